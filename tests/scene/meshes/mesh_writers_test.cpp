// SPDX-License-Identifier: GPL-3.0-or-later
// Tests text meshes that deviate from the letter of their formats, as some programs write them. The reader
// accepts them, or rejects them with the reason.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>

#include "fixtures/world/mesh_sizes.hpp"
#include "fixtures/world/read_scenes.hpp"
#include "scene/meshes/mesh_file.hpp"

namespace tubefoot {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;
using testing::ThrowsMessage;
using namespace std::string_literals;
using test::read;

std::string with_returns(std::string text) {
  std::ranges::replace(text, '\n', '\r');
  return text;
}

const std::string obj = "# a mark\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 \\\n3\n";
const std::string off = "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
const std::string ply =
    "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
    "property float quality\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
    "0 0 0 1\n1 0 0 1\n0 1 0 1\n3 0 1 2\n";
const std::string stl =
    "solid mark\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\n"
    "endloop\nendfacet\nendsolid mark\n";

const std::vector<std::pair<std::string, std::string>> texts{
    {"m.obj", obj}, {"m.off", off}, {"m.ply", ply}, {"m.stl", stl}};

TEST(MeshWriters, AMarkOfUtf8InFrontIsPassedOver) {
  for (const auto& [name, text] : texts)
    EXPECT_THAT(read(name, "\xef\xbb\xbf" + text).triangles, SizeIs(1)) << name;
}

TEST(MeshWriters, Utf16IsRefusedByItsName) {
  for (const auto& [name, text] : texts) {
    std::string small = "\xff\xfe", large = "\xfe\xff", bare;
    for (const char c : text) {
      small += {c, '\0'};
      large += {'\0', c};
      bare += {c, '\0'};
    }
    for (const std::string& wide : {small, large, bare}) {
      if (name == "m.stl" && wide == bare) continue;  // may be the beginning of a binary STL
      const std::string file = name;
      const auto reading = [&] { read(file, wide); };
      EXPECT_THAT(reading, ThrowsMessage<InputError>(AllOf(HasSubstr("UTF-16"), HasSubstr("iconv")))) << name;
    }
  }
}

TEST(MeshWriters, LinesMayEndInReturnsAlone) {
  for (const auto& [name, text] : texts) {
    const NamedMesh mesh = read(name, with_returns(text));
    EXPECT_THAT(mesh.triangles, SizeIs(1)) << name;
    EXPECT_THAT(mesh.warnings, IsEmpty()) << name;
  }
  EXPECT_THAT([] { read("m.obj", with_returns("v 0 0 0\nv 1 0 0\nv 0 x 0\n")); },
              ThrowsMessage<InputError>(HasSubstr("m.obj:3:5: ")));
}

TEST(MeshWriters, BinaryPlyBehindAHeaderWithReturns) {
  std::string bytes = with_returns(
      "ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
      "property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n");
  // The first byte of the numbers is a line feed, which does not belong to the last line end of the header.
  float first = 0;
  const std::uint32_t bits = 0x4000000au;
  std::memcpy(&first, &bits, 4);
  for (const float number : {first, 0.0F, 0.0F, 1.0F, 0.0F, 0.0F, 0.0F, 1.0F, 0.0F})
    bytes.append(reinterpret_cast<const char*>(&number), 4);
  bytes += "\3\0\0\0\0\1\0\0\0\2\0\0\0"s;
  const NamedMesh mesh = read("m.ply", bytes);
  EXPECT_THAT(mesh.triangles, SizeIs(1));
  EXPECT_EQ(mesh.points_m[0].x, static_cast<double>(first));
}

TEST(MeshWriters, StlMayShoutAndPartItsEnds) {
  std::string loud = stl;
  std::ranges::transform(loud, loud.begin(),
                         [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  EXPECT_THAT(read("m.stl", loud).triangles, SizeIs(1));
  std::string parted = stl;
  for (const char* word : {"endloop", "endfacet", "endsolid"}) parted.replace(parted.find(word), 3, "end ");
  EXPECT_THAT(read("m.stl", parted).triangles, SizeIs(1));
  EXPECT_THAT(read("m.stl", "\n  " + stl).triangles, SizeIs(1));
}

TEST(MeshWriters, OffMayWhisperOrLeaveItsWordOut) {
  EXPECT_THAT(read("m.off", "off" + off.substr(3)).triangles, SizeIs(1));
  EXPECT_THAT(read("m.off", off.substr(4)).triangles, SizeIs(1));
  EXPECT_THAT(read("m.off", "# a remark\n" + off.substr(4)).triangles, SizeIs(1));
  EXPECT_THAT(read("m.off", "coff 3 1 0" + off.substr(9)).triangles, SizeIs(1));
}

TEST(MeshWriters, NotANumberWhereNothingIsReadIsNoFault) {
  std::string text = ply;
  text.replace(text.find("1 0 0 1"), 7, "1 0 0 nan");
  EXPECT_THAT(read("m.ply", text).triangles, SizeIs(1));
  text = ply;
  text.replace(text.find("1 0 0 1"), 7, "1 nan 0 1");
  EXPECT_THAT([&] { read("m.ply", text); }, ThrowsMessage<InputError>(HasSubstr("m.ply:12:3: y")));
}

TEST(MeshWriters, FacesOfTwoCornersAreCountedAndLeftOut) {
  const auto told = ElementsAre(HasSubstr("2 faces have fewer than three corners and are left out"));
  for (const auto& [name, text] : std::vector<std::pair<std::string, std::string>>{
           {"m.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2\nf 1 2 3\nf 3\n"},
           {"m.off", "OFF\n3 3 0\n0 0 0\n1 0 0\n0 1 0\n2 0 1\n3 0 1 2\n1 0\n"},
           {"m.ply",
            "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float "
            "z\nelement face 3\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 "
            "0\n2 0 1\n3 0 1 2\n1 0\n"}}) {
    const NamedMesh mesh = read(name, text);
    EXPECT_THAT(mesh.triangles, SizeIs(1)) << name;
    EXPECT_THAT(mesh.warnings, told) << name;
  }
  EXPECT_THAT([] { read("m.obj", "v 0 0 0\nv 1 0 0\nf 1 2\n"); },
              ThrowsMessage<InputError>(HasSubstr("no facets, only 1 points or lines")));
}

TEST(MeshWriters, PointCloudsAreReportedWhatToBecome) {
  const auto told = ThrowsMessage<InputError>(AllOf(HasSubstr("3 points and no facets: it is a point cloud"),
                                                    HasSubstr("MeshLab"), HasSubstr("raster")));
  EXPECT_THAT([] { read("m.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n"); }, told);
  EXPECT_THAT(
      [] {
        read("m.ply",
             "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float "
             "z\nend_header\n0 0 0\n1 0 0\n0 1 0\n");
      },
      told);
}

TEST(MeshWriters, WhatBeginsAsAnotherFormatIsReportedSo) {
  EXPECT_THAT([] { read("m.obj", "; FBX 7.3.0 project file\n"); },
              ThrowsMessage<InputError>(
                  HasSubstr("begins like FBX: give the file the extension of this format, not .obj")));
  EXPECT_THAT([] { read("m.dae", "v 0 0 0\n"); },
              ThrowsMessage<InputError>(HasSubstr("does not begin like a .dae file")));
}

}  // namespace
}  // namespace tubefoot
