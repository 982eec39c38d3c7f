// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cstdint>
#include <glm/vec3.hpp>
#include <limits>
#include <span>

#include "engine/visibility/bistatic_history.hpp"
#include "engine/visibility/history.hpp"
#include "geometry/integrals/measure.hpp"

// Common visibility of both ends of a path, as a view of a history with one apex or with two. Quadratures and
// binnings read facets, convex parts and ray hits through this interface.

namespace tubefoot {

/// A facet as both ends of a path see it. With two apexes it has all shared parts; with one apex it is a
/// footprint, which one tube sees.
struct SeenFacet {
  FacetId facet = 0;
  FacetPlane plane;          ///< as the transmit leg sees it
  double rx_distance_m = 0;  ///< distance of the plane from the apex of the receive leg
  std::uint32_t first_piece = 0, piece_count = 0;
};

/// A convex part of a SeenFacet.
struct SeenPart {
  std::span<const glm::dvec3> corners_m;  ///< relative to the apex of the transmit leg
  std::uint32_t tx_tube = 0, rx_tube = 0;
};

/// The parts of the seabed that both ends of a path see. With one apex both ends are the same. The object is
/// a view of a history, which must outlive it.
class CommonVisibility {
 public:
  CommonVisibility(const History& history) : one_(&history) {}          // NOLINT: every history is one
  CommonVisibility(const BistaticHistory& history) : two_(&history) {}  // NOLINT

  bool one_apex() const { return one_ != nullptr; }
  /// Returns null for a history with one apex.
  const BistaticHistory* two_apexes() const { return two_; }
  /// Returns the apex of the receive leg relative to that of the transmit leg.
  glm::dvec3 rx_m() const { return one_ ? glm::dvec3(0) : two_->shared.receiver_m; }
  double grid_unit_m() const { return one_ ? one_->grid_unit_m : two_->grid_unit_m; }

  /// Numbers of its facets: [first(), end()).
  std::size_t first() const { return first_; }
  std::size_t end() const {
    return std::min(end_, one_ ? one_->footprints.footprints.size() : two_->shared.facets.size());
  }
  /// Returns a view of the facets [first, end) alone, which keep their numbers.
  CommonVisibility within(std::size_t first, std::size_t end) const {
    CommonVisibility part = *this;
    part.first_ = std::max(first, first_);
    part.end_ = std::min(end, end_);
    return part;
  }
  SeenFacet operator[](std::size_t number) const {
    if (one_ != nullptr) {
      const Footprint& f = one_->footprints.footprints[number];
      return {
          f.facet, {f.plane_normal, f.plane_distance_m}, f.plane_distance_m, f.first_piece, f.piece_count};
    }
    const SharedFacet& f = two_->shared.facets[number];
    return {
        f.facet, {f.plane_normal, f.transmit_distance_m}, f.receive_distance_m, f.first_piece, f.piece_count};
  }
  /// `number` is that of the facet.
  SeenPart part(std::size_t number, std::uint32_t piece) const {
    if (one_ != nullptr) {
      const Piece& p = one_->footprints.pieces[piece];
      const std::uint32_t tube = one_->footprints.footprints[number].tube;
      return {std::span(one_->footprints.corners_m).subspan(p.first, p.count), tube, tube};
    }
    const SharedPiece& p = two_->shared.pieces[piece];
    return {std::span(two_->shared.corners_m).subspan(p.first, p.count), p.transmit_tube, p.receive_tube};
  }
  /// Returns the facet's positions for both ends in stratified water; null if they equal the true position.
  const BistaticFacet* bistatic(std::size_t number) const {
    return two_ != nullptr && !two_->bistatic.empty() ? &two_->bistatic[number] : nullptr;
  }
  /// Returns the measures of a footprint, which all binnings except the exact one read; null with two apexes.
  const Footprint* footprint(std::size_t number) const {
    return one_ ? &one_->footprints.footprints[number] : nullptr;
  }
  /// Returns the hits of rays; empty with two apexes.
  std::span<const HitBlock> hits() const {
    return one_ != nullptr && with_hits_ ? one_->hits.blocks() : std::span<const HitBlock>();
  }
  /// Returns the hits of rays with two apexes; empty with one.
  std::span<const SharedHit> shared_hits() const {
    return two_ != nullptr && with_hits_ ? std::span(two_->hits) : std::span<const SharedHit>();
  }
  CommonVisibility without_hits() const {
    CommonVisibility part = *this;
    part.with_hits_ = false;
    return part;
  }

 private:
  const History* one_ = nullptr;
  const BistaticHistory* two_ = nullptr;
  std::size_t first_ = 0, end_ = std::numeric_limits<std::size_t>::max();
  bool with_hits_ = true;
};

}  // namespace tubefoot
