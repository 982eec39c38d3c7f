// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "advice/advice.hpp"
#include "advice/advice_json.hpp"
#include "app/commands.hpp"
#include "files/checked_file.hpp"
#include "files/json_text.hpp"
#include "run/console/say.hpp"
#include "run/settings.hpp"
#include "sensors/kinds/scene_file.hpp"
#include "study/ping_spread.hpp"

namespace tubefoot {
namespace {

void print_advice(const Advice& advice) {
  const ErrorMeasure measure = advice.tolerance.measure;
  for (const LookedAt& s : advice.sensors) {
    tell("predicted on   {}\n", pings_text(s.sensor, s.probes, s.pings));
    if (s.others_are_probes)
      tell("measured on    {}; there are no other pings, so only the seed of the rays differs\n",
           pings_text(s.sensor, s.others, s.pings));
    else
      tell("measured on    {}\n", pings_text(s.sensor, s.others, s.pings));
  }
  for (const std::string& name : advice.silent)
    tell("note           {} receives nothing in these pings, so only exact binning was tested\n", name);
  tell("\n{:<44} {:>10} {:>10} {:>10} {:>10}  {}\n", "", "predicted", "seconds", "measured", "seconds",
       "within");
  tell("{:<44} {:>10} {:>10} {:>10} {:>10}  {}\n", "", "error", "per ping", "error", "per ping",
       to_text(advice.tolerance));
  for (const Candidate& c : advice.candidates) {
    const std::string name = fmt::format("{}, {}", c.setting.engine, c.setting.setting);
    if (!c.tried && c.predicted_seconds == 0) {
      tell("{:<44} {:>10} {:>10} {:>10} {:>10}  no: {}\n", name, "-", "-", "-", "-", c.note);
      continue;
    }
    tell("{:<44} {:>10} {:>10.3g} ", name, error_text(measure, c.predicted_error), c.predicted_seconds);
    if (c.others)
      tell("{:>10} {:>10.3g}  {}\n", error_text(measure, error_of(*c.others, measure)),
           c.others->work.processor_seconds, advice.holds(c) ? "yes" : "no");
    else
      tell("{:>10} {:>10}  no: {}\n", "-", "-", c.note);
  }
  tell(
      "\nThe predicted error is a {:g} % confidence limit from the spread of the trial pings, and at least "
      "{:g} times their error. Times are in seconds of CPU time on one thread, without the loading of the "
      "scene.\n",
      100 * error_limit_confidence, least_margin);
  tell("cheapest       {}, {}\n", advice.best().setting.engine, advice.best().setting.setting);
  tell("neglected      {}\n", left_out_by(advice.best().setting.run));
  tell("options        {}\n", command_options(advice.best().setting.run));
}

}  // namespace

int advise_command(const AdviseOptions& options) {
  const Tolerance tolerance = requested_tolerance(options.tolerance);
  const SceneDescription scene = read_scene_file(options.scene, options.confined);
  std::optional<OutputFile> output;
  if (options.json && *options.json != "-") output.emplace(*options.json, inputs_of(scene));
  AdviceOptions requested;
  requested.trial_pings = options.trial_pings;
  if (options.pings) {
    if (const auto count = number_of_pings(*options.pings, 2, "--trial-pings N", options.quiet))
      requested.trial_pings = *count;
    else
      requested.pings = *options.pings;
  }
  requested.seed = scene.run.seed;
  requested.quiet = options.quiet;
  const ThreadLimit limit(options.threads.value_or(scene.run.threads));
  const Advice advice = advise(scene, tolerance, requested);
  const std::string json = text_of(json_of(advice, scene)) + "\n";
  if (options.json == "-") {
    tell("{}", json);
    return 0;
  }
  print_advice(advice);
  if (output) {
    write_file(output->path(), json);
    output->commit();
    tell("wrote {}\n", *options.json);
  }
  return 0;
}

}  // namespace tubefoot
