// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <glm/vec3.hpp>
#include <span>
#include <string>

#include "scene/description/georeference_description.hpp"

namespace tubefoot {

/// Position of the local east-north-up frame on Earth. The frame is tangent to the WGS 84 ellipsoid
/// (GeographicLib's LocalCartesian), or along the axes of a projected CRS about one of its points. In the
/// second case, coordinates are those of the projection minus the origin (grid north, the projection's
/// scale). Heights are unchanged: vertical datums are not converted.
class LocalFrame {
 public:
  /// Creates a frame of local metres, into which nothing can be transformed.
  LocalFrame() = default;
  /// Returns the east-north-up frame at a point, in degrees and metres above the ellipsoid.
  static LocalFrame at_lat_lon(double latitude_deg, double longitude_deg, double height_m);
  /// Returns a frame along the axes of a projected CRS ("EPSG:32602", WKT, PROJ text), with the origin in
  /// its units. Throws InputError at `place` for a CRS that is unknown, not projected, or whose axes are
  /// not east and north.
  static LocalFrame projected(const std::string& crs, double easting, double northing, double height_m,
                              const SourcePlace& place);
  /// Returns the frame that [georeference] describes. Throws InputError at its place.
  static LocalFrame from(const GeoreferenceDescription& description);

  bool is_georeferenced() const { return kind_ != Kind::kLocal; }
  /// Returns whether the frame is tangent to the ellipsoid instead of along the axes of a projected CRS.
  bool is_tangent() const { return kind_ == Kind::kTangent; }

  /// Transforms points of a CRS (easting or longitude, northing or latitude, height in m) into the frame.
  /// For the frame's own CRS this is one subtraction without loss of precision. Throws InputError at
  /// `place` if it fails.
  void carry(std::span<glm::dvec3> points, const std::string& crs, const SourcePlace& place) const;

  /// Returns the local position of a point on WGS 84. Throws InputError at `place` for a latitude beyond
  /// +-90 degrees, for a frame that is not georeferenced, and for a point outside of the CRS.
  glm::dvec3 from_lat_lon(double latitude_deg, double longitude_deg, double height_m,
                          const SourcePlace& place) const;
  /// Transforms many points with longitude, latitude and height, in place.
  void from_lon_lat(std::span<glm::dvec3> points, const SourcePlace& place) const;

  /// Transforms local points to longitude [degrees] and latitude [degrees] on WGS 84 and height [m], in
  /// place. Each call creates a transformation, so that one call with many points is faster. Throws
  /// InputError at `place` for a frame that is not georeferenced, and for a point without a position on
  /// Earth.
  void to_lon_lat(std::span<glm::dvec3> points, const SourcePlace& place) const;

  /// The plane map of the frame: easting = easting of the origin + east / metres_per_unit, and likewise
  /// northing.
  /// For a projected frame it is the frame's own CRS, and exact.
  /// For a tangent frame it is the orthographic projection about the origin. A point on the ellipsoid has
  /// its local east and north. At height h the coordinates differ by a factor 1 + h / R (50 m deep, 1 km
  /// away: 8 mm).
  /// A frame that is not georeferenced has no CRS.
  struct Map {
    std::string crs_wkt;
    double easting = 0, northing = 0;  ///< of the frame's origin, in the units of the CRS
    double metres_per_unit = 1;
  };
  Map map() const;
  /// Returns the height of the frame's origin in m, in the vertical reference of its CRS.
  double origin_height_m() const { return origin_.z; }

 private:
  enum class Kind { kLocal, kTangent, kProjected };
  Kind kind_ = Kind::kLocal;
  std::string crs_;             // projected: as WKT
  double metres_per_unit_ = 1;  // projected: unit of the axes of the CRS
  glm::dvec3 origin_{0};        // tangent: latitude, longitude, height; projected: easting, northing, height
};

/// Returns whether a CRS is in degrees. Throws InputError at `place` if it is neither geographic nor
/// projected.
bool is_geographic(const std::string& crs, const SourcePlace& place);

}  // namespace tubefoot
