// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>
#include <sys/resource.h>

#include <charconv>
#include <chrono>
#include <nlohmann/json.hpp>

#include "app/advice.hpp"
#include "app/commands.hpp"
#include "app/interrupt.hpp"
#include "app/output_folder.hpp"
#include "app/settings.hpp"
#include "app/simulation.hpp"
#include "app/survey.hpp"
#include "app/usage_error.hpp"
#include "study/ping_spread.hpp"

namespace tubefoot {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

double peak_memory_mb() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024;  // Linux counts kibibytes
}

void print_reference(double tolerance, const ReferenceStats& reference) {
  if (reference.bins_over == 0)
    fmt::print("reference: every energy within {:g} of its bin, certified\n", tolerance);
  else
    fmt::print(
        "reference: {} bins have wider bounds than {:g}; the widest is {:.3g} times what was asked, at "
        "sensor "
        "'{}', ping {}, beam {}, sample {}\n",
        reference.bins_over, tolerance, reference.worst_ratio, reference.worst_sensor, reference.worst_ping,
        reference.worst_beam, reference.worst_sample);
}

double bound_asked_for(const std::optional<std::string>& text) {
  double bound = 1e-9;
  if (!text) return bound;
  const auto [end, error] = std::from_chars(text->data(), text->data() + text->size(), bound);
  // Not a number fails both comparisons.
  if (error != std::errc() || end != text->data() + text->size() || !(bound >= 1e-12 && bound <= 0.1))
    throw UsageError(
        fmt::format("--tolerance of a --reference is a relative bound, 1e-12 to 0.1, not '{}'", *text));
  return bound;
}

void refuse_what_the_tolerance_picks(const RunOptions& options) {
  const char* option = options.engine          ? "--engine"
                       : options.arithmetic    ? "--arithmetic"
                       : options.binning       ? "--binning"
                       : options.sampling      ? "--sampling"
                       : options.rays          ? "--rays"
                       : options.rays_per_beam ? "--rays-per-beam"
                                               : nullptr;
  if (option != nullptr)
    throw UsageError(
        fmt::format("--tolerance picks engine and settings itself: leave out {}, or --tolerance", option));
}

/// The chosen settings; what the scene's own [run] says of seed, grid and threads stays.
void take_over(RunDescription& run, const RunDescription& chosen) {
  run.engine = chosen.engine;
  run.arithmetic = chosen.arithmetic;
  run.binning = chosen.binning;
  run.facets_per_split = chosen.facets_per_split;
  run.zero_tolerance = chosen.zero_tolerance;
  run.sampling = chosen.sampling;
  run.rays_per_beam = chosen.rays_per_beam;
}

Advice pick_settings(SceneDescription& description, const Tolerance& tolerance, bool quiet) {
  AdviceOptions options;
  options.measure = false;   // all of its time is the user's waiting
  options.largest_cost = 1;  // dearer rays would not be chosen
  options.seed = description.run.seed;
  options.quiet = quiet;
  Advice advice = advise(description, tolerance, options);
  take_over(description.run, advice.best().setting.run);
  if (!quiet)
    fmt::print("for {}: {}, {}\n", to_text(tolerance), advice.best().setting.engine,
               advice.best().setting.setting);
  return advice;
}

nlohmann::ordered_json json_of(const Advice& advice, double seconds) {
  const Candidate& best = advice.best();
  nlohmann::ordered_json json{
      {"asked", to_text(advice.tolerance)},
      {"measure", advice.tolerance.measure == ErrorMeasure::l1 ? "l1_error" : "rms_db_error"},
      {"value", advice.tolerance.value},
      {"engine", best.setting.engine},
      {"setting", best.setting.setting},
      {"options", options_of(best.setting.run)},
      {"error_on_probe_pings", best.probe_error},
      {"seconds_a_probe_ping", best.predicted_seconds},
      {"left_out", left_out_by(best.setting.run)},
      {"estimated_error", best.predicted_error},
      {"estimate",
       fmt::format("measured, not certified: {:g} % confidence limit from the spread of the probe "
                   "pings, against exact cuts",
                   100 * error_limit_confidence)},
      {"seconds_of_advice", seconds}};
  for (const LookedAt& s : advice.sensors) json["probe_pings"][s.sensor] = s.probes;
  return json;
}

void print_tolerance(const Advice& advice) {
  const Candidate& best = advice.best();
  fmt::print("tolerance {}: {}, {}; left out: {}; error about {} (measured on probe pings, not certified)\n",
             to_text(advice.tolerance), best.setting.engine, best.setting.setting,
             left_out_by(best.setting.run), error_text(advice.tolerance.measure, best.predicted_error));
}

}  // namespace

int run_command(const RunOptions& options) {
  const Clock::time_point start = Clock::now();
  SceneDescription description = described(options);
  if (options.engine) description.run.engine = *options.engine;
  if (options.binning) description.run.binning = *options.binning;
  if (options.sampling) description.run.sampling = *options.sampling;
  if (options.rays) {
    description.run.rays_per_ping = *options.rays;
    description.run.rays_per_beam.reset();
  }
  if (options.rays_per_beam) description.run.rays_per_beam = *options.rays_per_beam;
  if (options.seed) description.run.seed = *options.seed;
  std::optional<double> reference_tolerance;
  std::optional<Tolerance> tolerance;
  if (options.tolerance && !options.reference) {
    refuse_what_the_tolerance_picks(options);
    tolerance = asked_tolerance(*options.tolerance);
  }
  if (options.reference) {
    reference_tolerance = bound_asked_for(options.tolerance);
    if (description.run.engine != "tube")
      throw UsageError("--reference measures footprints: it needs --engine tube");
    if (description.run.binning != "exact")
      throw UsageError("--reference integrates footprints: it needs --binning exact");
    if (description.run.arithmetic == "double")
      throw UsageError("--reference needs an exact arithmetic: fixed, filtered or rational, not double");
  }
  const InterruptGuard interrupt;
  OutputFolder output(options.output);
  std::optional<Advice> advice;
  double advice_seconds = 0;
  if (tolerance) {
    const Clock::time_point advice_start = Clock::now();
    advice = pick_settings(description, *tolerance, options.quiet);
    advice_seconds = seconds_since(advice_start);
  }
  const ThreadLimit limit(description.run.threads);
  const auto survey = open_survey(description);
  const Scene& scene = survey->scene;
  std::vector<std::string> warnings = scene.report.warnings;
  print_warnings(warnings, options.quiet);

  SimulationStats stats;
  const Clock::time_point simulation_start = Clock::now();
  const std::vector<Recording> recordings = simulate(*survey, options.quiet, stats, reference_tolerance);
  const double simulation_seconds = seconds_since(simulation_start);

  const Clock::time_point write_start = Clock::now();
  const RunDescription& run = description.run;
  const bool exact = run.engine == "tube";
  write_echoes(output.staging() / "echoes.nc", recordings,
               {description.title, description.sha256, run.engine, exact ? run.arithmetic : "float",
                TUBEFOOT_VERSION, reference_tolerance});
  std::vector<std::filesystem::path> pictures;
  std::vector<std::string> picture_warnings;
  for (const Recording& recording : recordings)
    for (const auto& file : write_pictures(output.staging(), recording, &picture_warnings))
      pictures.push_back(file);
  print_warnings(picture_warnings, options.quiet);
  warnings.insert(warnings.end(), picture_warnings.begin(), picture_warnings.end());

  nlohmann::ordered_json json;
  json["scene"] = description.file.string();
  json["scene_hash"] = description.sha256;
  json["version"] = TUBEFOOT_VERSION;
  json["engine"] = run.engine;
  if (exact) {
    json["arithmetic"] = run.arithmetic;
    json["binning"] = run.binning;
  } else {
    json["sampling"] = run.sampling;
    if (run.rays_per_beam)
      json["rays_per_beam"] = *run.rays_per_beam;
    else
      json["rays_per_ping"] = run.rays_per_ping;
    json["seed"] = run.seed;
  }
  if (reference_tolerance) {
    const ReferenceStats& reference = stats.reference;
    json["reference"] = {{"tolerance", *reference_tolerance},
                         {"bins_over_tolerance", reference.bins_over},
                         {"worst_bound_over_asked", reference.worst_ratio},
                         {"worst_sensor", reference.worst_sensor},
                         {"worst_ping", reference.worst_ping},
                         {"worst_beam", reference.worst_beam},
                         {"worst_sample", reference.worst_sample}};
  }
  if (advice) json["tolerance"] = json_of(*advice, advice_seconds);
  json["threads"] = limit.threads();
  json["grid_unit_m"] = scene.grid.unit_m();
  json["facets"] = scene.mesh.facets.size();
  json["pings"] = stats.pings;
  json["tubes"] = stats.tubes;
  json["candidates"] = stats.candidates;
  json["footprints"] = stats.footprints;
  json["pieces"] = stats.pieces;
  json["ray_hits"] = stats.hits;
  json["seconds"] = {{"load", survey->load_seconds},
                     {"tree", survey->tree_seconds},
                     {"simulation", simulation_seconds},
                     {"visibility_of_all_pings", stats.visibility_seconds},
                     {"echo_of_all_pings", stats.echo_seconds},
                     {"write", seconds_since(write_start)},
                     {"total", seconds_since(start)}};
  json["peak_memory_mb"] = peak_memory_mb();
  json["warnings"] = warnings;
  write_file(output.staging() / "stats.json", json.dump(2) + "\n");
  if (InterruptGuard::requested()) throw std::runtime_error("interrupted: nothing was written");
  output.commit();

  if (!options.quiet)
    fmt::print("{} pings, {} tubes, {} {} in {:.1f} s\n", stats.pings, stats.tubes,
               exact ? stats.footprints : stats.hits, exact ? "footprints" : "ray hits",
               seconds_since(start));
  if (reference_tolerance) print_reference(*reference_tolerance, stats.reference);
  if (advice) print_tolerance(*advice);
  const std::filesystem::path folder = options.output;
  fmt::print("wrote {}\n", (folder / "echoes.nc").string());
  for (const auto& picture : pictures) fmt::print("wrote {}\n", (folder / picture).string());
  fmt::print("wrote {}\n", (folder / "stats.json").string());
  return 0;
}

}  // namespace tubefoot
