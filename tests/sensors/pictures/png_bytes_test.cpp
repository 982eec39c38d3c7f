// SPDX-License-Identifier: GPL-3.0-or-later
#include "sensors/pictures/png_bytes.hpp"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <memory>
#include <stdexcept>

#include "sensors/pictures/image_file.hpp"

namespace tubefoot {
namespace {

struct Decoded {
  OIIO::ImageSpec spec;
  std::vector<std::uint16_t> values;
};

/// Decodes the bytes with libpng, which verifies all checksums.
Decoded decoded(const std::vector<unsigned char>& bytes) {
  OIIO::Filesystem::IOMemReader memory(const_cast<unsigned char*>(bytes.data()), bytes.size());
  const auto input = OIIO::ImageInput::open("picture.png", nullptr, &memory);
  if (!input) throw std::runtime_error(OIIO::geterror());
  Decoded image{input->spec(), {}};
  image.values.resize(image.spec.image_pixels() * 3);
  if (!input->read_image(0, 0, 0, 3, OIIO::TypeDesc::UINT16, image.values.data()))
    throw std::runtime_error(input->geterror());
  return image;
}

/// All values between two codes, and values outside of 0 to 1.
std::vector<float> ramp(std::size_t pixels) {
  std::vector<float> components(3 * pixels);
  for (std::size_t k = 0; k < components.size(); ++k)
    components[k] = -0.01f + 1.02f * static_cast<float>(k) / static_cast<float>(components.size());
  return components;
}

TEST(PngBytes, HoldThePixelsThatOpenImageIoWouldWrite) {
  const int width = 331, height = 271;
  const std::vector<float> components = ramp(std::size_t(width) * height);
  for (const int bits : {8, 16}) {
    const OIIO::ImageSpec spec(width, height, 3, bits == 8 ? OIIO::TypeDesc::UINT8 : OIIO::TypeDesc::UINT16);
    const Decoded theirs = decoded(encoded_image("picture.png", spec, components.data()));
    const Decoded ours = decoded(png_bytes(width, height, components, bits, "a picture"));
    EXPECT_EQ(ours.spec.width, width);
    EXPECT_EQ(ours.spec.height, height);
    EXPECT_EQ(ours.spec.nchannels, 3);
    EXPECT_EQ(ours.spec.format, spec.format);
    EXPECT_EQ(ours.values, theirs.values) << bits << " bits";
    EXPECT_EQ(ours.spec.get_string_attribute("ImageDescription"), "a picture");
  }
}

TEST(PngBytes, SayNothingWhereNothingIsToBeSaidAndNothingHarmful) {
  const std::vector<float> pixel(3, 0.5f);
  EXPECT_EQ(decoded(png_bytes(1, 1, pixel, 8, "")).spec.get_string_attribute("ImageDescription"), "");
  EXPECT_EQ(decoded(png_bytes(1, 1, pixel, 8, "a\x1b[2Jb")).spec.get_string_attribute("ImageDescription"),
            "a\\x1b[2Jb");
}

TEST(PngBytes, RefuseWhatMakesNoPicture) {
  const std::vector<float> two(6);
  EXPECT_NO_THROW(png_bytes(2, 1, two, 8, ""));
  EXPECT_THROW(png_bytes(1, 1, two, 8, ""), std::invalid_argument);
  EXPECT_THROW(png_bytes(0, 1, {}, 8, ""), std::invalid_argument);
  EXPECT_THROW(png_bytes(2, -1, two, 8, ""), std::invalid_argument);
  EXPECT_THROW(png_bytes(2, 1, two, 4, ""), std::invalid_argument);
}

}  // namespace
}  // namespace tubefoot
