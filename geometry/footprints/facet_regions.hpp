// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <deque>
#include <glm/vec2.hpp>
#include <optional>

#include "geometry/arithmetic/exact_corner.hpp"
#include "geometry/footprints/coverage.hpp"
#include "geometry/footprints/plane_lines.hpp"

// What looks see of one facet as convex polygons in the facet's own coordinates. Heavy: include only in .cpp
// files.
namespace tubefoot {

/// Lines that live as long as this, with their opposites.
class LineStore {
 public:
  const PlaneLine* keep(PlaneLine line) {
    lines_.push_back(std::move(line));
    return &lines_.back();
  }
  const PlaneLine* opposite(const PlaneLine& line) { return keep(PlaneLine::of(-line.a, -line.b, -line.c)); }

 private:
  std::deque<PlaneLine> lines_;
};

/// Where a polygon lies on its chart, rounding included.
struct ChartBox {
  glm::dvec2 lo{std::numeric_limits<double>::infinity()}, hi{-std::numeric_limits<double>::infinity()};
  void include(glm::dvec2 point);
  bool meets(const ChartBox& o) const {
    return lo.x <= o.hi.x && o.lo.x <= hi.x && lo.y <= o.hi.y && o.lo.y <= hi.y;
  }
};
std::vector<glm::dvec2> corners_of(const LinePolygon& polygon);
ChartBox box_of(const std::vector<glm::dvec2>& corners);

/// The polygon without the half-planes' common part, as convex polygons appended to `parts`; it is left as
/// that common part. False, and nothing is changed, if there is none.
bool split_off(LinePolygon& polygon, std::span<const PlaneLine* const> lines, LineStore& store,
               std::vector<LinePolygon>& parts);

/// A convex part of a facet: inside these lines, those of the facet's own edges left out.
struct FacetRegion {
  std::uint32_t ping = 0, look = 0;
  std::array<FacetId, 2> parts{};  ///< of the seabeds of the look's ends
  bool hidden_too = false;         ///< all of the tube's share of the facet, not only what is seen
  std::vector<const PlaneLine*> lines;
  ChartBox box;
};

/// One facet and its regions. Its chart is the facet's own (FacetChart), or, where looks have seabeds of
/// their own, that of the weights of its second and third corner.
class FacetRegions {
 public:
  /// `facet` has an area.
  FacetRegions(const FacetMesh& mesh, FacetId facet, bool by_weights);

  /// The facet, or a part of it, as an end has it.
  struct Aspect {
    const CoverageEnd* end = nullptr;
    FacetId facet = 0;  ///< of the end's seabed
    bool edge_on = false;
    FacetCone seen;                      ///< under its names
    std::array<GridPoint, 3> corners{};  ///< relative to the apex, in the seabed's order
    ChartCorners on_chart{};             ///< where they lie
    LinePolygon place;                   ///< all of the part
  };
  /// What of a part lies in a look's window: within the outer lines, and not within the inner ones.
  struct Window {
    bool none = false;
    std::vector<const PlaneLine*> outer, inner;
  };

  Aspect aspect(const CoverageEnd& end, FacetId facet);
  /// `rx`: of the same part; null with one end.
  Window window(const CoverageLook& look, const Aspect& tx, const Aspect* rx);
  /// What a piece of a tube covers, and what all of a tube has.
  LinePolygon seen(const Aspect& from, std::uint32_t tube, std::uint32_t piece);
  LinePolygon within(const Aspect& from, std::uint32_t tube);
  /// What is inside of a window, of a look of that number.
  void add(const Window& window, LinePolygon polygon, const FacetRegion& what);

  const LinePolygon& triangle() const { return triangle_; }
  const std::vector<FacetRegion>& regions() const { return regions_; }
  const HugeInt& double_area() const { return double_area_; }  ///< on the chart
  /// Grid units.
  glm::dvec3 in_space(glm::dvec2 corner) const;

 private:
  std::vector<const PlaneLine*> lines_round(std::span<const glm::dvec3> ring, const Aspect& about);
  /// Edge k of a piece: nothing if it lies on an edge of the facet.
  const PlaneLine* edge(const NameContext& context, const TubeVisibility& seen, const NamedPiece& piece,
                        std::uint32_t k, const Aspect& from);

  const FacetMesh& mesh_;
  FacetId facet_;
  bool by_weights_;
  FacetChart chart_;
  GridPoint origin_;
  Vec64 normal_;
  ChartCorners corners_{};
  LineStore store_;
  LinePolygon triangle_;
  HugeInt double_area_;
  std::vector<FacetRegion> regions_;
};

/// Whether a part lies inside the window of a look, seen from anywhere on it; false if that is not sure.
/// `rx`: of `there`, where the look has another end.
bool surely_in_window(const CoverageLook& look, const FacetMesh& mesh, FacetId tx, const FacetMesh& there,
                      FacetId rx);
/// Whether all of a piece's edges are edges of its facet, by name alone.
bool is_whole_facet(const FacetMesh& mesh, const TubeVisibility& seen, const NamedPiece& piece);

}  // namespace tubefoot
