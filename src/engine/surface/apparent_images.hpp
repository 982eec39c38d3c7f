// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <vector>

#include "engine/surface/refracted_surface.hpp"
#include "engine/water/apparent_map.hpp"

// Computes the apparent positions of seabed points for one apex in stratified water, one for each ray that
// leads to a point. It also decides which edges map_apparent() cuts, from the travel-path error and from the
// change of the facet factor in decibels. See docs/notes/refraction.md.
namespace tubefoot {

/// Image of a point by one ray, and the return of the point along this ray.
struct SeenPoint {
  glm::dvec3 at_m{0};
  CornerReturn returned;
  double range_m = 0;
  /// Facet factor of a horizontal facet at this point, in decibels.
  double level_db = 0;
  /// Launch angle, positive down. It defines the order of several rays.
  double launch_rad = 0;
  /// 1 / CornerReturn::spreading. It is negative behind a caustic and 0 on it, so that it is a smooth
  /// function of the launch direction.
  double width = 0;
  /// Width that corresponds to Eigenray::caustic_area_m2_per_sr.
  double caustic_width = 0;
  /// `kept`: one-way factor of absorption, divided by that of the reference absorption. `speeds`: sound
  /// speed at the apex divided by that at the point.
  double kept = 1, speeds = 1;

  /// Value of RayOfPart::Corner::gain.
  double gain() const { return speeds / (std::hypot(width, caustic_width) * kept); }
  /// Returns whether the ray tube is about as wide as the tube of a straight ray, as it is far from
  /// caustics.
  bool is_wide() const { return returned.spreading > 0.25 && returned.spreading < 4; }
  bool crossed() const { return width < 0; }
};

/// Image of a point by the first ray to arrive. Without an eigenray the point is not seen.
struct ApparentImage : SeenPoint {
  int eigenrays = 0;
  /// Images by each of several rays in the order of their launch angles, if ApparentMapSettings requests
  /// them.
  std::vector<SeenPoint> several{};
  bool seen() const { return eigenrays > 0; }
  /// Returns whether there is one ray, far from caustics.
  bool regular() const { return eigenrays == 1 && is_wide(); }
};

/// Matches the rays to two points. Returns, for each ray of `fewer`, the index of the corresponding ray of
/// `more`, in order. The result is empty if no match is possible. Among the possible matches, it has the
/// smallest sum of differences of launch angles. Two points on opposite sides of a caustic differ by a pair
/// of neighbouring rays, one of which is crossed.
std::vector<std::size_t> same_rays(const std::vector<SeenPoint>& more, const std::vector<SeenPoint>& fewer);
/// Returns whether both points have the same number of rays, with the same sequence of crossed and uncrossed
/// rays.
bool are_alike(const std::vector<SeenPoint>& a, const std::vector<SeenPoint>& b);

/// Computes images, and decides which edges between them are cut.
class Images {
 public:
  Images(const ApparentMap& apparent_map, double reference_absorption_db_per_m,
         const ApparentMapSettings& settings, const ViewBounds* view_bounds);

  ApparentImage make(const glm::dvec3& point_m) const;

  /// Travel-path error of an edge, in metres. Without `middle` it is a bound. If rays spread about as in
  /// isovelocity water, the images of straight lines have about the curvature of rays. It is at most g / c
  /// per metre. The bound for short edges uses twice this curvature.
  double travel_path_error_m(const glm::dvec3& a, const glm::dvec3& b, const ApparentImage& from,
                             const ApparentImage& to, const ApparentImage* middle = nullptr) const {
    if (middle != nullptr) return edge_travel_path_error_m(from.at_m, to.at_m, middle->at_m);
    const glm::dvec3 edge = b - a;
    return from.regular() && to.regular() ? bend_per_m_ * glm::dot(edge, edge) / 4
                                          : std::numeric_limits<double>::infinity();
  }

  /// Returns whether an edge is short compared with its range. The two ends then determine the changes along
  /// the edge.
  static bool is_short(double length, const ApparentImage& from, const ApparentImage& to) {
    return 4 * length < std::min(from.range_m, to.range_m);
  }

  /// Returns whether the bound of travel_path_error_m() is sufficient, so that the images of the ends are
  /// enough.
  bool surely_whole(const glm::dvec3& a, const glm::dvec3& b, const ApparentImage& from,
                    const ApparentImage& to) const {
    const double length = glm::distance(a, b);
    return is_short(length, from, to) && is_fine(length, travel_path_error_m(a, b, from, to), from, to, to);
  }

  /// Returns whether an edge is too long for its distance to an apex on the seabed. After cutting, facets
  /// that contain the apex or nearly contain it lie where rays are straight.
  bool is_long_nearby(const glm::dvec3& a, const glm::dvec3& b) const {
    const double within_m = apparent_map_.straight_within_m();
    if (!(within_m > 0)) return false;
    const double length = glm::distance(a, b);
    return 2 * length > within_m && glm::distance((a + b) / 2.0, apparent_map_.apex_m()) < 2 * length;
  }

  template <class ImageOf>
  bool cuts(const glm::dvec3& a, const glm::dvec3& b, const ImageOf& image_of) const {
    const double length = glm::distance(a, b);
    const ApparentImage &from = image_of(a), &to = image_of(b);
    if (from.seen() && to.seen() && surely_whole(a, b, from, to)) return false;
    const ApparentImage& middle = image_of((a + b) / 2.0);
    if (!from.several.empty() || !to.several.empty() || !middle.several.empty())
      return cuts_by_any_ray(length, from, to, middle);
    // Edges in shadows, on caustics and next to them are cut to one uniform length. Otherwise the refinement
    // along a border between long edges would not end.
    if (!from.regular() || !to.regular() || !middle.regular()) return length > settings_.shadow_edge_m;
    return !is_fine(length, travel_path_error_m(a, b, from, to, &middle), from, to, middle);
  }

  /// Returns whether the surroundings of an edge are of interest. The surroundings are the ball of EdgeRule
  /// about the edge. If only one facet may be cut by the edge (`inside`), they are the part of the ball in
  /// the box of this facet.
  bool concerns(const glm::dvec3& a, const glm::dvec3& b, const FacetMesh& base, FacetId facet,
                const WorldGrid& grid, bool inside) const;

  /// Returns whether a facet is so small compared with its range that its corners determine its factor.
  /// `seen_m` is relative to the apex.
  bool is_small(const glm::dvec3 (&corners_m)[3], const glm::dvec3 (&seen_m)[3]) const;
  double reference_absorption_db_per_m() const { return absorption_; }
  const ApparentMap& apparent_map() const { return apparent_map_; }

  bool may_see(const glm::dvec3 (&corners_m)[3]) const {
    return view_bounds_ == nullptr || view_bounds_->may_see(corners_m);
  }
  /// Returns false only if no tube meets the image of any point within a distance of a place.
  bool may_show(const glm::dvec3& seen_at_m, double distance_m) const {
    return view_bounds_ == nullptr || view_bounds_->may_show(seen_at_m - apparent_map_.apex_m(), distance_m);
  }

 private:
  SeenPoint seen_point(const glm::dvec3& point_m, const ApparentPoint& found) const;
  /// A gap that grows with the square of the distance along the edge changes lengths by 4 gap / length at
  /// the ends. A constant factor of a facet has an error of half the change between its corners.
  bool is_fine(double length, double gap, const SeenPoint& from, const SeenPoint& to,
               const SeenPoint& middle) const {
    const auto [least, most] = std::minmax({from.level_db, to.level_db, middle.level_db});
    return gap <= settings_.travel_path_error_m &&
           db_per_relative * 4 * gap / length + (most - least) / 2 <= settings_.tolerance_db;
  }
  bool cuts_by_any_ray(double length, const ApparentImage& from, const ApparentImage& to,
                       const ApparentImage& middle) const;

  /// Decibels per small relative change.
  static constexpr double db_per_relative = 4.3429448190325183;

  const ApparentMap& apparent_map_;
  double absorption_;
  ApparentMapSettings settings_;
  const ViewBounds* view_bounds_;
  double bend_per_m_ = 0;
};

/// True facets after refinement, and the images of their vertices.
struct FineFacets {
  RefinedMesh mesh;
  std::vector<glm::dvec3> at_m;
  std::vector<ApparentImage> image;
};

inline glm::dvec3 normal_of(const glm::dvec3 (&c)[3]) { return glm::cross(c[1] - c[0], c[2] - c[0]); }

/// Cross-section of a scattering model up to a constant factor; null: Lambert's law.
double sigma_of(const ScatteringModel* model, double sine);

}  // namespace tubefoot
