// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <string_view>
#include <vector>

// What sound meets in a seabed of a given sediment. docs/scattering.md
namespace tubefoot {

/// Backscatter strength of a sediment [dB] at the grazing angles of `sediment_grazing_deg`, at one frequency:
/// the small-slope elastic model of the Applied Physics Laboratory, University of Washington (APL-UW TM
/// 2-00), sampled.
struct SedimentBackscatter {
  std::string_view name;  ///< e.g. "coarse sand"
  double frequency_khz = 0;
  std::array<double, 8> strength_db{};
};
inline constexpr std::array<double, 8> sediment_grazing_deg{5, 10, 20, 30, 45, 60, 80, 90};

/// Names of the sediments, coarsest first.
const std::vector<std::string_view>& sediment_names();

/// Throws std::invalid_argument for a name or a frequency that has no table.
const SedimentBackscatter& sediment_backscatter(std::string_view name, double frequency_khz);

/// A table is at one frequency; up to this ratio above or below it is used without a warning.
inline constexpr double sediment_frequency_ratio = 1.5;

/// A fluid seabed as sound sees it (APL-UW TR 9407, 1994).
struct FluidSediment {
  double density_ratio = 1;  ///< seabed over water
  double speed_ratio = 1;
  double loss = 0;  ///< imaginary over real part of the wavenumber
};

/// From mean grain size Mz [phi], -1 to 9, by the polynomials of APL-UW TR 9407. Nominal band 10-100 kHz.
/// Throws std::invalid_argument outside.
FluidSediment sediment_of_grain_size(double grain_size_phi);

/// From measured density and sound speed ratio, and attenuation in dB per wavelength.
FluidSediment fluid_sediment(double density_ratio, double speed_ratio, double attenuation_db_per_wavelength);

}  // namespace tubefoot
