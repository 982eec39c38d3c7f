// SPDX-License-Identifier: GPL-3.0-or-later
// Tests terrain by tiles: the facets are those of the whole terrain in the same order, and the sources of
// virtual rasters are found.

#include "scene/rasters/terrain_tiles.hpp"

#include <gdal_priv.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <numeric>
#include <random>
#include <tuple>

#include "files/companions.hpp"
#include "files/input_error.hpp"
#include "files/vrt_file.hpp"
#include "fixtures/world/read_scenes.hpp"
#include "scene/rasters/raster.hpp"

namespace tubefoot {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::ThrowsMessage;

constexpr int columns = 211, rows = 150;
constexpr double no_data = 9999;

/// Writes a raster with `holes_of_1000` pixels without data per thousand.
RasterTerrain write_raster(const TestFolder& folder, unsigned seed, unsigned holes_of_1000,
                           const char* crs_name = "EPSG:32630") {
  GDALAllRegister();
  const auto file = folder.path() / "bed.tif";
  const GDALDatasetUniquePtr out(GetGDALDriverManager()->GetDriverByName("GTiff")->Create(
      file.c_str(), columns, rows, 1, GDT_Float32, nullptr));
  OGRSpatialReference crs;
  crs.SetFromUserInput(crs_name);
  const bool degrees = crs.IsGeographic();
  double place[6] = {degrees ? -3.0 : 500000, degrees ? 1e-5 : 0.5, 0, degrees ? 47.0 : 5300000, 0,
                     degrees ? -1e-5 : -0.5};
  out->SetGeoTransform(place);
  out->SetSpatialRef(&crs);
  std::mt19937 random(seed);
  std::vector<float> values;
  for (int k = 0; k < columns * rows; ++k)
    values.push_back(random() % 1000 < holes_of_1000 ? float(no_data) : -20 - float(random() % 1000) / 250);
  out->GetRasterBand(1)->SetNoDataValue(no_data);
  EXPECT_EQ(out->GetRasterBand(1)->RasterIO(GF_Write, 0, 0, columns, rows, values.data(), columns, rows,
                                            GDT_Float32, 0, 0, nullptr),
            CE_None);
  RasterTerrain terrain;
  terrain.file = file;
  return terrain;
}

using Corners = std::array<glm::dvec3, 3>;

std::vector<Corners> corners_of(const ComponentMesh& mesh) {
  std::vector<Corners> list;
  for (const auto& [a, b, c] : mesh.triangles)
    list.push_back({mesh.points_m[a], mesh.points_m[b], mesh.points_m[c]});
  return list;
}

void expect_parts_of_the_whole(const RasterTerrain& terrain, unsigned seed) {
  SCOPED_TRACE(seed);
  std::optional<LocalFrame> frame, same_frame;
  const ComponentMesh whole = read_raster(terrain, frame);
  const TerrainTiles tiles(terrain, same_frame);
  EXPECT_EQ(tiles.facets(), whole.triangles.size());
  EXPECT_EQ(tiles.vertices(), whole.points_m.size());
  EXPECT_EQ(tiles.hole_cells(), whole.hole_cells);
  EXPECT_EQ(tiles.warnings(), whole.warnings);
  glm::dvec3 lo = whole.points_m.front(), hi = lo;
  for (const glm::dvec3& p : whole.points_m) lo = glm::min(lo, p), hi = glm::max(hi, p);
  EXPECT_EQ(tiles.lo_m(), lo);
  EXPECT_EQ(tiles.hi_m(), hi);

  std::vector<std::uint32_t> all(tiles.tiles().size());
  std::iota(all.begin(), all.end(), 0u);
  const ComponentMesh again = tiles.read(all);
  EXPECT_EQ(again.points_m, whole.points_m);
  EXPECT_EQ(again.triangles, whole.triangles);

  const std::vector<Corners> corners = corners_of(whole);
  std::mt19937 random(seed);
  for (int round = 0; round < 8; ++round) {
    std::vector<std::uint32_t> some;
    for (const std::uint32_t k : all)
      if (random() % 3 == 0) some.push_back(k);
    const std::vector<Corners> part = corners_of(tiles.read(some));
    const std::vector<std::uint64_t> numbers = tiles.numbers_of(some);
    ASSERT_EQ(part.size(), numbers.size());
    for (std::size_t f = 0; f < part.size(); ++f) ASSERT_EQ(part[f], corners.at(numbers[f])) << f;
    std::size_t facets = 0;
    for (const std::uint32_t k : some) facets += tiles.tiles()[k].facets;
    EXPECT_EQ(part.size(), facets);
  }
  // Each vertex in the box of a tile belongs to the tile. The box also contains the facets at the border of
  // the tile.
  for (const std::uint32_t k : all) {
    const ComponentMesh own = tiles.read(std::vector{k});
    std::vector<glm::dvec3> points = own.points_m;
    const auto less = [](const glm::dvec3& p, const glm::dvec3& q) {
      return std::tie(p.x, p.y) < std::tie(q.x, q.y);
    };
    std::sort(points.begin(), points.end(), less);
    for (const Corners& facet : corners) {
      if (std::ranges::none_of(facet, [&](const glm::dvec3& p) {
            return std::binary_search(points.begin(), points.end(), p, less);
          }))
        continue;
      for (const glm::dvec3& p : facet) {
        ASSERT_EQ(glm::min(p, tiles.tiles()[k].lo_m), tiles.tiles()[k].lo_m);
        ASSERT_EQ(glm::max(p, tiles.tiles()[k].hi_m), tiles.tiles()[k].hi_m);
      }
    }
  }
}

TEST(TerrainTiles, AreTheFacetsOfTheWholeInItsOrder) {
  const TestFolder folder;
  expect_parts_of_the_whole(write_raster(folder, 1, 0), 1);
  expect_parts_of_the_whole(write_raster(folder, 2, 30), 2);
  expect_parts_of_the_whole(write_raster(folder, 3, 600), 3);
}

TEST(TerrainTiles, KeepWindowStepAndFrame) {
  const TestFolder folder;
  RasterTerrain terrain = write_raster(folder, 4, 20, "EPSG:4326");
  expect_parts_of_the_whole(terrain, 4);
  terrain.window = {{3, 5, 200, 140}};
  terrain.decimate = 2;
  terrain.depth_positive_down = true;
  expect_parts_of_the_whole(terrain, 5);
  terrain.window = {{0, 0, 65, 66}};  // one tile wide; one row of cells more than a tile
  terrain.decimate = 1;
  expect_parts_of_the_whole(terrain, 6);
}

TEST(TerrainTiles, RefuseARasterWithoutAFacet) {
  const TestFolder folder;
  const RasterTerrain terrain = write_raster(folder, 7, 1000);
  EXPECT_THAT(
      [&] {
        std::optional<LocalFrame> frame;
        TerrainTiles(terrain, frame);
      },
      ThrowsMessage<InputError>(HasSubstr("no facets can be formed")));
}

std::string vrt_of(const std::string& source, int relative = 1) {
  return "<VRTDataset rasterXSize=\"4\" rasterYSize=\"4\"><VRTRasterBand band=\"1\" "
         "dataType=\"Float32\"><SimpleSource>"
         "<SourceFilename relativeToVRT=\"" +
         std::to_string(relative) + "\">" + source +
         "</SourceFilename></SimpleSource></VRTRasterBand></VRTDataset>";
}

TEST(VrtSources, AreFoundThroughVirtualRastersAndEachOnce) {
  const TestFolder folder;
  const auto outer = folder.write("outer.vrt", vrt_of("inner.tif") + "<!-- -->"),
             inner = folder.write("inner.tif", vrt_of("bed.asc"));  // identified by its content, as in GDAL
  const auto seabed = folder.write("bed.asc", "ncols 2\n");
  EXPECT_THAT(companions_of(outer), ElementsAre(inner, seabed));
  EXPECT_THAT(companions_of(seabed), IsEmpty());
  const auto own = folder.write("own.vrt", vrt_of("own.vrt"));
  EXPECT_THAT(vrt_sources(own), ElementsAre(own));
  EXPECT_THAT([&] { companions_of(own); }, ThrowsMessage<InputError>(HasSubstr("nested in 8 others")));
  EXPECT_THAT(vrt_sources(folder.write("far.vrt", vrt_of("/elsewhere/bed.tif", 0))),
              ElementsAre("/elsewhere/bed.tif"));
}

TEST(VrtSources, OfNetworksAndArchivesAreRefused) {
  const TestFolder folder;
  for (const char* source : {"/vsicurl/http://example.org/bed.tif", "/vsizip//bed.zip/bed.tif"}) {
    const auto file = folder.write("net.vrt", vrt_of(source, 0));
    EXPECT_THAT([&] { vrt_sources(file); }, ThrowsMessage<InputError>(HasSubstr("virtual file system")));
    RasterTerrain terrain;
    terrain.file = file;
    EXPECT_THAT(
        [&] {
          std::optional<LocalFrame> frame;
          read_raster(terrain, frame);
        },
        ThrowsMessage<InputError>(HasSubstr("virtual file system")));
  }
  const auto broken = folder.write("broken.vrt", "<VRTDataset><SimpleSource>");
  EXPECT_THAT([&] { vrt_sources(broken); },
              ThrowsMessage<InputError>(HasSubstr("cannot be read as a virtual raster")));
}

TEST(VrtSources, ThatAreMissingAreNamed) {
  const TestFolder folder;
  RasterTerrain terrain;
  terrain.file = folder.write("gone.vrt", vrt_of("gone.tif"));
  EXPECT_THAT(
      [&] {
        std::optional<LocalFrame> frame;
        read_raster(terrain, frame);
      },
      ThrowsMessage<InputError>(HasSubstr("gone.tif', which is not a file")));
}

}  // namespace
}  // namespace tubefoot
