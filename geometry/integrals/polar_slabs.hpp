// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace tubefoot {

/// An enclosure of a slant range. With long doubles the interval is negligible even for a sample without
/// another echo.
struct RangeEnclosure {
  long double lo = 0, hi = 0;
};

/// Slant ranges of a polygon's edge, for the cut into slabs. The variable s is the position along the edge's
/// line, from the line's point nearest to the apex.
struct EdgeRanges {
  RangeEnclosure from, to, nearest;  ///< of the edge's start, its end, and its line's nearest point
  int side_from = 0, side_to = 0;    ///< sign of s at start and end; 0 if undecided
};

/// A circle of constant range meets an edge. At s > 0 (`rising`) the polygon begins as the angle about the
/// foot point grows; at s < 0 it ends.
struct Crossing {
  std::uint32_t edge = 0;
  bool rising = false;
};

/// Cuts a convex polygon on a plane into slabs of slant range. The borders are those of the range samples,
/// and the ranges at which circles about the apex's foot point meet other edges than before. In a slab all
/// circles meet the same edges. The polygon's part in it is therefore a set of arcs whose ends are smooth
/// functions of range.
///
/// Ranges are enclosures, and a slab is an interval between them. The slabs omit gaps as wide as the
/// enclosures. No decision depends on a comparison within an enclosure.
class PolarSlabs {
 public:
  struct Slab {
    long double lo = 0, hi = 0;  ///< slant ranges
    std::uint32_t sample = 0;
    std::uint32_t first = 0, count = 0;  ///< in crossings(); none: the whole circle lies in the polygon
  };
  struct Gap {
    long double lo = 0, hi = 0;
    std::uint32_t first_sample = 0, end_sample = 0;  ///< samples that may contain the gap, [first, end)
  };

  /// `edges`: in order, counter-clockwise about the interior (as visible polygons are). `foot`: the apex's
  /// distance from the plane if the foot point lies strictly inside the polygon, or if that is undecided.
  /// `foot_inside`: the foot point certainly lies inside. `borders_m`: of the samples, increasing.
  void cut(std::span<const EdgeRanges> edges, const std::optional<RangeEnclosure>& foot, bool foot_inside,
           std::span<const double> borders_m);

  const std::vector<Slab>& slabs() const { return slabs_; }
  const std::vector<Gap>& gaps() const { return gaps_; }
  std::span<const Crossing> crossings(const Slab& slab) const {
    return std::span(crossings_).subspan(slab.first, slab.count);
  }

 private:
  struct Branch {
    Crossing crossing;
    RangeEnclosure begin, end;
    std::size_t begin_event = 0, end_event = 0;
  };
  std::size_t event_of(const RangeEnclosure& range) const;
  void add_slabs(long double lo, long double hi, std::uint32_t first, std::span<const double> borders_m);

  std::vector<Branch> branches_;
  std::vector<RangeEnclosure> events_;
  std::vector<Crossing> crossings_;
  std::vector<Slab> slabs_;
  std::vector<Gap> gaps_;
};

}  // namespace tubefoot
