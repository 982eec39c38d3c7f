// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <functional>

#include "engine/rays/embree.hpp"
#include "engine/rays/ray_engine.hpp"
#include "engine/rays/ray_planes.hpp"

// Implementation of RayScene, for the files that trace rays in it.
namespace tubefoot {

/// Writes hits into blocks, in order. A packet in which all rays have a hit fills a block of its own, whether
/// the previous block is full or not.
class HitWriter {
 public:
  /// `numbers` receives the number of the source's ray for each hit; null: not needed.
  explicit HitWriter(HitBlock* first, std::uint32_t* numbers = nullptr) : end_(first), numbers_(numbers) {}

  /// Returns the largest number of blocks for the hits of rays: full blocks, a block with a single hit
  /// between each two, and one more.
  static constexpr std::size_t most_blocks(std::size_t rays) { return 2 * (rays / (HitBlock::size + 1) + 1); }

  /// For the rays from `number` on.
  HitBlock& whole_block(std::uint32_t number) {
    open_ = false;
    if (numbers_ != nullptr)
      for (std::size_t k = 0; k < HitBlock::size; ++k) *numbers_++ = number + std::uint32_t(k);
    return *end_++;
  }
  void append(std::uint32_t number, const RayHit& hit) {
    if (numbers_ != nullptr) *numbers_++ = number;
    if (!open_ || end_[-1].count == HitBlock::size) {
      open_ = true;
      (end_++)->count = 0;
    }
    end_[-1].append(hit);
  }
  /// Returns the end of the blocks, none of which is empty.
  HitBlock* end() const { return end_; }

 private:
  HitBlock* end_;
  std::uint32_t* numbers_;
  bool open_ = false;  // whether the last block may receive more hits
};

struct RayScene::State {
  const FacetMesh& mesh;
  double unit_m;
  RTCScene scene = nullptr;
  RayPlanes planes;

  State(const FacetMesh& facet_mesh, const WorldGrid& grid) : mesh(facet_mesh), unit_m(grid.unit_m()) {}
  ~State() {
    if (scene != nullptr) rtcReleaseScene(scene);
  }
  State(const State&) = delete;
  State& operator=(const State&) = delete;

  /// Throws std::runtime_error if Embree fails.
  void build();
  void add_facets(RTCDevice device);

  /// Traces the rays that `next` provides and writes their hits. `next` returns false if there are no more
  /// rays.
  void trace(GridPoint apex, double reach_m, const std::function<bool(RayPacket&)>& next, HitWriter& hits,
             const RaysOnwards* onwards) const;
  void append_hits(GridPoint apex, double reach_m, const RayPacket& packet, const RTCRayHit16& rays,
                   std::uint32_t number, HitWriter& hits) const;
  bool meet_beyond(GridPoint apex, glm::dvec3 direction, double from_m, double reach_m, RayHit& hit) const;
};

}  // namespace tubefoot
