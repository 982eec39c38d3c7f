// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/idle_relief.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "scene/description/scene_component.hpp"
#include "sensors/kinds/kind_didson.hpp"

namespace tubefoot {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

/// A quadrangle of two facets.
std::shared_ptr<ComponentMesh> sheet(glm::dvec3 corner, glm::dvec3 along, glm::dvec3 up) {
  auto mesh = std::make_shared<ComponentMesh>();
  mesh->points_m = {corner, corner + along, corner + along + up, corner + up};
  mesh->triangles = {{0, 1, 2}, {0, 2, 3}};
  return mesh;
}

/// One object of rough rock before a sonar.
SceneDescription rock(std::shared_ptr<const ComponentMesh> facets, const std::string& displace) {
  SceneDescription d;
  d.file = "scene.toml";
  d.materials.resize(1);
  d.materials[0].name = "rock";
  ReliefDescription relief;
  relief.tile_m = 4;
  relief.resolution_m = 0.25;
  FractalReliefDescription fractal;
  fractal.hurst = 0.7;
  fractal.rms_height_m = 0.05;
  relief.kind = fractal;
  d.materials[0].relief.push_back(relief);
  d.refinement.displace = displace;
  d.objects.resize(1);
  d.objects[0].name = "wall";
  d.objects[0].material = "rock";
  d.objects[0].facets = std::move(facets);
  d.trajectories.resize(1);
  d.trajectories[0].kind = FixedTrajectory{};
  d.sensors.resize(1);
  d.sensors[0].name = "camera";
  d.sensors[0].kind = DidsonDescription();
  return d;
}

std::vector<std::string> warnings_of(const SceneDescription& d) { return load_scene(d).report.warnings; }

const glm::dvec3 before(-2, 10, -2), east(4, 0, 0), north(0, 4, 0), up(0, 0, 4);

TEST(IdleRelief, IsWarnedOfOnAWallThatIsDisplacedAlongItself) {
  EXPECT_THAT(warnings_of(rock(sheet(before, east, up), "vertical")),
              ElementsAre(AllOf(HasSubstr("'wall'"), HasSubstr("on 100 % of its area"),
                                HasSubstr("displace = \"normal\""))));
  EXPECT_THAT(warnings_of(rock(sheet(before, east, up), "normal")), IsEmpty());
  EXPECT_THAT(warnings_of(rock(sheet(before, east, north), "vertical")), IsEmpty());
}

TEST(IdleRelief, CountsWallsThatLeanLittle) {
  EXPECT_THAT(warnings_of(rock(sheet(before, east, up + glm::dvec3(0, 0.1, 0)), "vertical")),
              ElementsAre(HasSubstr("'wall'")));
  EXPECT_THAT(warnings_of(rock(sheet(before, east, up + glm::dvec3(0, 1, 0)), "vertical")), IsEmpty());
}

TEST(IdleRelief, IsWarnedOfOnTheSidesOfABox) {
  SceneDescription d = rock(nullptr, "vertical");
  d.objects[0].kind = BoxPrimitive{{1, 1, 1}};
  d.objects[0].position_m = {0, 10, 0};
  EXPECT_THAT(warnings_of(d), ElementsAre(HasSubstr("on 66.7 % of its area")));
  d.refinement.displace = "normal";
  EXPECT_THAT(warnings_of(d), IsEmpty());
  d.refinement.displace = "vertical";
  d.refinement.mode = "off";
  EXPECT_THAT(warnings_of(d), IsEmpty());
}

// The normals of both sides cancel: "normal" falls back to the vertical, which lies in the plane of the
// facets.
TEST(IdleRelief, IsWarnedOfOnASheetOfTwoSides) {
  auto both = sheet(before, east, up);
  both->triangles.push_back({0, 2, 1});
  both->triangles.push_back({0, 3, 2});
  EXPECT_THAT(warnings_of(rock(both, "normal")),
              testing::Contains(AllOf(HasSubstr("'wall': on "), HasSubstr("cancel"))));
}

}  // namespace
}  // namespace tubefoot
