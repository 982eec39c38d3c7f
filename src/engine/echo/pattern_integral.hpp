// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "engine/echo/edge_lanes.hpp"
#include "engine/echo/gain_panels.hpp"
#include "engine/scattering/beam_pattern.hpp"
#include "engine/scattering/facet_map.hpp"
#include "engine/scattering/pattern_levels.hpp"
#include "engine/scattering/reflectivity_field.hpp"
#include "engine/scattering/scattering_model.hpp"
#include "geometry/integrals/gauss_rules.hpp"
#include "geometry/integrals/measure.hpp"
#include "geometry/integrals/node_count.hpp"
#include "geometry/integrals/polar_slabs.hpp"

namespace tubefoot {

/// Micro-texture, and where the polygon's plane lies in its frame, the local one.
struct PlacedTexture {
  const ReflectivityField* field = nullptr;  ///< none: even
  LyingPlane plane{};
};

/// Integrates what an even seabed returns to one apex (density.hpp), times transmit and receive pattern, over
/// polygons cut by range samples.
///
/// A pattern has no symmetry about the foot point, so this is an integral over two dimensions: over slabs of
/// slant range (polar_slabs.hpp), and in each over the arcs of every circle. With q the range of the nearest
/// point of one of the slab's edges, r^2 = q^2 + t^2 makes r dr = t dt, and the ends of the arcs are analytic
/// in t even where a circle only touches an edge. Gauss-Legendre in t and in the angle; the number of nodes
/// follows from how far the integrand's singularities are and how fast the patterns can change.
///
/// Gains are not computed at nodes but read from piecewise polynomials (gain_panels.hpp). Where the beams of
/// a receiver are functions of one and the same cosine (a line array's), nodes are summed up as moments, and
/// the beams are looked at once for all footprints, in finish(). Beams sent at once along that array join
/// them. Then arcs need no nodes either where the angle is a smooth function of the cosine over them: their
/// moments are known from their ends (pattern_spans.cpp). Where it is one over all of a polygon, the law is
/// Lambert's and absorption within a sample is small, ends are followed along edges, without slabs
/// (pattern_edges.cpp).
///
/// Micro-texture is one more factor at the nodes, and one more reason for nodes; polygons with texture must
/// lie in one of its cells (texture_cells.hpp).
class PatternIntegrator {
 public:
  /// `tolerance`: about the error of an energy, relative to what the footprint would return at the patterns'
  /// peak (a table's corners, where its second derivative jumps, may exceed it). `beta_per_m`: absorption,
  /// one way.
  PatternIntegrator(std::span<const double> borders_m, double beta_per_m, const BeamPatterns& patterns,
                    double tolerance);

  /// Adds factor times the integral to energy[beam * samples + sample] for all beams that receive the tube,
  /// at the latest in finish(). `model`: by the angle that the polygon's plane is seen at; it must live until
  /// finish(). None: r^-2 instead, which is Lambert's but for a factor.
  void add(const PlanarPolygon& polygon, const FacetPlane& plane, const PlaneFrame& frame, std::uint32_t tube,
           double factor, std::span<double> energy, const ScatteringModel* model = nullptr,
           const PlacedTexture& texture = {});
  void finish(std::span<double> energy);
  /// Adds what is still waiting for finish(), and goes on.
  void settle(std::span<double> energy);

 private:
  struct Edge {
    glm::dvec2 along{0}, aside{0};  // unit: of its direction, and that turned clockwise
    double height = 0;              // p = s along + height aside
    double from = 0, to = 0;        // s
    int sample = 0;                 // where it starts
    double nearest2 = 0;            // squared range of its line's nearest point
  };
  struct Arc {
    Crossing begin, end;
  };
  struct Piece {
    double distance, distance2, q2, factor;
    bool full_circle, foot_inside;
    const ScatteringModel::Piece* model;  // none: Lambert's
  };
  /// A direction cosine over a piece, and over an arc of it: level + ahead cos + aside sin of the angle from
  /// the arc's middle.
  struct Axis {
    glm::dvec3 direction{0};
    double away = 0;
    glm::dvec2 plane{0};
    double level = 0, ahead = 0, aside = 0;
  };
  /// A gain along one of the receiver's axes.
  struct Term {
    std::size_t axis = 0;
    std::shared_ptr<GainPanels> gain;
  };
  /// How fast patterns change along a path: with their cosine, if they are of one axis and known to be smooth
  /// functions of it, else with the direction.
  struct Change {
    NodeCount count;
    std::optional<std::size_t> axis;
    bool by_angle = false;    // functions of the angle, which changes faster than the cosine off broadside
    double scale = 1;         // of the cosine, over the piece
    bool along_axis = false;  // over the piece: by its cosine
  };
  /// What beams [first, end) of a fan have in common.
  struct Receiver {
    std::uint32_t fan = 0, first = 0, end = 0;
    bool uniform = false;  // no receive pattern: one for all beams of the fan
    std::vector<Axis> axes;
    std::vector<Term> transmit;  // to be added up; none: 1, or in the moments
    std::optional<DirectionMoments> moments;
    std::size_t moments_axis = 0;
    std::vector<std::optional<Term>> receive;  // by beam, without moments; none: 1
    std::vector<CosineRange> audible;  // by beam: outside its gain is too little (BeamPatterns::least)
    std::vector<Change> changes;
  };

  /// A texture on the piece at hand.
  struct Factor {
    const ReflectivityField* field = nullptr;
    const NodeCount* count = nullptr;
    LyingPlane plane;
    glm::dvec3 ahead{0}, aside{0};  // place = foot + ahead cos + aside sin of the angle from an arc's middle
  };

  /// How fast a law changes: with the angle of incidence, and with the logarithm of range.
  struct ModelNodes {
    const ScatteringModel* model;
    NodeCount by_angle, by_range;
  };

  /// Where a polygon's edges are summed up along themselves (pattern_edges.cpp).
  struct EdgePath {
    EdgeLanes lanes;
    double nearest2 = 0;   // squared range of the polygon
    double reach = 0;      // of its cosines, from the middle
    double width = 0;      // mean of its arcs', in cosines
    double singular = 0;   // no singularity of the integrand is as near to an edge
    bool outside = false;  // of all samples
    int spare = 0;         // more nodes
    const DirectionMoments* of = nullptr;
    std::vector<std::uint32_t> panels;  // numbers, in the order of cosines
    std::vector<GainPanels::Panel> panel;
    std::vector<double> half;  // of panels
    struct Rows {
      std::uint32_t block = std::numeric_limits<std::uint32_t>::max();
      double* first = nullptr;
    };
    std::vector<Rows> rows;  // by panel
    std::size_t at = 0;      // in panels, where the last end was
    struct Cell {
      std::uint32_t sample, first;
    };
    std::vector<Cell> cells;
    EdgeNodes nodes;
  };

  /// An only arc from t0 to t1. The cosine of an end is (level + slope sqrt(t^2 + gap)) / r.
  struct Sweep {
    struct End {
      double level, slope, gap;
      std::array<double, 3> cosine;  // at t0, in the middle, at t1
    };
    std::array<End, 2> end;
    std::array<double, 3> per_r;
  };

  void take_texture(const PlacedTexture& texture);
  void face(glm::dvec2 ahead, double rho, double radius);
  Receiver& receiver_of(std::uint32_t tube);
  std::unique_ptr<Receiver> make_receiver(std::uint32_t fan, std::uint32_t first, std::uint32_t end) const;
  Term term(Receiver& receiver, std::span<const Directivity> beams) const;

  void take_axes(const PlanarPolygon& polygon, const FacetPlane& plane, const PlaneFrame& frame);
  void find_arcs(std::span<const Crossing> crossings, double t);
  glm::dvec2 point_at(const Crossing& crossing, double t2) const;
  double s_at(const Crossing& crossing, double t2) const;
  double nearest_singularity() const;
  double incidence_at(double t) const;
  void take_model(const ScatteringModel& model);
  double angle_between(glm::dvec2 begin, glm::dvec2 end) const;
  void integrate(double t0, double t1, int depth);
  int nodes_along(double t0, double t1, double rho) const;
  int nodes_of_model(double t0, double t1, double stretched_by, double rho) const;
  int nodes_along_spans(double t0, double t1, double rho);
  int nodes_of_arc(double half, double rho, double radius) const;
  void add_circle(double t, double weight);
  bool arcs_may_be_spans() const;
  bool add_spans(double t0, double t1, const GaussRule& rule);
  bool add_edges();
  bool find_edge_path();
  bool find_panels();
  int sample_of(double range2) const;
  double* row_of(std::uint32_t sample, std::size_t panel);
  void cut_edge(const Edge& edge, const Edge& next);
  void add_edge_nodes();
  void add_arc(double per_r, double rho, glm::dvec2 middle, double half, double weight);
  void add_panel(double half, double weight, const GaussRule& rule);
  bool may_be_received(std::size_t beam, double half) const;

  std::span<const double> borders_;
  double beta_, tolerance_;
  const BeamPatterns& patterns_;
  std::array<double, most_gauss_nodes + 1> least_rho_{};  // at which n nodes are enough
  std::vector<std::unique_ptr<Receiver>> receivers_;
  std::vector<std::uint32_t> receiver_of_tube_;  // + 1; 0: not asked for yet
  PolarSlabs slabs_;
  std::vector<EdgeRanges> ranges_;
  std::vector<Edge> edges_;
  std::vector<Arc> arcs_;
  std::vector<double> sum_;       // by beam of the tube
  std::uint32_t first_beam_ = 0;  // of the tube
  std::vector<std::pair<double, Crossing>> sorted_;
  Receiver* receiver_ = nullptr;
  std::vector<ModelNodes> models_;
  const ModelNodes* model_nodes_ = nullptr;  // of the law at hand
  Piece piece_{};
  bool spans_ = false;  // the slab's only arc may be added by its ends
  Sweep sweep_;
  EdgePath way_;
  std::vector<double> borders2_, absorbed_;  // squared borders; by sample: absorption in its middle
  bool little_absorption_ = false;           // within a sample
  Factor texture_;
  std::map<const ReflectivityField*, NodeCount> counts_;
};

}  // namespace tubefoot
