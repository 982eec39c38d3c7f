// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "geometry/arithmetic/cone_clip.hpp"
#include "geometry/visibility/gnomonic_frame.hpp"
#include "geometry/visibility/piece_tree.hpp"

namespace tubefoot {

/// A::FourHalves, or nothing where the arithmetic has none.
template <class A>
struct FourHalvesOf {
  struct Type {};
};
template <class A>
requires requires { typename A::FourHalves; }
struct FourHalvesOf<A> {
  using Type = typename A::FourHalves;
};

/// What the visibility algorithm cuts with: pieces in one buffer of corners, clipped to half-spaces, and
/// what a facet hides taken away from those that are left.
template <class A>
class PieceCutter {
 protected:
  /// Whether the arithmetic's first tier looks at several planes at once.
  static constexpr bool has_lanes = requires { typename A::FourHalves; };
  using FourHalves = typename FourHalvesOf<A>::Type;

  /// Fills sides_ with the side of each corner; returns 1 if any is positive, plus 2 if any is negative.
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

  /// Clips `piece` to `half`; false if nothing with an interior is left.
  bool clip_to(PieceRange& piece, Half<A> half) {
    const int signs = sides_of(piece, half);
    if (!(signs & 1)) return false;
    if (signs & 2) piece = clip(arithmetic_, buffer_, piece, half, sides_.data());
    return piece.count >= 3;
  }

  /// Where a facet hides: its cone, on the near side of the depth plane if there is one.
  struct Hidden {
    const FramedFacet* facet;
    const Half<A>* halves;
    int count;
    const FourHalves* lanes;
  };

  /// Takes what is hidden away from the pieces left; true if anything was taken.
  bool take_away(const Hidden& hidden) {
    unsigned cutting = 0;
    const auto meets = [&](PieceRange piece, unsigned& halves) {
      if (!A::signs_are_exact) return true;  // rounded signs at corners do not bind what lies within
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

  /// False if one of the halves given holds nothing of the piece. Else `cutting` are those that have corners
  /// of it on both sides, first_sides_ being those of the first: the others hold all of it.
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

  /// The same, the first tier being asked for all half-spaces at once.
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
      // Of the first that cuts, the cut will want to know all sides; of others, whether there are both.
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

  /// Two convex cones in one half-space with disjoint interiors are set apart by an edge plane of one of
  /// them: whether it is one of the piece's. Without this test it would be cut up for nothing.
  bool set_apart(PieceRange piece, const Hidden& hidden, unsigned cutting) const {
    for (std::uint32_t k = 0; cutting != 0 && k < piece.count; ++k)
      if (!any_vertex_inside(*hidden.facet, buffer_[piece.first + k].edge)) return true;
    return false;
  }

  /// Appends what is left of a piece outside of the halves that cut it; false if that is all of it.
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
        // They do not meet after all (set apart by a depth plane, or by the apex): undo the cuts.
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
  PieceTree left_;  ///< of the receiver at hand
  std::vector<int> sides_, first_sides_, flipped_;
  std::vector<unsigned> glances_;  ///< by corner: what the first tier says of an occluder's half-spaces
};

}  // namespace tubefoot
