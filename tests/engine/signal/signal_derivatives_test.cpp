// SPDX-License-Identifier: GPL-3.0-or-later
// Tests derivatives of signals of smooth facets: the image of a large plane in closed form, central
// differences of signals, laws, and invalid arguments.
#include <gtest/gtest.h>

#include <random>

#include "engine/scattering/echo_model.hpp"
#include "fixtures/world/smooth_plates.hpp"
#include "geometry/numbers/scalars.hpp"

namespace tubefoot {
namespace {

using test::Polygon2;
using namespace test::smooth_plates;

/// Polygons and channels that are functions of a parameter.
struct MovingPlates {
  std::vector<FacetPlane> planes;
  std::vector<std::vector<glm::dvec3>> corners;
  CoherentReceiver receiver;
  EchoModel model;
  SignalParameter by;

  void add(const FacetPlane& plane, const Polygon2& polygon) {
    planes.push_back(plane);
    corners.push_back(test::on_plane(plane, polygon));
  }
  /// Moves each plane at random, and each corner with its plane and along it.
  void move(std::mt19937_64& random) {
    std::uniform_real_distribution<double> unit(-1, 1);
    const auto vector = [&] { return glm::dvec3(unit(random), unit(random), unit(random)); };
    for (std::size_t n = 0; n < planes.size(); ++n) {
      const glm::dvec3 normal = planes[n].normal, turn = vector();
      SignalParameter::Polygon moved;
      moved.normal = glm::cross(turn, normal);
      moved.distance = unit(random);
      for (const glm::dvec3& corner : corners[n]) {
        glm::dvec3 along = vector();
        along -= glm::dot(along, normal) * normal;
        // normal . corner = -distance
        moved.corners.push_back(along - (moved.distance + glm::dot(moved.normal, corner)) * normal);
      }
      by.polygons.push_back(moved);
    }
    for (std::size_t c = 0; c < receiver.channels.size(); ++c) {
      by.transmit.push_back(vector());
      by.receive.push_back(vector());
    }
  }
  VisiblePolygons seen_at(double parameter) const {
    VisiblePolygons seen;
    for (std::size_t n = 0; n < planes.size(); ++n) {
      std::vector<glm::dvec3> moved = corners[n];
      for (std::size_t k = 0; k < moved.size() && !by.polygons.empty(); ++k)
        moved[k] += parameter * by.polygons[n].corners[k];
      // The plane of the first three corners.
      const glm::dvec3 normal =
          glm::normalize(glm::cross(moved[1] - moved[0], moved[2] - moved[0])) *
          (glm::dot(glm::cross(moved[1] - moved[0], moved[2] - moved[0]), planes[n].normal) > 0 ? 1.0 : -1.0);
      VisiblePolygon patch{FacetId(n), normal, -glm::dot(normal, moved[0])};
      patch.first_corner = std::uint32_t(seen.corners_m.size());
      patch.corner_count = std::uint32_t(moved.size());
      seen.corners_m.insert(seen.corners_m.end(), moved.begin(), moved.end());
      seen.patches.push_back(patch);
    }
    return seen;
  }
  ChannelSignals at(double parameter, double tolerance) const {
    CoherentReceiver moved = receiver;
    for (std::size_t c = 0; c < moved.channels.size(); ++c) {
      if (!by.transmit.empty()) moved.channels[c].transmit_m += parameter * by.transmit[c];
      if (!by.receive.empty()) moved.channels[c].receive_m += parameter * by.receive[c];
    }
    moved.sound_speed_m_s *= 1 + parameter * by.by_sound_speed;
    EchoModel echo_model = model;
    echo_model.absorption_db_per_m += parameter * by.by_absorption;
    return smooth_signals(seen_at(parameter), moved, echo_model, all_rigid, tolerance);
  }
  /// Central difference of fourth order.
  std::vector<std::complex<double>> difference(double step, double tolerance) const {
    const ChannelSignals a = at(step, tolerance), b = at(-step, tolerance), c = at(2 * step, tolerance),
                         d = at(-2 * step, tolerance);
    std::vector<std::complex<double>> slope(a.value.size());
    for (std::size_t k = 0; k < slope.size(); ++k)
      slope[k] = (8.0 * (a.value[k] - b.value[k]) - (c.value[k] - d.value[k])) / (12 * step);
    return slope;
  }
  ChannelSignals derivative(double tolerance) const {
    return smooth_signal_derivatives(seen_at(0), receiver, model, all_rigid, std::span(&by, 1), tolerance)
        .front();
  }
};

double largest_gap(const std::vector<std::complex<double>>& a, const std::vector<std::complex<double>>& b) {
  double worst = 0;
  for (std::size_t k = 0; k < a.size(); ++k) worst = std::max(worst, std::abs(a[k] - b[k]));
  return worst;
}

MovingPlates random_plates(std::mt19937_64& random, int n) {
  std::uniform_real_distribution<double> unit(0, 1);
  MovingPlates plates;
  for (int patch = 0; patch < 3; ++patch) {
    const double size = std::pow(10, -1.5 + 1.2 * unit(random));
    Polygon2 triangle = test::random_convex(random, {unit(random) - 0.5, unit(random) - 0.5}, size, size / 2);
    triangle.resize(3);
    plates.add(test::random_plane(random, 1 + unit(random)), triangle);
  }
  const glm::dvec3 apart = n % 2 == 0 ? glm::dvec3(0) : glm::dvec3(0.2, -0.1, 0.1);
  plates.receiver = receiver_of({{glm::dvec3(0), apart}, {glm::dvec3(0.05, 0, 0), apart}}, 3e-5, 40e3);
  listen(plates.receiver, plates.seen_at(0));
  plates.model.absorption_db_per_m = 0.1;
  return plates;
}

TEST(SignalDerivatives, EqualCentralDifferences) {
  const unsigned seed = 31;
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  std::mt19937_64 random(seed);
  for (int n = 0; n < 6; ++n) {
    MovingPlates plates = random_plates(random, n);
    plates.move(random);
    const ChannelSignals derivative = plates.derivative(1e-8);
    EXPECT_LT(largest_gap(derivative.value, plates.difference(1e-5, 1e-9)), 1e-5 * peak_of(derivative)) << n;
  }
}

TEST(SignalDerivatives, BySoundSpeedAndAbsorptionEqualCentralDifferences) {
  const unsigned seed = 32;
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  std::mt19937_64 random(seed);
  MovingPlates plates = random_plates(random, 1);
  plates.by.by_sound_speed = 0.1;
  ChannelSignals derivative = plates.derivative(1e-8);
  EXPECT_LT(largest_gap(derivative.value, plates.difference(2e-4, 1e-9)), 1e-5 * peak_of(derivative));
  plates.by = {};
  plates.by.by_absorption = 1;
  derivative = plates.derivative(1e-8);
  EXPECT_LT(largest_gap(derivative.value, plates.difference(1e-2, 1e-9)), 1e-5 * peak_of(derivative));
}

// The truncation of the pulse limits the smallest error.
TEST(SignalDerivatives, MeetTheirTolerance) {
  const unsigned seed = 33;
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  std::mt19937_64 random(seed);
  for (int n = 0; n < 6; ++n) {
    MovingPlates plates = random_plates(random, n);
    plates.move(random);
    const ChannelSignals exact = plates.derivative(1e-9);
    for (const double tolerance : {1e-2, 1e-4, 1e-6})
      EXPECT_LT(largest_gap(plates.derivative(tolerance).value, exact.value),
                (tolerance + 1e-6) * peak_of(exact))
          << n << ' ' << tolerance;
  }
}

// Law: a rigid motion of plates and channels changes nothing.
TEST(SignalDerivatives, OfARigidMotionAreZero) {
  const unsigned seed = 34;
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  std::mt19937_64 random(seed);
  MovingPlates plates = random_plates(random, 1);
  const glm::dvec3 turn(0.3, -0.5, 0.8), shift(0.2, 0.4, -0.1);
  const auto moved = [&](glm::dvec3 at) { return shift + glm::cross(turn, at); };
  double separate = 0;
  for (const bool rigid_motion : {false, true}) {
    plates.by = {};
    for (std::size_t n = 0; n < plates.planes.size(); ++n) {
      SignalParameter::Polygon polygon{
          {}, glm::cross(turn, plates.planes[n].normal), -glm::dot(plates.planes[n].normal, shift)};
      for (const glm::dvec3& corner : plates.corners[n]) polygon.corners.push_back(moved(corner));
      plates.by.polygons.push_back(polygon);
    }
    for (const SignalChannel& channel : plates.receiver.channels) {
      if (!rigid_motion) break;
      plates.by.transmit.push_back(moved(channel.transmit_m));
      plates.by.receive.push_back(moved(channel.receive_m));
    }
    const double peak = peak_of(plates.derivative(1e-8));
    if (rigid_motion)
      EXPECT_LT(peak, 1e-10 * separate);
    else
      separate = peak;
  }
}

// The image of a plane at the distance h is exp(2 i k h) / (2 h) g(t - 2 h / c).
TEST(SignalDerivatives, OfALargePlaneAreThoseOfItsImage) {
  const double height = 1.5, sigma = 3e-5;
  MovingPlates plates;
  plates.add(test::flat_seabed(height), {{-2, -2}, {2, -2}, {2, 2}, {-2, 2}});
  plates.receiver = receiver_of({{glm::dvec3(0), glm::dvec3(0)}}, sigma);
  plates.receiver.times.first_s = 1.6e-3 + plates.receiver.pulse.begin_s;
  plates.receiver.times.count = std::size_t(0.9e-3 * plates.receiver.times.rate_hz);
  plates.by.transmit = plates.by.receive = {{0, 0, 1}};
  const ChannelSignals derivative = plates.derivative(1e-6);
  const double k = 2 * pi * plates.receiver.carrier_hz / sound_speed, path = 2 * height;
  double worst = 0;
  for (std::size_t n = 0; n < derivative.samples; ++n) {
    const double t = plates.receiver.times.time_s(n) - path / sound_speed;
    const std::complex<double> exact =
        2.0 * phasor(k * path) / path *
        (std::complex<double>(-1 / path, k) + t / (sigma * sigma) / sound_speed) *
        plates.receiver.pulse.at(t);
    worst = std::max(worst, std::abs(derivative.at(0, n) - exact));
  }
  EXPECT_LT(worst, 1e-5 * peak_of(derivative));
}

// The foot point of both ends lies on an edge, or on a corner. There, half or a quarter of the image arrives.
TEST(SignalDerivatives, AreContinuousWhereTheShortestPathMeetsTheBorder) {
  for (const Polygon2& polygon : {Polygon2{{0, -0.4}, {0.9, -0.3}, {0.8, 0.5}, {0, 0.6}},
                                  Polygon2{{0, 0}, {0.9, -0.3}, {0.8, 0.5}, {0.1, 0.6}}}) {
    MovingPlates plates;
    plates.add(test::flat_seabed(1.5), polygon);
    plates.receiver = receiver_of({{glm::dvec3(0), glm::dvec3(0)}}, 3e-5, 40e3);
    // The jumps at the ends of a truncated pulse would add errors that grow near the border.
    plates.receiver.pulse = gaussian_pulse(3e-5, 1e-10);
    plates.receiver.times.rate_hz = 1.05 * plates.receiver.pulse.bandwidth_hz;
    listen(plates.receiver, plates.seen_at(0));
    plates.by.transmit = plates.by.receive = {{0.8, 0.1, 0.2}};
    const ChannelSignals derivative = plates.derivative(1e-8);
    EXPECT_LT(largest_gap(derivative.value, plates.difference(2e-5, 1e-9)), 2e-4 * peak_of(derivative));
  }
}

TEST(SignalDerivatives, RejectInvalidArguments) {
  std::mt19937_64 random(1);
  MovingPlates plates = random_plates(random, 1);
  const auto rejected = [](const MovingPlates& changed, const SmoothSurface& surface) {
    EXPECT_THROW(smooth_signal_derivatives(
                     changed.seen_at(0), changed.receiver, changed.model, [&](FacetId) { return &surface; },
                     std::span(&changed.by, 1)),
                 std::invalid_argument);
  };
  MovingPlates jump = plates;
  jump.receiver.pulse.breaks = {{0, 1, 0}};
  rejected(jump, rigid);
  MovingPlates without_slope = plates;
  without_slope.receiver.pulse.slope = nullptr;
  rejected(without_slope, rigid);
  rejected(plates, {.roughness_m = 1e-3});
  rejected(plates, {.fluid = fluid_sediment(1.8, 1.1, 0.5)});
  MovingPlates pattern = plates;
  pattern.receiver.channels[1].receive = {Directivity::Kind::line, {1, 0, 0}, false, 0, 1.5};
  rejected(pattern, rigid);
}

}  // namespace
}  // namespace tubefoot
