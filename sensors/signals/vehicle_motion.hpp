// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <glm/vec3.hpp>
#include <optional>
#include <vector>

#include "scene/trajectory.hpp"

namespace tubefoot {

/// Pose of a vehicle at any time of its pings. With stop-and-hop it stands still from a ping's start to the
/// next one's. Otherwise it moves during propagation.
class VehicleMotion {
 public:
  /// A track in the form of Trajectory (one sample: at rest); the starts of the pings are on its clock.
  /// Throws std::invalid_argument if a start is not finite, not after the previous one, or off the track.
  VehicleMotion(std::vector<Trajectory::Sample> track, std::vector<double> ping_start_s,
                bool stop_and_hop = true);

  std::size_t pings() const { return ping_start_s_.size(); }
  const std::vector<double>& ping_start_s() const { return ping_start_s_; }
  const std::vector<Trajectory::Sample>& track() const { return samples_; }
  bool stop_and_hop() const { return stop_and_hop_; }
  /// Pose at the start of a ping.
  const Pose& ping_pose(std::size_t ping) const { return ping_pose_[ping]; }
  /// Pose some time after the start of a ping. Throws std::out_of_range beyond the track's end.
  Pose at(std::size_t ping, double after_start_s) const;
  /// Throws std::invalid_argument unless the track continues for this time after every ping's start.
  void check_lasts(double after_start_s) const;

 private:
  std::vector<Trajectory::Sample> samples_;
  Trajectory track_;
  std::vector<double> ping_start_s_;
  std::vector<Pose> ping_pose_;
  bool stop_and_hop_;
};

/// Motion of one place on the vehicle during a ping [m, the scene's frame], as a function of the time after
/// the ping's start.
class PlaceMotion {
 public:
  /// `until_s` is the latest time of a query; VehicleMotion::check_lasts() must have accepted it.
  PlaceMotion(const VehicleMotion& motion, std::size_t ping, glm::dvec3 place_m, double until_s);
  glm::dvec3 at(double after_start_s) const {
    return even_ ? start_m_ + velocity_m_s_ * after_start_s : turned(after_start_s);
  }

 private:
  glm::dvec3 turned(double after_start_s) const;

  const VehicleMotion* motion_;
  std::size_t ping_;
  glm::dvec3 place_m_, start_m_, velocity_m_s_{0};
  bool even_;  ///< at rest, or in straight motion without rotation until then
};

/// A path of sound from a transmitter via a point at rest to a receiver.
struct TwoWayPath {
  double emitted_s = 0, received_s = 0;  ///< after the ping's start
  double tx_m = 0, rx_m = 0;             ///< transmit leg from the position of emission; receive leg to the
                                         ///< position of reception

  double delay_s() const { return received_s - emitted_s; }
};

/// Paths between moving places, exact to the rounding of doubles: each end has its position at the moment of
/// emission or reception. A fixed-point iteration finds the unknown end; each step reduces the error by the
/// ratio of speed to sound speed. Throws std::invalid_argument for a place as fast as sound.
TwoWayPath path_emitted_at(double emitted_s, const PlaceMotion& transmitter, glm::dvec3 point_m,
                           const PlaceMotion& receiver, double sound_speed_m_s);
TwoWayPath path_received_at(double received_s, const PlaceMotion& transmitter, glm::dvec3 point_m,
                            const PlaceMotion& receiver, double sound_speed_m_s);

}  // namespace tubefoot
