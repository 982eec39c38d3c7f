// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/footprints/coverage.hpp"

#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <map>
#include <optional>

#include "geometry/footprints/facet_regions.hpp"
#include "geometry/footprints/line_areas.hpp"
#include "geometry/steps/stop.hpp"

// Overlays the regions that the looks see of each facet. The borders of these regions divide the facet into
// cells, which count pings. The areas of the cells are added as rationals unless these become too long. A
// residue of their sum is compared with that of the facet's area (docs/notes/coverage.md).

namespace tubefoot {
namespace {

constexpr std::uint32_t no_piece = std::numeric_limits<std::uint32_t>::max();

/// Largest number of bits of the denominator of an exact area, also of the sum of a part of the cells.
constexpr std::size_t longest_denominator = 65536;

/// The cells of a facet that have one number of pings and are in a shadow or not.
struct Category {
  std::vector<std::uint32_t> cells;
  std::optional<Fraction> exact;  ///< twice the area on the chart, unless it is too long
  double area = 0, error = 0;     ///< the same, and the largest error of `area`
};
using Categories = std::map<std::pair<std::uint32_t, bool>, Category>;

/// Sums the areas of some categories.
class AreaSum {
 public:
  explicit AreaSum(const Integer& whole) : whole_(whole), whole_near_(whole.convert_to<double>()) {}

  void add(const Category& category) {
    parts_.push_back(category.exact);
    area_ += category.area;
    error_ += category.error;
  }
  bool empty() const { return parts_.empty(); }
  /// Returns the sum if all of its parts are known exactly.
  std::optional<Fraction> exact() const {
    std::vector<Fraction> known;
    for (const auto& part : parts_) {
      if (!part) return std::nullopt;
      known.push_back(*part);
    }
    return sum_within(
        known.size(), [&](std::size_t k) { return known[k]; }, longest_denominator);
  }
  /// Returns the sum as a share of the facet. `rest` has all other parts of the facet.
  AreaShare share(std::uint32_t pings, const AreaSum& rest) const {
    if (empty()) return {pings, 0, "0", 0};
    if (rest.empty()) return {pings, 1, "1", 0};
    std::optional<Fraction> area = exact();
    if (!area)
      if (const std::optional<Fraction> other = rest.exact())
        area = Fraction{product(whole_, other->denominator) - other->numerator, other->denominator};
    if (area) {
      ExactShare found = share_of(*area, whole_);
      return {pings, found.share, std::move(found.exact), found.share * 0x1p-52};
    }
    return {pings, area_ / whole_near_, {}, error_ / whole_near_ + 0x1p-51};
  }

 private:
  const Integer& whole_;
  double whole_near_;
  std::vector<std::optional<Fraction>> parts_;
  double area_ = 0, error_ = 0;
};

/// Computes twice the area of a cell in double, and adds the largest error to `error`.
double near_area(std::span<const glm::dvec2> corners, double& error) {
  double sum = 0, length = 0, size = 0;
  for (std::size_t k = 0; k < corners.size(); ++k) {
    const glm::dvec2 a = corners[k] - corners[0],
                     way = corners[k + 1 == corners.size() ? 0 : k + 1] - corners[k];
    sum += a.x * way.y - a.y * way.x;
    length += std::abs(way.x) + std::abs(way.y);
    size = std::max({size, std::abs(corners[k].x), std::abs(corners[k].y)});
  }
  // Each coordinate of a corner is accurate to 4 units in the last place, below 1e-15 of `size`. A moved
  // corner changes twice the area by at most its way times the length of the border. Rounding adds less.
  error += 8e-15 * size * length;
  return sum;
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

/// Adds the layers of parts of one facet: visible polygons of the looks, or the areas in their tubes.
void Coverage::add_layers(FacetRegions& facet, std::span<const Part> parts) const {
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
    const bool hidden_too = part.piece == no_piece;
    while (end < parts.size() && parts[end].look == part.look && parts[end].name == part.name) ++end;
    std::size_t rx = first;
    while (rx < end && !parts[rx].rx) ++rx;
    const CoverageLook& look = looks_[part.look];
    const std::span<const Part> sent = parts.subspan(first, rx - first),
                                listened = parts.subspan(rx, end - rx);
    // A look with two ends needs both.
    const bool both_ends = !sent.empty() && (!look.rx || !listened.empty());
    for (const FacetId own : both_ends ? own_parts(sent) : std::vector<FacetId>{}) {
      const FacetRegions::Aspect tx = facet.aspect(look.tx, own);
      if (tx.edge_on) continue;
      if (!look.rx) {
        const FacetRegions::Window window = facet.window(look, tx, nullptr);
        if (window.none) continue;
        for (const Part& its : sent)
          if (its.own == own) facet.add(window, polygon(tx, its));
        if (hidden_too) facet.end_layer({look.ping, part.look, {own, own}, true, {}});
        continue;
      }
      for (const FacetId own_rx : own_parts(listened)) {
        const FacetRegions::Aspect there = facet.aspect(*look.rx, own_rx);
        if (there.edge_on || (!hidden_too && tx.seen.reversed != there.seen.reversed)) continue;
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
            facet.add(window, std::move(both));
          }
        }
        if (hidden_too) facet.end_layer({look.ping, part.look, {own, own_rx}, true, {}});
      }
    }
    // All parts that one ping sees are one layer.
    if (!hidden_too && (end == parts.size() || looks_[parts[end].look].ping != look.ping))
      facet.end_layer({look.ping, part.look, {}, false, {}});
    facet.drop_lines();
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
  for (const std::span<const Part> some : parts) add_layers(facet, some);
  CoverageCells divided = divided_by_borders(facet.table(), facet.triangle(), facet.layers());
  measure(facet, divided, result);
  result.cells = std::move(divided.cells);
  result.corners.reserve(divided.corners.size());
  for (const glm::dvec2& corner : divided.corners) result.corners.push_back(facet.in_space(corner));
  return result;
}

/// Computes the shares of the cells, and whether they add up to the facet.
void Coverage::measure(const FacetRegions& facet, const CoverageCells& divided, FacetCoverage& result) {
  const LineTable& table = facet.table();
  const Integer whole = integer(facet.double_area());
  const auto lines_of = [&](std::uint32_t cell) {
    return std::span(divided.lines).subspan(divided.cells[cell].first, divided.cells[cell].count);
  };
  Categories categories;
  Residue total = 0;
  for (std::uint32_t k = 0; k < divided.cells.size(); ++k) {
    stop_if_wanted();
    const CoverageCell& cell = divided.cells[k];
    Category& category = categories[{cell.pings, cell.in_sector > 0}];
    category.cells.push_back(k);
    category.area += near_area(std::span(divided.corners).subspan(cell.first, cell.count), category.error);
    total = residue_sum(total, double_area_residue(table, lines_of(k)));
    result.seen.pings = std::max(result.seen.pings, cell.pings);
    result.shadow.pings = std::max(result.shadow.pings, cell.in_sector);
  }
  result.closes = total == residue_of(facet.double_area());
  for (auto& [key, category] : categories)
    category.exact = sum_within(
        category.cells.size(), [&](std::size_t k) { return double_area(table, lines_of(category.cells[k])); },
        longest_denominator);
  const auto share = [&](std::uint32_t pings, const auto& belongs) {
    AreaSum its(whole), rest(whole);
    for (const auto& [key, category] : categories) (belongs(key) ? its : rest).add(category);
    return its.share(pings, rest);
  };
  for (auto at = categories.begin(); at != categories.end();) {
    const std::uint32_t pings = at->first.first;
    result.by_pings.push_back(share(pings, [&](const auto& key) { return key.first == pings; }));
    while (at != categories.end() && at->first.first == pings) ++at;
  }
  result.seen = share(result.seen.pings, [](const auto& key) { return key.first > 0; });
  result.shadow = share(result.shadow.pings, [](const auto& key) { return key.second; });
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
