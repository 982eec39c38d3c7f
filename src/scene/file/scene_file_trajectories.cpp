// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/file/scene_file_ranges.hpp"
#include "scene/file/scene_file_sections.hpp"

// The section [[trajectories]] of a scene file.
namespace tubefoot {
namespace {

void check_survey(const SurveyTrajectory& survey, const TomlTable& table) {
  if (table.has("centre_m") + survey.centre_lat_lon_deg.has_value() + survey.centre_crs.has_value() > 1)
    throw InputError(table.place_of(survey.centre_crs ? "centre_crs" : "centre_lat_lon_deg"),
                     "the survey has more than one centre: keep one of 'centre_m', 'centre_lat_lon_deg' and "
                     "'centre_crs'");
  const int heights = survey.up_m.has_value() + survey.depth_m.has_value() + survey.altitude_m.has_value();
  if (heights != 1)
    throw InputError(table.place,
                     fmt::format("the survey has {} height: give one of 'up_m' (in the local frame), "
                                 "'depth_m' (below the water's surface) and 'altitude_m' (above the terrain)",
                                 heights == 0 ? "no" : "more than one"));
  if (survey.altitude_step_m && !survey.altitude_m)
    throw InputError(
        table.place_of("altitude_step_m"),
        "'altitude_step_m' needs 'altitude_m': remove 'altitude_step_m', or give the height as 'altitude_m'");
}

void check_trajectory(const TrajectoryDescription& trajectory, const TomlTable& table) {
  if (const auto* survey = std::get_if<SurveyTrajectory>(&trajectory.kind)) check_survey(*survey, table);
  if (const auto* waypoints = std::get_if<WaypointTrajectory>(&trajectory.kind))
    if (table.has("turn_s") && !waypoints->speed_m_s)
      throw InputError(table.place_of("turn_s"),
                       "'turn_s' applies only to files without times: give 'speed_m_s', or remove 'turn_s'");
  const auto* line = std::get_if<LineTrajectory>(&trajectory.kind);
  if (line == nullptr) return;
  if (line->start_m == line->end_m) {
    throw InputError(
        table.place_of("end_m"),
        "'end_m' equals 'start_m': a line needs a length (use kind = \"fixed\" for a fixed position)");
  }
  if (line->start_m[0] == line->end_m[0] && line->start_m[1] == line->end_m[1]) {
    throw InputError(table.place_of("end_m"),
                     "'end_m' lies directly above or below 'start_m': a vertical line has no heading (use "
                     "kind = \"waypoints\")");
  }
}

}  // namespace

const TomlSection<TrajectoryDescription>& trajectory_section() {
  using T = TrajectoryDescription;
  using Fixed = FixedTrajectory;
  using Line = LineTrajectory;
  using Waypoints = WaypointTrajectory;
  using Lines = SurveyTrajectory;
  constexpr ValueRange speed{.lo = 0, .hi = 100, .lo_excluded = true};
  constexpr ValueRange turn{.lo = 0.001, .hi = 1e6};
  static const auto section =
      TomlSection<T>(
          "[[trajectories]]",
          "Motion of a carrier. A single entry may be written as `[trajectory]`. A scene needs at least one.")
          .keys({field(
              "name", &T::name,
              {.meaning = "Name by which sensors refer to the trajectory.", .longest = limits::name_bytes})})
          .kind<Fixed>(
              "kind", "fixed", "The carrier has the same pose at all times.",
              {field("position_m", &Fixed::position_m,
                     {.meaning = "Position of the carrier: east, north, up.", .ranges = {coordinate}}),
               field("heading_deg", &Fixed::heading_deg,
                     {.meaning = "Heading of the carrier, clockwise from north.", .ranges = {heading}}),
               field("pitch_deg", &Fixed::pitch_deg,
                     {.meaning = "Pitch of the carrier. Positive values raise the bow.", .ranges = {pitch}}),
               field("roll_deg", &Fixed::roll_deg,
                     {.meaning = "Roll of the carrier. Positive values lower the starboard side.",
                      .ranges = {roll}})})
          .kind<Line>(
              "kind", "line",
              "The carrier moves along a straight line at constant speed, starting at time 0.",
              {field("start_m", &Line::start_m,
                     {.meaning = "Position at time 0: east, north, up.",
                      .ranges = {coordinate},
                      .required = true}),
               field("end_m", &Line::end_m,
                     {.meaning = "Last position: east, north, up. The carrier heads along the line, which "
                                 "must not be vertical.",
                      .ranges = {coordinate},
                      .required = true}),
               field("speed_m_s", &Line::speed_m_s,
                     {.meaning = "Constant speed along the line.", .ranges = {speed}}),
               field("pitch_deg", &Line::pitch_deg,
                     {.meaning = "Pitch of the carrier. Positive values raise the bow.", .ranges = {pitch}}),
               field("roll_deg", &Line::roll_deg,
                     {.meaning = "Roll of the carrier. Positive values lower the starboard side.",
                      .ranges = {roll}})})
          .kind<Waypoints>(
              "kind", "waypoints", "A file contains the poses of the carrier.",
              {field("file", &Waypoints::file,
                     {.meaning = "CSV file with a header line and one waypoint per row. tubefoot "
                                 "interpolates positions linearly and attitudes with quaternions.",
                      .required = true}),
               field("speed_m_s", &Waypoints::speed_m_s,
                     {.meaning = "Speed between waypoints, for a file without times.", .ranges = {speed}}),
               field("turn_s", &Waypoints::turn_s,
                     {.meaning = "Time from the end of a line to the start of the next line, for a file that "
                                 "has lines but no times.",
                      .ranges = {turn}})})
          .kind<Lines>(
              "kind", "survey",
              "The carrier follows parallel lines over a rectangle. Sensors ping along the lines but not "
              "between them.",
              {field("centre_m", &Lines::centre_m,
                     {.meaning = "Centre of the area: east, north.", .ranges = {coordinate}}),
               field("centre_lat_lon_deg", &Lines::centre_lat_lon_deg,
                     {.meaning = "Latitude and longitude (WGS 84) of the centre, instead of `centre_m`. "
                                 "Needs `[georeference]`.",
                      .ranges = {latitude, longitude}}),
               field("centre_crs", &Lines::centre_crs,
                     {.meaning = "Easting and northing of the centre in the `crs` of the scene, instead of "
                                 "`centre_m`."}),
               field("length_m", &Lines::length_m,
                     {.meaning = "Length of the lines.", .ranges = {size}, .required = true}),
               field("width_m", &Lines::width_m,
                     {.meaning = "Width of the area across the lines. As many lines as fit are centred in "
                                 "this width. 0: a single line.",
                      .ranges = {size_or_zero},
                      .required = true}),
               field("spacing_m", &Lines::spacing_m,
                     {.meaning = "Distance between lines. The first line is the port-most one, as seen along "
                                 "its heading.",
                      .ranges = {size},
                      .required = true}),
               field("heading_deg", &Lines::heading_deg,
                     {.meaning = "Heading of the first line, clockwise from north.", .ranges = {heading}}),
               field("one_way", &Lines::one_way,
                     {.meaning = "true: all lines run in the direction of the first line. false: every "
                                 "second line runs in the opposite direction."}),
               field("up_m", &Lines::up_m,
                     {.meaning = "Height of the carrier in the local frame. Give exactly one of `up_m`, "
                                 "`depth_m` and `altitude_m`.",
                      .ranges = {coordinate}}),
               field("depth_m", &Lines::depth_m,
                     {.meaning = "Depth of the carrier below the sea surface, instead of `up_m`.",
                      .ranges = {{.lo = 0, .hi = 12000}}}),
               field("altitude_m", &Lines::altitude_m,
                     {.meaning = "Height of the carrier above the terrain straight below, without relief, "
                                 "instead of `up_m`.",
                      .ranges = {{.lo = 0, .hi = 12000, .lo_excluded = true}}}),
               field("altitude_step_m", &Lines::altitude_step_m,
                     {.meaning = "Distance between the points at which the carrier has the height "
                                 "`altitude_m`. Between these points, its height varies linearly.",
                      .ranges = {size},
                      .default_value = "value of altitude_m"}),
               field("speed_m_s", &Lines::speed_m_s, {.meaning = "Speed over ground.", .ranges = {speed}}),
               field("turn_s", &Lines::turn_s,
                     {.meaning = "Time from the end of a line to the start of the next line.",
                      .ranges = {turn}}),
               field("pitch_deg", &Lines::pitch_deg,
                     {.meaning = "Pitch of the carrier. Positive values raise the bow.", .ranges = {pitch}}),
               field("roll_deg", &Lines::roll_deg,
                     {.meaning = "Roll of the carrier. Positive values lower the starboard side.",
                      .ranges = {roll}})})
          .check(check_trajectory);
  return section;
}

}  // namespace tubefoot
