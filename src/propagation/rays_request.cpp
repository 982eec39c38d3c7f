// SPDX-License-Identifier: GPL-3.0-or-later
#include "propagation/rays_request.hpp"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <array>
#include <cmath>

#include "files/csv_file.hpp"
#include "files/number_list.hpp"
#include "files/usage_error.hpp"
#include "geometry/numbers/scalars.hpp"
#include "run/console/progress.hpp"

namespace tubefoot {
namespace {

constexpr double longest_m = 1e8;  // the circumference of the Earth is 4e7 m
constexpr std::size_t most_points = 1'000'000;

std::optional<double> length(std::string_view text) {
  for (const auto& [unit, factor] : {std::pair{"km", 1e3}, {"m", 1.0}}) {
    if (!text.ends_with(unit)) continue;
    const auto value = number_of(text.substr(0, text.size() - std::string_view(unit).size()));
    return value ? std::optional(*value * factor) : std::nullopt;
  }
  return number_of(text);
}

void require_point(const glm::dvec3& point_m, const std::string& place) {
  for (const double value : {point_m.x, point_m.y, point_m.z})
    if (!(std::abs(value) <= longest_m))
      throw UsageError(fmt::format("{}: coordinates must be within {:g} m", place, longest_m));
}

}  // namespace

glm::dvec3 point_of(const std::string& text, const std::string& option) {
  const std::vector<std::string> words = split_at(text, ',');
  std::array<double, 3> values{};
  bool valid = words.size() == values.size();
  for (std::size_t k = 0; valid && k < values.size(); ++k) {
    const auto value = number_of(words[k]);
    valid = value.has_value();
    if (valid) values[k] = *value;
  }
  if (!valid)
    throw UsageError(
        fmt::format("{} '{}': expected a position X,Y,Z in m, for example 1500,0,-80", option, text));
  const glm::dvec3 point_m{values[0], values[1], values[2]};
  require_point(point_m, option);
  return point_m;
}

std::vector<glm::dvec3> points_of_file(const std::filesystem::path& file) {
  constexpr std::array<std::string_view, 3> columns = {"x_m", "y_m", "z_m"};
  std::vector<glm::dvec3> points_m;
  read_csv(file, columns, [&](const CsvRow& row) {
    for (std::size_t k = 0; k < columns.size(); ++k)
      if (!(std::abs(row.values[k]) <= longest_m))
        throw InputError(row.places[k], fmt::format("{} is {}, expected at most {:g} m from the origin: move "
                                                    "the point into the local frame",
                                                    columns[k], row.values[k], longest_m));
    if (points_m.size() == most_points)
      throw InputError(row.places[0],
                       fmt::format("the table has more than {} points: divide it", most_points));
    points_m.emplace_back(row.values[0], row.values[1], row.values[2]);
  });
  if (points_m.empty()) throw InputError({file.string(), 0, 0}, "has a header but no rows: expected a point");
  return points_m;
}

std::vector<double> lengths_of(const std::string& text, const std::string& option) {
  const std::vector<double> values = numbers_of(
      text,
      {option, "FIRST:LAST:STEP or numbers separated by commas, in m or km: 1km,2km", std::nullopt, length});
  if (!(std::abs(values.front()) <= longest_m && std::abs(values.back()) <= longest_m))
    throw UsageError(fmt::format("{} '{}': expected lengths of at most {:g} m", option, text, longest_m));
  return values;
}

std::vector<glm::dvec3> points_at(const RaysRequest& request, const std::vector<double>& ranges_m,
                                  const std::vector<double>& depths_m) {
  if (ranges_m.front() < 0)
    throw UsageError(
        fmt::format("--ranges: expected horizontal ranges of at least 0 m, not {:g}", ranges_m.front()));
  if (ranges_m.size() * depths_m.size() > most_points)
    throw UsageError(fmt::format("--ranges and --depths give {} points, more than {}: increase a step",
                                 ranges_m.size() * depths_m.size(), most_points));
  std::vector<glm::dvec3> points_m;
  for (const double depth_m : depths_m)
    for (const double range_m : ranges_m)
      points_m.emplace_back(request.source_m.x + range_m, request.source_m.y,
                            request.surface_height_m - depth_m);
  return points_m;
}

std::vector<PointArrivals> eigenrays_of(const RaysRequest& request, const std::vector<glm::dvec3>& points_m,
                                        bool quiet) {
  std::vector<PointArrivals> all(points_m.size());
  const double source_depth_m = request.depth_m(request.source_m);
  for (std::size_t k = 0; k < points_m.size(); ++k) {
    const glm::dvec3 along_m = points_m[k] - request.source_m;
    all[k] = {points_m[k], std::hypot(along_m.x, along_m.y), request.depth_m(points_m[k]), {}};
    const ArrivalOptions& water = request.options;
    if (!(all[k].depth_m >= water.surface_m && all[k].depth_m <= water.bottom_m))
      throw UsageError(
          fmt::format("point {} ({:g}, {:g}, {:g}) is at a depth of {:g} m, but the water extends "
                      "from {:g} to {:g} m: move the point",
                      k + 1, points_m[k].x, points_m[k].y, points_m[k].z, all[k].depth_m, water.surface_m,
                      water.bottom_m));
    if (all[k].range_m == 0 && all[k].depth_m == source_depth_m)
      throw UsageError(fmt::format("point {} is the source: no direction leads there", k + 1));
  }
  Progress progress("eigenrays", all.size(), quiet);
  tbb::parallel_for(std::size_t{0}, all.size(), [&](std::size_t k) {
    all[k].arrivals =
        arrivals(request.water, source_depth_m, all[k].depth_m, all[k].range_m, request.options);
    progress.step();
  });
  return all;
}

std::vector<FanRay> fan_of(const RaysRequest& request, const std::vector<double>& angles_deg, double range_m,
                           std::optional<int> most_reflections) {
  if (!(angles_deg.front() > -90 && angles_deg.back() < 90))
    throw UsageError(
        "--angles: expected launch angles between -90 and 90 degrees: a vertical ray reaches no range");
  if (!(range_m > 0)) throw UsageError("--ranges: expected a range above 0 m, to which the rays are traced");
  RayTraceOptions trace;
  trace.surface_m = request.options.surface_m;
  trace.bottom_m = request.options.bottom_m;
  trace.longest_range_m = range_m;
  if (most_reflections) trace.most_reflections = static_cast<std::size_t>(*most_reflections) + 1;
  std::vector<FanRay> fan;
  std::size_t nodes = 0;
  constexpr std::size_t most_nodes = 20'000'000;
  for (const double angle_deg : angles_deg) {
    fan.push_back({angle_deg * degree,
                   trace_ray(request.water, request.depth_m(request.source_m), angle_deg * degree, trace)});
    if ((nodes += fan.back().nodes.size()) > most_nodes)
      throw UsageError(
          fmt::format("the fan has more than {} points: increase the step of --angles, or reduce "
                      "--ranges or --reflections",
                      most_nodes));
  }
  return fan;
}

}  // namespace tubefoot
