// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <pugixml.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "files/input_error.hpp"

namespace tubefoot {

/// An XML file of unknown origin, and the XML files that it includes. A file must not have a document type
/// and thus defines no entities. Its nesting is limited to that of ordinary worlds.
class XmlInput {
 public:
  static constexpr std::size_t most_bytes = std::size_t{16} << 20;
  /// Bytes of all files together.
  static constexpr std::size_t most_bytes_in_all = std::size_t{64} << 20;
  static constexpr int most_nesting = 64;

  /// Throws InputError at the place of the error.
  explicit XmlInput(const std::filesystem::path& file);
  ~XmlInput();
  XmlInput(const XmlInput&) = delete;
  XmlInput& operator=(const XmlInput&) = delete;

  /// Returns the root element of the first file.
  pugi::xml_node root() const;
  /// Reads a further file, once, and returns its root element. Throws InputError at the place of the error.
  pugi::xml_node open(const std::filesystem::path& file);
  /// Returns the file that contains a node.
  const std::filesystem::path& file_of(pugi::xml_node node) const;
  SourcePlace place_of(pugi::xml_node node) const;
  [[noreturn]] void fail(pugi::xml_node node, const std::string& what) const;

  /// Parses `count` finite numbers separated by white space, none larger than any position on Earth. Throws
  /// InputError, which names `what`.
  std::vector<double> numbers(pugi::xml_node node, std::string_view text, std::size_t count,
                              std::string_view what) const;
  double number(pugi::xml_node node, std::string_view text, std::string_view what) const {
    return numbers(node, text, 1, what).front();
  }
  /// Parses the text of a child or an attribute; returns `otherwise` if it is missing.
  double child_number(pugi::xml_node node, const char* child, double otherwise) const;
  double attribute_number(pugi::xml_node node, const char* attribute, double otherwise) const;

 private:
  struct Document;
  const Document& document_of(pugi::xml_node node) const;

  std::vector<std::unique_ptr<const Document>> documents_;
  std::map<const void*, const Document*> by_root_;
  std::map<std::filesystem::path, const Document*> by_file_;
  std::size_t bytes_ = 0;
};

/// Returns the name of an element on one line, safe for display.
std::string name_in(pugi::xml_node node);

}  // namespace tubefoot
