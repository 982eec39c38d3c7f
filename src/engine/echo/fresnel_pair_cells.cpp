// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <array>
#include <set>
#include <utility>

#include "engine/echo/fresnel_cells.hpp"
#include "engine/visibility/looks.hpp"
#include "geometry/footprints/footprint_builder.hpp"

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

/// The surface of one leg: the visible surface, or that behind the edges of one component.
struct LegView {
  ApexLook look;
  const HiddenStrips* strips = nullptr;  ///< null: the visible surface

  std::uint32_t tube_of(std::uint32_t number) const {
    return strips == nullptr ? number : strips->of_window[number].first;
  }
};

class PairCellMaker {
 public:
  PairCellMaker(const FresnelSurface& surface, std::span<const FresnelLeg> legs,
                const std::array<LegView, 2>& visible, double wavelength_m, double step)
      : surface_(surface),
        visible_(visible),
        wavelength_m_(wavelength_m),
        zones_(legs, wavelength_m, surface.grid_unit_m),
        division_(zones_.zones(), step, 1) {
    cells_.history.transmit = legs[0].tubes;
    cells_.history.receive = legs[1].tubes;
    cells_.history.grid_unit_m = surface.grid_unit_m;
    cells_.history.shared.receiver_m = legs[1].apex_m;
  }

  FresnelPairCells make() {
    add(visible_[0], visible_[1]);
    std::set<std::uint16_t> components;
    for (const FresnelZone& zone : zones_.zones()) components.insert(zone.group().second);
    for (const std::uint16_t component : components) {
      std::array<HiddenStrips, 2> strips;
      std::array<std::vector<TubeVisibility>, 2> seen;
      for (const int leg : {0, 1}) {
        HiddenStrips& own = strips[std::size_t(leg)];
        own = hidden_strips(surface_, zones_, {leg, component}, wavelength_m_);
        if (own.is_empty()) continue;
        const SceneTree tree(own.mesh, SceneTree::HeightFieldSearch::ignored);
        seen[std::size_t(leg)] = look(own.mesh, tree, own.windows, surface_.options);
      }
      const auto hidden = [&](std::size_t leg) {
        return LegView{{strips[leg].windows, seen[leg], &strips[leg].mesh, strips[leg].facet_of},
                       &strips[leg]};
      };
      if (!strips[0].is_empty()) add(hidden(0), visible_[1]);
      if (!strips[1].is_empty()) add(visible_[0], hidden(1));
      if (!strips[0].is_empty() && !strips[1].is_empty()) add(hidden(0), hidden(1));
    }
    return std::move(cells_);
  }

 private:
  /// Adds the cells of the surface that both views share.
  void add(const LegView& transmit, const LegView& receive) {
    const SharedFootprints shared =
        shared_by_all(FootprintSharer(surface_.mesh, transmit.look, receive.look, surface_.grid_unit_m));
    std::vector<std::uint32_t> own, candidates;
    for (const SharedFacet& facet : shared.facets)
      for (std::uint32_t k = 0; k < facet.piece_count; ++k) {
        const SharedPiece& piece = shared.pieces[facet.first_piece + k];
        const auto corners = std::span(shared.corners_m).subspan(piece.first, piece.count);
        const std::array<std::uint32_t, 2> tubes{transmit.tube_of(piece.transmit_tube),
                                                 receive.tube_of(piece.receive_tube)};
        own.clear();
        candidates.clear();
        if (transmit.strips != nullptr) own.push_back(transmit.strips->of_window[piece.transmit_tube].second);
        if (receive.strips != nullptr) own.push_back(receive.strips->of_window[piece.receive_tube].second);
        for (const int leg : {0, 1}) zones_.find_lit(leg, tubes[std::size_t(leg)], corners, candidates);
        if (own.empty() && candidates.empty()) continue;
        for (const std::uint32_t zone : own) {
          const auto group = zones_.zones()[zone].group();
          zones_.find_hidden(group, tubes[std::size_t(group.first)], candidates);
        }
        std::ranges::sort(candidates);
        const auto take = [&](const FresnelPolygon& cell, double factor) {
          if (factor != 0) add_cell(facet, tubes, cell, factor);
        };
        if (own.empty())
          division_.lit({corners.begin(), corners.end()}, candidates, take);
        else
          division_.hidden({corners.begin(), corners.end()}, own, candidates, take);
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
  }

  const FresnelSurface& surface_;
  std::array<LegView, 2> visible_;
  double wavelength_m_;
  FresnelZones zones_;
  FresnelDivision division_;
  FresnelPairCells cells_;
};

}  // namespace

FresnelPairCells fresnel_pair_cells(const FresnelSurface& surface, const TubeSet& transmit,
                                    const TubeSet& receive, double wavelength_m, double cell_step) {
  const std::array<const TubeSet*, 2> tubes{&transmit, &receive};
  std::array<std::vector<TubeVisibility>, 2> seen;
  std::array<std::vector<ShadowEdge>, 2> edges;
  for (std::size_t leg = 0; leg < 2; ++leg) {
    seen[leg] = look(surface.mesh, surface.tree, *tubes[leg], surface.options);
    edges[leg] = shadow_edges(surface.mesh, named_history(surface, *tubes[leg], seen[leg]));
  }
  if (edges[0].empty() && edges[1].empty()) return {};
  const GridPoint between = receive.apex - transmit.apex;
  const std::array<FresnelLeg, 2> legs{
      FresnelLeg{transmit, edges[0]},
      FresnelLeg{receive, edges[1], surface.grid_unit_m * glm::dvec3(between.x, between.y, between.z)}};
  const std::array<LegView, 2> visible{LegView{{transmit, seen[0]}}, LegView{{receive, seen[1]}}};
  return PairCellMaker(surface, legs, visible, wavelength_m, cell_step).make();
}

}  // namespace tubefoot
