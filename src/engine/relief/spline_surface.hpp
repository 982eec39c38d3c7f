// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <vector>

#include "engine/relief/elevation_field.hpp"

namespace tubefoot {

/// How the variance of heights is spread over wavenumbers, whatever their direction.
struct RadialSpectrum {
  double step_rad_m = 1;
  std::vector<double> power_m2;  ///< [b]: of wavenumbers within half a step of b steps
};

/// A grid of B-spline coefficients, row by row from the south-west, with the border that the spline looks at.
class SplineGrid {
 public:
  SplineGrid(std::size_t columns, std::size_t rows)
      : columns_(columns), rows_(rows), padded_((columns + 3) * (rows + 3)) {}

  std::size_t columns() const { return columns_; }
  std::size_t rows() const { return rows_; }
  /// The coefficients of a row: columns -1 to columns + 1, rows -1 to rows + 1.
  float* row(std::ptrdiff_t j) { return padded_.data() + (j + 1) * (columns_ + 3) + 1; }
  const float* row(std::ptrdiff_t j) const { return padded_.data() + (j + 1) * (columns_ + 3) + 1; }
  /// Repeats the grid's opposite sides in the border: to be called when all coefficients are there.
  void close();

 private:
  std::size_t columns_, rows_;
  std::vector<float> padded_;
};

/// Heights over the horizontal plane as a bicubic B-spline: twice continuously differentiable, and a convex
/// combination of its coefficients, their first differences (slopes) and second differences (curvatures),
/// which makes this class's bounds. It is evaluated in double with +, -, *, / and floor alone, so that a
/// place has the same height to the last bit everywhere. z is not looked at.
class SplineSurface final : public ElevationField {
 public:
  struct Lattice {
    double west_m = 0, south_m = 0;  ///< of node (0, 0)
    double spacing_x_m = 1, spacing_y_m = 1;
    /// Repeated without end; else flat beyond the grid, whose two outermost rings of coefficients are 0 then.
    bool periodic = true;
  };
  SplineSurface(const Lattice& lattice, SplineGrid grid, const RadialSpectrum& spectrum);

  double height_m(glm::dvec3 place_m) const override;
  double largest_m() const override { return largest_m_; }
  /// The distance of nodes.
  double finest_m() const override;
  LeftOut left_out(double edge_m) const override;

  const Lattice& lattice() const { return lattice_; }
  std::size_t columns() const { return grid_.columns(); }
  std::size_t rows() const { return grid_.rows(); }
  double rms_height_m() const { return rms_height_m_; }

 private:
  void bound_derivatives();
  void tabulate_oscillation();
  void tabulate_rms(const RadialSpectrum& spectrum);

  Lattice lattice_;
  SplineGrid grid_;
  double nodes_per_m_x_, nodes_per_m_y_, periods_per_node_x_, periods_per_node_y_;
  double largest_m_ = 0, largest_slope_ = 0, largest_curvature_per_m_ = 0, rms_height_m_ = 0;
  std::vector<double> oscillation_m_;  // [j]: over any window of 2^(j + 3) nodes' distance or less
  struct Rms {
    double edge_m, height_m, slope;
  };
  std::vector<Rms> rms_;  // edges ascending
};

}  // namespace tubefoot
