// SPDX-License-Identifier: GPL-3.0-or-later
#include "sensors/recordings/writing_cost.hpp"

namespace tubefoot {

WritingCost cost_of_echoes(const Recording& recording, bool with_bounds) {
  constexpr double packing_s = 8e-9, writing_s = 3e-9;  // a byte; zeros take a fifth of it
  const double values = static_cast<double>(recording.pings() * recording.cells() * recording.channels()),
               bytes = sizeof(double) * values * (with_bounds ? 2 : 1);
  return {writing_s * bytes, packing_s * bytes, bytes};
}

WritingCost cost_by_cells(const Recording& recording, double seconds_a_cell, double bytes_a_cell) {
  const auto cells = static_cast<double>(recording.pings() * recording.cells());
  return {seconds_a_cell * cells, 0, bytes_a_cell * cells};
}

}  // namespace tubefoot
