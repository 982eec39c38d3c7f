// SPDX-License-Identifier: GPL-3.0-or-later
// Tests that each kind of sensor is one file. No other part of the program contains the name of a kind or
// of its types.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <regex>
#include <set>
#include <string>

#include "scene/file/sensor_presets.hpp"
#include "sensors/recordings/sensor_kind.hpp"

namespace tubefoot {
namespace {

namespace fs = std::filesystem;

/// Returns the line without its "//" comment.
std::string code_of(const std::string& line) { return line.substr(0, line.find("//")); }

std::vector<std::string> lines_with(const std::regex& words) {
  std::vector<std::string> found;
  const std::set<std::string> code{".cpp", ".hpp", ".js", ".py", ".pyi", ".html"};
  for (const char* folder : {"geometry", "src", "sensors", "python/native", "python/tubefoot"})
    for (const fs::directory_entry& entry :
         fs::recursive_directory_iterator(fs::path(TUBEFOOT_SOURCE_DIR) / folder)) {
      if (!code.contains(entry.path().extension()) || entry.path().filename().string().starts_with("kind_"))
        continue;
      std::ifstream in(entry.path());
      int number = 0;
      for (std::string line; std::getline(in, line);) {
        ++number;
        if (std::regex_search(code_of(line), words))
          found.push_back(entry.path().string() + ":" + std::to_string(number) + ": " + line);
      }
    }
  return found;
}

TEST(SensorKinds, AreNamedInTheirOwnFilesAlone) {
  ASSERT_GE(sensor_kinds().size(), 6u);
  for (const SensorSection* kind : sensor_kinds()) {
    const std::string& name = kind->name();
    std::string type = name;
    type.front() = static_cast<char>(std::toupper(static_cast<unsigned char>(type.front())));
    // Types called Array also represent other arrays.
    const bool has_many_meanings = name == "array";
    const std::regex words("[\"']" + name + "[\"']|\\b" + type + "(Description|Kind)" +
                           (has_many_meanings ? "" : "?") + "\\b|\\b" + name + "_kind\\b|kind_" + name);
    EXPECT_THAT(lines_with(words), testing::IsEmpty()) << name;
    std::ifstream own(fs::path(TUBEFOOT_SOURCE_DIR) / "sensors" / "kinds" / ("kind_" + name + ".cpp"));
    EXPECT_TRUE(own) << "no file of its own: " << name;
  }
}

TEST(SensorKinds, AreThereByName) {
  std::vector<std::string> names;
  for (const SensorSection* kind : sensor_kinds()) names.push_back(kind->name());
  EXPECT_TRUE(std::ranges::is_sorted(names));
  EXPECT_THAT(names, testing::Contains("didson"));
}

TEST(SensorKinds, HoldKeysOfTheirOwnTypeOnly) {
  struct Other {
    static const SensorSection& kind() { return *sensor_kinds().front(); }
  };
  SensorDescription sensor;
  EXPECT_THROW(kind_of(sensor), std::logic_error);
  sensor.kind = Other();
  EXPECT_EQ(kind_of(sensor).name(), sensor_kinds().front()->name());
  EXPECT_NO_THROW(sensor.kind.as<Other>());
  EXPECT_THROW(sensor.kind.as<int>(), std::logic_error);
  EXPECT_THROW(kind_of(sensor).figures(sensor), std::logic_error);
}

TEST(SensorKinds, ACopySKeysStayWhenTheOthersAreEdited) {
  struct Keys {
    int value = 1;
    static const SensorSection& kind() { return *sensor_kinds().front(); }
  };
  SensorKeys first = Keys();
  SensorKeys second = first;
  second.edit<Keys>().value = 2;
  EXPECT_EQ(first.as<Keys>().value, 1);
  EXPECT_EQ(second.as<Keys>().value, 2);
  EXPECT_EQ(&second.as<Keys>(), &SensorKeys(second).as<Keys>()) << "copies share";
}

TEST(SensorPresets, SayWhichSonarTheyAreAndWhereTheirFiguresComeFrom) {
  ASSERT_GE(sensor_presets().size(), 14u);
  for (const SensorPreset& preset : sensor_presets()) {
    SCOPED_TRACE(preset.name);
    EXPECT_THAT(preset.text, testing::StartsWith("# "));
    EXPECT_THAT(preset.text, testing::HasSubstr("\n# source: "));
    EXPECT_GT(preset.title().size(), 10u);
    EXPECT_GT(preset.source().size(), 10u);
  }
}

}  // namespace
}  // namespace tubefoot
