// SPDX-License-Identifier: GPL-3.0-or-later
// Tests derivatives of apparent positions and of returns of corners, against central differences of
// ApparentMap, and against the closed forms of one gradient.

#include "engine/water/apparent_motion.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>
#include <optional>

namespace tubefoot {
namespace {

constexpr double surface_m = 0, reference_m_s = 1493;
constexpr int any = -1;  // number of turning points

struct Case {
  const char* name;
  std::vector<ProfilePoint> points;
  glm::dvec3 apex, at;
  int turns = 0;
};

// Layers of positive, negative and zero gradient; steep, vertical, level and turning rays; ends in one layer.
const std::vector<Case> cases{
    {"one gradient, downwards", {{0, 1480}, {100, 1500}}, {3, -4, -12}, {40, 31, -61}},
    {"negative gradient", {{0, 1520}, {100, 1470}}, {3, -4, -12}, {60, 31, -61}},
    {"level points, arc within the layer", {{0, 1470}, {100, 1520}}, {0, 0, -30}, {80, 30, -30}, 1},
    {"turning within the layer", {{0, 1520}, {100, 1470}}, {0, 0, -30}, {110, 60, -28}, 1},
    {"zero gradient", {{0, 1500}, {100, 1500}}, {0, 0, -30}, {80, 30, -50}},
    {"zero gradient, level", {{0, 1500}, {100, 1500}}, {0, 0, -30}, {80, 30, -30}, any},
    {"below the profile", {{0, 1500}, {10, 1510}}, {0, 0, -30}, {80, 30, -50}},
    {"vertical in one layer", {{0, 1480}, {100, 1500}}, {1, 2, -10}, {1, 2, -60}},
    {"four layers", {{0, 1520}, {20, 1490}, {40, 1490}, {70, 1512}}, {3, -4, -5}, {60, 31, -81}},
    {"four layers upwards", {{0, 1520}, {20, 1490}, {40, 1490}, {70, 1512}}, {3, -4, -85}, {60, 31, -11}},
    {"four layers, vertical", {{0, 1520}, {20, 1490}, {40, 1490}, {70, 1512}}, {3, -4, -5}, {3, -4, -81}},
    {"four layers, flat", {{0, 1500}, {20, 1490}, {40, 1490}, {70, 1497}}, {0, 0, -5}, {300, 120, -65}},
    {"turning in another layer", {{0, 1500}, {30, 1500}, {60, 1540}}, {0, 0, -25}, {390, 100, -24}, 1},
    {"turning above, other layers below",
     {{0, 1540}, {20, 1500}, {30, 1499}, {60, 1490}},
     {0, 0, -22},
     {400, 200, -40},
     1},
};

WaterColumn column(std::vector<ProfilePoint> points, double more_db_per_m = 0) {
  WaterColumn water{SoundSpeedProfile(points), {}};
  for (std::size_t layer = 0; layer < water.profile.layers(); ++layer)
    water.absorption_db_per_m.push_back(0.05 + 0.02 * double(layer) + more_db_per_m);
  return water;
}

struct Seen {
  ApparentPoint image;
  glm::dvec3 at;  // relative to the apex
  CornerReturn returned;
};

/// The ray with a number of turning points.
Seen seen_in(const WaterColumn& water, glm::dvec3 apex, glm::dvec3 at, int turns) {
  const ApparentMap map(water, apex, surface_m, {}, reference_m_s);
  for (const ApparentPoint& image : map.all_apparent(at))
    if (turns == any || image.ray.turns == turns)
      return {image, image.at_m - apex, corner_return(map, at, image, 0)};
  ADD_FAILURE() << "no ray with " << turns << " turning points";
  return {};
}

/// Compares the derivatives with a central difference of fourth order.
template <class SeenAt>
void compare(const ApparentMotion::Velocity& by, double step, const SeenAt& seen_at, double tolerance) {
  const Seen a = seen_at(step), b = seen_at(-step), c = seen_at(2 * step), d = seen_at(-2 * step);
  const auto difference = [&](const auto& value) {
    return (8.0 * (value(a) - value(b)) - (value(c) - value(d))) / (12 * step);
  };
  const glm::dvec3 at = difference([](const Seen&s) { return s.at; }),
                   arrival = difference([](const Seen&s) { return s.returned.arrival; });
  const double density = difference([](const Seen& s) { return std::log(s.returned.density_per_m4); });
  EXPECT_LT(glm::length(by.at - at), tolerance * std::max(glm::length(at), 1e-2)) << glm::length(at);
  EXPECT_LT(glm::length(by.arrival - arrival), tolerance * std::max(glm::length(arrival), 1e-2))
      << glm::length(arrival);
  EXPECT_NEAR(by.log_density, density, tolerance * std::max(std::abs(density), 1e-1));
}

TEST(ApparentMotion, IsTheCentralDifferenceByPointApexAndWater) {
  for (const Case& c : cases) {
    SCOPED_TRACE(c.name);
    const WaterColumn water = column(c.points);
    const Seen seen = seen_in(water, c.apex, c.at, c.turns);
    EXPECT_TRUE(std::isfinite(seen.returned.density_per_m4));
    std::vector<WaterChange> changes(c.points.size());
    for (std::size_t k = 0; k < c.points.size(); ++k) {
      changes[k].sound_speed_m_s.assign(c.points.size(), 0);
      changes[k].sound_speed_m_s[k] = 1;
    }
    changes.push_back({{}, 1});
    const ApparentMap map(water, c.apex, surface_m, {}, reference_m_s);
    const ApparentMotion motion(map, c.at, seen.image, changes);
    constexpr double tolerance = 1e-7;
    for (int axis = 0; axis < 3; ++axis) {
      SCOPED_TRACE(axis);
      glm::dvec3 unit(0);
      unit[axis] = 1;
      compare(
          motion.of(unit, {}), 1e-3,
          [&](double h) { return seen_in(water, c.apex, c.at + h * unit, c.turns); }, tolerance);
      compare(
          motion.of({}, unit), 1e-3,
          [&](double h) { return seen_in(water, c.apex + h * unit, c.at, c.turns); }, tolerance);
    }
    for (std::size_t k = 0; k < c.points.size(); ++k) {
      SCOPED_TRACE(k);
      compare(
          motion.of({}, {}, k), 1e-3,
          [&](double h) {
            std::vector<ProfilePoint> points = c.points;
            points[k].sound_speed_m_s += h;
            return seen_in(column(points), c.apex, c.at, c.turns);
          },
          tolerance);
    }
    compare(
        motion.of({}, {}, c.points.size()), 1e-3,
        [&](double h) { return seen_in(column(c.points, h), c.apex, c.at, c.turns); }, tolerance);
  }
}

// One gradient gives cosh(g T) = 1 + g^2 d^2 / (2 c1 c2), with the straight distance d. The tube area is (6)
// of docs/notes/refraction.md.
TEST(ApparentMotion, HasTheClosedFormOfOneGradient) {
  const double g = 0.3, c0 = 1480;
  const WaterColumn water{SoundSpeedProfile({{0, c0}, {100, c0 + 100 * g}}), {}};
  const glm::dvec3 apex(0, 0, -20), at(35, -21, -71);
  const ApparentMap map(water, apex, surface_m, {}, reference_m_s);
  const ApparentMotion motion(map, at, *map.apparent(at), std::vector<WaterChange>{{{1, 1}, 0}});
  const auto time = [&](glm::dvec3 a, glm::dvec3 b, double more) {
    const double c1 = c0 + more - g * a.z, c2 = c0 + more - g * b.z, d = glm::distance(a, b);
    return 2 * std::asinh(g * d / (2 * std::sqrt(c1 * c2))) / g;  // acosh(1 + x) = 2 asinh(sqrt(x / 2))
  };
  const auto log_density = [&](glm::dvec3 a, glm::dvec3 b, double more) {
    const double c1 = c0 + more - g * a.z, c2 = c0 + more - g * b.z,
                 area = std::pow(c2 * std::sinh(g * time(a, b, more)) / g, 2);
    return -std::log(area * area * c1 * c1 / (c2 * c2));
  };
  const glm::dvec3 seen = map.apparent(at)->at_m - apex;
  const auto check = [&](const ApparentMotion::Velocity& by, glm::dvec3 of_apex, glm::dvec3 of_point,
                         double more) {
    constexpr double h = 1e-2;
    const auto slope = [&](const auto& f) {
      const auto f_at = [&](double k) { return f(apex + k * of_apex, at + k * of_point, k * more); };
      return (8 * (f_at(h) - f_at(-h)) - (f_at(2 * h) - f_at(-2 * h))) / (12 * h);
    };
    // The distance of the apparent position is the reference speed times the travel time.
    EXPECT_NEAR(glm::dot(by.at, glm::normalize(seen)), reference_m_s * slope(time), 1e-10);
    EXPECT_NEAR(by.log_density, slope(log_density), 1e-10);
  };
  check(motion.of({0, 0, 1}, {}), {}, {0, 0, 1}, 0);
  check(motion.of({0.6, 0.8, 0}, {}), {}, {0.6, 0.8, 0}, 0);
  check(motion.of({}, {0, 0, 1}), {0, 0, 1}, {}, 0);
  check(motion.of({}, {}, 0), {}, {}, 1);
}

TEST(ApparentMotion, RigidMotionsAndAllSpeedsAreLaws) {
  for (const Case& c : cases) {
    SCOPED_TRACE(c.name);
    const WaterColumn water = column(c.points);
    const ApparentPoint image = seen_in(water, c.apex, c.at, c.turns).image;
    WaterChange all;
    for (const ProfilePoint& p : c.points) all.sound_speed_m_s.push_back(p.sound_speed_m_s);
    const ApparentMap map(water, c.apex, surface_m, {}, reference_m_s);
    const ApparentMotion motion(map, c.at, image, std::vector<WaterChange>{all});
    const auto together = motion.of({0.3, -0.7, 0}, {0.3, -0.7, 0});
    EXPECT_EQ(glm::length(together.at), 0);
    EXPECT_EQ(glm::length(together.arrival), 0);
    EXPECT_EQ(together.log_density, 0);
    const glm::dvec3 axis(0, 0, 1), seen = image.at_m - c.apex;
    const auto turned = motion.of(glm::cross(axis, c.at - c.apex), {});
    EXPECT_LT(glm::length(turned.at - glm::cross(axis, seen)), 1e-12 * glm::length(seen));
    EXPECT_NEAR(turned.log_density, 0, 1e-12);
    // Proportional sound speeds keep the rays, and divide all travel times.
    const auto faster = motion.of({}, {}, 0);
    EXPECT_LT(glm::length(faster.at + seen), 1e-9 * glm::length(seen));
    EXPECT_LT(glm::length(faster.arrival), 1e-9);
    EXPECT_NEAR(faster.log_density, 0, 1e-8);
  }
}

// A sonar on a border belongs to the layer below, and the end of a ray to the layer from which it arrives.
TEST(ApparentMotion, OnABorderOfLayersIsTheLimitOfOneSide) {
  const WaterColumn water = column({{0, 1520}, {20, 1490}, {40, 1490}, {70, 1512}});
  const auto motion_of = [&](glm::dvec3 apex, glm::dvec3 at, bool of_apex) {
    const ApparentMap map(water, apex, surface_m, {}, reference_m_s);
    const glm::dvec3 unit(0.3, 0.4, 0.8), none(0);
    return ApparentMotion(map, at, *map.apparent(at)).of(of_apex ? none : unit, of_apex ? unit : none);
  };
  const auto expect_same = [](const ApparentMotion::Velocity& a, const ApparentMotion::Velocity& b) {
    EXPECT_LT(glm::length(a.at - b.at), 1e-7);
    EXPECT_LT(glm::length(a.arrival - b.arrival), 1e-8);
    EXPECT_NEAR(a.log_density, b.log_density, 1e-7);
  };
  constexpr double off_m = 1e-6;
  for (const double depth_m : {20.0, 40.0}) {
    const glm::dvec3 apex(0, 0, -depth_m), below(0, 0, -depth_m - off_m);
    for (const glm::dvec3 at : {glm::dvec3(30, 12, -60), glm::dvec3(30, 12, -11), glm::dvec3(40, 0, -40)}) {
      if (at.z == apex.z) continue;
      SCOPED_TRACE(testing::Message() << depth_m << " " << at.z);
      expect_same(motion_of(apex, at, true), motion_of(below, at, true));
    }
    const glm::dvec3 from(3, 2, -5), upwards(3, 2, -81), at(30, 12, -depth_m);
    expect_same(motion_of(from, at, false), motion_of(from, at + glm::dvec3(0, 0, off_m), false));
    expect_same(motion_of(upwards, at, false), motion_of(upwards, at - glm::dvec3(0, 0, off_m), false));
  }
}

TEST(ApparentMotion, RejectsAChangeOfAnotherProfile) {
  const WaterColumn water = column(cases[0].points);
  const ApparentMap map(water, cases[0].apex, surface_m);
  const ApparentPoint image = *map.apparent(cases[0].at);
  EXPECT_THROW(ApparentMotion(map, cases[0].at, image, std::vector<WaterChange>{{{1}, 0}}),
               std::invalid_argument);
}

}  // namespace
}  // namespace tubefoot
