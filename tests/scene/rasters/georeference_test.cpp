// SPDX-License-Identifier: GPL-3.0-or-later
// Tests local frames: tangent frames and projected frames, conversion to longitude and latitude and back,
// precision, and their map systems.

#include "scene/rasters/georeference.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <ogr_spatialref.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>
#include <memory>
#include <random>
#include <vector>

namespace tubefoot {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::ThrowsMessage;

const SourcePlace raster_place{"scene.toml", 2, 1};
constexpr double kSemiMajor = 6378137.0, kFlattening = 1 / 298.257223563;  // WGS 84

void expect_near(glm::dvec3 a, glm::dvec3 b, double tolerance) {
  EXPECT_LE(glm::distance(a, b), tolerance)
      << "(" << a.x << ", " << a.y << ", " << a.z << ") and (" << b.x << ", " << b.y << ", " << b.z << ")";
}

TEST(TangentFrame, TheEquatorIsACircle) {
  const LocalFrame frame = LocalFrame::at_lat_lon(0, 20, 0);
  const double angle = glm::radians(0.5);
  expect_near(frame.from_lat_lon(0, 20.5, 0, raster_place),
              {kSemiMajor * std::sin(angle), 0, kSemiMajor * (std::cos(angle) - 1)}, 1e-8);
  expect_near(frame.from_lat_lon(0, 20, 35, raster_place), {0, 0, 35}, 1e-9);
}

// Geocentric position on the ellipsoid, by the definition of geodetic latitude.
glm::dvec3 geocentric(double latitude_deg, double longitude_deg, double height) {
  const double lat = glm::radians(latitude_deg), lon = glm::radians(longitude_deg);
  const double e2 = kFlattening * (2 - kFlattening);
  const double normal = kSemiMajor / std::sqrt(1 - e2 * std::sin(lat) * std::sin(lat));
  return {(normal + height) * std::cos(lat) * std::cos(lon),
          (normal + height) * std::cos(lat) * std::sin(lon), (normal * (1 - e2) + height) * std::sin(lat)};
}

TEST(TangentFrame, AgreesWithGeocentricCoordinatesTurnedByHand) {
  const double lat = 65.31, lon = -168.39;
  const LocalFrame frame = LocalFrame::at_lat_lon(lat, lon, 12);
  const glm::dvec3 d = geocentric(65.32, -168.36, -52) - geocentric(lat, lon, 12);
  const double sp = std::sin(glm::radians(lat)), cp = std::cos(glm::radians(lat));
  const double sl = std::sin(glm::radians(lon)), cl = std::cos(glm::radians(lon));
  expect_near(frame.from_lat_lon(65.32, -168.36, -52, raster_place),
              {-sl * d.x + cl * d.y, -sp * cl * d.x - sp * sl * d.y + cp * d.z,
               cp * cl * d.x + cp * sl * d.y + sp * d.z},
              1e-8);
}

TEST(TangentFrame, UtmPointsArriveWhereTheirLatitudeAndLongitudeDo) {
  const LocalFrame frame = LocalFrame::at_lat_lon(0.4, -171, 0);
  // On the central meridian of zone 2, 1 degree is 110574.3886 m of arc (Snyder, Map Projections, WGS 84
  // constants), times 0.9996.
  glm::dvec3 point(500000, 0.9996 * 55287.1536, -10);  // half a degree: 55287.1536 m
  frame.carry({&point, 1}, "EPSG:32602", raster_place);
  expect_near(point, frame.from_lat_lon(0.5, -171, -10, raster_place), 0.01);
}

TEST(ProjectedFrame, SubtractsItsOriginAndLosesNoPrecision) {
  const LocalFrame frame = LocalFrame::projected("EPSG:32602", 621860, 7245027, -50, raster_place);
  std::vector<glm::dvec3> points = {{620152.872885373, 7246504.911727688, -52.25}, {621860, 7245027, -50}};
  frame.carry(points, "EPSG:32602", raster_place);
  EXPECT_EQ(points[0], glm::dvec3(620152.872885373 - 621860, 7246504.911727688 - 7245027, -2.25));
  EXPECT_EQ(points[1], glm::dvec3(0, 0, 0));
}

TEST(ProjectedFrame, KnowsItsOwnCrsByAnotherName) {
  const LocalFrame frame = LocalFrame::projected("EPSG:32602", 621860, 7245027, 0, raster_place);
  glm::dvec3 point(621861, 7245029, 0);
  frame.carry({&point, 1}, "+proj=utm +zone=2 +datum=WGS84 +units=m +no_defs", raster_place);
  EXPECT_EQ(point, glm::dvec3(1, 2, 0)) << "not through a transformation";
}

TEST(ProjectedFrame, CarriesLatitudeAndLongitude) {
  const LocalFrame frame = LocalFrame::projected("EPSG:32602", 500000, 0, 0, raster_place);
  expect_near(frame.from_lat_lon(0, -171, 7, raster_place), {0, 0, 7}, 1e-6);
  expect_near(frame.from_lat_lon(0.5, -171, 7, raster_place), {0, 0.9996 * 55287.1536, 7}, 0.01);
}

TEST(ProjectedFrame, TakesItsUnitIntoAccount) {
  // California zone 3 in US survey feet.
  const LocalFrame frame = LocalFrame::projected("EPSG:2227", 6000000, 2000000, 0, raster_place);
  glm::dvec3 point(6003937, 2007874, 5);
  frame.carry({&point, 1}, "EPSG:2227", raster_place);
  expect_near(point, {1200, 2400, 5}, 1e-9);
}

/// Random local points of a survey, within 5 km of the origin.
std::vector<glm::dvec3> survey_points() {
  std::mt19937_64 random(20240917);
  std::uniform_real_distribution<double> across(-5000, 5000), height(-300, 20);
  std::vector<glm::dvec3> points(500);
  for (glm::dvec3& p : points) p = {across(random), across(random), height(random)};
  return points;
}

void expect_round_trip(const LocalFrame& frame, double tolerance_m) {
  const std::vector<glm::dvec3> points = survey_points();
  std::vector<glm::dvec3> back = points;
  frame.to_lon_lat(back, raster_place);
  frame.carry(back, "EPSG:4326", raster_place);
  for (std::size_t k = 0; k < points.size(); ++k) expect_near(back[k], points[k], tolerance_m);
}

// A double resolves a longitude of 3 degrees to 2.5e-11 m and one of 168 degrees to 1.6e-9 m. It resolves
// the geocentric coordinates that the tangent frame uses to 5e-10 m each.
TEST(LocalFrame, GoesToLongitudeAndLatitudeAndBack) {
  expect_round_trip(LocalFrame::at_lat_lon(1.5, 3, 20), 4e-9);
  expect_round_trip(LocalFrame::projected("EPSG:32631", 500000, 160000, 20, raster_place), 1e-9);
  expect_round_trip(LocalFrame::at_lat_lon(65.31, -168.39, 0), 1e-8);
  expect_round_trip(LocalFrame::projected("EPSG:32602", 621860, 7245027, 0, raster_place), 1e-8);
  expect_round_trip(LocalFrame::projected("EPSG:2227", 6000000, 2000000, 0, raster_place), 1e-8);
}

TEST(TangentFrame, LeavesTheEllipsoidWhereTheCircleOfTheEquatorSays) {
  const LocalFrame frame = LocalFrame::at_lat_lon(0, 20, 7);
  glm::dvec3 point(3000, 0, 0);  // along the tangent at height 7 m
  frame.to_lon_lat({&point, 1}, raster_place);
  const double radius = kSemiMajor + 7;
  EXPECT_NEAR(point.x, 20 + glm::degrees(std::atan2(3000, radius)), 1e-13);
  EXPECT_NEAR(point.y, 0, 1e-13);
  EXPECT_NEAR(point.z, std::hypot(3000, radius) - kSemiMajor, 1e-8);
}

TEST(ProjectedFrame, LeavesByItsCentralMeridian) {
  const LocalFrame frame = LocalFrame::projected("EPSG:32602", 500000, 0, -3, raster_place);
  glm::dvec3 point(0, 0.9996 * 55287.1536, 10);
  frame.to_lon_lat({&point, 1}, raster_place);
  EXPECT_NEAR(point.x, -171, 1e-12);
  EXPECT_NEAR(point.y, 0.5, 1e-7);
  EXPECT_EQ(point.z, 7);
}

/// Longitude and latitude of map coordinates, by PROJ.
glm::dvec3 lon_lat_on_map(const LocalFrame::Map& map, double east, double north) {
  OGRSpatialReference crs, wgs84;
  crs.importFromWkt(map.crs_wkt.c_str());
  wgs84.importFromEPSG(4326);
  crs.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  wgs84.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  const std::unique_ptr<OGRCoordinateTransformation> step(OGRCreateCoordinateTransformation(&crs, &wgs84));
  double x = map.easting + east / map.metres_per_unit, y = map.northing + north / map.metres_per_unit;
  EXPECT_TRUE(step->Transform(1, &x, &y));
  return {x, y, 0};
}

TEST(LocalFrame, ItsMapShowsLocalPointsWhereTheyAre) {
  const LocalFrame projected = LocalFrame::projected("EPSG:2227", 6000000, 2000000, 5, raster_place);
  glm::dvec3 point(1200, 2400, -5);
  const glm::dvec3 mapped = lon_lat_on_map(projected.map(), point.x, point.y);
  projected.to_lon_lat({&point, 1}, raster_place);
  expect_near(mapped, point, 1e-12);
  EXPECT_EQ(LocalFrame().map().crs_wkt, "");
}

// On the ellipsoid the map of a tangent frame is exact. At height h, coordinates are too small by h / R.
TEST(TangentFrame, ItsMapIsOrthographic) {
  const LocalFrame frame = LocalFrame::at_lat_lon(48.3, -4.5, 0);
  const glm::dvec3 on_map = lon_lat_on_map(frame.map(), 1000, -2000);
  const glm::dvec3 surface = frame.from_lat_lon(on_map.y, on_map.x, 0, raster_place);
  EXPECT_NEAR(surface.x, 1000, 1e-6);
  EXPECT_NEAR(surface.y, -2000, 1e-6);
  const glm::dvec3 seabed = frame.from_lat_lon(on_map.y, on_map.x, -50, raster_place);
  EXPECT_NEAR(seabed.x, 1000 * (1 - 50 / 6.38e6), 1e-4);
  EXPECT_NEAR(seabed.y, -2000 * (1 - 50 / 6.38e6), 1e-4);
  EXPECT_GT(std::abs(seabed.y + 2000), 0.01);
}

// Programs list systems by their names.
TEST(TangentFrame, ItsMapHasAName) {
  const LocalFrame frame = LocalFrame::at_lat_lon(48.3, -4.5, 0);
  OGRSpatialReference crs;
  ASSERT_EQ(crs.importFromWkt(frame.map().crs_wkt.c_str()), OGRERR_NONE);
  EXPECT_STREQ(crs.GetName(), "Tangent plane at 48.3, -4.5 (WGS 84)");
  EXPECT_STREQ(crs.GetAttrValue("GEOGCS"), "WGS 84");
}

TEST(LocalFrame, FollowsTheDescription) {
  GeoreferenceDescription description;
  description.place = raster_place;
  description.crs = "EPSG:32602";
  description.origin_crs = {{621860, 7245027}};
  description.origin_height_m = 5;
  glm::dvec3 point(621861, 7245025, 0);
  LocalFrame::from(description).carry({&point, 1}, "EPSG:32602", raster_place);
  EXPECT_EQ(point, glm::dvec3(1, -2, -5));

  GeoreferenceDescription tangent;
  tangent.origin_lat_lon_deg = {{10, 20}};
  expect_near(LocalFrame::from(tangent).from_lat_lon(10, 20, 3, raster_place), {0, 0, 3}, 1e-8);
}

TEST(LocalFrame, RefusesWhatHasNoPlace) {
  const auto message = [](const char* text) {
    return ThrowsMessage<InputError>(AllOf(HasSubstr("scene.toml:2:1"), HasSubstr(text)));
  };
  EXPECT_THAT([] { LocalFrame::projected("EPSG:99999999", 0, 0, 0, raster_place); },
              message("EPSG:99999999"));
  EXPECT_THAT([] { LocalFrame::projected("utm two", 0, 0, 0, raster_place); },
              message("not a known coordinate reference system"));
  EXPECT_THAT([] { LocalFrame::projected("EPSG:4326", 0, 0, 0, raster_place); }, message("not a projected"));
  EXPECT_THAT([] { LocalFrame::projected("EPSG:2053", 0, 0, 0, raster_place); }, message("west or south"));
  EXPECT_THAT([] { LocalFrame::at_lat_lon(0, 0, 0).from_lat_lon(91, 0, 0, raster_place); },
              message("latitude 91"));
  EXPECT_THAT([] { LocalFrame().from_lat_lon(1, 0, 0, raster_place); }, message("[georeference]"));
  EXPECT_THAT([] { LocalFrame().to_lon_lat({}, raster_place); }, message("[georeference]"));
  EXPECT_THAT(
      [] {
        glm::dvec3 point(NAN, 0, 0);
        LocalFrame::at_lat_lon(0, 0, 0).to_lon_lat({&point, 1}, raster_place);
      },
      message("not a valid local point"));
  EXPECT_THAT(
      [] {
        LocalFrame::projected("+proj=gnom +lat_0=90", 0, 0, 0, raster_place)
            .from_lat_lon(-10, 0, 0, raster_place);
      },
      message("has no position"));
}

TEST(LocalFrame, PrintsNothing) {
  testing::internal::CaptureStderr();
  EXPECT_THROW(LocalFrame::projected("EPSG:99999999", 0, 0, 0, raster_place), InputError);
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

}  // namespace
}  // namespace tubefoot
