// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/sensor_places.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <limits>
#include <optional>

// This file checks that sensors and their elements do not lie on a facet, below the terrain or inside a
// closed object. It uses the crossings of the vertical through each position.

namespace tubefoot {

SensorPlaces::SensorPlaces(LoadedScene& loaded_scene) : loaded_scene_(loaded_scene), below_(loaded_scene) {}

SensorPlaces::Column SensorPlaces::column(const PingPlace& where) {
  Column column{surface_in_line_with(below_.in_line_with(where.at_m), where.at_m, where.time_s), {}};
  facets_near_vertical(column.surface_mesh.tree(), loaded_scene_.scene.grid.snap(where.at_m), column.near);
  return column;
}

bool SensorPlaces::is_terrain(std::uint16_t component) const {
  return component < loaded_scene_.scene.description.terrains.size();
}

bool SensorPlaces::is_sea(std::uint16_t component) const {
  const MovingObject* const sea = moving_sea_surface_of(loaded_scene_.scene);
  return sea != nullptr && sea->component == component;
}

void SensorPlaces::refuse_on_facet(const Column& column, const PingPlace& where) const {
  const auto& [place, ping, time_s, at_m, what] = where;
  const Scene& scene = loaded_scene_.scene;
  const std::optional<FacetContact> contact =
      contact_at(column.surface_mesh.mesh(), column.near, scene.grid.snap(at_m));
  if (!contact) return;
  constexpr std::array<const char*, 3> parts{"a vertex", "an edge", "a facet"};
  throw InputError(place, fmt::format("{} lies exactly on {} of '{}' at ping {} (t = {:.3f} s, east {:.6f}, "
                                      "north {:.6f}, up {:.6f} m), so its visible side is undefined: move it "
                                      "by a millimetre or more ('lever_arm_m', or the trajectory)",
                                      what, parts[static_cast<std::size_t>(contact->part)],
                                      scene.report.components[contact->component].name, ping, time_s, at_m.x,
                                      at_m.y, at_m.z));
}

void SensorPlaces::refuse_below(const VerticalCrossings& crossings, const PingPlace& where) const {
  const auto& [place, ping, time_s, at_m, what] = where;
  if (crossings.above == 0 || crossings.below > 0) return;
  throw InputError(
      place,
      fmt::format("{} is {:.3g} m below the seabed ('{}') at ping {} (t = {:.3f} s, east {:.2f}, north "
                  "{:.2f}, up {:.2f} m): raise its trajectory or lever arm",
                  what, crossings.lowest_above * loaded_scene_.scene.grid.unit_m(),
                  loaded_scene_.scene.report.components[crossings.component].name, ping, time_s, at_m.x,
                  at_m.y, at_m.z));
}

void SensorPlaces::refuse_above_sea(const VerticalCrossings& crossings, const PingPlace& where) const {
  if (crossings.below == 0) return;
  throw InputError(
      where.place,
      fmt::format("{} is {:.3g} m above the waves of the sea surface at ping {} (t = {:.3f} s, east {:.2f}, "
                  "north {:.2f}, up {:.2f} m): lower its trajectory or lever arm below the troughs",
                  where.what, crossings.highest_below * loaded_scene_.scene.grid.unit_m(), where.ping,
                  where.time_s, where.at_m.x, where.at_m.y, where.at_m.z));
}

void SensorPlaces::refuse_on_facet(const PingPlace& where) { refuse_on_facet(column(where), where); }

double SensorPlaces::check(const PingPlace& where, std::set<std::uint16_t>& inside) {
  Scene& scene = loaded_scene_.scene;
  double altitude_m = std::numeric_limits<double>::quiet_NaN();
  const Column lying = column(where);
  refuse_on_facet(lying, where);
  for (const VerticalCrossings& c :
       vertical_crossings(lying.surface_mesh.mesh(), lying.near, scene.grid.snap(where.at_m))) {
    if (is_terrain(c.component)) {
      refuse_below(c, where);
      if (c.below > 0) altitude_m = std::fmin(altitude_m, c.highest_below * scene.grid.unit_m());
    } else if (is_sea(c.component)) {
      refuse_above_sea(c, where);
    } else if (c.above % 2 == 1 && inside.insert(c.component).second) {
      scene.report.warnings.push_back(fmt::format(
          "{}: {} is inside object '{}' at ping {} (t = {:.3f} s), so it sees the object from the inside",
          to_string(where.place), where.what, scene.report.components[c.component].name, where.ping,
          where.time_s));
    }
  }
  return altitude_m;
}

/// Uses the objects as they are loaded. Relief does not open closed objects, and tiled terrain is not an
/// object.
void SensorPlaces::refuse_enclosed(const PingPlace& where) {
  const TransmissionSurface surface = surface_at(loaded_scene_, where.time_s);
  const FacetMesh& mesh = surface.mesh();
  const GridPoint point = loaded_scene_.scene.grid.snap(where.at_m);
  std::vector<FacetId> near;
  facets_near_vertical(surface.tree(), point, near);
  for (const VerticalCrossings& c : vertical_crossings(mesh, near, point)) {
    // A vertical from inside a closed object crosses the object above and below.
    if (is_terrain(c.component) || c.above == 0 || c.below == 0) continue;
    const ClosedShells& shells = shells_.try_emplace(c.component, mesh, c.component).first->second;
    if (!is_enclosed(mesh, shells, near, point)) continue;
    throw InputError(
        where.place,
        fmt::format("{} is inside the closed object '{}' at ping {} (t = {:.3f} s, east {:.3f}, north "
                    "{:.3f}, up {:.3f} m), where no sound reaches it: move it out ('receivers_m', "
                    "'lever_arm_m', or the trajectory), or open the mesh of the object",
                    where.what, loaded_scene_.scene.report.components[c.component].name, where.ping,
                    where.time_s, where.at_m.x, where.at_m.y, where.at_m.z));
  }
}

void SensorPlaces::refuse_hidden(const ElementPlaces& elements) {
  const auto refuse = [&](const char* kind, std::span<const glm::dvec3> places_m) {
    for (std::size_t k = 0; k < places_m.size(); ++k) {
      const PingPlace where{elements.place, elements.ping, elements.time_s, places_m[k],
                            fmt::format("{}{} of sensor '{}'", kind,
                                        places_m.size() > 1 ? fmt::format(" {}", k) : "", elements.sensor)};
      const Column lying = column(where);
      refuse_on_facet(lying, where);
      for (const VerticalCrossings& c : vertical_crossings(lying.surface_mesh.mesh(), lying.near,
                                                           loaded_scene_.scene.grid.snap(where.at_m)))
        if (is_terrain(c.component))
          refuse_below(c, where);
        else if (is_sea(c.component))
          refuse_above_sea(c, where);
      refuse_enclosed(where);
    }
  };
  refuse("the transmitter", elements.transmitters_m);
  refuse("receiver", elements.receivers_m);
}

}  // namespace tubefoot
