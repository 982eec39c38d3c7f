// SPDX-License-Identifier: GPL-3.0-or-later
// Compares shared footprints with polygon clipping in rationals (exact_oracles.hpp). The set of parts is
// exact, and the areas agree to rounding.
#include "geometry/footprints/shared_footprints.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <numeric>
#include <tuple>

#include "fixtures/geometry/exact_oracles.hpp"
#include "fixtures/geometry/grid_scenes.hpp"
#include "fixtures/geometry/looks.hpp"
#include "geometry/footprints/footprint_builder.hpp"
#include "geometry/integrals/measure.hpp"

namespace tubefoot {
namespace {

using test::Q;
using test::V3;

struct Look {
  TubeSet tubes;
  std::vector<TubeVisibility> seen;
  operator ApexLook() const { return {tubes, seen}; }
};

Look shared_look(const FacetMesh& mesh, const TubeSet& tubes, Arithmetic arithmetic = Arithmetic::fixed) {
  const SceneTree tree(mesh);
  VisibilityScratch scratch;
  Look result{tubes, std::vector<TubeVisibility>(tubes.tubes.size())};
  for (std::uint32_t t = 0; t < tubes.tubes.size(); ++t)
    see(mesh, tree, tubes, t, test::with(arithmetic), scratch, result.seen[t]);
  return result;
}

SharedFootprints share(const FacetMesh& mesh, const Look& transmit, const Look& receive, double unit_m = 1) {
  return FootprintSharer(mesh, transmit, receive, unit_m).all();
}

TubeSet moved(TubeSet tubes, GridPoint by) {
  tubes.apex = {tubes.apex.x + by.x, tubes.apex.y + by.y, tubes.apex.z + by.z};
  return tubes;
}

double area_of(const SharedFootprints& shared, const SharedFacet& facet, const SharedPiece& piece) {
  const FacetPlane plane{facet.plane_normal, facet.transmit_distance_m};
  PlanarPolygon polygon;
  polygon.assign(std::span(shared.corners_m).subspan(piece.first, piece.count), plane, PlaneFrame(plane));
  return area(polygon);
}

/// Facet, transmit tube, receive tube.
using Key = std::tuple<FacetId, std::uint32_t, std::uint32_t>;
struct Part {
  int pieces = 0;
  double area = 0, rounding = 0;
  std::vector<std::vector<V3>> corners;  // of the oracle's polygons, from the transmit apex
};
using Parts = std::map<Key, Part>;

Parts parts_of(const SharedFootprints& shared) {
  Parts parts;
  for (const SharedFacet& facet : shared.facets)
    for (std::uint32_t k = 0; k < facet.piece_count; ++k) {
      const SharedPiece& piece = shared.pieces[facet.first_piece + k];
      Part& part = parts[{facet.facet, piece.transmit_tube, piece.receive_tube}];
      ++part.pieces;
      part.area += area_of(shared, facet, piece);
    }
  return parts;
}

/// Returns the points of a piece on the plane of its facet, relative to the transmit apex.
std::vector<V3> points_of(const FacetMesh& mesh, const Look& shared_look, std::uint32_t tube,
                          const NamedPiece& piece, const V3& from_transmitter) {
  const auto facet = test::seen_from(mesh, piece.facet, shared_look.tubes.apex).value();
  std::vector<V3> points;
  for (const V3& d : test::cone_of(mesh, shared_look.tubes.apex, shared_look.seen[tube], piece)) {
    V3 p = test::times(Q(facet.c / test::scalar_product(facet.n, d)), d);
    for (int k = 0; k < 3; ++k) p[k] += from_transmitter[k];
    points.push_back(p);
  }
  return points;
}

/// Computes the same by clipping in rationals.
Parts shared_oracle(const FacetMesh& mesh, const Look& transmit, const Look& receive) {
  const V3 baseline = test::minus(test::vec(receive.tubes.apex), test::vec(transmit.tubes.apex));
  Parts parts;
  for (std::uint32_t t = 0; t < transmit.seen.size(); ++t)
    for (const NamedPiece& sent : transmit.seen[t].pieces)
      for (std::uint32_t r = 0; r < receive.seen.size(); ++r)
        for (const NamedPiece& received : receive.seen[r].pieces) {
          if (sent.facet != received.facet) continue;
          const auto a = test::seen_from(mesh, sent.facet, transmit.tubes.apex).value(),
                     b = test::seen_from(mesh, received.facet, receive.tubes.apex).value();
          if (test::scalar_product(a.n, b.n) < 0) continue;  // the other side of the facet
          const auto window = points_of(mesh, receive, r, received, baseline);
          const auto cut =
              test::clipped(points_of(mesh, transmit, t, sent, {0, 0, 0}), test::walls_of(window));
          if (cut.size() < 3) continue;
          std::vector<V3> points;
          for (const V3& d : cut) points.push_back(test::times(Q(a.c / test::scalar_product(a.n, d)), d));
          Q twice = 0;
          double reach = 0, length = 0;
          for (std::size_t k = 0; k < points.size(); ++k) {
            const V3& next = points[(k + 1) % points.size()];
            twice += test::scalar_product(a.n, test::vector_product(points[k], next));
            const V3 edge = test::minus(next, points[k]);
            length += std::sqrt(CGAL::to_double(test::scalar_product(edge, edge)));
            reach = std::max(reach, std::sqrt(CGAL::to_double(test::scalar_product(next, next))));
          }
          if (twice <= 0) continue;
          Part& part = parts[{sent.facet, t, r}];
          ++part.pieces;
          part.corners.push_back(points);
          part.area +=
              CGAL::to_double(twice) / 2 / std::sqrt(CGAL::to_double(test::scalar_product(a.n, a.n)));
          part.rounding +=
              1e-15 * length * (reach + std::sqrt(CGAL::to_double(test::scalar_product(baseline, baseline))));
        }
  return parts;
}

void expect_equal(const Parts& got, const Parts& expected) {
  for (const auto& [key, part] : expected) {
    const auto found = got.find(key);
    ASSERT_NE(found, got.end()) << "facet " << std::get<0>(key) << ", tubes " << std::get<1>(key) << " and "
                                << std::get<2>(key) << " share " << part.area;
    EXPECT_EQ(found->second.pieces, part.pieces);
    EXPECT_NEAR(found->second.area, part.area, 1e-13 * part.area + 8 * part.rounding);
  }
  EXPECT_EQ(got.size(), expected.size());
}

// Law S5. The audit detects a look that differs from the visible polygons of the apex.
TEST(SharedFootprints, AuditsCloseAndNameWhatIsShared) {
  std::size_t facets = 0, pieces = 0;
  for (std::uint64_t seed = 1; seed <= 12 / test::one_in; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    test::Random random(seed);
    const FacetMesh mesh = seed % 2 == 0 ? test::rough_terrain(random, 5, 4000, -1500, 500)
                                         : test::make_random_triangles(random, 10, 3000, 1500);
    const double tilt = seed % 2 == 0 ? 25 : 0;
    const TubeSet tx = test::forward_tubes({100, -50, 40}, 3, 2, 70, 60, tilt),
                  rx = test::forward_tubes({-300, 80, 200}, 2, 3, 70, 60, tilt);
    const auto audited = [&](const TubeSet& sent, const TubeSet& received, Arithmetic arithmetic) {
      const Look t = shared_look(mesh, sent, arithmetic), r = shared_look(mesh, received, arithmetic);
      const FootprintSharer sharer(mesh, t, r, 1);
      TopologyHash hash;
      std::size_t shared = 0;
      for (std::size_t k = 0; k < sharer.facets(); ++k) {
        const SharedAudit audit = sharer.audit(k, 7);
        EXPECT_TRUE(audit.closes) << "facet number " << k << ", defect " << audit.defect;
        EXPECT_EQ(audit.defect, 0);
        hash += audit.hash;
        shared += audit.pieces;
      }
      EXPECT_EQ(shared, sharer.all().pieces.size());
      facets += sharer.facets();
      pieces += shared;
      return hash;
    };
    const TopologyHash hash = audited(tx, rx, Arithmetic::fixed);
    EXPECT_EQ(audited(tx, rx, Arithmetic::filtered), hash);
    EXPECT_EQ(audited(tx, rx, Arithmetic::rational), hash);
    EXPECT_FALSE(audited(tx, moved(rx, {1, 0, 0}), Arithmetic::fixed) == hash);
  }
  EXPECT_GT(facets, 50u / test::one_in);
  EXPECT_GT(pieces, 100u / test::one_in);
}

TEST(SharedFootprints, AuditsFindAPieceThatIsSeenTwice) {
  FacetMesh mesh;
  test::add_facet(mesh, test::add_vertex(mesh, {-3000, 2000, -1000}),
                  test::add_vertex(mesh, {3000, 2000, -1000}), test::add_vertex(mesh, {0, 5000, -1000}));
  const TubeSet tx = test::forward_tubes({0, 0, 0}, 1, 1, 30, 30, 20),
                rx = test::forward_tubes({200, 0, 0}, 1, 1, 30, 30, 20);
  Look t = shared_look(mesh, tx);
  const Look r = shared_look(mesh, rx);
  ASSERT_FALSE(t.seen[0].pieces.empty());
  EXPECT_TRUE(FootprintSharer(mesh, t, r, 1).audit(0, 0).closes);
  t.seen[0].pieces.push_back(t.seen[0].pieces.front());
  const SharedAudit audit = FootprintSharer(mesh, t, r, 1).audit(0, 0);
  EXPECT_FALSE(audit.closes);
  EXPECT_GT(audit.defect, 0);
}

// Law S1.
TEST(SharedFootprints, AreThoseOfRationalClipping) {
  std::size_t shared = 0;
  for (const std::uint64_t seed : {20261, 20262})
    for (const test::Scene& scene : test::adversarial_cases(seed)) {
      test::Random random(seed);
      std::int32_t reach = 1;
      for (const GridPoint& p : scene.mesh.vertices)
        reach = std::max({reach, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
      if (reach > 1 << 28) continue;  // no space for another apex
      const std::int32_t step = std::max(reach / 8, 1);
      const Look transmit = shared_look(scene.mesh, scene.tubes);
      for (const GridPoint by :
           {GridPoint{0, 0, 0}, GridPoint{step, 0, 0},
            GridPoint{test::uniform(random, -step, step), test::uniform(random, -step, step),
                      test::uniform(random, -step, step)}}) {
        SCOPED_TRACE(testing::Message() << scene.name << ", seed " << seed << ", receiver at " << by.x << ' '
                                        << by.y << ' ' << by.z);
        const Look receive = shared_look(scene.mesh, moved(scene.tubes, by));
        const Parts expected = shared_oracle(scene.mesh, transmit, receive);
        expect_equal(parts_of(share(scene.mesh, transmit, receive)), expected);
        shared += expected.size();
      }
    }
  EXPECT_GT(shared, 1500u);
}

/// Whether a point lies on the border of one of the polygons, to within `error`.
bool is_on_border(const V3& p, const std::vector<std::vector<V3>>& polygons, const Q& error) {
  for (const std::vector<V3>& points : polygons)
    for (std::size_t k = 0; k < points.size(); ++k) {
      const V3 &a = points[k], &b = points[(k + 1) % points.size()];
      const V3 from_a = test::minus(p, a), edge = test::minus(b, a);
      if (test::scalar_product(from_a, from_a) <= error * error) return true;
      const V3 aside = test::vector_product(edge, from_a);
      const Q length2 = test::scalar_product(edge, edge), along = test::scalar_product(edge, from_a);
      if (along > 0 && along < length2 && test::scalar_product(aside, aside) <= error * error * length2)
        return true;
    }
  return false;
}

// Law S6.
TEST(SharedFootprints, CornersWithTheirRestsAreThoseOfRationalClipping) {
  const double unit_m = 0x1p-10;
  std::size_t corners = 0, rounded = 0;
  for (const std::uint64_t seed : {20265, 20266})
    for (const test::Scene& scene : test::adversarial_cases(seed)) {
      test::Random random(seed);
      std::int32_t reach = 1;
      for (const GridPoint& p : scene.mesh.vertices)
        reach = std::max({reach, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
      if (reach > 1 << 28) continue;  // no space for another apex
      const std::int32_t step = std::max(reach / 8, 1);
      const Look transmit = shared_look(scene.mesh, scene.tubes);
      for (const GridPoint by : {GridPoint{0, 0, 0}, GridPoint{test::uniform(random, -step, step),
                                                               test::uniform(random, -step, step),
                                                               test::uniform(random, -step, step)}}) {
        SCOPED_TRACE(testing::Message() << scene.name << ", seed " << seed << ", receiver at " << by.x << ' '
                                        << by.y << ' ' << by.z);
        const Look receive = shared_look(scene.mesh, moved(scene.tubes, by));
        const Parts expected = shared_oracle(scene.mesh, transmit, receive);
        const auto check = [&](const SharedFootprints& shared, bool exchanged) {
          ASSERT_EQ(shared.corner_rests_m.size(), shared.corners_m.size());
          const double apart = std::abs(by.x) + std::abs(by.y) + std::abs(by.z);
          for (const SharedFacet& facet : shared.facets)
            for (std::uint32_t k = 0; k < facet.piece_count; ++k) {
              const SharedPiece& piece = shared.pieces[facet.first_piece + k];
              const Part& part = exchanged
                                     ? expected.at({facet.facet, piece.receive_tube, piece.transmit_tube})
                                     : expected.at({facet.facet, piece.transmit_tube, piece.receive_tube});
              for (std::uint32_t c = piece.first; c < piece.first + piece.count; ++c) {
                const glm::dvec3 corner = shared.corners_m[c], rest = shared.corner_rests_m[c];
                V3 exact;
                for (int axis = 0; axis < 3; ++axis)
                  exact[axis] = (Q(corner[axis]) + Q(rest[axis])) / Q(unit_m);
                if (exchanged) {
                  const V3 baseline = test::vec(by);
                  for (int axis = 0; axis < 3; ++axis) exact[axis] += baseline[axis];
                }
                const double size = 4 * (glm::length(corner) / unit_m + 2 * apart);
                EXPECT_TRUE(is_on_border(exact, part.corners, Q(size) * Q(corner_rest_error)));
                ++corners;
                rounded += rest != glm::dvec3(0);
              }
            }
        };
        const SharedDetails details{.corner_rests = true};
        const SharedFootprints shared = FootprintSharer(scene.mesh, transmit, receive, unit_m, details).all();
        EXPECT_EQ(shared.corners_m, share(scene.mesh, transmit, receive, unit_m).corners_m);
        check(shared, false);
        check(exchanged(shared), true);
        if (by == GridPoint{}) check(shared_with_itself(scene.mesh, transmit, unit_m, details), false);
      }
    }
  EXPECT_GT(corners, 3000u);
  EXPECT_GT(rounded, corners / 4);
}

// Law S3.
TEST(SharedFootprints, OfOneApexAreItsFootprintsAndNeighboursShareNothing) {
  for (const test::Scene& scene : test::adversarial_cases(20263)) {
    SCOPED_TRACE(scene.name);
    const Look both = shared_look(scene.mesh, scene.tubes);
    const SharedFootprints shared = share(scene.mesh, both, both, 0x1p-10);
    EXPECT_EQ(shared.receiver_m, glm::dvec3(0));
    std::size_t pieces = 0;
    for (const TubeVisibility& seen : both.seen) pieces += seen.pieces.size();
    EXPECT_EQ(shared.pieces.size(), pieces);
    for (const SharedPiece& piece : shared.pieces) EXPECT_EQ(piece.transmit_tube, piece.receive_tube);

    FootprintSet set;
    for (std::uint32_t t = 0; t < both.seen.size(); ++t)
      append_footprints(scene.mesh, both.tubes, t, both.seen[t], 0x1p-10, set);
    measure(set);
    const Parts parts = parts_of(shared);
    EXPECT_EQ(parts.size(), set.footprints.size());
    for (const Footprint& footprint : set.footprints) {
      const Part& part = parts.at({footprint.facet, footprint.tube, footprint.tube});
      const double size = footprint.slant_range_max_m * footprint.slant_range_max_m;
      EXPECT_NEAR(part.area, footprint.area_m2, 1e-12 * footprint.area_m2 + 1e-15 * size);
    }
  }
}

// Laws S2 and S4.
TEST(SharedFootprints, AddUpToWhatTheOtherSeesOfAFootprint) {
  // The sum holds for each division of the receiver's sector into tubes, and after an exchange of both
  // ends.
  test::Random random(20264);
  const FacetMesh mesh = test::rough_terrain(random, 12, 20000000, -3000000, 900000);
  const TubeSet many = test::lattice_tubes({2500000, 300000, 100000}, -4, -5, 8, 6, 4);
  TubeSet one = many;
  one.tubes = {{0, 6 * 9, 6 * 9 + 8, 8}};
  const Look transmit = shared_look(mesh, test::forward_tubes({-2000000, 0, 0}, 4, 1, 60, 40, 20));
  const Look fine = shared_look(mesh, many), coarse = shared_look(mesh, one);
  const Parts by_fine = parts_of(share(mesh, transmit, fine)),
              by_coarse = parts_of(share(mesh, transmit, coarse)),
              swapped = parts_of(share(mesh, fine, transmit));
  Parts sum;
  for (const auto& [key, part] : by_fine) {
    sum[{std::get<0>(key), std::get<1>(key), 0}].area += part.area;
    const Part& other = swapped.at({std::get<0>(key), std::get<2>(key), std::get<1>(key)});
    EXPECT_EQ(other.pieces, part.pieces);
    EXPECT_NEAR(other.area, part.area, 1e-11 * part.area + 0.1);
  }
  EXPECT_EQ(swapped.size(), by_fine.size());
  ASSERT_EQ(sum.size(), by_coarse.size());
  FootprintSet set;
  for (std::uint32_t t = 0; t < transmit.seen.size(); ++t)
    append_footprints(mesh, transmit.tubes, t, transmit.seen[t], 1, set);
  measure(set);
  std::size_t whole = 0, partial = 0;
  for (const Footprint& footprint : set.footprints) {
    const Key key{footprint.facet, footprint.tube, 0};
    const auto found = by_coarse.find(key);
    if (found == by_coarse.end()) continue;
    const double area = found->second.area;
    EXPECT_NEAR(area, sum.at(key).area, 1e-11 * area + 0.1);
    EXPECT_LE(area, footprint.area_m2 * (1 + 1e-12) + 0.1);
    (area > 0.999999 * footprint.area_m2 ? whole : partial) += 1;
  }
  EXPECT_GT(whole, 20u);
  EXPECT_GT(partial, 20u);
}

// A receiver looks at an image of the mesh, scaled and rotated, from the image of its apex along the images
// of its rays. It sees the same as in the mesh.
TEST(SharedFootprints, OfImagesAreThoseOfTheMesh) {
  std::size_t shared = 0;
  for (const std::uint64_t seed : {20265, 20266}) {
    SCOPED_TRACE(seed);
    test::Random random(seed);
    const FacetMesh mesh = test::rough_terrain(random, 12, 20000000, -3000000, 900000);
    const auto image_of = [](GridPoint p) { return GridPoint{3 * p.z, p.x - p.z, p.y}; };
    FacetMesh image = mesh;
    for (GridPoint& v : image.vertices) v = image_of(v);
    const Look transmit = shared_look(mesh, test::lattice_tubes({-2000000, 0, 0}, -4, -5, 8, 6, 4)),
               receive = shared_look(mesh, test::lattice_tubes({2500000, 300000, 100000}, -4, -5, 8, 6, 3));
    TubeSet tubes = receive.tubes;
    tubes.apex = image_of(tubes.apex);
    tubes.reach = 1e12;
    for (GridPoint& ray : tubes.rays) ray = image_of(ray);
    const Look there = shared_look(image, tubes);
    const ApexLook sent{transmit.tubes, transmit.seen, &mesh}, received{there.tubes, there.seen, &image};
    Parts expected = shared_oracle(mesh, transmit, receive),
          found = parts_of(FootprintSharer(sent, received, 1).all());
    // The number of convex pieces depends on the view.
    for (auto& [key, part] : found)
      if (const auto of = expected.find(key); of != expected.end()) part.pieces = of->second.pieces;
    expect_equal(found, expected);
    shared += expected.size();
  }
  EXPECT_GT(shared, 100u);
}

TEST(SharedFootprints, WhatOnlyOneOfThemSeesIsNotShared) {
  // A seabed, and a wall between the apexes that rises above both of them.
  FacetMesh mesh;
  const auto quad = [&](GridPoint a, GridPoint b, GridPoint c, GridPoint d) {
    const VertexId first = test::add_vertex(mesh, a);
    for (const GridPoint& p : {b, c, d}) test::add_vertex(mesh, p);
    test::add_facet(mesh, first, first + 1, first + 2);
    test::add_facet(mesh, first, first + 2, first + 3);
  };
  quad({-5000, 0, -1000}, {5000, 0, -1000}, {5000, 10000, -1000}, {-5000, 10000, -1000});
  const TubeSet left = test::forward_tubes({-1000, 100, 0}, 3, 2, 120, 60, 30),
                right = test::forward_tubes({1000, 100, 0}, 3, 2, 120, 60, 30);
  EXPECT_GT(share(mesh, shared_look(mesh, left), shared_look(mesh, right)).pieces.size(), 4u);
  quad({0, 0, -1000}, {0, 10000, -1000}, {0, 10000, 9000}, {0, 0, 9000});
  EXPECT_EQ(share(mesh, shared_look(mesh, left), shared_look(mesh, right)).pieces.size(), 0u);
}

TEST(SharedFootprints, TheTwoSidesOfAFacetAreNotTheSame) {
  FacetMesh mesh;
  for (const GridPoint& p : {GridPoint{-900, 1000, -900}, {900, 1000, -900}, {0, 1000, 900}})
    test::add_vertex(mesh, p);
  test::add_facet(mesh, 0, 1, 2);
  const TubeSet before = test::lattice_tubes({0, 0, 0}, -1, -1, 2, 2, 1);
  TubeSet behind = before;
  behind.apex = {0, 2000, 0};
  for (GridPoint& ray : behind.rays) ray = {-ray.x, -ray.y, ray.z};
  const Look a = shared_look(mesh, before), b = shared_look(mesh, behind);
  ASSERT_EQ(a.seen[0].pieces.size(), 1u);
  ASSERT_EQ(b.seen[0].pieces.size(), 1u);
  EXPECT_EQ(share(mesh, a, b).facets.size(), 0u);
  EXPECT_EQ(share(mesh, b, b).facets.size(), 1u);
}

// Law S2.
TEST(SharedFootprints, ContactsWithoutAreaGiveNothingAndAGridUnitDoes) {
  // A plate at y = 1000. The sections of the tubes with the plate are squares that share an edge, share a
  // corner, or overlap by one unit.
  FacetMesh mesh;
  for (const GridPoint& p : {GridPoint{-100000, 1000, -100000}, {100000, 1000, -100000}, {0, 1000, 100000}})
    test::add_vertex(mesh, p);
  test::add_facet(mesh, 0, 1, 2);
  const auto window = [&](GridPoint apex, std::int32_t x, std::int32_t z) {
    TubeSet set;
    set.apex = apex;
    set.reach = 1e9;
    const std::int32_t far = 1000 - apex.y;
    for (const auto& [i, k] : {std::pair{0, 0}, {0, 1}, {1, 1}, {1, 0}})
      set.rays.push_back({x + 100 * i - apex.x, far, z + 100 * k - apex.z});
    set.tubes = {{0, 1, 2, 3}};
    return shared_look(mesh, set);
  };
  const Look transmit = window({0, 0, 0}, 0, 0);
  ASSERT_EQ(transmit.seen[0].pieces.size(), 1u);
  for (const auto& [x, z, width] : {std::tuple{100, 0, 0},
                                    {100, 100, 0},
                                    {-100, 37, 0},
                                    {0, -100, 0},
                                    {99, 0, 1},
                                    {99, 99, 1},
                                    {0, 0, 100}}) {
    const SharedFootprints shared = share(mesh, transmit, window({70, -900, -33}, x, z));
    ASSERT_EQ(shared.pieces.size(), width > 0 ? 1u : 0u) << x << ' ' << z;
    if (width > 0) {
      EXPECT_EQ(shared.pieces[0].count, 4u);
      EXPECT_NEAR(area_of(shared, shared.facets[0], shared.pieces[0]), (100 - x) * (100 - z), 1e-9);
    }
  }
}

TEST(SharedFootprints, DoNotDependOnTheArithmetic) {
  test::Random random(20265);
  const FacetMesh mesh = test::make_random_triangles(random, 25, 1000000, 500000);
  const TubeSet a = test::forward_tubes({0, 0, 0}, 2, 2, 60, 50),
                b = test::forward_tubes({150000, -70000, 30000}, 3, 1, 70, 50);
  const Parts fixed = parts_of(share(mesh, shared_look(mesh, a), shared_look(mesh, b)));
  const Parts rational = parts_of(
      share(mesh, shared_look(mesh, a, Arithmetic::rational), shared_look(mesh, b, Arithmetic::rational)));
  ASSERT_EQ(fixed.size(), rational.size());
  for (const auto& [key, part] : fixed)
    EXPECT_NEAR(rational.at(key).area, part.area, 1e-11 * part.area + 1e-4);
}

}  // namespace
}  // namespace tubefoot
