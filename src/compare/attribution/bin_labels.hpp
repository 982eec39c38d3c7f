// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>

#include "compare/attribution/scene_at_hand.hpp"
#include "compare/measures/scene_labels.hpp"

namespace tubefoot {

/// Determines elevation and material of the echo of each bin, and the objects nearer than the first range bin
/// that shade bins. It traces stratified rays in each beam.
///
/// Echoes of other beams determine the elevation of a range bin. A bin without energy lies in the shadow of
/// a near object if a ray of its beam meets the object at this elevation. Pings for which
/// `is_wanted` is false have no labels. Returns empty labels for separate receivers, receiver pairs and paths
/// via mirrors. Throws InputError if the echoes do not fit the scene.
SceneLabels bin_labels(const SceneAtHand& scene, const SensorEchoes& reference,
                       const std::function<bool(std::size_t ping)>& is_wanted, bool quiet);

}  // namespace tubefoot
