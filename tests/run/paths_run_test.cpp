// SPDX-License-Identifier: GPL-3.0-or-later
// Tests whole runs with paths over mirrors and with second scattering (docs/environment.md), in isovelocity
// and in stratified water.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numbers>
#include <numeric>

#include "fixtures/netcdf_reader.hpp"
#include "fixtures/scene_texts.hpp"
#include "fixtures/world/echoes.hpp"

namespace tubefoot {
namespace {

using testing::HasSubstr;

/// The sonar looks straight up from 5 m below the surface, with the seabed 20 m below. The sector is wider
/// than the rings of the range gate.
std::string scene(const std::string& paths) {
  return still_water() + paths + lambert_material("bed", -10) +
         flat_terrain(100, 100, "centre_m = [0, 0, -20]\n") + fixed_at(0, 0, -5) + R"([[sensors]]
name = "up"
kind = "didson"
beams = 3
horizontal_deg = 100
vertical_deg = 100
tilt_deg = -90
samples = 20
window_start_m = 24.5
window_length_m = 5
)";
}

const std::string surface = "[sea_surface]\nloss_db = 1\n";

TEST(PathsRun, AnUpwardLookSeesTheSeabedInTheSurface) {
  // Straight up there is no facet. With both legs over the surface (order 3) the seabed is 25 m away.
  EXPECT_EQ(echoes_of(scene(surface)).total(), 0);
  EXPECT_EQ(echoes_of(scene(surface + "[paths]\norder = 2\n")).total(), 0);
  const Echoes echoes = echoes_of(scene(surface + "[paths]\norder = 3\n"));
  const double mu = 0.1, loss = std::pow(10, -0.2);
  for (std::size_t k = 0; k < echoes.samples; ++k) {
    const double from = std::max(echoes.first_m(k), 25.0), to = echoes.last_m(k);
    double sum = 0;
    for (std::size_t beam = 0; beam < echoes.beams; ++beam) sum += echoes.at(0, beam, k);
    const double expected =
        to <= 25 ? 0 : loss * mu * std::numbers::pi / 2 * 625 * (std::pow(from, -4) - std::pow(to, -4));
    EXPECT_NEAR(sum, expected, 1e-6 * expected) << k;
  }
}

TEST(PathsRun, TheCheaperSettingsHearTheSame) {
  const std::string text = scene(surface + "[paths]\norder = 3\n");
  const Echoes exact = echoes_of(text), rays = echoes_of(text, {"--engine", "ray", "--rays", "400000"}),
               doubles = echoes_of(text, {"--arithmetic", "double"});
  double by_rays = 0;
  for (std::size_t bin = 0; bin < exact.energy.size(); ++bin) {
    by_rays += std::abs(rays.energy[bin] - exact.energy[bin]);
    EXPECT_NEAR(doubles.energy[bin], exact.energy[bin], 1e-11 * exact.total()) << bin;
  }
  EXPECT_GT(by_rays, 0);
  EXPECT_LT(by_rays, 0.02 * exact.total());
  // This run does not receive order 1, so that the effect of fast binning is that of the paths.
  EXPECT_NE(echoes_of(text, {"--binning", "centroid"}).energy, exact.energy);
}

TEST(PathsRun, OneOrderAloneAndAllOrdersAddUp) {
  const std::string both = surface + "[paths]\norder = 3\n";
  const auto with = [](std::string t, const std::string& from, const std::string& to) {
    return t.replace(t.find(from), from.size(), to);
  };
  // The sonar looks sideways, up and down.
  const std::string text = with(
      with(with(scene(both), "tilt_deg = -90", "tilt_deg = 0"), "vertical_deg = 100", "vertical_deg = 150"),
      "window_length_m = 5", "window_length_m = 20");
  const Echoes all = echoes_of(text);
  std::vector<double> sum(all.energy.size());
  for (int order = 1; order <= 3; ++order) {
    const Echoes one = echoes_of(with(text, "order = 3", fmt::format("order = 3\nonly_order = {}", order)));
    EXPECT_GT(one.total(), 0) << order;
    for (std::size_t k = 0; k < sum.size(); ++k) sum[k] += one.energy[k];
  }
  for (std::size_t k = 0; k < sum.size(); ++k) EXPECT_NEAR(all.energy[k], sum[k], 1e-12 * sum[k]) << k;
  // Order 1 equals the run without mirrors. The grid of the scene is coarser, because it must contain the
  // images.
  const Echoes first = echoes_of(with(text, "order = 3", "order = 3\nonly_order = 1"));
  const Echoes plain = echoes_of(with(text, both, ""));
  for (std::size_t k = 0; k < sum.size(); ++k)
    EXPECT_NEAR(first.energy[k], plain.energy[k], 1e-6 * plain.energy[k] + 1e-16) << k;
}

// The part of a quay above the water neither hides the mirror image of the quay nor returns sound above the
// surface.
TEST(PathsRun, WhatIsAboveTheSurfaceIsNotReceived) {
  const auto echoes = [](double top_m, double bottom_m) {
    std::string text = scene(surface + "[paths]\norder = 3\n");
    for (const auto& [from, to] : {std::pair("tilt_deg = -90", "tilt_deg = 0"),
                                   std::pair("window_start_m = 24.5", "window_start_m = 5"),
                                   std::pair("window_length_m = 5", "window_length_m = 20")})
      text.replace(text.find(from), std::string(from).size(), to);
    const std::string quay = fmt::format(
        "[[objects]]\nname = \"quay\"\nshape = \"box\"\nmaterial = \"bed\"\nsize_m = [30, 4, {}]\n"
        "position_m = [0, 10, {}]\n",
        top_m - bottom_m, (top_m + bottom_m) / 2);
    return echoes_of(text.insert(text.find("[trajectory]"), quay));
  };
  const Echoes level = echoes(0, -21), high = echoes(25, -21);
  EXPECT_GT(level.total(), 0);
  // The surface cuts the higher quay, and rounds its corners there to the grid (1e-6 m). This allows 1e-6
  // of a bin. For a bin with a facet sliver as narrow as the rounding it allows 1e-9 of the total.
  for (std::size_t k = 0; k < level.energy.size(); ++k)
    EXPECT_NEAR(high.energy[k], level.energy[k], 1e-6 * level.energy[k] + 1e-9 * level.total()) << k;
  // A bridge, seen from straight below.
  std::string text = scene(surface + "[paths]\norder = 3\n");
  const Echoes none = echoes_of(text);
  const Echoes gone =
      echoes_of(text.insert(text.find("[trajectory]"),
                            "[[objects]]\nname = \"bridge\"\nshape = \"box\"\nmaterial = \"bed\"\n"
                            "size_m = [30, 30, 2]\nposition_m = [0, 0, 8]\n"));
  EXPECT_GT(none.total(), 0);
  for (std::size_t k = 0; k < none.energy.size(); ++k)
    EXPECT_NEAR(gone.energy[k], none.energy[k], 1e-6 * none.energy[k]) << k;
}

/// A hollow of two seabeds that insonify each other, each with its own scattering model.
std::string hollow(int scatterings, int patch_m) {
  std::string text =
      scene(fmt::format("[paths]\norder = {0}\nscatterings = {0}\npatch_m = {1}\nonly_order = {0}\n"
                        "[[objects]]\nname = \"wall\"\nshape = \"box\"\nmaterial = \"bed\"\n"
                        "size_m = [30, 1, 6]\nposition_m = [0, 12, -17]\n",
                        scatterings, patch_m));
  for (const auto& [from, to] :
       {std::pair("tilt_deg = -90", "tilt_deg = 45"),
        std::pair("window_start_m = 24.5", "window_start_m = 10"),
        std::pair("window_length_m = 5", "window_length_m = 40"),
        std::pair("lambert_db = -10", "law = \"sediment\"\nsediment = \"rough rock\"\nsediment_khz = 300")})
    text.replace(text.find(from), std::string(from).size(), to);
  return text;
}

TEST(PathsRun, ScatteringsToAnyDepthByAnyLaw) {
  const double two = echoes_of(hollow(2, 4)).total(), three = echoes_of(hollow(3, 4)).total();
  EXPECT_GT(three, 0);
  EXPECT_LT(three, 0.9 * two);  // no albedo is above 0.9
}

const std::string finely = "refraction_gap_m = 0.0005\nrefraction_tolerance_db = 0.01\n";

/// Puts the scene in water whose sound speed changes with depth, with 1500 m/s at the sonar (5 m deep).
std::string refracted(std::string text, double g, const std::string& how = finely) {
  return text.replace(text.find(still_water()), still_water().size(),
                      fmt::format("[water]\nabsorption_db_per_km = 0\nprofile = \"gradient\"\n"
                                  "sound_speed_m_s = {}\ngradient_per_s = {}\nprofile_bottom_m = 40\n{}",
                                  1500 - 5 * g, g, how));
}

// Patches are cut differently than in isovelocity water, so that results differ by the error of the patch
// size.
TEST(PathsRun, ScatteringsInRefractingWater) {
  const double even = echoes_of(hollow(2, 8)).total(),
               almost = echoes_of(refracted(hollow(2, 8), 1e-6, "")).total(),
               strongly = echoes_of(refracted(hollow(2, 8), -2, "")).total();
  EXPECT_NEAR(almost, even, 5e-3 * even);
  EXPECT_GT(std::abs(strongly / almost - 1), 3e-3);
  EXPECT_NEAR(strongly, even, 0.2 * even);
}

// Tests energies and coherence of two receivers for second scatterings of the hollow.
TEST(PathsRun, ScatteringsInRefractingWaterToTwoReceivers) {
  const TestFolder folder;
  std::string text = hollow(2, 8);
  text.replace(text.find("[[sensors]]"), std::string::npos, R"(heading_deg = 90
[[sensors]]
name = "swath"
kind = "interferometric"
along_track_deg = 60
depression_min_deg = 5
frequency_khz = 100
baseline_m = 0.05
range_min_m = 10
range_max_m = 30
samples = 10
)");
  struct Reception {
    std::vector<double> upper, lower, real, imaginary;
    nlohmann::json refraction;
  };
  const auto received = [&](const std::string& scene, const std::string& name) {
    const auto out = folder / name;
    const Outcome outcome =
        run_program({"run", folder.write(name + ".toml", scene).string(), "-o", out.string(), "--quiet"});
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    const NetcdfReader file(out / "echoes.nc");
    const nlohmann::json stats = nlohmann::json::parse(std::ifstream(out / "stats.json"));
    return Reception{file.values("/", "energy"), file.values("/", "energy_lower"),
                     file.values("/", "cross_real"), file.values("/", "cross_imag"),
                     stats.value("refraction", nlohmann::json())};
  };
  const Reception even = received(text, "even"), almost = received(refracted(text, 1e-6, ""), "almost"),
                  strongly = received(refracted(text, -2, ""), "strongly");
  EXPECT_GT(almost.refraction.at("apparent_facets").get<int>(), 100);  // of patches, too
  const double total = std::reduce(even.upper.begin(), even.upper.end());
  EXPECT_GT(total, 0);
  double turned = 0, moved = 0;
  for (std::size_t k = 0; k < even.upper.size(); ++k) {
    EXPECT_NEAR(almost.upper[k], even.upper[k], 5e-3 * total) << k;
    EXPECT_NEAR(almost.lower[k], even.lower[k], 5e-3 * total) << k;
    EXPECT_NEAR(almost.real[k], even.real[k], 5e-3 * total) << k;
    EXPECT_NEAR(almost.imaginary[k], even.imaginary[k], 5e-3 * total) << k;
    EXPECT_LE(std::hypot(strongly.real[k], strongly.imaginary[k]),
              std::sqrt(strongly.upper[k] * strongly.lower[k]) * (1 + 1e-6));
    turned = std::max(turned, std::abs(even.imaginary[k]));
    moved = std::max(moved,
                     std::hypot(strongly.real[k] - even.real[k], strongly.imaginary[k] - even.imaginary[k]));
  }
  EXPECT_GT(turned, 0.02 * total);
  EXPECT_GT(moved, 0.01 * total);
}

// Straight up, with both legs over the surface: rings of the seabed by rays that are arcs of circles
// (physics sheet, 2.1).
TEST(PathsRun, AnUpwardLookThroughRefractingWater) {
  for (const double g : {-2.0, 1.5}) {
    const Echoes echoes = echoes_of(refracted(scene(surface + "[paths]\norder = 3\n"), g));
    const double at_surface = 1500 - 5 * g, at_sonar = 1500, at_seabed = at_surface + 20 * g;
    const auto sine = [&](double launch, double speed) {
      return std::sqrt(1 - std::pow(std::cos(launch) * speed / at_sonar, 2));
    };
    const auto time = [&](double launch) {
      const auto of = [&](double speed) { return std::atanh(sine(launch, speed)) / g; };
      return std::abs(of(at_sonar) - of(at_surface)) + std::abs(of(at_surface) - of(at_seabed));
    };
    const auto range = [&](double launch) {
      const auto of = [&](double speed) { return sine(launch, speed) * at_sonar / (std::cos(launch) * g); };
      return std::abs(of(at_sonar) - of(at_surface)) + std::abs(of(at_surface) - of(at_seabed));
    };
    const auto energy = [&](double launch) {  // per radian of launch angle
      const double d = 1e-4, slope = (range(launch - d) - range(launch + d)) / (2 * d);
      const double area = range(launch) * sine(launch, at_seabed) * slope / std::cos(launch);
      return 2 * std::numbers::pi * std::cos(launch) * 0.1 * sine(launch, at_seabed) *
             std::pow(at_seabed / at_sonar, 2) / area;
    };
    const auto launch_at = [&](double half_path_m) {
      double lo = 0.5, hi = std::numbers::pi / 2 - 1e-6;
      for (int k = 0; k < 60; ++k) (time((lo + hi) / 2) * 1500 > half_path_m ? lo : hi) = (lo + hi) / 2;
      return (lo + hi) / 2;
    };
    for (std::size_t k = 4; k < echoes.samples; k += 3) {
      double sum = 0, expected = 0;
      for (std::size_t beam = 0; beam < echoes.beams; ++beam) sum += echoes.at(0, beam, k);
      const double steep = launch_at(echoes.first_m(k)), flat = launch_at(echoes.last_m(k));
      constexpr int steps = 64;
      for (int n = 0; n < steps; ++n)
        expected += energy(flat + (steep - flat) * (n + 0.5) / steps) * (steep - flat) / steps;
      expected *= std::pow(10, -0.2);
      EXPECT_NEAR(sum, expected, 2e-3 * expected) << g << ' ' << k;
    }
  }
}

// Combines a scattering model, a texture, a separate receiver, a rough surface and a level plate, to order
// 4. Water that hardly refracts gives the result of isovelocity water.
TEST(PathsRun, EverythingAtOnceInAlmostIsovelocityWater) {
  const TestFolder folder;
  folder.write("plate.obj", "v -4 2 -17\nv 4 2 -17\nv 4 9 -17\nv -4 9 -17\nf 1 2 3\nf 1 3 4\n");
  const std::string text =
      still_water() +
      "[sea_surface]\nloss_db = 1\nrms_roughness_m = 0.0005\n[paths]\norder = 4\ndirect = true\n" +
      R"([[materials]]
name = "bed"
law = "gsab"
specular_db = -5
specular_width_deg = 8
oblique_db = -20
oblique_exponent = 1.5
[[materials.reflectivity]]
kind = "perlin"
wavelength_m = 6
octaves = 1
depth = 0.5
seed = 1
[[materials]]
name = "mirror"
lambert_db = -20
specular_loss_db = 3
[[terrain]]
kind = "flat"
width_m = 80
length_m = 80
centre_m = [0, 0, -20]
material = "bed"
[[objects]]
name = "plate"
shape = "mesh"
file = "plate.obj"
material = "mirror"
)" + fixed_at(0, 0, -9) +
      R"([[sensors]]
name = "sonar"
kind = "imaging"
beams = 2
horizontal_deg = 40
vertical_deg = 160
tilt_deg = 10
range_min_m = 1
range_max_m = 50
samples = 49
receiver_arm_m = [0, 1, 0]
)";
  const auto received = [&](const std::string& scene, const std::string& name) {
    const auto out = folder / name;
    const Outcome outcome =
        run_program({"run", folder.write(name + ".toml", scene).string(), "-o", out.string(), "--quiet"});
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    return std::pair(
        read_echoes(out / "echoes.nc"),
        nlohmann::json::parse(std::ifstream(out / "stats.json")).at("paths").at("energy_of_order"));
  };
  const auto [even, orders] = received(text, "even");
  const auto [almost, its_orders] = received(refracted(text, 1e-6), "almost");
  for (const char* order : {"2", "3", "4"}) {
    EXPECT_GT(orders.at(order).get<double>(), 0) << order;
    EXPECT_NEAR(its_orders.at(order).get<double>() / orders.at(order).get<double>(), 1, 1e-6) << order;
  }
  // A scattering model with corners is integrated to 1e-6 of the contribution of a facet.
  const double peak = *std::max_element(even.energy.begin(), even.energy.end());
  for (std::size_t k = 0; k < even.energy.size(); ++k)
    EXPECT_NEAR(almost.energy[k], even.energy[k], 1e-5 * even.energy[k] + 1e-9 * peak) << k;
}

TEST(PathsRun, RefractedPathsAreCounted) {
  const TestFolder folder;
  const auto file = folder.write("scene.toml", refracted(scene(surface + "[paths]\norder = 3\n"), -1));
  const Outcome outcome = run_program({"run", file.string(), "-o", (folder / "out").string()});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const nlohmann::json stats = nlohmann::json::parse(std::ifstream(folder / "out/stats.json"));
  EXPECT_GT(stats.at("refraction").at("apparent_facets").get<int>(), 2);
  EXPECT_EQ(stats.at("refraction").at("facets_folded"), 0);
  EXPECT_GT(stats.at("paths").at("images").get<int>(), 0);
}

TEST(PathsRun, SaysWhatItCannotDo) {
  const auto error_of = [](const std::string& text) {
    const TestFolder folder;
    const auto file = folder.write("scene.toml", text);
    const Outcome outcome = run_program({"run", file.string(), "-o", (folder / "out").string()});
    EXPECT_EQ(outcome.exit_code, 2);
    EXPECT_EQ(names_below(folder.path()), (std::set<std::string>{"scene.toml"}));
    return outcome.err;
  };
  EXPECT_THAT(error_of(scene("[paths]\norder = 2\n")), HasSubstr("add [sea_surface]"));
  std::string two_mirrors = scene(surface + "[paths]\norder = 3\nmost_images = 1\n");
  two_mirrors.insert(two_mirrors.find("[[terrain]]"), "specular_loss_db = 6\n");
  EXPECT_THAT(error_of(two_mirrors), HasSubstr("more than 1 images"));
  EXPECT_THAT(error_of(scene("[sea_surface]\nheight_m = -6\n")), HasSubstr("1 m above the sea surface"));
  EXPECT_THAT(error_of(scene("[paths]\norder = 9\nscatterings = 9\n")), HasSubstr("1 to 8"));
  const std::string box =
      "specular_loss_db = 6\n[[objects]]\nname = \"box\"\nshape = \"box\"\nmaterial = \"bed\"\n"
      "size_m = [3, 1, 6]\nposition_m = [0, 12, -17]\n";
  std::string inclined = refracted(scene(surface), 0.5);
  EXPECT_THAT(
      error_of(inclined.insert(inclined.find("[[terrain]]"), box)),
      HasSubstr(
          "'bed' is a mirror on facets that are not horizontal, and refracted rays via an inclined mirror"));
}

}  // namespace
}  // namespace tubefoot
