// SPDX-License-Identifier: GPL-3.0-or-later
// Tests channel signals of smooth facets. The comparisons are pulses along the edges, the image of a large
// plane, the target strength of a sphere, and laws.
#include "engine/signal/smooth_signals.hpp"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <random>

#include "engine/signal/smooth_amplitude.hpp"
#include "engine/visibility/tube_engine.hpp"
#include "fixtures/geometry/layered_scenes.hpp"
#include "fixtures/world/smooth_plates.hpp"
#include "geometry/integrals/polygon_transform.hpp"
#include "geometry/numbers/scalars.hpp"
#include "geometry/tubes/tube.hpp"

namespace tubefoot {
namespace {

using Complex = std::complex<double>;
using test::Polygon2;
using namespace test::smooth_plates;

PlanarPolygon polygon_of(const VisiblePolygons& seen, const VisiblePolygon& patch,
                         const SignalChannel& channel, PathCutter::Receiver& rx) {
  const glm::dvec3 transmit = channel.transmit_m - seen.origin_m, receive = channel.receive_m - seen.origin_m;
  const FacetPlane plane{patch.normal, patch.distance_m + glm::dot(patch.normal, transmit)};
  const PlaneFrame frame(plane);
  rx = {patch.distance_m + glm::dot(patch.normal, receive), frame.project(receive - transmit)};
  std::vector<glm::dvec3> corners;
  for (const glm::dvec3& corner : seen.corners(patch)) corners.push_back(corner - transmit);
  PlanarPolygon polygon;
  polygon.assign(corners, plane, frame);
  return polygon;
}

/// Computes the first channel by add_pulse_echo(), for rigid surfaces. `wave`: entire function of the pulse
/// at the carrier.
std::vector<Complex> by_edges(const VisiblePolygons& seen, const CoherentReceiver& receiver,
                              const TransmittedPulse& wave) {
  std::vector<double> times;
  for (std::size_t k = 0; k < receiver.times.count; ++k) times.push_back(receiver.times.time_s(k));
  std::vector<Complex> sum(times.size());
  for (const VisiblePolygon& patch : seen.patches) {
    PathCutter::Receiver rx;
    const PlanarPolygon polygon = polygon_of(seen, patch, receiver.channels[0], rx);
    add_pulse_echo(polygon, rx, wave, receiver.sound_speed_m_s, times, sum);
  }
  for (std::size_t k = 0; k < times.size(); ++k) sum[k] *= phasor(2 * pi * receiver.carrier_hz * times[k]);
  return sum;
}

/// exp(-t^2 (1 / 2 sigma^2 + i pi sweep)) of energy 1.
TransmittedPulse gaussian_wave(double sigma_s, double carrier_hz, double sweep_hz_s = 0) {
  const double omega = 2 * pi * carrier_hz;
  const Complex bend(1 / (2 * sigma_s * sigma_s), pi * sweep_hz_s);
  return {[=](double t) {
            return std::exp(-t * t * bend - Complex(0, omega * t)) / std::sqrt(sigma_s * std::sqrt(pi));
          },
          omega + 8 * (1 / sigma_s + 2 * pi * std::abs(sweep_hz_s) * sigma_s)};
}

double most_of(const VisiblePolygons& seen, const CoherentReceiver& receiver) {
  double sum = 0;
  for (const VisiblePolygon& patch : seen.patches) {
    PathCutter::Receiver rx;
    const PlanarPolygon polygon = polygon_of(seen, patch, receiver.channels[0], rx);
    sum += far_amplitude(polygon, rx, 2 * pi * receiver.carrier_hz / receiver.sound_speed_m_s).most;
  }
  return sum;
}

double largest_difference(const ChannelSignals& signals, std::span<const Complex> other) {
  double worst = 0;
  for (std::size_t k = 0; k < signals.samples; ++k)
    worst = std::max(worst, std::abs(signals.at(0, k) - other[k]));
  return worst;
}

// Law Q8, near and far, with one apex and two, for polygons that need one node and for polygons that must
// be cut.
TEST(SmoothSignals, AreThePulseAlongTheEdges) {
  const unsigned seed = 5;
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> unit(0, 1);
  const EchoModel model;
  for (int n = 0; n < 8; ++n) {
    const double size = std::pow(10, -2.3 + 2.3 * unit(random)),
                 height = 0.7 + (n % 3 == 0 ? 20 : 3) * unit(random),
                 sigma = std::pow(10, -4.8 + unit(random));
    const FacetPlane plane = test::random_plane(random, height);
    const VisiblePolygons seen = patches_of(
        plane,
        test::random_convex(random, {2 * unit(random) - 1, 2 * unit(random) - 1}, size, size * unit(random)));
    const glm::dvec3 apart =
        n % 2 == 0 ? glm::dvec3(0) : 0.3 * glm::dvec3(unit(random), unit(random), unit(random));
    CoherentReceiver receiver = receiver_of({{glm::dvec3(0), apart}}, sigma);
    listen(receiver, seen);
    const std::vector<Complex> exact = by_edges(seen, receiver, gaussian_wave(sigma, receiver.carrier_hz));
    const double most = most_of(seen, receiver) * std::abs(receiver.pulse.at(0));
    for (const double tolerance : {1e-2, 1e-4, 1e-6}) {
      const ChannelSignals signals = smooth_signals(seen, receiver, model, all_rigid, tolerance);
      const double off = largest_difference(signals, exact);
      EXPECT_LE(off, (tolerance + 3e-6) * most) << size << ' ' << height;
      // Echoes that cancel also have no error.
      EXPECT_LE(off, (4 * tolerance + 2e-5) * peak_of(signals)) << size << ' ' << height;
    }
  }
}

// The echoes of the edges come later than that of the image.
TEST(SmoothSignals, OfALargePlaneAreItsImage) {
  const double height = 1.5, sigma = 3e-5;
  const VisiblePolygons seen = patches_of(test::flat_seabed(height), {{-2, -2}, {2, -2}, {2, 2}, {-2, 2}});
  SmoothSurface surface{.reflection = {-0.6, 0.2}};
  for (const glm::dvec3 rx : {glm::dvec3(0), glm::dvec3(0.4, 0.1, -0.5)}) {
    CoherentReceiver receiver = receiver_of({{glm::dvec3(0), rx}}, sigma);
    const double image = std::hypot(2 * height + rx.z, rx.x, rx.y);
    receiver.times.first_s = 1.2e-3 + receiver.pulse.begin_s;
    receiver.times.count = std::size_t(1.8e-3 * receiver.times.rate_hz);
    const double k = 2 * pi * receiver.carrier_hz / sound_speed;
    EchoModel model;
    model.absorption_db_per_m = 0.05;
    for (const double tolerance : {1e-2, 1e-3}) {
      const ChannelSignals signals = smooth_signals(
          seen, receiver, model, [&](FacetId) { return &surface; }, tolerance);
      double worst = 0;
      for (std::size_t n = 0; n < signals.samples; ++n)
        worst =
            std::max(worst, std::abs(signals.at(0, n) -
                                     surface.reflection * std::pow(10, -0.05 * image / 20) / image *
                                         phasor(k * image) *
                                         receiver.pulse.at(receiver.times.time_s(n) - image / sound_speed)));
      EXPECT_LT(worst, tolerance * peak_of(signals)) << tolerance;
    }
  }
}

/// Returns the amplitude at the carrier from a pulse that is longer than the body.
Complex at_carrier(const ChannelSignals& signals, const CoherentReceiver& receiver, std::size_t channel = 0) {
  Complex received = 0, sent = 0;
  for (std::size_t k = 0; k < signals.samples; ++k) received += signals.at(channel, k);
  const int many = 20000;
  for (int k = 0; k <= many; ++k)
    sent += receiver.pulse.at(receiver.pulse.begin_s +
                              (receiver.pulse.end_s - receiver.pulse.begin_s) * k / many);
  sent *= (receiver.pulse.end_s - receiver.pulse.begin_s) / many;
  return received / receiver.times.rate_hz / sent;
}

// ka 20: Kirchhoff's sphere has |f| = 0.491128297 a. The value of its facets is slightly different.
TEST(SmoothSignals, OfASphereOfManyFacetsAreItsTargetStrength) {
  const WorldGrid grid(20, glm::dvec3(0));
  const double radius = 0.1, range = 30;
  const glm::dvec3 centre(0.3, range, -0.2);
  FacetMesh ball;
  test::add_sphere(ball, grid.snap(centre), radius / grid.unit_m(), 4);
  ball.material.resize(ball.facets.size(), 0);
  ball.component.resize(ball.facets.size(), 0);
  const SceneTree tree(ball);
  TubeSet tubes{grid.snap(glm::dvec3(0)), {}, {}, 1e9};
  AngularGrid angles{{-0.05, 0.0, 0.05},
                     {-0.05, 0.05},
                     glm::dmat3(glm::dvec3(0, 1, 0), glm::dvec3(1, 0, 0), glm::dvec3(0, 0, 1))};
  append_tubes(tubes, angles);
  const History history = TubeEngine(ball, tree, grid.unit_m(), {}).trace(tubes);
  EchoModel model;
  model.path.tx.apex_m = grid.to_metres(tubes.apex);
  const VisiblePolygons seen = visible_polygons(history, model);
  const double k = 20 / radius;
  CoherentReceiver receiver = receiver_of({{glm::dvec3(0), glm::dvec3(0)}}, 4e-4, k * sound_speed / (2 * pi));
  listen(receiver, seen);
  const Complex received = at_carrier(smooth_signals(seen, receiver, model, all_rigid), receiver);
  EXPECT_NEAR(20 * std::log10(std::abs(received) * glm::dot(centre, centre) / (0.491128297 * radius)), 0,
              0.25);
  SmoothAmplitude amplitudes(std::span(&k, 1), 0);
  Complex sum = 0;
  amplitudes.add(history, all_rigid, std::span(&sum, 1));
  EXPECT_LT(std::abs(received - sum), 1e-3 * std::abs(sum));
}

// Law Q7.
TEST(SmoothSignals, OfPolygonsInPartsAddUp) {
  const FacetPlane plane{glm::normalize(glm::dvec3(0.2, -0.3, 1)), 2};
  const Polygon2 polygon{{-0.2, -0.1}, {0.5, -0.3}, {0.7, 0.4}, {0.1, 0.6}};
  const VisiblePolygons whole = patches_of(plane, polygon);
  VisiblePolygons parts;
  for (std::size_t k = 0; k < 4; ++k)
    add_patch(parts, FacetId(k), plane, {polygon[k], polygon[(k + 1) % 4], {0.21, 0.13}});
  CoherentReceiver receiver = receiver_of({{glm::dvec3(0), glm::dvec3(0.1, 0, 0.2)}});
  listen(receiver, whole);
  const EchoModel model;
  for (const double tolerance : {1e-4, 1e-8}) {
    const ChannelSignals one = smooth_signals(whole, receiver, model, all_rigid, tolerance),
                         sum = smooth_signals(parts, receiver, model, all_rigid, tolerance);
    EXPECT_LT(largest_difference(sum, one.value), (10 * tolerance + 3e-6) * peak_of(one)) << tolerance;
  }
}

// Law Q5.
TEST(SmoothSignals, EndsMayBeExchanged) {
  VisiblePolygons seen =
      patches_of({glm::normalize(glm::dvec3(0.2, -0.3, 1)), 2}, {{-0.2, -0.1}, {0.5, -0.3}, {0.7, 0.4}});
  add_patch(seen, 1, test::flat_seabed(3), {{1, 1}, {1.02, 1}, {1.01, 1.03}});
  const Directivity line{Directivity::Kind::line, {1, 0, 0}, false, 0, 1.5};
  const glm::dvec3 a(0.1, 0.2, 0.3), b(-0.3, 0.1, -0.1);
  CoherentReceiver receiver = receiver_of({{a, b, line, {}}, {b, a, {}, line}});
  listen(receiver, seen);
  EchoModel model;
  model.absorption_db_per_m = 0.1;
  const SmoothSurface bottom{.fluid = fluid_sediment(1.8, 1.1, 0.5), .roughness_m = 1e-3};
  const ChannelSignals signals = smooth_signals(
      seen, receiver, model, [&](FacetId) { return &bottom; }, 1e-7);
  double worst = 0;
  for (std::size_t k = 0; k < signals.samples; ++k)
    worst = std::max(worst, std::abs(signals.at(0, k) - signals.at(1, k)));
  EXPECT_GT(peak_of(signals), 0);
  EXPECT_LT(worst, 1e-6 * peak_of(signals));
}

TEST(SmoothSignals, HaveTheSameBitsForAnyNumberOfThreads) {
  std::mt19937_64 random(4);
  std::uniform_real_distribution<double> unit(-1, 1);
  VisiblePolygons seen;
  for (FacetId n = 0; n < 600; ++n)
    add_patch(seen, n, test::random_plane(random, 3 + unit(random)),
              test::random_convex(random, {unit(random), unit(random)}, 0.1, 0.05));
  CoherentReceiver receiver = receiver_of({});
  for (int k = 0; k < 5; ++k) receiver.channels.push_back({glm::dvec3(0), {0.02 * k, 0, 0}});
  listen(receiver, seen);
  const auto of = [&](std::size_t threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    return smooth_signals(seen, receiver, {}, all_rigid, 1e-3).value;
  };
  const std::vector<Complex> one = of(1);
  EXPECT_EQ(of(4), one);
  EXPECT_EQ(of(3), one);
}

// Compares a transmitted sweep with the edges. Its matched filter finds the plate at its position.
TEST(SmoothSignals, OfASweepAreCompressedByItsFilter) {
  const double sigma = 3e-4, sweep = 1.5e7, height = 3;
  const VisiblePolygons seen = patches_of(test::flat_seabed(height), {{0.6, -0.4}, {1.1, -0.3}, {0.8, 0.5}});
  CoherentReceiver receiver = receiver_of({{glm::dvec3(0), glm::dvec3(0.1)}}, sigma);
  const TransmittedPulse wave = gaussian_wave(sigma, receiver.carrier_hz, sweep);
  receiver.pulse.envelope = [=, carrier = receiver.carrier_hz](double t) {
    return wave.pressure(t) * phasor(2 * pi * carrier * t);
  };
  receiver.pulse.bandwidth_hz = 2 * std::hypot(sweep * sigma, 1 / (2 * pi * sigma)) * 5.3;
  receiver.times.rate_hz = 1.05 * receiver.pulse.bandwidth_hz;
  listen(receiver, seen);
  const ChannelSignals signals = smooth_signals(seen, receiver, {}, all_rigid, 1e-5);
  EXPECT_LT(largest_difference(signals, by_edges(seen, receiver, wave)), 5e-5 * peak_of(signals));

  const double far = 20;
  const VisiblePolygons plate =
      patches_of(test::flat_seabed(far), {{-.05, -.03}, {.05, -.03}, {.05, .03}, {-.05, .03}});
  receiver.channels = {{glm::dvec3(0), glm::dvec3(0)}};
  listen(receiver, plate);
  const ChannelSignals echo = smooth_signals(plate, receiver, {}, all_rigid);
  const auto compressed = [&](double delay_s) {
    Complex sum = 0;
    for (std::size_t k = 0; k < echo.samples; ++k)
      sum += echo.at(0, k) * std::conj(receiver.pulse.at(receiver.times.time_s(k) - delay_s)) /
             receiver.times.rate_hz;
    return sum;
  };
  const double delay = 2 * far / sound_speed, step = 1 / receiver.times.rate_hz;
  // |f| = A / lambda = 0.4 m; the quadratic phase over the plate reduces it by 1 %.
  EXPECT_NEAR(std::abs(compressed(delay)), 0.4 / (far * far), 0.02 * 0.4 / (far * far));
  EXPECT_GT(std::abs(compressed(delay)), std::abs(compressed(delay + step / 4)));
  EXPECT_GT(std::abs(compressed(delay)), std::abs(compressed(delay - step / 4)));
}

TEST(SmoothSignals, OfRoughFacetsAreSilent) {
  VisiblePolygons seen = patches_of(test::flat_seabed(3), {{1, 1}, {1.5, 1}, {1.3, 1.7}});
  add_patch(seen, 1, test::flat_seabed(2), {{-1, -1}, {-0.7, -1}, {-0.9, -0.7}});
  CoherentReceiver receiver = receiver_of({{glm::dvec3(0), glm::dvec3(0)}});
  listen(receiver, seen);
  const ChannelSignals none =
      smooth_signals(seen, receiver, {}, [](FacetId) { return static_cast<const SmoothSurface*>(nullptr); });
  EXPECT_EQ(peak_of(none), 0);
  EXPECT_EQ(none.value.size(), receiver.times.count);
  const auto second = [](FacetId facet) { return facet == 1 ? &rigid : nullptr; };
  const SplitPolygons split = split_polygons(seen, [&](FacetId facet) { return second(facet) != nullptr; });
  ASSERT_EQ(split.smooth.patches.size(), 1u);
  ASSERT_EQ(split.rough.patches.size(), 1u);
  EXPECT_EQ(split.smooth.patches[0].facet, 1u);
  EXPECT_NEAR(split.smooth.area_m2() + split.rough.area_m2(), seen.area_m2(), 1e-15);
  EXPECT_EQ(smooth_signals(split.smooth, receiver, {}, all_rigid).value,
            smooth_signals(seen, receiver, {}, second).value);
  // Nothing is visible from behind.
  receiver.channels[0].receive_m = {0, 0, -10};
  EXPECT_EQ(peak_of(smooth_signals(seen, receiver, {}, all_rigid)), 0);
}

// The pattern takes effect in the direction of the specular point. Pieces that are as small as the patterns
// require leave little of their borders.
TEST(SmoothSignals, PatternsWeighTheImage) {
  const double height = 1.5;
  const VisiblePolygons seen = patches_of(test::flat_seabed(height), {{-2, -2}, {2, -2}, {2, 2}, {-2, 2}});
  const Directivity line{Directivity::Kind::line, {1, 0, 0}, false, 0, 3};
  const glm::dvec3 rx(0.6, 0.3, 0);
  CoherentReceiver receiver = receiver_of({{glm::dvec3(0), rx, line, {}}}, 3e-5);
  const double image = std::hypot(2 * height, rx.x, rx.y), k = 2 * pi * receiver.carrier_hz / sound_speed;
  receiver.times.first_s = 1.2e-3 + receiver.pulse.begin_s;
  receiver.times.count = std::size_t(1.8e-3 * receiver.times.rate_hz);
  const ChannelSignals signals = smooth_signals(seen, receiver, {}, all_rigid, 1e-4);
  const double pattern = amplitude_pattern(line, glm::dvec3(rx.x / 2, rx.y / 2, -height) / (image / 2));
  double worst = 0;
  for (std::size_t n = 0; n < signals.samples; ++n)
    worst = std::max(worst, std::abs(signals.at(0, n) -
                                     pattern / image * phasor(k * image) *
                                         receiver.pulse.at(receiver.times.time_s(n) - image / sound_speed)));
  EXPECT_LT(worst, 0.015 * std::abs(receiver.pulse.at(0)) / image);
  EXPECT_NEAR(peak_of(signals), pattern * std::abs(receiver.pulse.at(0)) / image, 0.02 * peak_of(signals));
}

TEST(SmoothSignals, RefuseWhatIsNone) {
  const VisiblePolygons seen = patches_of(test::flat_seabed(3), {{1, 1}, {1.5, 1}, {1.3, 1.7}});
  CoherentReceiver receiver = receiver_of({{glm::dvec3(0), glm::dvec3(0)}});
  for (const double tolerance : {0.0, -1e-3, 0.5, double(NAN)})
    EXPECT_THROW(smooth_signals(seen, receiver, {}, all_rigid, tolerance), std::invalid_argument);
  receiver.carrier_hz = receiver.pulse.bandwidth_hz / 2;
  EXPECT_THROW(smooth_signals(seen, receiver, {}, all_rigid), std::invalid_argument);
  receiver.carrier_hz *= 1.01;
  EXPECT_NO_THROW(smooth_signals(seen, receiver, {}, all_rigid));
  receiver.channels.clear();
  EXPECT_THROW(smooth_signals(seen, receiver, {}, all_rigid), std::invalid_argument);
}

}  // namespace
}  // namespace tubefoot
