// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <glm/vec3.hpp>
#include <span>
#include <string>

#include "scene/description/georeference_description.hpp"

namespace tubefoot {

/// Where the local east-north-up frame lies on Earth: either tangent to the WGS 84 ellipsoid (GeographicLib's
/// LocalCartesian), or along the axes of a projected CRS about a point of it, in which case coordinates are
/// the projection's own, less the origin (grid north, the projection's scale). Heights are taken as they
/// come: no vertical datum is changed.
class LocalFrame {
 public:
  /// Coordinates are local metres; nothing can be carried into the frame.
  LocalFrame() = default;
  /// East-north-up at a point. Degrees, metres above the ellipsoid.
  static LocalFrame at_lat_lon(double latitude_deg, double longitude_deg, double height_m);
  /// Axes of a projected CRS ("EPSG:32602", WKT, PROJ text), origin in its own units. Throws InputError at
  /// `place` for a CRS that is unknown, not projected, or whose axes are not east and north.
  static LocalFrame projected(const std::string& crs, double easting, double northing, double height_m,
                              const SourcePlace& place);
  /// What [georeference] asks for. Throws InputError at its place.
  static LocalFrame from(const GeoreferenceDescription& description);

  bool is_georeferenced() const { return kind_ != Kind::kLocal; }
  /// Tangent to the ellipsoid, not along the axes of a projected CRS.
  bool is_tangent() const { return kind_ == Kind::kTangent; }

  /// Carries points (easting or longitude, northing or latitude, height in m) of a CRS into the frame. A CRS
  /// equal to the frame's own costs one subtraction: no precision is lost. Throws InputError at `place` where
  /// it fails.
  void carry(std::span<glm::dvec3> points, const std::string& crs, const SourcePlace& place) const;

  /// Local position of a point on WGS 84. Throws InputError at `place` for a latitude beyond +-90 degrees, a
  /// frame that is not georeferenced, a point that the CRS cannot hold.
  glm::dvec3 from_lat_lon(double latitude_deg, double longitude_deg, double height_m,
                          const SourcePlace& place) const;
  /// The same of many points by longitude, latitude and height, in place.
  void from_lon_lat(std::span<glm::dvec3> points, const SourcePlace& place) const;

  /// The other way: local points to longitude [degrees], latitude [degrees] on WGS 84 and height [m], in
  /// place. A call sets up a transformation: give it many points. Throws InputError at `place` for a frame
  /// that is not georeferenced, or a point that has no place on Earth.
  void to_lon_lat(std::span<glm::dvec3> points, const SourcePlace& place) const;

  /// The flat map of the frame: easting = easting of the origin + east / metres_per_unit, and likewise
  /// northing. A projected frame: its own CRS, exact. A tangent frame: the orthographic projection about its
  /// origin, in which a point on the ellipsoid has its local east and north, and one at the height h above it
  /// has them but for a factor 1 + h / R (50 m deep, 1 km away: 8 mm). A frame that is not georeferenced: no
  /// CRS.
  struct Map {
    std::string crs_wkt;
    double easting = 0, northing = 0;  ///< of the frame's origin, in the CRS's units
    double metres_per_unit = 1;
  };
  Map map() const;
  /// Height of the frame's origin, m, as the heights of its CRS count.
  double origin_height_m() const { return origin_.z; }

 private:
  enum class Kind { kLocal, kTangent, kProjected };
  Kind kind_ = Kind::kLocal;
  std::string crs_;             // projected: as WKT
  double metres_per_unit_ = 1;  // projected: of the CRS's own axes
  glm::dvec3 origin_{0};        // tangent: latitude, longitude, height; projected: easting, northing, height
};

/// True for a CRS in degrees; throws InputError at `place` for one that is neither geographic nor projected.
bool is_geographic(const std::string& crs, const SourcePlace& place);

}  // namespace tubefoot
