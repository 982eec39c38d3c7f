// SPDX-License-Identifier: GPL-3.0-or-later
// Tests the files of sidescans: waterfalls, XTF and mosaics with their codes, positions, lines and
// warnings.

#include <OpenImageIO/imageio.h>
#include <gdal_priv.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <glm/gtc/quaternion.hpp>

#include "fixtures/packet_reader.hpp"
#include "fixtures/world/recordings.hpp"
#include "geometry/numbers/scalars.hpp"
#include "sensors/kinds/kind_sidescan.hpp"
#include "sensors/products/two_sided_files.hpp"

namespace tubefoot {
namespace {

using samples::file_content;
using samples::PacketReader;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

/// 20 range bins of 0.5 m from 1 m on, 4 m above the seabed, 0.5 m from ping to ping.
samples::OwnedRecording line(int pings = 9, const SignalDescription& signal = {}) {
  SensorDescription description = samples::sidescan(20);
  description.signal = signal;
  auto& fan = description.kind.edit<SidescanDescription>();
  fan.range_min_m = 1;
  fan.range_max_m = 11;
  auto made = samples::silent(description, pings);
  made.recording.altitude_m.assign(static_cast<std::size_t>(pings), 4.0);
  for (std::size_t k = 0; k < made.energies.size(); ++k)
    made.energies[k] = 1e-9 * double(1 + k * 7919 % 1000);
  return made;
}

constexpr TwoSidedWidths widths{0.5, 83};

RunContext at_sea() {
  RunContext run;
  run.frame = LocalFrame::at_lat_lon(48.25, -4.5, 10);
  run.start_unix_s = 1735689600;
  return run;
}

std::vector<std::uint16_t> waterfall_of(const std::filesystem::path& file, int& width, int& height) {
  auto input = OIIO::ImageInput::open(file.string());
  if (!input) throw std::runtime_error("no picture " + file.string());
  width = input->spec().width;
  height = input->spec().height;
  std::vector<std::uint16_t> pixels(std::size_t(width) * height);
  input->read_image(0, 0, 0, 1, OIIO::TypeDesc::UINT16, pixels.data());
  return pixels;
}

/// Code of a sample by its definition: 65535 is the largest amplitude, and amplitudes are square roots of
/// energies.
unsigned code(double energy, double largest) {
  return static_cast<unsigned>(std::floor(65535 * std::sqrt(energy / largest) + 0.5));
}

TEST(SidescanFiles, WaterfallHasARowAPingPortLeftAndTheLoudestSampleWhite) {
  const TestFolder folder;
  auto made = line();
  std::vector<std::string> warnings;
  write_two_sided_files(folder.path(), made.recording, at_sea(), widths, warnings);
  EXPECT_THAT(warnings, IsEmpty());
  int width = 0, height = 0;
  const auto pixels = waterfall_of(folder / "sidescan-waterfall.png", width, height);
  EXPECT_EQ(width, 40);
  EXPECT_EQ(height, 9);
  const double largest = *std::max_element(made.energies.begin(), made.energies.end());
  for (std::size_t ping = 0; ping < 9; ++ping)
    for (std::size_t k = 0; k < 20; ++k) {
      EXPECT_NEAR(pixels[ping * 40 + 19 - k], code(made.energy(ping, 0, k), largest), 1) << ping << " " << k;
      EXPECT_NEAR(pixels[ping * 40 + 20 + k], code(made.energy(ping, 1, k), largest), 1) << ping << " " << k;
    }
  EXPECT_EQ(*std::max_element(pixels.begin(), pixels.end()), 65535);
}

TEST(SidescanFiles, ASpecularReturnIsWhiteInTheWaterfallAndTheFullScaleOfTheXtf) {
  const TestFolder folder;
  auto made = line();
  std::fill(made.energies.begin(), made.energies.end(), 1e-12);
  made.energy(3, 1, 5) = 1e-4;  // 80 dB above the seabed
  std::vector<std::string> warnings;
  write_two_sided_files(folder.path(), made.recording, at_sea(), widths, warnings);
  int width = 0, height = 0;
  const auto pixels = waterfall_of(folder / "sidescan-waterfall.png", width, height);
  EXPECT_EQ(pixels[3 * 40 + 25], 65535);
  // 360 samples: the specular return raises the mean level by 80 / 360 dB.
  EXPECT_NEAR(pixels[0], 65535 * std::pow(10, -(15 + 80.0 / 360) / 20), 2);
  const std::string xtf = bytes_of(folder / "sidescan.xtf");
  EXPECT_NE(xtf.find(std::string("\7\0\7\0\7\0\xff\xff\7", 9)), std::string::npos);  // 65535 * 1e-4 is 6.6
}

TEST(SidescanFiles, XtfHasAttitudeNavigationAndSamplesOfEachPing) {
  const TestFolder folder;
  auto made = line();
  for (std::size_t k = 0; k < 9; ++k)
    made.recording.ping_pose[k].attitude = attitude_from_angles(30 * degree, 2 * degree, -3 * degree);
  std::vector<std::string> warnings;
  write_two_sided_files(folder.path(), made.recording, at_sea(), widths, warnings);
  const auto bytes = file_content(folder / "sidescan.xtf");
  const std::span<const unsigned char> all(bytes);
  PacketReader header(all.first(1024), false);
  EXPECT_EQ(header.text(18, 16), "sidescan");
  EXPECT_EQ(header.u32(256 + 8), 22u);
  EXPECT_EQ(header.f32(256 + 32), 455);
  EXPECT_NEAR(header.f32(256 + 40), 43.5, 1e-4);  // tilt
  EXPECT_EQ(header.f32(256 + 44), 83);            // height of the fan
  const double largest = *std::max_element(made.energies.begin(), made.energies.end());
  std::vector<unsigned> types;
  std::size_t ping = 0;
  for (std::size_t begin = 1024; begin < bytes.size();) {
    PacketReader packet(all.subspan(begin, 14), false);
    const std::size_t size = packet.u32(10);
    PacketReader whole(all.subspan(begin, size), false);
    types.push_back(whole.u8(2));
    if (whole.u8(2) == 3) {
      // A direction that is horizontal here tilts by 4e-5 degrees 4 m from the origin of the frame.
      EXPECT_NEAR(whole.f32(30), 2, 1e-5 + 1e-5 * double(ping));
      EXPECT_NEAR(whole.f32(34), -3, 1e-5 + 1e-5 * double(ping));
      EXPECT_NEAR(whole.f32(50), 30, 1e-5);
    } else if (whole.u8(2) == 42) {
      // A nautical mile of latitude is about 1852 m.
      EXPECT_NEAR((whole.f64(33) - 48.25) * 60 * 1852, 0.5 * double(ping), 0.01 * double(ping) + 1e-6);
      EXPECT_NEAR(whole.f64(41), -4.5, 1e-9);
      // 5 m below a frame at 10 m, whose plane departs from the ellipsoid
      EXPECT_NEAR(whole.f64(49), 5, 1.5e-6);
    } else {
      EXPECT_EQ(whole.u32(28), ping);
      EXPECT_NEAR(whole.f32(120), 5 * 3600 / 1852.0, 1e-4);  // 0.5 m in 0.1 s
      EXPECT_NEAR(whole.f32(192), -5, 1e-5);
      EXPECT_EQ(whole.f32(196), 4);
      EXPECT_NEAR(whole.f32(124), 30, 1e-5);
      for (std::size_t beam = 0; beam < 2; ++beam) {
        const std::size_t channel = 256 + beam * (64 + 44);
        EXPECT_EQ(whole.u16(channel), beam);
        EXPECT_EQ(whole.f32(channel + 4), 11);
        ASSERT_EQ(whole.u32(channel + 42), 22u);  // two empty ones before the first metre
        for (std::size_t k = 0; k < 22; ++k) {
          const unsigned stored = whole.u16(channel + 64 + 2 * (beam == 0 ? 21 - k : k));
          EXPECT_NEAR(stored, k < 2 ? 0 : code(made.energy(ping, beam, k - 2), largest), 1) << k;
        }
      }
      ++ping;
    }
    begin += size;
  }
  EXPECT_EQ(ping, 9u);
  ASSERT_EQ(types.size(), 27u);
  for (std::size_t k = 0; k < 27; ++k) EXPECT_EQ(types[k], (std::array{3u, 42u, 0u}[k % 3]));
}

TEST(SidescanFiles, WithoutAPlaceOnEarthThereIsNoXtfAndAWarningSaysWhatToDo) {
  const TestFolder folder;
  std::vector<std::string> warnings;
  const auto files = write_two_sided_files(folder.path(), line().recording, {}, widths, warnings);
  EXPECT_THAT(files, ElementsAre("sidescan-waterfall.png", "sidescan-mosaic.tif", "sidescan-mosaic.png"));
  EXPECT_THAT(warnings, ElementsAre(HasSubstr("add [georeference]")));
  EXPECT_FALSE(std::filesystem::exists(folder / "sidescan.xtf"));
}

TEST(SidescanFiles, WithoutASeabedBelowThereIsNoMosaic) {
  const TestFolder folder;
  for (const bool known_at_first : {true, false}) {
    auto made = line();
    made.recording.altitude_m.assign(9, std::nan(""));
    if (known_at_first) made.recording.altitude_m.front() = 4;
    std::vector<std::string> warnings;
    const auto files = write_two_sided_files(folder.path(), made.recording, at_sea(), widths, warnings);
    EXPECT_EQ(files.size(), known_at_first ? 4u : 2u);
    EXPECT_THAT(warnings.front(), HasSubstr(known_at_first ? "8 of 9 pings" : "9 of 9 pings"));
    EXPECT_EQ(warnings.size(), known_at_first ? 1u : 2u);
  }
}

TEST(SidescanFiles, DatesThatXtfCannotHoldAreAWarning) {
  const TestFolder folder;
  auto made = line();
  made.recording.ping_time_s.front() = -1e10;
  std::vector<std::string> warnings;
  write_two_sided_files(folder.path(), made.recording, at_sea(), widths, warnings);
  EXPECT_THAT(warnings, ElementsAre(HasSubstr("1970 to 2106")));
}

TEST(SidescanFiles, ReceiverIsInTheFilesOfASonar) {
  // Speckle follows the seed of the run: another seed gives other codes, and the same seed the same codes.
  const TestFolder folder;
  SignalDescription signal;
  signal.speckle = "rayleigh";
  const auto codes = [&](std::uint64_t seed) {
    std::vector<std::string> warnings;
    RunContext run = at_sea();
    run.seed = seed;
    write_two_sided_files(folder.path(), line(9, signal).recording, run, widths, warnings);
    return bytes_of(folder / "sidescan-waterfall.png");
  };
  const std::string one = codes(1);
  EXPECT_NE(one, codes(2));
  EXPECT_EQ(one, codes(1));
}

TEST(SidescanFiles, ASilentLineIsBlack) {
  const TestFolder folder;
  auto made = line();
  std::fill(made.energies.begin(), made.energies.end(), 0.0);
  std::vector<std::string> warnings;
  write_two_sided_files(folder.path(), made.recording, at_sea(), widths, warnings);
  int width = 0, height = 0;
  const auto pixels = waterfall_of(folder / "sidescan-waterfall.png", width, height);
  EXPECT_EQ(*std::max_element(pixels.begin(), pixels.end()), 0);
}

TEST(SidescanFiles, AFullDiskLeavesNoFile) {
  const TestFolder folder;
  const samples::FullDisk disk(1500);
  std::vector<std::string> warnings;
  EXPECT_THROW(write_two_sided_files(folder.path(), line(200).recording, at_sea(), widths, warnings),
               std::runtime_error);
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

TEST(SidescanFiles, MosaicCellsFollowPingsAndSamplesAndStayFew) {
  EXPECT_DOUBLE_EQ(mosaic_cell_m(line().recording), 2);  // three range bins of 0.5 m, rounded up
  auto sparse = line();
  for (std::size_t k = 0; k < 9; ++k) sparse.recording.ping_pose[k].position_m.y = 4.0 * double(k);
  EXPECT_DOUBLE_EQ(mosaic_cell_m(sparse.recording), 5);
  auto long_line = samples::silent(samples::sidescan(1000), 3);
  for (std::size_t k = 0; k < 3; ++k) long_line.recording.ping_pose[k].position_m.y = 5e5 * double(k);
  const double area = 1e6 * 100, cell = mosaic_cell_m(long_line.recording);
  EXPECT_LE(area / cell / cell, 4e6);
}

TEST(SidescanFiles, ASurveyHasAnXtfAndAMosaicALineAndOneMosaicOfAll) {
  const TestFolder folder;
  auto made = line();
  made.recording.line_starts = {0, 5};
  for (std::size_t k = 5; k < 9; ++k) {
    made.recording.ping_pose[k].position_m.x = 40;
    made.recording.ping_time_s[k] += 60;
  }
  std::vector<std::string> warnings;
  const auto files = write_two_sided_files(folder.path(), made.recording, at_sea(), widths, warnings);
  EXPECT_THAT(warnings, IsEmpty());
  EXPECT_THAT(files, ElementsAre("sidescan-line-01.xtf", "sidescan-line-02.xtf", "sidescan-waterfall.png",
                                 "sidescan-mosaic.tif", "sidescan-mosaic.png", "sidescan-line-01-mosaic.tif",
                                 "sidescan-line-01-mosaic.png", "sidescan-line-02-mosaic.tif",
                                 "sidescan-line-02-mosaic.png"));
  for (const auto& file : files) EXPECT_TRUE(std::filesystem::exists(folder / file.string())) << file;
  std::size_t ping = 0;
  for (const auto& [name, pings] :
       {std::pair("sidescan-line-01.xtf", 5u), std::pair("sidescan-line-02.xtf", 4u)}) {
    const auto bytes = file_content(folder / name);
    std::size_t in_file = 0;
    for (std::size_t begin = 1024; begin < bytes.size();) {
      PacketReader packet(std::span<const unsigned char>(bytes).subspan(begin), false);
      if (packet.u8(2) == 0) {
        EXPECT_EQ(packet.u32(28), ping++);
        // the distance across the turn does not count as speed
        EXPECT_NEAR(packet.f32(120), 5 * 3600 / 1852.0, 1e-4);
        ++in_file;
      }
      begin += packet.u32(10);
    }
    EXPECT_EQ(in_file, pings) << name;
  }
  EXPECT_NEAR(made.recording.track_length_m(), 7 * 0.5, 1e-12);
  EXPECT_NEAR(made.recording.ping_spacing_m(), 0.5, 1e-12);
}

TEST(SidescanFiles, ASensorAtRestHasNoMosaicAndTheReasonIsReported) {
  const auto written = [](const Recording& recording, std::string& said) {
    const TestFolder folder;
    std::vector<std::string> warnings;
    const auto files = write_two_sided_files(folder.path(), recording, at_sea(), widths, warnings);
    // Warnings that do not depend on echoes have the same text before the run.
    EXPECT_EQ(two_sided_files_left_out(recording, at_sea()), warnings);
    said = warnings.empty() ? "" : warnings.front();
    return std::ranges::find(files, std::filesystem::path("sidescan-mosaic.tif")) != files.end() &&
           std::ranges::find(files, std::filesystem::path("sidescan-mosaic.png")) != files.end();
  };
  std::string said;
  auto moving = line();
  EXPECT_TRUE(written(moving.recording, said));
  auto rest = line();
  for (Pose& pose : rest.recording.ping_pose) pose.position_m = {3, 4, -5};
  EXPECT_FALSE(written(rest.recording, said));
  EXPECT_THAT(said, HasSubstr("sidescan-mosaic.tif is not written: the sensor is at rest"));
  EXPECT_THAT(said, HasSubstr("A mosaic needs a sensor that moves or turns"));
  EXPECT_FALSE(written(line(1).recording, said));
  EXPECT_THAT(said, HasSubstr("one ping covers only a line"));
  // A line that turns on the spot covers a circle.
  auto turning = line();
  for (std::size_t k = 0; k < 9; ++k)
    turning.recording.ping_pose[k] = {{0, 0, -5}, glm::angleAxis(0.02 * double(k), glm::dvec3(0, 0, 1))};
  EXPECT_TRUE(written(turning.recording, said));
  EXPECT_EQ(said, "");
}

/// Beyond all surfaces the mosaic has no value. In shadows it has a dark value.
TEST(SidescanFiles, AMosaicHasNoValueWhereThereIsNoSurface) {
  for (const int surfaces : {20, 14}) {
    const TestFolder folder;
    auto made = line();
    for (std::size_t ping = 0; ping < 9; ++ping)
      for (std::size_t beam : {0, 1})
        for (std::size_t k = 12; k < 20; ++k) made.energy(ping, beam, k) = 0;
    made.recording.surfaces = [&](std::size_t) { return std::vector<int>{surfaces, surfaces}; };
    std::vector<std::string> warnings;
    write_two_sided_files(folder.path(), made.recording, at_sea(), widths, warnings);
    GDALAllRegister();
    const std::unique_ptr<GDALDataset> map(
        GDALDataset::Open((folder / "sidescan-mosaic.tif").c_str(), GDAL_OF_RASTER));
    ASSERT_TRUE(map);
    // The middle of the last range bin that may contain a surface, from 4 m above the seabed.
    const double end_m = 1 + 0.5 * surfaces, ground_m = std::sqrt((end_m - 0.25) * (end_m - 0.25) - 16);
    EXPECT_EQ(map->GetRasterXSize(), 2 * std::ceil(ground_m / 2)) << surfaces;
  }
}

TEST(SidescanFiles, DisplayGainBrightensPicturesAndLeavesTheXtf) {
  const TestFolder plain, bright;
  auto made = line();
  std::fill(made.energies.begin(), made.energies.end(), 1e-12);
  SignalDescription signal;
  signal.display_gain_db = -6;
  auto dimmed = line(9, signal);
  std::fill(dimmed.energies.begin(), dimmed.energies.end(), 1e-12);
  std::vector<std::string> warnings;
  write_two_sided_files(plain.path(), made.recording, at_sea(), widths, warnings);
  write_two_sided_files(bright.path(), dimmed.recording, at_sea(), widths, warnings);
  EXPECT_EQ(bytes_of(plain / "sidescan.xtf"), bytes_of(bright / "sidescan.xtf"));
  int width = 0, height = 0;
  EXPECT_NEAR(waterfall_of(plain / "sidescan-waterfall.png", width, height)[0], 65535, 1);
  EXPECT_NEAR(waterfall_of(bright / "sidescan-waterfall.png", width, height)[0], 65535 * std::pow(10, -0.3),
              1);
}

}  // namespace
}  // namespace tubefoot
