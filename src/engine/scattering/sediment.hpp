// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <string_view>
#include <vector>

// Acoustic properties of sediments. See docs/notes/scattering.md.
namespace tubefoot {

/// Backscattering strength of a sediment [dB] at the grazing angles of `sediment_grazing_deg`, at one
/// frequency. The values are samples of the small-slope elastic model of the Applied Physics Laboratory,
/// University of Washington (APL-UW TM 2-00).
struct SedimentBackscatter {
  std::string_view name;  ///< e.g. "coarse sand"
  double frequency_khz = 0;
  std::array<double, 8> strength_db{};
};
inline constexpr std::array<double, 8> sediment_grazing_deg{5, 10, 20, 30, 45, 60, 80, 90};

/// Names of the sediments, coarsest first.
const std::vector<std::string_view>& sediment_names();

/// Throws std::invalid_argument for a name or a frequency without a table.
const SedimentBackscatter& sediment_backscatter(std::string_view name, double frequency_khz);

/// A table is valid for one frequency. It is used without a warning up to this ratio above or below that
/// frequency.
inline constexpr double sediment_frequency_ratio = 1.5;

/// Acoustic parameters of a fluid seabed (APL-UW TR 9407, 1994).
struct FluidSediment {
  double density_ratio = 1;  ///< ratio of the seabed's to the water's density
  double speed_ratio = 1;
  double loss = 0;  ///< ratio of the imaginary to the real part of the wavenumber
};

/// Computes the parameters from the mean grain size Mz [phi], -1 to 9, with the polynomials of APL-UW TR
/// 9407. Nominal band 10-100 kHz. Throws std::invalid_argument outside.
FluidSediment sediment_of_grain_size(double grain_size_phi);

/// Computes the parameters from measured ratios of density and sound speed, and attenuation in dB per
/// wavelength.
FluidSediment fluid_sediment(double density_ratio, double speed_ratio, double attenuation_db_per_wavelength);

}  // namespace tubefoot
