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

// A kind of sensor is one file, kind_<name>.cpp, with its keys in scene files, its model and its output. No
// other file names it. docs/sensors.md explains how to write one.
namespace tubefoot {

class SensorKind : public SensorSection {
 public:
  using SensorSection::SensorSection;

  /// The sensor in water of that sound speed. `notes`, if given, receives messages about requests of the
  /// scene that the sensor cannot satisfy. Throws InputError at the sensor's position in the scene file if
  /// no such sensor exists.
  virtual SensorDescription in_water(SensorDescription sensor, double sound_speed_m_s,
                                     std::vector<std::string>* notes) const;
  /// Throws std::invalid_argument for an invalid sensor.
  virtual std::unique_ptr<Sensor> model(const SensorDescription& sensor) const = 0;

  /// Outline for external engines; empty for a kind that none of them supports.
  virtual std::optional<SonarOutline> outline(const SensorDescription& sensor) const;

  /// Names of all files that write_products() may write, without the name of the sensor and without numbers
  /// of pings and lines. For example, "sonar.nc" is the name of fan-sonar.nc, and "xtf" that of
  /// fan-line-01.xtf. write_products() omits those in RunContext::omitted and computes nothing for them.
  virtual std::vector<std::string> products() const;
  /// Writes the files of such a sonar, pictures included, into `folder`, ping by ping, and returns their
  /// names. Files that cannot be made of this recording are omitted, and `warnings` has the reasons. Throws
  /// std::runtime_error that names the file and the failed operation.
  virtual std::vector<std::filesystem::path> write_products(const std::filesystem::path& folder,
                                                            const Recording& recording, const RunContext& run,
                                                            std::vector<std::string>& warnings) const = 0;
  /// Files that a recording of those poses and times will not have, with reasons, as far as they are known
  /// before echoes exist. The warnings are those of write_products().
  virtual std::vector<std::string> files_left_out(const Recording& recording, const RunContext& run) const;
  /// Expected cost of write_products() for a recording of those poses and times; 0 unless a kind overrides
  /// it.
  virtual WritingCost writing_cost(const Recording& recording, const RunContext& run) const;
};

/// All kinds by name. CMakeLists.txt generates the list from the files.
const SensorSections& sensor_kinds();

/// Throws std::logic_error for a description without a kind.
const SensorKind& kind_of(const SensorDescription& sensor);

/// Calls SensorKind::in_water() of the sensor's kind.
SensorDescription in_water(const SensorDescription& sensor, double sound_speed_m_s,
                           std::vector<std::string>* notes = nullptr);

}  // namespace tubefoot
