// SPDX-License-Identifier: GPL-3.0-or-later
// Collects the surroundings of the footprints of a view: partly hidden facets in the tubes, and the facets
// of the mesh nearest to the footprints.
#include "viewer/view_surroundings.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <unordered_map>

#include "geometry/steps/stop.hpp"
#include "run/tube_pyramid.hpp"

namespace tubefoot {
namespace {

constexpr double not_worth_drawing_m2 = 1e-10;

double area_of(const std::vector<glm::dvec3>& polygon) {
  glm::dvec3 sum(0);
  for (std::size_t i = 1; i + 1 < polygon.size(); ++i)
    sum += glm::cross(polygon[i] - polygon[0], polygon[i + 1] - polygon[0]);
  return glm::length(sum) / 2;
}

/// Approximate horizontal distance of a position from the footprints, on the cells of a grid over their
/// box.
class Nearness {
 public:
  Nearness(const ViewData& view, glm::dvec3 lo, glm::dvec3 hi)
      : lo_(lo), cell_m_(std::max(hi.x - lo.x, hi.y - lo.y) / side), distance_(side * side, 0.0) {
    std::vector<bool> taken(side * side, false);
    for (const auto* points : {&view.shapes.corners_m, &view.shadows.corners_m})
      for (const glm::dvec3& p : *points) taken[cell(p)] = true;
    std::vector<std::size_t> shown;
    for (std::size_t c = 0; c < taken.size(); ++c)
      if (taken[c]) shown.push_back(c);
    for (std::size_t c = 0; c < taken.size() && !shown.empty(); ++c) {
      distance_[c] = std::numeric_limits<double>::infinity();
      for (const std::size_t s : shown)
        distance_[c] = std::min(distance_[c], cell_m_ * std::hypot(double(c % side) - double(s % side),
                                                                   double(c / side) - double(s / side)));
    }
  }
  double distance_m(glm::dvec3 place) const { return distance_[cell(place)]; }

 private:
  static constexpr std::size_t side = 64;
  std::size_t cell(glm::dvec3 p) const {
    const auto along = [&](int k) {
      return std::size_t(std::clamp((p[k] - lo_[k]) / cell_m_, 0.0, double(side - 1)));
    };
    return along(1) * side + along(0);
  }
  glm::dvec3 lo_;
  double cell_m_;
  std::vector<double> distance_;
};

}  // namespace

bool add_shadows(const Scene& scene, const TransmissionEnd& end, const History& history, std::size_t most,
                 ViewPolygons& shadows) {
  const TubeSet& tubes = history.tubes;
  const FacetMesh& mesh = *end.mesh;
  const glm::dvec3 apex = scene.grid.to_metres(tubes.apex);
  const double unit = scene.grid.unit_m();
  const auto& footprints = history.footprints.footprints;
  std::size_t next = 0;  // footprints are ordered by tube
  std::vector<FacetId> facets;
  std::vector<glm::dvec3> polygon;
  std::unordered_map<FacetId, double> seen_m2;
  for (std::uint32_t t = 0; t < tubes.tubes.size(); ++t) {
    seen_m2.clear();
    for (; next < footprints.size() && footprints[next].tube == t; ++next)
      seen_m2[footprints[next].facet] = footprints[next].area_m2;
    TubePyramid pyramid(tubes, t);
    facets.clear();
    end.tree->query(tubes.apex, pyramid.walls(), tubes.reach, facets);
    std::sort(facets.begin(), facets.end());
    for (const FacetId facet : facets) {
      stop_if_wanted();
      polygon = pyramid.part_of(mesh, facet);
      for (glm::dvec3& corner : polygon) corner *= unit;
      const double area = area_of(polygon);
      const auto seen = seen_m2.find(facet);
      if (area < not_worth_drawing_m2 || (seen != seen_m2.end() && seen->second > (1 - 1e-6) * area))
        continue;
      if (shadows.corners_of.size() == most) return false;
      shadows.corners_of.push_back(static_cast<std::uint16_t>(polygon.size()));
      for (const glm::dvec3& corner : polygon)
        shadows.corners_m.push_back(end.apparent == nullptr
                                        ? apex + corner
                                        : end.apparent->true_place(facet, apex + corner, scene.grid));
    }
  }
  return true;
}

ViewSurroundings surroundings(const ViewData& view) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  glm::dvec3 lo(infinity), hi(-infinity);
  for (const auto* points : {&view.shapes.corners_m, &view.shadows.corners_m})
    for (const glm::dvec3& p : *points) {
      lo = glm::min(lo, p);
      hi = glm::max(hi, p);
    }
  if (view.shapes.corners_m.empty() && view.shadows.corners_m.empty())
    for (const ViewPing& ping : view.pings) {
      lo = glm::min(lo, ping.sensor_m - 10.0);
      hi = glm::max(hi, ping.sensor_m + 10.0);
    }
  const double margin = glm::distance(lo, hi) / 4;
  return {lo - margin, hi + margin};
}

std::size_t take_mesh(const Scene& scene, const FacetMesh& mesh, const ViewSurroundings& about,
                      std::size_t most, ViewData& view) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  const auto& [lo, hi] = about;
  const Nearness nearness(view, lo, hi);
  struct Near {
    double distance_m;
    FacetId facet;
  };
  std::vector<Near> near;
  for (std::size_t f = 0; f < mesh.facets.size(); ++f) {
    stop_if_wanted();
    glm::dvec3 from(infinity), to(-infinity);
    for (const VertexId v : mesh.facets[f]) {
      const glm::dvec3 p = scene.grid.to_metres(mesh.vertices[v]);
      from = glm::min(from, p);
      to = glm::max(to, p);
    }
    if (from.x > hi.x || from.y > hi.y || from.z > hi.z || to.x < lo.x || to.y < lo.y || to.z < lo.z)
      continue;
    near.push_back({nearness.distance_m((from + to) / 2.0), FacetId(f)});
  }
  const std::size_t met = near.size();
  if (met > most) {
    const auto last = near.begin() + std::ptrdiff_t(most);
    std::nth_element(near.begin(), last, near.end(), [](const Near& a, const Near& b) {
      return a.distance_m != b.distance_m ? a.distance_m < b.distance_m : a.facet < b.facet;
    });
    // Takes whole cells to keep the border straight, except for cells at distance 0.
    const double limit_m = last->distance_m;
    near.resize(most);
    if (limit_m > 0) std::erase_if(near, [&](const Near& n) { return n.distance_m >= limit_m; });
  }
  std::unordered_map<VertexId, std::uint32_t> number;
  for (const Near& n : near)
    for (const VertexId v : mesh.facets[n.facet]) {
      const auto [place, is_new] = number.emplace(v, std::uint32_t(view.mesh_vertices_m.size()));
      if (is_new) view.mesh_vertices_m.push_back(scene.grid.to_metres(mesh.vertices[v]));
      view.mesh_facets.push_back(place->second);
    }
  return met - near.size();
}

}  // namespace tubefoot
