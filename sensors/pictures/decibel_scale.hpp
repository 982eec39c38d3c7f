// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>

#include "sensors/pictures/canvas.hpp"

namespace tubefoot {

/// Colours for what has no level, and around the data.
struct Palette {
  Colour background{0.155f, 0.165f, 0.18f};
  Colour ink{0.90f, 0.90f, 0.88f};
  Colour faint_ink{0.62f, 0.64f, 0.66f};
  Colour grid{0.75f, 0.85f, 0.90f};
  Colour no_echo{0.05f, 0.07f, 0.20f};
  Colour beyond{0.255f, 0.275f, 0.30f};  ///< where a beam has no surface any more (Recording::surfaces)
};
inline constexpr Palette palette;

/// How a picture shows energies: in dB below its brightest echoes, dark copper to pale.
class DecibelScale {
 public:
  /// Dynamic range of the pictures. Weaker echoes have the darkest colour of the scale.
  static constexpr double range_db = 50;

  /// 0 dB is the 99.9th percentile of the energies above zero, so that a few specular returns do not darken
  /// the rest. A display gain makes all echoes brighter by that amount.
  explicit DecibelScale(std::span<const double> energies_j, double display_gain_db = 0);

  /// Energy [J/m^2] that is shown as 0 dB; 0 without echoes.
  double reference_j() const { return reference_j_; }
  /// 0 (no echo, or range_db below the reference) to 1 (the reference and above).
  double level(double energy_j) const;
  /// Returns palette.no_echo for a zero energy, so that a shadow differs from a weak echo.
  Colour colour(double energy_j) const { return energy_j > 0 ? at_level(level(energy_j)) : palette.no_echo; }
  /// Colour of a pixel of which the fraction `beyond` contains no surface (Recording::surfaces).
  Colour colour(double energy_j, double beyond) const;
  /// Lightness grows linearly with the level, so that the picture is also readable in grey.
  static Colour at_level(double level);

  /// Draws a bar with its labels into the pixels [x, x + legend_width) x [y0, y1).
  void draw_legend(Canvas& canvas, int x, int y0, int y1) const;
  static constexpr int legend_width = 96;

 private:
  double reference_j_ = 0;
};

inline constexpr int title_size = 22, label_size = 17;

}  // namespace tubefoot
