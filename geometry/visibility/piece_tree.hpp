// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "geometry/arithmetic/cone_clip.hpp"

// Stores the convex pieces that remain of a facet while other facets are subtracted from it. Few pieces form
// a list; more pieces form the tree of their cuts, so that a facet is compared only with pieces near it.

namespace tubefoot {

/// The convex pieces that remain of a target facet while one facet after another is subtracted from it. More
/// than a few pieces are stored as the tree of their cuts. A node is an earlier piece, and its children are
/// the parts that were left of it. A facet that does not meet a node meets nothing below it, so it is
/// compared with the pieces near it and not with all. For example, n long facets that cross each other leave
/// n pieces, but each meets only a few of them.
///
/// Law L3 (pieces): the pieces and their order are those of a list in which each piece is replaced by its
/// remaining parts.
class PieceTree {
 public:
  /// Starts with one piece.
  void begin(PieceRange piece) {
    nodes_.assign(1, Node{piece, 0, 0, 0, 1});
    few_.assign(1, piece);
    listed_ = true;
  }

  bool empty() const { return nodes_.front().pieces == 0; }

  /// Cuts every piece; returns true if any piece changed. `cut(piece, requested, rest)` appends the remaining
  /// parts of a piece to `rest`, or returns false if the whole piece remains. `meets(piece, requested)` may
  /// return false only if `cut` would return false for everything within the piece. It may remove bits of
  /// `requested` that need no further test there.
  template <class Meets, class Cut>
  bool take_away(unsigned requested, const Meets& meets, const Cut& cut) {
    if (listed_) return take_away_from_few(requested, cut);
    if (empty()) return false;
    bool taken = false;
    visits_.assign(1, {0, requested});
    while (!visits_.empty()) {
      auto [at, requested_here] = visits_.back();
      visits_.pop_back();
      if (nodes_[at].children > 0) shorten(at);
      if (nodes_[at].children == 0) {
        rest_.clear();
        if (!cut(nodes_[at].piece, requested_here, rest_)) continue;
        taken = true;
        replace(at, rest_);
        continue;
      }
      const Node& node = nodes_[at];
      if (node.pieces >= worth_a_look && !meets(node.piece, requested_here)) continue;
      for (std::uint32_t child = node.first; child < node.first + node.children; ++child)
        if (nodes_[child].pieces > 0) visits_.push_back({child, requested_here});
    }
    return taken;
  }

  /// Visits all pieces in order.
  template <class Visit>
  void each(const Visit& visit) {
    if (listed_) {
      for (const PieceRange& piece : few_) visit(piece);
      return;
    }
    visits_.assign(1, {0, 0});
    while (!visits_.empty()) {
      const Node& node = nodes_[visits_.back().node];
      visits_.pop_back();
      if (node.pieces == 0) continue;
      if (node.children == 0) visit(node.piece);
      for (std::uint32_t child = node.first + node.children; child-- > node.first;)
        visits_.push_back({child, 0});
    }
  }

 private:
  struct Node {
    PieceRange piece;
    std::uint32_t parent;
    std::uint32_t first, children;  ///< nodes [first, first + children)
    std::uint32_t pieces;           ///< number of pieces at or below the node
  };
  struct Visit {
    std::uint32_t node;
    unsigned requested;
  };

  /// Up to this number, pieces are stored in a list. Most facets never have more.
  static constexpr std::size_t few = 6;
  /// A test of a node costs as much as a test of a piece, so it is made only for nodes with this many pieces.
  static constexpr std::uint32_t worth_a_look = 3;

  template <class Cut>
  bool take_away_from_few(unsigned requested, const Cut& cut) {
    bool taken = false;
    rest_.clear();
    for (const PieceRange& piece : few_) {
      const std::size_t mark = rest_.size();
      if (cut(piece, requested, rest_)) {
        taken = true;
      } else {
        rest_.resize(mark);
        rest_.push_back(piece);
      }
    }
    few_.swap(rest_);
    listed_ = few_.size() <= few;
    if (listed_)
      nodes_.front().pieces = static_cast<std::uint32_t>(few_.size());
    else
      replace(0, few_);
    return taken;
  }

  /// Replaces a leaf by its remaining parts.
  void replace(std::uint32_t at, const std::vector<PieceRange>& left) {
    if (left.size() == 1) {
      nodes_[at].piece = left.front();
      return;
    }
    nodes_[at].first = static_cast<std::uint32_t>(nodes_.size());
    nodes_[at].children = static_cast<std::uint32_t>(left.size());
    const std::uint32_t before = nodes_[at].pieces, now = nodes_[at].children;
    for (const PieceRange& piece : left) nodes_.push_back({piece, at, 0, 0, 1});
    for (std::uint32_t node = at;; node = nodes_[node].parent) {
      nodes_[node].pieces = nodes_[node].pieces - before + now;
      if (node == 0) break;
    }
  }

  /// Replaces a node by its only child that has pieces, if there is only one. That child is smaller.
  void shorten(std::uint32_t at) {
    while (nodes_[at].children > 0) {
      const Node node = nodes_[at];
      std::uint32_t child = node.first;
      while (nodes_[child].pieces == 0) ++child;
      if (nodes_[child].pieces != node.pieces) return;
      const Node only = nodes_[child];
      nodes_[at] = {only.piece, node.parent, only.first, only.children, only.pieces};
      for (std::uint32_t k = 0; k < only.children; ++k) nodes_[only.first + k].parent = at;
    }
  }

  std::vector<Node> nodes_;
  std::vector<Visit> visits_;
  bool listed_ = true;  ///< the pieces are those of few_, and the root has no children
  std::vector<PieceRange> few_;
  std::vector<PieceRange> rest_;
};

}  // namespace tubefoot
