// SPDX-License-Identifier: GPL-3.0-or-later
// The command `run`. It simulates all pings of a scene and writes a result folder, or computes one shard of
// a run (`--shard`). It resumes from a checkpoint and can take its settings from an error tolerance.
#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "advice/advice.hpp"
#include "app/commands.hpp"
#include "app/run_in_progress.hpp"
#include "files/atomic_output.hpp"
#include "files/shown.hpp"
#include "files/usage_error.hpp"
#include "geometry/steps/stop.hpp"
#include "run/console/amounts.hpp"
#include "run/console/say.hpp"
#include "run/gradient_parameters.hpp"
#include "run/part_run.hpp"
#include "run/partial_run.hpp"
#include "run/ranks/run_ranks.hpp"
#include "run/run_steps.hpp"
#include "run/settings.hpp"
#include "run/simulation.hpp"
#include "run/survey.hpp"
#include "study/ping_spread.hpp"

namespace tubefoot {
namespace {

using Clock = std::chrono::steady_clock;

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
      {"estimate", fmt::format("measured, not certified: {:g} % confidence limit from the spread of the "
                               "trial pings, relative to exact cuts",
                               100 * error_limit_confidence)},
      {"error_text", error_text(advice.tolerance.measure, best.predicted_error)},
      {"seconds_of_advice", seconds}};
  for (const LookedAt& s : advice.sensors) json["probe_pings"][s.sensor] = s.probes;
  return json;
}

/// Determines the settings: those of the resumed run, those of the scene, or those that a tolerance
/// selects.
void settle(RunInProgress& run, const SceneDescription& description, const PartialRun& partial) {
  const nlohmann::ordered_json scene_request = request_json(description, run.request);
  if (partial.kept()) {
    run.identity = *partial.kept();
    run.request = resumed(run.identity, scene_request, std::move(run.request));
    return;
  }
  run.identity = {{"asked", scene_request}};
  if (run.request.tolerance) {
    const Clock::time_point start = Clock::now();
    const Advice advice = pick_settings(description, run.request, run.options.quiet);
    run.identity["advice"] = json_of(advice, seconds_since(start));
  }
  run.identity["run"] = json_of(run.request);
}

std::vector<Recording> simulate_all(RunInProgress& run, const Survey& survey, PartialRun& partial,
                                    std::optional<LeadRank>& lead) {
  const Clock::time_point start = Clock::now();
  const bool quiet = run.options.quiet;
  const std::shared_ptr<PingStore> store = partial.open(layout_of(survey, run.request), run.identity);
  run.kept_pings = store->done_units();
  if (run.kept_pings > 0 && !quiet) say("continuing after {} finished pings\n", run.kept_pings);
  partial.keep_through([&] {
    if (lead)
      lead->simulate(survey, run.request, *store, quiet, run.threads, run.expected_write_seconds);
    else
      simulate(survey, run.request, *store, {quiet, nullptr, run.expected_write_seconds});
    stop_if_wanted();
  });
  std::vector<Recording> recordings = looked_back(run, survey, store);
  run.simulation_seconds = seconds_since(start);
  return recordings;
}

/// Computes a shard of the pings into a file next to the output, for join_command().
int run_part(const RunOptions& options) {
  const PartNumber number = parse_part(*options.part);
  if (is_later_rank()) return 0;  // the first rank reports errors
  if (is_one_of_several_ranks())
    throw UsageError(
        "--shard is for independent processes, but mpirun divides one run among its processes: leave out "
        "--shard, or start each shard separately");
  SceneDescription description = described(options);
  const RunRequest request = requested(options, description);
  omitted_files(description, options);  // rejects before the computation what join would reject
  if (request.tolerance)
    throw UsageError(
        "--tolerance could select different settings for each shard: find the settings once with 'tubefoot "
        "advise', and use them for all shards");
  // Rejects before the computation what join would reject.
  std::optional<OutputFolder> output(std::in_place, options.output, inputs_of(description));
  RunPart part(options, request_json(description, request));
  output.reset();
  keep_through([&] { return part.advice(); },
               [&] {
                 const ThreadLimit limit(description.run.threads);
                 const auto survey = open_survey(description, facets_for(request), request.coarseness);
                 refuse_changed_input(description);
                 RunWarnings warnings(
                     [&](const std::string& warning, bool) { print_warnings({warning}, options.quiet); });
                 warnings.foresee(*survey, request);
                 part.compute(*survey, request);
                 refuse_changed_input(description);
               });
  tell("wrote {} ({}: {} pings, {})\n", part.path().string(), in_words(number), part.pings(),
       size_text(static_cast<double>(part.bytes())));
  return 0;
}

}  // namespace

int run_command(const RunOptions& options) {
  if (options.gradient == "help") {
    tell("{}", harmless(gradient_help(described(options))));
    return 0;
  }
  if (options.part) return run_part(options);
  RunInProgress run(options);
  std::unique_ptr<RankLink> link = join_ranks();
  if (link && link->rank() > 0) return help_run(options, std::move(link));
  std::optional<LeadRank> lead;
  if (link) lead.emplace(std::move(link));
  SceneDescription description = described(options);
  run.request = requested(options, description);
  run.omitted = omitted_files(description, options);
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
  const auto survey = partial.unless_interrupted(
      [&] { return open_survey(description, facets_for(run.request), run.request.coarseness); });
  refuse_changed_input(description);
  run.warnings.foresee(*survey, run.request);
  const std::vector<std::string> left_out = files_left_out(
      *survey, run.request.selection, run.request.reference_tolerance.has_value(), run.omitted);
  print_warnings(left_out, options.quiet);
  foresee_writing(run, *survey);

  const std::vector<Recording> recordings = simulate_all(run, *survey, partial, lead);
  std::vector<std::filesystem::path> files;
  partial.keep_through([&] { files = write_all(run, *survey, recordings, left_out, output); });
  partial.remove();
  tell_all(run, *survey->loaded_scene, files);
  return 0;
}

}  // namespace tubefoot
