// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <functional>

namespace tubefoot {

/// What a polygon sends into a range sample of a beam: an energy [J for 1 J/sr at 1 m], or its enclosure.
template <class N>
struct Part {
  std::uint32_t beam = 0, sample = 0;
  N value;
  /// The facet's number in its Sight and the tube of the transmit leg, from sinks that ask whose it is.
  std::uint32_t seen = 0, tx_tube = 0;
};

/// Where the parts go: energies, bounds, tables of footprints, views. Parts come in an order that does not
/// depend on the threads.
template <class N>
using Sink = std::function<void(const Part<N>&)>;

}  // namespace tubefoot
