// SPDX-License-Identifier: GPL-3.0-or-later
// Tests BAGs of variable resolution: each node at its resolution, without cracks between supergrids. The
// oracle for the positions of nodes is GDAL's result for each supergrid.
#include "scene/rasters/variable_grid.hpp"

#include <gdal_priv.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <hdf5.h>

#include <cmath>
#include <cstdlib>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <map>
#include <random>

#include "fixtures/world/read_scenes.hpp"
#include "scene/rasters/raster.hpp"
#include "scene/rasters/raster_reader.hpp"
#include "scene/rasters/terrain_tiles.hpp"

namespace tubefoot {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::ThrowsMessage;

constexpr double cell = 50, west = 620000, north = 7246000;
constexpr float bag_no_data = 1e6f;

struct Grid {
  std::uint32_t nodes = 0;  ///< per side; 0: none
  float first_x = -1;       ///< -1: half a step
};

/// From the south, as in the file.
using Layout = std::vector<std::vector<Grid>>;

double plane(double x, double y) { return -30 + 0.01 * (x - west) + 0.02 * (y - north); }

/// A BAG of one resolution from GDAL's driver, to which the test adds the variable-resolution data.
struct VariableBag {
  TestFolder folder;
  std::filesystem::path file = folder.path() / "vr.bag";
  std::vector<std::vector<float>> heights;  ///< of each supergrid

  template <class Height>
  VariableBag(const Layout& layout, const Height& height, const char* node_member = "depth",
              std::uint32_t shift = 0) {
    GDALAllRegister();
    const int rows = static_cast<int>(layout.size()), columns = static_cast<int>(layout[0].size());
    {
      const GDALDatasetUniquePtr plain(
          GetGDALDriverManager()->GetDriverByName("MEM")->Create("", columns, rows, 2, GDT_Float32, nullptr));
      std::array<double, 6> transform{west, cell, 0, north, 0, -cell};
      plain->SetGeoTransform(transform.data());
      OGRSpatialReference crs;
      crs.SetFromUserInput("EPSG:32602");
      plain->SetSpatialRef(&crs);
      std::vector<float> overview(static_cast<std::size_t>(rows * columns), -30);
      for (const int band : {1, 2}) {
        EXPECT_EQ(plain->GetRasterBand(band)->RasterIO(GF_Write, 0, 0, columns, rows, overview.data(),
                                                       columns, rows, GDT_Float32, 0, 0, nullptr),
                  CE_None);
        plain->GetRasterBand(band)->SetNoDataValue(bag_no_data);
      }
      const GDALDatasetUniquePtr written(GetGDALDriverManager()->GetDriverByName("BAG")->CreateCopy(
          file.c_str(), plain.get(), FALSE, nullptr, nullptr, nullptr));
    }
    struct Entry {
      std::uint32_t index, nx, ny;
      float rx, ry, x, y;
    };
    std::vector<Entry> entries;
    std::vector<float> nodes;
    for (int row = 0; row < rows; ++row)
      for (int column = 0; column < columns; ++column) {
        const Grid& g = layout[row][column];
        const float step = g.nodes == 0 ? 0 : static_cast<float>(cell / g.nodes);
        const float first = g.first_x < 0 ? step / 2 : g.first_x;
        entries.push_back({g.nodes == 0 ? ~0u : static_cast<std::uint32_t>(nodes.size()) + shift, g.nodes,
                           g.nodes, step, step, first, step / 2});
        heights.emplace_back();
        for (std::uint32_t k = 0; k < g.nodes * g.nodes; ++k) {
          const auto along = [&](std::uint32_t n) {
            return static_cast<double>(n) * static_cast<double>(step);
          };
          const double x = west + column * cell + static_cast<double>(first) + along(k % g.nodes),
                       y = north - (rows - row) * cell + along(1) / 2 + along(k / g.nodes);
          nodes.push_back(static_cast<float>(height(x, y)));
          heights.back().push_back(nodes.back());
        }
      }
    const hid_t id = H5Fopen(file.c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
    const hid_t entry = H5Tcreate(H5T_COMPOUND, sizeof(Entry));
    H5Tinsert(entry, "index", offsetof(Entry, index), H5T_NATIVE_UINT32);
    H5Tinsert(entry, "dimensions_x", offsetof(Entry, nx), H5T_NATIVE_UINT32);
    H5Tinsert(entry, "dimensions_y", offsetof(Entry, ny), H5T_NATIVE_UINT32);
    H5Tinsert(entry, "resolution_x", offsetof(Entry, rx), H5T_NATIVE_FLOAT);
    H5Tinsert(entry, "resolution_y", offsetof(Entry, ry), H5T_NATIVE_FLOAT);
    H5Tinsert(entry, "sw_corner_x", offsetof(Entry, x), H5T_NATIVE_FLOAT);
    H5Tinsert(entry, "sw_corner_y", offsetof(Entry, y), H5T_NATIVE_FLOAT);
    const hid_t node = H5Tcreate(H5T_COMPOUND, 2 * sizeof(float));
    H5Tinsert(node, node_member, 0, H5T_NATIVE_FLOAT);
    H5Tinsert(node, "depth_uncrt", sizeof(float), H5T_NATIVE_FLOAT);
    std::vector<float> pairs;
    for (const float z : nodes) pairs.insert(pairs.end(), {z, 0.1f});
    const auto write = [&](const char* name, hsize_t n, hsize_t m, hid_t type, const void* values) {
      const std::array<hsize_t, 2> extent{n, m};
      const hid_t space = H5Screate_simple(2, extent.data(), nullptr);
      const hid_t set = H5Dcreate2(id, name, type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
      EXPECT_GE(H5Dwrite(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values), 0);
      H5Sclose(space);
      return set;
    };
    const hid_t table = write("/BAG_root/varres_metadata", static_cast<hsize_t>(rows),
                              static_cast<hsize_t>(columns), entry, entries.data());
    H5Dclose(write("/BAG_root/varres_refinements", 1, pairs.size() / 2, node, pairs.data()));
    // GDAL does not open the file without these attributes.
    const hid_t scalar = H5Screate(H5S_SCALAR);
    for (const char* name :
         {"min_resolution_x", "min_resolution_y", "max_resolution_x", "max_resolution_y"}) {
      const float value = std::string_view(name).starts_with("min") ? 1 : 50;
      const hid_t attribute = H5Acreate2(table, name, H5T_NATIVE_FLOAT, scalar, H5P_DEFAULT, H5P_DEFAULT);
      H5Awrite(attribute, H5T_NATIVE_FLOAT, &value);
      H5Aclose(attribute);
    }
    H5Sclose(scalar);
    H5Dclose(table);
    H5Tclose(entry);
    H5Tclose(node);
    H5Fclose(id);
  }

  /// In the frame of UTM zone 2N about the north-west corner.
  ComponentMesh read(RasterTerrain terrain = {}) const {
    std::optional<LocalFrame> frame = LocalFrame::projected("EPSG:32602", west, north, 0, {"scene", 1, 1});
    terrain.file = file;
    return read_raster(terrain, frame);
  }
};

double plan_area(const ComponentMesh& mesh) {
  double sum = 0;
  for (const auto& [a, b, c] : mesh.triangles) {
    const double twice =
        glm::cross(mesh.points_m[b] - mesh.points_m[a], mesh.points_m[c] - mesh.points_m[a]).z;
    EXPECT_GT(twice, 0) << "facets face up";
    sum += twice / 2;
  }
  return sum;
}

/// Counts edges of only one facet, and finds whether another vertex lies within such an edge.
std::size_t border_edges(const ComponentMesh& mesh, bool& cracked) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> uses;
  for (const auto& t : mesh.triangles)
    for (int k = 0; k < 3; ++k) ++uses[std::minmax(t[k], t[(k + 1) % 3])];
  std::size_t count = 0;
  cracked = false;
  for (const auto& [edge, n] : uses) {
    EXPECT_LE(n, 2) << "an edge with three facets";
    if (n != 1) continue;
    ++count;
    const glm::dvec2 a(mesh.points_m[edge.first]), b(mesh.points_m[edge.second]);
    for (std::uint32_t v = 0; v < mesh.points_m.size(); ++v) {
      if (v == edge.first || v == edge.second) continue;
      const glm::dvec2 p(mesh.points_m[v]);
      const double along = glm::dot(p - a, b - a) / glm::dot(b - a, b - a),
                   off = std::abs((b.x - a.x) * (p.y - a.y) - (b.y - a.y) * (p.x - a.x));
      // On the outer rim, nodes of one side of a cell may be collinear, but none lies within an edge.
      if (along > 1e-9 && along < 1 - 1e-9 && off < 1e-9) cracked = true;
    }
  }
  return count;
}

const Layout mixed{{{25}, {10}, {0}}, {{5}, {25}, {2}}};

TEST(VariableGrid, HasEveryNodeWhereGdalHasIt) {
  std::mt19937_64 random(18);
  std::uniform_real_distribution<double> any(-40, -20);
  const VariableBag bag(mixed, [&](double, double) { return any(random); });
  const ComponentMesh mesh = bag.read();
  std::map<std::pair<double, double>, double> vertices;
  for (const glm::dvec3& p : mesh.points_m) vertices[{p.x + west, p.y + north}] = p.z;
  std::size_t seen = 0;
  for (const auto& [row, column] : {std::pair{0, 0}, {0, 1}, {1, 0}, {1, 1}, {1, 2}}) {
    const std::string name =
        "BAG:\"" + bag.file.string() + "\":supergrid:" + std::to_string(row) + ":" + std::to_string(column);
    const GDALDatasetUniquePtr grid(GDALDataset::Open(name.c_str()));
    ASSERT_NE(grid, nullptr);
    std::array<double, 6> g{};
    grid->GetGeoTransform(g.data());
    const int nx = grid->GetRasterXSize(), ny = grid->GetRasterYSize();
    std::vector<double> z(static_cast<std::size_t>(nx * ny));
    ASSERT_EQ(
        grid->GetRasterBand(1)->RasterIO(GF_Read, 0, 0, nx, ny, z.data(), nx, ny, GDT_Float64, 0, 0, nullptr),
        CE_None);
    for (int k = 0; k < nx * ny; ++k, ++seen) {
      const auto found = vertices.find({g[0] + (k % nx + 0.5) * g[1], g[3] + (k / nx + 0.5) * g[5]});
      ASSERT_NE(found, vertices.end()) << name << " node " << k;
      EXPECT_EQ(found->second, z[k]);
    }
  }
  EXPECT_EQ(mesh.points_m.size(), seen);
  EXPECT_EQ(seen, 25u * 25 + 10 * 10 + 5 * 5 + 25 * 25 + 2 * 2);
}

// There are no cracks, overlaps or holes. A plane remains a plane, edges of only one facet form the
// outline, and the area is that of the outline.
TEST(VariableGrid, JoinsItsSupergridsWithoutCracks) {
  std::mt19937 random(7);
  for (int trial = 0; trial < 20; ++trial) {
    Layout layout(3, std::vector<Grid>(4));
    for (auto& row : layout)
      for (Grid& g : row) g.nodes = 1 + static_cast<std::uint32_t>(random() % 9);
    SCOPED_TRACE(trial);
    const VariableBag bag(layout, plane);
    const ComponentMesh mesh = bag.read();
    EXPECT_EQ(mesh.hole_cells, 0u);
    double area = plan_area(mesh);
    bool cracked = false;
    const std::size_t edges = border_edges(mesh, cracked);
    EXPECT_FALSE(cracked);
    // By Euler's formula: one piece without holes.
    EXPECT_EQ(mesh.triangles.size(), 2 * mesh.points_m.size() - 2 - edges);
    std::map<std::pair<std::uint32_t, std::uint32_t>, int> uses;
    for (const auto& t : mesh.triangles)
      for (int k = 0; k < 3; ++k) ++uses[{t[k], t[(k + 1) % 3]}];
    double enclosed = 0;
    for (const auto& [edge, n] : uses) {
      EXPECT_EQ(n, 1) << "facets over each other";
      if (uses.contains({edge.second, edge.first})) continue;
      const glm::dvec3 a = mesh.points_m[edge.first], b = mesh.points_m[edge.second];
      enclosed += (a.x * b.y - b.x * a.y) / 2;
    }
    EXPECT_NEAR(area, enclosed, 1e-6);
    // The outline lies within half of the widest step from the border of the whole.
    EXPECT_GT(area, 150.0 * 100);
    for (const glm::dvec3& p : mesh.points_m) EXPECT_NEAR(p.z, plane(p.x + west, p.y + north), 1e-5);
  }
}

TEST(VariableGrid, ToldFromItsOverview) {
  const VariableBag bag(mixed, plane);
  EXPECT_GT(bag.read().triangles.size(), 2000u);  // the overview has 4
}

TEST(VariableGrid, WhatIsMissingIsAHoleAndCounted) {
  const VariableBag whole({{{5}, {5}}, {{5}, {5}}}, plane);
  const double area = plan_area(whole.read());
  EXPECT_DOUBLE_EQ(area, 90 * 90);
  // One supergrid less: its own 40 x 40, two strips of 40 x 10, and half of the square between the corners.
  const VariableBag less({{{5}, {0}}, {{5}, {5}}}, plane);
  const ComponentMesh mesh = less.read();
  EXPECT_DOUBLE_EQ(area - plan_area(mesh), 40 * 40 + 2 * 40 * 10 + 50);
  EXPECT_EQ(mesh.hole_cells, 2u);
  // One node less, at the side of a strip.
  int count = 0;
  const VariableBag dot({{{5}, {5}}, {{5}, {5}}},
                        [&](double x, double y) { return ++count == 5 ? bag_no_data : plane(x, y); });
  EXPECT_GT(dot.read().hole_cells, 0u);
  EXPECT_LT(plan_area(dot.read()), area);
}

TEST(VariableGrid, IsResampledWhereRequested) {
  const VariableBag bag({{{25}, {10}}, {{5}, {2}}}, plane);
  RasterTerrain terrain;
  terrain.resolution_m = 4;
  const ComponentMesh mesh = bag.read(terrain);
  for (const glm::dvec3& p : mesh.points_m) {
    EXPECT_NEAR(p.z, plane(p.x + west, p.y + north), 1e-5);
    EXPECT_NEAR(std::remainder(p.x - 2, 4), 0, 1e-9);
    EXPECT_NEAR(std::remainder(p.y + 100 - 2, 4), 0, 1e-9);
  }
  EXPECT_GT(mesh.points_m.size(), 400u);
  EXPECT_LE(mesh.points_m.size(), 625u);
}

TEST(VariableGrid, AWindowTakesWholeSupergrids) {
  const VariableBag bag({{{5}, {5}, {5}}, {{5}, {5}, {4}}}, plane);
  RasterTerrain terrain;
  terrain.window = {1, 0, 2, 1};
  EXPECT_EQ(bag.read(terrain).points_m.size(), 5u * 5 + 4 * 4);
}

TEST(VariableGrid, RefusesWhatItCannotBe) {
  const auto refused = [](const auto& read, const char* what) {
    EXPECT_THAT(read, ThrowsMessage<InputError>(AllOf(HasSubstr("vr.bag"), HasSubstr(what))));
  };
  const VariableBag good(mixed, plane);
  RasterTerrain terrain;
  terrain.decimate = 2;
  refused([&] { good.read(terrain); }, "give resolution_m instead");
  terrain = {};
  terrain.resolution_m = 1e-3;
  refused([&] { good.read(terrain); }, "choose a larger resolution_m");
  terrain = {};
  terrain.file = good.file;
  std::optional<LocalFrame> frame;
  refused([&] { TerrainTiles(terrain, frame); }, "cannot be loaded in tiles");
  refused([&] { RasterFile(good.file); }, "coarse overview");
  terrain.file =
      good.folder.write("of-vr.bag.vrt",
                        "<VRTDataset rasterXSize=\"3\" "
                        "rasterYSize=\"2\"><GeoTransform>0,1,0,0,0,-1</GeoTransform><VRTRasterBand "
                        "dataType=\"Float32\" band=\"1\"><SimpleSource><SourceFilename "
                        "relativeToVRT=\"1\">vr.bag</SourceFilename>"
                        "<SourceBand>1</SourceBand></SimpleSource></VRTRasterBand></VRTDataset>");
  refused([&] { read_raster(terrain, frame); }, "coarse overview");
  const VariableBag touching({{{5}, {5, 10}}, {{5}, {5}}}, plane);
  refused([&] { touching.read(); }, "extend beyond a cell");
  const VariableBag no_depths({{{5}, {5}}, {{5}, {5}}}, plane, "height");
  refused([&] { no_depths.read(); }, "records without 'depth'");
  const VariableBag beyond({{{5}, {5}}, {{5}, {5}}}, plane, "depth", 10);
  refused([&] { beyond.read(); }, "nodes from number");
}

// advised_commands_test.py does the same for other files.
TEST(VariableGrid, AdvisedCommandGivesTheSameSurface) {
  if (std::system("gdal_translate --version >/dev/null 2>&1") != 0) GTEST_SKIP() << "no gdal_translate here";
  struct Case {
    const char* what;
    Layout layout;
    double coarsest;  ///< the widest step, which the advised resolution is not below
  };
  for (const Case& one : {Case{"one resolution", {{{5}, {5}}, {{5}, {5}}}, 10},
                          Case{"many resolutions", {{{25}, {10}, {3}}, {{5}, {25}, {2}}}, 25},
                          Case{"a cell without nodes", mixed, 25},
                          Case{"nodes on the borders of cells", {{{5, 0}, {7, 0}}, {{6, 0}, {9}}}, 10},
                          Case{"one node", {{{1}, {4}}, {{4}, {4}}}, 50}}) {
    SCOPED_TRACE(one.what);
    const VariableBag bag(one.layout, plane);
    std::string said;
    try {
      RasterFile refused(bag.file);
    } catch (const InputError& error) {
      said = error.what();
    }
    const std::size_t begin = said.find("`gdal_translate "), end = said.find('`', begin + 1);
    ASSERT_NE(end, said.npos) << said;
    ASSERT_EQ(std::system((said.substr(begin + 1, end - begin - 1) + " >/dev/null").c_str()), 0) << said;
    std::optional<LocalFrame> frame = LocalFrame::projected("EPSG:32602", west, north, 0, {"scene", 1, 1});
    RasterTerrain terrain;
    terrain.file = bag.folder.path() / "vr_new.tif";
    const ComponentMesh copy = read_raster(terrain, frame), own = bag.read();
    double step = cell;
    for (const glm::dvec3& a : copy.points_m)
      if (const double apart = std::abs(a.x - copy.points_m[0].x); apart > 1e-6) step = std::min(step, apart);
    EXPECT_GE(step, one.coarsest - 1e-6);
    EXPECT_LT(step, std::max(2 * one.coarsest, 25.0));
    for (const glm::dvec3& p : copy.points_m)
      EXPECT_NEAR(p.z, plane(p.x + west, p.y + north), 0.5 * step * 0.03 + 1e-5);
    // No holes except those of the file: the rims differ by one cell of the copy.
    EXPECT_EQ(copy.hole_cells > 0, own.hole_cells > 0);
    EXPECT_NEAR(std::sqrt(plan_area(copy)), std::sqrt(plan_area(own)), 2 * step);
  }
}

TEST(VariableGrid, ResolutionIsNotForOthers) {
  RasterTerrain terrain;
  TestFolder folder;
  terrain.file =
      folder.write("grid.asc", "ncols 2\nnrows 2\nxllcorner 0\nyllcorner 0\ncellsize 1\n1 1\n1 1\n");
  terrain.resolution_m = 2;
  std::optional<LocalFrame> frame;
  EXPECT_THAT([&] { read_raster(terrain, frame); },
              ThrowsMessage<InputError>(HasSubstr("has one resolution")));
}

}  // namespace
}  // namespace tubefoot
