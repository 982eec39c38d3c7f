// SPDX-License-Identifier: GPL-3.0-or-later
// A candidate brought to where it can be compared: frames averaged, its numbers fitted to the reference's.
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

/// A pair of sensors as the measures take it: views of its arrays.
EchoPair echo_pair(const EchoPairs::Sensor& pair);

/// Replaces every `frames` pings of each sensor that follow one another by their mean: several noisy pictures
/// of what stands still. Bounds are left out. Throws InputError where they do not divide the pings.
void average_frames(EchoContents& contents, std::size_t frames);

/// What was fitted of one sensor, and how far it was before.
struct SensorFit {
  std::string name;
  EnergyFit fit;
  EchoErrors before;
};

/// Fits every candidate and puts what was fitted in its place, so that all that follows measures what is
/// left. Throws InputError where nothing can be fitted. `pairs` is of `candidate`.
std::vector<SensorFit> fit_candidate(EchoContents& candidate, const EchoPairs& pairs, FitTerms terms);

/// What is wrong with every candidate. `as_given` has the candidate's numbers as they were read, `ideal` is
/// of a perfect engine of the same sampling, or null.
std::vector<Diagnosis> diagnose(const EchoPairs& pairs, const EchoContents& as_given, const EchoPairs* ideal);

/// As lines of the table, and as JSON.
/// @{
std::string fit_text(const SensorFit& fit);
std::string unitless_text(const UnitlessErrors& errors);
std::string geometry_text(const EchoPairs::Sensor& pair, const GeometryErrors& errors);
nlohmann::ordered_json fit_json(const SensorFit& fit);
nlohmann::ordered_json unitless_json(const UnitlessErrors& errors);
nlohmann::ordered_json geometry_json(const GeometryErrors& errors);
/// @}

/// What to do where the candidate has more than twice the energy in all, or less than half: it may be in
/// another unit. Empty where it has not.
std::string wild_ratio_hint(const EchoErrors& errors);

}  // namespace tubefoot
