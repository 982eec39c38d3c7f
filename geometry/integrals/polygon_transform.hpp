// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <complex>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <span>

#include "geometry/integrals/measure.hpp"

// Integrals of e^{i phase} over segments, triangles and polygons on which the phase is an affine function of
// position. They give the far field of a smooth polygon. See docs/notes/smooth-surfaces.md.
namespace tubefoot {

/// e^{i phase}; phases in radians.
std::complex<double> phasor(double phase);

/// The mean of e^{i phase} over a segment with the phases a and b at its ends. It is the first divided
/// difference of exp at ia and ib.
std::complex<double> mean_phasor(double a, double b);

/// The mean over a triangle from the phases at its corners: twice the second divided difference of exp. It
/// keeps its digits for all phases. Its error is some roundings of 1, and those of the phases.
std::complex<double> mean_phasor(double a, double b, double c);

/// Integral of e^{i gradient . x} over a polygon that need not be convex, where x is relative to the first
/// corner. `offsets` are the corners relative to the first corner (PlanarPolygon::offsets). The opposite
/// orientation gives the negative. The function uses Gordon's sum over edges (doi 10.1109/TAP.1975.1141105)
/// where that keeps its digits. For slivers and for phases that hardly change it uses a fan of triangles.
/// Law Q1 (polygons add up): the integrals over the parts of a polygon add up to that over the polygon.
/// Law Q2 (shift): a shift of a polygon by d changes the phase by gradient . d, no more.
std::complex<double> polygon_transform(std::span<const glm::dvec2> offsets, glm::dvec2 gradient);

/// Integral of e^{i q . x} over a plane polygon in space, positive if it turns counter-clockwise about
/// `normal` (unit).
std::complex<double> polygon_transform(std::span<const glm::dvec3> corners, glm::dvec3 normal, glm::dvec3 q);

}  // namespace tubefoot
