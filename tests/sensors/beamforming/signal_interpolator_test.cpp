// SPDX-License-Identifier: GPL-3.0-or-later
#include "sensors/beamforming/signal_interpolator.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "fixtures/refusal.hpp"
#include "geometry/numbers/scalars.hpp"

namespace tubefoot {
namespace {

using Complex = std::complex<double>;

std::vector<Complex> tone(double part_of_half_rate, std::size_t samples) {
  std::vector<Complex> signal;
  for (std::size_t k = 0; k < samples; ++k)
    signal.push_back(std::polar(1.0, pi * part_of_half_rate * double(k)));
  return signal;
}

double worst_error(const SignalInterpolator& interpolator) {
  double worst = 0;
  for (double part = -interpolator.band(); part <= interpolator.band() + 1e-9;
       part += interpolator.band() / 20) {
    const std::vector<Complex> signal = tone(part, 2 * interpolator.taps() + 4);
    const double middle = double(interpolator.taps());
    for (double fraction = 0; fraction < 1; fraction += 0.0173)
      worst = std::max(worst, std::abs(interpolator.at(signal, middle + fraction) -
                                       std::polar(1.0, pi * part * (middle + fraction))));
  }
  return worst;
}

TEST(SignalInterpolator, IsAsGoodAsItSays) {
  for (const double band : {0.3, 0.5, 0.8, 0.95})
    for (const double error : {1e-2, 1e-3, 1e-5, 1e-7, 1e-9}) {
      const SignalInterpolator interpolator(band, error);
      const double worst = worst_error(interpolator);
      EXPECT_LE(worst, error) << band;
      EXPECT_GE(worst, 0.02 * error) << band << ": more taps than it needs, " << interpolator.taps();
    }
}

TEST(SignalInterpolator, HasTheTapsThatItsDocumentSays) {
  EXPECT_EQ(SignalInterpolator(0.5, 1e-3).taps(), 10u);
  EXPECT_EQ(SignalInterpolator(0.8, 1e-3).taps(), 24u);
  EXPECT_EQ(SignalInterpolator(0.8, 1e-5).taps(), 38u);
}

TEST(SignalInterpolator, KeepsSamplesAndTakesSilenceForWhatLiesOutside) {
  const SignalInterpolator interpolator;
  const std::vector<Complex> signal{1, {2, 3}, -4, {0, 5}};
  for (std::size_t k = 0; k < 4; ++k)
    EXPECT_LT(std::abs(interpolator.at(signal, double(k)) - signal[k]), 1e-10);
  EXPECT_LT(std::abs(interpolator.at(signal, 9)), 1e-9);
  EXPECT_EQ(interpolator.at(signal, -1e9), 0.0);
  EXPECT_EQ(interpolator.at(signal, NAN), 0.0);
  EXPECT_EQ(interpolator.at(signal, 1e300), 0.0);
}

TEST(SignalInterpolator, ShiftsARecordAsItsValues) {
  const SignalInterpolator interpolator(0.6, 1e-4);
  const std::vector<Complex> signal = tone(0.37, 40);
  for (const double shift : {0.0, 0.25, -3.7, 12.5, 100.0, -1e12}) {
    std::vector<Complex> out(50, {1, 1});
    interpolator.add_shifted(signal, shift, {0, 2}, out);
    for (std::size_t k = 0; k < out.size(); ++k)
      EXPECT_LT(std::abs(out[k] - Complex(1, 1) - Complex(0, 2) * interpolator.at(signal, double(k) + shift)),
                1e-12);
  }
}

TEST(SignalInterpolator, RefusesWhatNoTapsCanDo) {
  expect_refused([] { SignalInterpolator(1, 1e-3); },
                 "the band of the interpolator is 1 times half the sampling rate");
  expect_refused([] { SignalInterpolator(0.5, 1e-12); }, "at least 1e-9");
  expect_refused([] { SignalInterpolator(0.999, 1e-6); }, "the limit is 512: increase the sampling rate");
}

}  // namespace
}  // namespace tubefoot
