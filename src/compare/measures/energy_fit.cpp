// SPDX-License-Identifier: GPL-3.0-or-later
// Fits gain, range exponent and offset of a candidate: C = gain (r / r0)^range R + offset. Gain and
// exponent are a line through the logarithms of the energy ratios of patches, by Huber's weights.
#include "compare/measures/energy_fit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <sstream>

#include "compare/measures/median.hpp"
#include "compare/measures/noise_floor.hpp"
#include "files/usage_error.hpp"

namespace tubefoot {
namespace {

constexpr std::size_t most_bands = 12, most_groups = 16, least_bins = 4;
constexpr double decibels_per_neper = 4.342944819032518;

/// A patch: logarithms of its energy ratio and of its range, and its weight.
struct Cell {
  double log_range = 0, log_ratio = 0, weight = 0;
  std::size_t group = 0;
};

/// Returns per sample the inverse of the mean of the reference over its insonified bins. These weights
/// prevent near ranges from dominating far ranges.
std::vector<double> sample_weights(const EchoPair& pair, double threshold_j) {
  std::vector<double> sums(pair.shape.samples), counts(pair.shape.samples);
  for (std::size_t bin = 0; bin < pair.reference_j.size(); ++bin) {
    if (!(pair.reference_j[bin] > threshold_j)) continue;
    sums[bin % pair.shape.samples] += pair.reference_j[bin];
    ++counts[bin % pair.shape.samples];
  }
  for (std::size_t s = 0; s < sums.size(); ++s) sums[s] = counts[s] > 0 ? counts[s] / sums[s] : 0;
  return sums;
}

class Fitter {
 public:
  Fitter(const EchoPair& pair, const EnergyFit& fit) : pair_(pair), fit_(fit) {
    const double threshold_j = lit_threshold(pair.reference_j);
    weights_ = sample_weights(pair, threshold_j);
    for (std::size_t s = 0; s < weights_.size(); ++s)
      if (weights_[s] > 0) lit_samples_.push_back(s);
    bands_ = std::clamp<std::size_t>(lit_samples_.size() / least_bins, 1, most_bands);
    const auto lit = static_cast<std::size_t>(
        std::ranges::count_if(pair.reference_j, [&](double e) { return e > threshold_j; }));
    groups_ = std::clamp<std::size_t>(lit / (2 * least_bins * bands_), 1,
                                      std::min(most_groups, pair.shape.pings * pair.shape.beams));
  }

  double middle_range_m() const {
    return lit_samples_.empty() ? 1 : pair_.slant_range_m[lit_samples_[lit_samples_.size() / 2]];
  }

  /// Returns the patches of the fitted candidate and the reference.
  std::vector<Cell> cells() const {
    const std::vector<double> fitted = fit_.fitted(pair_);
    const std::size_t columns = pair_.shape.pings * pair_.shape.beams, samples = pair_.shape.samples;
    std::map<std::pair<std::size_t, std::size_t>, std::array<double, 4>> sums;
    for (std::size_t i = 0; i < lit_samples_.size(); ++i) {
      const std::size_t s = lit_samples_[i], band = i * bands_ / lit_samples_.size();
      for (std::size_t column = 0; column < columns; ++column) {
        auto& [r, c, log_range, count] = sums[{band, column * groups_ / columns}];
        const std::size_t bin = column * samples + s;
        r += weights_[s] * pair_.reference_j[bin];
        c += weights_[s] * fitted[bin];
        if (!(pair_.reference_j[bin] > 0)) continue;
        log_range += std::log(pair_.slant_range_m[s] / fit_.middle_range_m);
        ++count;
      }
    }
    std::vector<Cell> cells;
    for (const auto& [key, sum] : sums) {
      const auto& [r, c, log_range, count] = sum;
      if (count >= least_bins && r > 0 && c > 0)
        cells.push_back({log_range / count, std::log(c / r), count, key.second});
    }
    return cells;
  }

 private:
  const EchoPair& pair_;
  const EnergyFit& fit_;
  std::vector<double> weights_;
  std::vector<std::size_t> lit_samples_;
  std::size_t bands_ = 1, groups_ = 1;
};

/// Weighted line a + b x through the patches, by Huber's weights. b is 0 if no exponent is fitted. The
/// spread between groups gives the standard errors.
struct Line {
  Estimate a, b;
};

Line line_through(const std::vector<Cell>& cells, bool gain, bool model) {
  Line line;
  if (gain) {
    std::vector<double> ratios;
    for (const Cell& cell : cells) ratios.push_back(cell.log_ratio);
    line.a.value = median_of(ratios);
  }
  for (int round = 0; round < 30; ++round) {
    const auto residual = [&](const Cell& c) {
      return c.log_ratio - line.a.value - line.b.value * c.log_range;
    };
    std::vector<double> sizes;
    for (const Cell& cell : cells) sizes.push_back(std::abs(residual(cell)));
    const double limit = 2 * median_of(sizes) + 1e-12;
    double w = 0, x = 0, xx = 0, e = 0, xe = 0;
    std::map<std::size_t, std::array<double, 2>> scores;
    for (const Cell& cell : cells) {
      const double off = residual(cell), weight = cell.weight * std::min(1.0, limit / std::abs(off));
      w += weight;
      x += weight * cell.log_range;
      xx += weight * cell.log_range * cell.log_range;
      e += weight * off;
      xe += weight * off * cell.log_range;
      scores[cell.group][0] += weight * off;
      scores[cell.group][1] += weight * off * cell.log_range;
    }
    if (!gain) x = 0, w = 1, e = 0;
    if (!model) x = 0, xx = 1, xe = 0;
    const double determinant = w * xx - x * x;
    if (!(determinant > 1e-9 * w * xx)) break;
    const double step_a = (xx * e - x * xe) / determinant, step_b = (w * xe - x * e) / determinant;
    line.a.value += step_a;
    line.b.value += step_b;
    double var_a = 0, var_b = 0;
    for (const auto& [group, s] : scores) {
      const double sa = gain ? s[0] : 0, sb = model ? s[1] : 0;
      const double da = (xx * sa - x * sb) / determinant, db = (w * sb - x * sa) / determinant;
      var_a += da * da;
      var_b += db * db;
    }
    const auto n = static_cast<double>(scores.size());
    // The residuals of a single group sum to 0, which gives no standard error.
    const double finite = n > 1 ? n / (n - 1) : 1;
    line.a.error = std::sqrt(finite * var_a);
    line.b.error = std::sqrt(finite * var_b);
    if (std::abs(step_a) + std::abs(step_b) < 1e-12) break;
  }
  return line;
}

}  // namespace

FitTerms fit_terms(const std::string& words) {
  FitTerms terms;
  std::istringstream list(words);
  for (std::string word; std::getline(list, word, ',');) {
    bool* term = word == "gain"     ? &terms.gain
                 : word == "range"  ? &terms.range
                 : word == "offset" ? &terms.offset
                                    : nullptr;
    if (!term)
      throw UsageError(fmt::format("--fit: unknown term '{}': expected gain, range or offset", word));
    if (*term) throw UsageError(fmt::format("--fit names {} twice", word));
    *term = true;
  }
  if (!terms.any())
    throw UsageError("--fit: expected one or more of gain, range and offset, separated by commas");
  return terms;
}

std::vector<double> EnergyFit::fitted(const EchoPair& pair) const {
  std::vector<double> factors;
  for (const double range_m : pair.slant_range_m)
    factors.push_back(std::pow(10, -gain_db.value / 10) *
                      (exponent.value == 0 ? 1 : std::pow(range_m / middle_range_m, -exponent.value)));
  std::vector<double> result(pair.candidate_j.begin(), pair.candidate_j.end());
  for (std::size_t bin = 0; bin < result.size(); ++bin)
    result[bin] = (terms.offset ? std::max(result[bin] - offset_j.value, 0.0) : result[bin]) *
                  factors[bin % pair.shape.samples];
  return result;
}

std::optional<EnergyFit> fit_energies(const EchoPair& pair, FitTerms terms) {
  EnergyFit fit;
  fit.terms = terms;
  if (terms.offset) {
    const NoiseFloor floor =
        noise_floor(pair.shape, pair.candidate_j, deep_shadow(pair.shape, pair.reference_j, 2, 3));
    fit.offset_j = {floor.mean_j, floor.mean_error_j};
  }
  const Fitter fitter(pair, fit);
  fit.middle_range_m = fitter.middle_range_m();
  if (!(fit.middle_range_m > 0)) return std::nullopt;
  if (!terms.gain && !terms.range) return fit;
  // The range factor at the centre of a patch differs from that of its bins. The remainder is fitted again.
  for (int round = 0; round < 8; ++round) {
    const std::vector<Cell> cells = fitter.cells();
    fit.cells = cells.size();
    if (cells.empty()) return std::nullopt;
    if (terms.range && cells.front().log_range == cells.back().log_range) return std::nullopt;
    const Line line = line_through(cells, terms.gain, terms.range);
    fit.gain_db.value += decibels_per_neper * line.a.value;
    fit.gain_db.error = decibels_per_neper * line.a.error;
    fit.exponent.value += line.b.value;
    fit.exponent.error = line.b.error;
    if (std::abs(line.a.value) + std::abs(line.b.value) < 1e-10) break;
  }
  return fit;
}

}  // namespace tubefoot
