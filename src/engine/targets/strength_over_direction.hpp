// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <glm/vec3.hpp>
#include <vector>

namespace tubefoot {

/// Backscattering cross-section of a body as a function of the direction to the sonar and of the frequency.
/// Between the angles of the table, the cross-section in m^2 is linear in elevation, azimuth and frequency.
/// Beyond the first and the last elevation, the value at that elevation applies. Azimuths continue with a
/// period of 360 degrees.
class StrengthOverDirection {
 public:
  /// Angles in degrees and frequencies in Hz, each increasing. The values in m^2 are [elevation][azimuth]
  /// [frequency]. Throws std::invalid_argument for values of another number or sign, and for axes that do not
  /// increase. It also throws for azimuths with a gap of more than twice their largest step.
  StrengthOverDirection(std::vector<double> elevations_deg, std::vector<double> azimuths_deg,
                        std::vector<double> frequencies_hz, std::vector<double> cross_sections_m2);

  /// Returns the cross-section in m^2. `direction` is the unit vector to the sonar in the axes of the body:
  /// azimuth from x towards y, elevation towards z. The frequency counts as the nearest one of the table if
  /// it is outside of the table.
  double at(glm::dvec3 direction, double frequency_hz) const;
  /// Returns whether a frequency lies in the table, or within one percent of its ends.
  bool covers(double frequency_hz) const;
  const std::vector<double>& frequencies_hz() const { return frequencies_hz_; }
  /// Returns a bound of the rounding error of at(), in m^2.
  double rounding_m2() const { return rounding_m2_; }

 private:
  std::vector<double> elevations_deg_, azimuths_deg_, frequencies_hz_, cross_sections_m2_;
  double rounding_m2_ = 0;
};

}  // namespace tubefoot
