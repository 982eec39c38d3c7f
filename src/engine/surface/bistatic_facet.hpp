// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <optional>
#include <unordered_map>
#include <vector>

#include "engine/scattering/facet_map.hpp"
#include "engine/surface/refracted_surface.hpp"
#include "geometry/footprints/shared_footprints.hpp"

// Transmitter and separate receiver in refracting water: facets that each sees elsewhere. docs/bistatic.md
namespace tubefoot {

/// The true facets that either apex may see, cut alike for both, and where each apex sees them. Vertices of
/// both apparent meshes have the numbers of `mesh`.
struct ApparentPair {
  FacetMesh mesh;
  ApparentSurface transmit, receive;
  std::vector<FacetId> transmit_origin, receive_origin;  ///< by apparent facet: that of `mesh`
};

/// straighten() for two apexes: edges are cut where either of the two needs it.
ApparentPair map_apparent_pair(const FacetMesh& base, std::span<const FacetId> facets, const WorldGrid& grid,
                               const ApparentMap& transmit, const ApparentMap& receive,
                               double reference_absorption_db_per_m, const ApparentMapSettings& settings,
                               const RefinementLimits& limits = {},
                               const ViewBounds* transmit_view_bounds = nullptr,
                               const ViewBounds* receive_view_bounds = nullptr);

/// A triangle as two apexes see it, flattened. Its edges have the root mean squares of the lengths that
/// they are seen with, and each apex is put where the corners are as far from it as they are seen: in even
/// water where it is. Sums of distances to the two are then right at the corners, and between them to second
/// order of the edges. Where a corner would be farther from another than the difference of their distances
/// allows, the apex is a thousandth of the distance above the plane. Coordinates: those of PathCutter.
struct BistaticFacet {
  double transmit_distance_m = 0, receive_distance_m = 0;  ///< from the plane
  glm::dvec2 receive_foot_m{0};
  FacetMap to_plane;  ///< from places where the transmitter sees them, relative to it, to (x, y, 0)
  /// Where the plane's points are seen, relative to each apex, and where they lie, local frame.
  LyingPlane transmit_seen, receive_seen, lies;
  struct Corner {
    double transmit_lies = 0, transmit_seen = 0, receive_lies = 0, receive_seen = 0;  ///< sines of grazing
    /// What a corner returns apart from its scattering, over 1 / (r_T^2 r_R^2) and reference absorption.
    double gain = 1;
  };
  std::array<Corner, 3> corners;
  double misfit_m = 0;  ///< of half paths at the corners

  /// To the end of a receiver pair whose middle the receive leg leads to: the apparent seabed stays where it
  /// is. False: the plane is not in front of it.
  bool move_receiver(glm::dvec3 by_m);
};

/// A triangle flattened between two apexes, and how far its corners then are from them. Of the corners'
/// returns only the seen sines and, as gain, the ratio of the areas.
struct FlattenedFacet {
  BistaticFacet facet;
  std::array<double, 3> there_m{}, back_m{};
  glm::dvec3 normal{0};  ///< where it lies
};
/// Corners as they are seen, relative to the apexes, and where they lie.
FlattenedFacet flatten_between(const glm::dvec3 (&from_transmitter)[3], const glm::dvec3 (&from_receiver)[3],
                               const glm::dvec3 (&lies)[3]);

/// One end of a path, and where it sees the seabed: vertices of the surface have the numbers of the seabed's.
struct ApparentEnd {
  const ApparentSurface& surface_mesh;
  const ApparentMap& water;
};

/// Facets that two ends share, in their order. `shared` is about `seabed`, whose facets both see.
std::vector<BistaticFacet> bistatic_facets(const SharedFootprints& shared, const FacetMesh& seabed,
                                           const ApparentEnd& transmit, const ApparentEnd& receive,
                                           const WorldGrid& grid, double absorption_db_per_m);
/// The same of a pair. `shared` is about pair.mesh.
std::vector<BistaticFacet> bistatic_facets(const SharedFootprints& shared, const ApparentPair& pair,
                                           const WorldGrid& grid, const ApparentMap& transmit,
                                           const ApparentMap& receive, double reference_absorption_db_per_m);

/// Lays out facets for a receiver pair: on one plane for both of its receivers, with edges as these see them,
/// so that their ranges, and what these differ by, are as right as they can be; the transmitter is put where
/// its distances to the corners are right. Corners of the result (Corner) are left as they are made.
class ReceiverPairFlattening {
 public:
  /// `receivers`: upper and lower. All outlive it.
  ReceiverPairFlattening(const FacetMesh& seabed, const ApparentEnd& transmit,
                         const std::array<const ApparentMap*, 2>& receivers, const WorldGrid& grid);
  /// Facets that one of them shares with the transmitter, in their order.
  std::vector<BistaticFacet> of(const SharedFootprints& shared, std::size_t receiver);

 private:
  using Image = std::optional<glm::dvec3>;  // from the receiver's apex, to the last digit
  const Image& image(std::size_t receiver, VertexId vertex);

  const FacetMesh& seabed_;
  const ApparentEnd transmit_;
  std::array<const ApparentMap*, 2> receivers_;
  const WorldGrid& grid_;
  std::array<std::unordered_map<VertexId, Image>, 2> images_;
};

/// What a facet returns over what the straight law makes of it flattened: the mean over its corners of
/// gain sqrt(sigma(lies) sigma(lies)) / sqrt(sigma(seen) sigma(seen)); null: Lambert's law.
double bistatic_factor(const BistaticFacet& facet, const ScatteringModel* model);

}  // namespace tubefoot
