// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/certified/facet_ends.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

namespace tubefoot {

EndOfFacet::EndOfFacet(const BistaticEnd& end, const FlatFacet& flat, const FacetCorners& lies, double pad_m,
                       const FacetCorners& seen)
    : end_(end),
      sign_(end.water.unfolding().sign),
      u_(turned(flat.u)),
      v_(turned(flat.v)),
      normal_(sign_ * turned(flat.normal)),
      source_depth_m_(end.water.finder().source_depth_m()),
      pad_m_(pad_m) {
  for (int k = 0; k < 3; ++k) lies_[k] = way_to(lies[k]), seen_[k] = turned(seen[k]);
  centre_ = way_to(flat.centre_m);
  glm::dvec3 across = glm::cross(seen_[1] - seen_[0], seen_[2] - seen_[0]);
  const double size = glm::length(across);
  if (!(size > 0)) return;
  across /= size;
  facing_ = glm::dot(across, seen_[0]);
  seen_normal_ = facing_ < 0 ? -across : across;
  const auto [least, most] = box_of(flat);
  const double wider = enclosure_slack * (1 + flat.longest_m);
  alone_ = end.rays.none_turns_before(padded(centre_), u_, v_, {least.x - wider, most.x + wider},
                                      {least.y - wider, most.y + wider});
  for (int k = 0; k < 3; ++k) {
    const auto there = over(padded(lies_[k]), 0.0, 0.0);
    if (!there) return;
    corner_[k] = *there;
    const auto& image = there->rays.image;
    off_m_ = std::max(
        off_m_, norm_of({image[0].v - seen_[k].x, image[1].v - seen_[k].y, image[2].v - seen_[k].z}).hi);
  }
  const auto middle = over(0.0, 0.0);
  if (!middle) return;
  middle_ = *middle;
  valid_ = true;
}

std::optional<EndPatch> EndOfFacet::over(const std::array<Interval, 3>& origin, const Interval& a,
                                         const Interval& b) const {
  const auto rays = end_.rays.over(origin, u_, v_, a, b, alone_);
  if (!rays) return std::nullopt;
  EndPatch patch{*rays, {}, {}, {}, {}, {}, {}};
  std::array<Jet, 3> at;
  for (int k = 0; k < 3; ++k) {
    at[std::size_t(k)].v = origin[std::size_t(k)] + a * u_[k] + b * v_[k];
    at[std::size_t(k)].a = outwards(u_[k], u_[k], 4);
    at[std::size_t(k)].b = outwards(v_[k], v_[k], 4);
    patch.distance2 = patch.distance2 + squared(at[std::size_t(k)]);
    patch.place[std::size_t(k)] = at[std::size_t(k)].v;
  }
  patch.sine_m = rays->arrival_across * (Jet(normal_.x) * at[0] + Jet(normal_.y) * at[1]) -
                 Jet(normal_.z) * rays->arrival_down_m;
  const SoundSpeedProfile& profile = end_.water.water().profile;
  const Interval depth = source_depth_m_ - at[2].v;
  const double first = profile.at(depth.lo), last = profile.at(depth.hi);
  Interval speed(std::min(first, last), std::max(first, last)), gradient;
  const std::size_t top = profile.layer_at(depth.lo), bottom = profile.layer_at(depth.hi);
  for (std::size_t layer = top; layer <= bottom; ++layer) {
    const double g = profile.gradient_per_s(layer);
    gradient = layer == top ? outwards(g, g, 4) : hull(gradient, outwards(g, g, 4));
    if (layer < bottom) speed = hull(speed, profile.points()[layer].sound_speed_m_s);
  }
  patch.speed = outwards(speed.lo, speed.hi, 8);
  patch.log_speed_a = -(gradient * at[2].a) / patch.speed;
  patch.log_speed_b = -(gradient * at[2].b) / patch.speed;
  return patch;
}

std::array<Interval, 3> EndOfFacet::change(const EndPatch& patch) const {
  // The gradient has the direction of the arriving rays. Their horizontal direction is the horizontal
  // direction of the point.
  const Interval per_m = reference_speed() / patch.speed / root(patch.distance2.v);
  const Interval across = per_m * patch.rays.arrival_across.v;
  return {across * patch.place[0], across * patch.place[1], -(per_m * patch.rays.arrival_down_m.v)};
}

}  // namespace tubefoot
