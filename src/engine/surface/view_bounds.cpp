// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/surface/view_bounds.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>

#include "engine/water/apparent_map.hpp"
#include "geometry/numbers/scalars.hpp"

// Tests conservatively whether balls, boxes and triangles may be visible in stratified water. Snell's law
// bounds launch angles: their cosine is the cosine of the straight line times a ratio of sound speeds. The
// flattest ray of the tubes bounds the range.
namespace tubefoot {
namespace {

double other_leg(double cosine) { return std::sqrt(std::max(0.0, (1 - cosine) * (1 + cosine))); }

/// Cosine of the elevation of a point at `height` above the apex and at `across` from its vertical.
double cosine_of(double height, double across) {
  const double range2 = height * height + across * across;
  return range2 > 0 ? across / std::sqrt(range2) : 1;
}

/// Returns the point of a triangle that is nearest to the origin.
glm::dvec2 nearest_of(const std::array<glm::dvec2, 3>& corners) {
  glm::dvec2 nearest{0};
  double least2 = std::numeric_limits<double>::infinity();
  int left = 0, right = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const glm::dvec2 from = corners[k], along = corners[(k + 1) % 3] - from;
    const double turn = cross(from, along), length2 = glm::dot(along, along);
    left += turn >= 0;
    right += turn <= 0;
    const double part = length2 > 0 ? std::clamp(-glm::dot(from, along) / length2, 0.0, 1.0) : 0;
    const glm::dvec2 point = from + part * along;
    if (glm::dot(point, point) < least2) {
      least2 = glm::dot(point, point);
      nearest = point;
    }
  }
  return left == 3 || right == 3 ? glm::dvec2(0) : nearest;
}

}  // namespace

ViewBounds::ViewBounds(const TubeSet& tubes, double grid_unit_m, const ApparentMap& apparent_map)
    : sector_(tubes, grid_unit_m), apparent_map_(apparent_map), apex_m_(apparent_map.apex_m()) {
  const SoundSpeedProfile& profile = apparent_map.water().profile;
  const double apex_depth_m = apparent_map.finder().source_depth_m(), at_apex = profile.at(apex_depth_m);
  double fastest = at_apex;
  for (const ProfilePoint& p : profile.points()) {
    Side& side = p.depth_m < apex_depth_m ? above_ : below_;
    side.slowest = std::max(side.slowest, at_apex / p.sound_speed_m_s);
    side.fastest = std::min(side.fastest, at_apex / p.sound_speed_m_s);
    fastest = std::max(fastest, p.sound_speed_m_s);
  }
  turning_.high_cosine = above_.fastest;
  turning_.high_sine = other_leg(above_.fastest);
  turning_.low_cosine = below_.fastest;
  turning_.low_sine = -other_leg(below_.fastest);
  stretch_ = apparent_map.reference_speed_m_s() / fastest;
  const auto [lowest, highest] = sector_.elevation_sines();
  trace_flattest(above_, false, std::max(lowest, 0.0));
  trace_flattest(below_, true, std::max(-highest, 0.0));
}

void ViewBounds::trace_flattest(Side& side, bool down, double launch_sine) {
  const SoundSpeedProfile& profile = apparent_map_.water().profile;
  const std::vector<ProfilePoint>& points = profile.points();
  const double apex_depth_m = apparent_map_.finder().source_depth_m(), at_apex = profile.at(apex_depth_m);
  launch_sine = std::max(0.0, launch_sine - 1e-9);  // far larger than rounding
  side.flattest = {at_apex, launch_sine, other_leg(launch_sine)};
  const double sign = down ? 1 : -1;
  const std::size_t apex_layer = profile.layer_at(apex_depth_m);
  side.borders = {{0, at_apex, sign * profile.gradient_per_s(apex_layer), launch_sine, 0}};
  for (std::size_t i = 0; i < points.size(); ++i) {
    const std::size_t k = down ? i : points.size() - 1 - i;
    const double way_m = sign * (points[k].depth_m - apex_depth_m);
    if (!(way_m > 0)) continue;
    const double range_m = side.farthest_m(way_m), speed = points[k].sound_speed_m_s;
    side.borders.push_back({way_m, speed, sign * profile.gradient_per_s(down ? k + 1 : k),
                            side.flattest.sine_at(speed), range_m});
  }
}

// Steeper rays reach depths that the flattest ray does not reach. There the result is infinite.
double ViewBounds::Side::farthest_m(double way_m) const {
  const auto next = std::upper_bound(borders.begin(), borders.end(), way_m,
                                     [](double way, const Border& border) { return way < border.way_m; });
  const Border& from = *(next - 1);
  const double dz_m = way_m - from.way_m;
  if (dz_m == 0) return from.range_m;
  const double speed = from.speed_m_s + from.gradient_per_s * dz_m, sine2 = flattest.sine2_at(speed);
  if (!(sine2 > 0)) return std::numeric_limits<double>::infinity();
  return from.range_m + flattest.p() * arc_reach(dz_m, from.speed_m_s, speed, from.sine, std::sqrt(sine2));
}

bool ViewBounds::may_see(DirectionBox& box, double lowest_m, double highest_m, double nearest_m,
                         double farthest_m) const {
  // Reach of the tubes.
  const double height_m = std::max({lowest_m, -highest_m, 0.0});
  const double reach_m = sector_.reach_m() / stretch_ + 1e-6;
  if (height_m * height_m + nearest_m * nearest_m > reach_m * reach_m) return false;
  // Monotone rays: the flattest and the steepest of each side.
  if (highest_m >= 0) {
    box.high_cosine = above_.fastest * cosine_of(highest_m, nearest_m);
    box.high_sine = other_leg(box.high_cosine);
  } else {
    box.high_cosine = std::min(1.0, below_.slowest * cosine_of(highest_m, farthest_m));
    box.high_sine = -other_leg(box.high_cosine);
  }
  if (lowest_m <= 0) {
    box.low_cosine = below_.fastest * cosine_of(lowest_m, nearest_m);
    box.low_sine = -other_leg(box.low_cosine);
  } else {
    box.low_cosine = std::min(1.0, above_.slowest * cosine_of(lowest_m, farthest_m));
    box.low_sine = other_leg(box.low_cosine);
  }
  constexpr double slack = 1 + 1e-9;
  const bool falling = lowest_m <= 0 && nearest_m <= slack * below_.farthest_m(-lowest_m),
             rising = highest_m >= 0 && nearest_m <= slack * above_.farthest_m(highest_m);
  if ((falling || rising) && sector_.may_meet(box)) return true;
  if (apparent_map_.finder().steeper_than_turning(height_m, farthest_m)) return false;
  box.low_sine = turning_.low_sine;
  box.low_cosine = turning_.low_cosine;
  box.high_sine = turning_.high_sine;
  box.high_cosine = turning_.high_cosine;
  return sector_.may_meet(box);
}

bool ViewBounds::may_see(const glm::dvec3& centre_m, double radius_m) const {
  if (!apparent_map_.unfolding().may_reach(centre_m.z - radius_m, centre_m.z + radius_m)) return false;
  const glm::dvec3 way = apparent_map_.unfolded(centre_m) - apex_m_;
  const double across = std::hypot(way.x, way.y);
  DirectionBox box;
  box.all_round = !(radius_m < across);
  if (!box.all_round) {
    const double sine = radius_m / across, cosine = other_leg(sine);
    const glm::dvec2 towards = glm::dvec2(way) / across, left(-towards.y, towards.x);
    box.from = cosine * towards - sine * left;
    box.to = cosine * towards + sine * left;
  }
  return may_see(box, way.z - radius_m, way.z + radius_m, std::max(0.0, across - radius_m),
                 across + radius_m);
}

// A convex hull lies completely beyond the line through its nearest point, perpendicular to the direction of
// this point. All ranges passed on are those of the hull itself. If the result is true for a hull, it is
// therefore true for every hull that contains it.
bool ViewBounds::may_see(std::span<const glm::dvec2> ways_m, glm::dvec2 nearest_m, double lowest_m,
                         double highest_m) const {
  const double nearest = glm::length(nearest_m);
  double farthest2 = 0;
  for (const glm::dvec2& way : ways_m) farthest2 = std::max(farthest2, glm::dot(way, way));
  DirectionBox box;
  box.all_round = !(nearest > 0);
  if (!box.all_round) {
    constexpr double none = std::numeric_limits<double>::infinity();
    double rightmost = none, leftmost = -none;
    glm::dvec2 right{0}, left{0};
    for (const glm::dvec2& way : ways_m) {
      const double beside = cross(nearest_m, way) / glm::dot(nearest_m, way);
      if (beside < rightmost) {
        rightmost = beside;
        right = way;
      }
      if (beside > leftmost) {
        leftmost = beside;
        left = way;
      }
    }
    box.from = glm::normalize(right);
    box.to = glm::normalize(left);
  }
  return may_see(box, lowest_m, highest_m, nearest, std::sqrt(farthest2));
}

bool ViewBounds::may_see(const glm::dvec3 (&corners_m)[3]) const {
  const auto [lowest, highest] = std::minmax({corners_m[0].z, corners_m[1].z, corners_m[2].z});
  if (!apparent_map_.unfolding().may_reach(lowest, highest)) return false;
  const glm::dvec3 a = apparent_map_.unfolded(corners_m[0]) - apex_m_,
                   b = apparent_map_.unfolded(corners_m[1]) - apex_m_,
                   c = apparent_map_.unfolded(corners_m[2]) - apex_m_;
  const std::array ways{glm::dvec2(a), glm::dvec2(b), glm::dvec2(c)};
  return may_see(ways, nearest_of(ways), std::min({a.z, b.z, c.z}), std::max({a.z, b.z, c.z}));
}

bool ViewBounds::may_see_box(const glm::dvec3& lowest_m, const glm::dvec3& highest_m) const {
  if (!apparent_map_.unfolding().may_reach(lowest_m.z, highest_m.z)) return false;
  const glm::dvec3 one = apparent_map_.unfolded(lowest_m) - apex_m_,
                   other = apparent_map_.unfolded(highest_m) - apex_m_, lo = glm::min(one, other),
                   hi = glm::max(one, other);
  return may_see(std::array{glm::dvec2(lo), glm::dvec2(hi.x, lo.y), glm::dvec2(hi), glm::dvec2(lo.x, hi.y)},
                 glm::clamp(glm::dvec2(0), glm::dvec2(lo), glm::dvec2(hi)), lo.z, hi.z);
}

std::vector<FacetId> ViewBounds::facets(const FacetMesh& mesh, const SceneTree& tree, const WorldGrid& grid,
                                        double margin_m) const {
  std::vector<FacetId> near, seen;
  const glm::dvec3 margin(margin_m);
  tree.query(
      [&](const GridPoint& lowest, const GridPoint& highest) {
        return may_see_box(grid.to_metres(lowest) - margin, grid.to_metres(highest) + margin);
      },
      near);
  for (const FacetId f : near) {
    const auto& [a, b, c] = mesh.facets[f];
    const glm::dvec3 corners[3] = {grid.to_metres(mesh.vertices[a]), grid.to_metres(mesh.vertices[b]),
                                   grid.to_metres(mesh.vertices[c])};
    if (margin_m > 0 ? may_see_box(glm::min(corners[0], glm::min(corners[1], corners[2])) - margin,
                                   glm::max(corners[0], glm::max(corners[1], corners[2])) + margin)
                     : may_see(corners))
      seen.push_back(f);
  }
  std::ranges::sort(seen);
  return seen;
}

}  // namespace tubefoot
