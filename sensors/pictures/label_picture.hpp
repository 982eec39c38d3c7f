// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "sensors/pictures/canvas.hpp"
#include "sensors/recordings/label_recording.hpp"
#include "sensors/recordings/recording.hpp"

namespace tubefoot {

/// Draws the attribution of one ping's energies side by side: objects, materials and mean heights. Each
/// sample has the colours of its labels, mixed by their shares. Adjacent beams form a fan, forward up and
/// port left; other beams are columns with the nearest sample on top. `font` as for Canvas.
Canvas draw_labels_of_ping(const Recording& recording, const LabelRecording& label_recording,
                           std::size_t ping, const std::string& font);
/// The same for all pings of one or two beams: the first ping at the bottom, port left.
Canvas draw_labels_of_track(const Recording& recording, const LabelRecording& label_recording,
                            const std::string& font);

}  // namespace tubefoot
