// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/footprints/layer_border.hpp"

#include <algorithm>
#include <cmath>

#include "geometry/footprints/line_areas.hpp"

// Cancels the shared edges of polygons line by line. Along a line, polygons on its
// positive side count +1, and those on its other side -1. Points are located by a ray towards larger v, which
// leaves the polygons in the end. Edges contain the smaller coordinate u of their ends, and not the larger
// one.

namespace tubefoot {

InnerPoint::InnerPoint(const LineTable& table, const TabledPolygon& polygon) {
  const auto inside = [&] {
    return std::ranges::all_of(polygon.lines, [&](const DirectedLine& line) {
      return side(table, line.line) == (line.opposite ? -1 : 1);
    });
  };
  for (const LineCorner& corner : polygon.corners)
    near_ += corner.near / static_cast<double>(polygon.corners.size());
  constexpr double steps = 4294967296.0;  // 2^32 per grid unit, fewer for large coordinates
  for (int axis = 0; axis < 2; ++axis)
    if (std::abs(near_[axis]) < 1048576.0) near_[axis] = std::nearbyint(near_[axis] * steps) / steps;
  if (inside()) return;
  // The polygon is too thin. Take the exact centre of three of its corners.
  near_exact_ = false;
  std::array<Integer, 3> x, y, w;
  for (std::size_t k = 0; k < 3; ++k) {
    const auto p = table.integers(polygon.corners[k].p), q = table.integers(polygon.corners[k].q);
    x[k] = p[1] * q[2] - p[2] * q[1];
    y[k] = p[2] * q[0] - p[0] * q[2];
    w[k] = p[0] * q[1] - p[1] * q[0];
  }
  x_ = x[0] * w[1] * w[2] + x[1] * w[0] * w[2] + x[2] * w[0] * w[1];
  y_ = y[0] * w[1] * w[2] + y[1] * w[0] * w[2] + y[2] * w[0] * w[1];
  w_ = 3 * w[0] * w[1] * w[2];
  known_ = true;
  near_ = {ratio(x_, w_), ratio(y_, w_)};
}

int InnerPoint::exact_side(const LineTable& table, LineId line) const {
  if (!known_) {
    const double scale = 4294967296.0;
    mpz_set_d(x_.backend().data(), near_.x * scale);
    mpz_set_d(y_.backend().data(), near_.y * scale);
    mpz_set_d(w_.backend().data(), scale);
    known_ = true;
  }
  const auto [a, b, c] = table.integers(line);
  return Integer(a * x_ + b * y_ + c * w_).sign();
}

int InnerPoint::side(const LineTable& table, LineId line) const {
  const LineTable::Near& of = table.near(line);
  const double x = of.a * near_.x, y = of.b * near_.y, value = x + y + of.c;
  if (std::abs(value) > 1e-14 * (std::abs(x) + std::abs(y) + std::abs(of.c))) return value > 0 ? 1 : -1;
  return exact_side(table, line);
}

int InnerPoint::compare_u(const LineTable& table, const LineCorner& corner) const {
  const double difference = corner.near.x - near_.x;
  if (std::abs(difference) > 1e-14 * (std::abs(corner.near.x) + std::abs(near_.x)))
    return difference > 0 ? 1 : -1;
  exact_side(table, corner.p);  // makes the integers known
  const auto p = table.integers(corner.p), q = table.integers(corner.q);
  return Integer((p[1] * q[2] - p[2] * q[1]) * w_ - (p[0] * q[1] - p[1] * q[0]) * x_).sign();
}

void LayerBorder::add(const TabledPolygon& polygon) {
  const std::size_t n = polygon.lines.size();
  for (std::size_t k = 0; k < n; ++k) {
    const auto& [line, opposite] = polygon.lines[k];
    const LineCorner &begin = polygon.corners[k], &end = polygon.corners[k + 1 == n ? 0 : k + 1];
    edges_.push_back(opposite ? BorderEdge{line, end, begin, -1} : BorderEdge{line, begin, end, 1});
  }
}

void LayerBorder::finish(const LineTable& table) {
  std::vector<BorderEdge> all;
  all.swap(edges_);
  std::sort(all.begin(), all.end(), [](const BorderEdge& x, const BorderEdge& y) { return x.line < y.line; });
  struct Event {
    const LineCorner* corner;
    int rise;
  };
  std::vector<Event> events;
  for (std::size_t first = 0, end = 0; first < all.size(); first = end) {
    const LineId line = all[first].line;
    while (end < all.size() && all[end].line == line) ++end;
    if (end - first == 1) {
      edges_.push_back(all[first]);
      continue;
    }
    events.clear();
    for (std::size_t k = first; k < end; ++k) {
      events.push_back({&all[k].from, all[k].rise});
      events.push_back({&all[k].to, -all[k].rise});
    }
    std::sort(events.begin(), events.end(),
              [&](const Event& x, const Event& y) { return table.order(line, *x.corner, *y.corner) < 0; });
    int rise = 0;
    const LineCorner* begin = nullptr;
    for (std::size_t k = 0; k < events.size();) {
      const LineCorner* at = events[k].corner;
      int next = rise;
      for (; k < events.size() && table.order(line, *at, *events[k].corner) == 0; ++k) next += events[k].rise;
      if (next == rise) continue;
      if (rise != 0) edges_.push_back({line, *begin, *at, rise});
      begin = at;
      rise = next;
    }
  }
  edges_.shrink_to_fit();
  make_bins();
}

void LayerBorder::make_bins() {
  const auto low = [](const BorderEdge& e) { return std::min(e.from.near.x, e.to.near.x); };
  const auto high = [](const BorderEdge& e) { return std::max(e.from.near.x, e.to.near.x); };
  double first = 0, last = 0;
  for (const BorderEdge& edge : edges_) {
    first = &edge == edges_.data() ? low(edge) : std::min(first, low(edge));
    last = &edge == edges_.data() ? high(edge) : std::max(last, high(edge));
  }
  first_u_ = first;
  const auto range = [&](const BorderEdge& edge, std::size_t bins) {
    // A point in an edge's range lies in one of its bins, also when coordinates are rounded.
    const double error = 1e-13 * (std::abs(first) + std::abs(last));
    const auto bin = [&](double u) {
      const double at = (u - first_u_) * bins_per_u_;
      return static_cast<std::size_t>(std::clamp(at, 0.0, static_cast<double>(bins - 1)));
    };
    return std::pair(bin(low(edge) - error), bin(high(edge) + error));
  };
  // Long edges lie in many bins, so they limit the number of bins.
  for (std::size_t bins = std::max<std::size_t>(1, edges_.size() / 2);; bins /= 2) {
    bins_per_u_ = last > first ? static_cast<double>(bins) / (last - first) : 0;
    std::size_t entries = 0;
    for (const BorderEdge& edge : edges_) {
      const auto [from, to] = range(edge, bins);
      entries += to - from + 1;
    }
    if (bins > 1 && entries > 6 * edges_.size()) continue;
    bin_start_.assign(bins + 1, 0);
    for (const BorderEdge& edge : edges_) {
      const auto [from, to] = range(edge, bins);
      for (std::size_t k = from; k <= to; ++k) ++bin_start_[k + 1];
    }
    for (std::size_t k = 0; k < bins; ++k) bin_start_[k + 1] += bin_start_[k];
    in_bin_.resize(entries);
    std::vector<std::uint32_t> at(bin_start_.begin(), bin_start_.end() - 1);
    for (std::uint32_t e = 0; e < edges_.size(); ++e) {
      const auto [from, to] = range(edges_[e], bins);
      for (std::size_t k = from; k <= to; ++k) in_bin_[at[k]++] = e;
    }
    return;
  }
}

void LayerBorder::count(const LineTable& table, const InnerPoint& point, const BorderEdge& edge,
                        int& polygons) const {
  const int from = point.compare_u(table, edge.from), to = point.compare_u(table, edge.to);
  // Exactly one end has a larger u, unless the ray misses the edge or the edge is vertical.
  if ((from > 0) == (to > 0)) return;
  // The positive side of an edge to the right is above the edge.
  const bool right_way = to > 0;
  if (point.side(table, edge.line) != (right_way ? -1 : 1)) return;
  polygons -= right_way ? edge.rise : -edge.rise;
}

bool LayerBorder::contains(const LineTable& table, const InnerPoint& point) const {
  if (edges_.empty()) return false;
  int polygons = 0;
  if (!point.is_near_exact()) {
    for (const BorderEdge& edge : edges_) count(table, point, edge, polygons);
    return polygons > 0;
  }
  const double at = (point.near().x - first_u_) * bins_per_u_;
  const auto bins = static_cast<double>(bin_start_.size() - 1);
  const auto bin = static_cast<std::size_t>(std::clamp(at, 0.0, bins - 1));
  for (std::uint32_t k = bin_start_[bin]; k < bin_start_[bin + 1]; ++k)
    count(table, point, edges_[in_bin_[k]], polygons);
  return polygons > 0;
}

}  // namespace tubefoot
