// SPDX-License-Identifier: GPL-3.0-or-later
// Tests that terrain by tiles gives the same results as terrain that is loaded as a whole, to the last bit.
// It also tests the memory of the tile cache and broken tiles.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <fstream>
#include <memory>

#include "fixtures/mosaic.hpp"
#include "fixtures/mpirun.hpp"
#include "fixtures/program.hpp"
#include "fixtures/scene_texts.hpp"
#include "run/checkpoint/ping_store.hpp"
#include "run/region_plan.hpp"
#include "run/simulation.hpp"
#include "run/survey.hpp"
#include "sensors/kinds/scene_file.hpp"

namespace tubefoot {
namespace {

namespace fs = std::filesystem;
using namespace mosaic;
using testing::AllOf;
using testing::HasSubstr;

struct Result {
  std::vector<std::vector<double>> energy;
  std::vector<std::vector<double>> altitude_m;
  SimulationStats stats;
  std::size_t regions = 0, loads = 0, most_bytes = 0;
};

Result simulated(const SceneDescription& description, int threads = 2,
                 std::optional<double> reference_tolerance = {}) {
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                  static_cast<std::size_t>(threads));
  const auto survey = open_survey(description);
  RunRequest request = request_of(description.run);
  request.reference_tolerance = reference_tolerance;
  const auto store = std::make_shared<PingStore>(layout_of(*survey, request));
  simulate(*survey, request, *store, {});
  Result result;
  for (std::size_t s = 0; s < survey->sensors.size(); ++s) {
    const auto take = [&](std::span<const double> values) {
      result.energy.emplace_back(values.begin(), values.end());
    };
    take(store->in_memory(s, "energy"));
    if (store->find(s, "energy_bound")) take(store->in_memory(s, "energy_bound"));
    std::vector<double> altitude = survey->sensors[s].altitudes_m;
    std::replace_if(
        altitude.begin(), altitude.end(), [](double a) { return std::isnan(a); }, -1.0);
    result.altitude_m.push_back(std::move(altitude));
  }
  result.stats = totals(*survey, *store);
  if (survey->loaded_scene->terrain_use) {
    result.regions = survey->loaded_scene->terrain_use->regions;
    result.loads = survey->loaded_scene->terrain_use->loads;
    result.most_bytes = survey->loaded_scene->terrain_use->most_bytes;
  }
  return result;
}

std::size_t bytes_of_mesh(const Survey& survey) {
  return survey.loaded_scene->tree->bytes() + survey.scene.mesh.facets.size() * 16 +
         survey.scene.mesh.vertices.size() * sizeof(GridPoint);
}

double sum(const std::vector<double>& values) {
  double all = 0;
  for (const double v : values) all += v;
  return all;
}

struct TiledCase {
  const char* name;
  std::string text;  ///< with {} for the terrain
  bool holes = false, island = false;
  const char* more = "";  ///< of the terrain
  std::optional<double> reference = {};
  friend void PrintTo(const TiledCase& of, std::ostream* out) { *out << of.name; }
};

std::vector<TiledCase> scenes() {
  const std::string line(diagonal), side(sidescan);
  std::string relief =
      with_ripples(scene("", line + side + "[relief]\ncell_m = 0.25\ndisplace = \"normal\"\n"));
  relief = replaced(relief, "pings = 9", "pings = 3");
  relief = replaced(relief, "ping_interval_s = 8", "ping_interval_s = 27");
  const std::string few =
      replaced(replaced(side, "pings = 9", "pings = 3"), "ping_interval_s = 8", "ping_interval_s = 27");
  const auto offline = [](const std::string& text) {
    return with_ripples(text + "[relief]\nmode = \"offline\"\ncell_m = 0.6\n");
  };
  const std::string refracting =
      "[water]\nprofile = \"gradient\"\nsound_speed_m_s = 1500\ngradient_per_s = "
      "-1.5\nprofile_bottom_m = 30\n";
  return {
      {"Sidescan", scene("", line + side)},
      {"SidescanWithHolesAndAnObject", scene("", std::string(ball) + line + side), true},
      {"MultibeamOfAWindowDecimated", scene("", line + std::string(multibeam)), false, false,
       "window = [11, 7, 280, 250]\ndecimate = 2"},
      {"TwoSensors", scene("", line + side + std::string(multibeam)), true},
      {"ReliefOnline", relief},
      {"ReliefOffline", replaced(replaced(relief, "cell_m = 0.25", "cell_m = 0.6"),
                                 "displace =", "mode = \"offline\"\ndisplace =")},
      {"ReliefOfflineWithHolesAndAnObject", offline(scene("", std::string(ball) + line + few)), true},
      {"ReliefOfflineOfAMapAndAnIsland",
       offline(with_mud(scene("[sea_surface]\nheight_m = 0\n",
                              line + replaced(few, "range_max_m = 22", "range_max_m = 16")))),
       false, true, patches},
      {"ReliefOfflineInRefractingWater", offline(scene(refracting, line + few))},
      {"RefractingWater", scene(refracting, line + few)},
      {"RefractingWaterWithReceiverApart", scene(refracting, line + few + "receiver_arm_m = [0.3, 0, 0]\n")},
      {"ReceiverApart", scene("", line + few + "receiver_arm_m = [0.3, 0, 0]\n"), true},
      {"PathsOverTheSurface", scene("[sea_surface]\nheight_m = 0\n[paths]\norder = 2\n",
                                    line + replaced(few, "range_max_m = 22", "range_max_m = 9"))},
      {"RefractingWaterUnderASurface",  // only this part is viewed: no sector contains the seabed
       scene(refracting + "[sea_surface]\nheight_m = 0\n[paths]\norder = 3\n",
             line + "[[sensors]]\nname = \"up\"\nkind = \"imaging\"\nbeams = 4\nhorizontal_deg = 20\n"
                    "vertical_deg = 40\ntilt_deg = -50\nrange_min_m = 14\nrange_max_m = 26\nsamples = 20\n"
                    "pings = 3\nping_interval_s = 27\n")},
      {"AnIslandAndTheSurface",
       scene("[sea_surface]\nheight_m = 0\n", line + replaced(few, "range_max_m = 22", "range_max_m = 16")),
       false, true},
      {"MaterialMap", with_mud(scene("", std::string(ball) + line + side)), true, false, patches},
      {"Reference", scene("", line + replaced(few, "samples = 60", "samples = 12")), true, false, "", 1e-6},
      {"Rays", scene("", line + few + "[run]\nengine = \"ray\"\nrays_per_ping = 5000\n")},
  };
}

class TiledTerrain : public testing::TestWithParam<TiledCase> {};

TEST_P(TiledTerrain, GivesTheBitsOfTheWhole) {
  const TiledCase& given = GetParam();
  const TestFolder folder;
  write_mosaic(folder, given.holes, given.island);
  const auto described = [&](const char* load, int cache_mb) {
    SceneDescription description = read_scene_text(
        replaced(given.text, "{}", terrain("mosaic.vrt", load, given.more)), folder / "scene.toml");
    description.run.terrain_cache_mb = cache_mb;
    return description;
  };
  const Result whole = simulated(described("whole", 0), 2, given.reference);
  ASSERT_GT(sum(whole.energy[0]), 0);
  EXPECT_EQ(whole.regions, 0u);
  struct {
    int threads, cache_mb;
  } const ways[] = {{1, 512}, {2, 0}};
  for (const auto& [threads, cache_mb] : ways) {
    SCOPED_TRACE(fmt::format("{} threads, {} MB", threads, cache_mb));
    const Result tiles = simulated(described("tiles", cache_mb), threads, given.reference);
    EXPECT_EQ(tiles.energy, whole.energy);
    EXPECT_EQ(tiles.altitude_m, whole.altitude_m);
    EXPECT_EQ(tiles.stats.candidates, whole.stats.candidates);
    EXPECT_EQ(tiles.stats.pieces, whole.stats.pieces);
    EXPECT_EQ(tiles.stats.refined_facets, whole.stats.refined_facets);
    EXPECT_GE(tiles.loads, tiles.regions);
    if (cache_mb == 0) {
      EXPECT_GE(tiles.regions, 2u);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Scenes, TiledTerrain, testing::ValuesIn(scenes()),
                         [](const auto& of) { return std::string(of.param.name); });

SceneDescription with_load(const TestFolder& folder, std::string_view file, std::string_view load,
                           std::string_view sensors = sidescan) {
  return read_scene_text(
      replaced(scene("", std::string(diagonal) + std::string(sensors)), "{}", terrain(file, load)),
      folder / "scene.toml");
}

TEST(TiledTerrainFiles, ACloudOptimisedGeoTiffIsReadByTiles) {
  const TestFolder folder;
  char* options[] = {const_cast<char*>("BLOCKSIZE=128"), const_cast<char*>("COMPRESS=DEFLATE"), nullptr};
  write(*raster(true), "COG", folder / "bed.tif", options);
  EXPECT_EQ(simulated(with_load(folder, "bed.tif", "tiles")).energy,
            simulated(with_load(folder, "bed.tif", "whole")).energy);
}

// A towfish sees few tiles: a cache of this size never contains more.
TEST(TiledTerrainFiles, NoMoreIsHeldThanTheCacheAndWhatIsInUse) {
  const TestFolder folder;
  write_mosaic(folder, false);
  const std::string near = replaced(sidescan, "range_max_m = 22", "range_max_m = 11");
  SceneDescription description = with_load(folder, "mosaic.vrt", "tiles", near);
  description.run.terrain_cache_mb = 0;
  const auto survey = open_survey(description);
  const RegionPlan plan(Transmissions(*survey, request_of(description.run)), 0);
  std::size_t largest = 0;
  for (const RegionPlan::Region& region : plan.regions())
    largest = std::max(largest, bytes_of_mesh(survey_with_tiles(*survey, region.tiles)));
  const Result one = simulated(description, 1);
  EXPECT_EQ(one.loads, plan.regions().size());
  EXPECT_LE(one.most_bytes, 2 * largest) << "the last one and the next";
  description = with_load(folder, "mosaic.vrt", "whole", near);
  EXPECT_LT(3 * largest, bytes_of_mesh(*open_survey(description)));
}

TEST(TiledTerrainFiles, CheckSaysWhatIsThereWithoutLoadingIt) {
  const TestFolder folder;
  write_mosaic(folder, false);
  folder.write("scene.toml", replaced(scene("", std::string(diagonal) + std::string(sidescan)), "{}",
                                      terrain("mosaic.vrt", "tiles")));
  const Outcome outcome = run_program({"check", (folder / "scene.toml").string()});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_THAT(outcome.out,
              HasSubstr(fmt::format("facets         {}; those of 'bed' in 5 x 5 tiles of 64 x 64 cells",
                                    2 * (columns - 1) * (rows - 1))));
}

// Cells that give too many facets are rejected before the facets are made, by tiles as for the whole.
TEST(TiledTerrainFiles, TooFineASeabedIsRefusedBeforeItIsMade) {
  const TestFolder folder;
  write_mosaic(folder, false);
  for (const char* load : {"whole", "tiles"}) {
    const std::string text =
        replaced(with_ripples(scene("", std::string(ball) + std::string(diagonal) + std::string(sidescan))),
                 "{}", terrain("mosaic.vrt", load, "window = [60, 50, 150, 140]\n")) +
        "[relief]\nmode = \"offline\"\ncell_m = 0.001\n";
    const Outcome outcome =
        run_program({"run", folder.write("scene.toml", text).string(), "-o", (folder / "out").string()});
    EXPECT_EQ(outcome.exit_code, 2);
    EXPECT_THAT(outcome.err, HasSubstr("a larger 'cell_m'"));
  }
}

// A refined seabed, made as a whole or by tiles, can be read by tiles, one region at a time.
TEST(TiledTerrainFiles, ARefinedSeabedIsReadByTiles) {
  const TestFolder folder;
  write_mosaic(folder, true);
  const auto text = [&](std::string_view load, std::string_view more) {
    return replaced(
               with_ripples(scene("", std::string(ball) + std::string(diagonal) + std::string(sidescan))),
               "{}", terrain("mosaic.vrt", load, "window = [60, 50, 150, 140]\n")) +
           fmt::format("[relief]\nmode = \"offline\"\ncell_m = 0.3\n{}", more);
  };
  const auto energies = [&](std::string_view load, std::string_view more, int cache_mb) {
    SceneDescription description = read_scene_text(text(load, more), folder / "scene.toml");
    description.run.terrain_cache_mb = cache_mb;
    const Result result = simulated(description);
    if (load == "tiles" && cache_mb == 0) {
      EXPECT_GE(result.regions, 2u);
    }
    return result.energy;
  };
  const auto expected = energies("whole", "", 0);
  ASSERT_GT(sum(expected[0]), 0);
  for (const char* by : {"whole", "tiles"}) {
    const auto refined = run_program(
        {"refine", folder.write("scene.toml", text(by, "")).string(), "-o", (folder / "bed.ply").string()});
    ASSERT_EQ(refined.exit_code, 0) << refined.err;
    EXPECT_EQ(energies("whole", "file = \"bed.ply\"\n", 0), expected);
    EXPECT_EQ(energies("tiles", "file = \"bed.ply\"\n", 512), expected);
    EXPECT_EQ(energies("tiles", "file = \"bed.ply\"\n", 0), expected);
  }
  // One height of this raster differs, so that it belongs to another seabed.
  GDALAllRegister();
  {
    const GDALDatasetUniquePtr data(GDALDataset::Open((folder / "part0.tif").c_str(), GDAL_OF_UPDATE));
    float value = -11.5f;
    ASSERT_EQ(
        data->GetRasterBand(1)->RasterIO(GF_Write, 100, 80, 1, 1, &value, 1, 1, GDT_Float32, 0, 0, nullptr),
        CE_None);
  }
  const Outcome other =
      run_program({"check", folder.write("scene.toml", text("tiles", "file = \"bed.ply\"\n")).string()});
  EXPECT_EQ(other.exit_code, 2);
  EXPECT_THAT(other.err, HasSubstr("of another scene"));
}

// A source is truncated during a run: the earlier pings are kept, and the run can resume after the source
// is restored.
TEST(TiledTerrainFiles, ABrokenTileStopsTheRunAndKeepsWhatWasFinished) {
  const TestFolder folder;
  write_mosaic(folder, false);
  const fs::path last = folder / "part3.tif";
  SceneDescription description = with_load(folder, "mosaic.vrt", "tiles");
  description.run.terrain_cache_mb = 0;
  const auto survey = open_survey(description);
  const std::string intact = bytes_of(last);
  const RunRequest request = request_of(description.run);
  const auto store = std::make_shared<PingStore>(layout_of(*survey, request));
  fs::resize_file(last, intact.size() / 3);
  try {
    const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
    simulate(*survey, request, *store, {});
    FAIL() << "the end of the line needs the south-east";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr((folder / "mosaic.vrt").string()));
    EXPECT_THAT(error.what(), HasSubstr("part3.tif"));
  }
  EXPECT_GT(store->done_units(), 1u);
  EXPECT_LT(store->done_units(), 9u);
  std::ofstream(last, std::ios::binary) << intact;
  simulate(*survey, request, *store, {});
  const auto energy = store->in_memory(0, "energy");
  EXPECT_EQ(std::vector<double>(energy.begin(), energy.end()),
            simulated(with_load(folder, "mosaic.vrt", "whole")).energy[0]);
}

TEST(TiledTerrainFiles, RecordingsKeepTheirEnergies) {
  const TestFolder folder;
  write_mosaic(folder, false);
  const SceneDescription description = with_load(folder, "mosaic.vrt", "tiles");
  const auto survey = open_survey(description);
  const RunRequest request = request_of(description.run);
  auto store = std::make_shared<PingStore>(layout_of(*survey, request));
  simulate(*survey, request, *store, {});
  const std::span<const double> kept = store->in_memory(0, "energy");
  const std::vector<double> before(kept.begin(), kept.end());
  const std::weak_ptr<PingStore> alive = store;
  std::vector<Recording> recordings = recordings_of(*survey, store);
  store.reset();
  ASSERT_FALSE(alive.expired());
  EXPECT_TRUE(std::ranges::equal(recordings.front().energy, before));
  recordings.clear();
  EXPECT_TRUE(alive.expired());
}

TEST(TiledTerrainFiles, TheHashSeesTheSourcesOfAMosaic) {
  const TestFolder folder;
  write_mosaic(folder, false);
  const std::string before = with_load(folder, "mosaic.vrt", "tiles").sha256;
  EXPECT_EQ(with_load(folder, "mosaic.vrt", "tiles").sha256, before);
  std::string bytes = bytes_of(folder / "part2.tif");
  bytes.back() = static_cast<char>(bytes.back() + 1);
  std::ofstream(folder / "part2.tif", std::ios::binary) << bytes;
  EXPECT_NE(with_load(folder, "mosaic.vrt", "tiles").sha256, before);
}

TEST(TiledTerrainFiles, RanksWriteWhatOneProcessWrites) {
  if (!fs::exists(TUBEFOOT_MPIRUN) || !fs::exists(TUBEFOOT_MPI_LIBRARY))
    GTEST_SKIP() << "Open MPI is not installed: libopenmpi-dev, openmpi-bin";
  const TestFolder folder;
  write_mosaic(folder, false);
  folder.write("scene.toml", replaced(scene("", std::string(diagonal) + std::string(sidescan)), "{}",
                                      terrain("mosaic.vrt", "tiles")) +
                                 "[run]\nterrain_cache_mb = 0\n");
  const std::vector<std::string> words{"run", (folder / "scene.toml").string(), "--threads", "1", "-o"};
  const auto run = [&](const char* name, const Surroundings& surroundings) {
    std::vector<std::string> own = words;
    own.push_back((folder / name).string());
    const Outcome outcome = run_program(own, surroundings);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    return bytes_of(folder / name / "echoes.nc");
  };
  Surroundings ranks;
  ranks.before = mpirun(2);
  const std::string alone = run("alone", {});
  EXPECT_GT(alone.size(), 1000u);
  EXPECT_TRUE(alone == run("ranks", ranks));
}

}  // namespace
}  // namespace tubefoot
