// SPDX-License-Identifier: GPL-3.0-or-later
#include "exchange/obj_mesh.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <iterator>

#include "exchange/plain_number.hpp"
#include "files/shown.hpp"
#include "geometry/steps/stop.hpp"

namespace tubefoot {

std::string numbers_text(glm::dvec3 v) {
  const double largest = std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
  return fmt::format("{} {} {}", plain(v.x, largest), plain(v.y, largest), plain(v.z, largest));
}

std::string commented(std::string_view text) {
  std::string out;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    const std::string_view line = text.substr(0, end);
    out += line.empty() ? "#\n" : fmt::format("# {}\n", harmless(line));
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return out;
}

ObjMesh::ObjMesh(const std::filesystem::path& file, std::string_view words)
    : file_(file), text_(commented(words)) {
  flush(true);
}

void ObjMesh::flush(bool always) {
  constexpr std::size_t piece = std::size_t{1} << 20;
  if (!always && text_.size() < piece) return;
  stop_if_wanted();
  file_.append(std::string_view(text_));
  text_.clear();
}

void ObjMesh::line(std::string_view text) {
  text_ += fmt::format("{}\n", text);
  flush(true);
}

void ObjMesh::object(std::string_view name, std::string_view material, std::span<const glm::dvec3> points,
                     std::span<const std::array<std::uint32_t, 3>> triangles, bool normals) {
  const auto out = [&] { return std::back_inserter(text_); };
  text_ += fmt::format("o {}\n", name);
  for (const glm::dvec3& p : points) {
    fmt::format_to(out(), "v {} {} {}\n", p.x, p.y, p.z);
    flush(false);
  }
  if (!material.empty()) text_ += fmt::format("usemtl {}\n", material);
  for (const auto& [a, b, c] : triangles) {
    const std::uint64_t i = points_ + a + 1, j = points_ + b + 1, k = points_ + c + 1;
    if (normals) {
      // Normals are used for shading only, so that floats suffice. A triangle without area has an arbitrary
      // one.
      glm::dvec3 n = glm::cross(points[b] - points[a], points[c] - points[a]);
      n = glm::length(n) > 0 ? glm::normalize(n) : glm::dvec3(0, 0, 1);
      ++normals_;
      fmt::format_to(out(), "vn {:.7g} {:.7g} {:.7g}\nf {}//{} {}//{} {}//{}\n", n.x + 0.0, n.y + 0.0,
                     n.z + 0.0, i, normals_, j, normals_, k, normals_);
    } else {
      fmt::format_to(out(), "f {} {} {}\n", i, j, k);
    }
    flush(false);
  }
  points_ += points.size();
  flush(true);
}

}  // namespace tubefoot
