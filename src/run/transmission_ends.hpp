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

namespace tubefoot {

/// One end of a transmission's paths: its tubes, and the seabed as they see it.
struct TransmissionEnd {
  TubeSet tubes;
  const FacetMesh* mesh = nullptr;
  const SceneTree* tree = nullptr;
  const RefinedMesh* refined = nullptr;  ///< the mesh as parts of the scene's facets; null: those themselves
  const ApparentSurface* apparent = nullptr;  ///< null where facets are where they seem to be
  /// By facet: the same one's name for the other end, where both ends have meshes of their own; else empty.
  std::span<const FacetId> name{};
  const LoadedScene* loaded_scene =
      nullptr;  ///< whose facets these are; null: they are the transmission's own

  FacetId name_of(FacetId facet) const { return name.empty() ? facet : name[facet]; }
  /// What a facet of that name is called: of the loaded scene's own, its number in all of the scene.
  FacetId number_of_name(FacetId shared) const {
    return loaded_scene == nullptr ? shared : loaded_scene->number_of(shared);
  }
  FacetId number_of(FacetId facet) const { return number_of_name(name_of(facet)); }
};

/// The ends of a transmission's paths, and what they see: one, or two where the receiver is apart. The
/// transmission outlives them.
class TransmissionEnds {
 public:
  /// With one end: tubes as that sensor sends them. `weights`: with RefinedMesh::weights about the scene's
  /// facets. Throws as Transmission::ground().
  TransmissionEnds(const Transmission& transmission, std::size_t sensor, bool weights = false);
  TransmissionEnds(const TransmissionEnds&) = delete;
  TransmissionEnds& operator=(const TransmissionEnds&) = delete;

  bool are_two() const { return ends_.size() == 2; }
  const TransmissionEnd& tx() const { return ends_.front(); }
  const TransmissionEnd& rx() const { return ends_.back(); }
  std::span<const TransmissionEnd> all() const { return ends_; }
  /// Facets of what two ends see together, and, in refracting water, where each sees them; null in even
  /// water.
  const FacetMesh& shared_mesh() const { return pair_ ? pair_->apparent.mesh : *tx().mesh; }
  /// Of the scene without relief, a facet of that, by its number in all of the scene.
  FacetId base_facet(FacetId shared) const;
  const ApparentPair* apparent_pair() const { return pair_ ? &pair_->apparent : nullptr; }

  /// What two ends see, each by itself and together, from one look of each.
  struct Seen {
    std::vector<History> alone;
    PathFootprints together;
  };
  Seen seen() const;
  /// How the transmission receives what two ends see together.
  std::unique_ptr<SensorModel> model(std::size_t sensor) const;
  /// The laws of both; `label` tells transmissions apart in the hash.
  BistaticAudit audit(std::uint64_t label) const;

 private:
  using Looks = std::vector<std::vector<TubeVisibility>>;  // by end
  Looks look_from_all(bool open_water) const;
  FootprintSharer sharer(const Looks& looks) const;

  const Transmission& transmission_;
  std::optional<TransmissionSurface> surface_mesh_;  ///< with weights
  std::optional<RefractedPair> pair_;
  std::vector<FacetId> pair_parent_;               ///< by facet of the pair's mesh: the scene's
  std::vector<std::unique_ptr<SceneTree>> trees_;  ///< of the pair
  std::vector<TransmissionEnd> ends_;
};

}  // namespace tubefoot
