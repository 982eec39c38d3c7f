// SPDX-License-Identifier: GPL-3.0-or-later

// Prints the reference of scene keys: all sections, or the keys that match a name; as text or as JSON.

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "app/commands.hpp"
#include "files/json_text.hpp"
#include "files/usage_error.hpp"
#include "files/words.hpp"
#include "run/console/say.hpp"
#include "sensors/kinds/scene_file.hpp"

namespace tubefoot {
namespace {

constexpr std::size_t widest_line = 100, text_column = 28;

/// A section, or a kind within a section, and its keys.
struct KeyGroup {
  SceneSection documentation;
  std::vector<SceneKey> keys;
};

std::vector<KeyGroup> all_groups() {
  std::vector<KeyGroup> groups;
  for (SceneSection& section : scene_file_sections()) groups.push_back({std::move(section), {}});
  for (const SceneKey& key : scene_file_keys()) {
    const auto group = std::ranges::find_if(groups, [&](const KeyGroup& g) {
      return g.documentation.section == key.section && g.documentation.kind == key.kind;
    });
    group->keys.push_back(key);
  }
  return groups;
}

/// Returns "materials.relief" for "[[materials.relief]]".
std::string without_brackets(std::string_view section) {
  std::string name;
  std::ranges::copy_if(section, std::back_inserter(name), [](char c) { return c != '[' && c != ']'; });
  return name;
}

/// Returns "relief" for "[[materials.relief]]".
std::string last_part(std::string_view section) {
  const std::string name = without_brackets(section);
  return name.substr(name.rfind('.') + 1);
}

/// Returns "flat" for `kind = "flat"`.
std::string kind_name(std::string_view kind) {
  const std::size_t begin = kind.find('"');
  return begin == std::string_view::npos ? ""
                                         : std::string(kind.substr(begin + 1, kind.rfind('"') - begin - 1));
}

/// Returns the groups that match `name`. The name of a section selects its kinds too; the name of a key
/// selects this key in all groups.
std::vector<KeyGroup> groups_of(const std::vector<KeyGroup>& all, const std::string& name) {
  std::vector<KeyGroup> found;
  for (const KeyGroup& group : all) {
    const auto& [section, kind, meaning] = group.documentation;
    const bool whole = name == section || name == kind || name == without_brackets(section) ||
                       name == last_part(section) || name == kind_name(kind);
    KeyGroup part{group.documentation, {}};
    for (const SceneKey& key : group.keys)
      if (whole || key.name == name || (key.former_name == name && !name.empty())) part.keys.push_back(key);
    if (whole || !part.keys.empty()) found.push_back(std::move(part));
  }
  return found;
}

/// Returns the keys whose name contains `part`.
std::vector<KeyGroup> groups_with(const std::vector<KeyGroup>& all, const std::string& part) {
  std::vector<KeyGroup> found;
  for (const KeyGroup& group : all) {
    KeyGroup own{group.documentation, {}};
    for (const SceneKey& key : group.keys)
      if (key.name.find(part) != std::string::npos) own.keys.push_back(key);
    if (!own.keys.empty()) found.push_back(std::move(own));
  }
  return found;
}

/// Returns all names that the command accepts.
std::vector<std::string> known_names(const std::vector<KeyGroup>& all) {
  std::vector<std::string> names;
  for (const auto& [documentation, keys] : all) {
    if (!documentation.section.empty()) names.push_back(without_brackets(documentation.section));
    if (!documentation.kind.empty()) names.push_back(kind_name(documentation.kind));
    for (const SceneKey& key : keys) names.push_back(key.name);
  }
  return names;
}

std::vector<KeyGroup> requested_groups(const KeysOptions& options) {
  const std::vector<KeyGroup> all = all_groups();
  if (!options.name) return all;
  if (std::vector<KeyGroup> found = groups_of(all, *options.name); !found.empty()) return found;
  if (std::vector<KeyGroup> found = groups_with(all, *options.name); !found.empty()) return found;
  const std::vector<std::string> names = known_names(all);
  const std::string_view meant = nearest(*options.name, names);
  throw UsageError(fmt::format("no section, kind or key matches '{}': {}'tubefoot keys' lists the sections",
                               *options.name,
                               meant.empty() ? std::string() : fmt::format("did you mean '{}'? ", meant)));
}

/// Returns `head`, followed by `text` that starts in the column of texts and continues in further lines.
std::string in_columns(const std::string& head, const std::string& text) {
  std::string result, line = head;
  const auto next_line = [&] {
    result += line + "\n";
    line.assign(text_column, ' ');
  };
  if (line.size() + 2 > text_column)
    next_line();
  else
    line.resize(text_column, ' ');
  std::istringstream words(text);
  bool begins = true;
  for (std::string word; words >> word; begins = false) {
    if (!begins && line.size() + 1 + word.size() > widest_line) {
      next_line();
      begins = true;
    }
    line += (begins ? "" : " ") + word;
  }
  return result + line + "\n";
}

/// Returns the text for a terminal, where names of keys are between single quotes.
std::string quoted(std::string text) {
  std::ranges::replace(text, '`', '\'');
  return text;
}

std::string properties(const SceneKey& key) {
  std::string text = key.type;
  if (!key.unit.empty()) text += " in " + key.unit;
  text += key.default_value == "required" ? "; required" : "; default: " + key.default_value;
  if (key.range.starts_with('"'))
    text += "; permitted: " + key.range;
  else if (!key.range.empty())
    text += "; range: " + key.range;
  return text;
}

void print_sections(const std::vector<KeyGroup>& all) {
  for (const auto& [documentation, keys] : all) {
    const auto& [section, kind, meaning] = documentation;
    const std::string head = section.empty() ? "title" : kind.empty() ? section : "  " + kind;
    tell("{}", in_columns(head, quoted(meaning)));
  }
  tell("\n'tubefoot keys SECTION' and 'tubefoot keys KIND' print the keys of a section or of a kind.\n");
}

void print_keys(const std::vector<KeyGroup>& groups) {
  bool first = true;
  for (const auto& [documentation, keys] : groups) {
    const auto& [section, kind, meaning] = documentation;
    if (!first) tell("\n");
    first = false;
    tell("{}", in_columns(fmt::format("{}{}{}", section.empty() ? "above all sections" : section,
                                      kind.empty() ? "" : " ", kind),
                          quoted(meaning)));
    for (const SceneKey& key : keys) {
      tell("{}", in_columns("  " + key.name, properties(key)));
      tell("{}", in_columns("", quoted(key.meaning)));
      if (!key.former_name.empty())
        tell("{}", in_columns("", fmt::format("The former name '{}' is deprecated.", key.former_name)));
    }
  }
}

nlohmann::ordered_json json_of(const std::vector<KeyGroup>& groups) {
  nlohmann::ordered_json sections = nlohmann::ordered_json::array();
  for (const auto& [documentation, keys] : groups) {
    nlohmann::ordered_json listed = nlohmann::ordered_json::array();
    for (const SceneKey& key : keys) {
      nlohmann::ordered_json entry{{"name", key.name},   {"type", key.type},
                                   {"unit", key.unit},   {"default", key.default_value},
                                   {"range", key.range}, {"meaning", key.meaning}};
      if (!key.former_name.empty()) entry["former_name"] = key.former_name;
      listed.push_back(std::move(entry));
    }
    sections.push_back({{"section", documentation.section},
                        {"kind", documentation.kind},
                        {"meaning", documentation.meaning},
                        {"keys", std::move(listed)}});
  }
  return {{"sections", std::move(sections)}};
}

}  // namespace

int keys_command(const KeysOptions& options) {
  const std::vector<KeyGroup> groups = requested_groups(options);
  if (options.json)
    tell("{}\n", text_of(json_of(groups)));
  else if (options.name)
    print_keys(groups);
  else
    print_sections(groups);
  return 0;
}

}  // namespace tubefoot
