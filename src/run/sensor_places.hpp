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

/// A place of a sensor at a ping [m, local frame], and what it is called: "sensor 'camera'".
struct PingPlace {
  const SourcePlace& place;  ///< of the sensor, in its scene file
  std::size_t ping = 0;
  double time_s = 0;
  glm::dvec3 at_m{0};
  std::string what;
};

/// The elements of an array at a ping [m, local frame].
struct ElementPlaces {
  const SourcePlace& place;  ///< of the sensor, in its scene file
  const std::string& sensor;
  std::size_t ping = 0;
  double time_s = 0;
  std::span<const glm::dvec3> transmitters_m, receivers_m;
};

/// Holds places of sensors against the scene, straight up and down from each. While the loaded scene has its
/// bodies whole, before the sea surface cuts them. Not for several threads at once.
class SensorPlaces {
 public:
  /// `loaded_scene`: warnings go to its report.
  explicit SensorPlaces(LoadedScene& loaded_scene);

  /// A surface through the apex has no side that could be seen, hides nothing, and returns nothing: that is
  /// no limit of what a sensor beside it receives, so it is no place for one: throws InputError.
  void refuse_on_facet(const PingPlace& where);
  /// The same, and throws InputError for a place below the terrain, which is a mistake in the scene; one
  /// inside an object may be in its own housing, which is a warning, once for each of `inside`. Returns the
  /// altitude over the terrain, not a number where there is none.
  double check(const PingPlace& where, std::set<std::uint16_t>& inside);
  /// Throws InputError for elements that lie on a facet, below the terrain, or enclosed by an object
  /// (ClosedShells): of several, for the transmitter, then for the first receiver.
  void refuse_hidden(const ElementPlaces& elements);

 private:
  struct Column {
    TransmissionSurface surface_mesh;
    std::vector<FacetId> near;
  };
  Column column(const PingPlace& where);
  void refuse_on_facet(const Column& column, const PingPlace& where) const;
  void refuse_below(const VerticalCrossings& crossings, const PingPlace& where) const;
  void refuse_enclosed(const PingPlace& where);
  bool is_terrain(std::uint16_t component) const;

  LoadedScene& loaded_scene_;
  SceneBelow below_;
  std::map<std::uint16_t, ClosedShells> shells_;  ///< of objects that elements were in line with
};

}  // namespace tubefoot
