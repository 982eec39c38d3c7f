// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/test_mesh.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <random>

namespace tubefoot {

TestMesh shuffled(const TestMesh& mesh, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::vector<std::size_t> place(mesh.vertices.size());  // old index -> new index
  std::iota(place.begin(), place.end(), std::size_t{0});
  std::shuffle(place.begin(), place.end(), random);
  TestMesh result;
  result.vertices.resize(mesh.vertices.size());
  for (std::size_t k = 0; k < place.size(); ++k) result.vertices[place[k]] = mesh.vertices[k];
  for (const auto& facet : mesh.facets) {
    std::array<std::size_t, 3> moved{place[facet[0]], place[facet[1]], place[facet[2]]};
    std::rotate(moved.begin(), moved.begin() + random() % 3, moved.end());
    result.facets.push_back(moved);
  }
  std::shuffle(result.facets.begin(), result.facets.end(), random);
  return result;
}

TestMesh mirrored(const TestMesh& mesh) {
  TestMesh result = mesh;
  for (auto& vertex : result.vertices) vertex[0] = -vertex[0];
  for (auto& facet : result.facets) std::swap(facet[1], facet[2]);
  return result;
}

std::string obj_text(const TestMesh& mesh) {
  std::string text;
  for (const auto& [x, y, z] : mesh.vertices) text += fmt::format("v {:.17g} {:.17g} {:.17g}\n", x, y, z);
  for (const auto& [a, b, c] : mesh.facets) text += fmt::format("f {} {} {}\n", a + 1, b + 1, c + 1);
  return text;
}

}  // namespace tubefoot
