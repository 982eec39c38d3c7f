// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/integrals/polar_slabs.hpp"

#include <algorithm>

namespace tubefoot {

std::size_t PolarSlabs::event_of(const RangeEnclosure& range) const {
  const auto after =
      std::upper_bound(events_.begin(), events_.end(), range.lo,
                       [](long double lo, const RangeEnclosure& event) { return lo < event.lo; });
  return std::size_t(after - events_.begin()) - 1;
}

void PolarSlabs::cut(std::span<const EdgeRanges> edges, const std::optional<RangeEnclosure>& foot,
                     bool foot_inside, std::span<const double> borders_m) {
  branches_.clear();
  events_.clear();
  crossings_.clear();
  slabs_.clear();
  gaps_.clear();
  for (std::uint32_t e = 0; e < edges.size(); ++e) {
    const EdgeRanges& edge = edges[e];
    if (edge.side_to != -1)
      branches_.push_back({{e, true}, edge.side_from == 1 ? edge.from : edge.nearest, edge.to});
    if (edge.side_from != 1)
      branches_.push_back({{e, false}, edge.side_to == -1 ? edge.to : edge.nearest, edge.from});
  }
  for (const Branch& branch : branches_) {
    events_.push_back(branch.begin);
    events_.push_back(branch.end);
  }
  if (foot) events_.push_back(*foot);
  std::sort(events_.begin(), events_.end(),
            [](const RangeEnclosure& a, const RangeEnclosure& b) { return a.lo < b.lo; });
  std::size_t merged = 0;
  for (std::size_t k = 1; k < events_.size(); ++k) {
    if (events_[k].lo <= events_[merged].hi)
      events_[merged].hi = std::max(events_[merged].hi, events_[k].hi);
    else
      events_[++merged] = events_[k];
  }
  events_.resize(events_.empty() ? 0 : merged + 1);
  for (Branch& branch : branches_) {
    branch.begin_event = event_of(branch.begin);
    branch.end_event = event_of(branch.end);
  }

  bool met = false;  // true if a circle nearer than this one met an edge
  for (std::size_t k = 0; k < events_.size(); ++k) {
    const RangeEnclosure& event = events_[k];
    if (event.hi > event.lo && event.hi >= borders_m.front() && event.lo <= borders_m.back()) {
      const auto begin = std::upper_bound(borders_m.begin(), borders_m.end(), event.lo) - borders_m.begin();
      const auto end = std::lower_bound(borders_m.begin(), borders_m.end(), event.hi) - borders_m.begin();
      // Sample k is [border k, border k + 1). A gap that touches a border belongs to both adjacent samples.
      gaps_.push_back({event.lo, event.hi, std::uint32_t(std::max<std::ptrdiff_t>(begin - 1, 0)),
                       std::uint32_t(std::min<std::ptrdiff_t>(end, std::ssize(borders_m) - 1))});
    }
    if (k + 1 == events_.size()) break;
    const auto first = std::uint32_t(crossings_.size());
    for (const Branch& branch : branches_)
      if (branch.begin_event <= k && branch.end_event > k) crossings_.push_back(branch.crossing);
    met = met || crossings_.size() > first;
    if (crossings_.size() > first || (foot_inside && !met))
      add_slabs(event.hi, events_[k + 1].lo, first, borders_m);
  }
}

void PolarSlabs::add_slabs(long double lo, long double hi, std::uint32_t first,
                           std::span<const double> borders_m) {
  lo = std::max<long double>(lo, borders_m.front());
  hi = std::min<long double>(hi, borders_m.back());
  const auto count = std::uint32_t(crossings_.size()) - first;
  auto border = std::upper_bound(borders_m.begin(), borders_m.end(), lo);
  while (lo < hi && border != borders_m.end()) {
    const long double end = std::min<long double>(hi, *border);
    slabs_.push_back({lo, end, std::uint32_t(border - borders_m.begin()) - 1, first, count});
    lo = end;
    ++border;
  }
}

}  // namespace tubefoot
