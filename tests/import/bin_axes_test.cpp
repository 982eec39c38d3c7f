// SPDX-License-Identifier: GPL-3.0-or-later
// Tests the directions of beams that are equidistant in several views.
#include "import/bin_axes.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "files/usage_error.hpp"

namespace tubefoot {
namespace {

/// Azimuths of the centres of beams that `import` assumes for these words.
std::vector<double> azimuths_of(const std::string& words, std::size_t beams) {
  const BinAxes reference{bin_intervals({-30, 30}), bin_intervals({1, 2})};
  ImportOptions options;
  options.azimuths = words;
  std::vector<std::string> told;
  return picture_axes(beams, 1, {}, reference, options, told).beams.centres;
}

TEST(Azimuths, OfViewsAreEquidistantInEach) {
  // Three views of 20 degrees with 4 beams: tangents of -3/4, -1/4, 1/4 and 3/4 of half a view.
  const std::vector<double> found = azimuths_of("tangent:20deg", 12);
  EXPECT_EQ(found, azimuths_of("tangent:3", 12));
  ASSERT_EQ(found.size(), 12U);
  constexpr double degree = M_PI / 180;
  for (std::size_t k = 0; k < 12; ++k) {
    const double view = -20 + 20 * double(k / 4), place = -0.75 + 0.5 * double(k % 4);
    EXPECT_NEAR(found[k], view + std::atan(place * std::tan(10 * degree)) / degree, 1e-12) << k;
  }
  // 11 beams: two views of 4 and one of 3, which all have the width of 4 beams.
  const std::vector<double> uneven = azimuths_of("tangent:3", 11);
  const double share = 60.0 / 11, half = 2 * share;
  for (std::size_t k = 0; k < 11; ++k) {
    const double view = -30 + share * 4 * double(k / 4) + half, place = -0.75 + 0.5 * double(k % 4);
    EXPECT_NEAR(uneven[k], view + std::atan(place * std::tan(half * degree)) / degree, 1e-12) << k;
  }
  EXPECT_EQ(azimuths_of("tangent", 11), azimuths_of("tangent:1", 11));
}

TEST(Azimuths, OfViewsAreThoseOfAReferenceThatListsThem) {
  // A list of axes has no outer borders, so that its sector is wider than 3 views of 20 degrees.
  for (const std::size_t beams : {12U, 96U, 300U}) {
    const BinAxes reference{bins_about(azimuths_of("tangent:3", beams)), bin_intervals({1, 2})};
    ASSERT_GT(reference.beams.edges.back(), 30) << beams;
    std::vector<std::string> told;
    for (const char* words : {"tangent:20deg", "tangent:3"}) {
      ImportOptions options;
      options.azimuths = words;
      EXPECT_EQ(picture_axes(beams, 1, {}, reference, options, told).beams.centres, reference.beams.centres)
          << words << " " << beams;
    }
    // Four views are other columns, and two views are wider than 20 degrees.
    ImportOptions four;
    four.azimuths = "tangent:4";
    EXPECT_NE(picture_axes(beams, 1, {}, reference, four, told).beams.centres, reference.beams.centres);
  }
}

TEST(Azimuths, OfInvalidViewsAreErrors) {
  for (const char* words : {"tangent:", "tangent:0", "tangent:-2", "tangent:1.5", "tangent:x", "tangent:3x",
                            "tangent:0deg", "tangent:13", "tangent:1e-300deg", "tangent:nan", "tangent:inf"})
    EXPECT_THROW(azimuths_of(words, 12), UsageError) << words;
}

}  // namespace
}  // namespace tubefoot
