// SPDX-License-Identifier: GPL-3.0-or-later
// Tests the report of array elements at positions that receive nothing. The report has the element number,
// the ping, and a remedy.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "fixtures/world/read_scenes.hpp"
#include "run/sensor_places.hpp"

namespace tubefoot {
namespace {

using testing::AllOf;
using testing::HasSubstr;

class HiddenElements : public testing::Test {
 protected:
  HiddenElements()
      : loaded_scene_(load_scene(read_scene(folder_, R"([water]
sound_speed_m_s = 1500
[[materials]]
name = "sand"
[[terrain]]
name = "bed"
kind = "flat"
width_m = 40
length_m = 40
cell_m = 10
[[objects]]
name = "crate"
shape = "box"
size_m = [2, 2, 2]
position_m = [5, 5, 1]
[[objects]]
name = "outer"
shape = "sphere"
radius_m = 2
chord_error_m = 0.01
position_m = [-6, 0, 6]
[[objects]]
name = "inner"
shape = "sphere"
radius_m = 1
chord_error_m = 0.01
position_m = [-6, 0, 6]
[[objects]]
name = "roof"
shape = "mesh"
file = "roof.obj"
position_m = [6, -6, 3]
[trajectory]
kind = "fixed"
[[sensors]]
name = "camera"
kind = "didson"
)"))) {
    loaded_scene_.tree = std::make_unique<SceneTree>(loaded_scene_.scene.mesh);
  }
  /// Returns the message about the receivers. An empty string means that all positions are valid.
  std::string said(const std::vector<glm::dvec3>& receivers_m, glm::dvec3 transmitter_m = {0, 0, 9}) {
    SensorPlaces places(loaded_scene_);
    const SourcePlace place{"scene.toml", 7, 1};
    const std::string name = "tail";
    try {
      places.refuse_hidden({place, name, 3, 1.5, std::span(&transmitter_m, 1), receivers_m});
    } catch (const InputError& error) {
      return error.what();
    }
    return {};
  }

  TestFolder folder_;
  // A box without two of its sides: there are still facets above and below its inside.
  std::filesystem::path roof_ = folder_.write("roof.obj", R"(v -1 -1 0
v 1 -1 0
v 1 1 0
v -1 1 0
v -1 -1 1
v 1 -1 1
v 1 1 1
v -1 1 1
f 5 6 7 8
f 1 2 6 5
f 3 4 8 7
f 1 4 3 2
)");
  LoadedScene loaded_scene_;
};

TEST_F(HiddenElements, InTheWaterMayBeAnywhere) {
  EXPECT_EQ(said({{0, 0, 5}, {0, 0, 0.01}, {5, 5, 2.01}, {6.01, 5, 1}, {5, 3.99, 1}, {-6, 2.01, 6}}), "");
  EXPECT_EQ(said({{100, 0, -3}}), "");  // next to the seabed there is no facet above
}

TEST_F(HiddenElements, InABoxAreReportedWithTheirNumberAndPing) {
  EXPECT_THAT(said({{0, 0, 5}, {5, 5, 1}, {5.5, 5, 1}}),
              AllOf(HasSubstr("scene.toml:7"),
                    HasSubstr("receiver 1 of sensor 'tail' is inside the closed object 'crate' at ping 3"),
                    HasSubstr("t = 1.500 s, east 5.000, north 5.000, up 1.000 m"),
                    HasSubstr("move it out ('receivers_m', 'lever_arm_m', or the trajectory)")));
  EXPECT_THAT(said({{0, 0, 5}}, {5.9, 4.1, 1.9}),
              HasSubstr("the transmitter of sensor 'tail' is inside the closed object 'crate'"));
  // Over the edges and corners of facets.
  for (const glm::dvec3 at : {glm::dvec3(4.000001, 4.000001, 0.5), {5.999999, 5.5, 1}, {5, 5, 1.999}})
    EXPECT_THAT(said({at}), HasSubstr("receiver of sensor 'tail' is inside the closed object 'crate'"));
}

TEST_F(HiddenElements, OnAnObjectAreReportedApart) {
  EXPECT_THAT(said({{5, 4.3, 2}}), HasSubstr("lies exactly on a facet of 'crate' at ping 3"));
  EXPECT_THAT(said({{4, 4, 2}}), HasSubstr("lies exactly on a vertex of 'crate'"));
}

TEST_F(HiddenElements, BetweenTwoSpheresAreInTheOuterOne) {
  EXPECT_THAT(said({{-6, 1.5, 6}}), HasSubstr("is inside the closed object 'outer'"));
  EXPECT_THAT(said({{-6, 0, 6.2}}), HasSubstr("is inside the closed object"));
}

TEST_F(HiddenElements, BelowTheSeabedAreReportedHowFar) {
  EXPECT_THAT(said({{0, 0, 5}, {1, 2, -0.5}}),
              AllOf(HasSubstr("receiver 1 of sensor 'tail' is 0.5 m below the seabed ('bed') at ping 3"),
                    HasSubstr("raise its trajectory or lever arm")));
}

// The box is open at two sides: there are facets above and below, and a way out.
TEST_F(HiddenElements, InWhatIsOpenMayBe) { EXPECT_EQ(said({{6, -6, 3.5}, {6.3, -5.8, 3.7}}), ""); }

}  // namespace
}  // namespace tubefoot
