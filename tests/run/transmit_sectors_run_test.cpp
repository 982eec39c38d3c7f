// SPDX-License-Identifier: GPL-3.0-or-later
// Tests runs of multibeams with transmit sectors. Delays and tilts move soundings, each sector has its own
// absorption, and the files contain the sectors.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numbers>

#include "fixtures/multibeam_runs.hpp"
#include "fixtures/netcdf_reader.hpp"
#include "fixtures/packet_reader.hpp"
#include "fixtures/world/echoes.hpp"
#include "geometry/numbers/scalars.hpp"
#include "scene/description/water_description.hpp"
#include "scene/scene_water.hpp"

namespace tubefoot {
namespace {

using namespace multibeam_for_tests;
using testing::HasSubstr;

/// A line to the north at 5 m/s, 20 m above a flat seabed at height 0, with a place on Earth.
std::string line_scene(const std::string& water = still_water(50)) {
  return "[georeference]\norigin_lat_lon_deg = [59.0, 10.0]\norigin_height_m = -25\n" + water +
         lambert_material("bed", -27) + flat_terrain(400, 400) +
         "[trajectory]\nkind = \"line\"\nstart_m = [0, -10, 20]\nend_m = [0, 10, 20]\nspeed_m_s = 5\n";
}

/// 31 beams over 90 degrees; `keys`: further keys.
std::string line_sensor(const std::string& name, const std::string& keys) {
  return fmt::format(
      "[[sensors]]\nname = \"{}\"\nkind = \"multibeam\"\nbeams = 31\nswath_deg = 90\nbeam_across_deg = 3\n"
      "along_track_deg = 1\nrange_min_m = 1\nrange_max_m = 41\nsamples = 800\npings = 3\n"
      "ping_interval_s = 0.5\n{}",
      name, keys);
}

const std::string three_edges = "sector_edges_deg = [-45, -15.5, 15.5, 45]\n";

std::size_t sector_of(std::size_t beam) { return beam < 10 ? 0 : beam < 21 ? 1 : 2; }

TEST(TransmitSectorsRun, OneExplicitSectorWritesTheSameFiles) {
  const TestFolder without, with;
  const std::string rough = replaced(line_scene(), flat_terrain(400, 400), rough_terrain(64, 64, 1));
  run(without, rough + line_sensor("sonar", "tvg_spreading = 30\nnoise_level_db = 60\n"));
  run(with, rough + line_sensor("sonar",
                                "tvg_spreading = 30\nnoise_level_db = 60\nsector_edges_deg = [-45, 45]\n"
                                "sector_frequencies_khz = [240]\nsector_tilts_deg = [0]\n"
                                "sector_delays_us = [0]\n"));
  ASSERT_EQ(names_below(without / "out"), names_below(with / "out"));
  for (const char* name : {"sonar-soundings.csv", "sonar.gsf", "sonar.xtf", "sonar-depth.tif"})
    EXPECT_EQ(samples::file_content(without / "out" / name), samples::file_content(with / "out" / name))
        << name;
  // Files of HDF5 contain times of their making, and the hashes of the scenes differ.
  const auto expect_equal = [&](const char* file, const std::string& group) {
    const NetcdfReader one(without / "out" / file), other(with / "out" / file);
    ASSERT_EQ(one.variables(group), other.variables(group));
    for (const std::string& name : one.variables(group)) {
      if (const std::string type = one.type(group, name); type != "double" && type != "float") continue;
      const std::vector<double> a = one.values(group, name), b = other.values(group, name);
      for (std::size_t k = 0; k < a.size(); ++k)
        ASSERT_TRUE(a[k] == b[k] || (std::isnan(a[k]) && std::isnan(b[k]))) << name;
    }
  };
  expect_equal("echoes.nc", "/");
  expect_equal("sonar-sonar.nc", "/Sonar/Beam_group1");
  expect_equal("sonar-sonar.nc", "/Sonar/Beam_group1/Bathymetry");
}

TEST(TransmitSectorsRun, ThreeEqualSectorsReceiveTheEnergiesOfOne) {
  const std::string rough = replaced(line_scene(), flat_terrain(400, 400), rough_terrain(64, 64, 1));
  for (const std::string more :
       {"", "spacing = \"distance\"\n", "transmit_pattern = \"line\"\ntransmit_aperture_m = 0.2\n"}) {
    const Echoes one = echoes_of(rough + line_sensor("sonar", more)),
                 three = echoes_of(rough + line_sensor("sonar", more + three_edges));
    EXPECT_GT(one.total(), 0);
    EXPECT_EQ(one.energy, three.energy) << more;
  }
}

// A delay d displaces soundings by the speed times d, and nothing else.
TEST(TransmitSectorsRun, ADelayMovesTheSoundingsAlongTheTrack) {
  const TestFolder folder;
  run(folder, line_scene() + line_sensor("one", "") +
                  line_sensor("three", three_edges + "sector_delays_us = [0, 20000, 50000]\n"));
  const auto one = soundings_in(folder / "out/one-soundings.csv"),
             three = soundings_in(folder / "out/three-soundings.csv");
  ASSERT_EQ(one.size(), 93u);
  ASSERT_EQ(three.size(), one.size());
  const std::array moved{0.0, 0.1, 0.25};
  const auto rows = csv_rows(folder / "out/three-soundings.csv");
  for (std::size_t k = 0; k < one.size(); ++k) {
    const std::size_t sector = sector_of(three[k].beam);
    EXPECT_NEAR(three[k].north - one[k].north, moved[sector], 1.1e-4);
    EXPECT_NEAR(three[k].east, one[k].east, 1.1e-4);
    EXPECT_NEAR(three[k].up, one[k].up, 1.1e-4);
    EXPECT_EQ(rows[k].at("sector"), std::to_string(sector));
    EXPECT_NEAR(std::stod(rows[k].at("time_s")), 0.5 * double(three[k].ping) + moved[sector] / 5, 1e-9);
  }
  EXPECT_FALSE(csv_rows(folder / "out/one-soundings.csv")[0].contains("sector"));
}

// Angle a across the track, tilt t, depth H. The sounding is H tan a to starboard and H tan t / cos a
// forward.
TEST(TransmitSectorsRun, ATiltMovesTheSoundingsOnACone) {
  const TestFolder folder;
  run(folder, line_scene() + line_sensor("three", three_edges + "sector_tilts_deg = [-6, 2, 10]\n"));
  const std::array tilt_deg{-6.0, 2.0, 10.0};
  const auto soundings = soundings_in(folder / "out/three-soundings.csv");
  ASSERT_EQ(soundings.size(), 93u);
  for (const CsvSounding& s : soundings) {
    SCOPED_TRACE(s.beam);
    const double tilt = tilt_deg[sector_of(s.beam)] * degree, across = (-45 + 3 * double(s.beam)) * degree;
    EXPECT_NEAR(s.angle_deg, across / degree, 1e-9);
    EXPECT_NEAR(s.range, 20 / std::cos(tilt) / std::cos(across), step_m);
    EXPECT_NEAR(s.east, 20 * std::tan(across), step_m);
    EXPECT_NEAR(s.north - (-10 + 2.5 * double(s.ping)), 20 * std::tan(tilt) / std::cos(across), step_m);
    EXPECT_NEAR(s.up, 0, step_m);
    // On the beam's axis exactly, at the measured range.
    EXPECT_NEAR(s.north - (-10 + 2.5 * double(s.ping)), s.range * std::sin(tilt), 2e-4);
  }
}

// A tilted nadir beam sees the seabed as a beam of a pitched sonar. The planes through the forward axis that
// bound it are closer by the cosine of the tilt. The rest is of second order in the width along the track.
TEST(TransmitSectorsRun, ATiltedNadirBeamIsThatOfAPitchedSonarNarrowedByTheCosine) {
  const auto scene = [](double tilt_deg, double pitch_deg) {
    return still_water(50) + lambert_material("bed", -27) + flat_terrain(400, 400) +
           fixed_at(3, -2, 20, fmt::format("pitch_deg = {}\n", pitch_deg)) +
           fmt::format(
               "[[sensors]]\nname = \"sonar\"\nkind = \"multibeam\"\nbeams = 1\nbeam_across_deg = 1\n"
               "along_track_deg = 2\nrange_min_m = 1\nrange_max_m = 41\nsamples = 800\n"
               "cone_tolerance = 1e-6\nsector_tilts_deg = [{}]\n",
               tilt_deg);
  };
  const Echoes tilted = echoes_of(scene(25, 0)), pitched = echoes_of(scene(0, 25));
  EXPECT_GT(pitched.total(), 0);
  const double narrowed = std::cos(25 * degree);
  EXPECT_NEAR(tilted.total() / pitched.total(), narrowed, 2e-4);
  for (std::size_t k = 0; k < pitched.samples; ++k)
    EXPECT_NEAR(tilted.at(0, 0, k), narrowed * pitched.at(0, 0, k), 0.003 * pitched.total()) << k;
}

/// Ratios of energies per range bin lie between those of the attenuations at both ends of the bin.
void expect_attenuated(const Echoes& with, const Echoes& without, std::size_t beam, double db_per_km) {
  std::size_t compared = 0;
  for (std::size_t k = 0; k < with.samples; ++k) {
    if (!(without.at(0, beam, k) > 0)) continue;
    const auto at = [&](double range_m) { return std::pow(10, -2 * db_per_km * range_m / 1e4); };
    const double ratio = with.at(0, beam, k) / without.at(0, beam, k);
    EXPECT_GT(ratio, at(with.last_m(k)) * (1 - 1e-9)) << beam << " " << k;
    EXPECT_LT(ratio, at(with.first_m(k)) * (1 + 1e-9)) << beam << " " << k;
    ++compared;
  }
  EXPECT_GT(compared, 0u);
}

TEST(TransmitSectorsRun, FrequencyAndOwnAbsorptionAttenuateAsAnExponential) {
  const std::string scene = line_scene("[water]\nsound_speed_m_s = 1500\n");
  const Echoes lossless = echoes_of(line_scene(still_water(0)) + line_sensor("sonar", three_edges));
  const Echoes by_frequency =
      echoes_of(scene + line_sensor("sonar", three_edges + "sector_frequencies_khz = [100, 240, 400]\n"));
  const Echoes own = echoes_of(
      scene + line_sensor("sonar", three_edges + "sector_absorptions_db_per_km = [20, 77.5, 900]\n"));
  WaterDescription water;
  water.sound_speed_m_s = 1500;
  const std::array khz{100.0, 240.0, 400.0}, given{20.0, 77.5, 900.0};
  for (const std::size_t beam : {0u, 12u, 30u}) {
    expect_attenuated(by_frequency, lossless, beam, absorption_db_per_km(water, khz[sector_of(beam)]));
    expect_attenuated(own, lossless, beam, given[sector_of(beam)]);
  }
}

// In stratified water, each sector has rays with its own absorption. A profile of nearly constant speed
// refracts little, so that the attenuation is that of straight rays.
TEST(TransmitSectorsRun, StratifiedWaterAttenuatesEachSectorByItsAbsorption) {
  const auto water = [](double db_per_km) {
    return fmt::format(
        "[water]\nprofile = \"gradient\"\nsound_speed_m_s = 1500\ngradient_per_s = 0.001\n"
        "profile_bottom_m = 100\nsurface_height_m = 25\nabsorption_db_per_km = {}\n",
        db_per_km);
  };
  const Echoes lossless = echoes_of(line_scene(water(0)) + line_sensor("sonar", three_edges));
  const Echoes own =
      echoes_of(line_scene(water(50)) +
                line_sensor("sonar", three_edges + "sector_absorptions_db_per_km = [20, 77.5, 900]\n"));
  const std::array given{20.0, 77.5, 900.0};
  for (const std::size_t beam : {2u, 12u, 28u}) {
    double with = 0, without = 0, middle_m = 0;
    for (std::size_t k = 0; k < own.samples; ++k) {
      with += own.at(0, beam, k);
      without += lossless.at(0, beam, k);
      middle_m += lossless.at(0, beam, k) * (own.first_m(k) + own.last_m(k)) / 2;
    }
    const double db = 10 * std::log10(without / with);
    EXPECT_NEAR(db, 2 * given[sector_of(beam)] * middle_m / without / 1000, 0.01 * db) << beam;
  }
}

TEST(TransmitSectorsRun, ADelayBeyondTheEndOfTheTrajectoryOrThePingIsAnError) {
  const TestFolder folder;
  folder.write("scene.toml",
               line_scene() +
                   replaced(line_sensor("sonar", "sector_delays_us = [600000]\n"), "pings = 3", "pings = 1") +
                   "first_ping_s = 3.9\n");
  const Outcome outcome =
      run_program({"run", (folder / "scene.toml").string(), "-o", (folder / "out").string(), "--quiet"});
  EXPECT_NE(outcome.exit_code, 0);
  EXPECT_THAT(outcome.err, HasSubstr("but the trajectory ends"));
}

/// The stored values of an array of the first ping of a GSF file, one number of `bytes` each.
std::vector<double> gsf_array(const std::filesystem::path& path, unsigned id, unsigned bytes) {
  samples::PacketReader file(samples::file_content(path), true);
  for (std::size_t at = 0; at < file.size(); at += 8 + file.u32(at)) {
    if ((file.u32(at + 4) & 0x3FFFFF) != 2) continue;
    samples::PacketReader ping(file.part(at + 8, file.u32(at)), true);
    const auto beams = static_cast<std::size_t>(ping.i16(16));
    for (std::size_t place = 56; place + 4 < ping.size(); place += 4 + (ping.u32(place) & 0xFFFFFF)) {
      if (ping.u8(place) != id) continue;
      EXPECT_EQ(ping.u32(place) & 0xFFFFFF, beams * bytes);
      std::vector<double> values;
      for (std::size_t beam = 0; beam < beams; ++beam)
        values.push_back(bytes == 1 ? ping.u8(place + 4 + beam) : ping.u16(place + 4 + 2 * beam));
      return values;
    }
  }
  throw std::runtime_error("no such array");
}

TEST(TransmitSectorsRun, FilesContainTheSectors) {
  const TestFolder folder;
  run(folder,
      line_scene() +
          line_sensor("sonar", three_edges +
                                   "sector_tilts_deg = [-6, 2, 10]\nsector_delays_us = [0, 200, 400]\n"
                                   "sector_frequencies_khz = [260, 320, 290]\n"
                                   "sector_pulse_lengths_us = [70, 100, 150]\n"
                                   "sector_absorptions_db_per_km = [60, 90, 75]\n"));
  const NetcdfReader echoes(folder / "out/echoes.nc");
  EXPECT_THAT(echoes.values("/", "sector_frequency_khz"), testing::ElementsAre(260, 320, 290));
  EXPECT_THAT(echoes.values("/", "sector_delay"),
              testing::Pointwise(testing::DoubleNear(1e-12), {0.0, 200e-6, 400e-6}));
  EXPECT_THAT(echoes.values("/", "sector_absorption_db_per_km"), testing::ElementsAre(60, 90, 75));
  const NetcdfReader sonar(folder / "out/sonar-sonar.nc");
  const std::string beams = "/Sonar/Beam_group1";
  EXPECT_EQ(sonar.length(beams, "tx_beam"), 3u);
  const std::array tilt_deg{-6.0, 2.0, 10.0}, khz{260.0, 320.0, 290.0}, pulse_us{70.0, 100.0, 150.0},
      db_per_km{60.0, 90.0, 75.0};
  for (std::size_t t = 0; t < 3; ++t) {
    EXPECT_NEAR(echoes.values("/", "sector_tilt").at(t), tilt_deg[t], 1e-9);
    EXPECT_NEAR(echoes.values("/", "sector_pulse_length").at(t), pulse_us[t] * 1e-6, 1e-15);
    EXPECT_NEAR(sonar.values(beams, "tx_beam_rotation_theta").at(t), tilt_deg[t], 1e-5);
    EXPECT_NEAR(sonar.values(beams, "transmit_frequency_start").at(t), khz[t] * 1e3, 1);
    EXPECT_NEAR(sonar.values(beams, "transmit_duration_nominal").at(t), pulse_us[t] * 1e-6, 1e-9);
    EXPECT_NEAR(sonar.values(beams, "transmit_delay").at(t), 200e-6 * double(t), 1e-9);
    EXPECT_NEAR(sonar.values(beams, "tx_beam_rotation_phi").at(t), 31.5 * (1 - double(t)), 1e-4);
    EXPECT_NEAR(sonar.values("/Environment", "frequency").at(t), khz[t] * 1e3, 1);
  }
  const auto sector = gsf_array(folder / "out/sonar.gsf", 22, 1),
             azimuth = gsf_array(folder / "out/sonar.gsf", 18, 2),
             angle = gsf_array(folder / "out/sonar.gsf", 5, 2);
  for (std::size_t beam = 0; beam < 31; ++beam) {
    SCOPED_TRACE(beam);
    const std::size_t own = sector_of(beam);
    EXPECT_EQ(echoes.values("/", "beam_sector").at(beam), double(own));
    EXPECT_NEAR(echoes.values("/", "beam_tilt").at(beam), tilt_deg[own], 1e-9);
    EXPECT_EQ(sonar.values(beams, "transmit_beam_index").at(beam), double(own));
    EXPECT_EQ(sonar.values(beams + "/Bathymetry", "detection_tx_beam").at(beam), double(own));
    EXPECT_NEAR(sonar.values(beams + "/Bathymetry", "detection_mean_absorption_coefficient").at(beam),
                db_per_km[own], 1e-4);
    EXPECT_EQ(sector[beam], double(own));
    // The direction of the axis from polar angle and azimuth, counterclockwise from starboard.
    const double tilt = tilt_deg[own] * degree, across = (-45 + 3 * double(beam)) * degree;
    const double polar = (angle[beam] > 32767 ? angle[beam] - 65536 : angle[beam]) / 100 * degree,
                 turn = azimuth[beam] / 100 * degree;
    if (std::abs(across) > 1e-9) {
      EXPECT_EQ(polar < 0, across < 0);
    }
    EXPECT_NEAR(std::sin(std::abs(polar)) * std::sin(turn), std::sin(tilt), 3e-4);
    EXPECT_NEAR(std::sin(std::abs(polar)) * std::cos(turn), std::cos(tilt) * std::sin(across), 3e-4);
  }
  // XTF: a header of 256 bytes, then a record of 64 bytes per sounding.
  samples::PacketReader xtf(samples::file_content(folder / "out/sonar.xtf"), false);
  std::size_t found = 0;
  for (std::size_t at = 1024; at + 14 < xtf.size(); at += xtf.u32(at + 10)) {
    ASSERT_EQ(xtf.u16(at), 0xFACEu);
    if (xtf.u8(at + 2) != 28) continue;
    for (std::size_t k = 0; k < xtf.u16(at + 4); ++k) {
      const std::size_t record = at + 256 + 64 * k, own = sector_of(xtf.u32(record));
      EXPECT_NEAR(xtf.f64(record + 24), 200e-6 * double(own), 1e-9);
      EXPECT_NEAR(xtf.f64(record + 32), -45 + 3 * double(xtf.u32(record)), 1e-9);
      EXPECT_NEAR(xtf.f64(record + 40), tilt_deg[own], 1e-9);
      ++found;
    }
  }
  EXPECT_EQ(found, 93u);
}

}  // namespace
}  // namespace tubefoot
