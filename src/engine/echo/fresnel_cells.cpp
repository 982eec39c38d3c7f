// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/echo/fresnel_cells.hpp"

#include <algorithm>
#include <array>

#include "engine/visibility/tube_engine.hpp"
#include "geometry/steps/stop.hpp"

// Divides the visible footprints near shadow borders into cells. Traces the surface behind each component
// that casts a shadow, and divides the result in the same way (fresnel_cells.hpp).

namespace tubefoot {
namespace {

class CellMaker {
 public:
  CellMaker(const FresnelSurface& surface, const History& history, const FresnelLeg& leg, double wavelength_m,
            const FresnelBlocks<FresnelCells>& blocks, double step)
      : surface_(surface),
        history_(history),
        wavelength_m_(wavelength_m),
        blocks_(blocks),
        zones_({&leg, 1}, wavelength_m, surface.grid_unit_m),
        division_(zones_.zones(), step, 2),
        visible_(history) {
    cells_.history.grid_unit_m = history.grid_unit_m;
  }

  void make() {
    add_lit();
    for (std::uint32_t zone = 0; zone < zones_.zones().size();) {
      const auto group = zones_.zones()[zone].group();
      for (const auto& list : zones_with_equal_strips(surface_, zones_, group)) add_hidden(group, list);
      zone = zones_.of_group(group).second;
    }
    pass_on();
  }

 private:
  void pass_on() {
    if (!cells_.facet.empty()) blocks_.take(cells_);
    FootprintSet& set = cells_.history.footprints;
    set.footprints.clear();
    set.pieces.clear();
    set.corners_m.clear();
    cells_.facet.clear();
    cells_.factor.clear();
  }

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
    if (cells_.facet.size() % 4096 == 0) stop_if_wanted();
    if (cells_.facet.size() >= blocks_.largest) pass_on();
  }

  void add_lit() {
    const FootprintSet& set = history_.footprints;
    for (const Footprint& footprint : set.footprints) {
      stop_if_wanted();
      for (std::uint32_t k = 0; k < footprint.piece_count; ++k) {
        const Piece& piece = set.pieces[footprint.first_piece + k];
        const auto corners = std::span(set.corners_m).subspan(piece.first, piece.count);
        candidates_.clear();
        zones_.find_lit(0, footprint.tube, corners, candidates_);
        if (candidates_.empty()) continue;
        division_.lit({corners.begin(), corners.end()}, candidates_,
                      [&](const FresnelPolygon& cell, double factor) {
                        if (factor != 0) add_cell(footprint, footprint.tube, footprint.facet, cell, factor);
                      });
      }
    }
  }

  /// Adds the surface behind edges of one component. `list`: one of zones_with_equal_strips().
  void add_hidden(std::pair<int, std::uint16_t> group, std::span<const std::uint32_t> list) {
    stop_if_wanted();
    const HiddenStrips strips = hidden_strips(surface_, zones_, list, wavelength_m_);
    if (strips.is_empty()) return;
    VisibilityOptions options = surface_.options;
    options.corner_names = false;
    const SceneTree tree(strips.mesh, SceneTree::HeightFieldSearch::ignored);
    const History hidden =
        TubeEngine(strips.mesh, tree, surface_.grid_unit_m, options).trace(strips.windows, nullptr, false);
    const FootprintSet& set = hidden.footprints;
    for (const Footprint& footprint : set.footprints) {
      stop_if_wanted();
      const auto [tube, own] = strips.of_window[footprint.tube];
      const FacetId facet = strips.facet_of[footprint.facet];
      const std::span<const Piece> visible = visible_.pieces(tube, facet);
      for (std::uint32_t k = 0; k < footprint.piece_count; ++k) {
        const Piece& piece = set.pieces[footprint.first_piece + k];
        const auto corners = std::span(set.corners_m).subspan(piece.first, piece.count);
        candidates_.clear();
        zones_.find_lit(0, tube, corners, candidates_);
        zones_.find_hidden(group, tube, candidates_);
        std::ranges::sort(candidates_);
        division_.hidden({corners.begin(), corners.end()}, std::array{own}, candidates_,
                         [&, tube = tube](const FresnelPolygon& cell, double factor) {
                           if (factor > 0 && !visible_.contain(visible, centre_of(cell)))
                             add_cell(footprint, tube, facet, cell, factor);
                         });
      }
    }
  }

  const FresnelSurface& surface_;
  const History& history_;
  double wavelength_m_;
  const FresnelBlocks<FresnelCells>& blocks_;
  FresnelZones zones_;
  FresnelDivision division_;
  VisiblePlaces visible_;
  FresnelCells cells_;
  std::vector<std::uint32_t> candidates_;
};

}  // namespace

void fresnel_cells(const FresnelSurface& surface, const History& history, std::span<const ShadowEdge> edges,
                   double wavelength_m, const FresnelBlocks<FresnelCells>& blocks, double cell_step) {
  if (edges.empty()) return;
  const FresnelLeg leg{history.tubes, edges};
  CellMaker(surface, history, leg, wavelength_m, blocks, cell_step).make();
}

}  // namespace tubefoot
