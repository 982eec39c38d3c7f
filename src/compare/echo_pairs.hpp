// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "sensors/recordings/echo_reader.hpp"

namespace tubefoot {

/// Two echo files whose sensors can be compared bin by bin.
struct EchoPairs {
  struct Sensor {
    const SensorEchoes *reference, *candidate;
  };
  std::vector<Sensor> sensors;
  std::vector<std::string> notes;  ///< remarks for the reader of the figures
};

/// Pairs the sensors of two files by name. A single sensor in each file needs no common name.
///
/// Each pair must have equal numbers of pings, beams and samples. Slant ranges must agree within 1 % of a
/// sample, and beam axes within 0.001 degree. The files must have the same scene hash. A missing hash adds a
/// note. Otherwise the function throws InputError, which names both files.
///
/// `sensor`: only this sensor. `any_scene`: different hashes add a note instead of an error.
EchoPairs pair_echoes(const EchoContents& reference, const EchoContents& candidate,
                      const std::optional<std::string>& sensor, bool any_scene);

}  // namespace tubefoot
