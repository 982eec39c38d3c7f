// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "app/program.hpp"
#include "sensors/recordings/echo_reader.hpp"

namespace tubefoot {

/// One sensor of an echoes.nc that tubefoot wrote.
struct Echoes : SensorEchoes {
  double first_m(std::size_t sample) const { return slant_range_bounds_m.at(2 * sample); }
  double last_m(std::size_t sample) const { return slant_range_bounds_m.at(2 * sample + 1); }
  /// Sample whose bounds hold a slant range.
  std::size_t sample_at(double range_m) const;
  /// Sum over samples of a beam.
  double beam_total(std::size_t ping, std::size_t beam) const;
  double total() const;
};

/// Reads `sensor`, or the first one if `sensor` is empty. Throws where something is missing.
Echoes read_echoes(const std::filesystem::path& file, const std::string& sensor = {});

/// Writes the scene, runs it with further arguments and reads the energies; throws with the program's own
/// words if it fails.
Echoes echoes_of(const std::string& scene, const std::vector<std::string>& arguments = {},
                 const std::string& sensor = {});
/// The same where the scene names files in `folder`.
Echoes echoes_in(const TestFolder& folder, const std::string& scene,
                 const std::vector<std::string>& arguments = {}, const std::string& sensor = {});

/// Largest |a - b| / max(|a|, |b|) over all samples; infinite where the sizes differ.
double largest_relative_difference(const Echoes& a, const Echoes& b);

}  // namespace tubefoot
