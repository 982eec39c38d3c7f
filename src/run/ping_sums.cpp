// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/ping_sums.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <numeric>
#include <optional>

#include "engine/certified/receiver_pair_reference.hpp"

// This file adds the contributions to a transmission to the energies, bounds, labels and signals of a ping.
// It keeps only the selected beams.

namespace tubefoot {
namespace {

void add_to(std::span<double> sums, std::span<const double> values) {
  std::transform(values.begin(), values.end(), sums.begin(), sums.begin(), std::plus<>());
}

/// Calls visit(row, index of the beam's first row in the stored values) for the rows [channel][beam of the
/// transmission] of the selected beams.
template <class Visit>
void each_chosen_row(std::size_t rows, const std::vector<std::uint32_t>& beams, const ChosenEchoes& chosen,
                     const Visit& visit) {
  for (std::size_t row = 0; row < rows; ++row)
    if (const std::optional<std::size_t> beam = chosen.place_of(beams[row % beams.size()]))
      visit(row, row / beams.size() * chosen.beams.size() + *beam);
}

/// `rows`: [channel][beam of the transmission][sample]. `all`: values of the sensor's selected beams.
/// `first` and `all_samples` give the position of a row's samples in those of the sensor.
void add_rows(std::span<const double> rows, const std::vector<std::uint32_t>& beams, std::size_t channels,
              const ChosenEchoes& chosen, std::size_t first, std::size_t all_samples, std::span<double> all) {
  const std::size_t samples = rows.size() / (beams.size() * channels);
  each_chosen_row(beams.size() * channels, beams, chosen, [&](std::size_t row, std::size_t place) {
    add_to(all.subspan(place * all_samples + first, samples), rows.subspan(row * samples, samples));
  });
}

std::size_t sample_count(const RangeSamples& samples) { return static_cast<std::size_t>(samples.count); }

/// Compares the bounds of the selected beams with the tolerance if some beams of a transmission are not
/// selected. The tolerance refers to the whole transmission.
void count_chosen(CertifiedEcho& certified, const Sensor& sensor, const std::vector<std::uint32_t>& beams,
                  const ChosenEchoes& chosen, double tolerance) {
  const auto samples = static_cast<std::size_t>(certified.echo.samples);
  const auto row_of = [&](std::vector<double>& values, std::size_t row) {
    return std::span(values).subspan(row * samples, samples);
  };
  if (!sensor.has_receiver_pair()) {
    for (std::size_t beam = 0; beam < beams.size(); ++beam)
      if (!chosen.place_of(beams[beam])) std::ranges::fill(row_of(certified.bound, beam), 0.0);
    compare_with(certified, tolerance);
    return;
  }
  certified.bins_over = 0;
  certified.worst_ratio = 0;
  for (std::size_t beam = 0; beam < beams.size(); ++beam) {
    if (!chosen.place_of(beams[beam])) continue;
    CertifiedEcho own{{sensor.channels(), certified.echo.samples, {}}, {}};
    for (std::size_t row = beam; row < certified.bound.size() / samples; row += beams.size()) {
      std::ranges::copy(row_of(certified.echo.energy, row), std::back_inserter(own.echo.energy));
      std::ranges::copy(row_of(certified.bound, row), std::back_inserter(own.bound));
    }
    compare_receiver_pair_with(own, tolerance);
    certified.bins_over += own.bins_over;
    if (!(own.worst_ratio > certified.worst_ratio)) continue;
    certified.worst_ratio = own.worst_ratio;
    certified.worst_beam = static_cast<int>(beam);
    certified.worst_sample = own.worst_sample;
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

void PingSums::add_to_channel(const Transmission& transmission, std::size_t s, std::string_view channel,
                              std::size_t array, std::span<const double> values) {
  if (chosen(s).pings == 0) return;
  const std::vector<std::uint32_t>& beams =
      transmission.sensor(s).beams_of_transmission(transmission.number());
  const Sensor& sensor = transmission.sensor(s);
  const std::size_t all_samples = sample_count(sensor.samples()), all = chosen(s).beams.size() * all_samples;
  add_rows(values.first(beams.size() * sample_count(transmission.samples(s))), beams, 1, chosen(s),
           sensor.first_sample(transmission.number()), all_samples,
           values_.of(s, channel).subspan(array * all, all));
}

void PingSums::add_to_beams(const Transmission& transmission, std::size_t s, std::string_view channel,
                            std::span<const double> values) {
  if (chosen(s).pings == 0) return;
  add_rows(values, transmission.sensor(s).beams_of_transmission(transmission.number()), 1, chosen(s), 0, 1,
           values_.of(s, channel));
}

void PingSums::add_signals(std::size_t s, std::span<const double> values, std::span<const double> bounds) {
  add_to_signals(s, "signals", values);
  if (!bounds.empty()) add_to_signals(s, "signals_bound", bounds);
}

void PingSums::add_to_signals(std::size_t s, std::string_view channel, std::span<const double> values) {
  add_to(values_.of(s, channel), values);
}

void PingSums::with_echo(const Transmission& transmission, const CommonVisibility& visibility, std::size_t s,
                         const EchoModel& model, const std::function<void(const Echo&)>& use) {
  const std::vector<std::uint32_t> fans = transmission.sensor(s).fan_of_tube(transmission.number());
  Echo echo = integrate_echo(visibility, transmission.beams_by_fans(s, fans), transmission.samples(s), model,
                             transmission.request().binning, values_.take_echo_room());
  use(echo);
  values_.give_back_echo_room(cleared_buffer(std::move(echo)));
}

void PingSums::add(const Transmission& transmission, std::size_t s, std::size_t order,
                   std::span<const double> energy, std::span<const SampleSpan> nonzero) {
  if (chosen(s).pings == 0) return;
  const std::vector<std::uint32_t>& beams =
      transmission.sensor(s).beams_of_transmission(transmission.number());
  const Sensor& sensor = transmission.sensor(s);
  const std::size_t samples = sample_count(transmission.samples(s)),
                    all_samples = sample_count(sensor.samples()),
                    first_sample = sensor.first_sample(transmission.number());
  // Zeros do not change a sum, so that samples outside of `nonzero` are skipped.
  double sum = 0;
  each_chosen_row(energy.size() / samples, beams, chosen(s), [&](std::size_t row, std::size_t place) {
    const auto [first, end] = nonzero.empty() ? SampleSpan{0, samples} : nonzero[row];
    const std::span<const double> values = energy.subspan(row * samples + first, end - first);
    if (row < beams.size()) sum = std::accumulate(values.begin(), values.end(), sum);
    add_to(values_.of(s, "energy", place * all_samples + first_sample + first, values.size()), values);
  });
  counts.energy_of_order[order] += sum;
}

void PingSums::add(const Transmission& transmission, std::size_t s, const CertifiedEcho& certified,
                   std::size_t order) {
  if (chosen(s).pings == 0) return;
  const Sensor& sensor = transmission.sensor(s);
  const std::vector<std::uint32_t>& beams = sensor.beams_of_transmission(transmission.number());
  const std::size_t samples = sample_count(transmission.samples(s)),
                    first_sample = sensor.first_sample(transmission.number());
  add_rows(certified.bound, beams, certified.bound.size() / (beams.size() * samples), chosen(s), first_sample,
           sample_count(sensor.samples()), values_.of(s, "energy_bound"));
  each_chosen_row(certified.bound.size() / samples, beams, chosen(s), [&](std::size_t row, std::size_t) {
    counts.refraction.unbounded += static_cast<std::uint64_t>(
        std::ranges::count_if(std::span(certified.bound).subspan(row * samples, samples),
                              [](double bound) { return !std::isfinite(bound); }));
  });
  const auto keep = [&](const CertifiedEcho& counted) {
    PingCounts met;
    met.bins_over = counted.bins_over;
    met.worst_ratio = counted.worst_ratio;
    met.worst_sensor = static_cast<std::uint32_t>(s);
    met.worst_beam = beams[static_cast<std::size_t>(counted.worst_beam)];
    met.worst_sample =
        static_cast<std::uint32_t>(first_sample) + static_cast<std::uint32_t>(counted.worst_sample);
    keep_worst(counts, met);
  };
  if (chosen(s).all_beams) {
    keep(certified);
  } else {
    CertifiedEcho some = certified;
    count_chosen(some, sensor, beams, chosen(s), *transmission.request().reference_tolerance);
    keep(some);
  }
  add(transmission, s, order, certified.echo.energy);
}

void PingSums::add_finer_relief(const Transmission& transmission, const CommonVisibility& visibility,
                                const FacetMesh& mesh, double sample_m) {
  if (const auto& omitted = transmission.loaded_scene().relief.omitted)
    finer_relief += tubefoot::finer_relief(visibility, mesh, *omitted, sample_m);
}

}  // namespace tubefoot
