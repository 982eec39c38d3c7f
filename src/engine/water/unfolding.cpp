// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/water/unfolding.hpp"

#include <cmath>
#include <stdexcept>
#include <vector>

#include "geometry/numbers/scalars.hpp"

namespace tubefoot {
namespace {

/// A profile point nearer to a mirror than this counts as on the mirror.
constexpr double same_depth_m = 1e-6;

/// Part of the path between two mirrors, before the first or after the last. Depth d of the water is at
/// offset + sign d.
struct Stretch {
  double offset_m, sign;
  double top_m, bottom_m;  ///< depths of the water
  double at(double depth_m) const { return offset_m + sign * depth_m; }
  double depth_m(double at_m) const { return sign * (at_m - offset_m); }
};

}  // namespace

UnfoldedWater unfold(const WaterColumn& water, const EigenrayOptions& rays, double surface_height_m,
                     std::span<const double> mirrors_m, bool up_first) {
  UnfoldedWater unfolded{water, rays, {}};
  if (mirrors_m.empty()) return unfolded;
  std::vector<Stretch> stretches{{0, 1, -infinite, infinite}};
  std::vector<double> mirror_at;
  bool up = up_first;
  for (const double height_m : mirrors_m) {
    const double depth_m = surface_height_m - height_m;
    Stretch& before = stretches.back();
    if (!(depth_m > before.top_m && depth_m < before.bottom_m))
      throw std::invalid_argument(
          "the horizontal mirrors of a path must alternately lie above and below each other");
    (up ? before.top_m : before.bottom_m) = depth_m;
    const double at = before.at(depth_m);
    mirror_at.push_back(at);
    Stretch after{2 * at - before.offset_m, -before.sign, -infinite, infinite};
    (up ? after.top_m : after.bottom_m) = depth_m;
    stretches.push_back(after);
    up = !up;
  }
  std::vector<ProfilePoint> points;
  for (const double at : mirror_at) points.push_back({at, 0});
  for (std::size_t k = 0; k < mirror_at.size(); ++k)
    points[k].sound_speed_m_s = water.profile.at(surface_height_m - mirrors_m[k]);
  for (const Stretch& stretch : stretches)
    for (const ProfilePoint& p : water.profile.points())
      if (p.depth_m > stretch.top_m + same_depth_m && p.depth_m < stretch.bottom_m - same_depth_m)
        points.push_back({stretch.at(p.depth_m), p.sound_speed_m_s});
  std::ranges::sort(points, {}, &ProfilePoint::depth_m);

  // Depth of the water at an unfolded position. The stretch is the number of mirrors before this position.
  const auto depth_at = [&](double at_m) {
    std::size_t k = 0;
    while (k < mirror_at.size() && (up_first ? at_m < mirror_at[k] : at_m > mirror_at[k])) ++k;
    return stretches[k].depth_m(at_m);
  };
  unfolded.water.profile = SoundSpeedProfile(points);
  unfolded.water.absorption_db_per_m.clear();
  if (!water.absorption_db_per_m.empty())
    for (std::size_t layer = 0; layer <= points.size(); ++layer) {
      const double at_m = layer == 0               ? points.front().depth_m - 1
                          : layer == points.size() ? points.back().depth_m + 1
                                                   : (points[layer - 1].depth_m + points[layer].depth_m) / 2;
      unfolded.water.absorption_db_per_m.push_back(
          water.absorption_in(water.profile.layer_at(depth_at(at_m))));
    }

  // The far ends of the first and the last stretch.
  const bool down_at_last = !up;  // rays go up if the next mirror would be above
  const double from = up_first ? rays.deepest_turn_m : rays.surface_m,
               to = stretches.back().at(down_at_last ? rays.deepest_turn_m : rays.surface_m);
  unfolded.rays.surface_m = std::min(from, to);
  unfolded.rays.deepest_turn_m = std::max(from, to);

  Unfolding& end = unfolded.unfolding;
  end.sign = stretches.back().sign;
  end.offset_m = surface_height_m * (1 - end.sign) - stretches.back().offset_m;
  end.last_mirror_m = mirrors_m.back();
  end.front = up ? 1 : -1;
  return unfolded;
}

}  // namespace tubefoot
