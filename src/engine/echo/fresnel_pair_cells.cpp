// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <array>
#include <set>
#include <utility>

#include "engine/echo/fresnel_cells.hpp"
#include "engine/visibility/looks.hpp"
#include "geometry/footprints/footprint_builder.hpp"
#include "geometry/steps/stop.hpp"

// Divides the common visibility of two apexes near the shadow borders of either leg into cells. The hidden
// side has three parts: behind an edge of the transmit leg, of the receive leg, and of both.

namespace tubefoot {
namespace {

/// Returns the footprints of an apex with the names of their corners, for shadow_edges().
History named_history(const FresnelSurface& surface, const TubeSet& tubes,
                      std::span<const TubeVisibility> seen) {
  std::vector<FootprintSet> of_tube(tubes.tubes.size());
  for (std::uint32_t tube = 0; tube < of_tube.size(); ++tube)
    append_footprints(surface.mesh, tubes, tube, seen[tube], surface.grid_unit_m, of_tube[tube], true);
  return {tubes, surface.grid_unit_m, joined(of_tube), {}};
}

/// The surface behind the edges of one component, with the facets and vertices of the whole surface.
struct HiddenSurface {
  TubeSet windows;
  std::vector<TubeVisibility> seen;                                ///< by window
  std::vector<std::pair<std::uint32_t, std::uint32_t>> of_window;  ///< by window: its tube and its zone
};

/// The surface of one leg: the visible surface, or that behind the edges of one component.
struct LegView {
  ApexLook look;
  const HiddenSurface* hidden = nullptr;  ///< null: the visible surface

  std::uint32_t tube_of(std::uint32_t number) const {
    return hidden == nullptr ? number : hidden->of_window[number].first;
  }
};

/// Translates the facets and vertices of strips to those of the surface.
void to_surface(const HiddenStrips& strips, TubeVisibility& seen) {
  for (NamedPiece& piece : seen.pieces) piece.facet = strips.facet_of[piece.facet];
  for (auto& [facet, occluder] : seen.occluders) {
    facet = strips.facet_of[facet];
    occluder = strips.facet_of[occluder];
  }
  const auto translate = [&](PointId& point) {
    if (point != no_point && (point & ray_bit) == 0) point = strips.vertex_of[point];
  };
  for (CornerName& corner : seen.corners) {
    translate(corner.point);
    for (PlaneName* plane : {&corner.p, &corner.q}) {
      if (plane->depth) {  // a plane of two facets
        plane->a = strips.facet_of[plane->a];
        plane->b = strips.facet_of[plane->b];
      } else {
        translate(plane->a);
        translate(plane->b);
      }
    }
  }
}

class PairCellMaker {
 public:
  PairCellMaker(const FresnelSurface& surface, std::span<const FresnelLeg> legs,
                const std::array<LegView, 2>& visible, const std::array<History, 2>& histories,
                double wavelength_m, const FresnelBlocks<FresnelPairCells>& blocks, double step)
      : surface_(surface),
        visible_(visible),
        places_{VisiblePlaces(histories[0]), VisiblePlaces(histories[1])},
        wavelength_m_(wavelength_m),
        blocks_(blocks),
        zones_(legs, wavelength_m, surface.grid_unit_m),
        division_(zones_.zones(), step, 1) {
    cells_.history.transmit = legs[0].tubes;
    cells_.history.receive = legs[1].tubes;
    cells_.history.grid_unit_m = surface.grid_unit_m;
    cells_.history.shared.receiver_m = legs[1].apex_m;
  }

  void make() {
    add(visible_[0], visible_[1]);
    std::set<std::uint16_t> components;
    for (const FresnelZone& zone : zones_.zones()) components.insert(zone.group().second);
    for (const std::uint16_t component : components) {
      const std::array<HiddenSurface, 2> hidden{hidden_surface({0, component}),
                                                hidden_surface({1, component})};
      const auto view = [&](std::size_t leg) {
        return LegView{{hidden[leg].windows, hidden[leg].seen}, &hidden[leg]};
      };
      const bool has_first = !hidden[0].seen.empty(), has_second = !hidden[1].seen.empty();
      if (has_first) add(view(0), visible_[1]);
      if (has_second) add(visible_[0], view(1));
      if (has_first && has_second) add(view(0), view(1));
    }
    pass_on();
  }

 private:
  /// Looks behind the edges of one component.
  HiddenSurface hidden_surface(std::pair<int, std::uint16_t> group) {
    HiddenSurface hidden;
    const TubeSet& tubes = zones_.leg(group.first).tubes;
    hidden.windows.apex = tubes.apex;
    hidden.windows.reach = tubes.reach;
    for (const auto& list : zones_with_equal_strips(surface_, zones_, group)) {
      stop_if_wanted();
      const HiddenStrips strips = hidden_strips(surface_, zones_, list, wavelength_m_);
      if (strips.is_empty()) continue;
      const SceneTree tree(strips.mesh, SceneTree::HeightFieldSearch::ignored);
      for (TubeVisibility& seen : look(strips.mesh, tree, strips.windows, surface_.options)) {
        to_surface(strips, seen);
        hidden.seen.push_back(std::move(seen));
      }
      const auto first_ray = std::uint32_t(hidden.windows.rays.size());
      hidden.windows.rays.insert(hidden.windows.rays.end(), strips.windows.rays.begin(),
                                 strips.windows.rays.end());
      for (Tube tube : strips.windows.tubes) {
        for (std::uint32_t& ray : tube) ray += first_ray;
        hidden.windows.tubes.push_back(tube);
      }
      hidden.of_window.insert(hidden.of_window.end(), strips.of_window.begin(), strips.of_window.end());
    }
    return hidden;
  }

  void pass_on() {
    if (!cells_.facet.empty()) blocks_.take(cells_);
    SharedFootprints& set = cells_.history.shared;
    set.facets.clear();
    set.pieces.clear();
    set.corners_m.clear();
    cells_.facet.clear();
    cells_.factor.clear();
  }

  /// Adds the cells of the surface that both views share.
  void add(const LegView& transmit, const LegView& receive) {
    const SharedFootprints shared =
        shared_by_all(FootprintSharer(surface_.mesh, transmit.look, receive.look, surface_.grid_unit_m));
    std::vector<std::uint32_t> own, candidates;
    for (const SharedFacet& facet : shared.facets) {
      stop_if_wanted();
      for (std::uint32_t k = 0; k < facet.piece_count; ++k) {
        const SharedPiece& piece = shared.pieces[facet.first_piece + k];
        const auto corners = std::span(shared.corners_m).subspan(piece.first, piece.count);
        const std::array<std::uint32_t, 2> tubes{transmit.tube_of(piece.transmit_tube),
                                                 receive.tube_of(piece.receive_tube)};
        own.clear();
        candidates.clear();
        if (transmit.hidden != nullptr) own.push_back(transmit.hidden->of_window[piece.transmit_tube].second);
        if (receive.hidden != nullptr) own.push_back(receive.hidden->of_window[piece.receive_tube].second);
        for (const int leg : {0, 1}) zones_.find_lit(leg, tubes[std::size_t(leg)], corners, candidates);
        if (own.empty() && candidates.empty()) continue;
        for (const std::uint32_t zone : own) {
          const auto group = zones_.zones()[zone].group();
          zones_.find_hidden(group, tubes[std::size_t(group.first)], candidates);
        }
        std::ranges::sort(candidates);
        std::array<std::span<const Piece>, 2> visible;
        for (const std::uint32_t zone : own) {
          const auto leg = std::size_t(zones_.zones()[zone].group().first);
          visible[leg] = places_[leg].pieces(tubes[leg], facet.facet);
        }
        const auto take = [&](const FresnelPolygon& cell, double factor) {
          if (factor == 0) return;
          for (const std::size_t leg : {0, 1})
            if (places_[leg].contain(visible[leg], centre_of(cell) - zones_.leg(int(leg)).apex_m)) return;
          add_cell(facet, tubes, cell, factor);
        };
        if (own.empty())
          division_.lit({corners.begin(), corners.end()}, candidates, take);
        else
          division_.hidden({corners.begin(), corners.end()}, own, candidates, take);
      }
    }
  }

  void add_cell(const SharedFacet& facet, const std::array<std::uint32_t, 2>& tubes,
                const FresnelPolygon& polygon, double factor) {
    SharedFootprints& set = cells_.history.shared;
    SharedFacet cell = facet;
    cell.facet = FacetId(cells_.facet.size());
    cell.first_piece = std::uint32_t(set.pieces.size());
    cell.piece_count = 1;
    set.facets.push_back(cell);
    set.pieces.push_back(
        {tubes[0], tubes[1], std::uint32_t(set.corners_m.size()), std::uint32_t(polygon.size())});
    set.corners_m.insert(set.corners_m.end(), polygon.begin(), polygon.end());
    cells_.facet.push_back(facet.facet);
    cells_.factor.push_back(factor);
    if (cells_.facet.size() % 4096 == 0) stop_if_wanted();
    if (cells_.facet.size() >= blocks_.largest) pass_on();
  }

  const FresnelSurface& surface_;
  std::array<LegView, 2> visible_;
  std::array<VisiblePlaces, 2> places_;
  double wavelength_m_;
  const FresnelBlocks<FresnelPairCells>& blocks_;
  FresnelZones zones_;
  FresnelDivision division_;
  FresnelPairCells cells_;
};

}  // namespace

void fresnel_pair_cells(const FresnelSurface& surface, const TubeSet& transmit, const TubeSet& receive,
                        double wavelength_m, const FresnelBlocks<FresnelPairCells>& blocks,
                        double cell_step) {
  const std::array<const TubeSet*, 2> tubes{&transmit, &receive};
  std::array<std::vector<TubeVisibility>, 2> seen;
  std::array<std::vector<ShadowEdge>, 2> edges;
  std::array<History, 2> histories;
  for (std::size_t leg = 0; leg < 2; ++leg) {
    seen[leg] = look(surface.mesh, surface.tree, *tubes[leg], surface.options);
    histories[leg] = named_history(surface, *tubes[leg], seen[leg]);
    edges[leg] = shadow_edges(surface.mesh, histories[leg]);
  }
  if (edges[0].empty() && edges[1].empty()) return;
  const GridPoint between = receive.apex - transmit.apex;
  const std::array<FresnelLeg, 2> legs{
      FresnelLeg{transmit, edges[0]},
      FresnelLeg{receive, edges[1], surface.grid_unit_m * glm::dvec3(between.x, between.y, between.z)}};
  const std::array<LegView, 2> visible{LegView{{transmit, seen[0]}}, LegView{{receive, seen[1]}}};
  PairCellMaker(surface, legs, visible, histories, wavelength_m, blocks, cell_step).make();
}

}  // namespace tubefoot
