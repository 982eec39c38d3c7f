// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "import/bin_axes.hpp"

namespace tubefoot {

/// Energies of imported pictures, [ping][beam][sample], and the axes of their bins.
struct CandidateEchoes {
  BinAxes axes;
  std::size_t pings = 0;
  std::vector<double> energy;
  /// For each ping, the corresponding ping of the reference.
  std::vector<std::size_t> ping_of_reference;
  std::vector<std::pair<std::string, std::string>> attributes;  ///< global attributes of the file
};

/// Writes an echo file (docs/output-files.md) with the times, poses and other properties of the sensor of the
/// reference. Throws std::runtime_error, which names the file.
void write_candidate(const std::filesystem::path& file, const CandidateEchoes& candidate,
                     const WholeEchoFile& reference, std::size_t sensor);

}  // namespace tubefoot
