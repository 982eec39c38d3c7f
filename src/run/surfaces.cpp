// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/surfaces.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "run/transmission_surface.hpp"
#include "run/tube_pyramid.hpp"

namespace tubefoot {
namespace {

double farthest2(const GridPoint& apex, const GridPoint& lo, const GridPoint& hi) {
  const auto along = [](double apex_at, double from, double to) {
    const double away = std::max(std::abs(from - apex_at), std::abs(to - apex_at));
    return away * away;
  };
  return along(apex.x, lo.x, hi.x) + along(apex.y, lo.y, hi.y) + along(apex.z, lo.z, hi.z);
}

/// Returns the distance of the farthest point of any facet in a tube, in grid units. The result lies between
/// `at_least` and `enough`.
double farthest_surface(const TransmissionSurface& surface, const TubeSet& tubes, std::size_t tube,
                        double at_least, double enough) {
  TubePyramid pyramid(tubes, tube);
  const FacetMesh& mesh = surface.mesh();
  double farthest = at_least;
  std::vector<FacetId> met;
  const auto look = [&] {
    for (const FacetId facet : met)
      for (const glm::dvec3& corner : pyramid.part_of(mesh, facet))
        farthest = std::max(farthest, glm::length(corner));
    met.clear();
  };
  surface.tree().query(
      [&](const GridPoint& lowest, const GridPoint& highest) {
        // evaluates the facets of the previous box; boxes nearer than the result so far are not opened
        look();
        return farthest < enough && farthest2(tubes.apex, lowest, highest) > farthest * farthest &&
               pyramid.may_meet(lowest, highest);
      },
      met);
  look();
  return std::min(farthest, enough);
}

}  // namespace

bool surfaces_are_known(const Survey& survey, std::size_t sensor) {
  return !survey.scene.water->refracts() && !survey.loaded_scene->is_tiled() &&
         !survey.sensors[sensor].sensor->has_separate_receiver();
}

std::vector<int> samples_with_surfaces(const Survey& survey, std::size_t sensor, std::size_t ping,
                                       std::span<const double> energy) {
  const SensorPings& pings = survey.sensors[sensor];
  const Sensor& sonar = *pings.sensor;
  const RangeSamples& samples = sonar.samples();
  const auto count = static_cast<std::size_t>(samples.count);
  const double unit_m = survey.scene.grid.unit_m();
  std::vector<int> all(sonar.beams().size(), 0);
  for (std::size_t b = 0; b < all.size(); ++b) {
    const std::span<const double> beam = energy.subspan(b * count, count);
    const auto last = std::find_if(beam.rbegin(), beam.rend(), [](double e) { return e > 0; });
    all[b] = static_cast<int>(beam.rend() - last);
  }
  for (std::size_t transmission = 0; transmission < sonar.transmissions(); ++transmission) {
    const std::vector<std::uint32_t>& beams = sonar.beams_of_transmission(transmission);
    if (std::ranges::all_of(beams, [&](std::uint32_t b) { return all[b] == samples.count; })) continue;
    const TubeSet tubes =
        sonar.tubes(pings.transmission_pose(ping, transmission), survey.scene.grid, transmission);
    const std::vector<std::uint32_t>& beam_of_tube = sonar.beam_of_tube(transmission);
    const TransmissionSurface surface =
        surface_at(*survey.loaded_scene, pings.times_s[ping] + sonar.transmission_delay_s(transmission));
    for (std::size_t t = 0; t < tubes.tubes.size(); ++t) {
      int& with_surface = all[beams[beam_of_tube[t]]];
      if (with_surface == samples.count) continue;
      const double known_m = samples.first_m + with_surface * samples.step_m,
                   end_m = samples.first_m + samples.count * samples.step_m;
      const double far_m = farthest_surface(surface, tubes, t, known_m / unit_m, end_m / unit_m) * unit_m;
      with_surface =
          std::clamp(static_cast<int>(std::ceil((far_m - samples.first_m) / samples.step_m - 1e-9)),
                     with_surface, samples.count);
    }
  }
  return all;
}

}  // namespace tubefoot
