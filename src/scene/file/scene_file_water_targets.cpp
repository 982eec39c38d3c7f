// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/file/scene_file_ranges.hpp"
#include "scene/file/scene_file_sections.hpp"

// The sections [[targets]] and [[target_populations]] of a scene file.
namespace tubefoot {
namespace {

constexpr ValueRange target_strength{.lo = -200, .hi = 100};

TomlField<WaterTargetDescription> strength_field() {
  using T = WaterTargetDescription;
  const TomlKey key =
      make_key("target_strength_db", "number", "none",
               {.meaning = "Target strength in all directions, re 1 m^2. Give either this key "
                           "or `file`.",
                .ranges = {target_strength}});
  return {key, [key](const toml::node& node, TomlSource& source, T& target) {
            read_value(node, key, source, target.strength.target_strength_db);
          }};
}

TomlField<WaterTargetDescription> strength_file_field() {
  using T = WaterTargetDescription;
  const TomlKey key =
      make_key("file", "file", "none",
               {.meaning = "CSV file of `tubefoot strength`: target strength by direction and frequency."});
  return {key, [key](const toml::node& node, TomlSource& source, T& target) {
            target.strength.file_place = source.place(node);
            read_value(node, key, source, target.strength.file);
          }};
}

TomlField<TargetPopulationDescription> mean_strength_field() {
  using P = TargetPopulationDescription;
  const TomlKey key =
      make_key("target_strength_db", "number", "none",
               {.meaning = "Mean target strength, re 1 m^2.", .ranges = {target_strength}, .required = true});
  return {key, [key](const toml::node& node, TomlSource& source, P& population) {
            read_value(node, key, source, population.strength.target_strength_db);
          }};
}

void check_target(const WaterTargetDescription& target, const TomlTable& table) {
  if (target.strength.target_strength_db && target.strength.file)
    throw InputError(
        place_of_pair(table, "target_strength_db", "file"),
        "'target_strength_db' and 'file' both set the target strength: give only one of the two");
  if (!target.strength.target_strength_db && !target.strength.file)
    throw InputError(
        table.place,
        fmt::format("target '{}' has no target strength: add 'target_strength_db' or 'file'", target.name));
  for (const char* key : {"heading_deg", "pitch_deg", "roll_deg"})
    if (!target.strength.file && table.has(key))
      throw InputError(
          table.place_of(key),
          fmt::format("'{}' turns the axes of a table, but the target strength is the same in all "
                      "directions: add 'file', or remove the key",
                      key));
}

void check_population(const TargetPopulationDescription& population, const TomlTable& table) {
  if (population.top_depth_m.value_or(0) < population.bottom_depth_m.value_or(0)) return;
  throw InputError(
      place_of_pair(table, "bottom_depth_m", "top_depth_m"),
      fmt::format("'bottom_depth_m' is {} and 'top_depth_m' is {}: depths increase downwards, so "
                  "the bottom must be deeper than the top",
                  population.bottom_depth_m.value_or(0), population.top_depth_m.value_or(0)));
}

}  // namespace

const TomlSection<WaterTargetDescription>& target_section() {
  using T = WaterTargetDescription;
  static const auto section =
      TomlSection<T>(
          "[[targets]]",
          "Point target in the water, such as a fish or a calibration sphere. It returns sound, but "
          "hides nothing.")
          .keys({field("name", &T::name,
                       {.meaning = "Name of the target in messages.",
                        .required = true,
                        .longest = limits::name_bytes}),
                 field("position_m", &T::position_m,
                       {.meaning = "Position: east, north, up.", .ranges = {coordinate}}),
                 field("position_lat_lon_deg", &T::position_lat_lon_deg,
                       {.meaning = "Latitude and longitude (WGS 84), instead of the first two numbers of "
                                   "`position_m`. Needs `[georeference]`.",
                        .ranges = {latitude, longitude}}),
                 strength_field(), strength_file_field(),
                 field("heading_deg", &T::heading_deg,
                       {.meaning = "Heading of the axes of the table, clockwise from north. The angles are "
                                   "those of an object.",
                        .ranges = {heading}}),
                 field("pitch_deg", &T::pitch_deg,
                       {.meaning = "Pitch of the axes of the table.", .ranges = {{.lo = -90, .hi = 90}}}),
                 field("roll_deg", &T::roll_deg,
                       {.meaning = "Roll of the axes of the table.", .ranges = {roll}})})
          .check(check_target);
  return section;
}

const TomlSection<TargetPopulationDescription>& target_population_section() {
  using P = TargetPopulationDescription;
  constexpr ValueRange density{.lo = 0, .hi = 1e6, .lo_excluded = true}, depth{.lo = -12000, .hi = 12000};
  static const auto section =
      TomlSection<P>("[[target_populations]]",
                     "Point targets at random positions in a box, such as a school of fish. All pings and "
                     "sensors meet the same targets.")
          .keys(
              {field("name", &P::name,
                     {.meaning = "Name of the population in messages. Populations with different names are "
                                 "independent.",
                      .required = true,
                      .longest = limits::name_bytes}),
               field("density_per_m3", &P::density_per_m3,
                     {.meaning = "Mean number of targets per cubic metre.",
                      .ranges = {density},
                      .required = true}),
               field("centre_m", &P::centre_m,
                     {.meaning = "Centre of the box: east, north.", .ranges = {coordinate}}),
               field("size_m", &P::size_m,
                     {.meaning = "Extent of the box: east-west, north-south.",
                      .ranges = {size},
                      .required = true}),
               field("top_depth_m", &P::top_depth_m,
                     {.meaning = "Depth of the top of the box below the sea surface.",
                      .ranges = {depth},
                      .default_value = "0"}),
               field("bottom_depth_m", &P::bottom_depth_m,
                     {.meaning = "Depth of the bottom of the box below the sea surface.",
                      .ranges = {depth},
                      .required = true}),
               mean_strength_field(),
               field("strength_spread_db", &P::strength_spread_db,
                     {.meaning = "Standard deviation of the target strength, which is normally distributed.",
                      .ranges = {{.lo = 0, .hi = 40}}}),
               field("seed", &P::seed,
                     {.meaning = "Seed of positions and target strengths.", .ranges = {not_negative}})})
          .check(check_population);
  return section;
}

}  // namespace tubefoot
