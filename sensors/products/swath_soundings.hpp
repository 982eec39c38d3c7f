// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <vector>

#include "sensors/detection/bottom_detection.hpp"
#include "sensors/detection/sounding.hpp"
#include "sensors/detection/sounding_place.hpp"
#include "sensors/products/received.hpp"

namespace tubefoot {

/// Angle of a beam across the track from straight down of the sensor, starboard positive.
double across_angle_rad(const BeamAxis& axis);
/// Direction of a beam at such an angle, in the sensor's frame.
glm::dvec3 across_direction(double across_angle_rad);

/// What a fan across the track makes of one ping.
struct SoundedPing {
  std::vector<std::vector<double>> received_j;     ///< by beam, as the receiver gives it, up to the last echo
  std::vector<std::optional<Sounding>> soundings;  ///< by beam; none where no sample counted
  std::vector<double> range_sigma_m;               ///< by beam, of its sounding
};

/// Detects the bottom in the pings of a fan across the track. Energies are looked at after the gain 20 log10
/// R + 2 alpha R: a level Lambert seabed, whatever its slope across the track, then has the mean range,
/// weighed by energy, of its beam's axis, but for a part of width^2 / 24 of it. A receiver with a time-varied
/// gain of its own (tvg_spreading) is taken as it is. What does not stand out of the receiver's noise does
/// not count. Soundings lie where the ray of the beam's axis ends (SoundingPlacer).
class BottomFinder {
 public:
  /// The recording must outlive this.
  BottomFinder(const Recording& recording, const RunContext& run, const DetectionRule& rule);
  /// With a receiver that leaves energies as they are.
  static BottomFinder ideal(const Recording& recording, const DetectionRule& rule,
                            const RunContext& run = {});
  /// Thread-safe.
  SoundedPing sound(std::size_t ping) const;
  const ReceiverChain& receiver() const { return received_.chain(); }
  const SoundingPlacer& placer() const { return placer_; }

 private:
  BottomFinder(const Recording& recording, ReceivedPings received, bool has_own_gain,
               const DetectionRule& rule, std::vector<double> noise_floor_j, SoundingPlacer placer);

  const Recording& recording_;
  ReceivedPings received_;
  DetectionRule rule_;
  std::vector<double> floor_j_;  ///< by sample: what is less is taken for noise
  std::vector<double> gain_;     ///< by sample, linear in energy
  SoundingPlacer placer_;
};

}  // namespace tubefoot
