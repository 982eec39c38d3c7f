// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "engine/echo/echo.hpp"
#include "engine/scattering/beam_pattern.hpp"
#include "geometry/numbers/world_grid.hpp"
#include "geometry/tubes/tube.hpp"
#include "scene/description/sensor_description.hpp"
#include "scene/trajectory.hpp"
#include "sensors/signals/signal_model.hpp"

namespace tubefoot {

/// A beam's axis in the sensor's frame, for files and pictures.
struct BeamAxis {
  double azimuth_rad = 0;  ///< clockwise from the sensor's forward axis seen from above (starboard positive)
  double elevation_rad = 0;  ///< above the sensor's horizontal plane
  double azimuth_width_rad = 0,
         elevation_width_rad = 0;  ///< full one-way widths of the ideal rectangular beam
};

/// What a sonar asks of an engine and what it makes of a history. It knows no engine. A kind of sensor is a
/// class derived from this one and what else sensor_kind.hpp asks for.
class Sensor {
 public:
  virtual ~Sensor() = default;

  const SensorDescription& description() const { return description_; }
  double frequency_khz() const { return frequency_khz_; }
  const std::vector<BeamAxis>& beams() const { return beams_; }
  const RangeSamples& samples() const { return samples_; }
  /// What is kept of each beam and sample: 1: its energy; 4: those of the upper and of the lower receiver,
  /// and the real and the imaginary part of the mean product of their signals.
  int channels() const { return has_receiver_pair() ? 4 : 1; }
  /// Of fans with two receivers each, half a baseline above and below the transmitter.
  struct ReceiverPair {
    double baseline_m = 0;  ///< 0: there is no receiver pair, and one receiver
    double tilt_deg = 0;    ///< of the direction that it faces, below the horizontal
  };
  const ReceiverPair& receiver_pair() const { return receiver_pair_; }
  bool has_receiver_pair() const { return receiver_pair_.baseline_m > 0; }
  /// How its elements send and receive, with phase; null: it keeps energies alone.
  const SignalModel* signals() const { return signals_ ? &*signals_ : nullptr; }
  /// Whether the fan of beams is spread across the track and looks down, else in the sensor's horizontal
  /// plane: what pictures of it have to know.
  bool is_across_track() const { return across_track_; }

  /// A ping is one transmission or several (an acoustic camera that fires groups of beams in turn), each from
  /// where the sensor is at its own time.
  std::size_t transmissions() const { return transmissions_.size(); }
  /// When a transmission is fired, seconds after the ping's time.
  double transmission_delay_s(std::size_t transmission) const {
    return transmissions_.at(transmission).delay_s;
  }
  /// The sensor's beams that listen to a transmission. Within the transmission they are numbered in this
  /// order.
  const std::vector<std::uint32_t>& beams_of_transmission(std::size_t transmission) const {
    return transmissions_.at(transmission).beams;
  }
  /// Per tube of `tubes()`: the beam, as the transmission numbers them, that it belongs to.
  const std::vector<std::uint32_t>& beam_of_tube(std::size_t transmission = 0) const {
    return transmissions_.at(transmission).beam_of_tube;
  }

  /// The tubes of a transmission from a pose of the sensor itself (mounting applied). Equal poses give equal
  /// sets.
  TubeSet tubes(const Pose& sensor_pose, const WorldGrid& grid, std::size_t transmission = 0) const;
  /// Whether transmitter or receiver have a pattern; if not, beams are 1 inside their tubes and 0 outside.
  bool has_patterns() const { return transmit_.has_value() || receive_.has_value() || has_receiver_pair(); }
  /// The patterns of a transmission from a pose of the sensor itself, by the transmission's numbers of beams.
  /// A receive pattern is steered to its beam's axis, a transmit pattern to the middle of its fan or, where
  /// the transmission's beams are all sent at once, to each of them, added up. With a receive pattern a beam
  /// receives its whole fan.
  BeamPatterns patterns(const Pose& sensor_pose, double sound_speed_m_s, std::size_t transmission = 0) const;

  /// TubeSet::reach of its tubes: the end of the last sample, in grid units.
  double reach(const WorldGrid& grid) const;
  /// Pose of the sensor for a pose of its carrier: lever arm and mounting applied, or turned to what it looks
  /// at.
  Pose pose_on(const Pose& carrier) const;
  /// Turns the sensor's axes into its carrier's. One that is turned to look at something carries itself.
  glm::dquat mounting() const;
  /// Whether the receiver has a place of its own.
  bool has_separate_receiver() const {
    return description_.receiver_arm_m && *description_.receiver_arm_m != description_.lever_arm_m;
  }
  /// Pose of the receiver for a pose of the carrier; that of the sensor, unless it is apart.
  Pose receiver_pose_on(const Pose& carrier) const;
  /// By tube of a transmission: the fan (one transmission and one receiver) it belongs to.
  std::vector<std::uint32_t> fan_of_tube(std::size_t transmission) const;
  /// Throws InputError at the sensor's place for a beam or a sector of less than narrowest_rad.
  void refuse_narrow() const;
  /// How far the walls of the narrowest beam may be from where they should be, as a part of its width: rays
  /// are integers.
  double wall_rounding() const;
  /// Rounding is then less than a hundredth of the width.
  static constexpr double narrowest_rad = 1e-5 * 3.14159265358979323846 / 180;

 protected:
  explicit Sensor(SensorDescription description);

  /// One transmission, received by the receiver of the beams [first_beam, end_beam).
  struct Fan {
    std::uint32_t first_beam = 0, end_beam = 0, end_tube = 0;  ///< tubes: from the end of the fan before
    glm::dvec3 axis{0, 1, 0};                                  ///< its middle, in the sensor's frame
    glm::dvec3 azimuth{1, 0, 0}, elevation{0, 0, 1};           ///< where the two angles' directions grow
    bool sent_by_beams = false;         ///< the transmit pattern is steered to each beam, else to `axis`
    glm::dvec3 receiver_pair{0, 0, 1};  ///< with a baseline: from its lower to its upper receiver
  };

  struct Transmission {
    double delay_s = 0;
    std::vector<std::uint32_t> beams;  ///< the sensor's; all else counts beams by their place in here
    std::vector<std::uint32_t> beam_of_tube;
    std::vector<AngularGrid> sectors;  ///< in the sensor's frame (x starboard, y forward, z up)
    std::vector<Fan> fans;
  };

  SensorDescription description_;
  double frequency_khz_ = 0;
  std::vector<BeamAxis> beams_;
  RangeSamples samples_;
  ReceiverPair receiver_pair_;
  std::optional<SignalModel> signals_;
  bool across_track_ = false;
  std::vector<Transmission> transmissions_;

 private:
  /// Of both its ends.
  glm::dquat attitude_on(const Pose& carrier) const;
  Directivity directivity(const PatternDescription& pattern, const std::shared_ptr<const PatternTable>& table,
                          const Fan& fan, glm::dvec3 beam_axis, const glm::dmat3& turn,
                          double sound_speed_m_s) const;

  /// Set where there is a pattern; a pointer to its table, if it is one.
  std::optional<std::shared_ptr<const PatternTable>> transmit_, receive_;
};

/// The sensor that a description asks for, of its kind.
std::unique_ptr<Sensor> make_sensor(const SensorDescription& description);

}  // namespace tubefoot
