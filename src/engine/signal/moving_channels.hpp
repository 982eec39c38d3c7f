// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <complex>
#include <vector>

#include "engine/signal/coherent_signals.hpp"
#include "engine/signal/moving_pulse.hpp"
#include "engine/signal/smooth_pieces.hpp"

namespace tubefoot {

/// The ways of a receiver's channels, each known once however many channels have it, and their pulse.
class MovingEnds {
 public:
  /// Throws std::invalid_argument for ways that are not finite or as fast as sound. `origin_m`: of the
  /// patches.
  MovingEnds(const CoherentReceiver& receiver, glm::dvec3 origin_m);

  /// Some end leaves its place.
  bool move() const { return transmit_bounds_.speed_m_s > 0 || receive_bounds_.speed_m_s > 0; }
  /// Channels without ways: where the ends are in the middle of the pulse (transmit) and of all samples.
  const CoherentReceiver& held() const { return held_; }
  /// How far ends get from there, for all samples together.
  void widen(SignalExtent& extent) const;

 private:
  friend class MovingChannels;

  glm::dvec3 origin_m_;
  CoherentReceiver held_;
  MovingPulse pulse_;
  std::vector<TabulatedMotion> transmit_, receive_;
  std::vector<std::size_t> transmit_of_, receive_of_;  // by channel
  MotionBounds transmit_bounds_, receive_bounds_;
  double half_record_s_;
};

/// All channels, some of which move, on the patch at hand.
class MovingChannels {
 public:
  /// `extent`: of `ends.held()`; `tolerance`: of amplitudes.
  MovingChannels(const MovingEnds& ends, const VisiblePolygons& seen, const EchoModel& model,
                 const SignalExtent& extent, double tolerance);

  /// False where nothing comes back from while there are samples.
  bool look_at(const VisiblePolygon& patch);
  const SurfaceProperties& seabed() const { return on_.front().path().seabed; }
  /// The ends where they are when the patch is received; the first ones are the middle of all.
  const SignalExtent& extent() const { return extent_; }
  /// Adds what all channels receive of a place to out[channel * samples + sample].
  void hear(glm::dvec3 place_m, std::complex<double> strength, double less_m, std::complex<double>* out);

 private:
  const MovingEnds& ends_;
  const VisiblePolygons& seen_;
  const EchoModel& model_;
  SignalExtent extent_;
  double tolerance_;
  std::vector<SignalChannel> placed_;
  std::vector<ChannelOnPolygon> on_;
  std::vector<char> faces_;                    // by channel: some time
  std::vector<MovingPulse::Passing> passing_;  // by transmitter's way
  std::vector<glm::dvec3> near_m_;             // by receiver's way, when the patch is received
  double newton_s_ = 0;
  bool even_ = false;
  std::vector<MovingPulse::Echo> echoes_;
};

}  // namespace tubefoot
