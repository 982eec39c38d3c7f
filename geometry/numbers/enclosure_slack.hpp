// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace tubefoot {

/// By this part enclosures are wider than the doubles that they are laid on say: far above their rounding.
inline constexpr double enclosure_slack = 1e-9;

}  // namespace tubefoot
