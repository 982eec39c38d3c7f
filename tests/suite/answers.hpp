// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cmath>
#include <functional>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <string>
#include <vector>

#include "suite/packed.hpp"

// Reads scenes of the benchmark suite and integrates over their triangles, as its README describes them.
namespace tubefoot {

/// A scene of a benchmark suite, with its answer.
struct AnsweredScene {
  AnsweredScene(const std::filesystem::path& suite, const std::string& name)
      : folder(suite / "scenes" / name),
        json(json_in(folder / "scene.json")),
        energy(array_in(suite / "answers" / name / "energy.npy")) {
    if (std::filesystem::exists(suite / "answers" / name / "bound.npy"))
      bound = array_in(suite / "answers" / name / "bound.npy");
  }
  std::filesystem::path folder;
  Json json;
  Array energy, bound;
  double first_m() const { return json["samples"]["first_m"]; }
  double step_m() const { return json["samples"]["step_m"]; }
  double border_deg(std::size_t k) const { return json["beams"]["borders_deg"][k]; }
  glm::dvec3 sonar() const {
    const auto at = json["pings"][0]["position_m"].get<std::array<double, 3>>();
    return {at[0], at[1], at[2]};
  }
};

/// Triangles of a surface of a scene: corners.
inline std::vector<std::array<glm::dvec3, 3>> triangles_of(const AnsweredScene& scene,
                                                           const std::string& obj) {
  const Mesh mesh = mesh_in(scene.folder / obj);
  std::vector<std::array<glm::dvec3, 3>> all;
  for (const auto& facet : mesh.facets) {
    auto& triangle = all.emplace_back();
    for (std::size_t k = 0; k < 3; ++k) {
      const auto& v = mesh.vertices[facet[k]];
      triangle[k] = {v[0], v[1], v[2]};
    }
  }
  return all;
}

/// Integral of f(place, normal) over triangles, by the middles of n x n equal parts.
inline double over(const std::vector<std::array<glm::dvec3, 3>>& triangles, int n,
                   const std::function<double(glm::dvec3, glm::dvec3)>& f) {
  double sum = 0;
  for (const auto& [a, b, c] : triangles) {
    const glm::dvec3 doubled = glm::cross(b - a, c - a);
    const double part = glm::length(doubled) / 2 / (n * n);
    for (int i = 0; i < n; ++i)
      for (int j = 0; i + j < n; ++j)
        for (const double third : {1.0 / 3, 2.0 / 3}) {
          if (third > 0.5 && i + j == n - 1) continue;
          sum += part *
                 f(a + (b - a) * ((i + third) / n) + (c - a) * ((j + third) / n), glm::normalize(doubled));
        }
  }
  return sum;
}

/// mu sin(g1) sin(g2) r1^-2 r2^-2.
inline double scattered(double mu, glm::dvec3 from, glm::dvec3 to, glm::dvec3 at, glm::dvec3 normal) {
  const glm::dvec3 tx = at - from, rx = at - to;
  const double r1 = glm::length(tx), r2 = glm::length(rx);
  return mu * std::abs(glm::dot(tx, normal) / r1 * glm::dot(rx, normal) / r2) / (r1 * r1 * r2 * r2);
}

}  // namespace tubefoot
