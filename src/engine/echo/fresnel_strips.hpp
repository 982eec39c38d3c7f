// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <utility>
#include <vector>

#include "engine/echo/fresnel_zones.hpp"
#include "engine/visibility/history.hpp"
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
  /// Returns the tubes that the hidden region of a zone may meet.
  std::span<const std::uint32_t> tubes_behind(std::uint32_t zone) const { return tubes_behind_[zone]; }
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
  OfTubes tubes_behind_;                           // by zone
};

/// The strips behind some shadow edges of one group, and the facets that may lie in them. The component that
/// casts the shadow is omitted. If this component is a terrain or receives the shadow itself, only some of
/// its facets are omitted. They lie in front of the edge or steeply below it, or the apex sees their other
/// side.
struct HiddenStrips {
  TubeSet windows;
  /// By window: its tube of the leg and its zone.
  std::vector<std::pair<std::uint32_t, std::uint32_t>> of_window;
  FacetMesh mesh;
  std::vector<FacetId> facet_of;    ///< by facet of this mesh, in increasing order: its number in the surface
  std::vector<VertexId> vertex_of;  ///< the same for vertices

  bool is_empty() const { return windows.tubes.empty() || mesh.facets.empty(); }
};
/// Returns the zones of a group in lists. The facets that are omitted do not differ between the zones of a
/// list.
std::vector<std::vector<std::uint32_t>> zones_with_equal_strips(const FresnelSurface& surface,
                                                                const FresnelZones& zones,
                                                                std::pair<int, std::uint16_t> group);
/// `list`: one of zones_with_equal_strips().
HiddenStrips hidden_strips(const FresnelSurface& surface, const FresnelZones& zones,
                           std::span<const std::uint32_t> list, double wavelength_m);

/// The visible polygons of an apex, by tube and facet.
class VisiblePlaces {
 public:
  /// `history` must outlive the object.
  explicit VisiblePlaces(const History& history);
  /// Returns the visible pieces of a facet in a tube.
  std::span<const Piece> pieces(std::uint32_t tube, FacetId facet) const;
  /// Returns whether one of these pieces contains a place on their plane. `place_m`: relative to the apex.
  bool contain(std::span<const Piece> pieces, glm::dvec3 place_m) const;

 private:
  const FootprintSet& set_;
};

}  // namespace tubefoot
