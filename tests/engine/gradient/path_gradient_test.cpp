// SPDX-License-Identifier: GPL-3.0-or-later
// Tests derivatives of energies of paths over mirrors: central differences of path_echo(), laws, and closed
// forms of images.
#include "engine/paths/path_gradient.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <random>
#include <stdexcept>
#include <string>

#include "fixtures/geometry/grid_scenes.hpp"
#include "fixtures/world/path_scenes.hpp"
#include "fixtures/world/textures.hpp"

namespace tubefoot {
namespace {

using test::Random;

constexpr double metres_per_unit = 0x1p-26;  // fine, because images are rounded to the grid

GridPoint fine_point(glm::dvec3 p) {
  const auto snap = [](double m) { return std::int32_t(std::lround(m / metres_per_unit)); };
  return {snap(p.x), snap(p.y), snap(p.z)};
}
glm::dvec3 in_metres(GridPoint p) { return metres_per_unit * glm::dvec3(p.x, p.y, p.z); }

enum Component : std::uint16_t { terrain, quay, beacon };

/// A terrain, a mirror and facets in front of both. One beam per tube of the receiver.
struct MirrorScene {
  FacetMesh mesh;
  TubeSet transmit, receive;
  RangeSamples samples{1, 9, 2};
  std::vector<double> mu{0.002, 0.01};
  std::vector<double> reflection{0, 0.5};  ///< of the terrain and the beacon, and of the quay
  double absorption_db_per_m = 0.2;
  PathSettings paths;
  std::vector<std::shared_ptr<const ScatteringModel>> scattering{};
  std::vector<std::shared_ptr<const ReflectivityField>> reflectivity{};

  MirrorScene() {
    paths.order = 3;
    paths.cutoff_db = 300;
    paths.arrivals = false;
  }
  EchoModel model() const {
    EchoModel model{mu, mesh.material, absorption_db_per_m};
    model.path.tx.apex_m = in_metres(transmit.apex);
    model.scattering = scattering;
    model.reflectivity = reflectivity;
    return model;
  }
  PathSettings settings() const {
    PathSettings own = paths;
    own.mirrors.reflection = reflection;
    return own;
  }
  std::vector<std::uint32_t> beams() const {
    std::vector<std::uint32_t> all(receive.tubes.size());
    std::iota(all.begin(), all.end(), 0);
    return all;
  }
  std::vector<double> energies(const std::function<bool(std::size_t)>& is_wanted) const {
    const SceneTree tree(mesh);
    const std::vector<std::uint32_t> beam = beams();
    const PathSettings own = settings();
    const PathEcho echo = path_echo(mesh, tree, metres_per_unit, {}, transmit, receive,
                                    {int(beam.size()), beam}, samples, model(), own);
    std::vector<double> sum(echo.by_order[0].energy.size());
    for (std::size_t order = 0; order < echo.by_order.size(); ++order)
      for (std::size_t k = 0; k < sum.size() && is_wanted(order); ++k)
        sum[k] += echo.by_order[order].energy[k];
    return sum;
  }
  std::vector<std::vector<double>> derivatives(std::span<const EchoParameter> parameters,
                                               const std::function<bool(std::size_t)>& is_wanted) const {
    const SceneTree tree(mesh);
    const std::vector<std::uint32_t> beam = beams();
    const PathSettings own = settings();
    return path_derivatives(mesh, tree, metres_per_unit, {}, transmit, receive, {int(beam.size()), beam},
                            samples, model(), own, parameters, is_wanted);
  }
};

bool every_order(std::size_t) { return true; }

void add_fine_facet(FacetMesh& mesh, Component component, glm::dvec3 a, glm::dvec3 b, glm::dvec3 c) {
  const VertexId i = test::add_vertex(mesh, fine_point(a)), j = test::add_vertex(mesh, fine_point(b)),
                 k = test::add_vertex(mesh, fine_point(c));
  test::add_facet(mesh, i, j, k);
  mesh.component.back() = component;
  mesh.material.back() = component == quay ? 1 : 0;
}

void move(GridPoint& p, glm::dvec3 by) { p = fine_point(in_metres(p) + by); }

void move_component(MirrorScene& scene, Component component,
                    const std::function<glm::dvec3(glm::dvec3)>& to) {
  std::vector<bool> own(scene.mesh.vertices.size());
  for (std::size_t f = 0; f < scene.mesh.facets.size(); ++f)
    for (const VertexId v : scene.mesh.facets[f]) own[v] = own[v] || scene.mesh.component[f] == component;
  for (std::size_t v = 0; v < own.size(); ++v)
    if (own[v]) scene.mesh.vertices[v] = fine_point(to(in_metres(scene.mesh.vertices[v])));
}

void turn_rays(TubeSet& tubes, glm::dvec3 axis, double angle) {
  for (GridPoint& ray : tubes.rays) {
    const glm::dvec3 r = glm::normalize(glm::angleAxis(angle, axis) * glm::dvec3(ray.x, ray.y, ray.z));
    ray = {std::int32_t(std::lround(0x1p30 * r.x)), std::int32_t(std::lround(0x1p30 * r.y)),
           std::int32_t(std::lround(0x1p30 * r.z))};
  }
}

MirrorScene mirror_scene(std::uint64_t seed, bool with_surface, bool with_quay) {
  MirrorScene scene;
  Random random(seed);
  const auto units = [](double m) { return std::int32_t(m / metres_per_unit); };
  scene.mesh = test::rough_terrain(random, 1, units(28), units(-2), units(0.5));
  if (with_quay) add_fine_facet(scene.mesh, quay, {-3.1, 8, -2.4}, {3.2, 7.4, -2.5}, {0.3, 8.4, 1.7});
  add_fine_facet(scene.mesh, beacon, {-0.9, 4.1, -0.6}, {-0.1, 4.3, -1.1}, {-0.4, 4.6, 0.3});
  add_fine_facet(scene.mesh, beacon, {0.7, 3.4, -0.3}, {0.3, 3.9, 0.2}, {1.2, 3.7, 0.9});
  scene.transmit = test::forward_tubes(fine_point({0.013, 0.021, 0.4}), 2, 1, 42, 64, 3);
  turn_rays(scene.transmit, {0, 1, 0}, 0.03);
  scene.receive = scene.transmit;
  if (with_surface) scene.paths.mirrors.surface = SeaSurface{fine_point({0, 0, 2.03}).z, 0.8, 0};
  return scene;
}

void with_separate_receiver(MirrorScene& scene) {
  scene.receive = test::forward_tubes(fine_point({0.61, -0.32, 0.13}), 2, 1, 46, 58, 5);
}

/// A parameter and the same change of a scene.
struct MirrorChange {
  std::string name;
  EchoParameter parameter;
  std::function<void(MirrorScene&, double)> apply;
};

MirrorChange sonar_moves(glm::dvec3 axis) {
  return {"sonar", EchoParameter::sonar_translation(axis), [axis](MirrorScene& s, double by) {
            const bool one = s.transmit.apex == s.receive.apex;
            move(s.transmit.apex, by * axis);
            one ? void(s.receive.apex = s.transmit.apex) : move(s.receive.apex, by * axis);
          }};
}

MirrorChange mounting_turns(glm::dvec3 axis) {
  return {"mounting", EchoParameter::mounting_rotation(axis), [axis](MirrorScene& s, double by) {
            turn_rays(s.transmit, axis, by);
            turn_rays(s.receive, axis, by);
          }};
}

MirrorChange sonar_turns(const MirrorScene& scene, glm::dvec3 axis) {
  const glm::dvec3 arm = in_metres(scene.receive.apex - scene.transmit.apex);
  MirrorChange change = mounting_turns(axis);
  return {"rotation", EchoParameter::sonar_rotation(axis),
          [turn = change.apply, arm, axis](MirrorScene& s, double by) {
            turn(s, by);
            s.receive.apex = fine_point(in_metres(s.transmit.apex) + glm::angleAxis(by, axis) * arm);
          }};
}

MirrorChange object_moves(const MirrorScene& scene, Component component, glm::dvec3 axis) {
  return {component == quay ? "quay" : "beacon",
          EchoParameter::object_translation(scene.mesh, component, axis), [=](MirrorScene& s, double by) {
            move_component(s, component, [&](glm::dvec3 p) { return p + by * axis; });
          }};
}

MirrorChange object_turns(const MirrorScene& scene, Component component, glm::dvec3 axis) {
  const glm::dvec3 origin(0.2, 7, -1);
  return {
      component == quay ? "turned quay" : "turned beacon",
      EchoParameter::object_rotation(scene.mesh, component, axis, origin - in_metres(scene.transmit.apex)),
      [=](MirrorScene& s, double by) {
        move_component(s, component,
                       [&](glm::dvec3 p) { return origin + glm::angleAxis(by, axis) * (p - origin); });
      }};
}

MirrorChange vertex_moves(VertexId vertex, glm::dvec3 axis) {
  EchoParameter parameter;
  parameter.velocity = [=](PointId id, glm::dvec3) { return id == vertex ? axis : glm::dvec3(0); };
  return {"vertex " + std::to_string(vertex), parameter,
          [=](MirrorScene& s, double by) { move(s.mesh.vertices[vertex], by * axis); }};
}

MirrorChange receiver_moves(glm::dvec3 axis) {
  EchoParameter parameter;
  parameter.velocity = [=](PointId id, glm::dvec3) { return id == receive_apex ? axis : glm::dvec3(0); };
  return {"receiver", parameter, [=](MirrorScene& s, double by) { move(s.receive.apex, by * axis); }};
}

MirrorChange more_absorption() {
  return {"absorption", EchoParameter::absorption(),
          [](MirrorScene& s, double by) { s.absorption_db_per_m += by; }};
}

MirrorChange faster_sound() {
  return {"sound speed", EchoParameter::sound_speed(15), [](MirrorScene& s, double by) {
            s.samples.first_m *= 1 + by / 15;
            s.samples.step_m *= 1 + by / 15;
            if (s.paths.mirrors.surface) s.paths.mirrors.surface->roughness /= (1 + by / 15) * (1 + by / 15);
          }};
}

MirrorChange more_mu() {
  return {"mu", EchoParameter::material_mu(0, 2), [](MirrorScene& s, double by) { s.mu[0] += by / 1000; }};
}

double largest_magnitude(const std::vector<double>& values) {
  double largest = 0;
  for (const double value : values) largest = std::max(largest, std::abs(value));
  return largest;
}

/// Compares each bin with differences of fourth order, whose steps are much larger than the rounding of
/// images and of their windows.
void expect_differences(const MirrorScene& scene, const std::vector<MirrorChange>& changes,
                        const std::function<bool(std::size_t)>& is_wanted = every_order,
                        double tolerance = 4e-5, double step = 0x1p-9) {
  std::vector<EchoParameter> parameters;
  for (const MirrorChange& change : changes) parameters.push_back(change.parameter);
  const std::vector<std::vector<double>> found = scene.derivatives(parameters, is_wanted);
  for (std::size_t n = 0; n < changes.size(); ++n) {
    SCOPED_TRACE(testing::Message() << n << ": " << changes[n].name);
    const auto at = [&](double by) {
      MirrorScene moved = scene;
      changes[n].apply(moved, by);
      return moved.energies(is_wanted);
    };
    const std::vector<double> a = at(step), b = at(-step), c = at(2 * step), d = at(-2 * step);
    const double unit = changes[n].name == "mu" ? 1000 : 1, largest = largest_magnitude(found[n]);
    EXPECT_GT(largest, 0);
    for (std::size_t k = 0; k < a.size(); ++k)
      EXPECT_NEAR(found[n][k], unit * (8 * (a[k] - b[k]) - (c[k] - d[k])) / (12 * step), tolerance * largest)
          << "bin " << k;
  }
}

std::vector<MirrorChange> motions(const MirrorScene& scene) {
  return {sonar_moves({1, 0, 0}),
          sonar_moves({0, 1, 0}),
          sonar_moves({0, 0, 1}),
          mounting_turns({0, 0, 1}),
          sonar_turns(scene, glm::normalize(glm::dvec3(1, 0.3, 0.2))),
          object_moves(scene, beacon, {1, 0, 0}),
          object_moves(scene, beacon, {0, 0, 1}),
          vertex_moves(3, {0, 0, 1}),
          more_absorption(),
          faster_sound(),
          more_mu()};
}

std::vector<MirrorChange> motions_with_quay(const MirrorScene& scene) {
  std::vector<MirrorChange> changes = motions(scene);
  for (const glm::dvec3 axis : {glm::dvec3(1, 0, 0), glm::dvec3(0, 1, 0), glm::dvec3(0, 0, 1)}) {
    changes.push_back(object_moves(scene, quay, axis));
    changes.push_back(object_turns(scene, quay, axis));
  }
  for (const VertexId vertex : scene.mesh.facets[2]) changes.push_back(vertex_moves(vertex, {0, 1, 0}));
  return changes;
}

TEST(PathDerivatives, UnderASeaSurfaceAreCentralDifferences) {
  for (const std::uint64_t seed : {4, 5}) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    MirrorScene scene = mirror_scene(seed, true, false);
    expect_differences(scene, motions(scene), [](std::size_t order) { return order == 2; });
    // The images do not see the facets in front of the terrain.
    std::vector<MirrorChange> of_terrain = motions(scene);
    std::erase_if(of_terrain, [](const MirrorChange& change) { return change.name == "beacon"; });
    expect_differences(scene, of_terrain, [](std::size_t order) { return order == 3; });
    scene.paths.mirrors.surface->roughness = 1.5;
    with_separate_receiver(scene);
    expect_differences(scene, motions(scene));
  }
}

// The wall between both beams is vertical. The image has a wall in the same plane, which turns the other way.
TEST(PathDerivatives, OfWallsInOnePlaneAreThoseOfTheReceiver) {
  MirrorScene scene = mirror_scene(5, true, false);
  scene.transmit = scene.receive = test::forward_tubes(scene.transmit.apex, 2, 1, 42, 64, 3);
  // Second derivatives jump at this pose.
  expect_differences(
      scene, {mounting_turns({0, 1, 0})}, [](std::size_t order) { return order == 2; }, 2e-4, 0x1p-11);
}

TEST(PathDerivatives, BeforeAMirrorFacetAreCentralDifferences) {
  for (const std::uint64_t seed : {3, 5}) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    MirrorScene scene = mirror_scene(seed, true, true);
    expect_differences(scene, motions_with_quay(scene));
    scene.paths.mirrors.surface->roughness = 1.5;
    with_separate_receiver(scene);
    expect_differences(scene, motions_with_quay(scene));
  }
}

TEST(PathDerivatives, OfModelsAndTexturesAreCentralDifferences) {
  MirrorScene scene = mirror_scene(5, true, true);
  ScatteringModel::Gsab parameters;
  parameters.specular = 0.2;
  parameters.specular_width_rad = 0.3;
  parameters.oblique = 0.01;
  parameters.oblique_exponent = 1.7;
  scene.scattering = {std::make_shared<const ScatteringModel>(ScatteringModel::gsab(parameters)), nullptr};
  scene.reflectivity = {test::perlin(1.5, 2), nullptr};
  scene.paths.mirrors.surface->roughness = 1.5;
  expect_differences(
      scene, {sonar_moves({0, 0, 1}), mounting_turns({0, 0, 1}), object_turns(scene, quay, {1, 0, 0})});
}

TEST(PathDerivatives, OfArrivalsAreCentralDifferences) {
  MirrorScene scene = mirror_scene(5, true, true);
  scene.paths.mirrors.surface->roughness = 1.5;
  scene.mu = {1e-30, 1e-30};
  scene.paths.arrivals = true;
  scene.samples = {0.1, 1, 30};
  // Ends that see each other, and a mirror that both see.
  scene.transmit = test::forward_tubes(fine_point({0.3, 1.5, 0.4}), 1, 1, 170, 170);
  scene.receive = test::forward_tubes(fine_point({-0.2, 1.52, 0.1}), 1, 1, 170, 170);
  turn_rays(scene.transmit, {0, 0, 1}, 0.3);
  turn_rays(scene.receive, {0, 0, 1}, -0.3);
  std::vector<MirrorChange> changes{sonar_moves({0, 1, 0}),
                                    sonar_moves({0, 0, 1}),
                                    sonar_turns(scene, {0, 0, 1}),
                                    object_moves(scene, quay, {0, 1, 0}),
                                    object_turns(scene, quay, {1, 0, 0}),
                                    more_absorption()};
  expect_differences(scene, changes);
  scene.paths.direct = true;
  expect_differences(scene, {receiver_moves({1, 0, 0}), receiver_moves({0, 1, 0}), more_absorption()});
  // The sound speed moves no arrival into another bin, but changes the roughness.
  expect_differences(scene, {faster_sound()}, every_order);
}

/// Velocity of everything relative to the transmitter.
EchoParameter everything(const PointVelocity& velocity) {
  EchoParameter parameter;
  parameter.velocity = velocity;
  return parameter;
}

TEST(PathDerivatives, OfARotationOfEverythingAreZero) {
  for (const bool with_surface : {false, true}) {
    SCOPED_TRACE(with_surface);
    MirrorScene scene = mirror_scene(3, with_surface, true);
    scene.paths.arrivals = true;
    if (with_surface) scene.paths.mirrors.surface->roughness = 1.5;
    with_separate_receiver(scene);
    // The sea surface stays level.
    const glm::dvec3 axis = with_surface ? glm::dvec3(0, 0, 1) : glm::dvec3(0.4, 0.7, -0.6);
    const auto turn = [axis](PointId, glm::dvec3 at) { return glm::cross(axis, at); };
    const std::vector<EchoParameter> parameters{everything(turn), everything([&](PointId id, glm::dvec3 at) {
                                                  return id & ray_bit ? glm::dvec3(0) : turn(id, at);
                                                })};
    const auto found = scene.derivatives(parameters, every_order);
    const double largest = largest_magnitude(found[1]);
    EXPECT_GT(largest, 0);
    EXPECT_LT(largest_magnitude(found[0]), 1e-8 * largest);
  }
}

// Energies have the factor s^-2 if all lengths have the factor s and the absorption 1 / s.
TEST(PathDerivatives, OfTheScaleOfEverythingAreMinusTwoEnergies) {
  for (const bool separate : {false, true}) {
    MirrorScene scene = mirror_scene(4, true, true);
    scene.paths.arrivals = true;
    scene.paths.mirrors.surface->roughness = 1.5;
    if (separate) with_separate_receiver(scene);
    EchoParameter scale = everything(
        [](PointId id, glm::dvec3 at) { return id & ray_bit && id != receive_apex ? glm::dvec3(0) : at; });
    scale.by_range_scale = 1;
    scale.by_absorption = -scene.absorption_db_per_m;
    const double height =
        metres_per_unit * (scene.paths.mirrors.surface->height - double(scene.transmit.apex.z));
    scale.apex_velocity = {0, 0, -height};
    const std::vector<EchoParameter> parameters{scale, EchoParameter::sonar_translation({0, 0, 1})};
    const std::vector<std::vector<double>> found = scene.derivatives(parameters, every_order);
    const std::vector<double> energies = scene.energies(every_order);
    for (std::size_t k = 0; k < energies.size(); ++k)
      EXPECT_NEAR(found[0][k], -2 * energies[k], 1e-7 * largest_magnitude(energies)) << k;
    EXPECT_GT(largest_magnitude(energies), 0);
  }
}

TEST(PathGradient, AgreesWithForwardMode) {
  for (const bool separate : {false, true}) {
    SCOPED_TRACE(separate);
    MirrorScene scene = mirror_scene(5, true, true);
    scene.paths.arrivals = true;
    scene.paths.mirrors.surface->roughness = 1.5;
    if (separate) with_separate_receiver(scene);
    const SceneTree tree(scene.mesh);
    const std::vector<std::uint32_t> beam = scene.beams();
    const PathSettings settings = scene.settings();
    Random random(1);
    std::uniform_real_distribution<double> uniform(-1, 1);
    const auto any = [&] { return glm::dvec3(uniform(random), uniform(random), uniform(random)); };
    std::vector<double> weights(beam.size() * std::size_t(scene.samples.count));
    for (double& weight : weights) weight = uniform(random);
    const EchoGradient gradient = path_gradient(scene.mesh, tree, metres_per_unit, {}, scene.transmit,
                                                scene.receive, {int(beam.size()), beam}, scene.samples,
                                                scene.model(), settings, weights, {}, every_order);
    std::vector<EchoParameter> parameters;
    std::vector<double> expected;
    const auto add = [&](const EchoParameter& parameter, double value) {
      parameters.push_back(parameter);
      expected.push_back(value);
    };
    glm::dvec3 translation = gradient.by_apex;
    for (const glm::dvec3& by : gradient.by_vertex) translation -= by;
    const auto turned = [](const TubeSet& tubes, const std::vector<glm::dvec3>& by, glm::dvec3 axis) {
      double sum = 0;
      for (std::size_t k = 0; k < by.size(); ++k)
        sum +=
            glm::dot(by[k], glm::cross(axis, glm::dvec3(tubes.rays[k].x, tubes.rays[k].y, tubes.rays[k].z)));
      return sum;
    };
    for (const glm::dvec3 axis : {glm::dvec3(1, 0, 0), glm::dvec3(0, 1, 0), glm::dvec3(0, 0, 1)}) {
      add(EchoParameter::sonar_translation(axis), glm::dot(translation, axis));
      const double own = turned(scene.transmit, gradient.by_ray, axis) +
                         turned(scene.receive, gradient.by_receive_ray, axis);
      add(EchoParameter::mounting_rotation(axis), own);
      const glm::dvec3 arm = in_metres(scene.receive.apex - scene.transmit.apex);
      add(EchoParameter::sonar_rotation(axis), own + glm::dot(gradient.by_receiver, glm::cross(axis, arm)));
    }
    std::vector<glm::dvec3> velocity;
    double of_vertices = 0;
    for (const glm::dvec3& by : gradient.by_vertex) {
      velocity.push_back(any());
      of_vertices += glm::dot(velocity.back(), by);
    }
    add(everything([&](PointId id, glm::dvec3) { return id & ray_bit ? glm::dvec3(0) : velocity[id]; }),
        of_vertices);
    add(EchoParameter::material_mu(0, 2), gradient.by_material_mu[0]);
    add(EchoParameter::absorption(), gradient.by_absorption);
    add(EchoParameter::sound_speed(1500), (gradient.by_range_scale - 2 * gradient.by_roughness) / 1500);
    const std::vector<std::vector<double>> found = scene.derivatives(parameters, every_order);
    for (std::size_t n = 0; n < parameters.size(); ++n) {
      double sum = 0, size = 0;
      for (std::size_t k = 0; k < weights.size(); ++k) {
        sum += weights[k] * found[n][k];
        size += std::abs(weights[k] * found[n][k]);
      }
      EXPECT_GT(size, 0) << n;
      EXPECT_NEAR(sum, expected[n], 1e-9 * size + 1e-13 * largest_magnitude(found[1])) << "parameter " << n;
    }
  }
}

TEST(PathDerivatives, OfHiddenVerticesAreZero) {
  MirrorScene scene = mirror_scene(3, true, true);
  const auto first = VertexId(scene.mesh.vertices.size());
  add_fine_facet(scene.mesh, beacon, {-1, 4, -6}, {1, 4, -6}, {0, 5, -5});
  std::vector<EchoParameter> parameters;
  for (VertexId vertex = first; vertex < first + 3; ++vertex)
    parameters.push_back(vertex_moves(vertex, {0.3, 0.5, 0.8}).parameter);
  for (const std::vector<double>& of : scene.derivatives(parameters, every_order))
    EXPECT_EQ(largest_magnitude(of), 0);
}

// Order 3 is a sonar at the image, 25 m above the seabed. It moves down if the sonar moves up. For order 2,
// one end moves up and the other down.
TEST(PathDerivatives, UnderALevelSeaSurfaceAreThoseOfTheImage) {
  const test::Setting s = test::under_surface(3);
  const SceneTree tree(s.mesh);
  const std::vector<std::uint32_t> beam(s.receive.tubes.size(), 0);
  PathSettings settings = s.paths;
  settings.mirrors.reflection = s.reflection;
  const std::vector<EchoParameter> parameters{EchoParameter::sonar_translation({0, 0, 1}),
                                              EchoParameter::sonar_translation({0.6, 0.8, 0}),
                                              EchoParameter::sonar_rotation({0, 0, 1})};
  const auto of = [&](std::size_t order) {
    return path_derivatives(s.mesh, tree, test::unit, {}, s.transmit, s.receive, {1, beam}, s.samples,
                            s.model(s.transmit), settings, parameters,
                            [=](std::size_t n) { return n == order; });
  };
  const std::vector<std::vector<double>> once = of(2), twice = of(3);
  for (std::size_t k = 0; k < once[0].size(); ++k) {
    const double from = 26 + double(k), to = from + 1, step = 1e-3;
    const double of_image = -0.36 * pi * 0.01 * 25 * (std::pow(from, -4) - std::pow(to, -4));
    EXPECT_NEAR(twice[0][k], of_image, 2e-7 * std::abs(of_image)) << k;
    const auto echo = [&](double up) {
      return 2 * 0.6 * (test::rings(0.01, 15 + up, 25 - up, to) - test::rings(0.01, 15 + up, 25 - up, from));
    };
    const double difference = (echo(step) - echo(-step)) / (2 * step);
    EXPECT_NEAR(once[0][k], difference, 1e-6 * std::abs(difference)) << k;
    for (const std::size_t n : {1, 2}) {
      EXPECT_NEAR(once[n][k], 0, 1e-7 * std::abs(difference)) << k;
      EXPECT_NEAR(twice[n][k], 0, 1e-7 * std::abs(of_image)) << k;
    }
  }
}

TEST(PathDerivatives, RejectsWhatHasNone) {
  MirrorScene scene = mirror_scene(3, true, true);
  scene.paths.scatterings = 2;
  EXPECT_THROW(scene.derivatives({}, every_order), std::invalid_argument);
  scene.paths.scatterings = 1;
  scene.paths.reference_tolerance = 1e-3;
  EXPECT_THROW(scene.derivatives({}, every_order), std::invalid_argument);
}

}  // namespace
}  // namespace tubefoot
