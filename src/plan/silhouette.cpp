// SPDX-License-Identifier: GPL-3.0-or-later
// Union of convex shapes as an outline: rasterises the shapes to cells, traces the borders of the covered
// cells, and simplifies the resulting loops.
#include "plan/silhouette.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <utility>

namespace tubefoot {
namespace {

double turn(glm::dvec2 a, glm::dvec2 b, glm::dvec2 c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

std::vector<glm::dvec2> convex_hull(std::span<const glm::dvec2> points) {
  std::vector<glm::dvec2> sorted;
  for (const glm::dvec2& p : points)
    if (std::isfinite(p.x) && std::isfinite(p.y)) sorted.push_back(p);
  std::ranges::sort(sorted, [](glm::dvec2 a, glm::dvec2 b) { return a.x != b.x ? a.x < b.x : a.y < b.y; });
  if (sorted.size() < 3) return sorted;
  std::vector<glm::dvec2> hull;
  for (int side = 0; side < 2; ++side) {
    const std::size_t first = hull.size();
    for (const glm::dvec2& p : sorted) {
      while (hull.size() >= first + 2 && turn(hull[hull.size() - 2], hull.back(), p) <= 0) hull.pop_back();
      hull.push_back(p);
    }
    hull.pop_back();
    std::ranges::reverse(sorted);
  }
  return hull;
}

double distance_to_segment(glm::dvec2 p, glm::dvec2 a, glm::dvec2 b) {
  const glm::dvec2 along = b - a;
  const double square = glm::dot(along, along);
  const double at = square > 0 ? std::clamp(glm::dot(p - a, along) / square, 0.0, 1.0) : 0;
  return glm::distance(p, a + at * along);
}

}  // namespace

std::vector<glm::dvec2> simplified(const std::vector<glm::dvec2>& points, double tolerance) {
  if (points.size() < 3) return points;
  std::vector<bool> kept(points.size(), false);
  kept.front() = kept.back() = true;
  std::vector<std::pair<std::size_t, std::size_t>> open{{0, points.size() - 1}};
  while (!open.empty()) {
    const auto [first, last] = open.back();
    open.pop_back();
    double farthest = tolerance;
    std::size_t at = 0;
    for (std::size_t k = first + 1; k < last; ++k)
      if (const double d = distance_to_segment(points[k], points[first], points[last]); d > farthest)
        farthest = d, at = k;
    if (at == 0) continue;
    kept[at] = true;
    open.push_back({first, at});
    open.push_back({at, last});
  }
  std::vector<glm::dvec2> rest;
  for (std::size_t k = 0; k < points.size(); ++k)
    if (kept[k]) rest.push_back(points[k]);
  return rest;
}

Silhouette::Silhouette(const Box& within)
    : within_(within),
      columns_(static_cast<std::size_t>(std::ceil(std::max(within.width(), 1.0) / cell))),
      rows_(static_cast<std::size_t>(std::ceil(std::max(within.height(), 1.0) / cell))),
      covered_(columns_ * rows_) {}

void Silhouette::add(std::span<const glm::dvec2> points) {
  std::vector<glm::dvec2> hull = convex_hull(points);
  if (hull.empty()) return;
  Box box = Box::none();
  for (glm::dvec2& p : hull) {
    p = (p - glm::dvec2(within_.left, within_.top)) / cell;
    box.add(p);
  }
  const auto columns = static_cast<double>(columns_), rows = static_cast<double>(rows_);
  if (box.right < 0 || box.left >= columns || box.bottom < 0 || box.top >= rows) return;
  const auto first = static_cast<std::size_t>(std::max(0.0, std::floor(box.top))),
             last = static_cast<std::size_t>(std::min(rows - 1, std::floor(box.bottom)));
  for (std::size_t row = first; row <= last; ++row) {
    // The part of the hull in this row of cells extends from lo to hi.
    const auto top = static_cast<double>(row), bottom = top + 1;
    double lo = columns, hi = -1;
    for (std::size_t k = 0; k < hull.size(); ++k) {
      const glm::dvec2 a = hull[k], b = hull[(k + 1) % hull.size()];
      if (std::max(a.y, b.y) < top || std::min(a.y, b.y) > bottom) continue;
      for (const double y : {std::clamp(a.y, top, bottom), std::clamp(b.y, top, bottom)}) {
        const double x = a.y == b.y ? a.x : a.x + (b.x - a.x) * ((y - a.y) / (b.y - a.y));
        lo = std::min(lo, x), hi = std::max(hi, x);
        if (a.y == b.y) lo = std::min(lo, b.x), hi = std::max(hi, b.x);
      }
    }
    if (hi < 0 || lo >= columns || lo > hi) continue;
    const auto from = static_cast<std::size_t>(std::max(0.0, std::floor(lo))),
               to = static_cast<std::size_t>(std::min(columns - 1, std::floor(hi)));
    std::fill_n(covered_.begin() + static_cast<std::ptrdiff_t>(row * columns_ + from), to - from + 1,
                std::uint8_t{1});
    for (const std::size_t column : {from, to + 1})
      for (const std::size_t edge : {row, row + 1})
        bounds_.add({within_.left + cell * static_cast<double>(column),
                     within_.top + cell * static_cast<double>(edge)});
  }
}

// Each side between a covered and an uncovered cell is a step, with the covered cell on its right.
std::vector<std::vector<glm::dvec2>> Silhouette::loops() const {
  enum Step { east, south, west, north };
  constexpr std::array<int, 4> step_x{1, 0, -1, 0}, step_y{0, 1, 0, -1};
  const std::size_t width = columns_ + 1;
  std::vector<std::uint8_t> steps(width * (rows_ + 1));
  const auto is_covered = [&](std::size_t x, std::size_t y) {  // a negative index becomes a large number
    return x < columns_ && y < rows_ && covered_[y * columns_ + x] != 0;
  };
  for (std::size_t y = 0; y < rows_; ++y)
    for (std::size_t x = 0; x < columns_; ++x) {
      if (!is_covered(x, y)) continue;
      if (!is_covered(x, y - 1)) steps[y * width + x] |= 1 << east;
      if (!is_covered(x + 1, y)) steps[y * width + x + 1] |= 1 << south;
      if (!is_covered(x, y + 1)) steps[(y + 1) * width + x + 1] |= 1 << west;
      if (!is_covered(x - 1, y)) steps[(y + 1) * width + x] |= 1 << north;
    }
  std::vector<std::vector<glm::dvec2>> all;
  for (std::size_t start = 0; start < steps.size(); ++start)
    while (steps[start] != 0) {
      std::vector<glm::dvec2> loop;
      std::size_t at = start;
      int step = -1;
      while (steps[at] != 0) {
        int next = 0;
        // At a corner of four cells the loop turns right, so that loops touch but do not cross.
        for (const int side : {1, 0, 3})
          if (next = step < 0 ? 0 : (step + side) % 4; step < 0 || (steps[at] >> next & 1) != 0) break;
        if (step < 0)
          while ((steps[at] >> next & 1) == 0) ++next;
        if (next != step)
          loop.push_back({within_.left + cell * static_cast<double>(at % width),
                          within_.top + cell * static_cast<double>(at / width)});
        steps[at] &= static_cast<std::uint8_t>(~(1 << next));
        step = next;
        at = static_cast<std::size_t>(
            static_cast<std::ptrdiff_t>(at) + step_x[static_cast<std::size_t>(step)] +
            step_y[static_cast<std::size_t>(step)] * static_cast<std::ptrdiff_t>(width));
        if (at == start) break;
      }
      all.push_back(std::move(loop));
    }
  return all;
}

std::string Silhouette::path() const {
  std::string data;
  if (empty()) return data;
  constexpr double stairs = 0.9 * cell;
  for (std::vector<glm::dvec2>& loop : loops()) {
    // Splits the closed loop at its point farthest from the start, because simplified() needs open lines.
    const auto far = std::ranges::max_element(
        loop, {}, [&](const glm::dvec2& p) { return glm::distance(p, loop.front()); });
    const std::vector<glm::dvec2> there(loop.begin(), far + 1);
    std::vector<glm::dvec2> back(far, loop.end());
    back.push_back(loop.front());
    std::vector<glm::dvec2> outline = simplified(there, stairs);
    const std::vector<glm::dvec2> rest = simplified(back, stairs);
    if (rest.size() > 2) outline.insert(outline.end(), rest.begin() + 1, rest.end() - 1);
    for (std::size_t k = 0; k < outline.size(); ++k)
      data += fmt::format("{}{:.1f} {:.1f}", k == 0 ? "M" : "L", outline[k].x, outline[k].y);
    data += "Z";
  }
  return data;
}

}  // namespace tubefoot
