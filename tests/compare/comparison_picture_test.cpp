// SPDX-License-Identifier: GPL-3.0-or-later
// Tests comparison pictures: the cells of candidate and ratio, orientation of waterfalls, colours, any
// sensor size, and texts that do not overlap.

#include "compare/comparison_picture.hpp"

#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "fixtures/world/recordings.hpp"

namespace tubefoot {
namespace {

SensorEchoes even_echoes(std::size_t pings, std::size_t beams, std::size_t samples) {
  SensorEchoes echoes;
  echoes.name = "sonar";
  echoes.pings = pings, echoes.beams = beams, echoes.samples = samples;
  for (std::size_t k = 0; k < samples; ++k) echoes.slant_range_m.push_back(5 + 0.5 * double(k));
  for (std::size_t k = 0; k < beams; ++k) echoes.beam_azimuth_deg.push_back(double(k));
  echoes.energy.assign(pings * beams * samples, 1e-9);
  return echoes;
}

struct Pixels {
  int width = 0, height = 0;
  std::vector<float> values;
  Colour at(int x, int y) const {
    const float* pixel = &values[3 * (std::size_t(y) * width + x)];
    return {pixel[0], pixel[1], pixel[2]};
  }
};

Pixels drawn(const SensorEchoes& reference, const SensorEchoes& candidate, std::size_t ping = 0,
             const std::string& font = "") {
  const TestFolder folder;
  draw_comparison({{&reference, &candidate, 1e-12, ping}}, {"one line", "another"}, font)
      .write_png(folder / "picture.png", "");
  auto input = OIIO::ImageInput::open((folder / "picture.png").string());
  Pixels pixels{input->spec().width, input->spec().height, {}};
  pixels.values.resize(std::size_t(3) * pixels.width * pixels.height);
  input->read_image(0, 0, 0, 3, OIIO::TypeDesc::FLOAT, pixels.values.data());
  return pixels;
}

/// A rectangle of pixels, [x0, x1) x [y0, y1).
struct Box {
  int x0 = 1 << 20, y0 = 1 << 20, x1 = 0, y1 = 0;
  int pixels = 0;
  int width() const { return x1 - x0; }
  int height() const { return y1 - y0; }
};

/// Returns the differences of two pictures per panel. Columns without differences separate the panels.
std::vector<Box> differences(const Pixels& a, const Pixels& b) {
  EXPECT_EQ(a.width, b.width);
  EXPECT_EQ(a.height, b.height);
  std::vector<Box> boxes;
  int last_x = -1000;
  for (int x = 0; x < a.width; ++x) {
    for (int y = 0; y < a.height; ++y) {
      const Colour p = a.at(x, y), q = b.at(x, y);
      if (std::abs(p.red - q.red) + std::abs(p.green - q.green) + std::abs(p.blue - q.blue) < 1e-3) continue;
      if (x > last_x + 1) boxes.emplace_back();
      last_x = x;
      Box& box = boxes.back();
      box = {std::min(box.x0, x), std::min(box.y0, y), std::max(box.x1, x + 1), std::max(box.y1, y + 1),
             box.pixels + 1};
    }
  }
  return boxes;
}

/// Returns the change after halving a bin of the candidate: its cells in the panels of the candidate and of
/// the ratio.
std::vector<Box> halved(const SensorEchoes& reference, std::size_t ping, std::size_t beam, std::size_t sample,
                        std::size_t drawn_ping = 0) {
  SensorEchoes candidate = reference;
  candidate.energy[(ping * reference.beams + beam) * reference.samples + sample] *= 0.5;
  return differences(drawn(reference, reference, drawn_ping), drawn(reference, candidate, drawn_ping));
}

TEST(ComparisonPicture, ABinIsACellOfTheCandidateAndOfTheRatio) {
  const SensorEchoes echoes = even_echoes(3, 5, 20);
  const auto first = halved(echoes, 1, 0, 0, 1), right = halved(echoes, 1, 1, 0, 1),
             up = halved(echoes, 1, 0, 1, 1);
  ASSERT_EQ(first.size(), 2u);
  ASSERT_EQ(right.size(), 2u);
  ASSERT_EQ(up.size(), 2u);
  for (std::size_t panel : {0u, 1u}) {
    const Box& box = first[panel];
    EXPECT_EQ(box.pixels, box.width() * box.height());
    EXPECT_GE(box.width() * 5, 300);
    EXPECT_GE(box.height() * 20, 260);
    EXPECT_EQ(right[panel].x0, box.x1);
    EXPECT_EQ(right[panel].y0, box.y0);
    EXPECT_EQ(up[panel].x0, box.x0);
    EXPECT_EQ(up[panel].y1, box.y0);
  }
  EXPECT_TRUE(halved(echoes, 0, 0, 0, 1).empty()) << "another ping is drawn";
}

TEST(ComparisonPicture, AWaterfallHasBeamZeroToTheLeftAndTheLastPingOnTop) {
  const SensorEchoes echoes = even_echoes(4, 2, 10);
  ASSERT_TRUE(drawn_as_waterfall(echoes));
  EXPECT_FALSE(drawn_as_waterfall(even_echoes(4, 3, 10)));
  const auto port = halved(echoes, 0, 0, 0), far_port = halved(echoes, 0, 0, 9),
             starboard = halved(echoes, 0, 1, 0), far_starboard = halved(echoes, 0, 1, 9),
             later = halved(echoes, 3, 0, 0);
  for (std::size_t panel : {0u, 1u}) {
    EXPECT_EQ(starboard.at(panel).x0, port.at(panel).x1);
    EXPECT_EQ(port[panel].x0 - far_port.at(panel).x0, 9 * port[panel].width());
    EXPECT_EQ(far_starboard.at(panel).x0 - starboard[panel].x0, 9 * port[panel].width());
    EXPECT_EQ(port[panel].y0 - later.at(panel).y0, 3 * port[panel].height());
  }
}

TEST(ComparisonPicture, RatioIsBlueWhereTheCandidateIsWeakerAndDarkWhereNothingIsLit) {
  const SensorEchoes reference = even_echoes(1, 4, 10);
  SensorEchoes candidate = reference;
  candidate.energy[0 * 10 + 0] = 0;     // missed
  candidate.energy[1 * 10 + 0] = 1e-6;  // far too much
  const Pixels picture = drawn(reference, candidate);
  const auto boxes = halved(reference, 0, 0, 0);  // its ratio is 0 elsewhere
  const Box cell = boxes.at(1);
  const auto colour_of = [&](int beam) {
    return picture.at(cell.x0 + beam * cell.width() + cell.width() / 2, cell.y0 + cell.height() / 2);
  };
  const auto expect_colour = [](Colour a, Colour b) {
    constexpr double half_a_step = 0.501 / 255;  // pictures have 8 bits
    EXPECT_NEAR(a.red, b.red, half_a_step);
    EXPECT_NEAR(a.green, b.green, half_a_step);
    EXPECT_NEAR(a.blue, b.blue, half_a_step);
  };
  expect_colour(colour_of(0), difference_colour(-1));
  expect_colour(colour_of(1), difference_colour(1));
  expect_colour(colour_of(2), difference_colour(0));
  SensorEchoes silent = reference;
  silent.energy.assign(40, 1e-13);  // below the threshold
  const Pixels dark = drawn(silent, silent);
  const Colour nothing = dark.at(cell.x0 + 3, cell.y0 + 3);
  EXPECT_LT(nothing.red + nothing.green + nothing.blue, 0.5);
}

TEST(ComparisonPicture, DivergingColoursAreMirroredInMeaning) {
  EXPECT_GT(difference_colour(-1).blue, 2 * difference_colour(-1).red);
  EXPECT_GT(difference_colour(1).red, 2 * difference_colour(1).blue);
  EXPECT_GT(difference_colour(0).red, 0.9f);
  EXPECT_NEAR(difference_colour(0).red, difference_colour(0).blue, 0.05);
  EXPECT_EQ(difference_colour(7).red, difference_colour(1).red);
  EXPECT_EQ(difference_colour(-7).red, difference_colour(-1).red);
}

TEST(ComparisonPicture, SensorsOfAnySizeAreDrawn) {
  for (const auto& [pings, beams, samples] : std::vector<std::array<std::size_t, 3>>{
           {1, 1, 1}, {1, 2, 1}, {1, 3, 1}, {2, 1, 3000}, {3000, 2, 700}, {1, 700, 3}, {2, 1024, 1500}}) {
    const SensorEchoes echoes = even_echoes(pings, beams, samples);
    const Canvas canvas = draw_comparison({{&echoes, &echoes, 1e-12, pings - 1}}, {}, label_font());
    EXPECT_LE(canvas.width(), 2000) << pings << " x " << beams << " x " << samples;
    EXPECT_LE(canvas.height(), 1100);
    EXPECT_GE(canvas.width(), 1000);
  }
  const SensorEchoes a = even_echoes(2, 4, 10), b = even_echoes(5, 2, 10);
  const int one = draw_comparison({{&a, &a, 0, 0}}, {}, "").height(),
            both = draw_comparison({{&a, &a, 0, 0}, {&b, &b, 0, 0}}, {}, "").height();
  EXPECT_GT(both, one + 260);
  EXPECT_THROW(draw_comparison({}, {}, ""), std::invalid_argument);
}

TEST(ComparisonPicture, TextsStayApartWhateverIsCompared) {
  if (label_font().empty()) GTEST_SKIP() << "no font is installed";
  for (const auto& [pings, beams, samples] : std::vector<std::array<std::size_t, 3>>{
           {1, 1, 1}, {1, 1, 300}, {3, 2, 5000}, {100'000, 2, 3}, {2, 512, 900}, {1, 12, 40}}) {
    SensorEchoes echoes = even_echoes(pings, beams, samples);
    echoes.name = "a-sonar-with-a-name-of-its-own";
    const Canvas canvas = draw_comparison({{&echoes, &echoes, 1e-12, 0}, {&echoes, &echoes, 1e-12, 0}},
                                          {"reference: " + std::string(90, 'r'), "candidate"}, label_font());
    const std::vector<PixelBox>& texts = canvas.texts();
    EXPECT_GT(texts.size(), 40u);
    for (std::size_t a = 0; a < texts.size(); ++a) {
      EXPECT_TRUE(texts[a].left >= 0 && texts[a].top >= 0 && texts[a].right <= canvas.width() &&
                  texts[a].bottom <= canvas.height())
          << pings << " x " << beams << " x " << samples << ", text " << a;
      for (std::size_t b = 0; b < a; ++b)
        EXPECT_FALSE(texts[a].left < texts[b].right && texts[b].left < texts[a].right &&
                     texts[a].top < texts[b].bottom && texts[b].top < texts[a].bottom)
            << pings << " x " << beams << " x " << samples << ": texts " << b << " and " << a;
    }
  }
}

}  // namespace
}  // namespace tubefoot
