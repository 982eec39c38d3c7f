// SPDX-License-Identifier: GPL-3.0-or-later
// Tests mesh files in text and binary formats: the same tetrahedron in each format, polygons, non-manifold
// meshes, truncated files, and error positions.

#include "scene/meshes/mesh_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <glm/geometric.hpp>

#include "fixtures/world/mesh_sizes.hpp"
#include "fixtures/world/read_scenes.hpp"

namespace tubefoot {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;
using testing::ThrowsMessage;
using Triangle = std::array<std::uint32_t, 3>;
using test::area;
using test::read;
using test::volume;

std::string without_last(std::string text, std::size_t bytes) {
  text.resize(text.size() - bytes);
  return text;
}

// --- the same tetrahedron in each format ---

constexpr const char* kObj =
    "# tetrahedron\nv 0 0 0\nv 7246504.123456 0 0\nv 0 1e0 0\nv 0 0 +1.5\n"
    "f 1 3 2\nf 1/9/9 2//7 4/1\nf 2 3 4\nf 3 1 4\n";
constexpr const char* kOff =
    "OFF # counts follow\n\n4 4 0\n0 0 0\n7246504.123456 0 0 255 0 0\n# a comment\n0 1 0\n0 0 1.5\n"
    "3 0 2 1 0.5 0.5 0.5\n3 0 1 3\n3 1 2 3\n3 2 0 3\n";
constexpr const char* kPly =
    "ply\nformat ascii 1.0\ncomment made by hand\nelement vertex 4\nproperty double x\nproperty double y\n"
    "property uchar red\nproperty double z\nelement face 4\nproperty list uchar int vertex_indices\n"
    "property float quality\nend_header\n0 0 255 0\n7246504.123456 0 255 0\n0 1 255 0\n0 0 255 1.5\n"
    "3 0 2 1 .5\n3 0 1 3 .5\n3 1 2 3 .5\n3 2 0 3 .5\n";

std::string text_stl(double far) {
  const std::array<std::string, 4> v = {"0 0 0", std::to_string(far) + " 0 0", "0 1 0", "0 0 1.5"};
  std::string text = "solid tetrahedron\n";
  for (const Triangle& t : {Triangle{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}}) {
    text += "  facet normal 0 0 0\n    outer loop\n";
    for (const auto k : t) text += "      vertex " + v[k] + "\n";
    text += "    endloop\n  endfacet\n";
  }
  return text + "endsolid tetrahedron\n";
}

template <typename Number>
void append(std::string& bytes, Number value, bool big_endian = false) {
  char raw[sizeof value];
  std::memcpy(raw, &value, sizeof value);
  if (big_endian) std::reverse(raw, raw + sizeof value);
  bytes.append(raw, sizeof value);
}

std::string binary_stl(float far) {
  const float v[4][3] = {{0, 0, 0}, {far, 0, 0}, {0, 1, 0}, {0, 0, 1.5F}};
  std::string bytes = "solid by a program that writes so into binary files";
  bytes.resize(80, '\0');
  append(bytes, std::uint32_t{4});
  for (const Triangle& t : {Triangle{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}}) {
    for (int k = 0; k < 3; ++k) append(bytes, 0.0F);
    for (const auto corner : t) {
      for (const float coordinate : v[corner]) append(bytes, coordinate);
    }
    append(bytes, std::uint16_t{0});
  }
  return bytes;
}

std::string binary_ply(bool big_endian, double far) {
  std::string bytes =
      std::string("ply\nformat binary_") + (big_endian ? "big" : "little") +
      "_endian 1.0\nelement vertex 4\nproperty double x\nproperty float y\nproperty short z2\n"
      "property double z\nelement face 4\nproperty list uchar uint vertex_index\nend_header\n";
  const double v[4][3] = {{0, 0, 0}, {far, 0, 0}, {0, 1, 0}, {0, 0, 1.5}};
  for (const auto& p : v) {
    append(bytes, p[0], big_endian);
    append(bytes, static_cast<float>(p[1]), big_endian);
    append(bytes, std::int16_t{-3}, big_endian);
    append(bytes, p[2], big_endian);
  }
  for (const Triangle& t : {Triangle{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}}) {
    append(bytes, std::uint8_t{3}, big_endian);
    for (const std::uint32_t k : t) append(bytes, k, big_endian);
  }
  return bytes;
}

TEST(MeshFile, EveryFormatGivesTheSameTetrahedronInDoublePrecision) {
  const double far = 7246504.123456;  // single precision would keep 7246504
  for (const auto& [name, content] :
       std::vector<std::pair<std::string, std::string>>{{"t.obj", kObj},
                                                        {"t.OFF", kOff},
                                                        {"t.ply", kPly},
                                                        {"little.ply", binary_ply(false, far)},
                                                        {"big.ply", binary_ply(true, far)},
                                                        {"t.stl", text_stl(far)}}) {
    SCOPED_TRACE(name);
    const ComponentMesh mesh = read(name, content);
    EXPECT_THAT(mesh.triangles, SizeIs(4));
    EXPECT_DOUBLE_EQ(volume(mesh), far * 1.5 / 6);
    EXPECT_THAT(mesh.warnings, IsEmpty());
  }
  EXPECT_DOUBLE_EQ(volume(read("binary.stl", binary_stl(8))), 8 * 1.5 / 6);
}

TEST(MeshFile, LineEndsOfDosAndContinuedLinesAreRead) {
  const ComponentMesh mesh = read("t.obj", "v 0 0 0\r\nv 1 0 \\\r\n0\r\nv 0 1 0\r\nf 1 2 \\\r\n  3\r\n");
  EXPECT_THAT(mesh.triangles, ElementsAre(Triangle{0, 1, 2}));
}

TEST(MeshFile, RelativeIndicesOfObjCountBackwards) {
  const ComponentMesh mesh =
      read("t.obj", "v 9 9 9\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf -3 -2 -1\nv 1 1 0\nf -3 -1 -2\n");
  EXPECT_THAT(mesh.triangles, ElementsAre(Triangle{0, 1, 2}, Triangle{1, 3, 2}));
  EXPECT_EQ(mesh.points_m[0], glm::dvec3(0, 0, 0)) << "the unused vertex 9 9 9 is left out";
}

TEST(MeshFile, FacesMayPointAhead) {
  EXPECT_THAT(read("t.obj", "f 1 2 3\nv 0 0 0\nv 1 0 0\nv 0 1 0\n").triangles, SizeIs(1));
}

// --- polygons ---

TEST(MeshFile, PolygonsAreCutIntoTheirTriangles) {
  const ComponentMesh hexagon =
      read("t.off", "OFF\n6 1 0\n2 0 0\n1 2 0\n-1 2 0\n-2 0 0\n-1 -2 0\n1 -2 0\n6 0 1 2 3 4 5\n");
  EXPECT_THAT(hexagon.triangles, SizeIs(4));
  EXPECT_DOUBLE_EQ(area(hexagon), 12);
}

TEST(MeshFile, AConcaveQuadrangleIsCutAtItsReflexCorner) {
  for (const char* face : {"f 1 2 3 4", "f 2 3 4 1", "f 3 4 1 2", "f 4 3 2 1"}) {
    const ComponentMesh dart =
        read("t.obj", std::string("v 0 0 0\nv 4 -4 1\nv 1 0 0.25\nv 4 4 1\n") + face + "\n");
    // a tilted concave quadrangle of horizontal area 4
    EXPECT_NEAR(area(dart), 4 * std::hypot(1, 0.25), 1e-12) << face;
    EXPECT_THAT(dart.warnings, IsEmpty());
  }
}

// --- no facet may be lost ---

FacetMesh on_grid(const ComponentMesh& mesh, MeshReport& report) {
  MeshBuilder builder(WorldGrid(10, {0, 0, 0}));
  builder.add(mesh.points_m, mesh.triangles, 0, 0);
  return builder.finish(report);
}

TEST(MeshFile, ComplexVerticesAndEdgesAndDuplicatesAllTakePart) {
  const ComponentMesh mesh =
      read("bad.obj",
           "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 -1 0\nv 0 0 1\n"  // three facets on the edge 1-2
           "f 1 2 3\nf 2 1 4\nf 1 2 5\n"
           "v 5 0 0\nv 6 0 0\nv 6 1 0\nv 4 0 0\nv 4 1 0\n"  // two fans that share only vertex 6
           "f 6 7 8\nf 6 9 10\n"
           "f 6 7 8\nf 7 8 6\n"  // duplicates
           "f 1 1 2\n"           // a repeated vertex
           "f 9 6 7\n");         // zero area: 4 0 0, 5 0 0, 6 0 0
  EXPECT_THAT(mesh.triangles, SizeIs(9));
  MeshReport report;
  const FacetMesh placed = on_grid(mesh, report);
  EXPECT_EQ(placed.facets.size(), 9u);
  EXPECT_EQ(report.duplicate_facets, 2u);
  EXPECT_EQ(report.degenerate_facets, 2u);

  testing::internal::CaptureStderr();
  const std::size_t refused = facets_outside_halfedge(placed, 0, 9);
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
  EXPECT_GE(refused, 4u);  // at least the third on the edge, the duplicates and the repeated vertex
  EXPECT_LT(refused, 9u);
}

TEST(MeshFile, AManifoldMeshFitsTheHalfEdgeStructure) {
  MeshReport report;
  const FacetMesh placed = on_grid(read("t.stl", binary_stl(8)), report);
  EXPECT_EQ(placed.vertices.size(), 4u);
  EXPECT_EQ(facets_outside_halfedge(placed, 0, 4), 0u);
}

TEST(MeshFile, RealMeshesKeepEveryFacet) {
  const std::filesystem::path data = TUBEFOOT_SOURCE_DIR "/scenes/data";
  EXPECT_THAT(read_mesh_file(data / "bop_panel.obj").triangles, SizeIs(5212));
  EXPECT_THAT(read_mesh_file(data / "lake_bottom.obj").triangles, SizeIs(12020));
  EXPECT_THAT(read_mesh_file(data / "munkholmen_seabed.obj").triangles, SizeIs(2115));
}

// --- bad input ---

struct BadMesh {
  std::string title, file, content, place, message;
};
void PrintTo(const BadMesh& bad, std::ostream* out) { *out << bad.title; }

class MeshFileRefuses : public testing::TestWithParam<BadMesh> {};

TEST_P(MeshFileRefuses, BadInputWithItsPlace) {
  const BadMesh& bad = GetParam();
  const TestFolder folder;
  const auto file = folder.write(bad.file, bad.content);
  EXPECT_THAT([&] { read_mesh_file(file); },
              ThrowsMessage<InputError>(AllOf(HasSubstr(bad.file + bad.place), HasSubstr(bad.message))));
}

std::string with(std::string text, const std::string& from, const std::string& to) {
  return text.replace(text.find(from), from.size(), to);
}

std::vector<BadMesh> bad_meshes() {
  const std::string obj = kObj, off = kOff, ply = kPly, stl = text_stl(8), binary = binary_stl(8);
  const std::string little = binary_ply(false, 8);
  std::string nan_stl = binary, nan_ply = little;
  const float not_a_number = std::nanf("");
  std::memcpy(nan_stl.data() + 84 + 12 + 4, &not_a_number, 4);
  const double infinite = INFINITY;
  std::memcpy(nan_ply.data() + little.find("end_header\n") + 11, &infinite, 8);
  std::string out_of_range_ply = little;
  out_of_range_ply[little.size() - 4] = 4;
  return {
      {"EmptyObj", "m.obj", "", ": ", "is empty"},
      {"EmptyOff", "m.off", " \n\n", ": ", "is empty"},
      {"EmptyPly", "m.ply", "", ": ", "is empty"},
      {"EmptyStl", "m.stl", "", ": ", "is empty"},
      {"UnknownFormat", "m.blend", "BLENDER", ": ",
       "expected .obj, .ply, .stl, .off, .dae, .gltf, .glb, .3ds or .fbx"},

      {"ObjCutInVertex", "m.obj", "v 0 0 0\nv 1 0 0\nv 0 1", ":3:", "cut short"},
      {"ObjCutInFace", "m.obj", without_last(obj, 3),
       ":9: ", "2 corners, and its line does not end with a newline"},
      {"ObjCutAfterVertices", "m.obj", obj.substr(0, obj.find("f 1 3")), ": ",
       "4 points and no facets: it is a point cloud"},
      {"ObjNan", "m.obj", with(obj, "1e0", "nan"), ":4:5: ", "y is 'nan', expected a finite number"},
      {"ObjInf", "m.obj", with(obj, "1e0", "-inf"), ":4:5: ", "finite"},
      {"ObjOverflow", "m.obj", with(obj, "1e0", "1e999"), ":4:5: ", "finite"},
      {"ObjNotANumber", "m.obj", with(obj, "1e0", "1,0"), ":4:5: ", "'1,0'"},
      {"ObjIndexTooLarge", "m.obj", with(obj, "f 2 3 4", "f 2 3 5"),
       ":8: ", "vertex 5, which is out of range"},
      {"ObjIndexZero", "m.obj", with(obj, "f 2 3 4", "f 2 0 4"), ":8:5: ", "out of range"},
      {"ObjIndexTooFarBack", "m.obj", with(obj, "f 2 3 4", "f 2 -5 4"), ":8:5: ", "out of range"},
      {"ObjIndexIsNoNumber", "m.obj", with(obj, "f 2 3 4", "f 2 x 4"), ":8:5: ", "expected an integer"},
      {"ObjMisspeltFace", "m.obj", with(obj, "f 2 3 4", "ff 2 3 4"),
       ":8:1: ", "does not start with an OBJ statement"},
      {"ObjOfBytes", "m.obj", std::string("\0\1\2\xff garbage", 12),
       ":1:1: ", "does not start with an OBJ statement"},

      {"OffHeader", "m.off", with(off, "OFF", "OOF"), ":1:1: ", "expected a header OFF"},
      {"OffFourDimensions", "m.off", with(off, "OFF", "4OFF"), ":1:1: ", "expected a header OFF"},
      {"OffBinary", "m.off", "OFF BINARY\n123", ":1:5: ", "binary OFF"},
      {"OffCutInVertices", "m.off", off.substr(0, off.find("0 0 1.5")), ":7: ", "expected vertex 4 of 4"},
      {"OffCutInFaces", "m.off", off.substr(0, off.find("3 1 2 3")), ":10: ", "expected face 3 of 4"},
      {"OffCutInLine", "m.off", without_last(off, 3), ":12:", "cut short"},
      {"OffNan", "m.off", with(off, "0 1 0", "0 nan 0"), ":7:3: ", "finite"},
      {"OffIndex", "m.off", with(off, "3 1 2 3", "3 1 2 4"), ":11:7: ", "out of range"},
      {"OffNegativeIndex", "m.off", with(off, "3 1 2 3", "3 1 -2 3"), ":11:5: ", "out of range"},
      {"OffNoFacet", "m.off", "OFF\n3 0 0\n0 0 0\n1 0 0\n0 1 0\n", ": ", "point cloud"},
      {"OffHugeCount", "m.off", "OFF\n4000000000 4000000000 0\n0 0 0\n", ":3: ", "cut off"},
      {"OffNegativeCount", "m.off", "OFF\n-3 1 0\n", ":2:1: ", "number of vertices"},

      {"PlyHeader", "m.ply", with(ply, "ply", "pyl"), ":1:1: ", "not a PLY file"},
      {"PlyCutInHeader", "m.ply", ply.substr(0, ply.find("element face")), ":8: ", "end_header"},
      {"PlyCutInVertices", "m.ply", ply.substr(0, ply.find("0 0 255 1.5")),
       ":15: ", "expected vertex 4 of 4"},
      {"PlyCutInLine", "m.ply", without_last(ply, 6), ":20:", "cut short"},
      {"PlyNan", "m.ply", with(ply, "0 1 255 0", "0 nan 255 0"), ":15:3: ", "finite"},
      {"PlyIndex", "m.ply", with(ply, "3 1 2 3", "3 1 2 4"), ":19: ", "vertex 4, which is out of range"},
      {"PlyNegativeIndex", "m.ply", with(ply, "3 1 2 3", "3 1 -2 3"), ":19:5: ", "out of range"},
      {"PlyNoX", "m.ply", with(ply, "double x", "double u"), ": ", "no property x"},
      {"PlyNoFacet", "m.ply", with(ply, "element face 4", "element face 0"), ": ", "point cloud"},
      {"PlyBinaryCut", "m.ply", without_last(little, 5), ": ", "cut off in face 4 of 4"},
      {"PlyBinaryCutInVertices", "m.ply", without_last(little, 60), ": ", "cut off in vertex 4 of 4"},
      {"PlyBinaryInf", "m.ply", nan_ply, ": ", "finite"},
      {"PlyBinaryIndex", "m.ply", out_of_range_ply, ": ",
       "face 3 (counted from 0) refers to vertex 4, which is out of range"},
      {"PlyHugeCount", "m.ply", with(little, "vertex 4", "vertex 4000000000"), ": ", "cut off"},
      {"PlyStrips", "m.ply", with(ply, "element face", "element tristrips"), ": ", "triangle strips"},

      {"StlCutInFacet", "m.stl", stl.substr(0, stl.rfind("      vertex")), ":26: ", "expected 'vertex'"},
      {"StlCutBetweenFacets", "m.stl", stl.substr(0, stl.find("endsolid")), ":29: ", "endsolid"},
      {"StlNan", "m.stl", with(stl, "vertex 0 1 0", "vertex 0 NaN 0"), ":5:16: ", "finite"},
      {"StlMissingVertex", "m.stl", with(stl, "      vertex 0 1 0\n", ""), ":6:5: ", "expected 'vertex'"},
      {"StlNoFacet", "m.stl", "solid nothing\nendsolid nothing\n", ": ", "no facets"},
      {"StlBinaryCut", "m.stl", without_last(binary, 1), ": ",
       "declares 4 facets in 284 bytes, but the file has 283"},
      {"StlBinaryHeaderCut", "m.stl", std::string(50, '\1'), ": ", "cut off"},
      {"StlBinaryNan", "m.stl", nan_stl, ": ", "finite"},
  };
}

INSTANTIATE_TEST_SUITE_P(Formats, MeshFileRefuses, testing::ValuesIn(bad_meshes()),
                         [](const auto& bad) { return bad.param.title; });

TEST(MeshFile, RefusesAMissingFileAndAFolder) {
  const TestFolder folder;
  EXPECT_THAT([&] { read_mesh_file(folder.path() / "none.obj"); },
              ThrowsMessage<InputError>(HasSubstr("none.obj")));
  std::filesystem::create_directory(folder.path() / "folder.obj");
  EXPECT_THROW(read_mesh_file(folder.path() / "folder.obj"), InputError);
}

TEST(MeshFile, EveryCutOfEveryFormatEndsWellOrInAnInputError) {
  const TestFolder folder;
  for (const auto& [name, content] :
       std::vector<std::pair<std::string, std::string>>{{"t.obj", kObj},
                                                        {"t.off", kOff},
                                                        {"t.ply", kPly},
                                                        {"b.ply", binary_ply(true, 8)},
                                                        {"t.stl", text_stl(8)},
                                                        {"b.stl", binary_stl(8)}}) {
    for (std::size_t size = 0; size < content.size(); ++size) {
      const auto file = folder.write(std::to_string(size) + name, content.substr(0, size));
      try {
        const ComponentMesh mesh = read_mesh_file(file);
        // A prefix may pass only if it lacks no more than line ends, a part of its last number, or whole
        // faces of an OBJ.
        if (mesh.triangles.size() < 4 || !mesh.warnings.empty()) {
          EXPECT_EQ(name, "t.obj") << size;
        } else {
          EXPECT_LE(content.size() - size, 14u) << name;  // " tetrahedron\n" after endsolid
        }
      } catch (const InputError&) {
      }
    }
  }
}

TEST(MeshFile, AnObjWithoutItsLastLineEndIsStated) {
  EXPECT_THAT(read("t.obj", without_last(kObj, 1)).warnings,
              ElementsAre(HasSubstr("does not end with a newline")));
}

}  // namespace
}  // namespace tubefoot
