// SPDX-License-Identifier: GPL-3.0-or-later
// Tests proven steps without a change of combinatorics: against known changes, and against the visible
// polygons at steps inside of the bounds.
#include "engine/gradient/validity.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <tuple>

#include "engine/gradient/visibility_certificate.hpp"
#include "fixtures/world/differentiated_scenes.hpp"

namespace tubefoot {
namespace {

using test::gradient_unit_m;
using test::GradientScene;
using test::grid_point;
using test::grid_units;

/// The borders of each facet's visible part by names, without the borders between its polygons. For each
/// corner on each plane: how many border edges end there minus how many begin there.
using Combinatorics =
    std::map<std::tuple<std::uint32_t, FacetId, std::array<std::uint32_t, 3>, std::array<std::uint32_t, 7>>,
             int>;

std::array<std::uint32_t, 3> plane_words(const PlaneName& plane) {
  return {std::min(plane.a, plane.b), std::max(plane.a, plane.b), plane.depth};
}
std::array<std::uint32_t, 7> corner_words(const CornerName& corner) {
  auto p = plane_words(corner.p), q = plane_words(corner.q);
  if (q < p) std::swap(p, q);
  return {corner.point, p[0], p[1], p[2], q[0], q[1], q[2]};
}
/// Returns a plane through both corners.
std::array<std::uint32_t, 3> edge_words(const CornerName& a, const CornerName& b) {
  const auto on = [](const CornerName& c, const PlaneName& plane) {
    if (c.point != no_point) return plane.contains(c.point);
    return plane_words(c.p) == plane_words(plane) || plane_words(c.q) == plane_words(plane);
  };
  for (const CornerName* c : {&a, &b})
    if (c->point == no_point)
      for (const PlaneName& plane : {c->p, c->q})
        if (on(a, plane) && on(b, plane)) return plane_words(plane);
  return plane_words({a.point, b.point, false});
}

Combinatorics combinatorics_of(const GradientScene& scene) {
  const FootprintSet set = scene.history().footprints;
  // Rays of names are numbered over all tubes, in the same order for the same combinatorics.
  Combinatorics all;
  for (const Footprint& footprint : set.footprints)
    for (std::uint32_t p = 0; p < footprint.piece_count; ++p) {
      const Piece& piece = set.pieces[footprint.first_piece + p];
      for (std::uint32_t c = 0; c < piece.count; ++c) {
        const CornerName &a = set.corner_names[piece.first + c],
                         &b = set.corner_names[piece.first + (c + 1) % piece.count];
        const auto plane = edge_words(a, b);
        --all[{footprint.tube, footprint.facet, plane, corner_words(a)}];
        ++all[{footprint.tube, footprint.facet, plane, corner_words(b)}];
      }
    }
  std::erase_if(all, [](const auto& entry) { return entry.second == 0; });
  return all;
}

/// A bound is below the known step, and not much.
void expect_step(double found, double known) {
  EXPECT_LE(found, known * (1 + 1e-12));
  EXPECT_GE(found, 0.97 * known);
}

TEST(ValidSteps, OfTheWallReachTheKnownChanges) {
  const GradientScene scene = test::wall_before_seabed();
  const auto slope = [&](std::size_t ray) {
    const GridPoint r = scene.tubes.rays[scene.tubes.tubes[0][ray]];
    return -double(r.z) / r.x;
  };
  double steep = 0, flat = 1e9;
  for (std::size_t k = 0; k < 4; ++k) {
    steep = std::max(steep, slope(k));
    flat = std::min(flat, slope(k));
  }
  const std::vector<EchoParameter> parameters{
      {[](PointId id, glm::dvec3) { return glm::dvec3(0, 0, id == 6 || id == 7); }},
      EchoParameter::object_translation(scene.mesh, 1, {1, 0, 0}),
      EchoParameter::sonar_translation({0, 0, 1}),
      EchoParameter::object_translation(scene.mesh, 1, {0, 0, 1}),
      EchoParameter::sonar_rotation({0, 1, 0}),
      EchoParameter::material_mu(0, 1)};
  const std::vector<ValidSteps> found = scene.valid_steps_of(parameters, 100);
  // Height of the wall: the end of the shadow, 12 / (3 - h), reaches the end of the seabed at 20 m. With
  // height 0 the wall vanishes.
  expect_step(found[0].forward, 1.9);
  expect_step(found[0].backward, 0.5);
  // Distance of the wall: the shadow ends at 1.2 d. Towards the sonar, the foot of the wall leaves the tube.
  expect_step(found[1].forward, 20 / 1.2 - 4);
  expect_step(found[1].backward, 4 - 3 / steep);
  // Height of the sonar: the foot of the wall, or the end of the seabed, leaves the tube.
  expect_step(found[2].forward, 4 * steep - 3);
  expect_step(found[2].backward, 3 - 20 * flat);
  // A gap opens below the wall at once.
  EXPECT_TRUE(found[3].on_change);
  EXPECT_EQ(found[3].forward, 0);
  // Pitch: the tube loses the foot of the wall at one end, and gains the sky at the other.
  const double foot = std::atan(steep) - std::atan(3.0 / 4), sky = std::atan(3.0 / 20) - std::atan(flat);
  EXPECT_GT(found[4].forward, 0);
  EXPECT_GT(found[4].backward, 0);
  EXPECT_LE(std::max(found[4].forward, found[4].backward), std::max(foot, sky));
  EXPECT_LE(std::min(found[4].forward, found[4].backward), std::min(foot, sky));
  EXPECT_TRUE(std::isinf(found[5].forward) && std::isinf(found[5].backward));
  for (const std::size_t n : {0, 1, 2, 4, 5}) EXPECT_FALSE(found[n].on_change) << n;
}

/// Moves a scene by a number of grid units along the parameter.
using Move = std::function<void(GradientScene&, std::int32_t)>;

TEST(ValidSteps, KeepCombinatoricsWithinTheBound) {
  int changed = 0, compared = 0;
  for (const std::uint64_t seed : {11, 12, 13, 14, 15, 16}) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    const GradientScene scene = test::few_facets(seed, 0);
    const std::vector<EchoParameter> parameters{
        EchoParameter::sonar_translation({1, 0, 0}),
        EchoParameter::sonar_translation({0, 0, 1}),
        EchoParameter::object_translation(scene.mesh, 1, {0, 1, 0}),
        {[](PointId id, glm::dvec3) { return glm::dvec3(0, 0, id == 4); }}};
    const std::vector<Move> moves{[](GradientScene& s, std::int32_t by) { s.tubes.apex.x += by; },
                                  [](GradientScene& s, std::int32_t by) { s.tubes.apex.z += by; },
                                  [](GradientScene& s, std::int32_t by) {
                                    for (std::size_t v = 9; v < s.mesh.vertices.size(); ++v)
                                      s.mesh.vertices[v].y += by;
                                  },
                                  [](GradientScene& s, std::int32_t by) { s.mesh.vertices[4].z += by; }};
    const std::vector<ValidSteps> steps = scene.valid_steps_of(parameters, 1);
    const Combinatorics expected = combinatorics_of(scene);
    for (std::size_t n = 0; n < parameters.size(); ++n) {
      ASSERT_FALSE(steps[n].on_change) << n;
      for (const int sign : {1, -1}) {
        const double bound = sign > 0 ? steps[n].forward : steps[n].backward;
        EXPECT_GT(bound, 0) << n;
        const auto at = [&](double step) {
          GradientScene moved = scene;
          moves[n](moved, sign * std::int32_t(step / gradient_unit_m));
          return combinatorics_of(moved);
        };
        for (const double part : {0.1, 0.5, 0.9, 1.0})
          EXPECT_EQ(at(part * bound), expected) << n << " " << part;
        if (bound == 1) continue;
        ++compared;
        changed += at(1.04 * bound) != expected;
      }
    }
  }
  EXPECT_GT(compared, 30);
  // The other bounds end where only the division of a visible part into polygons changes.
  EXPECT_GE(changed, 0.8 * compared) << "of " << compared;
}

TEST(ValidSteps, OfARoughTerrainArePositive) {
  GradientScene scene;
  test::Random random(21);
  scene.mesh = test::rough_terrain(random, 12, grid_units(16), 0, grid_units(0.4));
  scene.tubes = test::forward_tubes(grid_point(0.01, 0.02, 3), 4, 1, 36, 50, 30);
  scene.samples = {2, 0.5, 14};
  std::vector<EchoParameter> parameters;
  for (const glm::dvec3 axis : {glm::dvec3(1, 0, 0), glm::dvec3(0, 1, 0), glm::dvec3(0, 0, 1)}) {
    parameters.push_back(EchoParameter::sonar_translation(axis));
    parameters.push_back(EchoParameter::sonar_rotation(axis));
  }
  for (const ValidSteps& steps : scene.valid_steps_of(parameters, 1)) {
    EXPECT_FALSE(steps.on_change);
    EXPECT_GT(std::min(steps.forward, steps.backward), 1e-6);
    EXPECT_LT(std::max(steps.forward, steps.backward), 0.5);
  }
}

// The two facets of each side of a box stay in one plane while the box turns.
TEST(ValidSteps, OfARotatingBoxArePositive) {
  GradientScene scene = test::wall_before_seabed();
  scene.mesh.vertices.resize(4);
  scene.mesh.facets.resize(2);
  scene.mesh.material.resize(2);
  scene.mesh.component.resize(2);
  test::add_box(scene.mesh, grid_point(4.03125, 0.0078125, 0.75), std::int32_t(0.25 / gradient_unit_m));
  for (std::size_t f = 2; f < scene.mesh.facets.size(); ++f) scene.mesh.component[f] = 1;
  const std::vector<EchoParameter> parameters{
      EchoParameter::object_rotation(scene.mesh, 1, {0.5, 0.25, 1}, {4, 0, -2.25}),
      EchoParameter::object_translation(scene.mesh, 1, {0.5, 0.25, 1}),
      EchoParameter::sonar_rotation({0.5, 0.25, 1})};
  for (const ValidSteps& steps : scene.valid_steps_of(parameters, 1)) {
    EXPECT_FALSE(steps.on_change);
    EXPECT_GT(steps.forward, 1e-4);
    EXPECT_GT(steps.backward, 1e-4);
  }
}

TEST(VisibilityCertificate, FailsForWrongPolygons) {
  for (const std::uint64_t seed : {31, 32, 33}) {
    GradientScene scene = test::few_facets(seed, 0);
    SceneTree tree(scene.mesh);
    VisibilityOptions options;
    options.open_water = true;
    VisibilityScratch scratch;
    TubeVisibility seen;
    see(scene.mesh, tree, scene.tubes, 0, options, scratch, seen);
    const NameContext context{scene.mesh, scene.tubes.apex, seen.rays};
    const EchoParameter rises = EchoParameter::sonar_translation({0, 0, 1});
    const SceneMotion motion(context, rises, gradient_unit_m);
    const auto holds = [&](const TubeVisibility& claimed) {
      return VisibilityCertificate(context, claimed, tree, scene.tubes.reach, motion, 1e9).holds(0, 0);
    };
    EXPECT_TRUE(holds(seen));
    ASSERT_GT(seen.pieces.size(), 3u);
    for (std::size_t k = 0; k < seen.pieces.size(); ++k) {
      TubeVisibility wrong = seen;
      wrong.pieces.erase(wrong.pieces.begin() + std::ptrdiff_t(k));
      EXPECT_FALSE(holds(wrong)) << "without polygon " << k;
      wrong = seen;
      wrong.pieces.push_back(seen.pieces[k]);
      EXPECT_FALSE(holds(wrong)) << "polygon " << k << " twice";
      for (FacetId facet = 0; facet < scene.mesh.facets.size(); ++facet) {
        if (facet == seen.pieces[k].facet) continue;
        wrong = seen;
        wrong.pieces[k].facet = facet;
        EXPECT_FALSE(holds(wrong)) << "polygon " << k << " on facet " << facet;
      }
    }
    std::size_t accepted = 0;
    for (std::size_t k = 0; k < seen.corners.size(); ++k) {
      TubeVisibility wrong = seen;
      if (wrong.corners[k].point == no_point)
        wrong.corners[k].sign *= -1;
      else
        wrong.corners[k].point ^= 1;
      accepted += holds(wrong);
    }
    // Only corners between merged polygons have no effect.
    EXPECT_LT(4 * accepted, seen.corners.size());
    // Another facet before all others.
    for (const GridPoint p : {GridPoint{grid_units(-2), grid_units(1.5), grid_units(1)},
                              GridPoint{grid_units(2), grid_units(1.5), grid_units(1)},
                              GridPoint{0, grid_units(1.5), grid_units(4)}})
      test::add_vertex(scene.mesh, p);
    const auto last = VertexId(scene.mesh.vertices.size() - 1);
    test::add_facet(scene.mesh, last - 2, last - 1, last);
    tree = SceneTree(scene.mesh);
    EXPECT_FALSE(holds(seen));
  }
}

TEST(ValidSteps, RejectInvalidInput) {
  const GradientScene scene = test::wall_before_seabed();
  const std::vector<EchoParameter> parameters{EchoParameter::sonar_translation({0, 0, 1})};
  EXPECT_THROW(scene.valid_steps_of(parameters, 0), std::invalid_argument);
  const SceneTree tree(scene.mesh);
  VisibilityOptions inexact;
  inexact.arithmetic = Arithmetic::plain_double;
  EXPECT_THROW(valid_steps(scene.mesh, tree, scene.tubes, gradient_unit_m, inexact, parameters,
                           std::vector<double>{1}),
               std::invalid_argument);
}

}  // namespace
}  // namespace tubefoot
