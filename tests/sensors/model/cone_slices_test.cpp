// SPDX-License-Identifier: GPL-3.0-or-later
// Measures the distance between the cones that bound ideal beams and the planes that bound tubes, for each
// kind of sensor.
#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

#include "fixtures/world/recordings.hpp"
#include "geometry/numbers/scalars.hpp"
#include "sensors/kinds/kind_didson.hpp"
#include "sensors/kinds/kind_echosounder.hpp"
#include "sensors/kinds/kind_imaging.hpp"
#include "sensors/kinds/kind_interferometric.hpp"
#include "sensors/kinds/kind_multibeam.hpp"
#include "sensors/kinds/kind_sidescan.hpp"
#include "sensors/model/angles.hpp"

namespace tubefoot {
namespace {

const WorldGrid fitting_grid = WorldGrid::fitting(glm::dvec3(-100), glm::dvec3(100));

struct Case {
  const char* name;
  SensorDescription sensor;
  glm::dvec3 axis;    // of the cones
  double height_deg;  // of the beam over them, in both directions
};

std::vector<Case> all_kinds() {
  std::vector<Case> all;
  const auto add = [&](const char* name, auto kind, glm::dvec3 axis, double height_deg) {
    SensorDescription description;
    description.name = "s";
    description.kind = kind;
    all.push_back({name, description, axis, height_deg});
  };
  add("didson", DidsonDescription(), up_axis, 14);
  DidsonDescription wide;
  wide.beams = 3;
  wide.horizontal_deg = 60;
  add("didson of wide beams", wide, up_axis, 14);
  wide.vertical_deg = 100;  // two rows
  add("high didson", wide, up_axis, 100);
  DidsonDescription lens;
  lens.beam_centres = "lens";
  add("didson with a lens", lens, up_axis, 14);
  lens.cycles = 4;
  add("didson in cycles", lens, up_axis, 14);
  add("sidescan", SidescanDescription(), forward_axis, 0.5);
  SidescanDescription broad;
  broad.along_track_deg = 20;
  add("broad sidescan", broad, forward_axis, 20);
  add("interferometric", InterferometricDescription(), forward_axis, 0.5);
  add("multibeam", MultibeamDescription(), forward_axis, 1.5);
  MultibeamDescription apart;
  apart.spacing = "distance";
  add("multibeam of equal distances", apart, forward_axis, 1.5);
  add("imaging", ImagingDescription(), up_axis, 20);
  add("echosounder", EchosounderDescription(), forward_axis, 21);
  return all;
}

/// Largest relative distance in tan(elevation) of the outer walls of tubes from the cones.
double largest_error(const Case& kind) {
  const auto sensor = make_sensor(kind.sensor);
  const double cone = std::tan(kind.height_deg / 2 * degree);
  double worst = 0;
  std::size_t walls = 0;
  for (std::size_t transmission = 0; transmission < sensor->transmissions(); ++transmission) {
    const TubeSet tubes = sensor->tubes(Pose{}, fitting_grid, transmission);
    for (const Tube& tube : tubes.tubes)
      for (std::size_t k = 0; k < 4; ++k) {
        const auto ray = [&](std::size_t corner) {
          const GridPoint& r = tubes.rays[tube[corner % 4]];
          return glm::normalize(glm::dvec3(r.x, r.y, r.z));
        };
        const glm::dvec3 a = ray(k), b = ray(k + 1);
        const double lean_a = glm::dot(a, kind.axis), lean_b = glm::dot(b, kind.axis);
        const double edge = std::sin(std::atan(cone)) / 2;
        if (!(std::min(std::abs(lean_a), std::abs(lean_b)) > edge && lean_a * lean_b > 0)) continue;
        ++walls;
        // a wall contains all directions between its two rays
        for (const double s : {0.0, 0.25, 0.5, 0.75, 1.0}) {
          const glm::dvec3 d = glm::normalize((1 - s) * a + s * b);
          const double sine = std::abs(glm::dot(d, kind.axis));
          worst = std::max(worst, std::abs(sine / std::sqrt((1 - sine) * (1 + sine)) / cone - 1));
        }
      }
  }
  EXPECT_GE(walls, 2u) << kind.name;
  return worst;
}

TEST(ConeSlices, WallsAreWithinTheToleranceOfTheCones) {
  for (Case kind : all_kinds())
    for (const double tolerance : {1e-2, 4.5e-5, 1e-6, 3e-7}) {
      kind.sensor.cone_tolerance = tolerance;
      const double rays = 2e-9 / std::tan(kind.height_deg / 2 * degree);  // rounded to 2^-30
      EXPECT_LE(largest_error(kind), tolerance * (1 + 1e-6) + rays) << kind.name << " " << tolerance;
    }
}

TEST(ConeSlices, NoMoreSlicesThanTheToleranceTakes) {
  for (const double tolerance : {1e-3, 1e-5, 1e-7})
    for (const double width : {0.01, 0.3, 1.45}) {
      const int slices = slices_for(width, tolerance);
      const auto off = [&](int n) { return std::pow(std::tan(width / n / 4), 2); };
      EXPECT_LE(off(slices), tolerance * (1 + 1e-9));
      if (slices > 1) {
        EXPECT_GT(off(slices - 1), tolerance * (1 - 1e-9));
      }
    }
}

TEST(ConeSlices, CornersAndMiddlesAreAsFarFromTheCone) {
  // a degree: within the tolerance without a correction
  EXPECT_EQ(height_of_corners(0.1, 0.017, 4e-5), 0.1);
  for (const double cone : {0.004, 0.3, 1.2})
    for (const double slice : {0.002, 0.03, 0.5}) {
      const double corner = std::tan(height_of_corners(cone, slice, 1e-9)) / std::tan(cone),
                   middle = corner / std::cos(slice / 2), off = std::pow(std::tan(slice / 4), 2);
      EXPECT_NEAR(corner, 1 - off, 1e-14);
      EXPECT_NEAR(middle, 1 + off, 1e-14);
    }
}

}  // namespace
}  // namespace tubefoot
