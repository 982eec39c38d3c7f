// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <glm/vec3.hpp>
#include <span>

#include "engine/certified/bistatic_enclosure.hpp"
#include "engine/scattering/beam_pattern.hpp"
#include "engine/scattering/path.hpp"

// What beam patterns may make of places that are seen in slightly other directions than they are laid out in.
namespace tubefoot {

/// Directions to what is no farther than that from a place.
struct Towards {
  glm::dvec3 centre_m{0};
  double radius_m = 0;

  static Towards places(std::span<const glm::dvec3> places_m);
};

/// No less than what a pattern leaves in these directions.
double most_of(const Directivity& pattern, const Towards& towards);
double most_of(const TransmitPattern& transmit, const Towards& towards);
/// Or mirrors let pass.
double most_of(const MirrorLoss& loss, const Towards& towards);

/// What patterns in slightly other directions make of an energy, which would be `plain` without patterns.
/// With a^2 and b^2 the patterns there and back, integrals of a times others are bounded by Cauchy's and
/// Schwarz's inequality.
struct PatternAmbiguity {
  double tx_change = 0, tx_beams = 1, most_tx = 1;
  double rx_change = 0, most_rx = 1;

  /// of the transmit leg; the receive leg is taken after that, of one receiver or the worst of several.
  PatternAmbiguity() = default;
  PatternAmbiguity(const TransmitPattern& transmit, const Towards& there, const BistaticEnclosure& proven);
  void take_rx(const Directivity& receive, const Towards& back, const BistaticEnclosure& proven);

  double of(double energy, double plain) const;

 private:
  bool taken_ = false;
};

}  // namespace tubefoot
