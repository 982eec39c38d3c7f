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

// Which part of which facet a tube touches first: exactly, as convex pieces named by planes.
// docs/visibility.md
namespace tubefoot {

/// Number types that the one algorithm runs on. The first three see the same regions, always (how those are
/// cut into pieces may differ, as it does with facets_per_split).
enum class Arithmetic { fixed, filtered, rational, plain_double };

/// Name as in scene files and --arithmetic ("double" for plain_double); throws std::invalid_argument.
Arithmetic arithmetic_from_name(std::string_view name);
std::string_view name_of(Arithmetic arithmetic);

struct VisibilityOptions {
  Arithmetic arithmetic = Arithmetic::fixed;
  /// plain_double only: values within this, relative to their factors, count as zero.
  double tolerance = 0;
  /// A facet that more facets than this may hide is split before they are taken away from it; the visible
  /// region does not depend on it, only its cut into pieces and the time it takes.
  std::uint32_t facets_per_split = 64;
  /// Also find the open water of each tube: what no facet covers (for the closure law).
  bool open_water = false;
};

/// A convex cone of directions: corners [first, first + count) in TubeVisibility::corners, turning as a
/// tube's rays.
struct NamedPiece {
  FacetId facet = 0;
  std::uint32_t first = 0, count = 0;
};

/// What one tube sees.
struct TubeVisibility {
  std::vector<CornerName> corners;
  std::vector<NamedPiece> pieces;  ///< sorted by facet
  std::vector<NamedPiece> open;    ///< open water (facet is meaningless), if asked for
  /// (facet, facet that took something away from it), sorted, unique.
  std::vector<std::pair<FacetId, FacetId>> occluders;
  /// Rays that the names refer to: ray r is rays[r & ~ray_bit]. The first four are the tube's own.
  std::vector<GridPoint> rays;
  std::size_t candidates = 0;  ///< facets that subtend something within the tube's planes

  void clear();
};

/// Buffers that one thread keeps from tube to tube, so that the steady state allocates nothing.
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

/// Finds the visible pieces of tube `tube` of `tubes`. `out` is overwritten. By an exact arithmetic:
/// Law V1 (nearest): a direction lies in a piece of the facet that its ray meets first, or in open water.
/// Law V2 (arithmetics): every exact arithmetic sees the same regions of the same facets.
/// Law V3 (order): neither the order of facets, nor that of a facet's vertices, nor the ids of vertices, nor
///   whether facets share them changes what is seen.
/// Law V4 (translation): nor does moving scene and apex by a grid vector.
/// Law V5 (similarity): nor scaling the scene about the apex, nor (but for ties) exchanging the axes.
/// Law V6 (tubes add up): what the parts of a tube see adds up to what it sees.
/// Law V7 (facets add up): what is seen of the parts of a facet adds up to what is seen of it.
/// Law V8 (inner splitting): facets_per_split changes how pieces are cut, not what they cover.
/// Law V9 (monotone): a facet more uncovers nothing.
/// Law V10 (walls): nothing is seen behind a surface that covers the tube.
/// Law V11 (reach): facets wholly beyond the reach are not seen and hide nothing.
void see(const FacetMesh& mesh, const SceneTree& tree, const TubeSet& tubes, std::uint32_t tube,
         const VisibilityOptions& options, VisibilityScratch& scratch, TubeVisibility& out);

/// Tubes [first, end) of a set.
struct TubeRun {
  std::uint32_t first = 0, end = 0;
};

/// The set's tubes as runs of neighbours, in order: each tube of a run shares a wall with the one before it.
/// Depends on the set alone.
std::vector<TubeRun> runs_of(const TubeSet& tubes);

/// see() for each tube of a run in turn, `take(tube)` being called when `out` is that tube's. The same
/// results, bit for bit, in less time if the tubes are neighbours: they gather their facets together.
/// Law V12 (runs): a tube sees in any run what it sees alone, bit for bit: pieces, their order and names.
void see_run(const FacetMesh& mesh, const SceneTree& tree, const TubeSet& tubes, TubeRun run,
             const VisibilityOptions& options, VisibilityScratch& scratch, TubeVisibility& out,
             const std::function<void(std::uint32_t)>& take);

}  // namespace tubefoot
