// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/file/scene_file_tables.hpp"

#include <algorithm>

#include "scene/file/scene_file_words.hpp"

namespace tubefoot {

void check_material_name(const std::string& name, const SourcePlace& place,
                         const std::vector<std::string>& materials) {
  if (std::ranges::find(materials, name) != materials.end()) return;
  const std::string_view meant = nearest(name, materials);
  throw InputError(place, fmt::format("no entry of [[materials]] is named \"{}\": {}", name,
                                      meant.empty() ? "expected " + one_of(materials, '"')
                                                    : fmt::format("did you mean \"{}\"?", meant)));
}

}  // namespace tubefoot
