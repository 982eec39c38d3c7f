// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "import/bin_axes.hpp"

namespace tubefoot {

/// Energies of imported pictures, [ping][beam][sample], and where their bins are.
struct CandidateEchoes {
  BinAxes axes;
  std::size_t pings = 0;
  std::vector<double> energy;
  /// Of each ping, that of the reference which it is of.
  std::vector<std::size_t> ping_of_reference;
  std::vector<std::pair<std::string, std::string>> attributes;  ///< of the file
};

/// Writes an echo file (docs/echo-file.md) with times, poses and what else there is of the reference's
/// sensor. Throws std::runtime_error naming the file.
void write_candidate(const std::filesystem::path& file, const CandidateEchoes& candidate,
                     const WholeEchoFile& reference, std::size_t sensor);

}  // namespace tubefoot
