// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <charconv>
#include <chrono>
#include <nlohmann/json.hpp>

#include "app/advice.hpp"
#include "app/commands.hpp"
#include "app/interrupt.hpp"
#include "app/output_folder.hpp"
#include "app/partial_run.hpp"
#include "app/refraction.hpp"
#include "app/run_statistics.hpp"
#include "app/settings.hpp"
#include "app/simulation.hpp"
#include "app/survey.hpp"
#include "app/usage_error.hpp"
#include "scene/utc.hpp"
#include "sensors/products.hpp"
#include "study/ping_spread.hpp"

namespace tubefoot {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

/// `refined`: shots had ground of their own, no finer than its tolerance asks.
void print_reference(double tolerance, const ReferenceStats& reference, bool refined) {
  if (reference.bins_over == 0)
    fmt::print("reference: every energy within {:g} of its bin, certified{}\n", tolerance,
               refined ? ", for the facets that relief was refined into" : "");
  else if (reference.worst_ratio <= 1)  // of the bounds that are finite
    fmt::print("reference: {} bins have no bound; every other energy within {:g} of its bin, certified\n",
               reference.bins_over, tolerance);
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

Advice pick_settings(SceneDescription& description, const Tolerance& tolerance, bool quiet) {
  AdviceOptions options;
  options.measure = false;   // all of its time is the user's waiting
  options.largest_cost = 1;  // dearer rays would not be chosen
  options.seed = description.run.seed;
  options.quiet = quiet;
  Advice advice = advise(description, tolerance, options);
  RunDescription& run = description.run;
  const RunDescription& chosen = advice.best().setting.run;
  // What the scene's own [run] says of seed, grid and threads stays.
  run.engine = chosen.engine;
  run.arithmetic = chosen.arithmetic;
  run.binning = chosen.binning;
  run.facets_per_split = chosen.facets_per_split;
  run.zero_tolerance = chosen.zero_tolerance;
  run.sampling = chosen.sampling;
  run.rays_per_beam = chosen.rays_per_beam;
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
      {"error_text", error_text(advice.tolerance.measure, best.predicted_error)},
      {"seconds_of_advice", seconds}};
  for (const LookedAt& s : advice.sensors) json["probe_pings"][s.sensor] = s.probes;
  return json;
}

void print_tolerance(const nlohmann::ordered_json& advice) {
  fmt::print("tolerance {}: {}, {}; left out: {}; error about {} (measured on probe pings, not certified)\n",
             advice.at("asked").get<std::string>(), advice.at("engine").get<std::string>(),
             advice.at("setting").get<std::string>(), advice.at("left_out").get<std::string>(),
             advice.at("error_text").get<std::string>());
}

void print_relief(const Survey& survey, const SimulationStats& stats) {
  if (survey.ground)
    fmt::print("relief: {} facets made for {} pings; {} in cells of {:g} m over all of it\n",
               stats.refined_facets, stats.pings, survey.relief.uniform_facets, survey.relief.cell_m);
  else
    fmt::print("relief: {} facets, made once, in cells of {:g} m\n", survey.scene.mesh.facets.size(),
               survey.relief.cell_m);
  fmt::print(
      "finer relief would change a facet's energy by {:.2g} times itself (RMS), by {:.2g} times at most "
      "(first-order estimates for the worst ping, not certified)\n",
      stats.finer_relief_rms, stats.finer_relief_largest);
}

/// Everything that a result folder holds but stats.json.
std::vector<std::filesystem::path> write_files(const std::filesystem::path& folder,
                                               const std::vector<Recording>& recordings,
                                               const Provenance& provenance, const RunContext& run,
                                               std::vector<std::string>& warnings) {
  write_echoes(folder / "echoes.nc", recordings, provenance);
  std::vector<std::filesystem::path> files{"echoes.nc"};
  for (const Recording& recording : recordings) {
    if (InterruptGuard::requested()) break;
    for (const auto& file : write_products(folder, recording, run, warnings)) files.push_back(file);
  }
  return files;
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
    // One dial: the ground is refined no further, and no less, unless the scene says how far.
    if (!description.refinement.tolerance) description.refinement.tolerance = relative_error(*tolerance);
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
  PartialRun partial(options.output, options.resume);
  const nlohmann::ordered_json asked{{"version", TUBEFOOT_VERSION},
                                     {"scene_hash", description.sha256},
                                     {"run", json_of(description.run)},
                                     {"reference", reference_tolerance ? *reference_tolerance : 0.0},
                                     {"tolerance", tolerance ? to_text(*tolerance) : ""}};
  nlohmann::ordered_json identity{{"asked", asked}};
  if (partial.kept()) {
    identity = *partial.kept();
    refuse_other_request(identity.at("asked"), asked);
    description.run = run_of(identity.at("run"), description.run);
  } else {
    if (tolerance) {
      const Clock::time_point advice_start = Clock::now();
      const Advice advice = pick_settings(description, *tolerance, options.quiet);
      identity["advice"] = json_of(advice, seconds_since(advice_start));
    }
    identity["run"] = json_of(description.run);
  }
  const ThreadLimit limit(description.run.threads);
  const auto survey = open_survey(description);
  const Scene& scene = survey->scene;
  std::vector<std::string> warnings = scene.report.warnings;
  print_warnings(warnings, options.quiet);

  const Clock::time_point simulation_start = Clock::now();
  const std::shared_ptr<PingStore> store =
      partial.open(layout_of(*survey, reference_tolerance.has_value()), identity);
  const std::size_t kept_pings = store->done_units();
  if (kept_pings > 0 && !options.quiet) fmt::print(stderr, "going on after {} finished pings\n", kept_pings);
  const auto stop_if_asked = [&partial] {
    if (InterruptGuard::requested()) throw std::runtime_error("interrupted: " + partial.advice());
  };
  simulate(*survey, *store, options.quiet, reference_tolerance);
  stop_if_asked();
  const SimulationStats stats = totals(*survey, *store);
  const std::vector<Recording> recordings = recordings_of(*survey, store);
  const std::vector<std::string> refraction = refraction_warnings(*survey, stats);
  print_warnings(refraction, options.quiet);
  warnings.insert(warnings.end(), refraction.begin(), refraction.end());
  const double simulation_seconds = seconds_since(simulation_start);

  const RunDescription& run = description.run;
  const bool exact = run.engine == "tube";
  std::vector<std::filesystem::path> files;
  try {
    const Clock::time_point write_start = Clock::now();
    std::vector<std::string> file_warnings;
    files = write_files(
        output.staging(), recordings,
        {description.title, description.sha256, run.engine, exact ? run.arithmetic : "float",
         TUBEFOOT_VERSION, reference_tolerance},
        {scene.frame, *unix_time_s(run.start_utc), run.seed, description.water, description.title},
        file_warnings);
    print_warnings(file_warnings, options.quiet);
    warnings.insert(warnings.end(), file_warnings.begin(), file_warnings.end());
    nlohmann::ordered_json json = statistics_json(*survey, stats, reference_tolerance);
    if (identity.contains("advice")) json["tolerance"] = identity.at("advice");
    json["threads"] = limit.threads();
    if (kept_pings > 0) json["pings_kept_from_before"] = kept_pings;
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
    stop_if_asked();
    output.commit();
  } catch (const std::runtime_error& error) {
    if (InterruptGuard::requested()) throw;
    throw std::runtime_error(fmt::format("{}; {}", error.what(), partial.advice()));
  }
  partial.remove();

  if (!options.quiet)
    fmt::print("{} pings, {} tubes, {} {} in {:.1f} s\n", stats.pings, stats.tubes,
               exact ? stats.footprints : stats.hits, exact ? "footprints" : "ray hits",
               seconds_since(start));
  if (!options.quiet && survey->relief.cell_m > 0) print_relief(*survey, stats);
  if (reference_tolerance) print_reference(*reference_tolerance, stats.reference, survey->ground != nullptr);
  if (identity.contains("advice")) print_tolerance(identity.at("advice"));
  const std::filesystem::path folder = options.output;
  files.emplace_back("stats.json");
  for (const auto& file : files) fmt::print("wrote {}\n", (folder / file).string());
  return 0;
}

}  // namespace tubefoot
