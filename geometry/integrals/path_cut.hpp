// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Integrates a function over convex polygons that are cut by samples of path length. The path leads from a
// transmitter via the polygon to one or two receivers. Points of equal path length lie on ellipses about the
// plane's point of shortest path.

#include <cstddef>
#include <functional>
#include <glm/vec2.hpp>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "geometry/integrals/measure.hpp"

namespace tubefoot {

class CompactPathCutter;

/// Integrates over convex polygons that are cut by samples of path length, for a transmitter and a separate
/// receiver.
///
/// Points of a plane with the same path transmitter - point - receiver lie on an ellipse. The ellipse is the
/// section of a spheroid whose foci are the apexes. All these ellipses contain the plane's point of shortest
/// path, c, and the path grows along every ray from c. In polar coordinates about c a sample of a polygon is
/// a few cells { angle in an interval, distance between two curves }. Each curve is an edge or an ellipse,
/// both in closed form. The intervals end at corners and where an edge crosses an ellipse, a quadratic
/// equation. A cell counts only its own content, so no result is a difference of large parts. In each cell
/// the order of a Gauss-Legendre rule in angle and distance rises until two rules agree; otherwise the cell
/// is halved.
///
/// With a second receiver the cut parts lie in the same sample of both receivers. The ellipses of both have
/// a focus in common, so that two of them meet on a straight line (docs/sensors.md). A ray from c meets each
/// ellipse of the second receiver in one stretch. That stretch begins at c, except for ellipses so small
/// that c is outside. If the second path has its own transmitter, a search along the first ellipse finds the
/// intersections (docs/notes/signals.md).
///
/// Law P1 (ellipses): the samples of a plane are differences of ellipses, in closed form.
/// Law P2 (whole): the samples of a polygon add up to the integral over it, needles included.
/// Law P3 (shares): each sample contains the part of a polygon that lies in it.
class PathCutter {
 public:
  /// Position of the receiver: its distance from the polygon's plane, and its foot point. The origin of the
  /// coordinates is the transmitter's foot point, as in PlanarPolygon.
  struct Receiver {
    double distance = 0;
    glm::dvec2 foot{0};
  };
  /// A second path whose samples are cut together with those of the first. Its sample k contains half paths
  /// from `later_m` beyond the borders of the first path. Its transmitter may differ from the first one.
  struct SecondRange {
    Receiver transmit, receive;
    double later_m = 0;
  };
  /// Fills values of the integrand at a point of the plane, from its distances to transmitter and receiver.
  /// Errors are relative to values[0], which must not be negative.
  using Integrand = std::function<void(glm::dvec2 point, double transmit_range, double receive_range,
                                       std::span<double> values)>;
  struct Work {
    std::size_t values = 1;  ///< number of values of the integrand
    /// Angle, as seen from either apex, over which the integrand is smooth; at most 1 is used.
    double resolution_rad = 1;
    /// True if `resolution_rad` also holds from the second receiver, which may be nearer than both apexes.
    bool from_second = false;
    /// Two rules agree if they differ by less than this, relative to values[0] of the cell.
    double tolerance = 1e-10;
    /// Limit of the halvings of a cell for the tolerance. After that many the last result counts.
    int most_refinements = 30;
    /// Number of consecutive rules that must agree with their predecessors. Across a corner of the integrand
    /// two rules may agree by chance.
    int agreements = 1;
    /// True if the integrand is analytic, and at most e^3 times its value over half of `resolution_rad` into
    /// the complex plane. For small parts the order of a single rule then follows from their size
    /// (CompactPathCutter).
    bool analytic = false;
  };

  /// Limit of the refinements of a polygon. It is reached only if the rounding estimate was too small.
  static constexpr int most_refined_cells = 4000;

  /// Sample k contains half paths, (transmit range + receive range) / 2, from borders_m[k] to
  /// borders_m[k+1].
  explicit PathCutter(std::span<const double> half_path_borders_m);
  ~PathCutter();
  PathCutter(PathCutter&&) noexcept;

  /// Adds the integral of value i over polygon and sample k to out[k * work.values + i]. Both apexes must be
  /// off the plane and on the same side of it.
  void add(const PlanarPolygon& polygon, const Receiver& receiver, const Integrand& integrand,
           const Work& work, std::span<double> out) {
    add(polygon, std::span(&receiver, 1), integrand, work, out);
  }
  /// The same for one or two receivers. Sample k contains the points that both receive in sample k.
  /// `receive_range` is that of the first receiver.
  void add(const PlanarPolygon& polygon, std::span<const Receiver> receivers, const Integrand& integrand,
           const Work& work, std::span<double> out);
  /// The same for two paths. Sample k contains the points that lie in sample k of both paths.
  void add(const PlanarPolygon& polygon, const Receiver& receiver, const SecondRange& second,
           const Integrand& integrand, const Work& work, std::span<double> out);

  /// The shortest and the longest half path via a point of the polygon. Both apexes must be off the plane
  /// and on the same side of it.
  static std::pair<double, double> half_paths_of(const PlanarPolygon& polygon, const Receiver& receiver);
  /// Samples that the polygon may reach: [first, second).
  std::pair<std::size_t, std::size_t> samples_of(const PlanarPolygon& polygon,
                                                 const Receiver& receiver) const;

  /// Points p + y d of a plane whose path to two apexes is P: a y^2 + 2 b y + c = 0. With r_t^2 = A + 2 B y
  /// + y^2 and the same form for r_r^2,
  ///   4 P^2 r_t^2 = (P^2 + r_t^2 - r_r^2)^2
  /// is quadratic in y.
  struct EllipseOnRay {
    double a, b, c;
    /// `rt`, `rr`: ranges of p. `bt`, `br`: scalar products of d with the vectors from the apexes' foot
    /// points to p.
    EllipseOnRay(double path, double rt, double rr, double bt, double br) {
      const double path2 = path * path, difference = (rt - rr) * (rt + rr), slope = bt - br;
      a = 4 * (path2 - slope * slope);
      b = 4 * path2 * bt - 2 * (path2 + difference) * slope;
      c = -(path - rt - rr) * (path - rt + rr) * (path + rt - rr) * (path + rt + rr);
    }
    double discriminant() const { return b * b - a * c; }
  };

 private:
  /// An edge, relative to c. The interior is on its left.
  struct Line {
    glm::dvec2 from, to, along;  // neighbours share their corner to the last bit
    double length, height;       // height: of c to its left
    double least, most;          // distances of its points from c
    double along_of(glm::dvec2 direction) const;
  };
  struct Sector {
    glm::dvec2 middle;
    double half;
    const Line* far;
    const Line* near;  // null: the sector starts at c
  };
  /// Distance from c in a direction: to a line, to the curve on which the whole path is `path`, or 0. For an
  /// ellipse of the second receiver, `enters` says whether the ray enters or leaves it.
  struct Curve {
    const Line* line = nullptr;
    double path = 0;
    bool second = false, enters = false;
  };
  /// An apex over the plane, with its foot point relative to c.
  struct Apex {
    double height = 0;
    glm::dvec2 foot{0};
    double range(glm::dvec2 from_c) const;
  };
  struct Stretch {
    double enter = 0, leave = 0;
  };
  struct Cell {
    glm::dvec2 middle;
    double half;
    double from = 0, to = 1;            // fraction of the distance between the curves
    int halvings = 0, refinements = 0;  // halvings for size; halvings for accuracy
  };

  /// Size of a cell as seen from the nearer apex: along arcs about c and along rays from c.
  struct Extent {
    double arc = 0, ray = 0;
    bool steep = false;  ///< the distances differ too much because an edge runs nearly towards c
  };

  void add(const PlanarPolygon& polygon, const Receiver& receiver, const Integrand& integrand,
           const Work& work, std::span<double> out, const SecondRange* second);
  void add_polar(const PlanarPolygon& polygon, const Receiver& receiver, const SecondRange* second);
  void find_sectors(const PlanarPolygon& polygon);
  void integrate(const Sector& sector);
  double path_of(const Line& line, double along) const;
  double shortest_path(const Line& line, double from, double to) const;
  void add_crossings(const Line& line, double path, const Apex& transmit, const Apex& receive,
                     const Sector& sector, std::vector<double>& angles) const;
  void add_meetings(double first_path, double second_path, const Sector& sector,
                    std::vector<double>& angles) const;
  void add_meetings_found(double first_path, double second_path, const Sector& sector,
                          std::vector<double>& angles) const;
  void add_tangents(double second_path, const Sector& sector, std::vector<double>& angles) const;
  std::optional<Stretch> in_second(double path, glm::dvec2 direction) const;
  double distance(const Curve& curve, glm::dvec2 direction) const;
  void integrate_both(const Curve& near, const Curve& far, double from, double to, const Cell& cell,
                      std::span<double> out);
  void integrate_whole(const Curve& near, const Curve& far, const Cell& cell, std::span<double> out);
  void integrate(const Curve& near, const Curve& far, const Cell& cell, std::span<double> out);
  Extent extent_of(const Curve& near, const Curve& far, const Cell& cell) const;
  double tensor(const Curve& near, const Curve& far, const Cell& cell, int angles, int distances,
                std::vector<double>& sum);

  std::span<const double> borders_;
  // State of the current polygon.
  const Integrand* integrand_ = nullptr;
  Work work_{};
  std::span<double> out_;
  glm::dvec2 c_{0};  // in the polygon's coordinates
  Apex transmit_, receive_;
  std::optional<Apex> second_;
  Apex second_transmit_;            // the transmitter of the second path
  bool common_transmitter_ = true;  // true if both paths have the same transmitter
  double second_later_ = 0;         // offset of the second path's borders
  double second_transmit_range_ = 0;
  double transmit_range_ = 0, receive_range_ = 0;  // ranges of c
  double shortest_ = 0;                            // shortest path, at c
  double second_shortest_ = 0;                     // shortest path to the second receiver
  std::vector<Line> lines_;
  std::vector<Sector> sectors_;
  std::vector<double> angles_, values_;
  int refinements_left_ = 0;                    // remaining refinements of a whole cell
  double largest_part_ = 0;                     // largest part of a whole cell so far
  std::unique_ptr<CompactPathCutter> compact_;  // constructed at first use
  std::vector<PlanarPolygon> not_compact_;
};

}  // namespace tubefoot
