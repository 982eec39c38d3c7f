// SPDX-License-Identifier: GPL-3.0-or-later
// Tests the well head of scenes/wellhead/wellhead.obj: the output of its script, and the effect of
// cross-talk.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "fixtures/program.hpp"
#include "fixtures/world/echoes.hpp"

namespace tubefoot {
namespace {

namespace fs = std::filesystem;
const fs::path wellhead_scenes = fs::path(TUBEFOOT_SOURCE_DIR) / "scenes/wellhead";

TEST(WellHead, IsWhatItsScriptWrites) {
  const TestFolder folder;
  fs::copy(wellhead_scenes / "make_wellhead.py", folder / "make_wellhead.py");
  if (std::system("python3 -c pass >/dev/null 2>&1") != 0) GTEST_SKIP() << "no Python";
  ASSERT_EQ(std::system(fmt::format("python3 '{}'", (folder / "make_wellhead.py").string()).c_str()), 0);
  EXPECT_TRUE(bytes_of(folder / "wellhead.obj") == bytes_of(wellhead_scenes / "wellhead.obj"));
  EXPECT_LT(fs::file_size(wellhead_scenes / "wellhead.obj"), 100000u);
}

/// Each mesh that the scenes name is read completely: no facet is dropped, and all facets are of steel.
TEST(WellHead, IsReadWholeByTheScenesThatNameIt) {
  for (const char* scene : {"mesh.toml", "crosstalk.toml", "plain.toml"}) {
    const Outcome outcome = run_program({"check", (wellhead_scenes / scene).string()});
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_NE(outcome.out.find("well-head"), std::string::npos) << outcome.out;
    EXPECT_EQ(outcome.err.find("warning"), std::string::npos) << outcome.err;
  }
}

/// Number of cells in the water before the seabed (5.3 to 5.9 m) with an echo above -45 dB of the strongest
/// echo.
std::size_t bright_water(const char* scene) {
  const TestFolder folder;
  const Outcome outcome =
      run_program({"run", (wellhead_scenes / scene).string(), "-o", (folder / "out").string(), "--quiet"});
  if (outcome.exit_code != 0) throw std::runtime_error(outcome.err);
  EXPECT_TRUE(fs::exists(folder / "out/camera-0000-received.png"));
  const Echoes echoes = read_echoes(folder / "out/echoes.nc");
  const std::size_t beams = echoes.beams, samples = echoes.samples;
  const double loudest = *std::max_element(echoes.energy.begin(), echoes.energy.end());
  std::size_t cells = 0;
  for (std::size_t beam = 0; beam < beams; ++beam)
    for (std::size_t k = 0; k < samples; ++k)
      if (echoes.slant_range_m[k] > 5.3 && echoes.slant_range_m[k] < 5.9 &&
          echoes.energy[beam * samples + k] > std::pow(10, -4.5) * loudest)
        ++cells;
  return cells;
}

TEST(WellHead, CrossTalkLightsWaterThatIsDarkForPlainBeams) {
  const std::size_t with = bright_water("crosstalk.toml"), without = bright_water("plain.toml");
  EXPECT_GT(without, 100u);  // the posts themselves
  EXPECT_GT(with, 3 * without);
}

}  // namespace
}  // namespace tubefoot
