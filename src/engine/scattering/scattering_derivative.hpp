// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "engine/scattering/scattering_model.hpp"

// Derivatives of scattering models by the angle and by their parameters.
namespace tubefoot {

/// A cross-section with its derivatives. The angle of incidence phi and the sine of the grazing angle are
/// independent variables here, as in the terms of ScatteringModel.
struct CrossSectionSlopes {
  double value = 0;
  double by_log_sine = 0;   ///< by the logarithm of the sine
  double by_incidence = 0;  ///< by phi
};
/// The arguments are those of ScatteringModel::cross_section().
CrossSectionSlopes slopes_of(const ScatteringModel& model, double sine, double cosine);

/// The derivative of a model's cross-section by one of its numeric parameters, at fixed angle. It is the sum
/// over the terms of a piece of the term times
///     constant + linear (phi - from) + square phi^2 + log log(sine).
class ScatteringDerivative {
 public:
  enum class Gsab {
    specular,
    specular_width_rad,
    oblique,
    oblique_exponent,
    transition,
    transition_width_rad
  };
  /// The factories throw the exceptions of the factories of ScatteringModel. `which` below the number of
  /// angles; otherwise std::invalid_argument.
  static ScatteringDerivative gsab(const ScatteringModel::Gsab& parameters, Gsab which);
  /// Derivative by level `which` of a table, per dB.
  static ScatteringDerivative table_strength(std::span<const double> grazing_deg,
                                             std::span<const double> strength_db, std::size_t which);
  /// Derivative by grazing angle `which` of a table, per degree.
  static ScatteringDerivative table_angle(std::span<const double> grazing_deg,
                                          std::span<const double> strength_db, std::size_t which);

  /// Returns this derivative times a factor, for a parameter in another unit.
  ScatteringDerivative scaled(double factor) const;

  /// The arguments are those of ScatteringModel::cross_section().
  double cross_section(double sine, double cosine) const;

 private:
  struct Factor {
    double constant = 0, linear = 0, square = 0, log = 0;
  };
  static ScatteringDerivative table(std::span<const double> grazing_deg, std::span<const double> strength_db,
                                    std::size_t which, bool by_angle);

  ScatteringModel model_ = ScatteringModel::lambert(1);  ///< the terms, with their own levels
  std::vector<std::vector<Factor>> factors_;             ///< [piece][term]
};

}  // namespace tubefoot
