// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>

#include "engine/relief/spline_surface.hpp"

// Relief by spectral synthesis. Independent Gaussian amplitudes for the wavenumbers of a periodic tile are
// multiplied by the square root of a spectrum and Fourier transformed (D. Saupe in Peitgen & Saupe, The
// Science of Fractal Images, 1988). docs/notes/textures.md has the formulas. The amplitude of a wavenumber
// depends on the seed and on its two indices alone, so a finer resolution adds detail to the same seabed.
namespace tubefoot {

/// A periodic tile with its south-west corner at the origin of the local frame.
struct ReliefTile {
  double tile_m = 10;         ///< period, east and north
  double resolution_m = 0.1;  ///< upper limit of the node distance
  std::uint64_t seed = 1;

  /// Returns the number of nodes along a side: 4, 5, 6 or 7 times a power of two, at least 16.
  std::size_t nodes() const;
  bool operator==(const ReliefTile&) const = default;
};
/// Maximum number of nodes along a side. Computing a tile takes 25 bytes per node; the result takes 4.
inline constexpr std::size_t kMostNodes = 16384;

/// Isotropic fractional Brownian surface. Its 2-D spectrum of heights is W(K) = w2 (K h0)^-(2 hurst + 2), h0
/// = 1 cm, up to the nodes' Nyquist wavenumber. W is two-sided; its integral over the plane is the variance.
/// APL-UW TR 9407 (1994) gives w2 [cm^4] and the exponent gamma2 = 2 hurst + 2 of sediments.
struct FractalRelief : ReliefTile {
  double hurst = 0.8;  ///< 0 (rough) to 1 (smooth)
  /// Root mean square of this tile. Without it, the heights follow w2, on average over seeds.
  std::optional<double> rms_height_m = {};
  double spectral_strength_cm4 = 0.005;  ///< w2, used if rms_height_m is not set
  bool operator==(const FractalRelief&) const = default;
};

/// Oriented ripples: the real part of a complex fractional Brownian surface times exp(i k0 x). The spectrum's
/// peak is at k0, which is the lattice wavenumber nearest to the requested one.
struct RippleRelief : ReliefTile {
  double wavelength_m = 1;
  double direction_deg = 0;    ///< compass direction of the wave vector, across the crests
  double hurst = 0.9;          ///< a larger value gives a narrower band
  double rms_height_m = 0.01;  ///< root mean square of this tile
  bool operator==(const RippleRelief&) const = default;

  /// Returns the indices of k0: waves per tile, east and north.
  std::array<std::int64_t, 2> carrier() const;
};

/// Return the surfaces. They throw std::invalid_argument for a tile of more than kMostNodes. For ripples they
/// also throw if the node distance is too large for the wavelength, or if the tile is shorter than four
/// wavelengths.
/// @{
std::shared_ptr<const SplineSurface> make_surface(const FractalRelief& relief);
std::shared_ptr<const SplineSurface> make_surface(const RippleRelief& relief);
/// @}

}  // namespace tubefoot
