// SPDX-License-Identifier: GPL-3.0-or-later
// Tests runs of selected pings and beams. Their energies equal those of the same pings and beams of the
// whole run, to the last bit.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "fixtures/mosaic.hpp"
#include "fixtures/mpirun.hpp"
#include "fixtures/netcdf_reader.hpp"
#include "fixtures/program.hpp"
#include "run/checkpoint/ping_store.hpp"

namespace tubefoot {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;
using Words = std::vector<std::string>;

/// Two cameras that share their transmissions, another camera, and a sidescan, over a rough seabed with a
/// sphere.
std::string scene_with(const std::string& water, const std::string& material, const std::string& of_camera,
                       const std::string& more = "") {
  const auto camera = [&](const char* name, const char* window) {
    return fmt::format(
        "[[sensors]]\nname = \"{}\"\nkind = \"didson\"\nbeams = 20\nhorizontal_deg = 20\ntilt_deg = 20\n"
        "vertical_deg = 20\npings = 6\nping_interval_s = 0.2\nsamples = 40\n{}\n{}\n",
        name, window, of_camera);
  };
  return fmt::format(
             "{}\n[[materials]]\nname = \"sand\"\n{}\n[[terrain]]\nkind = \"fractal\"\nwidth_m = 20\n"
             "length_m = 24\ncell_m = 0.5\n[[objects]]\nname = \"ball\"\nshape = \"sphere\"\n"
             "chord_error_m = 0.01\nradius_m = 0.5\nposition_m = [0, 4, 0.3]\n[trajectory]\nkind = \"line\"\n"
             "start_m = [0, -1, 2]\nend_m = [0, 1, 2]\n{}\n",
             water, material, more) +
         camera("near", "window_start_m = 2\nwindow_length_m = 4") +
         camera("far", "window_start_m = 4\nwindow_length_m = 6") +
         camera("tilted", "window_start_m = 2\nwindow_length_m = 4\nroll_deg = 3") +
         "[[sensors]]\nname = \"side\"\nkind = \"sidescan\"\nsamples = 30\nrange_min_m = 1\nrange_max_m = 8\n"
         "ping_interval_s = 0.1\npings = 9\nspeckle = \"rayleigh\"\n";
}

struct SelectionRun : testing::Test {
  TestFolder folder;

  fs::path write(const std::string& scene) const { return folder.write("scene.toml", scene); }
  Outcome run(const fs::path& output, Words words) const {
    Words all{"run", (folder / "scene.toml").string(), "-o", output.string(), "--quiet"};
    all.insert(all.end(), words.begin(), words.end());
    return run_program(all);
  }
  /// Runs without pictures, which take longer than the echoes.
  Outcome run_echoes(const fs::path& output, Words words) const {
    words.insert(words.end(), {"--pictures", "none"});
    return run(output, words);
  }
  /// Compares a run of pings `first` to `first + pings - 1` and of `beams` of a sensor with the whole run.
  void expect_part(const Words& options, const std::string& sensor, std::size_t first, std::size_t pings,
                   const std::vector<std::size_t>& beams, const Words& selection,
                   const std::vector<std::string>& variables = {"energy"}) const {
    SCOPED_TRACE(sensor);
    Words words = options;
    words.insert(words.end(), {"--sensor", sensor});
    words.insert(words.end(), selection.begin(), selection.end());
    fs::remove_all(folder / "part");
    const Outcome outcome = run_echoes(folder / "part", words);
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    const NetcdfReader whole(folder / "whole/echoes.nc"), part(folder / "part/echoes.nc");
    EXPECT_EQ(part.text("/", "sensor_name"), sensor);
    const std::string group = "/" + sensor;
    const std::size_t all_beams = whole.length(group, "beam"), samples = whole.length(group, "sample");
    ASSERT_EQ(part.length("/", "ping"), pings);
    ASSERT_EQ(part.length("/", "beam"), beams.size());
    double received = 0;
    for (const std::string& variable : variables) {
      const std::vector<double> all = whole.values(group, variable), some = part.values("/", variable);
      for (std::size_t p = 0; p < pings; ++p)
        for (std::size_t b = 0; b < beams.size(); ++b)
          for (std::size_t k = 0; k < samples; ++k) {
            const double kept = some[(p * beams.size() + b) * samples + k];
            ASSERT_EQ(kept, all[((first + p) * all_beams + beams[b]) * samples + k])
                << variable << " at ping " << p << ", beam " << b << ", sample " << k;
            received += kept;
          }
    }
    EXPECT_GT(received, 0);
    for (const char* axis : {"ping_time", "sensor_heading"}) {
      const std::vector<double> all = whole.values(group, axis), some = part.values("/", axis);
      for (std::size_t p = 0; p < pings; ++p) EXPECT_EQ(some[p], all[first + p]) << axis;
    }
    const std::vector<double> azimuths = whole.values(group, "beam_azimuth"),
                              own = part.values("/", "beam_azimuth");
    for (std::size_t b = 0; b < beams.size(); ++b) EXPECT_EQ(own[b], azimuths[beams[b]]);
  }
};

const std::vector<std::size_t> of_camera{0, 3, 4, 5, 19};
const Words pings_and_beams{"--pings", "2:4", "--beams", "19,3:5,0"};

TEST_F(SelectionRun, HasTheWholeRunsEnergiesBitForBit) {
  struct Case {
    const char* what;
    std::string scene;
    Words options;
  };
  const std::string patterns = "receive_pattern = \"line\"\nreceive_aperture_m = 0.05\n";
  const std::vector<Case> cases{
      {"ideal beams", scene_with("", "", ""), {}},
      {"centroids", scene_with("", "", ""), {"--binning", "centroid"}},
      {"patterns", scene_with("", "", patterns), {}},
      {"cycles", scene_with("", "", "cycles = 4\n"), {}},
      {"rays", scene_with("", "", ""), {"--engine", "ray", "--rays", "4000"}},
      {"relief",
       scene_with("",
                  "lambert_db = -25\n[[materials.relief]]\nkind = \"ripples\"\ntile_m = 5.12\nresolution_m = "
                  "0.08\nwavelength_m = 0.8\nrms_height_m = 0.03",
                  ""),
       {}},
      {"refraction",
       scene_with("[water]\nsurface_height_m = 12\nprofile = \"gradient\"\nsound_speed_m_s = 1490\n"
                  "gradient_per_s = 1\nprofile_bottom_m = 30\n",
                  "", ""),
       {}},
      {"mirrors", scene_with("[sea_surface]\nheight_m = 4\n[paths]\norder = 2\n", "", ""), {}},
  };
  for (const Case& c : cases) {
    SCOPED_TRACE(c.what);
    write(c.scene);
    fs::remove_all(folder / "whole");
    const Outcome outcome = run_echoes(folder / "whole", c.options);
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    for (const char* sensor : {"near", "tilted"})
      expect_part(c.options, sensor, 2, 3, of_camera, pings_and_beams);
    expect_part(c.options, "side", 4, 5, {0, 1}, {"--pings", "4:"}, {"energy", "received"});
    expect_part(c.options, "side", 4, 5, {1}, {"--pings", "4:", "--beams", "1"}, {"energy", "received"});
  }
}

TEST_F(SelectionRun, HasTheWholeRunsEnergiesOverTerrainReadByTiles) {
  mosaic::write_mosaic(folder, true);
  write(fmt::format(
      fmt::runtime(mosaic::scene("", std::string(mosaic::diagonal) + std::string(mosaic::sidescan) +
                                         std::string(mosaic::multibeam))),
      mosaic::terrain("mosaic.vrt", "tiles")));
  const Outcome outcome = run_echoes(folder / "whole", {});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  expect_part({}, "side", 5, 3, {0, 1}, {"--pings", "5:7"});
  expect_part({}, "multi", 1, 4, {2, 3}, {"--pings", "1:", "--beams", "2:3"});
}

TEST_F(SelectionRun, HasTheBoundsOfTheWholeReference) {
  write(scene_with("", "", ""));
  ASSERT_EQ(run_echoes(folder / "whole", {"--reference"}).exit_code, 0);
  expect_part({"--reference"}, "near", 5, 1, {7}, {"--pings", "5", "--beams", "7"},
              {"energy", "energy_bound"});
  expect_part({"--reference"}, "side", 0, 2, {1}, {"--pings", ":1", "--beams", "1"},
              {"energy", "energy_bound"});
}

TEST_F(SelectionRun, SaysWhichPingsAndBeamsItHas) {
  write(scene_with("", "", ""));
  ASSERT_EQ(run(folder / "part", {"--sensor", "far", "--pings", "2:4", "--beams", "19,3:5,0"}).exit_code, 0);
  {
    const NetcdfReader part(folder / "part/echoes.nc");
    EXPECT_THAT(part.values("/", "ping_number"), ElementsAre(2, 3, 4));
    EXPECT_THAT(part.values("/", "beam_number"), ElementsAre(0, 3, 4, 5, 19));
    EXPECT_EQ(part.text("/", "units", "beam_number"), "1");
  }
  const auto stats = nlohmann::json::parse(bytes_of(folder / "part/stats.json"));
  EXPECT_EQ(stats.at("selection"),
            (nlohmann::json{{"sensor", "far"}, {"pings", "2:4"}, {"beams", "19,3:5,0"}}));
  EXPECT_EQ(stats.at("pings"), 3);
  // Five of twenty tubes are traced, and the other tubes of the same tube runs.
  EXPECT_THAT(names_below(folder / "part"),
              ElementsAre(".tubefoot-files", "echoes.nc", "scene.png", "stats.json"));
  EXPECT_THAT(stats.at("warnings")[0].get<std::string>(), HasSubstr("selects some of its beams"));
}

TEST_F(SelectionRun, LooksIntoTheTubesOfItsBeamsOnly) {
  write(scene_with("", "", ""));
  const auto footprints = [&](const Words& words) {
    fs::remove_all(folder / "part");
    EXPECT_EQ(run_echoes(folder / "part", words).exit_code, 0);
    return nlohmann::json::parse(bytes_of(folder / "part/stats.json")).at("footprints").get<int>();
  };
  const int all = footprints({"--sensor", "tilted"}),
            two = footprints({"--sensor", "tilted", "--beams", "0:1"});
  EXPECT_LT(two, all / 5);
  EXPECT_GT(two, 0);
}

TEST_F(SelectionRun, CallsPingsAndFilesByTheScenesNumbers) {
  write("[georeference]\ncrs = \"EPSG:32632\"\norigin_crs = [400000, 5400000]\n" + scene_with("", "", ""));
  ASSERT_EQ(run(folder / "whole", {}).exit_code, 0);
  ASSERT_EQ(run(folder / "part", {"--pings", "3:5"}).exit_code, 0);
  for (const char* name : {"near-0003.png", "near-0003.exr", "tilted-0005.png", "side.xtf", "side.png"})
    EXPECT_TRUE(fs::exists(folder / "part" / name)) << name;
  EXPECT_FALSE(fs::exists(folder / "part/near-0000.png"));
  // The picture of a ping does not depend on the others.
  for (const char* name : {"near-0003.png", "near-0003.exr", "tilted-0005.exr"})
    EXPECT_TRUE(bytes_of(folder / "whole" / name) == bytes_of(folder / "part" / name)) << name;
  const NetcdfReader part(folder / "part/echoes.nc");
  EXPECT_THAT(part.values("/side", "ping_number"), ElementsAre(3, 4, 5));
}

TEST_F(SelectionRun, RefusesWhatThereIsNot) {
  write(scene_with("", "", ""));
  const auto refused = [&](const Words& words, const std::vector<std::string>& said) {
    const Outcome outcome = run(folder / "part", words);
    EXPECT_EQ(outcome.exit_code, 2) << outcome.err;
    for (const std::string& part : said) EXPECT_THAT(outcome.err, HasSubstr(part));
    EXPECT_THAT(names_below(folder.path()), ElementsAre("scene.toml")) << "something is left behind";
  };
  refused({"--sensor", "camera"}, {"no sensor 'camera'", "'near', 'far', 'tilted', 'side'"});
  refused({"--pings", "6"}, {"--pings '6'", "sensor 'near' has pings 0 to 5"});
  refused({"--sensor", "side", "--pings", "9:"}, {"--pings '9:'", "sensor 'side' has pings 0 to 8"});
  refused({"--pings", "3:2"}, {"--pings '3:2'", "has pings 0 to 5"});
  refused({"--pings", ""}, {"--pings ''", "N, A:B"});
  refused({"--pings", "-1"}, {"--pings"});
  refused({"--beams", "4"}, {"--beams '4'", "sensor 'side' has beams 0 to 1"});
  refused({"--sensor", "far", "--beams", "20"}, {"--beams '20'", "sensor 'far' has beams 0 to 19"});
  refused({"--beams", ""}, {"--beams selects no beam"});
  refused({"--beams", "1,,2"}, {"--beams '1,,2'"});
}

TEST_F(SelectionRun, IsGoneOnWithOnlyByTheSameSelection) {
  write(scene_with("", "", ""));
  ASSERT_EQ(run_echoes(folder / "whole", {"--pings", "1:4"}).exit_code, 0);
  Surroundings killed;
  killed.signal = SIGKILL;
  const fs::path partial = folder / "part.partial";
  killed.interrupt_when = [&] {
    try {
      return fs::exists(partial) && summary_of(partial).done > 0;
    } catch (const UnusableStore&) {
      return false;
    }
  };
  const Words command{"run",       (folder / "scene.toml").string(),
                      "-o",        (folder / "part").string(),
                      "--pings",   "1:4",
                      "--threads", "1"};
  if (run_program(command, killed).signal != SIGKILL) GTEST_SKIP() << "the run was over before it was killed";
  const Outcome other = run(folder / "part", {"--pings", "1:3", "--resume"});
  EXPECT_EQ(other.exit_code, 2);
  EXPECT_THAT(other.err, AllOf(HasSubstr("had pings = \"1:4\""), HasSubstr("not \"1:3\"")));
  EXPECT_THAT(run(folder / "part", {"--resume"}).err, HasSubstr("not \"all\""));
  ASSERT_EQ(run_echoes(folder / "part", {"--pings", "1:4", "--resume"}).exit_code, 0);
  EXPECT_TRUE(bytes_of(folder / "whole/echoes.nc") == bytes_of(folder / "part/echoes.nc"));
}

TEST_F(SelectionRun, IsTheSameOnSeveralRanks) {
  write(scene_with("", "", ""));
  ASSERT_EQ(run_echoes(folder / "whole", {"--pings", "1:4", "--sensor", "far"}).exit_code, 0);
  Surroundings ranks;
  ranks.before = mpirun(2);
  const Outcome outcome = run_program({"run", (folder / "scene.toml").string(), "-o",
                                       (folder / "part").string(), "--pings", "1:4", "--sensor", "far"},
                                      ranks);
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_TRUE(bytes_of(folder / "whole/echoes.nc") == bytes_of(folder / "part/echoes.nc"));
}

TEST_F(SelectionRun, IsShownFromItsFirstPingOn) {
  write(scene_with("", "", ""));
  ASSERT_EQ(run(folder / "part", {"--pings", "3:4", "--sensor", "tilted"}).exit_code, 0);
  const auto view = [&](const Words& words) {
    Words all{"view", (folder / "part").string(), "-o", (folder / "page.html").string()};
    all.insert(all.end(), words.begin(), words.end());
    return run_program(all);
  };
  const Outcome first = view({});
  EXPECT_EQ(first.exit_code, 0) << first.err;
  EXPECT_THAT(first.out,
              AllOf(HasSubstr("sensor 'tilted'"), Not(HasSubstr("does not come from the direct echoes"))));
  EXPECT_EQ(view({"--pings", "4"}).exit_code, 0);
  const Outcome absent = view({"--pings", "2:3"});
  EXPECT_EQ(absent.exit_code, 2);
  EXPECT_THAT(absent.err, HasSubstr("contains only pings 3:4 of each sensor"));
  EXPECT_THAT(view({"--sensor", "near"}).err, HasSubstr("does not contain"));
}

}  // namespace
}  // namespace tubefoot
