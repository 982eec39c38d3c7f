// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

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

/// Integrates over convex polygons cut by samples of path length, transmitter and separate receiver.
///
/// Points of a plane with the same path transmitter - point - receiver lie on an ellipse (the plane cuts a
/// spheroid whose foci are the apexes). All these ellipses hold the plane's point of shortest path, c, and
/// the path grows along every ray from c. So in polar coordinates about c a polygon's part in a sample is a
/// few cells { angle in an interval, distance between two curves }, each curve an edge or an ellipse, both in
/// closed form; the intervals end at corners and where an edge crosses an ellipse, a quadratic equation.
/// Cells count only what is in them, so nothing is a difference of large parts. In each, Gauss-Legendre in
/// angle and distance: rules of rising order until two agree, else the cell is halved.
///
/// With a second receiver, the parts are cut that lie in the same sample of both. Its ellipses have a focus
/// in common with those of the first: two of them meet on a straight line (docs/sensors.md). A ray from c
/// meets each of them in one stretch, which begins at c but for ellipses so small that c is outside. Where
/// the second way has a transmitter of its own, ellipses meet where a search along the first one finds it
/// (docs/signals.md).
///
/// Law P1 (ellipses): the samples of a plane are differences of ellipses, in closed form.
/// Law P2 (whole): the samples of a polygon add up to the integral over it, needles included.
/// Law P3 (shares): each sample has of a polygon what lies in it.
class PathCutter {
 public:
  /// Where the receiver is: distance from the polygon's plane, and foot point in its coordinates (those of
  /// PlanarPolygon: the transmitter's foot point is their origin).
  struct Receiver {
    double distance = 0;
    glm::dvec2 foot{0};
  };
  /// Another way whose samples are to be cut with those of the first: its sample k holds half paths from
  /// `later_m` beyond the borders of the first one's. Its transmitter need not be that of the first.
  struct SecondRange {
    Receiver transmit, receive;
    double later_m = 0;
  };
  /// Fills values of the integrand at a point of the plane, given its distances from transmitter and
  /// receiver. values[0] must not be negative: errors are measured by it.
  using Integrand = std::function<void(glm::dvec2 point, double transmit_range, double receive_range,
                                       std::span<double> values)>;
  struct Work {
    std::size_t values = 1;  ///< how many values the integrand has
    /// An angle as seen from either apex over which the integrand is smooth; at most 1 is used.
    double resolution_rad = 1;
    /// That holds from the second receiver, too, which may be nearer than both.
    bool from_second = false;
    /// Two rules agree if they differ by less than this, relative to values[0] of the cell.
    double tolerance = 1e-10;
    /// Halvings of a cell for the sake of the tolerance; after these it is taken as it is.
    int most_refinements = 30;
    /// How many rules in a row must agree with the one before. Across a corner of the integrand two may by
    /// chance.
    int agreements = 1;
    /// The integrand is analytic, and over half of `resolution_rad` into the complex plane at most some e^3
    /// times what it is here: where parts are small, the order of a rule follows from their size, and one is
    /// enough (CompactPathCutter).
    bool analytic = false;
  };

  /// Sample k holds half paths, (transmit range + receive range) / 2, of borders_m[k] .. borders_m[k+1].
  explicit PathCutter(std::span<const double> half_path_borders_m);
  ~PathCutter();
  PathCutter(PathCutter&&) noexcept;

  /// Adds the integral of value i over polygon and sample k to out[k * work.values + i]. Both apexes must be
  /// off the plane, on the same side of it.
  void add(const PlanarPolygon& polygon, const Receiver& receiver, const Integrand& integrand,
           const Work& work, std::span<double> out) {
    add(polygon, std::span(&receiver, 1), integrand, work, out);
  }
  /// One or two receivers: sample k holds what both of them receive in sample k. `receive_range` is that of
  /// the first one.
  void add(const PlanarPolygon& polygon, std::span<const Receiver> receivers, const Integrand& integrand,
           const Work& work, std::span<double> out);
  /// Sample k holds what lies in sample k of both ways.
  void add(const PlanarPolygon& polygon, const Receiver& receiver, const SecondRange& second,
           const Integrand& integrand, const Work& work, std::span<double> out);

  /// The shortest and the longest half path by way of a point of the polygon, both apexes off the plane and
  /// on the same side of it.
  static std::pair<double, double> half_paths_of(const PlanarPolygon& polygon, const Receiver& receiver);
  /// Samples that the polygon may reach into: [first, second).
  std::pair<std::size_t, std::size_t> samples_of(const PlanarPolygon& polygon,
                                                 const Receiver& receiver) const;

  /// Where all that is p + y d of a plane has the path P to two apexes: a y^2 + 2 b y + c = 0. With
  /// r_t^2 = A + 2 B y + y^2 and r_r alike, 4 P^2 r_t^2 = (P^2 + r_t^2 - r_r^2)^2 is quadratic in y.
  struct EllipseOnRay {
    double a, b, c;
    /// `rt`, `rr`: ranges of p; `bt`, `br`: d times the ways to p from the apexes' foot points.
    EllipseOnRay(double path, double rt, double rr, double bt, double br) {
      const double path2 = path * path, difference = (rt - rr) * (rt + rr), slope = bt - br;
      a = 4 * (path2 - slope * slope);
      b = 4 * path2 * bt - 2 * (path2 + difference) * slope;
      c = -(path - rt - rr) * (path - rt + rr) * (path + rt - rr) * (path + rt + rr);
    }
    double discriminant() const { return b * b - a * c; }
  };

 private:
  /// An edge, about c. What lies on its left is inside.
  struct Line {
    glm::dvec2 from, to, along;  // neighbours share their corner to the last bit
    double length, height;       // of c to its left
    double least, most;          // distances of its points from c
    double along_of(glm::dvec2 direction) const;
  };
  struct Sector {
    glm::dvec2 middle;
    double half;
    const Line* far;
    const Line* near;  // none: from c on
  };
  /// Distance from c in a direction: on a line, or where the whole path is `path`, or 0. A ray leaves the
  /// second receiver's ellipse there, or enters it.
  struct Curve {
    const Line* line = nullptr;
    double path = 0;
    bool second = false, enters = false;
  };
  /// An apex over the plane; its foot point about c.
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
    double from = 0, to = 1;            // of the way between the curves
    int halvings = 0, refinements = 0;  // to be small enough; to be accurate enough
  };

  /// How large a cell is, as seen from the nearer apex: along arcs about c and along rays from it.
  struct Extent {
    double arc = 0, ray = 0;
    bool steep = false;  ///< an edge that all but runs towards c makes the distances differ too much
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
  // Of the polygon at hand.
  const Integrand* integrand_ = nullptr;
  Work work_{};
  std::span<double> out_;
  glm::dvec2 c_{0};  // in the polygon's coordinates
  Apex transmit_, receive_;
  std::optional<Apex> second_;
  Apex second_transmit_;            // the first one's, or another
  bool common_transmitter_ = true;  // of both ways
  double second_later_ = 0;         // of its paths
  double second_transmit_range_ = 0;
  double transmit_range_ = 0, receive_range_ = 0;  // of c
  double shortest_ = 0;                            // path, at c
  double second_shortest_ = 0;                     // to the second receiver
  std::vector<Line> lines_;
  std::vector<Sector> sectors_;
  std::vector<double> angles_, values_;
  int refinements_left_ = 0;                    // of a whole cell, as there may be
  double largest_part_ = 0;                     // of a whole cell, so far
  std::unique_ptr<CompactPathCutter> compact_;  // made when first asked for
  std::vector<PlanarPolygon> not_compact_;
};

}  // namespace tubefoot
