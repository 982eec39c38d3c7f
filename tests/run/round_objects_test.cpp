// SPDX-License-Identifier: GPL-3.0-or-later
// Compares a Lambert sphere in whole runs with its closed form. Without facet settings the sphere is as
// fine as the resolution of the sensor.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <boost/math/quadrature/gauss_kronrod.hpp>
#include <cmath>

#include "fixtures/program.hpp"
#include "fixtures/world/echoes.hpp"
#include "geometry/numbers/scalars.hpp"

namespace tubefoot {
namespace {

using testing::HasSubstr;

constexpr double away_m = 6, radius_m = 1;
const double object_mu = std::pow(10, -1.0);

std::string scene(const std::string& object, int samples) {
  return fmt::format(R"(
[water]
sound_speed_m_s = 1500
absorption_db_per_km = 0
[[materials]]
name = "steel"
lambert_db = -10
[[objects]]
name = "ball"
{}
position_m = [0.31, 5.9919853, 0]
heading_deg = 17
[trajectory]
kind = "fixed"
[[sensors]]
name = "s"
kind = "imaging"
beams = 1
horizontal_deg = 40
vertical_deg = 40
range_min_m = 4.8
range_max_m = 6
samples = {}
)",
                     object, samples);
}

/// Energy of the sphere between two slant ranges. The sonar sees the sphere up to the limb.
double closed_form(double from_m, double to_m) {
  const double d = away_m, a = radius_m, grazing = std::sqrt(d * d - a * a);
  from_m = std::clamp(from_m, d - a, grazing);
  to_m = std::clamp(to_m, d - a, grazing);
  if (!(to_m > from_m)) return 0;
  return boost::math::quadrature::gauss_kronrod<double, 31>::integrate(
      [&](double r) {
        const double cosine = (d * d - a * a - r * r) / (2 * a * r);
        return object_mu * cosine * cosine * std::pow(r, -4) * 2 * pi * a * r / d;
      },
      from_m, to_m, 8, 1e-12);
}

TEST(RoundObjects, ASphereReturnsWhatItsClosedFormSaysBinByBin) {
  for (const int samples : {12, 60, 240}) {
    const Echoes echoes = echoes_of(scene("shape = \"sphere\"\n", samples));
    double total = 0, exact = 0, loudest = 0;
    for (std::size_t k = 0; k < echoes.samples; ++k)
      loudest = std::max(loudest, closed_form(echoes.first_m(k), echoes.last_m(k)));
    for (std::size_t k = 0; k < echoes.samples; ++k) {
      const double expected = closed_form(echoes.first_m(k), echoes.last_m(k));
      total += echoes.at(0, 0, k);
      exact += expected;
      EXPECT_NEAR(echoes.at(0, 0, k), expected, 0.03 * loudest) << samples << " samples, " << k;
    }
    EXPECT_NEAR(total / exact, 1, 1e-3) << samples;
  }
}

TEST(RoundObjects, CoarseSpheresKeepTheirTotal) {
  for (const double chord : {0.05, 0.01, 0.002}) {
    const Echoes echoes =
        echoes_of(scene(fmt::format("shape = \"sphere\"\nchord_error_m = {}\n", chord), 60));
    EXPECT_NEAR(echoes.total() / closed_form(0, 10), 1, 0.3 * chord) << chord;
  }
}

TEST(RoundObjects, CheckTellsHowRoundTheyAre) {
  const TestFolder folder;
  const auto told = [&](const std::string& object, int samples) {
    const Outcome outcome =
        run_program({"check", folder.write("scene.toml", scene(object, samples)).string()});
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    return outcome.out;
  };
  EXPECT_THAT(told("shape = \"sphere\"\n", 100),
              HasSubstr("ball: the facets have the area of the curved surface and are within 750 um of it (a "
                        "sixteenth of the resolution of 's', 0.012 m in range)"));
  EXPECT_THAT(told("shape = \"cylinder\"\nchord_error_m = 0.004\n", 100),
              HasSubstr("are within 4 mm of it (from the scene)"));
  EXPECT_THAT(told("shape = \"cone\"\n", 1), HasSubstr("are within 20 mm of it (a fiftieth of the radius)"));
  EXPECT_THAT(told("shape = \"sphere\"\n", 10000),
              HasSubstr("are within 300 um of it (the finest default, which is coarser than"));
}

}  // namespace
}  // namespace tubefoot
