// SPDX-License-Identifier: GPL-3.0-or-later
// Tests scattering models in each integrator: without and with patterns, with fast binning, by rays, and
// with a separate transmitter and receiver.
#include <gtest/gtest.h>

#include <boost/math/quadrature/gauss_kronrod.hpp>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>
#include <numeric>
#include <random>

#include "engine/echo/echo.hpp"
#include "engine/scattering/sediment.hpp"
#include "fixtures/geometry/plane_polygons.hpp"
#include "fixtures/world/histories.hpp"
#include "geometry/numbers/scalars.hpp"

namespace tubefoot {
namespace {

using boost::math::quadrature::gauss_kronrod;
using test::flat_seabed;
using test::piece_on;
using test::Polygon2;

constexpr double law_mu = 0.004;
using Law = std::shared_ptr<const ScatteringModel>;
using test::add_footprint;
using test::one_beam;
using test::total;

Law shared(ScatteringModel model) { return std::make_shared<const ScatteringModel>(std::move(model)); }
Law lambert_as_gsab() { return shared(ScatteringModel::gsab({.oblique = law_mu, .oblique_exponent = 2})); }
Law three_terms() { return shared(ScatteringModel::gsab({0.4, 4 * degree, 0.01, 1.7, 0.03, 22 * degree})); }
Law medium_sand() {
  return shared(
      ScatteringModel::table(sediment_grazing_deg, sediment_backscatter("medium sand", 20).strength_db));
}

History history_of(const FacetPlane& plane, const Polygon2& polygon) {
  History history;
  add_footprint(history, 0, 0, plane, {polygon});
  measure(history.footprints);
  return history;
}

/// A null model means Lambert's law with mu.
Echo echo_of(const History& history, const RangeSamples& samples, const Law& model, double absorption = 0,
             const BeamPatterns* patterns = nullptr, Binning binning = Binning::exact,
             double pattern_tolerance = 1e-11) {
  const std::vector<double> material_mu{law_mu};
  const std::vector<std::uint16_t> one_facet{0};
  const std::vector<std::uint32_t> beam_of_tube{0};
  const std::vector<Law> models{model};
  EchoModel echo_model{material_mu, one_facet, absorption, patterns, pattern_tolerance};
  echo_model.scattering = models;
  return integrate_echo(history, {1, beam_of_tube}, samples, echo_model, binning);
}

/// A tube between two vertical planes that meet below the apex, with straight near and far walls.
Polygon2 wedge(double dphi, double far) {
  return {{0, 0}, {far, 0}, {far * std::cos(dphi), far * std::sin(dphi)}};
}

/// Returns the energy of a fan of azimuth dphi from a seabed at distance h between two ranges. It uses
/// quadrature between the ranges at which the model changes.
double fan_by_quadrature(const ScatteringModel& model, double h, double dphi, double from, double to,
                         double absorption) {
  const double beta = 2 * absorption * std::numbers::ln10 / 10;
  std::vector<double> ends{std::max(from, h), to};
  for (const auto& piece : model.pieces())
    if (const double r = h / std::cos(piece.to); r > ends.front() && r < to) ends.push_back(r);
  std::sort(ends.begin(), ends.end());
  double sum = 0;
  for (std::size_t k = 0; k + 1 < ends.size(); ++k) {
    const auto rho = [&](double r) { return std::sqrt(std::max((r - h) * (r + h), 0.0)); };
    // Integrates over rho, in which nothing is singular at the foot point.
    sum += gauss_kronrod<double, 31>::integrate(
        [&](double x) {
          const double r = std::hypot(h, x);
          return dphi * x * model.cross_section(h / r, x / r) * std::pow(r, -4) * std::exp(-beta * r);
        },
        rho(ends[k]), rho(ends[k + 1]), 12, 1e-14);
  }
  return sum;
}

Directivity line(double size) {
  Directivity d;
  d.kind = Directivity::Kind::line;
  d.axis = glm::normalize(glm::dvec3(0.3, 1, 0.1));
  d.size = size;
  d.centre = 0.05;
  return d;
}

TEST(ScatteringEcho, GsabWithTheObliqueTermAloneIsLambertInEveryIntegrator) {
  const unsigned seed = 20260;
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> along(-15, 15), size(0.01, 8), distance(0.5, 12);
  const BeamPatterns patterns = one_beam(line(20), line(12));
  const Law model = lambert_as_gsab();
  for (int run = 0; run < 60; ++run) {
    const glm::dvec2 centre = run % 5 == 0 ? glm::dvec2(0) : glm::dvec2{along(random), along(random)};
    const History history = history_of(test::random_plane(random, distance(random)),
                                       test::random_convex(random, centre, size(random), size(random)));
    const RangeSamples samples{1, 0.37, 80};
    for (const double absorption : {0.0, 0.4}) {
      for (const Binning binning : {Binning::exact, Binning::spread, Binning::centroid}) {
        const Echo a = echo_of(history, samples, model, absorption, nullptr, binning),
                   b = echo_of(history, samples, nullptr, absorption, nullptr, binning);
        for (int k = 0; k < samples.count; ++k)
          ASSERT_NEAR(a.at(0, k), b.at(0, k), 1e-12 * b.at(0, k) + 1e-15 * total(b)) << run << ' ' << k;
      }
      const Echo a = echo_of(history, samples, model, absorption, &patterns),
                 b = echo_of(history, samples, nullptr, absorption, &patterns);
      for (int k = 0; k < samples.count; ++k)
        ASSERT_NEAR(a.at(0, k), b.at(0, k), 1e-12 * b.at(0, k) + 1e-15 * total(b)) << run << ' ' << k;
    }
  }
}

TEST(ScatteringEcho, WholePlaneOfAPowerOfTheSineInClosedForm) {
  // C (D / r)^p r^-4 over r dr dphi from D on: 2 pi C / ((2 + p) D^2).
  for (const double p : {0.0, 0.5, 1.0, 2.0, 3.7, 9.0})
    for (const double distance : {0.3, 10.0}) {
      const Law model = shared(ScatteringModel::gsab({.oblique = 0.02, .oblique_exponent = p}));
      const double far = 1e7 * distance;
      const History history =
          history_of(flat_seabed(distance), {{-far, -far}, {far, -far}, {far, far}, {-far, far}});
      const double expected = 2 * pi * 0.02 / ((2 + p) * distance * distance);
      EXPECT_NEAR(total(echo_of(history, {0, 2 * far, 1}, model)), expected, 1e-11 * expected) << p;
      EXPECT_NEAR(total(echo_of(history, {distance / 2, distance, 40}, model)),
                  expected * (1 - std::pow(40.5, -2 - p)), 1e-11 * expected)
          << p;
    }
}

TEST(ScatteringEcho, EverySampleOfAFanIsASingleIntegral) {
  const double h = 10, dphi = 1.5 * degree;
  const std::vector<Law> models{
      three_terms(), medium_sand(),
      shared(ScatteringModel::gsab({.specular = 1, .specular_width_rad = degree})),
      shared(ScatteringModel::gsab({.oblique = 0.1, .oblique_exponent = 0})),
      shared(ScatteringModel::table(std::vector{3.0, 50.0, 90.0}, std::vector{-50.0, -20.0, 3.0}))};
  const History history = history_of(flat_seabed(h), wedge(dphi, 300));
  for (std::size_t l = 0; l < models.size(); ++l)
    for (const auto& [samples, absorption] :
         {std::pair{RangeSamples{9.9, 0.25, 200}, 0.0}, {RangeSamples{5, 7, 12}, 0.1}}) {
      const Echo echo = echo_of(history, samples, models[l], absorption);
      for (int k = 0; k < samples.count; ++k) {
        const double from = samples.first_m + k * samples.step_m, to = from + samples.step_m;
        const double expected = to > h ? fan_by_quadrature(*models[l], h, dphi, from, to, absorption) : 0;
        ASSERT_NEAR(echo.at(0, k), expected, 2e-11 * expected + 1e-15 * total(echo))
            << "law " << l << ", sample " << k;
      }
    }
}

TEST(ScatteringEcho, LambertAsATableConvergesToLambert) {
  const History history = history_of(flat_seabed(8), wedge(0.3, 60));
  const RangeSamples samples{7.9, 0.5, 60};
  const double lambert = total(echo_of(history, samples, nullptr));
  double error[2];
  for (const int fine : {0, 1}) {
    std::vector<double> angle, level;
    for (double grazing = 4; grazing <= 90; grazing += fine ? 0.5 : 1) {
      angle.push_back(grazing);
      level.push_back(10 * std::log10(law_mu * std::pow(std::sin(grazing * degree), 2)));
    }
    error[fine] = std::abs(
        total(echo_of(history, samples, shared(ScatteringModel::table(angle, level)))) / lambert - 1);
  }
  EXPECT_LT(error[0], 1e-3);
  EXPECT_NEAR(error[0] / error[1], 4, 0.3);
}

/// Returns the change of the energy of each range bin when the outline of the polygon moves by `moved_m`.
/// It takes the model at the start of the bin, on a strip of that width along the whole outline.
std::vector<double> energy_of_a_moved_outline(const History& history, const RangeSamples& samples,
                                              const ScatteringModel& model, double absorption,
                                              double moved_m) {
  const std::vector<glm::dvec3>& corners = history.footprints.corners_m;
  const double h = history.footprints.footprints.front().plane_distance_m;
  double outline_m = 0;
  for (std::size_t k = 0; k < corners.size(); ++k)
    outline_m += glm::distance(corners[k], corners[(k + 1) % corners.size()]);
  std::vector<double> energy;
  for (int k = 0; k < samples.count; ++k) {
    const double r = std::max(h, samples.first_m + k * samples.step_m), sine = h / r;
    energy.push_back(outline_m * moved_m * model.cross_section(sine, std::sqrt((1 - sine) * (1 + sine))) *
                     std::pow(r, -4) * std::pow(10, -0.2 * absorption * r));
  }
  return energy;
}

TEST(ScatteringEcho, PatternsOfOneAgreeWithNoPatterns) {
  // Compares two integrators without common code: a boundary integral, and nodes over slabs. Corners
  // rounded at grazing angles limit the accuracy of both for slivers and for bins that a polygon hardly
  // reaches.
  const unsigned seed = 4711;
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> along(-20, 20), size(0.05, 8), distance(0.3, 12);
  const BeamPatterns patterns = one_beam({}, {});
  const std::vector<Law> models{three_terms(), medium_sand(),
                                shared(ScatteringModel::gsab({.oblique = 0.1, .oblique_exponent = 9}))};
  const double absorption = 0.05, rounded_m = 5e-13;
  for (int run = 0; run < 2000; ++run) {
    const glm::dvec2 centre = run % 4 == 0 ? glm::dvec2(0) : glm::dvec2{along(random), along(random)};
    const double a = size(random), b = size(random);
    const FacetPlane plane = test::random_plane(random, distance(random));
    const History history = history_of(plane, test::random_convex(random, centre, a, b));
    const RangeSamples samples{0.25, 0.8, 45};
    const Law& model = models[std::size_t(run) % models.size()];
    const Echo plain = echo_of(history, samples, model, absorption),
               weighed = echo_of(history, samples, model, absorption, &patterns, Binning::exact, 1e-12);
    const std::vector<double> moved =
        energy_of_a_moved_outline(history, samples, *model, absorption, rounded_m);
    for (int k = 0; k < samples.count; ++k)
      ASSERT_NEAR(weighed.at(0, k), plain.at(0, k), 2e-10 * plain.at(0, k) + moved[std::size_t(k)])
          << run << ' ' << k;
  }
}

TEST(ScatteringEcho, WithPatternsAPolygonIsABruteForceSum) {
  const FacetPlane plane{glm::normalize(glm::dvec3(0.2, -0.1, 1)), 6};
  const PlaneFrame frame(plane);
  const Polygon2 polygon{{-1, -2}, {5, -1}, {4, 3}, {0, 2}};
  const History history = history_of(plane, polygon);
  const BeamPatterns patterns = one_beam(line(4), line(3));
  for (const Law& model : {three_terms(), medium_sand()}) {
    // Midpoints of a fine grid are of second order, except at the corners of a table.
    constexpr int n = 1200;
    double sum = 0;
    for (int i = 0; i < n; ++i)
      for (int k = 0; k < n; ++k) {
        const glm::dvec2 p{-1 + 6 * (i + 0.5) / n, -2 + 5 * (k + 0.5) / n};
        bool inside = true;
        for (std::size_t e = 0; e < polygon.size(); ++e) {
          const glm::dvec2 a = polygon[e], b = polygon[(e + 1) % polygon.size()] - a;
          inside = inside && b.x * (p.y - a.y) - b.y * (p.x - a.x) > 0;
        }
        if (!inside) continue;
        const glm::dvec3 place = -plane.distance_m * plane.normal + p.x * frame.u + p.y * frame.v;
        const double r = glm::length(place);
        const glm::dvec3 d = place / r;
        sum += model->cross_section(std::asin(plane.distance_m / r)) * std::pow(r, -4) * line(4).gain(d) *
               line(3).gain(d) * 30 / n / n;
      }
    const double energy = total(echo_of(history, {5.9, 0.5, 20}, model, 0, &patterns));
    EXPECT_NEAR(energy, sum, 1e-3 * sum);
  }
}

TEST(ScatteringEcho, WholeFootprintsScatterByTheirCentroidsAngle) {
  const FacetPlane plane = flat_seabed(5);
  const History history = history_of(plane, {{2, 1}, {2.02, 1}, {2.02, 1.03}, {2, 1.03}});
  const Footprint& f = history.footprints.footprints.front();
  for (const Law& model : {three_terms(), medium_sand()}) {
    const double r = glm::length(f.centroid_m), sigma = model->cross_section(std::asin(5 / r));
    for (const Binning binning : {Binning::spread, Binning::centroid})
      EXPECT_NEAR(total(echo_of(history, {1, 1, 20}, model, 0, nullptr, binning)),
                  sigma * f.area_m2 * std::pow(r, -4), 1e-12 * sigma);
    EXPECT_NEAR(total(echo_of(history, {1, 1, 20}, model)), sigma * f.area_m2 * std::pow(r, -4),
                1e-8 * sigma);
  }
}

TEST(ScatteringEcho, RaysConvergeToTheTubes) {
  // Rays at the middles of equal solid angles, over a fan from straight below to 20 degrees above the
  // seabed.
  const double h = 4, dphi = 0.2, highest = std::sin(20 * degree);
  for (const Law& model : {three_terms(), medium_sand()}) {
    const double far = h / highest * std::cos(20 * degree);
    double error[2];
    for (const int fine : {0, 1}) {
      const int n = fine ? 40000 : 2500;
      History rays;
      for (int k = 0; k < n; ++k) {
        RayHit hit;
        hit.sine_grazing = 1 - (1 - highest) * (k + 0.5) / n;
        hit.slant_range_m = h / hit.sine_grazing;
        hit.solid_angle_sr = dphi * (1 - highest) / n;
        rays.hits.push_back(hit);
      }
      const double truth = fan_by_quadrature(*model, h, dphi, h, std::hypot(h, far), 0);
      error[fine] = std::abs(total(echo_of(rays, {3, 20, 1}, model)) / truth - 1);
    }
    EXPECT_LT(error[0], 1e-3);
    EXPECT_LT(error[1], error[0] / 30);
  }
}

// --- transmitter and separate receiver

Echo bistatic_echo(const BistaticHistory& history, const RangeSamples& samples, const Law& model,
                   double absorption = 0, const BeamPatterns* patterns = nullptr) {
  const std::vector<double> material_mu{law_mu};
  const std::vector<std::uint16_t> material{0};
  const std::vector<std::uint32_t> beam{0};
  const std::vector<Law> models{model};
  EchoModel echo_model{material_mu, material, absorption, patterns};
  echo_model.scattering = models;
  return integrate_echo(history, {1, beam}, samples, echo_model);
}

TEST(ScatteringBistatic, LambertAndOneApexAreWhatTheyWere) {
  const Polygon2 polygon{{-3, -2}, {6, -1}, {5, 4}, {0, 5}};
  const FacetPlane plane{glm::normalize(glm::dvec3(0.1, 0.2, 1)), 5};
  const RangeSamples samples{4, 0.4, 20};
  const BistaticHistory apart = piece_on(plane, polygon, {1.5, -0.7, 0.4});
  const Echo gsab = bistatic_echo(apart, samples, lambert_as_gsab(), 0.1),
             lambert = bistatic_echo(apart, samples, nullptr, 0.1);
  for (int k = 0; k < samples.count; ++k)
    EXPECT_NEAR(gsab.at(0, k), lambert.at(0, k), 1e-12 * lambert.at(0, k));
  const BistaticHistory together = piece_on(plane, polygon, {0, 0, 0});
  const History history = history_of(plane, polygon);
  const BeamPatterns patterns = one_beam(line(4), line(3));
  for (const auto& [model, tolerance] :
       {std::pair{three_terms(), 1e-9}, {medium_sand(), 1e-5}, {lambert_as_gsab(), 1e-9}})
    for (const BeamPatterns* p : {(const BeamPatterns*)nullptr, &patterns}) {
      const Echo two = bistatic_echo(together, samples, model, 0.1, p),
                 one = echo_of(history, samples, model, 0.1, p);
      for (int k = 0; k < samples.count; ++k)
        EXPECT_NEAR(two.at(0, k), one.at(0, k), tolerance * one.at(0, k) + tolerance * 1e-3 * total(one))
            << k;
    }
}

TEST(ScatteringBistatic, IsReciprocal) {
  const FacetPlane plane = flat_seabed(6);
  const glm::dvec3 receiver(2, 1, -1.5);
  const Polygon2 polygon{{-3, -2}, {6, -1}, {5, 4}, {0, 5}};
  const PlaneFrame frame(plane);
  const glm::dvec2 foot = frame.project(receiver);
  const FacetPlane other = flat_seabed(plane.distance_m + receiver.z);
  const BistaticHistory there = piece_on(plane, polygon, receiver),
                        back = piece_on(other, test::shifted(polygon, -foot), -receiver);
  const RangeSamples samples{5, 0.3, 25};
  for (const auto& [model, tolerance] : {std::pair{three_terms(), 1e-9}, {medium_sand(), 1e-5}}) {
    const Echo a = bistatic_echo(there, samples, model, 0.1), b = bistatic_echo(back, samples, model, 0.1);
    EXPECT_GT(total(a), 0);
    for (int k = 0; k < samples.count; ++k)
      EXPECT_NEAR(a.at(0, k), b.at(0, k), tolerance * a.at(0, k) + tolerance * 1e-3 * total(a)) << k;
  }
}

TEST(ScatteringBistatic, OneApexAboveTheOtherIsASingleIntegral) {
  const double h1 = 7, h2 = 4;
  const Polygon2 endless{{-1e4, -1e4}, {1e4, -1e4}, {1e4, 1e4}, {-1e4, 1e4}};
  for (const auto& [model, tolerance] : {std::pair{three_terms(), 1e-8}, {medium_sand(), 3e-5}}) {
    double expected = 0;
    for (int k = 0; k < 400; ++k) {  // rho from 0 to far out
      const auto rho = [](int i) { return i * 0.05 * std::exp(i * 0.012); };
      expected += gauss_kronrod<double, 31>::integrate(
          [&, &sand = model](double x) {
            const double r1 = std::hypot(h1, x), r2 = std::hypot(h2, x);
            return 2 * pi * x *
                   std::sqrt(sand->cross_section(h1 / r1, x / r1) * sand->cross_section(h2 / r2, x / r2)) /
                   (r1 * r1 * r2 * r2);
          },
          rho(k), rho(k + 1), 5, 1e-12);
    }
    const double energy =
        total(bistatic_echo(piece_on(flat_seabed(h1), endless, {0, 0, h2 - h1}), {5, 10, 140}, model));
    EXPECT_NEAR(energy, expected, tolerance * expected);
  }
}

TEST(ScatteringEcho, RefusesLawsThatDoNotFitTheMaterials) {
  const History history = history_of(flat_seabed(5), wedge(0.1, 20));
  const std::vector<double> material_mu{law_mu};
  const std::vector<std::uint16_t> one_facet{0};
  const std::vector<std::uint32_t> beam_of_tube{0};
  const std::vector<Law> models{three_terms(), nullptr};
  EchoModel model{material_mu, one_facet, 0};
  model.scattering = models;
  EXPECT_THROW(integrate_echo(history, {1, beam_of_tube}, {1, 1, 30}, model), std::invalid_argument);
  EXPECT_THROW(integrate_echo(piece_on(flat_seabed(5), wedge(0.1, 20), {0, 0, 1}), {1, beam_of_tube},
                              {1, 1, 30}, model),
               std::invalid_argument);
}

}  // namespace
}  // namespace tubefoot
