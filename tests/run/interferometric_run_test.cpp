// SPDX-License-Identifier: GPL-3.0-or-later
// The whole program on a tilted plane, whose angles of arrival have a closed form.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "fixtures/csv_rows.hpp"
#include "fixtures/netcdf_reader.hpp"
#include "fixtures/program.hpp"
#include "fixtures/scene_texts.hpp"
#include "sensors/receiver/phase_noise.hpp"

namespace tubefoot {
namespace {

using std::numbers::pi;
constexpr double degree = pi / 180, depth = 10, slope = 0.15, step = 0.02, baseline = 0.006,
                 tilt = 30 * degree;
constexpr double wavelength = 1500 / 500e3;

/// A plane that rises by `slope` to starboard (east), 10 m below the sensor.
const char* bed = "v -80 -20 -22\nv 80 -20 2\nv 80 20 2\nv -80 20 -22\nf 1 2 3\nf 1 3 4\n";

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
    folder.write("bed.obj", bed);
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
    // The first samples of a side are cut by the fan's lower edge, or see the plane twice: this side and the
    // other of its nearest point.
    const double twice = pi - 2 * std::atan(side * slope) - angle_at(range - step, side);
    if (!(angle_at(range - step, side) < 87 * degree && twice > 89 * degree)) continue;
    ++compared;
    // What a sample may be off by: half of the angles that it gathers, the plane wave's law, a beam of half a
    // degree that sees the plane a little beside its middle.
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
    // A sample's own spread of phases decorrelates, and so does what only one of the receivers has in it.
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
  // No line is lost, and the errors have the variance of the law at each line's coherence.
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

// All four channels have bounds in the file, which hold what an ordinary run finds.
TEST(InterferometricRun, AReferenceHoldsEnergiesAndProducts) {
  const TestFolder folder;
  const auto file = folder.write("scene.toml", R"(
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
)");
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
      EXPECT_LE(bound[k], 1.01e-4 * size + 1e-12) << name << ' ' << k;
      all += std::abs(middle[k]);
    }
    EXPECT_GT(all, 0) << name;
  }
}

// Half a baseline is longer than the sonar is high: one receiver would lie in the bed, and hear nothing.
TEST(InterferometricRun, AReceiverInTheBedIsRefused) {
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
staff_tilt_deg = 0
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

TEST(InterferometricRun, DoublesHaveNoCommonFootprints) {
  const SceneRun run(scene(), {"--arithmetic", "double"});
  EXPECT_EQ(run.outcome.exit_code, 2);
  EXPECT_NE(
      run.outcome.err.find("'swath' has two receivers, and their common footprints need an exact arithmetic"),
      std::string::npos)
      << run.outcome.err;
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

}  // namespace
}  // namespace tubefoot
