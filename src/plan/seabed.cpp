// SPDX-License-Identifier: GPL-3.0-or-later
// Heights of the terrain for scene drawings: facets in a window, height maps by rasterisation, and profiles
// along sections. A shaded picture has light from the north-west.
#include "plan/seabed.hpp"

#include <cairo.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <memory>
#include <span>
#include <stdexcept>

#include "geometry/steps/stop.hpp"

namespace tubefoot {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity(),
                 none = std::numeric_limits<double>::quiet_NaN();

bool meets(const Window& window, glm::dvec3 lo, glm::dvec3 hi) {
  return lo.x <= window.hi_m.x && hi.x >= window.lo_m.x && lo.y <= window.hi_m.y && hi.y >= window.lo_m.y;
}

using TakeFacet = std::function<void(const std::array<glm::dvec3, 3>&)>;

void each_facet_of(const ComponentMesh& mesh, const TakeFacet& take) {
  for (const auto& [a, b, c] : mesh.triangles) take({mesh.points_m[a], mesh.points_m[b], mesh.points_m[c]});
}

/// Visits each tile as two facets. The height of a corner is the mean of the heights of the adjacent tiles.
void each_coarse_facet(const TerrainTiles& terrain, const std::vector<std::uint32_t>& tiles,
                       const TakeFacet& take) {
  const auto columns = static_cast<std::ptrdiff_t>(terrain.columns()),
             rows = static_cast<std::ptrdiff_t>(terrain.rows());
  const auto corner_up = [&](std::ptrdiff_t row, std::ptrdiff_t column, double own) {
    double sum = 0, count = 0;
    for (std::ptrdiff_t r = std::max<std::ptrdiff_t>(row - 1, 0); r <= std::min(row, rows - 1); ++r)
      for (std::ptrdiff_t c = std::max<std::ptrdiff_t>(column - 1, 0); c <= std::min(column, columns - 1);
           ++c) {
        const TerrainTiles::Tile& tile = terrain.tiles()[static_cast<std::size_t>(r * columns + c)];
        if (tile.facets > 0) sum += (tile.lo_m.z + tile.hi_m.z) / 2, ++count;
      }
    return count > 0 ? sum / count : own;
  };
  for (const std::uint32_t k : tiles) {
    const TerrainTiles::Tile& tile = terrain.tiles()[k];
    const std::ptrdiff_t row = k / columns, column = k % columns;
    const double own = (tile.lo_m.z + tile.hi_m.z) / 2;
    const glm::dvec3 north_west(tile.lo_m.x, tile.hi_m.y, corner_up(row, column, own)),
        north_east(tile.hi_m.x, tile.hi_m.y, corner_up(row, column + 1, own)),
        south_west(tile.lo_m.x, tile.lo_m.y, corner_up(row + 1, column, own)),
        south_east(tile.hi_m.x, tile.lo_m.y, corner_up(row + 1, column + 1, own));
    take({north_west, south_west, south_east});
    take({north_west, south_east, north_east});
  }
}

}  // namespace

bool each_terrain_facet(const Survey& survey, const Window& window, const TakeFacet& take) {
  const Scene& scene = survey.scene;
  const std::size_t terrains = scene.description.terrains.size();
  for (std::size_t f = 0; f < scene.mesh.facets.size(); ++f) {
    if (scene.mesh.component[f] >= terrains) continue;
    if (f % 65536 == 0) stop_if_wanted();
    std::array<glm::dvec3, 3> corners;
    for (std::size_t k = 0; k < 3; ++k)
      corners[k] = scene.grid.to_metres(scene.mesh.vertices[scene.mesh.facets[f][k]]);
    if (meets(window, glm::min(corners[0], glm::min(corners[1], corners[2])),
              glm::max(corners[0], glm::max(corners[1], corners[2]))))
      take(corners);
  }
  bool coarse = false;
  for (const TiledTerrain& tiled : scene.tiled) {
    if (!tiled.tiles) continue;
    std::vector<std::uint32_t> within;
    for (std::uint32_t k = 0; k < tiled.tiles->tiles().size(); ++k)
      if (const TerrainTiles::Tile& tile = tiled.tiles->tiles()[k];
          tile.facets > 0 && meets(window, tile.lo_m, tile.hi_m))
        within.push_back(k);
    constexpr std::size_t most_read = 400,
                          at_a_time = 64;  // more tiles have more cells than the drawing has pixels
    if (within.size() > most_read) {
      coarse = true;
      each_coarse_facet(*tiled.tiles, within, take);
      continue;
    }
    for (std::size_t k = 0; k < within.size(); k += at_a_time) {
      stop_if_wanted();
      each_facet_of(tiled.tiles->read(std::span(within).subspan(k, std::min(at_a_time, within.size() - k))),
                    take);
    }
  }
  return coarse;
}

PlanHeights::PlanHeights(const Window& window, int most)
    : window_(window), lowest_m_(infinity), highest_m_(-infinity) {
  const glm::dvec2 size = window.hi_m - window.lo_m;
  cell_m_ = std::max(size.x, size.y) / most;
  columns_ = std::clamp(static_cast<int>(std::lround(size.x / cell_m_)), 1, most);
  rows_ = std::clamp(static_cast<int>(std::lround(size.y / cell_m_)), 1, most);
  up_m_.assign(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_), none);
}

void PlanHeights::add(const std::array<glm::dvec3, 3>& facet) {
  std::array<glm::dvec3, 3> p;  // east and north in cells, from the centre of the first cell
  for (std::size_t k = 0; k < 3; ++k)
    p[k] = {(facet[k].x - window_.lo_m.x) / cell_m_ - 0.5, (facet[k].y - window_.lo_m.y) / cell_m_ - 0.5,
            facet[k].z};
  const double twice_area = (p[1].x - p[0].x) * (p[2].y - p[0].y) - (p[1].y - p[0].y) * (p[2].x - p[0].x);
  if (twice_area == 0 || !std::isfinite(twice_area)) return;
  const double bottom = std::min({p[0].y, p[1].y, p[2].y}), top = std::max({p[0].y, p[1].y, p[2].y});
  if (top < 0 || bottom > rows_ - 1) return;
  for (int row = static_cast<int>(std::ceil(std::max(bottom, 0.0))),
           last = static_cast<int>(std::floor(std::min(top, rows_ - 1.0)));
       row <= last; ++row) {
    double lo = infinity, hi = -infinity;
    for (std::size_t k = 0; k < 3; ++k) {
      const glm::dvec3 &a = p[k], &b = p[(k + 1) % 3];
      if (std::min(a.y, b.y) > row || std::max(a.y, b.y) < row) continue;
      const double from = a.y == b.y ? a.x : a.x + (b.x - a.x) * ((row - a.y) / (b.y - a.y)),
                   to = a.y == b.y ? b.x : from;
      lo = std::min({lo, from, to}), hi = std::max({hi, from, to});
    }
    constexpr double rounding = 1e-9;
    lo = std::max(lo - rounding, 0.0), hi = std::min(hi + rounding, columns_ - 1.0);
    for (int column = static_cast<int>(std::ceil(lo)); column <= hi; ++column) {
      const double b = ((column - p[0].x) * (p[2].y - p[0].y) - (row - p[0].y) * (p[2].x - p[0].x)) /
                       twice_area,
                   c = ((p[1].x - p[0].x) * (row - p[0].y) - (p[1].y - p[0].y) * (column - p[0].x)) /
                       twice_area,
                   up = p[0].z + b * (p[1].z - p[0].z) + c * (p[2].z - p[0].z);
      double& known = up_m_[static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) +
                            static_cast<std::size_t>(column)];
      if (!(known >= up)) known = up;
      lowest_m_ = std::min(lowest_m_, up), highest_m_ = std::max(highest_m_, up);
    }
  }
}

std::optional<double> PlanHeights::at(glm::dvec2 place_m) const {
  const glm::dvec2 cells = (place_m - window_.lo_m) / cell_m_ - 0.5;
  if (!(cells.x >= -0.5 && cells.y >= -0.5 && cells.x <= columns_ - 0.5 && cells.y <= rows_ - 0.5))
    return std::nullopt;
  const int column = std::clamp(static_cast<int>(std::floor(cells.x)), 0, std::max(columns_ - 2, 0)),
            row = std::clamp(static_cast<int>(std::floor(cells.y)), 0, std::max(rows_ - 2, 0));
  double sum = 0, weights = 0;
  for (int r = row; r <= std::min(row + 1, rows_ - 1); ++r)
    for (int c = column; c <= std::min(column + 1, columns_ - 1); ++c)
      if (const double up = up_m(c, r); !std::isnan(up)) {
        const double weight =
            std::max(1 - std::abs(cells.x - c), 0.0) * std::max(1 - std::abs(cells.y - r), 0.0);
        sum += weight * up, weights += weight;
      }
  if (!(weights > 0)) return std::nullopt;
  return sum / weights;
}

std::optional<double> PlanHeights::distance_m(glm::dvec3 from_m, glm::dvec3 direction, double most_m) const {
  if (empty()) return std::nullopt;
  // Restricts the ray to the box of the terrain.
  double first = 0, last = most_m;
  const std::array<std::array<double, 4>, 3> slabs{
      {{from_m.x, direction.x, window_.lo_m.x, window_.hi_m.x},
       {from_m.y, direction.y, window_.lo_m.y, window_.hi_m.y},
       {from_m.z, direction.z, lowest_m_ - 1e-3 * cell_m_, highest_m_ + 1e-3 * cell_m_}}};
  for (const auto& [from, way, lo, hi] : slabs) {
    if (way == 0) {
      if (from < lo || from > hi) return std::nullopt;
      continue;
    }
    const double a = (lo - from) / way, b = (hi - from) / way;
    first = std::max(first, std::min(a, b)), last = std::min(last, std::max(a, b));
  }
  if (!(first < last)) return std::nullopt;
  const auto over = [&](double way_m) -> std::optional<double> {
    const glm::dvec3 place = from_m + way_m * direction;
    const std::optional<double> up = at({place.x, place.y});
    if (!up) return std::nullopt;
    return place.z - *up;
  };
  if (const std::optional<double> begin = over(first); first == 0 && begin && *begin < 0) return std::nullopt;
  const double level_cells = (last - first) * std::hypot(direction.x, direction.y) / cell_m_;
  const int steps = std::clamp(static_cast<int>(1.5 * level_cells), 8, 4000);
  double before = first;
  for (int k = 1; k <= steps; ++k) {
    const double here = first + (last - first) * k / steps;
    const std::optional<double> height = over(here);
    if (!height || *height > 0) {
      before = here;
      continue;
    }
    double lo = before, hi = here;
    for (int halving = 0; halving < 20; ++halving) {
      const double middle = (lo + hi) / 2;
      const std::optional<double> up = over(middle);
      (!up || *up > 0 ? lo : hi) = middle;
    }
    return hi;
  }
  return std::nullopt;
}

namespace {

using Oklab = std::array<double, 3>;

Oklab tint(double share) {
  // Colours from deep to shallow. The colours of the sensors must stand out from them.
  constexpr std::array<Oklab, 3> stops{{{0.56, 0.66, 0.73}, {0.78, 0.80, 0.76}, {0.95, 0.90, 0.78}}};
  const double at = std::clamp(share, 0.0, 1.0) * (stops.size() - 1);
  const auto k = std::min(static_cast<std::size_t>(at), stops.size() - 2);
  Oklab mixed;
  for (std::size_t c = 0; c < 3; ++c)
    mixed[c] = stops[k][c] + (at - static_cast<double>(k)) * (stops[k + 1][c] - stops[k][c]);
  return mixed;
}

std::uint32_t byte_of(double component) {
  return static_cast<std::uint32_t>(std::lround(255 * std::clamp(component, 0.0, 1.0)));
}

}  // namespace

std::string seabed_colour(double share_of_height) {
  const Oklab c = tint(share_of_height);
  return fmt::format("#{:02x}{:02x}{:02x}", byte_of(c[0]), byte_of(c[1]), byte_of(c[2]));
}

std::string shaded(const PlanHeights& heights, double low_m, double high_m) {
  const int columns = heights.columns(), rows = heights.rows();
  // Slope towards the north-west, if there are neighbours.
  const auto slope = [&](int column, int row) {
    const auto rise = [&](int dc, int dr) {
      const int c0 = std::max(column - dc, 0), c1 = std::min(column + dc, columns - 1),
                r0 = std::max(row - dr, 0), r1 = std::min(row + dr, rows - 1);
      const double cells = (c1 - c0) + (r1 - r0);
      const double value =
          cells > 0 ? (heights.up_m(c1, r1) - heights.up_m(c0, r0)) / (cells * heights.cell_m()) : 0;
      return std::isnan(value) ? 0 : value;
    };
    return (rise(0, 1) - rise(1, 0)) / std::sqrt(2.0);
  };
  double squares = 0, count = 0;
  for (int row = 0; row < rows; ++row)
    for (int column = 0; column < columns; ++column)
      if (!std::isnan(heights.up_m(column, row))) squares += std::pow(slope(column, row), 2), ++count;
  constexpr double gentle = 0.02;
  const double usual = std::max(count > 0 ? 2 * std::sqrt(squares / count) : 0, gentle);

  const std::unique_ptr<cairo_surface_t, void (*)(cairo_surface_t*)> surface(
      cairo_image_surface_create(CAIRO_FORMAT_ARGB32, columns, rows), cairo_surface_destroy);
  if (cairo_surface_status(surface.get()) != CAIRO_STATUS_SUCCESS)
    throw std::runtime_error("cannot draw the seabed: " +
                             std::string(cairo_status_to_string(cairo_surface_status(surface.get()))));
  cairo_surface_flush(surface.get());
  unsigned char* bytes = cairo_image_surface_get_data(surface.get());
  const auto stride = static_cast<std::size_t>(cairo_image_surface_get_stride(surface.get()));
  for (int row = 0; row < rows; ++row)
    for (int column = 0; column < columns; ++column) {
      const double up = heights.up_m(column, row);
      if (std::isnan(up)) continue;
      // Few levels of both, which compress well.
      const double share = high_m > low_m ? std::round(24 * (up - low_m) / (high_m - low_m)) / 24 : 0.5,
                   light = 1 - 0.16 * std::round(4 * std::clamp(slope(column, row) / usual, -1.0, 1.0)) / 4;
      const Oklab c = tint(share);
      auto* pixel =
          reinterpret_cast<std::uint32_t*>(bytes + static_cast<std::size_t>(rows - 1 - row) * stride) +
          column;
      *pixel = 0xff000000u | byte_of(light * c[0]) << 16 | byte_of(light * c[1]) << 8 | byte_of(light * c[2]);
    }
  cairo_surface_mark_dirty(surface.get());
  std::string png;
  const auto put = [](void* to, const unsigned char* data, unsigned int size) {
    static_cast<std::string*>(to)->append(reinterpret_cast<const char*>(data), size);
    return CAIRO_STATUS_SUCCESS;
  };
  if (const cairo_status_t status = cairo_surface_write_to_png_stream(surface.get(), put, &png);
      status != CAIRO_STATUS_SUCCESS)
    throw std::runtime_error(std::string("cannot draw the seabed: ") + cairo_status_to_string(status));
  return png;
}

Profile::Profile(double from_m, double to_m, int columns)
    : from_m_(from_m),
      step_m_((to_m - from_m) / columns),
      lowest_m_(static_cast<std::size_t>(columns), infinity),
      highest_m_(static_cast<std::size_t>(columns), -infinity) {}

void Profile::add(double along_a, double up_a, double along_b, double up_b) {
  if (along_a > along_b) std::swap(along_a, along_b), std::swap(up_a, up_b);
  const double first = (along_a - from_m_) / step_m_ - 0.5, last = (along_b - from_m_) / step_m_ - 0.5;
  const auto count = static_cast<double>(columns());
  if (!(last >= 0) || !(first <= count - 1)) return;
  constexpr double rounding = 1e-9;
  for (double column = std::ceil(std::max(first - rounding, 0.0));
       column <= std::min(last + rounding, count - 1); ++column) {
    const auto k = static_cast<std::size_t>(column);
    const double up = last > first
                          ? up_a + (up_b - up_a) * std::clamp((column - first) / (last - first), 0.0, 1.0)
                          : std::max(up_a, up_b);
    lowest_m_[k] = std::min(lowest_m_[k], up), highest_m_[k] = std::max(highest_m_[k], up);
  }
}

void Profile::add(const std::array<glm::dvec3, 3>& facet, bool cut) {
  std::array<glm::dvec2, 3> crossings;
  std::size_t count = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const glm::dvec3 &a = facet[k], &b = facet[(k + 1) % 3];
    if (!cut) {
      add(a.x, a.y, b.x, b.y);
      continue;
    }
    if ((a.z >= 0) == (b.z >= 0)) continue;
    const double at = a.z / (a.z - b.z);
    crossings[count++] = {a.x + at * (b.x - a.x), a.y + at * (b.y - a.y)};
  }
  if (count == 2) add(crossings[0].x, crossings[0].y, crossings[1].x, crossings[1].y);
}

}  // namespace tubefoot
