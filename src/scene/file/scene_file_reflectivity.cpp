// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/scattering/perlin_reflectivity.hpp"
#include "scene/file/scene_file_ranges.hpp"
#include "scene/file/scene_file_sections.hpp"

namespace tubefoot {

const TomlSection<ReflectivityDescription>& reflectivity_section() {
  using Perlin = PerlinReflectivityKeys;
  using Map = MapReflectivityKeys;
  // 1 / PerlinLattice::largest, rounded down.
  constexpr ValueRange depth{.lo = 0, .hi = 0.9649, .if_above = "a bed cannot scatter less than nothing"};
  static const auto section =
      TomlSection<ReflectivityDescription>("[[materials.reflectivity]]")
          .kind<Perlin>("kind", "perlin",
                        {field("wavelength_m", &Perlin::wavelength_m, {.ranges = {size}}),
                         field("octaves", &Perlin::octaves,
                               {.ranges = {{.lo = 1, .hi = PerlinReflectivity::most_octaves}}}),
                         field("persistence", &Perlin::persistence, {.ranges = {{.lo = 0, .hi = 1}}}),
                         field("depth", &Perlin::depth, {.ranges = {depth}}),
                         field("seed", &Perlin::seed, {.ranges = {not_negative}})})
          .kind<Map>("kind", "map",
                     {field("file", &Map::file, {.required = true}),
                      field("values", &Map::values, {.choices = {"factor", "db"}}),
                      field("tile_m", &Map::tile_m, {.ranges = {size}})});
  return section;
}

}  // namespace tubefoot
