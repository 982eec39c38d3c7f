// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <map>
#include <numbers>
#include <vector>

#include "engine/echo/cone_sums.hpp"
#include "engine/echo/volume_echo.hpp"
#include "engine/echo/water_cells.hpp"
#include "engine/water/timed_ray.hpp"
#include "geometry/steps/stop.hpp"

// Volume reverberation along refracted rays. Each strip of elevation has the reverberation of isovelocity
// water with s_v = 1, times a factor per range sample. The factor is the ratio of the integrals over range.

namespace tubefoot {
namespace {

/// Angles in the vertical plane of a narrow cell, from the horizontal upwards. Directions behind the vertical
/// have more than a quarter turn.
struct VerticalPlane {
  glm::dvec3 ahead;  ///< horizontal unit vector
  bool up = false;   ///< whether the cell points upwards

  explicit VerticalPlane(std::span<const glm::dvec3> rays) {
    glm::dvec3 sum(0);
    for (const glm::dvec3& ray : rays) sum += glm::normalize(ray);
    up = sum.z > 0;
    sum.z = 0;
    ahead = glm::length(sum) > 1e-6 ? glm::normalize(sum) : glm::dvec3(1, 0, 0);
  }
  double angle(const glm::dvec3& d) const {
    const double angle = std::atan2(d.z, glm::dot(ahead, d));
    if (up) return angle < -std::numbers::pi / 2 ? angle + 2 * std::numbers::pi : angle;
    return angle > std::numbers::pi / 2 ? angle - 2 * std::numbers::pi : angle;
  }
  /// Normal of the plane of directions at an angle; products with lower directions are positive.
  glm::dvec3 wall(double angle) const { return std::sin(angle) * ahead - glm::dvec3(0, 0, std::cos(angle)); }
};

/// Return of the water along the ray of a launch direction, relative to isovelocity water with s_v = 1.
class RefractedRay {
 public:
  RefractedRay(const RefractingWater& water, const VolumeScattering& volume, double apex_depth_m, double sine,
               double last_m)
      : water_(water), volume_(volume), step_m_(last_m / nodes) {
    const double angle = std::asin(std::clamp(sine, -1.0, 1.0));
    const SoundSpeedProfile& profile = water.column.profile;
    const double apex_speed = profile.at(apex_depth_m);
    double absorption_db = 0, speed_before = apex_speed, db_before = rate_db(apex_depth_m);
    for (int k = 0; k <= nodes; ++k) {
      const double range = step_m_ * k, time = range / water.reference_speed_m_s;
      const auto ray_at = [&](double elevation) {
        return ray_after(profile, apex_depth_m, {-std::sin(elevation), std::cos(elevation)}, time);
      };
      const TimedRay ray = ray_at(angle), above = ray_at(angle + offset), below = ray_at(angle - offset);
      const double speed = profile.at(ray.depth_m), db = rate_db(ray.depth_m);
      if (k > 0)
        absorption_db +=
            (db + db_before) / 2 * step_m_ * (speed + speed_before) / 2 / water.reference_speed_m_s;
      speed_before = speed;
      db_before = db;
      Node node{ray.depth_m, 0};
      if (k > 0 && !(ray.shallowest_m < 0)) {
        // Wavefronts are perpendicular to the rays.
        const double spread =
            std::hypot(above.range_m - below.range_m, above.depth_m - below.depth_m) / (2 * offset);
        const double area = spread * ray.range_m / std::cos(angle);
        const double back = speed / apex_speed;
        if (area > 0)
          node.relative = range * range / area * back * back * speed / water.reference_speed_m_s *
                          std::pow(10, -2 * absorption_db / 10);
      }
      nodes_.push_back(node);
    }
    nodes_.front().relative = water.reference_speed_m_s / apex_speed;  // the limit at the apex
  }

  /// Ratio of the integrals over a range sample.
  double mean(double from_m, double to_m) const {
    constexpr int parts = 8;
    double sum = 0, weights = 0;
    for (int p = 0; p < parts; ++p) {
      const double r = from_m + (to_m - from_m) * (p + 0.5) / parts, at = std::min(r / step_m_, nodes - 1e-9);
      const auto k = std::size_t(at);
      const double share = at - double(k), weight = 1 / (r * r);
      const double depth = nodes_[k].depth_m + share * (nodes_[k + 1].depth_m - nodes_[k].depth_m);
      const double near = nodes_[k].relative, far = nodes_[k + 1].relative;
      const double relative =
          near > 0 && far > 0 ? near * std::pow(far / near, share) : near + share * (far - near);
      sum += weight * relative * coefficient(water_.surface_height_m - depth);
      weights += weight;
    }
    return sum / weights;
  }

 private:
  static constexpr int nodes = 400;
  static constexpr double offset = 1e-4;  ///< of the neighbouring rays, in radians
  struct Node {
    double depth_m, relative;
  };
  double rate_db(double depth_m) const {
    return water_.column.absorption_in(water_.column.profile.layer_at(depth_m));
  }
  double coefficient(double height_m) const {
    const auto above = std::ranges::upper_bound(volume_.borders_m, height_m);
    return volume_.s_v_per_m[std::size_t(above - volume_.borders_m.begin())];
  }

  const RefractingWater& water_;
  const VolumeScattering& volume_;
  double step_m_;
  std::vector<Node> nodes_;
};

/// A part of a cone within a strip.
struct StripCone {
  FacetPlane plane;
  std::vector<glm::dvec3> corners_m;
  std::uint32_t tube;
};

/// Cones by the number of their strip.
using Strips = std::map<long, std::vector<StripCone>>;

/// Divides the polygons of a narrow cell into strips of elevation.
void add_to_strips(const WaterCell& cell, std::uint32_t tube, double width, Strips& strips) {
  const VerticalPlane plane(cell.cone);
  const long half_turn = std::lround(std::numbers::pi / width);
  for (const SpacePolygon& polygon : cell.polygons) {
    double lowest = 2 * std::numbers::pi, highest = -2 * std::numbers::pi;
    for (const glm::dvec3& corner : polygon.corners_m) {
      lowest = std::min(lowest, plane.angle(corner));
      highest = std::max(highest, plane.angle(corner));
    }
    Directions rest = polygon.corners_m;
    for (long k = long(std::floor(lowest / width)); !rest.empty() && double(k) * width < highest; ++k) {
      const glm::dvec3 wall = plane.wall(double(k + 1) * width);
      auto [lower, upper] =
          VolumeRegions<DoubleSpace>::divided(rest, [&](const glm::dvec3& d) { return glm::dot(wall, d); });
      const bool behind = 2 * k >= half_turn || 2 * k < -half_turn;
      const long key = behind ? (plane.up ? half_turn : -half_turn) - 1 - k : k;
      if (!lower.empty()) strips[key].push_back({polygon.plane, std::move(lower), tube});
      rest = std::move(upper);
    }
  }
}

/// Width of cells of directions within which the elevation is that in one vertical plane.
constexpr double widest_cell_rad = 0.04;

}  // namespace

Echo refracted_volume_echo(const History& history, const ReceiveBeams& beams, const RangeSamples& samples,
                           const EchoModel& model, const VolumeScattering& volume,
                           const RefractingWater& water, double strip_width_rad) {
  check(volume);
  const double width = std::numbers::pi / 2 / std::ceil(std::numbers::pi / 2 / strip_width_rad);
  const double last_m = samples.border_m(samples.count);
  VolumeRegions<DoubleSpace> regions({{}, {1}}, 0, last_m);
  // Strips on both sides of the vertical have the same elevation, and so the same key.
  Strips strips;
  std::size_t surface = 0, open = 0;
  for (std::uint32_t tube = 0; tube < history.tubes.tubes.size(); ++tube) {
    each_small(water_cell(tube_content(history, tube, surface, open), regions), widest_cell_rad,
               [&](const WaterCell& cell) { add_to_strips(cell, tube, width, strips); });
  }
  Echo echo{beams.count, samples.count,
            std::vector<double>(std::size_t(beams.count) * std::size_t(samples.count))};
  ConeSums sums(beams, samples, 0, model.patterns, model.pattern_tolerance);
  const double apex_depth_m = water.surface_height_m - model.path.tx.apex_m.z;
  for (const auto& [k, cones] : strips) {
    stop_if_wanted();
    for (const StripCone& cone : cones) sums.add({cone.plane, cone.corners_m}, 1, cone.tube);
    const RefractedRay ray(water, volume, apex_depth_m, std::sin((double(k) + 0.5) * width), last_m);
    const std::vector<double> energy = sums.energies();
    for (int sample = 0; sample < samples.count; ++sample) {
      const double mean = ray.mean(samples.border_m(sample), samples.border_m(sample + 1));
      for (int beam = 0; beam < beams.count; ++beam) {
        const std::size_t bin = std::size_t(beam) * std::size_t(samples.count) + std::size_t(sample);
        echo.energy[bin] += mean * energy[bin];
      }
    }
  }
  return echo;
}

}  // namespace tubefoot
