// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <vector>

#include "engine/echo/receiver_pair_echo.hpp"
#include "engine/paths/path_echo.hpp"

// Computes the echoes of paths over mirrors at the two receivers of a receiver pair, and the mean product of
// the signals. Source: docs/notes/multiple-paths.md, "Receiver pairs".
namespace tubefoot {

/// Echoes at both receivers of a receiver pair, per order as in PathEcho.
struct ReceiverPairPathEcho {
  std::vector<ReceiverPairEcho> by_order;
  std::vector<ReceiverPairEcho> bound_by_order{};  ///< with a reference: half-widths of the enclosures
  std::size_t images = 0, shared_pieces = 0, arrivals = 0, patches = 0;
  std::vector<ApparentSurface> surface_meshes;  ///< as in PathEcho
  double largest_misfit_m = 0;
  SurfaceCounts seen_by_patches;  ///< as in PathEcho
};

/// Tubes of one fan from the transmitter and from the middle of a receiver pair (equal for a monostatic
/// sonar), and the receiver pair. Its wave number refers to the reference speed.
struct ReceiverPairEnds {
  const TubeSet &transmit, &receive;
  const ReceiverBaseline& receiver_pair;
};

/// Computes path_echo() for both ends of the receiver pair of one fan, and the mean products of their
/// signals. The image of a receiver pair in a mirror is a receiver pair. Paths over the same mirrors add to
/// the product if they come from the same surface element or from the same image of the transmitter. The
/// phase is that of the difference of the path lengths. A mirror shifts both phases equally, so this shift
/// cancels. Different paths are independent, as in the energies.
///
/// In refracting water (`water`, as for path_echo()) the images of both ends see the apparent seabed of the
/// image of their middle (docs/notes/refraction.md). Patches insonify this seabed through the water from
/// their own depth. Unscattered paths follow separate rays to the two ends.
///
/// `model.patterns`: those of this fan only (patterns_of_fan()), with one beam that receives all tubes of
/// the fan. Throws the exceptions of path_echo().
ReceiverPairPathEcho receiver_pair_path_echo(const FacetMesh& mesh, const SceneTree& tree, double grid_unit_m,
                                             const VisibilityOptions& options, const ReceiverPairEnds& ends,
                                             const RangeSamples& samples, const EchoModel& model,
                                             const PathSettings& settings, const PathWater* water = nullptr);

}  // namespace tubefoot
