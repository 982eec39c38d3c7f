// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <complex>
#include <cstddef>

namespace tubefoot {

// Signals are analytic with the time factor e^{-i omega t}. A pulse is p(t) = g(t) e^{-i phi(t)} with a real
// envelope g. Its complex baseband about the frequency f_b is p(t) e^{+2 pi i f_b t}. A delay of tau has the
// phase e^{+2 pi i f_b tau}.

/// The waveform of a transmission: a pulse of one frequency, or a chirp whose frequency changes linearly
/// from `start_hz` to `stop_hz`. Its envelope has raised-cosine flanks. The energy, the integral of g^2, is
/// 1.
struct TransmitWaveform {
  double start_hz = 0, stop_hz = 0;  ///< equal: a pulse of one frequency
  double duration_s = 0;
  double taper = 0;  ///< share of the duration in both flanks together: 0 for a rectangle, 1 for a Hann
                     ///< window

  double centre_hz() const { return 0.5 * (start_hz + stop_hz); }
  double chirp_rate_hz_s() const { return (stop_hz - start_hz) / duration_s; }
};

TransmitWaveform continuous_wave_pulse(double frequency_hz, double duration_s, double taper = 0);
TransmitWaveform linear_chirp(double start_hz, double stop_hz, double duration_s, double taper = 0);

/// Envelope g [s^-1/2] at a time after the beginning; 0 outside of [0, duration].
double envelope_at(const TransmitWaveform& waveform, double time_s);
/// Complex baseband about `baseband_hz` [s^-1/2].
std::complex<double> baseband_at(const TransmitWaveform& waveform, double baseband_hz, double time_s);
/// Derivative of baseband_at() by time, for a waveform with flanks.
std::complex<double> baseband_slope_at(const TransmitWaveform& waveform, double baseband_hz, double time_s);

struct FrequencyBand {
  double low_hz = 0, high_hz = 0;
};
/// The frequencies of the sweep, and on either side half the main lobe of the envelope's spectrum: (1 +
/// taper) / duration.
FrequencyBand band_of(const TransmitWaveform& waveform);

/// Sampling of a receiver: complex baseband about one frequency.
struct SignalSampling {
  double baseband_hz = 0;
  double rate_hz = 0;  ///< complex samples per second; they represent frequencies within half of this rate
  double first_s = 0;  ///< time of sample 0 after the start of the ping
  std::size_t samples = 0;

  double time_s(std::size_t sample) const { return first_s + static_cast<double>(sample) / rate_hz; }
  double end_s() const { return time_s(samples); }
};

// Each function throws std::invalid_argument; the message names the invalid value and gives advice.

/// Requires frequencies above 0, a duration above 0 and a taper between 0 and 1, all finite.
void check(const TransmitWaveform& waveform);
/// Requires rates and counts above 0 and at least one sample.
void check(const SignalSampling& sampling);
/// Requires that the band lies within half the sampling rate about the baseband frequency. The waveform must
/// not be longer than the record of a ping.
void check_sampled(const TransmitWaveform& waveform, const SignalSampling& sampling);
/// Requires that the band's shortest wavelength is at least twice the unit of the world grid. The grid
/// rounds vertices and would disturb shorter waves.
void check_wavelength(const TransmitWaveform& waveform, double sound_speed_m_s, double grid_unit_m);

}  // namespace tubefoot
