// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <optional>
#include <span>

#include "engine/scattering/scattering_model.hpp"
#include "geometry/numbers/interval.hpp"

// Scattering laws on facets that are seen elsewhere: the angle at which a ray meets a facet is not that at
// which it is seen to meet the apparent one.
namespace tubefoot {

/// The rays to a part of a facet: the sine of the grazing angle at which each is seen to meet the apparent
/// facet, the true sine over that one, and what both change by along the two directions of the facet's plane.
struct GrazingPatch {
  Interval sine, sine_a, sine_b;
  Interval ratio_a, ratio_b;  ///< of its logarithm
};

/// What an integral over an apparent facet is to take for a law, and what that leaves.
struct ApparentScattering {
  ScatteringModel model;
  /// Logarithm of the true cross-section at the true angle over `model`'s at the apparent one, less twice
  /// that of the two sines: nothing is left of Lambert's law.
  Interval rest;
};

/// The law of the apparent facet is the true one at an angle of incidence that is an affine function of the
/// apparent one (ScatteringModel::of_angle), so that pieces meet where they are seen to; the rest is how far
/// that function may be off anywhere on the facet. `middle` and the logarithm `log_ratio` of the sines: at
/// the facet's middle. `over`: all of it, in parts. `spread(a, b)`: what slopes in these intervals make
/// between the middle and any place of the facet. None where an angle may be level, or nothing is known of
/// it.
std::optional<ApparentScattering> apparent_scattering(
    const ScatteringModel& model, const GrazingPatch& middle, const Interval& log_ratio,
    std::span<const GrazingPatch> over,
    const std::function<Interval(const Interval& a, const Interval& b)>& spread);

/// No less than a law's cross-section at any grazing angle whose sine is in an interval.
double largest_cross_section(const ScatteringModel& model, const Interval& sine);

}  // namespace tubefoot
