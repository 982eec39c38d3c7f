// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "exchange/readers/scene_readers.hpp"

namespace tubefoot {

struct Scene;

/// Compares the sonars of an imported scene with its facets, as `check` does.
///
/// - A sonar exactly on a facet sees nothing, and `check` rejects it: it moves by a millimetre.
/// - A sonar inside an object sees this object only, often its own housing: a remark names the object.
/// - The example sonar of a scene without sonars moves away from the objects and looks at them.
///
/// Adds a remark for each of these cases. `loaded`: the same scene, loaded. Returns whether a sonar moved.
bool place_sonars(ImportedScene& scene, const Scene& loaded);

/// Returns the sonar of scenes without sonars, at the origin.
ImportedSensor example_sonar();

}  // namespace tubefoot
