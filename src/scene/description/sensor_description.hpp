// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <concepts>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <typeinfo>
#include <utility>

#include "files/input_error.hpp"
#include "scene/description/sensor_section.hpp"

// What a scene file says of a sensor: what all have, and the keys of its kind. docs/scene-file.md
namespace tubefoot {

/// The keys of a sensor's kind, as a value of the kind's own type. That type says which kind it is of, by a
/// static function `kind()`. Copies share the value.
class SensorKeys {
 public:
  SensorKeys() = default;  ///< of no kind
  template <class Own>
  requires requires {
    { Own::kind() } -> std::convertible_to<const SensorSection&>;
  }
  SensorKeys(Own own)
      : section_(&Own::kind()), type_(&typeid(Own)), own_(std::make_shared<Own>(std::move(own))) {}

  /// Throws std::logic_error where there is none.
  const SensorSection& section() const;
  /// Throws std::logic_error for keys of another type.
  template <class Own>
  const Own& as() const {
    check(typeid(Own));
    return *static_cast<const Own*>(own_.get());
  }
  /// To change them: a value of its own from here on, that copies do not see. Throws as as() does.
  template <class Own>
  Own& edit() {
    if (own_.use_count() != 1) own_ = std::make_shared<Own>(as<Own>());
    check(typeid(Own));
    return *static_cast<Own*>(own_.get());
  }

 private:
  void check(const std::type_info& requested) const;

  const SensorSection* section_ = nullptr;
  const std::type_info* type_ = nullptr;
  std::shared_ptr<void> own_;
};

/// As a section of the scene file fills it (toml_reader.hpp).
template <class Own>
void set_kind(SensorKeys& keys) {
  keys = Own();
}
template <class Own>
Own& kind_as(SensorKeys& keys) {
  return keys.edit<Own>();
}

/// Beam pattern (power) of a transmitter or a receiver.
struct PatternDescription {
  std::string pattern = "none";      ///< none | line | piston | gaussian | table
  std::string angle = "azimuth";     ///< azimuth | elevation | off_axis: what all but piston depend on
  std::optional<double> aperture_m;  ///< line: length; piston: diameter
  std::optional<double> width_deg;   ///< gaussian: full one-way width at -3 dB
  std::optional<std::filesystem::path> file;  ///< table
  SourcePlace file_place;
};

/// What the receiver makes of the echoes in the files that a sonar would write; echoes.nc keeps the energies.
struct SignalDescription {
  double source_level_db = 210;          ///< dB re 1 uPa at 1 m
  std::optional<double> noise_level_db;  ///< dB re 1 uPa in the receiver's band
  std::string speckle = "none";          ///< none | rayleigh | k
  int speckle_looks = 1;
  double speckle_shape = 1;             ///< nu of the K law
  std::optional<double> tvg_spreading;  ///< Sp of the gain Sp log10 R + 2 alpha R + G; none: no gain
  std::optional<double> tvg_absorption_db_per_km;  ///< alpha; else the water's own
  double tvg_gain_db = 0;
  double tvg_fixed_below_m = 10;          ///< nearer than this the gain stays what it is here
  double display_gain_db = 0;             ///< by which pictures are brighter; files keep their values
  std::optional<double> pulse_length_us;  ///< echoes are spread over c tau / 2; none: not spread
};

struct SensorDescription {
  SourcePlace place;
  std::string name;
  std::string preset = "none";  ///< of sensor_presets(); its keys are in here already
  std::string trajectory;       ///< may be empty when the scene has just one
  SourcePlace trajectory_place;
  std::array<double, 3> lever_arm_m{0, 0, 0};  ///< starboard, forward, up from the carrier's reference point
  std::optional<std::array<double, 3>> receiver_arm_m;  ///< of a separate receiver from the transmitter
  double yaw_deg = 0, tilt_deg = 0, roll_deg = 0;       ///< mounting: yaw to starboard, tilt downwards, roll
  std::optional<std::array<double, 3>>
      look_at_m;  ///< east, north, up of what it is turned to, whatever carries it
  double first_ping_s = 0;
  std::optional<int> pings;  ///< else 1; on the lines of a survey, all that fit them
  double ping_interval_s = 0.1;
  /// How far off a beam's height may be, relative, as its cones are cut by planes (angles.hpp).
  double cone_tolerance = 4.5e-5;
  PatternDescription transmit, receive;
  SignalDescription signal;
  SensorKeys kind;  ///< what only sensors of its kind have
};

/// What its kind makes of a sensor's keys.
SensorFigures figures_of(const SensorDescription& sensor);

}  // namespace tubefoot
