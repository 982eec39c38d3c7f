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
  std::vector<RefractedReference> sensors;  ///< by sensor of the group; empty for receiver pairs
  /// true if bounds are wider than requested, because a finer surface would have too many facets
  bool at_limit = false;

  std::size_t facets() const { return surface_mesh.mesh().facets.size(); }
};

/// The certified echoes of one transmission with a separate receiver, which shares its transmissions with no
/// other sensor.
struct RefractedPairTransmission {
  RefractedPair pair;
  BistaticHistory history;
  std::vector<RefractedReference> sensors;  ///< one element
  bool at_limit = false;

  std::size_t facets() const { return pair.apparent.mesh.facets.size(); }
};

/// The certified echoes of one fan of a receiver pair.
struct RefractedReceiverPairTransmission {
  /// apparent surfaces for the transmitter, the upper receiver and the lower receiver
  CommonApparentSurfaces apparent;
  BistaticHistory history;                  ///< history of the upper receiver
  std::vector<RefractedReference> sensors;  ///< one element, by rows (certify_refracted_receiver_pair())
  bool at_limit = false;

  std::size_t facets() const { return apparent.seabed.mesh.facets.size(); }
};

/// Refines the apparent surface of a transmission until one of three conditions holds. First, all but one in
/// two hundred of the finite bounds are within the run's tolerance. Second, a further refinement no longer
/// helps. Third, the surface would have more facets than a reference permits.
RefractedTransmission certify_refracted_transmission(const Transmission& transmission);
RefractedPairTransmission certify_refracted_pair_transmission(const Transmission& transmission);
RefractedReceiverPairTransmission certify_refracted_receiver_pair_transmission(
    const Transmission& transmission, std::size_t sensor, std::uint32_t fan);

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
