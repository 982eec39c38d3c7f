// SPDX-License-Identifier: GPL-3.0-or-later
// Tests terrain from rasters: vertices at cell centres, holes, windows, units, coordinate systems, formats,
// and rejected files.

#include "scene/rasters/raster.hpp"

#include <gdal_priv.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <netcdf.h>

#include <cmath>
#include <fstream>
#include <glm/geometric.hpp>

#include "files/netcdf_size.hpp"
#include "fixtures/world/mesh_sizes.hpp"
#include "fixtures/world/read_scenes.hpp"
#include "geometry/numbers/world_grid.hpp"
#include "scene/rasters/terrain_tiles.hpp"
#include "scene/surfaces/reflectivity.hpp"

namespace tubefoot {
namespace {

using test::area_from_above;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;
using testing::ThrowsMessage;

constexpr double kNoData = 1e6;
constexpr const char* kUtm2 = "EPSG:32602";

struct TestRaster {
  int columns = 4, rows = 3;
  std::vector<double> values;  // row by row from the north-west; empty: 10 row + column
  std::array<double, 6> geotransform = {621000, 2, 0, 7245000, 0, -3};
  const char* crs = kUtm2;
  const char* unit = "";
  double scale = 1, offset = 0;
};

std::filesystem::path write_tiff(const TestFolder& folder, const TestRaster& raster,
                                 const char* name = "r.tif") {
  GDALAllRegister();
  const auto file = folder.path() / name;
  const GDALDatasetUniquePtr out(GetGDALDriverManager()->GetDriverByName("GTiff")->Create(
      file.c_str(), raster.columns, raster.rows, 1, GDT_Float64, nullptr));
  std::array<double, 6> geotransform = raster.geotransform;
  if (geotransform[1] != 0) out->SetGeoTransform(geotransform.data());
  if (raster.crs != nullptr) {
    OGRSpatialReference crs;
    crs.SetFromUserInput(raster.crs);
    out->SetSpatialRef(&crs);
  }
  std::vector<double> values = raster.values;
  for (int i = static_cast<int>(values.size()); i < raster.columns * raster.rows; ++i) {
    values.push_back(10 * (i / raster.columns) + i % raster.columns);
  }
  GDALRasterBand& band = *out->GetRasterBand(1);
  band.SetNoDataValue(kNoData);
  if (raster.unit[0] != '\0') band.SetUnitType(raster.unit);
  if (raster.scale != 1) band.SetScale(raster.scale);
  if (raster.offset != 0) band.SetOffset(raster.offset);
  EXPECT_EQ(band.RasterIO(GF_Write, 0, 0, raster.columns, raster.rows, values.data(), raster.columns,
                          raster.rows, GDT_Float64, 0, 0, nullptr),
            CE_None);
  return file;
}

ComponentMesh read(const TestRaster& raster, std::optional<LocalFrame> frame = {},
                   RasterTerrain terrain = {}) {
  const TestFolder folder;
  terrain.file = write_tiff(folder, raster);
  return read_raster(terrain, frame);
}

LocalFrame utm_frame() { return LocalFrame::projected(kUtm2, 621000, 7245000, 0, {"scene.toml", 1, 1}); }

TEST(Raster, HasAVertexAtEachCellsCentre) {
  const ComponentMesh mesh = read({}, utm_frame());
  ASSERT_THAT(mesh.points_m, SizeIs(12));
  EXPECT_EQ(mesh.points_m[0], glm::dvec3(1, -1.5, 0));
  EXPECT_EQ(mesh.points_m[1], glm::dvec3(3, -1.5, 1));
  EXPECT_EQ(mesh.points_m[4], glm::dvec3(1, -4.5, 10));
  EXPECT_THAT(mesh.triangles, SizeIs(12));
  EXPECT_DOUBLE_EQ(area_from_above(mesh), 6 * 6);
  EXPECT_EQ(mesh.hole_cells, 0u);
  EXPECT_THAT(mesh.warnings, IsEmpty());
}

TEST(Raster, NoDataAndNanAreHolesAndThreeCornersKeepATriangle) {
  const double quarter = 2 * 3 / 2.0;
  for (int missing = 0; missing < 4; ++missing) {
    for (const double value : {kNoData, std::nan(""), HUGE_VAL}) {
      TestRaster raster{2, 2, {1, 1, 1, 1}};
      raster.values[missing] = value;
      const ComponentMesh mesh = read(raster, utm_frame());
      EXPECT_THAT(mesh.triangles, SizeIs(1));
      EXPECT_THAT(mesh.points_m, SizeIs(3));
      EXPECT_DOUBLE_EQ(area_from_above(mesh), quarter);
      EXPECT_EQ(mesh.hole_cells, 1u);
    }
  }
  // A hole in the middle of 5 x 5 centres: 12 whole cells, and 4 cells with a triangle each.
  TestRaster raster{5, 5, std::vector<double>(25, 7.0)};
  raster.values[12] = kNoData;
  const ComponentMesh mesh = read(raster, utm_frame());
  EXPECT_THAT(mesh.triangles, SizeIs(2 * 12 + 4));
  EXPECT_DOUBLE_EQ(area_from_above(mesh), (12 + 2) * 2 * quarter);
  EXPECT_EQ(mesh.hole_cells, 4u);
  for (const glm::dvec3& p : mesh.points_m) EXPECT_EQ(p.z, 7.0) << "a hole is no cliff";
}

TEST(Raster, AnIslandOfASingleCellGivesNoPoint) {
  TestRaster raster{4, 4, std::vector<double>(16, kNoData)};
  raster.values[0] = raster.values[1] = raster.values[4] = raster.values[15] = 1;
  EXPECT_THAT(read(raster, utm_frame()).points_m, SizeIs(3));
}

TEST(Raster, WindowAndDecimationKeepTheirCells) {
  TestRaster raster;
  raster.columns = 10;
  raster.rows = 8;
  RasterTerrain terrain;
  terrain.window = {{3, 2, 5, 4}};
  terrain.decimate = 2;
  const ComponentMesh mesh = read(raster, utm_frame(), terrain);
  ASSERT_THAT(mesh.points_m, SizeIs(6));  // columns 3, 5, 7 of rows 2, 4
  EXPECT_EQ(mesh.points_m[0], glm::dvec3(7, -7.5, 23));
  EXPECT_EQ(mesh.points_m[5], glm::dvec3(15, -13.5, 47));
  EXPECT_DOUBLE_EQ(area_from_above(mesh), 8 * 6);
}

TEST(Raster, DepthsUnitsScaleAndOffsetBecomeHeights) {
  TestRaster raster{2, 2, {1, 2, 3, 4}};
  raster.unit = "ft";
  raster.scale = 10;
  raster.offset = 5;
  RasterTerrain terrain;
  terrain.depth_positive_down = true;
  const ComponentMesh mesh = read(raster, utm_frame(), terrain);
  for (int i = 0; i < 4; ++i) EXPECT_DOUBLE_EQ(mesh.points_m[i].z, -(10 * (i + 1) + 5) * 0.3048);
}

TEST(Raster, UtmCostsNoPrecision) {
  TestRaster raster;
  raster.geotransform = {620152.872885372955352, 0.1, 0, 7246504.911727688275278, 0, -0.1};
  raster.columns = raster.rows = 50;
  const ComponentMesh mesh = read(raster, LocalFrame::projected(kUtm2, 620000, 7246000, 0, {}));
  const WorldGrid grid = WorldGrid::fitting({0, 0, -10}, {600, 600, 600});
  ASSERT_EQ(grid.exponent(), 20);
  for (int row = 0; row < 50; ++row) {
    for (int column = 0; column < 50; ++column) {
      const glm::dvec3 snapped = grid.to_metres(grid.snap(mesh.points_m[50 * row + column]));
      // In long double, from the numbers of the file. The coordinate itself has the spacing of doubles at
      // 7e6 m, 9.3e-10 m.
      const long double east = 620152.872885372955352L - 620000 + (column + 0.5L) * 0.1L;
      const long double north = 7246504.911727688275278L - 7246000 - (row + 0.5L) * 0.1L;
      EXPECT_LE(std::abs(static_cast<double>(snapped.x - east)), 0.5 * grid.unit_m() + 1e-9);
      EXPECT_LE(std::abs(static_cast<double>(snapped.y - north)), 0.5 * grid.unit_m() + 1e-9);
    }
  }
}

TEST(Raster, InATangentFrameEachVertexGoesToItsLatitudeAndLongitude) {
  TestRaster raster;
  raster.crs = "EPSG:4326";
  raster.geotransform = {20, 0.001, 0, 60.003, 0, -0.001};
  const LocalFrame frame = LocalFrame::at_lat_lon(60, 20, -5);
  const ComponentMesh mesh = read(raster, frame);
  const glm::dvec3 expected = frame.from_lat_lon(60.0015, 20.0025, 12, {});
  EXPECT_LE(glm::distance(mesh.points_m[6], expected), 1e-7);
}

TEST(Raster, SetsTheFrameOfASceneWithoutGeoreference) {
  const TestFolder folder;
  std::optional<LocalFrame> frame;
  const ComponentMesh first = read_raster({write_tiff(folder, {}), {}, 1, false}, frame);
  ASSERT_TRUE(frame && frame->is_georeferenced());
  EXPECT_THAT(first.warnings, ElementsAre(AllOf(HasSubstr("621004"), HasSubstr("7244996"))));
  EXPECT_EQ(first.points_m[0], glm::dvec3(621001 - 621004, 7244998.5 - 7244996, 0));
  TestRaster east;  // a second raster keeps the frame of the first
  east.geotransform[0] += 100;
  const ComponentMesh second = read_raster({write_tiff(folder, east), {}, 1, false}, frame);
  EXPECT_EQ(second.points_m[0].x, first.points_m[0].x + 100);
  EXPECT_THAT(second.warnings, IsEmpty());
}

TEST(Raster, AGeographicRasterSetsATangentFrame) {
  TestRaster raster;
  raster.crs = "EPSG:4326";
  raster.geotransform = {20, 0.001, 0, 60.003, 0, -0.001};
  std::optional<LocalFrame> frame;
  const TestFolder folder;
  const ComponentMesh mesh = read_raster({write_tiff(folder, raster), {}, 1, false}, frame);
  EXPECT_THAT(mesh.warnings, ElementsAre(AllOf(HasSubstr("60.0015"), HasSubstr("20.002"))));
  ASSERT_THAT(mesh.points_m, SizeIs(12));
  EXPECT_NEAR(mesh.points_m[7].x - mesh.points_m[4].x, 3 * 55.8, 0.5);  // 0.001 degrees at 60 degrees north
}

TEST(Raster, WithoutCrsItsCoordinatesAreLocalMetres) {
  TestRaster raster;
  raster.crs = nullptr;
  raster.geotransform = {-4, 1, 0, 3, 0, -1};
  const ComponentMesh mesh = read(raster);
  EXPECT_EQ(mesh.points_m[0], glm::dvec3(-3.5, 2.5, 0));
  EXPECT_THAT(mesh.warnings, ElementsAre(HasSubstr("metres in the local frame")));
}

void expect_refused(const TestRaster& raster, const char* message,
                    std::optional<LocalFrame> frame = utm_frame(), const RasterTerrain& terrain = {}) {
  EXPECT_THAT([&] { read(raster, frame, terrain); },
              ThrowsMessage<InputError>(AllOf(HasSubstr("r.tif: "), HasSubstr(message))));
}

TEST(Raster, RefusesWhatCannotBePlaced) {
  TestRaster raster;
  raster.crs = nullptr;
  expect_refused(raster, "gdal_translate -a_srs");
  expect_refused({}, "a preceding raster has none", LocalFrame());
  raster = {};
  raster.geotransform[2] = 0.1;
  expect_refused(raster, "rotated");
  raster = {};
  raster.geotransform[5] = 3;
  expect_refused(raster, "north-up");
  raster = {};
  raster.geotransform = {};
  expect_refused(raster, "no geotransform");
  raster = {};
  raster.unit = "fathom";
  expect_refused(raster, "'fathom'");
}

TEST(Raster, RefusesWindowsWithoutFacets) {
  RasterTerrain terrain;
  terrain.window = {{1, 1, 4, 2}};
  expect_refused({}, "does not lie in the raster of 4 x 3", utm_frame(), terrain);
  terrain.window = {{2000000000, 0, 2000000000, 2}};
  expect_refused({}, "does not lie in", utm_frame(), terrain);
  terrain.window = {{0, 0, 1, 3}};
  expect_refused({}, "at least 2 x 2", utm_frame(), terrain);
  terrain = {};
  terrain.decimate = 4;
  expect_refused({}, "at least 2 x 2", utm_frame(), terrain);
  TestRaster empty{3, 3, std::vector<double>(9, kNoData)};
  expect_refused(empty, "no facets");
}

// --- formats, whole and truncated ---

std::filesystem::path copy_as(const TestFolder& folder, const char* driver, const char* name,
                              char** options = nullptr) {
  TestRaster raster;
  raster.columns = raster.rows = 60;
  raster.geotransform[5] = -2;
  const auto tiff = write_tiff(folder, raster, "source.tif");
  const GDALDatasetUniquePtr in(GDALDataset::Open(tiff.c_str()));
  const auto file = folder.path() / name;
  const GDALDatasetUniquePtr out(GetGDALDriverManager()->GetDriverByName(driver)->CreateCopy(
      file.c_str(), in.get(), 0, options, nullptr, nullptr));
  EXPECT_NE(out, nullptr);
  return file;
}

// The file may contain units. Otherwise the values decide.
TEST(Raster, DegreesWithoutCrsAreNotTakenForMetres) {
  TestFolder folder;
  RasterTerrain terrain;
  const auto refused = [&](const char* what) {
    std::optional<LocalFrame> frame;
    EXPECT_THAT([&] { read_raster(terrain, frame); },
                ThrowsMessage<InputError>(AllOf(HasSubstr(what), HasSubstr("-a_srs EPSG:4326"))));
    EXPECT_THAT([&] { TerrainTiles(terrain, frame); },
                ThrowsMessage<InputError>(AllOf(HasSubstr(what), HasSubstr("-a_srs EPSG:4326"))));
  };
  // A coast in cells of a degree.
  terrain.file = folder.write("coast.asc",
                              "ncols 6\nnrows 5\nxllcorner -6\nyllcorner 47\ncellsize 1\n"
                              "0 -40 -90 -110 -60 -5\n-4000 -4500 -120 -90 -50 -20\n-4800 -4700 -4000 -100 "
                              "-60 -30\n-4900 -4800 -4600 -130 -80 -40\n-5000 -4900 -4800 -2000 -60 0\n");
  refused("5 x 4 m would be 5e+03 m high");
  // Steps of a metre in a tank are metres.
  terrain.file =
      folder.write("tank.asc", "ncols 3\nnrows 2\nxllcorner 0\nyllcorner 0\ncellsize 1\n0 1 2\n3 4 9\n");
  std::optional<LocalFrame> frame;
  EXPECT_THAT(read_raster(terrain, frame).warnings, ElementsAre(HasSubstr("metres in the local frame")));

  GDALAllRegister();
  terrain.file = folder.path() / "degrees.nc";
  {
    const GDALDatasetUniquePtr out(GetGDALDriverManager()->GetDriverByName("netCDF")->Create(
        terrain.file.c_str(), 4, 3, 1, GDT_Float32, nullptr));
    OGRSpatialReference crs;
    crs.SetFromUserInput("EPSG:4326");
    out->SetSpatialRef(&crs);
    std::array<double, 6> transform{1, 0.5, 0, 51, 0, -0.5};
    out->SetGeoTransform(transform.data());
    std::vector<float> flat(12, 1);
    EXPECT_EQ(
        out->GetRasterBand(1)->RasterIO(GF_Write, 0, 0, 4, 3, flat.data(), 4, 3, GDT_Float32, 0, 0, nullptr),
        CE_None);
  }
  // Its coordinates have the unit degrees_north. The test removes the datum from the file.
  int id = 0, count = 0;
  nc_open(terrain.file.c_str(), NC_WRITE, &id);
  nc_inq_nvars(id, &count);
  nc_redef(id);
  for (int variable = 0; variable < count; ++variable) nc_del_att(id, variable, "grid_mapping");
  nc_close(id);
  refused("its coordinates are in degrees");
}

/// z(y, x) as netCDF-C writes it, with optional coordinates without attributes.
std::filesystem::path write_netcdf(const TestFolder& folder, bool coordinates, bool north_first,
                                   bool turned_over = false, double bend = 0) {
  constexpr std::size_t rows = 3, columns = 4;
  const std::filesystem::path file = folder.path() / "bed.nc";
  int id = 0, y = 0, x = 0, z = 0, ys = 0, xs = 0;
  EXPECT_EQ(nc_create(file.c_str(), NC_CLOBBER, &id), NC_NOERR);
  nc_def_dim(id, "y", rows, &y);
  nc_def_dim(id, "x", columns, &x);
  if (coordinates) {
    nc_def_var(id, "y", NC_DOUBLE, 1, &y, &ys);
    nc_def_var(id, "x", NC_DOUBLE, 1, &x, &xs);
  }
  const int dimensions[] = {turned_over ? x : y, turned_over ? y : x};
  nc_def_var(id, "z", NC_DOUBLE, 2, dimensions, &z);
  nc_enddef(id);
  std::vector<double> heights(rows * columns);
  for (std::size_t row = 0; row < rows; ++row) {
    const std::size_t from_south = north_first ? rows - 1 - row : row;
    const double north = 100 + 2 * static_cast<double>(from_south) + (row == 1 ? bend : 0);
    if (coordinates) {
      EXPECT_EQ(nc_put_var1_double(id, ys, &row, &north), NC_NOERR);
    }
    for (std::size_t column = 0; column < columns; ++column)
      heights[turned_over ? column * rows + row : row * columns + column] =
          -10 * static_cast<double>(from_south) - static_cast<double>(column);
  }
  for (std::size_t column = 0; column < columns && coordinates; ++column) {
    const double east = 10 + 2 * static_cast<double>(column);
    EXPECT_EQ(nc_put_var1_double(id, xs, &column, &east), NC_NOERR);
  }
  EXPECT_EQ(nc_put_var_double(id, z, heights.data()), NC_NOERR);
  nc_close(id);
  return file;
}

TEST(Raster, LiesByTheCoordinatesOfANetcdfFileInEitherOrderOfRows) {
  for (const bool north_first : {false, true}) {
    TestFolder folder;
    RasterTerrain terrain;
    terrain.file = write_netcdf(folder, true, north_first);
    std::optional<LocalFrame> frame;
    const ComponentMesh mesh = read_raster(terrain, frame);
    ASSERT_EQ(mesh.points_m.size(), 12u);
    for (const glm::dvec3& p : mesh.points_m)
      EXPECT_DOUBLE_EQ(p.z, -5 * (p.y - 100) - (p.x - 10) / 2) << p.x << " " << p.y;
  }
}

TEST(Raster, RefusesNetcdfThatDoesNotSayWhereItLies) {
  TestFolder folder;
  RasterTerrain terrain;
  std::optional<LocalFrame> frame;
  const auto refused = [&](const char* what) {
    EXPECT_THAT([&] { read_raster(terrain, frame); }, ThrowsMessage<InputError>(HasSubstr(what)));
  };
  terrain.file = write_netcdf(folder, false, false);
  refused("--config GDAL_NETCDF_BOTTOMUP NO -a_ullr WEST NORTH EAST SOUTH");
  terrain.file = write_netcdf(folder, true, false, true);
  refused("its rows run along y");
  terrain.file = write_netcdf(folder, true, false, false, 0.5);
  refused("its coordinates 'y' are not evenly spaced");
}

// For any use: a red channel is no height, no reflectivity and no class.
TEST(Raster, PicturesInColoursAreRefused) {
  TestFolder folder;
  GDALAllRegister();
  RasterTerrain terrain;
  for (const auto& [driver, name, bands] : {std::tuple{"GTiff", "rgb.tif", 3}, {"GTiff", "rgba.tif", 4}}) {
    terrain.file = folder.path() / name;
    char** options = CSLSetNameValue(nullptr, "PHOTOMETRIC", "RGB");
    const GDALDatasetUniquePtr out(GetGDALDriverManager()->GetDriverByName(driver)->Create(
        terrain.file.c_str(), 4, 3, bands, GDT_Byte, options));
    CSLDestroy(options);
    std::array<double, 6> transform{0, 1, 0, 3, 0, -1};
    out->SetGeoTransform(transform.data());
    out->FlushCache();
    std::optional<LocalFrame> frame;
    EXPECT_THAT([&] { read_raster(terrain, frame); },
                ThrowsMessage<InputError>(AllOf(HasSubstr("colour picture, and colours are not heights"))));
    MaterialDescription sand;
    MapReflectivityKeys map;
    map.file = terrain.file;
    map.tile_m = {4, 3};
    sand.reflectivity.push_back({{}, map});
    std::vector<std::string> warnings;
    EXPECT_THAT(
        [&] { load_reflectivity(sand, LocalFrame{}, warnings); },
        ThrowsMessage<InputError>(AllOf(HasSubstr("colour picture, and colours are not reflectivities"))));
  }
}

class RasterFormat : public testing::TestWithParam<std::pair<std::string, std::string>> {};

TEST_P(RasterFormat, IsReadWholeAndRefusedWhenCutOff) {
  const TestFolder folder;
  const auto file = copy_as(folder, GetParam().first.c_str(), GetParam().second.c_str());
  std::optional<LocalFrame> frame = utm_frame();
  const ComponentMesh mesh = read_raster({file, {}, 1, false}, frame);
  ASSERT_THAT(mesh.points_m, SizeIs(3600));
  EXPECT_LE(glm::distance(mesh.points_m[61], glm::dvec3(3, -3, 11)), 1e-5);

  std::ifstream in(file, std::ios::binary);
  const std::string content((std::istreambuf_iterator<char>(in)), {});
  for (const std::size_t size : {std::size_t{0}, std::size_t{3}, std::size_t{50}, content.size() / 4,
                                 content.size() / 2, content.size() * 9 / 10}) {
    std::ofstream(file, std::ios::binary | std::ios::trunc) << content.substr(0, size);
    testing::internal::CaptureStderr();
    EXPECT_THAT(
        [&] {
          read_raster({file, {}, 1, false}, frame);
        },
        ThrowsMessage<InputError>(HasSubstr(GetParam().second + ": ")))
        << size << " of " << content.size() << " bytes";
    EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
  }
}

INSTANTIATE_TEST_SUITE_P(Gdal, RasterFormat,
                         testing::Values(std::pair{"GTiff", "cut.tif"}, std::pair{"AAIGrid", "cut.asc"},
                                         std::pair{"netCDF", "cut.nc"}, std::pair{"BAG", "cut.bag"}),
                         [](const auto& format) { return format.param.first; });

TEST(RasterFormats, OthersAreRefusedWithTheOnesThatAreRead) {
  const TestFolder folder;
  const auto file = folder.write("picture.png", "\x89PNG\r\n");
  std::optional<LocalFrame> frame;
  EXPECT_THAT(
      [&] {
        read_raster({file, {}, 1, false}, frame);
      },
      ThrowsMessage<InputError>(AllOf(HasSubstr("picture.png: "), HasSubstr("GeoTIFF, BAG, ESRI ASCII"))));
}

TEST(NetcdfClassicSize, IsThatOfTheFileForEveryVariant) {
  const TestFolder folder;
  for (const char* format : {"FORMAT=NC", "FORMAT=NC2"}) {
    char* options[] = {const_cast<char*>(format), nullptr};
    const auto file = copy_as(folder, "netCDF", "classic.nc", options);
    const auto size = netcdf_classic_size(file);
    ASSERT_TRUE(size) << format;
    EXPECT_EQ(*size, std::filesystem::file_size(file)) << format;
  }
  EXPECT_FALSE(netcdf_classic_size(folder.write("no.nc", "\x89HDF")));
  EXPECT_GT(netcdf_classic_size(folder.write("cut.nc", std::string("CDF\1\0\0\0\0\0\0\0\12\0\0\0\2", 16))),
            1u << 30);
}

TEST(RealRaster, TheWholeGridLoadsWithItsHoles) {
  const std::filesystem::path file = TUBEFOOT_SOURCE_DIR "/scenes/data/jd211.bag";
  testing::internal::CaptureStderr();
  std::optional<LocalFrame> frame;
  const ComponentMesh mesh = read_raster({file, {}, 1, false}, frame);
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
  // 45.9 % of 1707 x 1478 cells are valid.
  EXPECT_NEAR(static_cast<double>(mesh.points_m.size()) / (1707.0 * 1478.0), 0.459, 0.001);
  EXPECT_LE(mesh.triangles.size(), 2 * mesh.points_m.size());
  for (const glm::dvec3& p : mesh.points_m) ASSERT_TRUE(p.z > -52.97 && p.z < -50.98) << p.z;
}

TEST(RealRaster, ACutOffBagIsRefusedQuietly) {
  const std::filesystem::path source = TUBEFOOT_SOURCE_DIR "/scenes/data/jd211.bag";
  const TestFolder folder;
  const auto file = folder.path() / "cut.bag";
  std::filesystem::copy_file(source, file);
  std::filesystem::permissions(file, std::filesystem::perms::owner_all);
  std::filesystem::resize_file(file, 1000000);
  testing::internal::CaptureStderr();
  std::optional<LocalFrame> frame;
  EXPECT_THAT(
      [&] {
        read_raster({file, {}, 1, false}, frame);
      },
      ThrowsMessage<InputError>(AllOf(HasSubstr("cut.bag: "), HasSubstr("cut off or damaged"))));
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

}  // namespace
}  // namespace tubefoot
