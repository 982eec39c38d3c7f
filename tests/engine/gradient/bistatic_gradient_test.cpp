// SPDX-License-Identifier: GPL-3.0-or-later
// Tests gradients of energies of a transmitter and a separate receiver: central differences, laws, and the
// gradient of one apex.
#include "engine/gradient/bistatic_gradient.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <stdexcept>

#include "fixtures/world/differentiated_scenes.hpp"
#include "fixtures/world/textures.hpp"

namespace tubefoot {
namespace {

using test::gradient_unit_m;
using test::GradientScene;
using test::grid_point;
using test::rough_scene;

/// A scene of one apex and the tubes of a separate receiver. One beam per tube of the receiver.
struct BistaticScene : GradientScene {
  TubeSet receive;

  BistaticHistory both() const {
    const SceneTree tree(mesh);
    VisibilityOptions options;
    options.corner_names = true;
    return trace_bistatic(mesh, tree, gradient_unit_m, options, tubes, receive);
  }
  std::vector<double> energies_of_both() const {
    const std::vector<std::uint32_t> beams = beam_of_tube();
    return integrate_echo(both(), {int(beams.size()), beams}, samples, model(), {Binning::exact, 1e-12})
        .energy;
  }
  double energy_of_both() const {
    double sum = 0;
    for (const double energy : energies_of_both()) sum += energy;
    return sum;
  }
  EchoGradient gradient_of_both(std::span<const MaterialParameter> parameters = {}) const {
    const std::vector<std::uint32_t> beams = beam_of_tube();
    const std::vector<double> weights(bins(), 1);
    return echo_gradient(mesh, both(), {int(beams.size()), beams}, samples, model(), weights, parameters);
  }
  std::vector<std::vector<double>> derivatives_of_both(std::span<const EchoParameter> parameters) const {
    const std::vector<std::uint32_t> beams = beam_of_tube();
    return echo_derivatives(mesh, both(), {int(beams.size()), beams}, samples, model(), parameters);
  }
  void move_sonar(glm::ivec3 by) {
    for (TubeSet* set : {&tubes, &receive}) {
      set->apex.x += by.x;
      set->apex.y += by.y;
      set->apex.z += by.z;
    }
  }
};

/// A rough terrain with facets in front of it. The receiver is 2 m beside the transmitter and looks another
/// way.
BistaticScene bistatic_scene(std::uint64_t seed) {
  BistaticScene scene{rough_scene(seed), {}};
  scene.receive = test::forward_tubes(grid_point(2.03, -0.4, 2.3), 3, 1, 44, 46, 27);
  return scene;
}

double length_sum(const std::vector<glm::dvec3>& vectors) {
  double sum = 0;
  for (const glm::dvec3& v : vectors) sum += glm::length(v);
  return sum;
}

void expect_central_differences(const BistaticScene& scene, double tolerance = 1e-8, int stride = 1) {
  const EchoGradient gradient = scene.gradient_of_both();
  ASSERT_GT(scene.energy_of_both(), 0);
  constexpr std::int32_t step = 64;
  const auto difference = [&](const auto& move) {
    BistaticScene up = scene, down = scene;
    move(up, step);
    move(down, -step);
    return (up.energy_of_both() - down.energy_of_both()) / (2 * step * gradient_unit_m);
  };
  double largest = 0;
  for (const glm::dvec3& by : gradient.by_vertex) largest = std::max(largest, glm::length(by));
  ASSERT_GT(largest, 0);
  int moving = 0;
  for (std::size_t v = 0; v < scene.mesh.vertices.size(); ++v) {
    if (gradient.by_vertex[v] != glm::dvec3(0) ? moving++ % stride != 0 : v % 14 != 0) continue;
    // Each vertex moves along one axis.
    const int axis = int(v % 3);
    EXPECT_NEAR(gradient.by_vertex[v][axis], difference([&](BistaticScene& s, std::int32_t by) {
                  GridPoint& p = s.mesh.vertices[v];
                  (axis == 0 ? p.x : axis == 1 ? p.y : p.z) += by;
                }),
                tolerance * largest)
        << v;
  }
  EXPECT_GT(moving, 5);
  const double size = glm::length(gradient.by_receiver);
  EXPECT_NEAR(gradient.by_receiver.x,
              difference([](BistaticScene& s, std::int32_t by) { s.receive.apex.x += by; }),
              tolerance * size);
  EXPECT_NEAR(gradient.by_receiver.y,
              difference([](BistaticScene& s, std::int32_t by) { s.receive.apex.y += by; }),
              tolerance * size);
  EXPECT_NEAR(gradient.by_receiver.z,
              difference([](BistaticScene& s, std::int32_t by) { s.receive.apex.z += by; }),
              tolerance * size);
  const glm::dvec3 moved = test::translation_of(gradient);
  for (int axis = 0; axis < 3; ++axis)
    EXPECT_NEAR(moved[axis], difference([&](BistaticScene& s, std::int32_t by) {
                  glm::ivec3 all(0);
                  all[axis] = by;
                  s.move_sonar(all);
                }),
                tolerance * glm::length(moved))
        << axis;
}

TEST(BistaticGradient, AgreesWithCentralDifferences) {
  for (const std::uint64_t seed : {1, 2, 3}) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    const BistaticScene scene = bistatic_scene(seed);
    expect_central_differences(scene);
    const EchoGradient gradient = scene.gradient_of_both();
    BistaticScene more = scene, less = scene;
    more.absorption_db_per_m += 1e-4;
    less.absorption_db_per_m -= 1e-4;
    EXPECT_NEAR(gradient.by_absorption, (more.energy_of_both() - less.energy_of_both()) / 2e-4,
                1e-6 * std::abs(gradient.by_absorption));
    EXPECT_NEAR(gradient.by_material_mu[0], scene.energy_of_both() / scene.mu[0],
                1e-8 * gradient.by_material_mu[0]);
  }
}

// Each corner of such a scene is an occlusion of the transmitter, one of the receiver, or a wall of a tube.
TEST(BistaticGradient, OfEdgesOfBothApexesContributes) {
  const BistaticHistory history = bistatic_scene(1).both();
  ASSERT_EQ(history.shared.edges.size(), history.shared.corners_m.size());
  std::size_t of_receiver = 0;
  for (const SharedFacet& facet : history.shared.facets)
    for (std::uint32_t p = 0; p < facet.piece_count; ++p) {
      const SharedPiece& piece = history.shared.pieces[facet.first_piece + p];
      for (std::uint32_t k = 0; k < piece.count; ++k) {
        const SharedEdge& edge = history.shared.edges[piece.first + k];
        of_receiver += edge.of_receiver;
        // The line of the edge contains both ends.
        const glm::dvec3 line = glm::normalize(edge.to_m - edge.from_m);
        for (const std::uint32_t c : {k, (k + 1) % piece.count}) {
          const glm::dvec3 from = history.shared.corners_m[piece.first + c] - edge.from_m;
          EXPECT_LT(glm::length(glm::cross(line, from)), 1e-9) << c;
        }
      }
    }
  EXPECT_GT(of_receiver, 20u);
  EXPECT_LT(of_receiver, history.shared.edges.size() - 20);
}

TEST(BistaticGradient, OfARotationOfEverythingIsZero) {
  const BistaticScene scene = bistatic_scene(4);
  const BistaticHistory history = scene.both();
  const EchoGradient gradient = scene.gradient_of_both();
  glm::dvec3 rotation(0);
  double scale = 0;
  const auto turn = [&](glm::dvec3 at, glm::dvec3 by) {
    rotation += glm::cross(at, by);
    scale += glm::length(glm::cross(at, by));
  };
  const auto vector = [](GridPoint p) { return glm::dvec3(p.x, p.y, p.z); };
  for (std::size_t k = 0; k < gradient.by_ray.size(); ++k)
    turn(vector(history.shared.transmit_rays[k]), gradient.by_ray[k]);
  for (std::size_t k = 0; k < gradient.by_receive_ray.size(); ++k)
    turn(vector(history.shared.receive_rays[k]), gradient.by_receive_ray[k]);
  for (std::size_t v = 0; v < gradient.by_vertex.size(); ++v)
    turn(gradient_unit_m * vector(scene.mesh.vertices[v] - scene.tubes.apex), gradient.by_vertex[v]);
  turn(history.shared.receiver_m, gradient.by_receiver);
  ASSERT_GT(scale, 0);
  EXPECT_GT(length_sum(gradient.by_receive_ray), 0);
  EXPECT_LT(glm::length(rotation), 1e-8 * scale);
}

// Energies have the factor s^-2 if all lengths have the factor s and the absorption 1 / s.
TEST(BistaticGradient, OfTheScaleOfEverythingIsMinusTwoEnergies) {
  const BistaticScene scene = bistatic_scene(5);
  const EchoGradient gradient = scene.gradient_of_both();
  double sum = 0, scale = 0;
  const auto add = [&](double value) {
    sum += value;
    scale += std::abs(value);
  };
  for (std::size_t v = 0; v < gradient.by_vertex.size(); ++v) {
    const GridPoint p = scene.mesh.vertices[v] - scene.tubes.apex;
    add(glm::dot(gradient_unit_m * glm::dvec3(p.x, p.y, p.z), gradient.by_vertex[v]));
  }
  add(glm::dot(scene.both().shared.receiver_m, gradient.by_receiver));
  add(gradient.by_range_scale);
  add(-scene.absorption_db_per_m * gradient.by_absorption);
  EXPECT_NEAR(sum, -2 * scene.energy_of_both(), 1e-8 * scale);
}

TEST(BistaticGradient, InOnePlaceIsTheGradientOfOneApex) {
  GradientScene one = rough_scene(6);
  const BistaticScene scene{one, one.tubes};
  const EchoGradient both = scene.gradient_of_both(), alone = scene.gradient();
  double size = 0;
  for (const glm::dvec3& by : alone.by_vertex) size = std::max(size, glm::length(by));
  for (std::size_t v = 0; v < alone.by_vertex.size(); ++v)
    EXPECT_LT(glm::distance(both.by_vertex[v], alone.by_vertex[v]), 1e-9 * size) << v;
  EXPECT_NEAR(both.by_absorption, alone.by_absorption, 1e-9 * std::abs(alone.by_absorption));
  EXPECT_NEAR(both.by_range_scale, alone.by_range_scale, 1e-9 * std::abs(alone.by_range_scale));
  EXPECT_NEAR(both.by_material_mu[0], alone.by_material_mu[0], 1e-9 * alone.by_material_mu[0]);
  ASSERT_EQ(both.by_ray.size(), alone.by_ray.size());
  const double rays = length_sum(alone.by_ray);
  for (std::size_t k = 0; k < alone.by_ray.size(); ++k)
    EXPECT_LT(glm::distance(both.by_ray[k] + both.by_receive_ray[k], alone.by_ray[k]), 1e-9 * rays) << k;
}

// One beam and one tube of each apex, which change places.
TEST(BistaticGradient, OfExchangedApexesIsTheSame) {
  BistaticScene scene = bistatic_scene(7);
  scene.tubes = test::forward_tubes(scene.tubes.apex, 1, 1, 40, 50, 30);
  scene.receive = test::forward_tubes(scene.receive.apex, 1, 1, 44, 46, 27);
  BistaticScene back = scene;
  std::swap(back.tubes, back.receive);
  const EchoGradient gradient = scene.gradient_of_both(), exchanged = back.gradient_of_both();
  const double size = length_sum(gradient.by_vertex);
  for (std::size_t v = 0; v < gradient.by_vertex.size(); ++v)
    EXPECT_LT(glm::distance(gradient.by_vertex[v], exchanged.by_vertex[v]), 1e-9 * size) << v;
  glm::dvec3 all(0);
  for (const glm::dvec3& by : gradient.by_vertex) all += by;
  EXPECT_LT(glm::length(gradient.by_receiver + all + exchanged.by_receiver), 1e-9 * size);
  ASSERT_EQ(gradient.by_ray.size(), exchanged.by_receive_ray.size());
  const double rays = length_sum(gradient.by_ray);
  for (std::size_t k = 0; k < gradient.by_ray.size(); ++k)
    EXPECT_LT(glm::distance(gradient.by_ray[k], exchanged.by_receive_ray[k]), 1e-9 * rays) << k;
}

TEST(BistaticDerivatives, AgreeWithTheReverseGradient) {
  const BistaticScene scene = bistatic_scene(8);
  const BistaticHistory history = scene.both();
  const EchoGradient gradient = scene.gradient_of_both();
  std::vector<EchoParameter> parameters;
  std::vector<double> expected, scale;
  const auto add = [&](EchoParameter parameter, double value, double size) {
    parameters.push_back(std::move(parameter));
    expected.push_back(value);
    scale.push_back(size);
  };
  const auto turned = [](const std::vector<GridPoint>& rays, const std::vector<glm::dvec3>& by,
                         glm::dvec3 axis) {
    double sum = 0;
    for (std::size_t k = 0; k < rays.size(); ++k)
      sum += glm::dot(by[k], glm::cross(axis, glm::dvec3(rays[k].x, rays[k].y, rays[k].z)));
    return sum;
  };
  const double size = length_sum(gradient.by_vertex);
  for (const glm::dvec3 axis : {glm::dvec3(1, 0, 0), glm::dvec3(0, 1, 0), glm::dvec3(0, 0, 1)}) {
    add(EchoParameter::sonar_translation(axis), glm::dot(test::translation_of(gradient), axis), size);
    const double own = turned(history.shared.transmit_rays, gradient.by_ray, axis) +
                       turned(history.shared.receive_rays, gradient.by_receive_ray, axis);
    add(EchoParameter::mounting_rotation(axis), own, 10 * size);
    add(EchoParameter::sonar_rotation(axis),
        own + glm::dot(gradient.by_receiver, glm::cross(axis, history.shared.receiver_m)), 10 * size);
    EchoParameter receiver;
    receiver.velocity = [axis](PointId id, glm::dvec3) { return id == receive_apex ? axis : glm::dvec3(0); };
    add(receiver, glm::dot(gradient.by_receiver, axis), size);
  }
  add(EchoParameter::material_mu(0, 1), gradient.by_material_mu[0], gradient.by_material_mu[0]);
  add(EchoParameter::absorption(), gradient.by_absorption, -gradient.by_absorption);
  const std::vector<std::vector<double>> found = scene.derivatives_of_both(parameters);
  for (std::size_t n = 0; n < parameters.size(); ++n) {
    double sum = 0;
    for (const double value : found[n]) sum += value;
    EXPECT_NEAR(sum, expected[n], 1e-11 * scale[n]) << "parameter " << n;
  }
}

TEST(BistaticDerivatives, OfEachBinAgreeWithCentralDifferences) {
  const BistaticScene scene = bistatic_scene(9);
  const double speed = 1500, step = 1e-3;
  const std::vector<std::vector<double>> found = scene.derivatives_of_both(std::vector<EchoParameter>{
      EchoParameter::sound_speed(speed), EchoParameter::sonar_translation({0, 0, 1})});
  const auto energies = [&](double scale, std::int32_t higher) {
    BistaticScene moved = scene;
    moved.samples.first_m *= scale;
    moved.samples.step_m *= scale;
    moved.move_sonar({0, 0, higher});
    return moved.energies_of_both();
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

TEST(BistaticGradient, OfAScatteringModelAgreesWithCentralDifferences) {
  ScatteringModel::Gsab parameters;
  parameters.specular = 0.2;
  parameters.specular_width_rad = 0.3;
  parameters.oblique = 0.01;
  parameters.oblique_exponent = 1.7;
  parameters.transition = 0.03;
  parameters.transition_width_rad = 0.6;
  BistaticScene scene = bistatic_scene(10);
  const auto use = [](BistaticScene& of, const ScatteringModel::Gsab& with) {
    of.scattering = {std::make_shared<const ScatteringModel>(ScatteringModel::gsab(with))};
  };
  use(scene, parameters);
  expect_central_differences(scene);
  using Which = ScatteringDerivative::Gsab;
  const std::vector<std::pair<Which, double ScatteringModel::Gsab::*>> all{
      {Which::specular, &ScatteringModel::Gsab::specular},
      {Which::specular_width_rad, &ScatteringModel::Gsab::specular_width_rad},
      {Which::oblique_exponent, &ScatteringModel::Gsab::oblique_exponent}};
  std::vector<MaterialParameter> own;
  for (const auto& [which, member] : all) own.push_back({0, ScatteringDerivative::gsab(parameters, which)});
  const EchoGradient gradient = scene.gradient_of_both(own);
  for (std::size_t k = 0; k < all.size(); ++k) {
    const double step = 1e-4;
    BistaticScene more = scene, less = scene;
    ScatteringModel::Gsab up = parameters, down = parameters;
    up.*all[k].second += step;
    down.*all[k].second -= step;
    use(more, up);
    use(less, down);
    EXPECT_NEAR(gradient.by_scattering[k], (more.energy_of_both() - less.energy_of_both()) / (2 * step),
                2e-6 * std::abs(gradient.by_scattering[k]))
        << k;
  }
}

// The slopes of a table jump at its angles, so that energies and derivatives have errors there.
TEST(BistaticGradient, OfATableOfScatteringAgreesWithCentralDifferences) {
  const std::vector<double> angles{5, 20, 45, 70}, levels{-35, -28, -22, -12};
  BistaticScene scene = bistatic_scene(13);
  scene.tubes = test::forward_tubes(scene.tubes.apex, 1, 1, 14, 20, 30);
  scene.receive = test::forward_tubes(scene.receive.apex, 1, 1, 44, 46, 27);
  scene.scattering = {std::make_shared<const ScatteringModel>(ScatteringModel::table(angles, levels))};
  expect_central_differences(scene, 5e-5, 2);
}

TEST(BistaticGradient, OfTexturesAgreesWithCentralDifferences) {
  const auto map = test::random_map(5, 4, 3, {{0.3, 0.2}, {1.1, 0.2}, {-0.1, 0.9}, true});
  BistaticScene scene = bistatic_scene(12);
  scene.reflectivity = {test::perlin(1.5, 2)};
  expect_central_differences(scene, 1e-6);
  scene.reflectivity = {map};
  expect_central_differences(scene, 1e-6);
}

TEST(BistaticGradient, RejectsWhatHasNone) {
  const BistaticScene scene = bistatic_scene(11);
  const std::vector<std::uint32_t> beams = scene.beam_of_tube();
  const ReceiveBeams all{int(beams.size()), beams};
  const std::vector<double> weights(scene.bins(), 1);
  BistaticHistory unnamed = scene.both();
  unnamed.shared.edges.clear();
  EXPECT_THROW(echo_gradient(scene.mesh, unnamed, all, scene.samples, scene.model(), weights),
               std::invalid_argument);
  EXPECT_THROW(echo_gradient(scene.mesh, scene.both(), all, scene.samples, scene.model(),
                             std::span(weights).first(13)),
               std::invalid_argument);
  BistaticScene with_patterns = scene;
  with_patterns.patterns =
      BeamPatterns{{Directivity()}, {Directivity()}, {0, 0, 0}, {{0, 1}, {0, 1}, {0, 1}}};
  EXPECT_THROW(with_patterns.derivatives_of_both({}), std::invalid_argument);
}

}  // namespace
}  // namespace tubefoot
