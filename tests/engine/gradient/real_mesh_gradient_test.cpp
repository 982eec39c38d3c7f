// SPDX-License-Identifier: GPL-3.0-or-later
// Tests laws of derivatives on meshes of a lake, of a fjord and of a subsea panel, from random positions. An
// object in front hides a part of each mesh.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <glm/geometric.hpp>
#include <random>
#include <set>

#include "fixtures/world/differentiated_scenes.hpp"
#include "geometry/numbers/scalars.hpp"
#include "scene/meshes/mesh_file.hpp"

namespace tubefoot {
namespace {

using test::GradientScene;
using test::Random;

constexpr int real_beams = 8;

struct RealMesh {
  const char* file;
  double scale, height_m, ahead_m;  ///< height of the sonar, and the distance of the object from it
  double panel_scale;
  RangeSamples samples;
  std::array<std::uint64_t, 2> seeds;
};
constexpr double no_height = 0;  ///< the mesh lies ahead of the sonar, not below it
const std::vector<RealMesh> real_meshes{{"lake_bottom.obj", 1, 12, 14, 4, {3, 7, 40}, {4, 5}},
                                        {"munkholmen_seabed.obj", 1, 40, 30, 10, {10, 20, 40}, {1, 3}},
                                        {"bop_panel.obj", 10, no_height, 4, 1, {2, 0.25, 40}, {2, 3}}};

/// Component 0 is the mesh, component 1 the object in front of it. Tubes have exact walls: the rays of each
/// border of the fan lie in one plane.
struct RealView {
  std::string name;
  GradientScene scene;
  History history{};
  std::vector<double> energies{};

  std::vector<std::vector<double>> derivatives(std::span<const EchoParameter> parameters) const {
    const std::vector<std::uint32_t> beams = scene.beam_of_tube();
    return echo_derivatives(scene.mesh, history, {int(beams.size()), beams}, scene.samples, scene.model(),
                            parameters);
  }
  EchoGradient gradient(const std::vector<double>& weights) const {
    const std::vector<std::uint32_t> beams = scene.beam_of_tube();
    return echo_gradient(scene.mesh, history, {int(beams.size()), beams}, scene.samples, scene.model(),
                         weights);
  }
  void trace() {
    const std::vector<std::uint32_t> beams = scene.beam_of_tube();
    history = scene.history();
    energies = integrate_echo(history, {int(beams.size()), beams}, scene.samples, scene.model()).energy;
  }
};

double uniform_real(Random& random, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(random);
}
glm::dvec3 random_vector(Random& random) {
  return {uniform_real(random, -1, 1), uniform_real(random, -1, 1), uniform_real(random, -1, 1)};
}

GridPoint rounded(glm::dvec3 v) {
  return {std::int32_t(std::lround(v.x)), std::int32_t(std::lround(v.y)), std::int32_t(std::lround(v.z))};
}

/// Tubes side by side over 60 x 40 degrees ahead, in `columns` columns of equal width on a plane.
void add_fan(TubeSet& tubes, glm::dvec3 ahead, int columns) {
  const glm::dvec3 right = glm::normalize(glm::cross(ahead, glm::dvec3(0, 0, 1))),
                   up = glm::cross(right, ahead);
  const double size = 0x1p27;
  const GridPoint f = rounded(size * ahead), r = rounded(size * std::tan(30 * degree) / real_beams * right),
                  u = rounded(size * std::tan(20 * degree) * up);
  for (int i = -real_beams; i <= real_beams; i += 2 * real_beams / columns)
    for (const int j : {-1, 1})
      tubes.rays.push_back({f.x + i * r.x + j * u.x, f.y + i * r.y + j * u.y, f.z + i * r.z + j * u.z});
  for (std::uint32_t k = 0; k < std::uint32_t(columns); ++k)
    tubes.tubes.push_back({2 * k, 2 * k + 1, 2 * k + 3, 2 * k + 2});
}

NamedMesh real_mesh(const char* file) {
  return read_mesh_file(std::filesystem::path(TUBEFOOT_SOURCE_DIR) / "scenes/data" / file,
                        {.up = "y", .unit_m = {}});
}

/// Turns a mesh about the vertical, scales it, and moves the centre of its bounding box.
void place_mesh(ComponentMesh& mesh, double scale, double turn, glm::dvec3 centre) {
  glm::dvec3 low(infinite), high(-infinite);
  for (glm::dvec3& p : mesh.points_m) {
    p = scale * glm::dvec3(std::cos(turn) * p.x - std::sin(turn) * p.y,
                           std::sin(turn) * p.x + std::cos(turn) * p.y, p.z);
    low = glm::min(low, p);
    high = glm::max(high, p);
  }
  for (glm::dvec3& p : mesh.points_m) p += centre - 0.5 * (low + high);
}

RealView real_view(const RealMesh& real, std::uint64_t seed) {
  Random random(seed);
  RealView view{std::string(real.file) + ", seed " + std::to_string(seed), {}};
  GradientScene& scene = view.scene;
  NamedMesh mesh = real_mesh(real.file), object = real_mesh("bop_panel.obj");
  const double azimuth = uniform_real(random, -pi, pi);
  const bool below = real.height_m != no_height;
  const double tilt = below ? 0.25 : uniform_real(random, -0.2, 0.2);
  const glm::dvec3 ahead{std::cos(tilt) * std::sin(azimuth), std::cos(tilt) * std::cos(azimuth),
                         -std::sin(tilt)};
  glm::dvec3 apex(0);
  if (below) {
    // Above a point of the mesh near its centre.
    place_mesh(mesh, real.scale, 0, glm::dvec3(0));
    std::vector<glm::dvec3> near;
    for (const glm::dvec3& p : mesh.points_m)
      if (std::hypot(p.x, p.y) < 200) near.push_back(p);
    apex = near.at(std::size_t(uniform_real(random, 0, 1) * double(near.size()))) +
           glm::dvec3(0, 0, real.height_m * uniform_real(random, 1, 1.5));
  } else {
    place_mesh(mesh, real.scale, azimuth + uniform_real(random, -0.5, 0.5), 8.0 * ahead);
  }
  place_mesh(object, real.panel_scale, uniform_real(random, 0, pi), apex + real.ahead_m * ahead);
  glm::dvec3 low = apex, high = apex;
  for (const ComponentMesh* each : {&mesh, &object})
    for (const glm::dvec3& p : each->points_m) {
      low = glm::min(low, p);
      high = glm::max(high, p);
    }
  const WorldGrid grid = WorldGrid::fitting(low, high);
  MeshBuilder builder(grid);
  builder.add(mesh.points_m, mesh.triangles, 0, 0);
  builder.add(object.points_m, object.triangles, 0, 1);
  MeshReport report;
  scene.mesh = builder.finish(report);
  scene.unit_m = grid.unit_m();
  scene.tubes.apex = grid.snap(apex);
  scene.tubes.reach = real.samples.border_m(real.samples.count) / scene.unit_m;
  add_fan(scene.tubes, ahead, real_beams);
  scene.samples = real.samples;
  scene.absorption_db_per_m = 0.3 / real.samples.border_m(real.samples.count);
  view.trace();
  return view;
}

const std::vector<RealView>& real_views() {
  static const std::vector<RealView> views = [] {
    std::vector<RealView> all;
    for (const RealMesh& real : real_meshes)
      for (const std::uint64_t seed : real.seeds) all.push_back(real_view(real, seed));
    return all;
  }();
  return views;
}

std::set<FacetId> visible_facets(const RealView& view, std::uint16_t component) {
  std::set<FacetId> all;
  for (const Footprint& footprint : view.history.footprints.footprints)
    if (view.scene.mesh.component[footprint.facet] == component) all.insert(footprint.facet);
  return all;
}

/// Returns by vertex whether a visible polygon names it, by its facet or by a corner.
std::vector<bool> named_vertices(const RealView& view) {
  const FootprintSet& set = view.history.footprints;
  const FacetMesh& mesh = view.scene.mesh;
  std::vector<bool> named(mesh.vertices.size());
  const auto add_point = [&](PointId id) {
    if (!(id & ray_bit)) named.at(id) = true;
  };
  const auto add_all_of = [&](FacetId facet) {
    for (const VertexId v : mesh.facets.at(facet)) named[v] = true;
  };
  for (const Footprint& footprint : set.footprints) add_all_of(footprint.facet);
  for (const CornerName& corner : set.corner_names) {
    add_point(corner.point);
    if (corner.point != no_point) continue;
    for (const PlaneName& plane : {corner.p, corner.q})
      for (const std::uint32_t id : {plane.a, plane.b}) plane.depth ? add_all_of(id) : add_point(id);
  }
  return named;
}

double largest_of(const std::vector<double>& values) {
  double largest = 0;
  for (const double value : values) largest = std::max(largest, std::abs(value));
  return largest;
}

/// Expects that parts cancel each other in each bin, relative to the sum of their magnitudes.
void expect_sum_is_zero(std::span<const std::vector<double>> parts, double tolerance) {
  int filled = 0;
  for (std::size_t k = 0; k < parts[0].size(); ++k) {
    double sum = 0, size = 0;
    for (const std::vector<double>& part : parts) {
      sum += part[k];
      size += std::abs(part[k]);
    }
    filled += size > 0;
    EXPECT_LE(std::abs(sum), tolerance * size) << k;
  }
  EXPECT_GT(filled, 50);
}

// The object hides a part of the mesh: polygons of the mesh have corners on planes of the object's edges.
TEST(GradientOfRealMeshes, IsThatOfManyFacetsAndOfShadows) {
  for (const RealView& view : real_views()) {
    SCOPED_TRACE(view.name);
    const FacetMesh& mesh = view.scene.mesh;
    EXPECT_GT(visible_facets(view, 0).size(), 400u);
    EXPECT_GT(visible_facets(view, 1).size(), 1000u);
    std::vector<bool> of_object(mesh.vertices.size());
    for (std::size_t f = 0; f < mesh.facets.size(); ++f)
      if (mesh.component[f] == 1)
        for (const VertexId v : mesh.facets[f]) of_object[v] = true;
    const FootprintSet& set = view.history.footprints;
    std::size_t shadow_corners = 0;
    for (const Footprint& footprint : set.footprints)
      for (std::uint32_t p = 0; p < footprint.piece_count && mesh.component[footprint.facet] == 0; ++p) {
        const Piece& piece = set.pieces[footprint.first_piece + p];
        for (std::uint32_t c = 0; c < piece.count; ++c)
          for (const PlaneName& plane :
               {set.corner_names[piece.first + c].p, set.corner_names[piece.first + c].q})
            shadow_corners += plane.a != no_point && !plane.depth && !((plane.a | plane.b) & ray_bit) &&
                              of_object[plane.a] && of_object[plane.b];
      }
    EXPECT_GT(shadow_corners, 1000u);
  }
}

/// Translations of the sonar and of all components, which cancel, and then rotations about one point. The
/// vectors are multiples of 1/256, so that their product is exact.
constexpr std::size_t translations = 3;
std::vector<EchoParameter> rigid_motions(const FacetMesh& mesh) {
  Random random(3);
  const auto rounded_vector = [&](double size) {
    return glm::round(256.0 * size * random_vector(random)) / 256.0;
  };
  const glm::dvec3 axis = rounded_vector(1), centre = rounded_vector(5);
  return {EchoParameter::sonar_translation(axis), EchoParameter::object_translation(mesh, 0, axis),
          EchoParameter::object_translation(mesh, 1, axis),
          // A rotation about a point other than the apex moves the apex too.
          EchoParameter::sonar_rotation(axis), EchoParameter::sonar_translation(glm::cross(axis, -centre)),
          EchoParameter::object_rotation(mesh, 0, axis, centre),
          EchoParameter::object_rotation(mesh, 1, axis, centre)};
}

TEST(GradientOfRealMeshes, OfARigidMotionOfEverythingIsZero) {
  for (const RealView& view : real_views()) {
    SCOPED_TRACE(view.name);
    const auto found = view.derivatives(rigid_motions(view.scene.mesh));
    expect_sum_is_zero(std::span(found).first(translations), 1e-10);
    expect_sum_is_zero(std::span(found).subspan(translations), 1e-10);
  }
}

// Sums of enclosures contain 0. Balls take long, so that one beam of one view per mesh takes part.
TEST(GradientOfRealMeshes, LiesInEnclosuresWhichHaveTheSameLaw) {
  for (std::size_t v = 0; v < real_views().size(); v += 2) {
    RealView view = real_views()[v];
    SCOPED_TRACE(view.name);
    view.scene.tubes.tubes = {view.scene.tubes.tubes[real_beams / 2]};
    view.trace();
    const std::vector<EchoParameter> parameters = rigid_motions(view.scene.mesh);
    const CertifiedDerivatives enclosed = view.scene.certified(view.history, parameters);
    const auto found = view.derivatives(parameters);
    const auto expect_zero = [&](std::size_t first, std::size_t end) {
      for (std::size_t k = 0; k < view.energies.size(); ++k) {
        long double sum = 0, bound = 0;
        for (std::size_t n = first; n < end; ++n) {
          sum += enclosed.value[n][k];
          bound += enclosed.bound[n][k];
        }
        EXPECT_LE(std::abs(sum), bound) << k;
      }
    };
    expect_zero(0, translations);
    expect_zero(translations, parameters.size());
    for (std::size_t n = 0; n < parameters.size(); ++n) {
      const double largest = largest_of(enclosed.value[n]);
      ASSERT_GT(largest, 0) << n;
      EXPECT_LT(largest_of(enclosed.bound[n]), 1e-14 * largest) << n;
      for (std::size_t k = 0; k < found[n].size(); ++k)
        EXPECT_NEAR(found[n][k], enclosed.value[n][k], 1e-12 * largest) << n << " " << k;
    }
  }
}

// Energies scale as s^-2 if all lengths scale by s, and the absorption by 1 / s.
TEST(GradientOfRealMeshes, OfAScaleOfEverythingIsMinusTwiceTheEnergy) {
  for (const RealView& view : real_views()) {
    SCOPED_TRACE(view.name);
    EchoParameter longer{[](PointId id, glm::dvec3 at) { return id & ray_bit ? glm::dvec3(0) : at; }}, ranges,
        absorption;
    ranges.by_range_scale = 1;
    absorption.by_absorption = -view.scene.absorption_db_per_m;
    auto parts = view.derivatives(std::vector{longer, ranges, absorption});
    parts.push_back(view.energies);
    for (double& energy : parts.back()) energy *= 2;
    expect_sum_is_zero(parts, 1e-12);
  }
}

TEST(GradientOfRealMeshes, OfVerticesWithoutANameIsZero) {
  for (const RealView& view : real_views()) {
    SCOPED_TRACE(view.name);
    const std::vector<bool> named = named_vertices(view);
    const EchoGradient gradient = view.gradient(std::vector<double>(view.energies.size(), 1));
    std::size_t hidden = 0, moved = 0;
    for (std::size_t v = 0; v < named.size(); ++v) {
      if (named[v]) {
        moved += gradient.by_vertex[v] != glm::dvec3(0);
        continue;
      }
      ++hidden;
      EXPECT_EQ(gradient.by_vertex[v], glm::dvec3(0)) << v;
    }
    EXPECT_GT(hidden, 500u);
    EXPECT_GT(moved, 200u);
  }
}

// Small motions of such vertices do not change energies. The panel is not such a mesh: it has coincident
// facets, and the motion of a hidden one makes it visible.
TEST(GradientOfRealMeshes, OfVerticesWithoutANameIsTheDifferenceOfEnergies) {
  for (const RealView& view : real_views()) {
    if (view.name.starts_with("bop_panel")) continue;
    SCOPED_TRACE(view.name);
    const std::vector<bool> named = named_vertices(view);
    RealView other = view, named_moved = view;
    Random random(5);
    const auto move = [&](RealView& moved, VertexId v) {
      for (std::int32_t GridPoint::*x : {&GridPoint::x, &GridPoint::y, &GridPoint::z})
        moved.scene.mesh.vertices[v].*x += test::uniform(random, -64, 64);
    };
    std::set<VertexId> of_mesh;
    for (std::size_t f = 0; f < view.scene.mesh.facets.size(); ++f)
      if (view.scene.mesh.component[f] == 0)
        of_mesh.insert(view.scene.mesh.facets[f].begin(), view.scene.mesh.facets[f].end());
    for (const VertexId v : of_mesh) move(named[v] ? named_moved : other, v);
    other.trace();
    named_moved.trace();
    const double largest = largest_of(view.energies);
    double changed = 0;
    for (std::size_t k = 0; k < view.energies.size(); ++k) {
      EXPECT_NEAR(other.energies[k], view.energies[k], 1e-13 * largest) << k;
      changed = std::max(changed, std::abs(named_moved.energies[k] - view.energies[k]));
    }
    EXPECT_GT(changed, 1e-9 * largest);
  }
}

// The walls between the beams of a fan are borders of both neighbours.
TEST(GradientOfRealMeshes, OfTheSumOfBeamsIsThatOfOneBeamOfTheSameFan) {
  for (const RealView& view : real_views()) {
    SCOPED_TRACE(view.name);
    RealView wide = view;
    const std::vector<GridPoint> rays = view.scene.tubes.rays;
    wide.scene.tubes.rays = {rays[0], rays[1], rays[rays.size() - 2], rays.back()};
    wide.scene.tubes.tubes = {{0, 1, 3, 2}};
    wide.trace();
    const FacetMesh& mesh = view.scene.mesh;
    const glm::dvec3 axis(0.3, -0.5, 0.8);
    const std::vector<EchoParameter> parameters{EchoParameter::sonar_translation(axis),
                                                EchoParameter::sonar_rotation(axis),
                                                EchoParameter::object_translation(mesh, 1, axis),
                                                EchoParameter::object_rotation(mesh, 1, axis, {1, 2, 3}),
                                                EchoParameter::object_translation(mesh, 0, axis),
                                                EchoParameter::material_mu(0, 1),
                                                EchoParameter::absorption(),
                                                EchoParameter::sound_speed(1500)};
    const auto of_fan = view.derivatives(parameters), of_one = wide.derivatives(parameters);
    for (std::size_t n = 0; n < parameters.size(); ++n) {
      const double size = largest_of(of_fan[n]);
      EXPECT_GT(size, 0) << n;
      const std::size_t bins = of_one[n].size();
      for (std::size_t k = 0; k < bins; ++k) {
        double sum = 0;
        for (std::size_t beam = 0; beam < real_beams; ++beam) sum += of_fan[n][beam * bins + k];
        EXPECT_NEAR(of_one[n][k], sum, 1e-12 * size) << n << " " << k;
      }
    }
  }
}

// The product of a random velocity of each point with the gradient, and of random weights with derivatives.
TEST(GradientOfRealMeshes, OfForwardModeAgreesWithReverseMode) {
  for (const RealView& view : real_views()) {
    SCOPED_TRACE(view.name);
    Random random(4);
    const FootprintSet& set = view.history.footprints;
    std::vector<double> weights(view.energies.size());
    for (double& weight : weights) weight = uniform_real(random, -1, 1);
    std::vector<glm::dvec3> of_vertex(view.scene.mesh.vertices.size()), of_ray(set.name_rays.size());
    for (glm::dvec3& velocity : of_vertex) velocity = random_vector(random);
    for (glm::dvec3& velocity : of_ray) velocity = 1e8 * random_vector(random);
    EchoParameter all{
        [&](PointId id, glm::dvec3) { return id & ray_bit ? of_ray[id & ~ray_bit] : of_vertex[id]; }};
    all.by_range_scale = uniform_real(random, -1, 1);
    all.by_absorption = uniform_real(random, -1, 1);
    all.by_mu = {uniform_real(random, -1, 1)};
    const std::vector<double> forward = view.derivatives(std::vector{all})[0];
    double expected = 0, size = 0, found = 0;
    const auto add = [&](double part) {
      expected += part;
      size += std::abs(part);
    };
    const EchoGradient gradient = view.gradient(weights);
    for (std::size_t v = 0; v < of_vertex.size(); ++v) add(glm::dot(of_vertex[v], gradient.by_vertex[v]));
    for (std::size_t r = 0; r < of_ray.size(); ++r) add(glm::dot(of_ray[r], gradient.by_ray[r]));
    add(all.by_range_scale * gradient.by_range_scale);
    add(all.by_absorption * gradient.by_absorption);
    add(all.by_mu[0] * gradient.by_material_mu[0]);
    for (std::size_t k = 0; k < weights.size(); ++k) found += weights[k] * forward[k];
    ASSERT_GT(size, 0);
    EXPECT_NEAR(found, expected, 1e-12 * size);
  }
}

// A box behind the largest visible part of the mesh.
TEST(GradientOfRealMeshes, OfAHiddenObjectIsZero) {
  for (const RealView& view : real_views()) {
    SCOPED_TRACE(view.name);
    RealView with = view;
    const auto& seen = view.history.footprints.footprints;
    const auto largest = std::ranges::max_element(seen, {}, &Footprint::solid_angle_sr);
    const double size = std::sqrt(largest->solid_angle_sr) * glm::length(largest->centroid_m);
    const double unit = view.scene.unit_m;
    const double range = glm::length(largest->centroid_m);
    const GridPoint centre =
        with.scene.tubes.apex - rounded(-(1 + 0.1 * size / range) / unit * largest->centroid_m);
    FacetMesh& mesh = with.scene.mesh;
    const std::size_t first = mesh.vertices.size(), facets = mesh.facets.size();
    test::add_box(mesh, centre, std::int32_t(0.02 * size / unit));
    std::fill(mesh.component.begin() + std::ptrdiff_t(facets), mesh.component.end(), std::uint16_t(2));
    with.trace();
    EXPECT_TRUE(visible_facets(with, 2).empty());
    const auto found =
        with.derivatives(std::vector{EchoParameter::object_translation(mesh, 2, {0.6, 0, 0.8}),
                                     EchoParameter::object_rotation(mesh, 2, {0, 1, 0}, {1, 2, 3})});
    EXPECT_EQ(largest_of(found[0]), 0);
    EXPECT_EQ(largest_of(found[1]), 0);
    const EchoGradient gradient = with.gradient(std::vector<double>(with.energies.size(), 1));
    for (std::size_t v = first; v < mesh.vertices.size(); ++v)
      EXPECT_EQ(gradient.by_vertex[v], glm::dvec3(0)) << v;
  }
}

}  // namespace
}  // namespace tubefoot
