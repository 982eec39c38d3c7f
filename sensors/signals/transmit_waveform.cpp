// SPDX-License-Identifier: GPL-3.0-or-later
// Waveforms of a sonar, single-frequency pulses and linear chirps: envelope, complex baseband, band and
// checks of their sampling. The envelope has raised-cosine flanks and unit energy.

#include "sensors/signals/transmit_waveform.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "sensors/signals/require.hpp"

namespace tubefoot {
namespace {

using std::numbers::pi;

void require_positive(double value, const char* name, const char* unit) {
  require(value > 0 && std::isfinite(value),
          fmt::format("the {} is {} {}, but must be above 0 and finite", name, value, unit));
}

}  // namespace

TransmitWaveform continuous_wave_pulse(double frequency_hz, double duration_s, double taper) {
  return {frequency_hz, frequency_hz, duration_s, taper};
}

TransmitWaveform linear_chirp(double start_hz, double stop_hz, double duration_s, double taper) {
  return {start_hz, stop_hz, duration_s, taper};
}

double envelope_at(const TransmitWaveform& waveform, double time_s) {
  const double length = waveform.duration_s;
  if (!(time_s >= 0 && time_s <= length)) return 0;
  // The mean square of the flanks is 3/8, and that of the part between them is 1.
  const double height = 1 / std::sqrt(length * (1 - 0.625 * waveform.taper));
  const double flank = 0.5 * waveform.taper * length, from_end = std::min(time_s, length - time_s);
  if (from_end >= flank) return height;
  return height * 0.5 * (1 - std::cos(pi * from_end / flank));
}

std::complex<double> baseband_at(const TransmitWaveform& waveform, double baseband_hz, double time_s) {
  const double envelope = envelope_at(waveform, time_s);
  if (envelope == 0) return 0;
  const double cycles =
      (waveform.start_hz - baseband_hz + 0.5 * waveform.chirp_rate_hz_s() * time_s) * time_s;
  return std::polar(envelope, -2 * pi * cycles);
}

std::complex<double> baseband_slope_at(const TransmitWaveform& waveform, double baseband_hz, double time_s) {
  const double length = waveform.duration_s, flank = 0.5 * waveform.taper * length;
  if (!(time_s >= 0 && time_s <= length)) return 0;
  const double from_end = std::min(time_s, length - time_s),
               height = 1 / std::sqrt(length * (1 - 0.625 * waveform.taper)),
               steep = from_end < flank ? height * 0.5 * pi / flank * std::sin(pi * from_end / flank) : 0,
               hz = waveform.start_hz - baseband_hz + waveform.chirp_rate_hz_s() * time_s,
               cycles =
                   (waveform.start_hz - baseband_hz + 0.5 * waveform.chirp_rate_hz_s() * time_s) * time_s;
  return std::complex<double>(time_s < length / 2 ? steep : -steep,
                              -2 * pi * hz * envelope_at(waveform, time_s)) *
         std::polar(1.0, -2 * pi * cycles);
}

FrequencyBand band_of(const TransmitWaveform& waveform) {
  const double lobe_hz = (1 + waveform.taper) / waveform.duration_s;
  const auto [low_hz, high_hz] = std::minmax(waveform.start_hz, waveform.stop_hz);
  return {low_hz - lobe_hz, high_hz + lobe_hz};
}

void check(const TransmitWaveform& waveform) {
  require_positive(waveform.start_hz, "first frequency of the waveform", "Hz");
  require_positive(waveform.stop_hz, "last frequency of the waveform", "Hz");
  require_positive(waveform.duration_s, "duration of the waveform", "s");
  require(waveform.taper >= 0 && waveform.taper <= 1,
          fmt::format("the taper of the waveform is {}, but must be between 0 (rectangle) and 1 (Hann)",
                      waveform.taper));
  const FrequencyBand band = band_of(waveform);
  require(band.low_hz > 0,
          fmt::format("the waveform of {:.6g} s is too short for {:.6g} Hz, because its band reaches down to "
                      "{:.6g} Hz: increase its length or its frequency",
                      waveform.duration_s, std::min(waveform.start_hz, waveform.stop_hz), band.low_hz));
}

void check(const SignalSampling& sampling) {
  require_positive(sampling.baseband_hz, "baseband frequency", "Hz");
  require_positive(sampling.rate_hz, "sampling rate", "Hz");
  require(std::isfinite(sampling.first_s),
          fmt::format("the time of the first sample is {} s, but must be finite", sampling.first_s));
  require(sampling.samples > 0, "there are no samples: record at least one sample per ping");
}

void check_sampled(const TransmitWaveform& waveform, const SignalSampling& sampling) {
  check(waveform);
  check(sampling);
  const FrequencyBand band = band_of(waveform);
  const double half_hz = sampling.rate_hz / 2;
  const double needed_hz =
      std::max(std::abs(band.low_hz - sampling.baseband_hz), std::abs(band.high_hz - sampling.baseband_hz));
  require(needed_hz <= half_hz,
          fmt::format("the band of the waveform from {:.6g} Hz to {:.6g} Hz extends {:.6g} Hz from the "
                      "baseband frequency {:.6g} Hz, more than half of the sampling rate, {:.6g} Hz: sample "
                      "at {:.6g} Hz or more, or choose a baseband frequency in the middle of the band",
                      band.low_hz, band.high_hz, needed_hz, sampling.baseband_hz, half_hz, 2 * needed_hz));
  const double recorded_s = static_cast<double>(sampling.samples) / sampling.rate_hz;
  require(waveform.duration_s <= recorded_s,
          fmt::format("the waveform of {:.6g} s is longer than the record of {:.6g} s per ping: record {} "
                      "samples or more, or shorten the waveform",
                      waveform.duration_s, recorded_s, std::ceil(waveform.duration_s * sampling.rate_hz)));
}

void check_wavelength(const TransmitWaveform& waveform, double sound_speed_m_s, double grid_unit_m) {
  check(waveform);
  require_positive(sound_speed_m_s, "sound speed", "m/s");
  const double high_hz = band_of(waveform).high_hz, shortest_m = sound_speed_m_s / high_hz;
  require(shortest_m >= 2 * grid_unit_m,
          fmt::format("the shortest wavelength, {:.6g} m at {:.6g} Hz, is less than twice the unit of the "
                      "world grid, {:.6g} m: reduce the frequency to {:.6g} Hz, or make the scene smaller",
                      shortest_m, high_hz, grid_unit_m, sound_speed_m_s / (2 * grid_unit_m)));
}

}  // namespace tubefoot
