// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <glm/vec3.hpp>
#include <span>

#include "engine/certified/bistatic_enclosure.hpp"
#include "engine/scattering/beam_pattern.hpp"
#include "engine/scattering/path.hpp"

// Bounds the effect of direction errors on beam patterns. Rays to a point start in slightly other directions
// than those of the flattened point.
namespace tubefoot {

/// Directions to all points within a radius of a centre.
struct Towards {
  glm::dvec3 centre_m{0};
  double radius_m = 0;

  static Towards places(std::span<const glm::dvec3> places_m);
};

/// Upper bound of a pattern in these directions.
double most_of(const Directivity& pattern, const Towards& towards);
double most_of(const TransmitPattern& transmit, const Towards& towards);
/// Upper bound of the mirror losses in these directions.
double most_of(const MirrorLoss& loss, const Towards& towards);

/// Bound of the energy error due to patterns in slightly wrong directions, where `plain` is the energy
/// without patterns. Let a^2 and b^2 be the transmit and receive patterns. The inequality of Cauchy and
/// Schwarz bounds integrals of a times other factors.
struct PatternAmbiguity {
  double tx_change = 0, tx_beams = 1, most_tx = 1;
  double rx_change = 0, most_rx = 1;

  /// The constructor sets the transmit leg. take_rx() then adds a receive leg: of one receiver, or the worst
  /// of several.
  PatternAmbiguity() = default;
  PatternAmbiguity(const TransmitPattern& transmit, const Towards& there, const BistaticEnclosure& proven);
  void take_rx(const Directivity& receive, const Towards& back, const BistaticEnclosure& proven);

  double of(double energy, double plain) const;

 private:
  bool taken_ = false;
};

}  // namespace tubefoot
