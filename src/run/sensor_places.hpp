// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <map>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "files/input_error.hpp"
#include "geometry/mesh/closed_shells.hpp"
#include "geometry/search/vertical_line.hpp"
#include "run/scene_below.hpp"
#include "run/transmission_surface.hpp"

namespace tubefoot {

/// Position of a sensor at a ping [m, local frame], and its name in messages: "sensor 'camera'".
struct PingPlace {
  const SourcePlace& place;  ///< place of the sensor in its scene file
  std::size_t ping = 0;
  double time_s = 0;
  glm::dvec3 at_m{0};
  std::string what;
};

/// Positions of the elements of an array at a ping [m, local frame].
struct ElementPlaces {
  const SourcePlace& place;  ///< place of the sensor in its scene file
  const std::string& sensor;
  std::size_t ping = 0;
  double time_s = 0;
  std::span<const glm::dvec3> transmitters_m, receivers_m;
};

/// Checks positions of sensors against the scene, along the vertical through each of them. Use it while the
/// loaded scene contains whole bodies, before the sea surface cuts them. Not thread-safe.
class SensorPlaces {
 public:
  /// `loaded_scene`: its report receives the warnings.
  explicit SensorPlaces(LoadedScene& loaded_scene);

  /// Throws InputError for a position exactly on a facet, an edge or a vertex. From there the facet has no
  /// visible side, hides nothing and returns nothing. This is not the limit of the echoes at neighbouring
  /// positions.
  void refuse_on_facet(const PingPlace& where);
  /// Checks a position on a facet in the same way. Throws InputError for a position below the terrain or
  /// above the waves of the sea surface. A position inside an object may be the sensor's own housing, and
  /// causes a warning, once for each element of `inside`. Returns the altitude above the terrain, or NaN
  /// without terrain.
  double check(const PingPlace& where, std::set<std::uint16_t>& inside);
  /// Throws InputError for elements that lie on a facet, below the terrain, or inside a closed object
  /// (ClosedShells). The error names the transmitter, or else the first such receiver.
  void refuse_hidden(const ElementPlaces& elements);

 private:
  struct Column {
    TransmissionSurface surface_mesh;
    std::vector<FacetId> near;
  };
  Column column(const PingPlace& where);
  void refuse_on_facet(const Column& column, const PingPlace& where) const;
  void refuse_below(const VerticalCrossings& crossings, const PingPlace& where) const;
  void refuse_above_sea(const VerticalCrossings& crossings, const PingPlace& where) const;
  void refuse_enclosed(const PingPlace& where);
  bool is_terrain(std::uint16_t component) const;
  bool is_sea(std::uint16_t component) const;

  LoadedScene& loaded_scene_;
  SceneBelow below_;
  std::map<std::uint16_t, ClosedShells> shells_;  ///< of objects on a vertical through an element
};

}  // namespace tubefoot
