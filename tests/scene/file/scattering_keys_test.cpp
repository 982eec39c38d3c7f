// SPDX-License-Identifier: GPL-3.0-or-later
// Tests materials with scattering models other than Lambert's law: their keys, and the models that loading
// makes of them.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "fixtures/world/read_scenes.hpp"
#include "geometry/numbers/scalars.hpp"
#include "scene/scene.hpp"
#include "scene/surfaces/scattering.hpp"
#include "sensors/kinds/kind_didson.hpp"

namespace tubefoot {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

/// The scattering model of the only material, and the warnings of loading.
struct Loaded {
  std::shared_ptr<const ScatteringModel> model;
  std::vector<std::string> warnings;
  double db(double grazing_deg) const { return 10 * std::log10(model->cross_section(grazing_deg * degree)); }
};
Loaded load(const TestFolder& folder, std::string_view keys) {
  Loaded loaded;
  loaded.model = load_scattering(read_scene(folder, scene_with_sand(keys)), loaded.warnings).at(0);
  return loaded;
}

std::string load_error(const TestFolder& folder, std::string_view keys) {
  try {
    load(folder, keys);
  } catch (const InputError& error) {
    return error.what();
  }
  return {};
}

TEST(ScatteringKeys, AllAreRead) {
  const TestFolder folder;
  folder.write("measured.csv", "10, -30\n");
  const MaterialDescription lambert = read_scene(folder, smallest_scene).materials.at(0);
  EXPECT_EQ(lambert.model, "lambert");
  EXPECT_FALSE(lambert.unbounded);
  const MaterialDescription gsab =
      read_scene(folder, scene_with_sand(
                             "law = \"gsab\"\nspecular_db = -3\nspecular_width_deg = 4\noblique_db = -17\n"
                             "oblique_exponent = 1.5\ntransition_db = -14\ntransition_width_deg = 25\n"
                             "unbounded = true"))
          .materials.at(0);
  EXPECT_EQ(gsab.model, "gsab");
  EXPECT_EQ(gsab.specular_db, -3);
  EXPECT_EQ(gsab.specular_width_deg, 4);
  EXPECT_EQ(gsab.oblique_db, -17);
  EXPECT_EQ(gsab.oblique_exponent, 1.5);
  EXPECT_EQ(gsab.transition_db, -14);
  EXPECT_EQ(gsab.transition_width_deg, 25);
  EXPECT_TRUE(gsab.unbounded);
  const MaterialDescription table =
      read_scene(folder,
                 scene_with_sand("law = \"table\"\ntable_grazing_deg = [10, 45]\ntable_db = [-35, -22]"))
          .materials.at(0);
  EXPECT_THAT(table.table_grazing_deg, ElementsAre(10, 45));
  EXPECT_THAT(table.table_db, ElementsAre(-35, -22));
  EXPECT_EQ(read_scene(folder, scene_with_sand("law = \"table\"\ntable_file = \"measured.csv\""))
                .materials[0]
                .table_file,
            folder.path() / "measured.csv");
  const MaterialDescription sediment =
      read_scene(folder, scene_with_sand("law = \"sediment\"\nsediment = \"silt\"\nsediment_khz = 20"))
          .materials.at(0);
  EXPECT_EQ(sediment.sediment, "silt");
  EXPECT_EQ(sediment.sediment_khz, 20);
}

TEST(ScatteringKeys, LawsScatterAsTheKeysSay) {
  const TestFolder folder;
  EXPECT_EQ(load(folder, "lambert_db = -20").model, nullptr);
  const Loaded gsab = load(folder,
                           "law = \"gsab\"\nspecular_db = -3\nspecular_width_deg = 4\noblique_db = -17\n"
                           "transition_db = -14\ntransition_width_deg = 18");
  EXPECT_TRUE(gsab.warnings.empty());
  for (const double phi : {0.0, 3.0, 20.0, 70.0})
    EXPECT_NEAR(gsab.db(90 - phi),
                10 * std::log10(std::pow(10, -0.3) * std::exp(-phi * phi / 32) +
                                std::pow(10, -1.7) * std::pow(std::cos(phi * degree), 2) +
                                std::pow(10, -1.4) * std::exp(-phi * phi / 648)),
                1e-9)
        << phi;
  const Loaded flat = load(folder, "law = \"gsab\"\noblique_db = -21\noblique_exponent = 1");
  EXPECT_NEAR(flat.db(30), -21 + 10 * std::log10(0.5), 1e-9);
  const Loaded table = load(folder, "law = \"table\"\ntable_grazing_deg = [10, 45]\ntable_db = [-35, -22]");
  EXPECT_NEAR(table.db(27.5), -28.5, 1e-9);
  folder.write("measured.csv", "# grazing, level\n\n 10 , -35\r\n45,-22\n");
  const Loaded file = load(folder, "law = \"table\"\ntable_file = \"measured.csv\"");
  for (const double grazing : {3.0, 10.0, 27.5, 45.0, 80.0})
    EXPECT_EQ(file.db(grazing), table.db(grazing)) << grazing;
}

TEST(ScatteringKeys, SensorsOutsideASedimentsFrequencyAreWarnedOf) {
  const TestFolder folder;  // a camera of 1800 kHz
  const Loaded far = load(folder, "law = \"sediment\"\nsediment = \"coarse sand\"");
  EXPECT_NEAR(far.db(30), -14.97, 1e-9);
  EXPECT_THAT(far.warnings,
              ElementsAre("material 'sand' uses the table of 'coarse sand' at 300 kHz, but sensor 'camera' "
                          "works at 1800 kHz: the table is meant for 200 to 450 kHz"));
  SceneDescription scene =
      read_scene(folder, scene_with_sand("law = \"sediment\"\nsediment = \"silt\"\nsediment_khz = 20"));
  std::vector<std::string> warnings;
  scene.sensors[0].kind.edit<DidsonDescription>().frequency_khz = 30;
  EXPECT_NEAR(10 * std::log10(load_scattering(scene, warnings)[0]->cross_section(90 * degree)), -1.55, 1e-9);
  EXPECT_TRUE(warnings.empty());
  scene.sensors[0].kind.edit<DidsonDescription>().frequency_khz = 12;
  load_scattering(scene, warnings);
  EXPECT_EQ(warnings.size(), 1u);
}

TEST(ScatteringKeys, EverySedimentKeepsTheEnergyBound) {
  const TestFolder folder;
  for (const char* sediment :
       {"rough rock", "rock", "cobble", "sandy gravel", "coarse sand", "medium sand", "fine sand", "silt"})
    for (const int khz : {20, 300})
      EXPECT_EQ(load_error(folder, fmt::format("law = \"sediment\"\nsediment = \"{}\"\nsediment_khz = {}",
                                               sediment, khz)),
                "");
}

TEST(ScatteringKeys, WhatScattersMoreThanItReceivesIsRefusedUnlessAllowed) {
  const TestFolder folder;
  const std::string bright = "law = \"gsab\"\noblique_db = -4.9";  // 10 log10(1 / pi) = -4.9715
  EXPECT_THAT(load_error(folder, bright), HasSubstr("scene.toml:1:1: material 'sand' scatters 1.02 times the "
                                                    "energy that it receives at a grazing angle of "));
  EXPECT_THAT(load_error(folder, bright), HasSubstr("unbounded = true"));
  EXPECT_EQ(load_error(folder, "law = \"gsab\"\noblique_db = -4.972"), "");
  const Loaded allowed = load(folder, bright + "\nunbounded = true");
  ASSERT_EQ(allowed.warnings.size(), 1u);
  EXPECT_THAT(allowed.warnings[0], HasSubstr("material 'sand' scatters 1.02 times"));
  // Lambert's law with specular reflection.
  const std::string shiny = "lambert_db = -6\nspecular_loss_db = 0.1";  // pi / 10^0.6 + 10^-0.01 = 1.766
  EXPECT_THAT(load_error(folder, shiny), HasSubstr("'specular_loss_db' must be at least 6.7599"));
  EXPECT_THAT(load_error(folder, shiny), HasSubstr("unbounded = true"));
  const Loaded shiny_allowed = load(folder, shiny + "\nunbounded = true");
  ASSERT_EQ(shiny_allowed.warnings.size(), 1u);
  EXPECT_THAT(shiny_allowed.warnings[0], HasSubstr("scatters and mirrors 1.77 times the energy"));
  // For a small exponent, energy conservation fails at low grazing angles.
  EXPECT_THAT(load_error(folder, "law = \"gsab\"\noblique_db = -12\noblique_exponent = 0"),
              HasSubstr("at a grazing angle of 0.1 degrees"));
  EXPECT_THAT(
      load_error(folder, "law = \"table\"\ntable_grazing_deg = [20, 40, 90]\ntable_db = [-12, 0, -12]"),
      HasSubstr("at a grazing angle of 40 degrees"));
}

TEST(ScatteringKeys, MistakesAreReportedWithTheirPlace) {
  const TestFolder folder;
  const auto expect = [&](std::string_view keys, std::string_view message) {
    EXPECT_THAT(scene_error(folder, scene_with_sand(keys)), HasSubstr(std::string(message))) << keys;
  };
  expect("law = \"lommel\"", "scene.toml:3:7");
  expect("specular_db = -3",
         "3:15: 'specular_db' belongs to law = \"gsab\", but this material has law = \"lambert\"");
  expect("law = \"gsab\"\nlambert_db = -20", "4:14: 'lambert_db' belongs to law = \"lambert\"");
  expect("law = \"gsab\"", "3:7: law = \"gsab\" needs 'specular_db', 'oblique_db' or 'transition_db'");
  expect("law = \"gsab\"\nspecular_db = -3", "4:15: 'specular_db' needs the key 'specular_width_deg'");
  expect("law = \"gsab\"\ntransition_width_deg = 3", "'transition_width_deg' needs the key 'transition_db'");
  expect("law = \"gsab\"\noblique_exponent = 3", "'oblique_exponent' needs the key 'oblique_db' as well");
  expect("law = \"gsab\"\noblique_db = -20\noblique_exponent = -1", "must be 0 to 10, not -1");
  expect("law = \"gsab\"\nspecular_db = -3\nspecular_width_deg = 0", "must be 0.1 to 90 degrees, not 0");
  expect("law = \"table\"",
         "3:7: law = \"table\" needs 'table_file', or 'table_grazing_deg' with 'table_db'");
  expect("law = \"table\"\ntable_db = [-3]", "'table_db' needs the key 'table_grazing_deg'");
  expect("law = \"table\"\ntable_db = [-3]\ntable_grazing_deg = [20, 30]", "1 levels for 2 angles");
  expect("law = \"table\"\ntable_db = [-3, -3]\ntable_grazing_deg = [30, 30]",
         "must increase: 30 follows 30");
  expect("law = \"table\"\ntable_db = [-3]\ntable_grazing_deg = [91]", "> 0, <= 90");
  expect("law = \"sediment\"", "3:7: law = \"sediment\" needs the key 'sediment'");
  expect("law = \"sediment\"\nsediment = \"granite\"", "4:12");
  expect("law = \"sediment\"\nsediment = \"silt\"\nsediment_khz = 100", "must be 20 or 300, not 100");
  expect("law = \"table\"\ntable_file = \"nowhere.csv\"", "nowhere.csv");
}

TEST(ScatteringKeys, TablesInFilesAreCheckedLineByLine) {
  const TestFolder folder;
  const auto expect = [&](std::string_view text, std::string_view message) {
    folder.write("t.csv", text);
    EXPECT_THAT(load_error(folder, "law = \"table\"\ntable_file = \"t.csv\""),
                HasSubstr(std::string(message)))
        << text;
  };
  expect("", "t.csv: has no row");
  expect("# only words\n", "has no row");
  expect("10,-20\nangle,level\n", "t.csv:2: the row is 'angle,level', expected a grazing angle");
  expect("10\n", "t.csv:1: the row is '10'");
  expect("10,-20,3\n", "t.csv:1: the row is");
  expect("10,nan\n", "t.csv:1: the row is");
  expect("0,-20\n", "t.csv:1: the grazing angle must be above 0 and at most 90 degrees, not 0");
  expect("10,-20\n95,-20\n", "t.csv:2: the grazing angle");
  expect("20,-20\n\n10,-20\n", "t.csv:3: grazing angles must increase: 10 follows 20");
  expect("20,-1000\n", "t.csv:1: the level must be from -300 to 100 dB, not -1000");
  std::string long_table;
  for (int k = 1; k <= 1001; ++k) long_table += fmt::format("{},-20\n", k * 0.08);
  expect(long_table, "t.csv:1001: the table has more than 1000 rows");
  EXPECT_THAT(
      load_error(folder,
                 "law = \"table\"\ntable_grazing_deg = [30, 30.000000000000004]\ntable_db = [-20, -20]"),
      HasSubstr("too close to each other"));
}

}  // namespace
}  // namespace tubefoot
