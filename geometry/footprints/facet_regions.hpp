// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <deque>
#include <glm/vec2.hpp>
#include <optional>

#include "geometry/arithmetic/exact_corner.hpp"
#include "geometry/footprints/coverage.hpp"
#include "geometry/footprints/coverage_cells.hpp"
#include "geometry/footprints/line_table.hpp"
#include "geometry/footprints/plane_lines.hpp"

// Represents the parts of one facet that looks see as convex polygons in a chart of the facet. The lines of
// the polygons have exact coefficients (plane_lines.hpp). This header is expensive to compile: include it
// only in .cpp files.
namespace tubefoot {

/// A line and its number in a table, once it has one.
struct StoredLine : PlaneLine {
  mutable std::optional<DirectedLine> number = {};
};

/// Stores lines and their opposites until they are dropped.
class LineStore {
 public:
  const StoredLine* keep(PlaneLine line) {
    lines_.push_back({std::move(line), {}});
    return &lines_.back();
  }
  const StoredLine* opposite(const PlaneLine& line) { return keep(PlaneLine::of(-line.a, -line.b, -line.c)); }
  std::size_t size() const { return lines_.size(); }
  /// Drops all lines but the first ones.
  void shrink_to(std::size_t size) { lines_.resize(size); }

 private:
  std::deque<StoredLine> lines_;
};

/// Bounding box of a polygon on its chart, including rounding errors.
struct ChartBox {
  glm::dvec2 lo{std::numeric_limits<double>::infinity()}, hi{-std::numeric_limits<double>::infinity()};
  void include(glm::dvec2 point);
  bool meets(const ChartBox& o) const {
    return lo.x <= o.hi.x && o.lo.x <= hi.x && lo.y <= o.hi.y && o.lo.y <= hi.y;
  }
};
std::vector<glm::dvec2> corners_of(const LinePolygon& polygon);
ChartBox box_of(const std::vector<glm::dvec2>& corners);

/// Subtracts the common part of the half-planes from the polygon and appends the rest as convex polygons to
/// `parts`. The polygon becomes the common part. Returns false and changes nothing if there is no common
/// part.
bool split_off(LinePolygon& polygon, std::span<const PlaneLine* const> lines, LineStore& store,
               std::vector<LinePolygon>& parts);

/// One facet and the layers of its regions. Its chart is the facet's own (FacetChart). With `by_weights`, it
/// consists of the weights of the second and third corner. This is necessary if looks see the facet
/// displaced.
class FacetRegions {
 public:
  /// The facet must have an area above 0.
  FacetRegions(const FacetMesh& mesh, FacetId facet, bool by_weights);

  /// The facet or a part of it, in the seabed of one end.
  struct Aspect {
    const CoverageEnd* end = nullptr;
    FacetId facet = 0;  ///< facet of the end's seabed
    bool edge_on = false;
    FacetCone seen;                      ///< with the names of this seabed
    std::array<GridPoint, 3> corners{};  ///< relative to the apex, in the seabed's order
    ChartCorners on_chart{};             ///< positions of the corners on the chart
    LinePolygon place;                   ///< the whole part
  };
  /// The range gate of a look on a part: inside the outer lines and not inside the inner ones.
  struct Window {
    bool none = false;
    std::vector<const PlaneLine*> outer, inner;
  };

  Aspect aspect(const CoverageEnd& end, FacetId facet);
  /// `rx` is the aspect of the same part from the receiver; null for a look with one end.
  Window window(const CoverageLook& look, const Aspect& tx, const Aspect* rx);
  /// Return the polygon of a piece of a tube, and that of the whole tube.
  LinePolygon seen(const Aspect& from, std::uint32_t tube, std::uint32_t piece);
  LinePolygon within(const Aspect& from, std::uint32_t tube);
  /// Adds the part of the polygon inside the range gate to the current layer.
  void add(const Window& window, LinePolygon polygon);
  /// Ends the current layer, of which all but the border is given. A layer without polygons is left out.
  void end_layer(CoverageLayer layer);
  /// Drops the lines of all aspects, windows and polygons. Layers keep theirs.
  void drop_lines() { store_.shrink_to(own_lines_); }

  LineTable& table() { return table_; }
  const LineTable& table() const { return table_; }
  TabledPolygon triangle() { return tabled(triangle_); }
  const std::vector<CoverageLayer>& layers() const { return layers_; }
  const HugeInt& double_area() const { return double_area_; }  ///< area on the chart
  /// Returns the position in space, in grid units.
  glm::dvec3 in_space(glm::dvec2 corner) const;

 private:
  TabledPolygon tabled(const LinePolygon& polygon);
  std::vector<const PlaneLine*> lines_round(std::span<const glm::dvec3> ring, const Aspect& about);
  /// Returns the line of edge k of a piece, or null if it lies on an edge of the facet.
  const PlaneLine* edge(const NameContext& context, const TubeVisibility& seen, const NamedPiece& piece,
                        std::uint32_t k, std::span<const glm::dvec3> points, const Aspect& from);

  const FacetMesh& mesh_;
  FacetId facet_;
  bool by_weights_;
  FacetChart chart_;
  GridPoint origin_;
  Vec64 normal_;
  ChartCorners corners_{};
  LineStore store_;
  std::size_t own_lines_ = 0;  ///< lines of the facet itself, the first ones in the store
  LinePolygon triangle_;
  HugeInt double_area_;
  LineTable table_;
  LayerBorder border_;  ///< of the current layer
  bool any_polygon_ = false;
  std::vector<CoverageLayer> layers_;
};

/// Returns whether a part certainly lies inside the range gate of a look; false if this is not certain. `rx`
/// is a facet of the mesh `there`, for a look with a separate receiver.
bool surely_in_window(const CoverageLook& look, const FacetMesh& mesh, FacetId tx, const FacetMesh& there,
                      FacetId rx);
/// Returns whether all edges of a piece are edges of its facet, by their names alone.
bool is_whole_facet(const FacetMesh& mesh, const TubeVisibility& seen, const NamedPiece& piece);

}  // namespace tubefoot
