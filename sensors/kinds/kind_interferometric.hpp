// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "sensors/kinds/kind_sidescan.hpp"

namespace tubefoot {

/// Sidescan with a receiver pair on each side, above and below the transmitter.
struct InterferometricDescription : SidescanDescription {
  double baseline_m = 0.012;           ///< distance of the two receivers
  double receiver_pair_tilt_deg = 30;  ///< depression of the direction that the receiver pair faces
  bool phase_noise = false;            ///< adds the phase noise of a single look to soundings

  static const SensorSection& kind();
};

}  // namespace tubefoot
