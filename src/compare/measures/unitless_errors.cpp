// SPDX-License-Identifier: GPL-3.0-or-later
#include "compare/measures/unitless_errors.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace tubefoot {
namespace {

/// Returns the ranks of values minus their mean. Equal values share the mean of their ranks.
std::vector<double> centred_ranks(const std::vector<double>& values) {
  std::vector<std::size_t> order(values.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return values[a] < values[b]; });
  std::vector<double> ranks(values.size());
  const double middle = (static_cast<double>(values.size()) - 1) / 2;
  for (std::size_t first = 0, last = 0; first < order.size(); first = last) {
    while (last < order.size() && values[order[last]] == values[order[first]]) ++last;
    const double rank = static_cast<double>(first + last - 1) / 2 - middle;
    for (std::size_t k = first; k < last; ++k) ranks[order[k]] = rank;
  }
  return ranks;
}

double rank_correlation(const EchoPair& pair) {
  std::vector<double> r, c;
  for (std::size_t k = 0; k < pair.reference_j.size(); ++k) {
    if (!(pair.reference_j[k] > 0) && !(pair.candidate_j[k] > 0)) continue;
    r.push_back(pair.reference_j[k]);
    c.push_back(pair.candidate_j[k]);
  }
  if (r.size() < 2) return 0;
  const std::vector<double> a = centred_ranks(r), b = centred_ranks(c);
  const auto dot = [](const std::vector<double>& x, const std::vector<double>& y) {
    return std::inner_product(x.begin(), x.end(), y.begin(), 0.0);
  };
  const double scale = std::sqrt(dot(a, a) * dot(b, b));
  return scale > 0 ? dot(a, b) / scale : 0;
}

}  // namespace

UnitlessErrors unitless_errors(const EchoPair& pair) {
  UnitlessErrors errors;
  const EchoShape& shape = pair.shape;
  double sum = 0;
  for (std::size_t ping = 0; ping < shape.pings; ++ping)
    for (std::size_t sample = 0; sample < shape.samples; ++sample) {
      const auto bin = [&](std::size_t beam) { return (ping * shape.beams + beam) * shape.samples + sample; };
      double r = 0, c = 0, off = 0;
      for (std::size_t beam = 0; beam < shape.beams; ++beam) {
        r += pair.reference_j[bin(beam)];
        c += pair.candidate_j[bin(beam)];
      }
      errors.rows_of_one_side += (r > 0) != (c > 0);
      if (!(r > 0) || !(c > 0)) continue;
      for (std::size_t beam = 0; beam < shape.beams; ++beam)
        off += std::abs(pair.candidate_j[bin(beam)] / c - pair.reference_j[bin(beam)] / r);
      sum += off;
      ++errors.rows;
    }
  if (errors.rows > 0) errors.row_l1 = sum / static_cast<double>(errors.rows);
  errors.rank_correlation = rank_correlation(pair);
  return errors;
}

}  // namespace tubefoot
