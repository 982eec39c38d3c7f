// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <vector>

#include "engine/surface/refracted_surface.hpp"

// Places of the seabed as one apex sees them through refracting water, by each of the rays that lead there:
// what straighten() makes its facets of.
namespace tubefoot {

/// A point's image by one ray, and what that returns.
struct SeenPoint {
  glm::dvec3 at_m{0};
  CornerReturn returned;
  double range_m = 0;
  /// What a level facet's factor is here, in decibels.
  double level_db = 0;
  /// Of several rays, in whose order they are. Positive down.
  double launch_rad = 0;
  /// 1 / CornerReturn::spreading, below 0 behind a caustic and 0 on it: smooth in the launch direction.
  double width = 0;
  /// What Eigenray::caustic_area_m2_per_sr is of that.
  double caustic_width = 0;
  /// What absorption leaves one way over what the reference absorption does, and the sound speed at the apex
  /// over that at the point.
  double kept = 1, speeds = 1;

  /// RayOfPart::Corner::gain.
  double gain() const { return speeds / (std::hypot(width, caustic_width) * kept); }
  /// The ray's tube is about as wide as that of a straight one: far from caustics.
  bool is_wide() const { return returned.spreading > 0.25 && returned.spreading < 4; }
  bool crossed() const { return width < 0; }
};

/// By the first ray to arrive; without eigenray: not seen.
struct ApparentImage : SeenPoint {
  int eigenrays = 0;
  /// By each of several rays, by their launch angles: if ApparentMapSettings asks for them.
  std::vector<SeenPoint> several{};
  bool seen() const { return eigenrays > 0; }
  /// One ray, far from caustics.
  bool regular() const { return eigenrays == 1 && is_wide(); }
};

/// Rays to two places that are the same ones but for where they go: for each of the fewer, the number of that
/// of the more, in their order; empty where they cannot be. Of those, the ones that are launched most alike.
/// Places on the two sides of a caustic differ by neighbours one of which is crossed.
std::vector<std::size_t> same_rays(const std::vector<SeenPoint>& more, const std::vector<SeenPoint>& fewer);
/// As many, and each crossed or not in its turn.
bool are_alike(const std::vector<SeenPoint>& a, const std::vector<SeenPoint>& b);

/// Makes images, and says which edges between them are to be cut.
class Images {
 public:
  Images(const ApparentMap& apparent_map, double reference_absorption_db_per_m,
         const ApparentMapSettings& settings, const ViewBounds* view_bounds);

  ApparentImage make(const glm::dvec3& point_m) const;

  /// The gap of an edge, metres. Straight lines are seen curved about as much as rays are, at most g / c per
  /// metre, where rays spread about as in isovelocity water: of a short edge there, twice that is as good.
  double travel_path_error_m(const glm::dvec3& a, const glm::dvec3& b, const ApparentImage& from,
                             const ApparentImage& to, const ApparentImage* middle = nullptr) const {
    if (middle != nullptr) return edge_travel_path_error_m(from.at_m, to.at_m, middle->at_m);
    const glm::dvec3 edge = b - a;
    return from.regular() && to.regular() ? bend_per_m_ * glm::dot(edge, edge) / 4
                                          : std::numeric_limits<double>::infinity();
  }

  /// Short beside its range: the ends say how things change along it.
  static bool is_short(double length, const ApparentImage& from, const ApparentImage& to) {
    return 4 * length < std::min(from.range_m, to.range_m);
  }

  /// Whether the bound of travel_path_error_m() will do, and the images of the ends are enough.
  bool surely_whole(const glm::dvec3& a, const glm::dvec3& b, const ApparentImage& from,
                    const ApparentImage& to) const {
    const double length = glm::distance(a, b);
    return is_short(length, from, to) && is_fine(length, travel_path_error_m(a, b, from, to), from, to, to);
  }

  /// Whether an edge is long for how near it is to an apex on the seabed: facets that hold the apex, or
  /// nearly, lie then where rays are straight.
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
    // Shadows and caustics are cut evenly, in and beside them: a border narrowed down between long edges
    // would not end.
    if (!from.regular() || !to.regular() || !middle.regular()) return length > settings_.shadow_edge_m;
    return !is_fine(length, travel_path_error_m(a, b, from, to, &middle), from, to, middle);
  }

  /// Whether what lies about an edge is asked for: the ball of EdgeRule about it, and of that, where only one
  /// facet may be cut by it, what lies in that facet's box.
  bool concerns(const glm::dvec3& a, const glm::dvec3& b, const FacetMesh& base, FacetId facet,
                const WorldGrid& grid, bool inside) const;

  /// So small beside its range that its corners say all that its factor needs. `seen_m`: from the apex.
  bool is_small(const glm::dvec3 (&corners_m)[3], const glm::dvec3 (&seen_m)[3]) const;
  double reference_absorption_db_per_m() const { return absorption_; }
  const ApparentMap& apparent_map() const { return apparent_map_; }

  bool may_see(const glm::dvec3 (&corners_m)[3]) const {
    return view_bounds_ == nullptr || view_bounds_->may_see(corners_m);
  }
  /// False only if no tube meets what is seen within a distance of a place.
  bool may_show(const glm::dvec3& seen_at_m, double distance_m) const {
    return view_bounds_ == nullptr || view_bounds_->may_show(seen_at_m - apparent_map_.apex_m(), distance_m);
  }

 private:
  SeenPoint seen_point(const glm::dvec3& point_m, const ApparentPoint& found) const;
  /// A gap that grows as the square of the way along the edge changes lengths by 4 gap / length at its ends;
  /// one factor for a facet is off by half the change between them.
  bool is_fine(double length, double gap, const SeenPoint& from, const SeenPoint& to,
               const SeenPoint& middle) const {
    const auto [least, most] = std::minmax({from.level_db, to.level_db, middle.level_db});
    return gap <= settings_.travel_path_error_m &&
           db_per_relative * 4 * gap / length + (most - least) / 2 <= settings_.tolerance_db;
  }
  bool cuts_by_any_ray(double length, const ApparentImage& from, const ApparentImage& to,
                       const ApparentImage& middle) const;

  /// Decibels of a small relative change.
  static constexpr double db_per_relative = 4.3429448190325183;

  const ApparentMap& apparent_map_;
  double absorption_;
  ApparentMapSettings settings_;
  const ViewBounds* view_bounds_;
  double bend_per_m_ = 0;
};

/// True facets, fine enough, and their vertices' images.
struct FineFacets {
  RefinedMesh mesh;
  std::vector<glm::dvec3> at_m;
  std::vector<ApparentImage> image;
};

inline glm::dvec3 normal_of(const glm::dvec3 (&c)[3]) { return glm::cross(c[1] - c[0], c[2] - c[0]); }

/// Of a facet of that law, but for a factor; null: Lambert's.
double sigma_of(const ScatteringModel* model, double sine);

}  // namespace tubefoot
