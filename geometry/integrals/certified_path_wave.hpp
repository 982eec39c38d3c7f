// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Computes the integral of EdgeForm in ball arithmetic for any wave that is a function of path length. The
// wave may be a pulse with flanks; one evaluation then replaces the sum over frequencies. This header is
// expensive to compile; include it only in .cpp files and in headers of integrators.

#include <array>
#include <limits>
#include <map>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "geometry/integrals/certified_path_cells.hpp"
#include "geometry/integrals/certified_polygon.hpp"
#include "geometry/numbers/ball.hpp"

namespace tubefoot {

/// F(P). On each stretch of paths F is a sum of exponentials of quadratics. F is 0 before the first stretch
/// and after the last.
struct PathWave {
  struct Term {
    ComplexBall factor, linear, square;  ///< factor e^{x (linear + square x)} with x = P - origin
  };
  struct Stretch {
    Ball from, to;
    std::vector<Term> terms;
  };
  Ball origin;
  std::vector<Stretch> stretches;  ///< in ascending order of path; each starts at the end of the previous
                                   ///< one
  double largest = 0;              ///< upper bound of |F|
  /// Upper bound of |dF/dP|; infinite where the wave jumps.
  double steepest = std::numeric_limits<double>::infinity();

  ComplexBall on(const Stretch& stretch, const ComplexBall& path) const;
  /// Hull of F over all stretches in which the path may lie.
  ComplexBall at(const Ball& path) const;
};

/// The edges of a convex polygon, for any number of waves.
class CertifiedPathEdges {
 public:
  /// `points` are relative to the foot point of the transmitter. `height` is the transmitter's distance from
  /// the plane; both heights are positive.
  CertifiedPathEdges(std::span<const CertifiedPolygon::Point> points, const Ball& height,
                     const ApexOverPlane& rx);

  /// Bounds of the paths over all points of the polygon.
  double shortest_path() const { return shortest_path_; }
  double longest_path() const { return longest_path_; }

  /// (1 / 4 pi) times the closed integral of [(2 / D) F(D) - w F(P)] dpsi, with the shortest path D over the
  /// plane. For F = e^{ikP} the result is that of certified_edge_form(). `allowed` bounds the quadrature
  /// error of each edge. The radius beyond it comes from the corners and from stretches that end at the
  /// point of shortest path.
  ComplexBall integral(const PathWave& wave, double allowed);

 private:
  /// A directed edge with t from 0 to 1. Points are relative to the point of shortest path.
  struct Edge {
    Ball from_x, from_y, step_x, step_y;
    Ball angle;                 ///< turn times cross(from, step) / 4 pi
    Ball tx_square, rx_square;  ///< squared ranges at t = 0
    Ball tx_slope, rx_slope;    ///< slopes of the squared ranges
    Ball length_square;
  };
  /// The terms of an edge's integrands at one point. N is a real or a complex ball.
  template <class N>
  struct Place {
    N path;      ///< P
    N product;   ///< product of both ranges
    N across;    ///< D^2 less the squared difference of the ranges
    N distance;  ///< squared distance from the line through the images of both ends
  };
  template <class N>
  Place<N> place(const Edge& edge, const N& t) const;
  /// w dpsi/dt.
  template <class N>
  N weight(const Edge& edge, const Place<N>& p) const;

  /// A part of an edge with cached values for its quadrature rules.
  struct Panel {
    Ball middle, half;
    struct Ellipse {
      ComplexBall path;
      double log_weight;  ///< infinite where the weight is not analytic
    };
    struct Node {
      Ball path, weight;
    };
    static constexpr std::array<double, 5> rhos{2.5, 4.0, 7.0, 13.0, 30.0};
    std::array<std::optional<Ellipse>, rhos.size()> ellipse;
    std::map<int, std::vector<Node>> nodes;
  };
  Panel panel(double from, double to) const;
  const Panel::Ellipse& ellipse(const Edge& edge, Panel& panel, std::size_t which) const;
  const std::vector<Panel::Node>& nodes(const Edge& edge, Panel& panel, int count) const;

  /// A part of an edge on which the wave has one stretch (null: F is 0), or a gap between such parts.
  struct Part {
    double from, to;
    const PathWave::Stretch* stretch;
    bool gap;
  };
  std::vector<Part> parts_of(const Edge& edge, const PathWave& wave) const;
  /// Appends enclosures of all t at which the edge has this path.
  void add_crossings(const Edge& edge, const Ball& path, std::vector<std::pair<double, double>>& at) const;

  /// Minus the integral of w F dpsi over a part with one stretch. `kept` caches the panel; use it for parts
  /// that all waves share.
  ComplexBall far(std::size_t edge, const PathWave& wave, const PathWave::Stretch& stretch, double from,
                  double to, double allowed, int halvings, bool kept);
  /// The integral of the full integrand over a part.
  ComplexBall near(const Edge& edge, const PathWave& wave, const ComplexBall& at_shortest,
                   const PathWave::Stretch* of_shortest, const Part& part, double allowed) const;
  ComplexBall rest(const Edge& edge, const PathWave& wave, double from, double to) const;

  Ball shortest_;  ///< D
  Ball tx_x_, tx_y_, slope_x_, slope_y_;
  std::vector<Edge> edges_;
  std::vector<std::map<std::pair<double, double>, Panel>> panels_;  ///< by edge
  bool near_ = false, inside_ = false;
  double shortest_path_ = 0, longest_path_ = 0;
};

}  // namespace tubefoot
