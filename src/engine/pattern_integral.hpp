// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/beam_pattern.hpp"
#include "engine/gauss_rules.hpp"
#include "geometry/measure.hpp"
#include "geometry/polar_slabs.hpp"

namespace tubefoot {

/// Integrates r^-6 e^(-beta r) times transmit and receive pattern over polygons cut by range samples.
///
/// A pattern has no symmetry about the foot point, so this is an integral over two dimensions: over slabs of
/// slant range (polar_slabs.hpp), and in each over the arcs of every circle. With q the range of the nearest
/// point of one of the slab's edges, r^2 = q^2 + t^2 makes r dr = t dt, and the ends of the arcs are analytic
/// in t even where a circle only touches an edge. Gauss-Legendre in t and in the angle; the number of nodes
/// follows from how far the integrand's singularities are and how fast the patterns can change (error below
/// about 1e-11 of the patterns' peak, but for a table's own corners).
class PatternIntegrator {
 public:
  PatternIntegrator(std::span<const double> borders_m, double beta_per_m, const BeamPatterns& patterns);

  /// Adds factor times the integral to energy[beam * samples + sample] for all beams that hear the tube.
  void add(const PlanarPolygon& polygon, const FacetPlane& plane, const PlaneFrame& frame, std::uint32_t tube,
           double factor, std::span<double> energy);

 private:
  struct Edge {
    double angle = 0;         // of its direction in the plane
    double height = 0;        // p = s along + height (along turned clockwise)
    double from = 0, to = 0;  // s of start and end
    double nearest2 = 0;      // squared range of its line's nearest point
  };
  struct Arc {
    Crossing begin, end;
    double turns = 0;  // whole turns that make end - begin the arc
  };
  struct Piece {
    double distance, distance2, q2;
    bool full_circle;
    std::uint32_t tube;
  };

  /// Half extents of directions up to which n nodes are enough, by n - 1, and how fast the patterns grow.
  struct Smoothness {
    std::array<double, most_gauss_nodes> extent{};
    const TransmitPattern* transmit = nullptr;
    const Directivity* receive = nullptr;
    double growth(double y) const { return transmit->beams[0].growth(y) + receive->growth(y); }
  };
  Smoothness smoothness_of(const TransmitPattern& transmit, const Directivity& receive) const;

  void find_arcs(std::span<const Crossing> crossings, double t, bool foot_inside);
  double angle_at(const Crossing& crossing, double t2) const;
  double s_at(const Crossing& crossing, double t2) const;
  double nearest_singularity() const;
  void integrate(double t0, double t1, int depth);
  void choose_nodes_of_arcs(double half, double radius);
  void add_circle(double t, double weight);
  void add_arc(double r, double rho, double middle, double half, double weight);

  std::span<const double> borders_;
  double beta_;
  const BeamPatterns& patterns_;
  std::vector<Smoothness> smoothness_;  // by beam
  PolarSlabs slabs_;
  std::vector<EdgeRanges> ranges_;
  std::vector<Edge> edges_;
  std::vector<Arc> arcs_;
  std::vector<double> sum_;  // by beam of the tube
  std::vector<std::pair<double, Crossing>> sorted_;
  const PlaneFrame* frame_ = nullptr;
  glm::dvec3 down_{0};  // from the apex to the foot point
  Piece piece_{};
  const Smoothness* smooth_ = nullptr;
  int panels_ = 1;  // of an arc, each with the rule
  const GaussRule* arc_rule_ = nullptr;
};

}  // namespace tubefoot
