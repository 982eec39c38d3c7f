// SPDX-License-Identifier: GPL-3.0-or-later

// Reads a trajectory from waypoints in a CSV file. Positions are local, geographic or in the CRS of the
// scene. Missing times follow from the speed, missing headings from the track.

#include "scene/waypoint_file.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>
#include <numbers>
#include <string_view>

#include "files/csv_file.hpp"
#include "scene/file/scene_file_ranges.hpp"

namespace tubefoot {
namespace {

enum Column {
  time_s,
  east_m,
  north_m,
  latitude_deg,
  longitude_deg,
  easting,
  northing,
  up_m,
  depth_m,
  altitude_m,
  heading_deg,
  pitch_deg,
  roll_deg,
  line
};
constexpr std::size_t column_count = line + 1;
constexpr std::array<std::string_view, column_count> names = {
    "time_s", "east_m",  "north_m",    "latitude_deg", "longitude_deg", "easting",  "northing",
    "up_m",   "depth_m", "altitude_m", "heading_deg",  "pitch_deg",     "roll_deg", "line"};

// Largest values: times for which a double has microseconds, coordinates of scene files, coordinates of
// maps, and angles of many turns.
constexpr std::array<double, column_count> largest = {1e10,  far_m, far_m, 90,  360, 1e9, 1e9,
                                                      far_m, far_m, far_m, 1e6, 1e6, 1e6, 1e9};

/// A row of the file.
struct Waypoint {
  std::array<double, column_count> values;
  int line_number = 0;
  std::array<int, column_count> characters{};  ///< columns in the line where the values begin
  bool has(Column column) const { return !std::isnan(values[column]); }
  double operator[](Column column) const { return values[column]; }
};

/// Rows that all have the same columns.
struct WaypointTable {
  std::string file;
  std::vector<Waypoint> rows;
  SourcePlace header;
  CsvContents contents;

  explicit WaypointTable(const std::filesystem::path& path) : file(path.string()) {
    contents = read_csv(path, {}, names, [&](const CsvRow& row) {
      Waypoint& point = rows.emplace_back();
      for (std::size_t k = 0; k < column_count; ++k) {
        if (std::abs(row.values[k]) > largest[k])
          throw InputError(row.places[k], fmt::format("{} is {}, expected {:g} to {:g}", names[k],
                                                      row.values[k], -largest[k], largest[k]));
        point.values[k] = row.values[k];
        if (std::isnan(row.values[k])) {
          header = row.places[k];
        } else {
          point.line_number = row.places[k].line;
          point.characters[k] = row.places[k].column;
        }
      }
    });
    if (rows.empty())
      throw InputError({file, 0, 0}, "has a header but no waypoint, expected at least one row");
  }

  bool has(Column column) const { return rows.front().has(column); }
  /// Returns the place of a value, or of the header if the column is missing.
  SourcePlace place(std::size_t row, Column column) const {
    return has(column) ? SourcePlace{file, rows[row].line_number, rows[row].characters[column]} : header;
  }
  /// Returns the only existing one of some columns.
  Column only_one(std::initializer_list<Column> some, std::string_view expected) const {
    std::optional<Column> found;
    for (const Column column : some) {
      if (!has(column)) continue;
      if (found)
        throw InputError(place(0, column),
                         fmt::format("the columns {} and {} give the same quantity: expected {}",
                                     names[*found], names[column], expected));
      found = column;
    }
    if (!found) throw InputError(header, fmt::format("expected the columns {}", expected));
    return *found;
  }
};

/// Returns warnings about a line of waypoints.
std::vector<std::string> odd_waypoints(const std::vector<Trajectory::Sample>& samples, bool has_times,
                                       const std::filesystem::path& file) {
  std::vector<std::string> odd;
  const auto apart = [](double a, double b) { return std::abs(std::remainder(a - b, 2 * std::numbers::pi)); };
  std::size_t moves = 0, in_radians = 0;
  double way_m = 0;
  for (std::size_t k = 1; k < samples.size(); ++k) {
    const glm::dvec3 step = samples[k].pose.position_m - samples[k - 1].pose.position_m;
    way_m += glm::length(step);
    if (std::hypot(step.x, step.y) < 1e-3) continue;
    ++moves;
    const glm::dvec3 ahead = samples[k].pose.attitude * glm::dvec3(0, 1, 0);
    const double course = std::atan2(step.x, step.y), heading = std::atan2(ahead.x, ahead.y),
                 as_radians = glm::degrees(heading);
    constexpr double near = 0.2, far = 0.35;
    if (std::abs(as_radians) < 6.3 && apart(as_radians, course) < near && apart(heading, course) > far)
      ++in_radians;
  }
  if (moves > 0 && 10 * in_radians >= 9 * moves)
    odd.push_back(
        fmt::format("{}: heading_deg looks like radians: the headings agree with the directions between the "
                    "waypoints only as radians",
                    file.string()));
  const double lasts_s = samples.back().time_s - samples.front().time_s, speed_m_s = way_m / lasts_s;
  constexpr double fast_m_s = 30, slow_m_s = 0.005;
  if (has_times && lasts_s > 0 && (speed_m_s > fast_m_s || (speed_m_s < slow_m_s && way_m > 1)))
    odd.push_back(fmt::format("{}: {:.4g} m in {:.4g} s is a speed of {:.3g} m/s: is time_s in seconds?",
                              file.string(), way_m, lasts_s, speed_m_s));
  return odd;
}

class Waypoints {
 public:
  Waypoints(const WaypointTrajectory& description, const TrackSurroundings& around)
      : description_(description), around_(around), table_(description.file), rows_(table_.rows) {
    check_columns();
    place();
    if (around_.odd != nullptr)
      for (std::string& ignored : ignored_columns_warning(description_.file, table_.contents))
        around_.odd->push_back(std::move(ignored));
  }

  Trajectory track() const {
    const bool timed = table_.has(time_s), divided = table_.has(line);
    if (rows_.size() == 1) return Trajectory({{timed ? rows_[0][time_s] : 0, poses(0, 1).front()}});
    const std::vector<std::size_t> ends = ends_of_lines();
    std::vector<Trajectory::Sample> samples;
    std::vector<Trajectory::Line> lines;
    SurveyLines survey(description_.turn_s);
    const std::size_t told =
        around_.odd == nullptr ? 0 : around_.odd->size();  // warnings about one line are enough
    for (std::size_t k = 0, begin = 0; k < ends.size(); begin = ends[k++]) {
      std::vector<Trajectory::Sample> of_line;
      for (const Pose& pose : poses(begin, ends[k])) {
        const std::size_t i = begin + of_line.size();
        of_line.push_back({timed ? rows_[i][time_s] : time_under_way(i, of_line), pose});
      }
      if (around_.odd != nullptr && around_.odd->size() == told)
        for (std::string& words : odd_waypoints(of_line, timed, description_.file))
          around_.odd->push_back(std::move(words));
      if (!timed && divided) {
        if (of_line.size() < 2)
          throw InputError(table_.place(begin, line),
                           "the line has only one waypoint, expected two or more in a file without times");
        survey.add(std::move(of_line));
        continue;
      }
      lines.push_back({of_line.front().time_s, of_line.back().time_s});
      samples.insert(samples.end(), of_line.begin(), of_line.end());
    }
    if (samples.empty()) return std::move(survey).finish();
    if (!divided) lines.clear();
    return Trajectory(std::move(samples), std::move(lines));
  }

 private:
  void check_columns() {
    constexpr std::string_view position =
        "east_m and north_m, or latitude_deg and longitude_deg, or easting and northing (of the scene's crs)";
    across_ = table_.only_one({east_m, latitude_deg, easting}, position);
    along_ = table_.only_one({north_m, longitude_deg, northing}, position);
    if (along_ != across_ + 1)
      throw InputError(table_.place(0, along_), fmt::format("{} does not belong to {}: expected {}",
                                                            names[along_], names[across_], position));
    height_ =
        table_.only_one({up_m, depth_m, altitude_m},
                        "up_m, or depth_m (below the water's surface), or altitude_m (above the terrain)");
    if (table_.has(time_s) == description_.speed_m_s.has_value())
      throw InputError(
          table_.place(0, time_s),
          table_.has(time_s)
              ? "the column time_s and the scene's 'speed_m_s' both define the times: remove one of the two"
              : "expected the column time_s, or 'speed_m_s' in the scene's trajectory");
    for (std::size_t i = 1; table_.has(time_s) && i < rows_.size(); ++i)
      if (!(rows_[i][time_s] > rows_[i - 1][time_s]))
        throw InputError(table_.place(i, time_s), fmt::format("time_s must increase: {} follows {}",
                                                              rows_[i][time_s], rows_[i - 1][time_s]));
  }

  /// Computes the local positions of all rows.
  void place() {
    const SourcePlace file{description_.file.string(), 0, 0};
    for (const Waypoint& row : rows_) {
      const double up = height_ == up_m      ? row[up_m]
                        : height_ == depth_m ? around_.surface_height_m - row[depth_m]
                                             : 0;
      if (across_ == latitude_deg)
        positions_.emplace_back(row[longitude_deg], row[latitude_deg], up);
      else
        positions_.emplace_back(row[across_], row[along_], up);
    }
    if (across_ == latitude_deg) around_.place_by_lon_lat(positions_, file);
    if (across_ == easting) around_.place_by_crs(positions_, file);
    for (std::size_t i = 0; i < rows_.size(); ++i)
      if (!(std::abs(positions_[i].x) <= far_m && std::abs(positions_[i].y) <= far_m))
        throw InputError(table_.place(i, across_),
                         fmt::format("the waypoint is {:.0f} km east and {:.0f} km north of the scene's "
                                     "origin, expected at most {:g} km",
                                     positions_[i].x / 1e3, positions_[i].y / 1e3, far_m / 1e3));
    if (height_ != altitude_m) return;
    const std::vector<glm::dvec2> places(positions_.begin(), positions_.end());
    const auto surface_mesh = around_.terrain_heights_m(places);
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      if (!surface_mesh[i])
        throw InputError(
            table_.place(i, altitude_m),
            fmt::format("there is no terrain below this waypoint ({:.3f} m east, {:.3f} m north): "
                        "give up_m or depth_m",
                        places[i].x, places[i].y));
      positions_[i].z = *surface_mesh[i] + rows_[i][altitude_m];
    }
  }

  /// Returns the index after the last waypoint of each line.
  std::vector<std::size_t> ends_of_lines() const {
    std::vector<std::size_t> ends;
    for (std::size_t i = 1; i < rows_.size(); ++i)
      if (rows_[i].has(line) && rows_[i][line] != rows_[i - 1][line]) ends.push_back(i);
    ends.push_back(rows_.size());
    return ends;
  }

  /// Returns the time of the i-th waypoint, after the earlier waypoints of its line.
  double time_under_way(std::size_t i, std::span<const Trajectory::Sample> before) const {
    if (before.empty()) return 0;
    const double time =
        before.back().time_s + glm::distance(positions_[i - 1], positions_[i]) / *description_.speed_m_s;
    if (!(time > before.back().time_s))
      throw InputError(
          table_.place(i, across_),
          "the waypoint is at the same position as the previous one, expected different positions");
    return time;
  }

  /// Returns the poses of the waypoints [begin, end) of a line.
  std::vector<Pose> poses(std::size_t begin, std::size_t end) const {
    const auto angle = [&](std::size_t i, Column column) {
      return table_.has(column) ? glm::radians(rows_[i][column]) : 0;
    };
    const std::vector<double> along =
        table_.has(heading_deg) ? std::vector<double>() : headings_along(begin, end);
    std::vector<Pose> poses;
    for (std::size_t i = begin; i < end; ++i)
      poses.push_back(
          {positions_[i], attitude_from_angles(along.empty() ? angle(i, heading_deg) : along[i - begin],
                                               angle(i, pitch_deg), angle(i, roll_deg))});
    return poses;
  }

  /// Returns the mean of the directions to each waypoint and from it. A stationary carrier keeps its
  /// direction.
  std::vector<double> headings_along(std::size_t begin, std::size_t end) const {
    std::vector<glm::dvec2> course(end - begin, glm::dvec2(0));
    const auto walk = [&](std::size_t from, std::size_t to, glm::dvec2& way) {
      const glm::dvec2 step = glm::dvec2(positions_[to]) - glm::dvec2(positions_[from]);
      if (step != glm::dvec2(0)) way = glm::normalize(step);
    };
    glm::dvec2 before(0), after(0);
    for (std::size_t i = begin + 1; i < end; ++i) {
      walk(i - 1, i, before);
      course[i - begin] += before;
    }
    for (std::size_t i = end - 1; i > begin; --i) {
      walk(i - 1, i, after);
      course[i - 1 - begin] += after;
    }
    std::vector<double> headings;
    for (std::size_t k = 0; k < course.size(); ++k) {
      constexpr double turned_back = 1e-9;
      if (glm::length(course[k]) <= turned_back)
        throw InputError(table_.place(begin + k, across_),
                         "the track has no direction here: add the column heading_deg");
      headings.push_back(std::atan2(course[k].x, course[k].y));
    }
    return headings;
  }

  const WaypointTrajectory& description_;
  const TrackSurroundings& around_;
  const WaypointTable table_;
  const std::vector<Waypoint>& rows_;
  Column across_ = east_m, along_ = north_m, height_ = up_m;
  std::vector<glm::dvec3> positions_;
};

}  // namespace

Trajectory read_waypoints(const WaypointTrajectory& waypoints, const TrackSurroundings& around) {
  return Waypoints(waypoints, around).track();
}

}  // namespace tubefoot
