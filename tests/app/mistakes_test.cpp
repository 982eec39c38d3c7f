// SPDX-License-Identifier: GPL-3.0-or-later
// Tests typical mistakes of new users and the messages of the program: units, frames, range gates, names,
// files, tables and command lines. Each is one change of a valid scene, and none may stay unreported.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "app/command_line.hpp"
#include "fixtures/program.hpp"
#include "fixtures/scene_texts.hpp"

namespace tubefoot {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::Not;

constexpr std::string_view good_scene = R"(title = "A box on sand"
[water]
sound_speed_m_s = 1500
[[materials]]
name = "sand"
lambert_db = -27
[[materials]]
name = "steel"
lambert_db = -10
[[terrain]]
kind = "flat"
material = "sand"
width_m = 40
length_m = 60
[[objects]]
name = "box"
shape = "box"
material = "steel"
size_m = [1, 1, 1]
position_m = [0, 6, 0.5]
[trajectory]
kind = "fixed"
position_m = [0, 0, 3]
[[sensors]]
name = "camera"
kind = "imaging"
beams = 8
horizontal_deg = 20
vertical_deg = 20
tilt_deg = 25
samples = 64
range_min_m = 2
range_max_m = 12
)";

/// Eastwards, three pings.
constexpr std::string_view good_track =
    "time_s,east_m,north_m,up_m,heading_deg,pitch_deg,roll_deg\n0,-2,0,3,90,0,0\n10,3,0,3,90,0,0\n";

constexpr std::string_view cube_of_1000 =
    "v 0 0 0\nv 1000 0 0\nv 0 1000 0\nv 0 0 1000\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";

constexpr std::string_view good_grid =
    "ncols 5\nnrows 5\nxllcorner -10\nyllcorner -10\ncellsize 5\n0 0 0 0 0\n0 0 0 0 0\n0 0 0 0 0\n0 0 0 0 0\n"
    "0 0 0 0 0\n";

struct Edit {
  std::string from, to;
};
using Edits = std::vector<Edit>;
using Files = std::map<std::string, std::string>;

struct Mistake {
  std::string what;
  Edits edits;                     ///< of the valid scene
  std::vector<std::string> words;  ///< of the message
  int exit_code = 2;               ///< 0: a warning, and the request is completed
  Files files = {};
  /// SCENE stands for the scene, OUT for a folder that does not exist yet.
  std::vector<std::string> command = {"check", "SCENE"};
  std::string unreadable = {};  ///< a file that the user may not read
};

const Edit on_track{"kind = \"fixed\"\nposition_m = [0, 0, 3]", "kind = \"waypoints\"\nfile = \"track.csv\""};
const Edit three_pings{"range_max_m = 12", "range_max_m = 12\npings = 3\nping_interval_s = 2"};
const Edit of_mesh{"shape = \"box\"\nmaterial = \"steel\"\nsize_m = [1, 1, 1]",
                   "shape = \"mesh\"\nfile = \"thing.obj\"\nmaterial = \"steel\""};
const Edit on_grid{"kind = \"flat\"\nmaterial = \"sand\"\nwidth_m = 40\nlength_m = 60",
                   "kind = \"raster\"\nmaterial = \"sand\"\nfile = \"grid.asc\""};

std::string all_replaced(std::string_view text, std::string_view from, std::string_view to) {
  std::string changed(text);
  for (std::size_t at = 0; (at = changed.find(from, at)) != std::string::npos; at += to.size())
    changed.replace(at, from.size(), to);
  return changed;
}

Mistake of_track(std::string what, std::string track, std::vector<std::string> words, int exit_code = 2) {
  return {std::move(what),
          {on_track, three_pings},
          std::move(words),
          exit_code,
          {{"track.csv", std::move(track)}}};
}

Mistake at(std::string what, std::string_view position, std::vector<std::string> words, int exit_code = 0) {
  return {std::move(what), {{"[0, 0, 3]", std::string(position)}}, std::move(words), exit_code};
}

Mistake of_command(std::string what, std::vector<std::string> command, std::vector<std::string> words) {
  Mistake mistake{std::move(what), {}, std::move(words)};
  mistake.command = std::move(command);
  return mistake;
}

/// Runs the command line of the program in this process, because a hundred processes take long to start.
Outcome said(std::vector<std::string> words) {
  words.insert(words.begin(), "tubefoot");
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  Outcome outcome;
  testing::internal::CaptureStdout();
  testing::internal::CaptureStderr();
  outcome.exit_code = run_command_line(static_cast<int>(arguments.size()), arguments.data());
  outcome.out = testing::internal::GetCapturedStdout();
  outcome.err = testing::internal::GetCapturedStderr();
  return outcome;
}

Outcome outcome_of(const Mistake& mistake) {
  const TestFolder folder;
  fs::permissions(folder.path(), fs::perms(0777));
  std::string scene(good_scene);
  for (const Edit& edit : mistake.edits) scene = replaced(scene, edit.from, edit.to);
  folder.write("scene.toml", scene);
  for (const auto& [name, text] : mistake.files) folder.write(name, text);
  Surroundings surroundings;
  if (!mistake.unreadable.empty()) {
    fs::permissions(folder / mistake.unreadable, fs::perms::none);
    surroundings.as_nobody = true;
  }
  std::vector<std::string> command;
  for (const std::string& word : mistake.command)
    command.push_back(word == "SCENE" ? (folder / "scene.toml").string()
                      : word == "OUT" ? (folder / "out").string()
                                      : word);
  Outcome outcome = mistake.unreadable.empty() ? said(command) : run_program(command, surroundings);
  outcome.err = all_replaced(outcome.err, folder.path().string() + "/", "");
  return outcome;
}

void expect_answers(const std::vector<Mistake>& mistakes) {
  for (const Mistake& mistake : mistakes) {
    SCOPED_TRACE(mistake.what);
    // two users
    if (!mistake.unreadable.empty() && (geteuid() != 0 || !nobody_can_run_program())) continue;
    const Outcome outcome = outcome_of(mistake);
    EXPECT_EQ(outcome.exit_code, mistake.exit_code) << outcome.err;
    for (const std::string& word : mistake.words) EXPECT_THAT(outcome.err, HasSubstr(word));
    EXPECT_FALSE(mistake.words.empty());
  }
}

// --- valid input

TEST(Mistakes, NoneIsSeenInWhatIsRight) {
  const auto expect_silence = [](const Edits& edits, const Files& files) {
    for (const std::vector<std::string>& command :
         std::vector<std::vector<std::string>>{{"check", "SCENE"}, {"run", "SCENE", "-o", "OUT"}}) {
      const Outcome outcome = outcome_of({"none", edits, {}, 0, files, command});
      EXPECT_EQ(outcome.exit_code, 0);
      EXPECT_THAT(outcome.err, Not(HasSubstr("warning")));
    }
  };
  expect_silence({}, {});
  expect_silence({on_track, three_pings}, {{"track.csv", std::string(good_track)}});
  expect_silence({{"tilt_deg = 25", "tilt_deg = 24.5"}, {"[0, 0, 3]", "[0, 0, 3]\nheading_deg = 2.5"}}, {});
}

// --- sensors that look at nothing

std::vector<Mistake> directions() {
  return {
      {"tilt counted upwards",
       {{"tilt_deg = 25", "tilt_deg = -30"}},
       {"scene.toml:24:1: sensor 'camera' receives nothing", "19.5 to 40 degrees up", "towards 0 degrees",
        "'tilt_deg' is positive downwards"},
       0},
      {"tilt counted upwards, run",
       {{"tilt_deg = 25", "tilt_deg = -30"}},
       {"sensor 'camera' receives nothing", "19.5 to 40 degrees up"},
       0,
       {},
       {"run", "SCENE", "-o", "OUT"}},
      {"the carrier's bow up",
       {{"[0, 0, 3]", "[0, 0, 3]\npitch_deg = 60"}},
       {"receives nothing", "24.5 to 45 degrees up", "pitch_deg"},
       0},
      {"a flat fan that looks level",
       {{"tilt_deg = 25", "tilt_deg = 0"},
        {"vertical_deg = 20", "vertical_deg = 2"},
        {"[0, 6, 0.5]", "[0, -6, 0.5]"}},
       {"receives nothing", "from 1 degrees down to 1 degrees up", "and no facet is there",
        "east -20 to 20, north -30 to 30, up 0 to 0 m"},
       0},
      {"looks out over the terrain's edge",
       {{"[0, 0, 3]", "[25, 0, 3]\nheading_deg = 90"}},
       {"receives nothing", "towards 90 degrees", "5 m outside of the terrain", "east -20 to 20"},
       0},
  };
}
TEST(Mistakes, Directions) { expect_answers(directions()); }

std::vector<Mistake> windows() {
  return {
      {"a window behind all echoes",
       {{"range_min_m = 2", "range_min_m = 60"}, {"range_max_m = 12", "range_max_m = 65"}},
       {"receives nothing", "at ranges of 5.23 to 11.88 m", "its range gate is 60 to 65 m",
        "change the range gate"},
       0},
      {"a window behind all echoes, run",
       {{"range_min_m = 2", "range_min_m = 60"}, {"range_max_m = 12", "range_max_m = 65"}},
       {"receives nothing", "its range gate is 60 to 65 m"},
       0,
       {},
       {"run", "SCENE", "-o", "OUT"}},
      {"a window before all echoes",
       {{"range_min_m = 2", "range_min_m = 0.5"}, {"range_max_m = 12", "range_max_m = 2"}},
       {"receives nothing", "its range gate is 0.5 to 2 m"},
       0},
      {"a range in millimetres",
       {{"range_max_m = 12", "range_max_m = 12000"}},
       {"records up to 1.2e+04 m in range bins of 187 m", "is the range gate in metres?"},
       0},
      {"nearest and farthest exchanged",
       {{"range_min_m = 2", "range_min_m = 20"}},
       {"scene.toml:33:15: 'range_min_m' (20) must be less than 'range_max_m' (12)"}},
      {"so much absorption that nothing comes back",
       {{"sound_speed_m_s = 1500", "sound_speed_m_s = 1500\nabsorption_db_per_km = 100000"},
        {"range_min_m = 2", "range_min_m = 60"},
        {"range_max_m = 12", "range_max_m = 65"},
        {"[0, 0, 3]", "[0, 0, 27]"},
        {"length_m = 60", "length_m = 600"}},
       {"receives nothing: at ping 0", "within its range gate, but return no energy", "absorption_db_per_km"},
       0,
       {},
       {"run", "SCENE", "-o", "OUT"}},
  };
}
TEST(Mistakes, Windows) { expect_answers(windows()); }

// --- positions

std::vector<Mistake> frames() {
  const std::string utm =
      "time_s,east_m,north_m,up_m,heading_deg,pitch_deg,roll_deg\n0,621930,7245100,3,90,0,0\n"
      "10,621935,7245100,3,90,0,0\n";
  const std::string degrees =
      "time_s,east_m,north_m,up_m,heading_deg,pitch_deg,roll_deg\n0,-4.52,48.36,3,0,0,0\n10,-4.52,48.3601,3,"
      "0,0,0\n";
  const std::string here = "[georeference]\norigin_lat_lon_deg = [48.36, -4.52]\n[water]";
  return {
      of_track("a track in UTM over a local bed", utm,
               {"receives nothing", "km from the terrain, which covers east -20 to 20, north -30 to 30",
                "look like UTM easting and northing", "origin_crs"},
               0),
      {"a bed in UTM under a local track",
       {on_grid, {"[0, 6, 0.5]", "[0, -6, 0.5]"}},
       {"receives nothing", "the terrain's coordinates look like UTM", "[georeference]",
        "object 'box' lies outside of the terrain, which covers east 621932.5 to 621952.5"},
       0,
       {{"grid.asc", all_replaced(all_replaced(good_grid, "xllcorner -10", "xllcorner 621930"),
                                  "yllcorner -10", "yllcorner 7245100")}}},
      {"a track in longitude and latitude",
       {on_track, three_pings, {"[water]", here}},
       {"receives nothing", "look like longitude and latitude"},
       0,
       {{"track.csv", degrees}}},
      at("500 m above the seabed", "[0, 0, 500]",
         {"receives nothing", "up 500.00 m, 500 m above the terrain", "14.6 to 35 degrees down",
          "and no facet is there"}),
      at("500 m off the terrain", "[500, 0, 3]",
         {"receives nothing", "480 m outside of the terrain", "north -30 to 30"}),
      {"depths where heights are wanted",
       {{"length_m = 60", "length_m = 60\ncentre_m = [0, 0, 20]"}},
       {"scene.toml:25:1: sensor 'camera' is 17 m below the seabed"}},
      {"a bed at its depth, the sonar at its height",
       {{"length_m = 60", "length_m = 60\ncentre_m = [0, 0, -20]"}, {"[0, 6, 0.5]", "[0, 6, -19.5]"}},
       {"receives nothing", "up 3.00 m, 23 m above the terrain", "up -20 to -20 m"},
       0},
      {"an origin in degrees for a map in metres",
       {{"[water]", "[georeference]\ncrs = \"EPSG:32630\"\norigin_crs = [-4.52, 48.36]\n[water]"}},
       {"origin_crs [-4.52, 48.36] looks like degrees", "WGS 84 / UTM zone 30N", "origin_lat_lon_deg"}},
      {"degrees as a map",
       {{"[water]", "[georeference]\ncrs = \"EPSG:4326\"\norigin_crs = [48.36, -4.52]\n[water]"}},
       {"is not a projected coordinate reference system: give origin_lat_lon_deg"}},
  };
}
TEST(Mistakes, Frames) { expect_answers(frames()); }

std::vector<Mistake> objects() {
  const auto moved = [](std::string what, std::string_view to, std::vector<std::string> words) {
    return Mistake{std::move(what), {{"[0, 6, 0.5]", std::string(to)}}, std::move(words), 0};
  };
  return {
      moved("an object under the bed", "[0, 6, -5]",
            {"scene.toml:15:1: object 'box' is buried and cannot be seen: its top is 4.5 m below the seabed",
             "on_terrain_m"}),
      moved("an object off the terrain", "[0, 600, 0.5]",
            {"object 'box' lies outside of the terrain, which covers east -20 to 20, north -30 to 30"}),
      {"a size in millimetres",
       {{"size_m = [1, 1, 1]", "size_m = [1000, 1000, 1000]"}},
       {"object 'box' is 1000 m wide, 16.7 times as wide as the terrain", "other units",
        "is inside object 'box'"},
       0},
      {"a mesh in millimetres",
       {of_mesh},
       {"object 'box' is 1000 m wide", "unit_m"},
       0,
       {{"thing.obj", std::string(cube_of_1000)}}},
      {"set on terrain that is not there",
       {{"[0, 6, 0.5]", "[0, 600, 0]\non_terrain_m = 0"}},
       {"there is no terrain below the object's position", "terrain covers east -20 to 20, north -30 to 30"}},
  };
}
TEST(Mistakes, Objects) { expect_answers(objects()); }

TEST(Mistakes, WhereThingsAreIsReported) {
  const auto told = [](std::string_view to) {
    return outcome_of({"none", {{"[0, 6, 0.5]", std::string(to)}}, {}, 0}).out;
  };
  EXPECT_THAT(told("[0, 6, 0.5]"), HasSubstr("box                      on the seabed\n"));
  EXPECT_THAT(told("[0, 6, 0]"), HasSubstr("partly buried: from 0.5 m below the seabed to 0.5 m above\n"));
  EXPECT_THAT(told("[0, 6, 10]"), HasSubstr("9.5 m above the seabed\n"));
  EXPECT_THAT(told("[20, 6, 0.5]"), HasSubstr("on the seabed; partly outside of the terrain\n"));
  EXPECT_THAT(told("[0, 6, -5]"), HasSubstr("buried: its top is 4.5 m below the seabed\n"));
  EXPECT_THAT(told("[0, 6, 0.5]"), HasSubstr("east 0.00, north 0.00, up 3.00 m (3 m above the seabed)\n"));
  EXPECT_THAT(told("[0, 6, 0.5]"), HasSubstr("local, in metres, without a position on Earth\n"));
}

// --- units

std::vector<Mistake> units() {
  return {
      {"a frequency in Hz",
       {{"samples = 64", "samples = 64\nfrequency_khz = 455000"}},
       {"scene.toml:32:17: 'frequency_khz' must be 1 to 10000 kHz, not 455000"}},
      {"a frequency in MHz",
       {{"samples = 64", "samples = 64\nfrequency_khz = 1.8"}},
       {"beams of 2.5 degrees at 1.8 kHz, which need an antenna of 19.1 m", "kHz"},
       0},
      {"a sound speed in km/s",
       {{"sound_speed_m_s = 1500", "sound_speed_m_s = 1.5"}},
       {"scene.toml:3:19: 'sound_speed_m_s' must be 1300 to 1700 m/s, not 1.5"}},
      {"a loss without its sign",
       {{"lambert_db = -27", "lambert_db = 27"}},
       {"scene.toml:6:14:", "a surface cannot scatter more than it receives"}},
      {"a tilt in radians",
       {{"tilt_deg = 25", "tilt_deg = 0.436332"}},
       {"'tilt_deg' of sensor 'camera' is 0.436332, which looks like radians (25 degrees)"},
       0},
      {"a heading in radians",
       {{"[0, 6, 0.5]", "[0, 6, 0.5]\nheading_deg = -1.5708"}},
       {"scene.toml:15:1: 'heading_deg' of object 'box'", "looks like radians (-90 degrees)"},
       0},
      {"a key in radians",
       {{"tilt_deg = 25", "tilt_rad = 0.44"}},
       {"scene.toml:30:1: unknown key 'tilt_rad' in [[sensors]]: give it in degrees, as 'tilt_deg'"}},
      {"a unit behind the number",
       {{"tilt_deg = 25", "tilt_deg = 25 deg"}},
       {"scene.toml:30:15: not valid TOML", "write only the number"}},
      {"a unit in quotes",
       {{"tilt_deg = 25", "tilt_deg = \"25 deg\""}},
       {"scene.toml:30:12:", "write only the number"}},
      {"a decimal comma",
       {{"tilt_deg = 25", "tilt_deg = 25,5"}},
       {"scene.toml:30:14: not valid TOML", "write decimals with a point"}},
  };
}
TEST(Mistakes, Units) { expect_answers(units()); }

std::vector<Mistake> names() {
  return {
      {"a preset misspelt",
       {{"kind = \"imaging\"", "preset = \"aris-1801\""}},
       {"scene.toml:26:10: there is no preset \"aris-1801\" (did you mean \"aris-1800\"?)"}},
      {"a preset as a kind",
       {{"kind = \"imaging\"", "kind = \"klein-3000-445\""}},
       {"scene.toml:26:8: \"klein-3000-445\" is a preset, not a kind: write preset = \"klein-3000-445\""}},
      {"a kind misspelt",
       {{"kind = \"imaging\"", "kind = \"side-scan\""}},
       {"scene.toml:26:8:", "did you mean \"sidescan\"?"}},
      {"no kind", {{"kind = \"imaging\"\n", ""}}, {"scene.toml:24:1: [[sensors]] needs the key 'kind'"}},
      {"a material misspelt",
       {{"material = \"steel\"", "material = \"stel\""}},
       {"scene.toml:18:12:", "did you mean \"steel\"?"}},
      {"a section misspelt",
       {{"[[sensors]]", "[[sensor]]"}},
       {"scene.toml:24:3:", "did you mean 'sensors'?"}},
      {"text without quotes",
       {{"kind = \"imaging\"", "kind = imaging"}},
       {"scene.toml:26:9: not valid TOML", "put text in quotes"}},
      {"a colon for an equals sign",
       {{"beams = 8", "beams: 8"}},
       {"scene.toml:27:6: not valid TOML", "key = value"}},
      {"a place of two numbers",
       {{"[0, 0, 3]", "[0, 3]"}},
       {"scene.toml:23:14: 'position_m' must be an array of 3 numbers", "not of 2"}},
  };
}
TEST(Mistakes, Names) { expect_answers(names()); }

// --- files

std::vector<Mistake> files() {
  Mistake mesh{
      "a mesh that may not be read", {of_mesh}, {"thing.obj", "is not readable (Permission denied)"}};
  mesh.files["thing.obj"] = std::string(cube_of_1000);
  mesh.unreadable = "thing.obj";
  Mistake grid{"a grid that may not be read", {on_grid}, {"grid.asc", "is not readable (Permission denied)"}};
  grid.files["grid.asc"] = std::string(good_grid);
  grid.unreadable = "grid.asc";
  Mistake scene{"a scene that may not be read", {}, {"scene.toml", "is not readable (Permission denied)"}};
  scene.unreadable = "scene.toml";
  return {
      mesh,
      grid,
      scene,
      {"another case in a name",
       {of_mesh},
       {"scene.toml:18:8: 'file': there is no file 'thing.obj'", "did you mean 'Thing.OBJ'?"},
       2,
       {{"Thing.OBJ", std::string(cube_of_1000)}}},
      {"a name misspelt",
       {of_mesh, {"thing.obj", "thimg.obj"}},
       {"scene.toml:18:8: 'file': there is no file 'thimg.obj'", "did you mean 'thing.obj'?"},
       2,
       {{"thing.obj", std::string(cube_of_1000)}}},
      {"a folder as another system writes it",
       {of_mesh, {"thing.obj", "meshes\\\\thing.obj"}},
       {"scene.toml:18:8:", "separate folders with /"}},
      {"a format that is not read",
       {of_mesh, {"thing.obj", "thing.step"}},
       {"scene.toml:15:1: thing.step: '.step' is not a mesh format that tubefoot reads: expected .obj"},
       2,
       {{"thing.step", "ISO-10303-21;\n"}}},
      {"cells without data that the grid does not declare",
       {on_grid},
       {"grid.asc: has cells with the value -9999", "gdal_translate -a_nodata -9999"},
       0,
       {{"grid.asc", replaced(good_grid, "cellsize 5\n0 0 0", "cellsize 5\n-9999 0 0")}}},
      {"a grid of depths taken for heights",
       {on_grid},
       {"scene.toml:23:1: sensor 'camera' is 17 m below the seabed"},
       2,
       {{"grid.asc", all_replaced(good_grid, "0 0 0 0 0", "20 20 20 20 20")}}},
  };
}
TEST(Mistakes, Files) { expect_answers(files()); }

std::vector<Mistake> tables() {
  const auto with = [](std::string_view from, std::string_view to) {
    return all_replaced(good_track, from, to);
  };
  return {
      of_track("semicolons", with(",", ";"),
               {"scene.toml:21:1: track.csv:1: ", "expected some of time_s,east_m,north_m,",
                "columns are separated by semicolons, expected commas"}),
      of_track("tabs", with(",", "\t"), {"track.csv:1: ", "separated by tabs"}),
      of_track("decimal commas", with(",3,90", ",3,0,90"),
               {"track.csv:2: the row has 8 fields, expected 7", "are decimals written with commas?"}),
      of_track("no header", std::string(good_track.substr(good_track.find('\n') + 1)),
               {"track.csv:1: ", "the first line holds numbers: put the header above it"}),
      of_track("other names", with("east_m,north_m,up_m", "x,y,z"),
               {"track.csv:1: expected the columns east_m and north_m, or latitude_deg and longitude_deg"}),
      of_track(
          "headings whose name says radians", with("heading_deg", "heading_rad"),
          {"track.csv:1: the name of the column 'heading_rad' has another unit", "rename it to heading_deg"}),
      of_track("headings without their unit", with("heading_deg", "heading"),
               {"scene.toml:21:1: track.csv:1:28: unknown column 'heading': did you mean 'heading_deg'?"}),
      of_track("columns of another program",
               all_replaced(with(",0,0\n", ",0,0,7,8\n"), "roll_deg", "roll_deg,quality,ship"),
               {"track.csv: tubefoot ignores the columns 'quality', 'ship'"}, 0),
      {"columns of another program, in a run",
       {on_track, three_pings},
       {"track.csv: tubefoot ignores the columns 'quality', 'ship'"},
       0,
       {{"track.csv", all_replaced(with(",0,0\n", ",0,0,7,8\n"), "roll_deg", "roll_deg,quality,ship")}},
       {"run", "SCENE", "-o", "OUT"}},
      of_track("headings that can only be radians", with(",90,", ",1.5708,"),
               {"track.csv: heading_deg looks like radians"}, 0),
      of_track("a workbook", "PK\x03\x04 and more", {"this is a spreadsheet workbook: save it as CSV"}),
      of_track("UTF-16", std::string("\xFF\xFEt\0i\0m\0e\0", 10), {"this is UTF-16"}),
      of_track("dates", with("\n0,", "\n2024-01-01T00:00:00,"),
               {"track.csv:2:1: time_s is '2024-01-01T00:00:00'", "write seconds as one number"}),
      of_track("an empty cell", with("10,3,0,3,90", "10,3,0,3,"),
               {"track.csv:3:10: heading_deg is ''", "empty"}),
      of_track("times in milliseconds", with("\n10,", "\n10000,"),
               {"track.csv: 5 m in 1e+04 s is a speed of 0.0005 m/s: is time_s in seconds?"}, 0),
      of_track("times that stand still", with("\n10,", "\n0,"),
               {"track.csv:3:1: time_s must increase: 0 follows 0"}),
      of_track("times of another clock",
               with("\n0,", "\n-20,").replace(with("\n0,", "\n-20,").find("\n10,"), 4, "\n-10,"),
               {"ping 0 of sensor 'camera' is at 0 s, outside of its trajectory", "from -20 s to -10 s"}),
      of_track("an empty file", "", {"track.csv: is empty, expected the header"}),
  };
}
TEST(Mistakes, Tables) { expect_answers(tables()); }

// --- the command line

std::vector<Mistake> command_lines() {
  const auto run = [](std::vector<std::string> more) {
    std::vector<std::string> command{"run", "SCENE", "-o", "OUT"};
    command.insert(command.end(), more.begin(), more.end());
    return command;
  };
  return {
      of_command(
          "a tolerance of 50 %", run({"--tolerance", "0.5"}),
          {"'0.5' without a unit is a relative error of 50 %", "0.5dB", "or 50% for this relative error"}),
      of_command("a tolerance of 50 %, advise", {"advise", "SCENE", "--tolerance", "0.5"},
                 {"'0.5' without a unit is a relative error of 50 %"}),
      of_command("a tolerance in percent without its sign", run({"--tolerance", "5"}),
                 {"'5' without a unit is a relative error of 500 %", "5dB", "5%"}),
      of_command("rays for the tube engine", run({"--rays", "1000"}),
                 {"--rays is a setting of the ray engine, but this run uses tube: add --engine ray"}),
      of_command("rays a beam for the tube engine", run({"--rays-per-beam", "10"}),
                 {"--rays-per-beam is a setting"}),
      of_command("a sampling for the tube engine", run({"--sampling", "random"}),
                 {"--sampling is a setting"}),
      of_command("a binning for the ray engine", run({"--engine", "ray", "--binning", "spread"}),
                 {"--binning is a setting of the tube engine"}),
      of_command("a command misspelt", {"rnu", "SCENE"},
                 {"unknown command 'rnu': did you mean 'run'? 'tubefoot help' lists the commands"}),
      of_command("a scene that is not there", {"check", "scenes/mine.toml"}, {"there is no such scene file"}),
      of_command("a sensor that is not there", {"footprints", "SCENE", "--sensor", "kamera", "-o", "x.csv"},
                 {"the scene has no sensor 'kamera'; it has 'camera'"}),
      of_command("a ping that is not there", {"audit", "SCENE", "--pings", "5"},
                 {"the sensor has pings 0 to 0"}),
      of_command("a format that is not written", {"footprints", "SCENE", "--sensor", "camera", "-o", "x.shp"},
                 {"unknown suffix"}),
  };
}
TEST(Mistakes, CommandLines) { expect_answers(command_lines()); }

TEST(Mistakes, AreFortyAtLeast) {
  std::size_t all = 0;
  for (const auto group : {directions, windows, frames, objects, units, names, files, tables, command_lines})
    all += group().size();
  EXPECT_GE(all, 40U);
}

}  // namespace
}  // namespace tubefoot
