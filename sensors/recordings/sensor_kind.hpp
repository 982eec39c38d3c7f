// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "scene/description/sensor_description.hpp"
#include "sensors/recordings/recording.hpp"
#include "sensors/recordings/run_context.hpp"
#include "sensors/recordings/sonar_outline.hpp"
#include "sensors/recordings/writing_cost.hpp"

// A kind of sensor is one file, kind_<name>.cpp: its keys in scene files, its model, what it writes. No other
// file names it; docs/sensors.md says how to write one.
namespace tubefoot {

class SensorKind : public SensorSection {
 public:
  using SensorSection::SensorSection;

  /// The sensor as it is in water of that speed of sound; `notes`, if given, is reported of what the scene
  /// asks for and the sensor has not. Throws InputError at the sensor's place where there is no such sensor.
  virtual SensorDescription in_water(SensorDescription sensor, double sound_speed_m_s,
                                     std::vector<std::string>* notes) const;
  /// Throws std::invalid_argument for what makes no such sensor.
  virtual std::unique_ptr<Sensor> model(const SensorDescription& sensor) const = 0;

  /// Its form, for engines that know others; nothing of a kind that none of them has.
  virtual std::optional<SonarOutline> outline(const SensorDescription& sensor) const;

  /// Writes the files that such a sonar makes, pictures included, into `folder`, ping by ping, and returns
  /// their names. What cannot be made of this recording is left out, and `warnings` says why. Throws
  /// std::runtime_error naming the file and what failed.
  virtual std::vector<std::filesystem::path> write_products(const std::filesystem::path& folder,
                                                            const Recording& recording, const RunContext& run,
                                                            std::vector<std::string>& warnings) const = 0;
  /// Which files a recording of those poses and times will not have, and why, as far as that can be said
  /// before there are echoes: what write_products() says then, as well.
  virtual std::vector<std::string> files_left_out(const Recording& recording, const RunContext& run) const;
  /// What write_products() will take for a recording of those poses and times; nothing, unless a kind says.
  virtual WritingCost writing_cost(const Recording& recording, const RunContext& run) const;
};

/// All kinds there are, by name: CMakeLists.txt makes the list of the files.
const SensorSections& sensor_kinds();

/// Throws std::logic_error for a description of no kind.
const SensorKind& kind_of(const SensorDescription& sensor);

/// SensorKind::in_water() of its kind.
SensorDescription in_water(const SensorDescription& sensor, double sound_speed_m_s,
                           std::vector<std::string>* notes = nullptr);

}  // namespace tubefoot
