// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/mesh/segment_bins.hpp"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>

namespace tubefoot {
namespace {

constexpr std::size_t most_squares_a_side = 2048, most_entries = 100'000'000;

std::size_t part_of(double x, double lo, double hi, std::size_t parts) {
  const double part = (x - lo) / (hi - lo) * static_cast<double>(parts);
  return part > 0 ? std::min(static_cast<std::size_t>(std::min(part, 1e9)), parts - 1) : 0;
}

}  // namespace

std::size_t SegmentBins::column(double x) const { return part_of(x, lo_.x, hi_.x, side_); }
std::size_t SegmentBins::row(double y) const { return part_of(y, lo_.y, hi_.y, side_); }

template <class Visit>
void SegmentBins::for_each_bin(const PlanSegment& s, Visit visit) const {
  const glm::dvec2 lo = glm::min(s.a, s.b), hi = glm::max(s.a, s.b);
  if (hi.x < lo_.x || lo.x > hi_.x || hi.y < lo_.y || lo.y > hi_.y) return;
  const glm::dvec2 along = s.b - s.a;
  const double square_y = (hi_.y - lo_.y) / static_cast<double>(side_);
  // Larger than all rounding errors of the following computation, and much smaller than a square.
  const double slack = 1e-9 * std::max(hi_.x - lo_.x, hi.x - lo.x);
  for (std::size_t r = row(lo.y); r <= row(hi.y); ++r) {
    double from = lo.x, to = hi.x;
    if (hi.y - lo.y > square_y) {
      const double below = lo_.y + (static_cast<double>(r) - 0.001) * square_y,
                   above = lo_.y + (static_cast<double>(r) + 1.001) * square_y;
      const double x1 = s.a.x + along.x * std::clamp((below - s.a.y) / along.y, 0.0, 1.0),
                   x2 = s.a.x + along.x * std::clamp((above - s.a.y) / along.y, 0.0, 1.0);
      from = std::min(x1, x2), to = std::max(x1, x2);
    }
    if (to + slack < lo_.x || from - slack > hi_.x) continue;
    for (std::size_t c = column(from - slack); c <= column(to + slack); ++c) visit(r * side_ + c);
  }
}

SegmentBins::SegmentBins(std::span<const PlanSegment> segments, glm::dvec2 lo, glm::dvec2 hi)
    : segments_(segments), lo_(lo), hi_(hi) {
  // Avoids a division by zero if the rectangle has no width.
  hi_ = glm::max(hi_, lo_ + glm::dvec2(1e-6));
  side_ = std::clamp(static_cast<std::size_t>(2 * std::sqrt(static_cast<double>(segments.size()))),
                     std::size_t{1}, most_squares_a_side);
  for (;; side_ /= 2) {
    std::size_t entries = 0;
    for (const PlanSegment& s : segments_) for_each_bin(s, [&](std::size_t) { ++entries; });
    if (entries <= most_entries || side_ == 1) break;
  }
  first_.assign(side_ * side_ + 1, 0);
  for (const PlanSegment& s : segments_) for_each_bin(s, [&](std::size_t bin) { ++first_[bin + 1]; });
  for (std::size_t bin = 1; bin < first_.size(); ++bin) first_[bin] += first_[bin - 1];
  list_.resize(first_.back());
  std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
  for (std::uint32_t k = 0; k < segments_.size(); ++k)
    for_each_bin(segments_[k], [&](std::size_t bin) { list_[next[bin]++] = k; });
}

void SegmentBins::near(glm::dvec2 lo, glm::dvec2 hi, std::vector<std::uint32_t>& out) const {
  const std::size_t begin = out.size();
  for (std::size_t r = row(lo.y); r <= row(hi.y); ++r)
    for (std::size_t bin = r * side_ + column(lo.x); bin <= r * side_ + column(hi.x); ++bin)
      for (std::uint32_t k = first_[bin]; k < first_[bin + 1]; ++k) {
        const PlanSegment& s = segments_[list_[k]];
        if (std::max(s.a.x, s.b.x) >= lo.x && std::min(s.a.x, s.b.x) <= hi.x &&
            std::max(s.a.y, s.b.y) >= lo.y && std::min(s.a.y, s.b.y) <= hi.y)
          out.push_back(list_[k]);
      }
  const auto first = out.begin() + static_cast<std::ptrdiff_t>(begin);
  std::sort(first, out.end());
  out.erase(std::unique(first, out.end()), out.end());
}

}  // namespace tubefoot
