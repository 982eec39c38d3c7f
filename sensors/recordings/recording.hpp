// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

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

namespace tubefoot {

/// Pings [first, end).
struct PingSpan {
  std::size_t first = 0, end = 0;
};

struct SignalRecording;

/// All pings of one sensor, as they are written. The energies lie elsewhere, in memory or packed in a file.
struct Recording {
  const Sensor* sensor = nullptr;
  std::vector<double> ping_time_s;
  std::vector<Pose> ping_pose;             ///< of the sensor
  std::vector<std::size_t> line_starts{};  ///< first ping of each line of a survey; empty: not divided
  std::vector<double> altitude_m;  ///< above the terrain straight below; not a number: unknown. May be empty
  /// [ping][beam][sample], J for a source of 1 J/sr at 1 m. Of a sensor with more channels
  /// (Sensor::channels) those of a ping follow each other: [ping][channel][beam][sample]. Empty where they
  /// are packed.
  std::span<const double> energy;
  double sound_speed_m_s = 0;
  double absorption_db_per_km = 0;
  /// Reference runs: certified half-width of each energy [J], laid out as the energies; empty in others.
  std::span<const double> energy_bound{};
  // Of a part of a run (docs/commands.md):
  std::vector<std::uint32_t> ping_numbers{};   ///< as the scene counts them; empty: all, from 0
  std::vector<std::uint32_t> beam_numbers{};   ///< as the sonar counts them; empty: all
  std::size_t first_line = 0;                  ///< lines of the survey before the first of line_starts
  std::shared_ptr<const Sensor> some_beams{};  ///< with beam_numbers: `sensor`, with these beams only
  /// In place of `energy` and `energy_bound`; null where they lie in memory, or where there is no bound.
  std::shared_ptr<const PackedPings> packed_energy{}, packed_bound{};
  /// Keeps `energy` and `energy_bound` in memory; null where somebody else does.
  std::shared_ptr<const void> keeper{};
  /// Of each beam of a ping, how many samples from the first on may hold a surface, seen or hidden. Beyond
  /// them the scene has nothing in the beam, and what is dark there is no shadow: pictures show it in a
  /// colour of its own. Thread-safe; empty where that is not known.
  std::function<std::vector<int>(std::size_t ping)> surfaces{};
  /// What its elements receive, with phase (signal_recording.hpp); null for sensors without.
  std::shared_ptr<const SignalRecording> signals{};

  std::size_t pings() const { return ping_time_s.size(); }
  /// What a ping is called, in files and pictures, and by what draws its noise.
  std::uint32_t number_of(std::size_t ping) const {
    return ping_numbers.empty() ? static_cast<std::uint32_t>(ping) : ping_numbers[ping];
  }
  /// The lines of a survey, or all pings as one.
  std::vector<PingSpan> lines() const;
  /// The one of a ping.
  PingSpan line_of(std::size_t ping) const;
  /// Way of the sensor from ping to ping along all lines [m]; turns between them are none of it.
  double track_length_m() const;
  /// Mean distance between neighbouring pings of a line [m]; 0 without any.
  double ping_spacing_m() const;
  std::size_t cells() const;     ///< of a ping: beams times samples
  std::size_t channels() const;  ///< of the sensor
  bool has_bounds() const { return packed_bound || !energy_bound.empty(); }
  /// [beam][sample]. Throws Interrupted if somebody wants to stop, as channel_of() does: whoever writes a
  /// recording comes here for each ping.
  PingEnergies energy_of(std::size_t ping) const { return channel_of(ping, 0); }
  PingEnergies channel_of(std::size_t ping, std::size_t channel) const {
    stop_if_wanted();
    return packed_energy ? packed_energy->values(ping, channel) : in_memory(energy, ping, channel);
  }
  /// With bounds.
  PingEnergies bound_of(std::size_t ping, std::size_t channel) const {
    stop_if_wanted();
    return packed_bound ? packed_bound->values(ping, channel) : in_memory(energy_bound, ping, channel);
  }

 private:
  PingEnergies in_memory(std::span<const double> all, std::size_t ping, std::size_t channel) const {
    return all.subspan((ping * channels() + channel) * cells(), cells());
  }
};

/// Throws std::invalid_argument unless the recording has a sensor and as many times, poses and energies as it
/// says.
void check(const Recording& recording);

/// Where a recording comes from; written as global attributes.
struct Provenance {
  std::string title, scene_hash, engine, arithmetic, version;
  std::optional<double> reference_tolerance{};  ///< of a reference run
  std::string start_utc{};                      ///< date and time of the scene's time 0; empty: not said
  double coarseness = 0;                        ///< that facets were coarsened to; 0: they were not
  LocalFrame frame{};                           ///< where the scene lies on Earth, if it says so
};

/// All of that, by the names that echoes.nc has it under.
struct NamedAttribute {
  const char* name;
  std::variant<std::string, double> value;
};
std::vector<NamedAttribute> attributes_of(const Provenance& provenance);

/// What echoes.nc has of every ping of some scenes: with a place on Earth, or with lines of a survey.
struct PingColumn {
  const char *name, *units, *long_name;
  std::vector<double> values;
};
/// Throws InputError where a ping has no place on Earth, and the scene has.
std::vector<PingColumn> ping_columns(const Recording& recording, const Provenance& provenance);

/// Writes echoes.nc (netCDF-4, docs/echo-file.md). One recording: variables in the root group. Several: one
/// group per sensor, named after it. Pings are packed by all threads and written in order; equal recordings
/// give equal bytes. Nothing is written unless the disk has room for all of it. Throws std::runtime_error
/// naming the file and what failed.
void write_echoes(const std::filesystem::path& file, const std::vector<Recording>& recordings,
                  const Provenance& provenance);

}  // namespace tubefoot
