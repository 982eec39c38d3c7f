// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/water/sound_speed_profile.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

// Implements piecewise linear sound-speed profiles and samples smooth profiles. Two analytic profiles are
// those of Munk, JASA 55 (1974) 220, and Pedersen & Gordon, JASA 41 (1967) 419.
namespace tubefoot {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr std::size_t kMostPoints = 1'000'000;

void check_extent(double top_m, double bottom_m, double fineness) {
  if (!(top_m < bottom_m) || !(fineness > 0) || !std::isfinite(bottom_m - top_m))
    throw std::invalid_argument(
        "to sample a profile, its bottom must be below its top and its step must be above 0");
}

ProfilePoint point_at(const std::function<double(double)>& speed, double depth_m) {
  return {depth_m, speed(depth_m)};
}

}  // namespace

SoundSpeedProfile::SoundSpeedProfile(double sound_speed_m_s)
    : SoundSpeedProfile(std::vector<ProfilePoint>{{0, sound_speed_m_s}}) {}

SoundSpeedProfile::SoundSpeedProfile(std::vector<ProfilePoint> points) : points_(std::move(points)) {
  if (points_.empty()) throw std::invalid_argument("a sound-speed profile needs at least one point");
  for (std::size_t i = 0; i < points_.size(); ++i) {
    const ProfilePoint& p = points_[i];
    if (!std::isfinite(p.depth_m) || !(p.sound_speed_m_s > 0) || !std::isfinite(p.sound_speed_m_s))
      throw std::invalid_argument(
          "the depths and speeds of a sound-speed profile must be finite, and the speeds above 0");
    if (i > 0 && !(p.depth_m > points_[i - 1].depth_m))
      throw std::invalid_argument("the depths of a sound-speed profile must increase");
  }
  gradient_.assign(points_.size() + 1, 0.0);
  for (std::size_t i = 1; i < points_.size(); ++i) {
    gradient_[i] = (points_[i].sound_speed_m_s - points_[i - 1].sound_speed_m_s) /
                   (points_[i].depth_m - points_[i - 1].depth_m);
    constant_ = constant_ && gradient_[i] == 0;
  }
}

std::size_t SoundSpeedProfile::layer_at(double depth_m) const {
  const auto below = std::upper_bound(points_.begin(), points_.end(), depth_m,
                                      [](double depth, const ProfilePoint& p) { return depth < p.depth_m; });
  return static_cast<std::size_t>(below - points_.begin());
}

double SoundSpeedProfile::top_m(std::size_t layer) const {
  return layer == 0 ? -kInfinity : points_[layer - 1].depth_m;
}

double SoundSpeedProfile::bottom_m(std::size_t layer) const {
  return layer == points_.size() ? kInfinity : points_[layer].depth_m;
}

double SoundSpeedProfile::speed_in(std::size_t layer, double depth_m) const {
  if (layer == 0) return points_.front().sound_speed_m_s;
  if (layer == points_.size()) return points_.back().sound_speed_m_s;
  const ProfilePoint &above = points_[layer - 1], &below = points_[layer];
  // Interpolates from the nearer end, so that both ends have exactly the speeds of the points.
  return depth_m - above.depth_m < below.depth_m - depth_m
             ? above.sound_speed_m_s + gradient_[layer] * (depth_m - above.depth_m)
             : below.sound_speed_m_s - gradient_[layer] * (below.depth_m - depth_m);
}

double SoundSpeedProfile::largest_bend_per_m() const {
  double slowest = points_.front().sound_speed_m_s, steepest = 0;
  for (const ProfilePoint& p : points_) slowest = std::min(slowest, p.sound_speed_m_s);
  for (const double gradient : gradient_) steepest = std::max(steepest, std::abs(gradient));
  return steepest / slowest;
}

std::vector<ProfilePoint> sample_profile(const std::function<double(double)>& speed, double top_m,
                                         double bottom_m, double step_m) {
  check_extent(top_m, bottom_m, step_m);
  const double steps = std::ceil((bottom_m - top_m) / step_m * (1 - 1e-12));
  if (!(steps < double(kMostPoints)))
    throw std::invalid_argument("the profile would have a million points or more: use larger steps");
  std::vector<ProfilePoint> points;
  for (double i = 0; i < steps; ++i)
    points.push_back(point_at(speed, top_m + (bottom_m - top_m) * (i / steps)));
  points.push_back(point_at(speed, bottom_m));
  return points;
}

std::vector<ProfilePoint> sample_profile_within(const std::function<double(double)>& speed, double top_m,
                                                double bottom_m, double error_m_s) {
  check_extent(top_m, bottom_m, error_m_s);
  std::vector<ProfilePoint> points = {point_at(speed, top_m)};
  std::vector<ProfilePoint> ahead = {point_at(speed, bottom_m)};  // interval ends that remain, deepest first
  while (!ahead.empty()) {
    const ProfilePoint from = points.back(), to = ahead.back();
    const double middle_m = (from.depth_m + to.depth_m) / 2;
    bool close = true;
    for (const double f : {0.25, 0.5, 0.75}) {
      const double straight = from.sound_speed_m_s + f * (to.sound_speed_m_s - from.sound_speed_m_s);
      close =
          close && std::abs(speed(from.depth_m + f * (to.depth_m - from.depth_m)) - straight) <= error_m_s;
    }
    // The first halvings are always made, because a profile that is symmetric about the middle of an
    // interval looks straight.
    if ((close && to.depth_m - from.depth_m <= (bottom_m - top_m) / 4) || !(from.depth_m < middle_m)) {
      points.push_back(to);
      ahead.pop_back();
    } else {
      ahead.push_back(point_at(speed, middle_m));
    }
    if (points.size() + ahead.size() >= kMostPoints)
      throw std::invalid_argument("the profile would have a million points or more: permit a larger error");
  }
  return points;
}

double munk_sound_speed_m_s(double depth_m, double axis_speed_m_s, double axis_m, double scale_m,
                            double epsilon) {
  const double eta = 2 * (depth_m - axis_m) / scale_m;
  return axis_speed_m_s * (1 + epsilon * (eta + std::exp(-eta) - 1));
}

double n2_linear_sound_speed_m_s(double depth_m, double surface_speed_m_s, double g_per_s) {
  const double n2 = 1 + 2 * g_per_s * depth_m / surface_speed_m_s;
  return n2 > 0 ? surface_speed_m_s / std::sqrt(n2) : kInfinity;
}

}  // namespace tubefoot
