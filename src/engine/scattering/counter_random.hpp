// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cmath>
#include <complex>
#include <cstdint>
#include <numbers>

namespace tubefoot {

/// Philox4x32-10 (Salmon, Moraes, Dror & Shaw, "Parallel random numbers: as easy as 1, 2, 3", SC 2011), a
/// keyed bijection of 128-bit counters. The n-th random number does not depend on the earlier ones.
std::array<std::uint32_t, 4> philox4x32(std::array<std::uint32_t, 4> counter,
                                        std::array<std::uint32_t, 2> key);

/// Purpose of a random number. Numbers of different purposes are independent of each other.
enum class Purpose : std::uint32_t {
  speckle = 0,
  texture = 1,
  noise = 2,
  phase = 3,
  surface_place = 4,    ///< position of the scatterer in a cell of the surface
  surface_mesh = 5,     ///< the field at the scatterer
  surface_texture = 6,  ///< strength of the scatterer
  drawn = 7,            ///< signals drawn from their covariances
  navigation = 8,       ///< noise of recorded positions and attitudes
  targets = 9           ///< numbers, positions and strengths of targets in the water
};

/// The random numbers of one range sample, or of one cell of a lattice in space (given by three numbers).
/// They depend on the seed and the place alone, not on other numbers, threads or the order of calls.
class SampleRandom {
 public:
  SampleRandom(std::uint64_t seed, std::uint32_t ping, std::uint32_t beam, std::uint32_t sample)
      : key_{static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32)},
        ping_(ping),
        beam_(beam),
        sample_(sample) {}

  /// Returns two independent numbers of the open interval (0, 1), odd multiples of 2^-53. `draw` is the
  /// number of the pair within a purpose, below 2^24.
  std::array<double, 2> uniform_pair(Purpose purpose, std::uint32_t draw = 0) const;

 private:
  std::array<std::uint32_t, 2> key_;
  std::uint32_t ping_, beam_, sample_;
};

/// Returns a circular complex normal deviate of mean 0 and E|z|^2 = 1 (Box-Muller).
inline std::complex<double> circular_normal(const std::array<double, 2>& uniform) {
  return std::polar(std::sqrt(-std::log(uniform[0])), 2 * std::numbers::pi * uniform[1]);
}

/// Returns the quantile of a gamma variate of unit mean and variance 1 / shape.
double gamma_quantile(double probability, double shape);
/// Returns the quantile of a normal variate of mean 0 and variance 1.
double normal_quantile(double probability);

}  // namespace tubefoot
