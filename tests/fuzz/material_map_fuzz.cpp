// SPDX-License-Identifier: GPL-3.0-or-later
// Fuzzes material maps: rasters of classes and polygons over a small seabed. GDAL itself is not under test
// (validation/fuzzing.md).
#include <array>
#include <cmath>

#include "frame_on_earth.hpp"
#include "fuzz.hpp"
#include "gdal_is_quiet.hpp"
#include "named_file.hpp"
#include "scene/rasters/terrain.hpp"
#include "scene/surfaces/material_map.hpp"

namespace tubefoot::fuzz {
namespace {

std::vector<MaterialDescription> three_materials() {
  std::vector<MaterialDescription> materials(3);
  materials[0].name = "mud";
  materials[1].name = "sand";
  materials[2].name = "rock";
  return materials;
}

double plan_area(const ComponentMesh& mesh) {
  double twice = 0;
  for (const auto& [a, b, c] : mesh.triangles) {
    const glm::dvec3 u = mesh.points_m.at(b) - mesh.points_m.at(a),
                     v = mesh.points_m.at(c) - mesh.points_m.at(a);
    twice += u.x * v.y - u.y * v.x;
  }
  return twice / 2;
}

RasterMaterialMap raster(const std::filesystem::path& file, std::uint8_t options) {
  RasterMaterialMap map;
  map.file = file;
  const SourcePlace place{"scene.toml", 3, 1};
  map.classes = {{"0", "mud", place}, {"1", "sand", place}, {"2", "rock", place}, {"255", "mud", place}};
  if ((options & 2) != 0) {
    map.origin_m = {-8, -12.5};
    map.cell_m = 2;
  }
  return map;
}

PolygonMaterialMap polygons(const std::filesystem::path& file, std::uint8_t options) {
  PolygonMaterialMap map;
  map.file = file;
  if ((options & 2) != 0) map.overlaps = "first";
  if ((options & 4) != 0) map.coordinates = "local";
  if ((options & 8) != 0)
    map.classes = {{"S", "sand", {"scene.toml", 3, 1}}, {"R", "rock", {"scene.toml", 4, 1}}};
  return map;
}

}  // namespace
}  // namespace tubefoot::fuzz

/// A byte each for the format and its options, then the file. For a Shapefile: the lengths of .shp and .shx
/// in two bytes each, then .shp, .shx and .dbf.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace tubefoot;
  const fuzz::TimeLimit limit;
  const fuzz::NamedFile unopened;
  fuzz::Bytes bytes(data, size);
  constexpr std::array names{"m.geojson", "m.shp", "m.gpkg", "m.asc", "m.tif", "m.png"};
  const std::uint32_t format = bytes.below(names.size());
  const auto options = bytes.take<std::uint8_t>();
  TerrainDescription terrain;
  terrain.place.file = terrain.material_place.file = "scene.toml";
  terrain.material = "mud";
  std::filesystem::path file;
  if (format == 1) {
    const auto main = bytes.take<std::uint16_t>(), index = bytes.take<std::uint16_t>();
    file = fuzz::scratch_file("m.shp", bytes.text(main));
    fuzz::scratch_file("m.shx", bytes.text(index));
    fuzz::scratch_file("m.dbf", bytes.rest());
  } else {
    file = fuzz::scratch_file(names[format], bytes.rest());
  }
  terrain.material_map.emplace();
  terrain.material_map->place = {"scene.toml", 2, 1};
  if (format < 3)
    terrain.material_map->kind = fuzz::polygons(file, options);
  else
    terrain.material_map->kind = fuzz::raster(file, options);

  static const std::vector<MaterialDescription> materials = fuzz::three_materials();
  static const ComponentMesh seabed = flat_facets({16, 25, {0, 0, -10}, 4}, {"scene.toml", 1, 1});
  fuzz::may_refuse([&] {
    ComponentMesh mesh = seabed;
    apply_material_map(mesh, terrain, materials, (options & 1) != 0 ? fuzz::frame_on_earth() : LocalFrame());
    if (mesh.materials.size() != mesh.triangles.size()) fuzz::finding("a facet without a material");
    for (const std::uint16_t m : mesh.materials)
      if (m >= materials.size()) fuzz::finding("a material that there is not");
    // Cuts move points only by rounding.
    if (!(std::abs(fuzz::plan_area(mesh) - 16 * 25) < 1e-3)) fuzz::finding("the bed has another area");
  });
  return 0;
}
