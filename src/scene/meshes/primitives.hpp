// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "scene/description/object_description.hpp"
#include "scene/description/scene_component.hpp"

namespace tubefoot {

// Closed surfaces about their centre with the axis along z. Every edge belongs to two facets, no facet is
// degenerate, and facets are counter-clockwise as seen from outside.
// Facets have the area of the true surface (of the side for a cylinder and a cone). A Lambertian body then
// returns the same energy. Caps lack about 4/3 of the chord error divided by the radius. Vertices lie
// outside of the surface and the centres of facets inside, at most `chord_error_m` away. Each function
// throws InputError at `place` for sizes that are not positive, and for a chord error that needs more than
// 20 million facets.

/// Returns an icosahedron whose edges are divided into f parts and projected to the sphere. f is the
/// smallest number that keeps the chord error.
ComponentMesh sphere_facets(const SpherePrimitive& sphere, double chord_error_m, const SourcePlace& place);
/// Returns a prism on a regular polygon.
ComponentMesh cylinder_facets(const CylinderPrimitive& cylinder, double chord_error_m,
                              const SourcePlace& place);
/// Returns a pyramid on a regular polygon, or its frustum if the top radius is not zero.
ComponentMesh cone_facets(const ConePrimitive& cone, double chord_error_m, const SourcePlace& place);
ComponentMesh box_facets(const BoxPrimitive& box, const SourcePlace& place);

}  // namespace tubefoot
