// SPDX-License-Identifier: GPL-3.0-or-later
// Tests the keys of sensors that record element signals, and the keys of the scatterers whose echoes they
// record.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>

#include "fixtures/world/read_scenes.hpp"
#include "sensors/kinds/kind_array.hpp"
#include "sensors/model/sensor.hpp"
#include "sensors/recordings/sensor_kind.hpp"

namespace tubefoot {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

SceneDescription scene_with_array(const std::string& keys, const std::string& more = "") {
  const TestFolder folder;
  return read_scene(folder, replaced(smallest_scene, "kind = \"didson\"\n",
                                     "kind = \"array\"\npulse_length_us = 500\n" + keys + more));
}

ArrayDescription keys_of(const std::string& keys) {
  return scene_with_array(keys).sensors.at(0).kind.as<ArrayDescription>();
}

TEST(ArrayKeys, AllAreRead) {
  const ArrayDescription a = keys_of(
      "frequency_khz = 60\nbandwidth_khz = 12\npulse_taper = 0.5\nsampling_frequency_khz = 40\n"
      "baseband_khz = 61\nrange_min_m = 2\nrange_max_m = 30\nhorizontal_deg = 70\nvertical_deg = 33\n"
      "receivers = 7\nreceiver_spacing_m = [0.01, 0.02, 0.03]\nstop_and_hop = false\nown_sights = true\n"
      "signal_tolerance = 1e-4\nproducts = [\"fan\", \"sidescan\", \"aperture\", \"interferogram\"]\n"
      "formats = [\"jsf\", \"sonar_netcdf\"]\nbeams = 11\nbeams_deg = 44\nbeams_depression_deg = 5\n"
      "beams_plane = \"across_track\"\nsides = \"both\"\nbeam_window = \"taylor\"\nrange_window = "
      "\"hamming\"\n"
      "ping_window = \"uniform\"\npicture_m = [1, 2, 3, 4]\npicture_up_m = -5\npixel_m = 0.1\nhalf_beam_deg "
      "= 12\n"
      "upper = [0, 1]\nlower = [2]\nlooks_range = 3\nlooks_pings = 2\n");
  EXPECT_EQ(a.frequency_khz, 60);
  EXPECT_EQ(a.bandwidth_khz, 12);
  EXPECT_EQ(a.pulse_taper, 0.5);
  EXPECT_EQ(a.sampling_frequency_khz, 40);
  EXPECT_EQ(a.baseband_khz, 61);
  EXPECT_EQ(a.range_min_m, 2);
  EXPECT_EQ(a.range_max_m, 30);
  EXPECT_EQ(a.horizontal_deg, 70);
  EXPECT_EQ(a.vertical_deg, 33);
  EXPECT_EQ(a.receivers, 7);
  EXPECT_EQ(a.receiver_spacing_m, (std::array{0.01, 0.02, 0.03}));
  EXPECT_TRUE(a.own_views);
  EXPECT_EQ(a.signal_tolerance, 1e-4);
  EXPECT_THAT(a.products, ElementsAre("fan", "sidescan", "aperture", "interferogram"));
  EXPECT_THAT(a.formats, ElementsAre("jsf", "sonar_netcdf"));
  EXPECT_EQ(a.beams, 11);
  EXPECT_EQ(a.beams_deg, 44);
  EXPECT_EQ(a.beams_depression_deg, 5);
  EXPECT_EQ(a.beams_plane, "across_track");
  EXPECT_EQ(a.sides, "both");
  EXPECT_EQ(a.beam_window, "taylor");
  EXPECT_EQ(a.range_window, "hamming");
  EXPECT_EQ(a.ping_window, "uniform");
  EXPECT_EQ(a.picture_m, (std::array{1.0, 2.0, 3.0, 4.0}));
  EXPECT_EQ(a.picture_up_m, -5);
  EXPECT_EQ(a.pixel_m, 0.1);
  EXPECT_EQ(a.half_beam_deg, 12);
  EXPECT_THAT(a.upper, ElementsAre(0, 1));
  EXPECT_THAT(a.lower, ElementsAre(2));
  EXPECT_EQ(a.looks_range, 3);
  EXPECT_EQ(a.looks_pings, 2);
  EXPECT_THAT(keys_of("receivers_m = [[1, 2, 3], [4, 5, 6]]\n").receivers_m,
              ElementsAre(std::array{1.0, 2.0, 3.0}, std::array{4.0, 5.0, 6.0}));
}

// Errors name nested lists as lists, and report each list and each number in it.
TEST(ArrayKeys, WrongListsSayWhatIsExpected) {
  const auto said = [](const std::string& keys) -> std::string {
    try {
      keys_of(keys);
    } catch (const std::exception& error) {
      return error.what();
    }
    return "nothing was wrong";
  };
  EXPECT_THAT(said("receivers_m = [[0, 0]]\n"),
              HasSubstr("must be an array of 3 numbers in metres (-1000 to 1000), not of 2"));
  EXPECT_THAT(said("receivers_m = [[0, nan, 0]]\n"),
              HasSubstr("must be a number in metres (-1000 to 1000), not nan: it must be finite"));
  EXPECT_THAT(said("receivers_m = [0, 0, 0]\n"),
              HasSubstr("must be an array of 3 numbers in metres (-1000 to 1000), not an integer"));
  EXPECT_THAT(said("receivers_m = 3\n"), HasSubstr("must be an array of lists of 3 numbers in metres"));
}

TEST(ArrayKeys, OfTheScatterers) {
  const ScatterersDescription s = scene_with_array("",
                                                   "[scatterers]\nspacing_m = 0.02\ntexture = \"gamma\"\n"
                                                   "texture_shape = 2.5\ntexture_cell_m = 0.3\n")
                                      .scatterers;
  EXPECT_EQ(s.spacing_m, 0.02);
  EXPECT_EQ(s.texture, "gamma");
  EXPECT_EQ(s.texture_shape, 2.5);
  EXPECT_EQ(s.texture_cell_m, 0.3);
  EXPECT_FALSE(scene_with_array("").scatterers.spacing_m);
  const TestFolder folder;
  EXPECT_THAT(scene_error(folder, std::string(smallest_scene) + "[scatterers]\ntexture_shape = 2\n"),
              HasSubstr("'texture_shape' applies only to a texture"));
}

// The sound speed determines the length of samples and the position of half a wavelength.
TEST(ArrayKeys, BecomeASonarInItsWater) {
  const SceneDescription scene = scene_with_array(
      "frequency_khz = 30\nbandwidth_khz = 6\nsampling_frequency_khz = 20\nrange_min_m = 2\n"
      "range_max_m = 10\nreceivers = 3\n");
  const auto sensor = make_sensor(in_water(scene.sensors.at(0), 1500));
  EXPECT_NEAR(sensor->samples().step_m, 0.0375, 1e-12);
  EXPECT_EQ(sensor->samples().count, 213);  // 8 m of samples
  EXPECT_EQ(sensor->beams().size(), 1u);
  const SignalModel* model = sensor->signals();
  ASSERT_NE(model, nullptr);
  ASSERT_EQ(model->array.receivers_m.size(), 3u);
  EXPECT_NEAR(model->array.receivers_m[2].x, 0.025, 1e-15);
  EXPECT_NEAR(model->array.receivers_m[0].x, -0.025, 1e-15);
  EXPECT_EQ(model->sampling.baseband_hz, 30e3);
  EXPECT_NEAR(model->sampling.first_s, 4 / 1500.0, 1e-15);
  EXPECT_EQ(model->waveform.start_hz, 27e3);
  EXPECT_EQ(model->waveform.stop_hz, 33e3);
  EXPECT_EQ(model->waveform.duration_s, 5e-4);
  EXPECT_TRUE(model->stop_and_hop);
}

}  // namespace
}  // namespace tubefoot
