// SPDX-License-Identifier: GPL-3.0-or-later
// Receive beams of an array by delay-and-sum, in time or by phases in the spectrum, and their energies by
// range sample. The formulas are in beams.hpp.

#include "sensors/beamforming/beams.hpp"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>
#include <stdexcept>

#include "geometry/steps/stop.hpp"
#include "sensors/signals/require.hpp"
#include "sensors/signals/signal_transform.hpp"

namespace tubefoot {
namespace {

using Complex = std::complex<double>;
using std::numbers::pi;

/// The steering with weights that sum to 1 and directions of length 1.
BeamSteering normalised(const ElementSignals& signals, std::size_t ping, BeamSteering steering) {
  check(signals);
  require(ping < signals.pings(),
          fmt::format("there is no ping {}: the signals have {} pings", ping, signals.pings()));
  require(!steering.directions.empty(), "the steering has no beams: give at least one direction");
  require(std::isfinite(glm::length(steering.reference_m)),
          "the reference position of the beams is not finite");
  for (std::size_t beam = 0; beam < steering.directions.size(); ++beam) {
    const double length = glm::length(steering.directions[beam]);
    require(length > 0 && std::isfinite(length),
            fmt::format("the direction of beam {} must be a finite vector with a length above 0", beam));
    steering.directions[beam] /= length;
  }
  if (steering.weights.empty()) steering.weights.assign(signals.receivers(), 1);
  require(steering.weights.size() == signals.receivers(),
          fmt::format("there are {} weights for {} receivers", steering.weights.size(), signals.receivers()));
  double sum = 0;
  for (const double weight : steering.weights) sum += weight;
  require(sum != 0 && std::isfinite(sum), "the sum of the receiver weights is 0 or not finite");
  for (double& weight : steering.weights) weight /= sum;
  return steering;
}

/// Delay of a far arrival at a receiver, relative to the reference position.
double far_delay_s(const ElementSignals& signals, const BeamSteering& steering, std::size_t beam,
                   std::size_t receiver) {
  const glm::dvec3 offset = signals.array.transmitter_m - steering.reference_m +
                            signals.array.receivers_m[receiver] - steering.reference_m;
  return -glm::dot(steering.directions[beam], offset) / signals.sound_speed_m_s;
}

double baseband_rad_s(const ElementSignals& signals) { return 2 * pi * signals.sampling.baseband_hz; }

void add_focused(const ElementSignals& signals, std::size_t ping, const BeamSteering& steering,
                 std::size_t beam, const SignalInterpolator& interpolator, std::span<Complex> out) {
  const SignalSampling& sampling = signals.sampling;
  const Pose& pose = signals.motion.ping_pose(ping);
  const glm::dvec3 from = pose.position_m + pose.attitude * steering.reference_m,
                   direction = pose.attitude * steering.directions[beam];
  const PlaceMotion transmitter(signals.motion, ping, signals.array.transmitter_m, sampling.end_s());
  const double sent_s = signals.waveform.duration_s / 2;
  for (std::size_t receiver = 0; receiver < signals.receivers(); ++receiver) {
    const PlaceMotion own(signals.motion, ping, signals.array.receivers_m[receiver], sampling.end_s());
    for (std::size_t k = 0; k < out.size(); ++k) {
      const double time_s = sampling.time_s(k);
      if (time_s <= 0) continue;
      const glm::dvec3 point = from + direction * (0.5 * signals.sound_speed_m_s * time_s);
      const double delay_s =
          path_emitted_at(sent_s, transmitter, point, own, signals.sound_speed_m_s).delay_s();
      const Complex received =
          interpolator.at(signals.channel(ping, receiver), (delay_s - sampling.first_s) * sampling.rate_hz);
      if (received == 0.0) continue;
      out[k] +=
          received * std::polar(steering.weights[receiver], -baseband_rad_s(signals) * (delay_s - time_s));
    }
  }
}

}  // namespace

std::vector<glm::dvec3> across_track_fan(const std::vector<double>& angles_rad) {
  std::vector<glm::dvec3> directions;
  for (const double angle : angles_rad) directions.emplace_back(std::sin(angle), 0, -std::cos(angle));
  return directions;
}

std::vector<glm::dvec3> forward_fan(const std::vector<double>& angles_rad, double depression_rad) {
  const double level = std::cos(depression_rad), down = -std::sin(depression_rad);
  std::vector<glm::dvec3> directions;
  for (const double angle : angles_rad)
    directions.emplace_back(level * std::sin(angle), level * std::cos(angle), down);
  return directions;
}

std::vector<Complex> delay_and_sum(const ElementSignals& signals, std::size_t ping,
                                   const BeamSteering& requested, const SignalInterpolator& interpolator) {
  const BeamSteering steering = normalised(signals, ping, requested);
  interpolator.check_holds(signals.waveform, signals.sampling);
  std::vector<Complex> beams(steering.directions.size() * signals.samples());
  tbb::parallel_for(std::size_t{0}, steering.directions.size(), [&](std::size_t beam) {
    stop_if_wanted();
    const std::span<Complex> out = std::span(beams).subspan(beam * signals.samples(), signals.samples());
    if (steering.near_field) return add_focused(signals, ping, steering, beam, interpolator, out);
    for (std::size_t receiver = 0; receiver < signals.receivers(); ++receiver) {
      const double later_s = far_delay_s(signals, steering, beam, receiver);
      interpolator.add_shifted(signals.channel(ping, receiver), later_s * signals.sampling.rate_hz,
                               std::polar(steering.weights[receiver], -baseband_rad_s(signals) * later_s),
                               out);
    }
  });
  return beams;
}

std::vector<Complex> phase_and_sum(const ElementSignals& signals, std::size_t ping,
                                   const BeamSteering& requested) {
  const BeamSteering steering = normalised(signals, ping, requested);
  require(!steering.near_field,
          "beamforming by phase shifts needs plane waves: use delay_and_sum() for the near field");
  const SignalSampling& sampling = signals.sampling;
  double longest_s = 0;
  for (std::size_t beam = 0; beam < steering.directions.size(); ++beam)
    for (std::size_t receiver = 0; receiver < signals.receivers(); ++receiver)
      longest_s = std::max(longest_s, std::abs(far_delay_s(signals, steering, beam, receiver)));
  require(
      longest_s * sampling.rate_hz <= static_cast<double>(signals.samples()),
      fmt::format(
          "the plane wave of a beam arrives at a receiver {:.3g} s earlier or later than at the reference "
          "point of the array, which is longer than the record: place the receivers closer together",
          longest_s));
  // Appends as many zeros as the longest shift, so that the cyclic transform does not wrap samples around.
  const SignalTransform transform(signals.samples() +
                                  static_cast<std::size_t>(std::ceil(longest_s * sampling.rate_hz)));
  std::vector<std::vector<Complex>> spectra(signals.receivers());
  tbb::parallel_for(std::size_t{0}, signals.receivers(), [&](std::size_t receiver) {
    spectra[receiver] = transform.spectrum(signals.channel(ping, receiver));
  });
  std::vector<Complex> beams(steering.directions.size() * signals.samples());
  tbb::parallel_for(std::size_t{0}, steering.directions.size(), [&](std::size_t beam) {
    stop_if_wanted();
    std::vector<Complex> sum(transform.length());
    for (std::size_t receiver = 0; receiver < signals.receivers(); ++receiver) {
      const double later_s = far_delay_s(signals, steering, beam, receiver);
      for (std::size_t bin = 0; bin < sum.size(); ++bin) {
        const double frequency_hz = sampling.baseband_hz + transform.frequency_hz(bin, sampling.rate_hz);
        sum[bin] +=
            spectra[receiver][bin] * std::polar(steering.weights[receiver], -2 * pi * frequency_hz * later_s);
      }
    }
    const std::vector<Complex> own = transform.signal(sum);
    std::copy_n(own.begin(), signals.samples(),
                beams.begin() + static_cast<std::ptrdiff_t>(beam * signals.samples()));
  });
  return beams;
}

std::vector<double> beam_energies(const std::vector<Complex>& beams, const SignalSampling& sampling,
                                  double sound_speed_m_s, const RangeSamples& samples) {
  check(sampling);
  require(beams.size() % sampling.samples == 0,
          fmt::format("the number of values, {}, is not a multiple of the number of samples per beam, {}",
                      beams.size(), sampling.samples));
  require(samples.count > 0 && samples.step_m > 0,
          "there must be at least one range sample, with a length above 0 m");
  require(sound_speed_m_s > 0,
          fmt::format("the sound speed is {} m/s, but must be above 0", sound_speed_m_s));
  const std::size_t count = beams.size() / sampling.samples, ranges = static_cast<std::size_t>(samples.count);
  std::vector<double> energies(count * ranges);
  for (std::size_t k = 0; k < sampling.samples; ++k) {
    const double range_m = 0.5 * sound_speed_m_s * sampling.time_s(k);
    const double place = std::floor((range_m - samples.first_m) / samples.step_m);
    if (!(place >= 0 && place < samples.count)) continue;
    for (std::size_t beam = 0; beam < count; ++beam)
      energies[beam * ranges + static_cast<std::size_t>(place)] +=
          std::norm(beams[beam * sampling.samples + k]) / sampling.rate_hz;
  }
  return energies;
}

}  // namespace tubefoot
