// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/file/scene_file_ranges.hpp"
#include "scene/file/scene_file_sections.hpp"

// The section [relief] of a scene file.
namespace tubefoot {
namespace {

void check_refinement(const RefinementDescription& refinement, const TomlTable& table) {
  if (refinement.file && refinement.mode != "offline")
    throw InputError(table.place_of("file"),
                     "'file' contains a surface that is refined once: set mode = \"offline\"");
  if (refinement.mode != "online" && table.has("tolerance"))
    throw InputError(
        table.place_of("tolerance"),
        "'tolerance' sets the fineness of the surface of each transmission: set mode = \"online\"");
}

}  // namespace

const TomlSection<RefinementDescription>& refinement_section() {
  using R = RefinementDescription;
  static const auto section =
      TomlSection<R>("[relief]", "Refinement of facets with relief, for scenes whose materials have relief.")
          .keys(
              {field("mode", &R::mode,
                     {.meaning = "online: each transmission refines the facets that it insonifies. offline: "
                                 "all facets are refined when they are loaded. off: facets stay flat.",
                      .choices = {"online", "offline", "off"}}),
               field("cell_m", &R::cell_m,
                     {.meaning = "Length up to which edges are not subdivided. Default: the finest detail of "
                                 "any relief.",
                      .ranges = {size}}),
               field("displace", &R::displace,
                     {.meaning = "Direction of the heights. vertical: up. normal: along the normals of the "
                                 "vertices, interpolated over the facets.",
                      .choices = {"vertical", "normal"}}),
               field("tolerance", &R::tolerance,
                     {.meaning =
                          "online: estimated relative RMS error that coarser facets may cause per range bin. "
                          "0: full refinement. Default: 0.01, or the value of `tubefoot run --tolerance`.",
                      .ranges = {{.lo = 0, .hi = 1}}}),
               field("file", &R::file,
                     {.meaning = "offline: file with the refined surface of this scene from `tubefoot "
                                 "refine`. If the file exists, tubefoot reads it instead of refining the "
                                 "facets, and the file is part of the scene hash."})})
          .check(check_refinement);
  return section;
}

}  // namespace tubefoot
