// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/relief/wave_spectrum.hpp"

// Realisation of a directional wave spectrum as a sum of plane waves (Longuet-Higgins, Cartwright & Smith
// 1963; random phases: Rice 1944).
namespace tubefoot {

/// Directions of waves: energy per angle proportional to cos^(2 exponent)((direction - mean) / 2)
/// (Longuet-Higgins, Cartwright & Smith 1963).
struct WaveDirections {
  double towards_deg = 0;  ///< mean compass direction in which the waves travel
  double exponent = 10;    ///< 0: all directions equally; larger: narrower
};

/// A linear sea surface on deep water,
///     height(x, y, t) = sum of a cos(k (x sin d + y cos d) - w t + p),
/// with x east, y north and compass directions d. Each component stands for a cell of the spectrum in
/// frequency and direction. The integral over the cell is a^2 / 2. The phase p, and the
/// place of frequency and direction in the cell, are random numbers of the seed and the numbers of the cell.
/// A finer `shortest_m` adds components to the same sea. The surface is not periodic.
class WaveSurface {
 public:
  struct Component {
    double amplitude_m = 0;
    double frequency_rad_s = 0;
    double east_rad_m = 0, north_rad_m = 0;  ///< wavenumber
    double cosine = 1, sine = 0;             ///< of the phase p
  };

  /// `shortest_m`: length of the shortest wave. The longest wave has half the frequency of the peak; the
  /// energy of longer waves is below 1e-8 of the total.
  WaveSurface(const WaveSpectrum& spectrum, const WaveDirections& directions, double shortest_m,
              std::uint64_t seed);
  explicit WaveSurface(std::vector<Component> components) : components_(std::move(components)) {}

  std::span<const Component> components() const { return components_; }
  /// Returns the variance of the height over all places, from the amplitudes.
  double variance_m2() const;
  /// Returns the mean-square slope over both axes, from the amplitudes.
  double slope_variance() const;
  /// Returns the sum of the amplitudes. No height is larger.
  double bound_m() const;

 private:
  std::vector<Component> components_;
};

/// The heights of a wave surface at the nodes of a lattice. Thread-safe.
class WaveLattice {
 public:
  /// `east_m`, `north_m`: coordinates of the columns and rows.
  WaveLattice(const WaveSurface& surface, std::span<const double> east_m, std::span<const double> north_m);
  /// Returns the heights by node, row by row from the first north coordinate.
  std::vector<double> heights_m(double time_s) const;

 private:
  struct Wave {
    double amplitude_m, frequency_rad_s, cosine, sine;
  };
  std::size_t columns_, rows_;
  std::vector<Wave> waves_;
  /// cosines and sines of the phases along each axis, by component and node
  std::vector<double> east_cosine_, east_sine_, north_cosine_, north_sine_;
};

}  // namespace tubefoot
