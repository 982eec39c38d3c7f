// SPDX-License-Identifier: GPL-3.0-or-later
// Formats the trials of work-precision charts: verdicts per scene, diagrams of error over work, a CSV table
// and an HTML page.
#include "study/chart_page.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "files/csv_file.hpp"
#include "files/shown.hpp"

namespace tubefoot {
namespace {

constexpr double requested_db = 0.1, requested_l1 = 1e-3;

std::vector<Trial> filtered(std::span<const Trial> trials, bool sampling) {
  std::vector<Trial> some;
  for (const Trial& t : trials)
    if (t.counts && (t.samples > 0) == sampling) some.push_back(t);
  return some;
}

std::vector<std::string> engines_of(std::span<const Trial> trials) {
  std::vector<std::string> names;
  for (const Trial& t : trials)
    if (std::find(names.begin(), names.end(), t.engine) == names.end()) names.push_back(t.engine);
  return names;
}

std::string ratio(const std::optional<double>& value, bool extrapolated) {
  return value ? fmt::format("{:.3g}{}", *value, extrapolated ? " *" : "") : "not reached";
}

}  // namespace

std::vector<std::string> scenes_of(std::span<const Trial> trials) {
  std::vector<std::string> names;
  for (const Trial& t : trials)
    if (std::find(names.begin(), names.end(), t.scene) == names.end()) names.push_back(t.scene);
  return names;
}

std::vector<Trial> of_scene(std::span<const Trial> trials, const std::string& scene) {
  std::vector<Trial> some;
  for (const Trial& t : trials)
    if (t.scene == scene) some.push_back(t);
  return some;
}

std::string name_of(WorkMeasure work) {
  switch (work) {
    case WorkMeasure::seconds:
      return "seconds";
    case WorkMeasure::processor_seconds:
      return "processor time";
    case WorkMeasure::instructions:
      break;
  }
  return "instructions";
}

SceneVerdict verdict_of(const std::string& scene, std::span<const Trial> trials, WorkMeasure work) {
  const std::vector<Trial> all = of_scene(trials, scene), exact = filtered(all, false),
                           sampling = filtered(all, true);
  SceneVerdict verdict;
  verdict.scene = scene;
  verdict.work = work;
  const auto compare = [&](ErrorMeasure measure, double error, std::optional<double>& ratio_out,
                           bool& extrapolated) {
    const std::optional<Cost> ours = cost_of(exact, measure, error, work),
                              theirs = cost_of(sampling, measure, error, work);
    if (!ours || !theirs) return;
    ratio_out = theirs->amount / ours->amount;
    extrapolated = theirs->extrapolated;
  };
  compare(ErrorMeasure::rms_db, requested_db, verdict.ray_over_tube_at_db, verdict.db_extrapolated);
  compare(ErrorMeasure::l1, requested_l1, verdict.ray_over_tube_at_l1, verdict.l1_extrapolated);
  verdict.crossing_l1 = crossing_error(exact, sampling, ErrorMeasure::l1, work);
  return verdict;
}

Diagram work_precision_plot(const std::string& scene, std::span<const Trial> trials, ErrorMeasure measure) {
  const std::vector<Trial> all = of_scene(trials, scene);
  Diagram plot;
  const bool l1 = measure == ErrorMeasure::l1;
  plot.title = fmt::format("{}: {}", scene, l1 ? "relative L1 error" : "RMS error of bins with an echo");
  plot.x_label = "processor time per ping (s), one thread";
  plot.y_label = l1 ? "sum |E - reference| / sum reference" : "dB";
  double bound = 0;
  for (const Trial& t : all) bound = std::max(bound, t.bound);
  // A relative error e corresponds to 10 log10(1 + e) dB, about 4.34 e.
  plot.floor = l1 ? bound : bound * 4.342944819;
  plot.floor_name = "bound of the reference";
  for (const std::string& engine : engines_of(all)) {
    PlotSeries series;
    series.name = engine;
    std::vector<Trial> own;
    for (const Trial& t : all)
      if (t.engine == engine) own.push_back(t);
    std::sort(own.begin(), own.end(), [](const Trial& a, const Trial& b) {
      return a.work.processor_seconds < b.work.processor_seconds;
    });
    for (const Trial& t : own) series.points.emplace_back(t.work.processor_seconds, error_of(t, measure));
    series.joined = own.front().samples > 0;
    if (const auto order = convergence_order(own, measure, 2 * plot.floor))
      series.note = fmt::format("order {:.2f} in rays", *order);
    plot.series.push_back(std::move(series));
  }
  return plot;
}

std::string to_csv(std::span<const Trial> trials) {
  std::string csv =
      "scene,engine,setting,l1_error,rms_db_error,seconds,bound,processor_seconds,instructions\n";
  for (const Trial& t : trials)
    csv += fmt::format("{},{},{},{:.6g},{:.6g},{:.6g},{:.6g},{:.6g},{}\n", csv_text(t.scene),
                       csv_text(t.engine), csv_text(t.setting), t.l1_error, t.rms_db_error, t.work.seconds,
                       t.bound, t.work.processor_seconds,
                       t.work.instructions > 0 ? fmt::format("{:.0f}", t.work.instructions) : "");
  return csv;
}

std::string to_html(std::span<const Trial> trials, const std::string& about) {
  std::string html = fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<title>tubefoot: accuracy against speed</title>\n<style>\n"
      "body {{ font-family: sans-serif; margin: 2em auto; max-width: 1600px; padding: 0 1em; }}\n"
      "table {{ border-collapse: collapse; }}\n"
      "td, th {{ padding: 0.2em 0.8em; border-bottom: 1px solid #ddd; text-align: right; }}\n"
      "td:first-child, th:first-child, .left {{ text-align: left; }}\n"
      ".pair {{ display: flex; flex-wrap: wrap; gap: 1em; }}\n"
      "</style>\n</head>\n<body>\n<h1>Accuracy against speed</h1>\n<p>{}</p>\n",
      about);
  html += fmt::format(
      "<h2>Summary</h2>\n<table>\n<tr><th>scene</th><th class=\"left\">measured in</th><th>rays / tubes at "
      "{} dB RMS</th><th>rays / tubes at {} L1</th><th>rays cheaper above L1 of</th></tr>\n",
      requested_db, requested_l1);
  const WorkMeasure steadiest = steadiest_measure(trials);
  for (const std::string& scene : scenes_of(trials))
    for (const WorkMeasure work : {WorkMeasure::seconds, steadiest}) {
      const SceneVerdict v = verdict_of(scene, trials, work);
      html += fmt::format(
          "<tr><td>{}</td><td class=\"left\">{}</td><td>{}</td><td>{}</td><td>{:.2g} %</td></tr>\n",
          shown_markup(scene), name_of(work), ratio(v.ray_over_tube_at_db, v.db_extrapolated),
          ratio(v.ray_over_tube_at_l1, v.l1_extrapolated), 100 * v.crossing_l1);
    }
  html += fmt::format(
      "</table>\n<p>The ratios compare the cheapest ray setting with the cheapest tube setting that reach "
      "the error, by the clock and in {}. The second measure depends less on the load of the machine. * : no "
      "tested number of rays reaches the error, so the value is extrapolated along the fitted order.</p>\n",
      name_of(steadiest));
  for (const std::string& scene : scenes_of(trials))
    html += fmt::format("<h2>{}</h2>\n<div class=\"pair\">\n{}{}</div>\n", shown_markup(scene),
                        to_svg(work_precision_plot(scene, trials, ErrorMeasure::l1)),
                        to_svg(work_precision_plot(scene, trials, ErrorMeasure::rms_db)));
  html +=
      "<h2>All runs</h2>\n<table>\n<tr><th>scene</th><th class=\"left\">engine</th><th "
      "class=\"left\">setting</th><th>L1 error</th><th>RMS error, dB</th><th>seconds per "
      "ping</th><th>processor seconds</th><th>instructions</th><th>bound of the reference</th></tr>\n";
  for (const Trial& t : trials)
    html += fmt::format(
        "<tr><td>{}</td><td class=\"left\">{}</td><td class=\"left\">{}</td><td>{:.3g}</td><td>{:.3g}</td>"
        "<td>{:.3g}</td><td>{:.3g}</td><td>{}</td><td>{:.2g}</td></tr>\n",
        shown_markup(t.scene), shown_markup(t.engine), shown_markup(t.setting), t.l1_error, t.rms_db_error,
        t.work.seconds, t.work.processor_seconds,
        t.work.instructions > 0 ? fmt::format("{:.3g}", t.work.instructions) : "not counted", t.bound);
  return html + "</table>\n</body>\n</html>\n";
}

}  // namespace tubefoot
