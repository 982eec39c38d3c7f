// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/echo/contributions.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace tubefoot {
namespace {

/// The samples that a footprint may reach into, with one to spare on both sides for rounding.
std::pair<int, int> reached(const Footprint& footprint, const RangeSamples& samples) {
  const auto sample_of = [&](double range_m) {
    return int(
        std::clamp(std::floor((range_m - samples.first_m) / samples.step_m), -1.0, double(samples.count)));
  };
  return {std::max(sample_of(footprint.slant_range_min_m) - 1, 0),
          std::min(sample_of(footprint.slant_range_max_m) + 2, samples.count)};
}

}  // namespace

std::vector<Contribution> contributions(const History& history, std::span<const std::uint32_t> beam_of_tube,
                                        const RangeSamples& samples, const EchoLaw& law, Binning binning,
                                        const Echo& echo, double least_share) {
  std::vector<Contribution> all;
  const std::size_t channel = std::size_t(echo.beams) * echo.samples;
  const auto take = [&](const Footprint& footprint, std::span<double> energy) {
    const auto index = std::uint32_t(&footprint - history.footprints.footprints.data());
    std::pair<std::uint32_t, std::uint32_t> beams{beam_of_tube[footprint.tube],
                                                  beam_of_tube[footprint.tube] + 1};
    if (law.patterns != nullptr) beams = law.patterns->beams_of_tube[footprint.tube];
    const auto [begin, end] = reached(footprint, samples);
    Contribution largest;
    const std::size_t before = all.size();
    for (std::uint32_t beam = beams.first; beam < beams.second; ++beam)
      for (int sample = begin; sample < end; ++sample) {
        const std::size_t cell = std::size_t(beam) * echo.samples + std::size_t(sample);
        const double part = energy[cell];
        for (std::size_t c = cell; c < energy.size(); c += channel) energy[c] = 0;
        const Contribution found{index, beam, std::uint32_t(sample), part};
        if (part > largest.energy_j) largest = found;
        if (part != 0 && std::abs(part) >= least_share * echo.energy[cell]) all.push_back(found);
      }
    if (all.size() == before && largest.energy_j > 0) all.push_back(largest);
  };
  integrate_echo(history, beam_of_tube, echo.beams, samples, law, binning, take);
  // Footprints on micro-texture come after all others.
  std::stable_sort(all.begin(), all.end(),
                   [](const Contribution& a, const Contribution& b) { return a.footprint < b.footprint; });
  return all;
}

}  // namespace tubefoot
