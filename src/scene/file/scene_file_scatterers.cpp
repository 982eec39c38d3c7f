// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/file/scene_file_ranges.hpp"
#include "scene/file/scene_file_sections.hpp"

// The section [scatterers] of a scene file.
namespace tubefoot {
namespace {

void check_scatterers(const ScatterersDescription& scatterers, const TomlTable& table) {
  for (const char* key : {"texture_shape", "texture_cell_m"})
    if (scatterers.texture == "none" && table.has(key))
      throw InputError(
          table.place_of(key),
          fmt::format(
              "'{}' applies only to a texture: add texture = \"gamma\" or \"log_normal\", or remove the key",
              key));
}

}  // namespace

const TomlSection<ScatterersDescription>& scatterers_section() {
  using S = ScatterersDescription;
  constexpr ValueRange spacing{.lo = 1e-4, .hi = 100}, shape{.lo = 0.01, .hi = 1000};
  static const auto section =
      TomlSection<S>("[scatterers]",
                     "Scatterers of scene-fixed speckle, for sensors of kind array. The `seed` of `[run]` "
                     "determines the scatterers.")
          .keys(
              {field("spacing_m", &S::spacing_m,
                     {.meaning = "Side of the square that one scatterer represents. With the default, E[I^2] "
                                 "/ E[I]^2 of the intensity I is 2 within 0.02.",
                      .ranges = {spacing},
                      .default_value = "computed for the arrays of the scene"}),
               field("texture", &S::texture,
                     {.meaning = "Distribution of the mean scatterer strength from cell to cell. gamma gives "
                                 "K-distributed amplitudes.",
                      .choices = {"none", "gamma", "log_normal"}}),
               field(
                   "texture_shape", &S::texture_shape,
                   {.meaning = "Inverse of the variance of the mean scatterer strength.", .ranges = {shape}}),
               field("texture_cell_m", &S::texture_cell_m,
                     {.meaning = "Side of the cubic cells in which the mean scatterer strength is constant.",
                      .ranges = {spacing}})})
          .check(check_scatterers);
  return section;
}

}  // namespace tubefoot
