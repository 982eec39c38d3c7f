// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/ping_times.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace tubefoot {
namespace {

using testing::AllOf;
using testing::DoubleNear;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Pointwise;
using testing::ThrowsMessage;

SensorDescription sonar(std::optional<int> pings, double interval_s, double first_s = 0) {
  SensorDescription sensor;
  sensor.place = {"scene.toml", 40, 1};
  sensor.name = "sonar";
  sensor.pings = pings;
  sensor.ping_interval_s = interval_s;
  sensor.first_ping_s = first_s;
  return sensor;
}

/// From 0 to 1 s, from 10 to 10.05 s, from 20 to 20.5 s.
Trajectory three_lines() {
  return Trajectory({{0, {}}, {30, {{0, 30, 0}, {1, 0, 0, 0}}}}, {{0, 1}, {10, 10.05}, {20, 20.5}});
}

PingTimes times(const SensorDescription& sensor) { return {sensor, three_lines(), "survey"}; }

auto near(const std::vector<double>& expected) { return Pointwise(DoubleNear(1e-12), expected); }

TEST(PingTimes, OfATrackThatIsNotDividedAreAnIntervalApart) {
  const Trajectory still(std::vector<Trajectory::Sample>(1));
  const PingTimes one(sonar({}, 0.1, 5), still, "still");
  EXPECT_THAT(one.times_s(), ElementsAre(5));
  EXPECT_THAT(one.line_starts(), IsEmpty());
  EXPECT_THAT(PingTimes(sonar(3, 0.25, 5), still, "still").times_s(), ElementsAre(5, 5.25, 5.5));
}

TEST(PingTimes, OfASurveyBeginAnewOnEachLineAndAreAllThatFit) {
  EXPECT_THAT(times(sonar({}, 0.2)).times_s(), near({0, 0.2, 0.4, 0.6, 0.8, 1, 10, 20, 20.2, 20.4}));
  EXPECT_THAT(times(sonar({}, 0.2)).line_starts(), ElementsAre(0, 6, 7));
  // A line that is too short for a ping has none, and is not a line of the recording.
  EXPECT_THAT(times(sonar({}, 0.3, 0.1)).times_s(), near({0.1, 0.4, 0.7, 1, 20.1, 20.4}));
  EXPECT_THAT(times(sonar({}, 0.3, 0.1)).line_starts(), ElementsAre(0, 4));
  EXPECT_EQ(times(sonar({}, 0.3, 0.1)).first_s(), 0.1);
}

TEST(PingTimes, AreTheFirstOfASurveyWhereFewerAreRequested) {
  EXPECT_THAT(times(sonar(6, 0.2)).line_starts(), ElementsAre(0));
  EXPECT_THAT(times(sonar(8, 0.2)).times_s(), near({0, 0.2, 0.4, 0.6, 0.8, 1, 10, 20}));
  EXPECT_THAT(times(sonar(8, 0.2)).line_starts(), ElementsAre(0, 6, 7));
  EXPECT_EQ(times(sonar(10, 0.2)).count(), 10u);
  EXPECT_THAT([] { times(sonar(11, 0.2)); },
              ThrowsMessage<InputError>(
                  AllOf(HasSubstr("scene.toml:40:1"), HasSubstr("11 pings"), HasSubstr("hold only 10"))));
}

TEST(PingTimes, RefuseASurveyWithoutPingsAndOneWithTooMany) {
  EXPECT_THAT([] { times(sonar({}, 0.2, 2)); },
              ThrowsMessage<InputError>(HasSubstr("no ping of sensor 'sonar'")));
  EXPECT_THAT([] { times(sonar({}, 0.2, -1)); },
              ThrowsMessage<InputError>(HasSubstr("no ping of sensor 'sonar'")));
  EXPECT_THAT([] { times(sonar({}, 1e-8)); }, ThrowsMessage<InputError>(HasSubstr("more than 1e+07 pings")));
}

TEST(PingTimes, OfAListAreThoseOfTheList) {
  SensorDescription sensor = sonar({}, 0.1);
  sensor.ping_times_s = {2, 2.25, 7};
  const Trajectory still(std::vector<Trajectory::Sample>(1));
  const PingTimes listed(sensor, still, "still");
  EXPECT_THAT(listed.times_s(), ElementsAre(2, 2.25, 7));
  EXPECT_EQ(listed.count(), 3u);
  EXPECT_EQ(listed.first_s(), 2);
  EXPECT_THAT(listed.line_starts(), IsEmpty());
  EXPECT_TRUE(sensor.has_several_pings());
  EXPECT_EQ(sensor.shortest_interval_s(), 0.25);
}

TEST(PingTimes, OfAListAreOnTheTrajectoryAndNotOnLines) {
  SensorDescription sensor = sonar({}, 0.1);
  sensor.ping_times_s = {2, 31};
  EXPECT_THAT([&] { times(sensor); },
              ThrowsMessage<InputError>(AllOf(HasSubstr("scene.toml:40:1"), HasSubstr("'ping_times_s'"),
                                              HasSubstr("divided into lines"))));
  const Trajectory short_track({{0, {}}, {30, {{0, 30, 0}, {1, 0, 0, 0}}}});
  EXPECT_THAT([&] { PingTimes(sensor, short_track, "track"); },
              ThrowsMessage<InputError>(
                  AllOf(HasSubstr("ping 1 of sensor 'sonar' is at 31 s"), HasSubstr("change ping_times_s"))));
}

}  // namespace
}  // namespace tubefoot
