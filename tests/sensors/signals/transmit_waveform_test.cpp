// SPDX-License-Identifier: GPL-3.0-or-later
#include "sensors/signals/transmit_waveform.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "fixtures/refusal.hpp"
#include "geometry/numbers/scalars.hpp"

namespace tubefoot {
namespace {

TEST(TransmitWaveform, HasTheEnergyOneWhateverItsFlanks) {
  for (const double taper : {0.0, 0.1, 0.5, 1.0}) {
    const TransmitWaveform waveform = linear_chirp(90e3, 110e3, 3e-3, taper);
    constexpr int steps = 30000;
    double energy = 0;
    for (int k = 0; k < steps; ++k)
      energy += std::norm(baseband_at(waveform, 100e3, (k + 0.5) * 3e-3 / steps)) * 3e-3 / steps;
    EXPECT_NEAR(energy, 1, 1e-9) << taper;
    EXPECT_EQ(envelope_at(waveform, -1e-9), 0);
    EXPECT_EQ(envelope_at(waveform, 3e-3 + 1e-9), 0);
  }
}

TEST(TransmitWaveform, FallsBehindInPhaseByItsFrequencyAboveTheBaseband) {
  constexpr double step_s = 1e-8;
  const auto frequency_at = [&](const TransmitWaveform& waveform, double time_s) {
    const std::complex<double> turn = baseband_at(waveform, 100e3, time_s + step_s) *
                                      std::conj(baseband_at(waveform, 100e3, time_s - step_s));
    return 100e3 - std::atan2(turn.imag(), turn.real()) / (4 * pi * step_s);  // e^{-i omega t}
  };
  for (const double part : {0.1, 0.37, 0.9}) {
    EXPECT_NEAR(frequency_at(continuous_wave_pulse(103e3, 2e-3, 0.3), part * 2e-3), 103e3, 1e-2);
    EXPECT_NEAR(frequency_at(linear_chirp(95e3, 107e3, 2e-3, 0.3), part * 2e-3), 95e3 + part * 12e3, 1e-2);
    EXPECT_NEAR(frequency_at(linear_chirp(107e3, 95e3, 2e-3), part * 2e-3), 107e3 - part * 12e3, 1e-2);
  }
}

TEST(TransmitWaveform, SlopeEqualsCentralDifferences) {
  for (const double taper : {0.3, 1.0}) {
    const TransmitWaveform waveform = linear_chirp(90e3, 110e3, 2e-3, taper);
    const double step = 1e-10, rate = std::abs(baseband_slope_at(waveform, 95e3, 1.9e-3));
    for (const double time : {1e-5, 2e-4, 1e-3, 1.7e-3, 1.99e-3}) {
      const auto difference =
          (baseband_at(waveform, 95e3, time + step) - baseband_at(waveform, 95e3, time - step)) / (2 * step);
      EXPECT_LT(std::abs(baseband_slope_at(waveform, 95e3, time) - difference), 1e-5 * rate) << time;
    }
    for (const double time : {-1e-5, 2.01e-3}) EXPECT_EQ(baseband_slope_at(waveform, 95e3, time), 0.0);
  }
}

TEST(TransmitWaveform, HasTheBandOfItsSweepAndOfItsEnvelope) {
  EXPECT_NEAR(band_of(continuous_wave_pulse(100e3, 1e-3)).high_hz, 101e3, 1e-6);
  EXPECT_NEAR(band_of(continuous_wave_pulse(100e3, 1e-3, 1)).low_hz, 98e3, 1e-6);
  EXPECT_NEAR(band_of(linear_chirp(110e3, 90e3, 1e-2, 0.5)).low_hz, 90e3 - 150, 1e-6);
}

TEST(TransmitWaveform, RefusesWhatCannotBeSampled) {
  const SignalSampling sampling{100e3, 24e3, 0, 240};
  const auto refused = [&](const TransmitWaveform& waveform, const std::string& what) {
    expect_refused([&] { check_sampled(waveform, sampling); }, what);
  };
  EXPECT_NO_THROW(check_sampled(linear_chirp(90e3, 110e3, 10e-3), sampling));
  refused(linear_chirp(87e3, 110e3, 10e-3),
          "extends 13100 Hz from the baseband frequency 100000 Hz, more than half of the sampling rate, "
          "12000 Hz: "
          "sample at 26200 Hz or more, or choose a baseband frequency in the middle of the band");
  refused(linear_chirp(90e3, 110e3, 11e-3),
          "the waveform of 0.011 s is longer than the record of 0.01 s per ping: record 264 samples");
  refused(continuous_wave_pulse(-1, 1e-3), "first frequency of the waveform is -1 Hz, but must be above 0");
  refused(continuous_wave_pulse(100e3, NAN), "duration of the waveform is nan s");
  refused(continuous_wave_pulse(100e3, 1e-3, 1.5),
          "taper of the waveform is 1.5, but must be between 0 (rectangle) and 1 (Hann)");
  refused(continuous_wave_pulse(100e3, 1e-6), "too short for 100000 Hz");
  SignalSampling empty = sampling;
  empty.samples = 0;
  expect_refused([&] { check(empty); }, "record at least one");
  empty.samples = 1, empty.rate_hz = 0;
  expect_refused([&] { check(empty); }, "sampling rate is 0 Hz");
}

TEST(TransmitWaveform, RefusesWavelengthsThatSeeTheWorldGrid) {
  EXPECT_NO_THROW(check_wavelength(continuous_wave_pulse(1.8e6, 1e-4), 1500, 0x1p-20));
  expect_refused(
      [] { check_wavelength(continuous_wave_pulse(1e9, 1e-6), 1500, 0x1p-20); },
      "less than twice the unit of the world grid, 9.53674e-07 m: reduce the frequency to 7.86432e+08 Hz");
  EXPECT_NO_THROW(check_wavelength(continuous_wave_pulse(1e9, 1e-6), 2000, 0x1p-20));
}

}  // namespace
}  // namespace tubefoot
