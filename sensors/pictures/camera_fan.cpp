// SPDX-License-Identifier: GPL-3.0-or-later
// Geometry of an acoustic camera's fan in a picture: positions of beams and samples, cells under pixels, and
// coverage by grid lines.

#include "sensors/pictures/camera_fan.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "sensors/model/lens_beams.hpp"

namespace tubefoot {
namespace {

std::vector<double> borders_of(const std::vector<BeamAxis>& beams) {
  const BeamAxis& first = beams.front();
  if (beams.size() == 1)
    return {first.azimuth_rad - first.azimuth_width_rad / 2, first.azimuth_rad + first.azimuth_width_rad / 2};
  std::vector<double> centres;
  for (const BeamAxis& beam : beams) centres.push_back(beam.azimuth_rad);
  return borders_between(centres);
}

/// Coverage of a pixel by a line of one pixel's width at this distance.
float line_coverage(double distance_pixels) {
  return static_cast<float>(std::clamp(1 - std::abs(distance_pixels), 0.0, 1.0));
}

}  // namespace

double azimuth_between(double first_rad, double last_rad, double across, double ahead) {
  const double azimuth = std::atan2(across, ahead);
  if (azimuth >= first_rad && azimuth <= last_rad) return azimuth;
  const double middle = (first_rad + last_rad) / 2;
  return middle + std::remainder(azimuth - middle, 2 * std::numbers::pi);
}

CameraFan::CameraFan(const Sensor& sensor, double widest, double highest)
    : CameraFan(sensor.samples(), borders_of(sensor.beams()), widest, highest) {}

CameraFan::CameraFan(const std::vector<double>& azimuths_rad, const RangeSamples& samples, double widest,
                     double highest)
    : CameraFan(samples, borders_between(azimuths_rad), widest, highest) {}

CameraFan::CameraFan(const RangeSamples& samples, std::vector<double> borders_rad, double widest,
                     double highest)
    : borders_rad_(std::move(borders_rad)),
      near_m_(samples.first_m),
      far_m_(samples.first_m + samples.count * samples.step_m),
      step_m_(samples.step_m),
      samples_(samples.count) {
  double left_m = far_m_, right_m = -far_m_, low_m = far_m_, high_m = -far_m_;
  constexpr int steps = 720;
  for (int k = 0; k <= steps; ++k) {
    const double azimuth = first_azimuth_rad() + extent_rad() * k / steps;
    for (const double range : {near_m_, far_m_}) {
      left_m = std::min(left_m, range * std::sin(azimuth));
      right_m = std::max(right_m, range * std::sin(azimuth));
      low_m = std::min(low_m, range * std::cos(azimuth));
      high_m = std::max(high_m, range * std::cos(azimuth));
    }
  }
  pixels_per_m_ = std::min(widest / (right_m - left_m), highest / (high_m - low_m));
  width_ = static_cast<int>(std::ceil((right_m - left_m) * pixels_per_m_));
  height_ = static_cast<int>(std::ceil((high_m - low_m) * pixels_per_m_));
  apex_x_ = -left_m * pixels_per_m_;
  apex_y_ = high_m * pixels_per_m_;
}

double CameraFan::x(double azimuth_rad, double pixels) const {
  return apex_x_ + pixels * std::sin(azimuth_rad);
}
double CameraFan::y(double azimuth_rad, double pixels) const {
  return apex_y_ - pixels * std::cos(azimuth_rad);
}

std::int64_t CameraFan::cell_at(double x, double y) const {
  const double across = (x - apex_x_) / pixels_per_m_, ahead = (apex_y_ - y) / pixels_per_m_;
  const double sample = (std::hypot(across, ahead) - near_m_) / step_m_;
  if (sample < 0 || sample >= samples_) return -1;
  const auto border = std::ranges::upper_bound(
      borders_rad_, azimuth_between(first_azimuth_rad(), last_azimuth_rad(), across, ahead));
  if (border == borders_rad_.begin() || border == borders_rad_.end()) return -1;
  return (border - borders_rad_.begin() - 1) * samples_ + static_cast<std::int64_t>(sample);
}

CameraFan::Lines CameraFan::lines_at(double x, double y, double range_step_m, double angle_step_rad) const {
  const double across = x - apex_x_, ahead = apex_y_ - y;
  const double range = std::hypot(across, ahead);  // in pixels
  const double near = near_m_ * pixels_per_m_, far = far_m_ * pixels_per_m_;
  if (range < near - 1 || range > far + 1) return {};
  const double azimuth = azimuth_between(first_azimuth_rad(), last_azimuth_rad(), across, ahead),
               slack = 1 / std::max(range, 1.0);
  if (azimuth < first_azimuth_rad() - slack || azimuth > last_azimuth_rad() + slack) return {};
  Lines covered;
  covered.outline = std::max(line_coverage(range - near), line_coverage(range - far));
  for (const double edge : {first_azimuth_rad(), last_azimuth_rad()})
    if (std::cos(azimuth - edge) > 0)
      covered.outline = std::max(covered.outline, line_coverage(range * std::sin(azimuth - edge)));
  const double arc = std::round(range / pixels_per_m_ / range_step_m) * range_step_m;
  const double ray = std::round(azimuth / angle_step_rad) * angle_step_rad;
  covered.grid =
      std::max(line_coverage(range - arc * pixels_per_m_), line_coverage(range * std::sin(azimuth - ray)));
  return covered;
}

CameraPixels::CameraPixels(const CameraFan& fan)
    : width_(fan.width() + 2 * around),
      points_(std::clamp(static_cast<int>(std::ceil(1 / (fan.pixels_per_m_ * fan.step_m_))), 3, 8)),
      samples_(fan.samples()) {
  // The beam of all points of a pixel, or -1 if it is unknown. A pixel reaches less than 0.708 pixels from
  // its centre, and an arc sine is at most pi / 2 times its argument.
  const auto beam_of_all = [&](int x, int y) -> std::int64_t {
    constexpr double reach = 0.708;
    const double across = x + 0.5 - fan.apex_x_, ahead = fan.apex_y_ - y - 0.5;
    const double range = std::hypot(across, ahead), azimuth = std::atan2(across, ahead),
                 slack = std::numbers::pi / 2 * reach / range;
    if (!(range > reach) || std::abs(azimuth) + slack >= std::numbers::pi) return -1;
    const auto border = std::ranges::upper_bound(fan.borders_rad_, azimuth);
    if (border == fan.borders_rad_.begin() || border == fan.borders_rad_.end()) return -1;
    if (azimuth - slack <= *(border - 1) || azimuth + slack >= *border) return -1;
    return border - fan.borders_rad_.begin() - 1;
  };
  // As CameraFan::cell_at() in that beam.
  const auto cell_in = [&](std::int64_t beam, double x, double y) -> std::int64_t {
    const double across = (x - fan.apex_x_) / fan.pixels_per_m_,
                 ahead = (fan.apex_y_ - y) / fan.pixels_per_m_;
    const double sample = (std::hypot(across, ahead) - fan.near_m_) / fan.step_m_;
    return sample < 0 || sample >= samples_ ? -1 : beam * samples_ + static_cast<std::int64_t>(sample);
  };
  struct Row {
    std::vector<std::uint32_t> first, cells;
    std::vector<std::uint8_t> counts;
  };
  std::vector<Row> rows(static_cast<std::size_t>(fan.height() + 2 * around));
  tbb::parallel_for(std::size_t{0}, rows.size(), [&](std::size_t k) {
    Row& row = rows[k];
    const int y = static_cast<int>(k) - around;
    std::vector<std::uint32_t> under;
    for (int x = -around; x < width_ - around; ++x) {
      under.clear();
      const std::int64_t beam = beam_of_all(x, y);
      for (int j = 0; j < points_; ++j)
        for (int i = 0; i < points_; ++i) {
          const double u = x + (i + 0.5) / points_, v = y + (j + 0.5) / points_;
          if (const std::int64_t cell = beam < 0 ? fan.cell_at(u, v) : cell_in(beam, u, v); cell >= 0)
            under.push_back(static_cast<std::uint32_t>(cell));
        }
      std::ranges::sort(under);
      row.first.push_back(static_cast<std::uint32_t>(row.cells.size()));
      for (auto cell = under.begin(); cell != under.end();) {
        const auto end = std::find_if(cell, under.end(), [&](std::uint32_t other) { return other != *cell; });
        row.cells.push_back(*cell);
        row.counts.push_back(static_cast<std::uint8_t>(end - cell));
        cell = end;
      }
    }
  });
  first_.reserve(static_cast<std::size_t>(width_) * rows.size() + 1);
  for (Row& row : rows) {
    const auto before = static_cast<std::uint32_t>(cells_.size());
    for (const std::uint32_t first : row.first) first_.push_back(before + first);
    cells_.insert(cells_.end(), row.cells.begin(), row.cells.end());
    counts_.insert(counts_.end(), row.counts.begin(), row.counts.end());
    row = {};
  }
  first_.push_back(static_cast<std::uint32_t>(cells_.size()));
}

std::int64_t CameraPixels::only_cell_at(int x, int y) const {
  const std::size_t pixel = pixel_at(x, y);
  const std::uint32_t share = first_[pixel];
  if (first_[pixel + 1] != share + 1 || counts_[share] != points_ * points_) return -1;
  return cells_[share];
}

PixelEcho CameraPixels::echo_at(int x, int y, const PingEchoes& echoes) const {
  const std::size_t pixel = pixel_at(x, y);
  double sum = 0;
  int inside = 0, beyond = 0;
  for (std::uint32_t k = first_[pixel]; k < first_[pixel + 1]; ++k) {
    const std::uint32_t cell = cells_[k];
    const double energy = echoes.energy[cell];
    const auto samples = static_cast<std::uint32_t>(samples_);
    inside += counts_[k];
    if (!(energy > 0) && !echoes.surfaces.empty() &&
        static_cast<int>(cell % samples) >= echoes.surfaces[cell / samples])
      beyond += counts_[k];
    else
      sum += counts_[k] * energy;
  }
  if (inside == 0) return {};
  return {beyond < inside ? sum / (inside - beyond) : 0, inside / static_cast<double>(points_ * points_),
          beyond / static_cast<double>(inside)};
}

}  // namespace tubefoot
