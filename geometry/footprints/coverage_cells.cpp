// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/footprints/coverage_cells.hpp"

#include <tbb/parallel_invoke.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <utility>

#include "geometry/steps/stop.hpp"

// Divides a facet recursively. A cell with many edges is halved at a grid line near the median of the edges.
// A cell with few edges is divided along one of them. As soon as no edge of a layer enters a cell, one exact
// point decides whether the layer contains the cell. Each edge enters few cells on each of log n levels.

namespace tubefoot {
namespace {

/// The part of a border's edge inside a cell.
struct CellEdge {
  std::uint32_t layer = 0;
  LineId line = 0;
  LineCorner from, to;
};

/// A cell with the edges that enter it.
struct Node {
  TabledPolygon cell;
  std::vector<CellEdge> edges;
  std::uint32_t pings = 0;  ///< number of layers that see all of the cell
};

constexpr std::uint32_t unmarked = 0;

class Divider {
 public:
  Divider(LineTable& table, std::span<const CoverageLayer> layers)
      : table_(table), layers_(layers), mark_(layers.size(), unmarked) {}

  void start(const TabledPolygon& polygon) {
    Node root{polygon, {}, 0};
    std::vector<std::uint32_t> all(layers_.size());
    for (std::uint32_t k = 0; k < layers_.size(); ++k) {
      all[k] = k;
      for (const BorderEdge& edge : layers_[k].border.edges())
        if (std::ranges::none_of(polygon.lines, [&](const DirectedLine& l) { return l.line == edge.line; }))
          root.edges.push_back({k, edge.line, edge.from, edge.to});
    }
    decide(root, all);
    divide(std::move(root), 0);
  }
  CoverageCells take() { return std::move(made_); }

 private:
  static constexpr std::size_t few = 8, many = 20000;
  static constexpr int deepest = 200;

  struct Halves {
    Node positive, negative;
    std::vector<std::uint32_t> layers;  ///< layers with edges in the divided cell
  };

  /// Decides about layers without edges in a cell. `layers` has those of which this is not known.
  void decide(Node& node, std::span<const std::uint32_t> layers) {
    ++stamp_;
    for (const CellEdge& edge : node.edges) mark_[edge.layer] = stamp_;
    std::optional<InnerPoint> point;
    const auto contains = [&](std::uint32_t layer) {
      if (!point) point.emplace(table_, node.cell);
      return layers_[layer].border.contains(table_, *point);
    };
    bool hidden = false;
    for (const std::uint32_t layer : layers) {
      if (mark_[layer] == stamp_) continue;
      if (layers_[layer].hidden_too)
        hidden = true;
      else if (contains(layer))
        ++node.pings;
    }
    if (node.pings > 0) {  // what hides the cell from other pings does not matter
      std::erase_if(node.edges, [&](const CellEdge& edge) { return layers_[edge.layer].hidden_too; });
    } else if (hidden) {
      for (const std::uint32_t layer : layers)
        if (mark_[layer] != stamp_ && layers_[layer].hidden_too && contains(layer))
          in_tubes_.push_back(layer);
    }
  }

  void divide(Node node, int depth) {
    stop_if_wanted();
    if (node.edges.empty()) {
      add(node);
      return;
    }
    std::optional<Halves> halves;
    if (node.edges.size() > few && depth < deepest) halves = halved_at_grid_line(node);
    if (!halves) halves = divided_along_edge(node);
    node.edges = {};
    const std::size_t first = made_.cells.size();
    if (halves->positive.edges.size() + halves->negative.edges.size() > many) {
      Divider other(table_, layers_);
      other.in_tubes_ = in_tubes_;
      tbb::parallel_invoke([&] { go_on(std::move(halves->positive), halves->layers, depth); },
                           [&] { other.go_on(std::move(halves->negative), halves->layers, depth); });
      append(other.take());
    } else {
      go_on(std::move(halves->positive), halves->layers, depth);
      go_on(std::move(halves->negative), halves->layers, depth);
      if (made_.cells.size() == first + 2) unite_last_two(node);
    }
  }

  void go_on(Node node, std::span<const std::uint32_t> layers, int depth) {
    const std::size_t in_tubes = in_tubes_.size();
    decide(node, layers);
    divide(std::move(node), depth + 1);
    in_tubes_.resize(in_tubes);
  }

  /// Chooses the grid line at the median of the edges along u or v that fewer edges cross. Returns nothing if
  /// both separate few edges.
  std::optional<Halves> halved_at_grid_line(const Node& node) {
    struct Choice {
      bool across_v = false;
      std::int64_t place = 0;
      std::size_t most = 0, sum = 0;
    };
    std::optional<Choice> best;
    std::vector<double> middles(node.edges.size());
    for (const bool across_v : {false, true}) {
      const int axis = across_v ? 1 : 0;
      for (std::size_t k = 0; k < node.edges.size(); ++k)
        middles[k] = (node.edges[k].from.near[axis] + node.edges[k].to.near[axis]) / 2;
      const auto middle = middles.begin() + static_cast<std::ptrdiff_t>(middles.size() / 2);
      std::nth_element(middles.begin(), middle, middles.end());
      const double place = std::floor(*middle);
      std::size_t above = 0, below = 0;
      for (const CellEdge& edge : node.edges) {
        above += std::max(edge.from.near[axis], edge.to.near[axis]) > place;
        below += std::min(edge.from.near[axis], edge.to.near[axis]) < place;
      }
      double low = node.cell.corners[0].near[axis], high = low;
      for (const LineCorner& corner : node.cell.corners) {
        low = std::min(low, corner.near[axis]);
        high = std::max(high, corner.near[axis]);
      }
      if (!(low < place && place < high)) continue;
      const Choice choice{across_v, static_cast<std::int64_t>(place), std::max(above, below), above + below};
      if (!best || choice.sum < best->sum) best = choice;
    }
    if (!best || best->most > node.edges.size() * 7 / 8) return std::nullopt;
    return divided(node, table_.add_grid_line(best->across_v, best->place));
  }

  /// Divides the cell along its longest edge. The line of an edge inside a convex cell always crosses it.
  Halves divided_along_edge(const Node& node) {
    const auto length2 = [](const CellEdge& edge) {
      const glm::dvec2 way = edge.to.near - edge.from.near;
      return way.x * way.x + way.y * way.y;
    };
    const auto longest = std::ranges::max_element(
        node.edges, [&](const CellEdge& a, const CellEdge& b) { return length2(a) < length2(b); });
    std::optional<Halves> halves = divided(node, longest->line);
    if (!halves) throw std::logic_error("internal error: an edge inside a cell does not cross the cell");
    return std::move(*halves);
  }

  /// Divides a cell and its edges by a line. Returns nothing if the line does not cross the cell.
  std::optional<Halves> divided(const Node& node, LineId by) {
    Halves halves;
    halves.positive.pings = halves.negative.pings = node.pings;
    if (!clip(node.cell, by, halves.positive.cell, halves.negative.cell)) return std::nullopt;
    ++stamp_;
    for (const CellEdge& edge : node.edges) {
      if (mark_[edge.layer] != stamp_) {
        mark_[edge.layer] = stamp_;
        halves.layers.push_back(edge.layer);
      }
      const int from = table_.side(edge.from, by), to = edge.line == by ? 0 : table_.side(edge.to, by);
      if (edge.line == by || (from == 0 && to == 0)) continue;
      if (from >= 0 && to >= 0) {
        halves.positive.edges.push_back(edge);
      } else if (from <= 0 && to <= 0) {
        halves.negative.edges.push_back(edge);
      } else {
        const LineCorner middle = table_.corner(edge.line, by);
        CellEdge first = edge, second = edge;
        first.to = second.from = middle;
        (from > 0 ? halves.positive : halves.negative).edges.push_back(first);
        (from > 0 ? halves.negative : halves.positive).edges.push_back(second);
      }
    }
    std::sort(halves.layers.begin(), halves.layers.end());
    return halves;
  }

  bool clip(const TabledPolygon& cell, LineId by, TabledPolygon& positive, TabledPolygon& negative) {
    const std::size_t n = cell.lines.size();
    sides_.resize(n);
    bool some_in = false, some_out = false;
    for (std::size_t k = 0; k < n; ++k) {
      sides_[k] = table_.side(cell.corners[k], by);
      some_in = some_in || sides_[k] > 0;
      some_out = some_out || sides_[k] < 0;
    }
    if (!some_in || !some_out) return false;
    crossings_.assign(n, std::nullopt);
    for (std::size_t k = 0; k < n; ++k)
      if (sides_[k] * sides_[k + 1 == n ? 0 : k + 1] < 0)
        crossings_[k] = table_.corner(cell.lines[k].line, by);
    for (const int sign : {1, -1}) {
      TabledPolygon& rest = sign > 0 ? positive : negative;
      rest.lines.reserve(n + 1);
      rest.corners.reserve(n + 1);
      for (std::size_t k = 0; k < n; ++k) {
        const std::size_t next = k + 1 == n ? 0 : k + 1;
        const int begin = sign * sides_[k], end = sign * sides_[next];
        if (begin <= 0 && end <= 0) continue;
        rest.lines.push_back(cell.lines[k]);
        rest.corners.push_back(begin < 0 ? *crossings_[k] : cell.corners[k]);
        if (end < 0 || (end == 0 && sign * sides_[(k + 2) % n] < 0)) {
          rest.lines.push_back({by, sign < 0});
          rest.corners.push_back(end < 0 ? *crossings_[k] : cell.corners[next]);
        }
      }
    }
    return true;
  }

  void add(const Node& node) {
    CoverageCell cell;
    cell.pings = node.pings;
    if (node.pings == 0 && !in_tubes_.empty()) {
      pings_.clear();
      const CoverageLayer* first = nullptr;
      for (const std::uint32_t k : in_tubes_) {
        const CoverageLayer& layer = layers_[k];
        pings_.push_back(layer.ping);
        if (first == nullptr || layer.look < first->look) first = &layer;
      }
      std::sort(pings_.begin(), pings_.end());
      cell.in_sector = static_cast<std::uint32_t>(std::unique(pings_.begin(), pings_.end()) - pings_.begin());
      cell.first_look = first->look;
      cell.first_parts = first->parts;
    }
    place(cell, node.cell);
  }

  void place(CoverageCell cell, const TabledPolygon& polygon) {
    cell.first = static_cast<std::uint32_t>(made_.corners.size());
    cell.count = static_cast<std::uint32_t>(polygon.lines.size());
    made_.cells.push_back(cell);
    made_.lines.insert(made_.lines.end(), polygon.lines.begin(), polygon.lines.end());
    for (const LineCorner& corner : polygon.corners) made_.corners.push_back(corner.near);
  }

  /// Replaces the last two cells by the cell that was divided into them, if the same pings see both.
  void unite_last_two(const Node& node) {
    const CoverageCell first = made_.cells[made_.cells.size() - 2], second = made_.cells.back();
    if (first.pings != second.pings || first.in_sector != second.in_sector ||
        first.first_look != second.first_look || first.first_parts != second.first_parts)
      return;
    made_.cells.resize(made_.cells.size() - 2);
    made_.lines.resize(first.first);
    made_.corners.resize(first.first);
    place(first, node.cell);
  }

  void append(const CoverageCells& other) {
    for (CoverageCell cell : other.cells) {
      cell.first += static_cast<std::uint32_t>(made_.corners.size());
      made_.cells.push_back(cell);
    }
    made_.lines.insert(made_.lines.end(), other.lines.begin(), other.lines.end());
    made_.corners.insert(made_.corners.end(), other.corners.begin(), other.corners.end());
  }

  LineTable& table_;
  std::span<const CoverageLayer> layers_;
  std::vector<std::uint32_t> mark_;  ///< per layer: the stamp of the cell that has an edge of it
  std::uint32_t stamp_ = unmarked;
  std::vector<std::uint32_t> in_tubes_;  ///< layers that have all of the cell in their tubes
  CoverageCells made_;
  std::vector<int> sides_;
  std::vector<std::optional<LineCorner>> crossings_;
  std::vector<std::uint32_t> pings_;
};

}  // namespace

CoverageCells divided_by_borders(LineTable& table, const TabledPolygon& polygon,
                                 std::span<const CoverageLayer> layers) {
  Divider divider(table, layers);
  divider.start(polygon);
  return divider.take();
}

}  // namespace tubefoot
