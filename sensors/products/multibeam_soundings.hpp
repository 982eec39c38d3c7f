// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <vector>

#include "sensors/detection/bottom_detection.hpp"
#include "sensors/detection/soundings.hpp"
#include "sensors/products/products.hpp"

namespace tubefoot {

/// What a multibeam makes of one ping.
struct SoundedPing {
  std::vector<double> received_j;                  ///< [beam][sample], as the receiver gives it
  std::vector<std::optional<Sounding>> soundings;  ///< by beam; none where no sample counted
  std::vector<double> range_sigma_m;               ///< by beam, of its sounding
};

/// Detects the bottom in a multibeam's pings. Energies are looked at after the gain 20 log10 R + 2 alpha R: a
/// level Lambert bed, whatever its slope across the track, then has the mean range, weighed by energy, of its
/// beam's axis, but for a part of width^2 / 24 of it. A receiver with a time-varied gain of its own
/// (tvg_spreading) is taken as it is. What does not stand out of the receiver's noise does not count.
class BottomFinder {
 public:
  /// The recording must be a multibeam's and outlive this.
  BottomFinder(const Recording& recording, const RunContext& run);
  /// With a receiver that leaves energies as they are.
  static BottomFinder ideal(const Recording& recording);
  /// Thread-safe.
  SoundedPing sound(std::size_t ping) const;
  const ReceiverChain& receiver() const { return receiver_; }

 private:
  BottomFinder(const Recording& recording, const ReceiverChain& receiver, const SignalDescription& signal,
               std::vector<double> noise_floor_j);

  const Recording& recording_;
  ReceiverChain receiver_;
  double pulse_extent_m_ = 0;  ///< echoes are spread over it
  DetectionRule rule_;
  std::vector<double> floor_j_;  ///< by sample: what is less is taken for noise
  std::vector<double> gain_;     ///< by sample, linear in energy
};

}  // namespace tubefoot
