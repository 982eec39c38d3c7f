// SPDX-License-Identifier: GPL-3.0-or-later
// Tests the conversion of one serialized message (.cdr) to a picture: byte orders, encodings, directions,
// and damaged messages.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "files/input_error.hpp"
#include "files/usage_error.hpp"
#include "fixtures/refusal.hpp"
#include "fixtures/test_folder.hpp"
#include "import/bags/bag.hpp"
#include "recordings.hpp"

namespace tubefoot {
namespace {

using namespace recordings;
using testing::Contains;
using testing::DoubleNear;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::Pointwise;

class Messages : public testing::Test {
 protected:
  ForeignData read(const Bytes& bytes, const std::optional<std::string>& type = std::nullopt) {
    return read_bag(folder.write("m.cdr", bytes), type);
  }
  ForeignFrame frame(const Bytes& bytes, const std::optional<std::string>& type = std::nullopt) {
    return read(bytes, type).frames.at(0);
  }
  void refused(const Bytes& bytes, const std::string& type, const std::string& what) {
    expect_refused<InputError>([&] { read(bytes, type); }, what);
  }

  TestFolder folder;
};

TEST_F(Messages, AProjectedImageIsReadInBothByteOrders) {
  for (const bool big : {false, true})
    for (const char* name : {"", "a", "abc", "abcd", "abcdefg"}) {  // shifts the aligned fields after it
      SCOPED_TRACE(std::string(big ? "big " : "little ") + name);
      Sonar sonar = small_sonar();
      sonar.big_endian = big;
      sonar.frame_id = name;
      const ForeignFrame read = frame(projected(sonar));
      EXPECT_EQ(read.rows, 3u);
      EXPECT_EQ(read.columns, 4u);
      EXPECT_THAT(read.values, ElementsAre(0, 1, 2, 3, 10, 11, 12, 13, 20, 21, 22, 23));
      EXPECT_TRUE(read.eight_bits);
      EXPECT_THAT(read.range_m, ElementsAre(1, 1.5, 2, 2.5));
      EXPECT_THAT(read.azimuth_rad,
                  ElementsAre(DoubleNear(-0.1, 1e-15), DoubleNear(0, 1e-15), DoubleNear(0.1, 1e-15)));
      EXPECT_EQ(read.time_s, 100.25);
    }
}

template <class T>
Bytes raw(std::initializer_list<T> values, bool big) {
  Bytes bytes;
  for (const T value : values) {
    char each[sizeof value];
    std::memcpy(each, &value, sizeof value);
    if (big != (std::endian::native == std::endian::big)) std::reverse(each, each + sizeof each);
    bytes.append(each, sizeof each);
  }
  return bytes;
}

TEST_F(Messages, EveryTypeOfNumberIsReadInBothByteOrders) {
  Sonar sonar;
  sonar.beams = 1;
  for (const bool big : {false, true}) {
    sonar.big_endian_data = big;
    const auto values = [&](std::uint32_t dtype, const Bytes& data) {
      sonar.dtype = dtype;
      sonar.data = data;
      return frame(projected(sonar)).values;
    };
    EXPECT_THAT(values(0, raw<std::uint8_t>({0, 200, 255}, big)), ElementsAre(0, 200, 255));
    EXPECT_THAT(values(1, raw<std::int8_t>({-128, 0, 127}, big)), ElementsAre(-128, 0, 127));
    EXPECT_THAT(values(2, raw<std::uint16_t>({1, 65535}, big)), ElementsAre(1, 65535));
    EXPECT_THAT(values(3, raw<std::int16_t>({-2, 32767}, big)), ElementsAre(-2, 32767));
    EXPECT_THAT(values(4, raw<std::uint32_t>({1, 4294967295u}, big)), ElementsAre(1, 4294967295.0));
    EXPECT_THAT(values(5, raw<std::int32_t>({-3, 2147483647}, big)), ElementsAre(-3, 2147483647.0));
    EXPECT_THAT(values(6, raw<std::uint64_t>({1ull << 40}, big)), ElementsAre(1099511627776.0));
    EXPECT_THAT(values(7, raw<std::int64_t>({-(1ll << 40)}, big)), ElementsAre(-1099511627776.0));
    EXPECT_THAT(values(8, raw<float>({0.25f, -1e30f}, big)), ElementsAre(0.25, static_cast<double>(-1e30f)));
    EXPECT_THAT(values(9, raw<double>({0.1, 1e300}, big)), ElementsAre(0.1, 1e300));
  }
  sonar.dtype = 2;
  sonar.data = raw<std::uint16_t>({1}, false);
  sonar.big_endian_data = false;
  EXPECT_FALSE(frame(projected(sonar)).eight_bits);
}

TEST_F(Messages, DirectionsOfDaveAreTakenAsDavesAndTold) {
  Sonar sonar = small_sonar();
  sonar.directions.clear();
  for (const double azimuth : {-0.2, 0.1, 0.4})
    sonar.directions.insert(sonar.directions.end(), {std::cos(azimuth), std::sin(azimuth), 0});
  const ForeignData data = read(projected(sonar));
  const ForeignFrame& read = data.frames.at(0);
  EXPECT_EQ(read.rows, 4u);  // samples
  EXPECT_EQ(read.columns, 3u);
  EXPECT_THAT(read.values, ElementsAre(0, 1, 2, 3, 10, 11, 12, 13, 20, 21, 22, 23)) << "as stored";
  EXPECT_THAT(read.azimuth_rad,
              ElementsAre(DoubleNear(-0.2, 1e-15), DoubleNear(0.1, 1e-15), DoubleNear(0.4, 1e-15)));
  EXPECT_THAT(data.noticed, Contains(HasSubstr("DAVE")));
}

TEST_F(Messages, TwoBeamsAbeamAreNoDave) {
  Sonar sonar = small_sonar();
  sonar.beams = 2;
  sonar.data.resize(8);
  sonar.directions = {0, -1, 0, 0, 1, 0};  // z is 0, and both lie in the plane of the message
  const ForeignData data = read(projected(sonar));
  EXPECT_EQ(data.frames.at(0).rows, 2u);
  EXPECT_THAT(data.frames.at(0).azimuth_rad, ElementsAre(-M_PI / 2, M_PI / 2));
  EXPECT_THAT(data.noticed, Not(Contains(HasSubstr("DAVE"))));
}

TEST_F(Messages, WhatIsNotReportedIsTold) {
  Sonar sonar = small_sonar();
  sonar.directions.clear();
  sonar.ranges.clear();
  sonar.sec = sonar.nanosec = 0;
  const ForeignData data = read(projected(sonar));
  EXPECT_THAT(data.frames.at(0).range_m, IsEmpty());
  EXPECT_THAT(data.frames.at(0).azimuth_rad, IsEmpty());
  EXPECT_EQ(data.frames.at(0).time_s, std::nullopt);
  EXPECT_THAT(data.noticed, Contains(HasSubstr("the messages have no ranges")));
  EXPECT_THAT(data.noticed, Contains(HasSubstr("give the azimuths with --azimuths")));
  sonar = small_sonar();
  sonar.dtype = 8;
  sonar.ranges = {1};
  sonar.data =
      raw<float>({1, std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}, false);
  EXPECT_THAT(read(projected(sonar)).noticed, Contains("2 of 3 values are not finite"));
  sonar = small_sonar();
  sonar.directions[0] = 0.5;  // a beam above the plane
  EXPECT_THAT(read(projected(sonar)).noticed,
              Contains(HasSubstr("deviate from the plane of the fan by up to")));
}

Bytes raw_image(float rate, float speed, std::uint32_t each, std::uint32_t first,
                const std::vector<float>& angles, const Bytes& data, std::uint32_t beams) {
  return Cdr()
      .number(std::int32_t{5})
      .number(std::uint32_t{0})
      .text("raw")
      .number(0.0f)
      .number(speed)
      .list<float>({})
      .list<float>({})
      .number(rate)
      .number(each)
      .number(first)
      .list<float>({})
      .list<float>({})
      .list(angles)
      .number(std::uint8_t{0})
      .number(std::uint32_t{0})
      .number(beams)
      .bytes(data)
      .done();
}

TEST_F(Messages, ARawImageHasTheRangesOfItsSamples) {
  const ForeignFrame read = frame(raw_image(1000, 1500, 3, 10, {-0.5f, 0.5f}, "abcdef", 2));
  EXPECT_EQ(read.rows, 2u);
  EXPECT_EQ(read.columns, 3u);
  EXPECT_THAT(read.values, ElementsAre('a', 'b', 'c', 'd', 'e', 'f'));
  EXPECT_THAT(read.range_m, ElementsAre(7.5, 8.25, 9.0));  // (sample + 10) 1500 / 2000
  EXPECT_THAT(read.azimuth_rad, ElementsAre(-0.5, 0.5));
  const ForeignData no_speed = this->read(raw_image(1000, 0, 3, 0, {}, "abcdef", 2));
  EXPECT_THAT(no_speed.frames.at(0).range_m, IsEmpty());
  EXPECT_THAT(no_speed.noticed, Contains(HasSubstr("give the ranges with --ranges")));
  refused(raw_image(1000, 1500, 4, 0, {}, "abcdef", 2), raw_type, "samples_per_beam is 4");
  refused(raw_image(1000, 1500, 3, 0, {0.1f}, "abcdef", 2), raw_type, "rx_angles has 1 entries");
}

TEST_F(Messages, ACameraImageIsReadInItsEncodings) {
  EXPECT_THAT(frame(camera_image(2, 2, "mono8", 2, "abcd")).values, ElementsAre('a', 'b', 'c', 'd'));
  EXPECT_THAT(frame(camera_image(2, 2, "mono8", 3, "ab.cd.")).values, ElementsAre('a', 'b', 'c', 'd'))
      << "rows are padded";
  EXPECT_TRUE(frame(camera_image(2, 2, "mono8", 2, "abcd")).eight_bits);
  for (const bool big : {false, true}) {
    EXPECT_THAT(frame(camera_image(1, 2, "mono16", 4, raw<std::uint16_t>({258, 3}, big), big)).values,
                ElementsAre(258, 3));
    EXPECT_THAT(frame(camera_image(1, 2, "32FC1", 8, raw<float>({0.5f, -2}, big), big, true)).values,
                ElementsAre(0.5, -2));
  }
  EXPECT_EQ(frame(camera_image(1, 1, "mono8", 1, "a")).time_s, 7.5);
  for (const char* colours : {"rgb8", "bgr8", "8UC3"}) {
    const ForeignData grey = read(camera_image(1, 2, colours, 6, Bytes("aaabbb")));
    EXPECT_THAT(grey.frames.at(0).values, ElementsAre('a', 'b'));
    EXPECT_TRUE(grey.frames.at(0).eight_bits);
    EXPECT_THAT(grey.noticed, Contains(HasSubstr("all of them are grey")));
  }
  EXPECT_THAT(frame(camera_image(1, 2, "rgba8", 8, Bytes("aaaXbbbY"))).values, ElementsAre('a', 'b'));
  refused(camera_image(1, 2, "rgb8", 6, Bytes("aaaabc")), image_type,
          "pixel 1 of row 0 has a colour (97, 98, 99)");
  refused(camera_image(1, 2, "yuv422", 4, "abcd"), image_type, "encoding is 'yuv422', expected one of mono8");
}

TEST_F(Messages, CountsThatLieAreRefused) {
  const auto with = [](const auto& change) {
    Sonar sonar = small_sonar();
    change(sonar);
    return projected(sonar);
  };
  refused(with([](Sonar& s) { s.beams = 0; }), projected_type, "image.beam_count is 0");
  refused(with([](Sonar& s) { s.beams = 5; }), projected_type, "image.data has 12 bytes");
  refused(with([](Sonar& s) { s.beams = 4'000'000'000u; }), projected_type, "4000000000 beams");
  refused(with([](Sonar& s) { s.dtype = 10; }), projected_type, "image.dtype is 10");
  refused(with([](Sonar& s) { s.dtype = 9; }), projected_type, "float64 values for each of 3 beams");
  refused(with([](Sonar& s) { s.data.clear(); }), projected_type, "image.data has 0 samples");
  refused(with([](Sonar& s) { s.ranges.pop_back(); }), projected_type, "the number of ranges is 3");
  refused(with([](Sonar& s) { s.directions.resize(6); }), projected_type, "beam_directions has 2 entries");
  refused(with([](Sonar& s) { s.directions[1] = s.directions[2] = 0; }), projected_type,
          "entry 0 is (0, 0, 0)");
  refused(with([](Sonar& s) { s.directions[1] = NAN; }), projected_type, "which is not a direction");
  refused(with([](Sonar& s) { s.ranges[2] = INFINITY; }), projected_type, "ranges: entry 2 is inf");
  refused(camera_image(2, 2, "mono8", 1, "ab"), image_type,
          "step is 1 bytes, but a row of 2 pixels of 'mono8' has 2");
  refused(camera_image(3, 2, "mono8", 2, "abcd"), image_type,
          "data has 4 bytes, but 3 rows of 2 bytes have 6");
  refused(camera_image(0xffffffff, 0xffffffff, "mono8", 0xffffffff, "ab"), image_type,
          "but a ping has at most");
  refused(camera_image(0, 5, "mono8", 5, ""), image_type, "has no samples");
}

/// A list that claims 2^32 - 1 entries is rejected before memory is allocated.
TEST_F(Messages, HugeListsAreRefusedBeforeAnythingIsAllocated) {
  const auto begin = [] {
    Cdr cdr;
    cdr.number(std::int32_t{1}).number(std::uint32_t{0}).text("").number(1.0f).number(1.0f);
    return cdr;
  };
  refused(begin().number(0xffffffffu).done(), projected_type,
          "ping_info.tx_beamwidths: needs 17179869180 bytes");
  refused(begin().list<float>({}).list<float>({}).number(0xffffffffu).done(), projected_type,
          "beam_directions: has 4294967295 entries");
  refused(Cdr().number(std::int32_t{1}).number(std::uint32_t{0}).number(0xffffffffu).done(), projected_type,
          "header.frame_id: needs 4294967295 bytes");
}

TEST_F(Messages, CutAtEveryLengthAMessageIsRefused) {
  const Bytes whole[] = {projected(small_sonar()), raw_image(1000, 1500, 3, 10, {-0.5f, 0.5f}, "abcdef", 2),
                         camera_image(2, 2, "mono8", 2, "abcd")};
  const char* const types[] = {projected_type, raw_type, image_type};
  for (int k = 0; k < 3; ++k)
    for (std::size_t length = 0; length < whole[k].size(); ++length) {
      SCOPED_TRACE(length);
      EXPECT_THROW(read(whole[k].substr(0, length), types[k]), InputError);
      EXPECT_THROW(read(whole[k].substr(0, length)), InputError);
    }
}

TEST_F(Messages, WhatIsSerializedOtherwiseOrGoesOnIsRefused) {
  Bytes message = projected(small_sonar());
  EXPECT_NO_THROW(read(message + Bytes(3, '\0'))) << "transports fill up words";
  refused(message + Bytes(8, '\0'), projected_type, "8 bytes follow its last field");
  for (const char kind : {'\2', '\3', '\7', '\x0b'}) {  // parameter lists, XCDR2
    message[1] = kind;
    refused(message, projected_type, "is another serialization");
  }
  Bytes text = projected(small_sonar());
  text[4 + 8 + 4 + 5] = 'x';  // the end of "sonar"
  refused(text, projected_type, "header.frame_id: is a text that does not end with a zero byte");
}

TEST_F(Messages, ATypeIsFoundByItselfOrGiven) {
  EXPECT_THAT(read(projected(small_sonar())).noticed, Contains(HasSubstr("the only type that fits")));
  EXPECT_THAT(read(projected(small_sonar()), "marine_acoustic_msgs/ProjectedSonarImage").frames,
              testing::SizeIs(1));
  refused(projected(small_sonar()), image_type, "is not a message that tubefoot reads");
  expect_refused<UsageError>([&] { read(projected(small_sonar()), "/sonar"); }, "--topic must give its type");
}

TEST_F(Messages, TheListsOfHoloOceanAreNoPicture) {
  const Bytes lists = Cdr()
                          .number(std::int64_t{1})
                          .number(std::int32_t{2})
                          .number(std::int32_t{3})
                          .list<float>({1, 2})
                          .list<float>({1, 2, 3})
                          .done();
  refused(lists, "holoocean_interfaces/msg/ImagingSonar",
          "two lists (image_azimuth with 2 entries, image_range with 3)");
}

}  // namespace
}  // namespace tubefoot
