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
          fmt::format("'{}' is of a texture: add texture = \"gamma\" or \"log_normal\", or remove "
                      "the key",
                      key));
}

}  // namespace

const TomlSection<ScatterersDescription>& scatterers_section() {
  using S = ScatterersDescription;
  constexpr ValueRange spacing{.lo = 1e-4, .hi = 100}, shape{.lo = 0.01, .hi = 1000};
  static const auto section =
      TomlSection<S>("[scatterers]")
          .keys({field("spacing_m", &S::spacing_m,
                       {.ranges = {spacing},
                        .default_value = "computed from the speckle of the scene's arrays"}),
                 field("texture", &S::texture, {.choices = {"none", "gamma", "log_normal"}}),
                 field("texture_shape", &S::texture_shape, {.ranges = {shape}}),
                 field("texture_cell_m", &S::texture_cell_m, {.ranges = {spacing}})})
          .check(check_scatterers);
  return section;
}

}  // namespace tubefoot
