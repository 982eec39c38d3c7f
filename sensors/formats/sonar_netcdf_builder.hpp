// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <functional>
#include <limits>
#include <utility>
#include <vector>

#include "sensors/formats/sonar_netcdf_layout.hpp"

namespace tubefoot {

/// Conversion equation of levels in dB that need no conversion.
inline constexpr signed char conversion_type_5 = 5;
/// Conversion equation of complex signals whose squared modulus is proportional to the received power.
inline constexpr signed char conversion_type_1 = 1;

/// The angle modulo 360, from 0 up to 360.
inline double sonar_full_circle(double angle_deg) {
  return std::fmod(std::fmod(angle_deg, 360) + 360, 360) + 0.0;
}

/// Defines the groups one after another. The tables of a few groups are in one source file each.
class SonarNetcdfBuilder {
  using Ping = SonarNetcdfPing;
  using Values = std::vector<double>;

 public:
  SonarNetcdfBuilder(const NetcdfStream& stream, const SonarNetcdfHeader& header)
      : root_(stream, stream.id()), header_(header) {}

  SonarNetcdfLayout build() {
    root();
    environment();
    platform();
    sonar();
    bathymetry();
    return std::move(layout_);
  }

 private:
  /// A row with one value per ping.
  void each_ping(const NetcdfGroup& group, const NetcdfVariable& row,
                 std::function<double(const Ping&)> value) {
    column(group, row, 1, [value](const Ping& ping, Values& values) { values.push_back(value(ping)); });
  }
  /// A row with one value per beam.
  void each_beam(const NetcdfGroup& group, const NetcdfVariable& row,
                 std::function<double(const Ping&, std::size_t)> value) {
    column(group, row, header_.beams, [value, beams = header_.beams](const Ping& ping, Values& values) {
      for (std::size_t beam = 0; beam < beams; ++beam) values.push_back(value(ping, beam));
    });
  }
  void every_ping(const NetcdfGroup& group, const NetcdfVariable& row, double value) {
    each_ping(group, row, [value](const Ping&) { return value; });
  }
  void every_beam(const NetcdfGroup& group, const NetcdfVariable& row, double value) {
    each_beam(group, row, [value](const Ping&, std::size_t) { return value; });
  }
  int column(const NetcdfGroup& group, const NetcdfVariable& row, std::size_t per_ping,
             std::function<void(const Ping&, Values&)> append) {
    last_ = group.define(row, SonarNetcdfLayout::chunk_pings);
    layout_.columns.push_back({row.name, group.id(), last_, row.type, per_ping, std::move(append)});
    return last_;
  }
  void time(const NetcdfGroup& group, const char* name, int dimension, const char* long_name) {
    const int variable = group.define_time(name, dimension, long_name, SonarNetcdfLayout::chunk_pings);
    layout_.times.push_back({group.id(), variable});
  }

  void root();
  void environment();
  void platform();
  void sonar();
  void beam_group(const NetcdfGroup& sonar);
  void navigation(const NetcdfGroup& beams);
  void beam_geometry(const NetcdfGroup& beams);
  void backscatter(const NetcdfGroup& beams, nc_type sample);
  void transmission(const NetcdfGroup& beams);
  void complex_calibration(const NetcdfGroup& beams);
  void bathymetry();

  NetcdfGroup root_;
  const SonarNetcdfHeader& header_;
  SonarNetcdfLayout layout_;
  int last_ = 0;
  NetcdfGroup beam_group_ = root_;
  int ping_ = 0, beam_ = 0, tx_beam_ = 0, frequency_ = 0, subbeam_ = 0;
  nc_type stabilisation_ = 0, conversion_ = 0, transmit_ = 0, beam_type_ = 0;
};

}  // namespace tubefoot
