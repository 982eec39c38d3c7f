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

/// A bottom point that a receiver pair finds in one sample.
struct InterferometricSounding {
  std::uint32_t beam = 0, sample = 0;  ///< beam 0: port
  double range_m = 0;                  ///< range of the sample's middle
  double energy_j = 0, phase_rad = 0, coherence = 0;
  DepthEstimate
      estimate{};  ///< angle of arrival, and the position in the sensor's frame: below its horizontal plane
  glm::dvec3 position_m{0};  ///< east, north, up, abeam of the sensor
};

struct InterferometricNoise {
  double receiver_noise_j = 0;  ///< in every sample of each receiver; lowers coherences
  bool phase_noise = false;     ///< adds the single-look phase error for the coherence (phase_noise.hpp)
  std::uint64_t seed = 1;
};

/// A ping of a recording with four channels. Gives the products of the receiver pair in each cell.
class ReceiverPairPing {
 public:
  ReceiverPairPing(const Recording& recording, std::size_t ping);
  InterferometricSample ideal(std::size_t beam, std::size_t sample) const;
  /// The products with receiver noise, and the phase from which a sounding of the cell is computed.
  InterferometricSample received(std::size_t beam, std::size_t sample,
                                 const InterferometricNoise& noise) const;

 private:
  std::uint32_t number_;
  std::size_t samples_;
  std::array<PingEnergies, 4> channels_;
};

/// The soundings of a ping, by beam and range. A wrapped phase may have several angles; the result has the
/// one that is nearest in phase to an expected seabed. Its depth is a running mean over about five samples
/// before, weighted by the square of their coherence. The first sample of a side uses the altitude, or, if
/// that is unknown, the range of the nearest echo. Samples without a common signal have no sounding. Angles
/// follow from the sound speed at the sensor, and positions from the rays in the water of the run.
std::vector<InterferometricSounding> interferometric_soundings(const Recording& recording, std::size_t ping,
                                                               const InterferometricNoise& noise,
                                                               const RunContext& run = {});

}  // namespace tubefoot
