// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/scene_warnings.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "scene/idle_relief.hpp"
#include "scene/rasters/earth_place.hpp"
#include "scene/scene.hpp"
#include "scene/volume_layers.hpp"

namespace tubefoot {

void add_warnings(Scene& scene, double surface_height_m) {
  const MeshReport& mesh = scene.report.mesh;
  std::vector<std::string>& warnings = scene.report.warnings;
  if (scene.mesh.facets.empty() && scene.tiled.empty())
    warnings.push_back("the scene has no facets, so nothing returns echoes");
  if (mesh.degenerate_facets > 0) {
    warnings.push_back(
        fmt::format("{} facets have no area on the grid: they remain in the mesh, but return no echoes",
                    mesh.degenerate_facets));
  }
  if (mesh.duplicate_facets > 0) {
    warnings.push_back(
        fmt::format("{} facets coincide with an earlier facet: only the earlier facet returns echoes",
                    mesh.duplicate_facets));
  }
  if (const auto& surface = scene.description.sea_surface) {
    const MovingObject* const waves = moving_sea_surface_of(scene);
    const auto end = scene.mesh.facets.end() -
                     (waves == nullptr ? 0 : static_cast<std::ptrdiff_t>(waves->shape.facets.size()));
    const auto above = std::count_if(scene.mesh.facets.begin(), end, [&](const auto& facet) {
      return std::any_of(facet.begin(), facet.end(), [&](VertexId v) {
        return scene.grid.to_metres(scene.mesh.vertices[v]).z > surface->height_m;
      });
    });
    if (above > 0) {
      warnings.push_back(fmt::format(
          "{} facets reach above the sea surface: they end there, and the part above returns no echoes",
          above));
    }
    for (std::size_t i = 0; i < scene.tiled.size(); ++i)
      if (scene.tiled[i].tiles && scene.tiled[i].tiles->hi_m().z > surface->height_m)
        warnings.push_back(fmt::format(
            "'{}' reaches above the sea surface: it ends there, and the part above returns no echoes",
            scene.report.components[i].name));
  }
  constexpr double kCoarse_m = 1e-3;
  if (scene.grid.unit_m() > kCoarse_m && !scene.description.run.grid_exponent) {
    warnings.push_back(
        fmt::format("the scene is so large that its grid has a unit of {:.3g} m; tubefoot moved vertices by "
                    "up to {:.3g} m",
                    scene.grid.unit_m(),
                    scene.tiled.empty() ? mesh.largest_snap_m : std::sqrt(0.75) * scene.grid.unit_m()));
  }
  for (std::string& idle : idle_relief_warnings(scene)) warnings.push_back(std::move(idle));
  if (const auto warning = scale_warning(scene.frame)) warnings.push_back(*warning);
  double lowest_m = std::numeric_limits<double>::infinity();
  for (const ComponentReport& component : scene.report.components)
    lowest_m = std::min(lowest_m, component.lo_m.z);
  if (const auto warning =
          short_layers_warning(scene.description.water, scene.volume, surface_height_m, lowest_m))
    warnings.push_back(*warning);
}

}  // namespace tubefoot
