// SPDX-License-Identifier: GPL-3.0-or-later
// Compares JSF files with the table of EdgeTech's description by an independent reader: each byte is either
// examined or zero.
#include "sensors/formats/jsf_file.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "fixtures/packet_reader.hpp"
#include "fixtures/refusal.hpp"

namespace tubefoot {
namespace {

using Complex = std::complex<double>;
using samples::file_content;
using samples::PacketReader;

std::filesystem::path scratch_jsf(const std::string& name) {
  static const TestFolder folder;
  return folder / (name + ".jsf");
}

JsfPing ping() {
  JsfPing p;
  p.subsystem = JsfSubsystem::sidescan_high;
  p.starboard = true;
  p.number = 70000;
  p.unix_time_s = 1735689599.25;  // 2024-12-31 23:59:59.25, the 366th day
  p.x = -4.5, p.y = 48.25;
  p.heading_deg = 271.5, p.pitch_deg = 2.5, p.roll_deg = -3.25;
  p.depth_m = 12.75, p.altitude_m = 8.5;
  p.sound_speed_m_s = 1490.5;
  p.start_hz = 440e3, p.stop_hz = 1.8e6;
  p.sweep_s = 0.0042507;
  p.mixer_hz = 455e3;
  p.sample_interval_s = 1.0 / 48000;
  p.first_sample = 11;
  p.annotation = "a line";
  return p;
}

std::vector<Complex> noise(std::size_t count, double size) {
  std::mt19937 random(7);
  std::vector<Complex> values;
  for (std::size_t k = 0; k < count; ++k)
    values.emplace_back(size * (double(random()) / 2147483648.0 - 1),
                        size * (double(random()) / 2147483648.0 - 1));
  return values;
}

/// Returns the messages of a file. Throws if they do not fill the file.
std::vector<PacketReader> messages_of(const std::filesystem::path& file) {
  const auto bytes = file_content(file);
  std::vector<PacketReader> messages;
  for (std::size_t begin = 0; begin < bytes.size();) {
    PacketReader head{std::span(bytes).subspan(begin, 16), false};
    if (head.u16(0) != 0x1601) throw std::runtime_error("no start of a message");
    const std::size_t size = 16 + head.u32(12);
    messages.emplace_back(std::span(bytes).subspan(begin, size), false);
    begin += size;
  }
  return messages;
}

/// Samples of a message, scaled by its weighting factor.
std::vector<Complex> samples_of(PacketReader& m) {
  const std::size_t count = m.u16(16 + 114) | (m.u16(16 + 16) >> 8 & 0xF) << 16;
  const double unit = std::ldexp(1, -m.i16(16 + 168));
  std::vector<Complex> values;
  for (std::size_t k = 0; k < count; ++k)
    values.emplace_back(unit * m.i16(256 + 4 * k), unit * m.i16(258 + 4 * k));
  if (m.size() != 256 + 4 * count) throw std::runtime_error("another size than its samples have");
  return values;
}

TEST(JsfFile, HasTheFieldsOfTheTable) {
  const auto file = scratch_jsf("fields");
  JsfFile out(file);
  out.add(ping(), noise(3, 1));
  out.finish();
  std::vector<PacketReader> messages = messages_of(file);
  ASSERT_EQ(messages.size(), 1u);
  PacketReader& m = messages[0];
  EXPECT_EQ(m.u16(0), 0x1601u);
  EXPECT_EQ(m.u8(2), 13u);   // protocol version
  EXPECT_EQ(m.u8(3), 0u);    // session
  EXPECT_EQ(m.u16(4), 80u);  // type
  EXPECT_EQ(m.u8(6), 2u);    // command
  EXPECT_EQ(m.u8(7), 21u);   // subsystem
  EXPECT_EQ(m.u8(8), 1u);    // starboard
  EXPECT_EQ(m.u32(12), 240u + 12u);
  const auto at = [](std::size_t offset) { return 16 + offset; };
  EXPECT_EQ(m.i32(at(0)), 1735689599);
  EXPECT_EQ(m.u32(at(4)), 11u);
  EXPECT_EQ(m.u32(at(8)), 70000u);
  EXPECT_EQ(m.i16(at(28)), 1);  // ID code
  EXPECT_EQ(m.u16(at(30)), 1u | 1u << 3 | 1u << 5 | 1u << 6 | 1u << 9 | 1u << 10 | 1u << 14);
  EXPECT_EQ(m.i16(at(34)), 1);  // real and imaginary, matched filtered
  EXPECT_EQ(m.i32(at(80)), -4.5 * 60 * 10000);
  EXPECT_EQ(m.i32(at(84)), 48.25 * 60 * 10000);
  EXPECT_EQ(m.i16(at(88)), 2);
  EXPECT_EQ(m.text(at(90), 24), "a line");
  EXPECT_EQ(m.u16(at(114)), 3u);
  const double interval_ns = m.u32(at(116)) + (m.u16(at(18)) & 0xFF) / 256.0;
  EXPECT_NEAR(interval_ns, 1e9 / 48000, 1.0 / 512);
  EXPECT_EQ(m.u16(at(140)), 48000u);
  EXPECT_EQ(m.u16(at(126)) | (m.u16(at(16)) & 0xF) << 16, 44000u);        // 10 Hz
  EXPECT_EQ(m.u16(at(128)) | (m.u16(at(16)) >> 4 & 0xF) << 16, 180000u);  // of 20 bits
  EXPECT_EQ(m.u16(at(130)), 4u);                                          // ms
  EXPECT_EQ(m.u16(at(20)) >> 4 & 0x3FF, 251u);                            // and us
  EXPECT_EQ(m.i32(at(136)), 12750);
  EXPECT_EQ(m.i32(at(144)), 8500);
  EXPECT_EQ(m.f32(at(148)), 1490.5f);
  EXPECT_EQ(m.f32(at(152)), 455000.f);
  EXPECT_EQ(m.i16(at(156)), 2024);
  EXPECT_EQ(m.i16(at(158)), 366);
  EXPECT_EQ(m.i16(at(160)), 23);
  EXPECT_EQ(m.i16(at(162)), 59);
  EXPECT_EQ(m.i16(at(164)), 59);
  EXPECT_EQ(m.i16(at(166)), 3);
  EXPECT_EQ(m.i16(at(170)), 1);
  EXPECT_EQ(m.u16(at(172)), 27150u);
  EXPECT_NEAR(m.i16(at(174)) * 180.0 / 32768, 2.5, 0.003);
  EXPECT_NEAR(m.i16(at(176)) * 180.0 / 32768, -3.25, 0.003);
  EXPECT_EQ(m.u32(at(200)), 86399250u);
  EXPECT_EQ(m.u16(at(220)), 1u);
  int largest = 0;
  for (std::size_t k = 0; k < 6; ++k) largest = std::max(largest, std::abs(m.i16(256 + 2 * k)));
  EXPECT_EQ(m.u16(at(204)), unsigned(largest));
  samples_of(m);
  EXPECT_TRUE(m.unread().empty());
}

TEST(JsfFile, KeepsComplexSamplesToHalfAnInteger) {
  const auto file = scratch_jsf("samples");
  JsfFile out(file);
  const double sizes[] = {1e-9, 3e-5, 1, 32767, 2e6};
  for (const double size : sizes) out.add(ping(), noise(1000, size));
  out.add(ping(), noise(70000, 1));  // a count of more than 16 bits
  out.add(ping(), std::vector<Complex>(5));
  out.finish();
  std::vector<PacketReader> messages = messages_of(file);
  ASSERT_EQ(messages.size(), 7u);
  for (std::size_t k = 0; k < 5; ++k) {
    const std::vector<Complex> read = samples_of(messages[k]), expected = noise(1000, sizes[k]);
    ASSERT_EQ(read.size(), 1000u);
    const double unit = std::ldexp(1, -messages[k].i16(16 + 168));
    double error = 0, largest = 0;
    for (std::size_t j = 0; j < 1000; ++j) {
      error = std::max({error, std::abs(read[j].real() - expected[j].real()),
                        std::abs(read[j].imag() - expected[j].imag())});
      largest = std::max({largest, std::abs(expected[j].real()), std::abs(expected[j].imag())});
    }
    EXPECT_LE(error, unit / 2 * (1 + 1e-12)) << sizes[k];
    EXPECT_GT(largest / unit, 16383) << sizes[k];  // all 16 bits are used
  }
  EXPECT_EQ(samples_of(messages[5]).size(), 70000u);
  EXPECT_EQ(samples_of(messages[6]), std::vector<Complex>(5));
}

TEST(JsfFile, LeavesUnsaidWhatIsNotKnown) {
  const auto file = scratch_jsf("unknown");
  JsfFile out(file);
  JsfPing bare;
  bare.sample_interval_s = 1e-4;
  out.add(bare, noise(1, 1));
  JsfPing metres = bare;
  metres.degrees = false, metres.x = 1234.5678, metres.y = -20;
  out.add(metres, noise(1, 1));
  metres.y = 6.5e6;  // millimetres would not fit
  out.add(metres, noise(1, 1));
  out.finish();
  std::vector<PacketReader> m = messages_of(file);
  EXPECT_EQ(m[0].u16(16 + 30), 0u);
  EXPECT_EQ(m[1].u16(16 + 30), 1u);
  EXPECT_EQ(m[1].i16(16 + 88), 1);
  EXPECT_EQ(m[1].i32(16 + 80), 1234568);
  EXPECT_EQ(m[2].i16(16 + 88), 4);
  EXPECT_EQ(m[2].i32(16 + 84), 650000000);
}

TEST(JsfFile, RefusesWhatDoesNotFit) {
  const auto file = scratch_jsf("refused");
  JsfFile out(file);
  const auto refused = [&](auto change, const std::vector<Complex>& values, const std::string& what) {
    JsfPing p = ping();
    change(p);
    expect_refused([&] { out.add(p, values); }, "refused.jsf: ping 70000, starboard: " + what);
  };
  const auto nothing = [](JsfPing&) {};
  refused(nothing, {}, "number of samples is 0, but must be from 1 to 1048575");
  refused(nothing, {{1, NAN}}, "a sample is not finite: omit the ping");
  refused([](JsfPing& p) { p.y = 91; }, {1}, "latitude [deg] is 91");
  refused([](JsfPing& p) { p.heading_deg = -1; }, {1}, "heading [deg] is -1");
  refused([](JsfPing& p) { p.sample_interval_s = 0; }, {1}, "sample interval [s] is 0");
  refused([](JsfPing& p) { p.stop_hz = 2e7; }, {1},
          "last frequency [10 Hz] is 2000000, but must be from 0 to 1048575");
  refused([](JsfPing& p) { p.annotation = std::string(24, 'x'); }, {1}, "annotation");
  refused([](JsfPing& p) { p.unix_time_s = 3e9; }, {1}, "time [s since 1970] is 3000000000");
  refused([](JsfPing& p) { p.roll_deg = 181; }, {1}, "roll [deg] is 181");
  JsfPing edge = ping();
  edge.roll_deg = 180, edge.heading_deg = 360;
  EXPECT_NO_THROW(out.add(edge, noise(1, 1)));
}

}  // namespace
}  // namespace tubefoot
