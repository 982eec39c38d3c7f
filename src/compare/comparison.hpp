// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "compare/echo_pairs.hpp"
#include "compare/measures/echo_errors.hpp"

namespace tubefoot {

struct SensorErrors {
  EchoPairs::Sensor pair;
  EchoErrors errors;
};

/// Computes the errors of each candidate, with at most `worst` bins of largest error.
std::vector<SensorErrors> errors_of(const EchoPairs& pairs, std::size_t worst);

/// Returns all figures (docs/compared-figures.md). Figures that are not finite, as for a reference without
/// energy, become null.
nlohmann::ordered_json comparison_json(const EchoContents& reference, const EchoContents& candidate,
                                       const EchoPairs& pairs, const std::vector<SensorErrors>& sensors);

}  // namespace tubefoot
