// SPDX-License-Identifier: GPL-3.0-or-later
// Tests volume reverberation against closed forms of a fan above a flat seabed and against sums over rays in
// random scenes. Also tests the laws of VolumeRegions.
#include "engine/echo/volume_echo.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <random>

#include "engine/echo/volume_regions.hpp"
#include "engine/visibility/tube_engine.hpp"
#include "fixtures/geometry/grid_scenes.hpp"
#include "fixtures/geometry/metre_meshes.hpp"
#include "fixtures/world/histories.hpp"
#include "geometry/numbers/scalars.hpp"

namespace tubefoot {
namespace {

using test::one_beam;

/// A wedge of directions between two vertical planes, from the horizon to straight down, above a flat seabed.
/// The seabed is visible up to a distance; beyond it the directions are unobstructed.
History wedge_above_seabed(double width_rad, double height_m, double distance_m) {
  History history;
  const auto at = [&](double azimuth, double out, double z) {
    return glm::dvec3(out * std::cos(azimuth), out * std::sin(azimuth), z);
  };
  const GridPoint side = integer_ray(at(width_rad / 2, 1, 0));
  const double half = std::atan2(double(side.y), double(side.x));  // as the rays of the tube
  const std::vector<glm::dvec3> seabed{at(0, 0, -height_m), at(-half, distance_m, -height_m),
                                       at(half, distance_m, -height_m)};
  const std::vector<glm::dvec3> open{at(-half, 1, 0), at(half, 1, 0), at(half, distance_m, -height_m),
                                     at(-half, distance_m, -height_m)};
  history.tubes.rays = {integer_ray(at(-half, 1, 0)), integer_ray(at(half, 1, 0)), integer_ray({0, 0, -1})};
  history.tubes.tubes = {{1, 0, 2, 2}};
  FootprintSet& set = history.footprints;
  Footprint footprint;
  footprint.plane_normal = {0, 0, 1};
  footprint.plane_distance_m = height_m;
  footprint.piece_count = 1;
  set.pieces = {{0, 3}};
  // Visible polygons turn counter-clockwise for an observer who looks back at the apex.
  const bool turn = glm::dot(glm::cross(seabed[0], seabed[1]), seabed[2]) < 0;
  set.corners_m = turn ? std::vector{seabed[0], seabed[2], seabed[1]} : seabed;
  set.footprints = {footprint};
  set.open_pieces = {{0, 0, 4}};
  for (const glm::dvec3 d : open) set.open_directions.push_back(glm::normalize(d));
  if (glm::dot(glm::cross(open[0], open[1]), open[2]) < 0)
    std::reverse(set.open_directions.begin(), set.open_directions.end());
  return history;
}

/// The width of the wedge with rounded rays, relative to the requested width.
double rounded_width(double width_rad) {
  const GridPoint side = integer_ray({std::cos(width_rad / 2), std::sin(width_rad / 2), 0});
  return 2 * std::atan2(double(side.y), double(side.x)) / width_rad;
}

const std::vector<std::uint32_t> single_beam{0};

Echo volume_of(const History& history, const RangeSamples& samples, const VolumeScattering& volume,
               double absorption_db_per_m = 0, const BeamPatterns* patterns = nullptr) {
  EchoModel model;
  model.absorption_db_per_m = absorption_db_per_m;
  model.patterns = patterns;
  model.pattern_tolerance = 1e-10;
  return volume_echo(history, {1, single_beam}, samples, model, volume);
}

TEST(VolumeEcho, FanAboveSeabedHasTheValuesOfTheSheet) {
  const History history = wedge_above_seabed(0.01, 3, 500);
  const VolumeScattering volume{{}, {1e-7}};
  const double per_width = 1 / rounded_width(0.01);
  EXPECT_NEAR(volume_of(history, {5, 0.1, 1}, volume).energy[0] * per_width, 2.3298731257e-12,
              1e-10 * 2.33e-12);
  EXPECT_NEAR(volume_of(history, {10, 0.1, 1}, volume).energy[0] * per_width, 2.9555925890e-13,
              1e-10 * 2.96e-13);
  // E = s_v w (1/r0 - 1/r1) up to the height, and s_v w H (r0^-2 - r1^-2) / 2 beyond it.
  const Echo echo = volume_of(history, {0.5, 0.25, 400}, volume);
  for (int k = 0; k < echo.samples; ++k) {
    const double r0 = 0.5 + 0.25 * k, r1 = r0 + 0.25;
    const double expected =
        r1 <= 3 ? 1e-9 * (1 / r0 - 1 / r1) : 1e-9 * 3 * (1 / (r0 * r0) - 1 / (r1 * r1)) / 2;
    EXPECT_NEAR(echo.energy[k] * per_width, expected, 1e-12 * expected) << "sample " << k;
  }
}

TEST(VolumeEcho, AbsorptionMatchesNumericalIntegralOfTheClosedSolidAngle) {
  const History history = wedge_above_seabed(0.01, 3, 500);
  const double alpha = 0.4, beta = alpha * std::log(10) / 10;
  const Echo echo = volume_of(history, {1, 0.5, 60}, {{}, {1e-7}}, alpha);
  for (int k = 0; k < echo.samples; ++k) {
    const double r0 = 1 + 0.5 * k;
    double expected = 0;
    constexpr int steps = 2000;  // midpoint rule
    for (int i = 0; i < steps; ++i) {
      const double r = r0 + 0.5 * (i + 0.5) / steps;
      expected += 1e-9 * std::min(1.0, 3 / r) / (r * r) * std::exp(-2 * beta * r) * 0.5 / steps;
    }
    EXPECT_NEAR(echo.energy[k], expected, 2e-7 * expected) << "sample " << k;
  }
}

TEST(VolumeEcho, LayerHasItsClosedForm) {
  // The layer is 1 m to 2 m below the apex. Its solid angle is w (1 - 1/r) up to 2 m, and w / r beyond.
  const History history = wedge_above_seabed(0.01, 3, 500);
  const Echo echo = volume_of(history, {0.25, 0.25, 200}, {{-2, -1}, {0, 1e-7, 0}});
  const auto primitive = [](double r) {
    return r <= 1 ? 0 : r <= 2 ? -1 / r + 1 / (2 * r * r) + 0.5 : 0.125 + (0.25 - 1 / (r * r)) / 2;
  };
  for (int k = 0; k < echo.samples; ++k) {
    const double r0 = 0.25 + 0.25 * k, expected = 1e-9 * (primitive(r0 + 0.25) - primitive(r0));
    EXPECT_NEAR(echo.energy[k] / rounded_width(0.01), expected, 1e-12 * expected + 1e-24) << "sample " << k;
  }
}

/// A random scene about the apex with the tube of all its facets, in metres of 2^10 grid units.
struct RandomWater {
  FacetMesh mesh;
  TubeSet tubes;
  explicit RandomWater(std::uint64_t seed) {
    test::Random random(seed);
    mesh = test::make_random_triangles(random, 12, 20 << 10, 12 << 10);
    tubes.reach = 1e9;
    AngularGrid grid;
    grid.azimuth_edges_rad = {1.2, 1.6, 2.0};
    grid.elevation_edges_rad = {-0.4, 0.1, 0.5};
    append_tubes(tubes, grid);
  }
  History trace() const {
    VisibilityOptions options;
    options.open_water = true;
    const SceneTree tree(mesh);
    return TubeEngine(mesh, tree, 1.0 / (1 << 10), options).trace(tubes);
  }
  /// Returns the range of the nearest facet in a direction.
  double range_m(glm::dvec3 direction) const {
    double nearest = std::numeric_limits<double>::infinity();
    for (const auto& facet : mesh.facets) {
      std::array<glm::dvec3, 3> p;
      for (int k = 0; k < 3; ++k) {
        const GridPoint& v = mesh.vertices[facet[k]];
        p[k] = glm::dvec3(double(v.x), double(v.y), double(v.z)) / double(1 << 10);
      }
      const glm::dvec3 n = glm::cross(p[1] - p[0], p[2] - p[0]);
      const double along = glm::dot(n, direction);
      if (along == 0) continue;
      const double r = glm::dot(n, p[0]) / along;
      const glm::dvec3 at = r * direction;
      bool inside = r > 0;
      for (int k = 0; k < 3; ++k)
        inside = inside && glm::dot(glm::cross(p[(k + 1) % 3] - p[k], at - p[k]), n) >= 0;
      if (inside) nearest = std::min(nearest, r);
    }
    return nearest;
  }
};

TEST(VolumeEcho, AgreesWithSumsOverRaysInRandomScenes) {
  const VolumeScattering layers{{-6, -2, 3}, {2e-7, 0, 1e-7, 3e-7}};
  const RangeSamples samples{4, 2, 20};
  int obstructed = 0;
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    const RandomWater scene(seed);
    const History history = scene.trace();
    std::vector<std::uint32_t> beams(scene.tubes.tubes.size());
    for (std::size_t t = 0; t < beams.size(); ++t) beams[t] = std::uint32_t(t);
    EchoModel model;
    model.absorption_db_per_m = 0.1;
    const Echo echo = volume_echo(history, {int(beams.size()), beams}, samples, model, layers);
    const double beta = 0.01 * std::log(10);
    for (std::size_t t = 0; t < beams.size(); ++t) {
      // Midpoints of a grid on the parallelogram of the corner rays represent solid angles.
      std::array<glm::dvec3, 4> ray;
      for (int k = 0; k < 4; ++k) {
        const GridPoint& d = scene.tubes.rays[scene.tubes.tubes[t][k]];
        ray[k] = glm::normalize(glm::dvec3(double(d.x), double(d.y), double(d.z)));
      }
      std::vector<double> expected(samples.count, 0);
      constexpr int n = 90, steps = 12;
      for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) {
          const double u = (i + 0.5) / n, v = (j + 0.5) / n;
          const glm::dvec3 p =
              (1 - u) * (1 - v) * ray[0] + u * (1 - v) * ray[1] + u * v * ray[2] + (1 - u) * v * ray[3];
          const glm::dvec3 du = (1 - v) * (ray[1] - ray[0]) + v * (ray[2] - ray[3]),
                           dv = (1 - u) * (ray[3] - ray[0]) + u * (ray[2] - ray[1]);
          const double size = glm::length(p);
          const double solid_angle =
              std::abs(glm::dot(p, glm::cross(du, dv))) / (size * size * size) / (n * n);
          const double range = scene.range_m(p / size);
          obstructed += range < 44;
          for (int k = 0; k < samples.count; ++k)
            for (int step = 0; step < steps; ++step) {
              const double r = samples.first_m + samples.step_m * (k + (step + 0.5) / steps);
              if (r > range) break;
              const double z = r * p.z / size;
              const double s_v = z < -6 ? 2e-7 : z < -2 ? 0 : z < 3 ? 1e-7 : 3e-7;
              expected[k] += solid_angle * s_v / (r * r) * std::exp(-2 * beta * r) * samples.step_m / steps;
            }
        }
      const double largest = *std::max_element(expected.begin(), expected.end());
      for (int k = 0; k < samples.count; ++k)
        EXPECT_NEAR(echo.at(int(t), k), expected[k], 5e-3 * expected[k] + 1e-3 * largest)
            << "seed " << seed << ", tube " << t << ", sample " << k;
    }
  }
  EXPECT_GT(obstructed, 5000);
}

// Law Z1.
TEST(VolumeEcho, ConesFillTheSolidAngleOfEachTubeInRandomScenes) {
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    const RandomWater scene(seed);
    const History history = scene.trace();
    VolumeRegions<DoubleSpace> regions({{}, {1}}, 0, 50);
    std::size_t surface = 0, open = 0;
    for (std::uint32_t t = 0; t < scene.tubes.tubes.size(); ++t) {
      const TubeContent<DoubleSpace> content = tube_content(history, t, surface, open);
      double sum = 0;
      regions.divide(content, [&](const DoubleSpace::Polygon& cone, double s_v_per_m) {
        PlanarPolygon polygon;
        polygon.assign(cone.corners_m, cone.plane, PlaneFrame(cone.plane));
        EXPECT_GE(solid_angle(polygon), 0);
        sum += s_v_per_m * solid_angle(polygon);
      });
      // The tube as two triangles (Van Oosterom and Strackee 1983).
      const auto triangle = [](glm::dvec3 a, glm::dvec3 b, glm::dvec3 c) {
        return 2 * std::atan2(std::abs(glm::dot(a, glm::cross(b, c))),
                              1 + glm::dot(a, b) + glm::dot(b, c) + glm::dot(c, a));
      };
      const auto& r = content.rays;
      EXPECT_NEAR(sum, triangle(r[0], r[1], r[2]) + triangle(r[0], r[2], r[3]), 1e-12)
          << "seed " << seed << ", tube " << t;
    }
    EXPECT_EQ(surface, history.footprints.footprints.size());
    EXPECT_EQ(open, history.footprints.open_pieces.size());
  }
}

// Law Z2.
TEST(VolumeEcho, LayersAddUpAndBordersOfEqualLayersChangeNothing) {
  const RangeSamples samples{4, 0.5, 80};
  std::mt19937_64 random(7);
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    const RandomWater scene(seed);
    const History history = scene.trace();
    const std::vector<std::uint32_t> beams(scene.tubes.tubes.size(), 0);
    const auto volume = [&](const VolumeScattering& layers) {
      return volume_echo(history, {1, beams}, samples, {}, layers).energy;
    };
    std::vector<double> borders;
    for (int k = 0; k < 4; ++k) borders.push_back(std::uniform_real_distribution(-12.0, 12.0)(random));
    std::ranges::sort(borders);
    const std::vector<double> all = volume({borders, {1, 1, 1, 1, 1}}), uniform = volume({{}, {1}});
    std::vector<double> sum(all.size(), 0);
    for (std::size_t layer = 0; layer < 5; ++layer) {
      VolumeScattering single{borders, std::vector<double>(5, 0)};
      single.s_v_per_m[layer] = 1;
      const std::vector<double> own = volume(single);
      for (std::size_t k = 0; k < sum.size(); ++k) sum[k] += own[k];
    }
    for (std::size_t k = 0; k < sum.size(); ++k) {
      EXPECT_NEAR(all[k], uniform[k], 1e-13 * uniform[0]) << "seed " << seed << ", sample " << k;
      EXPECT_NEAR(sum[k], uniform[k], 1e-12 * uniform[0]) << "seed " << seed << ", sample " << k;
    }
  }
}

/// A tube up or down, in front of a horizontal plate at a height, and a small facet in front of the plate.
History before_plate(double height_m, bool with_object) {
  const double unit_m = 1.0 / (1 << 10);
  FacetMesh mesh;
  const auto add = [&](double half_m, double z_m) {
    const auto at = [&](double x, double y) {
      return test::add_vertex(
          mesh, {std::int32_t(x / unit_m), std::int32_t(y / unit_m), std::int32_t(z_m / unit_m)});
    };
    const VertexId a = at(-half_m, -half_m), b = at(half_m, -half_m), c = at(half_m, half_m),
                   d = at(-half_m, half_m);
    test::add_facet(mesh, a, b, c);
    test::add_facet(mesh, a, c, d);
  };
  add(100, height_m);
  if (with_object) add(0.5, height_m / 2);
  TubeSet set;
  set.reach = 1e9;
  const double z = height_m > 0 ? 1 : -1;
  test::add_pyramid(set, {glm::dvec3(0.3, 0.2, z), {-0.4, 0.3, z}, {-0.3, -0.2, z}, {0.4, -0.3, z}});
  VisibilityOptions options;
  options.open_water = true;
  const SceneTree tree(mesh);
  return TubeEngine(mesh, tree, unit_m, options).trace(set);
}

TEST(VolumeEcho, SurfaceOnTheBorderOfALayerEndsTheLayer) {
  for (const double height : {8.0, -8.0, 8.3125, -8.3125})
    for (const bool with_object : {false, true}) {
      SCOPED_TRACE(testing::Message() << "plate at " << height << " m, object " << with_object);
      const History history = before_plate(height, with_object);
      const Echo uniform = volume_of(history, {1, 0.5, 30}, {{}, {1e-7}});
      for (const double behind : {0.0, 5e-7}) {
        const VolumeScattering layers{{height},
                                      height > 0 ? std::vector{1e-7, behind} : std::vector{behind, 1e-7}};
        const Echo echo = volume_of(history, {1, 0.5, 30}, layers);
        for (int k = 0; k < 30; ++k)
          EXPECT_NEAR(echo.energy[k], uniform.energy[k], 1e-12 * uniform.energy[0]) << "sample " << k;
      }
    }
}

TEST(VolumeEcho, PatternsOfOneGiveTheIdealBeam) {
  const History history = wedge_above_seabed(0.4, 3, 500);
  const VolumeScattering volume{{-2.5, -1}, {0, 1e-7, 3e-8}};
  const BeamPatterns uniform = one_beam({}, {});
  const Echo ideal = volume_of(history, {0.5, 0.25, 100}, volume, 0.2),
             patterned = volume_of(history, {0.5, 0.25, 100}, volume, 0.2, &uniform);
  for (int k = 0; k < ideal.samples; ++k)
    EXPECT_NEAR(patterned.energy[k], ideal.energy[k], 1e-8 * ideal.energy[k] + 1e-20) << "sample " << k;
}

TEST(VolumeEcho, PatternWeightsTheSolidAngle) {
  // The pattern of a line along the horizontal x axis, over the wedge without a seabed nearer than 20 m.
  const History history = wedge_above_seabed(0.4, 20, 500);
  Directivity line;
  line.kind = Directivity::Kind::line;
  line.axis = {0, 1, 0};
  line.size = 12;
  const BeamPatterns patterns = one_beam(line, line);
  const Echo echo = volume_of(history, {5, 5, 3}, {{}, {1e-7}}, 0, &patterns);
  double weight = 0;
  constexpr int n = 1500;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) {
      const double azimuth = 0.4 * ((i + 0.5) / n - 0.5), sine = (j + 0.5) / n;
      const double w = std::sqrt(1 - sine * sine) * std::sin(azimuth);
      weight += line.gain({std::sqrt(1 - w * w), w, 0}) * line.gain({std::sqrt(1 - w * w), w, 0}) * 0.4 /
                (double(n) * n);
    }
  for (int k = 0; k < 3; ++k) {
    const double r = 5 + 5 * k, expected = 1e-7 * weight * (1 / r - 1 / (r + 5));
    EXPECT_NEAR(echo.energy[k], expected, 2e-5 * expected);
  }
}

/// Unobstructed directions between two depressions.
History open_fan(double width_rad, double shallow_rad, double steep_rad) {
  History history;
  AngularGrid grid;
  grid.azimuth_edges_rad = {-width_rad / 2, width_rad / 2};
  grid.elevation_edges_rad = {-steep_rad, -shallow_rad};
  append_tubes(history.tubes, grid);
  history.tubes.reach = 1e9;
  for (const std::uint32_t ray : history.tubes.tubes[0]) {
    const GridPoint& d = history.tubes.rays[ray];
    history.footprints.open_directions.push_back(
        glm::normalize(glm::dvec3(double(d.x), double(d.y), double(d.z))));
  }
  history.footprints.open_pieces = {{0, 0, 4}};
  return history;
}

TEST(VolumeEcho, RefractedRaysAgreeWithSumsOverNumericallyTracedRays) {
  const double width = 0.02, shallow = 0.15, steep = 0.6, apex_depth = 20, c0 = 1500, gradient = -6;
  WaterColumn column{
      SoundSpeedProfile({{0, c0 - gradient * apex_depth}, {200, c0 + gradient * (200 - apex_depth)}}),
      {0.01, 0.05, 0.05}};
  const VolumeScattering volume{{-45, -28}, {1e-7, 0, 3e-7}};  // the surface is at the height 0
  const RangeSamples samples{5, 0.5, 110};
  EchoModel model;
  model.path.tx.apex_m = {0, 0, -apex_depth};
  const Echo echo = refracted_volume_echo(open_fan(width, shallow, steep), {1, single_beam}, samples, model,
                                          volume, {column, 0, c0}, 5e-4);
  // Rays by Runge-Kutta steps: x' = c cos, z' = c sin, angle' = -g cos. Neighbouring rays bound the area.
  std::vector<double> expected(samples.count, 0);
  constexpr int rays = 1800;
  const double step_m = 0.05, last = samples.border_m(samples.count);
  struct State {
    double x, z, angle;
  };
  const auto derivative = [&](const State& s) {
    const double c = c0 + gradient * (s.z - apex_depth);
    return State{c * std::cos(s.angle), c * std::sin(s.angle), -gradient * std::cos(s.angle)};
  };
  const auto advanced = [&](const State& s, double dt) {
    const auto plus = [](const State& a, const State& b, double k) {
      return State{a.x + k * b.x, a.z + k * b.z, a.angle + k * b.angle};
    };
    const State k1 = derivative(s), k2 = derivative(plus(s, k1, dt / 2)),
                k3 = derivative(plus(s, k2, dt / 2)), k4 = derivative(plus(s, k3, dt));
    return State{s.x + dt / 6 * (k1.x + 2 * k2.x + 2 * k3.x + k4.x),
                 s.z + dt / 6 * (k1.z + 2 * k2.z + 2 * k3.z + k4.z),
                 s.angle + dt / 6 * (k1.angle + 2 * k2.angle + 2 * k3.angle + k4.angle)};
  };
  for (int i = 0; i < rays; ++i) {
    const double from = shallow + (steep - shallow) * i / rays,
                 to = shallow + (steep - shallow) * (i + 1) / rays;
    State upper{0, apex_depth, from}, lower{0, apex_depth, to};
    const double launched = width * (std::sin(to) - std::sin(from)), beta = 0.05 * std::log(10) / 10;
    double path = 0;
    for (double r = 0; r < last - 1e-9; r += step_m) {
      upper = advanced(upper, step_m / c0);
      lower = advanced(lower, step_m / c0);
      const State mid{(upper.x + lower.x) / 2, (upper.z + lower.z) / 2, 0};
      const double c = c0 + gradient * (mid.z - apex_depth);
      path += c * step_m / c0;
      const double area = std::hypot(upper.x - lower.x, upper.z - lower.z) * mid.x * width / launched;
      const auto k = std::ptrdiff_t(std::floor((r + step_m / 2 - samples.first_m) / samples.step_m));
      if (k < 0 || k >= samples.count) continue;
      const double s_v = mid.z > 45 ? 1e-7 : mid.z > 28 ? 0 : 3e-7;
      expected[std::size_t(k)] +=
          launched * s_v * (c / c0) * (c / c0) / area * std::exp(-2 * beta * path) * c * step_m / c0;
    }
  }
  for (int k = 0; k < samples.count; ++k)
    EXPECT_NEAR(echo.energy[std::size_t(k)], expected[std::size_t(k)],
                0.01 * expected[std::size_t(k)] + 3e-4 * expected[0])
        << "sample " << k;
}

TEST(VolumeEcho, WeakGradientApproachesIsovelocityWater) {
  const WaterColumn column{SoundSpeedProfile({{0, 1500}, {1000, 1500 + 1e-6}}), {0.1, 0.1, 0.1}};
  const VolumeScattering volume{{-12, -8}, {1e-7, 2e-8, 3e-7}};
  const RangeSamples samples{2, 0.5, 60};
  EchoModel model;
  model.absorption_db_per_m = 0.1;
  const History history = wedge_above_seabed(0.01, 15, 100);
  const Echo straight = volume_echo(history, {1, single_beam}, samples, model, volume),
             refracted = refracted_volume_echo(history, {1, single_beam}, samples, model, volume,
                                               {column, 0, 1500}, 5e-4);
  for (int k = 0; k < samples.count; ++k)
    EXPECT_NEAR(refracted.energy[std::size_t(k)], straight.energy[std::size_t(k)],
                2e-3 * straight.energy[std::size_t(k)])
        << "sample " << k;
}

TEST(VolumeEcho, SeparateReceiverAgreesWithSumsOverVolumeElements) {
  // A plate hides a part of the water from each end. Elements of a lattice are counted if both ends see them.
  const double unit_m = 1.0 / (1 << 10);
  const auto grid_point = [&](glm::dvec3 p) {
    return GridPoint{std::int32_t(p.x / unit_m), std::int32_t(p.y / unit_m), std::int32_t(p.z / unit_m)};
  };
  FacetMesh mesh;
  const VertexId a = test::add_vertex(mesh, grid_point({-3, 10, -2})),
                 b = test::add_vertex(mesh, grid_point({4, 11, -2})),
                 c = test::add_vertex(mesh, grid_point({1, 10, 3}));
  test::add_facet(mesh, a, b, c);
  const glm::dvec3 receiver(4, -1, 1);
  const auto tubes_from = [&](glm::dvec3 apex, double low, double high) {
    TubeSet set;
    set.apex = grid_point(apex);
    set.reach = 1e9;
    AngularGrid grid;
    grid.azimuth_edges_rad = {low, (low + high) / 2, high};
    grid.elevation_edges_rad = {-0.3, 0.3};
    append_tubes(set, grid);
    return set;
  };
  VisibilityOptions options;
  options.open_water = true;
  const SceneTree tree(mesh);
  const TubeEngine engine(mesh, tree, unit_m, options);
  const History transmit = engine.trace(tubes_from({0, 0, 0}, 1.2, 2.0)),
                receive = engine.trace(tubes_from(receiver, 1.3, 2.3));
  const std::vector<std::uint32_t> beams{0, 1};
  const RangeSamples samples{6, 2, 9};
  EchoModel model;
  model.absorption_db_per_m = 0.05;
  const VolumeScattering volume{{-1}, {3e-7, 1e-7}};
  const Echo echo =
      bistatic_volume_echo(transmit, receive, receiver, {2, beams}, samples, model, volume, 0.01);

  const glm::dvec3 pa(-3, 10, -2), pb(4, 11, -2), pc(1, 10, 3), normal = glm::cross(pb - pa, pc - pa);
  const auto is_hidden = [&](glm::dvec3 from, glm::dvec3 to) {
    const double h0 = glm::dot(normal, from - pa), h1 = glm::dot(normal, to - pa);
    if (h0 * h1 >= 0) return false;
    const glm::dvec3 at = from + h0 / (h0 - h1) * (to - from);
    return glm::dot(glm::cross(pb - pa, at - pa), normal) > 0 &&
           glm::dot(glm::cross(pc - pb, at - pb), normal) > 0 &&
           glm::dot(glm::cross(pa - pc, at - pc), normal) > 0;
  };
  const auto in_tube = [](const TubeSet& set, std::size_t tube, glm::dvec3 d) {
    for (std::size_t k = 0; k < 4; ++k) {
      const auto ray = [&](std::size_t i) {
        const GridPoint& r = set.rays[set.tubes[tube][i % 4]];
        return glm::dvec3(double(r.x), double(r.y), double(r.z));
      };
      if (glm::dot(glm::cross(ray(k), ray(k + 1)), d) < 0) return false;
    }
    return true;
  };
  std::vector<double> expected(echo.energy.size(), 0);
  const double step = 0.125, beta = 0.005 * std::log(10);
  int hidden = 0;
  for (double x = -14; x < 14; x += step)
    for (double y = 2; y < 27; y += step)
      for (double z = -9; z < 9; z += step) {
        const glm::dvec3 p(x + step / 2, y + step / 2, z + step / 2), q = p - receiver;
        const double r = glm::length(p), s = glm::length(q);
        const auto k = std::ptrdiff_t(std::floor(((r + s) / 2 - samples.first_m) / samples.step_m));
        if (k < 0 || k >= samples.count || !(in_tube(transmit.tubes, 0, p) || in_tube(transmit.tubes, 1, p)))
          continue;
        for (std::size_t beam = 0; beam < 2; ++beam) {
          if (!in_tube(receive.tubes, beam, q)) continue;
          if (is_hidden({}, p) || is_hidden(receiver, p)) {
            ++hidden;
            continue;
          }
          expected[beam * 9 + std::size_t(k)] +=
              (p.z < -1 ? 3e-7 : 1e-7) * std::exp(-beta * (r + s)) / (r * r * s * s) * step * step * step;
        }
      }
  EXPECT_GT(hidden, 1000);
  const double largest = *std::ranges::max_element(expected);
  for (std::size_t bin = 0; bin < expected.size(); ++bin)
    EXPECT_NEAR(echo.energy[bin], expected[bin], 0.01 * expected[bin] + 2e-3 * largest) << "bin " << bin;
}

TEST(VolumeEcho, NarrowBeamsOfASeparateReceiverDoNotDependOnCells) {
  // Beams of half a degree, 1 m beside the transmitter.
  const auto tubes_from = [](glm::dvec3 apex_m) {
    TubeSet set;
    set.apex = GridPoint{std::int32_t(apex_m.x * 1024), std::int32_t(apex_m.y * 1024), 0};
    set.reach = 1e9;
    AngularGrid grid;
    for (int k = 0; k <= 24; ++k) grid.azimuth_edges_rad.push_back(1.2 + k * 0.0087);
    grid.elevation_edges_rad = {-0.01, 0.01};
    append_tubes(set, grid);
    return set;
  };
  FacetMesh mesh;
  const VertexId a = test::add_vertex(mesh, {0, -90000, 0}), b = test::add_vertex(mesh, {9000, -90000, 0}),
                 c = test::add_vertex(mesh, {0, -90000, 9000});
  test::add_facet(mesh, a, b, c);  // behind both ends
  VisibilityOptions options;
  options.open_water = true;
  const SceneTree tree(mesh);
  const TubeEngine engine(mesh, tree, 1.0 / 1024, options);
  const History transmit = engine.trace(tubes_from({0, 0, 0})), receive = engine.trace(tubes_from({1, 0, 0}));
  std::vector<std::uint32_t> beams(24);
  for (std::uint32_t k = 0; k < 24; ++k) beams[k] = k;
  const auto echo = [&](double cell) {
    return bistatic_volume_echo(transmit, receive, {1, 0, 0}, {24, beams}, {10, 0.5, 3}, {}, {{}, {1e-7}},
                                cell)
        .energy;
  };
  const std::vector<double> usual = echo(5e-3), fine = echo(1e-3);
  // The first beams are outside of the transmit sector.
  int inside = 0;
  for (std::size_t beam = 13; beam < 24; ++beam)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t bin = 3 * beam + k;
      EXPECT_NEAR(usual[bin], fine[bin], 0.01 * fine[bin]) << "beam " << beam << ", sample " << k;
      inside += fine[bin] > 0;
    }
  EXPECT_GT(inside, 16);
}

TEST(VolumeEcho, ReceiverAtTheTransmitterGivesTheEchoOfOneApex) {
  const RandomWater scene(5);
  const History history = scene.trace();
  std::vector<std::uint32_t> beams(scene.tubes.tubes.size());
  for (std::size_t t = 0; t < beams.size(); ++t) beams[t] = std::uint32_t(t);
  const RangeSamples samples{4, 2, 20};
  EchoModel model;
  model.absorption_db_per_m = 0.1;
  const VolumeScattering volume{{-6, 3}, {2e-7, 1e-7, 3e-7}};
  const Echo one = volume_echo(history, {int(beams.size()), beams}, samples, model, volume),
             two = bistatic_volume_echo(history, history, glm::dvec3(0), {int(beams.size()), beams}, samples,
                                        model, volume, 0.01);
  const double largest = *std::ranges::max_element(one.energy);
  for (std::size_t bin = 0; bin < one.energy.size(); ++bin)
    EXPECT_NEAR(two.energy[bin], one.energy[bin], 5e-3 * one.energy[bin] + 5e-4 * largest) << "bin " << bin;
}

TEST(VolumeEcho, WideTubeToTheNadirHasTheDepthsOfItsDirections) {
  // 40 degrees along the track, 2 degrees across.
  History history;
  history.tubes.reach = 1e9;
  test::add_pyramid(
      history.tubes,
      {glm::dvec3(0.364, 0.0175, -1), {-0.364, 0.0175, -1}, {-0.364, -0.0175, -1}, {0.364, -0.0175, -1}});
  for (const std::uint32_t ray : history.tubes.tubes[0]) {
    const GridPoint& d = history.tubes.rays[ray];
    history.footprints.open_directions.push_back(
        glm::normalize(glm::dvec3(double(d.x), double(d.y), double(d.z))));
  }
  history.footprints.open_pieces = {{0, 0, 4}};
  const WaterColumn column{SoundSpeedProfile({{0, 1500}, {1000, 1500 + 1e-6}}), {0.4, 0.4, 0.4}};
  const VolumeScattering volume{{-20, -12}, {0, 1e-7, 0}};
  const RangeSamples samples{2, 0.25, 100};
  EchoModel model;
  model.absorption_db_per_m = 0.4;
  const Echo straight = volume_echo(history, {1, single_beam}, samples, model, volume),
             refracted =
                 refracted_volume_echo(history, {1, single_beam}, samples, model, volume, {column, 0, 1500});
  const double largest = *std::ranges::max_element(straight.energy);
  ASSERT_GT(largest, 0);
  for (int k = 0; k < samples.count; ++k)
    EXPECT_NEAR(refracted.energy[std::size_t(k)], straight.energy[std::size_t(k)],
                0.01 * straight.energy[std::size_t(k)] + 2e-3 * largest)
        << "sample " << k;
}

TEST(VolumeEcho, RejectsInvalidLayersAndSamplesAtTheApex) {
  const History history = wedge_above_seabed(0.01, 3, 500);
  EXPECT_THROW(volume_of(history, {0, 0.1, 3}, {{}, {1e-7}}), std::invalid_argument);
  EXPECT_THROW(volume_of(history, {1, 0.1, 3}, {{}, {-1e-7}}), std::invalid_argument);
  EXPECT_THROW(volume_of(history, {1, 0.1, 3}, {{}, {NAN}}), std::invalid_argument);
  EXPECT_THROW(volume_of(history, {1, 0.1, 3}, {{1, 1}, {0, 1, 2}}), std::invalid_argument);
  EXPECT_THROW(volume_of(history, {1, 0.1, 3}, {{1}, {0}}), std::invalid_argument);
}

}  // namespace
}  // namespace tubefoot
