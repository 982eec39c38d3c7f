// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "sensors/detection/interferometry.hpp"
#include "sensors/detection/sounding_place.hpp"
#include "sensors/recordings/recording.hpp"

namespace tubefoot {

/// A bottom point that two receivers on a receiver pair find in one sample.
struct InterferometricSounding {
  std::uint32_t beam = 0, sample = 0;  ///< beam 0: port
  double range_m = 0;                  ///< of the sample's middle
  double energy_j = 0, phase_rad = 0, coherence = 0;
  DepthEstimate
      estimate{};  ///< angle of arrival, and the place in the sensor's frame: below its horizontal plane
  glm::dvec3 position_m{0};  ///< east, north, up, abeam of the sensor
};

struct InterferometricNoise {
  double receiver_noise_j = 0;  ///< in every sample of each receiver: lowers coherences
  bool phase_noise = false;  ///< phases get the error of a single look at their coherence (phase_noise.hpp)
  std::uint64_t seed = 1;
};

/// A ping of a recording with four channels: the two receivers' products in its cells.
class ReceiverPairPing {
 public:
  ReceiverPairPing(const Recording& recording, std::size_t ping);
  InterferometricSample ideal(std::size_t beam, std::size_t sample) const;
  /// As the receivers have it: with their noise, and the phase that a sounding of the cell is made of.
  InterferometricSample received(std::size_t beam, std::size_t sample,
                                 const InterferometricNoise& noise) const;

 private:
  std::uint32_t number_;
  std::size_t samples_;
  std::array<PingEnergies, 4> channels_;
};

/// The soundings of a ping, by beam and range. Of the angles that a wrapped phase may stand for, the one is
/// taken that is nearest in phase to a seabed as deep as the samples before found it (a running mean of about
/// five, weighed by the square of their coherence); the first of a side: as deep as the altitude, or, where
/// that is not known, as the nearest echo is far. Samples without a common signal have no sounding. Angles
/// follow from the sound speed at the sensor, places from the rays of the run's water.
std::vector<InterferometricSounding> interferometric_soundings(const Recording& recording, std::size_t ping,
                                                               const InterferometricNoise& noise,
                                                               const RunContext& run = {});

}  // namespace tubefoot
