// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "geometry/integrals/measure.hpp"
#include "geometry/integrals/range_lanes.hpp"

namespace tubefoot {

/// Integrals of a function of range over planar polygons cut by range samples.
///
/// On a plane at distance D from the apex let rho, phi be polar coordinates about the foot point. Then
/// r^2 = D^2 + rho^2, so that r dr = rho drho, and an area element is r dr dphi. With
///     F_k(r) = integral of g(s) s ds from r_k to r (clamped to the sample r_k .. r_k+1)
/// the integral of g(r) dA over polygon and sample k is, by Green's theorem, the integral of F_k(r(phi)) dphi
/// along the polygon's boundary. Boundary beyond the sample counts with F_k(r_k+1) times its angle, boundary
/// nearer than the sample not at all: the arcs in which polygon and sample meet never have to be built.
///
/// This class is F: prepared once for a set of range samples and a g, it serves any number of polygons.
class RadialIntegral {
 public:
  /// A range interval on which g(s) s is a polynomial to rounding. A sample is one cell or several.
  struct Cell {
    double lo = 0, hi = 0;  ///< range, metres
    double middle = 0, per_half = 0;
    int degree = 0;
    std::size_t sample = 0;
    std::array<double, 13> primitive{};  ///< of g(s) s ds, in x = (s - middle) * per_half
    double whole = 0;                    ///< its integral over all of the cell
  };

  /// The integrals within a cell from one range on, prepared for many upper ends.
  class From {
   public:
    From() = default;
    From(const Cell& cell, double from_m);
    /// Integrals of g(s) s ds over lengths from there, each as if alone. Relative accuracy holds for short
    /// lengths too: the primitive's divided difference is evaluated, not a difference of its values. `Real`:
    /// a double, or a vector of them.
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
    std::array<double, 12> quotient_{};  ///< of (P(x) - P(x0)) / (x - x0), P being the primitive
  };

  /// Ranges below this one are left out, because g is often singular at the apex.
  static constexpr double nearest_range_m = 1e-9;

  /// `borders_m`: sample k is borders_m[k] .. borders_m[k+1]; increasing, not negative, finite, at least two.
  /// `g`: finite and smooth on the samples. Cells are split until an interpolant of degree 11 holds g to
  /// about 1e-15. Throws std::invalid_argument for borders that break these rules or a g that is not finite
  /// or that no splitting makes smooth.
  /// `corners_m`: increasing ranges at which cells end, as derivatives of g may jump there or be infinite;
  /// next to one of them a cell of 1e-10 of its range is taken as it is. `roundings`: how many its values
  /// carry.
  RadialIntegral(std::span<const double> borders_m, const std::function<double(double)>& g,
                 std::span<const double> corners_m = {}, double roundings = 1);

  std::size_t samples() const { return samples_; }
  const std::vector<Cell>& cells() const { return cells_; }
  /// From a cell's near end on.
  const From& from_front(std::size_t cell) const { return from_front_[cell]; }
  /// The same by number, cell after cell, for loops over several cells: near and far ends, and what From has.
  const double* lows() const { return lane(0); }
  const double* highs() const { return lane(1); }
  CellsOfStretches cells_from(std::size_t cell, std::size_t count) const;

  double front() const { return cells_.front().lo; }
  double back() const { return cells_.back().hi; }

  /// The cell that holds a range; the first one for anything nearer, cells().size() for anything beyond.
  std::size_t cell_at(double range_m) const;

  /// Integral of g(s) s ds from `from_m` to `from_m + length_m` inside a cell.
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

/// Cuts polygons by the range samples of a RadialIntegral. Holds scratch memory: one per thread.
/// Law R1 (Green): out[k] is the integral of g over polygon and sample k.
/// Law R2 (whole): the samples of a polygon add up to the integral over it.
/// Law R3 (polygons add up): the parts of a polygon have together, sample by sample, what it has.
/// Law R4 (samples add up): so have the parts of a sample.
/// Law R5 (digits): small polygons far away keep their digits.
class RangeCutter {
 public:
  explicit RangeCutter(const RadialIntegral& radial);

  /// Adds factor * (integral of g dA over polygon and sample k) to out[k], for every sample.
  /// `corners_m`: a polygon on `plane`, relative to the apex, turning as pieces do (footprint.hpp): the other
  /// turn gives the negative. It need not be convex. `out` holds radial.samples() numbers. Returns the
  /// samples that it has added to; it leaves the others alone.
  SampleSpan add(std::span<const glm::dvec3> corners_m, const FacetPlane& plane, double factor,
                 std::span<double> out);

  /// The same for a polygon in its plane's coordinates.
  SampleSpan add(const PlanarPolygon& polygon, double factor, std::span<double> out);

 private:
  struct Edge;
  void walk(const Edge& edge);
  void walk_outwards(const Edge& edge, double from, double to);
  void integrate_along(const Edge& edge, double direction, std::size_t first_cell, std::size_t count);
  void integrate(const Edge& edge, std::size_t cell, double from, double to);

  const RadialIntegral& radial_;
  PlanarPolygon polygon_;
  NearestPoint nearest_;
  glm::dvec2 nearest_from_foot_{0};
  std::size_t first_ = 0, last_ = 0;   ///< cells that hold the polygon's nearest and farthest points
  RadialIntegral::From from_nearest_;  ///< the first cell from the polygon's nearest range on
  std::vector<double> inside_;  ///< by cell from first_: integral of F dphi over the boundary inside the cell
  std::vector<double>
      angle_;  ///< by cell from first_: angle of the boundary inside; one more for beyond all cells
  std::vector<double> ends_;         ///< of the walk at hand: its stretches, one from each to the next
  std::vector<double> step_, rule_;  ///< of these stretches (nodes_of_stretches())
};

}  // namespace tubefoot
