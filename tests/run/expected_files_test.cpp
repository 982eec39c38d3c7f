// SPDX-License-Identifier: GPL-3.0-or-later
// Tests that `check` and `run` report in advance which files a run cannot write. Range gates are those that
// the file formats permit.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "fixtures/camera_file_reader.hpp"
#include "fixtures/program.hpp"
#include "fixtures/scene_texts.hpp"
#include "run/run_steps.hpp"
#include "run/simulation.hpp"
#include "sensors/kinds/scene_file.hpp"

namespace tubefoot {
namespace {

using testing::HasSubstr;
using testing::Not;

std::string camera_in(double sound_speed_m_s, const std::string& keys) {
  return fmt::format("[water]\nsound_speed_m_s = {}\n", sound_speed_m_s) + lambert_material("bed", -27) +
         flat_terrain(20, 20) + fixed_at(0, -3, 1.2) + "[[sensors]]\nname = \"camera\"\ntilt_deg = 20\n" +
         keys + "\n";
}

class Expected : public testing::Test {
 protected:
  Outcome does(const std::string& command, const std::string& scene) {
    folder.write("scene.toml", scene);
    std::vector<std::string> arguments{command, (folder / "scene.toml").string()};
    if (command == "run") arguments.insert(arguments.end(), {"-o", (folder / "out").string()});
    return run_program(arguments);
  }
  TestFolder folder;
};

TEST_F(Expected, AnArisHasAWindowOfItsOwnInAnyWater) {
  for (const char* preset : {"aris-1800", "aris-3000"})
    for (const double speed : {1421.3, 1462.43, 1500.0, 1537.9}) {
      const std::string scene = camera_in(speed, fmt::format("preset = \"{}\"", preset));
      const Outcome checked = does("check", scene), ran = does("run", scene);
      EXPECT_EQ(checked.exit_code, 0) << checked.err;
      EXPECT_EQ(ran.exit_code, 0) << ran.err;
      EXPECT_THAT(checked.err, Not(HasSubstr("warning"))) << preset << " " << speed;
      EXPECT_THAT(ran.err, Not(HasSubstr("warning")));
      const camera_file::Reader file(folder / "out/camera.aris");
      const double period = file.number(0, "SamplePeriod");
      EXPECT_EQ(period, std::round((preset == std::string("aris-1800") ? 4.992 : 2.688) / 512 * 2e6 / speed));
      EXPECT_NEAR(file.number(0, "WindowLength"), period * 512e-6 * speed / 2, 1e-5);
      EXPECT_THAT(checked.out,
                  HasSubstr(fmt::format("from {:g} to {:g} m", file.number(0, "WindowStart"),
                                        double(file.number(0, "SampleStartDelay")) * 1e-6 * speed / 2 +
                                            period * 512e-6 * speed / 2)
                                .substr(0, 10)));
      std::filesystem::remove_all(folder / "out");
    }
}

TEST_F(Expected, AWindowRequestedOfAnArisIsMovedToTheNearestAndToldByCheck) {
  const std::string scene =
      camera_in(1480, "preset = \"aris-1800\"\nwindow_start_m = 1\nwindow_length_m = 5");
  const Outcome checked = does("check", scene);
  EXPECT_EQ(checked.exit_code, 0);
  // 13 us: 512 x 13e-6 x 740 m; 1 m is 1351.35 us away.
  EXPECT_THAT(checked.err, HasSubstr("from 0.9997 to 5.9252 m (1351 us, then 512 samples of 13 us)"));
  EXPECT_EQ(does("run", scene).exit_code, 0);
  EXPECT_TRUE(std::filesystem::exists(folder / "out/camera.aris"));
}

TEST_F(Expected, WindowsThatNoFormatHoldsAreReportedByCheckAndOnceByRun) {
  const std::string scene = camera_in(1480, "kind = \"didson\"\nwindow_start_m = 2.8");
  const Outcome checked = does("check", scene), ran = does("run", scene);
  const std::string what = "no DIDSON or ARIS file is written for 'camera'";
  EXPECT_EQ(checked.exit_code, 0);
  EXPECT_THAT(checked.err, HasSubstr(what));
  EXPECT_THAT(checked.err, HasSubstr("choose a window_start_m of 2.94"));
  EXPECT_THAT(ran.err, HasSubstr(what));
  EXPECT_EQ(ran.err.find(what), ran.err.rfind(what)) << "once";
  EXPECT_LT(ran.err.find(what), ran.err.find("pings 1/1")) << "before the run";
  EXPECT_THAT(bytes_of(folder / "out/stats.json"), HasSubstr(what));
}

TEST_F(Expected, FilesThatNeedAPlaceOnEarthAreReportedByCheck) {
  EXPECT_THAT(does("check", camera_in(1500, "preset = \"reson-8101\"")).err, HasSubstr("add [georeference]"));
  EXPECT_THAT(does("check", camera_in(1500, "kind = \"sidescan\"")).err, HasSubstr("add [georeference]"));
}

TEST_F(Expected, FilesThatAreOmittedAreNotWrittenAndNotMissed) {
  const std::string scene = camera_in(1500,
                                      "kind = \"didson\"\npings = 2\n[[sensors]]\nname = \"fan\"\n"
                                      "kind = \"multibeam\"\nbeams = 10\nsamples = 100\npings = 2\n");
  folder.write("scene.toml", scene);
  const auto runs = [&](const std::string& without, const std::vector<std::string>& more = {}) {
    std::filesystem::remove_all(folder / "out");
    std::vector<std::string> words{
        "run", (folder / "scene.toml").string(), "-o", (folder / "out").string(), "--without", without};
    words.insert(words.end(), more.begin(), more.end());
    return run_program(words);
  };
  const Outcome plain = does("run", scene);
  ASSERT_EQ(plain.exit_code, 0) << plain.err;
  EXPECT_THAT(plain.err, HasSubstr("fan-sonar.nc, fan.gsf and fan.xtf need a position"));
  std::set<std::string> names = names_below(folder / "out");
  EXPECT_THAT(bytes_of(folder / "out/stats.json"), Not(HasSubstr("omitted_files")));

  const Outcome some = runs("scene.png,exr,fan-sonar.nc,camera-sequence.png,gsf");
  ASSERT_EQ(some.exit_code, 0) << some.err;
  EXPECT_THAT(some.err, HasSubstr("'fan': fan.xtf needs a position on Earth and is omitted"));
  EXPECT_THAT(some.out, HasSubstr("omitted, as --without says: scene.png, camera.exr, fan-sonar.nc, "
                                  "camera-sequence.png, fan.gsf\n"));
  for (const char* name : {"scene.png", "camera-0000.exr", "camera-0001.exr", "camera-sequence.png"})
    EXPECT_EQ(names.erase(name), 1u) << name;
  EXPECT_EQ(names_below(folder / "out"), names);
  EXPECT_THAT(bytes_of(folder / "out/stats.json"), HasSubstr("\"omitted_files\""));

  const Outcome rest = runs("echoes.nc,ddf,aris,soundings.csv,soundings.gpkg,sonar.nc,xtf,gsf,fan-depth.tif",
                            {"--pictures", "none"});
  ASSERT_EQ(rest.exit_code, 0) << rest.err;
  EXPECT_THAT(rest.err, Not(HasSubstr("fan")));  // of an omitted file, no reason is needed
  EXPECT_EQ(names_below(folder / "out"), (std::set<std::string>{".tubefoot-files", "stats.json"}));

  for (const auto& [name, why] : {std::pair("sonr.nc", "did you mean 'sonar.nc'?"),
                                  {"camera-sonar.nc", "no such product"},
                                  {"waterfall.png", "Products: echoes.nc, scene.png, sequence.png"},
                                  {"", "--without ''"},
                                  {"exr,,png", "--without ''"}}) {
    const Outcome outcome = runs(name);
    EXPECT_EQ(outcome.exit_code, 2) << name;
    EXPECT_THAT(outcome.err, HasSubstr(why)) << name;
    EXPECT_FALSE(std::filesystem::exists(folder / "out")) << name;
  }
  const Outcome nowhere = runs("echoes.nc", {"--reference"});
  EXPECT_EQ(nowhere.exit_code, 2);
  EXPECT_THAT(nowhere.err, HasSubstr("--reference writes its results to echoes.nc"));
}

// The scene of the drifting camera, with one frame.
TEST_F(Expected, TheDriftingCameraWritesADidsonFile) {
  SceneDescription scene = read_scene_file(TUBEFOOT_SOURCE_DIR "/scenes/textures/track.toml");
  scene.sensors.at(0).pings = 1;
  const auto survey = open_survey(scene);
  const RunRequest request = request_of(scene.run);
  EXPECT_TRUE(files_left_out(*survey).empty());
  SimulationStats stats;
  const std::vector<Recording> recordings = simulate(*survey, request, stats);
  std::vector<std::string> warnings;
  write_result_files(folder.path(), *survey, request, recordings, warnings);
  EXPECT_TRUE(warnings.empty());
  const camera_file::Reader file(folder / "camera.ddf");
  EXPECT_EQ(file.frames, 1u);
  EXPECT_EQ(file.number(0, "WindowStart"), 7);  // 2.94 m
}

// Labels are most of the output of such a run: one channel per object and per material.
TEST(ExpectedWriting, CountsLabelsPicturesAndSoundings) {
  const auto survey = open_survey(read_scene_text(
      lambert_material("bed", -27) + flat_terrain(20, 20) + fixed_at(0, -3, 1.2) +
          "[[sensors]]\nname = \"camera\"\nkind = \"didson\"\ntilt_deg = 20\npings = 2\n" +
          "[[sensors]]\nname = \"swath\"\nkind = \"multibeam\"\nbeams = 100\nsamples = 500\npings = 2\n",
      "scene.toml"));
  RunRequest request = request_of(survey->scene.description.run);
  PictureSettings without_pictures;
  without_pictures.which = PictureSettings::Which::none;
  const WritingCost plain = expected_writing(*survey, request, {without_pictures}),
                    pictures = expected_writing(*survey, request, {});
  EXPECT_GT(pictures.seconds_on(1), plain.seconds_on(1));
  EXPECT_GT(pictures.bytes, plain.bytes);
  request.labels = true;
  const WritingCost with_labels = expected_writing(*survey, request, {without_pictures});
  const double cells = 2.0 * 100 * 500, shares = 2, seconds_per_cell = 1e-7;  // one object, one material
  EXPECT_GT(with_labels.seconds_on(1), plain.seconds_on(1) + seconds_per_cell * cells);
  EXPECT_GT(with_labels.bytes - plain.bytes, 8 * shares * cells);
  request.labels = false;
  request.selection.sensor = "swath";
  const double seconds_per_sounding = 1e-5;
  EXPECT_GT(expected_writing(*survey, request, {without_pictures}).seconds_on(8),
            2 * 100 * seconds_per_sounding);
  RunOptions options;
  options.without =
      "echoes.nc,scene.png,soundings.csv,soundings.gpkg,sonar.nc,xtf,gsf,depth.tif,depth.png,"
      "depth-ideal.png";
  const WritingCost nothing =
      expected_writing(*survey, request, {{}, true, omitted_files(survey->scene.description, options)});
  EXPECT_EQ(nothing.seconds_on(8), 0);
  EXPECT_EQ(nothing.bytes, 0);
}

}  // namespace
}  // namespace tubefoot
