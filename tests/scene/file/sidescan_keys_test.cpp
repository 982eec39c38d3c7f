// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "fixtures/world/read_scenes.hpp"
#include "sensors/kinds/kind_sidescan.hpp"

namespace tubefoot {
namespace {

using testing::AllOf;
using testing::HasSubstr;

/// A scene with a sidescan that has these keys, too.
std::string scene_with_sidescan(const std::string& lines) {
  return std::string(smallest_scene) + "[[sensors]]\nname = \"fish\"\n" + lines;
}

SidescanDescription fan_of(const SceneDescription& scene) {
  return scene.sensors.back().kind.as<SidescanDescription>();
}

TEST(SidescanKeys, SamplingFrequencyTakesThePlaceOfSamples) {
  const TestFolder folder;
  const auto plain =
      fan_of(read_scene(folder, scene_with_sidescan("kind = \"sidescan\"\nsampling_frequency_khz = 20\n")));
  EXPECT_EQ(plain.sampling_frequency_khz, 20);
  EXPECT_THAT(scene_error(folder, scene_with_sidescan(
                                      "kind = \"sidescan\"\nsamples = 10\nsampling_frequency_khz = 20\n")),
              AllOf(HasSubstr("'samples' and 'sampling_frequency_khz'"), HasSubstr("remove one")));
  // The sampling frequency of the scene replaces the number of samples of a preset.
  EXPECT_EQ(fan_of(read_scene(folder, scene_with_sidescan(
                                          "preset = \"klein-3000-445\"\nsampling_frequency_khz = 20\n")))
                .sampling_frequency_khz,
            20);
}

TEST(SidescanKeys, AxisNeedsAPatternToTurn) {
  const TestFolder folder;
  const std::string axis = "kind = \"sidescan\"\naxis_depression_deg = 20\n";
  EXPECT_THAT(scene_error(folder, scene_with_sidescan(axis)),
              HasSubstr("add transmit_pattern or receive_pattern"));
  for (const std::string side : {"transmit", "receive"})
    EXPECT_EQ(fan_of(read_scene(folder, scene_with_sidescan(axis + side + "_pattern = \"gaussian\"\n" + side +
                                                            "_beam_width_deg = 50\n")))
                  .axis_depression_deg,
              20);
}

TEST(SidescanKeys, GainMayBeFixedBelowAnyRange) {
  const TestFolder folder;
  const std::string near = "kind = \"sidescan\"\ntvg_fixed_below_m = 1.5\n";
  EXPECT_THAT(scene_error(folder, scene_with_sidescan(near)),
              HasSubstr("'tvg_fixed_below_m' needs 'tvg_spreading'"));
  EXPECT_EQ(read_scene(folder, scene_with_sidescan(near + "tvg_spreading = 30\n"))
                .sensors.back()
                .signal.tvg_fixed_below_m,
            1.5);
}

TEST(SidescanKeys, AnySensorMayHaveAPulse) {
  const TestFolder folder;
  EXPECT_EQ(read_scene(folder, scene_with_sidescan("kind = \"didson\"\npulse_length_us = 16\n"))
                .sensors.back()
                .signal.pulse_length_us,
            16);
  EXPECT_THAT(scene_error(folder, scene_with_sidescan("kind = \"sidescan\"\npulse_length_us = 0\n")),
              HasSubstr("pulse_length_us"));
}

}  // namespace
}  // namespace tubefoot
