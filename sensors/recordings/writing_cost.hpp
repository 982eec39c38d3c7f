// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>

#include "sensors/recordings/recording.hpp"

namespace tubefoot {

/// The expected cost of writing files. The constants are measured on one machine (validation/performance.md).
struct WritingCost {
  double seconds = 0;         ///< work of one thread
  double shared_seconds = 0;  ///< work that all threads share
  double bytes = 0;           ///< upper limit of the size on the disk

  WritingCost& operator+=(const WritingCost& other) {
    seconds += other.seconds;
    shared_seconds += other.shared_seconds;
    bytes += other.bytes;
    return *this;
  }
  double seconds_on(int threads) const { return seconds + shared_seconds / std::max(threads, 1); }
};

/// The cost of so many stored values in echoes.nc.
WritingCost cost_of_echoes(double values);

/// The cost of the received data in echoes.nc.
WritingCost cost_of_received(const Recording& recording);

/// The cost of the labels in echoes.nc, for so many objects and materials of a scene.
WritingCost cost_of_labels(const Recording& recording, std::size_t objects, std::size_t materials);

/// The cost of files whose size is proportional to the cells of a ping.
WritingCost cost_by_cells(const Recording& recording, double seconds_a_cell, double bytes_a_cell);

}  // namespace tubefoot
