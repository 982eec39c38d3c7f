// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

namespace tubefoot {

/// One point of a profile. The depth is positive down from the sea surface.
struct ProfilePoint {
  double depth_m = 0;
  double sound_speed_m_s = 0;
};

/// Sound speed as a function of depth. It is linear between points, so that rays are arcs of circles, and
/// constant above the first and below the last point. The points divide the water into layers of one
/// gradient each. Layer 0 lies above the first point, layer i between points i - 1 and i, and the last layer
/// below all points.
class SoundSpeedProfile {
 public:
  explicit SoundSpeedProfile(double sound_speed_m_s);
  /// Throws std::invalid_argument unless depths increase, speeds are above 0 and all values are finite.
  explicit SoundSpeedProfile(std::vector<ProfilePoint> points);

  const std::vector<ProfilePoint>& points() const { return points_; }
  bool is_constant() const { return constant_; }
  double at(double depth_m) const { return speed_in(layer_at(depth_m), depth_m); }

  std::size_t layers() const { return points_.size() + 1; }
  /// Returns the layer that contains a depth. A point belongs to the layer below it.
  std::size_t layer_at(double depth_m) const;
  /// Minus and plus infinity for the outermost layers.
  double top_m(std::size_t layer) const;
  double bottom_m(std::size_t layer) const;
  /// dc/dz, positive if sound is faster at greater depth.
  double gradient_per_s(std::size_t layer) const { return gradient_[layer]; }
  /// Returns the steepest gradient divided by the slowest speed, which bounds the curvature of rays.
  double largest_bend_per_m() const;
  /// Returns the sound speed at a depth within a layer. At the ends of the layer it equals the speeds of the
  /// points.
  double speed_in(std::size_t layer, double depth_m) const;

 private:
  std::vector<ProfilePoint> points_;
  std::vector<double> gradient_;  // by layer
  bool constant_ = true;
};

/// Samples a smooth profile from `top_m` to `bottom_m` at uniform steps of at most `step_m`. Throws
/// std::invalid_argument unless top < bottom, step > 0 and the result has fewer than a million points.
std::vector<ProfilePoint> sample_profile(const std::function<double(double)>& speed, double top_m,
                                         double bottom_m, double step_m);

/// Samples a profile so that linear interpolation has an error of at most `error_m_s` at the quarters of
/// each interval. Intervals with a larger error are halved. Throws as sample_profile; the error must be
/// above 0.
std::vector<ProfilePoint> sample_profile_within(const std::function<double(double)>& speed, double top_m,
                                                double bottom_m, double error_m_s);

/// Sound speed of Munk's deep sound channel, JASA 55 (1974) 220: c = c1 (1 + epsilon (eta + exp(-eta) - 1))
/// with eta = 2 (z - axis) / scale.
double munk_sound_speed_m_s(double depth_m, double axis_speed_m_s = 1500, double axis_m = 1300,
                            double scale_m = 1300, double epsilon = 0.00737);

/// Profile whose squared refractive index is linear in depth: c = c0 / sqrt(1 + 2 g z / c0). Its rays are
/// parabolas (Pedersen & Gordon, JASA 41 (1967) 419). For g > 0, c decreases with depth. The result is
/// infinite if 1 + 2 g z / c0 <= 0.
double n2_linear_sound_speed_m_s(double depth_m, double surface_speed_m_s, double g_per_s);

}  // namespace tubefoot
