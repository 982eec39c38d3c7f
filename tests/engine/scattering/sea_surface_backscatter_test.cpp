// SPDX-License-Identifier: GPL-3.0-or-later
// Tests the backscattering of the sea surface against values of a program in another language and against
// limits of the equations. Resolved and unresolved slopes together are those of the sea.
#include "engine/scattering/sea_surface_backscatter.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "geometry/numbers/scalars.hpp"

namespace tubefoot {
namespace {

double in_db(double value) { return 10 * std::log10(value); }

// Values of a Python program with the equations of docs/notes/sea-surface.md.
TEST(SeaSurfaceBackscatter, HasTheValuesOfItsEquations) {
  struct Row {
    double wind_m_s, frequency_khz, grazing_deg, strength_db, roughness, bubbles;
  };
  for (const Row& row : {Row{0.5, 20, 40, -54.0247, 3.221891e-06, 7.365960e-07},
                         Row{3, 25, 60, -34.4068, 3.501415e-04, 1.237136e-05},
                         Row{5, 30, 20, -39.2611, 1.056523e-06, 1.174899e-04},
                         Row{8, 60, 80, -1.4784, 7.076677e-01, 3.809156e-03},
                         Row{10, 25, 20, -22.5442, 1.403034e-06, 5.565118e-03},
                         Row{10, 25, 90, 4.3986, 2.739228e+00, 1.411529e-02},
                         Row{12, 90, 35, -25.6396, 1.191422e-05, 2.717297e-03},
                         Row{15, 10, 75, -6.9084, 1.856095e-01, 1.817004e-02}}) {
    SCOPED_TRACE(row.strength_db);
    const SeaSurfaceCrossSections parts =
        sea_surface_cross_sections({row.wind_m_s, row.frequency_khz, 0}, row.grazing_deg * degree);
    EXPECT_NEAR(parts.roughness() / row.roughness, 1, 1e-5);
    EXPECT_NEAR(parts.bubbles / row.bubbles, 1, 1e-5);
    EXPECT_NEAR(in_db(parts.total()), row.strength_db, 1e-4);
  }
}

// Few bubbles scatter each way once: beta per direct path, and four and one times as much with the paths via
// the surface. Many bubbles absorb everything that passes them: half of the albedo of a thick layer remains.
TEST(SeaSurfaceBackscatter, HasTheLimitsOfFewAndOfManyBubbles) {
  const auto bubbles = [](double wind, double khz, double grazing) {
    return sea_surface_cross_sections({wind, khz, 0}, grazing).bubbles;
  };
  // (1 + 8 b e^(-2b) - e^(-4b)) / (2b) -> 6 for b -> 0; the rest is proportional to the bubbles.
  const double damping = 0.0136 / (4 * pi * 2.55e-2 * std::cbrt(25.0)), few = std::pow(10, -5.2577 + 0.4701);
  EXPECT_NEAR(bubbles(1, 25, 1.0) / (6 * damping * few), 1, 1e-3);
  const double grazing = 5 * degree;
  EXPECT_NEAR(
      bubbles(25, 100, grazing) / (0.0136 / (8 * pi * 2.55e-2 * std::cbrt(100.0)) * std::sin(grazing)), 1,
      1e-3);
  EXPECT_GT(bubbles(6, 30, 0.5), 2.9 * bubbles(5, 30, 0.5));  // 10^0.47 per m/s
}

TEST(SeaSurfaceBackscatter, HasSlopesOfCoxAndMunkForASlickSea) {
  // Cox & Munk (1954), slick: 0.008 + 1.56e-3 U, which has no short waves either.
  for (const double wind : {5.0, 10.0, 14.0})
    EXPECT_NEAR(sea_surface_slope_variance(wind) / (0.008 + 1.56e-3 * wind), 1, 0.2) << wind;
  EXPECT_NEAR(sea_surface_slope_variance(0.999), sea_surface_slope_variance(1), 2e-5);
}

// At normal incidence the strength is that of the slopes alone: 1 / (4 pi s^2), without the loss in bubbles.
TEST(SeaSurfaceBackscatter, IsSpecularAtNormalIncidence) {
  const SeaSurfaceCrossSections parts = sea_surface_cross_sections({4, 30, 0}, pi / 2);
  EXPECT_NEAR(parts.facets * 4 * pi * sea_surface_slope_variance(4), 1, 1e-12);
  EXPECT_NEAR(parts.share_of_facets, 1, 0.01);
  EXPECT_EQ(parts.small_scale, 0);
}

// The facets of a mesh have slopes of variance r, and the model has the rest. The mean over the facets is
// then the model with all slopes. Facets at slope (p, q) have the area sqrt(1 + p^2 + q^2) per plan.
TEST(SeaSurfaceBackscatter, LosesTheSlopesThatFacetsShow) {
  const double wind = 9, all = sea_surface_slope_variance(wind);
  for (const double resolved : {0.3 * all, 0.7 * all})
    for (const double incidence_deg : {0.0, 5.0, 12.0}) {
      const double incidence = incidence_deg * degree, deviation = std::sqrt(resolved / 2);
      double mean = 0, weights = 0;
      constexpr int half = 60;
      for (int i = -half; i <= half; ++i)
        for (int j = -half; j <= half; ++j) {
          const double p = 5 * deviation * i / half, q = 5 * deviation * j / half,
                       weight = std::exp(-(p * p + q * q) / resolved), norm = std::sqrt(1 + p * p + q * q),
                       sine = (std::cos(incidence) + p * std::sin(incidence)) / norm;
          weights += weight;
          if (sine > 0)
            mean += weight * norm *
                    sea_surface_cross_sections({wind, 30, resolved}, std::asin(std::min(sine, 1.0))).facets;
        }
      const double whole = sea_surface_cross_sections({wind, 30, 0}, pi / 2 - incidence).facets;
      EXPECT_NEAR(in_db(mean / weights), in_db(whole), 0.35) << resolved / all << " " << incidence_deg;
      EXPECT_GT(std::abs(in_db(sea_surface_cross_sections({wind, 30, resolved}, pi / 2 - incidence).facets) -
                         in_db(whole)),
                0.5);
    }
}

TEST(SeaSurfaceBackscatter, KeepsAPartOfItsSlopes) {
  const double all = sea_surface_slope_variance(7);
  EXPECT_DOUBLE_EQ(sea_surface_cross_sections({7, 30, all}, 1.5).facets,
                   sea_surface_cross_sections({7, 30, 0.9 * all}, 1.5).facets);
}

// The table that integrators use follows the equations, and is a smooth function at normal incidence. The
// small-scale part ends at 85 degrees with a step, which the table passes in a quarter of a degree.
TEST(SeaSurfaceBackscatter, IsATableOfItsEquations) {
  for (const double wind : {0.5, 3.0, 7.0, 15.0, 30.0})
    for (const double khz : {10.0, 30.0, 100.0, 500.0})
      for (const double resolved : {0.0, 0.5, 1.0}) {
        const SeaSurfaceBackscatter sea{wind, khz, resolved * sea_surface_slope_variance(wind)};
        const ScatteringModel model = sea_surface_scattering(sea);
        SCOPED_TRACE(testing::Message() << wind << " m/s, " << khz << " kHz, " << resolved);
        for (double grazing_deg = 1; grazing_deg <= 90; grazing_deg += 0.37) {
          if (grazing_deg > 85 && grazing_deg < 85.5) continue;
          EXPECT_NEAR(in_db(model.cross_section(grazing_deg * degree)),
                      in_db(sea_surface_cross_sections(sea, grazing_deg * degree).total()), 0.15)
              << grazing_deg;
        }
        EXPECT_NEAR(model.cross_section(0.5 * degree) / model.cross_section(0.25 * degree), 4, 1e-3);
        EXPECT_FALSE(model.is_pointed());
        EXPECT_LT(model.pieces().size(), 100u);
      }
}

TEST(SeaSurfaceBackscatter, RefusesWindAndFrequencyThatAreNotAbove0) {
  EXPECT_THROW(sea_surface_scattering(SeaSurfaceBackscatter{0, 30, 0}), std::invalid_argument);
  EXPECT_THROW(sea_surface_scattering(SeaSurfaceBackscatter{5, -1, 0}), std::invalid_argument);
}

}  // namespace
}  // namespace tubefoot
