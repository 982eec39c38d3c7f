// SPDX-License-Identifier: GPL-3.0-or-later
// Compares XTF files with the tables of the specification X41 by an independent reader: each byte is either
// examined or zero.
#include "sensors/formats/xtf_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <functional>
#include <limits>
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
using testing::Each;
using testing::ElementsAre;
using testing::ElementsAreArray;
using testing::HasSubstr;
using testing::IsEmpty;

// 2024-12-31 23:59:59.25 UTC, the 366th day of its year, and its milliseconds from midnight of the previous
// day.
constexpr double new_years_eve = 1735689599.25;
constexpr unsigned new_years_eve_tag = 2 * 86400000 - 750;

std::filesystem::path scratch(const std::string& name) {
  static const TestFolder folder;
  return folder / (name + ".xtf");
}

XtfHeader both_sonars() {
  XtfHeader header;
  header.sonar_name = "tow fish";
  header.note = "a line";
  header.sonar_type = 15;
  header.sidescan =
      XtfSidescan{{455, 0.21, 40, 20, -0.5, 1.25, 0.75}, {456, 0.22, 41, 21, 0.5, 1.5, 0.875}, 1000, true};
  header.bathymetry = XtfChannel{240, 1.5, 150, 90, 0.125, 2.5, 1};
  header.motion_starboard_m = 0.25;
  header.motion_forward_m = -3.5;
  header.motion_down_m = 1.5;
  return header;
}

XtfPlace place() {
  XtfPlace place;
  place.unix_time_s = new_years_eve;
  place.ping_number = 70000;
  place.x = -4.5;
  place.y = 48.25;
  place.heading_deg = 271.5;
  place.pitch_deg = 2.5;
  place.roll_deg = -3.25;
  place.heave_m = 0.5;
  place.depth_m = 12.75;
  place.altitude_m = 8.5;
  place.speed_m_s = 1852.0 / 3600 * 4;  // 4 knots
  return place;
}

/// The file, divided into header and packets. Throws if a packet violates X41 4.2, or if the last one does
/// not end with the file.
struct XtfContent {
  PacketReader header{{}, false};
  std::vector<PacketReader> packets;
};

XtfContent content_of(const std::filesystem::path& file) {
  const auto bytes = file_content(file);
  const std::span<const unsigned char> all(bytes);
  if (all.size() < 1024) throw std::runtime_error("no file header");
  XtfContent content{PacketReader(all.subspan(0, 1024), false), {}};
  for (std::size_t begin = 1024; begin < all.size();) {
    if (all.size() - begin < 64) throw std::runtime_error("a torn packet");
    if (all[begin] != 0xCE || all[begin + 1] != 0xFA) throw std::runtime_error("no magic number");
    const std::size_t size = all[begin + 10] | all[begin + 11] << 8 | all[begin + 12] << 16 |
                             static_cast<std::size_t>(all[begin + 13]) << 24;
    if (size < 64 || size % 64 != 0 || size > all.size() - begin) throw std::runtime_error("a wrong size");
    content.packets.emplace_back(all.subspan(begin, size), false);
    begin += size;
  }
  return content;
}

/// Writes one file and reads it back.
XtfContent written(const std::string& name, const XtfHeader& header,
                   const std::function<void(XtfFile&)>& fill) {
  const auto path = scratch(name);
  {
    XtfFile file(path, header);
    fill(file);
    file.finish();
  }
  XtfContent content = content_of(path);
  std::filesystem::remove(path);
  return content;
}

void expect_start(PacketReader& packet, unsigned type, unsigned channels) {
  EXPECT_EQ(packet.u16(0), 0xFACEu);
  EXPECT_EQ(packet.u8(2), type);
  EXPECT_EQ(packet.u16(4), channels);
  EXPECT_EQ(packet.u32(10), packet.size());
}

void expect_date(PacketReader& packet, std::size_t offset) {
  EXPECT_EQ(packet.u16(offset), 2024u);
  EXPECT_EQ(packet.u8(offset + 2), 12u);
  EXPECT_EQ(packet.u8(offset + 3), 31u);
  EXPECT_EQ(packet.u8(offset + 4), 23u);
  EXPECT_EQ(packet.u8(offset + 5), 59u);
  EXPECT_EQ(packet.u8(offset + 6), 59u);
}

void expect_place(PacketReader& packet) {
  expect_date(packet, 14);
  EXPECT_EQ(packet.u8(21), 25u);
  EXPECT_EQ(packet.u16(22), 366u);
  EXPECT_EQ(packet.u32(28), 70000u);
  EXPECT_EQ(packet.f32(32), 750);  // half the speed, as readers expect
  EXPECT_EQ(packet.f32(72), 1500);
  EXPECT_FLOAT_EQ(packet.f32(120), 4);
  EXPECT_EQ(packet.f32(124), 271.5f);
  EXPECT_EQ(packet.f64(128), 48.25);
  EXPECT_EQ(packet.f64(136), -4.5);
  for (const std::size_t clock : {148u, 236u}) {
    EXPECT_EQ(packet.u8(clock), 23u);
    EXPECT_EQ(packet.u8(clock + 1), 59u);
    EXPECT_EQ(packet.u8(clock + 2), 59u);
    EXPECT_EQ(packet.u8(clock + 3), 25u);
  }
  EXPECT_FLOAT_EQ(packet.f32(152), 4);
  EXPECT_EQ(packet.f64(160), 48.25);
  EXPECT_EQ(packet.f64(168), -4.5);
  EXPECT_EQ(packet.f32(192), 12.75f);
  EXPECT_EQ(packet.f32(196), 8.5f);
  EXPECT_EQ(packet.f32(204), 2.5f);
  EXPECT_EQ(packet.f32(208), -3.25f);
  EXPECT_EQ(packet.f32(212), 271.5f);
  EXPECT_EQ(packet.f32(216), 0.5f);
  EXPECT_EQ(packet.u32(224), new_years_eve_tag);
  EXPECT_EQ(packet.u32(232), new_years_eve_tag);
}

/// Reads the header and the samples of a channel, in the order of the file.
std::vector<unsigned> read_channel(PacketReader& packet, std::size_t& begin, unsigned index,
                                   double slant_range_m, unsigned frequency_khz) {
  EXPECT_EQ(packet.u16(begin), index);
  EXPECT_FLOAT_EQ(packet.f32(begin + 4), static_cast<float>(slant_range_m));
  EXPECT_FLOAT_EQ(packet.f32(begin + 16), static_cast<float>(slant_range_m / 750));
  EXPECT_FLOAT_EQ(packet.f32(begin + 20), static_cast<float>(slant_range_m / 750));
  EXPECT_EQ(packet.u16(begin + 24), 4u);
  EXPECT_EQ(packet.u16(begin + 26), frequency_khz);
  EXPECT_EQ(packet.u16(begin + 46), 5000u);
  const std::size_t count = packet.u32(begin + 42);
  std::vector<unsigned> samples;
  for (std::size_t k = 0; k < count; ++k) samples.push_back(packet.u16(begin + 64 + 2 * k));
  begin += 64 + 2 * count;
  return samples;
}

TEST(XtfFile, FileHeaderHasEachFieldInItsPlace) {
  const auto path = scratch("header");
  XtfFile(path, both_sonars()).finish();
  EXPECT_EQ(std::filesystem::file_size(path), 1024u);
  PacketReader header = content_of(path).header;
  EXPECT_EQ(header.u8(0), 0x7Bu);
  EXPECT_EQ(header.u8(1), 1u);
  EXPECT_THAT(header.part(2, 8), ElementsAreArray("tubefoot", 8));
  EXPECT_EQ(header.text(10, 8), "223");
  EXPECT_EQ(header.text(18, 16), "tow fish");
  EXPECT_EQ(header.u16(34), 15u);
  EXPECT_EQ(header.text(36, 64), "a line");
  EXPECT_EQ(header.text(100, 64), "header.xtf");
  EXPECT_EQ(header.u16(164), 3u);
  EXPECT_EQ(header.u16(166), 2u);
  EXPECT_EQ(header.u16(168), 1u);
  EXPECT_EQ(header.f32(232), -3.5f);
  EXPECT_EQ(header.f32(236), 0.25f);
  EXPECT_EQ(header.f32(240), 1.5f);
  struct Expected {
    unsigned type, correction, samples;
    const char* name;
    float frequency, along, tilt, across, starboard, forward, down;
  };
  const Expected channels[] = {{1, 1, 1000, "PORT", 455, 0.21f, 20, 40, -0.5f, 1.25f, 0.75f},
                               {2, 1, 1000, "STBD", 456, 0.22f, 21, 41, 0.5f, 1.5f, 0.875f},
                               {3, 0, 0, "BATHY", 240, 1.5f, 90, 150, 0.125f, 2.5f, 1}};
  for (unsigned index = 0; index < 3; ++index) {
    const std::size_t begin = 256 + 128 * index;
    const Expected& expected = channels[index];
    EXPECT_EQ(header.u8(begin), expected.type);
    EXPECT_EQ(header.u8(begin + 1), index);
    EXPECT_EQ(header.u16(begin + 2), expected.correction);
    EXPECT_EQ(header.u16(begin + 4), 1u);
    EXPECT_EQ(header.u16(begin + 6), 2u);
    EXPECT_EQ(header.u32(begin + 8), expected.samples);
    EXPECT_EQ(header.text(begin + 12, 16), expected.name);
    EXPECT_EQ(header.f32(begin + 28), 5);
    EXPECT_EQ(header.f32(begin + 32), expected.frequency);
    EXPECT_EQ(header.f32(begin + 36), expected.along);
    EXPECT_EQ(header.f32(begin + 40), expected.tilt);
    EXPECT_EQ(header.f32(begin + 44), expected.across);
    EXPECT_EQ(header.f32(begin + 48), expected.starboard);
    EXPECT_EQ(header.f32(begin + 52), expected.forward);
    EXPECT_EQ(header.f32(begin + 56), expected.down);
    EXPECT_EQ(header.u8(begin + 74), 3u);
  }
  EXPECT_THAT(header.unread(), IsEmpty());
}

TEST(XtfFile, HeaderSaysWhatIsThereAndInWhichUnits) {
  XtfHeader bathymetry_only = both_sonars();
  bathymetry_only.sidescan.reset();
  bathymetry_only.navigation = XtfNavigation::kMetres;
  bathymetry_only.channel_frequency_in_hz = true;
  PacketReader header = written("bathymetry_only", bathymetry_only, [](XtfFile&) {}).header;
  EXPECT_EQ(header.u16(164), 0u);
  EXPECT_EQ(header.u16(166), 0u);
  EXPECT_EQ(header.u16(168), 1u);
  EXPECT_EQ(header.u8(256), 3u);
  EXPECT_EQ(header.f32(256 + 32), 240000);
  for (std::size_t k = 256 + 128; k < 1024; ++k) EXPECT_EQ(header.u8(k), 0u);
}

TEST(XtfFile, SidescanPingHasEachFieldInItsPlace) {
  const std::vector<std::uint16_t> port{1, 2, 3, 4, 5}, starboard{11, 12, 65535};
  XtfContent content = written("ping", both_sonars(), [&](XtfFile& file) {
    file.add_sidescan_ping({place(), 75, port, starboard});
  });
  ASSERT_EQ(content.packets.size(), 1u);
  PacketReader& packet = content.packets[0];
  EXPECT_EQ(packet.size(), 448u);  // 256 + 64 + 10 + 64 + 6 = 400, in blocks of 64
  expect_start(packet, 0, 2);
  expect_place(packet);
  std::size_t begin = 256;
  EXPECT_THAT(read_channel(packet, begin, 0, 75, 455), ElementsAre(5, 4, 3, 2, 1));
  EXPECT_THAT(read_channel(packet, begin, 1, 75, 456), ElementsAre(11, 12, 65535));
  EXPECT_THAT(packet.unread(), IsEmpty());
}

// A point 30 m to port, in a record of 50 m with 500 samples. It lies in the 301st sample from the track,
// 300 samples before the end of the port record. Starboard stays dark.
TEST(XtfFile, TargetToPortLiesBeforeTheEndOfThePortRecord) {
  std::vector<std::uint16_t> port(500, 0), starboard(500, 0);
  port[300] = 4000;
  XtfContent content = written("target", both_sonars(), [&](XtfFile& file) {
    file.add_sidescan_ping({place(), 50, port, starboard});
  });
  std::size_t begin = 256;
  const auto first = read_channel(content.packets.at(0), begin, 0, 50, 455);
  const auto second = read_channel(content.packets.at(0), begin, 1, 50, 456);
  ASSERT_EQ(first.size(), 500u);
  for (std::size_t k = 0; k < 500; ++k) EXPECT_EQ(first[k], k == 500 - 1 - 300 ? 4000u : 0u) << k;
  EXPECT_THAT(second, Each(0u));
}

TEST(XtfFile, TimesUseTheHalfSpeedOfTheWater) {
  XtfHeader header = both_sonars();
  header.sound_speed_m_s = 1460;
  const std::vector<std::uint16_t> samples{7};
  PacketReader packet = written("speed", header, [&](XtfFile& file) {
                          file.add_sidescan_ping({place(), 73, samples, samples});
                        }).packets.at(0);
  EXPECT_EQ(packet.f32(32), 730);
  EXPECT_EQ(packet.f32(72), 1460);
  EXPECT_FLOAT_EQ(packet.f32(256 + 16), 0.1f);
  EXPECT_FLOAT_EQ(packet.f32(256 + 20), 0.1f);
}

TEST(XtfFile, AttitudeHasEachFieldInItsPlace) {
  PacketReader packet = written("attitude", both_sonars(), [](XtfFile& file) {
                          file.add_attitude({new_years_eve, 271.5, 2.5, -3.25, 0.5});
                        }).packets.at(0);
  ASSERT_EQ(packet.size(), 64u);
  expect_start(packet, 3, 0);
  EXPECT_EQ(packet.u32(22), 250000u);
  EXPECT_EQ(packet.u32(26), 1735689599u);
  EXPECT_EQ(packet.f32(30), 2.5f);
  EXPECT_EQ(packet.f32(34), -3.25f);
  EXPECT_EQ(packet.f32(38), 0.5f);
  EXPECT_EQ(packet.u32(46), new_years_eve_tag);
  EXPECT_EQ(packet.f32(50), 271.5f);
  expect_date(packet, 54);
  EXPECT_EQ(packet.u16(61), 250u);
  EXPECT_THAT(packet.unread(), IsEmpty());
}

TEST(XtfFile, NavigationHasEachFieldInItsPlace) {
  PacketReader packet = written("navigation", both_sonars(), [](XtfFile& file) {
                          file.add_navigation({new_years_eve, -4.5, 48.25, 51.5});
                        }).packets.at(0);
  ASSERT_EQ(packet.size(), 64u);
  expect_start(packet, 42, 0);
  expect_date(packet, 14);
  EXPECT_EQ(packet.u32(21), 250000u);
  EXPECT_EQ(packet.u32(25), 1735689599u);
  EXPECT_EQ(packet.u32(29), new_years_eve_tag);
  EXPECT_EQ(packet.f64(33), 48.25);
  EXPECT_EQ(packet.f64(41), -4.5);
  EXPECT_EQ(packet.f64(49), 51.5);
  EXPECT_EQ(packet.u8(57), 3u);
  EXPECT_THAT(packet.unread(), IsEmpty());
}

TEST(XtfFile, NoteHasItsTimeAndText) {
  PacketReader packet = written("note", both_sonars(), [](XtfFile& file) {
                          file.add_note(new_years_eve, "made by a simulator");
                        }).packets.at(0);
  ASSERT_EQ(packet.size(), 256u);
  expect_start(packet, 1, 0);
  expect_date(packet, 14);
  EXPECT_EQ(packet.text(56, 200), "made by a simulator");
  EXPECT_THAT(packet.unread(), IsEmpty());
}

TEST(XtfFile, SoundingsHaveEachFieldInTheirPlaces) {
  PacketReader packet = written("soundings", both_sonars(), [](XtfFile& file) {
                          const XtfSounding soundings[] = {{7, 0.02, -60.5, 0.25, 1234.5, 3},
                                                           {-8, 0.03, 59.5, -0.5, 0.125, -1}};
                          file.add_soundings(place(), soundings);
                        }).packets.at(0);
  ASSERT_EQ(packet.size(), 384u);
  expect_start(packet, 28, 2);
  expect_place(packet);
  EXPECT_EQ(packet.i32(256), 7);
  EXPECT_EQ(packet.f64(260), 1234.5);
  EXPECT_EQ(packet.i32(268), 3);
  EXPECT_EQ(packet.f64(272), 0.02);
  EXPECT_EQ(packet.f64(280), 0);
  EXPECT_EQ(packet.f64(288), -60.5);
  EXPECT_EQ(packet.f64(296), 0.25);
  EXPECT_EQ(packet.i32(320), -8);
  EXPECT_EQ(packet.f64(324), 0.125);
  EXPECT_EQ(packet.i32(332), -1);
  EXPECT_EQ(packet.f64(336), 0.03);
  EXPECT_EQ(packet.f64(352), 59.5);
  EXPECT_EQ(packet.f64(360), -0.5);
  EXPECT_THAT(packet.unread(), IsEmpty());
}

TEST(XtfFile, ProjectedPositionsAreStoredAsTheyAre) {
  XtfHeader header = both_sonars();
  header.navigation = XtfNavigation::kMetres;
  XtfPlace at_sea = place();
  at_sea.x = 388437.25;
  at_sea.y = 5345000.5;
  const std::vector<std::uint16_t> samples{7};
  PacketReader packet = written("metres", header, [&](XtfFile& file) {
                          file.add_sidescan_ping({at_sea, 75, samples, samples});
                        }).packets.at(0);
  EXPECT_EQ(packet.f64(160), 5345000.5);
  EXPECT_EQ(packet.f64(168), 388437.25);
}

// Random pings are recovered for any lengths, and packets keep to blocks of 64.
TEST(XtfFile, RandomPingsComeBack) {
  const auto seed = std::random_device{}();
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  std::mt19937 random(seed);
  const auto uniform = [&](double from, double to) {
    return std::uniform_real_distribution(from, to)(random);
  };
  struct Made {
    XtfPlace place;
    double slant_range_m;
    std::vector<std::uint16_t> port, starboard;
  };
  std::vector<Made> made(60);
  for (Made& one : made) {
    one.place = place();
    one.place.unix_time_s = std::floor(uniform(0, 4e9)) + 0.5;
    one.place.ping_number = static_cast<std::uint32_t>(random());
    one.place.x = uniform(-180, 180);
    one.place.y = uniform(-90, 90);
    one.place.heading_deg = uniform(0, 360);
    one.place.pitch_deg = uniform(-90, 90);
    one.place.roll_deg = uniform(-180, 180);
    one.slant_range_m = uniform(1, 500);
    one.port.resize(std::uniform_int_distribution<std::size_t>(1, 1000)(random));
    one.starboard.resize(std::uniform_int_distribution<std::size_t>(1, 1000)(random));
    for (auto* side : {&one.port, &one.starboard})
      for (auto& sample : *side) sample = static_cast<std::uint16_t>(random());
  }
  XtfContent content = written("random", both_sonars(), [&](XtfFile& file) {
    for (const Made& one : made)
      file.add_sidescan_ping({one.place, one.slant_range_m, one.port, one.starboard});
  });
  ASSERT_EQ(content.packets.size(), made.size());
  for (std::size_t k = 0; k < made.size(); ++k) {
    PacketReader& packet = content.packets[k];
    const Made& one = made[k];
    std::size_t begin = 256;
    auto port = read_channel(packet, begin, 0, one.slant_range_m, 455);
    const auto starboard = read_channel(packet, begin, 1, one.slant_range_m, 456);
    std::reverse(port.begin(), port.end());
    EXPECT_TRUE(std::equal(port.begin(), port.end(), one.port.begin(), one.port.end()));
    EXPECT_TRUE(std::equal(starboard.begin(), starboard.end(), one.starboard.begin(), one.starboard.end()));
    EXPECT_LT(packet.size() - begin, 64u);
    for (; begin < packet.size(); ++begin) EXPECT_EQ(packet.u8(begin), 0u);
    EXPECT_EQ(packet.u32(28), one.place.ping_number);
    EXPECT_EQ(packet.f64(160), one.place.y);
    EXPECT_EQ(packet.f64(168), one.place.x);
    EXPECT_EQ(packet.f32(204), static_cast<float>(one.place.pitch_deg));
    EXPECT_EQ(packet.f32(208), static_cast<float>(one.place.roll_deg));
    EXPECT_EQ(packet.f32(212), static_cast<float>(one.place.heading_deg));
    // From midnight of the day before the first ping, in turns of 2^31.
    const double midnight_s = (std::floor(made.front().place.unix_time_s / 86400) - 1) * 86400;
    const double turns = (one.place.unix_time_s - midnight_s) * 1000 / 2147483648.0;
    EXPECT_EQ(packet.u32(224), (turns - std::floor(turns)) * 2147483648.0);
    // Compares the date with the calendar of the system.
    const auto seconds = static_cast<std::time_t>(one.place.unix_time_s);
    std::tm date{};
    gmtime_r(&seconds, &date);
    EXPECT_EQ(packet.u16(14), static_cast<unsigned>(date.tm_year) + 1900);
    EXPECT_EQ(packet.u8(16), static_cast<unsigned>(date.tm_mon) + 1);
    EXPECT_EQ(packet.u8(17), static_cast<unsigned>(date.tm_mday));
    EXPECT_EQ(packet.u8(18), static_cast<unsigned>(date.tm_hour));
    EXPECT_EQ(packet.u8(19), static_cast<unsigned>(date.tm_min));
    EXPECT_EQ(packet.u8(20), static_cast<unsigned>(date.tm_sec));
    EXPECT_EQ(packet.u8(21), 50u);
    EXPECT_EQ(packet.u16(22), static_cast<unsigned>(date.tm_yday) + 1);
  }
}

// A time that arithmetic left one step of a double (0.24 us) early still stands for its nominal time. The
// last microsecond of a second does not belong to the next second.
TEST(XtfFile, TimesAreNeitherEarlyNorLate) {
  XtfContent content = written("hundredths", both_sonars(), [](XtfFile& file) {
    file.add_attitude({std::nextafter(1735689599.07, 0), 0, 0, 0, 0});
    file.add_attitude({1e9 + 0.999999, 0, 0, 0, 0});
  });
  EXPECT_EQ(content.packets.at(0).u16(61), 70u);
  EXPECT_EQ(content.packets.at(0).u32(22), 70000u);
  EXPECT_EQ(content.packets.at(1).u16(61), 999u);
  EXPECT_EQ(content.packets.at(1).u32(26), 1000000000u);
}

// MB-System reads the tags of attitude packets as signed: for half of all dates they would have no order.
TEST(XtfFile, TimeTagsStayBelowTwoToThe31AndFollowTheClock) {
  constexpr double half_period_s = 2147483.648, day_s = 86400;
  for (const double turn : {10.0, 401.0, 806.0, 807.0, 1234.0}) {
    // 2^31 ms of the count since 1970 lie ahead
    const double begin_s = std::floor(turn * half_period_s) - 3;
    XtfContent content = written("tags", both_sonars(), [&](XtfFile& file) {
      for (int k = 0; k < 7; ++k) {
        XtfPlace at = place();
        at.unix_time_s = begin_s + k;
        file.add_attitude({at.unix_time_s, 0, 0, 0, 0});
        file.add_navigation({at.unix_time_s, 0, 0, 0});
        file.add_soundings(at, {});
      }
      file.add_attitude({begin_s + 22 * day_s, 0, 0, 0, 0});
    });
    const unsigned first = content.packets.at(0).u32(46);
    EXPECT_GE(first, 86400000u) << "no tag is 0";
    for (unsigned k = 0; k < 7; ++k) {
      EXPECT_EQ(content.packets.at(3 * k).u32(46), first + 1000 * k) << turn;
      EXPECT_EQ(content.packets.at(3 * k + 1).u32(29), first + 1000 * k);
      EXPECT_EQ(content.packets.at(3 * k + 2).u32(224), first + 1000 * k);
      EXPECT_EQ(content.packets.at(3 * k + 2).u32(232), first + 1000 * k);
    }
    EXPECT_EQ(content.packets.at(21).u32(46), first + 22 * 86400000u);
    EXPECT_LT(content.packets.at(21).u32(46), 1u << 31);
  }
}

TEST(XtfFile, RefusesPlacesThatItsFieldsDoNotHold) {
  const struct {
    void (*spoil)(XtfPlace&, double);
    std::vector<double> values;
    const char* what;
  } cases[] = {
      {[](XtfPlace& p, double v) { p.unix_time_s = v; }, {nan, infinite, -1, 4294967296.}, "time"},
      {[](XtfPlace& p, double v) { p.x = v; }, {nan, infinite, -180.5, 180.5}, "longitude"},
      {[](XtfPlace& p, double v) { p.y = v; }, {nan, infinite, -90.5, 90.5}, "latitude"},
      {[](XtfPlace& p, double v) { p.heading_deg = v; }, {nan, infinite, -1, 361}, "heading"},
      {[](XtfPlace& p, double v) { p.pitch_deg = v; }, {nan, infinite, -91, 91}, "pitch"},
      {[](XtfPlace& p, double v) { p.roll_deg = v; }, {nan, infinite, -181, 181}, "roll"},
      {[](XtfPlace& p, double v) { p.heave_m = v; }, {nan, infinite, 1e39}, "heave"},
      {[](XtfPlace& p, double v) { p.depth_m = v; }, {nan, infinite, 1e39}, "depth"},
      {[](XtfPlace& p, double v) { p.altitude_m = v; }, {nan, infinite, -1}, "altitude"},
      {[](XtfPlace& p, double v) { p.speed_m_s = v; }, {nan, infinite, -1}, "speed"},
  };
  const std::vector<std::uint16_t> samples{7};
  const XtfContent content = written("places", both_sonars(), [&](XtfFile& file) {
    for (const auto& one : cases)
      for (const double value : one.values) {
        XtfPlace spoilt = place();
        one.spoil(spoilt, value);
        expect_refused([&] { file.add_sidescan_ping({spoilt, 75, samples, samples}); }, one.what);
        expect_refused([&] { file.add_soundings(spoilt, {}); }, one.what);
        expect_refused([&] { file.add_reson_8101_ping(spoilt, {}, {}); }, one.what);
      }
    for (const double value : {nan, -1.0, 361.0})
      expect_refused([&] { file.add_attitude({new_years_eve, value, 0, 0, 0}); }, "heading");
    expect_refused([&] { file.add_attitude({new_years_eve, 0, nan, 0, 0}); }, "pitch");
    expect_refused([&] { file.add_attitude({new_years_eve, 0, 0, nan, 0}); }, "roll");
    expect_refused([&] { file.add_attitude({new_years_eve, 0, 0, 0, nan}); }, "heave");
    expect_refused([&] { file.add_attitude({-1, 0, 0, 0, 0}); }, "time");
    expect_refused([&] { file.add_navigation({new_years_eve, 181, 0, 0}); }, "longitude");
    expect_refused([&] { file.add_navigation({new_years_eve, 0, nan, 0}); }, "latitude");
    expect_refused([&] { file.add_navigation({new_years_eve, 0, 0, nan}); }, "altitude");
    expect_refused([&] { file.add_note(new_years_eve, std::string(200, 'x')); }, "at most 199");
    file.add_note(new_years_eve, std::string(199, 'x'));
  });
  EXPECT_EQ(content.packets.size(), 1u) << "what is refused leaves no trace";
}

TEST(XtfFile, RefusesPingsThatAreNotWhatTheHeaderSays) {
  const std::vector<std::uint16_t> one{7}, many(1001, 7), none;
  const XtfContent content = written("counts", both_sonars(), [&](XtfFile& file) {
    expect_refused(
        [&] {
          file.add_sidescan_ping({place(), 75, many, one});
        },
        "number of samples on the port side");
    expect_refused(
        [&] {
          file.add_sidescan_ping({place(), 75, one, many});
        },
        "number of samples on the starboard side");
    expect_refused(
        [&] {
          file.add_sidescan_ping({place(), 75, none, one});
        },
        "number of samples on the port side");
    for (const double range : {nan, infinite, 0.0, -1.0})
      expect_refused([&] { file.add_sidescan_ping({place(), range, one, one}); }, "slant range");
    XtfSounding sounding;
    const auto refuse = [&](double XtfSounding::*field, double value, const char* what) {
      XtfSounding spoilt = sounding;
      spoilt.*field = value;
      expect_refused([&] { file.add_soundings(place(), {&spoilt, 1}); }, what);
    };
    refuse(&XtfSounding::two_way_time_s, nan, "two-way time");
    refuse(&XtfSounding::two_way_time_s, -1, "two-way time");
    refuse(&XtfSounding::across_angle_deg, 181, "angle across");
    refuse(&XtfSounding::along_angle_deg, nan, "angle along");
    refuse(&XtfSounding::intensity, infinite, "intensity");
    const std::vector<XtfSounding> crowd(65536);
    expect_refused([&] { file.add_soundings(place(), crowd); }, "number of soundings");
  });
  EXPECT_THAT(content.packets, IsEmpty());

  XtfHeader header = both_sonars();
  header.bathymetry.reset();
  written("no_bathymetry", header, [&](XtfFile& file) {
    expect_refused([&] { file.add_soundings(place(), {}); }, "no bathymetry");
    expect_refused([&] { file.add_reson_8101_ping(place(), {}, {}); }, "no bathymetry");
  });
  header = both_sonars();
  header.sidescan.reset();
  written("no_sidescan", header, [&](XtfFile& file) {
    expect_refused([&] { file.add_sidescan_ping({place(), 75, one, one}); }, "no sidescan");
  });
}

TEST(XtfFile, RefusesHeadersBeforeTouchingTheFile) {
  const auto path = scratch("refused");
  std::ofstream(path) << "what was there";
  const auto refuse = [&](auto spoil, const char* what) {
    XtfHeader header = both_sonars();
    spoil(header);
    expect_refused([&] { XtfFile(path, header); }, what);
  };
  refuse([](XtfHeader& h) { h.program = "a long name"; }, "program");
  refuse([](XtfHeader& h) { h.sonar_name = std::string(16, 'x'); }, "sonar name");
  refuse([](XtfHeader& h) { h.note = std::string(64, 'x'); }, "note");
  refuse([](XtfHeader& h) { h.note = std::string("a\0b", 3); }, "note");
  refuse([](XtfHeader& h) { h.sound_speed_m_s = 0; }, "sound speed");
  refuse([](XtfHeader& h) { h.sound_speed_m_s = nan; }, "sound speed");
  refuse([](XtfHeader& h) { h.sidescan->max_samples = 0; }, "samples");
  refuse([](XtfHeader& h) { h.sidescan->port.frequency_khz = 65536; }, "PORT frequency");
  refuse([](XtfHeader& h) { h.sidescan->starboard.tilt_deg = nan; }, "STBD tilt");
  refuse([](XtfHeader& h) { h.bathymetry->down_m = infinite; }, "BATHY position down");
  refuse([](XtfHeader& h) { h.sidescan.reset(), h.bathymetry.reset(); }, "neither");
  const auto left = file_content(path);
  EXPECT_EQ(std::string(left.begin(), left.end()), "what was there");
}

TEST(XtfFile, LeavesNothingUnlessFinished) {
  const auto path = scratch("unfinished");
  {
    XtfFile file(path, both_sonars());
    EXPECT_TRUE(std::filesystem::exists(path));
  }
  EXPECT_FALSE(std::filesystem::exists(path));
  XtfFile file(path, both_sonars());
  file.finish();
  EXPECT_THROW(file.add_note(0, "late"), std::logic_error);
  EXPECT_THROW(file.finish(), std::logic_error);
  EXPECT_TRUE(std::filesystem::exists(path));
}

TEST(XtfFile, SaysWhenTheDiskIsFull) {
  const auto path = scratch("full");
  std::filesystem::remove(path);
  std::filesystem::create_symlink("/dev/full", path);
  const std::vector<std::uint16_t> samples(1000, 7);
  const auto expect_full = [&](auto call) {
    try {
      call();
      ADD_FAILURE() << "no error";
    } catch (const std::runtime_error& error) {
      EXPECT_THAT(error.what(), HasSubstr(path.string()));
      EXPECT_THAT(error.what(), HasSubstr("No space left"));
    }
  };
  {
    XtfFile file(path, both_sonars());
    expect_full([&] { file.finish(); });  // all data was still in memory
  }
  XtfFile file(path, both_sonars());
  expect_full([&] {
    for (int ping = 0; ping < 100; ++ping) file.add_sidescan_ping({place(), 75, samples, samples});
  });
  EXPECT_THROW(file.finish(), std::logic_error);
  EXPECT_TRUE(std::filesystem::exists("/dev/full"));
}

TEST(XtfFile, SaysWhereItCannotBeWritten) {
  try {
    XtfFile(scratch("no/such/folder"), both_sonars());
    FAIL() << "no error";
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(), HasSubstr("no/such/folder.xtf"));
    EXPECT_THAT(error.what(), HasSubstr("No such file"));
  }
}

}  // namespace
}  // namespace tubefoot
