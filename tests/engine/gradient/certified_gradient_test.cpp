// SPDX-License-Identifier: GPL-3.0-or-later
// Compares certified derivatives with an oracle in 50 digits, with closed forms, and with the derivatives in
// doubles.
#include "engine/gradient/certified_gradient.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "fixtures/world/differentiated_scenes.hpp"
#include "gradient_oracle.hpp"
#include "wall_closed_form.hpp"

namespace tubefoot {
namespace {

using test::few_facets;
using test::gradient_unit_m;
using test::GradientScene;
using test::grid_point;
using test::Real;
using test::RealMotion;
using test::RealVector;
using test::wall_before_seabed;

/// A parameter with its exact motion.
struct KnownParameter {
  const char* name;
  EchoParameter parameter;
  RealMotion motion;
};

std::vector<KnownParameter> known_parameters(const GradientScene& scene) {
  const FacetMesh& mesh = scene.mesh;
  const glm::dvec3 axis = {0.25, -0.8125, 0.6}, origin(0.5, 5.25, 0.125);
  const RealVector exact = test::vector_of<Real>(axis), still{0, 0, 0};
  std::vector<bool> own(mesh.vertices.size());
  for (std::size_t f = 0; f < mesh.facets.size(); ++f)
    if (mesh.component[f] == 1)
      for (const VertexId v : mesh.facets[f]) own[v] = true;
  const auto is_own = [own](PointId id) { return !(id & ray_bit) && own[id]; };
  std::vector<KnownParameter> all;
  all.push_back(
      {"sonar translation", EchoParameter::sonar_translation(axis), {[=](PointId id, const RealVector&) {
         return id & ray_bit ? still : test::sum_of(still, -1, exact);
       }}});
  all.push_back(
      {"sonar rotation", EchoParameter::sonar_rotation(axis), {[=](PointId id, const RealVector& at) {
         return id & ray_bit ? test::cross_of(exact, at) : still;
       }}});
  all.push_back({"object translation",
                 EchoParameter::object_translation(mesh, 1, axis),
                 {[=](PointId id, const RealVector&) { return is_own(id) ? exact : still; }}});
  all.push_back({"object rotation",
                 EchoParameter::object_rotation(mesh, 1, axis, origin),
                 {[=](PointId id, const RealVector& at) {
                   return is_own(id)
                              ? test::cross_of(exact, test::sum_of(at, -1, test::vector_of<Real>(origin)))
                              : still;
                 }}});
  all.push_back({"vertex",
                 {[](PointId id, glm::dvec3) { return glm::dvec3(0, 0, id == 4); }},
                 {[=](PointId id, const RealVector&) {
                   return id == 4 ? RealVector{0, 0, 1} : still;
                 }}});
  all.push_back({"sound speed", EchoParameter::sound_speed(1500), {{}, 0, Real(1.0 / 1500), 0}});
  all.push_back({"mu", EchoParameter::material_mu(0, 1), {{}, 0, 0, 1}});
  all.push_back({"absorption", EchoParameter::absorption(), {{}, 1, 0, 0}});
  return all;
}

/// Expects that every enclosure contains the oracle's value. After a shift by twice its width, no enclosure
/// does so. Widths are relative to the largest derivative.
void expect_oracle(const GradientScene& scene, const std::vector<KnownParameter>& known) {
  const History history = scene.history();
  std::vector<EchoParameter> parameters;
  for (const KnownParameter& k : known) parameters.push_back(k.parameter);
  const CertifiedDerivatives found = scene.certified(history, parameters);
  test::GradientOracle oracle(scene.mesh, history, scene.samples, scene.mu[0], scene.absorption_db_per_m);
  for (std::size_t n = 0; n < known.size(); ++n) {
    SCOPED_TRACE(known[n].name);
    const std::vector<Real> expected = oracle.derivatives(known[n].motion);
    ASSERT_EQ(found.value[n].size(), expected.size());
    Real largest = 0;
    for (const Real& x : expected) largest = std::max(largest, Real(abs(x)));
    ASSERT_GT(largest, 0);
    const Real oracle_error = largest * Real("1e-36");
    for (std::size_t k = 0; k < expected.size(); ++k) {
      const Real value = found.value[n][k], bound = found.bound[n][k];
      EXPECT_LE(abs(value - expected[k]), bound + oracle_error) << k << ": " << value << " " << expected[k];
      EXPECT_LT(2 * bound, 1e-15 * largest) << k;
      if (bound == 0) continue;
      EXPECT_GT(abs(value + 4 * bound - expected[k]), bound + oracle_error) << k;
      EXPECT_GT(abs(value - 4 * bound - expected[k]), bound + oracle_error) << k;
    }
  }
}

TEST(CertifiedDerivatives, ContainTheOracle) {
  int intersections = 0;
  for (const std::uint64_t seed : {1, 2}) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    const GradientScene scene = few_facets(seed, 0);
    std::vector<KnownParameter> known = known_parameters(scene);
    known.pop_back();  // the oracle has no absorption below 0
    expect_oracle(scene, known);
    for (const CornerName& name : scene.history().footprints.corner_names)
      intersections += name.point == no_point && (name.p.depth || name.q.depth);
  }
  EXPECT_GT(intersections, 0);  // corners on intersections of facets
}

TEST(CertifiedDerivatives, ContainTheOracleWithAbsorption) {
  const GradientScene scene = few_facets(3, 0.375);
  const std::vector<KnownParameter> all = known_parameters(scene);
  expect_oracle(scene, {all[0], all[5], all[7]});
}

TEST(CertifiedDerivatives, OfTheShadowOfAWallContainTheClosedForm) {
  for (const std::int32_t half_width : {test::wall_half_width, test::narrow_wall_half_width}) {
    SCOPED_TRACE(half_width);
    const GradientScene scene = wall_before_seabed(half_width);
    const test::WallDerivatives wall = test::wall_derivatives(half_width, scene.mu[0]);
    const CertifiedDerivatives found = scene.certified(scene.history(), test::wall_parameters(scene.mesh));
    const Real expected[] = {wall.by_wall, wall.by_distance, wall.by_height};
    for (std::size_t n = 0; n < 3; ++n) {
      const Real value = found.value[n].at(0), bound = found.bound[n].at(0);
      EXPECT_LE(abs(value - expected[n]), bound) << n;
      EXPECT_GT(abs(value + 4 * bound - expected[n]), bound) << n;
      EXPECT_GT(abs(value - 4 * bound - expected[n]), bound) << n;
      // The contributions of both long edges cancel, except for a part in proportion to the width.
      EXPECT_LT(bound, 1e-15 * test::wall_half_width / half_width * abs(wall.by_wall)) << n;
    }
  }
}

TEST(CertifiedDerivatives, AgreeWithDoubles) {
  GradientScene scene = few_facets(4, 0.25);
  const std::vector<std::uint32_t> beams = scene.beam_of_tube();
  const History history = scene.history();
  std::vector<EchoParameter> parameters;
  for (const KnownParameter& known : known_parameters(scene)) parameters.push_back(known.parameter);
  const CertifiedDerivatives certified = scene.certified(history, parameters);
  const std::vector<std::vector<double>> found = echo_derivatives(
      scene.mesh, history, {int(beams.size()), beams}, scene.samples, scene.model(), parameters);
  for (std::size_t n = 0; n < parameters.size(); ++n) {
    double largest = 0;
    for (const double value : certified.value[n]) largest = std::max(largest, std::abs(value));
    for (std::size_t k = 0; k < found[n].size(); ++k)
      EXPECT_NEAR(found[n][k], certified.value[n][k], 1e-11 * largest) << n << " " << k;
  }
}

// The foot point lies in the polygon and on a range border. A motion towards the plane and one away from it
// have different derivatives. The disc within range R has the energy mu pi / 2 (H^-2 - H^2 R^-4).
TEST(CertifiedDerivatives, ContainBothSidesIfTheFootPointLiesOnARangeBorder) {
  GradientScene scene;
  scene.mesh.vertices = {grid_point(-30, -20, 0), grid_point(30, -20, 0), grid_point(1, 40, 0)};
  scene.mesh.facets = {{0, 1, 2}};
  scene.mesh.material = {0};
  scene.mesh.component = {0};
  scene.tubes.apex = grid_point(0, 0, 3);
  scene.tubes.reach = 30 / gradient_unit_m;
  const std::int32_t a = 1 << 28;
  scene.tubes.rays = {{a, a, -a}, {a, -a, -a}, {-a, -a, -a}, {-a, a, -a}};
  scene.tubes.tubes = {{0, 1, 2, 3}};
  scene.samples = {2.5, 0.5, 3};
  const std::vector<EchoParameter> parameters{EchoParameter::sonar_translation({0, 0, 1})};
  const CertifiedDerivatives found = scene.certified(scene.history(), parameters);
  // Derivatives of the bins [2.5, 3) and [3, 3.5) for a sonar that rises or sinks.
  const double pi = 3.141592653589793, H = 3, mu = scene.mu[0];
  const double rises = -mu * pi * (std::pow(H, -3) + H * std::pow(3.5, -4));
  const double sinks_near = -mu * pi * (std::pow(H, -3) + H * std::pow(3.0, -4)),
               sinks_far = -mu * pi * H * (std::pow(3.5, -4) - std::pow(3.0, -4));
  const auto contains = [&](std::size_t k, double x) {
    return std::abs(found.value[0][k] - x) <= found.bound[0][k] * (1 + 1e-12);
  };
  EXPECT_TRUE(contains(0, 0));
  EXPECT_TRUE(contains(0, sinks_near));
  EXPECT_TRUE(contains(1, rises));
  EXPECT_TRUE(contains(1, sinks_far));
  EXPECT_LT(found.bound[0][1], 10 * std::abs(rises));
}

TEST(CertifiedDerivatives, RejectWhatHasNone) {
  const GradientScene scene = wall_before_seabed();
  const std::vector<EchoParameter> parameters{EchoParameter::sonar_translation({0, 0, 1})};
  History unnamed = scene.history();
  unnamed.footprints.corner_names.clear();
  EXPECT_THROW(scene.certified(unnamed, parameters), std::invalid_argument);
}

}  // namespace
}  // namespace tubefoot
