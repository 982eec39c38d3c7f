// SPDX-License-Identifier: GPL-3.0-or-later
#include "sensors/signals/matched_filter.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "geometry/steps/stop.hpp"
#include "sensors/signals/signal_transform.hpp"

namespace tubefoot {
namespace {

using Complex = std::complex<double>;

/// g w / integral of |g|^2 w, times the sampling interval.
std::vector<Complex> normalised_replica(const TransmitWaveform& waveform, const SignalSampling& sampling,
                                        const ApertureWindow& window) {
  std::vector<Complex> samples = replica(waveform, sampling);
  double gain = 0;
  for (std::size_t k = 0; k < samples.size(); ++k) {
    const double place = static_cast<double>(k) / (sampling.rate_hz * waveform.duration_s) - 0.5;
    const double weight = window_at(window, place), power = std::norm(samples[k]);
    samples[k] *= weight;
    gain += power * weight;
  }
  for (Complex& sample : samples) sample /= gain;
  return samples;
}

}  // namespace

std::vector<Complex> replica(const TransmitWaveform& waveform, const SignalSampling& sampling) {
  check_sampled(waveform, sampling);
  const auto last = static_cast<std::size_t>(std::floor(waveform.duration_s * sampling.rate_hz));
  std::vector<Complex> samples;
  for (std::size_t k = 0; k <= last; ++k)
    samples.push_back(baseband_at(waveform, sampling.baseband_hz, static_cast<double>(k) / sampling.rate_hz));
  return samples;
}

ElementSignals matched_filtered(const ElementSignals& signals, const ApertureWindow& window) {
  check(signals);
  if (signals.matched_filtered)
    throw std::invalid_argument("the signals are already matched filtered: do not filter them again");
  const std::vector<Complex> sent = normalised_replica(signals.waveform, signals.sampling, window);
  const SignalTransform transform(signals.samples() + sent.size());  // long enough that no echo wraps around
                                                                     // from the end
  const std::vector<Complex> filter = transform.spectrum(sent);
  ElementSignals result = signals;
  result.matched_filtered = true;
  result.bound = {};  // the bounds apply to the unfiltered samples
  tbb::parallel_for(std::size_t{0}, signals.pings() * signals.receivers(), [&](std::size_t k) {
    stop_if_wanted();
    const std::size_t ping = k / signals.receivers(), receiver = k % signals.receivers();
    std::vector<Complex> bins = transform.spectrum(signals.channel(ping, receiver));
    for (std::size_t bin = 0; bin < bins.size(); ++bin) bins[bin] *= std::conj(filter[bin]);
    const std::vector<Complex> compressed = transform.signal(bins);
    std::copy_n(compressed.begin(), signals.samples(), result.channel(ping, receiver).begin());
  });
  return result;
}

}  // namespace tubefoot
