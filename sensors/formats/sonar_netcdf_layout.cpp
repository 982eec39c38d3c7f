// SPDX-License-Identifier: GPL-3.0-or-later
// The tables of SONAR-netCDF4 2.0 (ICES Cooperative Research Report 341 and its successors) and of the group
// Bathymetry of XSF 0.7 (Ifremer), row by row. Rows for split apertures do not apply and are omitted. The
// same holds for rows of conversion equations other than type 5 (levels in dB that need no conversion).
#include <fmt/format.h>

#include <string>

#include "sensors/formats/sonar_netcdf_builder.hpp"

namespace tubefoot {
namespace {

constexpr const char* sensor_group = "001";  // the platform has one sensor of each kind: the simulation

}  // namespace

void SonarNetcdfBuilder::root() {
  // SONAR-netCDF4 prescribes "CF-1.7" here, but requires features that CF does not have: groups, lists of
  // lists, levels in "dB".
  root_.attribute("Conventions", "SONAR-netCDF4-2.0, ACDD-1.3");
  root_.attribute("sonar_convention_authority", "ICES");
  root_.attribute("sonar_convention_name", "SONAR-netCDF4");
  root_.attribute("sonar_convention_version", "2.0");
  root_.attribute("xsf_convention_version", "0.7");
  root_.attribute("processing_status", "{}");  // XSF: JSON of later processing; none
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

void SonarNetcdfBuilder::environment() {
  const NetcdfGroup group = root_.group("Environment");
  Values frequencies, absorptions;
  for (const TxBeam& beam : beams_of_each_frequency()) {
    frequencies.push_back(beam.frequency_hz);
    absorptions.push_back(beam.absorption_db_per_m);
  }
  const int frequency = group.dimension("frequency", frequencies.size());
  group.put({"frequency", NC_FLOAT, {frequency}, "Hz", "Acoustic frequency", "sound_frequency", 0.0},
            frequencies);
  group.put({"absorption_indicative",
             NC_FLOAT,
             {frequency},
             "dB/m",
             "Indicative acoustic absorption",
             nullptr,
             0.0},
            absorptions);
  group.put({"sound_speed_indicative",
             NC_FLOAT,
             {},
             "m/s",
             "Indicative sound speed",
             "speed_of_sound_in_sea_water",
             0.0},
            {header_.sound_speed_m_s});
}

void SonarNetcdfBuilder::platform() {
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
            [](const Ping& p) { return sonar_full_circle(p.heading_deg); });
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
            [](const Ping& p) { return sonar_full_circle(p.heading_deg); });
  each_ping(
      attitude,
      {"vertical_offset",
       NC_FLOAT,
       {attitude_time},
       "m",
       "Platform vertical offset from nominal, positive where the water level lies below the nominal one"},
      [level = header_.water_level_m](const Ping& p) { return p.waterline_below_reference_m - level; });
}

void SonarNetcdfBuilder::sonar() {
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

void SonarNetcdfLayout::find_groups(const NetcdfStream& stream) {
  std::map<int, int> now;
  for (auto& [path, id] : groups) {
    const int found = stream.group(path);
    now[id] = found;
    id = found;
  }
  for (SonarNetcdfColumn& column : columns) column.group = now.at(column.group);
  for (Place& place : times) place.group = now.at(place.group);
  backscatter.group = now.at(backscatter.group);
  if (imaginary) imaginary->group = now.at(imaginary->group);
}

SonarNetcdfLayout define_sonar_netcdf(const NetcdfStream& stream, const SonarNetcdfHeader& header) {
  SonarNetcdfLayout layout = SonarNetcdfBuilder(stream, header).build();
  for (const char* path : {"/Platform/Position/001", "/Platform/Attitude/001", "/Sonar/Beam_group1",
                           "/Sonar/Beam_group1/Bathymetry"})
    layout.groups[path] = stream.group(path);
  return layout;
}

}  // namespace tubefoot
