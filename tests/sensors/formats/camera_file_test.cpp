// SPDX-License-Identifier: GPL-3.0-or-later
// Tests the common properties of DIDSON and ARIS files: times and poses, invalid frames, and no partial
// files after errors.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <fstream>
#include <functional>

#include "files/streamed_file.hpp"
#include "fixtures/camera_file_reader.hpp"
#include "fixtures/world/recordings.hpp"
#include "sensors/formats/aris_file.hpp"
#include "sensors/formats/ddf_file.hpp"

namespace tubefoot {
namespace {

using camera_file::Reader;
using ::testing::HasSubstr;

struct Ddf {
  using File = DdfFile;
  static DdfHeader header() {
    DdfHeader made;
    made.sample_rate_hz = ddf_sample_rate_hz(5);
    return made;
  }
};

struct Aris {
  using File = ArisFile;
  static ArisHeader header() { return {}; }
};

template <typename Format>
class CameraFile : public testing::Test {
 protected:
  using File = typename Format::File;

  CameraFile() { frame.amplitudes = picture; }

  /// Writes the file of one frame and reads it back.
  Reader written() {
    File file(path, Format::header());
    file.add(frame);
    file.finish();
    return Reader(path);
  }

  TestFolder folder;
  std::filesystem::path path = folder / "a.ddf";
  std::vector<std::uint8_t> picture = std::vector<std::uint8_t>(96 * 512, 7);
  CameraFrame frame;
};

using Formats = testing::Types<Ddf, Aris>;
TYPED_TEST_SUITE(CameraFile, Formats);

TYPED_TEST(CameraFile, all_parts_of_a_time_are_of_one_instant) {
  struct Case {
    double unix_s, day, hour, minute, second, hundredth;
    std::string date;
  };
  // Known times: rounding to hundredths carries through to the day.
  for (const Case& known : {Case{0, 1, 0, 0, 0, 0, "1970-01-01_000000"},
                            Case{951782399.994, 28, 23, 59, 59, 99, "2000-02-28_235959"},
                            Case{951782399.996, 29, 0, 0, 0, 0, "2000-02-29_000000"},
                            Case{1e9 + 0.12, 9, 1, 46, 40, 12, "2001-09-09_014640"},
                            Case{4294967295, 7, 6, 28, 15, 0, "2106-02-07_062815"}}) {
    this->frame.unix_time_s = known.unix_s;
    const Reader reader = this->written();
    const bool aris = reader.aris;
    EXPECT_EQ(reader.number(0, aris ? "TS_Day" : "Day"), known.day);
    EXPECT_EQ(reader.number(0, aris ? "TS_Hour" : "Hour"), known.hour);
    EXPECT_EQ(reader.number(0, aris ? "TS_Minute" : "Minute"), known.minute);
    EXPECT_EQ(reader.number(0, aris ? "TS_Second" : "Second"), known.second);
    EXPECT_EQ(reader.number(0, aris ? "TS_Hsecond" : "HSecond"), known.hundredth);
    EXPECT_EQ(reader.file_fields().at(aris ? "strDate" : "Date").text, known.date);
    const double time = reader.number(0, "FrameTime");
    if (aris)
      EXPECT_EQ(time, std::round(known.unix_s * 1e6));
    else
      EXPECT_EQ(time, std::floor(known.unix_s + 0.005));
  }
}

TYPED_TEST(CameraFile, headings_lie_from_0_to_360_degrees) {
  for (const auto& [told, kept] : {std::pair{360.0, 0.0},
                                   {-90.0, 270.0},
                                   {730.5, 10.5},
                                   {-1e-9, 0.0},
                                   {359.99999999, 0.0},
                                   {359.5, 359.5}}) {
    this->frame.platform.heading_deg = told;
    const Reader reader = this->written();
    EXPECT_EQ(reader.number(0, "Heading"), kept);
    EXPECT_EQ(reader.number(0, "CompassHeading"), kept);
  }
}

TYPED_TEST(CameraFile, a_bad_frame_is_refused_and_the_file_goes_on_without_it) {
  const double nan = std::nan(""), inf = INFINITY;
  const std::vector<std::uint8_t> short_by_one(96 * 512 - 1), of_48_beams(48 * 512),
      long_by_one(96 * 512 + 1);
  struct Case {
    std::string what;
    std::function<void(CameraFrame&)> spoil;
  };
  std::vector<Case> cases{
      {"49151 amplitudes instead of 49152", [&](CameraFrame& it) { it.amplitudes = short_by_one; }},
      {"24576 amplitudes instead of 49152", [&](CameraFrame& it) { it.amplitudes = of_48_beams; }},
      {"49153 amplitudes instead of 49152", [&](CameraFrame& it) { it.amplitudes = long_by_one; }},
      {"0 amplitudes", [&](CameraFrame& it) { it.amplitudes = {}; }},
      {"time", [&](CameraFrame& it) { it.unix_time_s = -1; }},
      {"time", [&](CameraFrame& it) { it.unix_time_s = 4294967296; }},
      {"latitude", [&](CameraFrame& it) { it.latitude_deg = 90.001; }},
      {"longitude", [&](CameraFrame& it) { it.longitude_deg = -180.001; }},
      {"pitch", [&](CameraFrame& it) { it.platform.pitch_deg = 90.001; }},
      {"roll", [&](CameraFrame& it) { it.platform.roll_deg = 180.001; }},
      {"pitch",
       [&](CameraFrame& it) {
         it.camera = CameraAttitude{0, 91, 0};
       }},
      {"depth", [&](CameraFrame& it) { it.depth_m = 1e300; }},
  };
  for (const double bad : {nan, inf, -inf}) {
    cases.push_back({"time", [=](CameraFrame& it) { it.unix_time_s = bad; }});
    cases.push_back({"latitude", [=](CameraFrame& it) { it.latitude_deg = bad; }});
    cases.push_back({"longitude", [=](CameraFrame& it) { it.longitude_deg = bad; }});
    cases.push_back({"heading", [=](CameraFrame& it) { it.platform.heading_deg = bad; }});
    cases.push_back({"pitch", [=](CameraFrame& it) { it.platform.pitch_deg = bad; }});
    cases.push_back({"roll", [=](CameraFrame& it) { it.platform.roll_deg = bad; }});
    cases.push_back({"heading", [=](CameraFrame& it) { it.camera = CameraAttitude{bad, 0, 0}; }});
    cases.push_back({"roll", [=](CameraFrame& it) { it.camera = CameraAttitude{0, 0, bad}; }});
    cases.push_back({"velocity", [=](CameraFrame& it) { it.velocity_m_s = bad; }});
    cases.push_back({"depth", [=](CameraFrame& it) { it.depth_m = bad; }});
    cases.push_back({"altitude", [=](CameraFrame& it) { it.altitude_m = bad; }});
  }
  typename TestFixture::File file(this->path, TypeParam::header());
  file.add(this->frame);
  for (const Case& bad : cases) {
    CameraFrame spoilt = this->frame;
    bad.spoil(spoilt);
    try {
      file.add(spoilt);
      ADD_FAILURE() << "taken in spite of its " << bad.what;
    } catch (const std::invalid_argument& error) {
      EXPECT_THAT(error.what(), HasSubstr(bad.what));
      EXPECT_THAT(error.what(), HasSubstr(this->path.string() + ": frame 1"));
    }
  }
  file.add(this->frame);
  file.finish();
  const Reader reader(this->path);
  EXPECT_EQ(reader.frames, 2u);
  EXPECT_EQ(reader.number(1, reader.aris ? "FrameIndex" : "FrameNumber"), 1);
}

TYPED_TEST(CameraFile, takes_no_more_frames_than_told) {
  auto header = TypeParam::header();
  header.most_frames = 2;
  typename TestFixture::File file(this->path, header);
  file.add(this->frame);
  file.add(this->frame);
  EXPECT_THROW(file.add(this->frame), std::invalid_argument);
  file.finish();
  EXPECT_EQ(Reader(this->path).frames, 2u);
}

TYPED_TEST(CameraFile, that_is_not_finished_is_gone) {
  {
    typename TestFixture::File file(this->path, TypeParam::header());
    file.add(this->frame);
    EXPECT_TRUE(std::filesystem::exists(this->path));
  }
  EXPECT_FALSE(std::filesystem::exists(this->path));
}

TYPED_TEST(CameraFile, without_a_frame_cannot_be_finished) {
  {
    typename TestFixture::File file(this->path, TypeParam::header());
    EXPECT_THROW(file.finish(), std::logic_error);
  }
  EXPECT_FALSE(std::filesystem::exists(this->path));
}

TYPED_TEST(CameraFile, that_is_finished_takes_nothing_more_and_stays) {
  {
    typename TestFixture::File file(this->path, TypeParam::header());
    file.add(this->frame);
    file.finish();
    EXPECT_THROW(file.add(this->frame), std::logic_error);
    EXPECT_THROW(file.finish(), std::logic_error);
  }
  EXPECT_EQ(Reader(this->path).frames, 1u);
}

TYPED_TEST(CameraFile, equal_frames_give_equal_bytes) {
  this->written();
  const std::string once = bytes_of(this->path);
  this->written();
  EXPECT_EQ(bytes_of(this->path), once);
}

// Sizes at which the disk is full: in a header, in the samples, and in the last block. The last case
// appears only when the library writes its buffer.
TYPED_TEST(CameraFile, a_full_disk_is_reported_and_leaves_nothing) {
  this->written();
  const auto size = std::filesystem::file_size(this->path);
  std::filesystem::remove(this->path);
  for (const auto room : {std::uintmax_t{0}, std::uintmax_t{100}, size / 2, size - 1}) {
    const std::string said = samples::failure_naming(this->path, [&] {
      const samples::FullDisk disk(static_cast<rlim_t>(room));
      typename TestFixture::File file(this->path, TypeParam::header());
      file.add(this->frame);
      file.finish();
    });
    EXPECT_THAT(said, HasSubstr("File too large"));
    EXPECT_FALSE(std::filesystem::exists(this->path)) << room;
  }
  const samples::FullDisk disk(static_cast<rlim_t>(size));
  EXPECT_EQ(this->written().frames, 1u);
}

TYPED_TEST(CameraFile, a_full_device_is_reported_and_not_removed) {
  std::filesystem::create_symlink("/dev/full", this->path);
  const std::string said = samples::failure_naming(this->path, [&] {
    typename TestFixture::File file(this->path, TypeParam::header());
    file.add(this->frame);
    file.finish();
  });
  EXPECT_THAT(said, HasSubstr("No space left on device"));
  EXPECT_TRUE(std::filesystem::is_symlink(this->path));
}

TYPED_TEST(CameraFile, a_missing_folder_is_reported) {
  const auto nowhere = this->folder / "none" / "a.ddf";
  const std::string said =
      samples::failure_naming(nowhere, [&] { typename TestFixture::File(nowhere, TypeParam::header()); });
  EXPECT_THAT(said, HasSubstr("No such file or directory"));
}

/// Returns the result of a Python reader: frames, then column (from the left), range and value of the
/// brightest pixel. Returns an empty list without Python and numpy.
std::vector<double> seen_by_numpy(const TestFolder& folder, const std::filesystem::path& file) {
  const auto answer = folder / "answer";
  for (const std::string python : {"python3", "/usr/bin/python3"}) {
    if (std::system((python + " -c 'import numpy' 2> /dev/null").c_str()) != 0) continue;
    const std::string command = fmt::format("{} '{}/tests/sensors/read_camera_file.py' '{}' > '{}'", python,
                                            TUBEFOOT_SOURCE_DIR, file.string(), answer.string());
    EXPECT_EQ(std::system(command.c_str()), 0);
    break;
  }
  std::ifstream stream(answer);
  return {std::istream_iterator<double>(stream), {}};
}

TEST(CameraFileOracle, numpy_sees_the_target_on_its_side_at_its_range) {
  const TestFolder folder;
  std::vector<std::uint8_t> picture(96 * 512, 7);
  picture[20 * 512 + 300] = 251;  // the 21st beam from port
  CameraFrame frame;
  frame.amplitudes = picture;
  DdfHeader header = Ddf::header();
  header.window = ddf_window(header, 2.1, 5);
  DdfFile file(folder / "a.ddf", header);
  for (int i = 0; i < 3; ++i) file.add(frame);
  file.finish();
  const auto seen = seen_by_numpy(folder, folder / "a.ddf");
  if (seen.empty()) GTEST_SKIP() << "python3 with numpy is not installed";
  EXPECT_THAT(seen, testing::ElementsAre(3, 20, testing::DoubleNear(2.1 + 300.5 * 5 / 512, 1e-9), 251));

  ArisHeader aris = Aris::header();
  aris.sound_speed_m_s = 1480;
  aris.window = {2000, 8};
  ArisFile other(folder / "a.aris", aris);
  for (int i = 0; i < 2; ++i) other.add(frame);
  other.finish();
  EXPECT_THAT(seen_by_numpy(folder, folder / "a.aris"),
              testing::ElementsAre(2, 20, testing::DoubleNear((2000 + 300 * 8) * 1e-6 * 740, 1e-9), 251));
}

// So little data that the library buffers all of it until the file is closed.
TEST(StreamedFile, a_disk_that_fills_with_the_last_block_is_reported_and_leaves_nothing) {
  const TestFolder folder;
  const auto path = folder / "small";
  const std::array<std::uint8_t, 10> bytes{};
  {
    const samples::FullDisk disk(5);
    StreamedFile file(path);
    file.append(bytes);
    EXPECT_THAT(samples::failure_naming(path, [&] { file.close(); }), HasSubstr("File too large"));
    EXPECT_FALSE(std::filesystem::exists(path));
    EXPECT_THROW(file.append(bytes), std::logic_error);
  }
  std::filesystem::create_symlink("/dev/full", path);
  StreamedFile device(path);
  device.append(bytes);
  EXPECT_THAT(samples::failure_naming(path, [&] { device.close(); }), HasSubstr("No space left"));
  EXPECT_TRUE(std::filesystem::is_symlink(path));
}

TEST(PacketBytes, puts_little_endian_bytes_where_told_and_nowhere_else) {
  PacketBytes record(std::endian::little, 40);
  record.put<std::uint8_t>(1, 0xFE);
  record.put<std::uint16_t>(3, 0x0102);
  record.put<std::uint32_t>(6, 0x03040506);
  record.put<std::uint64_t>(11, 0x0708090A0B0C0D0E);
  record.put<std::int32_t>(20, -2);
  record.put_single(25, 1.5);    // 3F C0 00 00
  record.put<double>(30, -2.5);  // C0 04 00 ...
  const std::array<std::uint8_t, 40> wanted{
      0,    0xFE, 0,    2,    1, 0, 6, 5,    4,    3, 0, 0x0E, 0x0D, 0x0C, 0x0B, 0x0A, 9, 8,    7, 0,
      0xFE, 0xFF, 0xFF, 0xFF, 0, 0, 0, 0xC0, 0x3F, 0, 0, 0,    0,    0,    0,    0,    4, 0xC0, 0, 0};
  EXPECT_THAT(record.bytes(), testing::ElementsAreArray(wanted));
}

TEST(PacketBytes, refuses_a_field_outside) {
  PacketBytes record(std::endian::little, 8);
  EXPECT_NO_THROW(record.put<std::uint32_t>(4, 1));
  EXPECT_THROW(record.put<std::uint32_t>(5, 1), std::out_of_range);
  EXPECT_THROW(record.put<std::uint64_t>(1, 1), std::out_of_range);
  EXPECT_THROW(record.put<std::uint8_t>(8, 1), std::out_of_range);
  EXPECT_THROW(record.put<std::uint8_t>(static_cast<std::size_t>(-1), 1), std::out_of_range);
  EXPECT_THROW(record.put_text(0, 9, "x"), std::out_of_range);
}

TEST(PacketBytes, text_is_padded_cut_and_always_terminated) {
  const auto kept = [](std::string_view text) {
    PacketBytes record(std::endian::little, 6);
    record.put_text(0, 6, "******");  // earlier contents are removed
    record.put_text(0, 5, text);
    return std::string(record.bytes().begin(), record.bytes().end());
  };
  using namespace std::string_literals;
  EXPECT_EQ(kept(""), "\0\0\0\0\0\0"s);
  EXPECT_EQ(kept("abcd"), "abcd\0\0"s);
  EXPECT_EQ(kept("abcdefg"), "abcd\0\0"s);
  EXPECT_EQ(kept("abc\u00e9"), "abc\0\0\0"s);  // two bytes, of which one would fit
  EXPECT_EQ(kept("ab\u00e9"), "ab\u00e9\0\0"s);
  EXPECT_EQ(kept("\u20ac\u20ac"), "\u20ac\0\0\0"s);
  EXPECT_EQ(kept("\x80\x80\x80\x80\x80\x80"), "\0\0\0\0\0\0"s);  // no character at all
}

}  // namespace
}  // namespace tubefoot
