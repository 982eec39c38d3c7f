// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "run/survey.hpp"

namespace tubefoot {

/// A warning for each sensor of which a reference's signals may hold what no bound encloses, and what that
/// is.
std::vector<std::string> open_signals(const Survey& survey);

}  // namespace tubefoot
