// SPDX-License-Identifier: GPL-3.0-or-later
// Tests survey tracks: parallel lines about the middle of an area, turns, headings, depths and altitudes,
// and positions on a map.

#include "scene/tracks.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

#include "fixtures/geometry/near.hpp"

namespace tubefoot {
namespace {

using test::expect_near;
using testing::AllOf;
using testing::HasSubstr;
using testing::ThrowsMessage;

/// Three lines of 80 m, 10 m apart, at 2 m/s.
SurveyTrajectory mown() {
  SurveyTrajectory survey;
  survey.centre_m = {100, 50};
  survey.length_m = 80;
  survey.width_m = 29;  // a fourth line would lie outside
  survey.spacing_m = 10;
  survey.speed_m_s = 2;
  survey.turn_s = 30;
  survey.up_m = -5;
  return survey;
}

Trajectory track(const SurveyTrajectory& survey, const TrackSurroundings& around = {}) {
  TrajectoryDescription description;
  description.place = {"scene.toml", 7, 1};
  description.kind = survey;
  return make_trajectory(description, around);
}

glm::dvec3 forward(const Pose& pose) { return pose.attitude * glm::dvec3(0, 1, 0); }

TEST(SurveyTrack, GoesUpAndDownLinesAboutTheMiddleOfItsArea) {
  const Trajectory t = track(mown());
  ASSERT_EQ(t.lines().size(), 3u);
  for (std::size_t line = 0; line < 3; ++line) {
    const double sense = line == 1 ? -1 : 1, east = 90 + 10.0 * static_cast<double>(line);
    const auto [begin, end] = t.lines()[line];
    EXPECT_DOUBLE_EQ(begin, 70.0 * static_cast<double>(line));  // 40 s of line, 30 s of turn
    EXPECT_DOUBLE_EQ(end - begin, 40);
    expect_near(t.at(begin).position_m, {east, 50 - sense * 40, -5});
    expect_near(t.at(begin + 10).position_m, {east, 50 - sense * 20, -5});
    expect_near(t.at(end).position_m, {east, 50 + sense * 40, -5});
    expect_near(forward(t.at(begin + 10)), {0, sense, 0});
    expect_near(t.at(end + 1).position_m, {east, 50 + sense * 42, -5});  // transmissions that come later
  }
}

TEST(SurveyTrack, LinesTooShortToTakeTimeAreRefused) {
  SurveyTrajectory survey = mown();
  survey.length_m = 1e-15;  // at 70 s a line ends at its start time
  EXPECT_THAT([&] { track(survey); },
              ThrowsMessage<InputError>(AllOf(HasSubstr("scene.toml:7"), HasSubstr("must increase"))));
}

TEST(SurveyTrack, TurnsWithItsHeadingAndGoesOneWayIfRequested) {
  SurveyTrajectory survey = mown();
  survey.heading_deg = 60;
  survey.one_way = true;
  survey.pitch_deg = 5;
  const Trajectory t = track(survey);
  const double h = std::numbers::pi / 3, p = std::numbers::pi / 36;
  const glm::dvec3 along(std::sin(h), std::cos(h), 0), starboard(std::cos(h), -std::sin(h), 0);
  for (std::size_t line = 0; line < 3; ++line) {
    const double begin = t.lines()[line].begin_s;
    expect_near(t.at(begin).position_m,
                glm::dvec3(100, 50, -5) - 40.0 * along + 10.0 * (static_cast<double>(line) - 1) * starboard);
    expect_near(forward(t.at(begin)), std::cos(p) * along + glm::dvec3(0, 0, std::sin(p)));
  }
}

TEST(SurveyTrack, AWidthOfZeroIsOneLineAndWholeSpacingsHaveOneMore) {
  SurveyTrajectory survey = mown();
  survey.width_m = 0;
  EXPECT_EQ(track(survey).lines().size(), 1u);
  survey.width_m = 0.3;
  survey.spacing_m = 0.1;  // 0.3 / 0.1 is less than 3
  EXPECT_EQ(track(survey).lines().size(), 4u);
  survey.spacing_m = 1e-9;
  EXPECT_THAT([&] { track(survey); },
              ThrowsMessage<InputError>(AllOf(HasSubstr("scene.toml:7:1"), HasSubstr("'spacing_m'"))));
}

TEST(SurveyTrack, HasItsHeightByDepthOrByAltitudeOverTheTerrain) {
  SurveyTrajectory survey = mown();
  survey.up_m.reset();
  survey.depth_m = 7;
  EXPECT_EQ(track(survey, {{}, 1.5, {}}).at(3).position_m.z, -5.5);

  survey.depth_m.reset();
  survey.altitude_m = 4;
  TrackSurroundings around;
  std::size_t requested = 0;
  around.terrain_heights_m = [&](std::span<const glm::dvec2> places) {
    std::vector<std::optional<double>> heights;
    requested = places.size();
    for (const glm::dvec2& p : places) heights.push_back(-20 + 0.1 * p.x + 0.25 * p.y);
    return heights;
  };
  const Trajectory t = track(survey, around);
  EXPECT_EQ(requested, 3u * 21);  // every 4 m
  for (const double time_s : {0.0, 11.1, 40.0, 83.0, 170.0}) {
    const glm::dvec3 at = t.at(time_s).position_m;
    EXPECT_NEAR(at.z, -16 + 0.1 * at.x + 0.25 * at.y, 1e-9) << time_s;
    EXPECT_NEAR(forward(t.at(time_s)).z, 0, 1e-12);  // it stays level
  }
  survey.altitude_step_m = 40;
  track(survey, around);
  EXPECT_EQ(requested, 3u * 3);
  survey.altitude_step_m = 1e-6;
  EXPECT_THAT([&] { track(survey, around); }, ThrowsMessage<InputError>(HasSubstr("'altitude_step_m'")));

  survey.altitude_step_m = 40;
  around.terrain_heights_m = [](std::span<const glm::dvec2> places) {
    std::vector<std::optional<double>> heights(places.size(), -20.0);
    heights[4].reset();
    return heights;
  };
  EXPECT_THAT([&] { track(survey, around); },
              ThrowsMessage<InputError>(
                  AllOf(HasSubstr("scene.toml:7:1"), HasSubstr("below line 2 at 100.000 m east, "
                                                               "50.000 m north"))));
}

TEST(SurveyTrack, LiesAboutAPlaceOfTheMapOrOfTheEarth) {
  SurveyTrajectory survey = mown();
  const SourcePlace place{"scene.toml", 1, 1};
  const LocalFrame utm = LocalFrame::projected("EPSG:32632", 400000, 5400000, 0, place);
  survey.centre_crs = {400100, 5400050};
  const glm::dvec3 begin(90, 10, -5);
  expect_near(track(survey, {utm, 0, {}}).at(0).position_m, begin);
  EXPECT_THAT(
      [&] {
        track(survey, {LocalFrame::at_lat_lon(48, 7, 0), 0, {}});
      },
      ThrowsMessage<InputError>(HasSubstr("'crs'")));
  survey.centre_crs.reset();
  glm::dvec3 centre(100, 50, 0);
  utm.to_lon_lat({&centre, 1}, place);
  survey.centre_lat_lon_deg = {centre.y, centre.x};
  expect_near(track(survey, {utm, 0, {}}).at(0).position_m, begin, 1e-6);
  EXPECT_THAT([&] { track(survey); },
              ThrowsMessage<InputError>(AllOf(HasSubstr("scene.toml:7:1"), HasSubstr("[georeference]"))));
}

}  // namespace
}  // namespace tubefoot
