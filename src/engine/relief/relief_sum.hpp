// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <vector>

#include "engine/relief/elevation_field.hpp"

namespace tubefoot {

/// Sum of several fields. The parts that a mesh does not represent are added too: root mean squares as those
/// of independent fields, largest values as bounds.
class ReliefSum final : public ElevationField {
 public:
  /// Requires at least one field.
  explicit ReliefSum(std::vector<std::shared_ptr<const ElevationField>> fields);

  double height_m(glm::dvec3 place_m) const override;
  double largest_m() const override;
  double finest_m() const override;
  LeftOut left_out(double edge_m) const override;

 private:
  std::vector<std::shared_ptr<const ElevationField>> fields_;
};

}  // namespace tubefoot
