// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <vector>

#include "engine/certified/certified_texture.hpp"
#include "engine/scattering/perlin_reflectivity.hpp"

namespace tubefoot {

/// Encloses octaves of Perlin noise. Cells of the finest octave are parts of the cells of all other octaves.
class CertifiedPerlin : public CertifiedTexture {
 public:
  /// Upper bound of the noise. PerlinLattice::largest is the maximum as found by a search. The tests prove
  /// this bound box by box.
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
  /// Position of a cell of the finest octave within a cell of another octave.
  struct Within {
    std::int64_t cell;
    double offset, scale;
  };
  static Within within(std::int64_t finest, int halvings);
  /// Sum of octaves at points of the cell, relative to its corner.
  struct Noise {
    double value, error;
  };
  Noise noise(std::span<const std::int64_t> cell, const std::array<Interval, 3>& place) const;

  PerlinLattice lattice_;
  double wavelength_m_, depth_;
  std::vector<double> weight_;  // by octave; they add up to 1, except for rounding
};

}  // namespace tubefoot
