// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>

#include "sensors/recordings/recording.hpp"

namespace tubefoot {

/// What writing files takes, about: figures of one machine (docs/performance.md).
struct WritingCost {
  double seconds = 0;         ///< of one thread
  double shared_seconds = 0;  ///< of all threads together
  double bytes = 0;           ///< on the disk, at most

  WritingCost& operator+=(const WritingCost& other) {
    seconds += other.seconds;
    shared_seconds += other.shared_seconds;
    bytes += other.bytes;
    return *this;
  }
  double seconds_on(int threads) const { return seconds + shared_seconds / std::max(threads, 1); }
};

/// Of echoes.nc.
WritingCost cost_of_echoes(const Recording& recording, bool with_bounds);

/// Of files that are made cell by cell of a ping.
WritingCost cost_by_cells(const Recording& recording, double seconds_a_cell, double bytes_a_cell);

}  // namespace tubefoot
