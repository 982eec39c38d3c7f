// SPDX-License-Identifier: GPL-3.0-or-later
// Tests bistatic echoes of a separate transmitter and receiver. The comparisons are closed forms on planes,
// quadrature in space, the monostatic echo, reciprocity, and random samples of paths.

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <boost/math/quadrature/gauss_kronrod.hpp>
#include <cmath>
#include <numbers>
#include <numeric>
#include <random>

#include "engine/echo/echo.hpp"
#include "engine/visibility/tube_engine.hpp"
#include "fixtures/geometry/grid_scenes.hpp"
#include "fixtures/geometry/plane_polygons.hpp"
#include "fixtures/world/histories.hpp"
#include "geometry/numbers/scalars.hpp"

namespace tubefoot {
namespace {

using boost::math::quadrature::gauss_kronrod;
using test::piece_on;
using test::Polygon2;
using test::total;

const double bistatic_mu = std::pow(10, -2.7);
const std::vector<double> bistatic_material_mu{bistatic_mu};

Echo echo_of(const BistaticHistory& history, const RangeSamples& samples, double absorption = 0,
             const BeamPatterns* patterns = nullptr) {
  const std::vector<std::uint16_t> material(100000, 0);
  const std::vector<std::uint32_t> beam(history.receive.tubes.size(), 0);
  return integrate_echo(history, {1, beam}, samples, {bistatic_material_mu, material, absorption, patterns});
}

const Polygon2 endless{{-1e5, -1e5}, {1e5, -1e5}, {1e5, 1e5}, {-1e5, 1e5}};

TEST(BistaticEcho, TheWholePlaneIsAPoissonKernel) {
  // h / (2 pi r^3) is Poisson's kernel of the half space. These kernels form a semigroup in h: the integral
  // of h1 h2 / (r1^3 r2^3) is 2 pi (h1 + h2) / l^3. Here l is the distance between one apex and the mirror
  // image of the other.
  for (const auto& [h1, h2, b] :
       {std::tuple{5.0, 5.0, 0.0}, {5.0, 2.0, 3.0}, {0.5, 0.4, 20.0}, {9.0, 0.05, 2.0}, {3.0, 3.0, 50.0}}) {
    const BistaticHistory history = piece_on(test::flat_seabed(h1), endless, {0.6 * b, -0.8 * b, h2 - h1});
    const double image = std::hypot(h1 + h2, b),
                 expected = 2 * pi * bistatic_mu * (h1 + h2) / (image * image * image);
    EXPECT_NEAR(total(echo_of(history, {0, 2e5, 1})), expected, 1e-9 * expected)
        << h1 << ' ' << h2 << ' ' << b;
    EXPECT_NEAR(total(echo_of(history, {0, 0.75, 400})) + total(echo_of(history, {300, 2e5, 1})), expected,
                1e-9 * expected);
  }
}

/// Whole rings with one apex above the other: with u = rho^2, the integral of du / 2 ((u + a) (u +
/// b))^-3/2.
double rings(double h1, double h2, double half_path) {
  const double path = 2 * half_path, a = h1 * h1, b = h2 * h2;
  if (path <= h1 + h2) return rings(h1, h2, (h1 + h2) / 2 * (1 + 1e-15));
  const double r1 = (path + (a - b) / path) / 2, u = r1 * r1 - a;
  return -2 * pi * bistatic_mu * h1 * h2 * (2 * u + a + b) /
         ((a - b) * (a - b) * std::sqrt((u + a) * (u + b)));
}

TEST(BistaticEcho, RingsOfOneApexAboveTheOtherInClosedForm) {
  for (const auto& [h1, h2] : {std::pair{10.0, 4.0}, {2.0, 7.5}}) {
    const BistaticHistory history = piece_on(test::flat_seabed(h1), endless, {0, 0, h2 - h1});
    const RangeSamples samples{(h1 + h2) / 2 - 0.15, 0.4, 60};
    const Echo echo = echo_of(history, samples);
    for (int k = 0; k < samples.count; ++k) {
      const double from = samples.first_m + k * samples.step_m;
      const double expected = rings(h1, h2, from + samples.step_m) - rings(h1, h2, from);
      ASSERT_NEAR(echo.at(0, k), expected, 1e-10 * expected + 1e-15 * rings(h1, h2, 1e6)) << k;
    }
  }
}

TEST(BistaticEcho, RingsWithAbsorptionAreASingleIntegral) {
  const double h1 = 10, h2 = 4, absorption = 0.4, beta = absorption * std::numbers::ln10 / 10;
  const BistaticHistory history = piece_on(test::flat_seabed(h1), endless, {0, 0, h2 - h1});
  const RangeSamples samples{7.5, 0.5, 30};
  const Echo echo = echo_of(history, samples, absorption);
  const auto radius = [&](double half_path) {
    const double r1 = half_path + (h1 * h1 - h2 * h2) / (4 * half_path);
    return std::sqrt(r1 * r1 - h1 * h1);
  };
  for (int k = 0; k < samples.count; ++k) {
    const auto density = [&](double rho) {
      const double r1 = std::hypot(h1, rho), r2 = std::hypot(h2, rho);
      return 2 * pi * rho * bistatic_mu * h1 * h2 * std::pow(r1 * r2, -3) * std::exp(-beta * (r1 + r2));
    };
    const double from = samples.first_m + k * samples.step_m;
    const double expected =
        gauss_kronrod<double, 31>::integrate(density, radius(from), radius(from + 0.5), 8, 1e-13);
    ASSERT_NEAR(echo.at(0, k), expected, 1e-10 * expected) << k;
  }
}

/// Integrates over a polygon in space with independent code. `density` takes a point relative to the
/// transmitter.
template <class Density>
double over_polygon(const std::vector<glm::dvec3>& corners, const Density& density) {
  double sum = 0;
  for (std::size_t t = 2; t < corners.size(); ++t) {
    const glm::dvec3 a = corners[0], b = corners[t - 1] - a, c = corners[t] - corners[t - 1];
    const auto line = [&](double x) {
      return x * gauss_kronrod<double, 31>::integrate([&](double y) { return density(a + x * (b + y * c)); },
                                                      0.0, 1.0, 5, 1e-11);
    };
    sum += glm::length(glm::cross(b, c)) * gauss_kronrod<double, 31>::integrate(line, 0.0, 1.0, 5, 1e-11);
  }
  return sum;
}

TEST(BistaticEcho, TiltedFacetsAgreeWithQuadratureInSpaceWithAndWithoutPatterns) {
  const unsigned seed = 161803;
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> place(-12, 12), height(0.5, 8);
  const double absorption = 0.2, beta = absorption * std::numbers::ln10 / 10;
  const Directivity line{Directivity::Kind::line, glm::normalize(glm::dvec3(1, 2, 0.5)), false, 0.1, 6},
      gauss{Directivity::Kind::gaussian, glm::normalize(glm::dvec3(0.3, 1, -1)), true, 0, 2.5};
  const BeamPatterns patterns{{line}, {gauss}, {0}, {{0, 1}}};
  for (int i = 0; i < 24; ++i) {
    const FacetPlane plane = test::random_plane(random, height(random));
    const PlaneFrame frame(plane);
    const glm::dvec3 receiver = place(random) * frame.u + place(random) * frame.v +
                                (height(random) - plane.distance_m) * plane.normal;
    const Polygon2 p = test::random_convex(random, {place(random), place(random)}, 4, 2);
    const BistaticHistory history = piece_on(plane, p, receiver);
    const auto corners = test::on_plane(plane, p);
    const auto density = [&](glm::dvec3 q) {
      const double rt = glm::length(q), rr = glm::length(q - receiver);
      const double st = std::abs(glm::dot(plane.normal, q)) / rt,
                   sr = std::abs(glm::dot(plane.normal, q - receiver)) / rr;
      return bistatic_mu * st * sr / (rt * rt * rr * rr) * std::exp(-beta * (rt + rr));
    };
    const double expected = over_polygon(corners, density);
    EXPECT_NEAR(total(echo_of(history, {0, 0.05, 1000}, absorption)), expected, 2e-10 * expected) << i;
    const double weighed = over_polygon(corners, [&](glm::dvec3 q) {
      return density(q) * line.gain(glm::normalize(q)) * gauss.gain(glm::normalize(q - receiver));
    });
    EXPECT_NEAR(total(echo_of(history, {0, 0.5, 100}, absorption, &patterns)), weighed, 3e-10 * expected)
        << i;
  }
}

// Scenes of the tests of the visibility kernel, in metres.

constexpr double unit_m = 0x1p-20;

struct Scenery {
  FacetMesh mesh;
  SceneTree tree;
  explicit Scenery(FacetMesh m) : mesh(std::move(m)), tree(mesh) {}
  BistaticHistory both(const TubeSet& transmit, const TubeSet& receive) const {
    return trace_bistatic(mesh, tree, unit_m, {}, transmit, receive);
  }
  Echo echo(const TubeSet& transmit, const TubeSet& receive, const RangeSamples& samples,
            double absorption) const {
    return echo_of(both(transmit, receive), samples, absorption);
  }
};

FacetMesh rough_terrain() {
  test::Random random(20266);
  return test::rough_terrain(random, 10, 20000000, -3000000, 500000);  // 19 m, 2.9 m below the apex
}

FacetMesh terrain_with_box() {
  FacetMesh mesh = rough_terrain();
  test::add_box(mesh, {1500000, 9000000, -2500000}, 1200000);
  return mesh;
}

void add_quad(FacetMesh& mesh, GridPoint a, GridPoint b, GridPoint c, GridPoint d) {
  const VertexId first = test::add_vertex(mesh, a);
  for (const GridPoint& p : {b, c, d}) test::add_vertex(mesh, p);
  test::add_facet(mesh, first, first + 1, first + 2);
  test::add_facet(mesh, first, first + 2, first + 3);
}

TEST(BistaticEcho, InOnePlaceItIsTheMonostaticEcho) {
  for (FacetMesh mesh : {rough_terrain(), terrain_with_box()}) {
    const Scenery run(std::move(mesh));
    const TubeSet tubes = test::forward_tubes({0, 0, 0}, 6, 1, 50, 30, 20);
    const std::vector<std::uint32_t> beams{0, 1, 2, 3, 4, 5}, none(6, 0);
    const RangeSamples samples{2, 0.0625, 300};
    const History history = TubeEngine(run.mesh, run.tree, unit_m, {}).trace(tubes);
    const BistaticHistory both = run.both(tubes, tubes);

    const Directivity line{Directivity::Kind::line, {1, 0, 0}, false, 0, 5};
    std::vector<Directivity> receive;
    std::vector<std::pair<std::uint32_t, std::uint32_t>> all(6, {0, 6});
    for (int b = 0; b < 6; ++b) {
      receive.push_back(line);
      receive.back().centre = 0.1 * (b - 2.5);
      receive.back().size = 12;
    }
    const BeamPatterns patterns{{line}, receive, none, all};
    for (const BeamPatterns* p : {static_cast<const BeamPatterns*>(nullptr), &patterns}) {
      EchoModel model{bistatic_material_mu, run.mesh.material, 0.1, p};
      model.pattern_tolerance = 1e-12;
      const Echo expected = integrate_echo(history, {6, beams}, samples, model);
      const Echo echo = integrate_echo(both, {6, beams}, samples, model);
      const double peak = *std::max_element(expected.energy.begin(), expected.energy.end());
      ASSERT_GT(peak, 0);
      for (std::size_t bin = 0; bin < echo.energy.size(); ++bin)
        ASSERT_NEAR(echo.energy[bin], expected.energy[bin], 1e-9 * expected.energy[bin] + 1e-12 * peak)
            << bin;
    }
  }
}

// The kernel in plain doubles finds the same corners where no decision is ambiguous.
TEST(BistaticEcho, DoublesSeeTheSameWhereNothingIsDegenerate) {
  const Scenery run(terrain_with_box());
  const TubeSet a = test::forward_tubes({-1000000, 0, 0}, 4, 2, 70, 40, 20),
                b = test::forward_tubes({2500000, 700000, 900000}, 3, 3, 60, 50, 25);
  VisibilityOptions doubles;
  doubles.arithmetic = Arithmetic::plain_double;
  const BistaticHistory exact = run.both(a, b),
                        plain = trace_bistatic(run.mesh, run.tree, unit_m, doubles, a, b);
  EXPECT_EQ(plain.shared.pieces.size(), exact.shared.pieces.size());
  const RangeSamples samples{2, 0.125, 160};
  const Echo expected = echo_of(exact, samples, 0.1), echo = echo_of(plain, samples, 0.1);
  ASSERT_GT(total(expected), 0);
  for (int k = 0; k < samples.count; ++k)
    ASSERT_NEAR(echo.at(0, k), expected.at(0, k), 1e-12 * expected.at(0, k) + 1e-15 * total(expected)) << k;
}

// The seabed is a lattice. Walls of tubes contain vertices and edges of the lattice, and other facets
// coincide.
TEST(BistaticEcho, DoublesInADegenerateSceneStayFinite) {
  FacetMesh mesh;
  constexpr std::int32_t m = 1 << 20;
  for (std::int32_t x = -4; x < 4; ++x)
    for (std::int32_t y = 1; y < 9; ++y)
      for (int twice = 0; twice < 2; ++twice)
        add_quad(mesh, {x * m, y * m, -3 * m}, {(x + 1) * m, y * m, -3 * m},
                 {(x + 1) * m, (y + 1) * m, -3 * m}, {x * m, (y + 1) * m, -3 * m});
  test::add_box(mesh, {0, 4 * m, -2 * m}, m);
  const Scenery run(mesh);
  const TubeSet a = test::lattice_tubes({0, 0, 0}, -4, -5, 8, 6, 4),
                b = test::lattice_tubes({m, 0, 0}, -4, -5, 8, 6, 4);
  const RangeSamples samples{2, 20, 1};
  const double exact = total(run.echo(a, b, samples, 0));
  ASSERT_GT(exact, 0);
  for (const double tolerance : {0.0, 1e-14, 1e-9}) {
    VisibilityOptions doubles;
    doubles.arithmetic = Arithmetic::plain_double;
    doubles.tolerance = tolerance;
    const double plain = total(echo_of(trace_bistatic(run.mesh, run.tree, unit_m, doubles, a, b), samples));
    EXPECT_TRUE(std::isfinite(plain)) << tolerance;
    EXPECT_NEAR(plain, exact, 0.01 * exact) << tolerance;
  }
}

TEST(BistaticEcho, SwappingTransmitterAndReceiverChangesNothing) {
  const Scenery run(terrain_with_box());
  const TubeSet a = test::forward_tubes({-1000000, 0, 0}, 4, 2, 70, 40, 20),
                b = test::forward_tubes({2500000, 700000, 900000}, 3, 3, 60, 50, 25);
  const RangeSamples samples{2, 0.125, 160};
  const Echo there = run.echo(a, b, samples, 0.1), back = run.echo(b, a, samples, 0.1);
  const double peak = *std::max_element(there.energy.begin(), there.energy.end());
  ASSERT_GT(peak, 0);
  int lit = 0;
  for (int k = 0; k < samples.count; ++k) {
    ASSERT_NEAR(there.at(0, k), back.at(0, k), 1e-9 * there.at(0, k) + 1e-13 * peak) << k;
    lit += there.at(0, k) > 1e-3 * peak;
  }
  EXPECT_GT(lit, 60);
}

TEST(BistaticEcho, TubesOfTheReceiverAddUp) {
  const Scenery run(terrain_with_box());
  const TubeSet transmit = test::forward_tubes({-1000000, 0, 0}, 2, 1, 70, 40, 20);
  const TubeSet many = test::lattice_tubes({2500000, 700000, 900000}, -4, -5, 8, 6, 4);
  TubeSet one = many;
  one.tubes = {{0, 6 * 9, 6 * 9 + 8, 8}};
  const RangeSamples samples{2, 0.5, 40};
  const Echo a = run.echo(transmit, many, samples, 0), b = run.echo(transmit, one, samples, 0);
  for (int k = 0; k < samples.count; ++k)
    ASSERT_NEAR(a.at(0, k), b.at(0, k), 3e-10 * a.at(0, k) + 1e-14 * total(a));
  ASSERT_GT(total(a), 0);
}

TEST(BistaticEcho, AWallHidesWhatEitherOfThemCannotSee) {
  // Both apexes lie 4 m above a seabed, 2 m to the left and to the right of a wall of 3 m. The shadow of
  // each apex on the seabed ends 2 m 3 / (4 - 3) = 6 m beyond the wall. The apexes see different sides of
  // the wall. Only the seabed beyond 6 m on either side returns energy.
  constexpr std::int32_t m = 1 << 20;
  const auto scene = [&](std::int32_t wall) {
    FacetMesh mesh;
    add_quad(mesh, {-16 * m, 0, -4 * m}, {16 * m, 0, -4 * m}, {16 * m, 16 * m, -4 * m},
             {-16 * m, 16 * m, -4 * m});
    if (wall > 0)
      add_quad(mesh, {0, -3 * m, -4 * m}, {0, 17 * m, -4 * m}, {0, 17 * m, wall - 4 * m},
               {0, -3 * m, wall - 4 * m});
    return mesh;
  };
  TubeSet left;
  left.apex = {-2 * m, -2 * m, 0};
  left.reach = 1e12;
  left.rays = {{-200, 10, -30}, {-200, 10, -1}, {200, 10, -1}, {200, 10, -30}};  // the whole seabed
  left.tubes = {{0, 1, 2, 3}};
  TubeSet right = left;
  right.apex.x = 2 * m;
  const auto strip = [&](double from, double to) {
    return over_polygon({{from, 2, -4}, {to, 2, -4}, {to, 18, -4}, {from, 18, -4}}, [](glm::dvec3 p) {
      const double rt = glm::length(p - glm::dvec3(-2, 0, 0)), rr = glm::length(p - glm::dvec3(2, 0, 0));
      return bistatic_mu * 16 * std::pow(rt * rr, -3);
    });
  };
  const RangeSamples samples{0, 40, 1};
  const double open = total(Scenery(scene(0)).echo(left, right, samples, 0)),
               walled = total(Scenery(scene(3 * m)).echo(left, right, samples, 0)),
               closed = total(Scenery(scene(5 * m)).echo(left, right, samples, 0));
  EXPECT_NEAR(open, strip(-16, 16), 1e-9 * open);
  EXPECT_NEAR(walled, strip(-16, -6) + strip(6, 16), 1e-9 * walled);
  EXPECT_EQ(closed, 0);
}

TEST(BistaticEcho, ARandomSampleOfPathsAgrees) {
  // The oracle draws random points on each facet and traces rays to both apexes. It shares only the mesh
  // with the engine.
  const unsigned seed = 57721;
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  std::mt19937_64 random(seed);
  FacetMesh mesh;
  constexpr std::int32_t m = 1 << 20;
  add_quad(mesh, {-8 * m, 0, -4 * m}, {8 * m, 0, -4 * m}, {8 * m, 16 * m, -3 * m}, {-8 * m, 16 * m, -3 * m});
  test::add_box(mesh, {m, 6 * m, -3 * m}, m);
  TubeSet transmit = test::forward_tubes({-3 * m, 0, 0}, 3, 2, 90, 60, 30),
          receive = test::forward_tubes({3 * m, m / 2, m}, 2, 2, 100, 60, 30);
  const RangeSamples samples{4, 1, 10};
  const Scenery run(mesh);
  const Echo echo = run.echo(transmit, receive, samples, 0.1);

  const auto point = [&](VertexId v) {
    return glm::dvec3(mesh.vertices[v].x, mesh.vertices[v].y, mesh.vertices[v].z) * unit_m;
  };
  const auto hidden = [&](glm::dvec3 apex, glm::dvec3 p) {
    for (const auto& f : mesh.facets) {
      const glm::dvec3 a = point(f[0]), e1 = point(f[1]) - a, e2 = point(f[2]) - a, d = p - apex;
      const glm::dvec3 h = glm::cross(d, e2);
      const double det = glm::dot(e1, h);
      if (std::abs(det) < 1e-12) continue;
      const glm::dvec3 s = apex - a, q = glm::cross(s, e1);
      const double u = glm::dot(s, h) / det, v = glm::dot(d, q) / det, t = glm::dot(e2, q) / det;
      if (u >= 0 && v >= 0 && u + v <= 1 && t > 0 && t < 1 - 1e-9) return true;
    }
    return false;
  };
  const auto inside = [](const TubeSet& set, glm::dvec3 direction) {
    for (const Tube& tube : set.tubes) {
      bool in = true;
      for (int k = 0; k < 4 && in; ++k) {
        const GridPoint a = set.rays[tube[k]], b = set.rays[tube[(k + 1) % 4]];
        in = glm::dot(glm::cross(glm::dvec3(a.x, a.y, a.z), glm::dvec3(b.x, b.y, b.z)), direction) >= 0;
      }
      if (in) return true;
    }
    return false;
  };
  const glm::dvec3 t(-3, 0, 0), r(3, 0.5, 1);
  const double beta = 0.1 * std::numbers::ln10 / 10;
  std::uniform_real_distribution<double> share(0, 1);
  std::vector<double> sum(10, 0), variance(10, 0);
  constexpr int points = 30000;
  for (const auto& f : mesh.facets) {
    const glm::dvec3 a = point(f[0]), e1 = point(f[1]) - a, e2 = point(f[2]) - a;
    const glm::dvec3 normal = glm::normalize(glm::cross(e1, e2));
    const double area = glm::length(glm::cross(e1, e2)) / 2;
    if (glm::dot(normal, t - a) * glm::dot(normal, r - a) <= 0) continue;
    std::vector<double> part(10, 0), squares(10, 0);
    for (int i = 0; i < points; ++i) {
      double x = share(random), y = share(random);
      if (x + y > 1) x = 1 - x, y = 1 - y;
      const glm::dvec3 p = a + x * e1 + y * e2;
      const double rt = glm::length(p - t), rr = glm::length(p - r);
      const int k = int(std::floor((rt + rr) / 2 - 4));
      if (k < 0 || k >= 10 || !inside(transmit, p - t) || !inside(receive, p - r) || hidden(t, p) ||
          hidden(r, p))
        continue;
      const double e = area * bistatic_mu * std::abs(glm::dot(normal, p - t) * glm::dot(normal, p - r)) *
                       std::pow(rt * rr, -3) * std::exp(-beta * (rt + rr));
      part[k] += e / points;
      squares[k] += e * e / points;
    }
    for (int k = 0; k < 10; ++k) {
      sum[k] += part[k];
      variance[k] += (squares[k] - part[k] * part[k]) / points;
    }
  }
  int lit = 0;
  for (int k = 0; k < 10; ++k) {
    EXPECT_NEAR(echo.at(0, k), sum[k], 5 * std::sqrt(variance[k]) + 1e-4 * total(echo)) << k;
    lit += echo.at(0, k) > 0.05 * total(echo);
  }
  EXPECT_GE(lit, 4);
}

TEST(BistaticEcho, FansHearTheirOwnTransmissionsAndBeamsTheirOwnTubes) {
  const Scenery run(rough_terrain());
  const TubeSet transmit = test::forward_tubes({0, 0, 0}, 2, 1, 60, 40, 20),
                receive = test::forward_tubes({1000000, 0, 0}, 2, 1, 60, 40, 20);
  const BistaticHistory history = run.both(transmit, receive);
  const EchoModel model{bistatic_material_mu, run.mesh.material, 0, nullptr};
  const RangeSamples samples{0, 30, 1};
  const std::vector<std::uint32_t> beams{0, 1}, swapped{1, 0}, first{0, 0}, second{1, 1};
  const Echo all = integrate_echo(history, {2, beams}, samples, model);
  const Echo other = integrate_echo(history, {2, swapped}, samples, model);
  const Echo own = integrate_echo(history, {2, beams, beams, beams}, samples, model);
  const Echo cross = integrate_echo(history, {2, beams, swapped, beams}, samples, model);
  EXPECT_EQ(total(integrate_echo(history, {2, beams, first, second}, samples, model)), 0);
  for (int b = 0; b < 2; ++b) {
    EXPECT_EQ(all.at(b, 0), other.at(1 - b, 0));
    EXPECT_NEAR(own.at(b, 0) + cross.at(b, 0), all.at(b, 0), 1e-13 * all.at(b, 0));
    EXPECT_GT(own.at(b, 0), cross.at(b, 0));
    EXPECT_GT(own.at(b, 0), 0);
  }
}

TEST(BistaticEcho, ThreadsChangeNoBit) {
  const Scenery run(terrain_with_box());
  const TubeSet a = test::forward_tubes({-1000000, 0, 0}, 4, 2, 70, 40, 20),
                b = test::forward_tubes({2500000, 700000, 900000}, 3, 3, 60, 50, 25);
  const auto with = [&](std::size_t threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    return run.echo(a, b, {2, 0.5, 40}, 0.1).energy;
  };
  EXPECT_EQ(with(1), with(4));
}

TEST(BistaticEcho, BadInputIsRefused) {
  const BistaticHistory history = piece_on(test::flat_seabed(5), endless, {1, 0, 0});
  const std::vector<std::uint16_t> material{0};
  const std::vector<std::uint32_t> beams{0}, too_far{3}, none, two{0, 0};
  const EchoModel model{bistatic_material_mu, material, 0, nullptr};
  const RangeSamples samples{0, 1, 10};
  const auto run = [&](const ReceiveBeams& b, const RangeSamples& s, const EchoModel& l,
                       double tolerance = 1e-10) {
    return integrate_echo(history, b, s, l, {Binning::exact, tolerance});
  };
  EXPECT_NO_THROW(run({1, beams}, samples, model));
  EXPECT_THROW(run({-1, beams}, samples, model), std::invalid_argument);
  EXPECT_THROW(run({1, too_far}, samples, model), std::invalid_argument);
  EXPECT_THROW(run({1, none}, samples, model), std::invalid_argument);
  EXPECT_THROW(run({1, beams, two, beams}, samples, model), std::invalid_argument);
  EXPECT_THROW(run({1, beams, beams, none}, samples, model), std::invalid_argument);
  EXPECT_THROW(run({1, beams}, {0, 0, 10}, model), std::invalid_argument);
  EXPECT_THROW(run({1, beams}, {-1, 1, 10}, model), std::invalid_argument);
  EXPECT_THROW(run({1, beams}, {0, 1, 0}, model), std::invalid_argument);
  EXPECT_THROW(run({1, beams}, {0, std::nan(""), 10}, model), std::invalid_argument);
  EXPECT_THROW(run({1, beams}, samples, {bistatic_material_mu, material, -1, nullptr}),
               std::invalid_argument);
  EXPECT_THROW(run({1, beams}, samples, {bistatic_material_mu, {}, 0, nullptr}), std::invalid_argument);
  EXPECT_THROW(run({1, beams}, samples, {{}, material, 0, nullptr}), std::invalid_argument);
  EXPECT_THROW(run({1, beams}, samples, model, 0), std::invalid_argument);
  const BeamPatterns other{{Directivity{}}, {Directivity{}, Directivity{}}, {0}, {{0, 2}}};
  EXPECT_THROW(run({1, beams}, samples, {bistatic_material_mu, material, 0, &other}), std::invalid_argument);
}

}  // namespace
}  // namespace tubefoot
