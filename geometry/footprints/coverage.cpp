// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/footprints/coverage.hpp"

#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <boost/multiprecision/gmp.hpp>
#include <cmath>
#include <glm/geometric.hpp>
#include <map>

#include "geometry/footprints/facet_regions.hpp"
#include "geometry/steps/stop.hpp"

namespace tubefoot {
namespace {

using Integer = boost::multiprecision::mpz_int;

constexpr std::uint32_t no_piece = std::numeric_limits<std::uint32_t>::max();

/// Not reduced: a sum of many costs products, not greatest common divisors.
struct Fraction {
  Integer numerator = 0, denominator = 1;
};

Fraction sum(const std::vector<Fraction>& terms, std::size_t begin, std::size_t end) {
  if (begin == end) return {};
  if (end - begin == 1) return terms[begin];
  const std::size_t middle = begin + (end - begin) / 2;
  const Fraction a = sum(terms, begin, middle), b = sum(terms, middle, end);
  if (a.denominator == b.denominator) return {a.numerator + b.numerator, a.denominator};
  return {a.numerator * b.denominator + b.numerator * a.denominator, a.denominator * b.denominator};
}
Fraction sum(const std::vector<Fraction>& terms) { return sum(terms, 0, terms.size()); }

Integer integer(const HugeInt& x) {
  Integer z;
  const auto& limbs = x.backend();
  mpz_import(z.backend().data(), limbs.size(), -1, sizeof(*limbs.limbs()), 0, 0, limbs.limbs());
  return limbs.sign() ? Integer(-z) : z;
}

/// Twice the area of a polygon. Its corner k is L_k-1 x L_k, so that corner k x corner k+1 =
/// L_k det(L_k-1, L_k, L_k+1): with c the third coefficient of L_k and w the third of a corner, the sum of
/// c det / (w w').
Fraction double_area(const LinePolygon& polygon) {
  const std::size_t n = polygon.size();
  struct Coefficients {
    Integer a, b, c;
  };
  std::vector<Coefficients> line;
  for (const PlaneLine* l : polygon) line.push_back({integer(l->a), integer(l->b), integer(l->c)});
  std::vector<Integer> weight(n);  // of the corner in which line k begins
  for (std::size_t k = 0; k < n; ++k) {
    const Coefficients &p = line[(k + n - 1) % n], &q = line[k];
    weight[k] = p.a * q.b - p.b * q.a;
  }
  std::vector<Fraction> terms;
  for (std::size_t k = 0; k < n; ++k) {
    const Coefficients &p = line[(k + n - 1) % n], &q = line[k], &r = line[(k + 1) % n];
    if (q.c == 0) continue;
    const Integer det = weight[k] * r.c + (p.b * q.c - p.c * q.b) * r.a + (p.c * q.a - p.a * q.c) * r.b;
    terms.push_back({q.c * det, weight[k] * weight[(k + 1) % n]});
  }
  return sum(terms);
}

struct Cell {
  LinePolygon lines;
  std::vector<glm::dvec2> corners;
  ChartBox box;
  std::uint32_t pings = 0, in_sector = 0, first_look = 0;
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
      if (in_sector++ == 0) first_look = region.look;
      last_in_sector = region.ping;
    }
  }
  bool has_counted(const FacetRegion& region) const {
    if (region.hidden_too) return pings > 0 || last_in_sector == region.ping;
    return last_ping == region.ping;
  }
};

/// Cells with their areas by what is known of them.
struct Overlay {
  using Key = std::pair<std::uint32_t, bool>;  ///< pings; in the sector of some
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

/// Each region in turn splits the cells that it meets, where it borders.
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
                            static_cast<std::uint32_t>(result.corners.size()),
                            static_cast<std::uint32_t>(cell.corners.size())});
    result.corners.insert(result.corners.end(), cell.corners.begin(), cell.corners.end());
  }
  for (const auto& [key, terms] : areas) result.areas[key].push_back(sum(terms));
  return result;
}

/// Where many regions meet a place it is halved first, so that each is held against few cells.
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
  // Regions that lie on top of each other are not told apart by halving.
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

/// Numerator and denominator scaled to what a double holds.
double ratio(const Integer& numerator, const Integer& denominator) {
  long top = 0, bottom = 0;
  const double n = mpz_get_d_2exp(&top, numerator.backend().data());
  const double d = mpz_get_d_2exp(&bottom, denominator.backend().data());
  return std::ldexp(n / d, static_cast<int>(top - bottom));
}

AreaShare share(std::uint32_t pings, const Fraction& area, const Integer& whole) {
  Integer p = area.numerator, q = area.denominator * whole;
  if (q < 0) {
    p = -p;
    q = -q;
  }
  const Integer common = gcd(p, q);
  p /= common;
  q /= common;
  return {pings, ratio(p, q), q == 1 ? p.str() : p.str() + "/" + q.str()};
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
  // Of a facet that a ping sees all of, nothing lies in a shadow.
  std::vector<char> seen_whole(mesh.facets.size(), 0);
  for (std::uint32_t l = 0; l < looks.size(); ++l)
    for (std::uint32_t tube = 0; tube < looks[l].seen.size(); ++tube) {
      stop_if_wanted();
      const TubeVisibility& seen = looks[l].seen[tube];
      for (std::uint32_t k = 0; k < seen.pieces.size(); ++k) {
        const FacetId facet = seen.pieces[k].facet;
        seen_.push_back({facet, l, tube, k});
        if (!seen_whole[facet] && is_whole_facet(mesh, seen, seen.pieces[k]) &&
            surely_in_window(mesh, facet, looks[l]))
          seen_whole[facet] = 1;
      }
    }
  std::vector<std::vector<Part>> within(looks.size());
  tbb::parallel_for(std::size_t{0}, looks.size(), [&](std::size_t l) {
    const TubeSet& tubes = looks[l].tubes;
    std::vector<FacetId> candidates;
    for (std::uint32_t tube = 0; tube < tubes.tubes.size(); ++tube) {
      stop_if_wanted();
      std::array<SceneTree::HalfSpace, 4> walls{};
      for (std::size_t k = 0; k < 4; ++k) {
        const Vec64 n = cross(tubes.rays[tubes.tubes[tube][k]], tubes.rays[tubes.tubes[tube][(k + 1) % 4]]);
        walls[k] = {static_cast<double>(n.x), static_cast<double>(n.y), static_cast<double>(n.z)};
      }
      candidates.clear();
      tree.query(tubes.apex, walls, std::min(tubes.reach, looks[l].farthest), candidates);
      for (const FacetId facet : candidates)
        if (!seen_whole[facet] && may_be_within(mesh, facet, tubes, tube))
          within[l].push_back({facet, static_cast<std::uint32_t>(l), tube, no_piece});
    }
  });
  for (const auto& parts : within) within_.insert(within_.end(), parts.begin(), parts.end());
  index();
}

void Coverage::index() {
  const auto key = [](const Part& p) { return std::tuple(p.facet, p.look, p.tube, p.piece); };
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

FacetCoverage Coverage::facet(std::size_t number) const {
  const Group& group = groups_[number];
  FacetCoverage result;
  result.facet = facet_of(number);
  FacetRegions facet(mesh_, result.facet);
  for (std::size_t k = group.seen; k < group.seen_end; ++k)
    facet.add_seen(looks_[seen_[k].look], seen_[k].look, seen_[k].tube, seen_[k].piece);
  for (std::size_t k = group.within; k < group.within_end; ++k)
    facet.add_within(looks_[within_[k].look], within_[k].look, within_[k].tube);
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
  result.closes = total.numerator == whole * total.denominator;
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
