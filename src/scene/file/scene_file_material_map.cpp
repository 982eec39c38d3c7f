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
      "shares", {.required = true}, [](const toml::table& table, TomlSource& source, PatchMaterialMap& map) {
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
      throw InputError(c.place,
                       fmt::format("'classes' of a raster are whole numbers, like 3 = \"{}\", not '{}'",
                                   c.material, c.value));
    if (!taken.insert(value).second)
      throw InputError(c.place, fmt::format("the class {} has a material already", value));
  }
}

}  // namespace

const TomlSection<MaterialMapDescription>& material_map_section() {
  using Raster = RasterMaterialMap;
  using Polygons = PolygonMaterialMap;
  using Patches = PatchMaterialMap;
  static const auto section =
      TomlSection<MaterialMapDescription>("[terrain.material_map]")
          .kind<Raster>("kind", "raster",
                        {field("file", &Raster::file, {.required = true}),
                         classes_field("classes", &Raster::classes, {.required = true}),
                         field("origin_m", &Raster::origin_m, {.ranges = {coordinate}}),
                         field("cell_m", &Raster::cell_m, {.ranges = {size}})})
          .kind<Polygons>(
              "kind", "polygons",
              {field("file", &Polygons::file, {.required = true}), field("layer", &Polygons::layer),
               field("attribute", &Polygons::attribute), classes_field("classes", &Polygons::classes),
               field("overlaps", &Polygons::overlaps, {.choices = {"last", "first"}}),
               field("coordinates", &Polygons::coordinates, {.choices = {"crs", "local"}})})
          .kind<Patches>("kind", "patches",
                         {field("patch_size_m", &Patches::patch_size_m, {.ranges = {size}, .required = true}),
                          shares_field(), field("seed", &Patches::seed, {.ranges = {not_negative}})})
          .check(check_map);
  return section;
}

TomlField<TerrainDescription> material_map_field() {
  return table_field<TerrainDescription>(
      "material_map", {}, [](const toml::table& table, TomlSource& source, TerrainDescription& terrain) {
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
