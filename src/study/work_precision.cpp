// SPDX-License-Identifier: GPL-3.0-or-later
// Work-precision analysis: errors of trials, and orders of convergence by least squares in logarithms.
// It interpolates or extrapolates the work that an error requires on the trials of each engine.
#include "study/work_precision.hpp"

#include <algorithm>
#include <cmath>
#include <map>

namespace tubefoot {
namespace {

struct Point {
  double samples, work, error;
};

/// Least-squares line through points (x, y); none if all x are equal.
struct Line {
  double slope, intercept;
};
std::optional<Line> fit(const std::vector<std::pair<double, double>>& points) {
  double x = 0, y = 0, xx = 0, xy = 0;
  const double n = static_cast<double>(points.size());
  for (const auto& [px, py] : points) {
    x += px / n;
    y += py / n;
  }
  for (const auto& [px, py] : points) {
    xx += (px - x) * (px - x);
    xy += (px - x) * (py - y);
  }
  if (!(xx > 0)) return std::nullopt;
  return Line{xy / xx, y - xy / xx * x};
}

/// Returns the sampling trials of each engine, ordered by number of samples.
std::map<std::string, std::vector<Point>> ladders(std::span<const Trial> trials, ErrorMeasure measure,
                                                  WorkMeasure work) {
  std::map<std::string, std::vector<Point>> all;
  for (const Trial& t : trials)
    if (t.samples > 0) all[t.engine].push_back({t.samples, amount_of(t.work, work), error_of(t, measure)});
  for (auto& [engine, points] : all)
    std::sort(points.begin(), points.end(),
              [](const Point& a, const Point& b) { return a.samples < b.samples; });
  return all;
}

/// Returns the work that one engine needs for an error.
std::optional<Cost> cost_on(const std::vector<Point>& ladder, double error) {
  // A coarse setting may have a small error by chance. It counts only if all finer settings are as good.
  std::size_t first = ladder.size();
  while (first > 0 && ladder[first - 1].error <= error) --first;
  if (first < ladder.size()) {
    const Point& good = ladder[first];
    if (first == 0 || !(good.error > 0)) return Cost{good.work, false};
    const Point& bad = ladder[first - 1];
    const double part = std::log(bad.error / error) / std::log(bad.error / good.error);
    return Cost{bad.work * std::pow(good.work / bad.work, part), false};
  }
  std::vector<std::pair<double, double>> tail;  // the finer half; coarse settings have not converged yet
  for (std::size_t k = ladder.size() / 2; k < ladder.size(); ++k)
    if (ladder[k].error > 0 && ladder[k].work > 0)
      tail.emplace_back(std::log(ladder[k].samples), std::log(ladder[k].error));
  if (tail.size() < 2) return std::nullopt;
  const std::optional<Line> line = fit(tail);
  if (!line || !(line->slope < -0.1)) return std::nullopt;
  const Point& best = ladder.back();
  // Work is proportional to the number of samples for fine settings.
  return Cost{best.work * std::pow(error / best.error, 1 / line->slope), true};
}

}  // namespace

double amount_of(const PingWork& work, WorkMeasure measure) {
  switch (measure) {
    case WorkMeasure::seconds:
      return work.seconds;
    case WorkMeasure::processor_seconds:
      return work.processor_seconds;
    case WorkMeasure::instructions:
      break;
  }
  return work.instructions;
}

WorkMeasure steadiest_measure(std::span<const Trial> trials) {
  return std::all_of(trials.begin(), trials.end(), [](const Trial& t) { return t.work.instructions > 0; })
             ? WorkMeasure::instructions
             : WorkMeasure::processor_seconds;
}

double error_of(const Trial& trial, ErrorMeasure measure) {
  return measure == ErrorMeasure::l1 ? trial.l1_error : trial.rms_db_error;
}

double error_of(std::span<const PingError> pings, ErrorMeasure measure) {
  double part = 0, whole = 0;
  for (const PingError& p : pings) {
    part += measure == ErrorMeasure::l1 ? p.difference_j : p.squared_db;
    whole += measure == ErrorMeasure::l1 ? p.reference_j : p.lit_bins;
  }
  if (!(part > 0)) return 0;
  return measure == ErrorMeasure::l1 ? part / whole
                                     : std::sqrt(part / whole);  // infinite if all energies are 0
}

std::optional<double> convergence_order(std::span<const Trial> trials, ErrorMeasure measure, double floor) {
  std::vector<std::pair<double, double>> points;
  const double ceiling = measure == ErrorMeasure::l1 ? unconverged_l1 : unconverged_db;
  for (const Trial& t : trials)
    if (const double error = error_of(t, measure);
        t.samples > 0 && error > floor && error > 0 && error < ceiling)
      points.emplace_back(std::log(t.samples), std::log(error));
  if (points.size() < 3) return std::nullopt;
  const std::optional<Line> line = fit(points);
  if (!line) return std::nullopt;
  return line->slope;
}

std::optional<double> samples_for(std::span<const Trial> ladder, ErrorMeasure measure, double error) {
  constexpr std::size_t tail = 3;
  std::vector<std::pair<double, double>> points;
  for (const Trial& t : ladder.last(std::min(tail, ladder.size())))
    if (const double e = error_of(t, measure); t.samples > 0 && e > 0 && std::isfinite(e))
      points.emplace_back(std::log(t.samples), std::log(e));
  if (points.size() < 2) return std::nullopt;
  const std::optional<Line> line = fit(points);
  // A slower decrease does not justify more samples.
  constexpr double flattest = -0.1;
  if (!line || !(line->slope < flattest)) return std::nullopt;
  return std::exp((std::log(error) - line->intercept) / line->slope);
}

std::optional<Cost> cost_of(std::span<const Trial> trials, ErrorMeasure measure, double error,
                            WorkMeasure work) {
  std::optional<Cost> least;
  const auto offer = [&](const std::optional<Cost>& cost) {
    if (cost && (!least || cost->amount < least->amount)) least = cost;
  };
  for (const Trial& t : trials)
    if (!(t.samples > 0) && error_of(t, measure) <= error) offer(Cost{amount_of(t.work, work), false});
  for (const auto& [engine, ladder] : ladders(trials, measure, work)) offer(cost_on(ladder, error));
  return least;
}

double crossing_error(std::span<const Trial> exact, std::span<const Trial> sampling, ErrorMeasure measure,
                      WorkMeasure work) {
  constexpr int steps_per_decade = 50, decades = 6;
  for (int k = 0; k <= steps_per_decade * decades; ++k) {
    const double error = std::pow(10.0, -static_cast<double>(k) / steps_per_decade);
    const std::optional<Cost> ours = cost_of(exact, measure, error, work),
                              theirs = cost_of(sampling, measure, error, work);
    if (ours && (!theirs || ours->amount <= theirs->amount)) return error;
  }
  return 0;
}

}  // namespace tubefoot
