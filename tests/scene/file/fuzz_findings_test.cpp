// SPDX-License-Identifier: GPL-3.0-or-later
// Repeats the findings of fuzzing for readers of scenes (validation/fuzzing.md), minimised. The test names
// state the findings.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <optional>

#include "files/shown.hpp"
#include "fixtures/world/read_scenes.hpp"
#include "scene/meshes/mesh_file.hpp"
#include "scene/rasters/georeference.hpp"
#include "scene/rasters/raster.hpp"
#include "scene/rasters/terrain.hpp"
#include "scene/scene_water.hpp"
#include "scene/surfaces/material_map.hpp"
#include "scene/surfaces/relief_map.hpp"
#include "scene/waypoint_file.hpp"

namespace tubefoot {
namespace {

using namespace std::string_literals;
using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

/// The message of the InputError that a file with these bytes gives; empty if there is none.
template <class Read>
std::string refusal(const std::string& name, const std::string& content, const Read& read) {
  const TestFolder folder;
  try {
    read(folder.write(name, content));
  } catch (const InputError& error) {
    return error.what();
  }
  return {};
}

constexpr const char* waypoint_columns = "time_s,east_m,north_m,up_m,heading_deg,pitch_deg,roll_deg\n";

std::string waypoints_refusal(const std::string& rows) {
  return refusal("t.csv", waypoint_columns + rows, [](const std::filesystem::path& file) {
    read_waypoints({file, {}}, {});
  });
}

// ---- Messages

TEST(FuzzedScenes, MessageGoesOnAfterANulOfTheInput) {
  EXPECT_THAT(waypoints_refusal("0,\0\x1b[2J,0,0,0,0,0\n"s),
              AllOf(HasSubstr("t.csv:2:3: "), HasSubstr("\\x00\\x1b[2J"),
                    HasSubstr("expected a finite number"), Not(HasSubstr("\x1b"))));
}

TEST(FuzzedScenes, MessageQuotesALongFieldInPart) {
  const std::string message = waypoints_refusal("0," + std::string(1000000, 'x') + ",0,0,0,0,0\n");
  EXPECT_LT(message.size(), 5000u);
  EXPECT_THAT(message, AllOf(HasSubstr("t.csv:2:3: "), HasSubstr("xxx ["), HasSubstr(" characters] xxx"),
                             HasSubstr("expected a finite number")));
}

TEST(FuzzedScenes, WhatIsCutOutOfAMessageLeavesCharactersWhole) {
  for (std::size_t before = 0; before < 8; ++before) {
    std::string text(before, 'a');
    for (int k = 0; k < 3000; ++k) text += "\u20ac";  // three bytes
    const std::string cut = shown(text);
    const std::size_t gap = cut.find(" [");
    ASSERT_NE(gap, std::string::npos);
    EXPECT_EQ((gap - before) % 3, 0u);
    EXPECT_EQ((cut.size() - cut.find("] ") - 2) % 3, 0u);
  }
}

// ---- Tables

TEST(FuzzedScenes, WaypointsAreAtTimesAndPlacesThatCanBeInterpolated) {
  EXPECT_THAT(waypoints_refusal("-1e308,0,0,0,0,0,0\n1e308,0,0,0,0,0,0\n"),
              HasSubstr("t.csv:2:1: time_s is -1e+308, expected -1e+10 to 1e+10"));
  EXPECT_THAT(waypoints_refusal("0,0,0,0,0,0,0\n1,0,-2e7,0,0,0,0\n"),
              HasSubstr("t.csv:3:5: north_m is -20000000, expected -1e+07 to 1e+07"));
  EXPECT_THAT(waypoints_refusal("0,0,0,0,0,0,1e7\n"),
              HasSubstr("t.csv:2:13: roll_deg is 10000000, expected"));
  EXPECT_THAT(waypoints_refusal("-1e10,1e7,-1e7,1e7,1e6,-1e6,1e6\n1e10,0,0,0,0,0,0\n"), IsEmpty());
}

TEST(FuzzedScenes, DepthsTooNearForAGradientAreRefused) {
  const auto read = [](const std::filesystem::path& file) {
    WaterDescription water;
    water.profile = "table";
    water.profile_file = file;
    const SceneWater made(water);
    EXPECT_GT(made.profile().at(1.0), 0);
  };
  const std::string columns = "depth_m,sound_speed_m_s\n";
  EXPECT_THAT(refusal("p.csv", columns + "0,1500\n5e-324,1400\n", read),
              HasSubstr("p.csv:3:1: depth_m must increase: 5e-324 follows 0"));
  EXPECT_THAT(refusal("p.csv", columns + "0,1500\n2e-6,1500.000001\n", read), IsEmpty());
}

// ---- Meshes

TEST(FuzzedScenes, LengthOfAListInTextPlyIsBounded) {
  const std::string ply =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
      "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n";
  EXPECT_THAT(
      refusal("m.ply", ply + "9223372036854775807 0 1 2\n", [](const auto& file) { read_mesh_file(file); }),
      HasSubstr("m.ply:13:1: the length of vertex_indices is 9.223372036854776e+18, expected"));
  EXPECT_THAT(refusal("m.ply", ply + "3 0 1 2\n", [](const auto& file) { read_mesh_file(file); }), IsEmpty());
}

// ---- Rasters and material maps

/// A netCDF file whose only attribute claims 1.9 GB.
std::string greedy_netcdf() {
  return "CDF\1"s + "\0\0\0\0"s                              // no records
         + "\0\0\0\0\0\0\0\0"s                               // no dimensions
         + "\0\0\0\x0c\0\0\0\1"s                             // one attribute
         + "\0\0\0\1a\0\0\0"s + "\0\0\0\2\x74\x6f\x6e\x65"s  // 'a': characters, 0x746f6e65 of them
         + "text"s + "\0\0\0\0\0\0\0\0"s;
}

std::size_t cut_by_map(const MaterialMapDescription& map) {
  std::vector<MaterialDescription> materials(2);
  materials[0].name = "mud";
  materials[1].name = "sand";
  TerrainDescription terrain;
  terrain.material = "mud";
  terrain.material_map = map;
  terrain.material_map->place = {"scene.toml", 2, 1};
  ComponentMesh mesh = flat_facets({10, 10, {0, 0, 0}, 0}, {"scene.toml", 1, 1});
  return apply_material_map(mesh, terrain, materials, LocalFrame());
}

TEST(FuzzedScenes, CellsAtNoPlaceAreRefused) {
  const auto read = [](const std::filesystem::path& file) {
    RasterTerrain terrain;
    terrain.file = file;
    std::optional<LocalFrame> frame;
    read_raster(terrain, frame);
  };
  const std::string head = "ncols 2\nnrows 2\nxllcorner 0\nyllcorner 0\n", cells = "1 1\n1 1\n";
  EXPECT_THAT(refusal("r.asc", head + "cellsize 1e308\n" + cells, read),
              HasSubstr("r.asc: has a cell with data at ("));
  EXPECT_THAT(refusal("r.asc", head + "cellsize 1e3\n" + cells, read), IsEmpty());
}

TEST(FuzzedScenes, ReliefOfThinCellsIsRefusedBeforeItsSpectrumTakesMemoryAndTime) {
  const auto read = [](const std::filesystem::path& file) {
    MapReliefDescription map;
    map.file = file;
    std::vector<std::string> warnings;
    read_relief_map(map, LocalFrame(), warnings);
  };
  const std::string head = "ncols 2\nnrows 2\nxllcorner 0\nyllcorner 0\n", cells = "1 1\n1 1\n";
  EXPECT_THAT(refusal("r.asc", head + "dx 1e-6\ndy 1e4\n" + cells, read),
              HasSubstr("r.asc: its cells are 1e-06 m by 10000 m over a length of 20000 m; expected"));
  EXPECT_THAT(refusal("r.asc", head + "dx 1e-3\ndy 1e3\n" + cells, read),
              HasSubstr("at most 1e+06 times the shorter side"));
  EXPECT_THAT(refusal("r.asc", head + "cellsize 1e-140\n" + cells, read),
              HasSubstr("r.asc: its cells are 1e-140 m"));
  EXPECT_THAT(refusal("r.asc", head + "dx 1\ndy 1000\n" + cells, read), IsEmpty());
}

TEST(FuzzedScenes, ClassicNetcdfIsMeasuredBeforeItsLibraryBelievesIt) {
  const auto measured = HasSubstr("r.nc: is cut off or damaged: its netCDF header");
  EXPECT_THAT(refusal("r.nc", greedy_netcdf(),
                      [](const std::filesystem::path& file) {
                        RasterTerrain terrain;
                        terrain.file = file;
                        std::optional<LocalFrame> frame;
                        read_raster(terrain, frame);
                      }),
              measured);
  EXPECT_THAT(refusal("r.nc", greedy_netcdf(),
                      [](const std::filesystem::path& file) {
                        RasterMaterialMap map;
                        map.file = file;
                        cut_by_map({{}, map});
                      }),
              measured);
}

TEST(FuzzedScenes, BordersThatReachOverMoreThanADoubleHoldsAreRefused) {
  const std::string polygon =
      R"({"type":"Feature","properties":{"material":"sand"},"geometry":{"type":"Polygon","coordinates":)"
      R"([[[0,-1e308],[4,-1e308],[4,1e308],[0,-1e308]]]}})";
  EXPECT_THAT(refusal("m.geojson", polygon,
                      [](const std::filesystem::path& file) {
                        PolygonMaterialMap map;
                        map.file = file;
                        map.coordinates = "local";
                        cut_by_map({{}, map});
                      }),
              HasSubstr("scene.toml:2:1: the map's border at"));
}

/// A GeoTIFF of one pixel, 2 m wide, whose geokeys refer to missing data: GDAL warns when the program
/// queries the CRS.
std::string tiff_with_broken_geokeys() {
  const auto entry = [](unsigned tag, unsigned type, unsigned count, unsigned value) {
    std::string bytes;
    for (const unsigned two : {tag, type}) bytes += {char(two & 255), char(two >> 8)};
    for (const unsigned four : {count, value})
      for (int k = 0; k < 4; ++k) bytes += char(four >> 8 * k & 255);
    return bytes;
  };
  constexpr unsigned entries = 12, keys = 8 + 2 + 12 * entries + 4, scale = keys + 16, tie = scale + 24;
  std::string tiff = "II*\0\x08\0\0\0"s + char(entries) + '\0';
  tiff += entry(256, 4, 1, 1) + entry(257, 4, 1, 1) + entry(258, 3, 1, 8) + entry(259, 3, 1, 1) +
          entry(262, 3, 1, 1) + entry(273, 4, 1, tie + 48) + entry(277, 3, 1, 1) + entry(278, 4, 1, 1) +
          entry(279, 4, 1, 1) + entry(33550, 12, 3, scale) + entry(33922, 12, 6, tie) +
          entry(34735, 3, 8, keys);
  tiff += "\0\0\0\0"s;                                      // no further directory
  tiff += "\1\0\1\0\0\0\1\0\x02\x04\xb1\x87\x09\0\x05\0"s;  // one key: a citation in text that is missing
  for (const double value : {2.0, 2.0, 0.0, 0.0, 0.0, 0.0, -3.0, 3.0, 0.0})
    tiff.append(reinterpret_cast<const char*>(&value), sizeof value);
  return tiff + '\1';
}

TEST(FuzzedScenes, NothingIsPrintedWhileADamagedMaterialMapIsRead) {
  testing::internal::CaptureStderr();
  EXPECT_THAT(refusal("m.tif", tiff_with_broken_geokeys(),
                      [](const std::filesystem::path& file) {
                        RasterMaterialMap map;
                        map.file = file;
                        map.classes = {{"1", "sand", {}}};
                        EXPECT_GT(cut_by_map({{}, map}), 0u);
                      }),
              IsEmpty());
  EXPECT_THAT(testing::internal::GetCapturedStderr(), IsEmpty());
}

// ---- Coordinate reference systems

// GDAL accepts a file name or an address and reads its contents.
TEST(FuzzedScenes, CoordinateReferenceSystemIsNoNameOfAFile) {
  const TestFolder folder;
  const auto file = folder.write("crs.txt", "EPSG:32632");
  const SourcePlace place{"scene.toml", 2, 1};
  const auto refused = [&](const std::string& crs) {
    try {
      LocalFrame::projected(crs, 0, 0, 0, place);
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_THAT(refused("EPSG:32632"), IsEmpty());
  EXPECT_THAT(refused(file.string()), HasSubstr("is not a known coordinate reference system"));
  EXPECT_THAT(refused("http://localhost:1/crs"), HasSubstr("is not a known coordinate reference system"));
}

}  // namespace
}  // namespace tubefoot
