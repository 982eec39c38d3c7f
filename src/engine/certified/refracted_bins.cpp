// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/certified/refracted_bins.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>
#include <utility>

#include "engine/certified/certified_driver.hpp"
#include "geometry/numbers/enclosure_slack.hpp"
#include "geometry/numbers/scalars.hpp"

// Implements the bins, samples and selections that references in stratified water share. Launch directions
// of unproven rays are bounded by RayEnclosure::most_turn_rad() above and below the straight line.
namespace tubefoot {
namespace {

constexpr double upright = std::numbers::pi / 2;
using State = FacetEnclosure::State;

}  // namespace

std::pair<std::size_t, std::size_t> samples_between(std::span<const double> borders, double nearest_m,
                                                    double farthest_m) {
  const auto first = std::upper_bound(borders.begin(), borders.end(), nearest_m),
             end = std::upper_bound(borders.begin(), borders.end(), farthest_m);
  return {std::size_t(std::max<std::ptrdiff_t>(first - borders.begin() - 1, 0)),
          std::min(std::size_t(end - borders.begin()), borders.size() - 1)};
}

Looked::Looked(std::span<const FacetEnclosure> facets) : facets_(facets), balls_(facets.size()) {
  std::vector<double> gaps;
  for (FacetId f = 0; f < facets.size(); ++f) {
    const FacetEnclosure& facet = facets[f];
    if (facet.state == State::unproven) continue;
    gaps.push_back(facet.travel_path_error_m);
    const glm::dvec3 centre = (facet.seen[0] + facet.seen[1] + facet.seen[2]) / 3.0;
    double radius = 0;
    for (const glm::dvec3& c : facet.seen) radius = std::max(radius, glm::distance(c, centre));
    balls_[f] = {centre, radius * (1 + enclosure_slack) + facet.travel_path_error_m};
  }
  std::ranges::sort(gaps);
  // The tree finds the facets with small travel-path errors. The others are tested one by one.
  if (!gaps.empty())
    usual_travel_path_error_m_ = 4 * gaps[gaps.size() / 2], most_travel_path_error_m_ = gaps.back();
  for (FacetId f = 0; f < facets.size(); ++f)
    if (facets[f].state != State::unproven && facets[f].travel_path_error_m > usual_travel_path_error_m_)
      wide_.push_back(f);
}

std::vector<FacetId> Looked::in(const Sector& tube, const SceneTree& tree, double beside_rad) const {
  std::vector<FacetId> seen = tube.facets(tree, usual_travel_path_error_m_ + beside_rad * tube.reach_m());
  seen.insert(seen.end(), wide_.begin(), wide_.end());
  std::erase_if(seen, [&](FacetId f) {
    return facets_[f].state == State::unproven ||
           !tube.may_meet(balls_[f].first, balls_[f].second + beside_rad * facets_[f].farthest_m);
  });
  std::ranges::sort(seen);
  seen.erase(std::unique(seen.begin(), seen.end()), seen.end());
  return seen;
}

Unknown::Unknown(std::span<const FacetEnclosure> facets, const RayEnclosure& rays) : rays_(rays) {
  for (const FacetEnclosure& facet : facets) {
    Around about;
    about.centre_m = (facet.seen[0] + facet.seen[1] + facet.seen[2]) / 3.0;
    for (const glm::dvec3& c : facet.seen)
      about.radius_m = std::max(about.radius_m, glm::distance(c, about.centre_m) * (1 + enclosure_slack));
    about.nearest_m = facet.nearest_m;
    look_at(about);
    balls_.push_back(about);
  }
  std::ranges::sort(balls_, {}, &Around::nearest_m);
}

double Unknown::begins_m(const Sector& tube) const {
  for (const Around& ball : balls_)
    if (may_be_seen(ball, tube)) return ball.nearest_m;
  return infinite;
}

void Unknown::look_at(Around& ball) const {
  const glm::dvec3& two_way = ball.centre_m;
  const double range = glm::length(two_way), across = std::hypot(two_way.x, two_way.y);
  ball.anywhere = !(range > ball.radius_m);
  if (ball.anywhere) return;
  const double level = std::atan2(two_way.z, across),
               apart = std::asin(ball.radius_m / range) + rays_.most_turn_rad() + enclosure_slack,
               low = std::max(level - apart, -upright), high = std::min(level + apart, upright);
  DirectionBox& box = ball.launch;
  box.low_sine = std::sin(low);
  box.low_cosine = std::cos(low);
  box.high_sine = std::sin(high);
  box.high_cosine = std::cos(high);
  box.all_round = !(ball.radius_m < across) || level + apart > upright || level - apart < -upright;
  if (box.all_round) return;
  const double sine = ball.radius_m / across, cosine = std::sqrt((1 - sine) * (1 + sine));
  const glm::dvec2 towards = glm::dvec2(two_way) / across, left(-towards.y, towards.x);
  box.from = cosine * towards - sine * left;
  box.to = cosine * towards + sine * left;
}

bool Unknown::may_be_seen(const Around& ball, const Sector& tube) const {
  if (ball.anywhere) return true;
  const double range = glm::length(ball.centre_m) - ball.radius_m;
  return rays_.least_stretch() * range <= tube.reach_m() * (1 + enclosure_slack) &&
         tube.may_meet(ball.launch);
}

RefractedReference reference_between(std::span<const BinIntervals> parts, const Echo& ordinary,
                                     double tolerance) {
  std::vector<Interval> total(ordinary.energy.size());
  for (const BinIntervals& bins : parts)  // in order, so that the result does not depend on the threads
    for (const auto& [bin, part] : bins) {
      total[bin].lo += std::max(part.lo, 0.0);
      total[bin].hi += part.hi;
    }

  CertifiedEcho certified{ordinary, std::vector<double>(total.size())};
  for (std::size_t bin = 0; bin < total.size(); ++bin) {
    if (!std::isfinite(total[bin].hi)) {
      certified.bound[bin] = infinite;
      continue;
    }
    const double lo = total[bin].lo * (1 - enclosure_slack), hi = total[bin].hi * (1 + enclosure_slack);
    certified.echo.energy[bin] = lo + (hi - lo) / 2;
    certified.bound[bin] = (hi - lo) / 2 * (1 + enclosure_slack);
  }
  return reference_of(std::move(certified), tolerance);
}

RefractedReference reference_of(CertifiedEcho echo, double tolerance) {
  return reference_of(std::move(echo), tolerance, reference_targets);
}

RefractedReference reference_of(CertifiedEcho echo, double tolerance, const Targets& targets_of) {
  RefractedReference reference;
  reference.certified = std::move(echo);
  CertifiedEcho& certified = reference.certified;
  compare_with(certified, tolerance, targets_of);
  reference.bins = certified.bound.size();
  reference.bins_over = certified.bins_over;
  reference.unbounded = static_cast<std::size_t>(
      std::ranges::count_if(certified.bound, [](double bound) { return !std::isfinite(bound); }));
  if (reference.bins_over == reference.unbounded) return reference;
  std::vector<double> excess;
  Echo least = certified.echo;
  for (std::size_t bin = 0; bin < least.energy.size(); ++bin)
    least.energy[bin] = std::max(least.energy[bin] - certified.bound[bin], 0.0);
  const std::vector<double> targets = targets_of(least, tolerance);
  for (std::size_t bin = 0; bin < targets.size(); ++bin)
    if (std::isfinite(certified.bound[bin]) && certified.bound[bin] > targets[bin])
      excess.push_back(certified.bound[bin] / targets[bin]);
  const auto middle = excess.begin() + std::ssize(excess) / 2;
  std::nth_element(excess.begin(), middle, excess.end());
  reference.usual_excess = *middle;
  return reference;
}

}  // namespace tubefoot
