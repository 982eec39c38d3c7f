// SPDX-License-Identifier: GPL-3.0-or-later
// The [[sensors]] section of a scene file.
#include <algorithm>

#include "files/limits.hpp"
#include "scene/file/scene_file_ranges.hpp"
#include "scene/file/scene_file_sections.hpp"
#include "scene/file/scene_file_words.hpp"
#include "scene/file/sensor_presets.hpp"

namespace tubefoot {
namespace {

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

/// Of an acoustic camera's beams and cycles.
void check_camera(const SensorDescription& sensor, const DidsonDescription& camera, const TomlTable& table) {
  const auto fail = [&](const char* key, const std::string& what) {
    throw InputError(table.place_of(key), what);
  };
  if (camera.beam_centres == "lens") {
    if (camera.beams != 48 && camera.beams != 96)
      fail("beams",
           fmt::format("beam_centres = \"lens\" is known for 48 or 96 beams, not for {}: take those, "
                       "or \"even\"",
                       camera.beams));
    if (table.has("horizontal_deg"))
      fail("horizontal_deg",
           "beam_centres = \"lens\" says how wide the fan is: remove 'horizontal_deg', or take \"even\"");
  }
  if (camera.beams % camera.cycles != 0)
    fail("cycles",
         fmt::format("'cycles' must share out the {} beams evenly, {} do not", camera.beams, camera.cycles));
  for (const char* key : {"cycle_interval_s", "firing_order"})
    if (table.has(key) && camera.cycles == 1)
      fail(key, fmt::format("'{}' needs 'cycles' of 2 or more: with one, all beams are fired at once", key));
  std::vector<int> order = camera.firing_order;
  std::ranges::sort(order);
  for (std::size_t k = 0; k < order.size(); ++k)
    if (order.size() != static_cast<std::size_t>(camera.cycles) || order[k] != static_cast<int>(k))
      fail("firing_order",
           fmt::format("'firing_order' must have each cycle from 0 to {} once", camera.cycles - 1));
  if (table.has("receive_margin_deg") && sensor.receive.pattern == "none")
    fail("receive_margin_deg",
         "'receive_margin_deg' needs a 'receive_pattern': without one, beams end at their borders");
  if (!table.has("transmit_steering")) return;
  if (sensor.transmit.pattern == "none")
    fail("transmit_steering", "'transmit_steering' needs a 'transmit_pattern': add it, or remove the key");
  if (camera.transmit_steering == "beams" && sensor.transmit.angle == "elevation")
    fail("transmit_steering",
         "a pattern over \"elevation\" is the same for all beams of the fan: take transmit_steering = "
         "\"fan\"");
}

void check_staff(const InterferometricDescription& sensor, const TomlTable& table) {
  if (sensor.baseline_m > sensor.range_min_m)
    throw InputError(place_of_pair(table, "baseline_m", "range_min_m"),
                     fmt::format("'baseline_m' ({}) must not be more than 'range_min_m' ({})",
                                 sensor.baseline_m, sensor.range_min_m));
}

/// A ping's energies are held whole, and all poses of a sensor.
void check_amounts(const SensorDescription& sensor, const TomlTable& table) {
  const std::int64_t cells = std::visit(
      [](const auto& kind) {
        std::int64_t beams = 2;
        if constexpr (requires { kind.beams; }) beams = kind.beams;
        return beams * kind.samples;
      },
      sensor.kind);
  if (cells > limits::ping_cells)
    throw InputError(
        place_of_pair(table, "beams", "samples"),
        fmt::format("'beams' and 'samples' make {} range samples a ping, at most {} are taken: lower "
                    "one of the two, or share the beams among several sensors",
                    cells, limits::ping_cells));
  const auto* camera = std::get_if<DidsonDescription>(&sensor.kind);
  const std::int64_t shots = std::int64_t{sensor.pings} * (camera != nullptr ? camera->cycles : 1);
  if (shots > limits::sensor_shots)
    throw InputError(table.place_of("pings"),
                     fmt::format("'pings' and 'cycles' make {} shots, at most {} are taken: ask for fewer "
                                 "pings, in several scenes",
                                 shots, limits::sensor_shots));
}

void check_sensor(const SensorDescription& sensor, const TomlTable& table) {
  check_amounts(sensor, table);
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
  if (const auto* camera = std::get_if<DidsonDescription>(&sensor.kind)) check_camera(sensor, *camera, table);
  const SidescanDescription* sidescan = std::get_if<SidescanDescription>(&sensor.kind);
  if (const auto* interferometric = std::get_if<InterferometricDescription>(&sensor.kind)) {
    sidescan = interferometric;
    check_staff(*interferometric, table);
  }
  if (sidescan != nullptr) {
    if (sidescan->depression_min_deg >= sidescan->depression_max_deg) {
      throw InputError(
          place_of_pair(table, "depression_min_deg", "depression_max_deg"),
          fmt::format("'depression_min_deg' ({}) must be less than 'depression_max_deg' ({}): {}",
                      sidescan->depression_min_deg, sidescan->depression_max_deg, no_width));
    }
    if (table.has("samples") && table.has("sampling_frequency_khz")) {
      throw InputError(table.place_of("sampling_frequency_khz"),
                       "'samples' and 'sampling_frequency_khz' both say how long a sample is: remove one of "
                       "the two");
    }
    if (sidescan->axis_depression_deg && sensor.transmit.pattern == "none" &&
        sensor.receive.pattern == "none")
      throw InputError(table.place_of("axis_depression_deg"),
                       "'axis_depression_deg' is the axis of patterns: add transmit_pattern or "
                       "receive_pattern, or remove the key");
  }
  if (const auto* fan = std::get_if<MultibeamDescription>(&sensor.kind)) {
    if (fan->beams > 1 && fan->swath_deg + fan->beam_across_deg > 180) {
      throw InputError(
          place_of_pair(table, "swath_deg", "beam_across_deg"),
          fmt::format("'swath_deg' ({}) and 'beam_across_deg' ({}) together must be at most 180: "
                      "the outermost beams reach above the horizontal",
                      fan->swath_deg, fan->beam_across_deg));
    }
  }
  std::visit(
      [&](const auto& kind) {
        if constexpr (requires { kind.range_min_m; })
          if (kind.range_min_m >= kind.range_max_m)
            throw InputError(place_of_pair(table, "range_min_m", "range_max_m"),
                             fmt::format("'range_min_m' ({}) must be less than 'range_max_m' ({})",
                                         kind.range_min_m, kind.range_max_m));
      },
      sensor.kind);
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

/// The keys of the receiver, as keys of the sensor.
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
      field("pulse_length_us", &G::pulse_length_us,
            {.ranges = {{.lo = 0, .hi = 100000, .lo_excluded = true}}})};
  std::vector<TomlField<SensorDescription>> fields;
  for (const TomlField<G>& f : own)
    fields.push_back({f.key, [read = f.read](const toml::node& node, TomlSource& source,
                                             SensorDescription& s) { read(node, source, s.signal); }});
  return fields;
}

/// Of the two limits of a sidescan's fan: together they keep it narrower than 170 degrees.
constexpr ValueRange depression{.lo = -80, .hi = 90, .if_below = too_wide, .if_above = "90 is straight down"};

/// The keys of a sidescan, as keys of it or of a kind that is one.
template <typename Kind>
std::vector<TomlField<Kind>> sidescan_fields() {
  const auto own = []<typename Value>(Value SidescanDescription::*member) {
    return static_cast<Value Kind::*>(member);
  };
  using S = SidescanDescription;
  return {field("frequency_khz", own(&S::frequency_khz), {.ranges = {frequency}}),
          field("along_track_deg", own(&S::along_track_deg), {.ranges = {sector(90, false)}}),
          field("depression_min_deg", own(&S::depression_min_deg), {.ranges = {depression}}),
          field("depression_max_deg", own(&S::depression_max_deg), {.ranges = {depression}}),
          field("samples", own(&S::samples), {.ranges = {range_samples}}),
          field("range_min_m", own(&S::range_min_m), {.ranges = {sonar_range}}),
          field("range_max_m", own(&S::range_max_m), {.ranges = {sonar_range}})};
}

std::vector<TomlField<SidescanDescription>> own_sidescan_fields() {
  using S = SidescanDescription;
  std::vector<TomlField<S>> fields = sidescan_fields<S>();
  fields.push_back(field("axis_depression_deg", &S::axis_depression_deg,
                         {.ranges = {depression}, .default_value = "the fan's middle"}));
  fields.push_back(field("sampling_frequency_khz", &S::sampling_frequency_khz,
                         {.ranges = {{.lo = 0, .hi = 100000, .lo_excluded = true}}}));
  return fields;
}

std::vector<TomlField<ImagingDescription>> imaging_fields() {
  using I = ImagingDescription;
  return {field("frequency_khz", &I::frequency_khz, {.ranges = {frequency}}),
          field("beams", &I::beams, {.ranges = {{.lo = 1, .hi = 4096}}}),
          field("horizontal_deg", &I::horizontal_deg, {.ranges = {sector(180, true)}}),
          field("vertical_deg", &I::vertical_deg, {.ranges = {sector(170, false)}}),
          field("samples", &I::samples, {.ranges = {range_samples}}),
          field("range_min_m", &I::range_min_m, {.ranges = {sonar_range}}),
          field("range_max_m", &I::range_max_m, {.ranges = {sonar_range}})};
}

std::vector<TomlField<EchosounderDescription>> echosounder_fields() {
  using E = EchosounderDescription;
  return {field("frequency_khz", &E::frequency_khz, {.ranges = {frequency}}),
          field("beam_deg", &E::beam_deg, {.ranges = {sector(90, false)}}),
          field("sector_deg", &E::sector_deg,
                {.ranges = {sector(170, false)}, .default_value = "3 beam_deg, at most 170"}),
          field("samples", &E::samples, {.ranges = {range_samples}}),
          field("range_min_m", &E::range_min_m, {.ranges = {sonar_range}}),
          field("range_max_m", &E::range_max_m, {.ranges = {sonar_range}}),
          field("detection", &E::detection, {.choices = {"first_return", "energy_centroid", "maximum"}}),
          field("detection_threshold_db", &E::detection_threshold_db, {.ranges = {{.lo = -300, .hi = 0}}})};
}

std::vector<TomlField<InterferometricDescription>> interferometric_fields() {
  using I = InterferometricDescription;
  std::vector<TomlField<I>> fields = sidescan_fields<I>();
  fields.push_back(
      field("baseline_m", &I::baseline_m, {.ranges = {{.lo = 0, .hi = 10, .lo_excluded = true}}}));
  fields.push_back(field("staff_tilt_deg", &I::staff_tilt_deg, {.ranges = {pitch}}));
  fields.push_back(field("phase_noise", &I::phase_noise));
  return fields;
}

}  // namespace

const TomlSection<SensorDescription>& sensor_section() {
  using S = SensorDescription;
  using Didson = DidsonDescription;
  using Multibeam = MultibeamDescription;
  constexpr ValueRange lever_arm{.lo = -1000, .hi = 1000};
  std::vector<std::string> presets = sensor_preset_names();
  presets.insert(presets.begin(), "none");
  static const auto section =
      TomlSection<S>("[[sensors]]")
          .keys({field("name", &S::name, {.required = true, .longest = limits::name_bytes}),
                 field("preset", &S::preset, {.choices = presets}),
                 field("trajectory", &S::trajectory, {.default_value = "the only trajectory"}),
                 field("lever_arm_m", &S::lever_arm_m, {.ranges = {lever_arm}}),
                 field("receiver_arm_m", &S::receiver_arm_m,
                       {.ranges = {lever_arm}, .default_value = "as lever_arm_m"}),
                 field("yaw_deg", &S::yaw_deg, {.ranges = {heading}}),
                 field("tilt_deg", &S::tilt_deg, {.ranges = {pitch}}),
                 field("roll_deg", &S::roll_deg, {.ranges = {roll}}),
                 field("first_ping_s", &S::first_ping_s, {.ranges = {{.lo = -1e10, .hi = 1e10}}}),
                 field("pings", &S::pings, {.ranges = {{.lo = 1, .hi = 1e7}}}),
                 field("ping_interval_s", &S::ping_interval_s,
                       {.ranges = {{.lo = 0, .hi = 1e6, .lo_excluded = true}}}),
                 field("cone_tolerance", &S::cone_tolerance, {.ranges = {{.lo = 1e-9, .hi = 0.01}}})})
          .keys(pattern_fields("transmit", &S::transmit))
          .keys(pattern_fields("receive", &S::receive))
          .keys(signal_fields())
          .kind<Didson>(
              "kind", "didson",
              {field("frequency_khz", &Didson::frequency_khz, {.ranges = {frequency}}),
               field("beams", &Didson::beams, {.ranges = {{.lo = 1, .hi = 4096}}}),
               field("beam_centres", &Didson::beam_centres, {.choices = {"even", "lens"}}),
               field("horizontal_deg", &Didson::horizontal_deg, {.ranges = {sector(180, true)}}),
               field("vertical_deg", &Didson::vertical_deg, {.ranges = {sector(170, false)}}),
               field("transmit_horizontal_deg", &Didson::transmit_horizontal_deg,
                     {.ranges = {sector(180, true)}, .default_value = "as horizontal_deg"}),
               field("transmit_vertical_deg", &Didson::transmit_vertical_deg,
                     {.ranges = {sector(170, false)}, .default_value = "as vertical_deg"}),
               field("receive_margin_deg", &Didson::receive_margin_deg, {.ranges = {{.lo = 0, .hi = 10}}}),
               field("cycles", &Didson::cycles, {.ranges = {{.lo = 1, .hi = 4096}}}),
               field("cycle_interval_s", &Didson::cycle_interval_s,
                     {.ranges = {{.lo = 0, .hi = 1000}}, .default_value = "echo of the window's end"}),
               field("firing_order", &Didson::firing_order,
                     {.ranges = {{.lo = 0, .hi = 4095}}, .default_value = "as numbered"}),
               field("transmit_steering", &Didson::transmit_steering,
                     {.choices = {"fan", "beams"}, .default_value = "beams, if there are cycles"}),
               field("samples", &Didson::samples, {.ranges = {range_samples}}),
               field("window_start_m", &Didson::window_start_m, {.ranges = {sonar_range}}),
               field("window_length_m", &Didson::window_length_m, {.ranges = {sonar_range}}),
               field("pictures", &Didson::pictures, {.choices = {"all", "sequence"}})})
          .kind<SidescanDescription>("kind", "sidescan", own_sidescan_fields())
          .kind<Multibeam>(
              "kind", "multibeam",
              {field("frequency_khz", &Multibeam::frequency_khz, {.ranges = {frequency}}),
               field("beams", &Multibeam::beams, {.ranges = {{.lo = 1, .hi = 4096}}}),
               field("swath_deg", &Multibeam::swath_deg, {.ranges = {sector(180, true)}}),
               field("spacing", &Multibeam::spacing, {.choices = {"angle", "distance"}}),
               field("beam_across_deg", &Multibeam::beam_across_deg, {.ranges = {sector(90, false)}}),
               field("along_track_deg", &Multibeam::along_track_deg, {.ranges = {sector(90, false)}}),
               field("samples", &Multibeam::samples, {.ranges = {range_samples}}),
               field("range_min_m", &Multibeam::range_min_m, {.ranges = {sonar_range}}),
               field("range_max_m", &Multibeam::range_max_m, {.ranges = {sonar_range}}),
               field("detection", &Multibeam::detection,
                     {.choices = {"first_return", "energy_centroid", "maximum"}}),
               field("detection_threshold_db", &Multibeam::detection_threshold_db,
                     {.ranges = {{.lo = -300, .hi = 0}}}),
               field("grid_cell_m", &Multibeam::grid_cell_m, {.ranges = {{.lo = 0, .hi = 100000}}})})
          .kind<ImagingDescription>("kind", "imaging", imaging_fields())
          .kind<EchosounderDescription>("kind", "echosounder", echosounder_fields())
          .kind<InterferometricDescription>("kind", "interferometric", interferometric_fields())
          .check(check_sensor);
  return section;
}

}  // namespace tubefoot
