// SPDX-License-Identifier: GPL-3.0-or-later

// Creates flat and fractal terrains on regular grids. Fractal relief is a sum of octaves of gradient noise
// (Perlin 1985, with his quintic fade of 2002). Heights are the same on every machine.

#include "scene/rasters/terrain.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "files/limits.hpp"
#include "files/memory_at_hand.hpp"
#include "geometry/steps/stop.hpp"

namespace tubefoot {
namespace {

void check_positive(double value, const char* what, const SourcePlace& place) {
  if (!(value > 0) || !std::isfinite(value)) {
    throw InputError(place, fmt::format("{} is {}, expected more than 0", what, value));
  }
}

// Returns the number of cells along one side, none longer than cell_m.
double cells_along(double extent_m, double cell_m) {
  return std::max(1.0,
                  std::ceil(extent_m / cell_m * (1 - 1e-12)));  // 50 m in cells of 0.1 m are 500, not 501
}

// Rounds a result to single precision. The last bit of library functions differs between machines; single
// precision removes the difference except for rare ties.
double portable(double value) { return static_cast<double>(static_cast<float>(value)); }

// A slope, as heights above the centre of a terrain.
struct Slope {
  double east = 0, north = 0;  // rise per metre
  template <class Terrain>
  static Slope of(const Terrain& terrain, const SourcePlace& place) {
    if (terrain.slope_deg == 0) return {};
    if (!(std::abs(terrain.slope_deg) <= 80))
      throw InputError(place, fmt::format("slope_deg is {}, expected -80 to 80", terrain.slope_deg));
    const double fall = std::tan(terrain.slope_deg * std::numbers::pi / 180),
                 heading = terrain.slope_heading_deg * std::numbers::pi / 180;
    return {-portable(fall * std::sin(heading)), -portable(fall * std::cos(heading))};
  }
};

// Returns a plane grid of columns x rows cells, row by row from the south-west, with facets that face up.
template <class Terrain>
ComponentMesh grid_facets(const Terrain& terrain, double cell_m, const SourcePlace& place) {
  const double width_m = terrain.width_m, length_m = terrain.length_m;
  const std::array<double, 3>& centre_m = terrain.centre_m;
  const Slope slope = Slope::of(terrain, place);
  check_positive(width_m, "width_m", place);
  check_positive(length_m, "length_m", place);
  check_positive(cell_m, "cell_m", place);
  const double columns = cells_along(width_m, cell_m), rows = cells_along(length_m, cell_m);
  if (!(columns * rows <= limits::cells)) {
    throw InputError(place, fmt::format("the terrain would have {:.3g} cells, but at most {:.3g} are "
                                        "allowed: give a larger cell_m or a smaller extent",
                                        columns * rows, limits::cells));
  }
  require_memory(2 * bytes_a_facet * columns * rows, place,
                 fmt::format("the terrain's {:.3g} cells", columns * rows),
                 "give a larger cell_m or a smaller extent");
  const auto nx = static_cast<std::uint32_t>(columns), ny = static_cast<std::uint32_t>(rows);
  ComponentMesh mesh;
  mesh.points_m.reserve((std::size_t{nx} + 1) * (std::size_t{ny} + 1));
  mesh.triangles.reserve(std::size_t{2} * nx * ny);
  for (std::uint32_t j = 0; j <= ny; ++j) {
    stop_if_wanted();
    for (std::uint32_t i = 0; i <= nx; ++i) {
      const double east_m = width_m * (i / columns - 0.5), north_m = length_m * (j / rows - 0.5);
      mesh.points_m.emplace_back(centre_m[0] + east_m, centre_m[1] + north_m,
                                 centre_m[2] + (slope.east * east_m + slope.north * north_m));
    }
  }
  for (std::uint32_t j = 0; j < ny; ++j) {
    stop_if_wanted();
    for (std::uint32_t i = 0; i < nx; ++i) {
      const std::uint32_t sw = j * (nx + 1) + i, se = sw + 1, nw = sw + nx + 1, ne = nw + 1;
      mesh.triangles.push_back({sw, se, ne});
      mesh.triangles.push_back({sw, ne, nw});
    }
  }
  return mesh;
}

// Returns a number that depends only on the arguments (SplitMix64's finaliser), so that the order of
// evaluation does not matter.
std::uint64_t hash(std::uint64_t seed, std::uint64_t octave, std::int64_t x, std::int64_t y) {
  std::uint64_t h = seed;
  for (const std::uint64_t part : {octave, static_cast<std::uint64_t>(x), static_cast<std::uint64_t>(y)}) {
    h = (h ^ part) + 0x9e3779b97f4a7c15u;
    h = (h ^ (h >> 30)) * 0xbf58476d1ce4e5b9u;
    h = (h ^ (h >> 27)) * 0x94d049bb133111ebu;
    h ^= h >> 31;
  }
  return h;
}

// The halves of a hash as two numbers in [-1, 1).
struct Pair {
  double u, v;
};
Pair pair(std::uint64_t h) {
  return {static_cast<double>(h >> 32) * 0x1p-31 - 1, static_cast<double>(h & 0xffffffffu) * 0x1p-31 - 1};
}

// Returns gradient noise of lattice constant 1 (Perlin 1985, with his quintic fade of 2002).
double gradient_noise(std::uint64_t seed, std::uint64_t octave, double x, double y) {
  const double x0 = std::floor(x), y0 = std::floor(y), fx = x - x0, fy = y - y0;
  const auto ix = static_cast<std::int64_t>(x0), iy = static_cast<std::int64_t>(y0);
  const auto slope = [&](int dx, int dy) {
    const Pair gradient = pair(hash(seed, octave, ix + dx, iy + dy));
    return gradient.u * (fx - dx) + gradient.v * (fy - dy);
  };
  const auto fade = [](double t) { return t * t * t * (t * (6 * t - 15) + 10); };
  const auto mix = [](double a, double b, double t) { return a + t * (b - a); };
  const double u = fade(fx), v = fade(fy);
  return mix(mix(slope(0, 0), slope(1, 0), u), mix(slope(0, 1), slope(1, 1), u), v);
}

// The sum of the octaves at a position, without normalisation.
class FractalNoise {
 public:
  FractalNoise(std::uint64_t seed, double hurst, double largest_m, double smallest_m)
      : seed_(seed), gain_(portable(std::exp2(-hurst))), largest_m_(largest_m) {
    for (double wavelength = largest_m; wavelength >= smallest_m || octaves_ == 0; wavelength /= 2)
      ++octaves_;
  }

  double operator()(double x_m, double y_m) const {
    double sum = 0, amplitude = 1, x = x_m / largest_m_, y = y_m / largest_m_;
    for (std::uint64_t octave = 0; octave < octaves_; ++octave) {
      // Gradient noise is 0 at its lattice points. Shift and rotation of each octave's lattice keep these
      // points apart.
      const Pair shift = pair(hash(seed_, octave, std::int64_t{1} << 62, 0));
      sum += amplitude * gradient_noise(seed_, octave, x + 64 * shift.u, y + 64 * shift.v);
      amplitude *= gain_;
      const double turned =
          0.8 * x -
          0.6 * y;  // rotation by an angle of the 3-4-5 triangle, without trigonometry and rounding modes
      y = 2 * (0.6 * x + 0.8 * y);
      x = 2 * turned;
    }
    return sum;
  }

 private:
  std::uint64_t seed_;
  double gain_;
  double largest_m_;
  std::uint64_t octaves_ = 0;
};

void normalise(std::vector<double>& heights, double rms) {
  double mean = 0, square = 0;
  for (const double h : heights) mean += h;
  mean /= static_cast<double>(heights.size());
  for (double& h : heights) {
    h -= mean;
    square += h * h;
  }
  const double scale = square > 0 ? rms / std::sqrt(square / static_cast<double>(heights.size())) : 0;
  for (double& h : heights) h *= scale;
}

}  // namespace

ComponentMesh flat_facets(const FlatTerrain& terrain, const SourcePlace& place) {
  const double cell = terrain.cell_m == 0 ? std::max(terrain.width_m, terrain.length_m) : terrain.cell_m;
  return grid_facets(terrain, cell, place);
}

ComponentMesh fractal_facets(const FractalTerrain& terrain, const SourcePlace& place) {
  ComponentMesh mesh = grid_facets(terrain, terrain.cell_m, place);
  if (!(terrain.hurst >= 0 && terrain.hurst <= 1)) {
    throw InputError(place, fmt::format("hurst is {}, expected 0 (rough) to 1 (smooth)", terrain.hurst));
  }
  if (!(terrain.rms_height_m >= 0) || !std::isfinite(terrain.rms_height_m)) {
    throw InputError(place, fmt::format("rms_height_m is {}, expected at least 0", terrain.rms_height_m));
  }
  const double largest = terrain.largest_wavelength_m == 0 ? std::max(terrain.width_m, terrain.length_m)
                                                           : terrain.largest_wavelength_m;
  check_positive(largest, "largest_wavelength_m", place);
  const FractalNoise noise(terrain.seed, terrain.hurst, largest, 2 * terrain.cell_m);
  std::vector<double> heights;
  heights.reserve(mesh.points_m.size());
  for (const glm::dvec3& p : mesh.points_m) {
    stop_if_wanted();
    heights.push_back(noise(p.x - terrain.centre_m[0], p.y - terrain.centre_m[1]));
  }
  normalise(heights, terrain.rms_height_m);
  for (std::size_t i = 0; i < heights.size(); ++i) mesh.points_m[i].z += heights[i];

  if (terrain.ripple_height_m != 0) {
    check_positive(terrain.ripple_height_m, "ripple_height_m", place);
    check_positive(terrain.ripple_wavelength_m, "ripple_wavelength_m", place);
    const double direction = terrain.ripple_direction_deg * std::numbers::pi / 180;
    const double east = portable(std::sin(direction)), north = portable(std::cos(direction));
    for (glm::dvec3& p : mesh.points_m) {
      stop_if_wanted();
      const double along = east * (p.x - terrain.centre_m[0]) + north * (p.y - terrain.centre_m[1]);
      const double wave = std::sin(2 * std::numbers::pi * along / terrain.ripple_wavelength_m);
      p.z += portable(0.5 * terrain.ripple_height_m * wave);
    }
  }
  return mesh;
}

}  // namespace tubefoot
