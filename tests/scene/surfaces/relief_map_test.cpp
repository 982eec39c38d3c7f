// SPDX-License-Identifier: GPL-3.0-or-later
// Tests relief from height maps: position, projection, tiling, units, cells without data, and rejected
// files.

#include "scene/surfaces/relief_map.hpp"

#include <gdal_priv.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>

#include "fixtures/world/read_scenes.hpp"

namespace tubefoot {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

constexpr double kNoData = -9999;
constexpr const char* kUtm31 = "EPSG:32631";

struct TestMap {
  int columns = 8, rows = 6;
  std::function<double(int, int)> value;  // by column and row from the north-west
  std::array<double, 6> geotransform{500000, 2, 0, 6650000, 0, -3};
  const char* crs = kUtm31;
  const char* unit = "";
};

std::filesystem::path write(const TestFolder& folder, const TestMap& map) {
  GDALAllRegister();
  const auto file = folder.path() / "map.tif";
  char sparse[] = "SPARSE_OK=TRUE";
  char* options[] = {sparse, nullptr};
  const GDALDatasetUniquePtr out(GetGDALDriverManager()->GetDriverByName("GTiff")->Create(
      file.c_str(), map.columns, map.rows, 1, GDT_Float64, options));
  std::array<double, 6> geotransform = map.geotransform;
  if (geotransform[1] != 0) out->SetGeoTransform(geotransform.data());
  if (map.crs != nullptr) {
    OGRSpatialReference crs;
    crs.SetFromUserInput(map.crs);
    out->SetSpatialRef(&crs);
  }
  GDALRasterBand& band = *out->GetRasterBand(1);
  band.SetNoDataValue(kNoData);
  if (map.unit[0] != '\0') band.SetUnitType(map.unit);
  std::vector<double> row(map.columns);
  for (int j = 0; j < map.rows && map.value; ++j) {
    for (int i = 0; i < map.columns; ++i) row[i] = map.value(i, j);
    EXPECT_EQ(
        band.RasterIO(GF_Write, 0, j, map.columns, 1, row.data(), map.columns, 1, GDT_Float64, 0, 0, nullptr),
        CE_None);
  }
  return file;
}

std::shared_ptr<const ElevationField> read(const TestMap& map, const LocalFrame& frame = {},
                                           std::optional<double> tile_m = {}, double scale = 1) {
  const TestFolder folder;
  std::vector<std::string> warnings;
  auto field = read_relief_map({write(folder, map), tile_m, scale}, frame, warnings);
  EXPECT_THAT(warnings, IsEmpty());
  return field;
}

std::string error_of(const TestMap& map, const LocalFrame& frame = {}, std::optional<double> tile_m = {}) {
  try {
    read(map, frame, tile_m);
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("map.tif"));
    return error.what();
  }
  return {};
}

double wavy(int column, int row) { return 0.1 * std::sin(1.3 * column) + 0.05 * std::cos(0.9 * row * row); }

TEST(ReliefMap, LiesInTheFramesOwnProjectionToTheCell) {
  const LocalFrame frame = LocalFrame::projected(kUtm31, 500003, 6649990, 0, {});
  TestMap map{.value = wavy};
  const auto field = read(map, frame);
  for (int row = 0; row < 6; ++row)
    for (int column = 0; column < 8; ++column)
      EXPECT_NEAR(field->height_m({2 * column + 1 - 3, 10 - 3 * row - 1.5, -20}), wavy(column, row), 1e-7);
  EXPECT_EQ(field->height_m({1000, 0, 0}), 0);
  EXPECT_EQ(field->finest_m(), 2);
  EXPECT_GE(field->largest_m(), 0.1);
}

TEST(ReliefMap, WithoutAnyReferenceLocalMetresAreMeant) {
  const auto field = read({.value = wavy, .geotransform = {-4, 0.5, 0, 7, 0, -0.5}, .crs = nullptr});
  EXPECT_NEAR(field->height_m({-4 + 0.25 + 2.5, 7 - 0.25 - 1, 0}), wavy(5, 2), 1e-7);
}

TEST(ReliefMap, IsCarriedIntoAnotherFrame) {
  // A hill on geographic cells, which are about square at 60 degrees north, in a frame tangent there. The
  // position of each height is that of its latitude and longitude in the frame.
  constexpr int n = 60;
  const auto hill = [](double column, double row) {
    const double x = (column - 30) / 9, y = (row - 24) / 12;
    return 2 * std::exp(-x * x - y * y);
  };
  const TestMap map{.columns = n,
                    .rows = n,
                    .value = hill,
                    .geotransform = {20, 0.0002, 0, 60.006, 0, -0.0001},
                    .crs = "EPSG:4326"};
  for (const double turn : {0.0, 1.0}) {
    // The second frame uses a projection of another zone, whose north is rotated by some degrees.
    const LocalFrame frame = turn == 0 ? LocalFrame::at_lat_lon(60.002, 20.004, 0)
                                       : LocalFrame::projected("EPSG:32632", 1110000, 6700000, 0, {});
    const auto field = read(map, frame);
    for (int row = 2; row < n - 2; row += 5)
      for (int column = 2; column < n - 2; column += 5) {
        const glm::dvec3 place =
            frame.from_lat_lon(60.006 - 0.0001 * (row + 0.5), 20 + 0.0002 * (column + 0.5), 0, {});
        EXPECT_NEAR(field->height_m(place), hill(column, row), 0.01) << column << " " << row << " " << turn;
      }
  }
}

TEST(ReliefMap, RepeatsEveryTile) {
  // 8 x 6 square cells of 0.5 m, from the origin, with or without a georeference.
  for (const double cell : {0.0, 2.0}) {
    const auto field = read({.value = wavy, .geotransform = {500000, cell, 0, 0, 0, -3}}, {}, 4.0, -2);
    for (int row = 0; row < 6; ++row)
      for (int column = 0; column < 8; ++column)
        for (const int copy : {0, -3, 1000}) {
          const double east = 0.5 * (column + 0.5) + 4 * copy, north = 3 - 0.5 * (row + 0.5) - 3 * copy;
          EXPECT_NEAR(field->height_m({east, north, 5}), -2 * wavy(column, row), 2e-7);
        }
  }
}

TEST(ReliefMap, CellsWithoutDataHaveNoHeight) {
  const auto field = read({.value =
                               [](int i, int j) {
                                 if (i == 3 && j == 2) return kNoData;
                                 if (i == 6 && j == 4) return std::nan("");
                                 return 0.25;
                               }},
                          {}, 8.0);
  EXPECT_NEAR(field->height_m({3.5, 6 - 2.5, 0}), 0, 1e-7);
  EXPECT_NEAR(field->height_m({6.5, 6 - 4.5, 0}), 0, 1e-7);
  EXPECT_NEAR(field->height_m({0.5, 0.5, 0}), 0.25, 1e-7);
}

TEST(ReliefMap, UnitsBecomeMetres) {
  const auto field = read({.value = [](int, int) { return 10.0; }, .unit = "cm"}, {}, 8.0);
  EXPECT_NEAR(field->height_m({2.3, 1.7, 0}), 0.1, 1e-7);
}

TEST(ReliefMap, WhatCannotBePlacedOrReadIsReported) {
  const LocalFrame utm = LocalFrame::projected(kUtm31, 500000, 6650000, 0, {});
  EXPECT_THAT(error_of({.value = wavy}), HasSubstr("[georeference]"));
  EXPECT_THAT(error_of({.value = wavy, .crs = nullptr}, utm), HasSubstr("coordinate reference system"));
  EXPECT_THAT(error_of({.value = wavy, .geotransform = {0, 0, 0, 0, 0, 0}}, utm), HasSubstr("geotransform"));
  EXPECT_THAT(error_of({.value = wavy, .geotransform = {0, 1, 0.1, 0, 0.1, -1}}, utm), HasSubstr("rotated"));
  EXPECT_THAT(error_of({.columns = 1, .value = wavy}, {}, 3.0), HasSubstr("2 x 2"));
  EXPECT_THAT(error_of({.columns = 10000, .rows = 5001, .value = {}}, {}, 3.0), HasSubstr("5e+07"));
  EXPECT_THAT(error_of({.value = [](int, int) { return 1e30; }}, {}, 3.0), HasSubstr("10000 m"));
  EXPECT_THAT(error_of({.value = wavy, .unit = "fathom"}, {}, 3.0), HasSubstr("fathom"));
  const TestFolder folder;
  std::vector<std::string> warnings;
  EXPECT_THROW(read_relief_map({folder.write("map.tif", "no raster"), 3.0, 1}, {}, warnings), InputError);
}

}  // namespace
}  // namespace tubefoot
