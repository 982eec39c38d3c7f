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
  std::vector<std::string> notes;  ///< what the reader of the figures should know
};

/// Pairs the sensors of two files by name (or one with one, whatever they are called). Throws InputError,
/// which names both files, unless each pair has equal numbers of pings, beams and samples, slant ranges equal
/// to 1 % of a sample, beam axes equal to 0.001 degree, and the files one scene hash; a file without a hash
/// is noted. `sensor`: only this one. `any_scene`: differing hashes are noted instead.
EchoPairs pair_echoes(const EchoContents& reference, const EchoContents& candidate,
                      const std::optional<std::string>& sensor, bool any_scene);

}  // namespace tubefoot
