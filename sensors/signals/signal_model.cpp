// SPDX-License-Identifier: GPL-3.0-or-later
#include "sensors/signals/signal_model.hpp"

#include <algorithm>
#include <glm/geometric.hpp>

namespace tubefoot {

double SignalModel::farthest_element_m() const {
  double farthest_m = glm::length(array.transmitter_m);
  for (const glm::dvec3 receiver : array.receivers_m)
    farthest_m = std::max(farthest_m, glm::length(receiver));
  return farthest_m;
}

}  // namespace tubefoot
