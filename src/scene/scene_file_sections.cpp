// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/scene_file_sections.hpp"

#include <algorithm>

#include "scene/scene_file_words.hpp"

namespace tubefoot {
namespace {

/// Coordinates and sizes: more than the Earth's radius is a slip, and the world grid ends at 2^30 m.
constexpr double far_m = 1e7;
constexpr ValueRange coordinate{.lo = -far_m, .hi = far_m};
constexpr ValueRange size{.lo = 0, .hi = far_m, .lo_excluded = true};
constexpr ValueRange size_or_zero{.lo = 0, .hi = far_m};
constexpr ValueRange height{.lo = 0, .hi = 10000};
constexpr ValueRange heading{.lo = -360, .hi = 360};
constexpr ValueRange pitch{.lo = -90, .hi = 90};
constexpr ValueRange roll{.lo = -180, .hi = 180};
constexpr ValueRange latitude{.lo = -90, .hi = 90};
constexpr ValueRange longitude{.lo = -180, .hi = 180};
constexpr ValueRange not_negative{.lo = 0};
constexpr ValueRange range_samples{.lo = 1, .hi = 65536};
constexpr ValueRange sonar_range{.lo = 0, .hi = 100000, .lo_excluded = true};
constexpr ValueRange frequency{.lo = 1, .hi = 10000};
constexpr ValueRange index{.lo = 0, .hi = 1000000};
constexpr ValueRange count_of_two{.lo = 2, .hi = 1000000};

constexpr const char* no_width = "a sector of no width sees nothing";
constexpr const char* too_wide =
    "a sector so wide does not project onto a plane, share it among several sensors";
constexpr ValueRange sector(double hi, bool hi_excluded) {
  return {.lo = 0,
          .hi = hi,
          .lo_excluded = true,
          .hi_excluded = hi_excluded,
          .if_below = no_width,
          .if_above = too_wide};
}

/// The place of the later key, or of the earlier one where the later is left to its default.
SourcePlace place_of_pair(const TomlTable& table, std::string_view earlier, std::string_view later) {
  return table.place_of(table.has(later) ? later : earlier);
}

void check_georeference(const GeoreferenceDescription& g, const TomlTable& table) {
  if (g.origin_lat_lon_deg && (g.crs || g.origin_crs)) {
    throw InputError(
        place_of_pair(table, "origin_crs", "crs"),
        "the frame lies at 'origin_lat_lon_deg' or in 'crs' at 'origin_crs': give only one of the two");
  }
  if (!g.origin_lat_lon_deg && !g.crs && !g.origin_crs) {
    throw InputError(table.place, "[georeference] needs 'origin_lat_lon_deg', or 'crs' with 'origin_crs'");
  }
  if (g.crs.has_value() != g.origin_crs.has_value()) {
    throw InputError(
        place_of_pair(table, "origin_crs", "crs"),
        fmt::format("'crs' and 'origin_crs' go together: add '{}'", g.crs ? "origin_crs" : "crs"));
  }
}

void check_water(const WaterDescription& water, const TomlTable& table) {
  if (water.sound_speed_m_s) return;
  // Mackenzie 1981 is fitted to these ranges; the temperature's own range is narrow enough.
  if (water.salinity_psu < 25) {
    throw InputError(
        table.place_of("salinity_psu"),
        fmt::format("the formula for sound speed holds for a 'salinity_psu' of 25 to 40, not {}: give "
                    "'sound_speed_m_s' for fresh or brackish water",
                    water.salinity_psu));
  }
  if (water.depth_m > 8000) {
    throw InputError(
        table.place_of("depth_m"),
        fmt::format("the formula for sound speed holds for a 'depth_m' of 0 to 8000, not {}: give "
                    "'sound_speed_m_s' for deeper water",
                    water.depth_m));
  }
}

void check_terrain(const TerrainDescription& terrain, const TomlTable& table) {
  const auto* fractal = std::get_if<FractalTerrain>(&terrain.kind);
  if (fractal != nullptr && fractal->ripple_height_m > 0 &&
      fractal->ripple_wavelength_m <= 2 * fractal->cell_m) {
    throw InputError(
        place_of_pair(table, "ripple_wavelength_m", "cell_m"),
        fmt::format("cells of {} metres cannot show ripples of {} metres: 'cell_m' must be less than "
                    "half of 'ripple_wavelength_m'",
                    fractal->cell_m, fractal->ripple_wavelength_m));
  }
}

void check_trajectory(const TrajectoryDescription& trajectory, const TomlTable& table) {
  const auto* line = std::get_if<LineTrajectory>(&trajectory.kind);
  if (line == nullptr) return;
  if (line->start_m == line->end_m) {
    throw InputError(table.place_of("end_m"),
                     "'end_m' equals 'start_m': a line has a length (kind = \"fixed\" stays in place)");
  }
  if (line->start_m[0] == line->end_m[0] && line->start_m[1] == line->end_m[1]) {
    throw InputError(
        table.place_of("end_m"),
        "'end_m' lies straight above or below 'start_m': heading follows the line, so a vertical one has "
        "none (use kind = \"waypoints\")");
  }
}

/// Of a sensor's transmit or receive pattern: each pattern needs its own measure and takes no other.
void check_pattern(const PatternDescription& pattern, const std::string& side, const TomlTable& table) {
  const struct {
    const char* measure;
    bool given;
    std::vector<std::string> patterns;
  } rules[] = {
      {"_aperture_m", pattern.aperture_m.has_value(), {"line", "piston"}},
      {"_beam_width_deg", pattern.width_deg.has_value(), {"gaussian"}},
      {"_pattern_file", pattern.file.has_value(), {"table"}},
      {"_pattern_angle", table.has(side + "_pattern_angle"), {"line", "gaussian", "table"}},
  };
  for (const auto& [measure, given, patterns] : rules) {
    const bool takes = std::ranges::find(patterns, pattern.pattern) != patterns.end();
    const std::string key = side + measure,
                      choice = fmt::format("{}_pattern = \"{}\"", side, pattern.pattern);
    if (given && !takes) {
      throw InputError(table.place_of(key),
                       fmt::format("'{}' goes with {}_pattern = {} and not with {}: remove it, or change the "
                                   "latter",
                                   key, side, one_of(patterns, '"'), choice));
    }
    if (takes && !given && key != side + "_pattern_angle")
      throw InputError(table.place_of(side + "_pattern"), fmt::format("{} needs the key '{}'", choice, key));
  }
  if (pattern.pattern == "line" && pattern.angle == "off_axis") {
    throw InputError(table.place_of(side + "_pattern_angle"),
                     fmt::format("a line array's pattern depends on \"azimuth\" or \"elevation\", not on "
                                 "\"off_axis\": take {}_pattern = \"piston\" for a round aperture",
                                 side));
  }
}

void check_sensor(const SensorDescription& sensor, const TomlTable& table) {
  check_pattern(sensor.transmit, "transmit", table);
  check_pattern(sensor.receive, "receive", table);
  constexpr std::size_t longest_name = 64;
  constexpr std::string_view allowed = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-";
  if (sensor.name.size() > longest_name || sensor.name.find_first_not_of(allowed) != std::string::npos) {
    throw InputError(
        table.place_of("name"),
        fmt::format("a sensor's 'name' becomes the name of files: expected at most {} of the characters "
                    "A-Z a-z 0-9 _ -, not \"{}\"",
                    longest_name, sensor.name));
  }
  if (const auto* sidescan = std::get_if<SidescanDescription>(&sensor.kind)) {
    if (sidescan->depression_min_deg >= sidescan->depression_max_deg) {
      throw InputError(
          place_of_pair(table, "depression_min_deg", "depression_max_deg"),
          fmt::format("'depression_min_deg' ({}) must be less than 'depression_max_deg' ({}): {}",
                      sidescan->depression_min_deg, sidescan->depression_max_deg, no_width));
    }
    if (sidescan->range_min_m >= sidescan->range_max_m) {
      throw InputError(place_of_pair(table, "range_min_m", "range_max_m"),
                       fmt::format("'range_min_m' ({}) must be less than 'range_max_m' ({})",
                                   sidescan->range_min_m, sidescan->range_max_m));
    }
  }
}

void check_run(const RunDescription& run, const TomlTable& table) {
  if (run.rays_per_beam && table.has("rays_per_ping")) {
    throw InputError(table.place_of("rays_per_beam"),
                     "rays are counted by ping or by beam: remove 'rays_per_ping' or 'rays_per_beam'");
  }
}

/// The keys of a transmit or receive pattern, as keys of the sensor.
std::vector<TomlField<SensorDescription>> pattern_fields(const std::string& side,
                                                         PatternDescription SensorDescription::*pattern) {
  using P = PatternDescription;
  constexpr ValueRange aperture{.lo = 0, .hi = 1000, .lo_excluded = true};
  constexpr ValueRange width{.lo = 0, .hi = 180, .lo_excluded = true};
  const std::vector<TomlField<P>> own{
      field(side + "_pattern", &P::pattern, {.choices = {"none", "line", "piston", "gaussian", "table"}}),
      field(side + "_pattern_angle", &P::angle, {.choices = {"azimuth", "elevation", "off_axis"}}),
      field(side + "_aperture_m", &P::aperture_m, {.ranges = {aperture}}),
      field(side + "_beam_width_deg", &P::width_deg, {.ranges = {width}}),
      field(side + "_pattern_file", &P::file)};
  std::vector<TomlField<SensorDescription>> fields;
  for (const TomlField<P>& f : own) {
    const bool is_file = f.key.type == "file";
    fields.push_back({f.key, [read = f.read, pattern, is_file](const toml::node& node, TomlSource& source,
                                                               SensorDescription& s) {
                        read(node, source, s.*pattern);
                        if (is_file) (s.*pattern).file_place = source.place(node.source());
                      }});
  }
  return fields;
}

}  // namespace

const TomlField<SceneDescription>& title_field() {
  static const auto title = field("title", &SceneDescription::title);
  return title;
}

const TomlSection<GeoreferenceDescription>& georeference_section() {
  using G = GeoreferenceDescription;
  static const auto section =
      TomlSection<G>("[georeference]")
          .keys({field("origin_lat_lon_deg", &G::origin_lat_lon_deg, {.ranges = {latitude, longitude}}),
                 field("crs", &G::crs), field("origin_crs", &G::origin_crs),
                 field("origin_height_m", &G::origin_height_m, {.ranges = {{.lo = -12000, .hi = 12000}}})})
          .check(check_georeference);
  return section;
}

const TomlSection<WaterDescription>& water_section() {
  using W = WaterDescription;
  static const auto section =
      TomlSection<W>("[water]")
          .keys(
              {field("sound_speed_m_s", &W::sound_speed_m_s, {.ranges = {{.lo = 1300, .hi = 1700}}}),
               field("absorption_db_per_km", &W::absorption_db_per_km, {.ranges = {{.lo = 0, .hi = 100000}}}),
               field("temperature_c", &W::temperature_c, {.ranges = {{.lo = -2, .hi = 30}}}),
               field("salinity_psu", &W::salinity_psu, {.ranges = {{.lo = 0, .hi = 40}}}),
               field("ph", &W::ph, {.ranges = {{.lo = 6, .hi = 9}}}),
               field("depth_m", &W::depth_m, {.ranges = {{.lo = 0, .hi = 10000}}})})
          .check(check_water);
  return section;
}

const TomlSection<MaterialDescription>& material_section() {
  using M = MaterialDescription;
  // 10 log10(1 / pi), rounded towards less energy (physics: Lambert, pi mu <= 1).
  constexpr ValueRange lambert{
      .lo = -120, .hi = -4.9715, .if_above = "a surface cannot scatter more than it receives"};
  static const auto section = TomlSection<M>("[[materials]]")
                                  .keys({field("name", &M::name, {.required = true}),
                                         field("lambert_db", &M::lambert_db, {.ranges = {lambert}})});
  return section;
}

const TomlSection<TerrainDescription>& terrain_section() {
  using T = TerrainDescription;
  using Flat = FlatTerrain;
  using Fractal = FractalTerrain;
  using Raster = RasterTerrain;
  static const auto section =
      TomlSection<T>("[[terrain]]")
          .keys({field("name", &T::name),
                 field("material", &T::material, {.default_value = "the only material"})})
          .kind<Flat>("kind", "flat",
                      {field("width_m", &Flat::width_m, {.ranges = {size}, .required = true}),
                       field("length_m", &Flat::length_m, {.ranges = {size}, .required = true}),
                       field("centre_m", &Flat::centre_m, {.ranges = {coordinate}}),
                       field("cell_m", &Flat::cell_m, {.ranges = {size_or_zero}})})
          .kind<Fractal>(
              "kind", "fractal",
              {field("width_m", &Fractal::width_m, {.ranges = {size}, .required = true}),
               field("length_m", &Fractal::length_m, {.ranges = {size}, .required = true}),
               field("centre_m", &Fractal::centre_m, {.ranges = {coordinate}}),
               field("cell_m", &Fractal::cell_m, {.ranges = {size}}),
               field("rms_height_m", &Fractal::rms_height_m, {.ranges = {height}}),
               field("hurst", &Fractal::hurst,
                     {.ranges = {{.lo = 0, .hi = 1, .lo_excluded = true, .hi_excluded = true}}}),
               field("largest_wavelength_m", &Fractal::largest_wavelength_m, {.ranges = {size_or_zero}}),
               field("seed", &Fractal::seed, {.ranges = {not_negative}}),
               field("ripple_height_m", &Fractal::ripple_height_m, {.ranges = {height}}),
               field("ripple_wavelength_m", &Fractal::ripple_wavelength_m, {.ranges = {size}}),
               field("ripple_direction_deg", &Fractal::ripple_direction_deg, {.ranges = {heading}})})
          .kind<Raster>(
              "kind", "raster",
              {field("file", &Raster::file, {.required = true}),
               field("window", &Raster::window, {.ranges = {index, index, count_of_two, count_of_two}}),
               field("decimate", &Raster::decimate, {.ranges = {{.lo = 1, .hi = 10000}}}),
               field("depth_positive_down", &Raster::depth_positive_down)})
          .check(check_terrain);
  return section;
}

const TomlSection<ObjectDescription>& object_section() {
  using O = ObjectDescription;
  using Sphere = SpherePrimitive;
  using Cylinder = CylinderPrimitive;
  using Cone = ConePrimitive;
  static const auto chord_error = field("chord_error_m", &O::chord_error_m, {.ranges = {size}});
  static const auto section =
      TomlSection<O>("[[objects]]")
          .keys({field("name", &O::name, {.required = true}),
                 field("material", &O::material, {.default_value = "the only material"}),
                 field("position_m", &O::position_m, {.ranges = {coordinate}}),
                 field("position_lat_lon_deg", &O::position_lat_lon_deg, {.ranges = {latitude, longitude}}),
                 field("on_terrain_m", &O::on_terrain_m, {.ranges = {coordinate}}),
                 field("heading_deg", &O::heading_deg, {.ranges = {heading}}),
                 field("pitch_deg", &O::pitch_deg, {.ranges = {pitch}}),
                 field("roll_deg", &O::roll_deg, {.ranges = {roll}}),
                 field("scale", &O::scale, {.ranges = {{.lo = 0, .hi = 1e6, .lo_excluded = true}}})})
          .kind<MeshFile>("shape", "mesh", {field("file", &MeshFile::file, {.required = true})},
                          {field("y_up", &O::y_up)})
          .kind<Sphere>("shape", "sphere", {field("radius_m", &Sphere::radius_m, {.ranges = {size}})},
                        {chord_error})
          .kind<Cylinder>("shape", "cylinder",
                          {field("radius_m", &Cylinder::radius_m, {.ranges = {size}}),
                           field("height_m", &Cylinder::height_m, {.ranges = {size}})},
                          {chord_error})
          .kind<Cone>("shape", "cone",
                      {field("radius_m", &Cone::radius_m, {.ranges = {size}}),
                       field("top_radius_m", &Cone::top_radius_m, {.ranges = {size_or_zero}}),
                       field("height_m", &Cone::height_m, {.ranges = {size}})},
                      {chord_error})
          .kind<BoxPrimitive>("shape", "box", {field("size_m", &BoxPrimitive::size_m, {.ranges = {size}})});
  return section;
}

const TomlSection<TrajectoryDescription>& trajectory_section() {
  using T = TrajectoryDescription;
  using Fixed = FixedTrajectory;
  using Line = LineTrajectory;
  using Waypoints = WaypointTrajectory;
  constexpr ValueRange speed{.lo = 0, .hi = 100, .lo_excluded = true};
  static const auto section =
      TomlSection<T>("[[trajectories]]")
          .keys({field("name", &T::name)})
          .kind<Fixed>("kind", "fixed",
                       {field("position_m", &Fixed::position_m, {.ranges = {coordinate}}),
                        field("heading_deg", &Fixed::heading_deg, {.ranges = {heading}}),
                        field("pitch_deg", &Fixed::pitch_deg, {.ranges = {pitch}}),
                        field("roll_deg", &Fixed::roll_deg, {.ranges = {roll}})})
          .kind<Line>("kind", "line",
                      {field("start_m", &Line::start_m, {.ranges = {coordinate}, .required = true}),
                       field("end_m", &Line::end_m, {.ranges = {coordinate}, .required = true}),
                       field("speed_m_s", &Line::speed_m_s, {.ranges = {speed}}),
                       field("pitch_deg", &Line::pitch_deg, {.ranges = {pitch}}),
                       field("roll_deg", &Line::roll_deg, {.ranges = {roll}})})
          .kind<Waypoints>("kind", "waypoints", {field("file", &Waypoints::file, {.required = true})})
          .check(check_trajectory);
  return section;
}

const TomlSection<SensorDescription>& sensor_section() {
  using S = SensorDescription;
  using Didson = DidsonDescription;
  using Sidescan = SidescanDescription;
  constexpr ValueRange lever_arm{.lo = -1000, .hi = 1000};
  // Together these two keep a fan narrower than 170 degrees.
  constexpr ValueRange depression{
      .lo = -80, .hi = 90, .if_below = too_wide, .if_above = "90 is straight down"};
  static const auto section =
      TomlSection<S>("[[sensors]]")
          .keys({field("name", &S::name, {.required = true}),
                 field("trajectory", &S::trajectory, {.default_value = "the only trajectory"}),
                 field("lever_arm_m", &S::lever_arm_m, {.ranges = {lever_arm}}),
                 field("yaw_deg", &S::yaw_deg, {.ranges = {heading}}),
                 field("tilt_deg", &S::tilt_deg, {.ranges = {pitch}}),
                 field("roll_deg", &S::roll_deg, {.ranges = {roll}}),
                 field("first_ping_s", &S::first_ping_s, {.ranges = {{.lo = -1e10, .hi = 1e10}}}),
                 field("pings", &S::pings, {.ranges = {{.lo = 1, .hi = 1e7}}}),
                 field("ping_interval_s", &S::ping_interval_s,
                       {.ranges = {{.lo = 0, .hi = 1e6, .lo_excluded = true}}})})
          .keys(pattern_fields("transmit", &S::transmit))
          .keys(pattern_fields("receive", &S::receive))
          .kind<Didson>("kind", "didson",
                        {field("frequency_khz", &Didson::frequency_khz, {.ranges = {frequency}}),
                         field("beams", &Didson::beams, {.ranges = {{.lo = 1, .hi = 4096}}}),
                         field("horizontal_deg", &Didson::horizontal_deg, {.ranges = {sector(180, true)}}),
                         field("vertical_deg", &Didson::vertical_deg, {.ranges = {sector(170, false)}}),
                         field("transmit_horizontal_deg", &Didson::transmit_horizontal_deg,
                               {.ranges = {sector(180, true)}, .default_value = "as horizontal_deg"}),
                         field("transmit_vertical_deg", &Didson::transmit_vertical_deg,
                               {.ranges = {sector(170, false)}, .default_value = "as vertical_deg"}),
                         field("samples", &Didson::samples, {.ranges = {range_samples}}),
                         field("window_start_m", &Didson::window_start_m, {.ranges = {sonar_range}}),
                         field("window_length_m", &Didson::window_length_m, {.ranges = {sonar_range}})})
          .kind<Sidescan>(
              "kind", "sidescan",
              {field("frequency_khz", &Sidescan::frequency_khz, {.ranges = {frequency}}),
               field("along_track_deg", &Sidescan::along_track_deg, {.ranges = {sector(90, false)}}),
               field("depression_min_deg", &Sidescan::depression_min_deg, {.ranges = {depression}}),
               field("depression_max_deg", &Sidescan::depression_max_deg, {.ranges = {depression}}),
               field("samples", &Sidescan::samples, {.ranges = {range_samples}}),
               field("range_min_m", &Sidescan::range_min_m, {.ranges = {sonar_range}}),
               field("range_max_m", &Sidescan::range_max_m, {.ranges = {sonar_range}})})
          .check(check_sensor);
  return section;
}

const TomlSection<RunDescription>& run_section() {
  using R = RunDescription;
  static const auto section =
      TomlSection<R>("[run]")
          .keys(
              {field("engine", &R::engine, {.choices = {"tube", "ray"}}),
               field("arithmetic", &R::arithmetic, {.choices = {"fixed", "filtered", "rational", "double"}}),
               field("binning", &R::binning, {.choices = {"exact", "spread", "centroid"}}),
               field("facets_per_split", &R::facets_per_split, {.ranges = {{.lo = 2, .hi = 1e6}}}),
               field("zero_tolerance", &R::zero_tolerance, {.ranges = {{.lo = 0, .hi = 1e-3}}}),
               field("sampling", &R::sampling, {.choices = {"stratified", "regular", "random", "column"}}),
               field("rays_per_ping", &R::rays_per_ping, {.ranges = {{.lo = 1, .hi = 1e10}}}),
               field("rays_per_beam", &R::rays_per_beam, {.ranges = {{.lo = 1, .hi = 1e10}}}),
               field("seed", &R::seed, {.ranges = {not_negative}}),
               field("grid_exponent", &R::grid_exponent, {.ranges = {{.lo = 0, .hi = 30}}}),
               field("threads", &R::threads, {.ranges = {{.lo = 0, .hi = 1024}}})})
          .check(check_run);
  return section;
}

}  // namespace tubefoot
