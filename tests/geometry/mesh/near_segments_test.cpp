// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/mesh/near_segments.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <set>
#include <vector>

namespace tubefoot {
namespace {

using Pairs = std::set<std::pair<std::uint32_t, std::uint32_t>>;

double cross(glm::dvec2 u, glm::dvec2 v) { return u.x * v.y - u.y * v.x; }

/// Returns whether segments with small integer coordinates have a common point: exact in doubles.
bool meet(const PlanSegment& s, const PlanSegment& t) {
  const double a = cross(t.b - t.a, s.a - t.a), b = cross(t.b - t.a, s.b - t.a),
               c = cross(s.b - s.a, t.a - s.a), d = cross(s.b - s.a, t.b - s.a);
  if (a * b > 0 || c * d > 0) return false;
  for (int axis = 0; axis < 2; ++axis)
    if (std::max(s.a[axis], s.b[axis]) < std::min(t.a[axis], t.b[axis]) ||
        std::max(t.a[axis], t.b[axis]) < std::min(s.a[axis], s.b[axis]))
      return false;
  return true;
}

TEST(NearSegments, VisitsEveryPairThatMeets) {
  constexpr unsigned seed = 20261127;
  std::mt19937 random(seed);
  for (const int length : {3, 40, 1000}) {
    SCOPED_TRACE(length);
    std::uniform_int_distribution<int> anywhere(-1000, 1000), aside(-length, length);
    std::vector<PlanSegment> segments;
    for (int k = 0; k < 400; ++k) {
      const glm::dvec2 a(anywhere(random), anywhere(random));
      segments.push_back({a, a + glm::dvec2(aside(random), aside(random))});
    }
    for (int k = 0; k < 50; ++k) {  // collinear segments, vertical ones, points
      segments.push_back({{k, k}, {k + 7, k + 7}});
      segments.push_back({{500, 3 * k}, {500, 3 * k + 4}});
      segments.push_back({{2 * k, 2 * k}, {2 * k, 2 * k}});
    }
    Pairs visited;
    for_each_near_pair(segments, [&](std::uint32_t i, std::uint32_t j) {
      EXPECT_LT(i, j);
      visited.emplace(i, j);
    });
    for (std::uint32_t i = 0; i < segments.size(); ++i)
      for (std::uint32_t j = i + 1; j < segments.size(); ++j)
        if (meet(segments[i], segments[j])) {
          EXPECT_TRUE(visited.contains({i, j})) << i << ' ' << j;
        }
  }
}

// Their bounding boxes all overlap.
TEST(NearSegments, ComparesFewPairsOfLongParallelSegments) {
  for (const glm::dvec2 along : {glm::dvec2(1000, 0), glm::dvec2(0, 1000), glm::dvec2(700, 300)}) {
    std::vector<PlanSegment> segments;
    constexpr int count = 20'000;
    for (int k = 0; k < count; ++k) {
      const glm::dvec2 from = glm::dvec2(-along.y, along.x) * (k * 1e-5);
      segments.push_back({from, from + along});
    }
    std::size_t visits = 0;
    for_each_near_pair(segments, [&](std::uint32_t, std::uint32_t) { ++visits; });
    EXPECT_LT(visits, std::size_t{20} * count);
  }
}

}  // namespace
}  // namespace tubefoot
