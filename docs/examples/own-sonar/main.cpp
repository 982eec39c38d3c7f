// SPDX-License-Identifier: GPL-3.0-or-later
// A sonar and an engine of one's own: a scanning sonar (one pencil beam that a motor turns all round), and an
// engine that sends one ray through the middle of each tube. The exact engine says how far the rays are off.
#include <cmath>
#include <cstdio>
#include <glm/geometric.hpp>
#include <limits>
#include <numbers>

#include "compare/measures/echo_errors.hpp"
#include "engine/echo/echo.hpp"
#include "engine/visibility/tube_engine.hpp"
#include "geometry/integrals/measure.hpp"
#include "scene/meshes/primitives.hpp"
#include "sensors/model/sensor.hpp"

using namespace tubefoot;

/// A sonar is its beams, its range samples and the tubes that cover what it looks at.
class ScanningSonar : public Sensor {
 public:
  ScanningSonar(int steps, double height_rad, RangeSamples samples) : Sensor(named("scanning sonar")) {
    frequency_khz_ = 675;
    samples_ = samples;
    const double width_rad = 2 * std::numbers::pi / steps;
    Transmission transmission;
    AngularGrid sector;
    for (int step = 0; step <= steps; ++step)
      sector.azimuth_edges_rad.push_back(-std::numbers::pi + step * width_rad);
    sector.elevation_edges_rad = {-height_rad / 2, height_rad / 2};
    // Columns: ahead (azimuth 0), starboard (azimuth 90 degrees), up, in the sensor's own axes.
    sector.frame = {glm::dvec3(0, 1, 0), glm::dvec3(1, 0, 0), glm::dvec3(0, 0, 1)};
    for (int step = 0; step < steps; ++step) {
      beams_.push_back({-std::numbers::pi + (step + 0.5) * width_rad, 0, width_rad, height_rad});
      transmission.beams.push_back(static_cast<std::uint32_t>(step));
      transmission.beam_of_tube.push_back(static_cast<std::uint32_t>(step));
    }
    transmission.sectors.push_back(sector);
    const auto all = static_cast<std::uint32_t>(steps);
    transmission.fans.push_back({0, all, all});
    transmissions_.push_back(transmission);
  }

 private:
  static SensorDescription named(const char* name) {
    SensorDescription description;
    description.name = name;
    return description;
  }
};

/// An engine fills a history. This one: where a tube's middle ray first meets a facet stands for all of the
/// tube.
History one_ray_a_tube(const FacetMesh& mesh, TubeSet tubes, double grid_unit_m) {
  const auto relative = [&](GridPoint p) {
    return grid_unit_m *
           glm::dvec3(double(p.x) - tubes.apex.x, double(p.y) - tubes.apex.y, double(p.z) - tubes.apex.z);
  };
  History history;
  history.grid_unit_m = grid_unit_m;
  for (std::uint32_t t = 0; t < tubes.tubes.size(); ++t) {
    glm::dvec3 ray(0);
    std::vector<glm::dvec3> corners;
    for (const std::uint32_t r : tubes.tubes[t]) {
      corners.push_back(glm::normalize(glm::dvec3(tubes.rays[r].x, tubes.rays[r].y, tubes.rays[r].z)));
      ray += corners.back();
    }
    ray = glm::normalize(ray);
    // As a polygon one metre off, the tube has the solid angle that the ray stands for.
    const FacetPlane screen{-ray, 1};
    for (glm::dvec3& c : corners) c /= glm::dot(c, ray);
    PlanarPolygon window;
    window.assign(corners, screen, PlaneFrame(screen));

    RayHit hit;
    hit.slant_range_m = std::numeric_limits<double>::infinity();
    for (FacetId f = 0; f < mesh.facets.size(); ++f) {
      const glm::dvec3 a = relative(mesh.vertices[mesh.facets[f][0]]),
                       b = relative(mesh.vertices[mesh.facets[f][1]]),
                       c = relative(mesh.vertices[mesh.facets[f][2]]);
      const glm::dvec3 normal = glm::normalize(glm::cross(b - a, c - a));
      const double range = glm::dot(a, normal) / glm::dot(ray, normal);
      const glm::dvec3 p = range * ray;
      const double side_a = glm::dot(glm::cross(b - a, p - a), normal),
                   side_b = glm::dot(glm::cross(c - b, p - b), normal),
                   side_c = glm::dot(glm::cross(a - c, p - c), normal);
      if (range > 0 && range < hit.slant_range_m && side_a >= 0 && side_b >= 0 && side_c >= 0)
        hit = {f, t, range, std::abs(glm::dot(ray, normal)), solid_angle(window), glm::vec3(ray)};
    }
    if (std::isfinite(hit.slant_range_m)) history.hits.push_back(hit);
  }
  history.tubes = std::move(tubes);
  return history;
}

int main() {
  // A box of 2 m on a seabed of 40 m, and the sonar 1.5 m above the seabed.
  const WorldGrid grid = WorldGrid::fitting(glm::dvec3(-20), glm::dvec3(20));
  MeshBuilder builder(grid);
  builder.add({{-20, -20, 0}, {20, -20, 0}, {20, 20, 0}, {-20, 20, 0}}, {{0, 1, 2}, {0, 2, 3}}, 0, 0);
  ComponentMesh box = box_facets({{2, 2, 2}}, {});
  for (glm::dvec3& p : box.points_m) p += glm::dvec3(4, 5, 1);
  builder.add(box.points_m, box.triangles, 1, 1);
  MeshReport report;
  const FacetMesh mesh = builder.finish(report);
  const SceneTree tree(mesh);

  const ScanningSonar sonar(360, 30 * std::numbers::pi / 180, {0.5, 0.05, 300});
  const Pose pose{{0, 0, 1.5}, attitude_from_angles(0, 0, 0)};
  const std::vector<double> mu{0.002, 0.1};  // of the seabed and of the box
  const EchoModel model{mu, mesh.material, 0.25};
  const auto echo_of = [&](const History& history) {
    return integrate_echo(history, {static_cast<int>(sonar.beams().size()), sonar.beam_of_tube()},
                          sonar.samples(), model);
  };

  const TubeEngine tubes(mesh, tree, grid.unit_m(), {});
  const Echo exact = echo_of(tubes.trace(sonar.tubes(pose, grid))),
             sampled = echo_of(one_ray_a_tube(mesh, sonar.tubes(pose, grid), grid.unit_m()));

  std::vector<double> ranges;
  for (int k = 0; k < sonar.samples().count; ++k)
    ranges.push_back(sonar.samples().first_m + (k + 0.5) * sonar.samples().step_m);
  const EchoErrors errors =
      echo_errors({{1, sonar.beams().size(), ranges.size()}, exact.energy, sampled.energy, {}, ranges});
  std::printf("exact: %.6e J/m2 in %zu lit bins; one ray a tube: %.6e J/m2, relative L1 error %.3f\n",
              errors.reference_total_j, errors.lit_bins, errors.candidate_total_j, errors.l1);
}
