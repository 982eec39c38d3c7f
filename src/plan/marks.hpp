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

/// A pyramid of directions from one place, in which a sensor looks.
struct SectorCell {
  glm::dvec3 apex_m{0};
  std::array<glm::dvec3, 4> directions;  ///< unit vectors, in turn
  std::array<double, 4>
      recorded_to_m{};  ///< along each: to the seabed, the sea surface or the end of the range window

  bool is_received(double from_m) const {
    return std::ranges::any_of(recorded_to_m, [&](double end_m) { return end_m > from_m; });
  }
  glm::dvec3 at(std::size_t corner, double range_m) const { return apex_m + range_m * directions[corner]; }
};

/// Where a sensor looks at a ping.
struct SectorMark {
  std::size_t sensor = 0, ping = 0;
  bool chosen = false;  ///< the ping of the sensor that is drawn large
  Pose pose;
  double first_m = 0, last_m = 0;        ///< of the range window
  std::vector<SectorCell> cells;         ///< of all its transmissions
  std::optional<glm::dvec3> receiver_m;  ///< where that is apart
};

struct Heading {
  glm::dvec3 place_m{0}, ahead{0, 1, 0};
};

/// Where a sensor goes, and how its carrier heads.
struct TrackMark {
  std::vector<std::vector<glm::dvec3>> lines_m;  ///< at pings
  std::vector<Heading> headings;                 ///< at some of them
};

struct ObjectMark {
  std::string name;
  std::size_t component = 0;
  Extent extent;
  bool is_buried = false;
};

/// What a drawing of a scene shows.
struct SceneMarks {
  std::vector<SectorMark> sectors;
  std::vector<TrackMark> tracks;
  std::vector<ObjectMark> objects;
  Extent terrain;
};

/// Of the pings of each sensor first, middle and last, and headings at some more. `placements`: of the
/// objects, if they are known.
SceneMarks marks_of(const Survey& survey, std::span<const SeabedPlacement> placements);

/// Looks along each direction of a sector, where it meets the seabed or the sea surface.
void look_for_seabed(SectorMark& sector, const PlanHeights& seabed, std::optional<double> surface_m);

/// The horizontal direction in which a section through a sector shows most of it: where it looks; of one that
/// looks down, along its wider side, to starboard, or ahead where it has none.
glm::dvec3 section_direction(const SectorMark& sector);

}  // namespace tubefoot
