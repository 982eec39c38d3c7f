// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <pugixml.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "files/input_error.hpp"

namespace tubefoot {

/// An XML file of a stranger: no document type, so no entities of its own, and no more nesting than any world
/// has.
class XmlInput {
 public:
  static constexpr std::size_t most_bytes = std::size_t{16} << 20;
  static constexpr int most_nesting = 64;

  /// Throws InputError at the place that is wrong.
  explicit XmlInput(const std::filesystem::path& file);

  pugi::xml_node root() const { return document_.document_element(); }
  SourcePlace place_of(pugi::xml_node node) const;
  [[noreturn]] void fail(pugi::xml_node node, const std::string& what) const;

  /// Finite numbers between white space, as many as `count`, none larger than any place on Earth. Throws
  /// InputError that names `what`.
  std::vector<double> numbers(pugi::xml_node node, std::string_view text, std::size_t count,
                              std::string_view what) const;
  double number(pugi::xml_node node, std::string_view text, std::string_view what) const {
    return numbers(node, text, 1, what).front();
  }
  /// Of a child's text, or of an attribute; `otherwise` where it is not there.
  double child_number(pugi::xml_node node, const char* child, double otherwise) const;
  double attribute_number(pugi::xml_node node, const char* attribute, double otherwise) const;

 private:
  SourcePlace place_at(std::ptrdiff_t offset) const;

  std::filesystem::path file_;
  std::string text_;
  std::vector<std::size_t> lines_;  ///< where each begins
  pugi::xml_document document_;
};

/// The element's own words of one line, as people may see them.
std::string name_in(pugi::xml_node node);

}  // namespace tubefoot
