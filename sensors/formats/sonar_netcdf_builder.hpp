// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
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
  using TxBeam = SonarTransmitBeam;
  using Values = std::vector<double>;

 public:
  SonarNetcdfBuilder(const NetcdfStream& stream, const SonarNetcdfHeader& header)
      : root_(stream, stream.id()), header_(header), tx_beams_(header.transmit_beams) {
    if (tx_beams_.empty())
      tx_beams_.push_back({header.frequency_hz, header.bandwidth_hz, header.pulse_length_s,
                           header.absorption_db_per_m, header.transmit_width_across_deg,
                           header.transmit_width_along_deg});
  }

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
  /// A row with one value per transmit beam, the same at each ping.
  void every_tx_beam(const NetcdfGroup& group, const NetcdfVariable& row,
                     const std::function<double(const TxBeam&)>& value) {
    Values values;
    for (const TxBeam& tx : tx_beams_) values.push_back(value(tx));
    column(group, row, values.size(),
           [values](const Ping&, Values& all) { all.insert(all.end(), values.begin(), values.end()); });
  }
  /// The same for an angle that the stabilisation changes by SonarNetcdfPing::transmit_steering_deg[][which].
  void steered_tx_beam(const NetcdfGroup& group, const NetcdfVariable& row, std::size_t which, double sign,
                       const std::function<double(const TxBeam&)>& angle_deg) {
    Values nominal;
    for (const TxBeam& tx : tx_beams_) nominal.push_back(angle_deg(tx));
    column(group, row, nominal.size(), [nominal, which, sign](const Ping& ping, Values& all) {
      for (std::size_t k = 0; k < nominal.size(); ++k) {
        const double turn = ping.transmit_steering_deg.empty() ? 0 : ping.transmit_steering_deg[k][which];
        all.push_back(sign * (nominal[k] + turn) + 0.0);
      }
    });
  }
  /// The first transmit beam of each frequency.
  std::vector<TxBeam> beams_of_each_frequency() const {
    std::vector<TxBeam> found;
    for (const TxBeam& beam : tx_beams_)
      if (std::ranges::find(found, beam.frequency_hz, &TxBeam::frequency_hz) == found.end())
        found.push_back(beam);
    return found;
  }
  /// A row with one value per beam that depends on the number of its transmit beam, the same at each ping.
  void every_beam_by_tx(const NetcdfGroup& group, const NetcdfVariable& row,
                        const std::function<double(std::size_t)>& value) {
    Values values;
    for (std::size_t beam = 0; beam < header_.beams; ++beam)
      values.push_back(value(header_.transmit_beam_of.empty() ? 0 : header_.transmit_beam_of[beam]));
    column(group, row, values.size(),
           [values](const Ping&, Values& all) { all.insert(all.end(), values.begin(), values.end()); });
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
  std::vector<TxBeam> tx_beams_;
  SonarNetcdfLayout layout_;
  int last_ = 0;
  NetcdfGroup beam_group_ = root_;
  int ping_ = 0, beam_ = 0, tx_beam_ = 0, frequency_ = 0, subbeam_ = 0;
  nc_type stabilisation_ = 0, conversion_ = 0, transmit_ = 0, beam_type_ = 0;
};

}  // namespace tubefoot
