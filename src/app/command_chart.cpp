// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <set>

#include "advice/chart_folder.hpp"
#include "advice/trials.hpp"
#include "app/commands.hpp"
#include "files/atomic_output.hpp"
#include "files/usage_error.hpp"
#include "run/console/progress.hpp"
#include "run/console/say.hpp"
#include "run/settings.hpp"
#include "sensors/kinds/scene_file.hpp"
#include "study/chart_page.hpp"

namespace tubefoot {
namespace {

void print_verdict(const SceneVerdict& v) {
  const auto ratio = [](const std::optional<double>& value, bool extrapolated) {
    return value ? fmt::format("{:.3g}{}", *value, extrapolated ? " *" : "") : std::string("not reached");
  };
  tell("{:<22} {:<14} {:>14} {:>14} {:>12.2g} %\n", v.scene, name_of(v.work),
       ratio(v.ray_over_tube_at_db, v.db_extrapolated), ratio(v.ray_over_tube_at_l1, v.l1_extrapolated),
       100 * v.crossing_l1);
}

}  // namespace

int chart_command(const ChartOptions& options) {
  std::set<std::string> names;
  std::vector<SceneDescription> scenes;
  Inputs inputs;
  for (const std::filesystem::path& file : options.scenes) {
    scenes.push_back(read_scene_file(file, options.confined));
    const Inputs its = inputs_of(scenes.back());
    inputs.insert(inputs.end(), its.begin(), its.end());
  }
  const std::optional<std::size_t> count =
      options.pings ? number_of_pings(*options.pings, 1, "--pings 0:N-1", options.quiet) : std::nullopt;
  const std::string pings = options.pings.value_or("0");
  OutputFolder output(options.output, inputs);
  const ThreadLimit one_thread(1);  // the seconds of a setting do not depend on other threads
  std::vector<Trial> trials;
  Progress progress("settings", options.scenes.size() * builtin_settings(1).size(), options.quiet);
  for (const SceneDescription& description : scenes) {
    TrialScene scene(description, count ? first_pings(*count) : chosen_pings(pings),
                     chart_reference_tolerance);
    if (!names.insert(scene.name()).second)
      throw UsageError(fmt::format(
          "two scenes have the name '{}', so the chart cannot distinguish them: rename a file or its folder",
          scene.name()));
    const std::vector<Trial> own =
        all_trials(scene, builtin_settings(scene.beams()), options.repeats,
                   {.seconds = options.seconds_per_trial}, [&] { progress.step(); });
    trials.insert(trials.end(), own.begin(), own.end());
  }
  write_chart(output.staging(), trials,
              chart_origin("<code>tubefoot chart</code>", count ? fmt::format("0:{}", *count - 1) : pings,
                           options.repeats));
  output.commit();
  tell("{:<22} {:<14} {:>14} {:>14} {:>14}\n", "scene", "measured in", "rays/tubes", "rays/tubes",
       "rays cheaper");
  tell("{:<22} {:<14} {:>14} {:>14} {:>14}\n", "", "", "at 0.1 dB RMS", "at 1e-3 L1", "above L1 of");
  bool extrapolated = false;
  for (const std::string& scene : scenes_of(trials))
    for (const WorkMeasure work : {WorkMeasure::seconds, steadiest_measure(trials)}) {
      const SceneVerdict v = verdict_of(scene, trials, work);
      print_verdict(v);
      extrapolated |= v.db_extrapolated || v.l1_extrapolated;
    }
  if (extrapolated) tell("* extrapolated beyond the finest tested number of rays, along the fitted order\n");
  tell("wrote {}\n", (options.output / "index.html").string());
  tell("wrote {}\n", (options.output / "chart.csv").string());
  return 0;
}

}  // namespace tubefoot
