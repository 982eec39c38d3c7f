// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/file/scene_file_ranges.hpp"
#include "scene/file/scene_file_sections.hpp"

// The section [[materials.relief]] of a scene file.
namespace tubefoot {
namespace {

void check_relief(const ReliefDescription& relief, const TomlTable& table) {
  const auto* fractal = std::get_if<FractalReliefDescription>(&relief.kind);
  if (fractal == nullptr) return;
  const auto one_of_two = [&table](bool first, bool second, const char* a, const char* b, const char* why) {
    if (first && second)
      throw InputError(place_of_pair(table, a, b),
                       fmt::format("'{}' and '{}' both {}: give only one of the two", a, b, why));
    if (!first && !second)
      throw InputError(table.place,
                       fmt::format("[[materials.relief]] with kind = \"fbm\" needs '{}' or '{}'", a, b));
  };
  one_of_two(fractal->hurst.has_value(), fractal->spectral_exponent.has_value(), "hurst", "spectral_exponent",
             "define the roughness of the surface");
  one_of_two(fractal->rms_height_m.has_value(), fractal->spectral_strength_cm4.has_value(), "rms_height_m",
             "spectral_strength_cm4", "define the height of the surface");
}

}  // namespace

const TomlSection<ReliefDescription>& relief_section() {
  using R = ReliefDescription;
  using F = FractalReliefDescription;
  using P = RippleReliefDescription;
  using M = MapReliefDescription;
  const std::vector<TomlField<R>> tile{
      field("tile_m", &R::tile_m,
            {.meaning = "Period of the surface towards east and north, and its longest wavelength. The "
                        "south-west corner of one tile is the origin of the frame.",
             .ranges = {size},
             .required = true}),
      field(
          "resolution_m", &R::resolution_m,
          {.meaning =
               "Largest spacing of the nodes of the surface. A tile has at most 16384 nodes along each side.",
           .ranges = {size},
           .required = true}),
      field("seed", &R::seed,
            {.meaning = "Seed of the surface. The same seed gives the same surface on every machine.",
             .ranges = {not_negative}})};
  constexpr ValueRange hurst{.lo = 0, .hi = 1};
  static const auto section =
      TomlSection<R>("[[materials.relief]]",
                     "Heights above the facets of the preceding material, as a function of position. The "
                     "heights of all entries are added.")
          .kind<F>("kind", "fbm",
                   "Fractional Brownian surface, which models rock, gravel or sand. Give either `hurst` or "
                   "`spectral_exponent`, and either `rms_height_m` or `spectral_strength_cm4`.",
                   {field("hurst", &F::hurst,
                          {.meaning = "Hurst exponent: rough near 0, smooth near 1.", .ranges = {hurst}}),
                    field("spectral_exponent", &F::spectral_exponent,
                          {.meaning = "Exponent gamma2 = 2 `hurst` + 2 of the APL-UW roughness spectrum w2 "
                                      "(K h0)^-gamma2 with h0 = 1 cm.",
                           .ranges = {{.lo = 2, .hi = 4}}}),
                    field("rms_height_m", &F::rms_height_m,
                          {.meaning = "Root mean square height of this tile.", .ranges = {height}}),
                    field("spectral_strength_cm4", &F::spectral_strength_cm4,
                          {.meaning =
                               "Spectral strength w2 of the APL-UW roughness spectrum, averaged over seeds.",
                           .ranges = {{.lo = 0, .hi = 1e6}}})},
                   tile)
          .kind<P>(
              "kind", "ripples", "Oriented ripples, computed by spectral translation.",
              {field("wavelength_m", &P::wavelength_m,
                     {.meaning = "Distance from crest to crest: at least 4 times `resolution_m` and at most "
                                 "a quarter of `tile_m`.",
                      .ranges = {size},
                      .required = true}),
               field("direction_deg", &P::direction_deg,
                     {.meaning = "Compass direction perpendicular to the crests, clockwise from north.",
                      .ranges = {heading}}),
               field("rms_height_m", &P::rms_height_m,
                     {.meaning = "Root mean square height of this tile.",
                      .ranges = {height},
                      .required = true}),
               field("hurst", &P::hurst,
                     {.meaning = "Concentration of the spectrum about the wavenumber of the ripples. Larger "
                                 "values give a narrower band.",
                      .ranges = {hurst}})},
              tile)
          .kind<M>(
              "kind", "map",
              "Measured heights above the facets, from band 1 of a raster. Cells without data have height 0.",
              {field("file", &M::file,
                     {.meaning = "Raster file of heights: GeoTIFF, BAG, ESRI ASCII grid or netCDF.",
                      .required = true}),
               field("tile_m", &M::tile_m,
                     {.meaning = "Width of a tile with square cells that repeats from the origin of the "
                                 "frame. Default: the georeference places the map, with height 0 outside.",
                      .ranges = {size}}),
               field("scale", &M::scale,
                     {.meaning = "Factor that multiplies the heights. Depths need a negative factor.",
                      .ranges = {{.lo = -1000, .hi = 1000}}})})
          .check(check_relief);
  return section;
}

}  // namespace tubefoot
