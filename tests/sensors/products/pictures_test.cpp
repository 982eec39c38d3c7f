// SPDX-License-Identifier: GPL-3.0-or-later
// Tests the pictures of recordings: positions of echoes in fans and waterfalls, colour scales, sequences,
// received pictures, and surfaces beyond the seabed.

#include "sensors/products/pictures.hpp"

#include <OpenImageIO/imageio.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <numeric>
#include <random>
#include <set>
#include <thread>

#include "fixtures/world/recordings.hpp"
#include "geometry/steps/steps.hpp"
#include "sensors/kinds/kind_didson.hpp"
#include "sensors/pictures/camera_animation.hpp"
#include "sensors/pictures/camera_picture.hpp"
#include "sensors/pictures/decibel_scale.hpp"
#include "sensors/pictures/waterfall_picture.hpp"
#include "sensors/recordings/recording.hpp"
#include "sensors/recordings/sensor_kind.hpp"

namespace tubefoot {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

struct Image {
  OIIO::ImageSpec spec;
  std::vector<float> values;
  float at(int x, int y, int channel) const {
    return values[(std::size_t(y) * spec.width + x) * spec.nchannels + channel];
  }
};

Image read(const std::filesystem::path& file) {
  auto input = OIIO::ImageInput::open(file.string());
  if (!input) throw std::logic_error(OIIO::geterror());
  Image image{input->spec(), {}};
  image.values.resize(std::size_t(image.spec.width) * image.spec.height * image.spec.nchannels);
  if (!input->read_image(0, 0, 0, image.spec.nchannels, OIIO::TypeDesc::FLOAT, image.values.data()))
    throw std::logic_error(input->geterror());
  return image;
}

Image read(const Canvas& canvas) {
  const TestFolder folder;
  canvas.write_png(folder / "picture.png", "", 16);
  return read(folder / "picture.png");
}

/// Middle of the pixels in which two pictures differ, weighted by the difference.
struct Spot {
  double x = 0, y = 0;
  int pixels = 0;
};

Spot difference(const Image& a, const Image& b) {
  EXPECT_EQ(a.spec.width, b.spec.width);
  EXPECT_EQ(a.spec.height, b.spec.height);
  Spot spot;
  double weight = 0;
  for (int y = 0; y < a.spec.height; ++y) {
    for (int x = 0; x < a.spec.width; ++x) {
      const double change = std::abs(a.at(x, y, 1) - b.at(x, y, 1));
      if (change < 1e-3) continue;
      spot.x += change * (x + 0.5);
      spot.y += change * (y + 0.5);
      weight += change;
      ++spot.pixels;
    }
  }
  spot.x /= weight;
  spot.y /= weight;
  return spot;
}

/// Position of one echo, without labels.
Spot camera_spot(std::size_t beam, std::size_t sample, const SensorDescription& camera = samples::camera()) {
  auto made = samples::silent(camera, 1);
  const Image before = read(draw_camera_frame(made.recording, 0, ""));
  made.energy(0, beam, sample) = 1e-9;
  return difference(before, read(draw_camera_frame(made.recording, 0, "")));
}

std::vector<std::filesystem::path> camera_pictures(const std::filesystem::path& folder,
                                                   const Recording& recording,
                                                   const std::optional<ReceiverOutput>& receiver_output,
                                                   const PictureSettings& settings = {}) {
  std::vector<std::string> warnings;
  return write_fan_pictures(folder, recording, receiver_output, settings, PictureSettings::Which::all,
                            warnings);
}

std::vector<std::filesystem::path> sidescan_pictures(const std::filesystem::path& folder,
                                                     const Recording& recording,
                                                     const std::optional<ReceiverOutput>& receiver_output,
                                                     const PictureSettings& settings = {}) {
  std::vector<std::string> warnings;
  return write_two_sided_pictures(folder, recording, receiver_output, settings, warnings);
}

TEST(CameraPicture, IsATrueFanWithPortLeftAndForwardUp) {
  const auto sensor = make_sensor(samples::camera());
  const double azimuth = sensor->beams()[70].azimuth_rad;
  const double near = 0.84 + 200.5 * 5 / 512, far = 0.84 + 400.5 * 5 / 512;
  const Spot starboard_near = camera_spot(70, 200), starboard_far = camera_spot(70, 400),
             port_near = camera_spot(25, 200);
  EXPECT_GT(starboard_near.x, port_near.x);
  EXPECT_LT(starboard_far.y, starboard_near.y);
  EXPECT_GT(starboard_near.pixels, 4);
  // Along the beam: direction and scale. Across: the mirrored beam at the same range and scale.
  const double right = starboard_far.x - starboard_near.x, up = starboard_near.y - starboard_far.y;
  EXPECT_NEAR(std::atan2(right, up), azimuth, 2e-3);
  const double pixels_per_m = std::hypot(right, up) / (far - near);
  EXPECT_NEAR(starboard_near.x - port_near.x, 2 * near * std::sin(azimuth) * pixels_per_m, 0.6);
  EXPECT_NEAR(starboard_near.y, port_near.y, 0.3);
}

TEST(CameraPicture, ShowsTheCellsAreaAtItsRange) {
  const Spot near = camera_spot(4, 2, samples::camera(8, 16)),
             far = camera_spot(4, 14, samples::camera(8, 16));
  const double ratio = (0.84 + 14.5 * 5 / 16) / (0.84 + 2.5 * 5 / 16);
  EXPECT_NEAR(double(far.pixels) / near.pixels, ratio, 0.1 * ratio);
}

TEST(CameraPicture, FansOfAnyWidthAreDrawn) {
  for (const double horizontal_deg : {0.3, 29.0, 130.0, 200.0, 360.0}) {
    SensorDescription description = samples::camera(horizontal_deg < 1 ? 1 : 24, 16);
    description.kind.edit<DidsonDescription>().horizontal_deg = horizontal_deg;
    auto made = samples::silent(description, 1);
    std::fill(made.energies.begin(), made.energies.end(), 1e-9);
    const Canvas canvas = draw_camera_frame(made.recording, 0, label_font());
    EXPECT_LE(canvas.width(), 2000);
    EXPECT_LE(canvas.height(), 1300);
  }
}

/// Position of one echo of a sidescan, without labels: 60 pings, 0.5 m apart.
Spot waterfall_spot(std::size_t ping, std::size_t beam, std::size_t sample) {
  auto made = samples::silent(samples::sidescan(), 60);
  const Image before = read(Waterfall(made.recording, "").draw());
  for (std::size_t k = 0; k < 10; ++k) made.energy(ping, beam, sample + k) = 1e-9;
  return difference(before, read(Waterfall(made.recording, "").draw()));
}

TEST(Waterfall, HasPortLeftTheLastPingOnTopAndEqualScales) {
  const Spot port_late = waterfall_spot(50, 0, 400), starboard_late = waterfall_spot(50, 1, 400);
  const Spot port_early = waterfall_spot(10, 0, 400), port_far = waterfall_spot(50, 0, 800);
  EXPECT_LT(port_late.x, starboard_late.x);
  EXPECT_LT(port_late.y, port_early.y);
  EXPECT_LT(port_far.x, port_late.x);
  EXPECT_NEAR(port_late.y, starboard_late.y, 1e-9);
  const double pixels_per_m = (port_early.y - port_late.y) / (40 * 0.5);
  EXPECT_NEAR((port_late.x - port_far.x) / (400 * 49.5 / 1000), pixels_per_m, 0.02 * pixels_per_m);
  // Slant range counts from the track: the sides are mirror images.
  const double range_m = 0.5 + 405 * 49.5 / 1000;
  EXPECT_NEAR(starboard_late.x - port_late.x, 2 * range_m * pixels_per_m, 2);
}

TEST(Waterfall, IsDrawnForASensorAtRestAndForASinglePing) {
  auto made = samples::silent(samples::sidescan(20), 1);
  made.energy(0, 1, 10) = 1e-9;
  EXPECT_GE(Waterfall(made.recording, label_font()).draw().height(), 240);
  auto rest = samples::silent(samples::sidescan(20), 5);
  for (Pose& pose : rest.recording.ping_pose) pose = Pose{};
  EXPECT_GE(Waterfall(rest.recording, label_font()).draw().height(), 240);
}

TEST(Waterfall, AveragesPingsThatShareARow) {
  // 20000 pings 0.1 mm apart: 240 rows. An echo in every second ping must not give a moire pattern with the
  // rows.
  auto made = samples::silent(samples::sidescan(2), 20000);
  for (std::size_t ping = 0; ping < 20000; ++ping) {
    made.recording.ping_pose[ping].position_m.y = 1e-4 * double(ping);
    for (const std::size_t beam : {0u, 1u})
      for (const std::size_t sample : {0u, 1u}) made.energy(ping, beam, sample) = ping % 2 ? 2e-9 : 0;
  }
  const Image image = read(Waterfall(made.recording, "").draw());
  const int x = image.spec.width / 4;
  for (int y = image.spec.height / 3; y < image.spec.height / 2; ++y)
    EXPECT_NEAR(image.at(x, y, 1), image.at(x, image.spec.height / 2, 1), 0.02);
}

TEST(Pictures, CameraFilesHoldTheFloats) {
  const TestFolder folder;
  auto made = samples::silent(samples::camera(5, 7), 2);
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> decades(-30, 3);
  for (double& energy : made.energies) energy = std::pow(10, decades(random));
  made.energy(1, 2, 3) = 0;
  EXPECT_THAT(camera_pictures(folder.path(), made.recording, {}),
              ElementsAre("camera-sequence.png", "camera-0000.png", "camera-0000.exr", "camera-0001.png",
                          "camera-0001.exr"));
  for (const std::size_t ping : {0u, 1u}) {
    const Image exr = read(folder / ("camera-000" + std::to_string(ping) + ".exr"));
    ASSERT_EQ(exr.spec.width, 5);
    ASSERT_EQ(exr.spec.height, 7);
    ASSERT_EQ(exr.spec.nchannels, 1);
    EXPECT_EQ(exr.spec.format, OIIO::TypeDesc::FLOAT);
    EXPECT_EQ(exr.spec.get_string_attribute("sensor"), "camera");
    EXPECT_EQ(exr.spec.get_int_attribute("ping"), int(ping));
    EXPECT_FLOAT_EQ(exr.spec.get_float_attribute("slant_range_first_m"), 0.84f);
    for (std::size_t beam = 0; beam < 5; ++beam)
      for (std::size_t sample = 0; sample < 7; ++sample)
        EXPECT_EQ(std::bit_cast<std::uint32_t>(exr.at(int(beam), int(sample), 0)),
                  std::bit_cast<std::uint32_t>(float(made.energy(ping, beam, sample))));
  }
  const Image png = read(folder / "camera-0001.png");
  EXPECT_EQ(png.spec.format, OIIO::TypeDesc::UINT8);
  EXPECT_EQ(png.spec.nchannels, 3);
}

TEST(Pictures, HaveSixteenBitsWhereTheyAreRequested) {
  const TestFolder folder;
  auto made = samples::silent(samples::camera(5, 40), 1);
  for (std::size_t k = 0; k < made.energies.size(); ++k) made.energies[k] = 1e-9 * std::pow(1.07, double(k));
  camera_pictures(folder.path(), made.recording, {}, {.bits = 16});
  const Image fine = read(folder / "camera-0000.png");
  EXPECT_EQ(fine.spec.format, OIIO::TypeDesc::UINT16);
  camera_pictures(folder.path(), made.recording, {});
  const Image coarse = read(folder / "camera-0000.png");
  ASSERT_EQ(coarse.spec.format, OIIO::TypeDesc::UINT8);
  ASSERT_EQ(coarse.spec.width, fine.spec.width);
  double largest = 0;
  for (int y = 0; y < fine.spec.height; ++y)
    for (int x = 0; x < fine.spec.width; ++x)
      largest = std::max(largest, double(std::abs(fine.at(x, y, 0) - coarse.at(x, y, 0))));
  EXPECT_GT(largest, 0.2 / 255) << "16 bits tell no more than 8";
  EXPECT_LT(largest, 0.6 / 255);
}

TEST(Pictures, AreThoseThatAreRequested) {
  using Which = PictureSettings::Which;
  const auto camera = samples::silent(samples::camera(5, 7), 3);
  const auto sidescan = samples::silent(samples::sidescan(6), 4);
  const auto files = [](const Recording& recording, Which which) {
    const TestFolder folder;
    std::vector<std::string> warnings;
    RunContext run;
    run.pictures.which = which;
    std::vector<std::filesystem::path> named =
        kind_of(recording.sensor->description()).write_products(folder.path(), recording, run, warnings);
    std::ranges::sort(named);
    std::vector<std::string> names;
    for (const auto& name : named) names.push_back(name.string());
    EXPECT_EQ(names_below(folder.path()), (std::set<std::string>{names.begin(), names.end()}));
    return names;
  };
  EXPECT_THAT(files(camera.recording, Which::none), ElementsAre());
  EXPECT_THAT(files(camera.recording, Which::sequence), ElementsAre("camera-sequence.png"));
  EXPECT_EQ(files(camera.recording, Which::all).size(), 7u);
  // Files of amplitudes remain. A line has no pictures by ping.
  EXPECT_THAT(files(sidescan.recording, Which::none), Not(Contains(HasSubstr(".png"))));
  EXPECT_THAT(files(sidescan.recording, Which::none), Not(Contains(HasSubstr(".exr"))));
  EXPECT_EQ(files(sidescan.recording, Which::sequence), files(sidescan.recording, Which::all));
  EXPECT_THAT(files(sidescan.recording, Which::all), Contains("sidescan-waterfall.png"));
}

TEST(Pictures, TellHowManyOfThemThereAreWhileTheyAreDrawn) {
  const auto camera = samples::silent(samples::camera(5, 7), 60);
  std::atomic<bool> over = false;
  std::size_t most_done = 0, total = 0;
  std::thread onlooker([&] {
    while (!over)
      if (const auto at_hand = Steps::at_hand(); at_hand && std::string(at_hand->what) == "pictures") {
        most_done = std::max(most_done, at_hand->done);
        total = at_hand->total;
      }
  });
  const TestFolder folder;
  std::vector<std::string> warnings;
  RunContext run;
  run.pictures.which = PictureSettings::Which::all;
  EXPECT_NO_THROW(kind_of(camera.recording.sensor->description())
                      .write_products(folder.path(), camera.recording, run, warnings));
  over = true;
  onlooker.join();
  EXPECT_EQ(total, 60u);
  EXPECT_GT(most_done, 0u);
  EXPECT_LE(most_done, 60u);
  EXPECT_FALSE(Steps::at_hand());
}

/// Frames of a GIF: their sizes, and their display times in hundredths of a second.
struct Frames {
  std::vector<OIIO::ImageSpec> specs;
  std::vector<std::vector<float>> pixels;
};

Frames frames_of(const std::filesystem::path& file) {
  Frames frames;
  const auto input = OIIO::ImageInput::open(file.string());
  if (!input) throw std::runtime_error("no GIF: " + file.string());
  for (int k = 0; input->seek_subimage(k, 0); ++k) {
    frames.specs.push_back(input->spec());
    const OIIO::ImageSpec& spec = frames.specs.back();
    frames.pixels.emplace_back(std::size_t(spec.width) * std::size_t(spec.height) *
                               std::size_t(spec.nchannels));
    input->read_image(k, 0, 0, spec.nchannels, OIIO::TypeDesc::FLOAT, frames.pixels.back().data());
  }
  return frames;
}

TEST(Pictures, AnAnimationShowsPingAfterPingAsFastAsTheyWere) {
  const TestFolder folder;
  auto made = samples::silent(samples::camera(8, 16), 4);
  for (std::size_t ping = 0; ping < 4; ++ping) {
    made.recording.ping_time_s[ping] = 0.25 * double(ping);
    for (std::size_t beam = 0; beam < 8; ++beam)
      for (std::size_t k = 0; k < 16; ++k) made.energy(ping, beam, k) = ping == 2 ? 1e-6 : 1e-10;
  }
  EXPECT_THAT(camera_pictures(folder.path(), made.recording, {},
                              {.which = PictureSettings::Which::sequence, .animated = true}),
              ElementsAre("camera-sequence.png", "camera-sequence.gif"));
  const Frames frames = frames_of(folder / "camera-sequence.gif");
  ASSERT_EQ(frames.specs.size(), 4u);
  std::vector<double> bright;
  for (std::size_t k = 0; k < 4; ++k) {
    EXPECT_EQ(frames.specs[k].width, frames.specs[0].width);
    EXPECT_EQ(frames.specs[k].height, frames.specs[0].height);
    bright.push_back(std::accumulate(frames.pixels[k].begin(), frames.pixels[k].end(), 0.0) /
                     double(frames.pixels[k].size()));
  }
  // On a common scale the strong ping is bright. The others, 40 dB below it, are equally dark.
  EXPECT_GT(bright[2], bright[1] + 0.1);
  EXPECT_NEAR(bright[1], bright[3], 0.02);
  // Blocks with the display time of a frame: 21 F9 04, flags, hundredths of a second.
  const std::string bytes = bytes_of(folder / "camera-sequence.gif");
  std::vector<int> shown;
  for (std::size_t at = 0; (at = bytes.find("\x21\xf9\x04", at)) != std::string::npos; ++at)
    shown.push_back(static_cast<unsigned char>(bytes[at + 4]) +
                    256 * static_cast<unsigned char>(bytes[at + 5]));
  EXPECT_THAT(shown, ElementsAre(25, 25, 25, 25));
  EXPECT_THAT(bytes, HasSubstr("NETSCAPE2.0")) << "it ends after its last frame";
}

TEST(Pictures, AnAnimationShowsTwoHundredPingsAtMost) {
  EXPECT_EQ(animation_frames(150).size(), 150u);
  const std::vector<std::size_t> many = animation_frames(1000);
  ASSERT_EQ(many.size(), 200u);
  EXPECT_EQ(many.front(), 0u);
  EXPECT_EQ(many.back(), 999u);
}

TEST(Pictures, SequencesShowTwentyPingsAtMostTheFirstAndTheLastAmongThem) {
  EXPECT_THAT(sequence_frames(1), ElementsAre(0u));
  EXPECT_THAT(sequence_frames(3), ElementsAre(0u, 1u, 2u));
  const std::vector<std::size_t> many = sequence_frames(1000);
  ASSERT_EQ(many.size(), 20u);
  EXPECT_EQ(many.front(), 0u);
  EXPECT_EQ(many.back(), 999u);
  for (std::size_t k = 0; k + 1 < many.size(); ++k) EXPECT_NEAR(double(many[k + 1] - many[k]), 999.0 / 19, 1);
}

TEST(Pictures, ASequenceIsOnOneScale) {
  auto made = samples::silent(samples::camera(8, 16), 7);
  for (std::size_t ping = 0; ping < 7; ++ping)
    for (std::size_t beam = 0; beam < 8; ++beam)
      for (std::size_t k = 0; k < 16; ++k) made.energy(ping, beam, k) = ping == 5 ? 1e-6 : 1e-9;
  const Image sheet = read(draw_camera_sequence(made.recording, ""));
  // Two rows, of five and of two: the brightest colour is that of ping 5, the first of the second row.
  int left = sheet.spec.width, right = 0, top = sheet.spec.height;
  for (int y = 0; y < sheet.spec.height; ++y)
    for (int x = 0; x < sheet.spec.width * 3 / 4; ++x)
      if (sheet.at(x, y, 2) > 0.6) {
        left = std::min(left, x);
        right = std::max(right, x);
        top = std::min(top, y);
      }
  EXPECT_LT(right, sheet.spec.width / 4);
  EXPECT_GT(top, sheet.spec.height / 2);
  EXPECT_GT(right - left, 100);
}

TEST(Pictures, ACameraMayAskForItsSequenceAlone) {
  const TestFolder folder;
  SensorDescription description = samples::camera(5, 7);
  description.kind.edit<DidsonDescription>().pictures = "sequence";
  const auto made = samples::silent(description, 3);
  std::vector<std::string> warnings;
  EXPECT_THAT(kind_of(description).write_products(folder.path(), made.recording, {}, warnings),
              ElementsAre("camera-sequence.png"));
}

/// Root-mean-square difference of the green of adjacent pixels, from a part of the width of a picture on.
double roughness_of(const Image& image, double from) {
  double sum = 0;
  int pixels = 0;
  const int left = static_cast<int>(image.spec.width * from), right = left + image.spec.width / 10;
  for (int y = image.spec.height * 2 / 5; y < image.spec.height * 3 / 5; ++y)
    for (int x = left; x < right; ++x, ++pixels)
      sum += std::pow(image.at(x + 1, y, 1) - image.at(x, y, 1), 2);
  return std::sqrt(sum / pixels);
}

/// A camera and a sidescan with uniform energies: their received pictures have speckle.
TEST(Pictures, WhatTheInstrumentShowsLiesBesideTheIdealPicture) {
  const TestFolder plain, both;
  for (const bool camera : {true, false}) {
    auto made = samples::silent(camera ? samples::camera(20, 40) : samples::sidescan(40), 2);
    for (double& energy : made.energies) energy = 1e-9;
    const Recording& recording = made.recording;
    ReceiverOutput receiver_output;
    receiver_output.said = "as received, with speckle";
    receiver_output.energy_of = [&](std::size_t ping) {
      std::vector<double> energies(recording.cells());
      std::mt19937 random(static_cast<unsigned>(ping) + 1);
      std::exponential_distribution<double> speckle(1);
      for (double& energy : energies) energy = 1e-9 * speckle(random);
      return energies;
    };
    const auto pictures_of = camera ? camera_pictures : sidescan_pictures;
    pictures_of(plain.path(), recording, {}, {});
    const auto files = pictures_of(both.path(), recording, receiver_output, {});
    const std::vector<std::pair<std::string, std::string>> pairs =
        camera ? std::vector<std::pair<std::string, std::string>>{{"camera-sequence.png",
                                                                   "camera-sequence-received.png"},
                                                                  {"camera-0000.png",
                                                                   "camera-0000-received.png"},
                                                                  {"camera-0001.png",
                                                                   "camera-0001-received.png"}}
               : std::vector<std::pair<std::string, std::string>>{{"sidescan.png", "sidescan-received.png"}};
    for (const auto& [ideal, received] : pairs) {
      SCOPED_TRACE(received);
      EXPECT_THAT(files, Contains(std::filesystem::path(received)));
      EXPECT_EQ(bytes_of(both / ideal), bytes_of(plain / ideal));
      const Image a = read(both / ideal), b = read(both / received);
      const double from = ideal.starts_with("camera-0") ? 0.35 : 0.15;
      EXPECT_GT(roughness_of(b, from), 1.3 * roughness_of(a, from));
    }
  }
}

TEST(Pictures, SidescanFilesArePingByPingPortTurnedOver) {
  const TestFolder folder;
  auto made = samples::silent(samples::sidescan(6), 4);
  for (std::size_t k = 0; k < made.energies.size(); ++k) made.energies[k] = 1e-12 * double(k + 1) / 3;
  EXPECT_THAT(sidescan_pictures(folder.path(), made.recording, {}),
              ElementsAre("sidescan.png", "sidescan.exr"));
  const Image exr = read(folder / "sidescan.exr");
  ASSERT_EQ(exr.spec.width, 12);
  ASSERT_EQ(exr.spec.height, 4);
  for (std::size_t ping = 0; ping < 4; ++ping) {
    for (std::size_t k = 0; k < 6; ++k) {
      EXPECT_EQ(exr.at(int(5 - k), int(ping), 0), float(made.energy(ping, 0, k)));
      EXPECT_EQ(exr.at(int(6 + k), int(ping), 0), float(made.energy(ping, 1, k)));
    }
  }
  EXPECT_EQ(read(folder / "sidescan.png").spec.format, OIIO::TypeDesc::UINT8);
}

TEST(Pictures, AreTheSameByteForByteAtAnotherTime) {
  const TestFolder a, b;
  auto made = samples::silent(samples::camera(5, 7), 1);
  made.energy(0, 2, 3) = 1e-9;
  const auto files = camera_pictures(a.path(), made.recording, {});
  // EXR files may contain the second of their creation
  std::this_thread::sleep_for(std::chrono::milliseconds(1100));
  camera_pictures(b.path(), made.recording, {});
  for (const auto& file : files) EXPECT_EQ(bytes_of(a / file.string()), bytes_of(b / file.string())) << file;
}

TEST(Pictures, NameTheFileThatCannotBeWritten) {
  const TestFolder folder;
  auto made = samples::silent(samples::camera(5, 7), 1);
  const auto fails_in = [&](const std::filesystem::path& where, const char* file) {
    return samples::failure_naming(where / file, [&] { camera_pictures(where, made.recording, {}); });
  };
  EXPECT_THAT(fails_in(folder / "absent", "camera-0000.png"), HasSubstr("No such file"));
  fails_in("/proc", "camera-0000.png");
  for (const char* name : {"camera-0000.png", "camera-0000.exr"}) {
    std::filesystem::create_symlink("/dev/full", folder / name);
    EXPECT_THAT(fails_in(folder.path(), name), HasSubstr("No space left"));
    std::filesystem::remove(folder / name);
  }
  for (const auto room : {0u, 300u, 2000u}) {
    const TestFolder small;
    const samples::FullDisk full(room);
    EXPECT_THROW(camera_pictures(small.path(), made.recording, {}), std::runtime_error);
    EXPECT_FALSE(std::filesystem::exists(small / "camera-0000.png")) << "room for " << room << " bytes";
  }
}

TEST(Pictures, RefuseANameThatLeadsElsewhere) {
  const TestFolder folder;
  for (const char* name : {"", ".", "..", "../camera", "a/b"}) {
    SensorDescription description = samples::camera(2, 3);
    description.name = name;
    const auto made = samples::silent(description, 1);
    EXPECT_THROW(camera_pictures(folder.path(), made.recording, {}), std::runtime_error) << name;
  }
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

TEST(Pictures, AreLabelledWhereThereIsAFont) {
  auto made = samples::silent(samples::camera(5, 7), 1);
  EXPECT_EQ(find_font({"NoSuchFontAnywhere"}), "");
  const TestFolder folder;
  std::vector<std::string> warnings;
  write_fan_pictures(folder.path(), made.recording, {}, {}, PictureSettings::Which::all, warnings);
  if (label_font().empty()) {
    EXPECT_THAT(warnings, ElementsAre(HasSubstr("fonts-dejavu-core")));
    GTEST_SKIP() << "no font is installed";
  }
  EXPECT_THAT(warnings, testing::IsEmpty());
  Canvas plain(200, 40, {}, ""), labelled(200, 40, {}, label_font());
  for (Canvas* canvas : {&plain, &labelled}) canvas->text(10, 20, "Caf\u00e9 -10\u00b0", 20, {1, 1, 1});
  EXPECT_GT(difference(read(plain), read(labelled)).pixels, 100);
}

/// The colour of a pixel of a picture.
Colour colour_at(const Image& image, double x, double y) {
  const int column = static_cast<int>(x), row = static_cast<int>(y);
  return {image.at(column, row, 0), image.at(column, row, 1), image.at(column, row, 2)};
}

void expect_colour(Colour found, Colour wanted, const std::string& what) {
  constexpr double sixteen_bits = 2e-4;
  EXPECT_NEAR(found.red, wanted.red, sixteen_bits) << what;
  EXPECT_NEAR(found.green, wanted.green, sixteen_bits) << what;
  EXPECT_NEAR(found.blue, wanted.blue, sixteen_bits) << what;
}

/// Beyond the surfaces of a beam there is neither echo nor shadow, unless the beam receives energy there.
TEST(Pictures, ShowWhereABeamHasNoSurfaceAnyMore) {
  const std::size_t beams = 8, samples = 16;
  auto made = samples::silent(samples::camera(int(beams), int(samples)), 1);
  for (std::size_t beam = 0; beam < beams; ++beam) made.energy(0, beam, 3) = 1e-6;
  made.energy(0, 5, 14) = 1e-6;
  const Spot shadow = camera_spot(5, 8, samples::camera(int(beams), int(samples))),
             beyond = camera_spot(5, 12, samples::camera(int(beams), int(samples))),
             echo = camera_spot(5, 14, samples::camera(int(beams), int(samples)));
  const Image before = read(draw_camera_frame(made.recording, 0, ""));
  made.recording.surfaces = [&](std::size_t) { return std::vector<int>(beams, 10); };
  const Image image = read(draw_camera_frame(made.recording, 0, ""));
  const Colour dark = palette.no_echo;
  // Grid lines lie over the fan: the tested points are next to them.
  expect_colour(colour_at(before, beyond.x, beyond.y), dark, "nobody knows");
  expect_colour(colour_at(image, shadow.x, shadow.y), dark, "shadow");
  expect_colour(colour_at(image, beyond.x, beyond.y), palette.beyond, "beyond");
  expect_colour(colour_at(image, echo.x, echo.y), DecibelScale::at_level(1), "an echo from beyond");
  EXPECT_GT(std::abs(palette.beyond.green - dark.green), 0.2);

  auto line = samples::silent(samples::sidescan(20), 40);
  for (std::size_t ping = 0; ping < 40; ++ping) line.energy(ping, 0, 5) = line.energy(ping, 1, 5) = 1e-9;
  // Port has surfaces up to its 15th range bin, starboard up to the last.
  line.recording.surfaces = [](std::size_t) { return std::vector<int>{15, 20}; };
  const Image waterfall = read(Waterfall(line.recording, "").draw());
  const int left = 28 + 72, middle = left + 300, y = waterfall.spec.height / 2;
  const auto x_of = [&](double sample) { return (0.5 + sample * 49.5 / 20) / 50 * 300; };
  expect_colour(colour_at(waterfall, middle - x_of(17.3), y), palette.beyond, "port, beyond");
  expect_colour(colour_at(waterfall, middle - x_of(13.3), y), dark, "port, shadow");
  expect_colour(colour_at(waterfall, middle + x_of(17.3), y), dark, "starboard, shadow");
}

/// The gain acts in decibels of the scale, for each picture.
TEST(Pictures, ADisplayGainBrightensFansToo) {
  SensorDescription description = samples::camera(8, 16);
  const Spot spot = camera_spot(5, 8, description);
  for (const double gain_db : {0.0, 12.0, -7.0}) {
    description.signal.display_gain_db = gain_db;
    auto made = samples::silent(description, 1);
    std::ranges::fill(made.energies, 1e-9);
    for (std::size_t beam = 0; beam < 8; ++beam) made.energy(0, beam, 8) = 1e-11;  // 20 dB below the rest
    expect_colour(colour_at(read(draw_camera_frame(made.recording, 0, "")), spot.x, spot.y),
                  DecibelScale::at_level(1 + (gain_db - 20) / DecibelScale::range_db),
                  "gain " + std::to_string(gain_db));
    const Image sheet = read(draw_camera_sequence(made.recording, ""));
    const Colour wanted = DecibelScale::at_level(1 + (gain_db - 20) / DecibelScale::range_db);
    int pixels = 0;
    for (int y = 110; y < 340; ++y)
      for (int x = 30; x < 180; ++x) {
        const Colour found = colour_at(sheet, x, y);
        pixels += std::abs(found.red - wanted.red) + std::abs(found.green - wanted.green) < 1e-3;
      }
    EXPECT_GT(pixels, 100) << "gain " << gain_db;
  }
}

TEST(DecibelScale, IsRelativeToTheStrongestThousandthOfTheEchoes) {
  std::vector<double> energies(20000, 0.0);  // bins without echo do not count
  for (int k = 0; k < 10000; ++k) energies[k] = k < 9980 ? 1e-12 : 1e-3;
  EXPECT_EQ(DecibelScale(energies).reference_j(), 1e-3);
  for (int k = 0; k < 10000; ++k) energies[k] = k < 9995 ? 1e-12 : 1e-3;
  const DecibelScale scale(energies);
  EXPECT_EQ(scale.reference_j(), 1e-12);
  EXPECT_EQ(scale.level(1e-3), 1);
  EXPECT_EQ(scale.level(1e-12), 1);
  EXPECT_NEAR(scale.level(1e-14), 0.6, 1e-12);  // -20 of -50 dB
  EXPECT_EQ(scale.level(1e-17 * 0.99), 0);
  EXPECT_EQ(scale.level(0), 0);
  EXPECT_EQ(scale.level(std::nan("")), 0);
  EXPECT_EQ(DecibelScale(std::vector<double>(10, 0.0)).level(0), 0);
  EXPECT_NEAR(DecibelScale(energies, 10).level(1e-14), 0.8, 1e-12);  // a display gain of 10 dB
  EXPECT_NEAR(DecibelScale(energies, -10).level(1e-12), 0.8, 1e-12);
}

TEST(DecibelScale, NoEchoAndAWeakEchoHaveDifferentColours) {
  const auto distance = [](Colour a, Colour b) {
    return std::abs(a.red - b.red) + std::abs(a.green - b.green) + std::abs(a.blue - b.blue);
  };
  const DecibelScale scale(std::vector<double>{1e-9});
  expect_colour(scale.colour(0), palette.no_echo, "no echo");
  expect_colour(scale.colour(1e-9 * 1e-30), DecibelScale::at_level(0),
                "an echo below the range of the scale");
  for (int k = 0; k <= 100; ++k)
    EXPECT_GT(distance(DecibelScale::at_level(k / 100.0), palette.no_echo), 0.15) << k;
  EXPECT_GT(distance(palette.beyond, palette.no_echo), 0.3);
}

TEST(DecibelScale, GrowsLighterEverywhere) {
  const auto luminance = [](Colour c) { return 0.2126 * c.red + 0.7152 * c.green + 0.0722 * c.blue; };
  for (int k = 1; k <= 100; ++k)
    EXPECT_GT(luminance(DecibelScale::at_level(k / 100.0)),
              luminance(DecibelScale::at_level((k - 1) / 100.0)));
}

TEST(Ticks, AreRoundNumbersOverAnyExtent) {
  EXPECT_DOUBLE_EQ(tick_step(5, 6), 1);
  EXPECT_DOUBLE_EQ(tick_step(50, 5), 10);
  EXPECT_DOUBLE_EQ(tick_step(0.13, 5), 0.05);
  EXPECT_DOUBLE_EQ(tick_step(100, 4), 50);
  EXPECT_THAT(ticks(0.84, 5.84, 1), ElementsAre(1, 2, 3, 4, 5));
  EXPECT_THAT(ticks(-50, 0, 10), testing::SizeIs(6));
  std::vector<std::string> labels;
  for (const double tick : ticks(-0.1, 0.1, 0.05)) labels.push_back(tick_label(tick, 0.05));
  EXPECT_THAT(labels, ElementsAre("-0.10", "-0.05", "0.00", "0.05", "0.10"));
  EXPECT_EQ(tick_label(20, 10), "20");
}

}  // namespace
}  // namespace tubefoot
