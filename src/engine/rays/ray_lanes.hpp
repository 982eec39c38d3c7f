// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>

#include "engine/rays/ray_patch.hpp"
#include "engine/visibility/ray_hits.hpp"

// Arithmetic on sixteen rays side by side. The compiler translates ray_lanes.cpp to vector code
// (src/engine/CMakeLists.txt). The digits are the same as for one ray after the other.
namespace tubefoot {

/// Sixteen neighbouring rays, which Embree traces at once.
struct RayPacket {
  static constexpr int size = 16;
  using Numbers = std::array<double, size>;
  int count = 0;                        ///< number of lanes in use, from 0
  alignas(64) Numbers x, y, z, weight;  ///< unit direction; solid angle [sr]
  std::array<std::uint32_t, size> tube;
};

/// Numbered streams of random bits: the increment and the finalizer of SplitMix64 (Steele, Lea and Flood).
namespace splitmix {
constexpr std::uint64_t golden = 0x9e3779b97f4a7c15u;
constexpr std::uint64_t mixed(std::uint64_t x) {
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
  return x ^ (x >> 31);
}
/// Return the middles of 2^32 intervals of [0, 1], selected by the upper and by the lower half of 64 bits.
constexpr double upper_uniform(std::uint64_t bits) { return (double(bits >> 32) + 0.5) * 0x1p-32; }
constexpr double lower_uniform(std::uint64_t bits) { return (double(std::uint32_t(bits)) + 0.5) * 0x1p-32; }
}  // namespace splitmix

/// Cells of a patch in rows, one per lane. Only one number changes from block to block of a band. Values that
/// were written lane by lane would have to reach the cache before they could be read as a vector.
struct RayCells {
  alignas(64) RayPacket::Numbers column, u_step, begin, count, weight;
  double first_column = 0;  ///< of the lanes; added to `column`
  double share = 1;         ///< area of a cell in the patch's (u, v)
};

/// Computes directions and weights (`weight` times density of solid angle) at points of a patch.
void aim(const RayPatch& patch, const RayPacket::Numbers& u, const RayPacket::Numbers& v,
         const RayPacket::Numbers& weight, RayPacket& packet);

/// The same at a random point of each cell, from the bits of `key` and the numbers of rays from `first` on.
void aim_into(const RayPatch& patch, const RayCells& cells, std::uint64_t key, std::uint64_t first,
              RayPacket& packet);

/// Sixteen points of the unit square, in 32 binary digits. Each number represents the middle of its interval
/// of length 2^-32.
struct NetBlock {
  alignas(64) std::array<std::uint32_t, RayPacket::size> x{}, y{};
};

/// The same at the points of a net, all of equal weight.
void aim_at_net(const RayPatch& patch, const NetBlock& points, double weight, RayPacket& packet);

/// Writes the facets that the rays hit, and 0 for rays without a hit, which have the geometry number `none`.
/// Returns the number of hits.
int met_facets(const unsigned* geometry, const unsigned* primitive, unsigned none, int count,
               std::array<FacetId, RayPacket::size>& facet);

/// Rounds the directions of a packet to float.
void round_directions(const RayPacket& packet, float* x, float* y, float* z);

/// normal . x = distance, in metres from the grid's origin. The normal has unit length, or is 0 for a facet
/// without area.
struct alignas(32) RayPlane {
  double x, y, z, distance_m;
};

struct MetPlanes {
  alignas(64) RayPacket::Numbers range_m, sine_grazing;
  std::array<std::int64_t, RayPacket::size> doubtful;  ///< not 0: rounding may affect the result
  std::int64_t any_doubtful;                           ///< the same for all lanes together
};

/// Computes the intersections of the rays of a packet with the planes of facets. The rays start at `place`,
/// at the distance `place_length` from the origin.
void meet_planes(const RayPlane* planes, const std::array<FacetId, RayPacket::size>& facet,
                 const glm::dvec3& place, double place_length, const RayPacket& rays,
                 const float* embree_range_m, MetPlanes& met);

/// Writes the hits of all sixteen rays.
void write_hits(const RayPacket& packet, const MetPlanes& met,
                const std::array<FacetId, RayPacket::size>& facet, const float* x, const float* y,
                const float* z, HitBlock& block);

}  // namespace tubefoot
