// SPDX-License-Identifier: GPL-3.0-or-later
// Tests [objects.materials], which maps the names of faces in a mesh file to materials of the scene:
// priority, reports and errors.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "fixtures/model_samples.hpp"
#include "fixtures/world/read_scenes.hpp"
#include "scene/scene.hpp"

namespace tubefoot {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::ThrowsMessage;

constexpr std::string_view scene = R"([[materials]]
name = "sand"
[[materials]]
name = "steel"
[[materials]]
name = "wood"
[[objects]]
name = "boat"
material = "sand"
shape = "mesh"
file = "boat.obj"
[objects.materials]
ENTRIES
[trajectory]
kind = "fixed"
position_m = [0, 0, 9]
[[sensors]]
name = "camera"
kind = "didson"
)";

constexpr std::string_view boat = R"(v 0 0 0
v 1 0 0
v 0 1 0
o boat
f 1 2 3
usemtl Paint (red)
f 1 2 3
g deck bow
f 1 2 3
usemtl Oak
f 1 2 3
o mast
g
f 1 2 3
)";

std::string with_entries(const std::string& entries) {
  std::string text(scene);
  return text.replace(text.find("ENTRIES"), 7, entries);
}

std::vector<std::uint16_t> materials(const std::string& entries) {
  const TestFolder folder;
  folder.write("boat.obj", boat);
  return load_scene(read_scene(folder, with_entries(entries))).mesh.material;
}

TEST(MeshMaterials, MaterialsOfObjFirstThenGroupsThenObjects) {
  EXPECT_THAT(materials("Oak = \"wood\""), ElementsAre(0, 0, 0, 2, 2));
  EXPECT_THAT(materials("\"Paint (red)\" = \"steel\"\nOak = \"wood\""), ElementsAre(0, 1, 1, 2, 2));
  EXPECT_THAT(materials("bow = \"steel\""), ElementsAre(0, 0, 1, 1, 0));
  EXPECT_THAT(materials("bow = \"steel\"\nOak = \"wood\""), ElementsAre(0, 0, 1, 2, 2));
  EXPECT_THAT(materials("boat = \"steel\"\nmast = \"wood\""), ElementsAre(1, 1, 1, 1, 2));
}

TEST(MeshMaterials, TheReportListsNamesWithTheirFacets) {
  const TestFolder folder;
  folder.write("boat.obj", boat);
  const Scene loaded = load_scene(read_scene(folder, with_entries("Oak = \"wood\"")));
  const auto& names = loaded.report.components[0].names;
  ASSERT_EQ(names.size(), 3u);
  EXPECT_EQ(names[0].name, "boat");
  EXPECT_EQ(names[0].material, "sand");
  EXPECT_EQ(names[1].name, "Paint (red)");
  EXPECT_EQ(names[1].facets, 2u);
  EXPECT_EQ(names[2].name, "Oak");
  EXPECT_EQ(names[2].material, "wood");
  EXPECT_EQ(names[2].facets, 2u);
}

TEST(MeshMaterials, MistakesAreReportedWhereTheyStand) {
  const TestFolder folder;
  folder.write("boat.obj", boat);
  EXPECT_THAT([&] { load_scene(read_scene(folder, with_entries("Oka = \"wood\""))); },
              ThrowsMessage<InputError>(AllOf(HasSubstr("scene.toml:13:7: "),
                                              HasSubstr("no face of the mesh has the name \"Oka\""),
                                              HasSubstr("\"Oak\""))));
  EXPECT_THAT(scene_error(folder, with_entries("Oak = \"wodo\"")),
              AllOf(HasSubstr("scene.toml:13:7: "), HasSubstr("did you mean \"wood\"?")));
}

TEST(MeshMaterials, NodesAndMaterialsOfModelsCount) {
  const TestFolder folder;
  folder.write("boat.glb", glb_model());
  std::string text = with_entries("child = \"wood\"");
  text.replace(text.find("boat.obj"), 8, "boat.glb");
  EXPECT_THAT(load_scene(read_scene(folder, text)).mesh.material, ElementsAre(0, 0, 2, 2));
  text.replace(text.find("child = \"wood\""), 14, "child = \"wood\"\nsteel = \"steel\"");
  EXPECT_THAT(load_scene(read_scene(folder, text)).mesh.material, ElementsAre(1, 1, 1, 1));
}

}  // namespace
}  // namespace tubefoot
