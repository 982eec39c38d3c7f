// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/certified/bistatic_enclosure.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <numbers>

#include "engine/certified/apparent_scattering.hpp"
#include "engine/certified/facet_ends.hpp"
#include "engine/certified/reference.hpp"
#include "geometry/numbers/scalars.hpp"
#include "geometry/steps/steps.hpp"

// Encloses flattened facets for two ends. Second derivatives of the difference between squared true range
// and squared flattened range bound the half-path error between the corners (S. Waldron, SIAM J. Numer.
// Anal. 35 (1998) 1191). See docs/notes/certified-energies.md, section "Of two ends".
namespace tubefoot {
namespace {

constexpr int most_parts = 16;  // of ReceiveRanges
using State = FacetEnclosure::State;

Interval both_ways(double size) { return {-size, size}; }
Interval common(const Interval& a, const Interval& b) {
  const Interval both(std::max(a.lo, b.lo), std::min(a.hi, b.hi));
  return both.lo <= both.hi ? both : hull(a, b);
}
Jet common(const Jet& x, const Jet& y) {
  Jet both;
  for (Interval Jet::*part : {&Jet::v, &Jet::a, &Jet::b, &Jet::aa, &Jet::ab, &Jet::bb})
    both.*part = common(x.*part, y.*part);
  return both;
}
/// Bound of the second derivatives in any direction.
double bend_of(const Jet& x) {
  return std::sqrt((squared(x.aa) + 2.0 * squared(x.ab) + squared(x.bb)).hi) * (1 + enclosure_slack);
}

class BistaticEncloser {
 public:
  BistaticEncloser(const BistaticSurface& seabed, const EchoModel& model)
      : seabed_(seabed),
        model_(model),
        beta_(outwards(std::numbers::ln10 / 10, std::numbers::ln10 / 10, 4)),
        surfaces_(facet_scattering(model)) {}

  struct Found {
    std::array<FacetEnclosure, 2> end;
    BistaticEnclosure pair;
  };
  /// `sees` states which ends see the facet: transmitter, receiver, other receiver.
  Found enclose(FacetId f, const std::array<bool, 3>& sees, const BistaticFacet* bistatic) const {
    Found found;
    const std::array<VertexId, 3>& vertices = seabed_.mesh.facets[f];
    FacetCorners lies, base;
    const auto& whole = seabed_.base.facets[seabed_.parent[f]];
    bool refined = false;
    for (std::size_t k = 0; k < 3; ++k) {
      lies[k] = seabed_.grid.to_metres(seabed_.mesh.vertices[vertices[k]]);
      base[k] = seabed_.grid.to_metres(seabed_.base.vertices[whole[k]]);
    }
    for (const glm::dvec3& corner : lies) refined = refined || std::ranges::find(base, corner) == base.end();
    // Refined corners are rounded to the grid and may lie off their base facet.
    const double pad_m = refined ? 2 * seabed_.grid.unit_m() : 0;
    std::array<FacetCorners, 2> seen;
    for (int e = 0; e < 2; ++e) {
      const BistaticEnd& end = seabed_.end(e);
      FacetEnclosure& facet = found.end[std::size_t(e)];
      for (std::size_t k = 0; k < 3; ++k) {
        seen[std::size_t(e)][k] =
            seabed_.grid.to_metres(end.surface_mesh.refined.mesh.vertices[vertices[k]]) - end.water.apex_m();
        facet.seen[k] = unproven_place(end, lies[k]);
      }
      facet.nearest_m = nearest_of(facet.seen) * end.rays.least_stretch();
      facet.farthest_m = infinite;
    }
    const FlatFacet flat(base, lies, pad_m);
    if (!flat.valid) return found;
    std::array<std::optional<EndOfFacet>, 2> ends;
    for (std::size_t e = 0; e < 2; ++e)
      if (sees[e]) {
        ends[e].emplace(seabed_.end(int(e)), flat, lies, pad_m, seen[e]);
        if (!ends[e]->valid()) ends[e].reset();
      }
    if (!ends[0] && !ends[1]) return found;
    Beside beside{.sees = sees[2], .end = {}};
    if (sees[2]) {
      FacetCorners seen_there;
      for (std::size_t k = 0; k < 3; ++k)
        seen_there[k] =
            seabed_.grid.to_metres(seabed_.beside->surface_mesh.refined.mesh.vertices[vertices[k]]) -
            seabed_.beside->water.apex_m();
      beside.end.emplace(*seabed_.beside, flat, lies, pad_m, seen_there);
      if (!beside.end->valid()) beside.end.reset();
    }
    const FacetScattering& surface = surfaces_[seabed_.mesh.material[f]];

    // Covers the facet by boxes. The boxes are halved until each end has one proven ray per box, and further
    // while this improves the bounds.
    Gathered best;
    for (int parts = 1; parts <= 8; parts *= 2) {
      Gathered finer = gather(flat, ends, beside, surface.model, parts);
      const auto ends_with_one_ray = [](const Gathered& all) { return all.whole[0] + all.whole[1]; };
      if (ends_with_one_ray(finer) < ends_with_one_ray(best)) continue;
      const bool as_many = parts > 1 && finer.whole == best.whole,
                 all_ends = finer.whole[0] == ends[0].has_value() && finer.whole[1] == ends[1].has_value(),
                 enough = as_many && all_ends && finer.measure() >= 0.8 * best.measure();
      best = std::move(finer);
      if (enough) break;
    }
    for (std::size_t e = 0; e < 2; ++e)
      if (ends[e] && best.whole[e])
        finish_end(flat, *ends[e], best, e, seen[e], pad_m, surface, found.end[e]);
    if (bistatic != nullptr && found.end[0].state == State::proven && found.end[1].state == State::proven)
      finish_pair(flat, *bistatic, {&*ends[0], &*ends[1]}, best, seen, pad_m,
                  edge_pad(flat, base, lies, pad_m), surface, found);
    return found;
  }

 private:
  struct Gathered {
    std::vector<std::pair<Interval, Interval>> boxes;
    std::array<std::vector<EndPatch>, 2> patches;  // by box
    std::array<bool, 2> whole{};                   // no box failed
    std::array<Bends, 2> bends;
    Interval level_a, level_b;
    std::array<double, 2> per_sr{};
    double per_area = 0;

    double measure() const {
      double sum = 0;
      for (const Bends& bend : bends) sum += bend.across;
      const double slopes = level_a.largest() + level_b.largest();
      return sum * (std::isfinite(slopes) ? 1 + slopes : 1);
    }
  };

  static glm::dvec3 unproven_place(const BistaticEnd& end, const glm::dvec3& place_m) {
    glm::dvec3 two_way = end.water.unfolded(place_m) - end.water.apex_m();
    two_way.z *= end.water.unfolding().sign;
    return two_way;
  }

  struct Beside {
    bool sees = false;
    std::optional<EndOfFacet> end;  // none if the other receiver sees the facet without a proven ray
  };

  Gathered gather(const FlatFacet& flat, const std::array<std::optional<EndOfFacet>, 2>& ends,
                  const Beside& other, const ScatteringModel* model, int parts) const {
    Gathered all;
    all.boxes = boxes_of(flat, parts);
    for (std::size_t e = 0; e < 2; ++e) {
      all.whole[e] = ends[e].has_value();
      for (std::size_t k = 0; k < all.boxes.size() && all.whole[e]; ++k) {
        auto patch = ends[e]->over(all.boxes[k].first, all.boxes[k].second);
        all.whole[e] = patch.has_value();
        if (!patch) break;
        // Second derivatives of images, which have the same vertical flip as their normals.
        const Bends bend = bends_of(patch->rays, ends[e]->seen_normal());
        all.bends[e].all = std::max(all.bends[e].all, bend.all);
        all.bends[e].across = std::max(all.bends[e].across, bend.across);
        all.patches[e].push_back(std::move(*patch));
      }
    }
    if (!all.whole[0] || !all.whole[1]) return all;
    for (std::size_t k = 0; k < all.boxes.size(); ++k) {
      const EndPatch &tx = all.patches[0][k], &rx = all.patches[1][k];
      const Interval a = slope(tx, &Jet::a) + slope(rx, &Jet::a) - 2.0 * tx.log_speed_a,
                     b = slope(tx, &Jet::b) + slope(rx, &Jet::b) - 2.0 * tx.log_speed_b;
      all.level_a = k == 0 ? a : hull(all.level_a, a);
      all.level_b = k == 0 ? b : hull(all.level_b, b);
      const auto& [box_a, box_b] = all.boxes[k];
      const auto also = other.end ? other.end->over(box_a, box_b) : std::nullopt;
      add_most(tx, rx, also ? &*also : nullptr, model, all);
      if (other.sees && !also) all.per_area = all.per_sr[0] = all.per_sr[1] = infinite;
    }
    return all;
  }

  /// Slopes of the logarithm of one end's factor, relative to the straight-ray factor of the image.
  Interval slope(const EndPatch& at, Interval Jet::*along) const {
    const RayJets& rays = at.rays;
    const Interval beyond_db =
        rays.absorption_db.*along - model_.absorption_db_per_m * reference_speed() * rays.time_s.*along;
    return at.sine_m.*along / at.sine_m.v + 3.0 * (rays.slowness_s_per_m.*along / rays.slowness_s_per_m.v) -
           rays.area_ratio_per_sr.*along / rays.area_ratio_per_sr.v - beta_ * beyond_db;
  }
  double reference_speed() const { return seabed_.tx.rays.reference_speed_m_s(); }

  /// Upper bounds of a box's return over two ends: per square metre, and per steradian at either end.
  struct Most {
    double per_sr[2]{}, per_area = 0;
  };
  Most most_of(const EndPatch& tx, const EndPatch& rx, const ScatteringModel* model) const {
    double lobe[2]{}, by_sine[2]{}, area[2]{}, lost = 1;
    for (const int e : {0, 1}) {
      const EndPatch& at = e == 0 ? tx : rx;
      const Interval sine = at.sine_m.v / root(at.distance2.v);
      const double largest = std::min(sine.largest(), 1.0), least = least_size(sine);
      lobe[e] = model == nullptr ? largest
                                 : std::sqrt(largest_cross_section(*model, {std::min(least, 1.0), largest})) *
                                       (1 + enclosure_slack);
      by_sine[e] = model == nullptr ? 1 : lobe[e] / least;
      area[e] = (at.rays.area_ratio_per_sr.v * at.distance2.v).lo;  // area per steradian from the point back
      if (!(area[e] > 0)) area[e] = 0;
      lost *= exp(-(beta_ * at.rays.absorption_db.v)).hi;
    }
    const double sent = seabed_.tx.water.finder().source_speed_m_s(),
                 received = seabed_.rx.water.finder().source_speed_m_s(),
                 // The areas per steradian in the two directions differ by its square.
        there = tx.speed.lo / sent * (1 - enclosure_slack), speeds = sent / received * (1 + enclosure_slack);
    // A point may be seen a tenth wider than on its apparent facet.
    return {{1.1 * by_sine[0] * lobe[1] * lost / area[1],
             1.1 * lobe[0] * by_sine[1] * lost * speeds * speeds / area[0]},
            lobe[0] * lobe[1] * lost / (area[0] * there * there * area[1])};
  }
  static double least_size(const Interval& x) {
    return x.may_be_zero() ? 0 : std::min(std::abs(x.lo), std::abs(x.hi));
  }
  /// Adds the bounds of a box. `beside`: the box as the other receiver sees it, whose return per steradian
  /// of the receive leg is included; null: no other receiver.
  void add_most(const EndPatch& tx, const EndPatch& rx, const EndPatch* beside, const ScatteringModel* model,
                Gathered& all) const {
    Most most = most_of(tx, rx, model);
    if (beside != nullptr) {
      const Most other = most_of(tx, *beside, model);
      const double speed = rx.speed.hi / seabed_.rx.water.finder().source_speed_m_s() * (1 + enclosure_slack),
                   sine = least_size(rx.sine_m.v / root(rx.distance2.v)),
                   area = (rx.rays.area_ratio_per_sr.v * rx.distance2.v).hi * speed * speed / sine;
      most.per_sr[0] = std::max(most.per_sr[0], other.per_sr[0]);
      most.per_sr[1] = std::max(most.per_sr[1], 1.1 * other.per_area * area);
      most.per_area = std::max(most.per_area, other.per_area);
    }
    all.per_area = std::max(all.per_area, most.per_area);
    for (const int e : {0, 1})
      all.per_sr[std::size_t(e)] = std::max(all.per_sr[std::size_t(e)], most.per_sr[e]);
  }

  /// Error of linear interpolation between corners (S. Waldron, SIAM J. Numer. Anal. 35 (1998) 1191).
  static double interpolated(const FlatFacet& flat, double bend) {
    return flat.radius_m * flat.radius_m / 2 * bend * (1 + enclosure_slack);
  }

  void finish_end(const FlatFacet& flat, const EndOfFacet& end, const Gathered& all, std::size_t e,
                  const FacetCorners& seen, double pad_m, const FacetScattering& surface,
                  FacetEnclosure& facet) const {
    const glm::dvec3 apex = seabed_.end(int(e)).water.apex_m();
    const double off = 1.1 * end.off_m() * (1 + enclosure_slack) +
                       glm::distance(apex,
                                     seabed_.grid.to_metres(seabed_.grid.snap(apex))),  // start of the tubes
        gap = interpolated(flat, all.bends[e].all) + off,
                 across = interpolated(flat, all.bends[e].across) + off;
    if (!std::isfinite(gap)) return;
    facet.travel_path_error_m = gap;
    facet.seen = seen;
    const glm::dvec3 normal = glm::normalize(glm::cross(seen[1] - seen[0], seen[2] - seen[0]));
    const double facing = glm::dot(normal, seen[0]);
    facet.normal = facing < 0 ? -normal : normal;
    facet.plane_m = std::abs(facing);
    facet.nearest_m = std::max(nearest_of(seen) - gap, 0.0);
    facet.farthest_m = farthest_of(seen) + gap;
    if (all.whole[1 - e]) {
      facet.most_per_sr = surface.most * all.per_sr[e];
      facet.most = surface.most * all.per_area * flat.area_m2 * (1 + 100 * pad_m / flat.height_m);
    }
    facet.state = State::conservative;
    const double sine = facet.plane_m / facet.farthest_m;
    // A point also has a sideways distance from its position on the apparent facet.
    facet.shift_m = sine > 0 ? (across + gap) / sine * (1 + enclosure_slack) + gap : infinite;
    Interval sines = all.patches[e].front().sine_m.v;
    for (const EndPatch& patch : all.patches[e]) sines = hull(sines, patch.sine_m.v);
    if (!(facet.shift_m < facet.nearest_m / 4) || sines.may_be_zero() ||
        (sines.lo > 0) != (end.facing() > 0) || !std::isfinite(facet.most_per_sr))
      return;
    facet.state = State::proven;
  }

  /// Bounds the relative error of a facet's area. Along edges of the base facet, corners may lie off the
  /// edge.
  static double edge_pad(const FlatFacet& flat, const FacetCorners& base, const FacetCorners& lies,
                         double pad_m) {
    if (pad_m == 0) return 0;
    double length = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const glm::dvec3 &p = lies[k], &q = lies[(k + 1) % 3];
      for (std::size_t i = 0; i < 3; ++i) {
        const glm::dvec3 &from = base[i], two_way = glm::normalize(base[(i + 1) % 3] - from);
        const auto off = [&](const glm::dvec3& x) { return glm::length(glm::cross(two_way, x - from)); };
        if (off(p) < 4 * pad_m && off(q) < 4 * pad_m) length += glm::distance(p, q);
      }
    }
    return length * 2 * pad_m / flat.area_m2;
  }

  /// Difference between true and flattened ranges for one end.
  struct Misfit {
    Jet at_middle;                      // squares: true minus flattened
    Interval v, a, b;                   // the same, anywhere on the facet
    std::vector<Jet> by_box;            // ranges
    std::array<Interval, 3> at_corner;  // ranges
    double largest_m = 0;
  };
  Jet square_of_range(const EndPatch& at) const {
    const Jet speed(reference_speed());
    return common(squared(speed * at.rays.time_s), squared(speed * at.rays.slowness_s_per_m) * at.distance2);
  }
  Misfit misfit_of(const FlatFacet& flat, const EndOfFacet& end, const std::vector<EndPatch>& patches,
                   const Gathered& all, const Flattened& flattened) const {
    Misfit found;
    found.at_middle = square_of_range(end.middle()) - flattened.range2(0.0, 0.0);
    std::array<Interval, 3> corner;
    Interval a_all(0.0), b_all(0.0);
    for (std::size_t k = 0; k < 3; ++k) {
      const Interval a(flat.at[k].x), b(flat.at[k].y);
      const Jet laid2 = flattened.range2(a, b), range2 = square_of_range(end.corner(int(k)));
      corner[k] = range2.v - laid2.v;
      found.at_corner[k] = corner[k] / (root(range2.v) + root(laid2.v));
      a_all = hull(a_all, a), b_all = hull(b_all, b);
    }
    std::vector<Jet> squares;
    Jet bend;
    for (std::size_t k = 0; k < patches.size(); ++k) {
      squares.push_back(square_of_range(patches[k]) -
                        flattened.range2(all.boxes[k].first, all.boxes[k].second));
      for (Interval Jet::*part : {&Jet::aa, &Jet::ab, &Jet::bb})
        bend.*part = k == 0 ? squares[k].*part : hull(bend.*part, squares[k].*part);
    }
    found.v = hull(hull(corner[0], corner[1]), corner[2]) + both_ways(interpolated(flat, bend_of(bend)));
    found.a = found.at_middle.a + bend.aa * a_all + bend.ab * b_all;
    found.b = found.at_middle.b + bend.ab * a_all + bend.bb * b_all;
    for (std::size_t k = 0; k < patches.size(); ++k) {
      Jet& square = squares[k];
      square.v = common(square.v, found.v);
      square.a = common(square.a, found.a);
      square.b = common(square.b, found.b);
      const Jet sum = Jet(reference_speed()) * patches[k].rays.time_s +
                      root(flattened.range2(all.boxes[k].first, all.boxes[k].second));
      found.by_box.push_back(square / sum);
      found.largest_m = std::max(found.largest_m, found.by_box.back().v.largest());
    }
    return found;
  }

  /// Returns the rays to a part of a facet, with the flattened grazing angles and the ratio of true to
  /// flattened sine.
  static GrazingPatch grazing(const EndPatch& at, const Jet& laid2, const Interval& misfit2,
                              const Interval& misfit2_a, const Interval& misfit2_b, double height) {
    const Jet sine = Jet(height) * inverse(root(laid2));
    const auto ratio = [&](Interval Jet::*along, const Interval& misfit_slope) {
      // Half the logarithm of the ratio of flattened to true squared ranges, which are almost equal.
      const Interval of_range = at.rays.time_s.*along / at.rays.time_s.v;
      return at.sine_m.*along / at.sine_m.v + at.rays.slowness_s_per_m.*along / at.rays.slowness_s_per_m.v +
             of_range * (misfit2 / laid2.v) - 0.5 * (misfit_slope / laid2.v);
    };
    return {sine.v, sine.a, sine.b, ratio(&Jet::a, misfit2_a), ratio(&Jet::b, misfit2_b)};
  }

  void finish_pair(const FlatFacet& flat, const BistaticFacet& bistatic,
                   const std::array<const EndOfFacet*, 2>& ends, const Gathered& all,
                   const std::array<FacetCorners, 2>& seen, double pad_m, double edge_pad_part,
                   const FacetScattering& surface, Found& found) const {
    BistaticEnclosure& pair = found.pair;
    std::array<glm::dvec2, 3> corner;
    for (std::size_t k = 0; k < 3; ++k) corner[k] = glm::dvec2(bistatic.to_plane.at(seen[0][k]));
    const std::array<Flattened, 2> flattened{
        Flattened(flat, corner, glm::dvec2(0), bistatic.transmit_distance_m),
        Flattened(flat, corner, bistatic.receive_foot_m, bistatic.receive_distance_m)};
    const double flattened_area = std::abs(cross(corner[1] - corner[0], corner[2] - corner[0])) / 2;
    if (!(flattened_area > 0 && flattened[0].height > 0 && flattened[1].height > 0)) return;
    const std::array<Misfit, 2> misfit{misfit_of(flat, *ends[0], all.patches[0], all, flattened[0]),
                                       misfit_of(flat, *ends[1], all.patches[1], all, flattened[1])};
    Jet bend;
    for (std::size_t k = 0; k < all.boxes.size(); ++k) {
      const Jet sum = misfit[0].by_box[k] + misfit[1].by_box[k];
      for (Interval Jet::*part : {&Jet::aa, &Jet::ab, &Jet::bb})
        bend.*part = k == 0 ? sum.*part : hull(bend.*part, sum.*part);
    }
    double at_corners = 0;
    for (std::size_t k = 0; k < 3; ++k)
      at_corners = std::max(at_corners, (misfit[0].at_corner[k] + misfit[1].at_corner[k]).largest());
    const double rounding_m = 1e-12 * (found.end[0].farthest_m + found.end[1].farthest_m);
    pair.shift_m =
        ((at_corners + interpolated(flat, bend_of(bend))) / 2 + pad_m + rounding_m) * (1 + enclosure_slack);

    const auto change = [&](const Interval& a, const Interval& b) {
      Interval sum = 0.0;
      for (int k = 0; k < 3; ++k) sum = hull(sum, a * flat.at[k].x + b * flat.at[k].y);
      return sum;
    };
    Interval level = log(outwards(flat.area_m2 / flattened_area, flat.area_m2 / flattened_area, 1e4)) +
                     both_ways(std::log1p(edge_pad_part)) + change(all.level_a, all.level_b) -
                     2.0 * log(ends[0]->middle().speed / seabed_.tx.water.finder().source_speed_m_s());
    for (std::size_t e = 0; e < 2; ++e) {
      const EndPatch& middle = ends[e]->middle();
      const FacetEnclosure& facet = found.end[e];
      const Interval sine_m = middle.sine_m.v.lo > 0 ? middle.sine_m.v : -middle.sine_m.v;
      const double height = flattened[e].height, off = misfit[e].largest_m;
      if (!sine_m.surely_positive() || !(off < facet.nearest_m / 4)) return;
      const Interval db =
          middle.rays.absorption_db.v - model_.absorption_db_per_m * reference_speed() * middle.rays.time_s.v;
      level = level + log(sine_m) + 3.0 * log(reference_speed() * middle.rays.slowness_s_per_m.v) -
              log(middle.rays.area_ratio_per_sr.v) - beta_ * db - log(Interval(height));
      level = level + both_ways(3 * std::log1p(off / (facet.nearest_m - off)) +
                                beta_.hi * model_.absorption_db_per_m * off);
      if (surface.model != nullptr) {
        const Jet laid2 = flattened[e].range2(0.0, 0.0);
        const GrazingPatch at = grazing(middle, laid2, misfit[e].at_middle.v, misfit[e].at_middle.a,
                                        misfit[e].at_middle.b, height);
        std::vector<GrazingPatch> over;
        for (std::size_t k = 0; k < all.boxes.size(); ++k)
          over.push_back(grazing(all.patches[e][k],
                                 flattened[e].range2(all.boxes[k].first, all.boxes[k].second), misfit[e].v,
                                 misfit[e].a, misfit[e].b, height));
        const Interval ratio = log(sine_m * root(laid2.v) / (root(middle.distance2.v) * height));
        const auto scattering = apparent_scattering(*surface.model, at, ratio, over, change);
        if (!scattering) return;
        pair.model[e] = scattering->model;
        level = level + 0.5 * scattering->log_remainder;
      }
      take_directions(flat, flattened[e], seen[e], facet, e, pair);
      const MirrorLoss& loss = e == 0 ? model_.path.tx.loss : model_.path.back().loss;
      const double turn = pair.turn_rad[e] + pair.stretch[e];
      level = level + both_ways(loss.roughness * double(loss.rough_normals.size()) * (1 + loss.bend) * turn *
                                (2 + turn) * (1 + enclosure_slack));
    }
    if (seabed_.beside != nullptr &&
        !take_rx(flat, *ends[1], all.patches[1], flattened[1], misfit[1], pair.rx))
      return;
    pair.rx.pad_m = 2 * pad_m;  // error of a length
    pair.factor = exp(level);
    pair.place_off_m = 4 * pad_m;
    pair.proven = pair.factor.is_finite() && std::isfinite(pair.shift_m) && pair.turn_rad[0] < 0.1 &&
                  pair.turn_rad[1] < 0.1 && pair.stretch[0] < 0.1 && pair.stretch[1] < 0.1;
  }

  bool take_rx(const FlatFacet& flat, const EndOfFacet& end, const std::vector<EndPatch>& patches,
               const Flattened& flattened, const Misfit& misfit, ReceiveRanges& rx) const {
    Jet bend;
    for (std::size_t k = 0; k < misfit.by_box.size(); ++k) {
      for (Interval Jet::*part : {&Jet::aa, &Jet::ab, &Jet::bb})
        bend.*part = k == 0 ? misfit.by_box[k].*part : hull(bend.*part, misfit.by_box[k].*part);
      const std::array<Interval, 3> change = end.change(patches[k]);
      for (std::size_t i = 0; i < 3; ++i) rx.change[i] = k == 0 ? change[i] : hull(rx.change[i], change[i]);
    }
    rx.between_m = interpolated(flat, bend_of(bend));
    if (!std::isfinite(rx.between_m)) return false;
    const auto parts_worth = [&] { return double(rx.parts) * rx.parts * seabed_.ranges_within_m; };
    for (rx.parts = 1; rx.parts < most_parts && rx.between_m > parts_worth();) rx.parts *= 2;
    rx.lattice_m.resize(std::size_t((rx.parts + 1) * (rx.parts + 1)));
    for (int i = 0; i <= rx.parts; ++i)
      for (int j = 0; i + j <= rx.parts; ++j) {
        const double to_1 = double(i) / rx.parts, to_2 = double(j) / rx.parts;
        const auto between = [&](const auto& corner) {
          return corner[0] + to_1 * (corner[1] - corner[0]) + to_2 * (corner[2] - corner[0]);
        };
        const auto there = end.at(between(end.lies()));
        if (!there) return false;
        const glm::dvec2 at = between(flat.at);
        const Interval laid2 = flattened.range2(at.x, at.y).v, range2 = square_of_range(*there).v,
                       sum = root(range2) + root(laid2);
        rx.lattice_m[std::size_t(i * (rx.parts + 1) + j)] =
            (range2 - laid2) / sum + both_ways(1e-14 * sum.hi);  // positions are rounded
      }
    return true;
  }

  static void take_directions(const FlatFacet& flat, const Flattened& flattened, const FacetCorners& seen,
                              const FacetEnclosure& facet, std::size_t e, BistaticEnclosure& pair) {
    pair.turn_rad[e] = 1.1 * facet.travel_path_error_m / facet.nearest_m + enclosure_slack * enclosure_slack;
    // The difference between squared apparent distances and squared flattened distances is a polynomial of
    // second degree.
    const auto [a, b] = flat.slopes_to(seen);
    const double aa = 2 * (glm::dot(a, a) - glm::dot(flattened.along_a, flattened.along_a)),
                 ab = 2 * (glm::dot(a, b) - glm::dot(flattened.along_a, flattened.along_b)),
                 bb = 2 * (glm::dot(b, b) - glm::dot(flattened.along_b, flattened.along_b));
    double corner = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const Jet laid2 = flattened.range2(flat.at[k].x, flat.at[k].y);
      corner = std::max(corner, (glm::dot(seen[k], seen[k]) - laid2.v).largest());
    }
    const double most = corner + interpolated(flat, std::sqrt(aa * aa + 2 * ab * ab + bb * bb));
    pair.stretch[e] = most / (facet.nearest_m * facet.nearest_m) + enclosure_slack * enclosure_slack;
  }

  const BistaticSurface& seabed_;
  const EchoModel& model_;
  Interval beta_;
  std::vector<FacetScattering> surfaces_;
};

}  // namespace

double ReceiveRanges::largest_difference_m(const ReceiveRanges& one, const ReceiveRanges& other) {
  const int parts = std::min(one.parts, other.parts);
  if (parts == 0) return infinite;
  const auto at = [&](const ReceiveRanges& of, int i, int j) {
    const int step = of.parts / parts;
    return of.lattice_m[std::size_t(step * (i * (of.parts + 1) + j))];
  };
  double lattice = 0;
  for (int i = 0; i <= parts; ++i)
    for (int j = 0; i + j <= parts; ++j)
      lattice = std::max(lattice, (at(one, i, j) - at(other, i, j)).largest());
  std::array<Interval, 3> change;
  for (std::size_t i = 0; i < 3; ++i) change[i] = one.change[i] - other.change[i];
  return (lattice + (one.between_m + other.between_m) / (double(parts) * parts) +
          std::max(one.pad_m, other.pad_m) * norm_of(change).hi) *
         (1 + enclosure_slack);
}

BistaticEnclosures enclose(const BistaticSurface& seabed, std::span<const SharedFacet> shared,
                           std::span<const BistaticFacet> bistatic, const EchoModel& model) {
  const BistaticEncloser encloser(seabed, model);
  BistaticEnclosures all;
  all.facets.resize(shared.size());
  std::array<std::vector<FacetId>, 2> seen_as;
  for (std::size_t e = 0; e < 2; ++e) {
    const BistaticEnd& end = seabed.end(int(e));
    seen_as[e].assign(seabed.mesh.facets.size(), no_facet);
    for (std::size_t k = 0; k < end.origin.size(); ++k) seen_as[e][end.origin[k]] = FacetId(k);
    all.ends[e].facets.resize(end.origin.size());
  }
  std::vector<char> seen_beside(seabed.mesh.facets.size(), 0);
  if (seabed.beside != nullptr)
    for (const FacetId facet : seabed.beside->origin) seen_beside[facet] = 1;
  std::vector<std::size_t> number(seabed.mesh.facets.size(), shared.size());
  for (std::size_t k = 0; k < shared.size(); ++k) number[shared[k].facet] = k;
  Steps steps("facets", seabed.mesh.facets.size());
  tbb::parallel_for(FacetId{0}, FacetId(seabed.mesh.facets.size()), [&](FacetId f) {
    steps.done();
    const std::array<bool, 3> sees{seen_as[0][f] != no_facet, seen_as[1][f] != no_facet, seen_beside[f] != 0};
    if (!sees[0] && !sees[1]) return;
    const bool is_shared = number[f] < shared.size();
    const auto found = encloser.enclose(f, sees, is_shared ? &bistatic[number[f]] : nullptr);
    for (std::size_t e = 0; e < 2; ++e)
      if (sees[e]) all.ends[e].facets[seen_as[e][f]] = found.end[e];
    if (is_shared) all.facets[number[f]] = found.pair;
  });
  for (std::size_t e = 0; e < 2; ++e) {
    const BistaticEnd& end = seabed.end(int(e));
    ApparentEnclosures& own = all.ends[e];
    for (const FacetEnclosure& facet : own.facets)
      if (facet.state == State::unproven) own.unproven.push_back(facet);
    for (const auto& corners : end.surface_mesh.left_out_m) {
      FacetEnclosure facet;
      for (std::size_t k = 0; k < 3; ++k) {
        facet.seen[k] = end.water.unfolded(corners[k]) - end.water.apex_m();
        facet.seen[k].z *= end.water.unfolding().sign;
      }
      facet.nearest_m = nearest_of(facet.seen) * end.rays.least_stretch();
      own.unproven.push_back(facet);
    }
  }
  return all;
}

}  // namespace tubefoot
