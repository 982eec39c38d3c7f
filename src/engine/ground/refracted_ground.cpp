// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/ground/refracted_ground.hpp"

#include <tbb/concurrent_unordered_map.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <deque>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <optional>
#include <stdexcept>
#include <tuple>
#include <unordered_map>

#include "engine/ground/paired_facet.hpp"
#include "geometry/mesh/weld_table.hpp"
#include "geometry/steps/stop.hpp"

namespace tubefoot {
namespace {

/// Decibels of a small relative change.
constexpr double db_per_relative = 4.3429448190325183;

/// A point's image, and what rays to it return; without eigenray: not `seen`.
struct Image {
  glm::dvec3 at_m{0};
  CornerReturn returned;
  double range_m = 0;
  /// What a level facet's factor is here, in decibels.
  double level_db = 0;
  int eigenrays = 0;
  bool seen() const { return eigenrays > 0; }
  /// One ray, whose tube is about as wide as that of a straight one: far from caustics.
  bool regular() const { return eigenrays == 1 && returned.spreading > 0.25 && returned.spreading < 4; }
};

struct PlaceHash {
  std::size_t operator()(const glm::dvec3& p) const {
    std::uint64_t h = 0;
    for (int i = 0; i < 3; ++i)
      h = (std::rotl(h, 21) ^ std::bit_cast<std::uint64_t>(p[i] + 0.0)) * 0x9e3779b97f4a7c15u;
    return h ^ (h >> 32);
  }
};

/// Makes images, and says which edges between them are to be cut.
class Images {
 public:
  Images(const Straightening& straightening, double reference_absorption_db_per_m,
         const StraighteningSettings& settings, const Outlook* outlook)
      : straightening_(straightening),
        absorption_(reference_absorption_db_per_m),
        settings_(settings),
        outlook_(outlook),
        bend_per_m_(straightening.water().profile.largest_bend_per_m()) {}

  Image make(const glm::dvec3& point_m) const {
    const std::optional<ApparentPoint> found = straightening_.apparent(point_m);
    if (!found) return {};
    const CornerReturn returned = corner_return(straightening_, point_m, *found, absorption_);
    if (!std::isfinite(returned.spreading)) return {};  // on a caustic, where rays say nothing
    // Rays that are nearly level, where they turn, do not make it as small or large as they could: little
    // comes back from there.
    constexpr double least = 0.1;
    const double sines = std::max(std::abs(found->ray.arrival_sine), least) /
                         std::max(std::abs(found->ray.launch_sine), least);
    return {found->at_m, returned, glm::distance(found->at_m, straightening_.apex_m()),
            db_per_relative * std::log(returned.spreading * sines), found->eigenrays};
  }

  /// The gap of an edge, metres. Straight lines are seen curved about as much as rays are, at most g / c per
  /// metre, where rays spread about as in even water: of a short edge there, twice that is as good.
  double gap_m(const glm::dvec3& a, const glm::dvec3& b, const Image& from, const Image& to,
               const Image* middle = nullptr) const {
    if (middle != nullptr) return edge_gap_m(from.at_m, to.at_m, middle->at_m);
    const glm::dvec3 edge = b - a;
    return from.regular() && to.regular() ? bend_per_m_ * glm::dot(edge, edge) / 4
                                          : std::numeric_limits<double>::infinity();
  }

  /// Short beside its range: the ends say how things change along it.
  static bool is_short(double length, const Image& from, const Image& to) {
    return 4 * length < std::min(from.range_m, to.range_m);
  }

  /// Whether the bound of gap_m() will do, and the images of the ends are enough.
  bool surely_whole(const glm::dvec3& a, const glm::dvec3& b, const Image& from, const Image& to) const {
    const double length = glm::distance(a, b);
    return is_short(length, from, to) && is_fine(length, gap_m(a, b, from, to), from, to, to);
  }

  /// Whether an edge is long for how near it is to an apex on the bed: facets that hold the apex, or nearly,
  /// lie then where rays are straight.
  bool is_long_nearby(const glm::dvec3& a, const glm::dvec3& b) const {
    const double within_m = straightening_.straight_within_m();
    if (!(within_m > 0)) return false;
    const double length = glm::distance(a, b);
    return 2 * length > within_m && glm::distance((a + b) / 2.0, straightening_.apex_m()) < 2 * length;
  }

  template <class ImageOf>
  bool cuts(const glm::dvec3& a, const glm::dvec3& b, const ImageOf& image_of) const {
    const double length = glm::distance(a, b);
    const Image &from = image_of(a), &to = image_of(b);
    if (from.seen() && to.seen() && surely_whole(a, b, from, to)) return false;
    const Image& middle = image_of((a + b) / 2.0);
    // Shadows and caustics are cut evenly, in and beside them: a border narrowed down between long edges
    // would not end.
    if (!from.regular() || !to.regular() || !middle.regular()) return length > settings_.shadow_edge_m;
    return !is_fine(length, gap_m(a, b, from, to, &middle), from, to, middle);
  }

  /// Whether what lies about an edge is asked for: the ball of EdgeRule about it, and of that, where only one
  /// facet may be cut by it, what lies in that facet's box.
  bool concerns(const glm::dvec3& a, const glm::dvec3& b, const FacetMesh& base, FacetId facet,
                const WorldGrid& grid, bool inside) const {
    const double length = glm::distance(a, b);
    if (!(length > settings_.shortest_edge_m)) return false;
    if (outlook_ == nullptr) return true;
    const glm::dvec3 middle = (a + b) / 2.0;
    if (!outlook_->may_see(middle, 2 * length)) return false;
    if (!inside) return true;
    glm::dvec3 lowest = grid.to_metres(base.vertices[base.facets[facet][0]]), highest = lowest;
    for (std::size_t k = 1; k < 3; ++k) {
      const glm::dvec3 corner = grid.to_metres(base.vertices[base.facets[facet][k]]);
      lowest = glm::min(lowest, corner);
      highest = glm::max(highest, corner);
    }
    return outlook_->may_see_box(glm::max(lowest, middle - 2 * length),
                                 glm::min(highest, middle + 2 * length));
  }

  /// So small beside its range that its corners say all that its factor needs. `seen_m`: from the apex.
  bool is_small(const glm::dvec3 (&corners_m)[3], const glm::dvec3 (&seen_m)[3]) const {
    constexpr double negligible = 1e-6;
    const glm::dvec3 normal = glm::cross(seen_m[1] - seen_m[0], seen_m[2] - seen_m[0]);
    double longest2 = 0, least = std::numeric_limits<double>::infinity();  // range times sine
    for (int i = 0; i < 3; ++i) {
      const glm::dvec3 edge = corners_m[(i + 1) % 3] - corners_m[i];
      longest2 = std::max(longest2, glm::dot(edge, edge));
      least = std::min(least, std::abs(glm::dot(normal, seen_m[i])));
    }
    return bend_per_m_ * longest2 * glm::length(normal) <= negligible * least;
  }
  double reference_absorption_db_per_m() const { return absorption_; }

  bool may_see(const glm::dvec3 (&corners_m)[3]) const {
    return outlook_ == nullptr || outlook_->may_see(corners_m);
  }

 private:
  /// A gap that grows as the square of the way along the edge changes lengths by 4 gap / length at its ends;
  /// one factor for a facet is off by half the change between them.
  bool is_fine(double length, double gap, const Image& from, const Image& to, const Image& middle) const {
    const auto [least, most] = std::minmax({from.level_db, to.level_db, middle.level_db});
    return gap <= settings_.gap_m &&
           db_per_relative * 4 * gap / length + (most - least) / 2 <= settings_.tolerance_db;
  }

  const Straightening& straightening_;
  double absorption_;
  StraighteningSettings settings_;
  const Outlook* outlook_;
  double bend_per_m_ = 0;
};

/// Asks Images for a refinement, each image made once.
class GapRule final : public EdgeRule {
 public:
  GapRule(const Images& images, const FacetMesh& base, const WorldGrid& grid)
      : images_(images), base_(base), grid_(grid) {}
  bool cuts(const BasePoint& a, const BasePoint& b) const override {
    // Where images jump, as the first ray to arrive does, cutting need not end beside a long edge that is
    // fine: there it ends here.
    constexpr double most_parts = 1 << (deepest_refinement - 2);
    for (const BasePoint* p : {&a, &b})
      for (const double weight : p->weight)
        if (std::floor(weight * most_parts) != weight * most_parts) return false;
    if (images_.is_long_nearby(a.at_m, b.at_m)) return true;
    bool inside = true;  // not on an edge of the base, where two facets have to agree
    for (std::size_t k = 0; k < 3; ++k) inside = inside && (a.weight[k] != 0 || b.weight[k] != 0);
    if (!images_.concerns(a.at_m, b.at_m, base_, a.facet, grid_, inside)) return false;
    return images_.cuts(a.at_m, b.at_m, [this](const glm::dvec3& p) -> const Image& { return of(p); });
  }
  const Image& of(const glm::dvec3& point_m) const {
    const auto known = known_.find(point_m);
    if (known != known_.end()) return known->second;
    return known_.emplace(point_m, images_.make(point_m)).first->second;
  }

 private:
  const Images& images_;
  const FacetMesh& base_;
  const WorldGrid& grid_;
  mutable tbb::concurrent_unordered_map<glm::dvec3, Image, PlaceHash> known_;
};

/// True facets, fine enough, and their vertices' images.
struct FineFacets {
  RefinedMesh mesh;
  std::vector<glm::dvec3> at_m;
  std::vector<Image> image;
};

/// The facets as they are, and whether an edge of one may have to be cut.
FineFacets unrefined(const FacetMesh& base, std::span<const FacetId> facets, const WorldGrid& grid,
                     const Images& images, bool weights, std::vector<FacetId>& to_cut) {
  FineFacets fine;
  std::unordered_map<VertexId, VertexId> own;
  own.reserve(facets.size());
  FacetMesh& mesh = fine.mesh.mesh;
  for (const FacetId f : facets) {
    stop_if_wanted();
    std::array<VertexId, 3> facet;
    for (std::size_t k = 0; k < 3; ++k) {
      const VertexId v = base.facets[f][k];
      const auto [entry, is_new] = own.try_emplace(v, VertexId(mesh.vertices.size()));
      if (is_new) {
        mesh.vertices.push_back(base.vertices[v]);
        fine.at_m.push_back(grid.to_metres(base.vertices[v]));
        fine.image.push_back(images.make(fine.at_m.back()));
      }
      facet[k] = entry->second;
    }
    mesh.facets.push_back(facet);
    mesh.material.push_back(base.material[f]);
    mesh.component.push_back(base.component[f]);
    fine.mesh.parent.push_back(f);
    if (weights) fine.mesh.weights.push_back(all_of_it);
    for (std::size_t k = 0; k < 3; ++k) {
      const VertexId a = facet[k], b = facet[(k + 1) % 3];
      if (!(fine.image[a].seen() && fine.image[b].seen() &&
            images.surely_whole(fine.at_m[a], fine.at_m[b], fine.image[a], fine.image[b]))) {
        to_cut.push_back(f);
        break;
      }
    }
  }
  return fine;
}

FineFacets refined(const FacetMesh& base, std::span<const FacetId> facets, const WorldGrid& grid,
                   const Images& images, const RefinementLimits& limits) {
  std::vector<FacetId> to_cut;
  FineFacets fine = unrefined(base, facets, grid, images, limits.weights, to_cut);
  if (to_cut.empty()) return fine;
  const GapRule rule(images, base, grid);
  RefinedMesh cut = refine(
      base, to_cut, grid, rule, [](const BasePoint& p) { return p.at_m; }, limits);
  // Both parts in the order of the base facets; the vertices that they share are welded.
  FineFacets all;
  FacetMesh& mesh = all.mesh.mesh;
  WeldTable weld(mesh.vertices);
  weld.reserve(fine.mesh.mesh.vertices.size() + cut.mesh.vertices.size());
  const auto take = [&](const RefinedMesh& from, std::size_t k) {
    std::array<VertexId, 3> facet;
    for (std::size_t c = 0; c < 3; ++c) facet[c] = weld.id_of(from.mesh.vertices[from.mesh.facets[k][c]]);
    mesh.facets.push_back(facet);
    mesh.material.push_back(from.mesh.material[k]);
    mesh.component.push_back(from.mesh.component[k]);
    all.mesh.parent.push_back(from.parent[k]);
    if (limits.weights) all.mesh.weights.push_back(from.weights[k]);
  };
  std::size_t next = 0, next_to_cut = 0;
  for (std::size_t k = 0; k < facets.size(); ++k) {
    if (next_to_cut == to_cut.size() || to_cut[next_to_cut] != facets[k]) {
      take(fine.mesh, k);
      continue;
    }
    for (; next < cut.parent.size() && cut.parent[next] == facets[k]; ++next) take(cut, next);
    ++next_to_cut;
  }
  for (const GridPoint& v : mesh.vertices) {
    all.at_m.push_back(grid.to_metres(v));
    all.image.push_back(rule.of(all.at_m.back()));
  }
  return all;
}

UnclearPlace unclear_place(FacetId facet, const glm::dvec3& at_m, const Image& image,
                           const glm::dvec3& apex_m) {
  const glm::dvec3 towards = (image.seen() ? image.at_m : at_m) - apex_m;
  return {facet, at_m, image.eigenrays, towards / std::max(glm::length(towards), 1e-300)};
}

/// One of a kind for each base facet.
void thin_out(std::vector<UnclearPlace>& unclear) {
  std::ranges::stable_sort(unclear, {},
                           [](const UnclearPlace& p) { return std::pair(p.facet, p.eigenrays > 0); });
  const auto same = [](const UnclearPlace& a, const UnclearPlace& b) {
    return a.facet == b.facet && (a.eigenrays > 0) == (b.eigenrays > 0);
  };
  unclear.erase(std::unique(unclear.begin(), unclear.end(), same), unclear.end());
}

/// Of a facet of that law, but for a factor; null: Lambert's.
double sigma_of(const ScatteringLaw* law, double sine) {
  if (law == nullptr) return lambert_sigma(sine);
  sine = std::min(sine, 1.0);
  return sine > 0 ? law->cross_section(sine, std::sqrt((1 - sine) * (1 + sine))) : 0;
}

glm::dvec3 normal_of(const glm::dvec3 (&c)[3]) { return glm::cross(c[1] - c[0], c[2] - c[0]); }

void check(const StraighteningSettings& settings) {
  if (!(settings.gap_m > 0 && settings.shortest_edge_m > 0 && settings.shadow_edge_m > 0 &&
        settings.tolerance_db > 0))
    throw std::invalid_argument("the lengths and the tolerance of straightening must be above 0");
}

/// What an apex sees of facets that are fine enough. `origin`: by apparent facet, which it is of.
ApparentGround seen_of(FineFacets fine, const Images& images, const WorldGrid& grid,
                       const Straightening& straightening, const StraighteningSettings& settings,
                       std::span<const std::shared_ptr<const ScatteringLaw>> laws,
                       std::vector<FacetId>* origin = nullptr) {
  ApparentGround ground;
  ground.reference_speed_m_s = straightening.reference_speed_m_s();
  FacetMesh& mesh = ground.refined.mesh;
  mesh.vertices.reserve(fine.at_m.size());
  for (std::size_t v = 0; v < fine.at_m.size(); ++v)  // facets of points without image are left out
    mesh.vertices.push_back(grid.snap(fine.image[v].seen() ? fine.image[v].at_m : fine.at_m[v]));
  const FacetMesh& from = fine.mesh.mesh;
  mesh.facets.reserve(from.facets.size());
  for (std::size_t f = 0; f < from.facets.size(); ++f) {
    stop_if_wanted();
    glm::dvec3 corners[3], seen[3];
    CornerReturn returns[3];
    bool kept = true, several = false, regular = true;
    std::optional<UnclearPlace> unclear;
    const auto note = [&](const glm::dvec3& at_m, const Image& image) {
      kept = kept && image.seen();
      several = several || image.eigenrays > 1;
      regular = regular && image.regular();
      if (!unclear && image.eigenrays != 1)
        unclear = unclear_place(fine.mesh.parent[f], at_m, image, straightening.apex_m());
    };
    for (int i = 0; i < 3; ++i) corners[i] = fine.at_m[from.facets[f][i]];
    if (!images.may_see(corners)) continue;  // a part of a large facet
    for (int i = 0; i < 3; ++i) {
      const VertexId v = from.facets[f][i];
      seen[i] = grid.to_metres(mesh.vertices[v]) - straightening.apex_m();
      returns[i] = fine.image[v].returned;
      note(corners[i], fine.image[v]);
    }
    const glm::dvec3 centre = (corners[0] + corners[1] + corners[2]) / 3.0;
    std::optional<Image> middle;
    if (kept && (!regular || !images.is_small(corners, seen))) middle = images.make(centre);
    if (kept && !regular) note(centre, *middle);
    if (unclear) ground.unclear.push_back(*unclear);
    ground.facets_of_several += kept && several;
    if (!kept) {
      ++ground.facets_in_shadow;
      ground.left_out_m.push_back({corners[0], corners[1], corners[2]});
      continue;
    }
    for (int i = 0; i < 3; ++i) {
      const int k = (i + 1) % 3;
      const Image &a = fine.image[from.facets[f][i]], &b = fine.image[from.facets[f][k]];
      double gap = images.gap_m(corners[i], corners[k], a, b);
      if (!(gap <= settings.gap_m) || !regular) {
        const Image between = images.make((corners[i] + corners[k]) / 2.0);
        if (between.seen()) gap = images.gap_m(corners[i], corners[k], a, b, &between);
      }
      if (std::isfinite(gap)) ground.largest_gap_m = std::max(ground.largest_gap_m, gap);
    }
    const glm::dvec3 towards = returns[0].arrival + returns[1].arrival + returns[2].arrival;
    ground.facets_folded +=
        glm::dot(normal_of(corners), towards) * glm::dot(normal_of(seen), seen[0] + seen[1] + seen[2]) < 0;
    const std::uint16_t material = from.material[f];
    mesh.facets.push_back(from.facets[f]);
    mesh.material.push_back(material);
    mesh.component.push_back(from.component[f]);
    ground.refined.parent.push_back(fine.mesh.parent[f]);
    if (!fine.mesh.weights.empty()) ground.refined.weights.push_back(fine.mesh.weights[f]);
    if (origin != nullptr) origin->push_back(FacetId(f));
    const ScatteringLaw* law = laws.empty() ? nullptr : laws[material].get();
    ground.facet_factor.push_back(facet_factor(
        corners, seen, returns, middle && middle->seen() ? &middle->returned : nullptr,
        images.reference_absorption_db_per_m(), [law](double sine) { return sigma_of(law, sine); }));
  }
  ground.truth = std::move(fine.at_m);
  thin_out(ground.unclear);
  return ground;
}

/// Cuts what any of several rules cuts.
struct AnyRule final : EdgeRule {
  bool cuts(const BasePoint& a, const BasePoint& b) const override {
    return std::ranges::any_of(rules, [&](const GapRule& rule) { return rule.cuts(a, b); });
  }
  std::deque<GapRule> rules;
};

FineFacets with_images(const RefinedMesh& cut, const WorldGrid& grid, const GapRule& rule) {
  FineFacets fine{cut, {}, {}};
  for (const GridPoint& v : cut.mesh.vertices) {
    fine.at_m.push_back(grid.to_metres(v));
    fine.image.push_back(rule.of(fine.at_m.back()));
  }
  return fine;
}

}  // namespace

ApparentGround straighten(const FacetMesh& base, std::span<const FacetId> facets, const WorldGrid& grid,
                          const Straightening& straightening, double reference_absorption_db_per_m,
                          const StraighteningSettings& settings, const RefinementLimits& limits,
                          std::span<const std::shared_ptr<const ScatteringLaw>> laws,
                          const Outlook* outlook) {
  check(settings);
  const Images images(straightening, reference_absorption_db_per_m, settings, outlook);
  return seen_of(refined(base, facets, grid, images, limits), images, grid, straightening, settings, laws);
}

ApparentPair straighten_pair(const FacetMesh& base, std::span<const FacetId> facets, const WorldGrid& grid,
                             const Straightening& transmit, const Straightening& receive,
                             double reference_absorption_db_per_m, const StraighteningSettings& settings,
                             const RefinementLimits& limits, const Outlook* transmit_outlook,
                             const Outlook* receive_outlook) {
  AlikeGrounds grounds =
      straighten_alike(base, facets, grid, std::array{&transmit, &receive}, reference_absorption_db_per_m,
                       settings, limits, std::array{transmit_outlook, receive_outlook});
  return {std::move(grounds.bed.mesh), std::move(grounds.seen[0]), std::move(grounds.seen[1]),
          std::move(grounds.origin[0]), std::move(grounds.origin[1])};
}

AlikeGrounds straighten_alike(const FacetMesh& base, std::span<const FacetId> facets, const WorldGrid& grid,
                              std::span<const Straightening* const> ways,
                              double reference_absorption_db_per_m, const StraighteningSettings& settings,
                              const RefinementLimits& limits, std::span<const Outlook* const> outlooks) {
  check(settings);
  std::deque<Images> images;
  AnyRule any;
  for (std::size_t k = 0; k < ways.size(); ++k)
    any.rules.emplace_back(
        images.emplace_back(*ways[k], reference_absorption_db_per_m, settings, outlooks[k]), base, grid);
  AlikeGrounds grounds;
  grounds.bed = refine(
      base, facets, grid, any, [](const BasePoint& p) { return p.at_m; }, limits);
  grounds.seen.resize(ways.size());
  grounds.origin.resize(ways.size());
  tbb::parallel_for(std::size_t{0}, ways.size(), [&](std::size_t k) {
    grounds.seen[k] = seen_of(with_images(grounds.bed, grid, any.rules[k]), images[k], grid, *ways[k],
                              settings, {}, &grounds.origin[k]);
  });
  return grounds;
}

glm::dvec3 ApparentGround::true_place(FacetId facet, glm::dvec3 seen_m, const WorldGrid& grid) const {
  const auto& corner = refined.mesh.facets[facet];
  glm::dvec3 seen[3];
  for (int i = 0; i < 3; ++i) seen[i] = grid.to_metres(refined.mesh.vertices[corner[i]]);
  const glm::dvec3 n = normal_of(seen), along = seen_m - seen[0];
  const double area2 = glm::dot(n, n);
  if (!(area2 > 0)) return truth[corner[0]];
  const double u = glm::dot(n, glm::cross(along, seen[2] - seen[0])) / area2,
               v = glm::dot(n, glm::cross(seen[1] - seen[0], along)) / area2;
  return truth[corner[0]] + u * (truth[corner[1]] - truth[corner[0]]) +
         v * (truth[corner[2]] - truth[corner[0]]);
}

std::vector<FacetMap> ApparentGround::facet_maps(glm::dvec3 apex_m, const WorldGrid& grid) const {
  std::vector<FacetMap> maps;
  maps.reserve(refined.mesh.facets.size());
  for (const auto& corner : refined.mesh.facets) {
    glm::dvec3 seen[3], lies[3];
    for (int i = 0; i < 3; ++i) {
      seen[i] = grid.to_metres(refined.mesh.vertices[corner[i]]) - apex_m;
      lies[i] = truth[corner[i]];
    }
    maps.push_back(facet_map(seen, lies));
  }
  return maps;
}

double ApparentGround::area_ratio(FacetId facet, const WorldGrid& grid) const {
  const auto& corner = refined.mesh.facets[facet];
  glm::dvec3 seen[3], lies[3];
  for (int i = 0; i < 3; ++i) {
    seen[i] = grid.to_metres(refined.mesh.vertices[corner[i]]);
    lies[i] = truth[corner[i]];
  }
  const double apparent = glm::length(normal_of(seen));
  return apparent > 0 ? glm::length(normal_of(lies)) / apparent : 0;
}

}  // namespace tubefoot
