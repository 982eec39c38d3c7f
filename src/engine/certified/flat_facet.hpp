// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <limits>
#include <utility>
#include <vector>

#include "engine/water/ray_enclosure.hpp"
#include "geometry/numbers/enclosure_slack.hpp"
#include "geometry/numbers/scalars.hpp"

// Geometry of true facets in their planes, over which their images are enclosed. It contains plane
// coordinates, the smallest enclosing circle, and the margin to which images are enclosed beyond the
// corners.
namespace tubefoot {

using FacetCorners = std::array<glm::dvec3, 3>;

/// Lower bound of the distance of a triangle's points from the origin.
inline double nearest_of(const FacetCorners& c) {
  const glm::dvec3 centre = (c[0] + c[1] + c[2]) / 3.0, n = glm::cross(c[1] - c[0], c[2] - c[0]);
  double radius = 0;
  for (const glm::dvec3& p : c) radius = std::max(radius, glm::distance(p, centre));
  const double size = glm::length(n), plane = size > 0 ? std::abs(glm::dot(n, centre)) / size : 0;
  return std::max({plane, glm::length(centre) - radius, 0.0}) * (1 - enclosure_slack);
}
inline double farthest_of(const FacetCorners& c) {
  return std::max({glm::length(c[0]), glm::length(c[1]), glm::length(c[2])}) * (1 + enclosure_slack);
}

/// True facet in the plane of its base facet. Refined corners are rounded to the grid and may lie off this
/// plane by `pad_m`, which widens every position.
class FlatFacet {
 public:
  FlatFacet(const FacetCorners& base, const FacetCorners& corners, double pad_m) : pad_m_(pad_m) {
    normal = glm::cross(base[1] - base[0], base[2] - base[0]);
    const double size = glm::length(normal);
    if (!(size > 0)) return;
    normal /= size;
    if (glm::dot(glm::cross(corners[1] - corners[0], corners[2] - corners[0]), normal) < 0) normal = -normal;
    int longest = 0;
    for (int k = 0; k < 3; ++k) {
      const double length = glm::distance(corners[k], corners[(k + 1) % 3]);
      if (length > longest_m) longest_m = length, longest = k;
    }
    if (!(longest_m > 0)) return;
    u = corners[(longest + 1) % 3] - corners[longest];
    u -= glm::dot(u, normal) * normal;
    u /= glm::length(u);
    v = glm::cross(normal, u);
    centre_m = (corners[0] + corners[1] + corners[2]) / 3.0;
    for (int k = 0; k < 3; ++k)
      at[k] = {glm::dot(corners[k] - centre_m, u), glm::dot(corners[k] - centre_m, v)};
    area_m2 = cross(at[1] - at[0], at[2] - at[0]) / 2;
    height_m = 2 * area_m2 / longest_m;
    valid = height_m > 4 * pad_m;
    margin_m = height_m / 50;
    // The smallest enclosing circle has the longest side as its diameter, or passes through all corners.
    const double p = glm::length(at[1] - at[0]), q = glm::length(at[2] - at[1]),
                 r = glm::length(at[0] - at[2]);
    const double sum2 = p * p + q * q + r * r;
    radius_m = (sum2 <= 2 * longest_m * longest_m ? longest_m / 2 : p * q * r / (4 * area_m2)) *
               (1 + enclosure_slack);
  }

  std::array<Interval, 3> padded(const glm::dvec3& p) const {
    std::array<Interval, 3> box;
    for (int i = 0; i < 3; ++i) box[i] = Interval(p[i] - pad_m_, p[i] + pad_m_);
    return box;
  }

  /// Slopes along u and v of the affine map from the corners to other places.
  template <class Place>
  std::pair<Place, Place> slopes_to(const std::array<Place, 3>& corner) const {
    const glm::dvec2 p = at[1] - at[0], q = at[2] - at[0];
    const double det = cross(p, q);
    const Place s = corner[1] - corner[0], t = corner[2] - corner[0];
    return {(s * q.y - t * p.y) / det, (t * p.x - s * q.x) / det};
  }

  glm::dvec3 normal{0}, u{0}, v{0}, centre_m{0};
  std::array<glm::dvec2, 3> at{};  // corners relative to the centre
  double longest_m = 0, height_m = 0, area_m2 = 0, radius_m = 0;
  double margin_m = 0;  // images are enclosed up to this distance beyond the corners
  bool valid = false;

 private:
  double pad_m_;
};

inline Interval norm_of(const std::array<Interval, 3>& x) {
  return root(squared(x[0]) + squared(x[1]) + squared(x[2]));
}

/// Bounds of second derivatives of the image: as a vector, and of its component along `normal`.
struct Bends {
  double all = 0, across = 0;
};
inline Bends bends_of(const RayJets& rays, const glm::dvec3& normal) {
  double all2 = 0;
  Jet along;
  for (int i = 0; i < 3; ++i) {
    const Jet& x = rays.image[i];
    all2 += (squared(x.aa) + 2.0 * squared(x.ab) + squared(x.bb)).hi;
    along = along + Jet(normal[i]) * x;
  }
  const double across2 = (squared(along.aa) + 2.0 * squared(along.ab) + squared(along.bb)).hi;
  return {std::sqrt(all2) * (1 + enclosure_slack), std::sqrt(across2) * (1 + enclosure_slack)};
}

/// Returns the box around a facet and its margin, in its plane.
inline std::pair<glm::dvec2, glm::dvec2> box_of(const FlatFacet& flat) {
  glm::dvec2 least = flat.at[0], most = flat.at[0];
  for (const glm::dvec2& p : flat.at) least = glm::min(least, p), most = glm::max(most, p);
  return {least - flat.margin_m, most + flat.margin_m};
}

/// Returns whether a box certainly lies outside of the facet and its margin.
inline bool beside(const FlatFacet& flat, const glm::dvec2& from, const glm::dvec2& to) {
  for (int k = 0; k < 3; ++k) {
    const glm::dvec2 &p = flat.at[k], &q = flat.at[(k + 1) % 3];
    double most = -std::numeric_limits<double>::infinity();
    for (const double x : {from.x, to.x})
      for (const double y : {from.y, to.y})
        most = std::max(most, cross(q - p, glm::dvec2(x, y) - p) / glm::length(q - p));
    if (most < -1.01 * flat.margin_m - enclosure_slack) return true;
  }
  return false;
}

/// Divides the box around a facet into `parts` intervals along each axis. Returns the boxes that meet the
/// facet.
inline std::vector<std::pair<Interval, Interval>> boxes_of(const FlatFacet& flat, int parts) {
  std::vector<std::pair<Interval, Interval>> boxes;
  const auto [least, most] = box_of(flat);
  const glm::dvec2 step = (most - least) / double(parts);
  for (int i = 0; i < parts; ++i)
    for (int j = 0; j < parts; ++j) {
      const glm::dvec2 from = least + step * glm::dvec2(i, j), to = least + step * glm::dvec2(i + 1, j + 1);
      if (!beside(flat, from, to)) boxes.push_back({{from.x, to.x}, {from.y, to.y}});
    }
  return boxes;
}

}  // namespace tubefoot
