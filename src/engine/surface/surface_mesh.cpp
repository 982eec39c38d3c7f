// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/surface/surface_mesh.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numeric>

#include "geometry/mesh/vertex_normals.hpp"
#include "geometry/search/vertical_line.hpp"
#include "geometry/steps/stop.hpp"

// Refines and displaces the seabed with its macro-texture. The rules cut textured edges that are longer than
// a cell, and, for transmissions, only where omitted_change() exceeds the tolerance. See
// docs/notes/textures.md, section "Refinement".
namespace tubefoot {
namespace {

std::uint64_t edge_key(VertexId a, VertexId b) {
  return std::uint64_t{std::min(a, b)} << 32 | std::max(a, b);
}

double length2(glm::dvec3 v) { return v.x * v.x + v.y * v.y + v.z * v.z; }

/// Returns the corner opposite to the base edge that contains both points; 3: no such edge.
std::size_t common_edge(const BasePoint& a, const BasePoint& b) {
  for (std::size_t k = 0; k < 3; ++k)
    if (a.weight[k] == 0 && b.weight[k] == 0) return k;
  return 3;
}

void insert(std::vector<std::uint16_t>& sorted, std::uint16_t material) {
  const auto at = std::lower_bound(sorted.begin(), sorted.end(), material);
  if (at == sorted.end() || *at != material) sorted.insert(at, material);
}

}  // namespace

/// Cuts edges of textured facets that are longer than a cell.
class SurfaceMesh::Cells : public EdgeRule {
 public:
  explicit Cells(const SurfaceMesh& of) : surface_mesh(of) {}
  bool cuts(const BasePoint& a, const BasePoint& b) const final {
    const double edge2 = length2(a.at_m - b.at_m);
    return edge2 > surface_mesh.settings_.cell_m * surface_mesh.settings_.cell_m && wants(a, b, edge2) &&
           surface_mesh.textured_along(a, b);
  }
  virtual bool wants(const BasePoint&, const BasePoint&, double) const { return true; }

 protected:
  const SurfaceMesh& surface_mesh;
};

struct SurfaceMesh::Seen : Cells {
  Seen(const SurfaceMesh& g, std::span<const Look> l) : Cells(g), looks(l) {
    for (const Look& look : looks) {
      sectors.emplace_back(*look.tubes, g.grid_.unit_m());
      apexes.push_back(g.grid_.to_metres(look.tubes->apex));
    }
  }

  bool wants(const BasePoint& a, const BasePoint& b, double edge2) const override {
    if (surface_mesh.mirrors_along(a, b)) return true;
    const glm::dvec3 middle = 0.5 * (a.at_m + b.at_m);
    const double length = std::sqrt(edge2),
                 lift = surface_mesh.omitted_.largest_height_m() + surface_mesh.grid_.unit_m();
    for (std::size_t k = 0; k < looks.size(); ++k) {
      const glm::dvec3 from_apex = middle - apexes[k];
      const double radius = 2 * length + lift;
      if (looks[k].view_bounds != nullptr ? !looks[k].view_bounds->may_see(middle, radius)
                                          : !sectors[k].may_meet(from_apex, radius))
        continue;
      if (surface_mesh.settings_.tolerance <= 0) return true;
      Resolution cell;
      cell.range_m = std::max({glm::length(from_apex) - length - lift, looks[k].first_m, looks[k].sample_m});
      cell.sine_grazing = surface_mesh.sine_grazing(a, b, from_apex, length);
      cell.sample_m = looks[k].sample_m;
      cell.beam_rad = looks[k].beam_rad > 0 ? looks[k].beam_rad : sectors[k].narrowest_rad();
      if (omitted_change(surface_mesh.omitted_.at(edge2), edge2, cell) > surface_mesh.settings_.tolerance)
        return true;
    }
    return false;
  }

  std::span<const Look> looks;
  std::vector<Sector> sectors;
  std::vector<glm::dvec3> apexes;
};

struct SurfaceMesh::InLine : Cells {
  InLine(const SurfaceMesh& g, glm::dvec3 place_m) : Cells(g), at(place_m) {}
  bool wants(const BasePoint& a, const BasePoint& b, double edge2) const override {
    const glm::dvec3 middle = 0.5 * (a.at_m + b.at_m);
    return std::hypot(middle.x - at.x, middle.y - at.y) <=
           2 * std::sqrt(edge2) + surface_mesh.omitted_.largest_height_m() + 2 * surface_mesh.grid_.unit_m();
  }
  glm::dvec3 at;
};

SurfaceMesh::SurfaceMesh(const FacetMesh& base, const WorldGrid& grid,
                         std::span<const std::shared_ptr<const ElevationField>> relief,
                         const SurfaceSettings& settings)
    : base_(base),
      grid_(grid),
      relief_(relief.begin(), relief.end()),
      settings_(settings),
      omitted_(relief, settings.cell_m),
      tree_(base, SceneTree::HeightFieldSearch::ignored) {
  find_borders();
  find_normals();
}

void SurfaceMesh::find_borders() {
  // Only vertices with more than one material, and their edges, have entries.
  std::vector<std::uint16_t> first(base_.vertices.size());
  std::vector<bool> met(base_.vertices.size());
  for (FacetId f = 0; f < base_.facets.size(); ++f)
    for (const VertexId v : base_.facets[f]) {
      if (!met[v]) {
        met[v] = true;
        first[v] = base_.material[f];
      } else if (first[v] != base_.material[f]) {
        insert(vertex_materials_[v], first[v]);
        insert(vertex_materials_[v], base_.material[f]);
      }
    }
  if (vertex_materials_.empty()) return;
  for (FacetId f = 0; f < base_.facets.size(); ++f)
    for (std::size_t k = 0; k < 3; ++k) {
      const VertexId a = base_.facets[f][k], b = base_.facets[f][(k + 1) % 3];
      if (vertex_materials_.contains(a) && vertex_materials_.contains(b))
        insert(edge_materials_[edge_key(a, b)], base_.material[f]);
    }
  std::erase_if(edge_materials_, [](const auto& entry) { return entry.second.size() < 2; });
}

void SurfaceMesh::find_normals() {
  normals_.resize(base_.vertices.size());
  const std::vector<glm::dvec3> normals = vertex_normals(base_);
  for (VertexId v = 0; v < normals.size(); ++v) normals_[v].normal = normals[v];
  for (FacetId f = 0; f < base_.facets.size(); ++f) {
    const glm::dvec3 n = doubled_area(base_, f);
    const double length = glm::length(n);
    if (!(length > 0)) continue;
    for (const VertexId v : base_.facets[f]) {
      // The angle is the same for both sides of a facet, like the grazing angle.
      const double chord = std::min(glm::distance(n / length, normals_[v].normal),
                                    glm::distance(-n / length, normals_[v].normal));
      normals_[v].spread_rad = std::max(normals_[v].spread_rad, 2 * std::asin(std::min(1.0, chord / 2)));
    }
  }
}

std::span<const std::uint16_t> SurfaceMesh::materials_at(const BasePoint& point) const {
  const std::span<const std::uint16_t> own(&base_.material[point.facet], 1);
  if (vertex_materials_.empty()) return own;
  const auto& corner = base_.facets[point.facet];
  for (std::size_t k = 0; k < 3; ++k) {
    if (point.weight[k] == 1) {
      const auto found = vertex_materials_.find(corner[k]);
      return found == vertex_materials_.end() ? own : found->second;
    }
  }
  for (std::size_t k = 0; k < 3; ++k) {
    if (point.weight[k] != 0) continue;
    const auto found = edge_materials_.find(edge_key(corner[(k + 1) % 3], corner[(k + 2) % 3]));
    return found == edge_materials_.end() ? own : found->second;
  }
  return own;
}

bool SurfaceMesh::textured_at(const BasePoint& point) const {
  const auto materials = materials_at(point);
  return std::any_of(materials.begin(), materials.end(), [&](std::uint16_t m) { return textured(m); });
}

std::span<const std::uint16_t> SurfaceMesh::materials_along(const BasePoint& a, const BasePoint& b) const {
  const std::span<const std::uint16_t> own(&base_.material[a.facet], 1);
  const std::size_t k = common_edge(a, b);
  if (k == 3 || edge_materials_.empty()) return own;
  const auto& corner = base_.facets[a.facet];
  const auto found = edge_materials_.find(edge_key(corner[(k + 1) % 3], corner[(k + 2) % 3]));
  return found == edge_materials_.end() ? own : found->second;
}

bool SurfaceMesh::textured_along(const BasePoint& a, const BasePoint& b) const {
  // A flat facet is cut where an edge ends on relief, so that the influence of the relief's border ends
  // there too.
  if (textured_at(a) || textured_at(b)) return true;
  return textured(base_.material[a.facet]) &&
         std::ranges::any_of(materials_along(a, b), [&](std::uint16_t m) { return textured(m); });
}

bool SurfaceMesh::mirrors_along(const BasePoint& a, const BasePoint& b) const {
  return !settings_.mirrors.empty() &&
         std::ranges::any_of(materials_along(a, b), [&](std::uint16_t m) { return mirrors(m); });
}

double SurfaceMesh::sine_grazing(const BasePoint& a, const BasePoint& b, glm::dvec3 from_apex,
                                 double radius_m) const {
  const double range = glm::length(from_apex);
  const auto lowest = [&](glm::dvec3 normal, double spread_rad) {
    return std::max(0.0,
                    (std::abs(glm::dot(normal, from_apex)) - radius_m) / (range + radius_m) - spread_rad);
  };
  const std::size_t k = common_edge(a, b);
  if (k == 3) {
    const glm::dvec3 n = doubled_area(base_, a.facet);
    const double length = glm::length(n);
    return length > 0 ? lowest(n / length, 0) : 0;
  }
  const auto& corner = base_.facets[a.facet];
  const VertexNormal &p = normals_[corner[(k + 1) % 3]], &q = normals_[corner[(k + 2) % 3]];
  return std::min(lowest(p.normal, p.spread_rad), lowest(q.normal, q.spread_rad));
}

glm::dvec3 SurfaceMesh::place(const BasePoint& point) const {
  double sum = 0;
  const auto materials = materials_at(point);
  for (const std::uint16_t m : materials)
    if (relief_[m]) sum += relief_[m]->height_m(point.at_m);
  const double height = sum / static_cast<double>(materials.size());
  if (settings_.displacement == Displacement::vertical) return point.at_m + glm::dvec3{0, 0, height};
  // If one of the three terms is zero, omitting it makes the sum independent of the order of an edge's ends.
  glm::dvec3 normal{0};
  for (std::size_t k = 0; k < 3; ++k)
    if (point.weight[k] != 0) normal += point.weight[k] * normals_[base_.facets[point.facet][k]].normal;
  const double length = glm::length(normal);
  return length > 0 ? point.at_m + height / length * normal : point.at_m;
}

RefinedMesh SurfaceMesh::refined(std::span<const FacetId> facets, const EdgeRule& rule,
                                 const RefinementLimits& limits) const {
  return refine(
      base_, facets, grid_, rule, [this](const BasePoint& p) { return place(p); }, limits);
}

RefinedMesh SurfaceMesh::everywhere(const RefinementLimits& limits) const {
  std::vector<FacetId> all(base_.facets.size());
  std::iota(all.begin(), all.end(), 0u);
  return everywhere(all, limits);
}

RefinedMesh SurfaceMesh::everywhere(std::span<const FacetId> facets, const RefinementLimits& limits) const {
  // The count is checked first, because the refinement up to the limit would take long.
  std::size_t count = 0;
  for (const FacetId f : facets) {
    stop_if_wanted();
    if (textured(base_.material[f])) count += tubefoot::uniform_count(base_, f, grid_, settings_.cell_m);
    if (count > limits.facets)
      throw RefinementTooLarge(fmt::format("the refinement creates more than {} facets", limits.facets));
  }
  return refined(facets, Cells(*this), limits);
}

RefinedMesh SurfaceMesh::seen_by(std::span<const Look> looks, const RefinementLimits& limits) const {
  const Seen rule(*this, looks);
  std::vector<FacetId> facets;
  const double lift = omitted_.largest_height_m() + grid_.unit_m();
  for (std::size_t k = 0; k < looks.size(); ++k) {
    const std::vector<FacetId> some = looks[k].view_bounds != nullptr
                                          ? looks[k].view_bounds->facets(base_, tree_, grid_, lift)
                                          : rule.sectors[k].facets(tree_, lift);
    facets.insert(facets.end(), some.begin(), some.end());
  }
  std::sort(facets.begin(), facets.end());
  facets.erase(std::unique(facets.begin(), facets.end()), facets.end());
  return refined(facets, rule, limits);
}

RefinedMesh SurfaceMesh::mirrors_within(glm::dvec3 place_m, double distance_m,
                                        const RefinementLimits& limits) const {
  std::vector<FacetId> facets;
  tree_.query(grid_.snap(place_m), std::span<const SceneTree::HalfSpace>(), distance_m / grid_.unit_m(),
              omitted_.largest_height_m() / grid_.unit_m() + 1, facets);
  std::erase_if(facets, [&](FacetId f) { return !mirrors(base_.material[f]); });
  std::ranges::sort(facets);
  return refined(facets, Cells(*this), limits);
}

RefinedMesh SurfaceMesh::in_line_with(glm::dvec3 place_m) const {
  std::vector<FacetId> facets;
  const double margin = omitted_.largest_height_m() / grid_.unit_m() + 1;
  facets_near_vertical(tree_, grid_.snap(place_m), margin, facets);
  std::sort(facets.begin(), facets.end());
  return refined(facets, InLine(*this, place_m), {});
}

std::size_t SurfaceMesh::uniform_count() const {
  std::size_t sum = 0;
  for (FacetId f = 0; f < base_.facets.size(); ++f) {
    stop_if_wanted();
    if (textured(base_.material[f])) sum += tubefoot::uniform_count(base_, f, grid_, settings_.cell_m);
  }
  return sum;
}

}  // namespace tubefoot
