// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <filesystem>
#include <vector>

#include "files/temporary_buffer.hpp"
#include "sensors/products/received.hpp"

namespace tubefoot {

/// Pings as the files of a sonar with a beam to either side have them: received once, for the scales of the
/// codes, and kept until they are written, in a file without a name where they are many.
class TwoSidedAmplitudes {
 public:
  /// `beside`: one of the files. `for_a_map`: samples without a surface are reported from silent ones.
  TwoSidedAmplitudes(const Recording& recording, const RunContext& run, const std::filesystem::path& beside,
                     bool for_a_map);

  /// [port, starboard][sample], uPa; not a number: no surface. On any thread.
  std::vector<float> of(std::size_t ping) const;
  /// That of the loudest sample.
  double largest_upa() const { return largest_ > 0 ? largest_ : 1; }
  /// White for the eye: 15 dB above the mean level, lest a quay wall leave the seabed black; less a display
  /// gain.
  double white_upa() const;

 private:
  const Recording& recording_;
  TemporaryBuffer rows_;
  float largest_ = 0;
  double sum_of_logarithms_ = 0;  ///< of what is above zero
  std::size_t echoes_ = 0;
};

}  // namespace tubefoot
