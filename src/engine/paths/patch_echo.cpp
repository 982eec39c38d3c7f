// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/paths/patch_echo.hpp"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <tuple>

#include "engine/law/density.hpp"
#include "geometry/steps/stop.hpp"

namespace tubefoot {
namespace {

/// Longest part, over its distance from the nearer end.
constexpr double largest_angle = 0.125;
/// How far the lines of equal path may be from straight, in samples.
constexpr double most_bent = 0.1;
/// Near the point parts need not be smaller than this, over `longest_m`: it stands for a patch of that size.
constexpr double smallest_part = 1.0 / 16;
/// How far the phase between two receivers may turn over a part: its mean then is a thousandth too large.
constexpr double most_turned_rad = 0.15;

double cross(glm::dvec2 a, glm::dvec2 b) { return a.x * b.y - a.y * b.x; }

/// Twice the area.
double turning(const std::vector<glm::dvec2>& polygon) {
  double sum = 0;
  for (std::size_t k = 2; k < polygon.size(); ++k)
    sum += cross(polygon[k - 1] - polygon[0], polygon[k] - polygon[0]);
  return sum;
}

/// Parts of a convex polygon where a linear function is negative and where it is not.
template <class Value>
void split(const std::vector<glm::dvec2>& polygon, const Value& value, std::vector<glm::dvec2>* negative,
           std::vector<glm::dvec2>* positive) {
  if (negative != nullptr) negative->clear();
  if (positive != nullptr) positive->clear();
  if (polygon.empty()) return;
  glm::dvec2 from = polygon.back();
  double before = value(from);
  for (const glm::dvec2 to : polygon) {
    const double after = value(to);
    if ((before < 0) != (after < 0)) {
      const glm::dvec2 between = from + before / (before - after) * (to - from);
      if (negative != nullptr) negative->push_back(between);
      if (positive != nullptr) positive->push_back(between);
    }
    if (after < 0) {
      if (negative != nullptr) negative->push_back(to);
    } else if (positive != nullptr) {
      positive->push_back(to);
    }
    from = to;
    before = after;
  }
}

std::pair<glm::dvec2, glm::dvec2> box_of(const std::vector<glm::dvec2>& polygon) {
  glm::dvec2 low = polygon.front(), high = low;
  for (const glm::dvec2 p : polygon) {
    low = glm::min(low, p);
    high = glm::max(high, p);
  }
  return {low, high};
}

}  // namespace

HeardFacets::HeardFacets(const Image& heard, glm::dvec3 apex_m, SeenBed bed)
    : image_(heard), apex_m_(apex_m), bent_(std::move(bed.bent)) {
  const SharedFootprints& seen = bed.shared;
  const auto number_of = [&](const SharedFacet& facet) { return std::size_t(&facet - seen.facets.data()); };
  std::vector<const SharedFacet*> by_facet;
  for (const SharedFacet& facet : seen.facets) by_facet.push_back(&facet);
  std::stable_sort(by_facet.begin(), by_facet.end(),
                   [](const SharedFacet* a, const SharedFacet* b) { return a->facet < b->facet; });
  for (const SharedFacet* one : by_facet) {
    const BentFacet* bent = bent_.empty() ? nullptr : &bent_[number_of(*one)];
    const FacetPlane plane = bent == nullptr
                                 ? FacetPlane{one->plane_normal, one->transmit_distance_m}
                                 : FacetPlane{bent->normal, -glm::dot(bent->normal, bent->lies.lies_m)};
    // Bent rays may come to both sides of a facet.
    std::size_t at = facets_.size();
    while (at > 0 && facets_[at - 1].facet == one->facet &&
           !(bent == nullptr || glm::dot(facets_[at - 1].plane.normal, plane.normal) > 0))
      --at;
    if (at == 0 || facets_[at - 1].facet != one->facet) {
      facets_.push_back({one->facet, plane, PlaneFrame(plane), {}});
      at = facets_.size();
    }
    Facet& facet = facets_[at - 1];
    for (std::uint32_t k = one->first_piece; k < one->first_piece + one->piece_count; ++k) {
      const SharedPiece& from = seen.pieces[k];
      Piece piece;
      piece.tube = from.transmit_tube;
      piece.seen_as = number_of(*one);
      for (std::uint32_t c = 0; c < from.count; ++c) {
        const glm::dvec3 corner = seen.corners_m[from.first + c];
        piece.corners.push_back(facet.frame.project(bent == nullptr ? corner : bent->lies.at(corner)));
      }
      const double area = turning(piece.corners);
      if (area == 0) continue;
      if (area < 0) std::reverse(piece.corners.begin(), piece.corners.end());
      std::tie(piece.low, piece.high) = box_of(piece.corners);
      facet.pieces.push_back(std::move(piece));
    }
  }
}

const HeardFacets::Facet* HeardFacets::find(FacetId facet, glm::dvec3 normal) const {
  for (auto at = std::lower_bound(facets_.begin(), facets_.end(), facet,
                                  [](const Facet&a, FacetId b) { return a.facet < b; });
       at != facets_.end() && at->facet == facet; ++at)
    if (glm::dot(at->plane.normal, normal) > 0) return &*at;
  return nullptr;
}

PatchEcho::PatchEcho(const EchoLaw& law, const ReceiveBeams& beams, double longest_m)
    : law_(law),
      beams_(beams),
      longest_m_(longest_m),
      beta_(absorption_per_m(law.absorption_db_per_m)),
      levels_(1) {}

void PatchEcho::bend(Over& end, const BentFacet& facet, glm::dvec3 from_heard_m) const {
  const FacetPlane& plane = facet_->plane;
  end.bent = &facet;
  end.lies.foot_m = -plane.distance_m * plane.normal - from_heard_m;
  end.lies.u = facet_->frame.u;
  end.lies.v = facet_->frame.v;
  end.seen.foot_m = facet.seen.at(end.lies.foot_m);
  end.seen.u = facet.seen.linear * end.lies.u;
  end.seen.v = facet.seen.linear * end.lies.v;
}

PatchEcho::Met PatchEcho::meet(const Over& end, glm::dvec2 p) const {
  Met met;
  if (end.bent != nullptr) {
    const glm::dvec3 seen = end.seen.at(p);
    met.lies_m = end.lies.at(p);
    met.range = glm::length(seen);
    met.direction = seen / met.range;
    const BentFacet::Ray ray = end.bent->ray_to(met.lies_m);
    met.sine = end.bent->sine(seen, ray);
    met.out = ray.out;
    met.home = ray.home;
    return met;
  }
  const glm::dvec2 away = p - end.foot;
  met.range = std::sqrt(end.height * end.height + glm::dot(away, away));
  met.sine = end.height / met.range;
  met.lies_m = -end.height * facet_->plane.normal + away.x * facet_->frame.u + away.y * facet_->frame.v;
  met.direction = met.lies_m / met.range;
  return met;
}

std::size_t PatchEcho::add(const SeenBed& bed, const Point& point, const Listener& heard, glm::dvec3 local_m,
                           const RangeSamples& samples, double borders_m, SparseEnergy& out) {
  const SharedFootprints& seen = bed.shared;
  point_ = &point;
  heard_ = &heard;
  samples_ = samples;
  borders_m_ = borders_m;
  out_ = &out;
  lit_ = upper_ = lower_ = {};
  upper_.image = &heard.image();
  upper_.at_m = local_m + heard.upper.apex_m();
  if (heard.lower) {
    lower_.image = &heard.lower->image();
    lower_.at_m = local_m + heard.lower->apex_m();
  }
  const glm::dvec3 from_heard = point.at_m - heard.upper.apex_m();
  std::size_t met = 0;
  Polygon source;
  for (const SharedFacet& facet : seen.facets) {
    const BentFacet* bent = bed.bent_of(facet);
    const glm::dvec3 side = bent != nullptr ? bent->normal : facet.plane_normal;
    facet_ = heard.upper.find(facet.facet, side);
    if (facet_ == nullptr) continue;
    const HeardFacets::Facet* lower = heard.lower ? heard.lower->find(facet.facet, side) : nullptr;
    if (heard.lower && lower == nullptr) continue;
    const std::uint16_t material = law_.material[facet.facet];
    scattering_ = law_.law_of(facet.facet);
    mu_ = scattering_ == nullptr ? law_.material_mu[material] : 1;
    if (mu_ == 0) continue;
    texture_ = law_.texture(facet.facet);
    lit_.height = facet.transmit_distance_m;
    lit_.foot = facet_->frame.project(from_heard);
    if (bent != nullptr) bend(lit_, *bent, from_heard);
    upper_.height = facet_->plane.distance_m;
    if (lower != nullptr) {
      lower_.height = lower->plane.distance_m;
      lower_.foot = facet_->frame.project(heard.lower->apex_m() - heard.upper.apex_m());
    }
    for (std::uint32_t k = facet.first_piece; k < facet.first_piece + facet.piece_count; ++k) {
      stop_if_wanted();
      const SharedPiece& piece = seen.pieces[k];
      source.clear();
      for (std::uint32_t c = 0; c < piece.count; ++c)
        source.push_back(
            facet_->frame.project((bent != nullptr ? bent->lies.at(seen.corners_m[piece.first + c])
                                                   : seen.corners_m[piece.first + c]) +
                                  from_heard));
      const auto [low, high] = box_of(source);
      for (const HeardFacets::Piece& other : facet_->pieces) {
        if (low.x > other.high.x || low.y > other.high.y || other.low.x > high.x || other.low.y > high.y)
          continue;
        own_tube_ = upper_.image->own_tube[other.tube];
        if (!beams_.fan_of_receive_tube.empty() && beams_.fan_of_receive_tube[own_tube_] != point.fan)
          continue;
        levels_[0] = source;
        clip(other.corners, levels_[0]);
        if (levels_[0].size() < 3) continue;
        if (const BentFacet* back = heard.upper.bent_of(other)) bend(upper_, *back, glm::dvec3(0));
        if (lower == nullptr) {
          ++met;
          halve(0);
          continue;
        }
        common_ = levels_[0];
        for (const HeardFacets::Piece& third : lower->pieces) {
          both_.clear();
          for (const glm::dvec2 corner : third.corners) both_.push_back(from_lower(*lower, corner));
          if (turning(both_) < 0) std::reverse(both_.begin(), both_.end());
          levels_[0] = common_;
          clip(both_, levels_[0]);
          if (levels_[0].size() < 3) continue;
          ++met;
          halve(0);
        }
      }
    }
  }
  return met;
}

void PatchEcho::clip(const std::vector<glm::dvec2>& by, Polygon& polygon) {
  for (std::size_t c = 0; c < by.size() && polygon.size() > 2; ++c) {
    const glm::dvec2 a = by[c], along = by[c + 1 == by.size() ? 0 : c + 1] - a;
    split(
        polygon, [&](glm::dvec2 p) { return cross(along, p - a); }, nullptr, &rest_);
    std::swap(polygon, rest_);
  }
}

glm::dvec2 PatchEcho::from_lower(const HeardFacets::Facet& lower, glm::dvec2 corner) const {
  return lower_.foot + facet_->frame.project(corner.x * lower.frame.u + corner.y * lower.frame.v);
}

double PatchEcho::fringe_rad_a_m(glm::dvec2 centre) const {
  return heard_->wavenumber_rad_m * glm::length((centre - upper_.foot) / upper_.range(centre) -
                                                (centre - lower_.foot) / lower_.range(centre));
}

void PatchEcho::halve(std::size_t level) {
  if (levels_[level].size() < 3) return;
  const auto [low, high] = box_of(levels_[level]);
  const glm::dvec2 size = high - low, centre = (low + high) * 0.5;
  const double diameter = glm::length(size);
  const double rt = lit_.range(centre), rr = upper_.range(centre), half = (rt + rr) / 2;
  // A half path changes by no more than the way, and that of the other end of a staff is no further off.
  const double off = diameter / 2 + glm::length(heard_->arm_m) / 2;
  if (half + off < samples_.first_m || half - off >= samples_.first_m + samples_.step_m * samples_.count)
    return;
  const bool turned = heard_->lower && fringe_rad_a_m(centre) * diameter > most_turned_rad;
  const bool small =
      !turned && (diameter <= smallest_part * longest_m_ ||
                  (diameter <= longest_m_ && diameter <= largest_angle * std::min(rt, rr) &&
                   diameter * diameter * (1 / rt + 1 / rr) / 16 <= most_bent * samples_.step_m));
  if (small) return cut_into_samples(levels_[level], centre);
  if (levels_.size() < level + 3) levels_.resize(level + 3);
  const int axis = size.x >= size.y ? 0 : 1;
  split(
      levels_[level], [&](glm::dvec2 p) { return p[axis] - centre[axis]; }, &levels_[level + 1],
      &levels_[level + 2]);
  halve(level + 2);
  halve(level + 1);  // may overwrite the other, which is done
}

void PatchEcho::cut_into_samples(const Polygon& polygon, glm::dvec2 centre) {
  const double rt = lit_.range(centre), rr = upper_.range(centre);
  const double per_step = 1 / samples_.step_m;
  double middle = ((rt + rr) / 2 - samples_.first_m) * per_step;
  glm::dvec2 gradient = (lit_.slope(centre, rt) + upper_.slope(centre, rr)) * (0.5 * per_step);
  const double other = heard_->lower ? lower_.range(centre) : rr;
  const double lower_middle = middle + (other - rr) / 2 * per_step;
  const glm::dvec2 lower_gradient =
      heard_->lower ? (lit_.slope(centre, rt) + lower_.slope(centre, other)) * (0.5 * per_step) : gradient;
  if (heard_->lower && borders_m_ > 0) {
    middle = (middle + lower_middle) / 2;
    gradient = (gradient + lower_gradient) * 0.5;
  }
  const auto take_part = [&](const Polygon& part, double sample) {
    if (!heard_->lower || borders_m_ > 0) return take(part, sample);
    cut_for_both(part, sample, lower_middle, lower_gradient, centre);
  };
  double least = middle, most = middle;
  for (std::size_t k = 0; k < polygon.size(); ++k) {
    const double here = middle + glm::dot(gradient, polygon[k] - centre);
    least = k == 0 ? here : std::min(least, here);
    most = k == 0 ? here : std::max(most, here);
  }
  const double first = std::floor(least), last = std::floor(most);
  if (first == last) return take_part(polygon, first);
  rest_ = polygon;
  for (double sample = first; sample < last && rest_.size() > 2; ++sample) {
    split(
        rest_, [&](glm::dvec2 p) { return middle + glm::dot(gradient, p - centre) - (sample + 1); }, &below_,
        &above_);
    take_part(below_, sample);
    std::swap(rest_, above_);
  }
  take_part(rest_, last);
}

/// What of a sample of the upper receiver's lies in the same one of the lower's.
void PatchEcho::cut_for_both(const Polygon& polygon, double sample, double middle, glm::dvec2 gradient,
                             glm::dvec2 centre) {
  const auto place = [&](glm::dvec2 p) { return middle + glm::dot(gradient, p - centre) - sample; };
  split(polygon, place, nullptr, &before_);
  split(
      before_, [&](glm::dvec2 p) { return place(p) - 1; }, &both_, nullptr);
  take(both_, sample);
}

void PatchEcho::take(const Polygon& polygon, double sample) {
  if (polygon.size() < 3 || !(sample >= 0 && sample < samples_.count)) return;
  double area = 0;
  glm::dvec2 centroid(0);
  for (std::size_t k = 2; k < polygon.size(); ++k) {
    const glm::dvec2 a = polygon[k - 1] - polygon[0], b = polygon[k] - polygon[0];
    const double part = cross(a, b);
    area += part;
    centroid += part * (a + b);
  }
  if (area == 0) return;
  const glm::dvec2 p = polygon[0] + centroid / (3 * area);
  const Met sent = meet(lit_, p);
  const double lobe = scattering_lobe(point_->scattering, glm::dot(sent.direction, point_->axis));
  if (lobe == 0) return;
  glm::dvec3 true_back{0};
  const auto energy_by = [&](const Over& receiver) {
    const Met home = meet(receiver, p);
    const double sigma =
        mu_ * scattering_lobe(scattering_, sent.sine) * scattering_lobe(scattering_, home.sine);
    double energy = density(sigma, Way<double>::of(sent.range, home.range), beta_) * (std::abs(area) / 2) *
                    lobe * point_->loss.at(sent.direction) * receiver.image->leg.loss.at(home.direction) *
                    sent.out * home.home;
    if (texture_ != nullptr) energy *= texture_->factor(receiver.at_m + home.lies_m);
    true_back = receiver.image->leg.to_true * home.direction;
    return heard_->row ? energy * law_.patterns->receive.front().gain(true_back) : energy;
  };
  const double energy = energy_by(upper_);
  if (heard_->lower) return take_product(sample, p, energy, energy_by(lower_));
  const auto bin = [&](std::size_t beam) { return beam * std::size_t(samples_.count) + std::size_t(sample); };
  if (heard_->row) return out_->add(bin(*heard_->row), energy);
  if (law_.patterns == nullptr) return out_->add(bin(beams_.of_tube[own_tube_]), energy);
  const auto [begin, end] = law_.patterns->beams_of_tube[own_tube_];
  for (std::uint32_t beam = begin; beam < end; ++beam)
    out_->add(bin(beam), energy * law_.patterns->receive[beam].gain(true_back));
}

void PatchEcho::take_product(double sample, glm::dvec2 p, double upper, double lower) {
  const glm::dvec3 at = heard_->upper.apex_m() - upper_.height * facet_->plane.normal +
                        p.x * facet_->frame.u + p.y * facet_->frame.v;
  // (upper^2 - lower^2) / (upper + lower) of the ranges: no cancellation where the staff is short.
  const double further =
      -2 * glm::dot(at - heard_->middle_m, heard_->arm_m) / (upper_.range(p) + lower_.range(p));
  double size = std::sqrt(upper * lower);
  if (borders_m_ > 0) size *= std::max(1 - std::abs(further) / 2 / borders_m_, 0.0);
  const std::size_t bin = std::size_t(*heard_->row) * std::size_t(samples_.count) + std::size_t(sample);
  out_->add(bin, size * std::cos(heard_->wavenumber_rad_m * further));
  out_->add(bin + std::size_t(samples_.count), size * std::sin(heard_->wavenumber_rad_m * further));
}

}  // namespace tubefoot
