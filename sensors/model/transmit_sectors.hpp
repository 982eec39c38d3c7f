// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "scene/description/sensor_description.hpp"
#include "sensors/model/sensor.hpp"

// Transmit sectors of a fan across the track: division of its beams, and checks of the keys.
namespace tubefoot {

/// A key with one value per sector, and its values, which may be empty.
struct SectorList {
  const char* key;
  const std::vector<double>* values;
};

/// The keys of a fan that determine its sectors. It refers to the values of a description.
struct SectorKeys {
  const std::vector<double>& edges_deg;
  std::vector<SectorList> lists;  ///< frequencies, tilts, delays, pulse lengths and absorptions
  double frequency_khz = 0, beam_across_deg = 0, along_track_deg = 0;
};

/// A transmit sector with the beams [first_beam, end_beam).
struct FanSector {
  std::uint32_t first_beam = 0, end_beam = 0;
  double delay_s = 0;
  TransmitSector properties;
};

/// An invalid key of the sectors, and the reason.
struct SectorError {
  std::string key, what;
};

/// Returns the first error of the keys of the sectors. `angles_rad`: axes of the beams from straight down, in
/// increasing order.
std::optional<SectorError> error_of_sectors(const SensorDescription& sensor, const SectorKeys& keys,
                                            const std::vector<double>& angles_rad);

/// Returns the sectors of keys without errors. Without the keys, all beams are in one sector.
std::vector<FanSector> sectors_of(const SectorKeys& keys, const std::vector<double>& angles_rad);

/// True if some sector differs from the only sector of a sonar without the keys.
bool differ_from_sensor(const std::vector<FanSector>& sectors, const SectorKeys& keys);

}  // namespace tubefoot
