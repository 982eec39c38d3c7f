// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Frequency spectra of wind waves on deep water.
namespace tubefoot {

inline constexpr double standard_gravity_m_s2 = 9.80665;

/// Spectrum of the height of the sea surface,
///     S(w) = alpha g^2 w^-5 exp(-5/4 (wp / w)^4) peak^exp(-(w - wp)^2 / (2 width^2 wp^2)),
/// in m^2 s for the angular frequency w in rad/s. Its integral from 0 to infinity is the variance of the
/// height. On deep water w^2 = g k for the wavenumber k.
class WaveSpectrum {
 public:
  /// Returns the spectrum of a fully developed sea (Pierson & Moskowitz, J. Geophys. Res. 69 (1964) 5181):
  /// alpha = 0.0081, exponent 0.74 (g / (U w))^4. U is the wind speed at 19.5 m, which is 1.026 times the one
  /// at 10 m (Stewart, Introduction to Physical Oceanography, 2008, section 16.4). Throws
  /// std::invalid_argument for a wind speed that is not above 0.
  static WaveSpectrum pierson_moskowitz(double wind_speed_m_s);
  /// Returns the spectrum of a sea that grows along a fetch (JONSWAP; Hasselmann et al., Dtsch. Hydrogr. Z.
  /// Suppl. A8(12), 1973): alpha = 0.076 (U^2 / (g F))^0.22, wp = 22 (g^2 / (U F))^(1/3), peak = 3.3. The
  /// width is 0.07 below wp and 0.09 above. U is the wind speed at 10 m. Throws std::invalid_argument unless
  /// both values are above 0.
  static WaveSpectrum jonswap(double wind_speed_m_s, double fetch_m);

  /// Returns S(w) for w > 0.
  double density(double frequency_rad_s) const;
  double peak_rad_s() const { return peak_rad_s_; }
  /// Returns the variance [m^2] of the height that waves of the frequencies from `lo` to `hi` cause. hi may
  /// be infinite, lo may be 0. Without a raised peak, it has a closed form.
  double variance_m2(double lo_rad_s, double hi_rad_s) const;
  /// Returns the mean-square slope of these waves, over both horizontal axes: the integral of k^2 S. It grows
  /// as the logarithm of hi, which must be finite.
  double slope_variance(double lo_rad_s, double hi_rad_s) const;
  /// Returns four standard deviations of the height.
  double significant_height_m() const;

 private:
  double alpha_ = 0, peak_rad_s_ = 1, peak_ = 1;
};

/// Returns the wavenumber [rad/m] of gravity waves on deep water: w^2 / g.
constexpr double deep_water_wavenumber(double frequency_rad_s) {
  return frequency_rad_s * frequency_rad_s / standard_gravity_m_s2;
}
/// Returns the angular frequency [rad/s] of gravity waves of a wavelength on deep water: sqrt(g k).
double deep_water_frequency(double wavelength_m);

}  // namespace tubefoot
