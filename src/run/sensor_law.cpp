// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/sensor_law.hpp"

#include <algorithm>

namespace tubefoot {

SensorLaw::SensorLaw(const Survey& survey, const ShotGround& ground, std::size_t sensor, std::size_t ping,
                     std::size_t shot) {
  const Scene& scene = survey.scene;
  const SensorPings& pings = survey.sensors[sensor];
  law = {scene.material_mu, ground.mesh().material, absorption_db_per_m(scene, *pings.sensor)};
  law.reflectivity = scene.reflectivity;
  law.scattering = scene.scattering;
  law.apex_m = scene.grid.to_metres(scene.grid.snap(pings.shot_pose(ping, shot).position_m));
  if (ground.apparent() != nullptr) {
    law.facet_factor = ground.apparent()->facet_factor;
    if (std::any_of(scene.reflectivity.begin(), scene.reflectivity.end(),
                    [](const auto& texture) { return texture != nullptr; })) {
      facet_maps = ground.apparent()->facet_maps(law.apex_m, scene.grid);
      law.facet_map = facet_maps;
    }
  }
  if (!pings.sensor->has_patterns()) return;
  patterns = pings.sensor->patterns(pings.shot_pose(ping, shot), pings.sound_speed_m_s, shot);
  law.patterns = &patterns;
}

}  // namespace tubefoot
