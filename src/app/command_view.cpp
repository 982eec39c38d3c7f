// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "app/commands.hpp"
#include "files/checked_file.hpp"
#include "files/companions.hpp"
#include "files/inlet.hpp"
#include "files/input_error.hpp"
#include "files/outlet.hpp"
#include "files/usage_error.hpp"
#include "run/console/say.hpp"
#include "run/settings.hpp"
#include "run/shot.hpp"
#include "sensors/recordings/echo_reader.hpp"
#include "viewer/page.hpp"
#include "viewer/view_gather.hpp"

namespace tubefoot {
namespace fs = std::filesystem;
namespace {

/// What a result folder says of the run that made it.
struct RunRecord {
  fs::path scene;
  std::string scene_hash, engine, arithmetic, binning;
};

RunRecord read_record(const fs::path& folder) {
  constexpr std::uintmax_t most_bytes = 4 << 20;
  const fs::path file = folder / "stats.json";
  if (!fs::exists(file))
    throw UsageError(fmt::format(
        "'{}' has no stats.json: name a folder that 'tubefoot run' wrote, or a scene file", folder.string()));
  try {
    const auto json = nlohmann::json::parse(
        read_whole(file, {file.string(), 0, 0}, most_bytes, "what 'tubefoot run' writes"));
    return {json.at("scene").get<std::string>(), json.at("scene_hash").get<std::string>(),
            json.at("engine").get<std::string>(), json.value("arithmetic", ""), json.value("binning", "")};
  } catch (const nlohmann::json::exception& error) {
    throw UsageError(fmt::format("'{}' is not what 'tubefoot run' writes: {}", file.string(), error.what()));
  }
}

SceneDescription described_by(const RunRecord& record, const ViewOptions& options) {
  CommonOptions common = options;
  common.scene = options.moved_scene.value_or(record.scene);
  if (!fs::exists(common.scene))
    throw UsageError(fmt::format("the scene of '{}' is not at '{}': name it with --scene",
                                 options.scene.string(), common.scene.string()));
  // The result may be somebody else's, and would name any file of this machine.
  const auto elsewhere = options.moved_scene ? std::nullopt : place_outside(".", common.scene);
  if (elsewhere && options.confined)
    throw UsageError(
        fmt::format("the scene that '{}' names is '{}', outside of the folder that you are in, and "
                    "--confined reads nothing outside: name it with --scene",
                    options.scene.string(), elsewhere->string()));
  if (elsewhere)
    print_warnings({fmt::format("the scene that '{}' names lies outside of the folder that you are in: '{}'",
                                options.scene.string(), elsewhere->string())},
                   options.quiet);
  SceneDescription description = described(common);
  if (description.sha256 != record.scene_hash)
    throw UsageError(
        fmt::format("'{0}' has changed since the run in '{1}', whose picture would not fit: run it again, or "
                    "view '{0}' itself",
                    common.scene.string(), options.scene.string()));
  if (record.engine == "tube") {
    if (!options.arithmetic && !record.arithmetic.empty()) description.run.arithmetic = record.arithmetic;
    if (!record.binning.empty()) description.run.binning = record.binning;
  }
  return description;
}

/// Replaces a view's picture by the one that the run recorded, and says where footprints do not explain it.
void take_recorded(const fs::path& folder, const RunRecord& record, ViewData& view) {
  const fs::path file = folder / "echoes.nc";
  const EchoContents contents = read_echo_file(file);
  const auto found = std::find_if(contents.sensors.begin(), contents.sensors.end(),
                                  [&](const SensorEchoes& s) { return s.name == view.sensor; });
  if (found == contents.sensors.end() || found->beams != view.beams || found->samples != view.samples ||
      view.pings.back().number >= found->pings)
    throw UsageError(fmt::format("'{}' does not hold the pings of sensor '{}' of its scene: run it again",
                                 file.string(), view.sensor));
  const std::size_t cells = std::size_t(view.beams) * view.samples;
  double total = 0, apart = 0;
  for (std::size_t p = 0; p < view.pings.size(); ++p)
    for (std::size_t c = 0; c < cells; ++c) {
      const double recorded = found->energy[view.pings[p].number * cells + c];
      double& shown = view.energy_j[p * cells + c];
      total += recorded;
      apart += std::abs(recorded - shown);
      shown = recorded;
    }
  if (record.engine != "tube")
    view.notes.push_back(
        fmt::format("The picture is the {} engine's, the footprints are the tube engine's: their "
                    "energies differ by {:.3g} of the picture's.",
                    record.engine, total > 0 ? apart / total : 0));
  else if (apart > 1e-6 * total)
    view.notes.push_back(fmt::format("{:.3g} of the picture's energy is not the footprints' ordinary echo.",
                                     total > 0 ? apart / total : 0));
}

bool has_other_paths(const Scene& scene) {
  const SceneDescription& d = scene.description;
  return d.sea_surface || d.paths.scatterings > 1 || d.paths.direct ||
         std::any_of(scene.material_reflection.begin(), scene.material_reflection.end(),
                     [](double reflection) { return reflection > 0; });
}

}  // namespace

int view_command(const ViewOptions& options) {
  const bool of_run = fs::is_directory(options.scene);
  if (!of_run && options.moved_scene)
    throw UsageError("--scene says where the scene of a result folder is now: leave it out for a scene file");
  std::optional<RunRecord> record;
  if (of_run) record = read_record(options.scene);
  const SceneDescription description = of_run ? described_by(*record, options) : described(options);
  Inputs inputs = inputs_of(description);
  if (of_run)
    for (const char* name : {"stats.json", "echoes.nc", list_name}) inputs.push_back(options.scene / name);
  OutputFile output(options.output, inputs);
  const ThreadLimit limit(description.run.threads);
  const auto survey = open_survey(description);
  print_warnings(survey->scene.report.warnings, options.quiet);
  const std::size_t sensor = options.sensor ? survey->fleet->sensor_named(*options.sensor) : 0;
  std::optional<PingRange> range;
  if (options.pings) range = resolved(*options.pings, survey->sensors[sensor].times_s.size());

  ViewData view = gather_view(Shots(*survey, request_of(description.run)), sensor, range, options.quiet);
  view.version = TUBEFOOT_VERSION;
  view.source = options.scene.string();
  if (has_other_paths(survey->scene))
    view.notes.push_back(
        "Footprints are those of the ordinary echo; paths over mirrors, and what scatters "
        "twice, have none.");
  if (record) take_recorded(options.scene, *record, view);
  const std::string page = view_page(view);

  write_file(output.path(), page);
  output.commit();
  if (!options.quiet)
    for (const std::string& note : view.notes) tell("note: {}\n", note);
  tell("wrote {} (sensor '{}', {} {}, {} footprints, {:.1f} MB)\n", options.output.string(), view.sensor,
       view.pings.size(), view.pings.size() == 1 ? "ping" : "pings", view.footprints.size(),
       static_cast<double>(page.size()) / 1e6);
  return 0;
}

}  // namespace tubefoot
