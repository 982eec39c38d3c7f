// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "scene/description/scene_component.hpp"
#include "scene/description/scene_description.hpp"

namespace tubefoot {

// Closed surfaces about their centre, axis along z: every edge belongs to two facets, no facet is degenerate,
// facets turn counter-clockwise for someone outside. Facets have the area of the true surface (a cylinder's
// and a cone's side; their caps lack about 4/3 of the chord error over the radius), so that a Lambert body
// returns what the true one does: vertices lie outside of the surface, the middles of facets inside, nowhere
// further from it than `chord_error_m`. Each throws InputError at `place` for sizes that are not positive and
// for a chord error that would need more than 20 million facets.

/// Icosahedron whose edges are cut into f parts and put on the sphere, with the smallest f that keeps the
/// chord error.
ComponentMesh sphere_facets(const SpherePrimitive& sphere, double chord_error_m, const SourcePlace& place);
/// Prism on a regular polygon.
ComponentMesh cylinder_facets(const CylinderPrimitive& cylinder, double chord_error_m,
                              const SourcePlace& place);
/// Pyramid on a regular polygon, or its frustum where the top radius is not zero.
ComponentMesh cone_facets(const ConePrimitive& cone, double chord_error_m, const SourcePlace& place);
ComponentMesh box_facets(const BoxPrimitive& box, const SourcePlace& place);

}  // namespace tubefoot
