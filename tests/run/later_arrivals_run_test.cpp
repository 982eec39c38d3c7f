// SPDX-License-Identifier: GPL-3.0-or-later
// Tests several eigenrays to the seabed in whole runs. A thermocline turns rays downwards to a flat seabed.
// The run receives all of them, in agreement with a fan of rays in closed form.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "fixtures/world/echoes.hpp"
#include "fixtures/world/gradient_scenes.hpp"
#include "fixtures/world/turning_water.hpp"

namespace tubefoot {
namespace {

using testing::HasSubstr;
using namespace test;

constexpr double from_m = 250, to_m = 410;

std::string late_scene(const std::string& water = {}, int samples = 80) {
  return "[water]\nsurface_height_m = 40\nprofile = \"table\"\nprofile_file = \"profile.csv\"\n"
         "absorption_db_per_km = 0\n" +
         water + lambert_material("bed", -27) + flat_terrain(1000, 1000) +
         fixed_at(0, 0, 20, "heading_deg = 37\n") +
         fmt::format(
             "[[sensors]]\nname = \"beam\"\nkind = \"didson\"\nbeams = 1\nhorizontal_deg = 1.5\n"
             "vertical_deg = 100\nfrequency_khz = {}\nsamples = {}\nwindow_start_m = {}\n"
             "window_length_m = {}\n",
             TurningWater::frequency_hz / 1000, samples, from_m, to_m - from_m);
}

struct ProfileFolder : TestFolder {
  ProfileFolder() { write("profile.csv", TurningWater::profile_csv); }
};

/// By range bin: energy of rays between two launch angles, positive downwards.
std::vector<double> fan(double low_rad, double high_rad, std::size_t samples) {
  constexpr int rays = 400'000;
  std::vector<double> energy(samples, 0.0);
  const double step = (high_rad - low_rad) / rays;
  for (int i = 0; i < rays; ++i) {
    const double launch = low_rad + (i + 0.5) * step;
    const TurningWater::Landing ray = TurningWater::landing(launch);
    const double sample = (1500 * ray.time_s - from_m) / (to_m - from_m) * double(samples);
    if (sample >= 0 && sample < double(samples))
      energy[std::size_t(sample)] +=
          mu * std::sin(ray.arrival_rad) / ray.area_back_m2 * fan_rad * std::cos(launch) * step;
  }
  return energy;
}

/// By range bin: the transmit leg is one and the receive leg another of all rays to a point, point by
/// point.
std::vector<double> crossed(std::size_t samples) {
  constexpr int places = 400'000;
  std::vector<double> energy(samples, 0.0);
  const double a = 2 * TurningWater::c / TurningWater::g, h = TurningWater::seabed_m, step = 300.0 / places;
  for (int i = 0; i < places; ++i) {
    const double x = 200 + (i + 0.5) * step, root2 = x * x - 4 * a * h;
    if (!(root2 > 0)) continue;
    std::vector<TurningWater::Landing> rays{TurningWater::landing(std::atan(h / x))};
    for (const double sign : {-1.0, 1.0}) {
      const double up = std::atan((x + sign * std::sqrt(root2)) / (2 * a));
      if (up < TurningWater::steepest_rad) rays.push_back(TurningWater::landing(-up));
    }
    for (std::size_t tx = 0; tx < rays.size(); ++tx)
      for (std::size_t rx = 0; rx < rays.size(); ++rx) {
        const double sample =
            (750 * (rays[tx].time_s + rays[rx].time_s) - from_m) / (to_m - from_m) * double(samples);
        if (tx != rx && sample >= 0 && sample < double(samples))
          energy[std::size_t(sample)] += mu * std::sin(rays[tx].arrival_rad) *
                                         std::sin(rays[rx].arrival_rad) * x * fan_rad * step /
                                         (rays[tx].area_back_m2 * rays[rx].area_back_m2);
      }
  }
  return energy;
}

double sum_of(const std::vector<double>& energy) { return std::reduce(energy.begin(), energy.end()); }

TEST(LaterArrivalsRun, AreAllReceived) {
  const ProfileFolder folder;
  const Echoes echoes = echoes_in(folder, late_scene());
  const std::vector<double> straight = fan(1e-4, 0.8, echoes.samples),
                            turned = fan(-TurningWater::steepest_rad, -1e-4, echoes.samples),
                            between = crossed(echoes.samples);
  double worst = 0, most = 0;
  for (std::size_t k = 0; k < echoes.samples; ++k) {
    const double wanted = straight[k] + turned[k] + between[k];
    worst = std::max(worst, std::abs(echoes.at(0, 0, k) - wanted));
    most = std::max(most, wanted);
  }
  EXPECT_NEAR((echoes.total() - sum_of(straight)) / (sum_of(turned) + sum_of(between)), 1, 0.02);
  EXPECT_LT(worst, 0.1 * most);
  EXPECT_GT(sum_of(turned), 0.2 * sum_of(straight));
  EXPECT_GT(sum_of(between), 0.2 * sum_of(turned));
}

TEST(LaterArrivalsRun, AreCounted) {
  const ProfileFolder folder;
  const auto file = folder.write("scene.toml", late_scene());
  const Outcome outcome = run_program({"run", file.string(), "-o", (folder / "out").string()});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(outcome.err.find("several rays"), std::string::npos) << outcome.err;
  const nlohmann::json stats = nlohmann::json::parse(bytes_of(folder / "out/stats.json")).at("refraction");
  EXPECT_GT(stats.at("facets_of_several_rays").get<int>(), 0);
  EXPECT_GT(stats.at("facets_folded").get<int>(), 0);
  EXPECT_EQ(stats.at("branches"),
            "every ray, in any combination of transmit leg and receive leg, with at most 1 turning point");
  const Outcome audit = run_program({"audit", file.string()});
  EXPECT_EQ(audit.exit_code, 0) << audit.err;
  EXPECT_THAT(audit.out, HasSubstr("failures       0\n"));
}

// A surface that is not a mirror excludes no arrival. The file states that footprints are those of first
// eigenrays.
TEST(LaterArrivalsRun, AreNotMissedWhereNoPathGoesOverTheSurface) {
  const ProfileFolder folder;
  const auto file = folder.write("scene.toml", late_scene() + "[sea_surface]\nheight_m = 40\n");
  const Outcome outcome = run_program({"run", file.string(), "-o", (folder / "out").string()});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(outcome.err.find("several rays"), std::string::npos) << outcome.err;
  EXPECT_EQ(outcome.err.find("inverted"), std::string::npos) << outcome.err;
  EXPECT_EQ(nlohmann::json::parse(bytes_of(folder / "out/stats.json")).at("refraction").at("branches"),
            "every ray, in any combination of transmit leg and receive leg, with at most 1 turning point");
  const Outcome footprints =
      run_program({"footprints", file.string(), "--sensor", "beam", "-o", (folder / "f.csv").string()});
  ASSERT_EQ(footprints.exit_code, 0) << footprints.err;
  EXPECT_THAT(footprints.err, HasSubstr("facets contain only the first arrival"));
}

// A separate receiver uses only the first eigenray, and the run reports this.
TEST(LaterArrivalsRun, SeparateReceiversSayWhatTheyLack) {
  const ProfileFolder folder;
  const auto file = folder.write("scene.toml", late_scene() + "receiver_arm_m = [0, 1, 0]\n");
  const Outcome outcome = run_program({"run", file.string(), "-o", (folder / "out").string()});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("several rays, with at most 1 turning point"));
  EXPECT_THAT(outcome.err, HasSubstr("computes only the first arrival"));
}

// Random rays meet the same eigenray branches.
TEST(LaterArrivalsRun, RaysHearWhatTubesHear) {
  const ProfileFolder folder;
  const double tubes = echoes_in(folder, late_scene()).total(),
               rays =
                   echoes_in(folder, late_scene(), {"--engine", "ray", "--rays-per-beam", "200000"}).total();
  EXPECT_NEAR(rays / tubes, 1, 0.02);
}

TEST(LaterArrivalsRun, WithoutTurnsOnlyTheFallingRayIsFollowed) {
  const ProfileFolder folder;
  const Echoes echoes = echoes_in(folder, late_scene("refraction_turns = 0\n"));
  const std::vector<double> straight = fan(1e-4, 0.8, echoes.samples);
  EXPECT_NEAR(echoes.total() / std::reduce(straight.begin(), straight.end()), 1, 0.01);
}

// No reference encloses the arrivals over several eigenrays: their bins have no bound.
TEST(LaterArrivalsRun, ReferencesSayWhereTheyHaveNoBound) {
  const ProfileFolder folder;
  const Echoes echoes = echoes_in(folder, late_scene({}, 16), {"--reference", "--tolerance", "0.1"});
  const std::vector<double> turned = fan(-TurningWater::steepest_rad, -1e-4, echoes.samples);
  for (std::size_t k = 0; k < echoes.samples; ++k)
    if (turned[k] > 0) {
      EXPECT_TRUE(std::isinf(echoes.energy_bound[k])) << k;
    }
}

}  // namespace
}  // namespace tubefoot
