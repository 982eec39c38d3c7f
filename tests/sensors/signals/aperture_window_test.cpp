// SPDX-License-Identifier: GPL-3.0-or-later
#include "sensors/signals/aperture_window.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>

#include "fixtures/lobes.hpp"
#include "fixtures/refusal.hpp"
#include "geometry/numbers/scalars.hpp"

namespace tubefoot {
namespace {

using Law = ApertureWindow::Law;

/// Figures for elements half a wavelength apart, by u = elements x turns of phase from one to the next.
LobeFigures figures_of(const ApertureWindow& window, std::size_t elements) {
  const std::vector<double> weights = window_weights(window, elements);
  std::vector<double> pattern;
  constexpr double step = 1e-3;
  const double most = 0.5 * static_cast<double>(elements);
  for (double u = -most; u <= most; u += step) {
    std::complex<double> sum = 0;
    for (std::size_t k = 0; k < elements; ++k)
      sum += std::polar(weights[k], 2 * pi * u / double(elements) * double(k));
    pattern.push_back(std::abs(sum));
  }
  return lobe_figures(pattern, -most, step);
}

TEST(ApertureWindow, HasTheLobesOfTheBooks) {
  struct {
    ApertureWindow window;
    double width, side_lobe_db, tolerance_db;
  } const cases[] = {{{Law::uniform}, 0.8859, -13.26, 0.01},
                     {{Law::hann}, 1.4406, -31.47, 0.02},
                     {{Law::hamming}, 1.3030, -42.67, 0.3},
                     {{Law::taylor, 30, 4}, 1.1189, -30, 0.5},
                     {{Law::taylor, 35, 5}, 1.18, -35, 0.5}};
  for (const auto& [window, width, side_lobe_db, tolerance_db] : cases) {
    const LobeFigures figures = figures_of(window, 128);
    EXPECT_NEAR(figures.half_power_width, width, 0.01 * width) << int(window.law);
    EXPECT_NEAR(figures.highest_side_lobe_db, side_lobe_db, tolerance_db) << int(window.law);
  }
}

TEST(ApertureWindow, OfChebyshevIsHisPolynomial) {
  for (const std::size_t elements : {2u, 7u, 16u, 33u})
    for (const double down_db : {20.0, 40.0, 80.0}) {
      const std::vector<double> weights = window_weights({Law::chebyshev, down_db}, elements);
      const double order = double(elements) - 1, ratio = std::pow(10, down_db / 20),
                   edge = std::cosh(std::acosh(ratio) / order);
      for (double psi = -pi; psi <= pi; psi += 0.0137) {
        std::complex<double> sum = 0;
        for (std::size_t k = 0; k < elements; ++k)
          sum += std::polar(weights[k], psi * (double(k) - 0.5 * order));
        const double x = edge * std::cos(psi / 2);
        const double expected =
            std::abs(x) <= 1 ? std::cos(order * std::acos(x)) : std::cosh(order * std::acosh(x));
        EXPECT_NEAR(sum.real(), expected, 1e-11 * ratio);
        EXPECT_NEAR(sum.imag(), 0, 1e-11 * ratio);
      }
    }
}

TEST(ApertureWindow, IsEvenAndContinuousWhereItHasAForm) {
  for (const ApertureWindow& window : {ApertureWindow{Law::hann}, ApertureWindow{Law::taylor, 30, 6}}) {
    const std::vector<double> weights = window_weights(window, 10);
    for (std::size_t k = 0; k < 10; ++k) {
      EXPECT_NEAR(weights[k], weights[9 - k], 1e-15);
      EXPECT_NEAR(weights[k], window_at(window, (double(k) - 4.5) / 10), 1e-15);
    }
    EXPECT_EQ(window_at(window, 0.51), 0);
  }
  EXPECT_EQ(window_weights({}, 3), std::vector<double>({1, 1, 1}));
}

TEST(ApertureWindow, RefusesNumbersThatMakeNone) {
  expect_refused([] { window_at({Law::chebyshev, 30}, 0); }, "uniformly spaced elements");
  expect_refused([] { window_weights({Law::taylor, -3}, 4); }, "side lobes of the window are -3 dB");
  expect_refused([] { window_weights({Law::taylor, 30, 0}, 4); }, "0 nearly equal side lobes");
}

}  // namespace
}  // namespace tubefoot
