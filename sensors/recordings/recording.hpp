// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// All pings of one sensor: times, poses, energies, certified bounds and signals. Writes them as an echo file
// (echoes.nc, docs/output-files.md).

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "geometry/steps/stop.hpp"
#include "scene/rasters/georeference.hpp"
#include "sensors/model/sensor.hpp"
#include "sensors/recordings/ping_energies.hpp"
#include "sensors/recordings/recorded_channel.hpp"

namespace tubefoot {

/// Pings [first, end).
struct PingSpan {
  std::size_t first = 0, end = 0;
};

struct SignalRecording;

/// All pings of one sensor in output form. The energies are stored elsewhere, in memory or packed in a file.
struct Recording {
  const Sensor* sensor = nullptr;
  std::vector<double> ping_time_s;
  std::vector<Pose> ping_pose;  ///< of the sensor
  /// [ping][transmission], of a sensor with transmit sectors, each at its own time; empty: ping_pose
  std::vector<SteeredPose> transmission_pose{};
  /// [ping][transmission], at the time of reception. Empty unless the receiver moves during a ping.
  std::vector<SteeredPose> receiver_pose{};
  std::vector<std::size_t> line_starts{};  ///< first ping of each line of a survey; empty: not divided
  std::vector<double> altitude_m;          ///< above the terrain straight below; NaN: unknown. May be empty
  /// [ping][beam][sample], J/m^2 for a source of 1 J/sr at 1 m. For a sensor with several channels
  /// (Sensor::channels) the order is [ping][channel][beam][sample]. Empty if the energies are packed.
  std::span<const double> energy;
  double sound_speed_m_s = 0;
  double absorption_db_per_km = 0;                    ///< at the sensor's frequency
  std::vector<double> sector_absorption_db_per_km{};  ///< by transmit sector; empty without them
  /// Reference runs: certified bound of each energy [J/m^2], in the order of the energies; empty in
  /// other runs.
  std::span<const double> energy_bound{};
  // The assumed configuration, with which the sonar's software makes its files (docs/processing.md). Each
  // default means that it is the true one.
  std::vector<Pose> recorded_poses{};  ///< [ping][transmission] of the sensor
  std::vector<Pose>
      recorded_receiver_poses{};  ///< the same at reception, if the receiver moves during a ping
  /// Assumed minus true height of the water level at each ping [m]. The recorded poses include it.
  std::vector<double> water_level_errors_m{};
  std::shared_ptr<const Sensor> assumed_sensor{};  ///< with recorded ranges, beam angles and mounting
  double assumed_sound_speed_m_s = 0;              ///< replaces `sound_speed_m_s`; 0: the true one
  double steering_sound_speed_m_s = 0;             ///< for the angles of beams; 0: that of the water
  double range_ratio = 1;  ///< recorded ranges divided by the true ones, in as_recorded()
  /// Sound speed for the steering of beams relative to the true one, in as_recorded(). Flat arrays record the
  /// angle asin(steering_ratio sin(true angle)).
  double steering_ratio = 1;
  // For a part of a run (docs/command-reference.md):
  std::vector<std::uint32_t> ping_numbers{};   ///< numbers in the scene; empty: all, from 0
  std::vector<std::uint32_t> beam_numbers{};   ///< numbers in the sonar; empty: all
  std::size_t first_line = 0;                  ///< number of the survey's lines before the first of
                                               ///< line_starts
  std::shared_ptr<const Sensor> some_beams{};  ///< with beam_numbers: `sensor` with these beams only
  /// Replace `energy` and `energy_bound`. Null if the values lie in memory, or if there is no bound.
  std::shared_ptr<const PackedPings> packed_energy{}, packed_bound{};
  /// Owner of the memory of `energy` and `energy_bound`; null if another object owns it.
  std::shared_ptr<const void> keeper{};
  /// Further variables over ping, beam and range bin, for echoes.nc and Python.
  std::vector<RecordedVariable> further{};
  /// Number of samples of each beam of a ping, from the first on, that may contain a visible or hidden
  /// surface. Beyond them the beam contains no surface, and a dark sample is not a shadow. Pictures show
  /// that part in a separate colour. Thread-safe; empty if unknown.
  std::function<std::vector<int>(std::size_t ping)> surfaces{};
  /// Signals of its elements, with phase (signal_recording.hpp); null for sensors without signals.
  std::shared_ptr<const SignalRecording> signals{};

  std::size_t pings() const { return ping_time_s.size(); }
  /// Number of a ping in files and pictures, and in the random generator of its noise.
  std::uint32_t number_of(std::size_t ping) const {
    return ping_numbers.empty() ? static_cast<std::uint32_t>(ping) : ping_numbers[ping];
  }
  /// Pose of the sensor at the time of the transmission that a beam receives.
  SteeredPose beam_pose(std::size_t ping, std::size_t beam) const;
  /// Pose of the receiver at the time of reception of a range bin. It is beam_pose() unless the receiver
  /// moves during a ping.
  SteeredPose receive_pose(std::size_t ping, std::size_t beam, std::size_t sample) const;
  /// Number of the transmit sector of a beam; 0 for a sensor without them.
  std::size_t sector_of(std::size_t beam) const;
  /// Number of transmit sectors; 1 for a sensor without them.
  std::size_t sectors() const;
  /// Absorption of a transmit sector, or at the sensor's frequency.
  double absorption_of(std::size_t sector) const {
    return sector_absorption_db_per_km.empty() ? absorption_db_per_km
                                               : sector_absorption_db_per_km.at(sector);
  }
  /// Pose of the sensor that its software assumes, at the time of a ping or of a transmission.
  const Pose& recorded_pose(std::size_t ping) const { return recorded_pose(ping, 0); }
  const Pose& recorded_pose(std::size_t ping, std::size_t transmission) const {
    return recorded_poses.empty() ? ping_pose.at(ping)
                                  : recorded_poses.at(ping * sensor->transmissions() + transmission);
  }
  /// This recording as the sonar's software sees it: poses, sound speed, ranges and beam angles are the
  /// assumed ones. It shares the energies.
  Recording as_recorded() const;
  double water_level_error_m(std::size_t ping) const {
    return water_level_errors_m.empty() ? 0 : water_level_errors_m.at(ping);
  }
  /// The lines of a survey, or all pings as one line.
  std::vector<PingSpan> lines() const;
  /// The line of a ping.
  PingSpan line_of(std::size_t ping) const;
  /// Length of the sensor's track along all lines [m], without the turns between lines.
  double track_length_m() const;
  /// Mean distance between neighbouring pings of a line [m]; 0 if there are none.
  double ping_spacing_m() const;
  std::size_t cells() const;     ///< per ping: beams times samples
  std::size_t channels() const;  ///< of the sensor
  /// Returns all variables over ping, beam and range bin: energies, bounds and further ones. They refer to
  /// values that this recording does not own.
  std::vector<RecordedVariable> variables() const;
  bool has_bounds() const { return packed_bound || !energy_bound.empty(); }
  /// [beam][sample]. Throws Interrupted if a stop is requested, as channel_of() does. Writers of recordings
  /// call this function for each ping.
  PingEnergies energy_of(std::size_t ping) const { return channel_of(ping, 0); }
  PingEnergies channel_of(std::size_t ping, std::size_t channel) const {
    stop_if_wanted();
    return packed_energy ? packed_energy->values(ping, channel) : in_memory(energy, ping, channel);
  }
  /// Requires bounds.
  PingEnergies bound_of(std::size_t ping, std::size_t channel) const {
    stop_if_wanted();
    return packed_bound ? packed_bound->values(ping, channel) : in_memory(energy_bound, ping, channel);
  }

 private:
  PingEnergies in_memory(std::span<const double> all, std::size_t ping, std::size_t channel) const {
    return all.subspan((ping * channels() + channel) * cells(), cells());
  }
};

/// Throws std::invalid_argument unless the recording has a sensor and consistent numbers of times, poses and
/// energies.
void check(const Recording& recording);

/// Origin of a recording; written as global attributes.
struct Provenance {
  std::string title, scene_hash, engine, arithmetic, version;
  std::optional<double> reference_tolerance{};  ///< of a reference run
  std::string start_utc{};                      ///< date and time of the scene's time 0; empty: unknown
  double coarseness = 0;                        ///< coarsening of the facets; 0: none
  LocalFrame frame{};                           ///< place of the scene on Earth, if it is georeferenced
};

/// The attributes of a Provenance, by their names in echoes.nc.
struct NamedAttribute {
  const char* name;
  std::variant<std::string, double> value;
};
std::vector<NamedAttribute> attributes_of(const Provenance& provenance);

/// Columns of echoes.nc by ping, for scenes with a place on Earth or with survey lines.
struct PingColumn {
  const char *name, *units, *long_name;
  std::vector<double> values;
};
/// Throws InputError if a ping of a georeferenced scene has no place on Earth.
std::vector<PingColumn> ping_columns(const Recording& recording, const Provenance& provenance);

/// Columns of echoes.nc by transmit sector or by beam; empty for a sensor without transmit sectors.
struct SectorColumn {
  const char *name, *units, *long_name;
  bool is_by_beam = false;
  std::vector<double> values{};
};
std::vector<SectorColumn> sector_columns(const Recording& recording);

/// Writes echoes.nc (netCDF-4, docs/output-files.md). One recording has its variables in the root group.
/// Several recordings have one group per sensor, with its name. All threads pack pings, which are written in
/// order; equal recordings give equal bytes. Writes nothing if the free disk space is too small. Throws
/// std::runtime_error that names the file and the failed operation.
void write_echoes(const std::filesystem::path& file, const std::vector<Recording>& recordings,
                  const Provenance& provenance);

}  // namespace tubefoot
