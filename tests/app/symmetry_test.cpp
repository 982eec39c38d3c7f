// SPDX-License-Identifier: GPL-3.0-or-later
// What must not change an echo, or must change it in a known way: sides, mirror images, places on the Earth.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <ogr_spatialref.h>

#include <cmath>
#include <memory>

#include "app/echo_reader.hpp"
#include "app/test_mesh.hpp"

namespace tubefoot {
namespace {

constexpr std::string_view sidescan = R"(
[[sensors]]
name = "sidescan"
kind = "sidescan"
along_track_deg = 1
samples = 300
range_min_m = 1
range_max_m = 40
)";

double bumps(double east, double north) {
  return 0.4 * std::sin(0.31 * east + 0.2) * std::cos(0.23 * north) + 0.1 * std::sin(1.9 * east - 1.3 * north);
}

/// A sidescan 6 m above a bed, heading as told, with a box 12 m away in a compass direction.
std::string box_scene(double heading_deg, double box_bearing_deg, bool with_box) {
  const double bearing = box_bearing_deg * 3.14159265358979 / 180;
  std::string scene = fmt::format(R"(
[[materials]]
name = "sand"
[[terrain]]
kind = "flat"
width_m = 90
length_m = 90
[trajectory]
kind = "fixed"
position_m = [0, 0, 6]
heading_deg = {}
)",
                                  heading_deg);
  if (with_box)
    scene += fmt::format(
        "[[objects]]\nname = \"box\"\nshape = \"box\"\nsize_m = [1, 1, 1]\nposition_m = [{}, {}, 0.5]\n",
        12 * std::sin(bearing), 12 * std::cos(bearing));
  return scene + std::string(sidescan);
}

TEST(Sides, AnObjectEchoesOnItsOwnSideOnly) {
  constexpr std::size_t port = 0, starboard = 1;
  for (const double heading_deg : {0.0, 90.0, 200.0})
    for (const std::size_t side : {port, starboard}) {
      SCOPED_TRACE(fmt::format("heading {}, {}", heading_deg, side == port ? "port" : "starboard"));
      const double bearing = heading_deg + (side == port ? -90 : 90);
      const Echoes bare = echoes_of(box_scene(heading_deg, bearing, false)),
                   box = echoes_of(box_scene(heading_deg, bearing, true));
      const std::size_t at = bare.sample_at(std::hypot(11.5, 5.5));
      EXPECT_GT(box.at(0, side, at), 5 * bare.at(0, side, at));
      for (std::size_t k = 0; k < bare.samples; ++k)
        EXPECT_EQ(box.at(0, 1 - side, k), bare.at(0, 1 - side, k)) << "sample " << k;
    }
}

std::string mesh_scene(double heading_deg, std::string_view sensors, std::string_view more = {}) {
  return fmt::format(R"(
[[materials]]
name = "sand"
[[objects]]
name = "bed"
shape = "mesh"
file = "bed.obj"
[trajectory]
kind = "fixed"
position_m = [0, 0, 6]
heading_deg = {}
pitch_deg = 2
)",
                     heading_deg) +
         std::string(sensors) + std::string(more);
}

Echoes echoes_over(const TestMesh& mesh, const std::string& scene) {
  const TestFolder folder;
  folder.write("bed.obj", obj_text(mesh));
  return echoes_in(folder, scene);
}

TEST(Mirror, SwapsPortAndStarboard) {
  const TestMesh mesh = relief(96, 40, bumps);
  for (const double heading_deg : {0.0, 17.0}) {
    SCOPED_TRACE(heading_deg);
    const Echoes there = echoes_over(mesh, mesh_scene(heading_deg, sidescan)),
                 mirrored_there = echoes_over(mirrored(mesh), mesh_scene(-heading_deg, sidescan));
    double worst = 0;
    for (const std::size_t beam : {0u, 1u})
      for (std::size_t k = 0; k < there.samples; ++k) {
        const double a = there.at(0, beam, k), b = mirrored_there.at(0, 1 - beam, k);
        if (a != b) worst = std::max(worst, std::abs(a - b) / std::max(a, b));
      }
    EXPECT_LT(worst, 1e-12);
    std::printf("worst %.3e  differ %.3e\n", worst, largest_relative_difference(there, mirrored_there));
    EXPECT_GT(largest_relative_difference(there, mirrored_there), 0.01);  // the bed is not symmetric itself
  }
}

}  // namespace
}  // namespace tubefoot
