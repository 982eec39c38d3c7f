// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "run/survey.hpp"
#include "scene/description/scene_description.hpp"
#include "sensors/recordings/echo_reader.hpp"

namespace tubefoot {

/// Sensor, pings and beams of the scene to which the echoes of a file belong.
struct SensorPlace {
  std::size_t sensor = 0;            ///< index in the survey
  std::vector<std::size_t> pings;    ///< number in the scene of each ping of the file
  std::vector<std::uint32_t> beams;  ///< number in the sonar of each beam of the file
};

/// The open scene from which a reference was computed.
class SceneAtHand {
 public:
  /// Throws InputError, which names both files, if the hash of the scene differs from that of the
  /// reference, unless `any_scene` is set. Adds remarks for the user to `notes`.
  SceneAtHand(const SceneDescription& scene, const EchoContents& reference, bool any_scene,
              std::vector<std::string>& notes);

  const Survey& survey() const { return *survey_; }
  /// Throws InputError if the scene lacks the sensor, or if its pings, beams or samples differ.
  SensorPlace place_of(const SensorEchoes& echoes) const;

 private:
  std::string scene_, reference_;
  std::unique_ptr<const Survey> survey_;
  bool one_sensor_ = false;  ///< the reference has a single sensor, whose name is not compared
};

}  // namespace tubefoot
