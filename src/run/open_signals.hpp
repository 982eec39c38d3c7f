// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "run/survey.hpp"

namespace tubefoot {

/// Returns one warning for each sensor whose signals may contain contributions without a certified bound in
/// a reference. The warning names these contributions.
std::vector<std::string> open_signals(const Survey& survey);

}  // namespace tubefoot
