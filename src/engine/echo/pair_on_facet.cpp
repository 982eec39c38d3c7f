// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/echo/pair_on_facet.hpp"

#include <algorithm>
#include <boost/math/special_functions/bessel.hpp>
#include <cmath>
#include <glm/geometric.hpp>

// Evaluates energies of channels and products of two channels on a facet, with patterns, mirror losses,
// texture and phase (pair_on_facet.hpp).

namespace tubefoot {

double amplitude_sign(const Directivity& pattern, double cosine) {
  // All in double, because long double differs between machines.
  using Double = boost::math::policies::policy<boost::math::policies::promote_double<false>>;
  const double w = std::clamp(cosine, -1.0, 1.0);
  switch (pattern.kind) {
    case Directivity::Kind::line:
      return line_amplitude(pattern.size * (w - pattern.centre), pattern.shading) < 0 ? -1 : 1;
    case Directivity::Kind::piston:
      return boost::math::cyl_bessel_j(1, pattern.size * std::sqrt(1 - w * w), Double()) < 0 ? -1 : 1;
    case Directivity::Kind::uniform:
    case Directivity::Kind::gaussian:
    case Directivity::Kind::table:
      break;
  }
  return 1;
}

namespace {

/// Energy of a channel without texture, and the sign of its amplitude.
struct Signed {
  double energy, sign = 1;
};

Signed energy_of(const ChannelOnFacet& channel, const glm::dvec2& p, double tx_m, double rx_m) {
  const PathOnFacet& path = channel.path;
  const auto& [transmit, receive, least, is_signed] = channel.patterns;
  const Directivity& sent = transmit.front();
  const bool uniform = transmit.size() == 1 && sent.kind == Directivity::Kind::uniform &&
                       receive->kind == Directivity::Kind::uniform;
  PathOnFacet::Directions towards;
  if (!uniform || path.over_mirrors()) towards = path.directions(p, tx_m, rx_m);
  const double energy = path.energy(tx_m, rx_m, towards);
  if (uniform) return {energy};
  double gain = 0;
  for (const Directivity& beam : transmit) gain += beam.gain(towards.tx);
  gain *= receive->gain(towards.rx);
  if (!(gain >= least)) return {0};
  if (!is_signed) return {energy * gain};
  return {energy * gain, amplitude_sign(sent, glm::dot(towards.tx, sent.axis)) *
                             amplitude_sign(*receive, glm::dot(towards.rx, receive->axis))};
}

}  // namespace

void PairIntegrand::operator()(const glm::dvec2& p, double tx_m, double rx_m,
                               std::span<double> values) const {
  const Signed one = energy_of(a, p, tx_m, rx_m);
  const double texture = a.path.texture_at(p);
  if (!b) {
    values[0] = one.energy * texture;
    return;
  }
  const double b_tx_m = tx ? b->path.tx.range(p) : tx_m, b_rx_m = b->path.rx.range(p);
  const Signed other = energy_of(*b, p, b_tx_m, b_rx_m);
  double further = rx.at(p, rx_m + b_rx_m);
  if (tx) further += tx->at(p, tx_m + b_tx_m);
  const auto product =
      PairDensity::of(one.energy, other.energy, wavenumber_rad_m * further, texture * one.sign * other.sign);
  values[0] = product.size;
  values[1] = product.real;
  values[2] = product.imag;
}

}  // namespace tubefoot
