// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <variant>

#include "files/input_error.hpp"

// Part of the description of a scene file: scene/description/scene_description.hpp.
namespace tubefoot {

/// Relief of a material as a fractional Brownian surface. Keys are 'hurst' or 'spectral_exponent' (2 hurst
/// + 2), and 'rms_height_m' or 'spectral_strength_cm4'.
struct FractalReliefDescription {
  std::optional<double> hurst, spectral_exponent, rms_height_m, spectral_strength_cm4;
  bool operator==(const FractalReliefDescription&) const = default;
};
/// Ripples with a translated spectrum.
struct RippleReliefDescription {
  double wavelength_m = 1;
  double direction_deg = 0;  ///< compass direction of the wave vector (across the crests)
  double rms_height_m = 0.01;
  double hurst = 0.9;  ///< width of the band; larger values give a narrower band
  bool operator==(const RippleReliefDescription&) const = default;
};
/// A measured map of deviations from the facets.
struct MapReliefDescription {
  std::filesystem::path file;  ///< path resolved against the scene file's folder
  std::optional<double>
      tile_m;        ///< width of the repeated map; by default the map lies at its georeferenced position
  double scale = 1;  ///< factor for its heights
  bool operator==(const MapReliefDescription&) const = default;
};
struct ReliefDescription {
  SourcePlace place;
  double tile_m = 0;  ///< period of synthesised relief
  double resolution_m = 0;
  std::uint64_t seed = 1;
  std::variant<FractalReliefDescription, RippleReliefDescription, MapReliefDescription> kind;
};

}  // namespace tubefoot
