// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/gradients.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>

#include "engine/gradient/apparent_parameters.hpp"
#include "engine/gradient/bistatic_gradient.hpp"
#include "engine/gradient/certified_gradient.hpp"
#include "engine/gradient/validity.hpp"
#include "engine/paths/path_gradient.hpp"
#include "files/usage_error.hpp"
#include "geometry/numbers/scalars.hpp"
#include "run/paths.hpp"
#include "run/refraction.hpp"
#include "run/survey.hpp"
#include "run/transmission_images.hpp"
#include "scene/surfaces/scattering.hpp"

// This file converts parameters of a scene to parameters of the engine (engine/gradient/echo_gradient.hpp),
// for each transmission and sensor.

namespace tubefoot {
namespace {

glm::dvec3 axis_vector(int axis) {
  glm::dvec3 unit(0);
  unit[axis] = 1;
  return unit;
}

constexpr const char *forward_step = "gradient_forward_step", *backward_step = "gradient_backward_step";

/// `kind`: "gradient", "gradient_bound", or one of the steps.
std::string gradient_channel(const GradientParameter& parameter, const std::string& kind = "gradient") {
  return kind + "." + parameter.name;
}

std::uint16_t gradient_component(const SceneDescription& description, const GradientParameter& parameter) {
  return static_cast<std::uint16_t>(description.terrains.size() + parameter.owner);
}

}  // namespace

std::optional<EchoParameter> engine_parameter(const GradientParameter& parameter,
                                              const Transmission& transmission, std::size_t s) {
  const FacetMesh& mesh = transmission.surface_mesh().mesh();
  const Scene& scene = transmission.scene();
  const Sensor& sensor = transmission.sensor(s);
  const Pose& pose = transmission.pose();
  const bool has_axis = parameter.is_of_sonar() || parameter.is_of_object();
  const glm::dvec3 axis = axis_vector(has_axis ? parameter.axis : 0);
  if (parameter.is_of_sonar() && parameter.owner != s) return std::nullopt;
  const std::uint16_t component = gradient_component(scene.description, parameter);
  switch (parameter.kind) {
    case GradientParameter::Kind::sonar_position:
      return EchoParameter::sonar_translation(axis);
    case GradientParameter::Kind::sonar_rotation:
      return EchoParameter::sonar_rotation(pose.attitude * axis);
    case GradientParameter::Kind::mounting:
      return EchoParameter::mounting_rotation(mounting_axis(sensor, pose.attitude, parameter.axis));
    case GradientParameter::Kind::patterns:
      return EchoParameter::patterns_rotation(pose.attitude * axis);
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
    case GradientParameter::Kind::scattering:
      return EchoParameter::material_scattering(scattering_parameter(scene.description, parameter));
    case GradientParameter::Kind::sound_speed:
      if (scene.water->refracts()) return EchoParameter();
      return EchoParameter::sound_speed(scene.sound_speed_m_s);
    case GradientParameter::Kind::profile:
    case GradientParameter::Kind::profile_gradient:
      return EchoParameter();
    case GradientParameter::Kind::absorption: {
      EchoParameter by_km = EchoParameter::absorption();
      by_km.by_absorption /= 1000;
      return by_km;
    }
  }
  return std::nullopt;
}

namespace {

/// Returns the derivatives of energies in stratified water.
std::vector<std::vector<double>> refracted_derivatives(
    const Transmission& transmission, const History& history, const ReceiveBeams& beams,
    const RangeSamples& samples, const EchoModel& model,
    const std::vector<const GradientParameter*>& parameters, std::vector<EchoParameter> at_rest) {
  const Scene& scene = transmission.scene();
  const TransmissionSurface& surface = transmission.surface_mesh();
  require_one_ray(transmission, history);
  std::vector<StratifiedParameter> stratified;
  for (std::size_t k = 0; k < parameters.size(); ++k)
    stratified.push_back({std::move(at_rest[k]), sound_speed_change(*parameters[k], scene.water->profile())});
  const ApparentMap water = apparent_map_of_one(transmission);
  std::vector<std::vector<double>> derivatives =
      echo_derivatives(surface.mesh(), history, beams, samples, model,
                       apparent_parameters(stratified, *surface.apparent(), water, scene.grid, model));
  for (std::size_t k = 0; k < parameters.size(); ++k)
    require_finite(transmission, parameters[k]->name, derivatives[k]);
  return derivatives;
}

/// Returns the largest step for which the run proves that the visible polygons keep their corners.
double largest_step(const GradientParameter& parameter, const Transmission& transmission, std::size_t s) {
  return parameter.is_translation() ? transmission.tubes_of(s).reach * transmission.scene().grid.unit_m() : 1;
}

/// Adds the valid steps of parameters by beam. `engine`: the parameters of the engine in the same order.
void add_steps(const Transmission& transmission, std::size_t s,
               const std::vector<const GradientParameter*>& parameters,
               const std::vector<EchoParameter>& engine, PingSums& sums) {
  std::vector<EchoParameter> moving;
  std::vector<const GradientParameter*> names;
  std::vector<double> largest;
  for (std::size_t k = 0; k < engine.size(); ++k) {
    if (!parameters[k]->moves_points()) continue;
    moving.push_back(engine[k]);
    names.push_back(parameters[k]);
    largest.push_back(largest_step(*parameters[k], transmission, s));
  }
  const TransmissionSurface& surface = transmission.surface_mesh();
  const SensorModel model = transmission.model(s);
  const std::vector<std::uint32_t>& beam_of_tube = transmission.sensor(s).beam_of_tube(transmission.number());
  const auto steps = valid_steps(surface.mesh(), surface.tree(), transmission.tubes_of(s),
                                 transmission.scene().grid.unit_m(), transmission.request().visibility,
                                 moving, largest, wanted_tubes(transmission, sums));
  for (std::size_t k = 0; k < moving.size(); ++k) {
    std::vector<double> forward(std::size_t(transmission.beams(s)), infinite), backward = forward;
    for (std::uint32_t tube = 0; tube < steps[k].size(); ++tube) {
      const auto [first, end] = model.model.patterns != nullptr
                                    ? model.patterns.beams_of_tube[tube]
                                    : std::pair(beam_of_tube[tube], beam_of_tube[tube] + 1);
      for (std::uint32_t beam = first; beam < end; ++beam) {
        forward[beam] = std::min(forward[beam], steps[k][tube].forward);
        backward[beam] = std::min(backward[beam], steps[k][tube].backward);
      }
    }
    sums.add_to_beams(transmission, s, gradient_channel(*names[k], forward_step), forward);
    sums.add_to_beams(transmission, s, gradient_channel(*names[k], backward_step), backward);
  }
}

/// Adds the derivatives of paths over mirrors, [parameter][beam][sample].
void add_paths_to(std::vector<std::vector<double>>& derivatives, const Transmission& transmission,
                  std::size_t s, const PathSettings& settings, const ReceiveBeams& beams,
                  const EchoModel& model, const std::vector<EchoParameter>& parameters) {
  const PathEnds ends(transmission, s);
  const TransmissionSurface& surface = transmission.surface_mesh();
  try {
    const std::vector<std::vector<double>> more = path_derivatives(
        surface.mesh(), surface.tree(), transmission.scene().grid.unit_m(), transmission.request().visibility,
        ends.transmit, ends.receive, beams, transmission.samples(s), model, settings, parameters,
        [&](std::size_t order) { return is_order_wanted(transmission.scene(), order); });
    for (std::size_t k = 0; k < more.size(); ++k)
      for (std::size_t bin = 0; bin < more[k].size(); ++bin) derivatives[k][bin] += more[k][bin];
  } catch (const std::length_error& error) {
    throw too_many_images(transmission.sensor(s).description(), error);
  }
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

MaterialParameter scattering_parameter(const SceneDescription& description,
                                       const GradientParameter& parameter) {
  return {parameter.owner,
          scattering_derivative(description.materials[parameter.owner], parameter.key, parameter.axis)};
}

std::vector<double> sound_speed_change(const GradientParameter& parameter, const SoundSpeedProfile& profile) {
  if (!parameter.is_of_sound_speed()) return {};
  std::vector<double> change;
  for (const ProfilePoint& point : profile.points())
    change.push_back(parameter.kind == GradientParameter::Kind::sound_speed        ? 1
                     : parameter.kind == GradientParameter::Kind::profile_gradient ? point.depth_m
                                                                                   : 0);
  if (parameter.kind == GradientParameter::Kind::profile) change.at(std::size_t(parameter.axis)) = 1;
  return change;
}

ApparentMap apparent_map_of_one(const Transmission& transmission) {
  return apparent_map_of(transmission.loaded_scene(), transmission.pings(), transmission.number(),
                         transmission.scene().grid.to_metres(transmission.tubes().apex));
}

void require_one_ray(const Transmission& transmission, const History& history) {
  const std::vector<FactorRule>& rules = transmission.surface_mesh().apparent()->factor_rule;
  if (std::ranges::none_of(history.footprints.footprints, [&](const Footprint& footprint) {
        return footprint.piece_count > 0 && rules[footprint.facet] == FactorRule::branch;
      }))
    return;
  throw InputError(transmission.scene().description.water.place,
                   fmt::format("{} has no derivatives: several rays lead to a visible facet: leave out "
                               "--gradient, or reduce 'refraction_turns'",
                               transmission.name()));
}

void require_finite(const Transmission& transmission, const std::string& parameter,
                    std::span<const double> derivatives) {
  if (std::ranges::all_of(derivatives, [](double by) { return std::isfinite(by); })) return;
  throw InputError(
      transmission.scene().description.water.place,
      fmt::format("{} has no derivative by {}: a ray touches a caustic, or is level where it starts or ends: "
                  "move the sonar, or leave out --gradient",
                  transmission.name(), parameter));
}

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

std::vector<OutputChannel> gradient_channels(const Scene& scene, const RunRequest& request, std::size_t beams,
                                             std::size_t samples) {
  std::vector<OutputChannel> channels;
  for (const GradientParameter& parameter :
       gradient_parameters(scene.description, request.gradient, scene.water.get())) {
    const std::string meaning = "derivative of energy by the " + parameter.meaning;
    const auto add = [&](const std::string& channel, bool is_by_beam, const std::string& units,
                         const std::string& text) {
      channels.push_back(
          {channel, is_by_beam ? beams : beams * samples, 1, {{channel, units, text, true, is_by_beam}}});
    };
    add(gradient_channel(parameter), false, parameter.units, meaning);
    if (request.reference_tolerance)
      add(gradient_channel(parameter, "gradient_bound"), false, parameter.units,
          "certified bound of the " + meaning);
    if (request.gradient_steps && parameter.moves_points())
      for (const auto& [kind, sense] : {std::pair(forward_step, "increase"), {backward_step, "decrease"}})
        add(gradient_channel(parameter, kind), true, parameter.is_translation() ? "m" : "rad",
            fmt::format("proven {} of the {} without a change of visible edges and corners; 0: none is "
                        "proven, and the derivative may be one-sided",
                        sense, parameter.meaning));
  }
  return channels;
}

void require_gradients(const Survey& survey, const RunRequest& request) {
  const SceneDescription& description = survey.scene.description;
  const std::vector<GradientParameter> parameters =
      gradient_parameters(description, request.gradient, survey.scene.water.get());
  if (parameters.empty()) return;
  const std::vector<ChosenEchoes> chosen = chosen_of(survey, request.selection);
  for (std::size_t s = 0; s < chosen.size(); ++s)
    if (request.reference_tolerance && chosen[s].pings > 0 && survey.sensors[s].sensor->has_patterns())
      throw UsageError(fmt::format(
          "--gradient: sensor '{}' has beam patterns, and certified derivatives need ideal beams: leave out "
          "--reference or the patterns, or select another sensor with --sensor",
          description.sensors[s].name));
  for (std::size_t s = 0; s < chosen.size(); ++s) {
    const Sensor& sensor = *survey.sensors[s].sensor;
    const bool paths = path_settings(survey.scene, sensor.frequency_khz()).has_value();
    if (chosen[s].pings == 0 || !(paths || sensor.has_separate_receiver())) continue;
    const std::string& name = description.sensors[s].name;
    const char* legs = paths ? "paths via mirrors" : "a separate receiver";
    if (sensor.has_patterns())
      throw UsageError(
          fmt::format("--gradient: sensor '{}' has {} and beam patterns, for which there are no derivatives: "
                      "leave out the patterns, or select another sensor with --sensor",
                      name, legs));
    if (request.gradient_steps)
      throw UsageError(fmt::format(
          "--gradient-steps: sensor '{}' has {}, for which no step is proven: leave out --gradient-steps, or "
          "select another sensor with --sensor",
          name, legs));
  }
  if (request.gradient_steps && survey.scene.water->refracts())
    throw UsageError(
        "--gradient-steps: no step is proven in stratified water, where apparent positions do not move along "
        "straight lines: leave out --gradient-steps, or set profile = \"constant\"");
  const auto of_sound_speed = std::ranges::find_if(parameters, &GradientParameter::is_of_sound_speed);
  for (std::size_t s = 0; s < chosen.size(); ++s)
    for (const PatternDescription* one : {&description.sensors[s].transmit, &description.sensors[s].receive})
      if (of_sound_speed != parameters.end() && chosen[s].pings > 0 &&
          (one->pattern == "line" || one->pattern == "piston"))
        throw UsageError(fmt::format(
            "--gradient {}: the pattern \"{}\" of sensor '{}' depends on the wavelength, and there is no "
            "derivative of it: leave out this parameter, or use a pattern of the kind gaussian or table",
            of_sound_speed->name, one->pattern, description.sensors[s].name));
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

std::vector<std::string> one_sided_derivatives(const std::vector<Recording>& recordings) {
  std::vector<std::string> warnings;
  for (const Recording& recording : recordings)
    for (const RecordedVariable& forward : recording.further) {
      const std::string prefix = std::string(forward_step) + ".";
      if (!forward.meaning.name.starts_with(prefix)) continue;
      const std::string parameter = forward.meaning.name.substr(prefix.size());
      const auto backward = std::ranges::find(recording.further, backward_step + ("." + parameter),
                                              [](const RecordedVariable& of) { return of.meaning.name; });
      std::size_t zeros = 0;
      for (std::size_t ping = 0; ping < recording.pings(); ++ping) {
        const PingEnergies ahead = forward.of(ping), behind = backward->of(ping);
        for (std::size_t beam = 0; beam < forward.cells; ++beam)
          zeros += ahead[beam] == 0 || behind[beam] == 0;
      }
      if (zeros > 0)
        warnings.push_back(fmt::format(
            "sensor '{}', derivative by {}: no step is proven for {} of {} pings and beams, because the pose "
            "lies on a change of visible edges. These derivatives may be one-sided",
            recording.sensor->description().name, parameter, zeros, recording.pings() * forward.cells));
    }
  return warnings;
}

void add_gradients(const EchoContribution& plan, const Transmission& transmission, PingSums& sums) {
  const std::vector<GradientParameter> all = gradient_parameters(
      transmission.scene().description, transmission.request().gradient, transmission.scene().water.get());
  const bool direct = is_order_wanted(transmission.scene(), 1),
             separate = transmission.has_separate_receiver();
  const std::optional<BistaticHistory> both =
      direct && separate ? std::optional(transmission.trace_both()) : std::nullopt;
  const History* one = separate || !direct ? nullptr : &traced(transmission, sums);
  const FacetMesh& mesh = transmission.surface_mesh().mesh();
  for (const std::size_t s : plan.sensors) {
    if (sums.chosen(s).pings == 0) continue;
    std::vector<const GradientParameter*> own_parameters;
    std::vector<std::string> channels, bounds;
    std::vector<EchoParameter> parameters;
    for (const GradientParameter& parameter : all)
      if (auto own = engine_parameter(parameter, transmission, s)) {
        own_parameters.push_back(&parameter);
        channels.push_back(gradient_channel(parameter));
        bounds.push_back(gradient_channel(parameter, "gradient_bound"));
        parameters.push_back(std::move(*own));
      }
    sums.as_echo([&] {
      const SensorModel model = transmission.model(s);
      const std::vector<std::uint32_t> fans = transmission.sensor(s).fan_of_tube(transmission.number());
      const EchoModel& echo_model = model.model;
      const ReceiveBeams beams = transmission.beams_by_fans(s, fans);
      const RangeSamples samples = transmission.samples(s);
      if (transmission.request().gradient_steps) add_steps(transmission, s, own_parameters, parameters, sums);
      if (!plan.tolerance) {
        std::vector<std::vector<double>> derivatives(
            parameters.size(), std::vector<double>(std::size_t(beams.count) * std::size_t(samples.count)));
        if (both) derivatives = echo_derivatives(mesh, *both, beams, samples, echo_model, parameters);
        if (one)
          derivatives = transmission.surface_mesh().apparent() != nullptr
                            ? refracted_derivatives(transmission, *one, beams, samples, echo_model,
                                                    own_parameters, parameters)
                            : echo_derivatives(mesh, *one, beams, samples, echo_model, parameters);
        if (const auto paths = path_settings(transmission, s))
          add_paths_to(derivatives, transmission, s, *paths, beams, echo_model, parameters);
        for (std::size_t k = 0; k < channels.size(); ++k)
          sums.add_to_channel(transmission, s, channels[k], 0, derivatives[k]);
        return;
      }
      const CertifiedDerivatives derivatives =
          certified_derivatives(mesh, *one, beams, samples, without_null_lists(echo_model), parameters);
      for (std::size_t k = 0; k < channels.size(); ++k) {
        sums.add_to_channel(transmission, s, channels[k], 0, derivatives.value[k]);
        sums.add_to_channel(transmission, s, bounds[k], 0, derivatives.bound[k]);
      }
    });
  }
}

}  // namespace tubefoot
