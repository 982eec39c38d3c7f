// SPDX-License-Identifier: GPL-3.0-or-later
// Compares covariances of a receiver pair with closed forms, with sums over scatterers, and with
// realisations of random scatterers.
#include "engine/echo/receiver_pair_echo.hpp"

#include <gtest/gtest.h>

#include <boost/math/quadrature/gauss_kronrod.hpp>
#include <cmath>
#include <complex>
#include <random>

#include "fixtures/geometry/plane_polygons.hpp"
#include "geometry/numbers/scalars.hpp"

namespace tubefoot {
namespace {

using test::Polygon2;
using Complex = std::complex<double>;

constexpr double mu = 0.003;
const std::vector<double> material_mu{mu, 0};
const std::vector<std::uint16_t> one_material(64, 0);

BeamPatterns patterns_of(const ReceiverBaseline& receiver_pair, const Directivity& transmit = {},
                         const Directivity& receive = {}) {
  return {{transmit}, {receive}, {0}, {{0, 1}}, {receiver_pair}};
}

/// A part of one facet that all ends see.
ReceiverPairHistory piece_for_pair(const FacetPlane& plane, const Polygon2& polygon) {
  ReceiverPairHistory history;
  SharedFacet facet;
  facet.piece_count = 1;
  facet.plane_normal = plane.normal;
  facet.transmit_distance_m = plane.distance_m;
  for (SharedFootprints* shared : {&history.by_upper, &history.by_lower}) {
    shared->corners_m = test::on_plane(plane, polygon);
    shared->pieces = {{0, 0, 0, std::uint32_t(polygon.size())}};
    shared->facets = {facet};
  }
  return history;
}

ReceiverPairEcho echo_of(const ReceiverPairHistory& history, const BeamPatterns& patterns,
                         const RangeSamples& samples,
                         std::span<const std::uint16_t> material = one_material) {
  return integrate_receiver_pair_echo(history, patterns.baselines[0], 0, 0, samples,
                                      {material_mu, material, 0, &patterns});
}

Complex cross_of(const ReceiverPairEcho& echo, std::size_t k) {
  return {echo.cross_real_j[k], echo.cross_imag_j[k]};
}
double coherence(const ReceiverPairEcho& echo, std::size_t k) {
  return std::abs(cross_of(echo, k)) / std::sqrt(echo.upper_j[k] * echo.lower_j[k]);
}

/// A strip, 1 mm wide along the track (y), of a plane `depth` below that rises by `slope` to starboard (x).
ReceiverPairHistory strip(double depth, double slope, double from, double to) {
  const FacetPlane plane{glm::normalize(glm::dvec3(-slope, 0, 1)), depth / std::hypot(1, slope)};
  const PlaneFrame frame(plane);
  const auto on = [&](double x, double y) { return frame.project({x, y, -depth + slope * x}); };
  Polygon2 polygon{on(from, -0.0005), on(from, 0.0005), on(to, 0.0005), on(to, -0.0005)};
  double turn = 0;
  for (std::size_t i = 0; i < 4; ++i)
    turn += polygon[i].x * polygon[(i + 1) % 4].y - polygon[i].y * polygon[(i + 1) % 4].x;
  if (turn < 0) std::reverse(polygon.begin(), polygon.end());
  return piece_for_pair(plane, polygon);
}

ReceiverBaseline receiver_pair_at(double tilt_rad, double baseline_m, double frequency_hz) {
  return {{std::sin(tilt_rad), 0, std::cos(tilt_rad)}, baseline_m, 2 * pi * frequency_hz / 1500};
}

/// |sin((dR - s) kappa / 2)| / (dR kappa / 2): the spread of phases in the range bin, over the part that
/// both receivers have in the same bin. `delta` returns the path difference at a range.
template <class Delta>
double expected_coherence(double range, double step, double wavenumber, const Delta& delta) {
  const double shift = std::abs(delta(range)) / 2;
  if (shift >= step) return 0;
  const double kappa = wavenumber * std::abs(delta(range + step / 2) - delta(range - step / 2)) / step;
  return std::abs(std::sin((step - shift) * kappa / 2)) / (step * kappa / 2);
}

// If the plane of a facet passes between the two ends, one end sees the facet. This does not depend on
// which end it is.
TEST(ReceiverPairEcho, AFacetThatOnlyOneEndFacesIsReceivedByThatEnd) {
  const FacetPlane plane{{1, 0, 0}, 0.02};
  ReceiverPairHistory history = piece_for_pair(plane, {{3, 3}, {4, 3}, {4, 4}});
  const RangeSamples samples{3, 1, 4};
  history.by_lower = {};
  const ReceiverPairEcho across = echo_of(history, patterns_of({{1, 0, 0}, 0.1, 100}), samples);
  // The upper end stays in place. The lower end lies next to it, before the plane.
  history.middle_m = {0.045, 0, 0};
  const ReceiverPairEcho before = echo_of(history, patterns_of({{1, 0, 0}, 0.01, 100}), samples);
  double all = 0;
  for (std::size_t k = 0; k < 4; ++k) {
    EXPECT_NEAR(across.upper_j[k], before.upper_j[k], 1e-7 * before.upper_j[k]) << k;
    EXPECT_EQ(across.lower_j[k], 0) << k;
    EXPECT_EQ(cross_of(across, k), 0.0) << k;
    all += before.upper_j[k];
  }
  EXPECT_GT(all, 0);
}

TEST(ReceiverPairEcho, CoherenceOfTheFlatSeabedHasTheShiftOfTheReceiversSamples) {
  const double range = 30, step = 0.075;
  const ReceiverBaseline receiver_pair = receiver_pair_at(pi / 6, 0.06, 250e3);
  const ReceiverPairEcho echo =
      echo_of(strip(10, 0, 5, 40), patterns_of(receiver_pair), {range - step / 2, step, 1});
  // A sum over eight million scatterers gives 0.9268102. Without the shift the value is 0.999876.
  EXPECT_NEAR(coherence(echo, 0), 0.926810, 2e-6);
  const double lean = std::asin(1.0 / 3) - pi / 6;
  EXPECT_NEAR(coherence(echo, 0), 0.999876 * (1 - 0.03 * std::abs(std::sin(lean)) / step), 5e-5);
}

TEST(ReceiverPairEcho, TiltedSeabedsAndLongBaselinesFollowTheClosedForm) {
  const double depth = 10;
  for (const double slope : {-0.2, 0.0, 0.15})
    for (const double baseline : {0.01, 0.06, 0.2})
      for (const double step : {0.02, 0.075})
        for (const double range : {16.0, 24.0, 30.0}) {
          const ReceiverBaseline receiver_pair = receiver_pair_at(pi / 6, baseline, 250e3);
          const double rise = std::atan(slope);
          const auto delta = [&](double r) {
            return baseline * std::sin(std::asin(depth * std::cos(rise) / r) - rise - pi / 6);
          };
          const ReceiverPairEcho echo =
              echo_of(strip(depth, slope, 2, 60), patterns_of(receiver_pair), {range - step / 2, step, 1});
          const double expected = expected_coherence(range, step, receiver_pair.wavenumber_rad_m, delta);
          // The energy is not quite uniform over the range bin. The deviation is a few times the bin length
          // divided by the range.
          EXPECT_NEAR(coherence(echo, 0), expected, 3 * step / range)
              << slope << ", baseline " << baseline << ", step " << step << ", range " << range;
          EXPECT_GT(echo.upper_j[0], 0);
        }
}

TEST(ReceiverPairEcho, SamplesThatDoNotMeetHaveNoCoherence) {
  // The range bins of the receivers are shifted against each other by half the path difference, at least 15
  // cm.
  const ReceiverBaseline receiver_pair = receiver_pair_at(-pi / 3, 0.5, 250e3);
  const ReceiverPairEcho echo = echo_of(strip(10, 0, 5, 40), patterns_of(receiver_pair), {20, 0.1, 100});
  for (std::size_t k = 0; k < 100; ++k) {
    EXPECT_GT(echo.upper_j[k], 0);
    EXPECT_GT(echo.lower_j[k], 0);
    EXPECT_EQ(cross_of(echo, k), 0.0) << k;
  }
}

TEST(ReceiverPairEcho, AnInfinitelyShortBaselineIsOneReceiverAndSwappedOnesAreConjugate) {
  ReceiverBaseline receiver_pair = receiver_pair_at(pi / 6, 1e-7, 250e3);
  const ReceiverPairHistory seabed = strip(10, 0.1, 2, 40);
  const RangeSamples samples{14, 0.5, 40};
  const ReceiverPairEcho one = echo_of(seabed, patterns_of(receiver_pair), samples);
  for (std::size_t k = 0; k < 40; ++k) {
    EXPECT_NEAR(one.cross_real_j[k], one.upper_j[k], 2e-6 * one.upper_j[k]);
    EXPECT_NEAR(one.lower_j[k], one.upper_j[k], 2e-6 * one.upper_j[k]);
  }
  receiver_pair = receiver_pair_at(pi / 6, 0.1, 250e3);
  const ReceiverPairEcho there = echo_of(seabed, patterns_of(receiver_pair), samples);
  receiver_pair.axis = -receiver_pair.axis;
  const ReceiverPairEcho back = echo_of(seabed, patterns_of(receiver_pair), samples);
  for (std::size_t k = 0; k < 40; ++k) {
    EXPECT_NEAR(there.upper_j[k], back.lower_j[k], 1e-9 * there.upper_j[k]);
    EXPECT_LT(std::abs(cross_of(there, k) - std::conj(cross_of(back, k))), 1e-8 * there.upper_j[k]);
  }
}

bool inside(const Polygon2& polygon, glm::dvec2 p) {
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const glm::dvec2 a = polygon[i], along = polygon[(i + 1) % polygon.size()] - a, to = p - a;
    if (along.x * to.y - along.y * to.x < 0) return false;
  }
  return true;
}

/// Energy of scatterers at a position for one receiver, and index of their range bin (-1: none).
struct Reception {
  double energy = 0, range = 0;
  int sample = -1;
};
Reception received(const FacetPlane& plane, glm::dvec3 at, double area, glm::dvec3 receiver,
                   const RangeSamples& samples) {
  const double rt = glm::length(at), rr = glm::distance(at, receiver);
  const double st = glm::dot(plane.normal, -at) / rt, sr = glm::dot(plane.normal, receiver - at) / rr;
  const double place = std::floor(((rt + rr) / 2 - samples.first_m) / samples.step_m);
  return {mu * st * sr / (rt * rt * rr * rr) * area, rr,
          place >= 0 && place < samples.count ? int(place) : -1};
}

/// Integrates over a polygon of a plane, triangle by triangle.
template <class Density>
double over_polygon(const FacetPlane& plane, const Polygon2& polygon, const Density& density) {
  using boost::math::quadrature::gauss_kronrod;
  const auto corners = test::on_plane(plane, polygon);
  double sum = 0;
  for (std::size_t t = 2; t < corners.size(); ++t) {
    const glm::dvec3 a = corners[0], b = corners[t - 1] - a, c = corners[t] - corners[t - 1];
    const auto row = [&](double x) {
      return x * gauss_kronrod<double, 31>::integrate([&](double y) { return density(a + x * (b + y * c)); },
                                                      0.0, 1.0, 6, 1e-11);
    };
    sum += glm::length(glm::cross(b, c)) * gauss_kronrod<double, 31>::integrate(row, 0.0, 1.0, 6, 1e-11);
  }
  return sum;
}

// All energy falls into one range bin, so that only the integrals matter, with patterns. Later cases move
// the transmitter.
TEST(ReceiverPairEcho, TotalsAgreeWithQuadratureInSpaceWithPatterns) {
  const unsigned seed = 161803;
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> place(-5, 5), distance(1, 6), share(0, 1), waves(0.3, 6);
  std::normal_distribution<double> gauss;
  const auto unit = [&] { return glm::normalize(glm::dvec3(gauss(random), gauss(random), gauss(random))); };
  for (int i = 0; i < 16; ++i) {
    const FacetPlane plane = test::random_plane(random, distance(random));
    const ReceiverBaseline receiver_pair{unit(), 0.9 * plane.distance_m * share(random),
                                         2 * pi * waves(random)};
    Directivity transmit, receive;
    if (i % 3 > 0) transmit = {Directivity::Kind::gaussian, unit(), true, 0, 0.9};
    // The product has corners at the nulls of a line, and their integration takes long.
    if (i % 3 > 1 && i < 8) receive = {Directivity::Kind::line, unit(), false, 0.1, 3};
    if (i % 3 > 1 && i >= 8) receive = {Directivity::Kind::gaussian, unit(), true, 0, 1.2};
    const glm::dvec2 centre = i % 4 ? glm::dvec2(place(random), place(random)) : glm::dvec2(0.2, -0.1);
    const Polygon2 polygon = test::random_convex(random, centre, 2.5, 1.5);
    ReceiverPairHistory history = piece_for_pair(plane, polygon);
    if (i >= 8) {
      // The pair moves along the plane, and above the plane as far as both ends require.
      const PlaneFrame frame(plane);
      history.middle_m =
          place(random) * frame.u + place(random) * frame.v + (distance(random) - 0.1) / 2 * plane.normal;
    }
    const glm::dvec3 half = receiver_pair.baseline_m / 2 * receiver_pair.axis, end = history.middle_m + half,
                     other = history.middle_m - half;
    const ReceiverPairEcho echo =
        echo_of(history, patterns_of(receiver_pair, transmit, receive), {0.9 * plane.distance_m, 100, 1});
    const auto energy = [&](glm::dvec3 at, glm::dvec3 receiver) {
      return received(plane, at, 1, receiver, {0, 1e6, 1}).energy * transmit.gain(glm::normalize(at)) *
             receive.gain(glm::normalize(at - receiver));
    };
    const auto product = [&](glm::dvec3 at) {
      return std::polar(std::sqrt(energy(at, end) * energy(at, other)),
                        receiver_pair.wavenumber_rad_m * (glm::distance(at, end) - glm::distance(at, other)));
    };
    const double upper = over_polygon(plane, polygon, [&](glm::dvec3 at) { return energy(at, end); }),
                 lower = over_polygon(plane, polygon, [&](glm::dvec3 at) { return energy(at, other); });
    const double scale = 1e-7 * std::sqrt(upper * lower);
    EXPECT_NEAR(echo.upper_j[0], upper, 1e-7 * upper) << i;
    EXPECT_NEAR(echo.lower_j[0], lower, 1e-7 * lower) << i;
    EXPECT_NEAR(echo.cross_real_j[0],
                over_polygon(plane, polygon, [&](glm::dvec3 at) { return product(at).real(); }), scale)
        << i;
    EXPECT_NEAR(echo.cross_imag_j[0],
                over_polygon(plane, polygon, [&](glm::dvec3 at) { return product(at).imag(); }), scale)
        << i;
  }
}

// This check does not depend on any cuts: the seabed is a lattice of a million scatterers, each with its
// own ranges. About the foot point the ellipses of both receivers are small and far from each other.
TEST(ReceiverPairEcho, AgreesWithSumsOverScatterers) {
  const unsigned seed = 161803;
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> place(-5, 5), distance(1, 6), share(0, 1);
  std::normal_distribution<double> gauss;
  for (int i = 0; i < 6; ++i) {
    const FacetPlane plane = test::random_plane(random, distance(random));
    const glm::dvec2 centre = i % 2 ? glm::dvec2(place(random), place(random)) : glm::dvec2(0.2, -0.1);
    const Polygon2 polygon = test::random_convex(random, centre, 2.5, 1.5);
    ReceiverBaseline receiver_pair{glm::normalize(glm::dvec3(gauss(random), gauss(random), gauss(random))),
                                   0.9 * plane.distance_m * share(random), 2 * pi * 2.5};
    const RangeSamples samples{plane.distance_m * 0.97, i % 4 < 2 ? 0.05 : 0.3, i % 4 < 2 ? 160 : 30};
    const ReceiverPairEcho echo =
        echo_of(piece_for_pair(plane, polygon), patterns_of(receiver_pair), samples);

    constexpr int n = 1200;
    glm::dvec2 low = polygon[0], high = low;
    for (const glm::dvec2 p : polygon) {
      low = glm::min(low, p);
      high = glm::max(high, p);
    }
    const glm::dvec2 cell = (high - low) / double(n);
    const PlaneFrame frame(plane);
    const std::size_t count = std::size_t(samples.count);
    std::vector<double> upper(count), lower(count);
    std::vector<Complex> cross(count);
    for (int x = 0; x < n; ++x)
      for (int y = 0; y < n; ++y) {
        const glm::dvec2 p = low + cell * glm::dvec2(x + 0.5, y + 0.5);
        if (!inside(polygon, p)) continue;
        const glm::dvec3 at = p.x * frame.u + p.y * frame.v - plane.distance_m * plane.normal;
        const glm::dvec3 end = receiver_pair.baseline_m / 2 * receiver_pair.axis;
        const Reception u = received(plane, at, cell.x * cell.y, end, samples),
                        l = received(plane, at, cell.x * cell.y, -end, samples);
        if (u.sample >= 0) upper[std::size_t(u.sample)] += u.energy;
        if (l.sample >= 0) lower[std::size_t(l.sample)] += l.energy;
        if (u.sample >= 0 && u.sample == l.sample)
          cross[std::size_t(u.sample)] += std::polar(std::sqrt(u.energy * l.energy),
                                                     receiver_pair.wavenumber_rad_m * (u.range - l.range));
      }
    double loudest = 0;
    for (const double e : upper) loudest = std::max(loudest, e);
    ASSERT_GT(loudest, 0);
    for (std::size_t k = 0; k < count; ++k) {  // the borders of a lattice are inexact by its cells
      ASSERT_NEAR(echo.upper_j[k], upper[k], 4e-3 * loudest) << i << ", sample " << k;
      ASSERT_NEAR(echo.lower_j[k], lower[k], 4e-3 * loudest) << i << ", sample " << k;
      ASSERT_LT(std::abs(cross_of(echo, k) - cross[k]), 4e-3 * loudest) << i << ", sample " << k;
    }
  }
}

// The covariance is that of random fields. The realisations are scatterers with circular Gaussian
// amplitudes.
TEST(ReceiverPairEcho, RealisationsOfScatterersHaveThisCovariance) {
  const unsigned seed = 2718;
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  std::mt19937_64 random(seed);
  std::normal_distribution<double> gauss(0, std::sqrt(0.5));
  const double depth = 10, step = 0.05;
  const ReceiverBaseline receiver_pair = receiver_pair_at(pi / 6, 0.05, 250e3);
  const RangeSamples samples{28, step, 3};
  const ReceiverPairEcho echo = echo_of(strip(depth, 0, 5, 40), patterns_of(receiver_pair), samples);
  const FacetPlane plane{{0, 0, 1}, depth};
  const glm::dvec3 end = receiver_pair.baseline_m / 2 * receiver_pair.axis;
  struct One {
    Reception upper, lower;
  };
  std::vector<One> scatterers;
  const double from = std::sqrt(27.9 * 27.9 - depth * depth), to = std::sqrt(28.3 * 28.3 - depth * depth);
  constexpr int many = 250;
  for (int k = 0; k < many; ++k) {
    const glm::dvec3 at(from + (to - from) * (k + 0.5) / many, 0, -depth);
    scatterers.push_back({received(plane, at, (to - from) / many * 1e-3, end, samples),
                          received(plane, at, (to - from) / many * 1e-3, -end, samples)});
  }
  constexpr int realisations = 4000;
  std::array<Complex, 3> cross{};
  std::array<double, 3> upper{}, lower{};
  for (int n = 0; n < realisations; ++n) {
    std::array<Complex, 3> y_upper{}, y_lower{};
    for (const One& s : scatterers) {
      const Complex field(gauss(random), gauss(random));
      for (const auto& [one, y] : {std::pair(&s.upper, &y_upper), {&s.lower, &y_lower}})
        if (one->sample >= 0)
          (*y)[std::size_t(one->sample)] +=
              field * std::polar(std::sqrt(one->energy), receiver_pair.wavenumber_rad_m * one->range);
    }
    for (std::size_t k = 0; k < 3; ++k) {
      cross[k] += y_upper[k] * std::conj(y_lower[k]) / double(realisations);
      upper[k] += std::norm(y_upper[k]) / realisations;
      lower[k] += std::norm(y_lower[k]) / realisations;
    }
  }
  for (std::size_t k = 0; k < 3; ++k) {
    const double spread = 4 / std::sqrt(double(realisations));
    EXPECT_NEAR(upper[k] / echo.upper_j[k], 1, spread + 0.02) << k;  // 0.02: a range bin has 30 scatterers
    EXPECT_NEAR(lower[k] / echo.lower_j[k], 1, spread + 0.02) << k;
    EXPECT_LT(std::abs(cross[k] - cross_of(echo, k)) / echo.upper_j[k], spread + 0.02) << k;
  }
}

/// A strip of seabed 10 m below, and a wall across the strip. The edge of the wall shadows the seabed
/// behind it. The upper receiver sees more of the seabed.
TEST(ReceiverPairEcho, WhatOneReceiverAloneSeesIsReceivedByItAlone) {
  constexpr double depth = 10, wall_x = 10, wall_top = -6, baseline = 1;
  const WorldGrid grid = WorldGrid::fitting(glm::dvec3(-50), glm::dvec3(50));
  FacetMesh mesh;
  const auto add = [&](glm::dvec3 a, glm::dvec3 b, glm::dvec3 c, glm::dvec3 d, std::uint16_t material) {
    const auto first = VertexId(mesh.vertices.size());
    for (const glm::dvec3 p : {a, b, c, d}) mesh.vertices.push_back(grid.snap(p));
    for (const auto& f : {std::array<VertexId, 3>{0, 1, 2}, {0, 2, 3}}) {
      mesh.facets.push_back({first + f[0], first + f[1], first + f[2]});
      mesh.material.push_back(material);
      mesh.component.push_back(0);
    }
  };
  add({2, -0.01, -depth}, {40, -0.01, -depth}, {40, 0.01, -depth}, {2, 0.01, -depth}, 0);
  add({wall_x, -5, -depth}, {wall_x, 5, -depth}, {wall_x, 5, wall_top}, {wall_x, -5, wall_top}, 1);
  const SceneTree tree(mesh);
  TubeSet tubes;
  tubes.apex = grid.snap(glm::dvec3(0));
  tubes.reach = 60 / grid.unit_m();
  append_tubes(tubes, {{0.1, 0.6, 1.1, 1.5},
                       {-0.05, 0.05},
                       glm::dmat3(glm::dvec3(1, 0, 0), glm::dvec3(0, 0, -1), glm::dvec3(0, 1, 0))});
  const ReceiverBaseline receiver_pair = receiver_pair_at(0.1, baseline, 20e3);
  const BeamPatterns patterns = patterns_of(receiver_pair);
  const ReceiverPairHistory history =
      trace_receiver_pair(mesh, tree, grid.unit_m(), {}, tubes, tubes, receiver_pair);
  const RangeSamples samples{12, 0.25, 60};
  const ReceiverPairEcho echo = echo_of(history, patterns, samples, mesh.material);
  VisibilityOptions doubles;  // no decision here is degenerate
  doubles.arithmetic = Arithmetic::plain_double;
  const ReceiverPairEcho plain =
      echo_of(trace_receiver_pair(mesh, tree, grid.unit_m(), doubles, tubes, tubes, receiver_pair), patterns,
              samples, mesh.material);
  for (std::size_t k = 0; k < echo.upper_j.size(); ++k) {
    EXPECT_NEAR(plain.upper_j[k], echo.upper_j[k], 1e-12 * echo.upper_j[k]) << k;
    EXPECT_NEAR(plain.lower_j[k], echo.lower_j[k], 1e-12 * echo.lower_j[k]) << k;
    EXPECT_LT(std::abs(cross_of(plain, k) - cross_of(echo, k)), 1e-12 * echo.upper_j[k] + 1e-20) << k;
  }

  const glm::dvec3 end = baseline / 2 * receiver_pair.axis;
  const auto sees = [&](glm::dvec3 apex, double x) {
    return x < wall_x || apex.z + (wall_x - apex.x) / (x - apex.x) * (-depth - apex.z) > wall_top;
  };
  const std::size_t count = std::size_t(samples.count);
  std::vector<double> upper(count), lower(count);
  std::vector<Complex> cross(count);
  constexpr int many = 200000;
  const FacetPlane plane{{0, 0, 1}, depth};
  for (int k = 0; k < many; ++k) {
    const glm::dvec3 at(2 + 38 * (k + 0.5) / many, 0, -depth);
    if (!sees(glm::dvec3(0), at.x)) continue;
    const double area = 38.0 / many * 0.02;
    const Reception u = received(plane, at, area, end, samples), l = received(plane, at, area, -end, samples);
    const bool by_upper = u.sample >= 0 && sees(end, at.x), by_lower = l.sample >= 0 && sees(-end, at.x);
    if (by_upper) upper[std::size_t(u.sample)] += u.energy;
    if (by_lower) lower[std::size_t(l.sample)] += l.energy;
    if (by_upper && by_lower && u.sample == l.sample)
      cross[std::size_t(u.sample)] +=
          std::polar(std::sqrt(u.energy * l.energy), receiver_pair.wavenumber_rad_m * (u.range - l.range));
  }
  std::size_t by_one = 0, dark = 0;
  for (std::size_t k = 0; k < count; ++k) {
    const double scale = 2e-5 * 1e-6 + 2e-4 * upper[k];
    EXPECT_NEAR(echo.upper_j[k], upper[k], scale) << k;
    EXPECT_NEAR(echo.lower_j[k], lower[k], scale) << k;
    EXPECT_LT(std::abs(cross_of(echo, k) - cross[k]), scale) << k;
    by_one += echo.upper_j[k] > 0 && echo.lower_j[k] == 0;
    dark += echo.upper_j[k] == 0 && echo.lower_j[k] == 0;
  }
  EXPECT_GE(by_one, 1u);  // the border of the shadow lies between the areas that the two receivers see
  EXPECT_GE(dark, 5u);
}

TEST(ReceiverPairEcho, RefusesWhatHasNoCommonFootprints) {
  const ReceiverBaseline receiver_pair = receiver_pair_at(0, 1.1, 250e3);
  EXPECT_THROW(echo_of({}, patterns_of(receiver_pair), {1, 1, 3}), std::invalid_argument);
}

}  // namespace
}  // namespace tubefoot
