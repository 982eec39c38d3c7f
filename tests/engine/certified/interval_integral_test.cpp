// SPDX-License-Identifier: GPL-3.0-or-later
// Tests the certified monostatic integral in intervals of doubles. It compares each integral with the same
// integral in ball arithmetic of 128 bits.
#include "engine/certified/interval_integral.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <map>
#include <memory>
#include <numbers>
#include <random>

#include "fixtures/geometry/metre_meshes.hpp"
#include "geometry/numbers/scalars.hpp"
#include "geometry/search/scene_tree.hpp"

namespace tubefoot {
namespace {

/// Facets before an apex and the tubes that see them. Walls of tubes, silhouettes and intersections of
/// facets cut the visible polygons.
struct Seen {
  Seen(const std::vector<std::array<glm::dvec3, 3>>& facets_m,
       const std::vector<std::array<glm::dvec3, 4>>& pyramids)
      : mesh(test::mesh_of(facets_m, grid)), tree(std::make_unique<SceneTree>(mesh)) {
    set.apex = grid.snap(glm::dvec3(0));
    set.reach = 200 / grid.unit_m();
    for (const auto& corners : pyramids) test::add_pyramid(set, corners);
  }

  /// Calls take(polygon in balls, polygon in intervals) for each visible polygon.
  template <class Take>
  void each_piece(const Take& take) const {
    VisibilityScratch scratch;
    TubeVisibility seen;
    IntervalPolygon fast;
    for (std::uint32_t tube = 0; tube < set.tubes.size(); ++tube) {
      see(mesh, *tree, set, tube, VisibilityOptions{}, scratch, seen);
      const NameContext context{mesh, set.apex, seen.rays};
      for (const NamedPiece& piece : seen.pieces) {
        if (!enclose_in_intervals(context, seen.corners, piece, grid.unit_m(), fast)) continue;
        take(certified_polygon(context, seen.corners, piece, grid.unit_m()), fast);
      }
    }
  }

  WorldGrid grid{20, glm::dvec3(0)};
  FacetMesh mesh;
  std::unique_ptr<SceneTree> tree;
  TubeSet set;
};

/// A seabed about the foot point, and facets of many sizes above the seabed that intersect each other.
Seen scattered_facets(unsigned seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> side(-1, 1), decades(-2.5, 0.3);
  const auto somewhere = [&] { return glm::dvec3(side(random), side(random), side(random)); };
  const glm::dvec3 a(60, 4, 5), b(-3, 70, -6), centre(3, 2, -9);
  std::vector<std::array<glm::dvec3, 3>> facets{{centre - a - b, centre + a - b, centre + a + b},
                                                {centre - a - b, centre + a + b, centre - a + b}};
  for (int k = 0; k < 60; ++k) {
    const glm::dvec3 place = glm::dvec3(0, 0, -6) + glm::dvec3(4, 4, 2.5) * somewhere();
    const double size = std::pow(10, decades(random));
    facets.push_back({place + size * somewhere(), place + size * somewhere(), place + size * somewhere()});
  }
  std::vector<std::array<glm::dvec3, 4>> pyramids;
  for (int k = -3; k < 4; ++k) {
    const double x = 0.3 * k, w = k % 2 == 0 ? 0.3 : 0.02;
    pyramids.push_back({glm::dvec3(x, -0.8, -1), {x + w, -0.8, -1}, {x + w, 0.9, -1}, {x, 0.9, -1}});
  }
  return Seen(facets, pyramids);
}

std::vector<double> borders_of(double from, double step, int count) {
  std::vector<double> borders;
  for (int k = 0; k <= count; ++k) borders.push_back(from + k * step);
  return borders;
}

std::vector<std::shared_ptr<const ScatteringModel>> models() {
  const auto shared = [](ScatteringModel model) {
    return std::make_shared<const ScatteringModel>(std::move(model));
  };
  return {nullptr, shared(ScatteringModel::lambert(0.02)),
          shared(ScatteringModel::gsab({0.4, 4 * degree, 0.01, 1.7, 0.03, 22 * degree})),
          shared(ScatteringModel::table(std::vector<double>{10, 30, 55, 80},
                                        std::vector<double>{-38, -30, -22, -12}))};
}

/// Balls by range bin.
std::map<std::uint32_t, Ball> in_balls(const CertifiedPolygon& polygon, const ScatteringModel* model,
                                       const std::vector<double>& borders, const Ball& beta) {
  CertifiedIntegrator integrator(borders, beta);
  integrator.take_model(model);
  std::map<std::uint32_t, Ball> sums;
  integrator.add(polygon, 0, {1e-17, [](std::uint32_t, std::uint32_t) { return 1e-40; }},
                 [&](const Part<Ball>& part) { sums[part.sample] += part.value; });
  return sums;
}

bool holds(const Interval& interval, const Ball& ball) {
  return interval.lo <= ball.lo() && ball.hi() <= interval.hi;
}
bool meets(const Interval& interval, const Ball& ball) {
  return interval.lo <= ball.hi() && ball.lo() <= interval.hi;
}

TEST(IntervalIntegral, HoldsWhatBallsSayOfEveryPieceAndLaw) {
  int compared = 0, sharp = 0, left_to_balls = 0;
  for (const unsigned seed : {11u, 12u}) {
    const Seen scene = scattered_facets(seed);
    // Uses short range bins, and long ones that need quadrature rules of many nodes.
    const std::vector<double> borders = seed == 11 ? borders_of(3, 0.37, 30) : borders_of(3, 4, 3);
    for (const auto& model : models())
      for (const double absorption : {0.0, 0.2}) {
        const Ball beta = Ball(absorption) * log(Ball(10)) / Ball(10);
        IntervalIntegrator integrator(borders, {beta.lo(), beta.hi()});
        integrator.take_model(model.get());
        std::vector<IntervalIntegrator::SamplePart> parts;
        int number = 0;
        scene.each_piece([&](const CertifiedPolygon& sure, const IntervalPolygon& fast) {
          SCOPED_TRACE(testing::Message()
                       << "seed " << seed << ", piece " << number++ << ", absorption " << absorption);
          const double relative = std::array{0.2, 1e-4, 1e-8}[std::size_t(number % 3)];
          if (!integrator.enclose(fast, 0, {relative, [](auto, auto) { return 1e-16; }}, parts)) {
            ++left_to_balls;
            return;
          }
          std::map<std::uint32_t, Interval> found;
          for (const auto& part : parts) found[part.sample] += part.value;
          const auto truth = in_balls(sure, model.get(), borders, beta);
          for (const auto& [sample, ball] : truth) {
            const Interval& own = found[sample];
            EXPECT_TRUE(meets(own, ball)) << own.lo << ' ' << own.hi << " not about " << ball.middle();
            EXPECT_LE(own.width(), 2.6 * relative * own.hi + 1e-14);
            ++compared;
            // The interval contains a ball of almost zero radius. It does not contain a ball at a distance
            // of one width.
            if (!(ball.hi() - ball.lo() <= 1e-6 * own.width())) continue;
            EXPECT_TRUE(holds(own, ball)) << own.lo << ' ' << own.hi << " do not hold " << ball.middle();
            EXPECT_FALSE(meets({own.lo + 1.01 * own.width(), own.hi + 1.01 * own.width()}, ball));
            ++sharp;
          }
          for (const auto& [sample, own] : found)
            EXPECT_TRUE(truth.contains(sample) || own.lo <= 0) << sample;
        });
      }
  }
  EXPECT_GT(compared, 3000);
  EXPECT_GT(sharp, compared / 2);
  EXPECT_LT(left_to_balls, compared / 20);
}

TEST(IntervalIntegral, RingsAboutTheFootAreClosedForms) {
  // The foot point lies inside a facet, where circles are whole, and on the edge between two facets. The
  // tube is a square of half side 8 m.
  using Facets = std::vector<std::array<glm::dvec3, 3>>;
  const Facets one{{glm::dvec3(-90, -80, -8), {95, -70, -8}, {3, 120, -8}}},
      two{{glm::dvec3(0, -100, -8), {100, 0, -8}, {0, 100, -8}},
          {glm::dvec3(0, -100, -8), {0, 100, -8}, {-100, 0, -8}}};
  const std::vector<double> borders = borders_of(7.75, 0.25, 16);
  for (const Facets& facets : {one, two}) {
    const Seen scene(facets, {{glm::dvec3(-1, -1, -1), {1, -1, -1}, {1, 1, -1}, {-1, 1, -1}}});
    std::vector<Interval> total(16);
    IntervalIntegrator integrator(borders, Interval(0));
    std::vector<IntervalIntegrator::SamplePart> parts;
    scene.each_piece([&](const CertifiedPolygon&, const IntervalPolygon& fast) {
      ASSERT_TRUE(integrator.enclose(fast, 0, {1e-7, [](auto, auto) { return 1e-12; }}, parts));
      for (const auto& part : parts) total[part.sample] += part.value;
    });
    for (std::size_t k = 1; borders[k + 1] < 8 * std::sqrt(2); ++k) {
      // integral of 2 pi r^-5 dr, times mu and the squared distance
      const double truth = std::numbers::pi / 2 * (std::pow(borders[k], -4) - std::pow(borders[k + 1], -4));
      EXPECT_LE(total[k].lo, truth * (1 + 1e-13)) << k;
      EXPECT_GE(total[k].hi, truth * (1 - 1e-13)) << k;
      EXPECT_LE(total[k].width(), 3e-7 * truth) << k;
    }
  }
}

TEST(IntervalIntegral, LeavesToBallsWhatDoublesDoNotTell) {
  const Seen scene = scattered_facets(13);
  const std::vector<double> borders = borders_of(3, 0.5, 20);
  IntervalIntegrator integrator(borders, Interval(0));
  std::vector<IntervalIntegrator::SamplePart> parts;
  int told = 0;
  scene.each_piece([&](const CertifiedPolygon&, const IntervalPolygon& fast) {
    told += integrator.enclose(fast, 0, {1e-19, [](auto, auto) { return 1e-300; }}, parts) && !parts.empty();
  });
  EXPECT_EQ(told, 0);
}

}  // namespace
}  // namespace tubefoot
