// SPDX-License-Identifier: GPL-3.0-or-later
// Tests that texts from the cache look the same as texts that the library draws each time.
#include "sensors/pictures/text_mask.hpp"

#include <OpenImageIO/imagebufalgo.h>
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "sensors/pictures/canvas.hpp"

namespace tubefoot {
namespace {

constexpr int mask_width = 400, mask_height = 60;
constexpr Colour ground{0.1f, 0.2f, 0.3f}, ink{0.9f, 0.8f, 0.4f};

/// The pixels of a line of text that OpenImageIO draws on a uniform background.
std::vector<float> drawn_at_once(int x, int baseline, const std::string& line, int size) {
  std::vector<float> pixels;
  for (int k = 0; k < mask_width * mask_height; ++k)
    pixels.insert(pixels.end(), {ground.red, ground.green, ground.blue});
  OIIO::ImageBuf image(OIIO::ImageSpec(mask_width, mask_height, 3, OIIO::TypeDesc::FLOAT), pixels.data());
  const float components[] = {ink.red, ink.green, ink.blue};
  EXPECT_TRUE(OIIO::ImageBufAlgo::render_text(image, x, baseline, line, size, label_font(), components));
  return pixels;
}

void expect_drawn_as_at_once(const std::string& line, int size) {
  Canvas canvas(mask_width, mask_height, ground, label_font());
  canvas.text(20, 30, line, size, ink);
  const int baseline = 30 + static_cast<int>(std::lround(0.365 * size));
  const std::vector<float> expected = drawn_at_once(20, baseline, line, size);
  double most = 0, inked = 0;
  for (std::size_t k = 0; k < expected.size(); ++k) {
    most = std::max(most, std::abs(static_cast<double>(canvas.components()[k]) - expected[k]));
    inked += std::abs(expected[k] - (k % 3 == 0 ? ground.red : k % 3 == 1 ? ground.green : ground.blue));
  }
  EXPECT_LT(most, 1e-5) << line << ", " << size;
  EXPECT_GT(inked, 10) << line;
}

TEST(TextMask, IsWhatTheLibraryDraws) {
  if (label_font().empty()) GTEST_SKIP() << "no font is installed";
  for (const int size : {12, 16, 22})
    for (const char* line : {"0 dB: -31.2 dB re 1 J/m2", "jgpqy,;()[]|", "W", "AVAToTeffi", " 1.5 m "})
      for (int again = 0; again < 2; ++again) expect_drawn_as_at_once(line, size);
}

TEST(TextMask, SurvivesMoreLinesThanAreKept) {
  if (label_font().empty()) GTEST_SKIP() << "no font is installed";
  expect_drawn_as_at_once("ping 0", 16);
  for (int k = 0; k < 1000; ++k) EXPECT_GT(text_mask(fmt::format("ping {}", k), 16, label_font()).length, 0);
  expect_drawn_as_at_once("ping 0", 16);
}

TEST(TextMask, IsCutAtThePicturesBorders) {
  if (label_font().empty()) GTEST_SKIP() << "no font is installed";
  Canvas canvas(30, 10, ground, label_font());
  for (const auto& [x, y] : {std::pair{-40, 5}, {20, -3}, {25, 12}, {5, 5}})
    canvas.text(x, y, "a title that is too long", 22, ink);
  EXPECT_EQ(canvas.texts().size(), 4u);
}

TEST(TextMask, OfBlanksHasNoPixels) {
  if (label_font().empty()) GTEST_SKIP() << "no font is installed";
  EXPECT_TRUE(text_mask("   ", 16, label_font()).coverage.empty());
}

}  // namespace
}  // namespace tubefoot
