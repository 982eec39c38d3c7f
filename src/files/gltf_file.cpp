// SPDX-License-Identifier: GPL-3.0-or-later
#include "files/gltf_file.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cctype>
#include <cstdint>
#include <cstring>
#include <nlohmann/json.hpp>
#include <string_view>
#include <system_error>

#include "files/absolute_path.hpp"
#include "files/companions.hpp"
#include "files/file_format.hpp"
#include "files/inlet.hpp"
#include "files/limits.hpp"

namespace tubefoot {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr std::size_t most_words = std::size_t{256} << 20;
constexpr int most_nesting = 64;

/// What changes materials and textures only, or says no more than what is read anyway.
constexpr std::string_view harmless_extensions[] = {"KHR_materials_", "KHR_texture_", "EXT_texture_",
                                                    "KHR_lights_", "KHR_xmp"};

class GltfReader {
 public:
  explicit GltfReader(const fs::path& gltf) : gltf_(gltf), place_{gltf.string(), 0, 0} {}

  std::vector<GltfBuffer> read() {
    const json root = parsed(words());
    if (!root.is_object()) fail("is no glTF: its JSON is no object");
    const std::string version = text_of(root, "asset", "version");
    if (!version.starts_with("2.")) fail(fmt::format("is glTF of version '{}', expected 2.0", version));
    refuse_extensions(root);
    std::vector<GltfBuffer> buffers;
    const auto list = root.find("buffers");
    if (list == root.end()) return buffers;
    if (!list->is_array()) fail("has 'buffers' that are no list");
    for (const json& buffer : *list) {
      const std::string uri = text_of(buffer, "uri");
      if (!uri.empty() && !uri.starts_with("data:")) buffers.push_back({uri, file_of(uri)});
    }
    return buffers;
  }

 private:
  [[noreturn]] void fail(const std::string& what) const { throw InputError(place_, what); }

  std::string words() const {
    if (format_of(gltf_) == FileFormat::gltf)
      return read_whole(gltf_, place_, most_words, "a glTF (JSON; its numbers in buffers)");
    // 12 bytes of header, then chunks: length, kind, content. The first is JSON.
    constexpr std::size_t header = 20;
    InputFile input(gltf_);
    const std::string head = input.head(header);
    std::uint32_t length = 0;
    if (head.size() == header) std::memcpy(&length, head.data() + 12, sizeof length);
    if (head.size() < header || head.substr(16, 4) != "JSON" || length > most_words ||
        length > input.size() - header)
      fail("is no binary glTF 2.0, or cut off: it does not begin with its words (JSON)");
    return input.head(header + length).substr(header);
  }

  json parsed(const std::string& text) const {
    const auto not_too_deep = [this](int depth, json::parse_event_t, json&) {
      if (depth > most_nesting) fail(fmt::format("nests values deeper than {}", most_nesting));
      return true;
    };
    try {
      return json::parse(text.starts_with("\xef\xbb\xbf") ? text.substr(3) : text, not_too_deep);
    } catch (const json::exception& error) {
      fail(fmt::format("is no glTF that can be read: {}", error.what()));
    }
  }

  /// Empty where there is none.
  static std::string text_of(const json& value, const char* key) {
    if (!value.is_object()) return {};
    const auto found = value.find(key);
    return found != value.end() && found->is_string() ? found->get<std::string>() : std::string();
  }
  static std::string text_of(const json& value, const char* outer, const char* key) {
    const auto found = value.find(outer);
    return found == value.end() ? std::string() : text_of(*found, key);
  }

  void refuse_extensions(const json& root) const {
    const auto required = root.find("extensionsRequired");
    if (required == root.end() || !required->is_array()) return;
    for (const json& extension : *required) {
      const std::string name = extension.is_string() ? extension.get<std::string>() : std::string();
      const auto begins = [&](std::string_view with) { return name.starts_with(with); };
      if (std::ranges::none_of(harmless_extensions, begins))
        fail(fmt::format("needs the extension '{}', which is not read: export it without (plain buffers)",
                         name));
    }
  }

  /// %20 and its like are the bytes that they stand for.
  static std::string decoded(const std::string& uri) {
    std::string text;
    for (std::size_t i = 0; i < uri.size(); ++i) {
      const auto is_hex = [&](std::size_t at) {
        return at < uri.size() && std::isxdigit(static_cast<unsigned char>(uri[at])) != 0;
      };
      if (uri[i] == '%' && is_hex(i + 1) && is_hex(i + 2)) {
        text += static_cast<char>(std::stoi(uri.substr(i + 1, 2), nullptr, 16));
        i += 2;
      } else {
        text += uri[i];
      }
    }
    return text;
  }

  fs::path file_of(const std::string& uri) const {
    const fs::path name = decoded(uri);
    const bool climbs = std::ranges::find(name, fs::path("..")) != name.end();
    if (name.is_absolute() || climbs || uri.find(':') != uri.npos ||
        name.string().find('\0') != std::string::npos)
      fail(
          fmt::format("names the buffer '{}', which is no file in its folder or below: copy it there, and "
                      "name it relative to the glTF",
                      uri));
    const fs::path file = absolute_path(gltf_).parent_path() / name;
    std::error_code ignored;
    if (!fs::is_regular_file(file, ignored))
      fail(fmt::format("names the buffer '{}', which is not there: it comes with the glTF", uri));
    if (const auto outside = place_outside(gltf_.parent_path(), file))
      fail(fmt::format("names the buffer '{}', which is a link out of its folder, to '{}': copy it there",
                       uri, outside->string()));
    return file;
  }

  fs::path gltf_;
  SourcePlace place_;
};

}  // namespace

std::vector<GltfBuffer> gltf_buffers(const fs::path& gltf) { return GltfReader(gltf).read(); }

}  // namespace tubefoot
