// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/gradients.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <stdexcept>

#include "engine/gradient/certified_gradient.hpp"
#include "files/usage_error.hpp"
#include "geometry/numbers/scalars.hpp"
#include "run/survey.hpp"

// This file converts parameters of a scene to parameters of the engine (engine/gradient/echo_gradient.hpp),
// for each transmission and sensor.

namespace tubefoot {
namespace {

glm::dvec3 axis_vector(int axis) {
  glm::dvec3 unit(0);
  unit[axis] = 1;
  return unit;
}

/// `kind`: "gradient" or "gradient_bound".
std::string gradient_channel(const GradientParameter& parameter, const std::string& kind = "gradient") {
  return kind + "." + parameter.name;
}

std::uint16_t gradient_component(const SceneDescription& description, const GradientParameter& parameter) {
  return static_cast<std::uint16_t>(description.terrains.size() + parameter.owner);
}

/// Returns the engine's parameter for the energies of a sensor. Empty if they do not depend on it.
std::optional<EchoParameter> engine_parameter(const GradientParameter& parameter,
                                              const Transmission& transmission, std::size_t s,
                                              const FacetMesh& mesh) {
  const Scene& scene = transmission.scene();
  const Sensor& sensor = transmission.sensor(s);
  const Pose& pose = transmission.pose();
  const glm::dvec3 axis = axis_vector(parameter.axis);
  if (parameter.is_of_sonar() && parameter.owner != s) return std::nullopt;
  const std::uint16_t component = gradient_component(scene.description, parameter);
  switch (parameter.kind) {
    case GradientParameter::Kind::sonar_position:
      return EchoParameter::sonar_translation(axis);
    case GradientParameter::Kind::sonar_rotation:
      return EchoParameter::sonar_rotation(pose.attitude * axis);
    case GradientParameter::Kind::mounting:
      return EchoParameter::sonar_rotation(mounting_axis(sensor, pose.attitude, parameter.axis));
    case GradientParameter::Kind::object_position:
      return EchoParameter::object_translation(mesh, component, axis);
    case GradientParameter::Kind::object_rotation: {
      const Pose& object = scene.report.components[component].pose;
      const glm::dvec3 apex_m = scene.grid.to_metres(transmission.tubes_of(s).apex);
      return EchoParameter::object_rotation(mesh, component, object.attitude * axis,
                                            object.position_m - apex_m);
    }
    case GradientParameter::Kind::mu:
      return EchoParameter::material_mu(parameter.owner, scene.material_mu.size());
    case GradientParameter::Kind::sound_speed:
      return EchoParameter::sound_speed(scene.sound_speed_m_s);
    case GradientParameter::Kind::absorption: {
      EchoParameter by_km = EchoParameter::absorption();
      by_km.by_absorption /= 1000;
      return by_km;
    }
  }
  return std::nullopt;
}

/// Returns the model without lists that contain nothing, which certified_derivatives() rejects.
EchoModel without_null_lists(EchoModel model) {
  const auto clear = [](auto& list) {
    if (std::ranges::all_of(list, [](const auto& one) { return one == nullptr; })) list = {};
  };
  clear(model.reflectivity);
  clear(model.scattering);
  return model;
}

}  // namespace

glm::dvec3 mounting_axis(const Sensor& sensor, const glm::dquat& attitude, int angle) {
  // attitude = carrier * turn(-yaw, z) turn(-tilt, x) turn(roll, y): see attitude_from_angles().
  const SensorDescription& d = sensor.description();
  const glm::dquat yaw = attitude_from_angles(d.yaw_deg * degree, 0, 0),
                   tilted = attitude_from_angles(d.yaw_deg * degree, -d.tilt_deg * degree, 0);
  const glm::dvec3 of_carrier = angle == 0   ? glm::dvec3(0, 0, -1)
                                : angle == 1 ? yaw * glm::dvec3(-1, 0, 0)
                                             : tilted * glm::dvec3(0, 1, 0);
  return attitude * (glm::conjugate(sensor.mounting()) * of_carrier);
}

std::vector<OutputChannel> gradient_channels(const SceneDescription& description, const RunRequest& request,
                                             std::size_t cells) {
  std::vector<OutputChannel> channels;
  for (const GradientParameter& parameter : gradient_parameters(description, request.gradient)) {
    const std::string name = gradient_channel(parameter);
    const std::string meaning = "derivative of energy by the " + parameter.meaning;
    channels.push_back({name, cells, 1, {{name, parameter.units, meaning, true}}});
    if (!request.reference_tolerance) continue;
    const std::string bound = gradient_channel(parameter, "gradient_bound");
    channels.push_back(
        {bound, cells, 1, {{bound, parameter.units, "certified bound of the " + meaning, true}}});
  }
  return channels;
}

void require_gradients(const Survey& survey, const RunRequest& request) {
  const SceneDescription& description = survey.scene.description;
  const std::vector<GradientParameter> parameters = gradient_parameters(description, request.gradient);
  if (parameters.empty()) return;
  const std::vector<ChosenEchoes> chosen = chosen_of(survey, request.selection);
  for (std::size_t s = 0; s < chosen.size(); ++s)
    if (request.reference_tolerance && chosen[s].pings > 0 && survey.sensors[s].sensor->has_patterns())
      throw UsageError(fmt::format(
          "--gradient: sensor '{}' has beam patterns, and certified derivatives need ideal beams: leave out "
          "--reference or the patterns, or select another sensor with --sensor",
          description.sensors[s].name));
  const bool by_sound_speed = std::ranges::find(parameters, GradientParameter::Kind::sound_speed,
                                                &GradientParameter::kind) != parameters.end();
  for (std::size_t s = 0; s < chosen.size(); ++s)
    for (const PatternDescription* one : {&description.sensors[s].transmit, &description.sensors[s].receive})
      if (by_sound_speed && chosen[s].pings > 0 && (one->pattern == "line" || one->pattern == "piston"))
        throw UsageError(fmt::format(
            "--gradient water.sound_speed: the pattern \"{}\" of sensor '{}' depends on the wavelength, and "
            "there is no derivative of it: leave out this parameter, or use a pattern of the kind "
            "gaussian or table",
            one->pattern, description.sensors[s].name));
  if (survey.loaded_scene->is_tiled()) return;
  for (const GradientParameter& parameter : parameters) {
    if (!parameter.is_of_object()) continue;
    const std::uint16_t component = gradient_component(description, parameter);
    const FacetMesh& mesh = survey.scene.mesh;
    try {
      EchoParameter::object_translation(mesh, component, {0, 0, 1});
    } catch (const std::invalid_argument&) {
      throw UsageError(
          fmt::format("--gradient {}: object '{}' has a vertex in common with another component, so that it "
                      "cannot move alone: move it by more than the grid unit of {:.2g} m",
                      parameter.name, description.objects[parameter.owner].name, survey.scene.grid.unit_m()));
    }
  }
}

void add_gradients(const EchoContribution& plan, const Transmission& transmission, PingSums& sums) {
  const std::vector<GradientParameter> all =
      gradient_parameters(transmission.scene().description, transmission.request().gradient);
  const History& history = traced(transmission, sums);
  const FacetMesh& mesh = transmission.surface_mesh().mesh();
  for (const std::size_t s : plan.sensors) {
    if (sums.chosen(s).pings == 0) continue;
    std::vector<std::string> channels, bounds;
    std::vector<EchoParameter> parameters;
    for (const GradientParameter& parameter : all)
      if (auto own = engine_parameter(parameter, transmission, s, mesh)) {
        channels.push_back(gradient_channel(parameter));
        bounds.push_back(gradient_channel(parameter, "gradient_bound"));
        parameters.push_back(std::move(*own));
      }
    sums.as_echo([&] {
      const SensorModel model = transmission.model(s);
      const std::vector<std::uint32_t> fans = transmission.sensor(s).fan_of_tube(transmission.number());
      const EchoModel& echo_model = model.model;
      const ReceiveBeams beams = transmission.beams_by_fans(s, fans);
      const RangeSamples& samples = transmission.sensor(s).samples();
      if (!plan.tolerance) {
        const auto derivatives = echo_derivatives(mesh, history, beams, samples, echo_model, parameters);
        for (std::size_t k = 0; k < channels.size(); ++k)
          sums.add_to_channel(transmission, s, channels[k], 0, derivatives[k]);
        return;
      }
      const CertifiedDerivatives derivatives =
          certified_derivatives(mesh, history, beams, samples, without_null_lists(echo_model), parameters);
      for (std::size_t k = 0; k < channels.size(); ++k) {
        sums.add_to_channel(transmission, s, channels[k], 0, derivatives.value[k]);
        sums.add_to_channel(transmission, s, bounds[k], 0, derivatives.bound[k]);
      }
    });
  }
}

}  // namespace tubefoot
