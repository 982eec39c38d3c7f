// SPDX-License-Identifier: GPL-3.0-or-later
// Defines the group Beam_group1 of SONAR-netCDF4 files: navigation, beam geometry, backscatter, transmission
// and the calibration of complex beams.
#include <fmt/format.h>

#include <numbers>
#include <string>

#include "sensors/formats/sonar_netcdf_builder.hpp"

namespace tubefoot {

void SonarNetcdfBuilder::beam_group(const NetcdfGroup& sonar) {
  beam_group_ = sonar.group("Beam_group1");
  const NetcdfGroup& group = beam_group_;
  group.attribute("beam_mode", "vertical");
  group.code_attribute("conversion_equation_type", conversion_,
                       header_.complex_beams ? conversion_type_1 : conversion_type_5);
  for (const char* sensor : {"MRU", "position", "gyro", "heading", "depth"})
    group.attribute(NC_GLOBAL, fmt::format("preferred_{}", sensor).c_str(), NC_INT, {0});
  const nc_type sample = group.float_list("sample_t");
  group.float_list("angle_t");
  group.float_list("pulse_t");
  ping_ = group.dimension("ping_time", NC_UNLIMITED);
  beam_ = group.dimension("beam", header_.beams);
  subbeam_ = group.dimension("subbeam", 1);
  tx_beam_ = group.dimension("tx_beam", tx_beams_.size());
  Values frequencies;
  for (const TxBeam& beam : beams_of_each_frequency()) frequencies.push_back(beam.frequency_hz);
  frequency_ = group.dimension("frequency", frequencies.size());

  std::vector<std::string> names;
  for (std::size_t k = 0; k < header_.beams; ++k) names.push_back(std::to_string(k));
  group.put_text("beam", beam_, "Beam name", names);
  group.put({"beam_type", beam_type_, {beam_}, nullptr, "Type of beam"}, Values(header_.beams, 0));
  group.put({"frequency", NC_FLOAT, {frequency_}, "Hz", "Acoustic frequency", "sound_frequency", 0.0},
            frequencies);
  group.put({"receive_transducer_index", NC_INT, {beam_}, nullptr, "Receive transducer index", nullptr, 0},
            Values(header_.beams, 0));
  time(group, "ping_time", ping_, "Time-stamp of each ping");

  backscatter(group, sample);
  navigation(group);
  beam_geometry(group);
  transmission(group);
}

void SonarNetcdfBuilder::backscatter(const NetcdfGroup& group, nc_type sample) {
  const auto lists = [&](const char* name, const char* units, const char* long_name) {
    return SonarNetcdfLayout::Place{group.id(),
                                    group.define({name, sample, {ping_, beam_, subbeam_}, units, long_name},
                                                 SonarNetcdfLayout::chunk_pings)};
  };
  if (header_.complex_beams) {
    layout_.backscatter = lists("backscatter_r", "W^(1/2)", "Backscatter per beam and sample (real part)");
    layout_.imaginary = lists("backscatter_i", "W^(1/2)", "Backscatter per beam and sample (imaginary part)");
  } else {
    layout_.backscatter = lists("backscatter_r", "dB", "Backscatter level per beam and sample");
  }
  each_beam(
      group,
      {"sample_count",
       NC_INT,
       {ping_, beam_, subbeam_},
       "1",
       "Number of samples in each beam, per ping",
       nullptr,
       0},
      [of_signals = header_.complex_beams](const Ping& p, std::size_t beam) {
        return static_cast<double>(of_signals ? p.backscatter[beam].size() : p.backscatter_db[beam].size());
      });
}

void SonarNetcdfBuilder::navigation(const NetcdfGroup& g) {
  const auto shared = [&] {
    g.attribute(last_, "coordinates", "ping_time platform_latitude platform_longitude");
  };
  for (const char* sensor : {"MRU", "position_sensor", "gyro_sensor", "heading_sensor", "depth_sensor"}) {
    const std::string name = fmt::format("active_{}", sensor);
    every_ping(
        g, {name.c_str(), NC_INT, {ping_}, nullptr, fmt::format("Active {} index", sensor), nullptr, 0}, 0);
    shared();
  }
  each_ping(
      g, {"platform_latitude", NC_DOUBLE, {ping_}, "degrees_north", "latitude", "Platform latitude", -90, 90},
      [](const Ping& p) { return p.latitude_deg; });
  shared();
  each_ping(g,
            {"platform_longitude",
             NC_DOUBLE,
             {ping_},
             "degrees_east",
             "longitude",
             "Platform longitude",
             -180,
             180},
            [](const Ping& p) { return p.longitude_deg; });
  shared();
  each_ping(g,
            {"platform_heading",
             NC_FLOAT,
             {ping_},
             "degrees_north",
             "Platform heading (true)",
             "platform_orientation",
             0,
             360},
            [](const Ping& p) { return sonar_full_circle(p.heading_deg); });
  shared();
  each_ping(g,
            {"platform_pitch",
             NC_FLOAT,
             {ping_},
             "arc_degree",
             "pitch angle, bow up positive",
             "platform_pitch_angle",
             -90,
             90},
            [](const Ping& p) { return p.pitch_deg; });
  shared();
  each_ping(g,
            {"platform_roll",
             NC_FLOAT,
             {ping_},
             "arc_degree",
             "roll angle, starboard down positive",
             "platform_roll_angle"},
            [](const Ping& p) { return p.roll_deg; });
  shared();
  each_ping(g,
            {"platform_vertical_offset",
             NC_FLOAT,
             {ping_},
             "m",
             "Distance from the platform's reference point to the water line, positive down"},
            [](const Ping& p) { return p.waterline_below_reference_m; });
  shared();
  each_ping(g,
            {"tx_transducer_depth", NC_FLOAT, {ping_}, "m", "Transmit transducer depth below the water line"},
            [](const Ping& p) { return p.transducer_depth_m; });
  shared();
  each_ping(g,
            {"waterline_to_chart_datum",
             NC_FLOAT,
             {ping_},
             "m",
             "Vertical distance from the water line to the chart datum, positive down"},
            [](const Ping& p) { return p.waterline_to_chart_datum_m; });
  g.attribute(last_, "vertical_coordinate_reference_system", "MSL depth");
  shared();
  each_ping(g,
            {"sound_speed_at_transducer",
             NC_FLOAT,
             {ping_},
             "m/s",
             "Sound speed at ping time and transducer depth",
             "speed_of_sound_in_sea_water",
             0.0},
            [](const Ping& p) {
              return p.steering_sound_speed_m_s > 0 ? p.steering_sound_speed_m_s : p.sound_speed_m_s;
            });
  shared();
}

void SonarNetcdfBuilder::beam_geometry(const NetcdfGroup& g) {
  const auto nominal = [&] { g.attribute(last_, "substitute_value_used", NC_INT, {0}); };
  // The beam's z axis is the direction of the beam, and its x axis points forward. The direction that the
  // convention calls vertical is therefore across track.
  every_beam(g,
             {"beamwidth_receive_major",
              NC_FLOAT,
              {ping_, beam_},
              "arc_degree",
              "Half power one-way receive beam width along major (horizontal) axis of beam: along track",
              nullptr,
              0,
              360},
             header_.receive_width_along_deg);
  nominal();
  every_beam(g,
             {"beamwidth_receive_minor",
              NC_FLOAT,
              {ping_, beam_},
              "arc_degree",
              "Half power one-way receive beam width along minor (vertical) axis of beam: across track",
              nullptr,
              0,
              360},
             header_.receive_width_across_deg);
  nominal();
  every_tx_beam(g,
                {"beamwidth_transmit_major",
                 NC_FLOAT,
                 {ping_, tx_beam_},
                 "arc_degree",
                 "Half power one-way transmit beam width along major (horizontal) axis of beam: along track",
                 nullptr,
                 0,
                 360},
                [](const TxBeam& tx) { return tx.width_along_deg; });
  every_tx_beam(g,
                {"beamwidth_transmit_minor",
                 NC_FLOAT,
                 {ping_, tx_beam_},
                 "arc_degree",
                 "Half power one-way transmit beam width along minor (vertical) axis of beam: across track",
                 nullptr,
                 0,
                 360},
                [](const TxBeam& tx) { return tx.width_across_deg; });
  // A right-handed rotation about the forward axis turns down towards port.
  each_beam(g,
            {"rx_beam_rotation_phi",
             NC_FLOAT,
             {ping_, beam_},
             "arc_degree",
             "receive beam angular rotation about the x axis, port positive",
             nullptr,
             -180,
             180},
            [](const Ping& p, std::size_t beam) { return -p.across_angle_deg[beam] + 0.0; });
  every_beam(g,
             {"rx_beam_rotation_theta",
              NC_FLOAT,
              {ping_, beam_},
              "arc_degree",
              "receive beam angular rotation about the y axis",
              nullptr,
              -90,
              90},
             0);
  every_beam(g,
             {"rx_beam_rotation_psi",
              NC_FLOAT,
              {ping_, beam_},
              "arc_degree",
              "receive beam angular rotation about the z axis",
              nullptr,
              -180,
              180},
             0);
  steered_tx_beam(g,
                  {"tx_beam_rotation_phi",
                   NC_FLOAT,
                   {ping_, tx_beam_},
                   "arc_degree",
                   "transmit beam angular rotation about the x axis",
                   nullptr,
                   -180,
                   180},
                  0, -1, [](const TxBeam& tx) { return tx.across_deg; });
  steered_tx_beam(g,
                  {"tx_beam_rotation_theta",
                   NC_FLOAT,
                   {ping_, tx_beam_},
                   "arc_degree",
                   "transmit beam angular rotation about the y axis",
                   nullptr,
                   -90,
                   90},
                  1, 1, [](const TxBeam& tx) { return tx.tilt_deg; });
  every_tx_beam(g,
                {"tx_beam_rotation_psi",
                 NC_FLOAT,
                 {ping_, tx_beam_},
                 "arc_degree",
                 "transmit beam angular rotation about the z axis",
                 nullptr,
                 -180,
                 180},
                [](const TxBeam&) { return 0; });
  every_ping(g,
             {"beam_stabilisation", stabilisation_, {ping_}, nullptr, "Beam stabilisation applied (or not)"},
             header_.beams_stabilised ? 1 : 0);
  every_beam(g,
             {"equivalent_beam_angle",
              NC_FLOAT,
              {ping_, beam_},
              "sr",
              "Equivalent beam angle",
              nullptr,
              0,
              4 * std::numbers::pi},
             header_.equivalent_beam_angle_sr);
  nominal();
  every_tx_beam(g,
                {"transmit_transducer_index",
                 NC_INT,
                 {ping_, tx_beam_},
                 nullptr,
                 "Transmit transducer index",
                 nullptr,
                 0},
                [](const TxBeam&) { return 0; });
  every_beam_by_tx(g,
                   {"transmit_beam_index",
                    NC_INT,
                    {ping_, beam_},
                    nullptr,
                    "Transmit beam index associated with the given beam",
                    nullptr,
                    0},
                   [](std::size_t tx) { return static_cast<double>(tx); });
  each_beam(
      g,
      {"detected_bottom_range", NC_FLOAT, {ping_, beam_}, "m", "Detected range of the bottom", nullptr, 0.0},
      [](const Ping& p, std::size_t beam) {
        const SonarDetection& d = p.detections[beam];
        return d.found ? p.sound_speed_m_s * d.two_way_travel_time_s / 2 : SonarDetection::none;
      });
}

void SonarNetcdfBuilder::transmission(const NetcdfGroup& g) {
  each_ping(
      g,
      {"sample_interval", NC_FLOAT, {ping_}, "s", "Interval between recorded raw data samples", nullptr, 0.0},
      [](const Ping& p) { return p.sample_interval_s; });
  every_tx_beam(g,
                {"sample_time_offset",
                 NC_FLOAT,
                 {ping_, tx_beam_},
                 "s",
                 "Time offset that is subtracted from the timestamp of each sample"},
                [](const TxBeam&) { return 0; });
  if (!header_.transmit_beams.empty())
    every_tx_beam(g,
                  {"transmit_delay",
                   NC_FLOAT,
                   {ping_, tx_beam_},
                   "s",
                   "Time from ping_time to the transmission of the beam; not part of the convention",
                   nullptr,
                   0.0},
                  [](const TxBeam& tx) { return tx.delay_s; });
  each_beam(g,
            {"blanking_interval",
             NC_FLOAT,
             {ping_, beam_},
             "s",
             "Amount of time during reception where samples are discarded",
             nullptr,
             0.0},
            [](const Ping& p, std::size_t) { return p.blanking_interval_s; });
  every_tx_beam(g,
                {"transmit_duration_nominal",
                 NC_FLOAT,
                 {ping_, tx_beam_},
                 "s",
                 "Nominal duration of transmitted pulse",
                 nullptr,
                 0.0},
                [](const TxBeam& tx) { return tx.pulse_length_s; });
  every_tx_beam(g,
                {"receive_duration_effective",
                 NC_FLOAT,
                 {ping_, tx_beam_},
                 "s",
                 "Effective duration of received pulse",
                 nullptr,
                 0.0},
                [](const TxBeam& tx) { return tx.pulse_length_s; });
  every_tx_beam(g,
                {"transmit_bandwidth",
                 NC_FLOAT,
                 {ping_, tx_beam_},
                 "Hz",
                 "Nominal bandwidth of transmitted pulse",
                 nullptr,
                 0.0},
                [](const TxBeam& tx) { return tx.bandwidth_hz; });
  every_tx_beam(g,
                {"transmit_frequency_start",
                 NC_FLOAT,
                 {ping_, tx_beam_},
                 "Hz",
                 "Start frequency in transmitted pulse",
                 "sound_frequency",
                 0.0},
                [this](const TxBeam& tx) {
                  return header_.chirp_start_hz > 0 ? header_.chirp_start_hz : tx.frequency_hz;
                });
  every_tx_beam(g,
                {"transmit_frequency_stop",
                 NC_FLOAT,
                 {ping_, tx_beam_},
                 "Hz",
                 "Stop frequency in transmitted pulse",
                 "sound_frequency",
                 0.0},
                [this](const TxBeam& tx) {
                  return header_.chirp_stop_hz > 0 ? header_.chirp_stop_hz : tx.frequency_hz;
                });
  constexpr double continuous_wave = 0, linear_chirp = 1;
  every_tx_beam(
      g, {"transmit_type", transmit_, {ping_, tx_beam_}, nullptr, "Type of transmitted pulse"},
      [this](const TxBeam&) { return header_.chirp_start_hz > 0 ? linear_chirp : continuous_wave; });
  if (header_.complex_beams) complex_calibration(g);
  if (header_.source_level_db)
    every_tx_beam(g,
                  {"transmit_source_level",
                   NC_FLOAT,
                   {ping_, tx_beam_},
                   "dB",
                   "Transmit source level, dB re 1 uPa at 1 m"},
                  [level_db = *header_.source_level_db](const TxBeam&) { return level_db; });
  every_ping(g,
             {"non_quantitative_processing",
              NC_SHORT,
              {ping_},
              nullptr,
              "Presence or not of non-quantitative processing applied to the backscattering data"},
             0);
  g.attribute(last_, "flag_meanings", "no_non_quantitative_processing");
  g.attribute(last_, "flag_values", NC_SHORT, {0});
}

/// Sets the parameters of equation type 1, TS = 10 log P + 40 log r + 2 alpha r - 10 log(Pt lambda^2 / 16
/// pi^2) - G. For a pulse of 1 J/sr at 1 m the last two terms are 0.
void SonarNetcdfBuilder::complex_calibration(const NetcdfGroup& g) {
  const double turns = 4 * std::numbers::pi * header_.frequency_hz / header_.sound_speed_m_s;
  every_tx_beam(g,
                {"transmit_power",
                 NC_FLOAT,
                 {ping_, tx_beam_},
                 "W",
                 "Transmit power: nominal, so that equation type 1 has no other calibration",
                 nullptr,
                 0.0},
                [turns](const TxBeam&) { return turns * turns; });
  every_beam(g, {"transducer_gain", NC_FLOAT, {ping_, beam_, frequency_}, "dB", "Gain of transducer"}, 0);
}

}  // namespace tubefoot
