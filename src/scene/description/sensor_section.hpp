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

/// What a scene has to know of a sensor, whatever its kind.
struct SensorFigures {
  double frequency_khz = 0;
  std::int64_t beams = 1, samples = 1;  ///< of a ping
  std::int64_t transmissions = 1;       ///< of a ping
  double sample_m = 0;                  ///< range that a sample covers
  double beam_deg = 0;                  ///< width of the narrowest beam
  double farthest_m = 0;                ///< range
};

/// A kind of sensor as scene files know it: `kind = "name"` in [[sensors]], and the keys that go with it.
/// What such a sensor does is not the scene's business (sensors/recordings/sensor_kind.hpp).
class SensorSection {
 public:
  explicit SensorSection(std::string name) : name_(std::move(name)) {}
  virtual ~SensorSection() = default;
  SensorSection(const SensorSection&) = delete;  // descriptions point to it
  SensorSection& operator=(const SensorSection&) = delete;

  const std::string& name() const { return name_; }
  /// Adds the kind with its keys: section.kind<Own>("kind", name(), ...).
  virtual void add_keys(TomlSection<SensorDescription>& section) const = 0;
  /// What no single key can tell. Throws InputError at a key's place.
  virtual void check(const SensorDescription&, const TomlTable&) const {}
  /// Whether its beams lie about the sensor's forward axis, so that it can be turned to look at something.
  virtual bool looks_ahead() const { return false; }
  /// Whether it keeps signals with phase, which smooth materials return.
  virtual bool receives_phases() const { return false; }
  virtual SensorFigures figures(const SensorDescription& sensor) const = 0;

 private:
  std::string name_;
};

/// The kinds that a scene file may name.
using SensorSections = std::vector<const SensorSection*>;

}  // namespace tubefoot
