// SPDX-License-Identifier: GPL-3.0-or-later
#include "files/file_format.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "files/input_error.hpp"
#include "fixtures/world/read_scenes.hpp"

namespace tubefoot {
namespace {

using namespace std::string_view_literals;

TEST(FileFormat, IsFoundByTheFirstBytesAndNotByTheName) {
  const TestFolder folder;
  const auto format = [&](const std::string& name, std::string_view bytes) {
    return format_of(folder.write(name, std::string(bytes)));
  };
  EXPECT_EQ(format("a.txt", "II*\0rest"sv), FileFormat::geotiff);
  EXPECT_EQ(format("a.txt", "MM\0+rest"sv), FileFormat::geotiff);
  EXPECT_EQ(format("a.bag", "\x89HDF\r\n\x1a\n"sv), FileFormat::bag);
  EXPECT_EQ(format("a.tif", "\x89HDF\r\n\x1a\n"sv), FileFormat::netcdf4);
  EXPECT_EQ(format("a.nc", "CDF\2rest"sv), FileFormat::netcdf_classic);
  EXPECT_EQ(format("a.nc", "CDF\7rest"sv), FileFormat::other);
  EXPECT_EQ(format("a.tif", "\n NCOLS 4\n"sv), FileFormat::ascii_grid);
  EXPECT_EQ(format("a.csv", "ncolss,4\n"sv), FileFormat::other);
  EXPECT_EQ(format("a.nc", "  <!-- --><vrtDATASET>"sv), FileFormat::vrt);
  EXPECT_EQ(format("a.nc", std::string(3000, ' ') + "<VRTDataset"), FileFormat::vrt);
  EXPECT_EQ(format("a.json", "\xef\xbb\xbf{\"type\":1}"sv), FileFormat::geojson);
  EXPECT_EQ(format("a.shp", "\0\0\x27\x0a"sv), FileFormat::shapefile);
  EXPECT_EQ(format("a.gpkg", "SQLite format 3\0"sv), FileFormat::geopackage);
  EXPECT_EQ(format("a.tif", ""), FileFormat::other);
  EXPECT_EQ(format("a.obj", "<?xml version=\"1.0\"?><!-- x -->\n<COLLADA version"sv), FileFormat::collada);
  EXPECT_EQ(format("a.dae", "<xml/>"sv), FileFormat::other);
  EXPECT_EQ(format("a.gltf", "{\"asset\":{}}"sv), FileFormat::gltf);
  EXPECT_EQ(format("a.bin", "glTF\2\0\0\0"sv), FileFormat::gltf_binary);
  EXPECT_EQ(format("a.x", "Kaydara FBX Binary  \0\x1a\0"sv), FileFormat::fbx);
  EXPECT_EQ(format("a.x", "; FBX 7.3.0 project file\n"sv), FileFormat::fbx);
  EXPECT_EQ(format("a.x", "MM\x40\0\0\0\2\0\x0a\0\0\0\3\0\0\0"sv), FileFormat::studio_3ds);
  EXPECT_EQ(format("a.x", "MM\x40\0\0\0\7\0\x0a\0\0\0"sv), FileFormat::other);
}

TEST(FileFormat, OfTwoFormatsAtOnceIsRefused) {
  const TestFolder folder;
  for (const std::string_view bytes :
       {"II*\0 <VRTDataset>"sv, "ncols 4\n<VRTDataset>"sv, "{\"a\":\"<vrtdataset\"}"sv})
    EXPECT_THAT([&] { format_of(folder.write("a", std::string(bytes))); },
                testing::ThrowsMessage<InputError>(testing::HasSubstr("two formats at once")));
}

}  // namespace
}  // namespace tubefoot
