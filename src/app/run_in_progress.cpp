// SPDX-License-Identifier: GPL-3.0-or-later
// Steps that `run` and `join` share after the simulation: summing statistics, writing the result folder and
// printing the summary.
#include "app/run_in_progress.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <tbb/parallel_invoke.h>

#include <algorithm>
#include <glm/trigonometric.hpp>

#include "files/checked_file.hpp"
#include "files/json_text.hpp"
#include "files/memory_at_hand.hpp"
#include "files/usage_error.hpp"
#include "geometry/steps/stop.hpp"
#include "plan/scene_drawing.hpp"
#include "run/console/amounts.hpp"
#include "run/console/say.hpp"
#include "run/console/written.hpp"
#include "run/labels.hpp"
#include "run/run_statistics.hpp"
#include "run/run_steps.hpp"

namespace tubefoot {
namespace {

using Clock = std::chrono::steady_clock;

/// `refined`: relief was refined for each transmission, down to the tolerance of the relief.
void print_reference(double tolerance, const ReferenceStats& reference, bool refined) {
  if (reference.bins_over == 0)
    tell("reference: certified; the relative half-width of each interval is at most {:g}{}\n", tolerance,
         refined ? ", for the refined facets of the relief" : "");
  else if (reference.worst_ratio == 0)  // no bound is finite
    tell("reference: certified; {} range bins have no bound, and all other energies are 0\n",
         reference.bins_over);
  else if (reference.worst_ratio <= 1)  // the largest ratio of the finite bounds
    tell(
        "reference: certified; {} range bins have no bound, and the relative half-width of the other "
        "intervals is at most {:g}\n",
        reference.bins_over, tolerance);
  else
    tell(
        "reference: {} range bins have intervals wider than {:g}; the widest is {:.3g} times the "
        "requested half-width, at sensor '{}', ping {}, beam {}, range bin {}\n",
        reference.bins_over, tolerance, reference.worst_ratio, reference.worst_sensor, reference.worst_ping,
        reference.worst_beam, reference.worst_sample);
}

void print_tolerance(const nlohmann::ordered_json& advice) {
  tell("tolerance {}: {}, {}; neglected: {}; error about {} (measured on trial pings, not certified)\n",
       advice.at("asked").get<std::string>(), advice.at("engine").get<std::string>(),
       advice.at("setting").get<std::string>(), advice.at("left_out").get<std::string>(),
       advice.at("error_text").get<std::string>());
}

void print_relief(const LoadedScene& loaded_scene, const SimulationStats& stats) {
  if (loaded_scene.refines_tiles())
    tell("relief: tiles are refined once per region of pings, with cells of {:g} m\n",
         loaded_scene.relief.cell_m);
  else if (loaded_scene.is_tiled())
    tell("relief: {} facets for {} pings\n", stats.refined_facets, stats.pings);
  else if (loaded_scene.surface_mesh)
    tell("relief: {} facets for {} pings; a uniform refinement would have {} facets with cells of {:g} m\n",
         stats.refined_facets, stats.pings, loaded_scene.relief.uniform_facets, loaded_scene.relief.cell_m);
  else
    tell("relief: {} facets, refined once, with cells of {:g} m\n", loaded_scene.scene.mesh.facets.size(),
         loaded_scene.relief.cell_m);
  tell(
      "finer relief would change the energy of a facet by {:.2g} (RMS) and at most {:.2g} times its value; "
      "these first-order estimates for the worst ping are not certified\n",
      stats.finer_relief_rms, stats.finer_relief_largest);
}

void print_coarsening(const SceneCoarsening& coarse) {
  tell(
      "coarsened: {} facets instead of {}; points move by at most {:.3g} mm ({:.3g} of the local resolution "
      "of the sonars), and normals turn by at most {:.3g} degrees (bounds)\n",
      coarse.facets, coarse.facets_before, 1000 * coarse.largest_move_m, coarse.largest_share,
      glm::degrees(coarse.largest_turn_rad));
}

/// Returns the contents of stats.json.
nlohmann::ordered_json whole_statistics(const RunInProgress& run, const Survey& survey,
                                        double write_seconds) {
  nlohmann::ordered_json json = statistics_json(survey, run.request, run.stats);
  if (run.identity.contains("advice")) json["tolerance"] = run.identity.at("advice");
  json["threads"] = run.threads;
  if (run.ranks) json["ranks"] = *run.ranks;
  if (run.parts) json["parts"] = *run.parts;
  if (run.kept_pings > 0) json["pings_kept_from_before"] = run.kept_pings;
  json["seconds"] = {{"load", survey.loaded_scene->load_seconds},
                     {"tree", survey.loaded_scene->tree_seconds},
                     {"simulation", run.simulation_seconds},
                     {"visibility_of_all_pings", run.stats.visibility_seconds},
                     {"echo_of_all_pings", run.stats.echo_seconds},
                     {"write", write_seconds},
                     {"total", seconds_since(run.start)}};
  json["peak_memory_mb"] = peak_memory_mb();
  json["warnings"] = run.warnings.all();
  if (!run.omitted.names.empty()) json["omitted_files"] = run.omitted.names;
  return json;
}

/// Formats the number of pings per second if this run computed all pings.
std::string pace(const RunInProgress& run) {
  return run.kept_pings == 0 && run.simulation_seconds > 0
             ? fmt::format(" ({:.3g} pings per second)",
                           static_cast<double>(run.stats.pings) / run.simulation_seconds)
             : std::string();
}

}  // namespace

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

void foresee_writing(RunInProgress& run, const Survey& survey) {
  const PictureSettings& pictures = run.options.pictures;
  if (pictures.animated && pictures.which == PictureSettings::Which::none)
    throw UsageError(
        "--animate needs pictures, but no pictures are drawn with --pictures none: leave out one of them");
  const WritingCost cost = expected_writing(survey, run.request, {pictures, true, run.omitted});
  const double kept = layout_of(survey, run.request).bytes();
  constexpr double long_s = 10, large_bytes = 1e9;
  const double seconds = run.expected_write_seconds = cost.seconds_on(run.threads);
  if (!run.options.quiet && (seconds > long_s || kept + cost.bytes > large_bytes))
    say("writing will take about {}; the disk needs {} for energies during the run, and at most about {} for "
        "the result\n",
        duration_text(seconds), size_text(kept), size_text(cost.bytes));
  std::error_code unknown;
  const std::filesystem::space_info disk = std::filesystem::space(
      std::filesystem::absolute(run.options.output, unknown).lexically_normal().parent_path(), unknown);
  if (unknown || static_cast<double>(disk.available) >= cost.bytes + kept) return;
  run.warnings.add(
      {fmt::format("the disk of '{}' has {} of free space, but the run can need {}: use fewer pings "
                   "(--pings, --sensor), or --pictures none",
                   run.options.output.string(), size_text(static_cast<double>(disk.available)),
                   size_text(cost.bytes + kept))});
}

std::vector<Recording> looked_back(RunInProgress& run, const Survey& survey,
                                   const std::shared_ptr<PingStore>& store) {
  run.stats = totals(survey, *store, run.request.selection);
  std::vector<Recording> recordings = recordings_of(survey, store, run.request.selection);
  run.label_recordings = label_recordings_of(survey, run.request, store);
  run.warnings.look_back(survey, run.request, run.stats, recordings);
  return recordings;
}

std::vector<std::filesystem::path> write_all(RunInProgress& run, const Survey& survey,
                                             const std::vector<Recording>& recordings,
                                             const std::vector<std::string>& expected, OutputFolder& output) {
  const Clock::time_point start = Clock::now();
  std::vector<std::string> warnings;
  std::vector<std::filesystem::path> files;
  const bool draws_scene =
      run.options.pictures.which != PictureSettings::Which::none && !run.omitted.scene_picture;
  const auto write_results = [&] {
    files = write_result_files(output.staging(), survey, run.request, recordings, warnings,
                               {run.options.pictures, run.options.quiet, run.omitted}, run.label_recordings);
  };
  const auto draw_scene = [&] { write_scene_picture(output.staging() / scene_picture_name, survey); };
  // librsvg terminates the program if memory is exhausted. It runs concurrently only if much memory is
  // free.
  constexpr double plenty_bytes = 2e9;
  if (!draws_scene) {
    write_results();
  } else if (memory_at_hand() > plenty_bytes) {
    tbb::parallel_invoke(write_results, draw_scene);
  } else {
    write_results();
    draw_scene();
  }
  if (draws_scene) files.emplace_back(scene_picture_name);
  for (const std::string& warning : warnings)
    if (std::ranges::find(expected, warning) != expected.end())
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

void tell_all(const RunInProgress& run, const LoadedScene& loaded_scene,
              const std::vector<std::filesystem::path>& files) {
  const SimulationStats& stats = run.stats;
  const bool exact = run.request.engine == Engine::tube;
  if (!run.options.quiet)
    tell("{} pings, {} tubes, {} {} in {:.1f} s\nsimulation {:.1f} s{}, writing {:.1f} s\n", stats.pings,
         stats.tubes, exact ? stats.footprints : stats.hits, exact ? "footprints" : "ray hits",
         seconds_since(run.start), run.simulation_seconds, pace(run), run.write_seconds);
  if (!run.options.quiet && loaded_scene.coarsening) print_coarsening(*loaded_scene.coarsening);
  if (!run.options.quiet && loaded_scene.relief.cell_m > 0) print_relief(loaded_scene, stats);
  if (run.request.reference_tolerance)
    print_reference(*run.request.reference_tolerance, stats.reference, loaded_scene.surface_mesh != nullptr);
  if (run.identity.contains("advice")) print_tolerance(run.identity.at("advice"));
  if (!run.options.quiet && !run.omitted.names.empty())
    tell("omitted, as --without says: {}\n", fmt::join(run.omitted.names, ", "));
  for (const std::string& line : written_lines(run.options.output, files)) tell("{}\n", line);
}

}  // namespace tubefoot
