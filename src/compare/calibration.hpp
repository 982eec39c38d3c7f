// SPDX-License-Identifier: GPL-3.0-or-later
// Prepares a candidate for comparison: averages frames and fits its energies to the reference.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "compare/diagnosis/diagnosis.hpp"
#include "compare/echo_pairs.hpp"
#include "compare/measures/echo_errors.hpp"
#include "compare/measures/energy_fit.hpp"
#include "compare/measures/geometry_errors.hpp"
#include "compare/measures/unitless_errors.hpp"

namespace tubefoot {

/// Returns a pair of sensors as views of their arrays, in the form that the error measures need.
EchoPair echo_pair(const EchoPairs::Sensor& pair);

/// Replaces every `frames` consecutive pings of each sensor by their mean, for noisy pictures of a static
/// scene. Removes bounds. Throws InputError if `frames` does not divide the number of pings.
void average_frames(EchoContents& contents, std::size_t frames);

/// Fitted parameters of one sensor, and its errors before the fit.
struct SensorFit {
  std::string name;
  EnergyFit fit;
  EchoErrors before;
};

/// Fits every candidate and replaces its energies by the fitted ones, so that later measures describe the
/// remaining error. Throws InputError if no fit is possible. `pairs` refers to `candidate`.
std::vector<SensorFit> fit_candidate(EchoContents& candidate, const EchoPairs& pairs, FitTerms terms);

/// Diagnoses every candidate. `as_given` has the energies of the candidate as read. `ideal` has those of a
/// perfect engine with the same sampling, or is null. `labels` and `fits` have one element per pair, or none.
std::vector<Diagnosis> diagnose(const EchoPairs& pairs, const EchoContents& as_given, const EchoPairs* ideal,
                                const std::vector<SceneLabels>& labels, const std::vector<SensorFit>& fits);

/// The results as lines of the table, and as JSON.
/// @{
std::string fit_text(const SensorFit& fit);
std::string unitless_text(const UnitlessErrors& errors);
std::string geometry_text(const EchoPairs::Sensor& pair, const GeometryErrors& errors);
nlohmann::ordered_json fit_json(const SensorFit& fit);
nlohmann::ordered_json unitless_json(const UnitlessErrors& errors);
nlohmann::ordered_json geometry_json(const GeometryErrors& errors);
/// @}

/// Returns advice if the total energy of the candidate is more than twice or less than half that of the
/// reference. The candidate may then have another unit. Otherwise the result is empty.
std::string wild_ratio_hint(const EchoErrors& errors);

}  // namespace tubefoot
