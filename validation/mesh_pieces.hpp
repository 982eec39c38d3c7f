// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <random>

#include "geometry/mesh/facet_mesh.hpp"
#include "geometry/tubes/tube.hpp"

// Elements of the cases, directly on the integer grid.
namespace tubefoot::atlas {

using Random = std::mt19937_64;

/// Returns a uniform number in [lo, hi], the same with every standard library.
std::int32_t uniform(Random& random, std::int32_t lo, std::int32_t hi);

VertexId add_vertex(FacetMesh& mesh, GridPoint p);
void add_facet(FacetMesh& mesh, VertexId a, VertexId b, VertexId c);
void add_facet(FacetMesh& mesh, GridPoint a, GridPoint b, GridPoint c);

/// Adds a sheet of 2 nu nv facets through the points at(u, v), u = 0..nu, v = 0..nv.
template <class At>
void add_sheet(FacetMesh& mesh, int nu, int nv, const At& at) {
  const auto first = static_cast<VertexId>(mesh.vertices.size());
  for (int v = 0; v <= nv; ++v)
    for (int u = 0; u <= nu; ++u) add_vertex(mesh, at(u, v));
  for (int v = 0; v < nv; ++v)
    for (int u = 0; u < nu; ++u) {
      const auto a = first + static_cast<VertexId>(v * (nu + 1) + u), c = a + static_cast<VertexId>(nu) + 1;
      add_facet(mesh, a, a + 1, c + 1);
      add_facet(mesh, a, c + 1, c);
    }
}

/// Adds an octahedron whose facets are split into four `times` times, with vertices on a sphere, rounded to
/// the grid.
void add_sphere(FacetMesh& mesh, GridPoint centre, std::int32_t radius, int times);

/// Adds a height field of 2 n^2 facets over [-width / 2, width / 2] x [0, width] about the height z. It has
/// smooth relief of `swell` and white roughness of `roughness`.
void add_seabed(Random& random, FacetMesh& mesh, int n, std::int32_t width, std::int32_t z,
                std::int32_t swell, std::int32_t roughness);

/// Gives vertices at the same grid point the same index, as loading does.
void weld(FacetMesh& mesh);

/// Returns columns x rows tubes between the rays first + i * across + j * up. Along the rays, `across` is
/// to the right and `up` is upwards.
TubeSet parallelogram_tubes(GridPoint apex, GridPoint first, GridPoint across, GridPoint up, int columns = 1,
                            int rows = 1);

}  // namespace tubefoot::atlas
