// SPDX-License-Identifier: GPL-3.0-or-later
// Sorts the patterns of a fan for PatternIntegrator: which patterns are functions of one cosine, and which
// gains are approximated by panels. Each thread keeps fitted gains for later pings.
#include <algorithm>
#include <functional>
#include <map>

#include "engine/echo/pattern_integral.hpp"

namespace tubefoot {
namespace {

using Kind = Directivity::Kind;

constexpr std::size_t fewest_for_moments = 3;  // number of beams; with fewer beams, separate gains cost less

bool is_uniform(const Directivity& pattern) { return pattern.kind == Kind::uniform; }

double growth_of(std::span<const Directivity> beams, double y) {
  double most = 0;
  for (const Directivity& beam : beams) most = std::max(most, beam.growth(y));
  return most;
}

/// Common axis of all patterns, if they have one.
std::optional<glm::dvec3> common_axis(std::span<const Directivity> beams) {
  std::optional<glm::dvec3> axis;
  for (const Directivity& beam : beams) {
    if (is_uniform(beam)) continue;
    if (axis && *axis != beam.axis) return std::nullopt;
    axis = beam.axis;
  }
  return axis;
}

/// Whether all patterns are smooth functions of their cosine. Functions of the angle from the axis are not.
bool known_by_cosine(std::span<const Directivity> beams) {
  return std::all_of(beams.begin(), beams.end(), [](const Directivity& beam) {
    return is_uniform(beam) || beam.kind == Kind::line ||
           (!beam.from_axis && (beam.kind == Kind::gaussian || beam.kind == Kind::table));
  });
}

bool by_angle(std::span<const Directivity> beams) {
  return std::any_of(beams.begin(), beams.end(), [](const Directivity& beam) {
    return beam.kind == Kind::gaussian || beam.kind == Kind::table;
  });
}

/// Approximate width that a polynomial of GainPanels can have.
double width_for(const std::function<double(double)>& growth, double tolerance) {
  const NodeCount count(growth, tolerance);
  double width = 0.5;
  while (width > 1e-4 && count.nodes(width / 2, 1000) > GainPanels::terms / 2) width /= 1.2;
  return width;
}

/// Products of the sum of some patterns and each of other patterns, all functions of one cosine. An empty
/// set means 1. The products do not depend on the pose, so each thread keeps them for later pings.
std::shared_ptr<GainPanels> gains_of(std::span<const Directivity> summed, std::span<const Directivity> each,
                                     double tolerance) {
  constexpr std::size_t most_kept = 64;
  using Key = std::pair<std::vector<double>, std::vector<const PatternTable*>>;
  thread_local std::map<Key, std::shared_ptr<GainPanels>> kept;
  Key key{{tolerance, double(summed.size())}, {}};
  for (const std::span<const Directivity> patterns : {summed, each})
    for (const Directivity& p : patterns) {
      key.first.insert(key.first.end(), {double(p.kind), double(p.from_axis), p.centre, p.size, p.shading});
      key.second.push_back(p.table.get());
    }
  if (const auto known = kept.find(key); known != kept.end()) return known->second;
  if (kept.size() >= most_kept) kept.clear();
  const auto growth = [=](double y) { return growth_of(summed, y) + growth_of(each, y); };
  const double width = width_for(growth, tolerance);
  const auto evaluate = [factor = std::vector(summed.begin(), summed.end()),
                         beams = std::vector(each.begin(), each.end())](double cosine,
                                                                        std::span<double> values) {
    double power = factor.empty() ? 1 : 0;
    for (const Directivity& beam : factor) power += beam.gain_at(cosine);
    values[0] = power;
    for (std::size_t b = 0; b < beams.size(); ++b) values[b] = power * beams[b].gain_at(cosine);
  };
  return kept[key] =
             std::make_shared<GainPanels>(std::max<std::size_t>(each.size(), 1), evaluate, width, tolerance);
}

}  // namespace

PatternIntegrator::Receiver& PatternIntegrator::receiver_of(std::uint32_t tube) {
  std::uint32_t& known = receiver_of_tube_[tube];
  if (known > 0) return *receivers_[known - 1];
  const std::uint32_t fan = patterns_.fan_of_tube[tube];
  const auto [first, end] = patterns_.beams_of_tube[tube];
  const bool uniform =
      std::all_of(patterns_.receive.begin() + first, patterns_.receive.begin() + end, is_uniform);
  for (std::size_t k = 0; k < receivers_.size() && known == 0; ++k) {
    const Receiver& r = *receivers_[k];
    if (r.fan == fan && r.uniform == uniform && (uniform || (r.first == first && r.end == end)))
      known = std::uint32_t(k + 1);
  }
  if (known == 0) {
    receivers_.push_back(make_receiver(fan, first, end));
    known = std::uint32_t(receivers_.size());
  }
  return *receivers_[known - 1];
}

/// Sum of the patterns that have the axis of the first one.
PatternIntegrator::Term PatternIntegrator::term(Receiver& receiver,
                                                std::span<const Directivity> beams) const {
  const glm::dvec3 axis = beams.front().axis;
  std::size_t k = 0;
  while (k < receiver.axes.size() && receiver.axes[k].direction != axis) ++k;
  if (k == receiver.axes.size()) {
    receiver.axes.emplace_back();
    receiver.axes.back().direction = axis;
  }
  return {k, gains_of(beams, {}, tolerance_)};
}

std::unique_ptr<PatternIntegrator::Receiver> PatternIntegrator::make_receiver(std::uint32_t fan,
                                                                              std::uint32_t first,
                                                                              std::uint32_t end) const {
  auto made = std::make_unique<Receiver>();
  made->fan = fan;
  made->first = first;
  made->end = end;
  const std::span<const Directivity> sent = patterns_.transmit[fan].beams,
                                     received = std::span(patterns_.receive).subspan(first, end - first);
  made->uniform = std::all_of(received.begin(), received.end(), is_uniform);
  const bool all_sent = std::all_of(sent.begin(), sent.end(), is_uniform);
  const auto sent_axis = common_axis(sent), received_axis = common_axis(received);
  const auto sent_growth = [sent](double y) { return growth_of(sent, y); };
  const auto received_growth = [received](double y) { return growth_of(received, y); };
  const auto both_growth = [=](double y) { return sent_growth(y) + received_growth(y); };

  // Receive patterns, with the transmit patterns of the same axis.
  const bool gather = patterns_.least.empty() && received_axis && received.size() >= fewest_for_moments;
  const bool join = gather && (all_sent || sent_axis == received_axis);
  if (gather) {
    made->moments_axis = 0;
    made->axes.emplace_back();
    made->axes.back().direction = *received_axis;
    made->moments.emplace(gains_of(join ? sent : sent.first(0), received, tolerance_));
  } else if (!made->uniform) {
    for (const Directivity& beam : received) {
      made->receive.emplace_back();
      if (!is_uniform(beam)) made->receive.back() = term(*made, {&beam, 1});
    }
  }
  if (!patterns_.least.empty() && !made->uniform) {
    double most_sent = 0;
    for (const Directivity& beam : sent) most_sent += two_way_peak(TransmitPattern(beam), Directivity());
    for (std::uint32_t beam = first; beam < end; ++beam)
      made->audible.push_back(cosines_of_gain(patterns_.receive[beam], patterns_.least[beam] / most_sent));
  }
  if (!join) {
    std::vector<Directivity> rest(sent.begin(), sent.end());
    // A single uniform beam needs no factor.
    while (!rest.empty() && !(sent.size() == 1 && all_sent)) {
      const glm::dvec3 axis = rest.front().axis;
      const auto own = std::stable_partition(rest.begin(), rest.end(),
                                             [&](const Directivity& beam) { return beam.axis != axis; });
      made->transmit.push_back(term(*made, std::span(own, rest.end())));
      rest.erase(own, rest.end());
    }
  }

  // Rates of change of all patterns.
  const auto axis_of = [&](const std::optional<glm::dvec3>& axis, std::span<const Directivity> beams) {
    std::optional<std::size_t> place;
    if (!axis || !known_by_cosine(beams)) return place;
    for (std::size_t k = 0; k < made->axes.size(); ++k)
      if (made->axes[k].direction == *axis) place = k;
    return place;
  };
  const auto sent_place = axis_of(sent_axis, sent), received_place = axis_of(received_axis, received);
  const auto add = [&](const std::function<double(double)>& growth, std::optional<std::size_t> axis,
                       bool angle) {
    made->changes.push_back({NodeCount(growth, tolerance_), axis, angle});
  };
  if (all_sent || made->uniform || sent_place == received_place) {
    add(both_growth, made->uniform ? sent_place : received_place, by_angle(sent) || by_angle(received));
  } else {
    add(sent_growth, sent_place, by_angle(sent));
    add(received_growth, received_place, by_angle(received));
  }
  return made;
}

}  // namespace tubefoot
