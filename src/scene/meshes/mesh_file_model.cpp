// SPDX-License-Identifier: GPL-3.0-or-later

// Reads models of other programs: it checks their size, nesting and buffers, and runs Assimp in a separate
// process with limits. Failures become errors for the user.

#include "scene/meshes/mesh_file_model.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <glm/common.hpp>
#include <system_error>

#include "files/gltf_file.hpp"
#include "files/input_registry.hpp"
#include "files/limits.hpp"
#include "files/memory_at_hand.hpp"
#include "geometry/steps/stop.hpp"
#include "scene/meshes/mesh_file_apart.hpp"

namespace tubefoot {
namespace {

namespace fs = std::filesystem;

constexpr const char* remedy = "export it again, or in another format (OBJ, PLY, STL)";

/// Returns a text without its comments <!-- ... -->.
std::string without_remarks(std::string_view text) {
  std::string result;
  for (;;) {
    const std::size_t begin = text.find("<!--");
    result += text.substr(0, begin);
    if (begin == text.npos) return result;
    const std::size_t end = text.find("-->", begin);
    if (end == text.npos) return result;
    text.remove_prefix(end + 3);
  }
}

/// Returns the text between `from` and the next `to`; empty if either is missing.
std::string_view between(std::string_view text, std::string_view from, std::string_view to) {
  const std::size_t begin = text.find(from);
  if (begin == text.npos) return {};
  text.remove_prefix(begin + from.size());
  const std::size_t end = text.find(to);
  return end == text.npos ? std::string_view() : text.substr(0, end);
}

/// Returns whether XML elements are nested deeper than `most`, because Assimp visits them recursively.
bool nests_deeper(std::string_view xml, std::size_t most) {
  std::size_t depth = 0, steps = 0;
  for (std::size_t at = xml.find('<'); at != xml.npos; at = xml.find('<', at + 1)) {
    if (++steps % 65536 == 0) stop_if_wanted();
    const std::string_view rest = xml.substr(at + 1);
    if (rest.starts_with("!--") || rest.starts_with("![CDATA[")) {
      at = xml.find(rest.starts_with("!--") ? "-->" : "]]>", at);
      if (at == xml.npos) return false;  // nothing follows
    } else if (rest.starts_with('/')) {
      depth -= depth > 0 ? 1 : 0;
    } else if (!rest.starts_with('?') && !rest.starts_with('!')) {
      const std::size_t end = xml.find('>', at);
      if (end == xml.npos) return false;  // not an element either
      if (xml[end - 1] != '/' && ++depth > most) return true;
      at = end;
    }
  }
  return false;
}

/// "./numbers.bin" becomes "numbers.bin".
std::string without_dots(std::string name) {
  while (name.starts_with("./")) name.erase(0, 2);
  return name;
}

/// Returns the file name for Assimp, which selects its behaviour by the extension.
std::string name_for(FileFormat format) {
  switch (format) {
    case FileFormat::collada:
      return "model.dae";
    case FileFormat::gltf:
      return "model.gltf";
    case FileFormat::gltf_binary:
      return "model.glb";
    case FileFormat::studio_3ds:
      return "model.3ds";
    default:
      return "model.fbx";
  }
}

class ModelReader {
 public:
  ModelReader(const fs::path& file, FileFormat format)
      : file_(file), format_(format), place_{file.string(), 0, 0}, main_name_(name_for(format)) {}

  Model read() {
    take(main_name_, file_);
    if (format_ == FileFormat::gltf || format_ == FileFormat::gltf_binary)
      for (const GltfBuffer& buffer : gltf_buffers(file_)) take(without_dots(buffer.uri), buffer.file);
    if (format_ == FileFormat::collada && nests_deeper(bytes_.at(main_name_), limits::model_depth))
      fail(fmt::format("nests its elements more than {} levels deep", limits::model_depth));
    Model model = from_assimp();
    for (std::string& warning : model.polygons.warnings)
      warning = fmt::format("{}: {}", place_.file, warning);
    for (const glm::dvec3& p : model.polygons.points)
      if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z))
        fail("has a coordinate that is not finite");
    if (format_ == FileFormat::collada) model.declared = collada_axes(bytes_.at(main_name_));
    if (format_ == FileFormat::gltf || format_ == FileFormat::gltf_binary) model.declared = {"y", 1.0};
    return model;
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    throw InputError(place_, fmt::format("{}: {}", what, remedy));
  }

  void take(const std::string& name, const fs::path& from) {
    const SourcePlace place{from.string(), 0, 0};
    const std::uintmax_t size = InputFile(from).size();
    total_ += static_cast<double>(size);
    require_memory(memory_a_byte * total_, place, fmt::format("its {} bytes", size),
                   "give a coarser model, or one that is cut to the scene");
    if (bytes_.contains(name) && name == main_name_)
      fail(fmt::format("has a buffer named '{}', a name that tubefoot uses for the file itself", name));
    bytes_[name] = read_whole(from, place, size, "a model that no program is writing");
  }

  Model from_assimp() const {
    // About 20 times Assimp's time for ordinary models.
    constexpr double seconds = 2, seconds_a_byte = 4e-7;
    load_assimp();
    ApartResult result;
    try {
      result = done_apart([this] { return assimp_model(bytes_, main_name_, format_); },
                          seconds + seconds_a_byte * total_,
                          std::min(memory_at_hand(), 1e9 + 20 * memory_a_byte * total_));
    } catch (const std::system_error& error) {
      // These errors are due to the machine, not to the file.
      if (error.code() == std::errc::resource_unavailable_try_again ||
          error.code() == std::errc::not_enough_memory)
        throw;
      fail(fmt::format("cannot be read: {}", error.what()));
    }
    const std::string format(name_of(format_));
    switch (result.end) {
      case ApartResult::End::refused:
        fail(fmt::format("cannot be read as {} (Assimp: {})", format, result.bytes));
      case ApartResult::End::too_long:
        fail(
            fmt::format("keeps Assimp, which reads {}, busy for more than {:.0f} s: the file is damaged, or "
                        "was made to cause this",
                        format, std::ceil(seconds + seconds_a_byte * total_)));
      case ApartResult::End::crashed:
        fail(fmt::format(
            "makes Assimp, which reads {}, crash: the file is damaged, or was made to cause this", format));
      case ApartResult::End::done:
        break;
    }
    try {
      return model_from(result.bytes);
    } catch (const std::runtime_error& error) {
      fail(fmt::format("makes Assimp, which reads {}, fail ({})", format, error.what()));
    }
  }

  /// Memory per byte of a model, for Assimp and for the result.
  static constexpr double memory_a_byte = 8;
  fs::path file_;
  FileFormat format_;
  SourcePlace place_;
  std::string main_name_;
  ModelBytes bytes_;
  double total_ = 0;
};

}  // namespace

DeclaredAxes collada_axes(std::string_view content) {
  // The first <asset> belongs to the file; those of its parts follow later.
  const std::string head =
      without_remarks(content.substr(0, std::min(content.find("</asset>"), content.size())));
  const std::size_t begin = head.find("<asset");
  DeclaredAxes axes;
  if (begin == head.npos || content.find("</asset>") == content.npos) return axes;
  const std::string_view asset = std::string_view(head).substr(begin);
  const std::string_view up = between(asset, "<up_axis>", "</up_axis>");
  for (const auto& [word, axis] : {std::pair("X_UP", "x"), std::pair("Y_UP", "y"), std::pair("Z_UP", "z")})
    if (up.find(word) != up.npos) axes.up = axis;
  std::string_view metre = between(asset, "<unit", ">");
  const std::size_t quote = std::min(metre.find("meter=\""), metre.find("meter='"));
  if (asset.find("<unit") == asset.npos) axes.default_unit_m = 1;
  if (quote == metre.npos) return axes;
  metre.remove_prefix(quote + 7);
  double unit_m = 0;
  const auto [end, error] = std::from_chars(metre.data(), metre.data() + metre.size(), unit_m);
  if (error == std::errc() && std::isfinite(unit_m) && unit_m > 0) axes.unit_m = unit_m;
  return axes;
}

Model read_model(const fs::path& file, FileFormat format) { return ModelReader(file, format).read(); }

}  // namespace tubefoot
