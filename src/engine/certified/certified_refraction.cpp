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

#include "engine/certified/certified_cells.hpp"
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

/// Samples that are cut `shift_m` before and after each border: number 2 k + 1 is surely of sample k, and 2 k
/// lies about the border between k - 1 and k.
class ShiftedSamples {
 public:
  ShiftedSamples(std::span<const double> borders, double step_m, double shift_m)
      : borders_(borders), shift_m_(shift_m), most_shift_m_(0.45 * step_m) {
    // An interval so wide that borders meet is one sample about each.
    const double shift = std::min(shift_m_, most_shift_m_);
    for (const double b : borders) {
      about_.push_back(std::max(b - shift, 0.0));
      about_.push_back(b + shift);
    }
  }
  std::span<const double> borders() const { return about_; }

  /// What a part of these samples has, from `lo` to `hi`, to the beam's bins.
  void add(std::uint32_t beam, std::uint32_t sample, double lo, double hi, Bins& bins) const {
    const std::size_t row = borders_.size() - 1, first = beam * row;
    if (shift_m_ > most_shift_m_) {
      const double from = about_[sample] - shift_m_ - most_shift_m_,
                   to = about_[sample + 1] + shift_m_ + most_shift_m_;
      for (std::size_t k = 0; k < row; ++k)
        if (borders_[k] <= to && borders_[k + 1] >= from) bins[first + k].hi += hi;
    } else if (sample % 2 == 1) {
      Between& bin = bins[first + sample / 2];
      bin.lo += lo;
      bin.hi += hi;
    } else {
      if (sample / 2 < row) bins[first + sample / 2].hi += hi;
      if (sample > 0) bins[first + sample / 2 - 1].hi += hi;
    }
  }

 private:
  std::span<const double> borders_;
  double shift_m_, most_shift_m_;
  std::vector<double> about_;
};

/// What all pieces share.
struct Asked {
  const EchoLaw& law;
  std::vector<std::shared_ptr<const CertifiedTexture>> textures;  // by material
  std::vector<double> borders, target;
  double step_m, tolerance;
  Ball beta;
};

/// One visible piece of a proven facet, and the tube that sees it.
struct ProvenPiece {
  const CertifiedPolygon& polygon;
  const FacetEnclosure& facet;
  FacetId id;
  std::uint32_t tube, beam;
};

void add_piece(const ProvenPiece& piece, const Asked& asked, Bins& bins) {
  const EchoLaw& law = asked.law;
  const CertifiedPolygon& polygon = piece.polygon;
  const FacetEnclosure& facet = piece.facet;
  const std::uint16_t material = law.material[piece.id];
  const std::size_t row = asked.borders.size() - 1;
  const ShiftedSamples samples(asked.borders, asked.step_m, facet.shift_m * (1 + slack));
  CertifiedIntegrator integrator(samples.borders(), asked.beta);
  if (facet.law) integrator.take_law(&*facet.law);
  const Ball factor = facet.law ? Ball(1) : Ball(law.material_mu[material]) * squared(polygon.distance);
  const double size = factor.hi() * facet.factor.hi;
  std::size_t cells = 1;
  const CertifiedIntegrator::Allowance allowance{
      asked.tolerance / 50, [&](std::uint32_t beam, std::uint32_t sample) {
        const std::size_t bin = beam * row + std::min<std::size_t>(sample / 2, row - 1);
        return std::max(asked.target[bin] / 2000 / double(cells) / size, 1e-300);
      }};
  // `times`: of a part, all that is not in its integral.
  const auto add = [&](const CertifiedPolygon& part, const CertifiedCell* cell, const Between& times) {
    const auto sink = [&](const Part<Ball>& own) {
      const Ball whole = factor * own.value;
      const double hi = whole.hi() * facet.factor.hi * (1 + slack),
                   lo = std::max(whole.lo() * facet.factor.lo * (1 - slack), 0.0);
      samples.add(own.beam, own.sample, (times.lo < 0 ? hi : lo) * times.lo, hi * times.hi, bins);
    };
    if (law.patterns != nullptr)
      integrator.add(part, *law.patterns, piece.tube, allowance, sink, cell);
    else
      integrator.add(part, piece.beam, allowance, sink, cell);
  };
  const CertifiedTexture* texture = asked.textures[material].get();
  if (texture == nullptr) return add(polygon, nullptr, {1, 1});
  const Between range{std::max(texture->range().lo(), 0.0), texture->range().hi()};
  const FacetMap& lies = law.path.out.facet_map[piece.id];
  const bool worth_it = range.hi - range.lo > asked.tolerance / 8 * range.lo;
  cells = worth_it ? cut_by_cells(polygon, *texture, lies, most_cells, {}) : 0;
  if (cells == 0) {
    cells = 1;
    return add(polygon, nullptr, range);
  }
  cut_by_cells(polygon, *texture, lies, most_cells,
               [&](const CertifiedPolygon& part, const CertifiedCell& cell) {
                 add(part, &cell, {1, 1});
               });
  // Places are not quite where the map has them.
  double per_m = 0;
  for (const CertifiedTexture::Axis& axis : texture->axes())
    per_m =
        std::max(per_m, root(squared(axis.per_m[0]) + squared(axis.per_m[1]) + squared(axis.per_m[2])).hi());
  const double change = std::min(texture->change(per_m * facet.place_off_m * (1 + slack)), range.hi);
  cells = 1;
  add(polygon, nullptr, {-change, change});
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

RefractedReference certify_refracted_echo(const StraightenedBed& bed, const RayEnclosure& rays,
                                          const History& history, const VisibilityOptions& options,
                                          std::span<const std::uint32_t> beam_of_tube,
                                          const RangeSamples& samples, const EchoLaw& law,
                                          const Echo& ordinary, double tolerance) {
  if (options.arithmetic == Arithmetic::plain_double)
    throw std::invalid_argument("a reference needs an exact arithmetic: fixed, filtered or rational");
  const Asked asked{law,
                    certified_textures(law),
                    sample_borders_m(samples),
                    reference_targets(ordinary, tolerance),
                    samples.step_m,
                    tolerance,
                    Ball(law.absorption_db_per_m) * log(Ball(10)) / Ball(10)};
  if (law.path.out.facet_map.empty() &&
      std::ranges::any_of(asked.textures, [](const auto& texture) { return texture != nullptr; }))
    throw std::invalid_argument("a micro-texture is that of where facets lie: it takes their maps");
  const FacetMesh& apparent = bed.mesh();
  const std::vector<double>& borders = asked.borders;
  const auto row = std::size_t(samples.count);
  const ApparentEnclosures enclosures = enclose(bed, rays, law);
  const UncertainEdges edges(apparent, bed.parent, enclosures);
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
    see(apparent, bed.tree, tubes, tube, options, visibility, seen);
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
    const std::vector<FacetId> nearby = looked.in(sector, bed.tree);
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
      add_piece({polygon, facet, piece.facet, tube, beam_of_tube[tube]}, asked, bins);
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
    const std::vector<double> targets = reference_targets(least, tolerance);
    for (std::size_t bin = 0; bin < total.size(); ++bin)
      if (finite.bound[bin] > targets[bin]) excess.push_back(finite.bound[bin] / targets[bin]);
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
