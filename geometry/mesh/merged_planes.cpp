// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/mesh/merged_planes.hpp"

// Groups facets by exact plane, removes the edges between them and triangulates the remaining border polygon
// with a constrained Delaunay triangulation. The areas before and after are compared as integers. A plane
// that fails any test stays unchanged.

#define CGAL_NO_CDT_2_WARNING
#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <bit>
#include <numeric>
#include <optional>
#include <span>
#include <tuple>
#include <unordered_map>
#include <utility>

#include "geometry/mesh/facet_cone.hpp"
#include "geometry/steps/stop.hpp"

namespace tubefoot {
namespace {

using Triangle = std::array<VertexId, 3>;
using Edge = std::array<VertexId, 2>;

/// Planes with fewer facets are not processed.
constexpr std::size_t fewest_facets = 8;

/// A facet's plane, material and component, which are equal for facets that may be merged. The plane is
/// normal . x = offset. The normal has no common divisor and points to the side that the facet faces.
struct PlaneKey {
  Vec64 normal;
  Int128 offset{};
  std::uint16_t material = 0, component = 0;
  FacetId facet = 0;

  auto plane() const { return std::tie(normal.x, normal.y, normal.z, offset, material, component); }
};

Vec64 normal_of(const FacetMesh& mesh, FacetId facet) {
  const Triangle& t = mesh.facets[facet];
  const GridPoint a = mesh.vertices[t[0]];
  return cross(mesh.vertices[t[1]] - a, mesh.vertices[t[2]] - a);
}

PlaneKey key_of(const FacetMesh& mesh, FacetId facet) {
  Vec64 n = normal_of(mesh, facet);
  const std::int64_t divisor = std::gcd(std::gcd(n.x, n.y), n.z);
  n = {n.x / divisor, n.y / divisor, n.z / divisor};
  return {n, dot(n, mesh.vertices[mesh.facets[facet][0]]), mesh.material[facet], mesh.component[facet],
          facet};
}

/// Returns the axis along which a nonzero normal is longest; the first of equal ones.
unsigned longest_axis(const Vec64& normal) {
  const auto size = [](std::int64_t x) { return x < 0 ? -x : x; };
  unsigned axis = size(normal.y) > size(normal.x) ? 1 : 0;
  if (size(normal.z) > std::max(size(normal.x), size(normal.y))) axis = 2;
  return axis;
}

std::int64_t along(const Vec64& v, unsigned axis) { return axis == 0 ? v.x : axis == 1 ? v.y : v.z; }

/// Returns a hash that is equal for facets that face the same way and have the same component and material.
/// The hash of a facet without area is 0. A long double holds the integers, so their quotients are rounded
/// once and multiples of a normal give the same hash.
std::uint64_t direction_hash(const FacetMesh& mesh, FacetId facet) {
  const Vec64 n = normal_of(mesh, facet);
  if (n.x == 0 && n.y == 0 && n.z == 0) return 0;
  const unsigned axis = longest_axis(n);
  const std::int64_t most = along(n, axis);
  std::uint64_t hash =
      axis + 4u * (most < 0) + 8u * mesh.material[facet] + (std::uint64_t{mesh.component[facet]} << 32);
  for (const unsigned other : {(axis + 1) % 3, (axis + 2) % 3}) {
    const auto slope = static_cast<double>(static_cast<long double>(along(n, other)) / most);
    hash = (hash ^ std::bit_cast<std::uint64_t>(slope + 0.0)) * 0x9e3779b97f4a7c15u;
    hash ^= hash >> 29;
  }
  return hash | 1;
}

/// Returns, per vertex, whether each facet around it has another facet with the same hash there. Only such a
/// vertex can lie inside a plane, or on a straight border of all planes around it. Other vertices are never
/// removed. In terrain nearly all vertices are of this kind.
std::vector<char> vertices_that_may_go(const FacetMesh& mesh, std::span<const std::uint64_t> hashes) {
  std::vector<std::uint32_t> end(mesh.vertices.size() +
                                 1);  // end of each vertex's facets after they are inserted
  for (const Triangle& t : mesh.facets)
    for (const VertexId v : t) ++end[v + 1];
  std::inclusive_scan(end.begin(), end.end(), end.begin());
  // Half of a hash suffices, because equal hashes only lead to a closer examination.
  std::vector<std::uint32_t> about(3 * mesh.facets.size());
  for (std::size_t facet = 0; facet < hashes.size(); ++facet)
    for (const VertexId v : mesh.facets[facet])
      about[end[v]++] = hashes[facet] == 0 ? 0 : static_cast<std::uint32_t>(hashes[facet] >> 32) | 1;
  std::vector<char> may_go(mesh.vertices.size());
  tbb::parallel_for(std::size_t{0}, may_go.size(), [&](std::size_t v) {
    const std::span<const std::uint32_t> facets(about.begin() + (v == 0 ? 0 : end[v - 1]),
                                                about.begin() + end[v]);
    if (v % 1024 == 0) stop_if_wanted();
    // Vertices with many facets skip the count, because a positive result only leads to a closer examination.
    constexpr std::size_t hub = 64;
    may_go[v] =
        facets.size() > hub || (!facets.empty() && std::ranges::all_of(facets, [&](std::uint32_t hash) {
          return hash != 0 && std::ranges::count(facets, hash) > 1;
        }));
  });
  return may_go;
}

/// Projection of a plane along the axis on which its normal is longest. Its facets turn counter-clockwise in
/// the projection.
class PlanePicture {
 public:
  explicit PlanePicture(const Vec64& normal) {
    const unsigned dropped = longest_axis(normal);
    first_ = (dropped + 1) % 3, second_ = (dropped + 2) % 3;
    if (along(normal, dropped) < 0) std::swap(first_, second_);
  }
  std::array<std::int64_t, 2> of(GridPoint p) const {
    const Vec64 wide{p.x, p.y, p.z};
    return {along(wide, first_), along(wide, second_)};
  }
  /// Exact: differences of grid points have 31 bits.
  Int128 twice_area(GridPoint a, GridPoint b, GridPoint c) const {
    const auto u = of(b - a), v = of(c - a);
    return Int128(u[0]) * v[1] - Int128(u[1]) * v[0];
  }

 private:
  unsigned first_, second_;
};

/// The facets of one plane that may become a polygon.
struct Plane {
  Vec64 normal;
  std::vector<FacetId> facets;
  std::vector<Edge> border{};  ///< by start vertex; the interior is on the left
  bool merged = true;
  std::vector<Triangle> triangles{};
};

/// Returns the border edges, sorted by their start. Returns nothing if two facets have an edge in the same
/// direction, because such facets overlap.
std::optional<std::vector<Edge>> border_of(const FacetMesh& mesh, std::span<const FacetId> facets) {
  std::vector<Edge> edges;
  edges.reserve(3 * facets.size());
  for (const FacetId facet : facets)
    for (unsigned k = 0; k < 3; ++k)
      edges.push_back({mesh.facets[facet][k], mesh.facets[facet][(k + 1) % 3]});
  std::ranges::sort(edges);
  if (std::ranges::adjacent_find(edges) != edges.end()) return std::nullopt;
  std::vector<Edge> border;
  for (const Edge& edge : edges)
    if (!std::ranges::binary_search(edges, Edge{edge[1], edge[0]})) border.push_back(edge);
  return border;
}

std::span<const Edge> edges_from(const std::vector<Edge>& border, VertexId start) {
  const auto begin = std::ranges::lower_bound(border, Edge{start, 0});
  auto end = begin;
  while (end != border.end() && (*end)[0] == start) ++end;
  return {begin, end};
}

/// Returns whether b lies on the straight line from a to c, between them. Exact.
bool is_between(GridPoint a, GridPoint b, GridPoint c) {
  const Vec64 n = cross(b - a, c - b);
  if (n.x != 0 || n.y != 0 || n.z != 0) return false;
  const GridPoint u = b - a, v = c - b;
  return Int128(u.x) * v.x + Int128(u.y) * v.y + Int128(u.z) * v.z > 0;
}

using Signs = CGAL::Exact_predicates_inexact_constructions_kernel;
using PlaneCdt = CGAL::Constrained_Delaunay_triangulation_2<
    Signs,
    CGAL::Triangulation_data_structure_2<CGAL::Triangulation_vertex_base_with_info_2<VertexId, Signs>,
                                         CGAL::Constrained_triangulation_face_base_2<Signs>>,
    CGAL::No_constraint_intersection_requiring_constructions_tag>;

/// Returns the triangles that an odd number of border edges separates from the outside. Returns nothing if
/// edges cross, because the facets then overlap.
std::optional<std::vector<Triangle>> triangulated(const FacetMesh& mesh, const std::vector<Edge>& border,
                                                  const PlanePicture& picture) {
  PlaneCdt cdt;
  std::unordered_map<VertexId, PlaneCdt::Vertex_handle> placed;
  const GridPoint middle = mesh.vertices[border.front()[0]];
  PlaneCdt::Vertex_handle last;  // the next vertex is near it
  const auto place = [&](VertexId v) {
    const auto [found, is_new] = placed.try_emplace(v);
    if (is_new) {
      const auto at = picture.of(mesh.vertices[v] - middle);
      found->second = cdt.insert(PlaneCdt::Point(static_cast<double>(at[0]), static_cast<double>(at[1])),
                                 last == PlaneCdt::Vertex_handle() ? PlaneCdt::Face_handle() : last->face());
      found->second->info() = v;
      last = found->second;
    }
    return found->second;
  };
  try {
    for (const Edge& edge : border) {
      stop_if_wanted();
      const PlaneCdt::Vertex_handle from = place(edge[0]), to = place(edge[1]);
      cdt.insert_constraint(from, to);
    }
  } catch (const PlaneCdt::Intersection_of_constraints_exception&) {
    return std::nullopt;
  }
  if (cdt.dimension() < 2) return std::nullopt;
  std::unordered_map<PlaneCdt::Face_handle, bool> inside;
  std::vector<std::pair<PlaneCdt::Face_handle, bool>> reached{{cdt.infinite_face(), false}};
  std::vector<Triangle> triangles;
  while (!reached.empty()) {
    const auto [face, is_inside] = reached.back();
    reached.pop_back();
    if (!inside.try_emplace(face, is_inside).second) continue;
    if (is_inside && cdt.is_infinite(face)) return std::nullopt;
    if (is_inside)
      triangles.push_back({face->vertex(0)->info(), face->vertex(1)->info(), face->vertex(2)->info()});
    for (int k = 0; k < 3; ++k) reached.emplace_back(face->neighbor(k), is_inside != face->is_constrained(k));
  }
  return triangles;
}

class PlaneMerger {
 public:
  explicit PlaneMerger(const FacetMesh& mesh) : mesh_(mesh) {}

  std::optional<FacetMesh> merged() {
    find_planes();
    // Facets that stay unchanged keep their corners, which may lie on the borders of other planes.
    for (bool settled = planes_.empty(); !settled;) {
      pin_corners();
      settled = true;
      for (Plane& plane : planes_)
        if (plane.merged && !merge(plane)) plane.merged = settled = false;
    }
    if (std::ranges::none_of(planes_, &Plane::merged)) return std::nullopt;
    return result();
  }

 private:
  void find_planes() {
    struct Named {
      std::uint64_t hash;
      FacetId facet;
      auto operator<=>(const Named&) const = default;
    };
    std::vector<std::uint64_t> hashes(mesh_.facets.size());
    tbb::parallel_for(std::size_t{0}, hashes.size(), [&](std::size_t facet) {
      hashes[facet] = direction_hash(mesh_, static_cast<FacetId>(facet));
    });
    const std::vector<char> may_go = vertices_that_may_go(mesh_, hashes);
    std::vector<Named> named;
    for (std::size_t facet = 0; facet < hashes.size(); ++facet)
      if (std::ranges::any_of(mesh_.facets[facet], [&](VertexId v) { return may_go[v] != 0; }))
        named.push_back({hashes[facet], static_cast<FacetId>(facet)});
    tbb::parallel_sort(named);
    std::vector<PlaneKey> alike;
    for (auto first = named.begin(); first != named.end();) {
      stop_if_wanted();
      const auto last =
          std::find_if(first, named.end(), [&](const Named& n) { return n.hash != first->hash; });
      if (first->hash != 0 && static_cast<std::size_t>(last - first) >= fewest_facets) {
        alike.clear();
        for (auto n = first; n != last; ++n) alike.push_back(key_of(mesh_, n->facet));
        add_planes(alike);
      }
      first = last;
    }
  }

  void add_planes(std::vector<PlaneKey>& alike) {
    std::ranges::stable_sort(alike, {}, &PlaneKey::plane);
    for (auto first = alike.begin(); first != alike.end();) {
      const auto last = std::find_if(first, alike.end(),
                                     [&](const PlaneKey& key) { return key.plane() != first->plane(); });
      if (static_cast<std::size_t>(last - first) >= fewest_facets) {
        Plane plane{first->normal, {}};
        for (auto key = first; key != last; ++key) plane.facets.push_back(key->facet);
        if (auto border = border_of(mesh_, plane.facets)) {
          plane.border = std::move(*border);
          planes_.push_back(std::move(plane));
        }
      }
      first = last;
    }
  }

  /// Marks vertices that stay: corners of facets that are not merged, and corners at which a border turns.
  void pin_corners() {
    pinned_.assign(mesh_.vertices.size(), false);
    std::vector<bool> in_plane(mesh_.facets.size(), false);
    for (const Plane& plane : planes_)
      if (plane.merged)
        for (const FacetId facet : plane.facets) in_plane[facet] = true;
    for (std::size_t facet = 0; facet < mesh_.facets.size(); ++facet)
      if (!in_plane[facet])
        for (const VertexId v : mesh_.facets[facet]) pinned_[v] = true;
    for (const Plane& plane : planes_) {
      if (!plane.merged) continue;
      for (const auto& [from, to] : plane.border) {
        const std::span<const Edge> onward = edges_from(plane.border, to);
        if (onward.size() != 1 ||
            !is_between(mesh_.vertices[from], mesh_.vertices[to], mesh_.vertices[onward.front()[1]]))
          pinned_[to] = true;
      }
    }
  }

  /// Returns the border with straight edges between pinned vertices.
  std::vector<Edge> mapped(const std::vector<Edge>& border) const {
    std::vector<Edge> straight;
    for (Edge edge : border) {
      if (!pinned_[edge[0]]) continue;
      while (!pinned_[edge[1]]) edge[1] = edges_from(border, edge[1]).front()[1];
      straight.push_back(edge);
    }
    return straight;
  }

  bool merge(Plane& plane) const {
    stop_if_wanted();
    const std::vector<Edge> border = mapped(plane.border);
    // A polygon of n corners has at least n - 2 triangles, and each separate piece has at least three
    // corners.
    if (border.size() > 3 * plane.facets.size() / 2) return false;
    const PlanePicture picture(plane.normal);
    const auto twice_area = [&](const Triangle& t) {
      return picture.twice_area(mesh_.vertices[t[0]], mesh_.vertices[t[1]], mesh_.vertices[t[2]]);
    };
    std::optional<std::vector<Triangle>> triangles = triangulated(mesh_, border, picture);
    if (!triangles || 2 * triangles->size() > plane.facets.size()) return false;
    Int128 before = 0, after = 0;
    for (const FacetId facet : plane.facets) before += twice_area(mesh_.facets[facet]);
    for (const Triangle& t : *triangles) after += twice_area(t);
    if (before != after) return false;
    for (Triangle& t : *triangles) std::rotate(t.begin(), std::ranges::min_element(t), t.end());
    std::ranges::sort(*triangles);
    plane.triangles = std::move(*triangles);
    return true;
  }

  FacetMesh result() const {
    constexpr std::uint32_t as_it_was = 0, gone = 1, first_plane = 2;
    std::vector<std::uint32_t> becomes(mesh_.facets.size(), as_it_was);
    for (std::uint32_t p = 0; p < planes_.size(); ++p) {
      if (!planes_[p].merged) continue;
      for (const FacetId facet : planes_[p].facets) becomes[facet] = gone;
      becomes[planes_[p].facets.front()] = first_plane + p;
    }
    FacetMesh merged;
    merged.vertices = mesh_.vertices;
    const auto add = [&](const Triangle& facet, std::size_t like) {
      merged.facets.push_back(facet);
      merged.material.push_back(mesh_.material[like]);
      merged.component.push_back(mesh_.component[like]);
    };
    for (std::size_t facet = 0; facet < mesh_.facets.size(); ++facet) {
      if (becomes[facet] == as_it_was) add(mesh_.facets[facet], facet);
      if (becomes[facet] >= first_plane)
        for (const Triangle& t : planes_[becomes[facet] - first_plane].triangles) add(t, facet);
    }
    return merged;
  }

  const FacetMesh& mesh_;
  std::vector<Plane> planes_;
  std::vector<bool> pinned_;
};

}  // namespace

std::optional<FacetMesh> with_planes_merged(const FacetMesh& mesh) { return PlaneMerger(mesh).merged(); }

}  // namespace tubefoot
