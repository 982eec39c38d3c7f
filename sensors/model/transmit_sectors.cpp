// SPDX-License-Identifier: GPL-3.0-or-later
#include "sensors/model/transmit_sectors.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string_view>

#include "sensors/model/angles.hpp"

namespace tubefoot {
namespace {

/// Rounding of angles, by which a beam may be outside of the outermost edges.
constexpr double edge_slack_deg = 1e-9;

std::size_t count_of_sectors(const SectorKeys& keys) {
  return keys.edges_deg.empty() ? 1 : keys.edges_deg.size() - 1;
}

const std::vector<double>& values_of(const SectorKeys& keys, std::string_view key) {
  return *std::ranges::find(keys.lists, key, &SectorList::key)->values;
}

/// Returns the sector of a beam. The intervals contain their lower edge, and the last one both edges. Empty
/// for a beam outside of all sectors.
std::optional<std::size_t> sector_at(const std::vector<double>& edges_deg, double angle_deg) {
  if (edges_deg.empty()) return 0;
  if (angle_deg < edges_deg.front() - edge_slack_deg || angle_deg > edges_deg.back() + edge_slack_deg)
    return std::nullopt;
  const auto above = std::upper_bound(edges_deg.begin() + 1, edges_deg.end() - 1, angle_deg);
  return static_cast<std::size_t>(above - edges_deg.begin() - 1);
}

std::optional<SectorError> error_of_edges(const std::vector<double>& edges,
                                          const std::vector<double>& angles_rad) {
  const char* key = "sector_edges_deg";
  if (edges.empty()) return std::nullopt;
  if (edges.size() == 1)
    return SectorError{key, "'sector_edges_deg' has one edge, but a sector has two edges: add an edge"};
  for (std::size_t k = 1; k < edges.size(); ++k)
    if (!(edges[k] > edges[k - 1]))
      return SectorError{key, fmt::format("the sectors overlap: 'sector_edges_deg' must increase, from port "
                                          "to starboard, but {} follows {}",
                                          edges[k], edges[k - 1])};
  constexpr std::size_t most = 255;  // files store the number of a sector in one byte
  if (edges.size() - 1 > most)
    return SectorError{key, fmt::format("'sector_edges_deg' defines {} sectors, but a sonar may have at most "
                                        "{}: use fewer edges",
                                        edges.size() - 1, most)};
  std::vector<std::size_t> beams(edges.size() - 1);
  for (std::size_t beam = 0; beam < angles_rad.size(); ++beam) {
    const double angle_deg = degrees(angles_rad[beam]);
    const auto sector = sector_at(edges, angle_deg);
    if (!sector)
      return SectorError{key, fmt::format("the sectors leave a gap: beam {} at {:.6g} degrees is in no "
                                          "sector, because the sectors extend from {} to {} degrees",
                                          beam, angle_deg, edges.front(), edges.back())};
    ++beams[*sector];
  }
  for (std::size_t sector = 0; sector < beams.size(); ++sector)
    if (beams[sector] == 0)
      return SectorError{key, fmt::format("sector {} from {} to {} degrees has no beam: move its edges, or "
                                          "remove the sector",
                                          sector, edges[sector], edges[sector + 1])};
  return std::nullopt;
}

}  // namespace

std::optional<SectorError> error_of_sectors(const SensorDescription& sensor, const SectorKeys& keys,
                                            const std::vector<double>& angles_rad) {
  if (auto error = error_of_edges(keys.edges_deg, angles_rad)) return error;
  const std::size_t count = count_of_sectors(keys);
  for (const auto& [key, values] : keys.lists)
    if (!values->empty() && values->size() != count)
      return SectorError{key, fmt::format("'{}' has {} values, but the sonar has {} sector{}: {}", key,
                                          values->size(), count, count == 1 ? "" : "s",
                                          keys.edges_deg.empty() ? "set 'sector_edges_deg', or give one value"
                                                                 : "give one value per sector")};
  for (const double delay_us : values_of(keys, "sector_delays_us"))
    if (sensor.has_several_pings() && delay_us * 1e-6 >= sensor.shortest_interval_s())
      return SectorError{"sector_delays_us",
                         fmt::format("a delay of {} us is longer than the ping: it must be below "
                                     "the time between pings, which is {} s",
                                     delay_us, sensor.shortest_interval_s())};
  for (const double tilt_deg : values_of(keys, "sector_tilts_deg"))
    if (!(std::abs(tilt_deg) + keys.along_track_deg / 2 < 90))
      return SectorError{
          "sector_tilts_deg",
          fmt::format("a sector with a tilt of {} degrees and an 'along_track_deg' of {} degrees reaches to "
                      "the forward or backward axis: tilt and half of the width must be below 90 degrees",
                      tilt_deg, keys.along_track_deg)};
  return std::nullopt;
}

std::vector<FanSector> sectors_of(const SectorKeys& keys, const std::vector<double>& angles_rad) {
  std::vector<FanSector> sectors(count_of_sectors(keys));
  const double half_across_rad = radians(keys.beam_across_deg) / 2;
  std::uint32_t beam = 0;
  for (std::size_t k = 0; k < sectors.size(); ++k) {
    const auto value = [&](std::string_view key) {
      const std::vector<double>& values = values_of(keys, key);
      return values.empty() ? std::optional<double>() : values[k];
    };
    FanSector& sector = sectors[k];
    sector.first_beam = beam;
    while (beam < angles_rad.size() && sector_at(keys.edges_deg, degrees(angles_rad[beam])) == k) ++beam;
    sector.end_beam = beam;
    sector.delay_s = value("sector_delays_us").value_or(0) * 1e-6;
    TransmitSector& own = sector.properties;
    own.frequency_khz = value("sector_frequencies_khz").value_or(keys.frequency_khz);
    own.tilt_rad = radians(value("sector_tilts_deg").value_or(0));
    own.first_across_rad = angles_rad[sector.first_beam] - half_across_rad;
    own.last_across_rad = angles_rad[sector.end_beam - 1] + half_across_rad;
    own.pulse_length_us = value("sector_pulse_lengths_us");
    own.absorption_db_per_km = value("sector_absorptions_db_per_km");
  }
  return sectors;
}

bool differ_from_sensor(const std::vector<FanSector>& sectors, const SectorKeys& keys) {
  const TransmitSector& first = sectors.front().properties;
  return sectors.size() > 1 || sectors.front().delay_s != 0 || first.tilt_rad != 0 ||
         first.frequency_khz != keys.frequency_khz || first.pulse_length_us || first.absorption_db_per_km;
}

}  // namespace tubefoot
