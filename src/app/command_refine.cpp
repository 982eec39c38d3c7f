// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <utility>

#include "app/commands.hpp"
#include "files/atomic_output.hpp"
#include "run/console/say.hpp"
#include "run/refined_surface_file.hpp"
#include "run/settings.hpp"
#include "run/transmission_surface.hpp"

namespace tubefoot {

int refine_command(const RefineOptions& options) {
  const SceneDescription description = described(options);
  Inputs inputs = description.inputs;
  if (description.refinement.file)
    std::erase(inputs, *description.refinement.file);  // this command writes that file
  OutputFile output(options.output, inputs);
  const ThreadLimit limit(description.run.threads);
  Scene loaded = load_scene(description);
  const Scene scene = loaded.tiled.empty() ? std::move(loaded) : with_tiles(loaded, all_tiles(loaded));
  print_warnings(scene.report.warnings, options.quiet);
  const std::unique_ptr<SurfaceMesh> surface_mesh = relief_surface(scene, scene.mesh);
  const RefinedMesh seabed = refined_seabed(scene, *surface_mesh);
  write_refined_seabed(output.path(), seabed, scene, *surface_mesh);
  output.commit();
  tell("wrote {} ({} facets from {})\n", options.output.string(), seabed.mesh.facets.size(),
       scene.mesh.facets.size());
  return 0;
}

}  // namespace tubefoot
