// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "scene/description/scene_description.hpp"

namespace tubefoot {

/// The sensor as it is in water of that speed of sound. Where a sidescan has a sampling frequency f, samples
/// of c / (2 f) each, as many whole ones as its range holds. The window of an ARIS (of its presets) is the
/// nearest that it has: whole microseconds to the first sample and from sample to sample; `notes`, if given,
/// says so where that moves one that the scene asks for by more than half a sample. Any other sensor stays as
/// it is. Throws InputError at the sensor's place where a sidescan has no sample, or more than can be.
SensorDescription in_water(SensorDescription description, double sound_speed_m_s,
                           std::vector<std::string>* notes = nullptr);

}  // namespace tubefoot
