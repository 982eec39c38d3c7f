// SPDX-License-Identifier: GPL-3.0-or-later
// Labels of bins from rays: elevation and material of the echoes, and near objects that shade bins.
#include "compare/attribution/bin_labels.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "compare/measures/median.hpp"
#include "engine/rays/ray_engine.hpp"
#include "geometry/steps/stop.hpp"
#include "run/console/progress.hpp"
#include "run/paths.hpp"
#include "run/transmission_rays.hpp"

namespace tubefoot {
namespace {

constexpr double degrees_per_radian = 57.29577951308232, least_share = 0.9;
constexpr std::int64_t rays_per_sample = 20, fewest_rays = 4000;

/// Elevations at which the rays of a beam meet an object.
struct SeenElevations {
  double low = 90, high = -90;
};

/// Sums over the rays of one ping, by beam and sample.
struct LabelSums {
  std::vector<double> energy, elevation;
  std::vector<std::map<std::uint16_t, double>> of_material;
  std::vector<std::map<std::uint16_t, SeenElevations>> near;  ///< by beam
};

void add_label_rays(const Transmission& transmission, std::size_t s, LabelSums& sums) {
  const Sensor& sensor = transmission.sensor(s);
  const RangeSamples& samples = sensor.samples();
  const auto count = static_cast<std::size_t>(samples.count);
  const RaySurface rays(transmission);
  const glm::dvec3 up = transmission.pose().attitude * glm::dvec3(0, 0, 1);
  const FacetMesh& mesh = transmission.surface_mesh().mesh();
  History history{transmission.tubes(), transmission.scene().grid.unit_m(), {}, {}};
  const std::vector<std::uint32_t>& beam_of_tube = sensor.beam_of_tube(transmission.number());
  const std::vector<std::uint32_t>& beams = sensor.beams_of_transmission(transmission.number());
  const std::int64_t rays_per_beam = std::max(rays_per_sample * samples.count, fewest_rays);
  trace_rays(*rays, history, {RaySampling::stratified, rays_per_beam, RaySettings::Per::beam, 1},
             beam_of_tube, [&] {
               for (const RayHit hit : history.hits) {
                 const std::size_t beam = beams[beam_of_tube[hit.tube]];
                 const double sine = std::clamp(glm::dot(glm::dvec3(hit.direction), up), -1.0, 1.0),
                              elevation = degrees_per_radian * std::asin(sine),
                              place = std::floor((hit.slant_range_m - samples.first_m) / samples.step_m);
                 if (place < 0) {
                   SeenElevations& seen = sums.near[beam][mesh.component[hit.facet]];
                   seen = {std::min(seen.low, elevation), std::max(seen.high, elevation)};
                 }
                 if (!(place >= 0 && place < samples.count)) continue;
                 const std::size_t bin = beam * count + static_cast<std::size_t>(place);
                 const double weight = hit.solid_angle_sr * hit.sine_grazing;
                 sums.energy[bin] += weight;
                 sums.elevation[bin] += weight * elevation;
                 sums.of_material[bin][mesh.material[hit.facet]] += weight;
               }
             });
}

/// Median elevation of the echoes of each sample; NaN for samples without echoes.
std::vector<double> elevations_of_rows(const LabelSums& sums, std::size_t samples) {
  std::vector<std::vector<double>> rows(samples);
  for (std::size_t bin = 0; bin < sums.energy.size(); ++bin)
    if (sums.energy[bin] > 0) rows[bin % samples].push_back(sums.elevation[bin] / sums.energy[bin]);
  std::vector<double> medians;
  for (auto& row : rows) medians.push_back(row.empty() ? NAN : median_of(std::move(row)));
  return medians;
}

}  // namespace

SceneLabels bin_labels(const SceneAtHand& scene, const SensorEchoes& reference,
                       const std::function<bool(std::size_t ping)>& is_wanted, bool quiet) {
  const SensorPlace place = scene.place_of(reference);
  const Survey& survey = scene.survey();
  const Sensor& sensor = *survey.sensors[place.sensor].sensor;
  SceneLabels labels;
  if (sensor.has_separate_receiver() || sensor.has_receiver_pair() ||
      path_settings(survey.scene, sensor.frequency_khz()))
    return labels;
  for (const ComponentReport& component : survey.scene.report.components)
    labels.object_names.push_back(component.name);
  for (const MaterialDescription& material : survey.scene.description.materials)
    labels.material_names.push_back(material.name);
  const std::size_t samples = reference.samples, bins = reference.beams * samples;
  labels.elevation_deg.assign(reference.pings * bins, NAN);
  labels.material.assign(reference.pings * bins, SceneLabels::none);
  labels.near_caster.assign(reference.pings * bins, SceneLabels::none);
  const Transmissions transmissions(survey, RunRequest{});
  TransmissionsAround around(transmissions);
  Progress progress("pings", reference.pings, quiet);
  for (std::size_t ping = 0; ping < reference.pings; ++ping) {
    stop_if_wanted();
    progress.step();
    if (!is_wanted(ping)) continue;
    const Transmissions& near =
        around.at(survey.sensor_set->transmissions_of(place.sensor), place.pings[ping]);
    const std::size_t all = sensor.beams().size() * samples;
    LabelSums sums{std::vector<double>(all), std::vector<double>(all),
                   std::vector<std::map<std::uint16_t, double>>(all),
                   std::vector<std::map<std::uint16_t, SeenElevations>>(sensor.beams().size())};
    for (std::size_t number = 0; number < sensor.transmissions(); ++number)
      add_label_rays(near.received_by(place.sensor, place.pings[ping], number), place.sensor, sums);
    const std::vector<double> of_row = elevations_of_rows(sums, samples);
    for (std::size_t k = 0; k < bins; ++k) {
      const std::size_t beam = place.beams[k / samples], in_scene = beam * samples + k % samples,
                        bin = ping * bins + k;
      if (const double energy = sums.energy[in_scene]; energy > 0) {
        labels.elevation_deg[bin] = static_cast<float>(sums.elevation[in_scene] / energy);
        for (const auto& [material, part] : sums.of_material[in_scene])
          if (part > least_share * energy) labels.material[bin] = material;
      }
      if (reference.energy[bin] > 0) continue;
      for (const auto& [object, seen] : sums.near[beam])
        if (const double elevation = of_row[k % samples]; elevation >= seen.low && elevation <= seen.high)
          labels.near_caster[bin] = object;
    }
  }
  return labels;
}

}  // namespace tubefoot
