// SPDX-License-Identifier: GPL-3.0-or-later
// Compares areas and solid angles of footprints in doubles with enclosures in ball arithmetic from the
// exact integers of their corners.
#include <flint/fmpz.h>
#include <gtest/gtest.h>

#include <boost/multiprecision/cpp_int.hpp>
#include <cmath>
#include <string>

#include "fixtures/geometry/grid_scenes.hpp"
#include "fixtures/geometry/looks.hpp"
#include "geometry/arithmetic/wide_direction.hpp"
#include "geometry/footprints/footprint_builder.hpp"
#include "geometry/integrals/measure.hpp"
#include "geometry/numbers/ball.hpp"

namespace tubefoot {
namespace {

using Integer = boost::multiprecision::cpp_int;
using Vector = std::array<Integer, 3>;

Ball ball(const Integer& x) {
  fmpz_t integer;
  fmpz_init(integer);
  fmpz_set_str(integer, x.str().c_str(), 10);
  Ball result;
  arb_set_round_fmpz(result.get(), integer, ball_bits);
  fmpz_clear(integer);
  return result;
}

Integer dot(const Vector& a, const Vector& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
Vector cross(const Vector& a, const Vector& b) {
  return {Integer(a[1] * b[2] - a[2] * b[1]), Integer(a[2] * b[0] - a[0] * b[2]),
          Integer(a[0] * b[1] - a[1] * b[0])};
}
Vector vector_of(GridPoint p) { return {Integer(p.x), Integer(p.y), Integer(p.z)}; }
Vector vector_of(const WideVec& v) { return {Integer(v[0].str()), Integer(v[1].str()), Integer(v[2].str())}; }

/// Van Oosterom and Strackee, with the exact triple product.
Ball solid_angle(const std::vector<Vector>& d) {
  Ball sum;
  const auto length = [](const Vector& v) { return root(ball(dot(v, v))); };
  for (std::size_t k = 2; k < d.size(); ++k) {
    const Vector &a = d[0], &b = d[k - 1], &c = d[k];
    const Ball la = length(a), lb = length(b), lc = length(c);
    const Ball below = la * lb * lc + ball(dot(a, b)) * lc + ball(dot(b, c)) * la + ball(dot(c, a)) * lb;
    sum += Ball(2) * atan2(ball(dot(a, cross(b, c))), below);
  }
  return sum;
}

/// Area of the polygon in which the directions meet n . x = offset, times the square of the grid unit.
Ball area(const std::vector<Vector>& d, const Vector& n, const Integer& offset) {
  // p_k = d_k offset / (n . d_k); the triple products of the fan with n are exact rationals.
  Ball sum;
  for (std::size_t k = 0; k < d.size(); ++k) {
    const Vector &a = d[k], &b = d[(k + 1) % d.size()];
    sum += ball(Integer(dot(n, cross(a, b)))) / (ball(dot(n, a)) * ball(dot(n, b)));
  }
  return sum * squared(ball(offset)) / (Ball(2) * root(ball(dot(n, n))));
}

// Law M4.
TEST(CertifiedMeasures, AreasAndSolidAnglesOfFootprintsAreThoseOfTheirExactCorners) {
  constexpr double unit = 0x1p-10;
  std::size_t compared = 0;
  for (const test::Scene& scene : test::adversarial_cases(20267)) {
    SCOPED_TRACE(scene.name);
    const SceneTree tree(scene.mesh);
    VisibilityScratch scratch;
    TubeVisibility seen;
    for (std::uint32_t tube = 0; tube < scene.tubes.tubes.size(); ++tube) {
      see(scene.mesh, tree, scene.tubes, tube, test::with(Arithmetic::fixed), scratch, seen);
      FootprintSet set;
      append_footprints(scene.mesh, scene.tubes, tube, seen, unit, set);
      measure(set);
      const NameContext context{scene.mesh, scene.tubes.apex, seen.rays};
      for (const Footprint& footprint : set.footprints) {
        const auto& vertices = scene.mesh.facets[footprint.facet];
        const Vector v0 = vector_of(scene.mesh.vertices[vertices[0]] - scene.tubes.apex);
        const Vector side1 = vector_of(scene.mesh.vertices[vertices[1]] - scene.mesh.vertices[vertices[0]]),
                     side2 = vector_of(scene.mesh.vertices[vertices[2]] - scene.mesh.vertices[vertices[0]]);
        Vector n = cross(side1, side2);
        Integer offset = dot(n, v0);
        if (offset < 0) {
          offset = -offset;
          for (Integer& x : n) x = -x;
        }
        Ball omega, square;
        for (const NamedPiece& piece : seen.pieces) {
          if (piece.facet != footprint.facet) continue;
          std::vector<Vector> directions;
          for (std::uint32_t k = 0; k < piece.count; ++k)
            directions.push_back(vector_of(wide_direction(context, seen.corners[piece.first + k])));
          omega += solid_angle(directions);
          square += area(directions, n, offset);
        }
        square = square * Ball(unit * unit);
        // Corners are rounded: the uncertainty of an area is a border of the rounding of the distance.
        const double far = footprint.slant_range_max_m, near = footprint.slant_range_min_m;
        const double border = 4e-15 * far * far;
        EXPECT_TRUE(square.surely_positive());
        EXPECT_LE((square - Ball(footprint.area_m2)).hi(), 1e-12 * footprint.area_m2 + border);
        EXPECT_GE((square - Ball(footprint.area_m2)).lo(), -1e-12 * footprint.area_m2 - border);
        const double cone = 4e-15 * far * far / (near * near);
        EXPECT_LE((omega - Ball(footprint.solid_angle_sr)).hi(), 1e-12 * footprint.solid_angle_sr + cone);
        EXPECT_GE((omega - Ball(footprint.solid_angle_sr)).lo(), -1e-12 * footprint.solid_angle_sr - cone);
        // The enclosures are no wider than necessary.
        EXPECT_LT((square - square.centre()).hi(), 1e-20 * far * far);
        EXPECT_LT((omega - omega.centre()).hi(), 1e-20);
        ++compared;
      }
    }
  }
  EXPECT_GT(compared, 200u);
}

}  // namespace
}  // namespace tubefoot
