// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <atomic>
#include <memory>
#include <vector>

#include "engine/water/water_column.hpp"
#include "geometry/search/scene_tree.hpp"
#include "scene/scene.hpp"
#include "scene/tiled_scene.hpp"
#include "sensors/model/sensor.hpp"

namespace tubefoot {

class Ground;
struct OwnEngine;
class OmittedRelief;
class RayScene;

/// All pings of one sensor: times and poses of the sensor itself.
struct SensorPings {
  std::shared_ptr<const Sensor> sensor;  ///< never null
  std::vector<double> times_s;
  std::vector<Pose> poses;           ///< at the pings' times
  std::vector<Pose> shot_poses;      ///< [ping][shot], each at its own time
  std::vector<Pose> receiver_poses;  ///< [ping][shot], of a receiver that is apart; else empty
  /// At its first place; the scene's, in even water. Travel times times this are slant ranges.
  double sound_speed_m_s = 1500;
  std::shared_ptr<const WaterColumn>
      water;                        ///< with absorption at its frequency; null: even, rays are straight
  std::vector<double> altitudes_m;  ///< above the terrain straight below; not a number where there is none

  const Pose& shot_pose(std::size_t ping, std::size_t shot) const {
    return shot_poses.at(ping * sensor->shots() + shot);
  }
  const Pose& receiver_pose(std::size_t ping, std::size_t shot) const {
    return receiver_poses.empty() ? shot_pose(ping, shot) : receiver_poses.at(ping * sensor->shots() + shot);
  }
};

/// Sensors that fire the same tubes from the same places at the same times: one history serves them all.
struct SharedShots {
  std::vector<std::size_t> sensors;  ///< indices into Survey::sensors
};

/// How relief is in a scene's facets; nothing of it without relief.
struct SurveyRelief {
  double cell_m = 0;                                ///< 0: no relief
  std::size_t base_facets = 0, uniform_facets = 0;  ///< unrefined; textured ones in cells
  std::vector<FacetId> parent;                      ///< offline: by facet of the scene, the unrefined one
  std::shared_ptr<const OmittedRelief> omitted;
};

/// Between a run and somebody who waits for it on another thread, and may stop it (geometry/work/stop.hpp).
struct RunWatch {
  std::atomic<std::size_t> pings{0}, total{0};  ///< finished, and to do
};

/// What was loaded of terrain that is read by tiles.
struct TerrainUse {
  std::atomic<std::size_t> regions{0}, loads{0};  ///< regions that pings are grouped into; loaded, also again
  std::atomic<std::size_t> most_bytes{0};         ///< held at a time
};

/// A loaded scene, its tree, and who pings where. Where terrain is read by tiles (scene.tiled), the scene's
/// mesh has all but that; survey_with_tiles() makes surveys that have some of it.
struct Survey : std::enable_shared_from_this<Survey> {
  explicit Survey(Scene loaded);
  ~Survey();
  Survey(const Survey&) = delete;  // the tree points into the scene
  Survey& operator=(const Survey&) = delete;

  Scene scene;
  SurveyRelief relief;
  std::unique_ptr<const Ground> ground;  ///< relief online: what shots refine, each for itself (ground_of)
  std::unique_ptr<SceneTree> tree;
  double lowest_m = 0;                   ///< of the scene, where water refracts: rays do not turn below
  std::shared_ptr<const RayScene> rays;  ///< for runs of the ray engine that share it; others make their own
  std::vector<SensorPings> sensors;
  std::vector<SharedShots> shots;
  double load_seconds = 0, tree_seconds = 0;
  std::shared_ptr<const OwnEngine> own_engine;  ///< computes echoes in place of a built-in one; else null
  std::shared_ptr<RunWatch> watch;              ///< may be null
  std::shared_ptr<TerrainUse> terrain_use;      ///< null without tiles

  bool is_tiled() const { return !scene.tiled.empty(); }

  /// Tubes of a shot of ping `ping` of a group, with the largest reach of its sensors.
  TubeSet tubes(const SharedShots& group, std::size_t ping, std::size_t shot) const;
  /// The tubes of the receiver of a sensor that has one apart.
  TubeSet receive_tubes(std::size_t sensor, std::size_t ping, std::size_t shot) const;
  std::size_t pings(const SharedShots& group) const { return sensors[group.sensors.front()].times_s.size(); }
  std::size_t shots_a_ping(const SharedShots& group) const {
    return sensors[group.sensors.front()].sensor->shots();
  }
  /// Index of the sensor of that name; throws UsageError naming the nearest ones.
  std::size_t sensor_named(const std::string& name) const;
};

/// Loads the scene, builds the tree, lays out the pings. `arithmetic` and `threads` are the caller's
/// business. Throws InputError: also where a sensor lies below the seabed. Adds warnings to the scene's
/// report.
std::unique_ptr<Survey> open_survey(const SceneDescription& description);

/// A survey of the same pings whose mesh has some tiles, too. The given one need not outlive it. Throws
/// InputError for a raster that can no longer be read.
std::unique_ptr<Survey> survey_with_tiles(const Survey& survey, const TileChoice& choice);

/// dB per metre, one way, for a sensor's frequency in the scene's water.
double absorption_db_per_m(const Scene& scene, const Sensor& sensor);

}  // namespace tubefoot
