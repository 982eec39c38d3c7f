// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/tubes/tube_finder.hpp"

#include <algorithm>
#include <cmath>

#include "geometry/mesh/facet_cone.hpp"

namespace tubefoot {
namespace {

/// Returns a point of a face of the cube [-1, 1]^3. On this face the coordinate face / 2 is 1 for an even and
/// -1 for an odd number.
glm::dvec3 on_face(std::size_t face, double u, double v) {
  const std::size_t axis = face / 2;
  glm::dvec3 p;
  p[int(axis)] = face % 2 == 0 ? 1 : -1;
  p[int((axis + 1) % 3)] = u;
  p[int((axis + 2) % 3)] = v;
  return p;
}

}  // namespace

TubeFinder::TubeFinder(const TubeSet& tubes) {
  for (const Tube& tube : tubes.tubes) {
    Walls& walls = walls_.emplace_back();
    for (std::size_t k = 0; k < 4; ++k) {
      const std::uint32_t a = tube[k], b = tube[(k + 1) % 4];
      const Vec64 n = cross(tubes.rays[a], tubes.rays[b]);
      const glm::dvec3 normal{double(n.x), double(n.y), double(n.z)};
      const double length = glm::length(normal);
      // Neighbours traverse their common wall in opposite directions, so their normals are opposite to the
      // last bit.
      walls[k] = length > 0 ? Wall{normal / length, a < b} : Wall{glm::dvec3(0), true};
    }
  }
  cells_ = std::clamp(int(std::sqrt(double(walls_.size())) / 2), 2, 24);
  const double edge = 2.0 / cells_;
  begin_.push_back(0);
  for (std::size_t face = 0; face < 6; ++face)
    for (int row = 0; row < cells_; ++row)
      for (int column = 0; column < cells_; ++column) {
        const double u = column * edge - 1, v = row * edge - 1;
        const glm::dvec3 axis = glm::normalize(on_face(face, u + edge / 2, v + edge / 2));
        double cosine = 1;
        for (const double du : {0.0, edge})
          for (const double dv : {0.0, edge})
            cosine = std::min(cosine, glm::dot(axis, glm::normalize(on_face(face, u + du, v + dv))));
        const double sine = std::sqrt(1 - cosine * cosine) + 1e-9;
        for (std::uint32_t tube = 0; tube < walls_.size(); ++tube)
          if (std::ranges::all_of(walls_[tube],
                                  [&](const Wall& wall) { return glm::dot(wall.normal, axis) >= -sine; }))
            in_cells_.push_back(tube);
        begin_.push_back(std::uint32_t(in_cells_.size()));
      }
}

std::size_t TubeFinder::cell_of(glm::dvec3 d) const {
  const glm::dvec3 size = glm::abs(d);
  const std::size_t axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  const double along = size[int(axis)];
  const auto cell = [&](double x) {
    return std::size_t(std::clamp(int((x / along + 1) / 2 * cells_), 0, cells_ - 1));
  };
  const std::size_t face = 2 * axis + (d[int(axis)] > 0 ? 0 : 1), column = cell(d[int((axis + 1) % 3)]),
                    row = cell(d[int((axis + 2) % 3)]);
  return (face * std::size_t(cells_) + row) * std::size_t(cells_) + column;
}

}  // namespace tubefoot
