// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include "app/commands.hpp"
#include "exchange/readers/scene_readers.hpp"
#include "files/atomic_output.hpp"
#include "run/console/say.hpp"

namespace tubefoot {

int import_scene_command(const ImportSceneOptions& options) {
  const ImportedScene scene = read_world(options.world, options.model_path);
  Inputs inputs{options.world};
  inputs.insert(inputs.end(), scene.inputs.begin(), scene.inputs.end());
  OutputFolder output(options.output, inputs);
  write_imported_scene(scene, output.staging());
  output.commit();
  if (!options.quiet)
    for (const std::string& line : scene.noticed) say("{}\n", line);
  tell("wrote {} ({} objects, {} sonars; {} notes)\n", (options.output / "scene.toml").string(),
       scene.objects.size(), scene.sensors.size(), scene.noticed.size());
  return 0;
}

}  // namespace tubefoot
