// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/visibility/plain_sight.hpp"

#include <gtest/gtest.h>

#include <array>
#include <optional>
#include <set>

#include "fixtures/geometry/layered_scenes.hpp"

// What planes alone tell, against rays in integers.
namespace tubefoot {
namespace {

using namespace test;

Int128 det(GridPoint a, GridPoint b, GridPoint c) { return dot(cross(a, b), c); }

/// A place off the middle of a facet, on one side of it or the other; none if rounding put it in the plane.
std::optional<GridPoint> beside(const FacetMesh& mesh, FacetId f, int off) {
  const auto& [i, j, k] = mesh.facets[f];
  const GridPoint a = mesh.vertices[i], b = mesh.vertices[j], c = mesh.vertices[k];
  const Vec64 n = cross(b - a, c - a);
  const GridPoint place{std::int32_t((std::int64_t(a.x) + b.x + c.x) / 3) + off * (n.x > 0   ? 1
                                                                                   : n.x < 0 ? -1
                                                                                             : 0),
                        std::int32_t((std::int64_t(a.y) + b.y + c.y) / 3) + off * (n.y > 0   ? 1
                                                                                   : n.y < 0 ? -1
                                                                                             : 0),
                        std::int32_t((std::int64_t(a.z) + b.z + c.z) / 3) + off * (n.z > 0   ? 1
                                                                                   : n.z < 0 ? -1
                                                                                             : 0)};
  if (dot(n, place - a) == 0) return std::nullopt;
  return place;
}

/// A facet other than f that a ray meets before the point of f, relative to the apex, at which `parts` of its
/// corners add up to.
std::optional<FacetId> met_before(const FacetMesh& mesh, GridPoint apex, const FacetCone& f,
                                  std::array<int, 3> parts) {
  const int all = parts[0] + parts[1] + parts[2];
  GridPoint ray{};
  for (std::size_t k = 0; k < 3; ++k)
    ray = {ray.x + parts[k] * f.point[k].x, ray.y + parts[k] * f.point[k].y, ray.z + parts[k] * f.point[k].z};
  FacetCone g;
  for (FacetId id = 0; id < mesh.facets.size(); ++id) {
    if (id == f.id || !FacetCone::make(mesh, id, apex, g)) continue;
    if (det(g.point[0], g.point[1], ray) <= 0 || det(g.point[1], g.point[2], ray) <= 0 ||
        det(g.point[2], g.point[0], ray) <= 0)
      continue;
    // At offset / (normal . ray) of the ray; f at 1 / all.
    const Int128 nearer = dot(g.normal, ray) - g.offset * all;
    if (nearer > 0 || (nearer == 0 && wins_tie(mesh, id, f.id))) return id;
  }
  return std::nullopt;
}

/// How many facets were whole and how many asked for a look, all told of the facets' middles of a mesh.
std::array<std::size_t, 2> expect_law(const FacetMesh& mesh) {
  const PlainSight plain(mesh);
  std::array<std::size_t, 2> found{0, 0};
  for (FacetId on = 0; on < mesh.facets.size(); ++on)
    for (const int off : {-1, 1, 5}) {
      const auto place = beside(mesh, on, off);
      if (!place) continue;
      const PlainSight::View view = plain.seen_from(*place, on);
      const std::set<FacetId> whole(view.whole.begin(), view.whole.end());
      found[0] += whole.size();
      FacetCone own, f;
      EXPECT_TRUE(FacetCone::make(mesh, on, *place, own));
      for (FacetId id = 0; id < mesh.facets.size(); ++id) {
        if (!FacetCone::make(mesh, id, *place, f)) continue;
        found[1] += view.look[id];
        bool before = false;
        // The place is at the origin: before the facet's plane is where the origin is.
        for (const GridPoint& p : f.point) before = before || dot(own.normal, p) < own.offset;
        if (!whole.contains(id)) {
          EXPECT_TRUE(view.look[id] || !before || id == on) << on << " loses " << id;
          continue;
        }
        EXPECT_FALSE(view.look[id]);
        for (const GridPoint& p : f.point) EXPECT_LE(dot(own.normal, p), own.offset) << on << ' ' << id;
        for (const auto& parts : {std::array{1, 1, 1}, {6, 1, 1}, {1, 6, 1}, {1, 1, 6}, {3, 3, 1}}) {
          const auto other = met_before(mesh, *place, f, parts);
          EXPECT_FALSE(other) << *other << " hides some of " << id << " from " << on;
        }
      }
      if (testing::Test::HasFailure()) return found;
    }
  return found;
}

// Law X1.
TEST(PlainSight, WhatIsSeenWholeIsMetFirst) {
  std::array<std::size_t, 2> found{0, 0};
  for (std::uint64_t seed = 1; seed < 5; ++seed) {
    Random random(seed);
    std::vector<FacetMesh> meshes{random_soup(random, 12, 1000, 500), random_soup(random, 30, 1000, 100),
                                  rough_terrain(random, 5, 2000, -300, 100)};
    for (const FacetMesh& mesh : meshes) {
      const auto [whole, look] = expect_law(mesh);
      found[0] += whole;
      found[1] += look;
      if (HasFailure()) return;
    }
  }
  EXPECT_GT(found[0], 1000u);
  EXPECT_GT(found[1], 10000u);
}

// Law X1: from places in a sphere all of it is seen, but where rounding makes edges hollow; what stands in
// it hides some.
TEST(PlainSight, InARoomAllIsSeenWhole) {
  FacetMesh room;
  add_sphere(room, {0, 0, 0}, 1e6, 2);
  const std::size_t count = room.facets.size();
  const PlainSight plain(room);
  for (FacetId on = 0; on < count; ++on) {
    const auto& [a, b, c] = room.facets[on];
    const auto middle = [&](std::int64_t sum) { return static_cast<std::int32_t>(sum * 100 / 301); };
    const GridPoint p = room.vertices[a], q = room.vertices[b], r = room.vertices[c];
    const GridPoint place{middle(std::int64_t(p.x) + q.x + r.x), middle(std::int64_t(p.y) + q.y + r.y),
                          middle(std::int64_t(p.z) + q.z + r.z)};
    EXPECT_EQ(plain.seen_from(place, on).whole.size(), count - 1);
  }
  FacetMesh furnished;
  add_sphere(furnished, {0, 0, 0}, 1e6, 1);
  add_sphere(furnished, {100000, 50000, 0}, 3e5, 0);
  const auto [whole, look] = expect_law(furnished);
  EXPECT_GT(whole, 0u);
  EXPECT_GT(look, 0u);
}

TEST(PlainSight, WallsOfTwoFacetsHideNothingOfEachOther) {
  FacetMesh box;  // its corners, and two facets for each side
  for (int k = 0; k < 8; ++k) add_vertex(box, {(k & 1) * 1000, (k >> 1 & 1) * 1000, (k >> 2 & 1) * 1000});
  const auto add_wall = [&](VertexId a, VertexId b, VertexId c, VertexId d) {
    add_facet(box, a, b, c);
    add_facet(box, a, c, d);
  };
  add_wall(0, 1, 3, 2);
  add_wall(4, 6, 7, 5);
  add_wall(0, 4, 5, 1);
  add_wall(2, 3, 7, 6);
  add_wall(0, 2, 6, 4);
  add_wall(1, 5, 7, 3);
  const PlainSight plain(box);
  EXPECT_EQ(plain.seen_from({600, 300, 1}, 0).whole.size(), 10u);  // all but the floor
  EXPECT_EQ(expect_law(box)[1], 0u);
  // One facet more in the plane of a wall, over it: which of the two is seen is decided by a look.
  add_facet(box, 4, 7, 5);
  EXPECT_GT(expect_law(box)[1], 0u);
}

TEST(PlainSight, LargeMeshesAreRefused) {
  FacetMesh mesh;
  for (const GridPoint p : {GridPoint{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}) add_vertex(mesh, p);
  for (std::size_t k = 0; k <= PlainSight::most_facets; ++k) add_facet(mesh, 0, 1, 2);
  EXPECT_THROW(PlainSight{mesh}, std::length_error);
}

}  // namespace
}  // namespace tubefoot
