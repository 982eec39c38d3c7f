// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/relief/relief_sum.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace tubefoot {

ReliefSum::ReliefSum(std::vector<std::shared_ptr<const ElevationField>> fields)
    : fields_(std::move(fields)) {}

double ReliefSum::height_m(glm::dvec3 place_m) const {
  double height = 0;
  for (const auto& field : fields_) height += field->height_m(place_m);
  return height;
}

double ReliefSum::largest_m() const {
  double largest = 0;
  for (const auto& field : fields_) largest += field->largest_m();
  return largest;
}

double ReliefSum::finest_m() const {
  double finest = fields_.front()->finest_m();
  for (const auto& field : fields_) finest = std::min(finest, field->finest_m());
  return finest;
}

ElevationField::LeftOut ReliefSum::left_out(double edge_m) const {
  LeftOut sum;
  for (const auto& field : fields_) {
    const LeftOut part = field->left_out(edge_m);
    sum.rms_height_m += part.rms_height_m * part.rms_height_m;
    sum.rms_slope += part.rms_slope * part.rms_slope;
    sum.largest_height_m += part.largest_height_m;
    sum.largest_slope += part.largest_slope;
  }
  sum.rms_height_m = std::sqrt(sum.rms_height_m);
  sum.rms_slope = std::sqrt(sum.rms_slope);
  return sum;
}

}  // namespace tubefoot
