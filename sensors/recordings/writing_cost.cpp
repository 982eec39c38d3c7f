// SPDX-License-Identifier: GPL-3.0-or-later
#include "sensors/recordings/writing_cost.hpp"

namespace tubefoot {

WritingCost cost_of_echoes(double values) {
  constexpr double copying_s = 2e-10;  // per byte; the simulation compresses each ping
  const double bytes = sizeof(double) * values;
  return {copying_s * bytes, 0, bytes};
}

WritingCost cost_of_received(const Recording& recording) {
  constexpr double receiving_and_compressing_s = 3e-7, bytes_of_24_bits = 5;  // per value
  const auto values =
      static_cast<double>(recording.pings() * recording.cells()) * (recording.channels() > 1 ? 2 : 1);
  return {0, receiving_and_compressing_s * values, bytes_of_24_bits * values};
}

WritingCost cost_of_labels(const Recording& recording, std::size_t objects, std::size_t materials) {
  constexpr double compressing_s = 3.5e-8, means_and_labels = 2.5;  // per value; doubles per cell
  const double values = static_cast<double>(recording.pings() * recording.cells()) *
                        (static_cast<double>(objects + materials) + means_and_labels);
  return {compressing_s * values, 0, sizeof(double) * values};
}

WritingCost cost_by_cells(const Recording& recording, double seconds_a_cell, double bytes_a_cell) {
  const auto cells = static_cast<double>(recording.pings() * recording.cells());
  return {seconds_a_cell * cells, 0, bytes_a_cell * cells};
}

}  // namespace tubefoot
