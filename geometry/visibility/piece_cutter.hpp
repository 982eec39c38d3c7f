// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "geometry/arithmetic/cone_clip.hpp"
#include "geometry/visibility/gnomonic_frame.hpp"
#include "geometry/visibility/piece_tree.hpp"

// Cuts convex pieces of a tube at half-spaces: subtracts the region that a facet hides from the remaining
// pieces. If the arithmetic has a fast first stage, that stage evaluates up to four half-spaces at once.

namespace tubefoot {

/// A::FourHalves, or an empty type if the arithmetic has none.
template <class A>
struct FourHalvesOf {
  struct Type {};
};
template <class A>
requires requires { typename A::FourHalves; }
struct FourHalvesOf<A> {
  using Type = typename A::FourHalves;
};

/// The cutting operations of the visibility algorithm. Pieces are stored in one buffer of corners and clipped
/// to half-spaces. The region that a facet hides is subtracted from the remaining pieces.
template <class A>
class PieceCutter {
 protected:
  /// Whether the first stage of the arithmetic evaluates several planes at once.
  static constexpr bool has_lanes = requires { typename A::FourHalves; };
  using FourHalves = typename FourHalvesOf<A>::Type;

  /// Writes the side of each corner to sides_. Returns 1 if any is positive, plus 2 if any is negative.
  int sides_of(PieceRange piece, Half<A> half) {
    if (sides_.size() < piece.count) sides_.resize(piece.count);
    int signs = 0;
    for (std::uint32_t k = 0; k < piece.count; ++k) {
      const int s = side(arithmetic_, buffer_[piece.first + k], half);
      sides_[k] = s;
      signs |= s > 0 ? 1 : s < 0 ? 2 : 0;
    }
    return signs;
  }

  void flip_sides() {
    if (flipped_.size() < sides_.size()) flipped_.resize(sides_.size());
    std::transform(sides_.begin(), sides_.end(), flipped_.begin(), [](int s) { return -s; });
  }

  /// Clips `piece` to `half`. Returns false if nothing with an interior is left.
  bool clip_to(PieceRange& piece, Half<A> half) {
    const int signs = sides_of(piece, half);
    if (!(signs & 1)) return false;
    if (signs & 2) piece = clip(arithmetic_, buffer_, piece, half, sides_.data());
    return piece.count >= 3;
  }

  /// The region that a facet hides: its cone, on the near side of the depth plane if there is one.
  struct Hidden {
    const FramedFacet* facet;
    const Half<A>* halves;
    int count;
    const FourHalves* lanes;
  };

  /// Subtracts the hidden region from the remaining pieces. Returns true if any piece changed.
  bool take_away(const Hidden& hidden) {
    unsigned cutting = 0;
    const auto meets = [&](PieceRange piece, unsigned& halves) {
      if (!A::signs_are_exact)
        return true;  // rounded signs at corners do not determine those of the interior
      const bool crossed = crosses(piece, hidden, halves, cutting);
      halves = cutting;
      return crossed;
    };
    const auto cut_up = [&](PieceRange piece, unsigned halves, std::vector<PieceRange>& rest) {
      return crosses(piece, hidden, halves, cutting) && !set_apart(piece, hidden, cutting) &&
             cut(piece, hidden, cutting, rest);
    };
    return left_.take_away((1u << hidden.count) - 1, meets, cut_up);
  }

  /// A part of the target that `occluder` hides.
  struct Removed {
    FacetId occluder;
    PieceRange piece;
  };

  /// Returns false if one of the given halves contains nothing of the piece. Otherwise `cutting` has the
  /// halves with corners on both sides, and first_sides_ has the sides of the first of them. The other halves
  /// contain the whole piece.
  bool crosses(PieceRange piece, const Hidden& hidden, unsigned halves, unsigned& cutting) {
    cutting = 0;
    if constexpr (has_lanes) return crosses_at_a_glance(piece, hidden, halves, cutting);
    for (int h = 0; h < hidden.count; ++h) {
      if (!(halves >> h & 1u)) continue;
      const int signs = sides_of(piece, hidden.halves[h]);
      if (!(signs & 1)) return false;
      if (!(signs & 2)) continue;
      if (cutting == 0) sides_.swap(first_sides_);
      cutting |= 1u << h;
    }
    return true;
  }

  /// The same, with one evaluation of the first stage for all half-spaces.
  bool crosses_at_a_glance(PieceRange piece, const Hidden& hidden, unsigned halves, unsigned& cutting) {
    if (glances_.size() < piece.count) glances_.resize(piece.count);
    unsigned any = 0, sure = ~0u;
    for (std::uint32_t k = 0; k < piece.count; ++k) {
      const unsigned sides = arithmetic_.double_sides(buffer_[piece.first + k].corner, *hidden.lanes);
      glances_[k] = sides;
      any |= sides;
      sure &= sides | sides >> 4;
    }
    for (int h = 0; h < hidden.count; ++h) {
      const unsigned inside = 1u << h, outside = 16u << h;
      if (!(halves & inside)) continue;
      // The cut needs all sides of the first half that cuts. For the other halves it needs only whether both
      // signs occur.
      if (!(sure & inside) && (cutting == 0 || (any & (inside | outside)) != (inside | outside)))
        for (std::uint32_t k = 0; k < piece.count; ++k) {
          if (glances_[k] & (inside | outside)) continue;
          const int s = ambiguous_side(arithmetic_, buffer_[piece.first + k], hidden.halves[h]);
          const unsigned found = s > 0 ? inside : s < 0 ? outside : 0;
          glances_[k] |= found;
          any |= found;
        }
      if (!(any & inside)) return false;
      if (!(any & outside)) continue;
      if (cutting == 0) {
        if (first_sides_.size() < piece.count) first_sides_.resize(piece.count);
        for (std::uint32_t k = 0; k < piece.count; ++k)
          first_sides_[k] = (glances_[k] & inside ? 1 : 0) - (glances_[k] & outside ? 1 : 0);
      }
      cutting |= inside;
    }
    return true;
  }

  /// An edge plane of one of two convex cones in one half-space with disjoint interiors separates them.
  /// Returns whether an edge plane of the piece does. Without this test the piece would be cut needlessly.
  bool set_apart(PieceRange piece, const Hidden& hidden, unsigned cutting) const {
    for (std::uint32_t k = 0; cutting != 0 && k < piece.count; ++k)
      if (!any_vertex_inside(*hidden.facet, buffer_[piece.first + k].edge)) return true;
    return false;
  }

  /// Appends the parts of a piece outside of the halves that cut it, and the part inside to removed_. Returns
  /// false if the whole piece remains.
  bool cut(PieceRange piece, const Hidden& hidden, unsigned cutting, std::vector<PieceRange>& left) {
    const std::size_t mark = buffer_.size();
    PieceRange rest = piece;
    for (int h = 0; h < hidden.count; ++h) {
      if (!(cutting >> h & 1u)) continue;
      const bool first = rest == piece;
      if (first) sides_.swap(first_sides_);
      const Half<A> half = hidden.halves[h];
      const int signs = first ? 3 : sides_of(rest, half);
      if (!(signs & 1)) {
        // They do not meet after all, because a depth plane or the apex separates them. The cuts are undone.
        buffer_.resize(mark);
        return false;
      }
      if (!(signs & 2)) continue;
      flip_sides();
      const PieceRange outside =
          clip(arithmetic_, buffer_, rest, Half<A>{half.plane, -half.sign}, flipped_.data());
      if (outside.count >= 3) left.push_back(outside);
      rest = clip(arithmetic_, buffer_, rest, half, sides_.data());
    }
    removed_.push_back({hidden.facet->cone.id, rest});
    return true;
  }

  bool any_vertex_inside(const FramedFacet& facet, Half<A> half) const {
    for (int k = 0; k < 3; ++k) {
      if constexpr (A::uses_names)
        if (half.plane->name.contains(facet.cone.vertex[k])) continue;
      if (half.sign * arithmetic_.side(facet.cone.point[k], half.plane->plane) > 0) return true;
    }
    return false;
  }

  A arithmetic_{};
  CornerBuffer<A> buffer_;
  PieceTree left_;  ///< remaining pieces of the current target facet
  std::vector<Removed> removed_;
  std::vector<int> sides_, first_sides_, flipped_;
  std::vector<unsigned> glances_;  ///< per corner: results of the first stage for an occluder's half-spaces
};

}  // namespace tubefoot
