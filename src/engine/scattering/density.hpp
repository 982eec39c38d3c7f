// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cmath>

#include "engine/scattering/scattering_model.hpp"

// What an element of the seabed returns along a path, per square metre: the integrand of every quadrature, in
// doubles and in balls.
//
//     sigma e^(-beta (r_out + r_rx)) / (r_out^2 r_rx^2)  [J/m^2 for 1 J/sr at 1 m]
//
// times what depends on direction or place alone: texture, patterns, losses at mirrors (PathOnFacet).
// beta = alpha ln(10) / 10, alpha in dB/m one way. sigma(tx, rx) = sqrt(sigma(out) sigma(home)) of a
// scattering model; Lambert's is mu sin(out) sin(home), the sines of the grazing angles being the distances
// of the apexes from the facet's plane over the ranges.
namespace tubefoot {

inline double squared(double x) { return x * x; }

/// The ranges of a point from both ends of its path.
template <class N>
struct TwoWayRange {
  N product, sum;

  /// From one apex and back to it.
  static TwoWayRange of(const N& range) { return {squared(range), range + range}; }
  static TwoWayRange of(const N& tx, const N& rx) { return {tx * rx, tx + rx}; }
};

template <class N>
N absorbed(const TwoWayRange<N>& two_way, const N& beta) {
  using std::exp;
  return exp(-(beta * two_way.sum));
}

template <class N>
N density(const N& sigma, const TwoWayRange<N>& two_way, const N& beta) {
  return sigma * absorbed(two_way, beta) / squared(two_way.product);
}

/// Of Lambert's law, over mu and the distances of both apexes from the plane: all that depends on ranges.
template <class N>
N lambert_density(const TwoWayRange<N>& two_way, const N& beta) {
  return absorbed(two_way, beta) / (squared(two_way.product) * two_way.product);
}

/// The same where a root has given the reciprocal of the product already: a division less at every node.
inline double density_by_reciprocal(double sigma, double per_product, double sum, double beta) {
  return sigma * std::exp(-(beta * sum)) * squared(per_product);
}

/// A law's cross-section on a plane at a distance from an apex, at a range from there.
inline double cross_section(const ScatteringModel& model, double distance_m, double range_m) {
  const double sine = std::min(distance_m / range_m, 1.0);
  return model.cross_section(
      sine, std::sqrt(std::max((range_m - distance_m) * (range_m + distance_m), 0.0)) / range_m);
}

/// The part of sigma(tx, rx) that belongs to one of the two grazing angles: sqrt(sigma); for Lambert's law
/// (no `model`) the sine, whose mu stands elsewhere.
inline double scattering_lobe(const ScatteringModel* model, double sine) {
  sine = std::min(sine, 1.0);
  if (!(sine > 0)) return 0;
  return model == nullptr ? sine : std::sqrt(model->cross_section(sine, std::sqrt(1 - sine * sine)));
}

}  // namespace tubefoot
