// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "engine/paths/path_echo.hpp"
#include "engine/water/apparent_map.hpp"
#include "run/checkpoint/ping_store.hpp"
#include "run/transmission.hpp"

// This header declares the apparent surfaces of sonars in refracting water (docs/environment.md). It contains
// the mapping settings of a run, the surfaces of each transmission, and their counts and warnings.

namespace tubefoot {

struct SimulationStats;

/// Returns the sound speed at the sensor's first position, or the scene's sound speed in isovelocity water.
double sound_speed_at(const Scene& scene, const SensorDescription& sensor, const Trajectory& trajectory);

/// Assigns a water column to each sensor if the water refracts. Throws InputError for a sensor above the
/// surface.
void put_into_water(LoadedScene& loaded_scene, SensorSet& sensor_set);

EigenrayOptions eigenray_options(const LoadedScene& loaded_scene);
/// `transmission`: number of a transmission of the sensor, which has its own frequency and absorption.
ApparentMap apparent_map_of(const LoadedScene& loaded_scene, const SensorPings& pings,
                            std::size_t transmission, glm::dvec3 apex_m);
/// Returns the settings of the apparent-position map that the scene requests.
ApparentMapSettings apparent_map_settings(const Transmission& transmission, double reach_m);

/// The seabed of a transmission at its true position: the scene's facets, or relief as fine as refracted
/// rays need it.
class TrueSurface {
 public:
  /// `all_view_bounds`: one element per set of tubes. `weights`: whether to compute RefinedMesh::weights.
  TrueSurface(const Transmission& transmission, std::span<const TubeSet> tubes,
              std::span<const ViewBounds> all_view_bounds, bool weights = false);

  const FacetMesh& mesh() const;
  /// Returns the facets within any of the view bounds, by increasing id.
  std::vector<FacetId> facets(std::span<const ViewBounds> all_view_bounds) const;
  /// Replaces the parent facets of `surface_mesh`, which belong to this seabed, by facets of the scene.
  void name_by_scene(ApparentSurface& surface_mesh) const;

 private:
  const LoadedScene& loaded_scene_;
  std::optional<TransmissionSurface> surface_;  ///< relief or moving objects; otherwise the loaded scene
};

/// Returns the facets of a transmission at their apparent positions. `weights`: whether to compute
/// RefinedMesh::weights relative to the scene's facets. Throws InputError if there are too many facets.
TransmissionSurface refracted_surface_of(const Transmission& transmission, bool weights = false);

/// The seabed within a transmission's view, which can be mapped with any settings. Parent facets are those
/// of the seabed.
class TransmissionApparentMap {
 public:
  /// Throws the errors of refracted_surface_of().
  explicit TransmissionApparentMap(const Transmission& transmission, bool weights = false);
  TransmissionApparentMap(const TransmissionApparentMap&) = delete;
  TransmissionApparentMap& operator=(const TransmissionApparentMap&) = delete;
  const TrueSurface& seabed() const { return seabed_; }
  /// Throws the errors of refracted_surface_of().
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

/// Throws the current exception as an InputError in the terms of the scene file if it concerns a
/// transmission's view through the water. Throws any other exception unchanged.
[[noreturn]] void rethrow_as_seen_by(const Transmission& transmission);

/// Returns the water that paths over mirrors pass through. `reach_m`: reach of the tubes.
PathWater path_water(const Transmission& transmission, std::size_t sensor, double reach_m);

/// The facets of a transmission at the positions at which its transmitter and its separate receiver see
/// them.
struct RefractedPair {
  TubeSet transmit_tubes, receive_tubes;
  ApparentMap transmit_water, receive_water;
  double absorption_db_per_m;
  ApparentPair apparent;
};
/// The seabed within the views of several ends of a transmission, which can be mapped jointly with any
/// settings. Parent facets are those of the seabed.
class EndsApparentMap {
 public:
  /// Throws the errors of refracted_surface_of().
  EndsApparentMap(const Transmission& transmission, std::vector<TubeSet> tubes,
                  std::vector<ApparentMap> water, bool weights = false);
  EndsApparentMap(const EndsApparentMap&) = delete;
  EndsApparentMap& operator=(const EndsApparentMap&) = delete;
  const TrueSurface& seabed() const { return *seabed_; }
  const TubeSet& tubes(std::size_t end) const { return tubes_[end]; }
  const ApparentMap& water(std::size_t end) const { return water_[end]; }
  double absorption_db_per_m() const;
  double reach_m() const;
  /// Throws the errors of refracted_surface_of().
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
/// The apparent-position map of transmitter and separate receiver.
class PairApparentMap {
 public:
  explicit PairApparentMap(const Transmission& transmission, bool weights = false);
  const TrueSurface& seabed() const { return ends_.seabed(); }
  double reach_m() const { return ends_.reach_m(); }
  const EndsApparentMap& ends() const { return ends_; }
  RefractedPair pair(const ApparentMapSettings& settings) const;

 private:
  EndsApparentMap ends_;
};
/// Returns the refracted pair with the settings of the scene; parent facets are those of the scene.
/// `weights`: whether to compute RefinedMesh::weights. Throws the errors of refracted_surface_of().
RefractedPair refracted_pair_of(const Transmission& transmission, bool weights = false);
/// Returns the common visibility of transmitter and receiver. The second function samples it by rays, in
/// portions.
BistaticHistory trace_both(const Transmission& transmission, const RefractedPair& pair);
void trace_rays_of_both(const Transmission& transmission, const RefractedPair& pair,
                        const RaySettings& settings, const std::function<void(const BistaticHistory&)>& take);

/// Returns the common visibility of a fan's transmitter and the two receivers of its receiver pair.
/// `receiver_pair`: an element of refracted_receiver_baselines(), which have the baselines that
/// integrate_receiver_pair_echo() requires.
ReceiverPairHistory trace_receiver_pair(const Transmission& transmission, const RefractedPair& pair,
                                        std::uint32_t fan, const ReceiverBaseline& receiver_pair);
std::vector<ReceiverBaseline> refracted_receiver_baselines(const Transmission& transmission,
                                                           const RefractedPair& pair);

void add_counts(ApparentMapCounts& counts, const ApparentSurface& surface_mesh,
                const Transmission& transmission);
void add_counts(ApparentMapCounts& counts, const SurfaceCounts& surface_meshes,
                const Transmission& transmission);
void add_counts(ApparentMapCounts& sum, const ApparentMapCounts& more);

/// Returns the entries of stats.json. `reference`: whether the run has bounds.
nlohmann::ordered_json refraction_json(const Survey& survey, bool reference, const SimulationStats& stats);
/// Returns the warnings of a run about facets without rays, or with several rays.
std::vector<std::string> refraction_warnings(const Survey& survey, bool reference,
                                             const SimulationStats& stats);

}  // namespace tubefoot
