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

/// Function that receives the parts of a polygon by cell.
using CellSink = std::function<void(const CertifiedPolygon& part, const CertifiedCell& cell)>;

/// Cuts a convex polygon along the planes between a texture's cells. `lies` maps apparent to true positions
/// and counts as exact. The polygon is relative to its apex. Together, the parts are exactly the polygon
/// (split of CertifiedPolygon). Returns the number of parts. Returns 0 if there are more than `most`; the
/// sink has then received some of them. Without a sink, the parts are only counted.
std::size_t cut_by_cells(const CertifiedPolygon& polygon, const CertifiedTexture& texture,
                         const FacetMap& lies, std::size_t most, const CellSink& sink);

}  // namespace tubefoot
