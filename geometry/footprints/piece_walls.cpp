// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/footprints/piece_walls.hpp"

#include <algorithm>
#include <cmath>

#include "geometry/arithmetic/wide_direction.hpp"

namespace tubefoot {
namespace {

/// Returns the side of a plane through the apex on which a piece lies that has this plane as wall. The result
/// is the sign of the normal there, or 0 if the corners contradict each other or lie in the plane. Doubles
/// decide if they can.
int side_of_piece(const NameContext& context, const PlaneName& plane, glm::dvec3 near,
                  std::span<const CornerName> corners, std::uint32_t k, std::span<const glm::dvec3> points) {
  int side = 0;
  const std::size_t n = corners.size();
  for (std::size_t i = 2; i < n; ++i) {
    const std::size_t corner = (k + i) % n;
    const glm::dvec3 products = near * points[corner];
    const double value = products.x + products.y + products.z;
    const double size = std::abs(products.x) + std::abs(products.y) + std::abs(products.z);
    int sign = value > 0 ? 1 : -1;
    if (!(std::abs(value) > 1e-13 * size))
      sign = dot(wide_normal(context, plane), wide_direction(context, corners[corner])).sign();
    if (sign * side < 0) return 0;
    if (sign != 0) side = sign;
  }
  return side;
}

}  // namespace

std::optional<PlaneName> shared_plane(const CornerName& x, const CornerName& y) {
  const auto through = [](const CornerName& corner, PointId point) -> std::optional<PlaneName> {
    if (corner.p.contains(point)) return corner.p;
    if (corner.q.contains(point)) return corner.q;
    return std::nullopt;
  };
  if (x.point != no_point && y.point != no_point) {
    if (x.point == y.point) return std::nullopt;
    return PlaneName{std::min(x.point, y.point), std::max(x.point, y.point), false};
  }
  if (x.point != no_point) return through(y, x.point);
  if (y.point != no_point) return through(x, y.point);
  const bool p = x.p == y.p || x.p == y.q, q = x.q == y.p || x.q == y.q;
  if (p == q) return std::nullopt;
  return p ? x.p : x.q;
}

std::array<HugeInt, 3> inward_normal(const NameContext& context, std::span<const CornerName> corners,
                                     std::uint32_t k, std::span<const glm::dvec3> points) {
  const CornerName &from = corners[k], &to = corners[(k + 1) % corners.size()];
  if (const auto plane = shared_plane(from, to)) {
    std::array<HugeInt, 3> inward;
    glm::dvec3 near;
    if (!plane->depth) {
      const Vec64 normal = cross(context.point(plane->a), context.point(plane->b));
      inward = {HugeInt(normal.x), HugeInt(normal.y), HugeInt(normal.z)};
      near = {static_cast<double>(normal.x), static_cast<double>(normal.y), static_cast<double>(normal.z)};
    } else {
      const WideVec normal = wide_normal(context, *plane);
      for (std::size_t c = 0; c < 3; ++c) {
        inward[c] = HugeInt(normal[c]);
        near[int(c)] = normal[c].convert_to<double>();
      }
    }
    const int side = near == glm::dvec3(0) ? 0 : side_of_piece(context, *plane, near, corners, k, points);
    if (side < 0)
      for (HugeInt& x : inward) x = -x;
    if (side != 0) return inward;
  }
  return wall_normal(wide_direction(context, from), wide_direction(context, to));
}

}  // namespace tubefoot
