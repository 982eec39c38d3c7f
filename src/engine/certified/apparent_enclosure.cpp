// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/certified/apparent_enclosure.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <numbers>

#include "engine/certified/apparent_scattering.hpp"
#include "engine/certified/flat_facet.hpp"
#include "engine/certified/reference.hpp"
#include "geometry/numbers/scalars.hpp"
#include "geometry/steps/steps.hpp"

// Encloses the error of apparent facets: travel-path error, range error, and the ratio of true to apparent
// return. The travel-path error is at most half the squared radius of the smallest circle around the
// corners, times the second derivative of the image (S. Waldron, SIAM J. Numer. Anal. 35 (1998) 1191). See
// docs/notes/certified-energies.md, section "Through refracting water".
namespace tubefoot {
namespace {

class Encloser {
 public:
  Encloser(const RayEnclosure& rays, double absorption_db_per_m)
      : rays_(rays),
        speed_(rays.reference_speed_m_s()),
        absorption_(absorption_db_per_m),
        beta_(outwards(std::numbers::ln10 / 5, std::numbers::ln10 / 5, 4)) {}

  FacetEnclosure enclose(const FacetCorners& base, const FacetCorners& truth, const FacetCorners& seen,
                         double pad_m, const FacetScattering& surface) const {
    FacetEnclosure facet;
    facet.seen = truth;
    facet.nearest_m = nearest_of(truth) * rays_.least_stretch();
    facet.farthest_m = infinite;
    const FlatFacet flat(base, truth, pad_m);
    if (!flat.valid) return facet;
    const auto [least, most] = box_of(flat);
    const double wider = enclosure_slack * (1 + flat.longest_m);
    const bool alone =
        rays_.none_turns_before(flat.padded(flat.centre_m), flat.u, flat.v, {least.x - wider, most.x + wider},
                                {least.y - wider, most.y + wider});
    // Images of the corners, and their distances from the apparent corners.
    double off_m = 0;
    for (int k = 0; k < 3; ++k) {
      const auto corner = rays_.over(flat.padded(truth[k]), flat.u, flat.v, 0.0, 0.0, alone);
      if (!corner) return facet;
      const Interval off = norm_of(
          {corner->image[0].v - seen[k].x, corner->image[1].v - seen[k].y, corner->image[2].v - seen[k].z});
      off_m = std::max(off_m, off.hi);
    }
    const auto middle = rays_.over(flat.padded(flat.centre_m), flat.u, flat.v, 0.0, 0.0, alone);
    if (!middle) return facet;

    glm::dvec3 normal = glm::cross(seen[1] - seen[0], seen[2] - seen[0]);
    const double size = glm::length(normal);
    if (!(size > 0)) return facet;
    normal /= size;
    const double facing = glm::dot(normal, seen[0]);
    facet.normal = facing < 0 ? -normal : normal;
    facet.plane_m = std::abs(facing);

    // Covers the facet by boxes. The boxes are halved until each box has one proven ray, and further while
    // this improves the bounds.
    Gathered best;
    bool one_ray = false;
    for (int parts = 1; parts <= 8; parts *= 2) {
      Gathered finer;
      if (!gather(flat, facet.normal, alone, surface.model, parts, finer)) continue;
      const auto slopes = [](const Gathered& all) { return all.level_a.largest() + all.level_b.largest(); };
      const bool enough =
          one_ray && finer.bends.across > 0.8 * best.bends.across && slopes(finer) > 0.8 * slopes(best);
      best = std::move(finer);
      one_ray = true;
      if (enough) break;
    }
    if (!one_ray) return facet;
    // Error of linear interpolation between the corners (S. Waldron, SIAM J. Numer. Anal. 35 (1998) 1191).
    // It is at most half the squared radius of the smallest circle around the corners, times the second
    // derivative. In the margin around the corners, it grows by the margin times the error of the slopes.
    const double reach = flat.longest_m + flat.margin_m,
                 beyond = 2 * flat.margin_m * reach * reach / flat.height_m;
    const auto gap = [&](double bend) {
      return ((flat.radius_m * flat.radius_m / 2 + beyond) * bend + 1.1 * off_m) * (1 + enclosure_slack);
    };
    facet.travel_path_error_m = gap(best.bends.all);
    if (!std::isfinite(facet.travel_path_error_m)) return facet;
    const double across_m = gap(best.bends.across);
    facet.seen = seen;
    facet.nearest_m = std::max(nearest_of(seen) - facet.travel_path_error_m, 0.0);
    facet.farthest_m = farthest_of(seen) + facet.travel_path_error_m;
    facet.most_per_sr = surface.most * best.per_sr.hi;
    facet.most = surface.most * best.per_area.hi * flat.area_m2 * (1 + 100 * pad_m / flat.height_m);
    facet.state = FacetEnclosure::State::conservative;

    const double sine = facet.plane_m / facet.farthest_m;
    facet.shift_m = sine > 0 ? across_m / sine * (1 + enclosure_slack) : infinite;
    // A ray that meets the image outside of the facet's own part must meet it within the margin.
    const double drift_m = facet.travel_path_error_m / sine / least_stretch(flat, seen);
    const bool within = drift_m <= flat.margin_m;
    // Corners may lie off the plane, and the map between triangles as thin as this one has rounding errors.
    facet.place_off_m = (drift_m + 4 * pad_m + 1e-14 * flat.longest_m * flat.longest_m / flat.height_m) *
                        (1 + enclosure_slack);
    const Interval towards = middle_sine(flat, *middle);
    if (!within || !(facet.shift_m < facet.nearest_m / 4) || best.sine.may_be_zero() ||
        (towards.lo > 0) != (facing > 0))
      return facet;
    const Interval db = middle->absorption_db.v - absorption_ * speed_ * middle->time_s.v;
    Interval level =
        log(towards.lo > 0 ? towards : -towards) + 3.0 * log(speed_ * middle->slowness_s_per_m.v) -
        log(middle->area_ratio_per_sr.v) - beta_ * db -
        log(outwards(facet.plane_m * (1 - enclosure_slack), facet.plane_m * (1 + enclosure_slack)));
    // Change that slopes cause between the middle and the corners, and in the margin around the corners.
    const auto change = [&](const Interval& a, const Interval& b) {
      Interval all = 0.0;
      for (int k = 0; k < 3; ++k) {
        const Interval own = a * flat.at[k].x + b * flat.at[k].y;
        all = k == 0 ? own : hull(all, own);
      }
      return all;
    };
    const auto beside = [&](const Interval& a, const Interval& b) {
      const double wide = flat.margin_m * (a.largest() + b.largest());
      return Interval(-wide, wide);
    };
    level = level + change(best.level_a, best.level_b) + beside(best.level_a, best.level_b);
    if (surface.model != nullptr) {
      const GrazingPatch at = grazing(flat, facet.normal, *middle, places(flat, 0.0, 0.0));
      const Interval ratio = log((towards.lo > 0 ? towards : -towards) * speed_ * middle->slowness_s_per_m.v /
                                 height_of(facet.normal, *middle).v);
      const auto scattering = apparent_scattering(
          *surface.model, at, ratio, best.grazing,
          [&](const Interval& a, const Interval& b) { return change(a, b) + beside(a, b); });
      if (!scattering) return facet;
      facet.model = scattering->model;
      level = level + scattering->log_remainder;
    }
    const double range = 3 * std::log1p(facet.shift_m / (facet.nearest_m - facet.shift_m)) +
                         beta_.hi * absorption_ * facet.shift_m;
    facet.factor = exp(level + Interval(-range, range));
    if (facet.factor.is_finite()) facet.state = FacetEnclosure::State::proven;
    return facet;
  }

 private:
  struct Gathered {
    Bends bends;
    Interval level_a, level_b, per_sr, per_area, sine;
    std::vector<GrazingPatch> grazing;  // with a scattering model
  };

  /// Points of the facet's plane at offsets a and b from its middle.
  static std::array<Jet, 2> places(const FlatFacet& flat, const Interval& a, const Interval& b) {
    std::array<Jet, 2> at;
    for (int k = 0; k < 2; ++k) {
      at[k].v = flat.padded(flat.centre_m)[k] + a * flat.u[k] + b * flat.v[k];
      at[k].a = flat.u[k];
      at[k].b = flat.v[k];
    }
    return at;
  }
  static Interval middle_sine(const FlatFacet& flat, const RayJets& rays) {
    const std::array<Interval, 3> centre = flat.padded(flat.centre_m);
    return sine_of(flat, rays, {centre[0], centre[1]}).v;
  }
  /// Height of the apex above the plane through a ray's image, parallel to the apparent facet.
  static Jet height_of(const glm::dvec3& normal, const RayJets& rays) {
    Jet height;
    for (int i = 0; i < 3; ++i) height = height + Jet(normal[i]) * rays.image[i];
    return height;
  }
  GrazingPatch grazing(const FlatFacet& flat, const glm::dvec3& normal, const RayJets& rays,
                       const std::array<Jet, 2>& at) const {
    const Jet lies = sine_of(flat, rays, at), height = height_of(normal, rays),
              seen = height / (Jet(speed_) * rays.time_s);
    const auto ratio = [&](const Interval& of_lies, const Interval& of_slowness, const Interval& of_height) {
      return of_lies / lies.v + of_slowness / rays.slowness_s_per_m.v - of_height / height.v;
    };
    return {seen.v, seen.a, seen.b, ratio(lies.a, rays.slowness_s_per_m.a, height.a),
            ratio(lies.b, rays.slowness_s_per_m.b, height.b)};
  }
  /// Sine of the grazing angle on the true facet times the distance. In isovelocity water it is the distance
  /// of the facet's plane.
  static Jet sine_of(const FlatFacet& flat, const RayJets& rays, const std::array<Jet, 2>& at) {
    const glm::dvec3& n = flat.normal;
    return rays.arrival_across * (Jet(n.x) * at[0] + Jet(n.y) * at[1]) - Jet(n.z) * rays.arrival_down_m;
  }

  bool gather(const FlatFacet& flat, const glm::dvec3& normal, bool alone, const ScatteringModel* model,
              int parts, Gathered& all) const {
    bool first = true;
    for (const auto& [a, b] : boxes_of(flat, parts)) {
      const auto rays = rays_.over(flat.padded(flat.centre_m), flat.u, flat.v, a, b, alone);
      if (!rays) return false;
      const std::array<Jet, 2> at = places(flat, a, b);
      const Jet sine = sine_of(flat, *rays, at);
      const Jet beyond = rays->absorption_db - Jet(absorption_ * speed_) * rays->time_s;
      const Interval lost = exp(-(beta_ * rays->absorption_db.v)), ratio = rays->area_ratio_per_sr.v;
      const Interval distance = rays->time_s.v / rays->slowness_s_per_m.v, area = ratio * squared(distance);
      const Interval size(0, (sine.v / distance).largest());
      Gathered own;
      own.bends = bends_of(*rays, normal);
      own.sine = sine.v;
      Interval scattered = squared(size), by_sine = size;
      if (model != nullptr) {
        const Interval along = sine.v / distance;
        const double flattest = along.may_be_zero() ? 0 : std::min(std::abs(along.lo), std::abs(along.hi));
        own.grazing.push_back(grazing(flat, normal, *rays, at));
        scattered = Interval(0, largest_cross_section(*model, {flattest, size.hi}));
        by_sine = Interval(0, scattered.hi / flattest);
      }
      own.per_sr = by_sine * lost / area;
      // The areas per steradian in the two directions differ by the ratio of the squared sound speeds.
      own.per_area = scattered * lost / squared(area * rays_.least_area_ratio());
      const auto slope = [&](const Interval& of_sine, const Interval& of_time, const Interval& of_area,
                             const Interval& of_db) {
        return of_sine / sine.v + 3.0 * (of_time / rays->slowness_s_per_m.v) - of_area / ratio -
               beta_ * of_db;
      };
      own.level_a = slope(sine.a, rays->slowness_s_per_m.a, rays->area_ratio_per_sr.a, beyond.a);
      own.level_b = slope(sine.b, rays->slowness_s_per_m.b, rays->area_ratio_per_sr.b, beyond.b);
      if (first) {
        all = own;
        first = false;
        continue;
      }
      all.grazing.insert(all.grazing.end(), own.grazing.begin(), own.grazing.end());
      all.bends.all = std::max(all.bends.all, own.bends.all);
      all.bends.across = std::max(all.bends.across, own.bends.across);
      for (Interval Gathered::*part :
           {&Gathered::level_a, &Gathered::level_b, &Gathered::per_sr, &Gathered::per_area, &Gathered::sine})
        all.*part = hull(all.*part, own.*part);
    }
    return !first;
  }

  /// Smallest stretch of the affine map from the facet to its apparent facet.
  static double least_stretch(const FlatFacet& flat, const FacetCorners& seen) {
    const auto [along_u, along_v] = flat.slopes_to(seen);
    const double a = glm::dot(along_u, along_u), b = glm::dot(along_u, along_v),
                 c = glm::dot(along_v, along_v);
    const double least = (a + c) / 2 - std::sqrt((a - c) * (a - c) / 4 + b * b);
    return 0.9 * std::sqrt(std::max(least, 0.0));  // the slopes of the image itself differ a little
  }

  const RayEnclosure& rays_;
  double speed_, absorption_;
  Interval beta_;
};

}  // namespace

ApparentEnclosures enclose(const MappedSeabed& seabed, const RayEnclosure& rays, const EchoModel& model) {
  const FacetMesh& mesh = seabed.mesh();
  const Encloser encloser(rays, model.absorption_db_per_m);
  const glm::dvec3 apex = rays.apex_m();
  const std::vector<FacetScattering> surfaces = facet_scattering(model);
  ApparentEnclosures all;
  all.facets.resize(mesh.facets.size());
  Steps steps("facets", mesh.facets.size());
  tbb::parallel_for(std::size_t{0}, mesh.facets.size(), [&](std::size_t f) {
    steps.done();
    FacetCorners base, truth, seen;
    const auto& whole = seabed.base.facets[seabed.parent[f]];
    for (std::size_t k = 0; k < 3; ++k) {
      base[k] = seabed.grid.to_metres(seabed.base.vertices[whole[k]]) - apex;
      truth[k] = seabed.surface_mesh.truth[mesh.facets[f][k]] - apex;
      seen[k] = seabed.grid.to_metres(mesh.vertices[mesh.facets[f][k]]) - apex;
    }
    all.facets[f] = encloser.enclose(base, truth, seen, 2 * seabed.grid.unit_m(), surfaces[mesh.material[f]]);
  });
  for (const FacetEnclosure& facet : all.facets)
    if (facet.state == FacetEnclosure::State::unproven) all.unproven.push_back(facet);
  for (const auto& corners : seabed.surface_mesh.left_out_m) {
    FacetEnclosure facet;
    for (std::size_t k = 0; k < 3; ++k) facet.seen[k] = corners[k] - apex;
    facet.nearest_m = nearest_of(facet.seen) * rays.least_stretch();
    all.unproven.push_back(facet);
  }
  return all;
}

}  // namespace tubefoot
