// SPDX-License-Identifier: GPL-3.0-or-later
// Tests gradients of energies for fixed combinatorics: closed forms, laws, and central differences.
#include "engine/gradient/echo_gradient.hpp"

#include <gtest/gtest.h>

#include <boost/math/quadrature/gauss_kronrod.hpp>
#include <cmath>
#include <glm/geometric.hpp>

#include "fixtures/world/differentiated_scenes.hpp"

namespace tubefoot {
namespace {

using test::gradient_unit_m;
using test::GradientScene;
using test::grid_point;
using test::rough_scene;
using test::translation_of;

/// Tangent of half the width of the tube in wall_scene(), times 2^28.
constexpr std::int32_t half_width = 1342177;

/// A flat seabed and a thin wall before it, seen by one narrow tube.
GradientScene wall_scene(double height, double wall, double distance, double from_m, double to_m) {
  GradientScene scene;
  scene.mesh.vertices = {grid_point(-20, -20, 0),       grid_point(20, -20, 0),
                         grid_point(20, 20, 0),         grid_point(-20, 20, 0),
                         grid_point(distance, -3, 0),   grid_point(distance, 3, 0),
                         grid_point(distance, 3, wall), grid_point(distance, -3, wall)};
  scene.mesh.facets = {{0, 1, 2}, {0, 2, 3}, {4, 5, 6}, {4, 6, 7}};
  scene.mesh.material = {0, 0, 0, 0};
  scene.mesh.component = {0, 0, 1, 1};
  scene.tubes.apex = grid_point(0, 0, height);
  scene.tubes.reach = 30 / gradient_unit_m;
  AngularGrid grid;
  grid.azimuth_edges_rad = {-0.005, 0.005};
  grid.elevation_edges_rad = {-1.2, -0.1};
  grid.frame = glm::dmat3(glm::dvec3(1, 0, 0), glm::dvec3(0, -1, 0), glm::dvec3(0, 0, 1));
  append_tubes(scene.tubes, grid);
  // Rays whose azimuth is exact in spite of their rounding.
  for (GridPoint& ray : scene.tubes.rays)
    ray = {1 << 28, ray.y < 0 ? -half_width : half_width,
           std::int32_t(std::lround((1 << 28) * (double(ray.z) / ray.x)))};
  scene.samples = {from_m, to_m - from_m, 1};
  return scene;
}

/// Derivatives of the energy of the seabed behind the wall. The closed form in range is mu H^2 / 4 (r_s^-4 -
/// r_1^-4), with the shadow border x = d H / (H - h). The azimuth is integrated numerically.
struct WallDerivatives {
  double energy = 0, by_wall = 0, by_distance = 0, by_height = 0;
};
WallDerivatives wall_derivatives(double H, double h, double d, double r1, double w, double mu) {
  const auto integral = [&](const auto& f) {
    return boost::math::quadrature::gauss_kronrod<double, 31>::integrate(f, -w / 2, w / 2, 0);
  };
  const double x = d * H / (H - h);
  const auto r_squared = [&](double phi) { return H * H + x * x / (std::cos(phi) * std::cos(phi)); };
  const auto by_x = [&](double phi) {
    return -4 * std::pow(r_squared(phi), -3) * x / (std::cos(phi) * std::cos(phi));
  };
  WallDerivatives all;
  const double factor = mu * H * H / 4;
  all.energy = factor * integral([&](double phi) { return std::pow(r_squared(phi), -2) - std::pow(r1, -4); });
  const double along = factor * integral(by_x);
  all.by_wall = along * d * H / ((H - h) * (H - h));
  all.by_distance = along * H / (H - h);
  all.by_height = 2 * all.energy / H + along * -d * h / ((H - h) * (H - h)) +
                  factor * integral([&](double phi) { return -4 * H * std::pow(r_squared(phi), -3); });
  return all;
}

TEST(EchoGradient, OfTheShadowOfAWallIsTheClosedForm) {
  const double H = 3, h = 0.5, d = 4, r1 = 6;
  const GradientScene scene = wall_scene(H, h, d, 5.2, r1);
  const double w = 2 * std::atan2(half_width, 1 << 28);
  const WallDerivatives expected = wall_derivatives(H, h, d, r1, w, scene.mu[0]);
  EXPECT_NEAR(expected.energy, 9.091844360675e-9, 1e-4 * 9e-9);  // gradients.md
  EXPECT_NEAR(expected.by_wall, -5.031615580812e-8, 1e-4 * 5e-8);
  EXPECT_NEAR(expected.by_distance, -3.144759738007e-8, 1e-4 * 3e-8);
  EXPECT_NEAR(expected.by_height, -1.931701426985e-9, 1e-3 * 2e-9);
  EXPECT_NEAR(scene.energy(), expected.energy, 1e-9 * expected.energy);
  const EchoGradient gradient = scene.gradient();
  const auto& by = gradient.by_vertex;
  const double scale = std::abs(expected.by_wall);
  EXPECT_NEAR(by[6].z + by[7].z, expected.by_wall, 1e-9 * scale);
  EXPECT_NEAR(by[4].x + by[5].x + by[6].x + by[7].x, expected.by_distance, 1e-9 * scale);
  EXPECT_NEAR(translation_of(gradient).z, expected.by_height, 1e-9 * scale);
  EXPECT_NEAR(gradient.by_material_mu[0], expected.energy / scene.mu[0],
              1e-9 * expected.energy / scene.mu[0]);
}

// Central differences move integer coordinates by far more than a grid unit.
TEST(EchoGradient, AgreesWithCentralDifferences) {
  for (const std::uint64_t seed : {1, 2, 3}) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    const GradientScene scene = rough_scene(seed);
    const EchoGradient gradient = scene.gradient();
    ASSERT_GT(scene.energy(), 0);
    constexpr std::int32_t step = 64;
    const double step_m = step * gradient_unit_m;
    const auto difference = [&](const auto& move) {
      GradientScene up = scene, down = scene;
      move(up, step);
      move(down, -step);
      return (up.energy() - down.energy()) / (2 * step_m);
    };
    double largest = 0;
    for (const glm::dvec3& by : gradient.by_vertex) largest = std::max(largest, glm::length(by));
    ASSERT_GT(largest, 0);
    for (std::size_t v = 0; v < scene.mesh.vertices.size(); v += 7) {
      EXPECT_NEAR(gradient.by_vertex[v].z,
                  difference([&](GradientScene& s, std::int32_t by) { s.mesh.vertices[v].z += by; }),
                  1e-6 * largest)
          << v;
      EXPECT_NEAR(gradient.by_vertex[v].x,
                  difference([&](GradientScene& s, std::int32_t by) { s.mesh.vertices[v].x += by; }),
                  1e-6 * largest)
          << v;
    }
    const glm::dvec3 moved = translation_of(gradient);
    const double size = glm::length(moved);
    EXPECT_NEAR(moved.x, difference([](GradientScene& s, std::int32_t by) { s.tubes.apex.x += by; }),
                1e-6 * size);
    EXPECT_NEAR(moved.y, difference([](GradientScene& s, std::int32_t by) { s.tubes.apex.y += by; }),
                1e-6 * size);
    EXPECT_NEAR(moved.z, difference([](GradientScene& s, std::int32_t by) { s.tubes.apex.z += by; }),
                1e-6 * size);
    const double alpha = scene.absorption_db_per_m, change = 1e-4;
    GradientScene more = scene, less = scene;
    more.absorption_db_per_m = alpha + change;
    less.absorption_db_per_m = alpha - change;
    EXPECT_NEAR(gradient.by_absorption, (more.energy() - less.energy()) / (2 * change),
                1e-6 * std::abs(gradient.by_absorption));
  }
}

// A rotation of mesh and tubes about the apex changes nothing.
TEST(EchoGradient, OfARotationOfEverythingIsZero) {
  const GradientScene scene = rough_scene(4);
  const EchoGradient gradient = scene.gradient();
  const std::vector<glm::dvec3> rays = scene.rays();
  glm::dvec3 rotation(0);
  double scale = 0;
  for (std::size_t k = 0; k < rays.size(); ++k) rotation += glm::cross(rays[k], gradient.by_ray[k]);
  for (std::size_t v = 0; v < gradient.by_vertex.size(); ++v) {
    const GridPoint p = scene.mesh.vertices[v] - scene.tubes.apex;
    const glm::dvec3 turned = glm::cross(gradient_unit_m * glm::dvec3(p.x, p.y, p.z), gradient.by_vertex[v]);
    rotation += turned;
    scale += glm::length(turned);
  }
  ASSERT_GT(scale, 0);
  EXPECT_LT(glm::length(rotation), 1e-9 * scale);
}

// Sums of forward derivatives over all bins equal products of the reverse gradient with velocities.
TEST(EchoDerivatives, AgreeWithTheReverseGradient) {
  for (const std::uint64_t seed : {5, 6}) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    const GradientScene scene = rough_scene(seed);
    const EchoGradient gradient = scene.gradient();
    const std::vector<std::uint32_t> beams = scene.beam_of_tube();
    const std::vector<glm::dvec3> rays = scene.rays();
    std::vector<EchoParameter> parameters;
    std::vector<double> expected, scale;
    const auto add = [&](EchoParameter parameter, double value, double size) {
      parameters.push_back(std::move(parameter));
      expected.push_back(value);
      scale.push_back(size);
    };
    for (const glm::dvec3 axis : {glm::dvec3(1, 0, 0), glm::dvec3(0, 1, 0), glm::dvec3(0, 0, 1)}) {
      double size = 0, turned = 0, turned_size = 0;
      for (const glm::dvec3& by : gradient.by_vertex) size += std::abs(glm::dot(by, axis));
      for (std::size_t k = 0; k < rays.size(); ++k) {
        const double more = glm::dot(gradient.by_ray[k], glm::cross(axis, rays[k]));
        turned += more;
        turned_size += std::abs(more);
      }
      add(EchoParameter::sonar_translation(axis), glm::dot(translation_of(gradient), axis), size);
      add(EchoParameter::sonar_rotation(axis), turned, turned_size);
    }
    add(EchoParameter::material_mu(0, 1), gradient.by_material_mu[0], gradient.by_material_mu[0]);
    add(EchoParameter::absorption(), gradient.by_absorption, -gradient.by_absorption);
    const std::vector<std::vector<double>> found = echo_derivatives(
        scene.mesh, scene.history(), {int(beams.size()), beams}, scene.samples, scene.model(), parameters);
    for (std::size_t n = 0; n < parameters.size(); ++n) {
      double sum = 0;
      for (const double value : found[n]) sum += value;
      EXPECT_NEAR(sum, expected[n], 1e-11 * scale[n]) << "parameter " << n;
    }
  }
}

// The derivative by the sound speed moves all borders of range bins.
TEST(EchoDerivatives, OfEachBinAgreeWithCentralDifferences) {
  const GradientScene scene = rough_scene(7);
  const std::vector<std::uint32_t> beams = scene.beam_of_tube();
  const double speed = 1500, step = 1e-3;
  const std::vector<EchoParameter> parameters{EchoParameter::sound_speed(speed),
                                              EchoParameter::sonar_translation({0, 0, 1})};
  const ReceiveBeams all{int(beams.size()), beams};
  const std::vector<std::vector<double>> found =
      echo_derivatives(scene.mesh, scene.history(), all, scene.samples, scene.model(), parameters);
  const auto energies = [&](double scale, std::int32_t higher) {
    GradientScene moved = scene;
    moved.samples.first_m *= scale;
    moved.samples.step_m *= scale;
    moved.tubes.apex.z += higher;
    return integrate_echo(moved.history(), all, moved.samples, moved.model()).energy;
  };
  const std::vector<double> faster = energies(1 + step / speed, 0), slower = energies(1 - step / speed, 0),
                            up = energies(1, 64), down = energies(1, -64);
  double largest[2] = {};
  for (std::size_t n = 0; n < 2; ++n)
    for (const double value : found[n]) largest[n] = std::max(largest[n], std::abs(value));
  ASSERT_GT(largest[0], 0);
  for (std::size_t k = 0; k < faster.size(); ++k) {
    EXPECT_NEAR(found[0][k], (faster[k] - slower[k]) / (2 * step), 1e-6 * largest[0]) << k;
    EXPECT_NEAR(found[1][k], (up[k] - down[k]) / (128 * gradient_unit_m), 1e-6 * largest[1]) << k;
  }
}

TEST(EchoDerivatives, RejectWhatHasNone) {
  const GradientScene scene = rough_scene(8);
  const std::vector<std::uint32_t> beams = scene.beam_of_tube();
  const ReceiveBeams all{int(beams.size()), beams};
  const std::vector<double> weights(3 * 14, 1);
  History unnamed = scene.history();
  unnamed.footprints.corner_names.clear();
  EXPECT_THROW(echo_gradient(scene.mesh, unnamed, all, scene.samples, scene.model(), weights),
               std::invalid_argument);
  EXPECT_THROW(echo_gradient(scene.mesh, scene.history(), all, scene.samples, scene.model(),
                             std::span(weights).first(13)),
               std::invalid_argument);
  std::vector<double> bad = weights;
  bad[5] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(echo_gradient(scene.mesh, scene.history(), all, scene.samples, scene.model(), bad),
               std::invalid_argument);
  FacetMesh two = scene.mesh;
  two.component[0] = 1;
  EXPECT_THROW(EchoParameter::object_translation(two, 1, {1, 0, 0}), std::invalid_argument);
}

}  // namespace
}  // namespace tubefoot
