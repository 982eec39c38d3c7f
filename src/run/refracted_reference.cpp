// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/refracted_reference.hpp"

#include <algorithm>
#include <cmath>

#include "engine/sight/tube_engine.hpp"
#include "run/refraction.hpp"
#include "run/sensor_law.hpp"

namespace tubefoot {
namespace {

constexpr int most_tries = 6;
constexpr double most_facets = 24'000;  // of the last try: some half a minute of one core
constexpr double coarsest = 0.1;        // tolerance that the first try is made for
constexpr double least_worth = 1.2;

RefractedShot certify(const Shot& shot, const ShotStraightening& seen, ApparentGround apparent) {
  const Scene& scene = shot.scene();
  const VisibilityOptions& options = shot.request().visibility;
  const std::vector<FacetId> parent = apparent.refined.parent;
  seen.bed().name_by_scene(apparent);
  RefractedShot found{ShotGround(shot.site(), std::move(apparent)), {}, 0, {}, false};
  const FacetMesh& mesh = found.ground.mesh();
  const StraightenedBed bed{*found.ground.apparent(), found.ground.tree(), seen.bed().mesh(), parent,
                            scene.grid};
  const TubeEngine engine(mesh, found.ground.tree(), scene.grid.unit_m(), options);
  found.history = engine.trace(shot.tubes(), &found.candidates, false);
  const glm::dvec3 apex = scene.grid.to_metres(found.history.tubes.apex);
  for (const std::size_t s : shot.group().sensors) {
    const Straightening straightening = straightening_of(shot.site(), shot.survey().sensors[s], apex);
    const RayEnclosure rays(straightening, eigenray_options(shot.site()));
    const SensorLaw sensor_law(shot, found.ground, s);
    const EchoLaw& law = sensor_law.law;
    const Sensor& sensor = shot.sensor(s);
    found.sensors.push_back(certify_refracted_echo(
        bed, rays, found.history, options, sensor.beam_of_tube(shot.number()), sensor.samples(), law,
        shot.echo(found.history, s, law), *shot.request().reference_tolerance));
  }
  return found;
}

/// Bins of a finite bound, those of them that are wider than asked, and how much the middle one of those is.
struct Quality {
  std::size_t bins = 0, over = 0;
  double usual_excess = 0;
};
Quality quality_of(const RefractedShot& shot) {
  Quality quality;
  for (const RefractedReference& sensor : shot.sensors) {
    quality.bins += sensor.bins;
    quality.over += sensor.bins_over;
    quality.usual_excess = std::max(quality.usual_excess, sensor.usual_excess);
  }
  return quality;
}

}  // namespace

RefractedShot certify_refracted_shot(const Shot& shot) {
  const double unit = shot.scene().grid.unit_m(), sample = shot.sample_length_m(),
               reach_m = shot.tubes().reach * unit, tolerance = *shot.request().reference_tolerance;
  // The scene's own keys are for ordinary runs. What is left between straight and curved shrinks with the
  // gap, and the change of a factor over a facet with its edges. The first ground is coarse: how many facets
  // a tolerance takes is known only from what it has.
  const double first = std::max(tolerance, coarsest);
  StraighteningSettings settings = straightening_settings(shot, reach_m);
  settings.gap_m = std::min(settings.gap_m, std::max(first * sample / 16, 2 * unit));
  settings.tolerance_db = std::min(settings.tolerance_db, 2 * first);
  settings.shortest_edge_m = std::max({sample / 16, reach_m / 20000, 64 * unit});
  const ShotStraightening seen(shot);
  RefractedShot best = certify(shot, seen, seen.ground(settings));
  for (int tries = 1;; ++tries) {
    const Quality quality = quality_of(best);
    // Slivers at a beam's ends are wider than asked with any ground.
    if (quality.over * 200 <= quality.bins) break;
    // Facets grow as the square at most, where it is spreading that they are cut for.
    const double room = std::sqrt(most_facets / std::max(double(best.ground.mesh().facets.size()), 1.0));
    if (room < least_worth || tries == most_tries) {
      best.at_limit = true;
      break;
    }
    const double finer = std::clamp(1.3 * quality.usual_excess, least_worth, room);
    settings.gap_m = std::max(settings.gap_m / finer, 2 * unit);
    settings.tolerance_db /= finer;
    ApparentGround ground = seen.ground(settings);
    const std::size_t facets = ground.refined.mesh.facets.size(),
                      facets_before = best.ground.mesh().facets.size();
    // Where it was about as fine as that already, the next one is to be finer than it is.
    const bool hardly_finer = double(facets) < least_worth * double(facets_before);
    if (hardly_finer) settings.gap_m = std::min(settings.gap_m, std::max(ground.largest_gap_m, 2 * unit));
    if (facets == facets_before) continue;
    RefractedShot next = certify(shot, seen, std::move(ground));
    const Quality found = quality_of(next);
    const bool worth_more = double(found.over) * least_worth < double(quality.over) ||
                            found.usual_excess * least_worth < quality.usual_excess;
    if (worth_more || found.over <= quality.over) best = std::move(next);
    if (worth_more || hardly_finer) continue;
    best.at_limit = true;
    break;
  }
  return best;
}

}  // namespace tubefoot
