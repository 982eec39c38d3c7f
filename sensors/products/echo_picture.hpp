// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <string>

#include "sensors/pictures/canvas.hpp"
#include "sensors/recordings/recording.hpp"

namespace tubefoot {

/// The picture that shows a recording as its kind's files do, as its beams lie: a waterfall of a beam to each
/// side; of a fan ahead the sequence of its pings, or one of them; of beams downwards, or downwards and to
/// the sides, the echogram of the steepest. Throws UsageError for one ping of what shows pings side by side.
Canvas draw_echoes(const Recording& recording, std::optional<std::size_t> ping, const std::string& font);

}  // namespace tubefoot
