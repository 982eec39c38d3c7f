// SPDX-License-Identifier: GPL-3.0-or-later
// Tests echoes of seabeds with micro-texture. The comparison is quadrature without knowledge of the cells,
// slabs and arcs of the integrator.
#include <gtest/gtest.h>

#include <boost/math/quadrature/gauss.hpp>
#include <cmath>
#include <functional>
#include <numeric>
#include <random>

#include "engine/echo/echo.hpp"
#include "engine/echo/receiver_pair_echo.hpp"
#include "engine/scattering/layered_reflectivity.hpp"
#include "fixtures/geometry/plane_polygons.hpp"
#include "fixtures/world/histories.hpp"
#include "fixtures/world/textures.hpp"
#include "geometry/numbers/scalars.hpp"

namespace tubefoot {
namespace {

using test::add_footprint;
using test::Field;
using test::flat_seabed;
using test::line;
using test::map_askew;
using test::on_plane;
using test::perlin;
using test::Polygon2;
using test::rectangle;
using test::total;

constexpr double texture_mu = 0.002;
const glm::dvec3 apex{123.456, -78.9, 4.2};

History history_of(const FacetPlane& plane, const std::vector<Polygon2>& polygons) {
  History history;
  for (const Polygon2& polygon : polygons)
    add_footprint(history, std::uint32_t(history.footprints.footprints.size()), 0, plane, {polygon});
  measure(history.footprints);
  return history;
}

struct Settings {
  RangeSamples samples{0, 0.1, 300};
  double absorption_db_per_m = 0.2;
  const BeamPatterns* patterns = nullptr;
  double tolerance = 1e-6;
  Binning binning = Binning::exact;
  glm::dvec3 apex_m = apex;
};

/// All footprints go to beam 0 where there are no patterns.
Echo echo_of(const History& history, const Field& texture, const Settings& s = {}) {
  const std::vector<double> material_mu{texture_mu};
  const std::vector<std::uint16_t> material{0};
  const std::vector<std::uint32_t> beam_of_tube(history.footprints.footprints.size() + history.hits.size(),
                                                0);
  const std::vector<Field> reflectivity{texture};
  const int beams = s.patterns != nullptr ? int(s.patterns->receive.size()) : 1;
  return integrate_echo(history, {beams, beam_of_tube}, s.samples,
                        EchoModel{material_mu, material, s.absorption_db_per_m, s.patterns, s.tolerance,
                                  reflectivity, Path{Leg{s.apex_m}}},
                        s.binning);
}

double even_density(const FacetPlane& plane, double r, double absorption_db_per_m) {
  const double beta = 2 * absorption_db_per_m * std::log(10.0) / 10;
  return texture_mu * plane.distance_m * plane.distance_m * std::pow(r, -6) * std::exp(-beta * r);
}

/// Integrates over a rectangle by a rule of 4 nodes on each of many small panels, independent of texture
/// cells.
double panels(glm::dvec2 lo, glm::dvec2 hi, int nx, int ny,
              const std::function<double(double x, double y)>& density) {
  using Rule = boost::math::quadrature::gauss<double, 4>;
  std::vector<std::pair<double, double>> rule;
  for (std::size_t i = 0; i < 2; ++i)
    for (const double side : {-1.0, 1.0}) rule.emplace_back(side * Rule::abscissa()[i], Rule::weights()[i]);
  const glm::dvec2 half = (hi - lo) / (2.0 * glm::dvec2(nx, ny));
  double sum = 0;
  for (int i = 0; i < nx; ++i)
    for (const auto& [u, weight] : rule) {
      const double x = lo.x + half.x * (2 * i + 1 + u);
      double row = 0;
      for (int j = 0; j < ny; ++j)
        for (const auto& [v, w] : rule) row += w * density(x, lo.y + half.y * (2 * j + 1 + v));
      sum += weight * row;
    }
  return sum * half.x * half.y;
}

/// Returns the energy of a rectangle on a plane.
double quadrature(const FacetPlane& plane, glm::dvec2 lo, glm::dvec2 hi,
                  const std::function<double(glm::dvec3 from_apex)>& factor, int n = 64) {
  const PlaneFrame frame(plane);
  return panels(lo, hi, n, n, [&](double x, double y) {
    const glm::dvec3 p = -plane.distance_m * plane.normal + x * frame.u + y * frame.v;
    return even_density(plane, glm::length(p), 0.2) * factor(p);
  });
}

std::vector<std::pair<std::string, Field>> textures() {
  const Field layers = std::make_shared<LayeredReflectivity>(
      std::vector{perlin(0.9, 1, 0.5, 2), perlin(0.7, 1, 0.25, 3), map_askew()});
  return {{"one octave", perlin(0.5)},
          {"wide", perlin(20, 1, 0.9, 7)},
          {"fine", perlin(0.13, 1, 0.25, 3)},
          {"octaves", perlin(1.0, 3)},
          {"map", map_askew()},
          {"layers", layers}};
}

TEST(MicroTexture, RectanglesAgreeWithBruteForce) {
  const unsigned seed = 20261;
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> place(-5, 5), size(0.1, 1.2), distance(0.5, 6);
  for (const auto& [name, texture] : textures())
    for (int i = 0; i < 4; ++i) {
      const FacetPlane plane = i == 0 ? flat_seabed(4) : test::random_plane(random, distance(random));
      // The second rectangle contains the foot point.
      const glm::dvec2 lo = i == 1 ? glm::dvec2{-0.3, -0.4} : glm::dvec2{place(random), place(random)};
      const glm::dvec2 hi = lo + glm::dvec2(size(random) + 0.4 * (i == 1), size(random) + 0.4 * (i == 1));
      const History history = history_of(plane, {rectangle(lo, hi)});
      const double even = total(echo_of(history, nullptr));
      const double expected = quadrature(
          plane, lo, hi, [&, &field = *texture](glm::dvec3 p) { return field.factor(apex + p); }, 200);
      for (const double tolerance : {1e-3, 1e-6, 1e-9}) {
        const double energy = total(echo_of(history, texture, {.tolerance = tolerance}));
        EXPECT_NEAR(energy / even, expected / even, tolerance + 2e-7)
            << name << ' ' << i << " tolerance " << tolerance;
      }
    }
}

TEST(MicroTexture, RingsOfARangeSampleAgreeWithBruteForce) {
  const double height = 3;
  const FacetPlane seabed = flat_seabed(height);
  const PlaneFrame frame(seabed);
  const History history = history_of(seabed, {rectangle({-6, -6}, {6, 6})});
  const RangeSamples samples{2.9, 0.25, 12};
  for (const auto& [name, texture] : textures()) {
    const Echo echo = echo_of(history, texture, {.samples = samples}),
               even = echo_of(history, nullptr, {.samples = samples});
    for (const int k : {0, 1, 4, 11}) {
      const auto density = [&, texture = texture](double r, double phi) {
        const double rho = std::sqrt(std::max(r * r - height * height, 0.0));
        return r * even_density(seabed, r, 0.2) *
               texture->factor(apex - height * seabed.normal + rho * std::cos(phi) * frame.u +
                               rho * std::sin(phi) * frame.v);
      };
      const double from = std::max(samples.first_m + k * samples.step_m, height),
                   to = samples.first_m + (k + 1) * samples.step_m;
      const double expected = panels({from, 0}, {to, 2 * pi}, 24, 1500, density);
      EXPECT_NEAR(echo.at(0, k) / even.at(0, k), expected / even.at(0, k), k == 0 ? 1e-4 : 4e-6)
          << name << ' ' << k;
    }
  }
}

TEST(MicroTexture, AFootprintCutInPiecesIsTheSame) {
  const unsigned seed = 31;
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> share(0.1, 0.9), place(-4, 4);
  for (const auto& [name, texture] : textures())
    for (int i = 0; i < 5; ++i) {
      const FacetPlane plane = test::random_plane(random, 3);
      const glm::dvec2 lo{place(random), place(random)}, hi = lo + glm::dvec2(1.1, 0.9);
      const glm::dvec2 cut = lo + glm::dvec2(share(random) * 1.1, share(random) * 0.9);
      const Echo whole = echo_of(history_of(plane, {rectangle(lo, hi)}), texture);
      const Echo even = echo_of(history_of(plane, {rectangle(lo, hi)}), nullptr);
      const Echo parts =
          echo_of(history_of(plane, {rectangle(lo, cut), rectangle({cut.x, lo.y}, {hi.x, cut.y}),
                                     rectangle({lo.x, cut.y}, {cut.x, hi.y}), rectangle(cut, hi)}),
                  texture);
      for (std::size_t k = 0; k < whole.energy.size(); ++k)
        ASSERT_NEAR(whole.energy[k], parts.energy[k], 1e-6 * even.energy[k] + 1e-12 * total(even))
            << name << ' ' << i << ' ' << k;
    }
}

TEST(MicroTexture, AFootprintMuchSmallerThanTheTextureHasTheFieldsValueFromEveryView) {
  // Two apexes see the plane z = 0 of the scene at one place.
  const glm::dvec3 place{7.3, -2.8, 0};
  for (const auto& [name, texture] : textures())
    for (const glm::dvec3 from : {glm::dvec3{5, -2, 3}, {11, 4, 8}}) {
      const FacetPlane seabed = flat_seabed(from.z);
      const PlaneFrame frame(seabed);
      const glm::dvec2 centre = frame.project(place - from);
      const glm::dvec2 half{5e-6, 5e-6};
      const History history = history_of(seabed, {rectangle(centre - half, centre + half)});
      const double ratio =
          total(echo_of(history, texture, {.apex_m = from})) / total(echo_of(history, nullptr));
      EXPECT_NEAR(ratio, texture->factor(place), 1e-4) << name;
    }
}

TEST(MicroTexture, TheMeanLevelOverAPeriodIsThatOfAnEvenSeabed) {
  // At this height the whole strip has the same level. The period is 256 cells.
  const double height = 2e4, wavelength = 0.5;
  const FacetPlane seabed = flat_seabed(height);
  const Settings settings{.samples = {1.9e4, 2e3, 1}, .absorption_db_per_m = 0};
  for (const std::uint64_t seed : {1, 2, 3}) {
    const Field texture = perlin(wavelength, 1, 0.9, seed);
    for (const bool along_x : {true, false}) {
      const glm::dvec2 half = along_x ? glm::dvec2{64, 0.01} : glm::dvec2{0.01, 64};
      const History history = history_of(seabed, {rectangle(-half, half)});
      EXPECT_NEAR(total(echo_of(history, texture, settings)) / total(echo_of(history, nullptr, settings)), 1,
                  1e-5)
          << seed;
    }
  }
}

TEST(MicroTexture, TheMeanLevelOverSeedsIsThatOfAnEvenSeabed) {
  const History history = history_of(flat_seabed(4), {rectangle({3, 2}, {3.2, 2.3})});
  const double even = total(echo_of(history, nullptr));
  const int seeds = 1000;
  double sum = 0, squares = 0;
  for (int seed = 1; seed <= seeds; ++seed) {
    const double ratio =
        total(echo_of(history, perlin(0.7, 2, 0.5, std::uint64_t(seed)), {.tolerance = 1e-3})) / even;
    sum += ratio;
    squares += ratio * ratio;
  }
  const double mean = sum / seeds, sigma = std::sqrt(squares / seeds - mean * mean);
  EXPECT_GT(sigma, 0.02);
  EXPECT_NEAR(mean, 1, 4 * sigma / std::sqrt(seeds));
}

TEST(MicroTexture, MakesNoShadowAndHidesNone) {
  // Two strips with a gap of range between them.
  const History history =
      history_of(flat_seabed(3), {rectangle({4, -1}, {5, 1}), rectangle({7, -1}, {9, 2})});
  const Echo even = echo_of(history, nullptr), echo = echo_of(history, perlin(0.4, 3, 0.9));
  int silent = 0;
  for (std::size_t k = 0; k < even.energy.size(); ++k) {
    EXPECT_EQ(echo.energy[k] == 0, even.energy[k] == 0) << k;
    silent += even.energy[k] == 0;
  }
  EXPECT_GT(silent, 200);
  EXPECT_LT(silent, 280);
}

TEST(MicroTexture, AnEvenMaterialBesideATexturedOneKeepsEveryBit) {
  History history = history_of(flat_seabed(3), {rectangle({4, -1}, {5, 1}), rectangle({7, -1}, {9, 2})});
  history.footprints.footprints[1].facet = 1;
  const std::vector<double> material_mu{texture_mu, texture_mu};
  const std::vector<std::uint16_t> material{0, 1};
  const std::vector<std::uint32_t> beam_of_tube{0, 1};
  const std::vector<Field> one{nullptr, perlin(0.3)};
  const BeamPatterns patterns{{Directivity{Directivity::Kind::gaussian, {1, 0, 0}, true, 0, 0.7}},
                              {{}, {}},
                              {0, 0},
                              {{0, 1}, {1, 2}}};
  for (const BeamPatterns* p : {static_cast<const BeamPatterns*>(nullptr), &patterns}) {
    const RangeSamples samples{0, 0.1, 120};
    EchoModel model{material_mu, material, 0.2, p};
    const Echo even = integrate_echo(history, {2, beam_of_tube}, samples, model);
    model.reflectivity = one;
    model.path.tx.apex_m = apex;
    const Echo echo = integrate_echo(history, {2, beam_of_tube}, samples, model);
    double differ = 0;
    for (int k = 0; k < samples.count; ++k) {
      EXPECT_EQ(echo.at(0, k), even.at(0, k)) << k;
      differ += std::abs(echo.at(1, k) - even.at(1, k));
    }
    EXPECT_GT(differ, 0);
  }
}

TEST(MicroTexture, RaysConvergeToTheTubes) {
  const FacetPlane seabed = flat_seabed(4);
  const PlaneFrame frame(seabed);
  const glm::dvec2 lo{3, 1}, hi{4, 2.5};
  const Field texture = perlin(0.8, 2, 0.5);
  const Settings one_sample{.samples = {0, 100, 1}, .absorption_db_per_m = 0};
  const double tubes = total(echo_of(history_of(seabed, {rectangle(lo, hi)}), texture, one_sample));
  double last = 1;
  for (const int n : {10, 40, 160}) {
    History rays;
    const glm::dvec2 cell = (hi - lo) / double(n);
    for (int i = 0; i < n * n; ++i) {
      const glm::dvec2 p = lo + cell * glm::dvec2(i % n + 0.5, i / n + 0.5);
      const glm::dvec3 d = -seabed.distance_m * seabed.normal + p.x * frame.u + p.y * frame.v;
      const double r = glm::length(d), sine = seabed.distance_m / r;
      rays.hits.push_back({0, 0, r, sine, cell.x * cell.y * sine / (r * r), glm::vec3(d / r)});
    }
    const double error = std::abs(total(echo_of(rays, texture, one_sample)) / tubes - 1);
    EXPECT_LT(error, last / 4) << n;
    last = error;
  }
  EXPECT_LT(last, 2e-5);
}

TEST(MicroTexture, FastBinningTakesItAtTheCentroid) {
  const History history = history_of(flat_seabed(4), {rectangle({3, 1}, {3.4, 1.6})});
  const Field texture = perlin(0.3, 2, 0.5);
  const double factor = texture->factor(apex + history.footprints.footprints[0].centroid_m);
  for (const Binning binning : {Binning::spread, Binning::centroid})
    EXPECT_NEAR(total(echo_of(history, texture, {.binning = binning})),
                factor * total(echo_of(history, nullptr, {.binning = binning})), 1e-20);
}

// --- with beam patterns

TEST(MicroTexture, PatternsAndTextureAgreeWithBruteForce) {
  const FacetPlane seabed = flat_seabed(4);
  const glm::dvec2 lo{3, 1}, hi{4.3, 2.2};
  const History history = history_of(seabed, {rectangle(lo, hi)});
  const glm::dvec3 x{1, 0, 0}, y{0, 1, 0};
  const TransmitPattern sent(std::vector<Directivity>{line(6, 0.1, y), line(6, -0.3, y)});
  // Four beams of an array, which are read from moments, then two without a common axis.
  const std::vector<std::vector<Directivity>> receivers{
      {line(20, 0.1, x), line(20, 0.3, x), line(20, 0.5, x), line(20, 0.7, x)},
      {line(9, 0.4, x), {Directivity::Kind::gaussian, y, false, 0.2, 0.3}}};
  for (const auto& receive : receivers)
    for (const auto& [name, texture] : textures()) {
      const BeamPatterns patterns{{sent}, receive, {0}, {{0, std::uint32_t(receive.size())}}};
      const Settings settings{.samples = {0.1, 100, 1}, .patterns = &patterns};
      const Echo echo = echo_of(history, texture, settings);
      const double peak = quadrature(seabed, lo, hi, [](glm::dvec3) { return 2.0; });
      for (std::size_t b = 0; b < receive.size(); ++b) {
        const auto received = [&, texture = texture](glm::dvec3 p) {
          const glm::dvec3 d = glm::normalize(p);
          return texture->factor(apex + p) * sent.gain(d) * receive[b].gain(d);
        };
        EXPECT_NEAR(echo.energy[b] / peak, quadrature(seabed, lo, hi, received) / peak, 2e-6)
            << name << " beam " << b;
      }
    }
}

TEST(MicroTexture, TwoReceiversOfAPairAgreeWithBruteForce) {
  const FacetPlane seabed = flat_seabed(4);
  const PlaneFrame frame(seabed);
  const glm::dvec2 lo{3, 1}, hi{4.3, 2.2};
  ReceiverPairHistory history;
  for (SharedFootprints* shared : {&history.by_upper, &history.by_lower}) {
    for (const glm::dvec2 p : rectangle(lo, hi))
      shared->corners_m.push_back(p.x * frame.u + p.y * frame.v - seabed.distance_m * seabed.normal);
    shared->pieces = {{0, 0, 0, 4}};
    SharedFacet facet;
    facet.piece_count = 1;
    facet.plane_normal = seabed.normal;
    facet.transmit_distance_m = seabed.distance_m;
    shared->facets = {facet};
  }
  const ReceiverBaseline receiver_pair{glm::normalize(glm::dvec3(1, 1, 0)), 0.05, 700};
  const BeamPatterns patterns{{TransmitPattern()}, {Directivity()}, {0}, {{0, 1}}, {receiver_pair}};
  const glm::dvec3 end = receiver_pair.baseline_m / 2 * receiver_pair.axis;
  for (const auto& [name, texture] : textures()) {
    const std::vector<Field> fields{texture};
    const std::vector<double> material_mu{texture_mu};
    const std::vector<std::uint16_t> one_facet{0};
    EchoModel model{material_mu, one_facet, 0.2, &patterns};
    model.reflectivity = fields;
    model.path.tx.apex_m = apex;
    const ReceiverPairEcho echo =
        integrate_receiver_pair_echo(history, receiver_pair, 0, 0, {0.1, 100, 1}, model);
    // quadrature() has the monostatic law. This factor converts the receive leg to that of the receiver.
    const auto further = [&](glm::dvec3 p, glm::dvec3 receiver) {
      const double height = glm::dot(seabed.normal, receiver - p), range = glm::distance(p, receiver);
      const double beta = 0.2 * std::log(10.0) / 10;  // quadrature() already contains the transmit leg
      return height / seabed.distance_m * std::pow(glm::length(p) / range, 3) *
             std::exp(-beta * (range - glm::length(p)));
    };
    const double peak = quadrature(seabed, lo, hi, [](glm::dvec3) { return 1.0; });
    EXPECT_NEAR(echo.upper_j[0] / peak,
                quadrature(seabed, lo, hi,
                           [&, texture = texture](glm::dvec3 p) {
                             return texture->factor(apex + p) * further(p, end);
                           }) /
                    peak,
                2e-6)
        << name;
    EXPECT_NEAR(echo.cross_real_j[0] / peak,
                quadrature(seabed, lo, hi,
                           [&, texture = texture](glm::dvec3 p) {
                             return texture->factor(apex + p) *
                                    std::sqrt(further(p, end) * further(p, -end)) *
                                    std::cos(700 * (glm::distance(p, end) - glm::distance(p, -end)));
                           }) /
                    peak,
                2e-6)
        << name;
  }
}

// --- transmitter and separate receiver

TEST(MicroTexture, BistaticEchoesAgreeWithBruteForce) {
  const FacetPlane seabed = flat_seabed(4);
  const PlaneFrame frame(seabed);
  const glm::dvec2 lo{3, 1}, hi{3.9, 1.8};
  const glm::dvec3 receiver{1.5, -2, 1};
  const BistaticHistory history = test::piece_on(seabed, rectangle(lo, hi), receiver);
  const std::vector<double> material_mu{texture_mu};
  const std::vector<std::uint16_t> material{0};
  const std::vector<std::uint32_t> beam{0};
  const BeamPatterns patterns{{Directivity{Directivity::Kind::gaussian, {1, 0, 0}, true, 0, 1.5}},
                              {line(5, 0.2, {1, 0, 0})},
                              {0},
                              {{0, 1}}};
  for (const auto& [name, texture] : textures())
    for (const BeamPatterns* p : {static_cast<const BeamPatterns*>(nullptr), &patterns}) {
      const std::vector<Field> reflectivity{texture};
      const auto energy = [&](const RangeSamples& samples) {
        return total(integrate_echo(history, {1, beam}, samples,
                                    {material_mu, material, 0, p, 1e-6, reflectivity, apex}));
      };
      const auto density = [&, texture = texture](double x, double y) {
        const glm::dvec3 t = -seabed.distance_m * seabed.normal + x * frame.u + y * frame.v, r = t - receiver;
        const double rt = glm::length(t), rr = glm::length(r);
        const double gain = p ? p->transmit[0].gain(t / rt) * p->receive[0].gain(r / rr) : 1;
        return texture_mu * seabed.distance_m * (seabed.distance_m + receiver.z) / std::pow(rt * rr, 3) *
               texture->factor(apex + t) * gain;
      };
      const double expected = panels(lo, hi, 64, 64, density);
      EXPECT_NEAR(energy({0, 100, 1}) / expected, 1, 1e-6) << name;
      EXPECT_NEAR(energy({0, 0.07, 1000}) / expected, 1, 1e-6) << name;
    }
}

TEST(MicroTexture, RefusesTexturesOfOtherMaterials) {
  const History history = history_of(flat_seabed(4), {rectangle({3, 1}, {3.4, 1.6})});
  const std::vector<double> material_mu{texture_mu};
  const std::vector<std::uint16_t> material{0};
  const std::vector<std::uint32_t> beam_of_tube{0};
  const std::vector<Field> two{perlin(1), perlin(2)};
  EchoModel model{material_mu, material};
  model.reflectivity = two;
  EXPECT_THROW(integrate_echo(history, {1, beam_of_tube}, {0, 1, 10}, model), std::invalid_argument);
  EXPECT_THROW(integrate_echo(BistaticHistory{}, {1, {}}, {0, 1, 10}, model), std::invalid_argument);
}

}  // namespace
}  // namespace tubefoot
