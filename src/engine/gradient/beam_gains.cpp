// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/gradient/beam_gains.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <stdexcept>

#include "engine/echo/path_on_facet.hpp"
#include "geometry/numbers/scalars.hpp"

namespace tubefoot {
namespace {

/// Below this number of beams, one row per beam is faster than powers.
constexpr std::uint32_t least_beams = 24;

}  // namespace

BeamGains::BeamGains(const BeamPatterns* patterns, const ReceiveBeams& beams, std::span<const double> weights,
                     std::size_t bins, double tolerance)
    : patterns_(patterns), beams_(beams), weights_(weights), bins_(bins), tolerance_(tolerance) {
  if (patterns == nullptr) return;
  bool fits = patterns->receive.size() == std::size_t(beams.count) &&
              patterns->fan_of_tube.size() == beams.of_tube.size() &&
              patterns->beams_of_tube.size() == beams.of_tube.size() &&
              (patterns->least.empty() || patterns->least.size() == patterns->receive.size());
  for (const std::uint32_t fan : patterns->fan_of_tube) fits = fits && fan < patterns->transmit.size();
  for (const auto& [first, end] : patterns->beams_of_tube)
    fits = fits && first <= end && end <= std::uint32_t(beams.count);
  if (!fits) throw std::invalid_argument("gradient: the beam patterns belong to other beams or other tubes");
  if (!patterns->baselines.empty())
    throw std::invalid_argument(
        "gradient: the signals of a receiver pair have no gradient: use one receiver");
}

void BeamGains::select(std::uint32_t tube, std::span<const glm::dvec3> corners_m) {
  if (tube >= beams_.of_tube.size() || beams_.of_tube[tube] >= std::uint32_t(beams_.count))
    throw std::invalid_argument("gradient: a tube has no beam");
  std::pair<std::uint32_t, std::uint32_t> received{beams_.of_tube[tube], beams_.of_tube[tube] + 1};
  std::uint32_t fan = 0;
  if (patterns_ != nullptr) {
    received = patterns_->beams_of_tube[tube];
    fan = patterns_->fan_of_tube[tube];
  }
  if (receiver_ == nullptr || first_ != received.first || end_ != received.second || fan_ != fan) {
    first_ = received.first;
    end_ = received.second;
    fan_ = fan;
    receiver_ = &receiver_of(fan);
    held_ = {};
    held_sum_ = nullptr;
  }
  panels_.clear();
  if (receiver_->gains && !weighted()) find_panels(corners_m);
}

BeamGains::Receiver& BeamGains::receiver_of(std::uint32_t fan) {
  const auto [place, fresh] = known_.try_emplace({fan, first_, end_});
  Receiver& receiver = place->second;
  if (!fresh) return receiver;
  receiver.first = first_;
  receiver.end = end_;
  if (patterns_ == nullptr) return receiver;
  Smoothness all;
  for (const Directivity& sent : patterns_->transmit[fan].beams)
    for (std::uint32_t beam = first_; beam < end_; ++beam) all.take(sent, patterns_->receive[beam]);
  receiver.smooth = {all.angle_rad, all.tables, {}};
  std::vector<Cone>& kinks = receiver.smooth.kinks;
  const auto add_kinks = [&](const Directivity& pattern) {
    if (pattern.kind != Directivity::Kind::table || kinks.size() > most_kinks) return;
    for (const double angle : pattern.table->borders())
      kinks.push_back(
          {pattern.axis, pattern.from_axis ? std::cos(angle) : std::sin(angle + std::asin(pattern.centre))});
  };
  for (const Directivity& sent : patterns_->transmit[fan].beams) add_kinks(sent);
  for (std::uint32_t beam = first_; beam < end_; ++beam) add_kinks(patterns_->receive[beam]);
  if (kinks.size() > most_kinks) kinks.clear();
  add_common_axis(receiver);
  return receiver;
}

/// Prepares polynomials if all receive beams are line arrays on one axis.
void BeamGains::add_common_axis(Receiver& receiver) const {
  if (end_ - first_ < least_beams || !patterns_->least.empty()) return;
  const std::span<const Directivity> all = std::span(patterns_->receive).subspan(first_, end_ - first_);
  double angle = 1;
  for (const Directivity& beam : all) {
    if (beam.kind != Directivity::Kind::line || beam.axis != all.front().axis) return;
    angle = std::min(angle, resolution_of([&](double y) { return beam.growth(y); }));
  }
  receiver.axis = all.front().axis;
  receiver.gains = std::make_unique<GainPanels>(
      all.size(),
      [all](double cosine, std::span<double> values) {
        for (std::size_t b = 0; b < all.size(); ++b) values[b] = all[b].gain_at(cosine);
      },
      angle, std::clamp(tolerance_ / 10, 1e-13, 1e-8));
}

/// Finds the panels that contain the cosines of a polygon. A cap about the mean of the corners contains a
/// convex polygon.
void BeamGains::find_panels(std::span<const glm::dvec3> corners_m) {
  glm::dvec3 middle(0);
  for (const glm::dvec3& corner : corners_m) middle += glm::normalize(corner);
  middle = glm::normalize(middle);
  double cap = 0;
  const auto angle_of = [&](glm::dvec3 a, glm::dvec3 b) {
    return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b));
  };
  for (const glm::dvec3& corner : corners_m) cap = std::max(cap, angle_of(middle, corner));
  const double to_axis = angle_of(middle, receiver_->axis);
  const double lowest = std::cos(std::min(to_axis + cap, pi)) - 1e-9,
               highest = std::cos(std::max(to_axis - cap, 0.0)) + 1e-9;
  const std::size_t most = (end_ - first_) / GainPanels::terms;
  for (double from = lowest; from <= highest; from = panels_.back().panel.hi) {
    if (panels_.size() == most) return panels_.clear();
    const std::uint32_t number = receiver_->gains->find(from);
    panels_.push_back({number, receiver_->gains->panel(number)});
  }
}

bool BeamGains::are_zero(std::size_t first_bin, std::size_t end_bin) const {
  for (std::uint32_t beam = first_; weighted() && beam < end_; ++beam)
    for (std::size_t bin = first_bin; bin < end_bin; ++bin)
      if (weights_[beam * bins_ + bin] != 0) return false;
  return weighted() || first_ == end_;
}

double BeamGains::weighted_sum(double cosine, std::size_t bin) {
  GainPanels& gains = *receiver_->gains;
  const bool same = held_sum_ != nullptr && cosine >= held_.panel.lo && cosine < held_.panel.hi;
  if (!same) {
    held_.number = gains.find(cosine);
    held_.panel = gains.panel(held_.number);
  }
  if (!same || held_bin_ != bin) {
    const auto [place, fresh] = receiver_->sums.try_emplace(std::uint64_t(held_.number) << 32 | bin);
    if (fresh) {
      place->second.fill(0);
      for (std::uint32_t beam = first_; beam < end_; ++beam) {
        const double weight = weights_[beam * bins_ + bin];
        const double* own = gains.coefficients(held_.number, beam - first_);
        for (std::size_t k = 0; k < place->second.size(); ++k) place->second[k] += weight * own[k];
      }
    }
    held_sum_ = &place->second;
    held_bin_ = bin;
  }
  const double x = (cosine - held_.panel.middle) * held_.panel.per_half;
  double sum = 0;
  for (std::size_t k = held_sum_->size(); k-- > 0;) sum = sum * x + (*held_sum_)[k];
  return sum;
}

void BeamGains::at(glm::dvec3 direction, std::size_t bin, std::span<double> gains) {
  const double sent = patterns_ == nullptr ? 1 : patterns_->transmit[fan_].gain(direction);
  if (receiver_->gains && weighted()) {
    gains[0] = sent * weighted_sum(glm::dot(direction, receiver_->axis), bin);
    return;
  }
  if (!panels_.empty()) {
    const double cosine = glm::dot(direction, receiver_->axis);
    std::fill(gains.begin(), gains.end(), 0.0);
    std::size_t number = 0;
    while (number + 1 < panels_.size() && cosine >= panels_[number].panel.hi) ++number;
    const double x = (cosine - panels_[number].panel.middle) * panels_[number].panel.per_half;
    double power = sent;
    for (std::size_t k = 0; k < std::size_t(GainPanels::terms); ++k, power *= x)
      gains[number * std::size_t(GainPanels::terms) + k] = power;
    return;
  }
  double sum = 0;
  for (std::uint32_t beam = first_; beam < end_; ++beam) {
    const double weight = weighted() ? weights_[beam * bins_ + bin] : 1;
    if (weighted() && weight == 0) continue;
    double gain = patterns_ == nullptr ? 1 : sent * patterns_->receive[beam].gain(direction);
    if (patterns_ != nullptr && !patterns_->receives(beam, gain)) gain = 0;
    if (weighted())
      sum += weight * gain;
    else
      gains[beam - first_] = gain;
  }
  if (weighted()) gains[0] = sum;
}

RowSums::Row RowSums::row(std::size_t number) {
  if (gains_.panels_.empty()) return {sums_.data() + (gains_.first_beam() + number) * gains_.bins_, 1};
  constexpr auto terms = std::size_t(GainPanels::terms);
  auto& panels = powers_[gains_.receiver_];
  const std::uint32_t panel = gains_.panels_[number / terms].number;
  if (panel >= panels.size()) panels.resize(panel + 1);
  if (panels[panel].empty()) panels[panel].assign(gains_.bins_ * terms, 0);
  return {panels[panel].data() + number % terms, terms};
}

void RowSums::finish() {
  constexpr auto terms = std::size_t(GainPanels::terms);
  for (const auto& [receiver, panels] : powers_)
    for (std::size_t panel = 0; panel < panels.size(); ++panel)
      for (std::size_t bin = 0; bin * terms < panels[panel].size(); ++bin) {
        const std::span<const double> powers = std::span(panels[panel]).subspan(bin * terms, terms);
        if (std::ranges::all_of(powers, [](double x) { return x == 0; })) continue;
        for (std::uint32_t beam = receiver->first; beam < receiver->end; ++beam) {
          const double* own = receiver->gains->coefficients(std::uint32_t(panel), beam - receiver->first);
          double sum = 0;
          for (std::size_t k = 0; k < terms; ++k) sum += own[k] * powers[k];
          sums_[beam * gains_.bins_ + bin] += sum;
        }
      }
  powers_.clear();
}

}  // namespace tubefoot
