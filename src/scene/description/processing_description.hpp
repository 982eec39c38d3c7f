// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>

#include "files/input_error.hpp"
#include "scene/description/water_description.hpp"

// Part of the description of a scene file: scene/description/scene_description.hpp.
namespace tubefoot {

/// The assumed configuration: water, navigation and water level with which the software of a sonar makes
/// its files. Each default is the true value. docs/processing.md
struct ProcessingDescription {
  SourcePlace place;
  std::optional<WaterDescription> water;                ///< assumed water; empty: the true one
  std::optional<double> sound_speed_at_transducer_m_s;  ///< for steering; empty: the true one
  double latency_s = 0, attitude_latency_s = 0;  ///< age of a recorded position, and of a recorded attitude
  SourcePlace latency_place, attitude_latency_place;
  double tide_m = 0;                               ///< assumed water level minus the true one
  std::optional<std::filesystem::path> tide_file;  ///< CSV of the same difference by time, in addition
  SourcePlace tide_file_place;
  // Errors of sensors: recorded minus true value. Attitudes are heading, pitch and roll, and positions are
  // east, north and up.
  std::array<double, 3> attitude_bias_deg{}, attitude_drift_deg_per_hour{}, attitude_noise_deg{};
  std::array<double, 3> position_bias_m{}, position_drift_m_per_hour{}, position_noise_m{};
  std::uint64_t seed = 1;  ///< of the noise
};

/// Mounting of a sensor that its software assumes. Empty members are the true values.
struct AssumedMountingDescription {
  SourcePlace place;
  std::optional<double> yaw_deg, tilt_deg, roll_deg;
  std::optional<std::array<double, 3>> lever_arm_m;
};

}  // namespace tubefoot
