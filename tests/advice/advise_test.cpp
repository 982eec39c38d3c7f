// SPDX-License-Identifier: GPL-3.0-or-later
// Tests the advice of `tubefoot advise`: the advised settings keep the tolerance on pings that the advice
// has not measured.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "advice/advice.hpp"
#include "fixtures/program.hpp"
#include "fixtures/scene_texts.hpp"
#include "run/settings.hpp"
#include "sensors/kinds/scene_file.hpp"
#include "validation/advise/unseen.hpp"

namespace tubefoot {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

const std::string small_camera = R"([[sensors]]
name = "camera"
kind = "didson"
tilt_deg = 25
horizontal_deg = 8
vertical_deg = 20
beams = 8
samples = 32
window_start_m = 2
window_length_m = 8
pings = 7
)";

const std::string sphere_and_box =
    lambert_material("sand", -27) + flat_terrain(30, 30) + ball_and_box() + R"([trajectory]
kind = "line"
start_m = [-0.5, 0, 2]
end_m = [-0.5, 1, 2]
)" + small_camera;

const std::string rough_seabed =
    lambert_material("sand", -27) +
    rough_terrain(16, 16, 0.1, "rms_height_m = 0.1\nlargest_wavelength_m = 4\nseed = 3\n") + R"([trajectory]
kind = "line"
start_m = [0, -6, 3]
end_m = [0, -4, 3]
)" + replaced(small_camera, "window_start_m = 2", "window_start_m = 3") +
    R"([[sensors]]
name = "sidescan"
kind = "sidescan"
samples = 24
along_track_deg = 2
depression_min_deg = 30
range_min_m = 2
range_max_m = 6
pings = 9
)";

Trial unseen(const Advice& advice, const SceneDescription& scene, const EngineSetting& setting) {
  return UnseenPings(scene, advice.sensors, 100).run(setting, 1);
}

struct Advise : testing::TestWithParam<std::string> {
  TestFolder folder;
  SceneDescription scene = read_scene_file(folder.write("scene.toml", GetParam()));
};

TEST_P(Advise, HoldsTheToleranceOnPingsItDidNotSee) {
  AdviceOptions options;
  options.quiet = true;
  options.trial_pings = 2;  // of 7 and 9, so that some are left
  for (const char* text : {"10%", "0.3dB", "1e-5"}) {
    const Tolerance tolerance = parse_tolerance(text);
    const Advice advice = advise(scene, tolerance, options);
    EXPECT_LE(error_of(unseen(advice, scene, advice.best().setting), tolerance.measure), tolerance.value)
        << text << ": " << advice.best().setting.engine << ", " << advice.best().setting.setting;
  }
}

// Checks all candidates that keep the tolerance, not only the cheapest on this machine. The time of rays
// does not matter.
TEST_P(Advise, EveryCandidateThatHoldsDoesSoOnPingsNotSeen) {
  AdviceOptions options;
  options.quiet = true;
  options.trial_pings = 2;  // of 7 and 9, so that some are left
  options.largest_cost = 100;
  const Tolerance tolerance = parse_tolerance("5%");
  const Advice advice = advise(scene, tolerance, options);
  int rays = 0;
  for (const Candidate& c : advice.candidates) {
    if (!advice.holds(c)) continue;
    rays += c.setting.run.engine == Engine::ray;
    EXPECT_LE(unseen(advice, scene, c.setting).l1_error, tolerance.value)
        << c.setting.engine << ", " << c.setting.setting;
  }
  EXPECT_GE(rays, 2) << "stratified and regular rays converge";
}

TEST_P(Advise, ATightToleranceTakesExactTubes) {
  AdviceOptions options;
  options.quiet = true;
  options.trial_pings = 2;  // of 7 and 9, so that some are left
  options.measure = false;
  for (const char* text : {"1e-6", "1e-4dB"}) {
    const Advice advice = advise(scene, parse_tolerance(text), options);
    EXPECT_EQ(advice.best().setting.run.engine, Engine::tube) << text;
    EXPECT_EQ(advice.best().setting.run.binning, Binning::exact) << text;
    EXPECT_EQ(advice.best().predicted_error, 0);
    for (const Candidate& c : advice.candidates)
      if (c.setting.run.engine == Engine::ray) {
        EXPECT_FALSE(c.tried);
        EXPECT_FALSE(c.note.empty());
      }
  }
}

// The pings of a sensor are selected together with their water.
TEST(AdviseThroughWater, TriesTubesWhereItRefracts) {
  const TestFolder folder;
  const SceneDescription scene = read_scene_file(
      folder.write("scene.toml",
                   "[water]\nprofile = \"gradient\"\nsound_speed_m_s = 1500\ngradient_per_s = -1\n"
                   "profile_bottom_m = 30\nsurface_height_m = 10\n" +
                       sphere_and_box));
  AdviceOptions options;
  options.quiet = true;
  options.trial_pings = 2;
  options.measure = false;
  options.samplings.clear();
  const Advice advice = advise(scene, parse_tolerance("10%"), options);
  ASSERT_FALSE(advice.candidates.empty());
  for (const Candidate& candidate : advice.candidates) EXPECT_TRUE(candidate.tried) << candidate.note;
}

INSTANTIATE_TEST_SUITE_P(SmallScenes, Advise, testing::Values(sphere_and_box, rough_seabed),
                         [](const auto& run) { return run.index == 0 ? "SphereAndBox" : "RoughBed"; });

/// Scenes in the repository with the tolerance of the test. Scenes with one ping are measured from other
/// positions.
struct ShippedScene {
  const char *file, *tolerance;
};

class AdviseShipped : public testing::TestWithParam<ShippedScene> {};

// Time grows at most in proportion to rays. A small number of rays thus implies a short time, on any
// machine.
TEST_P(AdviseShipped, RaysHoldOnUnseenPingsAndAreAtMostHalfAsManyAgainAsTheFewest) {
  const SceneDescription scene =
      read_scene_file(std::string(TUBEFOOT_SOURCE_DIR "/scenes/") + GetParam().file);
  const Tolerance tolerance = parse_tolerance(GetParam().tolerance);
  AdviceOptions options;
  options.quiet = true;
  options.largest_cost = 1e6;
  options.measure = false;
  options.samplings = {RaySampling::stratified};
  const Advice advice = advise(scene, tolerance, options);
  UnseenPings pings(scene, advice.sensors, 4);
  int tried = 0;
  for (const Candidate& c : advice.candidates) {
    if (!advice.holds(c)) continue;
    EXPECT_LE(error_of(pings.run(c.setting, 1), tolerance.measure), tolerance.value) << c.setting.setting;
    if (c.setting.run.engine != Engine::ray) continue;
    ++tried;
    const auto advised = static_cast<double>(c.setting.run.rays.rays);
    EXPECT_GT(error_of(pings.run(ray_setting(RaySampling::stratified,
                                             static_cast<std::int64_t>(advised / 1.5), pings.beams()),
                                 1),
                       tolerance.measure),
              tolerance.value)
        << advised << " rays a beam are more than half as many again as would do";
  }
  EXPECT_EQ(tried, 1);
}

INSTANTIATE_TEST_SUITE_P(Scenes, AdviseShipped,
                         testing::Values(ShippedScene{"chart/bowl.toml", "10%"},
                                         ShippedScene{"chart/box-and-wall.toml", "10%"},
                                         ShippedScene{"chart/flat-bed.toml", "3dB"},
                                         ShippedScene{"chart/sphere-on-plane.toml", "5%"},
                                         ShippedScene{"chart/fractal-terrain.toml", "5%"},
                                         ShippedScene{"survey/scene.toml", "5%"}));

// The seconds are given as data, so that the cheapest setting does not depend on this machine.
TEST(Cheapest, IsTheFastestThatHoldsByPredictionAndMeasurement) {
  Advice advice;
  advice.tolerance = parse_tolerance("1%");
  const auto add = [&](double predicted, double measured, double seconds) {
    Candidate& c = advice.candidates.emplace_back();
    c.predicted_error = predicted;
    c.predicted_seconds = 1;
    c.others.emplace();
    c.others->l1_error = measured;
    c.others->work.processor_seconds = seconds;
    c.others->work.seconds = 100 / seconds;  // by the clock, which depends on other processes
  };
  add(0, 0, 10);
  add(0.02, 0.001, 1);   // the prediction exceeds the tolerance
  add(0.005, 0.02, 2);   // the measurement exceeds the tolerance
  add(0.01, 0.01, 4);    // just within the tolerance
  add(0.005, 0.005, 5);  // within the tolerance, but slower
  add(0.001, 0.001, 3);
  advice.candidates.back().tried = false;
  EXPECT_EQ(cheapest(advice), 3u);
  advice.candidates[3].others->work.processor_seconds = 11;
  EXPECT_EQ(cheapest(advice), 4u);
  advice.candidates[4].others->work.processor_seconds = 12;
  EXPECT_EQ(cheapest(advice), 0u);
}

TEST(LookedAt, ProbesAndOthersAreSpreadOverTheRunAndApart) {
  const LookedAt many = looked_at(360, 2);
  EXPECT_THAT(many.probes, ElementsAre(45, 225));
  EXPECT_THAT(many.others, ElementsAre(135, 315));
  for (const std::size_t count : {1u, 2u, 5u})
    for (std::size_t pings = count + 1; pings < 20; ++pings) {
      const LookedAt some = looked_at(pings, count);
      EXPECT_EQ(some.probes.size(), count);
      EXPECT_EQ(some.others.size(), std::min<std::size_t>(count, pings - count));
      EXPECT_FALSE(some.others_are_probes);
      std::vector<std::size_t> all = some.probes;
      all.insert(all.end(), some.others.begin(), some.others.end());
      std::sort(all.begin(), all.end());
      EXPECT_EQ(std::unique(all.begin(), all.end()), all.end()) << "twice the same ping";
      EXPECT_LT(all.back(), pings);
    }
}

TEST(LookedAt, WithoutOtherPingsTheProbesServeTwiceAndItSaysSo) {
  const LookedAt one = looked_at(1, 2);
  EXPECT_THAT(one.probes, ElementsAre(0));
  EXPECT_THAT(one.others, ElementsAre(0));
  EXPECT_TRUE(one.others_are_probes);
}

struct AdviseProgram : testing::Test {
  TestFolder folder;
  std::string scene = folder.write("scene.toml", sphere_and_box).string();
  std::string output = (folder / "results").string();

  void expect_refused(const std::vector<std::string>& arguments, const std::string& message) const {
    SCOPED_TRACE(testing::PrintToString(arguments));
    const Outcome outcome = run_program(arguments);
    EXPECT_EQ(outcome.exit_code, 2);
    EXPECT_THAT(outcome.err, HasSubstr(message));
    EXPECT_THAT(outcome.out, IsEmpty());
    EXPECT_EQ(names_below(folder.path()), std::set<std::string>{"scene.toml"});
  }
};

TEST_F(AdviseProgram, PrintsATableAndNamesTheCheapest) {
  const Outcome outcome = run_program({"advise", scene, "--tolerance", "1e-5", "--quiet"});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_THAT(outcome.err, IsEmpty());
  for (const char* words :
       {"tubes, exact cuts, fixed", "tubes, spread", "tubes, centroid", "rays, stratified", "rays, sobol",
        "rays, adaptive", "rays, regular", "rays, one column per beam",
        "options        --engine tube --arithmetic fixed --binning exact\n"})
    EXPECT_THAT(outcome.out, HasSubstr(words));
}

TEST_F(AdviseProgram, JsonHasEveryCandidate) {
  const Outcome outcome =
      run_program({"advise", scene, "--tolerance", "2%", "--trial-pings", "3", "--json", "-", "--quiet"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const auto json = nlohmann::json::parse(outcome.out);
  EXPECT_EQ(json["tolerance"], "0.02");
  EXPECT_EQ(json["measure"], "l1_error");
  EXPECT_EQ(json["sensors"][0]["probe_pings"].size(), 3u);
  EXPECT_EQ(json["sensors"][0]["measured_pings"].size(), 3u);
  EXPECT_EQ(json["candidates"].size(), 8u);
  EXPECT_EQ(json["candidates"][0]["measured"]["error"], 0);
  EXPECT_TRUE(json["cheapest"]["holds"]);
  for (const auto& c : json["candidates"]) {
    if (c["holds"]) {
      EXPECT_GE(c["measured"]["seconds"], json["cheapest"]["measured"]["seconds"]);
    }
  }
}

TEST_F(AdviseProgram, TrialPingsComeFromTheSelectedPings) {
  const Outcome outcome = run_program({"advise", scene, "--tolerance", "2%", "--pings", "2:5",
                                       "--trial-pings", "2", "--threads", "2", "--json", "-", "--quiet"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const auto sensor = nlohmann::json::parse(outcome.out)["sensors"][0];
  EXPECT_EQ(sensor["pings"], 4);
  for (const char* which : {"probe_pings", "measured_pings"}) {
    EXPECT_EQ(sensor[which].size(), 2u);
    for (const int ping : sensor[which]) {
      EXPECT_GE(ping, 2);
      EXPECT_LE(ping, 5);
    }
  }
}

TEST_F(AdviseProgram, ABareNumberOfPingsKeepsItsMeaningWithAWarning) {
  const Outcome outcome = run_program(
      {"advise", scene, "--tolerance", "2%", "--pings", "3", "--json", (folder / "a.json").string()});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("a bare number of --pings is deprecated here: use --trial-pings N"));
  const auto json = nlohmann::json::parse(bytes_of(folder / "a.json"));
  EXPECT_EQ(json["sensors"][0]["probe_pings"].size(), 3u);
}

TEST_F(AdviseProgram, ARunWithAToleranceSaysWhatItLeftOut) {
  const Outcome outcome = run_program({"run", scene, "-o", output, "--tolerance", "1e-5", "--quiet"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_THAT(outcome.out,
              HasSubstr("tolerance 1e-05: tubes, exact cuts, fixed; neglected: nothing; error "));
  const auto stats = nlohmann::json::parse(bytes_of(folder / "results" / "stats.json"));
  EXPECT_EQ(stats["engine"], "tube");
  EXPECT_EQ(stats["binning"], "exact");
  const auto& said = stats["tolerance"];
  EXPECT_EQ(said["asked"], "1e-05");
  EXPECT_EQ(said["left_out"], "nothing");
  EXPECT_EQ(said["estimated_error"], 0);
  EXPECT_THAT(said["estimate"].get<std::string>(), HasSubstr("not certified"));
  EXPECT_EQ(said["probe_pings"]["camera"].size(), 7u);
}

// The engine for a loose tolerance depends on the machine. The report must describe the settings of the
// run.
TEST_F(AdviseProgram, ALooseRunIsTheOneThatItDescribes) {
  const Outcome outcome =
      run_program({"run", scene, "-o", output, "--tolerance", "6dB", "--seed", "5", "--quiet"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const auto stats = nlohmann::json::parse(bytes_of(folder / "results" / "stats.json"));
  const auto& said = stats["tolerance"];
  EXPECT_LE(said["estimated_error"], 6);
  const std::string run = said["options"];
  EXPECT_THAT(run, HasSubstr("--engine " + stats["engine"].get<std::string>()));
  if (stats["engine"] == "ray") {
    EXPECT_EQ(run, "--engine ray --sampling " + stats["sampling"].get<std::string>() + " --rays-per-beam " +
                       std::to_string(stats["rays_per_beam"].get<int>()));
    EXPECT_EQ(said["left_out"], "surfaces between rays");
    EXPECT_EQ(stats["seed"], 5);
  } else {
    EXPECT_THAT(run, HasSubstr("--binning " + stats["binning"].get<std::string>()));
  }
}

TEST_F(AdviseProgram, BadTolerancesAreRefused) {
  for (const char* bad : {"little", "nan", "0dB"}) {
    expect_refused({"advise", scene, "--tolerance", bad}, std::string("--tolerance '") + bad + "'");
    expect_refused({"run", scene, "-o", output, "--tolerance", bad},
                   std::string("--tolerance '") + bad + "'");
  }
  expect_refused({"run", scene, "-o", output, "--tolerance", "1e-9"}, "run --reference");
  for (const char* bad : {"0.1dB", "nan"})
    expect_refused({"run", scene, "-o", output, "--reference", "--tolerance", bad},
                   "relative bound from 1e-12 to 0.1");
  expect_refused({"advise", scene}, "--tolerance is required");
  expect_refused({"advise", scene, "--tolerance", "1%", "--pings", "1"},
                 "--pings '1': expected a number of pings of at least 2");
  expect_refused({"advise", scene, "--tolerance", "1%", "--pings", "7:900"}, "has pings 0 to ");
  expect_refused({"advise", scene, "--tolerance", "1%", "--trial-pings", "1"}, "--trial-pings");
  expect_refused({"advise", scene, "--tolerance", "1%", "--threads", "0"}, "--threads");
  expect_refused({"advise", scene, "--tolerance", "1%", "--json", folder.path().string()},
                 "is a folder: give the name of a file to write");
}

TEST_F(AdviseProgram, OptionsThatTheTolerancePicksAreRefused) {
  const std::vector<std::vector<std::string>> contradictions{
      {"--engine", "ray"},       {"--binning", "spread"}, {"--arithmetic", "double"},
      {"--sampling", "regular"}, {"--rays", "100"},       {"--rays-per-beam", "10"}};
  for (const auto& option : contradictions)
    expect_refused({"run", scene, "-o", output, "--tolerance", "1%", option[0], option[1]},
                   "leave out " + option[0] + ", or --tolerance");
}

}  // namespace
}  // namespace tubefoot
