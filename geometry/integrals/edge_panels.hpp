// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <vector>

#include "geometry/integrals/path_cut.hpp"

namespace tubefoot {

/// The integral of edge_form.hpp for an F that is analytic only piece by piece, as a pulse with flanks is: it
/// is
///     image() F(shortest_m()) + sum over panels of the integral of F(path) times a weight along the edge.
/// Along a panel the path grows or falls all the way, so whoever knows at which paths F bends or jumps can
/// cut panels there.
class EdgePanels {
 public:
  /// A part of an edge. Places along it are metres from the point that is nearest to the place of shortest
  /// path.
  struct Panel {
    std::size_t edge = 0;
    double from = 0, to = 0;
    double from_path_m = 0, to_path_m = 0;

    double least_path_m() const { return from_path_m < to_path_m ? from_path_m : to_path_m; }
    double most_path_m() const { return from_path_m < to_path_m ? to_path_m : from_path_m; }
  };
  /// Of a rule: F(path) counts with the weight.
  struct Node {
    double path_m, weight;
  };

  /// `growth_per_m`: F's pieces are no larger than some e^{growth |Im path|}. `most_spread_m`: of the paths
  /// of a panel. An apex in the plane sees it from the edge: there is nothing then. The polygon need not be
  /// convex.
  void assign(const PlanarPolygon& polygon, const PathCutter::Receiver& rx, double growth_per_m,
              double most_spread_m);

  const std::vector<Panel>& panels() const { return panels_; }
  /// The shortest path by the plane.
  double shortest_m() const { return shortest_m_; }
  /// One over it where the place of shortest path lies in the polygon, 0 elsewhere; on an edge, half.
  double image() const { return image_; }

  /// Where on a panel the path has that length, which is one of the panel's.
  double place_of(const Panel& panel, double path_m) const;
  /// Appends the nodes of Gauss-Legendre's rules from place to place on a panel. `turn_rad`: by
  /// how much more than the growth F's phase turns over half of the paths between. `error`: of the integral,
  /// relative to F's largest modulus times the integral of the weight's.
  void nodes(const Panel& panel, double from, double to, double turn_rad, double error,
             std::vector<Node>& out) const;

 private:
  /// A line with an edge on it, about the place of shortest path.
  struct Edge {
    double height;        ///< signed distance
    double tx_at, rx_at;  ///< the apexes' feet along it
    double tx_m, rx_m;    ///< the apexes' distances from the line
    double tilt_along, tilt_beside;
  };
  double path_at(const Edge& edge, double at) const;
  void add_nodes(const Edge& edge, double from, double to, double growth_per_m, double log_error,
                 int halvings, std::vector<Node>& out) const;
  void add_panels(std::size_t edge, double from, double to, double most_spread_m, int halvings);

  double growth_per_m_ = 0, shortest_m_ = 0, turn_ = 0, image_ = 0;
  std::vector<Edge> edges_;
  std::vector<Panel> panels_;
};

}  // namespace tubefoot
