// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/certified/certified_map.hpp"

#include <algorithm>
#include <cmath>

#include "geometry/numbers/enclosure_slack.hpp"

namespace tubefoot {
namespace {

constexpr double mean_rounding = 0x1p-48;  // of a bilinear mean in doubles, relative to its largest corner

}  // namespace

CertifiedMap::CertifiedMap(std::shared_ptr<const MapReflectivity> map) : map_(std::move(map)) {
  least_ = most_ = map_->value(0, 0);
  const auto columns = std::int64_t(map_->grid().columns), rows = std::int64_t(map_->grid().rows);
  for (std::int64_t j = -1; j < rows; ++j)
    for (std::int64_t i = -1; i < columns; ++i) {
      const auto [a, b, e, f] = corners(std::array{i, j});
      least_ = std::min({least_, a, b, e, f});
      most_ = std::max({most_, a, b, e, f});
      along_columns_ = std::max({along_columns_, std::abs(b - a), std::abs(f - e)});
      along_rows_ = std::max({along_rows_, std::abs(e - a), std::abs(f - b)});
    }
}

std::array<double, 4> CertifiedMap::corners(std::span<const std::int64_t> cell) const {
  const auto i = double(cell[0]), j = double(cell[1]);
  return {map_->value(i, j), map_->value(i + 1, j), map_->value(i, j + 1), map_->value(i + 1, j + 1)};
}

std::vector<CertifiedTexture::Axis> CertifiedMap::axes() const {
  const glm::dvec2 first = map_->placing().first_m;
  std::vector<Axis> axes;
  for (const glm::dvec2 along : {map_->to_column(), map_->to_row()})
    axes.push_back({{Ball(along.x), Ball(along.y), Ball()},
                    -(Ball(along.x) * Ball(first.x) + Ball(along.y) * Ball(first.y))});
  return axes;
}

Ball CertifiedMap::factor(std::span<const std::int64_t> cell, std::span<const Ball> q) const {
  std::array<double, 2> middle, radius;
  for (int a = 0; a < 2; ++a) {
    const Ball x = q[a] - Ball(double(cell[a]));
    const double lo = std::clamp(x.lo(), 0.0, 1.0), hi = std::clamp(x.hi(), 0.0, 1.0);
    middle[a] = lo + (hi - lo) / 2;
    radius[a] = (hi - lo) / 2 * enclosure_factor + 1e-16;
  }
  const auto [a, b, e, f] = corners(cell);
  const double x = middle[0], y = middle[1];
  Ball value((1 - y) * ((1 - x) * a + x * b) + y * ((1 - x) * e + x * f));
  const double error = std::max(std::abs(b - a), std::abs(f - e)) * radius[0] +
                       std::max(std::abs(e - a), std::abs(f - b)) * radius[1] +
                       std::max({a, b, e, f}) * mean_rounding;
  value.add_error(Ball(error * enclosure_factor));
  return value;
}

double CertifiedMap::largest(std::span<const std::int64_t> cell, std::span<const ComplexBall> q) const {
  const std::array<double, 4> corner = corners(cell);
  double largest = *std::max_element(corner.begin(), corner.end());
  for (int a = 0; a < 2; ++a) {
    // |x| + |1 - x| is 1 from 0 to 1. Outside it grows by at most 2 per unit of distance.
    const Ball x = q[a].real() - Ball(double(cell[a])), y = q[a].imaginary();
    largest *= 1 + 2 * std::hypot(std::max({0.0, -x.lo(), x.hi() - 1}),
                                  std::max(std::abs(y.lo()), std::abs(y.hi())));
  }
  return largest * enclosure_factor;
}

double CertifiedMap::difference(double off) const { return 2 * change(off); }

double CertifiedMap::change(double off) const {
  // Adds a tenth for the change of the slopes outside of a cell.
  return 1.1 * (along_columns_ + along_rows_) * off;
}

}  // namespace tubefoot
