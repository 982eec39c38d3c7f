// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/echo/fresnel_strips.hpp"

#include <algorithm>
#include <array>
#include <glm/geometric.hpp>
#include <utility>

#include "geometry/mesh/facet_cone.hpp"
#include "geometry/tubes/window_tubes.hpp"

// Assigns zones of shadow edges to tubes by their cones of directions. Cuts the strips behind edges to tubes,
// and collects the facets that may lie in them.

namespace tubefoot {
namespace {

glm::dvec3 vector_of(const GridPoint& p) { return {p.x, p.y, p.z}; }

DirectionCone cone_of(std::vector<glm::dvec3> corners) {
  glm::dvec3 middle(0);
  for (glm::dvec3& corner : corners) {
    corner = glm::normalize(corner);
    middle += corner;
  }
  DirectionCone cone{std::move(corners), {}};
  const std::size_t n = cone.corners.size();
  if (glm::dot(glm::cross(cone.corners[0], cone.corners[1]), middle) < 0) std::ranges::reverse(cone.corners);
  for (std::size_t k = 0; k < n; ++k)
    cone.walls.push_back(glm::cross(cone.corners[k], cone.corners[(k + 1) % n]));
  return cone;
}

/// Returns whether a wall of `cone` separates it from directions.
bool separates(const DirectionCone& cone, std::span<const glm::dvec3> directions) {
  return std::ranges::any_of(cone.walls, [&](const glm::dvec3& wall) {
    return std::ranges::all_of(directions, [&](const glm::dvec3& d) { return glm::dot(wall, d) <= 0; });
  });
}

bool may_meet(const DirectionCone& one, const DirectionCone& other) {
  return !separates(one, other.corners) && !separates(other, one.corners);
}

/// Returns the common part of two cones.
std::vector<glm::dvec3> common(const DirectionCone& one, const DirectionCone& other) {
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

/// Copies facets into a mesh with vertices of its own.
void copy_facets(const FacetMesh& whole, HiddenStrips& strips) {
  // Vertices keep their order, so that names of planes can be translated.
  std::vector<VertexId>& vertices = strips.vertex_of;
  for (const FacetId facet : strips.facet_of)
    vertices.insert(vertices.end(), whole.facets[facet].begin(), whole.facets[facet].end());
  std::ranges::sort(vertices);
  vertices.erase(std::ranges::unique(vertices).begin(), vertices.end());
  for (const VertexId vertex : vertices) strips.mesh.vertices.push_back(whole.vertices[vertex]);
  for (const FacetId facet : strips.facet_of) {
    std::array<VertexId, 3> corners{};
    for (std::size_t k = 0; k < 3; ++k)
      corners[k] = VertexId(std::ranges::lower_bound(vertices, whole.facets[facet][k]) - vertices.begin());
    strips.mesh.facets.push_back(corners);
    strips.mesh.material.push_back(whole.material[facet]);
    strips.mesh.component.push_back(whole.component[facet]);
  }
}

/// Returns whether the whole component that casts a shadow is omitted. A component that shades itself is also
/// the surface behind its edge.
bool is_omitted_whole(const FresnelSurface& surface, const ShadowEdge& edge) {
  return edge.background_component != edge.component && !surface.is_terrain(edge.component);
}

/// Returns whether a facet is a part of the component that hides the surface behind an edge.
bool is_omitted(const FresnelSurface& surface, FacetId facet, const ShadowEdge& edge, GridPoint apex,
                double wavelength_m) {
  const FacetMesh& mesh = surface.mesh;
  if (mesh.component[facet] != edge.component) return false;
  if (is_omitted_whole(surface, edge)) return true;
  if (edge.background_component == edge.component &&
      facing(mesh, facet, apex) * facing(mesh, edge.background, apex) <= 0)
    return true;
  // The facet lies in front of the edge, or at more than 45 degrees below the border of the shadow. A wall
  // below its own edge does so.
  return std::ranges::all_of(mesh.facets[facet], [&](VertexId vertex) {
    const ShadowEdge::Place at = edge.place(surface.grid_unit_m * vector_of(mesh.vertices[vertex] - apex));
    return at.q <= edge.distance_m + wavelength_m + std::max(at.h, 0.0);
  });
}

}  // namespace

FresnelZones::FresnelZones(std::span<const FresnelLeg> legs, double wavelength_m, double grid_unit_m)
    : legs_(legs) {
  std::size_t count = 0;
  for (const FresnelLeg& leg : legs) count += leg.edges.size();
  zones_.reserve(count);
  for (int number = 0; number < int(legs.size()); ++number) {
    const FresnelLeg& leg = legs[std::size_t(number)];
    std::vector<DirectionCone>& tubes = tubes_.emplace_back();
    for (const Tube& tube : leg.tubes.tubes) {
      std::vector<glm::dvec3> rays;
      for (const std::uint32_t ray : tube) rays.push_back(vector_of(leg.tubes.rays[ray]));
      tubes.push_back(cone_of(std::move(rays)));
    }
    OfTubes &lit_in = lit_in_.emplace_back(tubes.size()), &hidden_in = hidden_in_.emplace_back(tubes.size());
    for (const ShadowEdge& edge : leg.edges) {
      const auto e = std::uint32_t(zones_.size());
      const FresnelZone& zone =
          zones_.emplace_back(edge, wavelength_m, leg.tubes.reach * grid_unit_m, leg.apex_m, number);
      lit_.push_back(cone_of(zone.corners(false)));
      hidden_.push_back(cone_of(zone.corners(true)));
      tubes_behind_.emplace_back();
      for (std::uint32_t t = 0; t < tubes.size(); ++t) {
        if (may_meet(lit_.back(), tubes[t])) lit_in[t].push_back(e);
        if (!may_meet(hidden_.back(), tubes[t])) continue;
        hidden_in[t].push_back(e);
        tubes_behind_.back().push_back(t);
      }
    }
  }
}

void FresnelZones::find_lit(int leg, std::uint32_t tube, std::span<const glm::dvec3> polygon,
                            std::vector<std::uint32_t>& found) const {
  const auto& in_tube = lit_in_[std::size_t(leg)][tube];
  if (in_tube.empty()) return;
  std::vector<glm::dvec3> directions(polygon.begin(), polygon.end());
  for (glm::dvec3& direction : directions) direction -= legs_[std::size_t(leg)].apex_m;
  for (const std::uint32_t zone : in_tube)
    if (!separates(lit_[zone], directions) && zones_[zone].may_act_on(polygon)) found.push_back(zone);
}

void FresnelZones::find_hidden(std::pair<int, std::uint16_t> group, std::uint32_t tube,
                               std::vector<std::uint32_t>& found) const {
  for (const std::uint32_t zone : hidden_in_[std::size_t(group.first)][tube])
    if (zones_[zone].group() == group) found.push_back(zone);
}

std::pair<std::uint32_t, std::uint32_t> FresnelZones::of_group(std::pair<int, std::uint16_t> group) const {
  const auto of = std::ranges::equal_range(zones_, group, {}, &FresnelZone::group);
  return {std::uint32_t(of.begin() - zones_.begin()), std::uint32_t(of.end() - zones_.begin())};
}

std::vector<std::vector<std::uint32_t>> zones_with_equal_strips(const FresnelSurface& surface,
                                                                const FresnelZones& zones,
                                                                std::pair<int, std::uint16_t> group) {
  constexpr std::size_t longest = 64;  // limits memory, and does not affect the result
  std::vector<std::vector<std::uint32_t>> lists;
  std::vector<std::uint32_t> whole;
  const auto [first, end] = zones.of_group(group);
  for (std::uint32_t zone = first; zone < end; ++zone) {
    if (!is_omitted_whole(surface, zones.zones()[zone].edge())) {
      lists.push_back({zone});
      continue;
    }
    whole.push_back(zone);
    if (whole.size() == longest) lists.push_back(std::exchange(whole, {}));
  }
  if (!whole.empty()) lists.push_back(std::move(whole));
  return lists;
}

HiddenStrips hidden_strips(const FresnelSurface& surface, const FresnelZones& zones,
                           std::span<const std::uint32_t> list, double wavelength_m) {
  HiddenStrips strips;
  const int leg = zones.zones()[list.front()].group().first;
  const TubeSet& tubes = zones.leg(leg).tubes;
  WindowTubes windows(tubes.apex, tubes.reach);
  std::vector<std::pair<std::uint32_t, std::uint32_t>> cones;
  for (const std::uint32_t zone : list)
    for (const std::uint32_t t : zones.tubes_behind(zone)) {
      const std::vector<glm::dvec3> corners = common(zones.hidden(zone), zones.tube(leg, t));
      if (corners.size() < 3) continue;
      windows.add(corners, std::uint32_t(cones.size()));
      cones.emplace_back(t, zone);
    }
  strips.windows = windows.tubes();
  for (const std::uint32_t cone : windows.labels()) strips.of_window.push_back(cones[cone]);
  if (strips.windows.tubes.empty()) return strips;

  std::vector<FacetId> near;
  for (const std::uint32_t zone : list) {
    std::vector<SceneTree::HalfSpace> walls;
    for (const glm::dvec3& wall : zones.hidden(zone).walls) {
      const glm::dvec3 normal = glm::normalize(wall);
      walls.push_back({normal.x, normal.y, normal.z});
    }
    near.clear();
    surface.tree.query(tubes.apex, walls, tubes.reach, near);
    const ShadowEdge& edge = zones.zones()[zone].edge();
    for (const FacetId facet : near)
      if (!is_omitted(surface, facet, edge, tubes.apex, wavelength_m)) strips.facet_of.push_back(facet);
  }
  std::ranges::sort(strips.facet_of);
  strips.facet_of.erase(std::ranges::unique(strips.facet_of).begin(), strips.facet_of.end());
  copy_facets(surface.mesh, strips);
  return strips;
}

VisiblePlaces::VisiblePlaces(const History& history) : set_(history.footprints) {}

std::span<const Piece> VisiblePlaces::pieces(std::uint32_t tube, FacetId facet) const {
  const auto found = std::ranges::lower_bound(
      set_.footprints, std::pair(tube, facet), {},
      [](const Footprint& footprint) { return std::pair(footprint.tube, footprint.facet); });
  if (found == set_.footprints.end() || found->tube != tube || found->facet != facet) return {};
  return std::span(set_.pieces).subspan(found->first_piece, found->piece_count);
}

bool VisiblePlaces::contain(std::span<const Piece> pieces, glm::dvec3 place_m) const {
  return std::ranges::any_of(pieces, [&](const Piece& piece) {
    const auto corners = std::span(set_.corners_m).subspan(piece.first, piece.count);
    // The walls of the cone of the piece, whose sense of rotation is that of all pieces of its tube.
    bool any_inside = false, any_outside = false;
    for (std::size_t k = 0; k < corners.size(); ++k) {
      const double side = glm::dot(glm::cross(corners[k], corners[(k + 1) % corners.size()]), place_m);
      any_inside = any_inside || side > 0;
      any_outside = any_outside || side < 0;
    }
    return any_inside != any_outside;
  });
}

}  // namespace tubefoot
