// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/scattering/perlin_reflectivity.hpp"
#include "scene/file/scene_file_ranges.hpp"
#include "scene/file/scene_file_sections.hpp"

namespace tubefoot {

const TomlSection<ReflectivityDescription>& reflectivity_section() {
  using Perlin = PerlinReflectivityKeys;
  using Map = MapReflectivityKeys;
  // 1 / PerlinLattice::largest, rounded down.
  constexpr ValueRange depth{
      .lo = 0, .hi = 0.9649, .if_above = "with a larger depth, the factor could become negative"};
  static const auto section =
      TomlSection<ReflectivityDescription>(
          "[[materials.reflectivity]]",
          "Layer of the reflectivity texture of the preceding material: a factor with mean 1 that multiplies "
          "the scattered energy. The factors of all layers are multiplied.")
          .kind<Perlin>(
              "kind", "perlin", "Sum of octaves of improved Perlin noise.",
              {field("wavelength_m", &Perlin::wavelength_m,
                     {.meaning = "Cell size of the first octave, which has the longest wavelength.",
                      .ranges = {size}}),
               field(
                   "octaves", &Perlin::octaves,
                   {.meaning = "Number of octaves. Each octave has half the wavelength of the previous one.",
                    .ranges = {{.lo = 1, .hi = PerlinReflectivity::most_octaves}}}),
               field("persistence", &Perlin::persistence,
                     {.meaning = "Ratio of the amplitudes of successive octaves.",
                      .ranges = {{.lo = 0, .hi = 1}}}),
               field("depth", &Perlin::depth,
                     {.meaning = "Modulated share of the diffuse component. The factor is 1 + `depth` times "
                                 "the weighted mean of the octaves.",
                      .ranges = {depth}}),
               field("seed", &Perlin::seed,
                     {.meaning = "Seed of the texture. The same seed gives the same texture.",
                      .ranges = {not_negative}})})
          .kind<Map>(
              "kind", "map",
              "Band 1 of a raster, divided by its mean and interpolated bilinearly between pixel centres. "
              "Pixels without data have the mean value.",
              {field("file", &Map::file,
                     {.meaning = "Raster file: GeoTIFF, ESRI ASCII grid, BAG, netCDF or PNG.",
                      .required = true}),
               field("values", &Map::values,
                     {.meaning = "Content of a pixel. factor: the factor itself. db: 10 log10 of the factor.",
                      .choices = {"factor", "db"}}),
               field("tile_m", &Map::tile_m,
                     {.meaning =
                          "East and north extent of the raster as a tile that repeats from the origin of the "
                          "frame. Default: the georeference places the raster, with factor 1 outside.",
                      .ranges = {size}})});
  return section;
}

}  // namespace tubefoot
