// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <optional>
#include <span>

#include "engine/echo/path_on_facet.hpp"
#include "engine/scattering/pair_density.hpp"

// Defines the integrand of a pair of channels on the plane of one facet (pair_density.hpp). Receiver pairs
// and covariances of range bins use it. The caller chooses the polygons, and the samples of both channels
// (PathCutter).
namespace tubefoot {

/// Sign of a pattern's amplitude, whose square is the power pattern. It alternates from lobe to lobe for a
/// line array and a piston. `cosine`: between the direction and the pattern's axis.
double amplitude_sign(const Directivity& pattern, double cosine);

/// Patterns of a channel.
struct ChannelPatterns {
  std::span<const Directivity> transmit;  ///< simultaneous beams
  const Directivity* receive = nullptr;
  double least = 0;        ///< smallest two-way gain that counts
  bool is_signed = false;  ///< whether amplitudes have the signs of side lobes; for a single transmit beam
};

struct ChannelOnFacet {
  PathOnFacet path;
  ChannelPatterns patterns;
};

/// Difference of the ranges of a plane's points from two ends (range_difference()).
struct RangeDifference {
  /// Coefficients of x, y and the foot point for the product of `axis` and a place from the middle of the
  /// ends.
  glm::dvec3 along{0};
  double length_m = 0;

  /// The ends lie at `length_m` / 2 from their middle, the first one in the direction of `axis`.
  static RangeDifference of(const FacetPlane& plane, const PlaneFrame& frame, glm::dvec3 middle_m,
                            glm::dvec3 axis, double length_m) {
    return {{glm::dot(frame.u, axis), glm::dot(frame.v, axis),
             -plane.distance_m * glm::dot(plane.normal, axis) - glm::dot(middle_m, axis)},
            length_m};
  }
  double at(const glm::dvec2& p, double sum_of_ranges) const {
    return range_difference(length_m * (along.x * p.x + along.y * p.y + along.z), sum_of_ranges);
  }
};

/// Energy of channel a, or its product with channel b.
struct PairIntegrand {
  ChannelOnFacet a;
  std::optional<ChannelOnFacet> b{};
  double wavenumber_rad_m = 0;
  RangeDifference rx{};                 ///< range from the receiver of a minus that from the receiver of b
  std::optional<RangeDifference> tx{};  ///< the same for the transmitters; none: a common transmitter

  /// One value is the energy. Three values are those of PairDensity.
  std::size_t values() const { return b ? 3 : 1; }
  /// Values per square metre. `tx_m`, `rx_m`: ranges of the point from the ends of channel a. The point is a
  /// reference, because GCC 12 copies a pair of doubles by a 16-byte load right after two 8-byte stores.
  void operator()(const glm::dvec2& p, double tx_m, double rx_m, std::span<double> values) const;
};

}  // namespace tubefoot
