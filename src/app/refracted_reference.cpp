// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/refracted_reference.hpp"

#include <algorithm>
#include <cmath>

#include "app/refraction.hpp"
#include "app/sensor_law.hpp"
#include "engine/tube_engine.hpp"

namespace tubefoot {
namespace {

constexpr int most_tries = 3;
constexpr double most_facets = 200'000;  // some minutes a shot

RefractedShot certify(const Survey& survey, const SharedShots& group, std::size_t ping, std::size_t shot,
                      const VisibilityOptions& options, double tolerance,
                      const StraighteningSettings& settings) {
  const Scene& scene = survey.scene;
  RefractedShot found{refracted_ground_of(survey, group, ping, shot, settings), {}, 0, {}};
  const FacetMesh& mesh = found.ground.mesh();
  const double unit = scene.grid.unit_m();
  const TubeEngine engine(mesh, found.ground.tree(), unit, options);
  found.history = engine.trace(survey.tubes(group, ping, shot), &found.candidates, false);
  const glm::dvec3 apex = scene.grid.to_metres(found.history.tubes.apex);
  for (const std::size_t s : group.sensors) {
    const SensorPings& pings = survey.sensors[s];
    const Straightening straightening = straightening_of(survey, pings, apex);
    const RayEnclosure rays(straightening, eigenray_options(survey));
    const SensorLaw sensor_law(survey, found.ground, s, ping, shot);
    const EchoLaw& law = sensor_law.law;
    const Sensor& sensor = *pings.sensor;
    const ApparentEnclosures enclosures =
        enclose(*found.ground.apparent(), scene.mesh, scene.grid, rays, straightening.reference_speed_m_s(),
                law.material_mu, law.absorption_db_per_m);
    const Echo echo =
        integrate_echo(found.history, sensor.beam_of_tube(shot),
                       static_cast<int>(sensor.beams_of_shot(shot).size()), sensor.samples(), law);
    found.sensors.push_back(certify_refracted_echo(
        mesh, found.ground.tree(), found.ground.apparent()->refined.parent, enclosures, rays, found.history,
        options, sensor.beam_of_tube(shot), sensor.samples(), law, echo, tolerance));
  }
  return found;
}

}  // namespace

RefractedShot certify_refracted_shot(const Survey& survey, const SharedShots& group, std::size_t ping,
                                     std::size_t shot, const VisibilityOptions& options, double tolerance) {
  const double unit = survey.scene.grid.unit_m(), sample = sample_length_m(survey, group),
               reach_m = survey.tubes(group, ping, shot).reach * unit;
  // The scene's own keys are for ordinary runs. What is left between straight and curved shrinks with the
  // gap, and the change of a factor over a facet with its edges.
  StraighteningSettings settings = straightening_settings(survey, group, reach_m);
  settings.gap_m = std::min(settings.gap_m, std::max(tolerance * sample / 16, 2 * unit));
  settings.tolerance_db = std::min(settings.tolerance_db, 2 * tolerance);
  settings.shortest_edge_m = std::max({sample / 16, reach_m / 20000, 64 * unit});
  RefractedShot best = certify(survey, group, ping, shot, options, tolerance, settings);
  for (int tries = 1; tries < most_tries; ++tries) {
    double excess = 0;
    for (const RefractedReference& sensor : best.sensors)
      excess = std::max(excess, sensor.certified.worst_ratio);
    const double room = std::sqrt(most_facets / std::max(double(best.ground.mesh().facets.size()), 1.0));
    if (!(excess > 1) || room < 1.5) break;
    const double finer = std::min(1.3 * excess, room);
    settings.gap_m /= finer;
    settings.tolerance_db /= finer;
    RefractedShot next = certify(survey, group, ping, shot, options, tolerance, settings);
    const auto worst = [](const RefractedShot& found) {
      double ratio = 0;
      for (const RefractedReference& sensor : found.sensors)
        ratio = std::max(ratio, sensor.certified.worst_ratio);
      return ratio;
    };
    const bool worth_more = worst(next) < 0.8 * worst(best);
    if (worst(next) < worst(best)) best = std::move(next);
    if (!worth_more) break;
  }
  return best;
}

}  // namespace tubefoot
