// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/file/scene_file_ranges.hpp"
#include "scene/file/scene_file_sections.hpp"

namespace tubefoot {
namespace {

void check_paths(const PathsDescription& paths, const TomlTable& table) {
  if (paths.scatterings > paths.order)
    throw InputError(table.place_of("scatterings"),
                     fmt::format("{} scatterings need {} interactions: increase 'order', which is {}",
                                 paths.scatterings, paths.scatterings, paths.order));
  if (!paths.only_order || (*paths.only_order <= paths.order && (*paths.only_order > 0 || paths.direct)))
    return;
  throw InputError(table.place_of("only_order"),
                   *paths.only_order == 0
                       ? "order 0 is the direct path from transmitter to receiver: add 'direct = true'"
                       : fmt::format("'only_order' selects paths of order {}, but 'order' permits only paths "
                                     "up to order {}: increase 'order'",
                                     *paths.only_order, paths.order));
}

}  // namespace

const TomlSection<SeaSurfaceDescription>& sea_surface_section() {
  using S = SeaSurfaceDescription;
  static const auto section =
      TomlSection<S>("[sea_surface]",
                     "Horizontal mirror above the scene. All sonars must be below this mirror. Without this "
                     "section, the sea surface reflects no sound.")
          .keys({field("height_m", &S::height_m,
                       {.meaning = "Height (z) of the sea surface.", .ranges = {coordinate}}),
                 field("loss_db", &S::loss_db,
                       {.meaning = "Loss per reflection.", .ranges = {{.lo = 0, .hi = 120}}}),
                 field("rms_roughness_m", &S::rms_roughness_m,
                       {.meaning =
                            "Standard deviation sigma of the surface height. In addition to the loss, "
                            "roughness multiplies the intensity by exp(-(2 k sigma sin(grazing angle))^2).",
                        .ranges = {{.lo = 0, .hi = 10}}})});
  return section;
}

const TomlSection<PathsDescription>& paths_section() {
  using P = PathsDescription;
  static const auto section =
      TomlSection<P>("[paths]",
                     "Paths with reflections and multiple scattering. The sea surface and materials with "
                     "`specular_loss_db` reflect sound.")
          .keys(
              {field("order", &P::order,
                     {.meaning = "Largest number of interactions (reflections and scatterings) along a path.",
                      .ranges = {{.lo = 1, .hi = 8}}}),
               field("only_order", &P::only_order,
                     {.meaning = "Write only the echoes of this order. 0: the direct path from transmitter "
                                 "to receiver.",
                      .ranges = {{.lo = 0, .hi = 8}}}),
               field("cutoff_db", &P::cutoff_db,
                     {.meaning = "Reflection loss above which paths are omitted. At each scattering, "
                                 "tubefoot also omits the weakest patches, whose total energy is at least "
                                 "this far below that of the first scattering.",
                      .ranges = {{.lo = 0, .hi = 300}}}),
               field("scatterings", &P::scatterings,
                     {.meaning = "Largest number of scatterings along a path. Values above 1 are slow, "
                                 "because tubefoot computes the visibility of the scene from each patch.",
                      .ranges = {{.lo = 1, .hi = 8}}}),
               field("patch_m", &P::patch_m,
                     {.meaning = "Longest edge of a radiosity patch, for multiple scattering.",
                      .ranges = {size}}),
               field("most_images", &P::most_images,
                     {.meaning =
                          "Largest number of image apexes per apex. The limit for pairs of image apexes is a "
                          "hundred times higher. If a limit is exceeded, the run ends with an error.",
                      .ranges = {{.lo = 1, .hi = 10000000}}}),
               field("direct", &P::direct,
                     {.meaning = "true: a separate receiver also receives sound along the direct path from "
                                 "the transmitter."})})
          .check(check_paths);
  return section;
}

}  // namespace tubefoot
