// SPDX-License-Identifier: GPL-3.0-or-later
// Defines the section [[sensors]] of a scene file: keys of all sensors, of their patterns and of their
// receivers. Each kind of sensor adds its own keys (docs/scene-file.md).
#include <algorithm>

#include "files/limits.hpp"
#include "files/words.hpp"
#include "scene/file/scene_file_ranges.hpp"
#include "scene/file/scene_file_sections.hpp"

namespace tubefoot {
namespace {

/// Checks a transmit or receive pattern of a sensor. Each pattern needs its own measure and permits no
/// other.
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

void check_signal(const SignalDescription& signal, const TomlTable& table) {
  const struct {
    const char* key;
    bool takes;
    const char* wanted;
  } rules[] = {
      {"speckle_looks", signal.speckle != "none", "speckle = \"rayleigh\" or \"k\""},
      {"speckle_shape", signal.speckle == "k", "speckle = \"k\""},
      {"tvg_absorption_db_per_km", signal.tvg_spreading.has_value(), "'tvg_spreading'"},
      {"tvg_gain_db", signal.tvg_spreading.has_value(), "'tvg_spreading'"},
      {"tvg_fixed_below_m", signal.tvg_spreading.has_value(), "'tvg_spreading'"},
  };
  for (const auto& [key, takes, wanted] : rules)
    if (table.has(key) && !takes)
      throw InputError(table.place_of(key),
                       fmt::format("'{}' needs {}: add it, or remove the key", key, wanted));
}

/// Limits the energies of a ping and the poses of a sensor, because memory holds all of them.
void check_amounts(const SensorDescription& sensor, const TomlTable& table) {
  const SensorFigures figures = figures_of(sensor);
  const std::int64_t cells = figures.beams * figures.samples;
  if (cells > limits::ping_cells)
    throw InputError(
        place_of_pair(table, "beams", "samples"),
        fmt::format("'beams' and 'samples' make {} range samples a ping, at most {} are taken: lower "
                    "one of the two, or share the beams among several sensors",
                    cells, limits::ping_cells));
  const std::int64_t transmissions = sensor.pings.value_or(1) * figures.transmissions;
  if (transmissions > limits::sensor_transmissions)
    throw InputError(
        table.place_of("pings"),
        fmt::format("'pings' of {} transmissions each make {}, at most {} are taken: ask for fewer pings, in "
                    "several scenes",
                    figures.transmissions, transmissions, limits::sensor_transmissions));
}

void check_sensor(const SensorDescription& sensor, const TomlTable& table) {
  check_pattern(sensor.transmit, "transmit", table);
  check_pattern(sensor.receive, "receive", table);
  check_signal(sensor.signal, table);
  constexpr std::size_t longest_name = 64;
  constexpr std::string_view allowed = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-";
  if (sensor.name.size() > longest_name || sensor.name.find_first_not_of(allowed) != std::string::npos) {
    throw InputError(
        table.place_of("name"),
        fmt::format("a sensor's 'name' becomes the name of files: expected at most {} of the characters "
                    "A-Z a-z 0-9 _ -, not \"{}\"",
                    longest_name, sensor.name));
  }
  if (sensor.look_at_m) {
    if (!sensor.kind.section().looks_ahead())
      throw InputError(
          table.place_of("look_at_m"),
          fmt::format("'look_at_m' turns sonars that look ahead, which kind = \"{}\" does not: give "
                      "'yaw_deg', 'tilt_deg' and 'roll_deg'",
                      sensor.kind.section().name()));
    for (const char* key : {"yaw_deg", "tilt_deg"})
      if (table.has(key))
        throw InputError(
            table.place_of(key),
            fmt::format("'look_at_m' turns the sensor already: remove '{}' or 'look_at_m'", key));
  }
  sensor.kind.section().check(sensor, table);
  check_amounts(sensor, table);
}

/// Returns the keys of a transmit or receive pattern as keys of the sensor.
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
                        if (is_file) (s.*pattern).file_place = source.place(node);
                      }});
  }
  return fields;
}

/// Returns the keys of the receiver as keys of the sensor.
std::vector<TomlField<SensorDescription>> signal_fields() {
  using G = SignalDescription;
  constexpr ValueRange level{.lo = -300, .hi = 300};
  const std::vector<TomlField<G>> own{
      field("source_level_db", &G::source_level_db, {.ranges = {level}}),
      field("noise_level_db", &G::noise_level_db, {.ranges = {level}}),
      field("speckle", &G::speckle, {.choices = {"none", "rayleigh", "k"}}),
      field("speckle_looks", &G::speckle_looks, {.ranges = {{.lo = 1, .hi = 1024}}}),
      field("speckle_shape", &G::speckle_shape, {.ranges = {{.lo = 0.01, .hi = 1e6}}}),
      field("tvg_spreading", &G::tvg_spreading, {.ranges = {{.lo = 0, .hi = 60}}}),
      field("tvg_absorption_db_per_km", &G::tvg_absorption_db_per_km,
            {.ranges = {{.lo = 0, .hi = 100000}}, .default_value = "the water's"}),
      field("tvg_gain_db", &G::tvg_gain_db, {.ranges = {level}}),
      field("tvg_fixed_below_m", &G::tvg_fixed_below_m, {.ranges = {sonar_range}}),
      field("display_gain_db", &G::display_gain_db, {.ranges = {{.lo = -100, .hi = 100}}}),
      field("pulse_length_us", &G::pulse_length_us,
            {.ranges = {{.lo = 0, .hi = 100000, .lo_excluded = true}}})};
  std::vector<TomlField<SensorDescription>> fields;
  for (const TomlField<G>& f : own)
    fields.push_back({f.key, [read = f.read](const toml::node& node, TomlSource& source,
                                             SensorDescription& s) { read(node, source, s.signal); }});
  return fields;
}

}  // namespace

TomlSection<SensorDescription> sensor_section(const SensorSections& kinds) {
  using S = SensorDescription;
  constexpr ValueRange lever_arm{.lo = -1000, .hi = 1000};
  // Files of instruments contain times since 1970 as doubles, with a resolution of a quarter of a
  // microsecond. With a shorter interval, two pings would have the same time.
  constexpr ValueRange ping_interval{.lo = 1e-6, .hi = 1e6};
  TomlSection<S> section("[[sensors]]");
  section
      .keys({field("name", &S::name, {.required = true, .longest = limits::name_bytes}),
             field("preset", &S::preset, {.longest = limits::name_bytes}),
             field("trajectory", &S::trajectory, {.default_value = "the only trajectory"}),
             field("lever_arm_m", &S::lever_arm_m, {.ranges = {lever_arm}}),
             field("receiver_arm_m", &S::receiver_arm_m,
                   {.ranges = {lever_arm}, .default_value = "as lever_arm_m"}),
             field("yaw_deg", &S::yaw_deg, {.ranges = {heading}}),
             field("tilt_deg", &S::tilt_deg, {.ranges = {pitch}}),
             field("roll_deg", &S::roll_deg, {.ranges = {roll}}),
             field("look_at_m", &S::look_at_m, {.ranges = {coordinate}}),
             field("first_ping_s", &S::first_ping_s, {.ranges = {{.lo = -1e10, .hi = 1e10}}}),
             field("pings", &S::pings,
                   {.ranges = {{.lo = 1, .hi = 1e7}}, .default_value = "1; of a survey, all"}),
             field("ping_interval_s", &S::ping_interval_s, {.ranges = {ping_interval}}),
             field("cone_tolerance", &S::cone_tolerance, {.ranges = {{.lo = 1e-9, .hi = 0.01}}})})
      .keys(pattern_fields("transmit", &S::transmit))
      .keys(pattern_fields("receive", &S::receive))
      .keys(signal_fields());
  for (const SensorSection* kind : kinds) kind->add_keys(section);
  section.check(check_sensor);
  return section;
}

}  // namespace tubefoot
