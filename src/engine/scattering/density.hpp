// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cmath>

#include "engine/scattering/scattering_model.hpp"

// Energy density that an element of the seabed returns along a path, per square metre. It is the integrand of
// every quadrature, in doubles and in balls:
//
//     sigma e^(-beta (r_tx + r_rx)) / (r_tx^2 r_rx^2)  [J/m^2 for 1 J/sr at 1 m]
//
// Factors that depend on direction or place alone multiply it: texture, patterns, losses at mirrors
// (PathOnFacet). beta = alpha ln(10) / 10, with alpha in dB/m one way. For a scattering model sigma(tx, rx) =
// sqrt(sigma(tx) sigma(rx)). For Lambert's law it is mu sin(tx) sin(rx). The sine of a grazing angle is the
// distance of the apex from the facet's plane divided by the range.
namespace tubefoot {

inline double squared(double x) { return x * x; }

/// The ranges of a point from both ends of its path.
template <class N>
struct TwoWayRange {
  N product, sum;

  /// The range from one apex and back to it.
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

/// The part of the density of Lambert's law that depends on ranges. It is the density divided by mu and by
/// the distances of both apexes from the plane.
template <class N>
N lambert_density(const TwoWayRange<N>& two_way, const N& beta) {
  return absorbed(two_way, beta) / (squared(two_way.product) * two_way.product);
}

/// The same for a known reciprocal of the product, which saves one division per node.
inline double density_by_reciprocal(double sigma, double per_product, double sum, double beta) {
  return sigma * std::exp(-(beta * sum)) * squared(per_product);
}

/// Returns the cross-section of a scattering model on a plane at a distance from an apex, at a range from the
/// apex.
inline double cross_section(const ScatteringModel& model, double distance_m, double range_m) {
  const double sine = std::min(distance_m / range_m, 1.0);
  return model.cross_section(
      sine, std::sqrt(std::max((range_m - distance_m) * (range_m + distance_m), 0.0)) / range_m);
}

/// Returns the factor of sigma(tx, rx) for one of the two grazing angles: sqrt(sigma). For Lambert's law (no
/// `model`) it is the sine, and mu is applied elsewhere.
inline double scattering_lobe(const ScatteringModel* model, double sine) {
  sine = std::min(sine, 1.0);
  if (!(sine > 0)) return 0;
  return model == nullptr ? sine : std::sqrt(model->cross_section(sine, std::sqrt(1 - sine * sine)));
}

}  // namespace tubefoot
