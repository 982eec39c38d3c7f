// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <glm/vec3.hpp>
#include <memory>
#include <mutex>
#include <vector>

#include "engine/sight/history.hpp"
#include "run/own_engine.hpp"
#include "run/shot_ground.hpp"

namespace tubefoot::python {

/// A scene's vertices in metres, worked out once for all shots that ask.
struct SharedVertices {
  std::once_flag once;
  std::vector<glm::dvec3> points_m;
};

class NativeShot;

/// What one shot met, with all that its arrays point into.
struct NativeHistory {
  std::shared_ptr<const NativeShot> shot;
  History history;
};

/// One shot of one sensor: its ground, its tubes and how it listens.
class NativeShot : public std::enable_shared_from_this<NativeShot> {
 public:
  /// Throws UsageError where there is no such shot.
  NativeShot(std::shared_ptr<const Survey> survey, HeardShot which, std::shared_ptr<SharedVertices> vertices);

  const Survey& survey() const { return *survey_; }
  const HeardShot& which() const { return which_; }
  const SensorPings& pings() const { return survey_->sensors[which_.sensor]; }
  const Sensor& sensor() const { return *pings().sensor; }
  const Pose& pose() const { return pings().shot_pose(which_.ping, which_.shot); }
  const ShotGround& ground() const { return ground_; }
  const TubeSet& tubes() const { return tubes_; }
  const std::vector<glm::dvec3>& vertices_m() const;
  glm::dvec3 apex_m() const { return survey_->scene.grid.to_metres(tubes_.apex); }

  /// Visible footprints, measured, by the exact engine in the arithmetic that the scene names.
  std::shared_ptr<NativeHistory> trace() const;

 private:
  std::shared_ptr<const Survey> survey_;
  HeardShot which_;
  ShotGround ground_;
  TubeSet tubes_;
  std::shared_ptr<SharedVertices> vertices_;
};

}  // namespace tubefoot::python
