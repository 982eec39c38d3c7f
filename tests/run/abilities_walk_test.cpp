// SPDX-License-Identifier: GPL-3.0-or-later
// A walk over the table of what can be combined: every pair of features either runs or is refused, with its
// reason.
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <optional>
#include <set>

#include "fixtures/program.hpp"
#include "run/abilities.hpp"

namespace tubefoot {
namespace {

using testing::HasSubstr;

/// How a scene gets a feature: lines of its own tables, of the material, and of the sensor.
struct InScene {
  Feature feature;
  std::string tables{}, material{}, sensor{};
};
const std::vector<InScene> of_scenes{
    {Feature::refraction,
     "[water]\nprofile = \"gradient\"\nsound_speed_m_s = 1500\ngradient_per_s = 0.5\nprofile_bottom_m = 40\n"
     "surface_height_m = 20\n"},
    {Feature::mirrors, "[sea_surface]\nheight_m = 20\n"},
    {Feature::two_scatterings, "[paths]\norder = 2\nscatterings = 2\npatch_m = 1\n"},
    {Feature::receiver_apart, {}, {}, "receiver_arm_m = [0, 1, 0]\n"},
    {Feature::two_receivers, {}, {}, {}},  // another kind of sensor
    {Feature::tiles, {}, {}, {}},          // another way to load
    {Feature::relief_each_shot, "[relief]\nmode = \"online\"\ncell_m = 0.2\ntolerance = 0.5\n",
     "[[materials.relief]]\nkind = \"ripples\"\ntile_m = 5.12\nresolution_m = 0.04\nseed = 7\n"
     "wavelength_m = 0.4\ndirection_deg = 20\nrms_height_m = 0.01\n"},
    {Feature::scattering_law,
     {},
     "law = \"gsab\"\nspecular_db = -5\nspecular_width_deg = 8\noblique_db = -20\noblique_exponent = 1.5\n",
     {}},
    {Feature::micro_texture,
     {},
     "[[materials.reflectivity]]\nkind = \"perlin\"\nwavelength_m = 6\noctaves = 1\ndepth = 0.5\nseed = 1\n",
     {}}};

/// What a command or an option of it asks for.
struct Asked {
  Feature feature;
  std::vector<std::string> words;
};
const std::vector<Asked> of_runs{{Feature::reference, {"run", "--reference", "--tolerance", "1e-2"}},
                                 {Feature::double_arithmetic, {"run", "--arithmetic", "double"}},
                                 {Feature::fast_binning, {"run", "--binning", "centroid"}},
                                 {Feature::rays, {"run", "--engine", "ray", "--rays-per-beam", "50"}}};
const std::vector<Asked> of_commands{
    {Feature::audit, {"audit"}},
    {Feature::coverage, {"coverage", "-o", "covered.csv"}},
    {Feature::view, {"view", "-o", "page.html"}},
    {Feature::footprints, {"footprints", "--sensor", "sonar", "-o", "f.csv"}},
    {Feature::exact_corners, {"footprints", "--sensor", "sonar", "-o", "f.txt"}},
    {Feature::refine, {"refine", "-o", "bed.ply"}},
    {Feature::trial, {"advise", "--tolerance", "10%"}}};

std::string scene_with(const std::set<Feature>& features) {
  std::string tables, material, table_of_material, sensor;
  for (const InScene& one : of_scenes) {
    if (!features.contains(one.feature)) continue;
    tables += one.tables;
    (one.material.starts_with("[[") ? table_of_material : material) += one.material;
    sensor += one.sensor;
  }
  const bool staff = features.contains(Feature::two_receivers);
  return fmt::format(
      "{}[[materials]]\nname = \"rock\"\n{}{}"
      "[[terrain]]\nname = \"bed\"\nkind = \"raster\"\nfile = \"bed.asc\"\nmaterial = \"rock\"\nload = "
      "\"{}\"\n"
      "[trajectory]\nkind = \"fixed\"\nposition_m = [0, 0, 6]\n"
      "[[sensors]]\nname = \"sonar\"\nrange_min_m = 6\nrange_max_m = 10\nsamples = 8\n{}{}",
      tables, material, table_of_material, features.contains(Feature::tiles) ? "tiles" : "whole",
      staff ? "kind = \"interferometric\"\nalong_track_deg = 3\nfrequency_khz = 100\nbaseline_m = 0.05\n"
            : "kind = \"imaging\"\nbeams = 2\nhorizontal_deg = 4\nvertical_deg = 6\ntilt_deg = 50\n",
      sensor);
}

/// What the table says of a scene and a command that have these features and no others.
std::optional<std::string> reason_of_the_table(const std::set<Feature>& features) {
  for (const Refusal& r : refusals())
    if (features.contains(r.first) && features.contains(r.second) &&
        (!r.third || features.contains(*r.third)))
      return std::string(r.reason);
  return std::nullopt;
}

struct AbilitiesWalk : testing::Test {
  AbilitiesWalk() {
    std::string bed = "ncols 24\nnrows 24\nxllcorner -12\nyllcorner -12\ncellsize 1\n";
    for (int row = 0; row < 24; ++row) {
      for (int column = 0; column < 24; ++column) bed += fmt::format("{} ", -0.05 * (column % 3));
      bed += '\n';
    }
    folder.write("bed.asc", bed);
  }

  void walk(std::set<Feature> features, std::vector<std::string> words) {
    if (features.contains(Feature::two_scatterings)) features.insert(Feature::mirrors);  // paths as they are
    const std::string scene = scene_with(features);
    SCOPED_TRACE(fmt::format("{}\n{}", fmt::join(words, " "), scene));
    const auto file = folder.write("scene.toml", scene);
    for (std::string& word : words)
      if (word.find('.') != std::string::npos && !word.starts_with('-') && word != "1e-2")
        word = (folder / word).string();
    words.insert(words.begin() + 1, file.string());
    if (words.front() == "run") {
      words.push_back("-o");
      words.push_back((folder / fmt::format("out{}", ++runs)).string());
    }
    const Outcome outcome = run_program(words);
    const auto reason = reason_of_the_table(features);
    EXPECT_EQ(outcome.exit_code, reason ? 2 : 0) << outcome.err;
    if (reason) {
      EXPECT_THAT(outcome.err, HasSubstr(*reason));
    }
  }
  void walk_with(const std::vector<Asked>& asked) {
    for (const InScene& one : of_scenes)
      for (const Asked& two : asked) {
        // A bed is refined that has relief: with what tells beds apart.
        if (two.feature == Feature::refine && one.feature != Feature::relief_each_shot &&
            one.feature != Feature::tiles)
          continue;
        std::set<Feature> features{one.feature, two.feature};
        if (two.feature == Feature::refine) features.insert(Feature::relief_each_shot);
        walk(features, two.words);
      }
  }

  TestFolder folder;
  int runs = 0;
};

TEST_F(AbilitiesWalk, EveryPairOfASceneRunsOrIsRefused) {
  for (std::size_t a = 0; a < of_scenes.size(); ++a)
    for (std::size_t b = 0; b <= a; ++b) walk({of_scenes[a].feature, of_scenes[b].feature}, {"run"});
}

TEST_F(AbilitiesWalk, EveryFeatureOfASceneWithEveryRun) { walk_with(of_runs); }

TEST_F(AbilitiesWalk, EveryFeatureOfASceneWithEveryCommand) { walk_with(of_commands); }

TEST_F(AbilitiesWalk, EveryPairOfWhatARunAsks) {
  for (std::size_t a = 0; a < of_runs.size(); ++a)
    for (std::size_t b = 0; b < a; ++b) {
      std::vector<std::string> words = of_runs[a].words;
      words.insert(words.end(), of_runs[b].words.begin() + 1, of_runs[b].words.end());
      walk({of_runs[a].feature, of_runs[b].feature}, words);
    }
}

}  // namespace
}  // namespace tubefoot
