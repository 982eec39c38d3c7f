// SPDX-License-Identifier: GPL-3.0-or-later
// Displacements of the near edge of the fan. The lower side of a camera's view is a plane, not a cone. The
// near edge of a fan of several views therefore consists of arcs. An arc is fitted as a parabola over each
// view. Displacements of another form are not reported.
#include "compare/diagnosis/near_edge.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "compare/measures/median.hpp"

namespace tubefoot {
namespace {

constexpr std::size_t reach = 5, least_beams = 16, most_views = 12, window = 5;
constexpr std::size_t settled = 4;  // row behind an edge whose blur is complete
constexpr double farthest = 4;      // samples; beams without an edge within this distance are left out

struct Beam {
  double place = 0;  ///< in the fan, 0 to 1
  double offset = 0;
  double edge = 0;  ///< predicted, in samples
};

/// Displacements of the near edge. Levels are those of the candidate relative to the prediction without level
/// curve. They rise behind the edge, at once or over many rows if the vertical pattern is tapered. The median
/// of all beams is the common rise. It contains the pattern, so that a displacement of the rise remains.
class NearEdge {
 public:
  explicit NearEdge(const Residual& residual) : r_(residual), plain_j_(r_.predicted_j.size()) {
    for (std::size_t k = 0; k < plain_j_.size(); ++k)
      plain_j_[k] =
          r_.predicted_j[k] / (r_.level_curve.empty() ? 1 : r_.level_curve[k % r_.fan.shape().samples]);
    find_levels();
    find_edges();
    find_edge_shape();
    find_rise();
    find_step();
  }

  /// Displacement of a column in samples. Rounding of the candidate to steps moves it by at most `rounding`,
  /// by similar amounts in neighbouring columns.
  struct Offset {
    double value = 0, rounding = 0;
  };
  /// The differences are summed over the rise and over the rows behind it. Both sums are linear in the
  /// displacement and in the gain of the column.
  std::optional<Offset> offset_of(std::size_t column) const {
    if (end_ == 0 || !is_uniform(column, 1, 2 * end_)) return std::nullopt;
    // Noise hides a faint edge.
    if (r_.predicted_j[column * r_.fan.shape().samples + edges_[column] + end_] < 3 * r_.noise_j)
      return std::nullopt;
    double lack = 0, common = 0, lack_behind = 0, common_behind = 0;
    for (std::ptrdiff_t k = -std::ptrdiff_t(reach); k <= std::ptrdiff_t(2 * end_); ++k) {
      const bool behind = k > std::ptrdiff_t(end_);
      (behind ? common_behind : common) += rise(k);
      (behind ? lack_behind : lack) += rise(k) - level(column, k);
    }
    // The sum of the slopes of the rise over an interval is the difference of its ends.
    const double slopes = rise(std::ptrdiff_t(end_)), slopes_behind = rise(std::ptrdiff_t(2 * end_)) - slopes;
    const double determinant = slopes * common_behind - slopes_behind * common;
    if (!(determinant > 0.1 * slopes * common_behind)) return std::nullopt;
    const double offset = (lack * common_behind - lack_behind * common) / determinant,
                 loss = (slopes * lack_behind - slopes_behind * lack) / determinant;
    // If all echoes behind the edge differ, the edge is that of a shadow and not displaced.
    if (loss > 0.4 || loss < -0.6 || std::abs(offset) > farthest) return std::nullopt;
    const double half_step =
        step_j_ / 2 / r_.predicted_j[column * r_.fan.shape().samples + edges_[column] + end_];
    return Offset{offset - within_sample(column),
                  half_step * double(end_) * (common_behind + common) / determinant};
  }

  /// Position of the predicted edge in samples.
  double edge(std::size_t column) const { return double(edges_[column]) + within_sample(column); }
  /// A long rise is that of a tapered vertical pattern. Its length depends on the range of the edge.
  bool is_long() const { return end_ > 2 * reach; }

  /// Sum of |candidate - prediction| over the rise.
  double difference(std::size_t column) const {
    const std::size_t from = column * r_.fan.shape().samples + edges_[column];
    double sum = 0;
    for (std::size_t bin = from - reach; bin <= from + end_; ++bin)
      sum += std::abs(r_.predicted_j[bin] - r_.candidate_j[bin]);
    return sum;
  }

 private:
  /// Median of the insonified bins of each row. Objects do not affect it.
  void find_levels() {
    levels_j_ = row_levels(r_.fan.shape(), plain_j_);
    std::vector<std::vector<double>> insonified(levels_j_.size());
    for (std::size_t bin = 0; bin < plain_j_.size(); ++bin)
      if (const std::size_t s = bin % levels_j_.size(); plain_j_[bin] > 0.1 * levels_j_[s])
        insonified[s].push_back(plain_j_[bin]);
    for (std::size_t s = 0; s < levels_j_.size(); ++s)
      if (!insonified[s].empty()) levels_j_[s] = median_of(std::move(insonified[s]));
  }
  void find_edges() {
    const std::size_t samples = r_.fan.shape().samples, columns = plain_j_.size() / samples;
    for (std::size_t column = 0; column < columns; ++column) {
      std::size_t s = 0;
      while (s < samples && !(plain_j_[column * samples + s] > 0.3 * levels_j_[s])) ++s;
      edges_.push_back(s);
    }
  }

  /// Measures how much the blur of the prediction lowers its first rows, relative to the trend of the rows
  /// behind them.
  void find_edge_shape() {
    std::array<double, 2 * settled> sums{};
    for (std::size_t column = 0; column < edges_.size(); ++column)
      for (std::size_t row = 1; row < sums.size() && is_uniform(column, 1, sums.size()); ++row)
        sums[row] += plain_j_[column * r_.fan.shape().samples + edges_[column] + row];
    if (!(sums.back() > 0)) return;
    const double trend = std::pow(sums[settled] / sums.back(), 1.0 / (settled - 1));
    for (std::size_t row = 1; row < settled; ++row)
      edge_shape_[row] = sums[row] / sums[settled] / std::pow(trend, settled - row);
  }

  /// Finds the common rise and its end, from which on it grows by less than a tenth over `reach` rows.
  void find_rise() {
    const std::size_t samples = r_.fan.shape().samples;
    for (std::size_t place = 0; place < samples / 2; ++place) {
      const std::ptrdiff_t k = std::ptrdiff_t(place) - std::ptrdiff_t(reach);
      const auto row = static_cast<std::size_t>(std::max<std::ptrdiff_t>(k, 1));
      std::vector<double> levels;
      for (std::size_t column = 0; column < edges_.size(); ++column)
        if (is_uniform(column, row, row)) levels.push_back(level(column, k));
      if (levels.size() < least_beams) break;
      double sum = 0;
      const double middle = median_of(levels);
      std::size_t count = 0;
      // The mean without outliers has no steps where the samples of an edge are partly insonified.
      for (const double l : levels)
        if (std::abs(l - middle) < 1) sum += l, ++count;
      rise_.push_back(count > 0 ? sum / double(count) : middle);
    }
    const auto mean = [&](std::size_t first) {
      double sum = 0;
      for (std::size_t k = first; k < first + reach; ++k) sum += rise_[k + reach];
      return sum / double(reach);
    };
    for (std::size_t k = reach; 2 * k + reach < rise_.size() && end_ == 0; ++k)
      if (mean(k - reach + 1) > 0 && mean(k + 1) < 1.1 * mean(k - reach + 1)) end_ = k;
  }

  /// Finds the steps to which the candidate is rounded near the edges: the smallest difference of values. It
  /// is close to 0 without such steps.
  void find_step() {
    std::vector<double> values;
    for (std::size_t column = 0; column < edges_.size() && end_ > 0; ++column)
      if (is_uniform(column, 1, 2 * end_)) {
        const auto behind = r_.candidate_j.subspan(column * r_.fan.shape().samples + edges_[column] + 1);
        values.insert(values.end(), behind.begin(), behind.begin() + std::ptrdiff_t(2 * end_));
      }
    if (values.empty()) return;
    std::ranges::sort(values);
    constexpr double rounding = 1e-6;
    double least = values.back();
    for (std::size_t k = 1; k < values.size(); ++k)
      if (const double gap = values[k] - values[k - 1]; gap > rounding * values.back())
        least = std::min(least, gap);
    step_j_ = least;
  }

  /// Position of the predicted edge behind the beginning of its sample. The sample is partly insonified.
  double within_sample(std::size_t column) const {
    const std::size_t at = column * r_.fan.shape().samples + edges_[column];
    double insonified = 0;
    for (std::size_t bin = at - reach; bin <= at; ++bin) insonified += plain_j_[bin];
    return 1 - insonified / plain_j_[at + 1] * edge_shape_[1];
  }
  double rise(std::ptrdiff_t k) const { return rise_[std::size_t(k + std::ptrdiff_t(reach))]; }
  /// Level of a column relative to the prediction, k rows behind its edge. The row behind the edge is the
  /// first that is insonified completely. `edge_shape_` removes the blur of the prediction.
  double level(std::size_t column, std::ptrdiff_t k) const {
    const std::size_t from = column * r_.fan.shape().samples + edges_[column],
                      row = static_cast<std::size_t>(std::max<std::ptrdiff_t>(k, 1));
    return r_.candidate_j[static_cast<std::size_t>(std::ptrdiff_t(from) + k)] / plain_j_[from + row] *
           (row < settled ? edge_shape_[row] : 1);
  }
  /// Returns whether the prediction contains only the surface behind the edge in these rows.
  bool is_uniform(std::size_t column, std::size_t first, std::size_t last) const {
    const std::size_t samples = r_.fan.shape().samples, edge = edges_[column];
    if (edge < reach || edge + last + 1 >= samples) return false;
    for (std::size_t s = edge + first; s <= edge + last; ++s) {
      const double p = plain_j_[column * samples + s];
      if (!(p > 0.3 * levels_j_[s] && p < 1.8 * levels_j_[s])) return false;
    }
    return true;
  }

  const Residual& r_;
  std::vector<double> plain_j_, levels_j_, rise_;  // the rise begins `reach` rows before the edge
  std::vector<std::size_t> edges_;                 // first insonified sample of each column
  std::array<double, settled> edge_shape_{1, 1, 1, 1};
  double step_j_ = 0;    // of the candidate's values
  std::size_t end_ = 0;  // of the rise, in rows behind the edge; 0: none
};

/// Subtracts from values their mean and, if `edges` is given, their linear dependence on it.
void subtract_trend(std::vector<double>& values, const std::vector<double>& edges) {
  const auto centre = [](std::vector<double>& of) {
    double mean = 0;
    for (const double v : of) mean += v / static_cast<double>(of.size());
    for (double& v : of) v -= mean;
  };
  centre(values);
  if (edges.empty()) return;
  std::vector<double> trend = edges;
  centre(trend);
  double squares = 0, products = 0;
  for (std::size_t k = 0; k < values.size(); ++k) {
    squares += trend[k] * trend[k];
    products += trend[k] * values[k];
  }
  // Edges within one sample differ only by rounding.
  if (squares < static_cast<double>(values.size())) return;
  for (std::size_t k = 0; k < values.size(); ++k) values[k] -= products / squares * trend[k];
}

/// Depth of parabolas over equal views: least squares, and a standard error for residuals that are correlated
/// over `window` beams (Newey and West 1987).
struct Arcs {
  Estimate depth;
  double explained = 0;  ///< mean square of the fitted displacements
};

/// Fits arcs to beams without trend; `edges` is that of subtract_trend(). Arcs that the trend contains are
/// not resolved and have a depth of 0.
Arcs arcs(const std::vector<Beam>& beams, const std::vector<double>& edges, std::size_t views) {
  std::vector<double> shape;
  for (const Beam& beam : beams) {
    const double of_view = beam.place * static_cast<double>(views),
                 off = 2 * (of_view - std::floor(of_view)) - 1;
    shape.push_back(1 - off * off);
  }
  subtract_trend(shape, edges);
  double squares = 0, products = 0;
  for (std::size_t k = 0; k < beams.size(); ++k) {
    squares += shape[k] * shape[k];
    products += shape[k] * beams[k].offset;
  }
  // The variance of a parabola over whole views is 0.09.
  if (squares < 0.02 * static_cast<double>(beams.size())) return {};
  const double depth = products / squares;
  std::vector<double> scores;
  for (std::size_t k = 0; k < beams.size(); ++k)
    scores.push_back(shape[k] * (beams[k].offset - depth * shape[k]));
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
  const NearEdge edge(r);
  std::vector<std::vector<double>> of_beam(shape.beams), edges_of_beam(shape.beams);
  std::vector<double> roundings;
  for (std::size_t ping = 0; ping < shape.pings; ++ping) {
    std::vector<std::pair<std::size_t, double>> offsets;
    std::vector<double> all;
    for (std::size_t beam = 0; beam < shape.beams; ++beam)
      if (const auto offset = edge.offset_of(ping * shape.beams + beam)) {
        offsets.emplace_back(beam, offset->value);
        all.push_back(offset->value);
        roundings.push_back(offset->rounding);
        result.difference += edge.difference(ping * shape.beams + beam);
      }
    if (offsets.size() < least_beams) continue;
    const double middle = median_of(all);
    for (const auto& [beam, offset] : offsets) {
      of_beam[beam].push_back(offset - middle);
      edges_of_beam[beam].push_back(edge.edge(ping * shape.beams + beam));
    }
  }
  std::vector<Beam> beams;
  for (std::size_t beam = 0; beam < shape.beams; ++beam)
    if (!of_beam[beam].empty())
      beams.push_back({(static_cast<double>(beam) + 0.5) / static_cast<double>(shape.beams),
                       median_of(of_beam[beam]), median_of(edges_of_beam[beam])});
  if (beams.size() < std::max(least_beams, shape.beams / 3)) return result;
  std::vector<double> offsets, edges;
  for (const Beam& beam : beams) {
    offsets.push_back(beam.offset);
    if (edge.is_long()) edges.push_back(beam.edge);
  }
  subtract_trend(offsets, edges);
  for (std::size_t k = 0; k < beams.size(); ++k) beams[k].offset = offsets[k];
  double products = 0;
  for (std::size_t k = 1; k < beams.size(); ++k) products += offsets[k] * offsets[k - 1];
  // The covariance of neighbours is the variance without the noise of single beams.
  const double without_noise = products / static_cast<double>(beams.size() - 1);
  Arcs best;
  for (std::size_t views = 1; views <= std::min(most_views, shape.beams / 6); ++views)
    if (const Arcs found = arcs(beams, edges, views); found.explained > best.explained) {
      best = found;
      result.views = static_cast<int>(views);
    }
  const double rounding = median_of(roundings);
  const Arcs usual = arcs(beams, edges, static_cast<std::size_t>(r.fan.usual_views()));
  result.usual_error = std::hypot(usual.depth.error, rounding);
  if (best.explained > 0.6 * without_noise)
    result.depth = {std::abs(best.depth.value), std::hypot(best.depth.error, rounding)};
  else
    result.views = 0;
  return result;
}

}  // namespace tubefoot
