// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <string>

#include "sensors/pictures/canvas.hpp"
#include "sensors/recordings/recording.hpp"

namespace tubefoot {

/// Draws a recording in the form of its kind's pictures, by the arrangement of its beams. A beam to each
/// side gives a waterfall. A fan ahead gives the sequence of its pings, or one ping. Beams downwards, or
/// downwards and to the sides, give the echogram of the steepest beam. Throws UsageError if one ping is
/// requested of a picture that shows pings side by side.
Canvas draw_echoes(const Recording& recording, std::optional<std::size_t> ping, const std::string& font);

}  // namespace tubefoot
