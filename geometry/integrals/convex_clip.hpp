// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "geometry/integrals/measure.hpp"

namespace tubefoot {

/// Intersects a convex polygon with another one of the same plane, in doubles. Corners are accurate to 1e-12
/// of their distance from the apex, and parts nearer than that to an edge of `other` are not cut off.
/// Returns false if nothing wider than that remains.
bool clip_convex(PlanarPolygon& polygon, const PlanarPolygon& other);

}  // namespace tubefoot
