// SPDX-License-Identifier: GPL-3.0-or-later
// Tests the micro-texture of apparent facets. The engine evaluates the texture at the true positions of the
// seabed.
#include <gtest/gtest.h>

#include <boost/math/quadrature/gauss.hpp>
#include <cmath>
#include <numeric>
#include <random>

#include "engine/echo/echo.hpp"
#include "engine/surface/refracted_surface.hpp"
#include "engine/visibility/tube_engine.hpp"
#include "engine/water/apparent_map.hpp"
#include "fixtures/geometry/metre_meshes.hpp"
#include "fixtures/world/gradient_seabed.hpp"
#include "fixtures/world/textures.hpp"
#include "geometry/numbers/scalars.hpp"

namespace tubefoot {
namespace {

using test::Field;
using test::perlin;
using test::seabed_gradient;

constexpr double below_m = 20, texture_mu = 0.002;
const WorldGrid texture_grid{20, glm::dvec3(0)};

FacetMesh flat_seabed(double half_m, double cell_m) {
  MeshBuilder builder(texture_grid);
  test::add_flat_seabed(builder, half_m, cell_m, below_m);
  MeshReport report;
  return builder.finish(report);
}

ApparentSurface apparent(const FacetMesh& base, const WaterColumn& water, double travel_path_error_m) {
  std::vector<FacetId> all(base.facets.size());
  std::iota(all.begin(), all.end(), 0u);
  return map_apparent(base, all, texture_grid, ApparentMap(water, glm::dvec3(0), 10), 0,
                      {.travel_path_error_m = travel_path_error_m});
}

/// A fan of 6 degrees about x, with one beam per tube.
TubeSet narrow_fan() {
  TubeSet set;
  set.reach = 1e12;
  append_tubes(set, {{-3 * degree, 0, 3 * degree}, {-75 * degree, -40 * degree, -12 * degree}});
  return set;
}

const RangeSamples texture_range_samples{25, 2.5, 12};

/// Returns the energies of an apparent surface, or of a mesh as it is.
std::vector<double> hear(const FacetMesh& mesh, const ApparentSurface* surface_mesh, const Field& texture,
                         double tolerance = 1e-10, bool one_beam = true, Binning binning = Binning::exact) {
  const SceneTree tree(mesh);
  const std::vector<double> material_mu{texture_mu};
  const std::vector<Field> textures{texture};
  std::vector<FacetMap> maps;
  EchoModel model{material_mu, mesh.material, 0, nullptr, tolerance};
  if (texture) model.reflectivity = textures;
  if (surface_mesh != nullptr) {
    model.path.facet_factor = surface_mesh->facet_factor;
    maps = surface_mesh->facet_maps(glm::dvec3(0), texture_grid);
    model.path.tx.facet_map = maps;
  }
  const TubeSet tubes = narrow_fan();
  std::vector<std::uint32_t> beams(tubes.tubes.size(), 0);
  if (!one_beam) std::iota(beams.begin(), beams.end(), 0u);
  const History history = TubeEngine(mesh, tree, texture_grid.unit_m(), {}).trace(tubes, nullptr, true);
  return integrate_echo(history, {one_beam ? 1 : int(beams.size()), beams}, texture_range_samples, model,
                        binning)
      .energy;
}

/// A map with oblique pixels over the part of the seabed that the fan sees.
Field map_askew(std::uint64_t seed) {
  return test::random_map(9, 8, seed, {{-20, -20}, {6, 1}, {-0.7, 4}, true});
}

TEST(RefractedTexture, IsovelocityWaterIsTheStraightEngine) {
  const FacetMesh base = flat_seabed(64, 8);
  const WaterColumn water{SoundSpeedProfile({{0, 1480}, {50, 1480}}), {}};
  std::vector<FacetId> all(base.facets.size());
  std::iota(all.begin(), all.end(), 0u);
  const ApparentSurface surface_mesh = map_apparent(
      base, all, texture_grid, ApparentMap(water, glm::dvec3(0), 10), 0, {.travel_path_error_m = 1e-6});
  ASSERT_EQ(surface_mesh.refined.mesh.facets, base.facets);
  for (const std::uint64_t seed : {1, 2}) {
    SCOPED_TRACE(seed);
    for (const Field& texture : {perlin(1.3, 2, 0.8, seed), map_askew(seed)}) {
      const std::vector<double> straight = hear(base, nullptr, texture);
      const std::vector<double> refracted = hear(surface_mesh.refined.mesh, &surface_mesh, texture);
      for (std::size_t k = 0; k < straight.size(); ++k) {
        EXPECT_GT(straight[k], 0);
        EXPECT_NEAR(refracted[k] / straight[k], 1, 1e-12) << k;
      }
    }
  }
}

TEST(RefractedTexture, AConstantTextureIsNone) {
  const ApparentSurface surface_mesh = apparent(flat_seabed(128, 256), seabed_gradient(-0.5), 0.02);
  ASSERT_GT(surface_mesh.refined.mesh.facets.size(), 100u);
  const Field one = std::make_shared<PerlinReflectivity>(PerlinReflectivity::Settings{.depth = 0});
  const std::vector<double> even = hear(surface_mesh.refined.mesh, &surface_mesh, nullptr),
                            textured = hear(surface_mesh.refined.mesh, &surface_mesh, one);
  for (std::size_t k = 0; k < even.size(); ++k) EXPECT_NEAR(textured[k] / even[k], 1, 1e-9) << k;
}

/// Launch angle below the horizontal for the seabed point of a one-way time.
double launch_rad(double g, double t) {
  const double h = below_m, cs = 1500, cr = cs + g * h;
  const double x = std::sqrt(2 * cs * cr / (g * g) * (std::cosh(g * t) - 1) - h * h);
  return std::asin(h / std::hypot(x, h)) + std::atan(g * x / (cs + cr));
}

/// Energy per tube and range bin from the true seabed under one gradient. Travel time, tube area and angles
/// have closed forms (physics sheet 2.2), and the texture is taken at the true position. The rule has many
/// small panels over launch azimuth and time.
double closed_form(double g, double t1, double t2, double azimuth1, double azimuth2,
                   const ReflectivityField& texture) {
  const double h = below_m, cs = 1500, cr = cs + g * h;
  const auto at = [&](double t, double azimuth) {
    const double x = std::sqrt(2 * cs * cr / (g * g) * (std::cosh(g * t) - 1) - h * h);
    const double sinh_g = std::sinh(g * t) / g, area = cr * cr * sinh_g * sinh_g;
    const double chord = std::hypot(x, h), tilt = std::atan(g * x / (cs + cr));
    const double sine = std::sin(std::asin(h / chord) - tilt);
    return texture_mu * sine * sine * cr * cr / (cs * cs) / (area * area) * cs * cr * sinh_g *
           texture.factor({x * std::cos(azimuth), x * std::sin(azimuth), -h});
  };
  using Rule = boost::math::quadrature::gauss<double, 3>;
  const std::array<double, 3> node{-Rule::abscissa()[1], 0, Rule::abscissa()[1]},
      weight{Rule::weights()[1], Rule::weights()[0], Rule::weights()[1]};
  constexpr int n = 60;
  double sum = 0;
  for (int i = 0; i < 3 * n; ++i)
    for (int k = 0; k < 3 * n; ++k) {
      const double t = t1 + (t2 - t1) * (i / 3 + (1 + node[std::size_t(i % 3)]) / 2) / n;
      const double a = azimuth1 + (azimuth2 - azimuth1) * (k / 3 + (1 + node[std::size_t(k % 3)]) / 2) / n;
      sum += weight[std::size_t(i % 3)] * weight[std::size_t(k % 3)] * at(t, a);
    }
  return sum * (t2 - t1) * (azimuth2 - azimuth1) / (4 * n * n);
}

// The texture is not at apparent positions, which are up to metres away.
TEST(RefractedTexture, UnderOneGradientItLiesWhereTheSeabedIs) {
  const FacetMesh base = flat_seabed(128, 256);
  for (const double g : {-1.0, 0.4}) {
    const ApparentSurface surface_mesh = apparent(base, seabed_gradient(g), 1e-3);
    for (const std::uint64_t seed : {3, 4}) {
      SCOPED_TRACE(testing::Message() << "g " << g << " seed " << seed);
      const Field texture = perlin(1.5, 1, 0.8, seed);
      const std::vector<double> received =
          hear(surface_mesh.refined.mesh, &surface_mesh, texture, 1e-7, false);
      std::size_t compared = 0;
      for (int k = 0; k < texture_range_samples.count; ++k) {
        const double r1 = texture_range_samples.first_m + k * texture_range_samples.step_m,
                     r2 = r1 + texture_range_samples.step_m;
        // Tubes are ordered by azimuth, then from steep to flat. The test takes range bins that no border
        // between these tubes cuts.
        const bool steep = launch_rad(g, r2 / 1500) > 40.3 * degree && launch_rad(g, r1 / 1500) < 74 * degree,
                   flat = launch_rad(g, r1 / 1500) < 40 * degree && launch_rad(g, r2 / 1500) > 13 * degree;
        if (!steep && !flat) continue;
        for (int side = 0; side < 2; ++side) {
          const double azimuth = (side - 1) * 3 * degree;
          const double truth = closed_form(g, r1 / 1500, r2 / 1500, azimuth, azimuth + 3 * degree, *texture);
          const double found = received[std::size_t((2 * side + !steep) * texture_range_samples.count + k)];
          EXPECT_NEAR(found / truth, 1, 1e-3) << k << ' ' << side;
          ++compared;
        }
      }
      EXPECT_GT(compared, 12u);
    }
  }
}

// Tests the other readers of a texture: ray hits, and fast binning of footprints.
TEST(RefractedTexture, HitsAndCentroidsLieThereToo) {
  const Field texture = perlin(1.5, 2, 0.8, 5);
  const std::vector<Field> textures{texture};
  const std::vector<double> material_mu{texture_mu};
  const std::vector<std::uint16_t> material{0};
  const std::vector<std::uint32_t> beams{0};
  const glm::dvec3 seen[3]{{20, 0, -10}, {30, 0, -10}, {20, 10, -10}},
      lies[3]{{120, 7, -20}, {130, 8, -20}, {121, 19, -21}};
  const std::vector<FacetMap> maps{facet_map(seen, lies)};
  for (int k = 0; k < 3; ++k) EXPECT_LT(glm::distance(maps[0].at(seen[k]), lies[k]), 1e-12);
  EchoModel model{material_mu, material, 0, nullptr};
  model.reflectivity = textures;
  model.path.tx.facet_map = maps;
  const glm::dvec3 at(24, 3, -10), place = lies[0] + 0.4 * (lies[1] - lies[0]) + 0.3 * (lies[2] - lies[0]);
  History hit;
  hit.hits.push_back({.facet = 0,
                      .tube = 0,
                      .slant_range_m = glm::length(at),
                      .sine_grazing = 0.5,
                      .solid_angle_sr = 0.1,
                      .direction = glm::normalize(glm::vec3(at))});
  const RangeSamples samples{20, 5, 4};
  const auto sum = [&](const History& history, Binning binning) {
    const std::vector<double> energy = integrate_echo(history, {1, beams}, samples, model, binning).energy;
    return std::accumulate(energy.begin(), energy.end(), 0.0);
  };
  EXPECT_NEAR(sum(hit, Binning::exact), texture_mu * 0.5 * 0.1 / glm::dot(at, at) * texture->factor(place),
              1e-11);
  History footprint;
  Footprint& f = footprint.footprints.footprints.emplace_back();
  f.plane_normal = {0, 0, 1};
  f.plane_distance_m = 10;
  f.area_m2 = 0.25;
  f.centroid_m = at;
  f.grazing_angle_rad = std::asin(10 / glm::length(at));
  f.slant_range_min_m = f.slant_range_max_m = glm::length(at);
  const double even = texture_mu * 0.25 * 100 / std::pow(glm::length(at), 6);
  EXPECT_NEAR(sum(footprint, Binning::centroid) / even, texture->factor(place), 1e-12);
  model.path.tx.facet_map = std::span(maps).first(0);
  EXPECT_NEAR(sum(footprint, Binning::centroid) / even, texture->factor(at), 1e-12);
}

}  // namespace
}  // namespace tubefoot
