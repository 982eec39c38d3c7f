// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>

#include "files/input_error.hpp"

// Part of the description of a scene file: scene/description/scene_description.hpp.
namespace tubefoot {

/// A horizontal mirror above the scene. With `size_m`, the sea surface also has facets that move as waves.
struct SeaSurfaceDescription {
  SourcePlace place;
  double height_m = 0;  ///< of the mirror, and mean height of the waves
  double loss_db = 0;   ///< loss per reflection
  /// Standard deviation of the height; causes a further (Rayleigh) loss. Default: that of the wave spectrum
  /// for a surface with facets, otherwise 0.
  std::optional<double> rms_roughness_m;
  std::optional<std::array<double, 2>> size_m;  ///< of the facets: east, north; if empty, there are none
  std::array<double, 2> centre_m{0, 0};         ///< of the facets: east, north
  double cell_m = 0.5;                          ///< largest side of a cell of two facets
  double wind_speed_m_s = 0;                    ///< 10 m above the sea surface
  double wind_direction_deg = 0;                ///< compass direction from which the wind blows
  std::string spectrum = "pierson-moskowitz";   ///< pierson-moskowitz | jonswap
  double fetch_m = 0;                           ///< jonswap
  double spreading = 10;                        ///< exponent s of cos^2s(half the angle from the wind)
  std::uint64_t seed = 1;
  std::string material;  ///< empty: the scattering model of the sea surface
  SourcePlace material_place;
  std::optional<double> scattering_khz;  ///< frequency of that model; default: of the first sensor

  bool has_facets() const { return size_m.has_value(); }
};

}  // namespace tubefoot
