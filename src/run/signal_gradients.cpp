// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/signal_gradients.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <optional>
#include <set>

#include "run/gradients.hpp"
#include "run/paths.hpp"
#include "run/signals.hpp"
#include "run/stored_pings.hpp"
#include "run/survey.hpp"

// This file selects the sensors whose signals have derivatives, and computes these for each transmission.

namespace tubefoot {
namespace {

constexpr std::string_view energy_unit = "J m-2";  // at the start of GradientParameter::units

bool moves_signals(const GradientParameter& parameter) {
  return parameter.moves_points() || parameter.kind == GradientParameter::Kind::sound_speed ||
         parameter.kind == GradientParameter::Kind::absorption;
}

std::vector<GradientParameter> parameters_of_signals(const Survey& survey, const RunRequest& request) {
  std::vector<GradientParameter> all =
      gradient_parameters(survey.scene.description, request.gradient, survey.scene.water.get());
  std::erase_if(all, [](const GradientParameter& parameter) { return !moves_signals(parameter); });
  return all;
}

std::string channel_of_signals(const GradientParameter& parameter) {
  return "signals_gradient." + parameter.name;
}

/// Returns the smooth surfaces of the scene's facets, by material.
std::map<std::uint16_t, const SmoothSurface*> smooth_surfaces(const Scene& scene) {
  std::map<std::uint16_t, const SmoothSurface*> surfaces;
  for (const std::uint16_t material : std::set(scene.mesh.material.begin(), scene.mesh.material.end()))
    if (const SmoothSurface* surface = scene.smooth_surface(material)) surfaces.emplace(material, surface);
  return surfaces;
}

/// Returns the reason why the signals of a sensor have no derivatives.
std::optional<std::string> obstacle(const Survey& survey, std::size_t s, const RunRequest& request) {
  const Sensor& sensor = *survey.sensors[s].sensor;
  const Scene& scene = survey.scene;
  const SignalModel& model = *sensor.signals();
  if (request.reference_tolerance) return "there are no certified derivatives of signals";
  if (path_settings(scene, sensor.frequency_khz())) return "the sensor has paths via mirrors";
  if (sensor.has_separate_receiver()) return "the sensor has a separate receiver";
  if (model.own_views) return "each element has its own visibility";
  if (sensor.has_patterns()) return "the sensor has beam patterns";
  if (!model.stop_and_hop && !scene.trajectories[scene.sensor_trajectory[s]].is_fixed())
    return "the sensor moves during a ping";
  if (!(model.waveform.taper > 0)) return "the waveform has no flanks: set 'pulse_taper' above 0";
  for (const auto& [material, surface] : smooth_surfaces(scene))
    if (surface->fluid || surface->roughness_m > 0)
      return fmt::format("the smooth material '{}' is a fluid or has 'roughness_m'",
                         scene.description.materials[material].name);
  return std::nullopt;
}

bool has_signal_gradients(const Survey& survey, std::size_t s, const RunRequest& request) {
  return !request.gradient.empty() && survey.sensors[s].sensor->signals() != nullptr &&
         !smooth_surfaces(survey.scene).empty() && !obstacle(survey, s, request);
}

}  // namespace

std::vector<OutputChannel> signal_gradient_channels(const Survey& survey, std::size_t s,
                                                    const RunRequest& request) {
  std::vector<OutputChannel> channels;
  if (!has_signal_gradients(survey, s, request)) return channels;
  const SignalModel& model = *survey.sensors[s].sensor->signals();
  for (const GradientParameter& parameter : parameters_of_signals(survey, request))
    channels.push_back(
        {channel_of_signals(parameter), 2 * model.array.receivers_m.size() * model.sampling.samples, 1, {}});
  return channels;
}

std::vector<std::string> missing_signal_gradients(const Survey& survey, const RunRequest& request) {
  std::vector<std::string> warnings;
  if (request.gradient.empty() || survey.loaded_scene->is_tiled() || smooth_surfaces(survey.scene).empty())
    return warnings;
  const std::vector<ChosenEchoes> chosen = chosen_of(survey, request.selection);
  for (std::size_t s = 0; s < survey.sensors.size(); ++s) {
    if (chosen[s].pings == 0 || survey.sensors[s].sensor->signals() == nullptr) continue;
    if (const auto reason = obstacle(survey, s, request))
      warnings.push_back(
          fmt::format("sensor '{}': energies have derivatives, but signals have none, because {}",
                      survey.sensors[s].sensor->description().name, *reason));
  }
  return warnings;
}

std::vector<SignalRecording::Derivative> recorded_signal_gradients(const Survey& survey, std::size_t s,
                                                                   const std::shared_ptr<PingStore>& store) {
  std::vector<SignalRecording::Derivative> all;
  for (const GradientParameter& parameter :
       gradient_parameters(survey.scene.description, survey.scene.water.get()))
    if (RecordedChannel channel = recorded_channel(store, s, channel_of_signals(parameter));
        !channel.is_empty())
      all.push_back({parameter.name, "W^(1/2)" + parameter.units.substr(energy_unit.size()),
                     "derivative of pressure by the " + parameter.meaning, std::move(channel)});
  return all;
}

void add_signal_gradients(const EchoContribution& plan, const Transmission& transmission, PingSums& sums) {
  const Survey& survey = transmission.survey();
  const RunRequest& request = transmission.request();
  for (const std::size_t s : plan.sensors) {
    if (sums.chosen(s).pings == 0 || !has_signal_gradients(survey, s, request)) continue;
    std::vector<std::string> channels;
    std::vector<EchoParameter> parameters;
    for (const GradientParameter& parameter : parameters_of_signals(survey, request))
      if (auto own = engine_parameter(parameter, transmission, s)) {
        channels.push_back(channel_of_signals(parameter));
        parameters.push_back(std::move(*own));
      }
    const History& history = traced(transmission, sums);
    sums.as_echo([&] {
      const std::vector<ChannelSignals> derivatives =
          signal_derivatives(transmission, s, history, parameters);
      for (std::size_t n = 0; n < channels.size(); ++n)
        sums.add_to_signals(s, channels[n], parts_of(derivatives[n].value));
    });
  }
}

}  // namespace tubefoot
