// SPDX-License-Identifier: GPL-3.0-or-later
// Places the sonars of imported scenes: not on facets, with a remark on objects around them. It uses the
// exact predicates of `check` on the facets above, below and at a sonar.
#include "exchange/readers/sonar_places.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <numbers>

#include "files/shown.hpp"
#include "geometry/search/vertical_line.hpp"
#include "scene/scene.hpp"

namespace tubefoot {
namespace {

constexpr double step_m = 1e-3;  ///< what `check` recommends for a sensor on a facet

/// Returns the facets whose boxes contain the vertical through a point.
std::vector<FacetId> facets_at(const FacetMesh& mesh, GridPoint point) {
  std::vector<FacetId> near;
  for (FacetId f = 0; f < mesh.facets.size(); ++f) {
    const auto& [a, b, c] = mesh.facets[f];
    const GridPoint &p = mesh.vertices[a], &q = mesh.vertices[b], &r = mesh.vertices[c];
    const auto spans = [](auto at, auto u, auto v, auto w) {
      return std::min({u, v, w}) <= at && at <= std::max({u, v, w});
    };
    if (spans(point.x, p.x, q.x, r.x) && spans(point.y, p.y, q.y, r.y)) near.push_back(f);
  }
  return near;
}

std::optional<FacetContact> contact_of(glm::dvec3 position_m, const Scene& loaded) {
  const GridPoint point = loaded.grid.snap(position_m);
  return contact_at(loaded.mesh, facets_at(loaded.mesh, point), point);
}

/// Moves a sonar that lies on a facet: up, ahead or to starboard, whichever first leaves all facets. Adds a
/// remark, and returns whether the sonar moved.
bool move_off_facets(ImportedScene& scene, ImportedSensor& sonar, const Scene& loaded) {
  const auto contact = contact_of(sonar.own.position_m, loaded);
  if (!contact) return false;
  constexpr int most_steps = 10;
  for (int k = 1; k <= most_steps; ++k)
    for (const auto& [direction, words] :
         {std::pair(glm::dvec3(0, 0, 1), "higher"), std::pair(sonar.own.turn[1], "further ahead"),
          std::pair(sonar.own.turn[0], "further to starboard")}) {
      const double length_m = k * std::max(step_m, loaded.grid.unit_m());
      const glm::dvec3 moved_m = sonar.own.position_m + length_m * direction;
      if (contact_of(moved_m, loaded)) continue;
      sonar.own.position_m = moved_m;
      scene.noticed.push_back(fmt::format(
          "sonar '{}' lies exactly on the surface of '{}', from which nothing is visible: scene.toml has it "
          "{:.3g} m {}",
          sonar.name, shown_line(loaded.report.components[contact->component].name), length_m, words));
      return true;
    }
  return false;
}

/// Places a sonar south of the objects and above them. It looks at the middle of their box.
void look_at_all(ImportedSensor& sonar, const Scene& loaded) {
  glm::dvec3 lo = loaded.report.components.front().lo_m, hi = loaded.report.components.front().hi_m;
  for (const ComponentReport& component : loaded.report.components) {
    lo = glm::min(lo, component.lo_m);
    hi = glm::max(hi, component.hi_m);
  }
  constexpr double depression_rad = std::numbers::pi / 6, farthest_m = 100'000;
  const double radius_m = glm::length(hi - lo) / 2, distance_m = 1 + 1.2 * radius_m;
  const double sine = std::sin(depression_rad), cosine = std::cos(depression_rad);
  sonar.own.position_m = (lo + hi) / 2.0 + distance_m * glm::dvec3(0, -cosine, sine);
  sonar.own.turn = glm::dmat3(glm::dvec3(1, 0, 0), glm::dvec3(0, cosine, -sine), glm::dvec3(0, sine, cosine));
  sonar.keys.emplace_back("range_max_m",
                          fmt::format("{:.6g}", std::min(farthest_m, distance_m + 1.1 * radius_m)));
}

void report_enclosure(ImportedScene& scene, const ImportedSensor& sonar, const Scene& loaded) {
  const GridPoint point = loaded.grid.snap(sonar.own.position_m);
  for (const VerticalCrossings& crossing :
       vertical_crossings(loaded.mesh, facets_at(loaded.mesh, point), point))
    if (crossing.above % 2 == 1 && crossing.below % 2 == 1)
      scene.noticed.push_back(
          fmt::format("sonar '{0}' is inside object '{1}', so it sees only the inside of this object: remove "
                      "'{1}' from scene.toml if it is the housing of the sonar, or move the sonar",
                      sonar.name, shown_line(loaded.report.components[crossing.component].name)));
}

}  // namespace

ImportedSensor example_sonar() { return {"example", {{"kind", "\"imaging\""}}, {}}; }

bool place_sonars(ImportedScene& scene, const Scene& loaded) {
  if (loaded.report.components.empty()) return false;
  bool moved = false;
  if (scene.sensors.empty()) {
    scene.sensors.push_back(example_sonar());
    look_at_all(scene.sensors.front(), loaded);
    scene.noticed.push_back(
        "no sonar was found: scene.toml has an example sonar south of the objects, which looks north and 30 "
        "degrees down");
    moved = true;
  }
  for (ImportedSensor& sonar : scene.sensors) {
    moved = move_off_facets(scene, sonar, loaded) || moved;
    report_enclosure(scene, sonar, loaded);
  }
  return moved;
}

}  // namespace tubefoot
