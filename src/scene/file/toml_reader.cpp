// SPDX-License-Identifier: GPL-3.0-or-later

// Reads and checks values of a scene file: types, ranges, texts, files and arrays. Errors name the place
// and the expected value, and suggest the most similar key, unit or file.

#include "scene/file/toml_reader.hpp"

#include <fmt/ranges.h>
#include <toml++/toml.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <system_error>

#include "files/limits.hpp"
#include "files/words.hpp"
#include "scene/file/scene_file_words.hpp"

namespace tubefoot {
namespace {

namespace fs = std::filesystem;

/// Returns the type of a node in words: "a text", "an integer".
std::string type_in_words(const toml::node& node) {
  switch (node.type()) {
    case toml::node_type::string:
      return "a text";
    case toml::node_type::integer:
      return "an integer";
    case toml::node_type::floating_point:
      return "a number with a fraction";
    case toml::node_type::boolean:
      return "true or false";
    case toml::node_type::array:
      return "an array";
    case toml::node_type::table:
      return "a table";
    default:
      return "a date or time";
  }
}

std::vector<const toml::node*> elements_of(const toml::array& array) {
  std::vector<const toml::node*> elements;
  for (const toml::node& element : array) elements.push_back(&element);
  return elements;
}

[[noreturn]] void fail_type(const toml::node& node, const TomlKey& key, const TomlSource& source) {
  const bool text_for_number = node.is_string() && !key.unit.empty();
  const bool is_empty_array = node.is_array() && node.as_array()->empty();
  throw InputError(
      source.place(node.source()),
      fmt::format("'{}' must be {}, not {}{}", key.name, key.expected(),
                  is_empty_array ? std::string("an empty array") : type_in_words(node),
                  text_for_number ? fmt::format(": write only the number, in {}", key.unit) : std::string()));
}

void check_range(double value, const std::string& as_written, const toml::node& node, const TomlKey& key,
                 const TomlSource& source) {
  if (key.ranges.empty() || key.ranges.front().contains(value)) return;
  const ValueRange& range = key.ranges.front();
  const std::string why = value <= range.lo ? range.if_below : range.if_above;
  throw InputError(source.place(node.source()), fmt::format("'{}' must be {}{}{}, not {}{}{}", key.name,
                                                            key.range, key.unit.empty() ? "" : " ", key.unit,
                                                            as_written, why.empty() ? "" : ": ", why));
}

/// Returns a hint at the probable name of a file that does not exist.
std::string other_name(const fs::path& file) {
  if (file.string().find('\\') != std::string::npos) return ": separate folders with /, not with \\";
  std::vector<std::string> names;
  std::error_code error;
  constexpr std::size_t most = 1000;
  for (fs::directory_iterator entry(file.parent_path(), error), end;
       !error && entry != end && names.size() < most; entry.increment(error))
    names.push_back(entry->path().filename().string());
  std::ranges::sort(names);
  const auto small = [](std::string text) {
    std::ranges::transform(text, text.begin(),
                           [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return text;
  };
  const std::string wanted = file.filename().string();
  const auto same = std::ranges::find(names, small(wanted), small);
  const std::string_view meant = same != names.end() ? std::string_view(*same) : nearest(wanted, names);
  return meant.empty() ? "" : fmt::format(": did you mean '{}'?", meant);
}

}  // namespace

bool ValueRange::contains(double value) const {
  return (lo_excluded ? value > lo : value >= lo) && (hi_excluded ? value < hi : value <= hi);
}

std::string to_string(const ValueRange& range) {
  const bool below = std::isfinite(range.lo), above = std::isfinite(range.hi);
  const std::string lo = fmt::format("{} {}", range.lo_excluded ? ">" : ">=", range.lo);
  const std::string hi = fmt::format("{} {}", range.hi_excluded ? "<" : "<=", range.hi);
  if (below && above) {
    if (range.lo_excluded || range.hi_excluded) return lo + ", " + hi;
    return fmt::format("{} to {}", range.lo, range.hi);
  }
  return below ? lo : above ? hi : "";
}

TomlKey::TomlKey() = default;
TomlKey::TomlKey(const TomlKey&) = default;
TomlKey::TomlKey(TomlKey&&) noexcept = default;
TomlKey& TomlKey::operator=(const TomlKey&) = default;
TomlKey& TomlKey::operator=(TomlKey&&) noexcept = default;
TomlKey::~TomlKey() = default;

std::string TomlKey::expected() const {
  if (!choices.empty()) return one_of(choices, '"');
  std::string text;
  if (type == "file")
    text = "the name of a file";
  else if (type == "true or false")
    text = type;
  else if (type == "integer")
    text = "an integer";
  else if (type == "number" || type == "text")
    text = "a " + type;
  else
    text = "an array of " + type;
  if (!unit.empty()) text += " in " + unit;
  if (!range.empty()) text += " (" + range + ")";
  return text;
}

SourcePlace TomlSource::place(const toml::source_region& region) const {
  return {file.string(), static_cast<int>(region.begin.line), static_cast<int>(region.begin.column)};
}

SourcePlace TomlSource::place(const toml::node& value) const { return place(value.source()); }

const toml::node* TomlTable::value(std::string_view key) const { return table->get(key); }

SourcePlace TomlTable::place_of(std::string_view key) const {
  const toml::node* node = value(key);
  return node == nullptr ? place : source->place(*node);
}

std::vector<TomlEntry> entries_in_file_order(const toml::table& table, const TomlSource& source) {
  std::vector<TomlEntry> entries;
  for (const auto& [key, node] : table) entries.push_back({key.str(), &node, source.place(key.source())});
  std::ranges::stable_sort(entries, {},
                           [](const TomlEntry& e) { return std::pair(e.place.line, e.place.column); });
  return entries;
}

void rename_former_key(toml::table& table, const SceneKey& key, TomlSource& source) {
  const auto former = table.find(key.former_name);
  if (former == table.end()) return;
  const SourcePlace place = source.place(former->first.source());
  if (table.contains(key.name))
    throw InputError(place, fmt::format("'{}' is the former name of '{}', which is present too: remove '{}'",
                                        key.former_name, key.name, key.former_name));
  source.warnings.push_back(
      fmt::format("{}: the key '{}' is deprecated: use '{}'", to_string(place), key.former_name, key.name));
  table.insert(toml::key(key.name, former->first.source()), std::move(former->second));
  table.erase(key.former_name);
}

std::vector<TomlTable> tables_of(const toml::node& node, const std::string& section,
                                 const TomlSource& source) {
  std::vector<TomlTable> tables;
  const auto add = [&](const toml::node& one) {
    const SourcePlace place = source.place(one.source());
    if (!one.is_table()) throw InputError(place, fmt::format("expected tables: write {}", section));
    tables.push_back({one.as_table(), place, &source});
  };
  if (const toml::array* many = node.as_array(); many != nullptr) {
    for (const toml::node& one : *many) add(one);
  } else {
    add(node);
  }
  return tables;
}

void read_value(const toml::node& node, const TomlKey& key, TomlSource& source, double& value) {
  if (!node.is_number()) fail_type(node, key, source);
  // toml++ returns nothing for a whole number that a double cannot represent.
  const std::optional<double> number = node.value<double>();
  if (!number)
    throw InputError(source.place(node.source()),
                     fmt::format("'{}' must be {}, not {}: write it with a decimal point", key.name,
                                 key.expected(), node.as_integer()->get()));
  value = *number;
  const std::string as_written = fmt::format("{}", value);
  if (!std::isfinite(value)) {
    throw InputError(source.place(node.source()), fmt::format("'{}' must be {}, not {}: it must be finite",
                                                              key.name, key.expected(), as_written));
  }
  check_range(value, as_written, node, key, source);
}

void read_value(const toml::node& node, const TomlKey& key, TomlSource& source, std::int64_t& value) {
  if (!node.is_integer()) fail_type(node, key, source);
  value = node.as_integer()->get();
  check_range(static_cast<double>(value), fmt::format("{}", value), node, key, source);
}

void read_value(const toml::node& node, const TomlKey& key, TomlSource& source, bool& value) {
  if (!node.is_boolean()) fail_type(node, key, source);
  value = node.as_boolean()->get();
}

void read_value(const toml::node& node, const TomlKey& key, TomlSource& source, std::string& value) {
  if (!node.is_string()) fail_type(node, key, source);
  value = node.as_string()->get();
  const SourcePlace place = source.place(node.source());
  if (value.empty()) throw InputError(place, fmt::format("'{}' must not be empty", key.name));
  if (value.size() > key.longest)
    throw InputError(
        place, fmt::format("'{}' has {} bytes, expected at most {}", key.name, value.size(), key.longest));
  if (std::ranges::any_of(value, [](unsigned char c) { return c < 0x20 || c == 0x7f; })) {
    throw InputError(place,
                     fmt::format("'{}' must be one line of text without control characters", key.name));
  }
  if (!key.choices.empty() && std::ranges::find(key.choices, value) == key.choices.end()) {
    const std::string_view meant = nearest(value, key.choices);
    throw InputError(place, fmt::format("'{}' must be {}, not \"{}\"{}", key.name, key.expected(), value,
                                        meant.empty() ? "" : fmt::format(": did you mean \"{}\"?", meant)));
  }
}

void read_value(const toml::node& node, const TomlKey& key, TomlSource& source,
                std::filesystem::path& value) {
  std::string name;
  read_value(node, key, source, name);
  value = source.file.parent_path() / name;
  const SourcePlace place = source.place(node.source());
  std::error_code error;
  const fs::file_status status = fs::status(value, error);
  if (status.type() == fs::file_type::not_found) {
    throw InputError(
        place, fmt::format("'{}': there is no file '{}'; names are relative to the scene file's folder{}",
                           key.name, value.string(), other_name(value)));
  }
  if (status.type() == fs::file_type::none) {
    throw InputError(place,
                     fmt::format("'{}': cannot access '{}': {}", key.name, value.string(), error.message()));
  }
  if (status.type() != fs::file_type::regular) {
    throw InputError(place,
                     fmt::format("'{}': '{}' is a {}, expected a regular file", key.name, value.string(),
                                 status.type() == fs::file_type::directory ? "folder" : "special file"));
  }
  if (fs::file_size(value, error) > limits::named_file_bytes && !error) {
    throw InputError(
        place, fmt::format("'{}': '{}' has more than {} GiB: cut the file to the part that the scene needs",
                           key.name, value.string(), limits::named_file_bytes >> 30));
  }
  source.named_files.push_back({value, name, place});
}

std::string array_text(const std::vector<std::string>& elements) {
  return fmt::format("[{}]", fmt::join(elements, ", "));
}
std::string number_text(double value) { return fmt::format("{}", value); }

std::vector<const toml::node*> array_of_length(const toml::node& node, const TomlKey& key,
                                               const TomlSource& source, std::size_t length) {
  const toml::array* elements = node.as_array();
  if (elements == nullptr) fail_type(node, key, source);
  if (elements->size() != length) {
    throw InputError(source.place(node.source()),
                     fmt::format("'{}' must be {}, not of {}", key.name, key.expected(), elements->size()));
  }
  return elements_of(*elements);
}

std::vector<const toml::node*> array_of_any_length(const toml::node& node, const TomlKey& key,
                                                   const TomlSource& source) {
  const toml::array* elements = node.as_array();
  if (elements == nullptr || elements->empty()) fail_type(node, key, source);
  return elements_of(*elements);
}

TomlKey element_key(const TomlKey& key, std::size_t index) {
  TomlKey element = key;
  constexpr std::string_view lists = "lists of ";  // "lists of 3 numbers"
  if (key.type.starts_with(lists)) {
    element.type = key.type.substr(lists.size());
  } else {
    const std::size_t count =
        std::isdigit(static_cast<unsigned char>(key.type.front())) ? 2 : 0;  // "3 numbers"
    element.type = key.type.substr(count, key.type.size() - 1 - count);
  }
  if (!key.ranges.empty()) {
    element.ranges = {key.ranges.size() == 1 ? key.ranges.front() : key.ranges.at(index)};
    element.range = to_string(element.ranges.front());
  }
  return element;
}

TomlKey make_key(std::string_view name, std::string type, std::string default_value, KeyRule rule) {
  TomlKey key;
  static_cast<KeyRule&>(key) = std::move(rule);
  key.name = name;
  key.type = std::move(type);
  key.unit = measured_name(name).unit;
  key.meaning = key.KeyRule::meaning;
  key.former_name = key.KeyRule::former_name;
  if (!key.KeyRule::default_value.empty())
    key.default_value = key.KeyRule::default_value;
  else
    key.default_value = key.required ? "required" : std::move(default_value);
  for (const ValueRange& range : key.ranges) {
    if (!key.range.empty()) key.range += "; ";
    key.range += to_string(range);
  }
  if (!key.choices.empty()) key.range = one_of(key.choices, '"');
  return key;
}

TomlKey make_kind_key(const std::string& section, std::string_view name, std::vector<std::string> kinds) {
  TomlKey key = make_key(name, TomlType<std::string>::name(), {},
                         {.meaning = "Type of the entry. The type determines which other keys are valid.",
                          .choices = std::move(kinds),
                          .required = true});
  key.section = section;
  return key;
}

void check_key_names(const TomlTable& table, const std::vector<TomlKey>& keys) {
  std::vector<std::string> names;
  for (const TomlKey& key : keys) {
    if (std::ranges::find(names, key.name) == names.end()) names.push_back(key.name);
  }
  for (const TomlEntry& entry : entries_in_file_order(*table.table, *table.source)) {
    if (std::ranges::find(names, entry.key) != names.end()) continue;
    const std::string unknown = fmt::format("unknown key '{}' in {}", entry.key, keys.front().section);
    const std::string_view stem = measured_name(entry.key).stem;
    for (const TomlKey& key : keys) {
      const MeasuredName known = measured_name(key.name);
      if (!known.unit.empty() && known.stem == stem) {
        throw InputError(entry.place,
                         fmt::format("{}: give it in {}, as '{}'", unknown, known.unit, key.name));
      }
    }
    const std::string_view meant = nearest(entry.key, names);
    throw InputError(entry.place, meant.empty() ? fmt::format("{}: expected {}", unknown, one_of(names, '\''))
                                                : fmt::format("{}: did you mean '{}'?", unknown, meant));
  }
}

void check_kind_of_keys(const TomlTable& table, const std::vector<TomlKey>& keys, const std::string& kind) {
  const auto holds = [&kind](const TomlKey& key) { return key.kind.empty() || key.kind == kind; };
  for (const TomlKey& key : keys) {
    if (key.required && holds(key) && !table.has(key.name)) {
      throw InputError(table.place,
                       fmt::format("{}{}{} needs the key '{}': {}", key.section,
                                   key.kind.empty() ? "" : " with ", key.kind, key.name, key.expected()));
    }
  }
  for (const TomlEntry& entry : entries_in_file_order(*table.table, *table.source)) {
    const auto named = [&entry](const TomlKey& key) { return key.name == entry.key; };
    if (std::ranges::any_of(keys, [&](const TomlKey& key) { return named(key) && holds(key); })) continue;
    std::vector<std::string> owners;
    for (const TomlKey& key : keys) {
      if (named(key)) owners.push_back(key.kind);
    }
    throw InputError(entry.place, fmt::format("'{0}' applies to {1}, not to {2}: remove '{0}', or change {2}",
                                              entry.key, fmt::join(owners, ", "), kind));
  }
}

}  // namespace tubefoot
