// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace tubefoot {

/// Relative margin by which enclosures exceed the doubles from which they are constructed. It is far larger
/// than the rounding errors of these doubles.
inline constexpr double enclosure_slack = 1e-9;
/// Raises an upper bound by the slack.
inline constexpr double enclosure_factor = 1 + enclosure_slack;

}  // namespace tubefoot
