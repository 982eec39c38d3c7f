// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <vector>

#include "sensors/model/sensor.hpp"
#include "sensors/recordings/sonar_outline.hpp"

namespace tubefoot {

template <class S>
struct TomlField;

/// Two fans about the along-track axis, port (beam 0) and starboard (beam 1).
struct SidescanDescription {
  double frequency_khz = 455;
  double along_track_deg = 0.5;                            ///< one-way width of the ideal rectangular beam
  double depression_min_deg = 2, depression_max_deg = 85;  ///< limits of the fan below the horizontal
  std::optional<double> axis_depression_deg;               ///< axis of the patterns; unset: the fan's middle
  int samples = 1000;
  std::optional<double> sampling_frequency_khz;  ///< instead of samples: each is c / (2 f) long
  double range_min_m = 0.5, range_max_m = 50;

  static const SensorSection& kind();
};

/// The keys that all sidescan kinds share, and the checks among them. @{
std::vector<TomlField<SidescanDescription>> sidescan_fields();
void check_sidescan(const SidescanDescription& fan, const TomlTable& table);
/// @} Outline of a kind without receiver pairs.
SonarOutline sidescan_outline(const SidescanDescription& own);
/// Summary figures of the sonar.
SensorFigures sidescan_figures(const SidescanDescription& fan);

/// Sidescan with ideal rectangular beams: beam 0 looks to port, beam 1 to starboard. Each is a fan about the
/// along-track (forward) axis, from depression_min to depression_max below the horizontal, and along_track
/// wide at every depression. The port fan is the mirror image of the starboard fan, ray by ray. Patterns are
/// about the axis at axis_depression_deg, or about the fan's middle.
class Sidescan : public Sensor {
 public:
  /// Throws std::invalid_argument for an invalid fan, invalid ranges or invalid counts. Throws it also for a
  /// sampling frequency, which SensorKind::in_water() must convert into samples before.
  explicit Sidescan(const SensorDescription& description);

 protected:
  Sidescan(const SensorDescription& description, const SidescanDescription& fan);
};

}  // namespace tubefoot
