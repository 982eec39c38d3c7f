// SPDX-License-Identifier: GPL-3.0-or-later
// Tests transformations that must not change an echo, or change it in a known way: sides, mirror images,
// and positions on the Earth.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <ogr_spatialref.h>

#include <cmath>
#include <memory>

#include "fixtures/scene_texts.hpp"
#include "fixtures/test_mesh.hpp"
#include "fixtures/world/echoes.hpp"

namespace tubefoot {
namespace {

constexpr std::string_view symmetric_sidescan = R"(
[[sensors]]
name = "sidescan"
kind = "sidescan"
along_track_deg = 1
samples = 300
range_min_m = 1
range_max_m = 40
)";

double bumps(double east, double north) {
  return 0.4 * std::sin(0.31 * east + 0.2) * std::cos(0.23 * north) +
         0.1 * std::sin(1.9 * east - 1.3 * north);
}

/// A sidescan 6 m above a seabed with the given heading, and a box 12 m away in a compass direction.
std::string box_scene(double heading_deg, double box_bearing_deg, bool with_box) {
  const double bearing = box_bearing_deg * 3.14159265358979 / 180;
  std::string scene = lambert_material("sand", -27) + flat_terrain(90, 90) +
                      fixed_at(0, 0, 6, fmt::format("heading_deg = {}\n", heading_deg));
  if (with_box)
    scene += fmt::format(
        "[[objects]]\nname = \"box\"\nshape = \"box\"\nsize_m = [1, 1, 1]\nposition_m = [{}, {}, 0.5]\n",
        12 * std::sin(bearing), 12 * std::cos(bearing));
  return scene + std::string(symmetric_sidescan);
}

TEST(Sides, AnObjectEchoesOnItsOwnSideOnly) {
  constexpr std::size_t port = 0, starboard = 1;
  for (const double heading_deg : {0.0, 200.0})
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

TEST(MirroredScene, SwapsPortAndStarboard) {
  const TestMesh mesh = relief(96, 48, bumps);
  for (const double heading_deg : {0.0, 17.0}) {
    SCOPED_TRACE(heading_deg);
    const Echoes there = echoes_over(mesh, mesh_scene(heading_deg, symmetric_sidescan)),
                 mirrored_there = echoes_over(mirrored(mesh), mesh_scene(-heading_deg, symmetric_sidescan));
    double worst = 0;
    for (const std::size_t beam : {0u, 1u})
      for (std::size_t k = 0; k < there.samples; ++k) {
        const double a = there.at(0, beam, k), b = mirrored_there.at(0, 1 - beam, k);
        if (a != b) worst = std::max(worst, std::abs(a - b) / std::max(a, b));
      }
    EXPECT_LT(worst, 1e-12);
    EXPECT_GT(largest_relative_difference(there, mirrored_there),
              0.01);  // the seabed is not symmetric itself
  }
}

TEST(Translation, ByGridUnitsChangesNothing) {
  const TestMesh mesh = relief(96, 48, bumps);
  const std::string at_origin = mesh_scene(23, symmetric_sidescan, R"(
[[terrain]]
kind = "flat"
width_m = 64
length_m = 64
centre_m = [0, 0, -0.25]
[[objects]]
name = "ball"
shape = "sphere"
radius_m = 0.75
chord_error_m = 0.01
position_m = [9, 2, 0.5]
)");
  const Echoes there = echoes_over(mesh, at_origin);
  struct Shift {
    double east, north, up;
  };
  for (const Shift& by :
       {Shift{1.0 / 65536, 0, 0}, Shift{-64.5, 32.25, 3.125}, Shift{300 + 3.0 / 4096, -200, -40}}) {
    SCOPED_TRACE(fmt::format("{} {} {}", by.east, by.north, by.up));
    const auto place = [&](double east, double north, double up) {
      return fmt::format("[{:.17g}, {:.17g}, {:.17g}]", by.east + east, by.north + north, by.up + up);
    };
    std::string moved =
        replaced(at_origin, "file = \"bed.obj\"", "file = \"bed.obj\"\nposition_m = " + place(0, 0, 0));
    moved = replaced(moved, "centre_m = [0, 0, -0.25]", "centre_m = " + place(0, 0, -0.25));
    moved = replaced(moved, "position_m = [9, 2, 0.5]", "position_m = " + place(9, 2, 0.5));
    moved = replaced(moved, "position_m = [0, 0, 6]", "position_m = " + place(0, 0, 6));
    EXPECT_EQ(there.energy, echoes_over(mesh, moved).energy);
  }
}

/// An ESRI ASCII grid of 40 x 40 cells of 2 m whose south-west corner lies at (east, north).
std::string ascii_grid(double east, double north) {
  std::string text =
      fmt::format("ncols 40\nnrows 40\nxllcorner {:.3f}\nyllcorner {:.3f}\ncellsize 2\nNODATA_value -9999\n",
                  east, north);
  for (int row = 0; row < 40; ++row) {
    for (int column = 0; column < 40; ++column)
      text += row == 3 && column < 5 ? "-9999 " : fmt::format("{:.4f} ", bumps(2 * column, 80 - 2 * row));
    text += "\n";
  }
  return text;
}

constexpr std::string_view raster_scene = R"(
[[materials]]
name = "sand"
[[terrain]]
kind = "raster"
file = "bed.asc"
[[objects]]
name = "box"
shape = "box"
position_m = [9, 2, 0]
on_terrain_m = 0
[trajectory]
kind = "fixed"
position_m = [0, 0, 6]
heading_deg = 30
)";

std::string projection_of(int epsg) {
  OGRSpatialReference reference;
  if (reference.importFromEPSG(epsg) != OGRERR_NONE) throw std::runtime_error("unknown EPSG code");
  char* text = nullptr;
  reference.exportToWkt(&text);
  const std::unique_ptr<char, decltype(&CPLFree)> owner(text, CPLFree);
  return text;
}

// Coordinates of seven digits before the decimal point cost no precision. The same grid in its own frame,
// in UTM zone 2N and elsewhere in that zone gives the same echoes to the last bit.
TEST(Georeference, UtmCoordinatesCostNothing) {
  const TestFolder local;
  local.write("bed.asc", ascii_grid(-40, -40));
  const std::string own_frame = std::string(raster_scene) + std::string(symmetric_sidescan);
  const Echoes there = echoes_in(local, own_frame);
  EXPECT_GT(there.total(), 0);
  for (const auto& [east, north] : {std::pair{621930.0, 7245100.0}, std::pair{345678.0, 5000001.0}}) {
    SCOPED_TRACE(east);
    const TestFolder folder;
    folder.write("bed.asc", ascii_grid(east - 40, north - 40));
    folder.write("bed.prj", projection_of(32602));
    const Echoes utm = echoes_in(
        folder, fmt::format("[georeference]\ncrs = \"EPSG:32602\"\norigin_crs = [{}, {}]\n", east, north) +
                    own_frame);
    EXPECT_EQ(there.energy, utm.energy);
  }
}

}  // namespace
}  // namespace tubefoot
