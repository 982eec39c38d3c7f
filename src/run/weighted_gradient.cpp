// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/weighted_gradient.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numeric>

#include "engine/gradient/apparent_parameters.hpp"
#include "engine/gradient/bistatic_gradient.hpp"
#include "engine/paths/path_gradient.hpp"
#include "files/usage_error.hpp"
#include "geometry/numbers/grid_vector.hpp"
#include "geometry/steps/stop.hpp"
#include "run/abilities.hpp"
#include "run/gradients.hpp"
#include "run/paths.hpp"
#include "run/transmission_images.hpp"

// This file sums reverse-mode gradients over transmissions. Derivatives by points become derivatives by
// poses: a translation of the apex moves all vertices the opposite way, and a rotation turns all rays.

namespace tubefoot {
namespace {

void check_weights(const Survey& survey, const std::vector<std::span<const double>>& weights) {
  for (std::size_t s = 0; s < weights.size(); ++s) {
    const SensorPings& pings = survey.sensors[s];
    const std::size_t beams = pings.sensor->beams().size(),
                      samples = std::size_t(pings.sensor->samples().count);
    const std::string& name = pings.sensor->description().name;
    if (weights[s].empty()) continue;
    if (weights[s].size() != pings.times_s.size() * beams * samples)
      throw UsageError(
          fmt::format("weights of sensor '{}': {} numbers, expected {} x {} x {} (pings, beams, range bins)",
                      name, weights[s].size(), pings.times_s.size(), beams, samples));
    const auto bad = std::ranges::find_if_not(weights[s], [](double w) { return std::isfinite(w); });
    if (bad == weights[s].end()) continue;
    const auto at = std::size_t(bad - weights[s].begin());
    throw UsageError(
        fmt::format("weights of sensor '{}': ping {}, beam {}, range bin {} is {}, expected a finite number",
                    name, at / (beams * samples), at / samples % beams, at % samples, *bad));
  }
}

/// Returns the weights of a transmission, [beam of the transmission][range bin].
std::vector<double> weights_of(const Transmission& transmission, std::size_t s, std::span<const double> all) {
  const Sensor& sensor = transmission.sensor(s);
  const auto samples = std::size_t(sensor.samples().count);
  const std::span<const double> ping =
      all.subspan(transmission.ping() * sensor.beams().size() * samples, sensor.beams().size() * samples);
  std::vector<double> own;
  for (const std::uint32_t beam : sensor.beams_of_transmission(transmission.number())) {
    const std::span<const double> row = ping.subspan(beam * samples, samples);
    own.insert(own.end(), row.begin(), row.end());
  }
  return own;
}

/// History of a transmission with one apex or with a separate receiver.
struct SeenByEnds {
  std::optional<History> one;
  std::optional<BistaticHistory> two;

  explicit SeenByEnds(const Transmission& transmission) {
    if (transmission.has_separate_receiver())
      two = transmission.trace_both();
    else
      one = transmission.trace(nullptr, false);
  }
};

glm::dvec3 by_rotation_of(const std::vector<GridPoint>& rays, const std::vector<glm::dvec3>& by_ray) {
  glm::dvec3 sum(0);
  for (std::size_t k = 0; k < by_ray.size(); ++k)
    sum += glm::cross(glm::dvec3(rays[k].x, rays[k].y, rays[k].z), by_ray[k]);
  return sum;
}

/// Rays of an EchoGradient, and the receive apex relative to the transmit apex.
struct GradientRays {
  const std::vector<GridPoint>& transmit;
  const std::vector<GridPoint>* receive = nullptr;  ///< null: one apex
  glm::dvec3 receiver_m{0};

  explicit GradientRays(const SeenByEnds& seen)
      : transmit(seen.two ? seen.two->shared.transmit_rays : seen.one->footprints.name_rays) {
    if (!seen.two) return;
    receive = &seen.two->shared.receive_rays;
    receiver_m = seen.two->shared.receiver_m;
  }
  GradientRays(const PathEnds& ends, double unit_m)
      : transmit(ends.transmit.rays),
        receive(&ends.receive.rays),
        receiver_m(displacement_m(ends.transmit.apex, ends.receive.apex, unit_m)) {}
};

/// Adds the gradient of a transmission's energies to those of its sensor and scene.
void add_echo_gradient(const Transmission& transmission, std::size_t s, const GradientRays& rays,
                       const EchoGradient& echo, WeightedGradient& sum) {
  const Scene& scene = transmission.scene();
  const FacetMesh& mesh = scene.mesh;
  glm::dvec3 by_all_vertices(0), by_rotation = echo.by_pattern_rotation, by_turned_receiver(0);
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    if (echo.by_vertex[v] == glm::dvec3(0)) continue;
    sum.by_vertex[v] += echo.by_vertex[v];
    by_all_vertices += echo.by_vertex[v];
  }
  by_rotation += by_rotation_of(rays.transmit, echo.by_ray);
  if (rays.receive != nullptr) {
    by_rotation += by_rotation_of(*rays.receive, echo.by_receive_ray);
    by_turned_receiver = glm::cross(rays.receiver_m, echo.by_receiver);
  }
  for (std::size_t m = 0; m < echo.by_material_mu.size(); ++m) sum.by_mu[m] += echo.by_material_mu[m];
  sum.by_sound_speed += (echo.by_range_scale - 2 * echo.by_roughness) / scene.sound_speed_m_s;
  sum.by_absorption += echo.by_absorption / 1000;
  const Sensor& sensor = transmission.sensor(s);
  const glm::dquat& attitude = transmission.pose().attitude;
  WeightedGradient::OfSonar& sonar = sum.sonars[s];
  sonar.by_patterns[transmission.ping()] += glm::conjugate(attitude) * echo.by_pattern_rotation;
  sonar.by_position[transmission.ping()] += echo.by_apex - by_all_vertices;
  sonar.by_rotation[transmission.ping()] += glm::conjugate(attitude) * (by_rotation + by_turned_receiver);
  for (int k = 0; k < 3; ++k) {
    if (!sensor.description().look_at_m)
      sonar.by_mounting[transmission.ping()][k] += glm::dot(mounting_axis(sensor, attitude, k), by_rotation);
  }
}

/// Parameters of the sound speed in stratified water.
struct ProfileParameters {
  std::vector<GradientParameter> parameters;

  explicit ProfileParameters(const Scene& scene) {
    if (!scene.water->refracts()) return;
    parameters = gradient_parameters(scene.description, scene.water.get());
    std::erase_if(parameters,
                  [](const GradientParameter& parameter) { return !parameter.is_of_sound_speed(); });
  }
  /// `by_point`: derivatives by the sound speeds of the points of the profile.
  void add(const std::vector<double>& by_point, const SoundSpeedProfile& profile,
           WeightedGradient& sum) const {
    for (const GradientParameter& parameter : parameters) {
      if (parameter.kind == GradientParameter::Kind::profile) {
        sum.by_profile[parameter.name] += by_point.at(std::size_t(parameter.axis));
        continue;
      }
      const std::vector<double> change = sound_speed_change(parameter, profile);
      (parameter.kind == GradientParameter::Kind::sound_speed ? sum.by_sound_speed
                                                              : sum.by_profile[parameter.name]) +=
          std::inner_product(change.begin(), change.end(), by_point.begin(), 0.0);
    }
  }
};

/// Returns the derivatives by vertices of the scene from those by vertices of a refined mesh. These keep
/// their places on the facets of the scene.
std::vector<glm::dvec3> by_base_vertex(const FacetMesh& base, const RefinedMesh& refined,
                                       const std::vector<glm::dvec3>& by_vertex) {
  std::vector<glm::dvec3> sum(base.vertices.size(), glm::dvec3(0));
  std::vector<bool> done(by_vertex.size());
  for (std::size_t f = 0; f < refined.mesh.facets.size(); ++f)
    for (std::size_t k = 0; k < 3; ++k) {
      const VertexId v = refined.mesh.facets[f][k];
      if (done[v]) continue;
      done[v] = true;
      const auto [second, third] = refined.weights[f][k];
      const std::array<VertexId, 3>& corners = base.facets[refined.parent[f]];
      const std::int64_t weights[]{whole_weight - second - third, second, third};
      for (std::size_t c = 0; c < 3; ++c)
        if (weights[c] != 0) sum[corners[c]] += double(weights[c]) / double(whole_weight) * by_vertex[v];
    }
  return sum;
}

/// Converts the gradient of an apparent surface to one by the vertices of the scene. `sum` receives the
/// derivatives by the profile.
EchoGradient of_true_positions(const Transmission& transmission, EchoGradient echo, const EchoModel& model,
                               const ProfileParameters& profile,
                               std::span<const MaterialParameter> scattering, WeightedGradient& sum) {
  const Scene& scene = transmission.scene();
  const ApparentSurface& surface = *transmission.surface_mesh().apparent();
  const StratifiedGradient by =
      stratified_gradient(echo, surface, apparent_map_of_one(transmission), scene.grid, model, scattering);
  echo.by_vertex = by_base_vertex(scene.mesh, surface.refined, by.by_vertex);
  // The definition of EchoGradient::by_apex has all points at rest relative to the apex.
  echo.by_apex = by.by_apex;
  for (const glm::dvec3& of_vertex : echo.by_vertex) echo.by_apex += of_vertex;
  require_finite(transmission, "the vertices of the scene", {&echo.by_apex.x, 3});
  require_finite(transmission, "water.absorption", {&by.by_absorption, 1});
  echo.by_absorption = by.by_absorption;
  echo.by_scattering = by.by_scattering;
  echo.by_range_scale = 0;
  profile.add(by.by_sound_speed, scene.water->profile(), sum);
  return echo;
}

/// Sums derivatives by vertices to derivatives by the poses of objects.
void add_objects(const Scene& scene, const FacetMesh& mesh, WeightedGradient& sum) {
  constexpr std::uint32_t none = 0xffffffff, several = 0xfffffffe;
  std::vector<std::uint32_t> component(mesh.vertices.size(), none);
  for (std::size_t f = 0; f < mesh.facets.size(); ++f)
    for (const VertexId v : mesh.facets[f])
      component[v] = component[v] == none || component[v] == mesh.component[f] ? mesh.component[f] : several;
  const std::size_t terrains = scene.description.terrains.size();
  sum.objects.resize(scene.description.objects.size());
  for (std::size_t f = 0; f < mesh.facets.size(); ++f)
    for (const VertexId v : mesh.facets[f])
      if (mesh.component[f] >= terrains && component[v] == several)
        sum.objects[mesh.component[f] - terrains].moves_alone = false;
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    if (component[v] >= several || component[v] < terrains) continue;
    WeightedGradient::OfObject& object = sum.objects[component[v] - terrains];
    const Pose& pose = scene.report.components[component[v]].pose;
    const glm::dvec3 turn =
        glm::cross(scene.grid.to_metres(mesh.vertices[v]) - pose.position_m, sum.by_vertex[v]);
    object.by_position += sum.by_vertex[v];
    object.by_rotation += glm::conjugate(pose.attitude) * turn;
  }
}

}  // namespace

WeightedGradient weighted_gradient(const Survey& survey, RunRequest request,
                                   const std::vector<std::span<const double>>& weights, RunWatch* watch) {
  request.gradient = {"water.absorption"};  // marks the request for the checks below
  request.visibility.corner_names = true;
  require_able_to_run(survey, request);
  require_gradients(survey, request);
  if (survey.loaded_scene->is_tiled())
    throw UsageError(
        "gradient: the terrain is loaded in tiles, so that its vertices are not in memory: set "
        "load = \"whole\"");
  check_weights(survey, weights);
  const Transmissions transmissions(survey, request);
  const FacetMesh& mesh = survey.scene.mesh;
  WeightedGradient sum;
  sum.by_vertex.assign(mesh.vertices.size(), glm::dvec3(0));
  sum.by_mu.assign(survey.scene.material_mu.size(), 0);
  for (const SensorPings& pings : survey.sensors) {
    const std::vector<glm::dvec3> zeros(pings.times_s.size(), glm::dvec3(0));
    sum.sonars.push_back({zeros, zeros, zeros, zeros});
  }
  const ProfileParameters profile(survey.scene);
  std::vector<std::string> names;
  std::vector<MaterialParameter> scattering;
  for (const GradientParameter& parameter :
       gradient_parameters(survey.scene.description, survey.scene.water.get()))
    if (parameter.kind == GradientParameter::Kind::scattering) {
      names.push_back(parameter.name);
      scattering.push_back(scattering_parameter(survey.scene.description, parameter));
      sum.by_scattering[parameter.name] = 0;
    }
  // Transmissions are summed in their order, so that the result does not depend on the number of threads. The
  // tubes of each one are traced in parallel.
  if (watch != nullptr)
    for (const SharedTransmissions& group : survey.transmissions)
      watch->total += survey.sensor_set->pings(group);
  for (const SharedTransmissions& group : survey.transmissions)
    for (std::size_t ping = 0; ping < survey.sensor_set->pings(group); ++ping) {
      for (std::size_t number = 0; number < survey.sensor_set->transmissions_per_ping(group); ++number) {
        stop_if_wanted();
        const Transmission transmission = transmissions.of(group, ping, number);
        std::optional<SeenByEnds> seen;
        for (const std::size_t s : group.sensors) {
          if (s >= weights.size() || weights[s].empty()) continue;
          const SensorModel model = transmission.model(s);
          const std::vector<std::uint32_t> fans = transmission.sensor(s).fan_of_tube(number);
          const ReceiveBeams beams = transmission.beams_by_fans(s, fans);
          const RangeSamples& samples = transmission.sensor(s).samples();
          const std::vector<double> own_weights = weights_of(transmission, s, weights[s]);
          const auto add = [&](const GradientRays& rays, const EchoGradient& echo) {
            for (std::size_t k = 0; k < names.size(); ++k)
              sum.by_scattering[names[k]] += echo.by_scattering[k];
            add_echo_gradient(transmission, s, rays, echo, sum);
          };
          if (is_order_wanted(survey.scene, 1)) {
            if (!seen) seen.emplace(transmission);
            const auto gradient_of = [&](const auto& history) {
              return echo_gradient(transmission.surface_mesh().mesh(), history, beams, samples, model.model,
                                   own_weights, scattering);
            };
            EchoGradient echo = seen->two ? gradient_of(*seen->two) : gradient_of(*seen->one);
            if (transmission.surface_mesh().apparent() != nullptr) {
              require_one_ray(transmission, *seen->one);
              echo = of_true_positions(transmission, std::move(echo), model.model, profile, scattering, sum);
            }
            add(GradientRays(*seen), echo);
          }
          if (const auto paths = path_settings(transmission, s)) {
            const PathEnds ends(transmission, s);
            const auto gradient = [&] {
              try {
                return path_gradient(transmission.surface_mesh().mesh(), transmission.surface_mesh().tree(),
                                     survey.scene.grid.unit_m(), request.visibility, ends.transmit,
                                     ends.receive, beams, samples, model.model, *paths, own_weights,
                                     scattering,
                                     [&](std::size_t order) { return is_order_wanted(survey.scene, order); });
              } catch (const std::length_error& error) {
                throw too_many_images(transmission.sensor(s).description(), error);
              }
            };
            add(GradientRays(ends, survey.scene.grid.unit_m()), gradient());
          }
        }
      }
      if (watch != nullptr) ++watch->pings;
    }
  add_objects(survey.scene, mesh, sum);
  return sum;
}

}  // namespace tubefoot
