// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <functional>

#include "engine/rays/embree.hpp"
#include "engine/rays/ray_engine.hpp"
#include "engine/rays/ray_planes.hpp"

// What is behind a RayScene, for the files that trace rays in it.
namespace tubefoot {

/// Writes hits into blocks, in order. A packet all of whose rays met something fills a block of its own,
/// whether the one before is full or not.
class HitWriter {
 public:
  /// `numbers`: room for which of the source's rays each hit is of; null: it is not asked for.
  explicit HitWriter(HitBlock* first, std::uint32_t* numbers = nullptr) : end_(first), numbers_(numbers) {}

  /// So many blocks can the hits of rays need: full ones, with one of a single hit between each two, and one
  /// more.
  static constexpr std::size_t most_blocks(std::size_t rays) { return 2 * (rays / (HitBlock::size + 1) + 1); }

  /// Of rays `number` and on.
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
  /// Behind the last block, none of them empty.
  HitBlock* end() const { return end_; }

 private:
  HitBlock* end_;
  std::uint32_t* numbers_;
  bool open_ = false;  // whether the last block may take more
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

  /// Throws std::runtime_error if Embree failed.
  void build();
  void add_facets(RTCDevice device);

  /// Traces the rays that `next` gives and writes down their hits. It returns false when there are no more.
  void trace(GridPoint apex, double reach_m, const std::function<bool(RayPacket&)>& next, HitWriter& hits,
             const RaysOnwards* onwards) const;
  void append_hits(GridPoint apex, double reach_m, const RayPacket& packet, const RTCRayHit16& rays,
                   std::uint32_t number, HitWriter& hits) const;
  bool meet_beyond(GridPoint apex, glm::dvec3 direction, double from_m, double reach_m, RayHit& hit) const;
};

}  // namespace tubefoot
