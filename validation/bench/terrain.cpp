// SPDX-License-Identifier: GPL-3.0-or-later
// Benchmark meshes: a seeded rough terrain with optional hidden sheets, a sector of tubes, and interlaced
// strips that pass through each other.
#include "terrain.hpp"

#include <cmath>
#include <cstdint>

#include "geometry/numbers/scalars.hpp"

namespace tubefoot {
namespace {

constexpr double extent_m = 20, apex_height_m = 3, apex_before_m = 2;

std::uint64_t mix(std::uint64_t x) {  // finaliser of splitmix64
  x ^= x >> 30;
  x *= 0xbf58476d1ce4e5b9u;
  x ^= x >> 27;
  x *= 0x94d049bb133111ebu;
  return x ^ (x >> 31);
}

/// Returns a standard normal number for a grid point, the same on every machine.
double normal(std::uint64_t i, std::uint64_t j) {
  const std::uint64_t h = mix(mix(i * 0x9e3779b97f4a7c15u + 1) + j);
  const double u = (static_cast<double>(h >> 11) + 0.5) * 0x1p-53;
  const double v = static_cast<double>(mix(h) >> 11) * 0x1p-53;
  return std::sqrt(-2 * std::log(u)) * std::cos(6.283185307179586 * v);
}

double relief(double x, double y) {
  return 0.3 * std::sin(1.3 * x + 0.9 * y) + 0.25 * std::cos(1.9 * y - 0.7 * x + 1) +
         0.2 * std::sin(0.5 * x - 2.7 * y);
}

}  // namespace

FacetMesh benchmark_terrain(int n, int hidden_behind) {
  FacetMesh mesh;
  const double cell = extent_m / n, unit = std::ldexp(1.0, terrain_grid_exponent);
  for (int sheet = 0; sheet <= hidden_behind; ++sheet) {
    const auto base = static_cast<VertexId>(mesh.vertices.size());
    // The sheets below the first one are never visible.
    const double drop = 4.0 * sheet;
    for (int j = 0; j <= n; ++j)
      for (int i = 0; i <= n; ++i) {
        const double x = i * cell - extent_m / 2, y = j * cell;
        const double z =
            relief(x, y) + 0.2 * cell * normal(std::uint64_t(i), std::uint64_t(j)) - apex_height_m - drop;
        mesh.vertices.push_back({static_cast<std::int32_t>(std::lround(x * unit)),
                                 static_cast<std::int32_t>(std::lround((y + apex_before_m) * unit)),
                                 static_cast<std::int32_t>(std::lround(z * unit))});
      }
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i) {
        const auto a = base + static_cast<VertexId>(j * (n + 1) + i), b = a + 1,
                   c = a + static_cast<VertexId>(n) + 1, d = c + 1;
        mesh.facets.push_back({a, b, d});
        mesh.facets.push_back({a, d, c});
      }
  }
  mesh.material.assign(mesh.facets.size(), 0);
  mesh.component.assign(mesh.facets.size(), 0);
  return mesh;
}

TubeSet benchmark_sector(int columns) {
  AngularGrid grid;
  for (int k = 0; k <= columns; ++k) grid.azimuth_edges_rad.push_back((29.0 * k / columns - 14.5) * degree);
  grid.elevation_edges_rad = {-12 * degree, 12 * degree};
  const double c = std::cos(14 * degree), s = std::sin(14 * degree);
  grid.frame = glm::dmat3(glm::dvec3(0, c, -s), glm::dvec3(1, 0, 0), glm::dvec3(0, s, c));
  TubeSet set;
  set.reach = 1e12;
  append_tubes(set, grid);
  return set;
}

FacetMesh benchmark_interlaced_strips(int count) {
  FacetMesh mesh;
  const double unit = std::ldexp(1.0, terrain_grid_exponent);
  for (int k = 0; k < count; ++k) {
    std::uint64_t drawn = 0;
    const auto between = [&](double lo, double hi) {
      const std::uint64_t h = mix(mix(std::uint64_t(k) * 0x9e3779b97f4a7c15u + 1) + ++drawn);
      return lo + (hi - lo) * static_cast<double>(h >> 11) * 0x1p-53;
    };
    const double x = between(-1, 1), z = between(-1, 1), turned = between(0, 3.141592653589793),
                 half = between(2, 4), width = between(0.02, 0.06), c = std::cos(turned),
                 s = std::sin(turned);
    const auto add = [&](double along, double across) {
      mesh.vertices.push_back({static_cast<std::int32_t>(std::lround((x + along * c - across * s) * unit)),
                               static_cast<std::int32_t>(std::lround(between(9, 11) * unit)),
                               static_cast<std::int32_t>(std::lround((z + along * s + across * c) * unit))});
      return static_cast<VertexId>(mesh.vertices.size() - 1);
    };
    const VertexId from = add(-half, 0), to = add(half, 0), beside = add(-half, width);
    mesh.facets.push_back({from, to, beside});
  }
  mesh.material.assign(mesh.facets.size(), 0);
  mesh.component.assign(mesh.facets.size(), 0);
  return mesh;
}

TubeSet interlaced_strips_tube() {
  TubeSet set;
  set.reach = 1e12;
  set.rays = {{-1, 10, 1}, {1, 10, 1}, {1, 10, -1}, {-1, 10, -1}};
  for (GridPoint& ray : set.rays) ray = {ray.x << 20, ray.y << 20, ray.z << 20};
  set.tubes = {{0, 1, 2, 3}};
  return set;
}

}  // namespace tubefoot
