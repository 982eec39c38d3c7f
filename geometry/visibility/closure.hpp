// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>

#include "geometry/visibility/visibility.hpp"

namespace tubefoot {

/// A 128-bit sum of hashes. Addition is commutative, so the sum does not depend on order or threads.
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

/// The result of checking one tube, in rationals.
///
/// Law C1 (closure): the gnomonic areas of all visible pieces and of the unobstructed region add up to that
/// of the tube.
///
/// Law C2 (hash): hashes are equal if the visible regions are equal, however they are divided and in whatever
/// order they are added. A missing, duplicated or displaced piece, or a piece of another facet, changes the
/// hash.
struct TubeAudit {
  bool closes =
      false;  ///< also false if a piece is no cone within the tube, which only inexact signs can cause
  std::size_t pieces = 0;       ///< number of visible pieces
  std::size_t facets = 0;       ///< number of visible facets
  double covered_fraction = 0;  ///< share of the tube's gnomonic area, for display
  /// (visible + open - tube) / tube; exactly 0 if the law holds.
  double defect = 0;
  /// Hash of the visible facets (by their vertices relative to the apex) and of the exact gnomonic area of
  /// the visible part of each. It does not depend on the division into pieces, on facet ids, on the scene's
  /// position or on the arithmetic.
  TopologyHash hash;
};

/// Checks one tube. `seen` must come from see() with open_water. `label` distinguishes tubes and pings in the
/// hash.
TubeAudit audit(const FacetMesh& mesh, const TubeSet& tubes, std::uint32_t tube, const TubeVisibility& seen,
                std::uint64_t label);

}  // namespace tubefoot
