// SPDX-License-Identifier: GPL-3.0-or-later
// The command `rays`: eigenrays from a sensor or a position to points, or a fan of rays.
#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "app/commands.hpp"
#include "files/checked_file.hpp"
#include "files/number_list.hpp"
#include "files/usage_error.hpp"
#include "propagation/bellhop_file.hpp"
#include "propagation/rays_output.hpp"
#include "propagation/rays_request.hpp"
#include "run/console/say.hpp"
#include "run/settings.hpp"
#include "run/survey.hpp"

namespace tubefoot {
namespace {

constexpr double no_surface = -std::numeric_limits<double>::infinity();

void check_words(const RaysOptions& options) {
  if (options.scene.empty() && !options.profile)
    throw UsageError("no water: expected a scene file or --profile FILE.csv");
  if (options.profile && !options.from)
    throw UsageError("--profile has no sensor: give the position of the source with --from X,Y,Z");
  if (options.angles.empty()) {
    if (options.ranges.empty() != options.depths.empty())
      throw UsageError("--ranges and --depths belong together: give both");
    if (options.to.empty() && options.ranges.empty())
      throw UsageError("no points: expected --to X,Y,Z, or --ranges and --depths, or --angles for a fan");
    if (options.environment && !options.to.empty())
      throw UsageError("--environment needs points on a grid: give --ranges and --depths instead of --to");
  } else {
    if (!options.to.empty()) throw UsageError("--angles traces a fan, which has no points: remove --to");
    if (options.ranges.empty())
      throw UsageError("--angles needs --ranges: expected the range at which the rays end");
  }
}

/// The water and the source of a scene.
RaysRequest request_of(const SceneDescription& description, const RaysOptions& options) {
  RaysRequest request;
  request.water_name = description.title.empty() ? options.scene.filename().string() : description.title;
  const bool has_level = description.sea_surface || description.water.surface_height_m;
  const auto set_water = [&](const SceneWater& water, WaterColumn column) {
    request.water = std::move(column);
    request.surface_height_m = description.sea_surface && !description.water.surface_height_m
                                   ? description.sea_surface->height_m
                                   : water.surface_height_m();
    request.options.surface_m = has_level || water.refracts() ? 0 : no_surface;
  };
  if (options.from) {
    const SceneWater water(description.water);
    const bool absorbs = options.frequency_khz || description.water.absorption_db_per_km;
    set_water(water,
              absorbs ? water.column(options.frequency_khz.value_or(1)) : WaterColumn{water.profile(), {}});
    request.source_m = point_of(*options.from, "--from");
    return request;
  }
  const auto survey = open_survey(description);
  print_warnings(survey->scene.report.warnings, options.quiet);
  const std::size_t sensor = options.sensor ? survey->sensor_set->sensor_named(*options.sensor) : 0;
  const SensorPings& pings = survey->sensors.at(sensor);
  const PingRange range = resolved(options.pings, pings.times_s.size(), options.sensor.value_or(""));
  if (range.first != range.last)
    throw UsageError(
        fmt::format("--pings '{}': expected one ping, whose position is the source", options.pings));
  const SceneWater& water = *survey->scene.water;
  WaterColumn column{water.profile(), {}};
  if (options.frequency_khz)
    column = water.column(*options.frequency_khz);
  else if (!pings.water.empty())
    column = *pings.water.front();
  else
    column.absorption_db_per_m.assign(column.profile.layers(),
                                      absorption_db_per_m(survey->scene, *pings.sensor, 0));
  set_water(water, std::move(column));
  request.source_m = pings.transmission_pose(static_cast<std::size_t>(range.first), 0).position_m;
  return request;
}

/// The water of a table, with the surface at height 0.
RaysRequest request_of(const std::filesystem::path& profile, const RaysOptions& options) {
  WaterDescription description;
  description.profile = "table";
  description.profile_file = profile;
  const SceneWater water(description);
  RaysRequest request;
  request.water_name = profile.filename().string();
  request.water =
      options.frequency_khz ? water.column(*options.frequency_khz) : WaterColumn{water.profile(), {}};
  request.source_m = point_of(*options.from, "--from");
  request.options.surface_m = 0;
  return request;
}

void finish(RaysRequest& request, const RaysOptions& options) {
  ArrivalOptions& limits = request.options;
  if (options.bottom_m) limits.bottom_m = *options.bottom_m;
  limits.most_turns = options.turns;
  limits.most_reflections = options.reflections.value_or(0);
  if (!(limits.bottom_m > limits.surface_m))
    throw UsageError(fmt::format("--bottom {:g}: expected a depth below the surface, at {:g} m",
                                 limits.bottom_m, limits.surface_m));
  if (limits.most_reflections > 0 && limits.surface_m == no_surface && !options.bottom_m)
    throw UsageError(
        "--reflections: the scene has no sea surface and no bottom: add [sea_surface] to the scene, or give "
        "--bottom");
  const double depth_m = request.depth_m(request.source_m);
  if (!(depth_m >= limits.surface_m && depth_m <= limits.bottom_m))
    throw UsageError(
        fmt::format("the source is at a depth of {:g} m, but the water extends from {:g} to {:g} m: "
                    "move the source",
                    depth_m, limits.surface_m, limits.bottom_m));
}

/// Names the points that no ray reaches.
void report(const std::vector<PointArrivals>& points, bool to_file, bool quiet) {
  std::size_t rays = 0, dark = 0;
  std::string names;
  constexpr std::size_t most_named = 10;
  for (std::size_t k = 0; k < points.size(); ++k) {
    rays += points[k].arrivals.size();
    if (!points[k].arrivals.empty()) continue;
    if (++dark <= most_named) names += fmt::format("{}{}", dark > 1 ? ", " : "", k + 1);
  }
  if (dark > most_named) names += ", ...";
  if (to_file) {
    tell("points         {}\neigenrays      {}\n", points.size(), rays);
    if (dark > 0) tell("shadow         {} points without an eigenray: {}\n", dark, names);
  } else if (dark > 0 && !quiet) {
    say("warning: {} of {} points lie in a shadow zone, without an eigenray: {}\n", dark, points.size(),
        names);
  }
}

}  // namespace

int rays_command(const RaysOptions& options) {
  check_words(options);
  const ThreadLimit limit(options.threads.value_or(0));
  Inputs inputs;
  RaysRequest request;
  if (options.profile) {
    inputs = {*options.profile};
    request = request_of(*options.profile, options);
  } else {
    const SceneDescription description = described(options);
    inputs = inputs_of(description);
    request = request_of(description, options);
  }
  finish(request, options);
  std::vector<glm::dvec3> points_m;
  for (const std::string& to : options.to) {
    if (to.ends_with(".csv")) {
      inputs.emplace_back(to);
      std::ranges::copy(points_of_file(to), std::back_inserter(points_m));
    } else {
      points_m.push_back(point_of(to, "--to"));
    }
  }
  std::optional<OutputFile> output;
  if (options.output) output.emplace(*options.output, inputs);
  std::optional<RaysPicture> picture;
  if (options.picture) picture.emplace(*options.picture, inputs);
  std::optional<OutputFile> environment;
  if (options.environment) environment.emplace(*options.environment, inputs);

  std::string table, svg;
  BellhopRun bellhop;
  if (!options.ranges.empty()) bellhop.ranges_m = lengths_of(options.ranges, "--ranges");
  if (!options.depths.empty()) bellhop.depths_m = lengths_of(options.depths, "--depths");
  if (options.angles.empty()) {
    if (!options.ranges.empty())
      std::ranges::copy(
          points_at(request, lengths_of(options.ranges, "--ranges"), lengths_of(options.depths, "--depths")),
          std::back_inserter(points_m));
    const std::vector<PointArrivals> points = eigenrays_of(request, points_m, options.quiet);
    table = to_csv(request, points);
    std::vector<std::pair<double, double>> places;
    for (const PointArrivals& point : points) places.emplace_back(point.range_m, point.depth_m);
    if (picture) svg = to_svg(request, drawn(request, points), places);
    bellhop.angles_deg = beam_angles_deg(points);
    report(points, output.has_value(), options.quiet);
  } else {
    bellhop.angles_deg = numbers_of(
        options.angles, {"--angles", "FIRST:LAST:STEP or numbers separated by commas, in degrees", 1.0});
    const std::vector<FanRay> fan =
        fan_of(request, bellhop.angles_deg, bellhop.ranges_m.back(), options.reflections);
    table = to_csv(request, fan);
    if (picture) svg = to_svg(request, drawn(fan), {});
    if (output) tell("rays           {}\n", fan.size());
  }
  if (output) {
    write_file(output->path(), table);
    output->commit();
    tell("wrote {}\n", options.output->string());
  } else {
    tell("{}", table);
  }
  if (picture) {
    picture->write(svg);
    if (output) tell("wrote {}\n", options.picture->string());
  }
  if (environment) {
    write_file(environment->path(), bellhop_environment(request, bellhop));
    environment->commit();
    if (output) tell("wrote {}\n", options.environment->string());
  }
  return 0;
}

}  // namespace tubefoot
