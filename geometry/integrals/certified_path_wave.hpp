// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

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

// EdgeForm's integral of any wave that is reported by the length of its path, in balls: a pulse with its
// flanks, not one frequency after the other. Heavy: include only in .cpp files and headers of integrators.
namespace tubefoot {

/// F(P): on each stretch of paths a sum of exponentials of quadratics, 0 before the first and beyond the
/// last.
struct PathWave {
  struct Term {
    ComplexBall factor, linear, square;  ///< factor e^{x (linear + square x)}, x = P - origin
  };
  struct Stretch {
    Ball from, to;
    std::vector<Term> terms;
  };
  Ball origin;
  std::vector<Stretch> stretches;  ///< of increasing paths, each from where the one before ends
  double largest = 0;              ///< of the modulus
  /// Of its change by P; infinite where the wave jumps.
  double steepest = std::numeric_limits<double>::infinity();

  ComplexBall on(const Stretch& stretch, const ComplexBall& path) const;
  /// Of all stretches that the path may lie in.
  ComplexBall at(const Ball& path) const;
};

/// A convex polygon's edges, for any number of waves.
class CertifiedPathEdges {
 public:
  /// `points` about the foot point of the apex of the transmit leg, which is `height` above the plane,
  /// positive as that of the receive leg.
  CertifiedPathEdges(std::span<const CertifiedPolygon::Point> points, const Ball& height,
                     const ApexOverPlane& rx);

  /// Bounds of the paths over places of the polygon.
  double shortest_path() const { return shortest_path_; }
  double longest_path() const { return longest_path_; }

  /// (1 / 4 pi) closed integral of [(2 / D) F(D) - w F(P)] dpsi, D the shortest path over the plane: with F =
  /// e^{ikP} what certified_edge_form() has. `allowed`: of each edge's quadrature; what the radius has beyond
  /// it comes from the corners, and from ends of stretches that meet the place of shortest path.
  ComplexBall integral(const PathWave& wave, double allowed);

 private:
  /// A directed edge, t from 0 to 1, places told from that of shortest path.
  struct Edge {
    Ball from_x, from_y, step_x, step_y;
    Ball angle;                 ///< turn times cross(from, step) / 4 pi
    Ball tx_square, rx_square;  ///< of ranges, at t = 0
    Ball tx_slope, rx_slope;    ///< of those squares
    Ball length_square;
  };
  /// What an edge's integrands are made of at a place: with N a ball or a complex one.
  template <class N>
  struct Place {
    N path;      ///< P
    N product;   ///< of both ranges
    N across;    ///< D^2 less the square of their difference
    N distance;  ///< squared, from the line through the ends' images
  };
  template <class N>
  Place<N> place(const Edge& edge, const N& t) const;
  /// w dpsi/dt.
  template <class N>
  N weight(const Edge& edge, const Place<N>& p) const;

  /// A part of an edge, with what its rules need of it.
  struct Panel {
    Ball middle, half;
    struct Ellipse {
      ComplexBall path;
      double log_weight;  ///< infinite where it is not analytic
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

  /// Parts of an edge on which the wave is one stretch (null: none), and gaps between them.
  struct Part {
    double from, to;
    const PathWave::Stretch* stretch;
    bool gap;
  };
  std::vector<Part> parts_of(const Edge& edge, const PathWave& wave) const;
  /// Adds enclosures of all t at which the path is so long.
  void add_crossings(const Edge& edge, const Ball& path, std::vector<std::pair<double, double>>& at) const;

  /// Less w F dpsi over a part of one stretch. `kept`: of parts that all waves share.
  ComplexBall far(std::size_t edge, const PathWave& wave, const PathWave::Stretch& stretch, double from,
                  double to, double allowed, int halvings, bool kept);
  /// All of the integrand over a part.
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
