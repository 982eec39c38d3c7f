// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <glm/vec2.hpp>
#include <optional>
#include <span>
#include <vector>

#include "geometry/footprints/line_table.hpp"

// Represents the union of convex polygons on one facet by its border. Edges that two polygons share cancel,
// so the beams of a ping become one region. This header is expensive to compile: include it only in .cpp
// files.
namespace tubefoot {

/// A convex polygon on a table of lines. Edge k runs along line k, from corner k to the next one.
struct TabledPolygon {
  std::vector<DirectedLine> lines;
  std::vector<LineCorner> corners;
};

/// A point strictly inside a polygon, with exact coordinates.
class InnerPoint {
 public:
  InnerPoint(const LineTable& table, const TabledPolygon& polygon);

  /// Returns the side of a line on which the point lies: 1, 0 or -1.
  int side(const LineTable& table, LineId line) const;
  /// Returns whether a corner has a larger coordinate u: 1, 0 or -1.
  int compare_u(const LineTable& table, const LineCorner& corner) const;
  glm::dvec2 near() const { return near_; }
  bool is_near_exact() const { return near_exact_; }

 private:
  int exact_side(const LineTable& table, LineId line) const;
  void take_near();

  glm::dvec2 near_{0};
  bool near_exact_ = true;  ///< whether the exact point equals near_
  mutable bool known_ = false;
  mutable Integer x_, y_, w_;  ///< the point is (x / w, y / w), w > 0; computed when first needed
};

/// An edge of a border, in the direction of its line. Towards the side where the line is positive, the number
/// of polygons rises by `rise`.
struct BorderEdge {
  LineId line = 0;
  LineCorner from, to;
  int rise = 0;
};

class LayerBorder {
 public:
  /// Adds a polygon. Polygons may overlap.
  void add(const TabledPolygon& polygon);
  /// Cancels shared edges. No polygon may be added afterwards.
  void finish(const LineTable& table);
  std::span<const BorderEdge> edges() const { return edges_; }
  /// Returns whether a point lies in one polygon or more. The point must not lie on an edge.
  bool contains(const LineTable& table, const InnerPoint& point) const;

 private:
  void make_bins();
  void count(const LineTable& table, const InnerPoint& point, const BorderEdge& edge, int& polygons) const;

  std::vector<BorderEdge> edges_;
  double first_u_ = 0, bins_per_u_ = 0;
  std::vector<std::uint32_t> bin_start_, in_bin_;  ///< edges by their coordinates u
};

}  // namespace tubefoot
