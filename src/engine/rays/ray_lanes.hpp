// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>

#include "engine/rays/ray_patch.hpp"
#include "engine/visibility/ray_hits.hpp"

// Arithmetic on sixteen rays side by side. ray_lanes.cpp is compiled so that it becomes vector code
// (src/engine/CMakeLists.txt); the digits are those of one ray after the other.
namespace tubefoot {

/// Sixteen rays that lie side by side: what Embree traces at once.
struct RayPacket {
  static constexpr int size = 16;
  using Numbers = std::array<double, size>;
  int count = 0;                        ///< lanes in use, from 0
  alignas(64) Numbers x, y, z, weight;  ///< unit direction; solid angle [sr]
  std::array<std::uint32_t, size> tube;
};

/// Streams of random bits by number: the increment and the finalizer of SplitMix64 (Steele, Lea and Flood).
namespace splitmix {
constexpr std::uint64_t golden = 0x9e3779b97f4a7c15u;
constexpr std::uint64_t mixed(std::uint64_t x) {
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
  return x ^ (x >> 31);
}
/// The middles of 2^32 intervals of [0, 1], by the upper and the lower half of 64 bits.
constexpr double upper_uniform(std::uint64_t bits) { return (double(bits >> 32) + 0.5) * 0x1p-32; }
constexpr double lower_uniform(std::uint64_t bits) { return (double(std::uint32_t(bits)) + 0.5) * 0x1p-32; }
}  // namespace splitmix

/// Cells of a patch in rows, one for each lane. What changes from block to block of a band is one number:
/// what is written lane by lane would have to reach the cache before it can be read as a vector.
struct RayCells {
  alignas(64) RayPacket::Numbers column, u_step, begin, count, weight;
  double first_column = 0;  ///< of the lanes': added to `column`
  double share = 1;         ///< of a cell in the patch's u v
};

/// Directions and weights (`weight` times density of solid angle) at places of a patch.
void aim(const RayPatch& patch, const RayPacket::Numbers& u, const RayPacket::Numbers& v,
         const RayPacket::Numbers& weight, RayPacket& packet);

/// The same at a random place of each cell, by the bits of `key` and the numbers of rays from `first` on.
void aim_into(const RayPatch& patch, const RayCells& cells, std::uint64_t key, std::uint64_t first,
              RayPacket& packet);

/// Sixteen points of the unit square, in 32 binary digits: each the middle of what these leave open.
struct NetBlock {
  alignas(64) std::array<std::uint32_t, RayPacket::size> x{}, y{};
};

/// The same at the points of a net, all of one weight.
void aim_at_net(const RayPatch& patch, const NetBlock& points, double weight, RayPacket& packet);

/// The facets that rays met, 0 for those that met none by the numbers of geometries; returns how many did.
int met_facets(const unsigned* geometry, const unsigned* primitive, unsigned none, int count,
               std::array<FacetId, RayPacket::size>& facet);

/// The directions of a packet, rounded.
void round_directions(const RayPacket& packet, float* x, float* y, float* z);

/// normal . x = distance, metres from the grid's origin; the normal has unit length, or is 0 for a facet of
/// no area.
struct alignas(32) RayPlane {
  double x, y, z, distance_m;
};

struct MetPlanes {
  alignas(64) RayPacket::Numbers range_m, sine_grazing;
  std::array<std::int64_t, RayPacket::size> doubtful;  ///< not 0: within what rounding can do
  std::int64_t any_doubtful;                           ///< the same of all lanes together
};

/// Where the rays of a packet meet the planes of facets, from a place at `place_length` from the origin.
void meet_planes(const RayPlane* planes, const std::array<FacetId, RayPacket::size>& facet,
                 const glm::dvec3& place, double place_length, const RayPacket& rays,
                 const float* embree_range_m, MetPlanes& met);

/// Hits of all sixteen rays.
void write_hits(const RayPacket& packet, const MetPlanes& met,
                const std::array<FacetId, RayPacket::size>& facet, const float* x, const float* y,
                const float* z, HitBlock& block);

}  // namespace tubefoot
