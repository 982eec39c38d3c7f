// SPDX-License-Identifier: GPL-3.0-or-later
// Finds the files that worlds name by path, by model:// and by the address of a model in Gazebo Fuel. Files
// outside of the world's folder and of the model path are not read.
#include "exchange/readers/world_files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <system_error>

#include "exchange/readers/xml_input.hpp"
#include "files/absolute_path.hpp"
#include "files/companions.hpp"
#include "files/shown.hpp"

namespace tubefoot {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view fuel_collection = "models";

bool begins_with(std::string& name, std::string_view scheme) {
  if (!name.starts_with(scheme)) return false;
  name.erase(0, scheme.size());
  return true;
}

std::string lower_case(std::string text) {
  std::ranges::transform(text, text.begin(),
                         [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
  return text;
}

/// Replaces %20 and similar escapes of an address.
std::string unescaped(const std::string& text) {
  std::string out;
  for (std::size_t k = 0; k < text.size(); ++k) {
    unsigned value = 0;
    if (text[k] == '%' && k + 2 < text.size()) {
      const char* end = text.data() + k + 3;
      if (const auto read = std::from_chars(text.data() + k + 1, end, value, 16);
          read.ec == std::errc() && read.ptr == end) {
        out += static_cast<char>(value);
        k += 2;
        continue;
      }
    }
    out += text[k];
  }
  return out;
}

/// Returns the subfolder with the largest number as its name.
std::optional<fs::path> newest_version(const fs::path& folder) {
  constexpr int most_entries = 1000;
  std::optional<fs::path> newest;
  int largest = -1, entries = 0;
  std::error_code error;
  for (fs::directory_iterator at(folder, error), end; !error && at != end && entries < most_entries;
       at.increment(error), ++entries) {
    const std::string name = at->path().filename().string();
    int number = -1;
    const auto read = std::from_chars(name.data(), name.data() + name.size(), number);
    if (read.ec == std::errc() && read.ptr == name.data() + name.size() && number > largest) {
      largest = number;
      newest = at->path();
    }
  }
  return newest;
}

/// Appends the places of a model of Gazebo Fuel, or of a file in it. `address`: the part after https://,
/// HOST/1.0/OWNER/models/NAME[/VERSION[/files/PATH]]. Gazebo's cache names its folders in lower case.
void add_places_of_fuel(const std::string& address, const std::vector<fs::path>& model_path,
                        std::vector<fs::path>& places, std::string& why) {
  std::vector<std::string> parts;
  for (std::size_t at = 0; at <= address.size();) {
    const std::size_t end = std::min(address.find('/', at), address.size());
    if (end > at) parts.push_back(unescaped(address.substr(at, end - at)));
    at = end + 1;
  }
  const auto collection = std::ranges::find(parts, fuel_collection);
  if (collection == parts.end() || collection - parts.begin() < 2 || parts.end() - collection < 2) {
    why = "it is on another computer, and tubefoot reads only local files";
    return;
  }
  const std::string &name = *(collection + 1), &owner = *(collection - 1);
  fs::path rest;
  if (const auto files = std::find(collection + 2, parts.end(), "files"); files != parts.end())
    for (auto part = files + 1; part != parts.end(); ++part) rest /= *part;
  why = fmt::format(
      "model '{}' of Gazebo Fuel is not on this computer: download it, and give the folder that contains its "
      "folder, or a copy of Gazebo's cache (~/.gz/fuel), with --model-path",
      shown_line(name));
  for (const fs::path& folder : model_path) {
    const fs::path cached = lower_case(owner) / fs::path(fuel_collection) / lower_case(name);
    for (const fs::path& in_cache : {folder / lower_case(parts.front()) / cached, folder / cached})
      if (const auto newest = newest_version(in_cache)) places.push_back(*newest / rest);
  }
  // A folder of the same name may contain another model.
  for (const fs::path& folder : model_path)
    for (const std::string& spelling : {name, lower_case(name)}) places.push_back(folder / spelling / rest);
}

/// Returns the number of a version such as 1.10, as 1010; -1 for other texts.
int version_number(std::string_view text) {
  int major = 0, minor = 0;
  const char* end = text.data() + text.size();
  const auto first = std::from_chars(text.data(), end, major);
  if (first.ec != std::errc() || major > 100) return -1;
  if (first.ptr != end && *first.ptr == '.') std::from_chars(first.ptr + 1, end, minor);
  return major * 1000 + std::clamp(minor, 0, 999);
}

/// Returns the file that model.config names for the newest version of SDF.
fs::path file_of_config(const fs::path& folder) {
  const XmlInput config(folder / "model.config");
  int best = -2;
  std::string file;
  for (const pugi::xml_node sdf : config.root().children("sdf"))
    if (const int version = version_number(sdf.attribute("version").value()); version > best) {
      best = version;
      file = trimmed(sdf.child_value());
    }
  return file.empty() ? folder / "model.sdf" : folder / fs::path(file).relative_path();
}

}  // namespace

std::string trimmed(std::string_view uri) {
  constexpr std::string_view blanks = " \t\r\n";
  const std::size_t begin = uri.find_first_not_of(blanks);
  return begin == uri.npos ? std::string()
                           : std::string(uri.substr(begin, uri.find_last_not_of(blanks) - begin + 1));
}

WorldFiles::WorldFiles(const fs::path& world, std::vector<fs::path> model_path)
    : folder_(absolute_path(world).parent_path()), model_path_(std::move(model_path)) {
  for (fs::path& folder : model_path_) folder = absolute_path(folder);
}

bool WorldFiles::is_allowed(const fs::path& file) const {
  return !place_outside(folder_, file) || std::ranges::any_of(model_path_, [&](const fs::path& folder) {
    return !place_outside(folder, file);
  });
}

std::vector<fs::path> WorldFiles::candidates(const std::string& uri, const fs::path& beside,
                                             std::string& why) const {
  std::string name = trimmed(uri);
  std::vector<fs::path> places;
  if (begins_with(name, "http://") || begins_with(name, "https://")) {
    add_places_of_fuel(name, model_path_, places, why);
    return places;
  }
  const bool of_models = begins_with(name, "model://") || begins_with(name, "package://");
  if (!of_models) begins_with(name, "file://");
  const fs::path path(name), relative = path.relative_path();
  if (relative.empty() || name.find("://") != name.npos || name.find('\0') != name.npos) {
    why = "it does not name a file";
    return places;
  }
  if (of_models) {
    // A model names its own files by its own name.
    constexpr int most_levels = 32;
    fs::path level = beside;
    for (int k = 0; k < most_levels && level.has_filename(); ++k, level = level.parent_path())
      if (level.filename() == *relative.begin()) places.push_back(level.parent_path() / relative);
  } else {
    places.push_back(path.is_absolute() ? path : beside / path);
  }
  for (const fs::path& folder : model_path_) places.push_back(folder / relative);
  std::error_code error;
  const fs::path usual = folder_.parent_path() / "models";
  if (of_models && model_path_.empty())
    why = "give the folder of the models with --model-path";
  else if (of_models)
    why = "there is no such file in the folders of --model-path";
  else
    why = "there is no such file";
  if (of_models && fs::exists(usual / relative, error) && !is_allowed(usual / relative))
    why += fmt::format(" (it is in '{}')", shown_line(usual.string()));
  return places;
}

WorldFiles::Place WorldFiles::chosen(const std::vector<fs::path>& found, const std::string& why,
                                     std::string_view kind) const {
  if (found.empty()) return {{}, why};
  const auto allowed = std::ranges::find_if(found, [&](const fs::path& file) { return is_allowed(file); });
  if (allowed != found.end()) return {*allowed, {}};
  return {{},
          fmt::format("the {} lies outside of the world's folder; give its folder with --model-path", kind)};
}

WorldFiles::Place WorldFiles::file(const std::string& uri, const fs::path& beside) const {
  std::string why;
  std::vector<fs::path> found;
  for (const fs::path& place : candidates(uri, beside, why)) {
    std::error_code error;
    if (fs::is_regular_file(place, error)) found.push_back(place);
  }
  return chosen(found, why, "file");
}

WorldFiles::Place WorldFiles::model(const std::string& uri, const fs::path& beside) {
  std::string why;
  std::vector<fs::path> found;
  for (const fs::path& place : candidates(uri, beside, why)) {
    std::error_code error;
    if (fs::is_regular_file(place, error)) found.push_back(place);
    if (!fs::is_directory(place, error)) continue;
    auto known = model_files_.find(place);
    if (known == model_files_.end()) {
      const fs::path config = place / "model.config";
      const bool has_config = fs::is_regular_file(config, error) && is_allowed(config);
      known = model_files_.emplace(place, has_config ? file_of_config(place) : place / "model.sdf").first;
    }
    if (fs::is_regular_file(known->second, error))
      found.push_back(known->second);
    else
      why = fmt::format("the folder '{}' of the model contains no '{}'", shown_line(place.string()),
                        shown_line(known->second.lexically_relative(place).string()));
  }
  return chosen(found, why, "model");
}

}  // namespace tubefoot
