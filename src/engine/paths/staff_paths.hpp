// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <vector>

#include "engine/echo/staff_echo.hpp"
#include "engine/paths/path_echo.hpp"

// Paths over mirrors to two receivers on a staff. docs/paths.md
namespace tubefoot {

/// What both receivers of a staff hear, by order as PathEcho.
struct StaffPathEcho {
  std::vector<StaffEcho> by_order;
  std::size_t images = 0, shared_pieces = 0, arrivals = 0, patches = 0;
};

/// path_echo() to both ends of the staff of one fan, with the means of their signals' product. The image of
/// a staff in a mirror is a staff: what comes to both of its ends over the same mirrors and from the same
/// element of the bed, or the same image of the transmitter, adds to the product, with the difference of the
/// two path lengths for its phase. A mirror turns the phases of both alike, so what it does to one of them is
/// not asked. Different paths are independent, as in the energies.
///
/// `transmit`, `receive`: tubes of the fan, from the transmitter and from the middle of the staff (the same
/// for one place). `law.patterns`: those of the fan alone, whose one beam hears all of its tubes. Throws as
/// path_echo().
StaffPathEcho staff_path_echo(const FacetMesh& mesh, const SceneTree& tree, double grid_unit_m,
                              const VisibilityOptions& options, const TubeSet& transmit,
                              const TubeSet& receive, const Fringe& staff, const RangeSamples& samples,
                              const EchoLaw& law, const PathSettings& settings);

/// The patterns of one fan of a sensor alone, for `tubes` tubes of it.
BeamPatterns patterns_of_fan(const BeamPatterns& patterns, std::uint32_t fan, std::size_t tubes);

}  // namespace tubefoot
