// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/certified/pattern_ambiguity.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

#include "engine/certified/certified_gain.hpp"
#include "geometry/numbers/enclosure_slack.hpp"

// Bounds the change of beam patterns for directions that differ by a small angle, and the resulting error of
// energies. It uses the largest slopes of the square roots of patterns and the inequality of Cauchy and
// Schwarz. See docs/notes/certified-energies.md, section "Of two ends".
namespace tubefoot {
namespace {

/// Cosines between an axis and directions.
Interval cosines_of(const glm::dvec3& axis, const Towards& towards) {
  const double range = glm::length(towards.centre_m);
  if (!(range > towards.radius_m)) return {-1, 1};
  const double middle = glm::dot(axis, towards.centre_m) / range,
               apart = std::asin(towards.radius_m / range) * (1 + enclosure_slack) + enclosure_slack;
  return {std::max(middle - apart, -1.0), std::min(middle + apart, 1.0)};
}

/// Bound of the change of a pattern's square root. The direction has an error of `turn_rad`, and its cosine
/// with the pattern's axis an additional relative error of `stretch`. Largest slopes: sinc x = sin(pi x) /
/// (pi x) has 1.3703, and a shaded line array at most 1 + shading times as much. The function 2 J1(x) / x has
/// 0.37, or 1/8 as a function of x^2. The function exp(-2 ln 2 (a / size)^2) has 1.0099 / size.
double root_change(const Directivity& d, double turn_rad, double stretch, const Towards& towards) {
  if (d.kind == Directivity::Kind::uniform) return 0;
  if (d.kind == Directivity::Kind::line) return 1.3705 * (1 + d.shading) * d.size * (turn_rad + stretch);
  if (d.kind == Directivity::Kind::piston)
    return 0.4 * d.size * 1.01 * turn_rad + d.size * d.size / 4 * 1.01 * stretch;
  // Functions of the angle have d acos w = d asin w = dw / sqrt(1 - w^2) in modulus. The change of an angle
  // is largest at angle 0.
  const double flattest = std::min(cosines_of(d.axis, towards).largest() + stretch, 1.0),
               sine = std::sqrt((1 - flattest) * (1 + flattest)),
               turn =
                   1.01 * turn_rad + std::min(sine > 0 ? stretch / sine : 1.0, 1.2 * std::sqrt(2 * stretch));
  if (d.kind == Directivity::Kind::gaussian) return 1.011 / d.size * turn;
  return std::sqrt(CertifiedGain(d).largest().hi()) *
         std::expm1(d.table->steepest() * std::numbers::ln10 / 20 * turn) * (1 + enclosure_slack);
}

}  // namespace

Towards Towards::places(std::span<const glm::dvec3> places_m) {
  Towards found;
  for (const glm::dvec3& p : places_m) found.centre_m += p / double(places_m.size());
  for (const glm::dvec3& p : places_m)
    found.radius_m = std::max(found.radius_m, glm::distance(p, found.centre_m) * (1 + enclosure_slack));
  return found;
}

double most_of(const Directivity& pattern, const Towards& towards) {
  const CertifiedGain gain(pattern);
  if (gain.is_uniform()) return 1;
  const double most = gain.largest().hi();
  return std::min(gain.at(cosines_of(pattern.axis, towards), false, most).hi, most);
}
double most_of(const TransmitPattern& transmit, const Towards& towards) {
  double sum = 0;
  for (const Directivity& beam : transmit.beams) sum += most_of(beam, towards);
  return sum;
}

double most_of(const MirrorLoss& loss, const Towards& towards) {
  double exponent = 0;
  for (const glm::dvec3& normal : loss.rough_normals) {
    const Interval sine = cosines_of(normal, towards);
    const double least = sine.lo <= 0 && sine.hi >= 0 ? 0 : std::min(std::abs(sine.lo), std::abs(sine.hi));
    exponent += std::max(0.0, least * least - loss.bend * (1 - least * least));
  }
  return loss.factor * std::exp(-loss.roughness * exponent) * (1 + enclosure_slack);
}

PatternAmbiguity::PatternAmbiguity(const TransmitPattern& transmit, const Towards& there,
                                   const BistaticEnclosure& proven)
    : tx_beams(double(transmit.beams.size())), most_tx(tubefoot::most_of(transmit, there)) {
  for (const Directivity& beam : transmit.beams)
    tx_change = std::max(tx_change, root_change(beam, proven.turn_rad[0], proven.stretch[0], there));
}

void PatternAmbiguity::take_rx(const Directivity& receive, const Towards& back,
                               const BistaticEnclosure& proven) {
  most_rx = std::max(taken_ ? most_rx : 0.0, tubefoot::most_of(receive, back));
  rx_change = std::max(rx_change, root_change(receive, proven.turn_rad[1], proven.stretch[1], back));
  taken_ = true;
}

double PatternAmbiguity::of(double energy, double plain) const {
  const double t = tx_change, n = tx_beams, r = rx_change, tx = plain * most_tx, rx = plain * most_rx,
               root_n = std::sqrt(n);
  return (2 * t * root_n * std::sqrt(energy * rx) + n * t * t * rx + 2 * r * std::sqrt(energy * tx) +
          r * r * tx + 4 * t * r * root_n * std::sqrt(energy * plain) +
          2 * t * root_n * r * r * std::sqrt(tx * plain) + 2 * r * n * t * t * std::sqrt(rx * plain) +
          n * t * t * r * r * plain) *
         (1 + enclosure_slack);
}

}  // namespace tubefoot
