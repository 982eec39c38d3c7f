// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "geometry/arithmetic/exact_corner.hpp"
#include "geometry/numbers/exact_vector.hpp"
#include "geometry/visibility/visibility.hpp"

// Rational directions and gnomonic areas of named pieces. Heavy: include only in .cpp files.
namespace tubefoot {

/// Direction of a corner's ray, from its names alone.
ExactVector exact_direction(const NameContext& context, const CornerName& corner);

/// Directions of a piece's corners.
std::vector<ExactVector> exact_directions(const NameContext& context, const std::vector<CornerName>& corners,
                                          const NamedPiece& piece);

/// Whether every direction has axis . d > 0. An inexact arithmetic may name corners that are no directions at
/// all.
bool in_front(const ExactVector& axis, const std::vector<ExactVector>& directions);

/// Normal of the plane axis . x = 1 in which a tube's areas are compared; axis . d > 0 for all its directions
/// d.
ExactVector gnomonic_axis(const TubeSet& tubes, std::uint32_t tube);

/// Twice the area of the section of a convex cone by the plane axis . x = 1, divided by |axis|: a rational.
/// Every direction must lie in front of the axis, as all of an exact result do.
CGAL::Exact_rational gnomonic_area(const ExactVector& axis, const std::vector<ExactVector>& directions);

}  // namespace tubefoot
