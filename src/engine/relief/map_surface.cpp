// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/relief/map_surface.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <utility>

#include "engine/relief/fourier.hpp"

// Interpolates a height map by a bicubic B-spline. The coefficients c satisfy (c[k - 1] + 4 c[k] + c[k + 1])
// / 6 = s[k] along rows and columns. The radial spectrum of the heights comes from a Fourier transform.

namespace tubefoot {
namespace {

// Computes the B-spline coefficients c of the values s along a line, with zeros beyond its ends: (c[k - 1] +
// 4 c[k] + c[k + 1]) / 6 = s[k]. The method is elimination and back substitution.
class LineSolver {
 public:
  explicit LineSolver(std::size_t longest) : pivot_(longest) {
    double before = 0;
    for (double& p : pivot_) before = p = 1 / (4 - before);
  }
  void operator()(std::vector<double>& line) const {
    double before = 0;
    for (std::size_t k = 0; k < line.size(); ++k) before = line[k] = (6 * line[k] - before) * pivot_[k];
    for (std::size_t k = line.size() - 1; k-- > 0;) line[k] -= pivot_[k] * line[k + 1];
  }

 private:
  std::vector<double> pivot_;
};

// Converts heights to coefficients in place. A value n nodes away has the weight (2 - sqrt(3))^n, so few
// copies of a period at its ends suffice.
void interpolate(HeightMap& map) {
  constexpr std::size_t margin = 40;
  const LineSolver solve(std::max(map.columns, map.rows) + 2 * margin);
  std::vector<double> line;
  const auto along = [&](std::size_t first, std::size_t step, std::size_t count) {
    const std::size_t beside = map.periodic ? margin : 0;
    line.resize(count + 2 * beside);
    const std::size_t shift = count * margin - beside;  // a multiple of the period, minus the margin
    for (std::size_t k = 0; k < line.size(); ++k)
      line[k] = map.height_m[first + (map.periodic ? (k + shift) % count : k) * step];
    solve(line);
    for (std::size_t k = 0; k < count; ++k) map.height_m[first + k * step] = line[k + beside];
  };
  for (std::size_t j = 0; j < map.rows; ++j) along(j * map.columns, 1, map.columns);
  for (std::size_t i = 0; i < map.columns; ++i) along(i, map.columns, map.rows);
}

RadialSpectrum spectrum_of(const HeightMap& map) {
  const std::vector<std::complex<long double>> waves = plane_waves(map.height_m, map.columns, map.rows);
  const double width_m = static_cast<double>(map.columns) * map.spacing_x_m,
               length_m = static_cast<double>(map.rows) * map.spacing_y_m;
  const double longest_m = std::max(width_m, length_m);
  RadialSpectrum spectrum{2 * std::numbers::pi / longest_m, {}};
  const std::size_t half = map.columns / 2 + 1;
  for (std::size_t j = 0; j < map.rows; ++j)
    for (std::size_t i = 0; i < half; ++i) {
      if (i == 0 && j == 0) continue;  // the mean is not part of the relief
      const double x = static_cast<double>(i) / width_m,
                   y = static_cast<double>(std::min(j, map.rows - j)) / length_m;
      const auto bin = static_cast<std::size_t>(std::sqrt(x * x + y * y) * longest_m + 0.5);
      if (bin >= spectrum.power_m2.size()) spectrum.power_m2.resize(bin + 1);
      const double copies = i == 0 || 2 * i == map.columns ? 1 : 2;
      spectrum.power_m2[bin] += copies * static_cast<double>(std::norm(waves[j * half + i]));
    }
  return spectrum;
}

HeightMap with_border(const HeightMap& map) {
  const auto border = static_cast<double>(kMapBorder);
  HeightMap wider{map.columns + 2 * kMapBorder,
                  map.rows + 2 * kMapBorder,
                  map.west_m - border * map.spacing_x_m,
                  map.south_m - border * map.spacing_y_m,
                  map.spacing_x_m,
                  map.spacing_y_m,
                  false,
                  {}};
  wider.height_m.resize(wider.columns * wider.rows);
  for (std::size_t j = 0; j < map.rows; ++j)
    std::copy_n(
        map.height_m.begin() + static_cast<std::ptrdiff_t>(j * map.columns), map.columns,
        wider.height_m.begin() + static_cast<std::ptrdiff_t>((j + kMapBorder) * wider.columns + kMapBorder));
  return wider;
}

}  // namespace

std::shared_ptr<const SplineSurface> make_surface(HeightMap map) {
  if (!map.periodic) map = with_border(map);
  const RadialSpectrum spectrum = spectrum_of(map);
  interpolate(map);
  SplineGrid grid(map.columns, map.rows);
  const std::size_t rings = map.periodic ? 0 : 2;
  for (std::size_t j = rings; j + rings < map.rows; ++j) {
    float* const row = grid.row(static_cast<std::ptrdiff_t>(j));
    for (std::size_t i = rings; i + rings < map.columns; ++i)
      row[i] = static_cast<float>(map.height_m[j * map.columns + i]);
  }
  return std::make_shared<SplineSurface>(
      SplineSurface::Lattice{map.west_m, map.south_m, map.spacing_x_m, map.spacing_y_m, map.periodic},
      std::move(grid), spectrum);
}

}  // namespace tubefoot
