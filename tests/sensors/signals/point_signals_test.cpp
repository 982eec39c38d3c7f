// SPDX-License-Identifier: GPL-3.0-or-later
// Compares signals of points with the closed form in long double: two-way delays of platforms at rest and
// in motion.
#include "sensors/signals/point_signals.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "fixtures/lobes.hpp"
#include "fixtures/refusal.hpp"

namespace tubefoot {
namespace {

using Complex = std::complex<double>;
using Real = long double;
using test::c;
struct LongVector {
  Real x, y, z;
};

constexpr Real two_pi = 2 * std::numbers::pi_v<Real>;
/// 1e-9 of a wavelength, which is one turn
const double phase_tolerance = 2 * std::numbers::pi * 1e-9;

LongVector wide(glm::dvec3 v) { return {v.x, v.y, v.z}; }
LongVector difference(LongVector a, LongVector b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
LongVector moved(LongVector a, LongVector v, Real t) { return {a.x + v.x * t, a.y + v.y * t, a.z + v.z * t}; }
Real dot(LongVector a, LongVector b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
Real length(LongVector a) { return std::sqrt(dot(a, a)); }

/// Difference of the phase of a value from `cycles` turns, between -pi and pi.
double phase_error(Complex value, Real cycles) {
  const auto expected = static_cast<double>((cycles - std::floor(cycles)) * two_pi);
  const Complex turned = value * std::polar(1.0, -expected);
  return std::atan2(turned.imag(), turned.real());
}

VehicleMotion at_rest(std::vector<double> starts = {0}) {
  return {{{0, {{0, 0, -5}, attitude_from_angles(0.3, 0.05, -0.1)}}}, std::move(starts)};
}

TEST(PointSignals, HaveThePhaseOfTheExactDelayToABillionthOfAWavelength) {
  for (const double frequency_hz : {30e3, 455e3, 1.8e6}) {
    const auto waveform = continuous_wave_pulse(frequency_hz, 1e-3);
    const ElementArray array = line_array(5, {0.1, 0.02, 0}, {0.3, -0.2, 0.1});
    const VehicleMotion motion = at_rest();
    const std::vector<PointScatterer> targets{{{21.3, 33.1, -17.7}, {0.6, -0.8}}};
    const SignalSampling sampling{frequency_hz, 20e3, 0.04, 600};
    const ElementSignals signals = point_signals(targets, array, waveform, sampling, motion, c);
    const Pose pose = motion.ping_pose(0);
    const auto place = [&](glm::dvec3 body) { return wide(pose.position_m + pose.attitude * body); };
    const LongVector x = wide(targets[0].position_m);
    int echoes = 0;
    for (std::size_t e = 0; e < 5; ++e) {
      const Real tx = length(difference(x, place(array.transmitter_m))),
                 rx = length(difference(x, place(array.receivers_m[e]))), tau = (tx + rx) / c;
      for (std::size_t k = 0; k < sampling.samples; ++k) {
        const Complex value = signals.channel(0, e)[k];
        const Real after = Real(sampling.time_s(k)) - tau;
        if (after < 0 || after > 1e-3L) {
          EXPECT_EQ(value, 0.0);
          continue;
        }
        ++echoes;
        EXPECT_NEAR(std::abs(value) * double(tx * rx), std::sqrt(1000.0), 1e-9);
        EXPECT_LT(std::abs(phase_error(value / targets[0].strength, tau * frequency_hz)), phase_tolerance);
      }
    }
    EXPECT_EQ(echoes, 5 * 20);
  }
}

/// Transmit time of the sound that arrives at t, for uniform motion: the root of a quadratic equation.
Real emission(LongVector from, LongVector velocity, LongVector x, Real there) {
  const LongVector d = difference(x, from);  // |d - v t| = c (there - t)
  const Real a = Real(c) * c - dot(velocity, velocity), b = Real(c) * c * there - dot(d, velocity),
             e = Real(c) * c * there * there - dot(d, d);
  return (b - std::sqrt(b * b - a * e)) / a;
}

TEST(PointSignals, OfMovingPlatformsHaveTheExactDelayOfBothEnds) {
  constexpr double frequency_hz = 455e3;
  const glm::dvec3 velocity(1.5, 4, -0.5), begin(0, 0, -5);
  const glm::dquat attitude = attitude_from_angles(0.3, 0.05, -0.1);
  const std::vector<double> starts{0.125, 0.5, 2};
  const auto track = [&](const std::vector<double>& times) {
    std::vector<Trajectory::Sample> samples;
    for (const double t : times) samples.push_back({t, {begin + velocity * t, attitude}});
    return samples;
  };
  const VehicleMotion motion(track({0, 4}), starts, false);
  const auto waveform = continuous_wave_pulse(frequency_hz, 2e-3);
  const ElementArray array = line_array(3, {0.4, 0, 0}, {0.3, -0.2, 0.1});
  const std::vector<PointScatterer> targets{{{21.3, 33.1, -17.7}, 1}};
  const SignalSampling sampling{frequency_hz, 50e3, 0.04, 1000};
  const ElementSignals signals = point_signals(targets, array, waveform, sampling, motion, c);
  const LongVector x = wide(targets[0].position_m), v = wide(velocity);
  int echoes = 0;
  double worst = 0, hop_error = 0;
  for (std::size_t p = 0; p < starts.size(); ++p)
    for (std::size_t e = 0; e < 3; ++e)
      for (std::size_t k = 0; k < sampling.samples; ++k) {
        const Real t = sampling.time_s(k);
        const auto start = [&](glm::dvec3 body) {
          return moved(wide(begin + attitude * body), v, starts[p]);
        };
        const Real rx = length(difference(x, moved(start(array.receivers_m[e]), v, t))),
                   sent = emission(start(array.transmitter_m), v, x, t - rx / c);
        const Complex value = signals.channel(p, e)[k];
        if (sent < 0 || sent > 2e-3L) {
          EXPECT_EQ(value, 0.0);
          continue;
        }
        ++echoes;
        worst = std::max(worst, std::abs(phase_error(value, (t - sent) * frequency_hz)));
        const Real hop = (length(difference(x, start(array.transmitter_m))) +
                          length(difference(x, start(array.receivers_m[e])))) /
                         c;
        hop_error = std::max(hop_error, std::abs(phase_error(value, hop * frequency_hz)));
        EXPECT_NEAR(std::abs(value) * double(rx * (Real(c) * (t - sent) - rx)), std::sqrt(500.0), 1e-8);
      }
  EXPECT_GE(echoes, 9 * 99);
  EXPECT_LT(worst, phase_tolerance);
  EXPECT_GT(hop_error, 1);  // the error of stop-and-hop is several turns here
  // The same track in other pieces uses the code for general tracks.
  const VehicleMotion pieces(track({0, 0.17, 0.51, 2.03, 4}), starts, false);
  const ElementSignals same = point_signals(targets, array, waveform, sampling, pieces, c);
  for (std::size_t k = 0; k < same.pressure.size(); ++k)
    EXPECT_LT(std::abs(same.pressure[k] - signals.pressure[k]), 1e-9 * std::sqrt(500.0) / 700) << k;
}

TEST(PointSignals, OfATurningVehicleSatisfyTheEquationOfTheDelay) {
  const std::vector<Trajectory::Sample> track{{0, {{0, 0, 0}, attitude_from_angles(0, 0, 0)}},
                                              {0.1, {{0.3, 0.1, 0}, attitude_from_angles(0.2, 0.05, 0.1)}},
                                              {1, {{1, 2, 0.1}, attitude_from_angles(1, 0, -0.1)}}};
  const VehicleMotion motion(track, {0.06, 0.3}, false);
  const Trajectory clock(track);
  const glm::dvec3 x(20, 30, -10), tx_body(0.5, 1, 0), rx_body(-0.5, -1, 0.3);
  const auto along = [&](double t, glm::dvec3 body) {
    const Pose pose = clock.at(t);
    return pose.position_m + pose.attitude * body;
  };
  for (const std::size_t ping : {0u, 1u}) {
    const double start = motion.ping_start_s()[ping];
    const PlaceMotion tx(motion, ping, tx_body, 0.2), rx(motion, ping, rx_body, 0.2);
    const TwoWayPath path = path_emitted_at(0.004, tx, x, rx, c);
    const double there = 0.004 + glm::distance(along(start + 0.004, tx_body), x) / c;
    EXPECT_NEAR(path.received_s, there + glm::distance(along(start + path.received_s, rx_body), x) / c,
                1e-16);
    const TwoWayPath back = path_received_at(path.received_s, tx, x, rx, c);
    EXPECT_NEAR(back.emitted_s, 0.004, 1e-16);
    EXPECT_NEAR(back.tx_m + back.rx_m, back.delay_s() * c, 1e-12);
  }
}

TEST(PointSignals, AreDopplerShiftedByBothEnds) {
  constexpr double frequency_hz = 100e3, speed = 20;
  const VehicleMotion motion({{0, {}}, {1, {{0, speed, 0}, {1, 0, 0, 0}}}}, {0.25}, false);
  const SignalSampling sampling{frequency_hz, 40e3, 0, 4000};
  const ElementSignals signals =
      point_signals({{{0, 60, 0}, 1}}, line_array(1, {0, 0, 0}), continuous_wave_pulse(frequency_hz, 5e-3),
                    sampling, motion, c);
  const auto channel = signals.channel(0, 0);
  double turns = 0;
  int steps = 0;
  for (std::size_t k = 1; k < channel.size(); ++k) {
    if (channel[k - 1] == 0.0 || channel[k] == 0.0) continue;
    const Complex turn = channel[k] * std::conj(channel[k - 1]);
    turns -= std::atan2(turn.imag(), turn.real()) / (2 * std::numbers::pi);
    ++steps;
  }
  ASSERT_GT(steps, 150);
  const double shifted_hz = frequency_hz * (c + speed) / (c - speed);
  EXPECT_NEAR(turns * sampling.rate_hz / steps, shifted_hz - frequency_hz, 1e-5);
  EXPECT_NEAR((steps + 1) / sampling.rate_hz, 5e-3 * (c - speed) / (c + speed), 2 / sampling.rate_hz);
}

TEST(PointSignals, AddUp) {
  const auto waveform = linear_chirp(90e3, 110e3, 2e-3, 0.2);
  const ElementArray array = line_array(4, {0.01, 0, 0});
  const SignalSampling sampling{100e3, 40e3, 0, 2000};
  const PointScatterer a{{3, 20, 1}, {0.5, 0.1}}, b{{-2, 20.1, 0}, {0, 2}};
  const auto of = [&](const std::vector<PointScatterer>& targets) {
    return point_signals(targets, array, waveform, sampling, at_rest({0, 1}), c).pressure;
  };
  const auto first = of({a}), second = of({b}), both = of({a, b});
  ASSERT_EQ(both.size(), 2u * 4 * 2000);
  for (std::size_t k = 0; k < both.size(); ++k) EXPECT_EQ(both[k], first[k] + second[k]);
}

// Coordinates of 5000 km and clocks of 1970 round more than the last step moves. No element is as fast as
// sound.
TEST(PointSignals, OfMovingVehiclesAreFoundWhereverFrameAndClockBegin) {
  const auto waveform = continuous_wave_pulse(100e3, 1e-3);
  const SignalSampling sampling{100e3, 10e3, 0, 4000};
  const ElementArray array = line_array(3, {0.1, 0.03, 0});
  for (const double start_s : {0.0, 1.7e9})
    for (const double far_m : {0.0, 1e5, 5e6})
      for (const double turn : {0.0, 0.2})
        for (const double speed : {1e-9, 0.01, 2.0, -15.0}) {
          const glm::dvec3 from(far_m, far_m / 3, -5);
          const std::vector<Trajectory::Sample> track{
              {start_s - 1, {from, {1, 0, 0, 0}}},
              {start_s + 9,
               {from + glm::dvec3(0.3 * speed, 10 * speed, 0), attitude_from_angles(turn, 0, 0)}}};
          const VehicleMotion motion(track, {start_s + 3}, false);
          const auto signals =
              point_signals({{from + glm::dvec3(12, 200, -3), 1}}, array, waveform, sampling, motion, c);
          double energy = 0;
          for (const Complex& value : signals.pressure) energy += std::norm(value);
          EXPECT_GT(energy, 0) << start_s << ' ' << far_m << ' ' << turn << ' ' << speed;
        }
}

TEST(PointSignals, RefuseWhatMakesNone) {
  const auto waveform = continuous_wave_pulse(100e3, 1e-3);
  const SignalSampling sampling{100e3, 10e3, 0, 100};
  const ElementArray array = line_array(2, {0.1, 0, 0});
  const auto of = [&](const std::vector<PointScatterer>& targets, const ElementArray& elements,
                      const VehicleMotion& motion, double speed) {
    return point_signals(targets, elements, waveform, sampling, motion, speed);
  };
  expect_refused([&] { of({{{NAN, 0, 0}, 1}}, array, at_rest(), c); }, "scatterer 0 is not finite");
  expect_refused(
      [&] {
        of({{{0, 0, -5}, 1}}, array, at_rest(), c);
      },
      "scatterer 0 is at the position of an element at ping 0");
  expect_refused([&] { of({}, {}, at_rest(), c); }, "no receivers");
  expect_refused([&] { of({}, array, at_rest(), 0); }, "sound speed is 0 m/s");
  expect_refused([&] { of({}, array, at_rest({}), c); }, "no pings");
  expect_refused(
      [&] {
        at_rest({1, 1});
      },
      "ping 1 starts at 1 s, but must start at a finite time after the previous ping");
  const std::vector<Trajectory::Sample> second{{0, {}}, {1, {{0, 2, 0}, {1, 0, 0, 0}}}};
  expect_refused(
      [&] {
        VehicleMotion(second, {0, 2});
      },
      "ping 1 starts at 2 s, but the track has poses only from 0 s to 1 s");
  expect_refused(
      [&] { of({}, array, VehicleMotion(second, {0.995}, false), c); },
      "the last ping needs poses until 1.005 s, but the track ends at 1 s: lengthen the trajectory");
  EXPECT_NO_THROW(of({}, array, VehicleMotion(second, {0.995}, true), c));
  expect_refused(
      [&] {
        VehicleMotion({{0, {{0, 0, 0}, {1, 0, 0, 1}}}}, {0});
      },
      "quaternions must have length 1");
  expect_refused([&] { VehicleMotion({{0, {{NAN, 0, 0}, {1, 0, 0, 0}}}}, {0}); }, "positions must be finite");
  ElementArray many;
  many.receivers_m.resize(4);
  expect_refused(
      [&] {
        silent_signals(many, waveform, {100e3, 10e3, 0, std::size_t{1} << 62}, at_rest(), c);
      },
      "use fewer pings at a time");
  const std::vector<Trajectory::Sample> fast{{0, {}}, {1, {{0, 1600, 0}, {1, 0, 0, 0}}}};
  expect_refused(
      [&] {
        of({{{0, 5, 0}, 1}}, array, VehicleMotion(fast, {0.5}, false), c);
      },
      "as fast as sound");
}

}  // namespace
}  // namespace tubefoot
