// SPDX-License-Identifier: GPL-3.0-or-later
// Tests `compare --attribute`: it attributes planted errors to the correct objects and kinds of range bins,
// and the shares add up.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <nlohmann/json.hpp>

#include "fixtures/foreign_echoes.hpp"
#include "fixtures/program.hpp"
#include "fixtures/scene_texts.hpp"
#include "fixtures/world/echoes.hpp"

namespace tubefoot {
namespace {

using testing::HasSubstr;
using Json = nlohmann::json;
using Words = std::vector<std::string>;

/// Two spheres on a seabed, seen by a sonar with a range gate within the seabed.
const std::string two_balls = still_water() + lambert_material("sand", -18) + lambert_material("steel", -8) +
                              lambert_material("rubber", -12) +
                              flat_terrain(40, 40, "name = \"bed\"\nmaterial = \"sand\"\n") + R"([[objects]]
name = "left"
material = "steel"
shape = "sphere"
radius_m = 0.5
chord_error_m = 0.01
position_m = [-0.8, 6, 0.4]
[[objects]]
name = "right"
material = "rubber"
shape = "sphere"
radius_m = 0.5
chord_error_m = 0.01
position_m = [0.9, 7, 0.4]
)" + fixed_at(0, 0, 3) + R"([[sensors]]
name = "sonar"
kind = "didson"
beams = 48
tilt_deg = 20
vertical_deg = 20
samples = 200
window_start_m = 5
window_length_m = 12
)";

struct Attribute : testing::Test {
  TestFolder folder;
  Attribute() {
    folder.write("scene.toml", two_balls);
    run("scene.toml", "reference", {"--reference", "--tolerance", "1e-6"});
  }
  std::string path(const std::string& name) const { return (folder / name).string(); }
  void run(const std::string& scene, const std::string& output, const Words& more) const {
    Words words{"run", path(scene), "-o", path(output), "--quiet", "--pictures", "none"};
    words.insert(words.end(), more.begin(), more.end());
    const Outcome outcome = run_program(words);
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  }
  Json attribution(const std::string& candidate, const Words& more = {},
                   const std::string& reference = "reference/echoes.nc") const {
    Words words{"compare",     path(reference), path(candidate),
                "--attribute", "--scene",       path("scene.toml"),
                "--quiet",     "--json",        "-"};
    words.insert(words.end(), more.begin(), more.end());
    const Outcome outcome = run_program(words);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    const Json all = Json::parse(outcome.out)["sensors"][0]["attribution"];
    for (const char* table : {"causes", "kinds", "objects", "materials", "ranges", "beams"}) {
      double error = 0, energy = 0;
      for (const Json& row : all[table]) {
        error += row["share_of_error"].get<double>();
        energy += row["share_of_energy"].get<double>();
      }
      EXPECT_NEAR(error, 1, 1e-9) << table;
      EXPECT_NEAR(energy, 1, 1e-9) << table;
    }
    return all;
  }
  /// Writes the reference with each energy changed by `change`(beam, sample, energy).
  void write_changed(const std::function<double(std::size_t, std::size_t, double)>& change) const {
    const Echoes truth = read_echoes(folder / "reference/echoes.nc");
    ForeignGroup group;
    group.dimensions = {{"ping", truth.pings}, {"beam", truth.beams}, {"sample", truth.samples}};
    std::vector<double> energy = truth.energy;
    for (std::size_t bin = 0; bin < energy.size(); ++bin)
      energy[bin] = change(bin / truth.samples, bin % truth.samples, energy[bin]);
    group.variables = {{"energy", {{"ping", "beam", "sample"}, "J", energy}},
                       {"slant_range", {{"sample"}, "m", truth.slant_range_m}},
                       {"beam_azimuth", {{"beam"}, "degree", truth.beam_azimuth_deg}}};
    write_foreign(folder / "changed.nc", group);
  }
};

double share(const Json& table, const std::string& name) {
  for (const Json& row : table)
    if (row["name"] == name) return row["share_of_error"];
  return 0;
}

TEST_F(Attribute, AnErrorOfOneObjectAloneIsItsAlone) {
  folder.write("louder.toml", replaced(two_balls, "lambert_db = -12", "lambert_db = -9"));
  run("louder.toml", "louder", {});
  const Json all = attribution("louder/echoes.nc", {"--any-scene"});
  EXPECT_GT(share(all["objects"], "right"), 0.9999);
  EXPECT_GT(share(all["materials"], "rubber"), 0.9999);
  for (const Json& row : all["objects"]) {
    if (row["name"] != "right") continue;
    EXPECT_NEAR(row["level_db"].get<double>(), 3, 0.001);
  }
  for (const Json& bin : all["worst_bins"]) {
    EXPECT_EQ(bin["facets"][0]["object"], "right");
    double sum = 0;
    for (const Json& facet : bin["facets"]) sum += facet["share_of_energy"].get<double>();
    EXPECT_LE(sum, 1 + 1e-9);
    EXPECT_GT(sum, 0.3);
  }
}

TEST_F(Attribute, AMissingShadowIsTheCastersAndOfItsKind) {
  write_changed([](std::size_t, std::size_t sample, double energy) {
    return energy == 0 && sample > 60 && sample < 150 ? 1e-7 : energy;
  });
  const Json all = attribution("changed.nc");
  EXPECT_GT(share(all["kinds"], "shadow"), 0.98);
  EXPECT_GT(share(all["objects"], "left") + share(all["objects"], "right"), 0.9);
  EXPECT_GT(share(all["objects"], "left"), 0.1);
  EXPECT_GT(share(all["objects"], "right"), 0.2);
}

TEST_F(Attribute, RaysOfOneColumnAreWrongAtSilhouettesAndShadows) {
  // The face of a slab is flat. In the middle of a beam one column sees the same as the whole beam, but not
  // at the sides. (The face of a sphere has the larger error, because it curves within a beam.)
  std::string slab = two_balls;
  slab.erase(slab.find("[[objects]]"), slab.find("[trajectory]") - slab.find("[[objects]]"));
  folder.write("scene.toml", slab +
                                 "[[objects]]\nname = \"slab\"\nmaterial = \"steel\"\nshape = \"box\"\n"
                                 "size_m = [1.03, 0.1, 2]\nposition_m = [0.02, 7, 0]\n");
  run("scene.toml", "slab", {"--reference", "--tolerance", "1e-6"});
  run("scene.toml", "coarse", {"--engine", "ray", "--sampling", "column", "--rays-per-beam", "100000"});
  const Json all = attribution("coarse/echoes.nc", {}, "slab/echoes.nc");
  EXPECT_GT(share(all["kinds"], "silhouette") + share(all["kinds"], "shadow-edge"), 0.75);
  EXPECT_LT(share(all["kinds"], "interior"), 0.2);
}

TEST_F(Attribute, BandsAreThoseThatWereChanged) {
  write_changed([](std::size_t beam, std::size_t sample, double energy) {
    return energy * (beam < 5 && sample >= 120 ? 1.1 : 1.0);  // unobstructed seabed
  });
  const Json all = attribution("changed.nc");
  for (std::size_t band = 0; band < 6; ++band) EXPECT_EQ(all["ranges"][band]["share_of_error"], 0) << band;
  EXPECT_NEAR(share(all["beams"], "0 to 4"), 1, 1e-9);
  EXPECT_GT(share(all["kinds"], "interior"), 0.9);
  EXPECT_NEAR(share(all["objects"], "bed"), 1, 1e-9);
}

TEST_F(Attribute, NoErrorHasNoShares) {
  const Outcome outcome = run_program({"compare", path("reference/echoes.nc"), path("reference/echoes.nc"),
                                       "--attribute", "--scene", path("scene.toml"), "--quiet"});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("no error to attribute"));
}

TEST_F(Attribute, PartsOfARunAreFoundInTheScene) {
  run("scene.toml", "part", {"--beams", "10:20", "--reference", "--tolerance", "1e-6"});
  run("scene.toml", "part-rays", {"--beams", "10:20", "--engine", "ray", "--rays-per-beam", "3000"});
  const Outcome outcome =
      run_program({"compare", path("part/echoes.nc"), path("part-rays/echoes.nc"), "--attribute", "--scene",
                   path("scene.toml"), "--diagnose", "--ideal", "1x3000", "--quiet", "--json", "-"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const Json sensor = Json::parse(outcome.out)["sensors"][0];
  EXPECT_GT(share(sensor["attribution"]["objects"], "left"), 0);
  EXPECT_GT(sensor["ideal"]["l1_error"].get<double>(), 0);
}

TEST_F(Attribute, WhatDoesNotFitIsRefused) {
  const auto refusal = [&](const Words& more) {
    Words words{"compare", path("reference/echoes.nc"), path("reference/echoes.nc")};
    words.insert(words.end(), more.begin(), more.end());
    const Outcome outcome = run_program(words);
    EXPECT_EQ(outcome.exit_code, 2) << outcome.out;
    return outcome.err;
  };
  EXPECT_THAT(refusal({"--attribute"}), HasSubstr("--scene"));
  EXPECT_THAT(refusal({"--diagnose", "--ideal", "1x100"}), HasSubstr("--scene"));
  EXPECT_THAT(refusal({"--attribute", "--scene", path("none.toml")}), HasSubstr("none.toml"));
  folder.write("other.toml", replaced(two_balls, "samples = 200", "samples = 100"));
  EXPECT_THAT(refusal({"--attribute", "--scene", path("other.toml")}), HasSubstr("scene_hash"));
  EXPECT_THAT(refusal({"--attribute", "--any-scene", "--scene", path("other.toml")}),
              HasSubstr("1 pings x 48 beams x 200 range bins"));
  folder.write("renamed.toml", replaced(two_balls, "name = \"sonar\"", "name = \"b\"") + short_pings(2));
  EXPECT_THAT(refusal({"--attribute", "--any-scene", "--scene", path("renamed.toml")}), HasSubstr("sensor"));
  for (const char* words : {"0x100", "1x0", "points:0", "points:many", "points:", "2000x10", "1x9999999999"})
    EXPECT_THAT(refusal({"--diagnose", "--scene", path("scene.toml"), "--ideal", words}),
                HasSubstr("--ideal"))
        << words;
  EXPECT_THAT(refusal({"--diagnose", "--scene", path("scene.toml"), "--ideal", "axb"}), HasSubstr("axb"));
}

TEST_F(Attribute, ThePageHasWhoseAndTheIdeal) {
  run("scene.toml", "coarse", {"--engine", "ray", "--sampling", "column", "--rays-per-beam", "500"});
  const Outcome outcome = run_program({"compare", path("reference/echoes.nc"), path("coarse/echoes.nc"),
                                       "--html", path("page.html"), "--diagnose", "--ideal", "1x500",
                                       "--scene", path("scene.toml"), "--quiet"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const std::string page = bytes_of(folder / "page.html");
  for (const char* words :
       {"Attribution of the error", "sampling explains the whole error", "Worst bins and their facets",
        "silhouette", "1 x 500 rays per beam", "--ideal 1x500 --scene"})
    EXPECT_THAT(page, HasSubstr(words));
}

}  // namespace
}  // namespace tubefoot
