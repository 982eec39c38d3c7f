// SPDX-License-Identifier: GPL-3.0-or-later
// Tests whole runs of interferometers. The comparisons are closed forms of a tilted plane, travel times in
// one gradient, rays, and certified references.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "fixtures/csv_rows.hpp"
#include "fixtures/netcdf_reader.hpp"
#include "fixtures/program.hpp"
#include "fixtures/scene_texts.hpp"
#include "geometry/numbers/scalars.hpp"
#include "sensors/receiver/phase_noise.hpp"

namespace tubefoot {
namespace {

constexpr double depth = 10, slope = 0.15, step = 0.02, baseline = 0.006, tilt = 30 * degree;
constexpr double wavelength = 1500 / 500e3;

/// A plane that rises by `slope` to starboard (east), 10 m below the sensor.
const char* seabed = "v -80 -20 -22\nv 80 -20 2\nv 80 20 2\nv -80 20 -22\nf 1 2 3\nf 1 3 4\n";

std::string scene(const std::string& more = "") {
  return still_water() + fmt::format(R"([[materials]]
name = "sand"
[[objects]]
name = "bed"
shape = "mesh"
file = "bed.obj"
[trajectory]
kind = "fixed"
[[sensors]]
name = "swath"
preset = "geoswath-500"
range_min_m = 8
range_max_m = 38
samples = 1500
baseline_m = {}
{})",
                                     baseline, more);
}

/// Angle of arrival below the horizontal from a slant range; `side` is 1 for starboard.
double angle_at(double range, double side) {
  const double rise = std::atan(side * slope);
  return std::asin(depth * std::cos(rise) / range) - rise;
}

struct SceneRun {
  TestFolder folder;
  explicit SceneRun(const std::string& text, const std::vector<std::string>& more = {}) {
    folder.write("bed.obj", seabed);
    const auto file = folder.write("scene.toml", text);
    std::vector<std::string> arguments{"run", file.string(), "-o", (folder / "out").string(), "--quiet"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    outcome = run_program(arguments);
  }
  Outcome outcome;
};

std::vector<double> variable(const std::filesystem::path& file, const char* name) {
  return NetcdfReader(file).values("/", name);
}

TEST(InterferometricRun, SoundingsLieOnTheTiltedPlane) {
  const SceneRun run(scene());
  ASSERT_EQ(run.outcome.exit_code, 0) << run.outcome.err;
  const auto out = run.folder / "out";
  const std::vector<double> energy = variable(out / "echoes.nc", "energy"),
                            lower = variable(out / "echoes.nc", "energy_lower"),
                            real = variable(out / "echoes.nc", "cross_real"),
                            imaginary = variable(out / "echoes.nc", "cross_imag");
  std::size_t port = 0, starboard = 0, compared = 0;
  for (const auto& row : csv_rows(out / "swath-soundings.csv")) {
    const auto value = [&](const char* name) { return std::stod(row.at(name)); };
    const double side = row.at("side") == "port" ? -1 : 1, range = value("range_m");
    (side < 0 ? port : starboard) += 1;
    const std::size_t cell = (side < 0 ? 0u : 1500u) + std::size_t(value("sample"));
    EXPECT_NEAR(range, 8 + (value("sample") + 0.5) * step, 1e-7);
    EXPECT_NEAR(value("energy_j"), energy[cell], 1e-8 * energy[cell]);
    EXPECT_NEAR(value("phase_rad"), std::atan2(imaginary[cell], real[cell]), 1e-7);
    EXPECT_NEAR(value("coherence"),
                std::hypot(real[cell], imaginary[cell]) / std::sqrt(energy[cell] * lower[cell]), 1e-7);
    // The lower edge of the fan cuts the first range bins of a side. Other first bins contain the plane
    // twice, on both sides of its nearest point.
    const double twice = pi - 2 * std::atan(side * slope) - angle_at(range - step, side);
    if (!(angle_at(range - step, side) < 87 * degree && twice > 89 * degree)) continue;
    ++compared;
    // Error limit of a range bin: half of its range of angles, the plane-wave approximation, and the beam
    // width. The beam of half a degree sees the plane slightly beside its middle.
    const double angle = angle_at(range, side);
    const double gathered = std::max(std::abs(angle_at(range - step / 2, side) - angle),
                                     std::abs(angle_at(range + step / 2, side) - angle));
    const double beside = std::pow(0.25 * degree, 2) * std::abs(std::tan(angle - tilt));
    const double bound = gathered + std::pow(baseline / range, 2) / 16 + beside;
    ASSERT_NEAR(value("angle_deg"), angle / degree, bound / degree) << row.at("side") << " " << range;
    EXPECT_NEAR(value("depth_m"), range * std::sin(value("angle_deg") * degree), 1e-6);
    EXPECT_NEAR(value("east_m"), side * range * std::cos(value("angle_deg") * degree), 1e-6);
    EXPECT_NEAR(value("up_m"), -value("depth_m"), 1e-9);
    EXPECT_EQ(value("north_m"), 0);
    const double off_plane = std::abs(value("up_m") + depth - slope * value("east_m")) / std::hypot(1, slope);
    EXPECT_LT(off_plane, range * bound) << range;
    // The spread of phases in a range bin reduces the coherence, and so does the energy that only one
    // receiver has in this bin.
    const double half = pi * baseline / wavelength *
                        std::abs(std::sin(angle_at(range - step / 2, side) - tilt) -
                                 std::sin(angle_at(range + step / 2, side) - tilt));
    const double common = 1 - baseline / 2 * std::abs(std::sin(angle - tilt)) / step;
    if (angle < 75 * degree) {
      EXPECT_NEAR(value("coherence"), std::sin(common * half) / half, 4e-4) << range;
    }
  }
  EXPECT_GT(compared, 2700u);
  EXPECT_GT(port, 1300u);
  EXPECT_GT(starboard, 1300u);
  for (const char* file :
       {"swath.png", "swath.exr", "swath-phase.png", "swath-phase.exr", "swath-coherence.exr"})
    EXPECT_GT(std::filesystem::file_size(out / file), 1000u) << file;
}

TEST(InterferometricRun, PhaseNoiseFollowsTheSeedAndReceiverNoiseLowersCoherence) {
  const SceneRun silent(scene()),
      noisy(scene("phase_noise = true\nnoise_level_db = 130\nsource_level_db = 200\n")),
      again(scene("phase_noise = true\nnoise_level_db = 130\nsource_level_db = 200\n")),
      other(scene("phase_noise = true\nnoise_level_db = 130\nsource_level_db = 200\n"), {"--seed", "7"});
  const auto read = [](const SceneRun& run) {
    EXPECT_EQ(run.outcome.exit_code, 0) << run.outcome.err;
    return csv_rows(run.folder / "out" / "swath-soundings.csv");
  };
  const auto a = read(silent), b = read(noisy), c = read(again), d = read(other);
  EXPECT_EQ(b, c);
  EXPECT_NE(b, d);
  // No line is missing, and the errors have the variance of the law at the coherence of each line.
  ASSERT_EQ(a.size(), b.size());
  std::map<std::pair<std::string, std::string>, double> truth;
  for (const auto& row : a) truth[{row.at("side"), row.at("sample")}] = std::stod(row.at("phase_rad"));
  double sum = 0, squares = 0, count = 0, low = 0;
  for (const auto& row : b) {
    const auto found = truth.find({row.at("side"), row.at("sample")});
    ASSERT_NE(found, truth.end());
    const double coherence = std::stod(row.at("coherence")), variance = phase_variance(coherence);
    const double error = std::remainder(std::stod(row.at("phase_rad")) - found->second, 2 * pi);
    const double ratio = error * error / variance;
    sum += ratio;
    squares += ratio * ratio;
    ++count;
    low += coherence < 0.9;
  }
  const double mean = sum / count;
  EXPECT_NEAR(mean, 1, 4 * std::sqrt((squares / count - mean * mean) / count)) << count;
  EXPECT_GT(low, 100);
}

// All four channels have bounds in the file, which contain the values of an ordinary run.
TEST(InterferometricRun, AReferenceHoldsEnergiesAndProducts) {
  // The transmitter is in the middle, separate, and under a surface that is a mirror.
  for (const auto& [tables, keys] :
       {std::pair("", ""),
        {"", "receiver_arm_m = [1, 0.5, 0.25]\n"},
        {"[sea_surface]\nheight_m = 6.5\n[paths]\norder = 2\n", "depression_min_deg = -60\n"}}) {
    SCOPED_TRACE(std::string(tables) + keys);
    const TestFolder folder;
    const auto file = folder.write("scene.toml", tables + std::string(R"(
[[materials]]
name = "mud"
[[terrain]]
kind = "flat"
width_m = 60
length_m = 60
cell_m = 3
[trajectory]
kind = "fixed"
position_m = [0, 0, 6]
[[sensors]]
name = "swath"
kind = "interferometric"
along_track_deg = 3
frequency_khz = 100
baseline_m = 0.05
range_min_m = 6
range_max_m = 14
samples = 8
)") + keys);
    const auto run = [&](const char* out, std::vector<std::string> more) {
      std::vector<std::string> words{"run", file.string(), "-o", (folder / out).string()};
      words.insert(words.end(), more.begin(), more.end());
      const Outcome outcome = run_program(words);
      EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
      return folder / out / "echoes.nc";
    };
    const NetcdfReader ordinary(run("ordinary", {})),
        reference(run("reference", {"--reference", "--tolerance", "1e-4"}));
    const auto upper = ordinary.values("/", "energy"), lower = ordinary.values("/", "energy_lower");
    for (const std::string name : {"energy", "energy_lower", "cross_real", "cross_imag"}) {
      const auto found = ordinary.values("/", name), middle = reference.values("/", name),
                 bound = reference.values("/", name + "_bound");
      ASSERT_EQ(bound.size(), found.size());
      double all = 0;
      for (std::size_t k = 0; k < found.size(); ++k) {
        const double size = std::max(upper[k], lower[k]);
        EXPECT_LE(std::abs(found[k] - middle[k]), bound[k] + 1e-7 * size) << name << ' ' << k;
        EXPECT_LE(bound[k], 2e-4 * size + 1e-12) << name << ' ' << k;
        all += std::abs(middle[k]);
      }
      EXPECT_GT(all, 0) << name;
    }
  }
}

// Half a baseline exceeds the height of the sonar. One receiver would lie in the seabed and receive
// nothing.
TEST(InterferometricRun, AReceiverInTheSeabedIsRefused) {
  const TestFolder folder;
  const auto file = folder.write("scene.toml", R"(
[[materials]]
name = "mud"
[[terrain]]
kind = "flat"
width_m = 60
length_m = 60
[trajectory]
kind = "fixed"
position_m = [0, 0, 0.9]
[[sensors]]
name = "swath"
kind = "interferometric"
receiver_pair_tilt_deg = 0
baseline_m = 2
range_min_m = 2
range_max_m = 20
samples = 64
)");
  const Outcome check = run_program({"check", file.string()});
  EXPECT_EQ(check.exit_code, 2) << check.out;
  EXPECT_NE(check.err.find("the lower receiver of sensor 'swath' is 0.1 m below the seabed"),
            std::string::npos)
      << check.err;
}

TEST(InterferometricRun, DoublesSeeTheSamePhases) {
  const auto few = [](std::string text) {
    return replaced(replaced(text, "samples = 1500", "samples = 40"), "range_max_m = 38", "range_max_m = 18");
  };
  const SceneRun exact(few(scene())), doubles(few(scene()), {"--arithmetic", "double"});
  ASSERT_EQ(exact.outcome.exit_code, 0) << exact.outcome.err;
  ASSERT_EQ(doubles.outcome.exit_code, 0) << doubles.outcome.err;
  const auto a = csv_rows(exact.folder / "out" / "swath-soundings.csv"),
             b = csv_rows(doubles.folder / "out" / "swath-soundings.csv");
  ASSERT_EQ(a.size(), b.size());
  ASSERT_FALSE(a.empty());
  for (std::size_t k = 0; k < a.size(); ++k)
    for (const char* column : {"phase_rad", "coherence"})
      EXPECT_NEAR(std::stod(a[k].at(column)), std::stod(b[k].at(column)), 1e-9) << column << ' ' << k;
}

TEST(InterferometricRun, RaysAgreeWithFootprints) {
  const auto few = [](std::string text) {
    return replaced(replaced(text, "samples = 1500", "samples = 10"), "range_max_m = 38", "range_max_m = 18");
  };
  const SceneRun tubes(few(scene())), rays(few(scene()), {"--engine", "ray", "--rays", "400000"});
  ASSERT_EQ(tubes.outcome.exit_code, 0) << tubes.outcome.err;
  ASSERT_EQ(rays.outcome.exit_code, 0) << rays.outcome.err;
  const auto a = csv_rows(tubes.folder / "out" / "swath-soundings.csv"),
             b = csv_rows(rays.folder / "out" / "swath-soundings.csv");
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t k = 0; k < a.size(); ++k) {
    EXPECT_NEAR(std::remainder(std::stod(a[k].at("phase_rad")) - std::stod(b[k].at("phase_rad")), 2 * pi), 0,
                0.02);
    EXPECT_NEAR(std::stod(a[k].at("coherence")), std::stod(b[k].at("coherence")), 0.01);
  }
}

/// The sonar is 8 m above a seabed, next to a quay wall.
std::string short_scene(const std::string& kind, const std::string& water, const std::string& more = "") {
  return water + R"([[materials]]
name = "sand"
[[terrain]]
kind = "flat"
width_m = 60
length_m = 8
centre_m = [0, 0, -8]
[[objects]]
name = "quay"
shape = "box"
size_m = [1, 6, 7]
position_m = [14, 0, -5]
[trajectory]
kind = "fixed"
[[sensors]]
name = "swath"
frequency_khz = 250
along_track_deg = 1
depression_min_deg = -60
range_min_m = 5
range_max_m = 25
samples = 80
)" + fmt::format("kind = \"{}\"\n{}", kind, more);
}

struct Channels {
  std::vector<double> energy, lower, real, imaginary;
  explicit Channels(const std::string& text) {
    const TestFolder folder;
    const auto file = folder.write("scene.toml", text);
    const Outcome outcome = run_program({"run", file.string(), "-o", (folder / "out").string(), "--quiet"});
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    if (outcome.exit_code != 0) return;
    const auto nc = folder / "out" / "echoes.nc";
    energy = variable(nc, "energy");
    if (text.find("interferometric") == std::string::npos) return;
    lower = variable(nc, "energy_lower");
    real = variable(nc, "cross_real");
    imaginary = variable(nc, "cross_imag");
  }
};

void expect_near(const std::vector<double>& a, const std::vector<double>& b, double scale) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t k = 0; k < a.size(); ++k) EXPECT_NEAR(a[k], b[k], scale) << k;
}

void expect_near(const Channels& a, const Channels& b, double tolerance) {
  ASSERT_FALSE(b.energy.empty());
  const double scale = tolerance * *std::ranges::max_element(b.energy);
  EXPECT_GT(scale, 0);
  expect_near(a.energy, b.energy, scale);
  expect_near(a.lower, b.lower, scale);
  expect_near(a.real, b.real, scale);
  expect_near(a.imaginary, b.imaginary, scale);
}

const std::string surface =
    "[water]\nsound_speed_m_s = 1500\n[sea_surface]\nheight_m = 4\nloss_db = 1\n[paths]\norder = 3\n";

// Two receivers at one position receive the same as a sidescan, over mirrors and with two scatterings.
TEST(InterferometricRun, OverMirrorsAShortReceiverPairIsOneReceiver) {
  for (const std::string paths : {"only_order = 2\n", "only_order = 3\nscatterings = 2\npatch_m = 2\n"}) {
    const Channels one(short_scene("sidescan", surface + paths)),
        both(short_scene("interferometric", surface + paths, "baseline_m = 1e-5\n"));
    const double scale = 3e-3 * *std::ranges::max_element(one.energy);
    EXPECT_GT(scale, 0);
    expect_near(both.energy, one.energy, scale);
    expect_near(both.lower, one.energy, scale);
    expect_near(both.real, one.energy, scale);
    // the phase is 0.01
    for (const double imaginary : both.imaginary) EXPECT_NEAR(imaginary, 0, 4 * scale);
  }
}

TEST(InterferometricRun, OverMirrorsReceiversHaveNoMoreInCommonThanEither) {
  const Channels both(
      short_scene("interferometric", surface, "baseline_m = 0.02\nreceiver_pair_tilt_deg = 20\n"));
  ASSERT_FALSE(both.energy.empty());
  double turned = 0;
  for (std::size_t k = 0; k < both.energy.size(); ++k) {
    EXPECT_LE(std::hypot(both.real[k], both.imaginary[k]),
              std::sqrt(both.energy[k] * both.lower[k]) * (1 + 1e-6));
    turned = std::max(turned, std::abs(both.imaginary[k]) / both.energy[k]);
  }
  EXPECT_GT(turned, 0.3);
}

TEST(InterferometricRun, AReceiverPairOverTheSurfaceIsRefused) {
  const SceneRun run(short_scene("interferometric", replaced(surface, "height_m = 4", "height_m = 0.005"),
                                 "baseline_m = 0.02\nreceiver_pair_tilt_deg = 0\n"));
  EXPECT_EQ(run.outcome.exit_code, 2);
  EXPECT_NE(run.outcome.err.find("the receiver pair of sensor 'swath' is 0.005 m above the sea surface"),
            std::string::npos)
      << run.outcome.err;
}

std::string gradient(double per_s) {
  return fmt::format(
      "[water]\nprofile = \"gradient\"\nsound_speed_m_s = 1500\ngradient_per_s = {}\n"
      "profile_bottom_m = 40\nsurface_height_m = 5\n",
      per_s);
}

TEST(InterferometricRun, ATransmitterBesideItsReceiverPairByNothingIsInItsMiddle) {
  // Facets with refracted rays keep 0.1 dB.
  for (const auto& [water, tolerance] : {std::pair(still_water(), 1e-4), std::pair(gradient(2), 0.02)}) {
    const std::string receiver_pair = "baseline_m = 0.02\nreceiver_pair_tilt_deg = 20\n";
    expect_near(
        Channels(short_scene("interferometric", water, receiver_pair + "receiver_arm_m = [1e-5, 0, 0]\n")),
        Channels(short_scene("interferometric", water, receiver_pair)), tolerance);
  }
}

TEST(InterferometricRun, ATransmitterBesideItsReceiverPairInIsovelocityWaterThatIsReportedAsLayers) {
  const std::string receiver_pair =
      "baseline_m = 0.02\nreceiver_pair_tilt_deg = 20\nreceiver_arm_m = [0.5, 0.2, -0.8]\n";
  expect_near(Channels(short_scene("interferometric", gradient(1e-7), receiver_pair)),
              Channels(short_scene("interferometric", "[water]\nsound_speed_m_s = 1500\n", receiver_pair)),
              1e-3);
}

/// A point in a vertical plane of water in which the sound speed increases by 5 m/s per metre of depth.
struct Place {
  static constexpr double g = 5;
  double x, z;
  double speed() const { return 1500 + g * (5 - z); }
};
/// Computes the travel time in closed form.
double time_between(Place a, Place b) {
  const double d2 = (a.x - b.x) * (a.x - b.x) + (a.z - b.z) * (a.z - b.z);
  return std::acosh(1 + Place::g * Place::g * d2 / (2 * a.speed() * b.speed())) / Place::g;
}

constexpr double receiver_pair_m = 0.02, receiver_pair_first_m = 12, receiver_pair_sample_m = 0.05;
std::string far_scene(double tilt_deg, const std::string& more) {
  std::string text =
      short_scene("interferometric", gradient(Place::g),
                  fmt::format("baseline_m = 0.02\nreceiver_pair_tilt_deg = {}\n{}", tilt_deg, more));
  text = replaced(text, "range_min_m = 5", "range_min_m = 12");
  text = replaced(text, "samples = 80", "samples = 260");
  text = replaced(text, "along_track_deg = 1", "along_track_deg = 0.2");
  return replaced(text, "position_m = [14, 0, -5]", "position_m = [-14, 0, -5]");
}

/// Expects that phases in 260 cells, from `cells` on, follow from the travel times to both ends of a
/// receiver pair. `speed`: reference speed of the reported ranges.
void expect_phases_of_times(const Channels& both, std::size_t cells, Place sent, Place middle, double speed,
                            double tilt_deg) {
  const double ax = receiver_pair_m / 2 * std::sin(tilt_deg * degree),
               az = receiver_pair_m / 2 * std::cos(tilt_deg * degree);
  const Place upper{middle.x + ax, middle.z + az}, lower{middle.x - ax, middle.z - az};
  std::size_t compared = 0;
  for (std::size_t k = 0; k < 260; ++k) {
    const std::size_t cell = cells + k;
    if (!(both.energy[cell] > 0) ||
        !(std::hypot(both.real[cell], both.imaginary[cell]) > 0.8 * both.energy[cell]))
      continue;
    const double half = receiver_pair_first_m + (double(k) + 0.5) * receiver_pair_sample_m;
    double low = 3, high = 40;
    for (int i = 0; i < 60; ++i) {
      const Place met{(low + high) / 2, -8};
      (speed * (time_between(sent, met) + time_between(met, middle)) / 2 < half ? low : high) = met.x;
    }
    const Place met{low, -8};
    if (met.x > 24) continue;
    const double phase = 2 * pi * 250e3 * (time_between(met, upper) - time_between(met, lower));
    EXPECT_NEAR(std::remainder(std::atan2(both.imaginary[cell], both.real[cell]) - phase, 2 * pi), 0, 0.03)
        << half << " m, " << phase;
    ++compared;
  }
  EXPECT_GT(compared, 100u);
}

// The receiver pair hangs 4 m below its transmitter, where the sound speed is higher.
TEST(InterferometricRun, PhasesOfAReceiverPairBelowItsTransmitterAreThoseOfTravelTimes) {
  const Channels both(far_scene(20, "receiver_arm_m = [0.5, 0, -4]\n"));
  ASSERT_EQ(both.energy.size(), 520u);
  const Place sent{0, 0};
  expect_phases_of_times(both, 260, sent, {0.5, -4}, sent.speed(), 20);
}

// The sonar leaves the depth of its reference speed: at its second ping it is 2 m deeper.
TEST(InterferometricRun, PhasesAtAnotherDepthThanTheFirstAreThoseOfTravelTimes) {
  const Channels both(replaced(far_scene(60, "pings = 2\nping_interval_s = 1\n"), "kind = \"fixed\"\n",
                               "kind = \"line\"\nstart_m = [0, 0, 0]\nend_m = [0, 1, -2]\nspeed_m_s = "
                               "2.23606797749979\n"));
  ASSERT_EQ(both.energy.size(), 1040u);
  const Place first{0, 0}, second{0, -2};
  expect_phases_of_times(both, 260, first, first, first.speed(), 60);
  expect_phases_of_times(both, 780, second, second, first.speed(), 60);
}

/// The sonar is 8 m above a flat seabed, with bins of `bin_m` from 12 m on.
std::string long_baseline_scene(double bin_m, double gradient_per_s, const std::string& water_keys,
                                const std::string& more) {
  return gradient(gradient_per_s) + water_keys + lambert_material("mud", -20) +
         flat_terrain(80, 8, "centre_m = [0, 0, -8]\n") + fixed_at(0, 0, 0) +
         fmt::format(
             "[[sensors]]\nname = \"swath\"\nkind = \"interferometric\"\nfrequency_khz = 100\n"
             "along_track_deg = 0.5\nbaseline_m = 0.3\nrange_min_m = 12\nrange_max_m = 36\nsamples = {}\n{}",
             std::lround(24 / bin_m), more);
}

// By default, phases are as accurate as the baseline resolves, for any length of the range bins.
TEST(InterferometricRun, PhasesOfALongBaselineInStratifiedWaterAreRightByDefault) {
  for (const char* more : {"", "receiver_arm_m = [0.5, 0, -1]\n"})
    for (const auto& [bin_m, gradient_per_s] : {std::pair(0.1, 0.3), {1.0, 0.05}}) {
      SCOPED_TRACE(fmt::format("{} {}", bin_m, more));
      const std::string finely = "refraction_gap_m = 1e-5\nrefraction_tolerance_db = 0.005\n";
      const Channels usual(long_baseline_scene(bin_m, gradient_per_s, "", more)),
          fine(long_baseline_scene(bin_m, gradient_per_s, finely, more));
      ASSERT_EQ(usual.energy.size(), fine.energy.size());
      double worst = 0;
      std::size_t compared = 0;
      for (std::size_t k = 0; k < fine.energy.size(); ++k) {
        const double common = std::hypot(fine.real[k], fine.imaginary[k]);
        if (!(common > 0.3 * std::max(fine.energy[k], fine.lower[k])) || !(fine.energy[k] > 0)) continue;
        const double off =
            std::atan2(usual.imaginary[k], usual.real[k]) - std::atan2(fine.imaginary[k], fine.real[k]);
        worst = std::max(worst, std::abs(std::remainder(off, 2 * pi)));
        ++compared;
      }
      EXPECT_GT(compared, fine.energy.size() / 2);
      EXPECT_LT(worst, 0.012);
    }
}

// In stratified water the reference chooses its own apparent map, and traces rays to each receiver.
TEST(InterferometricRun, AReferenceInRefractingWaterHoldsEnergiesAndProducts) {
  for (const std::string keys : {"", "receiver_arm_m = [1, 0.5, 0.25]\n"}) {
    SCOPED_TRACE(keys);
    const TestFolder folder;
    const auto scene_at = [&](const std::string& water_keys) {
      return R"([water]
profile = "gradient"
sound_speed_m_s = 1500
gradient_per_s = 0.5
profile_bottom_m = 40
surface_height_m = 10
)" + water_keys +
             R"([[materials]]
name = "mud"
[[terrain]]
kind = "flat"
width_m = 40
length_m = 12
cell_m = 4
[trajectory]
kind = "fixed"
position_m = [0, 0, 6]
[[sensors]]
name = "swath"
kind = "interferometric"
along_track_deg = 3
frequency_khz = 100
baseline_m = 0.05
range_min_m = 7
range_max_m = 11
samples = 8
)" + keys;
    };
    const auto run = [&](const char* out, const std::string& text, std::vector<std::string> more) {
      const auto file = folder.write(std::string(out) + ".toml", text);
      std::vector<std::string> words{"run", file.string(), "-o", (folder / out).string()};
      words.insert(words.end(), more.begin(), more.end());
      const Outcome outcome = run_program(words);
      EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
      return folder / out / "echoes.nc";
    };
    const NetcdfReader fine(
        run("fine", scene_at("refraction_gap_m = 0.0005\nrefraction_tolerance_db = 0.005\n"), {})),
        ordinary(run("ordinary", scene_at(""), {})),
        reference(run("reference", scene_at(""), {"--reference", "--tolerance", "2e-2"}));
    const auto upper = fine.values("/", "energy"), lower = fine.values("/", "energy_lower");
    double bounds = 0, sizes = 0, turned = 0;
    for (const std::string name : {"energy", "energy_lower", "cross_real", "cross_imag"}) {
      const auto finely = fine.values("/", name), usual = ordinary.values("/", name),
                 middle = reference.values("/", name), bound = reference.values("/", name + "_bound");
      ASSERT_EQ(bound.size(), finely.size());
      for (std::size_t k = 0; k < finely.size(); ++k) {
        const double size = std::max(upper[k], lower[k]);
        EXPECT_LE(std::abs(finely[k] - middle[k]), bound[k] + 3e-3 * size) << name << ' ' << k;
        // The ordinary run promises 0.1 dB, and a quarter of a range bin.
        EXPECT_LE(std::abs(usual[k] - middle[k]), bound[k] + 0.03 * size) << name << ' ' << k;
        if (bound[k] > 3e-3 * size) {
          EXPECT_GT(std::abs(finely[k] + 2 * bound[k] + 6e-3 * size - middle[k]), bound[k]) << name << k;
        }
        bounds += bound[k];
        sizes += size;
        if (name == "cross_imag" && size > 0) turned = std::max(turned, std::abs(middle[k]) / size);
      }
    }
    EXPECT_GT(sizes, 0);
    EXPECT_LT(bounds, 0.03 * sizes);
    EXPECT_GT(turned, 0.5);
  }
}

}  // namespace
}  // namespace tubefoot
