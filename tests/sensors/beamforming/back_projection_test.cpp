// SPDX-License-Identifier: GPL-3.0-or-later
// Tests synthetic apertures for point targets: strengths have the correct phases, and the resolution is
// that of the weighting window.
#include "sensors/beamforming/back_projection.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "fixtures/lobes.hpp"
#include "fixtures/refusal.hpp"
#include "sensors/beamforming/beams.hpp"
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
const glm::dvec3 target(50, 1.5, -10);
const Complex strength(0.3, -0.4);

/// 150 pings along 3 m, northwards. The point is abeam of the middle.
VehicleMotion rail(double speed_m_s, bool stop_and_hop) {
  std::vector<double> starts;
  for (int k = 0; k < 150; ++k) starts.push_back((k + 0.5) * 0.02 / speed_m_s);
  return {{{0, {}}, {4 / speed_m_s, {{0, 4, 0}, {1, 0, 0, 0}}}}, starts, stop_and_hop};
}

ElementSignals recorded(const VehicleMotion& motion, const TransmitWaveform& waveform,
                        double rate_hz = 60e3) {
  const auto samples = static_cast<std::size_t>(0.01 * rate_hz);
  return matched_filtered(point_signals({{target, strength}}, ElementArray{{0, 0, 0}, {{0, 0, 0}}}, waveform,
                                        {frequency_hz, rate_hz, 0.064, samples}, motion, c));
}

TEST(BackProjection, GivesAPointItsStrengthAndPhase) {
  const SignalInterpolator interpolator(0.6, 1e-6);
  const auto waveform = linear_chirp(90e3, 110e3, 3e-3, 1);
  const PixelPlane pixel{target, {}, {}, 1, 1};
  EXPECT_LT(std::abs(back_projected(recorded(rail(1, true), waveform), pixel, interpolator)[0] - strength),
            2e-5);
  // The vehicle moves 10 cm between transmission and reception: first with the exact delay, then with the
  // wrong one.
  ElementSignals moving = recorded(rail(1.5, false), waveform);
  EXPECT_LT(std::abs(back_projected(moving, pixel, interpolator)[0] - strength), 5e-4);
  moving.motion = rail(1.5, true);
  EXPECT_GT(std::abs(back_projected(moving, pixel, interpolator)[0] - strength), 0.1);
  // Without correction of the spreading loss the value is that of a transducer.
  const Complex received = back_projected(recorded(rail(1, true), waveform), pixel, interpolator,
                                          {{}, {}, std::nullopt, false})[0];
  EXPECT_NEAR(std::abs(received) * 2600, 0.5, 1e-3);
}

TEST(BackProjection, ResolvesAsTheWindowsTheorySays) {
  const SignalInterpolator interpolator(0.5, 1e-5);
  const double range_m = std::sqrt(2600.0);
  struct {
    ApertureWindow window;
    double width, side_lobe_db, tolerance_db;
  } const cases[] = {{{Law::uniform}, 0.8859, -13.26, 0.1},
                     {{Law::hann}, 1.4406, -31.47, 0.3},
                     {{Law::taylor, 30, 4}, 1.1189, -30, 0.5}};
  // The resolution along the track, with a long tone so that range has no effect: lambda r / 2 L.
  const ElementSignals tone = recorded(rail(1, true), continuous_wave_pulse(frequency_hz, 5e-3, 1), 10e3);
  const PixelPlane along{target - glm::dvec3(0, 1.5, 0), {0, 1e-3, 0}, {}, 3001, 1};
  for (const auto& [window, width, side_lobe_db, tolerance_db] : cases) {
    std::vector<double> modulus;
    for (const Complex& pixel : back_projected(tone, along, interpolator, {window_weights(window, 150)}))
      modulus.push_back(std::abs(pixel));
    const LobeFigures figures = lobe_figures(modulus, 0, 1e-3);
    EXPECT_NEAR(figures.peak_at, 1.5, 1e-3);
    EXPECT_NEAR(figures.half_power_width / (wavelength_m * range_m / (2 * 3.0)), width, 0.02 * width);
    EXPECT_NEAR(figures.highest_side_lobe_db, side_lobe_db, tolerance_db);
  }
  // The resolution across the track, with a chirp: c / 2 B along the slant range.
  const ElementSignals chirp = recorded(rail(1, true), linear_chirp(85e3, 115e3, 6e-3), 120e3);
  const glm::dvec3 away = glm::dvec3(50, 0, -10) / range_m;
  const PixelPlane across{target - 0.2 * away, 1e-3 * away, {}, 401, 1};
  std::vector<double> modulus;
  for (const Complex& pixel : back_projected(chirp, across, interpolator)) modulus.push_back(std::abs(pixel));
  const LobeFigures figures = lobe_figures(modulus, 0, 1e-3);
  EXPECT_NEAR(figures.peak_at, 0.2, 1.1e-3);
  EXPECT_NEAR(figures.half_power_width / (c / (2 * 30e3)), 0.8859, 0.02 * 0.8859);
}

TEST(BackProjection, LooksAbeamOnlyWhereItIsAskedTo) {
  const SignalInterpolator interpolator(0.6, 1e-5);
  const ElementSignals signals = recorded(rail(1, true), linear_chirp(90e3, 110e3, 3e-3, 1));
  const auto at = [&](double north, double half_beam_rad) {
    return std::abs(
        back_projected(signals, {{50, north, -10}, {}, {}, 1, 1}, interpolator, {{}, {}, half_beam_rad})[0]);
  };
  EXPECT_NEAR(at(1.5, 0.005), 0.5, 1e-3);
  EXPECT_EQ(at(10, 0.005), 0);  // no ping lies abeam of it
}

TEST(BackProjection, IsARealApertureOfThePingNearestAbeam) {
  const SignalInterpolator interpolator(0.6, 1e-5);
  const ElementSignals signals = recorded(rail(1, true), linear_chirp(90e3, 110e3, 3e-3, 1));
  const PixelPlane along{target - glm::dvec3(0, 1.5, 0), {0, 0.02, 0}, {}, 150, 1};
  BackProjection how;
  how.nearest_abeam_only = true;
  const std::vector<Complex> real = back_projected(signals, along, interpolator, how);
  // Pings are at 0.01, 0.03, ... A pixel at 0.02 k is equally near to two of them, except for rounding. The
  // test takes pixels slightly forward of it.
  const PixelPlane beside{along.first_m + glm::dvec3(0, 0.004, 0), along.column_step_m, {}, 149, 1};
  const std::vector<Complex> own = back_projected(signals, beside, interpolator, how);
  for (const std::size_t k : {0u, 40u, 75u, 148u}) {
    ElementSignals one = signals;
    one.motion = {signals.motion.track(), {signals.motion.ping_start_s()[k]}};
    one.pressure.assign(signals.channel(k, 0).begin(), signals.channel(k, 0).end());
    EXPECT_EQ(own[k], back_projected(one, {beside.at(k, 0), {}, {}, 1, 1}, interpolator)[0]);
  }
  // One element receives from all directions. Its image does not decrease within the metre in which that of
  // a synthetic aperture does.
  const std::vector<Complex> focused = back_projected(signals, along, interpolator);
  EXPECT_NEAR(std::abs(real[75]), 0.5, 1e-3);
  EXPECT_NEAR(std::abs(focused[75]), 0.5, 1e-3);
  EXPECT_GT(std::abs(real[50]), 0.25);
  EXPECT_LT(std::abs(focused[50]), 0.1);
  // Outside of the requested beam the image is zero.
  how.half_beam_rad = 0.005;
  EXPECT_EQ(std::abs(back_projected(signals, {{50, 10, -10}, {}, {}, 1, 1}, interpolator, how)[0]), 0);
}

TEST(BackProjection, IsOneOfFourPicturesOfOneRecord) {
  // 32 receivers to starboard, pings northwards, and one point that is not abeam of any of them.
  const ElementArray array = line_array(32, {wavelength_m / 2, 0, 0});
  const glm::dvec3 point(6, 8, -12);
  std::vector<double> starts;
  for (int k = 0; k < 40; ++k) starts.push_back(0.1 * k);
  const VehicleMotion motion({{0, {}}, {5, {{0, 2.5, 0}, {1, 0, 0, 0}}}}, starts);
  const ElementSignals signals = matched_filtered(point_signals(
      {{point, 1}}, array, linear_chirp(90e3, 110e3, 3e-3, 1), {frequency_hz, 60e3, 0.019, 300}, motion, c));
  const SignalInterpolator interpolator(0.6, 1e-4);
  const auto brightest = [&](const std::vector<glm::dvec3>& directions) {
    const auto beams = delay_and_sum(signals, 0, {directions, {}, {0, 0, 0}, true}, interpolator);
    std::size_t best = 0;
    for (std::size_t k = 0; k < beams.size(); ++k)
      if (std::abs(beams[k]) > std::abs(beams[best])) best = k;
    return std::pair(best / 300, signals.sampling.time_s(best % 300) * c / 2);
  };
  std::vector<double> angles;
  for (int k = -40; k <= 40; ++k) angles.push_back(k * 0.02);
  const double range_m = glm::length(point), sine = 6 / range_m;
  // The fans of a multibeam and of a camera receive the same cone about the array. Each uses its own angle.
  const auto [below, below_m] = brightest(across_track_fan(angles));
  EXPECT_NEAR(std::sin(angles[below]), sine, 0.015);
  EXPECT_NEAR(below_m, range_m, 0.02);
  const auto [ahead, ahead_m] = brightest(forward_fan(angles, std::atan2(12, 10)));
  EXPECT_NEAR(std::sin(angles[ahead]) * std::cos(std::atan2(12, 10)), sine, 0.015);
  EXPECT_NEAR(ahead_m, range_m, 0.02);
  // A sidescan has one beam per ping. The first ping that comes nearest is the last of the line.
  const auto lines = [&](std::size_t ping) {
    const auto beam = delay_and_sum(signals, ping, {{{6, 0, -12}}, {}, {0, 0, 0}, true}, interpolator);
    std::size_t best = 0;
    for (std::size_t k = 0; k < beam.size(); ++k)
      if (std::abs(beam[k]) > std::abs(beam[best])) best = k;
    return signals.sampling.time_s(best) * c / 2;
  };
  EXPECT_NEAR(lines(0), range_m, 0.06);
  EXPECT_NEAR(lines(39), glm::length(point - glm::dvec3(0, 1.95, 0)), 0.06);
  EXPECT_NEAR(std::abs(back_projected(signals, {point, {}, {}, 1, 1}, interpolator)[0]), 1, 1e-3);
}

TEST(BackProjection, RefusesWhatMakesNoPicture) {
  const ElementSignals signals = recorded(rail(1, true), continuous_wave_pulse(frequency_hz, 1e-3, 1));
  const SignalInterpolator interpolator;
  expect_refused([&] { back_projected(signals, {target, {}, {}, 0, 3}, interpolator); }, "0 x 3 pixels");
  expect_refused(
      [&] {
        back_projected(signals, {target, {}, {}, 1, 1}, interpolator, {{1, 2}});
      },
      "2 weights for 150 pings");
  for (const PixelPlane& plane :
       {PixelPlane{{NAN, 0, 0}, {}, {}, 1, 1}, PixelPlane{target, {HUGE_VAL, 0, 0}, {}, 2, 1}})
    expect_refused([&] { back_projected(signals, plane, interpolator); }, "no finite position");
  for (const double half : {0.0, -1.0, 2.0, double(NAN)})
    expect_refused(
        [&] {
          back_projected(signals, {target, {}, {}, 1, 1}, interpolator, {{}, {}, half});
        },
        "must be above 0 and at most pi / 2");
  std::vector<double> weights(150, 1);
  weights[7] = NAN;
  expect_refused(
      [&] {
        back_projected(signals, {target, {}, {}, 1, 1}, interpolator, {weights});
      },
      "weight 7 of the pings is not finite");
  ElementSignals cut = signals;
  cut.pressure.pop_back();
  expect_refused(
      [&] {
        back_projected(cut, {target, {}, {}, 1, 1}, interpolator);
      },
      "there are 89999 pressures, but 150 pings x 1 receivers x 600 samples = 90000");
}

}  // namespace
}  // namespace tubefoot
