// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <vector>

#include "engine/certified/certified_texture.hpp"
#include "engine/scattering/map_reflectivity.hpp"

namespace tubefoot {

/// Encloses a map of factors, bilinear between the centres of its pixels. Its cells are columns and rows of
/// these centres. The values are those of MapReflectivity: pixels after normalisation, and to_column() and
/// to_row() as exact doubles.
class CertifiedMap : public CertifiedTexture {
 public:
  explicit CertifiedMap(std::shared_ptr<const MapReflectivity> map);

  std::vector<Axis> axes() const override;
  Ball factor(std::span<const std::int64_t> cell, std::span<const Ball> q) const override;
  double largest(std::span<const std::int64_t> cell, std::span<const ComplexBall> q) const override;
  double difference(double off) const override;
  double change(double off) const override;
  Ball range() const override { return Ball::between(least_, most_); }

 private:
  /// Values at the corners of a cell: at (0, 0), one column on, one row on, both.
  std::array<double, 4> corners(std::span<const std::int64_t> cell) const;

  std::shared_ptr<const MapReflectivity> map_;
  double least_, most_, along_columns_ = 0, along_rows_ = 0;
};

}  // namespace tubefoot
