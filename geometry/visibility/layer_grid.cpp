// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/visibility/layer_grid.hpp"

#include <algorithm>
#include <bit>
#include <numeric>

#include "geometry/steps/stop.hpp"

// Divides the gnomonic plane of a tube into cells, joins facets to layers in each cell and removes facets
// that a layer certainly hides. All decisions are made in double with margins (docs/notes/visibility.md,
// 'Layers').

namespace tubefoot {
namespace {

/// Approximate number of facets per cell for facets of equal size. The value follows from measurements
/// (validation/performance.md).
constexpr double facets_per_cell = 4;
/// If the average number of entries per facet exceeds this value, the cells are made larger.
constexpr double entries_per_facet = 6;
constexpr int most_cells_a_side = 512;
/// Relative margin of directions and planes, far larger than the rounding errors of their products.
constexpr double plane_margin = 1e-9;

/// Returns the side of edge k's plane on which a direction lies: 1 that of the facet, -1 the other one, 0
/// unknown.
int side_of_edge(const FacetCone& cone, int k, glm::dvec3 direction) {
  const Vec64 n = cross(cone.point[k], cone.point[(k + 1) % 3]);
  const glm::dvec3 normal(n.x, n.y, n.z);
  const double along = glm::dot(normal, direction), bound = plane_margin * glm::length(normal);
  return along > bound ? 1 : along < -bound ? -1 : 0;
}

std::uint32_t root(std::vector<std::uint32_t>& parent, std::uint32_t k) {
  while (parent[k] != k) k = parent[k] = parent[parent[k]];
  return k;
}

/// The bits of the negative float nearest to zero.
constexpr auto least_negative = static_cast<std::int32_t>(0x80000001u);

float below(double x) {
  const auto rounded = static_cast<float>(x);
  const auto too_high =
      static_cast<std::int32_t>(rounded > x);  // true for half of all numbers, therefore without a branch
  if (rounded == 0) [[unlikely]]
    return too_high ? std::bit_cast<float>(least_negative) : rounded;
  // The next lower float, computed without the call of nextafterf. The value was rounded up, so it is neither
  // -inf nor the lowest float.
  const auto bits = std::bit_cast<std::int32_t>(rounded);
  return std::bit_cast<float>(bits + (bits < 0 ? too_high : -too_high));
}

}  // namespace

LayerGrid::RoundedBounds::RoundedBounds(const Bounds& b)
    : ends{below(b.x0), below(b.y0), below(-b.x1), below(-b.y1)} {}

void LayerGrid::build(const GnomonicFrame& frame, const std::vector<FramedFacet>& facets,
                      const std::vector<Neighbours>& neighbours) {
  frame_ = &frame;
  facets_ = &facets;
  neighbours_ = &neighbours;
  place_.resize(facets.size());
  cells_of_facet_.resize(facets.size());
  stamp_.assign(facets.size(), 0);
  stamp_now_ = 0;
  judged_.assign(facets.size(), no_more);
  judgements_.clear();
  choose_size();
  fill();
  for (int y = 0; y < rows_; ++y)
    for (int x = 0; x < columns_; ++x) {
      stop_if_wanted();
      find_layers(x, y);
    }
  find_hidden();
  drop_hidden();
}

void LayerGrid::choose_size() {
  columns_ = rows_ = 1;
  const Bounds& tube = frame_->tube();
  if (tube.is_finite()) {
    const double width = tube.x1 - tube.x0, height = tube.y1 - tube.y0;
    double cells = static_cast<double>(facets_->size()) / facets_per_cell;
    for (int attempt = 0; attempt < 12 && cells > 1; ++attempt, cells /= 2) {
      columns_ = std::clamp(static_cast<int>(std::sqrt(cells * width / height)), 1, most_cells_a_side);
      rows_ = std::clamp(static_cast<int>(cells / columns_), 1, most_cells_a_side);
      cell_width_ = width / columns_;
      cell_height_ = height / rows_;
      double entries = 0;
      for (std::size_t f = 0; f < facets_->size(); ++f) {
        const Cells c = cells_of_facet_[f] = cells_of((*facets_)[f].bounds);
        entries += static_cast<double>(c.x1 - c.x0 + 1) * (c.y1 - c.y0 + 1);
      }
      if (entries <= entries_per_facet * static_cast<double>(facets_->size())) break;
      columns_ = rows_ = 1;
    }
    cell_width_ = width / columns_;
    cell_height_ = height / rows_;
  }
  if (columns_ == 1 && rows_ == 1)
    std::fill(cells_of_facet_.begin(), cells_of_facet_.end(), Cells{0, 0, 0, 0});
  cells_.assign(static_cast<std::size_t>(columns_) * rows_, Cell{});
}

LayerGrid::Cells LayerGrid::cells_of(const Bounds& bounds) const {
  const Bounds& tube = frame_->tube();
  // The value is clamped as a double, because bounds may be infinite or far outside.
  const auto index = [](double coordinate, double origin, double size, int count) {
    return static_cast<int>(std::clamp((coordinate - origin) / size, 0.0, count - 1.0));
  };
  // A single cell in a direction needs no arithmetic, which an infinite tube would not permit.
  return {columns_ == 1 ? 0 : index(bounds.x0, tube.x0, cell_width_, columns_),
          columns_ == 1 ? 0 : index(bounds.x1, tube.x0, cell_width_, columns_),
          rows_ == 1 ? 0 : index(bounds.y0, tube.y0, cell_height_, rows_),
          rows_ == 1 ? 0 : index(bounds.y1, tube.y0, cell_height_, rows_)};
}

void LayerGrid::fill() {
  const auto each_cell = [&](std::uint32_t f, const auto& visit) {
    const Cells c = cells_of_facet_[f];
    for (int y = c.y0; y <= c.y1; ++y)
      for (int x = c.x0; x <= c.x1; ++x) visit(cells_[static_cast<std::size_t>(y) * columns_ + x]);
  };
  for (std::uint32_t f = 0; f < facets_->size(); ++f) {
    each_cell(f, [](Cell& cell) { ++cell.end; });
  }
  std::uint32_t total = 0;
  for (Cell& cell : cells_) {
    const std::uint32_t count = cell.end;
    cell.begin = cell.end = total;
    total += count;
  }
  entries_.resize(total, Entry{0, 0, no_layer, RoundedBounds(Bounds::everything())});
  rounded_.clear();
  farthest_.resize(facets_->size());
  for (std::uint32_t f = 0; f < facets_->size(); ++f) {
    rounded_.emplace_back((*facets_)[f].bounds);
    farthest_[f] = (*facets_)[f].farthest;
    const Entry entry{(*facets_)[f].nearest, f, no_layer, rounded_.back()};
    each_cell(f, [&](Cell& cell) { entries_[cell.end++] = entry; });
  }
  for (const Cell& cell : cells_)
    std::sort(entries_.begin() + cell.begin, entries_.begin() + cell.end, [](const Entry& a, const Entry& b) {
      return a.nearest != b.nearest ? a.nearest < b.nearest : a.facet < b.facet;
    });
}

bool LayerGrid::has_silhouette_in(std::uint32_t f, const Bounds& cell, const Directions& corners) const {
  const FramedFacet& facet = (*facets_)[f];
  for (int k = 0; k < 3; ++k) {
    const std::int32_t n = (*neighbours_)[f][k];
    if (n == outside_tube || n >= 0) continue;
    if (!facet.placed) {
      // The edge does not enter the cell if its plane has all corners of the cell on one side.
      const int side = side_of_edge(facet.cone, k, corners[0]);
      if (side == 0 || std::ranges::any_of(corners, [&](const glm::dvec3& corner) {
            return side_of_edge(facet.cone, k, corner) != side;
          }))
        return true;
      continue;
    }
    Bounds edge = Bounds::nothing();
    edge.add(facet.corner[k]);
    edge.add(facet.corner[(k + 1) % 3]);
    edge.widen(GnomonicFrame::margin *
               (1 + std::max({std::abs(edge.x0), std::abs(edge.x1), std::abs(edge.y0), std::abs(edge.y1)})));
    if (edge.meets(cell)) return true;
  }
  return false;
}

int LayerGrid::place_of(const FramedFacet& facet, glm::dvec2 p) const {
  if (facet.placed) return where(facet, p);
  const glm::dvec3 direction = frame_->direction(p);
  int place = 1;
  for (int k = 0; k < 3; ++k) place = std::min(place, side_of_edge(facet.cone, k, direction));
  return place;
}

double LayerGrid::farthest_in(std::uint32_t f, const Directions& corners) const {
  // The distance of a plane is the quotient of a convex and a positive linear function of the position in the
  // gnomonic plane. It is therefore largest at a corner of the cell.
  const FacetCone& cone = (*facets_)[f].cone;
  const glm::dvec3 normal(cone.normal.x, cone.normal.y, cone.normal.z);
  const double offset = static_cast<double>(cone.offset), length = glm::length(normal);
  double farthest = 0;
  for (const glm::dvec3& corner : corners) {
    // Coordinates in the plane are uncertain by the margin, so the direction of the corner is, too.
    const double along = glm::dot(normal, corner) - 2 * GnomonicFrame::margin * length;
    if (!(along > plane_margin * length)) return farthest_[f];
    farthest = std::max(farthest, offset / along * (1 + plane_margin));
  }
  return std::min(farthest, farthest_[f]);
}

Bounds LayerGrid::bounds_of(int x, int y) const {
  const Bounds& tube = frame_->tube();
  return {tube.x0 + x * cell_width_, tube.x0 + (x + 1) * cell_width_, tube.y0 + y * cell_height_,
          tube.y0 + (y + 1) * cell_height_};
}

void LayerGrid::find_layers(int x, int y) {
  Cell& cell = cells_[static_cast<std::size_t>(y) * columns_ + x];
  if (cell.begin == cell.end || !frame_->tube().is_finite()) return;
  const Bounds box = bounds_of(x, y);
  const Directions corners{frame_->direction({box.x0, box.y0}), frame_->direction({box.x1, box.y0}),
                           frame_->direction({box.x1, box.y1}), frame_->direction({box.x0, box.y1})};
  // A vertex that two facets share is not nearer than either begins and not farther than either ends. Entries
  // that begin beyond all earlier ones therefore belong to other layers. If a layer of the earlier entries
  // closes the cell, the remaining entries are hidden here, whatever their layers are.
  for (std::uint32_t begin = cell.begin; begin < cell.end;) {
    double farthest = 0;
    std::uint32_t end = begin;
    do farthest = std::max(farthest, farthest_[entries_[end++].facet]);
    while (end < cell.end && !(entries_[end].nearest > farthest));
    if (find_layers(cell, box, corners, begin, end)) return;
    begin = end;
  }
}

/// Finds the layers of the entries [begin, end). Returns true if one of them closes the cell.
bool LayerGrid::find_layers(Cell& cell, const Bounds& box, const Directions& corners, std::uint32_t begin,
                            std::uint32_t end) {
  const std::uint32_t count = end - begin;
  ++stamp_now_;
  parent_.resize(count);
  std::iota(parent_.begin(), parent_.end(), 0u);
  for (std::uint32_t k = 0; k < count; ++k) {
    const std::uint32_t f = entries_[begin + k].facet;
    stamp_[f] = stamp_now_;
    place_[f] = k;
  }
  for (std::uint32_t k = 0; k < count; ++k) {
    const std::uint32_t f = entries_[begin + k].facet;
    for (const std::int32_t n : (*neighbours_)[f])
      if (n >= 0 && stamp_[n] == stamp_now_) parent_[root(parent_, k)] = root(parent_, place_[n]);
  }
  for (std::uint32_t k = 0; k < count; ++k) parent_[k] = root(parent_, k);  // from here on, its layer
  broken_.assign(count, 0);
  for (std::uint32_t k = 0; k < count; ++k) {
    const std::uint32_t f = entries_[begin + k].facet, layer = parent_[k];
    if (!broken_[layer]) broken_[layer] = has_silhouette_in(f, box, corners);
  }

  // Tries points of the cell until one is certainly inside the tube and certainly inside or outside of every
  // facet there.
  constexpr std::array<glm::dvec2, 5> tries{
      {{0.5, 0.5}, {0.31, 0.37}, {0.67, 0.29}, {0.35, 0.71}, {0.73, 0.66}}};
  bool certain = false;
  for (const glm::dvec2& t : tries) {
    const glm::dvec2 p{box.x0 + t.x * cell_width_, box.y0 + t.y * cell_height_};
    if (!frame_->surely_inside(p)) continue;
    covering_.clear();
    certain = true;
    for (std::uint32_t k = 0; k < count && certain; ++k) {
      if (broken_[parent_[k]]) continue;
      const int s = place_of((*facets_)[entries_[begin + k].facet], p);
      if (s == 0) certain = false;
      if (s > 0) covering_.push_back(k);
    }
    if (certain) break;
  }
  if (!certain) return false;

  for (const std::uint32_t covers : covering_) {
    const std::uint32_t layer = parent_[covers];
    const bool simple = std::none_of(covering_.begin(), covering_.end(), [&](std::uint32_t other) {
      return other != covers && parent_[other] == layer;
    });
    cell.has_simple_layer |= simple;
    double farthest = 0;
    for (std::uint32_t k = 0; k < count; ++k)
      if (parent_[k] == layer) {
        farthest = std::max(farthest, farthest_in(entries_[begin + k].facet, corners));
        if (simple) entries_[begin + k].simple_layer = static_cast<std::int32_t>(layer);
      }
    cell.closed_beyond = std::min(cell.closed_beyond, farthest);
  }
  return !covering_.empty();
}

bool LayerGrid::are_closed(const Cells& c, double nearest) const {
  for (int y = c.y0; y <= c.y1; ++y)
    for (int x = c.x0; x <= c.x1; ++x)
      if (!(nearest > cells_[static_cast<std::size_t>(y) * columns_ + x].closed_beyond)) return false;
  return true;
}

bool LayerGrid::hides(const Bounds& bounds, double nearest) const {
  return are_closed(cells_of(bounds), nearest);
}

void LayerGrid::find_hidden() {
  hidden_.resize(facets_->size());
  for (std::uint32_t f = 0; f < facets_->size(); ++f)
    hidden_[f] = are_closed(cells_of_facet_[f], (*facets_)[f].nearest);
}

void LayerGrid::drop_hidden() {
  for (Cell& cell : cells_) {
    const auto end =
        std::remove_if(entries_.begin() + cell.begin, entries_.begin() + cell.end,
                       [&](const Entry& e) { return hidden_[e.facet] || e.nearest > cell.closed_beyond; });
    cell.end = static_cast<std::uint32_t>(end - entries_.begin());
    const auto begin = entries_.begin() + cell.begin;
    cell.is_simple_layer =
        cell.has_simple_layer && begin != end && begin->simple_layer != no_layer &&
        std::all_of(begin, end, [&](const Entry& e) { return e.simple_layer == begin->simple_layer; });
  }
}

void LayerGrid::occluder_candidates(std::uint32_t facet, std::vector<std::uint32_t>& out) {
  const FramedFacet& target = (*facets_)[facet];
  const FourFloats reach = rounded_[facet].reach();
  const double farthest = target.farthest;
  const std::uint32_t overlaps = ++stamp_now_, now = ++stamp_now_;
  stamp_[facet] = now;
  for (std::uint32_t k = judged_[facet]; k != no_more; k = judgements_[k].next)
    stamp_[judgements_[k].facet] = judgements_[k].apart ? now : overlaps;
  std::size_t count = 0;
  const Cells c = cells_of_facet_[facet];
  for (int y = c.y0; y <= c.y1; ++y)
    for (int x = c.x0; x <= c.x1; ++x) {
      const Cell& cell = cells_[static_cast<std::size_t>(y) * columns_ + x];
      // A facet that is not hidden in this cell is one of its entries, and so belongs to the layer.
      if (cell.is_simple_layer && !(target.nearest > cell.closed_beyond)) continue;
      const Entry *const begin = entries_.data() + cell.begin, *const end = entries_.data() + cell.end;
      std::int32_t own_layer = own_layer_is_none;
      if (cell.has_simple_layer)
        for (const Entry* e = begin; e != end; ++e)
          if (e->facet == facet) {
            if (e->simple_layer != no_layer) own_layer = e->simple_layer;
            break;
          }
      if (found_.size() < count + (cell.end - cell.begin)) found_.resize(count + (cell.end - cell.begin));
      // About half of the entries are found, so a branch would be mispredicted often.
      const std::size_t before = count;
      for (const Entry* e = begin; e != end && e->nearest < farthest; ++e) {
        // A simple layer does not overlap itself here.
        found_[count] = {e->nearest, e->facet, false};
        count += e->bounds.within(reach) & (e->simple_layer != own_layer);
      }
      std::size_t fresh = before;
      for (std::size_t k = before; k < count; ++k) {
        std::uint32_t& stamp = stamp_[found_[k].facet];
        found_[fresh] = {found_[k].nearest, found_[k].facet, stamp == overlaps};
        fresh += stamp != now;
        stamp = now;
      }
      count = fresh;
    }
  std::size_t kept = 0;
  constexpr std::size_t most_judgements_a_facet = 64;  // the boxes of adjacent slivers all meet
  for (std::size_t k = 0; k < count; ++k) {
    const Found found = found_[k];
    const bool apart = !found.overlaps && surely_apart(target, (*facets_)[found.facet]);
    if (!apart) found_[kept++] = found;
    if (found.facet > facet && judgements_.size() < most_judgements_a_facet * facets_->size()) {
      // A pair that is not in the list is compared again.
      judgements_.push_back({facet, judged_[found.facet], apart});
      judged_[found.facet] = static_cast<std::uint32_t>(judgements_.size() - 1);
    }
  }
  const auto last = found_.begin() + static_cast<std::ptrdiff_t>(kept);
  std::sort(found_.begin(), last, [](const Found& a, const Found& b) {
    return a.nearest != b.nearest ? a.nearest < b.nearest : a.facet < b.facet;
  });
  out.clear();
  for (auto found = found_.begin(); found != last; ++found) out.push_back(found->facet);
}

}  // namespace tubefoot
