// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <complex>
#include <vector>

#include "engine/signal/coherent_signals.hpp"
#include "engine/signal/moving_pulse.hpp"
#include "engine/signal/smooth_pieces.hpp"

namespace tubefoot {

/// Motions of the ends of a receiver's channels, each stored once, and the pulse of the receiver.
class MovingEnds {
 public:
  /// Throws std::invalid_argument for motions that are not finite or not slower than sound. `origin_m`:
  /// origin of the visible polygons.
  MovingEnds(const CoherentReceiver& receiver, glm::dvec3 origin_m);

  /// Whether an end moves.
  bool move() const { return transmit_bounds_.speed_m_s > 0 || receive_bounds_.speed_m_s > 0; }
  /// Channels without motions. The transmitters are at their positions in the middle of the pulse, and the
  /// receivers at those in the middle of all samples.
  const CoherentReceiver& held() const { return held_; }
  /// Extends an extent by the distances that the ends move from there, over all samples.
  void widen(SignalExtent& extent) const;

 private:
  friend class MovingChannels;

  glm::dvec3 origin_m_;
  CoherentReceiver held_;
  MovingPulse pulse_;
  std::vector<TabulatedMotion> transmit_, receive_;
  std::vector<std::size_t> transmit_of_, receive_of_;  // per channel
  MotionBounds transmit_bounds_, receive_bounds_;
  double half_record_s_;
};

/// Channels with moving ends, on the current visible polygon.
class MovingChannels {
 public:
  /// `extent`: extent of `ends.held()`. `tolerance`: error of amplitudes.
  MovingChannels(const MovingEnds& ends, const VisiblePolygons& seen, const EchoModel& model,
                 const SignalExtent& extent, double tolerance);

  /// Selects a polygon. Returns false if its echo does not arrive during the samples.
  bool look_at(const VisiblePolygon& patch);
  const SurfaceProperties& seabed() const { return on_.front().path().seabed; }
  /// Positions of the ends when the echo of the polygon arrives. The first ones are the midpoints.
  const SignalExtent& extent() const { return extent_; }
  /// Adds the echo of a place in all channels to out[channel * samples + sample].
  void hear(glm::dvec3 place_m, std::complex<double> strength, double less_m, std::complex<double>* out);

 private:
  const MovingEnds& ends_;
  const VisiblePolygons& seen_;
  const EchoModel& model_;
  SignalExtent extent_;
  double tolerance_;
  std::vector<SignalChannel> placed_;
  std::vector<ChannelOnPolygon> on_;
  std::vector<char> faces_;                    // per channel: faces the polygon at some time
  std::vector<MovingPulse::Passing> passing_;  // per transmitter motion
  std::vector<glm::dvec3> near_m_;             // per receiver motion, at the arrival of the polygon's echo
  double newton_s_ = 0;
  bool even_ = false;
  std::vector<MovingPulse::Echo> echoes_;
};

}  // namespace tubefoot
