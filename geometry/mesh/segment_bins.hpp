// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <glm/vec2.hpp>
#include <span>
#include <vector>

#include "geometry/mesh/plan_cut.hpp"

namespace tubefoot {

/// Which segments may enter a rectangle: lists of segments by the squares of a chart that they run through.
class SegmentBins {
 public:
  /// Segments that do not reach into the rectangle lo .. hi are left out.
  SegmentBins(std::span<const PlanSegment> segments, glm::dvec2 lo, glm::dvec2 hi);

  /// Appends, each once and in their order, the segments that may enter the rectangle; none that does is
  /// missing.
  void near(glm::dvec2 lo, glm::dvec2 hi, std::vector<std::uint32_t>& out) const;

 private:
  std::size_t column(double x) const;
  std::size_t row(double y) const;
  /// Calls visit(bin) for every square that the segment may run through.
  template <class Visit>
  void for_each_bin(const PlanSegment& segment, Visit visit) const;

  std::span<const PlanSegment> segments_;
  glm::dvec2 lo_, hi_;
  std::size_t side_ = 1;  // squares a side
  std::vector<std::uint32_t> first_, list_;
};

}  // namespace tubefoot
