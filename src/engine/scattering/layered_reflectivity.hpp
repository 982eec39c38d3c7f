// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <vector>

#include "engine/scattering/reflectivity_field.hpp"

namespace tubefoot {

/// The product of several textures, which is never negative. Its average over different seeds of its noise is
/// the product of its maps at each place. The mean is 1 with one map or none.
class LayeredReflectivity : public ReflectivityField {
 public:
  /// Throws std::invalid_argument if there is no layer.
  explicit LayeredReflectivity(std::vector<std::shared_ptr<const ReflectivityField>> layers);

  double factor(glm::dvec3 place_m) const override;
  double largest() const override;
  double finest_m() const override;
  std::span<const CellPlanes> cells() const override { return cells_; }
  double change(double away_m) const override;

  const std::vector<std::shared_ptr<const ReflectivityField>>& layers() const { return layers_; }

 private:
  std::vector<std::shared_ptr<const ReflectivityField>> layers_;
  std::vector<CellPlanes> cells_;
};

}  // namespace tubefoot
