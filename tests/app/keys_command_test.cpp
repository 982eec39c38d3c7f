// SPDX-License-Identifier: GPL-3.0-or-later
// Tests the command `keys`.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <sstream>
#include <string>

#include "fixtures/program.hpp"
#include "sensors/kinds/scene_file.hpp"

namespace tubefoot {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::StartsWith;

std::string keys_of(const std::string& name) {
  const Outcome outcome = run_program({"keys", name});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_THAT(outcome.err, IsEmpty());
  return outcome.out;
}

void expect_narrow(const std::string& text) {
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    EXPECT_LE(line.size(), 100u) << line;
    EXPECT_FALSE(line.ends_with(' ')) << line;
  }
}

TEST(KeysCommand, PrintsAKeyWithAllItsProperties) {
  EXPECT_EQ(
      keys_of("temperature_c"),
      "[water]                     Sound speed and absorption of the water, which is isovelocity or\n"
      "                            stratified. Depths increase downwards from the sea surface.\n"
      "  temperature_c             number in degrees Celsius; default: 10; range: -2 to 30\n"
      "                            Temperature of the water.\n"
      "\n[processing.water]          Sound speed of the assumed water, with which the software of a sonar\n"
      "                            converts travel times to ranges and positions. The keys are those of\n"
      "                            '[water]', with the same defaults.\n"
      "  temperature_c             number in degrees Celsius; default: 10; range: -2 to 30\n"
      "                            Temperature of the water.\n");
}

TEST(KeysCommand, PrintsASectionWithItsKindsOrAKind) {
  const std::string terrain = keys_of("terrain");
  EXPECT_THAT(terrain,
              AllOf(StartsWith("[[terrain]] "), HasSubstr("\n[[terrain]] kind = \"flat\" "),
                    HasSubstr("\n  width_m                   number in metres; required; range: > 0, "
                              "<= 10000000\n"),
                    Not(HasSubstr("patch_size_m"))));
  EXPECT_EQ(keys_of("[[terrain]]"), terrain);
  const std::string multibeam = keys_of("multibeam");
  EXPECT_THAT(multibeam, AllOf(StartsWith("[[sensors]] kind = \"multibeam\"\n"), HasSubstr("  swath_deg "),
                               Not(HasSubstr("lever_arm_m"))));
  EXPECT_EQ(keys_of("kind = \"multibeam\""), multibeam);
  EXPECT_THAT(keys_of("relief"), AllOf(HasSubstr("[relief] "), HasSubstr("\n[[materials.relief]] ")));
  EXPECT_THAT(keys_of("title"), StartsWith("above all sections"));
  for (const std::string& text : {terrain, multibeam}) expect_narrow(text);
}

TEST(KeysCommand, PrintsAKeyOfAllKinds) {
  const std::string frequency = keys_of("frequency_khz");
  for (const char* kind : {"array", "didson", "sidescan", "scanning"})
    EXPECT_THAT(frequency, HasSubstr("kind = \"" + std::string(kind) + "\""));
  EXPECT_THAT(frequency, Not(HasSubstr("sampling_frequency_khz")));
  expect_narrow(frequency);
}

TEST(KeysCommand, FindsPartsOfNamesAndFormerNames) {
  EXPECT_THAT(keys_of("absorption"),
              AllOf(HasSubstr("  absorption_db_per_km"), HasSubstr("  tvg_absorption_db_per_km")));
  EXPECT_THAT(keys_of("staff_tilt_deg"), AllOf(HasSubstr("  receiver_pair_tilt_deg"),
                                               HasSubstr("The former name 'staff_tilt_deg' is deprecated.")));
}

TEST(KeysCommand, ListsAllSectionsAndKinds) {
  const Outcome outcome = run_program({"keys"});
  EXPECT_EQ(outcome.exit_code, 0);
  for (const SceneSection& section : scene_file_sections())
    EXPECT_THAT(outcome.out, HasSubstr(section.kind.empty() ? section.section : "\n  " + section.kind));
  expect_narrow(outcome.out);
}

TEST(KeysCommand, SuggestsANameForAMistypedOne) {
  const auto error_of = [](const char* name) {
    const Outcome outcome = run_program({"keys", name});
    EXPECT_EQ(outcome.exit_code, 2);
    EXPECT_THAT(outcome.out, IsEmpty());
    return outcome.err;
  };
  EXPECT_EQ(
      error_of("frequnecy_khz"),
      "tubefoot: no section, kind or key matches 'frequnecy_khz': did you mean 'frequency_khz'? 'tubefoot "
      "keys' lists the sections\n");
  EXPECT_THAT(error_of("watre"), HasSubstr("did you mean 'water'?"));
  EXPECT_THAT(error_of("multibaem"), HasSubstr("did you mean 'multibeam'?"));
  EXPECT_EQ(error_of("xyzzy"),
            "tubefoot: no section, kind or key matches 'xyzzy': 'tubefoot keys' lists the sections\n");
}

TEST(KeysCommand, WritesAllKeysAsJson) {
  const Outcome outcome = run_program({"keys", "--json"});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  std::size_t keys = 0;
  const nlohmann::json all = nlohmann::json::parse(outcome.out);
  for (const nlohmann::json& section : all.at("sections")) {
    EXPECT_NE(section.at("meaning"), "");
    for (const nlohmann::json& key : section.at("keys")) {
      for (const char* property : {"name", "type", "unit", "default", "range", "meaning"})
        EXPECT_TRUE(key.at(property).is_string()) << key;
      ++keys;
    }
  }
  EXPECT_EQ(keys, scene_file_keys().size());

  const nlohmann::json one = nlohmann::json::parse(run_program({"keys", "munk_axis_m", "--json"}).out);
  EXPECT_EQ(one.at("sections").size(), 2u);
  EXPECT_EQ(one.at("sections").at(0).at("section"), "[water]");
  EXPECT_EQ(one.at("sections").at(1).at("section"), "[processing.water]");
  EXPECT_EQ(one.at("sections").at(0).at("keys").at(0).at("default"), "1300");
}

}  // namespace
}  // namespace tubefoot
