// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/certified/certified_refraction.hpp"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <map>
#include <numbers>
#include <stdexcept>

#include "engine/certified/certified_integral.hpp"
#include "engine/certified/uncertain_edges.hpp"
#include "geometry/steps/steps.hpp"

namespace tubefoot {
namespace {

constexpr double slack = 1e-9;  // far above the rounding of the doubles that it is laid on
constexpr double infinite = std::numeric_limits<double>::infinity();
using State = FacetEnclosure::State;

/// Of a bin: no less, no more.
struct Between {
  double lo = 0, hi = 0;
};
using Bins = std::map<std::size_t, Between>;

void check_reference(const EchoLaw& law) {
  const auto any = [](const auto& list) {
    return std::any_of(list.begin(), list.end(), [](const auto& entry) { return entry != nullptr; });
  };
  if (any(law.reflectivity) || any(law.scattering))
    throw std::invalid_argument(
        "a reference through refracting water knows Lambert's law and even beds alone");
}

/// Samples that are cut `shift_m` before and after each border: number 2 k + 1 is surely of sample k, and 2 k
/// lies about the border between k - 1 and k.
std::vector<double> borders_about(std::span<const double> borders, double shift_m) {
  std::vector<double> about;
  for (const double b : borders) {
    about.push_back(std::max(b - shift_m, 0.0));
    about.push_back(b + shift_m);
  }
  return about;
}

/// Which facets have images that a tube may see.
class Looked {
 public:
  explicit Looked(std::span<const FacetEnclosure> facets) : facets_(facets), balls_(facets.size()) {
    std::vector<double> gaps;
    for (FacetId f = 0; f < facets.size(); ++f) {
      const FacetEnclosure& facet = facets[f];
      if (facet.state == State::unproven) continue;
      gaps.push_back(facet.gap_m);
      const glm::dvec3 centre = (facet.seen[0] + facet.seen[1] + facet.seen[2]) / 3.0;
      double radius = 0;
      for (const glm::dvec3& c : facet.seen) radius = std::max(radius, glm::distance(c, centre));
      balls_[f] = {centre, radius * (1 + slack) + facet.gap_m};
    }
    std::ranges::sort(gaps);
    // The tree is asked for those that move little; the others are looked at one by one.
    if (!gaps.empty()) usual_gap_m_ = 4 * gaps[gaps.size() / 2], most_gap_m_ = gaps.back();
    for (FacetId f = 0; f < facets.size(); ++f)
      if (facets[f].state != State::unproven && facets[f].gap_m > usual_gap_m_) wide_.push_back(f);
  }
  double most_gap_m() const { return most_gap_m_; }

  /// By increasing id.
  std::vector<FacetId> in(const Sector& tube, const SceneTree& tree) const {
    std::vector<FacetId> seen = tube.facets(tree, usual_gap_m_);
    seen.insert(seen.end(), wide_.begin(), wide_.end());
    std::erase_if(seen, [&](FacetId f) {
      return facets_[f].state == State::unproven || !tube.may_meet(balls_[f].first, balls_[f].second);
    });
    std::ranges::sort(seen);
    seen.erase(std::unique(seen.begin(), seen.end()), seen.end());
    return seen;
  }

 private:
  std::span<const FacetEnclosure> facets_;
  std::vector<std::pair<glm::dvec3, double>> balls_;  // about each image
  std::vector<FacetId> wide_;
  double usual_gap_m_ = 0, most_gap_m_ = 0;
};

/// Where the facets without a proven ray may be seen in a tube, and how soon.
class Unknown {
 public:
  Unknown(std::span<const FacetEnclosure> facets, const RayEnclosure& rays) : rays_(rays) {
    for (const FacetEnclosure& facet : facets) {
      Ball about;
      about.centre_m = (facet.seen[0] + facet.seen[1] + facet.seen[2]) / 3.0;
      for (const glm::dvec3& c : facet.seen)
        about.radius_m = std::max(about.radius_m, glm::distance(c, about.centre_m) * (1 + slack));
      about.nearest_m = facet.nearest_m;
      look_at(about);
      balls_.push_back(about);
    }
    std::ranges::sort(balls_, {}, &Ball::nearest_m);
  }
  /// Range beyond which nothing is known.
  double begins_m(const Sector& tube) const {
    for (const Ball& ball : balls_)
      if (may_be_seen(ball, tube)) return ball.nearest_m;
    return infinite;
  }

 private:
  struct Ball {
    glm::dvec3 centre_m{0};
    double radius_m = 0, nearest_m = 0;
    DirectionBox launch;  // of rays to it
    bool anywhere = false;
  };
  /// Launched in the ball's vertical plane, up to most_turn_rad() higher or lower.
  void look_at(Ball& ball) const {
    const glm::dvec3& way = ball.centre_m;
    const double range = glm::length(way), across = std::hypot(way.x, way.y);
    ball.anywhere = !(range > ball.radius_m);
    if (ball.anywhere) return;
    const double level = std::atan2(way.z, across),
                 apart = std::asin(ball.radius_m / range) + rays_.most_turn_rad() + slack,
                 low = std::max(level - apart, -upright), high = std::min(level + apart, upright);
    DirectionBox& box = ball.launch;
    box.low_sine = std::sin(low);
    box.low_cosine = std::cos(low);
    box.high_sine = std::sin(high);
    box.high_cosine = std::cos(high);
    box.all_round = !(ball.radius_m < across) || level + apart > upright || level - apart < -upright;
    if (box.all_round) return;
    const double sine = ball.radius_m / across, cosine = std::sqrt((1 - sine) * (1 + sine));
    const glm::dvec2 towards = glm::dvec2(way) / across, left(-towards.y, towards.x);
    box.from = cosine * towards - sine * left;
    box.to = cosine * towards + sine * left;
  }
  /// False only if no tube looks where a ray to the ball may be launched, or none comes as far.
  bool may_be_seen(const Ball& ball, const Sector& tube) const {
    if (ball.anywhere) return true;
    const double range = glm::length(ball.centre_m) - ball.radius_m;
    return rays_.least_stretch() * range <= tube.reach_m() * (1 + slack) && tube.may_meet(ball.launch);
  }
  static constexpr double upright = std::numbers::pi / 2;
  const RayEnclosure& rays_;
  std::vector<Ball> balls_;
};

}  // namespace

RefractedReference certify_refracted_echo(const FacetMesh& apparent, const SceneTree& tree,
                                          std::span<const FacetId> parent,
                                          const ApparentEnclosures& enclosures, const RayEnclosure& rays,
                                          const History& history, const VisibilityOptions& options,
                                          std::span<const std::uint32_t> beam_of_tube,
                                          const RangeSamples& samples, const EchoLaw& law,
                                          const Echo& ordinary, double tolerance) {
  if (options.arithmetic == Arithmetic::plain_double)
    throw std::invalid_argument("a reference needs an exact arithmetic: fixed, filtered or rational");
  check_reference(law);
  const std::vector<double> borders = sample_borders_m(samples);
  const std::vector<double> target = reference_targets(ordinary, tolerance);
  const Ball beta = Ball(law.absorption_db_per_m) * log(Ball(10)) / Ball(10);
  const auto row = std::size_t(samples.count);
  const UncertainEdges edges(apparent, parent, enclosures);
  const Unknown unknown(enclosures.unproven, rays);
  TubeSet tubes = history.tubes;
  // Facets that begin beyond the reach may be seen before it.
  const Looked looked(enclosures.facets);
  tubes.reach += 2 * looked.most_gap_m() / history.grid_unit_m;

  std::vector<Bins> by_tube(tubes.tubes.size());
  struct Buffers {
    VisibilityScratch visibility;
    TubeVisibility seen;
  };
  tbb::enumerable_thread_specific<Buffers> threads;
  Steps steps("tubes", tubes.tubes.size());
  tbb::parallel_for(std::uint32_t{0}, std::uint32_t(tubes.tubes.size()), [&](std::uint32_t tube) {
    steps.done();
    auto& [visibility, seen] = threads.local();
    see(apparent, tree, tubes, tube, options, visibility, seen);
    const NameContext context{apparent, tubes.apex, seen.rays};
    Bins& bins = by_tube[tube];
    const auto beams = law.patterns != nullptr ? law.patterns->beams_of_tube[tube]
                                               : std::pair(beam_of_tube[tube], beam_of_tube[tube] + 1);
    const auto each_bin = [&](double nearest_m, double farthest_m, const auto& change) {
      const auto first = std::upper_bound(borders.begin(), borders.end(), nearest_m);
      const auto end = std::upper_bound(borders.begin(), borders.end(), farthest_m);
      const std::size_t from = std::size_t(std::max<std::ptrdiff_t>(first - borders.begin() - 1, 0)),
                        to = std::min(std::size_t(end - borders.begin()), row);
      for (std::size_t k = from; k < to; ++k)
        for (std::uint32_t beam = beams.first; beam < beams.second; ++beam) change(bins[beam * row + k]);
    };
    const DoubtSink doubt = [&](const Doubt& d) {
      each_bin(d.nearest_m, d.farthest_m, [&](Between& bin) {
        bin.lo -= d.energy_j;
        bin.hi += d.energy_j;
      });
    };

    TubeSet own = tubes;
    own.tubes = {tubes.tubes[tube]};
    const Sector sector(own, history.grid_unit_m);
    const std::vector<FacetId> nearby = looked.in(sector, tree);
    for (const FacetId f : nearby) {
      const FacetEnclosure& facet = enclosures.facets[f];
      if (facet.state == State::loose)
        each_bin(facet.nearest_m, facet.farthest_m, [&](Between& bin) { bin.hi += facet.most; });
    }

    std::vector<SeenPiece> pieces;
    for (const NamedPiece& piece : seen.pieces) {
      stop_if_wanted();
      const CertifiedPolygon polygon = certified_polygon(context, seen.corners, piece, history.grid_unit_m);
      pieces.push_back(seen_piece(piece, polygon));
      const FacetEnclosure& facet = enclosures.facets[piece.facet];
      if (facet.state != State::proven || polygon.edges.size() < 3) continue;
      // An interval so wide that borders meet is one sample about each.
      const double shift = facet.shift_m * (1 + slack), most_shift = 0.45 * samples.step_m;
      const std::vector<double> about = borders_about(borders, std::min(shift, most_shift));
      CertifiedIntegrator integrator(about, beta);
      const Ball factor = Ball(law.material_mu[law.material[piece.facet]]) * squared(polygon.distance);
      const double size = factor.hi() * facet.factor.hi;
      const CertifiedIntegrator::Allowance allowance{
          tolerance / 50, [&](std::uint32_t beam, std::uint32_t sample) {
            const std::size_t bin = beam * row + std::min<std::size_t>(sample / 2, row - 1);
            return std::max(target[bin] / 2000 / size, 1e-300);
          }};
      const auto sink = [&](const Part<Ball>& part) {
        const auto [beam, sample] = std::pair(part.beam, part.sample);
        const Ball whole = factor * part.value;
        const double hi = whole.hi() * facet.factor.hi * (1 + slack),
                     lo = std::max(whole.lo() * facet.factor.lo * (1 - slack), 0.0);
        if (shift > most_shift) {
          const double from = about[sample] - shift - most_shift, to = about[sample + 1] + shift + most_shift;
          for (std::size_t k = 0; k < row; ++k)
            if (borders[k] <= to && borders[k + 1] >= from) bins[beam * row + k].hi += hi;
        } else if (sample % 2 == 1) {
          Between& bin = bins[beam * row + sample / 2];
          bin.lo += lo;
          bin.hi += hi;
        } else {
          if (sample / 2 < row) bins[beam * row + sample / 2].hi += hi;
          if (sample > 0) bins[beam * row + sample / 2 - 1].hi += hi;
        }
      };
      if (law.patterns != nullptr)
        integrator.add(polygon, *law.patterns, tube, allowance, sink);
      else
        integrator.add(polygon, beam_of_tube[tube], allowance, sink);
    }
    edges.add_doubts(context, seen, pieces, nearby, doubt);

    if (const double begins = unknown.begins_m(sector); begins < infinite)
      each_bin(begins, infinite, [&](Between& bin) { bin.hi = infinite; });
  });

  std::vector<Between> total(ordinary.energy.size());
  for (const Bins& bins : by_tube)  // in order, so that the result does not depend on the threads
    for (const auto& [bin, part] : bins) {
      total[bin].lo += std::max(part.lo, 0.0);
      total[bin].hi += part.hi;
    }

  RefractedReference reference;
  CertifiedEcho& certified = reference.certified;
  certified.echo = ordinary;
  certified.bound.resize(total.size());
  for (std::size_t bin = 0; bin < total.size(); ++bin) {
    if (!std::isfinite(total[bin].hi)) {
      certified.bound[bin] = infinite;
      ++reference.unbounded;
      continue;
    }
    const double lo = total[bin].lo * (1 - slack), hi = total[bin].hi * (1 + slack);
    certified.echo.energy[bin] = lo + (hi - lo) / 2;
    certified.bound[bin] = (hi - lo) / 2 * (1 + slack);
  }
  // What keeps the bounds that are finite from being as narrow as asked.
  CertifiedEcho finite = certified;
  for (double& bound : finite.bound) bound = std::isfinite(bound) ? bound : 0;
  hold_against(finite, tolerance);
  reference.bins = total.size() - reference.unbounded;
  reference.bins_over = finite.bins_over;
  if (finite.bins_over > 0) {
    std::vector<double> excess;
    Echo least = finite.echo;
    for (std::size_t bin = 0; bin < total.size(); ++bin)
      least.energy[bin] = std::max(least.energy[bin] - finite.bound[bin], 0.0);
    const std::vector<double> asked = reference_targets(least, tolerance);
    for (std::size_t bin = 0; bin < total.size(); ++bin)
      if (finite.bound[bin] > asked[bin]) excess.push_back(finite.bound[bin] / asked[bin]);
    const auto middle = excess.begin() + std::ssize(excess) / 2;
    std::nth_element(excess.begin(), middle, excess.end());
    reference.usual_excess = *middle;
  }
  hold_against(certified, tolerance);
  certified.worst_ratio = finite.worst_ratio;
  certified.worst_beam = finite.worst_beam;
  certified.worst_sample = finite.worst_sample;
  return reference;
}

}  // namespace tubefoot
