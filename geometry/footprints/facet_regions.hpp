// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <deque>
#include <glm/vec2.hpp>
#include <optional>

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
  bool hidden_too = false;  ///< all of the tube's share of the facet, not only what is seen
  std::vector<const PlaneLine*> lines;
  ChartBox box;
};

/// One facet and its regions.
class FacetRegions {
 public:
  /// `facet` has an area.
  FacetRegions(const FacetMesh& mesh, FacetId facet);

  /// What a look sees in a piece of one of its tubes, or has in that tube.
  void add_seen(const CoverageLook& look, std::uint32_t number, std::uint32_t tube, std::uint32_t piece);
  void add_within(const CoverageLook& look, std::uint32_t number, std::uint32_t tube);

  const LinePolygon& triangle() const { return triangle_; }
  const std::vector<FacetRegion>& regions() const { return regions_; }
  const HugeInt& double_area() const { return double_area_; }  ///< on the chart
  /// Grid units.
  glm::dvec3 in_space(glm::dvec2 corner) const;

 private:
  /// The facet as a look has it.
  struct Sight {
    std::uint32_t look = std::numeric_limits<std::uint32_t>::max();
    bool edge_on = false, out_of_range = false;
    FacetCone plane;  ///< as the mesh has it, its point[0] relative to the apex
    FacetCone seen;
    std::vector<const PlaneLine*> outer, inner;  ///< window: within these, and not within those
  };
  const Sight& sight(const CoverageLook& look, std::uint32_t number);
  std::vector<const PlaneLine*> ring(const Sight& sight, double radius, double distance2);
  void add(const Sight& sight, LinePolygon polygon, std::uint32_t ping, bool hidden_too);
  /// Edge k of a piece: nothing if it lies on an edge of the facet.
  const PlaneLine* edge(const NameContext& context, const TubeVisibility& seen, const NamedPiece& piece,
                        std::uint32_t k, const Sight& sight);

  const FacetMesh& mesh_;
  FacetId facet_;
  FacetChart chart_;
  GridPoint origin_;
  Vec64 normal_;
  LineStore store_;
  LinePolygon triangle_;
  HugeInt double_area_;
  Sight sight_;
  std::vector<FacetRegion> regions_;
};

/// Whether a facet lies inside the window of a look, seen from anywhere on it; false if that is not sure.
bool surely_in_window(const FacetMesh& mesh, FacetId facet, const CoverageLook& look);
/// Whether all of a piece's edges are edges of its facet, by name alone.
bool is_whole_facet(const FacetMesh& mesh, const TubeVisibility& seen, const NamedPiece& piece);

}  // namespace tubefoot
