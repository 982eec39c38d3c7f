// SPDX-License-Identifier: GPL-3.0-or-later
// Tests error messages of scene files: each error has its line and column, the expected value and, for
// misspelt names, the nearest valid name.

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <sstream>
#include <vector>

#include "files/limits.hpp"
#include "files/words.hpp"
#include "fixtures/world/read_scenes.hpp"
#include "scene/file/scene_file_keys.hpp"
#include "sensors/kinds/scene_file.hpp"

namespace tubefoot {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;

/// The smallest scene with `from` replaced by `to` must fail at `place` ("line:column", empty for the whole
/// file) with a message that contains `says`.
struct Mistake {
  const char* from;
  const char* to;
  const char* place;
  const char* says;
};

void expect_mistakes(const std::vector<Mistake>& mistakes) {
  const TestFolder folder;
  ASSERT_EQ(scene_error(folder, smallest_scene), "");
  for (const Mistake& m : mistakes) {
    const std::string error = scene_error(folder, replaced(smallest_scene, m.from, m.to));
    const std::string place = *m.place == '\0' ? "scene.toml: " : std::string("scene.toml:") + m.place + ": ";
    EXPECT_THAT(error, StartsWith(place)) << "for: " << m.to;
    EXPECT_THAT(error, HasSubstr(m.says)) << "for: " << m.to;
  }
}

// The lines that most tests change.
constexpr const char* material_name = "name = \"sand\"";                            // line 2
constexpr const char* terrain = "[[terrain]]";                                      // line 3
constexpr const char* flat = "kind = \"flat\"";                                     // line 4
constexpr const char* length = "length_m = 30";                                     // line 6
constexpr const char* fixed = "kind = \"fixed\"";                                   // line 8
constexpr const char* didson = "kind = \"didson\"\n";                               // line 11, the last one
constexpr const char* sensor_name = "name = \"camera\"";                            // line 10
constexpr const char* flat_lines = "kind = \"flat\"\nwidth_m = 20\nlength_m = 30";  // lines 4 to 6

TEST(SceneFileErrors, MisspeltKeysAndSectionsNameTheNearest) {
  expect_mistakes({
      {length, "lenght_m = 30", "6:1", "unknown key 'lenght_m' in [[terrain]]: did you mean 'length_m'?"},
      {flat, "knid = \"flat\"", "4:1", "unknown key 'knid' in [[terrain]]: did you mean 'kind'?"},
      {didson, "kind = \"didson\"\n  bems = 3", "12:3",
       "unknown key 'bems' in [[sensors]]: did you mean 'beams'?"},
      {didson, "kind = \"didson\"\nzzzzzz = 3", "12:1", "expected 'kind', 'name', 'preset', 'trajectory'"},
      {didson, "kind = \"didson\"\n[watr]", "12:2", "unknown section or key 'watr': did you mean 'water'?"},
      {didson, "kind = \"didson\"\n[[object]]", "12:3",
       "unknown section or key 'object': did you mean 'objects'?"},
      {"[[materials]]", "titel = \"x\"\n[[materials]]", "1:1", "did you mean 'title'?"},
      {"[[materials]]", "[[qqqqqqqqq]]\n[[materials]]", "1:3", "expected 'georeference', 'materials'"},
      {didson, "kind = \"didson\"\n[water.depth_m]\n", "12:1", "'depth_m' must be a number in metres"},
  });
}

TEST(SceneFileErrors, WrongUnitsNameTheRightOne) {
  expect_mistakes({
      {fixed, "kind = \"fixed\"\nheading_rad = 1", "9:1", "give it in degrees, as 'heading_deg'"},
      {fixed, "kind = \"fixed\"\nheading = 1", "9:1", "give it in degrees, as 'heading_deg'"},
      {didson, "kind = \"didson\"\n[water]\ndepth_km = 1", "13:1", "give it in metres, as 'depth_m'"},
      {didson, "kind = \"didson\"\n[water]\nsound_speed_km_h = 1", "13:1",
       "give it in m/s, as 'sound_speed_m_s'"},
      {didson, "kind = \"didson\"\n[water]\nabsorption_db_per_m = 1", "13:1",
       "in dB/km, as 'absorption_db_per_km'"},
      {didson, "kind = \"didson\"\nfrequency_hz = 1", "12:1", "give it in kHz, as 'frequency_khz'"},
      {didson, "kind = \"didson\"\nping_interval_ms = 1", "12:1", "give it in seconds, as 'ping_interval_s'"},
      {didson, "kind = \"didson\"\n[water]\ndepth_m = \"5 m\"", "13:11",
       "'depth_m' must be a number in metres (0 to 10000), not a text: write only the number, in metres"},
  });
}

constexpr const char* survey_keys = "kind = \"survey\"\nlength_m = 9\nwidth_m = 9\nspacing_m = 3\n";

TEST(SceneFileErrors, SurveysSayWhereAndHowHigh) {
  const auto with = [](const std::string& more) { return survey_keys + more; };
  for (const auto& [keys, place, says] :
       {std::tuple(with(""), "7:1", "the survey has no height: give one of 'up_m'"),
        std::tuple(with("up_m = 1\ndepth_m = 1"), "7:1", "more than one height"),
        std::tuple(with("up_m = 1\naltitude_step_m = 1"), "13:19", "'altitude_step_m' needs 'altitude_m'"),
        std::tuple(with("up_m = 1\ncentre_m = [1, 2]\ncentre_crs = [1, 2]"), "14:14", "more than one centre"),
        std::tuple(with("altitude_m = 0"), "12:14", "> 0"),
        std::tuple(std::string("kind = \"waypoints\"\nfile = \"scene.toml\"\nturn_s = 3"), "10:10",
                   "only to files without times")})
    expect_mistakes({{fixed, keys.c_str(), place, says}});
}

TEST(SceneFileErrors, LookAtIsForSensorsThatLookAheadAndNotTurnedOtherwise) {
  expect_mistakes({
      {didson, "kind = \"sidescan\"\nlook_at_m = [0, 0, 0]", "12:13",
       "'look_at_m' applies only to forward-looking sonars, not to kind = \"sidescan\""},
      {didson, "kind = \"didson\"\nlook_at_m = [0, 0, 0]\ntilt_deg = 3", "13:12", "remove 'tilt_deg'"},
  });
}

TEST(SceneFileErrors, WrongTypesSayWhatIsWanted) {
  expect_mistakes({
      {material_name, "name = 3", "2:8", "'name' must be a text, not an integer"},
      {didson, "kind = \"didson\"\nbeams = 96.0", "12:9",
       "'beams' must be an integer (1 to 4096), not a number with a fraction"},
      {didson, "kind = \"didson\"\nbeams = true", "12:9", "not true or false"},
      {didson, "kind = \"didson\"\ntilt_deg = 9007199254740993", "12:12",
       "not 9007199254740993: write it with a decimal point"},
      {didson, "kind = \"didson\"\n[georeference]\norigin_height_m = -9223372036854775808", "13:19",
       "write it with a decimal point"},
      {didson, "kind = \"didson\"\nbeams = [1]", "12:9", "not an array"},
      {didson, "kind = \"didson\"\nbeams = {}", "12:9", "not a table"},
      {didson, "kind = \"didson\"\nbeams = 2020-01-01", "12:9", "not a date or time"},
      {fixed, "kind = \"fixed\"\nposition_m = 3", "9:14",
       "'position_m' must be an array of 3 numbers in metres"},
      {fixed, "kind = \"fixed\"\nposition_m = [1, 2]", "9:14",
       "3 numbers in metres (-10000000 to 10000000), not of 2"},
      {fixed, "kind = \"fixed\"\nposition_m = [1,\n 2, \"3\"]", "10:5",
       "'position_m' must be a number in metres"},
      {didson, "kind = \"didson\"\n[[objects]]\nname=\"o\"\nshape=\"mesh\"\nfile=\"scene.toml\"\nup = \"w\"",
       "16:6", "'up' must be \"x\", \"y\" or \"z\", not \"w\""},
      {didson, "kind = \"didson\"\n[[water]]", "12:1", "'water' must be one table: write [water] once"},
      {"[[materials]]", "water = 5\n[[materials]]", "1:9", "'water' must be one table"},
      {"[[materials]]", "objects = [{name = \"o\", shape = \"box\"}, 7]\n[[materials]]", "1:41",
       "'objects' must be tables: write [[objects]]"},
      {material_name, "name = \"\"", "2:8", "'name' must not be empty"},
      {material_name, "name = \"a\\u0007b\"", "2:8", "without control characters"},
      {material_name, "name = \"a\\u007fb\"", "2:8", "without control characters"},
  });
}

TEST(SceneFileErrors, TextsHaveAtMostTheLargestLength) {
  const TestFolder folder;
  const auto error_of = [&](std::size_t length) {
    return scene_error(folder,
                       replaced(smallest_scene, material_name, "name = \"" + std::string(length, 'n') + '"'));
  };
  EXPECT_EQ(error_of(limits::name_bytes), "");
  EXPECT_EQ(error_of(limits::name_bytes + 1),
            fmt::format("scene.toml:2:8: 'name' has {} bytes, expected at most {}", limits::name_bytes + 1,
                        limits::name_bytes));
}

TEST(SceneFileErrors, NotFiniteNumbersAreRefused) {
  expect_mistakes({
      {length, "length_m = nan", "6:12", "not nan: it must be finite"},
      {length, "length_m = inf", "6:12", "not inf: it must be finite"},
      {length, "length_m = -inf", "6:12", "not -inf: it must be finite"},
      {fixed, "kind = \"fixed\"\nposition_m = [0, nan, 0]", "9:18", "it must be finite"},
  });
}

TEST(SceneFileErrors, MissingKeysAreNamed) {
  expect_mistakes({
      {length, "", "3:1", "[[terrain]] with kind = \"flat\" needs the key 'length_m': a number in metres"},
      {flat, "", "3:1", "[[terrain]] needs the key 'kind': \"flat\", \"fractal\" or \"raster\""},
      {sensor_name, "", "9:1", "[[sensors]] needs the key 'name': a text"},
      {material_name, "", "1:1", "[[materials]] needs the key 'name'"},
      {flat_lines, "kind = \"raster\"", "3:1", "needs the key 'file': the name of a file"},
      {fixed, "kind = \"line\"\nstart_m = [0, 0, 0]", "7:1", "needs the key 'end_m': an array of 3 numbers"},
  });
}

TEST(SceneFileErrors, ChoicesNameTheNearest) {
  expect_mistakes({
      {flat, "kind = \"flatt\"", "4:8", "not \"flatt\": did you mean \"flat\"?"},
      {flat, "kind = \"hexagon\"", "4:8",
       "'kind' must be \"flat\", \"fractal\" or \"raster\", not \"hexagon\""},
      {flat, "kind = 1", "4:8", "'kind' must be \"flat\", \"fractal\" or \"raster\", not an integer"},
      {didson, "kind = \"didsno\"", "11:8", "did you mean \"didson\"?"},
      {didson, "kind = \"didson\"\n[run]\narithmetic = \"filterd\"", "13:14", "did you mean \"filtered\"?"},
      {didson, "kind = \"didson\"\n[run]\nengine = \"tub\"", "13:10", "did you mean \"tube\"?"},
      {didson, "kind = \"didson\"\n[run]\nsampling = \"colum\"", "13:12", "did you mean \"column\"?"},
  });
}

TEST(SceneFileErrors, KeysOfAnotherKindSaySo) {
  expect_mistakes({
      {length, "length_m = 30\nhurst = 0.5", "7:1",
       "'hurst' applies to kind = \"fractal\", not to kind = \"flat\""},
      {didson, "kind = \"didson\"\nrange_max_m = 5", "12:1",
       "'range_max_m' applies to kind = \"array\", kind = \"echosounder\", kind = \"imaging\", kind = "},
      {didson, "kind = \"didson\"\n[[objects]]\nname = \"o\"\nshape = \"box\"\nradius_m = 1", "15:1",
       "'radius_m' applies to shape = \"sphere\", shape = \"cylinder\", shape = \"cone\", not to shape = "
       "\"box\""},
      {didson, "kind = \"didson\"\n[[objects]]\nname = \"o\"\nshape = \"box\"\nchord_error_m = 1", "15:1",
       "not to shape = \"box\""},
      {fixed, "kind = \"fixed\"\nspeed_m_s = 1", "9:1", "'speed_m_s' applies to kind = \"line\""},
  });
}

TEST(SceneFileErrors, SectorsOfNoWidthOrTooWideSaySo) {
  expect_mistakes({
      {didson, "kind = \"didson\"\nhorizontal_deg = 0", "12:18",
       "'horizontal_deg' must be > 0, < 180 degrees, not 0: a sector without width receives nothing"},
      {didson, "kind = \"didson\"\nhorizontal_deg = 180", "12:18",
       "not 180: a sector of this width cannot be projected"},
      {didson, "kind = \"didson\"\nvertical_deg = -1", "12:16",
       "not -1: a sector without width receives nothing"},
      {didson, "kind = \"didson\"\nvertical_deg = 170.5", "12:16", "distribute it over several sensors"},
      {didson, "kind = \"sidescan\"\nalong_track_deg = 0", "12:19",
       "a sector without width receives nothing"},
      {didson, "kind = \"sidescan\"\nalong_track_deg = 91", "12:19", "a sector of this width"},
      {didson, "kind = \"sidescan\"\ndepression_min_deg = 40\ndepression_max_deg = 40", "13:22",
       "'depression_min_deg' (40) must be less than 'depression_max_deg' (40): a sector without width "
       "receives nothing"},
      {didson, "kind = \"sidescan\"\ndepression_min_deg = 86", "12:22",
       "must be less than 'depression_max_deg' (85)"},
      {didson, "kind = \"sidescan\"\ndepression_max_deg = 91", "12:22", "90 is straight down"},
  });
}

TEST(SceneFileErrors, ACamerasBeamsAndCyclesMustAgree) {
  expect_mistakes({
      {didson, "kind = \"didson\"\nbeam_centres = \"lens\"\nbeams = 64", "13:9",
       "available for 48 or 96 beams, not for 64"},
      {didson, "kind = \"didson\"\nbeam_centres = \"lens\"\nhorizontal_deg = 29", "13:18",
       "remove 'horizontal_deg'"},
      {didson, "kind = \"didson\"\ncycles = 7", "12:10",
       "the number of beams (96) must be a multiple of 'cycles' (7)"},
      {didson, "kind = \"didson\"\ncycle_interval_s = 0.1", "12:20",
       "'cycle_interval_s' needs 'cycles' of 2 or more"},
      {didson, "kind = \"didson\"\nfiring_order = [0]", "12:16",
       "'firing_order' needs 'cycles' of 2 or more"},
      {didson, "kind = \"didson\"\ncycles = 2\nfiring_order = [0, 0]", "13:16",
       "each cycle from 0 to 1 once"},
      {didson, "kind = \"didson\"\ncycles = 2\nfiring_order = [0]", "13:16", "each cycle from 0 to 1 once"},
      {didson, "kind = \"didson\"\ncycles = 2\nfiring_order = []", "13:16",
       "'firing_order' must be an array of integers"},
      {didson, "kind = \"didson\"\ncycles = 2\nfiring_order = [1, 0.5]", "13:20", "integer"},
      {didson, "kind = \"didson\"\ncycles = 2\nfiring_order = [1, -1]", "13:20", "must be 0 to 4095, not -1"},
      {didson, "kind = \"didson\"\nreceive_margin_deg = 1", "12:22", "needs a 'receive_pattern'"},
      {didson, "kind = \"didson\"\ntransmit_steering = \"beams\"", "12:21", "needs a 'transmit_pattern'"},
      {didson,
       "kind = \"didson\"\ntransmit_pattern = \"gaussian\"\ntransmit_beam_width_deg = "
       "9\ntransmit_pattern_angle = \"elevation\"\ntransmit_steering = \"beams\"",
       "15:21", "needs transmit_steering = \"fan\""},
  });
}

TEST(SceneFileErrors, KeysOfOneTableMustAgree) {
  expect_mistakes({
      {didson, "kind = \"imaging\"\nrange_min_m = 50", "12:15",
       "'range_min_m' (50) must be less than 'range_max_m'"},
      {didson, "kind = \"echosounder\"\nrange_max_m = 0.5", "12:15",
       "'range_min_m' (0.5) must be less than 'range_max_m' (0.5)"},
      {didson, "kind = \"interferometric\"\ndepression_min_deg = 86", "12:22",
       "'depression_min_deg' (86) must be less than 'depression_max_deg'"},
      {didson, "kind = \"interferometric\"\nbaseline_m = 0.6", "12:14",
       "'baseline_m' (0.6) must be at most 'range_min_m' (0.5)"},
      {didson, "kind = \"sidescan\"\nrange_min_m = 50", "12:15",
       "'range_min_m' (50) must be less than 'range_max_m'"},
      {didson, "kind = \"sidescan\"\nrange_max_m = 0.5", "12:15", "must be less than 'range_max_m' (0.5)"},
      {fixed, "kind = \"line\"\nstart_m = [1, 2, 3]\nend_m = [1, 2, 3]", "10:9", "'end_m' equals 'start_m'"},
      {fixed, "kind = \"line\"\nstart_m = [1, 2, 3]\nend_m = [1, 2, 4]", "10:9", "directly above or below"},
      {didson, "kind = \"didson\"\n[georeference]", "12:1",
       "needs 'origin_lat_lon_deg', or 'crs' with 'origin_crs'"},
      {didson, "kind = \"didson\"\n[georeference]\norigin_lat_lon_deg = [1, 2]\ncrs = \"EPSG:32602\"", "14:7",
       "give only one of the two"},
      {didson, "kind = \"didson\"\n[georeference]\norigin_lat_lon_deg = [1, 2]\norigin_crs = [3, 4]", "14:14",
       "give only one of the two"},
      {didson, "kind = \"didson\"\n[georeference]\ncrs = \"EPSG:32602\"", "13:7", "add 'origin_crs'"},
      {didson, "kind = \"didson\"\n[georeference]\norigin_crs = [1, 2]", "13:14", "add 'crs'"},
      {didson, "kind = \"didson\"\n[georeference]\norigin_lat_lon_deg = [91, 2]", "13:23",
       "must be -90 to 90 degrees"},
      {didson, "kind = \"didson\"\n[georeference]\norigin_lat_lon_deg = [90, 181]", "13:27",
       "must be -180 to 180 degrees"},
      {didson, "kind = \"didson\"\n[water]\nsalinity_psu = 5", "13:16", "give 'sound_speed_m_s' for fresh"},
      {didson, "kind = \"didson\"\n[water]\ndepth_m = 9000", "13:11",
       "give 'sound_speed_m_s' for deeper water"},
      {flat_lines, "kind = \"fractal\"\nwidth_m = 9\nlength_m = 9\ncell_m = 0.1\nripple_height_m = 0.02",
       "7:10", "cells of 0.1 metres cannot resolve ripples of 0.2 metres"},
      {didson, "kind = \"didson\"\n[[objects]]\nname = \"o\"\nshape = \"box\"\nposition_lat_lon_deg = [1, 2]",
       "15:24", "add [georeference]"},
      {flat_lines, "kind = \"raster\"\nfile = \"scene.toml\"\nwindow = [0, 0, 1, 5]", "6:17",
       "must be 2 to 1000000"},
  });
}

TEST(SceneFileErrors, RaysAreCountedOneWay) {
  expect_mistakes({
      {didson, "kind = \"didson\"\n[run]\nrays_per_beam = 0", "13:17", "must be 1 to 10000000000, not 0"},
      {didson, "kind = \"didson\"\n[run]\nrays_per_beam = 11.5", "13:17", "integer"},
      {didson, "kind = \"didson\"\n[run]\nrays_per_beam = 20000000000", "13:17", "10000000000"},
      {didson, "kind = \"didson\"\n[run]\nrays_per_ping = 9\nrays_per_beam = 3", "14:17",
       "'rays_per_ping' and 'rays_per_beam' both set the number of rays"},
  });
}

TEST(SceneFileErrors, LambertMaterialsConserveEnergy) {
  expect_mistakes({
      {material_name, "name = \"sand\"\nlambert_db = -4.97", "3:14",
       "'lambert_db' must be -120 to -4.9715 dB, not -4.97: a surface cannot scatter more than it receives"},
      {material_name, "name = \"sand\"\nlambert_db = -10\nspecular_loss_db = 1.6", "4:20",
       "'sand' would return more energy than it receives"},
  });
}

TEST(SceneFileErrors, NamesMustDifferAndReferToSomething) {
  expect_mistakes({
      {terrain, "[[materials]]\nname = \"sand\"\n[[terrain]]\nmaterial = \"sand\"", "4:8",
       "the name \"sand\" is already used at scene.toml:2:8: every entry of [[materials]] needs its own "
       "'name'"},
      {didson, "kind = \"didson\"\n[[sensors]]\nkind = \"didson\"\nname = \"camera\"", "14:8",
       "already used at scene.toml:10:8"},
      {terrain, "[[terrain]]\nkind = \"flat\"\nwidth_m = 1\nlength_m = 1\n[[terrain]]", "7:1",
       "the name \"terrain\" is already used at scene.toml:3:1"},
      {"[trajectory]", "[trajectory]\nkind = \"fixed\"\n[[trajectories]]", "9:1",
       "the name \"trajectory\" is already used at"},
      {didson,
       "kind = \"didson\"\n[[objects]]\nname = \"o\"\nshape = \"box\"\n[[objects]]\nname = \"o\"\nshape = "
       "\"box\"",
       "16:8", "already used at scene.toml:13:8"},
      {flat, "kind = \"flat\"\nmaterial = \"sund\"", "5:12", "is named \"sund\": did you mean \"sand\"?"},
      {flat, "kind = \"flat\"\nmaterial = \"concrete\"", "5:12",
       "no entry of [[materials]] is named \"concrete\": expected \"sand\""},
      {terrain, "[[materials]]\nname = \"mud\"\n[[terrain]]", "5:1",
       "needs the key 'material': \"mud\" or \"sand\""},
      {didson, "kind = \"didson\"\ntrajectory = \"trajektory\"", "12:14", "did you mean \"trajectory\"?"},
      {"[[materials]]\nname = \"sand\"", "", "2:1",
       "'material' has nothing to refer to, because the scene has no [[materials]]"},
      {sensor_name, "name = \"cam/era\"", "10:8",
       "expected at most 64 of the characters A-Z a-z 0-9 _ -, not \"cam/era\""},
      {sensor_name, "name = \"caméra\"", "10:8", "becomes part of file names"},
      {sensor_name, "name = \"..\"", "10:8", "becomes part of file names"},
  });
  const TestFolder folder;
  EXPECT_THAT(scene_error(folder, replaced(smallest_scene, "\"camera\"", '"' + std::string(65, 'c') + '"')),
              StartsWith("scene.toml:10:8: "));
}

TEST(SceneFileErrors, AScenesPartsMustBeThere) {
  const TestFolder folder;
  for (const char* nothing : {"", "\n\n", "# nothing\n", "title = \"empty\"\n", "objects = []\n"}) {
    EXPECT_THAT(scene_error(folder, nothing),
                StartsWith("scene.toml: the scene has no terrain and no object: add"));
  }
  const std::string box = "[[materials]]\nname = \"m\"\n[[objects]]\nname = \"o\"\nshape = \"box\"\n";
  EXPECT_THAT(scene_error(folder, box), StartsWith("scene.toml: the scene has no sensor: add [[sensors]]"));
  const std::string sensor = "[[sensors]]\nname = \"s\"\nkind = \"didson\"\n";
  EXPECT_THAT(scene_error(folder, box + sensor), StartsWith("scene.toml: the scene has no trajectory"));
  const std::string trajectory = "[trajectory]\nkind = \"fixed\"\n";
  EXPECT_EQ(scene_error(folder, box + sensor + trajectory), "");
  EXPECT_THAT(scene_error(folder, box + "on_terrain_m = 0\n" + sensor + trajectory),
              StartsWith("scene.toml:6:16: 'on_terrain_m' needs a terrain: add [[terrain]]"));
}

TEST(SceneFileErrors, SyntaxErrorsArePlaced) {
  expect_mistakes({
      {length, "length_m = ", "6:12", "not valid TOML"},
      {length, "length_m 30", "6:10", "not valid TOML"},
      {length, "length_m = 30\nlength_m = 30", "7:12", "cannot redefine"},
      {length, "length_m = 9 9", "6:14", "not valid TOML"},
      {"name = \"sand\"", "name = \"sand", "2:13", "not valid TOML"},
      {"name = \"sand\"", "name = \"\xff\"", "2:8", "not valid TOML"},
      {didson, "kind = \"didson\"\n[trajectory]", "12:1", "cannot redefine"},
  });
}

TEST(SceneFileErrors, NestingDoesNotOverflowTheStack) {
  const TestFolder folder;
  const auto repeated = [](const std::string& text, int times) {
    std::string all;
    for (int i = 0; i < times; ++i) all += text;
    return all;
  };
  EXPECT_THAT(scene_error(folder, repeated("a.", 100000) + "a = 1"),
              StartsWith("scene.toml:1:130: the line has more than 64 dots"));
  EXPECT_THAT(scene_error(folder, "a = " + repeated("[", 100000)), StartsWith("scene.toml:1:"));
  EXPECT_THAT(scene_error(folder, "a = " + repeated("[\n{" + repeated("a.", 63) + "a=", 128)),
              HasSubstr("not valid TOML"));
  EXPECT_THAT(scene_error(folder, "[" + repeated("a.", 64) + "a]\n" + repeated("a.", 64) + "a=1"),
              HasSubstr("unknown section or key 'a'"));
  // Dots in comments and numbers are harmless.
  EXPECT_EQ(scene_error(folder, "# " + repeated(".", 300) + "\n" + std::string(smallest_scene)), "");
}

TEST(SceneFileErrors, TheSceneFileItselfMustBeReadable) {
  const TestFolder folder;
  const auto error_of = [](const std::filesystem::path& file) -> std::string {
    try {
      read_scene_file(file);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(error_of("no/such/scene.toml"), "no/such/scene.toml: there is no such scene file");
  EXPECT_THAT(error_of(folder.path()), HasSubstr(": is a folder, expected a scene file"));
  EXPECT_EQ(error_of(""), ": there is no such scene file");
  EXPECT_THAT(error_of(std::string(5000, 'x')), HasSubstr(": cannot be accessed: "));
  EXPECT_THAT(error_of(folder.write("large.toml", std::string((16 << 20) + 1, '#'))),
              HasSubstr(": is larger than "));
}

TEST(SceneFileErrors, NamedFilesMustExistAndBeReadable) {
  const TestFolder folder;
  std::filesystem::create_directory(folder.path() / "sub");
  ASSERT_EQ(mkfifo((folder.path() / "pipe").c_str(), 0600), 0);
  const auto error_of = [&folder](const std::string& name) {
    return scene_error(folder,
                       replaced(smallest_scene, flat_lines, "kind = \"raster\"\nfile = \"" + name + "\""));
  };
  EXPECT_EQ(
      error_of("grid.tif"),
      "scene.toml:5:8: 'file': there is no file 'grid.tif'; names are relative to the scene file's folder");
  EXPECT_THAT(error_of("scene.toml/grid.tif"), StartsWith("scene.toml:5:8: 'file': "));
  EXPECT_EQ(error_of("sub"), "scene.toml:5:8: 'file': 'sub' is a folder, expected a regular file");
  EXPECT_EQ(error_of("pipe"), "scene.toml:5:8: 'file': 'pipe' is a special file, expected a regular file");
  EXPECT_THAT(error_of(std::string(3000, 'x')), StartsWith("scene.toml:5:8: 'file': cannot access 'xxx"));
  EXPECT_EQ(error_of("/dev/zero"),
            "scene.toml:5:8: 'file': '/dev/zero' is a special file, expected a regular file");
  EXPECT_THAT(error_of("a\\u0000b"), HasSubstr("without control characters"));
  EXPECT_EQ(error_of("sub/../scene.toml"), "");
}

TEST(SceneFileErrors, NamedFilesNeedPermission) {
  if (geteuid() == 0) GTEST_SKIP() << "root reads everything";
  const TestFolder folder;
  std::filesystem::permissions(folder.write("grid.tif", "II*"), std::filesystem::perms::none);
  EXPECT_THAT(
      scene_error(folder, replaced(smallest_scene, flat_lines, "kind = \"raster\"\nfile = \"grid.tif\"")),
      AllOf(StartsWith("scene.toml:5:8: "), HasSubstr("grid.tif: may not be read (Permission denied)")));
}

// Tests each key with values of each wrong type, and with numbers just beyond its range.
class EveryKey : public testing::Test {
 protected:
  EveryKey() { folder_.write("file.dat", "x"); }

  static std::string good_value(const SceneKey& key) {
    if (key.type == "file") return "\"file.dat\"";
    if (key.type == "2 numbers") return "[10, 10]";
    if (key.type == "3 numbers") return "[0, 0, 0]";
    if (key.type == "table") return key.name == "shares" ? "{ x = 1 }" : "{ 1 = \"x\" }";
    return key.type == "text" ? "\"x\"" : "10";
  }

  /// A scene that gives `key` this value, with the other keys that it requires.
  static std::string scene(const SceneKey& key, const std::string& value) {
    std::string text = key.section + "\n" + key.kind + "\n";
    if (key.section == "[terrain.material_map]") text = "[terrain]\n" + some_kind("[[terrain]]") + text;
    if (key.section == "[sensors.processing]")
      text = "[[sensors]]\nname = \"s\"\n" + some_kind("[[sensors]]") + text;
    for (const SceneKey& other : scene_file_keys()) {
      const bool together = other.section == key.section && (other.kind.empty() || other.kind == key.kind);
      const bool tells_kind = key.kind.starts_with(other.name + " ");
      if (together && !tells_kind && other.default_value == "required" && other.name != key.name &&
          !other.range.starts_with('"')) {
        text += other.name + " = " + good_value(other) + "\n";
      }
    }
    // A key of all kinds needs one of them.
    if (key.kind.empty() && key.name != "kind" && key.name != "shape") text += some_kind(key.section);
    const bool nested = key.section.starts_with("[[materials.");
    return text + key.name + " = " + value + "\n" + (nested ? "[materials]\nname = \"m\"\n" : "");
  }

  static std::string some_kind(const std::string& section) {
    if (section == "[[terrain]]") return "kind = \"flat\"\nwidth_m = 1\nlength_m = 1\n";
    if (section == "[[objects]]") return "shape = \"box\"\n";
    if (section == "[[trajectories]]") return "kind = \"fixed\"\n";
    if (section == "[terrain.material_map]")
      return "kind = \"patches\"\npatch_size_m = 1\nshares = { x = 1 }\n";
    return section == "[[sensors]]" ? "kind = \"didson\"\n" : "";
  }

  /// Expects that `value` is rejected, at its own position or `deeper` characters further.
  void expect_refused(const SceneKey& key, const std::string& value, std::size_t deeper = 0) {
    const std::string text = scene(key, value);
    const auto after = key.section.starts_with("[[materials.") ? 2 : 0;  // lines of the material
    const auto line = std::count(text.begin(), text.end(), '\n') - after;
    const std::size_t column = key.name.size() + 4 + deeper;
    EXPECT_THAT(scene_error(folder_, text),
                StartsWith(fmt::format("scene.toml:{}:{}: '{}' must", line, column, key.name)))
        << text;
  }

  TestFolder folder_;
};

TEST_F(EveryKey, RefusesOtherTypes) {
  for (const SceneKey& key : scene_file_keys()) {
    const bool wants_text = key.type == "text" || key.type == "file",
               wants_bool = key.type == "true or false";
    if (!wants_text) expect_refused(key, "\"5 m\"");
    if (!wants_bool) expect_refused(key, "true");
    if (wants_text || wants_bool) expect_refused(key, "5");
    expect_refused(key, "[]");
    if (key.type != "table") expect_refused(key, "{a = 1}");
    if (key.type == "table") expect_refused(key, "{}");
    expect_refused(key, "12:30:00");
  }
}

TEST_F(EveryKey, RefusesNumbersThatAreNotFiniteOrBeyondTheRange) {
  int tried = 0;
  for (const SceneKey& key : scene_file_keys()) {
    if (key.type == "number") {
      for (const char* value : {"nan", "inf", "-inf"}) expect_refused(key, value);
    }
    if (key.range.empty() || key.range.starts_with('"')) continue;
    const bool array = key.type.ends_with('s'), whole = key.type.find("integer") != std::string::npos;
    // Ranges read "a to b", "> a, <= b", ">= a". Those of array elements stand between semicolons.
    std::istringstream words(key.range.substr(0, key.range.find(';')));
    std::string relation = ">=";
    for (std::string word; words >> word;) {
      if (word.find_first_of("0123456789") == std::string::npos) {
        relation = word == "to" ? "<=" : word;
        continue;
      }
      const bool upper = relation.starts_with('<');
      const double limit = std::stod(word);
      const double step = relation == "<" || relation == ">" ? 0 : whole ? 1 : std::abs(limit) * 1e-9 + 1e-9;
      const double beyond = upper ? limit + step : limit - step;
      const std::string value = whole ? fmt::format("{:.0f}", beyond) : fmt::format("{:.17g}", beyond);
      if (array) {
        const auto elements_wanted = static_cast<std::size_t>(key.type[0] - '0');
        std::string elements = "[" + value;
        for (std::size_t i = 1; i < elements_wanted; ++i) elements += ", 3";
        expect_refused(key, elements + "]", 1);
      } else {
        expect_refused(key, value);
      }
      ++tried;
    }
  }
  EXPECT_GT(tried, 120);
}

TEST_F(EveryKey, IsMissedByOneLetterAndFound) {
  for (const SceneKey& key : scene_file_keys()) {
    if (key.name == "ph" || key.name == "kind" || key.name == "shape")
      continue;  // too short, or itself required
    SceneKey misspelt = key;
    std::swap(misspelt.name[0], misspelt.name[1]);
    if (misspelt.name == key.name) continue;
    std::string text = scene(key, good_value(key));
    const std::size_t at = text.rfind("\n" + key.name + " = ") + 1;
    text.replace(at, key.name.size(), misspelt.name);
    EXPECT_THAT(scene_error(folder_, text), HasSubstr("did you mean '" + key.name + "'?")) << text;
  }
}

TEST(SceneFileWords, EditDistanceCountsSlipsOfThePen) {
  EXPECT_EQ(edit_distance("", ""), 0u);
  EXPECT_EQ(edit_distance("", "abc"), 3u);
  EXPECT_EQ(edit_distance("beams", "beam"), 1u);
  EXPECT_EQ(edit_distance("baems", "beams"), 1u);
  EXPECT_EQ(edit_distance("kitten", "sitting"), 3u);
  // the optimal-alignment value; the unrestricted distance would be 2
  EXPECT_EQ(edit_distance("ca", "abc"), 3u);
}

TEST(SceneFileWords, NearestIsNearEnoughOrNothing) {
  EXPECT_EQ(nearest("lenght_m", {"width_m", "length_m"}), "length_m");
  EXPECT_EQ(nearest("x", {"y", "z"}), "");
  EXPECT_EQ(nearest("hexagon", {"flat", "fractal", "raster"}), "");
  EXPECT_EQ(nearest(std::string(1000000, 'x'), {"xx"}), "");
}

TEST(SceneFileWords, ListsAreCutShort) {
  EXPECT_EQ(one_of({"a"}, '\''), "'a'");
  EXPECT_EQ(one_of({"a", "b", "c"}, '"'), "\"a\", \"b\" or \"c\"");
  EXPECT_THAT(one_of(std::vector<std::string>(1000, "a"), '\''), testing::EndsWith("'a' or 970 others"));
}

}  // namespace
}  // namespace tubefoot
