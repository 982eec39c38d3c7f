// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <functional>
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

// Integrates monostatic echoes with beam patterns over visible polygons. The integral is over slabs of slant
// range and over the arcs of circles in each slab. docs/visibility.md has the integrand.

namespace tubefoot {

/// Reflectivity texture with the position of the polygon's plane in the local frame.
struct PlacedTexture {
  const ReflectivityField* field = nullptr;  ///< null: uniform
  LyingPlane plane{};
};

/// Integrates the echo of a uniform surface to one apex (density.hpp), times transmit and receive pattern,
/// over polygons cut by range samples.
///
/// A pattern has no symmetry about the foot point, so the integral has two dimensions. It is over slabs of
/// slant range (polar_slabs.hpp), and in each slab over the arcs of every circle. Let q be the range of the
/// nearest point of one of the slab's edges. With r^2 = q^2 + t^2, r dr = t dt. The ends of the arcs are
/// then analytic in t, even if a circle touches an edge. Gauss-Legendre rules are used in t and in the
/// angle. The number of nodes depends on the distance of the integrand's singularities and on the rate at
/// which the patterns can change.
///
/// Gains are read from piecewise polynomials (gain_panels.hpp), not computed at nodes. If the beams of a
/// receiver are functions of one cosine (line array), the nodes are summed as moments. Then `finish()`
/// evaluates the beams once for all footprints. Transmit beams along the same array are included. If the
/// angle is a smooth function of the cosine over an arc, the moments follow from the ends of the arc without
/// nodes (pattern_spans.cpp). Under three conditions ends are followed along edges, without slabs
/// (pattern_edges.cpp). The angle is a smooth function of the cosine over the whole polygon, the model is
/// Lambert's law, and absorption within a sample is small.
///
/// A reflectivity texture is a further factor at the nodes and increases their number. A polygon with
/// texture must lie in one cell of the texture (texture_cells.hpp).
class PatternIntegrator {
 public:
  /// `tolerance`: approximate error of an energy, relative to the echo of the footprint at the patterns'
  /// peak. Kinks of tables, where the second derivative jumps, may exceed it. `beta_per_m`: absorption, one
  /// way.
  PatternIntegrator(std::span<const double> borders_m, double beta_per_m, const BeamPatterns& patterns,
                    double tolerance);

  /// Replaces the density of the echo by another function of range, which is smooth within each sample. Then
  /// `factor` contains all that depends on the plane, and no model is given.
  void take_density(std::function<double(double range_m)> density) { density_ = std::move(density); }

  /// Adds factor times the integral to energy[beam * samples + sample] for all beams that receive the tube,
  /// at the latest in finish(). Negative factors reduce energies. `model`: function of the angle to the
  /// polygon's plane, which must live until finish(). Null: r^-2, which is proportional to Lambert's law.
  void add(const PlanarPolygon& polygon, const FacetPlane& plane, const PlaneFrame& frame, std::uint32_t tube,
           double factor, std::span<double> energy, const ScatteringModel* model = nullptr,
           const PlacedTexture& texture = {});
  void finish(std::span<double> energy);
  /// Adds the pending contributions of finish(). More polygons may follow.
  void settle(std::span<double> energy);

 private:
  struct Edge {
    glm::dvec2 along{0}, aside{0};  // unit vectors: along the edge, and turned clockwise
    double height = 0;              // p = s along + height aside
    double from = 0, to = 0;        // range of s
    int sample = 0;                 // sample of its begin
    double nearest2 = 0;            // squared range of the nearest point of its line
  };
  struct Arc {
    Crossing begin, end;
  };
  struct Piece {
    double distance, distance2, q2, factor;
    bool full_circle, foot_inside;
    const ScatteringModel::Piece* model;  // null: Lambert's law
  };
  /// Direction cosine over a piece and over one of its arcs. It is level + ahead cos + aside sin of the
  /// angle from the middle of the arc.
  struct Axis {
    glm::dvec3 direction{0};
    double away = 0;
    glm::dvec2 plane{0};
    double level = 0, ahead = 0, aside = 0;
  };
  /// Gain along one of the receiver's axes.
  struct Term {
    std::size_t axis = 0;
    std::shared_ptr<GainPanels> gain;
  };
  /// Rate at which patterns change along a path. It refers to the cosine if the patterns have one axis and
  /// are smooth functions of its cosine. Otherwise it refers to the direction.
  struct Change {
    NodeCount count;
    std::optional<std::size_t> axis;
    bool by_angle = false;    // functions of the angle, which off broadside changes faster than the cosine
    double scale = 1;         // scale of the cosine over the piece
    bool along_axis = false;  // function of the cosine over the piece
  };
  /// Common properties of beams [first, end) of a fan.
  struct Receiver {
    std::uint32_t fan = 0, first = 0, end = 0;
    bool uniform = false;  // no receive pattern: one value for all beams of the fan
    std::vector<Axis> axes;
    std::vector<Term> transmit;  // factors at nodes; none: 1, or included in the moments
    std::optional<DirectionMoments> moments;
    std::size_t moments_axis = 0;
    std::vector<std::optional<Term>> receive;  // per beam, without moments; none: 1
    std::vector<CosineRange> audible;          // per beam: its gain is below BeamPatterns::least outside
    std::vector<Change> changes;
  };

  /// Texture on the current piece.
  struct Factor {
    const ReflectivityField* field = nullptr;
    const NodeCount* count = nullptr;
    LyingPlane plane;
    glm::dvec3 ahead{0}, aside{0};  // place = foot + ahead cos + aside sin of the angle from the middle of
                                    // an arc
  };

  /// Rates at which a model changes, with the angle of incidence and with the logarithm of range.
  struct ModelNodes {
    const ScatteringModel* model;
    NodeCount by_angle, by_range;
  };

  /// State of the integration along a polygon's edges (pattern_edges.cpp).
  struct EdgePath {
    EdgeLanes lanes;
    double nearest2 = 0;   // squared range of the polygon
    double reach = 0;      // largest distance of its cosines from the middle
    double width = 0;      // mean width of its arcs in cosines
    double singular = 0;   // lower bound of a singularity's distance from an edge
    bool outside = false;  // outside of all samples
    int spare = 0;         // number of additional nodes
    const DirectionMoments* of = nullptr;
    std::vector<std::uint32_t> panels;  // numbers in the order of cosines
    std::vector<GainPanels::Panel> panel;
    std::vector<double> half;  // of panels
    struct Rows {
      std::uint32_t block = std::numeric_limits<std::uint32_t>::max();
      double* first = nullptr;
    };
    std::vector<Rows> rows;  // per panel
    std::size_t at = 0;      // index in `panels` at the last end
    struct Cell {
      std::uint32_t sample, first;
    };
    std::vector<Cell> cells;
    EdgeNodes nodes;
  };

  /// Single arc from t0 to t1. The cosine of an end is (level + slope sqrt(t^2 + gap)) / r.
  struct Sweep {
    struct End {
      double level, slope, gap;
      std::array<double, 3> cosine;  // at t0, in the middle, at t1
    };
    std::array<End, 2> end;
    std::array<double, 3> per_r;
  };

  void take_texture(const PlacedTexture& texture);
  void face(glm::dvec2 ahead, double circle_radius_m, double radius);
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
  int nodes_of_arc(double half, double circle_radius_m, double radius) const;
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
  void add_arc(double per_r, double circle_radius_m, glm::dvec2 middle, double half, double weight);
  void add_panel(double half, double weight, const GaussRule& rule);
  bool may_be_received(std::size_t beam, double half) const;

  std::span<const double> borders_;
  double beta_, tolerance_;
  const BeamPatterns& patterns_;
  std::function<double(double range_m)> density_;         // none: that of the echo
  std::array<double, most_gauss_nodes + 1> least_rho_{};  // smallest rho for which n nodes suffice
  std::vector<std::unique_ptr<Receiver>> receivers_;
  std::vector<std::uint32_t> receiver_of_tube_;  // index + 1; 0: not yet determined
  PolarSlabs slabs_;
  std::vector<EdgeRanges> ranges_;
  std::vector<Edge> edges_;
  std::vector<Arc> arcs_;
  std::vector<double> sum_;       // per beam of the tube
  std::uint32_t first_beam_ = 0;  // first beam of the tube
  std::vector<std::pair<double, Crossing>> sorted_;
  Receiver* receiver_ = nullptr;
  std::vector<ModelNodes> models_;
  const ModelNodes* model_nodes_ = nullptr;  // nodes of the current model
  Piece piece_{};
  bool spans_ = false;  // the slab's single arc may be added by its ends
  Sweep sweep_;
  EdgePath way_;
  std::vector<double> borders2_, absorbed_;  // squared borders; absorption in the middle of each sample
  bool little_absorption_ = false;           // within a sample
  bool has_negative_factor_ = false;         // of a polygon since the last finish()
  Factor texture_;
  std::map<const ReflectivityField*, NodeCount> counts_;
};

}  // namespace tubefoot
