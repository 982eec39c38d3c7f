// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string_view>
#include <utility>
#include <vector>

#include "geometry/mesh/facet_mesh.hpp"
#include "geometry/mesh/names.hpp"
#include "geometry/search/scene_tree.hpp"
#include "geometry/tubes/tube.hpp"

// Computes the part of each facet that a tube meets first, exactly, as convex pieces whose corners are named
// by planes. Facets nearer to the apex are subtracted from each candidate facet, with exact signs of
// determinants (docs/notes/visibility.md).
namespace tubefoot {

/// Number types of the algorithm. The first three always give the same visible regions. Their division into
/// pieces may differ, as it does with facets_per_split.
enum class Arithmetic { fixed, filtered, rational, plain_double };

/// Returns the arithmetic of a name as in scene files and --arithmetic ("double" for plain_double). Throws
/// std::invalid_argument.
Arithmetic arithmetic_from_name(std::string_view name);
std::string_view name_of(Arithmetic arithmetic);

struct VisibilityOptions {
  Arithmetic arithmetic = Arithmetic::fixed;
  /// For plain_double only: values within this bound, relative to their factors, count as zero.
  double tolerance = 0;
  /// A facet that more facets than this number may hide is split before they are subtracted. This affects
  /// only the division into pieces and the computing time, not the visible region.
  std::uint32_t facets_per_split = 64;
  /// Whether to compute the unobstructed region of each tube too, which no facet covers.
  bool open_water = false;
  /// Whether footprints keep the names of their corners (FootprintSet::corner_names).
  bool corner_names = false;
};

/// A convex cone of directions: corners [first, first + count) in TubeVisibility::corners, in the sense of
/// rotation of a tube's rays.
struct NamedPiece {
  FacetId facet = 0;
  std::uint32_t first = 0, count = 0;
};

/// The visible pieces of one tube.
struct TubeVisibility {
  std::vector<CornerName> corners;
  std::vector<NamedPiece> pieces;  ///< sorted by facet
  std::vector<NamedPiece> open;    ///< the unobstructed region (facet is undefined), if requested
  /// Pairs (facet, facet that hides a part of it), sorted, unique.
  std::vector<std::pair<FacetId, FacetId>> occluders;
  /// Rays to which the names refer: ray r is rays[r & ~ray_bit]. The first four are the tube's own.
  std::vector<GridPoint> rays;
  /// Number of facets that subtend something within the pyramid of the run. It is stored with the first tube
  /// of a run, and is 0 for the others.
  std::size_t candidates = 0;

  void clear();
};

/// Buffers that one thread reuses from tube to tube, so that repeated calls allocate nothing.
class VisibilityScratch {
 public:
  VisibilityScratch();
  ~VisibilityScratch();
  VisibilityScratch(VisibilityScratch&&) noexcept;
  struct State;
  State& state() { return *state_; }

 private:
  std::unique_ptr<State> state_;
};

/// Finds the visible pieces of tube `tube` of `tubes`. `out` is overwritten. With an exact arithmetic these
/// laws hold.
///
/// Law V1 (nearest): a direction lies in a piece of the facet that its ray meets first, or in the
/// unobstructed region.
///
/// Law V2 (arithmetics): every exact arithmetic gives the same regions of the same facets.
///
/// Law V3 (order): the result does not depend on the order of facets or of a facet's vertices. It does not
/// depend on the ids of vertices or on whether facets share vertices.
///
/// Law V4 (translation): moving scene and apex by a grid vector does not change the result.
///
/// Law V5 (similarity): scaling the scene about the apex does not change the result. An exchange of the axes
/// does not change it either, except at ties.
///
/// Law V6 (tubes add up): the visible regions of the parts of a tube add up to that of the tube.
///
/// Law V7 (facets add up): the visible regions of the parts of a facet add up to that of the facet.
///
/// Law V8 (inner splitting): facets_per_split changes the division into pieces, not the region that they
/// cover.
///
/// Law V9 (monotone): an additional facet makes no hidden region visible.
///
/// Law V10 (walls): nothing is visible behind a surface that covers the tube.
///
/// Law V11 (reach): facets wholly beyond the reach are not visible and hide nothing.
void see(const FacetMesh& mesh, const SceneTree& tree, const TubeSet& tubes, std::uint32_t tube,
         const VisibilityOptions& options, VisibilityScratch& scratch, TubeVisibility& out);

/// Tubes [first, end) of a set.
struct TubeRun {
  std::uint32_t first = 0, end = 0;
};

/// Returns the set's tubes as runs of neighbours, in order. Each tube of a run shares a wall with the
/// previous one or overlaps it. The result depends on the set alone.
std::vector<TubeRun> runs_of(const TubeSet& tubes);

/// Computes the tubes of a run together, and calls `take(tube)` in turn when `out` is the result of that
/// tube. The visible pieces are computed once in a pyramid that contains the tubes, and then divided by the
/// walls of the tubes.
///
/// Law V12 (runs): the visible and unobstructed regions of a tube do not depend on the run. Their division
/// into pieces may.
void see_run(const FacetMesh& mesh, const SceneTree& tree, const TubeSet& tubes, TubeRun run,
             const VisibilityOptions& options, VisibilityScratch& scratch, TubeVisibility& out,
             const std::function<void(std::uint32_t)>& take);

}  // namespace tubefoot
