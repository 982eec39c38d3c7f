// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "geometry/mesh/facet_mesh.hpp"
#include "geometry/tubes/tube.hpp"
#include "prove/random.hpp"

// Random scenes of a few facets and four tubes each, with given seeds, from integers alone. They are small,
// so that millions of tubes can be checked in rationals, and as difficult as their kind permits.
namespace tubefoot::prove {

constexpr std::size_t tubes_per_scene = 4;

struct SmallScene {
  FacetMesh mesh;
  TubeSet tubes;  ///< four, two by two, with shared rays; each is a strictly convex pyramid
};

/// Kinds of difficult scenes.
constexpr std::array<std::string_view, 16> generator_names{
    "soup",                   // facets that intersect each other, at any scale
    "tiny lattice",           // everything coincides with everything
    "all round the apex",     // facets across the horizon of the apex, very wide tubes
    "on walls",               // vertices on rays and walls, edges in walls
    "coincident facets",      // the same facet two and three times
    "coplanar facets",        // overlapping in one or two planes
    "layers one unit apart",  // parallel surfaces, tilted or not
    "edge-on",                // facet planes that contain the apex, or miss it by a unit
    "apex touched",           // the apex is a vertex, lies on an edge, lies in a facet
    "slivers",                // a unit thick and up to 2^28 long
    "T-junctions",            // vertices within edges, exactly and a unit off
    "range ends",             // coordinates of 2^25 to 2^30, the ends of the bit budget
    "solids",                 // a box and an octahedron that intersect
    "grazing terrain",        // a seabed seen from close above it
    "needle tubes",           // rays of length 2^30 that differ by single units
    "pencils",                // many facets at one edge, many at one vertex
};

inline VertexId add_vertex(FacetMesh& mesh, GridPoint p) {
  mesh.vertices.push_back(p);
  return static_cast<VertexId>(mesh.vertices.size() - 1);
}

inline void add_facet(FacetMesh& mesh, VertexId a, VertexId b, VertexId c) {
  mesh.facets.push_back({a, b, c});
  mesh.material.push_back(0);
  mesh.component.push_back(0);
}

inline void add_facet(FacetMesh& mesh, GridPoint a, GridPoint b, GridPoint c) {
  const VertexId ia = add_vertex(mesh, a), ib = add_vertex(mesh, b), ic = add_vertex(mesh, c);
  add_facet(mesh, ia, ib, ic);
}

/// Scene number `index` of a seed: of kind index % generator_names.size().
SmallScene make_scene(std::uint64_t seed, std::uint64_t index);

/// A seabed of 2 n^2 facets under three spires, seen through 25 tubes, for errors that occur only among
/// many facets.
SmallScene make_large_scene(std::uint64_t seed, int n);

}  // namespace tubefoot::prove
