// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <vector>

#include "engine/echo/receiver_pair_echo.hpp"
#include "engine/paths/path_echo.hpp"

// Paths over mirrors to two receivers on a receiver pair. docs/paths.md
namespace tubefoot {

/// What both receivers of a receiver pair receive, by order as PathEcho.
struct ReceiverPairPathEcho {
  std::vector<ReceiverPairEcho> by_order;
  std::vector<ReceiverPairEcho> bound_by_order{};  ///< with a reference: half-widths of their enclosures
  std::size_t images = 0, shared_pieces = 0, arrivals = 0, patches = 0;
  std::vector<ApparentSurface> surface_meshes;  ///< as PathEcho's
  double largest_misfit_m = 0;
  SurfaceCounts seen_by_patches;  ///< as PathEcho's
};

/// Tubes of one fan, from the transmitter and from the middle of a receiver pair (the same for one place),
/// and the receiver pair, with the wave number by the reference speed.
struct ReceiverPairEnds {
  const TubeSet &transmit, &receive;
  const ReceiverBaseline& receiver_pair;
};

/// path_echo() to both ends of the receiver pair of one fan, with the means of their signals' product. The
/// image of a receiver pair in a mirror is a receiver pair: what comes to both of its ends over the same
/// mirrors and from the same element of the seabed, or the same image of the transmitter, adds to the
/// product, with the difference of the two path lengths for its phase. A mirror turns the phases of both
/// alike, so what it does to one of them is not asked. Different paths are independent, as in the energies.
///
/// In refracting water (`water`, as path_echo()'s) images of both ends look at the seabed as it appears from
/// that of their middle (docs/refraction.md), which patches light through the water from their own depth;
/// what comes unscattered follows rays to either end.
///
/// `law.patterns`: those of the fan alone (patterns_of_fan()), whose one beam receives all of its tubes.
/// Throws as path_echo().
ReceiverPairPathEcho receiver_pair_path_echo(const FacetMesh& mesh, const SceneTree& tree, double grid_unit_m,
                                             const VisibilityOptions& options, const ReceiverPairEnds& ends,
                                             const RangeSamples& samples, const EchoModel& model,
                                             const PathSettings& settings, const PathWater* water = nullptr);

}  // namespace tubefoot
