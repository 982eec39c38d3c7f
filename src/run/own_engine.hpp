// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <string>

namespace tubefoot {

class Transmission;

/// An engine of the user. Runs, charts and comparisons treat it as they treat the built-in engines.
struct OwnEngine {
  std::string name;
  /// Fills the energies [J/m^2 for a source of 1 J/sr] that a sensor receives from a transmission:
  /// [channel][beam of the transmission][sample] (Sensor::channels()). They are 0 before the call. If
  /// terrain is read by tiles, the survey of the transmission contains the tiles that the built-in engines
  /// need. Its surface mesh then reports facet numbers of the whole scene. Several threads call this
  /// function at the same time. An exception ends the run. A cross product of two receivers' signals that
  /// exceeds the geometric mean of their energies also ends the run (std::domain_error).
  std::function<void(const Transmission& transmission, std::size_t sensor, std::span<double> energy)> echo;
};

}  // namespace tubefoot
