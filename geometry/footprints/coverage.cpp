// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/footprints/coverage.hpp"

#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <map>

#include "geometry/footprints/facet_regions.hpp"
#include "geometry/footprints/line_areas.hpp"
#include "geometry/steps/stop.hpp"

// Overlays the regions that the looks see of each facet. Each region splits the cells of the facet that it
// meets, and the cells count pings. The areas of the cells are added as rationals and compared with the
// facet's area (docs/notes/coverage.md).

namespace tubefoot {
namespace {

constexpr std::uint32_t no_piece = std::numeric_limits<std::uint32_t>::max();

struct Cell {
  LinePolygon lines;
  std::vector<glm::dvec2> corners;
  ChartBox box;
  std::uint32_t pings = 0, in_sector = 0, first_look = 0;
  std::array<FacetId, 2> first_parts{};
  std::uint32_t last_ping = no_piece, last_in_sector = no_piece;

  void place() {
    corners = corners_of(lines);
    box = box_of(corners);
  }
  void count(const FacetRegion& region) {
    if (!region.hidden_too) {
      ++pings;
      last_ping = region.ping;
    } else {
      if (in_sector++ == 0) {
        first_look = region.look;
        first_parts = region.parts;
      }
      last_in_sector = region.ping;
    }
  }
  bool has_counted(const FacetRegion& region) const {
    if (region.hidden_too) return pings > 0 || last_in_sector == region.ping;
    return last_ping == region.ping;
  }
};

/// Cells, with their areas by number of pings and position in the sector.
struct Overlay {
  using Key =
      std::pair<std::uint32_t, bool>;  ///< number of pings; whether the cell is in the sector of some ping
  std::map<Key, std::vector<Fraction>> areas;
  std::vector<CoverageCell> cells;
  std::vector<glm::dvec2> corners;

  void append(Overlay&& o) {
    for (auto& [key, terms] : o.areas) {
      auto& mine = areas[key];
      std::move(terms.begin(), terms.end(), std::back_inserter(mine));
    }
    for (CoverageCell cell : o.cells) {
      cell.first += static_cast<std::uint32_t>(corners.size());
      cells.push_back(cell);
    }
    corners.insert(corners.end(), o.corners.begin(), o.corners.end());
  }
};

/// Splits, for each region in turn, the cells that its border crosses.
Overlay overlaid(const LinePolygon& place, std::span<const FacetRegion* const> regions) {
  LineStore store;
  std::vector<Cell> cells(1);
  cells[0].lines = place;
  cells[0].place();
  std::vector<LinePolygon> parts;
  for (const FacetRegion* region : regions) {
    const std::size_t count = cells.size();
    for (std::size_t k = 0; k < count; ++k) {
      stop_if_wanted();
      if (cells[k].has_counted(*region) || !cells[k].box.meets(region->box)) continue;
      parts.clear();
      if (!split_off(cells[k].lines, region->lines, store, parts)) continue;
      for (LinePolygon& part : parts) {
        Cell rest = cells[k];
        rest.lines = std::move(part);
        rest.place();
        cells.push_back(std::move(rest));
      }
      if (!parts.empty()) cells[k].place();
      cells[k].count(*region);
    }
  }
  Overlay result;
  std::map<Overlay::Key, std::vector<Fraction>> areas;
  for (const Cell& cell : cells) {
    stop_if_wanted();
    areas[{cell.pings, cell.pings == 0 && cell.in_sector > 0}].push_back(double_area(cell.lines));
    result.cells.push_back({cell.pings, cell.pings > 0 ? 0 : cell.in_sector, cell.first_look,
                            cell.first_parts, static_cast<std::uint32_t>(result.corners.size()),
                            static_cast<std::uint32_t>(cell.corners.size())});
    result.corners.insert(result.corners.end(), cell.corners.begin(), cell.corners.end());
  }
  for (const auto& [key, terms] : areas) result.areas[key].push_back(sum(terms));
  return result;
}

/// Halves a place that many regions meet, so that each region is compared with few cells.
Overlay overlaid_in_halves(const LinePolygon& place, std::vector<const FacetRegion*> regions, int depth) {
  constexpr std::size_t few = 600, many = 2000;
  const ChartBox box = box_of(corners_of(place));
  const bool wide = box.hi.x - box.lo.x > box.hi.y - box.lo.y;
  const double lo = wide ? box.lo.x : box.lo.y, hi = wide ? box.hi.x : box.hi.y;
  if (regions.size() <= few || depth > 40 || hi - lo < 16) return overlaid(place, regions);
  const auto middle = static_cast<std::int64_t>(std::floor(lo + (hi - lo) / 2));
  std::vector<const FacetRegion*> below, above;
  for (const FacetRegion* region : regions) {
    const double from = wide ? region->box.lo.x : region->box.lo.y;
    const double to = wide ? region->box.hi.x : region->box.hi.y;
    if (from <= static_cast<double>(middle)) below.push_back(region);
    if (to >= static_cast<double>(middle)) above.push_back(region);
  }
  // Halving does not separate regions that overlap each other.
  const std::size_t most = regions.size() - regions.size() / 6;
  if (below.size() > most && above.size() > most) return overlaid(place, regions);
  const PlaneLine cut = PlaneLine::of(wide ? 1 : 0, wide ? 0 : 1, -HugeInt(middle));
  LineStore store;
  std::vector<int> sides;
  std::array<LinePolygon, 2> halves{place, place};
  clip(halves[0], *store.opposite(cut), sides);
  clip(halves[1], cut, sides);
  std::array<Overlay, 2> done;
  const auto half = [&](std::size_t k, std::vector<const FacetRegion*>& its) {
    if (!halves[k].empty()) done[k] = overlaid_in_halves(halves[k], std::move(its), depth + 1);
  };
  if (regions.size() > many)
    tbb::parallel_invoke([&] { half(0, below); }, [&] { half(1, above); });
  else {
    half(0, below);
    half(1, above);
  }
  done[0].append(std::move(done[1]));
  return std::move(done[0]);
}

AreaShare share(std::uint32_t pings, const Fraction& area, const Integer& whole) {
  ExactShare exact = share_of(area, whole);
  return {pings, exact.share, std::move(exact.exact)};
}

bool may_be_within(const FacetMesh& mesh, FacetId facet, const TubeSet& tubes, std::uint32_t tube) {
  for (std::size_t k = 0; k < 4; ++k) {
    const Vec64 wall = cross(tubes.rays[tubes.tubes[tube][k]], tubes.rays[tubes.tubes[tube][(k + 1) % 4]]);
    if (std::none_of(mesh.facets[facet].begin(), mesh.facets[facet].end(),
                     [&](VertexId v) { return dot(wall, mesh.vertices[v] - tubes.apex) > 0; }))
      return false;
  }
  return true;
}

}  // namespace

Coverage::Coverage(const FacetMesh& mesh, const SceneTree& tree, std::span<const CoverageLook> looks)
    : mesh_(mesh), tree_(tree), looks_(looks) {
  // A facet that some ping sees whole has no part in shadow.
  std::vector<char> seen_whole(mesh.facets.size(), 0);
  for (std::uint32_t l = 0; l < looks.size(); ++l) {
    add_seen(l, false, seen_whole);
    if (looks[l].rx) add_seen(l, true, seen_whole);
  }
  std::vector<std::vector<Part>> within(looks.size());
  tbb::parallel_for(std::size_t{0}, looks.size(), [&](std::size_t l) {
    const auto look = static_cast<std::uint32_t>(l);
    add_within(look, false, seen_whole, within[l]);
    if (looks[l].rx) add_within(look, true, seen_whole, within[l]);
  });
  for (const auto& parts : within) within_.insert(within_.end(), parts.begin(), parts.end());
  index();
}

void Coverage::add_seen(std::uint32_t l, bool rx, std::vector<char>& seen_whole) {
  const CoverageLook& look = looks_[l];
  const CoverageEnd& end = rx ? *look.rx : look.tx;
  const FacetMesh& mesh = end.seabed ? *end.seabed->mesh : mesh_;
  for (std::uint32_t tube = 0; tube < end.seen.size(); ++tube) {
    stop_if_wanted();
    const TubeVisibility& seen = end.seen[tube];
    for (std::uint32_t k = 0; k < seen.pieces.size(); ++k) {
      const FacetId own = seen.pieces[k].facet, facet = end.base_of(own);
      seen_.push_back({facet, l, end.name_of(own), rx, own, tube, k});
      if (!look.rx && !end.is_displaced(own) && !seen_whole[facet] &&
          is_whole_facet(mesh, seen, seen.pieces[k]) && surely_in_window(look, mesh, own, mesh, own))
        seen_whole[facet] = 1;
    }
  }
}

void Coverage::add_within(std::uint32_t l, bool rx, const std::vector<char>& seen_whole,
                          std::vector<Part>& to) const {
  const CoverageLook& look = looks_[l];
  const CoverageEnd& end = rx ? *look.rx : look.tx;
  const FacetMesh& mesh = end.seabed ? *end.seabed->mesh : mesh_;
  const SceneTree& tree = end.seabed ? *end.seabed->tree : tree_;
  // Parts that the look itself sees whole. With one end this suffices.
  std::vector<char> part_whole;
  if (end.seabed && !look.rx) {
    part_whole.resize(mesh.facets.size(), 0);
    for (const TubeVisibility& seen : end.seen)
      for (const NamedPiece& piece : seen.pieces)
        if (is_whole_facet(mesh, seen, piece) && surely_in_window(look, mesh, piece.facet, mesh, piece.facet))
          part_whole[piece.facet] = 1;
  }
  const TubeSet& tubes = end.tubes;
  std::vector<FacetId> candidates;
  for (std::uint32_t tube = 0; tube < tubes.tubes.size(); ++tube) {
    stop_if_wanted();
    std::array<SceneTree::HalfSpace, 4> walls{};
    for (std::size_t k = 0; k < 4; ++k) {
      const Vec64 n = cross(tubes.rays[tubes.tubes[tube][k]], tubes.rays[tubes.tubes[tube][(k + 1) % 4]]);
      walls[k] = {static_cast<double>(n.x), static_cast<double>(n.y), static_cast<double>(n.z)};
    }
    candidates.clear();
    // Half a path length can be less than the range from one of its ends.
    tree.query(tubes.apex, walls, look.rx ? tubes.reach : std::min(tubes.reach, look.farthest), candidates);
    for (const FacetId own : candidates) {
      const FacetId facet = end.base_of(own);
      if (!seen_whole[facet] && (part_whole.empty() || !part_whole[own]) &&
          may_be_within(mesh, own, tubes, tube))
        to.push_back({facet, l, end.name_of(own), rx, own, tube, no_piece});
    }
  }
}

void Coverage::index() {
  const auto key = [](const Part& p) { return std::tuple(p.facet, p.look, p.name, p.rx, p.tube, p.piece); };
  const auto before = [&](const Part& a, const Part& b) { return key(a) < key(b); };
  tbb::parallel_sort(seen_.begin(), seen_.end(), before);
  tbb::parallel_sort(within_.begin(), within_.end(), before);
  std::size_t s = 0, w = 0;
  while (s < seen_.size() || w < within_.size()) {
    const FacetId facet = std::min(s < seen_.size() ? seen_[s].facet : no_facet,
                                   w < within_.size() ? within_[w].facet : no_facet);
    Group group{s, s, w, w};
    while (s < seen_.size() && seen_[s].facet == facet) ++s;
    while (w < within_.size() && within_[w].facet == facet) ++w;
    group.seen_end = s;
    group.within_end = w;
    const auto& [a, b, c] = mesh_.facets[facet];
    if (!is_degenerate(mesh_.vertices[a], mesh_.vertices[b], mesh_.vertices[c])) groups_.push_back(group);
  }
}

/// Returns the facets of an end's seabed to which these parts belong. This is one facet, unless several
/// facets of the end have the same name, as images in mirrors have that cut a facet.
std::vector<FacetId> Coverage::own_parts(std::span<const Part> parts) {
  std::vector<FacetId> own;
  for (const Part& part : parts)
    if (std::find(own.begin(), own.end(), part.own) == own.end()) own.push_back(part.own);
  return own;
}

/// Adds the regions of parts of one facet: visible polygons of the looks, or the areas in their tubes.
void Coverage::add_regions(FacetRegions& facet, std::span<const Part> parts) const {
  const auto polygon = [&](const FacetRegions::Aspect& from, const Part& part) {
    return part.piece == no_piece ? facet.within(from, part.tube) : facet.seen(from, part.tube, part.piece);
  };
  struct Placed {
    LinePolygon polygon;
    ChartBox box;
  };
  thread_local std::vector<int> sides;
  for (std::size_t first = 0, end = 0; first < parts.size(); first = end) {
    const Part& part = parts[first];
    while (end < parts.size() && parts[end].look == part.look && parts[end].name == part.name) ++end;
    std::size_t rx = first;
    while (rx < end && !parts[rx].rx) ++rx;
    const CoverageLook& look = looks_[part.look];
    if (rx == first || (look.rx && rx == end)) continue;  // in the sector of one end only
    const std::span<const Part> sent = parts.subspan(first, rx - first),
                                listened = parts.subspan(rx, end - rx);
    for (const FacetId own : own_parts(sent)) {
      const FacetRegions::Aspect tx = facet.aspect(look.tx, own);
      if (tx.edge_on) continue;
      FacetRegion what{look.ping, part.look, {own, own}, part.piece == no_piece, {}, {}};
      if (!look.rx) {
        const FacetRegions::Window window = facet.window(look, tx, nullptr);
        if (window.none) continue;
        for (const Part& its : sent)
          if (its.own == own) facet.add(window, polygon(tx, its), what);
        continue;
      }
      for (const FacetId own_rx : own_parts(listened)) {
        what.parts[1] = own_rx;
        const FacetRegions::Aspect there = facet.aspect(*look.rx, own_rx);
        if (there.edge_on || (!what.hidden_too && tx.seen.reversed != there.seen.reversed)) continue;
        const FacetRegions::Window window = facet.window(look, tx, &there);
        if (window.none) continue;
        std::vector<Placed> received;
        for (const Part& its : listened)
          if (its.own == own_rx)
            if (LinePolygon p = polygon(there, its); !p.empty()) {
              const ChartBox box = box_of(corners_of(p));
              received.push_back({std::move(p), box});
            }
        for (const Part& its : sent) {
          if (its.own != own) continue;
          const LinePolygon from = polygon(tx, its);
          if (from.empty()) continue;
          const ChartBox box = box_of(corners_of(from));
          for (const Placed& other : received) {
            stop_if_wanted();
            if (!box.meets(other.box)) continue;
            LinePolygon both = from;
            for (const PlaneLine* line : other.polygon) {
              if (!both.empty() && std::find(both.begin(), both.end(), line) == both.end())
                clip(both, *line, sides);
            }
            facet.add(window, std::move(both), what);
          }
        }
      }
    }
  }
}

FacetCoverage Coverage::facet(std::size_t number) const {
  const Group& group = groups_[number];
  FacetCoverage result;
  result.facet = facet_of(number);
  const std::array parts{std::span(seen_).subspan(group.seen, group.seen_end - group.seen),
                         std::span(within_).subspan(group.within, group.within_end - group.within)};
  constexpr double fine_range = 16 * least_ring;
  const bool by_weights = std::ranges::any_of(parts, [&](std::span<const Part> some) {
    return std::ranges::any_of(some, [&](const Part& part) {
      const CoverageLook& look = looks_[part.look];
      // On a coarse grid the corners of range gates would be rounded too much.
      return (part.rx ? *look.rx : look.tx).is_displaced(part.own) || look.farthest < fine_range;
    });
  });
  FacetRegions facet(mesh_, result.facet, by_weights);
  for (const std::span<const Part> some : parts) add_regions(facet, some);
  std::vector<const FacetRegion*> regions;
  for (const FacetRegion& region : facet.regions()) regions.push_back(&region);
  Overlay overlay = overlaid_in_halves(facet.triangle(), std::move(regions), 0);

  const Integer whole = integer(facet.double_area());
  std::vector<Fraction> all, seen, shadow;
  std::map<std::uint32_t, std::vector<Fraction>> by_pings;
  for (const auto& [key, terms] : overlay.areas) {
    const Fraction area = sum(terms);
    all.push_back(area);
    by_pings[key.first].push_back(area);
    if (key.first > 0) seen.push_back(area);
    if (key.second) shadow.push_back(area);
  }
  const Fraction total = sum(all);
  result.closes = total.numerator == product(whole, total.denominator);
  std::uint32_t most = 0, most_in_shadow = 0;
  for (const CoverageCell& cell : overlay.cells) {
    most = std::max(most, cell.pings);
    most_in_shadow = std::max(most_in_shadow, cell.in_sector);
  }
  for (const auto& [pings, terms] : by_pings) result.by_pings.push_back(share(pings, sum(terms), whole));
  result.seen = share(most, sum(seen), whole);
  result.shadow = share(most_in_shadow, sum(shadow), whole);
  result.cells = std::move(overlay.cells);
  for (const glm::dvec2& corner : overlay.corners) result.corners.push_back(facet.in_space(corner));
  return result;
}

FacetId Coverage::occluder(const FacetCoverage& of, const CoverageCell& cell) const {
  glm::dvec3 middle(0);
  for (std::uint32_t c = 0; c < cell.count; ++c)
    middle += of.corners[cell.first + c] / static_cast<double>(cell.count);
  const auto corner = [](const FacetMesh& mesh, FacetId facet, std::size_t k) {
    const GridPoint& p = mesh.vertices[mesh.facets[facet][k]];
    return glm::dvec3(p.x, p.y, p.z);
  };
  const auto hides = [&](const CoverageEnd& end, FacetId own) {
    if (!end.seabed) return first_in_the_way(mesh_, tree_, end.tubes.apex, middle);
    // The point in the end's seabed that lies between the part's corners as the middle does.
    const glm::dvec3 origin = corner(mesh_, of.facet, 0), along = corner(mesh_, of.facet, 1) - origin,
                     across = corner(mesh_, of.facet, 2) - origin, n = glm::cross(along, across);
    const double area2 = glm::dot(n, n) / static_cast<double>(whole_weight);
    const glm::dvec2 at{glm::dot(n, glm::cross(middle - origin, across)) / area2,
                        glm::dot(n, glm::cross(along, middle - origin)) / area2};
    const PartWeights& w = end.weights_of(own);
    const auto edge = [&](std::size_t k) { return glm::dvec2(w[k][0] - w[0][0], w[k][1] - w[0][1]); };
    const auto cross = [](glm::dvec2 a, glm::dvec2 b) { return a.x * b.y - a.y * b.x; };
    const glm::dvec2 from = at - glm::dvec2(w[0][0], w[0][1]);
    const double whole = cross(edge(1), edge(2));
    const glm::dvec3 first = corner(*end.seabed->mesh, own, 0);
    const FacetId own_occluder = first_in_the_way(
        *end.seabed->mesh, *end.seabed->tree, end.tubes.apex,
        first + (corner(*end.seabed->mesh, own, 1) - first) * (cross(from, edge(2)) / whole) +
            (corner(*end.seabed->mesh, own, 2) - first) * (cross(edge(1), from) / whole));
    return own_occluder == no_facet ? no_facet : end.base_of(own_occluder);
  };
  const CoverageLook& look = looks_[cell.first_look];
  const FacetId tx = hides(look.tx, cell.first_parts[0]);
  return tx != no_facet || !look.rx ? tx : hides(*look.rx, cell.first_parts[1]);
}

FacetId first_in_the_way(const FacetMesh& mesh, const SceneTree& tree, GridPoint apex, glm::dvec3 point) {
  const glm::dvec3 way = point - glm::dvec3(apex.x, apex.y, apex.z);
  const double length = glm::length(way);
  if (!(length > 0)) return no_facet;
  const glm::dvec3 d = way / length;
  const glm::dvec3 across = std::abs(d.x) < 0.7 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
  const glm::dvec3 e = glm::normalize(glm::cross(d, across)), f = glm::cross(d, e);
  constexpr double slack = 1e-9;
  std::array<SceneTree::HalfSpace, 4> walls{};
  const std::array<glm::dvec3, 4> normals{e + slack * d, -e + slack * d, f + slack * d, -f + slack * d};
  for (std::size_t k = 0; k < 4; ++k) walls[k] = {normals[k].x, normals[k].y, normals[k].z};
  std::vector<FacetId> candidates;
  tree.query(apex, walls, length, candidates);
  FacetId nearest = no_facet;
  double range = length * (1 - 1e-9);
  std::sort(candidates.begin(), candidates.end());
  for (const FacetId id : candidates) {
    FacetCone cone;
    if (!FacetCone::make(mesh, id, apex, cone)) continue;
    const auto inner = [&](const Vec64& n) {
      return static_cast<double>(n.x) * d.x + static_cast<double>(n.y) * d.y + static_cast<double>(n.z) * d.z;
    };
    bool inside = true;
    for (std::size_t k = 0; k < 3 && inside; ++k)
      inside = inner(cross(cone.point[k], cone.point[(k + 1) % 3])) >= 0;
    const double along = inside ? static_cast<double>(cone.offset) / inner(cone.normal) : 0;
    if (inside && along < range) {
      range = along;
      nearest = id;
    }
  }
  return nearest;
}

}  // namespace tubefoot
