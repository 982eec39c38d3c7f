// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <glm/vec3.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "plan/seabed.hpp"
#include "run/placement.hpp"
#include "run/survey.hpp"
#include "scene/extent.hpp"

namespace tubefoot {

/// A pyramid of directions from one apex, part of a sector.
struct SectorCell {
  glm::dvec3 apex_m{0};
  std::array<glm::dvec3, 4> directions;   ///< unit vectors, in cyclic order
  std::array<double, 4> recorded_to_m{};  ///< along each direction: range of the seabed, of the sea surface
                                          ///< or of the end of the range gate

  bool is_received(double from_m) const {
    return std::ranges::any_of(recorded_to_m, [&](double end_m) { return end_m > from_m; });
  }
  glm::dvec3 at(std::size_t corner, double range_m) const { return apex_m + range_m * directions[corner]; }
};

/// Sector of a sensor at a ping.
struct SectorMark {
  std::size_t sensor = 0, ping = 0;
  bool chosen = false;  ///< the drawing shows this ping of the sensor at large scale
  Pose pose;
  double first_m = 0, last_m = 0;        ///< limits of the range gate
  std::vector<SectorCell> cells;         ///< cells of all transmissions of the ping
  std::optional<glm::dvec3> receiver_m;  ///< position of a separate receiver
};

struct Heading {
  glm::dvec3 place_m{0}, ahead{0, 1, 0};
};

/// Track of a sensor, and headings of its carrier.
struct TrackMark {
  std::vector<std::vector<glm::dvec3>> lines_m;  ///< positions of the pings
  std::vector<Heading> headings;                 ///< headings at some pings
};

struct ObjectMark {
  std::string name;
  std::size_t component = 0;
  Extent extent;
  bool is_buried = false;
};

/// Elements of a scene drawing.
struct SceneMarks {
  std::vector<SectorMark> sectors;
  std::vector<TrackMark> tracks;
  std::vector<ObjectMark> objects;
  Extent terrain;
};

/// Collects the first, the middle and the last ping of each sensor, and headings at further pings.
/// `placements`: placements of the objects, if known.
SceneMarks marks_of(const Survey& survey, std::span<const SeabedPlacement> placements);

/// Finds the range along each direction of a sector at which it meets the seabed or the sea surface.
void look_for_seabed(SectorMark& sector, const PlanHeights& seabed, std::optional<double> surface_m);

/// Returns the horizontal direction of a section that shows most of a sector. This is the direction of the
/// sector. For a sector that looks down, it is the direction of its wider side, towards starboard. For a
/// sector that looks down and has no wider side, it is the forward direction.
glm::dvec3 section_direction(const SectorMark& sector);

}  // namespace tubefoot
