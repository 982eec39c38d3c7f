// SPDX-License-Identifier: GPL-3.0-or-later
// Tests integrals of beam patterns over arcs that the integrator adds by their end points. The comparison
// is quadrature without panels or arcs.
#include <gtest/gtest.h>

#include <boost/math/quadrature/gauss.hpp>
#include <boost/math/quadrature/gauss_kronrod.hpp>
#include <cmath>
#include <random>

#include "engine/echo/echo.hpp"
#include "engine/echo/gain_panels.hpp"
#include "engine/scattering/beam_pattern.hpp"
#include "fixtures/geometry/plane_polygons.hpp"
#include "fixtures/world/histories.hpp"

namespace tubefoot {
namespace {

using Kind = Directivity::Kind;

Directivity line_along_x(double length_over_wavelength, double steered_rad) {
  return {Kind::line, {1, 0, 0}, false, std::sin(steered_rad), length_over_wavelength};
}

TEST(DirectionSpans, AreIntegralsOverTheCosineAcrossPanelsAndBothWays) {
  using boost::math::quadrature::gauss_kronrod;
  const std::vector<Directivity> beams{line_along_x(40, -0.2), line_along_x(40, 0), line_along_x(40, 0.3)};
  const auto gains = std::make_shared<GainPanels>(
      beams.size(),
      [&](double cosine, std::span<double> values) {
        for (std::size_t b = 0; b < beams.size(); ++b) values[b] = beams[b].gain_at(cosine);
      },
      0.011, 1e-13);
  std::mt19937_64 random(31415);
  std::uniform_real_distribution<double> place(-0.95, 0.95), level(-3, 3), log_width(-9, -0.7);
  constexpr int spans = 200;
  constexpr std::size_t samples = 37;  // not a whole number of blocks
  for (int trial = 0; trial < spans; ++trial) {
    const double origin = place(random);
    const double width = std::exp(log_width(random)) * (trial % 2 == 0 ? 1 : -1);
    // Some arcs start on a border of panels.
    const double from = trial % 5 == 0 ? -1 + 0.5 * (trial % 4) : origin;
    std::vector<CosineSpan> alike;
    for (int k = 0; k < 3; ++k) {
      const double begin = std::clamp(from + 0.1 * k * width, -1.0, 1.0);
      alike.push_back(
          {begin, std::clamp(begin + width, -1.0, 1.0), {level(random), level(random), level(random)}});
    }
    DirectionMoments moments(gains);
    const auto sample = std::uint32_t(trial % int(samples));
    moments.begin(sample);
    moments.add(alike, origin);
    // A later call in another range bin does not reuse the values of an earlier call.
    const std::vector<double> node{0.1}, weight{2.0};
    moments.begin((sample + 1) % samples);
    moments.add(std::span<const double>(node), std::span<const double>(weight));
    std::vector<double> energy(beams.size() * samples, 0);
    moments.finish(0, samples, energy);
    for (std::size_t b = 0; b < beams.size(); ++b) {
      double expected = 0, size = 0;
      for (const CosineSpan& span : alike) {
        const auto density = [&](double w) {
          const double z = w - origin;
          return beams[b].gain_at(w) * (span.level[0] + z * (span.level[1] + z * span.level[2]));
        };
        const int parts = 1 + int(std::abs(width) * 100);
        for (int p = 0; p < parts; ++p) {
          const double lo = span.begin + (span.end - span.begin) * p / parts,
                       hi = span.begin + (span.end - span.begin) * (p + 1) / parts;
          const double sign = lo < hi ? 1 : -1;
          if (lo != hi)
            expected +=
                sign * gauss_kronrod<double, 61>::integrate(density, std::min(lo, hi), std::max(lo, hi), 0);
        }
        size += std::abs(span.end - span.begin) * 10;
      }
      ASSERT_NEAR(energy[b * samples + sample], expected, 1e-11 * size + 1e-15) << trial << " beam " << b;
      ASSERT_NEAR(energy[b * samples + (sample + 1) % samples], 2 * beams[b].gain_at(0.1), 1e-11);
      for (std::size_t k = 0; k < samples; ++k)
        if (k != sample && k != (sample + 1) % samples) {
          ASSERT_EQ(energy[b * samples + k], 0);
        }
    }
  }
}

/// Returns the energy of a small polygon without range limits, by triangles in space.
double over_space(const FacetPlane& plane, const test::Polygon2& p,
                  const std::function<double(glm::dvec3)>& gain) {
  using boost::math::quadrature::gauss;
  const std::vector<glm::dvec3> corners = test::on_plane(plane, p);
  double sum = 0;
  for (std::size_t t = 2; t < corners.size(); ++t) {
    const glm::dvec3 a = corners[0], b = corners[t - 1] - a, c = corners[t] - corners[t - 1];
    const auto density = [&](double x, double y) {
      const glm::dvec3 q = a + x * (b + y * c);
      const double r = glm::length(q), sine = glm::dot(plane.normal, q) / r;
      return sine * sine * std::pow(r, -4) * gain(q / r);
    };
    sum += glm::length(glm::cross(b, c)) *
           gauss<double, 40>::integrate(
               [&](double x) {
                 return x * gauss<double, 40>::integrate([&](double y) { return density(x, y); }, 0.0, 1.0);
               },
               0.0, 1.0);
  }
  return sum;
}

/// Compares footprints under the beams of a camera with their integrals in space. The footprints are
/// `thinness` times as wide as long.
void expect_integrals_in_space(double thinness, std::initializer_list<double> tolerances, double rounding) {
  std::mt19937_64 random(27182);
  std::uniform_real_distribution<double> across(-3, 3), ahead(-2, 9), size(0.01, 0.12), distance(0.3, 5);
  std::vector<Directivity> beams;
  for (int k = 0; k < 8; ++k) beams.push_back(line_along_x(123, 0.042 * k - 0.15));
  const TransmitPattern sent(beams);
  const BeamPatterns patterns{{sent}, beams, {0}, {{0, std::uint32_t(beams.size())}}};
  const std::vector<double> mu{1};
  const std::vector<std::uint16_t> material{0};
  const std::vector<std::uint32_t> beam_of_tube{0};
  for (int i = 0; i < 60; ++i) {
    const FacetPlane plane = test::random_plane(random, distance(random));
    const double a = size(random);
    const test::Polygon2 p = test::random_convex(random, {across(random), ahead(random)}, a, thinness * a);
    History history;
    test::add_footprint(history, 0, 0, plane, {p});
    const double all = over_space(plane, p, [](glm::dvec3) { return 1.0; });
    std::vector<double> direct;
    for (const Directivity& beam : beams)
      direct.push_back(over_space(plane, p, [&](glm::dvec3 d) { return sent.gain(d) * beam.gain(d); }));
    for (const double tolerance : tolerances) {
      const Echo echo = integrate_echo(history, {int(beams.size()), beam_of_tube}, {0.1, 0.01, 1500},
                                       EchoModel{mu, material, 0, &patterns, tolerance});
      for (int b = 0; b < echo.beams; ++b) {
        double sum = 0;
        for (int k = 0; k < echo.samples; ++k) sum += echo.at(b, k);
        ASSERT_NEAR(sum, direct[std::size_t(b)], (tolerance + rounding) * all) << i << " beam " << b;
      }
    }
  }
}

TEST(DirectionSpans, SmallFootprintsUnderACamerasBeamsAreTheirIntegralsInSpace) {
  expect_integrals_in_space(0.5, {1e-4, 1e-6, 1e-8}, 1e-11);
}

TEST(DirectionSpans, ThinFootprintsAreTooThoughTheirSidesAlmostCancel) {
  for (const double thinness : {0.02, 1e-3, 1e-4}) {
    SCOPED_TRACE(thinness);
    expect_integrals_in_space(thinness, {1e-4, 1e-6}, 1e-8);
  }
}

}  // namespace
}  // namespace tubefoot
