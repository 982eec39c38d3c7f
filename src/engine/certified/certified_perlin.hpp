// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <vector>

#include "engine/certified/certified_texture.hpp"
#include "engine/scattering/perlin_reflectivity.hpp"

namespace tubefoot {

/// Octaves of Perlin noise. The finest one's cells are parts of all others'.
class CertifiedPerlin : public CertifiedTexture {
 public:
  /// No noise is larger. PerlinLattice::largest is the number itself, as found by a search; this one is
  /// proven, box by box, by the tests.
  static constexpr double largest_noise = 1.06;

  explicit CertifiedPerlin(const PerlinReflectivity& field);

  std::vector<Axis> axes() const override;
  Ball factor(std::span<const std::int64_t> cell, std::span<const Ball> q) const override;
  Interval factor(std::span<const std::int64_t> cell, std::span<const Interval> q) const override;
  double largest(std::span<const std::int64_t> cell, std::span<const ComplexBall> q) const override;
  double difference(double off) const override;
  double change(double off) const override;
  Ball range() const override;

 private:
  /// Where a cell of the finest octave lies in the octave's own.
  struct Within {
    std::int64_t cell;
    double offset, scale;
  };
  static Within within(std::int64_t finest, int halvings);
  /// The sum of octaves at places in the cell, from its corner.
  struct Noise {
    double value, error;
  };
  Noise noise(std::span<const std::int64_t> cell, const std::array<Interval, 3>& place) const;

  PerlinLattice lattice_;
  double wavelength_m_, depth_;
  std::vector<double> weight_;  // by octave; they add up to 1, but for rounding
};

}  // namespace tubefoot
