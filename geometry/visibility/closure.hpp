// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>

#include "geometry/visibility/visibility.hpp"

namespace tubefoot {

/// A 128-bit sum of hashes: adding is commutative, so that neither order nor threads matter.
struct TopologyHash {
  std::uint64_t high = 0, low = 0;
  TopologyHash& operator+=(const TopologyHash& o) {
    high += o.high;
    low += o.low;
    return *this;
  }
  friend bool operator==(const TopologyHash&, const TopologyHash&) = default;
  std::string hex() const;
};

/// What holds of one tube's result, in rationals.
/// Law C1 (closure): the gnomonic areas of all visible pieces and of the open water add up to the tube's.
/// Law C2 (hash): hashes are equal where what is seen is, however it is cut up and in whatever order they are
///   added; a piece that is missing, doubled, moved or another facet's makes another.
struct TubeAudit {
  bool closes = false;     ///< false too if a piece is no cone within the tube, which only inexact signs make
  std::size_t pieces = 0;  ///< visible ones
  std::size_t facets = 0;  ///< seen
  double covered_fraction = 0;  ///< of the tube's gnomonic area, for people
  /// (visible + open - tube) / tube; exactly 0 where the law holds.
  double defect = 0;
  /// Of the facets seen (by their vertices relative to the apex) and the exact gnomonic area of what is seen
  /// of each: not of how it was cut up, of facet ids, of the scene's place, or of the arithmetic.
  TopologyHash hash;
};

/// `seen` must come from see() with open_water. `label` distinguishes tubes (and pings) in the hash.
TubeAudit audit(const FacetMesh& mesh, const TubeSet& tubes, std::uint32_t tube, const TubeVisibility& seen,
                std::uint64_t label);

}  // namespace tubefoot
