// SPDX-License-Identifier: GPL-3.0-or-later
// Compares derivatives with central differences in rational arithmetic, inside of one combinatorial cell.
// Points move exactly, rotations by rational points of the circle. Corners are rational functions of their
// names. Energies have 50 digits.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "fixtures/world/differentiated_scenes.hpp"
#include "gradient_oracle.hpp"

namespace tubefoot {
namespace {

using test::cross_of;
using test::dot_of;
using test::few_facets;
using test::gradient_unit_m;
using test::GradientScene;
using test::Rational;
using test::RationalVector;
using test::Real;
using test::sum_of;
using Changes = test::GradientOracle::Changes;

/// A parameter with its exact motion. `number`: a rational that determines the value of the parameter.
struct ExactParameter {
  const char* name;
  EchoParameter parameter;
  std::function<RationalVector(PointId, const RationalVector& at, const Rational& number)> place{};
  /// Numbers are values, or tangents of half an angle times `rate`.
  bool turns = false;
  Real rate = 1;
  std::function<Changes(const Real& value)> changes{};

  Real value(const Rational& number) const {
    return turns ? Real(2 * atan(Real(number) * rate) / rate) : Real(number);
  }
};

/// Rotation about an axis. The tangent of half the angle is `number` times the length of the axis (Cayley).
RationalVector turned_by(const RationalVector& axis, const Rational& number, const RationalVector& at) {
  const RationalVector across = cross_of(axis, at);
  const Rational factor = 2 * number / (1 + number * number * dot_of(axis, axis));
  return sum_of(at, factor, sum_of(across, number, cross_of(axis, across)));
}

Real length_of(const RationalVector& v) { return sqrt(Real(dot_of(v, v))); }

/// The attitude of a sonar on a carrier is carrier * yaw * tilt * roll. The tangents of half the angles are
/// rational.
struct ExactMounting {
  const RationalVector x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1}, carrier{1, 2, -3};
  const Rational carrier_angle{1, 5}, yaw{-1, 8}, tilt{-1, 6}, roll{1, 7};

  /// Returns a ray of the sonar in the local frame after changes of the tangents for tilt and roll.
  RationalVector outwards(const RationalVector& ray, const Rational& tilted, const Rational& rolled) const {
    const RationalVector in_carrier = turned_by(
        z, yaw, turned_by(x, tilt, turned_by(x, tilted, turned_by(y, roll, turned_by(y, rolled, ray)))));
    return turned_by(carrier, carrier_angle, in_carrier);
  }
  RationalVector inwards(const RationalVector& ray) const {
    return turned_by(y, -roll,
                     turned_by(x, -tilt, turned_by(z, -yaw, turned_by(carrier, -carrier_angle, ray))));
  }
  glm::dvec3 rounded(const RationalVector& v) const { return {double(v[0]), double(v[1]), double(v[2])}; }
  glm::dvec3 tilt_axis() const { return rounded(turned_by(carrier, carrier_angle, turned_by(z, yaw, x))); }
  glm::dvec3 roll_axis() const {
    return rounded(turned_by(carrier, carrier_angle, turned_by(z, yaw, turned_by(x, tilt, y))));
  }
};

std::vector<ExactParameter> exact_parameters(const GradientScene& scene) {
  const FacetMesh& mesh = scene.mesh;
  const glm::dvec3 axis(0.25, -0.8125, 0.625), origin(0.5, 5.25, 0.125);
  const RationalVector a = test::vector_of<Rational>(axis), o = test::vector_of<Rational>(origin);
  std::vector<bool> own(mesh.vertices.size());
  for (std::size_t f = 0; f < mesh.facets.size(); ++f)
    if (mesh.component[f] == 1)
      for (const VertexId v : mesh.facets[f]) own[v] = true;
  const auto is_ray = [](PointId id) { return (id & ray_bit) != 0; };
  const auto is_own = [own](PointId id) { return !(id & ray_bit) && own[id]; };
  const ExactMounting mounting;
  std::vector<ExactParameter> all;
  all.push_back({"sonar translation", EchoParameter::sonar_translation(axis),
                 [=](PointId id, const RationalVector& at, const Rational& number) {
                   return is_ray(id) ? at : sum_of(at, -number, a);
                 }});
  all.push_back({"sonar rotation", EchoParameter::sonar_rotation(axis),
                 [=](PointId id, const RationalVector& at, const Rational& number) {
                   return is_ray(id) ? turned_by(a, number, at) : at;
                 },
                 true, length_of(a)});
  all.push_back({"mounting tilt", EchoParameter::sonar_rotation(mounting.tilt_axis()),
                 [=](PointId id, const RationalVector& at, const Rational& number) {
                   return is_ray(id) ? mounting.outwards(mounting.inwards(at), number, 0) : at;
                 },
                 true});
  all.push_back({"mounting roll", EchoParameter::sonar_rotation(mounting.roll_axis()),
                 [=](PointId id, const RationalVector& at, const Rational& number) {
                   return is_ray(id) ? mounting.outwards(mounting.inwards(at), 0, number) : at;
                 },
                 true});
  all.push_back({"object translation", EchoParameter::object_translation(mesh, 1, axis),
                 [=](PointId id, const RationalVector& at, const Rational& number) {
                   return is_own(id) ? sum_of(at, number, a) : at;
                 }});
  all.push_back({"object rotation", EchoParameter::object_rotation(mesh, 1, axis, origin),
                 [=](PointId id, const RationalVector& at, const Rational& number) {
                   return is_own(id) ? sum_of(o, 1, turned_by(a, number, sum_of(at, -1, o))) : at;
                 },
                 true, length_of(a)});
  all.push_back({"vertex",
                 {[](PointId id, glm::dvec3) { return glm::dvec3(0, 0, id == 4); }},
                 [=](PointId id, const RationalVector& at, const Rational& number) {
                   return id == 4 ? sum_of(at, number, mounting.z) : at;
                 }});
  all.push_back(
      {.name = "mu", .parameter = EchoParameter::material_mu(0, 1), .changes = [](const Real& value) {
         return Changes{0, 0, value};
       }});
  all.push_back({.name = "sound speed",
                 .parameter = EchoParameter::sound_speed(1500),
                 .changes = [](const Real& value) {
                   return Changes{0, value / 1500, 0};
                 }});
  all.push_back(
      {.name = "absorption", .parameter = EchoParameter::absorption(), .changes = [](const Real& value) {
         return Changes{value, 0, 0};
       }});
  return all;
}

/// More than 10^3 grid units. Rotations move points at 1 m from the axis by the angle in metres.
constexpr std::int32_t cell_units = 1024;

std::vector<Real> moved_energies(test::GradientOracle& oracle, const test::Places<Rational>& rest,
                                 const ExactParameter& parameter, const Rational& number) {
  const test::Places<Rational> places = [&](PointId id) {
    const RationalVector at = rest(id);
    return parameter.place ? parameter.place(id, at, number) : at;
  };
  return oracle.energies(places, parameter.changes ? parameter.changes(parameter.value(number)) : Changes{});
}

/// A closed box above a terrain, whose facets share edges and planes.
GradientScene box_above_terrain() {
  GradientScene scene = few_facets(7, 0);
  FacetMesh& mesh = scene.mesh;
  while (mesh.component.back() == 1) {
    mesh.facets.pop_back();
    mesh.material.pop_back();
    mesh.component.pop_back();
  }
  const std::size_t terrain = mesh.facets.size();
  test::add_box(mesh, test::grid_point(0.3, 5, 1), test::grid_units(0.5));
  std::fill(mesh.component.begin() + std::ptrdiff_t(terrain), mesh.component.end(), std::uint16_t(1));
  return scene;
}

// The step is one grid unit, and the cell extends over at least 1024 grid units in both directions.
// Derivatives agree within 1e-8 of the derivative of their bin. For small derivatives, they agree within
// 1e-12 of the largest derivative by the parameter.
TEST(EchoDerivatives, AgreeWithRationalCentralDifferencesInACell) {
  for (const GradientScene& scene : {few_facets(5, 0.375), few_facets(6, 0), box_above_terrain()}) {
    const History history = scene.history();
    std::vector<ExactParameter> exact = exact_parameters(scene);
    const double absorption = scene.absorption_db_per_m;
    if (absorption == 0)
      exact.pop_back();  // the oracle has no absorption below 0
    else
      exact = {exact[0], exact[2], exact[5], exact[8], exact[9]};
    std::vector<EchoParameter> parameters;
    for (const ExactParameter& each : exact) parameters.push_back(each.parameter);
    const std::vector<ValidSteps> steps = scene.valid_steps_of(parameters, 1);
    const std::vector<std::vector<double>> found = scene.derivatives(parameters);
    test::GradientOracle oracle(scene.mesh, history, scene.samples, scene.mu[0], absorption);
    const test::Places<Rational> rest = test::places_at_rest<Rational>(scene.mesh, history);
    for (std::size_t n = 0; n < exact.size(); ++n) {
      SCOPED_TRACE(testing::Message() << exact[n].name << ", " << scene.mesh.facets.size() << " facets, "
                                      << absorption << " dB/m");
      EXPECT_GT(std::min(steps[n].forward, steps[n].backward), cell_units * gradient_unit_m);
      const Rational number(gradient_unit_m);
      const std::vector<Real> more = moved_energies(oracle, rest, exact[n], number),
                              less = moved_energies(oracle, rest, exact[n], -number);
      std::vector<double> expected;
      double largest = 0;
      for (std::size_t k = 0; k < more.size(); ++k) {
        expected.push_back(double((more[k] - less[k]) / (2 * exact[n].value(number))));
        largest = std::max(largest, std::abs(expected[k]));
      }
      ASSERT_GT(largest, 0);
      for (std::size_t k = 0; k < expected.size(); ++k)
        EXPECT_NEAR(found[n][k], expected[k], std::max(1e-8 * std::abs(expected[k]), 1e-12 * largest)) << k;
    }
  }
}

// The energies of a scene whose integer coordinates move follow from the names of the scene at rest.
TEST(CombinatorialCell, KeepsTheNamesOfCorners) {
  const GradientScene scene = few_facets(6, 0);
  const History history = scene.history();
  test::GradientOracle oracle(scene.mesh, history, scene.samples, scene.mu[0], 0);
  const test::Places<Rational> rest = test::places_at_rest<Rational>(scene.mesh, history);
  for (const ExactParameter& exact : exact_parameters(scene)) {
    if (!exact.place || exact.turns) continue;
    SCOPED_TRACE(exact.name);
    const auto moved_units = [&](PointId id, std::int32_t units) {
      const RationalVector none{0, 0, 0}, moved = exact.place(id, none, Rational(units));
      return GridPoint{std::int32_t(moved[0]), std::int32_t(moved[1]), std::int32_t(moved[2])};
    };
    for (const std::int32_t units : {-cell_units, 0, cell_units}) {
      GradientScene moved = scene;
      for (std::size_t v = 0; v < scene.mesh.vertices.size(); ++v) {
        const GridPoint by = moved_units(PointId(v), units);
        GridPoint& p = moved.mesh.vertices[v];
        p = {p.x + by.x, p.y + by.y, p.z + by.z};
      }
      const std::vector<double> energies = moved.energies();
      const std::vector<Real> expected =
          moved_energies(oracle, rest, exact, Rational(units) * Rational(gradient_unit_m));
      for (std::size_t k = 0; k < energies.size(); ++k)
        EXPECT_NEAR(energies[k], double(expected[k]), 1e-12 * std::max(double(expected[k]), 1e-30))
            << units << " " << k;
    }
  }
}

}  // namespace
}  // namespace tubefoot
