// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

namespace tubefoot {

/// One point of a profile; depth is positive down from the sea surface.
struct ProfilePoint {
  double depth_m = 0;
  double sound_speed_m_s = 0;
};

/// Sound speed against depth: linear between points, so that rays are arcs of circles, and constant above the
/// first and below the last. The points cut the water into layers of one gradient each: layer 0 lies above
/// the first point, layer i between points i - 1 and i, the last one below all.
class SoundSpeedProfile {
 public:
  explicit SoundSpeedProfile(double sound_speed_m_s);
  /// Depths must increase, speeds be above 0, all finite. Throws std::invalid_argument.
  explicit SoundSpeedProfile(std::vector<ProfilePoint> points);

  const std::vector<ProfilePoint>& points() const { return points_; }
  bool is_constant() const { return constant_; }
  double at(double depth_m) const { return speed_in(layer_at(depth_m), depth_m); }

  std::size_t layers() const { return points_.size() + 1; }
  /// The layer that holds a depth; a point belongs to the layer below it.
  std::size_t layer_at(double depth_m) const;
  /// Minus and plus infinity for the outermost layers.
  double top_m(std::size_t layer) const;
  double bottom_m(std::size_t layer) const;
  /// dc/dz, positive where sound is faster further down.
  double gradient_per_s(std::size_t layer) const { return gradient_[layer]; }
  /// The steepest gradient over the slowest speed: no ray is curved more than that.
  double largest_bend_per_m() const;
  /// Sound speed at a depth within a layer; equals the points' speeds at its ends.
  double speed_in(std::size_t layer, double depth_m) const;

 private:
  std::vector<ProfilePoint> points_;
  std::vector<double> gradient_;  // by layer
  bool constant_ = true;
};

/// Points of a smooth profile from `top_m` to `bottom_m`, evenly spaced by at most `step_m`.
/// Throws std::invalid_argument unless top < bottom, step > 0 and fewer than a million points result.
std::vector<ProfilePoint> sample_profile(const std::function<double(double)>& speed, double top_m,
                                         double bottom_m, double step_m);

/// Points such that linear interpolation is within `error_m_s` at the quarters of each interval: intervals
/// are halved where it is not. Throws as sample_profile; error > 0.
std::vector<ProfilePoint> sample_profile_within(const std::function<double(double)>& speed, double top_m,
                                                double bottom_m, double error_m_s);

/// Munk, JASA 55 (1974) 220: the deep sound channel, c = c1 (1 + epsilon (eta + exp(-eta) - 1)) with
/// eta = 2 (z - axis) / scale.
double munk_sound_speed_m_s(double depth_m, double axis_speed_m_s = 1500, double axis_m = 1300,
                            double scale_m = 1300, double epsilon = 0.00737);

/// The profile whose square of refractive index is linear in depth, c = c0 / sqrt(1 + 2 g z / c0): rays are
/// parabolas (Pedersen & Gordon, JASA 41 (1967) 419). c falls with depth for g > 0. Infinite where
/// 1 + 2 g z / c0 <= 0.
double n2_linear_sound_speed_m_s(double depth_m, double surface_speed_m_s, double g_per_s);

}  // namespace tubefoot
