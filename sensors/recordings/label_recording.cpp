// SPDX-License-Identifier: GPL-3.0-or-later
#include "sensors/recordings/label_recording.hpp"

#include <algorithm>
#include <limits>

#include "geometry/steps/stop.hpp"

namespace tubefoot {
namespace {

/// `energies`: [label][cell], or shares of them.
std::vector<std::int16_t> labels_of(std::span<const double> energies, std::size_t cells) {
  std::vector<std::int16_t> labels(cells, LabelRecording::no_label);
  for (std::size_t cell = 0; cell < cells; ++cell) {
    double largest = 0;
    for (std::size_t k = 0; k * cells < energies.size(); ++k)
      if (energies[k * cells + cell] > largest) {
        largest = energies[k * cells + cell];
        labels[cell] = static_cast<std::int16_t>(k);
      }
  }
  return labels;
}

}  // namespace

LabelPing LabelRecording::of(std::size_t ping) const {
  stop_if_wanted();
  const PingEnergies kept = recorded.of(ping, channels() * cells);
  const std::span<const double> all = kept;
  const auto channel = [&](std::size_t k) { return all.subspan(k * cells, cells); };
  constexpr double none = std::numeric_limits<double>::quiet_NaN();
  LabelPing ping_labels;
  ping_labels.object_share.assign(objects.size() * cells, 0);
  ping_labels.material_share.assign(materials.size() * cells, 0);
  if (has_unscattered) ping_labels.unscattered_share.assign(cells, 0);
  ping_labels.mean_height.assign(cells, none);
  ping_labels.mean_range.assign(cells, none);
  for (std::size_t cell = 0; cell < cells; ++cell) {
    // Patterns are evaluated as polynomials. Next to their zeros rounding may produce an energy below 0.
    const auto energy = [&](std::size_t k) { return std::max(channel(k)[cell], 0.0); };
    double scattered = 0;
    for (std::size_t k = 0; k < owners.size(); ++k) scattered += energy(k);
    const double straight = has_unscattered ? energy(owners.size() + 2) : 0, whole = scattered + straight;
    if (!(whole > 0)) continue;
    for (std::size_t k = 0; k < owners.size(); ++k) {
      ping_labels.object_share[owners[k].object * cells + cell] += energy(k) / whole;
      ping_labels.material_share[owners[k].material * cells + cell] += energy(k) / whole;
    }
    if (has_unscattered) ping_labels.unscattered_share[cell] = straight / whole;
    if (!(scattered > 0)) continue;
    ping_labels.mean_height[cell] = channel(owners.size())[cell] / scattered;
    ping_labels.mean_range[cell] = channel(owners.size() + 1)[cell] / scattered;
  }
  if (!label_level_db) {
    ping_labels.object_label = labels_of(ping_labels.object_share, cells);
    ping_labels.material_label = labels_of(ping_labels.material_share, cells);
    return ping_labels;
  }
  std::vector<double> of_object(objects.size() * cells), of_material(materials.size() * cells);
  for (std::size_t k = 0; k < owners.size(); ++k) {
    const std::span<const double> near_peak = channel(first_near_peak() + k);
    for (std::size_t cell = 0; cell < cells; ++cell) {
      const double energy = std::max(near_peak[cell], 0.0);
      of_object[owners[k].object * cells + cell] += energy;
      of_material[owners[k].material * cells + cell] += energy;
    }
  }
  ping_labels.object_label = labels_of(of_object, cells);
  ping_labels.material_label = labels_of(of_material, cells);
  return ping_labels;
}

}  // namespace tubefoot
