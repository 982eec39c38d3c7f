// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/file/scene_file_ranges.hpp"
#include "scene/file/scene_file_sections.hpp"

// The section [relief] of a scene file.
namespace tubefoot {
namespace {

void check_refinement(const RefinementDescription& refinement, const TomlTable& table) {
  if (refinement.file && refinement.mode != "offline")
    throw InputError(table.place_of("file"),
                     "'file' holds a bed that is refined once: it needs mode = \"offline\"");
  if (refinement.mode != "online" && table.has("tolerance"))
    throw InputError(
        table.place_of("tolerance"),
        "'tolerance' says the fineness of the surface of each transmission: it needs mode = \"online\"");
}

}  // namespace

const TomlSection<RefinementDescription>& refinement_section() {
  using R = RefinementDescription;
  static const auto section = TomlSection<R>("[relief]")
                                  .keys({field("mode", &R::mode, {.choices = {"online", "offline", "off"}}),
                                         field("cell_m", &R::cell_m, {.ranges = {size}}),
                                         field("displace", &R::displace, {.choices = {"vertical", "normal"}}),
                                         field("tolerance", &R::tolerance, {.ranges = {{.lo = 0, .hi = 1}}}),
                                         field("file", &R::file)})
                                  .check(check_refinement);
  return section;
}

}  // namespace tubefoot
