// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/rays/ray_lanes.hpp"

#include <bit>
#include <cmath>

#include "geometry/numbers/vector_clones.hpp"

namespace tubefoot {
namespace {

using namespace splitmix;

constexpr int lanes = RayPacket::size;
using Numbers = RayPacket::Numbers;

/// lower_uniform in operations that processors have for several numbers at once.
inline double uniform_of(std::uint64_t bits32) {
  return (std::bit_cast<double>(bits32 | 0x4330000000000000u) - 0x1p52 + 0.5) * 0x1p-32;
}

__attribute__((always_inline)) inline void aim_at(const RayPatch& patch, const Numbers& u, const Numbers& v,
                                                  const Numbers& weight, RayPacket& packet) {
  // None of which overlaps another, as the compiler has to be told.
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
    u[k] = (cells.column[k] + uniform_of(bits[k] >> 32)) * cells.u_step[k];
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
MetPlanes meet_planes(const RayPlanes16& planes, const glm::dvec3& place, double place_length,
                      const RayPacket& rays, const float* embree_range_m) {
  // A hundred times what rounding can do to the offset; beyond, the exact sign is not in doubt.
  constexpr double uncertain_offset = 1e-13;
  // Below, a ray may meet the plane away from the facet, where Embree's float saw a hit.
  constexpr double grazing_sine = 0.01, uncertain_range = 1e-6;
  MetPlanes met;
  for (int k = 0; k < lanes; ++k) {
    // Added as glm::dot does, so that a ray alone has the same digits.
    const double across = planes.x[k] * place.x + planes.y[k] * place.y + planes.z[k] * place.z;
    const double offset = planes.distance_m[k] - across;
    const double descent = planes.x[k] * rays.x[k] + planes.y[k] * rays.y[k] + planes.z[k] * rays.z[k];
    const double range = offset / descent, sine = std::abs(descent), embree = double(embree_range_m[k]);
    met.range_m[k] = range;
    met.sine_grazing[k] = sine;
    const bool sure_offset =
        std::abs(offset) > uncertain_offset * (std::abs(planes.distance_m[k]) + place_length);
    const bool sure_range = std::abs(range - embree) <= uncertain_range * embree;
    met.doubtful[k] = std::int64_t(!(sure_offset & (sine >= grazing_sine) & sure_range));
  }
  return met;
}

}  // namespace tubefoot
