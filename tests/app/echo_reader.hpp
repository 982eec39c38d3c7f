// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "app/program.hpp"

namespace tubefoot {

/// One sensor's energies as they stand in an echoes.nc.
struct Echoes {
  std::size_t pings = 0, beams = 0, samples = 0;
  std::vector<double> energy;  ///< ping, beam, sample
  std::vector<double> bound;   ///< the same, empty where the file has none
  std::vector<double> slant_range_bounds_m;

  double at(std::size_t ping, std::size_t beam, std::size_t sample) const {
    return energy.at((ping * beams + beam) * samples + sample);
  }
  double first_m(std::size_t sample) const { return slant_range_bounds_m.at(2 * sample); }
  double last_m(std::size_t sample) const { return slant_range_bounds_m.at(2 * sample + 1); }
  /// Sample whose bounds hold a slant range.
  std::size_t sample_at(double range_m) const;
  /// Sum over samples of a beam.
  double beam_total(std::size_t ping, std::size_t beam) const;
  double total() const;
};

/// Reads `sensor`'s group, or the root group if `sensor` is empty. Throws where something is missing.
Echoes read_echoes(const std::filesystem::path& file, const std::string& sensor = {});

/// A text attribute of the root group; throws where it is missing.
std::string read_attribute(const std::filesystem::path& file, const std::string& name);

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
