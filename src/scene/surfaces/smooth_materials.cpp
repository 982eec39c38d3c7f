// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/surfaces/smooth_materials.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "files/input_error.hpp"
#include "scene/description/scene_description.hpp"

namespace tubefoot {

std::vector<std::optional<SmoothSurface>> load_smooth_surfaces(const SceneDescription& scene,
                                                               std::vector<std::string>& warnings) {
  const bool are_received = std::ranges::any_of(
      scene.sensors, [](const SensorDescription& sensor) { return sensor.kind.section().receives_phases(); });
  std::vector<std::optional<SmoothSurface>> surfaces;
  for (const MaterialDescription& m : scene.materials) {
    std::optional<SmoothSurface>& surface = surfaces.emplace_back();
    if (!m.smooth) continue;
    surface = SmoothSurface{.reflection = m.reflection, .roughness_m = m.roughness_m};
    if (m.fluid) surface->fluid = fluid_sediment((*m.fluid)[0], (*m.fluid)[1], (*m.fluid)[2]);
    if (m.grain_size_phi) surface->fluid = sediment_of_grain_size(*m.grain_size_phi);
    if (!are_received && !scene.sensors.empty())
      warnings.push_back(fmt::format(
          "material '{}' is smooth, but no sensor records signals: its energies follow its scattering model",
          m.name));
  }
  if (!are_received && !scene.sensors.empty() && scene.scatterers.place.line > 0)
    warnings.push_back(
        fmt::format("{}: [scatterers] has no effect, because no sensor records signals (kind = \"array\")",
                    to_string(scene.scatterers.place)));
  return surfaces;
}

}  // namespace tubefoot
