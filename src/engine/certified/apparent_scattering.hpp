// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "engine/scattering/echo_model.hpp"
#include "engine/scattering/scattering_model.hpp"
#include "geometry/numbers/interval.hpp"

// Fits scattering models to apparent facets. A ray meets the true facet at an angle of incidence phi, and the
// apparent facet at another angle psi. The fitted model is the true model at phi = offset + slope psi. The
// remaining difference is enclosed. See docs/notes/certified-energies.md, section "Through refracting water".
namespace tubefoot {

/// Rays to a part of a facet. `sine` is the sine of the apparent grazing angle, which is the cosine of the
/// apparent angle of incidence. The ratio is that of the true sine to the apparent sine. The suffixes a and b
/// denote derivatives along the two directions of the facet's plane.
struct GrazingPatch {
  Interval sine, sine_a, sine_b;
  Interval ratio_a, ratio_b;  ///< of the logarithm of the ratio
};

/// Scattering model for an integral over an apparent facet, and the enclosed remainder.
struct ApparentScattering {
  ScatteringModel model;
  /// Logarithm of the ratio of two cross-sections: the true one at the true angle, and that of `model` at
  /// the apparent angle. Twice the logarithm of the ratio of the two sines is subtracted. For Lambert's law
  /// the remainder is 0.
  Interval log_remainder;
};

/// Fits the model of an apparent facet. It is the true model at an angle of incidence that is an affine
/// function of the apparent angle (ScatteringModel::of_angle). The pieces of the fitted model therefore meet
/// at the corresponding apparent angles. The remainder bounds the error of the affine function anywhere on
/// the facet.
///
/// `middle` and the logarithm `log_ratio` of the ratio of the sines belong to the middle of the facet.
/// `patches` cover the whole facet. `largest_change(a, b)` returns the change of a function between the
/// middle and any point of the facet, for derivatives in these intervals. The result is empty if a grazing
/// angle may be 0 or is not bounded.
std::optional<ApparentScattering> apparent_scattering(
    const ScatteringModel& model, const GrazingPatch& middle, const Interval& log_ratio,
    std::span<const GrazingPatch> patches,
    const std::function<Interval(const Interval& a, const Interval& b)>& largest_change);

/// Scattering of a facet.
struct FacetScattering {
  const ScatteringModel* model = nullptr;  ///< null: Lambert's law with mu = 1
  double most = 1;                         ///< largest mu, or 1 with a scattering model, times the texture
};
/// Returns the scattering by material. Throws the errors of certified_textures().
std::vector<FacetScattering> facet_scattering(const EchoModel& model);

/// Returns an upper bound of a model's cross-section over all grazing angles whose sine is in an interval.
double largest_cross_section(const ScatteringModel& model, const Interval& sine);

}  // namespace tubefoot
