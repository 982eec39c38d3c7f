// SPDX-License-Identifier: GPL-3.0-or-later
#include <toml++/toml.h>

#include <algorithm>
#include <charconv>
#include <set>

#include "scene/file/scene_file_ranges.hpp"
#include "scene/file/scene_file_sections.hpp"
#include "scene/file/scene_file_tables.hpp"

namespace tubefoot {
namespace {

TomlField<PatchMaterialMap> shares_field() {
  return table_field<PatchMaterialMap>(
      "shares",
      {.meaning = "Materials and their relative shares of the patches, each above 0 and up to 1000000, for "
                  "example `{ sand = 2, mud = 1 }`.",
       .required = true},
      [](const toml::table& table, TomlSource& source, PatchMaterialMap& map) {
        constexpr ValueRange share{.lo = 0, .hi = 1e6, .lo_excluded = true};
        for (const auto& [name, node] :
             table) {  // sorted by name, because their order in the file has no meaning
          MaterialShare& s = map.shares.emplace_back();
          s.material = name.str();
          s.place = source.place(name.source());
          read_value(node, make_key(name.str(), "number", "", {.ranges = {share}}), source, s.share);
        }
      });
}

void check_map(const MaterialMapDescription& map, const TomlTable& table) {
  const auto* raster = std::get_if<RasterMaterialMap>(&map.kind);
  if (raster == nullptr) return;
  if (raster->origin_m.has_value() != raster->cell_m.has_value())
    throw InputError(place_of_pair(table, "origin_m", "cell_m"),
                     fmt::format("'origin_m' and 'cell_m' go together: add '{}'",
                                 raster->origin_m ? "cell_m" : "origin_m"));
  std::set<std::int64_t> taken;
  for (const MaterialClass& c : raster->classes) {
    std::int64_t value = 0;
    const char* const end = c.value.data() + c.value.size();
    const auto [rest, error] = std::from_chars(c.value.data(), end, value);
    if (error != std::errc() || rest != end)
      throw InputError(
          c.place,
          fmt::format("the values in 'classes' of a raster must be whole numbers, as in 3 = \"{}\", not '{}'",
                      c.material, c.value));
    if (!taken.insert(value).second)
      throw InputError(c.place, fmt::format("the class {} already has a material", value));
  }
}

}  // namespace

const TomlSection<MaterialMapDescription>& material_map_section() {
  using Raster = RasterMaterialMap;
  using Polygons = PolygonMaterialMap;
  using Patches = PatchMaterialMap;
  static const auto section =
      TomlSection<MaterialMapDescription>("[terrain.material_map]",
                                          "Materials of the preceding terrain as a function of position. "
                                          "Borders between materials cut the facets.")
          .kind<Raster>("kind", "raster",
                        "Raster of classes, north up, with at most 50 million cells. Cells without data have "
                        "the `material` of the terrain.",
                        {field("file", &Raster::file,
                               {.meaning = "Raster with one class per cell in band 1: GeoTIFF, ESRI ASCII "
                                           "grid, netCDF, BAG or PNG.",
                                .required = true}),
                         classes_field("classes", &Raster::classes,
                                       {.meaning = "Material of each integer value that occurs, for example "
                                                   "`{ 1 = \"mud\", 2 = \"gravel\" }`.",
                                        .required = true}),
                         field("origin_m", &Raster::origin_m,
                               {.meaning = "East and north coordinates of the south-west corner of the "
                                           "raster, instead of the georeference of the file. Needs `cell_m`.",
                                .ranges = {coordinate}}),
                         field("cell_m", &Raster::cell_m,
                               {.meaning = "Side of a cell. Needs `origin_m`.", .ranges = {size}})})
          .kind<Polygons>(
              "kind", "polygons",
              "Polygons from a file. Outside all polygons, the seabed has the `material` of the terrain.",
              {field("file", &Polygons::file,
                     {.meaning = "File with the polygons: GeoPackage, GeoJSON, or the `.shp` file of a "
                                 "Shapefile. Inner rings are holes.",
                      .required = true}),
               field("layer", &Polygons::layer,
                     {.meaning = "Name of the layer. Optional if the file has only one layer."}),
               field("attribute", &Polygons::attribute,
                     {.meaning = "Name of the attribute that contains the material of a polygon."}),
               classes_field(
                   "classes", &Polygons::classes,
                   {.meaning = "Material of each value of the attribute, for example `{ \"Silty sand\" = "
                               "\"sand\" }`. Default: the values are names of materials."}),
               field(
                   "overlaps", &Polygons::overlaps,
                   {.meaning =
                        "Polygon that applies where polygons overlap: the last or the first one in the file.",
                    .choices = {"last", "first"}}),
               field("coordinates", &Polygons::coordinates,
                     {.meaning = "crs: the coordinate reference system of the file applies. local: the "
                                 "coordinates are in metres in the local frame.",
                      .choices = {"crs", "local"}})})
          .kind<Patches>("kind", "patches", "Random polygonal patches of similar size.",
                         {field("patch_size_m", &Patches::patch_size_m,
                                {.meaning = "Side of the square with the average area of a patch. At most "
                                            "200000 patches, including those around the terrain.",
                                 .ranges = {size},
                                 .required = true}),
                          shares_field(),
                          field("seed", &Patches::seed,
                                {.meaning = "Seed of the patches. The same seed gives the same patches.",
                                 .ranges = {not_negative}})})
          .check(check_map);
  return section;
}

TomlField<TerrainDescription> material_map_field() {
  return table_field<TerrainDescription>(
      "material_map",
      {.meaning = "Materials as a function of position, in the section `[terrain.material_map]`. `material` "
                  "then applies to the rest of the terrain."},
      [](const toml::table& table, TomlSource& source, TerrainDescription& terrain) {
        const TomlTable map{&table, source.place(table.source()), &source};
        terrain.material_map = material_map_section().read(map, source);
      });
}

void check_materials(const MaterialMapDescription& map, const std::vector<std::string>& materials) {
  const auto check = [&materials](const auto& named) {
    for (const auto& entry : named) check_material_name(entry.material, entry.place, materials);
  };
  if (const auto* raster = std::get_if<RasterMaterialMap>(&map.kind)) check(raster->classes);
  if (const auto* polygons = std::get_if<PolygonMaterialMap>(&map.kind)) check(polygons->classes);
  if (const auto* patches = std::get_if<PatchMaterialMap>(&map.kind)) check(patches->shares);
}

}  // namespace tubefoot
