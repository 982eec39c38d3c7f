// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <vector>

#include "engine/certified/certified_refraction.hpp"
#include "run/refraction.hpp"
#include "run/transmission.hpp"

namespace tubefoot {

/// The certified echoes of one transmission through refracting water, and the surface that causes them.
struct RefractedTransmission {
  TransmissionSurface surface_mesh;
  History history;
  std::size_t candidates = 0;
  std::vector<RefractedReference> sensors;  ///< by sensor of the request
  /// true if bounds are wider than requested, because a finer surface would have too many facets
  bool at_limit = false;

  std::size_t facets() const { return surface_mesh.mesh().facets.size(); }
};

/// The certified echo of one transmission with several ends. They are the transmitter and a separate
/// receiver, or for one fan of a receiver pair the transmitter, the upper and the lower receiver.
struct RefractedEndsTransmission {
  CommonApparentSurfaces apparent;  ///< by end
  BistaticHistory history;          ///< history of the first receiver
  /// One element. With a receiver pair, its rows are those of certify_refracted_receiver_pair().
  std::vector<RefractedReference> sensors;
  bool at_limit = false;

  std::size_t facets() const { return apparent.seabed.mesh.facets.size(); }
};

/// Refines the apparent surface of a transmission until one of three conditions holds. First, all but one in
/// two hundred of the finite bounds are within the run's tolerance. Second, a further refinement no longer
/// helps. Third, the surface would have more facets than a reference permits. `sensors`: sensors of the
/// transmission without a receiver pair.
RefractedTransmission certify_refracted_transmission(const Transmission& transmission,
                                                     const std::vector<std::size_t>& sensors);
RefractedEndsTransmission certify_refracted_pair_transmission(const Transmission& transmission);
RefractedEndsTransmission certify_refracted_receiver_pair_transmission(const Transmission& transmission,
                                                                       std::size_t sensor, std::uint32_t fan);

/// The certified echoes of a sensor's paths over mirrors, by order.
struct RefractedPathsTransmission {
  PathEcho paths;
  std::vector<RefractedReference> orders;
  bool at_limit = false;

  std::size_t facets() const;
};
/// Refines the apparent surfaces of a sensor's paths in the same way. The images make their own surfaces.
/// `trace`: calls path_echo() with the given water.
RefractedPathsTransmission certify_refracted_paths(const Transmission& transmission, const PathWater& water,
                                                   double reach_m,
                                                   const std::function<PathEcho(const PathWater&)>& trace);

}  // namespace tubefoot
