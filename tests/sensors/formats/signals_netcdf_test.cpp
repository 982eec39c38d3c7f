// SPDX-License-Identifier: GPL-3.0-or-later
// Tests signals.nc: files that tubefoot writes and that netCDF alone reads, and valid and invalid files of
// other origin.
#include "sensors/formats/signals_netcdf.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "files/input_error.hpp"
#include "fixtures/netcdf_reader.hpp"
#include "fixtures/refusal.hpp"
#include "fixtures/test_folder.hpp"
#include "sensors/signals/point_signals.hpp"

namespace tubefoot {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

ElementSignals signals(bool stop_and_hop = false) {
  const std::vector<Trajectory::Sample> track{{10, {{1, 2, -3}, attitude_from_angles(0.1, 0.2, 0.3)}},
                                              {11, {{1.5, 4, -3}, attitude_from_angles(0.2, 0.1, 0.3)}},
                                              {13, {{1, 9, -3.5}, attitude_from_angles(0, 0, 0)}}};
  return point_signals({{{4, 20, -11}, {0.5, 2}}}, line_array(4, {0.01, 0.002, 0}, {0.1, 0.2, 0.3}),
                       linear_chirp(95e3, 105e3, 2e-3, 0.25), {100e3, 30e3, 0.015, 500},
                       VehicleMotion(track, {10.5, 11, 12.25}, stop_and_hop), 1485);
}

class SignalsNetcdf : public testing::Test {
 protected:
  std::filesystem::path written(const ElementSignals& of) const {
    write_signals(folder_ / "signals.nc", of, {"a title", "", "", "", "1.2"});
    return folder_ / "signals.nc";
  }
  /// The file after a change by netCDF.
  template <class Change>
  std::filesystem::path changed(const Change& change) const {
    const auto file = written(signals());
    int id = 0;
    NetcdfReader::check(nc_open(file.c_str(), NC_WRITE, &id), "open");
    nc_redef(id);
    change(id);
    NetcdfReader::check(nc_close(id), "close");
    return file;
  }
  template <class Change>
  void refused(const Change& change, const std::string& what) const {
    const auto file = changed(change);
    const std::string said = refusal<InputError>([&] { read_signals(file); });
    EXPECT_THAT(said, HasSubstr(what));
    EXPECT_THAT(said, HasSubstr("signals.nc"));
  }
  TestFolder folder_;
};

int variable(int id, const char* name) {
  int found = 0;
  NetcdfReader::check(nc_inq_varid(id, name, &found), name);
  return found;
}

TEST_F(SignalsNetcdf, ComeBackToTheBit) {
  for (const bool hop : {false, true}) {
    ElementSignals own = signals(hop);
    own.matched_filtered = hop;
    const ElementSignals read = read_signals(written(own));
    EXPECT_EQ(read.pressure, own.pressure);
    EXPECT_EQ(read.sampling.baseband_hz, 100e3);
    EXPECT_EQ(read.sampling.rate_hz, 30e3);
    EXPECT_EQ(read.sampling.first_s, 0.015);
    EXPECT_EQ(read.samples(), 500u);
    EXPECT_EQ(read.sound_speed_m_s, 1485);
    EXPECT_EQ(read.waveform.start_hz, 95e3);
    EXPECT_EQ(read.waveform.stop_hz, 105e3);
    EXPECT_EQ(read.waveform.duration_s, 2e-3);
    EXPECT_EQ(read.waveform.taper, 0.25);
    EXPECT_EQ(read.matched_filtered, hop);
    EXPECT_EQ(read.motion.stop_and_hop(), hop);
    EXPECT_EQ(read.motion.ping_start_s(), own.motion.ping_start_s());
    EXPECT_EQ(read.array.receivers_m, own.array.receivers_m);
    EXPECT_EQ(read.array.transmitter_m, own.array.transmitter_m);
    ASSERT_EQ(read.motion.track().size(), 3u);
    for (const double after : {0.0, 0.013, 0.031})
      for (std::size_t ping = 0; ping < 3; ++ping) {
        EXPECT_EQ(read.motion.at(ping, after).position_m, own.motion.at(ping, after).position_m);
        EXPECT_EQ(read.motion.at(ping, after).attitude, own.motion.at(ping, after).attitude);
      }
  }
  const std::string bytes = bytes_of(written(signals()));
  EXPECT_EQ(bytes_of(written(signals())), bytes);
}

TEST_F(SignalsNetcdf, HaveTheLayoutOfTheirPage) {
  const ElementSignals own = signals();
  const NetcdfReader file(written(own));
  EXPECT_EQ(file.dimensions("/", "pressure"), "ping,receiver,sample,complex");
  EXPECT_EQ(file.type("/", "pressure"), "double");
  EXPECT_EQ(file.length("/", "ping"), 3u);
  EXPECT_EQ(file.length("/", "receiver"), 4u);
  EXPECT_EQ(file.length("/", "sample"), 500u);
  EXPECT_EQ(file.length("/", "complex"), 2u);
  EXPECT_EQ(file.number("/", "baseband_frequency"), 100e3);
  EXPECT_EQ(file.number("/", "sample_rate"), 30e3);
  EXPECT_EQ(file.text("/", "time_factor"), "exp(-i omega t)");
  EXPECT_EQ(file.text("/", "Conventions"), "tubefoot-signals-1.0");
  EXPECT_EQ(file.text("/", "title"), "a title");
  EXPECT_THAT(file.values("/", "ping_start_time"), ElementsAre(10.5, 11, 12.25));
  EXPECT_EQ(file.values("/", "sample_time")[499], own.sampling.time_s(499));
  const std::vector<double> values = file.values("/", "pressure");
  for (const std::size_t k : {0u, 1300u, 5999u}) {
    EXPECT_EQ(values[2 * k], own.pressure[k].real());
    EXPECT_EQ(values[2 * k + 1], own.pressure[k].imag());
  }
  EXPECT_EQ(file.dimensions("/", "receiver_position"), "receiver,xyz");
  EXPECT_EQ(file.values("/", "ping_position")[1], own.motion.ping_pose(0).position_m.y);
  EXPECT_EQ(file.values("/", "ping_attitude")[0], own.motion.ping_pose(0).attitude.w);
  EXPECT_THAT(file.values("/", "track_time"), ElementsAre(10, 11, 13));
}

TEST_F(SignalsNetcdf, OfStrangersMayHaveTheOtherSignAndNoTrack) {
  const ElementSignals own = signals(true);
  const auto file = changed([](int id) {
    nc_put_att_text(id, NC_GLOBAL, "time_factor", 15, "exp(+i omega t)");
    nc_rename_var(id, variable(id, "track_time"), "another");
    const double hop = 1;
    nc_put_att_double(id, NC_GLOBAL, "stop_and_hop", NC_DOUBLE, 1, &hop);
  });
  const ElementSignals read = read_signals(file), before = signals();
  for (std::size_t k = 0; k < read.pressure.size(); ++k)
    EXPECT_EQ(read.pressure[k], std::conj(before.pressure[k]));
  for (std::size_t ping = 0; ping < 3; ++ping)
    EXPECT_EQ(read.motion.ping_pose(ping).position_m, own.motion.ping_pose(ping).position_m);
}

TEST_F(SignalsNetcdf, AreRefusedWithTheVariableAndWhatToDo) {
  const auto without = [](const char* name) {
    return [name](int id) { nc_rename_var(id, variable(id, name), "another"); };
  };
  const auto with = [](const char* name, std::size_t at, double value) {
    return [=](int id) {
      std::size_t index[4] = {0, 0, 0, 0};
      index[0] = at;
      nc_put_var1_double(id, variable(id, name), index, &value);
    };
  };
  const auto number = [](const char* name, double value) {
    return [=](int id) { nc_put_att_double(id, NC_GLOBAL, name, NC_DOUBLE, 1, &value); };
  };
  refused(without("pressure"),
          "variable 'pressure' is missing; expected dimensions (ping, receiver, sample, complex) and unit "
          "'W^(1/2)' (see docs/output-files.md for the layout)");
  refused(without("receiver_position"), "'receiver_position' is missing");
  refused(without("sample_time"), "'sample_time' is missing");
  refused(with("pressure", 1, NAN), "holds nan at ping 1; expected finite numbers");
  refused(with("sample_time", 7, 1), "is 1 at sample 7, but 'sample_rate' implies 0.01523");
  refused(with("ping_start_time", 1, 3), "ping 1 starts at 3 s");
  refused(with("track_attitude", 1, 3), "at track 1, expected length 1");
  refused(number("sample_rate", -1), "the sampling rate is -1 Hz, but must be above 0");
  refused(number("stop_and_hop", 0.5), "attribute 'stop_and_hop' is 0.5, expected 0 or 1");
  refused(number("sound_speed_m_s", 0), "the sound speed is 0 m/s");
  refused([](int id) { nc_del_att(id, NC_GLOBAL, "baseband_frequency"); },
          "attribute 'baseband_frequency' is missing or not a number; expected Hz");
  refused([](int id) { nc_put_att_text(id, NC_GLOBAL, "time_factor", 1, "?"); },
          "attribute 'time_factor' is '?', expected 'exp(-i omega t)' or 'exp(+i omega t)'");
  EXPECT_THAT(refusal<InputError>([&] { read_signals(folder_ / "none.nc"); }),
              HasSubstr("there is no such file"));
  EXPECT_THAT(refusal<InputError>([&] { read_signals(folder_.write("text.nc", "no netCDF")); }),
              HasSubstr("cannot be read as netCDF"));
}

}  // namespace
}  // namespace tubefoot
