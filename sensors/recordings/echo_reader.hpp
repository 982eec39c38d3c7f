// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "sensors/recordings/recording.hpp"

namespace tubefoot {

/// One sensor's part of an echo file. Optional members are empty if the file does not contain them.
struct SensorEchoes {
  std::string name;  ///< `sensor_name`, or the group's name, or "sensor"
  std::size_t pings = 0, beams = 0, samples = 0;
  std::vector<double> energy;                ///< ping, beam, sample; J, finite and not negative
  std::vector<double> energy_bound;          ///< certified bound of `energy`, J, not negative; optional
  std::vector<double> slant_range_m;         ///< centre of each sample, increasing
  std::vector<double> slant_range_bounds_m;  ///< begin and end of each sample; optional
  std::vector<double> beam_azimuth_deg;
  std::vector<double> beam_elevation_deg;  ///< optional
  std::vector<double> ping_time_s;         ///< optional
  /// For a part of a run: numbers of the pings in the scene and of the beams in the sonar; whole,
  /// increasing. Optional.
  std::vector<double> ping_number, beam_number;

  double at(std::size_t ping, std::size_t beam, std::size_t sample) const {
    return energy.at((ping * beams + beam) * samples + sample);
  }
};

/// An echo file of tubefoot or of another program. docs/output-files.md lists the required contents.
struct EchoContents {
  std::filesystem::path file;
  Provenance provenance;  ///< empty texts if the file has none
  std::vector<SensorEchoes> sensors;
};

/// Reads every sensor of an echo file, netCDF-4 or classic. Compares sizes with the file's size and the
/// machine's memory before any allocation. Throws InputError that names file and variable, the value found,
/// the expected value and a remedy. It also throws for energies that are not finite, negative or were never
/// written.
EchoContents read_echo_file(const std::filesystem::path& file);

}  // namespace tubefoot
