// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "engine/gradient/scene_motion.hpp"
#include "geometry/numbers/interval.hpp"
#include "geometry/numbers/scalars.hpp"
#include "geometry/visibility/visibility.hpp"

namespace tubefoot {

/// Proves that the named polygons of one tube are the visible ones for all values of a parameter in an
/// interval. The proof has four parts (docs/notes/gradients.md, section 6):
///   1. By their names alone, the borders of all polygons and of the unobstructed region add up to the border
///      of the tube.
///      Polygons of one facet whose union is convex are then merged.
///   2. Each polygon is convex, in the sense of the tube, and in front of the apex.
///   3. Each polygon lies in the cone of its facet.
///   4. A plane separates each polygon from the part of each other facet that is nearer than its own facet.
/// By 1 and 2, the polygons cover each direction of the tube once. By 3 and 4, each shows the nearest facet.
/// A predicate is enclosed by its value in the middle of the interval and by its derivative in all of it. If
/// the enclosure contains 0, the predicate is 0 only by its names, or if it vanishes identically.
class VisibilityCertificate {
 public:
  /// `seen`: the tube with its unobstructed region, by an exact arithmetic. `vertex_speed`: largest
  /// SceneMotion::reach of a vertex for the step 1. The arguments must outlive this object.
  VisibilityCertificate(const NameContext& context, const TubeVisibility& seen, const SceneTree& tree,
                        double reach, const SceneMotion& motion, double vertex_speed);

  /// Returns whether the proof succeeds for the values from `from` to `to`.
  bool holds(double from, double to);

 private:
  using Slow = NamedVectors<MovingBall>;
  using Quick = NamedVectors<MovingInterval>;
  using Exact = NamedVectors<ExactNumber>;
  enum class Sign { negative = -1, zero = 0, positive = 1, unknown = 2 };
  using Key = std::array<std::uint32_t, 12>;

  struct Edge {
    PlaneName plane;
    int sign = 1;  ///< of the plane's normal, towards the polygon
  };
  struct Polygon {
    FacetId facet = none;  ///< none: unobstructed
    std::vector<CornerName> corners;
    std::vector<Edge> edges;                        ///< edge k joins corner k and corner k + 1
    std::map<FacetId, std::uint32_t> separated_by;  ///< the test that succeeded last
  };
  /// A corner of the near part of a facet: a near vertex, or the point of an edge on the plane of another
  /// facet. That edge leads from a near vertex to a far one.
  struct NearCorner {
    VertexId vertex, far = no_point;
    FacetId plane = none;
    bool may_be_far = false;  ///< the vertex too, so that the point may not exist
  };
  /// Bounds of a polygon or facet in the interval: the tangents of the angles across the tube, and the depth
  /// along its axis.
  struct ChartBox {
    Interval x{infinite, -infinite}, y = x, depth = x;
    bool is_in_front = true;

    void add(const Interval& right, const Interval& up, const Interval& ahead, const Interval& at_depth) {
      is_in_front = is_in_front && ahead.surely_positive();
      x = hull(x, right / ahead);
      y = hull(y, up / ahead);
      depth = hull(depth, at_depth);
    }
    /// Returns whether no direction meets both, or whether this box is behind the other one.
    bool is_beside_or_behind(const ChartBox& other) const {
      return is_in_front && (x.lo > other.x.hi || x.hi < other.x.lo || y.lo > other.y.hi ||
                             y.hi < other.y.lo || depth.lo > other.depth.hi);
    }
  };
  static constexpr FacetId none = 0xffffffffu;

  bool add_polygon(const TubeVisibility& seen, const NamedPiece& piece, bool is_open);
  bool borders_add_up();
  void merge_polygons();
  bool merge(Polygon& one, const Polygon& other);
  const std::vector<FacetId>& facets_that_may_hide(double from, double to);
  bool is_proper(const Polygon& polygon);
  bool is_in_facet(const Polygon& polygon);
  ChartBox box_of(const Polygon& polygon);
  ChartBox box_of(FacetId facet);
  bool is_separate(Polygon& polygon, FacetId facet);

  template <class Value>
  Ball enclosure_of(const Value& value);
  template <class Value>
  Sign sign_of(const Key& key, const Value& value);
  /// Returns whether value(vectors in all of the interval, vectors in its middle) is certainly positive.
  template <class Value>
  bool is_positive(const Value& value);
  template <class Value>
  bool vanishes(const Key& key, const Value& value);
  Sign side(const PlaneName& plane, PointId point);
  Sign side(const PlaneName& plane, const CornerName& corner);
  Sign side(const PlaneName& plane, const NearCorner& corner);
  Sign side_of_doubtful(const PlaneName& plane, const NearCorner& corner);
  Sign nearer(FacetId facet, VertexId vertex);
  Sign orientation(FacetId facet);
  PlaneName edge_of(FacetId facet, int k, int& sign) const;
  Exact& exact(int sample);

  const NameContext& context_;
  const SceneTree& tree_;
  double reach_;
  const SceneMotion& motion_;
  double vertex_speed_;
  std::array<glm::dvec3, 4> rays_;
  std::array<PlaneName, 4> walls_;
  bool is_certain_ = true;  ///< whether part 1 of the proof succeeded
  /// Facets that may hide something for the values of an interval. Each interval contains the next one.
  struct MayHide {
    double from, to;
    std::vector<FacetId> facets;
  };
  std::vector<MayHide> may_hide_;
  std::vector<Polygon> polygons_;
  std::optional<Slow> middle_, all_;  ///< in the middle of the current interval, and in all of it
  std::optional<Quick> quick_middle_, quick_all_;
  std::array<glm::dvec3, 3> chart_;            ///< two directions across the tube and one along it
  Ball half_;                                  ///< half the length of the interval
  std::vector<std::unique_ptr<Exact>> exact_;  ///< by sample
  std::map<Key, bool> vanishes_;
  std::map<Key, Sign> constant_;
  std::map<Key, Sign> signs_;  ///< in the current interval
};

}  // namespace tubefoot
