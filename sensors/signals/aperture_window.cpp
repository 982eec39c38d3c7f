// SPDX-License-Identifier: GPL-3.0-or-later
// Weights of aperture windows: uniform, Hann, Hamming, Taylor (1955) and Dolph-Chebyshev (1946). Continuous
// windows are cosine series; the Chebyshev weights are the discrete transform of their pattern.

#include "sensors/signals/aperture_window.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <stdexcept>

namespace tubefoot {
namespace {

using std::numbers::pi;
using Law = ApertureWindow::Law;

void check(const ApertureWindow& window) {
  if (window.law != Law::taylor && window.law != Law::chebyshev) return;
  if (!(window.side_lobe_db > 0 && window.side_lobe_db <= 300))
    throw std::invalid_argument(
        fmt::format("the side lobes of the window are {} dB below the main lobe, but this level must be "
                    "above 0 and at most 300 dB",
                    window.side_lobe_db));
  if (window.law == Law::taylor && !(window.nearly_equal >= 1 && window.nearly_equal <= 100))
    throw std::invalid_argument(fmt::format(
        "the Taylor window has {} nearly equal side lobes, but must have 1 to 100", window.nearly_equal));
}

/// Coefficients F_1.. of 1 + 2 sum F_m cos(2 pi m x).
std::vector<double> taylor_coefficients(const ApertureWindow& window) {
  const int count = window.nearly_equal;
  const double a = std::acosh(std::pow(10, window.side_lobe_db / 20)) / pi;
  const double dilation = count * count / (a * a + (count - 0.5) * (count - 0.5));
  std::vector<double> coefficients;
  for (int m = 1; m < count; ++m) {
    double product = m % 2 == 1 ? 0.5 : -0.5;
    for (int n = 1; n < count; ++n) {
      product *= 1 - m * m / (dilation * (a * a + (n - 0.5) * (n - 0.5)));
      if (n != m) product /= 1 - double(m * m) / (n * n);
    }
    coefficients.push_back(product);
  }
  return coefficients;
}

double cosine_series(double middle, const std::vector<double>& coefficients, double place) {
  double sum = middle;
  for (std::size_t m = 0; m < coefficients.size(); ++m)
    sum += 2 * coefficients[m] * std::cos(2 * pi * static_cast<double>(m + 1) * place);
  return sum;
}

std::vector<double> coefficients_of(const ApertureWindow& window) {
  switch (window.law) {
    case Law::uniform:
      return {};
    case Law::hann:
      return {0.25};
    case Law::hamming:
      return {0.23};
    case Law::taylor:
      return taylor_coefficients(window);
    case Law::chebyshev:
      break;
  }
  throw std::invalid_argument(
      "the Chebyshev window needs uniformly spaced elements: request all weights, or use the Taylor window");
}

double middle_of(Law law) { return law == Law::hann ? 0.5 : law == Law::hamming ? 0.54 : 1; }

/// T_n(x), for any x.
double chebyshev_polynomial(double n, double x) {
  if (std::abs(x) <= 1) return std::cos(n * std::acos(x));
  const double beyond = std::cosh(n * std::acosh(std::abs(x)));
  return x < 0 && std::fmod(n, 2) == 1 ? -beyond : beyond;
}

std::vector<double> chebyshev_weights(double side_lobe_db, std::size_t elements) {
  const auto count = static_cast<double>(elements);
  if (elements == 1) return {1};
  const double ratio = std::pow(10, side_lobe_db / 20), edge = std::cosh(std::acosh(ratio) / (count - 1));
  // Samples the pattern T_{n-1}(edge cos(psi / 2)) at as many angles as there are elements, and transforms
  // it.
  std::vector<double> weights;
  for (std::size_t k = 0; k < elements; ++k) {
    const double place = static_cast<double>(k) - 0.5 * (count - 1);
    double sum = ratio;
    for (std::size_t s = 1; s <= (elements - 1) / 2; ++s) {
      const auto angle = static_cast<double>(s) * pi / count;
      sum += 2 * chebyshev_polynomial(count - 1, edge * std::cos(angle)) * std::cos(2 * angle * place);
    }
    weights.push_back(sum / count);
  }
  return weights;
}

}  // namespace

double window_at(const ApertureWindow& window, double place) {
  check(window);
  const std::vector<double> coefficients = coefficients_of(window);
  return std::abs(place) <= 0.5 ? cosine_series(middle_of(window.law), coefficients, place) : 0;
}

std::vector<double> window_weights(const ApertureWindow& window, std::size_t elements) {
  check(window);
  if (elements == 0) return {};
  if (window.law == Law::chebyshev) return chebyshev_weights(window.side_lobe_db, elements);
  const std::vector<double> coefficients = coefficients_of(window);
  const auto count = static_cast<double>(elements);
  std::vector<double> weights;
  for (std::size_t k = 0; k < elements; ++k)
    weights.push_back(cosine_series(middle_of(window.law), coefficients,
                                    (static_cast<double>(k) - 0.5 * (count - 1)) / count));
  return weights;
}

}  // namespace tubefoot
