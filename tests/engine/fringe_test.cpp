// SPDX-License-Identifier: GPL-3.0-or-later
// Two receivers on a staff: products of their signals against true distances in space and against closed
// forms.
#include <gtest/gtest.h>

#include <boost/math/quadrature/gauss_kronrod.hpp>
#include <cmath>
#include <complex>
#include <numbers>
#include <random>

#include "engine/echo.hpp"
#include "geometry/plane_polygons.hpp"

namespace tubefoot {
namespace {

using test::on_plane;
using test::Polygon2;
using Complex = std::complex<double>;

constexpr double pi = std::numbers::pi;
constexpr double mu = 0.003;

void add_footprint(History& history, const FacetPlane& plane, const Polygon2& polygon) {
  FootprintSet& set = history.footprints;
  Footprint footprint;
  footprint.plane_normal = plane.normal;
  footprint.plane_distance_m = plane.distance_m;
  footprint.first_piece = std::uint32_t(set.pieces.size());
  footprint.piece_count = 1;
  set.pieces.push_back({std::uint32_t(set.corners_m.size()), std::uint32_t(polygon.size())});
  for (const glm::dvec3& corner : on_plane(plane, polygon)) set.corners_m.push_back(corner);
  set.footprints.push_back(footprint);
}

Echo echo_of(const History& history, const RangeSamples& samples, const BeamPatterns& patterns,
             Binning binning = Binning::exact) {
  const std::vector<double> material_mu{mu};
  const std::vector<std::uint16_t> one_facet{0};
  const std::vector<std::uint32_t> beam_of_tube{0};
  return integrate_echo(history, beam_of_tube, 1, samples,
                        EchoLaw{material_mu, one_facet, 0, &patterns, 1e-11}, binning);
}

BeamPatterns one_beam(const Fringe& fringe, const Directivity& transmit = {},
                      const Directivity& receive = {}) {
  return {{transmit}, {receive}, {0}, {{0, 1}}, {fringe}};
}

Complex cross_of(const Echo& echo, int sample) {
  const auto k = std::size_t(sample), n = std::size_t(echo.samples);
  return {echo.energy.at(n + k), echo.energy.at(2 * n + k)};
}

glm::dvec3 random_unit(std::mt19937_64& random) {
  std::normal_distribution<double> gauss;
  return glm::normalize(glm::dvec3(gauss(random), gauss(random), gauss(random)));
}

TEST(Fringe, PathDifferenceIsThatOfTheTrueWays) {
  const unsigned seed = 8128;
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> range(0.5, 200), share(0, 1);
  for (int i = 0; i < 1000; ++i) {
    Fringe fringe{random_unit(random), 0, 1};
    const double r = range(random);
    fringe.baseline_m = r * std::pow(share(random), 4);
    const glm::dvec3 p = r * random_unit(random), upper = fringe.baseline_m / 2 * fringe.axis;
    const double expected = glm::distance(p, upper) - glm::distance(p, -upper);
    EXPECT_NEAR(fringe.path_difference(r, glm::dot(p, fringe.axis) / r), expected,
                4e-16 * r + 1e-13 * fringe.baseline_m);
  }
  // The lower receiver is nearer to what lies below.
  EXPECT_GT((Fringe{{0, 0, 1}, 0.1, 1}.path_difference(10, -0.5)), 0);
}

/// Energy, and energy times the product of the receivers' signals, triangle by triangle in space.
std::pair<double, Complex> quadrature(const FacetPlane& plane, const Polygon2& p, const Fringe& fringe,
                                      const std::function<double(glm::dvec3)>& gain) {
  using boost::math::quadrature::gauss_kronrod;
  const glm::dvec3 upper = fringe.baseline_m / 2 * fringe.axis;
  const auto corners = on_plane(plane, p);
  std::array<double, 3> sums{};
  for (std::size_t t = 2; t < p.size(); ++t) {
    const glm::dvec3 a = corners[0], b = corners[t - 1] - a, c = corners[t] - corners[t - 1];
    for (std::size_t part = 0; part < 3; ++part) {
      const auto density = [&](double x, double y) {
        const glm::dvec3 q = a + x * (b + y * c);
        const double r = glm::length(q), sine = std::abs(glm::dot(plane.normal, q)) / r;
        const double phase = fringe.wavenumber_rad_m * (glm::distance(q, upper) - glm::distance(q, -upper));
        return mu * sine * sine * std::pow(r, -4) * gain(q / r) *
               (part == 0   ? 1
                : part == 1 ? std::cos(phase)
                            : std::sin(phase));
      };
      const auto row = [&](double x) {
        return x * gauss_kronrod<double, 31>::integrate([&](double y) { return density(x, y); }, 0.0, 1.0, 6,
                                                        1e-12);
      };
      sums[part] +=
          glm::length(glm::cross(b, c)) * gauss_kronrod<double, 31>::integrate(row, 0.0, 1.0, 6, 1e-12);
    }
  }
  return {sums[0], {sums[1], sums[2]}};
}

TEST(Fringe, ProductsAgreeWithQuadratureInSpace) {
  const unsigned seed = 161803;
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> place(-5, 5), distance(1, 6), baseline(0, 0.9), waves(0.3, 6);
  using Kind = Directivity::Kind;
  for (int i = 0; i < 12; ++i) {
    Fringe fringe{random_unit(random), baseline(random), 0};
    fringe.wavenumber_rad_m = 2 * pi * waves(random);
    Directivity transmit, receive;
    if (i % 3 > 0) transmit = {Kind::gaussian, random_unit(random), true, 0, 0.9};
    if (i % 3 > 1) receive = {Kind::line, random_unit(random), false, 0.1, 3};
    const FacetPlane plane = test::random_plane(random, distance(random));
    // Every fourth polygon lies about the foot point, so that whole circles are in it.
    const glm::dvec2 centre = i % 4 ? glm::dvec2(place(random), place(random)) : glm::dvec2(0.2, -0.1);
    const Polygon2 p = test::random_convex(random, centre, 2.5, 1.5);
    History history;
    add_footprint(history, plane, p);
    const Echo echo = echo_of(history, {0.95, 0.11, 200}, one_beam(fringe, transmit, receive));
    double energy = 0;
    Complex cross = 0;
    for (int k = 0; k < 200; ++k) {
      energy += echo.at(0, k);
      cross += cross_of(echo, k);
      EXPECT_LE(std::abs(cross_of(echo, k)), echo.at(0, k) * (1 + 1e-9));
    }
    const auto [all, product] =
        quadrature(plane, p, fringe, [&](glm::dvec3 d) { return transmit.gain(d) * receive.gain(d); });
    const double peak = quadrature(plane, p, fringe, [](glm::dvec3) { return 1.0; }).first;
    EXPECT_NEAR(energy, all, 1e-9 * peak) << i;
    EXPECT_LT(std::abs(cross - product), 1e-9 * peak) << i << ": " << cross << " " << product;
  }
}

/// A strip, 2 mm wide along the track, of a plane below that rises by `slope` to starboard (x).
struct Slope {
  double depth = 8, slope = 0.2;
  History history;

  Slope() {
    const FacetPlane plane{glm::normalize(glm::dvec3(-slope, 0, 1)), depth / std::hypot(1, slope)};
    const PlaneFrame frame(plane);
    const auto on = [&](double x, double y) { return frame.project({x, y, -depth + slope * x}); };
    Polygon2 strip{on(2, -0.001), on(2, 0.001), on(25, 0.001), on(25, -0.001)};
    double turn = 0;
    for (std::size_t i = 0; i < 4; ++i)
      turn += strip[i].x * strip[(i + 1) % 4].y - strip[i].y * strip[(i + 1) % 4].x;
    if (turn < 0) std::reverse(strip.begin(), strip.end());
    add_footprint(history, plane, strip);
  }
  /// Angle of arrival below the horizontal.
  double angle(double range) const {
    const double tilt = std::atan(slope);
    return std::asin(depth * std::cos(tilt) / range) - tilt;
  }
};

Fringe staff(double tilt_rad, double baseline_m, double wavelength_m) {
  return {{std::sin(tilt_rad), 0, std::cos(tilt_rad)}, baseline_m, 2 * pi / wavelength_m};
}

TEST(Fringe, PhaseOfATiltedPlaneFollowsTheAngleOfArrival) {
  const Slope bed;
  const double tilt = 0.4, baseline = 0.03, wavelength = 0.006, step = 0.01;
  const Echo echo = echo_of(bed.history, {9, step, 1200}, one_beam(staff(tilt, baseline, wavelength)));
  for (int k = 0; k < 1200; ++k) {
    const double range = 9 + (k + 0.5) * step;
    const auto phase = [&](double r) {
      return 2 * pi * baseline / wavelength * std::sin(bed.angle(r) - tilt);
    };
    const double spread = std::abs(phase(range + step / 2) - phase(range - step / 2));
    // The plane wave's law is off by the baseline over the range squared, an eighth of it.
    const double near = 2 * pi / wavelength * baseline * std::pow(baseline / range, 2) / 8;
    const double error = std::remainder(std::arg(cross_of(echo, k)) - phase(range), 2 * pi);
    ASSERT_LT(std::abs(error), 0.02 * spread + near + 1e-6) << k;
    ASSERT_GT(std::abs(cross_of(echo, k)), 0.999 * echo.at(0, k)) << k;
  }
}

TEST(Fringe, CoherenceOfASampleIsTheSincOfItsPhaseSpread) {
  const Slope bed;
  const double range = 14, tilt = 0.4, wavelength = 0.003;
  for (const double baseline : {0.02, 0.1, 0.2, 0.35})
    for (const double step : {0.05, 0.1, 0.2}) {
      const Echo echo =
          echo_of(bed.history, {range - step / 2, step, 1}, one_beam(staff(tilt, baseline, wavelength)));
      const auto phase = [&](double r) {
        return 2 * pi * baseline / wavelength * std::sin(bed.angle(r) - tilt);
      };
      const double half = std::abs(phase(range + step / 2) - phase(range - step / 2)) / 2;
      // Energy and phase are nearly even over the sample: to a few times its length over the range.
      EXPECT_NEAR(std::abs(cross_of(echo, 0)) / echo.at(0, 0), std::abs(std::sin(half) / half),
                  6 * step / range)
          << baseline << " m, " << step << " m, half spread " << half;
    }
}

TEST(Fringe, SwappedReceiversConjugateAndNoBaselineIsOneReceiver) {
  const Slope bed;
  const RangeSamples samples{9, 0.5, 20};
  Fringe fringe = staff(0.4, 0.1, 0.006);
  const Echo one = echo_of(bed.history, samples, one_beam(fringe));
  fringe.axis = -fringe.axis;
  const Echo other = echo_of(bed.history, samples, one_beam(fringe));
  fringe.baseline_m = 0;
  const Echo none = echo_of(bed.history, samples, one_beam(fringe));
  double most = 0;
  for (int k = 0; k < samples.count; ++k) {
    ASSERT_GT(one.at(0, k), 0);
    EXPECT_LT(std::abs(cross_of(one, k) - std::conj(cross_of(other, k))), 1e-12 * one.at(0, k));
    most = std::max(most, std::abs(cross_of(one, k).imag()) / one.at(0, k));
    EXPECT_DOUBLE_EQ(cross_of(none, k).real(), none.at(0, k));
    EXPECT_EQ(cross_of(none, k).imag(), 0);
  }
  EXPECT_GT(most, 0.01);
}

TEST(Fringe, RaysAndCentroidsHaveThePhaseOfTheirPlace) {
  const Fringe fringe = staff(0.3, 0.2, 0.01);
  const glm::dvec3 d = glm::normalize(glm::dvec3(2, 0.1, -1));
  History rays;
  rays.hits.push_back({0, 0, 7.25, 0.5, 1e-3, glm::vec3(d)});
  const double direct =
      2 * pi / 0.01 *
      (glm::distance(7.25 * d, 0.1 * fringe.axis) - glm::distance(7.25 * d, -0.1 * fringe.axis));
  const Echo echo = echo_of(rays, {7, 0.5, 1}, one_beam(fringe));
  EXPECT_GT(echo.at(0, 0), 0);
  EXPECT_LT(std::abs(cross_of(echo, 0) / echo.at(0, 0) - std::polar(1.0, direct)), 1e-4);  // float direction

  Slope bed;
  measure(bed.history.footprints);
  const glm::dvec3 c = bed.history.footprints.footprints[0].centroid_m;
  const double expected =
      2 * pi / 0.01 * (glm::distance(c, 0.1 * fringe.axis) - glm::distance(c, -0.1 * fringe.axis));
  const Echo binned = echo_of(bed.history, {1, 30, 1}, one_beam(fringe), Binning::centroid);
  EXPECT_LT(std::abs(cross_of(binned, 0) / binned.at(0, 0) - std::polar(1.0, expected)), 1e-9);
}

TEST(Fringe, RefusesABaselineLongerThanTheNearestRange) {
  EXPECT_THROW(echo_of({}, {1, 1, 3}, one_beam(staff(0, 1.1, 0.01))), std::invalid_argument);
  BeamPatterns two = one_beam(staff(0, 0.1, 0.01));
  two.fringes.push_back(two.fringes[0]);
  EXPECT_THROW(echo_of({}, {1, 1, 3}, two), std::invalid_argument);
}

}  // namespace
}  // namespace tubefoot
