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

/// Where the echoes of a file are in the scene that they are of.
struct SensorPlace {
  std::size_t sensor = 0;            ///< of the survey
  std::vector<std::size_t> pings;    ///< by ping of the file: the scene's number
  std::vector<std::uint32_t> beams;  ///< by beam of the file: the sonar's number
};

/// The scene that a reference was computed of, opened.
class SceneAtHand {
 public:
  /// Throws InputError, which names both files, where the reference has another scene's hash, unless
  /// `any_scene`; what the reader should know is added to `notes`.
  SceneAtHand(const SceneDescription& scene, const EchoContents& reference, bool any_scene,
              std::vector<std::string>& notes);

  const Survey& survey() const { return *survey_; }
  /// Throws InputError where the scene has no such sensor, or other pings, beams or samples.
  SensorPlace place_of(const SensorEchoes& echoes) const;

 private:
  std::string scene_, reference_;
  std::unique_ptr<const Survey> survey_;
  bool one_sensor_ = false;  ///< in the reference: its name does not matter
};

}  // namespace tubefoot
