// SPDX-License-Identifier: GPL-3.0-or-later
// The tables of SONAR-netCDF4 2.0 (ICES Cooperative Research Report 341 and its successors) and of the group
// Bathymetry of XSF 0.7 (Ifremer), row by row. Rows that belong to split apertures or to other conversion
// equations than type 5 (levels in dB, nothing left to convert) do not apply and are left out.
#include "sensors/sonar_netcdf_layout.hpp"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <numbers>

namespace tubefoot {
namespace {

using Ping = SonarNetcdfPing;
using Values = std::vector<double>;

constexpr double none = std::numeric_limits<double>::quiet_NaN();
constexpr const char* sensor_group = "001";  // the platform has one sensor of each kind: the simulation
constexpr signed char type_5 = 5;

/// From 0 up to 360.
double full_circle(double angle_deg) {
  const double turned = std::fmod(std::fmod(angle_deg, 360) + 360, 360);
  return turned + 0.0;
}

class Builder {
 public:
  Builder(const NetcdfStream& stream, const SonarNetcdfHeader& header)
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
  /// A row with one value a ping.
  void each_ping(const NetcdfGroup& group, const NetcdfVariable& row,
                 std::function<double(const Ping&)> value) {
    column(group, row, 1, [value](const Ping& ping, Values& values) { values.push_back(value(ping)); });
  }
  /// A row with one value a beam.
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
  void transmission(const NetcdfGroup& beams);
  void bathymetry();

  NetcdfGroup root_;
  const SonarNetcdfHeader& header_;
  SonarNetcdfLayout layout_;
  int last_ = 0;
  NetcdfGroup beam_group_ = root_;
  int ping_ = 0, beam_ = 0, tx_beam_ = 0;
  nc_type stabilisation_ = 0, conversion_ = 0, transmit_ = 0, beam_type_ = 0;
};

void Builder::root() {
  root_.attribute("Conventions", "CF-1.7, SONAR-netCDF4-2.0, ACDD-1.3");
  root_.attribute("sonar_convention_authority", "ICES");
  root_.attribute("sonar_convention_name", "SONAR-netCDF4");
  root_.attribute("sonar_convention_version", "2.0");
  root_.attribute("xsf_convention_version", "0.7");
  root_.attribute("processing_status", "{}");  // XSF: JSON of the processing done since; none
  root_.attribute("date_created", header_.date_created);
  root_.attribute("title", header_.title);
  root_.attribute("summary", header_.summary);
  root_.attribute("keywords", header_.keywords);
  if (!header_.license.empty()) root_.attribute("license", header_.license);
  if (!header_.rights.empty()) root_.attribute("rights", header_.rights);

  const NetcdfGroup annotation = root_.group("Annotation");
  const int time = annotation.dimension("time", NC_UNLIMITED);
  annotation.define_time("time", time, "Time-stamp of each annotation", 1);
  annotation.put_text("annotation_text", time, "Annotation text", {});

  const NetcdfGroup provenance = root_.group("Provenance");
  provenance.attribute("conversion_software_name", header_.software_name);
  provenance.attribute("conversion_software_version", header_.software_version);
  provenance.attribute("conversion_time", header_.date_created);
  provenance.attribute("history", header_.history);
  const int files = provenance.dimension(
      "filenames", header_.source_files.empty() ? NC_UNLIMITED : header_.source_files.size());
  provenance.put_text("source_filenames", files, "Source filenames", header_.source_files);
}

void Builder::environment() {
  const NetcdfGroup group = root_.group("Environment");
  const int frequency = group.dimension("frequency", 1);
  group.put({"frequency", NC_FLOAT, {frequency}, "Hz", "Acoustic frequency", "sound_frequency", 0.0},
            {header_.frequency_hz});
  group.put({"absorption_indicative",
             NC_FLOAT,
             {frequency},
             "dB/m",
             "Indicative acoustic absorption",
             nullptr,
             0.0},
            {header_.absorption_db_per_m});
  group.put({"sound_speed_indicative",
             NC_FLOAT,
             {},
             "m/s",
             "Indicative sound speed",
             "speed_of_sound_in_sea_water",
             0.0},
            {header_.sound_speed_m_s});
}

void Builder::platform() {
  const NetcdfGroup group = root_.group("Platform");
  group.attribute("platform_name", header_.platform_name);
  group.attribute("platform_type", header_.platform_type);
  group.attribute("platform_code_ICES", "");
  const nc_type function =
      group.enumeration("transducer_type_t", {{"receive_only", 0}, {"transmit_only", 1}, {"monostatic", 3}});
  const int transducer = group.dimension("transducer", 1);
  group.put({"transducer_function",
             function,
             {transducer},
             nullptr,
             "Transducer function (transmit_only, receive_only, monostatic)"},
            {3});

  const auto place = [&](const char* sensor, int dimension, glm::dvec3 offset, glm::dvec3 rotation,
                         bool rotates) {
    for (int axis = 0; axis < 3; ++axis) {
      const char letter = "xyz"[axis];
      const std::string offset_name = fmt::format("{}_offset_{}", sensor, letter);
      group.put(
          {offset_name.c_str(),
           NC_FLOAT,
           {dimension},
           "m",
           fmt::format("Distance along the {}-axis from the platform's origin to the {}", letter, sensor)},
          {offset[axis]});
      if (!rotates) continue;
      const std::string rotation_name = fmt::format("{}_rotation_{}", sensor, letter);
      group.put(
          {rotation_name.c_str(),
           NC_FLOAT,
           {dimension},
           "arc_degree",
           fmt::format("Extrinsic rotation about the {}-axis from the platform's axes to those of the {}",
                       letter, sensor),
           nullptr,
           -180,
           180},
          {rotation[axis]});
    }
  };
  place("transducer", transducer, header_.transducer_offset_m, header_.transducer_rotation_deg, true);
  group.put_text("transducer_ids", transducer, "Transducer name", {"transducer"});
  for (const char* sensor : {"position", "MRU", "gyro", "heading", "depth"}) {
    const int dimension = group.dimension(sensor, 1);
    const std::string name = sensor;
    group.put_text((name + "_ids").c_str(), dimension, (name + " sensor name").c_str(), {sensor_group});
    place(sensor, dimension, glm::dvec3(0), glm::dvec3(0),
          name == "MRU" || name == "gyro" || name == "heading");
  }
  group.put(
      {"water_level",
       NC_FLOAT,
       {},
       "m",
       "Distance from the platform's origin to the nominal water level along the z-axis, positive down"},
      {header_.water_level_m});

  const NetcdfGroup position = group.group("Position").group(sensor_group);
  position.attribute("description", "simulated positions of the platform's reference point at the pings");
  const int position_time = position.dimension("time", NC_UNLIMITED);
  time(position, "time", position_time, "Timestamps for position data");
  each_ping(
      position,
      {"latitude", NC_DOUBLE, {position_time}, "degrees_north", "latitude", "Platform latitude", -90, 90},
      [](const Ping& p) { return p.latitude_deg; });
  each_ping(
      position,
      {"longitude", NC_DOUBLE, {position_time}, "degrees_east", "longitude", "Platform longitude", -180, 180},
      [](const Ping& p) { return p.longitude_deg; });
  each_ping(position,
            {"heading",
             NC_FLOAT,
             {position_time},
             "degree",
             "Platform heading (true)",
             "platform_orientation",
             0,
             360},
            [](const Ping& p) { return full_circle(p.heading_deg); });
  each_ping(position,
            {"height_above_reference_ellipsoid",
             NC_FLOAT,
             {position_time},
             "m",
             "Height of the reference point above the WGS-84 ellipsoid",
             "height_above_reference_ellipsoid"},
            [](const Ping& p) { return p.height_m; });

  const NetcdfGroup attitude = group.group("Attitude").group(sensor_group);
  attitude.attribute("description", "simulated attitudes at the pings");
  const int attitude_time = attitude.dimension("time", NC_UNLIMITED);
  time(attitude, "time", attitude_time, "Timestamps for attitude data");
  each_ping(attitude,
            {"pitch",
             NC_FLOAT,
             {attitude_time},
             "arc_degree",
             "pitch angle, bow up positive",
             "platform_pitch_angle",
             -90,
             90},
            [](const Ping& p) { return p.pitch_deg; });
  each_ping(attitude,
            {"roll",
             NC_FLOAT,
             {attitude_time},
             "arc_degree",
             "roll angle, starboard down positive",
             "platform_roll_angle"},
            [](const Ping& p) { return p.roll_deg; });
  each_ping(attitude,
            {"heading",
             NC_FLOAT,
             {attitude_time},
             "degrees_north",
             "Platform heading (true)",
             "platform_orientation",
             0,
             360},
            [](const Ping& p) { return full_circle(p.heading_deg); });
  each_ping(
      attitude,
      {"vertical_offset",
       NC_FLOAT,
       {attitude_time},
       "m",
       "Platform vertical offset from nominal, positive where the water level lies below the nominal one"},
      [level = header_.water_level_m](const Ping& p) { return p.waterline_below_reference_m - level; });
}

void Builder::sonar() {
  const NetcdfGroup group = root_.group("Sonar");
  group.attribute("sonar_type", header_.sonar_type);
  group.attribute("sonar_manufacturer", header_.sonar_manufacturer);
  group.attribute("sonar_model", header_.sonar_model);
  group.attribute("sonar_serial_number", header_.sonar_serial_number);
  group.attribute("sonar_software_name", header_.software_name);
  group.attribute("sonar_software_version", header_.software_version);
  stabilisation_ = group.enumeration("beam_stabilisation_t", {{"not_stabilised", 0}, {"stabilised", 1}});
  beam_type_ = group.enumeration("beam_t", {{"single", 0},
                                            {"split_aperture_angles", 1},
                                            {"split_aperture_4_subbeams", 2},
                                            {"split_aperture_3_subbeams", 3},
                                            {"split_aperture_3_1_subbeams", 4}});
  conversion_ = group.enumeration(
      "conversion_equation_t",
      {{"type_1", 1}, {"type_2", 2}, {"type_3", 3}, {"type_4", 4}, {"type_5", 5}, {"type_6", 6}});
  transmit_ = group.enumeration("transmit_t", {{"CW", 0}, {"LFM", 1}, {"HFM", 2}});
  beam_group(group);
}

void Builder::beam_group(const NetcdfGroup& sonar) {
  beam_group_ = sonar.group("Beam_group1");
  const NetcdfGroup& group = beam_group_;
  group.attribute("beam_mode", "vertical");
  group.code_attribute("conversion_equation_type", conversion_, type_5);
  for (const char* sensor : {"MRU", "position", "gyro", "heading", "depth"})
    group.attribute(NC_GLOBAL, fmt::format("preferred_{}", sensor).c_str(), NC_INT, {0});
  const nc_type sample = group.float_list("sample_t");
  group.float_list("angle_t");
  group.float_list("pulse_t");
  ping_ = group.dimension("ping_time", NC_UNLIMITED);
  beam_ = group.dimension("beam", header_.beams);
  const int subbeam = group.dimension("subbeam", 1);
  tx_beam_ = group.dimension("tx_beam", 1);
  const int frequency = group.dimension("frequency", 1);

  std::vector<std::string> names;
  for (std::size_t k = 0; k < header_.beams; ++k) names.push_back(std::to_string(k));
  group.put_text("beam", beam_, "Beam name", names);
  group.put({"beam_type", beam_type_, {beam_}, nullptr, "Type of beam"}, Values(header_.beams, 0));
  group.put({"frequency", NC_FLOAT, {frequency}, "Hz", "Acoustic frequency", "sound_frequency", 0.0},
            {header_.frequency_hz});
  group.put({"receive_transducer_index", NC_INT, {beam_}, nullptr, "Receive transducer index", nullptr, 0},
            Values(header_.beams, 0));
  time(group, "ping_time", ping_, "Time-stamp of each ping");

  layout_.backscatter = {
      group.id(),
      group.define(
          {"backscatter_r", sample, {ping_, beam_, subbeam}, "dB", "Backscatter level per beam and sample"},
          SonarNetcdfLayout::chunk_pings)};
  each_beam(
      group,
      {"sample_count",
       NC_INT,
       {ping_, beam_, subbeam},
       "1",
       "Number of samples in each beam, per ping",
       nullptr,
       0},
      [](const Ping& p, std::size_t beam) { return static_cast<double>(p.backscatter_db[beam].size()); });
  navigation(group);
  beam_geometry(group);
  transmission(group);
}

void Builder::navigation(const NetcdfGroup& g) {
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
            [](const Ping& p) { return full_circle(p.heading_deg); });
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
            [](const Ping& p) { return p.sound_speed_m_s; });
  shared();
}

void Builder::beam_geometry(const NetcdfGroup& g) {
  const auto nominal = [&] { g.attribute(last_, "substitute_value_used", NC_INT, {0}); };
  // The beam's z axis is the beam, its x axis forward: what the convention calls its vertical is across
  // track.
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
  every_ping(g,
             {"beamwidth_transmit_major",
              NC_FLOAT,
              {ping_, tx_beam_},
              "arc_degree",
              "Half power one-way transmit beam width along major (horizontal) axis of beam: along track",
              nullptr,
              0,
              360},
             header_.transmit_width_along_deg);
  every_ping(g,
             {"beamwidth_transmit_minor",
              NC_FLOAT,
              {ping_, tx_beam_},
              "arc_degree",
              "Half power one-way transmit beam width along minor (vertical) axis of beam: across track",
              nullptr,
              0,
              360},
             header_.transmit_width_across_deg);
  // A right-handed turn about the forward axis takes down towards port.
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
  every_ping(g,
             {"tx_beam_rotation_phi",
              NC_FLOAT,
              {ping_, tx_beam_},
              "arc_degree",
              "transmit beam angular rotation about the x axis",
              nullptr,
              -180,
              180},
             0);
  every_ping(g,
             {"tx_beam_rotation_theta",
              NC_FLOAT,
              {ping_, tx_beam_},
              "arc_degree",
              "transmit beam angular rotation about the y axis",
              nullptr,
              -90,
              90},
             0);
  every_ping(g,
             {"tx_beam_rotation_psi",
              NC_FLOAT,
              {ping_, tx_beam_},
              "arc_degree",
              "transmit beam angular rotation about the z axis",
              nullptr,
              -180,
              180},
             0);
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
  every_ping(g,
             {"transmit_transducer_index",
              NC_INT,
              {ping_, tx_beam_},
              nullptr,
              "Transmit transducer index",
              nullptr,
              0},
             0);
  every_beam(g,
             {"transmit_beam_index",
              NC_INT,
              {ping_, beam_},
              nullptr,
              "Transmit beam index associated with the given beam",
              nullptr,
              0},
             0);
  each_beam(
      g,
      {"detected_bottom_range", NC_FLOAT, {ping_, beam_}, "m", "Detected range of the bottom", nullptr, 0.0},
      [](const Ping& p, std::size_t beam) {
        const SonarDetection& d = p.detections[beam];
        return d.found ? p.sound_speed_m_s * d.two_way_travel_time_s / 2 : none;
      });
}

void Builder::transmission(const NetcdfGroup& g) {
  each_ping(
      g,
      {"sample_interval", NC_FLOAT, {ping_}, "s", "Interval between recorded raw data samples", nullptr, 0.0},
      [](const Ping& p) { return p.sample_interval_s; });
  every_ping(g,
             {"sample_time_offset",
              NC_FLOAT,
              {ping_, tx_beam_},
              "s",
              "Time offset that is subtracted from the timestamp of each sample"},
             0);
  each_beam(g,
            {"blanking_interval",
             NC_FLOAT,
             {ping_, beam_},
             "s",
             "Amount of time during reception where samples are discarded",
             nullptr,
             0.0},
            [](const Ping& p, std::size_t) { return p.blanking_interval_s; });
  every_ping(g,
             {"transmit_duration_nominal",
              NC_FLOAT,
              {ping_, tx_beam_},
              "s",
              "Nominal duration of transmitted pulse",
              nullptr,
              0.0},
             header_.pulse_length_s);
  every_ping(g,
             {"receive_duration_effective",
              NC_FLOAT,
              {ping_, tx_beam_},
              "s",
              "Effective duration of received pulse",
              nullptr,
              0.0},
             header_.pulse_length_s);
  every_ping(g,
             {"transmit_bandwidth",
              NC_FLOAT,
              {ping_, tx_beam_},
              "Hz",
              "Nominal bandwidth of transmitted pulse",
              nullptr,
              0.0},
             header_.bandwidth_hz);
  every_ping(g,
             {"transmit_frequency_start",
              NC_FLOAT,
              {ping_, tx_beam_},
              "Hz",
              "Start frequency in transmitted pulse",
              "sound_frequency",
              0.0},
             header_.frequency_hz);
  every_ping(g,
             {"transmit_frequency_stop",
              NC_FLOAT,
              {ping_, tx_beam_},
              "Hz",
              "Stop frequency in transmitted pulse",
              "sound_frequency",
              0.0},
             header_.frequency_hz);
  every_ping(g, {"transmit_type", transmit_, {ping_, tx_beam_}, nullptr, "Type of transmitted pulse"}, 0);
  if (header_.source_level_db)
    every_ping(g,
               {"transmit_source_level",
                NC_FLOAT,
                {ping_, tx_beam_},
                "dB",
                "Transmit source level, dB re 1 uPa at 1 m"},
               *header_.source_level_db);
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

void Builder::bathymetry() {
  const NetcdfGroup g = beam_group_.group("Bathymetry");
  g.code_attribute("detection_conversion_equation_type", conversion_, type_5);
  const nc_type detection_type =
      g.enumeration("detection_type_t", {{"invalid", 0}, {"amplitude", 1}, {"phase", 2}, {"unknown", 127}});
  g.enumeration("seafloor_backscatter_equation_t", {{"type_1", 1}, {"type_2", 2}});
  const int detection = g.dimension("detection", header_.beams);
  g.dimension("seabed_sample", 1);  // readers expect it; the beams' time series are in backscatter_r

  const auto found = [&](const NetcdfVariable& row, double (*value)(const SonarDetection&),
                         const char* crs = nullptr) {
    each_beam(g, row, [value](const Ping& p, std::size_t k) {
      return p.detections[k].found ? value(p.detections[k]) : none;
    });
    if (crs) g.attribute(last_, "crs", crs);
  };
  using D = const SonarDetection&;
  found({"detection_latitude",
         NC_DOUBLE,
         {ping_, detection},
         "degrees_north",
         "latitude of the detection",
         "latitude",
         -90,
         90},
        [](D d) { return d.latitude_deg; });
  found({"detection_longitude",
         NC_DOUBLE,
         {ping_, detection},
         "degrees_east",
         "longitude of the detection",
         "longitude",
         -180,
         180},
        [](D d) { return d.longitude_deg; });
  found(
      {"detection_x",
       NC_FLOAT,
       {ping_, detection},
       "m",
       "along distance from the platform's reference point, forward positive"},
      [](D d) { return d.forward_starboard_down_m.x; }, "SCS");
  found(
      {"detection_y",
       NC_FLOAT,
       {ping_, detection},
       "m",
       "across distance from the platform's reference point, starboard positive"},
      [](D d) { return d.forward_starboard_down_m.y; }, "SCS");
  found(
      {"detection_z",
       NC_FLOAT,
       {ping_, detection},
       "m",
       "vertical distance from the platform's reference point, down positive"},
      [](D d) { return d.forward_starboard_down_m.z; }, "SCS");
  constexpr int valid = 0, invalid_acquisition = 2;
  each_beam(g,
            {"status",
             NC_BYTE,
             {ping_, detection},
             nullptr,
             "validity: 0 valid; bits 1 rejected, 2 invalid acquisition, 4 invalid conversion, 8 invalid "
             "swath, 16 invalid sounding row"},
            [](const Ping& p, std::size_t k) { return p.detections[k].found ? valid : invalid_acquisition; });
  constexpr int automatic = 1;
  every_beam(
      g,
      {"status_detail", NC_BYTE, {ping_, detection}, nullptr, "0 unknown, 1 automatic, 2 doubtful, 3 manual"},
      automatic);
  every_ping(
      g, {"multiping_sequence", NC_UBYTE, {ping_}, nullptr, "sequence number among the swaths of a ping"}, 0);
  each_beam(g, {"detection_type", detection_type, {ping_, detection}, nullptr, "type of detection"},
            [](const Ping& p, std::size_t k) { return p.detections[k].found ? 1 : 0; });
  every_ping(g,
             {"detection_beam_stabilisation",
              stabilisation_,
              {ping_},
              nullptr,
              "beam stabilisation applied (or not)"},
             header_.beams_stabilised ? 1 : 0);
  each_beam(g,
            {"detection_beam_pointing_angle",
             NC_FLOAT,
             {ping_, detection},
             "arc_degree",
             "beam pointing angle from the platform's down axis, port positive"},
            [](const Ping& p, std::size_t k) { return -p.detections[k].beam_angle_deg + 0.0; });
  found({"detection_two_way_travel_time", NC_FLOAT, {ping_, detection}, "s", "two-way travel time"},
        [](D d) { return d.two_way_travel_time_s; });
  found({"detection_quality_factor",
         NC_FLOAT,
         {ping_, detection},
         "percent",
         "standard deviation in per cent of the detected depth"},
        [](D d) { return d.quality; });
  every_beam(
      g, {"detection_rx_transducer_index", NC_SHORT, {ping_, detection}, nullptr, "receive transducer index"},
      0);
  each_beam(g, {"detection_rx_beam", NC_SHORT, {ping_, detection}, nullptr, "receive beam index"},
            [](const Ping&, std::size_t k) { return static_cast<double>(k); });
  every_beam(g, {"detection_tx_beam", NC_SHORT, {ping_, detection}, nullptr, "transmit beam index"}, 0);
  every_beam(
      g,
      {"detection_tx_transducer_index", NC_SHORT, {ping_, detection}, nullptr, "transmit transducer index"},
      0);
  found({"detection_backscatter_r", NC_FLOAT, {ping_, detection}, "dB", "backscatter of the detection"},
        [](D d) { return d.backscatter_db; });
  every_beam(g,
             {"detection_backscatter_i",
              NC_FLOAT,
              {ping_, detection},
              "dB",
              "imaginary part of the backscatter: none, levels are in dB"},
             none);
  every_beam(g,
             {"detection_mean_absorption_coefficient",
              NC_FLOAT,
              {ping_, detection},
              "dB/km",
              "mean absorption coefficient, one way"},
             1000 * header_.absorption_db_per_m);
  if (header_.source_level_db)
    every_beam(g,
               {"detection_source_level_applied",
                NC_FLOAT,
                {ping_, detection},
                "dB",
                "source level, dB re 1 uPa at 1 m"},
               *header_.source_level_db);
}

}  // namespace

SonarNetcdfLayout define_sonar_netcdf(const NetcdfStream& stream, const SonarNetcdfHeader& header) {
  return Builder(stream, header).build();
}

}  // namespace tubefoot
