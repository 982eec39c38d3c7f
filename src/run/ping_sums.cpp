// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/ping_sums.hpp"

#include <algorithm>
#include <functional>
#include <numeric>

namespace tubefoot {
namespace {

/// `rows`: [channel][beam of the shot][sample]; `all`: of the sensor's beams.
void add_rows(std::span<const double> rows, const std::vector<std::uint32_t>& beams, std::size_t channels,
              std::span<double> all) {
  const std::size_t samples = rows.size() / (beams.size() * channels),
                    all_beams = all.size() / (channels * samples);
  for (std::size_t row = 0; row < beams.size() * channels; ++row) {
    const std::size_t place = row / beams.size() * all_beams + beams[row % beams.size()];
    const std::span<double> to = all.subspan(place * samples, samples);
    const std::span<const double> from = rows.subspan(row * samples, samples);
    std::transform(from.begin(), from.end(), to.begin(), to.begin(), std::plus<>());
  }
}

}  // namespace

void keep_worst(PingCounts& kept, const PingCounts& met) {
  kept.bins_over += met.bins_over;
  if (met.worst_ratio <= kept.worst_ratio) return;
  kept.worst_ratio = met.worst_ratio;
  kept.worst_sensor = met.worst_sensor;
  kept.worst_beam = met.worst_beam;
  kept.worst_sample = met.worst_sample;
}

PingSums::PingSums(const SharedShots& group, PingStore& store, std::size_t slot)
    : store_(store), slot_(slot) {
  for (const std::size_t s : group.sensors)
    for (const std::span<double> values : {store.energy(s, slot), store.bound(s, slot)})
      std::fill(values.begin(), values.end(), 0.0);
}

void PingSums::add(const Shot& shot, std::size_t s, std::size_t order, std::span<const double> energy) {
  const std::vector<std::uint32_t>& beams = shot.sensor(s).beams_of_shot(shot.number());
  const std::size_t cells = beams.size() * static_cast<std::size_t>(shot.sensor(s).samples().count);
  counts.energy_of_order[order] +=
      std::accumulate(energy.begin(), energy.begin() + std::ptrdiff_t(cells), 0.0);
  add_rows(energy, beams, energy.size() / cells, store_.energy(s, slot_));
}

void PingSums::add(const Shot& shot, std::size_t s, const CertifiedEcho& certified, std::size_t order) {
  const std::vector<std::uint32_t>& beams = shot.sensor(s).beams_of_shot(shot.number());
  const std::size_t cells = beams.size() * static_cast<std::size_t>(shot.sensor(s).samples().count);
  add_rows(certified.bound, beams, certified.bound.size() / cells, store_.bound(s, slot_));
  PingCounts met;
  met.bins_over = certified.bins_over;
  met.worst_ratio = certified.worst_ratio;
  met.worst_sensor = static_cast<std::uint32_t>(s);
  met.worst_beam = beams[static_cast<std::size_t>(certified.worst_beam)];
  met.worst_sample = static_cast<std::uint32_t>(certified.worst_sample);
  keep_worst(counts, met);
  add(shot, s, order, certified.echo.energy);
}

void PingSums::add_finer_relief(const Shot& shot, const Sight& sight, const FacetMesh& mesh,
                                double sample_m) {
  if (const auto& omitted = shot.site().relief.omitted)
    finer_relief += tubefoot::finer_relief(sight, mesh, *omitted, sample_m);
}

}  // namespace tubefoot
