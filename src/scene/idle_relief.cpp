// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/idle_relief.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>

#include "geometry/mesh/vertex_normals.hpp"

namespace tubefoot {
namespace {

constexpr double least_sine = 0.05;   ///< sine of the angle between displacement and facet: 3 degrees
constexpr double least_share = 0.01;  ///< fraction of a component's area with relief

struct Areas {
  double all = 0, idle = 0;
};

/// Returns whether relief with these directions at the corners leaves a facet in its plane.
bool is_idle(glm::dvec3 normal, const std::array<glm::dvec3, 3>& directions) {
  return std::ranges::all_of(directions,
                             [&](glm::dvec3 way) { return std::abs(glm::dot(normal, way)) < least_sine; });
}

}  // namespace

std::vector<std::string> idle_relief_warnings(const Scene& scene) {
  const auto has_relief = [&](std::uint16_t material) { return scene.relief[material] != nullptr; };
  const FacetMesh& mesh = scene.mesh;
  if (std::ranges::none_of(mesh.material, has_relief)) return {};
  const bool vertical = scene.description.refinement.displace == "vertical";
  const std::vector<glm::dvec3> normals = vertical ? std::vector<glm::dvec3>() : vertex_normals(mesh);
  std::vector<Areas> areas(scene.report.components.size());
  for (FacetId f = 0; f < mesh.facets.size(); ++f) {
    if (!has_relief(mesh.material[f])) continue;
    const glm::dvec3 n = doubled_area(mesh, f);
    const double area = glm::length(n);
    if (!(area > 0)) continue;
    std::array<glm::dvec3, 3> directions;
    directions.fill({0, 0, 1});
    for (std::size_t k = 0; !vertical && k < 3; ++k) directions[k] = normals[mesh.facets[f][k]];
    Areas& of = areas[mesh.component[f]];
    of.all += area;
    if (is_idle(n / area, directions)) of.idle += area;
  }
  std::vector<std::string> warnings;
  for (std::size_t i = 0; i < areas.size(); ++i)
    if (areas[i].idle > least_share * areas[i].all)
      warnings.push_back(fmt::format(
          "'{}': on {:.3g} % of its area with relief, relief moves points only within their facets, so the "
          "area is refined but stays flat: {}",
          scene.report.components[i].name, 100 * areas[i].idle / areas[i].all,
          vertical ? "'displace' in [relief] is \"vertical\", and these facets are vertical: set displace = "
                     "\"normal\" to displace along the normal, or give the facets a material without relief"
                   : "the normals of facets that share vertices cancel: model the surface with only one "
                     "side, or give it a thickness"));
  return warnings;
}

}  // namespace tubefoot
