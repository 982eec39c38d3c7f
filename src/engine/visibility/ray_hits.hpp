// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <initializer_list>
#include <iterator>
#include <span>
#include <vector>

#include "geometry/mesh/facet_mesh.hpp"

// Hits of rays, stored in blocks of sixteen for vector instructions. A hit represents the solid angle from
// which its ray was drawn.

namespace tubefoot {

/// The element of a sampling engine: the hit of one ray, which represents the solid angle from which the ray
/// was drawn.
struct RayHit {
  FacetId facet = 0;
  std::uint32_t tube = 0;
  double slant_range_m = 0;
  double sine_grazing = 0;    ///< sine of the grazing angle between ray and facet
  double solid_angle_sr = 0;  ///< weight: the hit represents an area solid_angle * range^2 / sine_grazing
  glm::vec3 direction{0};     ///< unit direction of the ray in the local frame; beam patterns read it
};

/// Up to sixteen hits, with one array per member, so that they are written and read as vectors. Lanes from
/// `count` on are undefined.
struct HitBlock {
  static constexpr std::size_t size = 16;
  template <class T>
  using Lanes = std::array<T, size>;

  alignas(64) Lanes<double> slant_range_m;
  Lanes<double> sine_grazing, solid_angle_sr;
  Lanes<float> x, y, z;  ///< of the direction
  Lanes<FacetId> facet;
  Lanes<std::uint32_t> tube;
  std::uint32_t count;

  HitBlock() {}  // NOLINT: room for a million of them is not to be cleared first

  RayHit operator[](std::size_t lane) const {
    return {facet[lane],        tube[lane],           slant_range_m[lane],
            sine_grazing[lane], solid_angle_sr[lane], {x[lane], y[lane], z[lane]}};
  }
  void append(const RayHit& hit) {
    facet[count] = hit.facet;
    tube[count] = hit.tube;
    slant_range_m[count] = hit.slant_range_m;
    sine_grazing[count] = hit.sine_grazing;
    solid_angle_sr[count] = hit.solid_angle_sr;
    x[count] = hit.direction.x;
    y[count] = hit.direction.y;
    z[count] = hit.direction.z;
    ++count;
  }
};

/// Hits in the order in which their energies are added.
class RayHits {
 public:
  class Iterator {
   public:
    using iterator_category = std::input_iterator_tag;  // hits are constructed on access
    using value_type = RayHit;
    using difference_type = std::ptrdiff_t;
    using pointer = const RayHit*;
    using reference = RayHit;

    Iterator() = default;
    explicit Iterator(const HitBlock* block) : block_(block) {}
    RayHit operator*() const { return (*block_)[lane_]; }
    Iterator& operator++() {
      if (++lane_ == block_->count) {
        ++block_;
        lane_ = 0;
      }
      return *this;
    }
    Iterator operator++(int) {
      Iterator before = *this;
      ++*this;
      return before;
    }
    bool operator==(const Iterator&) const = default;

   private:
    const HitBlock* block_ = nullptr;
    std::size_t lane_ = 0;
  };

  RayHits() = default;
  RayHits(std::initializer_list<RayHit> hits) {
    for (const RayHit& hit : hits) push_back(hit);
  }

  std::size_t size() const {
    std::size_t count = 0;
    for (const HitBlock& block : blocks_) count += block.count;
    return count;
  }
  bool empty() const { return blocks_.empty(); }
  Iterator begin() const { return Iterator(blocks_.data()); }
  Iterator end() const { return Iterator(blocks_.data() + blocks_.size()); }
  /// The blocks, none of which is empty.
  std::span<const HitBlock> blocks() const { return blocks_; }
  std::span<HitBlock> blocks() { return blocks_; }

  void push_back(const RayHit& hit) {
    if (blocks_.empty() || blocks_.back().count == HitBlock::size) blocks_.emplace_back().count = 0;
    blocks_.back().append(hit);
  }
  void append(std::span<const HitBlock> more) { blocks_.insert(blocks_.end(), more.begin(), more.end()); }
  /// Returns memory for this number of blocks, with undefined contents. The caller writes them, and resize()
  /// removes the unused ones.
  HitBlock* room_for(std::size_t blocks) {
    blocks_.clear();  // avoids a copy of the old blocks
    blocks_.resize(blocks);
    return blocks_.data();
  }
  void resize(std::size_t blocks) { blocks_.resize(blocks); }

 private:
  std::vector<HitBlock> blocks_;
};

}  // namespace tubefoot
