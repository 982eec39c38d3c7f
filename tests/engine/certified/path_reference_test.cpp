// SPDX-License-Identifier: GPL-3.0-or-later
// Tests certified energies of a separate transmitter and receiver. The comparisons are closed forms, the
// monostatic reference, the ordinary integral, and values with 40 digits from a separate program
// (path_reference_digits.py).
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "engine/certified/reference.hpp"
#include "engine/scattering/perlin_reflectivity.hpp"
#include "engine/visibility/tube_engine.hpp"
#include "fixtures/geometry/metre_meshes.hpp"

namespace tubefoot {
namespace {

const double path_mu = std::pow(10, -2.7);
const std::vector<double> path_material_mu{path_mu};
using Facets = std::vector<std::array<glm::dvec3, 3>>;

/// The mesh, tubes and patterns that two apexes share, on a grid of 2^-20 m. Each apex has one tube.
struct Pair {
  Pair(const Facets& facets_m, glm::dvec3 tx_m, glm::dvec3 rx_m, const std::array<glm::dvec3, 4>& tx_tube,
       const std::array<glm::dvec3, 4>& rx_tube, double reach_m = 100)
      : grid(20, glm::dvec3(0)), mesh(test::mesh_of(facets_m, grid)), tree(mesh) {
    const auto tubes = [&](glm::dvec3 apex, const std::array<glm::dvec3, 4>& corners) {
      TubeSet set;
      set.apex = grid.snap(apex);
      set.reach = reach_m / grid.unit_m();
      test::add_pyramid(set, corners);
      return set;
    };
    history = trace_bistatic(mesh, tree, grid.unit_m(), {}, tubes(tx_m, tx_tube), tubes(rx_m, rx_tube), true);
    apex_m = tx_m;
  }

  EchoModel model(double absorption = 0, const BeamPatterns* patterns = nullptr) const {
    EchoModel model{path_material_mu, mesh.material, absorption, patterns};
    model.path.tx.apex_m = apex_m;
    return model;
  }
  struct Result {
    Echo ordinary;
    CertifiedEcho certified;
  };
  Result run(const RangeSamples& samples, const EchoModel& model, double tolerance) const {
    const std::vector<std::uint32_t> beam{0};
    const ReceiveBeams beams{1, beam};
    Result result{integrate_echo(history, beams, samples, model), {}};
    result.certified = certify_echo(mesh, history, beams, samples, model, result.ordinary, tolerance);
    return result;
  }

  WorldGrid grid;
  FacetMesh mesh;
  SceneTree tree;
  BistaticHistory history;
  glm::dvec3 apex_m;
};

Facets square(glm::dvec3 centre, glm::dvec3 a, glm::dvec3 b) {
  return {{centre - a - b, centre + a - b, centre + a + b}, {centre - a - b, centre + a + b, centre - a + b}};
}
Facets flat_facets() { return square({0, 0, 0}, {512, 0, 0}, {0, 512, 0}); }

const std::array<glm::dvec3, 4> down{glm::dvec3(-1, -1, -0.1), {1, -1, -0.1}, {1, 1, -0.1}, {-1, 1, -0.1}};
/// The bounds contain the ordinary energies, are as narrow as requested, and contain no energy that is
/// moved.
void expect_holds(const Pair::Result& result, double tolerance, double ordinary_error = 1e-9) {
  EXPECT_EQ(result.certified.bins_over, 0u) << result.certified.worst_ratio;
  const auto& ordinary = result.ordinary.energy;
  const double most = *std::max_element(ordinary.begin(), ordinary.end());
  EXPECT_GT(most, 0);
  for (std::size_t k = 0; k < ordinary.size(); ++k) {
    const double energy = result.certified.echo.energy[k], bound = result.certified.bound[k];
    EXPECT_LE(std::abs(ordinary[k] - energy), bound + ordinary_error * ordinary[k] + 1e-14 * most) << k;
    EXPECT_LE(bound, tolerance * std::max(energy, 1e-6 * most) * 1.01) << k;
  }
}

/// Whole rings with one apex above the other: with u = rho^2, the integral of du / 2 ((u + a) (u +
/// b))^-3/2.
long double rings(long double h1, long double h2, long double half_path) {
  const long double path = 2 * half_path, a = h1 * h1, b = h2 * h2;
  const long double r1 = (path + (a - b) / path) / 2, u = std::max(r1 * r1 - a, 0.0L);
  return -2 * std::numbers::pi_v<long double> * path_mu * h1 * h2 * (2 * u + a + b) /
         ((a - b) * (a - b) * std::sqrt((u + a) * (u + b)));
}

TEST(PathReference, RingsOfOneApexAboveTheOtherInClosedForm) {
  const double h1 = 10, h2 = 4;
  const Pair pair(flat_facets(), {0, 0, h1}, {0, 0, h2}, down, down);
  for (const double tolerance : {1e-3, 1e-6, 1e-9}) {
    const RangeSamples samples{7, 0.375, 8};  // a bin border at the shortest path
    const auto result = pair.run(samples, pair.model(), tolerance);
    expect_holds(result, tolerance);
    for (int k = 0; k < samples.count; ++k) {
      const long double from = samples.first_m + k * samples.step_m,
                        truth = rings(h1, h2, from + samples.step_m) - rings(h1, h2, from);
      const double bound = result.certified.bound[k];
      EXPECT_LE(std::abs(result.certified.echo.energy[k] - double(truth)), bound + 1e-15 * double(truth))
          << k;
      EXPECT_GT(bound, 0);
      // The bound does not contain an energy that is moved by twice the bound.
      EXPECT_GT(std::abs(result.certified.echo.energy[k] - double(truth) - 2.1 * bound), bound) << k;
    }
  }
}

TEST(PathReference, FortyDigitsFromOutsideTheProgram) {
  // from path_reference_digits.py
  const std::vector<double> digits{0.000007210947291133962905093818859029974484732,
                                   0.00000583492306415942642429656055148630124626,
                                   0.0000001427535419225745900682789350537995661574};
  const Pair pair({{glm::dvec3(1, -1, 0.25), {5, 1, 1.25}, {2, 3, 0.5}}}, {-1, 0.5, 6}, {1.5, -1, 4}, down,
                  down);
  EchoModel model = pair.model(0.0625);
  const std::vector<double> bright{0x1p-9};
  model.material_mu = bright;
  for (const double tolerance : {1e-2, 1e-5, 1e-10}) {
    const auto result = pair.run({4.5, 0.75, 3}, model, tolerance);
    expect_holds(result, tolerance);
    for (std::size_t k = 0; k < digits.size(); ++k) {
      const double energy = result.certified.echo.energy[k], bound = result.certified.bound[k];
      EXPECT_LE(std::abs(energy - digits[k]), bound + 1e-16 * digits[k]) << k << ' ' << tolerance;
      EXPECT_GT(std::abs(energy - digits[k] - 2.1 * bound), bound) << k;
    }
  }
}

/// Two enclosures of the same number must intersect.
void expect_same(const CertifiedEcho& a, const CertifiedEcho& b, double slack = 0) {
  for (std::size_t k = 0; k < a.bound.size(); ++k)
    EXPECT_LE(std::abs(a.echo.energy[k] - b.echo.energy[k]),
              a.bound[k] + b.bound[k] + slack * a.echo.energy[k])
        << k;
}

/// A rectangle of the plane z = 0 around `centre`.
Facets strip(glm::dvec3 centre, double length_x_m, double length_y_m) {
  return square(centre, {length_x_m / 2, 0, 0}, {0, length_y_m / 2, 0});
}
/// Looks along x, slightly downwards.
std::array<glm::dvec3, 4> forward(double across, double lower, double upper) {
  return {glm::dvec3(1, -across, lower), {1, -across, upper}, {1, across, upper}, {1, across, lower}};
}

TEST(PathReference, ThinStripsMeetTheToleranceOfOneApex) {
  // from thin_strip_digits.py, for the widths 15.6 mm and 2 mm
  const std::vector<std::vector<double>> digits{
      {6.089713570572914452703248e-14, 8.906776488985870536313849e-14, 6.652474277497414306829767e-14,
       5.021307042893710554766695e-14, 1.661751454034399222150705e-14},
      {7.612143043179156100094289e-15, 1.113347057671953757361888e-14, 8.315592823251096720385279e-15,
       6.276633787218487631728627e-15, 2.077189010804359316705179e-15}};
  const std::vector<double> bright{0x1p-9};
  for (std::size_t which = 0; which < 2; ++which)
    for (const double tolerance : {1e-3, 1e-6, 1e-9}) {
      SCOPED_TRACE(testing::Message() << "strip " << which << ", tolerance " << tolerance);
      const Pair pair(strip({60, 0, 0}, 10, which == 0 ? 0x1p-6 : 0x1p-9), {0, 0, 10}, {1.5, 0.25, 9.75},
                      forward(0.2, -0.3, -0.05), forward(0.2, -0.3, -0.05));
      EchoModel model = pair.model(0.03125);
      model.material_mu = bright;
      const auto result = pair.run({54, 2.5, 5}, model, tolerance);
      expect_holds(result, tolerance);
      for (std::size_t k = 0; k < digits[which].size(); ++k) {
        const double energy = result.certified.echo.energy[k], bound = result.certified.bound[k];
        EXPECT_LE(std::abs(energy - digits[which][k]), bound + 1e-15 * digits[which][k]) << k;
        EXPECT_GT(std::abs(energy - digits[which][k] - 2.1 * bound), bound) << k;
      }
    }
}

/// The corners of the common part are where walls of both ends cross the long edges of the strip.
TEST(PathReference, ThinStripsBetweenWallsOfBothEndsMeetTheTolerance) {
  const std::uint64_t seed = 31;
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> u(-1, 1);
  for (int trial = 0; trial < 12; ++trial) {
    SCOPED_TRACE(testing::Message() << "seed " << seed << ", trial " << trial);
    const double width = std::exp2(-3.0 - trial);  // 12.5 cm to 61 micrometres
    const bool along_x = trial % 2 == 0;
    const Facets facets = strip({60, 0, 0}, along_x ? 30 : width, along_x ? width : 30);
    const glm::dvec3 rx = glm::round(glm::dvec3(u(random), u(random), 10 + u(random)) * 1024.0) / 1024.0;
    const Pair pair(facets, {0, 0, 10}, rx, forward(0.05, -0.18, -0.14), forward(0.04, -0.2, -0.12));
    const auto fine = pair.run({50, 1, 20}, pair.model(0.1), 1e-6),
               coarse = pair.run({50, 1, 20}, pair.model(0.1), 1e-2);
    expect_holds(fine, 1e-6);
    expect_holds(coarse, 1e-2);
    expect_same(fine.certified, coarse.certified);
  }
}

Facets hills(std::mt19937_64& random) {
  std::uniform_real_distribution<double> height(-0.6, 0.6);
  double z[4][4];
  for (auto& row : z)
    for (double& one : row) one = height(random);
  Facets facets;
  const auto at = [&](int i, int j) { return glm::dvec3(5 * i - 7.5, 5 * j - 7.5, z[i][j]); };
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      facets.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      facets.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  return facets;
}

glm::dvec3 place(std::mt19937_64& random) {
  std::uniform_real_distribution<double> u(-3, 3);
  // Coordinates lie on the grid, so that nothing is rounded.
  const auto on_grid = [](double x) { return std::round(x * 1024) / 1024; };
  return {on_grid(u(random)), on_grid(u(random)), 6 + on_grid(u(random) / 2)};
}

TEST(PathReference, OrdinaryEnergiesLieWithinAndBothWaysAreTheSame) {
  const std::uint64_t seed = 20;
  std::mt19937_64 random(seed);
  const ScatteringModel gsab = ScatteringModel::gsab({0.3, 0.2, 0.01, 1.5, 0, 1});
  const std::vector<std::shared_ptr<const ScatteringModel>> models{std::make_shared<ScatteringModel>(gsab)};
  const std::vector<std::shared_ptr<const ReflectivityField>> texture{
      std::make_shared<const PerlinReflectivity>(PerlinReflectivity::Settings{3.0, 1, 0.5, 0.25, 7})};
  for (int trial = 0; trial < 4; ++trial) {
    SCOPED_TRACE(testing::Message() << "seed " << seed << ", trial " << trial);
    const Facets facets = hills(random);
    const double tolerance = trial == 1 ? 1e-3 : 1e-5;
    const glm::dvec3 tx = place(random), rx = place(random);
    const Pair there(facets, tx, rx, down, down), back(facets, rx, tx, down, down);
    EchoModel model = there.model(0.1), other = back.model(0.1);
    if (trial == 1) model.scattering = other.scattering = models;
    if (trial == 2) model.reflectivity = other.reflectivity = texture;
    const RangeSamples samples{6, 0.5, 6};
    const auto one = there.run(samples, model, tolerance), two = back.run(samples, other, tolerance);
    expect_holds(one, tolerance);
    expect_same(one.certified, two.certified);
  }
}

TEST(PathReference, OneApexTwiceIsTheReferenceOfOneApex) {
  std::mt19937_64 random(3);
  const Facets facets = hills(random);
  const glm::dvec3 at = place(random);
  const Pair pair(facets, at, at, down, down);
  const RangeSamples samples{6, 0.5, 8};
  const auto two = pair.run(samples, pair.model(0.1), 1e-6);
  expect_holds(two, 1e-6);
  const VisibilityOptions options;
  const TubeEngine engine(pair.mesh, pair.tree, pair.grid.unit_m(), options);
  const History history = engine.trace(pair.history.transmit);
  const std::vector<std::uint32_t> beam{0};
  const EchoModel model = pair.model(0.1);
  const Echo ordinary = integrate_echo(history, {1, beam}, samples, model);
  const CertifiedEcho one =
      certify_echo(pair.mesh, pair.tree, history, options, beam, samples, model, ordinary, 1e-9);
  expect_same(one, two.certified);
}

TEST(PathReference, FacetsInPartsReturnTheSame) {
  const Facets whole{{glm::dvec3(-4, -3, 0), {5, -2, 0.5}, {1, 6, -0.5}}};
  Facets parts;
  const auto& f = whole.front();
  const glm::dvec3 on = 0.25 * f[0] + 0.5 * f[1] + 0.25 * f[2];
  for (int k = 0; k < 3; ++k) parts.push_back({f[k], f[(k + 1) % 3], on});
  const Pair one(whole, {0, 1, 6}, {1, -1, 5}, down, down), many(parts, {0, 1, 6}, {1, -1, 5}, down, down);
  const RangeSamples samples{5, 0.25, 12};
  const auto a = one.run(samples, one.model(0.2), 1e-7), b = many.run(samples, many.model(0.2), 1e-7);
  expect_holds(a, 1e-7);
  expect_holds(b, 1e-7);
  expect_same(a.certified, b.certified);
}

TEST(PathReference, PatternsOfBothEnds) {
  std::mt19937_64 random(5);
  const Facets facets = hills(random);
  const Pair pair(facets, place(random), place(random), down, down);
  BeamPatterns patterns;
  Directivity line{Directivity::Kind::line, {0, 1, 0}};
  line.size = 8;
  Directivity gauss{Directivity::Kind::gaussian, glm::normalize(glm::dvec3(0.3, 0.2, -1)), true};
  gauss.size = 0.3;
  patterns.transmit = {line};
  patterns.receive = {gauss};
  patterns.fan_of_tube = {0};
  patterns.beams_of_tube = {{0, 1}};
  const auto result = pair.run({6, 0.5, 6}, pair.model(0.1, &patterns), 1e-4);
  expect_holds(result, 1e-4, 1e-8);
}

}  // namespace
}  // namespace tubefoot
