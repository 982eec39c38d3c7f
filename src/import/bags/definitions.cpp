// SPDX-License-Identifier: GPL-3.0-or-later
// Compares the message definition that a recording contains with the fields that tubefoot reads. Both are
// expanded to lists of primitive fields.
#include "import/bags/definitions.hpp"

#include <fmt/format.h>

#include <map>
#include <optional>
#include <sstream>
#include <type_traits>
#include <vector>

#include "files/shown.hpp"
#include "import/bags/sonar_messages.hpp"

namespace tubefoot {
namespace {

/// List of primitive fields, for example "uint32 header.stamp.nanosec", "float32[] ranges".
using Flat = std::vector<std::string>;

/// Expands the message types of tubefoot.
class Own {
 public:
  template <class T>
  void operator()(const char* name, T& value) {
    const std::string before = path_;
    path_ += (path_.empty() ? "" : ".") + std::string(name);
    put(value);
    path_ = before;
  }
  Flat flat;

 private:
  template <class T>
  void put(T& value) {
    if constexpr (ros::is_list<T>) {
      typename T::value_type one{};
      list_ = true;
      put(one);
      list_ = false;
    } else if constexpr (std::is_class_v<T> && !std::is_same_v<T, std::string>) {
      if (list_) path_ += "[]";
      list_ = false;
      fields(*this, value);
    } else {
      flat.push_back(fmt::format("{}{} {}", word<T>(), list_ ? "[]" : "", path_));
    }
  }
  template <class T>
  static std::string word() {
    if constexpr (std::is_same_v<T, bool>)
      return "bool";
    else if constexpr (std::is_same_v<T, std::string>)
      return "string";
    else if constexpr (std::is_floating_point_v<T>)
      return sizeof(T) == 4 ? "float32" : "float64";
    else
      return fmt::format("{}int{}", std::is_unsigned_v<T> ? "u" : "", 8 * sizeof(T));
  }

  std::string path_;
  bool list_ = false;
};

struct Field {
  std::string type, name;
};

/// Parses a field: "float32[<=8] x 1.0 # so" is a float32[] x. Constants, comments and blank lines are not
/// fields.
std::optional<Field> field_of(std::string line) {
  line = line.substr(0, line.find('#'));
  std::istringstream words(line);
  Field field;
  std::string next;
  if (!(words >> field.type >> field.name)) return std::nullopt;
  if (field.name.find('=') != std::string::npos || (words >> next && next.starts_with('=')))
    return std::nullopt;
  if (const std::size_t bound = field.type.find("<="); bound != std::string::npos) {
    const std::size_t open = field.type.rfind('[', bound);
    field.type = field.type.substr(0, open == std::string::npos ? bound : open) +
                 (open == std::string::npos ? "" : "[]");
  }
  if (field.type.starts_with("byte") || field.type.starts_with("char")) field.type.replace(0, 4, "uint8");
  return field;
}

/// Shortens type names: "std_msgs/Header" and "std_msgs/msg/Header" are the same type.
std::string short_name(std::string name) {
  if (const std::size_t at = name.find("/msg/"); at != std::string::npos) name.erase(at, 4);
  return name;
}

/// Expands a definition of a recording.
class Theirs {
 public:
  Theirs(std::string_view type, std::string_view definition) : root_(short_name(std::string(type))) {
    std::istringstream lines{std::string(definition)};
    std::string of = root_;
    for (std::string line; std::getline(lines, line);) {
      if (line.starts_with("MSG: ")) {
        of = short_name(line.substr(5));
        while (!of.empty() && std::isspace(static_cast<unsigned char>(of.back()))) of.pop_back();
      } else if (!line.starts_with("=====")) {
        if (std::optional<Field> field = field_of(line)) sections_[of].push_back(std::move(*field));
      }
    }
  }

  /// Returns nothing if the definition of a type is missing.
  std::optional<Flat> flat() {
    Flat flat;
    return add(root_, "", 0, flat) ? std::optional(std::move(flat)) : std::nullopt;
  }

 private:
  bool add(const std::string& type, const std::string& path, int depth, Flat& flat) const {
    constexpr int deepest = 8;
    constexpr std::size_t most = 1000;
    const auto section = sections_.find(type);
    if (section == sections_.end() || depth > deepest) return false;
    for (const Field& field : section->second) {
      if (flat.size() > most) return false;
      const std::string name = path.empty() ? field.name : path + "." + field.name;
      const std::size_t bracket = field.type.find('[');
      const std::string of = field.type.substr(0, bracket),
                        list = bracket == std::string::npos ? "" : field.type.substr(bracket);
      if (is_basic(of))
        flat.push_back(field.type + " " + name);
      else if (!add(section_name(of, type), name + list, depth + 1, flat))
        return false;
    }
    return true;
  }
  static bool is_basic(const std::string& type) {
    return type == "bool" || type.starts_with("int") || type.starts_with("uint") ||
           type.starts_with("float") || type == "string" || type == "wstring";
  }
  static std::string section_name(const std::string& type, const std::string& from) {
    if (type.find('/') != std::string::npos) return short_name(type);
    return type == "Header" ? "std_msgs/Header" : from.substr(0, from.find('/') + 1) + type;
  }

  std::string root_;
  std::map<std::string, std::vector<Field>> sections_;
};

}  // namespace

std::string difference_of_definition(std::string_view type, std::string_view definition) {
  const std::optional<Flat> theirs = Theirs(type, definition).flat();
  if (!theirs) return {};
  Own own;
  ros::Message message = ros::message_of(type);
  std::visit([&own](auto& any) { fields(own, any); }, message);
  const auto at = [](const Flat& flat, std::size_t k) {
    return k < flat.size() ? "'" + flat[k] + "'" : std::string("none");
  };
  for (std::size_t k = 0; k < std::max(own.flat.size(), theirs->size()); ++k)
    if (at(own.flat, k) != at(*theirs, k))
      return fmt::format("field {} is {}, expected {}", k + 1, shown_line(at(*theirs, k)), at(own.flat, k));
  return {};
}

}  // namespace tubefoot
