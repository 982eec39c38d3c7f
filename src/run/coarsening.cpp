// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/coarsening.hpp"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>
#include <limits>
#include <span>

#include "files/memory_at_hand.hpp"
#include "geometry/mesh/coarsened.hpp"
#include "geometry/steps/stop.hpp"

// This file computes the length that the sensors resolve on each facet. It replaces the facets of a scene by
// fewer facets within a fraction of this length (docs/accuracy-and-speed.md).

namespace tubefoot {
namespace {

glm::dvec3 vector_of(GridPoint p) { return {p.x, p.y, p.z}; }

/// Finds the distance to the nearest of a set of points, with a binary tree.
class NearestTransducer {
 public:
  explicit NearestTransducer(std::vector<glm::dvec3> points) : points_(std::move(points)) {
    axis_.resize(points_.size());
    sort(0, points_.size());
  }

  double distance(const glm::dvec3& from) const {
    double least = std::numeric_limits<double>::infinity();
    look(0, points_.size(), from, least);
    return std::sqrt(least);
  }

 private:
  void sort(std::size_t first, std::size_t last) {
    if (last - first < 2) return;
    glm::dvec3 lo = points_[first], hi = lo;
    for (std::size_t k = first; k < last; ++k) lo = glm::min(lo, points_[k]), hi = glm::max(hi, points_[k]);
    const glm::dvec3 size = hi - lo;
    const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    const std::size_t middle = (first + last) / 2;
    const auto at = [&](std::size_t k) { return points_.begin() + static_cast<std::ptrdiff_t>(k); };
    std::nth_element(at(first), at(middle), at(last),
                     [=](const glm::dvec3& a, const glm::dvec3& b) { return a[axis] < b[axis]; });
    axis_[middle] = static_cast<std::uint8_t>(axis);
    sort(first, middle);
    sort(middle + 1, last);
  }

  void look(std::size_t first, std::size_t last, const glm::dvec3& from, double& least) const {
    if (first == last) return;
    const std::size_t middle = (first + last) / 2;
    const glm::dvec3 away = from - points_[middle];
    least = std::min(least, glm::dot(away, away));
    const double side = away[axis_[middle]];
    const auto before = [&] { look(first, middle, from, least); };
    const auto behind = [&] { look(middle + 1, last, from, least); };
    side < 0 ? before() : behind();
    if (side * side < least) side < 0 ? behind() : before();
  }

  std::vector<glm::dvec3> points_;
  std::vector<std::uint8_t> axis_;
};

/// Positions of a sensor and its resolution. Lengths are in grid units.
struct Looks {
  NearestTransducer places;
  double sample, beam_rad, reach;

  /// Returns the resolved length on facets whose nearest point is at this distance or beyond.
  double resolved_at(double distance) const {
    // The bound distance / 2 keeps every facet away from the sonar.
    return distance > reach ? std::numeric_limits<double>::infinity()
                            : std::min({sample, beam_rad * distance, distance / 2});
  }
};

Looks looks_of(const SensorPings& pings, const WorldGrid& grid) {
  std::vector<glm::dvec3> places;
  for (const auto* poses : {&pings.transmission_poses, &pings.receiver_poses})
    for (const Pose& pose : *poses) places.push_back(vector_of(grid.snap(pose.position_m)));
  const SensorFigures figures = figures_of(pings.sensor->description());
  return {NearestTransducer(std::move(places)), figures.sample_m / grid.unit_m(),
          glm::radians(figures.beam_deg), pings.sensor->reach(grid)};
}

struct Box {
  GridPoint lo, hi;
};

Box box_of(const FacetMesh& mesh, FacetId facet) {
  Box box{mesh.vertices[mesh.facets[facet][0]], mesh.vertices[mesh.facets[facet][0]]};
  for (const VertexId v : mesh.facets[facet]) {
    const GridPoint p = mesh.vertices[v];
    box.lo = {std::min(box.lo.x, p.x), std::min(box.lo.y, p.y), std::min(box.lo.z, p.z)};
    box.hi = {std::max(box.hi.x, p.x), std::max(box.hi.y, p.y), std::max(box.hi.z, p.z)};
  }
  return box;
}

/// Returns a lower bound of the distance between points of the two boxes.
double gap(const Box& a, const Box& b) {
  const auto apart = [](std::int64_t a_lo, std::int64_t a_hi, std::int64_t b_lo, std::int64_t b_hi) {
    return static_cast<double>(std::max({std::int64_t{0}, b_lo - a_hi, a_lo - b_hi}));
  };
  return glm::length(glm::dvec3(apart(a.lo.x, a.hi.x, b.lo.x, b.hi.x), apart(a.lo.y, a.hi.y, b.lo.y, b.hi.y),
                                apart(a.lo.z, a.hi.z, b.lo.z, b.hi.z)));
}

bool share_a_corner(const std::array<VertexId, 3>& a, const std::array<VertexId, 3>& b) {
  return std::ranges::any_of(a, [&](VertexId v) { return std::ranges::find(b, v) != b.end(); });
}

/// Limits the displacement to half of the distance to facets of another component, or of another material
/// without a common vertex. No facet can then pass through a facet that was in front of it.
void keep_apart(const LoadedScene& loaded_scene, std::vector<double>& most_move) {
  const FacetMesh& mesh = loaded_scene.scene.mesh;
  const auto is_another = [&](FacetId a, FacetId b) {
    return mesh.component[a] != mesh.component[b] ||
           (mesh.material[a] != mesh.material[b] && !share_a_corner(mesh.facets[a], mesh.facets[b]));
  };
  const auto like_first = [&](std::size_t f) {
    return mesh.component[f] == mesh.component[0] && mesh.material[f] == mesh.material[0];
  };
  std::size_t first_other = 0;
  while (first_other < mesh.facets.size() && like_first(first_other)) ++first_other;
  if (first_other == mesh.facets.size()) return;
  const std::vector<double> wanted = most_move;
  tbb::parallel_for(std::size_t{0}, mesh.facets.size(), [&](std::size_t f) {
    stop_if_wanted();
    const auto facet = static_cast<FacetId>(f);
    if (wanted[f] == 0) return;
    const Box box = box_of(mesh, facet);
    std::vector<FacetId> near;
    loaded_scene.tree->query(
        [&](const GridPoint& lo, const GridPoint& hi) {
          return gap(box, {lo, hi}) < 2 * wanted[f];
        },
        near);
    for (const FacetId other : near)
      if (is_another(facet, other)) most_move[f] = std::min(most_move[f], gap(box, box_of(mesh, other)) / 2);
  });
}

}  // namespace

std::vector<double> resolved_lengths(const LoadedScene& loaded_scene, const SensorSet& sensor_set) {
  const FacetMesh& mesh = loaded_scene.scene.mesh;
  std::vector<Looks> all;
  for (const SensorPings& pings : sensor_set.sensors) all.push_back(looks_of(pings, loaded_scene.scene.grid));
  std::vector<double> least(mesh.facets.size());
  tbb::parallel_for(std::size_t{0}, mesh.facets.size(), [&](std::size_t f) {
    stop_if_wanted();
    const Box box = box_of(mesh, static_cast<FacetId>(f));
    const glm::dvec3 middle = 0.5 * (vector_of(box.lo) + vector_of(box.hi));
    const double radius = glm::length(0.5 * (vector_of(box.hi) - vector_of(box.lo)));
    double told = std::numeric_limits<double>::infinity();
    for (const Looks& looks : all)
      told = std::min(told, looks.resolved_at(std::max(0.0, looks.places.distance(middle) - radius)));
    least[f] = std::isfinite(told) ? told : 0;
  });
  return least;
}

void coarsen(LoadedScene& loaded_scene, const SensorSet& sensor_set, double tolerance) {
  const auto start = std::chrono::steady_clock::now();
  constexpr double taken_a_facet = 250;
  require_memory(taken_a_facet * static_cast<double>(loaded_scene.scene.mesh.facets.size()),
                 loaded_scene.scene.description.run.place,
                 fmt::format("coarsening {} facets", loaded_scene.scene.mesh.facets.size()),
                 "leave out --coarsen");
  std::vector<double> most_move = resolved_lengths(loaded_scene, sensor_set);
  for (double& move : most_move) move *= tolerance;
  keep_apart(loaded_scene, most_move);
  CoarseMesh coarse = coarsened(loaded_scene.scene.mesh, most_move, std::sqrt(tolerance));
  SceneCoarsening& told = loaded_scene.coarsening.emplace();
  told.tolerance = tolerance;
  told.facets_before = loaded_scene.scene.mesh.facets.size();
  told.facets = coarse.mesh.facets.size();
  told.largest_move_m =
      coarse.move.empty() ? 0 : *std::ranges::max_element(coarse.move) * loaded_scene.scene.grid.unit_m();
  told.largest_share = tolerance * coarse.largest_share;
  double area = 0;
  for (std::size_t f = 0; f < coarse.mesh.facets.size(); ++f) {
    const double turn_rad = coarse.turn_rad[f];
    if (turn_rad == 0) continue;
    const auto corner = [&](int k) { return vector_of(coarse.mesh.vertices[coarse.mesh.facets[f][k]]); };
    const double of_facet = glm::length(glm::cross(corner(1) - corner(0), corner(2) - corner(0)));
    told.largest_turn_rad = std::max(told.largest_turn_rad, turn_rad);
    told.rms_turn_rad += of_facet * turn_rad * turn_rad;
    area += of_facet;
  }
  told.rms_turn_rad = area > 0 ? std::sqrt(told.rms_turn_rad / area) : 0;
  if (told.facets < told.facets_before) {
    loaded_scene.scene.mesh = std::move(coarse.mesh);
    loaded_scene.tree = std::make_unique<SceneTree>(loaded_scene.scene.mesh);
  }
  told.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

}  // namespace tubefoot
