// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/terrain_height.hpp"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <limits>

namespace tubefoot {
namespace {

// Returns the height of a triangle at a position; empty if the triangle is elsewhere or vertical.
std::optional<double> height_of(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c, double x,
                                double y) {
  const auto turn = [x, y](const glm::dvec3& p, const glm::dvec3& q) {
    return (p.x - x) * (q.y - y) - (p.y - y) * (q.x - x);
  };
  const double wa = turn(b, c), wb = turn(c, a), wc = turn(a, b), sum = wa + wb + wc;
  const bool inside = (wa >= 0 && wb >= 0 && wc >= 0) || (wa <= 0 && wb <= 0 && wc <= 0);
  if (!inside || sum == 0) return std::nullopt;
  return (wa * a.z + wb * b.z + wc * c.z) / sum;
}

/// Positions in the cells of a grid, with about one position per cell.
class PlaceGrid {
 public:
  explicit PlaceGrid(std::span<const glm::dvec2> places) {
    for (const glm::dvec2& p : places) {
      lo_ = glm::min(lo_, p);
      hi_ = glm::max(hi_, p);
    }
    const double largest = std::max(hi_.x - lo_.x, hi_.y - lo_.y);
    side_ = std::clamp(static_cast<int>(std::sqrt(static_cast<double>(places.size()))), 1, 4096);
    cell_ = largest > 0 ? largest / side_ : 1;
    cells_.resize(static_cast<std::size_t>(side_) * static_cast<std::size_t>(side_));
    for (std::size_t k = 0; k < places.size(); ++k)
      cells_[index(column(places[k].x, lo_.x), column(places[k].y, lo_.y))].push_back(k);
  }

  /// Calls `take` with all positions within a box, and possibly with some near it.
  template <class Take>
  void each_in(glm::dvec2 lo, glm::dvec2 hi, const Take& take) const {
    if (lo.x > hi_.x || lo.y > hi_.y || hi.x < lo_.x || hi.y < lo_.y) return;
    for (int y = column(lo.y, lo_.y); y <= column(hi.y, lo_.y); ++y)
      for (int x = column(lo.x, lo_.x); x <= column(hi.x, lo_.x); ++x)
        for (const std::size_t k : cells_[index(x, y)]) take(k);
  }

 private:
  int column(double at, double from) const {
    return static_cast<int>(std::clamp(std::floor((at - from) / cell_), 0.0, side_ - 1.0));
  }
  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(side_) + static_cast<std::size_t>(x);
  }

  glm::dvec2 lo_{std::numeric_limits<double>::infinity()}, hi_{-std::numeric_limits<double>::infinity()};
  double cell_ = 1;
  int side_ = 1;
  std::vector<std::vector<std::size_t>> cells_;
};

}  // namespace

std::vector<std::optional<double>> terrain_heights_m(std::span<const ComponentMesh> terrains,
                                                     std::span<const glm::dvec2> places_m) {
  std::vector<std::optional<double>> highest(places_m.size());
  if (places_m.empty()) return highest;
  const PlaceGrid grid(places_m);
  for (const ComponentMesh& terrain : terrains) {
    for (const auto& [ia, ib, ic] : terrain.triangles) {
      const glm::dvec3 &a = terrain.points_m[ia], &b = terrain.points_m[ib], &c = terrain.points_m[ic];
      grid.each_in(glm::min(glm::dvec2(a), glm::min(glm::dvec2(b), glm::dvec2(c))),
                   glm::max(glm::dvec2(a), glm::max(glm::dvec2(b), glm::dvec2(c))), [&](std::size_t k) {
                     const auto height = height_of(a, b, c, places_m[k].x, places_m[k].y);
                     if (height && (!highest[k] || *height > *highest[k])) highest[k] = height;
                   });
    }
  }
  return highest;
}

}  // namespace tubefoot
