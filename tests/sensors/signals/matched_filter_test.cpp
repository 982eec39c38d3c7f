// SPDX-License-Identifier: GPL-3.0-or-later
#include "sensors/signals/matched_filter.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "fixtures/lobes.hpp"
#include "fixtures/refusal.hpp"
#include "geometry/numbers/scalars.hpp"
#include "sensors/signals/point_signals.hpp"
#include "sensors/signals/signal_transform.hpp"

namespace tubefoot {
namespace {

using Complex = std::complex<double>;
using test::c;

/// A transmitter and a receiver at one position, and a point at a distance with a delay of `delay_s`.
ElementSignals echo(const TransmitWaveform& waveform, const SignalSampling& sampling, double delay_s) {
  return point_signals({{{0, c * delay_s / 2, 0}, {0.3, 0.4}}}, line_array(1, {0, 0, 0}), waveform, sampling,
                       VehicleMotion({{0, {}}}, {0}), c);
}

TEST(SignalTransform, HasThePlusSignAndItsInverse) {
  const SignalTransform transform(5);
  ASSERT_EQ(transform.length(), 8u);
  const std::vector<Complex> spectrum = transform.spectrum(std::vector<Complex>{0, 1});
  for (std::size_t m = 0; m < 8; ++m)
    EXPECT_LT(std::abs(spectrum[m] - std::polar(1.0, 2 * pi * double(m) / 8)), 1e-15);
  EXPECT_EQ(transform.frequency_hz(3, 80), 30);
  EXPECT_EQ(transform.frequency_hz(4, 80), -40);
  const std::vector<Complex> signal{{1, 2}, {-3, 0.5}, {0, 1}, 4, {5, -6}, 0, {7, 7}, 1};
  const std::vector<Complex> again = transform.signal(transform.spectrum(signal));
  for (std::size_t k = 0; k < 8; ++k) EXPECT_LT(std::abs(again[k] - signal[k]), 1e-14);
  expect_refused([&] { transform.spectrum(std::vector<Complex>(9)); }, "longer than its spectrum");
}

TEST(MatchedFilter, IsTheCorrelationWithWhatWasSent) {
  const SignalSampling sampling{100e3, 50e3, 0.01, 700};
  const auto waveform = linear_chirp(90e3, 112e3, 3e-3, 0.3);
  const ElementSignals signals = echo(waveform, sampling, 0.0163);
  const ElementSignals filtered = matched_filtered(signals);
  const std::vector<Complex> sent = replica(waveform, sampling);
  double gain = 0;
  for (const Complex& value : sent) gain += std::norm(value);
  for (std::size_t k = 0; k < sampling.samples; ++k) {
    Complex sum = 0;
    for (std::size_t j = 0; j < sent.size() && k + j < sampling.samples; ++j)
      sum += signals.channel(0, 0)[k + j] * std::conj(sent[j]);
    EXPECT_LT(std::abs(filtered.channel(0, 0)[k] - sum / gain), 1e-12);
  }
  EXPECT_TRUE(filtered.matched_filtered);
  expect_refused([&] { matched_filtered(filtered); }, "already matched filtered");
}

TEST(MatchedFilter, PutsThePeakAtTheDelayWithAmplitudeAndPhase) {
  const SignalSampling sampling{100e3, 100e3, 0, 4000};
  constexpr double delay_s = 0.02;  // sample 2000
  for (const auto& waveform : {continuous_wave_pulse(103e3, 1e-3, 0.5), linear_chirp(80e3, 120e3, 2e-3, 0.2)})
    for (const auto law : {ApertureWindow::Law::uniform, ApertureWindow::Law::hann}) {
      const ElementSignals filtered = matched_filtered(echo(waveform, sampling, delay_s), {law});
      const Complex peak = filtered.channel(0, 0)[2000];
      const Complex expected = Complex(0.3, 0.4) * std::polar(1 / (15.0 * 15.0), 2 * pi * 100e3 * delay_s);
      EXPECT_LT(std::abs(peak - expected), 1e-9 / 225);
      for (const Complex& value : filtered.channel(0, 0))
        EXPECT_LE(std::abs(value), std::abs(peak) * (1 + 1e-9));
    }
}

TEST(MatchedFilter, ResolvesAChirpAsTheWindowsTheorySays) {
  // The spectrum of a long chirp is uniform: the compressed pulse is the transform of its window.
  const SignalSampling sampling{100e3, 4e6, 0.01, 60000};
  const auto waveform = linear_chirp(80e3, 120e3, 10e-3);  // time times bandwidth 400
  const ElementSignals signals = echo(waveform, sampling, 0.0145);
  struct {
    ApertureWindow window;
    double width, side_lobe_db, tolerance_db;
  } const cases[] = {{{ApertureWindow::Law::uniform}, 0.8859, -13.26, 0.1},
                     {{ApertureWindow::Law::taylor, 30, 4}, 1.1189, -30, 0.6}};
  for (const auto& [window, width, side_lobe_db, tolerance_db] : cases) {
    const ElementSignals filtered = matched_filtered(signals, window);
    std::vector<double> modulus;
    for (std::size_t k = 17600; k < 18400; ++k) modulus.push_back(std::abs(filtered.channel(0, 0)[k]));
    const LobeFigures figures = lobe_figures(modulus, 0.01 + 17600 / 4e6, 1 / 4e6);
    EXPECT_NEAR(figures.peak_at, 0.0145, 1e-9);
    EXPECT_NEAR(figures.half_power_width * 40e3, width, 0.02 * width);
    EXPECT_NEAR(figures.highest_side_lobe_db, side_lobe_db, tolerance_db);
  }
}

}  // namespace
}  // namespace tubefoot
