// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <boost/math/distributions/binomial.hpp>
#include <cmath>
#include <vector>

// Tests of samples against laws. A right program fails each with a known, tiny probability.
namespace tubefoot::statistics {

inline constexpr double false_alarm = 1e-9;

inline double mean(const std::vector<double>& values) {
  double sum = 0;
  for (const double value : values) sum += value;
  return sum / static_cast<double>(values.size());
}

inline double variance(const std::vector<double>& values) {
  const double centre = mean(values);
  double sum = 0;
  for (const double value : values) sum += (value - centre) * (value - centre);
  return sum / static_cast<double>(values.size());
}

/// <I^2> / <I>^2
inline double scintillation(const std::vector<double>& values) {
  const double centre = mean(values);
  return variance(values) / (centre * centre) + 1;
}

inline double correlation(const std::vector<double>& a, const std::vector<double>& b) {
  const double mean_a = mean(a), mean_b = mean(b);
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += (a[i] - mean_a) * (b[i] - mean_b);
  return sum / static_cast<double>(a.size()) / std::sqrt(variance(a) * variance(b));
}

/// Kolmogorov's distance between a sample and a distribution function.
template <typename Distribution>
double kolmogorov_distance(std::vector<double> values, Distribution distribution) {
  std::sort(values.begin(), values.end());
  const auto n = static_cast<double>(values.size());
  double distance = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double p = distribution(values[i]), below = static_cast<double>(i) / n;
    distance = std::max({distance, p - below, below + 1 / n - p});
  }
  return distance;
}

/// The distance that a sample of n exceeds with a probability of at most `false_alarm`, for every n:
/// inequality of Dvoretzky, Kiefer and Wolfowitz with Massart's constant.
inline double kolmogorov_limit(std::size_t n) {
  return std::sqrt(std::log(2 / false_alarm) / (2 * static_cast<double>(n)));
}

/// Exact two-sided probability of a count as far off as this one: binomial tails.
inline double tail_probability(std::size_t hits, std::size_t n, double p) {
  const boost::math::binomial law(static_cast<double>(n), p);
  const auto count = static_cast<double>(hits);
  const double below = cdf(law, count);
  const double above = hits == 0 ? 1 : cdf(complement(law, count - 1));
  return std::min(1.0, 2 * std::min(below, above));
}

}  // namespace tubefoot::statistics
