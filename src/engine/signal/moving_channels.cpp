// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/signal/moving_channels.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "engine/echo/quadratures.hpp"

// Evaluates channels with moving ends on visible polygons. Each echo has the exact travel times of its own
// points in time (MovingPulse). The extent for cutting polygons takes the ends' positions while the echo
// arrives. Source: docs/notes/signals.md.

namespace tubefoot {
namespace {

/// Error of tabulated motions, in wavelengths.
constexpr double way_tolerance = 1e-10;
/// Largest speed relative to the sound speed. Close to 1, times of reception cannot be computed.
constexpr double as_fast_as_sound = 0.99;
/// Smallest range for the choice of time steps.
constexpr double nearest_of_all_m = 1e-3;

std::size_t known(std::vector<TabulatedMotion>& motions, TabulatedMotion motion) {
  const auto same = std::find(motions.begin(), motions.end(), motion);
  if (same != motions.end()) return std::size_t(same - motions.begin());
  motions.push_back(std::move(motion));
  return motions.size() - 1;
}

/// Lists the middle of the bounding box first, then all places.
void list_ends(const std::vector<glm::dvec3>& places, glm::dvec3 origin_m, std::vector<glm::dvec3>& ends) {
  glm::dvec3 low = places[0], high = low;
  for (const glm::dvec3& place : places) {
    low = glm::min(low, place);
    high = glm::max(high, place);
  }
  ends.assign(1, origin_m + (low + high) / 2.0);
  for (const glm::dvec3& place : places) ends.push_back(origin_m + place);
}

}  // namespace

MovingEnds::MovingEnds(const CoherentReceiver& receiver, glm::dvec3 origin_m)
    : origin_m_(origin_m),
      held_(receiver),
      pulse_(receiver.pulse, receiver.times, receiver.carrier_hz, receiver.sound_speed_m_s),
      half_record_s_(double(receiver.times.count) / receiver.times.rate_hz / 2) {
  const double c = receiver.sound_speed_m_s, first_s = receiver.times.first_s,
               tolerance_m = way_tolerance * c / receiver.carrier_hz;
  for (std::size_t k = 0; k < held_.channels.size(); ++k) {
    SignalChannel& channel = held_.channels[k];
    const auto take = [&](PlatformMotion& motion, glm::dvec3& place, double begin_s, double end_s,
                          const char* end, std::vector<TabulatedMotion>& motions, MotionBounds& bounds) {
      if (motion == nullptr) return known(motions, TabulatedMotion(place - origin_m));
      TabulatedMotion table(motion, begin_s, end_s, origin_m, tolerance_m, as_fast_as_sound * c,
                            fmt::format("the {} of channel {}", end, k));
      bounds.widen(table.bounds());
      place = motion((begin_s + end_s) / 2);
      motion = nullptr;
      return known(motions, std::move(table));
    };
    transmit_of_.push_back(take(channel.transmit_motion, channel.transmit_m, receiver.pulse.begin_s,
                                receiver.pulse.end_s, "transmitter", transmit_, transmit_bounds_));
    receive_of_.push_back(take(channel.receive_motion, channel.receive_m, first_s,
                               first_s + 2 * half_record_s_, "receiver", receive_, receive_bounds_));
  }
}

void MovingEnds::widen(SignalExtent& extent) const {
  extent.moved_m =
      std::max(transmit_bounds_.speed_m_s * pulse_.half_s(), receive_bounds_.speed_m_s * half_record_s_);
  extent.speed_share = transmit_bounds_.speed_m_s / (held_.sound_speed_m_s - transmit_bounds_.speed_m_s);
}

MovingChannels::MovingChannels(const MovingEnds& ends, const VisiblePolygons& seen, const EchoModel& model,
                               const SignalExtent& extent, double tolerance)
    : ends_(ends),
      seen_(seen),
      model_(model),
      extent_(extent),
      tolerance_(tolerance),
      placed_(ends.held_.channels),
      faces_(placed_.size()) {
  ends_.widen(extent_);
}

bool MovingChannels::look_at(const VisiblePolygon& patch) {
  const MovingPulse& pulse = ends_.pulse_;
  const SignalTimes& times = ends_.held_.times;
  const double c = ends_.held_.sound_speed_m_s, v_tx = ends_.transmit_bounds_.speed_m_s,
               v_rx = ends_.receive_bounds_.speed_m_s, beta = std::max(v_tx, v_rx) / c,
               stretch = (1 + beta) / (1 - beta);
  glm::dvec3 centre(0);
  const auto corners = seen_.corners(patch);
  for (const glm::dvec3& corner : corners) centre += corner / double(corners.size());
  double radius = 0;
  for (const glm::dvec3& corner : corners) radius = std::max(radius, glm::distance(corner, centre));

  // Positions of the ends when the middle of the pulse is at the centre. The echo of the polygon arrives
  // within half_s before or after the echo of the centre.
  std::vector<glm::dvec3> senders;
  std::vector<glm::dvec3>& receivers = near_m_;
  receivers.clear();
  double spread = 0;
  for (const TabulatedMotion& motion : ends_.transmit_) {
    senders.push_back(motion.at(pulse.middle_s()).place_m);
    spread = std::max(spread, glm::distance(senders.back(), senders.front()));
  }
  const double there_s = pulse.middle_s() + glm::distance(senders[0], centre) / c,
               half_s = (pulse.half_s() + (2 * radius + spread) / c) * stretch;
  bool in_time = false;
  for (std::size_t w = 0; w < ends_.receive_.size(); ++w) {
    double time_s = there_s;
    for (int step = 0; step < 8; ++step)
      time_s = there_s + glm::distance(ends_.receive_[w].at(time_s).place_m, centre) / c;
    receivers.push_back(ends_.receive_[w].at(time_s).place_m);
    in_time = in_time || (time_s + half_s >= times.first_s && time_s - half_s <= times.time_s(times.count));
  }
  if (!in_time) return false;
  list_ends(senders, seen_.origin_m, extent_.transmit_m);
  list_ends(receivers, seen_.origin_m, extent_.receive_m);
  extent_.moved_m = std::max(v_tx * pulse.half_s(), v_rx * half_s);

  on_.clear();
  bool any = false;
  for (std::size_t k = 0; k < placed_.size(); ++k) {
    const glm::dvec3 &from = senders[ends_.transmit_of_[k]], &to = receivers[ends_.receive_of_[k]];
    placed_[k].transmit_m = seen_.origin_m + from;
    placed_[k].receive_m = seen_.origin_m + to;
    on_.emplace_back(placed_[k], seen_, patch, model_);
    faces_[k] = patch.distance_m + glm::dot(patch.normal, from) + extent_.moved_m > 0 &&
                patch.distance_m + glm::dot(patch.normal, to) + extent_.moved_m > 0;
    any = any || faces_[k];
  }
  if (!any || is_silent(seabed())) return false;

  double nearest = HUGE_VAL;
  for (const auto* ends : {&senders, &receivers})
    for (const glm::dvec3& end : *ends)
      nearest = std::min(nearest, std::max(glm::distance(end, centre) - radius,
                                           patch.distance_m + glm::dot(patch.normal, end)));
  nearest = std::max(nearest - extent_.moved_m, nearest_of_all_m);
  const MovingPulse::Steps steps = pulse.steps_for(ends_.transmit_bounds_, ends_.receive_bounds_, nearest);
  newton_s_ = steps.newton_s;
  passing_.clear();
  for (const TabulatedMotion& motion : ends_.transmit_) passing_.push_back(pulse.send(motion, steps.parts));
  even_ = (amplitude_rad + extent_.pattern_rad) * std::max(v_tx, v_rx) * pulse.half_s() * stretch <=
          tolerance_ / 4 * nearest;
  return true;
}

void MovingChannels::hear(glm::dvec3 place_m, std::complex<double> strength, double less_m,
                          std::complex<double>* tx) {
  for (MovingPulse::Passing& passing : passing_) ends_.pulse_.pass(place_m, passing);
  for (std::size_t k = 0; k < on_.size(); ++k) {
    if (!faces_[k]) continue;
    const std::size_t w = ends_.receive_of_[k];
    ends_.pulse_.add(
        passing_[ends_.transmit_of_[k]], ends_.receive_[w], near_m_[w], newton_s_, strength, less_m, even_,
        [&](glm::dvec3 from_m, glm::dvec3 to_m, double tx_m, double rx_m) {
          return on_[k].amplitude_from(place_m, from_m, to_m, tx_m, rx_m);
        },
        echoes_, tx + k * ends_.held_.times.count);
  }
}

}  // namespace tubefoot
