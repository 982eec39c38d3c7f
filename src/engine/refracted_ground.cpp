// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/refracted_ground.hpp"

#include <tbb/concurrent_hash_map.h>
#include <tbb/concurrent_unordered_map.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <glm/geometric.hpp>
#include <optional>
#include <stdexcept>
#include <tuple>

namespace tubefoot {
namespace {

struct PlaceHash {
  std::size_t operator()(const glm::dvec3& p) const {
    std::uint64_t h = 0;
    for (int i = 0; i < 3; ++i)
      h = (std::rotl(h, 21) ^ std::bit_cast<std::uint64_t>(p[i] + 0.0)) * 0x9e3779b97f4a7c15u;
    return h ^ (h >> 32);
  }
};

/// Images of true points, each found once.
class Images {
 public:
  explicit Images(const Straightening& straightening) : straightening_(straightening) {}
  const std::optional<ApparentPoint>& of(const glm::dvec3& point_m) {
    const auto known = images_.find(point_m);
    if (known != images_.end()) return known->second;
    return images_.emplace(point_m, straightening_.apparent(point_m)).first->second;
  }

 private:
  const Straightening& straightening_;
  tbb::concurrent_unordered_map<glm::dvec3, std::optional<ApparentPoint>, PlaceHash> images_;
};

class GapRule final : public EdgeRule {
 public:
  GapRule(Images& images, const StraighteningSettings& settings) : images_(images), settings_(settings) {}

  bool cuts(const BasePoint& a, const BasePoint& b) const override {
    const double length = glm::length(b.at_m - a.at_m);
    if (!(length > settings_.shortest_edge_m)) return false;
    const auto &from = images_.of(a.at_m), &to = images_.of(b.at_m),
               &middle = images_.of((a.at_m + b.at_m) / 2.0);
    // Shadows are cut evenly, in and beside them: a border narrowed down between long edges would not end.
    if (!from || !to || !middle) return length > settings_.shadow_edge_m;
    return edge_gap_m(from->at_m, to->at_m, middle->at_m) > settings_.gap_m;
  }

 private:
  Images& images_;
  StraighteningSettings settings_;
};

UnclearPlace unclear_place(FacetId facet, const glm::dvec3& at_m, const std::optional<ApparentPoint>& image,
                           const glm::dvec3& apex_m) {
  const glm::dvec3 towards = (image ? image->at_m : at_m) - apex_m;
  return {facet, at_m, image ? image->eigenrays : 0, towards / std::max(glm::length(towards), 1e-300)};
}

}  // namespace

ApparentGround straighten(const FacetMesh& base, std::span<const FacetId> facets, const WorldGrid& grid,
                          const Straightening& straightening, double reference_absorption_db_per_m,
                          const StraighteningSettings& settings, const RefinementLimits& limits) {
  if (!(settings.gap_m > 0 && settings.shortest_edge_m > 0 && settings.shadow_edge_m > 0))
    throw std::invalid_argument("the lengths of straightening must be above 0");
  Images images(straightening);
  // Where a vertex truly lies; of points with one image the first in order, whichever thread comes first.
  struct Compare {
    std::size_t hash(const GridPoint& p) const { return GridPointHash()(p); }
    bool equal(const GridPoint& a, const GridPoint& b) const { return a == b; }
  };
  using Truth = tbb::concurrent_hash_map<GridPoint, glm::dvec3, Compare>;
  const auto order = [](const glm::dvec3& p) { return std::tuple(p.x, p.y, p.z); };
  Truth truth;
  const auto image_or_self = [&](const glm::dvec3& at_m) {
    const auto& image = images.of(at_m);
    return image ? image->at_m : at_m;  // facets of points without image are left out below
  };
  RefinedMesh refined = refine(
      base, facets, grid, GapRule(images, settings),
      [&](const BasePoint& point) {
        const glm::dvec3 image = image_or_self(point.at_m);
        Truth::accessor entry;
        if (truth.insert(entry, {grid.snap(image), point.at_m})) return image;
        if (order(point.at_m) < order(entry->second)) entry->second = point.at_m;
        return image;
      },
      limits);

  struct Verdict {
    double factor = 0, gap_m = 0;
    bool kept = false;
    std::optional<UnclearPlace> unclear;
  };
  const FacetMesh& mesh = refined.mesh;
  std::vector<Verdict> verdicts(mesh.facets.size());
  tbb::parallel_for(std::size_t{0}, verdicts.size(), [&](std::size_t f) {
    Verdict& verdict = verdicts[f];
    glm::dvec3 corners[3], seen[3];
    const auto note = [&](const glm::dvec3& at_m) {
      const auto& image = images.of(at_m);
      if (!verdict.unclear && (!image || image->eigenrays > 1))
        verdict.unclear = unclear_place(refined.parent[f], at_m, image, straightening.apex_m());
      return image.has_value();
    };
    verdict.kept = true;
    for (int i = 0; i < 3; ++i) {
      const GridPoint vertex = mesh.vertices[mesh.facets[f][i]];
      Truth::const_accessor entry;
      truth.find(entry, vertex);
      corners[i] = entry->second;
      seen[i] = grid.to_metres(vertex);
      verdict.kept = note(corners[i]) && verdict.kept;
    }
    verdict.kept = note((corners[0] + corners[1] + corners[2]) / 3.0) && verdict.kept;
    if (!verdict.kept) return;
    verdict.factor = *facet_factor(straightening, corners, seen, reference_absorption_db_per_m);
    for (int i = 0; i < 3; ++i) {
      const glm::dvec3 &a = corners[i], &b = corners[(i + 1) % 3];
      const auto& middle = images.of((a + b) / 2.0);
      if (middle)
        verdict.gap_m =
            std::max(verdict.gap_m, edge_gap_m(images.of(a)->at_m, images.of(b)->at_m, middle->at_m));
    }
  });

  ApparentGround ground;
  ground.reference_speed_m_s = straightening.reference_speed_m_s();
  ground.refined.mesh.vertices = mesh.vertices;
  for (std::size_t f = 0; f < verdicts.size(); ++f) {
    const Verdict& verdict = verdicts[f];
    if (verdict.unclear) ground.unclear.push_back(*verdict.unclear);
    if (!verdict.kept) {
      ++ground.facets_in_shadow;
      continue;
    }
    ground.largest_gap_m = std::max(ground.largest_gap_m, verdict.gap_m);
    ground.refined.mesh.facets.push_back(mesh.facets[f]);
    ground.refined.mesh.material.push_back(mesh.material[f]);
    ground.refined.mesh.component.push_back(mesh.component[f]);
    ground.refined.parent.push_back(refined.parent[f]);
    ground.facet_factor.push_back(verdict.factor);
  }
  std::ranges::stable_sort(ground.unclear, {},
                           [](const UnclearPlace& p) { return std::pair(p.facet, p.eigenrays > 0); });
  const auto same = [](const UnclearPlace& a, const UnclearPlace& b) {
    return a.facet == b.facet && (a.eigenrays > 0) == (b.eigenrays > 0);
  };
  const auto rest = std::ranges::unique(ground.unclear, same);
  ground.unclear.erase(rest.begin(), rest.end());
  return ground;
}

}  // namespace tubefoot
