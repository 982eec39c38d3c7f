// SPDX-License-Identifier: GPL-3.0-or-later
// Common functions of the writers of signal products: names of files, compression of a ping, selection of
// receivers, phase centre, range samples and focused beams.

#include "sensors/products/signal_makers.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "sensors/beamforming/beams.hpp"
#include "sensors/model/angles.hpp"
#include "sensors/pictures/decibel_scale.hpp"
#include "sensors/signals/matched_filter.hpp"

namespace tubefoot {

std::filesystem::path SignalJob::new_file(const std::string& ending) const {
  files.emplace_back(products.name + ending);
  return folder / files.back();
}

void SignalJob::write(const Canvas& canvas, const std::string& ending, const std::string& what) const {
  canvas.write_png(new_file(ending), products.name + ", " + what, run.pictures.bits);
}

std::string SignalJob::said_of_signals() const {
  const TransmitWaveform& waveform = signals.waveform;
  const std::string pulse =
      waveform.start_hz == waveform.stop_hz
          ? fmt::format("{:g} kHz, {:g} ms", waveform.start_hz / 1000, 1000 * waveform.duration_s)
          : fmt::format("{:g} to {:g} kHz in {:g} ms", waveform.start_hz / 1000, waveform.stop_hz / 1000,
                        1000 * waveform.duration_s);
  return fmt::format("{}, {} receiver{}", pulse, signals.receivers(), signals.receivers() == 1 ? "" : "s");
}

ElementSignals compressed_ping(const ElementSignals& signals, std::size_t ping,
                               const ApertureWindow& window) {
  const std::size_t values = signals.receivers() * signals.samples();
  const auto first = signals.pressure.begin() + static_cast<std::ptrdiff_t>(ping * values);
  ElementSignals one{
      signals.waveform,
      signals.sampling,
      signals.sound_speed_m_s,
      signals.array,
      {signals.motion.track(), {signals.motion.ping_start_s()[ping]}, signals.motion.stop_and_hop()},
      signals.matched_filtered,
      {first, first + static_cast<std::ptrdiff_t>(values)}};
  return one.matched_filtered ? one : matched_filtered(one, window);
}

ElementSignals of_receivers(const ElementSignals& one_ping, const std::vector<std::size_t>& receivers) {
  ElementSignals some = one_ping;
  some.array.receivers_m.clear();
  some.pressure.clear();
  for (const std::size_t receiver : receivers) {
    some.array.receivers_m.push_back(one_ping.array.receivers_m[receiver]);
    const auto channel = one_ping.channel(0, receiver);
    some.pressure.insert(some.pressure.end(), channel.begin(), channel.end());
  }
  return some;
}

glm::dvec3 phase_centre_m(const ElementArray& array) {
  return 0.5 * (array.transmitter_m + array.centre_m());
}

RangeSamples ranges_of(const SignalSampling& sampling, double sound_speed_m_s) {
  const double step_m = 0.5 * sound_speed_m_s / sampling.rate_hz;
  return {0.5 * sound_speed_m_s * sampling.first_s - step_m / 2, step_m, static_cast<int>(sampling.samples)};
}

std::vector<std::complex<double>> focused_beams(const ElementSignals& one,
                                                const std::vector<glm::dvec3>& directions,
                                                const std::vector<double>& weights,
                                                const SignalInterpolator& interpolator) {
  return delay_and_sum(one, 0, {directions, weights, phase_centre_m(one.array), true}, interpolator);
}

std::vector<std::complex<double>> focused_beams(const ElementSignals& one, const SignalFan& fan,
                                                const SignalInterpolator& interpolator) {
  return focused_beams(one, fan.directions(), weights_along(one.array, starboard_axis, fan.window),
                       interpolator);
}

double strength_of(std::complex<double> value, double range_m) {
  return std::norm(value) * range_m * range_m * range_m * range_m;
}

GridPanel level_panel(std::string title, std::vector<double> values, std::size_t columns) {
  GridPanel panel;
  panel.title = std::move(title);
  panel.columns = columns;
  panel.rows = values.size() / columns;
  const double largest[] = {*std::ranges::max_element(values)};
  panel.colour = [scale = DecibelScale(largest), values = std::move(values), columns](PixelSpan across,
                                                                                      PixelSpan down) {
    double sum = 0;
    for (std::size_t row = down.first; row < down.end; ++row)
      for (std::size_t column = across.first; column < across.end; ++column)
        sum += values[row * columns + column];
    return scale.colour(sum / static_cast<double>((down.end - down.first) * (across.end - across.first)));
  };
  return panel;
}

}  // namespace tubefoot
