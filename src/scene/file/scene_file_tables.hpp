// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "scene/description/material_map_description.hpp"
#include "scene/file/toml_reader.hpp"

// Keys of a scene file whose values are tables with names that the user chooses.
namespace tubefoot {

/// Throws InputError for a value that is not a table, and for a table without entries.
const toml::table& table_with_entries(const toml::node& node, const TomlKey& key, const TomlSource& source);

/// Returns a key whose value is a table. `read(entry, source, s)` reads the table.
template <class S, class Read>
TomlField<S> table_field(std::string_view name, KeyRule rule, Read read) {
  const TomlKey key = make_key(name, "table", "none", std::move(rule));
  return {key, [key, read](const toml::node& node, TomlSource& source, S& s) {
            read(table_with_entries(node, key, source), source, s);
          }};
}

/// Returns a key whose value is a table of materials by their names in another file.
template <class S>
TomlField<S> classes_field(std::string_view name, std::vector<MaterialClass> S::*classes, KeyRule rule = {}) {
  return table_field<S>(name, std::move(rule), [classes](const toml::table& table, TomlSource& source, S& s) {
    for (const TomlEntry& entry : entries_in_file_order(table, source)) {
      MaterialClass& c = (s.*classes).emplace_back();
      c.value = entry.key;
      c.place = source.place(*entry.node);
      read_value(*entry.node, make_key(entry.key, "text", "", {}), source, c.material);
    }
  });
}

/// Throws InputError at `place` if `name` is not a material of the scene.
void check_material_name(const std::string& name, const SourcePlace& place,
                         const std::vector<std::string>& materials);

}  // namespace tubefoot
