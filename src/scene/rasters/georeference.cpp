// SPDX-License-Identifier: GPL-3.0-or-later

// Transforms points between geographic or projected coordinate reference systems and the local frame, with
// GDAL, PROJ and GeographicLib. It rejects a CRS that refers to files, and origins in degrees for a
// projected CRS.

#include "scene/rasters/georeference.hpp"

#include <fmt/core.h>
#include <ogr_spatialref.h>

#include <GeographicLib/LocalCartesian.hpp>
#include <algorithm>
#include <cctype>
#include <cmath>
#include <memory>
#include <string_view>
#include <vector>

#include "files/gdal_messages.hpp"
#include "files/proj_confinement.hpp"

namespace tubefoot {
namespace {

constexpr const char* kWgs84 = "EPSG:4326";

// Rejects a CRS text that names files of corrections. PROJ parses the text itself and would open these
// files, whose effect on a scene would not be part of any hash.
void refuse_files_in(const std::string& crs, const SourcePlace& place) {
  std::string text;
  for (const char c : crs)
    if (!std::isspace(static_cast<unsigned char>(c)))
      text += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  const auto refuse = [&](std::string_view word) {
    throw InputError(place, fmt::format("the coordinate reference system '{}' refers to a file or an "
                                        "operation ('{}'): expected a plain one, like EPSG:32632",
                                        crs.substr(0, 200), word));
  };
  constexpr std::size_t longest = 100'000;
  if (text.size() > longest) refuse("too long");
  if (text.starts_with('{')) refuse("{");  // PROJJSON contains nothing that WKT cannot express
  for (const std::string_view word : {"dict:", "init=", "grids", "gridshift", "parameterfile", "defmodel",
                                      "tinshift", "model=", "file=", "catalog=", "pipeline", "+step"})
    for (std::size_t at = text.find(word); at != text.npos; at = text.find(word, at + 1)) {
      const std::string_view behind = std::string_view(text).substr(at);
      // Part of Web Mercator, and not a grid.
      if (!behind.starts_with("grids=@null") ||
          (behind.size() > 11 && behind[11] != '"' && behind[11] != '+'))
        refuse(word);
    }
}

void refuse_rejected(const ProjConfinement& confinement, const std::string& crs, const SourcePlace& place) {
  if (!confinement.rejected().empty())
    throw InputError(place, fmt::format("the coordinate reference system '{}' refers to a file ('{}'), which "
                                        "tubefoot does not read: expected a plain one, like EPSG:32632",
                                        crs.substr(0, 200), confinement.rejected()));
}

// Returns a CRS with x = east or longitude and y = north or latitude, whatever order its authority
// prescribes. It has no vertical part, because heights are not converted.
OGRSpatialReference crs_from(const std::string& text, const SourcePlace& place) {
  refuse_files_in(text, place);
  const ProjConfinement confinement;
  const GdalMessages messages;
  OGRSpatialReference crs;
  // A scene of another person must not make GDAL open files or network addresses.
  const OGRErr outcome =
      crs.SetFromUserInput(text.c_str(), OGRSpatialReference::SET_FROM_USER_INPUT_LIMITATIONS_get());
  refuse_rejected(confinement, text, place);
  if (outcome != OGRERR_NONE) {
    throw InputError(
        place, fmt::format("'{}' is not a known coordinate reference system{}: expected one like EPSG:32632",
                           text.substr(0, 200), messages.in_brackets()));
  }
  if (crs.IsCompound()) crs.StripVertical();
  crs.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  return crs;
}

std::string wkt_of(const OGRSpatialReference& crs) {
  char* text = nullptr;
  crs.exportToWkt(&text);
  std::string wkt = text == nullptr ? "" : text;
  CPLFree(text);
  return wkt;
}

// Transforms x and y in place. GDAL recognises equal systems with different names and axis orders (a BAG's
// "unnamed" UTM zone 2N is EPSG:32602). It then leaves the points unchanged, to the last bit; a test checks
// this.
void transform(std::span<glm::dvec3> points, const OGRSpatialReference& from, const OGRSpatialReference& to,
               const SourcePlace& place) {
  const ProjConfinement confinement;
  const GdalMessages messages;
  const std::unique_ptr<OGRCoordinateTransformation> step(OGRCreateCoordinateTransformation(&from, &to));
  refuse_rejected(confinement, from.GetName(), place);
  if (step == nullptr) {
    throw InputError(place, fmt::format("no transformation from {} to {} is known{}", from.GetName(),
                                        to.GetName(), messages.in_brackets()));
  }
  constexpr std::size_t kBlock = 4096;
  std::vector<double> x(kBlock), y(kBlock);
  std::vector<int> ok(kBlock);
  for (std::size_t begin = 0; begin < points.size(); begin += kBlock) {
    const auto block = points.subspan(begin, std::min(kBlock, points.size() - begin));
    for (std::size_t i = 0; i < block.size(); ++i) {
      x[i] = block[i].x;
      y[i] = block[i].y;
    }
    step->Transform(static_cast<int>(block.size()), x.data(), y.data(), nullptr, ok.data());
    for (std::size_t i = 0; i < block.size(); ++i) {
      if (!ok[i] || !std::isfinite(x[i]) || !std::isfinite(y[i])) {
        throw InputError(place,
                         fmt::format("the point ({:.10g}, {:.10g}) of {} has no position in {}{}", block[i].x,
                                     block[i].y, from.GetName(), to.GetName(), messages.in_brackets()));
      }
      block[i].x = x[i];
      block[i].y = y[i];
    }
  }
}

void check_lat_lon(double latitude_deg, double longitude_deg, const SourcePlace& place) {
  if (!(std::abs(latitude_deg) <= 90) || !(std::abs(longitude_deg) <= 360)) {
    throw InputError(
        place,
        fmt::format("latitude {}, longitude {} is not a place on Earth: expected degrees, latitude first",
                    latitude_deg, longitude_deg));
  }
}

// Rejects an origin in degrees, which would be close to the projection's own origin. Such systems are
// hardly used there.
void refuse_degrees_for_metres(const std::string& crs, double easting, double northing,
                               const SourcePlace& place) {
  const OGRSpatialReference known = crs_from(crs, place);
  double west = 0, south = 0, east = 0, north = 0;
  const char* area = nullptr;
  if (std::abs(easting) > 360 || std::abs(northing) > 360 ||
      (easting == std::round(easting) && northing == std::round(northing)) || known.IsProjected() == 0 ||
      !known.GetAreaOfUse(&west, &south, &east, &north, &area) || west > east)
    return;
  const auto within = [&](double longitude, double latitude) {
    return longitude >= west && longitude <= east && latitude >= south && latitude <= north;
  };
  if (within(easting, northing) || within(northing, easting))
    throw InputError(place, fmt::format("origin_crs [{:g}, {:g}] looks like degrees, but {} has easting and "
                                        "northing in metres: give origin_lat_lon_deg, latitude first, "
                                        "instead of crs and origin_crs, or the origin's easting and northing",
                                        easting, northing, known.GetName()));
}

}  // namespace

LocalFrame LocalFrame::at_lat_lon(double latitude_deg, double longitude_deg, double height_m) {
  LocalFrame frame;
  frame.kind_ = Kind::kTangent;
  frame.origin_ = {latitude_deg, longitude_deg, height_m};
  return frame;
}

LocalFrame LocalFrame::projected(const std::string& crs, double easting, double northing, double height_m,
                                 const SourcePlace& place) {
  const OGRSpatialReference known = crs_from(crs, place);
  if (!known.IsProjected()) {
    throw InputError(
        place, fmt::format("{} is not a projected coordinate reference system: give origin_lat_lon_deg for a "
                           "frame tangent to the Earth",
                           known.GetName()));
  }
  OGRAxisOrientation axes[2] = {OAO_Other, OAO_Other};
  for (int axis = 0; axis < 2; ++axis) known.GetAxis(nullptr, axis, &axes[axis]);
  // On a polar map, both axes leave in the same compass direction, along two meridians.
  const bool polar = axes[0] == axes[1];
  for (const OGRAxisOrientation axis : axes)
    if (!polar && (axis == OAO_West || axis == OAO_South))
      throw InputError(place,
                       fmt::format("the axes of {} point to the west or south, expected easting and northing",
                                   known.GetName()));
  LocalFrame frame;
  frame.kind_ = Kind::kProjected;
  frame.crs_ = wkt_of(known);
  frame.metres_per_unit_ = known.GetLinearUnits();
  frame.origin_ = {easting, northing, height_m};
  return frame;
}

LocalFrame LocalFrame::from(const GeoreferenceDescription& description) {
  if (description.origin_lat_lon_deg) {
    const auto [latitude, longitude] = *description.origin_lat_lon_deg;
    check_lat_lon(latitude, longitude, description.place);
    return at_lat_lon(latitude, longitude, description.origin_height_m);
  }
  if (!description.crs || !description.origin_crs) {
    throw InputError(description.place, "expected either origin_lat_lon_deg, or crs and origin_crs");
  }
  const auto [easting, northing] = *description.origin_crs;
  refuse_degrees_for_metres(*description.crs, easting, northing, description.place);
  return projected(*description.crs, easting, northing, description.origin_height_m, description.place);
}

void LocalFrame::carry(std::span<glm::dvec3> points, const std::string& crs, const SourcePlace& place) const {
  const OGRSpatialReference source = crs_from(crs, place);
  switch (kind_) {
    case Kind::kLocal:
      throw InputError(place, "the scene has no [georeference]");
    case Kind::kTangent: {
      transform(points, source, crs_from(kWgs84, place), place);
      const GeographicLib::LocalCartesian tangent(origin_.x, origin_.y, origin_.z);
      for (glm::dvec3& p : points) {
        const glm::dvec3 lon_lat = p;
        tangent.Forward(lon_lat.y, lon_lat.x, lon_lat.z, p.x, p.y, p.z);
      }
      break;
    }
    case Kind::kProjected: {
      transform(points, source, crs_from(crs_, place), place);
      for (glm::dvec3& p : points) {
        p = {(p.x - origin_.x) * metres_per_unit_, (p.y - origin_.y) * metres_per_unit_, p.z - origin_.z};
      }
      break;
    }
  }
}

glm::dvec3 LocalFrame::from_lat_lon(double latitude_deg, double longitude_deg, double height_m,
                                    const SourcePlace& place) const {
  glm::dvec3 point(longitude_deg, latitude_deg, height_m);
  from_lon_lat({&point, 1}, place);
  return point;
}

void LocalFrame::from_lon_lat(std::span<glm::dvec3> points, const SourcePlace& place) const {
  for (const glm::dvec3& p : points) check_lat_lon(p.y, p.x, place);
  carry(points, kWgs84, place);
}

void LocalFrame::to_lon_lat(std::span<glm::dvec3> points, const SourcePlace& place) const {
  switch (kind_) {
    case Kind::kLocal:
      throw InputError(place, "the scene has no [georeference]");
    case Kind::kTangent: {
      const GeographicLib::LocalCartesian tangent(origin_.x, origin_.y, origin_.z);
      for (glm::dvec3& p : points) {
        if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z)) {
          throw InputError(place, fmt::format("({}, {}, {}) is not a valid local point", p.x, p.y, p.z));
        }
        const glm::dvec3 local = p;
        tangent.Reverse(local.x, local.y, local.z, p.y, p.x, p.z);
      }
      break;
    }
    case Kind::kProjected: {
      for (glm::dvec3& p : points) {
        p = {origin_.x + p.x / metres_per_unit_, origin_.y + p.y / metres_per_unit_, origin_.z + p.z};
      }
      transform(points, crs_from(crs_, place), crs_from(kWgs84, place), place);
      break;
    }
  }
}

LocalFrame::Map LocalFrame::map() const {
  switch (kind_) {
    case Kind::kLocal:
      break;
    case Kind::kTangent: {
      OGRSpatialReference orthographic;
      orthographic.SetProjCS(
          fmt::format("Tangent plane at {:.10g}, {:.10g} (WGS 84)", origin_.x, origin_.y).c_str());
      orthographic.SetWellKnownGeogCS("WGS84");
      orthographic.SetOrthographic(origin_.x, origin_.y, 0, 0);
      return {wkt_of(orthographic), 0, 0, 1};
    }
    case Kind::kProjected:
      return {crs_, origin_.x, origin_.y, metres_per_unit_};
  }
  return {};
}

bool is_geographic(const std::string& crs, const SourcePlace& place) {
  const OGRSpatialReference known = crs_from(crs, place);
  if (known.IsGeographic() == known.IsProjected()) {
    throw InputError(place, fmt::format("its coordinate reference system {} is neither geographic nor "
                                        "projected: expected longitude and latitude, or easting and northing",
                                        known.GetName()));
  }
  return known.IsGeographic() != 0;
}

}  // namespace tubefoot
