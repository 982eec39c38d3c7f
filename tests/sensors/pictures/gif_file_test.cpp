// SPDX-License-Identifier: GPL-3.0-or-later
// Tests of animations: OpenImageIO decodes exactly the pixels of frames of few colours. Frames of many
// colours are closer to the original than those of OpenImageIO's own encoder.
#include "sensors/pictures/gif_file.hpp"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tbb/parallel_for.h>

#include <cmath>
#include <random>
#include <set>

#include "fixtures/test_folder.hpp"

namespace tubefoot {
namespace {

using Pixels = std::vector<std::uint32_t>;

/// Frames of a GIF as OpenImageIO shows them one after the other.
std::vector<Pixels> frames_of(const std::vector<unsigned char>& bytes) {
  const TestFolder folder;
  folder.write("film.gif", std::string(bytes.begin(), bytes.end()));
  const auto input = OIIO::ImageInput::open((folder / "film.gif").string());
  if (!input) throw std::runtime_error("no GIF: " + OIIO::geterror());
  std::vector<Pixels> frames;
  for (int k = 0; input->seek_subimage(k, 0); ++k) {
    const OIIO::ImageSpec& spec = input->spec();
    std::vector<std::uint8_t> values(std::size_t(spec.width) * std::size_t(spec.height) *
                                     std::size_t(spec.nchannels));
    EXPECT_TRUE(input->read_image(k, 0, 0, spec.nchannels, OIIO::TypeDesc::UINT8, values.data()));
    Pixels& frame = frames.emplace_back();
    for (std::size_t p = 0; p < values.size(); p += std::size_t(spec.nchannels))
      frame.push_back(std::uint32_t(values[p] << 16 | values[p + 1] << 8 | values[p + 2]));
  }
  return frames;
}

std::vector<unsigned char> film_of(const std::vector<Pixels>& frames, int width, int delay = 5) {
  GifFile gif(width, int(frames.front().size()) / width, delay);
  for (const Pixels& frame : frames) gif.add(frame, indexed(frame));
  return gif.finish();
}

/// The same frames by the encoder of OpenImageIO.
std::vector<unsigned char> film_of_openimageio(const std::vector<Pixels>& frames, int width) {
  const std::vector<OIIO::ImageSpec> specs(
      frames.size(), OIIO::ImageSpec(width, int(frames.front().size()) / width, 3, OIIO::TypeDesc::UINT8));
  std::vector<unsigned char> bytes;
  OIIO::Filesystem::IOVecOutput memory(bytes);
  const auto output = OIIO::ImageOutput::create("film.gif");
  output->set_ioproxy(&memory);
  for (std::size_t k = 0; k < frames.size(); ++k) {
    std::vector<std::uint8_t> values;
    for (const std::uint32_t pixel : frames[k])
      for (const int shift : {16, 8, 0}) values.push_back(std::uint8_t(pixel >> shift));
    EXPECT_TRUE(k == 0 ? output->open("film.gif", int(specs.size()), specs.data())
                       : output->open("film.gif", specs[k], OIIO::ImageOutput::AppendSubimage));
    EXPECT_TRUE(output->write_image(OIIO::TypeDesc::UINT8, values.data()));
  }
  EXPECT_TRUE(output->close());
  return bytes;
}

double squared_error(const std::vector<Pixels>& a, const std::vector<Pixels>& b) {
  EXPECT_EQ(a.size(), b.size());
  double sum = 0, pixels = 0;
  for (std::size_t k = 0; k < a.size(); ++k) {
    EXPECT_EQ(a[k].size(), b[k].size());
    for (std::size_t p = 0; p < a[k].size(); ++p, ++pixels)
      for (const int shift : {16, 8, 0})
        sum += std::pow(double(a[k][p] >> shift & 255) - double(b[k][p] >> shift & 255), 2);
  }
  return sum / pixels;
}

TEST(GifFile, KeepsTheColoursOfFramesWithFewColours) {
  for (unsigned seed = 0; seed < 12; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937 random(seed);
    const std::size_t width = 1 + random() % 90, height = 1 + random() % 60, colours = 1 + random() % 255;
    Pixels palette(colours);
    for (std::uint32_t& colour : palette) colour = random() & 0xffffff;
    std::vector<Pixels> frames{Pixels(width * height)};
    for (std::uint32_t& pixel : frames[0]) pixel = palette[random() % colours];
    for (int k = 1; k < 6; ++k) {  // some pixels change; in one frame, none do
      frames.push_back(frames.back());
      for (std::size_t changes = k == 3 ? 0 : random() % (width * height); changes > 0; --changes)
        frames.back()[random() % (width * height)] = palette[random() % colours];
    }
    EXPECT_TRUE(frames_of(film_of(frames, int(width))) == frames);
  }
}

TEST(GifFile, IsNearerToFramesOfManyColoursThanADitheredFile) {
  for (unsigned seed = 0; seed < 3; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937 random(seed);
    constexpr int width = 160, height = 120;
    std::vector<Pixels> frames;
    for (int k = 0; k < 4; ++k) {
      Pixels& frame = frames.emplace_back();
      for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
          const double level = 0.5 + 0.5 * std::sin(0.05 * x + 0.03 * y + 0.2 * k + seed);
          const auto part = [&](double power) { return std::uint32_t(255 * std::pow(level, power)); };
          frame.push_back(part(0.6) << 16 | part(1) << 8 | part(2.5));
        }
      for (int dots = 0; dots < 400; ++dots) frame[random() % frame.size()] = random() & 0xffffff;
    }
    const std::vector<unsigned char> own = film_of(frames, width),
                                     dithered = film_of_openimageio(frames, width);
    EXPECT_LT(squared_error(frames_of(own), frames), 0.5 * squared_error(frames_of(dithered), frames));
    EXPECT_LT(own.size(), 1.2 * double(dithered.size()));
  }
}

TEST(GifFile, ReducesColoursToTheMeansOfTheirGroups) {
  Pixels grey;
  for (std::uint32_t k = 0; k < 256; ++k) grey.insert(grey.end(), 1 + k % 3, k << 16 | k << 8 | k);
  const IndexedPicture picture = indexed(grey);
  EXPECT_EQ(picture.colours.size(), 255u);
  std::set<int> wrong;  // one pair of neighbours has a common colour
  for (std::size_t p = 0; p < grey.size(); ++p)
    if (const int off = int(picture.colours.at(picture.pixels[p] - 1u)[0]) - int(grey[p] & 255); off != 0)
      wrong.insert(int(grey[p] & 255));
  EXPECT_LE(wrong.size(), 2u);
  std::vector<IndexedPicture> together(8);
  tbb::parallel_for(0, 8, [&](int k) { together[std::size_t(k)] = indexed(grey); });
  for (const IndexedPicture& other : together) {
    EXPECT_TRUE(other.pixels == picture.pixels);
    EXPECT_TRUE(other.colours == picture.colours);
  }
  EXPECT_TRUE(indexed({}).pixels.empty());
}

TEST(GifFile, RejectsSizesThatTheFormatDoesNotHave) {
  EXPECT_THROW(GifFile(0, 5, 1), GifError);
  EXPECT_THROW(GifFile(5, 65536, 1), GifError);
  GifFile gif(5, 4, 1);
  EXPECT_THROW(gif.add(Pixels(19), indexed(Pixels(19))), GifError);
  EXPECT_THROW(gif.add(Pixels(20), indexed(Pixels(19))), GifError);
}

}  // namespace
}  // namespace tubefoot
