// SPDX-License-Identifier: GPL-3.0-or-later
// Fuzzes the kernel: the input describes a tube and some facets. The tube must close, and all three exact
// arithmetics must agree. For each plane the visible area must equal that of cone subtraction in plain
// rationals.
#include <array>
#include <map>
#include <vector>

#include "fixtures/geometry/exact_oracles.hpp"
#include "fuzz.hpp"
#include "geometry/visibility/closure.hpp"
#include "geometry/visibility/visibility.hpp"

namespace tubefoot::fuzz {
namespace {

using namespace test;

constexpr std::int32_t range_end = 1 << WorldGrid::coordinate_bits;
constexpr std::size_t most_facets = 12;

/// Coordinates of mixed magnitudes: small numbers, powers of two and their neighbours, and arbitrary
/// numbers.
std::int32_t coordinate(Bytes& bytes) {
  const auto kind = bytes.take<std::uint8_t>();
  const std::int32_t sign = (kind & 1) != 0 ? -1 : 1;
  const auto shift = static_cast<int>(kind >> 3);
  switch (kind >> 1 & 3) {
    case 0:
      return sign * bytes.take<std::uint8_t>() % 8;
    case 1:
      return sign *
             std::min((std::int32_t{1} << std::min(shift, 30)) + bytes.take<std::int8_t>() % 2, range_end);
    case 2:
      return sign * (bytes.take<std::uint16_t>() << std::min(shift, 14));
    default:
      return sign * static_cast<std::int32_t>(bytes.take<std::uint32_t>() % (std::uint32_t(range_end) + 1));
  }
}

GridPoint point(Bytes& bytes) {
  const std::int32_t x = coordinate(bytes), y = coordinate(bytes);
  return {x, y, coordinate(bytes)};
}

int orientation(GridPoint a, GridPoint b, GridPoint c) {
  return sign_of(scalar_product(vec(a), vector_product(vec(b), vec(c))));
}

bool is_pyramid(const std::vector<GridPoint>& rays) {
  for (std::size_t k = 0; k < 4; ++k)
    for (std::size_t other = 2; other < 4; ++other)
      if (orientation(rays[k], rays[(k + 1) % 4], rays[(k + other) % 4]) <= 0) return false;
  return true;
}

/// Rays about y: (x0, y, z0) to (x1, y, z1), each optionally displaced a little.
std::vector<GridPoint> rays_of(Bytes& bytes) {
  const auto kind = bytes.take<std::uint8_t>();
  if (kind % 4 == 3) {
    std::vector<GridPoint> rays;
    for (int k = 0; k < 4; ++k) rays.push_back(point(bytes));
    return rays;
  }
  std::array<std::int32_t, 5> v{};
  for (std::int32_t& one : v) one = coordinate(bytes);
  std::int32_t x0 = v[0], x1 = v[1], z0 = v[2], z1 = v[3];
  const std::int32_t y = std::max(std::abs(v[4]), 1);
  if (x0 > x1) std::swap(x0, x1);
  if (z0 > z1) std::swap(z0, z1);
  std::vector<GridPoint> rays{{x0, y, z0}, {x1, y, z0}, {x1, y, z1}, {x0, y, z1}};
  if (orientation(rays[0], rays[1], rays[2]) < 0) std::swap(rays[1], rays[3]);
  if (kind % 4 == 2)
    for (GridPoint& ray : rays) {
      const auto move = [&](std::int32_t c) {
        return std::clamp(c + bytes.take<std::int8_t>() % 4, -range_end, range_end);
      };
      ray.x = move(ray.x), ray.y = move(ray.y), ray.z = move(ray.z);
    }
  return rays;
}

struct Case {
  FacetMesh mesh;
  TubeSet tubes;
};

/// A vertex relative to the apex: a new one, an earlier one, on a ray, or between two earlier ones or next
/// to one.
GridPoint vertex(Bytes& bytes, const std::vector<GridPoint>& earlier, const std::vector<GridPoint>& rays) {
  const std::uint32_t kind = bytes.below(8);
  if (kind < 3 || earlier.empty()) return point(bytes);
  const GridPoint a = earlier[bytes.below(static_cast<std::uint32_t>(earlier.size()))];
  if (kind == 3) return a;
  const auto combined = [](GridPoint p, GridPoint q, int s, int t) {
    const auto one = [&](std::int64_t u, std::int64_t v) {
      return static_cast<std::int32_t>(
          std::clamp<std::int64_t>((s * u + t * v) / (s + t == 0 ? 1 : s + t), -range_end, range_end));
    };
    return GridPoint{one(p.x, q.x), one(p.y, q.y), one(p.z, q.z)};
  };
  if (kind == 4) return combined(a, earlier[bytes.below(static_cast<std::uint32_t>(earlier.size()))], 1, 1);
  if (kind == 5) {  // beyond it, or before it
    const GridPoint b = earlier[bytes.below(static_cast<std::uint32_t>(earlier.size()))];
    const int s = bytes.take<std::int8_t>() % 4;
    return combined(a, b, s, 1 - s);
  }
  if (kind == 6) {  // on a wall or a ray
    const std::uint32_t k = bytes.below(4);
    return combined(rays[k], rays[(k + bytes.below(2)) % 4], 1, 1);
  }
  const auto near = [&](std::int32_t c) {
    return std::clamp(c + bytes.take<std::int8_t>() % 3, -range_end, range_end);
  };
  const std::int32_t x = near(a.x), y = near(a.y);
  return {x, y, near(a.z)};
}

Case case_of(Bytes& bytes) {
  Case made;
  made.tubes.reach = 1e12;
  made.tubes.rays = rays_of(bytes);
  made.tubes.tubes = {{0, 1, 2, 3}};
  std::vector<GridPoint> corners;
  const GridPoint apex = bytes.below(2) == 0 ? GridPoint{} : point(bytes);
  while (!bytes.empty() && corners.size() < 3 * most_facets)
    for (int k = 0; k < 3; ++k) corners.push_back(vertex(bytes, corners, made.tubes.rays));
  made.tubes.apex = apex;
  std::map<GridPoint, VertexId> welded;
  for (std::size_t c = 0; c < corners.size(); ++c) {
    const auto fits = [](std::int32_t a, std::int32_t d) {
      return std::abs(std::int64_t{a} + d) <= INT32_MAX;
    };
    const GridPoint d = corners[c];
    if (!fits(apex.x, d.x) || !fits(apex.y, d.y) || !fits(apex.z, d.z)) return {};
    const GridPoint p{apex.x + d.x, apex.y + d.y, apex.z + d.z};
    const auto [place, is_new] = welded.try_emplace(p, static_cast<VertexId>(made.mesh.vertices.size()));
    if (is_new) made.mesh.vertices.push_back(p);
    if (c % 3 == 0) made.mesh.facets.emplace_back();
    made.mesh.facets.back()[c % 3] = place->second;
  }
  made.mesh.material.resize(made.mesh.facets.size());
  made.mesh.component.resize(made.mesh.facets.size());
  return made;
}

using Pieces = std::vector<Cone>;

bool is_flat(const Cone& cone) {
  for (std::size_t k = 2; k < cone.size(); ++k)
    if (scalar_product(cone[0], vector_product(cone[k - 1], cone[k])) != 0) return false;
  return true;
}

/// Returns the part outside of a convex cone, which its walls define.
Pieces without(const Pieces& pieces, const std::vector<V3>& walls) {
  Pieces rest;
  for (const Cone& piece : pieces) {
    Cone inside = piece;
    Pieces parts;
    for (const V3& wall : walls) {
      Cone outside = clipped(inside, times(-1, wall));
      if (!is_flat(outside)) parts.push_back(std::move(outside));
      inside = clipped(inside, wall);
      if (is_flat(inside)) break;
    }
    if (is_flat(inside)) parts = {piece};  // they do not meet: no cut is necessary
    rest.insert(rest.end(), parts.begin(), parts.end());
  }
  return rest;
}

/// Visible areas in the gnomonic plane of the tube. Facets of one plane count together under the first of
/// them.
std::map<FacetId, Q> expected_areas(const Case& made, const GnomonicPlane& plane,
                                    std::vector<FacetId>& leader) {
  const std::vector<V3> walls = walls_of(cone_of(made.tubes, 0));
  std::vector<std::optional<SeenFrom>> seen;
  for (FacetId f = 0; f < made.mesh.facets.size(); ++f) {
    seen.push_back(seen_from(made.mesh, f, made.tubes.apex));
    leader.push_back(f);
    for (FacetId earlier = 0; seen[f] && earlier < f && leader[f] == f; ++earlier)
      if (seen[earlier] && same_plane(*seen[earlier], *seen[f])) leader[f] = earlier;
  }
  std::map<FacetId, Q> areas;
  for (FacetId f = 0; f < seen.size(); ++f) {
    if (!seen[f]) continue;
    Pieces visible{clipped(Cone(seen[f]->vertex.begin(), seen[f]->vertex.end()), walls)};
    for (FacetId other = 0; other < seen.size(); ++other) {
      if (!seen[other] || other == f) continue;
      const bool together = leader[other] == leader[f];
      if (together && other > f) continue;
      std::vector<V3> hidden(seen[other]->inward.begin(), seen[other]->inward.end());
      if (!together) hidden.push_back(nearer_side(*seen[f], *seen[other]));
      visible = without(visible, hidden);
    }
    Q& area = areas[leader[f]];
    for (const Cone& piece : visible)
      if (piece.size() > 2) area += plane.area(piece);
  }
  std::erase_if(areas, [](const auto& one) { return one.second == 0; });
  return areas;
}

void check(const Case& made) {
  const SceneTree tree(made.mesh);
  TopologyHash hash;
  for (const Arithmetic arithmetic : {Arithmetic::fixed, Arithmetic::filtered, Arithmetic::rational}) {
    VisibilityScratch scratch;
    TubeVisibility seen;
    VisibilityOptions options;
    options.arithmetic = arithmetic;
    options.open_water = true;
    if (made.mesh.facets.size() % 2 == 1) options.facets_per_split = 3;
    see(made.mesh, tree, made.tubes, 0, options, scratch, seen);
    const TubeAudit found = audit(made.mesh, made.tubes, 0, seen, 1);
    const std::string name(name_of(arithmetic));
    if (!found.closes) finding("it does not close in the arithmetic " + name);
    if (arithmetic != Arithmetic::fixed) {
      if (found.hash != hash) finding("fixed sees other areas than " + name);
      continue;
    }
    hash = found.hash;
    const GnomonicPlane plane(axis_of(cone_of(made.tubes, 0)));
    std::vector<FacetId> leader;
    const std::map<FacetId, Q> expected = expected_areas(made, plane, leader);
    std::map<FacetId, Q> areas;
    for (const NamedPiece& piece : seen.pieces)
      areas[leader.at(piece.facet)] += plane.area(cone_of(made.mesh, made.tubes.apex, seen, piece));
    if (areas != expected) finding("it sees other areas than the cones that are left");
  }
}

}  // namespace
}  // namespace tubefoot::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace tubefoot;
  const fuzz::TimeLimit limit;
  fuzz::Bytes bytes(data, size);
  const fuzz::Case made = fuzz::case_of(bytes);
  if (made.mesh.facets.empty() || !fuzz::is_pyramid(made.tubes.rays)) return 0;
  fuzz::check(made);
  return 0;
}
