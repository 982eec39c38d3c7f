// SPDX-License-Identifier: GPL-3.0-or-later
// Tests refraction in whole runs. A flat seabed under one gradient has a closed form (physics.md 2.2) with
// ring areas, tube areas and angles. Several layers are compared with separately integrated rays.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>
#include <numbers>
#include <numeric>

#include "engine/scattering/perlin_reflectivity.hpp"
#include "fixtures/world/echoes.hpp"
#include "fixtures/world/gradient_scenes.hpp"

namespace tubefoot {
namespace {

using testing::HasSubstr;
using namespace test;

/// Largest error of the range bins beyond 10.3 m, in dB, and relative error of their sum.
struct Errors {
  double worst_db = 0, sum = 0;
};
Errors errors_of(const Echoes& echoes, double g, double absorption_db_per_km) {
  Errors errors;
  double found = 0, wanted = 0;
  for (std::size_t k = 0; k < echoes.samples; ++k) {
    if (echoes.first_m(k) < 10.3) continue;
    const double truth = ring_energy(g, echoes.first_m(k), echoes.last_m(k), absorption_db_per_km);
    errors.worst_db = std::max(errors.worst_db, std::abs(10 * std::log10(echoes.at(0, 0, k) / truth)));
    found += echoes.at(0, 0, k);
    wanted += truth;
  }
  errors.sum = std::abs(found / wanted - 1);
  return errors;
}

TEST(RefractionRun, FlatSeabedUnderOneGradientIsTheClosedForm) {
  for (const double g : {-0.5, 0.4}) {
    for (const double absorption : {0.0, 400.0}) {
      SCOPED_TRACE(fmt::format("g {} absorption {}", g, absorption));
      const Errors usual = errors_of(echoes_of(scene_in(gradient(g, absorption))), g, absorption);
      EXPECT_LT(usual.worst_db, 0.1);
      const Errors fine =
          errors_of(echoes_of(scene_in(gradient(
                        g, absorption, "refraction_tolerance_db = 0.005\nrefraction_gap_m = 0.0005\n"))),
                    g, absorption);
      EXPECT_LT(fine.worst_db, 0.01);
      EXPECT_LT(fine.sum, 1.1e-4);
    }
  }
}

// Half the edge length gives a quarter of the travel-path error and of the energy error.
TEST(RefractionRun, EnergiesConvergeAtSecondOrderInTheEdges) {
  const double g = -1;
  std::vector<double> error;
  // totals of larger facets are as accurate with centroid binning
  for (const double gap : {0.01, 0.0025, 0.000625})
    error.push_back(
        errors_of(echoes_of(scene_in(gradient(
                      g, 0, fmt::format("refraction_tolerance_db = 10\nrefraction_gap_m = {}\n", gap)))),
                  g, 0)
            .sum);
  EXPECT_LT(error[2], error[0] / 4) << error[0] << ' ' << error[1] << ' ' << error[2];
  EXPECT_LT(error[2], 2e-4);
}

// The energy errors of a coarse apparent map have both signs. In total, large facets are as accurate as
// small ones, and so is the default.
TEST(RefractionRun, TotalsAreNotBiasedByTheTolerance) {
  for (const double g : {-0.5, 0.016, 0.4}) {
    const Errors usual = errors_of(echoes_of(scene_in(gradient(g))), g, 0);
    EXPECT_LT(usual.sum, 1.5e-3) << g;
    const Errors coarse = errors_of(
        echoes_of(scene_in(gradient(g, 0, "refraction_tolerance_db = 10\nrefraction_gap_m = 0.05\n"))), g, 0);
    EXPECT_LT(coarse.sum, 2e-3) << g;
  }
}

double largest_travel_path_error_m(const TestFolder& folder, const std::string& scene) {
  const auto out = folder / "out";
  const Outcome run =
      run_program({"run", folder.write("scene.toml", scene).string(), "-o", out.string(), "--quiet"});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  return nlohmann::json::parse(std::ifstream(out / "stats.json")).at("refraction").at("largest_gap_m");
}

TEST(RefractionRun, TheGapThatIsRequestedIsKept) {
  const TestFolder folder;
  for (const double gap : {1e-2, 1e-3, 1e-5}) {  // for any length of the range bins
    const std::string requested =
        replaced(scene_in(gradient(-1, 0, fmt::format("refraction_gap_m = {}\n", gap))), "samples = 128",
                 "samples = 8");
    EXPECT_LE(largest_travel_path_error_m(folder, requested), gap);
    const Outcome check = run_program({"check", (folder / "scene.toml").string()});
    EXPECT_EQ(check.exit_code, 0) << check.err;
    EXPECT_THAT(check.out, HasSubstr(", requested: "));
  }
}

TEST(RefractionRun, RaysSeeTheSameSurface) {
  const double g = -0.5;
  const Echoes rays = echoes_of(scene_in(gradient(g)), {"--engine", "ray", "--rays", "200000"});
  EXPECT_LT(errors_of(rays, g, 0).sum, 0.015);  // error of the random rays
}

// The texture has the true positions of the seabed, up to a metre from the apparent ones. The energy of a
// range bin relative to a uniform seabed is the mean of the texture over its ring.
TEST(RefractionRun, MicroTextureIsThatOfTheTrueSeabed) {
  const double g = -2, cr = c_sonar + g * above_seabed_m;
  const std::string even =
      scene_in(gradient(g, 0, "refraction_gap_m = 0.002\nrefraction_tolerance_db = 0.02"));
  const Echoes plain = echoes_of(even),
               textured = echoes_of(
                   replaced(even, "lambert_db = -27",
                            "lambert_db = -27\n[[materials.reflectivity]]\nkind = "
                            "\"perlin\"\nwavelength_m = 1.5\noctaves = 1\ndepth = 0.8\nseed = 7\n"));
  const PerlinReflectivity texture({.wavelength_m = 1.5, .octaves = 1, .depth = 0.8, .seed = 7});
  double least = 2, most = 0;
  for (std::size_t k = 0; k < plain.samples; ++k) {
    if (plain.first_m(k) < 10.5) continue;
    double mean = 0;
    constexpr int n = 16;
    for (int i = 0; i < n; ++i) {
      const double r = plain.first_m(k) + (i + 0.5) / n * (plain.last_m(k) - plain.first_m(k));
      const double x = std::sqrt(2 * c_sonar * cr / (g * g) * (std::cosh(g * r / c_sonar) - 1) -
                                 above_seabed_m * above_seabed_m);
      for (int j = 0; j < n; ++j) {
        const double heading = 37 * degree + fan_rad * ((j + 0.5) / n - 0.5);
        mean += texture.factor({x * std::sin(heading), x * std::cos(heading), 0}) / n / n;
      }
    }
    EXPECT_NEAR(textured.at(0, 0, k) / plain.at(0, 0, k), mean, 0.01) << k;
    least = std::min(least, mean);
    most = std::max(most, mean);
  }
  EXPECT_GT(most - least, 0.5);
}

// The fan ends 85 degrees below the horizontal. The seabed begins to return when this ray reaches it.
TEST(RefractionRun, FirstEchoComesWithTheSteepestRay) {
  for (const double g : {-2.0, 2.0}) {
    const Echoes echoes = echoes_of(scene_in(gradient(g)));
    const double cs = std::cos(85 * degree), cr = cs * (c_sonar + g * above_seabed_m) / c_sonar;
    const double t = (std::atanh(std::sqrt(1 - cs * cs)) - std::atanh(std::sqrt(1 - cr * cr))) / g;
    std::size_t first = 0;
    while (echoes.at(0, 0, first) == 0) ++first;
    EXPECT_EQ(first, echoes.sample_at(c_sonar * t)) << g;
  }
}

TEST(RefractionRun, AlmostIsovelocityWaterIsTheStraightRun) {
  const Echoes straight = echoes_of(replaced(scene_in("sound_speed_m_s = 1500\nabsorption_db_per_km = 200"),
                                             "surface_height_m = 20\n", ""));
  // [water] in isovelocity water has no surface.
  const Echoes refracted = echoes_of(scene_in(gradient(1e-8, 200)));
  EXPECT_LT(largest_relative_difference(straight, refracted), 1e-6);
}

/// Rays by Runge-Kutta through layers, from the sonar to the seabed: range, time and arrival angle, by
/// launch angle.
struct Landing {
  double range_m, time_s, arrival_rad;
};
Landing landing(const std::function<double(double)>& speed, double launch_rad) {
  // d/ds of range, depth, angle; the gradient by differences within a layer.
  const auto slope = [&](const std::array<double, 4>& s) {
    const double c = speed(s[1]), g = (speed(s[1] + 1e-6) - speed(s[1] - 1e-6)) / 2e-6;
    return std::array<double, 4>{std::cos(s[2]), std::sin(s[2]), -g / c * std::cos(s[2]), 1 / c};
  };
  std::array<double, 4> s{0, 10, launch_rad, 0};
  const auto moved = [](std::array<double, 4> at, const std::array<double, 4>& by, double step) {
    for (int i = 0; i < 4; ++i) at[i] += step * by[i];
    return at;
  };
  for (double step = 0.02; step > 1e-9;) {
    const auto k1 = slope(s), k2 = slope(moved(s, k1, step / 2)), k3 = slope(moved(s, k2, step / 2)),
               k4 = slope(moved(s, k3, step));
    std::array<double, 4> next = s;
    for (int i = 0; i < 4; ++i) next[i] += step / 6 * (k1[i] + 2 * k2[i] + 2 * k3[i] + k4[i]);
    if (next[1] > 20)
      step /= 2;
    else
      s = next;
  }
  return {s[0], s[3], s[2]};
}

TEST(RefractionRun, SeveralLayersAgreeWithRaysIntegratedApart) {
  const TestFolder folder;
  const std::vector<std::pair<double, double>> points{
      {0, 1520}, {9, 1502}, {12, 1494}, {15, 1493}, {30, 1490}};
  std::string csv = "depth_m,sound_speed_m_s\n";
  for (const auto& [z, c] : points) csv += fmt::format("{},{}\n", z, c);
  folder.write("profile.csv", csv);
  const auto speed = [&](double z) {
    for (std::size_t i = 1;; ++i)
      if (z <= points[i].first || i + 1 == points.size())
        return points[i - 1].second + (z - points[i - 1].first) * (points[i].second - points[i - 1].second) /
                                          (points[i].first - points[i - 1].first);
  };
  const Echoes echoes = echoes_in(
      folder, scene_in("profile = \"table\"\nprofile_file = \"profile.csv\"\nabsorption_db_per_km = 0"));
  // Energy between two launch angles: mu sin(arrival) over the area per steradian of the receive leg.
  const double cs = speed(10), cr = speed(20);
  std::vector<Landing> rays;
  std::vector<double> launch;
  for (double angle = 16; angle <= 76; angle += 0.5) {
    launch.push_back(angle * degree);
    rays.push_back(landing(speed, launch.back()));
  }
  std::size_t compared = 0;
  for (std::size_t k = 1; k < rays.size(); ++k) {
    const Landing &a = rays[k - 1], &b = rays[k];
    const double middle = (launch[k - 1] + launch[k]) / 2, step = launch[k] - launch[k - 1];
    const Landing m = landing(speed, middle);
    const double area =
        m.range_m * std::sin(m.arrival_rad) * (a.range_m - b.range_m) / step / std::cos(middle);
    const double energy = mu * std::sin(m.arrival_rad) / (area * cs * cs / (cr * cr)) * fan_rad *
                          (std::sin(launch[k]) - std::sin(launch[k - 1]));
    // Energy density in slant range, at the range of the middle ray.
    const double density = energy / (cs * (a.time_s - b.time_s));
    const std::size_t sample = echoes.sample_at(cs * m.time_s);
    const double width = echoes.last_m(sample) - echoes.first_m(sample);
    // It varies nearly with the fifth power of range: converts from the ray to the middle of the bin.
    const double from_middle = cs * m.time_s / (echoes.first_m(sample) + width / 2);
    const double found = echoes.at(0, 0, sample) / width / std::pow(from_middle, 5);
    EXPECT_NEAR(10 * std::log10(found / density), 0, 0.1) << launch[k] / degree;
    ++compared;
  }
  EXPECT_GT(compared, 60u);
}

TEST(RefractionRun, ShadowsAreLeftOutAndTold) {
  // Sound bends upwards from the seabed. The last ray that reaches the seabed is horizontal there.
  const double g = 10, cr = c_sonar + g * above_seabed_m;
  const Checkpoint run(replaced(scene_in(gradient(g)), "window_length_m = 32", "window_length_m = 62"));
  ASSERT_EQ(run.outcome.exit_code, 0) << run.outcome.err;
  EXPECT_THAT(run.outcome.err, HasSubstr("shadow zone"));
  const nlohmann::json& refraction = run.stats.at("refraction");
  EXPECT_GT(refraction.at("facets_in_shadow").get<int>(), 0);
  EXPECT_EQ(refraction.at("pings_with_shadows"), 1);
  const double sine = std::sqrt((cr - c_sonar) * (cr + c_sonar)) / cr;
  const double last_m = c_sonar * std::atanh(sine) / g;
  EXPECT_GE(refraction.at("first_shadow").at("range_m").get<double>(), 0.95 * last_m);
  const Echoes echoes = read_echoes(run.folder / "out/echoes.nc");
  for (std::size_t k = echoes.sample_at(last_m) + 1; k < echoes.samples; ++k)
    EXPECT_EQ(echoes.at(0, 0, k), 0);
}

TEST(RefractionRun, WithoutShadowsNothingIsWarned) {
  const Checkpoint run(scene_in(gradient(-0.3)));
  ASSERT_EQ(run.outcome.exit_code, 0) << run.outcome.err;
  EXPECT_EQ(run.outcome.err.find("apparent facets"), std::string::npos) << run.outcome.err;
  const nlohmann::json& refraction = run.stats.at("refraction");
  EXPECT_EQ(refraction.at("facets_in_shadow"), 0);
  EXPECT_EQ(refraction.at("facets_of_several_rays"), 0);
  EXPECT_EQ(refraction.at("facets_folded"), 0);
  EXPECT_GT(refraction.at("apparent_facets").get<int>(), 2);
  EXPECT_LE(refraction.at("largest_gap_m").get<double>(), 0.25 / 4);
  EXPECT_EQ(refraction.at("sound_speed_m_s").at("beam"), c_sonar);
}

constexpr std::string_view cube = R"(
[[objects]]
name = "cube"
shape = "box"
size_m = [2, 3, 4]
position_m = [12, 16, 1]
heading_deg = 20
)";

TEST(RefractionRun, AuditClosesOnEveryTube) {
  const TestFolder folder;
  const auto file = folder.write(
      "scene.toml", replaced(scene_in(gradient(-1)), "[trajectory]", std::string(cube) + "[trajectory]"));
  const Outcome outcome = run_program({"audit", file.string()});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("failures       0\n"));
}

TEST(RefractionRun, FootprintsLieOnTheTrueSeabed) {
  const TestFolder folder;
  const auto file = folder.write("scene.toml", scene_in(gradient(-1)));
  const auto output = folder / "seen.geojson";
  const Outcome outcome =
      run_program({"footprints", file.string(), "--sensor", "beam", "-o", output.string()});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const nlohmann::json seen = nlohmann::json::parse(bytes_of(output));
  double area = 0, farthest = 0;
  for (const auto& feature : seen.at("features")) {
    const auto& row = feature.at("properties");
    EXPECT_NEAR(row.at("centroid_up_m").get<double>(), 0, 1e-6);
    for (const auto& corner : feature.at("geometry").at("coordinates").at(0).at(0)) {
      EXPECT_NEAR(corner.at(2).get<double>(), 0, 1e-6);
      // Rays keep the azimuth of their beam.
      EXPECT_NEAR(std::atan2(corner.at(0).get<double>(), corner.at(1).get<double>()), 37 * degree,
                  fan_rad / 2 * 1.001);
    }
    area += row.at("area_m2").get<double>();
    farthest = std::max(farthest, std::hypot(row.at("centroid_east_m").get<double>(),
                                             row.at("centroid_north_m").get<double>()));
  }
  // A wedge of the seabed from under the steepest ray to the range limit of 40 m, or a little beyond.
  // Footprints are parts of whole facets.
  EXPECT_GT(farthest, 30);
  EXPECT_GT(area, fan_rad / 2 * 38 * 38 * 0.97);
}

TEST(RefractionRun, CheckAndPatternsKnowTheSpeedAtTheSonar) {
  const TestFolder folder;
  const auto file = folder.write("scene.toml", scene_in(gradient(-1)));
  const Outcome outcome = run_program({"check", file.string()});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("stratified: profile \"gradient\""));
  EXPECT_THAT(outcome.out, HasSubstr("sound speed 1500.00 m/s at the first position"));
}

TEST(RefractionRun, WhatCannotBeHadIsRefused) {
  const auto refused = [](const std::string& scene, const std::string& words,
                          const std::vector<std::string>& more = {}) {
    const Checkpoint run(scene, more);
    EXPECT_NE(run.outcome.exit_code, 0);
    EXPECT_THAT(run.outcome.err, HasSubstr(words));
  };
  const std::string plain = scene_in(gradient(-1));
  refused(replaced(replaced(plain, "lambert_db = -27", "lambert_db = -27\nspecular_loss_db = 6"),
                   "[trajectory]", std::string(cube) + "[trajectory]"),
          "is a mirror on facets that are not horizontal");
  refused(replaced(plain, "position_m = [0, 0, 10]", "position_m = [0, 0, 21]"), "above the sea surface");
}

}  // namespace
}  // namespace tubefoot
