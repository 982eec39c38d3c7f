// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>

#include "geometry/mesh/facet_cone.hpp"
#include "geometry/numbers/vector_products.hpp"
#include "geometry/numbers/wide_int.hpp"

// Vectors of 512-bit integers, for computations that involve a depth plane.
namespace tubefoot {

using WideVec = std::array<WideInt, 3>;

inline WideVec widen(const Vec64& v) { return {WideInt(v.x), WideInt(v.y), WideInt(v.z)}; }

/// Returns the normal of the plane on which two facets are equally deep. Facet j is the nearer one on the
/// positive side.
inline WideVec depth_normal(const FacetCone& i, const FacetCone& j) {
  const WideInt ci = widen(i.offset), cj = widen(j.offset);
  const WideVec ni = widen(i.normal), nj = widen(j.normal);
  return {WideInt(ci * nj[0] - cj * ni[0]), WideInt(ci * nj[1] - cj * ni[1]),
          WideInt(ci * nj[2] - cj * ni[2])};
}

}  // namespace tubefoot
