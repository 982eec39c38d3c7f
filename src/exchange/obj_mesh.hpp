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

/// "x y z": the shortest decimals that read as the same doubles; -0 is 0.
std::string numbers_text(glm::dvec3 v);

/// A Wavefront OBJ, object after object. Coordinates are as given; readers of doubles get the same bits.
class ObjMesh {
 public:
  /// `words`: of any lines, go above it as comments.
  ObjMesh(const std::filesystem::path& file, std::string_view words);
  /// Goes between objects: "mtllib ...".
  void line(std::string_view text);
  /// `material`: of usemtl; empty: none. Names are written as they are: without line ends, please. `normals`:
  /// each triangle with its own, for engines that make none.
  void object(std::string_view name, std::string_view material, std::span<const glm::dvec3> points,
              std::span<const std::array<std::uint32_t, 3>> triangles, bool normals = false);
  /// Throws std::runtime_error where the disk refuses, as all of it does.
  void close() { file_.close(); }

 private:
  void flush(bool always);

  StreamedFile file_;
  std::string text_;
  std::uint64_t points_ = 0, normals_ = 0;
};

/// `#` and a space before each line of a text.
std::string commented(std::string_view text);

}  // namespace tubefoot
