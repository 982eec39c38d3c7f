// SPDX-License-Identifier: GPL-3.0-or-later
// Tests the limits of the program: they agree with docs/limits.md, long lines are rejected, and available
// memory respects the limits of the process.

#include "files/limits.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fstream>
#include <iterator>
#include <sstream>

#include "engine/relief/spectral_relief.hpp"
#include "files/csv_file.hpp"
#include "files/memory_at_hand.hpp"
#include "geometry/mesh/plan_cut.hpp"
#include "scene/surfaces/material_map.hpp"

namespace tubefoot {
namespace {

using testing::HasSubstr;

TEST(Limits, AreThoseOfTheirPage) {
  std::ifstream in(std::string(TUBEFOOT_SOURCE_DIR) + "/docs/limits.md");
  const std::string page{std::istreambuf_iterator<char>(in), {}};
  const auto row = [&page](const char* what, auto most, const char* unit = "") {
    EXPECT_THAT(page, HasSubstr(fmt::format("\n| {} | {}{} |", what, most, unit)));
  };
  row("a scene file", limits::scene_file_bytes, " bytes");
  row("a text in a scene file", limits::text_bytes, " bytes");
  row("a scene's title", limits::title_bytes, " bytes");
  row("a name in a scene file", limits::name_bytes, " bytes");
  row("a file that a scene names", limits::named_file_bytes >> 30, " GiB");
  row("a line of a table (track, profile, pattern, law)", limits::line_bytes, " bytes");
  row("rows of a track or a profile", limits::table_rows);
  row("cells of a terrain, or read of a raster", static_cast<std::int64_t>(limits::cells));
  row("cells of a raster that is read by tiles", static_cast<std::int64_t>(limits::tiled_cells));
  row("a block (strip, tile, chunk) of a raster", limits::block_bytes, " bytes");
  row("facets of one primitive", static_cast<std::int64_t>(limits::primitive_facets));
  row("nodes of a relief's tile, along a side", kMostNodes);
  row("pieces of borders of a material map", most_material_borders);
  row("crossings of borders of a material map on a terrain",
      fmt::format("{}, and one more per {} pieces of borders", most_plan_crossings, segments_per_crossing));
  row("patches of a material map", most_material_patches);
  row("names of attributes of a GeoJSON map", limits::map_attributes);
  row("pairs of attribute names that follow each other in a feature of a GeoJSON map",
      limits::map_attribute_pairs);
  row("nodes of a model, one in another", limits::model_depth);
  row("nodes of a glTF model", limits::gltf_nodes);
  row("vertices, corners and values of morph targets that a model reads or places", limits::model_repeated,
      ", and one more per byte of the model");
  row("beams times samples of a ping", limits::ping_cells);
  row("pings times cycles of a sensor", limits::sensor_transmissions);
  EXPECT_THAT(page, HasSubstr(fmt::format("a facet counts {} bytes", bytes_a_facet)));
}

TEST(NextLine, IsThatOfGetline) {
  for (const std::string text : {"", "\n", "a", "a\n", "a\n\nbc", "\n\n", "a\r\nb\n"}) {
    SCOPED_TRACE(text);
    std::istringstream one(text), other(text);
    std::string line, expected;
    for (;;) {
      const bool more = next_line(one, line, {"file"});
      ASSERT_EQ(more, static_cast<bool>(std::getline(other, expected)));
      if (!more) break;
      EXPECT_EQ(line, expected);
    }
  }
}

TEST(NextLine, RefusesALineThatIsTooLong) {
  std::string text(limits::line_bytes, 'x');
  std::string line;
  std::istringstream longest(text + "\ny");
  EXPECT_TRUE(next_line(longest, line, {"file", 3}));
  EXPECT_EQ(line, text);
  std::istringstream longer(text + "xy");
  try {
    next_line(longer, line, {"file", 3});
    FAIL();
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("file:3: the line is longer than 1048576 bytes"));
  }
  EXPECT_EQ(longer.get(), 'y') << "no more was read";
}

TEST(MemoryAtHand, IsWhatTheMachineHasOrLess) {
  const double machine =
      static_cast<double>(sysconf(_SC_PHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGESIZE));
  EXPECT_GT(memory_at_hand(), 0);
  EXPECT_LT(memory_at_hand(), machine);
  EXPECT_NO_THROW(require_memory(1e6, {"scene.toml", 3, 4}, "two facets", "take one"));
  try {
    require_memory(2 * machine, {"scene.toml", 3, 4}, "two facets", "take one");
    FAIL();
  } catch (const InputError& error) {
    EXPECT_THAT(
        error.what(),
        testing::MatchesRegex(
            "scene.toml:3:4: two facets would need .* GB of memory, but only .* are available: take one"));
  }
}

// Runs in a separate process, which ends with the test.
TEST(MemoryAtHand, IsNoMoreThanTheLimitLeaves) {
#ifdef TUBEFOOT_SANITIZED
  GTEST_SKIP() << "sanitizers set aside terabytes of addresses";
#endif
  const pid_t child = fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    const double before = memory_at_hand();
    const rlimit limit{std::size_t{1} << 40, std::size_t{1} << 40};
    setrlimit(RLIMIT_AS, &limit);
    if (memory_at_hand() > before * 1.01) _exit(1);
    const rlimit taken{1 << 20, 1 << 20};  // already exceeded
    setrlimit(RLIMIT_AS, &taken);
    _exit(memory_at_hand() == 0 ? 0 : 2);
  }
  int status = 0;
  waitpid(child, &status, 0);
  EXPECT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 0);
}

}  // namespace
}  // namespace tubefoot
