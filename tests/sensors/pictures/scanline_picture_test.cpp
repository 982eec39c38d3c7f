// SPDX-License-Identifier: GPL-3.0-or-later
#include "sensors/pictures/scanline_picture.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numeric>

#include "fixtures/world/recordings.hpp"
#include "sensors/pictures/image_file.hpp"

namespace tubefoot {
namespace {

using testing::HasSubstr;

constexpr int width = 301, height = 77;

OIIO::ImageSpec sixteen_bits() { return OIIO::ImageSpec(1, 1, 1, OIIO::TypeDesc::UINT16); }

TEST(ScanlinePicture, ExrRowByRowIsTheExrAsAWhole) {
  const TestFolder folder;
  std::vector<float> values(width * height);
  std::iota(values.begin(), values.end(), -1000.25f);
  OIIO::ParamValueList attributes;
  attributes.attribute("sensor", "fish");
  write_exr(folder / "whole.exr", width, height, values, attributes);
  ScanlinePicture picture(folder / "rows.exr", width, height, exr_spec(attributes));
  for (int row = 0; row < height; ++row) picture.add_row(values.data() + row * width);
  picture.finish();
  EXPECT_EQ(bytes_of(folder / "rows.exr"), bytes_of(folder / "whole.exr"));
  EXPECT_GT(std::filesystem::file_size(folder / "rows.exr"), 1000u);
}

TEST(ScanlinePicture, PngKeepsEveryBit) {
  const TestFolder folder;
  std::vector<std::uint16_t> values(width * height);
  for (std::size_t k = 0; k < values.size(); ++k) values[k] = static_cast<std::uint16_t>(k * 40503u);
  ScanlinePicture picture(folder / "rows.png", width, height, sixteen_bits());
  for (int row = 0; row < height; ++row) picture.add_row(values.data() + row * width);
  picture.finish();
  auto input = OIIO::ImageInput::open((folder / "rows.png").string());
  ASSERT_TRUE(input);
  EXPECT_EQ(input->spec().format, OIIO::TypeDesc::UINT16);
  EXPECT_EQ(input->spec().nchannels, 1);
  std::vector<std::uint16_t> read(values.size());
  ASSERT_TRUE(input->read_image(0, 0, 0, 1, OIIO::TypeDesc::UINT16, read.data()));
  EXPECT_EQ(read, values);
}

TEST(ScanlinePicture, IsGoneUnlessFinished) {
  const TestFolder folder;
  const std::vector<std::uint16_t> row(width);
  for (const int rows : {0, 1, 2}) {
    {
      ScanlinePicture picture(folder / "part.png", width, 2, sixteen_bits());
      for (int k = 0; k < rows; ++k) picture.add_row(row.data());
      if (rows < 2) {
        EXPECT_THROW(picture.finish(), std::logic_error);
      } else {
        EXPECT_THROW(picture.add_row(row.data()), std::logic_error);
      }
    }
    EXPECT_FALSE(std::filesystem::exists(folder / "part.png")) << rows;
  }
}

TEST(ScanlinePicture, SaysThatTheDiskIsFullAndLeavesNothing) {
  const TestFolder folder;
  for (const std::string name : {"full.png", "full.exr"}) {
    const OIIO::ImageSpec spec = name == "full.png" ? sixteen_bits() : exr_spec({});
    const samples::FullDisk disk(20000);
    const std::string said = samples::failure_naming(folder / name, [&] {
      ScanlinePicture picture(folder / name, width, 1000, spec);
      std::vector<float> row(width);
      for (int k = 0; k < 1000; ++k) {
        for (std::size_t i = 0; i < row.size(); ++i)
          row[i] = static_cast<float>((i * 2654435761u + k * 97u) % 65536);
        picture.add_row(row.data());
      }
      picture.finish();
    });
    EXPECT_THAT(said, HasSubstr("File too large"));
    EXPECT_FALSE(std::filesystem::exists(folder / name));
  }
}

}  // namespace
}  // namespace tubefoot
