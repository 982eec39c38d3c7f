// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <vector>

#include "run/ping_sums.hpp"
#include "run/transmission.hpp"
#include "sensors/recordings/label_recording.hpp"

// This header declares the labels of each energy: object, material, mean height and mean range
// (docs/output-files.md). The energy of one object and material is the same integral over fewer facets. A
// mean height is the same integral with the height as one more factor of the density, in the way of a
// micro-texture. Each integral that an engine computes is therefore repeated for each channel with another
// echo model.
namespace tubefoot {

/// Channels of the labels of a survey.
class LabelChannels {
 public:
  LabelChannels(const Survey& survey, const RunRequest& request);

  using Owner = LabelRecording::Owner;
  /// Returns the pairs of object and material that facets may have.
  const std::vector<Owner>& owners() const { return owners_; }
  /// Channel numbers as in LabelRecording::recorded. Channel k belongs to owner k; the channels below follow.
  std::size_t height() const { return owners_.size(); }
  std::size_t range() const { return owners_.size() + 1; }
  std::size_t unscattered() const { return owners_.size() + 2; }
  bool has_unscattered() const { return has_unscattered_; }
  /// Channel of the energy that an owner returns near the peak of the beam patterns.
  std::size_t near_peak(std::size_t owner) const {
    return owners_.size() + 2 + (has_unscattered_ ? 1 : 0) + owner;
  }
  /// Returns the level below the two-way peak. Empty if no sensor has beam patterns.
  const std::optional<double>& label_level_db() const { return label_level_db_; }
  std::size_t channels() const { return near_peak(label_level_db_ ? owners_.size() : 0); }

  std::uint16_t owner(std::uint16_t object, std::uint16_t material) const;
  /// Returns the owner of each facet.
  std::vector<std::uint16_t> owners_of(const FacetMesh& mesh) const;
  /// Returns the mesh of the survey's loaded scene.
  const FacetMesh& scene_mesh() const { return *scene_mesh_; }
  /// Returns the mesh of the survey's loaded scene with owners in place of materials. The first call makes
  /// it. Thread-safe.
  const FacetMesh& owned_scene_mesh() const;
  std::span<const std::uint16_t> owners_of_loaded_scene() const;

 private:
  const FacetMesh* scene_mesh_;
  std::vector<Owner> owners_;
  /// by object and material; negative if no facet has this pair
  std::vector<std::vector<std::int32_t>> number_;
  bool has_unscattered_ = false;
  std::optional<double> label_level_db_;
  mutable std::once_flag loaded_scene_owned_, mesh_owned_;
  mutable std::vector<std::uint16_t> owners_of_loaded_scene_;
  mutable FacetMesh owned_;
};

/// Echo models of the label channels of a transmission, as one sensor receives it.
class LabelModels {
 public:
  /// `model`: the echo model of the energies, for the facets of `mesh`. All arguments must outlive this
  /// object.
  LabelModels(const Transmission& transmission, std::size_t sensor, const EchoModel& model,
              const FacetMesh& mesh);
  /// `owners`: has the same index as `model.material`.
  LabelModels(const Transmission& transmission, std::size_t sensor, const EchoModel& model,
              std::vector<std::uint16_t> owners);
  LabelModels(const LabelModels&) = delete;
  LabelModels& operator=(const LabelModels&) = delete;

  /// Function that returns an echo by an echo model: [beam of the transmission][sample]. Further channels
  /// are ignored.
  using EchoBy = std::function<std::vector<double>(const EchoModel&)>;
  /// Adds the labels of the scattered energy.
  void add(PingSums& sums, const EchoBy& echo_by) const;
  /// The echo model with owners in place of materials, and the echo model of a seabed that scatters nothing.
  EchoModel whole() const;
  EchoModel silent() const;

 private:
  using Textures = std::vector<std::shared_ptr<const ReflectivityField>>;
  Textures weighed_by(const std::shared_ptr<const ReflectivityField>& weight) const;
  void make_tables();

  const Transmission& transmission_;
  const LabelChannels& labels_;
  std::size_t sensor_;
  const EchoModel& model_;
  std::vector<std::uint16_t> own_;
  std::span<const std::uint16_t> owners_;  ///< by facet
  double scale_m_ = 1, lowest_m_ = 0;  ///< offset and scale of the weights, which lie between about 0 and 1
  std::vector<double> mu_, no_mu_;     ///< by owner, as are the members below
  std::vector<std::shared_ptr<const ScatteringModel>> scattering_, no_scattering_;
  Textures plain_, level_, height_, range_;
};

/// A mesh with owners in place of materials, and the reflection by owner. Path computations build their own
/// meshes from it.
struct LabelledSurface {
  LabelledSurface(const Transmission& transmission, const FacetMesh& mesh);
  LabelledSurface(const LabelledSurface&) = delete;
  LabelledSurface& operator=(const LabelledSurface&) = delete;
  const FacetMesh& mesh() const { return own ? *own : *loaded_scene; }

  std::vector<double> reflection;

 private:
  const FacetMesh* loaded_scene = nullptr;
  std::optional<FacetMesh> own;
};

/// Returns one recording of labels per stored sensor if the run requests labels. The recordings keep the
/// store alive.
std::vector<LabelRecording> label_recordings_of(const Survey& survey, const RunRequest& request,
                                                const std::shared_ptr<PingStore>& store);

}  // namespace tubefoot
