// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <complex>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <span>

#include "geometry/integrals/measure.hpp"

// Integrals of e^{i phase} over segments, triangles and polygons on which the phase is an affine function of
// place: what a smooth polygon returns to far away. docs/smooth-surfaces.md
namespace tubefoot {

/// e^{i phase}; phases in radians.
std::complex<double> phasor(double phase);

/// The mean of e^{i phase} over a segment at whose ends the phase is a and b: the first divided difference of
/// exp at ia and ib.
std::complex<double> mean_phasor(double a, double b);

/// The mean over a triangle by its corners' phases: twice the second divided difference of exp. There is no
/// phase where it loses digits: the error is some roundings of 1, and those of the phases themselves.
std::complex<double> mean_phasor(double a, double b, double c);

/// Integral of e^{i gradient . x} over a polygon that need not be convex, x being places relative to its
/// first corner; `offsets`: its corners relative to that (PlanarPolygon::offsets). Negative for a polygon
/// that turns the other way. Gordon's sum over edges (doi 10.1109/TAP.1975.1141105) where that keeps its
/// digits, a fan of triangles elsewhere: for phases that hardly change, and for slivers.
/// Law Q1 (polygons add up): the parts of a polygon have together what it has.
/// Law Q2 (shift): moving a polygon by d turns the phase by gradient . d, no more.
std::complex<double> polygon_transform(std::span<const glm::dvec2> offsets, glm::dvec2 gradient);

/// Integral of e^{i q . x} over a plane polygon in space, positive if it turns counter-clockwise about
/// `normal` (unit).
std::complex<double> polygon_transform(std::span<const glm::dvec3> corners, glm::dvec3 normal, glm::dvec3 q);

}  // namespace tubefoot
