// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "run/ping_sums.hpp"
#include "run/transmission.hpp"

namespace tubefoot {

/// One contribution to the echoes of a group of sensors that share transmissions. The plan of a run decides
/// all members before the first ping.
struct EchoContribution {
  std::vector<std::size_t> sensors;  ///< sensors of the group that receive it
  /// Adds its energies, bounds and counts to those of the ping.
  void (*add)(const EchoContribution& contribution, const Transmission& transmission, PingSums& sums);
  std::optional<double> tolerance;   ///< relative tolerance of a reference; empty for energies without bounds
  bool by_rays = false;              ///< true if rays sample the visibility
  bool has_surface_per_end = false;  ///< true if transmitter and receiver see different apparent surfaces
  bool needs_corner_names = false;   ///< true if the history must contain the names of corners
  bool needs_open_water = false;     ///< true if the history must contain unobstructed regions
};

/// Returns the plan of a group's contributions, in the order of summation. This function alone chooses them,
/// by the features of the scene and the request.
std::vector<EchoContribution> contributions_to(const Survey& survey, const RunRequest& request,
                                               const SharedTransmissions& group);

/// Returns the request with visibility options that supply the needs of all contributions of a plan.
RunRequest with_needs(RunRequest request, std::span<const std::vector<EchoContribution>> plan);

/// Returns the tubes of the selected beams. Empty if all tubes are wanted. A beam with a pattern receives
/// energy from all tubes, and the tolerance of a reference refers to all beams.
std::vector<bool> wanted_tubes(const Transmission& transmission, const PingSums& sums);

/// Returns the history of a transmission's tubes on its surface mesh. A stationary camera sends the same
/// tubes from the same position in each cycle. On a surface that its cycles share, the history is therefore
/// computed once. It is also computed once for several contributions of one transmission.
const History& traced(const Transmission& transmission, PingSums& sums);

}  // namespace tubefoot
