// SPDX-License-Identifier: GPL-3.0-or-later
// Tests datagrams: each field that the builder writes comes back, older revisions are read, and damaged
// datagrams are rejected.
#include "kmall/kmall_datagrams.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <limits>

#include "fixtures/kmall_builder.hpp"
#include "fixtures/refusal.hpp"
#include "fixtures/test_folder.hpp"

namespace tubefoot {
namespace {

using namespace kmall_for_tests;
using testing::AllOf;
using testing::ElementsAre;
using testing::FloatEq;
using testing::HasSubstr;

constexpr double infinite = std::numeric_limits<double>::infinity(),
                 not_a_number = std::numeric_limits<double>::quiet_NaN();

struct KmallDatagrams : testing::Test {
  TestFolder folder;

  /// Reads the only datagram of a file.
  template <class Read>
  auto read_with(Read read, const std::string& type, const std::string& bytes) const {
    KmallFile file(folder.write("one.kmall", bytes));
    return read(file, file.records(type).at(0));
  }
  KmallInstallation installation(const std::string& text) const {
    return read_with(read_kmall_installation, "#IIP", datagram("#IIP", 0, begin_s, installation_body(text)));
  }
  std::vector<KmallMotion> motion(const std::string& body, std::size_t version = 1) const {
    return read_with(read_kmall_motion, "#SKM", datagram("#SKM", version, begin_s, body));
  }
  KmallPosition position(const std::string& body, std::size_t version = 0) const {
    return read_with(read_kmall_position, "#SPO", datagram("#SPO", version, begin_s, body));
  }
  std::vector<KmallSoundSpeed> profile(const std::string& body, std::size_t version = 1) const {
    return read_with(read_kmall_profile, "#SVP", datagram("#SVP", version, begin_s, body));
  }
  KmallPing ping(const std::string& body, std::size_t version = 3) const {
    return read_with(read_kmall_ping, "#MRZ", part_of("#MRZ", version, begin_s + 7.25, 1, 1, body));
  }
  KmallWaterColumn column(const std::string& body, std::size_t version = 2) const {
    return read_with(read_kmall_water_column, "#MWC", part_of("#MWC", version, begin_s + 8.5, 1, 1, body));
  }
  template <class Read>
  static std::string message(const Read& read) {
    return refusal<InputError>(read);
  }
};

Ping full_ping() {
  Ping ping;
  ping.number = 54321;
  ping.fans = 2;
  ping.fan = 1;
  ping.transmitter = 2;
  ping.receiver = 3;
  ping.heading_deg = 271.5;
  ping.latitude_deg = -33.123456789;
  ping.longitude_deg = 151.987654321;
  ping.speed_m_s = 1488.25;
  ping.waterline_m = -0.75;
  ping.transmit_width_deg = 0.7;
  ping.receive_width_deg = 1.4;
  ping.column_rate_hz = 30637.25;
  ping.swath_port_deg = 62.5;
  ping.swath_starboard_deg = -61.25;
  ping.sectors = {{-0.5, 190e3, 2, 0.00022, 208, 12e3, 1.2e-4, 5.3e-5},
                  {1.25, 220e3, 0, 0, 211, 15e3, 9e-5, 4e-5}};
  Sounding a;
  a.sector = 1;
  a.detection_method = 2;
  a.column_angle_deg = 55.5;
  a.absorption_db_per_km = 63.25;
  a.angle_deg = 50.125;
  a.angle_correction_deg = 0.5;
  a.time_s = 0.015;
  a.time_correction_s = 0.0005;
  a.delta_latitude_deg = 1e-4;
  a.delta_longitude_deg = -2e-4;
  a.z_m = 8.5;
  a.y_m = -10.25;
  a.x_m = 0.375;
  Sounding b = a;
  b.sector = 0;
  b.detection_method = 1;
  b.column_angle_deg = -12;
  ping.soundings = {a, b};
  return ping;
}

TEST_F(KmallDatagrams, InstallationHasMountingsAndPhaseCentres) {
  const KmallInstallation read = installation(installation_text(
      "N=1;X=-0.5;Y=-0.1;Z=1.75;R=0.25;P=0.875;H=177.5;S=0.7;IPX=0.01;IPY=-0.05;IPZ=-0.02;ICX=0;"
      "ICY=0.0065;ICZ=-0.005;ISX=0.02;ISY=0.049;ISZ=-0.012",
      "N=2;X=-0.27;Y=0.02;Z=1.7;R=-0.045;P=-0.9;H=357.92;G=0.00;IX=-0.01;IY=0.03;IZ=-0.006",
      "X=1;Y=2;Z=-3;R=0.1;P=0.2;H=0.3;D=0", 0.625));
  EXPECT_EQ(read.sonar, "EM 2042 - synthetic");
  EXPECT_EQ(read.revision, "Rev J 2023-09-15");
  EXPECT_EQ(read.waterline_m, 0.625);
  ASSERT_TRUE(read.transmitters[0] && read.receivers[0]);
  EXPECT_FALSE(read.transmitters[1] || read.receivers[1]);
  const KmallMounting &tx = *read.transmitters[0], &rx = *read.receivers[0], &mru = read.motion_sensor;
  EXPECT_EQ(tx.position_m, glm::dvec3(-0.5, -0.1, 1.75));
  EXPECT_THAT((std::array{tx.roll_deg, tx.pitch_deg, tx.heading_deg}), ElementsAre(0.25, 0.875, 177.5));
  EXPECT_EQ(tx.phase_centres_m[0], glm::dvec3(0.01, -0.05, -0.02));
  EXPECT_EQ(tx.phase_centres_m[1], glm::dvec3(0, 0.0065, -0.005));
  EXPECT_EQ(tx.phase_centres_m[2], glm::dvec3(0.02, 0.049, -0.012));
  EXPECT_EQ(rx.position_m, glm::dvec3(-0.27, 0.02, 1.7));
  EXPECT_THAT((std::array{rx.roll_deg, rx.pitch_deg, rx.heading_deg}), ElementsAre(-0.045, -0.9, 357.92));
  for (const glm::dvec3& centre : rx.phase_centres_m) EXPECT_EQ(centre, glm::dvec3(-0.01, 0.03, -0.006));
  EXPECT_EQ(mru.position_m, glm::dvec3(1, 2, -3));
  EXPECT_THAT((std::array{mru.roll_deg, mru.pitch_deg, mru.heading_deg}), ElementsAre(0.1, 0.2, 0.3));
}

TEST_F(KmallDatagrams, InstallationHasTheActiveMotionSensorAndSeveralHeads) {
  const KmallInstallation read = installation(
      "KMALL:x,TRAI_TX1:X=1,TRAI_RX1:X=2,TRAI_TX2:X=3,TRAI_RX2:X=4,ATTI_1:X=5;U=NOT_SET,ATTI_2:X=6;U="
      "ACTIVE,");
  EXPECT_EQ(read.transmitters[1].value().position_m.x, 3);
  EXPECT_EQ(read.receivers[1].value().position_m.x, 4);
  EXPECT_EQ(read.motion_sensor.position_m.x, 6);
  EXPECT_EQ(read.waterline_m, 0);
}

TEST_F(KmallDatagrams, InstallationWithoutArraysOrWithTextForANumberIsRejected) {
  EXPECT_THAT(message([&] { installation("SYSTEM:EM 2042,"); }),
              AllOf(HasSubstr("#IIP at byte 0"), HasSubstr("TRAI_TX1"), HasSubstr("TRAI_RX1")));
  EXPECT_THAT(message([&] { installation("TRAI_TX1:X=0,"); }), HasSubstr("TRAI_RX1"));
  for (const char* value : {"", "abc", "1e9", "nan", "inf"})
    EXPECT_THAT(message([&] { installation(fmt::format("TRAI_TX1:X=0;Y={},TRAI_RX1:X=0,", value)); }),
                AllOf(HasSubstr("'Y'"), HasSubstr("is not a number")))
        << value;
}

TEST_F(KmallDatagrams, MotionHasAllSamples) {
  for (const std::size_t sample_bytes : {64u, 120u, 132u, 200u}) {
    const auto read =
        motion(motion_body({{1.25, 0.5, -1.5, 359.5, 0.25}, {1.5, -0.5, 2, 0.25, -0.125}}, sample_bytes));
    ASSERT_EQ(read.size(), 2u);
    EXPECT_NEAR(read[0].time_s, begin_s + 1.25, 1e-6);
    EXPECT_NEAR(read[1].time_s, begin_s + 1.5, 1e-6);
    EXPECT_THAT((std::array{read[0].roll_deg, read[0].pitch_deg, read[0].heading_deg, read[0].heave_m}),
                ElementsAre(0.5, -1.5, 359.5, 0.25));
    EXPECT_THAT((std::array{read[1].roll_deg, read[1].pitch_deg, read[1].heading_deg, read[1].heave_m}),
                ElementsAre(-0.5, 2, 0.25, -0.125));
  }
  EXPECT_TRUE(motion(motion_body({})).empty());
}

TEST_F(KmallDatagrams, PositionAndProfileHaveTheirFields) {
  const KmallPosition at = position(position_body({3.5, 51.244786965, -2.921881307}));
  EXPECT_NEAR(at.time_s, begin_s + 3.5, 1e-6);
  EXPECT_EQ(at.latitude_deg, 51.244786965);
  EXPECT_EQ(at.longitude_deg, -2.921881307);
  const auto points = profile(profile_body({{0, 1480.5}, {12.25, 1482}}));
  ASSERT_EQ(points.size(), 2u);
  EXPECT_EQ(points[1].depth_m, 12.25);
  EXPECT_EQ(points[0].sound_speed_m_s, 1480.5);
  EXPECT_EQ(points[1].sound_speed_m_s, 1482);
}

TEST_F(KmallDatagrams, PingHasAllFields) {
  const Ping written = full_ping();
  const KmallPing read = ping(body_of(written));
  EXPECT_NEAR(read.time_s, begin_s + 7.25, 1e-6);
  EXPECT_EQ(read.number, 54321u);
  EXPECT_EQ(read.fans, 2u);
  EXPECT_EQ(read.fan, 1u);
  EXPECT_EQ(read.transmitter, 2u);
  EXPECT_EQ(read.receiver, 3u);
  EXPECT_EQ(read.heading_deg, 271.5);
  EXPECT_EQ(read.latitude_deg, -33.123456789);
  EXPECT_EQ(read.longitude_deg, 151.987654321);
  EXPECT_EQ(read.sound_speed_m_s, 1488.25);
  EXPECT_EQ(read.waterline_m, -0.75);
  EXPECT_THAT(float(read.transmit_width_deg), FloatEq(0.7f));
  EXPECT_THAT(float(read.receive_width_deg), FloatEq(1.4f));
  EXPECT_EQ(read.water_column_rate_hz, 30637.25);
  EXPECT_EQ(read.swath_port_deg, 62.5);
  EXPECT_EQ(read.swath_starboard_deg, -61.25);
  ASSERT_EQ(read.sectors.size(), 2u);
  for (std::size_t k = 0; k < 2; ++k) {
    const KmallSector& s = read.sectors[k];
    const Sector& w = written.sectors[k];
    EXPECT_EQ(s.tilt_deg, w.tilt_deg);
    EXPECT_EQ(s.sub_array, w.sub_array);
    EXPECT_EQ(s.frequency_hz, w.frequency_hz);
    EXPECT_EQ(float(s.delay_s), float(w.delay_s));
    EXPECT_EQ(s.source_level_db, w.source_level_db);
    EXPECT_EQ(s.bandwidth_hz, w.bandwidth_hz);
    EXPECT_EQ(float(s.effective_pulse_s), float(w.effective_s));
  }
  ASSERT_EQ(read.soundings.size(), 2u);
  const KmallSounding& s = read.soundings[0];
  EXPECT_TRUE(s.is_valid);
  EXPECT_EQ(s.sector, 1u);
  EXPECT_EQ(s.water_column_angle_deg, 55.5);
  EXPECT_EQ(s.absorption_db_per_km, 63.25);
  EXPECT_EQ(s.angle_re_receiver_deg, 50.625);
  EXPECT_NEAR(s.two_way_travel_time_s, 0.0155, 1e-9);
  EXPECT_NEAR(s.latitude_deg, -33.123456789 + 1e-4, 1e-10);
  EXPECT_NEAR(s.longitude_deg, 151.987654321 - 2e-4, 1e-10);
  EXPECT_THAT((std::array{s.x_m, s.y_m, s.z_m}), ElementsAre(0.375, -10.25, 8.5));
  EXPECT_EQ(read.soundings[1].sector, 0u);
  EXPECT_EQ(read.soundings[1].water_column_angle_deg, -12);
}

TEST_F(KmallDatagrams, PingOfAnotherRevisionIsRead) {
  Ping written = full_ping();
  written.sector_bytes = 36;  // without the effective pulse length
  written.sounding_bytes = 112;
  written.info_bytes = 144;
  for (const std::size_t version : {0u, 1u, 2u, 3u}) {
    const KmallPing read = ping(body_of(written), version);
    ASSERT_EQ(read.sectors.size(), 2u);
    EXPECT_EQ(float(read.sectors[0].effective_pulse_s), 1.2e-4f);
    EXPECT_EQ(read.sectors[1].tilt_deg, 1.25);
    ASSERT_EQ(read.soundings.size(), 2u);
    EXPECT_EQ(read.soundings[1].x_m, 0.375);
  }
  written.sector_bytes = 60;
  written.sounding_bytes = 150;
  written.info_bytes = 200;
  EXPECT_EQ(ping(body_of(written)).soundings.at(1).x_m, 0.375);
  written.sector_bytes = 48;
  written.sectors[0].effective_s = 0;  // absent
  EXPECT_EQ(float(ping(body_of(written)).sectors.at(0).effective_pulse_s), 1.2e-4f);
}

TEST_F(KmallDatagrams, PingWithExtraDetectionsHasOnlyDetectionsThatAreNotRejected) {
  Ping written = full_ping();
  written.classes = 3;
  const Sounding one = written.soundings[0];
  written.soundings.clear();
  std::vector<bool> expected;
  for (const std::size_t type : {0u, 1u, 2u})
    for (const std::size_t method : {0u, 1u, 2u, 3u}) {
      Sounding s = one;
      s.detection_type = type;
      s.detection_method = method;
      written.soundings.push_back(s);
      expected.push_back(type == 0 && (method == 1 || method == 2));
    }
  written.extra_detections = 5;
  const KmallPing read = ping(body_of(written));
  std::vector<bool> valid;
  for (const KmallSounding& s : read.soundings) {
    valid.push_back(s.is_valid);
    EXPECT_EQ(s.x_m, 0.375);
  }
  EXPECT_EQ(valid, expected);
}

TEST_F(KmallDatagrams, PingWithAValueThatIsNotFiniteHasAnInvalidSounding) {
  for (const double value : {infinite, -infinite, not_a_number})
    for (double Sounding::*field :
         {&Sounding::column_angle_deg, &Sounding::absorption_db_per_km, &Sounding::angle_deg,
          &Sounding::angle_correction_deg, &Sounding::time_s, &Sounding::time_correction_s,
          &Sounding::delta_latitude_deg, &Sounding::delta_longitude_deg, &Sounding::z_m, &Sounding::y_m,
          &Sounding::x_m}) {
      Ping written = full_ping();
      written.soundings[0].*field = value;
      const KmallPing read = ping(body_of(written));
      EXPECT_FALSE(read.soundings.at(0).is_valid);
      EXPECT_TRUE(read.soundings.at(1).is_valid);
    }
  for (double Ping::*field :
       {&Ping::heading_deg, &Ping::latitude_deg, &Ping::longitude_deg, &Ping::speed_m_s, &Ping::waterline_m,
        &Ping::transmit_width_deg, &Ping::receive_width_deg, &Ping::column_rate_hz}) {
    Ping written = full_ping();
    written.*field = not_a_number;
    EXPECT_THAT(message([&] { ping(body_of(written)); }),
                AllOf(HasSubstr("#MRZ at byte 0"), HasSubstr("not finite")));
  }
  for (double Sector::*field :
       {&Sector::tilt_deg, &Sector::frequency_hz, &Sector::delay_s, &Sector::source_level_db,
        &Sector::bandwidth_hz, &Sector::total_s, &Sector::effective_s}) {
    Ping written = full_ping();
    written.sectors[1].*field = infinite;
    EXPECT_THAT(message([&] { ping(body_of(written)); }), HasSubstr("not finite"));
  }
  Ping written = full_ping();
  written.speed_m_s = 0;
  EXPECT_THAT(message([&] { ping(body_of(written)); }), HasSubstr("sound speed of 0"));
}

TEST_F(KmallDatagrams, ValuesOfSensorsThatAreNotFiniteAreRejected) {
  for (double Motion::*field :
       {&Motion::roll_deg, &Motion::pitch_deg, &Motion::heading_deg, &Motion::heave_m}) {
    Motion m{1, 0, 0, 0, 0};
    m.*field = not_a_number;
    EXPECT_THAT(message([&] { motion(motion_body({m})); }), HasSubstr("not finite"));
  }
  EXPECT_THAT(message([&] { position(position_body({0, infinite, 0})); }), HasSubstr("not finite"));
  EXPECT_THAT(message([&] { profile(profile_body({{0, not_a_number}})); }), HasSubstr("not finite"));
}

Column full_column() {
  Column column;
  column.number = 777;
  column.fans = 2;
  column.fan = 1;
  column.transmitter = 1;
  column.receiver = 2;
  column.gain_exponent = 40;
  column.gain_offset_db = -12;
  column.rate_hz = 17507.5;
  column.speed_m_s = 1481.25;
  column.sectors = {{-0.75, 190e3}, {0.5, 220e3}};
  column.sectors[0].width_along_deg = 1.5;
  column.sectors[1].width_along_deg = 1.25;
  column.beams = {
      {65, 0, 772, 0, 772.25, {-128, -1, 0, 1, 127}}, {10, 3, 0, 0, 0, {}}, {-64.5, 7, 5, 1, 4.75, {5, 6}}};
  return column;
}

void expect_beams(const KmallWaterColumn& read, bool is_fine) {
  ASSERT_EQ(read.beams.size(), 3u);
  EXPECT_EQ(read.beams[0].angle_deg, 65);
  EXPECT_EQ(read.beams[0].first_sample, 0u);
  EXPECT_EQ(read.beams[0].detected_sample, is_fine ? 772.25 : 772);
  EXPECT_THAT(read.beams[0].levels, ElementsAre(-128, -1, 0, 1, 127));
  EXPECT_TRUE(read.beams[1].levels.empty());
  EXPECT_EQ(read.beams[1].detected_sample, 0);
  EXPECT_EQ(read.beams[2].angle_deg, -64.5);
  EXPECT_EQ(read.beams[2].sector, 1u);
  EXPECT_EQ(read.beams[2].first_sample, 7u);
  EXPECT_THAT(read.beams[2].levels, ElementsAre(5, 6));
}

TEST_F(KmallDatagrams, WaterColumnHasAllFields) {
  const KmallWaterColumn read = column(body_of(full_column()));
  EXPECT_NEAR(read.time_s, begin_s + 8.5, 1e-6);
  EXPECT_EQ(read.number, 777u);
  EXPECT_EQ(read.fans, 2u);
  EXPECT_EQ(read.fan, 1u);
  EXPECT_EQ(read.transmitter, 1u);
  EXPECT_EQ(read.receiver, 2u);
  EXPECT_EQ(read.gain_exponent, 40);
  EXPECT_EQ(read.gain_offset_db, -12);
  EXPECT_EQ(read.sample_rate_hz, 17507.5);
  EXPECT_EQ(read.sound_speed_m_s, 1481.25);
  ASSERT_EQ(read.sectors.size(), 2u);
  EXPECT_EQ(read.sectors[0].tilt_deg, -0.75);
  EXPECT_EQ(read.sectors[1].frequency_hz, 220e3);
  EXPECT_EQ(read.sectors[0].beam_width_along_deg, 1.5);
  EXPECT_EQ(read.sectors[1].beam_width_along_deg, 1.25);
  expect_beams(read, true);
}

TEST_F(KmallDatagrams, WaterColumnOfAnotherRevisionIsRead) {
  Column written = full_column();
  for (const std::size_t version : {0u, 1u, 2u})
    for (const std::size_t phase : {0u, 1u, 2u}) {
      written.phase = phase;
      written.beam_bytes = 12;  // without the detection of high resolution
      expect_beams(column(body_of(written), version), false);
      written.beam_bytes = 16;
      expect_beams(column(body_of(written), version), true);
      written.beam_bytes = 20;
      written.sector_bytes = 24;
      expect_beams(column(body_of(written), version), true);
      written.sector_bytes = 16;
    }
}

TEST_F(KmallDatagrams, WaterColumnWithImpossibleValuesIsRejected) {
  const auto error_with = [&](const auto& change) {
    Column written = full_column();
    change(written);
    return message([&] { column(body_of(written)); });
  };
  EXPECT_THAT(error_with([](Column& c) { c.phase = 3; }), HasSubstr("phases of kind 3"));
  EXPECT_THAT(error_with([](Column& c) { c.rate_hz = 0; }), HasSubstr("sample rate"));
  EXPECT_THAT(error_with([](Column& c) { c.speed_m_s = -1; }), HasSubstr("sound speed"));
  EXPECT_THAT(error_with([](Column& c) { c.rate_hz = not_a_number; }), HasSubstr("not finite"));
  EXPECT_THAT(error_with([](Column& c) { c.beams[2].angle_deg = infinite; }), HasSubstr("not finite"));
  EXPECT_THAT(error_with([](Column& c) { c.sectors[0].tilt_deg = infinite; }), HasSubstr("not finite"));
  EXPECT_THAT(
      error_with([](Column& c) { c.beams[2].sector = 2; }),
      AllOf(HasSubstr("#MWC at byte 0"), HasSubstr("beam 2 belongs to sector 2"), HasSubstr("2 sectors")));
}

TEST_F(KmallDatagrams, SoundingOfAMissingSectorIsRejected) {
  Ping written = full_ping();
  written.soundings[1].sector = 2;
  EXPECT_THAT(message([&] { ping(body_of(written)); }),
              AllOf(HasSubstr("#MRZ at byte 0"), HasSubstr("sector 2"), HasSubstr("2 sectors")));
  written.sectors.clear();
  EXPECT_THAT(message([&] { ping(body_of(written)); }), HasSubstr("0 sectors"));
}

TEST_F(KmallDatagrams, UnknownVersionsAreNamed) {
  EXPECT_THAT(message([&] { motion(motion_body({}), 2); }),
              AllOf(HasSubstr("version 2"), HasSubstr("up to 1")));
  EXPECT_THAT(message([&] { position(position_body({}), 1); }), HasSubstr("version 1"));
  EXPECT_THAT(message([&] { profile(profile_body({}), 2); }), HasSubstr("version 2"));
  EXPECT_THAT(message([&] { ping(body_of(full_ping()), 4); }),
              AllOf(HasSubstr("#MRZ"), HasSubstr("version 4")));
  EXPECT_THAT(message([&] { column(body_of(full_column()), 3); }),
              AllOf(HasSubstr("#MWC"), HasSubstr("version 3")));
}

TEST_F(KmallDatagrams, BodiesThatEndTooEarlyAreRejected) {
  const auto reject_prefixes = [&](const std::string& body, std::size_t needed, const auto& read) {
    for (std::size_t size = 0; size < needed; ++size) {
      SCOPED_TRACE(size);
      EXPECT_THAT(message([&] { read(body.substr(0, size)); }), HasSubstr("at byte 0"));
    }
    read(body.substr(0, needed));
  };
  std::string body = motion_body({{1, 2, 3, 4, 5}});
  reject_prefixes(body, body.size(), [&](const std::string& b) { return motion(b); });
  body = position_body({});
  reject_prefixes(body, 8 + 28, [&](const std::string& b) { return position(b); });
  body = profile_body({{0, 1500}, {9, 1500}});
  reject_prefixes(body, body.size(), [&](const std::string& b) { return profile(b); });
  body = body_of(full_ping());
  reject_prefixes(body, body.size(), [&](const std::string& b) { return ping(b); });
  body = body_of(full_column());
  reject_prefixes(body, body.size(), [&](const std::string& b) { return column(b); });
}

/// A size or a count at an offset of a body.
struct Declared {
  std::size_t at, bytes;
  std::vector<std::size_t> values;
};

TEST_F(KmallDatagrams, SizesThatAreTooSmallOrExceedTheDatagramAreRejected) {
  const auto reject = [&](const std::string& body, const std::vector<Declared>& sizes, const auto& read) {
    for (const Declared& declared : sizes)
      for (const std::size_t value : declared.values) {
        SCOPED_TRACE(fmt::format("{} at {}", value, declared.at));
        std::string damaged = body;
        std::memcpy(damaged.data() + declared.at, &value, declared.bytes);
        EXPECT_THAT(message([&] { read(damaged); }), HasSubstr("at byte 0"));
      }
  };
  constexpr std::size_t huge = 65535;
  const Ping written = full_ping();
  const std::size_t received = 12 + 152 + 2 * 48;
  reject(body_of(written),
         {{0, 2, {0, 11, huge}},                   // common part
          {12, 2, {0, 139, huge}},                 // information on the ping
          {12 + 92, 2, {huge}},                    // number of sectors
          {12 + 94, 2, {0, 35, huge}},             // bytes of a sector
          {received, 2, {0, 31, huge}},            // information on the receiver
          {received + 2, 2, {3, huge}},            // number of soundings
          {received + 6, 2, {0, 111, 121, huge}},  // bytes of a sounding
          {received + 26, 2, {1, huge}}},          // number of extra detections
         [&](const std::string& b) { return ping(b); });
  const std::size_t reception = 12 + 12 + 2 * 16;
  reject(body_of(full_column()),
         {{0, 2, {0, 11, huge}},
          {12, 2, {0, 11, huge}},
          {14, 2, {huge}},
          {16, 2, {0, 13, huge}},
          {reception, 2, {0, 15, huge}},
          {reception + 2, 2, {4, huge}},
          {reception + 4, 1, {0, 11, 255}},
          {reception + 16 + 10, 2, {huge}}},
         [&](const std::string& b) { return column(b); });
  reject(motion_body({{}, {}}), {{0, 2, {0, 11, huge}}, {6, 2, {3, huge}}, {8, 2, {0, 63, huge}}},
         [&](const std::string& b) { return motion(b); });
  reject(profile_body({{}, {}}), {{0, 2, {0, 27, huge}}, {2, 2, {3, huge}}},
         [&](const std::string& b) { return profile(b); });
  reject(position_body({}), {{0, 2, {0, 7, huge}}}, [&](const std::string& b) { return position(b); });
}

TEST_F(KmallDatagrams, WaterColumnInPartsEqualsTheWholeOne) {
  Column written = full_column();
  for (int level = 0; level < 500; ++level) written.beams[0].levels.push_back(level % 256 - 128);
  const KmallWaterColumn whole = column(body_of(written));
  std::string bytes;
  for (const std::string& part : divided("#MWC", 2, begin_s + 8.5, body_of(written), 3))
    bytes += part + datagram("#CHE", 0, begin_s, "heave");
  const KmallWaterColumn joined_column = read_with(read_kmall_water_column, "#MWC", bytes);
  ASSERT_EQ(joined_column.beams.size(), whole.beams.size());
  for (std::size_t k = 0; k < whole.beams.size(); ++k)
    EXPECT_EQ(joined_column.beams[k].levels, whole.beams[k].levels);
}

}  // namespace
}  // namespace tubefoot
