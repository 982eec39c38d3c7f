// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "engine/certified/certified_integral.hpp"
#include "engine/certified/polar_integrand.hpp"
#include "geometry/integrals/interval_polygon.hpp"
#include "geometry/integrals/polar_numbers.hpp"

// Encloses the integral of CertifiedIntegrator in intervals of doubles. With r^2 = q^2 + t^2, Gauss-Legendre
// quadrature runs over t. Its error bound uses closed-form bounds of the integrand on a disk around the
// ellipse. See docs/notes/certified-energies.md, section "Doubles first".
namespace tubefoot {

/// Computes the integral of CertifiedIntegrator in intervals of doubles, without patterns and textures. It
/// is much faster, with a relative error of about 1e-12 for ordinary parts. If doubles do not meet the
/// allowance, the caller uses balls.
///
/// Slabs, quadrature rule and error bound are the same. M comes from closed forms. In a disk about the
/// middle of an interval, a function changes by at most the radius times its largest slope. All slopes
/// consist of moduli whose zeros are known.
class IntervalIntegrator : private PolarIntegrand<IntervalNumbers> {
 public:
  using Allowance = CertifiedIntegrator::Allowance;
  struct SamplePart {
    std::uint32_t sample = 0;
    Interval value;
  };

  /// `beta_per_m`: one-way absorption.
  IntervalIntegrator(std::span<const double> borders_m, const Interval& beta_per_m)
      : PolarIntegrand(beta_per_m), borders_(borders_m) {}

  using PolarIntegrand::take_model;

  /// Encloses the polygon's integral in each sample, in `parts`. Returns false if the enclosure of some part
  /// misses the allowance for `beam`; `parts` is then invalid.
  bool enclose(const IntervalPolygon& polygon, std::uint32_t beam, const Allowance& allowance,
               std::vector<SamplePart>& parts);

 private:
  /// Interval of t.
  struct Stretch {
    double from = 0, to = 0;
  };
  struct Allowed {
    double relative = 0, absolute = 0;
  };
  /// Bounds of the slope of the angle at an end of an arc.
  struct End {
    double height = 0;      // largest modulus
    double from_zeros = 0;  // distance to the zeros of s; unused for the edge of q
    bool of_q = false;
  };
  /// Disk about a value t: values at t, and distances to the zeros of all divisors.
  struct Place {
    double t = 0, arcs = 0;
    double range_zeros = 0, rho_zeros = 0, nearest_zeros = 0;
    Interval range, incidence;
  };

  bool prepare_slab(const PolarSlabs::Slab& slab);
  bool add_slab(const PolarSlabs::Slab& slab, const Allowed& allowed);
  bool add_ranges(long double lo, long double hi, const Allowed& allowed);
  bool integrate(double from, double to, const Allowed& allowed);
  bool try_rule(const Stretch& stretch, const Allowed& allowed, double share);

  double most_turn(long double range) const;
  double most_density_over(const Interval& range) const { return most_density(range.lo, range).hi; }
  double most_in(const Stretch& stretch) const;
  Place place_at(double t, const Interval& arcs);
  double most_within(const Place& place, double radius) const;
  double most_scattered(const Place& place, double radius) const;

  std::span<const double> borders_;
  PolarSlabs slabs_;
  Interval sum_;  // of the current slab
  // First crossing and number of crossings for which arcs were prepared. All circles between two events have
  // the same crossings.
  std::optional<std::pair<std::uint32_t, std::uint32_t>> prepared_;
  std::vector<End> ends_;  // of the arcs, at the current place
  std::vector<Stretch> work_;
};

}  // namespace tubefoot
