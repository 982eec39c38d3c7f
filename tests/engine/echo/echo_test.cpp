// SPDX-License-Identifier: GPL-3.0-or-later
// Tests echo integrals of the monostatic engine. The comparisons are printed values and closed forms of a
// flat Lambert seabed (physics sheet 7.5), quadrature in space, and sums over ray hits.

#include "engine/echo/echo.hpp"

#include <gtest/gtest.h>

#include <boost/math/quadrature/gauss_kronrod.hpp>
#include <boost/math/special_functions/expint.hpp>
#include <cmath>
#include <numeric>

#include "engine/scattering/radial_model.hpp"
#include "fixtures/geometry/plane_polygons.hpp"
#include "fixtures/world/histories.hpp"
#include "geometry/numbers/scalars.hpp"

namespace tubefoot {
namespace {

using test::add_footprint;
using test::flat_seabed;
using test::on_plane;
using test::Polygon2;
using test::total;

constexpr double slice = 1.5 * pi / 180;  // azimuth
constexpr double height = 10;
const double sand_mu = std::pow(10, -2.7);

double relative(double value, double expected) { return std::abs(value / expected - 1); }

/// Returns the energy of a fan of azimuth dphi from a flat Lambert seabed between two ranges (physics sheet
/// 7.5).
double closed_form(double dphi, double r1, double r2, double absorption_db_per_m) {
  const double beta = 2 * absorption_db_per_m * std::log(10.0) / 10;
  const auto antiderivative = [beta](double r) {
    return std::pow(r, -4) * (beta > 0 ? boost::math::expint(5, beta * r) : 0.25);
  };
  return sand_mu * height * height * dphi * (antiderivative(r1) - antiderivative(r2));
}

/// A tube between two vertical planes that meet below the apex, with straight near and far walls.
Polygon2 wedge(double dphi, double near, double far) {
  const glm::dvec2 a(1, 0), b(std::cos(dphi), std::sin(dphi));
  if (near == 0) return {{0, 0}, far * a, far * b};
  return {near * a, far * a, far * b, near * b};
}

const std::vector<std::uint16_t> one_facet{0};

Echo echo_of(const History& history, const RangeSamples& samples, double absorption_db_per_m = 0) {
  const std::vector<double> material_mu{sand_mu};
  const std::vector<std::uint32_t> beam_of_tube{0};
  return integrate_echo(history, {1, beam_of_tube}, samples,
                        EchoModel{material_mu, one_facet, absorption_db_per_m});
}

TEST(RadialModel, PrintedIntegralsFromTenToTwentyMetres) {
  const struct {
    double absorption_db_per_m, integral;
  } cases[] = {{0.0615, 1.650881e-5}, {0.42368, 2.243191e-6}};
  for (const auto& c : cases) {
    const auto radial = lambert_radial_integral({10, 10, 1}, c.absorption_db_per_m);
    double sum = 0;
    for (const auto& cell : radial->cells()) sum += RadialIntegral::within(cell, cell.lo, cell.hi - cell.lo);
    const double beta = 2 * c.absorption_db_per_m * std::log(10.0) / 10;
    const double exact = std::pow(10, -4) * boost::math::expint(5, 10 * beta) -
                         std::pow(20, -4) * boost::math::expint(5, 20 * beta);
    EXPECT_LT(relative(sum, exact), 1e-13);
    EXPECT_NEAR(sum, c.integral, 6e-7 * c.integral);
  }
}

TEST(FlatLambertSeabed, PrintedValuesOfOneSample) {
  History history;
  add_footprint(history, 0, 0, flat_seabed(height), {wedge(slice, 0, 60)});
  const RangeSamples samples{20, 0.05, 1};
  EXPECT_LT(relative(echo_of(history, samples).at(0, 0), 8.111093200e-11), 1e-9);
  EXPECT_NEAR(10 * std::log10(echo_of(history, samples).at(0, 0)), -100.909206, 1e-6);
  EXPECT_LT(relative(echo_of(history, samples, 0.0615).at(0, 0), 4.600156e-11), 2e-7);
  EXPECT_LT(relative(echo_of(history, samples, 0.42368).at(0, 0), 1.630223e-12), 4e-7);
}

TEST(FlatLambertSeabed, EverySampleIsTheClosedForm) {
  for (const double absorption : {0.0, 0.0615, 0.42368})
    for (const double step : {0.003, 0.02, 1.0, 10.0}) {
      History history;
      add_footprint(history, 0, 0, flat_seabed(height), {wedge(slice, 0, 60)});
      const RangeSamples samples{10, step, int(40 / step)};
      const Echo echo = echo_of(history, samples, absorption);
      for (int k = 0; k < samples.count; ++k)
        ASSERT_LT(relative(echo.at(0, k), closed_form(slice, 10 + k * step, 10 + (k + 1) * step, absorption)),
                  1e-10)
            << "sample " << k << " of " << step << " m, absorption " << absorption;
    }
}

TEST(FlatLambertSeabed, SampleAcrossTheFirstReturn) {
  History history;
  add_footprint(history, 0, 0, flat_seabed(height), {wedge(slice, 0, 60)});
  const Echo echo = echo_of(history, {9.9, 0.08, 4}, 0.0615);
  EXPECT_EQ(echo.at(0, 0), 0);
  EXPECT_LT(relative(echo.at(0, 1), closed_form(slice, height, 9.9 + 2 * 0.08, 0.0615)), 1e-10);
  EXPECT_LT(relative(echo.at(0, 2), closed_form(slice, 9.9 + 2 * 0.08, 9.9 + 3 * 0.08, 0.0615)), 1e-10);
}

TEST(FlatLambertSeabed, SamplesBeginAtTheApex) {
  History history;
  add_footprint(history, 0, 0, flat_seabed(height), {wedge(slice, 0, 60)});
  const Echo echo = echo_of(history, {0, 1, 40}, 0.0615);
  for (int k = 0; k < 40; ++k)
    if (k < 10)
      EXPECT_EQ(echo.at(0, k), 0);
    else
      EXPECT_LT(relative(echo.at(0, k), closed_form(slice, k, k + 1, 0.0615)), 1e-10);
}

TEST(FlatLambertSeabed, WholePlaneWithTheFootInside) {
  Polygon2 disc;
  for (int i = 0; i < 7; ++i)
    disc.push_back(1e6 * glm::dvec2(std::cos(2 * pi * i / 7), std::sin(2 * pi * i / 7)));
  History history;
  add_footprint(history, 0, 0, flat_seabed(height), {disc});
  const Echo rings = echo_of(history, {9.95, 0.1, 1000});
  EXPECT_LT(relative(rings.at(0, 0), closed_form(2 * pi, 10, 9.95 + 0.1, 0)), 1e-10);
  for (int k = 1; k < 1000; ++k)
    ASSERT_LT(relative(rings.at(0, k), closed_form(2 * pi, 9.95 + k * 0.1, 9.95 + (k + 1) * 0.1, 0)), 1e-10);
  EXPECT_LT(relative(total(echo_of(history, {0, 2e6, 1})), 3.134150715e-5), 1e-9);
}

TEST(FlatLambertSeabed, TubesOfAFanAddUpWhateverTheirWalls) {
  // Adjacent tubes share straight walls that are not range rings. Together the tubes form the wedge.
  History whole, parts;
  add_footprint(whole, 0, 0, flat_seabed(height), {wedge(slice, 5, 60)});
  double near = 5;
  for (const double far : {7.0, 11.0, 20.0, 21.0, 60.0}) {
    add_footprint(parts, 0, 0, flat_seabed(height), {wedge(slice, near, far)});
    near = far;
  }
  const RangeSamples samples{10, 0.05, 1200};
  const Echo a = echo_of(whole, samples, 0.0615), b = echo_of(parts, samples, 0.0615);
  for (int k = 0; k < samples.count; ++k) ASSERT_NEAR(a.at(0, k), b.at(0, k), 1e-13 * total(a));
}

TEST(Echo, TiltedFacetsAgreeWithQuadratureOverTheirArea) {
  const unsigned seed = 271828;
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> place(-12, 12), distance(0.5, 8);
  using boost::math::quadrature::gauss_kronrod;
  const double absorption = 0.2, beta = 2 * absorption * std::log(10.0) / 10;
  for (int i = 0; i < 40; ++i) {
    const FacetPlane plane = test::random_plane(random, distance(random));
    const Polygon2 p = test::random_convex(random, {place(random), place(random)}, 4, 2);
    // Independent quadrature in space: mu sin^2 / r^4 with the sine from the normal.
    const auto corners = on_plane(plane, p);
    double expected = 0;
    for (std::size_t t = 2; t < p.size(); ++t) {
      const glm::dvec3 a = corners[0], b = corners[t - 1] - a, c = corners[t] - corners[t - 1];
      const double jacobian = glm::length(glm::cross(b, c));
      const auto density = [&](double x, double y) {
        const glm::dvec3 q = a + x * (b + y * c);
        const double r = glm::length(q), sine = std::abs(glm::dot(plane.normal, q)) / r;
        return sand_mu * sine * sine * std::pow(r, -4) * std::exp(-beta * r);
      };
      const auto line = [&](double x) {
        return x * gauss_kronrod<double, 31>::integrate([&](double y) { return density(x, y); }, 0.0, 1.0, 5,
                                                        1e-11);
      };
      expected += jacobian * gauss_kronrod<double, 31>::integrate(line, 0.0, 1.0, 5, 1e-11);
    }
    History history;
    add_footprint(history, 0, 0, plane, {p});
    EXPECT_LT(relative(total(echo_of(history, {0, 0.04, 1000}, absorption)), expected), 1e-10) << i;
  }
}

TEST(Echo, TubesGoToTheirBeamsAndFacetsHaveTheirMaterials) {
  History history;
  add_footprint(history, 0, 0, flat_seabed(height), {wedge(slice, 5, 60)});
  add_footprint(history, 1, 1, flat_seabed(height), {wedge(slice, 5, 60)});
  add_footprint(history, 2, 0, flat_seabed(height), {wedge(slice, 5, 60)});
  const std::vector<double> material_mu{0.001, 0.003};
  const std::vector<std::uint16_t> material{1, 0};
  const std::vector<std::uint32_t> beam_of_tube{2, 0, 2};
  const Echo echo = integrate_echo(history, {3, beam_of_tube}, {20, 1, 4}, {material_mu, material, 0});
  ASSERT_EQ(echo.energy.size(), 12u);
  for (int k = 0; k < 4; ++k) {
    EXPECT_GT(echo.at(0, k), 0);
    EXPECT_EQ(echo.at(1, k), 0);
    EXPECT_NEAR(echo.at(2, k) / echo.at(0, k), 6, 1e-14);
  }
}

TEST(Echo, RayHitsCountWithTheirSolidAngle) {
  History history;
  history.hits = {{0, 0, 20.5, 0.5, 1e-4}, {0, 0, 21, 0.5, 1e-4}, {0, 0, 19.99, 1, 1}, {0, 0, 24, 1, 1}};
  const Echo echo = echo_of(history, {20, 1, 4}, 0.1);
  EXPECT_LT(relative(echo.at(0, 0), sand_mu * 0.5 * 1e-4 / (20.5 * 20.5) * std::pow(10, -0.2 * 20.5 / 10)),
            1e-14);
  EXPECT_LT(relative(echo.at(0, 1), sand_mu * 0.5 * 1e-4 / (21 * 21) * std::pow(10, -0.2 * 21 / 10)), 1e-14);
  EXPECT_EQ(echo.at(0, 2), 0);
  EXPECT_EQ(echo.at(0, 3), 0);
}

TEST(Echo, HitsOnABorderFallWhereFootprintsAreCut) {
  const RangeSamples samples{0.7, 0.1, 500};  // only the first few bin borders are multiples of the step
  const std::vector<double> borders = sample_borders_m(samples);
  for (int k = 0; k < samples.count; ++k) {
    History history;
    history.hits = {{0, 0, borders[k], 0.5, 1}, {0, 0, std::nextafter(borders[k + 1], 0), 0.5, 1}};
    const Echo echo = echo_of(history, samples, 0);
    for (int other = 0; other < samples.count; ++other)
      ASSERT_EQ(echo.at(0, other) > 0, other == k) << "sample " << k;
  }
}

TEST(Echo, ANarrowTubeAndAHitOfItsSolidAngleAgree) {
  // E = mu H dOmega / R^3 for a narrow beam on a flat seabed (physics sheet 7.5).
  const double r = 20, w = 1e-3, surface_mesh = std::sqrt(r * r - height * height);
  const Polygon2 small{
      {surface_mesh - w, -w}, {surface_mesh + w, -w}, {surface_mesh + w, w}, {surface_mesh - w, w}};
  History tube, ray;
  add_footprint(tube, 0, 0, flat_seabed(height), {small});
  measure(tube.footprints);
  const Footprint& footprint = tube.footprints.footprints[0];
  ray.hits = {{0, 0, r, std::sin(footprint.grazing_angle_rad), footprint.solid_angle_sr}};
  const double a = echo_of(tube, {19, 2, 1}, 0.1).at(0, 0), b = echo_of(ray, {19, 2, 1}, 0.1).at(0, 0);
  EXPECT_LT(relative(a, b), 1e-6);
  EXPECT_LT(relative(b, sand_mu * height * footprint.solid_angle_sr / (r * r * r) * std::pow(10, -0.4)),
            1e-6);
}

TEST(Echo, BadInputIsRefused) {
  History history;
  add_footprint(history, 1, 0, flat_seabed(height), {wedge(slice, 5, 60)});
  const std::vector<double> material_mu{0.001};
  const std::vector<std::uint32_t> beams{0, 0}, too_few{0}, too_far{0, 7};
  const EchoModel model{material_mu, one_facet, 0};
  const RangeSamples samples{20, 1, 4};
  EXPECT_NO_THROW(integrate_echo(history, {1, beams}, samples, model));
  EXPECT_THROW(integrate_echo(history, {1, too_few}, samples, model), std::invalid_argument);
  EXPECT_THROW(integrate_echo(history, {1, too_far}, samples, model), std::invalid_argument);
  EXPECT_THROW(integrate_echo(history, {-1, beams}, samples, model), std::invalid_argument);
  EXPECT_THROW(integrate_echo(history, {1, beams}, {20, 1, 0}, model), std::invalid_argument);
  EXPECT_THROW(integrate_echo(history, {1, beams}, {20, 0, 3}, model), std::invalid_argument);
  EXPECT_THROW(integrate_echo(history, {1, beams}, {-20, 1, 3}, model), std::invalid_argument);
  EXPECT_THROW(integrate_echo(history, {1, beams}, {20, std::nan(""), 3}, model), std::invalid_argument);
  EXPECT_THROW(integrate_echo(history, {1, beams}, samples, {material_mu, one_facet, -1}),
               std::invalid_argument);
  EXPECT_THROW(integrate_echo(history, {1, beams}, samples, {material_mu, one_facet, std::nan("")}),
               std::invalid_argument);
  EXPECT_THROW(integrate_echo(history, {1, beams}, samples, {material_mu, {}, 0}), std::invalid_argument);
  EXPECT_THROW(integrate_echo(history, {1, beams}, samples, {{}, one_facet, 0}), std::invalid_argument);
}

}  // namespace
}  // namespace tubefoot
