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

#include "geometry/footprints/range_ring.hpp"
#include "geometry/mesh/part_weights.hpp"
#include "geometry/search/scene_tree.hpp"
#include "geometry/tubes/tube.hpp"
#include "geometry/visibility/visibility.hpp"

// Computes how many pings see each part of each facet, in exact arithmetic (docs/notes/coverage.md). The
// borders of the parts that the pings see divide a facet into convex cells. The areas of the cells are
// rationals.
namespace tubefoot {

class FacetRegions;
struct CoverageCells;

/// The facets of one end's own seabed. They are parts of the covered mesh's facets, or images of such parts,
/// at any position and apparent position. A point lies between the corners of its part as it lies between the
/// corresponding points of the covered facet. Parts of one facet have no common area.
struct SurfaceParts {
  std::shared_ptr<const FacetMesh> mesh;
  std::shared_ptr<const SceneTree> tree;  ///< search tree of this mesh
  /// Facets with lower numbers are equal to those of the covered mesh, with the same vertices.
  FacetId first_displaced = 0;
  // Empty vectors stand for facets that have the numbers of the covered mesh and are whole.
  std::vector<FacetId> base;         ///< per facet: the facet of the covered mesh
  std::vector<PartWeights> weights;  ///< per facet: weights of the corners in the covered facet
  /// Per facet: a name. Facets of the same name in the seabeds of two ends are the same part. If the mirrors
  /// of each end cut the facets separately and no position is refracted, they are parts of the same facet.
  std::vector<FacetId> name;
};

/// The visible polygons of one end of a ping's paths.
struct CoverageEnd {
  TubeSet tubes;
  std::vector<TubeVisibility> seen;                 ///< per tube, by an exact arithmetic
  std::shared_ptr<const SurfaceParts> seabed = {};  ///< the surface that the end sees; null: the covered mesh

  bool is_displaced(FacetId facet) const { return seabed && facet >= seabed->first_displaced; }
  FacetId base_of(FacetId facet) const {
    return seabed && !seabed->base.empty() ? seabed->base[facet] : facet;
  }
  const PartWeights& weights_of(FacetId facet) const {
    return seabed && !seabed->weights.empty() ? seabed->weights[facet] : all_of_it;
  }
  FacetId name_of(FacetId facet) const {
    return seabed && !seabed->name.empty() ? seabed->name[facet] : facet;
  }
};

/// The visible polygons of one transmission of a ping.
struct CoverageLook {
  std::uint32_t ping = 0;  ///< several looks of one ping count once
  CoverageEnd tx;
  /// The range gate of half path lengths, in grid units. A facet that reaches beyond the gate is cut
  /// (docs/notes/coverage.md).
  double nearest = 0, farthest = std::numeric_limits<double>::infinity();
  /// True if the range gate of another look of the ping ends at `nearest`. The polygons of this border are
  /// then the same for both looks.
  bool continues = false;
  /// A separate receiver. A part is then seen if both ends see it from the same side. It is in the sector if
  /// both ends have it in their tubes.
  std::optional<CoverageEnd> rx = {};

  RingSide inner_side() const { return continues ? RingSide::inscribed : RingSide::circumscribed; }
};

/// A part of a facet's area that the given number of pings sees.
struct AreaShare {
  std::uint32_t pings = 0;
  double share = 0;   ///< fraction of the facet's area
  std::string exact;  ///< the same as a reduced fraction, "p/q" (or "0", "1"); empty if it is too long
  double error = 0;   ///< largest difference between `share` and the exact fraction
};

/// A convex part of a facet of which the same pings see every point.
struct CoverageCell {
  std::uint32_t pings = 0;  ///< number of pings that see the cell
  std::uint32_t in_sector =
      0;  ///< if no ping sees the cell: pings that have the cell in their tubes and range gate, hidden
  std::uint32_t first_look = 0;  ///< for a hidden cell: the first look that has it in its tubes
  std::array<FacetId, 2>
      first_parts{};  ///< for a hidden cell: the facets at it in the seabeds of this look's two ends
  std::uint32_t first = 0, count = 0;  ///< corners, counter-clockwise about the facet's normal
};

struct FacetCoverage {
  FacetId facet = 0;
  bool closes = false;  ///< whether the areas of the cells add up to that of the facet, modulo 2^61 - 1
  std::vector<AreaShare>
      by_pings;      ///< by increasing number of pings, including 0 (never seen); only shares above 0
  AreaShare seen;    ///< seen by one ping or more; `pings` is the largest number
  AreaShare shadow;  ///< never seen, although in the tubes and range gate of a ping; `pings` is the largest
                     ///< number of such pings
  std::vector<CoverageCell> cells;  ///< a partition of the facet
  std::vector<glm::dvec3> corners;  ///< grid units; the exact corners, rounded once
  bool met() const { return seen.share > 0 || shadow.share > 0; }
};

/// Overlays the visible polygons of many looks, facet by facet.
///
/// Law O1 (coverage): the shares by number of pings equal those of inclusion and exclusion in rationals.
///
/// Law O2 (order): the order of pings and the division into tubes do not change the shares.
///
/// Law O3 (parts): the division of the facets in the looks' own seabeds does not change the shares.
///
/// Law O4 (ends): an exchange of the two ends does not change the shares; two ends at one position give the
/// shares of one end.
///
/// Law O6 (mean): the mean number of pings equals the sum of the shares that each ping alone sees.
class Coverage {
 public:
  /// Mesh, tree and looks must outlive the object. Looks are ordered by ping.
  Coverage(const FacetMesh& mesh, const SceneTree& tree, std::span<const CoverageLook> looks);

  /// Returns the number of facets that may lie in the tubes of a look.
  std::size_t facets() const { return groups_.size(); }
  FacetId facet_of(std::size_t number) const {
    const Group& group = groups_[number];
    return group.seen < group.seen_end ? seen_[group.seen].facet : within_[group.within].facet;
  }
  /// Computes the facet of that number, in the order of facet ids. Thread-safe; the result does not depend on
  /// the number of threads.
  FacetCoverage facet(std::size_t number) const;

  /// Returns the facet that hides the middle of a hidden cell from the first look that has the cell in its
  /// tubes. The transmit leg is tested first, then the receive leg. Returns no_facet if there is none or it
  /// is too close to be distinguished. Computes in double.
  FacetId occluder(const FacetCoverage& of, const CoverageCell& cell) const;

 private:
  struct Part {
    FacetId facet = 0;
    std::uint32_t look = 0;
    FacetId name = 0;
    bool rx = false;
    FacetId own = 0;                    ///< facet of the end's seabed
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
  void add_layers(FacetRegions& facet, std::span<const Part> parts) const;
  static void measure(const FacetRegions& facet, const CoverageCells& divided, FacetCoverage& result);

  const FacetMesh& mesh_;
  const SceneTree& tree_;
  std::span<const CoverageLook> looks_;
  std::vector<Part> seen_, within_;  ///< ordered by facet, then look, tube and piece
  std::vector<Group> groups_;
};

/// Returns the first facet that the line from an apex to a point meets before the point, or `no_facet` if
/// there is none. Computes in double.
FacetId first_in_the_way(const FacetMesh& mesh, const SceneTree& tree, GridPoint apex, glm::dvec3 point);

}  // namespace tubefoot
