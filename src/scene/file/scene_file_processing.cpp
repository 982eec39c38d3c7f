// SPDX-License-Identifier: GPL-3.0-or-later
#include <toml++/toml.h>

#include "scene/file/scene_file_ranges.hpp"
#include "scene/file/scene_file_sections.hpp"
#include "scene/file/scene_file_tables.hpp"

// The sections [processing] and [sensors.processing] of a scene file: the assumed configuration.
namespace tubefoot {
namespace {

using P = ProcessingDescription;

/// Returns a key that also records the place of its value.
template <class T>
TomlField<P> placed_field(std::string_view name, T P::*member, SourcePlace P::*place, KeyRule rule) {
  const TomlField<P> of_value = field(name, member, std::move(rule));
  return {of_value.key, [read = of_value.read, place](const toml::node& node, TomlSource& source, P& p) {
            read(node, source, p);
            p.*place = source.place(node);
          }};
}

TomlField<P> assumed_water_field() {
  return table_field<P>(
      "water",
      {.meaning = "Assumed water, in the section `[processing.water]`.", .default_value = "the true water"},
      [](const toml::table& table, TomlSource& source, P& p) {
        const TomlTable water{&table, source.place(table.source()), &source};
        p.water = assumed_water_section().read(water, source);
      });
}

}  // namespace

const TomlSection<ProcessingDescription>& processing_section() {
  constexpr ValueRange latency{.lo = -1000, .hi = 1000};
  constexpr ValueRange tide{.lo = -1000, .hi = 1000};
  constexpr ValueRange angle{.lo = -180, .hi = 180};
  constexpr ValueRange error{.lo = -1e6, .hi = 1e6};
  constexpr ValueRange angle_noise{.lo = 0, .hi = 180};
  constexpr ValueRange position_noise{.lo = 0, .hi = 1e6};
  static const auto section =
      TomlSection<P>("[processing]",
                     "Assumed configuration with which the software of the sonars makes its files. Every key "
                     "defaults to the true value. The energies in echoes.nc, labels, signals and footprints "
                     "do not depend on this section.")
          .keys({assumed_water_field(),
                 field("sound_speed_at_transducer_m_s", &P::sound_speed_at_transducer_m_s,
                       {.meaning = "Sound speed with which a flat array computes the angles of its beams. "
                                   "Applies to multibeams, receiver pairs and arrays.",
                        .ranges = {{.lo = 1300, .hi = 1700}},
                        .default_value = "the true sound speed"}),
                 placed_field("latency_s", &P::latency_s, &P::latency_place,
                              {.meaning = "Latency of positions: the recorded position at a time is the "
                                          "true position this long before.",
                               .ranges = {latency}}),
                 placed_field("attitude_latency_s", &P::attitude_latency_s, &P::attitude_latency_place,
                              {.meaning = "Latency of attitudes: the recorded attitude at a time is the "
                                          "true attitude this long before.",
                               .ranges = {latency}}),
                 field("tide_m", &P::tide_m,
                       {.meaning = "Assumed minus true height of the water level. Recorded heights of sonar "
                                   "and soundings increase by this value.",
                        .ranges = {tide}}),
                 placed_field("tide_file", &P::tide_file, &P::tide_file_place,
                              {.meaning = "CSV file with the columns `time_s,tide_m`: further error of the "
                                          "water level by time, with linear interpolation."}),
                 field("attitude_bias_deg", &P::attitude_bias_deg,
                       {.meaning = "Constant errors of the recorded heading, pitch and roll.",
                        .ranges = {angle}}),
                 field("attitude_drift_deg_per_hour", &P::attitude_drift_deg_per_hour,
                       {.meaning = "Errors of the recorded heading, pitch and roll that grow linearly from "
                                   "time 0 of the scene.",
                        .ranges = {error}}),
                 field("attitude_noise_deg", &P::attitude_noise_deg,
                       {.meaning = "Standard deviations of the normal errors of heading, pitch and roll, "
                                   "which are independent at each transmission.",
                        .ranges = {angle_noise}}),
                 field("position_bias_m", &P::position_bias_m,
                       {.meaning = "Constant errors of the recorded position: east, north, up.",
                        .ranges = {error}}),
                 field("position_drift_m_per_hour", &P::position_drift_m_per_hour,
                       {.meaning = "Errors of the recorded position that grow linearly from time 0 of the "
                                   "scene: east, north, up.",
                        .ranges = {error}}),
                 field("position_noise_m", &P::position_noise_m,
                       {.meaning = "Standard deviations of the normal errors of the position, which are "
                                   "independent at each transmission: east, north, up.",
                        .ranges = {position_noise}}),
                 field("seed", &P::seed, {.meaning = "Seed of the noise.", .ranges = {not_negative}})});
  return section;
}

const TomlSection<AssumedMountingDescription>& assumed_mounting_section() {
  using M = AssumedMountingDescription;
  static const auto section =
      TomlSection<M>("[sensors.processing]",
                     "Mounting of the preceding sensor that its software assumes. Every key defaults to the "
                     "true value.")
          .keys({field("yaw_deg", &M::yaw_deg,
                       {.meaning = "Assumed mounting angle: rotation to starboard.",
                        .ranges = {heading},
                        .default_value = "value of the sensor"}),
                 field("tilt_deg", &M::tilt_deg,
                       {.meaning = "Assumed mounting angle: rotation downwards.",
                        .ranges = {pitch},
                        .default_value = "value of the sensor"}),
                 field("roll_deg", &M::roll_deg,
                       {.meaning = "Assumed mounting angle: rotation that lowers the starboard side.",
                        .ranges = {roll},
                        .default_value = "value of the sensor"}),
                 field("lever_arm_m", &M::lever_arm_m,
                       {.meaning = "Assumed position of the sensor on the carrier: starboard, forward, up.",
                        .ranges = {{.lo = -1000, .hi = 1000}},
                        .default_value = "value of the sensor"})});
  return section;
}

TomlField<SensorDescription> assumed_mounting_field() {
  return table_field<SensorDescription>(
      "processing",
      {.meaning = "Assumed mounting, in the section `[sensors.processing]`.",
       .default_value = "the true mounting"},
      [](const toml::table& table, TomlSource& source, SensorDescription& sensor) {
        const TomlTable mounting{&table, source.place(table.source()), &source};
        sensor.assumed = assumed_mounting_section().read(mounting, source);
      });
}

}  // namespace tubefoot
