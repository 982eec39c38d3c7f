// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <complex>
#include <glm/geometric.hpp>
#include <span>
#include <vector>

#include "engine/signal/baseband_pulse.hpp"
#include "engine/signal/platform_motion.hpp"

// Computes the echo of a place at rest with moving ends from the exact travel times, without a Doppler
// formula. The travel time fulfils c (t - s) = |x - T(s)| + |x - R(t)| for transmission at s and reception
// at t.

namespace tubefoot {

/// Pulse as moving ends receive it from a place x at rest. The pulse received at t was transmitted at s with
///     c (t - s) = L(t) = |x - T(s)| + |x - R(t)|.
/// The signal is A g(s) e^{ikL(t)}, so the motion itself stretches the pulse and shifts its carrier. Over
/// short parts of a pulse, L(t) is a parabola through three exact path lengths, with an error of at most
/// 1e-9 wavelengths. If a motion is not smooth within a part, the path length of each sample is computed.
class MovingPulse {
 public:
  MovingPulse(const BasebandPulse& pulse, const SignalTimes& times, double carrier_hz,
              double sound_speed_m_s);

  /// Resolution in time.
  struct Steps {
    std::size_t parts = 1;  ///< number of parts of the pulse
    double newton_s = 0;    ///< step of Newton's method after which the remaining error is negligible
  };
  /// For ends that are no faster than these bounds, at places no nearer than `nearest_m`.
  Steps steps_for(const MotionBounds& transmit, const MotionBounds& receive, double nearest_m) const;

  /// Pulse of a transmitter at a place.
  struct Passing {
    const TabulatedMotion* transmit = nullptr;
    std::vector<double> sent_s;      ///< two times per part, and the end
    std::vector<glm::dvec3> from_m;  ///< position of the transmitter at these times
    std::vector<char> smooth;        ///< per part
    glm::dvec3 place_m{0};
    std::vector<double> tx_m, there_s;
  };
  Passing send(const TabulatedMotion& transmit, std::size_t parts) const;
  void pass(glm::dvec3 place_m, Passing& passing) const;

  /// Echo of a point of the pulse.
  struct Echo {
    double time_s = 0, path_m = 0, amplitude = 0;
  };
  /// Adds strength * A g e^{ik(L - less)} to out[sample]. `near_m`: approximate position of the receiver at
  /// that time. `amplitude(from_m, to_m, tx_m, rx_m)`: A for these positions of the ends. `even`: one
  /// amplitude suffices for the whole pulse. `echoes`: buffer.
  template <class Amplitude>
  void add(const Passing& passing, const TabulatedMotion& receive, glm::dvec3 near_m, double newton_s,
           std::complex<double> strength, double less_m, bool even, const Amplitude& amplitude,
           std::vector<Echo>& echoes, std::complex<double>* out) const {
    const std::size_t count = passing.sent_s.size();
    echoes.resize(count);
    double time_s = passing.there_s[0] + glm::distance(near_m, passing.place_m) * per_c_, slope = 1;
    for (std::size_t n = 0; n < count; ++n) {
      if (n > 0) time_s += (passing.there_s[n] - passing.there_s[n - 1]) * slope;
      const Reception received = received_at(passing, n, receive, time_s, newton_s);
      time_s = received.time_s;
      slope = received.slope;
      echoes[n] = {time_s, passing.tx_m[n] + received.rx_m, 0};
      if (!even || n == count / 2)
        echoes[n].amplitude = amplitude(passing.from_m[n], received.to_m, passing.tx_m[n], received.rx_m);
    }
    const AmplitudeOf its{&amplitude,
                          [](const void* of, glm::dvec3 from_m, glm::dvec3 to_m, double tx_m, double rx_m) {
                            return (*static_cast<const Amplitude*>(of))(from_m, to_m, tx_m, rx_m);
                          }};
    add(passing, receive, echoes, strength, less_m, even ? AmplitudeOf{} : its, out);
  }

  double middle_s() const { return (begin_s_ + end_s_) / 2; }
  double half_s() const { return (end_s_ - begin_s_) / 2; }

 private:
  /// Accuracy of times that floating-point arithmetic permits.
  static constexpr double exact_s = 1e-14;
  struct Reception {
    double time_s, rx_m, slope;  ///< slope: derivative of the time of reception by the time at the place
    glm::dvec3 to_m;
  };
  Reception received_at(const Passing& passing, std::size_t n, const TabulatedMotion& receive, double time_s,
                        double newton_s) const {
    constexpr int hopeful_steps = 8, most_steps = 100;
    for (int step = 0;; ++step) {
      const TabulatedMotion::Moment end = receive.at(time_s);
      const glm::dvec3 motion = end.place_m - passing.place_m;
      const double rx = glm::length(motion), rate = glm::dot(motion, end.velocity_m_s) / rx,
                   slope = 1 / (1 - rate * per_c_), off = (time_s - passing.there_s[n] - rx * per_c_) * slope,
                   before_s = time_s;
      time_s -= off;
      // A step across a break of the motion is not a valid Newton step.
      const bool done =
          std::abs(off) <= newton_s &&
          (step > hopeful_steps || receive.is_smooth(std::min(before_s, time_s), std::max(before_s, time_s)));
      if (done || std::abs(off) <= exact_s || step == most_steps)
        return {time_s, rx - rate * off, slope, end.place_m - off * end.velocity_m_s};
    }
  }
  /// Reference to the amplitude function; none: one amplitude for the whole pulse.
  struct AmplitudeOf {
    const void* of = nullptr;
    double (*at)(const void* of, glm::dvec3 from_m, glm::dvec3 to_m, double tx_m, double rx_m) = nullptr;
  };
  void add(const Passing& passing, const TabulatedMotion& receive, std::span<const Echo> echoes,
           std::complex<double> strength, double less_m, const AmplitudeOf& amplitude,
           std::complex<double>* out) const;
  /// Envelope as a function of the transmission time from the begin of the pulse, in cubics.
  std::complex<double> envelope(double place) const {
    const double x_all = std::min(std::max(place, 0.0), last_);
    const auto k = std::min(std::ptrdiff_t(x_all), std::ptrdiff_t(cubics_.size()) - 1);
    const double x = x_all - double(k);
    const auto& c = cubics_[std::size_t(k)];
    return {c[0].real() + x * (c[1].real() + x * (c[2].real() + x * c[3].real())),
            c[0].imag() + x * (c[1].imag() + x * (c[2].imag() + x * c[3].imag()))};
  }

  SignalTimes times_;
  double begin_s_, end_s_, sound_speed_m_s_, per_c_, wavenumber_rad_m_, per_s_ = 0, last_ = 0;
  std::vector<std::array<std::complex<double>, 4>> cubics_;
};

}  // namespace tubefoot
