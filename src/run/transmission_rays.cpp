// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/transmission_rays.hpp"

#include <algorithm>
#include <cmath>

#include "engine/scattering/echo_model.hpp"

namespace tubefoot {
namespace {

/// Returns a number that distinguishes the pings and transmissions of a survey.
std::uint64_t label_of(const Transmission& transmission) {
  std::uint64_t label = transmission.ping();
  for (const SharedTransmissions& group : transmission.survey().transmissions) {
    if (&group == &transmission.group()) break;
    label += transmission.survey().sensor_set->pings(group);
  }
  return label + (std::uint64_t(transmission.number()) << 40);
}

}  // namespace

RaySettings rays_of(const Transmission& transmission) {
  RaySettings settings = transmission.request().rays;
  settings.seed += 0x9e3779b97f4a7c15u * label_of(transmission);
  return settings;
}

RayGuide guide_of(const Transmission& transmission) {
  const std::vector<std::size_t>& sensors = transmission.group().sensors;
  const std::size_t s = *std::min_element(sensors.begin(), sensors.end(), [&](std::size_t a, std::size_t b) {
    return transmission.sensor(a).samples().step_m < transmission.sensor(b).samples().step_m;
  });
  const Scene& scene = transmission.scene();
  const RangeSamples samples = transmission.samples(s);
  RayGuide guide{samples.first_m, samples.step_m, samples.count,
                 absorption_per_m(absorption_db_per_m(scene, transmission.sensor(s), transmission.number()))};
  const double slant = std::sqrt(0.5);
  for (std::size_t m = 0; m < scene.material_mu.size(); ++m)
    guide.material_strength.push_back(m < scene.scattering.size() && scene.scattering[m] != nullptr
                                          ? 2 * scene.scattering[m]->cross_section(slant, slant)
                                          : scene.material_mu[m]);
  if (transmission.has_separate_receiver())
    guide.receiver_m = transmission.receiver_pose().position_m - transmission.pose().position_m;
  return guide;
}

}  // namespace tubefoot
