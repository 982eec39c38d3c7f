// SPDX-License-Identifier: GPL-3.0-or-later

// Checks a glTF (JSON or binary) before Assimp reads it, and lists its buffers. It limits nesting,
// repetition of meshes and the number and depth of nodes, and rejects required extensions, except those
// known to keep the geometry.

#include "files/gltf_file.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cctype>
#include <cstdint>
#include <cstring>
#include <nlohmann/json.hpp>
#include <set>
#include <string_view>
#include <system_error>

#include "files/absolute_path.hpp"
#include "files/companions.hpp"
#include "files/file_format.hpp"
#include "files/input_registry.hpp"
#include "files/limits.hpp"
#include "geometry/steps/long_call.hpp"

namespace tubefoot {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr std::size_t most_words = std::size_t{256} << 20;
constexpr int most_nesting = 64;

/// Extensions that change only materials and textures, or add no information that is read.
constexpr std::string_view harmless_extensions[] = {"KHR_materials_", "KHR_texture_", "EXT_texture_",
                                                    "KHR_lights_", "KHR_xmp"};

class GltfReader {
 public:
  explicit GltfReader(const fs::path& gltf) : gltf_(gltf), place_{gltf.string(), 0, 0} {}

  std::vector<GltfBuffer> read() {
    const json root = parsed(words());
    if (!root.is_object()) fail("is not a glTF: its JSON is not an object");
    const std::string version = text_of(root, "asset", "version");
    if (!version.starts_with("2.")) fail(fmt::format("has the glTF version '{}', expected 2.0", version));
    refuse_extensions(root);
    refuse_other_positions(root);
    std::vector<GltfBuffer> buffers;
    std::set<std::string> known;
    std::uint64_t bytes = InputFile(gltf_).size();
    for (const json& buffer : list_of(root, "buffers")) {
      const std::string uri = text_of(buffer, "uri");
      if (uri.empty() || uri.starts_with("data:") || !known.insert(uri).second) continue;
      buffers.push_back({uri, file_of(uri)});
      std::error_code ignored;
      bytes += fs::file_size(buffers.back().file, ignored);
    }
    refuse_repetition(root, bytes);
    return buffers;
  }

 private:
  [[noreturn]] void fail(const std::string& what) const { throw InputError(place_, what); }

  std::string words() const {
    if (format_of(gltf_) == FileFormat::gltf)
      return read_whole(gltf_, place_, most_words, "a glTF (JSON with its numbers in buffers)");
    // The file has 12 bytes of header, then chunks with length, kind and content. The first chunk is JSON.
    constexpr std::size_t header = 20;
    InputFile input(gltf_);
    const std::string head = input.head(header);
    std::uint32_t length = 0;
    if (head.size() == header) std::memcpy(&length, head.data() + 12, sizeof length);
    if (head.size() < header || head.substr(16, 4) != "JSON" || length > most_words ||
        length > input.size() - header)
      fail("is not a binary glTF 2.0, or is cut off: it does not begin with a JSON chunk");
    return input.head(header + length).substr(header);
  }

  json parsed(const std::string& text) const {
    refuse_nesting(text);
    const auto parse = [its = text.starts_with("\xef\xbb\xbf") ? text.substr(3) : text] {
      return json::parse(its);
    };
    constexpr std::size_t long_text = std::size_t{1} << 20;
    try {
      return text.size() < long_text ? parse() : long_call(parse);
    } catch (const json::exception& error) {
      fail(fmt::format("cannot be read as glTF: {}", error.what()));
    }
  }

  /// Rejects deep nesting before the text is parsed, because a parser scans a list again for each of its
  /// elements.
  void refuse_nesting(std::string_view text) const {
    int depth = 0;
    bool in_string = false;
    for (std::size_t at = 0; at < text.size(); ++at) {
      if (at % 65536 == 0) stop_if_wanted();
      const char c = text[at];
      if (in_string) {
        if (c == '\\') ++at;
        in_string = c != '"';
      } else if (c == '"') {
        in_string = true;
      } else if (c == '{' || c == '[') {
        if (++depth > most_nesting) fail(fmt::format("nests values more than {} levels deep", most_nesting));
      } else if (c == '}' || c == ']') {
        --depth;
      }
    }
  }

  /// Returns the list with this key, or an empty one.
  const json& list_of(const json& value, const char* key) const {
    static const json none = json::array();
    if (!value.is_object()) return none;
    const auto found = value.find(key);
    if (found == value.end()) return none;
    if (!found->is_array()) fail(fmt::format("has '{}', which is not a list", key));
    return *found;
  }

  /// Throws if positions are not floats. Whole numbers need KHR_mesh_quantization, and Assimp would read
  /// their bits as floats. References to missing accessors are left to Assimp.
  void refuse_other_positions(const json& root) const {
    constexpr int float_numbers = 5126;
    const json& accessors = list_of(root, "accessors");
    const auto is_other = [&](const json& attributes) {
      const auto found = attributes.is_object() ? attributes.find("POSITION") : attributes.end();
      if (!attributes.is_object() || found == attributes.end() || !found->is_number_unsigned() ||
          found->get<std::uint64_t>() >= accessors.size())
        return false;
      const json& accessor = accessors[found->get<std::size_t>()];
      return !accessor.is_object() || accessor.value("componentType", json()) != float_numbers;
    };
    const json& meshes = list_of(root, "meshes");
    for (std::size_t m = 0; m < meshes.size(); ++m) {
      stop_if_wanted();
      const json& primitives = list_of(meshes[m], "primitives");
      for (std::size_t p = 0; p < primitives.size(); ++p)
        if ((primitives[p].is_object() && is_other(primitives[p].value("attributes", json()))) ||
            std::ranges::any_of(list_of(primitives[p], "targets"), is_other))
          fail(
              fmt::format("meshes[{}].primitives[{}]: the positions are not floats, expected the component "
                          "type {}: export positions as floats, without quantisation",
                          m, p, float_numbers));
    }
  }

  /// Throws if the model refers to its own parts so often that it expands to far more data than its bytes
  /// explain. It also throws if the nodes are not trees of a permitted depth.
  void refuse_repetition(const json& root, std::uint64_t bytes) const {
    const std::uint64_t most = bytes + limits::model_repeated;
    const json& accessors = list_of(root, "accessors");
    const auto count_of = [&](const json& number) -> std::uint64_t {
      if (!number.is_number_unsigned() || number.get<std::uint64_t>() >= accessors.size()) return 0;
      const json& accessor = accessors[number.get<std::size_t>()];
      const auto count = accessor.is_object() ? accessor.find("count") : accessor.end();
      return accessor.is_object() && count != accessor.end() && count->is_number_unsigned()
                 ? std::min(count->get<std::uint64_t>(), most + 1)
                 : 0;
    };
    const auto add = [most](std::uint64_t& sum, std::uint64_t more) { sum = std::min(sum + more, most + 1); };
    const auto add_all = [&](std::uint64_t& sum, const json& attributes) {
      if (attributes.is_object())
        for (const json& accessor : attributes) add(sum, count_of(accessor));
    };
    std::uint64_t read = 0;
    std::vector<std::uint64_t> placed_by;  // number of nodes that place each mesh
    for (const json& mesh : list_of(root, "meshes")) {
      stop_if_wanted();
      placed_by.push_back(0);
      for (const json& primitive : list_of(mesh, "primitives")) {
        if (!primitive.is_object()) continue;
        const json attributes = primitive.value("attributes", json());
        const std::uint64_t corners = count_of(primitive.value("indices", json()));
        add(read, corners);
        add_all(read, attributes);
        for (const json& target : list_of(primitive, "targets")) add_all(read, target);
        add(placed_by.back(), corners);
        if (attributes.is_object()) add(placed_by.back(), count_of(attributes.value("POSITION", json())));
      }
      if (read > most)
        fail(fmt::format(
            "meshes[{}]: the primitives and morph targets up to here refer to more than {} values, too many "
            "for the {} bytes of the file: export each mesh with its own vertices, without morph targets",
            placed_by.size() - 1, most, bytes));
    }
    refuse_nodes(root, placed_by, most);
  }

  void refuse_nodes(const json& root, const std::vector<std::uint64_t>& placed_by, std::uint64_t most) const {
    const json& nodes = list_of(root, "nodes");
    const auto index_in = [](const json& number, std::size_t size) {
      return number.is_number_unsigned() && number.get<std::uint64_t>() < size ? number.get<std::size_t>()
                                                                               : size;
    };
    if (nodes.size() > limits::gltf_nodes)
      fail(fmt::format("nodes[{}]: there are more than {} nodes: merge their meshes", limits::gltf_nodes,
                       limits::gltf_nodes));
    std::vector<std::size_t> parent(nodes.size(), nodes.size());
    std::uint64_t placed = 0;
    for (std::size_t k = 0; k < nodes.size(); ++k) {
      if (k % 65536 == 0) stop_if_wanted();
      if (!nodes[k].is_object()) continue;
      for (const json& child : list_of(nodes[k], "children")) {
        const std::size_t number = index_in(child, nodes.size());
        if (number == nodes.size()) continue;
        if (parent[number] != nodes.size())
          fail(fmt::format(
              "nodes[{}] is a child of nodes[{}] and of nodes[{}]: the nodes of a glTF must form trees",
              number, parent[number], k));
        parent[number] = k;
      }
      const std::size_t mesh = index_in(nodes[k].value("mesh", json()), placed_by.size());
      if (mesh < placed_by.size()) placed += std::min(placed_by[mesh], most + 1);
      if (placed > most)
        fail(fmt::format(
            "nodes[{}]: the instances of meshes up to here have more than {} vertices and corners, too many "
            "for the size of the file: export fewer instances, or give each its own facets",
            k, most));
    }
    for (const json& scene : list_of(root, "scenes")) {
      std::set<std::size_t> roots;
      for (const json& node : list_of(scene, "nodes")) {
        const std::size_t number = index_in(node, nodes.size());
        if (number < nodes.size() && (parent[number] != nodes.size() || !roots.insert(number).second))
          fail(fmt::format(
              "nodes[{}] is a root of a scene twice, or is also a child: the nodes of a glTF must form trees",
              number));
      }
    }
    refuse_depth(parent);
  }

  /// Follows each node to an ancestor of known depth, so that every node is visited once.
  void refuse_depth(const std::vector<std::size_t>& parent) const {
    const std::size_t none = parent.size();
    std::vector<std::size_t> depth(parent.size(), 0), way;
    for (std::size_t k = 0; k < parent.size(); ++k) {
      way.clear();
      std::size_t at = k;
      while (at != none && depth[at] == 0) {
        way.push_back(at);
        if (way.size() > limits::model_depth) break;
        at = parent[at];
      }
      std::size_t above = at == none ? 0 : depth[at];
      if (way.size() + above > limits::model_depth)
        fail(
            fmt::format("nodes[{}] is nested in more than {} other nodes, or in itself: flatten the nodes "
                        "when you export the file",
                        k, limits::model_depth));
      for (std::size_t w = way.size(); w-- > 0;) depth[way[w]] = ++above;
    }
  }

  /// Returns the text with this key, or an empty one.
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
        fail(
            fmt::format("needs the extension '{}', which tubefoot does not read: export the file without it "
                        "(with plain buffers)",
                        name));
    }
  }

  /// Replaces escapes such as %20 by their bytes.
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
          fmt::format("refers to the buffer '{}', which is neither in the folder of the glTF file nor below "
                      "it: copy the buffer there, and use a relative name",
                      uri));
    const fs::path file = absolute_path(gltf_).parent_path() / name;
    std::error_code ignored;
    if (!fs::is_regular_file(file, ignored))
      fail(fmt::format(
          "refers to the buffer '{}', which is missing: copy the buffer file together with the glTF", uri));
    if (const auto outside = place_outside(gltf_.parent_path(), file))
      fail(
          fmt::format("refers to the buffer '{}', which is a link to '{}', outside of the folder: copy the "
                      "buffer into the folder",
                      uri, outside->string()));
    return file;
  }

  fs::path gltf_;
  SourcePlace place_;
};

}  // namespace

std::vector<GltfBuffer> gltf_buffers(const fs::path& gltf) { return GltfReader(gltf).read(); }

}  // namespace tubefoot
