// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/ping_spread.hpp"

#include <algorithm>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <limits>
#include <vector>

namespace tubefoot {
namespace {

/// Computes the jackknife estimate of the standard error.
double standard_error(std::span<const PingError> pings, ErrorMeasure measure) {
  const auto n = static_cast<double>(pings.size());
  std::vector<double> without;
  double mean = 0;
  for (std::size_t left_out = 0; left_out < pings.size(); ++left_out) {
    std::vector<PingError> rest(pings.begin(), pings.end());
    rest.erase(rest.begin() + static_cast<std::ptrdiff_t>(left_out));
    without.push_back(error_of(rest, measure));
    mean += without.back() / n;
  }
  double squares = 0;
  for (const double e : without) squares += (e - mean) * (e - mean);
  return std::sqrt((n - 1) / n * squares);
}

}  // namespace

double error_limit(std::span<const PingError> pings, std::size_t population, ErrorMeasure measure) {
  const double error = error_of(pings, measure);
  if (!(error > 0) || !std::isfinite(error)) return error;
  const double at_least = least_margin * error;
  if (population <= pings.size()) return at_least;
  if (pings.size() < 2) return std::numeric_limits<double>::infinity();
  const auto n = static_cast<double>(pings.size());
  const double all = static_cast<double>(population);
  const double unseen = all / (all - n);  // accounts for the variance of the mean of the unseen pings
  const double quantile = boost::math::quantile(boost::math::students_t(n - 1), error_limit_confidence);
  const double limit = error + quantile * std::sqrt(unseen) * standard_error(pings, measure);
  return std::isfinite(limit) ? std::max(at_least, limit) : std::numeric_limits<double>::infinity();
}

}  // namespace tubefoot
