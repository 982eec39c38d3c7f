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

// Whose each energy is, and where it comes from (docs/labels.md). A share is the same integral over fewer
// facets, and a mean height the same with the height as one more factor of the density, as micro-texture is:
// whatever the engine integrates, it integrates once more for each channel, by another law.
namespace tubefoot {

/// What is resolved in a survey.
class LabelChannels {
 public:
  LabelChannels(const Survey& survey, const RunRequest& request);

  using Owner = LabelRecording::Owner;
  /// The pairs of an object and a material that facets may have.
  const std::vector<Owner>& owners() const { return owners_; }
  /// As in LabelRecording::values: channel k is owner k's; then these.
  std::size_t height() const { return owners_.size(); }
  std::size_t range() const { return owners_.size() + 1; }
  std::size_t unscattered() const { return owners_.size() + 2; }
  bool has_unscattered() const { return has_unscattered_; }
  /// Of what an owner returns near the peak of beam patterns.
  std::size_t near_peak(std::size_t owner) const {
    return owners_.size() + 2 + (has_unscattered_ ? 1 : 0) + owner;
  }
  /// Below the two-way peak; none where no sensor has beam patterns.
  const std::optional<double>& label_level_db() const { return label_level_db_; }
  std::size_t channels() const { return near_peak(label_level_db_ ? owners_.size() : 0); }

  std::uint16_t owner(std::uint16_t object, std::uint16_t material) const;
  /// By facet.
  std::vector<std::uint16_t> owners_of(const FacetMesh& mesh) const;
  /// The same of the mesh of the survey's site, kept.
  const FacetMesh& scene_mesh() const { return *scene_mesh_; }
  /// The mesh of the survey's site with owners for materials, made when it is first asked for. Thread-safe.
  const FacetMesh& owned_scene_mesh() const;
  std::span<const std::uint16_t> owners_of_loaded_scene() const;

 private:
  const FacetMesh* scene_mesh_;
  std::vector<Owner> owners_;
  std::vector<std::vector<std::int32_t>> number_;  ///< by object and material; below 0: no facet is of these
  bool has_unscattered_ = false;
  std::optional<double> label_level_db_;
  mutable std::once_flag loaded_scene_owned_, mesh_owned_;
  mutable std::vector<std::uint16_t> owners_of_loaded_scene_;
  mutable FacetMesh owned_;
};

/// The laws of a transmission's channels, as a sensor receives it.
class LabelModels {
 public:
  /// `model`: as for the energies, of `mesh`. All outlive this.
  LabelModels(const Transmission& transmission, std::size_t sensor, const EchoModel& model,
              const FacetMesh& mesh);
  /// `owners`: by what `law.material` is by.
  LabelModels(const Transmission& transmission, std::size_t sensor, const EchoModel& model,
              std::vector<std::uint16_t> owners);
  LabelModels(const LabelModels&) = delete;
  LabelModels& operator=(const LabelModels&) = delete;

  /// An echo by a law: [beam of the transmission][sample], and more channels, which are not read.
  using EchoBy = std::function<std::vector<double>(const EchoModel&)>;
  /// Adds what is scattered.
  void add(PingSums& sums, const EchoBy& echo_by) const;
  /// The law itself, with owners for materials, and that of a seabed that scatters nothing.
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
  double scale_m_ = 1, lowest_m_ = 0;      ///< of the weights, which are about 0 to 1
  std::vector<double> mu_, no_mu_;         ///< by owner, as all below
  std::vector<std::shared_ptr<const ScatteringModel>> scattering_, no_scattering_;
  Textures plain_, level_, height_, range_;
};

/// A mesh with owners for materials, and what of the scene is by material, by owner: for paths, that make
/// meshes of their own of it.
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

/// Where a ping store keeps the truth of a sensor: as one more sensor, that fires with it.
std::size_t place_of_labels(const Survey& survey, std::size_t sensor);
void add_labels(StoreLayout& layout, const Survey& survey, const RunRequest& request,
                const std::vector<ChosenEchoes>& chosen);

/// Of each sensor that is kept, if the run was asked for it. They keep the store alive.
std::vector<LabelRecording> label_recordings_of(const Survey& survey, const RunRequest& request,
                                                const std::shared_ptr<PingStore>& store);

}  // namespace tubefoot
