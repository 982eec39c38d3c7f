// SPDX-License-Identifier: GPL-3.0-or-later
// Defines the section [[sensors]] of a scene file: keys of all sensors, of their patterns and of their
// receivers. Each kind of sensor adds its own keys (docs/scene-keys.md).
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
      {"_shading", table.has(side + "_shading"), {"line"}},
  };
  for (const auto& [measure, given, patterns] : rules) {
    const bool takes = std::ranges::find(patterns, pattern.pattern) != patterns.end();
    const std::string key = side + measure,
                      choice = fmt::format("{}_pattern = \"{}\"", side, pattern.pattern);
    if (given && !takes) {
      throw InputError(
          table.place_of(key),
          fmt::format("'{}' applies to {}_pattern = {}, not to {}: remove the key, or change the pattern",
                      key, side, one_of(patterns, '"'), choice));
    }
    if (takes && !given && key != side + "_pattern_angle" && key != side + "_shading")
      throw InputError(table.place_of(side + "_pattern"), fmt::format("{} needs the key '{}'", choice, key));
  }
  if (pattern.pattern == "line" && pattern.angle == "off_axis") {
    throw InputError(table.place_of(side + "_pattern_angle"),
                     fmt::format("a line array's pattern depends on \"azimuth\" or \"elevation\", not on "
                                 "\"off_axis\": set {}_pattern = \"piston\" for a round aperture",
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
      {"quantisation_bottom_db", signal.quantisation_bits.has_value(), "'quantisation_bits'"},
      {"quantisation_top_db", signal.quantisation_bits.has_value(), "'quantisation_bits'"},
  };
  for (const auto& [key, takes, wanted] : rules)
    if (table.has(key) && !takes)
      throw InputError(table.place_of(key),
                       fmt::format("'{}' needs {}: add it, or remove the key", key, wanted));
  if (signal.quantisation_bits && !(signal.quantisation_bottom_db < signal.quantisation_top_db))
    throw InputError(
        place_of_pair(table, "quantisation_bits", "quantisation_top_db"),
        fmt::format("'quantisation_bottom_db' ({:g}) must be less than 'quantisation_top_db' ({:g}), the "
                    "levels of code 0 and of the largest code: set both",
                    signal.quantisation_bottom_db, signal.quantisation_top_db));
}

/// Limits the energies of a ping and the poses of a sensor, because memory holds all of them.
void check_amounts(const SensorDescription& sensor, const TomlTable& table) {
  const SensorFigures figures = figures_of(sensor);
  const std::int64_t cells = figures.beams * figures.samples;
  if (cells > limits::ping_cells)
    throw InputError(
        place_of_pair(table, "beams", "samples"),
        fmt::format("'beams' and 'samples' give {} range bins per ping, but at most {} are allowed: reduce "
                    "one of the two, or distribute the beams over several sensors",
                    cells, limits::ping_cells));
  const std::int64_t pings =
      sensor.ping_times_s.empty() ? sensor.pings.value_or(1) : std::ssize(sensor.ping_times_s);
  const std::int64_t transmissions = pings * figures.transmissions;
  if (transmissions > limits::sensor_transmissions)
    throw InputError(table.place_of(sensor.ping_times_s.empty() ? "pings" : "ping_times_s"),
                     fmt::format("'pings' with {} transmissions each give {} transmissions, but at most {} "
                                 "are allowed: distribute the pings over several scenes",
                                 figures.transmissions, transmissions, limits::sensor_transmissions));
}

/// Checks listed times of pings. Files of instruments contain times since 1970 as doubles, with a resolution
/// of a quarter of a microsecond.
void check_ping_times(const SensorDescription& sensor, const TomlTable& table) {
  if (sensor.ping_times_s.empty()) return;
  constexpr double least_interval_s = 1e-6;
  for (const char* key : {"first_ping_s", "pings", "ping_interval_s"})
    if (table.has(key))
      throw InputError(
          table.place_of(key),
          fmt::format("'ping_times_s' already sets the times of the pings: remove '{}' or the list", key));
  for (std::size_t k = 1; k < sensor.ping_times_s.size(); ++k)
    if (!(sensor.ping_times_s[k] - sensor.ping_times_s[k - 1] >= least_interval_s))
      throw InputError(table.place_of("ping_times_s"),
                       fmt::format("'ping_times_s' must increase by at least {} s: {} follows {}",
                                   least_interval_s, sensor.ping_times_s[k], sensor.ping_times_s[k - 1]));
}

void check_sensor(const SensorDescription& sensor, const TomlTable& table) {
  check_pattern(sensor.transmit, "transmit", table);
  check_pattern(sensor.receive, "receive", table);
  check_signal(sensor.signal, table);
  constexpr std::size_t longest_name = 64;
  constexpr std::string_view allowed = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-";
  if (sensor.name.size() > longest_name || sensor.name.find_first_not_of(allowed) != std::string::npos) {
    throw InputError(table.place_of("name"),
                     fmt::format("a sensor's 'name' becomes part of file names: expected at most {} of the "
                                 "characters A-Z a-z 0-9 _ -, not \"{}\"",
                                 longest_name, sensor.name));
  }
  if (sensor.look_at_m) {
    if (!sensor.kind.section().looks_ahead())
      throw InputError(table.place_of("look_at_m"),
                       fmt::format("'look_at_m' applies only to forward-looking sonars, not to kind = "
                                   "\"{}\": give 'yaw_deg', 'tilt_deg' and 'roll_deg'",
                                   sensor.kind.section().name()));
    for (const char* key : {"yaw_deg", "tilt_deg"})
      if (table.has(key))
        throw InputError(
            table.place_of(key),
            fmt::format("'look_at_m' already sets the direction of the sensor: remove '{}' or 'look_at_m'",
                        key));
    if (sensor.assumed.yaw_deg || sensor.assumed.tilt_deg || sensor.assumed.roll_deg)
      throw InputError(sensor.assumed.place,
                       "'look_at_m' already sets the direction of the sensor: remove the assumed angles from "
                       "[sensors.processing] or 'look_at_m'");
  }
  check_ping_times(sensor, table);
  if (table.has("motion_step_beams") && sensor.stop_and_hop)
    throw InputError(table.place_of("motion_step_beams"),
                     "'motion_step_beams' needs stop_and_hop = false: add it, or remove the key");
  sensor.kind.section().check(sensor, table);
  check_amounts(sensor, table);
}

/// Returns the keys of a transmit or receive pattern as keys of the sensor. `meaning` is that of the pattern.
std::vector<TomlField<SensorDescription>> pattern_fields(const std::string& side, std::string meaning,
                                                         PatternDescription SensorDescription::*pattern) {
  using P = PatternDescription;
  constexpr ValueRange aperture{.lo = 0, .hi = 1000, .lo_excluded = true};
  constexpr ValueRange width{.lo = 0, .hi = 180, .lo_excluded = true};
  const std::vector<TomlField<P>> own{
      field(side + "_pattern", &P::pattern,
            {.meaning = std::move(meaning), .choices = {"none", "line", "piston", "gaussian", "table"}}),
      field(side + "_pattern_angle", &P::angle,
            {.meaning =
                 "Angle that is the argument of the pattern: across the beam (azimuth), above the beam "
                 "(elevation), or from the beam axis (off_axis). For a sidescan, azimuth is along the track.",
             .choices = {"azimuth", "elevation", "off_axis"}}),
      field(side + "_aperture_m", &P::aperture_m,
            {.meaning = "Length of a line array, or diameter of a piston.", .ranges = {aperture}}),
      field(side + "_shading", &P::shading,
            {.meaning =
                 "Shading s of a line array of length L. Elements at the distance x from the centre have the "
                 "weight 1 + s cos(2 pi x / L). 0: uniform. 0.852: Hamming. 1: Hann.",
             .ranges = {{.lo = 0, .hi = 1}}}),
      field(side + "_beam_width_deg", &P::width_deg,
            {.meaning = "Full one-way width of a Gaussian pattern at -3 dB.", .ranges = {width}}),
      field(side + "_pattern_file", &P::file,
            {.meaning = "CSV file of a table pattern with the header line `angle_deg,level_db`. The angles "
                        "increase from row to row."})};
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
      field("source_level_db", &G::source_level_db,
            {.meaning = "Source level re 1 uPa at 1 m, for files that contain levels. The energy densities "
                        "in echoes.nc are for a source of 1 J/sr instead.",
             .ranges = {level}}),
      field(
          "noise_level_db", &G::noise_level_db,
          {.meaning = "Mean noise level in the receiver band, re 1 uPa. Without this key, there is no noise.",
           .ranges = {level}}),
      field("speckle", &G::speckle,
            {.meaning = "Amplitude distribution of the speckle from many scatterers. tubefoot draws one "
                        "random value per ping, beam and range bin.",
             .choices = {"none", "rayleigh", "k"}}),
      field("speckle_looks", &G::speckle_looks,
            {.meaning = "Number of independent looks whose energies are averaged.",
             .ranges = {{.lo = 1, .hi = 1024}}}),
      field("speckle_shape", &G::speckle_shape,
            {.meaning = "Shape parameter nu of the K distribution. Smaller values give spikier speckle.",
             .ranges = {{.lo = 0.01, .hi = 1e6}}}),
      field("tvg_spreading", &G::tvg_spreading,
            {.meaning = "Coefficient Sp of the time-varied gain Sp log10 R + 2 alpha R + G in dB. Without "
                        "this key, there is no gain.",
             .ranges = {{.lo = 0, .hi = 60}}}),
      field("tvg_absorption_db_per_km", &G::tvg_absorption_db_per_km,
            {.meaning = "One-way absorption alpha in the time-varied gain.",
             .ranges = {{.lo = 0, .hi = 100000}},
             .default_value = "absorption of the water"}),
      field("tvg_gain_db", &G::tvg_gain_db,
            {.meaning = "Constant G of the time-varied gain.", .ranges = {level}}),
      field("tvg_fixed_below_m", &G::tvg_fixed_below_m,
            {.meaning = "Range below which the gain is constant.", .ranges = {sonar_range}}),
      field("display_gain_db", &G::display_gain_db,
            {.meaning = "Additional brightness of pictures. Other files do not change.",
             .ranges = {{.lo = -100, .hi = 100}}}),
      field("pulse_length_us", &G::pulse_length_us,
            {.meaning = "Length tau of the pulse. Files in sonar formats spread each echo over c tau / 2 in "
                        "range, and levels apply to this pulse. Without this key, echoes are not spread.",
             .ranges = {{.lo = 0, .hi = 100000, .lo_excluded = true}}}),
      field("quantisation_bits", &G::quantisation_bits,
            {.meaning = "Bits of the codes to which the receiver quantises levels, after the gain. Without "
                        "this key, levels are not quantised.",
             .ranges = {{.lo = 1, .hi = 16}}}),
      field("quantisation_bottom_db", &G::quantisation_bottom_db,
            {.meaning = "Level re 1 uPa of code 0, which also stands for lower levels and no echo.",
             .ranges = {level}}),
      field("quantisation_top_db", &G::quantisation_top_db,
            {.meaning = "Level re 1 uPa of the largest code, which also stands for higher levels.",
             .ranges = {level}})};
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
  TomlSection<S> section("[[sensors]]", "Sonar that moves along a trajectory. A scene needs at least one.");
  section
      .keys(
          {field("name", &S::name,
                 {.meaning = "Name of the sensor and part of file names. Up to 64 letters without accents, "
                             "digits, underscores and hyphens.",
                  .required = true,
                  .longest = limits::name_bytes}),
           field("preset", &S::preset,
                 {.meaning = "Name of a real sonar; `tubefoot presets` lists the names. Keys of the entry "
                             "override the preset, and `kind` becomes optional.",
                  .longest = limits::name_bytes}),
           field(
               "trajectory", &S::trajectory,
               {.meaning =
                    "Name of an entry of `[[trajectories]]`. Optional if the scene has only one trajectory.",
                .default_value = "the only trajectory"}),
           field("lever_arm_m", &S::lever_arm_m,
                 {.meaning = "Position of the sensor on the carrier, relative to the reference point: "
                             "starboard, forward, up.",
                  .ranges = {lever_arm}}),
           field("receiver_arm_m", &S::receiver_arm_m,
                 {.meaning = "Position of a separate receiver with the same mounting angles. The transmitter "
                             "is then at `lever_arm_m`. Slant ranges are half of the two-way path length.",
                  .ranges = {lever_arm},
                  .default_value = "value of lever_arm_m"}),
           field("yaw_deg", &S::yaw_deg,
                 {.meaning = "Mounting angle: rotation to starboard.", .ranges = {heading}}),
           field("tilt_deg", &S::tilt_deg,
                 {.meaning = "Mounting angle: rotation downwards.", .ranges = {pitch}}),
           field("roll_deg", &S::roll_deg,
                 {.meaning = "Mounting angle: rotation that lowers the starboard side.", .ranges = {roll}}),
           field(
               "look_at_m", &S::look_at_m,
               {.meaning = "Point that the sensor faces at every ping, instead of `yaw_deg` and `tilt_deg`: "
                           "east, north, up. For the kinds array, didson, imaging and scanning.",
                .ranges = {coordinate}}),
           assumed_mounting_field(),
           field("first_ping_s", &S::first_ping_s,
                 {.meaning = "Time of the first ping on the trajectory. On a survey, the time is relative to "
                             "the start of each line.",
                  .ranges = {{.lo = -1e10, .hi = 1e10}}}),
           field("pings", &S::pings,
                 {.meaning =
                      "Number of pings. On a survey, tubefoot counts from the first ping of the first line.",
                  .ranges = {{.lo = 1, .hi = 1e7}},
                  .default_value = "1, or all pings of a survey"}),
           field("ping_interval_s", &S::ping_interval_s,
                 {.meaning = "Time between pings.", .ranges = {ping_interval}}),
           field("ping_times_s", &S::ping_times_s,
                 {.meaning = "Times of the pings on the trajectory, in increasing order. Replaces "
                             "`first_ping_s`, `pings` and `ping_interval_s`. Not for a survey.",
                  .ranges = {{.lo = -1e10, .hi = 1e10}}}),
           field("stop_and_hop", &S::stop_and_hop,
                 {.meaning = "true: the carrier stands still during a ping. false: the carrier moves while "
                             "the sound travels."}),
           field("motion_step_beams", &S::motion_step_beams,
                 {.meaning = "With stop_and_hop = false, energies are computed for intervals of the range. "
                             "Within an interval, the direction of the receiver changes by at most this part "
                             "of the width of the narrowest beam.",
                  .ranges = {{.lo = 1e-4, .hi = 10}}}),
           field("shadow", &S::shadow,
                 {.meaning =
                      "Borders of shadows: \"sharp\" for geometric shadows, \"fresnel\" for energies that "
                      "diffraction at silhouette edges weights on both sides of the border.",
                  .choices = {"sharp", "fresnel"}}),
           field("cone_tolerance", &S::cone_tolerance,
                 {.meaning = "Largest relative error in the height of an ideal beam, whose cones are "
                             "approximated by planes. Determines the number of tubes per beam.",
                  .ranges = {{.lo = 1e-9, .hi = 0.01}}})})
      .keys(pattern_fields("transmit",
                           "Transmitted power as a function of direction, relative to the centre of the fan.",
                           &S::transmit))
      .keys(pattern_fields("receive",
                           "Received power as a function of direction, relative to the axis of each beam.",
                           &S::receive))
      .keys(signal_fields());
  for (const SensorSection* kind : kinds) kind->add_keys(section);
  section.check(check_sensor);
  return section;
}

}  // namespace tubefoot
