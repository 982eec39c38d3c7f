// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/signal/signal_channel.hpp"

#include "engine/echo/pair_on_facet.hpp"

namespace tubefoot {

double amplitude_pattern(const Directivity& pattern, glm::dvec3 direction) {
  const double cosine = glm::dot(direction, pattern.axis);
  return amplitude_sign(pattern, cosine) * std::sqrt(pattern.gain_at(cosine));
}

ChannelOnPolygon::ChannelOnPolygon(const SignalChannel& channel, const VisiblePolygons& seen,
                                   const VisiblePolygon& patch, const EchoModel& model)
    : channel_(&channel),
      transmit_m_(channel.transmit_m - seen.origin_m),
      receive_m_(channel.receive_m - seen.origin_m),
      normal_(patch.normal),
      weighed_(channel.transmit.kind != Directivity::Kind::uniform ||
               channel.receive.kind != Directivity::Kind::uniform) {
  const FacetPlane plane{normal_, patch.distance_m + glm::dot(normal_, transmit_m_)};
  const PlaneFrame frame(plane);
  path_ =
      PathOnFacet(plane, frame, {plane.distance_m, glm::dvec2(0)},
                  {patch.distance_m + glm::dot(normal_, receive_m_), frame.project(receive_m_ - transmit_m_)},
                  patch.facet, model);
}

double ChannelOnPolygon::amplitude_from(glm::dvec3 place_m, glm::dvec3 transmit_m, glm::dvec3 receive_m,
                                        double tx_m, double rx_m) const {
  const double above_tx = path_.tx.over.distance + glm::dot(normal_, transmit_m - transmit_m_),
               above_rx = path_.rx.over.distance + glm::dot(normal_, receive_m - receive_m_);
  if (!(above_tx > 0 && above_rx > 0)) return 0;
  return amplitude(path_.density_between(above_tx, above_rx, tx_m, rx_m), place_m - transmit_m,
                   place_m - receive_m, tx_m, rx_m);
}

}  // namespace tubefoot
