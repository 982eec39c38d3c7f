// SPDX-License-Identifier: GPL-3.0-or-later
// Tests that a run that merges coplanar facets gives the energies of the single facets, to rounding and
// quadrature errors.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numeric>

#include "fixtures/program.hpp"
#include "fixtures/scene_texts.hpp"
#include "run/simulation.hpp"
#include "run/survey.hpp"
#include "sensors/kinds/scene_file.hpp"

namespace tubefoot {
namespace {

/// A seabed of cells of 0.25 m, and a box on it.
std::string fine_seabed(const std::string& sensor, const std::string& more = {},
                        const std::string& model = "lambert_db = -20\n") {
  return "[[materials]]\nname = \"sand\"\n" + model + more +
         "[[terrain]]\nname = \"bed\"\nkind = \"flat\"\nwidth_m = 30\nlength_m = 30\ncell_m = 0.25\n"
         "[[objects]]\nname = \"crate\"\nshape = \"box\"\nsize_m = [1, 1, 1]\nposition_m = [0.3, 5, 0.5]\n"
         "[trajectory]\nkind = \"fixed\"\nposition_m = [0.2, 0.1, 4]\n"
         "[[sensors]]\nname = \"sonar\"\n" +
         sensor;
}

struct MergedPlanesRun : testing::Test {
  TestFolder folder;

  std::vector<double> energies(const std::string& scene, Facets facets, std::size_t& met,
                               const std::string& engine = "tube") {
    SceneDescription description = read_scene_file(folder.write("scene.toml", scene));
    description.run.engine = engine;
    const auto survey = open_survey(description, facets);
    met = survey->scene.mesh.facets.size();
    SimulationStats stats;
    std::vector<double> all;
    const std::vector<Recording> recordings = simulate(*survey, request_of(description.run), stats);
    for (const Recording& recording : recordings)
      all.insert(all.end(), recording.energy.begin(), recording.energy.end());
    return all;
  }

  /// The tolerance is relative to the energy of a bin, or to the mean over bins if this is larger.
  void expect_alike(const std::string& scene, double relative) {
    SCOPED_TRACE(scene);
    std::size_t given = 0, merged = 0;
    const std::vector<double> truth = energies(scene, Facets::as_given, given),
                              energy = energies(scene, Facets::merged, merged);
    EXPECT_GT(given, 28'000u);
    EXPECT_LT(merged, 100u);
    ASSERT_EQ(truth.size(), energy.size());
    const double mean = std::accumulate(truth.begin(), truth.end(), 0.0) / double(truth.size());
    ASSERT_GT(mean, 0);
    for (std::size_t k = 0; k < truth.size(); ++k)
      EXPECT_NEAR(energy[k], truth[k], relative * std::max(truth[k], mean)) << "bin " << k;
  }
};

constexpr const char* camera =
    "kind = \"didson\"\nbeams = 6\ntilt_deg = 40\nwindow_start_m = 4\nwindow_length_m = 5\n";
constexpr const char* sidescan =
    "kind = \"sidescan\"\nrange_max_m = 14\nsamples = 50\nping_interval_s = 1\npings = 1\n";

TEST_F(MergedPlanesRun, OfLambertsLawToRounding) {
  expect_alike(fine_seabed(camera), 1e-11);
  expect_alike(fine_seabed(sidescan), 1e-11);
}

TEST_F(MergedPlanesRun, WithALawToQuadrature) {
  expect_alike(fine_seabed(camera, {},
                           "law = \"gsab\"\nspecular_db = -5\nspecular_width_deg = 8\noblique_db = -20\n"
                           "oblique_exponent = 1.5\n"),
               1e-4);
}

TEST_F(MergedPlanesRun, WithMicroTexture) {
  expect_alike(fine_seabed(camera,
                           "[[materials.reflectivity]]\nkind = \"perlin\"\nwavelength_m = 1\noctaves = 1\n"
                           "depth = 0.5\nseed = 1\n"),
               1e-4);
}

TEST_F(MergedPlanesRun, UnderAMirror) {
  expect_alike(fine_seabed(camera, "[sea_surface]\nheight_m = 6.5\n[paths]\norder = 2\n"), 1e-9);
}

TEST_F(MergedPlanesRun, RaysHitTheSamePlaces) {
  const std::string scene = fine_seabed(camera) + "[run]\nrays_per_ping = 20000\n";
  std::size_t given = 0, merged = 0;
  const std::vector<double> truth = energies(scene, Facets::as_given, given, "ray"),
                            energy = energies(scene, Facets::merged, merged, "ray");
  EXPECT_LT(100 * merged, given);
  const double all = std::accumulate(truth.begin(), truth.end(), 0.0);
  double apart = 0;
  for (std::size_t k = 0; k < truth.size(); ++k) apart += std::abs(truth[k] - energy[k]);
  EXPECT_LT(apart, 0.01 * all);  // a ray at a bin border may fall into the next bin
}

TEST_F(MergedPlanesRun, IsReportedInTheStatistics) {
  const std::string scene = folder.write("scene.toml", fine_seabed(camera)).string(),
                    out = (folder / "out").string();
  const auto facets_of = [&](std::vector<std::string> more) {
    std::vector<std::string> words{"run", scene, "-o", out, "--quiet", "--pictures", "none"};
    words.insert(words.end(), more.begin(), more.end());
    const Outcome outcome = run_program(words);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    return nlohmann::json::parse(bytes_of(folder / "out" / "stats.json"));
  };
  const nlohmann::json merged = facets_of({});
  EXPECT_LT(merged.at("facets"), 100);
  EXPECT_EQ(merged.at("facets_before_planes_were_merged"), 28'800 + 12);
  using Words = std::vector<std::string>;
  for (const Words& by_facets :
       {Words{"--reference", "--tolerance", "1e-3"}, {"--binning", "centroid"}, {"--binning", "spread"}}) {
    Words one_beam = by_facets;
    one_beam.insert(one_beam.end(), {"--beams", "0"});
    const nlohmann::json given = facets_of(one_beam);
    EXPECT_EQ(given.at("facets"), 28'800 + 12);
    EXPECT_FALSE(given.contains("facets_before_planes_were_merged"));
  }
}

TEST_F(MergedPlanesRun, IsOfNothingWhoseFacetsMatter) {
  const std::string ripples =
      "[[materials.relief]]\nkind = \"ripples\"\ntile_m = 5.12\nresolution_m = 0.04\nseed = 7\n"
      "wavelength_m = 1.25\ndirection_deg = 20\nrms_height_m = 0.02\n";
  for (const std::string& more :
       {"[water]\nprofile = \"gradient\"\nsound_speed_m_s = 1500\ngradient_per_s = 0.5\n"
        "profile_bottom_m = 40\nsurface_height_m = 6.5\n" +
            std::string(),
        std::string("[sea_surface]\nheight_m = 6.5\n[paths]\norder = 2\nscatterings = 2\npatch_m = 1\n"),
        ripples + "[relief]\nmode = \"online\"\ncell_m = 0.5\ntolerance = 0.5\n"}) {
    SCOPED_TRACE(more);
    const auto survey =
        open_survey(read_scene_file(folder.write("scene.toml", fine_seabed(camera, more))), Facets::merged);
    EXPECT_EQ(survey->scene.mesh.facets.size(), 28'800u + 12u);
    EXPECT_EQ(survey->loaded_scene->facets_given, 0u);
  }
}

}  // namespace
}  // namespace tubefoot
