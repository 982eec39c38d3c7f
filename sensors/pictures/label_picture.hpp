// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "sensors/pictures/canvas.hpp"
#include "sensors/recordings/label_recording.hpp"
#include "sensors/recordings/recording.hpp"

namespace tubefoot {

/// Draws whose the energies of one ping are and where they come from, side by side: objects and materials,
/// each sample in the colours of its owners mixed by their shares, and mean heights. Beams that lie side by
/// side make a fan, forward up and port left; others are columns, the nearest sample on top. `font` as for
/// Canvas.
Canvas draw_labels_of_ping(const Recording& recording, const LabelRecording& label_recording,
                           std::size_t ping, const std::string& font);
/// The same of all pings of one or two beams: the first ping at the bottom, port left.
Canvas draw_labels_of_track(const Recording& recording, const LabelRecording& label_recording,
                            const std::string& font);

}  // namespace tubefoot
