// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/survey_lines.hpp"

#include <stdexcept>

#include "scene/scene_placement.hpp"

namespace tubefoot {
namespace {

/// Extrapolates a line before its first or after its last sample `end`, with the velocity between `end` and
/// its neighbour `next`.
Trajectory::Sample beyond(const Trajectory::Sample& next, const Trajectory::Sample& end, double by_s) {
  const glm::dvec3 velocity = (end.pose.position_m - next.pose.position_m) / (end.time_s - next.time_s);
  const double later_s = end.time_s > next.time_s ? by_s : -by_s;
  return {end.time_s + later_s, {end.pose.position_m + later_s * velocity, end.pose.attitude}};
}

}  // namespace

void TrackSurroundings::place_by_lon_lat(std::span<glm::dvec3> points, const SourcePlace& place) const {
  tubefoot::place_by_lon_lat(
      points, frame, place,
      "latitude and longitude need a [georeference], which the scene does not have: add "
      "one, or give coordinates in metres in the local frame");
}

void TrackSurroundings::place_by_crs(std::span<glm::dvec3> points, const SourcePlace& place) const {
  if (!frame.is_georeferenced() || frame.is_tangent())
    throw InputError(place,
                     "easting and northing refer to a map: set 'crs' in [georeference], or give coordinates "
                     "in metres in the local frame");
  const LocalFrame::Map map = frame.map();
  for (glm::dvec3& p : points)
    p = {map.metres_per_unit * (p.x - map.easting), map.metres_per_unit * (p.y - map.northing), p.z};
}

SurveyLines::SurveyLines(double turn_s) : turn_s_(turn_s) {
  if (!(turn_s > 0)) throw std::invalid_argument("a turn must take more than 0 s");
}

void SurveyLines::add(std::vector<Trajectory::Sample> line) {
  const double begin_s = lines_.empty() ? 0 : lines_.back().end_s + turn_s_;
  for (Trajectory::Sample& sample : line) sample.time_s += begin_s;
  const double straight_on_s = 0.49 * turn_s_;  // less than half, so that times increase
  if (!lines_.empty()) samples_.push_back(beyond(line[1], line[0], straight_on_s));
  samples_.insert(samples_.end(), line.begin(), line.end());
  samples_.push_back(beyond(line.at(line.size() - 2), line.back(), straight_on_s));
  lines_.push_back({begin_s, line.back().time_s});
}

Trajectory SurveyLines::finish() && { return Trajectory(std::move(samples_), std::move(lines_)); }

}  // namespace tubefoot
