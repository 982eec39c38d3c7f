// SPDX-License-Identifier: GPL-3.0-or-later
// Levels of a candidate relative to its prediction. Patches of the picture give energy ratios; a piecewise
// linear curve through their logarithms is the level over range or elevation. Standard errors come from the
// spread between groups of columns.
#include "compare/diagnosis/level_differences.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

#include "compare/diagnosis/normal_equations.hpp"
#include "compare/measures/median.hpp"

namespace tubefoot {
namespace {

constexpr std::size_t bands = 20, groups = 8, knots = 7, least_bins = 6;
constexpr double decibels_per_neper = 4.342944819032518;

/// A patch: a band of rows of a group of columns.
struct Patch {
  double log_ratio = 0, weight = 0, coordinate = 0, log_range = 0;
  std::size_t group = 0;
};

bool is_lit(const Residual& r, std::size_t bin) {
  const std::size_t s = bin % r.fan.shape().samples;
  return r.row_counts[s] && r.levels_j[s] > 2 * r.noise_j && r.predicted_j[bin] > 0.2 * r.levels_j[s];
}

/// Energy ratios of the patches, in which all rows have the same weight. A patch is split at the median of
/// its coordinate. This separates surfaces at the same range and different elevations.
std::vector<Patch> patches_of(const Residual& r, const std::function<double(std::size_t)>& coordinate) {
  const EchoShape& shape = r.fan.shape();
  const std::size_t columns = shape.pings * shape.beams;
  std::vector<std::vector<std::size_t>> bins(bands * groups);
  for (std::size_t bin = 0; bin < r.predicted_j.size(); ++bin)
    if (is_lit(r, bin) && std::isfinite(coordinate(bin)))
      bins[bin % shape.samples * bands / shape.samples * groups + bin / shape.samples * groups / columns]
          .push_back(bin);
  std::vector<Patch> patches;
  for (std::size_t cell = 0; cell < bins.size(); ++cell) {
    std::ranges::stable_sort(bins[cell], {}, coordinate);
    const std::size_t parts = bins[cell].size() >= 4 * least_bins ? 2 : 1;
    for (std::size_t part = 0; part < parts; ++part) {
      const std::size_t first = part * bins[cell].size() / parts,
                        last = (part + 1) * bins[cell].size() / parts;
      double p = 0, c = 0;
      Patch patch{0, static_cast<double>(last - first), 0, 0, cell % groups};
      for (std::size_t k = first; k < last; ++k) {
        const std::size_t bin = bins[cell][k], s = bin % shape.samples;
        p += r.predicted_j[bin] / r.levels_j[s];
        c += r.candidate_j[bin] / r.levels_j[s];
        patch.coordinate += coordinate(bin) / patch.weight;
        patch.log_range += std::log(r.fan.range_m(s)) / patch.weight;
      }
      if (last - first < least_bins || !(p > 0) || !(c > 1e-3 * p)) continue;
      patch.log_ratio = std::log(c / p);
      patches.push_back(patch);
    }
  }
  return patches;
}

/// The two knots around a coordinate, and the share of the second one.
struct Position {
  std::size_t knot = 0;
  double share = 0;
};

Position position_of(const std::vector<double>& knots_at, double coordinate) {
  const auto above = std::ranges::upper_bound(knots_at, coordinate) - knots_at.begin();
  const auto k = static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(above - 1, 0, std::ssize(knots_at) - 2));
  return {k, std::clamp((coordinate - knots_at[k]) / (knots_at[k + 1] - knots_at[k]), 0.0, 1.0)};
}

/// Subtracts the power of range that fits best, so that a curve contains only what a power cannot.
void subtract_power(std::vector<Patch>& patches) {
  double w = 0, x = 0, y = 0, xx = 0, xy = 0;
  for (const Patch& p : patches) w += p.weight, x += p.weight * p.log_range, y += p.weight * p.log_ratio;
  for (const Patch& p : patches) {
    xx += p.weight * std::pow(p.log_range - x / w, 2);
    xy += p.weight * (p.log_range - x / w) * (p.log_ratio - y / w);
  }
  for (Patch& p : patches) p.log_ratio -= xx > 0 ? xy / xx * p.log_range : 0;
}

/// Piecewise linear curve over the coordinate, by Huber's weights. Single patches with a missing shadow or a
/// displaced edge have less influence.
LevelProfile profile_of(const std::vector<Patch>& patches) {
  constexpr std::size_t n = knots;
  LevelProfile profile;
  if (patches.size() < 2 * n) return profile;
  std::vector<double> places;
  for (const Patch& patch : patches) places.push_back(patch.coordinate);
  std::ranges::sort(places);
  for (std::size_t k = 0; k < n; ++k) profile.at.push_back(places[k * (places.size() - 1) / (n - 1)]);
  if (std::ranges::adjacent_find(profile.at, std::ranges::greater_equal{}) != profile.at.end())
    return {};  // the coordinate has too few different values
  std::vector<Position> positions;
  for (const Patch& patch : patches) positions.push_back(position_of(profile.at, patch.coordinate));
  std::vector<double> level(n), inverse, weights(patches.size()), off(patches.size());
  const auto residuals = [&] {
    for (std::size_t k = 0; k < patches.size(); ++k) {
      const auto& [knot, share] = positions[k];
      off[k] = patches[k].log_ratio - (1 - share) * level[knot] - share * level[knot + 1];
    }
  };
  for (std::size_t k = 0; k < patches.size(); ++k) weights[k] = patches[k].weight;
  for (int round = 0; round < 12; ++round) {
    residuals();
    if (round > 0) {
      std::vector<double> sizes;
      for (const double o : off) sizes.push_back(std::abs(o));
      const double limit = 2 * median_of(sizes) + 1e-9;
      for (std::size_t k = 0; k < patches.size(); ++k)
        weights[k] = patches[k].weight * std::min(1.0, limit / std::max(std::abs(off[k]), 1e-300));
    }
    std::vector<double> normal(n * n), right(n);
    for (std::size_t k = 0; k < patches.size(); ++k) {
      const auto& [knot, share] = positions[k];
      const std::array<double, 2> slope{1 - share, share};
      for (std::size_t i = 0; i < 2; ++i) {
        right[knot + i] += weights[k] * slope[i] * off[k];
        for (std::size_t j = 0; j < 2; ++j)
          normal[(knot + i) * n + knot + j] += weights[k] * slope[i] * slope[j];
      }
    }
    for (std::size_t i = 0; i < n; ++i) normal[i * n + i] += 1e-9;
    inverse = inverted(normal, n);
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t j = 0; j < n; ++j) level[i] += inverse[i * n + j] * right[j];
  }
  residuals();
  // The groups of columns are the clusters of the standard error.
  std::array<std::array<double, n>, groups> scores{};
  double squares = 0, sum = 0;
  for (std::size_t k = 0; k < patches.size(); ++k) {
    const auto& [knot, share] = positions[k];
    scores[patches[k].group][knot] += weights[k] * (1 - share) * off[k];
    scores[patches[k].group][knot + 1] += weights[k] * share * off[k];
    squares += weights[k] * off[k] * off[k];
    sum += weights[k];
  }
  profile.misfit = squares / sum;
  const auto [low, high] = std::ranges::minmax_element(level);
  const auto bottom = static_cast<std::size_t>(low - level.begin()),
             top = static_cast<std::size_t>(high - level.begin());
  double variance = 0;
  for (const auto& score : scores) {
    double moved = 0;
    for (std::size_t j = 0; j < n; ++j) moved += (inverse[top * n + j] - inverse[bottom * n + j]) * score[j];
    variance += moved * moved * groups / (groups - 1);
  }
  profile.largest_db = decibels_per_neper * *high;
  for (const double l : level) profile.db.push_back(decibels_per_neper * (l - *high));
  profile.spread_db = {decibels_per_neper * (*high - *low), decibels_per_neper * std::sqrt(variance)};
  return profile;
}

}  // namespace

PingGains ping_gains(const EchoShape& shape, std::span<const double> predicted_j,
                     std::span<const double> candidate_j) {
  PingGains gains{std::vector<double>(shape.pings, 1.0), {}};
  if (shape.pings < 2) return gains;
  const std::vector<double> levels = row_levels(shape, {predicted_j.begin(), predicted_j.end()});
  std::vector<double> logarithms, errors;
  for (std::size_t ping = 0; ping < shape.pings; ++ping) {
    std::array<std::array<double, 2>, bands * groups> sums{};
    for (std::size_t bin = ping * shape.beams * shape.samples; bin < (ping + 1) * shape.beams * shape.samples;
         ++bin) {
      const std::size_t s = bin % shape.samples, beam = bin / shape.samples % shape.beams;
      if (!(predicted_j[bin] > 0.2 * levels[s])) continue;
      auto& [p, c] = sums[s * bands / shape.samples * groups + beam * groups / shape.beams];
      p += predicted_j[bin] / levels[s];
      c += candidate_j[bin] / levels[s];
    }
    std::vector<double> ratios, deviations;
    for (const auto& [p, c] : sums)
      if (p > static_cast<double>(least_bins) / 2 && c > 0) ratios.push_back(std::log(c / p));
    if (ratios.size() < groups) return gains;
    logarithms.push_back(median_of(ratios));
    for (const double ratio : ratios) deviations.push_back(std::abs(ratio - logarithms.back()));
    // 1.86 is the ratio of the error of a median to the median deviation of normal values.
    errors.push_back(1.86 * median_of(deviations) / std::sqrt(static_cast<double>(ratios.size())));
  }
  const double usual = median_of(logarithms);
  for (std::size_t ping = 0; ping < shape.pings; ++ping)
    gains.factor[ping] = std::exp(logarithms[ping] - usual);
  const auto [low, high] = std::ranges::minmax_element(logarithms);
  gains.spread_db = {
      decibels_per_neper * (*high - *low),
      decibels_per_neper * std::hypot(errors[static_cast<std::size_t>(low - logarithms.begin())],
                                      errors[static_cast<std::size_t>(high - logarithms.begin())])};
  return gains;
}

LevelProfile level_over_elevation(const Residual& residual, std::span<const float> elevation_deg) {
  return profile_of(patches_of(residual, [&](std::size_t bin) -> double { return elevation_deg[bin]; }));
}

LevelProfile level_over_range(const Residual& residual) {
  const std::size_t samples = residual.fan.shape().samples;
  std::vector<Patch> patches =
      patches_of(residual, [&](std::size_t bin) { return residual.fan.range_m(bin % samples); });
  subtract_power(patches);
  return profile_of(patches);
}

std::vector<MaterialLevel> material_levels(const Residual& residual, std::span<const std::uint16_t> material,
                                           std::size_t materials) {
  std::vector<std::vector<std::size_t>> bins(materials);
  for (std::size_t bin = 0; bin < residual.predicted_j.size(); ++bin)
    if (material[bin] < materials && is_lit(residual, bin)) bins[material[bin]].push_back(bin);
  std::vector<MaterialLevel> levels(materials);
  for (std::size_t m = 0; m < materials; ++m) {
    MaterialLevel& level = levels[m];
    level.bins = bins[m].size();
    if (level.bins < 4 * least_bins) {
      level.bins = 0;
      continue;
    }
    // The bins of each part are adjacent, so that errors of neighbours do not appear independent.
    std::array<double, groups> p{}, c{};
    for (std::size_t k = 0; k < bins[m].size(); ++k) {
      const std::size_t bin = bins[m][k], s = bin % residual.fan.shape().samples,
                        part = k * groups / bins[m].size();
      const double scale = residual.levels_j[s] + residual.noise_j;
      p[part] += residual.predicted_j[bin] / scale;
      c[part] += residual.candidate_j[bin] / scale;
    }
    double of_p = 0, of_c = 0, squares = 0;
    for (std::size_t part = 0; part < groups; ++part) of_p += p[part], of_c += c[part];
    if (!(of_c > 0)) {
      level.db = {-largest_error_db, 0};
      continue;
    }
    for (std::size_t part = 0; part < groups; ++part) squares += std::pow(c[part] - of_c / of_p * p[part], 2);
    level.db = {decibels_per_neper * std::log(of_c / of_p),
                decibels_per_neper * std::sqrt(squares * groups / (groups - 1)) / of_c};
  }
  return levels;
}

Estimate spread_db(const std::vector<MaterialLevel>& levels) {
  const MaterialLevel *low = nullptr, *high = nullptr;
  for (const MaterialLevel& level : levels) {
    if (level.bins == 0) continue;
    if (!low || level.db.value < low->db.value) low = &level;
    if (!high || level.db.value > high->db.value) high = &level;
  }
  if (low == high) return {};
  return {high->db.value - low->db.value, std::hypot(high->db.error, low->db.error)};
}

bool differ(const std::vector<MaterialLevel>& levels) {
  constexpr double least_db = 1, error_bars = 5;
  const Estimate spread = spread_db(levels);
  return spread.value > std::max(least_db, error_bars * spread.error);
}

}  // namespace tubefoot
