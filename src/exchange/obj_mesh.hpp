// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <string>
#include <string_view>

#include "files/streamed_file.hpp"

namespace tubefoot {

/// Formats "x y z" as plain() numbers.
std::string numbers_text(glm::dvec3 v);

/// Writes a Wavefront OBJ object by object. Coordinates are written as given, so that readers that use
/// doubles get the same bits.
class ObjMesh {
 public:
  /// `words`: lines of a comment at the beginning of the file.
  ObjMesh(const std::filesystem::path& file, std::string_view words);
  /// Writes a line between objects: "mtllib ...".
  void line(std::string_view text);
  /// Writes an object. `material`: name for usemtl; empty: none. Names are written unchanged and must not
  /// contain line breaks. `normals`: writes a normal for each triangle, for engines that do not compute
  /// them.
  void object(std::string_view name, std::string_view material, std::span<const glm::dvec3> points,
              std::span<const std::array<std::uint32_t, 3>> triangles, bool normals = false);
  /// Throws std::runtime_error on a write error, as all functions of the class do.
  void close() { file_.close(); }

 private:
  void flush(bool always);

  StreamedFile file_;
  std::string text_;
  std::uint64_t points_ = 0, normals_ = 0;
};

/// Returns a text with `#` and a space before each line.
std::string commented(std::string_view text);

}  // namespace tubefoot
