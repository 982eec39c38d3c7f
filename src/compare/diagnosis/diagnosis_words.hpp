// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "compare/diagnosis/diagnosis.hpp"

namespace tubefoot {

/// Returns where to look in an engine for the cause of a finding of this name; empty for an unknown name.
std::string look_for(const std::string& fault);

/// Returns the findings and then the parts of the error, as lines of a table.
std::string diagnosis_text(const std::string& sensor, const Diagnosis& diagnosis);
nlohmann::ordered_json diagnosis_json(const Diagnosis& diagnosis);

/// A part of the error and its description, for example "0.0575  as it is".
struct ErrorShare {
  double l1 = 0;
  std::string words;
};
std::vector<ErrorShare> error_shares(const Diagnosis& diagnosis);

}  // namespace tubefoot
