// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "engine/paths/path_echo.hpp"
#include "run/checkpoint/ping_store.hpp"
#include "run/transmission.hpp"

// Sonars in water that refracts (docs/refraction.md).
namespace tubefoot {

struct SimulationStats;

/// Speed of sound where a sensor is first; the scene's, in isovelocity water.
double sound_speed_at(const Scene& scene, const SensorDescription& sensor, const Trajectory& trajectory);

/// Gives each sensor its water, where that refracts. Throws InputError for a sensor above the surface.
void put_into_water(LoadedScene& loaded_scene, SensorSet& sensor_set);

EigenrayOptions eigenray_options(const LoadedScene& loaded_scene);
ApparentMap apparent_map_of(const LoadedScene& loaded_scene, const SensorPings& pings, glm::dvec3 apex_m);
/// As the scene asks for.
ApparentMapSettings apparent_map_settings(const Transmission& transmission, double reach_m);

/// The seabed of a transmission where it lies: the scene's, or with relief as fine as bent rays need it.
class TrueSurface {
 public:
  /// `all_view_bounds`: of each set of tubes; `weights`: with RefinedMesh::weights.
  TrueSurface(const Transmission& transmission, std::span<const TubeSet> tubes,
              std::span<const ViewBounds> all_view_bounds, bool weights = false);

  const FacetMesh& mesh() const;
  /// Of any of the view bounds, by increasing id.
  std::vector<FacetId> facets(std::span<const ViewBounds> all_view_bounds) const;
  /// From facets of this seabed to the scene's.
  void name_by_scene(ApparentSurface& surface_mesh) const;

 private:
  const LoadedScene& loaded_scene_;
  RefinedMesh relief_;
  std::unique_ptr<SceneTree> tree_;  // of the relief
};

/// The facets of a transmission where it sees them, if asked for with RefinedMesh::weights about the scene's
/// facets. Throws InputError where it takes too many.
TransmissionSurface refracted_surface_of(const Transmission& transmission, bool weights = false);

/// What a transmission sees of its seabed, mapped as finely as one likes; facets are named by the seabed.
class TransmissionApparentMap {
 public:
  /// Throws as refracted_surface_of().
  explicit TransmissionApparentMap(const Transmission& transmission, bool weights = false);
  TransmissionApparentMap(const TransmissionApparentMap&) = delete;
  TransmissionApparentMap& operator=(const TransmissionApparentMap&) = delete;
  const TrueSurface& seabed() const { return seabed_; }
  /// Throws as refracted_surface_of().
  ApparentSurface surface_mesh(const ApparentMapSettings& settings) const;

 private:
  const Transmission& transmission_;
  bool weights_;
  TubeSet tubes_;
  ApparentMap apparent_map_;
  ViewBounds view_bounds_;
  TrueSurface seabed_;
  std::vector<FacetId> facets_;
};

/// Throws what is being handled as an InputError with the scene file's words, if it is about a transmission's
/// view through the water; else as it is.
[[noreturn]] void rethrow_as_seen_by(const Transmission& transmission);

/// What paths over mirrors are followed through, of tubes with that reach.
PathWater path_water(const Transmission& transmission, std::size_t sensor, double reach_m);

/// The facets of a transmission where its transmitter and its receiver, apart, see them.
struct RefractedPair {
  TubeSet transmit_tubes, receive_tubes;
  ApparentMap transmit_water, receive_water;
  double absorption_db_per_m;
  ApparentPair apparent;
};
/// What several ends of a transmission see of its seabed, mapped together and as finely as one likes; facets
/// are named by the seabed.
class EndsApparentMap {
 public:
  /// Throws as refracted_surface_of().
  EndsApparentMap(const Transmission& transmission, std::vector<TubeSet> tubes,
                  std::vector<ApparentMap> water, bool weights = false);
  EndsApparentMap(const EndsApparentMap&) = delete;
  EndsApparentMap& operator=(const EndsApparentMap&) = delete;
  const TrueSurface& seabed() const { return *seabed_; }
  const TubeSet& tubes(std::size_t end) const { return tubes_[end]; }
  const ApparentMap& water(std::size_t end) const { return water_[end]; }
  double absorption_db_per_m() const;
  double reach_m() const;
  /// Throws as refracted_surface_of().
  CommonApparentSurfaces surface_meshes(const ApparentMapSettings& settings) const;

 private:
  const Transmission& transmission_;
  bool weights_;
  std::vector<TubeSet> tubes_;
  std::vector<ApparentMap> water_;
  std::vector<ViewBounds> all_view_bounds_;
  std::optional<TrueSurface> seabed_;
  std::vector<FacetId> facets_;
};
/// Of transmitter and receiver.
class PairApparentMap {
 public:
  explicit PairApparentMap(const Transmission& transmission, bool weights = false);
  const TrueSurface& seabed() const { return ends_.seabed(); }
  double reach_m() const { return ends_.reach_m(); }
  RefractedPair pair(const ApparentMapSettings& settings) const;

 private:
  EndsApparentMap ends_;
};
/// As the scene asks for, named by the scene. `weights` as there. Throws as refracted_surface_of().
RefractedPair refracted_pair_of(const Transmission& transmission, bool weights = false);
/// What the two share of it; the same by rays, in portions.
BistaticHistory trace_both(const Transmission& transmission, const RefractedPair& pair);
void trace_rays_of_both(const Transmission& transmission, const RefractedPair& pair,
                        const RaySettings& settings, const std::function<void(const BistaticHistory&)>& take);

/// What a fan's transmitter and the two receivers on its receiver pair share of it, `receiver_pair` being one
/// of refracted_receiver_baselines(): those with the baselines that integrate_receiver_pair_echo() asks for.
ReceiverPairHistory trace_receiver_pair(const Transmission& transmission, const RefractedPair& pair,
                                        std::uint32_t fan, const ReceiverBaseline& receiver_pair);
std::vector<ReceiverBaseline> refracted_receiver_baselines(const Transmission& transmission,
                                                           const RefractedPair& pair);

void add_counts(ApparentMapCounts& counts, const ApparentSurface& surface_mesh,
                const Transmission& transmission);
void add_counts(ApparentMapCounts& counts, const SurfaceCounts& surface_meshes,
                const Transmission& transmission);
void add_counts(ApparentMapCounts& sum, const ApparentMapCounts& more);

/// For stats.json. `reference`: of a run with bounds.
nlohmann::ordered_json refraction_json(const Survey& survey, bool reference, const SimulationStats& stats);
/// What a run has to tell of facets without, or with several, rays.
std::vector<std::string> refraction_warnings(const Survey& survey, bool reference,
                                             const SimulationStats& stats);

}  // namespace tubefoot
