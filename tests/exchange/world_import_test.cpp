// SPDX-License-Identifier: GPL-3.0-or-later
// Tests worlds of other engines: nested poses, shapes, frames by name, and sonars. The import reports
// omitted elements, and malicious content does no harm.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <random>

#include "exchange/readers/scene_readers.hpp"
#include "files/input_error.hpp"
#include "fixtures/program.hpp"
#include "fixtures/test_folder.hpp"
#include "scene/meshes/mesh_file.hpp"

namespace tubefoot {
namespace {

namespace fs = std::filesystem;
using testing::Contains;
using testing::HasSubstr;

constexpr std::string_view triangle = "v 0 0 0\nv 1 0 0\nv 0 2 0\nf 1 2 3\n";

struct Worlds : testing::Test {
  TestFolder folder;
  Worlds() { folder.write("triangle.obj", triangle); }

  ImportedScene sdf(const std::string& inside, const std::vector<fs::path>& models = {}) const {
    folder.write("w.sdf", "<?xml version='1.0'?>\n<sdf version='1.9'><world name='w'>\n" + inside +
                              "\n</world></sdf>\n");
    return read_world(folder / "w.sdf", models);
  }
  ImportedScene scn(const std::string& inside) const {
    folder.write("w.scn", "<scenario>" + inside + "</scenario>");
    return read_world(folder / "w.scn", {});
  }
  std::string refusal(const std::string& text) const {
    folder.write("bad.sdf", text);
    try {
      read_world(folder / "bad.sdf", {});
    } catch (const InputError& error) {
      return error.what();
    }
    return "read";
  }
};

std::string model(const std::string& visual, const std::string& pose = "", const std::string& name = "m") {
  return "<model name='" + name + "'>" + pose + "<link name='l'><visual name='v'>" + visual +
         "</visual></link></model>";
}
const std::string box = "<geometry><box><size>1 2 3</size></box></geometry>";
const std::string mesh = "<geometry><mesh><uri>triangle.obj</uri></mesh></geometry>";

/// Converts a point of an object to the scene frame.
glm::dvec3 at(const ImportedObject& object, glm::dvec3 p) {
  return object.placed.position_m + object.placed.turn * p;
}

TEST_F(Worlds, PutPosesIntoPoses) {
  // A model at (10, 0, 0) is turned by 90 degrees. It contains a model at (1, 0, 0), a link at (0, 1, 0),
  // and a visual at (0, 0, 1).
  const ImportedScene scene = sdf(R"(<model name='outer'><pose degrees='true'>10 0 0 0 0 90</pose>
    <model name='inner'><pose>1 0 0 0 0 0</pose><link name='l'><pose>0 1 0 0 0 0</pose>
    <visual name='v'><pose rotation_format='quat_xyzw'>0 0 1 0 0 0.7071067811865476 0.7071067811865476</pose>)" +
                                  box + "</visual></link></model></model>");
  ASSERT_EQ(scene.objects.size(), 1);
  EXPECT_EQ(scene.objects[0].name, "outer::inner::l::v");
  EXPECT_LT(glm::length(scene.objects[0].placed.position_m - glm::dvec3(9, 1, 1)), 1e-14);
  // 90 and 90 degrees: its x axis points to -x.
  EXPECT_LT(glm::length(at(scene.objects[0], {1, 0, 0}) - glm::dvec3(8, 1, 1)), 1e-14);
  EXPECT_THAT(scene.objects[0].keys, Contains(std::pair<std::string, std::string>("size_m", "[1, 2, 3]")));
}

TEST_F(Worlds, FindFramesByName) {
  const ImportedScene scene =
      sdf("<frame name='f'><pose>0 0 5 0 0 0</pose></frame>" +
          model(box, "<pose relative_to='f'>1 0 0 0 0 0</pose>", "a") +
          model(box, "<pose relative_to='a'>0 1 0 0 0 0</pose>", "b") +
          model(box, "<pose relative_to='nowhere'>0 1 0 0 0 0</pose>", "c") +
          model(box, "<pose relative_to='e'/>", "d") + model(box, "<pose relative_to='d'/>", "e"));
  ASSERT_EQ(scene.objects.size(), 2);
  EXPECT_EQ(scene.objects[1].placed.position_m, glm::dvec3(1, 1, 5));
  EXPECT_THAT(scene.noticed, Contains(HasSubstr("relative to 'nowhere'")));
  EXPECT_THAT(scene.noticed, Contains(HasSubstr("'d' is left out")));  // they depend on each other
}

TEST_F(Worlds, ReadShapesAndTellWhatTheyDoNot) {
  const ImportedScene scene =
      sdf(model("<geometry><sphere><radius>2</radius></sphere></geometry>", "", "s") +
          model("<geometry><cylinder><radius>1</radius><length>4</length></cylinder></geometry>", "", "c") +
          model("<geometry><plane><normal>1 0 0</normal><size>4 6</size></plane></geometry>",
                "<pose>0 0 7 0 0 0</pose>", "p") +
          model("<geometry><mesh><uri>file://triangle.obj</uri><scale>-1 2 1</scale></mesh></geometry>", "",
                "m") +
          model("<geometry><heightmap><uri>h.png</uri></heightmap></geometry>", "", "heightmap") +
          model("<geometry><mesh><uri>triangle.obj</uri><submesh><name>x</name></submesh></mesh></geometry>",
                "", "sub") +
          "<include><uri>model://boat</uri></include><light name='x'/><physics/>");
  ASSERT_EQ(scene.objects.size(), 4);
  EXPECT_EQ(scene.objects[1].shape, "cylinder");
  // A wall that faces east, about z = 7.
  const ImportedObject& wall = scene.objects[2];
  EXPECT_LT(glm::length(wall.placed.turn * glm::dvec3(0, 0, 1) - glm::dvec3(1, 0, 0)), 1e-14);
  EXPECT_EQ(wall.placed.position_m.z, 7);
  // A mirrored mesh faces in the mirrored direction.
  const ComponentMesh& mirrored = scene.meshes[*scene.objects[3].mesh].mesh;
  EXPECT_EQ(mirrored.points_m[1], glm::dvec3(-1, 0, 0));
  EXPECT_EQ(mirrored.triangles[0], (std::array<std::uint32_t, 3>{0, 2, 1}));
  EXPECT_EQ(scene.objects[3].scale, (std::array<double, 3>{1, 2, 1}));
  for (const char* told : {"<heightmap>", "no part of the mesh has the name 'x'",
                           "<include> of 'model://boat'", "1 x <light>, 1 x <physics>", "lambert_db = -27"})
    EXPECT_THAT(scene.noticed, Contains(HasSubstr(told)));
}

TEST_F(Worlds, FindModelsInTheFoldersOfTheModelPath) {
  fs::create_directories(folder / "models/buoy/meshes");
  folder.write("models/buoy/meshes/b.obj", triangle);
  const std::string buoy = model("<geometry><mesh><uri>model://buoy/meshes/b.obj</uri></mesh></geometry>");
  EXPECT_EQ(sdf(buoy, {folder / "models"}).objects.size(), 1);
  const ImportedScene without = sdf(buoy + model(box));
  EXPECT_EQ(without.objects.size(), 1);
  EXPECT_THAT(without.noticed, Contains(HasSubstr("--model-path")));
}

TEST_F(Worlds, ReadNothingOutsideOfTheirFolder) {
  TestFolder elsewhere;
  elsewhere.write("secret.obj", triangle);
  fs::create_symlink(elsewhere / "secret.obj", folder / "link.obj");
  const std::string up = fs::relative(elsewhere / "secret.obj", folder.path()).string();
  for (const std::string& uri :
       {up, (elsewhere / "secret.obj").string(), "file://" + (elsewhere / "secret.obj").string(),
        std::string("link.obj"), "model://../" + up, std::string("http://x/y.obj"), std::string()}) {
    const ImportedScene scene =
        sdf(model("<geometry><mesh><uri>" + uri + "</uri></mesh></geometry>") + model(box), {folder.path()});
    EXPECT_EQ(scene.objects.size(), 1) << uri;
    EXPECT_TRUE(scene.meshes.empty()) << uri;
  }
  EXPECT_EQ(
      sdf(model("<geometry><mesh><uri>link.obj</uri></mesh></geometry>"), {elsewhere.path()}).objects.size(),
      1);
}

TEST_F(Worlds, ReadSonarsInTheEnginesWords) {
  const ImportedScene scene = sdf(model(box) + R"(<model name='v'><pose>0 0 5 0 0 0</pose><link name='l'>
    <sensor name='fan' type='custom' gz:type='multibeam_sonar'><pose>1 0 0 0 0 0</pose><gz:multibeam_sonar>
    <ray degrees='true'><scan><horizontal><beams>64</beams><min_angle>-20</min_angle><max_angle>60</max_angle></horizontal>
    <vertical><rays>30</rays><min_angle>-20</min_angle><max_angle>0</max_angle></vertical></scan>
    <range><min>0.5</min><max>15.5</max></range></ray><spec><sonarFreq>900e3</sonarFreq><bandwidth>5e3</bandwidth>
    <soundSpeed>1500</soundSpeed></spec></gz:multibeam_sonar></sensor>
    <sensor name='old' type='depth'><camera><horizontal_fov>1.5707963267948966</horizontal_fov><image><width>512</width></image>
    <clip><near>1</near><far>11</far></clip></camera><plugin filename='libnps_multibeam_sonar_ros_plugin.so' name='p'>
    <verticalFOV>10</verticalFOV></plugin></sensor>
    <sensor name='flat' type='gpu_lidar'><lidar><scan><horizontal><samples>9</samples><min_angle>-1</min_angle>
    <max_angle>1</max_angle></horizontal></scan><range><min>1</min><max>9</max></range></lidar></sensor>
    <sensor name='imu' type='imu'/></link></model>)");
  ASSERT_EQ(scene.sensors.size(), 2);
  const auto key = [&](std::size_t sensor, const std::string& name) {
    for (const auto& [k, value] : scene.sensors[sensor].keys)
      if (k == name) return value;
    return std::string();
  };
  // The plugin makes the number of beams odd, and the outermost beams lie at the stated azimuths.
  EXPECT_EQ(key(0, "beams"), "65");
  EXPECT_EQ(std::stod(key(0, "horizontal_deg")), 81.25);
  // Cones of 20 degrees about elevations of 0 to -20 degrees fill 30 degrees on either side of the axis.
  EXPECT_NEAR(std::stod(key(0, "vertical_deg")), 60, 1e-12);
  EXPECT_EQ(key(0, "samples"), "100");  // 15 m at 1500 / (2 x 5000) m
  EXPECT_EQ(key(0, "frequency_khz"), "900");
  // Its middle is 20 degrees to port of east. Angles about z grow to port.
  const double port = 20 * std::numbers::pi / 180;
  const glm::dvec3 ahead = scene.sensors[0].own.turn * glm::dvec3(0, 1, 0);
  EXPECT_LT(glm::length(ahead - glm::dvec3(std::cos(port), std::sin(port), 0)), 1e-14);
  EXPECT_EQ(scene.sensors[0].own.position_m, glm::dvec3(1, 0, 5));
  EXPECT_EQ(key(1, "spacing"), "\"distance\"");
  EXPECT_EQ(std::stod(key(1, "horizontal_deg")), 90);
  EXPECT_THAT(scene.noticed, Contains(HasSubstr("'flat' is left out")));
  EXPECT_THAT(scene.noticed, Contains(HasSubstr("'imu' is left out")));
}

TEST_F(Worlds, LeaveOutBodiesWithoutSizeAndSaySo) {
  const auto& scene =
      scn(R"(<static name='dot' type='sphere'><dimensions radius='-1'/><material name='Mud'/></static>
    <static name='sheet' type='box'><dimensions xyz='1 0 2'/><material name='Mud'/></static>
    <static name='ball' type='sphere'><dimensions radius='0.5'/><material name='Mud'/></static>)");
  ASSERT_EQ(scene.objects.size(), 1u);
  EXPECT_EQ(scene.objects[0].name, "ball");
  EXPECT_THAT(scene.noticed, Contains(HasSubstr("'dot' is left out: all of its lengths must be above 0")));
  EXPECT_THAT(scene.noticed, Contains(HasSubstr("'sheet' is left out: all of its lengths must be above 0")));
}

TEST_F(Worlds, ReadStonefishDown) {
  const ImportedScene scene =
      scn(R"(<static name='rock' type='model'><physical><mesh filename='triangle.obj' scale='2'/>
    <origin xyz='0 0 0' rpy='0 0 0'/></physical><material name='Rock'/><world_transform xyz='3 4 5' rpy='0 0 0'/></static>
    <static name='bottom' type='plane'><material name='Mud'/><world_transform xyz='0 0 9' rpy='0 0 0'/></static>
    <dynamic name='ball' type='sphere'><dimensions radius='0.5'/><material name='Rock'/><world_transform xyz='1 0 2' rpy='0 0 0'/></dynamic>
    <robot name='r'><base_link name='Base' type='sphere'/><sensor name='FLS' type='fls'><specs beams='64' bins='200'
    horizontal_fov='80' vertical_fov='20'/><settings range_min='0.5' range_max='10'/>
    <origin xyz='0 0 0' rpy='1.5707963267948966 0 1.5707963267948966'/><link name='Base'/></sensor>
    <sensor name='imu' type='imu'/><world_transform xyz='0 0 1' rpy='0 0 0'/></robot>)");
  ASSERT_EQ(scene.objects.size(), 3);
  // (north 3, east 4, down 5), and x of the mesh is north.
  EXPECT_EQ(scene.objects[0].placed.position_m, glm::dvec3(4, 3, -5));
  EXPECT_LT(glm::length(at(scene.objects[0], {2, 0, 0}) - glm::dvec3(4, 5, -5)), 1e-14);
  EXPECT_EQ(scene.objects[0].scale, (std::array<double, 3>{2, 2, 2}));
  EXPECT_EQ(scene.objects[1].placed.position_m.z, -9);
  ASSERT_EQ(scene.sensors.size(), 1);
  // The usual mounting: it looks ahead, which is north, upright.
  EXPECT_LT(glm::length(scene.sensors[0].own.turn * glm::dvec3(0, 1, 0) - glm::dvec3(0, 1, 0)), 1e-14);
  EXPECT_LT(glm::length(scene.sensors[0].own.turn * glm::dvec3(0, 0, 1) - glm::dvec3(0, 0, 1)), 1e-14);
  EXPECT_EQ(scene.sensors[0].own.position_m, glm::dvec3(0, 0, -1));
  // Four views of 20 degrees with 16 beams each: the tangent of the first axis is 15 sixteenths of that of
  // the edge.
  const double ten = 10 * std::numbers::pi / 180;
  const std::string first =
      fmt::format("[{}, ", -30 + std::atan(std::tan(ten) * -15 / 16) * 180 / std::numbers::pi);
  EXPECT_THAT(scene.sensors[0].keys,
              Contains(testing::Pair("beam_angles_deg", testing::StartsWith(first.substr(0, 12)))));
  for (const char* told : {"its beams are equidistant in each of 4 views", "'imu' is left out",
                           "its body is left out", "it is 10000 m wide", "material 'Mud'"})
    EXPECT_THAT(scene.noticed, Contains(HasSubstr(told)));
}

TEST_F(Worlds, SayWhereTheyAreWrong) {
  const auto world = [](const std::string& inside) {
    return "<sdf version='1.9'>\n<world name='w'>\n" + inside + "</world></sdf>";
  };
  EXPECT_THAT(refusal(""), HasSubstr("bad.sdf"));
  EXPECT_THAT(refusal("no xml"), HasSubstr("XML"));
  EXPECT_THAT(refusal("<urdf/>"), HasSubstr("begins with <urdf>"));
  EXPECT_THAT(refusal(world("")), HasSubstr("no geometry"));
  EXPECT_THAT(refusal(world(model(box, "<pose>1 2 x 0 0 0</pose>"))),
              HasSubstr("bad.sdf:3:17: <pose> is '1 2 x 0 0 0': 'x' is not a number"));
  for (const char* pose :
       {"1 2 3", "1 2 3 4 5 6 7", "1e300 0 0 0 0 0", "nan 0 0 0 0 0", "inf 0 0 0 0 0", "1e999 0 0 0 0 0"})
    EXPECT_THAT(refusal(world(model(box, std::string("<pose>") + pose + "</pose>"))),
                HasSubstr("bad.sdf:3:17: <pose>"))
        << pose;
  EXPECT_THAT(refusal(world(model("<geometry><sphere><radius>0</radius></sphere></geometry>"))),
              HasSubstr("above 0"));
  EXPECT_THAT(refusal("<!DOCTYPE x [<!ENTITY a 'aaaa'><!ENTITY b '&a;&a;'>]>" + world(model(box))),
              HasSubstr("document type"));
  std::string nested;
  for (int k = 0; k < 100'000; ++k) nested += "<model name='m'>";
  EXPECT_THAT(refusal("<sdf><world>" + nested), HasSubstr("XML"));
  for (int k = 0; k < 100'000; ++k) nested += "</model>";
  EXPECT_THAT(refusal("<sdf><world>" + nested + "</world></sdf>"), HasSubstr("nested deeper"));
}

TEST_F(Worlds, ThatAreCutOffAnywhereAreRefusedOrWhole) {
  const std::string whole =
      "<sdf version='1.9'><world name='w'>" + model(mesh, "<pose>1 2 3 0 0 0</pose>") + "</world></sdf>";
  for (std::size_t length = 0; length < whole.size(); ++length)
    EXPECT_NE(refusal(whole.substr(0, length)), "read") << whole.substr(0, length);
  EXPECT_EQ(refusal(whole), "read");
}

TEST_F(Worlds, ThatAreDamagedAreRefusedOrRead) {
  const std::string sonar =
      "<model name='v'><link name='l'><sensor name='s'><tubefoot:sonar pose='0 0 0 0 0 0' name='s' "
      "kind='imaging' beams='8' samples='16'/></sensor></link></model>";
  const std::string whole[] = {
      "<sdf version='1.9'><world name='w'>" + model(mesh, "<pose relative_to='f'>1 2 3 0 0 0</pose>") +
          "<frame name='f'><pose>1 2 3 0 0 0</pose></frame>" + model(box) + sonar + "</world></sdf>",
      "<scenario><static name='rock' type='model'><physical><mesh filename='triangle.obj' "
      "scale='2'/></physical>"
      "<world_transform xyz='3 4 5' rpy='0 1 0'/></static><sensor name='f' type='fls'><specs beams='64' "
      "bins='200' "
      "horizontal_fov='80' vertical_fov='20'/><settings range_min='0.5' "
      "range_max='10'/></sensor></scenario>"};
  std::mt19937 random(5);
  const auto below = [&](std::size_t end) { return random() % end; };
  std::size_t read = 0;
  for (int k = 0; k < 3000; ++k) {
    std::string text = whole[k % 2];
    for (std::size_t damage = 1 + below(3); damage > 0; --damage) {
      const std::size_t at = below(text.size());
      switch (below(4)) {
        case 0:
          text[at] = static_cast<char>(below(256));
          break;
        case 1:
          text.erase(at, 1 + below(8));
          break;
        case 2:
          text.insert(at, text.substr(below(text.size()), 1 + below(40)));
          break;
        default:
          text.insert(at, std::array{"9e99", "-1", "&#0;", "&lt;", "'", "<", "model", "\xff"}[below(8)]);
      }
    }
    folder.write("damaged.sdf", text);
    try {
      const ImportedScene scene = read_world(folder / "damaged.sdf", {});
      EXPECT_FALSE(scene.objects.empty());
      scene_text(scene);
      ++read;
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), HasSubstr("damaged.sdf"));
    }
  }
  EXPECT_GT(read, 100);
}

TEST_F(Worlds, KeysOfOursAreNumbersAndWords) {
  const auto sonar = [&](const std::string& attributes) {
    return model(box) +
           "<model name='v'><link name='l'><sensor name='s'><tubefoot:sonar pose='0 0 0 0 0 0' " +
           attributes + "/></sensor></link></model>";
  };
  EXPECT_EQ(sdf(sonar("name='a &quot;b&quot;\n' kind='imaging' beams='8' samples='16'")).sensors.at(0).name,
            "a__b__");
  EXPECT_THROW(sdf(sonar("kind='imaging' beams='8\n[[objects]]'")), InputError);
  EXPECT_THROW(sdf(sonar("kind='imaging&quot;'")), InputError);
  EXPECT_THROW(sdf(sonar("kind='imaging' BEAMS='8'")), InputError);
  for (const char* wrong : {"kind='imaging' beams='1e9'", "kind='nothing'", "kind='imaging' colour='red'",
                            "kind='imaging' trajectory='other'"}) {
    const ImportedScene scene = sdf(sonar(std::string("name='s' ") + wrong));
    EXPECT_TRUE(scene.sensors.empty()) << wrong;
    EXPECT_THAT(scene.noticed, Contains(HasSubstr("sonar 's' is left out"))) << wrong;
  }
}

TEST_F(Worlds, BecomeScenesThatRun) {
  folder.write("w.sdf", "<sdf version='1.9'><world name='w'>" +
                            model(mesh, "<pose>0 5 0 0 0 0</pose>", "a \"b\" \\") +
                            model(box, "<pose>0 8 0 0 0 0</pose>") + "</world></sdf>");
  const Outcome made = run_program({"import-scene", "--model-path", folder.path().string(),
                                    (folder / "w.sdf").string(), "-o", (folder / "out").string()});
  EXPECT_EQ(made.exit_code, 0) << made.err;
  EXPECT_THAT(made.err, HasSubstr("no sonar was found"));
  EXPECT_EQ(read_mesh_file(folder / "out/triangle.obj").triangles.size(), 1);
  const Outcome checked = run_program({"check", (folder / "out/scene.toml").string()});
  EXPECT_EQ(checked.exit_code, 0) << checked.err;
  // The command never overwrites its input.
  EXPECT_EQ(
      run_program({"import-scene", (folder / "w.sdf").string(), "-o", folder.path().string()}).exit_code, 2);
}

}  // namespace
}  // namespace tubefoot
