// SPDX-License-Identifier: GPL-3.0-or-later
// Forms images by back-projection. A pixel is the weighted sum, over pings and receivers, of the signal at
// the exact two-way delay. The phase of that delay is removed. The formula is in back_projection.hpp.

#include "sensors/beamforming/back_projection.hpp"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>
#include <stdexcept>

#include "geometry/steps/stop.hpp"

namespace tubefoot {
namespace {

using Complex = std::complex<double>;

std::vector<double> all_weights(const std::vector<double>& requested, std::size_t count, const char* of) {
  if (requested.empty()) return std::vector<double>(count, 1);
  if (requested.size() != count)
    throw std::invalid_argument(fmt::format("there are {} weights for {} {}", requested.size(), count, of));
  for (std::size_t k = 0; k < count; ++k)
    if (!std::isfinite(requested[k]))
      throw std::invalid_argument(fmt::format("weight {} of the {} is not finite", k, of));
  return requested;
}

/// Data of a ping that all pixels share.
struct PingPath {
  PlaceMotion transmitter;
  std::vector<PlaceMotion> receivers;
  glm::dvec3 centre_m, forward;
};

class Projector {
 public:
  Projector(const ElementSignals& signals, const SignalInterpolator& interpolator, const BackProjection& how)
      : signals_(signals),
        interpolator_(interpolator),
        spreading_undone_(how.spreading_undone),
        nearest_abeam_only_(how.nearest_abeam_only),
        ping_weights_(all_weights(how.ping_weights, signals.pings(), "pings")),
        receiver_weights_(all_weights(how.receiver_weights, signals.receivers(), "receivers")) {
    if (how.half_beam_rad) most_forward_ = std::sin(*how.half_beam_rad);
    const double end_s = signals.sampling.end_s();
    for (std::size_t ping = 0; ping < signals.pings(); ++ping) {
      const Pose& pose = signals.motion.ping_pose(ping);
      PingPath way{{signals.motion, ping, signals.array.transmitter_m, end_s},
                   {},
                   pose.position_m + pose.attitude * signals.array.centre_m(),
                   pose.attitude * glm::dvec3(0, 1, 0)};
      for (const glm::dvec3& place : signals.array.receivers_m)
        way.receivers.emplace_back(signals.motion, ping, place, end_s);
      ways_.push_back(std::move(way));
    }
  }

  Complex pixel(glm::dvec3 point) const {
    if (nearest_abeam_only_) {
      const std::optional<std::size_t> ping = nearest_abeam(point);
      return ping ? of_pings(*ping, *ping + 1, point) : 0;
    }
    return of_pings(0, ways_.size(), point);
  }

 private:
  /// Absolute sine of the angle from abeam at which a ping sees a point.
  double forward_of(std::size_t ping, glm::dvec3 point) const {
    const glm::dvec3 there = point - ways_[ping].centre_m;
    const double length = glm::length(there);
    return length > 0 ? std::abs(glm::dot(there, ways_[ping].forward)) / length : 0;
  }

  std::optional<std::size_t> nearest_abeam(glm::dvec3 point) const {
    std::optional<std::size_t> nearest;
    double least = most_forward_.value_or(1);
    for (std::size_t ping = 0; ping < ways_.size(); ++ping)
      if (const double own = forward_of(ping, point); nearest ? own < least : own <= least) {
        nearest = ping;
        least = own;
      }
    return nearest;
  }

  Complex of_pings(std::size_t first, std::size_t end, glm::dvec3 point) const {
    Complex sum = 0;
    double weights = 0;
    for (std::size_t ping = first; ping < end; ++ping) {
      if (most_forward_ && forward_of(ping, point) > *most_forward_) continue;
      for (std::size_t receiver = 0; receiver < ways_[ping].receivers.size(); ++receiver) {
        const double weight = ping_weights_[ping] * receiver_weights_[receiver];
        weights += weight;
        sum += weight * echo(ping, receiver, point);
      }
    }
    return weights == 0 ? 0 : sum / weights;
  }

  Complex echo(std::size_t ping, std::size_t receiver, glm::dvec3 point) const {
    const SignalSampling& sampling = signals_.sampling;
    const TwoWayPath path = path_emitted_at(signals_.waveform.duration_s / 2, ways_[ping].transmitter, point,
                                            ways_[ping].receivers[receiver], signals_.sound_speed_m_s);
    const double delay_s = path.delay_s();
    const Complex received =
        interpolator_.at(signals_.channel(ping, receiver), (delay_s - sampling.first_s) * sampling.rate_hz);
    if (received == 0.0) return 0;
    const double gain = spreading_undone_ ? path.tx_m * path.rx_m : 1;
    return received * std::polar(gain, -2 * std::numbers::pi * sampling.baseband_hz * delay_s);
  }

  const ElementSignals& signals_;
  const SignalInterpolator& interpolator_;
  bool spreading_undone_, nearest_abeam_only_;
  std::vector<double> ping_weights_, receiver_weights_;
  std::optional<double> most_forward_;
  std::vector<PingPath> ways_;
};

}  // namespace

std::vector<Complex> back_projected(const ElementSignals& signals, const PixelPlane& plane,
                                    const SignalInterpolator& interpolator, const BackProjection& how) {
  check(signals);
  if (plane.columns == 0 || plane.rows == 0)
    throw std::invalid_argument(fmt::format("the picture has {} x {} pixels, but must have at least 1 x 1",
                                            plane.columns, plane.rows));
  if (plane.columns > (std::size_t{1} << 31) / plane.rows)
    throw std::invalid_argument(
        fmt::format("the picture has {} x {} pixels, but must have at most 2^31", plane.columns, plane.rows));
  const glm::dvec3 last_m = plane.at(plane.columns - 1, plane.rows - 1);
  if (!std::isfinite(glm::length(plane.first_m)) || !std::isfinite(glm::length(last_m)))
    throw std::invalid_argument("the first or the last pixel of the picture has no finite position");
  if (how.half_beam_rad && !(*how.half_beam_rad > 0 && *how.half_beam_rad <= std::numbers::pi / 2))
    throw std::invalid_argument(fmt::format(
        "the half beam width is {} rad, but must be above 0 and at most pi / 2", *how.half_beam_rad));
  interpolator.check_holds(signals.waveform, signals.sampling);
  const Projector projector(signals, interpolator, how);
  std::vector<Complex> picture(plane.columns * plane.rows);
  tbb::parallel_for(std::size_t{0}, picture.size(), [&](std::size_t k) {
    if (k % plane.columns == 0) stop_if_wanted();
    picture[k] = projector.pixel(plane.at(k % plane.columns, k / plane.columns));
  });
  return picture;
}

}  // namespace tubefoot
