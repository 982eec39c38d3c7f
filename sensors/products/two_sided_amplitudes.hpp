// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <filesystem>
#include <vector>

#include "files/temporary_buffer.hpp"
#include "sensors/products/received.hpp"

namespace tubefoot {

/// Pings of a sonar with a beam to either side in the form of its files. They are received once, for the
/// scales of the codes, and kept until they are written. If there are many, an anonymous file stores them.
class TwoSidedAmplitudes {
 public:
  /// `beside`: one of the files. `for_a_map`: distinguishes samples without a surface from samples without
  /// energy.
  TwoSidedAmplitudes(const Recording& recording, const RunContext& run, const std::filesystem::path& beside,
                     bool for_a_map);

  /// [port, starboard][sample], uPa; NaN: no surface. Thread-safe.
  std::vector<float> of(std::size_t ping) const;
  /// Largest amplitude of all samples.
  double largest_upa() const { return largest_ > 0 ? largest_ : 1; }
  /// Amplitude that is shown as white: 15 dB above the mean level, less a display gain. The mean keeps a
  /// bright quay wall from making the seabed black.
  double white_upa() const;

 private:
  const Recording& recording_;
  TemporaryBuffer rows_;
  float largest_ = 0;
  double sum_of_logarithms_ = 0;  ///< over amplitudes above zero
  std::size_t echoes_ = 0;
};

}  // namespace tubefoot
