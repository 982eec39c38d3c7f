// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/rays/ray_lanes.hpp"

#include <bit>
#include <cmath>

#include "geometry/numbers/vector_clones.hpp"

// Vector code for sixteen rays. It aims rays at points of a patch, intersects them with facet planes in
// double and marks results that rounding may affect.

namespace tubefoot {
namespace {

using namespace splitmix;

constexpr int lanes = RayPacket::size;
using Numbers = RayPacket::Numbers;

/// Computes lower_uniform() with operations that processors have for several numbers at once.
inline double uniform_of(std::uint64_t bits32) {
  return (std::bit_cast<double>(bits32 | 0x4330000000000000u) - 0x1p52 + 0.5) * 0x1p-32;
}

__attribute__((always_inline)) inline void aim_at(const RayPatch& patch, const Numbers& u, const Numbers& v,
                                                  const Numbers& weight, RayPacket& packet) {
  // The pointers do not overlap; the compiler needs this information.
  const RayPatch own = patch;
  const double* __restrict at_u = u.data(), * __restrict at_v = v.data(), * __restrict given = weight.data();
  double *__restrict x = packet.x.data(), *__restrict y = packet.y.data(), *__restrict z = packet.z.data(),
                     *__restrict out = packet.weight.data();
  for (int k = 0; k < lanes; ++k) {
    const glm::dvec3 p = own.at(at_u[k], at_v[k]);
    const double inverse = 1 / std::sqrt(p.x * p.x + p.y * p.y + p.z * p.z);
    x[k] = p.x * inverse;
    y[k] = p.y * inverse;
    z[k] = p.z * inverse;
    out[k] = own.triple(at_u[k], at_v[k]) * (inverse * inverse * inverse) * given[k];
  }
}

}  // namespace

TUBEFOOT_VECTOR_CLONES
void aim(const RayPatch& patch, const Numbers& u, const Numbers& v, const Numbers& weight,
         RayPacket& packet) {
  aim_at(patch, u, v, weight, packet);
}

TUBEFOOT_VECTOR_CLONES
void aim_into(const RayPatch& patch, const RayCells& cells, std::uint64_t key, std::uint64_t first,
              RayPacket& packet) {
  alignas(64) std::array<std::uint64_t, lanes> bits;
  for (int k = 0; k < lanes; ++k) bits[k] = mixed(key + golden * (first + std::uint64_t(k)));
  alignas(64) Numbers u, v;
  for (int k = 0; k < lanes; ++k) {
    u[k] = ((cells.first_column + cells.column[k]) + uniform_of(bits[k] >> 32)) * cells.u_step[k];
    v[k] = (cells.begin[k] + uniform_of(bits[k] & 0xffffffffu) * cells.count[k]) * cells.share;
  }
  aim_at(patch, u, v, cells.weight, packet);
}

TUBEFOOT_VECTOR_CLONES
void aim_at_net(const RayPatch& patch, const NetBlock& points, double weight, RayPacket& packet) {
  alignas(64) Numbers u, v, given;
  for (int k = 0; k < lanes; ++k) {
    u[k] = uniform_of(points.x[k]);
    v[k] = uniform_of(points.y[k]);
    given[k] = weight;
  }
  aim_at(patch, u, v, given, packet);
}

TUBEFOOT_VECTOR_CLONES
int met_facets(const unsigned* __restrict geometry, const unsigned* __restrict primitive, unsigned none,
               int count, std::array<FacetId, RayPacket::size>& facet) {
  FacetId* __restrict out = facet.data();
  int met = 0;
  for (int k = 0; k < lanes; ++k) {
    const bool is_met = (geometry[k] != none) & (k < count);
    out[k] = is_met ? primitive[k] : 0;
    met += int(is_met);
  }
  return met;
}

TUBEFOOT_VECTOR_CLONES
void round_directions(const RayPacket& packet, float* __restrict x, float* __restrict y,
                      float* __restrict z) {
  for (int k = 0; k < lanes; ++k) {
    x[k] = float(packet.x[k]);
    y[k] = float(packet.y[k]);
    z[k] = float(packet.z[k]);
  }
}

namespace {

/// Four lanes in explicit vectors, instead of loops, because the lanes' numbers lie plane after plane in
/// memory.
using Four = double __attribute__((vector_size(32)));
using FourBits = std::int64_t __attribute__((vector_size(32)));

__attribute__((always_inline)) inline Four four_at(const double* from) {
  Four four;
  __builtin_memcpy(&four, from, sizeof four);
  return four;
}
__attribute__((always_inline)) inline void put(const Four& four, double* to) {
  __builtin_memcpy(to, &four, sizeof four);
}
__attribute__((always_inline)) inline Four magnitude(const Four& four) {
  constexpr std::int64_t all_but_sign = 0x7fffffffffffffff;
  return Four(FourBits(four) & all_but_sign);
}

}  // namespace

TUBEFOOT_VECTOR_CLONES
void meet_planes(const RayPlane* planes, const std::array<FacetId, RayPacket::size>& facet,
                 const glm::dvec3& place, double place_length, const RayPacket& rays,
                 const float* embree_range_m, MetPlanes& met) {
  // A hundred times the rounding error of the offset. Beyond this bound the exact sign is certain.
  constexpr double uncertain_offset = 1e-13;
  // For smaller sines a ray may meet the plane outside of the facet although Embree's float found a hit.
  constexpr double grazing_sine = 0.01, uncertain_range = 1e-6;
  FourBits any{};
  for (int k = 0; k < lanes; k += 4) {
    const Four a = four_at(&planes[facet[k]].x), b = four_at(&planes[facet[k + 1]].x),
               c = four_at(&planes[facet[k + 2]].x), d = four_at(&planes[facet[k + 3]].x);
    const Four ab_xz = __builtin_shufflevector(a, b, 0, 4, 2, 6),
               ab_yd = __builtin_shufflevector(a, b, 1, 5, 3, 7),
               cd_xz = __builtin_shufflevector(c, d, 0, 4, 2, 6),
               cd_yd = __builtin_shufflevector(c, d, 1, 5, 3, 7);
    const Four x = __builtin_shufflevector(ab_xz, cd_xz, 0, 1, 4, 5),
               y = __builtin_shufflevector(ab_yd, cd_yd, 0, 1, 4, 5),
               z = __builtin_shufflevector(ab_xz, cd_xz, 2, 3, 6, 7),
               distance = __builtin_shufflevector(ab_yd, cd_yd, 2, 3, 6, 7);
    // The order of additions is that of glm::dot, so that a single ray gives the same digits.
    const Four across = x * place.x + y * place.y + z * place.z;
    const Four offset = distance - across;
    const Four descent = x * four_at(&rays.x[k]) + y * four_at(&rays.y[k]) + z * four_at(&rays.z[k]);
    const Four range = offset / descent, sine = magnitude(descent);
    const Four embree{double(embree_range_m[k]), double(embree_range_m[k + 1]), double(embree_range_m[k + 2]),
                      double(embree_range_m[k + 3])};
    put(range, &met.range_m[k]);
    put(sine, &met.sine_grazing[k]);
    const FourBits sure = (magnitude(offset) > uncertain_offset * (magnitude(distance) + place_length)) &
                          (sine >= grazing_sine) & (magnitude(range - embree) <= uncertain_range * embree);
    const FourBits doubtful = ~sure;
    __builtin_memcpy(&met.doubtful[k], &doubtful, sizeof doubtful);
    any |= doubtful;
  }
  met.any_doubtful = any[0] | any[1] | any[2] | any[3];
}

TUBEFOOT_VECTOR_CLONES
void write_hits(const RayPacket& packet, const MetPlanes& met,
                const std::array<FacetId, RayPacket::size>& facet, const float* __restrict x,
                const float* __restrict y, const float* __restrict z, HitBlock& block) {
  HitBlock& __restrict to = block;
  to.count = HitBlock::size;
  for (int k = 0; k < lanes; ++k) {
    to.slant_range_m[k] = met.range_m[k];
    to.sine_grazing[k] = met.sine_grazing[k];
    to.solid_angle_sr[k] = packet.weight[k];
  }
  for (int k = 0; k < lanes; ++k) {
    to.x[k] = x[k];
    to.y[k] = y[k];
    to.z[k] = z[k];
    to.facet[k] = facet[k];
    to.tube[k] = packet.tube[k];
  }
}

}  // namespace tubefoot
