// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "run/sensor_set.hpp"
#include "scene/scene.hpp"

// This header declares the assumed configuration of the sensors of a survey. It consists of recorded poses,
// sound speeds, ranges and beam angles by which the files of the sonars differ from the truth.

namespace tubefoot {

/// Error of the water level as a function of time: assumed minus true height.
class WaterLevelError {
 public:
  /// Reads the file of the description if there is one. Throws InputError.
  explicit WaterLevelError(const ProcessingDescription& processing);
  /// Throws InputError for a time outside of the file.
  double at_m(double time_s) const;

 private:
  struct Level {
    double time_s, tide_m;
  };
  const ProcessingDescription& processing_;
  std::vector<Level> levels_;
};

/// Computes the assumed configuration of all sensors from [processing] and [sensors.processing]. Members of
/// SensorPings that equal the truth keep their defaults. Adds warnings to the report of the scene. Throws
/// InputError if a latency or a tide file does not cover a transmission.
void assume_configuration(Scene& scene, SensorSet& sensor_set);

/// Returns the differences of the assumed from the true configuration of a sensor; empty if both agree.
std::optional<std::string> assumed_configuration_text(const Scene& scene, const SensorPings& pings);

}  // namespace tubefoot
