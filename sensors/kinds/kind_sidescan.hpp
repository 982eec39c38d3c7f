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
  double depression_min_deg = 2, depression_max_deg = 85;  ///< the fan's limits below the horizontal
  std::optional<double> axis_depression_deg;               ///< what patterns are about; else the fan's middle
  int samples = 1000;
  std::optional<double> sampling_frequency_khz;  ///< instead of samples: each is c / (2 f) long
  double range_min_m = 0.5, range_max_m = 50;

  static const SensorSection& kind();
};

/// The keys that every kind that is a sidescan has, and what holds among them.
/// @{
std::vector<TomlField<SidescanDescription>> sidescan_fields();
void check_sidescan(const SidescanDescription& fan, const TomlTable& table);
/// @}
/// Its form, of a kind that has no receivers above each other.
SonarOutline sidescan_outline(const SidescanDescription& own);
/// Its figures.
SensorFigures sidescan_figures(const SidescanDescription& fan);

/// Sidescan with ideal rectangular beams: beam 0 looks to port, beam 1 to starboard. Each is a fan about the
/// along-track (forward) axis: from depression_min to depression_max below the horizontal, and along_track
/// wide at every depression. The port fan is the mirror image of the starboard fan, ray by ray. Patterns are
/// about the axis at axis_depression_deg, or about the fan's middle.
class Sidescan : public Sensor {
 public:
  /// Throws std::invalid_argument for a fan, ranges or counts that make no sidescan, and for a sampling
  /// frequency: SensorKind::in_water() turns that into samples.
  explicit Sidescan(const SensorDescription& description);

 protected:
  Sidescan(const SensorDescription& description, const SidescanDescription& fan);
};

}  // namespace tubefoot
