// SPDX-License-Identifier: GPL-3.0-or-later
// Compares visible polygons with CGAL's Envelope_3. One of the assertions of Envelope_3 in CGAL 5.5.1 is
// ambiguous in C++20. Some preconditions need the assertions.
#define CGAL_NO_ASSERTIONS
#define CGAL_NO_PRECONDITIONS
#include <CGAL/Env_surface_data_traits_3.h>
#include <CGAL/Env_triangle_traits_3.h>
#include <CGAL/Simple_cartesian.h>
#include <CGAL/envelope_3.h>
#include <gtest/gtest.h>

#include <map>
#include <string>

#include "fixtures/geometry/exact_oracles.hpp"
#include "fixtures/geometry/small_views.hpp"
#include "geometry/visibility/visibility.hpp"

// Compares visible polygons with CGAL's lower envelope of triangles. The projective map (x, y, z) -> (z/y,
// x/y, -1/y) about the apex makes rays of the apex vertical and keeps planes and their order. The first
// facet along a ray thus becomes the lowest. The test is a separate file because Envelope_3 takes long to
// compile.
namespace tubefoot {
namespace {

using namespace test;

using Kernel = CGAL::Simple_cartesian<Q>;
using Traits = CGAL::Env_surface_data_traits_3<CGAL::Env_triangle_traits_3<Kernel>, FacetId>;
using Diagram = CGAL::Envelope_diagram_2<Traits>;

const V3 forward{0, 1, 0};

Kernel::Point_3 mapped(const V3& p) { return {p[2] / p[1], p[0] / p[1], -1 / p[1]}; }
V3 direction_to(const Kernel::Point_2& p) { return {p.y(), 1, p.x()}; }

/// Part of the envelope on which one facet is lowest, or the first of several coincident facets.
struct Patch {
  FacetId facet;
  std::vector<Cone> boundary;  ///< outer boundary counter-clockwise, holes clockwise
};

std::vector<Patch> envelope(const FacetMesh& mesh, GridPoint apex) {
  std::vector<Traits::Surface_3> triangles;
  for (FacetId f = 0; f < mesh.facets.size(); ++f)
    if (const auto s = seen_from(mesh, f, apex))
      triangles.emplace_back(
          Kernel::Triangle_3(mapped(s->vertex[0]), mapped(s->vertex[1]), mapped(s->vertex[2])), f);
  Diagram diagram;
  CGAL::lower_envelope_3(triangles.begin(), triangles.end(), diagram);

  const auto loop = [](auto edge) {
    Cone cone;
    const auto first = edge;
    do cone.push_back(direction_to(edge->source()->point()));
    while (++edge != first);
    return cone;
  };
  std::vector<Patch> patches;
  for (auto face = diagram.faces_begin(); face != diagram.faces_end(); ++face) {
    if (face->is_unbounded() || face->surfaces_begin() == face->surfaces_end()) continue;
    Patch patch{face->surfaces_begin()->data(), {loop(face->outer_ccb())}};
    for (auto s = face->surfaces_begin(); s != face->surfaces_end(); ++s)
      patch.facet = std::min(patch.facet, s->data());
    for (auto hole = face->holes_begin(); hole != face->holes_end(); ++hole)
      patch.boundary.push_back(loop(*hole));
    patches.push_back(std::move(patch));
  }
  return patches;
}

bool all_ahead(const Scene& scene) {
  for (const auto& facet : scene.mesh.facets)
    for (const VertexId v : facet)
      if (scene.mesh.vertices[v].y <= scene.tubes.apex.y) return false;
  for (const GridPoint& ray : scene.tubes.rays)
    if (ray.y <= 0) return false;
  return true;
}

/// Returns the first facet in the same plane: coplanar facets count together.
std::vector<FacetId> plane_leaders(const FacetMesh& mesh, GridPoint apex) {
  std::vector<FacetId> leader;
  for (FacetId f = 0; f < mesh.facets.size(); ++f) {
    leader.push_back(f);
    const auto s = seen_from(mesh, f, apex);
    for (FacetId g = 0; s && g < f; ++g) {
      const auto other = seen_from(mesh, g, apex);
      if (other && same_plane(*s, *other)) {
        leader.back() = leader[g];
        break;
      }
    }
  }
  return leader;
}

/// Compares all tubes of a scene. Returns the number of facets that are visible in a tube.
std::size_t compare_with_envelope(const Scene& scene) {
  const GnomonicPlane plane(forward);
  std::size_t compared = 0;
  const auto patches = envelope(scene.mesh, scene.tubes.apex);
  const auto leader = plane_leaders(scene.mesh, scene.tubes.apex);
  const SceneTree tree(scene.mesh);
  VisibilityScratch scratch;
  TubeVisibility seen;
  for (std::uint32_t t = 0; t < scene.tubes.tubes.size(); ++t) {
    SCOPED_TRACE(testing::Message() << "tube " << t);
    std::map<FacetId, Q> rest;
    const std::vector<V3> walls = walls_of(cone_of(scene.tubes, t));
    for (const Patch& patch : patches)
      for (const Cone& boundary : patch.boundary)
        rest[leader[patch.facet]] += plane.area(clipped(boundary, walls));
    for (const auto& [facet, area] : rest) compared += area != 0;
    see(scene.mesh, tree, scene.tubes, t, {}, scratch, seen);
    for (const NamedPiece& piece : seen.pieces)
      rest[leader[piece.facet]] -= plane.area(cone_of(scene.mesh, scene.tubes.apex, seen, piece));
    for (const auto& [facet, area] : rest) EXPECT_EQ(area, 0) << "facet " << facet;
  }
  return compared;
}

// Law V1.
TEST(EnvelopeOracle, AreasEqualThoseOfTheLowerEnvelope) {
  std::size_t compared = 0, scenes = 0;
  for (std::uint64_t seed = 201; seed < 201 + (12 + one_in - 1) / one_in; ++seed)
    for (const Scene& scene : adversarial_cases(seed)) {
      if (!all_ahead(scene)) continue;
      SCOPED_TRACE(testing::Message() << "seed " << seed << ", " << scene.name);
      ++scenes;
      compared += compare_with_envelope(scene);
      if (testing::Test::HasFailure()) return;
    }
  EXPECT_GT(scenes, 20 / one_in);
  EXPECT_GT(compared, 1000 / one_in);
}

TEST(EnvelopeOracle, AreasOfSolidsTerrainAndRealMeshesEqualThoseOfTheLowerEnvelope) {
  std::map<std::string, std::size_t> compared;
  for (std::uint64_t seed = 231; seed < 231 + (3 + one_in - 1) / one_in; ++seed)
    for (const Scene& scene : small_views(seed, 80)) {
      ASSERT_TRUE(all_ahead(scene)) << scene.name;
      SCOPED_TRACE(testing::Message() << "seed " << seed << ", " << scene.name);
      compared[scene.name] += compare_with_envelope(scene);
      if (testing::Test::HasFailure()) return;
    }
  EXPECT_GE(compared.size(), 4u);
  for (const auto& [name, facets] : compared) EXPECT_GT(facets, 12 / one_in) << name;
}

}  // namespace
}  // namespace tubefoot
