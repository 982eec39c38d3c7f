// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "engine/scattering/perlin.hpp"
#include "engine/scattering/reflectivity_field.hpp"

namespace tubefoot {

/// Octaves of improved Perlin noise:
///     factor = 1 + depth sum_i persistence^i noise(2^i place / wavelength) / sum_i persistence^i.
/// The mean over 256 of the longest wavelengths along the frame's x, y or z is 1. The reason is that each
/// gradient of the table occurs once there (perlin.hpp). The standard deviation of one octave is 0.2704
/// depth.
class PerlinReflectivity : public ReflectivityField {
 public:
  struct Settings {
    double wavelength_m = 0.5;
    int octaves = 1;
    double persistence =
        0.5;              ///< ratio of an octave's amplitude to that of the octave with twice the wavelength
    double depth = 0.25;  ///< 0 to 1 / PerlinLattice::largest, so that no factor is negative
    std::uint64_t seed = 1;
  };
  static constexpr int most_octaves = 16;

  /// Throws std::invalid_argument for a wavelength that is not above 0 and finite, or a number of octaves
  /// outside of 1 to most_octaves. Also throws it for a persistence outside of [0, 1] or a depth that would
  /// make factors negative.
  explicit PerlinReflectivity(const Settings& settings);

  const Settings& settings() const { return settings_; }
  const PerlinLattice& lattice() const { return lattice_; }
  /// A summand amplitude noise(per_m place) of the factor.
  struct Octave {
    double per_m, amplitude;
  };
  const std::vector<Octave>& octaves() const { return octaves_; }

  double factor(glm::dvec3 place_m) const override;
  double largest() const override;
  double finest_m() const override;
  std::span<const CellPlanes> cells() const override { return cells_; }
  double change(double away_m) const override;

 private:
  Settings settings_;
  PerlinLattice lattice_;
  std::vector<Octave> octaves_;
  std::vector<CellPlanes> cells_;
};

}  // namespace tubefoot
