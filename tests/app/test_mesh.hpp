// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

namespace tubefoot {

/// A mesh as tests make it up, to be written as an OBJ file.
struct TestMesh {
  std::vector<std::array<double, 3>> vertices;
  std::vector<std::array<std::size_t, 3>> facets;  ///< vertex indices from 0
};

/// A square bed about the origin, cells x cells, two facets each. Heights are rounded to 2^-16 m; choose
/// cells of a dyadic width, and every vertex lies on any world grid of that unit or finer.
template <typename Height>
TestMesh relief(double side_m, std::size_t cells, Height height) {
  TestMesh mesh;
  const auto place = [&](std::size_t k) {
    return side_m * static_cast<double>(k) / static_cast<double>(cells) - side_m / 2;
  };
  for (std::size_t row = 0; row <= cells; ++row)
    for (std::size_t column = 0; column <= cells; ++column)
      mesh.vertices.push_back(
          {place(column), place(row), std::round(height(place(column), place(row)) * 65536) / 65536});
  for (std::size_t row = 0; row < cells; ++row)
    for (std::size_t column = 0; column < cells; ++column) {
      const std::size_t corner = row * (cells + 1) + column, above = corner + cells + 1;
      mesh.facets.push_back({corner, corner + 1, above + 1});
      mesh.facets.push_back({corner, above + 1, above});
    }
  return mesh;
}

/// Same mesh, facets and vertices in another order, facets' corners rotated.
TestMesh shuffled(const TestMesh& mesh, std::uint32_t seed);

/// Mirrored at the plane east = 0, facets turned so that they keep their upper side.
TestMesh mirrored(const TestMesh& mesh);

std::string obj_text(const TestMesh& mesh);

}  // namespace tubefoot
