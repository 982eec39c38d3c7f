// SPDX-License-Identifier: GPL-3.0-or-later
// Repeats the experiment of the original paper: a camera on a straight line at constant speed over a flat
// seabed. Micro-texture is fixed to the scene, so that adjacent frames share it and reveal the motion.
// Speckle is new for each frame, so that adjacent frames do not share it.
#include "track/camera_track.hpp"

#include <gtest/gtest.h>

#include "run/simulation.hpp"
#include "sensors/kinds/kind_didson.hpp"
#include "sensors/kinds/scene_file.hpp"
#include "sensors/products/received.hpp"

namespace tubefoot {
namespace {

constexpr double pixel_m = 0.02;

TrackEstimate track_of(bool texture, bool speckle) {
  SceneDescription scene = read_scene_file(TUBEFOOT_SOURCE_DIR "/scenes/textures/track.toml");
  SensorDescription& camera = scene.sensors.at(0);
  camera.pings = 4;
  camera.kind.edit<DidsonDescription>().samples = 200;
  if (!texture)
    for (MaterialDescription& material : scene.materials) material.reflectivity.clear();
  camera.signal.speckle = speckle ? "rayleigh" : "none";
  const auto survey = open_survey(scene);
  SimulationStats stats;
  const Recording recording = simulate(*survey, request_of(scene.run), stats).front();
  RunContext run;
  run.seed = 5;
  std::vector<std::vector<double>> frames;
  const ReceivedPings received(recording, run);
  for (std::size_t ping = 0; ping < recording.pings(); ++ping) frames.push_back(received.of(ping));
  return estimate_track(recording, frames, {0, pixel_m}, 6);
}

TEST(CameraTrack, MicroTextureGivesBackTheWay) {
  const TrackEstimate track = track_of(true, false);
  ASSERT_EQ(track.shifts.size(), 3u);
  for (const TrackStep& step : track.true_steps)
    EXPECT_NEAR(std::hypot(step.starboard_m, step.ahead_m), 0.05, 1e-9);
  EXPECT_LT(track.worst_pixels, 1);
  EXPECT_GT(track.least_correlation, 0.9);
}

TEST(CameraTrack, SpeckleHasNothingInCommonFromFrameToFrame) {
  const TrackEstimate track = track_of(false, true);
  EXPECT_LT(track.largest_correlation, 0.1);
  EXPECT_GT(track.worst_pixels, 1);
}

}  // namespace
}  // namespace tubefoot
