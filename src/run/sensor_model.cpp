// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/sensor_model.hpp"

#include <algorithm>

#include "run/transmission.hpp"

namespace tubefoot {

SensorModel::SensorModel(const Transmission& transmission, const TransmissionSurface& surface_mesh,
                         std::size_t sensor) {
  const Scene& scene = transmission.scene();
  const SensorPings& pings = transmission.survey().sensors[sensor];
  model = {scene.material_mu, surface_mesh.mesh().material, absorption_db_per_m(scene, *pings.sensor)};
  model.reflectivity = scene.reflectivity;
  model.scattering = scene.scattering;
  model.path.tx.apex_m = scene.grid.to_metres(
      scene.grid.snap(pings.transmission_pose(transmission.ping(), transmission.number()).position_m));
  if (surface_mesh.apparent() != nullptr) {
    model.path.facet_factor = surface_mesh.apparent()->facet_factor;
    if (transmission.labels() != nullptr ||
        std::any_of(scene.reflectivity.begin(), scene.reflectivity.end(),
                    [](const auto& texture) { return texture != nullptr; })) {
      facet_maps = surface_mesh.apparent()->facet_maps(model.path.tx.apex_m, scene.grid);
      model.path.tx.facet_map = facet_maps;
    }
  }
  if (!pings.sensor->has_patterns()) return;
  patterns = pings.sensor->patterns(pings.transmission_pose(transmission.ping(), transmission.number()),
                                    pings.sound_speed_m_s, transmission.number());
  model.patterns = &patterns;
  if (surface_mesh.apparent() == nullptr || patterns.baselines.empty()) return;
  // Phases depend on the sound speed at the receiver pair, but ranges are computed with the sound speed at
  // the sensor's first position.
  const double depth_m = scene.water->surface_height_m() -
                         pings.transmission_pose(transmission.ping(), transmission.number()).position_m.z;
  for (ReceiverBaseline& baseline : patterns.baselines)
    baseline.baseline_m *= pings.sound_speed_m_s / scene.water->profile().at(depth_m);
}

}  // namespace tubefoot
