// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <concepts>
#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <typeinfo>
#include <utility>
#include <vector>

#include "files/input_error.hpp"
#include "scene/description/processing_description.hpp"
#include "scene/description/sensor_section.hpp"

// Describes a sensor of a scene file: the keys of all sensors, the keys of its kind, its beam patterns and
// its signal processing. docs/scene-keys.md documents all keys.
namespace tubefoot {

/// The keys of a sensor's kind, as a value of the kind's own type. The static function `kind()` of that
/// type returns the kind. Copies share the value.
class SensorKeys {
 public:
  SensorKeys() = default;  ///< without a kind
  template <class Own>
  requires requires {
    { Own::kind() } -> std::convertible_to<const SensorSection&>;
  }
  SensorKeys(Own own)
      : section_(&Own::kind()), type_(&typeid(Own)), own_(std::make_shared<Own>(std::move(own))) {}

  /// Throws std::logic_error if there is no kind.
  const SensorSection& section() const;
  /// Throws std::logic_error if the keys have another type.
  template <class Own>
  const Own& as() const {
    check(typeid(Own));
    return *static_cast<const Own*>(own_.get());
  }
  /// Returns the keys for changes, which copies do not see. Throws under the same conditions as as().
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

/// Sets the kind. The sections of a scene file call this function (toml_reader.hpp).
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
  std::string pattern = "none";   ///< none | line | piston | gaussian | table
  std::string angle = "azimuth";  ///< azimuth | elevation | off_axis: argument of all patterns except piston
  std::optional<double> aperture_m;  ///< length of a line, diameter of a piston
  double shading = 0;                ///< line: amplitude of the cosine of the weights of its elements
  std::optional<double> width_deg;   ///< gaussian: full one-way width at -3 dB
  std::optional<std::filesystem::path> file;  ///< of a table
  SourcePlace file_place;
};

/// Processing of echoes by the receiver, for received data and files in the formats of sonars. Energies
/// stay as they are.
struct SignalDescription {
  double source_level_db = 210;          ///< dB re 1 uPa at 1 m
  std::optional<double> noise_level_db;  ///< dB re 1 uPa in the receiver's band
  std::string speckle = "none";          ///< none | rayleigh | k
  int speckle_looks = 1;
  double speckle_shape = 1;             ///< nu of the K distribution
  std::optional<double> tvg_spreading;  ///< Sp of the gain Sp log10 R + 2 alpha R + G; if empty, no gain
  std::optional<double> tvg_absorption_db_per_km;  ///< alpha; by default the water's absorption
  double tvg_gain_db = 0;
  double tvg_fixed_below_m = 10;          ///< at shorter range the gain has its value at this range
  double display_gain_db = 0;             ///< increases the brightness of pictures; files keep their values
  std::optional<double> pulse_length_us;  ///< echoes are spread over c tau / 2; if empty, not spread
  std::optional<int> quantisation_bits;   ///< of codes of levels; if empty, levels are not quantised
  double quantisation_bottom_db = 0, quantisation_top_db = 0;  ///< of code 0 and of the largest code
};

struct SensorDescription {
  SourcePlace place;
  std::string name;
  std::string preset = "none";  ///< name in sensor_presets(); its keys are already included
  std::string trajectory;       ///< may be empty if the scene has only one
  SourcePlace trajectory_place;
  std::array<double, 3> lever_arm_m{0, 0, 0};  ///< starboard, forward, up from the carrier's reference point
  std::optional<std::array<double, 3>> receiver_arm_m;  ///< arm of a separate receiver, from the transmitter
  double yaw_deg = 0, tilt_deg = 0, roll_deg = 0;       ///< mounting: yaw to starboard, tilt downwards, roll
  std::optional<std::array<double, 3>>
      look_at_m;  ///< east, north, up of the point that the sensor faces, independent of the carrier
  AssumedMountingDescription assumed;  ///< mounting with which files of the sonar are made
  double first_ping_s = 0;
  std::optional<int> pings;  ///< default 1; on the lines of a survey, all that fit
  double ping_interval_s = 0.1;
  std::vector<double> ping_times_s;  ///< increasing; instead of the three members before it, if not empty
  bool stop_and_hop = true;          ///< the carrier stands still during a ping
  double motion_step_beams = 0.1;    ///< largest change of the receiver's direction within an interval of the
                                     ///< record, in widths of the narrowest beam
  /// Permitted relative error of a beam's height, as planes approximate its cones (angles.hpp).
  double cone_tolerance = 4.5e-5;
  /// sharp: geometrical shadows. fresnel: energies are weighted by the diffraction at silhouette edges.
  std::string shadow = "sharp";
  PatternDescription transmit, receive;
  SignalDescription signal;
  SensorKeys kind;  ///< keys that only sensors of its kind have

  bool has_several_pings() const {
    return ping_times_s.empty() ? pings.value_or(1) > 1 : ping_times_s.size() > 1;
  }
  /// Returns the shortest time between pings.
  double shortest_interval_s() const {
    double shortest_s = ping_times_s.size() > 1 ? std::numeric_limits<double>::infinity() : ping_interval_s;
    for (std::size_t k = 1; k < ping_times_s.size(); ++k)
      shortest_s = std::min(shortest_s, ping_times_s[k] - ping_times_s[k - 1]);
    return shortest_s;
  }
};

/// Returns the figures that the kind of a sensor computes from its keys.
SensorFigures figures_of(const SensorDescription& sensor);

}  // namespace tubefoot
