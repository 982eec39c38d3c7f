// SPDX-License-Identifier: GPL-3.0-or-later
// Compares outlines of unions with known areas, and tests the other parts of drawings: lines, names, scales
// and texts.
#include "plan/silhouette.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <sstream>

#include "plan/painter.hpp"

namespace tubefoot {
namespace {

/// The loops of a path "M1 2L3 4Z...".
std::vector<std::vector<glm::dvec2>> loops_of(std::string data) {
  for (char& c : data)
    if (c == 'L') c = ' ';
  std::vector<std::vector<glm::dvec2>> loops;
  std::istringstream all(data);
  for (std::string loop; std::getline(all, loop, 'Z');) {
    EXPECT_EQ(loop.front(), 'M');
    std::istringstream numbers(loop.substr(1));
    std::vector<glm::dvec2> points;
    for (double x, y; numbers >> x >> y;) points.push_back({x, y});
    loops.push_back(points);
  }
  return loops;
}

/// Holes have the opposite orientation and a negative area.
double area_of(const std::string& data) {
  double sum = 0;
  for (const auto& loop : loops_of(data))
    for (std::size_t k = 0; k < loop.size(); ++k) {
      const glm::dvec2 a = loop[k], b = loop[(k + 1) % loop.size()];
      sum += (a.x * b.y - a.y * b.x) / 2;
    }
  return sum;
}

constexpr Box paper{10, 20, 410, 320};

void add_disc(Silhouette& silhouette, glm::dvec2 middle, double radius) {
  std::vector<glm::dvec2> points;
  for (int k = 0; k < 90; ++k) {
    const double angle = 2 * std::numbers::pi * k / 90;
    points.push_back(middle + radius * glm::dvec2(std::cos(angle), std::sin(angle)));
  }
  silhouette.add(points);
}

TEST(Silhouette, CoversADiscAndTwoThatOverlapOnce) {
  Silhouette one(paper), two(paper);
  add_disc(one, {200, 150}, 60);
  const double disc = std::numbers::pi * 60 * 60, half_a_cell_about = 2 * std::numbers::pi * 60 * 0.5;
  EXPECT_NEAR(area_of(one.path()), disc, half_a_cell_about);
  // They overlap by the lens of two circles whose middles are a radius apart.
  add_disc(two, {200, 150}, 60);
  add_disc(two, {260, 150}, 60);
  const double lens = 60 * 60 * (2 * std::numbers::pi / 3 - std::sqrt(3.0) / 2);
  EXPECT_NEAR(area_of(two.path()), 2 * disc - lens, 2 * half_a_cell_about);
  EXPECT_EQ(loops_of(two.path()).size(), 1u);
}

TEST(Silhouette, HasHoles) {
  Silhouette ring(paper);
  for (int k = 0; k < 60; ++k) {
    const auto at = [&](int step, double radius) {
      const double angle = 2 * std::numbers::pi * step / 60;
      return glm::dvec2(200, 150) + radius * glm::dvec2(std::cos(angle), std::sin(angle));
    };
    const std::array<glm::dvec2, 4> part{at(k, 50), at(k, 100), at(k + 1, 100), at(k + 1, 50)};
    ring.add(part);
  }
  EXPECT_EQ(loops_of(ring.path()).size(), 2u);
  EXPECT_NEAR(area_of(ring.path()), std::numbers::pi * (100 * 100 - 50 * 50),
              2 * std::numbers::pi * 150 * 0.5);
}

TEST(Silhouette, IsCutOffAtItsBoxAndTheThinnestBeamIsSeen) {
  Silhouette silhouette(paper);
  EXPECT_TRUE(silhouette.empty());
  EXPECT_EQ(silhouette.path(), "");
  const std::array<glm::dvec2, 3> huge{{{-1e12, -1e12}, {1e12, -1e12}, {0, 1e12}}};
  silhouette.add(huge);
  EXPECT_NEAR(area_of(silhouette.path()), paper.width() * paper.height(), 1);
  Silhouette thin(paper);
  const std::array<glm::dvec2, 3> needle{{{50, 60}, {350, 280}, {350, 280.001}}};
  thin.add(needle);
  EXPECT_NEAR(thin.bounds().left, 50, 0.5);
  EXPECT_NEAR(thin.bounds().bottom, 280, 0.51);
  EXPECT_GT(area_of(thin.path()), 50);
  EXPECT_EQ(loops_of(thin.path()).size(), 1u);
  Silhouette outside(paper);
  const std::array<glm::dvec2, 3> elsewhere{{{500, 60}, {600, 60}, {600, 80}}};
  outside.add(elsewhere);
  const double not_a_number = std::nan("");
  const std::array<glm::dvec2, 3> nowhere{
      {{not_a_number, 1}, {2, not_a_number}, {not_a_number, not_a_number}}};
  outside.add(nowhere);
  EXPECT_TRUE(outside.empty());
}

TEST(Silhouette, UnionsOfRandomTrianglesHaveTheAreaOfTheirPixels) {
  std::mt19937 random(21);
  std::uniform_real_distribution<double> x(0, 420), y(0, 340);
  for (int trial = 0; trial < 20; ++trial) {
    Silhouette silhouette(paper);
    std::vector<std::array<glm::dvec2, 3>> triangles;
    for (int k = 0; k < 8; ++k) {
      triangles.push_back({{{x(random), y(random)}, {x(random), y(random)}, {x(random), y(random)}}});
      silhouette.add(triangles.back());
    }
    double covered = 0;
    for (int row = 0; row < 300; ++row)
      for (int column = 0; column < 400; ++column) {
        const glm::dvec2 p(paper.left + column + 0.5, paper.top + row + 0.5);
        bool in = false;
        for (const auto& t : triangles) {
          int left = 0;
          for (std::size_t k = 0; k < 3; ++k) {
            const glm::dvec2 a = t[k], b = t[(k + 1) % 3];
            left += (b.x - a.x) * (p.y - a.y) - (b.y - a.y) * (p.x - a.x) > 0;
          }
          in = in || left == 0 || left == 3;
        }
        covered += in;
      }
    // On average half of each touched border cell is outside, along borders of some thousand pixels.
    EXPECT_NEAR(area_of(silhouette.path()), covered, 2500);
    EXPECT_GT(area_of(silhouette.path()), covered - 100);
  }
}

TEST(DrawingParts, LinesAreClippedNearTheirBox) {
  const auto pieces = clipped({{-1e9, 150}, {1e9, 150}, {1e9, 151}, {-1e9, 151}}, paper);
  ASSERT_EQ(pieces.size(), 2u);
  for (const auto& piece : pieces)
    for (const glm::dvec2& p : piece) {
      EXPECT_GE(p.x, paper.left - 51);
      EXPECT_LE(p.x, paper.right + 51);
    }
  const std::vector<glm::dvec2> inside{{20, 30}, {100, 200}, {300, 40}};
  ASSERT_EQ(clipped(inside, paper).size(), 1u);
  EXPECT_EQ(clipped(inside, paper).front().size(), 3u);
  EXPECT_TRUE(clipped({{-500, -500}, {-400, 900}}, paper).empty());
  EXPECT_TRUE(clipped({{20, 30}}, paper).empty());
}

TEST(DrawingParts, NamesAreNeverOverEachOtherNorOutside) {
  Labels labels(paper);
  Sheet sheet;
  int put = 0;
  for (int k = 0; k < 60; ++k) put += labels.put(sheet, {200, 150, 204, 154}, "name of an object", {});
  EXPECT_EQ(put, 4);  // around a small object, with such wide names
  const std::string svg = sheet.svg(10, 10);
  std::vector<Box> boxes;
  for (std::size_t at = 0; (at = svg.find("<text x=\"", at)) != std::string::npos; ++at) {
    const double x = std::stod(svg.substr(at + 9)), y = std::stod(svg.substr(svg.find("y=\"", at) + 3));
    boxes.push_back({x, y - 9, x + width_of("name of an object", 11), y + 2});
  }
  ASSERT_EQ(boxes.size(), 4u);
  for (std::size_t a = 0; a < 4; ++a)
    for (std::size_t b = 0; b < a; ++b) EXPECT_FALSE(boxes[a].meets(boxes[b])) << a << " " << b;
  EXPECT_FALSE(labels.put(sheet, {800, 150, 804, 154}, "outside", {}));
  EXPECT_EQ(sheet.svg(10, 10).find("outside"), std::string::npos);
}

TEST(DrawingParts, ASideViewIsStretchedByOneTwoOrFiveTimesAPowerOfTen) {
  EXPECT_EQ(stretch_of({10, 5}, 440, 240), 1);
  EXPECT_EQ(stretch_of({100, 0}, 440, 240), 1);
  EXPECT_EQ(stretch_of({1000, 10}, 440, 240), 20);    // 4.4 pixels high; 0.9 x 240 / 4.4 = 49
  EXPECT_EQ(stretch_of({1e6, 10}, 440, 240), 20000);  // 0.0044 pixels
  for (double up = 1e-3; up < 100; up *= 1.7) {
    const double drawn = stretch_of({100, up}, 440, 240) * up * 4.4;
    EXPECT_LE(drawn, up * 4.4 > 240 ? up * 4.4 : 240);
    EXPECT_GT(drawn, 0.9 * 240 / 2.5 - 1e-9) << up;
  }
}

TEST(DrawingParts, TextsMayHoldAnything) {
  Sheet sheet;
  sheet.text({1, 2}, "<script>&\"\x1b\n");
  const std::string svg = sheet.svg(10, 10);
  EXPECT_EQ(svg.find("<script>"), std::string::npos);
  EXPECT_EQ(svg.find('\x1b'), std::string::npos);
  EXPECT_NE(svg.find("&lt;script&gt;&amp;"), std::string::npos);
}

}  // namespace
}  // namespace tubefoot
