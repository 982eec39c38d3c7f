// SPDX-License-Identifier: GPL-3.0-or-later
// Tests work-precision curves: orders of convergence, costs between and beyond trials, the cheapest engine,
// crossings, and the chart page.

#include "study/work_precision.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <set>
#include <string>

#include "fixtures/test_folder.hpp"
#include "study/chart_page.hpp"
#include "study/svg_png.hpp"

namespace tubefoot {
namespace {

/// A sampling engine whose error is scale * samples^order and whose ray costs a microsecond.
std::vector<Trial> ladder(const std::string& engine, double scale, double order, double most = 1e6) {
  std::vector<Trial> trials;
  for (double n = 100; n <= most; n *= 10) {
    Trial t;
    t.scene = "bed";
    t.engine = engine;
    t.setting = "N";
    t.samples = n;
    t.work = {1e-6 * n, 0.8e-6 * n, 4000 * n};
    t.l1_error = scale * std::pow(n, order);
    t.rms_db_error = 20 * t.l1_error;
    t.bound = 1e-9;
    trials.push_back(t);
  }
  return trials;
}

Trial exact(double seconds, double l1) {
  Trial t;
  t.scene = "bed";
  t.engine = "tube";
  t.setting = "fixed";
  t.work = {seconds, 0.8 * seconds, 4e9 * seconds};
  t.l1_error = l1;
  t.rms_db_error = 20 * l1;
  t.bound = 1e-9;
  return t;
}

TEST(WorkPrecision, FindsTheOrderOfAPowerLaw) {
  const auto rays = ladder("rays", 3, -0.5);
  EXPECT_NEAR(*convergence_order(rays, ErrorMeasure::l1, 0), -0.5, 1e-12);
  EXPECT_NEAR(*convergence_order(rays, ErrorMeasure::rms_db, 0), -0.5, 1e-12);
  EXPECT_FALSE(convergence_order(std::vector<Trial>(rays.begin(), rays.begin() + 2), ErrorMeasure::l1, 0));
  EXPECT_FALSE(convergence_order(rays, ErrorMeasure::l1, 0.02)) << "only two errors are above that";
  EXPECT_FALSE(convergence_order(std::vector<Trial>(5, exact(1, 1e-9)), ErrorMeasure::l1, 0));
}

TEST(WorkPrecision, CostFollowsThePowerLawBetweenAndBeyondTrials) {
  const auto rays = ladder("rays", 3, -0.5);
  for (const double error : {0.2, 0.05, 0.003, 1e-4}) {
    const auto cost = cost_of(rays, ErrorMeasure::l1, error);
    ASSERT_TRUE(cost);
    EXPECT_NEAR(cost->amount / (1e-6 * std::pow(3 / error, 2)), 1, 1e-9) << error;
    EXPECT_EQ(cost->extrapolated, error < 0.003);
  }
  EXPECT_DOUBLE_EQ(cost_of(rays, ErrorMeasure::l1, 0.9)->amount, 1e-4)
      << "the coarsest setting is good enough";
}

TEST(WorkPrecision, WorkIsTheClocksTheProcessorsOrInstructionsAsRequested) {
  const auto rays = ladder("rays", 3, -0.5);
  const double clock = cost_of(rays, ErrorMeasure::l1, 0.01)->amount;
  EXPECT_NEAR(cost_of(rays, ErrorMeasure::l1, 0.01, WorkMeasure::processor_seconds)->amount, 0.8 * clock,
              1e-9 * clock);
  EXPECT_NEAR(cost_of(rays, ErrorMeasure::l1, 0.01, WorkMeasure::instructions)->amount, 4e9 * clock,
              1 * clock);

  // The machine was busy while the tubes ran: the clock has twice their processor time.
  std::vector<Trial> all = rays;
  all.push_back(exact(0.02, 0));
  all.back().work.seconds *= 2;
  const SceneVerdict busy = verdict_of("bed", all), steady = verdict_of("bed", all, steadiest_measure(all));
  EXPECT_NEAR(*steady.ray_over_tube_at_l1 / *busy.ray_over_tube_at_l1, 2, 1e-9);
  EXPECT_GT(busy.crossing_l1, 0);
  EXPECT_GT(steady.crossing_l1, busy.crossing_l1) << "rays are the cheaper choice for fewer errors";
  EXPECT_EQ(steady.work, WorkMeasure::instructions);
}

TEST(WorkPrecision, InstructionsAreTheMeasureWhereAllTrialsHaveThem) {
  std::vector<Trial> all = ladder("rays", 3, -0.5);
  EXPECT_EQ(steadiest_measure(all), WorkMeasure::instructions);
  EXPECT_EQ(name_of(steadiest_measure(all)), "instructions");
  EXPECT_THAT(to_csv(all), testing::HasSubstr(",8e-05,400000\n"));
  all.front().work.instructions = 0;
  EXPECT_EQ(steadiest_measure(all), WorkMeasure::processor_seconds);
  EXPECT_THAT(to_csv(all), testing::HasSubstr(",8e-05,\n"));
  EXPECT_THAT(to_html(all, ""), testing::HasSubstr("processor time"));
}

TEST(WorkPrecision, ALuckyCoarseSettingDoesNotCount) {
  auto rays = ladder("rays", 3, -0.5);
  rays[0].l1_error = 1e-6;
  EXPECT_NEAR(cost_of(rays, ErrorMeasure::l1, 0.01)->amount, 0.09, 1e-9);
}

TEST(WorkPrecision, AnEngineThatDoesNotConvergeReachesNothing) {
  EXPECT_FALSE(cost_of(ladder("column", 0.3, 0), ErrorMeasure::l1, 0.1));
  EXPECT_FALSE(cost_of(std::vector<Trial>{exact(1, 0.01)}, ErrorMeasure::l1, 0.001));
}

TEST(WorkPrecision, TheCheapestEngineCounts) {
  auto trials = ladder("slow", 30, -0.5);
  const auto fast = ladder("fast", 3, -0.75);
  trials.insert(trials.end(), fast.begin(), fast.end());
  EXPECT_NEAR(cost_of(trials, ErrorMeasure::l1, 0.01)->amount, 1e-6 * std::pow(300, 4 / 3.0), 1e-9);
}

TEST(WorkPrecision, CrossingIsWhereTheCostsMeet) {
  const auto rays = ladder("rays", 3, -0.5);
  // 0.09 s give the rays an error of 0.01.
  EXPECT_NEAR(crossing_error(std::vector<Trial>{exact(0.09, 1e-10)}, rays, ErrorMeasure::l1), 0.01, 0.0005);
  EXPECT_EQ(crossing_error(std::vector<Trial>{exact(1e-5, 1e-10)}, rays, ErrorMeasure::l1), 1);
  EXPECT_EQ(crossing_error(std::vector<Trial>{exact(0.09, 0.5)}, rays, ErrorMeasure::l1), 0)
      << "the exact side reaches 0.5 only, where rays are far cheaper";
}

TEST(ChartPage, VerdictsAreRatiosAtTheRequestedErrors) {
  auto trials = ladder("rays", 3, -0.5);
  trials.push_back(exact(0.01, 1e-10));
  const SceneVerdict v = verdict_of("bed", trials);
  EXPECT_NEAR(*v.ray_over_tube_at_l1 / (1e-6 * 9e6 / 0.01), 1, 1e-9);
  EXPECT_TRUE(v.l1_extrapolated);
  EXPECT_NEAR(*v.ray_over_tube_at_db / (1e-6 * std::pow(60 / 0.1, 2) / 0.01), 1, 1e-9);
  EXPECT_FALSE(v.db_extrapolated);
  EXPECT_NEAR(v.crossing_l1, 0.03, 0.002);
  Trial unsafe = exact(1e-9, 1e-10);  // cheap, but not a valid choice
  unsafe.counts = false;
  trials.push_back(unsafe);
  EXPECT_NEAR(verdict_of("bed", trials).crossing_l1, 0.03, 0.002);
}

TEST(ChartPage, RowsAreTrials) {
  Trial t = exact(0.5, 1e-3);
  t.setting = "a, \"b\"";
  EXPECT_EQ(to_csv(std::vector<Trial>{t}),
            "scene,engine,setting,l1_error,rms_db_error,seconds,bound,processor_seconds,instructions\n"
            "bed,tube,\"a, \"\"b\"\"\",0.001,0.02,0.5,1e-09,0.4,2000000000\n");
}

TEST(ChartPage, LinearAxesHoldNegativeNumbers) {
  Diagram diagram;
  diagram.scale = Scale::linear;
  diagram.series.push_back({"track", "", {{-0.5, -12}, {0, 3}, {2.5, 38}}, true});
  const std::string svg = to_svg(diagram);
  for (const char* tick : {">-0.5<", ">2.5<", ">-20<", ">40<"})
    EXPECT_NE(svg.find(tick), std::string::npos) << tick;
  EXPECT_EQ(svg.find(">60<"), std::string::npos);
  EXPECT_EQ(svg.find("nan"), std::string::npos);
}

// The chart has ten engines.
TEST(ChartPage, SeriesDifferInColourAndInLineOrMarker) {
  Diagram diagram;
  diagram.scale = Scale::linear;
  constexpr std::size_t count = 12;
  for (std::size_t s = 0; s < count; ++s)
    diagram.series.push_back({fmt::format("series {}", s), "", {{0, double(s)}, {1, double(s)}}, true});
  const std::string svg = to_svg(diagram);
  std::set<std::string> colours;
  for (std::size_t s = 0; s < count; ++s) colours.insert(series_colour(s));
  EXPECT_EQ(colours.size(), count);
  for (const std::string& colour : colours) EXPECT_NE(svg.find(colour), std::string::npos);
  for (const char* part : {"<circle", "<polygon", "stroke-dasharray=\"7 3\"", "stroke-dasharray=\"2 2.5\""})
    EXPECT_NE(svg.find(part), std::string::npos) << part;
}

TEST(ChartPage, DrawsWhatItIsGivenAndEscapesNames) {
  auto trials = ladder("rays <random> & \"co\"", 3, -0.5);
  trials.push_back(exact(0.01, 0));
  const std::string svg = to_svg(work_precision_plot("bed", trials, ErrorMeasure::l1));
  EXPECT_NE(svg.find("rays &lt;random&gt; &amp; &quot;co&quot;"), std::string::npos);
  EXPECT_NE(svg.find("order -0.50 in rays"), std::string::npos);
  EXPECT_NE(svg.find("bound of the reference"), std::string::npos);
  EXPECT_NE(svg.find("fill=\"white\" stroke=\"#d55e00\""), std::string::npos) << "below the bound: hollow";
  EXPECT_EQ(svg.find("inf"), std::string::npos);
  EXPECT_EQ(svg.find("nan"), std::string::npos);
  const TestFolder folder;
  const std::filesystem::path file = folder / "plot.png";
  write_png_of_svg(svg, file);
  EXPECT_GT(std::filesystem::file_size(file), 5000u);
  EXPECT_THROW(write_png_of_svg(svg, "/nowhere/plot.png"), std::runtime_error);
  EXPECT_THROW(write_png_of_svg("no drawing", file), std::runtime_error);
  const std::string html = to_html(trials, "Made by a test.");
  EXPECT_NE(html.find("Made by a test."), std::string::npos);
  EXPECT_EQ(html.find("http://"), html.find("http://www.w3.org/2000/svg")) << "nothing is fetched";
}

}  // namespace
}  // namespace tubefoot
