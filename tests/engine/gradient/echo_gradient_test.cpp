// SPDX-License-Identifier: GPL-3.0-or-later
// Tests gradients of energies for fixed combinatorics: closed forms, laws, and central differences.
#include "engine/gradient/echo_gradient.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>

#include "fixtures/world/differentiated_scenes.hpp"
#include "wall_closed_form.hpp"

namespace tubefoot {
namespace {

using test::gradient_unit_m;
using test::GradientScene;
using test::rough_scene;
using test::translation_of;

TEST(EchoGradient, OfTheShadowOfAWallIsTheClosedForm) {
  for (const std::int32_t half_width : {test::wall_half_width, test::narrow_wall_half_width}) {
    SCOPED_TRACE(half_width);
    const GradientScene scene = test::wall_before_seabed(half_width);
    const test::WallDerivatives wall = test::wall_derivatives(half_width, scene.mu[0]);
    const double energy = double(wall.energy),
                 expected[] = {double(wall.by_wall), double(wall.by_distance), double(wall.by_height)};
    EXPECT_NEAR(scene.energy(), energy, 1e-9 * energy);
    const EchoGradient gradient = scene.gradient();
    const auto& by = gradient.by_vertex;
    const double reverse[] = {by[6].z + by[7].z, by[4].x + by[5].x + by[6].x + by[7].x,
                              translation_of(gradient).z};
    const std::vector<std::vector<double>> forward = scene.derivatives(test::wall_parameters(scene.mesh));
    for (std::size_t n = 0; n < 3; ++n) {
      EXPECT_NEAR(reverse[n], expected[n], 1e-9 * std::abs(expected[n])) << n;
      EXPECT_NEAR(forward[n].at(0), expected[n], 1e-9 * std::abs(expected[n])) << n;
    }
    EXPECT_NEAR(gradient.by_material_mu[0], energy / scene.mu[0], 1e-9 * energy / scene.mu[0]);
  }
}

// The check values are those of a wall whose distance is the same in all directions of a fan of 0.01 rad. A
// narrow tube sees such a wall.
TEST(EchoGradient, OfTheShadowOfAWallHasTheCheckValues) {
  const GradientScene scene = test::wall_before_seabed(test::narrow_wall_half_width);
  const double factor = 0.01 / (2 * std::atan(test::narrow_wall_half_width / 0x1p28));
  EXPECT_NEAR(factor * scene.energy(), 9.091844360675e-9, 1e-9 * 9e-9);
  const std::vector<std::vector<double>> found = scene.derivatives(test::wall_parameters(scene.mesh));
  const double values[] = {-5.031615580812e-8, -3.144759738007e-8, -1.931701426985e-9};
  for (std::size_t n = 0; n < 3; ++n)
    EXPECT_NEAR(factor * found[n].at(0), values[n], 1e-9 * std::abs(values[n])) << n;
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
