// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "sensors/model/sidescan.hpp"

namespace tubefoot {

/// A sidescan with a staff on each side: two receivers, half a baseline above and below the transmitter, on a
/// line across the direction that the staff faces. Each has its own ranges and sees for itself.
class Interferometric : public Sidescan {
 public:
  /// Throws std::invalid_argument for what makes no sidescan, or a baseline that is not above 0 and at most
  /// as long as the nearest range.
  explicit Interferometric(const SensorDescription& description);
};

}  // namespace tubefoot
