// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/file/scene_file_ranges.hpp"
#include "scene/file/scene_file_sections.hpp"

namespace tubefoot {
namespace {

void check_paths(const PathsDescription& paths, const TomlTable& table) {
  if (paths.scatterings > paths.order)
    throw InputError(table.place_of("scatterings"),
                     fmt::format("{} scatterings are {} interactions: raise 'order', which is {}",
                                 paths.scatterings, paths.scatterings, paths.order));
  if (!paths.only_order || (*paths.only_order <= paths.order && (*paths.only_order > 0 || paths.direct)))
    return;
  throw InputError(
      table.place_of("only_order"),
      *paths.only_order == 0
          ? "order 0 is the way straight from transmitter to receiver: add 'direct = true'"
          : fmt::format("paths of order {} are wanted, but only those up to order {} are followed: "
                        "raise 'order'",
                        *paths.only_order, paths.order));
}

}  // namespace

const TomlSection<SeaSurfaceDescription>& sea_surface_section() {
  using S = SeaSurfaceDescription;
  static const auto section =
      TomlSection<S>("[sea_surface]")
          .keys({field("height_m", &S::height_m, {.ranges = {coordinate}}),
                 field("loss_db", &S::loss_db, {.ranges = {{.lo = 0, .hi = 120}}}),
                 field("rms_roughness_m", &S::rms_roughness_m, {.ranges = {{.lo = 0, .hi = 10}}})});
  return section;
}

const TomlSection<PathsDescription>& paths_section() {
  using P = PathsDescription;
  static const auto section =
      TomlSection<P>("[paths]")
          .keys({field("order", &P::order, {.ranges = {{.lo = 1, .hi = 8}}}),
                 field("only_order", &P::only_order, {.ranges = {{.lo = 0, .hi = 8}}}),
                 field("cutoff_db", &P::cutoff_db, {.ranges = {{.lo = 0, .hi = 300}}}),
                 field("scatterings", &P::scatterings, {.ranges = {{.lo = 1, .hi = 8}}}),
                 field("patch_m", &P::patch_m, {.ranges = {size}}),
                 field("most_images", &P::most_images, {.ranges = {{.lo = 1, .hi = 10000000}}}),
                 field("direct", &P::direct)})
          .check(check_paths);
  return section;
}

}  // namespace tubefoot
