// SPDX-License-Identifier: GPL-3.0-or-later
// Tests the documentation of scene keys, and former names of keys.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <sstream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "fixtures/world/read_scenes.hpp"
#include "scene/file/scene_file_keys.hpp"
#include "sensors/kinds/kind_interferometric.hpp"
#include "sensors/kinds/scene_file.hpp"

namespace tubefoot {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

std::size_t words_of(const std::string& text) {
  std::istringstream words(text);
  std::size_t count = 0;
  for (std::string word; words >> word;) ++count;
  return count;
}

/// Sentences end with a period and a space.
std::vector<std::string> sentences_of(std::string text) {
  std::vector<std::string> sentences;
  for (std::size_t end; (end = text.find(". ")) != std::string::npos; text.erase(0, end + 2))
    sentences.push_back(text.substr(0, end));
  sentences.push_back(text);
  return sentences;
}

void expect_meaning(const std::string& meaning, const std::string& name) {
  SCOPED_TRACE(name + ": " + meaning);
  EXPECT_TRUE(meaning.ends_with('.'));
  EXPECT_LE(words_of(meaning), 45u);
  for (const std::string& sentence : sentences_of(meaning)) EXPECT_LE(words_of(sentence), 25u) << sentence;
  EXPECT_EQ(std::ranges::count(meaning, '`') % 2, 0) << "an open back quote";
  for (const char* path : {".md", ".cpp", ".hpp", "docs/", "src/"})
    EXPECT_EQ(meaning.find(path), std::string::npos) << "names a source file";
  EXPECT_TRUE(std::ranges::all_of(meaning, [](unsigned char c) { return c >= 0x20 && c < 0x7f; }))
      << "not ASCII";
}

TEST(SceneKeys, EveryKeyHasAShortMeaning) {
  const std::vector<SceneKey> keys = scene_file_keys();
  ASSERT_GT(keys.size(), 280u);
  for (const SceneKey& key : keys)
    expect_meaning(key.meaning, fmt::format("{} {} {}", key.section, key.kind, key.name));
}

TEST(SceneKeys, EverySectionAndKindHasAShortMeaning) {
  std::set<std::pair<std::string, std::string>> described, used;
  for (const SceneSection& section : scene_file_sections()) {
    expect_meaning(section.meaning, section.section + " " + section.kind);
    EXPECT_TRUE(described.insert({section.section, section.kind}).second);
  }
  for (const SceneKey& key : scene_file_keys()) used.insert({key.section, key.kind});
  EXPECT_TRUE(std::ranges::includes(described, used));
}

// A name between back quotes is a key, a section, a command, a value with a comment, or columns of a file.
TEST(SceneKeys, MeaningsNameKeysThatExist) {
  std::set<std::string> names;
  for (const SceneKey& key : scene_file_keys()) names.insert(key.name);
  for (const SceneKey& key : scene_file_keys()) {
    std::string rest = key.meaning;
    for (std::size_t begin; (begin = rest.find('`')) != std::string::npos;) {
      const std::size_t end = rest.find('`', begin + 1);
      const std::string quoted = rest.substr(begin + 1, end - begin - 1);
      rest.erase(0, end + 1);
      if (quoted.find_first_of(" ,[{.\"") != std::string::npos) continue;
      EXPECT_TRUE(names.contains(quoted)) << key.name << " names " << quoted;
    }
  }
}

constexpr std::string_view interferometric_scene = R"([[materials]]
name = "sand"
[[terrain]]
kind = "flat"
width_m = 20
length_m = 20
[trajectory]
kind = "fixed"
[[sensors]]
name = "sonar"
)";

SceneDescription with_sensor_keys(const std::string& keys) {
  return read_scene_text(std::string(interferometric_scene) + keys, "scene.toml");
}

double tilt_of(const SceneDescription& scene) {
  return scene.sensors.front().kind.as<InterferometricDescription>().receiver_pair_tilt_deg;
}

TEST(FormerNamesOfKeys, KeepTheirMeaningWithAWarning) {
  const SceneDescription present =
      with_sensor_keys("kind = \"interferometric\"\nreceiver_pair_tilt_deg = 12\n");
  EXPECT_EQ(tilt_of(present), 12);
  EXPECT_THAT(present.warnings, IsEmpty());
  const SceneDescription former = with_sensor_keys("kind = \"interferometric\"\nstaff_tilt_deg = 12\n");
  EXPECT_EQ(tilt_of(former), 12);
  EXPECT_THAT(former.warnings, ElementsAre("scene.toml:12:1: the key 'staff_tilt_deg' is deprecated: use "
                                           "'receiver_pair_tilt_deg'"));
}

TEST(FormerNamesOfKeys, OverrideAPreset) {
  EXPECT_EQ(tilt_of(with_sensor_keys("preset = \"geoswath-250\"\n")), 30);
  const SceneDescription former = with_sensor_keys("preset = \"geoswath-250\"\nstaff_tilt_deg = 12\n");
  EXPECT_EQ(tilt_of(former), 12);
  EXPECT_EQ(former.warnings.size(), 1u);
}

TEST(FormerNamesOfKeys, KeepTheirPlaceInMessages) {
  const TestFolder folder;
  const auto error_of = [&](const std::string& keys) {
    return scene_error(folder, std::string(interferometric_scene) + keys);
  };
  EXPECT_THAT(
      error_of("kind = \"interferometric\"\nstaff_tilt_deg = 91\n"),
      testing::StartsWith("scene.toml:12:18: 'receiver_pair_tilt_deg' must be -90 to 90 degrees, not 91"));
  EXPECT_EQ(
      error_of("kind = \"interferometric\"\nstaff_tilt_deg = 9\nreceiver_pair_tilt_deg = 9\n"),
      "scene.toml:12:1: 'staff_tilt_deg' is the former name of 'receiver_pair_tilt_deg', which is present "
      "too: remove 'staff_tilt_deg'");
  EXPECT_THAT(error_of("kind = \"sidescan\"\nstaff_tilt_deg = 9\n"),
              AllOf(testing::StartsWith("scene.toml:12:1: "), HasSubstr("kind = \"interferometric\"")));
}

}  // namespace
}  // namespace tubefoot
