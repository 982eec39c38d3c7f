// SPDX-License-Identifier: GPL-3.0-or-later
// Compares the orientation of the axes of a frame on the Earth with independent computations: meridian
// convergence and scale.
#include "scene/rasters/earth_place.hpp"

#include <gtest/gtest.h>

#include <GeographicLib/Geodesic.hpp>
#include <GeographicLib/LambertConformalConic.hpp>
#include <GeographicLib/LocalCartesian.hpp>
#include <GeographicLib/UTMUPS.hpp>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <utility>

#include "geometry/numbers/scalars.hpp"

namespace tubefoot {
namespace {

const SourcePlace earth_place{"scene.toml", 3, 1};

/// Angle of grid north, clockwise from true north.
double convergence_deg(const EarthPlace& place) {
  const glm::dvec3 north = place.to_east_north_up[1];
  return std::atan2(north.x, north.y) / degree;
}

/// Metres of the map per metre on the ellipsoid, for a conformal map.
double scale(const EarthPlace& place) { return 1 / glm::length(place.to_east_north_up[1]); }

EarthPlace place_of(const LocalFrame& frame, glm::dvec3 point) {
  return on_earth(frame, {&point, 1}, earth_place).at(0);
}

TEST(EarthPlace, MeridiansOfUtmConvergeAsTheMercatorProjectionSays) {
  const std::pair<double, double> lat_lons[] = {{70, 17.99}, {70, 12.01}, {60, 15},
                                                {0.5, 17.5}, {-54, 16.2}, {83.9, 17.9}};
  for (const auto& [latitude, longitude] : lat_lons) {
    int zone = 0;
    bool north = false;
    double x = 0, y = 0, gamma_deg = 0, k = 0;
    GeographicLib::UTMUPS::Forward(latitude, longitude, zone, north, x, y, gamma_deg, k, 33);
    const char* crs = north ? "EPSG:32633" : "EPSG:32733";
    // The point lies away from the origin, so that the test depends on the point and not on the frame.
    const EarthPlace place =
        place_of(LocalFrame::projected(crs, x - 3000, y + 4000, 12, earth_place), {3000, -4000, -50});
    EXPECT_NEAR(place.lon_lat_height.x, longitude, 1e-9);
    EXPECT_NEAR(place.lon_lat_height.y, latitude, 1e-9);
    EXPECT_NEAR(place.lon_lat_height.z, -38, 1e-9);
    EXPECT_NEAR(convergence_deg(place), gamma_deg, 2e-8) << latitude << " " << longitude;
    EXPECT_NEAR(scale(place), k, 1e-9);
    EXPECT_NEAR(glm::dot(place.to_east_north_up[0], place.to_east_north_up[1]), 0, 1e-9);
    EXPECT_EQ(place.to_east_north_up[2], glm::dvec3(0, 0, 1));
  }
}

TEST(EarthPlace, MeridiansOfAConicMapConvergeByDozensOfDegrees) {
  const GeographicLib::LambertConformalConic conic(6378137, 1 / 298.257223563, 49, 77, 1);
  double origin_x = 0, origin_y = 0, x = 0, y = 0, gamma_deg = 0, k = 0;
  conic.Forward(-95, 49, -95, origin_x, origin_y, gamma_deg, k);
  conic.Forward(-95, 70, -60, x, y, gamma_deg, k);
  const LocalFrame frame =
      LocalFrame::projected("+proj=lcc +lat_1=49 +lat_2=77 +lat_0=49 +lon_0=-95 +datum=WGS84 +units=m",
                            x - origin_x, y - origin_y, 0, earth_place);
  const EarthPlace place = place_of(frame, {0, 0, 0});
  EXPECT_GT(gamma_deg, 30);
  EXPECT_NEAR(place.lon_lat_height.x, -60, 1e-8);
  EXPECT_NEAR(convergence_deg(place), gamma_deg, 1e-7);
  EXPECT_NEAR(scale(place), k, 1e-9);
}

TEST(EarthPlace, MeridiansOfAPolarMapAreItsRadii) {
  const struct {
    const char* crs;
    double latitude, longitude_of_north, turn;
  } polar[] = {{"EPSG:3413", 84, -45, 1},
               {"EPSG:5041", 88, 0, 1},
               {"EPSG:3031", -77, 0, -1},
               {"+proj=stere +lat_0=90 +lat_ts=60 +lon_0=-45 +datum=WGS84 +units=m", 71, -45, 1}};
  for (const auto& map : polar)
    for (const double longitude : {-45.0, 0.0, 77.5, 170.0, -120.0}) {
      const LocalFrame pole = LocalFrame::projected(map.crs, 0, 0, 0, earth_place);
      const EarthPlace place = place_of(pole, pole.from_lat_lon(map.latitude, longitude, 0, earth_place));
      EXPECT_NEAR(place.lon_lat_height.x, longitude, 1e-9);
      EXPECT_NEAR(
          std::remainder(convergence_deg(place) - map.turn * (longitude - map.longitude_of_north), 360), 0,
          1e-6)
          << map.crs << " " << longitude;
      EXPECT_GT(glm::determinant(place.to_east_north_up), 0) << "no mirror image";
    }
}

// This projection preserves neither lengths nor angles.
TEST(EarthPlace, DirectionsOfAMapThatIsNotConformalAreThoseOfItsPoints) {
  const LocalFrame frame = LocalFrame::projected("+proj=eqc +lat_ts=40 +lon_0=10 +datum=WGS84 +units=m",
                                                 500000, 6500000, 0, earth_place);
  const glm::dvec3 local(2000, -1000, -30);
  const EarthPlace place = place_of(frame, local);
  for (const double azimuth : {0.0, 33.0, 90.0, 145.0, 290.0}) {
    double latitude = 0, longitude = 0;
    GeographicLib::Geodesic::WGS84().Direct(place.lon_lat_height.y, place.lon_lat_height.x, azimuth, 10,
                                            latitude, longitude);
    const glm::dvec3 moved = frame.from_lat_lon(latitude, longitude, -30, earth_place) - local;
    const glm::dvec3 turned = place.to_east_north_up * moved;
    EXPECT_NEAR(turned.x, 10 * std::sin(azimuth * degree), 1e-4) << azimuth;
    EXPECT_NEAR(turned.y, 10 * std::cos(azimuth * degree), 1e-4) << azimuth;
    const glm::dvec3 steep = place.direction(glm::normalize(glm::normalize(moved) - glm::dvec3(0, 0, 2)));
    EXPECT_NEAR(std::atan2(steep.x, steep.y), std::atan2(turned.x, turned.y), 1e-12);
    EXPECT_NEAR(glm::length(steep), 1, 1e-12);
    EXPECT_NEAR(steep.z, -2 / std::sqrt(5), 1e-12) << "a map has no say in what is level";
  }
}

TEST(EarthPlace, OfATangentFrameLeansWithTheDistance) {
  const LocalFrame frame = LocalFrame::at_lat_lon(70, 18, 5);
  const glm::dvec3 local(20000, -7000, -40);
  const EarthPlace place = place_of(frame, local);
  const GeographicLib::LocalCartesian tangent(70, 18, 5);
  double latitude = 0, longitude = 0, height = 0;
  std::vector<double> m(9);
  tangent.Reverse(local.x, local.y, local.z, latitude, longitude, height, m);
  // The matrix of the library converts true directions into the frame.
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 3; ++column)
      EXPECT_NEAR(place.to_east_north_up[row][column], m[std::size_t(3 * row + column)], 2e-9);
  EXPECT_GT(std::abs(convergence_deg(place)), 0.4) << "20 km east at 70 degrees";
  EXPECT_NEAR(place.lon_lat_height.z, height, 1e-6);
}

TEST(EarthPlace, AMapOutOfScaleIsWarnedOf) {
  EXPECT_FALSE(scale_warning(LocalFrame()));
  EXPECT_FALSE(scale_warning(LocalFrame::at_lat_lon(60, 10, 0)));
  EXPECT_FALSE(scale_warning(LocalFrame::projected("EPSG:32633", 614000, 7770000, 0, earth_place)));
  EXPECT_FALSE(scale_warning(LocalFrame::projected("EPSG:5041", 2000000, 2000000, 0, earth_place)))
      << "0.994";
  const auto warning = scale_warning(LocalFrame::projected("EPSG:3857", 1.2e6, 8.4e6, 0, earth_place));
  ASSERT_TRUE(warning);
  // 6378137 m over the radius of the parallel, and over that of the meridian times the cosine of the
  // latitude.
  EXPECT_NE(warning->find("(60.0012 N, 10.7798 E)"), std::string::npos) << *warning;
  EXPECT_NE(warning->find("east is 1.995 m on the map, and a metre to the north is 1.998 m"),
            std::string::npos)
      << *warning;
}

TEST(EarthPlace, WaysBetweenPlacesLeadBack) {
  const glm::dvec3 from(17.9, 70.1, -3), to(17.912, 70.0985, -57.5);
  const glm::dvec3 way = east_north_up_between(from, to);
  double latitude = 0, longitude = 0;
  GeographicLib::Geodesic::WGS84().Direct(from.y, from.x, std::atan2(way.x, way.y) / degree,
                                          std::hypot(way.x, way.y), latitude, longitude);
  EXPECT_NEAR(latitude, to.y, 1e-12);
  EXPECT_NEAR(longitude, to.x, 1e-12);
  EXPECT_NEAR(way.z, -54.5, 1e-12);
}

}  // namespace
}  // namespace tubefoot
