// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <utility>
#include <vector>

#include "engine/echo/fresnel_zones.hpp"
#include "geometry/search/scene_tree.hpp"
#include "geometry/tubes/tube.hpp"
#include "geometry/visibility/visibility.hpp"

namespace tubefoot {

/// The surface that an apex sees, and how to find what lies behind it.
struct FresnelSurface {
  const FacetMesh& mesh;
  const SceneTree& tree;
  const VisibilityOptions& options;
  double grid_unit_m;
  /// Whether a component is a terrain, whose hills cast shadows on the terrain itself.
  std::function<bool(std::uint16_t component)> is_terrain;
};

/// A convex cone by the unit vectors of its corners and the inward normals of its walls.
struct DirectionCone {
  std::vector<glm::dvec3> corners, walls;
};

/// One leg of a path: its tubes, the shadow edges that its apex sees, and the apex relative to the origin of
/// places.
struct FresnelLeg {
  const TubeSet& tubes;
  std::span<const ShadowEdge> edges;
  glm::dvec3 apex_m{0};
};

/// The zones of the shadow edges of all legs, and the tubes that meet them. Zones are numbered by group.
class FresnelZones {
 public:
  FresnelZones(std::span<const FresnelLeg> legs, double wavelength_m, double grid_unit_m);

  /// Appends the zones of a leg whose insonified regions may contain a part of a polygon in a tube.
  void find_lit(int leg, std::uint32_t tube, std::span<const glm::dvec3> polygon,
                std::vector<std::uint32_t>& found) const;
  /// Appends the zones of a group whose hidden regions may meet a tube.
  void find_hidden(std::pair<int, std::uint16_t> group, std::uint32_t tube,
                   std::vector<std::uint32_t>& found) const;

  std::span<const FresnelZone> zones() const { return zones_; }
  const FresnelLeg& leg(int number) const { return legs_[std::size_t(number)]; }
  /// Returns the range of zones of a group.
  std::pair<std::uint32_t, std::uint32_t> of_group(std::pair<int, std::uint16_t> group) const;
  const DirectionCone& tube(int leg, std::uint32_t number) const { return tubes_[std::size_t(leg)][number]; }
  const DirectionCone& hidden(std::uint32_t zone) const { return hidden_[zone]; }

 private:
  using OfTubes = std::vector<std::vector<std::uint32_t>>;  // by tube
  std::span<const FresnelLeg> legs_;
  std::vector<FresnelZone> zones_;
  std::vector<DirectionCone> lit_, hidden_;        // by zone
  std::vector<std::vector<DirectionCone>> tubes_;  // by leg
  std::vector<OfTubes> lit_in_, hidden_in_;        // by leg
};

/// The strips behind the shadow edges of one group, and the facets that may lie in them. The component that
/// casts the shadows is omitted. If this component is a terrain, only some of its facets are omitted. They lie
/// in front of an edge, or the apex sees their other side.
struct HiddenStrips {
  TubeSet windows;
  /// By window: its tube of the leg and its zone.
  std::vector<std::pair<std::uint32_t, std::uint32_t>> of_window;
  FacetMesh mesh;
  std::vector<FacetId> facet_of;  ///< by facet of this mesh, in increasing order: its number in the surface

  bool is_empty() const { return windows.tubes.empty() || mesh.facets.empty(); }
};
HiddenStrips hidden_strips(const FresnelSurface& surface, const FresnelZones& zones,
                           std::pair<int, std::uint16_t> group, double wavelength_m);

}  // namespace tubefoot
