// SPDX-License-Identifier: GPL-3.0-or-later
// Tests that each command reports the same for terrain by tiles as for the whole terrain. The facets and
// their numbers are the same, to the last bit.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <set>

#include "advice/trials.hpp"
#include "fixtures/mosaic.hpp"
#include "fixtures/program.hpp"
#include "fixtures/scene_texts.hpp"
#include "run/facet_blocks.hpp"
#include "run/own_engine.hpp"
#include "run/simulation.hpp"
#include "run/tiles_in_view.hpp"
#include "sensors/kinds/scene_file.hpp"
#include "viewer/page.hpp"
#include "viewer/view_gather.hpp"

namespace tubefoot {
namespace {

using namespace mosaic;

struct CommandCase {
  const char* name;
  std::string text;  ///< with {} for the terrain
  bool holes = false, island = false;
  const char* more = "";  ///< of the terrain
  friend void PrintTo(const CommandCase& of, std::ostream* out) { *out << of.name; }
};

std::vector<CommandCase> cases() {
  const std::string line(diagonal);
  const std::string few = replaced(replaced(std::string(sidescan), "pings = 9", "pings = 3"),
                                   "ping_interval_s = 8", "ping_interval_s = 18.6");
  // The third ping has the island abeam. Paths over the surface need few of the tiles.
  const std::string abeam = replaced(few, "range_max_m = 22", "range_max_m = 16");
  const std::string relief = with_ripples(scene("", line + few + "[relief]\ncell_m = 0.25\n"));
  return {
      {"HolesAndAnObject", scene("", std::string(ball) + line + few), true},
      {"AnIslandAndTheSurface",
       scene("[sea_surface]\nheight_m = 0\n[paths]\norder = 2\n", std::string(ball) + line + abeam), false,
       true},
      {"AMapAndAnIsland", with_mud(scene("[sea_surface]\nheight_m = 0\n", std::string(ball) + line + abeam)),
       false, true, patches},
      {"ReliefOnline", relief},
      {"ReliefOffline", replaced(relief, "cell_m = 0.25", "mode = \"offline\"\ncell_m = 0.6")},
      {"ReliefOfflineOfAMapAndAnIsland",
       with_ripples(with_mud(scene("[sea_surface]\nheight_m = 0\n", std::string(ball) + line + abeam)) +
                    "[relief]\nmode = \"offline\"\ncell_m = 0.6\n"),
       false, true, patches},
      {"RefractingWater", scene("[water]\nprofile = \"gradient\"\nsound_speed_m_s = 1500\ngradient_per_s = "
                                "-1.5\nprofile_bottom_m = 30\n",
                                line + few)}};
}

/// The ways to read the terrain.
struct TileUse {
  const char *name, *load;
  int cache_mb;
};
constexpr TileUse whole{"whole", "whole", 512}, in_one{"in_one", "tiles", 512},
    in_parts{"in_parts", "tiles", 0};

class TiledCommands : public testing::TestWithParam<CommandCase> {
 protected:
  TiledCommands() { write_mosaic(folder, GetParam().holes, GetParam().island); }

  std::string text(const TileUse& use) const {
    return replaced(GetParam().text, "{}", terrain("mosaic.vrt", use.load, GetParam().more)) +
           (GetParam().text.find("[run]") == std::string::npos ? "[run]\n" : "") +
           fmt::format("terrain_cache_mb = {}\n", use.cache_mb);
  }
  SceneDescription described(const TileUse& use) const {
    return read_scene_text(text(use), folder / "scene.toml");
  }
  /// Returns the messages of a command, and the files that it writes into the folder or file of its last
  /// word.
  std::map<std::string, std::string> answers(const TileUse& use, std::vector<std::string> words) const {
    const fs::path output = folder / words.back();
    words.insert(words.begin() + 1, folder.write("scene.toml", text(use)).string());
    if (words[words.size() - 2] == "-o") words.back() = output.string();
    const Outcome outcome = run_program(words);
    EXPECT_LE(outcome.exit_code, 2) << outcome.err;
    std::map<std::string, std::string> all{{"code", std::to_string(outcome.exit_code)}, {"out", outcome.out}};
    if (outcome.exit_code == 2) {
      EXPECT_EQ(outcome.err.find("tiles"), std::string::npos) << outcome.err;
    }
    if (fs::is_directory(output))
      for (const auto& entry : fs::directory_iterator(output))
        all[entry.path().filename().string()] = bytes_of(entry.path());
    else if (fs::exists(output))
      all["file"] = bytes_of(output);
    fs::remove_all(output);
    return all;
  }
  void expect_same(const std::vector<std::string>& words) const {
    const auto expected = answers(whole, words);
    for (const TileUse& use : {in_one, in_parts}) {
      const auto found = answers(use, words);
      EXPECT_EQ(found.size(), expected.size());
      for (const auto& [name, bytes] : expected)
        EXPECT_TRUE(found.contains(name) && found.at(name) == bytes)
            << words.front() << ", " << use.name << ": " << name
            << " differs; whole: " << bytes.substr(0, 600)
            << "\ntiles: " << (found.contains(name) ? found.at(name).substr(0, 600) : "none");
    }
  }
  TestFolder folder;
};

TEST_P(TiledCommands, AuditHasTheHashOfTheWhole) { expect_same({"audit"}); }

TEST_P(TiledCommands, CoverageHasTheFacetsOfTheWhole) { expect_same({"coverage", "-o", "covered"}); }

TEST_P(TiledCommands, FootprintsNameTheFacetsOfTheWhole) {
  expect_same({"footprints", "--sensor", "side", "--pings", "1:2", "-o", "f.csv"});
}

TEST_P(TiledCommands, ExactCornersNameTheFacetsOfTheWhole) {
  expect_same({"footprints", "--sensor", "side", "--pings", "2", "-o", "f.txt"});
}

TEST_P(TiledCommands, APageShowsWhatItShowsOfTheWhole) {
  const auto page = [&](const TileUse& use) {
    const auto survey = open_survey(described(use));
    ViewData view = gather_view(Transmissions(*survey, request_of(survey->scene.description.run)), 0,
                                PingRange{1, 2}, true);
    EXPECT_GT(view.mesh_facets.size(), 1000u);
    view.scene_hash.clear();
    return view_page(view);
  };
  const std::string expected = page(whole);
  EXPECT_TRUE(page(in_parts) == expected);
}

// Returns the facets of a history as a user engine sees them, and their corners, without engine-specific
// numbers.
TEST_P(TiledCommands, AnEngineOfOnesOwnMeetsTheFacetsOfTheWhole) {
  const auto energies = [&](const TileUse& use) {
    const SceneDescription description = described(use);
    const auto survey = open_survey(description);
    RunRequest request = request_of(description.run);
    request.own_engine = std::make_shared<const OwnEngine>(
        OwnEngine{"own", [](const Transmission& transmission, std::size_t, std::span<double> energy) {
                    const History history = transmission.trace();
                    std::size_t k = 0;
                    for (const Footprint& footprint : history.footprints.footprints) {
                      const FacetMesh& mesh = transmission.surface_mesh().mesh();
                      const GridPoint corner = mesh.vertices[mesh.facets[footprint.facet][0]];
                      energy[k++ % energy.size()] += footprint.area_m2 * std::abs(1.0 * corner.x + corner.z);
                      // By the identifier of the facet, too.
                      energy[k++ % energy.size()] += transmission.surface_mesh().base_facet(footprint.facet);
                    }
                  }});
    SimulationStats stats;
    const auto recordings = simulate(*survey, request, stats);
    return std::vector<double>(recordings[0].energy.begin(), recordings[0].energy.end());
  };
  const std::vector<double> expected = energies(whole);
  EXPECT_GT(*std::ranges::max_element(expected), 0);
  EXPECT_EQ(energies(in_parts), expected);
}

TEST_P(TiledCommands, TrialsHaveTheErrorsOfTheWhole) {
  const auto trial = [&](const TileUse& use) {
    const TrialScene trials(described(use), first_pings(2), std::nullopt);
    const Trial found = trials.run(tube_setting(Binning::centroid), 1);
    return std::vector<double>{found.l1_error, found.rms_db_error};
  };
  const std::vector<double> expected = trial(whole);
  EXPECT_GT(expected[0], 0);
  EXPECT_EQ(trial(in_parts), expected);
}

INSTANTIATE_TEST_SUITE_P(Scenes, TiledCommands, testing::ValuesIn(cases()),
                         [](const auto& of) { return std::string(of.param.name); });

// With an empty cache each row of tiles is a block, and only a few pings see each block. The sphere is
// abeam of ping 4.
TEST(TiledBlocks, HoldEachFacetOnceWithThePingsThatMaySeeIt) {
  const TestFolder folder;
  write_mosaic(folder, false);
  SceneDescription description = read_scene_text(
      replaced(scene("", replaced(std::string(ball), "[-4, 8, 0]", "[-6.3, 8.3, 0]") + std::string(diagonal) +
                             replaced(std::string(sidescan), "range_max_m = 22", "range_max_m = 11")),
               "{}", terrain("mosaic.vrt", "tiles")),
      folder / "scene.toml");
  std::vector<ReceivedPing> pings;
  for (std::size_t ping = 0; ping < 9; ++ping) pings.push_back({0, ping});
  const auto blocks_of = [&](int cache_mb) {
    description.run.terrain_cache_mb = cache_mb;
    const auto survey = open_survey(description);
    return facet_blocks(Transmissions(*survey, request_of(description.run)), pings);
  };
  EXPECT_EQ(blocks_of(512).size(), 1u);
  const std::vector<FacetBlock> blocks = blocks_of(0);
  ASSERT_EQ(blocks.size(), 5u)
      << "4 rows of tiles, the fifth having but 3 rows of cells at the edge; the ball";
  EXPECT_EQ(blocks.front().first, 0u);
  EXPECT_EQ(blocks.back().first, 2u * (columns - 1) * (rows - 1));
  std::set<std::size_t> seen;
  FacetId end = 0;
  for (const FacetBlock& block : blocks) {
    EXPECT_GE(block.first, end);
    EXPECT_GT(block.end, block.first);
    end = block.end;
    EXPECT_LT(block.pings.size(), pings.size());
    seen.insert(block.pings.begin(), block.pings.end());
  }
  EXPECT_EQ(seen.size(), pings.size());
}

TEST(TiledRefine, WritesTheSeabedOfTheWhole) {
  const TestFolder folder;
  write_mosaic(folder, true);
  const std::string text =
      with_ripples(scene("", std::string(diagonal) + std::string(sidescan) + "[relief]\ncell_m = 0.3\n"));
  std::vector<std::string> seabeds;
  for (const char* load : {"whole", "tiles"}) {
    const auto file = folder.write(
        "scene.toml", replaced(text, "{}", terrain("mosaic.vrt", load, "window = [60, 50, 150, 140]\n")));
    const Outcome outcome = run_program({"refine", file.string(), "-o", (folder / load).string()});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    seabeds.push_back(bytes_of(folder / load));
  }
  EXPECT_GT(seabeds[0].size(), 1000000u);
  EXPECT_TRUE(seabeds[0] == seabeds[1]);
}

}  // namespace
}  // namespace tubefoot
