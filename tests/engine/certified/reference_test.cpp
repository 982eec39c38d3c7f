// SPDX-License-Identifier: GPL-3.0-or-later
// Compares certified energies with closed forms (physics sheet, 4 and 7) in 60 digits. The true value must
// lie inside the bound. The bound must be as narrow as requested, and must not contain other values.
#include "engine/certified/reference.hpp"

#include <gtest/gtest.h>

#include <boost/math/quadrature/gauss_kronrod.hpp>
#include <boost/math/special_functions/bessel.hpp>
#include <boost/math/special_functions/expint.hpp>
#include <cmath>
#include <functional>
#include <glm/geometric.hpp>
#include <numbers>
#include <random>
#include <utility>
#include <vector>

#include "engine/certified/certified_driver.hpp"
#include "engine/scattering/radial_model.hpp"
#include "engine/visibility/tube_engine.hpp"
#include "fixtures/geometry/metre_meshes.hpp"
#include "geometry/mesh/facet_mesh.hpp"
#include "geometry/numbers/scalars.hpp"

namespace tubefoot {
namespace {

const double mu = std::pow(10, -2.7);

/// A scene on a grid of 2^-20 m about the apex, which is the origin of the scene.
struct Bench {
  explicit Bench(const std::vector<std::array<glm::dvec3, 3>>& facets_m)
      : grid(20, glm::dvec3(0)),
        mesh(test::mesh_of(facets_m, grid)),
        tree(std::make_unique<SceneTree>(mesh)) {}

  TubeSet tubes(const std::vector<std::array<glm::dvec3, 4>>& pyramids, double reach_m) const {
    TubeSet set;
    set.apex = grid.snap(glm::dvec3(0));
    set.reach = reach_m / grid.unit_m();
    for (const auto& corners : pyramids) test::add_pyramid(set, corners);
    return set;
  }

  struct Result {
    Echo ordinary;
    CertifiedEcho certified;
    double energy(int beam, int sample) const { return certified.echo.at(beam, sample); }
    double bound(int beam, int sample) const {
      return certified.bound[std::size_t(beam) * ordinary.samples + sample];
    }
  };
  Result run(const TubeSet& set, const RangeSamples& samples, double absorption, double tolerance = 1e-9,
             const BeamPatterns* patterns = nullptr) const {
    const std::vector<double> material_mu{mu};
    const EchoModel model{material_mu, mesh.material, absorption, patterns};
    std::vector<std::uint32_t> beam_of_tube;
    for (std::uint32_t tube = 0; tube < set.tubes.size(); ++tube) beam_of_tube.push_back(tube);
    const VisibilityOptions options;
    const TubeEngine engine(mesh, *tree, grid.unit_m(), options);
    const History history = engine.trace(set);
    const int beams = int(set.tubes.size());
    Result result{integrate_echo(history, {beams, beam_of_tube}, samples, model), {}};
    result.certified =
        certify_echo(mesh, *tree, history, options, beam_of_tube, samples, model, result.ordinary, tolerance);
    return result;
  }

  WorldGrid grid;
  FacetMesh mesh;
  std::unique_ptr<SceneTree> tree;
};

std::vector<std::array<glm::dvec3, 3>> square_facets(glm::dvec3 centre, glm::dvec3 a, glm::dvec3 b) {
  return {{centre - a - b, centre + a - b, centre + a + b}, {centre - a - b, centre + a + b, centre - a + b}};
}

constexpr double height = 8;
Bench flat_seabed() { return Bench(square_facets({0, 0, -height}, {512, 0, 0}, {0, 512, 0})); }

/// A tube from straight below almost to the horizon, between two vertical planes. The rays of the tube are
/// exact on the grid: y = 1/4 x, so that the azimuth is atan(1/4).
const std::array<glm::dvec3, 4> wedge{
    glm::dvec3(0x1p-12, 0, -1), {0.5, 0, -0x1p-6}, {0.5, 0.125, -0x1p-6}, {0x1p-12, 0x1p-14, -1}};

/// Returns the energy of a fan of azimuth dphi between two ranges (physics sheet 7.5).
double closed_form(double dphi, double r1, double r2, double absorption) {
  const double beta = 2 * absorption * std::numbers::ln10 / 10;
  const auto tail = [beta](double r) {
    return std::pow(r, -4) * (beta > 0 ? boost::math::expint(5, beta * r) : 0.25);
  };
  return mu * height * height * dphi * (tail(r1) - tail(r2));
}

/// Returns the azimuth of a tube whose side walls are vertical planes through rounded rays.
double azimuth_between(const TubeSet& set, int first, int second) {
  const GridPoint a = set.rays[first], b = set.rays[second];
  return std::abs(std::atan2(double(b.y), double(b.x)) - std::atan2(double(a.y), double(a.x)));
}

TEST(Reference, FlatSeabedIsTheClosedFormWithinTheBound) {
  const Bench seabed = flat_seabed();
  const TubeSet set = seabed.tubes({wedge}, 40);
  const double dphi = azimuth_between(set, 1, 2);
  for (const double absorption : {0.0, 0.0615, 0.42368})
    for (const double tolerance : {1e-6, 1e-9, 1e-11}) {
      const auto result = seabed.run(set, {9, 0.25, 60}, absorption, tolerance);
      EXPECT_EQ(result.certified.bins_over, 0u) << tolerance;
      EXPECT_LE(result.certified.worst_ratio, 1);
      for (int k = 0; k < 60; ++k) {
        const double truth = closed_form(dphi, 9 + 0.25 * k, 9 + 0.25 * (k + 1), absorption);
        // The closed form itself is a difference of doubles, and the lower ends of the walls are rounded
        // rays.
        EXPECT_LE(std::abs(result.energy(0, k) - truth), result.bound(0, k) + 2e-13 * truth)
            << "sample " << k << ", absorption " << absorption << ", tolerance " << tolerance;
        EXPECT_LE(result.bound(0, k), tolerance * result.energy(0, k));
      }
    }
}

TEST(Reference, BoundShrinksAsRequestedAndDoesNotHoldForOtherEnergies) {
  const Bench seabed = flat_seabed();
  const TubeSet set = seabed.tubes({wedge}, 40);
  const double dphi = azimuth_between(set, 1, 2);
  std::vector<double> widest;
  for (const double tolerance : {1e-4, 1e-7, 1e-10}) {
    const auto result = seabed.run(set, {9, 1, 20}, 0.0615, tolerance);
    double most = 0;
    for (int k = 0; k < 20; ++k) {
      most = std::max(most, result.bound(0, k) / result.energy(0, k));
      const double truth = closed_form(dphi, 9 + k, 10 + k, 0.0615);
      const double moved = truth + 2.1 * std::max(result.bound(0, k), 1e-12 * truth);
      EXPECT_GT(std::abs(result.energy(0, k) - moved), result.bound(0, k)) << k;
      EXPECT_GT(result.bound(0, k), 0);
    }
    EXPECT_LE(most, tolerance);
    widest.push_back(most);
  }
  EXPECT_LT(widest[1], widest[0]);
  EXPECT_LT(widest[2], widest[1]);
}

TEST(Reference, WholeCirclesAboutTheFoot) {
  // A tube that contains the foot point: the rings are whole from the first return until they leave the
  // tube.
  const Bench seabed = flat_seabed();
  const TubeSet set = seabed.tubes({{glm::dvec3(-1, -1, -1), {1, -1, -1}, {1, 1, -1}, {-1, 1, -1}}}, 40);
  const auto result = seabed.run(set, {7.75, 0.25, 40}, 0.0615);
  EXPECT_EQ(result.certified.bins_over, 0u);
  EXPECT_LE(result.energy(0, 0), result.bound(0, 0));
  EXPECT_LE(result.bound(0, 0), 1e-15 * result.energy(0, 1));
  for (int k = 1; 7.75 + 0.25 * (k + 1) < height * std::sqrt(2); ++k) {
    const double truth = closed_form(2 * pi, 7.75 + 0.25 * k, 7.75 + 0.25 * (k + 1), 0.0615);
    EXPECT_LE(std::abs(result.energy(0, k) - truth), result.bound(0, k) + 2e-13 * truth) << k;
    EXPECT_LE(result.bound(0, k), 1e-9 * result.energy(0, k));
  }
  // Farther out, a circle of radius rho meets the square of half side H in four arcs: 2 pi - 8 acos(H /
  // rho).
  const double r1 = 7.75 + 0.25 * 20, r2 = r1 + 0.25, beta = 2 * 0.0615 * std::numbers::ln10 / 10;
  const double truth =
      mu * height * height *
      boost::math::quadrature::gauss_kronrod<double, 61>::integrate(
          [&](double r) {
            const double rho = std::sqrt(r * r - height * height);
            return std::pow(r, -5) * std::exp(-beta * r) * (2 * pi - 8 * std::acos(height / rho));
          },
          r1, r2, 5, 1e-15);
  EXPECT_LE(std::abs(result.energy(0, 20) - truth), result.bound(0, 20) + 1e-12 * truth);
}

TEST(Reference, PyramidAndWholeRangeAgreeWithSolidAngleIntegrals) {
  // The sum over the bins is mu / D^2 times the integral of cos^3 over the pyramid (no absorption). It is a
  // closed form for each rectangle.
  const Bench seabed = flat_seabed();
  const double a = 0.25, b = 0.5;  // the pyramid |x| <= a, |y| <= b on the plane z = -1, exact rays
  const TubeSet set = seabed.tubes({{glm::dvec3(-a, -b, -1), {a, -b, -1}, {a, b, -1}, {-a, b, -1}}}, 40);
  const auto result = seabed.run(set, {7, 0.5, 8}, 0);
  double sum = 0, bound = 0;
  for (int k = 0; k < 8; ++k) sum += result.energy(0, k), bound += result.bound(0, k);
  // E = mu / H^2 * integral over the rectangle of (1 + x^2 + y^2)^-3 dx dy, with a closed inner integral.
  const auto column = [&](double x) {
    const double c = 1 + x * x, s = std::sqrt(c);
    return 2 * (b / (4 * c * std::pow(c + b * b, 2)) + 3 * b / (8 * c * c * (c + b * b)) +
                3 * std::atan(b / s) / (8 * c * c * s));
  };
  // integer_ray() rounds to unit length, so that slopes are correct to 1e-9 only. The test computes slopes
  // from the rays.
  const GridPoint corner = set.rays[2];
  const double exact_a = double(corner.x) / -double(corner.z), exact_b = double(corner.y) / -double(corner.z);
  EXPECT_NEAR(exact_a, a, 2e-9);
  EXPECT_NEAR(exact_b, b, 2e-9);
  const double truth = mu / (height * height) *
                       boost::math::quadrature::gauss_kronrod<double, 61>::integrate(column, -a, a, 5, 1e-15);
  EXPECT_NEAR(sum / truth, 1, 2e-8);
  EXPECT_LT(bound, 1e-9 * sum);
}

TEST(Reference, ThinWallHidesExactlyItsShadow) {
  // A wall of height 1 at x = 10, seen from 5 above the seabed, shadows the seabed from 10 to 12.5 (physics
  // sheet 7.2).
  auto facets = square_facets({0, 0, -5}, {512, 0, 0}, {0, 512, 0});
  const glm::dvec3 foot(10, 0, -5);
  for (const auto& facet : square_facets(foot + glm::dvec3(0, 0, 0.5), {0, 64, 0}, {0, 0, 0.5}))
    facets.push_back(facet);
  const Bench scene(facets);
  const TubeSet set = scene.tubes(
      {{glm::dvec3(0x1p-12, 0, -1), {0.5, 0, -0x1p-6}, {0.5, 0x1p-7, -0x1p-6}, {0x1p-12, 0x1p-18, -1}}}, 30);
  const double dphi = azimuth_between(set, 1, 2);
  const auto result = scene.run(set, {10.78, 0.02, 150}, 0);
  EXPECT_EQ(result.certified.bins_over, 0u);
  // No energy returns between the top of the wall (10.7703 m on the near side, slightly farther on the
  // other side of the fan) and the tip of the shadow (13.4629 m).
  const double tip = std::hypot(12.5, 5), wall_foot = std::hypot(10, 10 * std::tan(dphi), 5);
  int dark = 0, lit = 0;
  for (int k = 0; k < 150; ++k) {
    const double r1 = 10.78 + 0.02 * k, r2 = r1 + 0.02;
    if (r1 > wall_foot + 1e-6 && r2 < tip - 1e-6) {
      EXPECT_LE(result.energy(0, k), result.bound(0, k)) << k;
      EXPECT_LE(result.bound(0, k), 1e-14 * result.energy(0, 149)) << k;
      ++dark;
    }
    const double far_tip = std::hypot(12.5, 12.5 * std::tan(dphi), 5);
    if (r1 > far_tip + 1e-6) {
      const double truth =
          mu * 25 * dphi / 4 * (std::pow(10.78 + 0.02 * k, -4) - std::pow(10.78 + 0.02 * (k + 1), -4));
      EXPECT_LE(std::abs(result.energy(0, k) - truth), result.bound(0, k) + 2e-12 * truth) << k;
      ++lit;
    }
  }
  EXPECT_GT(dark, 100);
  EXPECT_GT(lit, 10);
}

/// A sphere of 8 n^2 facets with vertices on the sphere.
std::vector<std::array<glm::dvec3, 3>> sphere(glm::dvec3 centre, double radius, int n) {
  std::vector<std::array<glm::dvec3, 3>> facets;
  const auto at = [&](int sx, int sy, int sz, int i, int j) {
    const double x = double(i) / n, y = double(j) / n;
    return centre + radius * glm::normalize(glm::dvec3(sx * x, sy * y, sz * (1 - x - y)));
  };
  for (const int sx : {-1, 1})
    for (const int sy : {-1, 1})
      for (const int sz : {-1, 1})
        for (int i = 0; i < n; ++i)
          for (int j = 0; i + j < n; ++j) {
            facets.push_back({at(sx, sy, sz, i, j), at(sx, sy, sz, i + 1, j), at(sx, sy, sz, i, j + 1)});
            if (i + j + 1 < n)
              facets.push_back(
                  {at(sx, sy, sz, i + 1, j), at(sx, sy, sz, i + 1, j + 1), at(sx, sy, sz, i, j + 1)});
          }
  return facets;
}

TEST(Reference, SphereConvergesToItsClosedForm) {
  // For a sphere of radius a at distance d, a ring of ranges r..r+dr has area 2 pi a r dr / d. The
  // incidence there is cos = (d^2 - a^2 - r^2) / (2 a r). The integral runs from the first return d - a to
  // the limb sqrt(d^2 - a^2).
  const double a = 1, d = 6;
  const double truth = mu * boost::math::quadrature::gauss_kronrod<double, 61>::integrate(
                                [&](double r) {
                                  const double cosine = (d * d - a * a - r * r) / (2 * a * r);
                                  return 2 * pi * a * r / d * cosine * cosine * std::pow(r, -4);
                                },
                                d - a, std::sqrt(d * d - a * a), 5, 1e-14);
  std::vector<double> error;
  for (const int n : {4, 8, 16}) {
    const Bench ball(sphere({d, 0, 0}, a, n));
    const TubeSet set =
        ball.tubes({{glm::dvec3(1, -0.5, -0.5), {1, 0.5, -0.5}, {1, 0.5, 0.5}, {1, -0.5, 0.5}}}, 9);
    const auto result = ball.run(set, {4.5, 0.125, 16}, 0);
    EXPECT_EQ(result.certified.bins_over, 0u) << n;
    double sum = 0;
    for (int k = 0; k < 16; ++k) {
      sum += result.energy(0, k);
      // The error of the ordinary run.
      EXPECT_LE(std::abs(result.ordinary.at(0, k) - result.energy(0, k)),
                result.bound(0, k) + 1e-10 * result.energy(0, k))
          << k;
    }
    error.push_back(std::abs(sum / truth - 1));
  }
  // The error is of second order in the size of the facets.
  EXPECT_LT(error[1], error[0] / 3);
  EXPECT_LT(error[2], error[1] / 3);
  EXPECT_LT(error[2], 0.01);
}

TEST(Reference, RoughFacetsAgreeWithTheOrdinaryRunToItsOwnError) {
  const unsigned seed = 161803;
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  std::mt19937_64 random(seed);
  std::normal_distribution<double> rough(0, 0.05);
  constexpr int n = 12;
  std::vector<std::vector<glm::dvec3>> points(n + 1);
  for (int i = 0; i <= n; ++i)
    for (int j = 0; j <= n; ++j) points[i].push_back({2 + i * 0.5, (j - n / 2) * 0.5, -3 + rough(random)});
  std::vector<std::array<glm::dvec3, 3>> facets;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) {
      facets.push_back({points[i][j], points[i + 1][j], points[i + 1][j + 1]});
      facets.push_back({points[i][j], points[i + 1][j + 1], points[i][j + 1]});
    }
  const Bench seabed(facets);
  const TubeSet set = seabed.tubes({{glm::dvec3(1, -0.3, -1.4), {1, 0, -1.4}, {1, 0, -0.3}, {1, -0.3, -0.3}},
                                    {glm::dvec3(1, 0, -1.4), {1, 0.3, -1.4}, {1, 0.3, -0.3}, {1, 0, -0.3}}},
                                   12);
  const auto result = seabed.run(set, {3, 0.05, 160}, 0.4);
  EXPECT_EQ(result.certified.bins_over, 0u);
  for (int beam = 0; beam < 2; ++beam) {
    const double peak = *std::max_element(result.ordinary.energy.begin(), result.ordinary.energy.end());
    for (int k = 0; k < 160; ++k)
      EXPECT_LE(std::abs(result.ordinary.at(beam, k) - result.energy(beam, k)),
                result.bound(beam, k) + 1e-9 * result.energy(beam, k) + 1e-14 * peak)
          << beam << " " << k;
  }
}

Directivity pattern(Directivity::Kind kind, glm::dvec3 axis, bool from_axis, double centre, double size) {
  return {kind, glm::normalize(axis), from_axis, centre, size, {}};
}

TEST(Reference, PatternsOverAFlatSeabedAreTheirSingleIntegrals) {
  using Kind = Directivity::Kind;
  using boost::math::quadrature::gauss_kronrod;
  const Bench seabed = flat_seabed();
  const TubeSet set = seabed.tubes({{glm::dvec3(-1, -1, -1), {1, -1, -1}, {1, 1, -1}, {-1, 1, -1}}}, 40);
  const Directivity line = pattern(Kind::line, {1, 0, 0}, false, 0.1, 9);
  const Directivity piston = pattern(Kind::piston, {0, 0, -1}, true, 0, 12);
  const Directivity gauss = pattern(Kind::gaussian, {0, 1, 0}, false, 0, 0.5);
  for (const auto& [transmit, receive] :
       {std::pair(Directivity(), line), std::pair(piston, piston), std::pair(gauss, line)}) {
    const BeamPatterns patterns{{transmit}, {receive}, {0}, {{0, 1}}};
    const auto result = seabed.run(set, {8.25, 0.25, 8}, 0.1, 1e-9, &patterns);
    EXPECT_EQ(result.certified.bins_over, 0u);
    const double beta = 0.2 * std::numbers::ln10 / 10;
    for (int k = 0; k < 8; ++k) {
      const auto ring = [&, &send = transmit, &hear = receive](double r) {
        const double rho = std::sqrt(r * r - height * height);
        return mu * height * height * std::pow(r, -5) * std::exp(-beta * r) *
               gauss_kronrod<double, 61>::integrate(
                   [&](double phi) {
                     const glm::dvec3 d = glm::dvec3(rho * std::cos(phi), rho * std::sin(phi), -height) / r;
                     return send.gain(d) * hear.gain(d);
                   },
                   0.0, 2 * pi, 8, 1e-14);
      };
      const double truth =
          gauss_kronrod<double, 31>::integrate(ring, 8.25 + 0.25 * k, 8.5 + 0.25 * k, 6, 1e-14);
      EXPECT_LE(std::abs(result.energy(0, k) - truth), result.bound(0, k) + 1e-11 * truth) << k;
      EXPECT_LE(result.bound(0, k), 1e-9 * result.energy(0, k) * (1 + 1e-6) + 1e-15 * result.energy(0, 0))
          << k;
    }
  }
}

TEST(Reference, BeamsSentAtOnceAddUp) {
  using Kind = Directivity::Kind;
  const Bench seabed = flat_seabed();
  const TubeSet set =
      seabed.tubes({{glm::dvec3(1, -0.25, -1), {1.5, -0.25, -1}, {1.5, 0.25, -1}, {1, 0.25, -1}}}, 40);
  const Directivity a = pattern(Kind::line, {0, 1, 0}, false, 0.1, 9),
                    b = pattern(Kind::line, {0, 1, 0}, false, -0.1, 9),
                    c = pattern(Kind::gaussian, {0, 0, 1}, false, -0.6, 0.3),
                    received = pattern(Kind::line, {0, 1, 0}, false, 0, 9);
  const auto run = [&](const TransmitPattern& sent) {
    const BeamPatterns patterns{{sent}, {received}, {0}, {{0, 1}}};
    return seabed.run(set, {11.5, 0.5, 4}, 0, 1e-9, &patterns);
  };
  const auto all = run(TransmitPattern(std::vector{a, b, c})), of_a = run(a), of_b = run(b), of_c = run(c);
  EXPECT_EQ(all.certified.bins_over, 0u);
  for (int k = 0; k < 4; ++k) {
    EXPECT_LE(std::abs(all.energy(0, k) - of_a.energy(0, k) - of_b.energy(0, k) - of_c.energy(0, k)),
              all.bound(0, k) + of_a.bound(0, k) + of_b.bound(0, k) + of_c.bound(0, k))
        << k;
    EXPECT_LE(all.bound(0, k), 1.001e-9 * all.energy(0, k)) << k;
  }
}

TEST(Reference, BoundsOfATableShrinkAsRequested) {
  using boost::math::quadrature::gauss_kronrod;
  const Bench seabed = flat_seabed();
  const TubeSet set = seabed.tubes({{glm::dvec3(-1, -1, -1), {1, -1, -1}, {1, 1, -1}, {-1, 1, -1}}}, 40);
  const std::vector<double> rows{-0.3, -0.05, 0.01, 0.05, 0.25};
  Directivity table = pattern(Directivity::Kind::table, {0, 1, 0}, false, 0, 0);
  table.table = std::make_shared<const PatternTable>(rows, std::vector<double>{-30, -6, 0, -6, -20});
  const BeamPatterns patterns{{Directivity()}, {table}, {0}, {{0, 1}}};
  // The rings are whole. They meet the rows where sin(row) = rho / r sin(phi).
  const auto ring = [&](double r) {
    const double rho = std::sqrt(r * r - height * height);
    std::vector<double> stops{-pi / 2, pi / 2};
    for (const double row : rows)
      if (std::abs(std::sin(row)) < rho / r) stops.push_back(std::asin(std::sin(row) * r / rho));
    std::sort(stops.begin(), stops.end());
    double half = 0;
    for (std::size_t k = 0; k + 1 < stops.size(); ++k)
      half += gauss_kronrod<double, 31>::integrate(
          [&](double phi) { return table.gain_at(rho / r * std::sin(phi)); }, stops[k], stops[k + 1], 4,
          1e-13);
    return 2 * half * mu * height * height * std::pow(r, -5);
  };
  std::vector<double> truth;
  for (int k = 0; k < 2; ++k)
    truth.push_back(gauss_kronrod<double, 31>::integrate(ring, 8.5 + 0.5 * k, 9 + 0.5 * k, 6, 1e-12));
  for (const double tolerance : {1e-2, 1e-4, 1e-6}) {
    const auto result = seabed.run(set, {8.5, 0.5, 2}, 0, tolerance, &patterns);
    EXPECT_EQ(result.certified.bins_over, 0u) << tolerance;
    for (int k = 0; k < 2; ++k) {
      EXPECT_LE(std::abs(result.energy(0, k) - truth[k]), result.bound(0, k) + 1e-9 * truth[k]) << k;
      EXPECT_LE(result.bound(0, k), tolerance * result.energy(0, k) * (1 + 1e-5)) << k;
    }
  }
}

TEST(Reference, NeedsAnExactArithmetic) {
  const Bench seabed = flat_seabed();
  VisibilityOptions options;
  options.arithmetic = Arithmetic::plain_double;
  const std::vector<double> material_mu{mu};
  EXPECT_THROW(certify_echo(seabed.mesh, *seabed.tree, {}, options, {}, {1, 1, 1},
                            {material_mu, seabed.mesh.material, 0}, {}, 1e-9),
               std::invalid_argument);
}

// The driver of all certified energies, with enclosures worked out by hand.
TEST(CertifiedDriver, RequestedBoundsFollowTheEnergyAndBothFloors) {
  const std::vector<double> target = reference_targets({2, 3, {1, 1e-3, 0, 1e-9, 0, 0}}, 0.01);
  const double expected[] = {1e-2, 1e-5, 1e-8, 1e-11, 1e-14, 1e-14};
  for (std::size_t bin = 0; bin < 6; ++bin) EXPECT_NEAR(target[bin] / expected[bin], 1, 1e-12) << bin;
  EXPECT_EQ(reference_targets({1, 2, {0, 0}}, 0.01), std::vector<double>(2, least_allowed));
}

TEST(CertifiedDriver, CertainPartOfTheEnergyDeterminesTheRequestedBound) {
  const auto compared = [](std::vector<double> bound, double tolerance) {
    CertifiedEcho certified{{1, int(bound.size()), std::vector<double>(bound.size(), 1)}, bound};
    compare_with(certified, tolerance);
    return certified;
  };
  const double exact = 0.01 / 0.99;  // 0.01 is this part of the certain 0.99
  EXPECT_EQ(compared({0.01}, exact).bins_over, 0u);
  EXPECT_EQ(compared({0.01}, exact * (1 - 5e-7)).bins_over, 0u) << "within the slack for rounding";
  EXPECT_EQ(compared({0.01}, exact * (1 - 2e-6)).bins_over, 1u);
  EXPECT_NEAR(compared({0.01}, 0.01).worst_ratio, 1 / 0.99, 2e-6);
  EXPECT_EQ(compared({NAN}, 0.01).bins_over, 1u);
  const CertifiedEcho with_infinite = compared({HUGE_VAL, 0.05, 0.02}, 0.01);
  EXPECT_EQ(with_infinite.bins_over, 3u);
  EXPECT_NEAR(with_infinite.worst_ratio, 0.05 / 0.0095, 1e-4);
  EXPECT_EQ(with_infinite.worst_sample, 1);
}

TEST(CertifiedDriver, BoundCoversTheWholeEnclosureOfAnEnergy) {
  const auto taken = [](const Ball& total, bool is_energy) {
    CertifiedEcho certified{{1, 1, {7}}, {0}};
    take_enclosure(certified, 0, total, is_energy);
    return std::pair(certified.echo.energy[0], certified.bound[0]);
  };
  const auto [energy, bound] = taken(Ball::between(-3, 1), true);
  EXPECT_EQ(energy, 0);
  EXPECT_NEAR(bound, 3, 1e-6);
  const auto [product, width] = taken(Ball::between(-3, 1), false);
  EXPECT_NEAR(product, -1, 1e-6);
  EXPECT_NEAR(width, 2, 1e-6);
  EXPECT_EQ(taken(Ball(HUGE_VAL), true), std::pair(7.0, HUGE_VAL));
}

TEST(CertifiedDriver, NarrowsItsPartsByTwiceTheWorstExcessAtMostTwice) {
  struct Outcome {
    int calls = 0;
    double tolerance = 0;
    std::size_t bins_over = 0;
  };
  const auto refined = [](const std::function<double(CertifiedRequest&)>& bound_of) {
    const EchoModel model;
    CertifiedRequest request(model, {1, 1, 1});
    Outcome outcome;
    const CertifiedEcho certified =
        refined_until_tolerance(request, {1, 1, {1}}, 0.01, reference_targets, [&] {
          ++outcome.calls;
          return CertifiedEcho{{1, 1, {1}}, {bound_of(request)}};
        });
    outcome.tolerance = request.tolerance;
    outcome.bins_over = certified.bins_over;
    return outcome;
  };
  const Outcome wide = refined([](CertifiedRequest& request) { return 4 * request.tolerance; });
  EXPECT_EQ(wide.calls, 2);
  EXPECT_EQ(wide.bins_over, 0u);
  EXPECT_NEAR(wide.tolerance, 0.01 / (2 * 0.04 / 0.0096), 1e-7);
  EXPECT_EQ(refined([](CertifiedRequest&) { return 0.009; }).calls, 1);
  EXPECT_EQ(refined([](CertifiedRequest&) { return 0.02; }).calls, 3);
  EXPECT_EQ(refined([](CertifiedRequest&) { return HUGE_VAL; }).calls, 1);
  EXPECT_EQ(refined([](CertifiedRequest& request) {
              request.is_coarse = true;
              return 0.02;
            }).calls,
            1);
}

TEST(CertifiedDriver, NeedsExactArithmetic) {
  EXPECT_THROW(require_exact({.arithmetic = Arithmetic::plain_double}), std::invalid_argument);
  EXPECT_NO_THROW(require_exact({.arithmetic = Arithmetic::fixed}));
}

}  // namespace
}  // namespace tubefoot
