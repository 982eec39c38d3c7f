// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <glm/vec3.hpp>
#include <vector>

#include "engine/certified/certified_texture.hpp"
#include "engine/scattering/facet_map.hpp"
#include "geometry/integrals/certified_polygon.hpp"
#include "geometry/integrals/plane_function.hpp"

namespace tubefoot {

/// One cell of a texture on the plane of a polygon.
struct CertifiedCell {
  const CertifiedTexture* texture = nullptr;
  /// Texture coordinate by axis.
  std::vector<PlaneFunction<Ball>> traces;
  std::vector<PlaneFunction<Interval>> traces_in_doubles;
  std::vector<std::int64_t> cell;
  /// Allowance that is added to factors. Corners of the polygon may lie outside of the cell by their
  /// rounding, or in a plane between two cells. The cell's polynomial may be wrong there by this amount.
  Ball slack;

  /// Encloses the factor at a point in the cell, in polar coordinates about the foot point.
  Ball factor(const Ball& rho, const Ball& angle) const;
  /// Upper bound of the modulus.
  double largest(const ComplexBall& rho, const ComplexBall& angle) const;
  /// Does the same for coordinates along u and v from the foot point.
  Ball factor_at(const Ball& x, const Ball& y) const;
  Interval factor_at(const Interval& x, const Interval& y) const;
  double largest_at(const ComplexBall& x, const ComplexBall& y) const;
};

/// Largest number of texture cells in one piece, which take half a minute. A piece with more cells is
/// enclosed by the range of the texture.
constexpr std::size_t most_cells = 1 << 16;

/// A convex polygon with a micro-texture. If the texture varies by more than an eighth of the tolerance, the
/// polygon is cut along the planes between the texture's cells. Together, the parts are exactly the polygon
/// (split of CertifiedPolygon).
class TexturedPolygon {
 public:
  /// `texture`: null for the factor 1. `lies` maps apparent to true positions and counts as exact. The
  /// polygon is relative to its apex. Polygon and texture must outlive this object.
  TexturedPolygon(const CertifiedPolygon& polygon, const CertifiedTexture* texture, const FacetMap& lies,
                  double tolerance);

  bool is_cut() const { return cells_ > 0; }
  /// Returns true if the texture varies too much for its range, but the polygon has too many cells.
  bool has_too_many_cells() const { return varies_ && cells_ == 0; }
  double parts() const { return is_cut() ? double(cells_) : 1; }
  const Ball& range() const { return range_; }
  /// Encloses the factor that the cells of the parts do not contain.
  Ball factor() const { return is_cut() ? Ball(1) : range_; }
  /// Bounds of this factor, which is not negative.
  Interval factor_bounds() const { return {std::max(factor().lo(), 0.0), factor().hi()}; }
  /// Bounds the change of the parts' factors over a distance. It is 0 if factor() covers it.
  double change_over(double distance_m) const;

  /// Function that receives a part with its cell. Without cells, it receives the whole polygon and null.
  using Take = std::function<void(const CertifiedPolygon& part, const CertifiedCell* cell)>;
  void each_part(const Take& take) const;

 private:
  std::size_t cut(const Take& take) const;

  const CertifiedPolygon& polygon_;
  const CertifiedTexture* texture_;
  FacetMap lies_;
  std::size_t cells_ = 0;
  Ball range_{1};
  bool varies_ = false;
};

}  // namespace tubefoot
