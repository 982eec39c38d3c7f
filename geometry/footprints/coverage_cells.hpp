// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <glm/vec2.hpp>
#include <span>
#include <vector>

#include "geometry/footprints/coverage.hpp"
#include "geometry/footprints/layer_border.hpp"
#include "geometry/footprints/line_table.hpp"

// Divides one facet into convex cells that no border of a region crosses. This header is expensive to
// compile: include it only in .cpp files.
namespace tubefoot {

/// A region of a facet: the part that one ping sees, or a part that lies in the tubes of one look.
struct CoverageLayer {
  std::uint32_t ping = 0, look = 0;
  std::array<FacetId, 2> parts{};  ///< facets in the seabeds of the look's two ends
  bool hidden_too = false;         ///< the part in the tubes, including what is hidden there
  LayerBorder border;
};

/// The cells of a facet. Edge k of a cell runs along line k from corner k.
struct CoverageCells {
  std::vector<CoverageCell> cells;
  std::vector<DirectedLine> lines;
  std::vector<glm::dvec2> corners;
};

/// Divides a polygon by the borders of the layers. Layers that see the facet precede the others, and each
/// ping has at most one of them. The result does not depend on the number of threads.
CoverageCells divided_by_borders(LineTable& table, const TabledPolygon& polygon,
                                 std::span<const CoverageLayer> layers);

}  // namespace tubefoot
