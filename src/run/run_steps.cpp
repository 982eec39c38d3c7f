// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/run_steps.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>

#include "files/shown.hpp"
#include "files/usage_error.hpp"
#include "files/utc.hpp"
#include "geometry/steps/stop.hpp"
#include "run/abilities.hpp"
#include "run/checkpoint/build_identity.hpp"
#include "run/console/progress.hpp"
#include "run/gradient_parameters.hpp"
#include "run/own_engine.hpp"
#include "run/settings.hpp"
#include "run/simulation.hpp"
#include "sensors/kinds/scene_file.hpp"
#include "sensors/recordings/receiver_output.hpp"

// This file implements the steps of a run that the command and the Python module share: request, identity,
// expected cost, and result files.

namespace tubefoot {
namespace {

double bound_requested(const std::optional<std::string>& text) {
  double bound = 1e-9;
  if (!text) return bound;
  const auto [end, error] = std::from_chars(text->data(), text->data() + text->size(), bound);
  // NaN fails both comparisons.
  if (error != std::errc() || end != text->data() + text->size() || !(bound >= 1e-12 && bound <= 0.1))
    throw UsageError(
        fmt::format("with --reference, --tolerance is a relative bound from 1e-12 to 0.1, not '{}'", *text));
  return bound;
}

/// Parses a coarseness between 0 and 1. Throws UsageError.
double coarseness_requested(const std::string& text) {
  double coarseness = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), coarseness);
  if (error != std::errc() || end != text.data() + text.size() || !(coarseness >= 0 && coarseness <= 1))
    throw UsageError(
        fmt::format("--coarsen '{}': expected the permitted displacement of facets as a fraction of the "
                    "resolution of the sonars, from 0 (no merging) to 1",
                    shown(text)));
  return coarseness;
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
        fmt::format("--tolerance selects the engine and its settings: leave out {}, or --tolerance", option));
}

/// Throws UsageError for settings of the engine that is not used.
void refuse_unused_settings(const RunOptions& options, Engine engine) {
  const bool rays = engine == Engine::ray;
  const char* unused = !rays && options.rays            ? "--rays"
                       : !rays && options.rays_per_beam ? "--rays-per-beam"
                       : !rays && options.sampling      ? "--sampling"
                       : rays && options.binning        ? "--binning"
                                                        : nullptr;
  if (unused != nullptr)
    throw UsageError(fmt::format(
        "{} is a setting of the {} engine, but this run uses {}: add --engine {}, or leave it out", unused,
        rays ? "tube" : "ray", name_of(engine), rays ? "tube" : "ray"));
}

RunContext context_of(const Scene& scene, const PictureSettings& pictures, bool with_bounds) {
  const SceneDescription& description = scene.description;
  return {scene.frame,          *unix_time_s(description.run.start_utc),
          description.run.seed, description.water,
          description.title,    pictures,
          with_bounds,          scene.assumed_water};
}

/// Returns recordings of the selection, without energies.
std::vector<Recording> recordings_to_be(const Survey& survey, const Selection& selection) {
  std::vector<Recording> recordings;
  const std::vector<ChosenEchoes> chosen = chosen_of(survey, selection);
  for (std::size_t s = 0; s < chosen.size(); ++s)
    if (chosen[s].pings > 0) recordings.push_back(recording_of(survey, s, selection, chosen[s]));
  return recordings;
}

/// Returns the recording of which the files of the sonar are made. The writer of signals needs both the true
/// and the assumed configuration, and selects them itself.
Recording for_products(const Recording& recording) {
  return recording.sensor->signals() != nullptr ? recording : recording.as_recorded();
}

std::string only_echoes_of(const Recording& recording) {
  return fmt::format(
      "'{}': --beams selects some of its beams, so only the echo file is written: pictures and sonar files "
      "need complete pings",
      recording.sensor->description().name);
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
  RunRequest request = request_of(description.run);
  request.labels = options.labels;
  if (options.label_level_db) {
    constexpr double most_db = 1000;
    if (!options.labels)
      throw UsageError("--label-level needs --labels: add --labels, or leave out --label-level");
    if (!(*options.label_level_db > 0 && *options.label_level_db <= most_db))
      throw UsageError(
          fmt::format("--label-level {}: expected decibels below the two-way peak of the beam pattern, above "
                      "0 and at most {}",
                      *options.label_level_db, most_db));
    request.label_level_db = *options.label_level_db;
  }
  if (options.gradient) {
    request.gradient = gradient_names(*options.gradient);
    gradient_parameters(description, request.gradient);
    require_able(request, Feature::gradient);
  }
  request.gradient_steps = options.gradient_steps;
  if (options.gradient_steps && !options.gradient)
    throw UsageError("--gradient-steps needs --gradient: add --gradient, or leave out --gradient-steps");
  if (options.coarsen) request.coarseness = coarseness_requested(*options.coarsen);
  request.selection = options.selection;
  if (!options.tolerance || options.reference) refuse_unused_settings(options, request.engine);
  if (options.tolerance && !options.reference) {
    refuse_what_the_tolerance_picks(options);
    require_able(request, Feature::trial);
    request.tolerance = requested_tolerance(*options.tolerance);
    // The tolerance also determines the fineness of the relief, unless the scene sets it.
    if (!description.refinement.tolerance)
      description.refinement.tolerance = relative_error(*request.tolerance);
    // Paths that together return less than a third of the tolerance are not followed.
    description.paths.cutoff_db =
        std::min(description.paths.cutoff_db, -10 * std::log10(relative_error(*request.tolerance) / 3));
  }
  if (options.reference) {
    request.reference_tolerance = bound_requested(options.tolerance);
    require_able(request, Feature::reference);
  }
  return request;
}

nlohmann::ordered_json request_json(const SceneDescription& description, const RunRequest& request) {
  const Selection& selection = request.selection;
  return {{"version", TUBEFOOT_VERSION},
          {"build", build_identity()},
          {"scene_hash", description.sha256},
          {"run", json_of(request)},
          {"sensor", selection.sensor.value_or("all")},
          {"pings", selection.pings.value_or("all")},
          {"beams", selection.beams.value_or("all")},
          {"reference", request.reference_tolerance.value_or(0.0)},
          {"tolerance", request.tolerance ? to_text(*request.tolerance) : ""}};
}

void refuse_changed_input(const SceneDescription& description) {
  std::string why = "its scene hash differs";
  try {
    if (read_scene_file(description.file, description.confined).sha256 == description.sha256) return;
  } catch (const InputError& error) {
    why = error.what();
  }
  throw std::runtime_error(
      fmt::format("'{}', or a file that it names, was changed during the run ({}): restore it before you "
                  "continue, or start again",
                  description.file.string(), why));
}

Facets facets_for(const RunRequest& request) {
  const bool by_facets = request.engine == Engine::tube && request.binning != Binning::exact;
  return request.own_engine || request.reference_tolerance || by_facets ? Facets::as_given : Facets::merged;
}

std::string engine_name(const RunRequest& request) {
  return request.own_engine ? request.own_engine->name : std::string(name_of(request.engine));
}

Provenance provenance_of(const Scene& scene, const RunRequest& request) {
  const SceneDescription& description = scene.description;
  const std::string_view arithmetic = request.own_engine ? "own"
                                      : request.engine == Engine::tube
                                          ? name_of(request.visibility.arithmetic)
                                          : "float";
  return {description.title,         description.sha256, engine_name(request),
          std::string(arithmetic),   TUBEFOOT_VERSION,   request.reference_tolerance,
          description.run.start_utc, request.coarseness, scene.frame};
}

std::vector<std::string> files_left_out(const Survey& survey, const Selection& selection, bool with_bounds,
                                        const OmittedFiles& omitted) {
  RunContext context = context_of(survey.scene, {}, with_bounds);
  std::vector<std::string> warnings;
  for (const Recording& recording : recordings_to_be(survey, selection)) {
    if (!recording.beam_numbers.empty()) {
      warnings.push_back(only_echoes_of(recording));
      continue;
    }
    context.omitted = omitted.of(recording.sensor->description().name);
    for (std::string& warning :
         kind_of(recording.sensor->description()).files_left_out(for_products(recording), context))
      warnings.push_back(std::move(warning));
  }
  return warnings;
}

WritingCost expected_writing(const Survey& survey, const RunRequest& request, const Writing& how) {
  RunContext context = context_of(survey.scene, how.pictures, request.reference_tolerance.has_value());
  // in addition to the files written next to it
  constexpr double scene_picture_s = 0.1, scene_picture_bytes = 3e5;
  WritingCost all;
  if (how.pictures.which != PictureSettings::Which::none && !how.omitted.scene_picture)
    all += {scene_picture_s, 0, scene_picture_bytes};
  double stored = 0;
  for (const StoreLayout::Sensor& sensor : layout_of(survey, request).sensors)
    for (const OutputChannel& channel : sensor.channels)
      if (!channel.variables.empty()) stored += static_cast<double>(sensor.pings * channel.values);
  if (!how.omitted.echoes) all += cost_of_echoes(stored);
  for (const Recording& recording : recordings_to_be(survey, request.selection)) {
    context.omitted = how.omitted.of(recording.sensor->description().name);
    if (!how.omitted.echoes && receiver_output_of(recording, context)) all += cost_of_received(recording);
    if (request.labels && !how.omitted.echoes)
      all += cost_of_labels(recording, survey.scene.report.components.size(),
                            survey.scene.description.materials.size());
    if (recording.beam_numbers.empty())
      all += kind_of(recording.sensor->description()).writing_cost(recording, context);
  }
  return all;
}

std::vector<std::filesystem::path> write_result_files(const std::filesystem::path& folder,
                                                      const Survey& survey, const RunRequest& request,
                                                      const std::vector<Recording>& recordings,
                                                      std::vector<std::string>& warnings, const Writing& how,
                                                      std::span<const LabelRecording> label_recordings) {
  RunContext context = context_of(survey.scene, how.pictures, request.reference_tolerance.has_value());
  const Progress progress("writing", how.quiet);
  std::vector<std::filesystem::path> files;
  if (!how.omitted.echoes) {
    files.emplace_back("echoes.nc");
    write_echoes(folder / files.back(), recordings, provenance_of(survey.scene, request), context);
    if (!label_recordings.empty()) add_labels(folder / files.back(), recordings, label_recordings);
  }
  for (const Recording& recording : recordings) {
    stop_if_wanted();
    if (!recording.beam_numbers.empty()) {
      warnings.push_back(only_echoes_of(recording));
    } else {
      context.omitted = how.omitted.of(recording.sensor->description().name);
      for (const auto& file : kind_of(recording.sensor->description())
                                  .write_products(folder, for_products(recording), context, warnings))
        files.push_back(file);
    }
  }
  for (std::size_t k = 0; k < label_recordings.size(); ++k)
    if (recordings[k].beam_numbers.empty() && how.pictures.wants(PictureSettings::Which::sequence) &&
        !how.omitted.of(recordings[k].sensor->description().name).contains("labels.png"))
      for (const auto& file :
           write_label_pictures(folder, recordings[k], label_recordings[k], how.pictures.bits))
        files.push_back(file);
  return files;
}

}  // namespace tubefoot
