// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "scene/description/scene_description.hpp"
#include "scene/file/toml_reader.hpp"

// Keys of a scene file whose values are tables of names that the user chooses.
namespace tubefoot {

/// A key whose value is a table, which `read(entry, source, s)` reads.
template <class S, class Read>
TomlField<S> table_field(std::string_view name, KeyRule rule, Read read) {
  const TomlKey key = make_key(name, "table", "none", std::move(rule));
  return {key, [key, read](const toml::node& node, TomlSource& source, S& s) {
            const toml::table* table = node.as_table();
            if (table == nullptr || table->empty())
              throw InputError(source.place(node.source()),
                               fmt::format("'{}' must be a table{}", key.name,
                                           table == nullptr ? "" : " with at least one entry"));
            read(*table, source, s);
          }};
}

/// A table of materials by what another file calls them.
template <class S>
TomlField<S> classes_field(std::string_view name, std::vector<MaterialClass> S::*classes, KeyRule rule = {}) {
  return table_field<S>(name, std::move(rule), [classes](const toml::table& table, TomlSource& source, S& s) {
    for (const TomlEntry& entry : entries_in_file_order(table, source)) {
      MaterialClass& c = (s.*classes).emplace_back();
      c.value = entry.key;
      c.place = source.place(entry.node->source());
      read_value(*entry.node, make_key(entry.key, "text", "", {}), source, c.material);
    }
  });
}

/// Throws InputError at `place` if `name` is none of the scene's materials.
void check_material_name(const std::string& name, const SourcePlace& place,
                         const std::vector<std::string>& materials);

}  // namespace tubefoot
