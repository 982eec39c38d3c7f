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

/// How far each candidate is from its reference, with at most `worst` worst bins.
std::vector<SensorErrors> errors_of(const EchoPairs& pairs, std::size_t worst);

/// All figures (docs/compare.md). Those that are not finite (a silent reference) become null.
nlohmann::ordered_json comparison_json(const EchoContents& reference, const EchoContents& candidate,
                                       const EchoPairs& pairs, const std::vector<SensorErrors>& sensors);

}  // namespace tubefoot
