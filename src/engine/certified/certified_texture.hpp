// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "engine/scattering/reflectivity_field.hpp"
#include "geometry/numbers/ball.hpp"
#include "geometry/numbers/interval.hpp"

namespace tubefoot {

/// Micro-texture for certified integrals. Planes at the integers of a few affine coordinates q of position
/// divide space into cells. In each cell the factor is a polynomial.
class CertifiedTexture {
 public:
  virtual ~CertifiedTexture() = default;

  /// q = per_m . position + origin
  struct Axis {
    std::array<Ball, 3> per_m;
    Ball origin;
  };
  virtual std::vector<Axis> axes() const = 0;

  /// Encloses the factor over all q (by axis) in the cell [c, c + 1] of each axis.
  virtual Ball factor(std::span<const std::int64_t> cell, std::span<const Ball> q) const = 0;
  /// Does the same in intervals of doubles.
  virtual Interval factor(std::span<const std::int64_t> cell, std::span<const Interval> q) const;

  /// Upper bound of the modulus of the cell's polynomial, which continues to complex q outside of the cell.
  virtual double largest(std::span<const std::int64_t> cell, std::span<const ComplexBall> q) const = 0;

  /// Bound for a point that is outside of a cell by at most `off` <= 0.01 along each axis. It bounds the
  /// difference between the factor there and the cell's polynomial at the nearest point of the cell. It also
  /// includes the change of the polynomial itself.
  virtual double difference(double off) const = 0;

  /// Bound of the difference between the factors of two points whose distance along each axis is at most
  /// `off`.
  virtual double change(double off) const = 0;

  /// Encloses the values of the factor everywhere.
  virtual Ball range() const = 0;
};

/// Returns a field as a certified texture, or null if it cannot be enclosed.
std::shared_ptr<const CertifiedTexture> certified_texture(
    const std::shared_ptr<const ReflectivityField>& field);

}  // namespace tubefoot
