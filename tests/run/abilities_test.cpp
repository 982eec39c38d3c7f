// SPDX-License-Identifier: GPL-3.0-or-later
// Tests the table of feature combinations. docs/limits.md shows this table, and all commands report the
// same about the same scene.
#include "run/abilities.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <set>
#include <sstream>

#include "fixtures/program.hpp"
#include "fixtures/scene_texts.hpp"

namespace tubefoot {
namespace {

using testing::HasSubstr;
using testing::Not;

std::string page_of_the_table() {
  std::string page = "| feature | combined with | reason for the rejection |\n|---|---|---|\n";
  for (const Refusal& refusal : refusals()) {
    std::string with(name_of(refusal.second));
    for (const auto& feature : refusal.more)
      if (feature) with += fmt::format(", {}", name_of(*feature));
    page += fmt::format("| {} | {} | {} |\n", name_of(refusal.first), with, refusal.reason);
  }
  return page;
}

TEST(Abilities, ArePagedAsTheyAre) {
  std::ifstream file(TUBEFOOT_SOURCE_DIR "/docs/limits.md");
  std::stringstream text;
  text << file.rdbuf();
  EXPECT_THAT(text.str(), HasSubstr(page_of_the_table())) << page_of_the_table();
}

// A reference of two receivers in stratified water runs, except over mirrors. The page of sensors states
// the same.
TEST(Abilities, TheSensorsPageSaysWhichReferencesOfTwoReceiversThereAre) {
  const auto rejects = [](std::set<Feature> features) {
    return std::ranges::any_of(refusals(), [&](const Refusal& refusal) {
      return features.contains(refusal.first) && features.contains(refusal.second) &&
             std::ranges::all_of(refusal.more,
                                 [&](const auto& more) { return !more || features.contains(*more); });
    });
  };
  EXPECT_FALSE(rejects({Feature::refraction, Feature::two_receivers, Feature::reference}));
  EXPECT_TRUE(rejects({Feature::refraction, Feature::two_receivers, Feature::reference, Feature::mirrors}));

  std::ifstream file(TUBEFOOT_SOURCE_DIR "/docs/sensors.md");
  const std::string page(std::istreambuf_iterator<char>(file), {});
  const std::size_t begin = page.find("## Interferometric sidescan"), end = page.find("\n## ", begin + 1);
  ASSERT_NE(end, std::string::npos);
  const std::string section = page.substr(begin, end - begin);
  EXPECT_THAT(section, Not(HasSubstr("refuses")));
  EXPECT_THAT(section, AllOf(HasSubstr("reference-results.md"), HasSubstr("limits.md")));
}

TEST(Abilities, EveryRefusalIsThereOnceAndSaysWhatToDo) {
  std::set<std::set<int>> seen;
  for (const Refusal& refusal : refusals()) {
    std::set<int> all{static_cast<int>(refusal.first), static_cast<int>(refusal.second)};
    for (const auto& feature : refusal.more)
      if (feature) all.insert(static_cast<int>(*feature));
    SCOPED_TRACE(refusal.reason);
    EXPECT_TRUE(seen.insert(all).second) << "said twice";
    EXPECT_FALSE(refusal.reason.empty());
    EXPECT_FALSE(refusal.reason.ends_with('.'));
  }
}

struct AbilitiesOf : testing::Test {
  TestFolder folder;
  Outcome tried(const std::string& scene, std::vector<std::string> words) {
    const std::filesystem::path file = folder.write("scene.toml", scene);
    words.insert(words.begin() + 1, file.string());
    return run_program(words);
  }
};

const std::string seabed =
    lambert_material("rock", -27) + flat_terrain(20, 20) + fixed_at(0, 0, 8) + R"([[sensors]]
name = "sonar"
kind = "imaging"
beams = 8
tilt_deg = 45
samples = 16
range_max_m = 15
)";

// The command `check` rejects each scene that `run` rejects, with the same message.
TEST_F(AbilitiesOf, CheckRefusesWhatRunWould) {
  for (const std::string& more :
       {std::string("[sea_surface]\nheight_m = 5\n"), std::string("[paths]\norder = 2\n")}) {
    SCOPED_TRACE(more);
    const Outcome check = tried(seabed + more, {"check"}),
                  run = tried(seabed + more, {"run", "-o", (folder / "out").string()});
    EXPECT_EQ(run.exit_code, 2) << run.err;
    EXPECT_EQ(check.exit_code, 2) << check.out;
    EXPECT_EQ(check.err, run.err);
  }
}

// The advice considers rays and fast binning also over mirrors and with a separate receiver.
TEST_F(AbilitiesOf, AdviceWeighsEverySetting) {
  for (const char* more : {"[sea_surface]\nheight_m = 20\n", "receiver_arm_m = [0, 1, 0]\n"}) {
    const Outcome advice = tried(seabed + more, {"advise", "--tolerance", "10%"});
    EXPECT_EQ(advice.exit_code, 0) << advice.err;
    EXPECT_THAT(advice.out, AllOf(HasSubstr("rays, stratified"), HasSubstr("tubes, centroid")));
    EXPECT_THAT(advice.out, Not(HasSubstr("leave out")));
  }
}

}  // namespace
}  // namespace tubefoot
