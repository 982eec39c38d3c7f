// SPDX-License-Identifier: GPL-3.0-or-later
// Tests whole reference runs in stratified water. The cases are closed forms of one gradient, seabeds with
// other scattering models, textures and relief, and bins without a bound.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "fixtures/world/echoes.hpp"
#include "fixtures/world/gradient_scenes.hpp"

namespace tubefoot {
namespace {

using testing::HasSubstr;
using testing::Not;
using namespace test;

// A reference chooses a smaller travel-path error than the scene states.
TEST(RefractedReferenceRun, HoldsTheClosedFormWithinTheTolerance) {
  for (const double g : {-0.5, -0.2}) {
    SCOPED_TRACE(g);
    const double absorption = 0, tolerance = 2e-3;
    const std::string scene = scene_in(gradient(g, absorption));
    const Checkpoint run(scene, {"--reference", "--tolerance", "2e-3"});
    ASSERT_EQ(run.outcome.exit_code, 0) << run.outcome.err;
    EXPECT_THAT(run.outcome.out, HasSubstr("the relative half-width of each interval is at most 0.002"));
    EXPECT_EQ(run.stats.at("reference").at("bins_over_tolerance"), 0);
    const Echoes echoes = read_echoes(run.folder / "out/echoes.nc"), ordinary = echoes_of(scene);
    for (std::size_t k = 0; k < echoes.samples; ++k) {
      if (echoes.first_m(k) < 10.3) continue;
      const double truth = ring_energy(g, echoes.first_m(k), echoes.last_m(k), absorption);
      // The tolerance limits the half-width. The bound is the distance to the farther end of the interval.
      EXPECT_LE(echoes.energy_bound[k], 2 * tolerance * echoes.energy[k] * 1.003) << k;
      // The rays of the tubes are rounded to 2^-30, and so are the walls of a fan.
      EXPECT_LE(std::abs(echoes.energy[k] - truth), echoes.energy_bound[k] + 1e-6 * truth) << k;
      // The ordinary run promises 0.1 dB.
      EXPECT_LE(std::abs(echoes.energy[k] - ordinary.energy[k]), echoes.energy_bound[k] + 0.0233 * truth)
          << k;
    }
  }
}

TEST(RefractedReferenceRun, SaysWhereItHasNoBound) {
  const Checkpoint run(replaced(scene_in(gradient(10)), "window_length_m = 32", "window_length_m = 62"),
                       {"--reference", "--tolerance", "1e-2"});
  ASSERT_EQ(run.outcome.exit_code, 0) << run.outcome.err;
  EXPECT_THAT(run.outcome.err, HasSubstr("have no bound"));
  const Echoes echoes = read_echoes(run.folder / "out/echoes.nc");
  std::size_t infinite = 0;
  for (const double bound : echoes.energy_bound) infinite += std::isinf(bound);
  EXPECT_EQ(run.stats.at("refraction").at("bins_without_bound"), infinite);
  EXPECT_GT(infinite, 0u);
  EXPECT_LT(infinite, echoes.samples - 10);
  EXPECT_TRUE(std::isinf(echoes.energy_bound.back()));
}

// The count is over the requested beams. The widest bound is that of the finite bounds.
TEST(RefractedReferenceRun, CountsBinsWithoutABoundOfTheChosenBeams) {
  std::string scene = replaced(scene_in(gradient(10)), "window_length_m = 32", "window_length_m = 62");
  scene = replaced(replaced(scene, "beams = 1", "beams = 3"), "horizontal_deg = 1.5", "horizontal_deg = 4.5");
  scene = replaced(replaced(scene, "samples = 128", "samples = 32"), "width_m = 256\nlength_m = 256",
                   "width_m = 100\nlength_m = 100");
  const Checkpoint run(scene, {"--reference", "--tolerance", "1e-1", "--beams", "1"});
  ASSERT_EQ(run.outcome.exit_code, 0) << run.outcome.err;
  const Echoes echoes = read_echoes(run.folder / "out/echoes.nc");
  EXPECT_EQ(echoes.energy_bound.size(), echoes.samples);
  EXPECT_EQ(run.stats.at("refraction").at("bins_without_bound"),
            std::ranges::count_if(echoes.energy_bound, [](double bound) { return std::isinf(bound); }));
  EXPECT_TRUE(run.stats.at("reference").at("worst_bound_over_asked").is_number());
  EXPECT_THAT(run.outcome.out, Not(HasSubstr("inf")));
}

/// A triangle of 6 m, 13 m ahead of a sonar at 10 m, with its middle `above_m` higher than the sonar.
struct TriangleAhead {
  TestFolder folder;
  std::string scene;
  TriangleAhead(double above_m, const std::string& water, const std::string& more) {
    const auto file = folder.write(
        "triangle.obj",
        fmt::format("v 3.3 13 {0}\nv -3.3 13 {0}\nv 0 13 {1}\nf 1 2 3\n", 7 + above_m, 13 + above_m));
    scene = "[water]\n" + water + lambert_material("plate", -20) +
            fmt::format("[[objects]]\nname = \"plate\"\nshape = \"mesh\"\nfile = \"{}\"\n", file.string()) +
            fixed_at(0, 0, 10) +
            "[[sensors]]\nname = \"sonar\"\nkind = \"imaging\"\nbeams = 4\nhorizontal_deg = 40\n"
            "vertical_deg = 40\nrange_min_m = 12.5\nrange_max_m = 16.9\nsamples = 16\n" +
            more;
  }
};

// Rays to such a triangle rise, fall and run horizontally. Its lower edge may lie at the depth of the
// sonar.
TEST(RefractedReferenceRun, BoundsEveryBinOfATriangleAtTheSonarsDepth) {
  struct Case {
    double gradient_per_s, above_m;
    const char* more;
  };
  const std::string apart = "receiver_arm_m = [0.4, 0, 0.2]\n";
  for (const Case& c : {Case{-0.01, 0, ""}, {-0.01, 3, ""}, {-0.5, 0, ""}, {-0.01, 0, apart.c_str()}}) {
    SCOPED_TRACE(fmt::format("{} {} {}", c.gradient_per_s, c.above_m, c.more));
    const TriangleAhead at(c.above_m, "surface_height_m = 20\n" + gradient(c.gradient_per_s), c.more),
        even(c.above_m, "sound_speed_m_s = 1500\nabsorption_db_per_km = 0\n", c.more);
    const Checkpoint run(at.scene, {"--reference", "--tolerance", "2e-3"});
    ASSERT_EQ(run.outcome.exit_code, 0) << run.outcome.err;
    EXPECT_FALSE(run.stats.at("refraction").contains("bins_without_bound"));
    EXPECT_EQ(run.stats.at("reference").at("bins_over_tolerance"), 0);
    const Echoes echoes = read_echoes(run.folder / "out/echoes.nc"), straight = echoes_of(even.scene);
    const double most = *std::ranges::max_element(straight.energy);
    std::size_t received = 0;
    for (std::size_t k = 0; k < echoes.energy.size(); ++k) {
      EXPECT_TRUE(std::isfinite(echoes.energy_bound[k])) << k;
      // Sound speeds differ by 2e-5 within 3 m at -0.01 /s: a bin of 0.3 m may gain or lose a thousandth.
      if (c.gradient_per_s == -0.01) {
        EXPECT_NEAR(echoes.energy[k], straight.energy[k], echoes.energy_bound[k] + 2e-3 * most) << k;
      }
      received += echoes.energy[k] > 0;
    }
    EXPECT_GT(received, 8u);
  }
}

constexpr std::string_view gsab =
    "law = \"gsab\"\nspecular_db = -10\nspecular_width_deg = 8\noblique_db = -25\noblique_exponent = 3\n";
constexpr std::string_view texture =
    "lambert_db = -27\n[[materials.reflectivity]]\nkind = \"perlin\"\nwavelength_m = 1.5\noctaves = "
    "1\ndepth = 0.5\nseed = 7\n";
constexpr std::string_view relief =
    "lambert_db = -27\n[[materials.relief]]\nkind = \"ripples\"\ntile_m = 5.12\nresolution_m = 0.04\nseed = "
    "7\nwavelength_m = 0.8\ndirection_deg = 20\nrms_height_m = 0.01\n";

/// Range bins of 25 cm over 14 m, for a seabed of 48 m.
std::string scene_of(std::string_view material, const std::string& water) {
  std::string scene = replaced(scene_in(water), "lambert_db = -27\n", material);
  scene = replaced(scene, "width_m = 256\nlength_m = 256", "width_m = 48\nlength_m = 48");
  return replaced(replaced(scene, "window_length_m = 32", "window_length_m = 14"), "samples = 128",
                  "samples = 56");
}

TEST(RefractedReferenceRun, HoldsTheClosedFormOfALawWithinTheTolerance) {
  const auto sigma = [](double sine) {
    const double phi = std::acos(std::min(sine, 1.0)), width = 8 * degree;
    return 0.1 * std::exp(-phi * phi / (2 * width * width)) + std::pow(10, -2.5) * sine * sine * sine;
  };
  for (const double g : {-0.5, 0.3}) {
    SCOPED_TRACE(g);
    const Checkpoint run(scene_of(gsab, gradient(g, 200)), {"--reference", "--tolerance", "5e-3"});
    ASSERT_EQ(run.outcome.exit_code, 0) << run.outcome.err;
    EXPECT_EQ(run.stats.at("reference").at("bins_over_tolerance"), 0);
    const Echoes echoes = read_echoes(run.folder / "out/echoes.nc");
    for (std::size_t k = 0; k < echoes.samples; ++k) {
      if (echoes.first_m(k) < 10.3) continue;
      const double truth = ring_energy(g, echoes.first_m(k), echoes.last_m(k), 200, sigma);
      EXPECT_LE(echoes.energy_bound[k], 2 * 5e-3 * echoes.energy[k] * 1.006) << k;
      EXPECT_LE(std::abs(echoes.energy[k] - truth), echoes.energy_bound[k] + 1e-6 * truth) << k;
    }
  }
}

// Compares with ordinary runs whose settings are finer than the default.
TEST(RefractedReferenceRun, HoldsFineOrdinaryRunsOfTextureAndRelief) {
  for (const std::string_view seabed : {texture, relief}) {
    const std::string online =
        seabed == relief ? "[relief]\nmode = \"online\"\ncell_m = 0.4\ntolerance = 0.3\n" : "";
    SCOPED_TRACE(seabed);
    const Checkpoint run(online + scene_of(seabed, gradient(-0.5)), {"--reference", "--tolerance", "1e-2"});
    ASSERT_EQ(run.outcome.exit_code, 0) << run.outcome.err;
    const Echoes echoes = read_echoes(run.folder / "out/echoes.nc"),
                 ordinary = echoes_of(online + scene_of(seabed, gradient(-0.5, 0,
                                                                         "refraction_tolerance_db = 0.002\n"
                                                                         "refraction_gap_m = 0.0001\n")));
    double bounds = 0, energies = 0;
    for (std::size_t k = 0; k < echoes.samples; ++k) {
      // Twice the travel-path error relative to a bin, and the tolerance of the run.
      const double off = 2 * 1e-4 / 0.25 + 5e-4;
      EXPECT_LE(std::abs(echoes.energy[k] - ordinary.energy[k]),
                echoes.energy_bound[k] + off * ordinary.energy[k])
          << k;
      bounds += echoes.energy_bound[k];
      energies += echoes.energy[k];
    }
    EXPECT_LT(bounds, 0.01 * energies);
  }
}

// A separate receiver with all features of a seabed. The comparison is ordinary runs as fine as above.
TEST(RefractedReferenceRun, HoldsFineOrdinaryRunsOfSeparateReceivers) {
  const std::string apart = "receiver_arm_m = [0, 1, 0.2]\n",
                    cells = "[relief]\nmode = \"online\"\ncell_m = 0.8\ntolerance = 0.5\n",
                    patterns =
                        "transmit_pattern = \"line\"\ntransmit_aperture_m = 0.3\n"
                        "receive_pattern = \"line\"\nreceive_aperture_m = 0.1\n";
  for (const std::string& seabed :
       {std::string(gsab), std::string(relief) + std::string(texture).substr(17)}) {
    SCOPED_TRACE(seabed);
    const std::string online = seabed.starts_with("law") ? "" : cells,
                      more = apart + (online.empty() ? "" : patterns);
    const auto scene = [&](const std::string& keys) {
      return online +
             replaced(replaced(scene_of(seabed, gradient(-0.5, 60, keys)), "samples = 56", "samples = 14"),
                      "window_length_m = 14", "window_length_m = 7") +
             more;
    };
    const Checkpoint run(scene(""), {"--reference", "--tolerance", "3e-2"});
    ASSERT_EQ(run.outcome.exit_code, 0) << run.outcome.err;
    const Echoes echoes = read_echoes(run.folder / "out/echoes.nc"),
                 ordinary = echoes_of(scene("refraction_tolerance_db = 0.002\nrefraction_gap_m = 0.0001\n"));
    double bounds = 0, energies = 0;
    for (std::size_t k = 0; k < echoes.samples; ++k) {
      const double off = 2 * 1e-4 / 0.5 + 5e-4;
      EXPECT_LE(std::abs(echoes.energy[k] - ordinary.energy[k]),
                echoes.energy_bound[k] + off * ordinary.energy[k])
          << k;
      bounds += echoes.energy_bound[k];
      energies += echoes.energy[k];
    }
    EXPECT_GT(energies, 0);
    EXPECT_LT(bounds, 0.05 * energies);
  }
}

// The paths go down to the seabed, up to the surface and down again, and straight back. The result agrees
// with the ordinary run within the 0.1 dB that the ordinary run promises.
TEST(RefractedReferenceRun, HoldsOrdinaryRunsOverMirrors) {
  std::string scene =
      "[sea_surface]\nheight_m = 20\nloss_db = 1\n[paths]\norder = 3\n" + scene_in(gradient(-0.5, 60));
  scene = replaced(scene, "lambert_db = -27\n", "lambert_db = -27\nspecular_loss_db = 3\n");
  scene = replaced(scene, "width_m = 256\nlength_m = 256", "width_m = 16\nlength_m = 40");
  scene = replaced(replaced(scene, "heading_deg = 37", "heading_deg = 0"), "samples = 128", "samples = 4");
  scene =
      replaced(scene, "window_start_m = 8\nwindow_length_m = 32", "window_start_m = 31\nwindow_length_m = 8");
  const Checkpoint run(scene, {"--reference", "--tolerance", "1e-1"});
  ASSERT_EQ(run.outcome.exit_code, 0) << run.outcome.err;
  EXPECT_EQ(run.stats.at("reference").at("bins_over_tolerance"), 0);
  const Echoes echoes = read_echoes(run.folder / "out/echoes.nc"), ordinary = echoes_of(scene);
  for (std::size_t k = 0; k < echoes.samples; ++k) {
    EXPECT_GT(echoes.energy[k], 0) << k;
    EXPECT_LE(echoes.energy_bound[k], 0.1 * echoes.energy[k] * 1.001) << k;
    EXPECT_LE(std::abs(echoes.energy[k] - ordinary.energy[k]),
              echoes.energy_bound[k] + 0.0233 * ordinary.energy[k])
        << k;
  }
}

// In the view of each transmission, the cells are those of a seabed that is refined once.
TEST(RefractedReferenceRun, ReliefOfEachTransmissionIsThatOfAllTransmissions) {
  const std::string scene = scene_of(relief, gradient(-0.5));
  const std::vector<std::string> requested{"--reference", "--tolerance", "2e-2"};
  const Checkpoint online("[relief]\nmode = \"online\"\ncell_m = 0.4\ntolerance = 0\n" + scene, requested),
      offline("[relief]\nmode = \"offline\"\ncell_m = 0.4\n" + scene, requested);
  ASSERT_EQ(online.outcome.exit_code, 0) << online.outcome.err;
  ASSERT_EQ(offline.outcome.exit_code, 0) << offline.outcome.err;
  EXPECT_EQ(online.stats.at("reference").at("bins_over_tolerance"), 0);
  EXPECT_GT(online.stats.at("relief").at("facets_made").get<int>(), 100);
  const Echoes one = read_echoes(online.folder / "out/echoes.nc"),
               all = read_echoes(offline.folder / "out/echoes.nc"),
               flat = echoes_of(replaced(scene, relief, "lambert_db = -27\n"));
  double largest = 0;
  for (std::size_t k = 0; k < one.samples; ++k) {
    EXPECT_LE(std::abs(one.energy[k] - all.energy[k]), 1e-6 * all.energy[k]) << k;
    if (all.energy[k] > 0) largest = std::max(largest, std::abs(flat.energy[k] / all.energy[k] - 1));
  }
  EXPECT_GT(largest, 0.1);  // it is not flat
}

// A first apparent map of a few facets may gain nothing from a few more facets. This does not stop the
// refinement: a tighter tolerance gives no wider bounds than a loose one.
TEST(RefractedReferenceRun, TighterTolerancesHaveNoWiderBounds) {
  const TestFolder folder;
  constexpr std::array steps{0, 1, -8, 8, -1, -10, 6, -3, -2, 4, -5, -4, 2, 3, -6};  // cm
  std::string seabed = "ncols 24\nnrows 24\nxllcorner -12\nyllcorner -12\ncellsize 1\n";
  for (std::size_t row = 0; row < 24; ++row)
    for (std::size_t column = 0; column < 24; ++column)
      seabed +=
          fmt::format("{}{}", 0.01 * steps[(column + 9 * row) % steps.size()], column < 23 ? " " : "\n");
  const std::string scene =
      "[water]\nprofile = \"gradient\"\nsound_speed_m_s = 1500\ngradient_per_s = 0.5\nprofile_bottom_m = 40\n"
      "surface_height_m = 6.5\n[[materials]]\nname = \"rock\"\n[[terrain]]\nkind = \"raster\"\nfile = \"" +
      folder.write("bed.asc", seabed).string() +
      "\"\n[trajectory]\nkind = \"fixed\"\nposition_m = [0, 0, 6]\n[[sensors]]\nname = \"sonar\"\n"
      "kind = \"imaging\"\nbeams = 1\nhorizontal_deg = 2\nvertical_deg = 10\ntilt_deg = 50\n"
      "receiver_arm_m = [0, 1, 0]\nrange_min_m = 7\nrange_max_m = 12\nsamples = 4\n";
  for (const char* tolerance : {"9e-3", "7e-3", "3e-3", "1e-3"}) {
    const Checkpoint run(scene, {"--reference", "--tolerance", tolerance});
    ASSERT_EQ(run.outcome.exit_code, 0) << run.outcome.err;
    EXPECT_EQ(run.stats.at("reference").at("bins_over_tolerance"), 0) << tolerance;
  }
}

TEST(RefractedReferenceRun, SaysThatOneRayAloneIsFollowed) {
  const Checkpoint run(scene_of(texture, gradient(-0.5)), {"--reference", "--tolerance", "3e-2"});
  ASSERT_EQ(run.outcome.exit_code, 0) << run.outcome.err;
  EXPECT_THAT(run.stats.at("refraction").at("branches").get<std::string>(),
              HasSubstr("in references, tubefoot computes only the first arrival"));
}

}  // namespace
}  // namespace tubefoot
