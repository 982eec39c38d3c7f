// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <functional>

namespace tubefoot {

/// Contribution of a polygon to a range sample of a beam. It is a received energy density in J/m² for 1 J/sr
/// at 1 m, or its enclosure.
template <class N>
struct Part {
  std::uint32_t beam = 0, sample = 0;
  N value;
  /// Index of the facet in its visibility, and tube of the transmit leg. Set only for sinks that request
  /// attribution.
  std::uint32_t seen = 0, tx_tube = 0;
};

/// Receiver of the parts: energies, bounds, tables of footprints, views. The order of the parts does not
/// depend on the threads.
template <class N>
using Sink = std::function<void(const Part<N>&)>;

}  // namespace tubefoot
