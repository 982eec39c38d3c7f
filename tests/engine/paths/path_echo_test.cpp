// SPDX-License-Identifier: GPL-3.0-or-later
// Tests echoes of paths over mirrors and with second scattering (docs/notes/multiple-paths.md). The
// comparisons are image series, closed forms, and brute-force rays.

#include "engine/paths/path_echo.hpp"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <boost/math/quadrature/gauss_kronrod.hpp>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>
#include <numeric>
#include <random>

#include "fixtures/world/path_scenes.hpp"

namespace tubefoot {
namespace {

using namespace test;

constexpr std::int32_t metre = 1 << 20;

/// Depths: source 5 m, receiver 10 m, water 20 m; the distance is 100 m.
Setting channel(int order) {
  Setting s;
  s.mesh = square_seabed(-20, 150);
  s.transmit = around({0, 0, -5}, -86, 86, 2, 180);
  s.receive = around({100, 0, -10}, -86, 86, 2, 180);
  s.samples = {40, 0.2, 250};
  s.mu = {1e-12};
  s.reflection = {0.25};
  s.paths.order = order;
  s.paths.cutoff_db = 300;
  s.paths.direct = true;
  s.paths.mirrors.surface = SeaSurface{0, 0.8, 0};
  return s;
}

// Isovelocity image sources in a channel of 20 m, with c about 1539 m/s (physics sheet).
TEST(PathEcho, AFlatChannelIsTheImageSeries) {
  constexpr int order = 4;
  Setting s = channel(order);
  s.absorption_db_per_m = 0.01;
  const PathEcho paths = s.run();
  EXPECT_EQ(paths.arrivals, 1u + 2 * order);
  EXPECT_EQ(paths.images, 4u * order - 2);  // the receiver images of the last order would add no new paths
  std::vector<double> lengths;
  for (int n = 0; n <= order; ++n) {
    std::vector<double> expected(s.samples.count);
    for (int first = 0; first < (n == 0 ? 1 : 2); ++first) {
      double depth = 5, passes = 1;
      for (int k = 0; k < n; ++k) {
        const bool at_surface = (first + k) % 2 == 0;
        depth = at_surface ? -depth : 40 - depth;
        passes *= at_surface ? 0.8 : 0.25;
      }
      const double length = std::hypot(100, depth - 10);
      lengths.push_back(length);
      expected[std::size_t((length / 2 - s.samples.first_m) / s.samples.step_m)] +=
          passes * std::pow(10, -0.001 * length) / (length * length);
    }
    double scattered = 0;  // mu is negligible
    for (int k = 0; k < s.samples.count; ++k) {
      const double energy = paths.by_order[n].at(0, k);
      if (expected[k] == 0)
        scattered += energy;
      else
        EXPECT_NEAR(energy, expected[k], 1e-9 * expected[k]) << "order " << n << " sample " << k;
    }
    EXPECT_LT(scattered, 1e-13);
  }
  EXPECT_NEAR(lengths[0] / 1539, 0.0650, 1e-4);
  EXPECT_NEAR(lengths[1] / 1539, 0.0657, 1e-4);
  EXPECT_NEAR(lengths[2] / 1539, 0.0670, 1e-4);
}

TEST(PathEcho, AFlatMirrorAtNormalIncidenceReturnsByItsImage) {
  Setting s;
  s.mesh = square_seabed(-20, 50);
  s.transmit = s.receive = around({3, -2, -5}, -90 + 1e-3, -10, 4, 100);
  s.samples = {0, 0.1, 400};
  s.mu = {1e-12};
  s.reflection = {0.5};
  // This grid has no tube straight down, so that the test adds one.
  TubeSet down;
  down.apex = s.transmit.apex;
  down.reach = 100.0 * metre;
  append_tubes(
      down, {steps(-20, 20, 2), steps(-20, 20, 2), glm::dmat3(glm::dvec3(0, 0, -1), {0, 1, 0}, {1, 0, 0})});
  s.transmit = s.receive = down;
  const PathEcho paths = s.run();
  // The specular return lies on the borders of four range gates of images. The receiver gets it once.
  EXPECT_EQ(paths.arrivals, 1u);
  EXPECT_DOUBLE_EQ(paths.by_order[1].at(0, 150), 0.5 / 900);
  EXPECT_DOUBLE_EQ(total(paths.by_order[1]), 0.5 / 900);
  EXPECT_EQ(total(paths.by_order[0]), 0);  // a monostatic sonar receives no direct arrival
}

// Order 2: one leg is direct and the other goes over the surface, in both orders. Order 3: both legs go
// over the surface. This is a sonar at the mirror image above the seabed.
TEST(PathEcho, SurfaceMultiplesOfAFlatSeabedInClosedForm) {
  const Setting s = under_surface(3);
  const PathEcho paths = s.run();
  EXPECT_EQ(total(paths.by_order[1]), 0);
  for (int k = 0; k < s.samples.count; ++k) {
    const double from = 26 + k, to = from + 1;
    const double once = 2 * 0.6 * (rings(0.01, 15, 25, to) - rings(0.01, 15, 25, from));
    EXPECT_NEAR(paths.by_order[2].at(0, k), once, 2e-8 * once) << k;
    const double twice = 0.36 * pi / 2 * 0.01 * 625 * (std::pow(from, -4) - std::pow(to, -4));
    EXPECT_NEAR(paths.by_order[3].at(0, k), twice, 2e-8 * twice) << k;
  }
}

TEST(PathEcho, ARoughSurfaceTakesMoreAtSteeperAngles) {
  Setting s = under_surface(3);
  const double roughness = 3.7;
  s.paths.mirrors.surface->roughness = roughness;
  const PathEcho paths = s.run();
  for (int k = 0; k < s.samples.count; ++k) {
    const double from = 26 + k;
    const auto twice = [&](double r) {
      return 0.36 * 2 * pi * 0.01 * 625 * std::pow(r, -5) * std::exp(-2 * roughness * 625 / (r * r));
    };
    const double both =
        boost::math::quadrature::gauss_kronrod<double, 31>::integrate(twice, from, from + 1.0);
    EXPECT_NEAR(paths.by_order[3].at(0, k), both, 2e-8 * both) << k;
    const auto radius = [](double half_path) {
      const double r = half_path + (625.0 - 225.0) / (4 * half_path);  // from the image, 25 m up
      return std::sqrt(r * r - 625);
    };
    const auto once = [&](double rho) {
      const double r1 = std::hypot(15, rho), r2 = std::hypot(25, rho);
      return 2 * 0.6 * 2 * pi * rho * 0.01 * 375 * std::pow(r1 * r2, -3) *
             std::exp(-roughness * 625 / (r2 * r2));
    };
    const double one =
        boost::math::quadrature::gauss_kronrod<double, 31>::integrate(once, radius(from), radius(from + 1));
    EXPECT_NEAR(paths.by_order[2].at(0, k), one, 2e-8 * one) << k;
  }
}

TEST(PathEcho, PatternsAreTakenAtTheTrueDirections) {
  // A pattern about the vertical, different up and down, on the transmit leg only or on the receive leg
  // only.
  const Directivity tilted{Directivity::Kind::gaussian, {0, 0, 1}, true, 0, 1.5};
  Setting s = under_surface(3);
  BeamPatterns out{{tilted}, {Directivity()}, {}, {}}, back{{TransmitPattern()}, {tilted}, {}, {}};
  for (BeamPatterns* patterns : {&out, &back}) {
    patterns->fan_of_tube.assign(s.receive.tubes.size(), 0);
    patterns->beams_of_tube.assign(s.receive.tubes.size(), {0, 1});
    const PathEcho paths = s.run(patterns);
    for (int k = 0; k < s.samples.count; k += 7) {
      const double from = 26 + k;
      const auto radius = [](double half_path) {
        const double r = half_path + (625.0 - 225.0) / (4 * half_path);
        return std::sqrt(r * r - 625);
      };
      // One leg goes up to the surface, and the other straight down.
      const auto once = [&](double rho) {
        const double r1 = std::hypot(15, rho), r2 = std::hypot(25, rho);
        return 0.6 * 2 * pi * rho * 0.01 * 375 * std::pow(r1 * r2, -3) *
               (tilted.gain_at(25 / r2) + tilted.gain_at(-15 / r1));
      };
      const double one =
          boost::math::quadrature::gauss_kronrod<double, 31>::integrate(once, radius(from), radius(from + 1));
      EXPECT_NEAR(paths.by_order[2].at(0, k), one, 5e-8 * one) << k;
      const auto twice = [&](double r) {
        return 0.36 * 2 * pi * 0.01 * 625 * std::pow(r, -5) * tilted.gain_at(25 / r);
      };
      const double both =
          boost::math::quadrature::gauss_kronrod<double, 31>::integrate(twice, from, from + 1.0);
      EXPECT_NEAR(paths.by_order[3].at(0, k), both, 5e-8 * both) << k;
    }
  }
}

TEST(PathEcho, TheCutOffDropsWhatItSaysAndNothingElse) {
  Setting s = under_surface(3);
  s.paths.mirrors.surface->reflection = std::pow(10, -0.3);  // 3 dB
  s.paths.cutoff_db = 300;
  const PathEcho all = s.run();
  s.paths.cutoff_db = 6.01;
  EXPECT_EQ(s.run().by_order[3].energy, all.by_order[3].energy);
  s.paths.cutoff_db = 5.99;
  const PathEcho less = s.run();
  EXPECT_EQ(less.by_order[2].energy, all.by_order[2].energy);
  EXPECT_EQ(total(less.by_order[3]), 0);
  s.paths.cutoff_db = 2.99;
  EXPECT_EQ(s.run().images, 0u);
}

TEST(PathEcho, EnergyGoesDownWithEveryLoss) {
  Setting s = channel(4);
  s.mu = {0.05};
  s.mesh = square_seabed(-20, 100);
  s.transmit = s.receive = around({1, 2, -5}, -86, 86, 4, 100);
  s.samples = {5, 0.5, 90};
  std::vector<double> before;
  for (const double loss_db : {0.1, 1.0, 6.0, 20.0}) {
    s.reflection = {std::pow(10, -loss_db / 10)};
    s.paths.mirrors.surface->reflection = std::pow(10, -loss_db / 10);
    const PathEcho paths = s.run();
    std::vector<double> now;
    for (const Echo& echo : paths.by_order) now.push_back(total(echo));
    for (std::size_t n = 0; n < before.size(); ++n)
      EXPECT_TRUE(now[n] < before[n] || (n < 2 && now[n] == 0)) << loss_db << ' ' << n;
    before = now;
  }
}

/// A ray tracer in doubles that tests each facet in turn.
struct Rays {
  const FacetMesh& mesh;

  std::vector<glm::dvec3> corners = [this] {
    std::vector<glm::dvec3> all;
    for (const GridPoint p : mesh.vertices) all.push_back(metres(p));
    return all;
  }();

  struct Hit {
    int facet = -1;
    double range = 1e300;
    glm::dvec3 normal{0};  ///< against the ray
  };
  Hit first(glm::dvec3 from, glm::dvec3 along, int but = -1) const {
    Hit hit;
    for (std::size_t f = 0; f < mesh.facets.size(); ++f) {
      if (int(f) == but) continue;
      const auto& [i, j, k] = mesh.facets[f];
      const glm::dvec3 a = corners[i], u = corners[j] - a, v = corners[k] - a, n = glm::cross(u, v);
      const double down = glm::dot(n, along);
      if (down == 0) continue;
      const double range = glm::dot(n, a - from) / down;
      if (!(range > 1e-9) || range >= hit.range) continue;
      const glm::dvec3 p = from + range * along - a;
      const double nn = glm::dot(n, n), s = glm::dot(glm::cross(p, v), n) / nn,
                   t = glm::dot(glm::cross(u, p), n) / nn;
      if (s < 0 || t < 0 || s + t > 1) continue;
      hit = {int(f), range, glm::normalize(down > 0 ? -n : n)};
    }
    return hit;
  }
};

// Two perpendicular plates, a seabed that extends under both and past them, and loose facets that intersect
// everything. Mirror planes cut facets. Facets hide each other on the transmit leg, between scatterings and
// on the receive leg.
TEST(PathEcho, OnceMirroredOnceScatteredAgreesWithBruteForceRays) {
  const unsigned seed = 4;  // a seed for which no loose facet hides the corner
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> place(-1, 1);
  Setting s;
  add_quad(s.mesh, {4, -3, -2}, {4.5, 4, -2.2}, {4.25, 4, 2.5}, {3.75, -3, 2.4}, 1);
  add_quad(s.mesh, {-3, 4, -2}, {4.5, 4, -2.2}, {4.25, 4, 2.5}, {-3.1, 4, 2.5}, 1);
  add_quad(s.mesh, {-6, -6, -1.5}, {7, -6, -1.7}, {7, 7, -1.4}, {-6, 7, -1.6}, 0);
  for (int k = 0; k < 6; ++k) {
    VertexId v[3];
    const glm::dvec3 middle{2 + 2.5 * place(random), 2 + 2.5 * place(random), 0.5 + place(random)};
    for (VertexId& id : v) {
      const glm::dvec3 corner{middle.x + place(random), middle.y + place(random), middle.z + place(random)};
      id = add_vertex(s.mesh, at({corner.x, corner.y, corner.z}));
    }
    add_facet(s.mesh, v[0], v[1], v[2]);
  }
  // This spike penetrates the first plate, and most of it lies behind the plate. There it must hide
  // nothing.
  const VertexId spike[] = {add_vertex(s.mesh, at({3.6, 0.4, 0.6})), add_vertex(s.mesh, at({7, -2, -0.5})),
                            add_vertex(s.mesh, at({7, 2.5, 1.5}))};
  add_facet(s.mesh, spike[0], spike[1], spike[2]);
  const GridPoint apex = at({-1, -1.25, 0.3});
  const glm::dvec3 forward = glm::normalize(glm::dvec3(1, 1, -0.1)),
                   right = glm::normalize(glm::cross(forward, {0, 0, 1})), up = glm::cross(right, forward);
  TubeSet set;
  set.apex = apex;
  set.reach = 60.0 * metre;
  append_tubes(set, {steps(-40, 40, 4), steps(-35, 35, 3), glm::dmat3(forward, right, up)});
  s.transmit = s.receive = set;
  s.samples = {0, 1, 30};
  s.mu = {0.1, 0.02};
  s.reflection = {0, 0.7};
  s.paths.order = 2;
  const PathEcho paths = s.run();

  // The plates make a corner of slightly less than a right angle, which returns two images. The rays below
  // do not model this unscattered return.
  Setting smooth = s;
  smooth.mu = {0, 0};
  const PathEcho arrivals = smooth.run();
  EXPECT_EQ(arrivals.arrivals, 2u);
  std::vector<double> expected = arrivals.by_order[2].energy;
  EXPECT_NEAR(total(arrivals.by_order[2]), 2 * 0.49 / 224, 0.1 / 224);  // about twice as far as to the edge

  const Rays rays{s.mesh};
  // A square grid of directions over the section of each tube: d = a + s (b - a) + t (e - a) + s t (a + c -
  // b - e).
  constexpr int n = 260;
  const glm::dvec3 from = metres(apex);
  for (const Tube& tube : set.tubes) {
    glm::dvec3 corner[4];
    for (int k = 0; k < 4; ++k)
      corner[k] = glm::normalize(glm::dvec3(set.rays[tube[k]].x, set.rays[tube[k]].y, set.rays[tube[k]].z));
    for (int i = 0; i < n; ++i)
      for (int j = 0; j < n; ++j) {
        const double x = (i + 0.5 * (1 + place(random))) / n, y = (j + 0.5 * (1 + place(random))) / n;
        const glm::dvec3 q = (1 - x) * (1 - y) * corner[0] + x * (1 - y) * corner[1] + x * y * corner[2] +
                             (1 - x) * y * corner[3],
                         dx = (1 - y) * (corner[1] - corner[0]) + y * (corner[2] - corner[3]),
                         dy = (1 - x) * (corner[3] - corner[0]) + x * (corner[2] - corner[1]);
        const double solid_angle =
            std::abs(glm::dot(q, glm::cross(dx, dy))) / std::pow(glm::length(q), 3) / (n * n);
        const glm::dvec3 along = glm::normalize(q);
        const Rays::Hit mirror = rays.first(from, along);
        if (mirror.facet < 0 || s.mesh.material[mirror.facet] != 1) continue;
        const glm::dvec3 turned = from + mirror.range * along,
                         onward = along - 2 * glm::dot(along, mirror.normal) * mirror.normal;
        const Rays::Hit second = rays.first(turned, onward, mirror.facet);
        if (second.facet < 0) continue;
        const glm::dvec3 point = turned + second.range * onward, rx = from - point;
        const double range = glm::length(rx), sine = glm::dot(rx, second.normal) / range;
        if (sine <= 0 || rays.first(point, rx / range, second.facet).range < range) continue;
        // The tubes of the receiver are those of the transmitter.
        bool received = false;
        const glm::dvec3 there = -rx * double(metre);
        for (const Tube& other : set.tubes) {
          bool inside = true;
          for (int k = 0; k < 4; ++k) {
            const GridPoint a = set.rays[other[k]], b = set.rays[other[(k + 1) % 4]];
            inside = inside &&
                     glm::dot(glm::cross(glm::dvec3(a.x, a.y, a.z), glm::dvec3(b.x, b.y, b.z)), there) >= 0;
          }
          received = received || inside;
        }
        if (!received) continue;
        const double half = (mirror.range + second.range + range) / 2;
        if (half < s.samples.count)
          expected[std::size_t(half)] +=
              2 * 0.7 * solid_angle * s.mu[s.mesh.material[second.facet]] * sine / (range * range);
      }
  }
  const double all = std::accumulate(expected.begin(), expected.end(), 0.0),
               rest = all - total(arrivals.by_order[2]);
  EXPECT_NEAR(total(paths.by_order[2]), all, 1e-3 * rest);
  for (int k = 0; k < s.samples.count; ++k)
    EXPECT_NEAR(paths.by_order[2].at(0, k), expected[k],
                5e-3 * (expected[k] - arrivals.by_order[2].at(0, k)) + 1e-3 * rest)
        << k;
}

// A right angle acts on its image as one mirror. One half is visible by the first plate, and the other half
// by the second. For a receiver at the transmitter the border of the two is the edge of the corner.
TEST(PathEcho, ACornerReflectorSendsBackOneImage) {
  Setting s;
  add_quad(s.mesh, {5, -5, -5}, {5, 4, -5}, {5, 4, 5}, {5, -5, 5}, 0);
  add_quad(s.mesh, {-5, 4, -5}, {5, 4, -5}, {5, 4, 5}, {-5, 4, 5}, 0);
  TubeSet set;
  set.apex = at({1, 0.5, 0.25});
  set.reach = 100.0 * metre;
  append_tubes(set, {steps(-60, 60, 3), steps(-30, 30, 2),
                     glm::dmat3(glm::normalize(glm::dvec3(1, 1, 0)), glm::normalize(glm::dvec3(1, -1, 0)),
                                {0, 0, 1})});
  s.transmit = s.receive = set;
  s.samples = {0, 0.01, 2000};
  s.mu = {1e-12};
  s.reflection = {0.5};
  s.paths.order = 3;
  const PathEcho paths = s.run();
  const auto sample = [](double half) { return int(half / 0.01); };
  EXPECT_NEAR(paths.by_order[1].at(0, sample(4)), 0.5 / 64, 1e-12);  // either plate, straight on
  EXPECT_NEAR(paths.by_order[1].at(0, sample(3.5)), 0.5 / 49, 1e-12);
  const double edge = std::hypot(4, 3.5);
  EXPECT_NEAR(paths.by_order[2].at(0, sample(edge)), 0.25 / (4 * edge * edge), 1e-12);
  EXPECT_EQ(paths.arrivals, 3u);
  for (const double aside : {-0.5, 0.5}) {
    s.receive.apex = at({1 + aside, 0.5, 0.25});
    const double length = std::hypot(8 - aside, 7);
    const PathEcho apart = s.run();
    EXPECT_NEAR(apart.by_order[2].at(0, sample(length / 2)), 0.25 / (length * length), 1e-12);
    EXPECT_EQ(apart.arrivals, 3u);
  }
}

/// A sphere about the origin by bisection of the edges of a regular octahedron.
FacetMesh sphere(double radius, int halvings, bool bowl) {
  FacetMesh mesh;
  const auto add = [&](auto&& self, glm::dvec3 a, glm::dvec3 b, glm::dvec3 c, int left) -> void {
    if (left > 0) {
      const glm::dvec3 ab = glm::normalize(a + b), bc = glm::normalize(b + c), ca = glm::normalize(c + a);
      self(self, a, ab, ca, left - 1);
      self(self, ab, b, bc, left - 1);
      self(self, ca, bc, c, left - 1);
      self(self, ab, bc, ca, left - 1);
      return;
    }
    VertexId v[3];
    int k = 0;
    for (const glm::dvec3 p : {a, b, c})
      v[k++] = add_vertex(mesh, at({radius * p.x, radius * p.y, radius * p.z}));
    add_facet(mesh, v[0], v[1], v[2]);
  };
  for (const double x : {-1, 1})
    for (const double y : {-1, 1})
      for (const double z : {-1, 1})
        if (z < 0 || !bowl) add(add, {x, 0, 0}, {0, y, 0}, {0, 0, z}, halvings);
  weld(mesh);
  return mesh;
}

Setting in_a_sphere(bool bowl) {
  Setting s;
  s.mesh = sphere(2, 2, bowl);
  s.transmit.apex = at({0, 0, 0.01});
  s.transmit.reach = 20.0 * metre;
  append_tubes(s.transmit, {steps(-180, 180, 4), steps(-89.9, 89.9, 2), glm::dmat3(1)});
  s.receive = s.transmit;
  s.samples = {1, 0.25, 20};
  s.mu = {0.2};
  s.reflection = {0};
  s.paths.order = 2;
  s.paths.scatterings = 2;
  return s;
}

// sin sin / r^2 is 1 / (4 a^2) between any two points of a sphere. Thus the middle of the sphere receives
// pi mu (the albedo) times the first scattering from the second. The part c^2 / (4 a^2) arrives by chords
// up to c. A bowl, half a sphere, keeps half of the sound. The opening of this bowl is 0.512 of its area,
// and facets do not insonify themselves (1 in 64). The radius lies between those of the corners and of the
// middles of the facets.
TEST(PathEcho, ASphereAndABowlHaveASecondEcho) {
  for (const bool bowl : {false, true}) {
    const Setting s = in_a_sphere(bowl);
    const PathEcho paths = s.run();
    const double part = bowl ? 0.5 : 1, a = 1.95, first = part * 4 * pi * 0.2 / (a * a);
    EXPECT_NEAR(total(paths.by_order[2]), part * pi * 0.2 * first,
                (bowl ? 0.045 : 0.03) * part * pi * 0.2 * first)
        << bowl;
    if (bowl) continue;
    double sum = 0;
    for (int k = 0; k < s.samples.count; ++k) {
      sum += paths.by_order[2].at(0, k);
      const double chord = 2 * (s.samples.first_m + (k + 1) * s.samples.step_m - a);
      const double near = chord <= 0 ? 0 : std::min(1.0, chord * chord / (4 * a * a));
      EXPECT_NEAR(sum / total(paths.by_order[2]), near, 0.04) << k;
    }
  }
}

/// Two oblique plates that face each other. Neither hides anything.
Setting two_plates() {
  Setting s;
  add_quad(s.mesh, {-1, -1, -2}, {1, -1, -2}, {1, 1, -2}, {-1, 1, -2}, 0);
  add_quad(s.mesh, {2, -1, -1.5}, {2.25, 1, -1.5}, {2.25, 1, 0.5}, {2, -1, 0.5}, 1);
  TubeSet set;
  set.apex = at({-0.5, 0.25, 0.5});
  set.reach = 20.0 * metre;
  const glm::dvec3 forward = glm::normalize(glm::dvec3(1, 0, -1));
  append_tubes(set, {steps(-75, 75, 4), steps(-75, 75, 3),
                     glm::dmat3(forward, {0, -1, 0}, glm::cross(forward, {0, -1, 0}))});
  s.transmit = s.receive = set;
  s.samples = {2, 0.5, 8};
  s.mu = {0.1, 0.3};
  s.reflection = {0, 0};
  s.paths.order = 2;
  s.paths.scatterings = 2;
  s.absorption_db_per_m = 0.5;
  return s;
}

TEST(PathEcho, TwoScatteringsAreTheDoubleIntegralOverBothFacetsAndConvergeWithThePatches) {
  Setting s = two_plates();
  s.receive.apex = at({-0.25, -0.5, 0.75});
  // Midpoint rule over both plates, in both orders.
  struct Point {
    glm::dvec3 at, normal;
    double area, mu;
  };
  constexpr int n = 24;
  std::vector<Point> points[2];
  const glm::dvec3 a[2] = {{-1, -1, -2}, {2, -1, -1.5}}, u[2] = {{2, 0, 0}, {0.25, 2, 0}},
                   v[2] = {{0, 2, 0}, {0, 0, 2}};
  for (int p = 0; p < 2; ++p)
    for (int i = 0; i < n; ++i)
      for (int j = 0; j < n; ++j) {
        const glm::dvec3 normal = glm::cross(u[p], v[p]) * (p == 0 ? 1.0 : -1.0);
        points[p].push_back({a[p] + (i + 0.5) / n * u[p] + (j + 0.5) / n * v[p], glm::normalize(normal),
                             glm::length(normal) / (n * n), s.mu[p]});
      }
  const double beta = 0.5 * std::numbers::ln10 / 10;
  const glm::dvec3 from = metres(s.transmit.apex), to = metres(s.receive.apex);
  std::vector<double> expected(s.samples.count);
  for (int first = 0; first < 2; ++first)
    for (const Point& p : points[first])
      for (const Point& q : points[1 - first]) {
        const glm::dvec3 in = from - p.at, over = q.at - p.at, out = to - q.at;
        const double r1 = glm::length(in), r2 = glm::length(over), r3 = glm::length(out), path = r1 + r2 + r3;
        const double sines = glm::dot(p.normal, in) / r1 * (glm::dot(p.normal, over) / r2) *
                             (-glm::dot(q.normal, over) / r2) * (glm::dot(q.normal, out) / r3);
        const int k = int((path / 2 - s.samples.first_m) / s.samples.step_m);
        if (k >= 0 && k < s.samples.count)
          expected[k] +=
              p.mu * q.mu * sines * std::exp(-beta * path) / std::pow(r1 * r2 * r3, 2) * p.area * q.area;
      }
  const double all = std::accumulate(expected.begin(), expected.end(), 0.0);
  s.paths.patch_m = 0.25;
  const PathEcho fine = s.run();
  EXPECT_NEAR(total(fine.by_order[2]), all, 2e-3 * all);
  for (int k = 0; k < s.samples.count; ++k)
    EXPECT_NEAR(fine.by_order[2].at(0, k), expected[k], 0.01 * expected[k] + 0.003 * all) << k;
  // The error is a quarter with patches half as long.
  s.paths.patch_m = 2;
  const double coarse = total(s.run().by_order[2]);
  s.paths.patch_m = 1;
  const double middle = total(s.run().by_order[2]), best = total(fine.by_order[2]);
  EXPECT_GT(std::abs(coarse - best), 2 * std::abs(middle - best));
}

TEST(PathEcho, TwoScatteringsOverASurfaceAreThoseOfItsImage) {
  // The mirror image of the second plate stands as far above the surface. The scene with the image plate
  // gives the same energy, as far as the leg from plate to plate goes over the surface.
  Setting s;
  s.mesh = square_seabed(-4, 2);
  s.transmit = s.receive = around({0, 0, -2}, -89, -5, 3, 40);
  s.samples = {0, 40, 1};
  s.mu = {0.2};
  s.reflection = {0};
  s.paths.order = 3;
  s.paths.scatterings = 2;
  s.paths.patch_m = 0.5;
  s.paths.mirrors.surface = SeaSurface{0, 0.7, 0};
  const double over_surface = total(s.run().by_order[3]);
  // From seabed to seabed over the surface, 4 m up: each leg from p to q uses an image at a distance of 8
  // m.
  constexpr int n = 40;
  double expected = 0;
  for (int i = 0; i < n * n; ++i)
    for (int j = 0; j < n * n; ++j) {
      const glm::dvec3 p(4 * (i % n + 0.5) / n - 2, 4 * (i / n + 0.5) / n - 2, 0),
          q(4 * (j % n + 0.5) / n - 2, 4 * (j / n + 0.5) / n - 2, 8), rx(0, 0, 2);
      const double r1 = glm::length(rx - p), r2 = glm::length(q - p),
                   r3 = glm::length(rx - glm::dvec3(q.x, q.y, 0));
      expected += 0.7 * 0.04 * (2 / r1) * (8 / r2) * (8 / r2) * (2 / r3) / std::pow(r1 * r2 * r3, 2) *
                  std::pow(4.0 / n, 4);
    }
  EXPECT_NEAR(over_surface, expected, 0.01 * expected);
}

TEST(PathEcho, ThreadsChangeNothing) {
  Setting s = channel(2);
  s.mu = {0.02};
  const PathEcho many = s.run();
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const PathEcho alone = s.run();
  for (std::size_t n = 0; n < many.by_order.size(); ++n)
    EXPECT_EQ(many.by_order[n].energy, alone.by_order[n].energy);
}

}  // namespace
}  // namespace tubefoot
