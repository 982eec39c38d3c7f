// SPDX-License-Identifier: GPL-3.0-or-later
// Tests COLLADA, glTF, 3DS and FBX files: node transformations, axes and units, names, and malicious files
// that expand to large contents.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <memory>
#include <random>

#include "fixtures/model_samples.hpp"
#include "fixtures/processor_time.hpp"
#include "fixtures/world/mesh_sizes.hpp"
#include "fixtures/world/read_scenes.hpp"
#include "scene/meshes/mesh_file_apart.hpp"
#include "scene/meshes/mesh_file_model.hpp"

namespace tubefoot {
namespace {

using test::area;
using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;
using testing::ThrowsMessage;

struct Sample {
  std::string name, content;
};
std::vector<Sample> samples() {
  return {{"m.dae", collada_model()},
          {"m.gltf", gltf_model(R"(,"uri":"numbers.bin")")},
          {"m.glb", glb_model()},
          {"m.3ds", studio_model()},
          {"m.fbx", fbx_model()}};
}

NamedMesh read(const TestFolder& folder, const Sample& sample, const MeshAxes& axes = {}) {
  folder.write("numbers.bin", gltf_numbers());
  return read_mesh_file(folder.write(sample.name, sample.content), axes);
}

struct Box {
  glm::dvec3 lo{1e9}, hi{-1e9};
};
Box box_of(const ComponentMesh& mesh) {
  Box box;
  for (const glm::dvec3& p : mesh.points_m) {
    box.lo = glm::min(box.lo, p);
    box.hi = glm::max(box.hi, p);
  }
  return box;
}

TEST(Models, NodesPutMeshesWhereTheyBelongAndUnitsMakeThemMetres) {
  const TestFolder folder;
  for (const Sample& sample : samples()) {
    SCOPED_TRACE(sample.name);
    const bool one = sample.name == "m.3ds";
    // With the same options for all formats: z up, metres.
    const NamedMesh mesh = read(folder, sample, {"z", 1.0});
    EXPECT_NEAR(area(mesh), one ? 2 : 2 + 4, 1e-5);
    const Box box = box_of(mesh);
    // The second plate: x from 0 to 2 becomes y, y from 0 to 2 becomes -x. All is moved by 3 and lifted by
    // 0.5.
    EXPECT_LT(glm::distance(box.lo, one ? glm::dvec3(3, 0, 0) : glm::dvec3(1, 0, 0)), 1e-6);
    EXPECT_LT(glm::distance(box.hi, one ? glm::dvec3(4, 2, 0) : glm::dvec3(4, 2, 0.5)), 1e-6);
  }
}

TEST(Models, WhatTheFileDeclaresIsTaken) {
  const TestFolder folder;
  const auto is = [&](const Sample& sample, glm::dvec3 lo, glm::dvec3 hi) {
    const Box box = box_of(read(folder, sample));
    EXPECT_LT(glm::distance(box.lo, lo) + glm::distance(box.hi, hi), 1e-6) << sample.name;
  };
  is({"m.dae", collada_model()}, {0.01, 0, 0}, {0.04, 0.02, 0.005});
  is({"m.dae", collada_model(R"(<!--<unit meter="9"/>--><unit meter='2'/><up_axis> Y_UP </up_axis>)")},
     {2, -1, 0}, {8, 0, 4});
  // x becomes z, z becomes -x.
  is({"m.dae", collada_model(R"(<unit meter="1"/><up_axis>X_UP</up_axis>)")}, {-0.5, 0, 1}, {0, 2, 4});
  // Metres, y up: y becomes z, z becomes -y.
  is({"m.gltf", gltf_model(R"(,"uri":"numbers.bin")")}, {1, -0.5, 0}, {4, 0, 2});
  is({"m.glb", glb_model()}, {1, -0.5, 0}, {4, 0, 2});
  is({"m.fbx", fbx_model()}, {1, 0, 0}, {4, 2, 0.5});
  is({"m.fbx",
      fbx_model("\t\tP: \"UpAxis\", \"int\", \"Integer\", \"\",1\n\t\tP: \"UnitScaleFactor\", \"double\", "
                "\"Number\", \"\",1\n")},
     {0.01, -0.005, 0}, {0.04, 0, 0.02});
}

// An FBX file also rotates its nodes by the inverse of PostRotation, about the axes of the node itself.
TEST(Models, PivotsOfAnFbxTurnAsTheyShould) {
  const TestFolder folder;
  std::string text = fbx_model();
  const std::string hull = "\"A\",3,0,0\n";
  const std::size_t at = text.find(hull);
  ASSERT_NE(at, text.npos);
  text.insert(at + hull.size(),
              "\t\t\tP: \"RotationActive\", \"bool\", \"\", \"\",1\n"
              "\t\t\tP: \"PostRotation\", \"Vector3D\", \"Vector\", \"\",0,0,90\n");
  const NamedMesh mesh = read(folder, {"m.fbx", text});
  const Box box = box_of(mesh);
  EXPECT_LT(glm::distance(box.lo, glm::dvec3(3, -1, 0)), 1e-6);
  EXPECT_LT(glm::distance(box.hi, glm::dvec3(5, 2, 0.5)), 1e-6);
  for (const std::vector<std::string>& names : mesh.names)
    for (const std::string& name : names) EXPECT_EQ(name.find("AssimpFbx"), name.npos) << name;
}

// The reader does not support quantised integer positions.
TEST(Models, QuantisedPositionsAreRefused) {
  const TestFolder folder;
  std::string text = gltf_model(R"(,"uri":"numbers.bin")");
  text.insert(text.find('{') + 1, R"("extensionsRequired":["KHR_mesh_quantization"],)");
  EXPECT_THAT(
      [&] {
        read(folder, {"m.gltf", text});
      },
      ThrowsMessage<InputError>(HasSubstr("KHR_mesh_quantization")));
}

// Whole numbers without the extension are invalid. Assimp would read their bits as floats.
TEST(Models, PositionsThatAreWholeNumbersAreRejected) {
  const TestFolder folder;
  for (const char* type : {"5123", "5122", "5125", "5120", "\"FLOAT\""}) {
    std::string text = gltf_model(R"(,"uri":"numbers.bin")");
    const std::string floats = R"("componentType":5126)";
    text.replace(text.find(floats), floats.size(), std::string(R"("componentType":)") + type);
    EXPECT_THAT(
        [&] {
          read(folder, {"m.gltf", text});
        },
        ThrowsMessage<InputError>(HasSubstr("meshes[0].primitives[0]: the positions are not floats")))
        << type;
  }
}

TEST(Models, WhatNeitherFileNorSceneSaysIsRefused) {
  const TestFolder folder;
  const auto refused = [&](const Sample& sample, const MeshAxes& axes, const char* what) {
    EXPECT_THAT([&] { read(folder, sample, axes); }, ThrowsMessage<InputError>(HasSubstr(what)))
        << sample.name;
  };
  const char *both = "add 'up' (\"x\", \"y\" or \"z\") and 'unit_m'",
             *axis = "does not define its vertical axis", *unit = "does not define its unit of length";
  refused({"m.3ds", studio_model()}, {}, both);
  refused({"m.3ds", studio_model()}, {"z", {}}, unit);
  refused({"m.3ds", studio_model()}, {{}, 0.01}, axis);
  refused({"m.dae", collada_model("")}, {}, axis);
  refused({"m.dae", collada_model("<unit meter=\"-1\"/><up_axis>Z_UP</up_axis>")}, {}, unit);
  refused({"m.dae", collada_model("<unit name=\"cm\"/><up_axis>Z_UP</up_axis>")}, {}, unit);
  refused({"m.dae", collada_model("<unit meter=\"0.01\"/>")}, {}, axis);
  refused({"m.fbx", fbx_model("")}, {}, both);
  refused({"m.fbx",
           fbx_model("\t\tP: \"OriginalUpAxis\", \"int\", \"Integer\", \"\",1\n\t\tP: \"UnitScaleFactor\", "
                     "\"double\", \"Number\", \"\",1\n")},
          {}, axis);
  refused({"m.fbx",
           fbx_model("\t\tP: \"UpAxis\", \"int\", \"Integer\", \"\",1\n\t\tP: \"UpAxisSign\", \"int\", "
                     "\"Integer\", \"\",-1\n\t\tP: \"UnitScaleFactor\", \"double\", \"Number\", \"\",1\n")},
          {}, axis);
}

TEST(Models, ColladaWithoutAUnitIsInMetres) {
  const TestFolder folder;
  const Sample sample{"m.dae", collada_model("<up_axis>Z_UP</up_axis>")};
  const NamedMesh mesh = read(folder, sample);
  EXPECT_LT(glm::distance(box_of(mesh).hi, glm::dvec3(4, 2, 0.5)), 1e-6);
  EXPECT_THAT(mesh.warnings, Contains(HasSubstr("states no unit of length, so its unit is 1 m")));
  // Other lengths replace the default, and then there is no warning.
  for (const MeshAxes& axes : {MeshAxes{{}, 0.01, {}, {}}, MeshAxes{{}, {}, {}, 0.01}}) {
    const NamedMesh scaled = read(folder, sample, axes);
    EXPECT_LT(glm::distance(box_of(scaled).hi, glm::dvec3(0.04, 0.02, 0.005)), 1e-6);
    EXPECT_TRUE(scaled.warnings.empty());
  }
  // Stated values precede those for files without them.
  const MeshAxes unless_stated{{}, {}, "y", 0.01};
  EXPECT_LT(
      glm::distance(box_of(read(folder, {"m.dae", collada_model("<unit meter='2'/><up_axis>Z_UP</up_axis>")},
                                unless_stated))
                        .hi,
                    glm::dvec3(8, 4, 1)),
      1e-6);
  EXPECT_LT(glm::distance(box_of(read(folder, {"m.dae", collada_model("")}, unless_stated)).hi,
                          glm::dvec3(0.04, 0, 0.02)),
            1e-6);
}

TEST(Models, TheSceneHasTheLastWordOnAxesAndUnits) {
  const TestFolder folder;
  const Box box = box_of(read(folder, {"m.dae", collada_model()}, {"y", 1.0}));
  EXPECT_LT(glm::distance(box.hi, glm::dvec3(4, 0, 2)), 1e-6);
}

TEST(Models, FacesGoByMaterialMeshAndNodes) {
  const TestFolder folder;
  for (const Sample& sample : samples()) {
    const NamedMesh mesh = read(folder, sample, {"z", 1.0});
    ASSERT_EQ(mesh.names_of.size(), mesh.triangles.size()) << sample.name;
    const auto& names = mesh.names[mesh.names_of.front()];
    ASSERT_FALSE(names.empty()) << sample.name;
    EXPECT_EQ(names.front(), "steel") << sample.name;
    if (sample.name == "m.3ds") continue;  // contains only names of materials without key frames
    EXPECT_THAT(names, AllOf(Contains("plate"), Contains("hull"))) << sample.name;
    EXPECT_THAT(mesh.names[mesh.names_of.back()], AllOf(Contains("child"), Contains("hull"))) << sample.name;
  }
}

TEST(Models, PolygonsAreCutByOurselves) {
  const TestFolder folder;
  std::string text = collada_model();
  const auto put = [&](const std::string& from, const std::string& to) {
    text.replace(text.find(from), from.size(), to);
  };
  // The U-shaped outline of mesh_polygons_test.cpp.
  put("count=\"12\">0 0 0 1 0 0 1 2 0 0 2 0",
      "count=\"24\">0 0 0 1 0 0 1 1.2 0 1.8 1.2 0 1.8 0 0 2.8 0 0 2.8 2 0 0 2 0");
  put("count=\"4\" stride", "count=\"8\" stride");
  put("<vcount>4</vcount><p>0 1 2 3</p>", "<vcount>8</vcount><p>0 1 2 3 4 5 6 7</p>");
  const NamedMesh mesh = read(folder, {"m.dae", text}, {"z", 1.0});
  const double own = 2.8 * 2 - 0.8 * 1.2;
  EXPECT_NEAR(area(mesh), own + 2 * own, 1e-5);
}

TEST(Models, BuffersOfGltfStayInItsFolder) {
  const TestFolder folder;
  std::filesystem::create_directory(folder.path() / "model");
  folder.write("outside.bin", gltf_numbers());
  std::filesystem::create_symlink("../outside.bin", folder.path() / "model/link.bin");
  folder.write("model/my numbers.bin", gltf_numbers());
  const auto reads = [&](const std::string& uri) {
    return read_mesh_file(folder.write("model/m.gltf", gltf_model(fmt::format(R"(,"uri":"{}")", uri))));
  };
  EXPECT_THAT(reads("my%20numbers.bin").triangles, SizeIs(4));
  EXPECT_THAT(reads("./my numbers.bin").triangles, SizeIs(4));
  for (const std::string& uri :
       {std::string("../outside.bin"), (folder.path() / "outside.bin").string(),
        std::string("http://example.org/numbers.bin"), std::string("a/../../outside.bin"),
        std::string("link.bin"), std::string("none.bin"), std::string("file:outside.bin")})
    EXPECT_THAT([&] { reads(uri); }, ThrowsMessage<InputError>(HasSubstr(uri))) << uri;
}

TEST(Models, BuffersOfGltfAreInTheSceneHash) {
  const TestFolder folder;
  folder.write("m.gltf", gltf_model(R"(,"uri":"numbers.bin")"));
  const std::string scene =
      std::string(smallest_scene) + "[[objects]]\nname = \"o\"\nshape = \"mesh\"\nfile = \"m.gltf\"\n";
  folder.write("numbers.bin", gltf_numbers());
  const SceneDescription first = read_scene(folder, scene);
  EXPECT_THAT(first.inputs, Contains(folder.path() / "numbers.bin"));
  std::string other = gltf_numbers();
  other[3] = 1;
  folder.write("numbers.bin", other);
  EXPECT_NE(read_scene(folder, scene).sha256, first.sha256);
}

TEST(Models, GltfThatNeedsWhatIsNotReadIsRefused) {
  const TestFolder folder;
  const auto refused = [&](const std::string& text, const char* what) {
    EXPECT_THAT([&] { read(folder, {"m.gltf", text}); }, ThrowsMessage<InputError>(HasSubstr(what)));
  };
  refused(gltf_model("", R"("extensionsRequired":["KHR_draco_mesh_compression"],)"),
          "KHR_draco_mesh_compression");
  refused(R"({"asset":{"version":"1.0"}})", "version '1.0'");
  refused("{\"asset\"", "cannot be read as glTF");
  refused("{\"a\":" + std::string(1000, '[') + std::string(1000, ']') + "}", "levels deep");
}

TEST(Models, CutOrChangedFilesEndWellOrInAnInputError) {
  constexpr unsigned seed = 20262;
  RecordProperty("seed", seed);
  std::mt19937 random(seed);
  const TestFolder folder;
  for (const Sample& sample : samples())
    for (int trial = 0; trial < 40; ++trial) {
      SCOPED_TRACE(fmt::format("seed {}, {} {}", seed, sample.name, trial));
      Sample bad = sample;
      if (trial % 2 == 0)
        bad.content.resize(random() % bad.content.size());
      else
        for (int i = 0; i < 4; ++i) bad.content[random() % bad.content.size()] = static_cast<char>(random());
      try {
        const NamedMesh mesh = read(folder, bad, {"z", 1.0});
        for (const glm::dvec3& p : mesh.points_m) EXPECT_TRUE(std::isfinite(p.x + p.y + p.z));
      } catch (const InputError& error) {
        EXPECT_THAT(error.what(), HasSubstr(sample.name));
      }
    }
}

TEST(Models, NestingWithoutEndIsRefused) {
  const TestFolder folder;
  std::string text = collada_model(), deep, back;
  for (int i = 0; i < 200000; ++i) {
    deep += "<node>";
    back += "</node>";
  }
  const std::size_t at = text.find("<node id=\"n\"");
  text.insert(at, deep + back);
  EXPECT_THAT(
      [&] {
        read(folder, {"m.dae", text});
      },
      ThrowsMessage<InputError>(HasSubstr("more than 1000 levels deep")));
}

TEST(Models, NodesThatDoubleAndDoubleEndInALimit) {
  // Each node contains the next node twice: 2^60 plates.
  const TestFolder folder;
  std::string nodes;
  for (int i = 0; i < 60; ++i)
    nodes += fmt::format("<node id=\"d{}\"><instance_node url=\"#d{}\"/><instance_node url=\"#d{}\"/></node>",
                         i, i + 1, i + 1);
  std::string text = collada_model();
  text.insert(
      text.find("<library_visual_scenes>"),
      "<library_nodes>" + nodes + "<node id=\"d60\"><instance_geometry url=\"#g\"/></node></library_nodes>");
  text.insert(text.find("<node id=\"n2\""), "<instance_node url=\"#d0\"/>");
  EXPECT_THAT([&] { read(folder, {"m.dae", text}); }, ThrowsMessage<InputError>(HasSubstr("Assimp")));
}

// --- small files with large contents ---

/// A glTF with the buffer of model_samples.hpp: 4 positions (accessor 0), 6 corners (accessor 1).
std::string gltf_of(const std::string& nodes, const std::string& roots, const std::string& meshes) {
  return R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[)" + roots + R"(]}],"nodes":[)" + nodes +
         R"(],"meshes":[)" + meshes +
         R"(],"accessors":[{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3","min":[0,0,0],)" +
         R"("max":[1,2,0]},{"bufferView":1,"componentType":5123,"count":6,"type":"SCALAR"}],)" +
         R"("bufferViews":[{"buffer":0,"byteLength":48},{"buffer":0,"byteOffset":48,"byteLength":12}],)" +
         R"("buffers":[{"byteLength":60,"uri":"numbers.bin"}]})";
}
std::string repeated(const std::string& text, int times) {
  std::string all;
  for (int k = 0; k < times; ++k) all += (k == 0 ? "" : ",") + text;
  return all;
}
std::string numbers_up_to(int count) {
  std::string all;
  for (int k = 0; k < count; ++k) all += (k == 0 ? "" : ",") + std::to_string(k);
  return all;
}
const std::string plate = R"({"attributes":{"POSITION":0},"indices":1})";

/// Returns the error message, or an empty string if the file is valid. The time must be within the limit
/// for malicious input.
std::string said_in_time(const TestFolder& folder, const Sample& sample) {
  std::string said;
  EXPECT_LT(processor_seconds([&] {
              try {
                read(folder, sample, {"z", 1.0});
              } catch (const InputError& error) {
                said = error.what();
              }
            }),
            hostile_input_s)
      << sample.name << ' ' << said.substr(0, 200);
  return said;
}

TEST(Models, ManyInstancesEndInTime) {
  const TestFolder folder;
  const std::string mesh = R"({"primitives":[)" + plate + "]}";
  for (const int count : {1000, 100'000, 300'000}) {
    SCOPED_TRACE(count);
    const std::string nodes = repeated(R"({"mesh":0})", count);
    said_in_time(folder, {"m.gltf", gltf_of(nodes, numbers_up_to(count), mesh)});
    said_in_time(folder, {"m.gltf", gltf_of(nodes + R"(,{"children":[)" + numbers_up_to(count) + "]}",
                                            std::to_string(count), mesh)});
  }
  // A larger mesh at many positions: 1000 plates, 100 000 times.
  const std::string large = R"({"primitives":[)" + repeated(plate, 1000) + "]}";
  EXPECT_THAT(said_in_time(folder, {"m.gltf", gltf_of(repeated(R"({"mesh":0})", 100'000),
                                                      numbers_up_to(100'000), large)}),
              AllOf(HasSubstr("m.gltf"), HasSubstr("instances of meshes"), HasSubstr("fewer instances")));
}

TEST(Models, ManyPrimitivesAndMorphTargetsEndInTime) {
  const TestFolder folder;
  const std::string node = R"({"mesh":0})";
  for (const int count : {1000, 30'000, 100'000}) {
    SCOPED_TRACE(count);
    said_in_time(folder,
                 {"m.gltf", gltf_of(node, "0", R"({"primitives":[)" + repeated(plate, count) + "]}")});
    said_in_time(folder, {"m.gltf", gltf_of(node, "0",
                                            R"({"primitives":[{"attributes":{"POSITION":0},"targets":[)" +
                                                repeated(R"({"POSITION":0})", count) + "]}]}")});
    said_in_time(folder, {"m.gltf", gltf_of(repeated(node, count), "0",
                                            repeated(R"({"primitives":[)" + plate + "]}", count))});
  }
}

/// The primitives share one accessor of many positions.
TEST(Models, SharedVerticesOfManyPrimitivesAreRefused) {
  const TestFolder folder;
  const auto with_places = [&](const std::string& primitive, int times) {
    std::string text =
        gltf_of(R"({"mesh":0})", "0", R"({"primitives":[)" + repeated(primitive, times) + "]}");
    const std::string count = R"("count":4)";
    text.replace(text.find(count), count.size(), R"("count":100000)");
    return text;
  };
  EXPECT_THAT(said_in_time(folder, {"m.gltf", with_places(plate, 1000)}),
              AllOf(HasSubstr("m.gltf: meshes[0]"), HasSubstr("its own vertices")));
  EXPECT_THAT(said_in_time(folder, {"m.gltf", with_places(R"({"attributes":{"POSITION":0},"targets":[)" +
                                                              repeated(R"({"POSITION":0})", 1000) + "]}",
                                                          1)}),
              HasSubstr("morph targets"));
}

TEST(Models, DeepTreesOfNodesAreRefusedInTime) {
  const TestFolder folder;
  const auto chain = [](int depth) {
    std::string nodes;
    for (int k = 0; k + 1 < depth; ++k) nodes += fmt::format(R"({{"children":[{}]}},)", k + 1);
    return gltf_of(nodes + R"({"mesh":0})", "0", R"({"primitives":[)" + plate + "]}");
  };
  EXPECT_EQ(said_in_time(folder, {"m.gltf", chain(900)}), "");
  for (const int depth : {1001, 100'000})
    EXPECT_THAT(said_in_time(folder, {"m.gltf", chain(depth)}),
                HasSubstr("is nested in more than 1000 other nodes"));
}

TEST(Models, NodesOfGltfFormTrees) {
  const TestFolder folder;
  const std::string mesh = R"({"primitives":[)" + plate + "]}";
  const auto said = [&](const std::string& nodes, const std::string& roots) {
    return said_in_time(folder, {"m.gltf", gltf_of(nodes, roots, mesh)});
  };
  EXPECT_THAT(said(R"({"children":[1]},{"children":[2]},{"children":[1]})", "0"),
              HasSubstr("is a child of nodes[0] and of nodes[2]"));
  EXPECT_THAT(said(R"({"children":[1,1]},{"mesh":0})", "0"), HasSubstr("form trees"));
  EXPECT_THAT(said(R"({"mesh":0})", "0,0"), HasSubstr("form trees"));
  EXPECT_THAT(said(R"({"mesh":0},{"children":[2]},{"children":[1]})", "0"), HasSubstr("or in itself"));
}

// --- similar files of other formats: Assimp's own limit, or that of placed nodes ---

TEST(Models, InstancesOfColladaEndInTime) {
  const TestFolder folder;
  std::string text = collada_model(), instances;
  for (int k = 0; k < 60'000; ++k)
    instances += fmt::format("<node id=\"i{}\"><instance_geometry url=\"#g\"/></node>", k);
  text.insert(text.find("<node id=\"n2\""), instances);
  said_in_time(folder, {"m.dae", text});
  // 17 nodes with 10 instances each of the next would be 10^17.
  std::string nodes;
  for (int k = 0; k < 17; ++k) {
    nodes += fmt::format("<node id=\"d{}\">", k);
    for (int i = 0; i < 10; ++i) nodes += fmt::format("<instance_node url=\"#d{}\"/>", k + 1);
    nodes += "</node>";
  }
  text = collada_model();
  text.insert(
      text.find("<library_visual_scenes>"),
      "<library_nodes>" + nodes + "<node id=\"d17\"><instance_geometry url=\"#g\"/></node></library_nodes>");
  text.insert(text.find("<node id=\"n2\""), "<instance_node url=\"#d0\"/>");
  EXPECT_THAT(said_in_time(folder, {"m.dae", text}), HasSubstr("Assimp"));
}

TEST(Models, ConnectionsOfFbxEndInTime) {
  const TestFolder folder;
  std::string text = fbx_model(), models, connections;
  for (int k = 0; k < 20'000; ++k) {
    models += fmt::format("\tModel: {}, \"Model::m{}\", \"Mesh\" {{\n\t\tVersion: 232\n\t}}\n", 1000 + k, k);
    connections += fmt::format("\tC: \"OO\",{},0\n\tC: \"OO\",100,{}\n", 1000 + k, 1000 + k);
  }
  text.insert(text.find("\tMaterial: 300"), models);
  text.insert(text.find("\tC: \"OO\",200,0"), connections);
  said_in_time(folder, {"m.fbx", text});
}

// --- work in a separate process ---

using End = ApartResult::End;

TEST(DoneApart, ComesBackWithWhatTheWorkReturned) {
  const std::string long_one(3 << 20, 'x');
  const ApartResult result = done_apart([&] { return long_one; }, 10, 1e9);
  EXPECT_EQ(result.end, End::done);
  EXPECT_TRUE(result.bytes == long_one);
  EXPECT_EQ(done_apart([]() -> std::string { throw std::runtime_error("no"); }, 10, 1e9).bytes, "no");
}

TEST(DoneApart, OutlivesCrashesEndlessWorkAndHunger) {
  EXPECT_EQ(done_apart(
                []() -> std::string {
                  std::raise(SIGSEGV);
                  return {};
                },
                10, 1e9)
                .end,
            End::crashed);
  EXPECT_EQ(done_apart([]() -> std::string { _exit(0); }, 10, 1e9).end, End::crashed);
  EXPECT_EQ(done_apart(
                []() -> std::string {
                  volatile bool endless = true;
                  while (endless) {
                  }
                  return {};
                },
                1, 1e9)
                .end,
            End::too_long);
#ifndef TUBEFOOT_SANITIZED
  EXPECT_EQ(done_apart([] { return std::string(std::size_t{2} << 30, 'x'); }, 10, 5e8).end, End::refused);
#endif
}

#ifndef TUBEFOOT_SANITIZED
TEST(DoneApart, CountsNotTheMemoryThatThereWasBefore) {
  const std::unique_ptr<char[]> much(new char[std::size_t{3} << 29]);
  EXPECT_EQ(done_apart([&] { return std::string(1 << 20, much ? 'x' : 'y'); }, 10, 5e8).end, End::done);
}

TEST(DoneApart, CanOpenNoFile) {
  const ApartResult result = done_apart(
      [] { return std::string(std::ifstream("/proc/self/maps").is_open() ? "open" : "closed"); }, 10, 1e9);
  EXPECT_EQ(result.bytes, "closed");
}
#endif

}  // namespace
}  // namespace tubefoot
