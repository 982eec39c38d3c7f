// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <optional>
#include <unordered_map>
#include <vector>

#include "engine/scattering/bistatic_facet.hpp"
#include "engine/surface/refracted_surface.hpp"
#include "geometry/footprints/shared_footprints.hpp"

// Flattens facets for a transmitter and a separate receiver in stratified water. The two apexes see each
// facet at different apparent positions. See docs/notes/bistatic.md.
namespace tubefoot {

/// True facets that either apex may see, with the same cuts for both, and their apparent positions for each
/// apex. The vertices of both apparent meshes have the same numbers as those of `mesh`.
struct ApparentPair {
  FacetMesh mesh;
  ApparentSurface transmit, receive;
  std::vector<FacetId> transmit_origin, receive_origin;  ///< facet of `mesh` for each apparent facet
};

/// Does the same as map_apparent() for two apexes. An edge is cut if either apex requires the cut.
ApparentPair map_apparent_pair(const FacetMesh& base, std::span<const FacetId> facets, const WorldGrid& grid,
                               const ApparentMap& transmit, const ApparentMap& receive,
                               double reference_absorption_db_per_m, const ApparentMapSettings& settings,
                               const RefinementLimits& limits = {},
                               const ViewBounds* transmit_view_bounds = nullptr,
                               const ViewBounds* receive_view_bounds = nullptr);

/// Triangle flattened between two apexes, and the distances of its corners from them. The corners contain
/// only the apparent sines and, as gain, the ratio of true to flattened area.
struct FlattenedFacet {
  BistaticFacet facet;
  std::array<double, 3> there_m{}, back_m{};
  glm::dvec3 normal{0};  ///< of the true facet
};
/// Flattens a triangle, given its apparent corners relative to each apex and its true corners.
FlattenedFacet flatten_between(const glm::dvec3 (&from_transmitter)[3], const glm::dvec3 (&from_receiver)[3],
                               const glm::dvec3 (&lies)[3]);

/// One end of a path, and the apparent seabed that it sees. The vertices of the surface have the same
/// numbers as those of the seabed.
struct ApparentEnd {
  const ApparentSurface& surface_mesh;
  const ApparentMap& water;
};

/// Flattens the facets that two ends share, in the order of `shared`. Facet numbers of `shared` refer to
/// `seabed`.
std::vector<BistaticFacet> bistatic_facets(const SharedFootprints& shared, const FacetMesh& seabed,
                                           const ApparentEnd& transmit, const ApparentEnd& receive,
                                           const WorldGrid& grid, double absorption_db_per_m);
/// Does the same for an apparent pair. Facet numbers of `shared` refer to pair.mesh.
std::vector<BistaticFacet> bistatic_facets(const SharedFootprints& shared, const ApparentPair& pair,
                                           const WorldGrid& grid, const ApparentMap& transmit,
                                           const ApparentMap& receive, double reference_absorption_db_per_m);

/// Flattens facets for a receiver pair. Both receivers have the same plane, whose edges have the mean
/// squared lengths that the receivers see. Their ranges and range differences are then as accurate as
/// possible. The transmitter lies where its distances to the corners equal the apparent ranges. The corners
/// (Corner) of the result keep their default values.
class ReceiverPairFlattening {
 public:
  /// `receivers`: upper and lower receiver. All arguments must outlive this object.
  ReceiverPairFlattening(const FacetMesh& seabed, const ApparentEnd& transmit,
                         const std::array<const ApparentMap*, 2>& receivers, const WorldGrid& grid);
  /// Flattens the facets that one receiver shares with the transmitter, in the order of `shared`.
  std::vector<BistaticFacet> of(const SharedFootprints& shared, std::size_t receiver);

 private:
  using Image = std::optional<glm::dvec3>;  // from the receiver's apex, not rounded to the grid
  const Image& image(std::size_t receiver, VertexId vertex);

  const FacetMesh& seabed_;
  const ApparentEnd transmit_;
  std::array<const ApparentMap*, 2> receivers_;
  const WorldGrid& grid_;
  std::array<std::unordered_map<VertexId, Image>, 2> images_;
};

}  // namespace tubefoot
