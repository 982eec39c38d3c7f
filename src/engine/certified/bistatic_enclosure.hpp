// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "engine/certified/apparent_enclosure.hpp"
#include "engine/surface/bistatic_facet.hpp"

// What is proven of facets that two ends of a path see elsewhere.
namespace tubefoot {

/// An end of a path, and what it sees of a seabed: vertices of its ground have the numbers of the seabed's.
/// Its apex may lie beside the grid point that its tubes look from.
struct BistaticEnd {
  const ApparentSurface& surface_mesh;
  const SceneTree& tree;            ///< of its apparent facets
  std::span<const FacetId> origin;  ///< by apparent facet: that of the seabed
  const ApparentMap& water;
  const RayEnclosure& rays;  ///< through that
};

/// A seabed that is cut alike for both ends, and the flat facets that it is cut of.
struct BistaticSurface {
  const FacetMesh& mesh;
  std::span<const FacetId> parent;  ///< by facet of the mesh: that of the base
  const FacetMesh& base;            ///< where it lies
  const WorldGrid& grid;
  BistaticEnd tx, rx;
  /// Another receiver of the same transmission: most_per_sr and most are of what either receives of a place.
  const BistaticEnd* beside = nullptr;
  double ranges_within_m = 0;  ///< with that: how closely ReceiveRanges are to be told

  const BistaticEnd& end(int which) const { return which == 0 ? tx : rx; }
};

/// Ranges along rays home from a facet, less those laid out: on a lattice of a power of two of parts a side,
/// from the first corner to the second (i) and to the third (j), as the mesh has them. What two receivers
/// beside each other differ by, mostly, is all but alike for both: so ranges have to be told far more closely
/// than samples ask for.
struct ReceiveRanges {
  int parts = 0;
  std::vector<Interval> lattice_m{};  ///< at i (parts + 1) + j
  double between_m = 0;  ///< and anywhere between no farther than that from the linear; all of that at 1 part
  double pad_m = 0;      ///< places lie no farther from where the mesh has them
  std::array<Interval, 3> change{};  ///< of the range with its place, anywhere

  /// The difference of both ranges differs by no more from that of those laid out.
  static double largest_difference_m(const ReceiveRanges& one, const ReceiveRanges& other);
};

/// What is proven of a facet flattened (BistaticFacet), by ends: transmit and receive.
struct BistaticEnclosure {
  bool proven = false;
  double shift_m = 0;  ///< the half path of no place differs by more from the one laid out
  /// What a place returns along its two rays, over what the straight law makes of it laid out: of Lambert's
  /// law, or of the laws below, which are those of the angles that are laid out.
  Interval factor;
  std::array<std::optional<ScatteringModel>, 2> model;
  /// No ray is launched farther than this from where its end sees the place, and the place's distance there
  /// is no farther than this part of itself from the range laid out.
  std::array<double, 2> turn_rad{}, stretch{};
  ReceiveRanges rx;        ///< of a receiver that has one beside it
  double place_off_m = 0;  ///< no place lies farther from where the laid out plane has it
};

struct BistaticEnclosures {
  /// As the ends' apparent facets. Their shifts are those of ambiguities about places: of ranges to a facet's
  /// plane in the direction of a place; energies are those of the whole path.
  std::array<ApparentEnclosures, 2> ends;
  std::vector<BistaticEnclosure> facets;  ///< as `shared`
};

/// Encloses the facets of a seabed that either end sees, and more closely those that they share: `shared`,
/// and how each is laid out. `model`: that of apparent ranges, with the path's mirrors; material by facet of
/// the seabed.
BistaticEnclosures enclose(const BistaticSurface& seabed, std::span<const SharedFacet> shared,
                           std::span<const BistaticFacet> bistatic, const EchoModel& model);

}  // namespace tubefoot
