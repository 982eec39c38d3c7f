// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <algorithm>
#include <boost/math/distributions/binomial.hpp>
#include <boost/math/distributions/chi_squared.hpp>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <map>
#include <numbers>
#include <optional>
#include <string>

#include "engine/rays/embree.hpp"
#include "fixtures/geometry/small_views.hpp"
#include "geometry/footprints/footprint_builder.hpp"
#include "geometry/integrals/measure.hpp"

// Compares the measures of footprints with Embree's rays. Solid angles are compared with directions drawn
// uniformly from the tube, and areas with points drawn uniformly from the facets. The test has its own
// sampling and its own Embree scenes, with coordinates relative to the apex, in grid units, as floats.
// Bounds are those of the binomial and chi-square distributions at five sigma for all comparisons together.
namespace tubefoot {
namespace {

using namespace test;

constexpr double five_sigma = 5.7e-7;  // both tails of the normal distribution
/// More comparisons than the test makes. Each comparison gets its share of the error probability
/// (Bonferroni).
constexpr double most_comparisons = 1e6;
/// A float displaces an edge and a ray by about 1e-7 rad. The uncertainty of a share is about that, times
/// the length of its border over the solid angle of the tube. The test takes this value.
constexpr double float_leak = 2e-6;

glm::dvec3 vector_of(GridPoint p) { return {p.x, p.y, p.z}; }

/// Embree's scene of a mesh from an apex. It omits facets whose plane contains the apex, because they
/// subtend nothing.
class Rays {
 public:
  Rays(const FacetMesh& mesh, GridPoint apex) : device_(rtcNewDevice(nullptr)), scene_(rtcNewScene(device_)) {
    rtcSetSceneFlags(scene_, RTC_SCENE_FLAG_ROBUST);
    FacetCone cone;
    for (FacetId f = 0; f < mesh.facets.size(); ++f)
      if (FacetCone::make(mesh, f, apex, cone)) facets_.push_back(f);
    const RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* vertex = static_cast<float*>(rtcSetNewGeometryBuffer(
        geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), mesh.vertices.size()));
    for (const GridPoint& p : mesh.vertices) {
      const GridPoint from_apex = p - apex;
      for (const std::int32_t x : {from_apex.x, from_apex.y, from_apex.z}) *vertex++ = static_cast<float>(x);
    }
    auto* index = static_cast<unsigned*>(rtcSetNewGeometryBuffer(
        geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(unsigned), facets_.size()));
    for (const FacetId f : facets_)
      for (const VertexId v : mesh.facets[f]) *index++ = v;
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene_, geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(scene_);
    if (const RTCError error = rtcGetDeviceError(device_); error != RTC_ERROR_NONE)
      throw std::runtime_error("Embree: error " + std::to_string(error));
  }
  ~Rays() {
    rtcReleaseScene(scene_);
    rtcReleaseDevice(device_);
  }
  Rays(const Rays&) = delete;
  Rays& operator=(const Rays&) = delete;

  std::optional<FacetId> first(glm::dvec3 direction) const {
    RTCRayHit ray{};
    ray.ray.dir_x = static_cast<float>(direction.x);
    ray.ray.dir_y = static_cast<float>(direction.y);
    ray.ray.dir_z = static_cast<float>(direction.z);
    ray.ray.tfar = std::numeric_limits<float>::infinity();
    ray.ray.mask = ~0u;
    ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    first_hit(scene_, ray);
    if (ray.hit.geomID == RTC_INVALID_GEOMETRY_ID) return {};
    return facets_[ray.hit.primID];
  }

 private:
  RTCDevice device_;
  RTCScene scene_;
  std::vector<FacetId> facets_;
};

/// The directions inside the integer walls of a tube.
class Directions {
 public:
  Directions(const TubeSet& tubes, std::uint32_t tube) {
    std::array<glm::dvec3, 4> ray;
    for (int k = 0; k < 4; ++k) ray[k] = glm::normalize(vector_of(tubes.rays[tubes.tubes[tube][k]]));
    for (int k = 0; k < 4; ++k) {
      const Vec64 wall = cross(tubes.rays[tubes.tubes[tube][k]], tubes.rays[tubes.tubes[tube][(k + 1) % 4]]);
      wall_[k] = {static_cast<double>(wall.x), static_cast<double>(wall.y), static_cast<double>(wall.z)};
    }
    axis_ = glm::normalize(ray[0] + ray[1] + ray[2] + ray[3]);
    lowest_ = 1;
    for (const glm::dvec3& r : ray) lowest_ = std::min(lowest_, glm::dot(axis_, r));
    if (lowest_ <= 0) throw std::domain_error("a tube that no cap smaller than a half-space holds");
    side_ = glm::normalize(
        glm::cross(axis_, std::abs(axis_.z) < 0.7 ? glm::dvec3(0, 0, 1) : glm::dvec3(1, 0, 0)));
    // Girard: the sum of the angles between adjacent walls, minus two right angles.
    solid_angle_ = -2 * std::numbers::pi;
    for (int k = 0; k < 4; ++k) {
      const glm::dvec3 a = glm::normalize(wall_[k]), b = glm::normalize(wall_[(k + 1) % 4]);
      solid_angle_ += std::numbers::pi - std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b));
    }
  }

  bool contain(glm::dvec3 d) const {
    return std::all_of(wall_.begin(), wall_.end(), [&](glm::dvec3 w) { return glm::dot(w, d) > 0; });
  }
  double solid_angle() const { return solid_angle_; }

  /// Draws uniformly in solid angle: from the cap about the axis that contains the tube (Archimedes), it
  /// takes the directions in the tube.
  glm::dvec3 draw(Random& random) const {
    std::uniform_real_distribution<double> height(lowest_, 1), turn(0, 2 * std::numbers::pi);
    for (;;) {
      const double h = height(random), t = turn(random), r = std::sqrt(1 - h * h);
      const glm::dvec3 d = h * axis_ + r * (std::cos(t) * side_ + std::sin(t) * glm::cross(axis_, side_));
      if (contain(d)) return d;
    }
  }

 private:
  std::array<glm::dvec3, 4> wall_;
  glm::dvec3 axis_, side_;
  double lowest_ = 1, solid_angle_ = 0;
};

/// Returns the first facet in the same plane, for each facet. For coplanar facets that overlap, Embree
/// reports any of them.
std::vector<FacetId> plane_leaders(const FacetMesh& mesh, GridPoint apex) {
  std::vector<FacetId> leader(mesh.facets.size());
  std::vector<FacetCone> cones(mesh.facets.size());
  for (FacetId f = 0; f < mesh.facets.size(); ++f) {
    leader[f] = f;
    if (!FacetCone::make(mesh, f, apex, cones[f])) continue;
    for (FacetId g = 0; g < f && leader[f] == f; ++g)
      if (leader[g] == g && cones[g].offset > 0 &&
          std::all_of(cones[f].point.begin(), cones[f].point.end(),
                      [&](GridPoint p) { return dot(cones[g].normal, p) == cones[g].offset; }))
        leader[f] = g;
  }
  return leader;
}

/// Returns the footprints of one tube with measures in grid units instead of metres.
std::vector<Footprint> footprints_of(const Scene& scene, const SceneTree& tree, std::uint32_t tube) {
  VisibilityScratch scratch;
  TubeVisibility seen;
  see(scene.mesh, tree, scene.tubes, tube, {}, scratch, seen);
  FootprintSet set;
  append_footprints(scene.mesh, scene.tubes, tube, seen, 1, set);
  measure(set);
  return set.footprints;
}

/// Returns whether so many hits in so many rays are likely for that share, at five sigma over all
/// comparisons.
bool plausible(std::int64_t hits, std::int64_t rays, double share) {
  using boost::math::cdf;
  using boost::math::complement;
  const double least = five_sigma / most_comparisons / 2;
  const auto binomial = [&](double p) {
    return boost::math::binomial_distribution<double>(static_cast<double>(rays), std::clamp(p, 0.0, 1.0));
  };
  if (cdf(binomial(share - float_leak), static_cast<double>(hits)) < least) return false;
  return hits == 0 || cdf(complement(binomial(share + float_leak), static_cast<double>(hits - 1))) > least;
}

/// Chi-square of hits against shares. Facets with few rays are combined.
struct ChiSquare {
  double sum = 0, freedom = 0;

  void add(const std::map<FacetId, std::pair<double, std::int64_t>>& share_and_hits, std::int64_t rays) {
    double rest_expected = static_cast<double>(rays), rest_hits = static_cast<double>(rays);
    double few_expected = 0, few_hits = 0;
    const auto cell = [&](double expected, double hits) {
      sum += (hits - expected) * (hits - expected) / expected;
      freedom += 1;
      rest_expected -= expected;
      rest_hits -= hits;
    };
    for (const auto& [facet, both] : share_and_hits) {
      const double expected = both.first * static_cast<double>(rays), hits = static_cast<double>(both.second);
      if (expected >= 20) {
        cell(expected, hits);
      } else {
        few_expected += expected;
        few_hits += hits;
      }
    }
    if (few_expected >= 20) cell(few_expected, few_hits);
    if (rest_expected >= 20)  // the unobstructed region, or the combined few
      sum += (rest_hits - rest_expected) * (rest_hits - rest_expected) / rest_expected;
    else
      freedom -= freedom > 0;  // without a rest, one of the cells follows from the others
  }
  double upper_tail() const {
    return boost::math::cdf(
        boost::math::complement(boost::math::chi_squared_distribution<double>(freedom), sum));
  }
};

std::vector<Scene> scenes_for_embree(std::uint64_t seed) {
  std::vector<Scene> scenes = all_scenes(seed);
  for (Scene& view : small_views(seed, 400)) scenes.push_back(std::move(view));
  return scenes;
}

TEST(EmbreeOracle, SolidAnglesAreSharesOfRays) {
  constexpr std::int64_t rays = 20000;
  std::size_t compared = 0;
  ChiSquare all;
  for (std::uint64_t seed = 1; seed < 1 + (3 + one_in - 1) / one_in; ++seed)
    for (const Scene& scene : scenes_for_embree(seed)) {
      SCOPED_TRACE(testing::Message() << "seed " << seed << ", " << scene.name);
      Random random(seed);
      const SceneTree tree(scene.mesh);
      const Rays embree(scene.mesh, scene.tubes.apex);
      const auto leader = plane_leaders(scene.mesh, scene.tubes.apex);
      for (std::uint32_t t = 0; t < scene.tubes.tubes.size(); ++t) {
        SCOPED_TRACE(testing::Message() << "tube " << t);
        const Directions tube(scene.tubes, t);
        std::map<FacetId, std::pair<double, std::int64_t>> share_and_hits;
        for (const Footprint& footprint : footprints_of(scene, tree, t))
          share_and_hits[leader[footprint.facet]].first += footprint.solid_angle_sr / tube.solid_angle();
        for (std::int64_t ray = 0; ray < rays; ++ray)
          if (const auto hit = embree.first(tube.draw(random))) ++share_and_hits[leader[*hit]].second;
        double total = 0;
        for (const auto& [facet, both] : share_and_hits) {
          EXPECT_TRUE(plausible(both.second, rays, both.first))
              << "facet " << facet << ": share " << both.first << ", " << both.second << " of " << rays
              << " rays";
          total += both.first;
          ++compared;
        }
        EXPECT_LT(total, 1 + 1e-9);
        ChiSquare here;
        here.add(share_and_hits, rays);
        if (here.freedom > 0) {
          EXPECT_GT(here.upper_tail(), five_sigma / most_comparisons) << here.sum << " for " << here.freedom;
        }
        all.add(share_and_hits, rays);
        if (testing::Test::HasFailure()) return;
      }
    }
  RecordProperty("compared", static_cast<int>(compared));
  EXPECT_GT(compared, 4000 / one_in);
  EXPECT_LT(compared, most_comparisons);
  // The fit is also not too good, which would indicate a sampling that is not independent.
  EXPECT_GT(all.upper_tail(), five_sigma) << all.sum << " for " << all.freedom;
  EXPECT_LT(all.upper_tail(), 1 - five_sigma) << all.sum << " for " << all.freedom;
}

TEST(EmbreeOracle, AreasAreSharesOfPointsOnTheFacets) {
  constexpr std::int64_t points = 1000;
  std::size_t compared = 0, partly_seen = 0;
  double excess = 0, variance = 0, uncertain = 0;
  for (std::uint64_t seed = 11; seed < 11 + (3 + one_in - 1) / one_in; ++seed)
    for (const Scene& scene : scenes_for_embree(seed)) {
      SCOPED_TRACE(testing::Message() << "seed " << seed << ", " << scene.name);
      Random random(seed);
      const SceneTree tree(scene.mesh);
      const Rays embree(scene.mesh, scene.tubes.apex);
      const auto leader = plane_leaders(scene.mesh, scene.tubes.apex);
      std::map<FacetId, int> in_plane;
      for (const FacetId l : leader) ++in_plane[l];
      for (std::uint32_t t = 0; t < scene.tubes.tubes.size(); ++t) {
        SCOPED_TRACE(testing::Message() << "tube " << t);
        const Directions tube(scene.tubes, t);
        std::map<FacetId, double> seen_area;
        for (const Footprint& footprint : footprints_of(scene, tree, t))
          seen_area[footprint.facet] = footprint.area_m2;
        for (FacetId f = 0; f < scene.mesh.facets.size(); ++f) {
          FacetCone cone;
          if (in_plane[leader[f]] > 1 || !FacetCone::make(scene.mesh, f, scene.tubes.apex, cone)) continue;
          const glm::dvec3 a = vector_of(cone.point[0]), b = vector_of(cone.point[1]) - a,
                           c = vector_of(cone.point[2]) - a;
          std::int64_t hits = 0;
          std::uniform_real_distribution<double> unit(0, 1);
          for (std::int64_t k = 0; k < points; ++k) {
            double u = unit(random), v = unit(random);
            if (u + v > 1) {
              u = 1 - u;
              v = 1 - v;
            }
            const glm::dvec3 p = a + u * b + v * c;
            hits += tube.contain(p) && embree.first(glm::normalize(p)) == f;
          }
          const double share = seen_area[f] / (glm::length(glm::cross(b, c)) / 2);
          EXPECT_TRUE(plausible(hits, points, share))
              << "facet " << f << ": share " << share << ", " << hits << " of " << points << " points";
          ++compared;
          partly_seen += share > 0.01 && share < 0.99;
          excess += static_cast<double>(hits) - points * share;
          variance += points * std::max(share * (1 - share), 0.0);
          uncertain += points * float_leak;
        }
        if (testing::Test::HasFailure()) return;
      }
    }
  RecordProperty("compared", static_cast<int>(compared));
  EXPECT_LT(compared, most_comparisons);
  EXPECT_GT(partly_seen, 3000 / one_in);
  EXPECT_LT(std::abs(excess), 5 * std::sqrt(variance) + uncertain) << "all facets together";
}

}  // namespace
}  // namespace tubefoot
