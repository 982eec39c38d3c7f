// SPDX-License-Identifier: GPL-3.0-or-later
// Tests covariances of signal channels within range bins. The comparisons are the energies of the echo
// engines, closed forms of van Cittert and Zernike, and sums over points.

#include "engine/signal/gated_covariance.hpp"

#include <gtest/gtest.h>

#include <boost/math/quadrature/gauss_kronrod.hpp>
#include <random>

#include "engine/echo/receiver_pair_echo.hpp"
#include "engine/scattering/perlin_reflectivity.hpp"
#include "fixtures/geometry/plane_polygons.hpp"
#include "fixtures/world/histories.hpp"
#include "fixtures/world/signal_scenes.hpp"
#include "geometry/numbers/scalars.hpp"

namespace tubefoot {
namespace {

using boost::math::quadrature::gauss_kronrod;
using Complex = std::complex<double>;
using test::Polygon2;
using test::SignalView;

const std::vector<double> one_mu{0.1};
const std::vector<std::uint16_t> one_material{0};

EchoModel isovelocity_model() { return {one_mu, one_material}; }

/// Returns a polygon on the plane z = -height, in (x, y).
VisiblePolygons surface_apex(double height, const Polygon2& polygon) {
  VisiblePolygons seen;
  for (const glm::dvec2 p : polygon) seen.corners_m.push_back({p, -height});
  std::reverse(seen.corners_m.begin(), seen.corners_m.end());  // clockwise from above
  seen.patches = {{0, {0, 0, 1}, height, 0, std::uint32_t(polygon.size()), 0, 0}};
  return seen;
}

Polygon2 rectangle(double x0, double x1, double y0, double y1) {
  return {{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}};
}

TEST(GatedCovariance, OneChannelWithItselfIsTodaysEnergy) {
  for (const test::SignalScene& scene : test::signal_scenes()) {
    const SignalView view(scene, {0.0, 0.0, 0.0});
    const RangeSamples samples{3, 0.2, 20};
    const std::vector<std::uint32_t> beams(view.history.tubes.tubes.size(), 0);
    EchoModel model = view.model;
    model.absorption_db_per_m = 0.2;
    const Echo echo = integrate_echo(view.history, {1, beams}, samples, model);
    const SignalChannel channel{view.apex_m, view.apex_m};
    const SampleCovariances own =
        gated_covariances(view.patches(), channel, channel, samples, 100, model, 1e-14);
    ASSERT_GT(test::total(echo), 0);
    for (int k = 0; k < samples.count; ++k) {
      EXPECT_NEAR(own.at(k, k).real(), echo.at(0, k), 1e-12 * echo.at(0, k)) << scene.name << ' ' << k;
      EXPECT_EQ(own.at(k, k).imag(), 0);
      EXPECT_EQ(own.at(k, k + 1), 0.0);
    }
    // The limit of two coincident channels agrees, too.
    const SignalChannel other{view.apex_m, view.apex_m + glm::dvec3(1e-13, 0, 0)};
    const SampleCovariances both =
        gated_covariances(view.patches(), channel, other, samples, 100, model, 1e-13);
    for (int k = 0; k < samples.count; ++k)
      EXPECT_NEAR(std::abs(both.at(k, k)), echo.at(0, k), 1e-10 * echo.at(0, k)) << scene.name << ' ' << k;
  }
}

TEST(GatedCovariance, WithPatternsItIsTodaysEnergyToo) {
  const test::SignalScene scene = test::signal_scenes()[1];
  const SignalView view(scene, {0.0, 0.0, 0.0});
  const RangeSamples samples{3, 0.2, 20};
  SignalChannel channel{view.apex_m, view.apex_m};
  channel.transmit = {Directivity::Kind::line, {1, 0, 0}, false, 0, 4};
  channel.receive = {Directivity::Kind::gaussian, glm::normalize(glm::dvec3(0, 1, -0.8)), true, 0, 0.6};
  const std::size_t tubes = view.history.tubes.tubes.size();
  const std::vector<std::uint32_t> beams(tubes, 0);
  const BeamPatterns patterns = patterns_of_fan({{channel.transmit}, {channel.receive}, {}, {}}, 0, tubes);
  EchoModel model = view.model;
  model.patterns = &patterns;
  model.pattern_tolerance = 1e-12;
  const Echo echo = integrate_echo(view.history, {1, beams}, samples, model);
  const SampleCovariances own =
      gated_covariances(view.patches(), channel, channel, samples, 100, model, 1e-13);
  double loudest = 0;
  for (int k = 0; k < samples.count; ++k) loudest = std::max(loudest, echo.at(0, k));
  for (int k = 0; k < samples.count; ++k)
    EXPECT_NEAR(own.at(k, k).real(), echo.at(0, k), 1e-11 * loudest) << k;
}

TEST(GatedCovariance, BetweenTwoApexesItIsTodaysEnergyWithLawsAndTextures) {
  const test::SignalScene scene = test::signal_scenes()[1];
  const SignalView view(scene, {0.0, 0.0, 0.0}), other(scene, {0.25, 0.0, 0.125});
  const SceneTree tree(scene.mesh);
  const BistaticHistory history = trace_bistatic(scene.mesh, tree, test::signal_grid().unit_m(), {},
                                                 view.history.tubes, other.history.tubes);
  const std::vector<std::shared_ptr<const ScatteringModel>> models{
      nullptr,
      std::make_shared<const ScatteringModel>(ScatteringModel::gsab({0.1, 0.2, 0.02, 2, 0.01, 0.4}))};
  const std::vector<std::shared_ptr<const ReflectivityField>> textures{
      std::make_shared<const PerlinReflectivity>(PerlinReflectivity::Settings{}), nullptr};
  EchoModel model = view.model;
  model.absorption_db_per_m = 0.1;
  const RangeSamples samples{3, 0.2, 20};
  const std::vector<std::uint32_t> beams(other.history.tubes.tubes.size(), 0);
  const auto check = [&](double tolerance) {
    const Echo echo = integrate_echo(history, {1, beams}, samples, model, Quadrature(Binning::exact, 1e-13));
    const SignalChannel channel{view.apex_m, other.apex_m};
    const SampleCovariances own =
        gated_covariances(visible_polygons(history, model), channel, channel, samples, 100, model, 1e-13);
    ASSERT_GT(test::total(echo), 0);
    for (int k = 0; k < samples.count; ++k)
      EXPECT_NEAR(own.at(k, k).real(), echo.at(0, k), tolerance * echo.at(0, k)) << k;
  };
  check(1e-12);
  model.scattering = models;
  check(1e-12);
  model.reflectivity = textures;
  check(1e-12);
}

TEST(GatedCovariance, ReceiversOfAReceiverPairAreItsEcho) {
  const ReceiverBaseline receiver_pair{{std::sin(0.4), 0, std::cos(0.4)}, 0.3, 2 * pi * 30e3 / 1500};
  const RangeSamples samples{6, 0.1, 40};
  const Polygon2 polygon{{3, -2}, {8, -1}, {7, 3}, {4, 2}};
  ReceiverPairHistory history;
  history.transmit.tubes = history.upper.tubes = history.lower.tubes = {Tube{}};
  const VisiblePolygons seen = surface_apex(5, polygon);
  SharedFacet facet{0, 0, 1, {0, 0, 1}, 5, 5};
  history.by_upper.corners_m = seen.corners_m;
  history.by_upper.pieces = {{0, 0, 0, 4}};
  history.by_upper.facets = {facet};
  history.by_lower = history.by_upper;
  const BeamPatterns patterns{{Directivity()}, {Directivity()}, {0}, {{0, 1}}, {receiver_pair}};
  EchoModel model = isovelocity_model();
  model.patterns = &patterns;
  const ReceiverPairEcho echo = integrate_receiver_pair_echo(history, receiver_pair, 0, 0, samples, model);
  const glm::dvec3 end = receiver_pair.baseline_m / 2 * receiver_pair.axis;
  const SampleCovariances both = gated_covariances(seen, {glm::dvec3(0), end}, {glm::dvec3(0), -end}, samples,
                                                   receiver_pair.wavenumber_rad_m, model);
  for (int k = 0; k < samples.count; ++k) {
    const auto n = std::size_t(k);
    const Complex expected(echo.cross_real_j[n], echo.cross_imag_j[n]);
    EXPECT_LT(std::abs(both.at(k, k) - expected), 1e-8 * echo.upper_j[n] + 1e-18) << k;
  }
}

// A flat seabed 10 m below, and a receiver pair tilted by 30 degrees with the transmitter at its lower end.
// The frequency is 250 kHz, and the range bin of 75 mm starts at 30 m.
TEST(GatedCovariance, FootprintsThatAreShiftedDecorrelate) {
  const double step = 0.075, baseline = 0.06, range = 30, k = 2 * pi * 250e3 / 1500;
  const VisiblePolygons strip = surface_apex(10, rectangle(5, 40, -5e-4, 5e-4));
  const EchoModel model = isovelocity_model();
  const glm::dvec3 receiver_pair = baseline * glm::dvec3(0.5, 0, std::sqrt(0.75));
  const auto coherence = [&](glm::dvec3 one_end, glm::dvec3 other_end, double first_m) {
    const RangeSamples samples{first_m, step, 1};
    const SignalChannel one{{}, one_end}, other{{}, other_end};
    const double size = std::sqrt(gated_covariances(strip, one, one, samples, k, model).at(0, 0).real() *
                                  gated_covariances(strip, other, other, samples, k, model).at(0, 0).real());
    return std::abs(gated_covariances(strip, one, other, samples, k, model).at(0, 0)) / size;
  };
  // Only the spread of phases remains: energy that the gates shift out of one range bin lies in its
  // neighbours.
  const RangeSamples three{range - step, step, 3};
  const auto all = [&](double wavenumber) {
    const SampleCovariances r = gated_covariances(strip, {{}, receiver_pair}, {}, three, wavenumber, model);
    return std::abs(r.at(1, 0) + r.at(1, 1) + r.at(1, 2));
  };
  EXPECT_NEAR(all(k) / all(0), 0.999875684, 2e-8);
  EXPECT_NEAR(coherence(receiver_pair, {}, range), 0.927009, 3e-6);
  // The transmitter is in the middle of the receiver pair and the range bin about 30 m: see
  // docs/sensors.md.
  EXPECT_NEAR(coherence(receiver_pair / 2.0, -receiver_pair / 2.0, range - step / 2), 0.926810, 2e-6);
  // The closed form assumes uniform energy over a range bin.
  const auto delta = [&](double r) { return baseline * std::sin(std::asin(10 / r) - pi / 6); };
  const double kappa = k * std::abs(delta(range + step / 2) - delta(range - step / 2)) / step,
               shift = std::abs(delta(range)) / 2;
  EXPECT_NEAR(coherence(receiver_pair / 2.0, -receiver_pair / 2.0, range - step / 2),
              std::sin((step - shift) * kappa / 2) / (step * kappa / 2), 5e-6);
}

// Van Cittert and Zernike: a footprint of width a at range r, and elements at a distance D.
TEST(GatedCovariance, AnEvenFootprintsCoherenceIsASinc) {
  const double a = 0.5, r = 20, apart = 0.02, k = 2 * pi * 455e3 / 1500;
  const auto sinc = [](double x) { return std::sin(x) / x; };
  EXPECT_NEAR(sinc(k * apart * a / (2 * r)), 0.962589148, 5e-10);
  // One element lies over the middle of the footprint, the other next to it.
  const auto further = [&](double x) { return std::hypot(r, x) - std::hypot(r, x - apart); };
  const auto mean = [&](const auto& f) {
    return gauss_kronrod<double, 61>::integrate([&](double x) { return f(x); }, -a / 2, a / 2, 8, 1e-13) / a;
  };
  EXPECT_NEAR(std::hypot(mean([&](double x) { return std::cos(k * further(x)); }),
                         mean([&](double x) { return std::sin(k * further(x)); })),
              0.962592637, 5e-10);
  // A thin strip under the sonar, with amplitudes that depend on ranges and grazing angles.
  const VisiblePolygons strip = surface_apex(r, rectangle(-a / 2, a / 2, -1e-5, 1e-5));
  const SignalChannel over{}, beside{{}, {apart, 0, 0}};
  const RangeSamples whole{19, 3, 1};
  const EchoModel model = isovelocity_model();
  const double one = gated_covariances(strip, over, over, whole, k, model).at(0, 0).real(),
               other = gated_covariances(strip, beside, beside, whole, k, model).at(0, 0).real(),
               both = std::abs(gated_covariances(strip, over, beside, whole, k, model).at(0, 0)),
               size = std::sqrt(one * other);
  const auto weight = [&](double x, double power,
                          double of_other) {  // of the ranges, transmitter over the middle
    return std::pow(std::hypot(r, x), power) * std::pow(std::hypot(r, x - apart), of_other);
  };
  const double expected =
      std::hypot(mean([&](double x) { return weight(x, -4.5, -1.5) * std::cos(k * further(x)); }),
                 mean([&](double x) { return weight(x, -4.5, -1.5) * std::sin(k * further(x)); })) /
      std::sqrt(mean([&](double x) { return weight(x, -6, 0); }) *
                mean([&](double x) { return weight(x, -3, -3); }));
  EXPECT_NEAR(both / size, expected, 1e-9);
  EXPECT_NEAR(both / size, 0.962592637, 1e-5);  // amplitudes decrease towards the ends
  // The first zero is at lambda r / a.
  const double zero = 2 * pi / k * r / a;
  const SignalChannel far_left{{}, {-zero / 2, 0, 0}}, far_right{{}, {zero / 2, 0, 0}};
  EXPECT_LT(std::abs(gated_covariances(strip, far_left, far_right, whole, k, model).at(0, 0)) / size, 2e-4);
}

TEST(GatedCovariance, DisplacedPhaseCentresFollowABSpline) {
  // Transmit and receive apertures of length L, both displaced by D along themselves: B3(2 D / L) / B3(0).
  const auto b3 = [](double x) {
    x = std::abs(x);
    return x < 1 ? 2.0 / 3 - x * x + x * x * x / 2 : x < 2 ? std::pow(2 - x, 3) / 6 : 0;
  };
  EXPECT_EQ(b3(0.25) / b3(0), 0.91796875);
  EXPECT_EQ(b3(1) / b3(0), 0.25);
  const double wavelength = 0.01, k = 2 * pi / wavelength, r = 1000;
  const RangeSamples whole{r / 2, r, 1};
  const EchoModel model = isovelocity_model();
  const auto strip_for = [&](double length) {  // six side lobes
    const double half = 7 * wavelength / length * r;
    return surface_apex(r, rectangle(-half, half, -1e-5, 1e-5));
  };
  for (const double length : {0.2, 0.4}) {
    const VisiblePolygons strip = strip_for(length);
    const Directivity line{Directivity::Kind::line, {1, 0, 0}, false, 0, length / wavelength};
    const auto channel = [&](double x) { return SignalChannel{{x, 0, 0}, {x, 0, 0}, line, line}; };
    const double size =
        gated_covariances(strip, channel(0), channel(0), whole, k, model, 1e-7).at(0, 0).real();
    for (const double share : {0.125, 0.5}) {
      const double d = share * length;
      const Complex both =
          gated_covariances(strip, channel(-d / 2), channel(d / 2), whole, k, model, 1e-7).at(0, 0);
      EXPECT_NEAR(both.real() / size, b3(2 * share) / b3(0), 0.15 * std::pow(wavelength / length, 2))
          << length << ' ' << share;
      EXPECT_LT(std::abs(both.imag()), 1e-5 * size);
    }
  }
  // The pattern on one leg only gives a triangle.
  const double length = 0.4;
  const VisiblePolygons strip = strip_for(length / 2);  // side lobes decrease with their square only
  const Directivity line{Directivity::Kind::line, {1, 0, 0}, false, 0, length / wavelength};
  const auto channel = [&](double x) { return SignalChannel{{x, 0, 0}, {x, 0, 0}, line, {}}; };
  const double size = gated_covariances(strip, channel(0), channel(0), whole, k, model, 1e-7).at(0, 0).real();
  const Complex both =
      gated_covariances(strip, channel(-0.05), channel(0.05), whole, k, model, 1e-7).at(0, 0);
  EXPECT_NEAR(both.real() / size, 1 - 2 * 0.1 / length, 8e-3);
}

/// Sums over a lattice of points, by definition.
TEST(GatedCovariance, DisplacedTransmittersAgreeWithSumsOverPoints) {
  const unsigned seed = 5;
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> share(-0.5, 0.5);
  for (int trial = 0; trial < 6; ++trial) {
    const double height = 2 + share(random);
    const Polygon2 polygon = test::random_convex(random, {share(random) * 3, share(random) * 3}, 1.5, 0.9);
    if (polygon.size() < 3) continue;
    const VisiblePolygons seen = surface_apex(height, polygon);
    const auto near = [&] { return glm::dvec3(share(random), share(random), share(random)); };
    const SignalChannel a{near(), near()}, b{near(), near()};
    const RangeSamples samples{1.5, 0.11, 25};
    const double k = 30;
    const EchoModel model = isovelocity_model();
    const SampleCovariances both = gated_covariances(seen, a, b, samples, k, model),
                            swapped = gated_covariances(seen, b, a, samples, k, model),
                            turned = gated_covariances(seen, {a.receive_m, a.transmit_m},
                                                       {b.receive_m, b.transmit_m}, samples, k, model);
    ASSERT_GT(both.reach, 0);
    std::vector<Complex> sum(both.value.size());
    glm::dvec2 low = polygon[0], high = low;
    for (const glm::dvec2 p : polygon) {
      low = glm::min(low, p);
      high = glm::max(high, p);
    }
    constexpr int n = 1500;
    const glm::dvec2 cell = (high - low) / double(n);
    for (int x = 0; x < n; ++x)
      for (int y = 0; y < n; ++y) {
        const glm::dvec2 p = low + cell * glm::dvec2(x + 0.5, y + 0.5);
        bool inside = true;
        for (std::size_t i = 0; i < polygon.size() && inside; ++i) {
          const glm::dvec2 c = polygon[i], d = polygon[(i + 1) % polygon.size()];
          inside = (d.x - c.x) * (p.y - c.y) - (d.y - c.y) * (p.x - c.x) >= 0;
        }
        if (!inside) continue;
        const glm::dvec3 at(p, -height);
        const auto received = [&](const SignalChannel& c) {
          const double tx = glm::distance(at, c.transmit_m), rx = glm::distance(at, c.receive_m);
          const double energy =
              0.1 * (height + c.transmit_m.z) * (height + c.receive_m.z) / std::pow(tx * rx, 3);
          return std::pair(tx + rx, std::sqrt(energy));
        };
        const auto [la, aa] = received(a);
        const auto [lb, ab] = received(b);
        const double ka = std::floor((la / 2 - samples.first_m) / samples.step_m),
                     kb = std::floor((lb / 2 - samples.first_m) / samples.step_m);
        if (ka < 0 || kb < 0 || ka >= samples.count || kb >= samples.count) continue;
        ASSERT_LE(std::abs(ka - kb), both.reach);
        sum[std::size_t((2 * both.reach + 1) * int(ka) + int(kb - ka) + both.reach)] +=
            std::polar(aa * ab * cell.x * cell.y, k * (la - lb));
      }
    double loudest = 0;
    for (const Complex& s : sum) loudest = std::max(loudest, std::abs(s));
    ASSERT_GT(loudest, 0);
    for (int i = 0; i < samples.count; ++i)
      for (int j = std::max(i - both.reach, 0); j <= std::min(i + both.reach, samples.count - 1); ++j) {
        const Complex expected = sum[std::size_t((2 * both.reach + 1) * i + j - i + both.reach)];
        EXPECT_LT(std::abs(both.at(i, j) - expected), 5e-3 * loudest) << trial << ' ' << i << ' ' << j;
        // Law: Hermitian.
        EXPECT_LT(std::abs(both.at(i, j) - std::conj(swapped.at(j, i))), 1e-8 * loudest) << trial;
        // Law: reciprocal.
        EXPECT_LT(std::abs(both.at(i, j) - turned.at(i, j)), 1e-8 * loudest) << trial;
      }
  }
}

// Transmitter and receiver are exchanged: all ellipses of one channel are ellipses of the other.
TEST(GatedCovariance, OfAPathAndTheSamePathBackIsItsEnergy) {
  const VisiblePolygons seen = surface_apex(3, {{-1, 0.5}, {2, 1}, {1.5, 3}, {-0.5, 2.5}});
  const glm::dvec3 here(0.2, -0.1, 0.3), there(-0.4, 0.3, -0.2);
  const RangeSamples samples{2.5, 0.13, 20};
  const EchoModel model = isovelocity_model();
  const SampleCovariances both = gated_covariances(seen, {here, there}, {there, here}, samples, 200, model),
                          own = gated_covariances(seen, {here, there}, {here, there}, samples, 200, model);
  double all = 0;
  for (int k = 0; k < samples.count; ++k) all += own.at(k, k).real();
  ASSERT_GT(all, 0);
  for (int k = 0; k < samples.count; ++k)
    for (int j = std::max(k - both.reach, 0); j <= std::min(k + both.reach, samples.count - 1); ++j)
      EXPECT_LT(std::abs(both.at(k, j) - own.at(k, j)), 1e-9 * all) << k << ' ' << j;
}

/// Divides polygons, range bins and tubes into parts: the sums stay the same.
TEST(GatedCovariance, PartsAddUp) {
  const test::SignalScene scene = test::signal_scenes()[0];
  const SignalView view(scene, {0.0, 0.0, 0.0});
  const VisiblePolygons seen = view.patches();
  const SignalChannel a{view.apex_m, view.apex_m + glm::dvec3(0.05, 0, 0)},
      b{view.apex_m + glm::dvec3(0.02, 0.01, 0), view.apex_m - glm::dvec3(0.05, 0, 0)};
  const RangeSamples samples{3, 0.3, 14};
  const double k = 80;
  const SampleCovariances all = gated_covariances(seen, a, b, samples, k, view.model);
  std::vector<Complex> by_tube(all.value.size()), halves(all.value.size());
  for (std::uint32_t tube = 0; tube < 6; ++tube) {
    VisiblePolygons part = seen;
    std::erase_if(part.patches, [&](const VisiblePolygon& p) { return p.rx_tube != tube; });
    const SampleCovariances own = gated_covariances(part, a, b, samples, k, view.model);
    for (std::size_t n = 0; n < own.value.size(); ++n) by_tube[n] += own.value[n];
  }
  for (const int half : {0, 1}) {
    VisiblePolygons part;
    part.origin_m = seen.origin_m;
    for (const VisiblePolygon& patch : seen.patches) {
      const auto corners = seen.corners(patch);
      const std::size_t n = corners.size();
      const glm::dvec3 p = (corners[0] + corners[1]) / 2.0,
                       q = (corners[n / 2] + corners[(n / 2 + 1) % n]) / 2.0;
      VisiblePolygon one = patch;
      one.first_corner = std::uint32_t(part.corners_m.size());
      if (half == 0) {
        part.corners_m.push_back(p);
        for (std::size_t i = 1; i <= n / 2; ++i) part.corners_m.push_back(corners[i]);
        part.corners_m.push_back(q);
      } else {
        part.corners_m.push_back(q);
        for (std::size_t i = n / 2 + 1; i <= n; ++i) part.corners_m.push_back(corners[i % n]);
        part.corners_m.push_back(p);
      }
      one.corner_count = std::uint32_t(part.corners_m.size()) - one.first_corner;
      part.patches.push_back(one);
    }
    const SampleCovariances own = gated_covariances(part, a, b, samples, k, view.model);
    for (std::size_t n = 0; n < own.value.size(); ++n) halves[n] += own.value[n];
  }
  double loudest = 0;
  for (const Complex& v : all.value) loudest = std::max(loudest, std::abs(v));
  for (std::size_t n = 0; n < all.value.size(); ++n) {
    EXPECT_LT(std::abs(by_tube[n] - all.value[n]), 1e-13 * loudest) << n;
    EXPECT_LT(std::abs(halves[n] - all.value[n]), 1e-9 * loudest) << n;
  }
}

TEST(GatedCovariance, RefusesWhatIsNone) {
  const VisiblePolygons seabed = surface_apex(5, rectangle(-1, 1, -1, 1));
  const EchoModel model = isovelocity_model();
  EXPECT_THROW(gated_covariances(seabed, {}, {}, {1, 0, 3}, 1, model), std::invalid_argument);
  EXPECT_THROW(gated_covariances(seabed, {}, {}, {1, 1, 0}, 1, model), std::invalid_argument);
  EXPECT_THROW(gated_covariances(seabed, {}, {}, {1, 1, 3}, -1, model), std::invalid_argument);
  EXPECT_THROW(gated_covariances(seabed, {}, {}, {1, 1, 3}, 1, model, 0), std::invalid_argument);
  const BistaticHistory apart = test::piece_on(test::flat_seabed(5), rectangle(-1, 1, -1, 1), {0, 0, 1});
  EXPECT_EQ(visible_polygons(apart, model).patches.size(), 1u);
  EchoModel by_mirror = model;
  by_mirror.path.tx.loss.factor = 0.5;
  EXPECT_THROW(visible_polygons(apart, by_mirror), std::invalid_argument);
}

}  // namespace
}  // namespace tubefoot
