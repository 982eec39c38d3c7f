// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/surface/refracted_surface.hpp"

#include <tbb/concurrent_unordered_map.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <deque>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <optional>
#include <stdexcept>
#include <tuple>
#include <unordered_map>

#include "engine/surface/apparent_images.hpp"
#include "engine/surface/eigenray_branches.hpp"
#include "engine/surface/facet_flattening.hpp"
#include "engine/water/apparent_map.hpp"
#include "geometry/mesh/weld_table.hpp"
#include "geometry/steps/stop.hpp"

// Refines the seabed until its apparent facets meet the settings, maps the vertices to apparent positions,
// and computes the facet factors. Facets with several eigenrays go to EigenrayBranches. See
// docs/notes/refraction.md.
namespace tubefoot {
namespace {

struct PlaceHash {
  std::size_t operator()(const glm::dvec3& p) const {
    std::uint64_t h = 0;
    for (int i = 0; i < 3; ++i)
      h = (std::rotl(h, 21) ^ std::bit_cast<std::uint64_t>(p[i] + 0.0)) * 0x9e3779b97f4a7c15u;
    return h ^ (h >> 32);
  }
};

/// Decides cuts by the images of edges. Each image is computed once.
class GapRule final : public EdgeRule {
 public:
  GapRule(const Images& images, const FacetMesh& base, const WorldGrid& grid)
      : images_(images), base_(base), grid_(grid) {}
  bool cuts(const BasePoint& a, const BasePoint& b) const override {
    // Images of the first ray to arrive may jump. Refinement of such a region next to a long accurate edge
    // might not end without this limit.
    constexpr double most_parts = 1 << (deepest_refinement - 2);
    for (const BasePoint* p : {&a, &b})
      for (const double weight : p->weight)
        if (std::floor(weight * most_parts) != weight * most_parts) return false;
    if (images_.is_long_nearby(a.at_m, b.at_m)) return true;
    bool inside = true;  // not on an edge of the base mesh, where two facets must have the same cuts
    for (std::size_t k = 0; k < 3; ++k) inside = inside && (a.weight[k] != 0 || b.weight[k] != 0);
    if (!images_.concerns(a.at_m, b.at_m, base_, a.facet, grid_, inside)) return false;
    return images_.cuts(a.at_m, b.at_m,
                        [this](const glm::dvec3& p) -> const ApparentImage& { return of(p); });
  }
  const ApparentImage& of(const glm::dvec3& point_m) const {
    const auto known = known_.find(point_m);
    if (known != known_.end()) return known->second;
    return known_.emplace(point_m, images_.make(point_m)).first->second;
  }

 private:
  const Images& images_;
  const FacetMesh& base_;
  const WorldGrid& grid_;
  mutable tbb::concurrent_unordered_map<glm::dvec3, ApparentImage, PlaceHash> known_;
};

/// Returns the facets without cuts. `to_cut` receives the facets with an edge that may need a cut.
FineFacets unrefined(const FacetMesh& base, std::span<const FacetId> facets, const WorldGrid& grid,
                     const Images& images, bool weights, std::vector<FacetId>& to_cut) {
  FineFacets fine;
  std::unordered_map<VertexId, VertexId> own;
  own.reserve(facets.size());
  FacetMesh& mesh = fine.mesh.mesh;
  for (const FacetId f : facets) {
    stop_if_wanted();
    std::array<VertexId, 3> facet;
    for (std::size_t k = 0; k < 3; ++k) {
      const VertexId v = base.facets[f][k];
      const auto [entry, is_new] = own.try_emplace(v, VertexId(mesh.vertices.size()));
      if (is_new) {
        mesh.vertices.push_back(base.vertices[v]);
        fine.at_m.push_back(grid.to_metres(base.vertices[v]));
        fine.image.push_back(images.make(fine.at_m.back()));
      }
      facet[k] = entry->second;
    }
    mesh.facets.push_back(facet);
    mesh.material.push_back(base.material[f]);
    mesh.component.push_back(base.component[f]);
    fine.mesh.parent.push_back(f);
    if (weights) fine.mesh.weights.push_back(all_of_it);
    for (std::size_t k = 0; k < 3; ++k) {
      const VertexId a = facet[k], b = facet[(k + 1) % 3];
      if (!(fine.image[a].seen() && fine.image[b].seen() &&
            images.surely_whole(fine.at_m[a], fine.at_m[b], fine.image[a], fine.image[b]))) {
        to_cut.push_back(f);
        break;
      }
    }
  }
  return fine;
}

FineFacets refined(const FacetMesh& base, std::span<const FacetId> facets, const WorldGrid& grid,
                   const Images& images, const RefinementLimits& limits) {
  std::vector<FacetId> to_cut;
  FineFacets fine = unrefined(base, facets, grid, images, limits.weights, to_cut);
  if (to_cut.empty()) return fine;
  const GapRule rule(images, base, grid);
  RefinedMesh cut = refine(
      base, to_cut, grid, rule, [](const BasePoint& p) { return p.at_m; }, limits);
  // Merges both parts in the order of the base facets. Shared vertices are welded.
  FineFacets all;
  FacetMesh& mesh = all.mesh.mesh;
  WeldTable weld(mesh.vertices);
  weld.reserve(fine.mesh.mesh.vertices.size() + cut.mesh.vertices.size());
  const auto take = [&](const RefinedMesh& from, std::size_t k) {
    std::array<VertexId, 3> facet;
    for (std::size_t c = 0; c < 3; ++c) facet[c] = weld.id_of(from.mesh.vertices[from.mesh.facets[k][c]]);
    mesh.facets.push_back(facet);
    mesh.material.push_back(from.mesh.material[k]);
    mesh.component.push_back(from.mesh.component[k]);
    all.mesh.parent.push_back(from.parent[k]);
    if (limits.weights) all.mesh.weights.push_back(from.weights[k]);
  };
  std::size_t next = 0, next_to_cut = 0;
  for (std::size_t k = 0; k < facets.size(); ++k) {
    if (next_to_cut == to_cut.size() || to_cut[next_to_cut] != facets[k]) {
      take(fine.mesh, k);
      continue;
    }
    for (; next < cut.parent.size() && cut.parent[next] == facets[k]; ++next) take(cut, next);
    ++next_to_cut;
  }
  for (const GridPoint& v : mesh.vertices) {
    all.at_m.push_back(grid.to_metres(v));
    all.image.push_back(rule.of(all.at_m.back()));
  }
  return all;
}

UnclearPlace unclear_place(FacetId facet, const glm::dvec3& at_m, const ApparentImage& image,
                           const glm::dvec3& apex_m) {
  const glm::dvec3 towards = (image.seen() ? image.at_m : at_m) - apex_m;
  return {facet, at_m, image.eigenrays, towards / std::max(glm::length(towards), 1e-300)};
}

/// Keeps one point of each kind per base facet.
void thin_out(std::vector<UnclearPlace>& unclear) {
  std::ranges::stable_sort(unclear, {},
                           [](const UnclearPlace& p) { return std::pair(p.facet, p.eigenrays > 0); });
  const auto same = [](const UnclearPlace& a, const UnclearPlace& b) {
    return a.facet == b.facet && (a.eigenrays > 0) == (b.eigenrays > 0);
  };
  unclear.erase(std::unique(unclear.begin(), unclear.end(), same), unclear.end());
}

void check(const ApparentMapSettings& settings) {
  if (!(settings.travel_path_error_m > 0 && settings.shortest_edge_m > 0 && settings.shadow_edge_m > 0 &&
        settings.tolerance_db > 0))
    throw std::invalid_argument("the lengths and the tolerance of the apparent map must be above 0");
}

/// Computes the apparent surface of refined facets for one apex. `origin` receives the refined facet of each
/// apparent facet.
ApparentSurface seen_of(FineFacets fine, const Images& images, const WorldGrid& grid,
                        const ApparentMap& apparent_map, const ApparentMapSettings& settings,
                        std::span<const std::shared_ptr<const ScatteringModel>> models,
                        std::vector<FacetId>* origin = nullptr) {
  ApparentSurface surface_mesh;
  surface_mesh.reference_speed_m_s = apparent_map.reference_speed_m_s();
  FacetMesh& mesh = surface_mesh.refined.mesh;
  mesh.vertices.reserve(fine.at_m.size());
  for (std::size_t v = 0; v < fine.at_m.size(); ++v)  // facets with points without image are omitted below
    mesh.vertices.push_back(grid.snap(fine.image[v].seen() ? fine.image[v].at_m : fine.at_m[v]));
  const FacetMesh& from = fine.mesh.mesh;
  mesh.facets.reserve(from.facets.size());
  EigenrayBranches sheets(fine, images, grid, models, surface_mesh);
  for (std::size_t f = 0; f < from.facets.size(); ++f) {
    stop_if_wanted();
    glm::dvec3 corners[3], seen[3];
    CornerReturn returns[3];
    bool kept = true, several = false, regular = true;
    std::optional<UnclearPlace> unclear;
    const auto note = [&](const glm::dvec3& at_m, const ApparentImage& image) {
      kept = kept && image.seen();
      several = several || image.eigenrays > 1;
      regular = regular && image.regular();
      if (!unclear && image.eigenrays != 1)
        unclear = unclear_place(fine.mesh.parent[f], at_m, image, apparent_map.apex_m());
    };
    for (int i = 0; i < 3; ++i) corners[i] = fine.at_m[from.facets[f][i]];
    if (!images.may_see(corners)) continue;  // a part of a large facet that is outside of the view
    if (std::ranges::any_of(from.facets[f], [&](VertexId v) { return !fine.image[v].several.empty(); })) {
      for (const VertexId v : from.facets[f]) note(fine.at_m[v], fine.image[v]);
      surface_mesh.unclear.push_back(*unclear);
      sheets.add(FacetId(f));
      continue;
    }
    for (int i = 0; i < 3; ++i) {
      const VertexId v = from.facets[f][i];
      seen[i] = grid.to_metres(mesh.vertices[v]) - apparent_map.apex_m();
      returns[i] = fine.image[v].returned;
      note(corners[i], fine.image[v]);
    }
    const glm::dvec3 centre = (corners[0] + corners[1] + corners[2]) / 3.0;
    std::optional<ApparentImage> middle;
    if (kept && (!regular || !images.is_small(corners, seen))) middle = images.make(centre);
    if (kept && !regular) note(centre, *middle);
    if (unclear) surface_mesh.unclear.push_back(*unclear);
    surface_mesh.facets_of_several += kept && several;
    if (!kept) {
      ++surface_mesh.facets_in_shadow;
      surface_mesh.left_out_m.push_back({corners[0], corners[1], corners[2]});
      continue;
    }
    for (int i = 0; i < 3; ++i) {
      const int k = (i + 1) % 3;
      const ApparentImage &a = fine.image[from.facets[f][i]], &b = fine.image[from.facets[f][k]];
      double gap = images.travel_path_error_m(corners[i], corners[k], a, b);
      if (!(gap <= settings.travel_path_error_m) || !regular) {
        const ApparentImage between = images.make((corners[i] + corners[k]) / 2.0);
        if (between.seen()) gap = images.travel_path_error_m(corners[i], corners[k], a, b, &between);
      }
      if (std::isfinite(gap))
        surface_mesh.largest_travel_path_error_m = std::max(surface_mesh.largest_travel_path_error_m, gap);
    }
    const glm::dvec3 towards = returns[0].arrival + returns[1].arrival + returns[2].arrival;
    surface_mesh.facets_folded +=
        glm::dot(normal_of(corners), towards) * glm::dot(normal_of(seen), seen[0] + seen[1] + seen[2]) < 0;
    const std::uint16_t material = from.material[f];
    mesh.facets.push_back(from.facets[f]);
    mesh.material.push_back(material);
    mesh.component.push_back(from.component[f]);
    surface_mesh.refined.parent.push_back(fine.mesh.parent[f]);
    if (!fine.mesh.weights.empty()) surface_mesh.refined.weights.push_back(fine.mesh.weights[f]);
    if (origin != nullptr) origin->push_back(FacetId(f));
    surface_mesh.factor_rule.push_back(middle && middle->seen() ? FactorRule::corners_and_centre
                                                                : FactorRule::corners);
    const ScatteringModel* model = models.empty() ? nullptr : models[material].get();
    surface_mesh.facet_factor.push_back(facet_factor(
        corners, seen, returns, middle && middle->seen() ? &middle->returned : nullptr,
        images.reference_absorption_db_per_m(), [model](double sine) { return sigma_of(model, sine); }));
  }
  surface_mesh.truth = std::move(fine.at_m);
  surface_mesh.truth.insert(surface_mesh.truth.end(), sheets.truth().begin(), sheets.truth().end());
  thin_out(surface_mesh.unclear);
  return surface_mesh;
}

/// Cuts an edge if any of several rules cuts it.
struct AnyRule final : EdgeRule {
  bool cuts(const BasePoint& a, const BasePoint& b) const override {
    return std::ranges::any_of(rules, [&](const GapRule& rule) { return rule.cuts(a, b); });
  }
  std::deque<GapRule> rules;
};

FineFacets with_images(const RefinedMesh& cut, const WorldGrid& grid, const GapRule& rule) {
  FineFacets fine{cut, {}, {}};
  for (const GridPoint& v : cut.mesh.vertices) {
    fine.at_m.push_back(grid.to_metres(v));
    fine.image.push_back(rule.of(fine.at_m.back()));
  }
  return fine;
}

}  // namespace

ApparentSurface map_apparent(const FacetMesh& base, std::span<const FacetId> facets, const WorldGrid& grid,
                             const ApparentMap& apparent_map, double reference_absorption_db_per_m,
                             const ApparentMapSettings& settings, const RefinementLimits& limits,
                             std::span<const std::shared_ptr<const ScatteringModel>> models,
                             const ViewBounds* view_bounds) {
  check(settings);
  const Images images(apparent_map, reference_absorption_db_per_m, settings, view_bounds);
  return seen_of(refined(base, facets, grid, images, limits), images, grid, apparent_map, settings, models);
}

ApparentPair map_apparent_pair(const FacetMesh& base, std::span<const FacetId> facets, const WorldGrid& grid,
                               const ApparentMap& transmit, const ApparentMap& receive,
                               double reference_absorption_db_per_m, const ApparentMapSettings& settings,
                               const RefinementLimits& limits, const ViewBounds* transmit_view_bounds,
                               const ViewBounds* receive_view_bounds) {
  CommonApparentSurfaces surface_meshes = map_apparent_together(
      base, facets, grid, std::array{&transmit, &receive}, reference_absorption_db_per_m, settings, limits,
      std::array{transmit_view_bounds, receive_view_bounds});
  return {std::move(surface_meshes.seabed.mesh), std::move(surface_meshes.seen[0]),
          std::move(surface_meshes.seen[1]), std::move(surface_meshes.origin[0]),
          std::move(surface_meshes.origin[1])};
}

CommonApparentSurfaces map_apparent_together(const FacetMesh& base, std::span<const FacetId> facets,
                                             const WorldGrid& grid, std::span<const ApparentMap* const> ways,
                                             double reference_absorption_db_per_m,
                                             const ApparentMapSettings& settings,
                                             const RefinementLimits& limits,
                                             std::span<const ViewBounds* const> all_view_bounds) {
  check(settings);
  std::deque<Images> images;
  AnyRule any;
  for (std::size_t k = 0; k < ways.size(); ++k)
    any.rules.emplace_back(
        images.emplace_back(*ways[k], reference_absorption_db_per_m, settings, all_view_bounds[k]), base,
        grid);
  CommonApparentSurfaces surface_meshes;
  surface_meshes.seabed = refine(
      base, facets, grid, any, [](const BasePoint& p) { return p.at_m; }, limits);
  surface_meshes.seen.resize(ways.size());
  surface_meshes.origin.resize(ways.size());
  tbb::parallel_for(std::size_t{0}, ways.size(), [&](std::size_t k) {
    surface_meshes.seen[k] = seen_of(with_images(surface_meshes.seabed, grid, any.rules[k]), images[k], grid,
                                     *ways[k], settings, {}, &surface_meshes.origin[k]);
  });
  return surface_meshes;
}

glm::dvec3 ApparentSurface::true_place(FacetId facet, glm::dvec3 seen_m, const WorldGrid& grid) const {
  const auto& corner = refined.mesh.facets[facet];
  glm::dvec3 seen[3];
  for (int i = 0; i < 3; ++i) seen[i] = grid.to_metres(refined.mesh.vertices[corner[i]]);
  const glm::dvec3 n = normal_of(seen), along = seen_m - seen[0];
  const double area2 = glm::dot(n, n);
  if (!(area2 > 0)) return truth[corner[0]];
  const double u = glm::dot(n, glm::cross(along, seen[2] - seen[0])) / area2,
               v = glm::dot(n, glm::cross(seen[1] - seen[0], along)) / area2;
  return truth[corner[0]] + u * (truth[corner[1]] - truth[corner[0]]) +
         v * (truth[corner[2]] - truth[corner[0]]);
}

std::vector<FacetMap> ApparentSurface::facet_maps(glm::dvec3 apex_m, const WorldGrid& grid) const {
  std::vector<FacetMap> maps;
  maps.reserve(refined.mesh.facets.size());
  for (const auto& corner : refined.mesh.facets) {
    glm::dvec3 seen[3], lies[3];
    for (int i = 0; i < 3; ++i) {
      seen[i] = grid.to_metres(refined.mesh.vertices[corner[i]]) - apex_m;
      lies[i] = truth[corner[i]];
    }
    maps.push_back(facet_map(seen, lies));
  }
  return maps;
}

double ApparentSurface::area_ratio(FacetId facet, const WorldGrid& grid) const {
  const auto& corner = refined.mesh.facets[facet];
  glm::dvec3 seen[3], lies[3];
  for (int i = 0; i < 3; ++i) {
    seen[i] = grid.to_metres(refined.mesh.vertices[corner[i]]);
    lies[i] = truth[corner[i]];
  }
  const double apparent = glm::length(normal_of(seen));
  return apparent > 0 ? glm::length(normal_of(lies)) / apparent : 0;
}

}  // namespace tubefoot
