// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "engine/certified/certified_integral.hpp"
#include "geometry/integrals/interval_polygon.hpp"

namespace tubefoot {

/// CertifiedIntegrator's integral in intervals of doubles, without patterns and textures: much faster, to
/// some 1e-12 of a usual part. What doubles do not tell as closely as is allowed is left to balls.
///
/// Slabs, rule and its error bound are the same. M comes from closed forms: in a disk about the middle of an
/// interval no function is farther from its value there than the disk's radius times its largest slope, and
/// all slopes are made of moduli whose zeros are known.
class IntervalIntegrator {
 public:
  using Allowance = CertifiedIntegrator::Allowance;
  struct SamplePart {
    std::uint32_t sample = 0;
    Interval value;
  };

  /// `beta_per_m`: absorption, one way.
  IntervalIntegrator(std::span<const double> borders_m, const Interval& beta_per_m)
      : borders_(borders_m), beta_(beta_per_m) {}

  /// As CertifiedIntegrator's.
  void take_model(const ScatteringModel* model) { model_ = model; }

  /// What the polygon has in each sample, in `parts`; false if some part is not enclosed as narrowly as is
  /// allowed for `beam`: then they say nothing.
  bool enclose(const IntervalPolygon& polygon, std::uint32_t beam, const Allowance& allowance,
               std::vector<SamplePart>& parts);

 private:
  struct Arc {
    Crossing begin, end;
    Interval base;  // its length but for what both ends turn by
  };
  /// From one t to another.
  struct Stretch {
    double from = 0, to = 0;
  };
  struct Allowed {
    double relative = 0, absolute = 0;
  };
  /// Of an arc's end: how fast its angle may change.
  struct End {
    double height = 0;      // largest modulus
    double from_zeros = 0;  // of s; of the edge that q is of: none
    bool of_q = false;
  };
  /// Disks about a place t: values there, and how far what is divided by is from its zeros.
  struct Place {
    double t = 0, arcs = 0;
    double range_zeros = 0, rho_zeros = 0, nearest_zeros = 0;
    Interval range, incidence;
  };

  bool prepare(const PolarSlabs::Slab& slab);
  bool find_arcs(std::span<const Crossing> crossings, const Interval& t);
  bool add_slab(const PolarSlabs::Slab& slab, const Allowed& allowed);
  bool add_ranges(long double lo, long double hi, const Allowed& allowed);
  bool integrate(double from, double to, const Allowed& allowed);
  bool try_rule(const Stretch& stretch, const Allowed& allowed, double share);

  double most_turn(long double range) const;
  double most_density(const Interval& range) const;
  double most_in(const Stretch& stretch) const;
  Place place_at(double t, const Interval& arcs);
  double most_within(const Place& place, double radius) const;
  double most_scattered(const Place& place, double radius) const;

  Interval turn(std::uint32_t edge, const Interval& t, const Interval& t2) const;
  Interval angle_at(const Crossing& crossing, const Interval& t, const Interval& t2) const;
  Interval arcs_length(const Interval& t, const Interval& t2) const;
  Interval rho_at(const Interval& t, const Interval& t2) const;
  Interval radial(const Interval& t, const Interval& t2) const;

  std::span<const double> borders_;
  Interval beta_;
  const ScatteringModel* model_ = nullptr;
  const ScatteringModel::Piece* model_piece_ = nullptr;  // of the ranges at hand

  const IntervalPolygon* polygon_ = nullptr;
  PolarSlabs slabs_;
  std::vector<PolarSlabs::Gap> corners_;  // where the law's pieces meet, in slabs
  Interval distance_;
  Interval sum_;  // of the slab at hand
  // Of what all circles between two events meet, and the slab of which that was found.
  std::optional<std::pair<std::uint32_t, std::uint32_t>> prepared_;
  bool full_circle_ = false;
  std::uint32_t q_edge_ = 0;
  FineInterval q2_;
  Interval range_q2_, rho_q2_;     // q^2 in doubles, and from the foot point
  std::vector<Interval> beyond2_;  // by edge: q^2 - its nearest2
  std::vector<Arc> arcs_;
  std::vector<std::pair<Interval, Crossing>> sorted_;
  std::vector<End> ends_;  // of the arcs, at the place at hand
  std::vector<Stretch> work_;
};

}  // namespace tubefoot
