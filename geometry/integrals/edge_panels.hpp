// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <vector>

#include "geometry/integrals/path_cut.hpp"

namespace tubefoot {

/// The integral of edge_form.hpp for an F that is analytic only piece by piece, such as a pulse with flanks.
/// It equals image() F(shortest_m()) plus, for each panel, the integral of F(path) times a weight along the
/// edge. The path is monotonic along a panel. A caller that knows the paths of kinks or jumps of F can cut
/// panels there.
class EdgePanels {
 public:
  /// A part of an edge. Positions along it are in metres from the point nearest to the point of shortest
  /// path.
  struct Panel {
    std::size_t edge = 0;
    double from = 0, to = 0;
    double from_path_m = 0, to_path_m = 0;

    double least_path_m() const { return from_path_m < to_path_m ? from_path_m : to_path_m; }
    double most_path_m() const { return from_path_m < to_path_m ? to_path_m : from_path_m; }
  };
  /// A node of a quadrature rule: F(path) times the weight.
  struct Node {
    double path_m, weight;
    double at;  ///< position on the panel
  };

  /// `growth_per_m`: the pieces of F are at most e^{growth |Im path|} times a constant. `most_spread_m`
  /// limits the range of paths in a panel. An apex in the plane yields no panels. The polygon need not be
  /// convex.
  void assign(const PlanarPolygon& polygon, const PathCutter::Receiver& rx, double growth_per_m,
              double most_spread_m);

  const std::vector<Panel>& panels() const { return panels_; }
  /// Number of the corner of the polygon at which a panel's edge begins.
  std::size_t corner_of(const Panel& panel) const { return edges_[panel.edge].corner; }
  /// Shortest path via the plane.
  double shortest_m() const { return shortest_m_; }
  /// 1 / shortest_m() if the point of shortest path lies in the polygon, half of it on an edge, 0 elsewhere.
  double image() const { return image_; }

  /// Position on a panel at which the path is `path_m`, which must be a path of the panel.
  double place_of(const Panel& panel, double path_m) const;
  /// Appends the nodes of Gauss-Legendre rules between two positions of a panel. `turn_rad` is the phase of
  /// F, beyond the growth, over half of the paths between. `error` is that of the integral, relative to the
  /// largest |F| times the integral of |weight|.
  void nodes(const Panel& panel, double from, double to, double turn_rad, double error,
             std::vector<Node>& out) const;

 private:
  /// The line of an edge, relative to the point of shortest path.
  struct Edge {
    double height;        ///< signed distance
    double tx_at, rx_at;  ///< positions of the apexes' foot points along the line
    double tx_m, rx_m;    ///< distances of the apexes from the line
    double tilt_along, tilt_beside;
    std::size_t corner;  ///< at which the edge begins
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
