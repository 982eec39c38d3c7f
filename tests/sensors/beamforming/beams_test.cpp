// SPDX-License-Identifier: GPL-3.0-or-later
// Compares beams of point targets with the theory of weighting windows, and with the single transducer that
// they represent.
#include "sensors/beamforming/beams.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>

#include "fixtures/lobes.hpp"
#include "fixtures/refusal.hpp"
#include "geometry/numbers/scalars.hpp"
#include "sensors/signals/aperture_window.hpp"
#include "sensors/signals/matched_filter.hpp"
#include "sensors/signals/point_signals.hpp"

namespace tubefoot {
namespace {

using Complex = std::complex<double>;
using Law = ApertureWindow::Law;
using test::c;
using test::frequency_hz;
using test::wavelength_m;

VehicleMotion at_rest() { return {{{0, {}}}, {0}}; }

/// 64 receivers half a wavelength apart to starboard, and a tone from so far that its waves are plane.
ElementSignals far_tone(double sine, double spacing_m = wavelength_m / 2, std::size_t receivers = 64) {
  constexpr double range_m = 20000;
  const glm::dvec3 target = range_m * glm::dvec3(sine, 0, -std::sqrt(1 - sine * sine));
  return point_signals({{target, range_m * range_m}}, line_array(receivers, {spacing_m, 0, 0}),
                       continuous_wave_pulse(frequency_hz, 8e-3, 0.2),
                       {frequency_hz, 5e3, 2 * range_m / c - 2e-3, 60}, at_rest(), c);
}

std::vector<glm::dvec3> by_sine(double first, double step, int count) {
  std::vector<glm::dvec3> directions;
  for (int k = 0; k < count; ++k) {
    const double sine = first + k * step;
    directions.emplace_back(sine, 0, -std::sqrt(1 - sine * sine));
  }
  return directions;
}

std::vector<double> modulus_at(const std::vector<Complex>& beams, std::size_t samples, std::size_t sample) {
  std::vector<double> modulus;
  for (std::size_t k = sample; k < beams.size(); k += samples) modulus.push_back(std::abs(beams[k]));
  return modulus;
}

/// Half-power width of the Dolph-Chebyshev pattern, in lambda / aperture of half-wavelength elements: the
/// point at which the Chebyshev polynomial is 3 dB down.
double dolph_width(double elements, double down_db) {
  const double ratio = std::pow(10, down_db / 20), edge = std::cosh(std::acosh(ratio) / (elements - 1)),
               half = std::cosh(std::acosh(ratio / std::sqrt(2.0)) / (elements - 1));
  return 2 * elements * std::acos(half / edge) / pi;
}

TEST(Beams, HaveTheWidthAndTheSideLobesOfTheirWindow) {
  constexpr double sine = 0.3, step = 1e-3, first = -0.6, aperture_m = 64 * wavelength_m / 2;
  const ElementSignals signals = far_tone(sine);
  struct {
    ApertureWindow window;
    double width, side_lobe_db, tolerance_db;
  } const cases[] = {{{Law::uniform}, 0.8859, -13.26, 0.05},
                     {{Law::hann}, 1.4406, -31.47, 0.1},
                     {{Law::taylor, 30, 4}, 1.1189, -30, 0.5},
                     {{Law::chebyshev, 40}, dolph_width(64, 40), -40, 0.05}};
  const SignalInterpolator interpolator(0.5, 1e-5);
  for (const auto& [window, width, side_lobe_db, tolerance_db] : cases) {
    const BeamSteering steering{by_sine(first, step, 1500), window_weights(window, 64)};
    for (const bool in_time : {true, false}) {
      const std::vector<Complex> beams =
          in_time ? delay_and_sum(signals, 0, steering, interpolator) : phase_and_sum(signals, 0, steering);
      const LobeFigures figures = lobe_figures(modulus_at(beams, 60, 30), first, step);
      EXPECT_NEAR(figures.peak_at, sine, 1e-9 + step / 2);
      EXPECT_NEAR(figures.peak, envelope_at(signals.waveform, 4e-3), 2e-4 * figures.peak);
      EXPECT_NEAR(figures.half_power_width * aperture_m / wavelength_m, width, 0.02 * width)
          << int(window.law);
      EXPECT_NEAR(figures.highest_side_lobe_db, side_lobe_db, tolerance_db) << int(window.law);
    }
  }
}

TEST(Beams, HaveGratingLobesWhereElementsAreSparse) {
  constexpr double step = 1e-3;
  const ElementSignals sparse = far_tone(0.1, 2 * wavelength_m, 16);
  const std::vector<double> pattern =
      modulus_at(phase_and_sum(sparse, 0, {by_sine(-0.95, step, 1901), {}}), 60, 30);
  for (const double sine : {-0.9, -0.4, 0.1, 0.6})  // that of the target, and half a sine from it
    EXPECT_NEAR(pattern[std::size_t(std::lround((sine + 0.95) / step))], pattern[1050], 1e-2 * pattern[1050])
        << sine;
  EXPECT_LT(pattern[std::size_t(std::lround((0.1 + 0.25 + 0.95) / step))], 0.1 * pattern[1050]);
}

TEST(Beams, AreTheSameInTimeAndInFrequency) {
  const ElementSignals signals =
      point_signals({{{12, 5, -20}, 1}, {{-5, 1, -22}, {0, 2}}}, line_array(32, {wavelength_m / 2, 0, 0}),
                    linear_chirp(90e3, 110e3, 4e-3, 0.5), {frequency_hz, 40e3, 0.02, 1000}, at_rest(), c);
  const BeamSteering steering{across_track_fan({-0.9, -0.2, 0, 0.5, 1.1}), window_weights({Law::hann}, 32)};
  for (const double error : {1e-3, 1e-5}) {
    const auto in_time = delay_and_sum(signals, 0, steering, SignalInterpolator(0.6, error)),
               in_frequency = phase_and_sum(signals, 0, steering);
    double largest = 0, worst = 0;
    for (const Complex& value : signals.pressure) largest = std::max(largest, std::abs(value));
    for (std::size_t k = 0; k < in_time.size(); ++k)
      worst = std::max(worst, std::abs(in_time[k] - in_frequency[k]));
    EXPECT_LT(worst, error * largest + 2e-5 * largest);  // a pulse is not strictly band-limited
  }
}

TEST(Beams, FocusedNearAreTheOneTransducerAtTheReference) {
  // 0.96 m of array, two metres away: the error of plane waves is several wavelengths.
  const ElementArray array = line_array(128, {wavelength_m / 2, 0, 0}, {0.2, 0.1, 0});
  const SignalSampling sampling{frequency_hz, 60e3, 0, 500};
  const glm::dvec3 reference(0.2, 0.1, 0.05);
  const double time_s = sampling.time_s(170), range_m = c * time_s / 2;
  const glm::dvec3 direction = glm::normalize(glm::dvec3(0.5, 0.1, -1)),
                   target = reference + direction * range_m;
  const auto waveform = linear_chirp(90e3, 110e3, 2e-3, 1);
  const SignalInterpolator interpolator(0.5, 1e-6);
  for (const double speed : {0.0, 10.0}) {
    const std::vector<Trajectory::Sample> still{{0, {}}}, moving{{0, {}}, {1, {{0, speed, 0}, {1, 0, 0, 0}}}};
    const VehicleMotion motion(speed == 0 ? still : moving, {0}, false);
    const ElementSignals signals =
        matched_filtered(point_signals({{target, {0, 1}}}, array, waveform, sampling, motion, c));
    BeamSteering steering{{direction}, {}, reference, true};
    const Complex focused = delay_and_sum(signals, 0, steering, interpolator)[170];
    Complex expected = 0;
    for (const glm::dvec3& place : array.receivers_m)
      expected +=
          Complex(0, 1) / (glm::distance(target, array.transmitter_m) * glm::distance(target, place)) / 128.0;
    expected *= std::polar(1.0, 2 * pi * frequency_hz * time_s);
    EXPECT_LT(std::abs(focused - expected), (speed == 0 ? 1e-5 : 2e-2) * std::abs(expected)) << speed;
    steering.near_field = false;
    EXPECT_LT(std::abs(delay_and_sum(signals, 0, steering, interpolator)[170]), 0.5 * std::abs(expected));
  }
}

TEST(Beams, AreLinear) {
  const SignalSampling sampling{frequency_hz, 40e3, 0.02, 400};
  const ElementArray array = line_array(8, {wavelength_m / 2, 0, 0});
  const auto of = [&](const std::vector<PointScatterer>& targets) {
    return point_signals(targets, array, continuous_wave_pulse(frequency_hz, 1e-3, 1), sampling, at_rest(),
                         c);
  };
  const PointScatterer a{{5, 1, -15}, {0.5, 0.1}}, b{{-2, 3, -16}, {0, 2}};
  for (const bool near : {false, true}) {
    const BeamSteering steering{forward_fan({-0.3, 0.4}, 1.2), {}, {0, 0, 0}, near};
    const SignalInterpolator interpolator(0.5, 1e-4);
    const auto first = delay_and_sum(of({a}), 0, steering, interpolator),
               second = delay_and_sum(of({b}), 0, steering, interpolator),
               both = delay_and_sum(of({a, b}), 0, steering, interpolator);
    for (std::size_t k = 0; k < both.size(); ++k) EXPECT_LT(std::abs(both[k] - first[k] - second[k]), 1e-14);
  }
}

TEST(Beams, BringTheEnergyOfEchoes) {
  // A pulse of 1 J/sr at 1 m: a point returns |f|^2 / r^4.
  const glm::dvec3 target(3, 0, -12);
  const ElementSignals signals = point_signals(
      {{target, {0.6, 0.3}}}, line_array(16, {wavelength_m / 2, 0, 0}),
      continuous_wave_pulse(frequency_hz, 1e-3, 1), {frequency_hz, 200e3, 0.01, 4000}, at_rest(), c);
  const BeamSteering steering{{target, {-1, 0, -1}}, {}, {0, 0, 0}, true};
  const RangeSamples samples{10, 0.1, 40};
  const auto beams = delay_and_sum(signals, 0, steering, SignalInterpolator(0.5, 1e-6));
  const std::vector<double> energies = beam_energies(beams, signals.sampling, c, samples);
  ASSERT_EQ(energies.size(), 80u);
  double toward = 0, aside = 0;
  for (std::size_t k = 0; k < 40; ++k) toward += energies[k], aside += energies[40 + k];
  const double range = glm::length(target);
  EXPECT_NEAR(toward, 0.45 / std::pow(range, 4), 1e-4 * toward);
  EXPECT_LT(aside, 0.1 * toward);
  const auto first = static_cast<std::size_t>((range - 10) / 0.1);
  EXPECT_EQ(energies[first - 1], 0);
  EXPECT_EQ(energies[first + 9], 0);  // 1 ms is 0.75 m
}

TEST(Beams, RefuseWhatMakesNone) {
  const ElementSignals signals = far_tone(0, wavelength_m / 2, 4);
  const SignalInterpolator interpolator;
  const auto refused = [&](const BeamSteering& steering, std::size_t ping, const std::string& what) {
    expect_refused([&] { delay_and_sum(signals, ping, steering, interpolator); }, what);
    expect_refused([&] { phase_and_sum(signals, ping, steering); }, what);
  };
  refused({{{0, 0, -1}}}, 1, "there is no ping 1: the signals have 1 pings");
  refused({}, 0, "at least one direction");
  refused({{{0, 0, -1}, {0, 0, 0}}}, 0, "direction of beam 1 must be a finite vector with a length above 0");
  refused({{{0, 0, -1}}, {1, 2}}, 0, "2 weights for 4 receivers");
  refused({{{0, 0, -1}}, {1, -1, 1, -1}}, 0, "receiver weights is 0");
  refused({{{0, 0, -1}}, {}, {0, NAN, 0}}, 0, "reference position of the beams is not finite");
  expect_refused([&] { phase_and_sum(signals, 0, {{{0, 0, -1}}, {}, {0, 0, 0}, true}); }, "plane waves");
  expect_refused([&] { beam_energies({1, 2, 3}, signals.sampling, c, {0, 1, 1}); }, "is not a multiple of");
}

}  // namespace
}  // namespace tubefoot
