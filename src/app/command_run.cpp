// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <nlohmann/json.hpp>

#include "advice/advice.hpp"
#include "app/commands.hpp"
#include "files/checked_file.hpp"
#include "files/json_text.hpp"
#include "files/outlet.hpp"
#include "files/usage_error.hpp"
#include "geometry/steps/stop.hpp"
#include "plan/scene_drawing.hpp"
#include "run/console/amounts.hpp"
#include "run/console/say.hpp"
#include "run/console/written.hpp"
#include "run/partial_run.hpp"
#include "run/ranks/run_ranks.hpp"
#include "run/run_statistics.hpp"
#include "run/run_steps.hpp"
#include "run/run_warnings.hpp"
#include "run/settings.hpp"
#include "run/simulation.hpp"
#include "run/survey.hpp"
#include "run/truth.hpp"
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
    tell("reference: every energy within {:g} of its bin, certified{}\n", tolerance,
         refined ? ", for the facets that relief was refined into" : "");
  else if (reference.worst_ratio == 0)  // no bound is finite
    tell("reference: {} bins have no bound, and every other energy is 0, certified\n", reference.bins_over);
  else if (reference.worst_ratio <= 1)  // of the bounds that are finite
    tell("reference: {} bins have no bound; every other energy within {:g} of its bin, certified\n",
         reference.bins_over, tolerance);
  else
    tell(
        "reference: {} bins have wider bounds than {:g}; the widest is {:.3g} times what was asked, at "
        "sensor "
        "'{}', ping {}, beam {}, sample {}\n",
        reference.bins_over, tolerance, reference.worst_ratio, reference.worst_sensor, reference.worst_ping,
        reference.worst_beam, reference.worst_sample);
}

nlohmann::ordered_json json_of(const Advice& advice, double seconds) {
  const Candidate& best = advice.best();
  nlohmann::ordered_json json{
      {"asked", to_text(advice.tolerance)},
      {"measure", advice.tolerance.measure == ErrorMeasure::l1 ? "l1_error" : "rms_db_error"},
      {"value", advice.tolerance.value},
      {"engine", best.setting.engine},
      {"setting", best.setting.setting},
      {"options", command_options(best.setting.run)},
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
  tell("tolerance {}: {}, {}; left out: {}; error about {} (measured on probe pings, not certified)\n",
       advice.at("asked").get<std::string>(), advice.at("engine").get<std::string>(),
       advice.at("setting").get<std::string>(), advice.at("left_out").get<std::string>(),
       advice.at("error_text").get<std::string>());
}

void print_relief(const Site& site, const SimulationStats& stats) {
  if (site.refines_tiles())
    tell("relief: tiles refined once for each region of pings, in cells of {:g} m\n", site.relief.cell_m);
  else if (site.is_tiled())
    tell("relief: {} facets made for {} pings\n", stats.refined_facets, stats.pings);
  else if (site.ground)
    tell("relief: {} facets made for {} pings; {} in cells of {:g} m over all of it\n", stats.refined_facets,
         stats.pings, site.relief.uniform_facets, site.relief.cell_m);
  else
    tell("relief: {} facets, made once, in cells of {:g} m\n", site.scene.mesh.facets.size(),
         site.relief.cell_m);
  tell(
      "finer relief would change a facet's energy by {:.2g} times itself (RMS), by {:.2g} times at most "
      "(first-order estimates for the worst ping, not certified)\n",
      stats.finer_relief_rms, stats.finer_relief_largest);
}

/// What the steps of a run hand on to each other.
struct RunUnderWay {
  explicit RunUnderWay(const RunOptions& asked) : options(asked) {}

  const RunOptions& options;
  RunRequest request;
  nlohmann::ordered_json identity;  ///< for who goes on with it or shares it
  const Clock::time_point start = Clock::now();
  SimulationStats stats;
  std::size_t kept_pings = 0;  ///< of a run before, that this one goes on with
  int threads = 0;
  std::optional<int> ranks;
  double simulation_seconds = 0, write_seconds = 0;
  std::vector<TruthRecording> truths;  ///< if asked for
  RunWarnings warnings{
      [this](const std::string& warning, bool) { print_warnings({warning}, options.quiet); }};
};

/// Settings as the run that is gone on with had them, as the scene says, or as a tolerance picks them.
void settle(RunUnderWay& run, const SceneDescription& description, const PartialRun& partial) {
  const nlohmann::ordered_json asked = asked_of(description, run.request);
  if (partial.kept()) {
    run.identity = *partial.kept();
    run.request = resumed(run.identity, asked, std::move(run.request));
    return;
  }
  run.identity = {{"asked", asked}};
  if (run.request.tolerance) {
    const Clock::time_point start = Clock::now();
    const Advice advice = pick_settings(description, run.request, run.options.quiet);
    run.identity["advice"] = json_of(advice, seconds_since(start));
  }
  run.identity["run"] = json_of(run.request);
}

/// Says what writing will take where that is much, and that the disk is too small.
void foresee_writing(RunUnderWay& run, const Survey& survey) {
  const PictureSettings& pictures = run.options.pictures;
  if (pictures.animated && pictures.which == PictureSettings::Which::none)
    throw UsageError("--animate asks for pictures, and --pictures none for none: leave out one of them");
  const WritingCost cost = expected_writing(survey, run.request, pictures);
  double kept = 0;
  for (const StoreLayout::Sensor& sensor : layout_of(survey, run.request).sensors)
    kept += 8.0 * static_cast<double>(sensor.pings) * static_cast<double>(sensor.cells);
  if (run.request.reference_tolerance) kept *= 2;
  constexpr double long_s = 10, large_bytes = 1e9;
  const double seconds = cost.seconds_on(run.threads);
  if (!run.options.quiet && (seconds > long_s || kept + cost.bytes > large_bytes))
    say("writing will take about {}, and the disk {} for energies while it runs and at most about {} for the "
        "result\n",
        duration_text(seconds), size_text(kept), size_text(cost.bytes));
  std::error_code unknown;
  const std::filesystem::space_info disk = std::filesystem::space(
      std::filesystem::absolute(run.options.output).lexically_normal().parent_path(), unknown);
  if (unknown || static_cast<double>(disk.available) >= cost.bytes + kept) return;
  run.warnings.add(
      {fmt::format("the disk of '{}' has {}, and the run may need {}: ask for fewer pings "
                   "(--pings, --sensor), or --pictures none",
                   run.options.output.string(), size_text(static_cast<double>(disk.available)),
                   size_text(cost.bytes + kept))});
}

std::vector<Recording> simulate_all(RunUnderWay& run, const Survey& survey, PartialRun& partial,
                                    std::optional<LeadRank>& lead) {
  const Clock::time_point start = Clock::now();
  const bool quiet = run.options.quiet;
  const std::shared_ptr<PingStore> store = partial.open(layout_of(survey, run.request), run.identity);
  run.kept_pings = store->done_units();
  if (run.kept_pings > 0 && !quiet) say("going on after {} finished pings\n", run.kept_pings);
  partial.keep_through([&] {
    if (lead)
      lead->simulate(survey, run.request, *store, quiet, run.threads);
    else
      simulate(survey, run.request, *store, {quiet});
    stop_if_wanted();
  });
  run.stats = totals(survey, *store, run.request.selection);
  std::vector<Recording> recordings = recordings_of(survey, store, run.request.selection);
  run.truths = truths_of(survey, run.request, store);
  run.warnings.look_back(survey, run.request, run.stats, recordings);
  run.simulation_seconds = seconds_since(start);
  return recordings;
}

/// For stats.json.
nlohmann::ordered_json whole_statistics(const RunUnderWay& run, const Survey& survey, double write_seconds) {
  nlohmann::ordered_json json = statistics_json(survey, run.request, run.stats);
  if (run.identity.contains("advice")) json["tolerance"] = run.identity.at("advice");
  json["threads"] = run.threads;
  if (run.ranks) json["ranks"] = *run.ranks;
  if (run.kept_pings > 0) json["pings_kept_from_before"] = run.kept_pings;
  json["seconds"] = {{"load", survey.site->load_seconds},
                     {"tree", survey.site->tree_seconds},
                     {"simulation", run.simulation_seconds},
                     {"visibility_of_all_pings", run.stats.visibility_seconds},
                     {"echo_of_all_pings", run.stats.echo_seconds},
                     {"write", write_seconds},
                     {"total", seconds_since(run.start)}};
  json["peak_memory_mb"] = peak_memory_mb();
  json["warnings"] = run.warnings.all();
  return json;
}

/// Names of all files written. `foreseen`: warnings that were given before.
std::vector<std::filesystem::path> write_all(RunUnderWay& run, const Survey& survey,
                                             const std::vector<Recording>& recordings,
                                             const std::vector<std::string>& foreseen, OutputFolder& output) {
  const Clock::time_point start = Clock::now();
  std::vector<std::string> warnings;
  std::vector<std::filesystem::path> files =
      write_result_files(output.staging(), survey, run.request, recordings, warnings,
                         {run.options.pictures, run.options.quiet}, run.truths);
  if (run.options.pictures.which != PictureSettings::Which::none) {
    write_scene_picture(output.staging() / scene_picture_name, survey);
    files.emplace_back(scene_picture_name);
  }
  for (const std::string& warning : warnings)
    if (std::ranges::find(foreseen, warning) != foreseen.end())
      run.warnings.keep({warning});
    else
      run.warnings.add({warning});
  write_file(output.staging() / "stats.json",
             text_of(whole_statistics(run, survey, seconds_since(start))) + "\n");
  stop_if_wanted();
  refuse_changed_input(survey.scene.description);
  output.commit();
  run.write_seconds = seconds_since(start);
  files.emplace_back("stats.json");
  return files;
}

/// Pings a second, where this run made all of them.
std::string pace(const RunUnderWay& run) {
  return run.kept_pings == 0 && run.simulation_seconds > 0
             ? fmt::format(" ({:.3g} pings a second)",
                           static_cast<double>(run.stats.pings) / run.simulation_seconds)
             : std::string();
}

void tell_all(const RunUnderWay& run, const Site& site) {
  const SimulationStats& stats = run.stats;
  const bool exact = run.request.engine == Engine::tube;
  if (!run.options.quiet)
    tell("{} pings, {} tubes, {} {} in {:.1f} s\nsimulation {:.1f} s{}, writing {:.1f} s\n", stats.pings,
         stats.tubes, exact ? stats.footprints : stats.hits, exact ? "footprints" : "ray hits",
         seconds_since(run.start), run.simulation_seconds, pace(run), run.write_seconds);
  if (!run.options.quiet && site.relief.cell_m > 0) print_relief(site, stats);
  if (run.request.reference_tolerance)
    print_reference(*run.request.reference_tolerance, stats.reference, site.ground != nullptr);
  if (run.identity.contains("advice")) print_tolerance(run.identity.at("advice"));
}

}  // namespace

int run_command(const RunOptions& options) {
  RunUnderWay run(options);
  std::unique_ptr<RankLink> link = join_ranks();
  if (link && link->rank() > 0) return help_run(options, std::move(link));
  std::optional<LeadRank> lead;
  if (link) lead.emplace(std::move(link));
  SceneDescription description = described(options);
  run.request = requested(options, description);
  OutputFolder output(options.output, inputs_of(description));
  PartialRun partial(options.output, options.resume);
  settle(run, description, partial);
  int threads = description.run.threads;
  if (lead) {
    lead->start(run.identity.at("asked"), run.identity.at("run"));
    run.ranks = lead->ranks();
    if (threads <= 0) threads = threads_of_rank(lead->local_ranks());
  }
  const ThreadLimit limit(threads);
  run.threads = limit.threads();
  const auto survey =
      partial.unless_interrupted([&] { return open_survey(description, facets_for(run.request)); });
  refuse_changed_input(description);
  run.warnings.foresee(*survey, run.request);
  const std::vector<std::string> left_out = files_left_out(*survey, run.request.selection);
  print_warnings(left_out, options.quiet);
  foresee_writing(run, *survey);

  const std::vector<Recording> recordings = simulate_all(run, *survey, partial, lead);
  std::vector<std::filesystem::path> files;
  partial.keep_through([&] { files = write_all(run, *survey, recordings, left_out, output); });
  partial.remove();
  tell_all(run, *survey->site);
  for (const std::string& line : written_lines(options.output, files)) tell("{}\n", line);
  return 0;
}

}  // namespace tubefoot
