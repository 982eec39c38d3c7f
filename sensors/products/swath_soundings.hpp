// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <vector>

#include "sensors/detection/bottom_detection.hpp"
#include "sensors/detection/sounding.hpp"
#include "sensors/detection/sounding_place.hpp"
#include "sensors/products/beam_ray.hpp"
#include "sensors/products/received.hpp"

namespace tubefoot {

/// The received energies and soundings of one ping of a fan across the track.
struct SoundedPing {
  std::vector<std::vector<double>> received_j;     ///< by beam, received energies up to the last echo
  std::vector<std::optional<Sounding>> soundings;  ///< by beam; empty if no sample counted
  std::vector<double> range_sigma_m;               ///< by beam, of its sounding
  std::vector<BeamRay> rays;                       ///< by beam, at the time of its sounding
};

/// Detects the bottom in the pings of a fan across the track. Energies are weighted by the gain 20 log10 R +
/// 2 alpha R. On a plane Lambert seabed of any slope across the track the energy-weighted mean range is then
/// that of the beam's axis. The deviation is a fraction width^2 / 24 of it. A receiver with its own
/// time-varied gain (tvg_spreading) gets no further gain. Samples that are not distinguishable from the
/// receiver's noise do not count. The gain and the pose are those of the beam's transmit sector. Soundings
/// are at the end of the ray along the beam's axis (SoundingPlacer).
class BottomFinder {
 public:
  /// The recording must outlive this object.
  BottomFinder(const Recording& recording, const RunContext& run, const DetectionRule& rule);
  /// With an ideal receiver, which does not change energies.
  static BottomFinder ideal(const Recording& recording, const DetectionRule& rule,
                            const RunContext& run = {});
  /// Thread-safe.
  SoundedPing sound(std::size_t ping) const;
  const ReceiverChain& receiver(std::size_t beam = 0) const { return received_.chain(beam); }
  const SoundingPlacer& placer() const { return placer_; }

 private:
  BottomFinder(const Recording& recording, ReceivedPings received, bool has_own_gain,
               const DetectionRule& rule, std::vector<std::vector<double>> noise_floor_j,
               SoundingPlacer placer);

  const Recording& recording_;
  ReceivedPings received_;
  DetectionRule rule_;
  // By transmit sector and sample:
  std::vector<std::vector<double>> floor_j_;  ///< lower energies count as noise
  std::vector<std::vector<double>> gain_;     ///< linear in energy
  SoundingPlacer placer_;
};

}  // namespace tubefoot
