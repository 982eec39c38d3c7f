// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "geometry/arithmetic/exact_corner.hpp"
#include "geometry/numbers/exact_vector.hpp"
#include "geometry/visibility/visibility.hpp"

// Rational directions and gnomonic areas of named pieces. This header is expensive to compile: include it
// only in .cpp files.
namespace tubefoot {

/// Returns the direction of a corner's ray, from its names alone.
ExactVector exact_direction(const NameContext& context, const CornerName& corner);

/// Returns the directions of a piece's corners.
std::vector<ExactVector> exact_directions(const NameContext& context, const std::vector<CornerName>& corners,
                                          const NamedPiece& piece);

/// Returns whether every direction has axis . d > 0. Names of an inexact arithmetic may be invalid
/// directions.
bool in_front(const ExactVector& axis, const std::vector<ExactVector>& directions);

/// Returns the normal of the plane axis . x = 1 in which a tube's areas are compared. All directions d of the
/// tube have axis . d > 0.
ExactVector gnomonic_axis(const TubeSet& tubes, std::uint32_t tube);

/// Returns twice the area of the section of a convex cone by the plane axis . x = 1, divided by |axis|: a
/// rational. Every direction must lie in front of the axis, as all directions of an exact result do.
CGAL::Exact_rational gnomonic_area(const ExactVector& axis, const std::vector<ExactVector>& directions);

}  // namespace tubefoot
