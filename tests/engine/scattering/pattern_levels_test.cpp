// SPDX-License-Identifier: GPL-3.0-or-later
// Tests levels of beam patterns: the peak of a two-way pattern, receive gains below their peak, and the
// directions of a given gain.

#include "engine/scattering/pattern_levels.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

#include "geometry/numbers/scalars.hpp"

namespace tubefoot {
namespace {

using Kind = Directivity::Kind;

/// A pattern whose centre is `centre_deg` off the plane perpendicular to the axis.
Directivity pattern(Kind kind, glm::dvec3 axis, double size, double centre_deg = 0) {
  Directivity made;
  made.kind = kind;
  made.axis = axis;
  made.size = size;
  made.centre = std::sin(centre_deg * degree);
  return made;
}
Directivity about(Kind kind, glm::dvec3 axis, double size) {
  Directivity made = pattern(kind, axis, size);
  made.from_axis = true;
  return made;
}

const glm::dvec3 across(1, 0, 0), up(0, 0, 1);

TEST(TwoWayPeak, IsOneWhereBothPatternsHaveTheirPeak) {
  for (const double steered_deg : {-40., 0., 12.}) {
    const Directivity received = pattern(Kind::line, across, 200, steered_deg);
    EXPECT_DOUBLE_EQ(two_way_peak({}, received), 1);
    EXPECT_NEAR(two_way_peak(pattern(Kind::gaussian, up, 12 * degree, -20), received), 1, 1e-9);
    EXPECT_NEAR(two_way_peak(pattern(Kind::line, up, 500, 3), received), 1, 1e-9);
    EXPECT_NEAR(two_way_peak(pattern(Kind::line, across, 3, steered_deg), received), 1, 1e-9);
  }
  EXPECT_NEAR(two_way_peak(about(Kind::piston, glm::normalize(glm::dvec3(1, 2, -1)), 400), Directivity()), 1,
              1e-9);
}

// The product of two Gaussians of the same width has its maximum half way between them, where both have the
// same loss.
TEST(TwoWayPeak, IsThatOfTheProduct) {
  const double width = 10 * degree, apart = 8 * degree;
  const double product = std::exp(-4 * std::numbers::ln2 * 2 * std::pow(apart / 2 / width, 2));
  EXPECT_NEAR(two_way_peak(pattern(Kind::gaussian, up, width), pattern(Kind::gaussian, up, width, 8)),
              product, 1e-6);
  const glm::dvec3 ahead(0, 1, 0), aside(std::sin(apart), std::cos(apart), 0);
  EXPECT_NEAR(two_way_peak(about(Kind::gaussian, ahead, width), about(Kind::gaussian, aside, width)), product,
              1e-6);
  // Simultaneously transmitted beams add up.
  const Directivity one = pattern(Kind::gaussian, across, width, 4);
  EXPECT_NEAR(two_way_peak(TransmitPattern(std::vector{one, one}), one), 2, 1e-9);
}

TEST(TwoWayPeak, OfATableIsItsHighestLevel) {
  Directivity table = pattern(Kind::table, across, 0);
  table.table =
      std::make_shared<const PatternTable>(std::vector{-0.3, 0.1, 0.4}, std::vector{-30., 2., -10.});
  EXPECT_NEAR(two_way_peak({}, table), std::pow(10, 0.2), 1e-12);
}

TEST(ReceiveGainsBelowPeak, DoNotDependOnTheTransmitPattern) {
  Directivity table = pattern(Kind::table, across, 0);
  table.table =
      std::make_shared<const PatternTable>(std::vector{-0.3, 0.1, 0.4}, std::vector{-30., 2., -10.});
  BeamPatterns patterns;
  patterns.transmit = {pattern(Kind::gaussian, across, 5 * degree)};
  patterns.receive = {pattern(Kind::gaussian, across, 5 * degree, 20), Directivity(), table};
  patterns.fan_of_tube = {0};
  patterns.beams_of_tube = {{0, 3}};
  const std::vector<double> least = receive_gains_below_peak(patterns, 10);
  ASSERT_EQ(least.size(), 3u);
  EXPECT_NEAR(least[0], 0.1, 1e-12);
  EXPECT_NEAR(least[1], 0.1, 1e-12);
  EXPECT_NEAR(least[2], 0.1 * std::pow(10, 0.2), 1e-12);
  EXPECT_LT(gains_below_peak(patterns, 10, false)[0], 1e-3 * least[0]);
}

TEST(CosinesOfGain, HoldAllDirectionsOfThatGain) {
  Directivity table = pattern(Kind::table, across, 0, 5);
  table.table = std::make_shared<const PatternTable>(std::vector{-0.4, -0.3, -0.1, 0.1, 0.4},
                                                     std::vector{-30., -25., 0., -3., -40.});
  Directivity off_axis = table;
  off_axis.from_axis = true;
  Directivity shaded = pattern(Kind::line, across, 30, 25);
  shaded.shading = 0.7;
  for (const Directivity& p :
       {pattern(Kind::line, across, 30, 25), shaded, pattern(Kind::gaussian, across, 8 * degree, -50),
        about(Kind::gaussian, across, 8 * degree), about(Kind::piston, across, 20), table, off_axis})
    for (const double least : {0.9, 0.1, 0.01, 1e-6}) {
      const CosineRange range = cosines_of_gain(p, least);
      for (int k = -20000; k <= 20000; ++k) {
        const double cosine = k / 20000.;
        if (p.gain_at(cosine) >= least) {
          EXPECT_TRUE(cosine >= range.lo && cosine <= range.hi)
              << int(p.kind) << ' ' << least << ' ' << cosine;
        }
      }
    }
  EXPECT_LT(cosines_of_gain(pattern(Kind::line, across, 30, 25), 0.01).hi, std::sin(25 * degree) + 0.11);
}

}  // namespace
}  // namespace tubefoot
