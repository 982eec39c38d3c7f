// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "sensors/kinds/kind_sidescan.hpp"

namespace tubefoot {

/// Sidescan whose two receivers a side sit on a receiver pair, above and below the transmitter.
struct InterferometricDescription : SidescanDescription {
  double baseline_m = 0.012;  ///< from receiver to receiver
  double receiver_pair_tilt_deg =
      30;                    ///< of the direction that the receiver pair faces, below the horizontal
  bool phase_noise = false;  ///< soundings from phases with the noise of a single look

  static const SensorSection& kind();
};

}  // namespace tubefoot
