// SPDX-License-Identifier: GPL-3.0-or-later
// Tests the received data of each sensor kind in whole runs: the variables `received` and `received_lower`
// of echoes.nc.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "fixtures/netcdf_reader.hpp"
#include "fixtures/program.hpp"
#include "fixtures/scene_texts.hpp"

namespace tubefoot {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::Not;

const char* receiver =
    "speckle = \"rayleigh\"\nsource_level_db = 200\nnoise_level_db = 100\n";  // 1e-10 J/m2 of noise

std::string receiving_scene(const std::string& kind, const std::string& keys) {
  std::string scene(small_scene);
  scene.resize(scene.find("[[sensors]]"));
  return scene + fmt::format("[[sensors]]\nname = \"sonar\"\nkind = \"{}\"\nsamples = 80\n{}", kind, keys);
}

struct ReceivedRun : testing::Test {
  TestFolder folder;
  ReceivedRun() { folder.write("thing.obj", tetrahedron); }
  Outcome run(const std::string& scene, const std::vector<std::string>& more = {}) const {
    std::vector<std::string> words{"run",     folder.write("scene.toml", scene).string(),
                                   "-o",      (folder / "out").string(),
                                   "--quiet", "--pictures",
                                   "none"};
    words.insert(words.end(), more.begin(), more.end());
    return run_program(words);
  }
};

TEST_F(ReceivedRun, EveryKindOfEnergiesHasReceivedData) {
  const std::string fan = "range_min_m = 1\nrange_max_m = 8\n";
  const std::pair<const char*, std::string> kinds[] = {
      {"didson", "beams = 4\nhorizontal_deg = 4\ntilt_deg = 30\n"},
      {"imaging", "beams = 8\nhorizontal_deg = 20\ntilt_deg = 30\n" + fan},
      {"scanning", "scan_deg = 20\nstep_deg = 2\ntilt_deg = 30\n" + fan},
      {"multibeam", "beams = 8\n" + fan},
      {"echosounder", fan},
      {"sidescan", fan},
      {"interferometric", fan}};
  for (const auto& [kind, keys] : kinds) {
    SCOPED_TRACE(kind);
    const Outcome ideal = run(receiving_scene(kind, keys));
    ASSERT_EQ(ideal.exit_code, 0) << ideal.err;
    const std::vector<double> energies = NetcdfReader(folder / "out/echoes.nc").values("/", "energy");
    EXPECT_THAT(NetcdfReader(folder / "out/echoes.nc").variables("/"), Not(Contains("received")));
    const Outcome outcome = run(receiving_scene(kind, keys + receiver));
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    const NetcdfReader file(folder / "out/echoes.nc");
    EXPECT_EQ(file.values("/", "energy"), energies);
    const std::vector<double> received = file.values("/", "received");
    ASSERT_EQ(received.size(), energies.size());
    for (const double energy : received) ASSERT_GT(energy, 0);
    const bool pair = std::string(kind) == "interferometric";
    EXPECT_EQ(std::ranges::count(file.variables("/"), std::string("received_lower")), pair ? 1 : 0);
    // Relative to the mean, the values are exponential with the mean 1.
    double sum = 0;
    for (std::size_t k = 0; k < received.size(); ++k) sum += received[k] / (energies[k] + 1e-10);
    const auto n = static_cast<double>(received.size());
    EXPECT_NEAR(sum / n, 1, 5 / std::sqrt(n));
  }
}

TEST_F(ReceivedRun, AnArrayHasNoReceiverButSignals) {
  const std::string keys =
      "quantisation_bits = 8\nquantisation_bottom_db = 40\nquantisation_top_db = 100\npulse_length_us = "
      "100\n";
  const Outcome outcome = run(replaced(receiving_scene("array", keys), "samples = 80\n", ""));
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.err, HasSubstr("an array records signals"));
}

TEST_F(ReceivedRun, LevelsOfCodesAreChecked) {
  const std::string fan = "range_min_m = 1\nrange_max_m = 8\n";
  EXPECT_THAT(run(receiving_scene("sidescan", fan + "quantisation_bits = 8\n")).err,
              HasSubstr("'quantisation_bottom_db' (0) must be less than 'quantisation_top_db' (0)"));
  EXPECT_THAT(run(receiving_scene("sidescan", fan + "quantisation_top_db = 8\n")).err,
              HasSubstr("'quantisation_top_db' needs 'quantisation_bits'"));
}

}  // namespace
}  // namespace tubefoot
