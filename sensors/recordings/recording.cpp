// SPDX-License-Identifier: GPL-3.0-or-later
// Queries of a recording: lines of a survey, track length, ping spacing, consistency check, and the
// attributes and columns of its echo file.

#include "sensors/recordings/recording.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <glm/geometric.hpp>
#include <iterator>
#include <stdexcept>

#include "sensors/model/angles.hpp"
#include "sensors/recordings/navigation.hpp"

namespace tubefoot {

std::size_t Recording::cells() const {
  return sensor->beams().size() * static_cast<std::size_t>(sensor->samples().count);
}

std::size_t Recording::channels() const { return static_cast<std::size_t>(sensor->channels()); }

std::vector<ChannelVariable> energy_variables(std::size_t channels, bool bounds) {
  const std::vector<ChannelVariable> all{
      {"energy", "J m-2", "received energy density per beam and range bin, for a source of 1 J/sr at 1 m",
       true},
      {"energy_lower", "J m-2",
       "received energy density per beam and range bin at the lower receiver; energy is that of the upper "
       "receiver"},
      {"cross_real", "J m-2",
       "real part of the mean product of the signal of the upper receiver and the conjugate signal of the "
       "lower receiver"},
      {"cross_imag", "J m-2",
       "imaginary part of the mean product of the signal of the upper receiver and the conjugate signal of "
       "the lower receiver"}};
  std::vector<ChannelVariable> variables(all.begin(), all.begin() + std::ptrdiff_t(channels));
  if (!bounds) return variables;
  for (ChannelVariable& of : variables) {
    const std::string subject = of.name == "energy" ? "energy" : "value of " + of.name;
    of = {of.name + "_bound", of.units,
          fmt::format("certified bound: the true {} lies within {} +- {}_bound", subject, of.name, of.name)};
  }
  return variables;
}

std::vector<RecordedVariable> Recording::variables() const {
  std::vector<RecordedVariable> all;
  const auto add = [&](const RecordedChannel& channel, bool bounds) {
    for (const ChannelVariable& variable : energy_variables(channels(), bounds))
      all.push_back({variable, channel, all.size() % channels(), channels(), cells()});
  };
  add({energy, packed_energy}, false);
  if (has_bounds()) add({energy_bound, packed_bound}, true);
  all.insert(all.end(), further.begin(), further.end());
  return all;
}

std::size_t Recording::sectors() const { return std::max<std::size_t>(sensor->transmit_sectors().size(), 1); }

std::size_t Recording::sector_of(std::size_t beam) const {
  return sensor->transmit_sectors().empty() ? 0 : sensor->beams().at(beam).sector;
}

SteeredPose Recording::beam_pose(std::size_t ping, std::size_t beam) const {
  if (transmission_pose.empty()) return ping_pose.at(ping);
  return transmission_pose.at(ping * sensor->transmissions() +
                              sensor->first_transmission(sensor->beams().at(beam).sector));
}

SteeredPose Recording::receive_pose(std::size_t ping, std::size_t beam, std::size_t sample) const {
  if (receiver_pose.empty()) return beam_pose(ping, beam);
  return receiver_pose.at(ping * sensor->transmissions() +
                          sensor->transmission_receiving(sensor->beams().at(beam).sector, sample));
}

Recording Recording::as_recorded() const {
  Recording recorded = *this;
  for (std::size_t ping = 0; ping < ping_pose.size(); ++ping) recorded.ping_pose[ping] = recorded_pose(ping);
  // The sonar knows the steering of its beams.
  const auto replace = [](std::vector<SteeredPose>& poses, const std::vector<Pose>& by) {
    for (std::size_t k = 0; k < by.size() && k < poses.size(); ++k) static_cast<Pose&>(poses[k]) = by[k];
  };
  replace(recorded.transmission_pose, recorded_poses);
  replace(recorded.receiver_pose, recorded_receiver_poses);
  if (steering_sound_speed_m_s > 0) recorded.steering_ratio = steering_sound_speed_m_s / sound_speed_m_s;
  if (assumed_sensor) recorded.sensor = assumed_sensor.get();
  if (assumed_sound_speed_m_s > 0) {
    recorded.sound_speed_m_s = assumed_sound_speed_m_s;
    recorded.range_ratio = assumed_sound_speed_m_s / sound_speed_m_s;
  }
  return recorded;
}

std::vector<PingSpan> Recording::lines() const {
  std::vector<PingSpan> lines;
  for (const std::size_t start : line_starts) {
    if (!lines.empty()) lines.back().end = start;
    lines.push_back({start, pings()});
  }
  if (lines.empty()) lines.push_back({0, pings()});
  return lines;
}

PingSpan Recording::line_of(std::size_t ping) const {
  const auto after = std::ranges::upper_bound(line_starts, ping);
  return {after == line_starts.begin() ? 0 : *(after - 1), after == line_starts.end() ? pings() : *after};
}

double Recording::track_length_m() const {
  double length = 0;
  for (const PingSpan& line : lines())
    for (std::size_t k = line.first + 1; k < line.end; ++k)
      length += glm::distance(ping_pose[k - 1].position_m, ping_pose[k].position_m);
  return length;
}

double Recording::ping_spacing_m() const {
  const std::size_t ways = pings() - lines().size();
  return ways == 0 ? 0 : track_length_m() / static_cast<double>(ways);
}

void check(const Recording& recording) {
  if (!recording.sensor) throw std::invalid_argument("a recording without a sensor cannot be written");
  const Sensor& sensor = *recording.sensor;
  const std::size_t pings = recording.ping_time_s.size();
  const std::size_t cells = recording.packed_energy ? 0 : pings * recording.channels() * recording.cells();
  if (pings == 0 || recording.ping_pose.size() != pings || recording.energy.size() != cells ||
      (!recording.energy_bound.empty() && recording.energy_bound.size() != cells))
    throw std::invalid_argument(fmt::format(
        "inconsistent recording of '{}': {} ping times, {} poses, {} energies for {} beams of {} samples",
        sensor.description().name, pings, recording.ping_pose.size(), recording.energy.size(),
        sensor.beams().size(), sensor.samples().count));
}

std::vector<NamedAttribute> attributes_of(const Provenance& provenance) {
  std::vector<NamedAttribute> attributes{
      {"title", provenance.title},           {"Conventions", "tubefoot-echoes-1.0"},
      {"scene_hash", provenance.scene_hash}, {"engine", provenance.engine},
      {"arithmetic", provenance.arithmetic}, {"version", provenance.version}};
  if (provenance.reference_tolerance)
    attributes.push_back({"reference_tolerance", *provenance.reference_tolerance});
  if (provenance.coarseness > 0) attributes.push_back({"coarsened", provenance.coarseness});
  if (!provenance.start_utc.empty()) attributes.push_back({"start_utc", provenance.start_utc});
  if (!provenance.frame.is_georeferenced()) return attributes;
  const LocalFrame::Map map = provenance.frame.map();
  attributes.insert(attributes.end(), {{"map_crs_wkt", map.crs_wkt},
                                       {"map_easting_of_origin", map.easting},
                                       {"map_northing_of_origin", map.northing},
                                       {"map_metres_per_unit", map.metres_per_unit},
                                       {"height_of_origin_m", provenance.frame.origin_height_m()}});
  return attributes;
}

std::vector<PingColumn> ping_columns(const Recording& recording, const Provenance& provenance) {
  std::vector<PingColumn> of_lines;
  if (!recording.ping_numbers.empty())
    of_lines.push_back({"ping_number",
                        "1",
                        "ping of the scene, counted from 0",
                        {recording.ping_numbers.begin(), recording.ping_numbers.end()}});
  if (!recording.line_starts.empty()) {
    of_lines.push_back({"line", "1", "line of the survey, counted from 1", {}});
    auto number = static_cast<double>(recording.first_line);
    for (const PingSpan& line : recording.lines()) of_lines.back().values.resize(line.end, ++number);
  }
  if (!provenance.frame.is_georeferenced()) return of_lines;
  std::vector<PingColumn> columns{
      {"sensor_longitude", "degrees_east", "longitude of the sensor on WGS 84", {}},
      {"sensor_latitude", "degrees_north", "latitude of the sensor on WGS 84", {}},
      {"sensor_height", "m", "height of the sensor, up positive, as the scene's heights count", {}},
      {"sensor_true_heading",
       "degree",
       "heading of the sensor's forward axis, clockwise from true north",
       {}}};
  RunContext run;
  run.frame = provenance.frame;
  NavigationTrack track(recording, run);
  for (std::size_t ping = 0; ping < recording.pings(); ++ping) {
    const NavigationFix& fix = track.of(ping);
    const double values[] = {fix.place.lon_lat_height.x, fix.place.lon_lat_height.y,
                             fix.place.lon_lat_height.z, fix.lie.heading_deg};
    for (std::size_t k = 0; k < columns.size(); ++k) columns[k].values.push_back(values[k]);
  }
  columns.insert(columns.end(), of_lines.begin(), of_lines.end());
  return columns;
}

std::vector<SectorColumn> sector_columns(const Recording& recording) {
  const Sensor& sensor = *recording.sensor;
  const std::vector<TransmitSector>& sectors = sensor.transmit_sectors();
  if (sectors.empty()) return {};
  std::vector<SectorColumn> columns{
      {"sector_frequency_khz", "kHz", "centre frequency of the transmit sector"},
      {"sector_tilt", "degree",
       "angle of the axis of the transmit sector from the plane across the track, forward positive"},
      {"sector_delay", "s", "time of the transmission of the sector after ping_time"},
      {"sector_absorption_db_per_km", "dB km-1", "one-way absorption of the sector"},
      {"beam_sector", "1", "transmit sector of the beam, counted from 0", true},
      {"beam_tilt", "degree", "angle of the beam axis from the plane across the track, forward positive",
       true}};
  for (std::size_t k = 0; k < sectors.size(); ++k) {
    const double values[] = {sectors[k].frequency_khz, degrees(sectors[k].tilt_rad),
                             sensor.transmission_delay_s(sensor.first_transmission(k)),
                             recording.absorption_of(k)};
    for (std::size_t column = 0; column < std::size(values); ++column)
      columns[column].values.push_back(values[column]);
  }
  for (const BeamAxis& axis : sensor.beams()) {
    columns[4].values.push_back(static_cast<double>(axis.sector));
    columns[5].values.push_back(degrees(axis.tilt_rad));
  }
  if (std::ranges::any_of(sectors,
                          [](const TransmitSector& own) { return own.pulse_length_us.has_value(); })) {
    columns.push_back({"sector_pulse_length", "s", "length of the pulse of the sector"});
    for (std::size_t k = 0; k < sectors.size(); ++k)
      columns.back().values.push_back(sensor.pulse_length_us(k).value_or(0) * 1e-6);
  }
  return columns;
}

}  // namespace tubefoot
