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

namespace tubefoot {

/// A pulse as ends that move receive it of a place x at rest. What is received at t was sent at s,
///     c (t - s) = L(t) = |x - T(s)| + |x - R(t)|,
/// and makes the signal A g(s) e^{ikL(t)}: the pulse is stretched and its carrier shifted as the ways say, by
/// no formula of Doppler's. Over short parts of a pulse L(t) is a parabola through three exact ways, to 1e-9
/// of a wavelength at most; where a way bends meanwhile, each sample's own way is found.
class MovingPulse {
 public:
  MovingPulse(const BasebandPulse& pulse, const SignalTimes& times, double carrier_hz,
              double sound_speed_m_s);

  /// How finely ways are followed.
  struct Steps {
    std::size_t parts = 1;  ///< of the pulse
    double newton_s = 0;    ///< a step of Newton's method after which nothing is left to find
  };
  /// For ends that move no faster than these, at places no nearer than `nearest_m`.
  Steps steps_for(const MotionBounds& transmit, const MotionBounds& receive, double nearest_m) const;

  /// A transmitter's pulse as it passes a place.
  struct Passing {
    const TabulatedMotion* transmit = nullptr;
    std::vector<double> sent_s;      ///< two for a part, and the end
    std::vector<glm::dvec3> from_m;  ///< where the transmitter is then
    std::vector<char> smooth;        ///< by part
    glm::dvec3 place_m{0};
    std::vector<double> tx_m, there_s;
  };
  Passing send(const TabulatedMotion& transmit, std::size_t parts) const;
  void pass(glm::dvec3 place_m, Passing& passing) const;

  /// What comes back of a passing pulse.
  struct Echo {
    double time_s = 0, path_m = 0, amplitude = 0;
  };
  /// Adds strength A g e^{ik(L - less)} to out[sample]. `near_m`: where the receiver is about then.
  /// `amplitude(from_m, to_m, tx_m, rx_m)`: A, the ends being there; `even`: one for all of the pulse will
  /// do. `echoes` is room to work in.
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
  /// A time that is known as well as clocks tell.
  static constexpr double exact_s = 1e-14;
  struct Reception {
    double time_s, rx_m, slope;  ///< slope: of times of hearing by times at the place
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
      // A step that comes over a bend is none of Newton's.
      const bool done =
          std::abs(off) <= newton_s &&
          (step > hopeful_steps || receive.is_smooth(std::min(before_s, time_s), std::max(before_s, time_s)));
      if (done || std::abs(off) <= exact_s || step == most_steps)
        return {time_s, rx - rate * off, slope, end.place_m - off * end.velocity_m_s};
    }
  }
  /// Who can tell the amplitude, ends being where they are; none: it is even.
  struct AmplitudeOf {
    const void* of = nullptr;
    double (*at)(const void* of, glm::dvec3 from_m, glm::dvec3 to_m, double tx_m, double rx_m) = nullptr;
  };
  void add(const Passing& passing, const TabulatedMotion& receive, std::span<const Echo> echoes,
           std::complex<double> strength, double less_m, const AmplitudeOf& amplitude,
           std::complex<double>* out) const;
  /// By the time when it was sent, from the pulse's begin on, in cubics.
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
