// SPDX-License-Identifier: GPL-3.0-or-later
#include <memory>
#include <nlohmann/json.hpp>

#include "app/commands.hpp"
#include "app/run_in_progress.hpp"
#include "files/atomic_output.hpp"
#include "geometry/steps/stop.hpp"
#include "run/part_run.hpp"
#include "run/partial_run.hpp"
#include "run/run_steps.hpp"
#include "run/settings.hpp"
#include "run/simulation.hpp"
#include "run/survey.hpp"

namespace tubefoot {

int join_command(const JoinOptions& join) {
  const RunParts parts(join.output);
  const RunOptions options = parts.options_of_run(join);
  RunInProgress run(options);
  run.parts = parts.count();
  SceneDescription description = described(options);
  run.request = requested(options, description);
  run.omitted = omitted_files(description, options);
  const nlohmann::ordered_json scene_request = request_json(description, run.request);
  run.identity = {{"asked", scene_request}, {"run", json_of(run.request)}};
  parts.require(scene_request);
  OutputFolder output(options.output, inputs_of(description));
  PartialRun partial(options.output, false);
  const ThreadLimit limit(description.run.threads);
  run.threads = limit.threads();
  const auto survey = open_survey(description, facets_for(run.request), run.request.coarseness);
  refuse_changed_input(description);
  const PartDeal deal(*survey, layout_of(*survey, run.request), parts.count());
  parts.require_whole(deal);
  run.warnings.foresee(*survey, run.request);
  const std::vector<std::string> left_out = files_left_out(
      *survey, run.request.selection, run.request.reference_tolerance.has_value(), run.omitted);
  print_warnings(left_out, options.quiet);
  foresee_writing(run, *survey);

  const auto start = std::chrono::steady_clock::now();
  const std::shared_ptr<PingStore> store = partial.open(deal.layout(), run.identity);
  partial.remove();  // removes the name only; the shards remain if this process is killed, and its disk space
                     // is freed then
  parts.hand_over(deal, *store, options.quiet);
  run.simulation_seconds = seconds_since(start);
  const std::vector<Recording> recordings = looked_back(run, *survey, store);
  const std::vector<std::filesystem::path> files = write_all(run, *survey, recordings, left_out, output);
  if (!join.keep_parts) parts.remove();
  tell_all(run, *survey->loaded_scene, files);
  return 0;
}

}  // namespace tubefoot
