// SPDX-License-Identifier: GPL-3.0-or-later
// Writes echo files (echoes.nc), in the layout of docs/output-files.md: dimensions, coordinates, attributes
// and the chunks of each ping.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "engine/scattering/knife_edge.hpp"
#include "geometry/steps/steps.hpp"
#include "sensors/formats/echo_netcdf.hpp"
#include "sensors/model/angles.hpp"
#include "sensors/recordings/pose_angles.hpp"
#include "sensors/recordings/receiver_output.hpp"
#include "sensors/recordings/recording.hpp"
#include "sensors/recordings/run_context.hpp"
#include "sensors/recordings/sensor_kind.hpp"

namespace tubefoot {
namespace {

namespace fs = std::filesystem;

template <typename Item, typename Value>
std::vector<double> column(const std::vector<Item>& items, Value value) {
  std::vector<double> values;
  values.reserve(items.size());
  for (const Item& item : items) values.push_back(value(item));
  return values;
}

/// Poses as the variables of a file: [ping][xyz], [ping][wxyz] and the angles of each.
struct PoseColumns {
  std::vector<double> positions, attitudes;
  std::vector<PoseAngles> angles;
};

template <typename PoseOf>
PoseColumns pose_columns(std::size_t pings, PoseOf pose_of) {
  PoseColumns columns;
  for (std::size_t ping = 0; ping < pings; ++ping) {
    const Pose pose = pose_of(ping);
    const auto& p = pose.position_m;
    const glm::dquat q = glm::normalize(pose.attitude);
    columns.positions.insert(columns.positions.end(), {p.x, p.y, p.z});
    columns.attitudes.insert(columns.attitudes.end(), {q.w, q.x, q.y, q.z});
    columns.angles.push_back(angles_of(q));
  }
  return columns;
}

/// A variable of the file over ping, beam and range bin, and the packed values of its pings.
struct FileVariable {
  ChannelVariable meaning;
  PingVariable values;
};

/// The variables of a recording. Chunks that are already packed go into the file unchanged.
std::vector<FileVariable> ping_variables(const Recording& recording,
                                         const std::optional<ReceiverOutput>& received) {
  std::vector<FileVariable> variables;
  for (const RecordedVariable& of : recording.variables())
    variables.push_back({of.meaning, {of.meaning.name, [of](std::size_t ping) {
                                        if (of.channel.packed) return of.channel.packed->chunk(ping, of.part);
                                        stop_if_wanted();
                                        const PingEnergies values = of.of(ping);
                                        return packed_chunk(values);
                                      }}});
  const auto add_received = [&](const char* name, const char* long_name, bool lower) {
    variables.push_back({{name, "J m-2", long_name, true}, {name, [&received, lower](std::size_t ping) {
                                                              return packed_chunk(
                                                                  received->recorded_energy_of(ping, lower));
                                                            }}});
  };
  if (received)
    add_received(
        "received",
        "energy density per beam and range bin as the receiver records it, for a source of 1 J/sr at 1 m",
        false);
  if (received && received->lower_energy_of)
    add_received(
        "received_lower",
        "energy density per beam and range bin as the lower receiver records it; received is that of the "
        "upper receiver",
        true);
  return variables;
}

void describe_received(EchoGroup& group, int variable, const ReceiverOutput& received) {
  group.attribute(variable, "receiver", received.said);
  group.attribute(variable, "unit_level_db", received.unit_level_db);
  group.attribute(variable, "random_seed", fmt::format("{}", received.seed));
  std::string comment =
      "Level [dB re 1 uPa] = unit_level_db + 10 log10(received). Random numbers are Philox4x32-10 of seed, "
      "ping, beam and range bin. Values are rounded to 24 significant bits.";
  if (received.codes) {
    group.attribute(variable, "quantisation_bits", received.codes->bits);
    group.attribute(variable, "quantisation_bottom_db", received.codes->bottom_db);
    group.attribute(variable, "quantisation_step_db", received.codes->step_db);
    comment +=
        " Code = (level - quantisation_bottom_db) / quantisation_step_db. Code 0 (no echo, or a level "
        "up to quantisation_bottom_db) is the value 0.";
  }
  group.attribute(variable, "comment", comment);
}

/// Variables of the transmit sectors, for a sensor that has them.
void define_sectors(EchoGroup& group, const Recording& recording, int beam,
                    const std::optional<ReceiverOutput>& received) {
  const std::vector<SectorColumn> columns = sector_columns(recording);
  if (columns.empty()) return;
  const int sector = group.dimension("sector", recording.sectors());
  for (const SectorColumn& column : columns)
    group.variable(column.name, {column.is_by_beam ? beam : sector}, column.units, column.long_name,
                   column.values);
  if (received)
    group.variable("sector_unit_level_db", {sector}, "dB",
                   "level of an energy density of 1 J/m2 in received, dB re 1 uPa",
                   received->sector_unit_level_db);
}

void define_recording(EchoGroup& group, const Recording& recording, const Provenance& provenance,
                      const std::optional<ReceiverOutput>& received) {
  const Sensor& sensor = *recording.sensor;
  const std::vector<BeamAxis>& beams = sensor.beams();
  const RangeSamples& samples = sensor.samples();

  group.attribute("sensor_name", sensor.description().name);
  group.attribute("sensor_kind", kind_of(sensor.description()).name());
  group.attribute("frequency_khz", sensor.frequency_khz());
  group.attribute("source_energy", "1 J/sr at 1 m");
  if (sensor.description().shadow == "fresnel")
    group.attribute("shadow_borders", std::string(fresnel_statement));
  group.attribute("sound_speed_m_s", recording.sound_speed_m_s);
  group.attribute("absorption_db_per_km", recording.absorption_db_per_km);

  const int ping = group.dimension("ping", recording.ping_time_s.size());
  const int beam = group.dimension("beam", beams.size());
  const int sample = group.dimension("sample", static_cast<std::size_t>(samples.count));
  const int bound = group.dimension("bound", 2);
  const int xyz = group.dimension("xyz", 3);
  const int wxyz = group.dimension("wxyz", 4);

  for (const FileVariable& of_pings : ping_variables(recording, received)) {
    const auto& [name, units, long_name, has_coordinates, is_by_beam] = of_pings.meaning;
    std::vector<int> dimensions{ping, beam};
    std::vector<std::size_t> chunk{1, beams.size()};
    if (!is_by_beam) {
      dimensions.push_back(sample);
      chunk.push_back(static_cast<std::size_t>(samples.count));
    }
    const int variable = group.define(name, dimensions, units, long_name);
    if (has_coordinates)
      group.attribute(variable, "coordinates",
                      is_by_beam ? "ping_time beam_azimuth beam_elevation"
                                 : "ping_time beam_azimuth beam_elevation slant_range");
    if (name.starts_with("received")) describe_received(group, variable, *received);
    group.chunk(variable, name, chunk);
  }

  group.variable("ping_time", {ping}, "s", "time of the transmission on the clock of the scene",
                 recording.ping_time_s);
  if (!provenance.start_utc.empty()) {
    const int time = group.variable("ping_utc", {ping}, "seconds since " + provenance.start_utc,
                                    "date and time of the transmission", recording.ping_time_s);
    group.attribute(time, "standard_name", "time");
    group.attribute(time, "calendar", "standard");
  }

  std::vector<double> centres, bounds, travel_times;
  for (int k = 0; k < samples.count; ++k) {
    const double centre = samples.first_m + (k + 0.5) * samples.step_m;
    centres.push_back(centre);
    bounds.push_back(samples.first_m + k * samples.step_m);
    bounds.push_back(samples.first_m + (k + 1) * samples.step_m);
    travel_times.push_back(2 * centre / recording.sound_speed_m_s);
  }
  const int range =
      group.variable("slant_range", {sample}, "m", "slant range of the centre of the range bin", centres);
  group.attribute(range, "bounds", "slant_range_bounds");
  group.variable("slant_range_bounds", {sample, bound}, "m",
                 "slant ranges at both ends of the range bin, which contains the nearer end", bounds);
  group.variable("two_way_travel_time", {sample}, "s", "two-way travel time of the centre of the range bin",
                 travel_times);

  group.variable("beam_azimuth", {beam}, "degree",
                 "azimuth of the beam axis in the sensor frame, clockwise from forward, starboard positive",
                 column(beams, [](const BeamAxis& axis) { return degrees(axis.azimuth_rad); }));
  group.variable("beam_elevation", {beam}, "degree",
                 "elevation of the beam axis above the horizontal plane of the sensor",
                 column(beams, [](const BeamAxis& axis) { return degrees(axis.elevation_rad); }));
  group.variable("beam_azimuth_width", {beam}, "degree",
                 "full one-way width of the ideal rectangular beam in azimuth",
                 column(beams, [](const BeamAxis& axis) { return degrees(axis.azimuth_width_rad); }));
  group.variable("beam_elevation_width", {beam}, "degree",
                 "full one-way width of the ideal rectangular beam in elevation",
                 column(beams, [](const BeamAxis& axis) { return degrees(axis.elevation_width_rad); }));
  if (!recording.beam_numbers.empty())
    group.variable("beam_number", {beam}, "1", "beam of the sonar, counted from 0",
                   {recording.beam_numbers.begin(), recording.beam_numbers.end()});

  define_sectors(group, recording, beam, received);

  const auto [positions, attitudes, angles] =
      pose_columns(recording.pings(), [&](std::size_t k) { return recording.ping_pose[k]; });
  group.variable("sensor_position", {ping, xyz}, "m",
                 "position of the sensor in the local frame: east, north, up", positions);
  group.variable("sensor_attitude", {ping, wxyz}, "1",
                 "quaternion w, x, y, z that rotates the sensor axes (x starboard, y forward, z up) into the "
                 "local frame",
                 attitudes);
  group.variable("sensor_heading", {ping}, "degree",
                 "heading of the forward axis of the sensor, clockwise from north in the local frame",
                 column(angles, [](const PoseAngles& a) { return a.heading_deg; }));
  group.variable("sensor_pitch", {ping}, "degree", "pitch of the sensor, forward axis up positive",
                 column(angles, [](const PoseAngles& a) { return a.pitch_deg; }));
  group.variable("sensor_roll", {ping}, "degree", "roll of the sensor, starboard down positive",
                 column(angles, [](const PoseAngles& a) { return a.roll_deg; }));

  if (!recording.recorded_poses.empty()) {
    const auto recorded =
        pose_columns(recording.pings(), [&](std::size_t k) { return recording.recorded_pose(k); });
    group.variable("recorded_sensor_position", {ping, xyz}, "m",
                   "position of the sensor that its software assumes, in the local frame: east, north, up",
                   recorded.positions);
    group.variable("recorded_sensor_attitude", {ping, wxyz}, "1",
                   "quaternion w, x, y, z of the attitude that the software of the sensor assumes, as in "
                   "sensor_attitude",
                   recorded.attitudes);
    group.variable("recorded_sensor_heading", {ping}, "degree",
                   "heading of the sensor that its software assumes, clockwise from north in the local frame",
                   column(recorded.angles, [](const PoseAngles& a) { return a.heading_deg; }));
    group.variable("recorded_sensor_pitch", {ping}, "degree",
                   "pitch of the sensor that its software assumes, forward axis up positive",
                   column(recorded.angles, [](const PoseAngles& a) { return a.pitch_deg; }));
    group.variable("recorded_sensor_roll", {ping}, "degree",
                   "roll of the sensor that its software assumes, starboard down positive",
                   column(recorded.angles, [](const PoseAngles& a) { return a.roll_deg; }));
  }

  for (const PingColumn& column : ping_columns(recording, provenance))
    group.variable(column.name, {ping}, column.units, column.long_name, column.values);

  group.write();
}

/// `received`: by recording.
void write_file_of(const fs::path& path, const std::vector<Recording>& recordings,
                   const Provenance& provenance, const std::vector<std::optional<ReceiverOutput>>& received) {
  if (recordings.empty()) throw std::invalid_argument("no recording to write into " + path.string());
  for (const Recording& recording : recordings) check(recording);

  std::size_t bytes = 0;
  for (std::size_t k = 0; k < recordings.size(); ++k) {
    const Recording& r = recordings[k];
    bytes += ping_variables(r, received[k]).size() * r.pings() * r.cells() * sizeof(double);
  }
  EchoNetcdf file(path);
  EchoGroup root = file.root();
  for (const auto& [name, value] : attributes_of(provenance))
    std::visit([&, name = name](const auto& v) { root.attribute(name, v); }, value);
  const bool grouped = recordings.size() > 1;
  for (std::size_t k = 0; k < recordings.size(); ++k) {
    EchoGroup group = grouped ? root.group(recordings[k].sensor->description().name) : root;
    define_recording(group, recordings[k], provenance, received[k]);
  }
  Hdf5Chunks& chunks = file.chunks(bytes);
  for (std::size_t k = 0; k < recordings.size(); ++k) {
    const Recording& recording = recordings[k];
    Steps steps("pings of echoes.nc", recording.pings());
    std::vector<PingVariable> variables;
    for (FileVariable& of_pings : ping_variables(recording, received[k]))
      variables.push_back(std::move(of_pings.values));
    write_pings(chunks, grouped ? "/" + recording.sensor->description().name + "/" : "/", variables,
                recording.pings(), recording.cells(), [&](std::size_t) { steps.done(); });
  }
  file.close();
}

}  // namespace

void write_echoes(const fs::path& path, const std::vector<Recording>& recordings,
                  const Provenance& provenance) {
  write_file_of(path, recordings, provenance, std::vector<std::optional<ReceiverOutput>>(recordings.size()));
}

void write_echoes(const fs::path& path, const std::vector<Recording>& recordings,
                  const Provenance& provenance, const RunContext& run) {
  std::vector<std::optional<ReceiverOutput>> received;
  for (const Recording& recording : recordings) received.push_back(receiver_output_of(recording, run));
  write_file_of(path, recordings, provenance, received);
}

}  // namespace tubefoot
