// SPDX-License-Identifier: GPL-3.0-or-later
// Tests reflectivity textures (micro-texture) in scene files: keys, noise and maps after loading, and
// rejected values.
#include <gdal_priv.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "engine/scattering/perlin_reflectivity.hpp"
#include "fixtures/world/read_scenes.hpp"
#include "scene/scene.hpp"
#include "scene/surfaces/reflectivity.hpp"

namespace tubefoot {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::ThrowsMessage;

/// The smallest scene with more lines below the name of its material.
std::string with_texture(std::string_view lines) {
  return replaced(smallest_scene, "name = \"sand\"\n", "name = \"sand\"\n" + std::string(lines));
}

TEST(ReflectivityKeys, AreReadLayerByLayer) {
  const TestFolder folder;
  folder.write("map.asc", "grid");
  const SceneDescription scene = read_scene(folder, with_texture(R"([[materials.reflectivity]]
kind = "perlin"
wavelength_m = 0.8
octaves = 5
persistence = 0.7
depth = 0.3
seed = 12
[[materials.reflectivity]]
kind = "map"
file = "map.asc"
values = "db"
tile_m = [4, 2.5]
)"));
  const auto& layers = scene.materials.at(0).reflectivity;
  ASSERT_EQ(layers.size(), 2u);
  const auto& noise = std::get<PerlinReflectivityKeys>(layers[0].kind);
  EXPECT_EQ(noise.wavelength_m, 0.8);
  EXPECT_EQ(noise.octaves, 5);
  EXPECT_EQ(noise.persistence, 0.7);
  EXPECT_EQ(noise.depth, 0.3);
  EXPECT_EQ(noise.seed, 12u);
  const auto& map = std::get<MapReflectivityKeys>(layers[1].kind);
  EXPECT_EQ(map.file, folder.path() / "map.asc");
  EXPECT_EQ(map.values, "db");
  EXPECT_EQ(map.tile_m, (std::array{4.0, 2.5}));
  EXPECT_EQ(layers[1].place.line, 10u);
}

TEST(ReflectivityKeys, AreRefusedWithTheirPlace) {
  const TestFolder folder;
  const auto error = [&](const std::string& lines) {
    return scene_error(folder, with_texture("[[materials.reflectivity]]\nkind = \"perlin\"\n" + lines));
  };
  EXPECT_THAT(error("depth = 0.97\n"),
              AllOf(HasSubstr("scene.toml:5:"), HasSubstr("the factor could become negative")));
  EXPECT_THAT(error("depth = -0.1\n"), HasSubstr("scene.toml:5:"));
  EXPECT_THAT(error("octaves = 0\n"), HasSubstr("1 to 16"));
  EXPECT_THAT(error("octaves = 17\n"), HasSubstr("1 to 16"));
  EXPECT_THAT(error("wavelength_m = 0\n"), HasSubstr("scene.toml:5:"));
  EXPECT_THAT(error("persistence = 1.5\n"), HasSubstr("0 to 1"));
  EXPECT_THAT(error("wavelength = 1\n"), HasSubstr("wavelength_m"));
  EXPECT_THAT(error("tile_m = [1, 1]\n"), HasSubstr("map"));
  EXPECT_THAT(scene_error(folder, with_texture("reflectivity = 3\n")),
              AllOf(HasSubstr("scene.toml:3:"), HasSubstr("[[materials.reflectivity]]")));
  EXPECT_THAT(scene_error(folder, with_texture("reflectivity = [1]\n")), HasSubstr("expected tables"));
  EXPECT_THAT(scene_error(folder, with_texture("[[materials.reflectivity]]\nkind = \"map\"\n")),
              HasSubstr("file"));
}

struct Raster {
  int columns = 2, rows = 2;
  std::vector<double> values{1, 2, 3, 6};
  const char* crs = nullptr;
  bool placed = true;
  std::array<double, 6> geotransform{10, 0.5, 0, 20, 0, -0.25};
};

std::filesystem::path write(const TestFolder& folder, const Raster& raster, const char* name = "map.tif") {
  GDALAllRegister();
  const auto file = folder.path() / name;
  const GDALDatasetUniquePtr out(GetGDALDriverManager()->GetDriverByName("GTiff")->Create(
      file.c_str(), raster.columns, raster.rows, 1, GDT_Float64, nullptr));
  std::array<double, 6> geotransform = raster.geotransform;
  if (raster.placed) out->SetGeoTransform(geotransform.data());
  if (raster.crs != nullptr) {
    OGRSpatialReference crs;
    crs.SetFromUserInput(raster.crs);
    out->SetSpatialRef(&crs);
  }
  std::vector<double> values = raster.values;
  out->GetRasterBand(1)->SetNoDataValue(-99);
  EXPECT_EQ(out->GetRasterBand(1)->RasterIO(GF_Write, 0, 0, raster.columns, raster.rows, values.data(),
                                            raster.columns, raster.rows, GDT_Float64, 0, 0, nullptr),
            CE_None);
  return file;
}

MapReflectivityKeys keys_of(const std::filesystem::path& file, const std::string& values = "factor",
                            std::optional<std::array<double, 2>> tile_m = {}) {
  return {file, values, tile_m};
}

std::shared_ptr<const ReflectivityField> load(const std::vector<MapReflectivityKeys>& maps,
                                              const LocalFrame& frame = {}) {
  MaterialDescription material;
  material.name = "sand";
  for (const MapReflectivityKeys& map : maps) material.reflectivity.push_back({{"scene.toml", 7, 1}, map});
  std::vector<std::string> warnings;
  return load_reflectivity(material, frame, warnings);
}

TEST(ReflectivityMap, LiesWhereItsGeotransformSays) {
  const TestFolder folder;
  const auto map = load({keys_of(write(folder, {}))});
  // Centres of pixels: north-west 10.25, 19.875.
  EXPECT_NEAR(map->factor({10.25, 19.875, 3}), 1.0 / 3, 1e-6);
  EXPECT_NEAR(map->factor({10.75, 19.875, 3}), 2.0 / 3, 1e-6);
  EXPECT_NEAR(map->factor({10.25, 19.625, 3}), 1, 1e-6);
  EXPECT_NEAR(map->factor({10.75, 19.625, 3}), 2, 1e-6);
  EXPECT_EQ(map->factor({12, 19, 0}), 1);
}

TEST(ReflectivityMap, OfDecibelsAndWithoutData) {
  const TestFolder folder;
  const auto map = load({keys_of(write(folder, {.values = {0, 10, -99, 10}}), "db")});
  EXPECT_NEAR(map->factor({10.25, 19.875, 0}), 1.0 / 7, 1e-6);
  EXPECT_NEAR(map->factor({10.75, 19.875, 0}), 10.0 / 7, 1e-6);
  EXPECT_NEAR(map->factor({10.25, 19.625, 0}), 1, 1e-6);
}

TEST(ReflectivityMap, TilesAreNorthUpFromTheFramesOrigin) {
  const TestFolder folder;
  const auto map = load({keys_of(write(folder, {.placed = false}), "factor", std::array{4.0, 2.0})});
  for (const glm::dvec3 away : {glm::dvec3{0, 0, 0}, {4, 0, 0}, {-40, 22, 5}}) {
    EXPECT_NEAR(map->factor(glm::dvec3{1, 1.5, 0} + away), 1.0 / 3, 1e-6);  // north-west
    EXPECT_NEAR(map->factor(glm::dvec3{3, 0.5, 0} + away), 2, 1e-6);        // south-east
  }
}

TEST(ReflectivityMap, OfAProjectionIsCarriedIntoTheFrame) {
  const TestFolder folder;
  const Raster utm{.crs = "EPSG:32602", .geotransform = {573000, 2, 0, 6012345, 0, -2}};
  const LocalFrame same = LocalFrame::projected("EPSG:32602", 573000, 6012345, 0, {});
  const auto map = load({keys_of(write(folder, utm))}, same);
  EXPECT_NEAR(map->factor({1, -1, 0}), 1.0 / 3, 1e-6);
  EXPECT_NEAR(map->factor({3, -3, 0}), 2, 1e-6);
  // In a frame of geographic north the map is rotated.
  const LocalFrame tangent = LocalFrame::at_lat_lon(54.2, -170, 0);
  std::vector<glm::dvec3> centre{{573001, 6012344, 0}};
  tangent.carry(centre, "EPSG:32602", {});
  EXPECT_NEAR(load({keys_of(write(folder, utm))}, tangent)->factor(centre[0]), 1.0 / 3, 1e-4);
}

TEST(ReflectivityMap, IsRefusedWithItsFilesName) {
  const TestFolder folder;
  const auto expect = [&](const MapReflectivityKeys& keys, const LocalFrame& frame, const char* what) {
    EXPECT_THAT([&] { load({keys}, frame); },
                ThrowsMessage<InputError>(AllOf(HasSubstr("map.tif"), HasSubstr(what))));
  };
  const LocalFrame frame = LocalFrame::at_lat_lon(54.2, -170, 0);
  expect(keys_of(write(folder, {.placed = false})), {}, "tile_m");
  expect(keys_of(write(folder, {.crs = "EPSG:32602"})), {}, "[georeference]");
  expect(keys_of(write(folder, {})), frame, "coordinate reference system");
  expect(keys_of(write(folder, {.values = {1, 2, -1, 3}})), {}, "negative");
  expect(keys_of(write(folder, {.values = {0, 0, 0, 0}})), {}, "above 0");
  // The pixels are in metres, but the map covers 200 km: the curvature of the Earth is not negligible.
  expect(keys_of(write(folder, {.crs = "EPSG:32602", .geotransform = {473000, 1e5, 0, 6112345, 0, -1}})),
         frame, "parallelogram");
  folder.write("map.tif", "II*");
  expect(keys_of(folder.path() / "map.tif"), {}, "cannot be read");
  const MapReflectivityKeys map = keys_of(write(folder, {}));
  EXPECT_THAT(
      [&] {
        load({map, map});
      },
      ThrowsMessage<InputError>(AllOf(HasSubstr("scene.toml:7:1"), HasSubstr("second map"))));
}

TEST(ReflectivityLayers, OfOneSeedDiffer) {
  MaterialDescription material;
  std::vector<std::string> warnings;
  EXPECT_EQ(load_reflectivity(material, {}, warnings), nullptr);
  const PerlinReflectivityKeys keys{.wavelength_m = 0.7, .octaves = 2, .seed = 5};
  material.reflectivity = {{{}, keys}};
  const auto one = load_reflectivity(material, {}, warnings);
  material.reflectivity.push_back({{}, keys});
  const auto two = load_reflectivity(material, {}, warnings);
  const glm::dvec3 place{0.31, 0.52, -0.23};
  EXPECT_NEAR(one->factor(place),
              PerlinReflectivity({.wavelength_m = 0.7, .octaves = 2, .seed = 5}).factor(place), 1e-15);
  EXPECT_GT(std::abs(two->factor(place) - one->factor(place) * one->factor(place)), 1e-3);
}

TEST(ReflectivityLayers, BelongToTheirMaterial) {
  const TestFolder folder;
  const std::string text =
      with_texture("[[materials.reflectivity]]\nkind = \"perlin\"\n[[materials]]\nname = \"mud\"\n");
  const Scene scene = load_scene(
      read_scene(folder, replaced(text, "kind = \"flat\"\n", "kind = \"flat\"\nmaterial = \"sand\"\n")));
  ASSERT_EQ(scene.reflectivity.size(), 2u);
  EXPECT_NE(scene.reflectivity[0], nullptr);
  EXPECT_EQ(scene.reflectivity[1], nullptr);
}

}  // namespace
}  // namespace tubefoot
