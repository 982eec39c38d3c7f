// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>

#include "geometry/steps/stop.hpp"
#include "scene/meshes/mesh_file_polygons.hpp"
#include "scene/meshes/mesh_file_text.hpp"

// Reads the Polygon File Format (Stanford): a text header that lists elements and their properties, then
// the elements. They are text, or little-endian or big-endian binary. Required are x, y, z of `vertex` and
// the list vertex_indices of `face`.
namespace tubefoot {
namespace {

struct Type {
  int bytes = 0;
  char kind = 'i';  // i(nteger), u(nsigned), f(loat)
};

struct Property {
  std::string name;
  Type type, count;  // count: type of a list's length
  bool is_list = false;
};

struct Element {
  std::string name;
  std::int64_t count = 0;
  std::vector<Property> properties;
};

enum class Encoding { kText, kLittle, kBig };

Type type_of(TextLines& text) {
  struct Name {
    std::string_view old_name, new_name;
    Type type;
  };
  constexpr std::array<Name, 8> kNames = {{{"char", "int8", {1, 'i'}},
                                           {"uchar", "uint8", {1, 'u'}},
                                           {"short", "int16", {2, 'i'}},
                                           {"ushort", "uint16", {2, 'u'}},
                                           {"int", "int32", {4, 'i'}},
                                           {"uint", "uint32", {4, 'u'}},
                                           {"float", "float32", {4, 'f'}},
                                           {"double", "float64", {8, 'f'}}}};
  const std::string_view word = text.word();
  for (const Name& name : kNames) {
    if (word == name.old_name || word == name.new_name) return name.type;
  }
  throw InputError(text.place(),
                   "expected a PLY type: char, uchar, short, ushort, int, uint, float or double");
}

class PlyReader {
 public:
  PlyReader(std::string_view content, const std::string& file) : file_(file), text_(content, file) {
    read_header();
  }

  UncheckedPolygons read() {
    for (const Element& element : elements_) {
      if (element.properties.empty()) {
        throw InputError({file_, 0, 0}, fmt::format("the element {} has no properties", element.name));
      }
      if (element.name == "vertex") {
        read_vertices(element);
      } else if (element.name == "face") {
        read_faces(element);
      } else {
        if (element.name == "tristrips") {
          throw InputError({file_, 0, 0}, "holds triangle strips, not faces: export it with faces");
        }
        for (std::int64_t i = 0; i < element.count; ++i) {
          stop_if_wanted();
          begin(element, i);
          for (const Property& property : element.properties) skip(property);
        }
      }
    }
    return std::move(polygons_);
  }

 private:
  void read_header() {
    text_.next_with_words("the word ply");
    if (text_.word() != "ply")
      throw InputError(text_.place(), "expected the word ply: this is not a PLY file");
    bool has_format = false;
    for (;;) {
      text_.next_with_words("'end_header'");
      const std::string_view keyword = text_.word();
      if (keyword == "end_header") break;
      if (keyword == "format") {
        const std::string_view name = text_.word();
        if (name != "ascii" && name != "binary_little_endian" && name != "binary_big_endian") {
          throw InputError(text_.place(), "expected ascii, binary_little_endian or binary_big_endian");
        }
        encoding_ = name == "ascii"                  ? Encoding::kText
                    : name == "binary_little_endian" ? Encoding::kLittle
                                                     : Encoding::kBig;
        has_format = true;
      } else if (keyword == "element") {
        Element element{std::string(text_.word()), 0, {}};
        element.count = text_.integer("the element's count");
        if (element.count < 0 || element.count >= std::numeric_limits<std::uint32_t>::max()) {
          throw InputError(text_.place(),
                           fmt::format("the element's count is {}, expected 0 to 2^32 - 2", element.count));
        }
        elements_.push_back(std::move(element));
      } else if (keyword == "property") {
        if (elements_.empty()) throw InputError(text_.place(), "a property precedes the first element");
        elements_.back().properties.push_back(read_property());
      } else if (keyword != "comment" && keyword != "obj_info") {
        throw InputError(text_.place(), "expected format, element, property, comment or end_header");
      }
    }
    if (!has_format) throw InputError(text_.place(), "the header does not name a format");
    bytes_ = text_.rest();
  }

  Property read_property() {
    Property property;
    TextLines ahead = text_;
    if (ahead.word() == "list") {
      text_.word();
      property.is_list = true;
      property.count = type_of(text_);
      if (property.count.kind == 'f')
        throw InputError(text_.place(), "a list's length must be of an integer type");
    }
    property.type = type_of(text_);
    property.name = text_.word();
    return property;
  }

  void begin(const Element& element, std::int64_t i) {
    element_ = &element;
    index_ = i;
    if (encoding_ == Encoding::kText)
      text_.next_with_words(fmt::format("{} {} of {}", element.name, i + 1, element.count));
  }

  double value(Type type, const std::string& name) {
    if (encoding_ == Encoding::kText)
      return type.kind == 'f' ? text_.number(name) : static_cast<double>(text_.integer(name));
    if (bytes_.size() < static_cast<std::size_t>(type.bytes)) {
      throw InputError({file_, 0, 0},
                       fmt::format("is cut off in {} {} of {}", element_->name, index_ + 1, element_->count));
    }
    std::array<char, 8> raw{};
    std::copy_n(bytes_.begin(), type.bytes, raw.begin());
    bytes_.remove_prefix(type.bytes);
    if (encoding_ == Encoding::kBig) std::reverse(raw.begin(), raw.begin() + type.bytes);
    return decoded(raw, type);
  }

  static double decoded(const std::array<char, 8>& raw, Type type) {
    const auto as = [&raw](auto number) {
      std::memcpy(&number, raw.data(), sizeof number);
      return static_cast<double>(number);
    };
    if (type.kind == 'f') return type.bytes == 4 ? as(float{}) : as(double{});
    if (type.bytes == 1) return type.kind == 'i' ? as(std::int8_t{}) : as(std::uint8_t{});
    if (type.bytes == 2) return type.kind == 'i' ? as(std::int16_t{}) : as(std::uint16_t{});
    return type.kind == 'i' ? as(std::int32_t{}) : as(std::uint32_t{});
  }

  std::int64_t list_length(const Property& property) {
    const double length = value(property.count, property.name);
    // In a text file, the value need not fit its type.
    if (!(length >= 0 && length <= std::numeric_limits<std::uint32_t>::max()))
      throw InputError(place(),
                       fmt::format("the length of {} is {}, expected 0 to 2^32 - 1", property.name, length));
    return static_cast<std::int64_t>(length);
  }

  void skip(const Property& property) {
    const std::int64_t count = property.is_list ? list_length(property) : 1;
    for (std::int64_t i = 0; i < count; ++i) {
      if (encoding_ == Encoding::kText)
        text_.skip(property.name);  // an unused value need not be a number
      else
        value(property.type, property.name);
    }
  }

  void read_vertices(const Element& element) {
    constexpr std::array<std::string_view, 3> kAxes = {"x", "y", "z"};
    for (const std::string_view axis : kAxes) {
      const auto named = [axis](const Property& p) { return p.name == axis && !p.is_list; };
      if (std::none_of(element.properties.begin(), element.properties.end(), named)) {
        throw InputError({file_, 0, 0}, fmt::format("its vertices have no property {}", axis));
      }
    }
    for (std::int64_t i = 0; i < element.count; ++i) {
      stop_if_wanted();
      begin(element, i);
      glm::dvec3 point(0);
      for (const Property& property : element.properties) {
        const auto axis = std::find(kAxes.begin(), kAxes.end(), property.name) - kAxes.begin();
        if (axis == 3 || property.is_list) {
          skip(property);
          continue;
        }
        const double coordinate = value(property.type, property.name);
        if (!std::isfinite(coordinate)) {
          throw InputError(place(),
                           fmt::format("{} of vertex {} (counted from 0) is {}, expected a finite number",
                                       property.name, i, coordinate));
        }
        point[static_cast<int>(axis)] = coordinate;
      }
      polygons_.points.push_back(point);
    }
  }

  void read_faces(const Element& element) {
    const auto is_corners = [](const Property& p) {
      return p.is_list && (p.name == "vertex_indices" || p.name == "vertex_index");
    };
    if (std::none_of(element.properties.begin(), element.properties.end(), is_corners)) {
      throw InputError({file_, 0, 0}, "its faces have no list vertex_indices");
    }
    for (std::int64_t i = 0; i < element.count; ++i) {
      stop_if_wanted();
      begin(element, i);
      for (const Property& property : element.properties) {
        if (is_corners(property)) {
          read_corners(property);
        } else {
          skip(property);
        }
      }
      polygons_.end_polygon();
      if (encoding_ == Encoding::kText) polygons_.line.push_back(text_.line());
    }
  }

  void read_corners(const Property& property) {
    const std::int64_t count = list_length(property);
    for (std::int64_t k = 0; k < count; ++k) {
      const double index = value(property.type, property.name);
      if (!(index >= 0 && index < std::numeric_limits<std::uint32_t>::max())) {
        throw InputError(place(), fmt::format("vertex index {} of face {} (counted from 0) is out of range",
                                              index, index_));
      }
      polygons_.corners.push_back(static_cast<std::uint32_t>(index));
    }
  }

  SourcePlace place() const {
    return encoding_ == Encoding::kText ? text_.place() : SourcePlace{file_, 0, 0};
  }

  std::string file_;
  TextLines text_;
  std::string_view bytes_;
  Encoding encoding_ = Encoding::kText;
  std::vector<Element> elements_;
  const Element* element_ = nullptr;  // element that is being read, for errors
  std::int64_t index_ = 0;
  UncheckedPolygons polygons_;
};

}  // namespace

UncheckedPolygons parse_ply(std::string_view content, const std::string& file) {
  return PlyReader(content, file).read();
}

}  // namespace tubefoot
