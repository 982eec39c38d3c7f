// SPDX-License-Identifier: GPL-3.0-or-later
// Fine alignment of the reference with the candidate. Gauss-Newton iterations with Huber weights fit
// displacement, scales, blur and the levels of the rows together. Standard errors come from the spread of
// the steps of patches of the picture. Terms that are not significant are removed one by one.
#include "compare/diagnosis/alignment.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <set>
#include <utility>

#include "compare/diagnosis/coarse_search.hpp"
#include "compare/diagnosis/normal_equations.hpp"
#include "compare/measures/median.hpp"
#include "geometry/steps/stop.hpp"

namespace tubefoot {
namespace {

using Picture = std::vector<double>;

constexpr std::size_t patch_columns = 16, patch_rows = 8, patches = patch_columns * patch_rows;
constexpr double fine_blur = 1, least_error_bars = 5;
constexpr std::size_t most_knots = 7, rows_per_knot = 8;
constexpr double least_share_of_curve = 0.35;
constexpr double clearly_better = 0.95;  // factor of the misfit
constexpr double largest_curve = 3;      // of the logarithm of a level
constexpr std::size_t border = 3;  // bins at the border, where blur and shifts reach outside of the picture

bool is_growth(WarpTerm term) { return term == WarpTerm::beam_growth || term == WarpTerm::sample_growth; }
bool is_blur(WarpTerm term) {
  return term == WarpTerm::beam_blur || term == WarpTerm::sample_blur || is_growth(term);
}

/// A parameter of the fit. The knots of the level curve come first.
struct Parameter {
  std::optional<WarpTerm> term;  ///< none for a knot
  std::size_t knot = 0;
  double step = 0;     ///< step of the numerical derivative
  double largest = 0;  ///< largest step of one iteration
  double visible = 0;  ///< smaller values have no relevant effect
};
using Parameters = std::vector<Parameter>;

/// Gauss-Newton search over all terms.
class FineSearch {
 public:
  FineSearch(const Pictures& pictures, const Warp& start)
      : pictures_(pictures), fan_(pictures.fan), shape_(fan_.shape()), warp_(start) {
    const double wide = fan_.has_width() ? fine_blur : 0;
    smooth_reference_ = fan_.blurred(pictures.reference_j, wide, fine_blur);
    used_ = pictures.left_out;
    used_.flip();
    used_.resize(shape_.bins(), true);
    calibrate();
    levels_ = row_levels(shape_, scaled(predicted_j_));
    for (std::size_t k = 0; k < used_.size(); ++k) used_[k] = used_[k] && says_something(k);
    set_knots();
    calibrate();
    levels_ = row_levels(shape_, scaled(predicted_j_));
    candidate_ = masked(as_seen(shape_, fan_.blurred(pictures.candidate_j, wide, fine_blur), levels_));
  }

  double misfit() const { return misfit_of(masked(predicted(warp_)), candidate_); }

  LocalEstimate shift() {
    Parameters parameters;
    for (const Parameter& p : all_parameters())
      if (!p.term || p.term == WarpTerm::beams || p.term == WarpTerm::samples) parameters.push_back(p);
    iterate(parameters);
    LocalEstimate local;
    for (std::size_t i = 0; i < parameters.size(); ++i) {
      if (parameters[i].term == WarpTerm::beams) local.beams = {warp_.beams, errors_[i]};
      if (parameters[i].term == WarpTerm::samples) local.samples = {warp_.samples, errors_[i]};
    }
    return local;
  }

  Alignment found() {
    Parameters parameters = all_parameters();
    settle(parameters);
    if (fan_.range_m(0) > 0) simplify(parameters);
    if (warp_.azimuth_scale != 0 && warp_.tangent == 0) try_tangent(parameters);
    drop_idle(parameters);
    Alignment alignment;
    for (std::size_t i = 0; i < parameters.size(); ++i)
      if (parameters[i].term) alignment.errors[static_cast<std::size_t>(*parameters[i].term)] = errors_[i];
    alignment.resolvable = resolvable(parameters);
    alignment.warp = warp_;
    alignment.fit = fit_;
    alignment.level_curve = curve();
    alignment.predicted_j = scaled(predicted_j_);
    alignment.misfit = misfit();
    return alignment;
  }

 private:
  bool says_something(std::size_t bin) const {
    const std::size_t s = bin % shape_.samples, beam = bin / shape_.samples % shape_.beams;
    const bool inside = !fan_.has_width() || (beam >= border && beam + border < shape_.beams);
    return inside && s >= std::max(border, pictures_.first_row) && s + border < shape_.samples &&
           levels_[s] > pictures_.faintest_j;
  }
  Picture masked(Picture picture) const {
    for (std::size_t k = 0; k < picture.size(); ++k)
      if (!used_[k]) picture[k] = 0;
    return picture;
  }
  Picture scaled(Picture energy) const {
    for (std::size_t k = 0; k < energy.size(); ++k) energy[k] *= factors_[k % shape_.samples];
    return energy;
  }

  /// Places the knots of the level curve at equal numbers of used rows.
  void set_knots() {
    std::vector<bool> row_used(shape_.samples);
    for (std::size_t k = 0; k < used_.size(); ++k)
      if (used_[k]) row_used[k % shape_.samples] = true;
    std::vector<std::size_t> rows;
    for (std::size_t s = 0; s < row_used.size(); ++s)
      if (row_used[s]) rows.push_back(s);
    const std::size_t count =
        rows.empty() ? 1 : std::clamp<std::size_t>(rows.size() / rows_per_knot, 1, most_knots);
    knots_.clear();
    for (std::size_t k = 0; k < count; ++k)
      knots_.push_back(
          rows.empty() ? 0 : rows[count > 1 ? k * (rows.size() - 1) / (count - 1) : rows.size() / 2]);
    curve_.assign(count, 0.0);
  }
  /// Share of a knot in the logarithm of the level of a row. The shares of a row sum to 1.
  double share_of(std::size_t knot, std::size_t row) const {
    const auto at = [&](std::size_t k) { return static_cast<double>(knots_[k]); };
    const auto s = static_cast<double>(row);
    if (s <= at(knot)) return knot == 0 ? 1 : std::max(0.0, (s - at(knot - 1)) / (at(knot) - at(knot - 1)));
    return knot + 1 == knots_.size() ? 1 : std::max(0.0, (at(knot + 1) - s) / (at(knot + 1) - at(knot)));
  }
  std::vector<double> curve() const {
    std::vector<double> result(shape_.samples, 1.0);
    for (std::size_t s = 0; s < result.size(); ++s) {
      double log_level = 0;
      for (std::size_t k = 0; k < curve_.size(); ++k) log_level += curve_[k] * share_of(k, s);
      result[s] = std::exp(log_level);
    }
    return result;
  }

  /// Fits gain and range exponent to patches (energy_fit.hpp) of the rows that count. The level curve
  /// multiplies both.
  void calibrate() {
    predicted_j_ = fan_.warped(pictures_.reference_j, warp_);
    const Picture reference = masked(predicted_j_), candidate = masked(pictures_.candidate_j);
    const std::vector<double>& ranges = fan_.ranges_m();
    fit_ = fit_energies({shape_, reference, candidate, {}, ranges}, {true, ranges.front() > 0, false})
               .value_or(EnergyFit{});
    factors_.assign(shape_.samples, std::pow(10, fit_.gain_db.value / 10));
    for (std::size_t s = 0; s < shape_.samples; ++s)
      if (fit_.exponent.value != 0)
        factors_[s] *= std::pow(ranges[s] / fit_.middle_range_m, fit_.exponent.value);
    const std::vector<double> levels = curve();
    for (std::size_t s = 0; s < shape_.samples; ++s) factors_[s] *= levels[s];
  }

  /// The picture for a warp, with the logarithm of the level at a knot changed.
  Picture predicted(const Warp& warp, std::size_t knot = 0, double change = 0) const {
    Picture energy = fan_.warped(smooth_reference_, warp);
    std::vector<double> factors = factors_;
    for (std::size_t s = 0; s < factors.size() && change != 0; ++s)
      factors[s] *= std::exp(change * share_of(knot, s));
    for (std::size_t k = 0; k < energy.size(); ++k) energy[k] *= factors[k % shape_.samples];
    return as_seen(shape_, energy, levels_);
  }

  Parameters all_parameters() const {
    const double far = fan_.range_m(shape_.samples - 1) / fan_.sample_m(),
                 edge = static_cast<double>(shape_.beams) / 2;
    Parameters all;
    for (std::size_t knot = 0; knot < knots_.size(); ++knot) all.push_back({{}, knot, 0.02, 0.5, 0});
    all.push_back({WarpTerm::samples, 0, 0.2, 1, 0.1});
    all.push_back({WarpTerm::range_scale, 0, 0.2 / far, 1 / far, 0.2 / far});
    all.push_back({WarpTerm::sample_blur, 0, 0.1, 0.5, 0.15});
    if (warp_.sample_growth != 0) all.push_back(growth(WarpTerm::sample_growth));
    if (!fan_.has_width()) return all;
    all.push_back({WarpTerm::beams, 0, 0.2, 1, 0.06});
    all.push_back({WarpTerm::azimuth_scale, 0, 0.2 / edge, 1 / edge, 0.12 / edge});
    all.push_back({WarpTerm::beam_blur, 0, 0.1, 0.5, 0.15});
    if (warp_.beam_growth != 0) all.push_back(growth(WarpTerm::beam_growth));
    if (warp_.tangent != 0) all.push_back(tangent(warp_.views));
    return all;
  }
  static Parameter growth(WarpTerm term) { return {term, 0, 0.1, 0.5, 0.3}; }
  Parameter tangent(int views) const {
    const double most = fan_.largest_of_tangent(views);
    return {WarpTerm::tangent, 0, 0.2 / most, 1 / most, 0.08 / most};
  }

  void iterate(const Parameters& parameters) {
    for (int round = 0; round < 12; ++round) {
      const std::vector<double> steps = solve(parameters);
      double largest = 0;
      for (std::size_t i = 0; i < parameters.size(); ++i) {
        const Parameter& p = parameters[i];
        const double step = std::clamp(steps[i], -p.largest, p.largest);
        if (!p.term) {
          curve_[p.knot] = std::clamp(curve_[p.knot] + step, -largest_curve, largest_curve);
          continue;
        }
        double& value = value_of(warp_, *p.term);
        value += step;
        if (is_blur(*p.term)) value = std::clamp(value, -0.2, 9.0);
        largest = std::max(largest, std::abs(step) / p.step);
      }
      calibrate();
      if (largest < 0.05) break;
    }
    solve(parameters);  // sets errors_ at the solution
    stop_if_wanted();
  }

  /// Fits all parameters, and removes those that are not significant, the weakest first.
  void settle(Parameters& parameters) {
    bool tangent_tried = warp_.tangent != 0 || !fan_.has_width(),
         growth_tried = warp_.sample_growth != 0 || warp_.beam_growth != 0;
    while (true) {
      iterate(parameters);
      if (const auto weakest = weakest_of(parameters); weakest != parameters.end()) {
        value_of(warp_, *weakest->term) = 0;
        parameters.erase(weakest);
      } else if (!std::exchange(tangent_tried, true) && add_tangent(parameters)) {
        continue;
      } else if (std::exchange(growth_tried, true) || !add_growth(parameters)) {
        break;
      }
    }
  }

  /// Adds blur that grows with range, along each axis for which it is significant.
  bool add_growth(Parameters& parameters) {
    bool any = false;
    for (const WarpTerm term : {WarpTerm::sample_growth, WarpTerm::beam_growth}) {
      if (term == WarpTerm::beam_growth && !fan_.has_width()) continue;
      const FineSearch was = *this;
      Parameters more = parameters;
      more.push_back(growth(term));
      value_of(warp_, term) = more.back().step;
      iterate(more);
      if (value_of(warp_, term) > std::max(more.back().visible, least_error_bars * errors_.back())) {
        parameters = more;
        any = true;
      } else {
        restore(was);
      }
    }
    solve(parameters);
    return any;
  }

  /// Removes displacements that explain too little of the misfit. Errors of another kind, such as a vertical
  /// pattern or a missing object, pull significantly at displacements but are not explained by them.
  void drop_idle(Parameters& parameters) {
    using enum WarpTerm;
    for (const std::vector<WarpTerm>& group :
         {std::vector{samples, range_scale}, std::vector{beams}, std::vector{azimuth_scale, tangent},
          std::vector{sample_growth, beam_growth}}) {
      const auto in_group = [&](const Parameter& p) {
        return p.term && std::ranges::count(group, *p.term) > 0;
      };
      if (std::ranges::none_of(parameters, in_group)) continue;
      const double found = misfit();
      const FineSearch was = *this;
      Parameters fewer = parameters;
      std::erase_if(fewer, in_group);
      for (const WarpTerm term : group) value_of(warp_, term) = 0;
      settle(fewer);
      if (found > (1 - least_share_explained) * misfit()) {
        parameters = fewer;
        continue;
      }
      restore(was);
    }
  }

  /// The smallest displacements that would be found, of the terms that are 0.
  std::array<double, warp_terms> resolvable(const Parameters& parameters) {
    std::array<double, warp_terms> sizes{};
    for (const Parameter& candidate : all_parameters()) {
      if (!candidate.term || is_blur(*candidate.term) || value_of(warp_, *candidate.term) != 0) continue;
      Parameters more = parameters;
      more.push_back(candidate);
      solve(more);
      sizes[static_cast<std::size_t>(*candidate.term)] =
          std::max(candidate.visible, least_error_bars * errors_.back());
    }
    if (fan_.has_width() && warp_.tangent == 0) {
      const int views = fan_.usual_views();
      if (const double most = fan_.largest_of_tangent(views); most > 0.02) {
        Parameters more = parameters;
        warp_.views = views;
        more.push_back(tangent(views));
        solve(more);
        sizes[static_cast<std::size_t>(WarpTerm::tangent)] =
            most * std::max(more.back().visible, least_error_bars * errors_.back());
        warp_.views = 1;
      }
    }
    return sizes;
  }
  void restore(const FineSearch& was) {
    warp_ = was.warp_;
    errors_ = was.errors_;
    curve_ = was.curve_;
    calibrate();
  }

  /// Tries a shift alone and a scale of range alone. Their effects are nearly the same if all echoes lie in
  /// a narrow interval of range. Each of them is kept if it explains about as much as both; the shift is
  /// tried first.
  void simplify(Parameters& parameters) {
    const bool scaled = warp_.range_scale != 0;
    if (!scaled && warp_.samples == 0) return;
    const double found = misfit();
    for (const WarpTerm alone : {WarpTerm::samples, WarpTerm::range_scale}) {
      if (!scaled && alone == WarpTerm::samples) continue;  // this is the present model already
      const bool simpler = scaled && (warp_.samples != 0 || alone == WarpTerm::samples);
      if (scaled && !simpler) continue;
      const FineSearch was = *this;
      const WarpTerm other = alone == WarpTerm::samples ? WarpTerm::range_scale : WarpTerm::samples;
      Parameters fewer;
      for (const Parameter& p : all_parameters())
        if (p.term != other) fewer.push_back(p);
      warp_.samples = warp_.range_scale = 0;
      settle(fewer);
      if (misfit() < (simpler ? 1.02 : 0.98) * found) {
        parameters = fewer;
        return;
      }
      restore(was);
    }
  }

  /// Tries the tangent of a single view instead of the azimuth scale. Over most of the fan it displaces
  /// beams as another opening angle does.
  void try_tangent(Parameters& parameters) {
    if (fan_.largest_of_tangent(1) < 0.08) return;
    const double found = misfit();
    const FineSearch was = *this;
    warp_.azimuth_scale = 0;
    warp_.tangent = warp_.views = 1;
    Parameters other = all_parameters();
    settle(other);
    if (misfit() < clearly_better * found) {
      parameters = other;
      return;
    }
    restore(was);
  }

  std::size_t patch_of(std::size_t bin) const {
    const std::size_t s = bin % shape_.samples, column = bin / shape_.samples;
    return column * patch_columns / (shape_.pings * shape_.beams) * patch_rows +
           s * patch_rows / shape_.samples;
  }

  std::vector<Picture> slopes_of(const Parameters& parameters) const {
    std::vector<Picture> slopes;
    for (const Parameter& p : parameters) {
      Warp up = warp_, down = warp_;
      if (p.term) {
        value_of(up, *p.term) += p.step;
        value_of(down, *p.term) -= p.step;
      }
      const double change = p.term ? 0 : p.step;
      Picture slope = predicted(up, p.knot, change);
      const Picture other = predicted(down, p.knot, -change);
      for (std::size_t k = 0; k < slope.size(); ++k) slope[k] = (slope[k] - other[k]) / (2 * p.step);
      slopes.push_back(std::move(slope));
    }
    return slopes;
  }

  /// Returns the limit of Huber's weights. Larger deviations have less weight.
  double huber_limit(const Picture& at) const {
    std::vector<double> sizes;
    for (std::size_t k = 0; k < at.size(); ++k)
      if (used_[k] && at[k] + candidate_[k] > 0.05) sizes.push_back(std::abs(candidate_[k] - at[k]));
    if (sizes.empty()) return 1;
    return std::max(3 * median_of(std::move(sizes)), 0.02);
  }

  /// Makes one step of all parameters and sets their errors_.
  std::vector<double> solve(const Parameters& parameters) {
    const std::size_t n = parameters.size();
    const Picture at = predicted(warp_);
    const std::vector<Picture> slopes = slopes_of(parameters);
    const double limit = huber_limit(at);
    std::vector<double> normal(n * n), right(n), of_normal(patches * n * n), of_right(patches * n);
    std::vector<bool> counts(patches);
    // The level curve is too coarse for rows in which a vertical pattern falls to 0. Only the knots, which
    // are the first parameters, use these rows.
    std::vector<double> levels = curve();
    const double least_level = least_share_of_curve * std::ranges::max(levels);
    for (std::size_t k = 0; k < at.size(); ++k) {
      if (!used_[k] || (at[k] == 0 && candidate_[k] == 0)) continue;
      const std::size_t of_bin = levels[k % shape_.samples] < least_level ? knots_.size() : n;
      const double off = candidate_[k] - at[k],
                   weight = std::min(1.0, limit / std::max(std::abs(off), 1e-300));
      const std::size_t patch = patch_of(k);
      counts[patch] = true;
      for (std::size_t i = 0; i < of_bin; ++i) {
        const double a = weight * slopes[i][k];
        if (a == 0) continue;
        of_right[patch * n + i] += a * off;
        for (std::size_t j = 0; j < of_bin; ++j) of_normal[(patch * n + i) * n + j] += a * slopes[j][k];
      }
    }
    for (std::size_t k = 0; k < of_right.size(); ++k) right[k % n] += of_right[k];
    for (std::size_t k = 0; k < of_normal.size(); ++k) normal[k % (n * n)] += of_normal[k];
    constexpr double regularisation = 1e-12;
    for (std::size_t i = 0; i < n; ++i) normal[i * n + i] += regularisation;
    const std::vector<double> inverse = inverted(normal, n);
    std::vector<double> steps(n);
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t j = 0; j < n; ++j) steps[i] += inverse[i * n + j] * right[j];
    // The step that each patch would make beyond the common step. The spread of these steps gives the
    // errors, which are clustered by columns and by rows (Cameron, Gelbach and Miller 2011).
    std::vector<double> of_cells(n), by_column(patch_columns * n), by_row(patch_rows * n);
    double voters = 0;
    for (std::size_t patch = 0; patch < patches; ++patch) {
      if (!counts[patch]) continue;
      ++voters;
      std::vector<double> vote(n);
      for (std::size_t i = 0; i < n; ++i) {
        vote[i] = of_right[patch * n + i];
        for (std::size_t j = 0; j < n; ++j) vote[i] -= of_normal[(patch * n + i) * n + j] * steps[j];
      }
      for (std::size_t i = 0; i < n; ++i) {
        double moved = 0;
        for (std::size_t j = 0; j < n; ++j) moved += inverse[i * n + j] * vote[j];
        of_cells[i] += moved * moved;
        by_column[patch / patch_rows * n + i] += moved;
        by_row[patch % patch_rows * n + i] += moved;
      }
    }
    const auto terms = static_cast<double>(n);
    const double few = voters > terms + 1 ? voters / (voters - terms) : 100;
    errors_.assign(n, 0);
    for (std::size_t k = 0; k < by_column.size(); ++k) errors_[k % n] += by_column[k] * by_column[k];
    for (std::size_t k = 0; k < by_row.size(); ++k) errors_[k % n] += by_row[k] * by_row[k];
    for (std::size_t i = 0; i < n; ++i)
      errors_[i] = normal[i * n + i] > 2 * regularisation
                       ? std::sqrt(few * std::max(of_cells[i], errors_[i] - of_cells[i]))
                       : std::numeric_limits<double>::infinity();  // no bin contains the parameter
    return steps;
  }

  /// Returns the term to remove next, or the end if all are significant.
  Parameters::iterator weakest_of(Parameters& parameters) {
    auto weakest = parameters.end();
    double least = 1;
    for (auto p = parameters.begin(); p != parameters.end(); ++p) {
      if (!p->term) continue;
      const double value = value_of(warp_, *p->term),
                   error = errors_[static_cast<std::size_t>(p - parameters.begin())];
      const double strength = is_blur(*p->term) && value < 0
                                  ? 0
                                  : std::abs(value) / std::max(least_error_bars * error, p->visible);
      if (strength >= least) continue;
      least = strength;
      weakest = p;
    }
    return weakest;
  }

  /// Adds the tangent with the number of views that explains most of the remaining difference, if it is
  /// significant.
  bool add_tangent(Parameters& parameters) {
    double strongest = least_error_bars;
    int best = 0;
    for (const int views : std::set{1, 2, 3, 4, 6, fan_.usual_views()}) {
      if (fan_.largest_of_tangent(views) < 0.08) continue;
      Parameters more = parameters;
      more.push_back(tangent(views));
      warp_.views = views;
      const double step = std::abs(solve(more).back()), bars = step / (errors_.back() + 1e-300);
      if (bars <= strongest || step <= more.back().visible) continue;
      strongest = bars;
      best = views;
    }
    warp_.views = std::max(best, 1);
    if (best > 0) parameters.push_back(tangent(best));
    solve(parameters);
    return best > 0;
  }

  const Pictures& pictures_;
  const Fan& fan_;
  EchoShape shape_;
  Warp warp_;
  std::vector<std::size_t> knots_{0};  // rows
  std::vector<double> curve_ = {0};    // logarithms of levels at the knots
  std::vector<double> levels_, factors_, errors_;
  std::vector<bool> used_;
  Picture smooth_reference_, candidate_, predicted_j_;
  EnergyFit fit_;
};

}  // namespace

double& value_of(Warp& warp, WarpTerm term) {
  switch (term) {
    case WarpTerm::beams:
      return warp.beams;
    case WarpTerm::samples:
      return warp.samples;
    case WarpTerm::azimuth_scale:
      return warp.azimuth_scale;
    case WarpTerm::range_scale:
      return warp.range_scale;
    case WarpTerm::tangent:
      return warp.tangent;
    case WarpTerm::beam_blur:
      return warp.beam_blur;
    case WarpTerm::sample_blur:
      return warp.sample_blur;
    case WarpTerm::beam_growth:
      return warp.beam_growth;
    case WarpTerm::sample_growth:
      break;
  }
  return warp.sample_growth;
}

double value_of(const Warp& warp, WarpTerm term) {
  Warp copy = warp;
  return value_of(copy, term);
}

std::vector<double> row_levels(const EchoShape& shape, const std::vector<double>& energy_j) {
  const double threshold_j = lit_threshold(energy_j);
  std::vector<double> sums(shape.samples + 1), counts(shape.samples + 1), result(shape.samples, 1.0);
  for (std::size_t k = 0; k < energy_j.size(); ++k) {
    if (!(energy_j[k] > threshold_j)) continue;
    sums[k % shape.samples + 1] += energy_j[k];
    ++counts[k % shape.samples + 1];
  }
  for (std::size_t s = 0; s < shape.samples; ++s) {
    sums[s + 1] += sums[s];
    counts[s + 1] += counts[s];
  }
  if (counts.back() == 0) return result;
  const std::size_t reach = std::max<std::size_t>(4, shape.samples / 40);
  for (std::size_t s = 0; s < shape.samples; ++s) {
    std::size_t first = s > reach ? s - reach : 0, last = std::min(shape.samples, s + reach + 1);
    while (counts[last] == counts[first]) {
      first = first > 0 ? first - 1 : 0;
      last = std::min(shape.samples, last + 1);
    }
    result[s] = (sums[last] - sums[first]) / (counts[last] - counts[first]);
  }
  return result;
}

LocalEstimate local_shift(const Pictures& pictures) { return FineSearch(pictures, {}).shift(); }

double misfit_under(const Pictures& pictures, const Warp& warp) {
  return FineSearch(pictures, warp).misfit();
}

std::size_t Alignment::terms() const {
  std::size_t count = 0;
  for (std::size_t k = 0; k < warp_terms; ++k) count += value_of(warp, static_cast<WarpTerm>(k)) != 0;
  return count;
}

Alignment align(const Pictures& pictures, const Warp& start) {
  const double before = FineSearch(pictures, {}).misfit();
  Alignment alignment = FineSearch(pictures, start).found();
  alignment.misfit_before = before;
  return alignment;
}

}  // namespace tubefoot
