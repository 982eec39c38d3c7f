// SPDX-License-Identifier: GPL-3.0-or-later

// Joins the supergrids of a BAG of variable resolution to one surface without cracks, and samples such a
// surface at one resolution.

#include "scene/rasters/variable_grid.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>

#include "geometry/steps/stop.hpp"
#include "scene/rasters/raster_reader.hpp"

namespace tubefoot {
namespace {

using Supergrid = BagRefinements::Supergrid;
constexpr std::uint32_t hole = RasterReader::hole;

/// A node for facets: its position, which exists without data as well, and its vertex (or hole).
struct Node {
  glm::dvec2 place;
  std::uint32_t vertex;
};

/// Returns twice the area of a triangle, positive if counter-clockwise.
double turn(glm::dvec2 a, glm::dvec2 b, glm::dvec2 c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

class Joiner {
 public:
  Joiner(const VariableGrid& grid, const SourcePlace& place) : grid_(grid), place_(place) {}

  ComponentMesh run() {
    for (std::size_t row = 0; row < grid_.rows; ++row)
      for (std::size_t column = 0; column < grid_.columns; ++column) take_nodes(row, column);
    for (std::size_t row = 0; row < grid_.rows; ++row) {
      stop_if_wanted();
      for (std::size_t column = 0; column < grid_.columns; ++column) {
        join_within(row, column);
        const bool east = column + 1 < grid_.columns, north = row + 1 < grid_.rows;
        if (east) join_strip(side(row, column, true, true), side(row, column + 1, true, false));
        if (north) join_strip(side(row + 1, column, false, false), side(row, column, false, true));
        if (east && north) join_corner(row, column);
      }
    }
    return std::move(mesh_);
  }

 private:
  const Supergrid& at(std::size_t row, std::size_t column) const {
    return grid_.refinements.at(grid_.row + row, grid_.column + column);
  }
  Node node(std::size_t row, std::size_t column, std::size_t j, std::size_t i) const {
    const Supergrid& s = at(row, column);
    const std::size_t cell = row * grid_.columns + column;
    return {place_of(row, column, j, i), vertices_[first_[cell] + j * s.columns + i]};
  }
  glm::dvec2 place_of(std::size_t row, std::size_t column, std::size_t j, std::size_t i) const {
    const Supergrid& s = at(row, column);
    const auto cell = [](std::size_t k) { return static_cast<double>(k); };
    return {grid_.west + cell(grid_.column + column) * grid_.cell_x + s.first_x + cell(i) * s.step_x,
            grid_.south + cell(grid_.row + row) * grid_.cell_y + s.first_y + cell(j) * s.step_y};
  }

  void take_nodes(std::size_t row, std::size_t column) {
    const Supergrid& s = at(row, column);
    first_.push_back(vertices_.size());
    if (s.columns == 0) {
      ++mesh_.hole_cells;
      return;
    }
    // Strips lie between the nodes of two cells. They require that nodes lie within their cells.
    if (!(s.first_x + (s.columns - 1) * s.step_x < grid_.cell_x) ||
        !(s.first_y + (s.rows - 1) * s.step_y < grid_.cell_y))
      throw InputError(
          place_, fmt::format("the supergrid at row {}, column {} (counted from 0, from the south-west) is "
                              "too large: {} x {} nodes with a spacing of {:g} x {:g} extend beyond a cell "
                              "of {:g} x {:g}; resample the file to one resolution with {}",
                              grid_.row + row, grid_.column + column, s.columns, s.rows, s.step_x, s.step_y,
                              grid_.cell_x, grid_.cell_y,
                              advised_resampling(place_.file, grid_.cell_x, grid_.cell_y)));
    for (std::size_t j = 0; j < s.rows; ++j)
      for (std::size_t i = 0; i < s.columns; ++i) {
        const float height = grid_.refinements.heights[s.first + j * s.columns + i];
        vertices_.push_back(std::isnan(height) ? hole : static_cast<std::uint32_t>(mesh_.points_m.size()));
        if (!std::isnan(height)) mesh_.points_m.emplace_back(place_of(row, column, j, i), height);
      }
  }

  void add(std::uint32_t a, std::uint32_t b, std::uint32_t c) { mesh_.triangles.push_back({a, b, c}); }

  void join_within(std::size_t row, std::size_t column) {
    const Supergrid& s = at(row, column);
    const std::uint32_t* const v = vertices_.data() + first_[row * grid_.columns + column];
    const std::size_t n = s.columns;
    for (std::size_t j = 0; j + 1 < s.rows; ++j)
      for (std::size_t i = 0; i + 1 < n; ++i)
        mesh_.hole_cells +=
            join_centres(v[(j + 1) * n + i], v[(j + 1) * n + i + 1], v[j * n + i], v[j * n + i + 1],
                         [this](std::uint32_t a, std::uint32_t b, std::uint32_t c) { add(a, b, c); });
  }

  // Returns the nodes along a side of a supergrid, from the south or the west.
  using Side = std::vector<Node>;
  Side side(std::size_t row, std::size_t column, bool upright, bool last) const {
    const Supergrid& s = at(row, column);
    const std::size_t along = upright ? s.rows : s.columns, across = upright ? s.columns : s.rows;
    Side nodes;
    for (std::size_t k = 0; k < along; ++k) {
      const std::size_t fixed = last ? across - 1 : 0;
      nodes.push_back(upright ? node(row, column, k, fixed) : node(row, column, fixed, k));
    }
    return nodes;
  }

  /// Joins two parallel rows of nodes with the same direction, one on the left and one on the right. Any
  /// order of steps gives a triangulation. The shorter of the two next edges avoids narrow triangles.
  void join_strip(const Side& left, const Side& right) {
    if (left.empty() || right.empty()) return;
    for (std::size_t l = 0, r = 0; l + 1 < left.size() || r + 1 < right.size();) {
      bool on_left = r + 1 == right.size();
      if (!on_left && l + 1 < left.size()) {
        const glm::dvec2 by_left = left[l + 1].place - right[r].place,
                         by_right = right[r + 1].place - left[l].place;
        on_left = glm::dot(by_left, by_left) <= glm::dot(by_right, by_right);
      }
      const Node third = on_left ? left[l + 1] : right[r + 1];
      if (left[l].vertex == hole || right[r].vertex == hole || third.vertex == hole)
        ++mesh_.hole_cells;
      else
        add(left[l].vertex, right[r].vertex, third.vertex);
      ++(on_left ? l : r);
    }
  }

  /// Joins the corners of a cell and of the cells to its east, north and north-east.
  void join_corner(std::size_t row, std::size_t column) {
    std::array<Node, 4> around{};  // counter-clockwise from the south-west
    std::size_t count = 0, missing = 0;
    for (const auto& [up, right] : {std::pair{0, 0}, {0, 1}, {1, 1}, {1, 0}}) {
      const Supergrid& s = at(row + up, column + right);
      const Node corner = s.columns == 0 ? Node{{}, hole}
                                         : node(row + up, column + right, up == 0 ? s.rows - 1 : 0,
                                                right == 0 ? s.columns - 1 : 0);
      if (corner.vertex == hole)
        ++missing;
      else
        around[count++] = corner;
    }
    mesh_.hole_cells += missing > 0 && missing < 4;
    const auto& [a, b, c, d] = around;
    const auto take = [this](const Node& p, const Node& q, const Node& r) {
      if (turn(p.place, q.place, r.place) > 0) add(p.vertex, q.vertex, r.vertex);
    };
    if (count == 3) take(a, b, c);
    if (count < 4) return;
    // The quadrilateral is simple, and at least one diagonal lies inside.
    const bool by_ac = turn(a.place, b.place, c.place) > 0 && turn(a.place, c.place, d.place) > 0,
               by_bd = turn(a.place, b.place, d.place) > 0 && turn(b.place, c.place, d.place) > 0;
    if (by_ac && (!by_bd || glm::distance(a.place, c.place) <= glm::distance(b.place, d.place))) {
      take(a, b, c);
      take(a, c, d);
    } else {
      take(a, b, d);
      take(b, c, d);
    }
  }

  const VariableGrid& grid_;
  const SourcePlace& place_;
  ComponentMesh mesh_;
  std::vector<std::size_t> first_;       // index in vertices_ of the south-west node, by cell
  std::vector<std::uint32_t> vertices_;  // by node
};

}  // namespace

ComponentMesh join_supergrids(const VariableGrid& grid, const SourcePlace& place) {
  return Joiner(grid, place).run();
}

ComponentMesh resampled(const ComponentMesh& surface, const VariableGrid& grid, double step,
                        const SourcePlace& place) {
  const double west = grid.west + static_cast<double>(grid.column) * grid.cell_x,
               south = grid.south + static_cast<double>(grid.row) * grid.cell_y,
               width = static_cast<double>(grid.columns) * grid.cell_x,
               length = static_cast<double>(grid.rows) * grid.cell_y;
  const double across = std::round(width / step), up = std::round(length / step);
  if (across < 2 || up < 2)
    throw InputError(place, fmt::format("an extent of {:g} x {:g} with cells of {:g} gives only {:g} x {:g} "
                                        "cells, expected at least 2 x 2: choose a smaller resolution_m",
                                        width, length, step, across, up));
  const auto columns = static_cast<std::size_t>(across), rows = static_cast<std::size_t>(up);
  const auto x_of = [&](std::size_t i) { return west + (static_cast<double>(i) + 0.5) * step; };
  const auto y_of = [&](std::size_t j) { return south + (static_cast<double>(j) + 0.5) * step; };
  std::vector<double> heights(columns * rows, std::numeric_limits<double>::quiet_NaN());
  // Nodes are rounded to single precision, so that the centre of a cell may lie slightly outside of the
  // outermost nodes.
  constexpr double rounding = 1e-6;
  const auto first_from = [step](double from, double lo, std::size_t count) {
    return static_cast<std::size_t>(
        std::clamp(std::ceil((lo - from) / step - 0.5 - rounding), 0., static_cast<double>(count)));
  };
  for (const auto& [ia, ib, ic] : surface.triangles) {
    const glm::dvec3 a = surface.points_m[ia], b = surface.points_m[ib], c = surface.points_m[ic];
    const double area = turn(a, b, c);
    for (std::size_t j = first_from(south, std::min({a.y, b.y, c.y}), rows);
         j < rows && y_of(j) <= std::max({a.y, b.y, c.y}) + rounding * step; ++j)
      for (std::size_t i = first_from(west, std::min({a.x, b.x, c.x}), columns);
           i < columns && x_of(i) <= std::max({a.x, b.x, c.x}) + rounding * step; ++i) {
        const glm::dvec2 p{x_of(i), y_of(j)};
        const double of_a = turn(p, b, c) / area, of_b = turn(a, p, c) / area, of_c = turn(a, b, p) / area;
        // Positions on an edge belong to both sides, independent of rounding.
        if (std::min({of_a, of_b, of_c}) >= -rounding)
          heights[j * columns + i] = of_a * a.z + of_b * b.z + of_c * c.z;
      }
  }
  ComponentMesh mesh;
  std::vector<std::uint32_t> vertices(heights.size(), hole);
  for (std::size_t k = 0; k < heights.size(); ++k) {
    if (std::isnan(heights[k])) continue;
    vertices[k] = static_cast<std::uint32_t>(mesh.points_m.size());
    mesh.points_m.emplace_back(x_of(k % columns), y_of(k / columns), heights[k]);
  }
  for (std::size_t j = 0; j + 1 < rows; ++j)
    for (std::size_t i = 0; i + 1 < columns; ++i) {
      const std::uint32_t* const v = vertices.data() + j * columns + i;
      mesh.hole_cells += join_centres(v[columns], v[columns + 1], v[0], v[1],
                                      [&mesh](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
                                        mesh.triangles.push_back({a, b, c});
                                      });
    }
  return mesh;
}

}  // namespace tubefoot
