// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "engine/certified/certified_cells.hpp"
#include "engine/certified/certified_gain.hpp"
#include "engine/echo/sink.hpp"
#include "engine/scattering/beam_pattern.hpp"
#include "engine/scattering/scattering_model.hpp"
#include "geometry/integrals/certified_polygon.hpp"

namespace tubefoot {

/// Encloses the integral of what an even seabed returns to one apex (density.hpp) over a polygon's part in
/// each range sample, times the patterns of its tube and the micro-texture of its cell if there are any.
/// docs/reference.md says how.
///
/// The integrand is not negative, and so are all parts of the integral. In a slab (polar_slabs.hpp) it is
/// analytic in t, r^2 = q^2 + t^2, and in the angle. Gauss-Legendre with N >= 2 nodes errs by at most
/// 64/15 M rho^-2N / (1 - rho^-2) on [-1, 1], where M bounds the integrand on the ellipse with foci +-1 and
/// semi-axes that add up to rho (L. N. Trefethen, Approximation Theory and Approximation Practice, theorem
/// 19.3); M comes from one evaluation on the rectangle around the ellipse. Intervals are halved until the
/// error fits; what is left at the work limit, and the gaps between slabs, are bounded by the largest value
/// of the integrand.
class CertifiedIntegrator {
 public:
  /// What a piece needs: how far off its part of a bin may be.
  struct Allowance {
    double relative = 0;  ///< of what the part itself has
    /// What is allowed besides for each slab, by beam of the receiver and sample, before the factor.
    std::function<double(std::uint32_t beam, std::uint32_t sample)> absolute;
  };

  /// `beta_per_m`: absorption, one way.
  CertifiedIntegrator(std::span<const double> borders_m, const Ball& beta_per_m);

  /// The law of the polygons from now on; null: r^-2 in its place, which is Lambert's but for a factor.
  void take_model(const ScatteringModel* model) { model_ = model; }

  /// Without patterns: all parts are of `beam`. With a texture the polygon lies in its cell.
  void add(const CertifiedPolygon& polygon, std::uint32_t beam, const Allowance& allowance,
           const Sink<Ball>& sink, const CertifiedCell* texture = nullptr);
  /// With patterns, for all beams that receive the tube.
  void add(const CertifiedPolygon& polygon, const BeamPatterns& patterns, std::uint32_t tube,
           const Allowance& allowance, const Sink<Ball>& sink, const CertifiedCell* texture = nullptr);

  /// Intervals that were left at the work limit, so far.
  std::size_t given_up() const { return given_up_; }

 private:
  struct Arc {
    Crossing begin, end;
    Ball turns;  // to add to end - begin
  };
  /// A direction cosine over a polygon: cosine = (away distance + rho (u cos + v sin)) / r.
  struct Cosine : CertifiedGain {
    Ball away, u, v;  // the pattern's axis in the polygon's frame
  };
  /// A part of a slab; `v` runs from -1 to 1 along each of its arcs.
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
  bool prepare(std::span<const Crossing> crossings, const PolarSlabs::Slab& slab);
  bool find_arcs(std::span<const Crossing> crossings, const Ball& t);
  void integrate_slab(const PolarSlabs::Slab& slab, bool clear, double relative);
  void integrate(const Ball& t0, const Ball& t1, double relative);
  Ball scattered_over(const Ball& r) const;
  Ball most_density(const Ball& nearest, const Ball& over) const;
  bool try_interval(const Interval& interval, const Ball& whole, double relative);
  void halve(const Interval& interval);
  void enclose(const Interval& interval);
  double nearest_singularity() const;

  template <class N>
  N angle_at(const Crossing& crossing, const N& t, const N& t2) const;
  template <class N>
  N radial(const N& t, const N& r) const;
  template <class N>
  N arcs_length(const N& t, const N& t2) const;

  // With patterns or a texture.
  template <class N>
  std::pair<N, N> ends_of(const Arc* arc, const N& t, const N& t2) const;
  template <class N>
  N cosine_at(const Cosine& cosine, const N& distance_over_r, const N& rho_over_r, const N& angle) const;
  Cosine cosine_of(const Directivity& pattern) const;
  double log_bound(const Arc* arc, const ComplexBall& t, const ComplexBall& v,
                   std::vector<double>& by_beam) const;
  Ball gain(const Cosine& cosine, const Ball& w) const { return cosine.at(w, by_segment_, largest_gain_); }
  std::vector<double> take_segments(const Arc* arc, const Ball& t, const Ball& v);
  bool try_patterned(const Interval& interval, const Ball& whole, double relative);
  std::vector<Ball> box(const Interval& interval) const;
  bool try_box(const Interval& interval, double share, double relative);
  std::vector<Ball> values(const Arc* arc, const Ball& t, const std::vector<Ball>& v,
                           const std::vector<Ball>& weight) const;

  std::span<const double> borders_;
  Ball beta_, distance2_, largest_gain_;
  std::size_t given_up_ = 0;

  const ScatteringModel* model_ = nullptr;
  const ScatteringModel::Piece* model_piece_ = nullptr;  // of the interval at hand
  std::vector<PolarSlabs::Gap> corners_;                 // where the law's pieces meet, in slabs
  const CertifiedPolygon* polygon_ = nullptr;
  PolarSlabs slabs_;
  Ball q2_;
  std::uint32_t q_edge_ = 0;
  bool full_circle_ = false;
  std::vector<Ball> beyond2_;  // by edge: q^2 - its nearest2
  std::vector<Arc> arcs_;
  std::vector<Part> parts_;  // by beam from the first
  std::vector<Interval> work_;
  bool weighed_ = false;  // by patterns, a texture or both
  const CertifiedCell* texture_ = nullptr;
  std::vector<Cosine> transmit_;  // beams sent at once
  std::vector<Cosine> receive_;
  bool tabulated_ = false;   // some pattern is a table
  bool by_segment_ = false;  // tables are what their cosine's segment says
  bool split_arcs_ = false;  // which way the interval that failed last should be halved
};

}  // namespace tubefoot
