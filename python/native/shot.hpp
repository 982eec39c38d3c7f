// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <glm/vec3.hpp>
#include <memory>
#include <mutex>
#include <vector>

#include "engine/sight/history.hpp"
#include "run/shot.hpp"

namespace tubefoot::python {

/// A shot as one sensor hears it.
struct HeardShot {
  std::size_t sensor = 0, ping = 0, shot = 0;
};

class NativeShot;

/// What one shot met, with all that its arrays point into.
struct NativeHistory {
  std::shared_ptr<const NativeShot> shot;
  History history;
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
  const ShotGround& ground() const { return shot_.ground(); }
  const TubeSet& tubes() const { return tubes_; }
  const std::vector<glm::dvec3>& vertices_m() const;
  glm::dvec3 apex_m() const { return survey().scene.grid.to_metres(tubes_.apex); }

  /// Visible footprints, measured, by the exact engine in the arithmetic that the scene names.
  std::shared_ptr<NativeHistory> trace() const;

 private:
  const HeardShot which_;
  const Shots shots_;
  const Shot shot_;  ///< whose ground is made already, so that threads may share it
  TubeSet tubes_;
  mutable std::once_flag vertices_made_;
  mutable std::vector<glm::dvec3> vertices_m_;  ///< of ground of its own
};

}  // namespace tubefoot::python
