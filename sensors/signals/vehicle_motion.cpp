// SPDX-License-Identifier: GPL-3.0-or-later
// Motion of a vehicle during its pings, and two-way paths between its moving places and a point at rest. A
// fixed-point iteration solves time = from + sign |place(t) - point| / c for the unknown end of a path.

#include "sensors/signals/vehicle_motion.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <stdexcept>

namespace tubefoot {
namespace {

// At a hundredth of the sound speed eight steps reach the last bit. No vehicle needs more than a few steps.
constexpr int most_steps = 64;
// Steps this small, or this small relative to the first step, come from the rounding of positions and clocks
// and may never end.
constexpr double rounding_s = 1e-11, rounding_of_first = 1e-3;

/// Solves time = from + sign |place(time) - point| / c.
template <class Place>
double time_at(double from_s, double sign, const Place& place, glm::dvec3 point_m, double sound_speed_m_s) {
  double time_s = from_s + sign * glm::distance(place.at(from_s), point_m) / sound_speed_m_s;
  double change_s = HUGE_VAL, first_change_s = 0;
  for (int step = 0; step < most_steps; ++step) {
    const double next_s = from_s + sign * glm::distance(place.at(time_s), point_m) / sound_speed_m_s;
    const double moved_s = std::abs(next_s - time_s);
    time_s = next_s;
    if (moved_s == 0) return time_s;
    if (step == 0) first_change_s = moved_s;
    if (step > 3 && moved_s >= change_s) {
      if (moved_s < std::max(rounding_s, rounding_of_first * first_change_s)) return time_s;
      break;
    }
    change_s = moved_s;
  }
  throw std::invalid_argument(
      fmt::format("a point of the vehicle moves at {} m/s, as fast as sound, so travel times are undefined: "
                  "reduce the speed of the trajectory",
                  sound_speed_m_s));
}

}  // namespace

VehicleMotion::VehicleMotion(std::vector<Trajectory::Sample> track, std::vector<double> ping_start_s,
                             bool stop_and_hop)
    : samples_(std::move(track)),
      track_(samples_),
      ping_start_s_(std::move(ping_start_s)),
      stop_and_hop_(stop_and_hop) {
  constexpr double off_one = 1e-6;
  for (std::size_t k = 0; k < samples_.size(); ++k) {
    const Pose& pose = samples_[k].pose;
    const double length = glm::length(pose.attitude), way = glm::length(pose.position_m);
    if (!std::isfinite(way) || !(std::abs(length - 1) < off_one))
      throw std::invalid_argument(
          fmt::format("pose {} of the track has a position at a distance of {} m and an attitude of length "
                      "{}: positions must be finite and quaternions must have length 1",
                      k, way, length));
  }
  for (std::size_t ping = 0; ping < ping_start_s_.size(); ++ping) {
    const double start_s = ping_start_s_[ping];
    if (!std::isfinite(start_s) || (ping > 0 && !(start_s > ping_start_s_[ping - 1])))
      throw std::invalid_argument(fmt::format(
          "ping {} starts at {} s, but must start at a finite time after the previous ping", ping, start_s));
    if (!track_.holds(start_s))
      throw std::invalid_argument(
          fmt::format("ping {} starts at {} s, but the track has poses only from {} s to {} s", ping, start_s,
                      track_.begin_s(), track_.end_s()));
    ping_pose_.push_back(track_.at(start_s));
  }
}

Pose VehicleMotion::at(std::size_t ping, double after_start_s) const {
  return stop_and_hop_ ? ping_pose_[ping] : track_.at(ping_start_s_[ping] + after_start_s);
}

void VehicleMotion::check_lasts(double after_start_s) const {
  if (stop_and_hop_ || ping_start_s_.empty() || track_.holds(ping_start_s_.back() + after_start_s)) return;
  throw std::invalid_argument(
      fmt::format("the last ping needs poses until {} s, but the track ends at {} s: lengthen the "
                  "trajectory, or use the stop-and-hop approximation",
                  ping_start_s_.back() + after_start_s, track_.end_s()));
}

PlaceMotion::PlaceMotion(const VehicleMotion& motion, std::size_t ping, glm::dvec3 place_m, double until_s)
    : motion_(&motion), ping_(ping), place_m_(place_m) {
  const Pose& start = motion.ping_pose(ping);
  start_m_ = start.position_m + start.attitude * place_m;
  even_ = motion.stop_and_hop() || motion.track().size() == 1;
  if (even_) return;
  // Tests whether the ping lies in one straight piece of the track, without rotation.
  const std::vector<Trajectory::Sample>& track = motion.track();
  const double start_s = motion.ping_start_s()[ping];
  const auto after =
      std::upper_bound(track.begin() + 1, track.end() - 1, start_s,
                       [](double time, const Trajectory::Sample& s) { return time < s.time_s; });
  const Trajectory::Sample &a = *(after - 1), &b = *after;
  even_ = a.pose.attitude == b.pose.attitude && start_s >= a.time_s && start_s + until_s <= b.time_s;
  if (even_) velocity_m_s_ = (b.pose.position_m - a.pose.position_m) / (b.time_s - a.time_s);
}

glm::dvec3 PlaceMotion::turned(double after_start_s) const {
  // Intermediate guesses of the iteration may lie off the track by their error.
  const double start_s = motion_->ping_start_s()[ping_];
  const Pose pose = motion_->at(ping_, std::clamp(after_start_s, motion_->track().front().time_s - start_s,
                                                  motion_->track().back().time_s - start_s));
  return pose.position_m + pose.attitude * place_m_;
}

TwoWayPath path_emitted_at(double emitted_s, const PlaceMotion& transmitter, glm::dvec3 point_m,
                           const PlaceMotion& receiver, double sound_speed_m_s) {
  TwoWayPath path{emitted_s, 0, glm::distance(transmitter.at(emitted_s), point_m), 0};
  const double there_s = emitted_s + path.tx_m / sound_speed_m_s;
  path.received_s = time_at(there_s, 1, receiver, point_m, sound_speed_m_s);
  path.rx_m = glm::distance(receiver.at(path.received_s), point_m);
  return path;
}

TwoWayPath path_received_at(double received_s, const PlaceMotion& transmitter, glm::dvec3 point_m,
                            const PlaceMotion& receiver, double sound_speed_m_s) {
  TwoWayPath path{0, received_s, 0, glm::distance(receiver.at(received_s), point_m)};
  const double there_s = received_s - path.rx_m / sound_speed_m_s;
  path.emitted_s = time_at(there_s, -1, transmitter, point_m, sound_speed_m_s);
  path.tx_m = glm::distance(transmitter.at(path.emitted_s), point_m);
  return path;
}

}  // namespace tubefoot
