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

/// A micro-texture as certified integrals need it. Planes at the integers of a few affine coordinates q of
/// place cut space into cells, and in each cell the factor is a polynomial.
class CertifiedTexture {
 public:
  virtual ~CertifiedTexture() = default;

  /// q = per_m . place + origin
  struct Axis {
    std::array<Ball, 3> per_m;
    Ball origin;
  };
  virtual std::vector<Axis> axes() const = 0;

  /// Encloses the factor at all those q (by axis) that lie in the cell [c, c + 1] of each axis.
  virtual Ball factor(std::span<const std::int64_t> cell, std::span<const Ball> q) const = 0;
  /// The same in intervals of doubles.
  virtual Interval factor(std::span<const std::int64_t> cell, std::span<const Interval> q) const;

  /// Upper bound of the modulus of the cell's polynomial, continued to complex q outside of the cell too.
  virtual double largest(std::span<const std::int64_t> cell, std::span<const ComplexBall> q) const = 0;

  /// At a place that is outside of a cell by no more than `off` <= 0.01 along each axis: bound of what the
  /// factor differs there from the cell's polynomial at the cell's nearest place, plus what the polynomial
  /// itself does.
  virtual double difference(double off) const = 0;

  /// The factors of two places that are apart by no more than `off` along each axis differ by no more.
  virtual double change(double off) const = 0;

  /// Encloses all factors.
  virtual Ball range() const = 0;
};

/// A field as a certified texture; null if there is no way to enclose it.
std::shared_ptr<const CertifiedTexture> certified_texture(
    const std::shared_ptr<const ReflectivityField>& field);

}  // namespace tubefoot
