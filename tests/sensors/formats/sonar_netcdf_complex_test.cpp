// SPDX-License-Identifier: GPL-3.0-or-later
// Tests complex beams in SONAR-netCDF4: both parts are recovered, and equation type 1 gives the target
// strength.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "fixtures/netcdf_reader.hpp"
#include "fixtures/refusal.hpp"
#include "fixtures/test_folder.hpp"
#include "sensors/beamforming/beams.hpp"
#include "sensors/formats/sonar_netcdf.hpp"
#include "sensors/signals/matched_filter.hpp"
#include "sensors/signals/point_signals.hpp"

namespace tubefoot {
namespace {

constexpr const char* kBeamGroup = "/Sonar/Beam_group1";
constexpr std::size_t kBeams = 3;

SonarNetcdfHeader complex_header() {
  SonarNetcdfHeader h;
  h.date_created = "2024-05-06T07:08:09Z";
  h.beams = kBeams;
  h.frequency_hz = 100e3;
  h.chirp_start_hz = 90e3, h.chirp_stop_hz = 110e3;
  h.pulse_length_s = 2e-3;
  h.sound_speed_m_s = 1500;
  h.complex_beams = true;
  return h;
}

SonarNetcdfPing ping(int number) {
  SonarNetcdfPing p;
  p.unix_time_ns = 1714979289'000000000 + number * 33'333'333LL;
  p.sound_speed_m_s = 1500;
  p.sample_interval_s = 1.0 / 40e3;
  p.detections.resize(kBeams);
  for (std::size_t beam = 0; beam < kBeams; ++beam) {
    p.across_angle_deg.push_back(-30 + 30.0 * double(beam));
    p.backscatter.emplace_back();
    for (std::size_t k = 0; k < beam * 4; ++k)
      p.backscatter[beam].emplace_back(float(number) + float(k) / 8, -float(beam) - float(k) / 16);
  }
  return p;
}

TEST(SonarNetcdfComplex, KeepsBothPartsOfEveryBeam) {
  const TestFolder folder;
  constexpr int pings = 37;
  SonarNetcdfFile out(folder / "line.nc", complex_header());
  for (int k = 0; k < pings; ++k) out.add(ping(k));
  out.finish();
  const NetcdfReader file(folder / "line.nc");
  EXPECT_EQ(file.dimensions(kBeamGroup, "backscatter_i"), "ping_time,beam,subbeam");
  EXPECT_EQ(file.type(kBeamGroup, "backscatter_i"), "sample_t");
  signed char equation = 0;
  NetcdfReader::check(nc_get_att(file.group(kBeamGroup), NC_GLOBAL, "conversion_equation_type", &equation),
                      "equation");
  EXPECT_EQ(equation, 1);
  EXPECT_EQ(file.codes(kBeamGroup, "transmit_type"), std::vector<int>(pings, 1));  // LFM
  EXPECT_EQ(file.values(kBeamGroup, "transmit_frequency_start")[3], 90e3);
  EXPECT_EQ(file.values(kBeamGroup, "transmit_frequency_stop")[3], 110e3);
  const auto real = file.lists(kBeamGroup, "backscatter_r"),
             imaginary = file.lists(kBeamGroup, "backscatter_i");
  const auto counts = file.values(kBeamGroup, "sample_count");
  for (int k = 0; k < pings; ++k)
    for (std::size_t beam = 0; beam < kBeams; ++beam) {
      const std::vector<std::complex<float>> expected = ping(k).backscatter[beam];
      const std::size_t at = std::size_t(k) * kBeams + beam;
      ASSERT_EQ(counts[at], double(expected.size()));
      ASSERT_EQ(real[at].size(), expected.size());
      ASSERT_EQ(imaginary[at].size(), expected.size());
      for (std::size_t j = 0; j < expected.size(); ++j)
        EXPECT_EQ(std::complex<float>(real[at][j], imaginary[at][j]), expected[j]);
    }
}

TEST(SonarNetcdfComplex, GivesATargetItsStrengthByEquationOne) {
  const TestFolder folder;
  constexpr double range_m = 30;
  const ElementSignals signals = matched_filtered(point_signals(
      {{{0, 0, -range_m}, {0.3, 0.4}}}, line_array(16, {0.0075, 0, 0}), linear_chirp(90e3, 110e3, 2e-3, 0.5),
      {100e3, 40e3, 0.039, 160}, VehicleMotion({{0, {}}}, {0}), 1500));
  const auto beams = delay_and_sum(signals, 0, {across_track_fan({-0.5, 0, 0.5}), {}, {0, 0, 0}, true},
                                   SignalInterpolator());
  SonarNetcdfPing p = ping(0);
  p.blanking_interval_s = signals.sampling.first_s;
  for (std::size_t beam = 0; beam < kBeams; ++beam)
    p.backscatter[beam].assign(beams.begin() + std::ptrdiff_t(beam * 160),
                               beams.begin() + std::ptrdiff_t(beam * 160 + 160));
  SonarNetcdfFile out(folder / "line.nc", complex_header());
  out.add(p);
  out.finish();
  // From here on the test acts as a reader.
  const NetcdfReader file(folder / "line.nc");
  const auto real = file.lists(kBeamGroup, "backscatter_r")[1],
             imaginary = file.lists(kBeamGroup, "backscatter_i")[1];
  const double sample = std::round((2 * range_m / 1500 - file.values(kBeamGroup, "blanking_interval")[1]) /
                                   file.values(kBeamGroup, "sample_interval")[0]);
  const auto k = static_cast<std::size_t>(sample);
  const double power = double(real[k]) * real[k] + double(imaginary[k]) * imaginary[k];
  const double wavelength = 1500 / 100e3, transmitted = file.values(kBeamGroup, "transmit_power")[0];
  const double strength_db =
      10 * std::log10(power) + 40 * std::log10(range_m) -
      10 * std::log10(transmitted * wavelength * wavelength / (16 * std::numbers::pi * std::numbers::pi)) -
      file.values(kBeamGroup, "transducer_gain")[1];
  EXPECT_NEAR(strength_db, 10 * std::log10(0.25), 1e-3);
}

TEST(SonarNetcdfComplex, RefusesLevelsAmongSignalsAndSignalsAmongLevels) {
  const TestFolder folder;
  SonarNetcdfFile out(folder / "line.nc", complex_header());
  SonarNetcdfPing both = ping(0);
  both.backscatter_db.resize(kBeams);
  expect_refused([&] { out.add(both); }, "ping 0: it has levels, but the file stores complex beams");
  SonarNetcdfPing few = ping(0);
  few.backscatter.pop_back();
  expect_refused([&] { out.add(few); }, "ping 0: there are 2 time series for 3 beams");
  SonarNetcdfHeader levels = complex_header();
  levels.complex_beams = false;
  SonarNetcdfFile of_levels(folder / "levels.nc", levels);
  both.backscatter_db.resize(kBeams);
  expect_refused([&] { of_levels.add(both); }, "ping 0: it has complex beams, but the file stores levels");
}

}  // namespace
}  // namespace tubefoot
