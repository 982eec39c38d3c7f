// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "sensors/recordings/recording.hpp"

namespace tubefoot {

/// One sensor's part of an echo file. What a file need not have is empty where it has not.
struct SensorEchoes {
  std::string name;  ///< `sensor_name`, else the group's name, else "sensor"
  std::size_t pings = 0, beams = 0, samples = 0;
  std::vector<double> energy;                ///< ping, beam, sample; J, finite and not negative
  std::vector<double> energy_bound;          ///< certified half-width of `energy`, J, not negative; optional
  std::vector<double> slant_range_m;         ///< centre of each sample, increasing
  std::vector<double> slant_range_bounds_m;  ///< begin and end of each sample; optional
  std::vector<double> beam_azimuth_deg;
  std::vector<double> beam_elevation_deg;  ///< optional
  std::vector<double> ping_time_s;         ///< optional
  /// Of a part of a run: what the scene calls its pings and the sonar its beams; whole, increasing. Optional
  std::vector<double> ping_number, beam_number;

  double at(std::size_t ping, std::size_t beam, std::size_t sample) const {
    return energy.at((ping * beams + beam) * samples + sample);
  }
};

/// An echo file: tubefoot's own or a stranger's (docs/echo-file.md says what that must hold).
struct EchoContents {
  std::filesystem::path file;
  Provenance provenance;  ///< empty texts where the file does not say
  std::vector<SensorEchoes> sensors;
};

/// Reads every sensor of an echo file, netCDF-4 or classic. Sizes are checked against the file's size and the
/// machine's memory before anything is allocated. Throws InputError naming file and variable, what was found,
/// what was expected and what to do, also for energies that are not finite, negative or were never written.
EchoContents read_echo_file(const std::filesystem::path& file);

}  // namespace tubefoot
