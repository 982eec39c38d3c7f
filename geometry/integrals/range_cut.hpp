// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Integrates a function of range over planar polygons, separately for each range sample. Green's theorem
// converts the integral over polygon and sample into an integral along the polygon's boundary.

#include <array>
#include <cstddef>
#include <functional>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "geometry/integrals/measure.hpp"
#include "geometry/integrals/range_lanes.hpp"

namespace tubefoot {

/// Integrals of a function of range over planar polygons that are cut by range samples.
///
/// On a plane at distance D from the apex let rho, phi be polar coordinates about the foot point. Then r^2 =
/// D^2 + rho^2, so that r dr = rho drho, and an area element is r dr dphi. Let F_k(r) = integral of g(r) r
/// ds from r_k to r (clamped to the sample r_k .. r_k+1). By Green's theorem the integral of g(r) dA over
/// polygon and sample k is the integral of F_k(r(phi)) dphi along the polygon's boundary. Boundary beyond
/// the sample counts F_k(r_k+1) times its angle, and boundary nearer than the sample counts nothing. The
/// arcs in which polygon and sample meet need no construction.
///
/// This class is F. One object, prepared for a set of range samples and a g, serves any number of polygons.
class RadialIntegral {
 public:
  /// A range interval on which g(r) r is a polynomial up to rounding. A sample consists of one or more
  /// cells.
  struct Cell {
    double lo = 0, hi = 0;  ///< range, metres
    double middle = 0, per_half = 0;
    int degree = 0;
    std::size_t sample = 0;
    std::array<double, 13> primitive{};  ///< primitive of g(r) r, in x = (s - middle) * per_half
    double whole = 0;                    ///< its integral over the whole cell
  };

  /// The integrals within a cell from one range on, prepared for many upper ends.
  class From {
   public:
    From() = default;
    From(const Cell& cell, double from_m);
    /// Integrals of g(r) r ds over lengths from there, each independent of the others. The divided
    /// difference of the primitive keeps the relative accuracy for short lengths too. `Real` is a double or
    /// a vector of doubles.
    template <class Real, std::size_t n>
    std::array<Real, n> over(const std::array<Real, n>& lengths_m) const {
      std::array<Real, n> x, quotient;
#pragma GCC unroll 4
      for (std::size_t k = 0; k < n; ++k) {
        x[k] = x0_ + lengths_m[k] * per_half_;
        quotient[k] = Real{};
      }
      for (auto i = static_cast<std::size_t>(degree_); i-- > 0;)
#pragma GCC unroll 4
        for (std::size_t k = 0; k < n; ++k) quotient[k] = quotient[k] * x[k] + quotient_[i];
#pragma GCC unroll 4
      for (std::size_t k = 0; k < n; ++k) quotient[k] = lengths_m[k] * per_half_ * quotient[k];
      return quotient;
    }
    double over(double length_m) const { return over(std::array{length_m})[0]; }

   private:
    friend class RadialIntegral;
    double x0_ = 0, per_half_ = 0;
    int degree_ = 0;
    std::array<double, 12> quotient_{};  ///< coefficients of (P(x) - P(x0)) / (x - x0), where P is the
                                         ///< primitive
  };

  /// Ranges below this one are omitted, because g is often singular at the apex.
  static constexpr double nearest_range_m = 1e-9;

  /// `borders_m`: sample k is borders_m[k] .. borders_m[k+1]; increasing, not negative, finite, at least
  /// two. `g`: finite and smooth on the samples. The constructor splits cells until an interpolant of degree
  /// 11 represents g to about 1e-15. `kinks_m`: increasing ranges at which cells end, because derivatives
  /// of g may jump or be infinite there. Next to such a range, a cell of 1e-10 of the range is accepted as
  /// it is. `roundings`: error of the values of g in units of 1e-15. Throws std::invalid_argument for borders
  /// that break these rules, for a g that is not finite, and for a g that no splitting makes smooth.
  RadialIntegral(std::span<const double> borders_m, const std::function<double(double)>& g,
                 std::span<const double> kinks_m = {}, double roundings = 1);

  std::size_t samples() const { return samples_; }
  const std::vector<Cell>& cells() const { return cells_; }
  /// Integrals from a cell's near end on.
  const From& from_front(std::size_t cell) const { return from_front_[cell]; }
  /// The same as arrays by cell, for loops over several cells: near ends, far ends, and the data of From.
  const double* lows() const { return lane(0); }
  const double* highs() const { return lane(1); }
  CellsOfStretches cells_from(std::size_t cell, std::size_t count) const;

  double front() const { return cells_.front().lo; }
  double back() const { return cells_.back().hi; }

  /// Index of the cell that contains a range: 0 for a nearer range, cells().size() for a farther one.
  std::size_t cell_at(double range_m) const;

  /// Integral of g(r) r ds from `from_m` to `from_m + length_m` inside a cell.
  static double within(const Cell& cell, double from_m, double length_m) {
    return From(cell, from_m).over(length_m);
  }

 private:
  const double* lane(std::size_t row) const { return lanes_.data() + row * cells_.size(); }

  std::size_t samples_;
  std::vector<Cell> cells_;
  std::vector<From> from_front_;
  std::vector<double> lanes_;  ///< rows by cell: low, high, x0, per_half, degree, quotient[0], ...
  double cells_per_m_ = 0;
};

/// Samples [first, end).
struct SampleSpan {
  std::size_t first = 0, end = 0;
};

/// Cuts polygons by the range samples of a RadialIntegral. An object contains scratch memory; use one per
/// thread.
/// Law R1 (Green): out[k] is the integral of g over polygon and sample k.
/// Law R2 (whole): the samples of a polygon add up to the integral over it.
/// Law R3 (polygons add up): the parts of a polygon have together, sample by sample, the integral of the
/// polygon.
/// Law R4 (samples add up): the parts of a sample have together the integral of the sample.
/// Law R5 (digits): small polygons far away keep their digits.
class RangeCutter {
 public:
  /// `second`: another integrand on the same cells, which shares the walk along the edges. Throws
  /// std::invalid_argument if its cells differ.
  explicit RangeCutter(const RadialIntegral& radial, const RadialIntegral* second = nullptr);

  /// Adds factor * (integral of g dA over polygon and sample k) to out[k], for every sample. `corners_m`: a
  /// polygon on `plane`, relative to the apex, with the orientation of visible polygons (footprint.hpp). The
  /// opposite orientation gives the negative. The polygon need not be convex. `out` has radial.samples()
  /// elements. Returns the samples to which it added; the others stay unchanged.
  SampleSpan add(std::span<const glm::dvec3> corners_m, const FacetPlane& plane, double factor,
                 std::span<double> out);

  /// The same for a polygon in its plane's coordinates. `second_out`: sums of the second integrand, if there
  /// is one.
  SampleSpan add(const PlanarPolygon& polygon, double factor, std::span<double> out,
                 std::span<double> second_out = {});

 private:
  struct Edge;
  void walk(const Edge& edge);
  void walk_outwards(const Edge& edge, double from, double to);
  void integrate_along(const Edge& edge, double direction, std::size_t first_cell, std::size_t count);
  void integrate(const Edge& edge, std::size_t cell, double from, double to);

  const RadialIntegral& radial_;
  const RadialIntegral* second_;
  PlanarPolygon polygon_;
  NearestPoint nearest_;
  glm::dvec2 nearest_from_foot_{0};
  std::size_t first_ = 0, last_ = 0;  ///< cells that contain the polygon's nearest and farthest points
  /// integrals in the first cell from the polygon's nearest range on, of both integrands
  RadialIntegral::From from_nearest_, second_from_nearest_;
  std::vector<double> inside_;  ///< by cell from first_: integral of F dphi over the boundary inside the
                                ///< cell
  std::vector<double> second_inside_;  ///< the same for the second integrand
  std::vector<double> angle_;  ///< by cell from first_: angle of the boundary inside; one more element for
                               ///< the range beyond all cells
  std::vector<double> ends_;   ///< ends of the stretches of the current walk
  std::vector<double> step_, rule_;  ///< of these stretches (nodes_of_stretches())
};

}  // namespace tubefoot
