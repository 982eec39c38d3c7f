// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <string>

namespace tubefoot {

class Transmission;

/// An engine that is not built in. It runs, and is charted and compared, like those that are.
struct OwnEngine {
  std::string name;
  /// Fills the energies [J] that a sensor receives of a transmission, [channel][beam of the
  /// transmission][sample] (Sensor::channels()), which are 0 before. Where terrain is read by tiles, the
  /// transmission's survey has those that the built-in engines need for it, and its ground knows what facets
  /// are called in all of the scene. Called from several threads at a time. What it throws ends the run; so
  /// does a product of two receivers' signals that their energies cannot have (std::domain_error).
  std::function<void(const Transmission& transmission, std::size_t sensor, std::span<double> energy)> echo;
};

}  // namespace tubefoot
