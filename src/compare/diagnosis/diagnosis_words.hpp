// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "compare/diagnosis/diagnosis.hpp"

namespace tubefoot {

/// Findings first, then what is left of the error, as lines of a table.
std::string diagnosis_text(const std::string& sensor, const Diagnosis& diagnosis);
nlohmann::ordered_json diagnosis_json(const Diagnosis& diagnosis);

/// What of the error is what, a line each: "0.0575  as it is".
struct ErrorShare {
  double l1 = 0;
  std::string words;
};
std::vector<ErrorShare> error_shares(const Diagnosis& diagnosis);

}  // namespace tubefoot
