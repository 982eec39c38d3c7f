// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace tubefoot {

struct SensorDescription;
struct TomlTable;
template <class S>
class TomlSection;

/// Figures of a sensor that a scene needs, independent of its kind.
struct SensorFigures {
  double frequency_khz = 0;
  std::int64_t beams = 1, samples = 1;  ///< per ping
  std::int64_t transmissions = 1;       ///< per ping
  double sample_m = 0;                  ///< range interval of a sample
  double beam_deg = 0;                  ///< width of the narrowest beam
  double farthest_m = 0;                ///< largest range
};

/// A kind of sensor in scene files: `kind = "name"` in [[sensors]], and its keys. The function of such a
/// sensor is defined elsewhere (sensors/recordings/sensor_kind.hpp).
class SensorSection {
 public:
  explicit SensorSection(std::string name) : name_(std::move(name)) {}
  virtual ~SensorSection() = default;
  SensorSection(const SensorSection&) = delete;  // descriptions point to the object
  SensorSection& operator=(const SensorSection&) = delete;

  const std::string& name() const { return name_; }
  /// Adds the kind with its keys: section.kind<Own>("kind", name(), ...).
  virtual void add_keys(TomlSection<SensorDescription>& section) const = 0;
  /// Checks conditions on several keys. Throws InputError at the place of a key.
  virtual void check(const SensorDescription&, const TomlTable&) const {}
  /// Returns whether the beams lie about the sensor's forward axis, so that the sensor can face a point.
  virtual bool looks_ahead() const { return false; }
  /// Returns whether the sensor records signals with phase, which smooth materials return.
  virtual bool receives_phases() const { return false; }
  virtual SensorFigures figures(const SensorDescription& sensor) const = 0;

 private:
  std::string name_;
};

/// The kinds that a scene file may name.
using SensorSections = std::vector<const SensorSection*>;

}  // namespace tubefoot
