// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/placement.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <optional>

#include "geometry/search/vertical_line.hpp"
#include "run/scene_below.hpp"
#include "run/transmission_surface.hpp"
#include "scene/extent.hpp"

// This file checks the plausibility of a scene before a run. It reports objects that are buried, float above
// the seabed or have other units than the terrain. It also reports range gates that extend far beyond all
// facets.

namespace tubefoot {
namespace {

/// The seabed above and below given positions, one position after another.
class Seabed {
 public:
  explicit Seabed(const LoadedScene& loaded_scene) : below_(loaded_scene) {}

  /// Returns the height of a position above the highest terrain there; negative below it. Empty outside of
  /// all terrain.
  std::optional<double> height_over_m(glm::dvec3 place_m) {
    const LoadedScene& loaded_scene = below_.in_line_with(place_m);
    const TransmissionSurface surface_mesh =
        surface_in_line_with(loaded_scene, place_m, loaded_scene.scene.first_ping_s);
    const GridPoint point = loaded_scene.scene.grid.snap(place_m);
    std::vector<FacetId> near;
    facets_near_vertical(surface_mesh.tree(), point, near);
    std::optional<double> height;
    for (const VerticalCrossings& c : vertical_crossings(surface_mesh.mesh(), near, point)) {
      if (c.component >= loaded_scene.scene.description.terrains.size() || c.above + c.below == 0) continue;
      const double over =
          (c.above > 0 ? -c.lowest_above : c.highest_below) * loaded_scene.scene.grid.unit_m();
      height = height ? std::min(*height, over) : over;
    }
    return height;
  }

 private:
  SceneBelow below_;
};

/// Returns some of a component's vertices: the outermost ones, and others between them.
std::vector<glm::dvec3> places_of(const Scene& scene, std::size_t component, std::size_t most) {
  std::vector<VertexId> vertices;
  const auto [first, last] =
      std::equal_range(scene.mesh.component.begin(), scene.mesh.component.end(), component);
  for (auto at = first; at != last; ++at)
    for (const VertexId v : scene.mesh.facets[static_cast<std::size_t>(at - scene.mesh.component.begin())])
      vertices.push_back(v);
  std::vector<glm::dvec3> places;
  if (vertices.empty()) return places;
  const auto add = [&](VertexId v) { places.push_back(scene.grid.to_metres(scene.mesh.vertices[v])); };
  for (const auto along : {&GridPoint::x, &GridPoint::y, &GridPoint::z}) {
    const auto [lo, hi] =
        std::ranges::minmax_element(vertices, {}, [&](VertexId v) { return scene.mesh.vertices[v].*along; });
    add(*lo);
    add(*hi);
  }
  for (std::size_t k = 0; k < vertices.size(); k += vertices.size() / most + 1) add(vertices[k]);
  return places;
}

double largest_side_m(const Extent& extent) {
  return std::max(extent.hi_m.x - extent.lo_m.x, extent.hi_m.y - extent.lo_m.y);
}

struct Heights {
  double lowest_m = std::numeric_limits<double>::infinity(),
         highest_m = -std::numeric_limits<double>::infinity();
  std::size_t over_terrain = 0, places = 0;
};

SeabedPlacement told(const std::string& name, const Extent& object, const Extent& terrain,
                     const Heights& heights, const std::string& place, bool moves) {
  SeabedPlacement placement{name, {}, {}, false};
  const auto warn = [&](const std::string& what) {
    placement.warning = fmt::format("{}: object '{}' {}", place, name, what);
  };
  constexpr double far_larger = 4;
  if (const double times = largest_side_m(object) / largest_side_m(terrain); times > far_larger) {
    placement.words = fmt::format("{:.3g} times as wide as the terrain", times);
    warn(fmt::format("is {:.4g} m wide, {:.3g} times as wide as the terrain, which covers {}: {}",
                     largest_side_m(object), times, to_text(terrain),
                     largest_side_m(terrain) < 1
                         ? "are the coordinates of the terrain in degrees or kilometres?"
                         : "are its coordinates in other units (unit_m, scale)?"));
    return placement;
  }
  if (heights.places == 0) {
    placement.words = "has no facet in the water";
    warn("has no facet in the water: it is above the sea surface");
  } else if (heights.over_terrain == 0) {
    const double beside_m = terrain.distance_in_plan_m((object.lo_m + object.hi_m) / 2.0);
    placement.words =
        beside_m > 0
            ? fmt::format("outside of the terrain, {:.4g} m from it to the centre of the object", beside_m)
            : std::string("above a hole in the terrain, or outside of it");
    const std::string frames = mixed_frames((object.lo_m + object.hi_m) / 2.0, terrain);
    if (beside_m > 0)
      warn(fmt::format("lies outside of the terrain, which covers {}: {}", to_text(terrain),
                       frames.empty() ? "move it onto the terrain, unless this is intended" : frames));
  } else if (heights.highest_m < 0) {
    placement.is_buried = true;
    placement.words = fmt::format("buried: its top is {:.4g} m below the seabed", -heights.highest_m);
    warn(fmt::format(
        "is buried and cannot be seen{}: its top is {:.4g} m below the seabed; {}",
        moves ? " at the first ping" : "", -heights.highest_m,
        moves ? "change 'position_m' or the trajectory" : "on_terrain_m = 0 places it on the seabed"));
  } else if (heights.lowest_m > 1e-3) {
    placement.words = fmt::format("{:.4g} m above the seabed", heights.lowest_m);
  } else if (heights.lowest_m > -1e-3) {
    placement.words = "on the seabed";
  } else {
    placement.words = fmt::format("partly buried: from {:.4g} m below the seabed to {:.4g} m above",
                                  -heights.lowest_m, heights.highest_m);
  }
  constexpr double tiny_m = 0.01;
  if (const glm::dvec3 size_m = object.hi_m - object.lo_m;
      placement.warning.empty() && std::max({size_m.x, size_m.y, size_m.z}) < tiny_m)
    warn(fmt::format(
        "has a size of only {:.3g} x {:.3g} x {:.3g} m: are its coordinates in other units (unit_m, scale)?",
        size_m.x, size_m.y, size_m.z));
  if (heights.over_terrain > 0 && heights.over_terrain < heights.places)
    placement.words += "; partly outside of the terrain";
  return placement;
}

}  // namespace

std::vector<SeabedPlacement> placements(const Survey& survey) {
  const Scene& scene = survey.scene;
  const Extent terrain = extent_of(scene, Components::terrains);
  std::vector<SeabedPlacement> all;
  if (terrain.empty()) return all;
  const std::size_t terrains = scene.description.terrains.size();
  // For tiled terrain, each position loads tiles; with relief, each position computes a surface.
  const std::size_t most = survey.loaded_scene->is_tiled()                       ? 4
                           : survey.loaded_scene->has_surface_per_transmission() ? 30
                                                                                 : 300;
  Seabed seabed(*survey.loaded_scene);
  const MovingObject* const sea = moving_sea_surface_of(scene);
  const std::size_t end = sea == nullptr ? scene.report.components.size() : sea->component;
  for (std::size_t i = terrains; i < end; ++i) {
    const ComponentReport& object = scene.report.components[i];
    Heights heights;
    for (const glm::dvec3& place_m : places_of(scene, i, most)) {
      ++heights.places;
      const std::optional<double> over_m = seabed.height_over_m(place_m);
      if (!over_m) continue;
      ++heights.over_terrain;
      heights.lowest_m = std::min(heights.lowest_m, *over_m);
      heights.highest_m = std::max(heights.highest_m, *over_m);
    }
    all.push_back(told(object.name, {object.lo_m, object.hi_m}, terrain, heights,
                       to_string(scene.description.objects[i - terrains].place),
                       !scene.description.objects[i - terrains].trajectory.empty()));
  }
  return all;
}

std::vector<std::string> vast_windows(const Survey& survey) {
  std::vector<std::string> warnings;
  const Extent all = extent_of(survey.scene, Components::all);
  if (all.empty()) return warnings;
  for (const SensorPings& pings : survey.sensors) {
    const RangeSamples& samples = pings.sensor->samples();
    const double end_m = samples.first_m + samples.step_m * samples.count;
    double farthest_m = 0;
    for (const Pose& pose : pings.poses)
      farthest_m = std::max(farthest_m, glm::length(glm::max(glm::abs(all.lo_m - pose.position_m),
                                                             glm::abs(all.hi_m - pose.position_m))));
    constexpr double vast = 20;
    if (end_m > vast * farthest_m)
      warnings.push_back(
          fmt::format("{}: sensor '{}' records up to {:.4g} m in range bins of {:.3g} m, but no point of the "
                      "scene is farther away than {:.4g} m: is the range gate in metres?",
                      to_string(pings.sensor->description().place), pings.sensor->description().name, end_m,
                      samples.step_m, farthest_m));
  }
  return warnings;
}

}  // namespace tubefoot
