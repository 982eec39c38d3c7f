// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/scattering/layered_reflectivity.hpp"

#include <algorithm>
#include <limits>
#include <stdexcept>

namespace tubefoot {

LayeredReflectivity::LayeredReflectivity(std::vector<std::shared_ptr<const ReflectivityField>> layers)
    : layers_(std::move(layers)) {
  if (layers_.empty()) throw std::invalid_argument("a layered texture needs at least one layer");
  for (const auto& layer : layers_) cells_.insert(cells_.end(), layer->cells().begin(), layer->cells().end());
}

double LayeredReflectivity::factor(glm::dvec3 place_m) const {
  double factor = 1;
  for (const auto& layer : layers_) factor *= layer->factor(place_m);
  return factor;
}

double LayeredReflectivity::largest() const {
  double largest = 1;
  for (const auto& layer : layers_) largest *= layer->largest();
  return largest;
}

double LayeredReflectivity::finest_m() const {
  double finest = std::numeric_limits<double>::infinity();
  for (const auto& layer : layers_) finest = std::min(finest, layer->finest_m());
  return finest;
}

double LayeredReflectivity::change(double away_m) const {
  double at_place = 1, away = 1;
  for (const auto& layer : layers_) {
    at_place *= layer->largest();
    away *= layer->largest() + layer->change(away_m);
  }
  return away - at_place;
}

}  // namespace tubefoot
