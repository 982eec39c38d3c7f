// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <numbers>
#include <span>
#include <vector>

// docs/scattering.md
namespace tubefoot {

/// Backscattering cross-section per unit area and steradian as a function of the grazing angle alone.
///
/// Every law here is, between angles of incidence phi (from the normal), a sum of terms
///     level e^(slope (phi - from) - curvature phi^2) cos(phi)^power,
/// analytic in phi: what an integrator needs to know to be exact, or certain, about it.
///
/// Transmitter and separate receiver: sigma(i, s) = sqrt(sigma(i) sigma(s)), which is reciprocal because it
/// is symmetric, is the law itself where both are in the same place, and is Lambert's for Lambert's.
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

  /// Lambert's law, mu sin^2(grazing).
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

  /// Backscatter strength 10 log10 sigma at grazing angles, linear in dB against the angle between them;
  /// below the first angle it falls as sin^2 (as Lambert's), above the last one it is held. Throws
  /// std::invalid_argument unless angles are in (0, 90], increasing, as many as levels and at least one, and
  /// levels are finite, from -300 to 100 dB.
  static ScatteringModel table(std::span<const double> grazing_deg, std::span<const double> strength_db);

  /// Monostatic cross-section; `sine` and `cosine` of the grazing angle, sine > 0, cosine >= 0.
  double cross_section(double sine, double cosine) const;
  double cross_section(double grazing_rad) const;

  /// This law as a function of another angle of incidence psi, from 0 to pi / 2, where its own is
  /// from_rad + stretch psi and its sine of the grazing angle is `sines` times the other one's: the same
  /// terms again. stretch > 0; where its own angle would be below 0, its first terms go on.
  ScatteringModel of_angle(double from_rad, double stretch, double sines) const;

  /// In order of growing incidence; the last one ends at pi / 2.
  const std::vector<Piece>& pieces() const { return pieces_; }
  /// The one that holds an angle of incidence.
  std::size_t piece_at(double incidence_rad) const;
  /// Cross-section by one piece's terms, wherever they are asked for.
  static double in_piece(const Piece& piece, double incidence_rad, double sine);
  /// Whether its slope is not 0 at normal incidence, so that it is no smooth function of position there.
  bool is_pointed() const;

  /// How fast it may grow in the complex plane: |sigma| <= exp(growth(y)) times its largest value over a
  /// stretch of angles, y into the imaginary; powers of the sine are left out, as functions of range.
  double growth(double imaginary_rad) const;
  /// Of the sine.
  double largest_power() const;

  /// The largest exponent that matters: how many times their own rounding its values may carry.
  double steepest_exponent() const;

  /// What is scattered over what is received, Int sigma(i, s) dOmega_s / sin(i), at a grazing angle i.
  double albedo(double grazing_rad) const;
  /// The largest of all angles from least_checked_deg to 90 degrees, by tenths of a degree and the pieces'
  /// ends.
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
