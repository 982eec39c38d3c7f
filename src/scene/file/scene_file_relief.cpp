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
             "say how rough the surface is");
  one_of_two(fractal->rms_height_m.has_value(), fractal->spectral_strength_cm4.has_value(), "rms_height_m",
             "spectral_strength_cm4", "say how high the surface is");
}

}  // namespace

const TomlSection<ReliefDescription>& relief_section() {
  using R = ReliefDescription;
  using F = FractalReliefDescription;
  using P = RippleReliefDescription;
  using M = MapReliefDescription;
  const std::vector<TomlField<R>> tile{
      field("tile_m", &R::tile_m, {.ranges = {size}, .required = true}),
      field("resolution_m", &R::resolution_m, {.ranges = {size}, .required = true}),
      field("seed", &R::seed, {.ranges = {not_negative}})};
  constexpr ValueRange hurst{.lo = 0, .hi = 1};
  static const auto section =
      TomlSection<R>("[[materials.relief]]")
          .kind<F>(
              "kind", "fbm",
              {field("hurst", &F::hurst, {.ranges = {hurst}}),
               field("spectral_exponent", &F::spectral_exponent, {.ranges = {{.lo = 2, .hi = 4}}}),
               field("rms_height_m", &F::rms_height_m, {.ranges = {height}}),
               field("spectral_strength_cm4", &F::spectral_strength_cm4, {.ranges = {{.lo = 0, .hi = 1e6}}})},
              tile)
          .kind<P>("kind", "ripples",
                   {field("wavelength_m", &P::wavelength_m, {.ranges = {size}, .required = true}),
                    field("direction_deg", &P::direction_deg, {.ranges = {heading}}),
                    field("rms_height_m", &P::rms_height_m, {.ranges = {height}, .required = true}),
                    field("hurst", &P::hurst, {.ranges = {hurst}})},
                   tile)
          .kind<M>(
              "kind", "map",
              {field("file", &M::file, {.required = true}), field("tile_m", &M::tile_m, {.ranges = {size}}),
               field("scale", &M::scale, {.ranges = {{.lo = -1000, .hi = 1000}}})})
          .check(check_relief);
  return section;
}

}  // namespace tubefoot
