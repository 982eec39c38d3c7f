// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <array>

#include "scene/file/scene_file_ranges.hpp"
#include "scene/file/scene_file_sections.hpp"

// Defines the section [water] of a scene file: isovelocity or stratified water. The checks test which keys
// a profile permits and requires, and whether the formula for sound speed is valid.
namespace tubefoot {
namespace {

/// A key that only some profiles read, and the profiles that require it.
struct ProfileKey {
  const char* name;
  std::vector<const char*> profiles, needed_by{};
};

const std::vector<ProfileKey>& profile_keys() {
  static const std::vector<ProfileKey> keys = {
      {"profile_file", {"table", "cast"}, {"table", "cast"}},
      {"surface_height_m", {"table", "cast", "gradient", "munk", "n2-linear"}},
      {"refraction_gap_m", {"table", "cast", "gradient", "munk", "n2-linear"}},
      {"refraction_tolerance_db", {"table", "cast", "gradient", "munk", "n2-linear"}},
      {"refraction_turns", {"table", "cast", "gradient", "munk", "n2-linear"}},
      {"profile_bottom_m", {"gradient", "munk", "n2-linear"}, {"gradient", "munk", "n2-linear"}},
      {"gradient_per_s", {"gradient", "n2-linear"}, {"gradient", "n2-linear"}},
      {"munk_axis_m", {"munk"}},
      {"munk_scale_m", {"munk"}},
      {"munk_epsilon", {"munk"}},
      {"profile_error_m_s", {"munk", "n2-linear"}},
      {"profile_step_m", {"munk", "n2-linear"}},
  };
  return keys;
}

/// Checks the keys of volume scattering.
void check_scattering(const WaterDescription& water, const TomlTable& table) {
  if (water.volume_scattering_db && water.volume_scattering_file)
    throw InputError(
        place_of_pair(table, "volume_scattering_db", "volume_scattering_file"),
        "the water scatters uniformly, or in the layers of 'volume_scattering_file': give only one "
        "of the two keys");
}

void check_profile(const WaterDescription& water, const TomlTable& table) {
  const auto among = [&water](const std::vector<const char*>& profiles) {
    return std::ranges::find(profiles, water.profile) != profiles.end();
  };
  for (const ProfileKey& key : profile_keys()) {
    const bool scatters = water.volume_scattering_db || water.volume_scattering_file;
    if (scatters && key.name == std::string_view("surface_height_m")) continue;
    if (table.has(key.name) && !among(key.profiles)) {
      throw InputError(
          table.place_of(key.name),
          fmt::format("'{}' belongs to profile = \"{}\", but the profile is \"{}\": remove one of "
                      "the two",
                      key.name, fmt::join(key.profiles, "\" or \""), water.profile));
    }
    if (!table.has(key.name) && among(key.needed_by)) {
      throw InputError(table.place_of("profile"),
                       fmt::format("profile = \"{}\" needs '{}': add it", water.profile, key.name));
    }
  }
  if (water.profile_error_m_s && water.profile_step_m) {
    throw InputError(
        place_of_pair(table, "profile_error_m_s", "profile_step_m"),
        "a profile is sampled to 'profile_error_m_s' or every 'profile_step_m': give only one of "
        "the two");
  }
  if (water.sound_speed_m_s && among({"table", "cast"})) {
    throw InputError(table.place_of("sound_speed_m_s"),
                     fmt::format("profile = \"{}\" has its sound speeds in 'profile_file': remove "
                                 "'sound_speed_m_s'",
                                 water.profile));
  }
  if (!water.sound_speed_m_s && among({"gradient", "munk", "n2-linear"})) {
    throw InputError(table.place_of("profile"),
                     fmt::format("profile = \"{}\" needs 'sound_speed_m_s', the speed at {}: add it",
                                 water.profile, water.profile == "munk" ? "its axis" : "the surface"));
  }
  if (water.latitude_deg && water.sound_speed_formula != "leroy") {
    throw InputError(table.place_of("latitude_deg"),
                     "'latitude_deg' belongs to sound_speed_formula = \"leroy\": remove one of the two");
  }
}

/// Checks that the values are within the validity of the formula for sound speed, if one is used.
void check_formula(const WaterDescription& water, const TomlTable& table) {
  if (water.sound_speed_m_s || water.profile != "constant") return;
  const bool leroy = water.sound_speed_formula == "leroy";
  const double saltless = leroy ? 0 : 25, deepest = leroy ? 12000 : 8000;
  // The range of the temperature's key is narrow enough.
  if (water.salinity_psu < saltless) {
    throw InputError(table.place_of("salinity_psu"),
                     fmt::format("the formula for sound speed is valid for a 'salinity_psu' of 25 to 40, not "
                                 "{}: give 'sound_speed_m_s' for fresh or brackish water",
                                 water.salinity_psu));
  }
  if (water.depth_m > deepest) {
    throw InputError(table.place_of("depth_m"),
                     fmt::format("the formula for sound speed is valid for a 'depth_m' of 0 to {:g}, not {}: "
                                 "give 'sound_speed_m_s' for deeper water",
                                 deepest, water.depth_m));
  }
}

/// Returns the keys of the water. Without `all`, returns those that determine the sound speed.
std::vector<TomlField<WaterDescription>> water_fields(bool all) {
  using W = WaterDescription;
  std::vector<TomlField<W>> fields{
      field("sound_speed_m_s", &W::sound_speed_m_s,
            {.meaning = "Sound speed of isovelocity water. Default: computed with "
                        "`sound_speed_formula`. For a profile given by a formula: speed at the "
                        "surface, or on the channel axis for munk.",
             .ranges = {{.lo = 1300, .hi = 1700}}}),
      field("absorption_db_per_km", &W::absorption_db_per_km,
            {.meaning = "One-way absorption. Default: computed with `absorption_model` at the "
                        "frequency of each sensor.",
             .ranges = {{.lo = 0, .hi = 100000}}}),
      field("temperature_c", &W::temperature_c,
            {.meaning = "Temperature of the water.", .ranges = {{.lo = -2, .hi = 30}}}),
      field("salinity_psu", &W::salinity_psu,
            {.meaning = "Salinity of the water. The Mackenzie formula needs at least 25.",
             .ranges = {{.lo = 0, .hi = 40}}}),
      field("ph", &W::ph,
            {.meaning = "Acidity (pH) of the water, which affects only the absorption.",
             .ranges = {{.lo = 6, .hi = 9}}}),
      field("depth_m", &W::depth_m,
            {.meaning = "Depth below the sea surface at which the formulas apply in isovelocity "
                        "water. The Mackenzie formula holds down to 8000 m.",
             .ranges = {{.lo = 0, .hi = 10000}}}),
      field("sound_speed_formula", &W::sound_speed_formula,
            {.meaning = "mackenzie: Mackenzie 1981. leroy: Leroy, Robinson and Goldsmith 2008.",
             .choices = {"mackenzie", "leroy"}}),
      field("latitude_deg", &W::latitude_deg,
            {.meaning = "Latitude for the Leroy formula, which computes pressure from depth.",
             .ranges = {latitude},
             .default_value = "45"}),
      field("absorption_model", &W::absorption_model,
            {.meaning = "francois-garrison: Francois and Garrison 1982. ainslie-mccolm: Ainslie "
                        "and McColm 1998.",
             .choices = {"francois-garrison", "ainslie-mccolm"}}),
      field("profile", &W::profile,
            {.meaning = "Type of the sound-speed profile. Each type has its own keys.",
             .choices = {"constant", "table", "cast", "gradient", "munk", "n2-linear"}}),
      field("profile_file", &W::profile_file,
            {.meaning = "CSV file. table: columns `depth_m,sound_speed_m_s`. cast: columns "
                        "`depth_m,temperature_c,salinity_psu`, from which tubefoot computes sound "
                        "speed and absorption. Depths increase by at least 1 um per row."}),
      field("surface_height_m", &W::surface_height_m,
            {.meaning = "Height (z) of the sea surface, where the depth is 0.",
             .ranges = {{.lo = -12000, .hi = 12000}},
             .default_value = "0"}),
      field("profile_bottom_m", &W::profile_bottom_m,
            {.meaning = "Depth at which a profile given by a formula ends. The sound speed is "
                        "constant below this depth.",
             .ranges = {{.lo = 0, .hi = 12000, .lo_excluded = true}}}),
      field("gradient_per_s", &W::gradient_per_s,
            {.meaning = "gradient: change of sound speed with depth. n2-linear: parameter g of "
                        "the sound speed c0 / sqrt(1 + 2 g z / c0) at depth z.",
             .ranges = {{.lo = -10, .hi = 10}}}),
      field("munk_axis_m", &W::munk_axis_m,
            {.meaning = "munk: depth of the axis of the sound channel.",
             .ranges = {{.lo = 0, .hi = 12000}},
             .default_value = "1300"}),
      field("munk_scale_m", &W::munk_scale_m,
            {.meaning = "munk: depth scale of the sound channel.",
             .ranges = {{.lo = 1, .hi = 12000}},
             .default_value = "1300"}),
      field("munk_epsilon", &W::munk_epsilon,
            {.meaning = "munk: strength of the sound channel.",
             .ranges = {{.lo = 0, .hi = 0.1}},
             .default_value = "0.00737"}),
      field("profile_error_m_s", &W::profile_error_m_s,
            {.meaning = "munk, n2-linear: largest error of the linear interpolation between the "
                        "sampled points of the profile.",
             .ranges = {{.lo = 0.0001, .hi = 10}},
             .default_value = "0.01"}),
      field("profile_step_m", &W::profile_step_m,
            {.meaning = "munk, n2-linear: spacing of the sampled points of the profile, instead "
                        "of `profile_error_m_s`.",
             .ranges = {{.lo = 0.01, .hi = 1000}}}),
      field("refraction_gap_m", &W::travel_path_error_m,
            {.meaning = "Largest travel-path error: distance between refracted facets and their apparent "
                        "positions. Default: a quarter of a range bin, or less for a receiver pair.",
             .ranges = {{.lo = 0.00001, .hi = 1000}}}),
      field("refraction_tolerance_db", &W::refraction_tolerance_db,
            {.meaning = "Largest error in the energy density on a facet due to the approximation "
                        "of the apparent facet by a plane.",
             .ranges = {{.lo = 0.001, .hi = 10}},
             .default_value = "0.1"}),
      field("refraction_turns", &W::refraction_turns,
            {.meaning = "Largest number of turning points of a ray between the sonar and the "
                        "seabed. tubefoot omits rays with more turning points.",
             .ranges = {{.lo = 0, .hi = 16}}}),
      field("volume_scattering_db", &W::volume_scattering_db,
            {.meaning = "Volume scattering strength of the water, in dB re 1 m^-1. Without this key and "
                        "`volume_scattering_file`, the water does not scatter.",
             .ranges = {{.lo = -300, .hi = 0}}}),
      field("volume_scattering_file", &W::volume_scattering_file,
            {.meaning = "CSV file with the columns `depth_m,volume_scattering_db`, one row per layer. Each "
                        "layer extends from its depth to that of the next row. The file may be "
                        "`profile_file` with one more column."})};
  constexpr std::array<std::string_view, 8> others = {"absorption_db_per_km",    "ph",
                                                      "absorption_model",        "refraction_gap_m",
                                                      "refraction_tolerance_db", "refraction_turns",
                                                      "volume_scattering_db",    "volume_scattering_file"};
  if (!all)
    std::erase_if(
        fields, [&](const TomlField<W>& f) { return std::ranges::find(others, f.key.name) != others.end(); });
  return fields;
}

void check_water(const WaterDescription& water, const TomlTable& table) {
  check_scattering(water, table);
  check_profile(water, table);
  check_formula(water, table);
}

}  // namespace

const TomlSection<WaterDescription>& water_section() {
  static const auto section =
      TomlSection<WaterDescription>(
          "[water]",
          "Sound speed and absorption of the water, which is isovelocity or stratified. Depths "
          "increase downwards from the sea surface.")
          .keys(water_fields(true))
          .check(check_water);
  return section;
}

const TomlSection<WaterDescription>& assumed_water_section() {
  static const auto section =
      TomlSection<WaterDescription>(
          "[processing.water]",
          "Sound speed of the assumed water, with which the software of a sonar converts travel times to "
          "ranges and positions. The keys are those of `[water]`, with the same defaults.")
          .keys(water_fields(false))
          .check(check_water);
  return section;
}

}  // namespace tubefoot
