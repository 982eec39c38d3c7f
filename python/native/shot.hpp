// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <glm/vec3.hpp>
#include <memory>
#include <mutex>
#include <vector>

#include "engine/sight/path_footprints.hpp"
#include "run/shot_ends.hpp"

namespace tubefoot::python {

/// A shot as one sensor hears it.
struct HeardShot {
  std::size_t sensor = 0, ping = 0, shot = 0;
};

class NativeShot;

/// What one shot met, with all that its arrays point into.
struct NativeHistory {
  std::shared_ptr<const NativeShot> shot;
  FootprintSet footprints;
  std::vector<std::uint32_t> receive_tube;  ///< by footprint: the tube itself, unless the receiver is apart
  std::vector<double> receive_distance_m;   ///< of the receiver from the facet's plane
};

/// One shot of one sensor, where terrain is read by tiles with those that it needs: its ground, its tubes and
/// how it listens.
class NativeShot : public std::enable_shared_from_this<NativeShot> {
 public:
  /// Throws UsageError where there is no such shot.
  NativeShot(const Survey& survey, const RunRequest& request, HeardShot which);

  const Survey& survey() const { return shots_.survey(); }
  const HeardShot& which() const { return which_; }
  const SensorPings& pings() const { return survey().sensors[which_.sensor]; }
  const Sensor& sensor() const { return *pings().sensor; }
  const Pose& pose() const { return shot_.pose(); }
  const Pose& receiver_pose() const { return shot_.receiver_pose(); }
  /// Of facets that both ends see: where the transmitter sees them.
  const FacetMesh& mesh() const { return ends_.shared_mesh(); }
  const ShotEnds& ends() const { return ends_; }
  const TubeSet& tubes() const { return ends_.out().tubes; }
  const TubeSet& receive_tubes() const { return ends_.home().tubes; }
  const std::vector<glm::dvec3>& vertices_m() const;
  glm::dvec3 metres(GridPoint apex) const { return survey().scene.grid.to_metres(apex); }

  /// Visible footprints, measured, by the exact engine in the arithmetic that the scene names; with a
  /// receiver apart, those of both ends.
  std::shared_ptr<NativeHistory> trace() const;

 private:
  const HeardShot which_;
  const Shots shots_;
  const Shot shot_;  ///< whose ground is made already, so that threads may share it
  const ShotEnds ends_;
  mutable std::once_flag vertices_made_;
  mutable std::vector<glm::dvec3> vertices_m_;  ///< of facets of its own
};

}  // namespace tubefoot::python
