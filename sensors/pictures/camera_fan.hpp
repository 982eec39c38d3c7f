// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "sensors/model/sensor.hpp"

namespace tubefoot {

/// The azimuth of a place to starboard and ahead: the one of those a whole turn apart that lies between two
/// borders, or is nearest to their middle. A fan all around may begin below -180 degrees.
double azimuth_between(double first_rad, double last_rad, double across, double ahead);

/// An acoustic camera's beams on a page: slant range from the camera at the bottom, azimuth to the sides,
/// forward up and port left, both axes at one scale. Beams meet midway between their axes. Coordinates are
/// pixels from the top left one of the fan's box.
class CameraFan {
 public:
  /// At most so many pixels wide and high.
  CameraFan(const Sensor& sensor, double widest, double highest);
  /// Of beams with these axes, in order; of one beam there is no fan.
  CameraFan(const std::vector<double>& azimuths_rad, const RangeSamples& samples, double widest,
            double highest);

  int width() const { return width_; }
  int height() const { return height_; }
  double near_m() const { return near_m_; }
  double far_m() const { return far_m_; }
  int beams() const { return static_cast<int>(borders_rad_.size()) - 1; }
  int samples() const { return samples_; }
  double first_azimuth_rad() const { return borders_rad_.front(); }
  double last_azimuth_rad() const { return borders_rad_.back(); }
  double extent_rad() const { return last_azimuth_rad() - first_azimuth_rad(); }
  double pixels_per_m() const { return pixels_per_m_; }

  /// A place at `pixels` from the camera.
  double x(double azimuth_rad, double pixels) const;
  double y(double azimuth_rad, double pixels) const;

  /// The cell [beam][sample] at a place of the page, or -1 outside of the fan.
  std::int64_t cell_at(double x, double y) const;

  /// How much of a pixel's middle range arcs and angle lines cover, lines of one pixel's width.
  struct Lines {
    float grid = 0, outline = 0;
  };
  Lines lines_at(double x, double y, double range_step_m, double angle_step_rad) const;

 private:
  std::vector<double> borders_rad_;  ///< of the beams
  double near_m_, far_m_, step_m_;
  int samples_;
  double pixels_per_m_ = 0, apex_x_ = 0, apex_y_ = 0;
  int width_ = 0, height_ = 0;

  CameraFan(const RangeSamples& samples, std::vector<double> borders_rad, double widest, double highest);

  friend class CameraPixels;
};

/// Energies of a ping [beam][sample], and of each beam the number of samples that may hold a surface; empty:
/// all may.
struct PingEchoes {
  std::span<const double> energy;
  std::vector<int> surfaces;
};

/// Mean energy of the cells under a pixel that may hold a surface, the part of the pixel that the fan covers,
/// and the part of that which lies beyond all surfaces.
struct PixelEcho {
  double energy_j = 0, coverage = 0, beyond = 0;
};

/// Which cells of a ping each pixel of a fan shows: those at a square of points in it, nearest cell, no
/// interpolation. The same for all pings, and most of the work of drawing one.
class CameraPixels {
 public:
  explicit CameraPixels(const CameraFan& fan);

  /// Pixels beyond the fan's box that this knows, on all four sides.
  static constexpr int around = 2;

  PixelEcho echo_at(int x, int y, const PingEchoes& echoes) const;
  /// The cell that a pixel shows alone and without a margin, or -1: most do, and all of a cell's alike.
  std::int64_t only_cell_at(int x, int y) const;

 private:
  std::size_t pixel_at(int x, int y) const {
    return static_cast<std::size_t>(y + around) * static_cast<std::size_t>(width_) +
           static_cast<std::size_t>(x + around);
  }

  int width_, points_, samples_;
  std::vector<std::uint32_t> first_;  ///< of each pixel, row by row, its first share; one more at the end
  std::vector<std::uint32_t> cells_;  ///< of each share, its cell
  std::vector<std::uint8_t> counts_;  ///< of each share, how many points of the pixel lie in its cell
};

}  // namespace tubefoot
