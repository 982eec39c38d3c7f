// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/surface/relief_error.hpp"

#include <algorithm>
#include <cmath>

namespace tubefoot {
namespace {

void raise(ElevationField::LeftOut& to, const ElevationField::LeftOut& by) {
  to.rms_height_m = std::max(to.rms_height_m, by.rms_height_m);
  to.rms_slope = std::max(to.rms_slope, by.rms_slope);
  to.largest_height_m = std::max(to.largest_height_m, by.largest_height_m);
  to.largest_slope = std::max(to.largest_slope, by.largest_slope);
}

}  // namespace

OmittedRelief::OmittedRelief(std::span<const std::shared_ptr<const ElevationField>> relief, double finest_m)
    : finest2_m2_(finest_m * finest_m), by_material_(relief.size()) {
  for (std::size_t m = 0; m < relief.size(); ++m) {
    if (!relief[m]) continue;
    largest_height_m_ = std::max(largest_height_m_, relief[m]->largest_m());
    for (std::size_t k = 0; k < steps; ++k) {
      by_material_[m][k] = relief[m]->left_out(finest_m * std::exp2(static_cast<double>(k) / 4));
      if (k > 0) raise(by_material_[m][k], by_material_[m][k - 1]);
      raise(largest_[k], by_material_[m][k]);
    }
  }
}

std::size_t OmittedRelief::step(double edge2_m2) const {
  if (!(edge2_m2 > finest2_m2_)) return 0;
  const double k = std::ceil(2 * std::log2(edge2_m2 / finest2_m2_));
  return static_cast<std::size_t>(std::min(k, static_cast<double>(steps - 1)));
}

double grazing_cotangent(double sine) {
  constexpr double lowest_sine = 0.02;
  const double s = std::max(sine, lowest_sine);
  return std::sqrt(std::max(0.0, 1 - s * s)) / s;
}

double omitted_change(const ElevationField::LeftOut& left_out, double edge2_m2, const Resolution& cell) {
  const double cot = grazing_cotangent(cell.sine_grazing), s = left_out.rms_slope;
  const double patches = std::max(1.0, cell.range_m * cell.beam_rad * cell.sample_m / edge2_m2);
  return 2 * s * cot / std::sqrt(patches) + s * s * (0.5 + cot * cot) +
         left_out.rms_height_m * cell.sine_grazing / cell.sample_m * std::sqrt(2 / patches);
}

}  // namespace tubefoot
