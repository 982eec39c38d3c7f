// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "engine/certified/certified_cells.hpp"
#include "engine/certified/certified_gain.hpp"
#include "engine/certified/polar_integrand.hpp"
#include "engine/echo/sink.hpp"
#include "engine/scattering/beam_pattern.hpp"
#include "engine/scattering/scattering_model.hpp"
#include "geometry/integrals/certified_polygon.hpp"
#include "geometry/integrals/polar_numbers.hpp"

// Encloses integrals of the monostatic echo density over polygons, split into range samples, in ball
// arithmetic. Optional factors are beam patterns and micro-texture. See docs/notes/certified-energies.md.
namespace tubefoot {

/// Encloses the return of an untextured seabed to one apex (density.hpp) over a polygon's part in each range
/// sample. Patterns of the tube and the micro-texture of the cell are optional factors.
/// docs/notes/certified-energies.md describes the method.
///
/// The integrand and all parts of the integral are non-negative. In a slab (polar_slabs.hpp) the integrand
/// is analytic in t, with r^2 = q^2 + t^2, and in the angle. Gauss-Legendre quadrature with N >= 2 nodes on
/// [-1, 1] has an error of at most 64/15 M rho^-2N / (1 - rho^-2). M bounds the integrand on the ellipse
/// with foci +-1 and semi-axes that add up to rho (L. N. Trefethen, Approximation Theory and Approximation
/// Practice, theorem 19.3). One evaluation on the rectangle around the ellipse yields M.
///
/// Intervals are halved until the error is within the allowance. The largest value of the integrand bounds
/// the intervals that remain at the work limit, and the gaps between slabs.
class CertifiedIntegrator : private PolarIntegrand<BallNumbers> {
 public:
  /// Permitted error of a piece's part of a bin.
  struct Allowance {
    double relative = 0;  ///< relative to the energy of the part
    /// Additional permitted error per slab, by receive beam and sample, before the factor.
    std::function<double(std::uint32_t beam, std::uint32_t sample)> absolute;
  };

  /// `beta_per_m`: one-way absorption.
  CertifiedIntegrator(std::span<const double> borders_m, const Ball& beta_per_m);

  using PolarIntegrand::Density;
  using PolarIntegrand::take_density;
  using PolarIntegrand::take_model;

  /// Integrates without patterns; all parts belong to `beam`. With a texture, the polygon must lie in its
  /// cell.
  void add(const CertifiedPolygon& polygon, std::uint32_t beam, const Allowance& allowance,
           const Sink<Ball>& sink, const CertifiedCell* texture = nullptr);
  /// Integrates with patterns, for all beams that receive the tube.
  void add(const CertifiedPolygon& polygon, const BeamPatterns& patterns, std::uint32_t tube,
           const Allowance& allowance, const Sink<Ball>& sink, const CertifiedCell* texture = nullptr);

  /// Number of intervals that were left at the work limit.
  std::size_t given_up() const { return given_up_; }

 private:
  /// Direction cosine over a polygon: cosine = (away distance + rho (u cos + v sin)) / r.
  struct Cosine : CertifiedGain {
    Ball away, u, v;  // the pattern's axis in the polygon's frame
  };
  /// Part of a slab. `v` runs from -1 to 1 along each of its arcs.
  struct Interval {
    Ball from, to;
    int depth = 0;
    double v_from = -1, v_to = 1;
  };
  struct Part {
    Ball sum;
    double allowed = 0;
  };

  void add(const CertifiedPolygon& polygon, std::uint32_t first_beam, std::uint32_t end_beam,
           const Allowance& allowance, const Sink<Ball>& sink);
  void integrate_slab(const PolarSlabs::Slab& slab, bool clear, double relative);
  void integrate(const Ball& t0, const Ball& t1, double relative);
  bool try_interval(const Interval& interval, const Ball& whole, double relative);
  void halve(const Interval& interval);
  void enclose(const Interval& interval);
  double nearest_singularity() const;

  // The following functions are for patterns or a texture.
  template <class N>
  std::pair<N, N> ends_of(const Arc* arc, const N& t, const N& t2) const;
  template <class N>
  N cosine_at(const Cosine& cosine, const N& distance_over_r, const N& rho_over_r, const N& angle) const;
  static Cosine cosine_of(const Directivity& pattern, const CertifiedPolygon& polygon);
  double log_bound(const Arc* arc, const ComplexBall& t, const ComplexBall& v,
                   std::vector<double>& by_beam) const;
  Ball gain(const Cosine& cosine, const Ball& w) const { return cosine.at(w, by_segment_, largest_gain_); }
  std::vector<double> take_segments(const Arc* arc, const Ball& t, const Ball& v);
  bool try_patterned(const Interval& interval, const Ball& whole, double relative);
  std::vector<Ball> box(const Interval& interval) const;
  bool try_box(const Interval& interval, double share, double relative);
  std::vector<Ball> values(const Arc* arc, const Ball& t, const std::vector<Ball>& v,
                           const std::vector<Ball>& weight) const;

  void take_sample(std::size_t sample);

  std::span<const double> borders_;
  std::vector<Ball> starts_;  // F at the start of each sample, for the density of the volume
  Ball largest_gain_;
  std::size_t given_up_ = 0;

  PolarSlabs slabs_;
  std::vector<Part> parts_;  // by beam, from the first
  std::vector<Interval> work_;
  bool weighed_ = false;  // by patterns, a texture or both
  const CertifiedCell* texture_ = nullptr;
  std::vector<Cosine> transmit_;  // beams of one transmission
  std::vector<Cosine> receive_;
  bool tabulated_ = false;   // some pattern is a table
  bool by_segment_ = false;  // tables are represented by the segments of their cosines
  bool split_arcs_ = false;  // whether the interval that failed last should be halved along its arcs
};

}  // namespace tubefoot
