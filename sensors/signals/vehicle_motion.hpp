// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <glm/vec3.hpp>
#include <optional>
#include <vector>

#include "scene/trajectory.hpp"

namespace tubefoot {

/// Where a vehicle is at any time of its pings. With stop-and-hop it stands still from a ping's start to the
/// next one's; without, it moves while sound is in progress.
class VehicleMotion {
 public:
  /// A track as Trajectory has it (one sample: at rest), on whose clock the pings start. Throws
  /// std::invalid_argument where a start is not finite, not after the one before, or off the track.
  VehicleMotion(std::vector<Trajectory::Sample> track, std::vector<double> ping_start_s,
                bool stop_and_hop = true);

  std::size_t pings() const { return ping_start_s_.size(); }
  const std::vector<double>& ping_start_s() const { return ping_start_s_; }
  const std::vector<Trajectory::Sample>& track() const { return samples_; }
  bool stop_and_hop() const { return stop_and_hop_; }
  /// At its start.
  const Pose& ping_pose(std::size_t ping) const { return ping_pose_[ping]; }
  /// Some time after its start. Throws std::out_of_range beyond the track's end.
  Pose at(std::size_t ping, double after_start_s) const;
  /// Throws std::invalid_argument unless the track goes on for so long after every ping's start.
  void check_lasts(double after_start_s) const;

 private:
  std::vector<Trajectory::Sample> samples_;
  Trajectory track_;
  std::vector<double> ping_start_s_;
  std::vector<Pose> ping_pose_;
  bool stop_and_hop_;
};

/// Way of one place on the vehicle during a ping [m, the scene's frame], by the time after the ping's start.
class PlaceMotion {
 public:
  /// `until_s`: the latest time that will be asked for; VehicleMotion::check_lasts() has looked at it.
  PlaceMotion(const VehicleMotion& motion, std::size_t ping, glm::dvec3 place_m, double until_s);
  glm::dvec3 at(double after_start_s) const {
    return even_ ? start_m_ + velocity_m_s_ * after_start_s : turned(after_start_s);
  }

 private:
  glm::dvec3 turned(double after_start_s) const;

  const VehicleMotion* motion_;
  std::size_t ping_;
  glm::dvec3 place_m_, start_m_, velocity_m_s_{0};
  bool even_;  ///< at rest, or straight on without a turn until then
};

/// A way of sound from a transmitter by a point at rest to a receiver.
struct TwoWayPath {
  double emitted_s = 0, received_s = 0;  ///< after the ping's start
  double tx_m = 0, rx_m = 0;             ///< from where it was emitted, to where it is received

  double delay_s() const { return received_s - emitted_s; }
};

/// Exact, to the rounding of doubles, for places that move: each end is where it is when sound leaves it or
/// reaches it. The end that is asked for is found by fixed-point iteration, which gains a factor of speed
/// over sound speed a step. Throws std::invalid_argument for a place as fast as sound.
TwoWayPath path_emitted_at(double emitted_s, const PlaceMotion& transmitter, glm::dvec3 point_m,
                           const PlaceMotion& receiver, double sound_speed_m_s);
TwoWayPath path_received_at(double received_s, const PlaceMotion& transmitter, glm::dvec3 point_m,
                            const PlaceMotion& receiver, double sound_speed_m_s);

}  // namespace tubefoot
