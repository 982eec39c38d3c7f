// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/tubes/mirror.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <unordered_map>

#include "geometry/steps/stop.hpp"

// Mirrors points and directions at planes, and clips facets at a mirror plane. Sides of the plane are exact;
// mirrored points and cut corners are rounded to the grid (docs/notes/multiple-paths.md).

namespace tubefoot {
namespace {

/// Returns the fraction of the edge from a, in front of the plane, to b, behind it, at which the plane cuts
/// it. The order of a and b is the same for both facets of an edge, so they get the same point.
long double part_of_way(Int128 side_a, Int128 side_b) {
  return static_cast<long double>(side_a) /
         (static_cast<long double>(side_a) - static_cast<long double>(side_b));
}

GridPoint cut_of(GridPoint a, GridPoint b, long double part) {
  const auto between = [part](std::int32_t from, std::int32_t to) {
    return static_cast<std::int32_t>(
        std::llround(from + part * (static_cast<long double>(to) - static_cast<long double>(from))));
  };
  return {between(a.x, b.x), between(a.y, b.y), between(a.z, b.z)};
}

class PartBuilder {
 public:
  PartBuilder(MeshPart& part, bool named) : part_(part), named_(named) {}

  void add(const FacetMesh& mesh, FacetId facet, std::array<GridPoint, 3> corners,
           const std::array<PartCorner, 3>& where) {
    std::array<VertexId, 3> vertices{};
    for (std::size_t k = 0; k < 3; ++k) {
      const auto id = static_cast<VertexId>(part_.mesh.vertices.size());
      const PartVertex of{mesh.facets[facet][where[k].from], mesh.facets[facet][where[k].to]};
      bool is_new = false;
      if (named_) {
        const auto [at, added] = named_ids_.emplace(of, id);
        vertices[k] = at->second;
        is_new = added;
        if (added) part_.vertex.push_back(of);
      } else {
        const auto [at, added] = ids_.emplace(corners[k], id);
        vertices[k] = at->second;
        is_new = added;
      }
      if (is_new) part_.mesh.vertices.push_back(corners[k]);
    }
    part_.mesh.facets.push_back(vertices);
    part_.mesh.material.push_back(mesh.material[facet]);
    part_.mesh.component.push_back(mesh.component[facet]);
    part_.origin.push_back(facet);
  }

 private:
  MeshPart& part_;
  bool named_;
  std::unordered_map<GridPoint, VertexId, GridPointHash> ids_;
  std::map<PartVertex, VertexId> named_ids_;
};

}  // namespace

MirrorPlane MirrorPlane::horizontal(std::int32_t height) { return {{0, 0, -1}, -Int128(height)}; }

MirrorPlane MirrorPlane::of_facet(const FacetMesh& mesh, FacetId facet, GridPoint seen_from) {
  const auto& [a, b, c] = mesh.facets[facet];
  const GridPoint origin = mesh.vertices[a];
  MirrorPlane plane;
  plane.normal = cross(mesh.vertices[b] - origin, mesh.vertices[c] - origin);
  const std::int64_t divisor = std::gcd(std::gcd(plane.normal.x, plane.normal.y), plane.normal.z);
  if (divisor != 0)
    plane.normal = {plane.normal.x / divisor, plane.normal.y / divisor, plane.normal.z / divisor};
  plane.offset = dot(plane.normal, origin);
  if (plane.side(seen_from) < 0) {
    plane.normal = {-plane.normal.x, -plane.normal.y, -plane.normal.z};
    plane.offset = -plane.offset;
  }
  return plane;
}

GridPoint MirrorPlane::image(GridPoint p) const {
  const long double x = static_cast<long double>(normal.x), y = static_cast<long double>(normal.y),
                    z = static_cast<long double>(normal.z);
  const long double twice = -2 * (static_cast<long double>(side(p)) / (x * x + y * y + z * z));
  const auto moved = [twice](std::int32_t from, long double along) {
    const long double to = from + twice * along;
    if (!(std::abs(to) <= std::numeric_limits<std::int32_t>::max()))
      throw GridRangeError(
          "a mirrored apex lies outside of the world grid: the unit of the grid is too fine");
    return static_cast<std::int32_t>(std::llround(to));
  };
  return {moved(p.x, x), moved(p.y, y), moved(p.z, z)};
}

glm::dvec3 MirrorPlane::unit_normal() const {
  const long double x = static_cast<long double>(normal.x), y = static_cast<long double>(normal.y),
                    z = static_cast<long double>(normal.z), length = std::sqrt(x * x + y * y + z * z);
  return {double(x / length), double(y / length), double(z / length)};
}

glm::dmat3 MirrorPlane::reflection() const {
  return glm::dmat3(1) - 2.0 * glm::outerProduct(unit_normal(), unit_normal());
}

bool operator<(const MirrorPlane& a, const MirrorPlane& b) {
  if (a.normal.x != b.normal.x) return a.normal.x < b.normal.x;
  if (a.normal.y != b.normal.y) return a.normal.y < b.normal.y;
  if (a.normal.z != b.normal.z) return a.normal.z < b.normal.z;
  return a.offset < b.offset;
}

MeshPart in_front_of(const MirrorPlane& plane, const FacetMesh& mesh, std::span<const FacetId> facets,
                     std::vector<std::array<PartCorner, 3>>* corners, bool named) {
  MeshPart part;
  PartBuilder builder(part, named);
  for (const FacetId facet : facets) {
    stop_if_wanted();
    std::array<GridPoint, 3> corner{};
    std::array<Int128, 3> side{};
    for (std::size_t k = 0; k < 3; ++k) {
      corner[k] = mesh.vertices[mesh.facets[facet][k]];
      side[k] = plane.side(corner[k]);
    }
    const auto in_front = std::count_if(side.begin(), side.end(), [](Int128 s) { return s > 0; });
    const auto behind = std::count_if(side.begin(), side.end(), [](Int128 s) { return s < 0; });
    if (in_front == 0) continue;
    if (behind == 0) {
      constexpr std::array whole{PartCorner{0, 0, 0}, PartCorner{1, 1, 0}, PartCorner{2, 2, 0}};
      builder.add(mesh, facet, corner, whole);
      if (corners != nullptr) corners->push_back(whole);
      continue;
    }
    std::vector<GridPoint> kept;
    std::vector<PartCorner> where;
    const auto cut = [&](std::size_t front, std::size_t back) {
      const long double way = part_of_way(side[front], side[back]);
      kept.push_back(cut_of(corner[front], corner[back], way));
      where.push_back({front, back, way});
    };
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t next = (k + 1) % 3;
      if (side[k] >= 0) {
        kept.push_back(corner[k]);
        where.push_back({k, k, 0});
      }
      if (side[k] > 0 && side[next] < 0) cut(k, next);
      if (side[k] < 0 && side[next] > 0) cut(next, k);
    }
    for (std::size_t k = 2; k < kept.size(); ++k)
      if (!is_degenerate(kept[0], kept[k - 1], kept[k])) {
        builder.add(mesh, facet, {kept[0], kept[k - 1], kept[k]}, {where[0], where[k - 1], where[k]});
        if (corners != nullptr) corners->push_back({where[0], where[k - 1], where[k]});
      }
  }
  return part;
}

}  // namespace tubefoot
