// SPDX-License-Identifier: GPL-3.0-or-later
// Tests the sonars and shapes of SDF worlds against closed forms: the fans that the plugins compute, prisms,
// capsules and parts of meshes. Sonars on facets and inside objects are reported.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

#include "exchange/readers/scene_readers.hpp"
#include "files/input_error.hpp"
#include "fixtures/program.hpp"
#include "fixtures/test_folder.hpp"
#include "scene/meshes/mesh_file.hpp"

namespace tubefoot {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::Not;

struct Sonars : testing::Test {
  TestFolder folder;

  ImportedScene sdf(const std::string& inside, std::optional<double> unit_m = {}) const {
    folder.write("w.sdf", "<sdf version='1.9'><world name='w'>" + inside + "</world></sdf>");
    return read_world(folder / "w.sdf", {}, unit_m);
  }
  static std::string body(const std::string& geometry, const std::string& pose = "0 0 0 0 0 0") {
    return "<model name='m'><pose>" + pose + "</pose><link name='l'><visual name='v'><geometry>" + geometry +
           "</geometry></visual></link></model>";
  }
  ImportedScene sensor(const std::string& text) const {
    return sdf(body("<box/>") + "<model name='s'><link name='l'>" + text + "</link></model>");
  }
  static double key(const ImportedSensor& sensor, const std::string& name) {
    for (const auto& [k, value] : sensor.keys)
      if (k == name) return std::stod(value);
    return std::nan("");
  }
};

constexpr double to_rad = std::numbers::pi / 180;

std::string scan(double low, double high, double below, double above, const std::string& counts) {
  return fmt::format(
      "<scan><horizontal>{0}<min_angle>{1}</min_angle><max_angle>{2}</max_angle></horizontal>"
      "<vertical>{0}<min_angle>{3}</min_angle><max_angle>{4}</max_angle></vertical></scan>"
      "<range><min>0.1</min><max>20</max></range>",
      counts, low, high, below, above);
}

// Each ray of the plugin is a cone with the whole vertical angle: the height doubles, less one step.
TEST_F(Sonars, OfGazeboAreAboutTwiceAsHighAsStated) {
  for (const double half_deg : {6.0, 20.0}) {
    const double rad = half_deg * to_rad;
    const ImportedScene scene = sensor(
        "<sensor name='s' type='custom' gz:type='multibeam_sonar'><gz:multibeam_sonar><ray>" +
        scan(-1, 1, -rad, rad, "<beams>8</beams><rays>300</rays>") +
        "</ray><spec><verticalFOV>12</verticalFOV><maxDistance>10</maxDistance><bandwidth>30e3</bandwidth>"
        "<soundSpeed>1480</soundSpeed></spec></gz:multibeam_sonar></sensor>");
    ASSERT_EQ(scene.sensors.size(), 1);
    EXPECT_NEAR(key(scene.sensors[0], "vertical_deg"), 4 * half_deg, 1e-9);
    EXPECT_EQ(key(scene.sensors[0], "beams"), 9);
    // The axes of the outermost beams lie at the stated azimuths.
    EXPECT_NEAR(key(scene.sensors[0], "horizontal_deg") * 8 / 9, 2 / to_rad, 1e-9);
    EXPECT_EQ(key(scene.sensors[0], "range_max_m"), 10);
    EXPECT_EQ(scene.sound_speed_m_s, 1480);
    EXPECT_THAT(scene.noticed, Contains(HasSubstr(fmt::format("states a height of {} degrees, but its plugin "
                                                              "computes {} degrees",
                                                              2 * half_deg, 4 * half_deg))));
  }
}

// The kernel uses all rows of the image: their number, not <verticalFOV>, determines the height.
TEST_F(Sonars, OfRastersAreAsHighAsTheirImages) {
  const auto raster = [&](const std::string& plugin, double width, double height) {
    return sensor(fmt::format(
        "<sensor name='s' type='depth'><camera><horizontal_fov>1.57079632679</horizontal_fov><image><width>{}"
        "</width><height>{}</height></image><clip><near>0.2</near><far>60</far></clip></camera><plugin "
        "filename='{}' name='p'><verticalFOV>20</verticalFOV><sonarFreq>900e3</sonarFreq><bandwidth>29.9e3"
        "</bandwidth><sourceLevel>220</sourceLevel><imageTopicName>x</imageTopicName></plugin></sensor>",
        width, height, plugin));
  };
  for (const double height : {114.0, 228.0}) {
    const ImportedScene scene = raster("libnps_multibeam_sonar_ros_plugin.so", 512, height);
    ASSERT_EQ(scene.sensors.size(), 1);
    EXPECT_NEAR(key(scene.sensors[0], "vertical_deg"), 2 * std::atan(height / 512) / to_rad, 1e-8);
    EXPECT_NEAR(key(scene.sensors[0], "horizontal_deg"), 90, 1e-8);
    EXPECT_EQ(key(scene.sensors[0], "range_max_m"), 60);
    EXPECT_THAT(scene.noticed, Contains("left out: 1 x <sourceLevel>"));
    EXPECT_THAT(scene.noticed, Contains(HasSubstr("1 x <imageTopicName>")));
  }
  // The image sonar of uuv_simulator draws 400 rows up to 17 m.
  const ImportedScene scene = raster("libuuv_gazebo_ros_image_sonar.so", 256, 128);
  ASSERT_EQ(scene.sensors.size(), 1);
  EXPECT_EQ(key(scene.sensors[0], "range_max_m"), 17);
  EXPECT_EQ(key(scene.sensors[0], "samples"), std::round(400 * 16.8 / 17));
}

TEST_F(Sonars, OfRaysAreAsHighAsTheirRays) {
  const std::string ray = "<ray>" + scan(-0.5, 0.5, -0.349066, 0.349066, "<samples>101</samples>") + "</ray>";
  const ImportedScene scene = sensor(
      "<sensor name='s' type='gpu_ray'>" + ray +
      "<plugin filename='libnps_multibeam_sonar_ray_ros_plugin.so' name='p'><verticalFOV>20</verticalFOV>"
      "<maxDistance>12</maxDistance></plugin></sensor><sensor name='l' type='gpu_lidar'>" +
      ray + "</sensor>");
  ASSERT_EQ(scene.sensors.size(), 2);
  for (const ImportedSensor& sensor : scene.sensors) {
    EXPECT_NEAR(key(sensor, "vertical_deg"), 2 * 0.349066 / to_rad, 1e-9);
    EXPECT_NEAR(key(sensor, "horizontal_deg"), 1.01 / to_rad, 1e-9);
  }
  EXPECT_EQ(key(scene.sensors[0], "range_max_m"), 12);
  EXPECT_EQ(key(scene.sensors[1], "range_max_m"), 20);
  EXPECT_THAT(scene.noticed,
              Contains(HasSubstr("states a height of 20 degrees, but its plugin computes 40")));
  EXPECT_THAT(scene.noticed, Contains(HasSubstr("'l' is a lidar")));
}

double volume_of(const ComponentMesh& mesh) {
  double six = 0;
  for (const auto& [a, b, c] : mesh.triangles)
    six += glm::dot(mesh.points_m[a], glm::cross(mesh.points_m[b], mesh.points_m[c]));
  return six / 6;
}

TEST_F(Sonars, SeePrismsAndCapsules) {
  // An L of area 3, once in each direction of rotation. The facets face outwards.
  const std::vector<std::string> corners{"0 0", "2 0", "2 1", "1 1", "1 2", "0 2"};
  std::string there, back;
  for (const std::string& corner : corners) {
    there += "<point>" + corner + "</point>";
    back = "<point>" + corner + "</point>" + back;
  }
  for (const std::string& points : {there, back, there + "<point>0 0</point>"}) {
    const ImportedScene scene = sdf(body("<polyline>" + points + "<height>5</height></polyline>"));
    ASSERT_EQ(scene.meshes.size(), 1);
    EXPECT_NEAR(volume_of(scene.meshes[0].mesh), 15, 1e-12);
  }
  for (const char* wrong : {"<point>0 0</point><point>1 1</point>",
                            "<point>0 0</point><point>1 1</point><point>1 0</point><point>0 1</point>"})
    EXPECT_THAT(sdf(body("<box/>") + body(std::string("<polyline>") + wrong + "</polyline>")).objects.size(),
                1);
  const ImportedScene scene =
      sdf(body("<capsule><radius>0.5</radius><length>4</length></capsule>", "1 2 3 1.5707963267948966 0 0"));
  ASSERT_EQ(scene.objects.size(), 3);
  // A quarter turn about x: z becomes -y.
  EXPECT_LT(glm::length(scene.objects[1].placed.position_m - glm::dvec3(1, 4, 3)), 1e-14);
  EXPECT_LT(glm::length(scene.objects[2].placed.position_m - glm::dvec3(1, 0, 3)), 1e-14);
}

TEST_F(Sonars, SeePartsOfMeshes) {
  folder.write("two.obj",
               "o keel\nv 0 0 0\nv 1 0 0\nv 0 2 0\nf 1 2 3\no sail\nv 4 0 6\nv 8 0 6\nv 4 2 8\nf 4 5 6\n");
  const auto part = [&](const std::string& submesh) {
    return sdf(body("<mesh><uri>two.obj</uri>" + submesh + "</mesh>"));
  };
  EXPECT_EQ(part("").meshes.at(0).mesh.triangles.size(), 2);
  const ImportedScene sail = part("<submesh><name>sail</name></submesh>");
  ASSERT_EQ(sail.meshes.at(0).mesh.points_m.size(), 3);
  EXPECT_EQ(sail.meshes[0].mesh.points_m[0], glm::dvec3(4, 0, 6));
  EXPECT_EQ(part("<submesh><name>sail</name><center>true</center></submesh>").meshes.at(0).mesh.points_m[0],
            glm::dvec3(-2, -1, -1));
}

TEST_F(Sonars, SeeMeshesInTheUnitOfTheOption) {
  folder.write("t.obj", "v 0 0 0\nv 1 0 0\nv 0 2 0\nf 1 2 3\n");
  const std::string mesh = body("<mesh><uri>t.obj</uri></mesh>");
  EXPECT_EQ(sdf(mesh).meshes.at(0).mesh.points_m[2].y, 2);
  EXPECT_EQ(sdf(mesh, 0.001).meshes.at(0).mesh.points_m[2].y, 0.002);
  const auto program = [&](const std::string& unit) {
    return run_program({"import-scene", (folder / "w.sdf").string(), "--unit-m", unit, "-o",
                        (folder / "out").string()})
        .exit_code;
  };
  EXPECT_EQ(program("0.01"), 0);
  EXPECT_EQ(read_mesh_file(folder / "out/t.obj").points_m[2].y, 0.02);
  EXPECT_NE(program("0"), 0);
  EXPECT_NE(program("-1"), 0);
}

TEST_F(Sonars, OnAFacetMoveOffIt) {
  folder.write("w.sdf", "<sdf version='1.9'><world name='w'>" + body("<plane><size>20 20</size></plane>") +
                            "<model name='s'><link name='l'><sensor name='eye' type='gpu_lidar'><lidar>" +
                            scan(-0.5, 0.5, -0.2, 0.2, "<samples>9</samples>") +
                            "</lidar></sensor></link></model></world></sdf>");
  const Outcome made =
      run_program({"import-scene", (folder / "w.sdf").string(), "-o", (folder / "out").string()});
  EXPECT_EQ(made.exit_code, 0) << made.err;
  EXPECT_THAT(made.err, HasSubstr("sonar 'eye' lies exactly on the surface of 'm::l::v'"));
  EXPECT_THAT(bytes_of(folder / "out/scene.toml"), HasSubstr("position_m = [0, 0, 0.001]"));
  const Outcome checked = run_program({"check", (folder / "out/scene.toml").string()});
  EXPECT_EQ(checked.exit_code, 0) << checked.err;
}

TEST_F(Sonars, InTheirHousingAreReportedWithItsName) {
  const auto notes = [&](const std::string& at) {
    ImportedScene scene =
        sdf("<model name='housing'><link name='l'><visual name='v'><geometry><sphere><radius>0.1</radius>"
            "</sphere></geometry></visual><sensor name='eye' type='gpu_lidar'><pose>" +
            at + " 0 0 0</pose><lidar>" + scan(-0.5, 0.5, -0.2, 0.2, "<samples>9</samples>") +
            "</lidar></sensor></link></model>");
    std::filesystem::create_directories(folder / "out");
    write_imported_scene(scene, folder / "out");
    return scene.noticed;
  };
  EXPECT_THAT(notes("0 0 0"), Contains(HasSubstr("sonar 'eye' is inside object 'housing::l::v'")));
  EXPECT_THAT(notes("0.2 0 0"), Not(Contains(HasSubstr("is inside object"))));
}

TEST_F(Sonars, OfTheExampleSeeTheObjects) {
  for (const char* shape : {"<plane><size>20 20</size></plane>", "<sphere><radius>30</radius></sphere>"}) {
    folder.write("w.sdf",
                 std::string("<sdf version='1.9'><world name='w'>") + body(shape) + "</world></sdf>");
    std::filesystem::remove_all(folder / "out");
    EXPECT_EQ(
        run_program({"import-scene", (folder / "w.sdf").string(), "-o", (folder / "out").string()}).exit_code,
        0);
    const Outcome checked = run_program({"check", (folder / "out/scene.toml").string()});
    EXPECT_EQ(checked.exit_code, 0) << checked.err;
    EXPECT_THAT(checked.err, Not(HasSubstr("receives nothing"))) << checked.err;
  }
}

TEST_F(Sonars, NeedWorldsNotTemplates) {
  for (const char* name : {"w.world.xacro", "w.sdf.erb", "w.sdf.em"}) {
    folder.write(name, "<sdf version='1.9'/>");
    EXPECT_THAT([&] { read_world(folder / name, {}); },
                testing::ThrowsMessage<InputError>(HasSubstr("is a template of")));
  }
  folder.write("r.urdf", "<robot name='r'/>");
  EXPECT_THAT([&] { read_world(folder / "r.urdf", {}); },
              testing::ThrowsMessage<InputError>(HasSubstr("gz sdf -p")));
}

}  // namespace
}  // namespace tubefoot
