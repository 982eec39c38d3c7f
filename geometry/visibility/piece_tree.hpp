// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "geometry/arithmetic/cone_clip.hpp"

namespace tubefoot {

/// The convex pieces that are left of a receiver while one facet after another is taken away from it. Once
/// they are more than a few, as the tree of their cuts: a node is a piece that there once was, its children
/// are what was left of it. What does not meet a node meets nothing below it, so a facet is held against the
/// pieces about it and not against all: of n long facets across one another each meets a few pieces, but n
/// are left.
/// Law L3 (pieces): the pieces, and their order, are those of a list in which each piece is replaced by what
///   is left of it.
class PieceTree {
 public:
  /// One piece.
  void begin(PieceRange piece) {
    nodes_.assign(1, Node{piece, 0, 0, 0, 1});
    few_.assign(1, piece);
    listed_ = true;
  }

  bool empty() const { return nodes_.front().pieces == 0; }

  /// Cuts every piece; true if anything was taken of any. `cut(piece, asked, rest)` appends what is left of a
  /// piece to `rest`, or returns false if that is all of it. `meets(piece, asked)` may be false only if `cut`
  /// would be for all that lies within the piece; it may take out of `requested` what need not be asked there
  /// again.
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
    std::uint32_t pieces;           ///< at or below
  };
  struct Visit {
    std::uint32_t node;
    unsigned requested;
  };

  /// No more pieces than this are kept in a list: most receivers never have more.
  static constexpr std::size_t few = 6;
  /// A look at a node costs as much as one at a piece.
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

  /// Of a leaf, this is left.
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

  /// Puts a node's only child that has pieces, if there is but one, in its place: it is smaller.
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
