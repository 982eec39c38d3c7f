// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/relief/spline_surface.hpp"

#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "geometry/steps/stop.hpp"

// Evaluates bicubic B-splines of heights and bounds the error of their linear interpolation. The bounds
// follow from differences of coefficients; the estimates follow from the radial spectrum.

namespace tubefoot {
namespace {

// The result of a mathematical function, rounded to single precision, is the same on every machine, except
// for rare ties.
double portable(double value) { return static_cast<double>(static_cast<float>(value)); }

std::array<double, 4> cubic_weights(double f) {
  const double g = 1 - f, f3 = f * f * f;
  const double first = g * g * g / 6, last = f3 / 6, second = (4 - 6 * f * f + 3 * f3) / 6;
  return {first, second, 1 - first - second - last, last};
}

struct Extremes {
  float lo = std::numeric_limits<float>::infinity(), hi = -std::numeric_limits<float>::infinity();
  void add(const Extremes& other) {
    lo = std::min(lo, other.lo);
    hi = std::max(hi, other.hi);
  }
};

// Extremes of square blocks of coefficients on a periodic grid. The last blocks of a row or column may be
// narrower.
struct Blocks {
  std::size_t columns = 0, rows = 0;
  std::vector<Extremes> blocks;

  Blocks(std::size_t wide, std::size_t high) : columns(wide), rows(high), blocks(wide * high) {}
  Extremes& at(std::size_t i, std::size_t j) { return blocks[j * columns + i]; }
  const Extremes& at(std::size_t i, std::size_t j) const { return blocks[j * columns + i]; }

  Blocks halved() const {
    Blocks half((columns + 1) / 2, (rows + 1) / 2);
    for (std::size_t j = 0; j < rows; ++j)
      for (std::size_t i = 0; i < columns; ++i) half.at(i / 2, j / 2).add(at(i, j));
    return half;
  }

  // Returns the largest difference within any `wide` x `high` blocks.
  double oscillation(std::size_t wide, std::size_t high) const {
    Blocks of_rows(columns, rows);
    for (std::size_t j = 0; j < rows; ++j)
      for (std::size_t i = 0; i < columns; ++i)
        for (std::size_t n = 0, k = i; n < wide; ++n, k = k + 1 == columns ? 0 : k + 1)
          of_rows.at(i, j).add(at(k, j));
    double largest = 0;
    for (std::size_t j = 0; j < rows; ++j)
      for (std::size_t i = 0; i < columns; ++i) {
        Extremes all;
        for (std::size_t n = 0, k = j; n < high; ++n, k = k + 1 == rows ? 0 : k + 1)
          all.add(of_rows.at(i, k));
        largest = std::max(largest, static_cast<double>(all.hi) - static_cast<double>(all.lo));
      }
    return largest;
  }
};

// Returns the number of blocks of `size` coefficients that a window of the length of 4 blocks may need. It
// covers 4 size + 4 coefficients, and one block more if there is a narrower block at the period's end.
std::size_t blocks_in_window(std::size_t size, std::size_t period) {
  return 5 + (size + 2) / size + (period % size != 0 ? 1 : 0);
}

// Returns the share of the variance of a wave of wavenumber K with random phase that linear interpolation
// between nodes `edge` apart does not represent. `half` is K edge / 2.
double height_share(double half) {
  // The two branches differ at their border by less than 1e-6 of the share.
  if (half < 0.05) return half * half * half * half * (2.0 / 15 - half * half * 22 / 945);
  const double sinc = std::sin(half) / half;
  return 1 + (2 + std::cos(2 * half)) / 3 - 2 * sinc * sinc;
}
double slope_share(double half) {
  if (half < 1e-3) return half * half / 3;
  const double sinc = std::sin(half) / half;
  return 1 - sinc * sinc;
}

}  // namespace

void SplineGrid::close() {
  const auto columns = static_cast<std::ptrdiff_t>(columns_), rows = static_cast<std::ptrdiff_t>(rows_);
  for (std::ptrdiff_t j = 0; j < rows; ++j) {
    stop_if_wanted();
    float* const r = row(j);
    r[-1] = r[columns - 1];
    r[columns] = r[0];
    r[columns + 1] = r[1];
  }
  for (const auto& [to, from] :
       {std::pair{std::ptrdiff_t{-1}, rows - 1}, {rows, std::ptrdiff_t{0}}, {rows + 1, std::ptrdiff_t{1}}})
    std::copy_n(row(from) - 1, columns + 3, row(to) - 1);
}

SplineSurface::SplineSurface(const Lattice& lattice, SplineGrid grid, const RadialSpectrum& spectrum)
    : lattice_(lattice),
      grid_(std::move(grid)),
      nodes_per_m_x_(1 / lattice.spacing_x_m),
      nodes_per_m_y_(1 / lattice.spacing_y_m),
      periods_per_node_x_(1 / static_cast<double>(grid_.columns())),
      periods_per_node_y_(1 / static_cast<double>(grid_.rows())) {
  grid_.close();
  bound_derivatives();
  tabulate_oscillation();
  tabulate_rms(spectrum);
}

double SplineSurface::height_m(glm::dvec3 place_m) const {
  double u = (place_m.x - lattice_.west_m) * nodes_per_m_x_,
         v = (place_m.y - lattice_.south_m) * nodes_per_m_y_;
  const auto columns = static_cast<double>(grid_.columns()), rows = static_cast<double>(grid_.rows());
  if (lattice_.periodic) {
    u -= columns * std::floor(u * periods_per_node_x_);
    v -= rows * std::floor(v * periods_per_node_y_);
    // Rounding may leave the period by an ulp.
    if (!(u >= 0 && u < columns)) u = 0;
    if (!(v >= 0 && v < rows)) v = 0;
  } else if (!(u >= 0 && u < columns && v >= 0 && v < rows)) {
    return 0;
  }
  const auto i = static_cast<std::ptrdiff_t>(u),
             j = static_cast<std::ptrdiff_t>(v);  // floor, because u and v are not negative
  const std::array<double, 4> wx = cubic_weights(u - static_cast<double>(i)),
                              wy = cubic_weights(v - static_cast<double>(j));
  const float* c = grid_.row(j - 1) + i - 1;
  double height = 0;
  for (int r = 0; r < 4; ++r, c += grid_.columns() + 3)
    height += wy[r] * (wx[0] * c[0] + wx[1] * c[1] + wx[2] * c[2] + wx[3] * c[3]);
  return height;
}

double SplineSurface::finest_m() const { return std::min(lattice_.spacing_x_m, lattice_.spacing_y_m); }

// Differences of neighbouring coefficients bound the derivatives, because the derivative of a B-spline is a
// B-spline with these differences as coefficients.
void SplineSurface::bound_derivatives() {
  struct Largest {
    double height = 0, x = 0, y = 0, xx = 0, xy = 0, yy = 0;
  };
  const auto columns = static_cast<std::ptrdiff_t>(grid_.columns()),
             rows = static_cast<std::ptrdiff_t>(grid_.rows());
  const auto of_rows = [&](const tbb::blocked_range<std::ptrdiff_t>& range, Largest most) {
    for (std::ptrdiff_t j = range.begin(); j < range.end(); ++j) {
      stop_if_wanted();
      const float *const below = grid_.row(j - 1), *const here = grid_.row(j),
                         *const above = grid_.row(j + 1);
      for (std::ptrdiff_t i = 0; i < columns; ++i) {
        const double c = here[i], east = here[i + 1], north = above[i];
        most.height = std::max(most.height, std::abs(c));
        most.x = std::max(most.x, std::abs(east - c));
        most.y = std::max(most.y, std::abs(north - c));
        most.xx = std::max(most.xx, std::abs(east - 2 * c + here[i - 1]));
        most.yy = std::max(most.yy, std::abs(north - 2 * c + below[i]));
        most.xy = std::max(most.xy, std::abs(above[i + 1] - north - east + c));
      }
    }
    return most;
  };
  const Largest most = tbb::parallel_reduce(
      tbb::blocked_range<std::ptrdiff_t>(0, rows, 64), Largest{}, of_rows,
      [](const Largest& a, const Largest& b) {
        return Largest{std::max(a.height, b.height), std::max(a.x, b.x),   std::max(a.y, b.y),
                       std::max(a.xx, b.xx),         std::max(a.xy, b.xy), std::max(a.yy, b.yy)};
      });
  const double dx = lattice_.spacing_x_m, dy = lattice_.spacing_y_m;
  constexpr double rounding = 1 + 1e-9;  // of these bounds and of height_m
  largest_m_ = most.height * rounding;
  const double east = most.x / dx, north = most.y / dy;
  largest_slope_ = std::sqrt(east * east + north * north) * rounding;
  // The largest eigenvalue of the matrix of the largest second derivatives bounds the eigenvalues of the
  // matrix at every place.
  const double xx = most.xx / (dx * dx), yy = most.yy / (dy * dy), xy = most.xy / (dx * dy);
  largest_curvature_per_m_ = ((xx + yy) / 2 + std::sqrt((xx - yy) * (xx - yy) / 4 + xy * xy)) * rounding;
}

void SplineSurface::tabulate_oscillation() {
  const std::size_t columns = grid_.columns(), rows = grid_.rows();
  Blocks blocks((columns + 1) / 2, (rows + 1) / 2);
  for (std::size_t j = 0; j < rows; ++j) {
    const float* const row = grid_.row(static_cast<std::ptrdiff_t>(j));
    for (std::size_t i = 0; i < columns; ++i) blocks.at(i / 2, j / 2).add({row[i], row[i]});
  }
  for (std::size_t size = 2; 2 * size < std::max(columns, rows); size *= 2) {
    stop_if_wanted();
    if (size > 2) blocks = blocks.halved();
    oscillation_m_.push_back(blocks.oscillation(std::min(blocks.columns, blocks_in_window(size, columns)),
                                                std::min(blocks.rows, blocks_in_window(size, rows))));
  }
}

void SplineSurface::tabulate_rms(const RadialSpectrum& spectrum) {
  double variance = 0;
  for (const double power : spectrum.power_m2) variance += power;
  rms_height_m_ = portable(std::sqrt(variance));
  const double longest = std::max(lattice_.spacing_x_m * static_cast<double>(grid_.columns()),
                                  lattice_.spacing_y_m * static_cast<double>(grid_.rows()));
  constexpr double ratio = 1.189207115;  // 2^(1/4)
  for (double edge = finest_m() / 8; edge < 4 * longest; edge *= ratio) {
    double height = 0, slope = 0;
    for (std::size_t b = 1; b < spectrum.power_m2.size(); ++b) {
      const double wavenumber = static_cast<double>(b) * spectrum.step_rad_m, half = wavenumber * edge / 2;
      height += spectrum.power_m2[b] * height_share(half);
      slope += spectrum.power_m2[b] * wavenumber * wavenumber * slope_share(half);
    }
    rms_.push_back({edge, portable(std::sqrt(height)), portable(std::sqrt(slope))});
  }
}

ElevationField::LeftOut SplineSurface::left_out(double edge_m) const {
  LeftOut left;
  const auto above = std::ranges::upper_bound(rms_, edge_m, {}, &Rms::edge_m);
  if (above ==
      rms_.begin()) {  // the relief is smooth at this scale: second order in height, first order in slope
    const double part = edge_m / rms_.front().edge_m;
    left.rms_height_m = part * part * rms_.front().height_m;
    left.rms_slope = part * rms_.front().slope;
  } else if (above == rms_.end()) {
    left.rms_height_m = rms_.back().height_m;
    left.rms_slope = rms_.back().slope;
  } else {
    const Rms &a = above[-1], &b = *above;
    const double part = (edge_m - a.edge_m) / (b.edge_m - a.edge_m);
    left.rms_height_m = a.height_m + part * (b.height_m - a.height_m);
    left.rms_slope = a.slope + part * (b.slope - a.slope);
  }

  // A triangle with edges of at most e fits in a circle of radius e / sqrt(3) (Jung). For a place x = sum of
  // l_i v_i, sum of l_i |x - v_i|^2 <= e^2 / 3. Taylor's theorem about x gives M e^2 / 6, and the Lipschitz
  // condition gives L e / sqrt(3). The triangle also lies in a square window of side e.
  constexpr double inverse_root_3 = 0.57735026918962577;
  left.largest_height_m =
      std::min(largest_curvature_per_m_ * edge_m * edge_m / 6, largest_slope_ * edge_m * inverse_root_3);
  double window_m = 8 * finest_m();
  for (const double oscillation : oscillation_m_) {
    if (edge_m <= window_m) {
      left.largest_height_m = std::min(left.largest_height_m, oscillation);
      break;
    }
    window_m *= 2;
  }
  left.largest_height_m = std::min(left.largest_height_m, 2 * largest_m_);
  left.largest_slope = std::min(2 * largest_curvature_per_m_ * edge_m, 3 * largest_slope_);
  return left;
}

}  // namespace tubefoot
