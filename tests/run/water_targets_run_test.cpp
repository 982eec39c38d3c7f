// SPDX-License-Identifier: GPL-3.0-or-later
// Tests targets in the water in whole runs: energies, bounds, signals, occlusion, tables of strengths and bad
// input. The oracles are closed forms and point_signals().
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <fstream>
#include <glm/geometric.hpp>
#include <iterator>

#include "files/input_error.hpp"
#include "fixtures/netcdf_reader.hpp"
#include "fixtures/program.hpp"
#include "fixtures/scene_texts.hpp"
#include "fixtures/world/echoes.hpp"
#include "fixtures/world/read_scenes.hpp"
#include "geometry/numbers/scalars.hpp"
#include "run/simulation.hpp"
#include "run/survey.hpp"
#include "run/water_targets.hpp"
#include "sensors/kinds/scene_file.hpp"
#include "sensors/products/array_files.hpp"
#include "sensors/recordings/signal_recording.hpp"
#include "sensors/signals/point_signals.hpp"

namespace tubefoot {
namespace {

using testing::AllOf;
using testing::HasSubstr;

constexpr double target_db = -30, water_db_per_km = 60;

std::string target_at(glm::dvec3 place, const std::string& more = "target_strength_db = -30\n",
                      const std::string& name = "fish") {
  return fmt::format("[[targets]]\nname = \"{}\"\nposition_m = [{}, {}, {}]\n{}", name, place.x, place.y,
                     place.z, more);
}

/// A sonar that looks north from the origin, over a seabed outside of its sector.
std::string ahead_scene(const std::string& targets, const std::string& sensor = "",
                        const std::string& water = still_water(water_db_per_km)) {
  return water + lambert_material("sand", -20) + flat_terrain(40, 40, "centre_m = [0, 0, -30]\n") + targets +
         fixed_at(0, 0, 0) +
         "[[sensors]]\nname = \"sonar\"\nkind = \"imaging\"\nbeams = 16\nhorizontal_deg = 40\nvertical_deg = "
         "30\nsamples = 100\nrange_min_m = 5\nrange_max_m = 15\n" +
         sensor;
}

/// sigma e^(-beta (r + s)) / (r s)^2 for the water and the target strength above.
double target_closed_form(double r, double s) {
  const double beta = water_db_per_km / 1000 * std::log(10) / 10;
  return std::pow(10, target_db / 10) * std::exp(-beta * (r + s)) / std::pow(r * s, 2);
}

struct TargetBin {
  std::size_t beam = 0, sample = 0, count = 0;
  double energy = 0;
};
TargetBin target_bin_of(const Echoes& echoes, std::size_t ping = 0) {
  TargetBin found;
  for (std::size_t beam = 0; beam < echoes.beams; ++beam)
    for (std::size_t k = 0; k < echoes.samples; ++k) {
      const double energy = echoes.at(ping, beam, k);
      if (energy == 0) continue;
      ++found.count;
      if (energy > found.energy) found = {beam, k, found.count, energy};
    }
  return found;
}

TEST(WaterTargetsRun, ATargetReturnsItsClosedFormInOneBin) {
  const glm::dvec3 place(0.75, 8.5, -1.25);
  const double range = glm::length(place), expected = target_closed_form(range, range);
  const Echoes echoes = echoes_of(ahead_scene(target_at(place)));
  const TargetBin found = target_bin_of(echoes);
  EXPECT_EQ(found.count, 1u);
  EXPECT_EQ(found.sample, echoes.sample_at(range));
  EXPECT_NEAR(found.energy, expected, 1e-12 * expected);
  EXPECT_NEAR(echoes.beam_azimuth_deg.at(found.beam), std::atan2(0.75, 8.5) / degree, 1.25 + 1e-9);
  // The same energy by rays and with other settings of the tube engine.
  for (const std::vector<std::string>& words :
       {std::vector<std::string>{"--engine", "ray"}, {"--binning", "centroid"}, {"--arithmetic", "double"}})
    EXPECT_EQ(echoes_of(ahead_scene(target_at(place)), words).energy, echoes.energy) << words[1];
}

TEST(WaterTargetsRun, AReferenceHoldsTheClosedForm) {
  const glm::dvec3 place(0.75, 8.5, -1.25);
  for (const std::string sensor : {"", "receiver_arm_m = [1, 0.5, 0.25]\n",
                                   "receive_pattern = \"gaussian\"\nreceive_beam_width_deg = 3\n"}) {
    SCOPED_TRACE(sensor);
    const bool pattern = sensor.starts_with("receive_pattern");
    const double range = glm::length(place),
                 back = sensor.starts_with("receiver_arm") ? glm::distance(place, {1, 0.5, 0.25}) : range;
    const Echoes plain = echoes_of(ahead_scene(target_at(place), sensor)),
                 bounded =
                     echoes_of(ahead_scene(target_at(place), sensor), {"--reference", "--tolerance", "1e-9"});
    ASSERT_EQ(bounded.energy_bound.size(), plain.energy.size());
    const TargetBin found = target_bin_of(bounded);
    EXPECT_GT(found.energy, 0);
    for (std::size_t k = 0; k < plain.energy.size(); ++k)
      EXPECT_NEAR(bounded.energy[k], plain.energy[k], bounded.energy_bound[k] + 1e-13 * plain.energy[k]);
    const double bound = *std::ranges::max_element(bounded.energy_bound);
    EXPECT_GT(bound, 0);
    EXPECT_LT(bound, 1e-9 * found.energy);
    if (!pattern) {
      EXPECT_NEAR(found.energy, target_closed_form(range, back), bound + 1e-14 * found.energy);
      EXPECT_EQ(found.sample, plain.sample_at((range + back) / 2));
    }
  }
}

// Targets on a fine arc, also on the walls between beams: each is in one beam.
TEST(WaterTargetsRun, NeighbouringBeamsShareNoTargetAndLoseNone) {
  std::string targets;
  double expected = 0;
  constexpr int count = 161;
  for (int k = 0; k < count; ++k) {
    const double azimuth = (-19.9 + 39.8 * k / (count - 1)) * degree;
    const glm::dvec3 place(10 * std::sin(azimuth), 10 * std::cos(azimuth), 0);
    targets += target_at(place, "target_strength_db = -30\n", fmt::format("fish {}", k));
  }
  // On the walls between the middle beams, and on a common ray of four tubes.
  for (const double y : {7.0, 8.0, 11.5}) {
    targets += target_at({0, y, 0}, "target_strength_db = -30\n", fmt::format("ahead {}", y));
    expected += target_closed_form(y, y);
  }
  expected += count * target_closed_form(10, 10);
  EXPECT_NEAR(echoes_of(ahead_scene(targets)).total(), expected, 1e-5 * expected);
}

// A box hides a target. The sonar's line to the target passes the vertical edge of the box at x = 0.5, y = 5.
TEST(WaterTargetsRun, ATargetVanishesAtTheSilhouetteOfABox) {
  const std::string box =
      "[[objects]]\nname = \"box\"\nshape = \"box\"\nsize_m = [1, 1, 2]\nposition_m = [0, 4.5, 0]\n";
  const auto energy = [&](glm::dvec3 place, const std::string& sensor = "") {
    const std::string with = ahead_scene(box + target_at(place), "range_min_m = 6\n" + sensor);
    return echoes_of(replaced(with, "range_min_m = 5\n", "")).total();
  };
  // The silhouette from the origin is the near edge at (0.5, 4): x / y = 1/8.
  EXPECT_EQ(energy({1, 8, 0}), 0) << "the line touches the edge";
  EXPECT_EQ(energy({1 - 1e-6, 8, 0}), 0);
  EXPECT_GT(energy({1 + 2e-6, 8, 0}), 0);
  EXPECT_EQ(energy({0, 9, 0.5}), 0);
  // A receiver to the side of the box sees the target, but the transmitter does not.
  EXPECT_EQ(energy({0.9, 8, 0}, "receiver_arm_m = [2, 0, 0]\n"), 0);
  EXPECT_GT(energy({1.1, 8, 0}, "receiver_arm_m = [2, 0, 0]\n"), 0);
  EXPECT_EQ(energy({1.1, 8, 0}, "receiver_arm_m = [-2, 0, 0]\n"), 0);
}

// The transmitter sees the target past the box. The line from the receiver meets the box at x = 0.2, y = 4.
TEST(WaterTargetsRun, ATargetHiddenFromTheSeparateReceiverAloneReturnsNothing) {
  const std::string box =
      "[[objects]]\nname = \"box\"\nshape = \"box\"\nsize_m = [1, 1, 2]\nposition_m = [0, 4.5, 0]\n";
  const glm::dvec3 place(-1.1, 8, 0), receiver(1.5, 0, 0);
  const auto energy = [&](const std::string& object, const std::string& sensor) {
    const std::string with = ahead_scene(object + target_at(place), "range_min_m = 7\n" + sensor);
    return echoes_of(replaced(with, "range_min_m = 5\n", "")).total();
  };
  const double range = glm::length(place), back = glm::distance(place, receiver);
  const std::string arm = "receiver_arm_m = [1.5, 0, 0]\n";
  // The target lies at the nearest grid point.
  EXPECT_NEAR(energy(box, ""), target_closed_form(range, range), 1e-6 * target_closed_form(range, range));
  EXPECT_NEAR(energy("", arm), target_closed_form(range, back), 1e-6 * target_closed_form(range, back));
  EXPECT_EQ(energy(box, arm), 0);
}

/// A ray in water with one vertical gradient of the sound speed, integrated step by step.
struct GradientRay {
  double range = 0, height = 0;  ///< horizontal and vertical position
  double along = 1, up = 0;      ///< direction
  double length = 0;
};

/// Water of the sound speed `speed` at height 0 that changes by `per_m` for each metre upwards.
struct GradientWater {
  double speed = 1500, per_m = 0;

  /// Follows a ray over a length by the classical Runge-Kutta method. A ray curves by the component of the
  /// gradient perpendicular to its direction t. The equation is dt/ds = -(grad c - (grad c . t) t) / c.
  GradientRay follow(double height, double elevation, double length) const {
    using State = std::array<double, 4>;
    const auto slope = [&](const State& s) {
      const double by = per_m / (speed + per_m * s[1]);
      return State{s[2], s[3], by * s[3] * s[2], -by * (1 - s[3] * s[3])};
    };
    State at{0, height, std::cos(elevation), std::sin(elevation)};
    constexpr int steps = 400;
    const double h = length / steps;
    for (int k = 0; k < steps; ++k) {
      const auto moved = [&](const State& by, double share) {
        State there = at;
        for (std::size_t i = 0; i < 4; ++i) there[i] += share * by[i];
        return there;
      };
      const State a = slope(at), b = slope(moved(a, h / 2)), c = slope(moved(b, h / 2)),
                  d = slope(moved(c, h));
      for (std::size_t i = 0; i < 4; ++i) at[i] += h / 6 * (a[i] + 2 * b[i] + 2 * c[i] + d[i]);
    }
    return {at[0], at[1], at[2], at[3], length};
  }
  /// Returns the elevation and the length of the ray from a height to a point, by Newton's method.
  std::array<double, 2> aim(double height, double to_range, double to_height) const {
    double elevation = std::atan2(to_height - height, to_range),
           length = std::hypot(to_range, to_height - height);
    for (int step = 0; step < 30; ++step) {
      const GradientRay end = follow(height, elevation, length);
      const double d_range = to_range - end.range, d_height = to_height - end.height;
      length += d_range * end.along + d_height * end.up;
      elevation += (-d_range * end.up + d_height * end.along) / length;
    }
    return {elevation, length};
  }
  /// Returns the area of the ray tube per steradian. Neighbouring rays are `across` apart perpendicular to
  /// the ray. Horizontally, their distance is the range times the difference of azimuths.
  double area_per_sr(double height, double to_range, double to_height) const {
    const auto [elevation, length] = aim(height, to_range, to_height);
    constexpr double step = 1e-4;
    const GradientRay ray = follow(height, elevation, length),
                      above = follow(height, elevation + step, length),
                      below = follow(height, elevation - step, length);
    const double across =
        (-(above.range - below.range) * ray.up + (above.height - below.height) * ray.along) / (2 * step);
    return std::abs(across) * to_range / std::cos(elevation);
  }
};

// In water of one gradient, the travel time between two points is acosh(1 + g^2 d^2 / (2 c1 c2)) / g.
TEST(WaterTargetsRun, RefractedRaysGiveTravelTimesAndSpreading) {
  const auto water = [](double gradient_per_s) {
    return fmt::format(
        "[water]\nsurface_height_m = 20\nprofile = \"gradient\"\nsound_speed_m_s = 1500\n"
        "gradient_per_s = {}\nprofile_bottom_m = 60\nabsorption_db_per_km = {}\n",
        gradient_per_s, water_db_per_km);
  };
  const glm::dvec3 place(0.75, 11.5, 2.25);
  const double range = glm::length(place);
  const Echoes straight = echoes_of(ahead_scene(target_at(place))),
               nearly = echoes_of(ahead_scene(target_at(place), "", water(1e-7)));
  EXPECT_NEAR(nearly.total(), straight.total(), 1e-5 * straight.total());
  const double g = -8, c1 = 1500 + g * 20, c2 = 1500 + g * (20 - place.z);
  const double time_s = std::acosh(1 + g * g * range * range / (2 * c1 * c2)) / std::abs(g);
  const Echoes curved = echoes_of(ahead_scene(target_at(place), "", water(g)));
  const TargetBin found = target_bin_of(curved);
  EXPECT_EQ(found.count, 1u);
  EXPECT_EQ(found.sample, curved.sample_at(c1 * time_s));
  EXPECT_NE(found.sample, curved.sample_at(range));
  // Ray tubes from both ends give the spreading. The differences of rays have an error of 1e-8.
  const GradientWater between{c1, -g};
  const double across = std::hypot(place.x, place.y), length = between.aim(0, across, place.z)[1],
               spread = between.area_per_sr(0, across, place.z) * between.area_per_sr(place.z, across, 0),
               expected = std::pow(10, target_db / 10 - 2 * water_db_per_km / 1000 * length / 10) / spread;
  EXPECT_GT(std::abs(expected / straight.total() - 1), 1e-3) << "refraction changes the spreading";
  EXPECT_NEAR(found.energy, expected, 1e-6 * expected);
  // A separate receiver next to the transmitter receives nearly the same.
  const Echoes beside = echoes_of(ahead_scene(target_at(place), "receiver_arm_m = [0, 0, 1e-5]\n", water(g)));
  EXPECT_NEAR(beside.total(), curved.total(), 1e-4 * curved.total());
}

// The record of a ping is divided into intervals, each with its own pose of the receiver.
TEST(WaterTargetsRun, AMovingSonarReceivesATargetOnce) {
  const auto scene = [](const std::string& more) {
    return still_water() + lambert_material("sand", -20) + flat_terrain(40, 40, "centre_m = [0, 0, -300]\n") +
           target_at({4, 0.0, -10}) +
           "[trajectory]\nkind = \"line\"\nstart_m = [0, -2.5, 0]\nend_m = [0, 20, 0]\nspeed_m_s = 5\n"
           "[[sensors]]\nname = \"swath\"\nkind = \"multibeam\"\nbeams = 24\nswath_deg = 92\n"
           "along_track_deg = 3\nrange_min_m = 4\nrange_max_m = 44\nsamples = 160\nfirst_ping_s = 0.5\n" +
           more;
  };
  const double range = std::hypot(4, 10), expected = 1e-3 / std::pow(range, 4);
  const Echoes moving = echoes_of(scene("stop_and_hop = false\nmotion_step_beams = 0.01\n"));
  EXPECT_EQ(target_bin_of(moving).count, 1u);
  EXPECT_NEAR(moving.total(), expected, 1e-3 * expected);
  EXPECT_NEAR(echoes_of(scene("")).total(), expected, 1e-12 * expected);
}

// The sonar moves by 0.4 m until the echo from a range of 10 m arrives. Each target lies in its own bin.
TEST(WaterTargetsRun, ASonarThatApproachesReceivesEachTargetOnceAtBordersOfIntervals) {
  constexpr int count = 340;
  std::string targets;
  for (int k = 0; k < count; ++k)
    targets +=
        target_at({0.5, 5.5 + 0.0257 * k, 0.25}, "target_strength_db = -30\n", fmt::format("fish {}", k));
  const std::string
      fixed = fixed_at(0, 0, 0),
      track = "[trajectory]\nkind = \"line\"\nstart_m = [0, 0, 0]\nend_m = [0, 30, 0]\nspeed_m_s = 30\n",
      sensor = "stop_and_hop = false\nmotion_step_beams = 0.01\n";
  const auto received = [&](const std::string& water, const std::vector<std::string>& words) {
    const std::string scene = replaced(ahead_scene(targets, sensor, water), fixed, track);
    return target_bin_of(echoes_of(replaced(scene, "samples = 100\n", "samples = 1000\n"), words)).count;
  };
  EXPECT_EQ(received(still_water(), {}), std::size_t(count));
  EXPECT_EQ(received(still_water(), {"--reference", "--tolerance", "1e-6"}), std::size_t(count));
  EXPECT_EQ(received("[water]\nsurface_height_m = 20\nprofile = \"gradient\"\nsound_speed_m_s = 1500\n"
                     "gradient_per_s = 1\nprofile_bottom_m = 60\n",
                     {}),
            std::size_t(count));
}

TEST(WaterTargetsRun, APopulationIsTheSameForAnyNumberOfThreads) {
  const std::string school =
      "[[target_populations]]\nname = \"school\"\ndensity_per_m3 = 3\ncentre_m = [0, 9]\nsize_m = [6, 5]\n"
      "top_depth_m = -2\nbottom_depth_m = 2\ntarget_strength_db = -45\nstrength_spread_db = 3\nseed = 4\n";
  const std::string scene = ahead_scene(school, "pings = 3\nping_interval_s = 1\n");
  const Echoes one = echoes_of(scene, {"--threads", "1"}), two = echoes_of(scene, {"--threads", "2"});
  EXPECT_EQ(one.energy, two.energy);
  const std::size_t ping = one.beams * one.samples;
  EXPECT_GT(std::count_if(one.energy.begin(), one.energy.begin() + std::ptrdiff_t(ping),
                          [](double e) { return e > 0; }),
            50);
  for (std::size_t k = 0; k < ping; ++k) EXPECT_EQ(one.energy[k], one.energy[2 * ping + k]);
  EXPECT_NE(echoes_of(replaced(scene, "seed = 4", "seed = 5")).energy, one.energy);
}

TEST(WaterTargetsRun, AReceiverPairReceivesThePhaseOfTheTarget) {
  const glm::dvec3 place(15, 0.0, -7);
  const std::string text = still_water(0) + lambert_material("sand", -20) +
                           flat_terrain(10, 10, "centre_m = [0, 0, -300]\n") + target_at(place) +
                           fixed_at(0, 0, 0) +
                           "[[sensors]]\nname = \"swath\"\npreset = \"geoswath-500\"\nalong_track_deg = 2\n"
                           "range_min_m = 10\nrange_max_m = 30\nsamples = 200\nbaseline_m = 0.01\n";
  const TestFolder folder;
  const auto file = folder.write("scene.toml", text);
  for (const bool reference : {false, true}) {
    std::vector<std::string> words{"run", file.string(), "-o", (folder / "out").string()};
    if (reference) words.insert(words.end(), {"--reference", "--tolerance", "1e-6"});
    const Outcome outcome = run_program(words);
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    const NetcdfReader echoes(folder / "out" / "echoes.nc");
    const std::vector<double> upper = echoes.values("/", "energy"),
                              lower = echoes.values("/", "energy_lower"),
                              re = echoes.values("/", "cross_real"), im = echoes.values("/", "cross_imag");
    const auto bin = std::size_t(std::ranges::max_element(upper) - upper.begin());
    ASSERT_GT(upper[bin], 0);
    EXPECT_NEAR(lower[bin], upper[bin], 0.01 * upper[bin]);
    EXPECT_NEAR(std::hypot(re[bin], im[bin]), std::sqrt(upper[bin] * lower[bin]), 1e-9 * upper[bin]);
    // The pair's axis is tilted by the key of the preset, 30 degrees, in the plane across the track.
    const double tilt = 30 * degree, wave = 2 * pi * 500e3 / 1500;
    const glm::dvec3 axis(std::sin(tilt), 0, std::cos(tilt));
    const double phase = wave * (glm::distance(place, 0.005 * axis) - glm::distance(place, -0.005 * axis));
    EXPECT_NEAR(std::remainder(std::atan2(im[bin], re[bin]) - phase, 2 * pi), 0, 1e-6);
  }
}

struct WaterTargetSignals : testing::Test {
  TestFolder folder;

  ElementSignals signals_of(const std::string& text) {
    const SceneDescription description = read_scene_file(folder.write("scene.toml", text));
    const RunRequest request = request_of(description.run);
    const std::unique_ptr<const Survey> survey = open_survey(description, Facets::merged);
    SimulationStats stats;
    const std::vector<Recording> recordings = simulate(*survey, request, stats);
    return element_signals_of(recordings.at(0));
  }
  static std::string scene(const std::string& more, const std::string& sensor, const std::string& track) {
    return still_water() + lambert_material("sand", -20) + flat_terrain(2, 2, "centre_m = [0.3, 6, -6]\n") +
           more + track +
           "[[sensors]]\nname = \"sonar\"\nkind = \"array\"\ntilt_deg = 45\nfrequency_khz = 30\n"
           "bandwidth_khz = 6\npulse_length_us = 500\npulse_taper = 0.4\nrange_min_m = 4\nrange_max_m = 11\n"
           "horizontal_deg = 50\nvertical_deg = 50\nbaseband_khz = 30.5\nsampling_frequency_khz = 20\n"
           "receivers_m = [[0, 0, 0], [0.4, 0, -0.1], [-0.2, 0.3, 0]]\n" +
           sensor;
  }
  /// Largest change of the signal of each element by a target in a scene with an object.
  std::vector<double> differences(const std::string& object, glm::dvec3 place, const std::string& sensor) {
    const ElementSignals with = signals_of(scene(object + target_at(place), sensor, fixed_at(0, 0, 0))),
                         without = signals_of(scene(object, sensor, fixed_at(0, 0, 0)));
    std::vector<double> each;
    for (std::size_t e = 0; e < with.receivers(); ++e) {
      double most = 0;
      for (std::size_t k = 0; k < with.samples(); ++k)
        most = std::max(most, std::abs(with.channel(0, e)[k] - without.channel(0, e)[k]));
      each.push_back(most);
    }
    return each;
  }
};

TEST_F(WaterTargetSignals, AreThoseOfPoints) {
  const glm::dvec3 place(0.5, 4.25, -3.5);
  const std::string at_rest = fixed_at(0, 0, 0),
                    moving =
                        "[trajectory]\nkind = \"line\"\nstart_m = [0, -1, 0]\nend_m = [0.5, 3, 0.25]\n"
                        "speed_m_s = 3\n";
  for (const auto& [sensor, track] : {std::pair<std::string, std::string>{"", at_rest},
                                      {"stop_and_hop = false\n", moving},
                                      {"own_sights = true\n", at_rest}}) {
    SCOPED_TRACE(sensor);
    const ElementSignals with = signals_of(scene(target_at(place), sensor, track)),
                         without = signals_of(scene("", sensor, track)),
                         points = point_signals({{place, std::sqrt(1e-3)}}, with.array, with.waveform,
                                                with.sampling, with.motion, with.sound_speed_m_s);
    double most = 0, worst = 0;
    ASSERT_EQ(with.pressure.size(), points.pressure.size());
    for (std::size_t k = 0; k < with.pressure.size(); ++k) {
      most = std::max(most, std::abs(points.pressure[k]));
      worst = std::max(worst, std::abs(with.pressure[k] - without.pressure[k] - points.pressure[k]));
    }
    ASSERT_GT(most, 0);
    EXPECT_LT(worst, 2e-9 * most);
  }
}

// A plate hides the target from all elements, or from one element with a view of its own.
TEST_F(WaterTargetSignals, AreHiddenLikeEnergies) {
  const std::string plate =
      "[[objects]]\nname = \"plate\"\nshape = \"box\"\nsize_m = [0.3, 0.05, 0.3]\nposition_m = [0.25, 2.1, "
      "-1.75]\n";
  const glm::dvec3 place(0.5, 4.25, -3.5);
  EXPECT_THAT(differences(plate, place, ""), testing::Each(0));
  // The transmitter at the origin does not see the target, whatever a receiver sees.
  EXPECT_THAT(differences(plate, place, "own_sights = true\n"), testing::Each(0));
}

// The plate is on the line from the second element to the target. All elements share the view of the
// transmitter, or the second element has its own view.
TEST_F(WaterTargetSignals, AreHiddenFromAnElementAlone) {
  const std::string plate =
      "[[objects]]\nname = \"plate\"\nshape = \"box\"\nsize_m = [0.2, 0.05, 0.2]\nposition_m = [0.45, 2.1, "
      "-1.785]\n";
  const glm::dvec3 place(0.5, 4.25, -3.5);
  EXPECT_THAT(differences(plate, place, ""), testing::Each(testing::Gt(0)));
  EXPECT_THAT(differences(plate, place, "own_sights = true\n"),
              testing::ElementsAre(testing::Gt(0), 0, testing::Gt(0)));
}

// The target is farther from the transmitter than the range gate, but half of the path is shorter.
TEST_F(WaterTargetSignals, OfDistantElementsContainAllTargetsWithinTheRange) {
  const glm::dvec3 place(-2.5, 8, -8);
  for (const std::string sensor : {"", "own_sights = true\n"}) {
    SCOPED_TRACE(sensor);
    const auto text = [&](const std::string& target) {
      return replaced(scene(target, sensor, fixed_at(0, 0, 0)), "[[0, 0, 0], [0.4, 0, -0.1], [-0.2, 0.3, 0]]",
                      "[[0, 2, 0]]");
    };
    const ElementSignals with = signals_of(text(target_at(place))), without = signals_of(text("")),
                         points = point_signals({{place, std::sqrt(1e-3)}}, with.array, with.waveform,
                                                with.sampling, with.motion, with.sound_speed_m_s);
    double most = 0, worst = 0;
    for (std::size_t k = 0; k < with.pressure.size(); ++k) {
      most = std::max(most, std::abs(points.pressure[k]));
      worst = std::max(worst, std::abs(with.pressure[k] - without.pressure[k] - points.pressure[k]));
    }
    ASSERT_GT(most, 0);
    EXPECT_LT(worst, 2e-9 * most);
  }
}

/// A table for a sonar in the direction of the x axis of the body, 10 dB stronger than to the sides.
std::string strength_table(double frequency_hz) {
  std::string rows = "elevation_deg,azimuth_deg,frequency_hz,target_strength_db\n";
  for (const double elevation : {-30.0, 0.0, 30.0})
    for (const double azimuth : {0.0, 90.0, 180.0, 270.0})
      rows += fmt::format("{},{},{},{}\n", elevation, azimuth, frequency_hz, azimuth == 0 ? -20.0 : -30.0);
  return rows;
}

TEST(WaterTargetsRun, ATableTurnsWithItsTarget) {
  const TestFolder folder;
  folder.write("fish.csv", strength_table(1.8e6));
  const auto total = [&](double heading_deg) {
    const std::string target =
        target_at({0, 8, 0}, fmt::format("file = \"fish.csv\"\nheading_deg = {}\n", heading_deg));
    return echoes_in(folder, ahead_scene(target, "frequency_khz = 1800\n", still_water())).total();
  };
  // The sonar lies south of the target. At heading 90 degrees, the x axis (starboard) points south.
  const double weak = 1e-3 / std::pow(8, 4);
  EXPECT_NEAR(total(90), 10 * weak, 1e-9 * weak);
  EXPECT_NEAR(total(0), weak, 1e-9 * weak);
  EXPECT_NEAR(total(270), weak, 1e-9 * weak);
  EXPECT_NEAR(total(45), 5.5 * weak, 1e-9 * weak) << "half of the way in m2";
}

TEST(WaterTargetsRun, TablesOfStrengthOfTheProgramAreRead) {
  const TestFolder folder;
  folder.write("plate.obj", "v -0.1 0 -0.1\nv 0.1 0 -0.1\nv 0.1 0 0.1\nv -0.1 0 0.1\nf 1 2 3\nf 1 3 4\n");
  const Outcome outcome = run_program({"strength", (folder / "plate.obj").string(), "--frequencies", "300kHz",
                                       "--azimuths", "0:350:10", "-o", (folder / "plate.csv").string()});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const std::string target = target_at({0, 8, 0}, "file = \"plate.csv\"\n");
  const Echoes echoes = echoes_in(folder, ahead_scene(target, "frequency_khz = 300\n", still_water()));
  // A plate of area A that faces the sonar has the cross-section (A / wavelength)^2.
  const double sigma = std::pow(0.04 / (1500 / 300e3), 2);
  EXPECT_NEAR(echoes.total(), sigma / std::pow(8, 4), 0.01 * sigma / std::pow(8, 4));
}

void expect_target_error(const std::string& scene, const std::string& line, const std::string& message,
                         const std::string& table = strength_table(1.8e6)) {
  const TestFolder folder;
  folder.write("fish.csv", table);
  const std::string file = folder.write("scene.toml", scene).string(), out = (folder / "out").string();
  for (const auto& command :
       std::vector<std::vector<std::string>>{{"check", file}, {"run", file, "-o", out}}) {
    const Outcome outcome = run_program(command);
    EXPECT_EQ(outcome.exit_code, 2) << command[0] << outcome.err;
    EXPECT_THAT(outcome.err, AllOf(HasSubstr(line), HasSubstr(message))) << command[0];
  }
  EXPECT_FALSE(std::filesystem::exists(out));
}

TEST(WaterTargetsRun, TargetsThatNoSoundReachesAreErrors) {
  const std::string box =
      "[[objects]]\nname = \"wreck\"\nshape = \"box\"\nsize_m = [2, 2, 2]\nposition_m = [0, 9, 0]\n";
  expect_target_error(ahead_scene(target_at({0.25, 8.75, 0.5}) + box),
                      "scene.toml:12:", "target 'fish' is inside the closed object 'wreck'");
  expect_target_error(ahead_scene(target_at({3, 5, -30.5})),
                      "scene.toml:12:", "target 'fish' is 0.5 m below the seabed ('terrain')");
  expect_target_error(ahead_scene(target_at({3, 5.5, -30})),
                      "scene.toml:12:", "lies exactly on a facet of 'terrain'");
  expect_target_error(ahead_scene("[sea_surface]\nheight_m = 4\n" + target_at({0, 8, 4.5})),
                      "scene.toml:14:", "target 'fish' is 0.5 m above the sea surface");
  // The water that scatters may also state the height of its surface.
  const std::string with_surface = still_water() + "surface_height_m = 4\nvolume_scattering_db = -90\n";
  expect_target_error(ahead_scene(target_at({0, 8, 4.5}), "", with_surface),
                      "scene.toml:", "target 'fish' is 0.5 m above the sea surface (at 4 m)");
}

TEST(WaterTargetsRun, PopulationsAboveTheSeaSurfaceAreErrors) {
  const std::string school =
      "[[target_populations]]\nname = \"krill\"\ndensity_per_m3 = 1\nsize_m = [4, 4]\ntop_depth_m = -2\n"
      "bottom_depth_m = 3\ntarget_strength_db = -80\n";
  const std::string message =
      "the box of population 'krill' ends 2 m above the sea surface (at 4 m): set "
      "'top_depth_m' to 0 or more";
  const std::string with_surface = still_water() + "surface_height_m = 4\nvolume_scattering_db = -90\n";
  expect_target_error(ahead_scene("[sea_surface]\nheight_m = 4\n" + school), "scene.toml:14:", message);
  expect_target_error(ahead_scene(school, "", with_surface), "scene.toml:", message);
  // Water without a surface continues above depth 0.
  EXPECT_NO_THROW(echoes_of(ahead_scene(school)));
}

std::string population_text(const std::string& density, double size_m) {
  return fmt::format(
      "[[target_populations]]\nname = \"krill\"\ndensity_per_m3 = {}\nsize_m = [{}, {}]\n"
      "top_depth_m = -10\nbottom_depth_m = 10\ntarget_strength_db = -80\n",
      density, size_m, size_m);
}

TEST(WaterTargetsRun, TooManyTargetsAreAnErrorBeforeTheRun) {
  expect_target_error(ahead_scene(population_text("50000", 32)), "scene.toml:12:",
                      "population 'krill' has 1.02e+09 targets in the mean, but the limit is 5e+08: reduce "
                      "'density_per_m3'");
  expect_target_error(ahead_scene(population_text("100000", 10)),
                      "scene.toml:12:", "targets in the mean, but the limit is 1e+07");
  // Eigenrays and signals of targets take longer.
  const std::string stratified =
      "[water]\nsurface_height_m = 20\nprofile = \"gradient\"\nsound_speed_m_s = 1500\n"
      "gradient_per_s = 0.1\nprofile_bottom_m = 60\n";
  expect_target_error(
      ahead_scene(replaced(population_text("300", 10), "top_depth_m = -10", "top_depth_m = 5"), "",
                  stratified),
      "scene.toml:", "targets in the mean, but the limit in stratified water is 100000");
}

TEST_F(WaterTargetSignals, OfTooManyTargetsAreAnErrorBeforeTheRun) {
  const std::string text = replaced(scene(population_text("30000", 20), "", fixed_at(0, 0, 0)),
                                    "sampling_frequency_khz = 20\n", "sampling_frequency_khz = 2000\n");
  expect_target_error(
      text, "scene.toml:", "values in all channels, but the limit is 1e+10: set 'density_per_m3' to");
}

TEST(WaterTargetsRun, TheLimitsAreThoseOfTheirPage) {
  std::ifstream in(std::string(TUBEFOOT_SOURCE_DIR) + "/docs/limits.md");
  const std::string page{std::istreambuf_iterator<char>(in), {}};
  EXPECT_THAT(page,
              HasSubstr(fmt::format("\n| targets of a population; targets in the sector of a transmission "
                                    "(expected numbers) | {:.0f}; {:.0f} |",
                                    most_targets_of_population, most_targets_of_transmission)));
  EXPECT_THAT(page,
              HasSubstr(fmt::format("\n| the same in stratified water, for each transmission | {:.0f} |",
                                    most_targets_of_refracted_transmission)));
  EXPECT_THAT(page, HasSubstr(fmt::format(
                        "\n| values in the signals of populations in a ping: expected targets, times "
                        "receivers, times samples of a pulse | {:.0f} |",
                        most_target_signal_values)));
}

TEST(WaterTargetsRun, BadTablesAreErrorsWithTheirLine) {
  const std::string scene =
      ahead_scene(target_at({0, 8, 0}, "file = \"fish.csv\"\n"), "frequency_khz = 1800\n");
  const std::string head = "elevation_deg,azimuth_deg,frequency_hz,target_strength_db\n";
  expect_target_error(scene, "fish.csv:3:", "appear twice", head + "0,0,1.8e6,-30\n0,0,1.8e6,-31\n");
  expect_target_error(scene, "fish.csv:2:", "elevation_deg is 95", head + "95,0,1.8e6,-30\n");
  expect_target_error(scene, "fish.csv:2:", "target_strength_db is 'loud'", head + "0,0,1.8e6,loud\n");
  expect_target_error(scene, "fish.csv", "has no row for elevation 0 deg, azimuth 180 deg",
                      head + "0,0,1.8e6,-30\n5,0,1.8e6,-30\n5,180,1.8e6,-30\n");
  expect_target_error(scene, "fish.csv", "expected a full turn",
                      head + "0,0,1.8e6,-30\n0,10,1.8e6,-30\n0,20,1.8e6,-30\n");
  expect_target_error(scene, "fish.csv:1:", "the column target_strength_db is missing",
                      "elevation_deg,azimuth_deg,frequency_hz\n0,0,1.8e6\n");
  expect_target_error(scene,
                      "scene.toml:15:", "are for 38000 to 38000 Hz, but sensor 'sonar' uses 1.8e+06 Hz",
                      strength_table(38e3));
}

TEST(WaterTargetKeys, ContradictionsAreErrors) {
  const TestFolder folder;
  folder.write("fish.csv", strength_table(1.8e6));
  const auto error = [&](const std::string& text) { return scene_error(folder, ahead_scene(text)); };
  EXPECT_EQ(error(target_at({0, 8, 0}, "")),
            "scene.toml:12:1: target 'fish' has no target strength: add 'target_strength_db' or 'file'");
  EXPECT_THAT(error(target_at({0, 8, 0}, "target_strength_db = 1\nfile = \"fish.csv\"\n")),
              HasSubstr("give only one of the two"));
  EXPECT_THAT(error(target_at({0, 8, 0}, "target_strength_db = 1\nheading_deg = 3\n")),
              HasSubstr("'heading_deg' turns the axes of a table"));
  EXPECT_THAT(error(target_at({0, 8, 0}) + target_at({0, 9, 0})),
              HasSubstr("the name \"fish\" is already used"));
  EXPECT_THAT(error("[[targets]]\nname = \"x\"\nposition_lat_lon_deg = [1, 2]\ntarget_strength_db = 1\n"),
              HasSubstr("add [georeference]"));
  EXPECT_THAT(error("[[target_populations]]\nname = \"x\"\ndensity_per_m3 = 1\nsize_m = [1, 1]\n"
                    "top_depth_m = 5\nbottom_depth_m = 5\ntarget_strength_db = 1\n"),
              HasSubstr("the bottom must be deeper than the top"));
}

TEST(WaterTargetsRun, PathsOverMirrorsWarnThatTheyLeadToNoTarget) {
  const TestFolder folder;
  const auto file =
      folder.write("scene.toml", ahead_scene("[sea_surface]\nheight_m = 4\n" + target_at({0, 8, 1})));
  const Outcome outcome = run_program({"run", file.string(), "-o", (folder / "out").string()});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("lead to no target in the water"));
}

}  // namespace
}  // namespace tubefoot
