// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Maps the beams and samples of an acoustic camera to the pixels of a fan. Slant range counts from the
// camera, azimuth extends to the sides, and both axes have one scale. A pixel shows the mean energy of its
// cells.

#include <cstdint>
#include <span>
#include <vector>

#include "sensors/model/sensor.hpp"

namespace tubefoot {

/// Azimuth of a point at these distances to starboard and ahead. Among azimuths that differ by whole turns
/// the function selects the one between the borders, or the one nearest to their middle. A fan of a whole
/// turn may begin below -180 degrees.
double azimuth_between(double first_rad, double last_rad, double across, double ahead);

/// The beams of an acoustic camera on a page. The slant range counts from the camera at the bottom, and
/// azimuth extends to the sides. Forward is up, port is left, and both axes have one scale. Beams meet
/// midway between their axes. Coordinates are pixels from the top left corner of the fan's box.
class CameraFan {
 public:
  /// Limits the width and height to these numbers of pixels.
  CameraFan(const Sensor& sensor, double widest, double highest);
  /// The same for beams with these axes, in order. Requires more than one beam.
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

  /// Position at a distance of `pixels` from the camera in this direction.
  double x(double azimuth_rad, double pixels) const;
  double y(double azimuth_rad, double pixels) const;

  /// Index of the cell [beam][sample] at a position of the page; -1 outside of the fan.
  std::int64_t cell_at(double x, double y) const;

  /// Coverage of a pixel by range arcs and angle lines of one pixel's width.
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

/// Energies of a ping [beam][sample], and the number of samples of each beam that may contain a surface;
/// empty: all may.
struct PingEchoes {
  std::span<const double> energy;
  std::vector<int> surfaces;
};

/// Mean energy of the cells under a pixel that may contain a surface. `coverage` is the part of the pixel
/// inside the fan, and `beyond` the part of that beyond all surfaces.
struct PixelEcho {
  double energy_j = 0, coverage = 0, beyond = 0;
};

/// The cells of a ping that each pixel of a fan shows: the nearest cells at a square of points in the pixel,
/// without interpolation. They are the same for all pings, and computing them is most of the work of a
/// picture.
class CameraPixels {
 public:
  explicit CameraPixels(const CameraFan& fan);

  /// Width of the margin of pixels around the fan's box, on all four sides.
  static constexpr int around = 2;

  PixelEcho echo_at(int x, int y, const PingEchoes& echoes) const;
  /// The cell of a pixel that shows one cell without a margin, or -1. Most pixels show one cell, and all
  /// pixels of a cell have the same colour.
  std::int64_t only_cell_at(int x, int y) const;

 private:
  std::size_t pixel_at(int x, int y) const {
    return static_cast<std::size_t>(y + around) * static_cast<std::size_t>(width_) +
           static_cast<std::size_t>(x + around);
  }

  int width_, points_, samples_;
  std::vector<std::uint32_t> first_;  ///< by pixel, row by row: its first share; one more at the end
  std::vector<std::uint32_t> cells_;  ///< by share: its cell
  std::vector<std::uint8_t> counts_;  ///< by share: number of the pixel's points in that cell
};

}  // namespace tubefoot
