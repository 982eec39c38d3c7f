// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/echo/fresnel_cells.hpp"

#include <algorithm>
#include <array>
#include <optional>
#include <unordered_map>
#include <utility>

#include "engine/echo/fresnel_zones.hpp"
#include "engine/visibility/tube_engine.hpp"
#include "geometry/mesh/facet_cone.hpp"
#include "geometry/tubes/window_tubes.hpp"

// Divides the visible footprints near shadow borders into cells. Traces the surface behind each component
// that casts a shadow, and divides the result in the same way (fresnel_cells.hpp).

namespace tubefoot {
namespace {

glm::dvec3 vector_of(const GridPoint& p) { return {p.x, p.y, p.z}; }

/// A convex cone by the directions of its corners and the inward normals of its walls.
struct Cone {
  std::vector<glm::dvec3> corners, walls;
};

Cone cone_of(std::vector<glm::dvec3> corners) {
  glm::dvec3 middle(0);
  for (glm::dvec3& corner : corners) {
    corner = glm::normalize(corner);
    middle += corner;
  }
  Cone cone{std::move(corners), {}};
  const std::size_t n = cone.corners.size();
  if (glm::dot(glm::cross(cone.corners[0], cone.corners[1]), middle) < 0) std::ranges::reverse(cone.corners);
  for (std::size_t k = 0; k < n; ++k)
    cone.walls.push_back(glm::cross(cone.corners[k], cone.corners[(k + 1) % n]));
  return cone;
}

/// Returns whether a wall of `cone` separates it from directions.
bool separates(const Cone& cone, std::span<const glm::dvec3> directions) {
  return std::ranges::any_of(cone.walls, [&](const glm::dvec3& wall) {
    return std::ranges::all_of(directions, [&](const glm::dvec3& d) { return glm::dot(wall, d) <= 0; });
  });
}

bool may_meet(const Cone& one, const Cone& other) {
  return !separates(one, other.corners) && !separates(other, one.corners);
}

/// The zones of a transmission and the tubes that meet them.
class Zones {
 public:
  Zones(const History& history, std::span<const ShadowEdge> edges, double wavelength_m) {
    const TubeSet& tubes = history.tubes;
    for (const Tube& tube : tubes.tubes) {
      std::vector<glm::dvec3> rays;
      for (const std::uint32_t ray : tube) rays.push_back(vector_of(tubes.rays[ray]));
      tubes_.push_back(cone_of(std::move(rays)));
    }
    zones.reserve(edges.size());
    lit_in.resize(tubes_.size());
    hidden_in.resize(tubes_.size());
    for (std::uint32_t e = 0; e < edges.size(); ++e) {
      const FresnelZone& zone = zones.emplace_back(edges[e], wavelength_m, tubes.reach * history.grid_unit_m);
      lit_.push_back(cone_of(zone.corners(false)));
      hidden_.push_back(cone_of(zone.corners(true)));
      for (std::uint32_t t = 0; t < tubes_.size(); ++t) {
        if (may_meet(lit_.back(), tubes_[t])) lit_in[t].push_back(e);
        if (may_meet(hidden_.back(), tubes_[t])) hidden_in[t].push_back(e);
      }
    }
  }

  /// Returns the zones of `candidates` whose insonified regions may contain a part of a polygon.
  void find_lit(std::span<const glm::dvec3> polygon, std::span<const std::uint32_t> candidates,
                std::vector<std::uint32_t>& found) const {
    found.clear();
    for (const std::uint32_t e : candidates)
      if (!separates(lit_[e], polygon)) found.push_back(e);
  }
  const Cone& tube(std::uint32_t number) const { return tubes_[number]; }
  const Cone& hidden(std::uint32_t edge) const { return hidden_[edge]; }

  std::vector<FresnelZone> zones;
  std::vector<std::vector<std::uint32_t>> lit_in, hidden_in;  ///< by tube: zones that may meet it

 private:
  std::vector<Cone> tubes_, lit_, hidden_;
};

/// Returns the common part of two cones.
std::vector<glm::dvec3> common(const Cone& one, const Cone& other) {
  FresnelPolygon rest = one.corners, inside, outside;
  for (const glm::dvec3& wall : other.walls) {
    split(rest, {glm::normalize(wall), 0}, inside, outside);
    std::swap(rest, inside);
  }
  return rest;
}

/// Sign of a facet's turn as the apex sees it.
double facing(const FacetMesh& mesh, FacetId facet, GridPoint apex) {
  std::array<glm::dvec3, 3> corner;
  for (std::size_t k = 0; k < 3; ++k) corner[k] = vector_of(mesh.vertices[mesh.facets[facet][k]] - apex);
  return glm::dot(glm::cross(corner[1] - corner[0], corner[2] - corner[0]), corner[0]);
}

/// Facets of a mesh with vertices of their own.
class PartOfMesh {
 public:
  explicit PartOfMesh(const FacetMesh& whole) : whole_(&whole) {}
  void add(FacetId facet) {
    std::array<VertexId, 3> corners{};
    for (std::size_t k = 0; k < 3; ++k) {
      const VertexId vertex = whole_->facets[facet][k];
      const auto [known, is_new] = vertex_.try_emplace(vertex, VertexId(mesh.vertices.size()));
      if (is_new) mesh.vertices.push_back(whole_->vertices[vertex]);
      corners[k] = known->second;
    }
    mesh.facets.push_back(corners);
    mesh.material.push_back(whole_->material[facet]);
    mesh.component.push_back(whole_->component[facet]);
    facet_of.push_back(facet);
  }
  FacetMesh mesh;
  std::vector<FacetId> facet_of;  ///< by facet: its number in the whole mesh

 private:
  const FacetMesh* whole_;
  std::unordered_map<VertexId, VertexId> vertex_;
};

class CellMaker {
 public:
  CellMaker(const FresnelSurface& surface, const History& history, std::span<const ShadowEdge> edges,
            double wavelength_m, double step)
      : surface_(surface),
        history_(history),
        edges_(edges),
        wavelength_m_(wavelength_m),
        zones_(history, edges, wavelength_m),
        division_(zones_.zones, step) {
    cells_.history.grid_unit_m = history.grid_unit_m;
  }

  FresnelCells make() {
    add_lit();
    for (std::uint32_t e = 0; e < edges_.size();) {
      const std::uint32_t first = e;
      while (e < edges_.size() && edges_[e].component == edges_[first].component) ++e;
      add_hidden(first, e);
    }
    return std::move(cells_);
  }

 private:
  void add_cell(const Footprint& footprint, std::uint32_t tube, FacetId facet, const FresnelPolygon& polygon,
                double factor) {
    FootprintSet& set = cells_.history.footprints;
    Footprint cell;
    cell.facet = FacetId(cells_.facet.size());
    cell.tube = tube;
    cell.first_piece = std::uint32_t(set.pieces.size());
    cell.piece_count = 1;
    cell.plane_normal = footprint.plane_normal;
    cell.plane_distance_m = footprint.plane_distance_m;
    set.footprints.push_back(cell);
    set.pieces.push_back({std::uint32_t(set.corners_m.size()), std::uint32_t(polygon.size())});
    set.corners_m.insert(set.corners_m.end(), polygon.begin(), polygon.end());
    cells_.facet.push_back(facet);
    cells_.factor.push_back(factor);
  }

  void add_lit() {
    const FootprintSet& set = history_.footprints;
    std::vector<std::uint32_t> candidates;
    for (const Footprint& footprint : set.footprints) {
      const auto& in_tube = zones_.lit_in[footprint.tube];
      if (in_tube.empty()) continue;
      for (std::uint32_t k = 0; k < footprint.piece_count; ++k) {
        const Piece& piece = set.pieces[footprint.first_piece + k];
        const auto corners = std::span(set.corners_m).subspan(piece.first, piece.count);
        zones_.find_lit(corners, in_tube, candidates);
        if (candidates.empty()) continue;
        division_.lit({corners.begin(), corners.end()}, candidates,
                      [&](const FresnelPolygon& cell, double factor) {
                        if (factor != 0) add_cell(footprint, footprint.tube, footprint.facet, cell, factor);
                      });
      }
    }
  }

  /// Returns whether a facet is a part of the component that hides the surface behind an edge.
  bool is_omitted(FacetId facet, const ShadowEdge& edge) const {
    const FacetMesh& mesh = surface_.mesh;
    if (mesh.component[facet] != edge.component) return false;
    if (!surface_.is_terrain(edge.component)) return true;
    const double front = facing(mesh, edge.background, history_.tubes.apex);
    if (mesh.component[edge.background] == edge.component &&
        facing(mesh, facet, history_.tubes.apex) * front <= 0)
      return true;
    return std::ranges::all_of(mesh.facets[facet], [&](VertexId vertex) {
      const glm::dvec3 place = history_.grid_unit_m * vector_of(mesh.vertices[vertex] - history_.tubes.apex);
      return glm::dot(edge.across, place) <= edge.distance_m + wavelength_m_;
    });
  }

  /// Adds the surface behind the edges [first, end) of one component.
  void add_hidden(std::uint32_t first, std::uint32_t end) {
    const TubeSet& tubes = history_.tubes;
    WindowTubes windows(tubes.apex, tubes.reach);
    std::vector<std::pair<std::uint32_t, std::uint32_t>> tube_and_edge;
    for (std::uint32_t t = 0; t < tubes.tubes.size(); ++t)
      for (const std::uint32_t e : zones_.hidden_in[t]) {
        if (e < first || e >= end) continue;
        const std::vector<glm::dvec3> corners = common(zones_.hidden(e), zones_.tube(t));
        if (corners.size() < 3) continue;
        windows.add(corners, std::uint32_t(tube_and_edge.size()));
        tube_and_edge.emplace_back(t, e);
      }
    if (windows.tubes().tubes.empty()) return;

    std::vector<FacetId> found, omitted, near;
    for (std::uint32_t e = first; e < end; ++e) {
      std::vector<SceneTree::HalfSpace> walls;
      for (const glm::dvec3& wall : zones_.hidden(e).walls) {
        const glm::dvec3 normal = glm::normalize(wall);
        walls.push_back({normal.x, normal.y, normal.z});
      }
      near.clear();
      surface_.tree.query(tubes.apex, walls, tubes.reach, near);
      for (const FacetId facet : near) (is_omitted(facet, edges_[e]) ? omitted : found).push_back(facet);
    }
    for (std::vector<FacetId>* facets : {&found, &omitted}) {
      std::ranges::sort(*facets);
      facets->erase(std::ranges::unique(*facets).begin(), facets->end());
    }
    PartOfMesh behind(surface_.mesh);
    for (const FacetId facet : found)
      if (!std::ranges::binary_search(omitted, facet)) behind.add(facet);
    if (behind.mesh.facets.empty()) return;

    VisibilityOptions options = surface_.options;
    options.corner_names = false;
    const SceneTree tree(behind.mesh, SceneTree::HeightFieldSearch::ignored);
    const History hidden =
        TubeEngine(behind.mesh, tree, history_.grid_unit_m, options).trace(windows.tubes(), nullptr, false);
    const FootprintSet& set = hidden.footprints;
    std::vector<std::uint32_t> candidates;
    for (const Footprint& footprint : set.footprints) {
      const auto [tube, own] = tube_and_edge[windows.labels()[footprint.tube]];
      for (std::uint32_t k = 0; k < footprint.piece_count; ++k) {
        const Piece& piece = set.pieces[footprint.first_piece + k];
        const auto corners = std::span(set.corners_m).subspan(piece.first, piece.count);
        zones_.find_lit(corners, zones_.lit_in[tube], candidates);
        for (const std::uint32_t e : zones_.hidden_in[tube])
          if (e >= first && e < end) candidates.push_back(e);
        std::ranges::sort(candidates);
        candidates.erase(std::ranges::unique(candidates).begin(), candidates.end());
        division_.hidden({corners.begin(), corners.end()}, own, candidates,
                         [&, tube = tube](const FresnelPolygon& cell, double factor) {
                           if (factor > 0)
                             add_cell(footprint, tube, behind.facet_of[footprint.facet], cell, factor);
                         });
      }
    }
  }

  const FresnelSurface& surface_;
  const History& history_;
  std::span<const ShadowEdge> edges_;
  double wavelength_m_;
  Zones zones_;
  FresnelDivision division_;
  FresnelCells cells_;
};

}  // namespace

FresnelCells fresnel_cells(const FresnelSurface& surface, const History& history,
                           std::span<const ShadowEdge> edges, double wavelength_m, double cell_step) {
  if (edges.empty()) return {};
  return CellMaker(surface, history, edges, wavelength_m, cell_step).make();
}

}  // namespace tubefoot
