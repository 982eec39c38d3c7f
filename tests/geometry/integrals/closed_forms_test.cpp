// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <glm/geometric.hpp>
#include <numeric>
#include <optional>

#include "fixtures/geometry/layered_scenes.hpp"
#include "fixtures/geometry/plane_polygons.hpp"
#include "geometry/footprints/footprint_builder.hpp"
#include "geometry/integrals/measure.hpp"
#include "geometry/integrals/range_cut.hpp"
#include "geometry/numbers/scalars.hpp"

// Compares footprints, shadows, solid angles and range bins with closed forms (physics sheet, section 7).
// The test uses the whole kernel: facets and tubes on the grid, visible polygons, footprints, measures and
// range cuts.
namespace tubefoot {
namespace {

using namespace test;
using test::relative;

/// 2^-25 m: scenes extend 32 m from the apex at the origin. The rounding of a grid point is at most 1.5e-8
/// m, and of a ray 2^-31 rad.
constexpr int exponent = 25;
const WorldGrid grid(exponent, glm::dvec3(0));

void add_triangle(FacetMesh& mesh, glm::dvec3 a, glm::dvec3 b, glm::dvec3 c) {
  const VertexId i = add_vertex(mesh, grid.snap(a)), j = add_vertex(mesh, grid.snap(b)),
                 k = add_vertex(mesh, grid.snap(c));
  add_facet(mesh, i, j, k);
}
void add_quadrangle(FacetMesh& mesh, glm::dvec3 a, glm::dvec3 b, glm::dvec3 c, glm::dvec3 d) {
  add_triangle(mesh, a, b, c);
  add_triangle(mesh, a, c, d);
}
FacetMesh flat_seabed(double height) {
  FacetMesh mesh;
  const double far = 31;
  add_quadrangle(mesh, {-far, -far, -height}, {far, -far, -height}, {far, far, -height},
                 {-far, far, -height});
  return mesh;
}

TubeSet empty_set() {
  TubeSet set;
  set.reach = 1e12;
  return set;
}

/// Adds a tube with the given corner rays in the orientation of tubes.
void add_tube(TubeSet& set, std::array<glm::dvec3, 4> ray) {
  if (glm::dot(glm::cross(ray[0], ray[1]), ray[2]) < 0) std::swap(ray[1], ray[3]);
  const auto first = static_cast<std::uint32_t>(set.rays.size());
  for (const glm::dvec3& r : ray) set.rays.push_back(integer_ray(glm::normalize(r)));
  set.tubes.push_back({first, first + 1, first + 2, first + 3});
}

/// Returns a rectangular pyramid about `axis`, from the tangents of its half-angles sideways (horizontal)
/// and upwards.
TubeSet pyramid(glm::dvec3 axis, double sideways, double upwards) {
  axis = glm::normalize(axis);
  const glm::dvec3 side =
      glm::normalize(glm::cross(axis, std::abs(axis.z) < 0.9 ? glm::dvec3(0, 0, 1) : glm::dvec3(1, 0, 0)));
  const glm::dvec3 up = glm::cross(side, axis);
  TubeSet set = empty_set();
  add_tube(set, {axis - sideways * side - upwards * up, axis + sideways * side - upwards * up,
                 axis + sideways * side + upwards * up, axis - sideways * side + upwards * up});
  return set;
}

/// Azimuth cells about the vertical between two depressions, looking along x.
TubeSet azimuth_fan(double width, int cells, double lowest, double highest) {
  AngularGrid angles;
  for (int k = 0; k <= cells; ++k) angles.azimuth_edges_rad.push_back(width * k / cells - width / 2);
  angles.elevation_edges_rad = {-lowest, -highest};
  TubeSet set = empty_set();
  append_tubes(set, angles);
  return set;
}

/// A fan that starts straight below: one tube with the nadir and three rays to the seabed beyond `radius` /
/// height.
TubeSet fan_from_nadir(double width, double radius_over_height) {
  const double r = radius_over_height / std::cos(width / 2), t = std::tan(width / 2);
  TubeSet set = empty_set();
  add_tube(set, {{{0, 0, -1}, {r, -r * t, -1}, {1.5 * r, 0, -1}, {r, r * t, -1}}});
  return set;
}

FootprintSet footprints_of(const FacetMesh& mesh, const TubeSet& tubes, std::uint32_t facets_per_split = 64) {
  const SceneTree tree(mesh);
  VisibilityScratch scratch;
  VisibilityOptions options;
  options.facets_per_split = facets_per_split;
  TubeVisibility seen;
  FootprintSet set;
  for (std::uint32_t t = 0; t < tubes.tubes.size(); ++t) {
    see(mesh, tree, tubes, t, options, scratch, seen);
    append_footprints(mesh, tubes, t, seen, grid.unit_m(), set);
  }
  measure(set);
  return set;
}

double total(const FootprintSet& set, double Footprint::*what) {
  double sum = 0;
  for (const Footprint& footprint : set.footprints) sum += footprint.*what;
  return sum;
}
double area_of(const FootprintSet& set) { return total(set, &Footprint::area_m2); }
double solid_angle_of(const FootprintSet& set) { return total(set, &Footprint::solid_angle_sr); }

FootprintSet facets_from(FootprintSet set, FacetId first, FacetId end) {
  std::erase_if(set.footprints, [&](const Footprint& f) { return f.facet < first || f.facet >= end; });
  return set;
}

/// Returns the area by range bin.
std::vector<double> range_bins(const FootprintSet& set, const std::vector<double>& borders) {
  const RadialIntegral radial(borders, [](double) { return 1.0; });
  RangeCutter cutter(radial);
  std::vector<double> bins(radial.samples(), 0.0);
  for (const Footprint& f : set.footprints)
    for (std::uint32_t p = 0; p < f.piece_count; ++p) {
      const Piece& piece = set.pieces[f.first_piece + p];
      cutter.add(std::span(set.corners_m).subspan(piece.first, piece.count),
                 {f.plane_normal, f.plane_distance_m}, 1, bins);
    }
  return bins;
}

double first_return(const FootprintSet& set) {
  double range = 1e9;
  for (const Footprint& f : set.footprints) range = std::min(range, f.slant_range_min_m);
  return range;
}

/// Expects errors that fall by a factor of four for half the step.
void expect_second_order(const std::vector<double>& errors, double slack) {
  for (std::size_t k = 1; k < errors.size(); ++k)
    EXPECT_NEAR(errors[k - 1] / errors[k], 4, slack) << "at halving " << k << ": error " << errors[k];
}

// ---- 7.1 Footprints on a plane

TEST(ClosedForms, FootprintOfARectangularPyramid) {
  const double a = std::tan(0.15 * degree), b = std::tan(7 * degree);
  const FootprintSet set = footprints_of(flat_seabed(5), pyramid({std::cos(30 * degree), 0, -0.5}, a, b));
  EXPECT_LT(relative(area_of(set), 0.28210069162), 1e-6);
  glm::dvec3 lo(1e9), hi(-1e9);
  for (const glm::dvec3& corner : set.corners_m) {
    lo = glm::min(lo, corner);
    hi = glm::max(hi, corner);
    EXPECT_NEAR(std::abs(corner.y), corner.x < 9 ? 0.02158874 : 0.03325158, 5e-8);
  }
  EXPECT_NEAR(lo.x, 6.635224108, 5e-8);
  EXPECT_NEAR(hi.x, 11.779261829, 1e-7);
}

TEST(ClosedForms, FootprintOfAnAzimuthElevationTube) {
  const double h = 10, exact = 3.861177381;
  std::vector<double> errors;
  for (const int cells : {1, 2, 4, 8}) {
    const double area =
        area_of(footprints_of(flat_seabed(h), azimuth_fan(1.5 * degree, cells, 25 * degree, 20 * degree)));
    const double f = 1.5 * degree / cells,
                 straight = cells * std::sin(f) / 2 * h * h *
                            (std::pow(std::tan(20 * degree), -2) - std::pow(std::tan(25 * degree), -2));
    EXPECT_LT(relative(area, straight), 1e-6) << cells;
    errors.push_back(exact - area);
  }
  EXPECT_NEAR(errors[0], exact - 3.860736328, 1e-6);
  errors.pop_back();  // the last error is as small as the rounding of rays
  expect_second_order(errors, 0.05);
}

TEST(ClosedForms, FootprintOfACone) {
  const double h = 10, t = 30 * degree, al = 5 * degree;
  const glm::dvec3 axis(std::cos(t), 0, -std::sin(t)), side(0, 1, 0), up(std::sin(t), 0, std::cos(t));
  std::vector<double> errors;
  for (const int corners : {16, 32, 64, 128}) {  // a polygonal cone of as many rays, as a fan from its axis
    const auto ray = [&](int k) {
      const double turn = 2 * pi * k / corners;
      return axis + std::tan(al) * (std::cos(turn) * side + std::sin(turn) * up);
    };
    TubeSet set = empty_set();
    for (int k = 0; k < corners; k += 2) add_tube(set, {axis, ray(k), ray(k + 1), ray(k + 2)});
    errors.push_back(19.919423919 - area_of(footprints_of(flat_seabed(h), set)));
    EXPECT_GT(errors.back(), 0);
  }
  expect_second_order(errors, 0.1);
}

// ---- 7.2 Shadows and first returns

TEST(ClosedForms, ShadowOfAThinWall) {
  FacetMesh mesh = flat_seabed(5);
  add_quadrangle(mesh, {10, -3, -5}, {10, 3, -5}, {10, 3, -4}, {10, -3, -4});
  const FootprintSet set = footprints_of(mesh, azimuth_fan(8 * degree, 4, 60 * degree, 12 * degree));
  const FootprintSet seabed = facets_from(set, 0, 2), wall = facets_from(set, 2, 4);
  double before = 0, tip = 1e9, tip_range = 1e9;
  for (const Footprint& f : seabed.footprints)
    for (std::uint32_t p = f.first_piece; p < f.first_piece + f.piece_count; ++p) {
      const Piece& piece = seabed.pieces[p];
      const std::span corners = std::span(seabed.corners_m).subspan(piece.first, piece.count);
      const auto beyond =
          std::count_if(corners.begin(), corners.end(), [](glm::dvec3 c) { return c.x > 11; });
      EXPECT_TRUE(beyond == 0 || beyond == std::ptrdiff_t(piece.count))
          << "a piece on both sides of the shadow";
      for (const glm::dvec3& c : corners) {
        if (beyond)
          tip = std::min(tip, c.x);
        else
          before = std::max(before, c.x);
      }
      if (beyond) {
        PlanarPolygon polygon;
        const FacetPlane plane{f.plane_normal, f.plane_distance_m};
        polygon.assign(corners, plane, PlaneFrame(plane));
        tip_range = std::min(tip_range, nearest_point(polygon).range);
      }
    }
  EXPECT_NEAR(before, 10, 1e-7);
  EXPECT_NEAR(tip, 12.5, 1e-7);
  EXPECT_NEAR(tip_range, 13.462912018, 1e-7);
  EXPECT_NEAR(first_return(wall), 10.770329614, 1e-7);  // the top of the wall, where the shadow begins
  EXPECT_NEAR(tip_range - first_return(wall), 2.692582404, 1e-7);
  // h = H Ls / R_tip.
  EXPECT_NEAR(5 * (tip_range - first_return(wall)) / tip_range, 1, 1e-7);
  // The seabed has no area at ranges from the foot of the wall, at the sides of the fan, to the tip of the
  // shadow.
  const double foot_range = std::hypot(10 / std::cos(4 * degree), 5);
  const auto bins = range_bins(seabed, {1, foot_range + 1e-6, 13.462912018 - 1e-6, 30});
  EXPECT_GT(bins[0], 1);
  EXPECT_NEAR(bins[1], 0, 1e-9);
  EXPECT_GT(bins[2], 1);
}

/// Adds a sphere centred on `towards`, with one facet of the coarsest level and thus of each level.
void add_ball(FacetMesh& mesh, glm::dvec3 centre, double radius, int level, glm::dvec3 towards) {
  FacetMesh unit;
  add_sphere(unit, {0, 0, 0}, 0x1p29, level);
  const glm::dvec3 z = glm::normalize(towards), x = glm::normalize(glm::cross(z, glm::dvec3(0.3, 0.7, -0.2))),
                   y = glm::cross(z, x);
  // The facet of the octahedron in the first octant is centred on (1, 1, 1).
  const glm::dvec3 from_z = glm::normalize(glm::dvec3(1, 1, 1)),
                   from_x = glm::normalize(glm::dvec3(1, -1, 0)), from_y = glm::cross(from_z, from_x);
  const auto first = static_cast<VertexId>(mesh.vertices.size());
  for (const GridPoint& p : unit.vertices) {
    const glm::dvec3 d = glm::normalize(glm::dvec3(p.x, p.y, p.z));
    add_vertex(mesh, grid.snap(centre + radius * (glm::dot(d, from_x) * x + glm::dot(d, from_y) * y +
                                                  glm::dot(d, from_z) * z)));
  }
  for (const auto& v : unit.facets) add_facet(mesh, v[0] + first, v[1] + first, v[2] + first);
}

/// The area of the convex hull of points (Andrew's monotone chain).
double hull_area(std::vector<glm::dvec2> points) {
  std::sort(points.begin(), points.end(),
            [](glm::dvec2 a, glm::dvec2 b) { return a.x != b.x ? a.x < b.x : a.y < b.y; });
  double area = 0;
  for (int half = 0; half < 2; ++half) {
    std::vector<glm::dvec2> chain;
    for (const glm::dvec2& p : points) {
      const auto turns_left = [&](glm::dvec2 a, glm::dvec2 b) {
        return (b.x - a.x) * (p.y - a.y) - (b.y - a.y) * (p.x - a.x) > 0;
      };
      while (chain.size() > 1 && !turns_left(chain[chain.size() - 2], chain.back())) chain.pop_back();
      chain.push_back(p);
    }
    for (std::size_t k = 1; k < chain.size(); ++k)
      area += (chain[k - 1].x * chain[k].y - chain[k].x * chain[k - 1].y) / 2;
    std::reverse(points.begin(), points.end());
  }
  return area;
}

TEST(ClosedForms, SphereOnTheFloor) {
  const glm::dvec3 centre(10, 0, -4);
  const double shadow = 14.497793613, range = 9.770329614;
  const TubeSet tubes = azimuth_fan(30 * degree, 3, 60 * degree, 13 * degree);
  const double bare = area_of(footprints_of(flat_seabed(5), tubes));
  std::vector<double> area_errors, range_errors;
  for (const int level : {3, 4, 5, 6}) {
    SCOPED_TRACE(testing::Message() << "level " << level);
    FacetMesh mesh = flat_seabed(5);
    add_ball(mesh, centre, 1, level, -centre);
    const FootprintSet set = footprints_of(mesh, tubes);
    const FootprintSet seabed = facets_from(set, 0, 2),
                       ball = facets_from(set, 2, static_cast<FacetId>(mesh.facets.size()));
    area_errors.push_back(shadow - (bare - area_of(seabed)));
    range_errors.push_back(first_return(ball) - range);
    EXPECT_GT(area_errors.back(), 0) << "an inscribed ball has the smaller shadow";
    // The sphere of facets is convex: its shadow is the hull of the shadows of its vertices.
    std::vector<glm::dvec2> shadows;
    for (std::size_t v = 6; v < mesh.vertices.size(); ++v) {
      const glm::dvec3 p = grid.to_metres(mesh.vertices[v]);
      shadows.push_back(glm::dvec2(p.x, p.y) * (-5 / p.z));
    }
    EXPECT_NEAR(bare - area_of(seabed), hull_area(shadows), 1e-6);
    // The ends of the shadow on the floor, straight ahead.
    const FootprintSet ahead = footprints_of(mesh, azimuth_fan(1e-3 * degree, 1, 60 * degree, 13 * degree));
    double near = 0, far = 1e9;
    for (const Footprint& f : facets_from(ahead, 0, 2).footprints)
      for (std::uint32_t p = f.first_piece; p < f.first_piece + f.piece_count; ++p)
        for (std::uint32_t k = 0; k < ahead.pieces[p].count; ++k) {
          const double x = ahead.corners_m[ahead.pieces[p].first + k].x;
          (x < 13 ? near : far) = x < 13 ? std::max(near, x) : std::min(far, x);
        }
    // The sphere is inscribed, by at most 1 - cos of half the angle of an edge. The far end of the shadow
    // moves most.
    const double sagitta = 1 - std::cos(pi / 4 / (1 << level) * 1.3);
    EXPECT_GT(near, 9.758731568 - 1e-7);
    EXPECT_LT(near, 9.758731568 + 5 * sagitta);
    EXPECT_LT(far, 16.907935098 + 1e-7);
    EXPECT_GT(far, 16.907935098 - 12 * sagitta);
  }
  expect_second_order(range_errors, 0.2);
  expect_second_order({range_errors[2], range_errors[3]}, 0.02);
  // The outline crosses facets differently at each level, so that the order holds only overall.
  EXPECT_NEAR(std::log2(area_errors.front() / area_errors.back()) / 3, 2, 0.2);
  EXPECT_LT(area_errors.back() / shadow, 3e-4);
}

// ---- 7.3 Solid angles

TEST(ClosedForms, SolidAnglesOfTriangles) {
  const struct {
    const char* what;
    glm::dvec3 a, b, c;
    double solid_angle;
  } cases[] = {{"octant", {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, pi / 2},
               {"half a side of a cube", {1, -1, -1}, {1, 1, -1}, {1, 1, 1}, pi / 3},
               {"small one far away", {0, 0, 10}, {1, 0, 10}, {0, 1, 10}, 0.004975144902}};
  for (const auto& c : cases) {
    SCOPED_TRACE(c.what);
    FacetMesh mesh;
    add_triangle(mesh, c.a, c.b, c.c);
    const glm::dvec3 axis = glm::normalize(c.a) + glm::normalize(c.b) + glm::normalize(c.c);
    const FootprintSet one = footprints_of(mesh, pyramid(axis, 3, 3));
    ASSERT_EQ(one.footprints.size(), 1u);
    EXPECT_NEAR(solid_angle_of(one), c.solid_angle, 1e-12);
    // Four tubes share the walls of the pyramid: through its four corners and its axis.
    const TubeSet whole = pyramid(axis, 3, 3);
    TubeSet quarters = empty_set();
    const auto ray = [&](int k) {
      const GridPoint r = whole.rays[k % 4];
      return glm::dvec3(r.x, r.y, r.z);
    };
    const glm::dvec3 n = glm::normalize(axis);
    for (int k = 0; k < 4; ++k) add_tube(quarters, {n, ray(k) + ray(k + 3), ray(k), ray(k) + ray(k + 1)});
    // Walls between them differ by rounded rays only at the outside, where there is no triangle.
    EXPECT_NEAR(solid_angle_of(footprints_of(mesh, quarters)), c.solid_angle, 2e-9);
  }
}

TEST(ClosedForms, SolidAnglesOfRectanglePyramidSectorBeamAndSphere) {
  FacetMesh rectangle;
  add_quadrangle(rectangle, {3, -1, -2}, {3, 1, -2}, {3, 1, 2}, {3, -1, 2});
  EXPECT_NEAR(solid_angle_of(footprints_of(rectangle, pyramid({1, 0, 0}, 1, 1))), 0.705295355263, 1e-12);

  FacetMesh wall;
  add_quadrangle(wall, {10, -25, -25}, {10, 25, -25}, {10, 25, 25}, {10, -25, 25});
  const double a = std::tan(14.5 * degree), b = std::tan(7 * degree);
  EXPECT_LT(relative(solid_angle_of(footprints_of(wall, pyramid({1, 0, 0}, a, b))), 0.122073535208), 1e-8);

  // Tubes have straight walls between corner rays: the angular sector is their limit.
  std::vector<double> errors;
  for (const int cells : {4, 8, 16})
    errors.push_back(0.123367235381 - solid_angle_of(footprints_of(
                                          wall, azimuth_fan(29 * degree, cells, 7 * degree, -7 * degree))));
  expect_second_order(errors, 0.05);
  EXPECT_LT(
      relative(solid_angle_of(footprints_of(wall, azimuth_fan(0.3 * degree, 8, 7 * degree, -7 * degree))),
               .00127621278),
      1e-7);

  std::vector<double> ball_errors;
  for (const int level : {2, 3, 4}) {
    FacetMesh ball;
    add_ball(ball, {10, 0, 0}, 1, level, {-1, 0.2, 0.3});
    ball_errors.push_back(0.031494861523 - solid_angle_of(footprints_of(ball, pyramid({1, 0, 0}, 0.2, 0.2))));
  }
  expect_second_order(ball_errors, 0.6);
}

TEST(ClosedForms, SolidAnglesAreConservedUnderSplitting) {
  std::size_t compared = 0;
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    Random random(seed);
    for (const Scene& scene : all_scenes(seed)) {
      SCOPED_TRACE(testing::Message() << "seed " << seed << ", " << scene.name);
      // Rays on a lattice, so that the walls of small tubes coincide exactly with the walls of the large
      // tube.
      const int n = 6;
      TubeSet fine = lattice_tubes(scene.tubes.apex, -n / 2, -n / 2, n, n, uniform(random, 2, 8)),
              whole = fine;
      const auto corner = [&](int i, int j) { return static_cast<std::uint32_t>(j * (n + 1) + i); };
      whole.tubes = {{corner(0, 0), corner(0, n), corner(n, n), corner(n, 0)}};
      const auto by_facet = [&](const TubeSet& tubes, std::uint32_t facets_per_split) {
        std::vector<double> sum(scene.mesh.facets.size() + 1, 0.0);
        for (const Footprint& f : footprints_of(scene.mesh, tubes, facets_per_split).footprints) {
          sum[f.facet] += f.solid_angle_sr;
          sum.back() += f.solid_angle_sr;
        }
        return sum;
      };
      const auto one = by_facet(whole, 1000000), cut_up = by_facet(whole, 4), many = by_facet(fine, 64);
      const double y = fine.rays[0].y, x = n / 2.0,
                   sector = 4 * std::atan(x * x / (y * std::sqrt(y * y + 2 * x * x)));
      EXPECT_LE(one.back(), sector * (1 + 1e-12));
      for (std::size_t f = 0; f < one.size(); ++f) {
        // Relative to the sum, of which a facet is a part.
        EXPECT_NEAR(cut_up[f], one[f], 1e-12 * one.back()) << "facet " << f;
        EXPECT_NEAR(many[f], one[f], 1e-12 * one.back()) << "facet " << f;
        compared += one[f] > 0;
      }
      if (scene.name == std::string("inside the spheres")) {
        EXPECT_LT(relative(one.back(), sector), 1e-12);
      }
    }
  }
  EXPECT_GT(compared, 1000u);
}

// ---- 7.4 Range bins of a flat seabed

TEST(ClosedForms, RangeBinsOfAFlatSeabed) {
  const double h = 10, f = 1.5 * degree;
  const FootprintSet slice = footprints_of(flat_seabed(h), fan_from_nadir(f, 2.5));
  EXPECT_LT(relative(range_bins(slice, {20, 20.05})[0], 0.026212663703), 1e-7);
  EXPECT_LT(relative(range_bins(slice, {9.98, 10.03})[0], 0.007865762606), 1e-7);
  EXPECT_NEAR(first_return(slice), h, 1e-7);

  std::vector<double> borders;
  for (int k = 0; k <= 800; ++k) borders.push_back(10 + 0.0125 * k);
  const std::vector<double> rings = range_bins(slice, borders);
  for (std::size_t k = 0; k < rings.size(); ++k)
    ASSERT_LT(relative(rings[k], f * (borders[k] + borders[k + 1]) / 2 * 0.0125), 1e-6) << k;

  // Without the nadir in the fan: H / sin of the steepest ray.
  EXPECT_NEAR(
      first_return(footprints_of(flat_seabed(h), azimuth_fan(0.001 * degree, 1, 50 * degree, 20 * degree))),
      h / std::sin(50 * degree), 1e-7);
}

// ---- 7.6 Polygons and circles

TEST(ClosedForms, CirclesAndPolygonsOfFacets) {
  using Corners = std::vector<glm::dvec2>;
  const Corners unit{{0, 0}, {1, 0}, {1, 1}, {0, 1}}, square{{-1, -1}, {1, -1}, {1, 1}, {-1, 1}};
  const Corners triangle{{0, 0}, {4, 0}, {0, 3}};
  const struct {
    const char* what;
    Corners polygon;
    glm::dvec2 centre;
    double radius, area, whole;
  } cases[] = {{"unit square, circle at its corner", unit, {0, 0}, 1, pi / 4, 1},
               {"square, circle cuts all edges", square, {0, 0}, 1.2, 3.803644523140, 4},
               {"square, circle at a corner", square, {1, 1}, 1, pi / 4, 4},
               {"square, circle at an edge's middle", square, {1, 0}, 1, pi / 2, 4},
               {"3-4-5 triangle, incircle", triangle, {1, 1}, 1, pi, 6},
               {"3-4-5 triangle, circle at the right angle", triangle, {0, 0}, 2, pi, 6},
               {"3-4-5 triangle, circumcircle", triangle, {2, 1.5}, 2.5, 6, 6}};
  for (const auto& c : cases)
    for (const double distance : {0.5, 3.0}) {
      SCOPED_TRACE(testing::Message() << c.what << ", plane at " << distance);
      FacetMesh mesh;
      const auto corner = [&](std::size_t k) {
        const glm::dvec2 p = c.polygon[k] - c.centre;
        return glm::dvec3(p.x, p.y, -distance);
      };
      for (std::size_t k = 2; k < c.polygon.size(); ++k)
        add_triangle(mesh, corner(0), corner(k - 1), corner(k));
      // One tube over the whole scene, and 36 tubes whose walls cut polygon and circle.
      const TubeSet fine = [&] {
        TubeSet set = lattice_tubes({0, 0, 0}, -3, -3, 6, 6, 1);
        for (GridPoint& r : set.rays) r = {7 * r.x, 7 * r.z + 1, -6 * r.y};
        return set;
      }();
      TubeSet whole = fine;
      whole.tubes = {{0, 42, 48, 6}};
      for (const TubeSet& tubes : {whole, fine}) {
        const FootprintSet set = footprints_of(mesh, tubes);
        const double rim = std::hypot(c.radius, distance);
        const auto areas = range_bins(set, {0, rim, 100});
        if (distance > 1) {
          EXPECT_NEAR(areas[0], c.area, 1e-11);
          EXPECT_NEAR(areas[0] + areas[1], c.whole, 1e-11);
          EXPECT_NEAR(area_of(set), c.whole, 1e-11);
        } else {  // the outer walls of the tubes cut off parts of the larger polygons
          EXPECT_LE(areas[0] + areas[1], c.whole * (1 + 1e-12));
          EXPECT_NEAR(areas[0] + areas[1], area_of(set), 1e-12);
        }
      }
    }
}

}  // namespace
}  // namespace tubefoot
