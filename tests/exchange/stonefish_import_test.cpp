// SPDX-License-Identifier: GPL-3.0-or-later
// Tests Stonefish scenarios with animated and compound bodies, and numbers that the engine rounds.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <glm/geometric.hpp>

#include "exchange/readers/scene_readers.hpp"
#include "fixtures/test_folder.hpp"

namespace tubefoot {
namespace {

namespace fs = std::filesystem;
using testing::Contains;
using testing::HasSubstr;
using testing::Not;

const std::string fls =
    "<sensor name='FLS' type='fls'><specs beams='64' bins='200' horizontal_fov='80' vertical_fov='20'/>"
    "<settings range_min='0.5' range_max='10'/>"
    "<origin xyz='1 0 0' rpy='1.5707963267948966 0 1.5707963267948966'/></sensor>";

struct Scenarios : testing::Test {
  TestFolder folder;

  ImportedScene read(const std::string& inside) const {
    folder.write("w.scn", "<scenario>" + inside + "</scenario>");
    return read_world(folder / "w.scn", {});
  }
};

TEST_F(Scenarios, AnimatedBodiesAndTheirSonarsAreAtTheFirstKeyPoint) {
  const ImportedScene scene = read(R"(<animated name='fish' type='sphere'><dimensions radius='0.5'/>
    <origin xyz='0 0 0' rpy='0 0 0'/><material name='m'/><trajectory type='spline' playback='repeat'>
    <keypoint time='5' xyz='9 9 9' rpy='0 0 0'/><keypoint time='0.0' xyz='1 2 3' rpy='0 0 1.5707963267948966'/>
    <keypoint time='-1' xyz='8 8 8' rpy='0 0 0'/></trajectory>)" +
                                   fls + R"(</animated>
    <animated name='frame' type='empty'><trajectory type='pwl' playback='onetime'>
    <keypoint time='2' xyz='0 0 7' rpy='0 0 0'/></trajectory>)" +
                                   fls + "</animated>");
  ASSERT_EQ(scene.objects.size(), 1);
  // North 1, east 2, down 3; turned from north to east.
  EXPECT_EQ(scene.objects[0].placed.position_m, glm::dvec3(2, 1, -3));
  ASSERT_EQ(scene.sensors.size(), 2);
  EXPECT_LT(glm::length(scene.sensors[0].own.position_m - glm::dvec3(3, 1, -3)), 1e-12);
  EXPECT_LT(glm::length(scene.sensors[0].own.turn[1] - glm::dvec3(1, 0, 0)), 1e-12);
  EXPECT_LT(glm::length(scene.sensors[1].own.position_m - glm::dvec3(0, 1, -7)), 1e-12);
  EXPECT_THAT(scene.noticed,
              Contains(HasSubstr("'fish' moves along its <trajectory> in Stonefish: here it stays "
                                 "at its first key point, at 0 s")));
  EXPECT_THAT(scene.noticed, Contains(HasSubstr("'frame' moves along its <trajectory> in Stonefish: here it "
                                                "stays at its first key point, at 2 s")));
  EXPECT_THAT(scene.noticed, Not(Contains(HasSubstr("initial position"))));
}

TEST_F(Scenarios, AnimatedBodiesWithoutKeyPointsAreLeftOut) {
  const ImportedScene scene = read(
      "<static name='rock' type='sphere'><dimensions radius='1'/></static>"
      "<animated name='a' type='sphere'><dimensions radius='1'/>" +
      fls + "<trajectory type='manual'/></animated>");
  EXPECT_EQ(scene.objects.size(), 1);
  EXPECT_TRUE(scene.sensors.empty());
  EXPECT_THAT(scene.noticed, Contains(HasSubstr("'a' is left out with its sensors")));
}

TEST_F(Scenarios, OriginsMoveStaticBodiesOnly) {
  const auto body = [](const std::string& kind, const std::string& place) {
    return "<" + kind + " name='" + kind + "' type='box'><dimensions xyz='1 1 1'/>" +
           "<origin xyz='0 0 2' rpy='0 0 0'/><material name='m'/>" + place + "</" + kind + ">";
  };
  const ImportedScene scene =
      read(body("static", "<world_transform xyz='0 0 1' rpy='0 0 0'/>") +
           body("animated",
                "<trajectory type='manual'><keypoint time='0' xyz='0 0 1' rpy='0 0 0'/></trajectory>"));
  ASSERT_EQ(scene.objects.size(), 2);
  EXPECT_EQ(scene.objects[0].placed.position_m.z, -3);
  EXPECT_EQ(scene.objects[1].placed.position_m.z, -1);
  EXPECT_THAT(scene.noticed, Contains(HasSubstr("the <origin> of 'animated' is ignored")));
}

TEST_F(Scenarios, CompoundBodiesShowTheirOutside) {
  const ImportedScene scene = read(R"(<dynamic name='vehicle' type='compound'>
    <external_part name='hull' type='sphere'><dimensions radius='1'/><origin xyz='0 0 0' rpy='0 0 0'/>
    <material name='m'/><compound_transform xyz='1 0 0' rpy='0 0 0'/></external_part>
    <internal_part name='battery' type='box'><dimensions xyz='1 1 1'/><material name='m'/></internal_part>
    <internal_part name='lamp' type='box' always_visible='true'><dimensions xyz='1 1 1'/><material name='m'/>
    </internal_part><world_transform xyz='0 0 5' rpy='0 0 0'/></dynamic>)");
  ASSERT_EQ(scene.objects.size(), 2);
  EXPECT_EQ(scene.objects[0].name, "hull");
  EXPECT_EQ(scene.objects[0].placed.position_m, glm::dvec3(0, 1, -5));
  EXPECT_EQ(scene.objects[1].name, "lamp");
  EXPECT_THAT(scene.noticed, Contains(HasSubstr("1 x <internal_part>")));
}

TEST_F(Scenarios, SonarsOfManyBeamsBecomeSensors) {
  const ImportedScene scene = read(
      "<static name='rock' type='sphere'><dimensions radius='1'/></static><sensor name='f' type='fls'>"
      "<specs beams='512' bins='100' horizontal_fov='120' vertical_fov='20'/><settings range_min='1' "
      "range_max='10'/><world_transform xyz='0 0 5' rpy='0 0 0'/></sensor>");
  EXPECT_EQ(scene.sensors.size(), 1) << testing::PrintToString(scene.noticed);
}

TEST_F(Scenarios, OddNumbersAreRoundedUpAsInTheEngine) {
  const ImportedScene scene = read(
      "<static name='rock' type='sphere'><dimensions radius='1'/></static><sensor name='f' type='fls'>"
      "<specs beams='15' bins='99' horizontal_fov='60' vertical_fov='20'/><settings range_min='0' "
      "range_max='10'/><world_transform xyz='0 0 5' rpy='0 0 0'/></sensor>");
  ASSERT_EQ(scene.sensors.size(), 1);
  EXPECT_THAT(scene.sensors[0].keys, Contains(testing::Pair("samples", "100")));
  EXPECT_THAT(scene.sensors[0].keys, Contains(testing::Pair("range_min_m", "0.02")));
  EXPECT_THAT(scene.noticed, Contains(HasSubstr("has 16 beams")));
}

}  // namespace
}  // namespace tubefoot
