// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/paths/patch_echo.hpp"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <tuple>

#include "engine/scattering/density.hpp"
#include "engine/scattering/pair_density.hpp"
#include "geometry/numbers/scalars.hpp"
#include "geometry/steps/stop.hpp"

// Integrates the last scattering of a path over polygons that a point and a receiver both see. The polygons
// are halved until they are small, then cut along straight lines of equal path. Source:
// docs/notes/multiple-paths.md, "Several scatterings".

namespace tubefoot {
namespace {

/// Largest ratio of the length of a part to its distance from the nearer end.
constexpr double largest_angle = 0.125;
/// Largest error of straight lines of equal path, in samples.
constexpr double most_curved = 0.1;
/// Smallest part near the point, relative to `longest_m`. Smaller parts are useless, because the point
/// represents a patch of about that size.
constexpr double smallest_part = 1.0 / 16;
/// Largest change over a part of the phase between two receivers. The mean is then too large by a
/// thousandth.
constexpr double most_turned_rad = 0.15;

/// Splits a convex polygon into the parts in which a linear function is negative and non-negative.
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

PatchEcho::PatchEcho(const EchoModel& model, const ReceiveBeams& beams, double longest_m,
                     std::span<const double> least_received)
    : model_(model),
      beams_(beams),
      longest_m_(longest_m),
      beta_(absorption_per_m(model.absorption_db_per_m)),
      least_received_(least_received),
      levels_(1) {}

std::size_t PatchEcho::add(const VisibleSurface& seabed, const Point& point, const ImageReceiver& received,
                           glm::dvec3 local_m, const RangeSamples& samples, double borders_m,
                           SparseEnergy& energy) {
  const SharedFootprints& seen = seabed.shared;
  point_ = &point;
  received_ = &received;
  local_m_ = local_m;
  samples_ = samples;
  borders_m_ = borders_m;
  energy_ = &energy;
  const std::vector<ReceiverViews::End>& ends = received.receives.ends();
  const glm::dvec3 received_at = ends.front().apex_m, from_received = point.at_m - received_at;
  std::size_t met = 0;
  Polygon source;
  for (const SharedFacet& shared : seen.facets) {
    const RefractedFacet* refracted = seabed.refracted_of(shared);
    const ReceiverViews::Facet* facet =
        received.receives.find(shared.facet, refracted != nullptr ? refracted->normal : shared.plane_normal);
    if (facet == nullptr) continue;
    scattering_ = model_.model_of(shared.facet);
    mu_ = scattering_ == nullptr ? model_.material_mu[model_.material[shared.facet]] : 1;
    if (mu_ == 0) continue;
    texture_ = model_.texture(shared.facet);
    lit_ = OverFacet(*facet, from_received, shared.transmit_distance_m, refracted);
    for (std::uint32_t k = shared.first_piece; k < shared.first_piece + shared.piece_count; ++k) {
      stop_if_wanted();
      const SharedPiece& piece = seen.pieces[k];
      source.clear();
      for (std::uint32_t c = 0; c < piece.count; ++c)
        source.push_back(
            facet->frame.project((refracted != nullptr ? refracted->lies.at(seen.corners_m[piece.first + c])
                                                       : seen.corners_m[piece.first + c]) +
                                 from_received));
      const auto [low, high] = box_of(source);
      for (const ReceiverViews::Piece& other : facet->pieces) {
        if (low.x > other.high.x || low.y > other.high.y || other.low.x > high.x || other.low.y > high.y)
          continue;
        own_tube_ = received.receives.image().own_tube[other.tube];
        if (!beams_.fan_of_receive_tube.empty() && beams_.fan_of_receive_tube[own_tube_] != point.fan)
          continue;
        levels_[0] = source;
        for (const Polygon& by : other.seen) clip(by, levels_[0]);
        if (levels_[0].size() < 3) continue;
        for (std::size_t end = 0; end < ends.size(); ++end)
          rx_[end] = OverFacet(*facet, ends[end].apex_m - received_at, facet->height_m[end],
                               received.receives.refracted_of(other, end));
        ++met;
        halve(0);
      }
    }
  }
  return met;
}

void PatchEcho::clip(const std::vector<glm::dvec2>& by, Polygon& polygon) {
  for (std::size_t c = 0; c < by.size() && polygon.size() > 2; ++c) {
    const glm::dvec2 a = by[c], along = by[c + 1 == by.size() ? 0 : c + 1] - a;
    const auto inward = [&](glm::dvec2 p) { return cross(along, p - a); };
    if (std::ranges::all_of(polygon, [&](glm::dvec2 p) { return inward(p) >= 0; })) continue;
    split(polygon, inward, nullptr, &rest_);
    std::swap(polygon, rest_);
  }
}

double PatchEcho::phase_rad_per_m(glm::dvec2 centre) const {
  return received_->wavenumber_rad_m *
         glm::length(rx_[0].slope(centre, rx_[0].range(centre)) - rx_[1].slope(centre, rx_[1].range(centre)));
}

void PatchEcho::halve(std::size_t level) {
  if (levels_[level].size() < 3) return;
  const auto [low, high] = box_of(levels_[level]);
  const glm::dvec2 size = high - low, centre = (low + high) * 0.5;
  const double diameter = glm::length(size);
  const double rt = lit_.range(centre), rr = rx_[0].range(centre), half = (rt + rr) / 2;
  // Half paths over the part differ from that at its centre by at most `steepest` * diameter / 2. The other
  // end of a receiver pair adds at most half the length of the pair.
  const double steepest = (lit_.steepest() + rx_[0].steepest()) / 2,
               off = steepest * diameter / 2 + glm::length(received_->arm_m) / 2;
  if (half + off < samples_.first_m || half - off >= samples_.first_m + samples_.step_m * samples_.count)
    return;
  const bool turned = received_->is_product() && phase_rad_per_m(centre) * diameter > most_turned_rad;
  const bool small =
      !turned && (diameter <= smallest_part * longest_m_ ||
                  (diameter <= longest_m_ && diameter <= largest_angle * std::min(rt, rr) &&
                   diameter * diameter * (1 / rt + 1 / rr) / 16 <= most_curved * samples_.step_m));
  if (small) return cut_into_samples(levels_[level], centre);
  if (levels_.size() < level + 3) levels_.resize(level + 3);
  const int axis = size.x >= size.y ? 0 : 1;
  split(
      levels_[level], [&](glm::dvec2 p) { return p[axis] - centre[axis]; }, &levels_[level + 1],
      &levels_[level + 2]);
  halve(level + 2);
  halve(level + 1);  // may overwrite level + 2, which is finished
}

void PatchEcho::cut_into_samples(const Polygon& polygon, glm::dvec2 centre) {
  const bool product = received_->is_product();
  const double rt = lit_.range(centre), rr = rx_[0].range(centre);
  const double per_step = 1 / samples_.step_m;
  double middle = ((rt + rr) / 2 - samples_.first_m) * per_step;
  glm::dvec2 gradient = (lit_.slope(centre, rt) + rx_[0].slope(centre, rr)) * (0.5 * per_step);
  const double other = product ? rx_[1].range(centre) : rr;
  const double lower_middle = middle + (other - rr) / 2 * per_step;
  const glm::dvec2 lower_gradient =
      product ? (lit_.slope(centre, rt) + rx_[1].slope(centre, other)) * (0.5 * per_step) : gradient;
  if (product && borders_m_ > 0) {
    middle = (middle + lower_middle) / 2;
    gradient = (gradient + lower_gradient) * 0.5;
  }
  const auto take_part = [&](const Polygon& part, double sample) {
    if (!product || borders_m_ > 0) return take(part, sample);
    cut_for_both(part, sample, lower_middle, lower_gradient, centre);
  };
  placed_.clear();
  double least = std::numeric_limits<double>::infinity(), most = -least;
  for (const glm::dvec2 p : polygon) {
    const double here = middle + glm::dot(gradient, p - centre);
    placed_.push_back({p, here});
    least = std::min(least, here);
    most = std::max(most, here);
  }
  const double first = std::floor(least), last = std::floor(most);
  if (first == last) return take_part(polygon, first);
  for (double sample = first; sample < last && placed_.size() > 2; ++sample) {
    const double border = sample + 1;
    below_.clear();
    left_.clear();
    Placed from = placed_.back();
    for (const Placed& to : placed_) {
      if ((from.sample < border) != (to.sample < border)) {
        const double part = (border - from.sample) / (to.sample - from.sample);
        const glm::dvec2 between = from.at + part * (to.at - from.at);
        below_.push_back(between);
        left_.push_back({between, border});
      }
      if (to.sample < border)
        below_.push_back(to.at);
      else
        left_.push_back(to);
      from = to;
    }
    take_part(below_, sample);
    placed_.swap(left_);
  }
  below_.clear();
  for (const Placed& p : placed_) below_.push_back(p.at);
  take_part(below_, last);
}

/// Takes the part of an upper receiver's sample that lies in the same sample of the lower receiver.
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
  const OverFacet::Met sent = lit_.meet(p);
  const double lobe = scattering_lobe(point_->scattering, glm::dot(sent.direction, point_->axis));
  if (lobe == 0) return;
  glm::dvec3 true_back{0};
  const auto energy_by = [&](std::size_t end) {
    const OverFacet::Met rx = rx_[end].meet(p);
    const ReceiverViews::End& receiver = received_->receives.ends()[end];
    const double sigma =
        mu_ * scattering_lobe(scattering_, sent.sine) * scattering_lobe(scattering_, rx.sine);
    double energy = density(sigma, TwoWayRange<double>::of(sent.range, rx.range), beta_) *
                    (std::abs(area) / 2) * lobe * point_->loss.at(sent.direction) *
                    receiver.image->leg.loss.at(rx.direction) * sent.tx * rx.rx;
    if (texture_ != nullptr) energy *= texture_->factor(local_m_ + receiver.apex_m + rx.lies_m);
    true_back = receiver.image->leg.to_true * rx.direction;
    return received_->row ? energy * gain_of(0, true_back) : energy;
  };
  const double energy = energy_by(0);
  if (received_->is_product()) return take_product(sample, p, energy, energy_by(1));
  const auto bin = [&](std::size_t beam) { return beam * std::size_t(samples_.count) + std::size_t(sample); };
  if (received_->row) return energy_->add(bin(*received_->row), energy);
  if (model_.patterns == nullptr) return energy_->add(bin(beams_.of_tube[own_tube_]), energy);
  const auto [begin, end] = model_.patterns->beams_of_tube[own_tube_];
  for (std::uint32_t beam = begin; beam < end; ++beam)
    energy_->add(bin(beam), energy * gain_of(beam, true_back));
}

double PatchEcho::gain_of(std::size_t beam, glm::dvec3 true_back) const {
  const double gain = model_.patterns->receive[beam].gain(true_back);
  return least_received_.empty() || gain >= least_received_[beam] ? gain : 0;
}

void PatchEcho::take_product(double sample, glm::dvec2 p, double upper, double lower) {
  LyingPlane seen = rx_[0].seen();
  seen.foot_m += received_->receives.ends().front().apex_m;
  const double further = range_difference(glm::dot(seen.at(p) - received_->middle_m, received_->arm_m),
                                          rx_[0].range(p) + rx_[1].range(p)),
               in_both = borders_m_ > 0 ? std::max(1 - std::abs(further) / 2 / borders_m_, 0.0) : 1;
  const auto product = PairDensity::of(upper, lower, received_->wavenumber_rad_m * further, in_both);
  const std::size_t bin = std::size_t(*received_->row) * std::size_t(samples_.count) + std::size_t(sample);
  energy_->add(bin, product.real);
  energy_->add(bin + std::size_t(samples_.count), product.imag);
}

}  // namespace tubefoot
