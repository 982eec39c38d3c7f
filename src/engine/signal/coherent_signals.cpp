// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/signal/coherent_signals.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>

#include "engine/echo/quadratures.hpp"
#include "engine/signal/chebyshev_moments.hpp"
#include "engine/signal/moving_channels.hpp"
#include "engine/signal/surface_scatterers.hpp"
#include "geometry/numbers/scalars.hpp"
#include "geometry/steps/in_order.hpp"

// Computes signals of a scene-fixed field by moments of its scatterers, independent draws by Gauss nodes,
// and covariances by sums over the same nodes. Source: docs/notes/signals.md.

namespace tubefoot {
namespace {

/// Work per task. The numbers determine the order of summation.
constexpr std::size_t scatterers_per_task = 4096, scatterer_patches_per_task = 64;

double wavenumber(const CoherentReceiver& receiver) {
  return 2 * pi * receiver.carrier_hz / receiver.sound_speed_m_s;
}

/// Middle of the bounding box of all ends of one kind.
glm::dvec3 middle_of(const CoherentReceiver& receiver, glm::dvec3 SignalChannel::*end) {
  glm::dvec3 low = receiver.channels[0].*end, high = low;
  for (const SignalChannel& channel : receiver.channels) {
    low = glm::min(low, channel.*end);
    high = glm::max(high, channel.*end);
  }
  return (low + high) / 2.0;
}

/// `products`: for products of two channels. Otherwise for single channels, relative to the phase of a path
/// to the middle of all ends.
SignalExtent extent_of(const CoherentReceiver& receiver, const Path& path, bool products, double tolerance) {
  SignalExtent extent;
  extent.products = products;
  extent.wavenumber_rad_m = wavenumber(receiver);
  // Interpolation with n nodes leaves the error 2 |K / 2|^n / n! of a frequency, with n at most
  // ChebyshevNodes::most. Gauss rules of n nodes leave an error proportional to E|K|^2n, where K is the
  // difference of two frequencies. By Minkowski's inequality, means of lower orders are below that of the
  // highest order. Means of differences are below twice those of the frequencies.
  extent.band_rad_m = 2 * pi / receiver.sound_speed_m_s *
                      (products ? weighed_bandwidth_hz(receiver.pulse, 2 * most_rule_nodes)
                                : resolved_bandwidth_hz(receiver.pulse, ChebyshevNodes::most, tolerance) / 2);
  double sent = 0, received = 0;
  if (!products) {
    extent.transmit_m.push_back(middle_of(receiver, &SignalChannel::transmit_m));
    extent.receive_m.push_back(middle_of(receiver, &SignalChannel::receive_m));
  }
  const auto add = [](std::vector<glm::dvec3>& places, glm::dvec3 place) {
    if (std::find(places.begin(), places.end(), place) == places.end()) places.push_back(place);
  };
  for (const SignalChannel& channel : receiver.channels) {
    add(extent.transmit_m, channel.transmit_m);
    add(extent.receive_m, channel.receive_m);
    sent = std::max(sent, amplitude_wavenumber(channel.transmit));
    received = std::max(received, amplitude_wavenumber(channel.receive));
  }
  sent += amplitude_wavenumber(path.tx.loss);
  received += amplitude_wavenumber(path.back().loss);
  extent.pattern_rad = (sent + received) * (products ? 2 : 1);
  return extent;
}

/// All channels on the current polygon.
class ChannelsOnPolygon {
 public:
  ChannelsOnPolygon(const VisiblePolygons& seen, const CoherentReceiver& receiver, const EchoModel& model)
      : seen_(seen), receiver_(receiver), model_(model), wavenumber_(wavenumber(receiver)) {}

  /// Selects a polygon. Returns false if no channel receives an echo from it.
  bool look_at(const VisiblePolygon& patch) {
    on_.clear();
    bool any = false;
    for (const SignalChannel& channel : receiver_.channels) {
      on_.emplace_back(channel, seen_, patch, model_);
      any = any || on_.back().faces();
    }
    seabed_ = on_.front().path().seabed;
    return any && !is_silent(seabed_);
  }
  const SurfaceProperties& seabed() const { return seabed_; }

  /// Calls take(channel, amplitude with phase, delay) for each channel that faces the polygon.
  template <class Take>
  void hear(glm::dvec3 place_m, std::complex<double> strength, double less_m, const Take& take) const {
    for (std::size_t c = 0; c < on_.size(); ++c) {
      if (!on_[c].faces()) continue;
      const ChannelOnPolygon::Reception received = on_[c].at(place_m);
      take(c, std::polar(received.amplitude, wavenumber_ * (received.path_m - less_m)) * strength,
           received.path_m / receiver_.sound_speed_m_s);
    }
  }

 private:
  const VisiblePolygons& seen_;
  const CoherentReceiver& receiver_;
  const EchoModel& model_;
  double wavenumber_;
  std::vector<ChannelOnPolygon> on_;
  SurfaceProperties seabed_;
};

using Values = std::vector<std::complex<double>>;

void add_up(Values& all, const Values& part) {
  for (std::size_t k = 0; k < part.size(); ++k) all[k] += part[k];
}

ChannelSignals zero_signals(const CoherentReceiver& receiver) {
  ChannelSignals signals{receiver.channels.size(), receiver.times.count, {}};
  signals.value.assign(signals.channels * signals.samples, 0);
  return signals;
}

/// Divides work into tasks and adds their results in a fixed order.
template <class Make>
void in_tasks(std::size_t count, std::size_t per_task, Values& all, const Make& make) {
  in_order(
      0, (count + per_task - 1) / per_task, 16 * all.size(),
      [&](std::size_t task) {
        Values part(all.size());
        make(task * per_task, std::min((task + 1) * per_task, count), part);
        return part;
      },
      [&](std::size_t, const Values& part) { add_up(all, part); });
}

/// Passes the field's scatterers on one polygon after the other to the channels, directly or as moments.
class ScatterersOnPolygon {
 public:
  ScatterersOnPolygon(const VisiblePolygons& patches, const CoherentReceiver& receiver,
                      const SurfaceField& field, const ChebyshevNodes& nodes)
      : patches_(patches),
        field_(field),
        wavenumber_(wavenumber(receiver)),
        first_m_((receiver.times.first_s - receiver.pulse.end_s) * receiver.sound_speed_m_s),
        last_m_((receiver.times.time_s(receiver.times.count) - receiver.pulse.begin_s) *
                receiver.sound_speed_m_s),
        moments_(nodes) {}

  /// Calls hear(place, strength, less). The channels' phases are those of their path lengths minus `less`,
  /// in m.
  template <class Hear>
  void tell(const VisiblePolygon& patch, const SurfaceProperties& seabed, const SignalExtent& extent,
            const SmoothPieces& pieces, const Hear& hear) {
    const glm::dvec3 tx = extent.transmit_m[0] - patches_.origin_m,
                     rx = extent.receive_m[0] - patches_.origin_m;
    const double scatterer_m2 = field_.area_m2(patch.normal);
    chunks_.clear();
    pieces.cut(patches_, patch, chunks_);
    for (const SmoothPieces::Chunk& chunk : chunks_) {
      if (!moments_.begin(chunk, tx, rx, extent, first_m_, last_m_)) continue;
      corners_.clear();
      for (const glm::dvec2 p : chunk.polygon) corners_.push_back(patches_.origin_m + chunk.at(p));
      // A few scatterers cost less individually than as nodes.
      const bool few = area_of(chunk.polygon) / scatterer_m2 < moments_.nodes();
      if (!few) moments_.clear();
      field_.for_scatterers(corners_, patch.normal, [&](glm::dvec3 place, std::complex<double> z) {
        const glm::dvec3 at = place - patches_.origin_m;
        if (seabed.texture != nullptr) z *= std::sqrt(seabed.texture->factor(place));
        if (few)
          hear(at, z, 0);
        else
          moments_.add(at,
                       z * std::polar(1.0, wavenumber_ * (glm::distance(at, tx) + glm::distance(at, rx))));
      });
      if (few) continue;
      moments_.tell([&](glm::dvec3 at, std::complex<double> strength) {
        hear(at, strength, glm::distance(at, tx) + glm::distance(at, rx));
      });
    }
  }

 private:
  const VisiblePolygons& patches_;
  const SurfaceField& field_;
  double wavenumber_, first_m_, last_m_;
  ChebyshevMoments moments_;
  std::vector<SmoothPieces::Chunk> chunks_;
  std::vector<glm::dvec3> corners_;
};

ChannelSignals moving_signals(const VisiblePolygons& patches, const MovingEnds& ends, const EchoModel& model,
                              const SurfaceField& field, double tolerance) {
  const CoherentReceiver& receiver = ends.held();
  const SignalExtent extent = extent_of(receiver, model.path, false, tolerance);
  const ChebyshevNodes nodes(tolerance);
  ChannelSignals signals = zero_signals(receiver);
  in_tasks(patches.patches.size(), scatterer_patches_per_task, signals.value,
           [&](std::size_t begin, std::size_t end, Values& part) {
             MovingChannels channels(ends, patches, model, extent, tolerance);
             ScatterersOnPolygon scatterers(patches, receiver, field, nodes);
             for (std::size_t number = begin; number < end; ++number) {
               stop_if_wanted();
               const VisiblePolygon& patch = patches.patches[number];
               if (!channels.look_at(patch)) continue;
               // Pieces for the positions of the ends during the echo of the polygon.
               const SmoothPieces pieces(channels.extent(), nodes.most_change());
               scatterers.tell(patch, channels.seabed(), channels.extent(), pieces,
                               [&](glm::dvec3 at, std::complex<double> strength, double less_m) {
                                 channels.hear(at, strength, less_m, part.data());
                               });
             }
           });
  return signals;
}

bool has_paths(const CoherentReceiver& receiver) {
  return std::any_of(receiver.channels.begin(), receiver.channels.end(),
                     [](const SignalChannel& channel) { return channel.has_path(); });
}

}  // namespace

void check(const CoherentReceiver& receiver, const EchoModel& model) {
  check(receiver.pulse, receiver.times);
  check(model);
  if (receiver.channels.empty()) throw std::invalid_argument("signals need at least one channel");
  if (!(receiver.carrier_hz > 0 && receiver.sound_speed_m_s > 0))
    throw std::invalid_argument(
        fmt::format("signals need a carrier and a sound speed above 0, not {} Hz and {} m/s",
                    receiver.carrier_hz, receiver.sound_speed_m_s));
}

ChannelSignals element_signals(const VisiblePolygons& patches, const CoherentReceiver& receiver,
                               const EchoModel& model, const SurfaceField& field, double tolerance) {
  check(receiver, model);
  check(field);
  if (has_paths(receiver)) {
    const MovingEnds ends(receiver, patches.origin_m);
    return ends.move() ? moving_signals(patches, ends, model, field, tolerance)
                       : element_signals(patches, ends.held(), model, field, tolerance);
  }
  const PulseTable table(receiver.pulse, receiver.times, tolerance);
  const SignalExtent extent = extent_of(receiver, model.path, false, tolerance);
  const ChebyshevNodes nodes(tolerance);
  const SmoothPieces pieces(extent, nodes.most_change());
  ChannelSignals signals = zero_signals(receiver);
  in_tasks(patches.patches.size(), scatterer_patches_per_task, signals.value,
           [&](std::size_t begin, std::size_t end, Values& part) {
             ChannelsOnPolygon channels(patches, receiver, model);
             ScatterersOnPolygon scatterers(patches, receiver, field, nodes);
             const auto take = [&](std::size_t c, std::complex<double> amplitude, double delay) {
               table.add(amplitude, delay, &part[c * receiver.times.count]);
             };
             for (std::size_t number = begin; number < end; ++number) {
               stop_if_wanted();
               const VisiblePolygon& patch = patches.patches[number];
               if (!channels.look_at(patch)) continue;
               scatterers.tell(patch, channels.seabed(), extent, pieces,
                               [&](glm::dvec3 at, std::complex<double> strength, double less_m) {
                                 channels.hear(at, strength, less_m, take);
                               });
             }
           });
  return signals;
}

ChannelSignals drawn_signals(const VisiblePolygons& patches, const CoherentReceiver& receiver,
                             const EchoModel& model, std::uint64_t seed, std::uint32_t ping,
                             double tolerance) {
  check(receiver, model);
  std::optional<MovingEnds> ends;
  if (has_paths(receiver)) {
    ends.emplace(receiver, patches.origin_m);
    if (!ends->move()) return drawn_signals(patches, ends->held(), model, seed, ping, tolerance);
  }
  SignalExtent extent = extent_of(ends ? ends->held() : receiver, model.path, true, tolerance);
  if (ends) ends->widen(extent);
  const PulseTable table(receiver.pulse, receiver.times, tolerance);
  const std::vector<SurfaceScatterer> seabed = seabed_scatterers(patches, extent, tolerance);
  ChannelSignals signals = zero_signals(receiver);
  const auto draw = [&](std::size_t n, const SurfaceProperties& on) {
    const SampleRandom random(seed, ping, std::uint32_t(std::uint64_t(n) >> 32), std::uint32_t(n));
    return std::sqrt(seabed[n].weight_m2 * texture_at(on, patches, seabed[n].place_m)) *
           circular_normal(random.uniform_pair(Purpose::drawn));
  };
  in_tasks(seabed.size(), scatterers_per_task, signals.value,
           [&](std::size_t begin, std::size_t end, Values& part) {
             std::optional<std::uint32_t> patch;
             bool received = false;
             if (ends) {
               MovingChannels channels(*ends, patches, model, extent, tolerance);
               for (std::size_t n = begin; n < end; ++n) {
                 if (patch != seabed[n].patch)
                   received = channels.look_at(patches.patches[*(patch = seabed[n].patch)]);
                 if (received) channels.hear(seabed[n].place_m, draw(n, channels.seabed()), 0, part.data());
               }
               return;
             }
             ChannelsOnPolygon channels(patches, receiver, model);
             for (std::size_t n = begin; n < end; ++n) {
               if (patch != seabed[n].patch)
                 received = channels.look_at(patches.patches[*(patch = seabed[n].patch)]);
               if (!received) continue;
               channels.hear(seabed[n].place_m, draw(n, channels.seabed()), 0,
                             [&](std::size_t c, std::complex<double> amplitude, double delay) {
                               table.add(amplitude, delay, &part[c * receiver.times.count]);
                             });
             }
           });
  return signals;
}

CovarianceMatrix signal_covariances(const VisiblePolygons& patches, const CoherentReceiver& receiver,
                                    std::span<const SignalSample> samples, const EchoModel& model,
                                    double tolerance) {
  check(receiver, model);
  if (has_paths(receiver))
    throw std::invalid_argument(
        "signal covariances need transmitters and receivers at rest: leave out the motions of the channels, "
        "or use element_signals() or drawn_signals(), which support motion");
  std::vector<std::vector<std::pair<double, std::size_t>>> of_channel(receiver.channels.size());
  for (std::size_t n = 0; n < samples.size(); ++n) {
    if (samples[n].channel >= receiver.channels.size() || samples[n].sample >= receiver.times.count)
      throw std::invalid_argument(
          fmt::format("there is no sample {} of channel {}: there are {} channels of {} samples",
                      samples[n].sample, samples[n].channel, receiver.channels.size(), receiver.times.count));
    of_channel[samples[n].channel].emplace_back(receiver.times.time_s(samples[n].sample), n);
  }
  const std::vector<SurfaceScatterer> seabed =
      seabed_scatterers(patches, extent_of(receiver, model.path, true, tolerance), tolerance);
  CovarianceMatrix matrix{samples.size(), Values(samples.size() * samples.size())};
  in_tasks(seabed.size(), scatterers_per_task, matrix.value,
           [&](std::size_t begin, std::size_t end, Values& part) {
             ChannelsOnPolygon channels(patches, receiver, model);
             std::optional<std::uint32_t> patch;
             bool received = false;
             std::vector<std::pair<std::size_t, std::complex<double>>> h;
             for (std::size_t n = begin; n < end; ++n) {
               if (patch != seabed[n].patch)
                 received = channels.look_at(patches.patches[*(patch = seabed[n].patch)]);
               if (!received) continue;
               const double strength =
                   seabed[n].weight_m2 * texture_at(channels.seabed(), patches, seabed[n].place_m);
               h.clear();
               channels.hear(seabed[n].place_m, std::sqrt(strength), 0,
                             [&](std::size_t c, std::complex<double> amplitude, double delay) {
                               for (const auto& [time, row] : of_channel[c])
                                 if (const std::complex<double> g = receiver.pulse.at(time - delay); g != 0.0)
                                   h.emplace_back(row, amplitude * g);
                             });
               for (const auto& [row, a] : h)
                 for (const auto& [column, b] : h)
                   if (column <= row) part[row * samples.size() + column] += a * std::conj(b);
             }
           });
  for (std::size_t row = 0; row < samples.size(); ++row) {
    matrix.at(row, row) = matrix.at(row, row).real();
    for (std::size_t column = 0; column < row; ++column)
      matrix.at(column, row) = std::conj(matrix.at(row, column));
  }
  return matrix;
}

std::vector<std::complex<double>> drawn_samples(const LowRankFactor& factor, std::uint64_t seed,
                                                std::uint32_t draw) {
  std::vector<std::complex<double>> z;
  for (std::size_t k = 0; k < factor.rank; ++k)
    z.push_back(
        circular_normal(SampleRandom(seed, draw, 0xffffffff, std::uint32_t(k)).uniform_pair(Purpose::drawn)));
  return factor.times(z);
}

}  // namespace tubefoot
