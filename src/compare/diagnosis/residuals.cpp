// SPDX-License-Identifier: GPL-3.0-or-later
// Measures the difference that remains after alignment: wrongly insonified shadows, missing near returns,
// offsets of first returns and of shadow borders, scatter, and quantisation steps.
#include "compare/diagnosis/residuals.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>
#include <utility>

#include "compare/measures/median.hpp"

namespace tubefoot {
namespace {

/// Mean and deviation of single borders or beams.
double mean_of(const std::vector<double>& values) {
  return values.empty()
             ? 0
             : std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}
double deviation_of(const std::vector<double>& values) {
  const double mean = mean_of(values);
  double squares = 0;
  for (const double v : values) squares += (v - mean) * (v - mean);
  return values.size() > 1 ? std::sqrt(squares / static_cast<double>(values.size() - 1)) : 0;
}

/// Walks along an axis of the picture and measures the shift of each shadow border. A border lies between
/// `plateau` insonified bins and as many dark bins. The shift is the energy that the candidate lacks there,
/// in bins; a positive shift means a larger shadow.
class EdgeWalk {
 public:
  explicit EdgeWalk(const Residual& residual) : residual_(residual) {}

  void along(std::size_t first, std::size_t stride, std::size_t length) {
    // Only borders between the first and the last echo of the line count, since the ends of the fan are not
    // shadows.
    const auto is_lit = [&](std::size_t k) { return residual_.predicted_j[first + k * stride] > 0; };
    std::size_t begin = 0, end = length;
    while (begin < end && !is_lit(begin)) ++begin;
    while (end > begin && !is_lit(end - 1)) --end;
    for (std::size_t k = begin + plateau; k + plateau <= end; ++k) {
      if (const auto lack = at(first, stride, k, 1)) offsets_.push_back(*lack);
      if (const auto lack = at(first, stride, k, -1)) offsets_.push_back(*lack);
    }
  }
  EdgeOffsets result() const {
    EdgeOffsets offsets;
    offsets.edges = offsets_.size();
    offsets.spread = deviation_of(offsets_);
    offsets.mean.value = mean_of(offsets_);
    // Adjacent borders belong to one object. The standard error therefore counts a third of the borders.
    if (!offsets_.empty())
      offsets.mean.error = offsets.spread * std::sqrt(3 / static_cast<double>(offsets_.size()));
    return offsets;
  }

 private:
  static constexpr std::size_t plateau = 4;

  /// Measures the border before place k. `way` 1: dark from k on, -1: dark before k.
  std::optional<double> at(std::size_t first, std::size_t stride, std::size_t k, int way) const {
    double lit = 0, lack = 0;
    for (std::size_t i = 0; i < plateau; ++i) {
      const std::size_t in_light = first + stride * (way > 0 ? k - 1 - i : k + i),
                        in_dark = first + stride * (way > 0 ? k + i : k - 1 - i);
      const std::size_t row = in_light % residual_.fan.shape().samples;
      if (!residual_.row_counts[row]) return std::nullopt;
      const double level = residual_.levels_j[row];
      const double p = residual_.predicted_j[in_light], q = residual_.predicted_j[in_dark];
      // The two bins at the border may be partly insonified.
      if (i > 0 && (!(p > 0.4 * level) || !(p < 1.8 * level) || q > 0.02 * level)) return std::nullopt;
      if (i == 0 && (!(p > 0.5 * level) || q > 0.5 * level)) return std::nullopt;
      if (i > 0) lit += p / (plateau - 1);
      lack += p - residual_.candidate_j[in_light] + q - residual_.candidate_j[in_dark];
    }
    return std::clamp(lack / lit, -4.0, 4.0);
  }

  const Residual& residual_;
  std::vector<double> offsets_;
};

/// Returns whether a bin within some samples before `bin` in its beam is brighter than the level of its
/// row.
bool bright_before(const Residual& r, std::size_t bin) {
  constexpr std::size_t reach = 20;
  const std::size_t s = bin % r.fan.shape().samples;
  for (std::size_t k = 1; k <= std::min(reach, s); ++k)
    if (r.predicted_j[bin - k] > 1.7 * r.levels_j[s - k]) return true;
  return false;
}

/// Returns whether the level of the candidate relative to the reference rises in a step at a row. A step is
/// more than twice the rise behind the row. A vertical pattern that begins there rises at most as much. The
/// interval is wider than a step that is blurred by one bin.
bool is_step(const Residual& r, std::size_t row) {
  constexpr std::size_t interval = 5;
  const EchoShape& shape = r.fan.shape();
  if (row < 2 || row + 2 * interval >= shape.samples) return false;
  const auto level = [&](std::size_t first) {
    double p = 0, c = 0;
    for (std::size_t s = first; s < first + 2; ++s)
      for (std::size_t column = 0; column < shape.pings * shape.beams; ++column) {
        const std::size_t bin = column * shape.samples + s;
        if (!(r.predicted_j[bin] > 0.2 * r.levels_j[s])) continue;
        p += r.predicted_j[bin] / (r.level_curve.empty() ? 1 : r.level_curve[s]);
        c += r.candidate_j[bin];
      }
    return p > 0 ? c / p : 0;
  };
  const double before = level(row - 2), at = level(row - 2 + interval),
               behind = level(row - 2 + 2 * interval);
  return at - before > 2 * std::max(behind - at, 0.0);
}

/// Number of the bins of a shadow in runs along range that contain wrongly insonified bins. Other shadows
/// that touch this one, and the dark parts of the fan, do not count.
std::size_t own_shadow(const Residual& r, const std::vector<bool>& wrong, std::vector<std::size_t>& shadow) {
  std::ranges::sort(shadow);
  const std::size_t samples = r.fan.shape().samples;
  std::size_t count = 0;
  for (std::size_t first = 0, last = 0; first < shadow.size(); first = last) {
    bool any = false;
    for (last = first; last < shadow.size() && shadow[last] - shadow[first] == last - first &&
                       shadow[last] / samples == shadow[first] / samples;
         ++last)
      any = any || wrong[shadow[last]];
    if (any) count += last - first;
  }
  return count;
}

}  // namespace

WronglyLit wrongly_lit(const Residual& r) {
  const EchoShape& shape = r.fan.shape();
  WronglyLit lit;
  lit.bins.resize(shape.bins());
  if (r.labels) lit.of_object.resize(r.labels->object_names.size());
  const auto is_shadow = [&](std::size_t bin) { return r.dark[bin] && r.row_counts[bin % shape.samples]; };
  const auto is_named = [&](std::size_t bin) {
    return r.labels && !r.labels->near_caster.empty() && r.labels->near_caster[bin] != SceneLabels::none;
  };
  for (std::size_t bin = 0; bin < shape.bins(); ++bin) {
    const std::size_t s = bin % shape.samples;
    lit.bins[bin] = is_shadow(bin) && r.candidate_j[bin] > std::max(r.noise_j, 0.15 * r.levels_j[s]);
    if (!is_named(bin) || !is_shadow(bin)) continue;
    const std::uint16_t object = r.labels->near_caster[bin];
    lit.of_object[object].wrong += lit.bins[bin];
    ++lit.of_object[object].all;
  }
  std::vector<bool> visited(shape.bins());
  std::vector<std::size_t> shadow;
  for (std::size_t start = 0; start < shape.bins(); ++start) {
    if (visited[start] || !is_shadow(start)) continue;
    shadow.assign(1, start);
    visited[start] = true;
    std::size_t wrong = 0, beginnings = 0, bright = 0;
    for (std::size_t next = 0; next < shadow.size(); ++next) {
      const std::size_t bin = shadow[next], s = bin % shape.samples, beam = bin / shape.samples % shape.beams;
      const auto reach = [&](std::size_t neighbour) {
        if (visited[neighbour] || !is_shadow(neighbour)) return;
        visited[neighbour] = true;
        shadow.push_back(neighbour);
      };
      if (s > 0) reach(bin - 1);
      if (s + 1 < shape.samples) reach(bin + 1);
      if (beam > 0) reach(bin - shape.samples);
      if (beam + 1 < shape.beams) reach(bin + shape.samples);
      // Shadows of named objects do not belong to a visible surface.
      wrong += lit.bins[bin] && !is_named(bin);
      if (s > 0 && r.dark[bin - 1]) continue;
      ++beginnings;
      bright += bright_before(r, bin);
    }
    ShadowCount& of = 4 * bright >= beginnings ? lit.behind_seen : lit.behind_unseen;
    of.wrong += wrong;
    of.all += own_shadow(r, lit.bins, shadow);
  }
  return lit;
}

std::optional<double> near_returns_missing_to(const Residual& r) {
  const EchoShape& shape = r.fan.shape();
  std::size_t lost = 0, rows = 0;
  for (std::size_t s = 0; s < shape.samples; ++s) {
    std::size_t should = 0, has = 0;
    for (std::size_t column = 0; column < shape.pings * shape.beams; ++column) {
      const std::size_t bin = column * shape.samples + s;
      if (!(r.predicted_j[bin] > 0.2 * r.levels_j[s])) continue;
      ++should;
      has += r.candidate_j[bin] > std::max(r.noise_j, 0.02 * r.levels_j[s]);
    }
    if (should == 0) continue;
    if (10 * has > should) {
      // Missing near returns are a cut: nearly all echoes before it are missing and most echoes after it
      // are present.
      if (rows < 3 || lost < 30 || 2 * has < should || !is_step(r, s)) return std::nullopt;
      return r.fan.range_m(s) - r.fan.sample_m() / 2;
    }
    lost += should;
    ++rows;
  }
  return std::nullopt;
}

void leave_out_missing_rows(Residual& r) {
  const auto missing_to_m = near_returns_missing_to(r);
  for (std::size_t s = 0; missing_to_m && s < r.row_counts.size(); ++s)
    if (r.fan.range_m(s) < *missing_to_m + r.fan.sample_m()) r.row_counts[s] = false;
}

EdgeOffsets shadow_sides(const Residual& r) {
  EdgeWalk walk(r);
  const EchoShape& shape = r.fan.shape();
  for (std::size_t ping = 0; ping < shape.pings && r.fan.has_width(); ++ping)
    for (std::size_t s = 0; s < shape.samples; ++s)
      walk.along(ping * shape.beams * shape.samples + s, shape.samples, shape.beams);
  return walk.result();
}

EdgeOffsets shadow_ends(const Residual& r) {
  EdgeWalk walk(r);
  const EchoShape& shape = r.fan.shape();
  for (std::size_t column = 0; column < shape.pings * shape.beams; ++column)
    walk.along(column * shape.samples, 1, shape.samples);
  return walk.result();
}

double scatter(const Residual& r) {
  constexpr std::size_t edge = 12;  // samples behind the first return, where the near edge may be displaced
  const EchoShape& shape = r.fan.shape();
  std::vector<double> sizes;
  for (std::size_t first = 0; first < r.predicted_j.size(); first += shape.samples) {
    std::size_t begin = 0;
    while (begin < shape.samples && !(r.predicted_j[first + begin] > 0.2 * r.levels_j[begin])) ++begin;
    for (std::size_t s = begin + edge; s + 2 < shape.samples; ++s) {
      if (!r.row_counts[s]) continue;
      const std::size_t bin = first + s;
      const double p = r.predicted_j[bin];
      bool even = p > 0.2 * r.levels_j[s] && p < 3 * r.levels_j[s];
      for (const std::size_t near : {bin - 2, bin - 1, bin + 1, bin + 2})
        even = even && std::abs(r.predicted_j[near] - p) < 0.15 * p;
      if (!even) continue;
      sizes.push_back(std::abs(std::min(r.candidate_j[bin] / p, 4.0) - 1));
    }
  }
  // The median is not affected by single areas with another error, such as a vertical pattern.
  return 1.4826 * median_of(std::move(sizes));
}

EvenSteps steps_of(std::span<const double> values) {
  EvenSteps steps;
  constexpr std::size_t most = 1024, least_share = 4;
  std::set<double> different;
  std::size_t lit = 0;
  double top = 0;
  for (const double v : values) {
    lit += v > 0;
    top = std::max(top, v);
    if (v > 0 && different.size() <= most) different.insert(v);
  }
  if (lit == 0) return steps;
  // Some bin has the largest value, and in a symmetric scene several have.
  constexpr std::ptrdiff_t least_at_top = 8;
  const std::ptrdiff_t at_top = std::count(values.begin(), values.end(), top);
  if (at_top >= least_at_top) steps.share_at_top = static_cast<double>(at_top) / static_cast<double>(lit);
  steps.smallest = different.size() <= most ? *different.begin() : 0;
  if (different.size() > most || different.size() * least_share > lit || different.size() < 2) return steps;
  steps.levels = different.size();
  // Steps are uniform if all values are integer multiples of the smallest difference.
  const auto even = [&](auto of) {
    double gap = INFINITY, before = NAN;
    for (const double v : different) {
      if (!std::isnan(before)) gap = std::min(gap, of(v) - before);
      before = of(v);
    }
    const double first = of(*different.begin());
    return std::all_of(different.begin(), different.end(), [&](double v) {
      const double places = (of(v) - first) / gap;
      return std::abs(places - std::round(places)) < 0.02 && places < 70000;
    });
  };
  if (even([](double v) { return v; }))
    steps.scale = "energy";
  else if (even([](double v) { return std::sqrt(v); }))
    steps.scale = "amplitude";
  else if (even([](double v) { return 10 * std::log10(v); }))
    steps.scale = "dB";
  return steps;
}

}  // namespace tubefoot
