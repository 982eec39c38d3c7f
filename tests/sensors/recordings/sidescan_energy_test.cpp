// SPDX-License-Identifier: GPL-3.0-or-later
// Compares the energy of sidescan samples with that of the footprints. The test integrates each footprint
// separately by plain subdivision.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <fstream>
#include <glm/geometric.hpp>
#include <numeric>

#include "engine/visibility/tube_engine.hpp"
#include "fixtures/world/recordings.hpp"
#include "scene/scene.hpp"
#include "sensors/kinds/scene_file.hpp"

namespace tubefoot {
namespace {

constexpr double absorption_db_per_m = 0.11;

/// Lambert's law, spreading and absorption on both legs, per area at a position relative to the apex.
double model(glm::dvec3 place, glm::dvec3 normal, double mu) {
  const double range = glm::length(place), sine = std::abs(glm::dot(place, normal)) / range;
  return mu * sine * sine * std::pow(range, -4) * std::pow(10, -2 * absorption_db_per_m * range / 10);
}

/// Radon's rule of seven points, exact to degree 5. A triangle is cut into four until it is small relative
/// to its range.
double over_triangle(glm::dvec3 a, glm::dvec3 b, glm::dvec3 c, glm::dvec3 normal, double mu, int depth = 0) {
  const double longest = std::max({glm::distance(a, b), glm::distance(b, c), glm::distance(c, a)});
  if (longest > 0.04 * glm::length(a) && depth < 12) {
    const glm::dvec3 ab = (a + b) / 2.0, bc = (b + c) / 2.0, ca = (c + a) / 2.0;
    return over_triangle(a, ab, ca, normal, mu, depth + 1) + over_triangle(ab, b, bc, normal, mu, depth + 1) +
           over_triangle(ca, bc, c, normal, mu, depth + 1) + over_triangle(ab, bc, ca, normal, mu, depth + 1);
  }
  const double root = std::sqrt(15.0), near = (6 - root) / 21, far = (6 + root) / 21;
  double mean = 0.225 * model((a + b + c) / 3.0, normal, mu);
  for (const auto& [s, weight] : {std::pair{near, (155 - root) / 1200}, std::pair{far, (155 + root) / 1200}})
    for (const auto& p :
         {std::array{1 - 2 * s, s, s}, std::array{s, 1 - 2 * s, s}, std::array{s, s, 1 - 2 * s}})
      mean += weight * model(p[0] * a + p[1] * b + p[2] * c, normal, mu);
  return mean * glm::length(glm::cross(b - a, c - a)) / 2;
}

double over_footprint(const FootprintSet& set, const Footprint& footprint, double mu) {
  double energy = 0;
  for (std::uint32_t p = 0; p < footprint.piece_count; ++p) {
    const Piece& piece = set.pieces[footprint.first_piece + p];
    for (std::uint32_t k = 2; k < piece.count; ++k)
      energy += over_triangle(set.corners_m[piece.first], set.corners_m[piece.first + k - 1],
                              set.corners_m[piece.first + k], footprint.plane_normal, mu);
  }
  return energy;
}

TEST(Sidescan, SamplesAddUpToTheFootprints) {
  const TestFolder folder;
  std::ofstream(folder / "scene.toml") << R"(
[[materials]]
name = "sand"
lambert_db = -20
[[materials]]
name = "steel"
lambert_db = -8
[[terrain]]
kind = "fractal"
material = "sand"
width_m = 60
length_m = 20
cell_m = 1.5
rms_height_m = 0.4
seed = 5
[[objects]]
name = "drum"
shape = "cylinder"
material = "steel"
position_m = [-9, 0, 0.5]
[trajectory]
kind = "fixed"
position_m = [0, 0, 6]
heading_deg = 4
[[sensors]]
name = "fish"
kind = "sidescan"
along_track_deg = 2
range_min_m = 1
range_max_m = 60
samples = 1180
)";
  const Scene scene = load_scene(read_scene_file(folder / "scene.toml"));
  const SceneTree tree(scene.mesh);
  const auto sensor = make_sensor(scene.description.sensors.front());
  TubeEngine engine(scene.mesh, tree, scene.grid.unit_m(), {});
  const Pose pose = sensor->pose_on(scene.trajectories.front().at(0));
  const History history = engine.trace(sensor->tubes(pose, scene.grid));
  const EchoModel echo_model{scene.material_mu, scene.mesh.material, absorption_db_per_m};
  const Echo echo = integrate_echo(history, {2, sensor->beam_of_tube()}, sensor->samples(), echo_model);

  std::array<double, 2> expected{};
  for (const Footprint& footprint : history.footprints.footprints)
    expected[sensor->beam_of_tube()[footprint.tube]] += over_footprint(
        history.footprints, footprint, scene.material_mu[scene.mesh.material[footprint.facet]]);
  EXPECT_GT(history.footprints.footprints.size(), 100u);
  for (std::size_t beam = 0; beam < 2; ++beam) {
    const auto begin = echo.energy.begin() + static_cast<std::ptrdiff_t>(beam * 1180);
    EXPECT_NEAR(std::accumulate(begin, begin + 1180, 0.0) / expected[beam], 1, 1e-8) << beam;
  }
  EXPECT_GT(expected[0], 1.2 * expected[1]);  // the drum lies to port
}

}  // namespace
}  // namespace tubefoot
