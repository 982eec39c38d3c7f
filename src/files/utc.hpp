// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <string>

namespace tubefoot {

/// Returns the seconds since 1970-01-01T00:00:00Z for "YYYY-MM-DDThh:mm:ssZ" (seconds may have decimals),
/// without leap seconds. It is empty for other text, invalid days, and years outside of 1970 to 2099.
std::optional<double> unix_time_s(const std::string& utc);

}  // namespace tubefoot
