// SPDX-License-Identifier: GPL-3.0-or-later
// Tests the reader of echo files: files of tubefoot and of other programs, optional variables, invalid
// layouts, excessive sizes and truncated files.

#include "sensors/recordings/echo_reader.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <limits>

#include "files/input_error.hpp"
#include "fixtures/foreign_echoes.hpp"
#include "fixtures/world/recordings.hpp"
#include "geometry/numbers/scalars.hpp"

namespace tubefoot {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

struct EchoReader : testing::Test {
  TestFolder folder;
  std::filesystem::path file = folder / "echoes.nc";
  ForeignGroup group = least_echoes();

  ForeignVariable& variable(const char* name) { return group.variables[name]; }

  std::string refusal_of_file() const {
    try {
      read_echo_file(file);
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), HasSubstr(file.string() + ": "));
      return error.what();
    }
    ADD_FAILURE() << "no error";
    return {};
  }
  /// Writes `group`, which must be rejected, and resets it.
  std::string refusal(int mode = NC_NETCDF4) {
    write_foreign(file, group, {}, mode);
    group = least_echoes();
    return refusal_of_file();
  }
};

TEST_F(EchoReader, ReadsWhatTubefootWrites) {
  auto camera = samples::silent(samples::camera(4, 8), 3);
  for (std::size_t k = 0; k < camera.energies.size(); ++k)
    camera.energies[k] = k % 5 ? std::exp(-0.37 * double(k)) / 3 : 0;
  auto sidescan = samples::silent(samples::sidescan(6), 2);
  write_echoes(file, {camera.recording, sidescan.recording},
               {"A test", "0123abcd", "tube", "fixed", "0.1.0"});
  const EchoContents contents = read_echo_file(file);
  EXPECT_EQ(contents.file, file);
  EXPECT_EQ(contents.provenance.title, "A test");
  EXPECT_EQ(contents.provenance.scene_hash, "0123abcd");
  EXPECT_EQ(contents.provenance.engine, "tube");
  EXPECT_EQ(contents.provenance.arithmetic, "fixed");
  EXPECT_EQ(contents.provenance.version, "0.1.0");
  ASSERT_THAT(contents.sensors, SizeIs(2));
  const SensorEchoes& echoes = contents.sensors[0];
  EXPECT_EQ(echoes.name, "camera");
  EXPECT_EQ(echoes.pings, 3u);
  EXPECT_EQ(echoes.beams, 4u);
  EXPECT_EQ(echoes.samples, 8u);
  EXPECT_EQ(echoes.energy, camera.energies);
  EXPECT_EQ(echoes.at(2, 1, 5), camera.energy(2, 1, 5));
  EXPECT_THAT(echoes.energy_bound, IsEmpty());
  EXPECT_EQ(echoes.ping_time_s, camera.recording.ping_time_s);
  EXPECT_DOUBLE_EQ(echoes.slant_range_m[1], 0.84 + 1.5 * 5 / 8);
  EXPECT_DOUBLE_EQ(echoes.slant_range_bounds_m[3], 0.84 + 2 * 5.0 / 8);
  EXPECT_THAT(echoes.beam_azimuth_deg,
              testing::Pointwise(testing::DoubleNear(1e-12), {-10.875, -3.625, 3.625, 10.875}));
  EXPECT_THAT(echoes.beam_elevation_deg, ElementsAre(0, 0, 0, 0));
  EXPECT_EQ(contents.sensors[1].name, "sidescan");
  EXPECT_EQ(contents.sensors[1].beams, 2u);
}

TEST_F(EchoReader, ThreeVariablesAreEnoughInEitherFormat) {
  for (const int mode : {NC_NETCDF4, 0, NC_64BIT_OFFSET, NC_64BIT_DATA, NC_NETCDF4 | NC_CLASSIC_MODEL}) {
    SCOPED_TRACE(mode);
    write_foreign(file, group, {}, mode);
    const EchoContents contents = read_echo_file(file);
    EXPECT_THAT(contents.provenance.scene_hash, IsEmpty());
    ASSERT_THAT(contents.sensors, SizeIs(1));
    const SensorEchoes& echoes = contents.sensors[0];
    EXPECT_EQ(echoes.name, "sensor");
    EXPECT_EQ(echoes.energy, group.variables["energy"].values);
    EXPECT_THAT(echoes.slant_range_m, ElementsAre(2, 2.5, 3, 3.5));
    EXPECT_THAT(echoes.beam_azimuth_deg, ElementsAre(-10, 0, 10));
    EXPECT_THAT(echoes.ping_time_s, IsEmpty());
    EXPECT_THAT(echoes.beam_elevation_deg, IsEmpty());
    EXPECT_THAT(echoes.slant_range_bounds_m, IsEmpty());
  }
}

TEST_F(EchoReader, Float32AndOtherSpellingsOfUnitsAreUnderstood) {
  variable("energy").type = NC_FLOAT;
  variable("energy").units = "joule";
  variable("slant_range").units = "metres";
  variable("beam_azimuth").units = "degrees";
  variable("energy").fill = 0;  // zero is then both an energy and the fill value
  write_foreign(file, group);
  EXPECT_EQ(read_echo_file(file).sensors[0].energy[1], double(1e-9f));
}

TEST_F(EchoReader, TextsMayBeStringsAsHdf5LibrariesWriteThem) {
  write_foreign(file, group);
  int id = 0, energy = 0;
  foreign::require(nc_open(file.c_str(), NC_WRITE, &id));
  foreign::require(nc_inq_varid(id, "energy", &energy));
  const char *unit = "J", *hash = "0123", padded[] = "tank\0\0\0";
  foreign::require(nc_del_att(id, energy, "units"));
  foreign::require(nc_put_att_string(id, energy, "units", 1, &unit));
  foreign::require(nc_put_att_string(id, NC_GLOBAL, "scene_hash", 1, &hash));
  foreign::require(nc_put_att_text(id, NC_GLOBAL, "sensor_name", 7, padded));
  foreign::require(nc_close(id));
  const EchoContents contents = read_echo_file(file);
  EXPECT_EQ(contents.provenance.scene_hash, "0123");
  EXPECT_EQ(contents.sensors[0].name, "tank");
}

TEST_F(EchoReader, GroupsAreSensorsIfTheyHaveEnergies) {
  ForeignGroup named = group;
  named.attributes["sensor_name"] = "bow";
  write_foreign(file, {}, {{"first", group}, {"notes", {}}, {"second", named}});
  const EchoContents contents = read_echo_file(file);
  ASSERT_THAT(contents.sensors, SizeIs(2));
  EXPECT_EQ(contents.sensors[0].name, "first");
  EXPECT_EQ(contents.sensors[1].name, "bow");
  write_foreign(file, {}, {{"first", named}, {"second", named}});
  EXPECT_THAT(refusal_of_file(), HasSubstr("two groups have the sensor_name 'bow'"));
  named.variables["slant_range"].units = "km";
  write_foreign(file, {}, {{"first", group}, {"second", named}});
  EXPECT_THAT(refusal_of_file(), HasSubstr("variable 'second/slant_range' has unit 'km', expected 'm'"));
  write_foreign(file, {}, {{"notes", {}}});
  EXPECT_THAT(refusal_of_file(), HasSubstr("has no variable 'energy', neither in its root nor in a group"));
}

TEST_F(EchoReader, EnergyBoundIsReadIfItIsThere) {
  std::vector<double> half_widths(24, 1e-15);
  half_widths[7] = infinite;
  group.variables["energy_bound"] = {{"ping", "beam", "sample"}, "J", half_widths};
  write_foreign(file, group);
  EXPECT_EQ(read_echo_file(file).sensors[0].energy_bound, half_widths);
  for (const double bad : {-1e-15, nan}) {
    half_widths[7] = bad;
    group.variables["energy_bound"] = {{"ping", "beam", "sample"}, "J", half_widths};
    EXPECT_THAT(refusal(), AllOf(HasSubstr("'energy_bound' holds"), HasSubstr("ping 0, beam 1, sample 3"),
                                 HasSubstr("half-widths of at least 0")));
  }
  group.variables["energy_bound"] = {{"sample"}, "J", {1, 2, 3, 4}};
  EXPECT_THAT(refusal(), HasSubstr("'energy_bound' has dimensions (sample), expected (ping, beam, sample)"));
  group.variables["energy_bound"] = {{"ping", "beam", "sample"}, "dB", half_widths};
  EXPECT_THAT(refusal(), HasSubstr("'energy_bound' has unit 'dB', expected 'J m-2'"));
}

TEST_F(EchoReader, MissingVariablesAreNamed) {
  for (const auto& [name, dimensions] :
       std::map<std::string, std::string>{{"slant_range", "dimensions (sample) and unit 'm'"},
                                          {"beam_azimuth", "dimensions (beam) and unit 'degree'"}}) {
    group.variables.erase(name);
    EXPECT_THAT(refusal(), HasSubstr(fmt::format("variable '{}' is missing; expected {}", name, dimensions)));
  }
  group.variables.erase("energy");
  EXPECT_THAT(refusal(), HasSubstr("has no variable 'energy'"));
}

TEST_F(EchoReader, DimensionsTypesAndUnitsMustBeTheLayouts) {
  variable("energy").dimensions = {"beam", "ping", "sample"};
  EXPECT_THAT(refusal(),
              HasSubstr("'energy' has dimensions (beam, ping, sample), expected (ping, beam, sample)"));
  variable("energy").type = NC_INT;
  EXPECT_THAT(refusal(), HasSubstr("'energy' has type int, expected float64 (or float32)"));
  variable("energy").units = "dB";
  EXPECT_THAT(refusal(), HasSubstr("'energy' has unit 'dB', expected 'J m-2'"));
  variable("slant_range").units.reset();
  EXPECT_THAT(refusal(), HasSubstr("'slant_range' has no unit, expected 'm'"));
  variable("beam_azimuth").units = "radian";
  EXPECT_THAT(refusal(), HasSubstr("'beam_azimuth' has unit 'radian', expected 'degree'"));
  group.variables["ping_time"] = {{"ping"}, "ms", {0, 1}};
  EXPECT_THAT(refusal(), HasSubstr("'ping_time' has unit 'ms', expected 's'"));
  group.attributes["source_energy"] = "1 J";
  EXPECT_THAT(refusal(),
              HasSubstr("assumes a source of '1 J' (attribute source_energy), expected '1 J/sr at 1 m'"));
  group.dimensions.emplace_back("bound", 3);
  group.variables["slant_range_bounds"] = {{"sample", "bound"}, "m", std::vector<double>(12, 1.0)};
  EXPECT_THAT(refusal(), HasSubstr("'slant_range_bounds' has 4 x 3 values, expected 4 x 2"));
}

TEST_F(EchoReader, EnergiesMustBeFiniteAndNotNegative) {
  for (const double bad : {nan, infinite, -1e-12}) {
    variable("energy").values[17] = bad;
    EXPECT_THAT(refusal(), AllOf(HasSubstr(fmt::format("'energy' holds {} at ping 1, beam 1, sample 1", bad)),
                                 HasSubstr("expected finite energies of at least 0")));
  }
  variable("slant_range").values = {2, 2.5, 2.5, 3};
  EXPECT_THAT(refusal(), HasSubstr("'slant_range' goes from 2.5 to 2.5 at sample 2"));
  variable("beam_azimuth").values[2] = nan;
  EXPECT_THAT(refusal(), HasSubstr("'beam_azimuth' holds nan at beam 2; expected a finite number"));
}

TEST_F(EchoReader, WhatWasNeverWrittenIsNoEcho) {
  for (const int mode : {NC_NETCDF4, 0}) {
    variable("energy").values.clear();
    EXPECT_THAT(refusal(mode), HasSubstr("'energy' has no value at ping 0, beam 0, sample 0"));
    variable("energy").values.clear();
    variable("energy").type = NC_FLOAT;
    EXPECT_THAT(refusal(mode), HasSubstr("'energy' has no value"));
  }
  variable("slant_range").values.clear();
  EXPECT_THAT(refusal(), HasSubstr("'slant_range' has no value at sample 0"));
  variable("energy").fill = 1e20;
  variable("energy").values[6] = 1e20;
  EXPECT_THAT(refusal(), HasSubstr("'energy' has no value at ping 0, beam 1, sample 2"));
}

TEST_F(EchoReader, HugeClaimsAreRefusedBeforeAnythingIsAllocated) {
  const std::size_t gigabyte_of_doubles = std::size_t{1} << 27;
  for (const std::size_t length : {gigabyte_of_doubles, std::size_t{1} << 40, std::size_t{1} << 57}) {
    group.dimensions = {{"ping", 2}, {"beam", 3}, {"sample", length}};
    variable("energy").values.clear();
    variable("slant_range").values.clear();
    rusage before{}, after{};
    getrusage(RUSAGE_SELF, &before);
    EXPECT_THAT(refusal(), AllOf(HasSubstr(fmt::format("'energy' declares 2 x 3 x {} values", length)),
                                 HasSubstr("more than the file's")));
    getrusage(RUSAGE_SELF, &after);
    EXPECT_LT(after.ru_maxrss - before.ru_maxrss, 100'000) << "kibibytes";
  }
  group.dimensions[0].second = NC_UNLIMITED;  // without written data
  variable("energy").values.clear();
  EXPECT_THAT(refusal(), HasSubstr("'energy' is empty (0 x 3 x 4)"));
}

TEST_F(EchoReader, FilesThatAreNone) {
  EXPECT_THAT(refusal_of_file(), HasSubstr("there is no such file"));
  for (const std::string content :
       {"", "ping,beam,sample\n0,0,1\n", "\x89HDF\r\n\x1a\n", "CDF\1", "CDF\5 and more"}) {
    std::ofstream(file, std::ios::binary) << content;
    EXPECT_THAT(refusal_of_file(),
                testing::AnyOf(HasSubstr("cannot be read as netCDF"), HasSubstr("is cut off")));
  }
  std::filesystem::remove(file);
  std::filesystem::create_directory(file);
  EXPECT_THAT(refusal_of_file(), HasSubstr("is a folder, expected an echo file"));
}

TEST_F(EchoReader, FilesCutOffAnywhereAreRefused) {
  for (const int mode : {NC_NETCDF4, 0}) {
    write_foreign(file, group, {}, mode);
    const std::string whole = bytes_of(file);
    for (std::size_t length = 0; length < whole.size(); length += 1 + whole.size() / 61) {
      SCOPED_TRACE(fmt::format("mode {}, {} of {} bytes", mode, length, whole.size()));
      std::ofstream(file, std::ios::binary) << whole.substr(0, length);
      refusal_of_file();
    }
    std::ofstream(file, std::ios::binary) << whole.substr(0, whole.size() - 1);
    refusal_of_file();
  }
}

}  // namespace
}  // namespace tubefoot
