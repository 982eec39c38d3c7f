// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "geometry/integrals/measure.hpp"

namespace tubefoot {

/// Leaves of a convex polygon what lies in another one of the same plane, in doubles: what is nearer to an
/// edge of the other than corners are known (1e-12 of their distance from the apex) is not cut. False if
/// nothing is left that is broader than that.
bool clip_convex(PlanarPolygon& polygon, const PlanarPolygon& other);

}  // namespace tubefoot
