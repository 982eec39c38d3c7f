// SPDX-License-Identifier: GPL-3.0-or-later
// Tests coherent amplitudes of smooth polygons. The comparisons are plane waves with their bound, edge
// sums, and the visible polygons of the engine.
#include "engine/signal/smooth_amplitude.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>

#include "engine/scattering/reflection.hpp"
#include "engine/visibility/tube_engine.hpp"
#include "fixtures/geometry/plane_polygons.hpp"
#include "geometry/integrals/polygon_transform.hpp"
#include "geometry/numbers/scalars.hpp"
#include "geometry/tubes/tube.hpp"

namespace tubefoot {
namespace {

using test::planar;
using test::Polygon2;
using Complex = std::complex<double>;
using test::k_100khz;

Complex amplitude(const PlanarPolygon& polygon, const PathCutter::Receiver& rx, double k, double tolerance,
                  const SmoothSurface& surface = {}) {
  SmoothAmplitude amplitudes(std::span(&k, 1), tolerance);
  Complex sum = 0;
  amplitudes.add(polygon, rx, surface, std::span(&sum, 1));
  return sum;
}

// Law Q6, and the bound: it is never exceeded, and is close to the error.
TEST(FarAmplitude, IsWithinItsBoundOfTheEdges) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> unit(0, 1);
  double tightest = 0;
  for (int n = 0; n < 400; ++n) {
    const double size = std::pow(10, -3 + 2.5 * unit(random)), k = std::pow(10, 1 + 2.5 * unit(random));
    const PlanarPolygon polygon = planar(
        test::random_convex(random, {4 * unit(random) - 2, 4 * unit(random) - 2}, size, size * unit(random)),
        0.5 + 3 * unit(random));
    const PathCutter::Receiver rx{0.5 + 3 * unit(random), {unit(random), 2 * unit(random)}};
    const FarAmplitude far = far_amplitude(polygon, rx, k);
    const double off = std::abs(far.pressure - amplitude(polygon, rx, k, 0));
    EXPECT_LE(off, far.error + 1e-13) << size << " " << k;
    EXPECT_LE(std::abs(far.pressure), far.most * (1 + 1e-12));
    if (far.error > 1e-10 && far.error < 0.1 * far.most) tightest = std::max(tightest, off / far.error);
  }
  EXPECT_GT(tightest, 0.2);
}

TEST(FarAmplitude, ErrorFallsWithRange) {
  double before = 1;
  for (const double range : {5.0, 50.0, 500.0, 5000.0}) {
    const PlanarPolygon polygon = planar({{.1, .1}, {.2, .1}, {.2, .16}, {.1, .16}}, range);
    const FarAmplitude far = far_amplitude(polygon, {range, {0, 0}}, k_100khz);
    const double off =
        std::abs(far.pressure - amplitude(polygon, {range, {0, 0}}, k_100khz, 0)) / std::abs(far.pressure);
    EXPECT_LT(off, before / 7);
    before = off;
    // The cross-section of the plate, p = f e^{2ikR} / R^2.
    if (range == 5000) {
      EXPECT_NEAR(std::abs(far.pressure) * range * range, 0.4, 1e-5);
    }
  }
}

// The table of the signals sheet gives lengths for k D^2 / 4R of 0.05. Plane waves have this accuracy
// there, across a square of this diameter, on its axis and off it.
TEST(FarAmplitude, IsGoodAsFarAsTheSheetSays) {
  for (const auto& [hertz, range, millimetres] :
       {std::array{100e3, 20.0, 98.0}, {455e3, 10.0, 32.0}, {1.8e6, 5.0, 11.5}}) {
    const double k = 2 * pi * hertz / 1500, diameter = std::sqrt(4 * range * 0.05 / k);
    EXPECT_NEAR(1e3 * diameter, millimetres, millimetres < 20 ? 0.05 : 0.5);
    const double side = diameter / std::sqrt(2.0);
    const Polygon2 square{{0, 0}, {side, 0}, {side, side}, {0, side}};
    for (const glm::dvec2 middle : {glm::dvec2(0), glm::dvec2(0.5 * range, 0.2 * range)}) {
      const double height = std::sqrt(range * range - glm::dot(middle, middle));
      const PlanarPolygon polygon = planar(test::shifted(square, middle - side / 2), height);
      const FarAmplitude far = far_amplitude(polygon, {height, {0, 0}}, k);
      EXPECT_LE(far.error, 0.05 * far.most) << hertz;
      EXPECT_LE(std::abs(far.pressure - amplitude(polygon, {height, {0, 0}}, k, 0)), 0.05 * far.most)
          << hertz;
    }
  }
}

// The signals sheet states the phase error of the grid of the scene, 2k times half a unit. It is 0.007 rad
// at 1.8 MHz for a unit of 2^-20 m.
TEST(SmoothAmplitude, TheWorldsGridTurnsPhasesAsTheSheetSays) {
  const double k = 2 * pi * 1.8e6 / 1500, unit = 0x1p-20;
  EXPECT_NEAR(2 * k * 0.48e-6, 0.007, 5e-4);
  double most = 0;
  for (int n = 0; n < 200; ++n) {
    const double height = 2 + n * 0.00137, snapped = std::round(height / unit) * unit;
    const Polygon2 square{{-.003, -.003}, {.003, -.003}, {.003, .003}, {-.003, .003}};
    const Complex exact = amplitude(planar(square, height), {height, {0, 0}}, k, 0),
                  got = amplitude(planar(square, snapped), {snapped, {0, 0}}, k, 0);
    most = std::max(most, std::abs(std::arg(got / exact)));
  }
  EXPECT_LT(most, 2 * k * 0.48e-6);
  EXPECT_GT(most, 0.9 * 0.007);
}

// Two apexes far away: the bistatic value of the signals sheet is -0.0306517890946051 i.
TEST(FarAmplitude, IsTheSymmetricFormBetweenTwoDirections) {
  const double range = 1e7;
  const auto at = [&](double theta, double phi) {
    return range * glm::dvec3(std::sin(theta * degree) * std::cos(phi * degree),
                              std::sin(theta * degree) * std::sin(phi * degree), std::cos(theta * degree));
  };
  const glm::dvec3 source = at(30, 180), receiver = at(40, 15);
  const Polygon2 plate{{-.05, -.03}, {.05, -.03}, {.05, .03}, {-.05, .03}};
  const FarAmplitude far = far_amplitude(planar(test::shifted(plate, -glm::dvec2(source)), source.z),
                                         {receiver.z, glm::dvec2(receiver - source)}, k_100khz);
  EXPECT_NEAR(std::abs(far.pressure) * range * range, 0.0306517890946051, 1e-8);
}

TEST(SmoothAmplitude, TakesPlaneWavesOnlyWithinTheTolerance) {
  const std::vector<double> k{10, 100, 1000, 10000};
  const PlanarPolygon polygon = planar({{.1, .1}, {.2, .1}, {.2, .16}, {.1, .16}}, 5);
  std::vector<Complex> mixed(4), exact(4);
  SmoothAmplitude by_both(k, 0.02), by_edges(k, 0);
  by_both.add(polygon, {5, {0, 0}}, {}, mixed);
  by_edges.add(polygon, {5, {0, 0}}, {}, exact);
  EXPECT_EQ(by_both.count().far, 1U);
  EXPECT_EQ(by_both.count().near, 3U);
  EXPECT_EQ(by_edges.count().far, 0U);
  for (std::size_t i = 0; i < 4; ++i)
    EXPECT_LE(std::abs(mixed[i] - exact[i]), 0.02 * far_amplitude(polygon, {5, {0, 0}}, k[i]).most);
  EXPECT_EQ(mixed[3], exact[3]);
  EXPECT_NE(mixed[0], exact[0]);
}

TEST(SmoothAmplitude, ReflectionAndRoughnessAreFactors) {
  const PlanarPolygon polygon = planar({{-.1, -.1}, {.1, -.1}, {.1, .1}, {-.1, .1}}, 3);
  const PathCutter::Receiver rx{2, {1, 0}};
  const Complex rigid = amplitude(polygon, rx, 300, 0);
  EXPECT_LT(std::abs(amplitude(polygon, rx, 300, 0, {.reflection = -1}) + rigid), 1e-15);
  const double sine = mean_sine(polygon, rx), change = 600 * sine * 1e-3;
  EXPECT_LT(std::abs(amplitude(polygon, rx, 300, 0, {.roughness_m = 1e-3}) -
                     std::exp(-change * change / 2) * rigid),
            1e-15);
  const FluidSediment sand = fluid_sediment(2, 1.15, 0.9);
  EXPECT_LT(std::abs(amplitude(polygon, rx, 300, 0, {.fluid = sand}) -
                     reflection_coefficient(sand, std::asin(sine)) * rigid),
            1e-15);
  // At the specular point the mean sine is that of either leg.
  const PlanarPolygon at_mirror = planar({{.5, -.1}, {.7, -.1}, {.7, .1}, {.5, .1}}, 3);
  EXPECT_NEAR(mean_sine(at_mirror, rx), 5 / std::sqrt(26.0), 1e-14);
}

TEST(SmoothAmplitude, RefusesWaveNumbersThatAreNone) {
  for (const std::vector<double>& wrong : {std::vector<double>{0}, {-1}, {2, 1}, {1, 1}, {NAN}, {INFINITY}})
    EXPECT_THROW(SmoothAmplitude(wrong, 0), std::invalid_argument);
  const double k = 1;
  EXPECT_THROW(SmoothAmplitude(std::span(&k, 1), -1), std::invalid_argument);
  EXPECT_THROW(SmoothAmplitude(std::span(&k, 1), NAN), std::invalid_argument);
}

// Law Q7: a flat seabed of many facets, cut by the walls of many tubes, is one plane for one apex.
TEST(SmoothAmplitude, TubesAndFacetsMakeNoEdges) {
  const WorldGrid grid(20, glm::dvec3(0));
  const auto history_of = [&](int facets, int tubes) {
    MeshBuilder builder(grid);
    std::vector<glm::dvec3> points;
    std::vector<std::array<std::uint32_t, 3>> triangles;
    const auto across = static_cast<std::uint32_t>(facets) + 1;
    for (std::uint32_t i = 0; i < across; ++i)
      for (std::uint32_t j = 0; j < across; ++j)
        points.emplace_back(8.0 * i / facets - 4, 8.0 * j / facets - 4, 0);
    for (std::uint32_t i = 0; i + 1 < across; ++i)
      for (std::uint32_t j = 0; j + 1 < across; ++j) {
        const std::uint32_t k = i * across + j;
        triangles.push_back({k, k + across, k + 1});
        triangles.push_back({k + 1, k + across, k + across + 1});
      }
    builder.add(points, triangles, 0, 0);
    MeshReport report;
    const FacetMesh mesh = builder.finish(report);
    const SceneTree tree(mesh);
    TubeSet set{grid.snap({0.1, 0.2, 2}), {}, {}, 1e9};
    AngularGrid angles;
    for (int k = 0; k <= tubes; ++k) {
      angles.azimuth_edges_rad.push_back(-0.4 + 0.7 * k / tubes);
      angles.elevation_edges_rad.push_back(-0.3 + 0.5 * k / tubes);
    }
    angles.frame = glm::dmat3(glm::dvec3(0, 0, -1), glm::dvec3(0, 1, 0), glm::dvec3(1, 0, 0));
    append_tubes(set, angles);
    return TubeEngine(mesh, tree, grid.unit_m(), {}).trace(set);
  };
  const std::vector<double> k{50, 400, 3000};
  const SmoothSurface rigid;
  const auto of = [&](const History& history, double tolerance) {
    std::vector<Complex> sum(3);
    SmoothAmplitude amplitudes(k, tolerance);
    amplitudes.add(
        history, [&](FacetId) { return &rigid; }, sum);
    return sum;
  };
  // The outer walls of one tube are planes through its corner rays, and differ from those of many tubes.
  // The visible polygons differ there. The test thus compares only facets and tubes with the same walls.
  const std::vector<Complex> one = of(history_of(2, 1), 0), fine = of(history_of(16, 1), 0);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_LT(std::abs(one[i] - fine[i]), 1e-12) << i;
  // With plane waves, fine facets are within the tolerance of the largest possible return.
  const std::vector<Complex> far = of(history_of(128, 1), 0.05);
  EXPECT_LT(std::abs(far[0] - one[0]), 0.05 * 50 / 4 * 1.5);
  EXPECT_LT(std::abs(far[0] - one[0]), 0.02 * std::abs(one[0]));
}

// One frequency of a long pulse: a pulse of infinite length equals its spectrum.
TEST(PulseEcho, OfALongPulseIsTheAmplitude) {
  const PlanarPolygon polygon = planar({{-.1, -.1}, {.3, -.1}, {.1, .2}}, 1);
  const PathCutter::Receiver rx{1.5, {.2, .1}};
  const double c = 1500, omega = k_100khz * c, time = 0.002;
  const TransmittedPulse pulse{[&](double t) { return phasor(-omega * t); }, omega};
  Complex sum = 0;
  add_pulse_echo(polygon, rx, pulse, c, std::span(&time, 1), std::span(&sum, 1));
  EXPECT_LT(std::abs(sum - phasor(-omega * time) * amplitude(polygon, rx, k_100khz, 0)), 1e-11);
}

}  // namespace
}  // namespace tubefoot
