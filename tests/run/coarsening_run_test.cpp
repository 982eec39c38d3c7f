// SPDX-License-Identifier: GPL-3.0-or-later
// Tests runs with --coarsen, which merges facets: their reports, their effect on energies, and the features
// that they exclude.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>
#include <limits>
#include <nlohmann/json.hpp>
#include <numeric>
#include <set>

#include "fixtures/netcdf_reader.hpp"
#include "fixtures/program.hpp"
#include "fixtures/scene_texts.hpp"
#include "run/coarsening.hpp"
#include "run/survey.hpp"
#include "sensors/kinds/scene_file.hpp"

namespace tubefoot {
namespace {

using testing::HasSubstr;
using Words = std::vector<std::string>;

const std::string materials =
    "[[materials]]\nname = \"sand\"\nlambert_db = -20\n[[materials]]\nname = \"steel\"\nlambert_db = -10\n";
const std::string rolling_seabed =
    "[[terrain]]\nname = \"bed\"\nkind = \"fractal\"\nmaterial = \"sand\"\nwidth_m = 12\nlength_m = 12\n"
    "cell_m = 0.1\nrms_height_m = 0.05\nhurst = 0.95\nlargest_wavelength_m = 6\nseed = 3\n";
const std::string ball =
    "[[objects]]\nname = \"ball\"\nshape = \"sphere\"\nmaterial = \"steel\"\nradius_m = 0.8\n"
    "chord_error_m = 0.0003\nposition_m = [0.3, 5, 2]\n";
const std::string place = "[trajectory]\nkind = \"fixed\"\nposition_m = [0.2, 0.1, 4]\n";
const std::string camera =
    "[[sensors]]\nname = \"sonar\"\nkind = \"imaging\"\nbeams = 12\nhorizontal_deg = 24\nvertical_deg = 30\n"
    "tilt_deg = 30\nsamples = 40\nrange_min_m = 2\nrange_max_m = 8\n";

struct CoarseningRun : testing::Test {
  TestFolder folder;
  int runs = 0;

  Outcome tried(const std::string& scene, const Words& more) {
    Words words{"run", folder.write("scene.toml", scene).string(), "-o", output().string(), "--pictures",
                "none"};
    words.insert(words.end(), more.begin(), more.end());
    return run_program(words);
  }
  std::filesystem::path output() const { return folder / fmt::format("out{}", runs); }

  nlohmann::json stats_of(const std::string& scene, const Words& more) {
    ++runs;
    const Outcome outcome = tried(scene, more);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    told = outcome.out;
    return nlohmann::json::parse(bytes_of(output() / "stats.json"));
  }
  std::vector<double> energies() const { return NetcdfReader(output() / "echoes.nc").values("/", "energy"); }

  std::string told;
};

TEST_F(CoarseningRun, TellsWhatItChangesAndChangesLittle) {
  const std::string scene = materials + rolling_seabed + ball + place + camera;
  const nlohmann::json given = stats_of(scene, {});
  EXPECT_FALSE(given.contains("coarsening"));
  const std::vector<double> sure = energies();
  const double all = std::accumulate(sure.begin(), sure.end(), 0.0);
  double last = 0;
  for (const double tolerance : {0.003, 0.03, 0.3}) {
    SCOPED_TRACE(tolerance);
    const nlohmann::json stats = stats_of(scene, {"--coarsen", fmt::format("{}", tolerance)});
    const nlohmann::json& coarse = stats.at("coarsening");
    EXPECT_EQ(coarse.at("tolerance"), tolerance);
    EXPECT_EQ(coarse.at("facets_before"), given.at("facets"));
    EXPECT_EQ(coarse.at("facets"), stats.at("facets"));
    EXPECT_LT(coarse.at("facets"), coarse.at("facets_before"));
    const double share = coarse.at("largest_move").at("of_resolution"),
                 turn_deg = coarse.at("turn").at("largest_deg");
    EXPECT_LE(share, tolerance);
    EXPECT_GT(share, 0.5 * tolerance);
    EXPECT_LE(coarse.at("largest_move").at("m"), tolerance * 6.0 / 40);
    EXPECT_LE(turn_deg, glm::degrees(std::sqrt(tolerance)) * (1 + 1e-6));
    EXPECT_NEAR(coarse.at("change_of_energy").at("largest"), std::sin(glm::radians(2 * turn_deg)), 1e-9);
    EXPECT_THAT(told,
                HasSubstr(fmt::format("coarsened: {} facets instead of {};", coarse.at("facets").get<int>(),
                                      coarse.at("facets_before").get<int>())));
    EXPECT_EQ(NetcdfReader(output() / "echoes.nc").number("/", "coarsened"), tolerance);
    const std::vector<double> here = energies();
    double apart = 0;
    for (std::size_t k = 0; k < sure.size(); ++k) apart += std::abs(here[k] - sure[k]);
    EXPECT_GT(apart, last);
    EXPECT_LT(apart, tolerance * all);
    last = apart;
  }
}

TEST_F(CoarseningRun, OfNoToleranceIsTheRunItself) {
  const std::string scene = materials + rolling_seabed + ball + place + camera;
  EXPECT_EQ(stats_of(scene, {}).at("facets"), stats_of(scene, {"--coarsen", "0"}).at("facets"));
  EXPECT_EQ(bytes_of(folder / "out1" / "echoes.nc"), bytes_of(folder / "out2" / "echoes.nc"));
}

TEST_F(CoarseningRun, IsTheSameForAnyThreadsAndInParts) {
  const std::string scene = materials + rolling_seabed + ball + place + camera;
  stats_of(scene, {"--coarsen", "0.05", "--threads", "1"});
  stats_of(scene, {"--coarsen", "0.05", "--threads", "3"});
  EXPECT_EQ(bytes_of(folder / "out1" / "echoes.nc"), bytes_of(folder / "out2" / "echoes.nc"));
  ++runs;
  EXPECT_EQ(tried(scene, {"--coarsen", "0.05", "--shard", "1/1"}).exit_code, 0);
  const Outcome joined =
      run_program({"join", (folder / "scene.toml").string(), "-o", output().string(), "--pictures", "none"});
  EXPECT_EQ(joined.exit_code, 0) << joined.err;
  EXPECT_EQ(bytes_of(folder / "out1" / "echoes.nc"), bytes_of(output() / "echoes.nc"));
}

// By the nearest point of each sensor in turn.
TEST_F(CoarseningRun, WhatIsReportedApartGrowsWithTheRange) {
  const std::string line =
                        "[trajectory]\nkind = \"line\"\nstart_m = [-2, -4, 5]\nend_m = [1, 3, 5]\n"
                        "speed_m_s = 1\n",
                    sidescan =
                        "[[sensors]]\nname = \"side\"\nkind = \"sidescan\"\nrange_max_m = 6\nsamples = 40\n"
                        "ping_interval_s = 0.5\nlever_arm_m = [0.3, 0, 0]\n";
  const auto survey = open_survey(
      read_scene_file(folder.write("scene.toml", materials + rolling_seabed + line + camera + sidescan)));
  const Scene& scene = survey->scene;
  const std::vector<double> apart = resolved_lengths(*survey->loaded_scene, *survey->sensor_set);
  std::size_t unreached = 0;
  for (std::size_t f = 0; f < scene.mesh.facets.size(); f += 7) {
    double nearest = std::numeric_limits<double>::infinity(), farthest = nearest;
    for (const SensorPings& pings : survey->sensors) {
      const SensorFigures figures = figures_of(pings.sensor->description());
      for (const Pose& pose : pings.transmission_poses) {
        double near = std::numeric_limits<double>::infinity(), far = 0;
        for (const VertexId v : scene.mesh.facets[f]) {
          const double away = glm::distance(pose.position_m, scene.grid.to_metres(scene.mesh.vertices[v]));
          near = std::min(near, away), far = std::max(far, away);
        }
        const double beam_rad = glm::radians(figures.beam_deg);
        // Facets are at most 0.14 m long, except for their slope.
        if (near - 0.2 < figures.farthest_m)
          nearest = std::min(nearest, std::min(figures.sample_m, beam_rad * (near - 0.2)));
        if (far < figures.farthest_m)
          farthest = std::min(farthest, std::min(figures.sample_m, beam_rad * far));
      }
    }
    const double told_m = apart[f] * scene.grid.unit_m();
    if (told_m == 0) {
      ++unreached;
      EXPECT_TRUE(std::isinf(farthest));
      continue;
    }
    EXPECT_GE(told_m, nearest - 1e-5);
    EXPECT_LE(told_m, farthest + 1e-5);
  }
  EXPECT_GT(unreached, 10u);
  EXPECT_LT(unreached, scene.mesh.facets.size() / 14);
}

// A sphere in the seabed: both keep their facets on and near their intersection.
TEST_F(CoarseningRun, NothingComesThroughWhatItLayBehind) {
  std::string buried = ball;
  buried.replace(buried.find("5, 2]"), 5, "5, 0.3]");
  const SceneDescription scene =
      read_scene_file(folder.write("scene.toml", materials + rolling_seabed + buried + place + camera));
  const auto given = open_survey(scene, Facets::merged), made = open_survey(scene, Facets::merged, 0.3);
  const FacetMesh &before = given->scene.mesh, &after = made->scene.mesh;
  EXPECT_LT(2 * after.facets.size(), before.facets.size());
  const std::set<std::array<VertexId, 3>> there(after.facets.begin(), after.facets.end());
  std::size_t crossing = 0;
  for (std::size_t f = 0; f < before.facets.size(); ++f) {
    glm::dvec3 middle(0);
    for (const VertexId v : before.facets[f]) middle += given->scene.grid.to_metres(before.vertices[v]) / 3.0;
    // Facets of the seabed whose middles lie near the intersection with the sphere.
    const double from_centre = glm::distance(middle, glm::dvec3(0.3, 5, 0.3));
    if (before.component[f] != 0 || std::abs(from_centre - 0.8) > 0.01) continue;
    ++crossing;
    EXPECT_TRUE(there.contains(before.facets[f]));
  }
  EXPECT_GT(crossing, 10u);
}

TEST_F(CoarseningRun, RefusesWhatIsNoTolerance) {
  const std::string scene = materials + rolling_seabed + place + camera;
  for (const char* wrong : {"2", "1.0001", "-0.1", "nan", "much", "0.1x", ""}) {
    SCOPED_TRACE(wrong);
    const Outcome outcome = tried(scene, {fmt::format("--coarsen={}", wrong)});
    EXPECT_EQ(outcome.exit_code, 2);
    EXPECT_THAT(outcome.err, HasSubstr("--coarsen"));
    EXPECT_FALSE(exists(output()));
  }
  EXPECT_THAT(tried(scene, {"--coarsen", "2"}).err,
              HasSubstr("--coarsen '2': expected the permitted displacement of facets as a fraction of the "
                        "resolution of the sonars, from 0 (no merging) to 1"));
}

TEST_F(CoarseningRun, IsRefusedWhereFacetsMatter) {
  const std::string scene = materials + rolling_seabed + place + camera;
  const std::string ripples =
      "[[materials.relief]]\nkind = \"ripples\"\ntile_m = 5.12\nresolution_m = 0.04\nseed = 7\n"
      "wavelength_m = 1.25\ndirection_deg = 20\nrms_height_m = 0.02\n";
  const std::string bending =
      "[water]\nprofile = \"gradient\"\nsound_speed_m_s = 1500\ngradient_per_s = 0.5\n"
      "profile_bottom_m = 40\nsurface_height_m = 6.5\n";
  const std::string scattering =
      "[sea_surface]\nheight_m = 6.5\n[paths]\norder = 2\nscatterings = 2\npatch_m = 1\n";
  struct {
    std::string scene;
    Words words;
    const char* reason;
  } cases[] = {
      {scene, {"--reference", "--tolerance", "1e-3"}, "this output refers to the facets of the scene"},
      {scene, {"--binning", "centroid"}, "less accurate with merged facets"},
      {scene, {"--tolerance", "10%"}, "settings are tested on the facets of the scene"},
      {bending + scene, {}, "tubefoot already adapts the facets to the refraction"},
      {scattering + scene, {}, "in the second scattering, tubefoot treats facets as points"},
      {materials + ripples + "[relief]\nmode = \"offline\"\ncell_m = 0.2\n" + rolling_seabed + place + camera,
       {},
       "cannot merge facets that relief has refined"},
      {materials + ripples + "[relief]\nmode = \"online\"\ncell_m = 0.5\ntolerance = 0.5\n" + rolling_seabed +
           place + camera,
       {},
       "cannot merge facets that relief has refined"},
      {materials + rolling_seabed + place +
           "[[sensors]]\nname = \"sonar\"\nkind = \"interferometric\"\nrange_max_m = 10\nsamples = 8\n"
           "along_track_deg = 3\nfrequency_khz = 100\nbaseline_m = 0.05\n",
       {},
       "phases depend on lengths much smaller"},
  };
  for (const auto& [text, words, reason] : cases) {
    SCOPED_TRACE(reason);
    Words all = words;
    all.insert(all.end(), {"--coarsen", "0.1"});
    const Outcome outcome = tried(text, all);
    EXPECT_EQ(outcome.exit_code, 2) << outcome.out;
    EXPECT_THAT(outcome.err, AllOf(HasSubstr(reason), HasSubstr("--coarsen")));
  }
}

}  // namespace
}  // namespace tubefoot
