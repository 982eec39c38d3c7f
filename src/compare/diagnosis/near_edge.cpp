// SPDX-License-Identifier: GPL-3.0-or-later
// Displacements of the near edge of the fan. The lower side of a camera's view is a plane, not a cone. The
// near edge of a fan of several views therefore consists of arcs. An arc is fitted as a parabola over each
// view. Displacements of another form are not reported.
#include "compare/diagnosis/near_edge.hpp"

#include <algorithm>
#include <cmath>

#include "compare/measures/median.hpp"

namespace tubefoot {
namespace {

constexpr std::size_t reach = 5, least_beams = 16, most_views = 12, window = 5;
constexpr double farthest = 4;  // samples; beams without an edge within this distance are left out

struct Beam {
  double place = 0;  ///< in the fan, 0 to 1
  double offset = 0;
};

/// Median of the insonified bins of each row of the prediction. Objects do not affect it.
std::vector<double> medians_of_rows(const Residual& r) {
  const EchoShape& shape = r.fan.shape();
  std::vector<std::vector<double>> lit(shape.samples);
  for (std::size_t bin = 0; bin < r.predicted_j.size(); ++bin)
    if (r.predicted_j[bin] > 0.1 * r.levels_j[bin % shape.samples])
      lit[bin % shape.samples].push_back(r.predicted_j[bin]);
  std::vector<double> medians;
  for (auto& row : lit) medians.push_back(row.empty() ? 0 : median_of(std::move(row)));
  return medians;
}

/// Displacement of the near edge in a beam, in samples. `difference` grows by |candidate - prediction|.
std::optional<double> offset_of(const Residual& r, const std::vector<double>& medians, std::size_t from,
                                double& difference) {
  const std::size_t samples = r.fan.shape().samples;
  std::size_t s = 0;
  while (s < samples && !(r.predicted_j[from + s] > 0.3 * r.levels_j[s])) ++s;
  if (s < reach || s + 2 * reach >= samples || !r.row_counts[s + 1]) return std::nullopt;
  // A vertical pattern that falls to 0 leaves no edge to measure, and noise hides a faint edge.
  if (medians[s + 1] < 3 * r.noise_j) return std::nullopt;
  if (!r.level_curve.empty() && r.level_curve[s + reach] < 0.5 * std::ranges::max(r.level_curve))
    return std::nullopt;
  if (medians[s + reach] < 0.5 * medians[std::min(s + 4 * reach, samples - 1)]) return std::nullopt;
  double lack = 0, should = 0, has = 0;
  for (std::size_t k = s - reach; k <= s + reach; ++k) {
    lack += r.predicted_j[from + k] - r.candidate_j[from + k];
    difference += std::abs(r.predicted_j[from + k] - r.candidate_j[from + k]);
  }
  // If all echoes behind the edge differ, the edge is that of a shadow and not displaced.
  for (std::size_t k = s + reach + 1; k <= s + 2 * reach; ++k) {
    should += r.predicted_j[from + k];
    has += r.candidate_j[from + k];
  }
  if (has < 0.6 * should || has > 1.6 * should) return std::nullopt;
  // A displaced edge lacks the level right behind it; a gradual edge lacks that at the end of the interval.
  double level = 0;
  for (std::size_t k = s + 2; k <= s + reach; ++k)
    level = std::max(
        level, (r.predicted_j[from + k - 1] + r.predicted_j[from + k] + r.predicted_j[from + k + 1]) / 3);
  if (!(level > 0.3 * r.levels_j[s])) return std::nullopt;
  const double offset = lack / level;
  return std::abs(offset) < farthest ? std::optional(offset) : std::nullopt;
}

/// Depth of parabolas over equal views: least squares, and a standard error for residuals that are correlated
/// over `window` beams (Newey and West 1987).
struct Arcs {
  Estimate depth;
  double explained = 0;  ///< mean square of the fitted displacements
};

Arcs arcs(const std::vector<Beam>& beams, std::size_t views) {
  std::vector<double> shape;
  double mean = 0, mean_offset = 0;
  for (const Beam& beam : beams) {
    const double of_view = beam.place * static_cast<double>(views),
                 off = 2 * (of_view - std::floor(of_view)) - 1;
    shape.push_back(1 - off * off);
    mean += shape.back() / static_cast<double>(beams.size());
    mean_offset += beam.offset / static_cast<double>(beams.size());
  }
  double squares = 0, products = 0;
  for (std::size_t k = 0; k < beams.size(); ++k) {
    shape[k] -= mean;
    squares += shape[k] * shape[k];
    products += shape[k] * (beams[k].offset - mean_offset);
  }
  const double depth = products / squares;
  std::vector<double> scores;
  for (std::size_t k = 0; k < beams.size(); ++k)
    scores.push_back(shape[k] * (beams[k].offset - mean_offset - depth * shape[k]));
  double variance = 0;
  for (std::size_t k = 0; k < scores.size(); ++k)
    for (std::size_t lag = 0; lag <= window && lag <= k; ++lag)
      variance += (lag == 0 ? 1 : 2 * (1 - double(lag) / (window + 1))) * scores[k] * scores[k - lag];
  return {{depth, std::sqrt(std::max(variance, 0.0)) / squares},
          depth * depth * squares / static_cast<double>(beams.size())};
}

}  // namespace

Scallops scallops(const Residual& r) {
  const EchoShape& shape = r.fan.shape();
  Scallops result;
  const std::vector<double> medians = medians_of_rows(r);
  std::vector<std::vector<double>> of_beam(shape.beams);
  std::size_t edges = 0, pings = 0;
  for (std::size_t ping = 0; ping < shape.pings; ++ping) {
    std::vector<std::pair<std::size_t, double>> offsets;
    for (std::size_t beam = 0; beam < shape.beams; ++beam)
      if (const auto offset =
              offset_of(r, medians, (ping * shape.beams + beam) * shape.samples, result.difference))
        offsets.emplace_back(beam, *offset);
    if (offsets.size() < least_beams) continue;
    ++pings;
    edges += offsets.size();
    std::vector<double> all;
    for (const auto& [beam, offset] : offsets) all.push_back(offset);
    const double middle = median_of(all);
    for (const auto& [beam, offset] : offsets) of_beam[beam].push_back(offset - middle);
  }
  std::vector<Beam> beams;
  for (std::size_t beam = 0; beam < shape.beams; ++beam)
    if (!of_beam[beam].empty())
      beams.push_back(
          {(static_cast<double>(beam) + 0.5) / static_cast<double>(shape.beams), median_of(of_beam[beam])});
  if (beams.size() < std::max(least_beams, shape.beams / 3)) return result;
  double products = 0, squares = 0, mean = 0;
  for (const Beam& beam : beams) mean += beam.offset / static_cast<double>(beams.size());
  for (std::size_t k = 0; k < beams.size(); ++k) {
    squares += std::pow(beams[k].offset - mean, 2);
    if (k > 0) products += (beams[k].offset - mean) * (beams[k - 1].offset - mean);
  }
  if (!(squares > 0)) return result;
  result.alikeness = products / squares * std::sqrt(static_cast<double>(beams.size() - 1));
  // The covariance of neighbours is the variance without the noise of single beams.
  const double without_noise = products / static_cast<double>(beams.size() - 1);
  Arcs best;
  for (std::size_t views = 1; views <= std::min(most_views, shape.beams / 6); ++views)
    if (const Arcs found = arcs(beams, views); found.explained > best.explained) {
      best = found;
      result.views = static_cast<int>(views);
    }
  if (best.explained > 0.6 * without_noise)
    result.depth = {std::abs(best.depth.value), best.depth.error};
  else
    result.views = 0;
  return result;
}

}  // namespace tubefoot
