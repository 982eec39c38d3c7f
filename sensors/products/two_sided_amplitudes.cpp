// SPDX-License-Identifier: GPL-3.0-or-later
#include "sensors/products/two_sided_amplitudes.hpp"

#include <algorithm>
#include <cmath>

#include "geometry/steps/in_order.hpp"

namespace tubefoot {
namespace {

struct ScaledPing {
  std::vector<float> amplitudes;
  float largest = 0;
  std::vector<float> logarithms;  ///< of amplitudes above zero
};

/// A map has no value where there is no surface, which differs from shadow.
void mark_no_surface(const Recording& recording, std::size_t ping, std::vector<float>& amplitudes) {
  if (!recording.surfaces) return;
  const std::vector<int> surfaces = recording.surfaces(ping);
  const auto count = static_cast<std::size_t>(recording.sensor->samples().count);
  for (std::size_t beam = 0; beam < surfaces.size(); ++beam)
    for (auto k = static_cast<std::size_t>(surfaces[beam]); k < count; ++k)
      if (float& amplitude = amplitudes[beam * count + k]; !(amplitude > 0)) amplitude = std::nanf("");
}

}  // namespace

TwoSidedAmplitudes::TwoSidedAmplitudes(const Recording& recording, const RunContext& run,
                                       const std::filesystem::path& beside, bool for_a_map)
    : recording_(recording), rows_(beside) {
  const ReceivedPings received(recording, run);
  Steps steps("pings read to find the scale of the amplitudes", recording.pings());
  const auto make = [&](std::size_t ping) {
    ScaledPing made;
    for (const double energy : received.of(ping)) {
      const auto value = static_cast<float>(received.chain().amplitude_upa(energy));
      made.amplitudes.push_back(value);
      made.largest = std::max(made.largest, value);
      if (!(value <= 0)) made.logarithms.push_back(std::log(value));
    }
    // The energies are loaded at this point, and the samples with surfaces depend on them too.
    if (for_a_map) mark_no_surface(recording, ping, made.amplitudes);
    return made;
  };
  in_order(steps, 0, recording.pings(), 2 * sizeof(float) * recording.cells(), make,
           [&](std::size_t, const ScaledPing& made) {
             rows_.add(made.amplitudes.data(), made.amplitudes.size() * sizeof(float));
             largest_ = std::max(largest_, made.largest);
             for (const float logarithm : made.logarithms) sum_of_logarithms_ += logarithm;
             echoes_ += made.logarithms.size();
           });
}

std::vector<float> TwoSidedAmplitudes::of(std::size_t ping) const {
  stop_if_wanted();
  std::vector<float> amplitudes(recording_.cells());
  const std::size_t bytes = amplitudes.size() * sizeof(float);
  rows_.read(ping * bytes, amplitudes.data(), bytes);
  return amplitudes;
}

double TwoSidedAmplitudes::white_upa() const {
  if (echoes_ == 0) return 1;
  const double mean_level_upa = std::exp(sum_of_logarithms_ / static_cast<double>(echoes_));
  return std::min(largest_upa(), mean_level_upa * std::pow(10, 15.0 / 20)) *
         std::pow(10, -recording_.sensor->description().signal.display_gain_db / 20);
}

}  // namespace tubefoot
