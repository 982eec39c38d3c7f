// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <vector>

#include "engine/relief/elevation_field.hpp"

namespace tubefoot {

/// Distribution of the variance of heights over the magnitude of wavenumbers.
struct RadialSpectrum {
  double step_rad_m = 1;
  std::vector<double> power_m2;  ///< [b]: of wavenumbers within half a step of b steps
};

/// A grid of B-spline coefficients, row by row from the south-west, with the border that the spline needs.
class SplineGrid {
 public:
  SplineGrid(std::size_t columns, std::size_t rows)
      : columns_(columns), rows_(rows), padded_((columns + 3) * (rows + 3)) {}

  std::size_t columns() const { return columns_; }
  std::size_t rows() const { return rows_; }
  /// Returns the coefficients of a row: columns -1 to columns + 1, rows -1 to rows + 1.
  float* row(std::ptrdiff_t j) { return padded_.data() + (j + 1) * (columns_ + 3) + 1; }
  const float* row(std::ptrdiff_t j) const { return padded_.data() + (j + 1) * (columns_ + 3) + 1; }
  /// Copies the grid's opposite sides to the border. Call it when all coefficients are set.
  void close();

 private:
  std::size_t columns_, rows_;
  std::vector<float> padded_;
};

/// Heights over the horizontal plane as a bicubic B-spline, which is twice continuously differentiable. The
/// height is a convex combination of the coefficients; slopes and curvatures are convex combinations of their
/// first and second differences. The bounds of this class follow from that. The spline is evaluated in double
/// with +, -, *, / and floor alone. A place therefore has the same height to the last bit on every machine.
/// The evaluation ignores z.
class SplineSurface final : public ElevationField {
 public:
  struct Lattice {
    double west_m = 0, south_m = 0;  ///< of node (0, 0)
    double spacing_x_m = 1, spacing_y_m = 1;
    /// Whether the grid is repeated without end. Otherwise the surface is flat beyond the grid, and the two
    /// outermost rings of coefficients must be 0.
    bool periodic = true;
  };
  SplineSurface(const Lattice& lattice, SplineGrid grid, const RadialSpectrum& spectrum);

  double height_m(glm::dvec3 place_m) const override;
  double largest_m() const override { return largest_m_; }
  /// Returns the node distance.
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
  std::vector<double> oscillation_m_;  // [j]: over any window of at most 2^(j + 3) node distances
  struct Rms {
    double edge_m, height_m, slope;
  };
  std::vector<Rms> rms_;  // by increasing edge length
};

}  // namespace tubefoot
