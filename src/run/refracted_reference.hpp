// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <vector>

#include "engine/certified/certified_refraction.hpp"
#include "run/refraction.hpp"
#include "run/transmission.hpp"

namespace tubefoot {

/// The certified echoes of one transmission through refracting water, and the surface that they are of.
struct RefractedTransmission {
  TransmissionSurface surface_mesh;
  History history;
  std::size_t candidates = 0;
  std::vector<RefractedReference> sensors;  ///< as the group's; of receiver pairs nothing
  bool at_limit = false;  ///< bounds are wider than asked, and a finer ground would have too many facets

  std::size_t facets() const { return surface_mesh.mesh().facets.size(); }
};

/// The same of a separate receiver, which has its transmissions for itself.
struct RefractedPairTransmission {
  RefractedPair pair;
  BistaticHistory history;
  std::vector<RefractedReference> sensors;  ///< one
  bool at_limit = false;

  std::size_t facets() const { return pair.apparent.mesh.facets.size(); }
};

/// The same of one fan of a receiver pair.
struct RefractedReceiverPairTransmission {
  CommonApparentSurfaces apparent;          ///< of the transmitter, of the upper and of the lower receiver
  BistaticHistory history;                  ///< of the upper one
  std::vector<RefractedReference> sensors;  ///< one, by rows (certify_refracted_receiver_pair())
  bool at_limit = false;

  std::size_t facets() const { return apparent.seabed.mesh.facets.size(); }
};

/// Straightens the surface of a transmission ever finer, until all but a two-hundredth of the bounds that are
/// finite are within the tolerance that the run asks for, until that helps no more, or until the surface
/// would have more facets than a reference is worth.
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
/// The same of these, whose images make grounds of their own: `trace` is path_echo() through a water.
RefractedPathsTransmission certify_refracted_paths(const Transmission& transmission, const PathWater& water,
                                                   double reach_m,
                                                   const std::function<PathEcho(const PathWater&)>& trace);

}  // namespace tubefoot
