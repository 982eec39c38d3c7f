// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/mesh/near_segments.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <optional>
#include <vector>

#include "geometry/steps/stop.hpp"

// Divides segments recursively by lines at the median along the best of several directions. Small groups, and
// groups that no direction separates, are compared pair by pair.

namespace tubefoot {
namespace {

/// The part of a segment in the cell of a node.
struct SegmentPart {
  std::uint32_t segment = 0;
  glm::dvec2 from{}, to{};
};

struct Split {
  glm::dvec2 direction{};
  double middle = 0;
  double cost = 0;  ///< twice the number of pairs left on both sides
};

class Halving {
 public:
  Halving(double slack, const std::function<void(std::uint32_t, std::uint32_t)>& visit)
      : slack_(slack), visit_(visit) {}

  void halve(std::vector<SegmentPart> parts) {
    stop_if_wanted();
    constexpr std::size_t few = 16;
    if (parts.size() <= few) return compare(parts);
    const std::optional<Split> split = best_split(parts);
    if (!split) return compare(parts);
    std::vector<SegmentPart> below, above;
    for (const SegmentPart& part : parts) {
      const double from = glm::dot(split->direction, part.from), to = glm::dot(split->direction, part.to);
      if (std::min(from, to) <= split->middle + slack_)
        below.push_back(cut(part, from, to, split->middle + slack_, true));
      if (std::max(from, to) >= split->middle - slack_)
        above.push_back(cut(part, from, to, split->middle - slack_, false));
    }
    parts = {};
    halve(std::move(below));
    halve(std::move(above));
  }

 private:
  /// Returns the part on one side of a line at `at`. A part that does not cross the line is returned
  /// unchanged.
  static SegmentPart cut(SegmentPart part, double from, double to, double at, bool below) {
    const auto is_out = [&](double x) { return below ? x > at : x < at; };
    if (is_out(from) == is_out(to)) return part;
    const glm::dvec2 met = glm::mix(part.from, part.to, std::clamp((at - from) / (to - from), 0.0, 1.0));
    (is_out(from) ? part.from : part.to) = met;
    return part;
  }

  /// Returns nothing if no direction separates the parts, so that comparing all pairs costs no more.
  std::optional<Split> best_split(const std::vector<SegmentPart>& parts) {
    constexpr double enough = 0.75;
    const auto all = static_cast<double>(parts.size());
    std::optional<Split> best;
    const auto attempt = [&](glm::dvec2 direction) {
      middles_.clear();
      for (const SegmentPart& part : parts) middles_.push_back(glm::dot(direction, part.from + part.to) / 2);
      const auto half = middles_.begin() + static_cast<std::ptrdiff_t>(middles_.size() / 2);
      std::nth_element(middles_.begin(), half, middles_.end());
      double below = 0, above = 0;
      for (const SegmentPart& part : parts) {
        const double from = glm::dot(direction, part.from), to = glm::dot(direction, part.to);
        below += std::min(from, to) <= *half + slack_;
        above += std::max(from, to) >= *half - slack_;
      }
      const double cost = below * below + above * above;
      if (cost <= enough * all * all && (!best || cost < best->cost)) best = Split{direction, *half, cost};
    };
    attempt({1, 0});
    attempt({0, 1});
    // The normal of parallel segments separates them.
    constexpr int tries = 3;
    for (int k = 0; k < tries; ++k) {
      state_ = state_ * 6364136223846793005u + 1442695040888963407u;
      const SegmentPart& part = parts[(state_ >> 33) % parts.size()];
      const glm::dvec2 along = part.to - part.from;
      if (const double length = glm::length(along); length > 0)
        attempt(glm::dvec2(-along.y, along.x) / length);
    }
    return best;
  }

  void compare(const std::vector<SegmentPart>& parts) const {
    for (std::size_t i = 0; i < parts.size(); ++i) {
      stop_if_wanted();
      const glm::dvec2 lo = glm::min(parts[i].from, parts[i].to) - slack_,
                       hi = glm::max(parts[i].from, parts[i].to) + slack_;
      for (std::size_t j = i + 1; j < parts.size(); ++j) {
        const SegmentPart &a = parts[i], &b = parts[j];
        if (std::min(b.from.x, b.to.x) > hi.x || std::max(b.from.x, b.to.x) < lo.x ||
            std::min(b.from.y, b.to.y) > hi.y || std::max(b.from.y, b.to.y) < lo.y)
          continue;
        visit_(std::min(a.segment, b.segment), std::max(a.segment, b.segment));
      }
    }
  }

  double slack_;
  const std::function<void(std::uint32_t, std::uint32_t)>& visit_;
  std::vector<double> middles_;
  std::uint64_t state_ = 1;
};

}  // namespace

void for_each_near_pair(std::span<const PlanSegment> segments,
                        const std::function<void(std::uint32_t, std::uint32_t)>& visit) {
  std::vector<SegmentPart> parts;
  parts.reserve(segments.size());
  double largest = 0;
  for (const PlanSegment& segment : segments) {
    parts.push_back({static_cast<std::uint32_t>(parts.size()), segment.a, segment.b});
    for (const glm::dvec2& p : {segment.a, segment.b})
      largest = std::max({largest, std::abs(p.x), std::abs(p.y)});
  }
  // The bound exceeds some thousand roundings: one per division and a few more.
  constexpr double roundings = 0x1p-38;
  Halving(largest * roundings, visit).halve(std::move(parts));
}

}  // namespace tubefoot
