// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "engine/certified/apparent_enclosure.hpp"
#include "engine/surface/facet_flattening.hpp"

// Encloses facets that the two ends of a path see at different apparent positions in stratified water. For
// each flattened facet it bounds the half path length, the ratio of true to straight-ray return, and the
// launch directions. See docs/notes/certified-energies.md, section "Of two ends".
namespace tubefoot {

/// One end of a path, and the apparent seabed that it sees. The vertices of the surface have the same
/// numbers as those of the seabed. The apex may differ from the grid point from which its tubes start.
struct BistaticEnd {
  const ApparentSurface& surface_mesh;
  const SceneTree& tree;            ///< tree of the apparent facets
  std::span<const FacetId> origin;  ///< facet of the seabed for each apparent facet
  const ApparentMap& water;
  const RayEnclosure& rays;  ///< rays through this water
};

/// Seabed with the same cuts for both ends, and the flat facets from which it was cut.
struct BistaticSurface {
  const FacetMesh& mesh;
  std::span<const FacetId> parent;  ///< base facet of each facet of the mesh
  const FacetMesh& base;            ///< at true positions
  const WorldGrid& grid;
  BistaticEnd tx, rx;
  /// Another receiver of the same transmission, or null. With it, most_per_sr and most bound the return of a
  /// point to either receiver.
  const BistaticEnd* beside = nullptr;
  double ranges_within_m = 0;  ///< with another receiver: required accuracy of ReceiveRanges

  const BistaticEnd& end(int which) const { return which == 0 ? tx : rx; }
};

/// Ranges along receive legs from a facet, minus the flattened ranges. The values lie on a lattice with a
/// power of two of parts per side. Index i runs from the first corner to the second, and j from the first to
/// the third, in the order of the mesh. Two neighbouring receivers have almost equal errors of range. The
/// difference of their ranges requires far higher accuracy than range bins do.
struct ReceiveRanges {
  int parts = 0;
  std::vector<Interval> lattice_m{};  ///< at index i (parts + 1) + j
  double between_m = 0;               ///< largest deviation from linear interpolation if parts is 1
  double pad_m = 0;                   ///< largest distance of a point from its position in the mesh
  std::array<Interval, 3> change{};   ///< slopes of the range along the axes, anywhere on the facet

  /// Returns an upper bound of the error that flattening causes in the range difference of two receivers.
  static double largest_difference_m(const ReceiveRanges& one, const ReceiveRanges& other);
};

/// Proven bounds of a flattened facet (BistaticFacet). Index 0 of the arrays is the transmit end, index 1
/// the receive end.
struct BistaticEnclosure {
  bool proven = false;
  double shift_m = 0;  ///< largest difference of a half path length from the flattened one
  /// Ratio between the return of a point along its two rays and the straight-ray return of its flattened
  /// point. The latter uses Lambert's law, or the models below, which are functions of the flattened angles.
  Interval factor;
  std::array<std::optional<ScatteringModel>, 2> model;
  /// `turn_rad`: largest angle between the launch direction of a ray and the apparent direction of its
  /// point. `stretch`: largest relative difference between the apparent distance of a point and its
  /// flattened range.
  std::array<double, 2> turn_rad{}, stretch{};
  ReceiveRanges rx;        ///< only with another receiver
  double place_off_m = 0;  ///< largest distance of a point from its position by the flattened plane
};

struct BistaticEnclosures {
  /// Enclosures of each end's apparent facets. Their shifts are those of ambiguities about points: errors of
  /// the range to a facet's plane in the direction of a point. Their energies are those of the whole path.
  std::array<ApparentEnclosures, 2> ends;
  std::vector<BistaticEnclosure> facets;  ///< in the order of `shared`
};

/// Encloses the facets of a seabed that either end sees, and more tightly those in `shared` that both ends
/// see. `bistatic` contains the flattened facets of `shared`. The ranges of `model` are apparent ranges, and
/// its path contains the mirrors. Materials are those of the facets of the seabed.
BistaticEnclosures enclose(const BistaticSurface& seabed, std::span<const SharedFacet> shared,
                           std::span<const BistaticFacet> bistatic, const EchoModel& model);

}  // namespace tubefoot
