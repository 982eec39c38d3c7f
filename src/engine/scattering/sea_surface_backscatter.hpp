// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "engine/scattering/scattering_model.hpp"

// Backscattering of the sea surface from below, 10 to 100 kHz (APL-UW TR 9407, High-Frequency Ocean
// Environmental Acoustic Models Handbook, 1994). The note docs/notes/sea-surface.md lists the equations,
// their sources and their verification.
namespace tubefoot {

/// Wind speed 10 m above the sea, and acoustic frequency.
struct SeaSurfaceBackscatter {
  double wind_speed_m_s = 5;
  double frequency_khz = 30;
  /// Mean-square slope, over both axes, of the waves that facets already show. The roughness of the model has
  /// only the rest.
  double resolved_slope_variance = 0;
};

/// Frequencies for which the handbook gives the model, and wind speeds of its published curves.
inline constexpr double sea_surface_lowest_khz = 10, sea_surface_highest_khz = 100;
inline constexpr double sea_surface_least_wind_m_s = 3, sea_surface_most_wind_m_s = 15;
/// Part of the mean-square slope that the model keeps, even if facets show more of it.
inline constexpr double least_unresolved_slope = 0.1;

/// The parts of the backscattering cross-section per unit area and steradian, at a grazing angle.
struct SeaSurfaceCrossSections {
  double facets = 0;       ///< specular reflection from wave facets (high-frequency Kirchhoff)
  double small_scale = 0;  ///< composite roughness
  double share_of_facets = 0;
  double bubble_loss_db = 0;  ///< two-way loss of both above, in the layer of bubbles
  double bubbles = 0;         ///< resonant bubbles below the surface

  double roughness() const;
  double total() const { return roughness() + bubbles; }
};

/// Returns the mean-square slope of the sea, over both axes: 4.6e-3 ln(2.1 U^2) for U >= 1 m/s, 0.0034 below.
double sea_surface_slope_variance(double wind_speed_m_s);

/// Evaluates the equations. grazing_rad: above 0, to pi / 2. Throws std::invalid_argument for a frequency or
/// a wind speed that is not above 0.
SeaSurfaceCrossSections sea_surface_cross_sections(const SeaSurfaceBackscatter& sea, double grazing_rad);

/// Returns the model as a table of strengths from 1 to 90 degrees, within 0.03 dB of the equations. Below 1
/// degree it decreases as Lambert's law. Throws the errors of sea_surface_cross_sections().
ScatteringModel sea_surface_scattering(const SeaSurfaceBackscatter& sea);

}  // namespace tubefoot
