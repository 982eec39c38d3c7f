// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/signal/signal_channel.hpp"

#include <algorithm>
#include <boost/math/special_functions/bessel.hpp>
#include <numbers>

namespace tubefoot {

double amplitude_pattern(const Directivity& pattern, glm::dvec3 direction) {
  const double cosine = glm::dot(direction, pattern.axis), size = std::sqrt(pattern.gain_at(cosine));
  // All in double, because long double differs between machines.
  using Double = boost::math::policies::policy<boost::math::policies::promote_double<false>>;
  switch (pattern.kind) {
    case Directivity::Kind::line: {
      const double x = pattern.size * (std::clamp(cosine, -1.0, 1.0) - pattern.centre);
      return x != 0 && std::sin(std::numbers::pi * x) / x < 0 ? -size : size;
    }
    case Directivity::Kind::piston: {
      const double w = std::clamp(cosine, -1.0, 1.0), x = pattern.size * std::sqrt(1 - w * w);
      return boost::math::cyl_bessel_j(1, x, Double()) < 0 ? -size : size;
    }
    case Directivity::Kind::uniform:
    case Directivity::Kind::gaussian:
    case Directivity::Kind::table:
      break;
  }
  return size;
}

ChannelOnPolygon::ChannelOnPolygon(const SignalChannel& channel, const VisiblePolygons& seen,
                                   const VisiblePolygon& patch, const EchoModel& model)
    : channel_(&channel),
      transmit_m_(channel.transmit_m - seen.origin_m),
      receive_m_(channel.receive_m - seen.origin_m),
      transmit_{patch.normal, patch.distance_m + glm::dot(patch.normal, transmit_m_)},
      receive_distance_m_(patch.distance_m + glm::dot(patch.normal, receive_m_)),
      frame_(transmit_),
      path_(transmit_, frame_, receive_m_ - transmit_m_, receive_distance_m_, patch.facet, model),
      weighed_(channel.transmit.kind != Directivity::Kind::uniform ||
               channel.receive.kind != Directivity::Kind::uniform) {}

double ChannelOnPolygon::amplitude_from(glm::dvec3 place_m, glm::dvec3 transmit_m, glm::dvec3 receive_m,
                                        double tx_m, double rx_m) const {
  const double above_tx = transmit_.distance_m + glm::dot(transmit_.normal, transmit_m - transmit_m_),
               above_rx = receive_distance_m_ + glm::dot(transmit_.normal, receive_m - receive_m_);
  if (!(above_tx > 0 && above_rx > 0)) return 0;
  const SurfaceProperties& seabed = path_.seabed;
  const auto motion = TwoWayRange<double>::of(tx_m, rx_m);
  double amplitude =
      seabed.scattering == nullptr
          ? std::sqrt(seabed.mu * above_tx * above_rx * lambert_density(motion, path_.beta_per_m))
          : std::sqrt(seabed.factor * density(std::sqrt(cross_section(*seabed.scattering, above_tx, tx_m) *
                                                        cross_section(*seabed.scattering, above_rx, rx_m)),
                                              motion, path_.beta_per_m));
  const glm::dvec3 there = (place_m - transmit_m) / tx_m, back = (place_m - receive_m) / rx_m;
  if (weighed_)
    amplitude *= amplitude_pattern(channel_->transmit, there) * amplitude_pattern(channel_->receive, back);
  if (path_.over_mirrors()) amplitude *= std::sqrt(path_.passed(there, back));
  return amplitude;
}

}  // namespace tubefoot
