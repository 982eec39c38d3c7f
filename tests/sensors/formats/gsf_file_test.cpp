// SPDX-License-Identifier: GPL-3.0-or-later
// Compares GSF files with the tables of the format by an independent reader: each byte is either examined
// or zero.
#include "sensors/formats/gsf_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <functional>
#include <limits>
#include <map>
#include <numbers>
#include <random>

#include "fixtures/packet_reader.hpp"
#include "fixtures/refusal.hpp"
#include "geometry/numbers/scalars.hpp"

namespace tubefoot {
namespace {

using samples::file_content;
using samples::nan;
using samples::PacketReader;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

std::filesystem::path scratch_gsf(const std::string& name) {
  static const TestFolder folder;
  return folder / (name + ".gsf");
}

/// Five beams over a flat bottom 20 m below, the outer ones at 60 degrees. The port-most beam is rejected.
GsfPing five_beams() {
  GsfPing ping;
  ping.unix_time_s = 1735689599.25;
  ping.longitude_deg = -4.5123456;
  ping.latitude_deg = 48.25;
  ping.heading_deg = 271.5;
  ping.pitch_deg = 2.5;
  ping.roll_deg = -3.25;
  ping.heave_m = 0.5;
  ping.course_deg = 270.25;
  ping.speed_m_s = 1852.0 / 3600 * 4;  // 4 knots
  ping.tide_m = -1.25;
  ping.depth_corrector_m = 0.75;
  ping.height_m = 51.125;
  ping.separation_m = -2.5;
  ping.gps_tide_m = 0.125;
  ping.depth_m = {20, 20, 20, 20, 20};
  ping.across_m = {-34.641, -11.547, 0, 11.547, 34.641};
  ping.along_m = {-0.25, 0, 0.25, 0, 0};
  ping.two_way_time_s = {0.0533333, 0.0307920, 0.0266667, 0.0307920, 0.0533333};
  ping.beam_angle_deg = {-60, -30, 0, 30, 60};
  ping.mean_amplitude_db = {-31.25, -28, -12, -28, -31};
  ping.flags = {1, 0, 0, 0, 0};
  return ping;
}

struct GsfRecord {
  unsigned id = 0;
  PacketReader data;
};

/// Returns the records of a file. Throws if one violates the format, or does not end in the file.
std::vector<GsfRecord> records_of(const std::filesystem::path& path, bool checksums = false) {
  const auto bytes = file_content(path);
  const std::span<const unsigned char> all(bytes);
  std::vector<GsfRecord> records;
  const std::size_t head_size = checksums ? 12 : 8;
  for (std::size_t begin = 0; begin < all.size();) {
    if (all.size() - begin < head_size) throw std::runtime_error("a torn record");
    PacketReader head(all.subspan(begin, head_size), true);
    const std::size_t size = head.u32(0);
    const unsigned id = head.u32(4);
    if (size % 4 != 0 || size > all.size() - begin - head_size) throw std::runtime_error("a wrong size");
    if ((id >> 31 != 0) != checksums) throw std::runtime_error("a wrong checksum flag");
    const auto data = all.subspan(begin + head_size, size);
    std::uint32_t sum = 0;
    for (const unsigned char byte : data) sum += byte;
    if (checksums && head.u32(8) != sum) throw std::runtime_error("a wrong checksum");
    records.push_back({id & 0x7FFFFFFF, PacketReader(data, true)});
    begin += head_size + size;
  }
  return records;
}

std::vector<GsfRecord> written(const std::string& name, const GsfOptions& options,
                               const std::function<void(GsfFile&)>& fill) {
  const auto path = scratch_gsf(name);
  {
    GsfFile file(path, options);
    fill(file);
    file.finish();
  }
  auto records = records_of(path, options.checksums);
  std::filesystem::remove(path);
  return records;
}

struct ReadScale {
  unsigned bytes;
  double multiplier, offset;
};

double read_signed(PacketReader& data, std::size_t at, unsigned bytes) {
  return bytes == 1 ? data.i8(at) : bytes == 2 ? data.i16(at) : data.i32(at);
}

double read_unsigned(PacketReader& data, std::size_t at, unsigned bytes) {
  return bytes == 1 ? data.u8(at) : bytes == 2 ? data.u16(at) : data.u32(at);
}

/// Arrays of a ping as numbers. `scales` persists from ping to ping, as in the library of the format.
std::map<unsigned, std::vector<double>> arrays_of(PacketReader& data, std::map<unsigned, ReadScale>& scales) {
  std::map<unsigned, std::vector<double>> arrays;
  const auto beams = static_cast<std::size_t>(data.i16(16));
  std::size_t at = 56;
  while (data.size() - at >= 4) {
    const unsigned word = data.u32(at), id = word >> 24;
    const std::size_t size = word & 0xFFFFFF;
    at += 4;
    if (size > data.size() - at) throw std::runtime_error("an array beyond its record");
    if (id == 100) {
      const unsigned count = data.u32(at);
      if (size != 4 + 12 * count) throw std::runtime_error("scales of a wrong size");
      for (unsigned k = 0; k < count; ++k) {
        const std::size_t entry = at + 4 + 12 * k;
        scales[data.u8(entry)] = {data.u8(entry + 1) >> 4, double(data.i32(entry + 4)),
                                  double(data.i32(entry + 8))};
        if (data.u8(entry + 1) & 0xF || data.u16(entry + 2)) throw std::runtime_error("unknown compression");
      }
    } else {
      const ReadScale scale = scales.at(id);
      if (size != beams * scale.bytes) throw std::runtime_error("an array of a wrong size");
      const bool is_signed = id == 2 || id == 3 || id == 5 || id == 6;
      for (std::size_t beam = 0; beam < beams; ++beam) {
        const std::size_t field = at + beam * scale.bytes;
        const double stored =
            is_signed ? read_signed(data, field, scale.bytes) : read_unsigned(data, field, scale.bytes);
        arrays[id].push_back(stored / scale.multiplier - scale.offset);
      }
    }
    at += size;
  }
  for (; at < data.size(); ++at)
    if (data.u8(at) != 0) throw std::runtime_error("a pad that is not zero");
  return arrays;
}

TEST(GsfFile, BeginsWithTheVersion) {
  auto records = written("header", {}, [](GsfFile&) {});
  ASSERT_THAT(records, SizeIs(1));
  EXPECT_EQ(records[0].id, 1u);
  EXPECT_EQ(records[0].data.size(), 12u);
  EXPECT_EQ(records[0].data.text(0, 12), "GSF-v03.09");
}

TEST(GsfFile, PingHasEachFieldInItsPlace) {
  auto records = written("ping", {}, [](GsfFile& file) { file.add_ping(five_beams()); });
  ASSERT_THAT(records, SizeIs(2));
  EXPECT_EQ(records[1].id, 2u);
  PacketReader& data = records[1].data;
  EXPECT_EQ(data.i32(0), 1735689599);
  EXPECT_EQ(data.i32(4), 250000000);
  EXPECT_EQ(data.i32(8), -45123456);
  EXPECT_EQ(data.i32(12), 482500000);
  EXPECT_EQ(data.i16(16), 5);
  EXPECT_EQ(data.i16(18), 3);  // the beam straight down, counted from 1
  EXPECT_EQ(data.i16(20), 0);
  EXPECT_EQ(data.i16(22), 0);
  EXPECT_EQ(data.i16(24), -125);
  EXPECT_EQ(data.i32(26), 75);
  EXPECT_EQ(data.u16(30), 27150u);
  EXPECT_EQ(data.i16(32), 250);
  EXPECT_EQ(data.i16(34), -325);
  EXPECT_EQ(data.i16(36), 50);
  EXPECT_EQ(data.u16(38), 27025u);
  EXPECT_EQ(data.u16(40), 400u);
  EXPECT_EQ(data.i32(42), 51125);
  EXPECT_EQ(data.i32(46), -2500);
  EXPECT_EQ(data.i32(50), 125);
  EXPECT_EQ(data.i16(54), 0);
  // Scale factors: subrecord 100, seven of 12 bytes after their count.
  EXPECT_EQ(data.u32(56), 0x64000058u);
  EXPECT_EQ(data.u32(60), 7u);
  const unsigned scales[7][3] = {{0x01400000, 1000, 0},     {0x02400000, 1000, 0}, {0x03400000, 1000, 0},
                                 {0x04400000, 10000000, 0}, {0x05200000, 100, 0},  {0x06200000, 100, 0},
                                 {0x10100000, 1, 0}};
  for (std::size_t k = 0; k < 7; ++k)
    for (std::size_t word = 0; word < 3; ++word)
      EXPECT_EQ(data.u32(64 + 12 * k + 4 * word), scales[k][word]) << k << " " << word;
  const auto int32_array = [&](std::size_t at, unsigned id, std::vector<int> values) {
    EXPECT_EQ(data.u32(at), id << 24 | 20);
    for (std::size_t beam = 0; beam < 5; ++beam) EXPECT_EQ(data.i32(at + 4 + 4 * beam), values[beam]) << id;
  };
  int32_array(148, 1, {20000, 20000, 20000, 20000, 20000});
  int32_array(172, 2, {-34641, -11547, 0, 11547, 34641});
  int32_array(196, 3, {-250, 0, 250, 0, 0});
  int32_array(220, 4, {533333, 307920, 266667, 307920, 533333});
  const auto int16_array = [&](std::size_t at, unsigned id, std::vector<int> values) {
    EXPECT_EQ(data.u32(at), id << 24 | 10);
    for (std::size_t beam = 0; beam < 5; ++beam) EXPECT_EQ(data.i16(at + 4 + 2 * beam), values[beam]) << id;
  };
  int16_array(244, 5, {-6000, -3000, 0, 3000, 6000});
  int16_array(258, 6, {-3125, -2800, -1200, -2800, -3100});
  EXPECT_EQ(data.u32(272), 16u << 24 | 5);
  EXPECT_THAT(data.part(276, 5), ElementsAre(1, 0, 0, 0, 0));
  EXPECT_EQ(data.size(), 284u);  // 281 in blocks of 4
  EXPECT_THAT(data.unread(), IsEmpty());
}

TEST(GsfFile, An8101sOwnSubrecordFollowsTheArrays) {
  GsfPing ping = five_beams();
  Reson8101Settings sonar;
  sonar.sound_speed_m_s = 1481.26;
  sonar.range_m = 75;
  sonar.ping_rate_hz = 6.25;
  sonar.power = 7;
  sonar.gain = 31;
  sonar.time_varied_gain = true;
  sonar.absorption_db_per_km = 61;
  sonar.projector_angle_deg = -2.5;
  sonar.head_temperature_c = 11.5;
  sonar.sonar_id = 0x01020304;
  ping.reson_8101 = sonar;
  ping.ping_number = 70000;
  auto records = written("reson", {}, [&](GsfFile& file) { file.add_ping(ping); });
  PacketReader& data = records.at(1).data;
  const std::size_t begin = 281;  // where the arrays end
  EXPECT_EQ(data.u32(begin), 122u << 24 | 52);
  const std::size_t at = begin + 4;
  EXPECT_EQ(data.u16(at), 0u);  // no latency
  EXPECT_EQ(data.u32(at + 2), 70000u);
  EXPECT_EQ(data.u32(at + 6), 0x01020304u);
  EXPECT_EQ(data.u16(at + 10), 8101u);
  EXPECT_EQ(data.u16(at + 12), 240u);
  EXPECT_EQ(data.u16(at + 14), 14813u);
  EXPECT_EQ(data.u16(at + 16),
            65535u);  // Hz: the highest rate that 75 m permit is 161 kHz, but the field limits it
  EXPECT_EQ(data.u16(at + 18), 6250u);
  EXPECT_EQ(data.u16(at + 20), 8u);
  EXPECT_EQ(data.u16(at + 22), 75u);
  EXPECT_EQ(data.u16(at + 24), 7u);
  EXPECT_EQ(data.u16(at + 26), 31u | 1u << 14);
  EXPECT_EQ(data.u16(at + 28), 75u);
  EXPECT_EQ(data.u8(at + 30), 120u);
  EXPECT_EQ(data.u8(at + 31), 61u);
  EXPECT_EQ(data.u8(at + 32), 15u);
  EXPECT_EQ(data.u8(at + 33), 15u);
  EXPECT_EQ(data.u8(at + 34), 0u);
  EXPECT_EQ(data.i16(at + 35), -250);
  EXPECT_EQ(data.i16(at + 46), 115);
  EXPECT_EQ(data.u16(at + 48), 15000u);
  EXPECT_EQ(data.size(), 340u);  // 337 in blocks of 4
  for (std::size_t k = 0; k < begin; ++k) data.u8(k);
  EXPECT_THAT(data.unread(), IsEmpty());
}

TEST(GsfFile, ProcessingParametersAreTextsWithTheirLengths) {
  const std::vector<std::string> parameters{"ROLL_COMPENSATED=YES", "GEOID=WGS-84"};
  auto records = written("parameters", {}, [&](GsfFile& file) {
    file.add_processing_parameters(1735689599.25, parameters);
    for (const char* wrong : {"ROLL_COMPENSATED", ""}) {
      const std::vector<std::string> one{wrong};
      EXPECT_THROW(file.add_processing_parameters(1735689599.25, one), std::invalid_argument);
    }
  });
  ASSERT_THAT(records, SizeIs(2));
  EXPECT_EQ(records[1].id, 4u);
  PacketReader& data = records[1].data;
  EXPECT_EQ(data.i32(0), 1735689599);
  EXPECT_EQ(data.i32(4), 250000000);
  EXPECT_EQ(data.u16(8), 2u);
  std::size_t at = 10;
  for (const std::string& parameter : parameters) {
    const std::size_t size = data.u16(at);
    EXPECT_EQ(size, parameter.size() + 1);  // with the terminating zero
    EXPECT_EQ(data.text(at + 2, size), parameter);
    at += 2 + size;
  }
  EXPECT_EQ(data.size(), (at + 3) / 4 * 4);
  EXPECT_THAT(data.unread(), IsEmpty());
}

TEST(GsfFile, SoundSpeedProfileIsTwoTimesAPlaceAndItsPoints) {
  auto records = written("profile", {}, [](GsfFile& file) {
    GsfSoundSpeedProfile profile;
    profile.observed_unix_time_s = 1735689000.5;
    profile.applied_unix_time_s = 1735689599.25;
    profile.longitude_deg = -4.5123456;
    profile.latitude_deg = 48.25;
    EXPECT_THROW(file.add_sound_speed_profile(profile), std::invalid_argument) << "no points";
    for (const double depth_m : {-1.0, nan}) {
      profile.points = {{depth_m, 1500}};
      EXPECT_THROW(file.add_sound_speed_profile(profile), std::invalid_argument) << depth_m;
    }
    profile.points = {{5, 1500}, {4, 1490}};
    EXPECT_THROW(file.add_sound_speed_profile(profile), std::invalid_argument) << "depths that decrease";
    profile.points = {{0, 1512.346}, {8.125, 1500}, {12000, 1480.25}};
    file.add_sound_speed_profile(profile);
  });
  ASSERT_THAT(records, SizeIs(2));
  EXPECT_EQ(records[1].id, 3u);
  PacketReader& data = records[1].data;
  EXPECT_EQ(data.i32(0), 1735689000);
  EXPECT_EQ(data.i32(4), 500000000);
  EXPECT_EQ(data.i32(8), 1735689599);
  EXPECT_EQ(data.i32(12), 250000000);
  EXPECT_EQ(data.i32(16), -45123456);
  EXPECT_EQ(data.i32(20), 482500000);
  EXPECT_EQ(data.u32(24), 3u);
  const unsigned points[3][2] = {{0, 151235}, {813, 150000}, {1200000, 148025}};  // cm and cm/s
  for (std::size_t k = 0; k < 3; ++k)
    for (std::size_t column = 0; column < 2; ++column)
      EXPECT_EQ(data.u32(28 + 8 * k + 4 * column), points[k][column]) << k << ' ' << column;
  EXPECT_EQ(data.size(), 52u);
  EXPECT_THAT(data.unread(), IsEmpty());
}

// Readers accept records of at most 524288 bytes.
TEST(GsfFile, AProfileOfMorePointsThanARecordHoldsIsThinned) {
  auto records = written("long_profile", {}, [](GsfFile& file) {
    GsfSoundSpeedProfile profile;
    for (int k = 0; k <= 100'000; ++k) profile.points.push_back({0.1 * k, 1500 + 1e-3 * k});
    file.add_sound_speed_profile(profile);
  });
  PacketReader& data = records.at(1).data;
  EXPECT_LE(data.size(), 524288u);
  const std::size_t count = data.u32(24);
  EXPECT_GT(count, 60'000u);
  EXPECT_EQ(data.size(), 28 + 8 * count);
  EXPECT_EQ(data.u32(28), 0u);
  EXPECT_EQ(data.u32(28 + 8 * (count - 1)), 1'000'000u);
  EXPECT_EQ(data.u32(32 + 8 * (count - 1)), 160'000u);
}

TEST(GsfFile, ScalesStandInTheFirstPingOnly) {
  auto records = written("scales", {}, [](GsfFile& file) {
    file.add_ping(five_beams());
    GsfPing second = five_beams();
    second.depth_m[4] = 19.5;
    file.add_ping(second);
  });
  ASSERT_THAT(records, SizeIs(3));
  EXPECT_EQ(records[1].data.size() - records[2].data.size(), 4u + 4 + 7 * 12);
  std::map<unsigned, ReadScale> scales;
  arrays_of(records[1].data, scales);
  EXPECT_THAT(arrays_of(records[2].data, scales)[1], ElementsAre(20, 20, 20, 20, 19.5));
}

// A rejected ping must not consume the scales.
TEST(GsfFile, ScalesWaitForThePingThatIsWritten) {
  auto records = written("refused_first", {}, [](GsfFile& file) {
    GsfPing bad = five_beams();
    bad.depth_m[2] = nan;
    EXPECT_THROW(file.add_ping(bad), std::invalid_argument);
    file.add_ping(five_beams());
  });
  ASSERT_THAT(records, SizeIs(2));
  EXPECT_EQ(records[1].data.u32(56) >> 24, 100u);
}

TEST(GsfFile, ArraysThatAreNotThereAreLeftOut) {
  GsfPing ping = five_beams();
  ping.along_m.clear();
  ping.mean_amplitude_db.clear();
  ping.flags.clear();
  auto records = written("few", {}, [&](GsfFile& file) {
    file.add_ping(ping);
    EXPECT_THROW(file.add_ping(five_beams()), std::invalid_argument);
  });
  std::map<unsigned, ReadScale> scales;
  const auto arrays = arrays_of(records.at(1).data, scales);
  std::vector<unsigned> ids;
  for (const auto& [id, values] : arrays) ids.push_back(id);
  EXPECT_THAT(ids, ElementsAre(1, 2, 4, 5));
  EXPECT_THAT(scales, SizeIs(4));
}

TEST(GsfFile, ChecksumsAreTheSumsOfTheBytes) {
  GsfOptions options;
  options.checksums = true;
  const GsfAttitude level{1735689599.25, 0, 0, 0, 0};
  const auto records = written("sums", options, [&](GsfFile& file) {
    file.add_ping(five_beams());
    file.add_attitude({&level, 1});
  });  // the reader has compared the checksums
  EXPECT_THAT(records, SizeIs(3));
}

TEST(GsfFile, HeadingRoundsToNorthNotToFullTurn) {
  GsfPing ping = five_beams();
  ping.heading_deg = 359.996;
  ping.course_deg = 360;
  auto records = written("north", {}, [&](GsfFile& file) { file.add_ping(ping); });
  EXPECT_EQ(records.at(1).data.u16(30), 0u);
  EXPECT_EQ(records.at(1).data.u16(38), 0u);
}

// One step of a double (0.24 us) early, a typical result of arithmetic.
TEST(GsfFile, TimesAreNotEarly) {
  GsfPing ping = five_beams();
  ping.unix_time_s = std::nextafter(1735689600.0, 0);
  auto records = written("time", {}, [&](GsfFile& file) { file.add_ping(ping); });
  EXPECT_EQ(records.at(1).data.i32(0), 1735689600);
  EXPECT_EQ(records.at(1).data.i32(4), 0);
}

TEST(GsfFile, AttitudeHasEachFieldInItsPlace) {
  auto records = written("attitude", {}, [](GsfFile& file) {
    const GsfAttitude attitudes[] = {{1735689599.25, 271.5, 2.5, -3.25, 0.5},
                                     {1735689600.125, 0.01, -2.5, 3.25, -0.5}};
    file.add_attitude(attitudes);
  });
  ASSERT_THAT(records, SizeIs(2));
  EXPECT_EQ(records[1].id, 12u);
  PacketReader& data = records[1].data;
  ASSERT_EQ(data.size(), 32u);  // 10 + 2 * 10 in blocks of 4
  EXPECT_EQ(data.i32(0), 1735689599);
  EXPECT_EQ(data.i32(4), 250000000);
  EXPECT_EQ(data.u16(8), 2u);
  const int expected[2][5] = {{0, 250, -325, 50, 27150}, {875, -250, 325, -50, 1}};
  for (std::size_t k = 0; k < 2; ++k) {
    EXPECT_EQ(data.u16(10 + 10 * k), static_cast<unsigned>(expected[k][0]));
    EXPECT_EQ(data.i16(12 + 10 * k), expected[k][1]);
    EXPECT_EQ(data.i16(14 + 10 * k), expected[k][2]);
    EXPECT_EQ(data.i16(16 + 10 * k), expected[k][3]);
    EXPECT_EQ(data.u16(18 + 10 * k), static_cast<unsigned>(expected[k][4]));
  }
  EXPECT_THAT(data.unread(), IsEmpty());
}

// All values are recovered to half a unit of their scale, in each field size and with offsets.
TEST(GsfFile, RandomPingsComeBackToHalfAUnit) {
  const auto seed = std::random_device{}();
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  std::mt19937 random(seed);
  const auto uniform = [&](double from, double to) {
    return std::uniform_real_distribution(from, to)(random);
  };
  for (const bool small : {false, true}) {
    GsfOptions options;
    options.depth.offset = 10;
    options.across.offset = -7;
    if (small) {
      options.depth = {200, 10, 2};
      options.across = {100, -7, 2};
      options.along = {500, 0, 2};
      options.two_way_time = {200000, 0, 2};
      options.mean_amplitude = {2, 0, 1};
    }
    std::vector<GsfPing> pings;
    for (int k = 0; k < 30; ++k) {
      GsfPing ping = five_beams();
      const auto beams = std::uniform_int_distribution<std::size_t>(1, 300)(random);
      const auto fill = [&](std::vector<double>& values, double from, double to) {
        values.clear();
        for (std::size_t beam = 0; beam < beams; ++beam) values.push_back(uniform(from, to));
      };
      fill(ping.depth_m, -9, 300);
      fill(ping.across_m, -300, 300);
      fill(ping.along_m, -60, 60);
      fill(ping.two_way_time_s, 0, 0.3);
      fill(ping.beam_angle_deg, -180, 180);
      fill(ping.mean_amplitude_db, -63, 63);
      ping.flags.clear();
      for (std::size_t beam = 0; beam < beams; ++beam)
        ping.flags.push_back(static_cast<std::uint8_t>(random()));
      pings.push_back(std::move(ping));
    }
    auto records = written("random", options, [&](GsfFile& file) {
      for (const GsfPing& ping : pings) file.add_ping(ping);
    });
    ASSERT_EQ(records.size(), pings.size() + 1);
    std::map<unsigned, ReadScale> scales;
    for (std::size_t k = 0; k < pings.size(); ++k) {
      const GsfPing& ping = pings[k];
      auto arrays = arrays_of(records[k + 1].data, scales);
      const auto expect_near = [&](unsigned id, const std::vector<double>& values, double unit) {
        ASSERT_EQ(arrays[id].size(), values.size());
        for (std::size_t beam = 0; beam < values.size(); ++beam)
          EXPECT_NEAR(arrays[id][beam], values[beam], unit * (0.5 + 1e-6)) << id;
      };
      expect_near(1, ping.depth_m, small ? 5e-3 : 1e-3);
      expect_near(2, ping.across_m, small ? 1e-2 : 1e-3);
      expect_near(3, ping.along_m, small ? 2e-3 : 1e-3);
      expect_near(4, ping.two_way_time_s, small ? 5e-6 : 1e-7);
      expect_near(5, ping.beam_angle_deg, 1e-2);
      expect_near(6, ping.mean_amplitude_db, small ? 0.5 : 1e-2);
      expect_near(16, {ping.flags.begin(), ping.flags.end()}, 0);
    }
  }
}

TEST(GsfFile, RefusesPingsThatItsFieldsDoNotHold) {
  const struct {
    double GsfPing::*field;
    std::vector<double> values;
    const char* what;
  } fields[] = {{&GsfPing::unix_time_s, {nan, infinite, -1, 2147483648.}, "time"},
                {&GsfPing::longitude_deg, {nan, -180.5, 180.5}, "longitude"},
                {&GsfPing::latitude_deg, {nan, -90.5, 90.5}, "latitude"},
                {&GsfPing::heading_deg, {nan, -1, 361}, "heading"},
                {&GsfPing::pitch_deg, {nan, -91, 91}, "pitch"},
                {&GsfPing::roll_deg, {nan, -181, 181}, "roll"},
                {&GsfPing::heave_m, {nan, -328, 328}, "heave"},
                {&GsfPing::course_deg, {nan, -1, 361}, "course"},
                {&GsfPing::speed_m_s, {nan, -1, 338}, "speed"},
                {&GsfPing::tide_m, {nan, -328, 328}, "tide"},
                {&GsfPing::depth_corrector_m, {nan, infinite, 3e7}, "depth corrector"},
                {&GsfPing::height_m, {nan, infinite, 3e6}, "height"},
                {&GsfPing::separation_m, {nan, infinite, -3e6}, "separation"},
                {&GsfPing::gps_tide_m, {nan, infinite, 3e6}, "GPS tide"}};
  const struct {
    std::vector<double> GsfPing::*array;
    std::vector<double> values;
    const char* what;
  } arrays[] = {{&GsfPing::depth_m, {nan, infinite, -1, 4294968}, "depth [m] of beam 3"},
                {&GsfPing::across_m, {nan, infinite, 2147484}, "distance across [m] of beam 3"},
                {&GsfPing::along_m, {nan, infinite, -2147484}, "distance along [m] of beam 3"},
                {&GsfPing::two_way_time_s, {nan, -1, 430}, "two-way time [s] of beam 3"},
                {&GsfPing::beam_angle_deg, {nan, -328, 328}, "beam angle [deg] of beam 3"},
                {&GsfPing::mean_amplitude_db, {nan, -infinite, -328}, "mean amplitude [dB] of beam 3"}};
  const auto records = written("bad", {}, [&](GsfFile& file) {
    for (const auto& one : fields)
      for (const double value : one.values) {
        GsfPing ping = five_beams();
        ping.*one.field = value;
        expect_refused([&] { file.add_ping(ping); }, one.what);
      }
    for (const auto& one : arrays) {
      GsfPing ping = five_beams();
      for (const double value : one.values) {
        (ping.*one.array)[3] = value;
        expect_refused([&] { file.add_ping(ping); }, one.what);
      }
      ping = five_beams();
      (ping.*one.array).push_back(0);
      expect_refused([&] { file.add_ping(ping); }, "beams");
    }
    GsfPing ping = five_beams();
    ping.flags.pop_back();
    expect_refused([&] { file.add_ping(ping); }, "4 values of flags for 5 beams");
    expect_refused([&] { file.add_ping({}); }, "no depths");
    GsfPing wide;
    wide.depth_m.assign(32768, 20);
    expect_refused([&] { file.add_ping(wide); }, "number of beams");
    wide.depth_m.assign(32767, 20);
    wide.across_m = wide.along_m = wide.two_way_time_s = wide.depth_m;
    expect_refused([&] { file.add_ping(wide); }, "at most 524288");
  });
  EXPECT_THAT(records, SizeIs(1)) << "what is refused leaves no trace";
}

TEST(GsfFile, TakesARecordOfTheLargestSizeOnly) {
  // A header of 56 bytes, four scales, and four arrays of four bytes per beam.
  constexpr std::size_t before = 56 + (4 + 4 + 4 * 12) + 4 * 4, most_beams = (524288 - before) / 16;
  static_assert(before + 16 * most_beams == 524288);
  const auto records = written("largest", {}, [&](GsfFile& file) {
    GsfPing ping;
    for (const std::size_t beams : {most_beams + 1, most_beams}) {
      ping.depth_m.assign(beams, 20);
      ping.across_m = ping.along_m = ping.two_way_time_s = ping.depth_m;
      if (beams == most_beams)
        file.add_ping(ping);
      else
        expect_refused([&] { file.add_ping(ping); }, "at most 524288");
    }
  });
  EXPECT_THAT(records, SizeIs(2));
}

TEST(GsfFile, RefusesSoundSpeedProfilesOutsideOfTheEarth) {
  const auto records = written("nowhere", {}, [&](GsfFile& file) {
    GsfSoundSpeedProfile profile;
    profile.points = {{0, 1500}};
    profile.longitude_deg = 180.5;
    expect_refused([&] { file.add_sound_speed_profile(profile); }, "longitude");
    profile.longitude_deg = 0;
    profile.latitude_deg = -90.5;
    expect_refused([&] { file.add_sound_speed_profile(profile); }, "latitude");
  });
  EXPECT_THAT(records, SizeIs(1));
}

TEST(GsfFile, RefusesAttitudesThatARecordDoesNotHold) {
  const auto records = written("bad_attitude", {}, [](GsfFile& file) {
    const auto refuse = [&](std::vector<GsfAttitude> attitudes, const char* what) {
      expect_refused([&] { file.add_attitude(attitudes); }, what);
    };
    refuse({}, "no attitudes");
    refuse({{nan, 0, 0, 0, 0}}, "time");
    refuse({{10, 0, 0, 0, 0}, {9, 0, 0, 0, 0}}, "9 s follows 10 s");
    refuse({{10, 0, 0, 0, 0}, {nan, 0, 0, 0, 0}}, "follows");
    refuse({{10, 0, 0, 0, 0}, {76, 0, 0, 0, 0}}, "time after the first");
    refuse({{10, nan, 0, 0, 0}}, "heading");
    refuse({{10, 0, -91, 0, 0}}, "pitch");
    refuse({{10, 0, 0, 181, 0}}, "roll");
    refuse({{10, 0, 0, 0, nan}}, "heave");
    refuse(std::vector<GsfAttitude>(65536), "number of attitudes");
    refuse(std::vector<GsfAttitude>(60000), "at most 524288");
  });
  EXPECT_THAT(records, SizeIs(1));
}

TEST(GsfFile, RefusesOptionsBeforeTouchingTheFile) {
  const auto path = scratch_gsf("refused");
  std::ofstream(path) << "what was there";
  const auto refuse = [&](auto spoil, const char* what) {
    GsfOptions options;
    spoil(options);
    expect_refused([&] { GsfFile(path, options); }, what);
  };
  refuse([](GsfOptions& o) { o.version = "GSF-v03.09xx"; }, "version");
  refuse([](GsfOptions& o) { o.depth.multiplier = 0; }, "multiplier of depth");
  refuse([](GsfOptions& o) { o.across.bytes = 1; },
         "across is stored in 1 bytes, but must be stored in 2 or 4");
  refuse([](GsfOptions& o) { o.along.bytes = 3; }, "along");
  refuse([](GsfOptions& o) { o.two_way_time.multiplier = -1; }, "two-way time");
  refuse([](GsfOptions& o) { o.beam_angle.bytes = 4; },
         "beam angle is stored in 4 bytes, but must be stored in 2");
  refuse([](GsfOptions& o) { o.mean_amplitude.bytes = 4; }, "must be stored in 1 or 2");
  const auto left = file_content(path);
  EXPECT_EQ(std::string(left.begin(), left.end()), "what was there");
}

TEST(GsfFile, LeavesNothingUnlessFinished) {
  const auto path = scratch_gsf("unfinished");
  {
    GsfFile file(path);
    file.add_ping(five_beams());
  }
  EXPECT_FALSE(std::filesystem::exists(path));
}

TEST(GsfFile, SaysWhenTheDiskIsFull) {
  const auto path = scratch_gsf("full");
  std::filesystem::remove(path);
  std::filesystem::create_symlink("/dev/full", path);
  GsfFile file(path);
  try {
    for (int ping = 0; ping < 100; ++ping) file.add_ping(five_beams());
    file.finish();
    ADD_FAILURE() << "no error";
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(), HasSubstr(path.string()));
    EXPECT_THAT(error.what(), HasSubstr("No space left"));
  }
  EXPECT_THROW(file.add_ping(five_beams()), std::logic_error);
}

}  // namespace
}  // namespace tubefoot
