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

/// What comes straight from an apex, or from its image, to a receiver (path_echo.hpp).
struct Arrival {
  GridPoint displacement{};  ///< from the one to the other, grid units
  double unit_m = 1;         ///< of the grid
  double absorption_db_per_m = 0;
  const Leg* leg = nullptr;                   ///< of the image
  const TransmitPattern* transmit = nullptr;  ///< null: without patterns
  std::span<const Directivity> receive{};     ///< by beam; without patterns one beam receives it
};

using TakeArrival = std::function<void(std::size_t beam, std::size_t sample, double energy, double bound)>;
/// Encloses it: by beam and sample, energy and half-width of its bound. Where a border between samples may be
/// all of the path's half, from nothing to all of it is in either.
void certify_arrival(const Arrival& arrival, const RangeSamples& samples, const TakeArrival& take);

/// A ray from an apex, or over mirrors, to a place.
struct EnclosedRay {
  Ball half_path_m;  ///< half of what sound covers in its time at the reference speed
  Ball energy;       ///< of 1 J/sr what passes a square metre there, but for what mirrors take
  std::array<Ball, 3> sent, arrives;  ///< directions of travel, unit vectors; as the image has it, and there
};
/// None where it is not proven that there is one.
std::optional<EnclosedRay> enclose_ray(const ApparentMap& water, const RayEnclosure& rays,
                                       const glm::dvec3& place_m);
/// What comes along it; `sure`: or nothing does. Of `arrival` the way and what is about isovelocity water are
/// not read.
void certify_arrival(const EnclosedRay& ray, const Arrival& arrival, bool sure, const RangeSamples& samples,
                     const TakeArrival& take);

/// A value with the half-width of its bound.
struct Bounded {
  double value = 0, bound = 0;
};

/// What the signals of two receivers on a receiver pair, of these energies, have in common that came straight
/// from one place: the root of both energies, with the phase between the two ends. `displacement`: from there
/// to the receiver pair's middle, grid units. Real and imaginary part.
std::array<Bounded, 2> certify_arrivals_product(const GridPoint& displacement, double unit_m,
                                                const ReceiverBaseline& receiver_pair, const Bounded& upper,
                                                const Bounded& lower);

}  // namespace tubefoot
