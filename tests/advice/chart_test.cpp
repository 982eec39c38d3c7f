// SPDX-License-Identifier: GPL-3.0-or-later
// Tests the data of the chart: the output of `tubefoot chart` for small scenes, and the convergence of rays
// to the reference.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <sstream>

#include "fixtures/program.hpp"
#include "fixtures/scene_texts.hpp"

namespace tubefoot {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::UnorderedElementsAre;

/// A slope behind a step, hidden in part, in a few long range bins, so that many rays meet each bin.
constexpr std::string_view scene = R"(title = "Step"
[water]
absorption_db_per_km = 200
[[materials]]
name = "sand"
[[terrain]]
kind = "flat"
width_m = 30
length_m = 30
[[objects]]
name = "step"
shape = "box"
size_m = [1.1, 0.7, 0.6]
position_m = [0.2, 1, 0.3]
heading_deg = 20
[trajectory]
kind = "fixed"
position_m = [0, -5, 2.5]
[[sensors]]
name = "camera"
kind = "didson"
beams = 4
horizontal_deg = 8
vertical_deg = 16
tilt_deg = 22
samples = 24
window_start_m = 4
window_length_m = 7
)";

struct Row {
  std::string engine, setting;
  double l1 = 0, db = 0, seconds = 0, bound = 0, processor_seconds = 0;
  std::string instructions;
};

/// Splits a line of CSV and removes quotes.
std::vector<std::string> fields_of(const std::string& line) {
  std::vector<std::string> fields(1);
  bool quoted = false;
  for (const char c : line) {
    if (c == '"')
      quoted = !quoted;
    else if (c == ',' && !quoted)
      fields.emplace_back();
    else
      fields.back() += c;
  }
  return fields;
}

/// Rays per beam, from "1500 per beam".
double rays_of(const Row& row) { return std::stod(row.setting); }

/// Slope of log l1 over log rays, by least squares, over settings from `fewest` rays per beam on.
double order(const std::vector<Row>& rows, double fewest) {
  double n = 0, x = 0, y = 0, xx = 0, xy = 0;
  for (const Row& row : rows) {
    if (rays_of(row) < fewest) continue;
    const double lx = std::log(rays_of(row)), ly = std::log(row.l1);
    n += 1, x += lx, y += ly, xx += lx * lx, xy += lx * ly;
  }
  EXPECT_GE(n, 5);
  return (n * xy - x * y) / (n * xx - x * x);
}

/// Runs the command once for all tests of its output.
struct Chart : testing::Test {
  static void SetUpTestSuite() {
    folder = std::make_unique<TestFolder>();
    folder->write("step.toml", scene);
    outcome = run_program({"chart", (*folder / "step.toml").string(), "-o", (*folder / "out").string(),
                           "--seconds", "1000", "--repeats", "1", "--quiet"});
    if (outcome.exit_code != 0) return;
    std::istringstream csv(bytes_of(*folder / "out" / "chart.csv"));
    std::getline(csv, header);
    for (std::string line; std::getline(csv, line);) {
      const std::vector<std::string> f = fields_of(line);
      ASSERT_EQ(f.size(), 9u) << line;
      EXPECT_EQ(f[0], "step");
      rows[f[1]].push_back({f[1], f[2], std::stod(f[3]), std::stod(f[4]), std::stod(f[5]), std::stod(f[6]),
                            std::stod(f[7]), f[8]});
    }
  }
  static void TearDownTestSuite() { folder.reset(); }
  void SetUp() override { ASSERT_EQ(outcome.exit_code, 0) << outcome.err; }

  static std::unique_ptr<TestFolder> folder;
  static Outcome outcome;
  static std::string header;
  static std::map<std::string, std::vector<Row>> rows;
};
std::unique_ptr<TestFolder> Chart::folder;
Outcome Chart::outcome;
std::string Chart::header;
std::map<std::string, std::vector<Row>> Chart::rows;

TEST_F(Chart, WritesEveryEngineInARowASetting) {
  EXPECT_EQ(header,
            "scene,engine,setting,l1_error,rms_db_error,seconds,bound,processor_seconds,instructions");
  std::map<std::string, std::size_t> settings;
  for (const auto& [engine, own] : rows) settings[engine] = own.size();
  EXPECT_THAT(settings, UnorderedElementsAre(
                            std::pair{"tubes, exact cuts", 4u}, std::pair{"tubes, double", 2u},
                            std::pair{"tubes, spread", 1u}, std::pair{"tubes, centroid", 1u},
                            std::pair{"rays, stratified", 11u}, std::pair{"rays, sobol", 11u},
                            std::pair{"rays, adaptive", 11u}, std::pair{"rays, regular", 11u},
                            std::pair{"rays, random", 11u}, std::pair{"rays, one column per beam", 11u}));
  // The settings of existing simulators are among the steps.
  std::set<std::string> rungs;
  for (const Row& row : rows["rays, random"]) rungs.insert(row.setting);
  for (const char* rays : {"1", "11", "23", "114", "1500", "17000"})
    EXPECT_TRUE(rungs.count(std::string(rays) + " per beam")) << rays;
  for (const auto& [engine, own] : rows)
    for (const Row& row : own) {
      EXPECT_GT(row.seconds, 0) << engine << ", " << row.setting;
      EXPECT_GT(row.processor_seconds, 0) << engine << ", " << row.setting;
      // The run has one thread. The clock of the processor is coarser on some machines.
      EXPECT_LT(row.processor_seconds, 1.05 * row.seconds + 0.01) << engine << ", " << row.setting;
      if (!row.instructions.empty()) {
        EXPECT_GT(std::stod(row.instructions), 0) << row.setting;
      }
      EXPECT_GE(row.l1, 0) << engine << ", " << row.setting;
      EXPECT_LE(row.db, 30) << engine << ", " << row.setting;
      EXPECT_GT(row.bound, 0);
      EXPECT_LT(row.bound, 1e-6);
    }
}

TEST_F(Chart, ExactTubesLieAtTheReference) {
  for (const Row& row : rows["tubes, exact cuts"]) {
    EXPECT_LT(row.l1, 1e-9) << row.setting;
    EXPECT_LT(row.db, 1e-8) << row.setting;
  }
  for (const Row& row : rows["tubes, centroid"])
    EXPECT_GT(row.l1, 1e-3) << "facets are far longer than samples";
}

TEST_F(Chart, RandomRaysConvergeToTheReferenceAsTheSquareRoot) {
  const std::vector<Row>& random = rows["rays, random"];
  const double slope = order(random, 100);
  EXPECT_GT(slope, -0.6);
  EXPECT_LT(slope, -0.4);
  // If the error of the reference exceeded this, the error of the rays would stop falling earlier.
  EXPECT_LT(random.back().l1, 3e-3);
}

TEST_F(Chart, StratifiedRaysConvergeFaster) {
  const double slope = order(rows["rays, stratified"], 100);
  EXPECT_LT(slope, order(rows["rays, random"], 100) - 0.1);
  EXPECT_GT(slope, -1.05);  // a boundary through cells of side N^-1/2 permits at most N^-3/4 on average
  EXPECT_LT(rows["rays, stratified"].back().l1, rows["rays, random"].back().l1 / 3);
}

// Sobol rays converge like stratified ones. A smaller error is only promised for powers of two, which the
// steps do not contain.
TEST_F(Chart, SobolRaysConvergeFaster) {
  EXPECT_LT(order(rows["rays, sobol"], 100), order(rows["rays, random"], 100) - 0.1);
  EXPECT_LT(rows["rays, sobol"].back().l1, rows["rays, random"].back().l1 / 3);
}

TEST_F(Chart, AdaptiveRaysAreAheadOfStratifiedOnes) {
  EXPECT_LT(order(rows["rays, adaptive"], 100), order(rows["rays, random"], 100) - 0.1);
  EXPECT_LT(rows["rays, adaptive"].back().l1, 0.8 * rows["rays, stratified"].back().l1);
}

TEST_F(Chart, WritesPageAndPictures) {
  EXPECT_THAT(names_below(*folder / "out"),
              UnorderedElementsAre(".tubefoot-files", "chart.csv", "index.html", "step-l1.svg", "step-l1.png",
                                   "step-rms-db.svg", "step-rms-db.png"));
  const std::string page = bytes_of(*folder / "out" / "index.html"),
                    svg = bytes_of(*folder / "out" / "step-l1.svg");
  EXPECT_THAT(page, HasSubstr("</html>"));
  EXPECT_THAT(page, HasSubstr("rays, stratified"));
  EXPECT_THAT(svg, HasSubstr("<svg"));
  EXPECT_THAT(svg, HasSubstr("order -0."));
  for (const char* png : {"step-l1.png", "step-rms-db.png"})
    EXPECT_EQ(bytes_of(*folder / "out" / png).substr(0, 8), "\x89PNG\r\n\x1a\n");
  EXPECT_THAT(outcome.out, HasSubstr("rays/tubes"));
  EXPECT_THAT(outcome.out, testing::ContainsRegex("\nstep +seconds "));
  EXPECT_THAT(outcome.out, testing::ContainsRegex("\nstep +(processor time|instructions) "));
  EXPECT_THAT(outcome.out, HasSubstr("chart.csv"));
}

/// Returns the error message of a command line that must fail without output files.
std::string refusal(const TestFolder& folder, const std::vector<std::string>& scenes) {
  const std::set<std::string> before = names_below(folder.path());
  std::vector<std::string> words{"chart"};
  words.insert(words.end(), scenes.begin(), scenes.end());
  for (const char* word : {"--seconds", "0.01", "--repeats", "1", "--quiet", "-o"}) words.emplace_back(word);
  words.push_back((folder / "out").string());
  const Outcome outcome = run_program(words);
  EXPECT_EQ(outcome.exit_code, 2) << outcome.err;
  EXPECT_THAT(outcome.out, IsEmpty());
  EXPECT_EQ(names_below(folder.path()), before);
  return outcome.err;
}

TEST(ChartErrors, ScenesOfOneNameAreRefused) {
  const TestFolder folder;
  std::filesystem::create_directory(folder / "other");
  folder.write("step.toml", scene);
  folder.write("other/step.toml", scene);
  EXPECT_THAT(refusal(folder, {(folder / "step.toml").string(), (folder / "other/step.toml").string()}),
              HasSubstr("two scenes have the name 'step'"));
}

TEST(ChartErrors, AMissingOrWrongSceneIsNamed) {
  const TestFolder folder;
  folder.write("step.toml", scene);
  folder.write("wrong.toml", replaced(scene, "tilt_deg", "tild_deg"));
  EXPECT_THAT(refusal(folder, {(folder / "nowhere.toml").string()}), HasSubstr("nowhere.toml"));
  // Also after another scene was computed.
  EXPECT_THAT(refusal(folder, {(folder / "step.toml").string(), (folder / "wrong.toml").string()}),
              HasSubstr("did you mean 'tilt_deg'?"));
}

TEST(ChartErrors, NoSceneAtAllIsRefused) {
  const TestFolder folder;
  EXPECT_THAT(refusal(folder, {}), HasSubstr("SCENE"));
}

}  // namespace
}  // namespace tubefoot
