// SPDX-License-Identifier: GPL-3.0-or-later
// Tests certified references in stratified water for scattering models other than Lambert's law and for
// textured seabeds. The comparisons are closed forms of rings in one gradient with independent scattering
// formulas, single rays, and straight references in isovelocity water.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <boost/math/quadrature/gauss_kronrod.hpp>
#include <cmath>
#include <glm/geometric.hpp>
#include <random>

#include "fixtures/world/gradient_seabed.hpp"
#include "fixtures/world/textures.hpp"
#include "geometry/numbers/scalars.hpp"

namespace tubefoot {
namespace {

using test::GradientSeabed;
using test::seabed_fan;
using test::seabed_gradient;
using test::SeabedRay;
using test::Triangle;

constexpr std::array<double, 5> table_deg{10, 24, 37, 52, 80}, table_db{-38, -30, -27, -22, -12};

/// A scattering model, and its published formula as a function of the angle of incidence.
struct Law {
  const char* name;
  ScatteringModel model;
  double (*value)(double phi);
};
const std::vector<Law>& models() {
  static const std::vector<Law> all{
      {"three terms", ScatteringModel::gsab({0.4, 9 * degree, 0.01, 1.7, 0.03, 22 * degree}),
       [](double phi) {
         const auto lobe = [&](double b) { return std::exp(-phi * phi / (2 * b * b)); };
         return 0.4 * lobe(9 * degree) + 0.01 * std::pow(std::cos(phi), 1.7) + 0.03 * lobe(22 * degree);
       }},
      {"table", ScatteringModel::table(table_deg, table_db),
       [](double phi) {
         const double grazing = 90 - phi / degree;
         if (grazing < table_deg[0])
           return std::pow(10, table_db[0] / 10) *
                  std::pow(std::cos(phi) / std::sin(table_deg[0] * degree), 2);
         if (grazing > table_deg.back()) return std::pow(10, table_db.back() / 10);
         std::size_t k = 0;
         while (grazing > table_deg[k + 1]) ++k;
         const double part = (grazing - table_deg[k]) / (table_deg[k + 1] - table_deg[k]);
         return std::pow(10, (table_db[k] + part * (table_db[k + 1] - table_db[k])) / 10);
       }},
      {"without any fall", ScatteringModel::gsab({.oblique = 0.002, .oblique_exponent = 0}),
       [](double) { return 0.002; }},
      {"steep", ScatteringModel::gsab({.oblique = 0.3, .oblique_exponent = 8}),
       [](double phi) { return 0.3 * std::pow(std::cos(phi), 8); }}};
  return all;
}
std::shared_ptr<const ScatteringModel> shared(const ScatteringModel& model) {
  return std::make_shared<const ScatteringModel>(model);
}

double ring_energy(const Law& model, double g, double t1, double t2, double absorption) {
  return boost::math::quadrature::gauss_kronrod<double, 31>::integrate(
      [&](double t) {
        const SeabedRay ray(g, t, absorption);
        return model.value(std::acos(std::min(ray.sine, 1.0))) * ray.density;
      },
      t1, t2, 8, 1e-9);
}

// The bounds are also tight: a fifth of a bound fails somewhere, and all bounds fail when energies move by
// twice the bound.
TEST(RefractedSeabed, HoldsTheClosedFormOfEveryLaw) {
  constexpr std::uint64_t seed = 31;
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> unit(0, 1);
  for (const Law& model : models()) {
    double closest = 0;
    for (int trial = 0; trial < 3; ++trial) {
      const double g = (trial % 2 ? 1 : -1) * std::pow(10, -1.2 * unit(random)),
                   absorption = trial % 3 ? 0.2 * unit(random) : 0;
      const RangeSamples samples{21, 0.4 + 0.6 * unit(random), 40};
      const double gap = std::pow(10, -2 - unit(random)), width_deg = 1 + 3 * unit(random);
      SCOPED_TRACE(fmt::format("{} seed {} trial {}: g {} absorption {} gap {}", model.name, seed, trial, g,
                               absorption, gap));
      GradientSeabed seabed;
      seabed.models = {shared(model.model), nullptr};
      const RefractedReference found =
          seabed.certified(seabed_gradient(g, absorption), seabed_fan(width_deg, 89.5),
                           {.travel_path_error_m = gap}, samples, absorption, 1e-2);
      EXPECT_EQ(found.unbounded, 0u);
      for (int k = 0; k < samples.count; ++k) {
        const double from = samples.first_m + k * samples.step_m;
        const double truth = width_deg * degree *
                             ring_energy(model, g, from / 1500, (from + samples.step_m) / 1500, absorption);
        const double energy = found.certified.echo.energy[k], bound = found.certified.bound[k];
        // The rays of the tubes are rounded to 2^-30.
        EXPECT_LE(std::abs(energy - truth), bound + 3e-8 * truth) << k;
        EXPECT_GT(std::abs(energy + 2 * bound - truth), bound - 3e-8 * truth) << k;
        closest = std::max(closest, std::abs(energy - truth) / bound);
      }
    }
    EXPECT_GT(closest, 0.05) << model.name;
  }
}

TEST(RefractedSeabed, BoundsOfLawsShrinkWithTheGap) {
  const RangeSamples samples{21, 1, 40};
  for (const Law& model : models()) {
    SCOPED_TRACE(model.name);
    GradientSeabed seabed;
    seabed.models = {shared(model.model), nullptr};
    double before = 1;
    for (const double gap : {1e-2, 1e-3, 1e-4}) {
      const RefractedReference found = seabed.certified(seabed_gradient(-0.2), seabed_fan(2, 89.5),
                                                        {.travel_path_error_m = gap}, samples, 0, 1e-3);
      double bounds = 0, energies = 0;
      for (std::size_t k = 0; k < found.certified.bound.size(); ++k) {
        bounds += found.certified.bound[k] / found.certified.echo.energy[k];
        energies += 1;
      }
      EXPECT_LT(bounds / energies, before / 2) << gap;
      before = bounds / energies;
    }
    EXPECT_LT(before, 3e-3);
  }
}

TEST(RefractedSeabed, IsovelocityWaterIsTheStraightReference) {
  const WaterColumn even{SoundSpeedProfile({{0, 1500}, {50, 1500}}), {}};
  const TubeSet tubes = seabed_fan(4, 89.5);
  const RangeSamples samples{21, 2, 12};
  std::vector<GradientSeabed> seabeds(models().size() + 3, GradientSeabed({}, 64, 16));
  for (std::size_t k = 0; k < models().size(); ++k) seabeds[k].models = {shared(models()[k].model), nullptr};
  const std::size_t textured = models().size();
  seabeds[textured].textures = {test::perlin(6, 1, 0.5), nullptr};
  seabeds[textured + 1].textures = {test::map_askew(), nullptr};
  seabeds[textured + 2].models = {shared(models()[1].model), nullptr};
  seabeds[textured + 2].textures = {test::perlin(3, 2, 0.5, 9), nullptr};
  for (std::size_t b = 0; b < seabeds.size(); ++b) {
    SCOPED_TRACE(b);
    const RefractedReference found =
        seabeds[b].certified(even, tubes, {.travel_path_error_m = 1}, samples, 0, 1e-6);
    const CertifiedEcho straight = seabeds[b].straight(tubes, samples, 1e-7);
    for (std::size_t k = 0; k < straight.bound.size(); ++k) {
      EXPECT_LE(std::abs(found.certified.echo.energy[k] - straight.echo.energy[k]),
                found.certified.bound[k] + straight.bound[k])
          << k;
      // The bound covers corners that are displaced by two grid units, for a range bin of 2 m. At edges of
      // some facets the scattering models fall by a factor of a hundred.
      EXPECT_LE(found.certified.bound[k], 0.03 * straight.echo.energy[k]) << k;
    }
  }
}

/// Integrates with Gauss's rule of three points in cells of time and azimuth.
double textured_energy(const ReflectivityField& texture, double g, double t1, double t2, double half_width) {
  const std::array<double, 3> node{-std::sqrt(0.6), 0, std::sqrt(0.6)}, weight{5. / 18, 8. / 18, 5. / 18};
  constexpr int n = 40;
  double sum = 0;
  for (int i = 0; i < 3 * n; ++i) {
    const SeabedRay ray(g, t1 + (t2 - t1) * (i / 3 + (1 + node[std::size_t(i % 3)]) / 2) / n, 0);
    double around = 0;
    for (int k = 0; k < 3 * n; ++k) {
      const double a = half_width * (2 * (k / 3 + (1 + node[std::size_t(k % 3)]) / 2) / n - 1);
      around +=
          weight[std::size_t(k % 3)] *
          texture.factor({ray.across_m * std::cos(a), ray.across_m * std::sin(a), -GradientSeabed::below_m});
    }
    sum += weight[std::size_t(i % 3)] * GradientSeabed::mu * ray.sine * ray.sine * ray.density * around;
  }
  return sum * (t2 - t1) * 2 * half_width / (n * n);
}

// The texture is evaluated at the true position of the seabed, which is up to metres from the apparent
// position.
TEST(RefractedSeabed, HoldsMicroTextureWhereTheSeabedLies) {
  const RangeSamples samples{24, 0.7, 16};
  for (const double g : {-1.0, 0.4}) {
    for (int kind = 0; kind < 3; ++kind) {
      SCOPED_TRACE(fmt::format("g {} kind {}", g, kind));
      const test::Field texture =
          kind == 0   ? test::perlin(1.5, 1, 0.8, 3)
          : kind == 1 ? test::perlin(4, 2, 0.5, 4)
                      : test::random_map(40, 30, 4, {{-2, -8}, {0.9, 0.2}, {-0.1, 0.7}, true});
      double before = 1, closest = 0;
      for (const double gap : {4e-3, 4e-4}) {
        GradientSeabed seabed;
        seabed.textures = {texture, nullptr};
        const CertifiedEcho found =
            seabed
                .certified(seabed_gradient(g), seabed_fan(6), {.travel_path_error_m = gap}, samples, 0, 1e-2)
                .certified;
        double bounds = 0, energies = 0;
        for (int k = 0; k < samples.count; ++k) {
          const double from = samples.first_m + k * samples.step_m;
          const double truth =
              textured_energy(*texture, g, from / 1500, (from + samples.step_m) / 1500, 3 * degree);
          const double error = std::abs(found.echo.energy[k] - truth), bound = found.bound[k];
          EXPECT_LE(error, bound + 2e-5 * truth) << k;
          closest = std::max(closest, error / bound);
          bounds += bound;
          energies += found.echo.energy[k];
        }
        EXPECT_LT(bounds / energies, before / 3);
        before = bounds / energies;
      }
      EXPECT_LT(before, 0.05);
    }
  }
}

// Positions are uncertain. The bound includes a texture whose wavelength is as small as this uncertainty.
TEST(RefractedSeabed, WhatIsFinerThanPlacesAreKnownIsInTheBound) {
  const RangeSamples samples{25, 6, 1};
  GradientSeabed even, fine, coarse;
  fine.textures = {test::perlin(0.2, 1, 0.5, 5), nullptr};
  coarse.textures = {test::perlin(20, 1, 0.5, 5), nullptr};
  double before = 2;
  for (const double gap : {1e-2, 1e-3}) {
    const auto bound = [&](const GradientSeabed& seabed) {
      const CertifiedEcho found =
          seabed.certified(seabed_gradient(-1), seabed_fan(1), {.travel_path_error_m = gap}, samples, 0, 1e-2)
              .certified;
      return found.bound[0] / found.echo.energy[0];
    };
    // Positions are known to about the travel-path error. The noise changes by up to about 3 per
    // wavelength.
    const double of_even = bound(even), of_fine = bound(fine), of_coarse = bound(coarse);
    EXPECT_GT(of_fine, of_even + 0.5 * gap / 0.2);
    EXPECT_LT(of_fine, of_even + 50 * gap / 0.2);
    EXPECT_NEAR(of_coarse - of_even, (of_fine - of_even) / 100, (of_fine - of_even) / 50 + 0.2 * of_even);
    EXPECT_LT(of_fine, before);
    before = of_fine / 4;
  }
}

// Compares each enclosure of a facet with single eigenrays to points on the facet.
TEST(RefractedSeabed, EnclosuresHoldWhatRaysToPlacesOnFacetsSay) {
  constexpr std::uint64_t seed = 12;
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> unit(0, 1);
  double closest_factor = 0, closest_place = 0;
  std::size_t proven = 0;
  for (int trial = 0; trial < 60; ++trial) {
    const Law& model = models()[std::size_t(trial) % models().size()];
    SCOPED_TRACE(fmt::format("{} seed {} trial {}", model.name, seed, trial));
    // Some facets are nearly perpendicular to the ray.
    const glm::dvec3 at(2 + 50 * unit(random) * unit(random), 10 * unit(random) - 5, -4 - 12 * unit(random));
    const double size = trial % 3 ? 3 : 0.5;
    Triangle t;
    for (glm::dvec3& p : t) {
      const glm::dvec3 way = size * glm::dvec3(unit(random) - 0.5, unit(random) - 0.5, unit(random) - 0.5);
      p = at + way -
          (trial % 5 == 0 ? 0.95 * glm::dot(way, glm::normalize(at)) * glm::normalize(at) : glm::dvec3(0));
    }
    GradientSeabed site({t});
    site.models = {nullptr, shared(model.model)};
    const double absorption = 0.1;
    const WaterColumn one = seabed_gradient(trial % 2 ? 0.7 : -0.7, absorption);
    const WaterColumn layers{SoundSpeedProfile({{0, 1530}, {11, 1515}, {13, 1495}, {30, 1490}}),
                             {0.1, 0.12, 0.09, 0.08, 0.1}};
    const WaterColumn& water = trial % 8 < 4 ? one : layers;
    const EigenrayOptions options{.deepest_turn_m = 30};
    const ApparentMap apparent_map(water, glm::dvec3(0), GradientSeabed::apex_depth_m, options);
    std::vector<FacetId> facets{FacetId(site.base.facets.size() - 1)};
    const ApparentSurface surface_mesh =
        map_apparent(site.base, facets, site.grid, apparent_map, absorption, {.travel_path_error_m = 1e9});
    const RayEnclosure rays(apparent_map, options);
    const SceneTree tree(surface_mesh.refined.mesh);
    const ApparentEnclosures all =
        enclose({surface_mesh, tree, site.base, surface_mesh.refined.parent, site.grid}, rays,
                site.model(surface_mesh.refined.mesh, absorption));
    const std::vector<FacetMap> maps = surface_mesh.facet_maps(glm::dvec3(0), site.grid);
    for (std::size_t f = 0; f < all.facets.size(); ++f) {
      const FacetEnclosure& facet = all.facets[f];
      if (facet.state != FacetEnclosure::State::proven) continue;
      ++proven;
      ASSERT_TRUE(facet.model);
      Triangle lies;
      for (int k = 0; k < 3; ++k) lies[k] = surface_mesh.truth[surface_mesh.refined.mesh.facets[f][k]];
      const glm::dvec3 normal = glm::normalize(glm::cross(lies[1] - lies[0], lies[2] - lies[0]));
      for (int k = 0; k < 60; ++k) {
        double a = unit(random), b = unit(random);
        if (a + b > 1) a = 1 - a, b = 1 - b;
        const glm::dvec3 place = lies[0] + a * (lies[1] - lies[0]) + b * (lies[2] - lies[0]);
        const auto image = apparent_map.apparent(place);
        ASSERT_TRUE(image);
        const glm::dvec3 direction = glm::normalize(image->at_m);
        const double sine = glm::dot(direction, facet.normal), straight = facet.plane_m / sine;
        const double off = glm::distance(maps[f].at(direction * straight), place);
        EXPECT_LE(off, facet.place_off_m);
        closest_place = std::max(closest_place, off / facet.place_off_m);
        const double beta = std::numbers::ln10 / 5;
        const double lies_sine =
            std::abs(glm::dot(normal, apparent_map.arrival_direction(place, image->ray)));
        const double per_sr = model.value(std::acos(std::min(lies_sine, 1.0))) / lies_sine /
                              apparent_map.return_area_m2_per_sr(place, image->ray) *
                              std::exp(-beta * image->ray.absorption_db);
        const double factor =
            per_sr / (facet.model->cross_section(sine, std::sqrt((1 - sine) * (1 + sine))) / sine /
                      (straight * straight) * std::exp(-beta * absorption * straight));
        EXPECT_GE(factor, facet.factor.lo * (1 - 1e-9));
        EXPECT_LE(factor, facet.factor.hi * (1 + 1e-9));
        closest_factor =
            std::max(closest_factor, std::abs(factor - facet.factor.middle()) / (facet.factor.width() / 2));
        EXPECT_LE(per_sr, facet.most_per_sr);
      }
    }
  }
  EXPECT_GT(proven, 30u);
  EXPECT_GT(closest_factor, 0.3);
  EXPECT_GT(closest_place, 0.3);
}

TEST(RefractedSeabed, WhatCannotBeEnclosedIsRefused) {
  struct Ones final : ReflectivityField {
    double factor(glm::dvec3) const override { return 1; }
    double largest() const override { return 1; }
    double finest_m() const override { return 1; }
    std::span<const CellPlanes> cells() const override { return {}; }
    double change(double) const override { return 0; }
  };
  GradientSeabed seabed;
  seabed.textures = {std::make_shared<const Ones>(), nullptr};
  EXPECT_THROW(seabed.certified(seabed_gradient(0.4), seabed_fan(2), {.travel_path_error_m = 0.1}, {24, 1, 4},
                                0, 1e-2),
               std::invalid_argument);
}

}  // namespace
}  // namespace tubefoot
