// SPDX-License-Identifier: GPL-3.0-or-later
// Cost of signals of smooth surfaces (validation/signals.md). Measures processor seconds for an array over
// a sphere and over the wreck of the survey scene. Compares them with the exact pulse along every edge.
//
//     tubefoot_smooth_bench [elements] [elements of the exact pulse]
#include <fmt/core.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>

#include "engine/signal/smooth_amplitude.hpp"
#include "engine/signal/smooth_signals.hpp"
#include "engine/visibility/tube_engine.hpp"
#include "geometry/integrals/polygon_transform.hpp"
#include "geometry/numbers/scalars.hpp"
#include "scene/scene.hpp"
#include "sensors/kinds/scene_file.hpp"
#include "timing.hpp"

namespace tubefoot {
namespace {

constexpr double carrier_hz = 100e3, sound_speed = 1500, bandwidth_hz = 10e3;

const SmoothSurface rigid;

void measure(const char* what, VisiblePolygons seen, int elements, int exact_elements) {
  const double sigma = std::sqrt(-2 * std::log(1e-3)) / (pi * bandwidth_hz);
  CoherentReceiver receiver;
  for (int k = 0; k < elements; ++k)
    receiver.channels.push_back(
        {seen.origin_m,
         seen.origin_m + glm::dvec3((k - 0.5 * (elements - 1)) * sound_speed / carrier_hz / 2, 0, 0)});
  receiver.pulse = gaussian_pulse(sigma, 1e-3);
  receiver.carrier_hz = carrier_hz;
  receiver.sound_speed_m_s = sound_speed;
  double nearest = 1e9, farthest = 0;
  for (const glm::dvec3& corner : seen.corners_m) {
    nearest = std::min(nearest, glm::length(corner));
    farthest = std::max(farthest, glm::length(corner));
  }
  receiver.times = {2 * (nearest - 1) / sound_speed, 1.25 * bandwidth_hz, 0};
  receiver.times.count = std::size_t(2 * (farthest - nearest + 2) / sound_speed * receiver.times.rate_hz);
  const auto surface_of = [](FacetId) { return &rigid; };
  fmt::print("{}: {} polygons, {:.3g} m2, {:.1f} to {:.1f} m, {} samples\n", what, seen.patches.size(),
             seen.area_m2(), nearest, farthest, receiver.times.count);
  CoherentReceiver some = receiver;
  some.channels.resize(std::size_t(exact_elements));
  std::vector<std::complex<double>> exact;
  const double exact_s = seconds([&] {
    std::vector<double> times;
    for (std::size_t k = 0; k < receiver.times.count; ++k) times.push_back(receiver.times.time_s(k));
    const TransmittedPulse wave{
        [&](double t) { return receiver.pulse.envelope(t) * phasor(-2 * pi * carrier_hz * t); },
        2 * pi * carrier_hz + 8 / sigma};
    for (const SignalChannel& channel : some.channels) {
      std::vector<std::complex<double>> row(times.size());
      for (const VisiblePolygon& patch : seen.patches) {
        const glm::dvec3 transmit = channel.transmit_m - seen.origin_m,
                         receive = channel.receive_m - seen.origin_m;
        const FacetPlane plane{patch.normal, patch.distance_m + glm::dot(patch.normal, transmit)};
        const PlaneFrame frame(plane);
        PlanarPolygon polygon;
        polygon.assign(seen.corners(patch), plane, frame);
        add_pulse_echo(polygon, {patch.distance_m + glm::dot(patch.normal, receive), frame.project(receive)},
                       wave, sound_speed, times, row);
      }
      for (std::size_t k = 0; k < times.size(); ++k)
        exact.push_back(row[k] * phasor(2 * pi * carrier_hz * times[k]));
    }
  });
  fmt::print("  the pulse along all edges: {:.4f} s per element\n", exact_s / exact_elements);
  for (const double tolerance : {1e-2, 1e-3, 1e-4}) {
    ChannelSignals signals;
    const double all_s =
        seconds([&] { signals = smooth_signals(seen, receiver, {}, surface_of, tolerance); });
    double most = 0, off = 0, power = 0, peak = 0;
    for (std::size_t k = 0; k < exact.size(); ++k) {
      most = std::max(most, std::abs(signals.value[k] - exact[k]));
      peak = std::max(peak, std::abs(exact[k]));
      off += std::norm(signals.value[k] - exact[k]);
      power += std::norm(exact[k]);
    }
    fmt::print("  tolerance {:g}: {:.3f} s for {} elements; error at most {:.1e} of the peak, rms {:.1e}\n",
               tolerance, all_s, elements, most / peak, std::sqrt(off / power));
  }
}

void run(int elements, int exact_elements) {
  const Scene scene =
      load_scene(read_scene_file(std::filesystem::path(TUBEFOOT_SCENES) / "survey/scene.toml"));
  const SceneTree tree(scene.mesh);
  TubeSet tubes;
  tubes.apex = scene.grid.snap({-24, 16, -8});
  tubes.reach = 40 / scene.grid.unit_m();
  AngularGrid grid;
  for (int k = 0; k <= 12; ++k) grid.azimuth_edges_rad.push_back(5 * (k - 6) * degree);
  for (int k = 0; k <= 2; ++k) grid.elevation_edges_rad.push_back((-60 + 30 * k) * degree);
  grid.frame = glm::dmat3(glm::dvec3(0, 1, 0), glm::dvec3(1, 0, 0), glm::dvec3(0, 0, 1));
  append_tubes(tubes, grid);
  const History history = TubeEngine(scene.mesh, tree, scene.grid.unit_m(), {}).trace(tubes);
  EchoModel model;
  model.path.tx.apex_m = scene.grid.to_metres(tubes.apex);
  const SplitPolygons split = split_polygons(visible_polygons(history, model), [&](FacetId facet) {
    return scene.description.materials[scene.mesh.material[facet]].name == "steel";
  });
  measure("wreck", split.smooth, elements, exact_elements);

  // A sphere of radius 0.5 m at a distance of 10 m: its rows of facets that face the sonar.
  VisiblePolygons ball;
  const int rows = 24;
  const glm::dvec3 centre(0, 10, 0);
  const auto at = [&](int i, int j) {
    const double theta = pi * i / rows, phi = pi * j / rows;
    return centre + 0.5 * glm::dvec3(std::sin(theta) * std::cos(phi), -std::sin(theta) * std::sin(phi),
                                     std::cos(theta));
  };
  const auto add = [&](glm::dvec3 a, glm::dvec3 b, glm::dvec3 c) {
    glm::dvec3 normal = glm::normalize(glm::cross(b - a, c - a));
    if (glm::dot(normal, a) > 0) normal = -normal;
    if (!(-glm::dot(normal, a) > 0.1)) return;
    PlanarPolygon turn;
    const FacetPlane plane{normal, -glm::dot(normal, a)};
    turn.assign(std::vector{a, b, c}, plane, PlaneFrame(plane));
    if (area(turn) < 0) std::swap(b, c);
    VisiblePolygon patch{FacetId(ball.patches.size()), normal, plane.distance_m};
    patch.first_corner = std::uint32_t(ball.corners_m.size());
    patch.corner_count = 3;
    ball.patches.push_back(patch);
    ball.corners_m.insert(ball.corners_m.end(), {a, b, c});
  };
  for (int i = 0; i < rows; ++i)
    for (int j = 0; j < rows; ++j) {
      if (i > 0) add(at(i, j), at(i, j + 1), at(i + 1, j));
      if (i + 1 < rows) add(at(i, j + 1), at(i + 1, j + 1), at(i + 1, j));
    }
  measure("sphere", ball, elements, exact_elements);
}

}  // namespace
}  // namespace tubefoot

int main(int argc, char** argv) {
  const auto number = [&](int k, int otherwise) { return argc > k ? std::atoi(argv[k]) : otherwise; };
  tubefoot::run(number(1, 64), number(2, 2));
}
