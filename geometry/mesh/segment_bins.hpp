// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <glm/vec2.hpp>
#include <span>
#include <vector>

#include "geometry/mesh/plan_cut.hpp"

namespace tubefoot {

/// Finds the segments that may enter a rectangle. It stores lists of segments for the squares of a chart
/// through which they run.
class SegmentBins {
 public:
  /// Segments that do not reach into the rectangle lo .. hi are omitted.
  SegmentBins(std::span<const PlanSegment> segments, glm::dvec2 lo, glm::dvec2 hi);

  /// Appends the segments that may enter the rectangle, each once and in their order. The list contains all
  /// segments that do enter it.
  void near(glm::dvec2 lo, glm::dvec2 hi, std::vector<std::uint32_t>& out) const;

 private:
  std::size_t column(double x) const;
  std::size_t row(double y) const;
  /// Calls visit(bin) for every square through which the segment may run.
  template <class Visit>
  void for_each_bin(const PlanSegment& segment, Visit visit) const;

  std::span<const PlanSegment> segments_;
  glm::dvec2 lo_, hi_;
  std::size_t side_ = 1;  // number of squares per side
  std::vector<std::uint32_t> first_, list_;
};

}  // namespace tubefoot
