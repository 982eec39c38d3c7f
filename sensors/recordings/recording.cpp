// SPDX-License-Identifier: GPL-3.0-or-later
#include "sensors/recordings/recording.hpp"

#include <fmt/format.h>

#include <stdexcept>

#include "sensors/recordings/navigation.hpp"

namespace tubefoot {

std::size_t Recording::cells() const {
  return sensor->beams().size() * static_cast<std::size_t>(sensor->samples().count);
}

std::size_t Recording::channels() const { return static_cast<std::size_t>(sensor->channels()); }

void check(const Recording& recording) {
  if (!recording.sensor) throw std::invalid_argument("a recording without a sensor cannot be written");
  const Sensor& sensor = *recording.sensor;
  const std::size_t pings = recording.ping_time_s.size();
  const std::size_t cells = pings * recording.channels() * recording.cells();
  if (pings == 0 || recording.ping_pose.size() != pings || recording.energy.size() != cells ||
      (!recording.energy_bound.empty() && recording.energy_bound.size() != cells))
    throw std::invalid_argument(fmt::format(
        "recording of '{}' does not add up: {} ping times, {} poses, {} energies for {} beams of {} samples",
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

std::vector<EarthColumn> earth_columns(const Recording& recording, const Provenance& provenance) {
  if (!provenance.frame.is_georeferenced()) return {};
  std::vector<EarthColumn> columns{
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
  return columns;
}

}  // namespace tubefoot
