// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cstddef>
#include <type_traits>
#include <vector>

#include "engine/certified/certified_scattering.hpp"
#include "engine/certified/certified_volume.hpp"
#include "engine/scattering/density.hpp"
#include "engine/scattering/scattering_model.hpp"
#include "geometry/integrals/polar_arcs.hpp"

// The monostatic echo density over a slab of a polygon as an integral over range, for any number type. Its
// integrand is the density of a circle times the length of its arcs in the polygon. CertifiedIntegrator and
// IntervalIntegrator add their bounds of the quadrature error. Include this heavy header only in .cpp files
// and in headers of integrators.
namespace tubefoot {

template <class Numbers>
class PolarIntegrand : public PolarArcs<Numbers> {
  using Arcs = PolarArcs<Numbers>;

 public:
  using typename Arcs::Number;

  /// `beta_per_m`: one-way absorption.
  explicit PolarIntegrand(const Number& beta_per_m) : beta_(beta_per_m) {}

  /// Sets the scattering model of the following polygons. With null, the integrand contains r^-2 instead,
  /// which is Lambert's law up to a constant factor.
  void take_model(const ScatteringModel* model) { model_ = model; }

  /// Replaces the density of the echo. `solid_angle`: r^-3, so that the integral times the distance of the
  /// plane is the solid angle. `volume`: r^-3 (F(r) - F(start)), with the primitive F of volume_primitive().
  /// Only for balls.
  enum class Density { echo, solid_angle, volume };
  void take_density(Density density) { density_ = density; }

  /// The integrand over t: t times the density times the length of the arcs. Because r dr = t dt, the
  /// integral over t equals that of density times r times arcs over r.
  template <class N>
  N value(const N& t) const {
    const N t2 = squared(t), r2 = N(this->range_q2_) + t2;
    return radial(t, r2, root(r2)) * this->arcs_length(t, t2);
  }
  /// Its integral over [middle - half, middle + half] by a rule on [-1, 1], without the error of the rule.
  template <class Node>
  Number by_rule(const Number& middle, const Number& half, const std::vector<Node>& nodes,
                 const std::vector<Node>& weights) const {
    Number sum;
    for (std::size_t i = 0; i < nodes.size(); ++i) sum += weights[i] * value(middle + half * nodes[i]);
    return sum * half;
  }

 protected:
  /// t times the density. `r2`: the squared range, from which the range `r` was computed.
  template <class N>
  N radial(const N& t, const N& r2, const N& r) const;
  /// Upper bound of the density from `nearest` on, up to the far end of the ranges `over`.
  Number most_density(const Number& nearest, const Number& over) const;
  /// Calls part(lo, hi) for the ranges of the slab in each piece of the model. A model is analytic in each of
  /// its pieces. The pieces meet at irrational ranges. Enclosures of these ranges are omitted here and
  /// recorded in corners_. Stops and returns false if `part` returns false.
  template <class Part>
  bool each_piece(const PolarSlabs::Slab& slab, const Part& part);

  Number beta_;
  const ScatteringModel* model_ = nullptr;
  Density density_ = Density::echo;
  Number start_{};  ///< F at the start of the current sample, for the density of the volume
  const ScatteringModel::Piece* model_piece_ = nullptr;  // of the current ranges
  std::vector<PolarSlabs::Gap> corners_;  // ranges at which the model's pieces meet, as gaps in slabs
};

template <class Numbers>
template <class N>
N PolarIntegrand<Numbers>::radial(const N& t, const N& r2, const N& r) const {
  if constexpr (std::is_same_v<Number, Ball>) {
    if (density_ == Density::solid_angle) return t / (r2 * r);
    if (density_ == Density::volume) return t * (volume_primitive(r, beta_) - N(start_)) / (r2 * r);
  }
  const TwoWayRange<N> two_way{Numbers::range_product(r2, r), r + r};
  const N beta(beta_);
  if (model_piece_ == nullptr) return t * lambert_density(two_way, beta);
  const N incidence = Numbers::incidence(this->distance_, this->rho_at(t, squared(t)));
  return t * density(cross_section_in(*model_piece_, incidence, N(N(this->distance_) / r)), two_way, beta);
}

template <class Numbers>
auto PolarIntegrand<Numbers>::most_density(const Number& nearest, const Number& over) const -> Number {
  if constexpr (std::is_same_v<Number, Ball>) {
    const Number cube = squared(nearest) * nearest;
    if (density_ == Density::solid_angle) return Number(1) / cube;
    if (density_ == Density::volume)
      return Number(std::max((volume_primitive(over, beta_) - start_).hi(), 0.0)) / cube;
  }
  const auto two_way = TwoWayRange<Number>::of(nearest);
  if (model_ == nullptr) return lambert_density(two_way, beta_);
  const Number rho = root(squared(over) - squared(this->distance_));
  const Number sigma =
      cross_section_over(*model_, Numbers::angle_of(this->distance_, rho), this->distance_ / over);
  return density(Number(Numbers::upper(sigma)), two_way, beta_);
}

template <class Numbers>
template <class Part>
bool PolarIntegrand<Numbers>::each_piece(const PolarSlabs::Slab& slab, const Part& part) {
  model_piece_ = nullptr;
  if (model_ == nullptr) return part(slab.lo, slab.hi);
  const auto& pieces = model_->pieces();
  long double from = slab.lo;
  for (const ScatteringModel::Piece& piece : pieces) {
    model_piece_ = &piece;
    if (&piece == &pieces.back()) return part(from, slab.hi);
    const RangeEnclosure corner = Numbers::range_at(this->distance_, piece.to);
    if (!(corner.hi > from)) continue;
    if (!part(from, std::min(corner.lo, slab.hi))) return false;
    if (!(corner.lo < slab.hi)) return true;
    from = std::max(from, corner.lo);
    corners_.push_back({from, std::min(corner.hi, slab.hi), slab.sample, slab.sample + 1});
    if (!(corner.hi < slab.hi)) return true;
    from = corner.hi;
  }
  return true;
}

}  // namespace tubefoot
