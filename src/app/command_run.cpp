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
#include "geometry/work/stop.hpp"
#include "run/console/say.hpp"
#include "run/kept/partial_run.hpp"
#include "run/ranks/run_ranks.hpp"
#include "run/refraction.hpp"
#include "run/run_statistics.hpp"
#include "run/run_steps.hpp"
#include "run/settings.hpp"
#include "run/simulation.hpp"
#include "run/survey.hpp"
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

void print_relief(const Survey& survey, const SimulationStats& stats) {
  if (survey.is_tiled())
    tell("relief: {} facets made for {} pings\n", stats.refined_facets, stats.pings);
  else if (survey.ground)
    tell("relief: {} facets made for {} pings; {} in cells of {:g} m over all of it\n", stats.refined_facets,
         stats.pings, survey.relief.uniform_facets, survey.relief.cell_m);
  else
    tell("relief: {} facets, made once, in cells of {:g} m\n", survey.scene.mesh.facets.size(),
         survey.relief.cell_m);
  tell(
      "finer relief would change a facet's energy by {:.2g} times itself (RMS), by {:.2g} times at most "
      "(first-order estimates for the worst ping, not certified)\n",
      stats.finer_relief_rms, stats.finer_relief_largest);
}

}  // namespace

int run_command(const RunOptions& options) {
  const Clock::time_point start = Clock::now();
  std::unique_ptr<RankLink> link = join_ranks();
  if (link && link->rank() > 0) return help_run(options, std::move(link));
  std::optional<LeadRank> lead;
  if (link) lead.emplace(std::move(link));
  SceneDescription description = described(options);
  const RunRequest request = requested(options, description);
  const std::optional<double>& reference_tolerance = request.reference_tolerance;
  const std::optional<Tolerance>& tolerance = request.tolerance;
  OutputFolder output(options.output, inputs_of(description));
  PartialRun partial(options.output, options.resume);
  const nlohmann::ordered_json asked = asked_of(description, request);
  nlohmann::ordered_json identity{{"asked", asked}};
  if (partial.kept()) {
    identity = *partial.kept();
    description.run = resumed(identity, asked, description.run);
  } else {
    if (tolerance) {
      const Clock::time_point advice_start = Clock::now();
      const Advice advice = pick_settings(description, *tolerance, options.quiet);
      identity["advice"] = json_of(advice, seconds_since(advice_start));
    }
    identity["run"] = json_of(description.run);
  }
  int threads = description.run.threads;
  if (lead) {
    lead->start(asked, identity.at("run"));
    if (threads <= 0) threads = threads_of_rank(lead->local_ranks());
  }
  const ThreadLimit limit(threads);
  const auto survey = partial.unless_interrupted([&] { return open_survey(description); });
  refuse_changed_input(description);
  const Scene& scene = survey->scene;
  std::vector<std::string> warnings = scene.report.warnings;
  const std::vector<std::string> left_out = files_left_out(*survey);
  print_warnings(warnings, options.quiet);
  print_warnings(left_out, options.quiet);

  const Clock::time_point simulation_start = Clock::now();
  const std::shared_ptr<PingStore> store =
      partial.open(layout_of(*survey, reference_tolerance.has_value()), identity);
  const std::size_t kept_pings = store->done_units();
  if (kept_pings > 0 && !options.quiet) say("going on after {} finished pings\n", kept_pings);
  partial.keep_through([&] {
    if (lead)
      lead->simulate(*survey, *store, options.quiet, reference_tolerance, limit.threads());
    else
      simulate(*survey, *store, options.quiet, reference_tolerance);
    stop_if_wanted();
  });
  const SimulationStats stats = totals(*survey, *store);
  const std::vector<Recording> recordings = recordings_of(*survey, store);
  const std::vector<std::string> refraction = refraction_warnings(*survey, stats);
  print_warnings(refraction, options.quiet);
  warnings.insert(warnings.end(), refraction.begin(), refraction.end());
  const double simulation_seconds = seconds_since(simulation_start);

  const RunDescription& run = description.run;
  const bool exact = run.engine == "tube";
  std::vector<std::filesystem::path> files;
  partial.keep_through([&] {
    const Clock::time_point write_start = Clock::now();
    std::vector<std::string> file_warnings;
    files = write_result_files(output.staging(), *survey, recordings, reference_tolerance, file_warnings);
    warnings.insert(warnings.end(), file_warnings.begin(), file_warnings.end());
    std::erase_if(file_warnings, [&](const std::string& warning) {
      return std::ranges::find(left_out, warning) != left_out.end();
    });
    print_warnings(file_warnings, options.quiet);
    nlohmann::ordered_json json = statistics_json(*survey, stats, reference_tolerance);
    if (identity.contains("advice")) json["tolerance"] = identity.at("advice");
    json["threads"] = limit.threads();
    if (lead) json["ranks"] = lead->ranks();
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
    write_file(output.staging() / "stats.json", text_of(json) + "\n");
    stop_if_wanted();
    refuse_changed_input(description);
    output.commit();
  });
  partial.remove();

  if (!options.quiet)
    tell("{} pings, {} tubes, {} {} in {:.1f} s\n", stats.pings, stats.tubes,
         exact ? stats.footprints : stats.hits, exact ? "footprints" : "ray hits", seconds_since(start));
  if (!options.quiet && survey->relief.cell_m > 0) print_relief(*survey, stats);
  if (reference_tolerance) print_reference(*reference_tolerance, stats.reference, survey->ground != nullptr);
  if (identity.contains("advice")) print_tolerance(identity.at("advice"));
  const std::filesystem::path folder = options.output;
  files.emplace_back("stats.json");
  for (const auto& file : files) tell("wrote {}\n", (folder / file).string());
  return 0;
}

}  // namespace tubefoot
