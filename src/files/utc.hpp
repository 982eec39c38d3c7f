// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <string>

namespace tubefoot {

/// Seconds since 1970-01-01T00:00:00Z of "YYYY-MM-DDThh:mm:ssZ" (seconds may have decimals), leap seconds not
/// counted; nothing for any other text, a day that is none, or a year outside of 1970 to 2099.
std::optional<double> unix_time_s(const std::string& utc);

}  // namespace tubefoot
