// SPDX-License-Identifier: GPL-3.0-or-later
// Tests derivatives of energies in stratified water: central differences of whole echoes with a refinement
// that stays fixed, isovelocity water as a profile, and laws.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <glm/geometric.hpp>
#include <numeric>
#include <string_view>

#include "engine/gradient/apparent_parameters.hpp"
#include "fixtures/world/differentiated_scenes.hpp"
#include "fixtures/world/textures.hpp"

namespace tubefoot {
namespace {

constexpr double surface_m = 6;          // height of the sea surface; the sonar is at 3 m
constexpr int exponent = 25, finer = 8;  // a finer grid than that of the other scenes: 2^-25 m

const std::vector<ProfilePoint> layers{{0, 1490}, {3.5, 1494}, {4.5, 1488}, {5.25, 1488}, {7, 1497}};

std::int32_t& coordinate(GridPoint& p, int axis) { return axis == 0 ? p.x : axis == 1 ? p.y : p.z; }

/// A true seabed and what a sonar sees of it through the water.
struct StratifiedScene {
  FacetMesh base;
  TubeSet tubes;
  RangeSamples samples{2, 0.5, 16};
  std::vector<double> mu{std::pow(10, -2.7)};
  std::vector<std::shared_ptr<const ScatteringModel>> models{};
  std::vector<std::shared_ptr<const ReflectivityField>> textures{};
  std::optional<BeamPatterns> patterns{};
  std::vector<ProfilePoint> profile = layers;
  double absorption_db_per_m = 0.15, layer_db_per_m = 0.02;
  double factor_tolerance_db = 1e9;  ///< no edge is cut
  double reference_m_s = 1492;
  WorldGrid grid{exponent, glm::dvec3(0)};

  glm::dvec3 apex_m() const { return grid.to_metres(tubes.apex); }
  WaterColumn water() const {
    WaterColumn column{SoundSpeedProfile(profile), {}};
    for (std::size_t k = 0; k < column.profile.layers(); ++k)
      column.absorption_db_per_m.push_back(absorption_db_per_m + layer_db_per_m * double(k));
    return column;
  }
  ApparentMap map(const WaterColumn& column) const {
    return ApparentMap(column, apex_m(), surface_m, {}, reference_m_s);
  }
  ApparentSurface surface(const ApparentMap& seen) const {
    std::vector<FacetId> all(base.facets.size());
    std::iota(all.begin(), all.end(), 0u);
    return map_apparent(
        base, all, grid, seen, absorption_db_per_m,
        {.travel_path_error_m = 1e9, .tolerance_db = factor_tolerance_db, .shortest_edge_m = 0.1}, {},
        models);
  }
  /// `maps` must outlive the result.
  EchoModel model(const ApparentSurface& seen, std::vector<FacetMap>& maps) const {
    EchoModel model{mu, seen.refined.mesh.material, absorption_db_per_m, patterns ? &*patterns : nullptr};
    model.scattering = models;
    model.reflectivity = textures;
    model.pattern_tolerance = 1e-11;
    if (!textures.empty()) model.path.tx.facet_map = maps = seen.facet_maps(apex_m(), grid);
    model.path.facet_factor = seen.facet_factor;
    model.path.tx.apex_m = apex_m();
    return model;
  }
  History history(const FacetMesh& mesh) const {
    const SceneTree tree(mesh);
    VisibilityOptions options;
    options.corner_names = true;
    return TubeEngine(mesh, tree, grid.unit_m(), options).trace(tubes);
  }
  std::vector<std::uint32_t> beams() const {
    std::vector<std::uint32_t> all(tubes.tubes.size());
    std::iota(all.begin(), all.end(), 0u);
    return all;
  }
  std::vector<double> energies() const {
    const WaterColumn column = water();
    const ApparentSurface seen = surface(map(column));
    const std::vector<std::uint32_t> own = beams();
    std::vector<FacetMap> maps;
    return integrate_echo(history(seen.refined.mesh), {int(own.size()), own}, samples, model(seen, maps))
        .energy;
  }
  std::vector<std::vector<double>> derivatives(
      const std::function<std::vector<StratifiedParameter>(const FacetMesh&)>& parameters) const {
    const WaterColumn column = water();
    const ApparentMap seen_by = map(column);
    const ApparentSurface seen = surface(seen_by);
    EXPECT_EQ(seen.facets_of_several, 0u);
    EXPECT_EQ(seen.facets_in_shadow, 0u);
    const std::vector<std::uint32_t> own = beams();
    std::vector<FacetMap> maps;
    const EchoModel echo_model = model(seen, maps);
    const FacetMesh& mesh = seen.refined.mesh;
    return echo_derivatives(mesh, history(mesh), {int(own.size()), own}, samples, echo_model,
                            apparent_parameters(parameters(mesh), seen, seen_by, grid, echo_model));
  }
};

/// A rough terrain, and facets in front of it, which are component 1.
StratifiedScene rough_stratified(std::uint64_t seed) {
  StratifiedScene scene;
  test::Random random(seed);
  scene.base = test::rough_terrain(random, 3, test::grid_units(16), 0, test::grid_units(0.4));
  test::add_random_facets(scene.base, random, 4, 1);
  for (GridPoint& v : scene.base.vertices) v = {finer * v.x, finer * v.y, finer * v.z};
  const GridPoint apex = test::grid_point(0.01, 0.02, 3);
  scene.tubes = test::forward_tubes({finer * apex.x, finer * apex.y, finer * apex.z}, 3, 1, 36, 36, 36);
  return scene;
}

void add_gsab(StratifiedScene& scene) {
  scene.models = {
      std::make_shared<const ScatteringModel>(ScatteringModel::gsab({0.02, 0.3, 2e-3, 1.7, 5e-3, 0.6}))};
}

void add_texture(StratifiedScene& scene) { scene.textures = {test::perlin(2.0, 1, 0.9)}; }

/// All beams receive all tubes, from which the transmit pattern selects.
void add_pattern(StratifiedScene& scene) {
  const auto tubes = std::uint32_t(scene.tubes.tubes.size());
  BeamPatterns patterns;
  patterns.transmit = {TransmitPattern(
      Directivity{Directivity::Kind::gaussian, glm::normalize(glm::dvec3(0.1, 1, -0.7)), true, 0, 0.3, {}})};
  for (std::uint32_t k = 0; k < tubes; ++k) {
    patterns.receive.push_back(
        {Directivity::Kind::gaussian, glm::normalize(glm::dvec3(0.2 * k - 0.2, 1, -0.6)), true, 0, 0.2, {}});
    patterns.fan_of_tube.push_back(0);
    patterns.beams_of_tube.emplace_back(0, tubes);
  }
  scene.patterns = std::move(patterns);
}

double largest(const std::vector<double>& values) {
  double most = 0;
  for (const double v : values) most = std::max(most, std::abs(v));
  return most;
}

struct Change {
  const char* name;
  std::function<StratifiedParameter(const StratifiedScene&, const FacetMesh&)> parameter;
  std::function<void(StratifiedScene&, int)> move;  ///< by a number of steps
  double step;
};

// Apparent positions are rounded to the grid, so that steps must be large.
constexpr int length_units = 1 << 16;  // about 2 mm
constexpr double speed_step = 1;

std::vector<Change> changes() {
  std::vector<Change> all;
  constexpr const char* axes[]{"east", "north", "up"};
  for (int axis = 0; axis < 3; ++axis) {
    glm::dvec3 unit(0);
    unit[axis] = 1;
    const double step = length_units / std::exp2(exponent);
    all.push_back({axes[axis],
                   [unit](const auto&, const auto&) {
                     return StratifiedParameter{EchoParameter::sonar_translation(unit)};
                   },
                   [axis](StratifiedScene& scene, int steps) {
                     coordinate(scene.tubes.apex, axis) += steps * length_units;
                   },
                   step});
    all.push_back({"object",
                   [unit](const auto&, const FacetMesh& mesh) {
                     return StratifiedParameter{EchoParameter::object_translation(mesh, 1, unit)};
                   },
                   [axis](StratifiedScene& scene, int steps) {
                     std::vector<bool> own(scene.base.vertices.size());
                     for (std::size_t f = 0; f < scene.base.facets.size(); ++f)
                       for (const VertexId v : scene.base.facets[f])
                         if (scene.base.component[f] == 1) own[v] = true;
                     for (std::size_t v = 0; v < own.size(); ++v)
                       if (own[v]) coordinate(scene.base.vertices[v], axis) += steps * length_units;
                   },
                   step});
  }
  for (std::size_t k = 0; k < layers.size(); ++k)
    all.push_back(
        {"profile",
         [k](const auto&, const auto&) {
           StratifiedParameter parameter;
           parameter.sound_speed_m_s.assign(layers.size(), 0);
           parameter.sound_speed_m_s[k] = 1;
           return parameter;
         },
         [k](StratifiedScene& scene, int steps) { scene.profile[k].sound_speed_m_s += speed_step * steps; },
         speed_step});
  all.push_back({"absorption",
                 [](const auto&, const auto&) { return StratifiedParameter{EchoParameter::absorption()}; },
                 [](StratifiedScene& scene, int steps) { scene.absorption_db_per_m += 1e-3 * steps; }, 1e-3});
  return all;
}

void compare_with_differences(const StratifiedScene& scene, std::vector<Change> all, double tolerance) {
  const auto derivatives = scene.derivatives([&](const FacetMesh& mesh) {
    std::vector<StratifiedParameter> parameters;
    for (const Change& change : all) parameters.push_back(change.parameter(scene, mesh));
    return parameters;
  });
  for (std::size_t n = 0; n < all.size(); ++n) {
    SCOPED_TRACE(all[n].name);
    const auto energies = [&](int steps) {
      StratifiedScene moved = scene;
      all[n].move(moved, steps);
      return moved.energies();
    };
    const std::vector<double> a = energies(1), b = energies(-1), c = energies(2), d = energies(-2);
    EXPECT_GT(largest(derivatives[n]), 0);
    double most = 0;  // of all points of the profile
    for (std::size_t m = 0; m < all.size(); ++m)
      if (std::string_view(all[m].name) == all[n].name) most = std::max(most, largest(derivatives[m]));
    double worst = 0;
    for (std::size_t k = 0; k < a.size(); ++k)
      worst = std::max(
          worst, std::abs(derivatives[n][k] - (8 * (a[k] - b[k]) - (c[k] - d[k])) / (12 * all[n].step)));
    EXPECT_LT(worst, tolerance * most) << n;
  }
}

TEST(ApparentGradient, IsTheCentralDifferenceOfEchoes) {
  compare_with_differences(rough_stratified(3), changes(), 1e-5);
}

TEST(ApparentGradient, IsTheCentralDifferenceWithAScatteringModel) {
  StratifiedScene scene = rough_stratified(3);
  add_gsab(scene);
  std::vector<Change> all = changes();
  const ScatteringModel::Gsab gsab{0.02, 0.3, 2e-3, 1.7, 5e-3, 0.6};
  all.push_back({"exponent",
                 [gsab](const auto&, const auto&) {
                   return StratifiedParameter{EchoParameter::material_scattering(
                       {0, ScatteringDerivative::gsab(gsab, ScatteringDerivative::Gsab::oblique_exponent)})};
                 },
                 [gsab](StratifiedScene& moved, int steps) {
                   ScatteringModel::Gsab own = gsab;
                   own.oblique_exponent += 1e-3 * steps;
                   moved.models = {std::make_shared<const ScatteringModel>(ScatteringModel::gsab(own))};
                 },
                 1e-3});
  compare_with_differences(scene, all, 1e-5);
}

TEST(ApparentGradient, IsTheCentralDifferenceWithATexture) {
  StratifiedScene scene = rough_stratified(3);
  add_texture(scene);
  compare_with_differences(scene, changes(), 1e-5);
}

TEST(ApparentGradient, EnergiesAreLinearInMu) {
  const StratifiedScene scene = rough_stratified(5);
  const std::vector<double> energies = scene.energies();
  const auto by = scene.derivatives(
      [](const FacetMesh&) { return std::vector<StratifiedParameter>{{EchoParameter::material_mu(0, 1)}}; });
  for (std::size_t k = 0; k < energies.size(); ++k)
    EXPECT_NEAR(by[0][k] * scene.mu[0], energies[k], 1e-9 * largest(energies));
}

void compare_with_isovelocity_water(StratifiedScene scene, double tolerance) {
  for (ProfilePoint& p : scene.profile) p.sound_speed_m_s = scene.reference_m_s;
  scene.layer_db_per_m = 0;
  scene.absorption_db_per_m = 0;
  const auto parameters = [&](const FacetMesh& mesh) {
    std::vector<StratifiedParameter> all;
    for (int axis = 0; axis < 3; ++axis) {
      glm::dvec3 unit(0);
      unit[axis] = 1;
      all.push_back({EchoParameter::sonar_translation(unit)});
      all.push_back({EchoParameter::sonar_rotation(unit)});
      all.push_back({EchoParameter::patterns_rotation(unit)});
      all.push_back({EchoParameter::object_translation(mesh, 1, unit)});
      all.push_back({EchoParameter::object_rotation(mesh, 1, unit, {0.1, 0.2, -1})});
    }
    for (std::size_t k = 0; k < scene.profile.size(); ++k) {
      all.push_back({{}, std::vector<double>(scene.profile.size(), 0)});
      all.back().sound_speed_m_s[k] = 1;
    }
    return all;
  };
  const auto seen = scene.derivatives(parameters);
  std::vector<EchoParameter> straight;
  for (const StratifiedParameter& p : parameters(scene.base))
    if (p.sound_speed_m_s.empty()) straight.push_back(p.at_rest);
  straight.push_back(EchoParameter::sound_speed(scene.reference_m_s));
  const std::vector<std::uint32_t> own = scene.beams();
  EchoModel model{scene.mu, scene.base.material, scene.absorption_db_per_m,
                  scene.patterns ? &*scene.patterns : nullptr};
  model.reflectivity = scene.textures;
  model.pattern_tolerance = 1e-11;
  model.path.tx.apex_m = scene.apex_m();
  const auto by = echo_derivatives(scene.base, scene.history(scene.base), {int(own.size()), own},
                                   scene.samples, model, straight);
  for (std::size_t n = 0; n + 1 < straight.size(); ++n)
    for (std::size_t k = 0; k < by[n].size(); ++k)
      EXPECT_NEAR(seen[n][k], by[n][k], tolerance * largest(by[n])) << n << " " << k;
  for (std::size_t k = 0; k < by.back().size(); ++k) {
    double sum = 0;
    for (std::size_t n = straight.size() - 1; n < seen.size(); ++n) sum += seen[n][k];
    EXPECT_NEAR(sum, by.back()[k], tolerance * largest(by.back())) << k;
  }
}

TEST(ApparentGradient, OfAProfileOfEqualSpeedsIsThatOfIsovelocityWater) {
  StratifiedScene scene = rough_stratified(7);
  compare_with_isovelocity_water(scene, 1e-9);
  add_pattern(scene);
  compare_with_isovelocity_water(scene, 1e-8);
  add_texture(scene);
  compare_with_isovelocity_water(scene, 1e-8);
}

// Facets are cut here, so that centres and cut edges take part.
TEST(ApparentGradient, OfEverythingMovedOrTurnedHorizontallyIsZero) {
  StratifiedScene scene = rough_stratified(9);
  scene.factor_tolerance_db = 0.02;
  const WaterColumn column = scene.water();
  const ApparentSurface cut = scene.surface(scene.map(column));
  EXPECT_GT(cut.refined.mesh.facets.size(), 2 * scene.base.facets.size());
  const auto by = scene.derivatives([](const FacetMesh& mesh) {
    std::vector<StratifiedParameter> all;
    for (const glm::dvec3 axis : {glm::dvec3(1, 0, 0), glm::dvec3(0, 1, 0)})
      all.insert(all.end(), {{EchoParameter::sonar_translation(axis)},
                             {EchoParameter::object_translation(mesh, 0, axis)},
                             {EchoParameter::object_translation(mesh, 1, axis)}});
    const glm::dvec3 up(0, 0, 1);
    all.insert(all.end(), {{EchoParameter::sonar_rotation(up)},
                           {EchoParameter::object_rotation(mesh, 0, up, glm::dvec3(0))},
                           {EchoParameter::object_rotation(mesh, 1, up, glm::dvec3(0))}});
    return all;
  });
  for (std::size_t law = 0; law < 3; ++law)
    for (std::size_t k = 0; k < by[0].size(); ++k) {
      const double a = by[3 * law][k], b = by[3 * law + 1][k], c = by[3 * law + 2][k];
      EXPECT_NEAR(a + b + c, 0,
                  1e-7 * (std::abs(a) + std::abs(b) + std::abs(c)) + 1e-9 * largest(by[3 * law]))
          << law << " " << k;
    }
}

// The refined mesh has cut facets here. Its vertices are those of ApparentSurface::truth.
TEST(ApparentGradient, ReverseModeIsTheWeightedSumOfForwardMode) {
  StratifiedScene scene = rough_stratified(11);
  scene.factor_tolerance_db = 0.05;
  add_gsab(scene);
  add_texture(scene);
  add_pattern(scene);
  const WaterColumn column = scene.water();
  const ApparentMap map = scene.map(column);
  const ApparentSurface surface = scene.surface(map);
  std::vector<FacetMap> maps;
  const EchoModel model = scene.model(surface, maps);
  const FacetMesh& mesh = surface.refined.mesh;
  const History history = scene.history(mesh);
  const std::vector<std::uint32_t> own = scene.beams();
  const ReceiveBeams beams{int(own.size()), own};
  const MaterialParameter width{
      0, ScatteringDerivative::gsab({0.02, 0.3, 2e-3, 1.7, 5e-3, 0.6}, ScatteringDerivative::Gsab::oblique)};
  const std::vector<std::vector<double>> changes{{0, 1, 0, 0, 0}, {0, 0, 0, 1, 0}};
  std::vector<StratifiedParameter> parameters{{{}, changes[0]}, {{}, changes[1]}};
  for (const glm::dvec3 axis : {glm::dvec3(1, 0, 0), glm::dvec3(0, 0, 1)}) {
    parameters.push_back({EchoParameter::sonar_translation(axis)});
    parameters.push_back({EchoParameter::object_translation(mesh, 1, axis)});
  }
  parameters.push_back({EchoParameter::absorption()});
  parameters.push_back({EchoParameter::material_scattering(width)});
  parameters.push_back({EchoParameter::patterns_rotation({0.6, 0, 0.8})});
  const auto by = echo_derivatives(mesh, history, beams, scene.samples, model,
                                   apparent_parameters(parameters, surface, map, scene.grid, model));
  test::Random random(4);
  std::vector<double> weights(own.size() * std::size_t(scene.samples.count));
  for (double& w : weights) w = test::uniform(random, -1000, 1000) / 1000.0;
  const std::vector<MaterialParameter> scattering{width};
  const EchoGradient apparent =
      echo_gradient(mesh, history, beams, scene.samples, model, weights, scattering);
  const StratifiedGradient gradient =
      stratified_gradient(apparent, surface, map, scene.grid, model, scattering);
  std::vector<bool> object(mesh.vertices.size());
  for (std::size_t f = 0; f < mesh.facets.size(); ++f)
    for (const VertexId v : mesh.facets[f]) object[v] = mesh.component[f] == 1;
  glm::dvec3 by_object(0);
  for (std::size_t v = 0; v < object.size(); ++v)
    if (object[v]) by_object += gradient.by_vertex[v];
  const double reverse[]{gradient.by_sound_speed[1],
                         gradient.by_sound_speed[3],
                         gradient.by_apex.x,
                         by_object.x,
                         gradient.by_apex.z,
                         by_object.z,
                         gradient.by_absorption,
                         gradient.by_scattering[0],
                         glm::dot(apparent.by_pattern_rotation, glm::dvec3(0.6, 0, 0.8))};
  for (std::size_t n = 0; n < by.size(); ++n) {
    double sum = 0, magnitudes = 0;
    for (std::size_t k = 0; k < weights.size(); ++k) {
      sum += weights[k] * by[n][k];
      magnitudes += std::abs(weights[k] * by[n][k]);
    }
    EXPECT_GT(magnitudes, 0) << n;
    EXPECT_NEAR(reverse[n], sum, 1e-9 * magnitudes) << n;
  }
}

}  // namespace
}  // namespace tubefoot
