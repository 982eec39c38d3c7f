// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "geometry/integrals/certified_path_cells.hpp"

// Encloses integrals of bistatic densities over polygons, split by half path length. Each cell between two
// ellipses of equal path length is integrated by Gauss-Legendre quadrature in two variables. The error bound
// is that of L. N. Trefethen (Approximation Theory and Approximation Practice, theorem 19.3), for each
// variable separately.
namespace tubefoot {

/// A point in the coordinates of a polygon, relative to the foot point of its apex.
template <class N>
struct PlanePlace {
  N x, y;
};

/// Integrand over a polygon: one or more values per point, in balls.
class CertifiedIntegrand {
 public:
  virtual ~CertifiedIntegrand() = default;

  virtual std::size_t values() const = 0;
  /// Index of the value that determines the size of a value. A value itself may be small by cancellation.
  virtual std::size_t size_of(std::size_t value) const { return value; }
  /// Returns whether all values are non-negative.
  virtual bool positive() const { return true; }
  /// Estimates the distance from a point over which the integrand is smooth. It only guides the work.
  virtual double scale_m(const PlanePlace<Ball>& place) const = 0;

  /// Encloses all values over a ball of points, which may be as large as a polygon.
  virtual void at(const PlanePlace<Ball>& place, std::vector<Ball>& values) const = 0;
  /// Does the same in intervals of doubles. Returns false if this is not available.
  virtual bool at(const PlanePlace<Interval>&, std::vector<Interval>&) const { return false; }

  /// Chooses a function that is analytic in the whole box. Until the next call, at() and log_bounds() refer
  /// to this function. It differs from the true one by a factor whose logarithm is at most off[value].
  /// Returns false if there is no such function.
  virtual bool take(const PlanePlace<Ball>& box, std::vector<double>& off) = 0;
  /// Lets at() enclose the true integrand everywhere again.
  virtual void take_whole() = 0;
  /// Upper bounds of log |value| over a rectangle of complex points, for the chosen function. Infinite where
  /// it is not analytic.
  virtual void log_bounds(const PlanePlace<ComplexBall>& place, std::vector<double>& bounds) const = 0;
};

/// Encloses the integral of values over a polygon's part in each sample of path length
/// (certified_path_cells). docs/notes/certified-energies.md describes the method.
///
/// In a cell the integrand is analytic in t and in v, with X = near + v (far - near). Gauss-Legendre
/// quadrature in each variable has the error of CertifiedIntegrator's rule. Cells are halved until the error
/// is within the allowance. Cells that remain at the work limit, and gaps, are enclosed by the area times
/// the range of the integrand.
class CertifiedPathIntegrator {
 public:
  /// Permitted error of a sample's part: relative to the part's value, plus an absolute error by value and
  /// sample.
  struct Allowance {
    double relative = 0;
    std::function<double(std::size_t value, std::size_t sample)> absolute;
  };
  using Taker = std::function<void(std::size_t sample, std::span<const Ball> values)>;
  using IntervalTaker = std::function<void(std::size_t sample, std::span<const Interval> values)>;

  explicit CertifiedPathIntegrator(std::span<const double> half_path_borders_m)
      : cutter_(half_path_borders_m) {}

  /// Integrates a polygon. With `ambiguous`, only the area of an unknown part of the polygon is given, and
  /// the integral over this part is enclosed.
  void add(const CertifiedPolygon& polygon, const ApexOverPlane& out, std::span<const ApexOverPlane> homes,
           CertifiedIntegrand& integrand, const Allowance& allowance, const Taker& take,
           const std::optional<Ball>& ambiguous = {});
  void add(const CertifiedPolygon& polygon, const ApexOverPlane& out, std::span<const ApexOverPlane> homes,
           CertifiedIntegrand& integrand, const Allowance& allowance, const IntervalTaker& take,
           const std::optional<Ball>& ambiguous = {});

  /// Number of cells that were left at the work limit.
  std::size_t given_up() const { return given_up_; }

 private:
  struct Box {
    Ball from, to;  // interval of t
    double v_from = 0, v_to = 1;
    int depth = 0;
  };
  /// X dX for dt dv, and the point.
  template <class N>
  struct Element {
    N area;
    PlanePlace<N> place;
  };
  template <class N>
  Element<N> element(const N& near, const N& far, const N& t, const N& v) const;
  template <class N>
  Element<N> over(const Box& box) const;

  /// Parameter of an ellipse, number of nodes that it permits, and bounds in the ellipse by value.
  struct Choice {
    int nodes = 0;
    double rho = 0;
    std::vector<double> log_m;
  };
  template <class Evaluate>
  Choice choose(double first_rho, double size, const std::vector<double>& log_allowed,
                const Evaluate& evaluate);

  /// Result of a box. `unknown`: doubles are not accurate enough.
  enum class Outcome { done, too_wide, unknown };

  void integrate(const CertifiedPathCutter::Cell& cell);
  /// Tries doubles first, then balls.
  bool try_box(const Box& box);
  template <class N>
  Outcome try_box_in(const Box& box);
  template <class N>
  Outcome try_rules(const Box& box, const std::vector<double>& off);
  template <class N>
  Outcome try_range(const Box& box, const Element<N>& all, bool at_any_width);
  template <class N>
  bool sum_nodes(const Box& box, int nodes_t, int nodes_v, std::vector<N>& sum);
  bool evaluate(const PlanePlace<Ball>& place, std::vector<Ball>& values) const {
    integrand_->at(place, values);
    return true;
  }
  bool evaluate(const PlanePlace<Interval>& place, std::vector<Interval>& values) const {
    return integrand_->at(place, values);
  }
  void halve(const Box& box);
  Ball whole_of(const Box& box) const { return (box.to - box.from) * Ball(box.v_to - box.v_from); }

  // Curves and frame of the current cell, in balls and in doubles.
  Ball near_at(const Ball& t) const { return cell_->near.at(t); }
  Ball far_at(const Ball& t) const { return cell_->far.at(t); }
  Interval near_at(const Interval& t) const { return near_.at(t); }
  Interval far_at(const Interval& t) const { return far_.at(t); }
  const RayFrame& frame_in(const Ball&) const { return *frame_; }
  const IntervalFrame& frame_in(const Interval&) const { return own_frame_; }
  template <class N>
  std::vector<N>& values_in();
  void add_to_sum(std::size_t value, const Ball& part) {
    sum_[value] += part;
    in_balls_ = true;
  }
  void add_to_sum(std::size_t value, const Interval& part) { sum_in_doubles_[value] += part; }

  CertifiedPathCutter cutter_;
  std::size_t given_up_ = 0;
  // Members of the current cell.
  CertifiedIntegrand* integrand_ = nullptr;
  const RayFrame* frame_ = nullptr;
  const CertifiedPathCutter::Cell* cell_ = nullptr;
  IntervalFrame own_frame_;
  IntervalCurve near_, far_;
  bool in_doubles_ = true;  // the integrand has values in doubles
  bool in_balls_ = false;   // some part of the cell is in sum_
  double relative_ = 0;
  std::vector<double> most_;     // largest modulus over the whole polygon, by value
  double largest_area_ = 0;      // upper bound of the area of any part
  std::vector<double> allowed_;  // by value, for the whole cell
  std::vector<Ball> sum_, values_;
  std::vector<Interval> sum_in_doubles_, values_in_doubles_;
  std::vector<Box> work_;
  bool split_v_ = false;  // direction in which the box that failed last should be halved
};

}  // namespace tubefoot
