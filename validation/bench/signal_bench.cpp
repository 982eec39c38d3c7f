// SPDX-License-Identifier: GPL-3.0-or-later
// Cost of element signals over the survey scene (docs/signals.md). Measures processor seconds as a function
// of elements, polygons and bandwidth. Compares them with the direct sum over the same scatterers.
//
//     tubefoot_signal_bench [reach in metres] [most elements] [direct: 0 or 1]
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <numbers>
#include <string>
#include <utility>

#include "engine/signal/coherent_signals.hpp"
#include "engine/signal/surface_scatterers.hpp"
#include "engine/visibility/tube_engine.hpp"
#include "geometry/numbers/scalars.hpp"
#include "scene/scene.hpp"
#include "sensors/kinds/scene_file.hpp"
#include "timing.hpp"

namespace tubefoot {
namespace {

constexpr double carrier_hz = 100e3, sound_speed = 1500, wavelength = sound_speed / carrier_hz;

/// Returns elements half a wavelength apart along x that look along y.
CoherentReceiver array_of(int elements, double bandwidth_hz, glm::dvec3 place_m, double reach_m) {
  CoherentReceiver receiver;
  for (int k = 0; k < elements; ++k)
    receiver.channels.push_back(
        {place_m, place_m + glm::dvec3((k - 0.5 * (elements - 1)) * wavelength / 2, 0, 0)});
  // The band ends at amplitudes of 1e-3 of the peak.
  receiver.pulse = gaussian_pulse(std::sqrt(-2 * std::log(1e-3)) / (std::numbers::pi * bandwidth_hz), 1e-3);
  receiver.times = {0, 1.25 * bandwidth_hz, std::size_t(2 * reach_m / sound_speed * 1.25 * bandwidth_hz)};
  receiver.carrier_hz = carrier_hz;
  receiver.sound_speed_m_s = sound_speed;
  return receiver;
}

/// Returns the receiver on a vehicle that moves along y and turns.
CoherentReceiver on_the_way(CoherentReceiver receiver, double speed_m_s, double rad_s) {
  const glm::dvec3 middle = receiver.channels[0].transmit_m;
  const auto way = [&](glm::dvec3 place_m) -> PlatformMotion {
    return [=, lever = place_m - middle](double t) {
      const double turn = rad_s * t;
      return middle + glm::dvec3(std::cos(turn) * lever.x - std::sin(turn) * lever.y,
                                 std::sin(turn) * lever.x + std::cos(turn) * lever.y + speed_m_s * t,
                                 lever.z);
    };
  };
  for (SignalChannel& channel : receiver.channels) {
    channel.transmit_motion = way(channel.transmit_m);
    channel.receive_motion = way(channel.receive_m);
  }
  return receiver;
}

struct Place {
  VisiblePolygons seen;
  EchoModel model;
};

double spacing_for(double bandwidth_hz) {
  return surface_spacing_m(bandwidth_hz, wavelength, sound_speed, 60 * degree);
}

/// Sums the contribution of each scatterer to each element directly.
ChannelSignals direct_sum(const Place& place, const CoherentReceiver& receiver, const SurfaceField& field,
                          std::size_t& scatterers) {
  ChannelSignals all{receiver.channels.size(), receiver.times.count, {}};
  all.value.assign(all.channels * all.samples, 0);
  const PulseTable table(receiver.pulse, receiver.times);
  const double k = 2 * std::numbers::pi * receiver.carrier_hz / receiver.sound_speed_m_s;
  std::vector<ChannelOnPolygon> on;
  std::vector<glm::dvec3> corners;
  for (const VisiblePolygon& patch : place.seen.patches) {
    on.clear();
    for (const SignalChannel& channel : receiver.channels)
      on.emplace_back(channel, place.seen, patch, place.model);
    corners.clear();
    for (const glm::dvec3& c : place.seen.corners(patch)) corners.push_back(c + place.seen.origin_m);
    field.for_scatterers(corners, patch.normal, [&](glm::dvec3 at, std::complex<double> z) {
      ++scatterers;
      for (std::size_t c = 0; c < on.size(); ++c) {
        const ChannelOnPolygon::Reception received = on[c].at(at - place.seen.origin_m);
        table.add(z * std::polar(received.amplitude, k * received.path_m),
                  received.path_m / receiver.sound_speed_m_s, &all.value[c * all.samples]);
      }
    });
  }
  return all;
}

void compare(const char* what, const ChannelSignals& signals, const ChannelSignals& truth) {
  double difference = 0, power = 0;
  for (std::size_t k = 0; k < truth.value.size(); ++k) {
    difference += std::norm(signals.value[k] - truth.value[k]);
    power += std::norm(truth.value[k]);
  }
  fmt::print("  {}: rms error {:.1e} of the rms signal\n", what, std::sqrt(difference / power));
}

/// Large polygons: a flat seabed 10 m below the sonar.
Place flat_seabed(glm::dvec3 apex) {
  static const std::vector<double> mu{0.01};
  static const std::vector<std::uint16_t> material{0};
  Place place;
  place.model.material_mu = mu;
  place.model.material = material;
  place.model.path.tx.apex_m = place.seen.origin_m = apex;
  place.seen.corners_m = {{-20, 8, -10}, {-20, 28, -10}, {20, 28, -10}, {20, 8, -10}};
  place.seen.patches = {{0, {0, 0, 1}, 10, 0, 4, 0, 0}};
  return place;
}

void run(double reach_m, int most_elements, bool direct) {
  const Scene scene =
      load_scene(read_scene_file(std::filesystem::path(TUBEFOOT_SCENES) / "survey/scene.toml"));
  const SceneTree tree(scene.mesh);
  TubeSet tubes;
  tubes.apex = scene.grid.snap({0, -20, -8});
  tubes.reach = reach_m / scene.grid.unit_m();
  AngularGrid grid;
  for (int k = 0; k <= 60; ++k) grid.azimuth_edges_rad.push_back((k - 30) * degree);
  for (int k = 0; k <= 24; ++k) grid.elevation_edges_rad.push_back((-75 + 3 * k) * degree);
  grid.frame = glm::dmat3(glm::dvec3(0, 1, 0), glm::dvec3(1, 0, 0), glm::dvec3(0, 0, 1));
  append_tubes(tubes, grid);
  const glm::dvec3 apex = scene.grid.to_metres(tubes.apex);
  History history;
  const double visibility_s =
      seconds([&] { history = TubeEngine(scene.mesh, tree, scene.grid.unit_m(), {}).trace(tubes); });
  Place place;
  place.model.material_mu = scene.material_mu;
  place.model.material = scene.mesh.material;
  place.model.path.tx.apex_m = apex;
  place.seen = visible_polygons(history, place.model);
  fmt::print("survey scene, {} m: {} polygons, {:.0f} m2, {:.2f} s for the common visibility\n", reach_m,
             place.seen.patches.size(), place.seen.area_m2(), visibility_s);

  ChannelSignals signals;
  const auto measure = [&](const Place& of, const CoherentReceiver& receiver, double bandwidth,
                           double tolerance) {
    const SurfaceField field{1, spacing_for(bandwidth)};
    const double by_field =
        seconds([&] { signals = element_signals(of.seen, receiver, of.model, field, tolerance); });
    ChannelSignals drawn;
    const double by_rule =
        seconds([&] { drawn = drawn_signals(of.seen, receiver, of.model, 1, 0, tolerance); });
    fmt::print("{:4} elements, {:5.1f} kHz, {:6} polygons, tolerance {:g}: field {:.2f} s, drawn {:.2f} s\n",
               receiver.channels.size(), bandwidth / 1e3, of.seen.patches.size(), tolerance, by_field,
               by_rule);
  };
  for (int elements = 1; elements <= most_elements; elements *= 4)
    measure(place, array_of(elements, 10e3, apex, reach_m), 10e3, 1e-3);
  for (const double bandwidth : {2.5e3, 5e3, 20e3})
    measure(place, array_of(64, bandwidth, apex, reach_m), bandwidth, 1e-3);
  for (const auto& [speed, turn] : {std::pair(2.0, 0.0), {2.0, 0.2}, {20.0, 0.0}}) {
    fmt::print("at {} m/s, turning by {} rad/s:\n", speed, turn);
    measure(place, on_the_way(array_of(64, 10e3, apex, reach_m), speed, turn), 10e3, 1e-3);
  }
  for (const double tolerance : {1e-2, 1e-4})
    measure(place, array_of(64, 10e3, apex, reach_m), 10e3, tolerance);
  for (const int part : {2, 4}) {
    Place some = place;
    std::vector<VisiblePolygon> patches;
    for (std::size_t k = 0; k < place.seen.patches.size(); k += std::size_t(part))
      patches.push_back(place.seen.patches[k]);
    some.seen.patches = patches;
    measure(some, array_of(64, 10e3, apex, reach_m), 10e3, 1e-3);
  }
  const auto beside_direct = [&](const Place& some, const char* what) {
    const CoherentReceiver receiver = array_of(64, 10e3, apex, reach_m);
    const SurfaceField field{1, spacing_for(10e3)};
    ChannelSignals truth;
    std::size_t scatterers = 0;
    const double direct_s = seconds([&] { truth = direct_sum(some, receiver, field, scatterers); });
    fmt::print("direct sum, {}: {} scatterers, {:.2f} s\n", what, scatterers, direct_s);
    for (const double tolerance : {1e-1, 1e-2, 1e-3, 1e-4}) {
      measure(some, receiver, 10e3, tolerance);
      compare("against the direct sum", signals, truth);
    }
  };
  if (!direct) return;
  beside_direct(flat_seabed(apex), "a flat seabed of 40 m x 20 m");
  // One polygon in 16, because the direct sum takes equally long for each polygon.
  Place some = place;
  some.seen.patches.clear();
  for (std::size_t k = 0; k < place.seen.patches.size(); k += 16)
    some.seen.patches.push_back(place.seen.patches[k]);
  beside_direct(some, "one polygon in 16 of the survey scene");
}

}  // namespace
}  // namespace tubefoot

int main(int argc, char** argv) {
  std::setvbuf(stdout, nullptr, _IOLBF, 0);
  const auto number = [&](int k, double otherwise) { return argc > k ? std::atof(argv[k]) : otherwise; };
  tubefoot::run(number(1, 40), int(number(2, 256)), number(3, 1) != 0);
}
