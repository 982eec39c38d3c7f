// SPDX-License-Identifier: GPL-3.0-or-later
// Detects the bottom in the beams of a fan across the track. The methods are amplitude (BottomFinder), and
// the phase between beams of the array's two halves (split_beam_zero).

#include "sensors/products/signal_soundings.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "sensors/beamforming/beams.hpp"
#include "sensors/detection/split_beam.hpp"
#include "sensors/model/angles.hpp"
#include "sensors/pictures/decibel_scale.hpp"
#include "sensors/products/signal_makers.hpp"

namespace tubefoot {
namespace {

using Complex = std::complex<double>;
using std::numbers::pi;

/// The receivers to port or to starboard, with their weights. The middle one of an odd number is in both
/// halves, with half its weight.
struct ArrayHalf {
  std::vector<std::size_t> receivers;
  std::vector<double> weights;
  double sum = 0, centre_m = 0;  ///< sum of the weights; centre, to starboard
};

struct ArrayHalves {
  ArrayHalf port, starboard;
};

ArrayHalves halves_of(const ElementArray& array, const std::vector<double>& weights) {
  const std::size_t count = array.receivers_m.size();
  std::vector<std::size_t> order(count);
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, {}, [&](std::size_t k) { return array.receivers_m[k].x; });
  ArrayHalves halves;
  const auto put = [&](ArrayHalf& half, std::size_t receiver, double share) {
    const double weight = share * (weights.empty() ? 1 : weights[receiver]);
    half.receivers.push_back(receiver);
    half.weights.push_back(weight);
    half.sum += weight;
    half.centre_m += weight * array.receivers_m[receiver].x;
  };
  for (std::size_t k = 0; k < count; ++k) {
    const bool middle = count % 2 == 1 && k == count / 2;
    if (middle || k < count / 2) put(halves.port, order[k], middle ? 0.5 : 1);
    if (middle || k >= count / 2) put(halves.starboard, order[k], middle ? 0.5 : 1);
  }
  for (ArrayHalf* half : {&halves.port, &halves.starboard}) half->centre_m /= half->sum;
  return halves;
}

double wavelength_m(const ElementSignals& signals) {
  return signals.sound_speed_m_s / signals.waveform.centre_hz();
}

/// Number of samples per independent look.
double samples_a_look(const ElementSignals& signals) {
  const TransmitWaveform& waveform = signals.waveform;
  const double band_hz = std::max(std::abs(waveform.stop_hz - waveform.start_hz), 1 / waveform.duration_s);
  return std::max(1.0, signals.sampling.rate_hz / band_hz);
}

/// Data that the detections in all beams share.
struct Detector {
  const ElementSignals& signals;
  const SignalMultibeam& multibeam;
  const RangeSamples& ranges;
  glm::dvec3 from_m;  ///< the phase centre on the vehicle
  double lobe_sine, edge_rad, look;

  Sounding sounding(std::size_t beam, double angle_rad, double range_m) const {
    const glm::dvec3 axis{std::sin(angle_rad), 0, -std::cos(angle_rad)};
    Pose pose = signals.motion.ping_pose(0);
    pose.position_m += pose.attitude * from_m;
    Sounding found;
    found.beam = static_cast<std::uint32_t>(beam);
    found.time_s = signals.motion.ping_start_s()[0];
    found.position_m = sounding_position(pose, axis, range_m);
    found.two_way_travel_time_s = 2 * range_m / signals.sound_speed_m_s;
    found.slant_range_m = range_m;
    found.beam_angle_deg = degrees(angle_rad);
    return found;
  }

  glm::dvec3 axis_of(double angle_rad) const {
    return signals.motion.ping_pose(0).attitude * glm::dvec3(std::sin(angle_rad), 0, -std::cos(angle_rad));
  }
  /// Sine of the angle from straight down at which a beam meets a level seabed.
  double across_sine(double angle_rad) const {
    const double z = axis_of(angle_rad).z;
    return std::sqrt(std::max(0.0, 1 - z * z));
  }
  /// Distance in slant range to the limits of the main lobe on a level seabed, on either side of a range.
  double lobe_m(double angle_rad, double range_m) const {
    constexpr double least_cosine = 0.02;
    const double down = std::max(least_cosine, -axis_of(angle_rad).z), level = across_sine(angle_rad);
    return range_m * level / (down * down) * lobe_sine;
  }
};

void detect(SignalSoundings& found, const Detector& detector, std::size_t beam, double angle_rad,
            std::span<const Complex> product) {
  const RangeSamples& ranges = found.ranges;
  const auto count = static_cast<std::size_t>(ranges.count);
  const std::span<const Complex> values = std::span(found.beams).subspan(beam * count, count);
  std::vector<double> evened(count);
  for (std::size_t k = 0; k < count; ++k) {
    const double range_m = std::max(0.0, ranges.first_m + (static_cast<double>(k) + 0.5) * ranges.step_m);
    evened[k] = std::norm(values[k]) * range_m * range_m;
  }
  const std::optional<Detection> amplitude = detect_bottom(evened, ranges, detector.multibeam.rule);
  if (!amplitude) return;
  Sounding own = detector.sounding(beam, angle_rad, amplitude->range_m);
  own.amplitude = std::abs(values[static_cast<std::size_t>(amplitude->sample)]);
  own.quality = amplitude->quality;
  own.method = detector.multibeam.rule.method;
  own.flags = amplitude->flags;
  found.amplitude[beam] = own;
  // The detection counts energies as single looks. Samples taken faster than the bandwidth are not
  // independent.
  found.amplitude_sigma_m[beam] = amplitude->range_sigma_m * std::sqrt(detector.look);
  if (product.empty()) return;
  constexpr double beyond_lobe = 1.5, least_looks = 4;
  SplitBeamSearch search;
  search.from = (amplitude->range_m - ranges.first_m) / ranges.step_m - 0.5;
  search.half_window = std::max(beyond_lobe * detector.lobe_m(angle_rad, amplitude->range_m) / ranges.step_m,
                                least_looks * detector.look);
  search.edge_rad = detector.edge_rad;
  search.samples_a_look = detector.look;
  const double sine = detector.across_sine(angle_rad);
  if (amplitude->range_m > 0) search.bend = level_seabed_bend(amplitude->range_m, sine, ranges.step_m);
  // A curvature that reaches its slope at the window's end is no longer a second-order term.
  search.bend = std::clamp(search.bend, -0.25 / search.half_window, 0.25 / search.half_window);
  const std::optional<SplitBeamDetection> zero = split_beam_zero(product, search);
  if (!zero) return;
  const double range_m = ranges.first_m + (zero->sample + 0.5) * ranges.step_m;
  if (!(range_m > 0)) return;
  Sounding phase = detector.sounding(beam, angle_rad, range_m);
  const double nearest = std::clamp(std::round(zero->sample), 0.0, static_cast<double>(count - 1));
  phase.amplitude = std::abs(values[static_cast<std::size_t>(nearest)]);
  phase.quality = own.quality;
  phase.method = DetectionMethod::split_beam;
  phase.flags = own.flags;
  found.phase[beam] = phase;
  found.phase_sigma_m[beam] = zero->sigma * ranges.step_m;
}

}  // namespace

std::optional<Sounding> SignalSoundings::best(std::size_t beam) const {
  if (phase[beam] && (!amplitude[beam] || phase_sigma_m[beam] < amplitude_sigma_m[beam])) return phase[beam];
  return amplitude[beam];
}

double half_lobe_sine(const ElementSignals& signals, const std::vector<double>& weights) {
  const double k = 2 * pi / wavelength_m(signals);
  const auto level = [&](double sine) {
    Complex sum = 0;
    double all = 0;
    for (std::size_t e = 0; e < signals.receivers(); ++e) {
      const double weight = weights.empty() ? 1 : weights[e];
      sum += std::polar(weight, k * signals.array.receivers_m[e].x * sine);
      all += weight;
    }
    return std::abs(sum) / std::abs(all);
  };
  constexpr double step = 1e-4;
  const double half = std::sqrt(0.5);
  double sine = step;
  while (sine < 1 && level(sine) > half) sine += step;
  return std::min(sine, 1.0);
}

SignalSoundings signal_soundings(const ElementSignals& compressed, const SignalMultibeam& multibeam,
                                 const SignalInterpolator& interpolator) {
  const SignalFan& fan = multibeam.fan;
  const std::vector<double> angles = fan.angles_rad(),
                            weights = weights_along(compressed.array, starboard_axis, fan.window);
  const glm::dvec3 from = phase_centre_m(compressed.array);
  SignalSoundings found;
  found.ranges = ranges_of(compressed.sampling, compressed.sound_speed_m_s);
  found.amplitude.resize(angles.size());
  found.phase.resize(angles.size());
  found.amplitude_sigma_m.resize(angles.size());
  found.phase_sigma_m.resize(angles.size());
  Detector detector{compressed,
                    multibeam,
                    found.ranges,
                    from,
                    half_lobe_sine(compressed, weights),
                    0,
                    samples_a_look(compressed)};
  const auto beams_of = [&](const ElementSignals& signals, const std::vector<double>& own) {
    return delay_and_sum(signals, 0, {fan.directions(), own, from, true}, interpolator);
  };
  std::vector<Complex> product;
  if (multibeam.split_beam) {
    const ArrayHalves halves = halves_of(compressed.array, weights);
    const ArrayHalf &port = halves.port, &starboard = halves.starboard;
    product = beams_of(of_receivers(compressed, starboard.receivers), starboard.weights);
    found.beams = beams_of(of_receivers(compressed, port.receivers), port.weights);
    // The sum of both halves is the beam of the whole array.
    const double all = port.sum + starboard.sum;
    for (std::size_t k = 0; k < product.size(); ++k) {
      const Complex left = found.beams[k], right = product[k];
      product[k] = right * std::conj(left);
      found.beams[k] = (port.sum * left + starboard.sum * right) / all;
    }
    detector.edge_rad = std::min(0.9 * pi, 2 * pi / wavelength_m(compressed) *
                                               (starboard.centre_m - port.centre_m) * detector.lobe_sine);
  } else {
    found.beams = beams_of(compressed, weights);
  }
  const auto count = static_cast<std::size_t>(found.ranges.count);
  tbb::parallel_for(std::size_t{0}, angles.size(), [&](std::size_t beam) {
    detect(found, detector, beam, angles[beam],
           product.empty() ? std::span<const Complex>()
                           : std::span<const Complex>(product).subspan(beam * count, count));
  });
  return found;
}

}  // namespace tubefoot
