// SPDX-License-Identifier: GPL-3.0-or-later
// Reads XML files of unknown origin with limits on size and nesting and without a document type. It maps
// elements to file, line and column, and parses numbers.
#include "exchange/readers/xml_input.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <iterator>

#include "files/input_registry.hpp"
#include "files/shown.hpp"

namespace tubefoot {
namespace {

constexpr std::string_view blanks = " \t\r\n";

}  // namespace

struct XmlInput::Document {
  std::filesystem::path file;
  std::string text;
  std::vector<std::size_t> lines;  ///< begin of each line
  pugi::xml_document tree;

  SourcePlace place_at(std::ptrdiff_t offset) const {
    if (offset < 0 || static_cast<std::size_t>(offset) > text.size()) return {file.string(), 0, 0};
    const auto at = static_cast<std::size_t>(offset);
    const auto after = std::ranges::upper_bound(lines, at);
    return {file.string(), static_cast<int>(after - lines.begin()),
            static_cast<int>(at - *std::prev(after)) + 1};
  }
};

XmlInput::XmlInput(const std::filesystem::path& file) { open(file); }
XmlInput::~XmlInput() = default;

pugi::xml_node XmlInput::root() const { return documents_.front()->tree.document_element(); }

pugi::xml_node XmlInput::open(const std::filesystem::path& file) {
  std::error_code error;
  const std::filesystem::path key = std::filesystem::weakly_canonical(file, error);
  if (const auto known = by_file_.find(key); known != by_file_.end())
    return known->second->tree.document_element();
  auto made = std::make_unique<Document>();
  made->file = file;
  made->text =
      read_whole(file, {file.string(), 0, 0}, most_bytes, "an SDF world or a Stonefish scenario (XML)");
  bytes_ += made->text.size();
  if (bytes_ > most_bytes_in_all)
    throw InputError({file.string(), 0, 0},
                     fmt::format("brings the included files to {} bytes: expected at most {} MB together; "
                                 "import the models separately",
                                 bytes_, most_bytes_in_all >> 20));
  made->lines.push_back(0);
  for (std::size_t at = 0; at < made->text.size(); ++at)
    if (made->text[at] == '\n') made->lines.push_back(at + 1);
  const pugi::xml_parse_result parsed = made->tree.load_buffer(
      made->text.data(), made->text.size(), pugi::parse_default | pugi::parse_doctype, pugi::encoding_utf8);
  if (!parsed)
    throw InputError(made->place_at(parsed.offset),
                     fmt::format("is not valid XML: {}", harmless(parsed.description())));
  const Document& document = *made;
  by_root_.emplace(document.tree.internal_object(), &document);
  documents_.push_back(std::move(made));
  for (const pugi::xml_node node : document.tree.children())
    if (node.type() == pugi::node_doctype)
      fail(node, "has a document type, which tubefoot does not accept: remove <!DOCTYPE ...>");
  // An iterative walk, so that the stack does not grow with the nesting.
  int depth = 0;
  for (pugi::xml_node node = document.tree.document_element(); node;) {
    if (depth > most_nesting) fail(node, fmt::format("is nested deeper than {} elements", most_nesting));
    if (const pugi::xml_node inner = node.first_child()) {
      node = inner;
      ++depth;
      continue;
    }
    while (node && !node.next_sibling() && depth > 0) {
      node = node.parent();
      --depth;
    }
    node = depth > 0 ? node.next_sibling() : pugi::xml_node();
  }
  by_file_.emplace(key, &document);
  return document.tree.document_element();
}

const XmlInput::Document& XmlInput::document_of(pugi::xml_node node) const {
  const auto known = by_root_.find(node.root().internal_object());
  return known == by_root_.end() ? *documents_.front() : *known->second;
}

const std::filesystem::path& XmlInput::file_of(pugi::xml_node node) const { return document_of(node).file; }

SourcePlace XmlInput::place_of(pugi::xml_node node) const {
  // pugixml counts from the name of an element.
  const std::ptrdiff_t offset = node.offset_debug();
  return document_of(node).place_at(offset > 0 && node.type() == pugi::node_element ? offset - 1 : offset);
}

void XmlInput::fail(pugi::xml_node node, const std::string& what) const {
  throw InputError(place_of(node), what);
}

std::vector<double> XmlInput::numbers(pugi::xml_node node, std::string_view text, std::size_t count,
                                      std::string_view what) const {
  constexpr double largest = 1e9;
  std::vector<double> values;
  const auto wrong = [&](const std::string& why) {
    fail(node,
         fmt::format("{} is '{}': {}, expected {}", what, shown_line(text.substr(0, 100)), why,
                     count == 1 ? "a number" : fmt::format("{} numbers with spaces between them", count)));
  };
  std::string_view rest = text;
  while (true) {
    rest.remove_prefix(std::min(rest.find_first_not_of(blanks), rest.size()));
    if (rest.empty()) break;
    std::string_view word = rest.substr(0, rest.find_first_of(blanks));
    rest.remove_prefix(word.size());
    if (word.starts_with('+')) word.remove_prefix(1);
    double value = 0;
    const char* end = word.data() + word.size();
    const auto read = std::from_chars(word.data(), end, value);
    if (read.ec != std::errc() || read.ptr != end || !std::isfinite(value))
      wrong(fmt::format("'{}' is not a number", shown_line(word.substr(0, 40))));
    if (std::abs(value) > largest) wrong(fmt::format("{} is larger than {:g}", value, largest));
    if (values.size() == count) wrong("there are too many numbers");
    values.push_back(value);
  }
  if (values.size() != count) wrong(fmt::format("there are {} numbers", values.size()));
  return values;
}

double XmlInput::child_number(pugi::xml_node node, const char* child, double otherwise) const {
  const pugi::xml_node found = node.child(child);
  return found ? number(found, found.child_value(), fmt::format("<{}>", child)) : otherwise;
}

double XmlInput::attribute_number(pugi::xml_node node, const char* attribute, double otherwise) const {
  const pugi::xml_attribute found = node.attribute(attribute);
  return found ? number(node, found.value(), fmt::format("{} of <{}>", attribute, name_in(node))) : otherwise;
}

std::string name_in(pugi::xml_node node) { return shown_line(std::string_view(node.name()).substr(0, 80)); }

}  // namespace tubefoot
