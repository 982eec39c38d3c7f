// SPDX-License-Identifier: GPL-3.0-or-later
// Reads messages as YAML text, as `ros2 topic echo` prints them. Fields that only one type has identify the
// type. The text is read message by message, with a check of the memory that each message needs.
#include "import/bags/text_messages.hpp"

#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include <charconv>
#include <limits>
#include <sstream>
#include <type_traits>

#include "files/csv_file.hpp"
#include "files/input_registry.hpp"
#include "files/memory_at_hand.hpp"
#include "files/shown.hpp"
#include "geometry/steps/stop.hpp"
#include "import/bags/bag_limits.hpp"
#include "import/bags/message_error.hpp"

namespace tubefoot {
namespace {

namespace fs = std::filesystem;

class YamlReader {
 public:
  YamlReader(const YAML::Node& node, SourcePlace begin) : node_(node), begin_(std::move(begin)) {}

  template <class T>
  void operator()(const char* name, T& value) {
    const YAML::Node field = node_.IsMap() ? node_[name] : YAML::Node(YAML::NodeType::Undefined);
    if (!field.IsDefined()) fail(node_, fmt::format("has no '{}'", name));
    name_ = name;
    read(field, value);
  }

 private:
  template <class T>
  void read(const YAML::Node& node, T& value) {
    if constexpr (std::is_same_v<T, std::string>) {
      value = scalar(node, "a text");
    } else if constexpr (std::is_same_v<T, bool>) {
      const std::string text = scalar(node, "true or false");
      if (text != "true" && text != "false")
        fail(node, fmt::format("{} is '{}', expected true or false", name_, shown_line(text)));
      value = text == "true";
    } else if constexpr (std::is_arithmetic_v<T>) {
      number(node, value);
    } else if constexpr (ros::is_list<T>) {
      if (!node.IsSequence())
        fail(node,
             fmt::format("{} is not a list: print it with ros2 topic echo --full-length, without --no-arr",
                         name_));
      value.reserve(node.size());
      for (const YAML::Node& each : node) {
        if (each.IsScalar() && each.Scalar() == "...")
          fail(
              each,
              fmt::format(
                  "{}: the list was cut off when it was printed: print it with ros2 topic echo --full-length",
                  name_));
        read(each, value.emplace_back());
      }
    } else {
      YamlReader inner(node, begin_);
      fields(inner, value);
    }
  }

  std::string scalar(const YAML::Node& node, std::string_view expected) const {
    if (!node.IsScalar()) fail(node, fmt::format("{}: expected {}", name_, expected));
    return node.Scalar();
  }

  template <class T>
  void number(const YAML::Node& node, T& value) {
    const std::string text = scalar(node, "a number");
    if constexpr (std::is_floating_point_v<T>) {
      constexpr T infinite = std::numeric_limits<T>::infinity();
      if (text == ".nan") return void(value = std::numeric_limits<T>::quiet_NaN());
      if (text == ".inf" || text == "-.inf") return void(value = text[0] == '-' ? -infinite : infinite);
    }
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc{} || end != text.data() + text.size())
      fail(node, fmt::format("{}: '{}' is not a number of the field's type", name_, shown_line(text)));
  }

  [[noreturn]] void fail(const YAML::Node& node, const std::string& what) const {
    SourcePlace place = begin_;
    const YAML::Mark mark = node.Mark();
    if (!mark.is_null()) {
      place.line += mark.line;
      place.column = mark.column + 1;
    }
    throw InputError(place, what);
  }

  YAML::Node node_;
  SourcePlace begin_;
  const char* name_ = "";
};

/// Identifies the type by a field that only one type has.
std::string type_of(const YAML::Node& node, const SourcePlace& place) {
  if (node.IsMap()) {
    if (node["beam_directions"]) return std::string(ros::ProjectedSonarImage::name);
    if (node["samples_per_beam"]) return std::string(ros::RawSonarImage::name);
    if (node["encoding"]) return std::string(ros::Image::name);
    if (node["bins_azimuth"]) return std::string(ros::ImagingSonar::name);
  }
  throw InputError(place,
                   "is not a message that tubefoot reads: expected the fields of ProjectedSonarImage, "
                   "RawSonarImage or Image, as ros2 topic echo --full-length prints them");
}

void read_one(const std::string& text, const SourcePlace& begin, const std::optional<std::string>& type,
              const std::function<void(const ros::Message&)>& take) {
  // Measured: for a list with one number per line, YAML needs about 70 bytes of memory per byte of text.
  constexpr double memory_a_byte = 80;
  require_memory(memory_a_byte * static_cast<double>(text.size()), begin, "the message as text",
                 "record a bag (ros2 bag record) instead");
  try {
    const YAML::Node node = YAML::Load(text);
    if (node.IsNull()) return;  // nothing follows the last ---
    ros::Message message = ros::message_of(type ? *type : type_of(node, begin));
    YamlReader reader(node, begin);
    std::visit([&reader](auto& any) { fields(reader, any); }, message);
    take(message);
  } catch (const MessageError& error) {
    throw InputError(begin, error.what());
  } catch (const YAML::Exception& error) {
    SourcePlace place = begin;
    if (!error.mark.is_null()) {
      place.line += error.mark.line;
      place.column = error.mark.column + 1;
    }
    throw InputError(place, fmt::format("is not a message as ros2 topic echo prints it (YAML): {}",
                                        shown_line(error.msg)));
  }
}

}  // namespace

void read_message_text(const fs::path& file, const std::optional<std::string>& type,
                       const std::function<void(const ros::Message&)>& take) {
  InputFile input(file);
  std::string text;
  SourcePlace begin{file.string(), 1, 0}, here = begin;
  for (std::string line; next_line(input.stream(), line, here); ++here.line) {
    stop_if_wanted();
    if (line == "---" || line == "---\r") {
      read_one(text, begin, type, take);
      text.clear();
      begin.line = here.line + 1;
      continue;
    }
    text += line;
    text += '\n';
    if (text.size() > limits::message_text_bytes)
      throw InputError(
          begin,
          fmt::format("has a message of more than {} bytes of text: record a bag (ros2 bag record) instead",
                      limits::message_text_bytes));
  }
  read_one(text, begin, type, take);
}

}  // namespace tubefoot
