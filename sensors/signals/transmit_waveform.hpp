// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <complex>
#include <cstddef>

namespace tubefoot {

// Signals are analytic with the time factor e^{-i omega t}: a pulse is p(t) = g(t) e^{-i phi(t)} with a real
// envelope g, and its complex baseband about the frequency f_b is p(t) e^{+2 pi i f_b t}. What comes later by
// tau has the phase e^{+2 pi i f_b tau}.

/// What a sonar transmits: a pulse of one frequency, or a chirp whose frequency goes evenly from `start_hz`
/// to `stop_hz`. Its envelope has raised-cosine flanks; the energy, the integral of g^2, is 1.
struct TransmitWaveform {
  double start_hz = 0, stop_hz = 0;  ///< equal: a pulse of one frequency
  double duration_s = 0;
  double taper = 0;  ///< share of the duration in both flanks together: 0 a rectangle, 1 a Hann window

  double centre_hz() const { return 0.5 * (start_hz + stop_hz); }
  double chirp_rate_hz_s() const { return (stop_hz - start_hz) / duration_s; }
};

TransmitWaveform continuous_wave_pulse(double frequency_hz, double duration_s, double taper = 0);
TransmitWaveform linear_chirp(double start_hz, double stop_hz, double duration_s, double taper = 0);

/// Envelope g [s^-1/2] at a time after the beginning; 0 outside of [0, duration].
double envelope_at(const TransmitWaveform& waveform, double time_s);
/// Complex baseband about `baseband_hz` [s^-1/2].
std::complex<double> baseband_at(const TransmitWaveform& waveform, double baseband_hz, double time_s);

struct FrequencyBand {
  double low_hz = 0, high_hz = 0;
};
/// All frequencies that are swept, and on either side half the main lobe of the envelope's own spectrum:
/// (1 + taper) / duration.
FrequencyBand band_of(const TransmitWaveform& waveform);

/// How a receiver samples: complex baseband about one frequency.
struct SignalSampling {
  double baseband_hz = 0;
  double rate_hz = 0;  ///< complex samples a second: they hold frequencies within half of it
  double first_s = 0;  ///< of sample 0, after the start of the ping
  std::size_t samples = 0;

  double time_s(std::size_t sample) const { return first_s + static_cast<double>(sample) / rate_hz; }
  double end_s() const { return time_s(samples); }
};

// Each throws std::invalid_argument that says what is wrong with which value and what to do.

/// Frequencies above 0, a duration above 0, a taper within 0 and 1; all finite.
void check(const TransmitWaveform& waveform);
/// Rates and counts above 0; at least one sample.
void check(const SignalSampling& sampling);
/// The band lies within half the sampling rate about the baseband frequency, and the waveform is no longer
/// than what is recorded of a ping.
void check_sampled(const TransmitWaveform& waveform, const SignalSampling& sampling);
/// The shortest wavelength of the band is at least twice the world grid's unit: shorter ones would see the
/// grid that vertices are snapped to.
void check_wavelength(const TransmitWaveform& waveform, double sound_speed_m_s, double grid_unit_m);

}  // namespace tubefoot
