// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>

#include "engine/relief/spline_surface.hpp"

// Relief by spectral synthesis: independent Gaussian amplitudes for the wavenumbers of a periodic tile, times
// the root of a spectrum, and a Fourier transform (D. Saupe in Peitgen & Saupe, The Science of Fractal
// Images, 1988). docs/textures.md has the formulas. A wavenumber's amplitude depends on the seed and on its
// two indices alone: a finer resolution adds detail to the same seabed.
namespace tubefoot {

/// A periodic tile, its south-west corner at the origin of the local frame.
struct ReliefTile {
  double tile_m = 10;         ///< period, east and north
  double resolution_m = 0.1;  ///< nodes are no farther apart
  std::uint64_t seed = 1;

  /// Nodes along a side: 4, 5, 6 or 7 times a power of two, at least 16.
  std::size_t nodes() const;
  bool operator==(const ReliefTile&) const = default;
};
/// No tile has more along a side: building one takes 25 bytes a node, keeping it 4.
inline constexpr std::size_t kMostNodes = 16384;

/// Fractional Brownian surface: isotropic, with the 2-D spectrum of heights W(K) = w2 (K h0)^-(2 hurst + 2),
/// h0 = 1 cm (W is two-sided, its integral over the plane is the variance), up to the nodes' Nyquist
/// wavenumber. APL-UW TR 9407 (1994) gives w2 [cm^4] and the exponent gamma2 = 2 hurst + 2 of sediments.
struct FractalRelief : ReliefTile {
  double hurst = 0.8;  ///< 0 (rough) to 1 (smooth)
  /// Of this very tile; else of w2, in the mean over seeds.
  std::optional<double> rms_height_m = {};
  double spectral_strength_cm4 = 0.005;  ///< w2, where there is no rms height
  bool operator==(const FractalRelief&) const = default;
};

/// Oriented ripples: a complex fractional Brownian surface times exp(i k0 x), its real part. The spectrum's
/// peak is moved to k0, the lattice's wavenumber nearest to the wanted one.
struct RippleRelief : ReliefTile {
  double wavelength_m = 1;
  double direction_deg = 0;    ///< compass direction of the wave vector, across the crests
  double hurst = 0.9;          ///< the larger, the narrower the band
  double rms_height_m = 0.01;  ///< of this very tile
  bool operator==(const RippleRelief&) const = default;

  /// k0's indices, waves per tile, east and north.
  std::array<std::int64_t, 2> carrier() const;
};

/// The surfaces. They throw std::invalid_argument for a tile of more than kMostNodes, or ripples whose
/// wavelength the nodes cannot show or the tile does not hold four times.
/// @{
std::shared_ptr<const SplineSurface> make_surface(const FractalRelief& relief);
std::shared_ptr<const SplineSurface> make_surface(const RippleRelief& relief);
/// @}

}  // namespace tubefoot
