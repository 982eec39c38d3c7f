// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// The sonar as the engines see it: beams, range samples, transmissions with their tubes and beam patterns,
// and mounting on a carrier. Classes derived from Sensor are the kinds of sensors.

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
  /// Angle of the axis from the plane across the track, towards forward. Azimuth and elevation include it.
  double tilt_rad = 0;
  std::uint32_t sector = 0;  ///< for a sensor with transmit sectors: number of the beam's sector
};

/// Direction of a beam's axis in the sensor's frame.
glm::dvec3 beam_direction(const BeamAxis& axis);

/// Properties of a transmission that differ between the transmit sectors of a sensor.
struct TransmitSector {
  double frequency_khz = 0;
  double tilt_rad = 0;                               ///< of its cone about the forward axis, towards forward
  double first_across_rad = 0, last_across_rad = 0;  ///< borders of its outermost beams, from straight down
  std::optional<double> pulse_length_us{};           ///< empty: that of the sensor
  std::optional<double> absorption_db_per_km{};      ///< one way; empty: that of the water at the frequency
};

/// Pose of a sonar, and the steering of its beams relative to its axes. Steering applies to fans across the
/// track.
struct SteeredPose : Pose {
  SteeredPose() = default;
  SteeredPose(const Pose& pose, double across = 0, double along = 0)  // NOLINT: every pose is one
      : Pose(pose), across_rad(across), along_rad(along) {}

  double across_rad = 0;  ///< added to the angles across the track, positive to starboard
  double along_rad = 0;   ///< added to the angles along the track, positive towards forward

  bool operator==(const SteeredPose& other) const {
    return position_m == other.position_m && attitude == other.attitude && across_rad == other.across_rad &&
           along_rad == other.along_rad;
  }
};

/// Middle of the sector of a transmission in the sensor's frame.
struct SectorAxis {
  double across_rad = 0;  ///< from straight down, positive to starboard
  double along_rad = 0;   ///< positive towards forward
};

/// The requests of a sonar to an engine, and the interpretation of a history. It does not depend on an
/// engine. A kind of sensor is a class derived from this one, with the functions of sensor_kind.hpp.
class Sensor {
 public:
  virtual ~Sensor() = default;

  const SensorDescription& description() const { return description_; }
  double frequency_khz() const { return frequency_khz_; }
  /// Frequency of a transmission. It is that of the sensor unless the sensor has transmit sectors.
  double frequency_khz(std::size_t transmission) const {
    return transmit_sectors_.empty() ? frequency_khz_
                                     : transmit_sectors_.at(transmission / intervals_).frequency_khz;
  }
  /// The transmit sectors. Empty for a sensor whose transmissions all have the properties of the sensor and
  /// no tilt.
  const std::vector<TransmitSector>& transmit_sectors() const { return transmit_sectors_; }
  /// Absorption that the scene sets for a transmission; empty: that of the water at its frequency.
  std::optional<double> own_absorption_db_per_km(std::size_t transmission) const {
    if (transmit_sectors_.empty()) return std::nullopt;
    return transmit_sectors_.at(transmission / intervals_).absorption_db_per_km;
  }
  /// Length of the pulse of a transmit sector; empty: as long as a range bin.
  std::optional<double> pulse_length_us(std::size_t sector) const {
    if (!transmit_sectors_.empty() && transmit_sectors_.at(sector).pulse_length_us)
      return transmit_sectors_[sector].pulse_length_us;
    return description_.signal.pulse_length_us;
  }
  const std::vector<BeamAxis>& beams() const { return beams_; }
  const RangeSamples& samples() const { return samples_; }
  /// The range bins of the sensor that receive a transmission: all of them, unless the receiver moves during
  /// a ping (divide_record()).
  RangeSamples samples(std::size_t transmission) const;
  /// The first transmission of a transmit sector, and the one that receives a range bin.
  std::size_t first_transmission(std::size_t sector) const { return sector * intervals_; }
  std::size_t transmission_receiving(std::size_t sector, std::size_t sample) const;
  /// Number of the first bin that receives a transmission.
  std::size_t first_sample(std::size_t transmission) const {
    return static_cast<std::size_t>(samples_.count) * (transmission % intervals_) / intervals_;
  }
  /// Number of values per beam and sample. One value is the energy. Four values are the energies of the
  /// upper and of the lower receiver, and both parts of the mean complex product of their signals.
  int channels() const { return has_receiver_pair() ? 4 : 1; }
  /// Two receivers per fan, half a baseline above and below the transmitter.
  struct ReceiverPair {
    double baseline_m = 0;  ///< 0: one receiver, no receiver pair
    double tilt_deg = 0;    ///< depression of the direction that the pair faces
  };
  const ReceiverPair& receiver_pair() const { return receiver_pair_; }
  bool has_receiver_pair() const { return receiver_pair_.baseline_m > 0; }
  /// Signal model of the elements, with phase; null for a sensor that records only energies.
  const SignalModel* signals() const { return signals_ ? &*signals_ : nullptr; }
  /// True if the fan of beams is across the track and looks down, false if it is in the sensor's horizontal
  /// plane. Pictures depend on it.
  bool is_across_track() const { return across_track_; }

  /// Motions of the carrier against which beams are steered.
  struct Stabilisation {
    bool roll = false, pitch = false, yaw = false;
    double heading_window_s = 0;  ///< yaw: duration over which the reference heading is averaged
    bool any() const { return roll || pitch || yaw; }
  };
  const Stabilisation& stabilisation() const { return stabilisation_; }
  /// Angles of the middle of the sector of a transmission, across and along the track.
  SectorAxis sector_axis(std::size_t transmission) const { return fired(transmission).axis; }

  /// Number of transmissions per ping. An acoustic camera that fires groups of beams in turn has several.
  /// The pose of each transmission is that at its own time. The intervals of a divided record count as
  /// transmissions.
  std::size_t transmissions() const { return firings() * intervals_; }
  /// The same without the division of the record.
  std::size_t firings() const { return transmissions_.size(); }
  /// Time of a transmission, in seconds after the ping's time.
  double transmission_delay_s(std::size_t transmission) const { return fired(transmission).delay_s; }
  /// The beams of the sensor that receive a transmission. Within the transmission their numbers follow this
  /// order.
  const std::vector<std::uint32_t>& beams_of_transmission(std::size_t transmission) const {
    return fired(transmission).beams;
  }
  /// By tube of `tubes()`: its beam, in the numbering of the transmission.
  const std::vector<std::uint32_t>& beam_of_tube(std::size_t transmission = 0) const {
    return fired(transmission).beam_of_tube;
  }

  /// The tubes of a transmission from a pose of the sensor itself (mounting applied). Equal poses give equal
  /// sets.
  TubeSet tubes(const SteeredPose& sensor_pose, const WorldGrid& grid, std::size_t transmission = 0) const;
  /// The tubes of the transmitter if the receiver is separate. They cover the insonified sector once, while
  /// beams of the receiver may overlap. Their number and order are those of tubes().
  TubeSet transmit_tubes(const SteeredPose& sensor_pose, const WorldGrid& grid,
                         std::size_t transmission = 0) const;
  /// True if transmitter or receiver have a pattern. Otherwise beams are 1 inside their tubes and 0 outside.
  bool has_patterns() const { return transmit_.has_value() || receive_.has_value() || has_receiver_pair(); }
  /// The patterns of a transmission from a pose of the sensor itself, by beam in the numbering of the
  /// transmission. A receive pattern is steered to its beam's axis. A transmit pattern is steered to the
  /// middle of its fan. If the beams of the transmission are sent simultaneously, it is the sum of patterns
  /// steered to each of them. With a receive pattern a beam receives its whole fan.
  BeamPatterns patterns(const SteeredPose& sensor_pose, double sound_speed_m_s,
                        std::size_t transmission = 0) const {
    return patterns(sensor_pose, sensor_pose, sound_speed_m_s, transmission);
  }
  /// The same for a receiver with its own pose.
  BeamPatterns patterns(const SteeredPose& transmitter, const SteeredPose& receiver, double sound_speed_m_s,
                        std::size_t transmission) const;

  /// The end of the last sample, in grid units, as TubeSet::reach: of all transmissions, or of one.
  double reach(const WorldGrid& grid) const { return reach(grid, samples_); }
  double reach(const WorldGrid& grid, std::size_t transmission) const {
    return reach(grid, samples(transmission));
  }
  /// Pose of the sensor for a pose of its carrier, with lever arm and mounting, or turned towards its
  /// target.
  Pose pose_on(const Pose& carrier) const;
  /// Rotation from the sensor's axes to its carrier's. It is the identity for a sensor that is turned
  /// towards a target.
  glm::dquat mounting() const;
  /// True if the receiver has its own pose.
  bool has_separate_receiver() const {
    return receiver_moves() ||
           (description_.receiver_arm_m && *description_.receiver_arm_m != description_.lever_arm_m);
  }
  /// Division of the record of each transmission for a receiver that moves during a ping.
  struct Division {
    int intervals = 1;              ///< of range bins, each a transmission with the same tubes
    double sound_speed_m_s = 1500;  ///< converts ranges to times
    double largest_turn_rad = 0;    ///< largest rotation of the receiver during a record
  };
  /// True after divide_record().
  bool receiver_moves() const { return division_.has_value(); }
  /// Divides the record. The receiver of an interval has the pose of its middle. Throws
  /// std::invalid_argument for more intervals than bins.
  void divide_record(const Division& division);
  /// Time at which the middle of the record of a transmission arrives, in seconds after the ping's time. It
  /// is the time of the transmission, unless the receiver moves.
  double reception_delay_s(std::size_t transmission) const;
  /// Pose of the receiver for a pose of the carrier. It is the sensor's pose unless the receiver is
  /// separate.
  Pose receiver_pose_on(const Pose& carrier) const;
  /// By tube of a transmission: its fan (one transmission and one receiver).
  std::vector<std::uint32_t> fan_of_tube(std::size_t transmission) const;
  /// Throws InputError at the sensor's position in the scene file for a beam or a sector below
  /// narrowest_rad.
  void refuse_narrow() const;
  /// Bound of the rounding of the narrowest beam's walls, as a fraction of its width. It exists because rays
  /// are integers.
  double wall_rounding() const;
  /// At this width rounding is less than a hundredth of the width.
  static constexpr double narrowest_rad = 1e-5 * 3.14159265358979323846 / 180;

 protected:
  explicit Sensor(SensorDescription description);

  /// One transmission, received by the receiver of the beams [first_beam, end_beam).
  struct Fan {
    /// tubes start at the end of the previous fan
    std::uint32_t first_beam = 0, end_beam = 0, end_tube = 0;
    glm::dvec3 axis{0, 1, 0};                         ///< its middle, in the sensor's frame
    glm::dvec3 azimuth{1, 0, 0}, elevation{0, 0, 1};  ///< directions in which the two angles grow
    bool sent_by_beams = false;         ///< the transmit pattern is steered to each beam, otherwise to
                                        ///< `axis`
    glm::dvec3 receiver_pair{0, 0, 1};  ///< with a baseline: direction from its lower to its upper receiver
  };

  struct Transmission {
    double delay_s = 0;
    std::vector<std::uint32_t> beams;  ///< the sensor's beam numbers; all other members use positions in
                                       ///< this list
    std::vector<std::uint32_t> beam_of_tube;
    std::vector<AngularGrid> sectors;  ///< in the sensor's frame (x starboard, y forward, z up)
    /// The sectors of a transmitter whose receiver is separate; empty: those of the receiver.
    std::vector<AngularGrid> transmitter_sectors;
    /// The sectors of both ends if the receiver moves during a ping; empty: as above. The transmitter also
    /// covers Division::largest_turn_rad beyond its outermost cells.
    std::vector<AngularGrid> moving_sectors, moving_transmitter_sectors;
    std::vector<Fan> fans;
    SectorAxis axis;
  };

  SensorDescription description_;
  double frequency_khz_ = 0;
  std::vector<BeamAxis> beams_;
  RangeSamples samples_;
  ReceiverPair receiver_pair_;
  std::optional<SignalModel> signals_;
  bool across_track_ = false;
  Stabilisation stabilisation_;
  std::vector<Transmission> transmissions_;       ///< one per firing
  std::vector<TransmitSector> transmit_sectors_;  ///< see transmit_sectors()

 private:
  /// The firing to which a transmission belongs.
  const Transmission& fired(std::size_t transmission) const {
    return transmissions_.at(transmission / intervals_);
  }
  double reach(const WorldGrid& grid, const RangeSamples& samples) const;
  TubeSet tubes_of(const std::vector<AngularGrid>& sectors, const SteeredPose& pose, const WorldGrid& grid,
                   std::size_t transmission) const;
  /// Attitude of both ends.
  glm::dquat attitude_on(const Pose& carrier) const;
  Directivity directivity(const PatternDescription& pattern, const std::shared_ptr<const PatternTable>& table,
                          const Fan& fan, glm::dvec3 beam_axis, const glm::dmat3& turn,
                          double wavelength_m) const;

  std::optional<Division> division_;
  std::size_t intervals_ = 1;  ///< Division::intervals
  /// Set if there is a pattern; a pointer to its table, if the pattern has one.
  std::optional<std::shared_ptr<const PatternTable>> transmit_, receive_;
};

/// Creates the sensor of a description, of its kind.
std::unique_ptr<Sensor> make_sensor(const SensorDescription& description);

}  // namespace tubefoot
