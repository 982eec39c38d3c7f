// SPDX-License-Identifier: GPL-3.0-or-later
// Tests `tubefoot compare`: figures that were worked out by hand, rejected input, notes, results and exit
// codes.
#include <OpenImageIO/imageio.h>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "fixtures/foreign_echoes.hpp"
#include "fixtures/scene_texts.hpp"
#include "fixtures/world/echoes.hpp"

namespace tubefoot {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

using Words = std::vector<std::string>;

struct Compare : testing::Test {
  TestFolder folder;
  ForeignGroup reference = least_echoes(), candidate = least_echoes();
  std::map<std::string, ForeignGroup> reference_groups, candidate_groups;

  Compare() {
    reference.attributes["scene_hash"] = "0123";
    candidate.attributes["scene_hash"] = "0123";
  }

  std::string path(const char* name) const { return (folder / name).string(); }

  Outcome compare(const Words& options = {}) const {
    write_foreign(folder / "reference.nc", reference, reference_groups);
    write_foreign(folder / "candidate.nc", candidate, candidate_groups);
    Words words{"compare", path("reference.nc"), path("candidate.nc")};
    words.insert(words.end(), options.begin(), options.end());
    return run_program(words);
  }
  nlohmann::json figures(Words options = {}) const {
    options.insert(options.end(), {"--json", "-"});
    const Outcome outcome = compare(options);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_THAT(outcome.err, IsEmpty());
    return nlohmann::json::parse(outcome.out);
  }
  /// Expects an error about the candidate that also names the reference, before any file is written. Then
  /// resets both.
  void expect_mismatch(const std::string& message, bool names_reference = true) {
    SCOPED_TRACE(message);
    const Outcome outcome = compare({"--json", path("f.json"), "--png", path("p.png")});
    EXPECT_EQ(outcome.exit_code, 2) << outcome.out;
    EXPECT_THAT(outcome.err, AllOf(HasSubstr(path("candidate.nc") + ": "), HasSubstr(message)));
    if (names_reference) {
      EXPECT_THAT(outcome.err, HasSubstr(path("reference.nc")));
    }
    EXPECT_THAT(outcome.out, IsEmpty());
    EXPECT_EQ(names_below(folder.path()), (std::set<std::string>{"candidate.nc", "reference.nc"}));
    reference = candidate = least_echoes();
  }
};

TEST_F(Compare, FiguresAreThoseOfTheDefinition) {
  // 24 bins of k nJ, every fifth 0: the sum is 276 - 50 = 226. Doubled 24 -> no such bin; 23 -> 46, 1 -> 0.
  auto& energies = candidate.variables["energy"].values;
  energies[23] = 46e-9;  // ping 1, beam 2, sample 3
  energies[1] = 0;       // ping 0, beam 0, sample 1: the first return moves by one sample
  energies[5] = 1e-9;    // ping 0, beam 1, sample 1: a shadow
  std::vector<double> bounds(24, 0);
  bounds[1] = 1e-9;
  reference.variables["energy_bound"] = {{"ping", "beam", "sample"}, "J", bounds};
  const auto json = figures({"--worst", "2"});
  EXPECT_EQ(json["reference"]["scene_hash"], "0123");
  EXPECT_THAT(json["notes"], IsEmpty());
  ASSERT_EQ(json["sensors"].size(), 1u);
  const auto& sensor = json["sensors"][0];
  EXPECT_EQ(sensor["name"], "sensor");
  EXPECT_EQ(sensor["pings"], 2);
  EXPECT_EQ(sensor["beams"], 3);
  EXPECT_EQ(sensor["samples"], 4);
  EXPECT_NEAR(sensor["l1_error"], 25.0 / 226, 1e-12);
  EXPECT_NEAR(sensor["energy_ratio"], 249.0 / 226, 1e-12);
  EXPECT_NEAR(sensor["energy_ratio_db"], 10 * std::log10(249.0 / 226), 1e-12);
  EXPECT_NEAR(sensor["rms_db_error"], std::hypot(10 * std::log10(2), 30) / std::sqrt(19), 1e-9);
  EXPECT_EQ(sensor["lit_bins"], 19);
  EXPECT_EQ(sensor["shadow_bins"], 5);
  EXPECT_EQ(sensor["empty_where_lit"], 1);
  EXPECT_EQ(sensor["lit_where_shadow"], 1);
  EXPECT_EQ(sensor["first_return"]["in_both"], 6);
  EXPECT_NEAR(sensor["first_return"]["mean_m"], 0.5 / 6, 1e-12);
  EXPECT_EQ(sensor["first_return"]["largest_m"], 0.5);
  EXPECT_EQ(sensor["first_return"]["largest_samples"], 1);
  EXPECT_EQ(sensor["first_return"]["largest_beam"], 0);
  EXPECT_NEAR(sensor["within_bound"]["bound_l1"], 1.0 / 226, 1e-12);
  EXPECT_NEAR(sensor["within_bound"]["share_of_difference"], 1.0 / 25, 1e-9);
  EXPECT_NEAR(sensor["within_bound"]["share_of_bins"], 18.0 / 20, 1e-12);
  ASSERT_EQ(sensor["worst_bins"].size(), 2u);
  const auto& worst = sensor["worst_bins"][0];
  EXPECT_EQ(worst["ping"], 1);
  EXPECT_EQ(worst["beam"], 2);
  EXPECT_EQ(worst["sample"], 3);
  EXPECT_EQ(worst["slant_range_m"], 3.5);
  EXPECT_NEAR(worst["share_of_difference"], 23.0 / 25, 1e-12);
  EXPECT_NEAR(worst["error_db"], 10 * std::log10(2), 1e-9);
}

TEST_F(Compare, TableSaysTheSame) {
  candidate.variables["energy"].values[23] = 46e-9;
  const Outcome outcome = compare();
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  for (const char* words :
       {"sensor: 2 pings x 3 beams x 4 range bins", "relative L1 error        0.102",
        "RMS error of echo bins   0.691 dB", "total energy ratio       1.10177 (+0.421 dB)",
        "missing echoes           0 of 19 echo bins", "echoes in shadows        0 of 5",
        "6 in both files, 0 only in the reference", "unknown, because the reference has no energy_bound",
        "3.500       2.3e-08       4.6e-08       +3.01          100 %"})
    EXPECT_THAT(outcome.out, HasSubstr(words));
}

TEST_F(Compare, AFileWithItselfHasNoError) {
  const auto sensor = figures({"--within", "0", "--within-db", "0"})["sensors"][0];
  EXPECT_EQ(sensor["l1_error"], 0);
  EXPECT_EQ(sensor["rms_db_error"], 0);
  EXPECT_EQ(sensor["energy_ratio"], 1);
  EXPECT_EQ(sensor["empty_where_lit"], 0);
  EXPECT_EQ(sensor["lit_where_shadow"], 0);
  EXPECT_EQ(sensor["first_return"]["mean_absolute_m"], 0);
  EXPECT_EQ(sensor["within_bound"], nullptr);
  EXPECT_THAT(sensor["worst_bins"], IsEmpty());
}

TEST_F(Compare, TwiceTheEnergyIsThreeDecibelsAndNotWithinLess) {
  for (double& energy : candidate.variables["energy"].values) energy *= 2;
  EXPECT_NEAR(figures()["sensors"][0]["rms_db_error"], 3.0103, 1e-4);
  EXPECT_NEAR(figures()["sensors"][0]["energy_ratio"], 2, 1e-12);
  for (const Words& enough :
       {Words{"--within", "1.001"}, {"--within-db", "3.02"}, {"--within", "2", "--within-db", "4"}}) {
    const Outcome outcome = compare(enough);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_THAT(outcome.out, HasSubstr("within the allowed error"));
  }
  for (const Words& less : {Words{"--within", "0.999"},
                            {"--within-db", "3"},
                            {"--within", "2", "--within-db", "3"},
                            {"--within", "0.5", "--within-db", "4"}}) {
    const Outcome outcome = compare(less);
    EXPECT_EQ(outcome.exit_code, 3);
    EXPECT_THAT(outcome.out,
                AllOf(HasSubstr("relative L1 error        1\n"), HasSubstr("ABOVE the allowed error")));
  }
  const Outcome json = compare({"--within", "0.5", "--json", "-"});
  EXPECT_EQ(json.exit_code, 3);
  EXPECT_EQ(nlohmann::json::parse(json.out)["within"]["held"], false);
}

TEST_F(Compare, ASilentReferenceHasNoFiniteError) {
  reference.variables["energy"].values.assign(24, 0);
  const auto sensor = figures()["sensors"][0];
  EXPECT_EQ(sensor["l1_error"], nullptr);
  EXPECT_EQ(sensor["lit_where_shadow"], 19);
  EXPECT_EQ(compare({"--within", "1000"}).exit_code, 3);
}

TEST_F(Compare, OtherShapesAreRefused) {
  candidate.dimensions[0].second = 1;
  candidate.variables["energy"].values.resize(12);
  expect_mismatch("'energy' of sensor 'sensor' has 1 pings x 3 beams x 4 range bins");
  candidate.dimensions[2].second = 3;
  candidate.variables["energy"].values.resize(18);
  candidate.variables["slant_range"].values.resize(3);
  expect_mismatch("2 pings x 3 beams x 3 range bins");
}

TEST_F(Compare, OtherRangesAreRefused) {
  candidate.variables["slant_range"].values[2] += 0.006;  // of samples of 0.5 m
  expect_mismatch("'slant_range' of sensor 'sensor' is 3.006 m at sample 2");
  candidate.variables["slant_range"].values[2] += 0.004;
  EXPECT_EQ(compare().exit_code, 0);
  candidate = least_echoes();
  for (auto* side : {&reference, &candidate}) {
    side->dimensions.emplace_back("bound", 2);
    side->variables["slant_range_bounds"] = {{"sample", "bound"}, "m", {2, 2.1, 2.5, 2.6, 3, 3.1, 3.5, 3.6}};
  }
  candidate.variables["slant_range_bounds"].values[3] += 0.002;
  expect_mismatch("'slant_range_bounds' of sensor 'sensor' is 2.602 m at edge 3");
}

TEST_F(Compare, OtherBeamsAreRefused) {
  candidate.variables["beam_azimuth"].values = {10, 0, -10};
  expect_mismatch("'beam_azimuth' of sensor 'sensor' is 10 degrees at beam 0");
  candidate.variables["beam_azimuth"].values = {-10, 0.0011, 10};
  expect_mismatch("'beam_azimuth' of sensor 'sensor' is 0.0011 degrees at beam 1");
  candidate.variables["beam_azimuth"].values = {350, 0.0009, -350};
  EXPECT_EQ(compare().exit_code, 0) << "whole turns and float32 do not matter";
  candidate = least_echoes();
  for (auto* side : {&reference, &candidate})
    side->variables["beam_elevation"] = {{"beam"}, "degree", {0, 0, 0}};
  candidate.variables["beam_elevation"].values[2] = -30;
  expect_mismatch("'beam_elevation' of sensor 'sensor' is -30 degrees at beam 2");
}

TEST_F(Compare, OtherUnitsAndBrokenFilesAreRefused) {
  candidate.variables["energy"].units = "uJ";
  expect_mismatch("'energy' has unit 'uJ', expected 'J m-2'", false);
  candidate.variables["energy"].values[3] = std::nan("");
  expect_mismatch("'energy' holds nan at ping 0, beam 0, sample 3", false);
  candidate.variables["energy"].values[3] = -1;
  expect_mismatch("'energy' holds -1 at ping 0, beam 0, sample 3", false);
  candidate.variables.erase("slant_range");
  expect_mismatch("'slant_range' is missing", false);
  const Outcome missing = run_program({"compare", path("reference.nc"), path("absent.nc")});
  EXPECT_EQ(missing.exit_code, 2);
  EXPECT_THAT(missing.err, HasSubstr(path("absent.nc") + ": there is no such file"));
  folder.write("cut.nc", bytes_of(folder / "reference.nc").substr(0, 3000));
  const Outcome cut = run_program({"compare", path("cut.nc"), path("reference.nc")});
  EXPECT_EQ(cut.exit_code, 2);
  EXPECT_THAT(cut.err, HasSubstr(path("cut.nc") + ": cannot be read as netCDF"));
}

TEST_F(Compare, AnotherSceneIsRefusedUnlessAnySceneIsAllowed) {
  candidate.attributes["scene_hash"] = "4567";
  const auto notes = figures({"--any-scene"})["notes"];
  EXPECT_THAT(notes, ElementsAre("the scenes differ: scene_hash 0123 and 4567"));
  expect_mismatch("scene_hash is 4567, but");
}

TEST_F(Compare, AFileWithoutSceneHashIsNoted) {
  candidate.attributes.clear();
  EXPECT_THAT(compare().out, HasSubstr("note       the candidate has no scene_hash"));
  EXPECT_EQ(figures()["notes"].size(), 1u);
  candidate.attributes["scene_hash"] = "0123";
  reference.attributes.clear();
  EXPECT_THAT(compare().out, HasSubstr("note       the reference has no scene_hash"));
}

TEST_F(Compare, OtherPingTimesAreNoted) {
  reference.variables["ping_time"] = {{"ping"}, "s", {0, 0.1}};
  EXPECT_THAT(figures()["notes"], IsEmpty());
  candidate.variables["ping_time"] = {{"ping"}, "s", {0, 0.2}};
  EXPECT_THAT(figures()["notes"],
              ElementsAre("the ping times of 'sensor' differ; the comparison matches pings by their number"));
}

struct CompareSensors : Compare {
  CompareSensors() {
    ForeignGroup other = least_echoes();
    for (double& energy : other.variables["energy"].values) energy *= 2;
    reference_groups = {{"bow", least_echoes()}, {"stern", least_echoes()}};
    candidate_groups = {{"stern", other}, {"bow", least_echoes()}, {"mast", least_echoes()}};
    for (auto* root : {&reference, &candidate}) root->variables.clear(), root->dimensions.clear();
  }
};

TEST_F(CompareSensors, AreComparedByName) {
  const auto json = figures();
  ASSERT_EQ(json["sensors"].size(), 2u);
  EXPECT_EQ(json["sensors"][0]["name"], "bow");
  EXPECT_EQ(json["sensors"][0]["l1_error"], 0);
  EXPECT_EQ(json["sensors"][1]["name"], "stern");
  EXPECT_NEAR(json["sensors"][1]["l1_error"], 1, 1e-12);
  EXPECT_THAT(json["notes"], ElementsAre("the sensor 'mast' of the candidate is not in the reference"));
  EXPECT_EQ(figures({"--sensor", "stern"})["sensors"].size(), 1u);
  EXPECT_EQ(compare({"--within", "0.5", "--sensor", "bow"}).exit_code, 0);
  EXPECT_EQ(compare({"--within", "0.5"}).exit_code, 3);
  std::swap(candidate_groups["bow"], candidate_groups["stern"]);
  EXPECT_EQ(compare({"--within", "0.5"}).exit_code, 3) << "the first sensor counts as the last one does";
}

TEST_F(CompareSensors, ThatAreMissingAreRefused) {
  Outcome outcome = compare({"--sensor", "keel"});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.err, HasSubstr("has no sensor 'keel'; it has 'bow', 'stern'"));
  candidate_groups.erase("bow");
  outcome = compare();
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.err, HasSubstr("has no sensor 'bow'"));
  EXPECT_THAT(outcome.err, HasSubstr("it has 'mast', 'stern'"));
  EXPECT_EQ(compare({"--sensor", "stern"}).exit_code, 0);
  // One sensor on each side is compared under any names.
  reference_groups.erase("bow");
  candidate_groups.erase("stern");
  EXPECT_THAT(figures()["notes"],
              ElementsAre("the sensor of the candidate has the name 'mast', not 'stern'"));
}

TEST_F(Compare, ResultsAreWrittenWholeOrNotAtAll) {
  candidate.variables["energy"].values[7] *= 3;
  const Outcome outcome = compare({"--json", path("figures.json"), "--png", path("picture.png")});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_THAT(outcome.out,
              AllOf(HasSubstr("wrote " + path("figures.json")), HasSubstr("wrote " + path("picture.png"))));
  EXPECT_EQ(nlohmann::json::parse(bytes_of(folder / "figures.json")), figures());
  const auto picture = OIIO::ImageInput::open(path("picture.png"));
  ASSERT_TRUE(picture);
  EXPECT_GT(picture->spec().width, 900);
  const std::string before = bytes_of(folder / "picture.png");
  compare({"--png", path("again.png")});
  EXPECT_EQ(bytes_of(folder / "again.png").size(), before.size()) << "the same but for the file's name in it";

  for (const char* option : {"--json", "--png"}) {
    EXPECT_EQ(compare({option, path("absent/f.png")}).exit_code, 2);
    Surroundings full;
    full.largest_file_bytes = 100;
    fs::remove(folder / "full.png");
    const Outcome cut =
        run_program({"compare", path("reference.nc"), path("candidate.nc"), option, path("full.png")}, full);
    EXPECT_EQ(cut.exit_code, 1);
    EXPECT_THAT(cut.err, HasSubstr(path("full.png")));
    EXPECT_FALSE(fs::exists(folder / "full.png"));
  }
}

TEST_F(Compare, WhatCannotBeMeantIsRefused) {
  const auto expect_refused = [&](const Words& options, const std::string& message) {
    const Outcome outcome = compare(options);
    EXPECT_EQ(outcome.exit_code, 2) << outcome.out;
    EXPECT_THAT(outcome.err, HasSubstr(message));
    EXPECT_EQ(names_below(folder.path()), (std::set<std::string>{"candidate.nc", "reference.nc"}));
  };
  expect_refused({"--png", path("picture.jpg")}, "the name of a picture must end in .png");
  expect_refused({"--json", path("reference.nc")}, "is an input");
  expect_refused({"--json", path("candidate.nc")}, "is an input");
  expect_refused({"--json", folder.path().string()}, "is a folder: give the name of a file to write");
  expect_refused({"--json", path("x.png"), "--png", path("x.png")}, "name the same file");
  expect_refused({"--within", "-1"}, "--within");
  expect_refused({"--within-db", "much"}, "--within-db");
  expect_refused({"--worst", "-1"}, "--worst");
  expect_refused({"third.nc"}, "third.nc");
  EXPECT_EQ(run_program({"compare", path("reference.nc")}).exit_code, 2);
  EXPECT_EQ(bytes_of(folder / "reference.nc"), bytes_of(folder / "candidate.nc")) << "inputs are untouched";
}

TEST_F(Compare, AWildRatioPointsToTheFit) {
  for (double& energy : candidate.variables["energy"].values) energy *= 1.9;
  EXPECT_THAT(figures()["notes"], IsEmpty()) << "2.8 dB";
  for (double& energy : candidate.variables["energy"].values) energy *= 1e7;
  EXPECT_THAT(figures()["notes"][0].get<std::string>(), HasSubstr("'--fit gain'"));
  EXPECT_THAT(compare().out, HasSubstr("note       sensor: the total energies differ by +72.8 dB"));
  EXPECT_THAT(figures({"--fit", "gain"})["notes"], IsEmpty());
}

TEST_F(Compare, FiguresAfterAFitAreOfWhatIsLeft) {
  for (double& energy : candidate.variables["energy"].values) energy *= 4e7;
  const auto sensor = figures({"--fit", "gain", "--within", "1e-9"})["sensors"][0];
  EXPECT_NEAR(sensor["fit"]["gain_db"]["value"], 76.0206, 1e-3);
  EXPECT_LT(sensor["fit"]["gain_db"]["error"], 1e-3);
  EXPECT_NEAR(sensor["fit"]["before"]["l1_error"], 4e7 - 1, 1);
  EXPECT_LT(sensor["l1_error"], 1e-9);
  EXPECT_NEAR(sensor["unitless"]["rank_correlation"], 1, 1e-12);
  EXPECT_LT(sensor["unitless"]["row_l1"], 1e-12);
  EXPECT_THAT(compare({"--fit", "gain"}).out,
              AllOf(HasSubstr("fitted gain              +76.021 +- 0.000 dB\n"),
                    HasSubstr("before the fit           L1 4e+07")));
  EXPECT_EQ(compare({"--fit", "loss"}).exit_code, 2);
  EXPECT_THAT(compare({"--fit", "loss"}).err,
              HasSubstr("unknown term 'loss': expected gain, range or offset"));
  candidate.variables["energy"].values.assign(24, 0);
  EXPECT_THAT(compare({"--fit", "gain"}).err, HasSubstr("too few echoes"));
}

TEST_F(Compare, GeometryAloneNeedsNoUnits) {
  for (double& energy : candidate.variables["energy"].values) energy = energy > 0 ? 200 : 0;
  candidate.variables["energy"].values[1] = 0;  // the first return of ping 0, beam 0 moves by one sample
  const auto geometry = figures({"--geometry"})["sensors"][0]["geometry"];
  EXPECT_NEAR(geometry["visible"]["iou"], 18.0 / 19, 1e-12);
  EXPECT_NEAR(geometry["shadow"]["iou"], 4.0 / 5, 1e-12) << "bin 15 is behind its beam's last echo";
  EXPECT_NEAR(geometry["first_return"]["mean_absolute_samples"], 1.0 / 6, 1e-12);
  EXPECT_EQ(
      figures({"--geometry", "--threshold", "201"})["sensors"][0]["geometry"]["visible"]["candidate_bins"],
      0);
  EXPECT_THAT(compare({"--geometry"}).out,
              HasSubstr("visible area             19 bins in the reference, 18 "));
  EXPECT_EQ(compare({"--threshold", "1"}).exit_code, 2) << "it would be silent without --geometry";
}

TEST_F(Compare, FramesAreAveraged) {
  candidate.dimensions[0].second = 4;
  auto& energies = candidate.variables["energy"].values;
  const std::vector<double> pings = energies;
  energies.clear();
  for (std::size_t ping = 0; ping < 2; ++ping)
    for (const double factor : {0.5, 1.5})
      for (std::size_t k = 0; k < 12; ++k) energies.push_back(factor * pings[12 * ping + k]);
  EXPECT_LT(figures({"--frames", "2"})["sensors"][0]["l1_error"], 1e-12);
  EXPECT_THAT(compare({"--frames", "3"}).err, HasSubstr("4 pings, which is not a multiple of --frames 3"));
  expect_mismatch("'energy' of sensor 'sensor' has 4 pings");
}

TEST_F(Compare, AnOutputModelPutsTheReferenceIntoTheCandidatesMeasure) {
  const std::string output_model = folder.write("recipe.toml", "[[steps]]\nstep = \"amplitude\"\n").string();
  for (double& energy : candidate.variables["energy"].values) energy = std::sqrt(energy);
  EXPECT_EQ(figures({"--output-model", output_model})["sensors"][0]["l1_error"], 0);
  EXPECT_EQ(figures({"--output-model", output_model})["recipe"]["file"], output_model);
  folder.write("recipe.toml", "[[steps]]\nstep = \"mean\"\n");
  EXPECT_THAT(compare({"--output-model", output_model}).err, HasSubstr("needs the solid angle"));
  EXPECT_EQ(compare({"--output-model", path("absent.toml")}).exit_code, 2);
}

TEST_F(Compare, APageHasFindingsPictureFiguresAndTheCommand) {
  const Outcome outcome = compare({"--html", path("page.html")});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  const std::string page = bytes_of(folder / "page.html");
  const auto findings = page.find("Findings"), picture = page.find("data:image/png;base64,"),
             figures = page.find("<h2>Figures"),
             command = page.find("tubefoot compare " + path("reference.nc"));
  EXPECT_LT(findings, picture);
  EXPECT_LT(picture, figures);
  EXPECT_LT(figures, command);
  EXPECT_LT(command, page.size());
  EXPECT_EQ(compare({"--html", path("reference.nc")}).exit_code, 2) << "an input";
  EXPECT_THAT(compare({"--html", path("x"), "--json", path("x")}).err, HasSubstr("name the same file"));
}

TEST_F(Compare, HelpShowsAnExample) {
  const Outcome outcome = run_program({"compare", "--help"});
  EXPECT_EQ(outcome.exit_code, 0);
  for (const char* words :
       {"Example:\n  tubefoot compare ", "REFERENCE", "CANDIDATE", "--json", "--png", "--any-scene"})
    EXPECT_THAT(outcome.out, HasSubstr(words));
  EXPECT_THAT(run_program({"--help"}).out, HasSubstr("\n  compare "));
}

TEST(CompareRuns, RaysComeCloserToTheTubesTheMoreThereAre) {
  const TestFolder folder;
  folder.write("thing.obj", tetrahedron);
  const auto scene = folder.write("scene.toml", small_scene).string();
  const auto run = [&](const std::string& name, Words options) {
    options.insert(options.begin(), {"run", scene, "--quiet", "-o", (folder / name).string()});
    EXPECT_EQ(run_program(options).exit_code, 0);
    return (folder / name / "echoes.nc").string();
  };
  const std::string tubes = run("tubes", {});
  const auto error = [&](const std::string& rays) {
    const Outcome outcome = run_program(
        {"compare", tubes, run("rays-" + rays, {"--engine", "ray", "--rays", rays}), "--json", "-"});
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    const auto json = nlohmann::json::parse(outcome.out);
    EXPECT_EQ(json["candidate"]["engine"], "ray");
    EXPECT_EQ(json["sensors"][0]["name"], "camera");
    return json["sensors"][0]["l1_error"].get<double>();
  };
  const double few = error("2000"), many = error("200000");
  EXPECT_GT(few, 3 * many);
  EXPECT_LT(many, 0.2);
  EXPECT_GT(many, 0);
}

}  // namespace
}  // namespace tubefoot
