// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "engine/water/sound_speed_profile.hpp"

namespace tubefoot {

/// Water that rays pass: sound speed as a function of depth, and absorption by layer.
struct WaterColumn {
  SoundSpeedProfile profile{1500};
  /// Absorption one way, one value per layer of the profile; empty: no absorption.
  std::vector<double> absorption_db_per_m{};

  double absorption_in(std::size_t layer) const {
    return absorption_db_per_m.empty() ? 0 : absorption_db_per_m[layer];
  }
};

}  // namespace tubefoot
