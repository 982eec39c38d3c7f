// SPDX-License-Identifier: GPL-3.0-or-later
// Tests the bounds of references in stratified water. One gradient has closed forms for rings of a flat
// seabed. The energies of the rings must lie within the bounds, and not far inside. Apparent facets are
// coarse and range bins narrow here, so that a bound of a tenth would fail.
#include "engine/certified/certified_refraction.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <boost/math/quadrature/gauss_kronrod.hpp>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <numbers>
#include <random>

#include "fixtures/world/gradient_seabed.hpp"
#include "geometry/numbers/scalars.hpp"

namespace tubefoot {
namespace {

using test::GradientSeabed;
using test::seabed_fan;
using test::seabed_gradient;
using test::Triangle;

const double gradient_mu = GradientSeabed::mu;

/// Returns the energy of the ring between two one-way travel times, per radian of azimuth.
double ring_energy(double g, double t1, double t2, double absorption) {
  return boost::math::quadrature::gauss_kronrod<double, 31>::integrate(
      [&](double t) {
        const test::SeabedRay ray(g, t, absorption);
        return gradient_mu * ray.sine * ray.sine * ray.density;
      },
      t1, t2, 5, 1e-13);
}

TEST(CertifiedRefraction, HoldsTheClosedFormOfOneGradientAndNotFarInside) {
  constexpr std::uint64_t seed = 88;
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> unit(0, 1);
  double closest = 0;
  for (int trial = 0; trial < 16; ++trial) {
    const double g = (trial % 2 ? 1 : -1) * std::pow(10, -1.5 * unit(random)),
                 absorption = trial % 3 ? 0.2 * unit(random) : 0;
    const RangeSamples samples{26, 0.1 + 0.5 * unit(random), 80};
    const double gap = std::pow(10, -1.5 - 2 * unit(random)), width_deg = 2 + 8 * unit(random);
    SCOPED_TRACE(fmt::format("seed {} trial {}: g {} absorption {} gap {}", seed, trial, g, absorption, gap));
    const RefractedReference found =
        GradientSeabed().certified(seabed_gradient(g, absorption), seabed_fan(width_deg),
                                   {.travel_path_error_m = gap}, samples, absorption, 1e-2);
    EXPECT_EQ(found.unbounded, 0u);
    for (int k = 0; k < samples.count; ++k) {
      const double from = samples.first_m + k * samples.step_m;
      const double truth =
          width_deg * degree * ring_energy(g, from / 1500, (from + samples.step_m) / 1500, absorption);
      const double error = std::abs(found.certified.echo.energy[k] - truth), bound = found.certified.bound[k];
      // The rays of the tubes are rounded to 2^-30.
      EXPECT_LE(error, bound + 3e-8 * truth) << k;
      closest = std::max(closest, error / bound);
    }
  }
  EXPECT_GT(closest, 0.2);
}

TEST(CertifiedRefraction, BoundsShrinkWithTheGapToAnyTolerance) {
  const RangeSamples samples{26, 1, 30};
  double before = 1;
  for (const double gap : {1e-2, 1e-3, 1e-4}) {
    const RefractedReference found = GradientSeabed().certified(
        seabed_gradient(-0.2), seabed_fan(2), {.travel_path_error_m = gap}, samples, 0, 1e-3);
    double worst = 0;
    for (std::size_t k = 0; k < found.certified.bound.size(); ++k)
      worst = std::max(worst, found.certified.bound[k] / found.certified.echo.energy[k]);
    EXPECT_LT(worst, before / 2) << gap;
    EXPECT_NEAR(found.certified.worst_ratio, worst / 1e-3, 0.2 * worst / 1e-3);
    before = worst;
  }
  EXPECT_LT(before, 2e-3);
}

TEST(CertifiedRefraction, IsovelocityWaterIsTheStraightReference) {
  const GradientSeabed site;
  const TubeSet tubes = seabed_fan(10);
  const RangeSamples samples{26, 2, 20};
  const WaterColumn even{SoundSpeedProfile({{0, 1500}, {50, 1500}}), {}};
  const RefractedReference found = site.certified(even, tubes, {.travel_path_error_m = 1}, samples, 0, 1e-6);
  const CertifiedEcho straight = site.straight(tubes, samples, 1e-9);
  for (std::size_t k = 0; k < straight.bound.size(); ++k) {
    EXPECT_LE(std::abs(found.certified.echo.energy[k] - straight.echo.energy[k]),
              found.certified.bound[k] + straight.bound[k]);
    // The bound covers corners that are displaced by two grid units, for a range bin of 2 m.
    EXPECT_LE(found.certified.bound[k], 2e-4 * straight.echo.energy[k]) << k;
  }
}

// Objects in the water hide facets and are hidden. The bounds of a coarse map must contain the energies of
// a fine map.
TEST(CertifiedRefraction, HoldsFinerSurfacesBehindObjects) {
  constexpr std::uint64_t seed = 4;
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> unit(0, 1);
  const RangeSamples samples{18, 0.4, 130};
  for (int trial = 0; trial < 3; ++trial) {
    SCOPED_TRACE(fmt::format("seed {} trial {}", seed, trial));
    std::vector<Triangle> more;
    for (int k = 0; k < 3; ++k) {
      const glm::dvec3 at(20 + 25 * unit(random), 6 * unit(random) - 3, -19 + 8 * unit(random) * (k % 2));
      Triangle t;
      for (glm::dvec3& p : t)
        p = at + 4.0 * glm::dvec3(unit(random) - 0.5, unit(random) - 0.5, unit(random) - 0.5);
      more.push_back(t);
    }
    const GradientSeabed site(more);
    const double g = trial % 2 ? 0.5 : -0.8;
    const auto run = [&](double gap) {
      return site
          .certified(seabed_gradient(g), seabed_fan(8), {.travel_path_error_m = gap, .shortest_edge_m = 0.01},
                     samples, 0, 1e-2)
          .certified;
    };
    const CertifiedEcho fine = run(2e-4), coarse = run(3e-2);
    double fine_sum = 0, coarse_sum = 0;
    for (std::size_t k = 0; k < fine.bound.size(); ++k) {
      ASSERT_TRUE(std::isfinite(fine.bound[k]));
      EXPECT_LE(std::abs(fine.echo.energy[k] - coarse.echo.energy[k]),
                coarse.bound[k] + fine.bound[k] + 1e-30)
          << k;
      fine_sum += fine.bound[k];
      coarse_sum += coarse.bound[k];
    }
    EXPECT_LT(fine_sum, 0.2 * coarse_sum);
  }
}

// A long straight edge has a curved apparent position. It hides parts of the facets behind it over many
// range bins.
TEST(CertifiedRefraction, HoldsShadowsOfLongEdges) {
  const GradientSeabed site({{{{25, -6, -12}, {25, 6, -12}, {25.5, 0, -20}}}}, 64, 2);
  const RangeSamples samples{43, 0.003, 1500};
  const auto run = [&](double gap) {
    return site
        .certified(seabed_gradient(-1), seabed_fan(6), {.travel_path_error_m = gap, .shortest_edge_m = 0.01},
                   samples, 0, 1e-2)
        .certified;
  };
  const CertifiedEcho fine = run(1e-4), coarse = run(1);
  for (std::size_t k = 0; k < fine.bound.size(); ++k)
    EXPECT_LE(std::abs(fine.echo.energy[k] - coarse.echo.energy[k]), coarse.bound[k] + fine.bound[k] + 1e-30)
        << k;
}

/// Compares each enclosure of the last facet of a seabed with single eigenrays to points on the facet.
struct EnclosuresAgainstRays {
  double closest_gap = 0, closest_factor = 0;
  std::size_t unproven = 0;

  void add(const GradientSeabed& site, const WaterColumn& water, double absorption, std::mt19937_64& random) {
    std::uniform_real_distribution<double> unit(0, 1);
    const EigenrayOptions options{.deepest_turn_m = 30};
    const ApparentMap apparent_map(water, glm::dvec3(0), GradientSeabed::apex_depth_m, options);
    std::vector<FacetId> facets{FacetId(site.base.facets.size() - 1)};
    const ApparentSurface surface_mesh =
        map_apparent(site.base, facets, site.grid, apparent_map, absorption, {.travel_path_error_m = 1e9});
    const RayEnclosure rays(apparent_map, options);
    const SceneTree tree(surface_mesh.refined.mesh);
    const EchoModel model = site.model(surface_mesh.refined.mesh, absorption);
    const ApparentEnclosures all =
        enclose({surface_mesh, tree, site.base, surface_mesh.refined.parent, site.grid}, rays, model);
    unproven += all.unproven.size();
    for (std::size_t f = 0; f < all.facets.size(); ++f) {
      const FacetEnclosure& facet = all.facets[f];
      if (facet.state != FacetEnclosure::State::proven) continue;
      Triangle lies;
      for (int k = 0; k < 3; ++k) lies[k] = surface_mesh.truth[surface_mesh.refined.mesh.facets[f][k]];
      const glm::dvec3 normal = glm::normalize(glm::cross(lies[1] - lies[0], lies[2] - lies[0]));
      for (int k = 0; k < 40; ++k) {
        double a = unit(random), b = unit(random);
        if (a + b > 1) a = 1 - a, b = 1 - b;
        const glm::dvec3 place = lies[0] + a * (lies[1] - lies[0]) + b * (lies[2] - lies[0]);
        const auto image = apparent_map.apparent(place);
        ASSERT_TRUE(image);
        ASSERT_EQ(image->eigenrays, 1);
        const glm::dvec3 flat =
            facet.seen[0] + a * (facet.seen[1] - facet.seen[0]) + b * (facet.seen[2] - facet.seen[0]);
        const double gap = glm::distance(image->at_m, flat);
        EXPECT_LE(gap, facet.travel_path_error_m);
        closest_gap = std::max(closest_gap, gap / facet.travel_path_error_m);
        // Distance along the ray to the plane of the apparent facet.
        const glm::dvec3 direction = glm::normalize(image->at_m);
        const double range = glm::length(image->at_m), sine = glm::dot(direction, facet.normal),
                     straight = facet.plane_m / sine;
        EXPECT_LE(std::abs(range - straight), facet.shift_m);
        EXPECT_GE(range, facet.nearest_m);
        EXPECT_LE(range, facet.farthest_m);
        const double beta = std::numbers::ln10 / 5;
        const double lies_sine =
            std::abs(glm::dot(normal, apparent_map.arrival_direction(place, image->ray)));
        const double per_sr = lies_sine / apparent_map.return_area_m2_per_sr(place, image->ray) *
                              std::exp(-beta * image->ray.absorption_db);
        const double factor =
            per_sr / (sine / (straight * straight) * std::exp(-beta * absorption * straight));
        EXPECT_GE(factor, facet.factor.lo);
        EXPECT_LE(factor, facet.factor.hi);
        closest_factor =
            std::max(closest_factor, std::abs(factor - facet.factor.middle()) / (facet.factor.width() / 2));
        EXPECT_LE(3 * gradient_mu * per_sr, facet.most_per_sr);
      }
    }
  }
};

TEST(CertifiedRefraction, EnclosuresHoldWhatRaysToPlacesOnFacetsSay) {
  constexpr std::uint64_t seed = 12;
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> unit(0, 1);
  EnclosuresAgainstRays compared;
  for (int trial = 0; trial < 40; ++trial) {
    SCOPED_TRACE(fmt::format("seed {} trial {}", seed, trial));
    std::vector<Triangle> more;
    const glm::dvec3 at(15 + 40 * unit(random), 10 * unit(random) - 5, -4 - 12 * unit(random));
    Triangle t;
    for (glm::dvec3& p : t)
      p = at + 3.0 * glm::dvec3(unit(random) - 0.5, unit(random) - 0.5, unit(random) - 0.5);
    more.push_back(t);
    const double absorption = 0.1;
    const WaterColumn one = seabed_gradient(trial % 2 ? 0.7 : -0.7, absorption);
    const WaterColumn layers{SoundSpeedProfile({{0, 1530}, {11, 1515}, {13, 1495}, {30, 1490}}),
                             {0.1, 0.12, 0.09, 0.08, 0.1}};
    compared.add(GradientSeabed(more), trial % 4 < 2 ? one : layers, absorption, random);
  }
  EXPECT_GT(compared.closest_gap, 0.3);
  EXPECT_GT(compared.closest_factor, 0.3);
}

// Rays to such a facet rise and fall. They turn just before they return to the depth of the sonar.
TEST(CertifiedRefraction, FacetsAtTheSonarsDepthAreProven) {
  constexpr std::uint64_t seed = 31;
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> unit(0, 1);
  const auto water_of = [](std::vector<ProfilePoint> points) {
    const std::vector<double> absorption(points.size() + 1, 0.1);
    return WaterColumn{SoundSpeedProfile(std::move(points)), absorption};
  };
  const std::vector<WaterColumn> waters{
      seabed_gradient(-0.01, 0.1), seabed_gradient(0.01, 0.1), seabed_gradient(-0.5, 0.1),
      // The sonar lies in the gradient between two others, and in isovelocity water above a gradient.
      water_of({{0, 1530}, {5, 1520}, {15, 1500}, {30, 1490}}),
      water_of({{0, 1490}, {6, 1490}, {14, 1500}, {30, 1502}}),
      water_of({{0, 1500}, {15, 1500}, {30, 1480}})};
  for (std::size_t k = 0; k < waters.size(); ++k) {
    EnclosuresAgainstRays compared;
    for (int trial = 0; trial < 6; ++trial) {
      SCOPED_TRACE(fmt::format("seed {} water {} trial {}", seed, k, trial));
      const double half = 0.5 + 2 * unit(random), turn = unit(random) - 0.5;
      const Triangle ahead{{{13, -half, -half}, {13 + turn, half, -half}, {13, 0.2, half}}};
      compared.add(GradientSeabed({ahead}), waters[k], 0.1, random);
    }
    EXPECT_EQ(compared.unproven, 0u) << "water " << k;
    if (k + 1 < waters.size()) {  // in isovelocity water the apparent facet equals the facet
      EXPECT_GT(compared.closest_gap, 0.1) << "water " << k;
    }
  }
}

TEST(CertifiedRefraction, WhereNoRayIsProvenNothingIsClaimed) {
  const RangeSamples samples{26, 1, 70};
  // Rays bend upwards: the last ray that reaches the seabed is horizontal there.
  const double g = 6, cr = 1500 + 20 * g;
  const double last_m = 1500 * std::atanh(std::sqrt((cr - 1500) * (cr + 1500)) / cr) / g;
  const RefractedReference found =
      GradientSeabed().certified(seabed_gradient(g), seabed_fan(4),
                                 {.travel_path_error_m = 1e-2, .shortest_edge_m = 0.1}, samples, 0, 1e-2);
  EXPECT_GT(found.unbounded, 0u);
  std::size_t infinite = 0;
  for (int k = 0; k < samples.count; ++k) {
    const double from = samples.first_m + k, bound = found.certified.bound[k];
    infinite += std::isinf(bound);
    if (from > last_m) {
      EXPECT_TRUE(std::isinf(bound)) << k;
    }
    if (!std::isfinite(bound)) continue;
    const double truth = 4 * degree * ring_energy(g, from / 1500, (from + 1) / 1500, 0);
    EXPECT_LE(std::abs(found.certified.echo.energy[k] - truth), bound + 3e-8 * truth) << k;
  }
  EXPECT_EQ(infinite, found.unbounded);
  EXPECT_LT(infinite, std::size_t(samples.count));
}

// A caller that refines by the result of a reference must see the bins without a bound.
TEST(CertifiedRefraction, BinsWithoutABoundAreOverTheTolerance) {
  constexpr double infinite = std::numeric_limits<double>::infinity();
  const CertifiedEcho echo{Echo{1, 4, {1, 1, 1, 1}}, {1e-4, infinite, infinite, 0.1}};
  const RefractedReference found = reference_of(echo, 1e-3);
  EXPECT_EQ(found.bins, 4u);
  EXPECT_EQ(found.bins_over, 3u);
  EXPECT_EQ(found.unbounded, 2u);
  EXPECT_NEAR(found.usual_excess, 0.1 / (0.9 * 1e-3), 1e-3);
  // The worst ratio is that of the finite bounds.
  EXPECT_NEAR(found.certified.worst_ratio, 0.1 / (0.9 * 1e-3), 1e-3);
  EXPECT_EQ(found.certified.worst_sample, 3);

  const RefractedReference none = reference_of({Echo{1, 2, {1, 1}}, {infinite, infinite}}, 1e-3);
  EXPECT_EQ(none.bins_over, 2u);
  EXPECT_EQ(none.usual_excess, 0);
  EXPECT_EQ(none.certified.worst_ratio, 0);
}

}  // namespace
}  // namespace tubefoot
