// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>

#include "engine/echo/echo.hpp"
#include "engine/ground/paired_facet.hpp"
#include "engine/law/path_loss.hpp"
#include "geometry/footprints/shared_footprints.hpp"
#include "geometry/search/scene_tree.hpp"
#include "geometry/visibility/visibility.hpp"

// Transmitter and receiver apart. docs/bistatic.md
namespace tubefoot {

/// What one transmission met that a receiver elsewhere sees too. A path is transmit apex -> facet -> receive
/// apex, so a shared footprint is a path.
struct BistaticHistory {
  TubeSet transmit, receive;
  double grid_unit_m = 1;  ///< metres per grid unit of both
  SharedFootprints shared;
  /// In refracting water: by shared facet, where else it is seen and lies; empty: in even water.
  std::vector<PairedFacet> paired{};
};

/// Exact visibility from both apexes, and the exact intersections on the facets. `options` must name an exact
/// arithmetic. The result does not depend on the threads.
BistaticHistory trace_bistatic(const FacetMesh& mesh, const SceneTree& tree, double grid_unit_m,
                               const VisibilityOptions& options, TubeSet transmit, TubeSet receive);

/// The same in refracting water, on facets that the two apexes see in different places (trees of the two
/// apparent meshes). Facets of the history are those of pair.mesh. `transmit` and `receive` are what the pair
/// was made with; both have the same reference speed.
BistaticHistory trace_bistatic(const ApparentPair& pair, const WorldGrid& grid,
                               const VisibilityOptions& options, TubeSet transmit, TubeSet receive,
                               const Straightening& transmit_water, const Straightening& receive_water,
                               double reference_absorption_db_per_m);

/// Which beams hear what.
struct BistaticBeams {
  int count = 0;                                   ///< beams of the receiver
  std::span<const std::uint32_t> of_receive_tube;  ///< the beam that a receive tube belongs to
  /// Fans of the tubes: a receiver hears the transmissions of its own fan only. Both empty: one fan.
  std::span<const std::uint32_t> fan_of_transmit_tube{}, fan_of_receive_tube{};
};

/// Relative error that integrate_bistatic_echo() keeps if it is not told otherwise.
constexpr double bistatic_tolerance = 1e-10;

/// The echo of a receiver apart from its transmitter. Sample k covers half paths, (transmit range + receive
/// range) / 2, from first + k step on. An area element returns
///     mu sin(grazing at T) sin(grazing at R) r_T^-2 r_R^-2 10^(-alpha (r_T + r_R) / 10) B_T B_R dA,
/// which is integrate_echo()'s law where both are in the same place; with a scattering law,
/// sqrt(sigma(grazing at T) sigma(grazing at R)) instead of mu and the sines (scattering_law.hpp).
/// `law.patterns` is about receive tubes
/// (its fans are used as theirs); the transmit pattern is taken in the direction from the transmit apex, the
/// receive pattern in that from the receive apex. The error of each energy is at most about `tolerance` times
/// what it would be with patterns of 1; tabulated patterns, whose second derivative jumps, keep it only to
/// about 1e-6, tabulated laws, whose first does, to about 1e-5. With `loss` every element also loses what the
/// mirrors on its path take, by the directions from the two apexes, which may be images (docs/paths.md). With
/// paired facets, ranges are travel times by the reference speed, patterns are taken in the directions in
/// which rays leave and arrive, and each facet has paired_factor().
Echo integrate_bistatic_echo(const BistaticHistory& history, const BistaticBeams& beams,
                             const RangeSamples& samples, const EchoLaw& law,
                             double tolerance = bistatic_tolerance, const PathLoss* loss = nullptr);

}  // namespace tubefoot
