// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/vrt_sources.hpp"

#include <cpl_minixml.h>
#include <fmt/core.h>

#include <algorithm>
#include <fstream>
#include <memory>
#include <set>
#include <string>
#include <string_view>

#include "files/input_error.hpp"
#include "scene/raster_messages.hpp"

namespace tubefoot {
namespace {

namespace fs = std::filesystem;

constexpr int deepest = 8;
constexpr std::uintmax_t most_bytes = 256u << 20;

bool is_vrt(const fs::path& file) {
  std::error_code ignored;
  if (!fs::is_regular_file(file, ignored)) return false;
  std::ifstream stream(file, std::ios::binary);
  std::string head(1024, '\0');  // as much as GDAL looks at
  stream.read(head.data(), static_cast<std::streamsize>(head.size()));
  return head.find("<VRTDataset") != std::string::npos;
}

class Sources {
 public:
  void add(const fs::path& vrt, int depth) {
    const auto fail = [&vrt](const std::string& what) { throw InputError({vrt.string(), 0, 0}, what); };
    if (depth > deepest)
      fail(fmt::format("is a virtual raster within {} others: name its own sources", deepest));
    std::error_code error;
    if (fs::file_size(vrt, error) > most_bytes) fail("is too large for a virtual raster");
    const GdalMessages messages;
    const std::unique_ptr<CPLXMLNode, void (*)(CPLXMLNode*)> root(CPLParseXMLFile(vrt.c_str()),
                                                                  CPLDestroyXMLNode);
    if (root == nullptr) fail("is no virtual raster that can be read" + messages.in_brackets());
    std::vector<const CPLXMLNode*> left{root.get()};
    while (!left.empty()) {
      const CPLXMLNode* node = left.back();
      left.pop_back();
      if (node->psNext != nullptr) left.push_back(node->psNext);
      if (node->eType != CXT_Element) continue;
      if (node->psChild != nullptr) left.push_back(node->psChild);
      const std::string_view name = node->pszValue;
      if (name != "SourceFilename" && name != "SourceDataset") continue;
      const std::string text = CPLGetXMLValue(node, nullptr, "");
      if (text.find("/vsi") != std::string::npos)
        fail(fmt::format("reads '{}' through a virtual file system: fetch or unpack it first",
                         text.substr(0, 200)));
      const bool relative = std::string_view(CPLGetXMLValue(node, "relativeToVRT", "0")) == "1";
      const fs::path source = relative ? vrt.parent_path() / text : fs::path(text);
      if (!known_.insert(source).second) continue;
      list.push_back(source);
      if (is_vrt(source)) add(source, depth + 1);
    }
  }
  std::vector<fs::path> list;

 private:
  std::set<fs::path> known_;
};

}  // namespace

std::vector<fs::path> vrt_sources(const fs::path& file) {
  Sources sources;
  if (is_vrt(file)) sources.add(file, 1);
  return std::move(sources.list);
}

}  // namespace tubefoot
