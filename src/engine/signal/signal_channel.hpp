// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <complex>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include "engine/echo/path_on_facet.hpp"
#include "engine/scattering/beam_pattern.hpp"
#include "engine/signal/platform_motion.hpp"
#include "engine/signal/visible_polygons.hpp"

// Signals are analytic with the time factor e^{-i omega t}. A path of length L has the phase factor
// e^{+ikL}.
namespace tubefoot {

/// One transmission as one receiver receives it: an element, a beam, a ping, or a combination. Over mirrors
/// the ends are images, and the model contains the losses of the mirrors.
struct SignalChannel {
  glm::dvec3 transmit_m{0}, receive_m{0};  ///< local frame
  Directivity transmit{}, receive{};       ///< power patterns; amplitudes have the signs of side lobes
  /// Positions of moving ends, which replace the fixed positions. The axes of the patterns do not move. The
  /// transmit motion is evaluated from the begin to the end of the pulse. The receive motion is evaluated
  /// from the first sample to one sample after the last.
  PlatformMotion transmit_motion{}, receive_motion{};

  bool has_path() const { return transmit_motion != nullptr || receive_motion != nullptr; }
};

/// Amplitude pattern, whose square is the power pattern. It is real and 1 on the axis. Its sign alternates
/// from lobe to lobe for a line array and a piston.
double amplitude_pattern(const Directivity& pattern, glm::dvec3 direction);

/// Channel on the plane of one visible polygon.
class ChannelOnPolygon {
 public:
  ChannelOnPolygon(const SignalChannel& channel, const VisiblePolygons& seen, const VisiblePolygon& patch,
                   const EchoModel& model);

  /// Whether both ends lie on the visible side. Otherwise the channel receives nothing from the polygon.
  bool faces() const { return path_.tx.over.distance > 0 && path_.rx.over.distance > 0; }

  struct Reception {
    double path_m = 0;     ///< transmit leg plus receive leg
    double amplitude = 0;  ///< square: energy of 1 m² of uniform seabed, for 1 J/sr at 1 m
  };
  /// `place_m`: on the plane of the polygon, relative to the polygons' origin.
  Reception at(glm::dvec3 place_m) const {
    const glm::dvec3 there = place_m - transmit_m_, back = place_m - receive_m_;
    const double tx = glm::length(there), rx = glm::length(back);
    return {tx + rx, amplitude(path_.density_at(tx, rx), there, back, tx, rx)};
  }
  /// Amplitude for other positions of the ends, with their distances from the place. 0 behind the plane.
  double amplitude_from(glm::dvec3 place_m, glm::dvec3 transmit_m, glm::dvec3 receive_m, double tx_m,
                        double rx_m) const;

  const PathOnFacet& path() const { return path_; }

 private:
  /// `there_m`, `back_m`: vectors from both ends to the place, whose lengths are the ranges.
  double amplitude(double density, glm::dvec3 there_m, glm::dvec3 back_m, double tx_m, double rx_m) const {
    double size = std::sqrt(density);
    if (!weighed_ && !path_.over_mirrors()) return size;
    const PathOnFacet::Directions towards{there_m / tx_m, back_m / rx_m};
    if (weighed_)
      size *= amplitude_pattern(channel_->transmit, towards.tx) *
              amplitude_pattern(channel_->receive, towards.rx);
    return path_.over_mirrors() ? size * std::sqrt(path_.passed(towards)) : size;
  }

  const SignalChannel* channel_;
  glm::dvec3 transmit_m_, receive_m_;  // relative to the polygons' origin
  glm::dvec3 normal_;
  PathOnFacet path_;
  bool weighed_;
};

/// Texture factor at a place relative to the polygons' origin; 1: uniform.
inline double texture_at(const SurfaceProperties& seabed, const VisiblePolygons& seen, glm::dvec3 place_m) {
  return seabed.texture == nullptr ? 1 : seabed.texture->factor(seen.origin_m + place_m);
}

}  // namespace tubefoot
