// SPDX-License-Identifier: GPL-3.0-or-later
// Tests echoes.nc: its layout, compression, later changes, packed pings, behaviour on full disks, and files
// larger than the memory limit.

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <netcdf.h>
#include <sys/stat.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <thread>

#include "fixtures/netcdf_reader.hpp"
#include "fixtures/test_folder.hpp"
#include "fixtures/world/packed_recording.hpp"
#include "fixtures/world/recordings.hpp"
#include "geometry/numbers/scalars.hpp"
#include "sensors/products/pictures.hpp"
#include "sensors/recordings/receiver_output.hpp"
#include "sensors/recordings/recording.hpp"
#include "sensors/recordings/run_context.hpp"

namespace tubefoot {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

const Provenance provenance{"A test", "0123abcd", "tube", "fixed", "0.1.0"};

samples::OwnedRecording noisy_camera(int pings = 3) {
  auto made = samples::silent(samples::camera(4, 8), pings);
  for (std::size_t k = 0; k < made.energies.size(); ++k)
    made.energies[k] = k % 5 ? std::exp(-0.37 * double(k)) / 3 : 0;
  for (std::size_t ping = 0; ping < made.recording.ping_pose.size(); ++ping)
    made.recording.ping_pose[ping].attitude =
        attitude_from_angles((350 - 90.0 * double(ping)) * degree, -20 * degree, 5 * double(ping) * degree);
  return made;
}

TEST(EchoFile, NumbersTheLinesOfASurvey) {
  const TestFolder folder;
  auto made = noisy_camera(5);
  write_echoes(folder / "whole.nc", {made.recording}, provenance);
  EXPECT_THAT(NetcdfReader(folder / "whole.nc").variables("/"), Not(Contains("line")));
  made.recording.line_starts = {0, 2};
  write_echoes(folder / "lines.nc", {made.recording}, provenance);
  EXPECT_THAT(NetcdfReader(folder / "lines.nc").values("/", "line"), ElementsAre(1, 1, 2, 2, 2));
}

TEST(EchoFile, ReadsBackBitForBit) {
  const TestFolder folder;
  const auto made = noisy_camera();
  const Recording& recording = made.recording;
  write_echoes(folder / "echoes.nc", {recording}, provenance);
  const NetcdfReader file(folder / "echoes.nc");

  EXPECT_EQ(file.dimensions("/", "energy"), "ping,beam,sample");
  EXPECT_EQ(file.values("/", "energy"), made.energies);
  EXPECT_EQ(file.values("/", "ping_time"), recording.ping_time_s);
  const auto centres = file.values("/", "slant_range"), bounds = file.values("/", "slant_range_bounds"),
             travel = file.values("/", "two_way_travel_time");
  ASSERT_EQ(centres.size(), 8u);
  for (std::size_t k = 0; k < 8; ++k) {
    EXPECT_DOUBLE_EQ(bounds[2 * k], 0.84 + 5.0 / 8 * double(k));
    EXPECT_DOUBLE_EQ(bounds[2 * k + 1], 0.84 + 5.0 / 8 * double(k + 1));
    EXPECT_DOUBLE_EQ(centres[k], (bounds[2 * k] + bounds[2 * k + 1]) / 2);
    EXPECT_DOUBLE_EQ(travel[k], 2 * centres[k] / 1480);
  }
  EXPECT_THAT(file.values("/", "beam_azimuth"),
              testing::Pointwise(testing::DoubleNear(1e-12), {-10.875, -3.625, 3.625, 10.875}));
  EXPECT_THAT(file.values("/", "beam_elevation"), ElementsAre(0, 0, 0, 0));
  EXPECT_THAT(file.values("/", "beam_azimuth_width"), testing::Each(testing::DoubleNear(7.25, 1e-12)));
  EXPECT_THAT(file.values("/", "beam_elevation_width"), testing::Each(testing::DoubleNear(14, 1e-12)));

  EXPECT_EQ(file.dimensions("/", "sensor_position"), "ping,xyz");
  EXPECT_THAT(file.values("/", "sensor_position"), ElementsAre(0, 0, -5, 0, 0.5, -5, 0, 1, -5));
  EXPECT_EQ(file.dimensions("/", "sensor_attitude"), "ping,wxyz");
  const auto attitude = file.values("/", "sensor_attitude");
  for (std::size_t ping = 0; ping < 3; ++ping) {
    const glm::dquat q = recording.ping_pose[ping].attitude;
    EXPECT_THAT(std::vector<double>(attitude.begin() + long(4 * ping), attitude.begin() + long(4 * ping + 4)),
                testing::Pointwise(testing::DoubleNear(1e-15), {q.w, q.x, q.y, q.z}));
  }
  EXPECT_THAT(file.values("/", "sensor_heading"),
              testing::Pointwise(testing::DoubleNear(1e-9), {350.0, 260.0, 170.0}));
  EXPECT_THAT(file.values("/", "sensor_pitch"), testing::Each(testing::DoubleNear(-20, 1e-9)));
  EXPECT_THAT(file.values("/", "sensor_roll"),
              testing::Pointwise(testing::DoubleNear(1e-9), {0.0, 5.0, 10.0}));
}

TEST(EchoFile, HeadingOfASensorThatLooksStraightDownIsItsWholeTurn) {
  const TestFolder folder;
  auto made = noisy_camera(1);
  made.recording.ping_pose[0].attitude = attitude_from_angles(70 * degree, -90 * degree, 0);
  write_echoes(folder / "echoes.nc", {made.recording}, provenance);
  const NetcdfReader file(folder / "echoes.nc");
  EXPECT_NEAR(file.values("/", "sensor_heading")[0], 70, 1e-6);
  EXPECT_NEAR(file.values("/", "sensor_pitch")[0], -90, 1e-6);
  EXPECT_NEAR(file.values("/", "sensor_roll")[0], 0, 1e-6);
}

TEST(EchoFile, EveryVariableHasUnitsAndALongName) {
  const TestFolder folder;
  write_echoes(folder / "echoes.nc", {noisy_camera().recording}, provenance);
  const NetcdfReader file(folder / "echoes.nc");
  EXPECT_EQ(file.variables("/").size(), 14u);
  for (const std::string& variable : file.variables("/")) {
    EXPECT_FALSE(file.text("/", "units", variable.c_str()).empty());
    EXPECT_FALSE(file.text("/", "long_name", variable.c_str()).empty());
  }
  const auto units = [&](const char* name) { return file.text("/", "units", name); };
  EXPECT_EQ(units("energy"), "J m-2");
  EXPECT_EQ(units("ping_time"), "s");
  EXPECT_EQ(units("slant_range"), "m");
  EXPECT_EQ(units("slant_range_bounds"), "m");
  EXPECT_EQ(units("two_way_travel_time"), "s");
  EXPECT_EQ(units("beam_azimuth"), "degree");
  EXPECT_EQ(units("sensor_position"), "m");
  EXPECT_EQ(units("sensor_attitude"), "1");
  EXPECT_EQ(units("sensor_heading"), "degree");
}

TEST(EchoFile, SaysWhereItComesFrom) {
  const TestFolder folder;
  write_echoes(folder / "echoes.nc", {noisy_camera().recording}, provenance);
  const NetcdfReader file(folder / "echoes.nc");
  EXPECT_EQ(file.text("/", "title"), "A test");
  EXPECT_EQ(file.text("/", "Conventions"), "tubefoot-echoes-1.0");
  EXPECT_EQ(file.text("/", "scene_hash"), "0123abcd");
  EXPECT_EQ(file.text("/", "engine"), "tube");
  EXPECT_EQ(file.text("/", "arithmetic"), "fixed");
  EXPECT_EQ(file.text("/", "version"), "0.1.0");
  EXPECT_EQ(file.text("/", "sensor_name"), "camera");
  EXPECT_EQ(file.text("/", "sensor_kind"), "didson");
  EXPECT_EQ(file.text("/", "source_energy"), "1 J/sr at 1 m");
  EXPECT_EQ(file.number("/", "frequency_khz"), 1800);
  EXPECT_EQ(file.number("/", "sound_speed_m_s"), 1480);
  EXPECT_EQ(file.number("/", "absorption_db_per_km"), 700);
  write_echoes(folder / "unsaid.nc", {noisy_camera().recording}, {});
  EXPECT_EQ(NetcdfReader(folder / "unsaid.nc").text("/", "arithmetic"), "");
}

TEST(EchoFile, EnergyIsCompressedPingByPing) {
  const TestFolder folder;
  write_echoes(folder / "echoes.nc", {noisy_camera().recording}, provenance);
  const NetcdfReader file(folder / "echoes.nc");
  int storage = 0, shuffle = 0, deflate = 0, level = 0;
  std::size_t chunk[3];
  NetcdfReader::check(nc_inq_var_chunking(file.group("/"), file.find("/", "energy"), &storage, chunk),
                      "chunking");
  NetcdfReader::check(
      nc_inq_var_deflate(file.group("/"), file.find("/", "energy"), &shuffle, &deflate, &level), "deflate");
  EXPECT_EQ(storage, NC_CHUNKED);
  EXPECT_THAT(chunk, ElementsAre(1u, 4u, 8u));
  EXPECT_EQ(shuffle, 1);
  EXPECT_EQ(deflate, 1);
}

TEST(EchoFile, SeveralRecordingsAreAGroupEach) {
  const TestFolder folder;
  const auto camera = noisy_camera();
  auto sidescan = samples::silent(samples::sidescan(6), 2);
  sidescan.energy(1, 0, 3) = 4.5e-9;
  write_echoes(folder / "echoes.nc", {camera.recording, sidescan.recording}, provenance);
  const NetcdfReader file(folder / "echoes.nc");
  EXPECT_EQ(file.text("/", "scene_hash"), "0123abcd");
  EXPECT_TRUE(file.variables("/").empty());
  EXPECT_EQ(file.values("/camera", "energy"), camera.energies);
  EXPECT_EQ(file.text("/sidescan", "sensor_kind"), "sidescan");
  EXPECT_EQ(file.values("/sidescan", "energy"), sidescan.energies);
  EXPECT_THAT(file.values("/sidescan", "beam_azimuth"), ElementsAre(-90, 90));
}

TEST(EchoFile, IsTheSameByteForByteAtAnotherTime) {
  const TestFolder folder;
  const auto camera = noisy_camera();
  const auto sidescan = samples::silent(samples::sidescan(6), 2);
  write_echoes(folder / "a.nc", {camera.recording, sidescan.recording}, provenance);
  std::this_thread::sleep_for(std::chrono::milliseconds(1100));  // HDF5 stores times in seconds
  write_echoes(folder / "b.nc", {camera.recording, sidescan.recording}, provenance);
  EXPECT_EQ(bytes_of(folder / "a.nc"), bytes_of(folder / "b.nc"));
}

// netCDF opens a file for writing only if the file keeps the order of creation of its variables.
TEST(EchoFile, TakesChangesWhenOpenedForWriting) {
  const TestFolder folder;
  const auto camera = noisy_camera();
  const auto sidescan = samples::silent(samples::sidescan(6), 2);
  write_echoes(folder / "one.nc", {camera.recording}, provenance);
  write_echoes(folder / "two.nc", {camera.recording, sidescan.recording}, provenance);
  for (const auto& [name, path] : {std::pair{"one.nc", "/"}, std::pair{"two.nc", "/camera"}}) {
    int id = 0, group = 0, energy = 0;
    ASSERT_EQ(nc_open((folder / name).c_str(), NC_WRITE, &id), NC_NOERR) << name;
    ASSERT_EQ(nc_inq_grp_full_ncid(id, path, &group), NC_NOERR);
    ASSERT_EQ(nc_inq_varid(group, "energy", &energy), NC_NOERR);
    const std::size_t at[] = {1, 2, 3};
    const double value = 4.25;
    EXPECT_EQ(nc_put_var1_double(group, energy, at, &value), NC_NOERR);
    EXPECT_EQ(nc_put_att_text(id, NC_GLOBAL, "title", 7, "another"), NC_NOERR);
    EXPECT_EQ(nc_put_att_text(group, energy, "comment", 4, "mine"), NC_NOERR);
    EXPECT_EQ(nc_close(id), NC_NOERR);
    const NetcdfReader file(folder / name);
    std::vector<double> expected = camera.energies;
    expected[(1 * 4 + 2) * 8 + 3] = value;
    EXPECT_EQ(file.values(path, "energy"), expected);
    EXPECT_EQ(file.text("/", "title"), "another");
    EXPECT_EQ(file.text(path, "comment", "energy"), "mine");
    EXPECT_EQ(file.values(path, "ping_time"), camera.recording.ping_time_s);
  }
}

TEST(EchoFile, NamesTheFileThatCannotBeMade) {
  const TestFolder folder;
  const auto made = noisy_camera();
  for (const auto& file :
       {folder / "absent/echoes.nc", std::filesystem::path("/proc/echoes.nc"), folder.path()})
    samples::failure_naming(file, [&] { write_echoes(file, {made.recording}, provenance); });
  EXPECT_TRUE(std::filesystem::is_directory(folder.path()));
}

TEST(EchoFile, AFullDiskIsAnErrorAndLeavesNothing) {
  const TestFolder folder;
  auto made = samples::silent(samples::camera(), 4);
  std::uint64_t state = 1;  // incompressible
  for (double& energy : made.energies)
    energy = double(state = state * 6364136223846793005u + 1442695040888963407u);
  const auto file = folder / "echoes.nc";
  write_echoes(file, {made.recording}, provenance);
  const auto size = std::filesystem::file_size(file);
  // The disk is full at the start, within the data, and at the very end.
  for (const auto room : {std::uintmax_t(0), std::uintmax_t(4096), size / 2, size - 1}) {
    std::filesystem::remove(file);
    const samples::FullDisk full(room);
    samples::failure_naming(file, [&] { write_echoes(file, {made.recording}, provenance); });
    EXPECT_FALSE(std::filesystem::exists(file)) << "room for " << room << " bytes";
  }
  std::filesystem::create_symlink("/dev/full", file);
  samples::failure_naming(file, [&] { write_echoes(file, {made.recording}, provenance); });
  EXPECT_TRUE(std::filesystem::exists("/dev/full"));
  // Afterwards netCDF works again.
  write_echoes(folder / "second.nc", {made.recording}, provenance);
  EXPECT_EQ(NetcdfReader(folder / "second.nc").values("/", "energy"), made.energies);
}

constexpr int pings_beyond_memory = 70'000;  // 17.9 MB of energies; up to 16 MiB are built in memory

TEST(EchoFile, KeepsNoSpaceThatWasSetAside) {
  const TestFolder folder;
  const auto made = samples::silent(samples::camera(4, 8), pings_beyond_memory);
  write_echoes(folder / "echoes.nc", {made.recording}, provenance);
  EXPECT_EQ(NetcdfReader(folder / "echoes.nc").values("/", "energy"), made.energies);
  struct stat file {};
  ASSERT_EQ(stat((folder / "echoes.nc").c_str(), &file), 0);
  constexpr blkcnt_t block_bytes = 512, margin_bytes = 1 << 20;
  EXPECT_LT(file.st_blocks * block_bytes, file.st_size + margin_bytes);
  const auto absent = folder / "absent/echoes.nc";
  samples::failure_naming(absent, [&] { write_echoes(absent, {made.recording}, provenance); });
}

// Pings that were packed at their creation give the same file.
TEST(EchoFile, TakesPackedPingsAsTheyAre) {
  const TestFolder folder;
  const auto made = noisy_camera(20);
  write_echoes(folder / "echoes.nc", {made.recording}, provenance);
  write_echoes(folder / "packed.nc", {samples::packed(made.recording)}, provenance);
  EXPECT_EQ(bytes_of(folder / "packed.nc"), bytes_of(folder / "echoes.nc"));
  EXPECT_EQ(NetcdfReader(folder / "packed.nc").values("/", "energy"), made.energies);
}

TEST(EchoFile, IsPackedAlikeByAnyNumberOfThreads) {
  const TestFolder folder;
  const auto made = noisy_camera(20);
  for (const int threads : {1, 2, 7}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, std::size_t(threads));
    write_echoes(folder / fmt::format("{}.nc", threads), {made.recording}, provenance);
  }
  EXPECT_EQ(bytes_of(folder / "2.nc"), bytes_of(folder / "1.nc"));
  EXPECT_EQ(bytes_of(folder / "7.nc"), bytes_of(folder / "1.nc"));
}

// Otherwise HDF5 would crash at the end of the program.
TEST(EchoFile, AFullDiskIsMetBeforeALargeFileIsWritten) {
  const TestFolder folder;
  const auto made = noisy_camera(pings_beyond_memory);
  const auto file = folder / "echoes.nc";
  for (const rlim_t room : {rlim_t{4096}, rlim_t{1} << 20, rlim_t{16} << 20}) {
    const samples::FullDisk full(room);
    samples::failure_naming(file, [&] { write_echoes(file, {made.recording}, provenance); });
    EXPECT_FALSE(std::filesystem::exists(file)) << "room for " << room << " bytes";
  }
  write_echoes(file, {made.recording}, provenance);
  EXPECT_EQ(NetcdfReader(file).values("/", "energy"), made.energies);
}

TEST(EchoFile, RefusesNamesThatMakeNoGroup) {
  const TestFolder folder;
  const auto file = folder / "echoes.nc";
  const auto a = noisy_camera(), b = noisy_camera();
  EXPECT_THAT(samples::failure_naming(file,
                                      [&] {
                                        write_echoes(file, {a.recording, b.recording}, provenance);
                                      }),
              HasSubstr("camera"));
  EXPECT_FALSE(std::filesystem::exists(file));
}

TEST(EchoFile, RefusesRecordingsThatDoNotAddUp) {
  const TestFolder folder;
  const auto file = folder / "echoes.nc";
  const auto refused = [&](auto change) {
    auto made = noisy_camera();
    change(made.recording);
    EXPECT_THROW(write_echoes(file, {made.recording}, provenance), std::invalid_argument);
    std::vector<std::string> warnings;
    EXPECT_THROW(
        write_fan_pictures(folder.path(), made.recording, {}, {}, PictureSettings::Which::all, warnings),
        std::invalid_argument);
  };
  refused([](Recording& r) { r.sensor = nullptr; });
  refused([](Recording& r) { r.energy = r.energy.first(r.energy.size() - 1); });
  refused([](Recording& r) { r.ping_pose.pop_back(); });
  refused([](Recording& r) {
    const Sensor* sensor = r.sensor;
    r = {};
    r.sensor = sensor;
  });
  EXPECT_THROW(write_echoes(file, {}, provenance), std::invalid_argument);
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

/// Rounds to 24 significant bits by the specification.
double rounded(double value) {
  int exponent = 0;
  const double fraction = std::frexp(value, &exponent);
  return std::ldexp(std::nearbyint(std::ldexp(fraction, 24)), exponent - 24);
}

SensorDescription with_receiver(SensorDescription description) {
  description.signal.speckle = "rayleigh";
  description.signal.noise_level_db = 90;
  description.signal.tvg_spreading = 30;
  description.signal.pulse_length_us = 300;
  return description;
}

TEST(ReceivedData, AreThoseOfThePicturesInTheFile) {
  const TestFolder folder;
  auto camera = samples::silent(with_receiver(samples::camera(4, 8)), 3);
  for (std::size_t k = 0; k < camera.energies.size(); ++k) camera.energies[k] = k % 5 ? 1e-12 * double(k) : 0;
  RunContext run;
  run.seed = 11;
  write_echoes(folder / "echoes.nc", {camera.recording}, provenance, run);
  const NetcdfReader file(folder / "echoes.nc");
  EXPECT_EQ(file.values("/", "energy"), camera.energies);
  EXPECT_EQ(file.dimensions("/", "received"), "ping,beam,sample");
  const auto received = file.values("/", "received");
  const auto pictured = receiver_output_of(camera.recording, run);
  ASSERT_TRUE(pictured);
  std::size_t k = 0;
  for (std::size_t ping = 0; ping < 3; ++ping)
    for (const double energy : pictured->energy_of(ping)) ASSERT_EQ(received.at(k++), rounded(energy));
  EXPECT_EQ(k, received.size());
  EXPECT_EQ(file.text("/", "units", "received"), "J m-2");
  EXPECT_THAT(file.text("/", "long_name", "received"), HasSubstr("as the receiver records it"));
  EXPECT_THAT(file.text("/", "receiver", "received"), HasSubstr("speckle, noise"));
  EXPECT_EQ(file.text("/", "random_seed", "received"), "11");
  EXPECT_NEAR(file.number("/", "unit_level_db", "received"), pictured->unit_level_db, 1e-12);

  run.seed = 12;
  write_echoes(folder / "other.nc", {camera.recording}, provenance, run);
  EXPECT_NE(NetcdfReader(folder / "other.nc").values("/", "received"), received);
}

TEST(ReceivedData, AreAbsentForAnIdealReceiver) {
  const TestFolder folder;
  const auto made = noisy_camera();
  write_echoes(folder / "echoes.nc", {made.recording}, provenance);
  write_echoes(folder / "run.nc", {made.recording}, provenance, RunContext{});
  EXPECT_EQ(bytes_of(folder / "run.nc"), bytes_of(folder / "echoes.nc"));
}

TEST(ReceivedData, HaveTheMeanOfEnergyAndNoise) {
  SensorDescription description = samples::sidescan(1000);
  description.signal.speckle = "rayleigh";
  description.signal.source_level_db = 200;
  description.signal.noise_level_db = 100;  // 1e-10 J/m2
  auto made = samples::silent(description, 50);
  std::ranges::fill(made.energies, 4e-10);
  const TestFolder folder;
  write_echoes(folder / "echoes.nc", {made.recording}, provenance, RunContext{});
  double sum = 0, squares = 0;
  const auto received = NetcdfReader(folder / "echoes.nc").values("/", "received");
  for (const double energy : received) sum += energy / 5e-10, squares += energy / 5e-10 * energy / 5e-10;
  const auto n = double(received.size());
  EXPECT_NEAR(sum / n, 1, 5 / std::sqrt(n));
  EXPECT_NEAR(squares / n, 2, 5 * std::sqrt(20 / n));  // exponential: the variance of squares is 4! - 2^2
}

TEST(ReceivedData, HaveTheLevelsOfTheirCodes) {
  SensorDescription description = samples::sidescan(1000);
  description.signal.speckle = "rayleigh";
  description.signal.source_level_db = 200;
  description.signal.quantisation_bits = 8;
  description.signal.quantisation_bottom_db = 80;
  description.signal.quantisation_top_db = 131;
  auto made = samples::silent(description, 2);
  for (std::size_t k = 0; k < made.energies.size(); ++k) made.energies[k] = k % 3 ? 1e-9 : 0;
  const TestFolder folder;
  write_echoes(folder / "echoes.nc", {made.recording}, provenance, RunContext{});
  const NetcdfReader file(folder / "echoes.nc");
  EXPECT_EQ(file.number("/", "quantisation_bits", "received"), 8);
  EXPECT_EQ(file.number("/", "quantisation_bottom_db", "received"), 80);
  EXPECT_NEAR(file.number("/", "quantisation_step_db", "received"), 51.0 / 255, 1e-12);
  const double unit_db = file.number("/", "unit_level_db", "received");
  EXPECT_NEAR(unit_db, 200, 1e-12);
  const auto received = file.values("/", "received");
  std::size_t faint = 0;  // 30 dB below the mean: one of a thousand
  for (std::size_t k = 0; k < received.size(); ++k) {
    if (k % 3 == 0) {
      ASSERT_EQ(received[k], 0);
      continue;
    }
    if (received[k] == 0) {
      ++faint;
      continue;
    }
    const double code = (unit_db + 10 * std::log10(received[k]) - 80) / (51.0 / 255);
    ASSERT_NEAR(code, std::round(code), 1e-5);
    ASSERT_TRUE(code > 0.5 && code < 255.5) << code;
  }
  EXPECT_LT(faint, 20u);
}

TEST(ReceivedData, OfSelectedPingsAndBeamsAreThoseOfTheWhole) {
  auto whole = samples::silent(with_receiver(samples::camera(4, 8)), 3);
  std::ranges::fill(whole.energies, 1e-12);
  auto part = samples::silent(with_receiver(samples::camera(4, 8)), 1);
  std::ranges::fill(part.energies, 1e-12);
  part.recording.ping_numbers = {2};
  part.recording.beam_numbers = {3, 2, 1, 0};
  const auto of_whole = receiver_output_of(whole.recording, {})->energy_of(2),
             of_part = receiver_output_of(part.recording, {})->energy_of(0);
  for (std::size_t beam = 0; beam < 4; ++beam)
    for (std::size_t k = 0; k < 8; ++k) EXPECT_EQ(of_part[(3 - beam) * 8 + k], of_whole[beam * 8 + k]);
}

TEST(ReceivedData, AreTheSameForAnyNumberOfThreads) {
  const TestFolder folder;
  auto made = samples::silent(with_receiver(samples::sidescan(200)), 40);
  for (const int threads : {1, 2, 7}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, std::size_t(threads));
    write_echoes(folder / fmt::format("{}.nc", threads), {made.recording}, provenance, RunContext{});
  }
  EXPECT_EQ(bytes_of(folder / "2.nc"), bytes_of(folder / "1.nc"));
  EXPECT_EQ(bytes_of(folder / "7.nc"), bytes_of(folder / "1.nc"));
}

}  // namespace
}  // namespace tubefoot
