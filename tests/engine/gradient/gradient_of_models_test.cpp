// SPDX-License-Identifier: GPL-3.0-or-later
// Tests gradients of energies with scattering models, beam patterns and textures: central differences inside
// of one combinatorial cell, laws, and invalid input.
#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <numeric>
#include <random>

#include "engine/scattering/layered_reflectivity.hpp"
#include "fixtures/world/differentiated_scenes.hpp"
#include "fixtures/world/textures.hpp"
#include "geometry/numbers/scalars.hpp"

namespace tubefoot {
namespace {

using test::gradient_unit_m;
using test::GradientScene;
using test::perlin;
using test::rough_scene;
using test::translation_of;

constexpr ScatteringModel::Gsab gsab_parameters{0.02, 0.3, 2e-3, 1.7, 5e-3, 0.6};
const std::vector<double> table_angles{5, 20, 45, 70}, table_levels{-35, -28, -22, -12};

void add_model(GradientScene& scene, ScatteringModel model) {
  scene.scattering = {std::make_shared<const ScatteringModel>(std::move(model))};
}

Directivity pattern_of(Directivity::Kind kind, double size, glm::dvec3 axis, bool from_axis = false,
                       double centre = 0) {
  return {kind, glm::normalize(axis), from_axis, centre, size, {}};
}

Directivity tabulated(glm::dvec3 axis, std::vector<double> angle_rad, const std::vector<double>& level_db) {
  Directivity pattern = pattern_of(Directivity::Kind::table, 1, axis, true);
  pattern.table = std::make_shared<const PatternTable>(std::move(angle_rad), level_db);
  return pattern;
}

/// All beams receive all tubes. Receive beams are steered copies of one pattern.
void add_patterns(GradientScene& scene, Directivity transmit, const Directivity& receive) {
  const auto tubes = std::uint32_t(scene.tubes.tubes.size());
  BeamPatterns patterns;
  patterns.transmit = {TransmitPattern(std::move(transmit))};
  for (std::uint32_t k = 0; k < tubes; ++k) {
    Directivity beam = receive;
    if (!beam.from_axis && beam.kind != Directivity::Kind::uniform)
      beam.centre = 0.45 / tubes * (k - (tubes - 1) / 2.0);
    patterns.receive.push_back(beam);
    patterns.fan_of_tube.push_back(0);
    patterns.beams_of_tube.emplace_back(0, tubes);
  }
  scene.patterns = std::move(patterns);
}

struct NamedScene {
  std::string name;
  GradientScene scene;
  double tolerance = 1e-6;
  std::vector<MaterialParameter> parameters{};
};

std::vector<NamedScene> scenes_of_models() {
  using Kind = Directivity::Kind;
  using Gsab = ScatteringDerivative::Gsab;
  const glm::dvec3 ahead(0.1, 1, -0.5), across(1, 0.1, 0.05);
  std::vector<NamedScene> scenes;
  const auto make = [&](const char* name, std::uint64_t seed) -> NamedScene& {
    return scenes.emplace_back(NamedScene{name, rough_scene(seed)});
  };
  // Fewer facets for quadratures with many cells.
  const auto make_narrow = [&](const char* name, std::uint64_t seed, double width_deg) -> NamedScene& {
    NamedScene& made = make(name, seed);
    made.scene.tubes = test::forward_tubes(made.scene.tubes.apex, 3, 1, width_deg, 30, 30);
    return made;
  };
  const auto add_gsab = [&](NamedScene& to) {
    add_model(to.scene, ScatteringModel::gsab(gsab_parameters));
    for (const Gsab which : {Gsab::specular, Gsab::specular_width_rad, Gsab::oblique, Gsab::oblique_exponent,
                             Gsab::transition, Gsab::transition_width_rad})
      to.parameters.push_back({0, ScatteringDerivative::gsab(gsab_parameters, which)});
  };
  const auto add_table = [&](NamedScene& to) {
    add_model(to.scene, ScatteringModel::table(table_angles, table_levels));
    for (std::size_t k = 0; k < table_angles.size(); ++k) {
      to.parameters.push_back({0, ScatteringDerivative::table_strength(table_angles, table_levels, k)});
      to.parameters.push_back({0, ScatteringDerivative::table_angle(table_angles, table_levels, k)});
    }
  };
  add_gsab(make("gsab", 11));
  add_table(make("table of scattering", 12));
  add_patterns(make("line array", 13).scene, Directivity(), pattern_of(Kind::line, 6, across));
  add_patterns(make("piston", 14).scene, pattern_of(Kind::piston, 4, ahead, true), Directivity());
  add_patterns(make("Gaussian", 15).scene, pattern_of(Kind::gaussian, 0.6, ahead, true),
               pattern_of(Kind::gaussian, 0.5, across));
  add_patterns(make("table of a pattern", 16).scene, tabulated({0.6, 1, -0.3}, {0, 1.6}, {0, -30}),
               Directivity());
  scenes.back().tolerance = 5e-6;
  // Energies have errors at the rows of a table, which differences amplify.
  NamedScene& rows = make_narrow("table of a pattern with rows", 16, 4);
  add_patterns(rows.scene, tabulated(ahead, {0, 0.15, 0.3, 1.4}, {0, -3, -12, -20}), Directivity());
  rows.tolerance = 5e-4;
  NamedScene& mixed = make("gsab with crossed line arrays", 17);
  add_gsab(mixed);
  add_patterns(mixed.scene, pattern_of(Kind::line, 3, {0, 0.4, 1}, false, -0.2),
               pattern_of(Kind::line, 5, across));
  NamedScene& kinked = make("table of scattering with a Gaussian pattern", 18);
  add_table(kinked);
  add_patterns(kinked.scene, pattern_of(Kind::gaussian, 0.8, ahead, true), Directivity());
  // So many beams that sums over directions are common to them.
  NamedScene& many = make("many beams", 24);
  many.scene.tubes = test::forward_tubes(test::grid_point(0.01, 0.02, 3), 26, 1, 36, 50, 30);
  add_patterns(many.scene, pattern_of(Kind::gaussian, 0.8, ahead, true), pattern_of(Kind::line, 6, across));
  make_narrow("Perlin noise", 19, 12).scene.reflectivity = {perlin(1.5, 2)};
  const auto map = test::random_map(5, 4, 3, {{0.3, 0.2}, {1.1, 0.2}, {-0.1, 0.9}, true});
  make("map", 20).scene.reflectivity = {map};
  NamedScene& layered = make_narrow("layers, gsab and a line array", 21, 12);
  layered.scene.reflectivity = {std::make_shared<const LayeredReflectivity>(
      std::vector<std::shared_ptr<const ReflectivityField>>{map, perlin(2)})};
  add_gsab(layered);
  add_patterns(layered.scene, Directivity(), pattern_of(Kind::line, 4, across));
  return scenes;
}

std::vector<double> random_weights(std::size_t count, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> value(-1, 2);
  std::vector<double> weights(count);
  for (double& weight : weights) weight = value(random);
  return weights;
}

double dot_of(const std::vector<double>& a, const std::vector<double>& b) {
  return std::inner_product(a.begin(), a.end(), b.begin(), 0.0);
}

glm::dvec3 rotated(glm::dvec3 v, glm::dvec3 axis, double angle) {
  return std::cos(angle) * v + std::sin(angle) * glm::cross(axis, v) +
         (1 - std::cos(angle)) * glm::dot(axis, v) * axis;
}

void turn_patterns(GradientScene& scene, glm::dvec3 axis, double angle) {
  for (TransmitPattern& transmit : scene.patterns->transmit)
    for (Directivity& beam : transmit.beams) beam.axis = rotated(beam.axis, axis, angle);
  for (Directivity& beam : scene.patterns->receive) beam.axis = rotated(beam.axis, axis, angle);
}

TEST(GradientOfModels, AgreesWithCentralDifferences) {
  for (const auto& [name, scene, tolerance, parameters] : scenes_of_models()) {
    SCOPED_TRACE(name);
    const std::vector<double> weights = random_weights(scene.bins(), 1);
    const EchoGradient gradient = scene.gradient(weights, parameters);
    constexpr std::int32_t step = 128;
    const auto difference = [&](const auto& move, double half_step) {
      GradientScene up = scene, down = scene;
      move(up, 1);
      move(down, -1);
      return (up.energy(weights) - down.energy(weights)) / (2 * half_step);
    };
    const double step_m = step * gradient_unit_m;
    double largest = 0;
    for (const glm::dvec3& by : gradient.by_vertex) largest = std::max(largest, glm::length(by));
    ASSERT_GT(largest, 0);
    std::size_t moved = 0;
    for (std::size_t v = 0; v < scene.mesh.vertices.size(); v += 7) {
      const glm::dvec3 by = gradient.by_vertex[v];
      if (by == glm::dvec3(0)) continue;
      ++moved;
      EXPECT_NEAR(
          by.z, difference([&](GradientScene& s, int side) { s.mesh.vertices[v].z += side * step; }, step_m),
          tolerance * largest)
          << v;
      EXPECT_NEAR(
          by.y, difference([&](GradientScene& s, int side) { s.mesh.vertices[v].y += side * step; }, step_m),
          tolerance * largest)
          << v;
    }
    EXPECT_GE(moved, 3u);
    const glm::dvec3 by_place = translation_of(gradient);
    const auto by_apex = [&](std::int32_t GridPoint::*axis) {
      return difference([&](GradientScene& s, int side) { s.tubes.apex.*axis += side * step; }, step_m);
    };
    const double size = std::max(glm::length(by_place), largest);
    EXPECT_NEAR(by_place.x, by_apex(&GridPoint::x), tolerance * size);
    EXPECT_NEAR(by_place.y, by_apex(&GridPoint::y), tolerance * size);
    EXPECT_NEAR(by_place.z, by_apex(&GridPoint::z), tolerance * size);

    ASSERT_FALSE(scene.tubes.rays.empty());
    const GridPoint ray = scene.tubes.rays[1];
    const double reach = glm::length(glm::dvec3(ray.x, ray.y, ray.z));
    const auto unit = std::int32_t(reach * 1e-5);
    glm::dvec3 by_ray(0);  // names number the rays of each tube on their own
    const std::vector<glm::dvec3> rays = scene.rays();
    for (std::size_t k = 0; k < rays.size(); ++k)
      if (rays[k] == glm::dvec3(ray.x, ray.y, ray.z)) by_ray += gradient.by_ray[k];
    EXPECT_NEAR(
        by_ray.z * reach,
        difference([&](GradientScene& s, int side) { s.tubes.rays[1].z += side * unit; }, unit / reach),
        tolerance * std::max(largest, glm::length(by_ray) * reach));

    const double alpha = scene.absorption_db_per_m, change = 1e-4;
    const double by_absorption = difference(
        [&](GradientScene& s, int side) { s.absorption_db_per_m = alpha + side * change; }, change);
    EXPECT_NEAR(gradient.by_absorption, by_absorption, tolerance * std::abs(by_absorption));
    const double scale = 1e-5;
    const double by_scale = difference(
        [&](GradientScene& s, int side) {
          s.samples.first_m *= 1 + side * scale;
          s.samples.step_m *= 1 + side * scale;
        },
        scale);
    EXPECT_NEAR(gradient.by_range_scale, by_scale, tolerance * std::max(std::abs(by_scale), largest));
    for (int k = 0; scene.patterns && k < 3; ++k) {
      glm::dvec3 axis(0);
      axis[k] = 1;
      const double angle = 1e-5;
      EXPECT_NEAR(
          gradient.by_pattern_rotation[k],
          difference([&](GradientScene& s, int side) { turn_patterns(s, axis, side * angle); }, angle),
          tolerance * std::max(largest, glm::length(gradient.by_pattern_rotation)))
          << k;
    }
  }
}

// Each bin of each beam, in forward mode.
TEST(GradientOfModels, OfEachBinAgreesWithCentralDifferences) {
  for (const auto& [name, scene, tolerance, parameters] : scenes_of_models()) {
    SCOPED_TRACE(name);
    constexpr std::int32_t step = 128;
    const double angle = 1e-5;
    const glm::dvec3 axis = glm::normalize(glm::dvec3(0.3, -0.5, 0.8));
    const std::vector<std::vector<double>> found = scene.derivatives(
        std::vector{EchoParameter::sonar_translation({0, 1, 0}), EchoParameter::patterns_rotation(axis)});
    const auto differences = [&](const auto& move, double half_step) {
      GradientScene up = scene, down = scene;
      move(up, 1);
      move(down, -1);
      std::vector<double> all = up.energies();
      const std::vector<double> less = down.energies();
      for (std::size_t k = 0; k < all.size(); ++k) all[k] = (all[k] - less[k]) / (2 * half_step);
      return all;
    };
    std::vector<std::vector<double>> expected;
    expected.push_back(differences([&](GradientScene& s, int side) { s.tubes.apex.y += side * step; },
                                   step * gradient_unit_m));
    if (scene.patterns)
      expected.push_back(
          differences([&](GradientScene& s, int side) { turn_patterns(s, axis, side * angle); }, angle));
    else
      expected.emplace_back(scene.bins(), 0.0);
    for (std::size_t n = 0; n < 2; ++n) {
      double largest = 0;
      for (const double value : expected[n]) largest = std::max(largest, std::abs(value));
      for (std::size_t k = 0; k < expected[n].size(); ++k)
        EXPECT_NEAR(found[n][k], expected[n][k], tolerance * largest) << n << " " << k;
    }
  }
}

TEST(GradientOfModels, OfParametersOfScatteringAgreesWithCentralDifferences) {
  for (const NamedScene& named : scenes_of_models()) {
    if (named.parameters.empty()) continue;
    SCOPED_TRACE(named.name);
    const bool table = named.parameters.size() > 6;
    std::vector<EchoParameter> engine;
    for (const MaterialParameter& parameter : named.parameters)
      engine.push_back(EchoParameter::material_scattering(parameter));
    const std::vector<std::vector<double>> all = named.scene.derivatives(engine);
    for (std::size_t k = 0; k < named.parameters.size(); ++k) {
      SCOPED_TRACE(k);
      const std::vector<double>& found = all[k];
      double step = 0;
      const auto energies = [&](int side) {
        GradientScene changed = named.scene;
        if (table) {
          std::vector<double> angles = table_angles, levels = table_levels;
          step = 1e-3;
          (k % 2 == 0 ? levels : angles)[k / 2] += side * step;
          add_model(changed, ScatteringModel::table(angles, levels));
        } else {
          ScatteringModel::Gsab p = gsab_parameters;
          double* const values[]{&p.specular,         &p.specular_width_rad, &p.oblique,
                                 &p.oblique_exponent, &p.transition,         &p.transition_width_rad};
          step = 1e-4 * *values[k];
          *values[k] += side * step;
          add_model(changed, ScatteringModel::gsab(p));
        }
        return changed.energies();
      };
      const std::vector<double> more = energies(1), less = energies(-1);
      double largest = 0;
      for (const double value : found) largest = std::max(largest, std::abs(value));
      for (std::size_t bin = 0; bin < found.size(); ++bin)
        EXPECT_NEAR(found[bin], (more[bin] - less[bin]) / (2 * step), 2e-6 * largest) << bin;
    }
  }
}

TEST(GradientOfModels, OfForwardModeAgreesWithReverseMode) {
  for (const auto& [name, scene, tolerance, parameters] : scenes_of_models()) {
    SCOPED_TRACE(name);
    const std::vector<double> weights = random_weights(scene.bins(), 2);
    const EchoGradient gradient = scene.gradient(weights, parameters);
    const std::vector<glm::dvec3> rays = scene.rays();
    std::vector<EchoParameter> forward;
    std::vector<double> expected;
    for (int k = 0; k < 3; ++k) {
      glm::dvec3 axis(0);
      axis[k] = 1;
      forward.push_back(EchoParameter::sonar_translation(axis));
      expected.push_back(translation_of(gradient)[k]);
      double turned = gradient.by_pattern_rotation[k];
      for (std::size_t r = 0; r < rays.size(); ++r)
        turned += glm::dot(gradient.by_ray[r], glm::cross(axis, rays[r]));
      forward.push_back(EchoParameter::sonar_rotation(axis));
      expected.push_back(turned);
      forward.push_back(EchoParameter::patterns_rotation(axis));
      expected.push_back(gradient.by_pattern_rotation[k]);
    }
    forward.push_back(EchoParameter::material_mu(0, 1));
    expected.push_back(gradient.by_material_mu[0]);
    forward.push_back(EchoParameter::absorption());
    expected.push_back(gradient.by_absorption);
    forward.push_back(EchoParameter::sound_speed(1500));
    expected.push_back(gradient.by_range_scale / 1500);
    for (std::size_t k = 0; k < parameters.size(); ++k) {
      forward.push_back(EchoParameter::material_scattering(parameters[k]));
      expected.push_back(gradient.by_scattering[k]);
    }
    const std::vector<std::vector<double>> found = scene.derivatives(forward);
    for (std::size_t n = 0; n < forward.size(); ++n) {
      double size = 0;
      for (std::size_t k = 0; k < weights.size(); ++k) size += std::abs(weights[k] * found[n][k]);
      EXPECT_NEAR(dot_of(found[n], weights), expected[n], 1e-9 * size) << n;
    }
  }
}

// Without patterns and textures, rotations of mesh and tubes are independent of each other in the code.
TEST(GradientOfModels, OfARotationOfEverythingIsZero) {
  for (const auto& [name, scene, tolerance, parameters] : scenes_of_models()) {
    if (!scene.reflectivity.empty()) continue;
    SCOPED_TRACE(name);
    const EchoGradient gradient = scene.gradient(random_weights(scene.bins(), 3));
    glm::dvec3 rotation = gradient.by_pattern_rotation;
    double size = 0;
    const std::vector<glm::dvec3> rays = scene.rays();
    for (std::size_t k = 0; k < rays.size(); ++k) rotation += glm::cross(rays[k], gradient.by_ray[k]);
    for (std::size_t v = 0; v < gradient.by_vertex.size(); ++v) {
      const GridPoint p = scene.mesh.vertices[v] - scene.tubes.apex;
      const glm::dvec3 turned =
          glm::cross(gradient_unit_m * glm::dvec3(p.x, p.y, p.z), gradient.by_vertex[v]);
      rotation += turned;
      size += glm::length(turned);
    }
    ASSERT_GT(size, 0);
    EXPECT_LT(glm::length(rotation), 1e-9 * size);
    // The same in forward mode, for all points at once.
    EchoParameter all = EchoParameter::patterns_rotation({0, 0, 1});
    all.velocity = [](PointId, glm::dvec3 at) { return glm::cross(glm::dvec3(0, 0, 1), at); };
    const EchoParameter mesh_alone = [&] {
      EchoParameter parameter = all;
      parameter.pattern_rotation = glm::dvec3(0);
      parameter.velocity = [](PointId id, glm::dvec3 at) {
        return id & ray_bit ? glm::dvec3(0) : glm::cross(glm::dvec3(0, 0, 1), at);
      };
      return parameter;
    }();
    const std::vector<std::vector<double>> found = scene.derivatives(std::vector{all, mesh_alone});
    double largest = 0, left = 0;
    for (std::size_t k = 0; k < found[0].size(); ++k) {
      largest = std::max(largest, std::abs(found[1][k]));
      left = std::max(left, std::abs(found[0][k]));
    }
    ASSERT_GT(largest, 0);
    EXPECT_LT(left, 1e-9 * largest);
  }
}

// With a texture, a translation of the sonar with the scene moves it against the texture alone.
TEST(GradientOfModels, OfATranslationOfEverythingIsThatOfTheTexture) {
  for (const auto& [name, scene, tolerance, parameters] : scenes_of_models()) {
    SCOPED_TRACE(name);
    EchoParameter all;
    all.apex_velocity = {0.6, 0, 0.8};
    const std::vector<double> found = scene.derivatives(std::vector{all})[0];
    const double size = dot_of(found, found);
    if (scene.reflectivity.empty())
      EXPECT_EQ(size, 0);
    else
      EXPECT_GT(size, 0);
  }
}

// Energies scale as s^-2 if all lengths scale by s, and the absorption by 1 / s.
TEST(GradientOfModels, OfAScaleOfEverythingIsMinusTwiceTheEnergy) {
  for (const auto& [name, scene, tolerance, parameters] : scenes_of_models()) {
    if (!scene.reflectivity.empty()) continue;
    SCOPED_TRACE(name);
    const std::vector<double> weights = random_weights(scene.bins(), 4);
    const EchoGradient gradient = scene.gradient(weights);
    double sum = gradient.by_range_scale - scene.absorption_db_per_m * gradient.by_absorption, size = 0;
    for (std::size_t v = 0; v < gradient.by_vertex.size(); ++v) {
      const GridPoint p = scene.mesh.vertices[v] - scene.tubes.apex;
      const double part = gradient_unit_m * glm::dot(glm::dvec3(p.x, p.y, p.z), gradient.by_vertex[v]);
      sum += part;
      size += std::abs(part);
    }
    EXPECT_NEAR(sum, -2 * scene.energy(weights), 0.01 * tolerance * size);
  }
}

TEST(GradientOfModels, OfAHiddenVertexIsZero) {
  for (auto& [name, scene, tolerance, parameters] : scenes_of_models()) {
    SCOPED_TRACE(name);
    GradientScene hidden = scene;
    const std::size_t first = hidden.mesh.vertices.size();
    test::add_box(hidden.mesh, test::grid_point(0, 8, -3), std::int32_t(0.5 / gradient_unit_m));
    const EchoGradient gradient = hidden.gradient();
    for (std::size_t v = first; v < hidden.mesh.vertices.size(); ++v)
      EXPECT_EQ(gradient.by_vertex[v], glm::dvec3(0));
  }
}

// Directions below the limit do not contribute.
TEST(GradientOfModels, OfALimitOfGainsIsThatOfTheOtherDirections) {
  GradientScene scene = rough_scene(22);
  add_patterns(scene, pattern_of(Directivity::Kind::gaussian, 0.6, {0, 1, -0.5}, true), Directivity());
  const EchoGradient free = scene.gradient();
  scene.patterns->least.assign(3, 1e-9);
  const EchoGradient low = scene.gradient();
  scene.patterns->least.assign(3, 2);
  const EchoGradient high = scene.gradient();
  for (std::size_t v = 0; v < free.by_vertex.size(); ++v) {
    EXPECT_EQ(low.by_vertex[v], free.by_vertex[v]);
    EXPECT_EQ(high.by_vertex[v], glm::dvec3(0));
  }
}

class FieldOfAnotherKind : public ReflectivityField {
 public:
  double factor(glm::dvec3) const override { return 1; }
  double largest() const override { return 1; }
  double finest_m() const override { return 1; }
  std::span<const CellPlanes> cells() const override { return {}; }
  double change(double) const override { return 0; }
};

TEST(GradientOfModels, RejectsWhatHasNone) {
  GradientScene scene = rough_scene(23);
  const std::vector<EchoParameter> parameters{EchoParameter::sonar_translation({1, 0, 0})};
  const auto is_rejected = [&](const GradientScene& bad, std::span<const MaterialParameter> scattering = {}) {
    EXPECT_THROW(bad.gradient({}, scattering), std::invalid_argument);
    if (!scattering.empty()) return;
    EXPECT_THROW(bad.derivatives(parameters), std::invalid_argument);
  };
  GradientScene bad = scene;
  bad.reflectivity = {std::make_shared<const FieldOfAnotherKind>()};
  is_rejected(bad);
  bad = scene;
  add_patterns(bad, Directivity(), Directivity());
  bad.patterns->baselines.resize(1);
  is_rejected(bad);
  bad = scene;
  add_patterns(bad, Directivity(), Directivity());
  bad.patterns->receive.pop_back();
  is_rejected(bad);
  const ScatteringDerivative derivative =
      ScatteringDerivative::gsab(gsab_parameters, ScatteringDerivative::Gsab::oblique);
  is_rejected(scene, std::vector<MaterialParameter>{{0, derivative}});  // Lambert's law
  add_model(scene, ScatteringModel::gsab(gsab_parameters));
  is_rejected(scene, std::vector<MaterialParameter>{{1, derivative}});
  EXPECT_NO_THROW(scene.gradient({}, std::vector<MaterialParameter>{{0, derivative}}));
}

}  // namespace
}  // namespace tubefoot
