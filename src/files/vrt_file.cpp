// SPDX-License-Identifier: GPL-3.0-or-later

// Reads a GDAL virtual raster (VRT) as XML, compares its elements and attributes with a list of permitted
// ones, and returns its source files.

#include "files/vrt_file.hpp"

#include <cpl_minixml.h>
#include <fmt/core.h>

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <cstring>
#include <map>
#include <memory>
#include <string>
#include <string_view>

#include "files/absolute_path.hpp"
#include "files/advised_command.hpp"
#include "files/gdal_messages.hpp"
#include "files/input_registry.hpp"
#include "files/library_settings.hpp"

namespace tubefoot {
namespace {

namespace fs = std::filesystem;

constexpr std::uintmax_t most_bytes = 64u << 20;
constexpr std::size_t most_value_bytes = 65536;

std::string lower(std::string_view text) {
  std::string result(text);
  std::ranges::transform(result, result.begin(), [](unsigned char c) { return char(std::tolower(c)); });
  return result;
}

/// Permitted elements of a VRT and their attributes, in lower case, because GDAL ignores case.
const std::map<std::string_view, std::string_view>& allowed_attributes() {
  static const std::map<std::string_view, std::string_view> allowed{
      {"vrtdataset", " rasterxsize rasterysize "},
      {"srs", " dataaxistosrsaxismapping coordinateepoch "},
      {"geotransform", ""},
      {"blockxsize", ""},
      {"blockysize", ""},
      {"metadata", ""},
      {"mdi", " key "},
      {"maskband", ""},
      {"vrtrasterband", " datatype band blockxsize blockysize "},
      {"description", ""},
      {"unittype", ""},
      {"offset", ""},
      {"scale", ""},
      {"nodatavalue", ""},
      {"hidenodatavalue", ""},
      {"colorinterp", ""},
      {"colortable", ""},
      {"entry", " c1 c2 c3 c4 "},
      {"categorynames", ""},
      {"category", ""},
      {"simplesource", " resampling "},
      {"complexsource", " resampling "},
      {"sourcefilename", " relativetovrt shared "},
      {"sourceband", ""},
      {"sourceproperties", " rasterxsize rasterysize datatype blockxsize blockysize "},
      {"srcrect", " xoff yoff xsize ysize "},
      {"dstrect", " xoff yoff xsize ysize "},
      {"nodata", ""},
      {"scaleoffset", ""},
      {"scaleratio", ""},
      {"lut", ""},
      {"exponent", ""},
      {"srcmin", ""},
      {"srcmax", ""},
      {"dstmin", ""},
      {"dstmax", ""},
      {"colortablecomponent", ""},
      {"usemaskband", ""},
      {"histograms", ""},
      {"histitem", ""},
      {"histmin", ""},
      {"histmax", ""},
      {"bucketcount", ""},
      {"includeoutofrange", ""},
      {"approximate", ""},
      {"histcounts", ""},
  };
  return allowed;
}

class VrtReader {
 public:
  explicit VrtReader(const fs::path& vrt)
      : vrt_(vrt), text_(read_whole(vrt, {vrt.string(), 0, 0}, most_bytes, "a virtual raster (VRT)")) {}

  std::vector<fs::path> read() {
    const GdalMessages messages;
    const std::unique_ptr<CPLXMLNode, void (*)(CPLXMLNode*)> root(
        text_.find('\0') == text_.npos ? CPLParseXMLString(text_.c_str()) : nullptr, CPLDestroyXMLNode);
    if (root == nullptr)
      throw InputError({vrt_.string(), 0, 0}, "cannot be read as a virtual raster" + messages.in_brackets());
    // Visits elements depth first, in the order of the file. It does not recurse, because an untrusted file
    // determines the depth.
    std::vector<const CPLXMLNode*> left{root.get()};
    while (!left.empty()) {
      const CPLXMLNode* node = left.back();
      left.pop_back();
      if (node->psNext != nullptr) left.push_back(node->psNext);
      if (node->eType == CXT_Literal) refuse_declaration(node);
      if (node->eType == CXT_Text && std::strlen(node->pszValue) > most_value_bytes)
        throw InputError({vrt_.string(), 0, 0},
                         fmt::format("has a text of more than {} bytes", most_value_bytes));
      if (node->eType != CXT_Element || node->pszValue[0] == '?')
        continue;  // "?" begins a declaration such as <?xml version="1.0"?>
      const std::string name = lower(node->pszValue);
      ++met_[name];
      check(node, name);
      if (name == "sourcefilename") take_source(node, name);
      if (node->psChild != nullptr) left.push_back(node->psChild);
    }
    return std::move(sources_);
  }

 private:
  void check(const CPLXMLNode* node, const std::string& name) const {
    const auto known = allowed_attributes().find(name);
    if (known == allowed_attributes().end())
      fail(name, fmt::format("has an element <{}>, which tubefoot does not read", node->pszValue));
    for (const CPLXMLNode* child = node->psChild; child != nullptr; child = child->psNext) {
      if (child->eType != CXT_Attribute) continue;
      const std::string attribute = lower(child->pszValue);
      if (known->second.find(fmt::format(" {} ", attribute)) == std::string_view::npos)
        fail(name, fmt::format("has <{} {}=\"{}\">, which tubefoot does not read", node->pszValue,
                               child->pszValue, child->psChild == nullptr ? "" : child->psChild->pszValue));
    }
  }

  void refuse_declaration(const CPLXMLNode* node) const {
    throw InputError({vrt_.string(), 0, 0},
                     fmt::format("has a declaration <{}>, which tubefoot does not read: remove it",
                                 std::string_view(node->pszValue).substr(0, 80)));
  }

  void take_source(const CPLXMLNode* node, const std::string& name) {
    const std::string text = CPLGetXMLValue(node, nullptr, "");
    if (text.empty()) fail(name, "has a source without a name");
    // GDAL reads the attribute as true if it is a number other than 0.
    const bool relative = std::atoi(CPLGetXMLValue(node, "relativeToVRT", "0")) != 0;
    if (text.find("/vsi") != text.npos)
      fail(name, fmt::format("reads '{}' through a virtual file system: fetch or unpack it first", text));
    if (text.find("://") != text.npos || text.find('"') != text.npos ||
        (!relative && !fs::path(text).is_absolute()))
      fail(name, fmt::format("names the source '{}', which is neither an absolute file name nor a name "
                             "relative to the VRT (relativeToVRT=\"1\")",
                             text));
    const fs::path source = absolute_path(relative ? vrt_.parent_path() / text : fs::path(text));
    const fs::path plain = plain_name(source);
    // If ".." follows a link, the lexical name and the name on disk refer to two files.
    if (plain_name(source.lexically_normal()) != plain)
      fail(name, fmt::format("names the source '{}', whose path follows a link and then leads back with "
                             "'..': give its direct path",
                             text));
    sources_.push_back(plain);
  }

  /// Throws InputError at the line of the last visited element with this name.
  [[noreturn]] void fail(const std::string& name, const std::string& what) const {
    throw InputError({vrt_.string(), line_of(name, met_.at(name)), 0},
                     fmt::format("{}: build it from plain rasters with `gdalbuildvrt OUT IN...`, or convert "
                                 "it to a plain raster with {}",
                                 what, advised_command("gdal_translate", vrt_)));
  }

  int line_of(const std::string& name, int which) const {
    const std::string text = lower(text_);
    std::size_t at = 0;
    for (; at < text.size(); ++at) {
      if (text.compare(at, 4, "<!--") == 0) at = std::min(text.find("-->", at), text.size() - 1);
      if (text[at] != '<' || text.compare(at + 1, name.size(), name) != 0) continue;
      const std::size_t end = at + 1 + name.size();
      if (end < text.size() && std::string_view(" \t\r\n/>").find(text[end]) == std::string_view::npos)
        continue;
      if (--which == 0) break;
    }
    return 1 +
           static_cast<int>(std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(at), '\n'));
  }

  const fs::path& vrt_;
  std::string text_;
  std::map<std::string, int> met_;
  std::vector<fs::path> sources_;
};

}  // namespace

std::vector<fs::path> vrt_sources(const fs::path& vrt) { return VrtReader(vrt).read(); }

}  // namespace tubefoot
