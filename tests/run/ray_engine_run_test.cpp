// SPDX-License-Identifier: GPL-3.0-or-later
// Compares whole runs of the ray engine with the exact engine. The energies converge as the number of rays
// grows.
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "fixtures/scene_texts.hpp"
#include "fixtures/world/echoes.hpp"

namespace tubefoot {
namespace {

const std::string ray_scene = lambert_material("sand", -27) + lambert_material("steel", -10) +
                              flat_terrain(30, 30, "material = \"sand\"\n") +
                              ball_and_box("material = \"steel\"\n") + fixed_at(0, 0, 2) + R"([[sensors]]
name = "camera"
kind = "didson"
tilt_deg = 25
horizontal_deg = 5
vertical_deg = 20
beams = 10
samples = 64
window_start_m = 2
window_length_m = 8
)";

std::vector<std::string> rays(int count, int seed) {
  return {"--engine", "ray", "--rays", std::to_string(count), "--seed", std::to_string(seed)};
}

/// Mean and standard deviation of the total energy over five seeds.
std::pair<double, double> spread(int count) {
  std::vector<double> totals;
  for (int seed = 1; seed <= 5; ++seed) totals.push_back(echoes_of(ray_scene, rays(count, seed)).total());
  double mean = 0, square = 0;
  for (const double total : totals) mean += total / 5;
  for (const double total : totals) square += (total - mean) * (total - mean) / 4;
  return {mean, std::sqrt(square)};
}

TEST(RayRun, TotalEnergyConvergesToTheTubeEngines) {
  const double exact = echoes_of(ray_scene).total();
  const auto [few_mean, few_deviation] = spread(2000);
  const auto [many_mean, many_deviation] = spread(200000);
  // The mean of five lies within six of its own standard errors. The errors of Embree's floats are far
  // smaller.
  EXPECT_NEAR(few_mean, exact, 6 * few_deviation / std::sqrt(5));
  EXPECT_NEAR(many_mean, exact, 6 * many_deviation / std::sqrt(5) + 1e-6 * exact);
  EXPECT_LT(many_deviation,
            few_deviation / 5);  // 100 times the rays: at least the 10 of plain sampling, with margin
  EXPECT_LT(many_deviation, 1e-3 * exact);
}

TEST(RayRun, EverySampleComesClose) {
  const Echoes exact = echoes_of(ray_scene), sampled = echoes_of(ray_scene, rays(1000000, 3));
  double difference = 0;
  for (std::size_t k = 0; k < exact.energy.size(); ++k)
    difference += std::abs(exact.energy[k] - sampled.energy[k]);
  EXPECT_LT(difference, 0.02 * exact.total());
  for (std::size_t k = 0; k < exact.energy.size(); ++k)
    if (exact.energy[k] == 0) {
      EXPECT_LT(sampled.energy[k], 1e-6 * exact.total()) << "sample " << k;
    }
}

TEST(RayRun, SameSeedSameFile) {
  const TestFolder folder;
  const auto bytes = [&](const std::vector<std::string>& arguments) {
    echoes_in(folder, ray_scene, arguments);
    return bytes_of(folder / "results" / "echoes.nc");
  };
  const std::string once = bytes(rays(3000, 7));
  EXPECT_EQ(once, bytes(rays(3000, 7)));
  auto threads = rays(3000, 7);
  threads.insert(threads.end(), {"--threads", "1"});
  EXPECT_EQ(once, bytes(threads));
  EXPECT_NE(once, bytes(rays(3000, 8)));
}

TEST(RayRun, StatisticsAndResultsNameEngineRaysAndSeed) {
  const TestFolder folder;
  echoes_in(folder, ray_scene, rays(4321, 9));
  const auto stats = nlohmann::json::parse(bytes_of(folder / "results" / "stats.json"));
  EXPECT_EQ(stats["engine"], "ray");
  EXPECT_EQ(stats["rays_per_ping"], 4321);
  EXPECT_EQ(stats["seed"], 9);
  EXPECT_GT(stats["ray_hits"], 4321 / 2);
  EXPECT_LE(stats["ray_hits"], 4321 + 100);
  EXPECT_EQ(stats["footprints"], 0);
  EXPECT_EQ(read_echo_file(folder / "results" / "echoes.nc").provenance.engine, "ray");
  EXPECT_EQ(read_echo_file(folder / "results" / "echoes.nc").provenance.arithmetic, "float");
}

TEST(RayRun, CommandLineGoesBeforeTheSceneFile) {
  const TestFolder folder;
  echoes_in(folder, ray_scene + "[run]\nengine = \"ray\"\nrays_per_ping = 1000\nseed = 4\n",
            {"--rays", "2000"});
  auto stats = nlohmann::json::parse(bytes_of(folder / "results" / "stats.json"));
  EXPECT_EQ(stats["engine"], "ray");
  EXPECT_EQ(stats["rays_per_ping"], 2000);
  EXPECT_EQ(stats["seed"], 4);
  echoes_in(folder, ray_scene + "[run]\nengine = \"ray\"\n",
            {"--engine", "tube", "--arithmetic", "filtered"});
  stats = nlohmann::json::parse(bytes_of(folder / "results" / "stats.json"));
  EXPECT_EQ(stats["engine"], "tube");
  EXPECT_EQ(stats["arithmetic"], "filtered");
}

TEST(RayRun, EverySamplingTakesEveryCountPerBeam) {
  // Numbers of rays per beam of existing simulators, from one to seventeen thousand.
  const TestFolder folder;
  const double exact = echoes_of(ray_scene).total();
  for (const std::string sampling : {"stratified", "sobol", "adaptive", "regular", "random", "column"})
    for (const int count : {1, 11, 23, 114, 1500, 17000}) {
      SCOPED_TRACE(sampling + ", " + std::to_string(count) + " rays per beam");
      const std::string run = sampling == "column" ? "[run]\nrays_per_beam = 3\n" : "";
      const double total =
          echoes_in(folder, ray_scene + run,
                    {"--engine", "ray", "--sampling", sampling, "--rays-per-beam", std::to_string(count)})
              .total();
      const auto stats = nlohmann::json::parse(bytes_of(folder / "results" / "stats.json"));
      EXPECT_EQ(stats["sampling"], sampling);
      EXPECT_EQ(stats["rays_per_beam"], count);
      EXPECT_FALSE(stats.contains("rays_per_ping"));
      EXPECT_LE(stats["ray_hits"], 10 * count);
      EXPECT_GE(stats["ray_hits"], 10 * count / 2);
      if (count >= 114) {
        EXPECT_NEAR(total, exact, (sampling == "column" ? 0.15 : count < 1500 ? 0.1 : 0.02) * exact);
      }
    }
}

TEST(RayRun, CountsByPingAndByBeamExcludeEachOther) {
  const TestFolder folder;
  const std::string file = folder.write("scene.toml", ray_scene).string();
  const auto refused = [&](std::vector<std::string> options, const char* says) {
    std::vector<std::string> arguments{"run", file, "-o", (folder / "results").string()};
    arguments.insert(arguments.end(), options.begin(), options.end());
    const Outcome outcome = run_program(arguments);
    EXPECT_EQ(outcome.exit_code, 2);
    EXPECT_NE(outcome.err.find(says), std::string::npos) << outcome.err;
    EXPECT_EQ(names_below(folder.path()), std::set<std::string>{"scene.toml"});
  };
  refused({"--rays", "5", "--rays-per-beam", "5"}, "excludes");
  refused({"--rays-per-beam", "0"}, "--rays-per-beam");
  refused({"--rays-per-beam", "2.5"}, "--rays-per-beam");
  refused({"--sampling", "halton"}, "halton");
  // The count of the command line replaces that of the scene, in either notation of the scene.
  echoes_in(folder, ray_scene + "[run]\nengine = \"ray\"\nrays_per_beam = 7\n", {"--rays", "2000"});
  auto stats = nlohmann::json::parse(bytes_of(folder / "results" / "stats.json"));
  EXPECT_EQ(stats["rays_per_ping"], 2000);
  echoes_in(folder, ray_scene + "[run]\nengine = \"ray\"\nrays_per_beam = 7\nsampling = \"regular\"\n");
  stats = nlohmann::json::parse(bytes_of(folder / "results" / "stats.json"));
  EXPECT_EQ(stats["rays_per_beam"], 7);
  EXPECT_EQ(stats["sampling"], "regular");
}

}  // namespace
}  // namespace tubefoot
