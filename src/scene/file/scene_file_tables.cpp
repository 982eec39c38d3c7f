// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/file/scene_file_tables.hpp"

#include <toml++/toml.h>

#include <algorithm>

#include "files/words.hpp"

namespace tubefoot {

const toml::table& table_with_entries(const toml::node& node, const TomlKey& key, const TomlSource& source) {
  const toml::table* table = node.as_table();
  if (table == nullptr || table->empty())
    throw InputError(source.place(node), fmt::format("'{}' must be a table{}", key.name,
                                                     table == nullptr ? "" : " with at least one entry"));
  return *table;
}

void check_material_name(const std::string& name, const SourcePlace& place,
                         const std::vector<std::string>& materials) {
  if (std::ranges::find(materials, name) != materials.end()) return;
  const std::string_view meant = nearest(name, materials);
  throw InputError(place, fmt::format("no entry of [[materials]] is named \"{}\": {}", name,
                                      meant.empty() ? "expected " + one_of(materials, '"')
                                                    : fmt::format("did you mean \"{}\"?", meant)));
}

}  // namespace tubefoot
