// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/surface/apparent_images.hpp"

#include <algorithm>
#include <glm/common.hpp>
#include <numbers>
#include <numeric>
#include <optional>

#include "engine/water/apparent_map.hpp"

// Computes the apparent images of seabed points, matches the rays of neighbouring points, and decides which
// edges need a cut. An edge is cut until its travel-path error and the error of its facet factor are within
// the settings. See docs/notes/refraction.md.
namespace tubefoot {

bool are_alike(const std::vector<SeenPoint>& a, const std::vector<SeenPoint>& b) {
  return std::ranges::equal(a, b, {}, &SeenPoint::crossed, &SeenPoint::crossed);
}

std::vector<std::size_t> same_rays(const std::vector<SeenPoint>& more, const std::vector<SeenPoint>& fewer) {
  const std::size_t n = more.size(), m = fewer.size();
  std::vector<std::size_t> same(m);
  if (are_alike(more, fewer)) {
    std::iota(same.begin(), same.end(), std::size_t{0});
    return same;
  }
  if (m >= n) return {};
  // sum[i][j] is the least sum of launch-angle differences for the rays from (i, j) to the end.
  constexpr double none = std::numeric_limits<double>::infinity();
  std::vector<std::vector<double>> sum(n + 1, std::vector<double>(m + 1, none));
  const auto with = [&](std::size_t i, std::size_t j) {
    return more[i].crossed() == fewer[j].crossed()
               ? std::abs(more[i].launch_rad - fewer[j].launch_rad) + sum[i + 1][j + 1]
               : none;
  };
  for (std::size_t i = 0; i <= n; ++i) sum[i][m] = 0;
  for (std::size_t i = n; i-- > 0;)
    for (std::size_t j = m; j-- > 0;) sum[i][j] = std::min(sum[i + 1][j], with(i, j));
  if (!(sum[0][0] < none)) return {};
  for (std::size_t i = 0, j = 0; j < m; ++i)
    if (with(i, j) <= sum[i + 1][j]) same[j++] = i;
  return same;
}

Images::Images(const ApparentMap& apparent_map, double reference_absorption_db_per_m,
               const ApparentMapSettings& settings, const ViewBounds* view_bounds)
    : apparent_map_(apparent_map),
      absorption_(reference_absorption_db_per_m),
      settings_(settings),
      view_bounds_(view_bounds),
      bend_per_m_(apparent_map.water().profile.largest_bend_per_m()) {}

ApparentImage Images::make(const glm::dvec3& point_m) const {
  std::vector<ApparentPoint> several;
  const std::optional<ApparentPoint> found =
      apparent_map_.apparent(point_m, settings_.later_arrivals ? &several : nullptr);
  if (!found) return {};
  ApparentImage image{seen_point(point_m, *found), found->eigenrays, {}};
  if (settings_.later_arrivals && found->eigenrays > 1) {
    for (const ApparentPoint& each : several) image.several.push_back(seen_point(point_m, each));
    return image;
  }
  if (!std::isfinite(image.returned.spreading)) return {};  // on a caustic, where ray theory has no result
  return image;
}

SeenPoint Images::seen_point(const glm::dvec3& point_m, const ApparentPoint& found) const {
  const CornerReturn returned = corner_return(apparent_map_, point_m, found, absorption_);
  // For nearly horizontal rays near their turning points, this limit keeps the level from its extremes. The
  // return from there is small.
  constexpr double least = 0.1;
  const double sines =
      std::max(std::abs(found.ray.arrival_sine), least) / std::max(std::abs(found.ray.launch_sine), least);
  SeenPoint seen{found.at_m, returned, glm::distance(found.at_m, apparent_map_.apex_m()),
                 db_per_relative * std::log(returned.spreading * sines)};
  if (!settings_.later_arrivals) return seen;
  seen.launch_rad = std::atan2(found.ray.launch_sine, found.ray.launch_cosine);
  // Scales with the ray's own area; the caustic's area is a multiple of it.
  Eigenray unit = found.ray;
  unit.tube_area_m2_per_sr = 1;
  const double width = 1 / corner_return(apparent_map_, point_m, {found.at_m, unit}, absorption_).spreading;
  seen.width = (found.ray.crossed ? -1 : 1) * width * found.ray.tube_area_m2_per_sr;
  seen.caustic_width = width * found.ray.caustic_area_m2_per_sr;
  const double beyond_db =
      found.ray.absorption_db - absorption_ * apparent_map_.reference_speed_m_s() * found.ray.time_s;
  seen.kept = std::exp(-beyond_db * std::numbers::ln10 / 10);
  seen.speeds = apparent_map_.finder().source_speed_m_s() /
                apparent_map_.water().profile.at(apparent_map_.depth_m(point_m));
  if (found.eigenrays > 1)
    seen.level_db = db_per_relative * std::log(sines / std::hypot(seen.width, seen.caustic_width));
  return seen;
}

// The border at which rays appear or vanish between the ends is located along the edge later. This rule
// makes the border lie between short edges.
bool Images::cuts_by_any_ray(double length, const ApparentImage& from, const ApparentImage& to,
                             const ApparentImage& middle) const {
  // Images of facets next to a caustic have errors of direction, at most as large as their width, when their
  // ranges are already accurate.
  constexpr double sideways = 16, beside_caustics = 5;
  const auto rays_to = [](const ApparentImage& image) {
    return image.several.empty() && image.seen() ? std::vector<SeenPoint>{image} : image.several;
  };
  const std::vector<SeenPoint> a = rays_to(from), b = rays_to(to), m = rays_to(middle);
  if (!are_alike(a, b) || !are_alike(a, m)) {
    const auto shows = [&](const std::vector<SeenPoint>& rays) {
      return std::ranges::any_of(
          rays, [&](const SeenPoint& ray) { return may_show(ray.at_m, length + ray.range_m / 10); });
    };
    return shows(a) || shows(b) || shows(m);
  }
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (!may_show(m[i].at_m, glm::distance(a[i].at_m, b[i].at_m))) continue;
    const double gap = edge_travel_path_error_m(a[i].at_m, b[i].at_m, m[i].at_m);
    if (a[i].is_wide() && b[i].is_wide() && m[i].is_wide()) {
      if (!is_fine(length, gap, a[i], b[i], m[i])) return true;
      continue;
    }
    const glm::dvec3 off = m[i].at_m - (a[i].at_m + b[i].at_m) / 2.0;
    const double along = std::abs(glm::dot(off, glm::normalize(m[i].at_m - apparent_map_.apex_m())));
    const auto [least, most] = std::minmax({a[i].level_db, b[i].level_db, m[i].level_db});
    if (along > settings_.travel_path_error_m || gap > sideways * settings_.travel_path_error_m) return true;
    if (!((most - least) / 2 <= beside_caustics * settings_.tolerance_db)) return true;
  }
  return false;
}

bool Images::concerns(const glm::dvec3& a, const glm::dvec3& b, const FacetMesh& base, FacetId facet,
                      const WorldGrid& grid, bool inside) const {
  const double length = glm::distance(a, b);
  if (!(length > settings_.shortest_edge_m)) return false;
  if (view_bounds_ == nullptr) return true;
  const glm::dvec3 middle = (a + b) / 2.0;
  if (!view_bounds_->may_see(middle, 2 * length)) return false;
  if (!inside) return true;
  glm::dvec3 lowest = grid.to_metres(base.vertices[base.facets[facet][0]]), highest = lowest;
  for (std::size_t k = 1; k < 3; ++k) {
    const glm::dvec3 corner = grid.to_metres(base.vertices[base.facets[facet][k]]);
    lowest = glm::min(lowest, corner);
    highest = glm::max(highest, corner);
  }
  return view_bounds_->may_see_box(glm::max(lowest, middle - 2 * length),
                                   glm::min(highest, middle + 2 * length));
}

bool Images::is_small(const glm::dvec3 (&corners_m)[3], const glm::dvec3 (&seen_m)[3]) const {
  constexpr double negligible = 1e-6;
  const glm::dvec3 normal = glm::cross(seen_m[1] - seen_m[0], seen_m[2] - seen_m[0]);
  double longest2 = 0, least = std::numeric_limits<double>::infinity();  // range times sine
  for (int i = 0; i < 3; ++i) {
    const glm::dvec3 edge = corners_m[(i + 1) % 3] - corners_m[i];
    longest2 = std::max(longest2, glm::dot(edge, edge));
    least = std::min(least, std::abs(glm::dot(normal, seen_m[i])));
  }
  return bend_per_m_ * longest2 * glm::length(normal) <= negligible * least;
}

double sigma_of(const ScatteringModel* model, double sine) {
  if (model == nullptr) return lambert_sigma(sine);
  sine = std::min(sine, 1.0);
  return sine > 0 ? model->cross_section(sine, std::sqrt((1 - sine) * (1 + sine))) : 0;
}

}  // namespace tubefoot
