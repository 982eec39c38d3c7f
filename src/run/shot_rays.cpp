// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/shot_rays.hpp"

#include <algorithm>
#include <cmath>

#include "engine/law/echo_law.hpp"

namespace tubefoot {
namespace {

/// Tells pings of a survey apart.
std::uint64_t label_of(const Shot& shot) {
  std::uint64_t label = shot.ping();
  for (const SharedShots& group : shot.survey().shots) {
    if (&group == &shot.group()) break;
    label += shot.survey().fleet->pings(group);
  }
  return label + (std::uint64_t(shot.number()) << 40);
}

}  // namespace

RaySettings rays_of(const Shot& shot) {
  RaySettings settings = shot.request().rays;
  settings.seed += 0x9e3779b97f4a7c15u * label_of(shot);
  return settings;
}

RayGuide guide_of(const Shot& shot) {
  const std::vector<std::size_t>& sensors = shot.group().sensors;
  const std::size_t s = *std::min_element(sensors.begin(), sensors.end(), [&](std::size_t a, std::size_t b) {
    return shot.sensor(a).samples().step_m < shot.sensor(b).samples().step_m;
  });
  const Scene& scene = shot.scene();
  const RangeSamples samples = shot.sensor(s).samples();
  RayGuide guide{samples.first_m, samples.step_m, samples.count,
                 absorption_per_m(absorption_db_per_m(scene, shot.sensor(s)))};
  const double slant = std::sqrt(0.5);
  for (std::size_t m = 0; m < scene.material_mu.size(); ++m)
    guide.material_strength.push_back(m < scene.scattering.size() && scene.scattering[m] != nullptr
                                          ? 2 * scene.scattering[m]->cross_section(slant, slant)
                                          : scene.material_mu[m]);
  if (shot.has_receiver_apart()) guide.receiver_m = shot.receiver_pose().position_m - shot.pose().position_m;
  return guide;
}

}  // namespace tubefoot
