// SPDX-License-Identifier: GPL-3.0-or-later
// The command `view`. It writes a page that shows footprints in three dimensions next to the sonar picture,
// for a scene file or a result folder. It can compare the picture with that of another engine
// (docs/footprints.md).
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numeric>

#include "app/commands.hpp"
#include "files/atomic_output.hpp"
#include "files/checked_file.hpp"
#include "files/companions.hpp"
#include "files/input_error.hpp"
#include "files/input_registry.hpp"
#include "files/usage_error.hpp"
#include "plan/scene_drawing.hpp"
#include "run/console/say.hpp"
#include "run/settings.hpp"
#include "run/transmission.hpp"
#include "sensors/recordings/echo_reader.hpp"
#include "viewer/page.hpp"
#include "viewer/view_gather.hpp"

namespace tubefoot {
namespace fs = std::filesystem;
namespace {

/// The parameters of a run that its result folder records.
struct RunRecord {
  fs::path scene;
  std::string scene_hash, engine, arithmetic, binning;
  std::optional<std::string> sensor{}, pings{}, beams{};  ///< selection of the run; none: all
};

RunRecord read_record(const fs::path& folder) {
  constexpr std::uintmax_t most_bytes = 4 << 20;
  const fs::path file = folder / "stats.json";
  if (!fs::exists(file))
    throw UsageError(fmt::format(
        "'{}' has no stats.json: name a result folder of 'tubefoot run', or a scene file", folder.string()));
  try {
    const auto json = nlohmann::json::parse(
        read_whole(file, {file.string(), 0, 0}, most_bytes, "the stats.json of 'tubefoot run'"));
    RunRecord record{json.at("scene").get<std::string>(), json.at("scene_hash").get<std::string>(),
                     json.at("engine").get<std::string>(), json.value("arithmetic", ""),
                     json.value("binning", "")};
    for (const auto& [key, requested] :
         {std::pair{"sensor", &record.sensor}, std::pair{"pings", &record.pings},
          std::pair{"beams", &record.beams}})
      if (const auto part = json.find("selection"); part != json.end() && part->contains(key))
        *requested = part->at(key).get<std::string>();
    return record;
  } catch (const nlohmann::json::exception& error) {
    throw UsageError(
        fmt::format("'{}' is not a valid stats.json of 'tubefoot run': {}", file.string(), error.what()));
  }
}

SceneDescription described_by(const RunRecord& record, const ViewOptions& options) {
  CommonOptions common = options;
  common.scene = options.moved_scene.value_or(record.scene);
  if (!fs::exists(common.scene))
    throw UsageError(
        fmt::format("the scene file of '{}' is no longer at '{}': name its new location with --scene",
                    options.scene.string(), common.scene.string()));
  // Another person may have made the result, and its record could name any file of this machine.
  const auto elsewhere = options.moved_scene ? std::nullopt : place_outside(".", common.scene);
  if (elsewhere && options.confined)
    throw UsageError(
        fmt::format("the result '{}' names the scene file '{}' outside of the current folder, which "
                    "--confined forbids: name the scene with --scene",
                    options.scene.string(), elsewhere->string()));
  if (elsewhere)
    print_warnings({fmt::format("the result '{}' names a scene file outside of the current folder: '{}'",
                                options.scene.string(), elsewhere->string())},
                   options.quiet);
  SceneDescription description = described(common);
  if (description.sha256 != record.scene_hash)
    throw UsageError(
        fmt::format("'{0}' has changed since the run in '{1}', so the recorded picture does not match: run "
                    "the scene again, or view '{0}' itself",
                    common.scene.string(), options.scene.string()));
  if (record.engine == "tube") {
    if (!options.arithmetic && !record.arithmetic.empty()) description.run.arithmetic = record.arithmetic;
    if (!record.binning.empty()) description.run.binning = record.binning;
  }
  return description;
}

/// Returns the index in the file of each ping that the view shows. The result is shorter if the file lacks
/// pings.
std::vector<std::size_t> places_of(const ViewData& view, const SensorEchoes& echoes) {
  std::vector<std::size_t> place;
  for (const ViewPing& ping : view.pings) {
    const auto own = std::ranges::lower_bound(echoes.ping_number, double(ping.number));
    if (echoes.ping_number.empty() && ping.number < echoes.pings)
      place.push_back(ping.number);
    else if (own != echoes.ping_number.end() && *own == double(ping.number))
      place.push_back(static_cast<std::size_t>(own - echoes.ping_number.begin()));
  }
  return place;
}

/// Returns the energies of an echo file at each cell of the picture of the view.
std::vector<double> picture_in(const fs::path& file, const ViewData& view) {
  const EchoContents contents = read_echo_file(file);
  const std::string& hash = contents.provenance.scene_hash;
  if (!hash.empty() && hash != view.scene_hash)
    throw InputError(
        {file.string()},
        fmt::format("scene_hash is {}, but '{}' has {}: view the scene from which the file was computed",
                    hash, view.source, view.scene_hash));
  auto found = std::ranges::find(contents.sensors, view.sensor, &SensorEchoes::name);
  if (found == contents.sensors.end() && contents.sensors.size() == 1) found = contents.sensors.begin();
  if (found == contents.sensors.end())
    throw InputError(
        {file.string()},
        fmt::format("has no sensor '{}': choose a sensor of the file with --sensor", view.sensor));
  const std::vector<std::size_t> place = places_of(view, *found);
  if (!found->beam_number.empty() || found->beams != view.beams || found->samples != view.samples ||
      place.size() != view.pings.size())
    throw InputError(
        {file.string()},
        fmt::format("has {} pings x {} beams x {} range bins of sensor '{}', but the page shows pings {} to "
                    "{} x {} x {}: choose pings with --pings",
                    found->pings, found->beams, found->samples, found->name, view.pings.front().number,
                    view.pings.back().number, view.beams, view.samples));
  const std::size_t cells = std::size_t(view.beams) * view.samples;
  std::vector<double> picture;
  for (const std::size_t ping : place)
    picture.insert(picture.end(), found->energy.begin() + std::ptrdiff_t(ping * cells),
                   found->energy.begin() + std::ptrdiff_t((ping + 1) * cells));
  return picture;
}

/// Adds the picture of another engine to the view.
void take_candidate(const ViewOptions& options, ViewData& view) {
  view.reference_name = view.source;
  if (options.reference) {
    view.energy_j = picture_in(*options.reference, view);
    view.reference_name = options.reference->string();
    view.notes.push_back("The picture of the reference comes from " + view.reference_name +
                         "; the footprints come from the scene.");
  }
  view.candidate_name = options.candidate->string();
  view.candidate_j = picture_in(*options.candidate, view);
  const double ours = std::reduce(view.energy_j.begin(), view.energy_j.end()),
               theirs = std::reduce(view.candidate_j.begin(), view.candidate_j.end());
  const double ratio = theirs / ours;
  if (!(ratio > 0) || !std::isfinite(ratio) || (ratio <= 2 && ratio >= 0.5)) return;
  for (double& energy : view.candidate_j) energy /= ratio;
  view.notes.push_back(
      fmt::format("The total energy of the candidate differs by {:+.3g} dB; its picture is scaled to the "
                  "total of the reference.",
                  10 * std::log10(ratio)));
}

/// Replaces the picture of a view by the recorded one. Adds a note if the footprints do not explain its
/// energy.
void take_recorded(const fs::path& folder, const RunRecord& record, ViewData& view) {
  const fs::path file = folder / "echoes.nc";
  const EchoContents contents = read_echo_file(file);
  const auto found = std::find_if(contents.sensors.begin(), contents.sensors.end(),
                                  [&](const SensorEchoes& s) { return s.name == view.sensor; });
  if (record.beams)
    throw UsageError(fmt::format(
        "'{}' contains only beams {}, which do not form a picture: view a run of all beams, or '{}'",
        folder.string(), *record.beams, record.scene.string()));
  std::vector<std::size_t> place;  // a run may contain only some pings
  if (found != contents.sensors.end()) place = places_of(view, *found);
  const bool has_all = place.size() == view.pings.size();
  if (found != contents.sensors.end() && record.pings && !has_all)
    throw UsageError(
        fmt::format("'{}' contains only pings {} of each sensor: choose some of these pings with --pings",
                    folder.string(), *record.pings));
  if (found == contents.sensors.end() || found->beams != view.beams || found->samples != view.samples ||
      !has_all)
    throw UsageError(
        fmt::format("'{}' does not contain the pings of sensor '{}' of its scene: run the scene again",
                    file.string(), view.sensor));
  const std::size_t cells = std::size_t(view.beams) * view.samples;
  double total = 0, apart = 0;
  for (std::size_t p = 0; p < view.pings.size(); ++p)
    for (std::size_t c = 0; c < cells; ++c) {
      const double recorded = found->energy[place[p] * cells + c];
      double& shown = view.energy_j[p * cells + c];
      total += recorded;
      apart += std::abs(recorded - shown);
      shown = recorded;
    }
  if (record.engine != "tube")
    view.notes.push_back(
        fmt::format("The picture comes from the {} engine and the footprints from the tube engine; the "
                    "difference of their energies is {:.3g} times the energy of the picture.",
                    record.engine, total > 0 ? apart / total : 0));
  else if (apart > 1e-6 * total)
    view.notes.push_back(
        fmt::format("A fraction of {:.3g} of the picture's energy does not come from the direct echoes of "
                    "the footprints.",
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
    throw UsageError("--scene is for result folders only: leave it out for a scene file");
  std::optional<RunRecord> record;
  if (of_run) record = read_record(options.scene);
  const SceneDescription description = of_run ? described_by(*record, options) : described(options);
  Inputs inputs = inputs_of(description);
  if (of_run)
    for (const char* name : {"stats.json", "echoes.nc", list_name}) inputs.push_back(options.scene / name);
  for (const auto& file : {options.candidate, options.reference})
    if (file) inputs.push_back(*file);
  OutputFile output(options.output, inputs);
  const ThreadLimit limit(description.run.threads);
  const auto survey = open_survey(description);
  print_warnings(survey->scene.report.warnings, options.quiet);
  const std::optional<std::string> name = options.sensor || !record ? options.sensor : record->sensor;
  const std::size_t sensor = name ? survey->sensor_set->sensor_named(*name) : 0;
  std::optional<PingRange> range;
  if (options.pings) {
    range = resolved(*options.pings, survey->sensors[sensor].times_s.size());
  } else if (record && record->pings) {  // the first ping of the run
    range = resolved(*record->pings, survey->sensors[sensor].times_s.size());
    range->last = range->first;
  }

  ViewData view =
      gather_view(Transmissions(*survey, request_of(description.run)), sensor, range, options.quiet);
  view.version = TUBEFOOT_VERSION;
  view.source = options.scene.string();
  view.drawing = scene_drawing(*survey, {});
  if (has_other_paths(survey->scene))
    view.notes.push_back(
        "Footprints belong to direct echoes; mirror paths and second scattering have no footprints.");
  if (record) take_recorded(options.scene, *record, view);
  if (options.candidate) take_candidate(options, view);
  const std::string page = view_page(view);

  write_file(output.path(), page);
  output.commit();
  if (!options.quiet)
    for (const std::string& note : view.notes) tell("note: {}\n", note);
  const double megabytes = static_cast<double>(page.size()) / 1e6;
  const auto pings = static_cast<double>(view.pings.size());
  tell("wrote {} (sensor '{}', {} {}, {} footprints, {:.1f} MB{})\n", options.output.string(), view.sensor,
       view.pings.size(), view.pings.size() == 1 ? "ping" : "pings", view.footprints.size(), megabytes,
       view.pings.size() == 1 ? std::string() : fmt::format(", {:.2g} MB per ping", megabytes / pings));
  return 0;
}

}  // namespace tubefoot
