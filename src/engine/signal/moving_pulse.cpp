// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/signal/moving_pulse.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

// Solves the travel-time equation of moving ends by Newton's method, and interpolates path lengths over
// parts of a pulse by parabolas. The envelope is a table of cubics. Source: docs/notes/signals.md.

namespace tubefoot {
namespace {

/// Interpolation by cubics leaves the error 0.0234 (pi / 48)^4 = 4e-7 at the highest frequency of the
/// sampling rate. The error at other frequencies is smaller.
constexpr double cubics_per_sample = 48;
/// Relative to the height of the pulse, next to the ends of its flanks.
constexpr double break_error = 1e-6, most_cubics = 1e6;
constexpr double off_wavelengths = 1e-9;
constexpr std::size_t most_parts = 1 << 14;
/// Number of samples over which phase factors are multiplied up before their rounding errors are reset.
constexpr std::size_t turns_together = 64;
constexpr int most_steps = 100;

/// e^{ix}, by a series for small x.
std::complex<double> turn(double x) {
  if (std::abs(x) > 1.0 / 16) return std::polar(1.0, x);
  const double y = x * x;
  return {1 - y / 2 * (1 - y / 12 * (1 - y / 30 * (1 - y / 56))),
          x * (1 - y / 6 * (1 - y / 20 * (1 - y / 42 * (1 - y / 72))))};
}

std::complex<double> product(std::complex<double> a, std::complex<double> b) {
  return {a.real() * b.real() - a.imag() * b.imag(), a.real() * b.imag() + a.imag() * b.real()};
}

/// Parabola through three values at given times.
struct Parabola {
  double at_0, time_0, time_1, slope, bend;
  Parabola(const double (&time)[3], const double (&per)[3], double v0, double v1, double v2)
      : at_0(v0), time_0(time[0]), time_1(time[1]), slope((v1 - v0) * per[0]) {
    bend = ((v2 - v1) * per[1] - slope) * per[2];
  }
  double at(double t) const { return at_0 + (t - time_0) * (slope + (t - time_1) * bend); }
  double slope_at(double t) const { return slope + (2 * t - time_0 - time_1) * bend; }
};

}  // namespace

MovingPulse::MovingPulse(const BasebandPulse& pulse, const SignalTimes& times, double carrier_hz,
                         double sound_speed_m_s)
    : times_(times),
      begin_s_(pulse.begin_s),
      end_s_(pulse.end_s),
      sound_speed_m_s_(sound_speed_m_s),
      per_c_(1 / sound_speed_m_s),
      wavenumber_rad_m_(2 * std::numbers::pi * carrier_hz / sound_speed_m_s) {
  // The last cubic ends with the pulse, so that the pulse may jump there.
  const double length_s = end_s_ - begin_s_;
  double cubics = length_s * times.rate_hz * cubics_per_sample;
  // The error of a cubic that contains a break is that of the break over the cubic's length.
  const double peak = std::abs(pulse.at(pulse.begin_s + length_s / 2));
  for (const PulseBreak& at : pulse.breaks)
    if (peak > 0)
      cubics = std::max(cubics,
                        std::min(length_s * std::sqrt(at.bend_per_s2 / (break_error * peak)), most_cubics));
  const auto count = std::max<std::size_t>(4, std::size_t(std::ceil(cubics)));
  per_s_ = double(count) / length_s;
  last_ = double(count);
  std::vector<std::complex<double>> value;
  for (std::size_t k = 0; k <= count; ++k)
    value.push_back(pulse.envelope(std::min(begin_s_ + double(k) / per_s_, end_s_)));
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t first = std::clamp<std::size_t>(k, 1, count - 2) - 1;
    const std::complex<double>* v = &value[first];
    // Newton's form from the first value, shifted to the begin of the cubic.
    const auto d1 = v[1] - v[0], d2 = (v[2] - 2.0 * v[1] + v[0]) / 2.0,
               d3 = (v[3] - 3.0 * v[2] + 3.0 * v[1] - v[0]) / 6.0;
    const double o = double(k) - double(first);
    cubics_.push_back(
        {v[k - first], d1 + d2 * (2 * o - 1) + d3 * (3 * o * o - 6 * o + 2), d2 + d3 * (3 * o - 3), d3});
  }
}

MovingPulse::Steps MovingPulse::steps_for(const MotionBounds& transmit, const MotionBounds& receive,
                                          double nearest_m) const {
  const double c = sound_speed_m_s_, wavelength = 2 * std::numbers::pi / wavenumber_rad_m_;
  // Bounds of the second and third time derivative of a range.
  const auto second = [&](const MotionBounds& motion) {
    return motion.speed_m_s * motion.speed_m_s / nearest_m + motion.acceleration_m_s2;
  };
  const auto third = [&](const MotionBounds& motion) {
    const double v = motion.speed_m_s;
    return 1.2 * v * v * v / (nearest_m * nearest_m) + 3 * v * motion.acceleration_m_s2 / nearest_m +
           motion.jerk_m_s3;
  };
  const double beta = std::max(transmit.speed_m_s, receive.speed_m_s) / c, stretch = (1 + beta) / (1 - beta),
               tx = second(transmit), rx = second(receive);
  const double of_path = (third(transmit) * stretch * stretch * stretch + third(receive) +
                          3 * tx * stretch * (tx * stretch * stretch + rx) / (c * (1 - beta))) /
                         (1 - beta);
  Steps steps;
  // A parabola through both ends and the middle leaves the error |u (u^2 - h^2)| / 6 <= 0.0642 h^3 times the
  // third derivative.
  if (of_path > 0) {
    const double longest = std::cbrt(off_wavelengths * wavelength / (0.0642 * of_path));
    const double parts = std::ceil(half_s() * stretch / longest);
    steps.parts = std::size_t(std::clamp(parts, 1.0, double(most_parts)));
  }
  steps.newton_s = rx > 0 ? std::sqrt(2 * 0.1 * off_wavelengths * wavelength / rx) : HUGE_VAL;
  return steps;
}

MovingPulse::Passing MovingPulse::send(const TabulatedMotion& transmit, std::size_t parts) const {
  Passing passing;
  passing.transmit = &transmit;
  for (std::size_t n = 0; n <= 2 * parts; ++n) {
    const double share = double(n) / double(2 * parts);
    passing.sent_s.push_back(n == 2 * parts ? end_s_ : begin_s_ + share * (end_s_ - begin_s_));
    passing.from_m.push_back(transmit.at(passing.sent_s.back()).place_m);
  }
  for (std::size_t part = 0; part < parts; ++part)
    passing.smooth.push_back(transmit.is_smooth(passing.sent_s[2 * part], passing.sent_s[2 * part + 2]));
  passing.tx_m.resize(passing.sent_s.size());
  passing.there_s.resize(passing.sent_s.size());
  return passing;
}

void MovingPulse::pass(glm::dvec3 place_m, Passing& passing) const {
  passing.place_m = place_m;
  for (std::size_t n = 0; n < passing.sent_s.size(); ++n) {
    passing.tx_m[n] = glm::distance(passing.from_m[n], place_m);
    passing.there_s[n] = passing.sent_s[n] + passing.tx_m[n] / sound_speed_m_s_;
  }
}

void MovingPulse::add(const Passing& passing, const TabulatedMotion& receive, std::span<const Echo> echoes,
                      std::complex<double> strength, double less_m, const AmplitudeOf& exact,
                      std::complex<double>* out) const {
  const auto samples = double(times_.count);
  const auto sample_of = [&](double time_s) { return (time_s - times_.first_s) * times_.rate_hz; };
  if (sample_of(echoes.back().time_s) < 0 || sample_of(echoes.front().time_s) > samples - 1) return;
  const double k = wavenumber_rad_m_, step_s = 1 / times_.rate_hz;
  const bool even = exact.of == nullptr;
  const double even_size = echoes[echoes.size() / 2].amplitude;
  for (std::size_t part = 0; 2 * part + 2 < echoes.size(); ++part) {
    const Echo &a = echoes[2 * part], &b = echoes[2 * part + 1], &c = echoes[2 * part + 2];
    const bool last = 2 * part + 3 == echoes.size();
    const auto from = std::size_t(std::clamp(std::ceil(sample_of(a.time_s)), 0.0, samples)),
               to = std::size_t(
                   std::clamp(last ? std::floor(sample_of(c.time_s)) + 1 : std::ceil(sample_of(c.time_s)),
                              0.0, samples));
    if (from >= to) continue;
    const double time[3] = {a.time_s, b.time_s, c.time_s},
                 per[3] = {1 / (time[1] - time[0]), 1 / (time[2] - time[1]), 1 / (time[2] - time[0])};
    const Parabola path(time, per, a.path_m, b.path_m, c.path_m);
    if (passing.smooth[part] && receive.is_smooth(a.time_s, c.time_s)) {
      const Parabola amplitude(time, per, a.amplitude, b.amplitude, c.amplitude);
      // The path n samples after the anchor is first + n (step + n bend).
      const double bend_m = path.bend * step_s * step_s;
      const std::complex<double> bend = turn(2 * k * bend_m);
      for (std::size_t anchor = from; anchor < to; anchor += turns_together) {
        const double first_s = times_.time_s(anchor), first_m = path.at(first_s),
                     step_m = path.slope_at(first_s) * step_s;
        std::complex<double> phase = product(strength, std::polar(1.0, k * (first_m - less_m))),
                             step = turn(k * (step_m + bend_m));
        if (even) phase *= even_size;
        const double first = (first_s - first_m * per_c_ - begin_s_) * per_s_,
                     per_sample = (step_s - step_m * per_c_) * per_s_, refracted = -bend_m * per_c_ * per_s_;
        const std::size_t count = std::min(turns_together, to - anchor);
        std::complex<double>* sample = out + anchor;
        for (std::size_t m = 0; m < count; ++m) {
          const double n = double(std::ptrdiff_t(m));
          std::complex<double> g = envelope(first + n * (per_sample + n * refracted));
          if (!even) g *= amplitude.at(times_.time_s(anchor + m));
          sample[m] += product(phase, g);
          phase = product(phase, step);
          step = product(step, bend);
        }
      }
      continue;
    }
    for (std::size_t n = from; n < to; ++n) {
      const double time_s = times_.time_s(n);
      const glm::dvec3 to_m = receive.at(time_s).place_m;
      const double rx = glm::distance(to_m, passing.place_m), there_s = time_s - rx * per_c_;
      double sent_s = time_s - path.at(time_s) * per_c_, tx_m = 0;
      glm::dvec3 from_m;
      for (int step = 0; step < most_steps; ++step) {
        const TabulatedMotion::Moment end = passing.transmit->at(sent_s);
        from_m = end.place_m;
        const glm::dvec3 motion = from_m - passing.place_m;
        tx_m = glm::length(motion);
        const double off =
            (sent_s + tx_m * per_c_ - there_s) / (1 + glm::dot(motion, end.velocity_m_s) * per_c_ / tx_m);
        sent_s -= off;
        if (std::abs(off) <= exact_s) break;
      }
      const double size = !even ? exact.at(exact.of, from_m, to_m, tx_m, rx) : even_size;
      out[n] += product(strength, std::polar(size, k * (tx_m + rx - less_m))) *
                envelope((sent_s - begin_s_) * per_s_);
    }
  }
}

}  // namespace tubefoot
