// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <string_view>

#include "app/commands.hpp"
#include "exchange/readers/scene_readers.hpp"
#include "files/atomic_output.hpp"
#include "files/usage_error.hpp"
#include "run/console/say.hpp"

namespace tubefoot {
namespace {

void say_notes(const ImportSceneOptions& options, const std::vector<std::string>& notes) {
  if (!options.quiet)
    for (const std::string& line : notes) say("{}\n", line);
}

/// Appends the folders of the environment variables in which Gazebo looks for models.
std::vector<std::filesystem::path> search_path(std::vector<std::filesystem::path> folders) {
  for (const char* variable : {"GZ_SIM_RESOURCE_PATH", "SDF_PATH", "GAZEBO_MODEL_PATH"})
    if (const char* value = std::getenv(variable); value != nullptr) {
      const std::string_view text = value;
      for (std::size_t at = 0; at < text.size();) {
        const std::size_t end = std::min(text.find(':', at), text.size());
        if (end > at) folders.emplace_back(text.substr(at, end - at));
        at = end + 1;
      }
    }
  return folders;
}

int import_line(const ImportSceneOptions& options) {
  if (!options.model_path.empty() || options.unit_m)
    throw UsageError("--model-path and --unit-m apply to worlds of other engines, not to a survey line");
  const KmallSurvey line = read_kmall_survey(options.world, false);
  Inputs inputs = line.inputs();
  if (options.kmall.material_table) inputs.push_back(*options.kmall.material_table);
  OutputFolder output(options.output, inputs);
  const KmallSceneReport report = write_kmall_scene(line, options.kmall, output.staging());
  output.commit();
  say_notes(options, report.notes);
  tell("wrote {} ({} sensors, {} pings; {} notes)\n", (options.output / "scene.toml").string(),
       report.sensors, report.pings, report.notes.size());
  return 0;
}

}  // namespace

int import_scene_command(const ImportSceneOptions& options) {
  if (is_kmall_name(options.world)) return import_line(options);
  if (options.kmall != KmallSceneOptions())
    throw UsageError(
        "--seabed, --cell-m, --receive-shading and --material-table apply to survey lines (.kmall) only");
  ImportedScene scene = read_world(options.world, search_path(options.model_path), options.unit_m);
  Inputs inputs{options.world};
  inputs.insert(inputs.end(), scene.inputs.begin(), scene.inputs.end());
  OutputFolder output(options.output, inputs);
  write_imported_scene(scene, output.staging());
  output.commit();
  say_notes(options, scene.noticed);
  tell("wrote {} ({} objects, {} sonars; {} notes)\n", (options.output / "scene.toml").string(),
       scene.objects.size(), scene.sensors.size(), scene.noticed.size());
  return 0;
}

}  // namespace tubefoot
