// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "engine/visibility/bistatic_audit.hpp"
#include "engine/visibility/path_footprints.hpp"
#include "run/refraction.hpp"
#include "run/transmission.hpp"

// A path of a transmission has two ends: the transmitter and the receiver. A monostatic sonar has one end for
// both. Each end has tubes and a surface mesh, and the visibility solver runs once per end. The common
// visibility of both ends needs facets that both meshes share.
//
// A facet has three numbers:
// - in the mesh of its end (FacetId of TransmissionEnd::mesh);
// - in the mesh that both ends share, here called its name (TransmissionEnd::name_of());
// - in the whole scene (TransmissionEnd::number_of()).
namespace tubefoot {

/// One end of a transmission's paths: its tubes, and the seabed from its view.
struct TransmissionEnd {
  TubeSet tubes;
  const FacetMesh* mesh = nullptr;
  const SceneTree* tree = nullptr;
  /// The mesh as parts of the scene's facets; null: the scene's facets themselves.
  const RefinedMesh* refined = nullptr;
  const MovedFacets* moved = nullptr;  ///< the scene's facets at another time; null if they are at rest
  const ApparentSurface* apparent = nullptr;  ///< null if apparent and true positions are equal
  /// By facet: the shared name of this facet at both ends, if each end has its own mesh. Otherwise empty.
  std::span<const FacetId> name{};
  /// Scene to which these facets belong; null: the facets are the transmission's own.
  const LoadedScene* loaded_scene = nullptr;

  FacetId name_of(FacetId facet) const { return name.empty() ? facet : name[facet]; }
  /// Returns the number of a facet with that name: its number in the whole scene, if it is a facet of the
  /// loaded scene.
  FacetId number_of_name(FacetId shared) const {
    return loaded_scene == nullptr ? shared : loaded_scene->number_of(shared);
  }
  FacetId number_of(FacetId facet) const { return number_of_name(name_of(facet)); }
};

/// The ends of a transmission's paths and their visibility: one end, or two for a separate receiver. The
/// transmission must outlive this object.
class TransmissionEnds {
 public:
  /// With one end, the tubes are those that `sensor` sends. `weights`: whether to compute
  /// RefinedMesh::weights relative to the scene's facets. Throws the errors of Transmission::surface_mesh().
  TransmissionEnds(const Transmission& transmission, std::size_t sensor, bool weights = false);
  TransmissionEnds(const TransmissionEnds&) = delete;
  TransmissionEnds& operator=(const TransmissionEnds&) = delete;

  bool are_two() const { return ends_.size() == 2; }
  const TransmissionEnd& tx() const { return ends_.front(); }
  const TransmissionEnd& rx() const { return ends_.back(); }
  std::span<const TransmissionEnd> all() const { return ends_; }
  /// Returns the facets of the common visibility of two ends. The function apparent_pair() returns their
  /// apparent positions from each end; it returns null in isovelocity water.
  const FacetMesh& shared_mesh() const { return pair_ ? pair_->apparent.mesh : *tx().mesh; }
  /// Returns the facet of the scene without relief that contains a shared facet, by its number in the whole
  /// scene.
  FacetId base_facet(FacetId shared) const;
  const ApparentPair* apparent_pair() const { return pair_ ? &pair_->apparent : nullptr; }

  /// Visibility from two ends, separately and in common, with one computation per end. The common visibility
  /// is limited to the interval of a divided record.
  struct Seen {
    std::vector<History> alone;
    PathFootprints together;
  };
  /// Requires two ends.
  Seen seen() const;
  /// Returns the model by which the transmission receives the common visibility of two ends.
  std::unique_ptr<SensorModel> model(std::size_t sensor) const;
  /// Requires two ends. Checks the closure laws of each end and of their common visibility. `label`
  /// distinguishes transmissions in the hash.
  BistaticAudit audit(std::uint64_t label) const;

 private:
  using Looks = std::vector<std::vector<TubeVisibility>>;  // by end
  Looks look_from_all(bool open_water) const;
  FootprintSharer sharer(const Looks& looks) const;

  const Transmission& transmission_;
  std::optional<TransmissionSurface> surface_mesh_;  ///< with weights
  std::optional<RefractedPair> pair_;
  std::vector<FacetId> pair_parent_;               ///< by facet of the pair's mesh: the facet of the scene
  std::vector<std::unique_ptr<SceneTree>> trees_;  ///< trees of the pair
  std::vector<TransmissionEnd> ends_;
};

}  // namespace tubefoot
