// SPDX-License-Identifier: GPL-3.0-or-later
// What fuzzing found (docs/fuzzing.md), minimised, named by what it shows.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "scene/material_map_gdal.hpp"
#include "scene/mesh_file.hpp"
#include "scene/raster.hpp"
#include "scene/scene_file_folder.hpp"

namespace tubefoot {
namespace {

using namespace std::string_literals;
using testing::AllOf;
using testing::EndsWith;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

/// The message of the InputError that reading gives; empty if it gives none.
template <class Read>
std::string refusal(const Read& read) {
  try {
    read();
  } catch (const InputError& error) {
    return error.what();
  }
  return {};
}

std::string mesh_refusal(const std::string& name, const std::string& content) {
  const SceneFolder folder;
  return refusal([&] { read_mesh_file(folder.write(name, content)); });
}

TEST(FuzzFindings, MessageGoesOnAfterANulOfTheInput) {
  EXPECT_THAT(mesh_refusal("m.off", "OFF\n\0\x1b[2J 1 1\n"s),
              AllOf(HasSubstr("m.off:2:1: "), HasSubstr("\\x00\\x1b[2J"), HasSubstr("expected"),
                    Not(HasSubstr("\x1b"))));
}

TEST(FuzzFindings, MessageQuotesALongWordInPart) {
  const std::string message = mesh_refusal("m.off", "OFF\n" + std::string(1000000, 'x') + " 1 1\n");
  EXPECT_LT(message.size(), 5000u);
  EXPECT_THAT(message, AllOf(HasSubstr("m.off:2:1: "), HasSubstr("xxx ["), HasSubstr(" characters] xxx")));
}

TEST(FuzzFindings, WhatIsCutOutOfAMessageLeavesCharactersWhole) {
  for (std::size_t before = 0; before < 8; ++before) {
    std::string text(before, 'a');
    for (int k = 0; k < 3000; ++k) text += "\u20ac";  // three bytes
    const std::string cut = shown(text);
    const std::size_t gap = cut.find(" [");
    ASSERT_NE(gap, std::string::npos);
    EXPECT_EQ((gap - before) % 3, 0u);
    EXPECT_EQ((cut.size() - cut.find("] ") - 2) % 3, 0u);
  }
}

/// A netCDF file of 60 bytes whose only attribute claims 1.9 GB.
std::string greedy_netcdf() {
  return "CDF\1"s + "\0\0\0\0"s                              // no records
         + "\0\0\0\0\0\0\0\0"s                               // no dimensions
         + "\0\0\0\x0c\0\0\0\1"s                             // one attribute
         + "\0\0\0\1a\0\0\0"s + "\0\0\0\2\x74\x6f\x6e\x65"s  // 'a', of characters, as many as "tone" says
         + "text"s + "\0\0\0\0\0\0\0\0"s;
}

TEST(FuzzFindings, ClassicNetcdfIsMeasuredBeforeItsLibraryBelievesIt) {
  const SceneFolder folder;
  const auto file = folder.write("r.nc", greedy_netcdf());
  std::optional<LocalFrame> frame;
  const auto measured = HasSubstr("r.nc: is cut off or damaged: its netCDF header");
  EXPECT_THAT(refusal([&] {
                RasterTerrain terrain;
                terrain.file = file;
                read_raster(terrain, frame);
              }),
              measured);
  const char* const drivers[] = {"netCDF", nullptr};
  EXPECT_THAT(refusal([&] { open_material_map({file.string()}, GDAL_OF_RASTER, drivers, "netCDF"); }),
              measured);
}

}  // namespace
}  // namespace tubefoot
