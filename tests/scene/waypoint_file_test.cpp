// SPDX-License-Identifier: GPL-3.0-or-later
// Tests waypoint files: columns, comments, headings along the track, times from a speed, survey lines,
// coordinates, and errors.

#include "scene/waypoint_file.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>

#include "fixtures/geometry/near.hpp"
#include "fixtures/world/read_scenes.hpp"
#include "scene/tracks.hpp"

namespace tubefoot {
namespace {

using test::expect_near;
using testing::AllOf;
using testing::HasSubstr;
using testing::ThrowsMessage;

const glm::dvec3 kNorthward(0, 1, 0);

Trajectory read(const std::filesystem::path& file) { return read_waypoints({file, {}}, {}); }

constexpr const char* kHeader = "time_s,east_m,north_m,up_m,heading_deg,pitch_deg,roll_deg\n";

TEST(Waypoints, AreReadInAnyColumnOrderWithCommentsAndFurtherColumns) {
  const TestFolder folder;
  const Trajectory t =
      read(folder.write("route.csv",
                        "# a survey\r\n\r\n"
                        "note, up_m ,time_s,east_m,north_m,heading_deg,pitch_deg,roll_deg\r\n"
                        "start,-3,0,1,2,90,0,0\r\n"
                        "end,-5,2,3,4,90,0,0\r\n"));
  expect_near(t.at(1).position_m, {2, 3, -4});
  expect_near(t.at(1).attitude * kNorthward, {1, 0, 0});
}

struct BadCsv {
  const char* name;
  std::string content;
  const char* place;
  const char* message;
};
void PrintTo(const BadCsv& bad, std::ostream* out) { *out << bad.name; }

class WaypointsRefuse : public testing::TestWithParam<BadCsv> {};

TEST_P(WaypointsRefuse, BadFiles) {
  const TestFolder folder;
  const auto file = folder.write("route.csv", GetParam().content);
  EXPECT_THAT([&] { read(file); },
              ThrowsMessage<InputError>(AllOf(HasSubstr("route.csv" + std::string(GetParam().place)),
                                              HasSubstr(GetParam().message))));
}

INSTANTIATE_TEST_SUITE_P(
    Csv, WaypointsRefuse,
    testing::Values(BadCsv{"Empty", "", ": ", "expected the header"},
                    BadCsv{"NoPosition", "time_s,up_m\n0,1\n", ":1: ", "east_m and north_m, or"},
                    BadCsv{"HalfAPosition", "time_s,east_m,up_m\n0,1,2\n", ":1: ", "expected the columns"},
                    BadCsv{"MixedPosition", "time_s,east_m,longitude_deg,up_m\n0,1,2,3\n",
                           ":2:5: ", "longitude_deg does not belong to east_m"},
                    BadCsv{"TwoPositions",
                           "time_s,east_m,north_m,latitude_deg,longitude_deg,up_m\n0,1,2,3,4,5\n",
                           ":2:7: ", "east_m and latitude_deg give the same quantity"},
                    BadCsv{"NoHeight", "time_s,east_m,north_m\n0,1,2\n", ":1: ", "depth_m (below"},
                    BadCsv{"TwoHeights", "time_s,east_m,north_m,up_m,depth_m\n0,1,2,3,4\n",
                           ":2:9: ", "up_m and depth_m give the same quantity"},
                    BadCsv{"NoTimes", "east_m,north_m,up_m\n0,1,2\n0,2,2\n", ":1: ", "'speed_m_s'"},
                    BadCsv{"NoDirection", "time_s,east_m,north_m,up_m\n0,1,2,3\n1,1,2,4\n",
                           ":2:3: ", "no direction here"},
                    BadCsv{"OfNoMap", "time_s,easting,northing,up_m\n0,1,2,3\n1,1,5,3\n", ": ", "'crs'"},
                    BadCsv{"NoPlaceOnEarth", "time_s,latitude_deg,longitude_deg,up_m\n0,1,2,3\n1,1,5,3\n",
                           ": ", "[georeference]"},
                    BadCsv{"BeyondThePole", "time_s,latitude_deg,longitude_deg,up_m\n0,91,2,3\n",
                           ":2:3: ", "expected -90 to 90"},
                    BadCsv{"NoRow", kHeader, ": ", "at least one row"},
                    BadCsv{"NotANumber", std::string(kHeader) + "0,1,2,3,4,5,6\n1,1,north,3,4,5,6\n",
                           ":3:5: ", "north_m is 'north'"},
                    BadCsv{"Nan", std::string(kHeader) + "0,nan,2,3,4,5,6\n", ":2:3: ", "finite"},
                    BadCsv{"ShortRow", std::string(kHeader) + "0,1,2,3,4,5\n", ":2: ", "6 fields"},
                    BadCsv{"TimeStandsStill", std::string(kHeader) + "0,1,2,3,4,5,6\n0,1,2,3,4,5,6\n",
                           ":3:1: ", "time_s must increase"}),
    [](const auto& bad) { return bad.param.name; });

// An ignored column loses motion, so that a column with a similar name is an error.
struct Resembling {
  const char *column, *meant;
};
void PrintTo(const Resembling& one, std::ostream* out) { *out << one.column; }

class WaypointColumns : public testing::TestWithParam<Resembling> {};

TEST_P(WaypointColumns, AreRefusedWithASuggestionWhereTheyResembleAMissingOne) {
  const TestFolder folder;
  const auto [column, meant] = GetParam();
  const auto file = folder.write("route.csv", fmt::format("time_s,east_m,north_m,up_m,{}\n"
                                                          "0,0,0,0,1\n1,0,1,0,1\n",
                                                          column));
  EXPECT_THAT([&] { read(file); }, ThrowsMessage<InputError>(AllOf(
                                       HasSubstr(fmt::format("route.csv:1:28: unknown column '{}'", column)),
                                       HasSubstr(fmt::format("did you mean '{}'?", meant)))));
}

INSTANTIATE_TEST_SUITE_P(
    Names, WaypointColumns,
    testing::Values(Resembling{"heading", "heading_deg"}, Resembling{"Heading_deg", "heading_deg"},
                    Resembling{"HeadingDeg", "heading_deg"}, Resembling{"headingrad", "heading_deg"},
                    Resembling{"heading [deg]", "heading_deg"}, Resembling{"headnig_deg", "heading_deg"},
                    Resembling{"yaw_deg", "heading_deg"}, Resembling{"yaw", "heading_deg"},
                    Resembling{"hdg", "heading_deg"}, Resembling{"Pitch", "pitch_deg"},
                    Resembling{"pitch_degrees", "pitch_deg"}, Resembling{"picth_deg", "pitch_deg"},
                    Resembling{"ROLL", "roll_deg"}, Resembling{"depth", "depth_m"},
                    Resembling{"depth (m)", "depth_m"}, Resembling{"Lat", "latitude_deg"},
                    Resembling{"altitude", "altitude_m"}, Resembling{"Line", "line"}));

TEST(Waypoints, ListOtherColumnsAsIgnored) {
  const TestFolder folder;
  std::vector<std::string> odd;
  TrackSurroundings around;
  around.odd = &odd;
  const auto file = folder.write("route.csv",
                                 "time_s,note,east_m,north_m,up_m,heading_deg,heading,pitch_rate,\n"
                                 "0,a,0,0,0,0,0,0,\n1,b,0,1,0,0,0,0,\n");
  read_waypoints({file, {}}, around);
  EXPECT_THAT(odd, testing::ElementsAre(file.string() +
                                        ": tubefoot ignores the columns 'note', 'heading', 'pitch_rate'"));
  odd.clear();
  read_waypoints({folder.write("plain.csv", "time_s,east_m,north_m,up_m\n0,0,0,0\n1,0,1,0\n"), {}}, around);
  EXPECT_THAT(odd, testing::IsEmpty());
}

TEST(Waypoints, AColumnThatStandsTwiceIsRefused) {
  const TestFolder folder;
  const auto file = folder.write("route.csv", "time_s,east_m,north_m,up_m,up_m\n0,0,0,0,1\n1,0,1,0,1\n");
  EXPECT_THAT([&] { read(file); },
              ThrowsMessage<InputError>(HasSubstr("route.csv:1:28: the column up_m occurs twice")));
}

TEST(Waypoints, AMissingFileIsNamedWithThePlaceThatNamedIt) {
  TrajectoryDescription description;
  description.place = {"scene.toml", 3, 2};
  description.kind = WaypointTrajectory{"no_such_file.csv", {}};
  EXPECT_THAT([&] { make_trajectory(description, {}); },
              ThrowsMessage<InputError>(AllOf(HasSubstr("scene.toml:3:2"), HasSubstr("no_such_file.csv"))));
}

TEST(Waypoints, WithoutHeadingsLookAlongTheTrack) {
  const TestFolder folder;
  const Trajectory t = read(folder.write("route.csv",
                                         "time_s,east_m,north_m,up_m,roll_deg\n"
                                         "0,0,0,-3,0\n1,0,5,-3,0\n2,5,5,-3,20\n3,5,5,-4,0\n"));
  expect_near(t.at(0).attitude * kNorthward, {0, 1, 0});
  // half of the turn at the corner
  expect_near(t.at(1).attitude * kNorthward, {std::sqrt(0.5), std::sqrt(0.5), 0});
  expect_near(t.at(2).attitude * kNorthward, {1, 0, 0});
  expect_near(t.at(2).attitude * glm::dvec3(1, 0, 0),
              {0, -std::cos(glm::radians(20.0)), -std::sin(glm::radians(20.0))});
  expect_near(t.at(3).attitude * kNorthward, {1, 0, 0});  // it only descended
}

// For a stop of any length, the reader finds the heading in one pass.
TEST(Waypoints, ACarrierThatStaysLooksWhereItCameAlong) {
  const TestFolder folder;
  constexpr int rows = 200000;
  std::string text = "time_s,east_m,north_m,up_m\n-1,0,-5,0\n";
  for (int k = 0; k < rows; ++k) text += fmt::format("{},0,0,0\n", k);
  text += fmt::format("{},7,0,0\n", rows);
  const Trajectory t = read(folder.write("anchored.csv", text));
  expect_near(t.at(rows / 2).attitude * kNorthward, {std::sqrt(0.5), std::sqrt(0.5), 0});
  expect_near(t.at(rows).attitude * kNorthward, {1, 0, 0});
}

TEST(Waypoints, AWayTooShortToTakeTimeIsRefused) {
  const TestFolder folder;
  const auto file =
      folder.write("short.csv",
                   "east_m,north_m,up_m,heading_deg\n0,0,0,0\n9e6,0,0,0\n-9e6,0,0,0\n9e6,0,0,0\n"
                   "9000000.000000002,0,0,0\n");
  EXPECT_THAT(
      [&] {
        read_waypoints({file, 0.5}, {});
      },
      ThrowsMessage<InputError>(AllOf(HasSubstr("short.csv:6:1: "), HasSubstr("different positions"))));
}

TEST(Waypoints, WithoutTimesAreReachedAtTheSpeedThatIsGiven) {
  const TestFolder folder;
  const auto file = folder.write("route.csv", "east_m,north_m,up_m\n0,0,0\n30,40,0\n30,40,-10\n30,100,-10\n");
  const Trajectory t = read_waypoints({file, 2.0}, {});
  EXPECT_DOUBLE_EQ(t.end_s(), (50 + 10 + 60) / 2.0);
  expect_near(t.at(25).position_m, {30, 40, 0});
  expect_near(t.at(30).position_m, {30, 40, -10});
  EXPECT_TRUE(t.lines().empty());
  const auto timed = folder.write("timed.csv", "time_s,east_m,north_m,up_m\n0,0,0,0\n1,0,1,0\n");
  EXPECT_THAT(
      [&] {
        read_waypoints({timed, 2.0}, {});
      },
      ThrowsMessage<InputError>(HasSubstr("both define the times")));
  const auto still = folder.write("still.csv", "east_m,north_m,up_m,heading_deg\n0,0,0,0\n0,0,0,0\n");
  EXPECT_THAT(
      [&] {
        read_waypoints({still, 2.0}, {});
      },
      ThrowsMessage<InputError>(AllOf(HasSubstr("still.csv:3:1: "), HasSubstr("different positions"))));
}

TEST(Waypoints, AreDividedWhereTheirLineChanges) {
  const TestFolder folder;
  const Trajectory timed =
      read(folder.write("timed.csv",
                        "line,time_s,east_m,north_m,up_m\n"
                        "7,0,0,0,0\n7,10,0,20,0\n9,100,5,20,0\n9,104,5,10,0\n9,110,5,0,0\n"));
  ASSERT_EQ(timed.lines().size(), 2u);
  EXPECT_EQ(timed.lines()[0].end_s, 10);
  EXPECT_EQ(timed.lines()[1].begin_s, 100);
  expect_near(timed.at(10).attitude * kNorthward, {0, 1, 0});  // the turn does not bend the end of the line
  expect_near(timed.at(100).attitude * kNorthward, {0, -1, 0});

  const auto file =
      folder.write("route.csv", "line,east_m,north_m,up_m\n1,0,0,0\n1,0,20,0\n2,5,20,0\n2,5,0,0\n");
  const Trajectory going = read_waypoints({file, 2.0, 30}, {});
  ASSERT_EQ(going.lines().size(), 2u);
  EXPECT_EQ(going.lines()[0].end_s, 10);
  EXPECT_EQ(going.lines()[1].begin_s, 40);
  EXPECT_EQ(going.lines()[1].end_s, 50);
  expect_near(going.at(10.5).position_m,
              {0, 21, 0});  // straight on, as the later transmissions of the last ping need
}

TEST(Waypoints, LieWhereTheirCoordinatesSay) {
  const TestFolder folder;
  const SourcePlace place{"scene.toml", 1, 1};
  for (const LocalFrame& frame : {LocalFrame::projected("EPSG:32632", 500000, 5500000, 0, place),
                                  LocalFrame::at_lat_lon(49.6, 9.0, 0)}) {
    const std::vector<glm::dvec3> at{{12.5, -40.25, -3}, {812.5, 960, -7}};
    std::vector<glm::dvec3> on_earth = at;
    frame.to_lon_lat(on_earth, place);
    std::string rows = "time_s,longitude_deg,latitude_deg,depth_m\n";
    for (std::size_t k = 0; k < at.size(); ++k)
      rows += fmt::format("{},{:.13f},{:.13f},{}\n", k, on_earth[k].x, on_earth[k].y, 1.5 - at[k].z);
    const Trajectory t = read_waypoints({folder.write("earth.csv", rows), {}}, {frame, 1.5, {}});
    for (std::size_t k = 0; k < at.size(); ++k)
      expect_near(t.at(static_cast<double>(k)).position_m, at[k], 1e-5);
    const auto file = folder.write(
        "map.csv", "time_s,easting,northing,up_m\n0,500012.5,5499959.75,-3\n1,500812.5,5500960,-7\n");
    if (frame.is_tangent())
      EXPECT_THAT(
          [&] {
            read_waypoints({file, {}}, {frame, 0, {}});
          },
          ThrowsMessage<InputError>(HasSubstr("'crs'")));
    else
      for (std::size_t k = 0; k < at.size(); ++k)
        expect_near(read_waypoints({file, {}}, {frame, 0, {}}).at(static_cast<double>(k)).position_m, at[k],
                    1e-9);
  }
}

TEST(Waypoints, KeepTheirAltitudeOverTheTerrain) {
  const TestFolder folder;
  const auto file = folder.write("low.csv", "time_s,east_m,north_m,altitude_m\n0,0,0,2\n1,0,10,3\n");
  TrackSurroundings around;
  around.terrain_heights_m = [](std::span<const glm::dvec2> places) {
    std::vector<std::optional<double>> heights;
    for (const glm::dvec2& p : places) heights.push_back(p.y - 50);
    return heights;
  };
  EXPECT_EQ(read_waypoints({file, {}}, around).at(1).position_m.z, -37);
  around.terrain_heights_m = [](std::span<const glm::dvec2>) {
    return std::vector<std::optional<double>>{1.0, std::nullopt};
  };
  EXPECT_THAT(
      [&] {
        read_waypoints({file, {}}, around);
      },
      ThrowsMessage<InputError>(AllOf(HasSubstr("low.csv:3:8: "), HasSubstr("no terrain below"))));
}

}  // namespace
}  // namespace tubefoot
