// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "geometry/mesh/part_weights.hpp"
#include "geometry/search/scene_tree.hpp"
#include "geometry/tubes/tube.hpp"
#include "geometry/visibility/visibility.hpp"

// How often each part of each facet is seen by many pings: exactly. docs/coverage.md
namespace tubefoot {

class FacetRegions;

inline constexpr FacetId no_facet = std::numeric_limits<FacetId>::max();

/// Facets of a look's own: parts of the covered mesh's facets, or images of parts, which may lie and seem
/// anywhere. A point of a part is that of its facet which lies as it does between corners. Parts of a facet
/// have no common area.
struct SurfaceParts {
  FacetMesh mesh;
  std::unique_ptr<const SceneTree> tree;  ///< of this mesh
  std::vector<FacetId> base;              ///< by facet: the covered one
  std::vector<PartWeights> weights;       ///< by facet
  /// By facet: facets of two ends' seabeds of the same name are the same part; or, where each end's mirrors
  /// cut facets for themselves and all is seen where it lies, parts of the same.
  std::vector<FacetId> name;
};

/// What one end of a ping's paths sees.
struct CoverageEnd {
  TubeSet tubes;
  std::vector<TubeVisibility> seen;                 ///< per tube, by an exact arithmetic
  std::shared_ptr<const SurfaceParts> seabed = {};  ///< what it looks at; null: the covered mesh

  FacetId base_of(FacetId facet) const { return seabed ? seabed->base[facet] : facet; }
  FacetId name_of(FacetId facet) const { return seabed ? seabed->name[facet] : facet; }
};

/// What one transmission of a ping sees.
struct CoverageLook {
  std::uint32_t ping = 0;  ///< what several looks of one ping see counts once
  CoverageEnd tx;
  /// The window of half paths, grid units. A facet that reaches beyond it is cut (docs/coverage.md).
  double nearest = 0, farthest = std::numeric_limits<double>::infinity();
  /// A receiver elsewhere. Seen is then what both ends see of the same side, and in the sector what both have
  /// in their tubes.
  std::optional<CoverageEnd> rx = {};
};

/// A part of a facet's area that so many pings see.
struct AreaShare {
  std::uint32_t pings = 0;
  double share = 0;   ///< of the facet's area
  std::string exact;  ///< the same as a reduced fraction, "p/q" (or "0", "1")
};

/// A convex part of a facet, the same pings seeing all of it.
struct CoverageCell {
  std::uint32_t pings = 0;       ///< that see it
  std::uint32_t in_sector = 0;   ///< where none sees it: pings in whose tubes and window it lies, hidden
  std::uint32_t first_look = 0;  ///< where it lies hidden: the first look that has it in its tubes
  std::array<FacetId, 2> first_parts{};  ///< and which facets of its ends' seabeds lie there
  std::uint32_t first = 0, count = 0;    ///< corners, counter-clockwise about the facet's normal
};

struct FacetCoverage {
  FacetId facet = 0;
  bool closes = false;              ///< whether the shares add up to 1, as an equality of rationals
  std::vector<AreaShare> by_pings;  ///< by increasing number of pings, 0 (never seen) included; no empty ones
  AreaShare seen;                   ///< by one ping or more; `pings` is the most
  AreaShare shadow;  ///< never seen, though in the tubes and window of a ping; `pings`: the most that have it
  std::vector<CoverageCell> cells;  ///< they partition the facet
  std::vector<glm::dvec3> corners;  ///< grid units; the exact ones, rounded once
  bool met() const { return seen.share > 0 || shadow.share > 0; }
};

/// Overlays what many looks see, facet by facet.
/// Law O1 (coverage): shares by number of pings are those of inclusion and exclusion in rationals.
/// Law O2 (order): neither the order of pings nor how tubes are split changes them.
/// Law O3 (parts): nor how the looks' own seabeds part its facets.
/// Law O4 (ends): nor which of two ends is the transmit leg; both in one place see what one does.
class Coverage {
 public:
  /// Mesh, tree and looks must outlive it; looks are ordered by ping.
  Coverage(const FacetMesh& mesh, const SceneTree& tree, std::span<const CoverageLook> looks);

  /// Facets that may lie in the tubes of a look.
  std::size_t facets() const { return groups_.size(); }
  FacetId facet_of(std::size_t number) const {
    const Group& group = groups_[number];
    return group.seen < group.seen_end ? seen_[group.seen].facet : within_[group.within].facet;
  }
  /// The facet of that number, in the order of facet ids. Thread-safe; the result does not depend on threads.
  FacetCoverage facet(std::size_t number) const;

  /// What comes first on the way from the first look of a hidden cell to its middle (from its way home, if
  /// the transmit leg is free): a facet of the mesh, no_facet where there is none or it is too close to tell.
  /// In double.
  FacetId occluder(const FacetCoverage& of, const CoverageCell& cell) const;

 private:
  struct Part {
    FacetId facet = 0;
    std::uint32_t look = 0;
    FacetId name = 0;
    bool rx = false;
    FacetId own = 0;                    ///< in the end's seabed
    std::uint32_t tube = 0, piece = 0;  ///< piece: no_piece for the tube itself
  };
  struct Group {
    std::size_t seen = 0, seen_end = 0, within = 0, within_end = 0;
  };
  void add_seen(std::uint32_t look, bool rx, std::vector<char>& seen_whole);
  void add_within(std::uint32_t look, bool rx, const std::vector<char>& seen_whole,
                  std::vector<Part>& to) const;
  void index();
  static std::vector<FacetId> own_parts(std::span<const Part> parts);
  void add_regions(FacetRegions& facet, std::span<const Part> parts) const;

  const FacetMesh& mesh_;
  const SceneTree& tree_;
  std::span<const CoverageLook> looks_;
  std::vector<Part> seen_, within_;  ///< by facet, then look, tube and piece
  std::vector<Group> groups_;
  bool parted_ = false;  ///< some look has a seabed of its own
};

/// The facet that the line from an apex to a point meets first, before the point; `no_facet` if there is
/// none. In double.
FacetId first_in_the_way(const FacetMesh& mesh, const SceneTree& tree, GridPoint apex, glm::dvec3 point);

}  // namespace tubefoot
