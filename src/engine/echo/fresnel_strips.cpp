// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/echo/fresnel_strips.hpp"

#include <algorithm>
#include <array>
#include <glm/geometric.hpp>
#include <unordered_map>

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
  std::unordered_map<VertexId, VertexId> own;
  for (const FacetId facet : strips.facet_of) {
    std::array<VertexId, 3> corners{};
    for (std::size_t k = 0; k < 3; ++k) {
      const VertexId vertex = whole.facets[facet][k];
      const auto [known, is_new] = own.try_emplace(vertex, VertexId(strips.mesh.vertices.size()));
      if (is_new) strips.mesh.vertices.push_back(whole.vertices[vertex]);
      corners[k] = known->second;
    }
    strips.mesh.facets.push_back(corners);
    strips.mesh.material.push_back(whole.material[facet]);
    strips.mesh.component.push_back(whole.component[facet]);
  }
}

/// Returns whether a facet is a part of the component that hides the surface behind an edge.
bool is_omitted(const FresnelSurface& surface, FacetId facet, const ShadowEdge& edge, GridPoint apex,
                double wavelength_m) {
  const FacetMesh& mesh = surface.mesh;
  if (mesh.component[facet] != edge.component) return false;
  if (!surface.is_terrain(edge.component)) return true;
  if (mesh.component[edge.background] == edge.component &&
      facing(mesh, facet, apex) * facing(mesh, edge.background, apex) <= 0)
    return true;
  return std::ranges::all_of(mesh.facets[facet], [&](VertexId vertex) {
    const glm::dvec3 place = surface.grid_unit_m * vector_of(mesh.vertices[vertex] - apex);
    return glm::dot(edge.across, place) <= edge.distance_m + wavelength_m;
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
      for (std::uint32_t t = 0; t < tubes.size(); ++t) {
        if (may_meet(lit_.back(), tubes[t])) lit_in[t].push_back(e);
        if (may_meet(hidden_.back(), tubes[t])) hidden_in[t].push_back(e);
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
    if (!separates(lit_[zone], directions)) found.push_back(zone);
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

HiddenStrips hidden_strips(const FresnelSurface& surface, const FresnelZones& zones,
                           std::pair<int, std::uint16_t> group, double wavelength_m) {
  HiddenStrips strips;
  const int leg = group.first;
  const TubeSet& tubes = zones.leg(leg).tubes;
  WindowTubes windows(tubes.apex, tubes.reach);
  std::vector<std::pair<std::uint32_t, std::uint32_t>> cones;
  std::vector<std::uint32_t> in_tube;
  for (std::uint32_t t = 0; t < tubes.tubes.size(); ++t) {
    in_tube.clear();
    zones.find_hidden(group, t, in_tube);
    for (const std::uint32_t zone : in_tube) {
      const std::vector<glm::dvec3> corners = common(zones.hidden(zone), zones.tube(leg, t));
      if (corners.size() < 3) continue;
      windows.add(corners, std::uint32_t(cones.size()));
      cones.emplace_back(t, zone);
    }
  }
  strips.windows = windows.tubes();
  for (const std::uint32_t cone : windows.labels()) strips.of_window.push_back(cones[cone]);
  if (strips.windows.tubes.empty()) return strips;

  std::vector<FacetId> found, omitted, near;
  const auto [first, end] = zones.of_group(group);
  for (std::uint32_t zone = first; zone < end; ++zone) {
    std::vector<SceneTree::HalfSpace> walls;
    for (const glm::dvec3& wall : zones.hidden(zone).walls) {
      const glm::dvec3 normal = glm::normalize(wall);
      walls.push_back({normal.x, normal.y, normal.z});
    }
    near.clear();
    surface.tree.query(tubes.apex, walls, tubes.reach, near);
    const ShadowEdge& edge = zones.zones()[zone].edge();
    for (const FacetId facet : near)
      (is_omitted(surface, facet, edge, tubes.apex, wavelength_m) ? omitted : found).push_back(facet);
  }
  for (std::vector<FacetId>* facets : {&found, &omitted}) {
    std::ranges::sort(*facets);
    facets->erase(std::ranges::unique(*facets).begin(), facets->end());
  }
  std::ranges::set_difference(found, omitted, std::back_inserter(strips.facet_of));
  copy_facets(surface.mesh, strips);
  return strips;
}

}  // namespace tubefoot
