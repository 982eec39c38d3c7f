// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <optional>
#include <span>
#include <tuple>
#include <utility>
#include <vector>

#include "engine/scattering/volume_scattering.hpp"
#include "geometry/integrals/measure.hpp"

// The unobstructed water of a tube as a sum of cones from the apex to polygons, for doubles and for balls.
//
// Along a direction, the water scatters from the apex to the first surface at the range R. Let h(R) be the
// integral of a function of range from 0 to R. Let layers with the coefficients s_0, s_1, ..., s_n meet at
// the ranges R_1 < R_2 < ... < R. The integral is then
//
//     (s_0 - s_1) h(R_1) + (s_1 - s_2) h(R_2) + ... + s_n h(R).
//
// Each term belongs to a polygon in the tube. It is a visible polygon of a surface, or a part of the border
// between two layers. Directions without a surface have a polygon beyond all range samples.
namespace tubefoot {

/// Polygons in doubles, relative to the apex.
struct DoubleSpace {
  using Number = double;
  using Vector = glm::dvec3;
  struct Polygon {
    FacetPlane plane;
    std::span<const glm::dvec3> corners_m;  ///< with the orientation of visible polygons; not owned
  };

  static std::span<const Vector> corners(const Polygon& polygon) { return polygon.corners_m; }
  /// Returns a polygon with other corners on the same plane, which must outlive it.
  static Polygon on_same_plane(const Polygon& polygon, std::span<const Vector> corners) {
    return {polygon.plane, corners};
  }
  /// Returns a polygon on the plane whose points p have dot(normal, p) = -distance. `normal` is a unit vector
  /// except for rounding. The corners must outlive the polygon.
  static Polygon on_plane(const glm::dvec3& normal, double distance, std::span<const Vector> corners) {
    return {{normal, distance}, corners};
  }
  static int sign(double x) { return (x > 0) - (x < 0); }
  static glm::dvec3 middle(const Vector& v) { return v; }
  static double middle_of(double x) { return x; }
  static double product(const glm::dvec3& a, const Vector& b) { return glm::dot(a, b); }
  static Vector between(const Vector& a, const Vector& b, double share) { return a + share * (b - a); }
  static Vector scaled(const Vector& v, double factor) { return factor * v; }
};

/// The content of one tube: directions of its rays, visible polygons, and unobstructed cones of directions.
template <class Space>
struct TubeContent {
  std::array<typename Space::Vector, 4> rays;
  std::vector<typename Space::Polygon> surfaces;
  std::vector<std::vector<typename Space::Vector>> open;
};

/// Divides the unobstructed water of tubes into cones. All polygons keep the sense of rotation of the tube.
/// In balls, a corner whose side of a border is undecided counts as a point of the border.
/// Law Z1 (water): without borders, the cones are the visible polygons and the unobstructed regions. Their
/// solid angles add up to that of the tube.
/// Law Z2 (layers): borders between layers with equal coefficients change no sum of integrals.
template <class Space>
class VolumeRegions {
 public:
  using Number = typename Space::Number;
  using Vector = typename Space::Vector;
  using Polygon = typename Space::Polygon;

  /// `volume`: heights in the local frame. Polygons of unobstructed directions lie between `beyond_m` and
  /// twice that range.
  VolumeRegions(const VolumeScattering& volume, double apex_height_m, double beyond_m)
      : s_v_per_m_(volume.s_v_per_m), beyond_m_(beyond_m) {
    check(volume);
    for (const double border : volume.borders_m) {
      heights_.push_back(Number(border) - Number(apex_height_m));
      apex_layer_ += border <= apex_height_m;
    }
  }

  /// Calls take(polygon, s_v) for all cones of a tube whose coefficient is not 0.
  template <class Take>
  void divide(const TubeContent<Space>& tube, const Take& take) {
    obstructed_.assign(heights_.size(), false);
    half_side_m_ = 2 * beyond_m_;
    if (!heights_.empty())
      for (const Polygon& surface : tube.surfaces)
        for (const Vector& corner : Space::corners(surface))
          half_side_m_ = std::max(half_side_m_, 1.01 * glm::length(Space::middle(corner)));
    for (std::size_t i = 0; i < heights_.size(); ++i) {
      if (Space::sign(heights_[i]) == 0) continue;
      for (const Polygon& surface : tube.surfaces) obstructed_[i] = obstructed_[i] || hides(surface, i);
      if (obstructed_[i]) continue;
      // The part of the border within the tube is in front of all surfaces.
      Corners cone(tube.rays.begin(), tube.rays.end());
      for (const glm::dvec3& wall : square_of(i))
        if (!cone.empty())
          cone = divided(cone, [&](const Vector& d) { return Space::product(wall, d); }).first;
      if (!cone.empty()) add_border(i, cone, take);
    }
    for (const Polygon& surface : tube.surfaces) add_surface(surface, take);
    for (const Corners& cone : tube.open) add_open(cone, take);
  }

  using Corners = std::vector<Vector>;
  /// Divides a convex polygon, or a convex cone given by its corner directions, at the zero of a linear
  /// function. A corner whose sign is undecided counts as a zero. Returns the parts with values of at least 0
  /// and of at most 0; a missing part is empty.
  template <class Side>
  static std::pair<Corners, Corners> divided(const Corners& corners, const Side& side) {
    std::vector<Number> value;
    std::vector<int> sign;
    bool positive = false, negative = false;
    for (const Vector& corner : corners) {
      value.push_back(side(corner));
      sign.push_back(Space::sign(value.back()));
      positive = positive || sign.back() > 0;
      negative = negative || sign.back() < 0;
    }
    if (!negative) return {corners, {}};
    if (!positive) return {{}, corners};
    std::pair<Corners, Corners> parts;
    for (std::size_t i = 0; i < corners.size(); ++i) {
      const std::size_t next = i + 1 == corners.size() ? 0 : i + 1;
      if (sign[i] >= 0) parts.first.push_back(corners[i]);
      if (sign[i] <= 0) parts.second.push_back(corners[i]);
      if (sign[i] * sign[next] >= 0) continue;
      const Vector crossing = Space::between(corners[i], corners[next], value[i] / (value[i] - value[next]));
      parts.first.push_back(crossing);
      parts.second.push_back(crossing);
    }
    return parts;
  }

 private:
  static Number height_of(const Vector& corner) { return Space::product({0, 0, 1}, corner); }

  /// Returns whether a part of a surface is between the heights of the apex and of a border, or on the
  /// border.
  bool hides(const Polygon& surface, std::size_t border) const {
    const int up = Space::sign(heights_[border]);
    bool beside_apex = false, before_border = false;
    for (const Vector& corner : Space::corners(surface)) {
      beside_apex = beside_apex || Space::sign(height_of(corner)) == up;
      before_border = before_border || Space::sign(heights_[border] - height_of(corner)) != -up;
    }
    return beside_apex && before_border;
  }
  /// Returns the layer that contains a whole surface, if there is one.
  std::optional<std::size_t> only_layer(const Polygon& surface) const {
    std::size_t layer = 0;
    const auto corners = Space::corners(surface);
    for (; layer < heights_.size(); ++layer) {
      bool above = false, below = false;
      for (const Vector& corner : corners) {
        const int side = Space::sign(height_of(corner) - heights_[layer]);
        above = above || side > 0;
        below = below || side < 0;
      }
      if (!above) return layer;
      if (below) return std::nullopt;
    }
    return layer;
  }
  std::size_t layer_behind(std::size_t border) const { return border < apex_layer_ ? border : border + 1; }
  std::size_t layer_before(std::size_t border) const { return border < apex_layer_ ? border + 1 : border; }

  template <class Take>
  void add_surface(const Polygon& surface, const Take& take) const {
    bool is_added = false;
    const auto add_part = [&](const Corners& part, std::size_t layer) {
      if (!is_added && s_v_per_m_[layer] != 0) take(Space::on_same_plane(surface, part), s_v_per_m_[layer]);
      const auto [first, end] = std::minmax(layer, apex_layer_);
      for (std::size_t border = first; border < end; ++border)
        if (obstructed_[border]) add_border(border, part, take);
    };
    if (const auto layer = only_layer(surface)) {
      if (s_v_per_m_[*layer] != 0) take(surface, s_v_per_m_[*layer]);
      const auto [first, end] = std::minmax(*layer, apex_layer_);
      if (std::find(obstructed_.begin() + std::ptrdiff_t(first), obstructed_.begin() + std::ptrdiff_t(end),
                    true) == obstructed_.begin() + std::ptrdiff_t(end))
        return;
      is_added = true;
    }
    const auto corners = Space::corners(surface);
    Corners above(corners.begin(), corners.end());
    for (std::size_t i = 0; i < heights_.size() && !above.empty(); ++i) {
      // A surface on the border belongs to the lower layer, here and in only_layer().
      auto [lower, upper] = divided(above, [&](const Vector& p) { return heights_[i] - height_of(p); });
      if (!lower.empty()) add_part(lower, i);
      above = std::move(upper);
    }
    if (!above.empty()) add_part(above, heights_.size());
  }

  template <class Take>
  void add_open(const Corners& cone, const Take& take) const {
    if (heights_.empty()) return add_exit(cone, s_v_per_m_.front(), take);
    const auto [upper, lower] = divided(cone, height_of);
    if (!upper.empty()) add_open_half(upper, true, take);
    if (!lower.empty()) add_open_half(lower, false, take);
  }

  /// Adds unobstructed directions upwards or downwards, from the apex on.
  template <class Take>
  void add_open_half(Corners cone, bool up, const Take& take) const {
    std::size_t layer = apex_layer_;
    const std::size_t borders = up ? heights_.size() - apex_layer_ : apex_layer_;
    for (std::size_t k = 0; k < borders; ++k) {
      const std::size_t border = up ? apex_layer_ + k : apex_layer_ - 1 - k;
      // Directions that meet the border outside of its square end before it.
      if (Space::sign(heights_[border]) != 0)
        for (const glm::dvec3& wall : square_of(border)) {
          auto [inner, outer] = divided(cone, [&](const Vector& d) { return Space::product(wall, d); });
          if (!outer.empty()) add_exit(outer, s_v_per_m_[layer], take);
          cone = std::move(inner);
          if (cone.empty()) return;
        }
      if (obstructed_[border]) add_border(border, cone, take);
      layer = layer_behind(border);
    }
    add_exit(cone, s_v_per_m_[layer], take);
  }

  /// Adds a cone of unobstructed directions, on planes beyond all samples.
  template <class Take>
  void add_exit(const Corners& cone, double s_v_per_m, const Take& take) const {
    if (s_v_per_m == 0) return;
    // A cone within 53 degrees about its mean direction has a polygon whose ranges differ by less than 5/3.
    constexpr double least_cosine = 0.6;
    std::vector<glm::dvec3> directions;
    glm::dvec3 mean(0);
    for (const Vector& corner : cone) {
      directions.push_back(glm::normalize(Space::middle(corner)));
      mean += directions.back();
    }
    mean = glm::normalize(mean);
    if (!std::ranges::all_of(directions, [&](glm::dvec3 d) { return glm::dot(mean, d) >= least_cosine; })) {
      // A plane through the apex halves the largest angle between two corners.
      glm::dvec3 wall(0);
      for (const glm::dvec3& one : directions)
        for (const glm::dvec3& other : directions)
          if (glm::length(one - other) > glm::length(wall)) wall = one - other;
      const auto [one, other] = divided(cone, [&](const Vector& d) { return Space::product(wall, d); });
      if (!one.empty() && !other.empty()) {
        add_exit(one, s_v_per_m, take);
        add_exit(other, s_v_per_m, take);
        return;
      }
    }
    const Number distance(beyond_m_ * 1.05);
    Corners corners;
    for (const Vector& d : cone) corners.push_back(Space::scaled(d, distance / Space::product(mean, d)));
    take(Space::on_plane(-mean, distance, corners), s_v_per_m);
  }

  /// Adds the part of a border that a cone of directions meets.
  template <class Take>
  void add_border(std::size_t border, const Corners& cone, const Take& take) const {
    const double change = s_v_per_m_[layer_before(border)] - s_v_per_m_[layer_behind(border)];
    const int up = Space::sign(heights_[border]);
    if (up == 0 || change == 0) return;  // h(0) = 0
    Corners corners;
    for (const Vector& d : cone) corners.push_back(Space::scaled(d, heights_[border] / height_of(d)));
    take(Space::on_plane({0, 0, -up}, Number(up) * heights_[border], corners), change);
  }

  /// Returns the walls of the cone of directions that meet a border within a square about the apex. The
  /// square exceeds the samples and all surfaces of the tube. Directions inside have positive products with
  /// the walls.
  std::array<glm::dvec3, 4> square_of(std::size_t border) const {
    const double steep = half_side_m_ / Space::middle_of(heights_[border]);
    return {{{1, 0, steep}, {-1, 0, steep}, {0, 1, steep}, {0, -1, steep}}};
  }

  std::vector<Number> heights_;  ///< of the borders above the apex
  std::vector<double> s_v_per_m_;
  double beyond_m_;
  double half_side_m_ = 0;  ///< of the squares on borders
  std::size_t apex_layer_ = 0;
  std::vector<bool> obstructed_;  ///< by border: surfaces hide a part of it within the current tube
};

}  // namespace tubefoot
