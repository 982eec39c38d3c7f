// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/run_steps.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>

#include "files/usage_error.hpp"
#include "files/utc.hpp"
#include "geometry/work/stop.hpp"
#include "run/abilities.hpp"
#include "run/console/say.hpp"
#include "run/kept/build_identity.hpp"
#include "run/kept/partial_run.hpp"
#include "run/own_engine.hpp"
#include "sensors/products/products.hpp"

namespace tubefoot {
namespace {

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

RunContext context_of(const Survey& survey) {
  const SceneDescription& description = survey.scene.description;
  return {survey.scene.frame, *unix_time_s(description.run.start_utc), description.run.seed,
          description.water, description.title};
}

}  // namespace

RunRequest requested(const RunOptions& options, SceneDescription& description) {
  if (options.engine) description.run.engine = *options.engine;
  if (options.binning) description.run.binning = *options.binning;
  if (options.sampling) description.run.sampling = *options.sampling;
  if (options.rays) {
    description.run.rays_per_ping = *options.rays;
    description.run.rays_per_beam.reset();
  }
  if (options.rays_per_beam) description.run.rays_per_beam = *options.rays_per_beam;
  if (options.seed) description.run.seed = *options.seed;
  RunRequest request;
  if (options.tolerance && !options.reference) {
    refuse_what_the_tolerance_picks(options);
    request.tolerance = asked_tolerance(*options.tolerance);
    // One dial: the ground is refined no further, and no less, unless the scene says how far.
    if (!description.refinement.tolerance)
      description.refinement.tolerance = relative_error(*request.tolerance);
    // Paths that together return less than a third of it are not worth following, either.
    description.paths.cutoff_db =
        std::min(description.paths.cutoff_db, -10 * std::log10(relative_error(*request.tolerance) / 3));
  }
  if (options.reference) {
    request.reference_tolerance = bound_asked_for(options.tolerance);
    require_able(description.run, Feature::reference);
  }
  return request;
}

nlohmann::ordered_json asked_of(const SceneDescription& description, const RunRequest& request) {
  return {{"version", TUBEFOOT_VERSION},
          {"build", build_identity()},
          {"scene_hash", description.sha256},
          {"run", json_of(description.run)},
          {"reference", request.reference_tolerance.value_or(0.0)},
          {"tolerance", request.tolerance ? to_text(*request.tolerance) : ""}};
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
    say("for {}: {}, {}\n", to_text(tolerance), advice.best().setting.engine, advice.best().setting.setting);
  return advice;
}

void refuse_changed_input(const SceneDescription& description) {
  std::string why = "its scene hash is another";
  try {
    if (read_scene_file(description.file, description.confined).sha256 == description.sha256) return;
  } catch (const InputError& error) {
    why = error.what();
  }
  throw std::runtime_error(fmt::format(
      "'{}', or a file that it names, was changed during the run ({}): bring it back before you go "
      "on, or begin anew",
      description.file.string(), why));
}

std::string engine_name(const Survey& survey) {
  return survey.own_engine ? survey.own_engine->name : survey.scene.description.run.engine;
}

Provenance provenance_of(const Survey& survey, const std::optional<double>& reference_tolerance) {
  const SceneDescription& description = survey.scene.description;
  const RunDescription& run = description.run;
  const std::string arithmetic = survey.own_engine ? "own" : run.engine == "tube" ? run.arithmetic : "float";
  return {description.title, description.sha256,  engine_name(survey), arithmetic,
          TUBEFOOT_VERSION,  reference_tolerance, run.start_utc,       survey.scene.frame};
}

std::vector<std::string> files_left_out(const Survey& survey) {
  const RunContext context = context_of(survey);
  std::vector<std::string> warnings;
  for (const SensorPings& pings : survey.sensors) {
    Recording recording;
    recording.sensor = pings.sensor.get();
    recording.ping_time_s = pings.times_s;
    recording.sound_speed_m_s = pings.sound_speed_m_s;
    for (std::string& warning : files_left_out(recording, context)) warnings.push_back(std::move(warning));
  }
  return warnings;
}

std::vector<std::filesystem::path> write_result_files(const std::filesystem::path& folder,
                                                      const Survey& survey,
                                                      const std::vector<Recording>& recordings,
                                                      const std::optional<double>& reference_tolerance,
                                                      std::vector<std::string>& warnings) {
  const RunContext context = context_of(survey);
  write_echoes(folder / "echoes.nc", recordings, provenance_of(survey, reference_tolerance));
  std::vector<std::filesystem::path> files{"echoes.nc"};
  for (const Recording& recording : recordings) {
    stop_if_wanted();
    for (const auto& file : write_products(folder, recording, context, warnings)) files.push_back(file);
  }
  return files;
}

}  // namespace tubefoot
