// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "geometry/integrals/certified_path_cells.hpp"

namespace tubefoot {

/// A place in the coordinates of a polygon, about the foot point of its apex.
template <class N>
struct PlanePlace {
  N x, y;
};

/// What is integrated over a polygon: values by place, in balls.
class CertifiedIntegrand {
 public:
  virtual ~CertifiedIntegrand() = default;

  virtual std::size_t values() const = 0;
  /// The value that tells how large a value is, which itself may cancel.
  virtual std::size_t size_of(std::size_t value) const { return value; }
  /// Values cannot be negative.
  virtual bool positive() const { return true; }
  /// About how far one may go from a place until it is no longer smooth. A guess, which guides the work.
  virtual double scale_m(const PlanePlace<Ball>& place) const = 0;

  /// Encloses all values over a ball of places, which may be as large as a polygon.
  virtual void at(const PlanePlace<Ball>& place, std::vector<Ball>& values) const = 0;
  /// The same in intervals of doubles; false if there is none.
  virtual bool at(const PlanePlace<Interval>&, std::vector<Interval>&) const { return false; }

  /// What it is in all of a box: from then on at() and log_bounds() are of a function that is analytic there,
  /// and differ from the true one by a factor whose logarithm is at most off[value]. False if there is none.
  virtual bool take(const PlanePlace<Ball>& box, std::vector<double>& off) = 0;
  /// at() is again what holds everywhere.
  virtual void take_whole() = 0;
  /// Upper bounds of log |value| over a rectangle of complex places, of what was taken; infinite where it is
  /// not analytic.
  virtual void log_bounds(const PlanePlace<ComplexBall>& place, std::vector<double>& bounds) const = 0;
};

/// Encloses the integral of values over a polygon's part in each sample of path length
/// (certified_path_cells). docs/reference.md says how.
///
/// In a cell the integrand is analytic in t and in v, X = near + v (far - near). Gauss-Legendre in both errs
/// as CertifiedIntegrator's does; cells are halved until the error fits, and what is left at the work limit,
/// and the gaps, are enclosed by area times the integrand's range.
class CertifiedPathIntegrator {
 public:
  /// How far off a sample's part may be: relative to what a part has, and besides, by value and sample.
  struct Allowance {
    double relative = 0;
    std::function<double(std::size_t value, std::size_t sample)> absolute;
  };
  using Taker = std::function<void(std::size_t sample, std::span<const Ball> values)>;
  using IntervalTaker = std::function<void(std::size_t sample, std::span<const Interval> values)>;

  explicit CertifiedPathIntegrator(std::span<const double> half_path_borders_m)
      : cutter_(half_path_borders_m) {}

  /// With `ambiguous`, of a part of the polygon that is not known, but for its area.
  void add(const CertifiedPolygon& polygon, const ApexOverPlane& out, std::span<const ApexOverPlane> homes,
           CertifiedIntegrand& integrand, const Allowance& allowance, const Taker& take,
           const std::optional<Ball>& ambiguous = {});
  void add(const CertifiedPolygon& polygon, const ApexOverPlane& out, std::span<const ApexOverPlane> homes,
           CertifiedIntegrand& integrand, const Allowance& allowance, const IntervalTaker& take,
           const std::optional<Ball>& ambiguous = {});

  /// Cells that were left at the work limit, so far.
  std::size_t given_up() const { return given_up_; }

 private:
  struct Box {
    Ball from, to;  // of t
    double v_from = 0, v_to = 1;
    int depth = 0;
  };
  /// X dX of dt dv, and the place.
  template <class N>
  struct Element {
    N area;
    PlanePlace<N> place;
  };
  template <class N>
  Element<N> element(const N& near, const N& far, const N& t, const N& v) const;
  template <class N>
  Element<N> over(const Box& box) const;

  /// Parameter of an ellipse and nodes of the rule that it allows; by value, bounds in it.
  struct Choice {
    int nodes = 0;
    double rho = 0;
    std::vector<double> log_m;
  };
  template <class Evaluate>
  Choice choose(double first_rho, double size, const std::vector<double>& log_allowed,
                const Evaluate& evaluate);

  /// What became of a box. Doubles may not tell enough.
  enum class Outcome { done, too_wide, unknown };

  void integrate(const CertifiedPathCutter::Cell& cell);
  /// In balls where doubles do not do.
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

  // The cell at hand, in balls and in doubles.
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
  // Of the cell at hand.
  CertifiedIntegrand* integrand_ = nullptr;
  const RayFrame* frame_ = nullptr;
  const CertifiedPathCutter::Cell* cell_ = nullptr;
  IntervalFrame own_frame_;
  IntervalCurve near_, far_;
  bool in_doubles_ = true;  // the integrand can tell its values in doubles
  bool in_balls_ = false;   // some part of the cell is in sum_
  double relative_ = 0;
  std::vector<double> most_;     // by value: of all the polygon
  double largest_area_ = 0;      // no part of it has more
  std::vector<double> allowed_;  // by value, for the whole cell
  std::vector<Ball> sum_, values_;
  std::vector<Interval> sum_in_doubles_, values_in_doubles_;
  std::vector<Box> work_;
  bool split_v_ = false;  // which way the box that failed last should be halved
};

}  // namespace tubefoot
