// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <functional>
#include <optional>
#include <span>

#include "engine/scattering/beam_pattern.hpp"
#include "engine/scattering/path.hpp"
#include "engine/scattering/range_samples.hpp"
#include "engine/water/ray_enclosure.hpp"
#include "geometry/mesh/facet_mesh.hpp"
#include "geometry/numbers/ball.hpp"

namespace tubefoot {

/// Sound that travels from an apex or its image to a receiver without scattering (path_echo.hpp).
struct Arrival {
  GridPoint displacement{};  ///< vector from the source to the receiver, in grid units
  double unit_m = 1;         ///< metres per grid unit
  double absorption_db_per_m = 0;
  const Leg* leg = nullptr;                   ///< leg of the image
  const TransmitPattern* transmit = nullptr;  ///< null: without patterns
  std::span<const Directivity> receive{};     ///< by beam; without patterns there is one beam
};

using TakeArrival = std::function<void(std::size_t beam, std::size_t sample, double energy, double bound)>;
/// Encloses an arrival. `take` receives energy and half-width of its bound by beam and sample. If half the
/// path length may lie on a border between samples, each of these samples receives an interval from zero to
/// the whole energy.
void certify_arrival(const Arrival& arrival, const RangeSamples& samples, const TakeArrival& take);

/// Ray from an apex, or over mirrors, to a point.
struct EnclosedRay {
  Ball half_path_m;  ///< half of the distance that sound covers in the travel time at the reference speed
  Ball energy;       ///< energy per square metre at the point for 1 J/sr, without mirror losses
  std::array<Ball, 3> sent, arrives;  ///< directions of travel, unit vectors: at the image, and at the point
};
/// Returns nothing if it is not proven that exactly one ray exists.
std::optional<EnclosedRay> enclose_ray(const ApparentMap& water, const RayEnclosure& rays,
                                       const glm::dvec3& place_m);
/// Encloses an arrival along a ray. `sure` is false if the arrival may not exist. The members of `arrival`
/// for the vector, the grid unit and isovelocity absorption are not used.
void certify_arrival(const EnclosedRay& ray, const Arrival& arrival, bool sure, const RangeSamples& samples,
                     const TakeArrival& take);

/// A value with the half-width of its bound.
struct Bounded {
  double value = 0, bound = 0;
};

/// Encloses the mean product of the signals of a receiver pair for sound that arrives from one point without
/// scattering. It is the geometric mean of both energies, with the phase difference between the two
/// receivers. `displacement`: vector from the source to the middle of the pair, in grid units. Returns real
/// and imaginary part.
std::array<Bounded, 2> certify_arrivals_product(const GridPoint& displacement, double unit_m,
                                                const ReceiverBaseline& receiver_pair, const Bounded& upper,
                                                const Bounded& lower);

}  // namespace tubefoot
