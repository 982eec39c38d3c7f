// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "engine/certified/apparent_enclosure.hpp"
#include "engine/ground/paired_facet.hpp"

// What is proven of facets that two ends of a path see elsewhere.
namespace tubefoot {

/// An end of a path, and what it sees of a bed: vertices of its ground have the numbers of the bed's.
struct PairedEnd {
  const ApparentGround& ground;
  const SceneTree& tree;            ///< of its apparent facets
  std::span<const FacetId> origin;  ///< by apparent facet: that of the bed
  const Straightening& water;
  const RayEnclosure& rays;  ///< through that
};

/// A bed that is cut alike for both ends, and the flat facets that it is cut of.
struct PairedBed {
  const FacetMesh& mesh;
  std::span<const FacetId> parent;  ///< by facet of the mesh: that of the base
  const FacetMesh& base;            ///< where it lies
  const WorldGrid& grid;
  PairedEnd out, home;

  const PairedEnd& end(int which) const { return which == 0 ? out : home; }
};

/// What is proven of a facet laid out flat (PairedFacet), by ends: out and home.
struct PairedEnclosure {
  bool proven = false;
  double shift_m = 0;  ///< the half path of no place differs by more from the one laid out
  /// What a place returns along its two rays, over what the straight law makes of it laid out: of Lambert's
  /// law, or of the laws below, which are those of the angles that are laid out.
  Interval factor;
  std::array<std::optional<ScatteringLaw>, 2> law;
  /// No ray is launched farther than this from where its end sees the place, and the place's distance there
  /// is no farther than this part of itself from the range laid out.
  std::array<double, 2> turn_rad{}, stretch{};
  double place_off_m = 0;  ///< no place lies farther from where the laid out plane has it
};

struct PairedEnclosures {
  /// As the ends' apparent facets. Their shifts are those of doubts about places: of ranges to a facet's
  /// plane in the direction of a place; energies are those of the whole path.
  std::array<ApparentEnclosures, 2> ends;
  std::vector<PairedEnclosure> facets;  ///< as `shared`
};

/// Encloses the facets of a bed that either end sees, and more closely those that they share: `shared`, and
/// how each is laid out. `law`: that of apparent ranges, with the path's mirrors; material by facet of the
/// bed.
PairedEnclosures enclose(const PairedBed& bed, std::span<const SharedFacet> shared,
                         std::span<const PairedFacet> paired, const EchoLaw& law);

}  // namespace tubefoot
