// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <numbers>
#include <span>
#include <vector>

// Scattering models: backscattering cross-section as a function of the grazing angle, by Lambert's law, by
// the generic seafloor model of Lamarche et al. (2011) or by a table. Source and formulas:
// docs/notes/scattering.md.
namespace tubefoot {

/// Backscattering cross-section per unit area and steradian as a function of the grazing angle alone.
///
/// The angle of incidence phi is measured from the normal. Every model is piecewise a sum of terms
///     level e^(slope (phi - from) - curvature phi^2) cos(phi)^power.
/// The terms are analytic in phi, so an integrator can bound its error.
///
/// For a transmitter and a separate receiver sigma(i, s) = sqrt(sigma(i) sigma(s)). This is symmetric and
/// therefore reciprocal. It equals the model itself for transmitter and receiver at one position, and
/// Lambert's law for Lambert's law.
class ScatteringModel {
 public:
  struct Term {
    double level = 0;  ///< linear, >= 0
    double slope = 0, curvature = 0, power = 0;
  };
  /// Angles of incidence [from, to) in radians.
  struct Piece {
    double from = 0, to = std::numbers::pi / 2;
    std::vector<Term> terms{};
  };

  /// Returns Lambert's law, mu sin^2(grazing).
  static ScatteringModel lambert(double mu);

  /// Generic seafloor backscatter (Lamarche, Lurton, Verdier & Augustin 2011):
  ///     A exp(-phi^2 / (2 B^2)) + C cos^D phi + E exp(-phi^2 / (2 F^2)).
  struct Gsab {
    double specular = 0, specular_width_rad = 1;      ///< A, B
    double oblique = 0, oblique_exponent = 2;         ///< C, D
    double transition = 0, transition_width_rad = 1;  ///< E, F
  };
  /// Throws std::invalid_argument for levels that are negative or not finite, widths not above 0, an exponent
  /// below 0, or no level at all.
  static ScatteringModel gsab(const Gsab& parameters);

  /// Returns a model of backscattering strengths 10 log10 sigma at grazing angles, linear in dB against the
  /// angle between them. Below the first angle it decreases as sin^2 (as Lambert's law); above the last one
  /// it is constant. Throws std::invalid_argument unless the angles are in (0, 90] and increasing, with one
  /// level per angle and at least one. Levels must be finite, from -300 to 100 dB.
  static ScatteringModel table(std::span<const double> grazing_deg, std::span<const double> strength_db);

  /// Returns the monostatic cross-section, from sine and cosine of the grazing angle; sine > 0, cosine >= 0.
  double cross_section(double sine, double cosine) const;
  double cross_section(double grazing_rad) const;

  /// Returns this model as a function of another angle of incidence psi, from 0 to pi / 2. Its own angle is
  /// from_rad + stretch psi, and its own sine of the grazing angle is `sines` times the other one. The result
  /// has the same kind of terms. stretch > 0. If its own angle is below 0, its first terms are continued.
  ScatteringModel of_angle(double from_rad, double stretch, double sines) const;

  /// Pieces by increasing angle of incidence; the last one ends at pi / 2.
  const std::vector<Piece>& pieces() const { return pieces_; }
  /// Returns the number of the piece that contains an angle of incidence.
  std::size_t piece_at(double incidence_rad) const;
  /// Returns the cross-section from the terms of one piece, also for angles outside of it.
  static double in_piece(const Piece& piece, double incidence_rad, double sine);
  /// Returns whether the slope is not 0 at normal incidence. The cross-section is then not a smooth function
  /// of position there.
  bool is_pointed() const;

  /// Returns a bound on the growth in the complex plane, for imaginary parts up to y. |sigma| is at most
  /// exp(growth(y)) times its largest value over a range of angles. Powers of the sine are excluded, because
  /// they are functions of range.
  double growth(double imaginary_rad) const;
  /// Returns the largest power of the sine.
  double largest_power() const;

  /// Returns the largest relevant exponent, which is the amplification of rounding errors in the values.
  double steepest_exponent() const;

  /// Returns the ratio of scattered to received energy, Int sigma(i, s) dOmega_s / sin(i), at a grazing angle
  /// i.
  double albedo(double grazing_rad) const;
  /// Largest albedo for angles from least_checked_deg to 90 degrees, evaluated in steps of a tenth of a
  /// degree and at the ends of the pieces.
  struct Albedo {
    double grazing_rad = 0, value = 0;
  };
  Albedo largest_albedo() const;
  static constexpr double least_checked_deg = 0.1;

 private:
  double half_albedo() const;

  std::vector<Piece> pieces_;
};

}  // namespace tubefoot
