// SPDX-License-Identifier: GPL-3.0-or-later
// Tests bounds of the height and slope that a triangle mesh leaves out of a relief map. It also tests their
// root mean squares over equilateral triangles.

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <memory>
#include <numbers>
#include <random>

#include "engine/relief/map_surface.hpp"
#include "engine/relief/relief_sum.hpp"
#include "engine/relief/spectral_relief.hpp"

namespace tubefoot {
namespace {

using Triangle = std::array<glm::dvec2, 3>;

double cross(glm::dvec2 a, glm::dvec2 b) { return a.x * b.y - a.y * b.x; }

/// Error of the plane of a triangle at one point: height, and slope by differences over a small step.
struct Miss {
  double height_m, slope;
};
Miss miss(const ElevationField& field, const Triangle& t, double a, double b) {
  const auto height = [&](glm::dvec2 p) { return field.height_m({p.x, p.y, 7}); };
  const std::array<double, 3> h{height(t[0]), height(t[1]), height(t[2])};
  const glm::dvec2 u = t[1] - t[0], v = t[2] - t[0], place = t[0] + a * u + b * v;
  const double area = cross(u, v);
  const glm::dvec2 plane{((h[1] - h[0]) * v.y - (h[2] - h[0]) * u.y) / area,
                         ((h[2] - h[0]) * u.x - (h[1] - h[0]) * v.x) / area};
  const double step = 1e-5 * field.finest_m();
  const glm::dvec2 slope{
      (height(place + glm::dvec2(step, 0)) - height(place - glm::dvec2(step, 0))) / (2 * step),
      (height(place + glm::dvec2(0, step)) - height(place - glm::dvec2(0, step))) / (2 * step)};
  return {height(place) - (h[0] + a * (h[1] - h[0]) + b * (h[2] - h[0])), glm::length(slope - plane)};
}

bool no_angle_over_120(const Triangle& t) {
  for (int i = 0; i < 3; ++i) {
    const glm::dvec2 a = t[(i + 1) % 3] - t[i], b = t[(i + 2) % 3] - t[i];
    if (glm::dot(a, b) < -0.5 * glm::length(a) * glm::length(b)) return false;
  }
  return true;
}

/// A ridge of one node, a step, and noise, which no spectrum produces.
std::shared_ptr<const SplineSurface> odd_map(bool periodic) {
  HeightMap map{37, 50, 3, -2, 0.2, 0.3, periodic, std::vector<double>(37 * 50)};
  std::mt19937_64 random(4);
  std::uniform_real_distribution<double> noise(-0.02, 0.02);
  for (std::size_t n = 0; n < map.height_m.size(); ++n)
    map.height_m[n] = noise(random) + (n % 37 == 20 ? 0.5 : 0) + (n / 37 > 30 ? 0.3 : 0);
  return make_surface(map);
}

std::vector<std::shared_ptr<const ElevationField>> fields() {
  const auto rock = make_surface(FractalRelief{{10, 0.05, 1}, 0.5, 0.2});
  const auto ripples = make_surface(RippleRelief{{10, 0.05, 2}, 0.5, 30, 0.9, 0.02});
  return {rock, ripples, odd_map(true), odd_map(false),
          std::make_shared<ReliefSum>(std::vector{std::shared_ptr<const ElevationField>(rock),
                                                  std::shared_ptr<const ElevationField>(ripples)})};
}

TEST(LeftOut, BoundsHoldOnTrianglesOfAllShapes) {
  std::mt19937_64 random(20261121);
  std::uniform_real_distribution<double> unit(0, 1);
  int which = 0;
  for (const auto& field : fields()) {
    for (double edge = field->finest_m() / 8; edge < 40; edge *= 2) {
      const ElevationField::LeftOut left = field->left_out(edge);
      double height = 0, slope = 0;
      for (int n = 0; n < 1500; ++n) {
        const glm::dvec2 corner(unit(random) * 12, unit(random) * 18 - 3);
        Triangle t;
        double longest = 0;
        for (glm::dvec2& p : t) p = glm::dvec2(unit(random), unit(random));
        if (n % 3 == 0) t[2] = t[0] + (t[1] - t[0]) * unit(random) + 0.01 * t[2];  // slivers, too
        for (int i = 0; i < 3; ++i) longest = std::max(longest, glm::length(t[i] - t[(i + 1) % 3]));
        for (glm::dvec2& p : t) p = corner + p * (edge / longest * (1 - 1e-9));
        double a = unit(random), b = unit(random);
        if (a + b > 1) a = 1 - a, b = 1 - b;
        const Miss m = miss(*field, t, a, b);
        height = std::max(height, std::abs(m.height_m));
        if (no_angle_over_120(t)) slope = std::max(slope, m.slope);
      }
      EXPECT_LE(height, left.largest_height_m) << "field " << which << ", edge " << edge;
      EXPECT_LE(slope, left.largest_slope * (1 + 1e-6) + 1e-9) << "field " << which << ", edge " << edge;
      EXPECT_GE(height, left.largest_height_m / 60) << "a bound of use; field " << which << ", edge " << edge;
      EXPECT_LE(left.rms_height_m, left.largest_height_m);
      EXPECT_LE(left.rms_slope, left.largest_slope);
    }
    ++which;
  }
}

TEST(LeftOut, BoundOfLongEdgesSeesBothEndsOfATriangle) {
  // Smooth hollows of 1 at the corners of a triangle and a hill of 1 at the middle: the error of the plane
  // is 2. No window that is much smaller contains both.
  constexpr int n = 160;
  for (const double edge : {32.0, 64.0})
    for (const int shift : {0, 1, 3, 7, 90}) {
      const glm::dvec2 middle(60 + shift, 70 + 2 * shift);
      Triangle t;
      HeightMap map{n, n, 0, 0, 1, 1, true, std::vector<double>(n * n)};
      const auto put = [&](glm::dvec2 place, double height) {
        for (int y = 0; y < n; ++y)
          for (int x = 0; x < n; ++x) {
            const double east = std::remainder(x - place.x, n), north = std::remainder(y - place.y, n);
            map.height_m[y * n + x] += height * std::exp(-(east * east + north * north) / 18);
          }
      };
      for (int i = 0; i < 3; ++i) {
        const double angle = 0.3 * shift + i * 2 * std::numbers::pi / 3;
        t[i] = middle + edge / std::sqrt(3) * glm::dvec2(std::cos(angle), std::sin(angle));
        put(t[i], -1);
      }
      put(middle, 1);
      const auto surface = make_surface(map);
      const double missed = miss(*surface, t, 1.0 / 3, 1.0 / 3).height_m;
      EXPECT_NEAR(missed, 2, 0.01);
      EXPECT_LE(missed, surface->left_out(edge).largest_height_m) << edge << " " << shift;
    }
}

TEST(LeftOut, RootMeanSquaresAreThoseOfEquilateralTriangles) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> unit(0, 1);
  const auto all = fields();
  for (const std::size_t which : {0, 1, 4}) {
    for (double edge = all[which]->finest_m() / 20; edge < 20; edge *= 1.7) {
      const ElevationField::LeftOut left = all[which]->left_out(edge);
      double heights = 0, slopes = 0;
      constexpr int count = 4000;
      for (int n = 0; n < count; ++n) {
        const glm::dvec2 centre(unit(random) * 10, unit(random) * 10);
        const double turn = 2 * std::numbers::pi * unit(random);
        Triangle t;
        for (int i = 0; i < 3; ++i) {
          const double angle = turn + i * 2 * std::numbers::pi / 3;
          t[i] = centre + edge / std::sqrt(3) * glm::dvec2(std::cos(angle), std::sin(angle));
        }
        double a = unit(random), b = unit(random);
        if (a + b > 1) a = 1 - a, b = 1 - b;
        const Miss m = miss(*all[which], t, a, b);
        heights += m.height_m * m.height_m / count;
        slopes += m.slope * m.slope / count;
      }
      const double height = left.rms_height_m / std::sqrt(heights),
                   slope = left.rms_slope / std::sqrt(slopes);
      EXPECT_TRUE(height > 0.85 && height < 1.6) << which << " " << edge << ": " << height;
      EXPECT_TRUE(slope > 0.85 && slope < 1.4) << which << " " << edge << ": " << slope;
    }
  }
}

TEST(LeftOut, OfASumAddsUp) {
  const auto all = fields();
  const ElevationField &a = *all[0], &b = *all[1], &sum = *all[4];
  EXPECT_EQ(sum.height_m({1.23, 4.56, 0}), a.height_m({1.23, 4.56, 0}) + b.height_m({1.23, 4.56, 0}));
  EXPECT_EQ(sum.largest_m(), a.largest_m() + b.largest_m());
  EXPECT_EQ(sum.finest_m(), std::min(a.finest_m(), b.finest_m()));
  const auto x = a.left_out(0.3), y = b.left_out(0.3), z = sum.left_out(0.3);
  EXPECT_DOUBLE_EQ(z.rms_height_m, std::hypot(x.rms_height_m, y.rms_height_m));
  EXPECT_DOUBLE_EQ(z.rms_slope, std::hypot(x.rms_slope, y.rms_slope));
  EXPECT_EQ(z.largest_height_m, x.largest_height_m + y.largest_height_m);
  EXPECT_EQ(z.largest_slope, x.largest_slope + y.largest_slope);
}

}  // namespace
}  // namespace tubefoot
